//! What is chosen, and why.

mod bodies;

use bodies::{any_bodies, body};
use proptest::prelude::*;
use wisdom_belief::{BeliefError, Criterion, Frame, MassFunction};

fn abc() -> Frame {
    Frame::shafer(["A", "B", "C"]).expect("a frame")
}

fn mass(masses: &[(&'static str, f64)]) -> MassFunction {
    MassFunction::parse(&abc(), masses.iter().copied()).expect("masses")
}

#[test]
fn each_criterion_takes_what_it_values_most() {
    let m = mass(&[("A", 0.35), ("B", 0.3), ("C", 0.1), ("B | C", 0.25)]);
    let chosen = |criterion| {
        let choice = m.decide(&abc().alternatives(), criterion, &abc()).expect("a choice");
        assert!(choice.ties.is_empty(), "{choice:?}");
        (choice.index, (choice.value * 1e6).round() / 1e6)
    };
    assert_eq!(chosen(Criterion::Belief), (0, 0.35));
    assert_eq!(chosen(Criterion::Plausibility), (1, 0.55));
    assert_eq!(chosen(Criterion::Pignistic), (1, 0.425));
    // B | C is split 3 : 1, as A and B alone would have it.
    assert_eq!(chosen(Criterion::Dsmp { epsilon: 0.0 }), (1, 0.4875));
    assert_eq!(chosen(Criterion::Hurwicz { pessimism: 1.0 }), (0, 0.35));
    assert_eq!(chosen(Criterion::Hurwicz { pessimism: 0.5 }), (1, 0.425));
    assert_eq!(chosen(Criterion::Hurwicz { pessimism: 0.9 }), (0, 0.35));
}

#[test]
fn ties_go_to_the_first_and_are_reported() {
    let m = mass(&[("A", 0.2), ("B", 0.4), ("C", 0.4)]);
    let choice = m.decide(&abc().alternatives(), Criterion::Belief, &abc()).expect("a choice");
    assert_eq!((choice.index, choice.ties), (1, vec![2]));
    let backwards: Vec<_> = abc().alternatives().into_iter().rev().collect();
    let choice = m.decide(&backwards, Criterion::Belief, &abc()).expect("a choice");
    assert_eq!((choice.index, choice.ties), (0, vec![1]));
}

/// 0.1 + 0.2 is more than 0.3 in binary, and no reason to prefer anything.
#[test]
fn rounding_does_not_break_ties() {
    let m = mass(&[("A", 0.3), ("B", 0.1), ("B | C", 0.2), ("A | C", 0.4)]);
    let pair = [abc().parse("A").expect("an atom"), abc().parse("B | C").expect("a union")];
    assert!(m.belief(pair[1]) > m.belief(pair[0]));
    let choice = m.decide(&pair, Criterion::Belief, &abc()).expect("a choice");
    assert_eq!((choice.index, choice.ties), (0, vec![1]));
}

#[test]
fn an_alternative_is_dominated_when_another_is_surer_than_it_is_possible() {
    let m = mass(&[("A", 0.5), ("A | B", 0.2), ("B", 0.2), ("C", 0.1)]);
    // Bel(A) = 0.5 exceeds Pl(B) = 0.4 and Pl(C) = 0.1.
    assert_eq!(m.non_dominated(&abc().alternatives(), &abc()), Ok(vec![0]));
    let open = mass(&[("A", 0.4), ("A | B", 0.3), ("B", 0.2), ("C", 0.1)]);
    assert_eq!(open.non_dominated(&abc().alternatives(), &abc()), Ok(vec![0, 1]));
}

#[test]
fn alternatives_are_atoms_that_exist() {
    let frame = Frame::with_empty(["A", "B", "C"], &["B"]).expect("a frame");
    let printed: Vec<String> = frame.alternatives().iter().map(|&a| frame.print(a)).collect();
    assert_eq!(printed, ["A", "C"]);
}

#[test]
fn what_cannot_be_decided_is_refused() {
    let (frame, all) = (abc(), abc().alternatives());
    let m = mass(&[("A", 1.0)]);
    let none = m.decide(&[], Criterion::Belief, &frame);
    assert_eq!(none, Err(BeliefError::NoAlternatives));
    assert_eq!(m.non_dominated(&[], &frame), Err(BeliefError::NoAlternatives));
    for pessimism in [-0.1, 1.1, f64::NAN] {
        let refused = m.decide(&all, Criterion::Hurwicz { pessimism }, &frame);
        assert!(matches!(refused, Err(BeliefError::Parameter { name: "pessimism", .. })));
    }
    let refused = m.decide(&all, Criterion::Dsmp { epsilon: -1.0 }, &frame).expect_err("ε < 0");
    assert_eq!(refused.to_string(), "epsilon is -1; it must be from 0 to 1e30");
    let nothing = mass(&[("empty", 1.0)]).decide(&all, Criterion::Pignistic, &frame);
    assert_eq!(nothing, Err(BeliefError::NothingPossible));
    let free = Frame::free(["A", "B", "C"]).expect("a frame");
    let foreign = m.decide(&free.alternatives(), Criterion::Belief, &frame);
    assert!(matches!(foreign, Err(BeliefError::ForeignElement { .. })));
}

proptest! {
    /// Whatever Bel, Pl or a mix of them chooses is not dominated.
    #[test]
    fn the_chosen_one_is_never_dominated((frame, numbers) in any_bodies(1)) {
        let (m, alternatives) = (body(&frame, &numbers[0], &[]), frame.alternatives());
        let good = m.non_dominated(&alternatives, &frame).expect("alternatives");
        let pessimism = bodies::Ratio::new(1, 3);
        for criterion in [
            Criterion::Belief,
            Criterion::Plausibility,
            Criterion::Pignistic,
            Criterion::Hurwicz { pessimism },
        ] {
            let choice = m.decide(&alternatives, criterion, &frame).expect("a choice");
            prop_assert!(good.contains(&choice.index), "{:?}", criterion);
        }
    }
}
