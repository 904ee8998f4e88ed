//! What calls for a decision, and when.

use wisdom_autonomy::{Budget, MapUpdate, Pace, Spec, Trigger, Triggers};
use wisdom_goals::{Action, Directive, Outcome, Reason, Transformation, Window};
use wisdom_planner::Vehicle;

use crate::stage::{Look, Played, Stage, directive, fate, pursued, said, spec, term, updated};

const ROCK: &str = "
    ....................
    ....................
    .R..............8...
    ....................
    ....................
    ....................
";

/// Something shows on the way to the rock.
const ON_THE_WAY: &str = "
    ....................
    ....................
    .R.......9......8...
    ....................
    ....................
    ....................
";

/// The goal goes on as it was.
fn goes_on(stage: &mut Stage, first: &wisdom_autonomy::Decision) -> wisdom_autonomy::Decision {
    let goal = pursued(first);
    stage.interrupt(first);
    let second = stage.decide();
    let kept = (Action::Keep, Reason::Unchanged, Transformation::Identity);
    assert_eq!(fate(&second, goal), (kept.0, kept.1, kept.2, Some(Outcome::Continue)));
    assert_eq!(pursued(&second), goal);
    second
}

fn found<T>(stage: &Stage, wanted: impl Fn(&Trigger) -> Option<T>) -> T {
    let triggers = stage.rover.triggers();
    triggers.iter().find_map(wanted).unwrap_or_else(|| panic!("not among {triggers:?}"))
}

pub(crate) fn a_prize_that_changes_on_the_way_ahead_calls_for_a_decision() -> Played {
    let triggers = Triggers { corridor_change: 0.3, ..Triggers::default() };
    let mut stage = Stage::new(Spec { triggers, ..spec(ROCK) });
    stage.look(&Look::of(ROCK, 0.2));
    let first = stage.decide();
    stage.advance(&first, 2, 1.0);
    stage.look(&Look::of(ON_THE_WAY, 0.15));
    let (cell, before, after) = found(&stage, |t| match t {
        Trigger::CorridorChanged { cell, before, after } => Some((*cell, *before, *after)),
        _ => None,
    });
    assert_eq!((cell, before), (crate::stage::place(ON_THE_WAY, '9'), 0.0));
    assert!((after - 0.9 * 0.85).abs() < 1e-6, "{after}");
    let second = goes_on(&mut stage, &first);
    assert_eq!(second.plan().sequence.stops.len(), 2, "what showed is taken in on the way");
    stage.played()
}

pub(crate) fn a_way_ahead_below_the_floor_calls_for_a_decision_and_defers_the_goal() -> Played {
    let vehicle = Vehicle { hazard_floor_per_m: 4e-3, ..spec(ROCK).vehicle };
    let budget = Budget { min_reliability: 0.7, ..spec(ROCK).budget };
    let told = updated(Spec { vehicle, budget, ..spec(ROCK) }, "elevation", MapUpdate::Latest);
    let mut stage = Stage::new(told);
    stage.look(&Look::of(ROCK, 0.2).ground(0.1));
    let first = stage.decide();
    let goal = pursued(&first);
    stage.advance(&first, 2, 1.0);
    // Dust: the ground ahead is hardly known any more.
    stage.look(&Look::of(ROCK, 0.2).ground(0.9));
    let (reliability, floor) = found(&stage, |t| match t {
        Trigger::Risk { reliability, floor } => Some((*reliability, *floor)),
        _ => None,
    });
    assert!(reliability < floor && floor == 0.7, "{reliability} against {floor}");
    stage.interrupt(&first);
    let second = stage.decide();
    let deferred = (Action::Defer, Reason::Risk, Transformation::Identity);
    assert_eq!(fate(&second, goal), (deferred.0, deferred.1, deferred.2, Some(Outcome::Defer)));
    let (chance, least) = term(said(&second, goal), "reliability");
    assert!((chance - reliability).abs() < 1e-9 && least == Some(0.7), "{chance} {least:?}");
    assert_eq!(second.act.name(), "wait");
    stage.played()
}

pub(crate) fn a_window_that_is_about_to_close_calls_for_a_decision() -> Played {
    let window = Some(Window { open_s: 0.0, close_s: 1000.0 });
    let directives = vec![Directive { window, ..directive("image") }];
    let mut stage = Stage::new(Spec { directives, ..spec(ROCK) });
    stage.look(&Look::of(ROCK, 0.2));
    let first = stage.decide();
    stage.advance(&first, 3, 1.0);
    stage.tick();
    assert_eq!(stage.due(), [""; 0], "a quarter of an hour and more is left");
    stage.advance(&first, 2, 1.0);
    stage.tick();
    let left_s = found(&stage, |t| match t {
        Trigger::WindowClosing { left_s, .. } => Some(*left_s),
        _ => None,
    });
    assert!((left_s - (1000.0 - stage.spent.time_s)).abs() < 1e-9 && left_s <= 900.0, "{left_s}");
    goes_on(&mut stage, &first);
    stage.played()
}

pub(crate) fn a_long_time_without_a_decision_calls_for_one() -> Played {
    let triggers = Triggers { watchdog_s: 100.0, ..Triggers::default() };
    let mut stage = Stage::new(Spec { triggers, ..spec(ROCK) });
    stage.look(&Look::of(ROCK, 0.2));
    let first = stage.decide();
    stage.advance(&first, 3, 1.0);
    stage.tick();
    assert_eq!(stage.due(), [""; 0]);
    stage.advance(&first, 2, 1.0);
    stage.tick();
    assert_eq!(stage.due(), ["watchdog"]);
    goes_on(&mut stage, &first);
    stage.played()
}

/// A rover at a pace that decides every 100 s if it looks at the clock, on its way to the rock.
fn at_pace(pace: Pace) -> (Stage, wisdom_autonomy::Decision) {
    let triggers = Triggers { pace, cadence_s: 100.0, ..Triggers::default() };
    let mut stage = Stage::new(Spec { triggers, ..spec(ROCK) });
    stage.look(&Look::of(ROCK, 0.2));
    assert_eq!(stage.due(), ["start"]);
    let first = stage.decide();
    // Three metres in 76 s, and something shows on the way.
    stage.advance(&first, 3, 1.0);
    stage.look(&Look::of(ON_THE_WAY, 0.15));
    (stage, first)
}

pub(crate) fn the_event_pace_never_asks_for_the_time() -> Played {
    let (mut stage, first) = at_pace(Pace::Event);
    assert_eq!(stage.due(), ["new-candidate"]);
    let second = goes_on(&mut stage, &first);
    stage.advance(&second, 10, 1.0);
    stage.tick();
    assert_eq!(stage.due(), [""; 0], "253 s on");
    stage.played()
}

pub(crate) fn the_cadence_pace_keeps_what_is_not_urgent_until_it_is_time() -> Played {
    let (mut stage, first) = at_pace(Pace::Cadence);
    assert_eq!(stage.due(), [""; 0], "it is not time yet");
    stage.advance(&first, 1, 1.0);
    stage.tick();
    assert_eq!(stage.due(), ["new-candidate", "cadence"]);
    let second = goes_on(&mut stage, &first);
    let names: Vec<&str> = second.triggers.iter().map(Trigger::name).collect();
    assert_eq!(names, ["new-candidate", "cadence"]);
    // What is urgent does not wait.
    stage.advance(&second, 1, 1.0);
    let wall = ON_THE_WAY.replace("..8", "#.8");
    stage.look(&Look::of(&wall, 0.1));
    assert!(stage.due().contains(&"route-blocked"), "{:?}", stage.due());
    stage.played()
}

pub(crate) fn the_hybrid_pace_asks_at_events_and_at_its_time() -> Played {
    let (mut stage, first) = at_pace(Pace::Hybrid);
    assert_eq!(stage.due(), ["new-candidate"]);
    let second = goes_on(&mut stage, &first);
    stage.advance(&second, 4, 1.0);
    stage.tick();
    assert_eq!(stage.due(), ["cadence"]);
    goes_on(&mut stage, &second);
    stage.played()
}
