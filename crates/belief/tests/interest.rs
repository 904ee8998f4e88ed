//! Laws of what is computed on the frame {I, NI} in closed form. (That each closed form is its rule: `exact.rs`.)

use proptest::prelude::*;
use wisdom_belief::{
    BeliefError, Frame, Fused, InterestMass, Model, Opinion, ParadoxPolicy, Rule, Uncertainty, rule,
};

/// Two ways to add up the same few products differ by their rounding.
const SAME: f64 = 1e-12;

/// Deng's weights are worth less digits: square roots of small squares.
const SAME_ROOT: f64 = 1e-9;

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

/// A rule and a policy that it gives a meaning.
fn any_reading() -> impl Strategy<Value = (Rule, ParadoxPolicy)> {
    let policies = |rule: Rule| ParadoxPolicy::ALL.map(|policy| (rule, policy));
    let readings = Rule::ALL.into_iter().flat_map(policies);
    let admitted = readings.filter(|&(rule, policy)| rule.admits(policy)).collect::<Vec<_>>();
    prop::sample::select(admitted)
}

fn close(a: InterestMass, b: InterestMass, tolerance: f64) -> bool {
    a.masses().into_iter().zip(b.masses()).all(|(a, b)| (a - b).abs() < tolerance)
}

/// Rules on Shafer's model whose answers may leave mass on ∅.
fn leaves_mass_on_empty(rule: Rule, policy: ParadoxPolicy) -> bool {
    let given = policy == ParadoxPolicy::ToEmpty;
    matches!(rule, Rule::Conjunctive | Rule::Cautious | Rule::Bold)
        || given && matches!(rule, Rule::Disjunctive | Rule::Average)
}

proptest! {
    #[test]
    fn fused_masses_sum_to_one_and_closed_worlds_know_no_paradox(
        sources in any_sources(), (rule, policy) in any_reading(),
    ) {
        let fused = rule.fuse(&sources, policy).mass;
        prop_assert!((fused.masses().iter().sum::<f64>() - 1.0).abs() < SAME);
        prop_assert!(fused.masses().iter().all(|mass| (0.0..=1.0 + SAME).contains(mass)));
        prop_assert!(
            rule == Rule::Dsmc || leaves_mass_on_empty(rule, policy) || fused.paradox() == 0.0
        );
    }

    #[test]
    fn the_order_of_the_sources_does_not_matter(
        sources in any_sources().prop_flat_map(|sources| {
            (Just(sources.clone()), Just(sources).prop_shuffle())
        }),
        (rule, policy) in any_reading(),
    ) {
        let (a, b) = (rule.fuse(&sources.0, policy), rule.fuse(&sources.1, policy));
        let tolerance = if rule == Rule::Deng { SAME_ROOT } else { SAME };
        prop_assert!(close(a.mass, b.mass, tolerance), "{:?} {:?}", a, b);
        prop_assert!((a.conflict - b.conflict).abs() < SAME);
    }

    /// Bit by bit: an expert who is heard later changes nothing of what was fused before.
    #[test]
    fn dsmc_two_at_a_time_is_dsmc_all_at_once(sources in any_sources()) {
        let fuse = |sources: &[InterestMass]| Rule::Dsmc.fuse(sources, ParadoxPolicy::Split).mass;
        let folded = sources.iter().fold(InterestMass::VACUOUS, |a, &b| fuse(&[a, b]));
        prop_assert_eq!(folded, fuse(&sources));
    }

    /// Under DSmC the doubts m(NI) + m(I ∪ NI) of the sources multiply, and belief in I is what they leave of 1.
    #[test]
    fn under_dsmc_doubts_multiply_and_belief_is_the_rest(sources in any_sources()) {
        let fused = Rule::Dsmc.fuse(&sources, ParadoxPolicy::Split).mass;
        let doubts = sources.iter().map(|source| source.not_interesting() + source.ignorance());
        let expected = 1.0 - doubts.product::<f64>();
        prop_assert!((fused.belief() - expected).abs() < SAME);
        prop_assert_eq!(fused.plausibility(&Model::Free), 1.0);
    }

    #[test]
    fn all_paradox_policies_agree_where_there_is_no_paradox(
        sources in any_sources(), (rule, policy) in any_reading(),
    ) {
        prop_assume!(rule != Rule::Bold); // It admits one policy only.
        let bare: Vec<_> =
            sources.iter().map(|&source| ParadoxPolicy::ToIgnorance.apply(source)).collect();
        prop_assert_eq!(rule.fuse(&bare, policy), rule.fuse(&bare, ParadoxPolicy::ToIgnorance));
    }

    #[test]
    fn statistics_of_one_cell_equal_the_general_measures(m in any_mass(), epsilon in 0.0..0.1_f64) {
        let hybrid = Frame::with_empty(["I", "NI"], &["I & NI"]).expect("a frame");
        for model in [Model::Free, Model::Shafer, hybrid.model().clone()] {
            let frame = Frame::interest(model.clone()).expect("a frame");
            let (body, i) = (m.mass_function(&frame).expect("{I, NI}"), frame.atom(0).expect("I"));
            prop_assert!((m.belief_under(&model) - body.belief(i)).abs() < SAME);
            prop_assert!((m.plausibility(&model) - body.plausibility(i)).abs() < SAME);
            prop_assert!((m.pignistic(&model) - body.pignistic(i)).abs() < SAME);
            prop_assert!((m.dsmp(&model, epsilon) - body.dsmp(i, epsilon)).abs() < SAME);
        }
    }

    /// The printed closed forms on the free model.
    #[test]
    fn pignistic_and_dsmp_follow_their_formulas(m in any_mass(), epsilon in 1e-6..0.1_f64) {
        let [i, n, u, p] = m.masses();
        let betp = p + i + n / 2.0 + u * 2.0 / 3.0;
        prop_assert!((m.pignistic(&Model::Free) - betp).abs() < SAME);
        let dsmp = p + i
            + n * (p + epsilon) / (p + 2.0 * epsilon)
            + u * (p + 2.0 * epsilon) / (p + 3.0 * epsilon);
        prop_assert!((m.dsmp(&Model::Free, epsilon) - dsmp).abs() < SAME);
    }

    #[test]
    fn discounting_in_two_steps_multiplies_what_is_kept(
        m in any_mass(), a in 0.0..=1.0, b in 0.0..=1.0,
    ) {
        let u = |u: f64| Uncertainty::new(u).expect("in [0, 1]");
        let once = m.discounted(u(1.0 - (1.0 - a) * (1.0 - b)));
        prop_assert!(close(m.discounted(u(a)).discounted(u(b)), once, SAME));
    }
}

/// PCR6 gives a share of each conflict to the ignorance of whoever took part: a source without an opinion
/// draws mass to I ∪ NI.
#[test]
fn a_vacuous_source_dilutes_pcr6_and_not_pcr6_plus() {
    let sources = [interest_mass([6, 1, 3, 0]), interest_mass([5, 3, 2, 0])];
    let more = [sources[0], sources[1], InterestMass::VACUOUS];
    let ignorance = |rule: Rule, sources: &[InterestMass]| {
        rule.fuse(sources, ParadoxPolicy::Split).mass.ignorance()
    };
    for rule in [Rule::Pcr6, Rule::Pcr6Plus] {
        assert!((ignorance(rule, &sources) - 0.06).abs() < SAME);
    }
    assert!(ignorance(Rule::Pcr6, &more) > 0.15);
    assert!((ignorance(Rule::Pcr6Plus, &more) - 0.06).abs() < SAME);
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
    for rule in [Rule::Dempster, Rule::Zhang, Rule::Jaccard] {
        let error = BeliefError::TotalConflict { sources: 2, rule };
        assert_eq!(rule::combine(rule, &bodies, &frame), Err(error));
        let fused = rule.fuse(&sources, ParadoxPolicy::ToIgnorance);
        assert_eq!(fused, Fused { mass: InterestMass::VACUOUS, conflict: 1.0 }, "{rule}");
    }
}

#[test]
fn what_a_weight_rule_cannot_decompose_is_a_value_on_the_map() {
    let undefined = Fused { mass: InterestMass::VACUOUS, conflict: 1.0 };
    let dogmatic = [[1, 1, 0, 0], [0, 1, 1, 0]].map(interest_mass);
    assert_eq!(Rule::Cautious.fuse(&dogmatic, ParadoxPolicy::ToIgnorance), undefined);
    let normal = [[1, 1, 1, 0], [0, 1, 1, 1]].map(interest_mass);
    assert_eq!(Rule::Bold.fuse(&normal, ParadoxPolicy::ToEmpty), undefined);
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
        let fused = rule.fuse::<f64>(&[], ParadoxPolicy::ToIgnorance);
        assert_eq!(fused, Fused { mass: InterestMass::VACUOUS, conflict: 0.0 }, "{rule}");
    }
}
