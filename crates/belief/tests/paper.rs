//! The paper's tables and equations on belief functions.

use wisdom_belief::{
    Frame, InterestMass, MassFunction, Model, Opinion, ParadoxPolicy, Rule, Uncertainty, rule,
};

fn seen(paradox: f64, not_interesting: f64, interesting: f64, u: f64) -> InterestMass {
    let opinion = Opinion { paradox, not_interesting, interesting };
    let u = Uncertainty::new(u).expect("in [0, 1]");
    InterestMass::try_from(opinion).expect("an opinion").discounted(u)
}

/// Table 6: gradient, texture and temperature at (67, 20).
fn table_6() -> [InterestMass; 3] {
    [seen(0.15, 0.05, 0.8, 0.0), seen(0.05, 0.0, 0.95, 0.66), seen(0.2, 0.8, 0.0, 0.19)]
}

/// Table 4: two experts who contradict each other.
fn table_4() -> [InterestMass; 2] {
    [seen(0.0, 0.0, 0.99, 0.0), seen(0.0, 0.99, 0.0, 0.0)]
}

fn assert_masses(found: InterestMass, [i, ni, theta, paradox]: [f64; 4], tolerance: f64) {
    let close = |a: f64, b: f64| (a - b).abs() <= tolerance;
    assert!(
        close(found.interesting(), i)
            && close(found.not_interesting(), ni)
            && close(found.ignorance(), theta)
            && close(found.paradox(), paradox),
        "{found:?}"
    );
}

#[test]
fn table_5_dempster_cannot_decide_and_dsmt_can() {
    let dst = Rule::Dempster.fuse(&table_4(), ParadoxPolicy::ToIgnorance);
    // The paper rounds to four decimals.
    assert_masses(dst.mass, [0.4975, 0.4975, 0.005, 0.0], 5e-5);
    assert!((dst.conflict - 0.9801).abs() < 1e-12);
    let dsmt = Rule::Dsmc.fuse(&table_4(), ParadoxPolicy::ToIgnorance);
    assert_masses(dsmt.mass, [0.0099, 0.0099, 0.0001, 0.9801], 1e-12);
    assert!((dsmt.mass.belief() - 0.99).abs() < 1e-12);
}

#[test]
fn table_7_the_rock_border_is_believed_interesting() {
    let fused = Rule::Dsmc.fuse(&table_6(), ParadoxPolicy::ToIgnorance);
    assert_masses(fused.mass, [0.149_416, 0.027_654, 0.0, 0.822_93], 1e-12);
    // Printed 0.97234607, exactly 0.972346 (docs/paper-notes.md).
    assert!((fused.mass.belief() - 0.972_346_07).abs() < 1e-7);
    assert_eq!(fused.conflict, 0.0);
}

#[test]
fn table_8_moves_the_paradox_to_ignorance() {
    let moved = table_6().map(|source| ParadoxPolicy::ToIgnorance.apply(source));
    assert_masses(moved[0], [0.8, 0.05, 0.15, 0.0], 1e-12);
    assert_masses(moved[1], [0.323, 0.0, 0.677, 0.0], 1e-12);
    assert_masses(moved[2], [0.0, 0.648, 0.352, 0.0], 1e-12);
}

#[test]
fn table_9_under_dempster_the_rock_border_is_no_objective() {
    let fused = Rule::Dempster.fuse(&table_6(), ParadoxPolicy::ToIgnorance);
    assert_masses(fused.mass, [0.6881, 0.2296, 0.0824, 0.0], 5e-5);
}

/// The paper says that another way to move the paradox would change little; it would.
#[test]
fn the_paradox_policy_moves_the_interest_of_the_rock_border() {
    let interest = |policy| Rule::Dempster.fuse(&table_6(), policy).mass.belief();
    assert!((interest(ParadoxPolicy::ToIgnorance) - 0.6881).abs() < 5e-5);
    assert!((interest(ParadoxPolicy::Split) - 0.7538).abs() < 5e-5);
    assert!((interest(ParadoxPolicy::Renormalise) - 0.8438).abs() < 5e-5);
}

/// Below both: PCR6 gives the conflict back to the thermal expert, too.
#[test]
fn pcr6_believes_less_in_the_rock_border() {
    let fused = Rule::Pcr6.fuse(&table_6(), ParadoxPolicy::ToIgnorance).mass;
    assert!((fused.interesting() - 0.5518).abs() < 5e-5);
    assert!((fused.not_interesting() - 0.2936).abs() < 5e-5);
    assert!((fused.pignistic(&Rule::Pcr6.model()) - 0.6291).abs() < 5e-5);
}

/// Eqs. 6 to 9: Dempster's rule on the refined frame is the classic rule on the free one, element by element.
#[test]
fn eq_6_to_9_the_refined_frame_gives_the_same_masses_without_conflict() {
    let free = Frame::interest(Model::Free).expect("a frame");
    let refined = free.refined(["X", "Y", "Z"]).expect("three regions");
    let sources = table_6().map(|source| source.mass_function(&free).expect("the frame {I, NI}"));
    let primed = sources.each_ref().map(|source| refined.mass(source));

    let i = refined.frame().parse("X | Y").expect("an element");
    assert_eq!(primed[0].mass(i), 0.8); // Eq. 6: m'(X ∪ Y) = m(I)
    let conflict = rule::conflict(&primed, refined.frame()).expect("one frame");
    assert_eq!(conflict, 0.0); // Eq. 7
    let direct = rule::combine(Rule::Dsmc, &sources, &free).expect("a free frame");
    let detour = rule::combine(Rule::Dempster, &primed, refined.frame()).expect("no conflict");
    assert_eq!(detour.focal().len(), direct.focal().len());
    for &(element, mass) in direct.focal() {
        assert!((detour.mass(refined.element(element)) - mass).abs() < 1e-15, "Eqs. 8 and 9");
    }
}

/// Two sources sure of different things leave Dempster's rule certain of what both doubt.
#[test]
fn zadeh_dempster_is_sure_of_what_both_doubt_and_pcr6_is_not() {
    let frame = Frame::shafer(["A", "B", "C"]).expect("a frame");
    let body = |likely| MassFunction::parse(&frame, [(likely, 0.9), ("C", 0.1)]).expect("a body");
    let sources = [body("A"), body("B")];
    let c = frame.parse("C").expect("an atom");
    let dempster = rule::combine(Rule::Dempster, &sources, &frame).expect("C survives");
    assert_eq!(dempster.mass(c), 1.0);
    let pcr6 = rule::combine(Rule::Pcr6, &sources, &frame).expect("few products");
    // 0.01 agreed, and of each conflict 0.9 × 0.1 with C the tenth that C put in.
    assert!((pcr6.mass(c) - (0.01_f64 + 2.0 * 0.09 * 0.1)).abs() < 1e-15);
}

#[test]
fn dull_ground_seen_clearly_has_belief_0_488_and_hidden_ground_none() {
    let dull = seen(0.2, 0.8, 0.0, 0.0);
    let fused = Rule::Dsmc.fuse(&[dull; 3], ParadoxPolicy::ToIgnorance).mass;
    assert!((fused.belief() - 0.488).abs() < 1e-12);
    let hidden = dull.discounted(Uncertainty::UNKNOWN);
    assert_eq!(hidden, InterestMass::VACUOUS);
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        let fused = rule.fuse(&[hidden; 3], ParadoxPolicy::ToIgnorance);
        assert_eq!((fused.mass, fused.conflict), (InterestMass::VACUOUS, 0.0), "{rule}");
    }
}
