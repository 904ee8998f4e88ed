//! Laws of the rules, on random bodies.

use proptest::prelude::*;
use wisdom_belief::{
    BeliefError, Frame, Fused, InterestMass, MassFunction, Model, Opinion, ParadoxPolicy, Rule,
    Uncertainty, rule,
};

/// Closed forms and general rules add up the same products in another order.
const SAME: f64 = 1e-12;

fn interest_mass([i, n, u, p]: [u32; 4]) -> InterestMass {
    let sum = f64::from(i + n + u + p);
    let [i, n, u, p] = [i, n, u, p].map(|mass| f64::from(mass) / sum);
    InterestMass::new(Opinion { paradox: p, not_interesting: n, interesting: i }, u)
        .expect("they sum to 1")
}

/// Any mass function on {I, NI}, often with masses that are 0.
fn any_mass() -> impl Strategy<Value = InterestMass> {
    let weight = || prop_oneof![1 => Just(0), 3 => 0..1000_u32];
    [weight(), weight(), weight(), weight()]
        .prop_filter("some mass", |masses| masses.iter().sum::<u32>() > 0)
        .prop_map(interest_mass)
}

fn any_sources() -> impl Strategy<Value = Vec<InterestMass>> {
    prop::collection::vec(any_mass(), 1..=5)
}

fn any_rule() -> impl Strategy<Value = Rule> {
    prop::sample::select(Rule::ALL.to_vec())
}

fn any_policy() -> impl Strategy<Value = ParadoxPolicy> {
    prop::sample::select(ParadoxPolicy::ALL.to_vec())
}

fn masses(m: InterestMass) -> [f64; 4] {
    [m.interesting(), m.not_interesting(), m.ignorance(), m.paradox()]
}

fn close(a: InterestMass, b: InterestMass) -> bool {
    masses(a).into_iter().zip(masses(b)).all(|(a, b)| (a - b).abs() < SAME)
}

/// The closed form's answer by the general algorithm, on {I, NI} under the rule's model.
fn general(rule: Rule, sources: &[InterestMass], policy: ParadoxPolicy) -> Fused {
    let frame = Frame::interest(rule.model()).expect("a frame");
    let read = |source: &InterestMass| {
        let source = if frame.is_free() { *source } else { policy.apply(*source) };
        source.mass_function(&frame).expect("the frame {I, NI}")
    };
    let bodies: Vec<MassFunction> = sources.iter().map(read).collect();
    let conflict = rule::conflict(&bodies, &frame).expect("one frame");
    let mass = match rule::combine(rule, &bodies, &frame) {
        Ok(fused) => {
            let of = |text| fused.mass(frame.parse(text).expect("an element"));
            let opinion =
                Opinion { paradox: of("I & NI"), not_interesting: of("NI"), interesting: of("I") };
            InterestMass::new(opinion, of("I | NI")).expect("masses sum to 1")
        }
        Err(BeliefError::TotalConflict { .. }) => InterestMass::VACUOUS,
        Err(error) => panic!("{error}"),
    };
    Fused { mass, conflict }
}

/// Any mass function on a frame of three atoms under some model.
fn any_bodies() -> impl Strategy<Value = (Frame, Vec<MassFunction>)> {
    bodies_on(vec![
        Frame::free(["A", "B", "C"]).expect("a frame"),
        Frame::shafer(["A", "B", "C"]).expect("a frame"),
        Frame::with_empty(["A", "B", "C"], &["A & B"]).expect("a frame"),
    ])
}

fn free_bodies() -> impl Strategy<Value = (Frame, Vec<MassFunction>)> {
    bodies_on(vec![Frame::free(["A", "B", "C"]).expect("a frame")])
}

fn bodies_on(frames: Vec<Frame>) -> impl Strategy<Value = (Frame, Vec<MassFunction>)> {
    let frame = prop::sample::select(frames);
    let weights = prop::collection::vec(prop::collection::vec(1..100_u32, 5), 2..=4);
    let picks = prop::collection::vec(prop::sample::subsequence((0..9).collect::<Vec<_>>(), 5), 4);
    (frame, weights, picks).prop_map(|(frame, weights, picks)| {
        let texts = ["A", "B", "C", "A | B", "B | C", "A | C", "Theta", "A & C | B", "C & (A | B)"];
        let body = |(weights, picks): (&Vec<u32>, &Vec<usize>)| {
            let mut masses = std::collections::BTreeMap::new();
            let elements = picks.iter().map(|&pick| frame.parse(texts[pick]).expect("an element"));
            let sum = f64::from(weights.iter().sum::<u32>());
            for (element, &weight) in elements.zip(weights) {
                let element = if element.is_empty() { frame.theta() } else { element };
                *masses.entry(element).or_insert(0.0) += f64::from(weight) / sum;
            }
            MassFunction::new(&frame, masses).expect("they sum to 1")
        };
        let bodies = weights.iter().zip(&picks).map(body).collect();
        (frame, bodies)
    })
}

fn same(a: &MassFunction, b: &MassFunction) -> bool {
    a.focal().iter().chain(b.focal()).all(|&(x, _)| (a.mass(x) - b.mass(x)).abs() < SAME)
}

proptest! {
    #[test]
    fn closed_forms_equal_the_general_algorithm(
        sources in any_sources(), rule in any_rule(), policy in any_policy(),
    ) {
        let (closed, general) = (rule.fuse(&sources, policy), general(rule, &sources, policy));
        prop_assert!(close(closed.mass, general.mass), "{closed:?} {general:?}");
        if rule == Rule::Dsmc {
            prop_assert_eq!(closed.conflict, 0.0);
        } else {
            prop_assert!((closed.conflict - general.conflict).abs() < SAME);
        }
    }

    #[test]
    fn fused_masses_sum_to_one_and_exclusive_models_know_no_paradox(
        sources in any_sources(), rule in any_rule(), policy in any_policy(),
    ) {
        let fused = rule.fuse(&sources, policy).mass;
        prop_assert!((masses(fused).iter().sum::<f64>() - 1.0).abs() < SAME);
        prop_assert!(masses(fused).iter().all(|mass| (0.0..=1.0 + SAME).contains(mass)));
        prop_assert!(rule == Rule::Dsmc || fused.paradox() == 0.0);
    }

    #[test]
    fn the_order_of_the_sources_does_not_matter(
        sources in any_sources().prop_shuffle().prop_flat_map(|sources| {
            (Just(sources.clone()), Just(sources).prop_shuffle())
        }),
        rule in any_rule(), policy in any_policy(),
    ) {
        let (a, b) = (rule.fuse(&sources.0, policy), rule.fuse(&sources.1, policy));
        prop_assert!(close(a.mass, b.mass) && (a.conflict - b.conflict).abs() < SAME);
    }

    #[test]
    fn a_vacuous_source_changes_nothing_under_dsmc_and_dempster(
        sources in any_sources(), policy in any_policy(),
    ) {
        let mut more = sources.clone();
        more.push(InterestMass::VACUOUS);
        for rule in [Rule::Dsmc, Rule::Dempster] {
            prop_assert!(close(rule.fuse(&sources, policy).mass, rule.fuse(&more, policy).mass));
        }
    }

    #[test]
    fn dsmc_two_at_a_time_is_dsmc_all_at_once(sources in any_sources()) {
        let fuse = |sources: &[InterestMass]| Rule::Dsmc.fuse(sources, ParadoxPolicy::Split).mass;
        let folded = sources.iter().fold(InterestMass::VACUOUS, |a, &b| fuse(&[a, b]));
        prop_assert_eq!(folded, fuse(&sources));
    }

    /// Under DSmC the doubts m(NI) + m(I ∪ NI) of the sources multiply, and belief in I is what they leave of 1.
    #[test]
    fn under_dsmc_doubts_multiply_and_belief_is_the_rest(sources in any_sources()) {
        let fused = Rule::Dsmc.fuse(&sources, ParadoxPolicy::ToIgnorance).mass;
        let doubts = sources.iter().map(|source| source.not_interesting() + source.ignorance());
        let expected = 1.0 - doubts.product::<f64>();
        prop_assert!((fused.belief() - expected).abs() < SAME);
        prop_assert_eq!(fused.plausibility(&Model::Free), 1.0);
    }

    #[test]
    fn all_paradox_policies_agree_where_there_is_no_paradox(
        sources in any_sources(), rule in any_rule(),
    ) {
        let bare: Vec<_> =
            sources.iter().map(|&source| ParadoxPolicy::ToIgnorance.apply(source)).collect();
        let by = |policy| rule.fuse(&bare, policy);
        prop_assert_eq!(by(ParadoxPolicy::Split), by(ParadoxPolicy::ToIgnorance));
        prop_assert_eq!(by(ParadoxPolicy::Renormalise), by(ParadoxPolicy::ToIgnorance));
    }

    #[test]
    fn statistics_of_the_kernel_equal_the_general_measures(m in any_mass(), epsilon in 0.0..0.1_f64) {
        let hybrid = Frame::with_empty(["I", "NI"], &["I & NI"]).expect("a frame");
        for model in [Model::Free, Model::Shafer, hybrid.model().clone()] {
            let frame = Frame::interest(model.clone()).expect("a frame");
            let (body, i) = (m.mass_function(&frame).expect("{I, NI}"), frame.atom(0).expect("I"));
            prop_assert!((m.plausibility(&model) - body.plausibility(i)).abs() < SAME);
            prop_assert!((m.pignistic(&model) - body.pignistic(i)).abs() < SAME);
            prop_assert!((m.dsmp(&model, epsilon) - body.dsmp(i, epsilon)).abs() < SAME);
            if model == Model::Free {
                prop_assert!((m.belief() - body.belief(i)).abs() < SAME);
            }
        }
    }

    /// The printed closed forms on the free model.
    #[test]
    fn pignistic_and_dsmp_follow_their_formulas(m in any_mass(), epsilon in 1e-6..0.1_f64) {
        let [i, n, u, p] = masses(m);
        let betp = p + i + n / 2.0 + u * 2.0 / 3.0;
        prop_assert!((m.pignistic(&Model::Free) - betp).abs() < SAME);
        let dsmp = p + i
            + n * (p + epsilon) / (p + 2.0 * epsilon)
            + u * (p + 2.0 * epsilon) / (p + 3.0 * epsilon);
        prop_assert!((m.dsmp(&Model::Free, epsilon) - dsmp).abs() < SAME);
    }

    #[test]
    fn discounting_in_two_steps_multiplies_what_is_kept(m in any_mass(), a in 0.0..=1.0, b in 0.0..=1.0) {
        let u = |u: f64| Uncertainty::new(u).expect("in [0, 1]");
        let once = m.discounted(u(1.0 - (1.0 - a) * (1.0 - b)));
        prop_assert!(close(m.discounted(u(a)).discounted(u(b)), once));
    }

    #[test]
    fn general_rules_commute_and_keep_all_mass((frame, bodies) in any_bodies(), rule in any_rule()) {
        prop_assume!(rule != Rule::Dsmc || frame.is_free());
        let reversed: Vec<_> = bodies.iter().rev().cloned().collect();
        match (rule::combine(rule, &bodies, &frame), rule::combine(rule, &reversed, &frame)) {
            (Ok(a), Ok(b)) => {
                prop_assert!(same(&a, &b));
                let sum: f64 = a.focal().iter().map(|&(_, mass)| mass).sum();
                prop_assert!((sum - 1.0).abs() < SAME && a.conflict() == 0.0);
            }
            (a, b) => prop_assert!(a.is_err() && b.is_err()),
        }
    }

    #[test]
    fn on_the_free_model_all_rules_are_dsmc((frame, bodies) in free_bodies()) {
        let dsmc = rule::combine(Rule::Dsmc, &bodies, &frame).expect("no empty intersection");
        for rule in Rule::ALL {
            prop_assert!(same(&rule::combine(rule, &bodies, &frame).expect("no conflict"), &dsmc));
        }
    }

    #[test]
    fn belief_bounds_pignistic_and_plausibility((frame, bodies) in any_bodies()) {
        for atom in 0..3 {
            let (m, a) = (&bodies[0], frame.atom(atom).expect("an atom"));
            let (belief, betp, dsmp) = (m.belief(a), m.pignistic(a), m.dsmp(a, 0.001));
            let plausibility = m.plausibility(a);
            prop_assert!(belief <= betp + SAME && betp <= plausibility + SAME);
            prop_assert!(belief <= dsmp + SAME && dsmp <= plausibility + SAME);
            prop_assert!(m.commonality(a) <= plausibility + SAME);
        }
    }
}

/// PCR6 gives a share of each conflict to the ignorance of whoever took part: a source without an opinion
/// draws mass to I ∪ NI.
#[test]
fn a_vacuous_source_dilutes_pcr6() {
    let sources = [interest_mass([6, 1, 3, 0]), interest_mass([5, 3, 2, 0])];
    let more = [sources[0], sources[1], InterestMass::VACUOUS];
    let ignorance =
        |sources: &[InterestMass]| Rule::Pcr6.fuse(sources, ParadoxPolicy::Split).mass.ignorance();
    assert!((ignorance(&sources) - 0.06).abs() < SAME);
    assert!(ignorance(&more) > 0.15);
}

#[test]
fn pcr6_two_at_a_time_is_not_pcr6_all_at_once() {
    let sources = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0]].map(interest_mass);
    let fuse = |sources: &[InterestMass]| Rule::Pcr6.fuse(sources, ParadoxPolicy::Split).mass;
    let folded = fuse(&[fuse(&sources[..2]), sources[2]]);
    assert!((fuse(&sources).interesting() - 1.0 / 3.0).abs() < SAME);
    assert!((folded.interesting() - 1.0 / 3.0).abs() > 0.1);
}

#[test]
fn total_conflict_is_an_error_in_general_and_a_value_on_the_map() {
    let sources = [[1, 0, 0, 0], [0, 1, 0, 0]].map(interest_mass);
    let frame = Frame::interest(Model::Shafer).expect("a frame");
    let bodies = sources.map(|source| source.mass_function(&frame).expect("{I, NI}"));
    assert_eq!(
        rule::combine(Rule::Dempster, &bodies, &frame),
        Err(BeliefError::TotalConflict { sources: 2 })
    );
    let fused = Rule::Dempster.fuse(&sources, ParadoxPolicy::ToIgnorance);
    assert_eq!(fused, Fused { mass: InterestMass::VACUOUS, conflict: 1.0 });
}

/// Near total conflict 1 − K keeps a few digits only; the sum of what survives keeps them all.
#[test]
fn dempster_keeps_its_digits_near_total_conflict() {
    let tiny = 1e-13;
    let opinion = |interesting, not_interesting| {
        let opinion = Opinion { paradox: 0.0, not_interesting, interesting };
        InterestMass::new(opinion, tiny).expect("they sum to 1")
    };
    let sources = [opinion(1.0 - tiny, 0.0), opinion(0.0, 1.0 - tiny)];
    let fused = Rule::Dempster.fuse(&sources, ParadoxPolicy::ToIgnorance).mass;
    let exact = (1.0 - tiny) / (2.0 - tiny);
    assert!((fused.interesting() - exact).abs() < 1e-15);
}

#[test]
fn no_sources_say_nothing() {
    for rule in Rule::ALL {
        let fused = rule.fuse(&[], ParadoxPolicy::ToIgnorance);
        assert_eq!(fused, Fused { mass: InterestMass::VACUOUS, conflict: 0.0 });
        let frame = Frame::interest(rule.model()).expect("a frame");
        assert_eq!(rule::combine(rule, &[], &frame), Ok(MassFunction::vacuous(&frame)));
    }
}
