//! Scenes on ground drawn by hand: each brings about one change of mind, and says why with which numbers.

mod changes;
mod idle;
mod stage;
mod triggers;

use std::collections::BTreeSet;

use stage::Played;
use wisdom_goals::{Outcome, Transformation};

/// Each scene is a test of its name; all of them together are what the last tests of this file look at.
macro_rules! scenes {
    ($($of:ident::$name:ident),* $(,)?) => {
        $(
            #[test]
            fn $name() {
                $of::$name();
            }
        )*

        const SCENES: &[fn() -> Played] = &[$($of::$name),*];
    };
}

scenes! {
    changes::a_target_that_proves_unreachable_is_given_up,
    changes::a_target_that_proves_unreachable_gives_way_to_another_of_its_kind,
    changes::interest_that_a_closer_look_denies_is_lost,
    changes::a_better_rock_takes_the_place_of_one_that_was_committed_to,
    changes::two_maxima_that_merge_leave_one_goal,
    changes::a_maximum_that_splits_brings_forth_a_child,
    changes::a_slope_that_eats_the_budget_erodes_the_goal_to_what_can_be_afforded,
    changes::a_slope_that_eats_the_budget_defers_a_goal_without_a_substitute,
    changes::an_instrument_that_fails_erodes_its_goals_to_their_substitute,
    changes::a_failed_try_erodes_the_goal_to_its_substitute,
    changes::a_failed_try_is_repaired_and_the_last_one_ends_the_goal,
    changes::a_command_makes_a_goal_and_its_withdrawal_ends_it,
    changes::a_contradiction_is_adjudicated_and_settled_by_a_closer_look,
    changes::a_peak_that_moves_takes_its_goal_along,
    changes::a_class_that_clears_up_makes_the_goal_concrete_and_one_that_blurs_abstract,
    changes::a_look_that_keeps_its_promise_turns_look_again_into_inspect,
    changes::readings_that_got_worse_turn_inspect_into_look_again,
    changes::an_expert_that_speaks_against_turns_inspect_into_adjudicate,
    changes::a_pose_that_is_lost_is_replaced_by_another,
    changes::a_wall_across_the_first_leg_changes_the_order,
    changes::operators_that_must_be_added_expand_the_goal_anew,
    changes::three_cells_of_one_map_make_three_kinds_of_goals,
    idle::with_everything_unreachable_it_looks_then_moves_then_goes_home_then_waits_for_word,
    idle::with_a_window_still_to_open_it_waits_for_that_time,
    triggers::a_prize_that_changes_on_the_way_ahead_calls_for_a_decision,
    triggers::a_way_ahead_below_the_floor_calls_for_a_decision_and_defers_the_goal,
    triggers::a_window_that_is_about_to_close_calls_for_a_decision,
    triggers::a_long_time_without_a_decision_calls_for_one,
    triggers::the_event_pace_never_asks_for_the_time,
    triggers::the_cadence_pace_keeps_what_is_not_urgent_until_it_is_time,
    triggers::the_hybrid_pace_asks_at_events_and_at_its_time,
}

fn all() -> Played {
    SCENES.iter().map(|scene| scene()).fold(Played::default(), Played::join)
}

#[test]
fn the_scenes_show_every_transformation_and_every_outcome() {
    let played = all();
    assert_eq!(played.transformations, Transformation::ALL.iter().copied().collect());
    assert_eq!(played.outcomes, Outcome::ALL.iter().copied().collect());
}

#[test]
fn the_scenes_show_all_ten_triggers() {
    // The ten of the goal model, in its order; two of them have two names.
    let ten = BTreeSet::from([
        "goal-ended",
        "leg-failed",
        "interest-changed",
        "corridor-changed",
        "new-candidate",
        "risk",
        "route-blocked",
        "budget-drift",
        "window-closing",
        "command",
        "conflict",
        "watchdog",
    ]);
    let missing: Vec<_> = ten.difference(&all().triggers).copied().collect();
    assert!(missing.is_empty(), "{missing:?}");
}
