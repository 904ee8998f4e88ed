//! Goals that change for reasons.

use wisdom_autonomy::{Act, Budget, MapUpdate, Spec, StepResult, Trigger, Wake, Word};
use wisdom_belief::Rule;
use wisdom_fusion::Fusion;
use wisdom_goals::{
    Action, Cause, Directive, Kind, ManagerSpec, Outcome, Reason, Taxonomy, Transformation,
};
use wisdom_planner::Vehicle;

use crate::stage::{
    Look, NEAR, Played, Stage, compared, directive, fate, goal_at, place, pursued, route, said,
    spec, term, updated,
};

/// A rock in the east, a lesser one in the west.
const TWO_ROCKS: &str = "
    ......................
    ......................
    ......................
    ......................
    .7.........R.....9....
    ......................
    ......................
    ......................
";

/// The same, seen from nearer: the rock in the east stands among pits.
const EAST_IN_PITS: &str = "
    ......................
    ......................
    ................###...
    ...............#...#..
    .7.........R...#.9.#..
    ...............#...#..
    ................###...
    ......................
";

/// One rock.
const ONE_ROCK: &str = "
    ................
    ................
    .R..........8...
    ................
    ................
";

pub(crate) fn a_target_that_proves_unreachable_is_given_up() -> Played {
    let mut stage = Stage::new(spec(TWO_ROCKS));
    stage.look(&Look::of(TWO_ROCKS, 0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(said(&first, goal).goal.target, place(TWO_ROCKS, '9'));
    stage.advance(&first, 1, 1.0);
    stage.look(&Look::of(EAST_IN_PITS, 0.1));
    assert!(stage.due().contains(&"route-blocked"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    let (gave_up, retraction) = (Reason::Unreachable, Transformation::Retraction);
    assert_eq!(fate(&second, goal), (Action::Drop, gave_up, retraction, Some(Outcome::Drop)));
    compared(said(&second, goal), "poses", 0.0, Some(1.0));
    assert_eq!(pursued(&second), goal_at(&second, place(TWO_ROCKS, '7')), "the other rock is next");
    stage.played()
}

pub(crate) fn a_target_that_proves_unreachable_gives_way_to_another_of_its_kind() -> Played {
    let unseen = TWO_ROCKS.replace('7', ".");
    let wide = Directive { generalise_m: 20.0, ..directive("image") };
    let mut stage = Stage::new(Spec { directives: vec![wide], ..spec(TWO_ROCKS) });
    stage.look(&Look::of(&unseen, 0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 1, 1.0);
    stage.look(&Look::of(EAST_IN_PITS, 0.1));
    stage.interrupt(&first);
    let second = stage.decide();
    let any = (Action::Modify, Reason::Generalised, Transformation::Generalization);
    assert_eq!(fate(&second, goal), (any.0, any.1, any.2, Some(Outcome::Adjust)));
    let verdict = said(&second, goal);
    assert_eq!(verdict.goal.target, place(TWO_ROCKS, '7'));
    compared(verdict, "poses", 0.0, Some(1.0));
    compared(verdict, "prize", 0.7 * 0.9, Some(0.9 * 0.9));
    compared(verdict, "moved_m", 16.0, Some(20.0));
    assert_eq!(pursued(&second), goal, "the same goal goes on to the other rock");
    stage.played()
}

pub(crate) fn interest_that_a_closer_look_denies_is_lost() -> Played {
    let mut stage = Stage::new(spec(TWO_ROCKS));
    stage.look(&Look::of(TWO_ROCKS, 0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(&TWO_ROCKS.replace('9', "."), 0.1));
    assert!(stage.due().contains(&"interest-changed"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    let (lost, retraction) = (Reason::LostInterest, Transformation::Retraction);
    assert_eq!(fate(&second, goal), (Action::Drop, lost, retraction, Some(Outcome::Drop)));
    let verdict = said(&second, goal);
    assert_eq!(verdict.cause, Cause::Discovery);
    compared(verdict, "prize", 0.0, Some(0.9 * 0.6 / 2.0));
    compared(verdict, "interest", 0.0, Some(0.9 * 0.6));
    assert_eq!(pursued(&second), goal_at(&second, place(TWO_ROCKS, '7')));
    stage.played()
}

pub(crate) fn a_better_rock_takes_the_place_of_one_that_was_committed_to() -> Played {
    const BEFORE: &str = "
        ........................
        ........................
        ..........5.R......6....
        ........................
        ........................
    ";
    const AFTER: &str = "
        ........................
        ........................
        ..9.......5.R......6....
        ........................
        ........................
    ";
    // Enough for either of the outer rocks, not for both: 3.4 kJ a metre.
    let budget = Budget { energy_j: 70_000.0, ..spec(BEFORE).budget };
    let mut stage = Stage::new(Spec { budget, ..spec(BEFORE) });
    stage.look(&Look::of(BEFORE, 0.2));
    let first = stage.decide();
    let near = goal_at(&first, place(BEFORE, '5'));
    let outer = goal_at(&first, place(BEFORE, '6'));
    assert_eq!(first.plan().sequence.goals().collect::<Vec<_>>(), [near, outer]);
    stage.achieve(&first);
    stage.look(&Look::of(AFTER, 0.1));
    assert!(stage.due().contains(&"new-candidate"), "{:?}", stage.due());
    let second = stage.decide();
    let better = goal_at(&second, place(AFTER, '9'));
    let done = (Action::Achieve, Reason::Done, Transformation::Retraction, Some(Outcome::Finish));
    assert_eq!(fate(&second, near), done);
    let added = (Action::Add, Reason::NewMaximum, Transformation::Formulation, None);
    assert_eq!(fate(&second, better), added);
    let crowded = (Action::Defer, Reason::Superseded, Transformation::Identity, None);
    assert_eq!(fate(&second, outer), crowded);
    let verdict = said(&second, outer);
    assert_eq!(verdict.other, Some(better));
    let (needed, limit) = term(verdict, "energy_j");
    let limit = limit.expect("a limit");
    assert!((limit - (70_000.0 - stage.spent.energy_j)).abs() < 1e-6, "what is left: {limit}");
    assert!(needed > limit, "both need {needed} J of {limit} J");
    assert_eq!(pursued(&second), better);
    stage.played()
}

/// Two rocks in the fog; a closer look shows one long ridge.
const TWO_PEAKS: &str = "
    ....................
    ....................
    .R.....8.....8......
    ....................
    ....................
";
const ONE_RIDGE: &str = "
    ....................
    ....................
    .R...888888888......
    ....................
    ....................
";

pub(crate) fn two_maxima_that_merge_leave_one_goal() -> Played {
    let mut stage = Stage::new(spec(TWO_PEAKS));
    stage.look(&Look::of(TWO_PEAKS, 0.4));
    let first = stage.decide();
    let near = pursued(&first);
    let far = first.plan().sequence.goals().nth(1).expect("a second goal");
    stage.advance(&first, 1, 1.0);
    stage.look(&Look::of(ONE_RIDGE, 0.1));
    stage.interrupt(&first);
    let second = stage.decide();
    assert_eq!(
        fate(&second, far),
        (Action::Drop, Reason::Merged, Transformation::Retraction, None)
    );
    let verdict = said(&second, far);
    assert_eq!(verdict.other, Some(near));
    compared(verdict, "prize", 0.8 * 0.9, Some(0.8 * 0.9));
    let kept = (Action::Keep, Reason::Unchanged, Transformation::Identity);
    assert_eq!(fate(&second, near), (kept.0, kept.1, kept.2, Some(Outcome::Continue)));
    assert_eq!(pursued(&second), near);
    stage.played()
}

pub(crate) fn a_maximum_that_splits_brings_forth_a_child() -> Played {
    let mut stage = Stage::new(spec(ONE_RIDGE));
    stage.look(&Look::of(ONE_RIDGE, 0.4));
    let first = stage.decide();
    let whole = pursued(&first);
    assert_eq!(first.manager_after.goals.len(), 1, "one ridge, one goal");
    stage.advance(&first, 1, 1.0);
    let two = ONE_RIDGE.replace("888888888", "8.......8");
    stage.look(&Look::of(&two, 0.1));
    assert!(stage.due().contains(&"interest-changed"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    let born = |id: &&_| *id != &whole;
    let child = *second.manager_after.goals.keys().find(born).expect("a child");
    assert_eq!(
        fate(&second, child),
        (Action::Add, Reason::Split, Transformation::Formulation, None)
    );
    let verdict = said(&second, child);
    assert_eq!((verdict.other, verdict.goal.parent), (Some(whole), Some(whole)));
    compared(verdict, "prize", 0.8 * 0.9, None);
    let formulated = &verdict.changes[0].terms;
    assert!(formulated.iter().any(|t| t.name == "prominence" && t.limit == Some(0.1)));
    assert_eq!(pursued(&second), whole, "the leg under way goes on");
    assert_eq!(second.plan().sequence.goals().collect::<Vec<_>>(), [whole, child]);
    stage.played()
}

/// Heights under [`ONE_ROCK`]: what looked level rises towards the rock.
const UPHILL: &str = "
    aaaaaaabcdefgggg
    aaaaaaabcdefgggg
    aaaaaaabcdefgggg
    aaaaaaabcdefgggg
    aaaaaaabcdefgggg
";

/// Four metres on loose ground at twice the price, and the slope comes in sight.
fn up_the_slope(spec: Spec) -> (Stage, wisdom_autonomy::Decision, wisdom_goals::GoalId) {
    // The level way takes 34 kJ, sampling 60 kJ; slip and slope take 25 kJ more.
    let budget = Budget { energy_j: 105_000.0, ..spec.budget };
    let mut stage = Stage::new(Spec { budget, ..spec });
    stage.look(&Look::of(ONE_ROCK, 0.2).ground(0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 4, 2.0);
    stage.look(&Look::of(ONE_ROCK, 0.2).ground(0.1).heights(UPHILL));
    let drift = stage.rover.triggers().iter().find_map(|t| match t {
        Trigger::BudgetDrift { share } => Some(*share),
        _ => None,
    });
    // Four of ten metres cost double.
    assert!((drift.expect("a drift") - 0.4).abs() < 0.01, "{drift:?}");
    stage.interrupt(&first);
    let second = stage.decide();
    (stage, second, goal)
}

pub(crate) fn a_slope_that_eats_the_budget_erodes_the_goal_to_what_can_be_afforded() -> Played {
    let sample = Directive { substitute: Some(1), ..directive("sample") };
    let directives = vec![Directive { weight: 1.5, ..sample }, directive("image")];
    let (stage, second, goal) = up_the_slope(Spec { directives, ..spec(ONE_ROCK) });
    let eroded = (Action::Modify, Reason::Afforded, Transformation::Erosion);
    assert_eq!(fate(&second, goal), (eroded.0, eroded.1, eroded.2, Some(Outcome::Reformulate)));
    let verdict = said(&second, goal);
    let (needed, left) = term(verdict, "energy_j");
    let left = left.expect("a limit");
    assert!((left - (105_000.0 - stage.spent.energy_j)).abs() < 1e-6, "what is left: {left}");
    assert!(needed > left && needed > 60_000.0, "sampling and the way need {needed} J");
    assert_eq!(verdict.goal.directive, 1);
    assert!((verdict.goal.prize - 0.8 * 0.8).abs() < NEAR, "an image is worth no more than 1");
    assert_eq!(pursued(&second), goal, "it drives on, to take an image");
    stage.played()
}

pub(crate) fn a_slope_that_eats_the_budget_defers_a_goal_without_a_substitute() -> Played {
    let directives = vec![directive("sample")];
    let (stage, second, goal) = up_the_slope(Spec { directives, ..spec(ONE_ROCK) });
    let deferred = (Action::Defer, Reason::Energy, Transformation::Identity);
    assert_eq!(fate(&second, goal), (deferred.0, deferred.1, deferred.2, Some(Outcome::Defer)));
    let (needed, left) = term(said(&second, goal), "energy_j");
    assert!(left.is_some_and(|left| needed > left), "{needed} J against {left:?}");
    assert_eq!(second.act, Act::Wait { wake: Wake::Word });
    stage.played()
}

fn facts(adds: &[&str], deletes: &[&str]) -> Word {
    let names = |names: &[&str]| names.iter().map(ToString::to_string).collect();
    Word::Facts { adds: names(adds), deletes: names(deletes) }
}

pub(crate) fn an_instrument_that_fails_erodes_its_goals_to_their_substitute() -> Played {
    let sample = Directive { substitute: Some(1), weight: 2.0, ..directive("sample") };
    let directives = vec![sample, directive("image")];
    let mut stage = Stage::new(Spec { directives, ..spec(ONE_ROCK) });
    stage.look(&Look::of(ONE_ROCK, 0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(said(&first, goal).goal.directive, 0);
    stage.advance(&first, 2, 1.0);
    stage.hear(facts(&[], &["arm-works"]));
    assert_eq!(stage.due(), ["facts"]);
    stage.interrupt(&first);
    let second = stage.decide();
    let eroded = (Action::Modify, Reason::Fault, Transformation::Erosion);
    assert_eq!(fate(&second, goal), (eroded.0, eroded.1, eroded.2, Some(Outcome::Reformulate)));
    compared(said(&second, goal), "directives able", 0.0, Some(1.0));
    assert_eq!(said(&second, goal).goal.directive, 1);
    assert_eq!(pursued(&second), goal, "it drives on, to take an image");
    stage.achieve(&second);
    let third = stage.decide();
    assert_eq!(said(&third, goal).action, Action::Achieve);
    stage.played()
}

pub(crate) fn a_failed_try_erodes_the_goal_to_its_substitute() -> Played {
    let sample = Directive { substitute: Some(1), ..directive("sample") };
    let directives = vec![Directive { weight: 2.0, ..sample }, directive("image")];
    let mut stage = Stage::new(Spec { directives, ..spec(ONE_ROCK) });
    stage.look(&Look::of(ONE_ROCK, 0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    stage.report(&first, StepResult::Aborted(goal), &[]);
    assert_eq!(stage.due(), ["leg-failed"]);
    let second = stage.decide();
    let eroded = (Action::Modify, Reason::Eroded, Transformation::Erosion);
    assert_eq!(fate(&second, goal), (eroded.0, eroded.1, eroded.2, Some(Outcome::Reformulate)));
    compared(said(&second, goal), "attempts", 1.0, Some(2.0));
    assert_eq!(pursued(&second), goal);
    stage.played()
}

pub(crate) fn a_failed_try_is_repaired_and_the_last_one_ends_the_goal() -> Played {
    let mut stage = Stage::new(spec(ONE_ROCK));
    stage.look(&Look::of(ONE_ROCK, 0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    stage.report(&first, StepResult::Aborted(goal), &[]);
    let second = stage.decide();
    let again = (Action::Keep, Reason::Unchanged, Transformation::Identity);
    assert_eq!(fate(&second, goal), (again.0, again.1, again.2, Some(Outcome::Repair)));
    assert_eq!((pursued(&second), said(&second, goal).goal.attempts), (goal, 1));
    stage.advance(&second, 2, 1.0);
    stage.report(&second, StepResult::Blocked(goal), &[]);
    let third = stage.decide();
    let spent = (Action::Drop, Reason::AttemptsSpent, Transformation::Retraction);
    assert_eq!(fate(&third, goal), (spent.0, spent.1, spent.2, Some(Outcome::Drop)));
    compared(said(&third, goal), "attempts", 2.0, Some(2.0));
    assert_eq!(third.act, Act::Wait { wake: Wake::Word }, "and the place is not wanted again");
    stage.played()
}

pub(crate) fn a_command_makes_a_goal_and_its_withdrawal_ends_it() -> Played {
    let mut stage = Stage::new(spec(TWO_ROCKS));
    stage.look(&Look::of(TWO_ROCKS, 0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 1, 1.0);
    let (name, directive) = ("look-there".to_owned(), "image".to_owned());
    let target = wisdom_grid::Cell::new(1, 14);
    let wish = Word::Pursue { name: name.clone(), directive, target, prize: 2.0, mandatory: true };
    stage.hear(wish);
    assert_eq!(stage.due(), ["command"]);
    stage.interrupt(&first);
    let second = stage.decide();
    let commanded = goal_at(&second, target);
    let added = (Action::Add, Reason::Commanded, Transformation::Formulation, None);
    assert_eq!(fate(&second, commanded), added);
    assert_eq!(said(&second, commanded).cause, Cause::Command);
    compared(said(&second, commanded), "prize", 2.0, None);
    let kept = (Action::Keep, Reason::Unchanged, Transformation::Identity);
    assert_eq!(fate(&second, goal), (kept.0, kept.1, kept.2, Some(Outcome::Continue)));
    assert_eq!(pursued(&second), goal, "the leg under way goes on");
    assert_eq!(second.plan().sequence.goals().nth(1), Some(commanded), "the command is next");

    stage.advance(&second, 1, 1.0);
    stage.hear(Word::Withdraw { name });
    stage.interrupt(&second);
    let third = stage.decide();
    let withdrawn = (Action::Drop, Reason::Withdrawn, Transformation::Retraction, None);
    assert_eq!(fate(&third, commanded), withdrawn);
    assert_eq!(said(&third, commanded).cause, Cause::Command);
    compared(said(&third, commanded), "prize", 2.0, None);
    assert_eq!(third.plan().sequence.goals().collect::<Vec<_>>()[0], goal, "as if nothing was");
    assert_eq!(third.plan().sequence.stops.len(), 2);
    stage.played()
}

pub(crate) fn a_contradiction_is_adjudicated_and_settled_by_a_closer_look() -> Played {
    const GLOW: &str = "
        ....................
        ....................
        .R....7........9....
        ....................
        ....................
    ";
    // The second instrument has read one cell, and sees nothing there.
    const TRACE: &str = "
        ????????????????????
        ????????????????????
        ???????????????0????
        ????????????????????
        ????????????????????
    ";
    let judge = Directive { weight: 1.5, ..directive("judge") };
    let directives = vec![directive("image"), judge];
    let mut stage = Stage::new(Spec { directives, ..spec(GLOW) });
    stage.look(&Look::of(GLOW, 0.2));
    let first = stage.decide();
    let near = goal_at(&first, place(GLOW, '7'));
    let disputed = goal_at(&first, place(GLOW, '9'));
    assert_eq!(first.plan().sequence.goals().collect::<Vec<_>>(), [near, disputed]);
    stage.advance(&first, 1, 1.0);
    stage.look(&Look::of(GLOW, 0.2).trace(TRACE, 0.2));
    let conflict = stage.rover.triggers().iter().find_map(|t| match t {
        Trigger::Conflict { goal, before, after } => Some((*goal, *before, *after)),
        _ => None,
    });
    let (goal, before, after) = conflict.expect("the experts contradict each other");
    // One is for it with 0.9·0.8, the other against it with 0.8.
    assert_eq!((goal, before), (disputed, 0.0));
    assert!((after - 0.72 * 0.8).abs() < 1e-6, "{after}");
    stage.interrupt(&first);
    let second = stage.decide();
    let judged = *second.manager_after.goals.keys().next_back().expect("a third goal");
    let added = (Action::Add, Reason::NewMaximum, Transformation::Formulation, None);
    assert_eq!(fate(&second, judged), added);
    compared(said(&second, judged), "prize", 1.5 * 0.72 * 0.8, None);
    let aside = (Action::Defer, Reason::Excluded, Transformation::Identity, None);
    assert_eq!(fate(&second, disputed), aside);
    assert_eq!(said(&second, disputed).other, Some(judged));
    stage.achieve(&second);
    let third = stage.decide();
    assert_eq!(pursued(&third), judged, "first it is found out who is right");

    stage.advance(&third, 2, 1.0);
    stage.look(&Look::of(GLOW, 0.05).trace(TRACE, 0.05));
    stage.interrupt(&third);
    let fourth = stage.decide();
    let settled = (Action::Drop, Reason::Settled, Transformation::Retraction);
    assert_eq!(fate(&fourth, judged), (settled.0, settled.1, settled.2, Some(Outcome::Drop)));
    // Two readings of u = 0.2 each then, of 0.05 each now; half of the doubt had to go.
    compared(said(&fourth, judged), "uncertainty", 0.1, Some(0.2));
    let back = (Action::Add, Reason::Promoted, Transformation::Identity, None);
    assert_eq!(fate(&fourth, disputed), back);
    assert_eq!(pursued(&fourth), disputed, "and the rock is worth its visit");
    stage.played()
}

pub(crate) fn a_peak_that_moves_takes_its_goal_along() -> Played {
    let after = ONE_ROCK.replace("8.", "89");
    let mut stage = Stage::new(spec(ONE_ROCK));
    stage.look(&Look::of(ONE_ROCK, 0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(&after, 0.1));
    stage.interrupt(&first);
    let second = stage.decide();
    let moved = (Action::Modify, Reason::PeakMoved, Transformation::Specialization);
    assert_eq!(fate(&second, goal), (moved.0, moved.1, moved.2, Some(Outcome::Adjust)));
    let verdict = said(&second, goal);
    assert_eq!(verdict.goal.target, place(&after, '9'));
    compared(verdict, "prize at the old target", 0.8 * 0.9, Some(0.9 * 0.9));
    compared(verdict, "moved_m", 1.0, None);
    assert_eq!(pursued(&second), goal);
    stage.played()
}

pub(crate) fn a_class_that_clears_up_makes_the_goal_concrete_and_one_that_blurs_abstract() -> Played
{
    let soil = ONE_ROCK.replace('8', "4");
    let mut taxonomy = Taxonomy::default();
    taxonomy.add("rock", None, &[]).expect("a tree");
    taxonomy.add("ledge", Some("rock"), &[4]).expect("a tree");
    let manager = ManagerSpec { taxonomy, ..spec(ONE_ROCK).manager };
    let rock = Directive { object: Some(0), ..directive("image") };
    let ledge = Directive { object: Some(1), weight: 1.5, ..directive("sample") };
    let told = Spec { manager, directives: vec![rock, ledge], ..spec(ONE_ROCK) };
    let mut told = updated(told, "soil", MapUpdate::Latest);
    told.triggers.watchdog_s = 40.0;
    let mut stage = Stage::new(told);
    stage.look(&Look::of(ONE_ROCK, 0.2).soil(&soil, 0.6));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(said(&first, goal).goal.directive, 0, "a rock of some kind");
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(ONE_ROCK, 0.2).soil(&soil, 0.1));
    stage.interrupt(&first);
    let second = stage.decide();
    let down = (Action::Modify, Reason::Concretised, Transformation::Concretion);
    assert_eq!(fate(&second, goal), (down.0, down.1, down.2, Some(Outcome::Reformulate)));
    compared(said(&second, goal), "class uncertainty", f64::from(0.1_f32), Some(0.5));
    assert_eq!(said(&second, goal).goal.directive, 1, "a ledge");
    stage.advance(&second, 2, 1.0);
    stage.look(&Look::of(ONE_ROCK, 0.2).soil(&soil, 0.7));
    stage.interrupt(&second);
    let third = stage.decide();
    let up = (Action::Modify, Reason::Abstracted, Transformation::Abstraction);
    assert_eq!(fate(&third, goal), (up.0, up.1, up.2, Some(Outcome::Reformulate)));
    compared(said(&third, goal), "class uncertainty", f64::from(0.7_f32), Some(0.5));
    assert_eq!((pursued(&third), said(&third, goal).goal.directive), (goal, 0));
    stage.played()
}

/// A rover that looks again where nothing but uncertainty speaks against a place.
fn looking_again(picture: &str) -> Spec {
    let image = Directive { min_interest: 0.4, ..directive("image") };
    let close_look = [("glow".to_owned(), 0.1), ("trace".to_owned(), 0.1)].into_iter().collect();
    Spec { directives: vec![image, directive("look")], close_look, ..spec(picture) }
}

pub(crate) fn a_look_that_keeps_its_promise_turns_look_again_into_inspect() -> Played {
    let mut stage = Stage::new(looking_again(ONE_ROCK));
    stage.look(&Look::of(ONE_ROCK, 0.7).ground(0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(said(&first, goal).goal.directive, 1, "from afar it is only a promise");
    compared(said(&first, goal), "prize", 0.8 * 0.9 - 0.8 * 0.3, None);
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(ONE_ROCK, 0.1));
    stage.interrupt(&first);
    let second = stage.decide();
    let kept = (Action::Modify, Reason::Retyped, Transformation::Retyping);
    assert_eq!(fate(&second, goal), (kept.0, kept.1, kept.2, Some(Outcome::Reformulate)));
    let verdict = said(&second, goal);
    assert_eq!(verdict.goal.directive, 0);
    compared(verdict, "prize", 0.8 * 0.9, Some(0.0));
    compared(verdict, "ignorance", 0.1, None);
    assert_eq!(pursued(&second), goal);
    stage.played()
}

pub(crate) fn readings_that_got_worse_turn_inspect_into_look_again() -> Played {
    let mut stage = Stage::new(updated(looking_again(ONE_ROCK), "glow", MapUpdate::Latest));
    stage.look(&Look::of(ONE_ROCK, 0.1));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(said(&first, goal).goal.directive, 0);
    stage.advance(&first, 2, 1.0);
    // Dust on the lens.
    stage.look(&Look::of(ONE_ROCK, 0.96).ground(0.1));
    assert!(stage.due().contains(&"interest-changed"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    let worse = (Action::Modify, Reason::Retyped, Transformation::Retyping);
    assert_eq!(fate(&second, goal), (worse.0, worse.1, worse.2, Some(Outcome::Reformulate)));
    let verdict = said(&second, goal);
    assert_eq!(verdict.goal.directive, 1);
    let u = f64::from(0.96_f32);
    compared(verdict, "prize", 0.8 * 0.9 - 0.8 * (1.0 - u), Some(0.8 * (1.0 - u)));
    compared(verdict, "ignorance", u, None);
    assert_eq!(pursued(&second), goal, "it goes on, to look again");
    stage.played()
}

pub(crate) fn an_expert_that_speaks_against_turns_inspect_into_adjudicate() -> Played {
    let against = ONE_ROCK.replace(['.', 'R'], "?").replace('8', "0");
    // Under Yager's rule what two experts contradict each other about is unknown, not interesting.
    let fusion = Fusion { rule: Rule::Yager, ..Fusion::default() };
    let directives = vec![directive("image"), directive("judge")];
    let mut stage = Stage::new(Spec { fusion, directives, ..spec(ONE_ROCK) });
    stage.look(&Look::of(ONE_ROCK, 0.04));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(ONE_ROCK, 0.04).trace(&against, 0.04));
    stage.interrupt(&first);
    let second = stage.decide();
    let disputed = (Action::Modify, Reason::Retyped, Transformation::Retyping);
    let reformulated = Some(Outcome::Reformulate);
    assert_eq!(fate(&second, goal), (disputed.0, disputed.1, disputed.2, reformulated));
    let verdict = said(&second, goal);
    assert_eq!(verdict.goal.directive, 1);
    let (kept, left) = (f64::from(1.0 - 0.04_f32), f64::from(0.04_f32));
    compared(verdict, "contradiction", 0.8 * kept * kept, None);
    compared(verdict, "prize", 0.8 * kept * kept, Some(0.8 * kept * left));
    assert_eq!(pursued(&second), goal);
    stage.played()
}

pub(crate) fn a_pose_that_is_lost_is_replaced_by_another() -> Played {
    const FROM_AFAR: &str = "
        ................
        ................
        ................
        .R........8.....
        ................
        ................
        ................
    ";
    // A pit two metres this side of the rock.
    const FROM_NEAR: &str = "
        ................
        ................
        ................
        .R......#.8.....
        ................
        ................
        ................
    ";
    let far = Directive { standoff_m: 2.0, ..directive("image") };
    let mut stage = Stage::new(Spec { directives: vec![far], ..spec(FROM_AFAR) });
    stage.look(&Look::of(FROM_AFAR, 0.2).ground(0.4));
    let first = stage.decide();
    let goal = pursued(&first);
    assert_eq!(first.manager_after.goals[&goal].pose, Some(place(FROM_NEAR, '#')));
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(FROM_NEAR, 0.2).ground(0.1));
    assert!(stage.due().contains(&"route-blocked"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    // The pit itself reads dull, and so did the ground before.
    let other = (Action::Modify, Reason::PoseLost, Transformation::Substitution);
    assert_eq!(fate(&second, goal), (other.0, other.1, other.2, Some(Outcome::Adjust)));
    compared(said(&second, goal), "poses", 1.0, None);
    let pose = second.manager_after.goals[&goal].pose.expect("a pose");
    assert!(pose.distance(place(FROM_NEAR, '8')) <= 2.0 && pose != place(FROM_NEAR, '#'));
    assert_eq!(route(&second).cells.last(), Some(&pose));
    stage.played()
}

pub(crate) fn a_wall_across_the_first_leg_changes_the_order() -> Played {
    const OPEN: &str = "
        ......................
        ......................
        ...8.....R.......7....
        ......................
        ......................
        ......................
        ......................
        ......................
        ......................
        ......................
        ......................
        ......................
    ";
    const WALLED: &str = "
        ......#...............
        ......#...............
        ...8..#..R.......7....
        ......#...............
        ......#...............
        ......#...............
        ......#...............
        ......#...............
        ......#...............
        ......................
        ......................
        ......................
    ";
    // A vehicle on whose ground every metre counts.
    let vehicle = Vehicle { hazard_floor_per_m: 6e-3, ..spec(OPEN).vehicle };
    let budget = Budget { min_reliability: 0.1, ..spec(OPEN).budget };
    let mut stage = Stage::new(Spec { vehicle, budget, ..spec(OPEN) });
    stage.look(&Look::of(OPEN, 0.1).ground(0.2));
    let first = stage.decide();
    let (west, east) = (goal_at(&first, place(OPEN, '8')), goal_at(&first, place(OPEN, '7')));
    assert_eq!(first.plan().sequence.goals().collect::<Vec<_>>(), [west, east]);
    stage.look(&Look::of(WALLED, 0.1));
    assert!(stage.due().contains(&"route-blocked"), "{:?}", stage.due());
    stage.interrupt(&first);
    let second = stage.decide();
    assert_eq!(second.plan().sequence.goals().collect::<Vec<_>>(), [east, west]);
    let later = (Action::Reorder, Reason::BetterOrder, Transformation::Reorder);
    assert_eq!(fate(&second, west), (later.0, later.1, later.2, Some(Outcome::Adjust)));
    compared(said(&second, west), "prize", 0.8 * 0.9, None);
    let (committed, value) = (second.committed_value, second.plan().sequence.value);
    assert!(committed.is_some_and(|before| value >= 1.05 * before), "{committed:?} -> {value}");
    assert_eq!(pursued(&second), east);
    stage.played()
}

pub(crate) fn operators_that_must_be_added_expand_the_goal_anew() -> Played {
    let mut stage = Stage::new(spec(ONE_ROCK));
    stage.look(&Look::of(ONE_ROCK, 0.2));
    let first = stage.decide();
    let goal = pursued(&first);
    let operators = first.manager_after.goals[&goal].operators.len();
    stage.advance(&first, 2, 1.0);
    stage.hear(facts(&[], &["mast-up"]));
    stage.interrupt(&first);
    let second = stage.decide();
    let kept = (Action::Keep, Reason::Unchanged, Transformation::Identity);
    assert_eq!(fate(&second, goal), (kept.0, kept.1, kept.2, Some(Outcome::ReExpand)));
    assert_eq!(second.manager_after.goals[&goal].operators.len(), operators + 1, "raise, image");
    compared(said(&second, goal), "prize", 0.8 * 0.8, None);
    stage.achieve(&second);
    let third = stage.decide();
    assert_eq!(said(&third, goal).action, Action::Achieve);
    stage.played()
}

pub(crate) fn three_cells_of_one_map_make_three_kinds_of_goals() -> Played {
    // One cell certain and interesting (9), one that would be if its reading could be trusted (8), and one that two
    // instruments contradict each other about (6).
    const GLOW: &str = "
        ........................
        ........................
        .R....9.....8......6....
        ........................
        ........................
    ";
    const DOUBT: &str = "
        ........................
        ........................
        ............7...........
        ........................
        ........................
    ";
    let against = GLOW.replace(['.', 'R', '9', '8'], "?").replace('6', "0");
    let image = Directive { min_interest: 0.6, ..directive("image") };
    let told = looking_again(GLOW);
    let directives = vec![image, directive("look"), directive("judge")];
    let mut stage = Stage::new(Spec { directives, ..told });
    stage.look(&Look::of(GLOW, 0.1).doubts(DOUBT).trace(&against, 0.1));
    let decision = stage.decide();
    let kinds: Vec<(wisdom_grid::Cell, Kind)> = decision
        .manager_after
        .goals
        .values()
        .map(|goal| (goal.target, stage.rover.spec().directives[goal.directive].kind))
        .collect();
    let mut kinds = kinds;
    kinds.sort_by_key(|(target, _)| target.col);
    let expected = [('9', Kind::Inspect), ('8', Kind::LookAgain), ('6', Kind::Adjudicate)];
    assert_eq!(kinds, expected.map(|(sign, kind)| (place(GLOW, sign), kind)));
    let prize = |sign| term(said(&decision, goal_at(&decision, place(GLOW, sign))), "prize").0;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert!(near(prize('9'), 0.9 * 0.9), "what it is: {}", prize('9'));
    let doubt = f64::from(0.7_f32);
    assert!(near(prize('8'), 0.8 * 0.9 - 0.8 * (1.0 - doubt)), "what a look adds: {}", prize('8'));
    assert!(near(prize('6'), 0.6 * 0.9 * 0.9), "for times against: {}", prize('6'));
    stage.played()
}
