//! What becomes of goals while the map, the budgets and the rover's luck change.

mod rover;

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use wisdom_goals::{
    Access, Action, Approach, Cause, Deliberated, Directive, Domain, Event, Extraction, FactSet,
    GoalId, GoalManager, Limits, ManagerSpec, Policy, Preferences, Problem, Reason, Selection,
    Status, Survey, Verdict, View, Weighed, poses, serves, sites,
};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{FieldOptions, field};
use wisdom_terrain::Layer;

use rover::{directives, domain, ground, travel};

const NO_LIMITS: Limits = Limits {
    time_s: f64::INFINITY,
    energy_j: f64::INFINITY,
    data_mb: f64::INFINITY,
    min_reliability: 0.0,
};

/// A rover on flat ground that takes a picture of every maximum.
struct Rig {
    manager: GoalManager,
    domain: Domain,
    facts: FactSet,
    at: Cell,
    limits: Limits,
    policy: Policy,
    hazard_per_m: f32,
    blocked: Vec<Cell>,
    /// Interest where it is not the prize.
    interest: Option<Raster<f32>>,
    pinned: Option<GoalId>,
    used: BTreeSet<GoalId>,
}

/// What one deliberation said.
struct Told {
    verdicts: Vec<Verdict>,
    selection: Selection,
}

impl Told {
    fn of(&self, id: u32) -> &Verdict {
        self.verdicts
            .iter()
            .find(|v| v.goal.id == GoalId(id))
            .unwrap_or_else(|| panic!("nothing is said of G{id}: {:?}", self.verdicts))
    }

    fn says(&self, id: u32) -> (Action, Reason, Cause) {
        let verdict = self.of(id);
        (verdict.action, verdict.reason, verdict.cause)
    }

    fn order(&self) -> Vec<u32> {
        self.selection.sequence().goals().map(|g| g.0).collect()
    }
}

/// A map drawn with digits, tenths; cells are one metre.
fn picture(rows: &[&str]) -> Raster<f32> {
    let spec = GridSpec::new(rows.len(), rows[0].len(), 1.0).expect("a small grid");
    Raster::from_fn(spec, |c| f32::from(rows[c.row].as_bytes()[c.col] - b'0') / 10.0)
}

/// Goals 2 m apart are two; a maximum within 2 m is the same.
fn spec() -> ManagerSpec {
    ManagerSpec {
        extraction: Extraction { min_separation_m: 2.0, ..Extraction::default() },
        identity_radius_m: 2.0,
        ..ManagerSpec::default()
    }
}

/// Only pictures are taken.
fn camera() -> Vec<Directive> {
    vec![directives(&domain()).swap_remove(1)]
}

impl Rig {
    fn new(spec: ManagerSpec, directives: Vec<Directive>, at: Cell) -> Self {
        let domain = domain();
        Self {
            manager: GoalManager::new(spec, directives),
            facts: domain.initial(),
            domain,
            at,
            limits: NO_LIMITS,
            policy: Policy::ExpectedInterest,
            hazard_per_m: 0.001,
            blocked: Vec::new(),
            interest: None,
            pinned: None,
            used: BTreeSet::new(),
        }
    }

    /// A rover with a camera at this column of a map of one row.
    fn at(col: usize) -> Self {
        Self::new(spec(), camera(), Cell::new(0, col))
    }

    /// The readings changed, and the rover thinks about it.
    fn sees(&mut self, rows: &[&str]) -> Told {
        self.decide(&picture(rows), true)
    }

    /// Nothing new was read, but something was done or spent.
    fn thinks_again(&mut self, rows: &[&str]) -> Told {
        self.decide(&picture(rows), false)
    }

    /// Whatever is decided, the contracts of a deliberation hold.
    fn decide(&mut self, prize: &Raster<f32>, map_changed: bool) -> Told {
        let grid = prize.spec();
        let known: BTreeSet<GoalId> = self.manager.state().goals.keys().copied().collect();
        let first = self.manager.state().decision == 0;
        let interest = self.interest.clone().unwrap_or_else(|| prize.clone());
        let none = Raster::filled(grid, 0.0);
        let blocked = Raster::from_fn(grid, |c| self.blocked.contains(&c));
        let digest = |cell: Cell| {
            let near = grid.around(cell, 2);
            near.cells().fold(0u64, |bits, c| bits << 1 | u64::from(blocked[c]))
        };
        let found = sites(prize, &self.manager.survival());
        let survey = Survey {
            inspect: View { sites: &found, signal: prize, interest: &interest },
            look_again: None,
            adjudicate: None,
            ignorance: &none,
            paradox: &none,
            contradiction: &none,
            credit: &|_| vec![1.0],
            heard: &|_| 1,
            doubt: &|_| 0.0,
            class: &|_| None,
            able: &|_| true,
            ground: &|cell| Some(digest(cell)),
            stand: self.at,
            time_s: 0.0,
            map_changed,
        };
        let mut revision = self.manager.revise(&survey);

        let flat = Raster::filled(grid, 0.0);
        let ground = ground(flat.clone(), Raster::filled(grid, self.hazard_per_m), blocked.clone());
        let reach = field(&ground, self.at, &FieldOptions::default());
        let elevation = Layer::certain(flat).expect("heights are finite");
        let approach = Approach { standoff_m: 0.0, eye_height_m: 1.0, poses: 1 };
        let ways = self.manager.state().goals.values();
        let mut ways: BTreeMap<_, _> =
            ways.map(|g| (g.id, poses(&reach, &elevation, g.target, &approach))).collect();
        let access = Access {
            poses: &|target, _| poses(&reach, &elevation, target, &approach),
            serves: &|pose, target, _| serves(&reach, &elevation, pose, target, &approach),
        };
        self.manager.keep_in_reach(&mut ways, access, &survey, &mut revision);
        let shortlist = self.manager.shortlist(&ways, 1.0);
        let mut cells = vec![self.at];
        let mut nodes = BTreeMap::new();
        for id in &shortlist.kept {
            nodes.insert(*id, vec![cells.len()]);
            cells.push(ways[id][0].0);
        }
        let travel = travel(&ground, &cells);
        let candidates = self.manager.candidates(&shortlist, &nodes, 1.0, 0.0);
        let directives = self.manager.directives().to_vec();
        let problem = Problem {
            candidates: &candidates,
            travel: &travel,
            ends: &[],
            domain: &self.domain,
            directives: &directives,
            facts: self.facts,
            limits: self.limits,
            waiting_w: 0.0,
            policy: self.policy,
            preferences: Preferences::default(),
        };
        let selection = self.manager.select(&problem, self.pinned);
        let weighed = Weighed {
            selection: &selection,
            shortlist: &shortlist,
            poses: &ways,
            problem,
            nodes: &cells,
            spacing_m: 1.0,
            map_changed,
        };
        let Deliberated { verdicts, transitions } = self.manager.commit(revision, weighed);
        for step in &transitions {
            assert!(step.to.may_follow(step.from), "{step:?}");
        }
        let told = Told { verdicts, selection };
        self.check(&told, &known, first, map_changed);
        told
    }

    fn check(&mut self, told: &Told, known: &BTreeSet<GoalId>, first: bool, map_changed: bool) {
        let state = self.manager.state();
        let ids: Vec<GoalId> = told.verdicts.iter().map(|v| v.goal.id).collect();
        let open: BTreeSet<GoalId> = state.goals.keys().copied().collect();
        assert_eq!(
            ids,
            known.union(&open).copied().collect::<Vec<_>>(),
            "every known goal has exactly one verdict"
        );
        let order: Vec<GoalId> = told.selection.sequence().goals().collect();
        assert_eq!(state.agenda, order);
        for verdict in &told.verdicts {
            let Verdict { goal, action, .. } = verdict;
            let status = match action {
                Action::Add | Action::Keep | Action::Modify | Action::Reorder => Status::Committed,
                Action::Defer => Status::Formulated,
                Action::Drop => Status::Dropped,
                Action::Achieve => Status::Finished,
            };
            assert_eq!(goal.status(), status, "{verdict:?}");
            assert_eq!(verdict.turn, order.iter().position(|id| *id == goal.id), "{verdict:?}");
            assert_eq!(open.contains(&goal.id), status.is_open(), "{verdict:?}");
            assert_eq!(first, verdict.cause == Cause::Start, "{verdict:?}");
            assert!(map_changed || verdict.cause != Cause::Discovery, "{verdict:?}");
            let new = !known.contains(&goal.id);
            assert!(!new || self.used.insert(goal.id), "{} is used again", goal.id);
        }
    }
}

#[test]
fn a_new_maximum_is_added() {
    let mut rig = Rig::at(5);
    let told = rig.sees(&["0900000000000"]);
    assert_eq!(told.says(0), (Action::Add, Reason::NewMaximum, Cause::Start));
    let told = rig.sees(&["0900000000800"]);
    assert_eq!(told.says(0), (Action::Keep, Reason::Unchanged, Cause::Discovery));
    assert_eq!(told.says(1), (Action::Add, Reason::NewMaximum, Cause::Discovery));
    assert_eq!(told.of(1).goal.target, Cell::new(0, 10));
    assert_eq!(told.order(), [0, 1]);
}

#[test]
fn a_goal_that_a_closer_look_finds_dull_is_dropped() {
    let mut rig = Rig::at(6);
    rig.sees(&["0900000000800"]);
    let told = rig.sees(&["0000000000800"]);
    assert_eq!(told.says(0), (Action::Drop, Reason::LostInterest, Cause::Discovery));
    let term = &told.of(0).terms[0];
    // Half of what it was worth would have kept it.
    assert_eq!((term.name, term.value), ("prize", 0.0));
    assert!((term.limit.expect("a floor") - 0.45).abs() < 1e-6);
    assert_eq!(told.says(1), (Action::Keep, Reason::Unchanged, Cause::Discovery));
    assert_eq!(told.order(), [1]);
}

#[test]
fn a_goal_whose_interest_falls_below_what_its_directive_asks_is_dropped() {
    let mut directives = camera();
    directives[0].min_interest = 0.55;
    let mut rig = Rig::new(spec(), directives, Cell::new(0, 6));
    rig.sees(&["0900000000800"]);
    let told = rig.sees(&["0500000000800"]);
    assert_eq!(told.says(0), (Action::Drop, Reason::LostInterest, Cause::Discovery));
    assert_eq!(told.of(0).terms[0].limit, Some(0.55));
}

#[test]
fn a_goal_keeps_its_name_while_its_maximum_moves() {
    let mut rig = Rig::at(6);
    rig.sees(&["0090000000000"]);
    let told = rig.sees(&["0009000000000"]);
    assert_eq!(told.says(0), (Action::Modify, Reason::PeakMoved, Cause::Discovery));
    assert_eq!(told.of(0).goal.target, Cell::new(0, 3));
    let moved = told.of(0).terms.iter().find(|t| t.name == "moved_m").expect("it says how far");
    assert_eq!(moved.value, 1.0);
    // The old cell is as good as the middle of the wider top: nothing moves.
    let told = rig.sees(&["0009990000000"]);
    assert_eq!(told.says(0), (Action::Keep, Reason::Unchanged, Cause::Discovery));
    assert_eq!(told.of(0).goal.target, Cell::new(0, 3));
}

#[test]
fn two_maxima_that_become_one_are_one_goal() {
    let mut rig = Rig::at(9);
    rig.sees(&["0008007000000"]);
    let told = rig.sees(&["0000090000000"]);
    assert_eq!(told.says(0), (Action::Drop, Reason::Merged, Cause::Discovery));
    assert_eq!(told.of(0).other, Some(GoalId(1)), "the nearer goal stays");
    assert_eq!(told.says(1), (Action::Add, Reason::Promoted, Cause::Discovery));
    assert_eq!(told.order(), [1]);
}

/// The maximum that both were near is one that nobody wants any more.
#[test]
fn no_goal_is_merged_into_one_that_goes_in_the_same_breath() {
    let mut rig = Rig::at(9);
    rig.sees(&["0080007000000"]);
    rig.interest = Some(picture(&["0000000000000"]));
    let told = rig.sees(&["0000090000000"]);
    for id in [0, 1] {
        assert_eq!(told.says(id), (Action::Drop, Reason::LostInterest, Cause::Discovery));
        assert_eq!(told.of(id).other, None);
    }
}

#[test]
fn a_better_rock_changes_the_order_only_beyond_the_hysteresis() {
    let mut rig = Rig::at(7);
    rig.hazard_per_m = 0.02;
    assert_eq!(rig.sees(&["000900000008000"]).order(), [0, 1]);
    // The other order is better by 1 %.
    let told = rig.sees(&["000800000009000"]);
    assert!(told.selection.held);
    assert_eq!(told.order(), [0, 1]);
    assert_eq!(told.says(0), (Action::Keep, Reason::Unchanged, Cause::Discovery));
    let best = &told.selection.family[0];
    assert_eq!(best.goals().collect::<Vec<_>>(), [GoalId(1), GoalId(0)]);
    assert!(best.value > told.selection.sequence().value);
    assert!(best.value < 1.05 * told.selection.sequence().value);
    // Now it is better by 9 %.
    let told = rig.sees(&["000400000009000"]);
    assert!(!told.selection.held);
    assert_eq!(told.order(), [1, 0]);
    let reordered: Vec<_> =
        told.verdicts.iter().filter(|v| v.action == Action::Reorder).map(|v| v.reason).collect();
    assert_eq!(reordered, [Reason::BetterOrder], "one goal overtook the other");
}

#[test]
fn a_small_find_is_held_back_and_a_larger_one_is_added() {
    let mut rig = Rig::at(7);
    rig.sees(&["09000900000900000"]);
    let told = rig.sees(&["09000900000900010"]);
    assert!(told.selection.held);
    assert_eq!(told.says(3), (Action::Defer, Reason::Held, Cause::Discovery));
    let term = &told.of(3).terms[0];
    let least = term.limit.expect("what it would have taken");
    assert!(term.value > told.selection.sequence().value && term.value < least, "{term:?}");
    let told = rig.sees(&["09000900000900040"]);
    assert!(!told.selection.held);
    assert_eq!(told.says(3), (Action::Add, Reason::Promoted, Cause::Discovery));
    assert_eq!(told.order().len(), 4);
}

#[test]
fn the_goal_of_the_leg_under_way_stays_first() {
    let mut rig = Rig::at(7);
    rig.hazard_per_m = 0.05;
    assert_eq!(rig.sees(&["000300000000000"]).order(), [0]);
    rig.pinned = Some(GoalId(0));
    let told = rig.sees(&["000300000900000"]);
    assert_eq!(told.order(), [0, 1]);
    rig.pinned = None;
    assert_eq!(rig.thinks_again(&["000300000900000"]).order(), [1, 0]);
    // A pinned goal that is gone binds nobody.
    rig.pinned = Some(GoalId(0));
    let told = rig.sees(&["000000000900000"]);
    assert_eq!((told.order(), told.selection.pinned), (vec![1], None));
}

#[test]
fn a_budget_cut_defers_what_no_longer_fits_and_says_by_how_much() {
    // A picture and the way to it: 4 m to the left, 6 m to the right.
    let near_s = 65.0 + 4.0 / 0.04 / 0.99;
    for (reason, name) in [(Reason::Time, "time_s"), (Reason::Energy, "energy_j")] {
        let mut rig = Rig::at(5);
        let told = rig.sees(&["090000000009"]);
        assert_eq!(told.order(), [0, 1]);
        let whole = told.selection.sequence();
        let (time_s, energy_j) = (whole.time_s, whole.energy_j);
        // Both together no longer fit: the farther one goes, and its overrun is that of both.
        match reason {
            Reason::Time => rig.limits.time_s = time_s - 1.0,
            _ => rig.limits.energy_j = energy_j - 1.0,
        }
        let told = rig.thinks_again(&["090000000009"]);
        let kept = told.order();
        assert_eq!(kept, [0]);
        assert_eq!(told.says(1), (Action::Defer, reason, Cause::Execution));
        let term = told.of(1).terms[0].clone();
        assert_eq!(term.name, name);
        let limit = term.limit.expect("a limit");
        assert!(term.value > limit && term.value <= limit + 1.0 + 1e-6, "{term:?}");
        // Not even one fits alone: what each needs alone is said.
        match reason {
            Reason::Time => rig.limits.time_s = 100.0,
            _ => rig.limits.energy_j = 100.0,
        }
        let told = rig.thinks_again(&["090000000009"]);
        assert_eq!(told.order(), [0; 0]);
        assert_eq!(told.says(0), (Action::Defer, reason, Cause::Execution));
        let term = &told.of(0).terms[0];
        assert_eq!(term.limit, Some(100.0));
        if reason == Reason::Time {
            assert!((term.value - near_s).abs() < 1e-6, "{term:?}");
        }
        // With the budget back, they are wanted again.
        rig.limits = NO_LIMITS;
        let told = rig.thinks_again(&["090000000009"]);
        assert_eq!(told.says(0), (Action::Add, Reason::Promoted, Cause::Execution));
    }
}

#[test]
fn risk_and_data_keep_goals_out_too() {
    let mut rig = Rig::at(5);
    rig.hazard_per_m = 0.05;
    rig.limits.min_reliability = 0.75;
    let told = rig.sees(&["090000000009"]);
    assert_eq!(told.order(), [0]);
    assert_eq!(told.says(1), (Action::Defer, Reason::Risk, Cause::Start));
    let term = &told.of(1).terms[0];
    assert!(term.value < 0.75 && term.limit == Some(0.75));
    rig.limits = Limits { data_mb: 40.0, ..NO_LIMITS };
    let told = rig.thinks_again(&["090000000009"]);
    assert_eq!(told.says(1), (Action::Defer, Reason::Data, Cause::Execution));
    assert_eq!((told.of(1).terms[0].value, told.of(1).terms[0].limit), (80.0, Some(40.0)));
}

#[test]
fn goals_beyond_those_sequenced_exactly_say_which_bound_they_missed() {
    let mut rig = Rig::new(ManagerSpec { max_sequenced: 1, ..spec() }, camera(), Cell::new(0, 6));
    let told = rig.sees(&["0900000000500"]);
    assert_eq!(told.says(1), (Action::Defer, Reason::BeyondExact, Cause::Start));
    let term = &told.of(1).terms[0];
    let reliability = |metres: f64| (-0.001 * metres).exp();
    assert!((term.value - 0.5 * reliability(4.0)).abs() < 1e-6);
    assert!((term.limit.expect("the bound to beat") - 0.9 * reliability(5.0)).abs() < 1e-6);
}

#[test]
fn a_goal_not_ready_for_its_turn_says_so() {
    let mut rig = Rig::new(spec(), vec![directives(&domain()).swap_remove(2)], Cell::new(0, 6));
    let told = rig.sees(&["0900000000000"]);
    assert_eq!(told.says(0), (Action::Defer, Reason::Preconditions, Cause::Start));
}

#[test]
fn a_committed_goal_out_of_reach_is_dropped_and_tried_anew_once_its_ground_changed() {
    let map = ["0090000000000"];
    let mut rig = Rig::at(6);
    rig.sees(&map);
    let wall = vec![Cell::new(0, 3)];
    rig.blocked.clone_from(&wall);
    let told = rig.sees(&map);
    assert_eq!(told.says(0), (Action::Drop, Reason::Unreachable, Cause::Discovery));
    assert!(rig.sees(&map).verdicts.is_empty(), "the ground is still the same");
    rig.blocked.clear();
    let told = rig.sees(&map);
    assert_eq!(told.says(1), (Action::Add, Reason::Reopened, Cause::Discovery));
    // One reopening is all it gets.
    rig.blocked = wall;
    let told = rig.sees(&map);
    assert_eq!(told.says(1), (Action::Drop, Reason::Unreachable, Cause::Discovery));
    rig.blocked.clear();
    assert!(rig.sees(&map).verdicts.is_empty());
}

#[test]
fn places_are_reopened_as_often_as_allowed() {
    let map = ["0090000000000"];
    for max_reopenings in 0..4 {
        let mut rig = Rig::new(ManagerSpec { max_reopenings, ..spec() }, camera(), Cell::new(0, 6));
        let mut reopened = 0;
        for turn in 0..20 {
            rig.blocked = if turn % 2 == 1 { vec![Cell::new(0, 3)] } else { Vec::new() };
            let told = rig.sees(&map);
            reopened += told.verdicts.iter().filter(|v| v.reason == Reason::Reopened).count();
        }
        assert_eq!(reopened, max_reopenings as usize);
    }
}

/// A goal on trial at a reopened place may lose its interest and leave no trace; the trial counts all the same.
#[test]
fn a_trial_that_ends_in_lost_interest_counts() {
    let (map, dull) = (["0090000000000"], ["0000000000000"]);
    let mut rig = Rig::at(6);
    rig.sees(&map);
    rig.blocked = vec![Cell::new(0, 3)];
    rig.sees(&map);
    rig.blocked.clear();
    assert_eq!(rig.sees(&map).of(1).reason, Reason::Reopened);
    assert_eq!(rig.sees(&dull).of(1).reason, Reason::LostInterest);
    rig.blocked = vec![Cell::new(0, 4)];
    rig.sees(&map);
    rig.blocked.clear();
    assert!(rig.sees(&map).verdicts.is_empty());
}

/// A contact analysis that erodes to an image.
fn arm_and_camera() -> Vec<Directive> {
    let mut pool = directives(&domain());
    pool.truncate(2);
    pool[0].weight = 2.0;
    pool[0].substitute = Some(1);
    pool
}

#[test]
fn a_failed_try_erodes_to_the_substitute_and_the_last_one_ends_the_goal() {
    let map = ["0090000000000"];
    let mut rig = Rig::new(spec(), arm_and_camera(), Cell::new(0, 6));
    assert_eq!(rig.sees(&map).of(0).goal.directive, 0);
    rig.manager.note(GoalId(0), Event::Failed);
    let told = rig.thinks_again(&map);
    assert_eq!(told.says(0), (Action::Modify, Reason::Eroded, Cause::Execution));
    assert_eq!((told.of(0).goal.directive, told.of(0).goal.attempts), (1, 1));
    assert!((told.of(0).goal.prize - 0.9).abs() < 1e-6, "an image is worth half of an analysis");
    rig.manager.note(GoalId(0), Event::Failed);
    // Erosion is what was done, whatever the instruments showed at the same time.
    let told = rig.sees(&map);
    assert_eq!(told.says(0), (Action::Drop, Reason::AttemptsSpent, Cause::Execution));
    assert_eq!((told.of(0).terms[0].value, told.of(0).terms[0].limit), (2.0, Some(2.0)));
    assert!(rig.sees(&map).verdicts.is_empty(), "a place given up brings forth no goal");
}

#[test]
fn an_erosion_is_caused_by_execution_even_when_the_map_changed() {
    let mut rig = Rig::new(spec(), arm_and_camera(), Cell::new(0, 6));
    rig.sees(&["0090000000000"]);
    rig.manager.note(GoalId(0), Event::Failed);
    let told = rig.sees(&["0080000000000"]);
    assert_eq!(told.says(0), (Action::Modify, Reason::Eroded, Cause::Execution));
}

#[test]
fn an_achieved_goal_explains_what_lies_around_it() {
    let map = ["0090070000080"];
    let mut rig = Rig::at(6);
    let told = rig.sees(&map);
    assert_eq!(told.order().len(), 2);
    // Once the better one is done it will be explained: no plan counts on both.
    assert_eq!(told.says(2), (Action::Defer, Reason::Excluded, Cause::Start));
    assert_eq!(told.of(2).other, Some(GoalId(0)));
    rig.manager.note(GoalId(0), Event::Achieved);
    let told = rig.thinks_again(&map);
    assert_eq!(told.says(0), (Action::Achieve, Reason::Done, Cause::Execution));
    // 3 m away, within the exclusion radius.
    assert_eq!(told.says(2), (Action::Drop, Reason::Explained, Cause::Execution));
    assert_eq!(told.of(2).other, Some(GoalId(0)));
    assert_eq!(told.says(1), (Action::Keep, Reason::Unchanged, Cause::Execution));
    let told = rig.sees(&map);
    assert_eq!(told.verdicts.len(), 1, "neither maximum comes back");
}

/// The target may lie off the peak, as long as it is as good; the peak is the same maximum.
#[test]
fn an_achieved_goal_explains_its_maximum_even_where_that_is_wide() {
    let mut rig = Rig::at(6);
    rig.sees(&["0999000000000000"]);
    let told = rig.sees(&["0999999999999900"]);
    assert_eq!(
        told.of(0).goal.target,
        Cell::new(0, 3),
        "nearest to the rover, 4 m from the middle"
    );
    rig.manager.note(GoalId(0), Event::Achieved);
    let told = rig.thinks_again(&["0999999999999900"]);
    assert_eq!(told.verdicts.len(), 1);
    assert_eq!(told.says(0), (Action::Achieve, Reason::Done, Cause::Execution));
}

/// A prize of nothing is no reason for a goal, however interesting the place.
#[test]
fn a_directive_without_weight_brings_forth_no_goals() {
    let mut pool = camera();
    pool[0].weight = 0.0;
    let mut rig = Rig::new(spec(), pool, Cell::new(0, 6));
    for _ in 0..3 {
        assert!(rig.sees(&["0090000000000"]).verdicts.is_empty());
    }
    assert_eq!(rig.manager.state().next_id, 0);
}

#[test]
fn a_goal_lost_and_found_again_gets_no_more_tries() {
    let (map, dull) = (["0090000000000"], ["0000000000000"]);
    let mut rig = Rig::at(6);
    rig.sees(&map);
    rig.manager.note(GoalId(0), Event::Failed);
    assert_eq!(rig.thinks_again(&map).of(0).goal.attempts, 1);
    assert_eq!(rig.sees(&dull).of(0).reason, Reason::LostInterest);
    assert_eq!(rig.sees(&map).of(1).goal.attempts, 1, "the place remembers");
    rig.manager.note(GoalId(1), Event::Failed);
    assert_eq!(rig.thinks_again(&map).of(1).reason, Reason::AttemptsSpent);
}

#[test]
fn what_a_record_remembers_is_enough_to_take_the_decision_again() {
    let mut rig = Rig::new(spec(), arm_and_camera(), Cell::new(0, 6));
    rig.sees(&["0090000000500"]);
    rig.manager.note(GoalId(0), Event::Failed);
    let remembered = rig.manager.state().clone();
    let mut other = Rig::new(spec(), arm_and_camera(), Cell::new(0, 6));
    other.manager.restore(remembered);
    other.used.clone_from(&rig.used);
    let (told, again) = (rig.sees(&["0080000000700"]), other.sees(&["0080000000700"]));
    assert_eq!(told.verdicts, again.verdicts);
    assert_eq!(told.selection, again.selection);
    assert_eq!(rig.manager, other.manager);
}

/// One step of a world that is out to keep the rover busy for nothing.
#[derive(Debug, Clone)]
struct Flicker {
    /// For each of three spots: its height, and where within a metre of its middle it lies.
    spots: [(u8, usize); 3],
    /// Whether the ground near each spot changes.
    stones: [bool; 3],
    map_changed: bool,
}

fn any_flicker() -> impl Strategy<Value = Flicker> {
    let spot = || (prop_oneof![Just(0u8), 3u8..=9], 0usize..3);
    let stone = any::<bool>;
    ([spot(), spot(), spot()], [stone(), stone(), stone()], any::<bool>())
        .prop_map(|(spots, stones, map_changed)| Flicker { spots, stones, map_changed })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// However the map flickers, a place is tried no more than its attempts allow, once and at each reopening.
    #[test]
    fn a_flickering_world_cannot_keep_the_rover_trying(
        steps in proptest::collection::vec(any_flicker(), 80),
        max_reopenings in 0u32..3,
    ) {
        const SPOTS: [usize; 3] = [4, 12, 20];
        let mut rig = Rig::new(ManagerSpec { max_reopenings, ..spec() }, arm_and_camera(), Cell::new(1, 8));
        let grid = GridSpec::new(3, 25, 1.0).expect("a small grid");
        let mut tries = 0;
        for step in steps {
            let mut prize = Raster::filled(grid, 0.0);
            rig.blocked.clear();
            for (middle, ((height, off), stone)) in SPOTS.into_iter().zip(step.spots.into_iter().zip(step.stones)) {
                prize[Cell::new(1, middle + off - 1)] = f32::from(height) / 10.0;
                if stone {
                    rig.blocked.push(Cell::new(0, middle));
                }
            }
            let told = rig.decide(&prize, step.map_changed);
            if let Some(first) = told.selection.sequence().goals().next() {
                rig.manager.note(first, Event::Failed);
                tries += 1;
            }
        }
        prop_assert!(tries <= 3 * 2 * (1 + max_reopenings), "{} tries", tries);
        // The adversary did what it could: a world of eighty steps always has something to try.
        prop_assert!(tries > 0);
    }

    /// Any maps, budgets, stones and luck: the contracts of a deliberation (see `check`) hold throughout.
    #[test]
    fn every_deliberation_keeps_its_contracts(
        steps in proptest::collection::vec(
            (
                proptest::collection::vec(0u8..=9, 5 * 16),
                proptest::collection::vec(0usize..80, 0..12),
                (any::<bool>(), 0.0..3000.0f64, 0.0..1.0f64),
                proptest::option::of(any::<bool>()),
                any::<bool>(),
            ),
            1..8,
        ),
        policy in prop::sample::select(&Policy::ALL[..2]),
        max_sequenced in 1usize..6,
    ) {
        let spec = ManagerSpec { max_sequenced, ..spec() };
        let mut rig = Rig::new(spec, arm_and_camera(), Cell::new(2, 8));
        rig.policy = policy;
        let grid = GridSpec::new(5, 16, 1.0).expect("a small grid");
        for (heights, stones, (map_changed, time_s, floor), luck, pin) in steps {
            // Most cells are dull, so that there are many maxima.
            let prize = Raster::from_fn(grid, |c| {
                let height = heights[grid.index(c)];
                if height < 7 { 0.0 } else { f32::from(height) / 10.0 }
            });
            rig.blocked = stones.into_iter().map(|i| grid.cell(i)).filter(|c| *c != rig.at).collect();
            rig.limits = Limits { time_s, min_reliability: floor, ..NO_LIMITS };
            let told = rig.decide(&prize, map_changed);
            let first = told.selection.sequence().goals().next();
            rig.pinned = first.filter(|_| pin);
            if let (Some(first), Some(good)) = (first, luck) {
                rig.manager.note(first, if good { Event::Achieved } else { Event::Failed });
            }
        }
    }
}

#[test]
fn a_mandatory_goal_is_sequenced_before_any_other_whatever_it_is_worth() {
    let mut pool = camera();
    pool.push(pool[0].clone());
    pool[0].min_interest = 0.8;
    pool[1] = Directive { name: "must".into(), weight: 0.5, mandatory: true, ..pool[1].clone() };
    let mut rig = Rig::new(ManagerSpec { max_sequenced: 1, ..spec() }, pool, Cell::new(0, 6));
    let told = rig.sees(&["0900000000500"]);
    assert_eq!(told.order(), [1]);
    assert_eq!(told.says(0), (Action::Defer, Reason::BeyondExact, Cause::Start));
}

#[test]
fn goals_that_a_better_one_will_explain_do_not_take_the_place_of_others() {
    let mut rig = Rig::new(ManagerSpec { max_sequenced: 2, ..spec() }, camera(), Cell::new(0, 6));
    let told = rig.sees(&["0908000000700"]);
    let mut order = told.order();
    order.sort_unstable();
    assert_eq!(order, [0, 2]);
    assert_eq!(told.says(1), (Action::Defer, Reason::Excluded, Cause::Start));
    assert_eq!(told.of(1).other, Some(GoalId(0)));
}
