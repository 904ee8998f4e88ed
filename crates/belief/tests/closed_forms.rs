//! The closed forms on {I, NI}, beside a plain reading of the rules' definitions: every way to choose one
//! element of each source, and where its product goes.

use proptest::prelude::*;
use wisdom_belief::{BeliefError, InterestMass, Number, ParadoxPolicy, Rule, Settings};

/// Both add up the same products in another order.
const SAME: f64 = 1e-12;

// Elements of {I, NI} as sets of atoms; the paradox stands apart, since only dsmc and dsmh know it.
const I: usize = 0;
const NI: usize = 1;
const THETA: usize = 2;
const PARADOX: usize = 3;

/// One element of each source, and the product of their masses.
struct Choice {
    elements: Vec<usize>,
    product: f64,
}

impl Choice {
    fn any(&self, element: usize) -> bool {
        self.elements.contains(&element)
    }

    /// The atoms of the intersection and of the union under Shafer's model, ∅ being what the paradox is.
    fn atoms(&self) -> [usize; 2] {
        let atoms = |&element: &usize| [0b01, 0b10, 0b11, 0b00][element];
        let intersection = self.elements.iter().map(atoms).fold(0b11, |all, x| all & x);
        [intersection, self.elements.iter().map(atoms).fold(0, |all, x| all | x)]
    }
}

fn choices(sources: &[[f64; 4]]) -> Vec<Choice> {
    let mut all = vec![Choice { elements: Vec::new(), product: 1.0 }];
    for source in sources {
        all = all
            .iter()
            .flat_map(|choice| {
                (0..4).map(|element| Choice {
                    elements: [&choice.elements[..], &[element]].concat(),
                    product: choice.product * source[element],
                })
            })
            .filter(|choice| choice.product > 0.0)
            .collect();
    }
    all
}

/// Where the mass of a set of atoms is kept.
fn slot(atoms: usize) -> usize {
    [PARADOX, I, NI, THETA][atoms]
}

fn conjunctive(sources: &[[f64; 4]]) -> [f64; 4] {
    let mut masses = [0.0; 4];
    for choice in choices(sources) {
        masses[slot(choice.atoms()[0])] += choice.product;
    }
    masses
}

fn scaled(masses: [f64; 4]) -> Option<[f64; 4]> {
    let sum: f64 = masses[..PARADOX].iter().sum();
    (sum > 0.0).then(|| [masses[I] / sum, masses[NI] / sum, masses[THETA] / sum, 0.0])
}

/// Gives each conflicting product to I, NI and I ∪ NI by weights that add up to more than 0.
fn given_back(sources: &[[f64; 4]], weights: impl Fn(&Choice) -> [f64; 3]) -> [f64; 4] {
    let mut masses = conjunctive(sources);
    masses[PARADOX] = 0.0;
    for choice in choices(sources).iter().filter(|choice| choice.atoms()[0] == 0) {
        let weights = weights(choice);
        let sum: f64 = weights.iter().sum();
        for (mass, weight) in masses.iter_mut().zip(weights) {
            *mass += choice.product * weight / sum;
        }
    }
    masses
}

/// For each element: the sum or product of the masses that chose it; 0 if there are none.
fn groups(sources: &[[f64; 4]], choice: &Choice, sums: bool) -> [f64; 3] {
    [I, NI, THETA].map(|element| {
        let chose = sources.iter().zip(&choice.elements).filter(|(_, chosen)| **chosen == element);
        let masses = chose.map(|(source, _)| source[element]);
        match (choice.any(element), sums) {
            (false, _) => 0.0,
            (true, true) => masses.sum(),
            (true, false) => masses.product(),
        }
    })
}

fn columns(sources: &[[f64; 4]]) -> [f64; 3] {
    [I, NI, THETA].map(|element| sources.iter().map(|source| source[element]).sum())
}

fn mean(sources: &[[f64; 4]], weights: &[f64]) -> [f64; 4] {
    let total: f64 = weights.iter().sum();
    [I, NI, THETA, PARADOX].map(|element| {
        let weighted = sources.iter().zip(weights).map(|(source, weight)| weight * source[element]);
        weighted.sum::<f64>() / total
    })
}

/// Jousselme's distance, by its definition with the Jaccard index of every pair of elements.
fn distance(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let jaccard = |x: usize, y: usize| {
        let (x, y) = (x + 1, y + 1); // atoms of I, NI, I ∪ NI
        f64::from((x & y).count_ones()) / f64::from((x | y).count_ones())
    };
    let mut sum = 0.0;
    for x in 0..3 {
        for y in 0..3 {
            sum += (a[x] - b[x]) * (a[y] - b[y]) * jaccard(x, y);
        }
    }
    (sum.max(0.0) / 2.0).sqrt()
}

fn deng(sources: &[[f64; 4]]) -> Option<[f64; 4]> {
    let support = |s: usize| {
        let others = sources.iter().enumerate().filter(|&(other, _)| other != s);
        others.map(|(_, source)| 1.0 - distance(&sources[s], source)).sum::<f64>()
    };
    let mut weights: Vec<f64> = (0..sources.len()).map(support).collect();
    if weights.iter().sum::<f64>() < 1e-9 {
        weights.fill(1.0);
    }
    scaled(conjunctive(&vec![mean(sources, &weights); sources.len()]))
}

/// Weights of the canonical decomposition from commonalities, then their minima, and back: with m(Θ) > 0 the
/// weight of A is Π q(B)^(−1)^(|B| − |A| + 1) over all B that contain A.
fn cautious(sources: &[[f64; 4]]) -> Option<[f64; 4]> {
    let mut least = [f64::INFINITY; 3];
    for [i, n, u, p] in sources {
        let (q_i, q_n, q_empty) = (i + u, n + u, i + n + u + p);
        if *u == 0.0 {
            return None;
        }
        for (least, weight) in least.iter_mut().zip([u / q_i, u / q_n, q_i * q_n / (q_empty * u)]) {
            *least = least.min(weight);
        }
    }
    let [w_i, w_n, w_empty] = least;
    // Generalised simple functions, one after the other, by commonality: q of A^w is w but on parts of A.
    let (q_theta, q_i, q_n) = (w_i * w_n * w_empty, w_n * w_empty, w_i * w_empty);
    let (i, n) = (q_i - q_theta, q_n - q_theta);
    Some([i, n, q_theta, 1.0 - i - n - q_theta])
}

/// The cautious rule of the negations: what contains A becomes what A contains.
fn bold(sources: &[[f64; 4]]) -> Option<[f64; 4]> {
    let negated = |[i, n, u, p]: &[f64; 4]| [*n, *i, *p, *u];
    let sources: Vec<[f64; 4]> = sources.iter().map(negated).collect();
    cautious(&sources).map(|masses| negated(&masses))
}

/// What the definition of a rule makes of sources; nothing where it is undefined.
fn by_definition(rule: Rule, sources: &[[f64; 4]]) -> Option<[f64; 4]> {
    let conjunction = conjunctive(sources);
    let [i, n, u, k] = conjunction;
    let (count, all) = (sources.len() as f64, choices(sources));
    let moved = |to: &dyn Fn(&Choice) -> usize| {
        let mut masses = [0.0; 4];
        for choice in &all {
            masses[to(choice)] += choice.product;
        }
        masses
    };
    let disjunction = moved(&|choice| slot(choice.atoms()[1]));
    let centre = |weight: &dyn Fn(&Choice) -> f64| {
        let mut masses = [0.0; 4];
        for choice in &all {
            masses[slot(choice.atoms()[0])] += choice.product * weight(choice);
        }
        scaled(masses)
    };
    let size = |atoms: usize| f64::from(atoms.count_ones());
    let pcr = |sums: bool, ignorance: bool| {
        Some(given_back(sources, |choice| {
            let [i, n, u] = groups(sources, choice, sums);
            [i, n, if ignorance { u } else { 0.0 }]
        }))
    };
    match rule {
        Rule::Dsmc => Some(moved(&|choice| match choice {
            choice if choice.any(PARADOX) || choice.any(I) && choice.any(NI) => PARADOX,
            choice => slot(choice.atoms()[0]),
        })),
        Rule::Conjunctive => Some(conjunction),
        Rule::Dempster | Rule::MinC => scaled(conjunction),
        Rule::Disjunctive => Some(disjunction),
        Rule::Yager => Some([i, n, u + k, 0.0]),
        Rule::DuboisPrade => Some(moved(&|choice| match choice.atoms() {
            [0, union] => slot(union),
            [intersection, _] => slot(intersection),
        })),
        // The default k of 1.
        Rule::Inagaki => Some([i * (1.0 + k), n * (1.0 + k), u * (1.0 + k) + k * k, 0.0]),
        Rule::Dsmh => Some(moved(&|choice| match choice.atoms() {
            // All empty: the atoms that I ∩ NI is written with; else the union of what is not.
            [0, 0] => THETA,
            [0, union] => slot(union),
            [intersection, _] => slot(intersection),
        })),
        Rule::Pcr1 => {
            let c = columns(sources).map(|column| column / count);
            Some([i + k * c[I], n + k * c[NI], u + k * c[THETA], 0.0])
        }
        Rule::Pcr2 | Rule::Pcr3 => {
            let [c_i, c_n, _] = columns(sources);
            Some(given_back(sources, |_| [c_i, c_n, 0.0]))
        }
        Rule::Pcr4 => {
            let [c_i, c_n, _] = columns(sources);
            let weights = if i > 0.0 && n > 0.0 { [i, n, 0.0] } else { [c_i, c_n, 0.0] };
            Some(given_back(sources, |_| weights))
        }
        Rule::Pcr5 => pcr(false, true),
        Rule::Pcr6 => pcr(true, true),
        Rule::Pcr5Plus | Rule::Pcr5Canonical => pcr(false, false),
        Rule::Pcr6Plus | Rule::Pcr6Canonical => pcr(true, false),
        Rule::Florea => {
            let whole = 1.0 - k + k * k;
            let mixed = |x: usize| (k * disjunction[x] + (1.0 - k) * conjunction[x]) / whole;
            Some([mixed(I), mixed(NI), mixed(THETA), 0.0])
        }
        Rule::Average => Some(mean(sources, &vec![1.0; sources.len()])),
        Rule::Murphy => {
            let mean = mean(sources, &vec![1.0; sources.len()]);
            scaled(conjunctive(&vec![mean; sources.len()]))
        }
        Rule::Deng => deng(sources),
        Rule::Zhang => centre(&|choice| {
            let sizes =
                choice.elements.iter().map(|&element| if element == THETA { 2.0 } else { 1.0 });
            size(choice.atoms()[0]) / sizes.product::<f64>()
        }),
        Rule::Jaccard => centre(&|choice| match choice.atoms() {
            [_, 0] => 0.0,
            [intersection, union] => size(intersection) / size(union),
        }),
        Rule::Cautious => cautious(sources),
        Rule::Bold => bold(sources),
        Rule::Urr => {
            let focal = columns(sources).map(|column| if column > 0.0 { 1.0 } else { 0.0 });
            Some(given_back(sources, |_| focal))
        }
        Rule::Purr => Some(given_back(sources, |choice| {
            [I, NI, THETA].map(|x| choice.elements.iter().filter(|&&e| e == x).count() as f64)
        })),
        _ => unreachable!("a rule without a definition here"),
    }
}

fn mass(weights: [u32; 4]) -> InterestMass {
    let sum = f64::from(weights.iter().sum::<u32>());
    InterestMass::from_masses(weights.map(|w| f64::from(w) / sum)).expect("they sum to 1")
}

/// Any mass function on {I, NI}, often with masses that are 0.
fn any_mass() -> impl Strategy<Value = InterestMass> {
    let weight = || prop_oneof![1 => Just(0), 3 => 1..1000_u32];
    [weight(), weight(), weight(), weight()]
        .prop_filter("some mass", |masses| masses.iter().sum::<u32>() > 0)
        .prop_map(mass)
}

fn any_sources() -> impl Strategy<Value = Vec<InterestMass>> {
    prop::collection::vec(any_mass(), 1..=5)
}

fn admitted() -> Vec<(Rule, ParadoxPolicy)> {
    let pairs = Rule::ALL.into_iter().flat_map(|rule| ParadoxPolicy::ALL.map(|p| (rule, p)));
    pairs.filter(|(rule, policy)| rule.admits(*policy)).collect()
}

fn close<F: Number>(a: [F; 4], b: [f64; 4], tolerance: f64) -> bool {
    a.into_iter().zip(b).all(|(a, b)| (a.to_f64() - b).abs() < tolerance)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn closed_forms_are_what_the_definitions_say(
        sources in any_sources(), (rule, policy) in prop::sample::select(admitted()),
    ) {
        let read = |source: &InterestMass| {
            if rule == Rule::Dsmc { *source } else { policy.apply(*source) }.masses()
        };
        let read: Vec<[f64; 4]> = sources.iter().map(read).collect();
        let fused = rule.fuse(&sources, policy);
        let Some(expected) = by_definition(rule, &read) else {
            prop_assert_eq!(fused.mass, InterestMass::VACUOUS);
            prop_assert_eq!(fused.conflict, 1.0);
            return Ok(());
        };
        prop_assert!(
            close(fused.mass.masses(), expected, SAME), "{rule} {policy} {fused:?} {expected:?}"
        );
        let k = if rule == Rule::Dsmc { 0.0 } else { conjunctive(&read)[PARADOX] };
        prop_assert!((fused.conflict - k).abs() < SAME, "{rule} {fused:?} {k}");
    }

    #[test]
    fn fused_masses_sum_to_one_under_every_rule(
        sources in any_sources(), (rule, policy) in prop::sample::select(admitted()),
    ) {
        let masses = rule.fuse(&sources, policy).mass.masses();
        prop_assert!((masses.iter().sum::<f64>() - 1.0).abs() < SAME);
        prop_assert!(masses.iter().all(|mass| (0.0..=1.0 + SAME).contains(mass)), "{rule} {masses:?}");
    }

    #[test]
    fn single_precision_is_within_a_millionth(
        sources in any_sources(), (rule, policy) in prop::sample::select(admitted()),
    ) {
        let rounded: Vec<InterestMass<f32>> = sources.iter().map(|source| source.to()).collect();
        let exact: Vec<InterestMass> = rounded.iter().map(|source| source.to()).collect();
        let (single, double) = (rule.fuse(&rounded, policy), rule.fuse(&exact, policy));
        prop_assert!(close(single.mass.masses(), double.mass.masses(), 1e-6), "{rule} {single:?} {double:?}");
    }

    #[test]
    fn weights_of_the_average_need_not_sum_to_one(
        sources in any_sources(), scale in 0.1..10.0_f64, weights in prop::collection::vec(0.1..1.0_f64, 5),
    ) {
        let scaled: Vec<f64> = weights.iter().map(|weight| weight * scale).take(sources.len()).collect();
        let settings = Settings::default().with_weights(&scaled);
        let fused = Rule::Average.fuse_with(&sources, ParadoxPolicy::ToEmpty, &settings).expect("weights");
        let masses: Vec<[f64; 4]> = sources.iter().map(InterestMass::masses).collect();
        prop_assert!(close(fused.mass.masses(), mean(&masses, &weights[..sources.len()]), SAME));
    }

    /// From Yager's rule at 0 over the default to what Dempster's rule makes of no ignorance.
    #[test]
    fn inagaki_moves_from_yager_to_no_ignorance_gained(sources in any_sources(), k in 0.0..3.0_f64) {
        let by = |k: f64| {
            let settings = Settings::default().with_inagaki_k(k);
            Rule::Inagaki.fuse_with(&sources, ParadoxPolicy::Split, &settings).expect("a k").mass
        };
        prop_assert!(close(by(0.0).masses(), Rule::Yager.fuse(&sources, ParadoxPolicy::Split).mass.masses(), SAME));
        let [i, n, u, conflict] = Rule::Conjunctive.fuse(&sources, ParadoxPolicy::Split).mass.masses();
        let limit = if i + n > 0.0 { 1.0 / (i + n) } else { f64::INFINITY };
        let k = k.min(limit);
        let grown = 1.0 + k * conflict;
        let expected = [i * grown, n * grown, u * grown + (grown - k) * conflict, 0.0];
        prop_assert!(close(by(k).masses(), expected, SAME));
        if limit.is_finite() {
            // Beyond the limit nothing changes: ignorance keeps what the sources agreed on.
            prop_assert!((by(limit + 1.0).ignorance() - u).abs() < SAME);
        }
    }
}

/// The sum over all assignments by an integral, and one by one.
#[test]
fn pcr6_of_many_sources_is_within_1e_12_of_its_definition() {
    let sources: Vec<InterestMass> =
        (0..10_u32).map(|s| mass([(s * 7 + 3) % 11, (s * 5 + 1) % 7, (s * 3) % 5, 0])).collect();
    for count in [9, 10] {
        let masses: Vec<[f64; 4]> = sources[..count].iter().map(InterestMass::masses).collect();
        for rule in [Rule::Pcr6, Rule::Pcr6Plus] {
            let fused = rule.fuse(&sources[..count], ParadoxPolicy::ToIgnorance).mass;
            let expected = by_definition(rule, &masses).expect("always defined");
            assert!(
                close(fused.masses(), expected, 1e-12),
                "{rule} {count} {fused:?} {expected:?}"
            );
        }
    }
}

/// The point (67, 20) of the paper's Table 6: gradient, texture, temperature, discounted.
fn table_6() -> [InterestMass; 3] {
    [[0.8, 0.05, 0.0, 0.15], [0.323, 0.0, 0.66, 0.017], [0.0, 0.648, 0.19, 0.162]]
        .map(|masses| InterestMass::from_masses(masses).expect("they sum to 1"))
}

/// m(I), m(NI) and BetP(I) at the paper's point, to four decimals: the choice of the rule is worth as much as
/// the evidence.
#[test]
fn the_rule_decides_how_interesting_the_rock_border_is() {
    let expected = [
        (Rule::Yager, [0.2987, 0.0997, 0.5995]),
        (Rule::DuboisPrade, [0.2987, 0.0997, 0.5995]),
        (Rule::Pcr5, [0.4996, 0.3459, 0.5769]),
        (Rule::Pcr6, [0.5518, 0.2936, 0.6291]),
        (Rule::Pcr5Plus, [0.5652, 0.3991, 0.5830]),
        (Rule::Pcr6Plus, [0.6174, 0.3468, 0.6353]),
        (Rule::Pcr1, [0.5105, 0.2313, 0.6396]),
        (Rule::Pcr4, [0.7230, 0.2413, 0.7409]),
        (Rule::Average, [0.3743, 0.2327, 0.5708]),
        (Rule::Murphy, [0.6149, 0.2896, 0.6626]),
        (Rule::Deng, [0.6713, 0.2238, 0.7237]),
        (Rule::Zhang, [0.7123, 0.2223, 0.7450]),
        (Rule::Florea, [0.1718, 0.0573, 0.5573]),
        (Rule::Cautious, [0.2964, 0.1023, 0.7136]),
    ];
    for (rule, expected) in expected {
        let mass = rule.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass;
        let found = [mass.interesting(), mass.not_interesting(), mass.pignistic(&rule.model())];
        let close = found.iter().zip(expected).all(|(found, e)| (found - e).abs() <= 5.1e-5);
        assert!(close, "{rule}: {found:?}");
    }
    let empty = Rule::Cautious.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass.paradox();
    assert!((empty - 0.5457).abs() < 5e-5);
    let dsmc = Rule::Dsmc.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass;
    assert!((dsmc.belief() - 0.9723).abs() < 5e-5);
}

/// Masses as they come under each policy; the last by the hybrid rule.
#[test]
fn the_paradox_policy_decides_it_too() {
    let expected = [
        (Rule::Dempster, ParadoxPolicy::ToIgnorance, [0.6881, 0.2296, 0.0824]),
        (Rule::Dempster, ParadoxPolicy::Split, [0.7538, 0.2462, 0.0]),
        (Rule::Dempster, ParadoxPolicy::Renormalise, [0.8438, 0.1562, 0.0]),
        // An open world scales up in the end what the policy before scaled up first.
        (Rule::Dempster, ParadoxPolicy::ToEmpty, [0.8438, 0.1562, 0.0]),
        (Rule::Dsmh, ParadoxPolicy::KeepForDsmh, [0.2013, 0.0300, 0.7687]),
    ];
    for (rule, policy, expected) in expected {
        let [i, n, u, _] = rule.fuse(&table_6(), policy).mass.masses();
        let close = [i, n, u].iter().zip(expected).all(|(found, e)| (found - e).abs() <= 5.1e-5);
        assert!(close, "{rule} {policy}: {:?}", [i, n, u]);
    }
}

#[test]
fn calls_that_make_no_sense_are_refused() {
    let sources = [InterestMass::VACUOUS; 9];
    let call =
        |rule: Rule, policy, settings: &Settings<'_>| rule.fuse_with(&sources, policy, settings);
    let plain = Settings::default();
    assert_eq!(
        call(Rule::Dempster, ParadoxPolicy::KeepForDsmh, &plain),
        Err(BeliefError::PolicyNotAdmitted {
            rule: Rule::Dempster,
            policy: ParadoxPolicy::KeepForDsmh
        })
    );
    assert_eq!(
        call(Rule::Pcr5, ParadoxPolicy::Split, &plain),
        Err(BeliefError::TooManySources { sources: 9, limit: 8, rule: Rule::Pcr5 })
    );
    let parameter =
        |rule: Rule, settings: &Settings<'_>| match call(rule, ParadoxPolicy::Split, settings) {
            Err(BeliefError::Parameter { name, value, .. }) => (name, value),
            other => panic!("{other:?}"),
        };
    for k in [-1.0, f64::INFINITY] {
        assert_eq!(parameter(Rule::Inagaki, &plain.with_inagaki_k(k)), ("inagaki_k", k));
    }
    assert_eq!(parameter(Rule::Average, &plain.with_weights(&[1.0])), ("weights", 1.0));
    let mut weights = [1.0; 9];
    weights[4] = -0.5;
    assert_eq!(parameter(Rule::Average, &plain.with_weights(&weights)), ("weights", -0.5));
    assert!(call(Rule::Average, ParadoxPolicy::Split, &plain.with_weights(&[0.0; 9])).is_err());
    assert!(call(Rule::Pcr6, ParadoxPolicy::Split, &plain).is_ok());
}

/// Only the belief that is not on ∅ counts under Shafer's model.
#[test]
fn belief_under_shafers_model_does_not_count_the_empty_element() {
    let fused = Rule::Conjunctive.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass;
    assert_eq!(fused.belief_under(&Rule::Conjunctive.model()), fused.interesting());
    assert_eq!(fused.belief(), fused.interesting() + fused.paradox());
    let free = Rule::Dsmc.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass;
    assert_eq!(free.belief_under(&Rule::Dsmc.model()), free.paradox() + free.interesting());
}
