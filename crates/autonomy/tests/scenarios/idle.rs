//! A rover that can reach nothing is never idle.

use wisdom_autonomy::{Act, Budget, Fallback, MapUpdate, Spec, Triggers, Wake};
use wisdom_goals::{Action, Directive, Reason, Transformation, Window};

use crate::stage::{
    Look, Played, Stage, compared, directive, fate, goal_at, place, route, said, spec, updated,
};

/// An island; the only rock lies beyond the pits.
const ISLAND: &str = "
    .........#........
    .........#........
    .........#........
    .R..H....#....9...
    .........#........
    .........#........
    .........#........
";

fn stranded() -> Spec {
    let fallback = Fallback {
        max_looks: 2,
        look_range_m: 2.0,
        min_ignorance: 0.1,
        home: place(ISLAND, 'H'),
        return_home: true,
    };
    updated(Spec { fallback, ..spec(ISLAND) }, "glow", MapUpdate::Weighted)
}

pub(crate) fn with_everything_unreachable_it_looks_then_moves_then_goes_home_then_waits_for_word()
-> Played {
    let mut stage = Stage::new(stranded());
    stage.at = place(ISLAND, 'R');
    let look = Look::of(ISLAND, 0.6).ground(0.1);
    stage.look(&look);
    let first = stage.decide();
    let goal = goal_at(&first, place(ISLAND, '9'));
    let away = (Action::Defer, Reason::Unreachable, Transformation::Identity, None);
    assert_eq!(fate(&first, goal), away);
    compared(said(&first, goal), "poses", 0.0, Some(1.0));
    assert_eq!(first.act.name(), "look");
    assert_eq!(route(&first).cells, [stage.at], "first from where it stands");
    stage.arrive(&first);
    stage.look(&look);
    let second = stage.decide();
    assert_eq!(second.act.name(), "look");
    assert!(route(&second).cells.len() > 1, "then from another place");
    stage.arrive(&second);
    stage.look(&look);
    let third = stage.decide();
    assert!(matches!(third.act, Act::Home { .. }), "then home: {:?}", third.act);
    stage.arrive(&third);
    assert_eq!(stage.at, place(ISLAND, 'H'));
    let fourth = stage.decide();
    assert_eq!(fourth.act, Act::Wait { wake: Wake::Word }, "then it waits, and says for what");
    assert_eq!(fate(&fourth, goal), away, "the goal stays known");
    stage.played()
}

pub(crate) fn with_a_window_still_to_open_it_waits_for_that_time() -> Played {
    let opens_s = 50_000.0;
    let window = Some(Window { open_s: opens_s, close_s: 2.0 * opens_s });
    let directives = vec![Directive { window, ..directive("image") }];
    let told = stranded();
    let fallback = Fallback { max_looks: 0, ..told.fallback };
    let triggers = Triggers { watchdog_s: opens_s, ..told.triggers };
    let mut stage = Stage::new(Spec { directives, fallback, triggers, ..told });
    stage.look(&Look::of(ISLAND, 0.2).ground(0.1));
    let decision = stage.decide();
    assert_eq!(decision.act, Act::Wait { wake: Wake::Time(opens_s) });
    // It wakes; once the window is open there is no time left to wait for.
    stage.spent.time_s = opens_s;
    stage.tick();
    assert_eq!(stage.due(), ["watchdog"]);
    assert_eq!(stage.decide().act, Act::Wait { wake: Wake::Word });
    stage.played()
}

/// Nothing to pursue; the east is hardly known, the west a little better.
#[test]
fn when_the_best_vantage_is_too_dear_it_looks_from_a_nearer_one() {
    const PLAIN: &str = "
        ....................
        ....................
        ....................
        .R..................
        ....................
        ....................
        ....................
    ";
    const DOUBT: &str = "
        22222222444444449999
        22222222444444449999
        22222222444444449999
        22222222444444449999
        22222222444444449999
        22222222444444449999
        22222222444444449999
    ";
    // Ten metres of level ground at 3.4 kJ each: the far east is out of reach.
    let told = spec(PLAIN);
    let budget = Budget { energy_j: 34_000.0, ..told.budget };
    let fallback = Fallback { max_looks: 1, min_ignorance: 0.3, ..told.fallback };
    let mut stage = Stage::new(Spec { budget, fallback, ..told });
    stage.look(&Look::of(PLAIN, 0.2).ground(0.1).doubts(DOUBT));
    let decision = stage.decide();
    let Act::Look { route, ignorance } = &decision.act else {
        panic!("it could look from nearer: {:?}", decision.act);
    };
    assert!(route.cost.energy_j <= 34_000.0 && *ignorance > 0.0);
}
