//! What is done with a mass function before and after combination: laws, which hold exactly on rationals under every
//! model, and what is refused. (Published examples are in `vectors.rs`.)

mod bodies;

use bodies::{Ratio, any_bodies, body};
use proptest::prelude::*;
use wisdom_belief::{BeliefError, Element, Frame, MassFunction, Number, Rule, Uncertainty, rule};

fn ab() -> Frame {
    Frame::shafer(["A", "B"]).expect("a frame")
}

fn mass(frame: &Frame, masses: &[(&'static str, f64)]) -> MassFunction {
    MassFunction::parse(frame, masses.iter().copied()).expect("masses")
}

/// By hand: Bel(A) = 1/4, Pl(A) = 1, Pl(B) = 3/4; A is half of the union, so the sums of discord and strife are
/// 1/4 + 3/8 for A and 1/8 + 3/4 for the union.
#[test]
fn entropies_of_a_small_body_are_those_of_their_formulas() {
    let m = mass(&ab(), &[("A", 0.25), ("A | B", 0.75)]);
    let check = |name: &str, found: Result<f64, BeliefError>, wanted: f64| {
        let found = found.expect(name);
        assert!((found - wanted).abs() < 1e-12, "{name}: {found}, not {wanted}");
    };
    let shannon = |p: f64| -p * p.log2() - (1.0 - p) * (1.0 - p).log2();
    check("confusion", m.confusion(), 0.5);
    check("dissonance", m.dissonance(), 0.0);
    check("Nguyen", m.nguyen_entropy(), shannon(0.25));
    check("Deng", m.deng_entropy(), shannon(0.25) + 0.75 * 3_f64.log2());
    check("nonspecificity", m.nonspecificity(), 0.75);
    check("discord", m.discord(), -0.25 * 0.625_f64.log2());
    check("strife", m.strife(), -0.75 * 0.875_f64.log2());
    check("ambiguity", m.ambiguity(&ab()), shannon(0.625));
    check("Jiroušek-Shenoy", m.jirousek_shenoy_entropy(&ab()), shannon(4.0 / 7.0) + 0.75);
}

#[test]
fn a_probability_has_shannons_entropy_by_every_measure_of_conflict() {
    let frame = Frame::shafer(["A", "B", "C"]).expect("a frame");
    let m = mass(&frame, &[("A", 0.5), ("B", 0.25), ("C", 0.25)]);
    for (name, found) in [
        ("confusion", m.confusion()),
        ("dissonance", m.dissonance()),
        ("Nguyen", m.nguyen_entropy()),
        ("Deng", m.deng_entropy()),
        ("discord", m.discord()),
        ("strife", m.strife()),
        ("ambiguity", m.ambiguity(&frame)),
        ("Jiroušek-Shenoy", m.jirousek_shenoy_entropy(&frame)),
    ] {
        assert!((found.expect(name) - 1.5).abs() < 1e-12, "{name}");
    }
    assert_eq!(m.nonspecificity(), Ok(0.0));
}

#[test]
fn entropies_are_of_a_closed_world() {
    let m = mass(&ab(), &[("empty", 0.25), ("A", 0.75)]);
    let refused = m.deng_entropy().expect_err("mass on the empty element").to_string();
    assert_eq!(refused, "m(empty) is 0.25; Deng entropy is defined only where it is 0");
    for found in [
        m.nonspecificity(),
        m.nguyen_entropy(),
        m.confusion(),
        m.dissonance(),
        m.discord(),
        m.strife(),
        m.ambiguity(&ab()),
        m.jirousek_shenoy_entropy(&ab()),
    ] {
        assert!(matches!(found, Err(BeliefError::EmptyHasMass { mass: 0.25, .. })), "{found:?}");
    }
}

#[test]
fn opposite_certainties_are_as_far_apart_as_can_be() {
    let [a, b, nothing] = ["A", "B", "empty"].map(|text| mass(&ab(), &[(text, 1.0)]));
    assert_eq!(a.jousselme_distance(&b), 1.0);
    assert_eq!(nothing.jousselme_distance(&a), 1.0);
    assert_eq!(nothing.jousselme_distance(&nothing), 0.0);
    assert_eq!(
        [a.conflict_with(&b), a.conflict_with(&a), nothing.conflict_with(&a)],
        [1.0, 0.0, 1.0]
    );
}

#[test]
fn impossible_conditions_are_refused() {
    let m = mass(&ab(), &[("A", 1.0)]);
    let b = ab().parse("B").expect("an atom");
    let refused = m.conditioned(b, &ab()).expect_err("Pl(B) = 0").to_string();
    assert_eq!(refused, "Pl(B) is 0; conditioning on it needs more");
    let open = m.conditioned_unnormalised(b, &ab()).expect("defined");
    assert_eq!(open.conflict(), 1.0);
    let foreign = Frame::free(["A", "B", "C"]).expect("a frame").theta();
    let refused = m.conditioned(foreign, &ab());
    assert!(matches!(refused, Err(BeliefError::ForeignElement { .. })));
}

#[test]
fn what_was_not_combined_cannot_be_taken_back() {
    let certain = mass(&ab(), &[("A", 1.0)]);
    let part = mass(&ab(), &[("A", 0.5), ("Theta", 0.5)]);
    let vacuous = MassFunction::vacuous(&ab());
    assert_eq!(part.decombined(&certain, &ab()), Err(BeliefError::Dogmatic { index: 1 }));
    let refused = vacuous.decombined(&part, &ab()).expect_err("no such source").to_string();
    assert_eq!(refused, "without that source m(A) would be -1; it must be at least 0");
    assert!(matches!(
        vacuous.decombined_normalised(&part, &ab()),
        Err(BeliefError::NotDecombinable { .. })
    ));
}

#[test]
fn what_was_not_discounted_cannot_be_restored() {
    let m = mass(&ab(), &[("A", 0.75), ("Theta", 0.25)]);
    for u in [0.5, 1.0] {
        let refused = m.undiscounted(Uncertainty::new(u).expect("in [0, 1]"), &ab());
        assert_eq!(refused, Err(BeliefError::NotDiscounted { ignorance: 0.25, uncertainty: u }));
    }
    assert!(MassFunction::<f64>::vacuous(&ab()).undiscounted(Uncertainty::UNKNOWN, &ab()).is_err());
}

#[test]
fn bad_contexts_are_refused() {
    let (frame, m) = (ab(), mass(&ab(), &[("A", 1.0)]));
    let a = frame.parse("A").expect("an atom");
    let repeated = m.contextually_discounted(&[(a, 0.5), (a, 0.5)], &frame);
    assert_eq!(repeated, Err(BeliefError::RepeatedElement { element: "A".to_owned() }));
    for reliability in [-0.1, 1.1, f64::NAN] {
        let refused = m.contextually_reinforced(&[(a, reliability)], &frame);
        assert!(matches!(refused, Err(BeliefError::Parameter { name: "reliability", .. })));
    }
}

#[test]
fn weights_need_ignorance_or_contradiction() {
    let (frame, m) = (ab(), mass(&ab(), &[("A", 1.0)]));
    assert_eq!(m.conjunctive_weights(&frame), Err(BeliefError::Dogmatic { index: 0 }));
    assert_eq!(m.disjunctive_weights(&frame), Err(BeliefError::Normal { index: 0 }));
    let sources = [MassFunction::vacuous(&frame), m];
    let dogmatic = rule::combine(Rule::Cautious, &sources, &frame);
    assert_eq!(dogmatic, Err(BeliefError::Dogmatic { index: 1 }));
    assert_eq!(rule::combine(Rule::Bold, &sources, &frame), Err(BeliefError::Normal { index: 0 }));
    assert_eq!(
        rule::combine(Rule::Cautious, &[], &frame),
        Ok(MassFunction::<f64>::vacuous(&frame))
    );
}

#[test]
fn regions_are_named_by_the_atoms_they_lie_in() {
    let frame = Frame::with_empty(["A", "B", "C"], &["A & C"]).expect("a frame");
    let names: Vec<String> =
        frame.regions().map(|region| frame.atoms_of(region).join(" ")).collect();
    assert_eq!(names, ["A", "B", "A B", "C", "B C"]);
    for region in frame.regions() {
        assert_eq!(frame.region(&frame.atoms_of(region)), Ok(region));
    }
    let error = |atoms: &[&str]| frame.region(atoms).expect_err("no region").to_string();
    assert_eq!(
        error(&["A", "C"]),
        "no region inside exactly {A, C}; a region lies in one atom at least, and the model of the frame \
         {A, B, C} must not empty it"
    );
    assert!(error(&[]).starts_with("no region inside exactly {}"));
    assert_eq!(error(&["A", "D"]), "unknown atom `D`; known: A, B, C");
    assert_eq!(error(&["A", "A"]), "atom `A` is named twice");
    let shafer = Frame::shafer((0..64).map(|atom| format!("t{atom}"))).expect("64 atoms");
    let last = shafer.region(&["t63"]).expect("an atom");
    assert_eq!((last.bit(), shafer.atoms_of(last)), (63, vec!["t63"]));
    assert!(matches!(shafer.region(&["t0", "t1"]), Err(BeliefError::NoSuchRegion { .. })));
}

#[test]
fn mass_on_nothing_has_no_probability() {
    let nothing = mass(&ab(), &[("empty", 1.0)]);
    assert_eq!(nothing.pignistic_distribution(&ab()), Err(BeliefError::NothingPossible));
    assert_eq!(nothing.dsmp_distribution(0.1, &ab()), Err(BeliefError::NothingPossible));
    assert_eq!(nothing.plausibility_distribution(&ab()), Err(BeliefError::NothingPossible));
    let m = mass(&ab(), &[("A", 1.0)]);
    let refused = m.dsmp_distribution(f64::NAN, &ab());
    assert!(matches!(refused, Err(BeliefError::Parameter { name: "epsilon", .. })));
    let alone = Frame::free(["A"]).expect("a frame");
    let sure = MassFunction::<f64>::vacuous(&alone).pignistic_distribution(&alone);
    assert_eq!(sure.expect("one region").information_content(), 1.0);
}

/// One source, with mass on Θ and, if asked, on ∅.
fn with_theta(
    frame: &Frame,
    numbers: &[(prop::sample::Index, i128)],
    open: bool,
) -> MassFunction<Ratio> {
    let also: &[Element] = if open { &[frame.theta(), Element::EMPTY] } else { &[frame.theta()] };
    body(frame, numbers, also)
}

/// Masses of some tens of products of numbers near 1, each off by 1e-16.
const ROUNDING: f64 = 1e-13;

fn product(factors: impl Iterator<Item = Ratio>) -> Ratio {
    factors.fold(Ratio::one(), |product, factor| product * factor)
}

/// Some elements of a frame, each with a reliability in quarters.
fn contexts(frame: &Frame, numbers: &[(prop::sample::Index, i128)]) -> Vec<(Element, Ratio)> {
    let elements: Vec<Element> = frame.elements().collect();
    let context = |(index, quarters): &(prop::sample::Index, i128)| {
        (*index.get(&elements), Ratio::new(*quarters, 4))
    };
    numbers.iter().map(context).collect::<std::collections::BTreeMap<_, _>>().into_iter().collect()
}

proptest! {
    /// q(A) is the product of w over what does not hold A; b(A) that of v over what A does not hold.
    #[test]
    fn weights_multiply_to_what_they_decompose(
        (frame, numbers) in any_bodies(1),
        open in any::<bool>(),
    ) {
        let m = with_theta(&frame, &numbers[0], open);
        let w = m.conjunctive_weights(&frame).expect("mass on Θ");
        for a in frame.elements() {
            let outside = w.listed().iter().filter(|(b, _)| !a.is_subset_of(*b));
            prop_assert_eq!(product(outside.map(|&(_, w)| w)), m.commonality(a));
        }
        prop_assert_eq!(m.disjunctive_weights(&frame).is_ok(), open);
        if let Ok(v) = m.disjunctive_weights(&frame) {
            for a in frame.elements() {
                let outside = v.listed().iter().filter(|(b, _)| !b.is_subset_of(a));
                prop_assert_eq!(product(outside.map(|&(_, v)| v)), m.implicability(a));
            }
        }
    }

    #[test]
    fn cautious_and_bold_keep_the_smallest_weights((frame, numbers) in any_bodies(2)) {
        let m = [0, 1].map(|source| with_theta(&frame, &numbers[source], true));
        let cautious = rule::combine(Rule::Cautious, &m, &frame).expect("mass on Θ");
        let bold = rule::combine(Rule::Bold, &m, &frame).expect("mass on ∅");
        let weights = |m: &MassFunction<Ratio>| m.conjunctive_weights(&frame).expect("mass on Θ");
        let ([first, second], fused) = ([&m[0], &m[1]].map(weights), weights(&cautious));
        for a in frame.elements().filter(|&a| a != frame.theta()) {
            prop_assert_eq!(fused.of(a), first.of(a).least(second.of(a)), "w({})", frame.print(a));
        }
        let weights = |m: &MassFunction<Ratio>| m.disjunctive_weights(&frame).expect("mass on ∅");
        let ([first, second], fused) = ([&m[0], &m[1]].map(weights), weights(&bold));
        for a in frame.elements().filter(|a| !a.is_empty()) {
            prop_assert_eq!(fused.of(a), first.of(a).least(second.of(a)), "v({})", frame.print(a));
        }
    }

    /// Nothing cancels, so f64 is as close to the exact masses as its inputs are to theirs.
    #[test]
    fn cautious_and_bold_in_floating_point_are_close_to_exact((frame, numbers) in any_bodies(3)) {
        let exact = [0, 1, 2].map(|source| with_theta(&frame, &numbers[source], true));
        let rounded = exact.clone().map(|m| {
            let masses = m.focal().iter().map(|&(element, mass)| (element, mass.to_f64()));
            MassFunction::new(&frame, masses.collect::<Vec<_>>()).expect("masses")
        });
        for rule in [Rule::Cautious, Rule::Bold] {
            let exact = rule::combine(rule, &exact, &frame).expect("weights");
            let rounded = rule::combine(rule, &rounded, &frame).expect("weights");
            for element in frame.elements() {
                let error = (rounded.mass(element) - exact.mass(element).to_f64()).abs();
                prop_assert!(error < ROUNDING, "{}: {} off by {}", rule, frame.print(element), error);
            }
            prop_assert!((rounded.sum() - 1.0).abs() < ROUNDING);
        }
    }

    #[test]
    fn what_is_said_twice_counts_once((frame, numbers) in any_bodies(1)) {
        let m = with_theta(&frame, &numbers[0], true);
        for rule in [Rule::Cautious, Rule::Bold] {
            let twice = rule::combine(rule, &[m.clone(), m.clone()], &frame);
            prop_assert_eq!(twice.as_ref(), Ok(&m), "{}", rule);
        }
    }

    #[test]
    fn what_was_combined_can_be_taken_back((frame, numbers) in any_bodies(2)) {
        let (rest, part) = (body(&frame, &numbers[0], &[]), with_theta(&frame, &numbers[1], false));
        let both = [rest.clone(), part.clone()];
        let fused = rule::combine(Rule::Conjunctive, &both, &frame).expect("one frame");
        prop_assert_eq!(fused.decombined(&part, &frame), Ok(rest.clone()));
        let fused = rule::combine(Rule::Dempster, &both, &frame).expect("mass on Θ");
        prop_assert_eq!(fused.decombined_normalised(&part, &frame), Ok(rest));
    }

    /// b'(A) = b(A) Π β over contexts that A does not hold; q'(A) = q(A) Π β over those that do not hold A.
    #[test]
    fn contextual_corrections_scale_implicability_and_commonality((frame, numbers) in any_bodies(2)) {
        let (m, contexts) = (body(&frame, &numbers[0], &[]), contexts(&frame, &numbers[1]));
        let discounted = m.contextually_discounted(&contexts, &frame).expect("contexts");
        let reinforced = m.contextually_reinforced(&contexts, &frame).expect("contexts");
        for a in frame.elements() {
            let outside = contexts.iter().filter(|(c, _)| !c.is_subset_of(a)).map(|&(_, beta)| beta);
            prop_assert_eq!(discounted.implicability(a), m.implicability(a) * product(outside));
            let outside = contexts.iter().filter(|(c, _)| !a.is_subset_of(*c)).map(|&(_, beta)| beta);
            prop_assert_eq!(reinforced.commonality(a), m.commonality(a) * product(outside));
        }
    }

    #[test]
    fn a_discount_is_that_of_the_context_theta_and_can_be_taken_back((frame, numbers) in any_bodies(1)) {
        let m = body(&frame, &numbers[0], &[]);
        let u = Uncertainty::new(0.375).expect("in [0, 1]");
        let discounted = m.discounted(u, &frame);
        let theta = [(frame.theta(), Ratio::new(5, 8))];
        prop_assert_eq!(m.contextually_discounted(&theta, &frame), Ok(discounted.clone()));
        prop_assert_eq!(discounted.undiscounted(u, &frame), Ok(m));
    }

    /// Conditioning is combination with the certainty of what is known.
    #[test]
    fn conditioning_is_combination_with_a_certainty(
        (frame, numbers) in any_bodies(1),
        on in any::<prop::sample::Index>(),
    ) {
        let m = body(&frame, &numbers[0], &[]);
        let elements: Vec<Element> = frame.elements().collect();
        let on = *on.get(&elements);
        let known = MassFunction::new(&frame, [(on, Ratio::one())]).expect("certain");
        let both = [m.clone(), known];
        let open = rule::combine(Rule::Conjunctive, &both, &frame);
        prop_assert_eq!(m.conditioned_unnormalised(on, &frame), open);
        match m.conditioned(on, &frame) {
            Ok(closed) => prop_assert_eq!(Ok(closed), rule::combine(Rule::Dempster, &both, &frame)),
            Err(error) => {
                prop_assert_eq!(error, BeliefError::Implausible { element: frame.print(on) });
                prop_assert_eq!(m.plausibility(on), Ratio::zero());
            }
        }
    }

    #[test]
    fn distributions_sum_to_one_and_agree_with_their_measures(
        (frame, numbers) in any_bodies(1),
        open in any::<bool>(),
    ) {
        let also: &[Element] = if open { &[Element::EMPTY] } else { &[] };
        let (m, epsilon) = (body(&frame, &numbers[0], also), Ratio::new(1, 3));
        let betp = m.pignistic_distribution(&frame).expect("possible");
        let dsmp = m.dsmp_distribution(epsilon, &frame).expect("possible");
        let contour = m.plausibility_distribution(&frame).expect("possible");
        for distribution in [&betp, &dsmp, &contour] {
            prop_assert_eq!(distribution.probability(frame.theta()), Ratio::one());
        }
        for a in frame.elements() {
            prop_assert_eq!(betp.probability(a), m.pignistic(a));
            prop_assert_eq!(dsmp.probability(a), m.dsmp(a, epsilon));
        }
        let ratio = |region| m.contour(region) / contour.of(region);
        let possible = frame.regions().filter(|&region| m.contour(region) > Ratio::zero());
        let ratios: Vec<Ratio> = possible.map(ratio).collect();
        prop_assert!(ratios.iter().all(|ratio| *ratio == ratios[0]), "scaled by one number");
        let content = betp.information_content();
        // A product of logarithms and their sums err by some 1e-15.
        prop_assert!((-1e-12..=1.0).contains(&content), "{}", content);
    }

    #[test]
    fn the_square_of_the_distance_is_its_quadratic_form((frame, numbers) in any_bodies(2)) {
        let m = [0, 1].map(|source| body(&frame, &numbers[source], &[Element::EMPTY]));
        let similar = |a: Element, b: Element| match (a | b).cardinality() {
            0 => Ratio::one(),
            union => Ratio::new((a & b).cardinality().into(), union.into()),
        };
        let mut form = Ratio::zero();
        for a in frame.elements() {
            for b in frame.elements() {
                let [of_a, of_b] = [a, b].map(|x| m[0].mass(x) - m[1].mass(x));
                form += of_a * of_b * similar(a, b);
            }
        }
        let square = m[0].jousselme_square(&m[1]);
        prop_assert_eq!(square, form / Ratio::count(2));
        prop_assert_eq!(square, m[1].jousselme_square(&m[0]));
        prop_assert!(square >= Ratio::zero() && square <= Ratio::one());
        prop_assert_eq!(square == Ratio::zero(), m[0] == m[1]);
    }

    #[test]
    fn conflicts_are_those_of_the_conjunctive_rule((frame, numbers) in any_bodies(2)) {
        let m = [0, 1].map(|source| body(&frame, &numbers[source], &[]));
        let conflict = |sources: &[MassFunction<Ratio>]| {
            rule::combine(Rule::Conjunctive, sources, &frame).expect("one frame").conflict()
        };
        prop_assert_eq!(m[0].conflict_with(&m[1]), conflict(&m));
        for order in 0..4 {
            let copies = vec![m[0].clone(); order as usize];
            let found = m[0].auto_conflict(order).expect("few elements");
            prop_assert_eq!(found, conflict(&copies), "order {}", order);
        }
    }
}
