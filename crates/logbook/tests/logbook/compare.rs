//! Two decisions differ first at a stage, in a field.

use wisdom_logbook::first_difference;
use wisdom_logbook::record::Decision;

use crate::story;

fn sound() -> Decision {
    Decision::of(&story::decision(1), &story::setting())
}

/// A change to a decision, and the stage and field that must be named.
type Change = (fn(&mut Decision), &'static str, &'static str);

#[test]
fn the_first_difference_names_its_stage_and_field() {
    let changes: [Change; 12] = [
        (|d| d.decision_version += 1, "record", "decision_version"),
        (|d| d.triggers[1].goal = None, "trigger", "triggers[1].goal"),
        (|d| manager(d).retired[0].closed = false, "state", "state.manager.retired[0].closed"),
        (|d| d.frame.as_mut().unwrap().digest.push('0'), "frame", "frame.digest"),
        (|d| d.gradient.as_mut().unwrap().digest.clear(), "gradient", "gradient.digest"),
        (|d| d.masses.as_mut().unwrap().digest.clear(), "masses", "masses.digest"),
        (|d| d.fusion.as_mut().unwrap().background = 0.5, "fusion", "fusion.background"),
        (
            |d| d.candidates.as_mut().unwrap().shortlist.push(9),
            "candidates",
            "candidates.shortlist[1]",
        ),
        (|d| d.routes.as_mut().unwrap().travel_digest.clear(), "routes", "routes.travel_digest"),
        (
            |d| d.objective.as_mut().unwrap().family[0].legs.clear(),
            "objective",
            "objective.family[0].legs[0]",
        ),
        (
            |d| d.choice.as_mut().unwrap().verdicts[1].reason = "time".to_owned(),
            "choice",
            "choice.verdicts[1].reason",
        ),
        (|d| d.choice = None, "choice", "choice"),
    ];
    for (change, stage, path) in changes {
        let mut other = sound();
        change(&mut other);
        let difference = first_difference(&sound(), &other).unwrap();
        assert_eq!((difference.stage, difference.path.as_str()), (stage, path));
        assert_eq!(difference.decision, 1);
        let back = first_difference(&other, &sound()).unwrap();
        assert_eq!((back.left, back.right), (difference.right, difference.left));
    }
}

fn manager(decision: &mut Decision) -> &mut wisdom_logbook::record::ManagerState {
    decision.state.as_mut().unwrap().manager.as_mut().unwrap()
}

#[test]
fn the_earlier_stage_is_named_whatever_the_fields_are_called() {
    let mut other = sound();
    other.choice = None;
    other.state.as_mut().unwrap().idle_looks = 7;
    let difference = first_difference(&sound(), &other).unwrap();
    assert_eq!(difference.to_string(), "decision 1, state: state.idle_looks is 0 against 7");
}

#[test]
fn one_ulp_is_a_difference_shown_in_full() {
    let mut other = sound();
    let fusion = other.fusion.as_mut().unwrap();
    fusion.background = fusion.background.next_up();
    let difference = first_difference(&sound(), &other).unwrap();
    assert_eq!(difference.ulps, Some(1));
    assert_eq!(
        difference.to_string(),
        "decision 1, fusion: fusion.background is 0.488 against 0.48800000000000004 (1 ulp)"
    );
}

#[test]
fn decisions_that_differ_only_in_their_chain_are_the_same() {
    let other = Decision { chain: "ff".to_owned(), ..sound() };
    assert_eq!(first_difference(&sound(), &other), None);
}
