//! Laws of the rules of combination on random bodies of exact rationals, and an example for each law that a rule
//! does not keep.

#[path = "definition/rational.rs"]
mod rational;

use std::collections::BTreeMap;

use proptest::prelude::*;
use rational::Exact;
use wisdom_belief::{BeliefError, Frame, MassFunction, Number, Rule, Settings, rule};

type Mass = MassFunction<Exact>;

/// Rules under which two at a time, in any order, is all at once.
const ASSOCIATIVE: [Rule; 7] = [
    Rule::Dsmc,
    Rule::Conjunctive,
    Rule::Dempster,
    Rule::Zhang,
    Rule::Disjunctive,
    Rule::Cautious,
    Rule::Bold,
];

/// Rules under which a source that knows nothing changes nothing.
const VACUOUS_IS_NEUTRAL: [Rule; 13] = [
    Rule::Dsmc,
    Rule::Conjunctive,
    Rule::Dempster,
    Rule::Zhang,
    Rule::Yager,
    Rule::Inagaki,
    Rule::Pcr2,
    Rule::Pcr3,
    Rule::Pcr4,
    Rule::Pcr5Plus,
    Rule::Pcr6Plus,
    Rule::Pcr5Canonical,
    Rule::Pcr6Canonical,
];

/// Rules under which a source combined with itself says the same.
const IDEMPOTENT: [Rule; 3] = [Rule::Cautious, Rule::Bold, Rule::Average];

/// Rules that do something else than meet even where nothing conflicts.
const NOT_CONJUNCTIVE_IN_AGREEMENT: [Rule; 8] = [
    Rule::Disjunctive,
    Rule::Average,
    Rule::Murphy,
    Rule::Deng,
    Rule::Zhang,
    Rule::Jaccard,
    Rule::Cautious,
    Rule::Bold,
];

const ABC: [&str; 3] = ["A", "B", "C"];

fn abc() -> Frame {
    Frame::shafer(ABC).expect("a frame")
}

fn ab() -> Frame {
    Frame::shafer(["A", "B"]).expect("a frame")
}

fn free() -> Frame {
    Frame::free(ABC).expect("a frame")
}

/// A mass function from whole weights.
fn body<F: Number>(frame: &Frame, weights: &[(&str, u32)]) -> MassFunction<F> {
    let all = F::count(weights.iter().map(|&(_, weight)| weight).sum());
    MassFunction::parse(frame, weights.iter().map(|&(text, weight)| (text, F::count(weight) / all)))
        .expect("masses that sum to 1")
}

/// Three sources with conflicts of two and of three, and some ignorance; none of them leans on another.
fn three(frame: &Frame) -> [Mass; 3] {
    [
        body(frame, &[("A", 3), ("B", 1), ("A | B", 2), ("Theta", 2)]),
        body(frame, &[("B", 2), ("A | C", 3), ("Theta", 1)]),
        body(frame, &[("C", 4), ("A", 1), ("B | C", 1), ("Theta", 1)]),
    ]
}

/// The same three, who each allow that no hypothesis is true: the bold rule asks for that.
fn three_for(rule: Rule, frame: &Frame) -> [Mass; 3] {
    if rule != Rule::Bold {
        return three(frame);
    }
    [
        body(frame, &[("empty", 2), ("A", 3), ("A | B", 1)]),
        body(frame, &[("empty", 1), ("B", 1), ("A | C", 2)]),
        body(frame, &[("empty", 4), ("C", 1), ("A | B", 1)]),
    ]
}

fn combine(rule: Rule, sources: &[Mass], frame: &Frame) -> Result<Mass, BeliefError> {
    rule::combine(rule, sources, frame)
}

fn fold(rule: Rule, sources: &[Mass], frame: &Frame) -> Result<Mass, BeliefError> {
    rule::fold(rule, sources, frame, &Settings::default())
}

/// Two answers are the same masses, exactly, or undefined for the same reason (whose details, such as how many
/// sources were at it, may differ).
fn same(a: &Result<Mass, BeliefError>, b: &Result<Mass, BeliefError>) -> bool {
    match (a, b) {
        (Ok(a), Ok(b)) => a == b,
        (Err(a), Err(b)) => std::mem::discriminant(a) == std::mem::discriminant(b),
        _ => false,
    }
}

/// Elements that sources name, by number, and their weights. Those that the model empties stand for Θ.
type Sayings = Vec<Vec<(usize, u32)>>;

const NAMED: [&str; 10] =
    ["A", "B", "C", "A | B", "B | C", "A | C", "A & B", "A & C | B", "C & (A | B)", "Theta"];

fn sayings(sources: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Sayings> {
    let saying = prop::collection::vec((0..NAMED.len(), 1..=9_u32), 1..=4);
    prop::collection::vec(saying, sources)
}

fn frames() -> [Frame; 4] {
    let hybrid = |empty: &[&str]| Frame::with_empty(ABC, empty).expect("a frame");
    [free(), abc(), hybrid(&["A & B"]), hybrid(&["A & C", "B & C"])]
}

fn any_frame() -> impl Strategy<Value = Frame> {
    prop::sample::select(frames().to_vec())
}

fn any_rule() -> impl Strategy<Value = Rule> {
    prop::sample::select(Rule::ALL.to_vec())
}

/// The sources on a frame; with mass on Θ for the cautious rule and on ∅ for the bold one.
fn bodies(sayings: &Sayings, frame: &Frame, rule: Rule) -> Vec<Mass> {
    let body = |saying: &Vec<(usize, u32)>| {
        let mut weights = BTreeMap::new();
        for &(name, weight) in saying {
            let named = frame.parse(NAMED[name]).expect("an element");
            let element = if named.is_empty() { frame.theta() } else { named };
            *weights.entry(element).or_insert(0) += weight;
        }
        match rule {
            Rule::Cautious => *weights.entry(frame.theta()).or_insert(0) += 1,
            Rule::Bold => *weights.entry(wisdom_belief::Element::EMPTY).or_insert(0) += 1,
            _ => (),
        }
        let all = weights.values().sum();
        let masses =
            weights.into_iter().map(|(element, weight)| (element, Exact::ratio(weight, all)));
        MassFunction::new(frame, masses).expect("masses that sum to 1")
    };
    sayings.iter().map(body).collect()
}

proptest! {
    #[test]
    fn the_order_of_the_sources_does_not_matter(
        (sayings, shuffled) in sayings(2..=4).prop_flat_map(|s| (Just(s.clone()), Just(s).prop_shuffle())),
        frame in any_frame(),
    ) {
        for rule in Rule::ALL {
            Exact::forget_all();
            let of = |sayings| combine(rule, &bodies(sayings, &frame, rule), &frame);
            prop_assert!(same(&of(&sayings), &of(&shuffled)), "{}", rule);
        }
    }

    /// Without a model learned later no mass is lost: Dubois and Prade's and Florea's rules included.
    #[test]
    fn fused_masses_are_positive_and_sum_to_one(
        sayings in sayings(1..=4), frame in any_frame(), rule in any_rule(),
    ) {
        Exact::forget_all();
        if let Ok(fused) = combine(rule, &bodies(&sayings, &frame, rule), &frame) {
            prop_assert_eq!(fused.sum(), Exact::one());
            prop_assert!(fused.focal().iter().all(|&(_, mass)| mass > Exact::zero()));
        }
    }

    #[test]
    fn a_vacuous_source_is_neutral_where_the_literature_says_so(
        sayings in sayings(1..=3), frame in any_frame(), at in 0..3_usize,
    ) {
        for rule in VACUOUS_IS_NEUTRAL {
            Exact::forget_all();
            let sources = bodies(&sayings, &frame, rule);
            let mut more = sources.clone();
            more.insert(at.min(sources.len()), MassFunction::vacuous(&frame));
            let (less, more) = (combine(rule, &sources, &frame), combine(rule, &more, &frame));
            prop_assert!(same(&less, &more), "{rule}: {less:?} {more:?}");
        }
    }

    #[test]
    fn associative_rules_take_sources_two_at_a_time_in_any_order(
        (sayings, shuffled) in sayings(2..=4).prop_flat_map(|s| (Just(s.clone()), Just(s).prop_shuffle())),
        frame in any_frame(),
    ) {
        for rule in ASSOCIATIVE {
            Exact::forget_all();
            let at_once = combine(rule, &bodies(&sayings, &frame, rule), &frame);
            let folded = fold(rule, &bodies(&shuffled, &frame, rule), &frame);
            prop_assert!(same(&at_once, &folded), "{rule}: {at_once:?} {folded:?}");
        }
    }

    #[test]
    fn who_repeats_himself_adds_nothing_under_idempotent_rules(
        sayings in sayings(1..=2), frame in any_frame(),
    ) {
        for rule in IDEMPOTENT {
            Exact::forget_all();
            let sources = bodies(&sayings, &frame, rule);
            prop_assert_eq!(combine(rule, &[sources[0].clone(), sources[0].clone()], &frame), Ok(sources[0].clone()));
            let repeated = [&sources[..], &sources[..]].concat();
            let (once, twice) = (combine(rule, &sources, &frame), combine(rule, &repeated, &frame));
            prop_assert!(same(&once, &twice), "{rule}: {once:?} {twice:?}");
        }
    }

    #[test]
    fn one_source_alone_is_what_it_is(sayings in sayings(1..=1), frame in any_frame()) {
        for rule in Rule::ALL.into_iter().filter(|&rule| rule != Rule::Dsmc || frame.is_free()) {
            Exact::forget_all();
            let sources = bodies(&sayings, &frame, rule);
            prop_assert_eq!(combine(rule, &sources, &frame), Ok(sources[0].clone()), "{}", rule);
        }
    }

    /// No intersection is empty there, so nothing conflicts.
    #[test]
    fn on_the_free_model_rules_about_conflict_are_dsmc(sayings in sayings(1..=4)) {
        let frame = free();
        for rule in Rule::ALL.into_iter().filter(|rule| !NOT_CONJUNCTIVE_IN_AGREEMENT.contains(rule)) {
            Exact::forget_all();
            let sources = bodies(&sayings, &frame, rule);
            prop_assert_eq!(combine(rule, &sources, &frame), combine(Rule::Dsmc, &sources, &frame), "{}", rule);
        }
    }

    #[test]
    fn two_sources_share_conflicts_alike_under_pcr5_and_pcr6(
        sayings in sayings(2..=2), frame in any_frame(),
    ) {
        Exact::forget_all();
        let sources = bodies(&sayings, &frame, Rule::Pcr5);
        let pcr5 = combine(Rule::Pcr5, &sources, &frame);
        let others =
            [Rule::Pcr6, Rule::Pcr5Plus, Rule::Pcr6Plus, Rule::Pcr5Canonical, Rule::Pcr6Canonical];
        for rule in others {
            prop_assert_eq!(&combine(rule, &sources, &frame), &pcr5, "{}", rule);
        }
    }

    /// Of the conflicts on two exclusive atoms only Θ can take no part.
    #[test]
    fn on_two_atoms_keeping_is_being_minimal(sayings in sayings(1..=4)) {
        Exact::forget_all();
        let frame = Frame::with_empty(ABC, &["A & B", "C"]).expect("a frame");
        let sources = bodies(&sayings, &frame, Rule::Pcr5Plus);
        let by = |rule| combine(rule, &sources, &frame).expect("defined for all");
        prop_assert_eq!(by(Rule::Pcr5Plus), by(Rule::Pcr5Canonical));
        prop_assert_eq!(by(Rule::Pcr6Plus), by(Rule::Pcr6Canonical));
        let doubts = sources.iter().map(|source| source.mass(frame.theta()));
        let product = doubts.fold(Exact::one(), |product, doubt| product * doubt);
        prop_assert_eq!(by(Rule::Pcr5Plus).mass(frame.theta()), product);
        prop_assert_eq!(by(Rule::Pcr6Plus).mass(frame.theta()), product);
    }

    #[test]
    fn minc_on_two_atoms_is_dempster(sayings in sayings(1..=4)) {
        Exact::forget_all();
        let frame = Frame::with_empty(ABC, &["A & B", "C"]).expect("a frame");
        let sources = bodies(&sayings, &frame, Rule::MinC);
        if let Ok(dempster) = combine(Rule::Dempster, &sources, &frame) {
            prop_assert_eq!(combine(Rule::MinC, &sources, &frame), Ok(dempster));
        }
    }

    #[test]
    fn inagaki_begins_as_yager(sayings in sayings(1..=4), frame in any_frame()) {
        Exact::forget_all();
        let sources = bodies(&sayings, &frame, Rule::Inagaki);
        let settings = Settings::default().with_inagaki_k(0.0);
        let found = rule::combine_with(Rule::Inagaki, &sources, &frame, &settings);
        prop_assert_eq!(found, combine(Rule::Yager, &sources, &frame));
    }

    /// Florea's two weights belong to the right masses: no conflict leaves the conjunctive ones, and there are
    /// no others when all is conflict.
    #[test]
    fn florea_turns_from_conjunctive_to_disjunctive_as_conflict_grows(sayings in sayings(2..=3), frame in any_frame()) {
        Exact::forget_all();
        let sources = bodies(&sayings, &frame, Rule::Florea);
        let by = |rule| combine(rule, &sources, &frame).expect("defined for all");
        let conflict = rule::conflict(&sources, &frame).expect("one frame");
        let florea = by(Rule::Florea);
        prop_assert_eq!(florea.sum(), Exact::one());
        if conflict == Exact::zero() {
            prop_assert_eq!(florea, by(Rule::Conjunctive));
        } else if conflict == Exact::one() {
            prop_assert_eq!(florea, by(Rule::Disjunctive));
        }
    }

    #[test]
    fn belief_bounds_pignistic_and_dsmp_and_plausibility(
        sayings in sayings(1..=1), frame in any_frame(), epsilon in 1..=9_u32,
    ) {
        Exact::forget_all();
        let m = &bodies(&sayings, &frame, Rule::Dempster)[0];
        for atom in (0..3).filter_map(|atom| frame.atom(atom)) {
            let (belief, plausibility) = (m.belief(atom), m.plausibility(atom));
            for probability in [m.pignistic(atom), m.dsmp(atom, Exact::ratio(epsilon, 10))] {
                prop_assert!(belief <= probability && probability <= plausibility);
            }
            prop_assert!(m.commonality(atom) <= plausibility);
        }
    }
}

#[test]
fn other_rules_are_swayed_by_a_vacuous_source() {
    let frame = abc();
    for rule in Rule::ALL.into_iter().filter(|rule| !VACUOUS_IS_NEUTRAL.contains(rule)) {
        let mut sources = match rule {
            // Not separable: one of its weights is above 1, and the vacuous one's 1 is less.
            Rule::Cautious => vec![body(&frame, &[("A | B", 1), ("B | C", 1), ("Theta", 2)])],
            Rule::Bold => three_for(rule, &frame)[..2].to_vec(),
            // Neither says anything of Θ: URR gives it a share only if someone does.
            _ => {
                let first = body(&frame, &[("A", 3), ("B", 1), ("C", 1)]);
                vec![first, body(&frame, &[("B", 2), ("A | C", 3)])]
            }
        };
        let before = combine(rule, &sources, &frame).expect("defined for these");
        sources.push(MassFunction::vacuous(&frame));
        let after = combine(rule, &sources, &frame);
        if rule == Rule::Bold {
            assert_eq!(after, Err(BeliefError::Normal { index: 2 }));
        } else {
            assert_ne!(after.expect("defined for these"), before, "{rule}");
        }
    }
}

#[test]
fn the_disjunctive_rule_has_the_impossible_for_its_neutral_source() {
    let frame = abc();
    let [a, b, _] = three(&frame);
    let silent = body(&frame, &[("empty", 1)]);
    let fused = combine(Rule::Disjunctive, &[a.clone(), b.clone()], &frame);
    assert_eq!(combine(Rule::Disjunctive, &[a, silent, b], &frame), fused);
}

/// Folded from the other end they say something else, and neither is what they say all at once.
#[test]
fn other_rules_depend_on_the_order_when_folded() {
    let frame = abc();
    for rule in Rule::ALL.into_iter().filter(|rule| !ASSOCIATIVE.contains(rule)) {
        let [a, b, c] = three(&frame);
        let at_once = combine(rule, &[a.clone(), b.clone(), c.clone()], &frame);
        let forth = fold(rule, &[a.clone(), b.clone(), c.clone()], &frame).expect("defined");
        let back = fold(rule, &[c, b, a], &frame).expect("defined for these");
        assert_ne!(forth, back, "{rule}");
        assert_ne!(at_once.expect("defined for these"), forth, "{rule}");
    }
}

#[test]
fn other_rules_are_not_idempotent() {
    let frame = abc();
    for rule in Rule::ALL.into_iter().filter(|rule| !IDEMPOTENT.contains(rule)) {
        let frame = if rule == Rule::Dsmc { free() } else { frame.clone() };
        let source = body(&frame, &[("A", 3), ("B | C", 1), ("Theta", 1)]);
        let twice = combine(rule, &[source.clone(), source.clone()], &frame);
        assert_ne!(twice.expect("defined for these"), source, "{rule}");
    }
}

#[test]
fn the_rest_of_the_rules_are_not_dsmc_on_the_free_model() {
    let frame = free();
    for rule in NOT_CONJUNCTIVE_IN_AGREEMENT {
        let sources = three_for(rule, &frame);
        let found = combine(rule, &sources, &frame).expect("defined for these");
        assert_ne!(Ok(found), combine(Rule::Dsmc, &sources, &frame), "{rule}");
    }
}

/// On {A, B} only Θ holds the others; on a larger frame A ∪ C may take part in a conflict with A and B, and yet
/// hold A.
#[test]
fn on_three_atoms_keeping_is_more_than_being_minimal() {
    let frame = abc();
    let sources =
        [body(&frame, &[("A", 1)]), body(&frame, &[("B", 1)]), body(&frame, &[("A | C", 1)])];
    let of = |rule: Rule, text| {
        let fused = combine(rule, &sources, &frame).expect("defined for all");
        fused.mass(frame.parse(text).expect("an element"))
    };
    assert_eq!(of(Rule::Pcr5Plus, "A | C"), Exact::ratio(1, 3));
    assert_eq!(of(Rule::Pcr6Plus, "A | C"), Exact::ratio(1, 3));
    assert_eq!(of(Rule::Pcr5Canonical, "A | C"), Exact::zero());
    assert_eq!(of(Rule::Pcr6Canonical, "A"), Exact::ratio(1, 2));
}

#[test]
fn minc_on_three_atoms_is_not_dempster() {
    let (frame, sources) = (abc(), three(&abc()));
    assert_ne!(combine(Rule::MinC, &sources, &frame), combine(Rule::Dempster, &sources, &frame));
}

/// K = 1/2, m(Θ) = 1/12: k = 1 / (1 − K) = 2 is Dempster's rule; at the limit 1 / (1 − K − m(Θ)) = 12/5 no
/// conflict becomes ignorance at all.
#[test]
fn inagaki_passes_dempster_on_its_way() {
    let frame = ab();
    let sources =
        [body(&frame, &[("A", 3), ("Theta", 1)]), body(&frame, &[("B", 2), ("Theta", 1)])];
    assert_eq!(rule::conflict(&sources, &frame), Ok(Exact::ratio(1, 2)));
    let by = |k| {
        let settings = Settings::default().with_inagaki_k(k);
        rule::combine_with(Rule::Inagaki, &sources, &frame, &settings)
    };
    assert_eq!(by(2.0), combine(Rule::Dempster, &sources, &frame));
    let ignorance = Exact::ratio(1, 12);
    let limit = 12.0 / 5.0;
    assert!(by(limit + 0.01).is_err(), "Θ would lose mass");
    let near = by(2.375).expect("below the limit").mass(frame.theta());
    assert!(near > ignorance && near < ignorance + Exact::ratio(1, 100), "{near:?}");
}

/// "PCR5 of many sources" names three rules in the literature, which agree on two sources only.
#[test]
fn pcr5_two_at_a_time_all_at_once_and_canonical_are_three_rules() {
    let (frame, sources) = (abc(), three(&abc()));
    let at_once = combine(Rule::Pcr5, &sources, &frame).expect("defined for all");
    let canonical = combine(Rule::Pcr5Canonical, &sources, &frame).expect("defined for all");
    let folded = fold(Rule::Pcr5, &sources, &frame).expect("defined for all");
    assert!(at_once != canonical && canonical != folded && folded != at_once);
}

/// Forty sources of three focal elements make 3^40 products, which no walk would see the end of.
#[test]
fn associative_rules_need_no_walk_over_all_products() {
    let frame = free();
    let source = body::<f64>(&frame, &[("A", 1), ("A | B", 1), ("Theta", 2)]);
    let open = body::<f64>(&frame, &[("empty", 1), ("A | B", 1), ("A", 2)]);
    let many = [Rule::Yager, Rule::Pcr1, Rule::Florea, Rule::Murphy, Rule::Average];
    for rule in ASSOCIATIVE.into_iter().chain(many) {
        let source = if rule == Rule::Bold { &open } else { &source };
        let fused = rule::combine(rule, &vec![source.clone(); 40], &frame);
        let sum = fused.expect("nothing conflicts").sum();
        // Forty sums of a few products each.
        assert!((sum - 1.0).abs() < 1e-13, "{rule}: {sum}");
    }
}

/// Masses far below any threshold count: m(A) of the second source is 1e-14 and all that speaks for A against B.
#[test]
fn pcr_drops_no_mass_however_small() {
    let frame = ab();
    let tiny = 1e-14_f64;
    let sources = [
        MassFunction::parse(&frame, [("A", tiny), ("Theta", 1.0 - tiny)]).expect("they sum to 1"),
        MassFunction::parse(&frame, [("B", 1.0)]).expect("a mass"),
    ];
    for rule in [Rule::Pcr5, Rule::Pcr6, Rule::Pcr5Plus, Rule::Pcr6Plus, Rule::Pcr5Canonical] {
        let fused = rule::combine(rule, &sources, &frame).expect("defined for all");
        let (a, share) =
            (fused.mass(frame.parse("A").expect("an atom")), tiny * tiny / (1.0 + tiny));
        assert!((a - share).abs() < 1e-14 * share, "{rule}: m(A) is {a:e}, not {share:e}");
    }
}

/// Near total conflict 1 − K keeps a few digits only; the sum of what survives keeps them all.
#[test]
fn dempster_keeps_its_digits_near_total_conflict() {
    let frame = ab();
    let tiny = 1e-13_f64;
    let towards = |text| {
        MassFunction::parse(&frame, [(text, 1.0 - tiny), ("Theta", tiny)]).expect("they sum to 1")
    };
    let fused = rule::combine(Rule::Dempster, &[towards("A"), towards("B")], &frame);
    let exact = (1.0 - tiny) / (2.0 - tiny);
    for text in ["A", "B"] {
        let found = fused.as_ref().expect("not total").mass(frame.parse(text).expect("an atom"));
        assert!((found - exact).abs() < 1e-15, "{found}");
    }
}

#[test]
fn total_conflict_leaves_scaled_rules_undefined_and_all_others_defined() {
    let frame = abc();
    let sources: [Mass; 2] = [body(&frame, &[("A", 1)]), body(&frame, &[("B", 1), ("C", 1)])];
    for rule in [Rule::Dempster, Rule::Zhang, Rule::Jaccard] {
        let error = BeliefError::TotalConflict { sources: 2, rule };
        assert_eq!(combine(rule, &sources, &frame), Err(error));
    }
    for rule in Rule::ALL {
        let fused = combine(rule, &sources, &frame);
        match rule {
            Rule::Dempster | Rule::Zhang | Rule::Jaccard => (),
            Rule::Dsmc => assert!(matches!(fused, Err(BeliefError::NotFreeModel { .. }))),
            Rule::Cautious => assert_eq!(fused, Err(BeliefError::Dogmatic { index: 0 })),
            Rule::Bold => assert_eq!(fused, Err(BeliefError::Normal { index: 0 })),
            _ => assert_eq!(fused.expect("defined for all").sum(), Exact::one(), "{rule}"),
        }
    }
}

/// A mean of sources who hold that nothing can be true has nothing to scale up either.
#[test]
fn murphy_is_undefined_when_all_mass_is_on_the_impossible() {
    let frame = abc();
    let nothing: Mass = body(&frame, &[("empty", 1)]);
    for rule in [Rule::Dempster, Rule::Murphy] {
        let error = BeliefError::TotalConflict { sources: 2, rule };
        assert_eq!(combine(rule, &[nothing.clone(), nothing.clone()], &frame), Err(error));
    }
}

#[test]
fn a_dogmatic_source_has_no_conjunctive_weights_and_a_normal_one_no_disjunctive() {
    let frame = abc();
    let [first, ..] = three(&frame);
    let dogmatic = body(&frame, &[("A", 1), ("B | C", 2)]);
    let error = Err(BeliefError::Dogmatic { index: 1 });
    assert_eq!(combine(Rule::Cautious, &[first.clone(), dogmatic], &frame), error);
    let [open, ..] = three_for(Rule::Bold, &frame);
    assert_eq!(combine(Rule::Bold, &[open, first], &frame), Err(BeliefError::Normal { index: 1 }));
}

#[test]
fn the_classic_rule_asks_for_the_free_model() {
    let hybrid = Frame::with_empty(ABC, &["A & B"]).expect("a frame");
    for frame in [abc(), hybrid] {
        let refused = combine(Rule::Dsmc, &[MassFunction::vacuous(&frame)], &frame);
        assert_eq!(refused, Err(BeliefError::NotFreeModel { atoms: "A, B, C".to_owned() }));
    }
}

#[test]
fn rules_that_give_mass_on_the_impossible_no_meaning_refuse_it() {
    let open_world = [
        Rule::Conjunctive,
        Rule::Dempster,
        Rule::Disjunctive,
        Rule::Average,
        Rule::Murphy,
        Rule::Cautious,
        Rule::Bold,
    ];
    let frame = free();
    let open: Mass = body(&frame, &[("empty", 1), ("A", 1), ("Theta", 2)]);
    for rule in Rule::ALL {
        let fused = combine(rule, &[open.clone(), open.clone()], &frame);
        if open_world.contains(&rule) {
            assert!(fused.is_ok(), "{rule}: {fused:?}");
        } else {
            assert_eq!(fused, Err(BeliefError::MassOnEmpty { index: 0, mass: 0.25, rule }));
        }
    }
}

/// What the library says of its rules is what is shown here.
#[test]
fn the_stated_algebra_of_each_rule_is_the_one_it_obeys() {
    for rule in Rule::ALL {
        let stated = rule.algebra();
        assert_eq!(stated.associative, ASSOCIATIVE.contains(&rule), "{rule}");
        assert_eq!(stated.vacuous_is_neutral, VACUOUS_IS_NEUTRAL.contains(&rule), "{rule}");
        assert_eq!(stated.idempotent, IDEMPOTENT.contains(&rule), "{rule}");
    }
}

#[test]
fn no_sources_say_nothing() {
    for rule in Rule::ALL {
        let frame = if rule == Rule::Dsmc { free() } else { abc() };
        assert_eq!(combine(rule, &[], &frame), Ok(MassFunction::vacuous(&frame)), "{rule}");
        assert_eq!(fold(rule, &[], &frame), Ok(MassFunction::vacuous(&frame)), "{rule}");
    }
}
