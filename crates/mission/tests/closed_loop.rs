//! The closed loop: missions run to their end, every step of the story holds together, and what the rover
//! discovers, not chance of the machine, changes its goals.

mod small;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::LazyLock;

use wisdom_autonomy::{Act, Decision, Maps, Message, Observation, Outcome, Spent, StepResult};
use wisdom_belief::Rule;
use wisdom_goals::{Action, Cause, FactSet, GoalId, Reason, Status};
use wisdom_mission::{
    DecisionBound, FaultEvent, Mission, Override, Progress, RecordError, Recorder, RunStatus,
    RunSummary, run,
};
use wisdom_planner::{Budget, validate};
use wisdom_terrain::unit_noise;

/// Keeps the story, and checks every plan of every family against the map it was made from.
struct Story<'a> {
    mission: &'a Mission,
    observations: Vec<(u32, Spent)>,
    decisions: Vec<Decision>,
    outcomes: Vec<Outcome>,
}

impl Recorder for Story<'_> {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        self.observations.push((observation.number, observation.spent));
        Ok(())
    }

    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError> {
        let spec = &self.mission.spec;
        let left = Budget {
            time_s: (spec.budget.time_s - decision.state.spent.time_s).max(0.0),
            energy_j: (spec.budget.energy_j
                - spec.budget.reserve_j
                - decision.state.spent.energy_j)
                .max(0.0),
            min_reliability: spec.budget.min_reliability,
        };
        for option in &decision.family {
            assert_eq!(option.plan.start, decision.state.pose.cell);
            assert_eq!(option.plan.legs.len(), option.sequence.stops.len());
            validate(&option.plan, &maps.ground, &spec.vehicle, &left)
                .unwrap_or_else(|e| panic!("decision {}: {e}", decision.number));
        }
        assert!(!decision.triggers.is_empty(), "decision {} has no trigger", decision.number);
        self.decisions.push(decision.clone());
        Ok(())
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.outcomes.push(outcome.clone());
        Ok(())
    }

    fn message(&mut self, _: &Message) -> Result<(), RecordError> {
        Ok(())
    }

    fn fault(&mut self, _: &FaultEvent) -> Result<(), RecordError> {
        Ok(())
    }
}

/// A run with its story.
struct Run {
    mission: Mission,
    summary: RunSummary,
    decisions: Vec<Decision>,
    outcomes: Vec<Outcome>,
}

/// Runs a mission and checks its story.
fn go(mission: Mission) -> Run {
    let mut story = Story {
        mission: &mission,
        observations: Vec::new(),
        decisions: Vec::new(),
        outcomes: Vec::new(),
    };
    let summary =
        run(&mission, &mut story, &mut |_: &Progress<'_>| true).expect("the run ends well");
    let Story { observations, decisions, outcomes, .. } = story;
    assert!(observations.iter().zip(0..).all(|((number, _), i)| *number == i));
    let run = Run { mission, summary, decisions, outcomes };
    check_ends(&run);
    check_spending(&run, &observations);
    check_verdicts(&run);
    check_facts(&run);
    check_progress(&run);
    run
}

fn check_ends(run: &Run) {
    let Run { mission, summary, decisions, outcomes } = run;
    assert!(matches!(summary.status, RunStatus::Waiting | RunStatus::BudgetSpent), "{summary:?}");
    assert_eq!(summary.decisions as usize, decisions.len());
    for (decision, number) in decisions.iter().zip(0..) {
        assert_eq!(decision.number, number);
        assert!(["pursue", "look", "home", "wait"].contains(&decision.act.name()));
        assert!(decision.family.len() > decision.chosen, "there is always a plan, if only to stay");
    }
    // Every decision but the last is answered.
    assert_eq!(outcomes.len() + 1, decisions.len());
    assert!(outcomes.iter().zip(0..).all(|(outcome, number)| outcome.decision == number));
    let last = decisions.last().expect("there is a first decision");
    let waits = matches!(last.act, Act::Wait { .. });
    assert!(waits || summary.status == RunStatus::BudgetSpent || mission.spec.fallback.return_home);
}

fn check_spending(run: &Run, observations: &[(u32, Spent)]) {
    let never_less = |story: &[Spent]| {
        for pair in story.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            assert!(after.time_s >= before.time_s && after.energy_j >= before.energy_j);
            assert!(after.data_mb >= before.data_mb && after.length_m >= before.length_m);
        }
    };
    never_less(&observations.iter().map(|(_, spent)| *spent).collect::<Vec<_>>());
    never_less(&run.decisions.iter().map(|d| d.state.spent).collect::<Vec<_>>());
    for (outcome, next) in run.outcomes.iter().zip(&run.decisions[1..]) {
        assert_eq!(outcome.spent, next.state.spent);
        assert_eq!(outcome.pose, next.state.pose);
        assert_eq!(outcome.track.last(), Some(&outcome.pose.cell));
    }
    assert!(run.summary.spent.data_mb <= run.mission.spec.budget.data_mb);
    let ground = run.mission.world.ground().expect("it is in memory");
    for step in run.summary.track.windows(2) {
        assert!(ground.edge(step[0], step[1]).is_some(), "{} to {}", step[0], step[1]);
    }
}

/// Every goal gets one verdict a decision, and only changes that a goal's life allows.
fn check_verdicts(run: &Run) {
    let mut lives: BTreeMap<GoalId, Status> = BTreeMap::new();
    for decision in &run.decisions {
        let n = decision.number;
        let judged: BTreeSet<GoalId> = decision.verdicts.iter().map(|v| v.goal.id).collect();
        assert_eq!(judged.len(), decision.verdicts.len(), "decision {n}: one verdict a goal");
        let before = decision.state.manager.goals.keys();
        let after = decision.manager_after.goals.keys();
        assert!(before.chain(after).all(|id| judged.contains(id)), "decision {n}: all goals");
        for verdict in &decision.verdicts {
            let (id, was) = (verdict.goal.id, lives.get(&verdict.goal.id).copied());
            let (allowed, now) = match verdict.action {
                Action::Add => (was.is_none_or(|s| s == Status::Formulated), Status::Committed),
                Action::Keep | Action::Modify | Action::Reorder => {
                    (was == Some(Status::Committed), Status::Committed)
                }
                Action::Defer => (was.is_none_or(Status::is_open), Status::Formulated),
                Action::Drop => (was.is_some_and(Status::is_open), Status::Dropped),
                Action::Achieve => (was == Some(Status::Committed), Status::Finished),
            };
            assert!(allowed, "decision {n}: {} of {id}, which was {was:?}", verdict.action);
            assert_eq!(verdict.goal.status(), now, "decision {n}: {} of {id}", verdict.action);
            assert_eq!(verdict.turn.is_some(), now == Status::Committed, "decision {n}: {id}");
            let start = n == 0;
            assert_eq!(verdict.cause == Cause::Start, start, "decision {n}: {id}");
            assert!(
                verdict.cause != Cause::Discovery || decision.map_changed,
                "decision {n}: {id}"
            );
            lives.insert(id, now);
        }
        let mut turns: Vec<(Option<usize>, GoalId)> = decision
            .verdicts
            .iter()
            .filter(|v| v.turn.is_some())
            .map(|v| (v.turn, v.goal.id))
            .collect();
        turns.sort_unstable();
        let sequence: Vec<_> =
            decision.plan().sequence.goals().enumerate().map(|(i, id)| (Some(i), id)).collect();
        assert_eq!(turns, sequence, "decision {n}");
    }
}

/// The facts are what the operators of the outcomes make them.
fn check_facts(run: &Run) {
    let domain = &run.mission.spec.domain;
    assert_eq!(run.decisions[0].state.facts, domain.initial());
    for ((decision, outcome), next) in
        run.decisions.iter().zip(&run.outcomes).zip(&run.decisions[1..])
    {
        let wanted = match &decision.act {
            Act::Pursue(goal) => {
                let directive = decision.manager_after.goals[goal].directive;
                run.mission.spec.directives[directive].achieves
            }
            _ => FactSet::EMPTY,
        };
        let facts = outcome.operators.iter().fold(decision.state.facts, |facts, name| {
            let index = domain.operators().iter().position(|o| o.name == *name);
            let index = index.expect("an operator of the domain");
            domain.step(facts, index, wanted).expect("its preconditions hold")
        });
        assert_eq!(facts, next.state.facts, "after decision {}", decision.number);
        let drives = outcome.operators.iter().filter(|name| *name == "drive").count();
        let moved = outcome.track.len() > 1;
        assert!(drives <= 1 && drives >= usize::from(moved), "after decision {}", decision.number);
        if matches!(outcome.result, StepResult::Achieved(_)) {
            assert!(facts.contains(wanted), "after decision {}", decision.number);
        } else if !moved && !matches!(decision.act, Act::Pursue(_)) {
            assert_eq!(drives, 0, "no wheel turned after decision {}", decision.number);
        }
    }
}

/// No decision is answered by nothing: something was spent, seen, or counted as a failure or a look. What can
/// be spent and tried is finite, so decisions are.
fn check_progress(run: &Run) {
    for pair in run.decisions.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        let changed = before.state.spent != after.state.spent
            || before.digests.frame != after.digests.frame
            || before.state.idle_looks != after.state.idle_looks
            || before.manager_after != after.manager_after;
        assert!(changed, "decision {} led to nothing", before.number);
    }
    for pair in run.outcomes.windows(2) {
        let stays =
            |o: &Outcome| matches!(o.result, StepResult::Interrupted(_)) && o.track.len() == 1;
        assert!(!(stays(&pair[0]) && stays(&pair[1])), "two interruptions on one spot");
    }
}

fn load(name: &str, overrides: &[(&str, &str)]) -> Mission {
    let overrides: Vec<Override> =
        overrides.iter().map(|(key, value)| Override::new(*key, *value)).collect();
    Mission::load(&small::shipped(name), &overrides).unwrap_or_else(|e| panic!("{e}"))
}

fn small_mission(landscape: &str, changes: &[(&str, &str)]) -> Mission {
    small::mission(landscape, changes).unwrap_or_else(|e| panic!("{e}"))
}

/// The search is cut short in all tests: they are about the loop, and unoptimised.
const SHORT_SEARCH: (&str, &str) = ("goals.expansions", "10000");

static PAPER: LazyLock<Run> = LazyLock::new(|| go(load("paper", &[SHORT_SEARCH])));

/// A third of the mission's day is enough to meet every action.
static MARIAS_PASS: LazyLock<Run> =
    LazyLock::new(|| go(load("marias-pass", &[SHORT_SEARCH, ("budget.time-s", "20000.0")])));

/// A random scene of rocks with bright faces, patches and hot spots, fixed by its number.
fn scene(number: u64) -> String {
    let draw = |what: u64, item: u64, low: f64, high: f64| {
        low + (high - low) * unit_noise(&[0x5CE_4E5, number, what, item])
    };
    let place = |what: u64, item: u64| {
        // On a ring about the rover, so that it does not start inside a rock.
        let angle = draw(what, item, 0.0, std::f64::consts::TAU);
        let distance = draw(what + 1, item, 8.0, 17.0);
        (20.0 + distance * libm::cos(angle), 20.0 + distance * libm::sin(angle))
    };
    let mut text = small::LEVEL.to_owned();
    text.push_str(
        "\n[roughness]\namplitude_m = 0.2\nwavelength_cells = 12.0\noctaves = 3\ngain = 0.5\n",
    );
    for i in 0..4 {
        let (col, row) = place(10, i);
        let (a, b) = (draw(12, i, 2.0, 3.5), draw(13, i, 2.0, 3.5));
        let height = draw(14, i, 5.0, 14.0);
        write!(
            text,
            "\n[[rock]]\ncentre = [{col:.3}, {row:.3}]\nhalf-axes = [{a:.3}, {b:.3}]\n\
             height_m = {height:.3}\nwall = \"ramp\"\nwall_cells = 1.2\n\
             \n[[patch]]\nclass = 4\nshape = {{ face = {{ centre = [{col:.3}, {row:.3}], \
             radius_cells = 4.5, towards = [20.0, 20.0], beyond_cells = 0.0 }} }}\n"
        )
        .expect("a string takes all");
    }
    for i in 0..3 {
        let (col, row) = place(20, i);
        let (radius, class) = (draw(22, i, 2.0, 5.0), 1 + (draw(23, i, 0.0, 3.0) as u8));
        write!(
            text,
            "\n[[patch]]\nclass = {class}\nshape = {{ disc = {{ centre = [{col:.3}, {row:.3}], \
             radius_cells = {radius:.3} }} }}\n"
        )
        .expect("a string takes all");
        let (col, row) = place(30, i);
        let (radius, peak) = (draw(32, i, 3.0, 6.0), draw(33, i, 30.0, 95.0));
        write!(
            text,
            "\n[[hot_spot]]\ncentre = [{col:.3}, {row:.3}]\nradius_cells = {radius:.3}\n\
             edge_cells = 2.5\npeak = {peak:.3}\n"
        )
        .expect("a string takes all");
    }
    text
}

#[test]
fn the_paper_s_mission_runs_to_its_end() {
    let run = &*PAPER;
    assert!(run.summary.achieved.len() >= 5, "{} goals", run.summary.achieved.len());
    assert_eq!(run.summary.count(Action::Achieve) as usize, run.summary.achieved.len());
    assert!(run.summary.decisions > 10 && run.summary.observations > 20);
}

#[test]
fn every_action_occurs_and_the_map_s_changes_bring_it_about() {
    let mut met = BTreeSet::new();
    for run in [&*PAPER, &*MARIAS_PASS] {
        for decision in &run.decisions {
            for verdict in &decision.verdicts {
                met.insert(verdict.action);
                let of_the_map = match verdict.action {
                    Action::Modify => verdict.reason != Reason::Eroded,
                    Action::Drop => verdict.reason == Reason::LostInterest,
                    Action::Add => verdict.reason == Reason::NewMaximum,
                    _ => false,
                };
                if of_the_map && decision.number > 0 {
                    let told = (verdict.action, verdict.reason, decision.number);
                    assert!(decision.map_changed, "{told:?} without a new reading");
                }
            }
        }
    }
    for action in Action::ALL {
        assert!(met.contains(action), "{action} never occurs");
    }
}

/// Each rule sees the same scene in its own way; under each the run is sound from end to end.
#[test]
fn a_mission_runs_under_every_rule_that_makes_maps() {
    let mut chosen = BTreeSet::new();
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        let named = format!("rule = \"{rule}\"\npolicy");
        let run = go(small_mission(&scene(1), &[("policy", &named)]));
        let first = &run.decisions[0];
        chosen.insert(format!(
            "{:?}",
            first.verdicts.iter().map(|v| v.goal.target).collect::<Vec<_>>()
        ));
    }
    assert!(chosen.len() > 1, "the choice of a rule changes nothing");
}

#[test]
fn a_rover_that_knows_everything_discovers_nothing() {
    let mut runs = vec![go(load("paper", &[SHORT_SEARCH, ("prior.kind", "complete")]))];
    for number in 0..3 {
        let complete = ("kind = \"averaged\"", "kind = \"complete\"");
        runs.push(go(small_mission(&scene(number), &[complete])));
    }
    for run in runs {
        let mut changes = 0;
        for decision in &run.decisions[1..] {
            assert!(!decision.map_changed, "decision {}", decision.number);
            changes += decision.verdicts.len();
        }
        for action in Action::ALL {
            assert_eq!(run.summary.count_for(*action, Cause::Discovery), 0, "{action}");
        }
        assert!(changes > 0 && !run.summary.achieved.is_empty(), "the control does something");
        // Not a matter of labels: with nothing to find, no maximum is new, moves, fades or merges.
        for verdict in run.decisions.iter().skip(1).flat_map(|d| &d.verdicts) {
            let found_out = matches!(
                verdict.reason,
                Reason::NewMaximum
                    | Reason::PeakMoved
                    | Reason::LostInterest
                    | Reason::Merged
                    | Reason::Unreachable
            );
            let acted = !matches!(verdict.action, Action::Defer | Action::Keep);
            assert!(!(found_out && acted), "{verdict:?}");
        }
    }
}

#[test]
fn what_is_discovered_adds_drops_and_modifies_goals() {
    let mut counts: BTreeMap<(Action, Cause), u32> = BTreeMap::new();
    let mut achieved = 0;
    for number in 0..20 {
        let run = go(small_mission(&scene(number), &[]));
        for (key, count) in &run.summary.actions {
            *counts.entry(*key).or_default() += count;
        }
        achieved += run.summary.achieved.len();
    }
    tell(&counts, achieved);
    for action in [Action::Add, Action::Drop, Action::Modify] {
        let count = counts.get(&(action, Cause::Discovery)).copied().unwrap_or(0);
        assert!(count > 0, "no {action} by discovery in 20 scenes: {counts:?}");
    }
}

#[expect(clippy::print_stdout, reason = "the counts are what one runs this test by hand for")]
fn tell(counts: &BTreeMap<(Action, Cause), u32>, achieved: usize) {
    println!("20 scenes, {achieved} goals achieved; verdicts:");
    for ((action, cause), count) in counts {
        println!("{:>8} {:>10} {count:>6}", action.to_string(), cause.to_string());
    }
}

#[test]
fn the_same_mission_is_decided_alike_at_any_thread_count() {
    let at = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be made").install(|| go(small_mission(&scene(7), &[])))
    };
    let first = at(2);
    assert!(first.decisions.len() > 3);
    for threads in [2, 1, 7] {
        let again = at(threads);
        assert_eq!(first.decisions, again.decisions, "{threads} threads");
        assert_eq!(first.outcomes, again.outcomes, "{threads} threads");
        assert_eq!(first.summary, again.summary, "{threads} threads");
    }
    let other = go(small_mission(&scene(7), &[("seed = 1", "seed = 2")]));
    assert_ne!(first.decisions, other.decisions, "the seed matters");
}

#[test]
fn the_paper_s_mission_is_decided_alike_on_one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let again = pool.expect("a thread").install(|| go(load("paper", &[SHORT_SEARCH])));
    assert_eq!(PAPER.decisions, again.decisions);
    assert_eq!(PAPER.outcomes, again.outcomes);
    assert_eq!(PAPER.summary, again.summary);
}

/// A hot disc in the north-west corner and nothing else: one goal.
fn one_goal(more: &str) -> String {
    format!(
        "{}\n[[hot_spot]]\ncentre = [7.0, 7.0]\nradius_cells = 3.0\nedge_cells = 1.0\npeak = 50.0\n{more}",
        small::LEVEL
    )
}

/// Four ridges closed around the disc.
fn walled() -> String {
    let corners = [(1.5, 1.5), (12.5, 1.5), (12.5, 12.5), (1.5, 12.5), (1.5, 1.5)];
    let walls = corners.windows(2).map(|pair| {
        let ((a, b), (c, d)) = (pair[0], pair[1]);
        format!(
            "\n[[ridge]]\nfrom = [{a}, {b}]\nto = [{c}, {d}]\nhalf_width_cells = 1.5\nheight_m = 4.0\n"
        )
    });
    one_goal(&walls.collect::<String>())
}

/// Knows the mean height of the whole scene, which is level, and sees warmth from high above.
const WARMTH_ONLY: [(&str, &str); 5] = [
    (
        "experts = [\"experts/dem.toml\", \"experts/temperature.toml\", \"experts/texture.toml\"]",
        "experts = [\"experts/temperature.toml\"]",
    ),
    ("block = 8", "block = 40"),
    ("[\"elevation\", \"texture\", \"temperature\"]", "[\"temperature\"]"),
    ("height-m = 3.0\nrange-m = 15.0", "height-m = 200.0\nrange-m = 60.0"),
    ("max-sequenced = 8", "max-sequenced = 8\nmax-reopenings = 0"),
];

#[test]
fn walls_that_the_map_did_not_show_block_twice_and_never_again() {
    let mut changes = WARMTH_ONLY.to_vec();
    // Neither a substitute nor a long arm: the goal can only be tried again.
    changes.push(("exclusion-radius-m = 6.0\nsubstitute = \"image\"", "exclusion-radius-m = 6.0"));
    changes.push(("min-interest = 0.6", "min-interest = 1.0"));
    let run = go(small_mission(&walled(), &changes));
    let blocked: Vec<&Outcome> =
        run.outcomes.iter().filter(|o| matches!(o.result, StepResult::Blocked(_))).collect();
    assert_eq!(blocked.len(), 2, "two tries a goal");
    for outcome in blocked {
        let next = &run.decisions[outcome.decision as usize + 1];
        assert!(next.triggers.iter().any(|t| t.name() == "leg-failed"), "{:?}", next.triggers);
        assert!(next.map_changed, "the hazard cameras saw what was in the way");
    }
    assert!(run.summary.achieved.is_empty());
    let given_up =
        run.decisions.iter().flat_map(|d| &d.verdicts).find(|v| v.action == Action::Drop);
    let given_up = given_up.expect("the goal is dropped");
    assert_eq!((given_up.reason, given_up.goal.attempts), (Reason::AttemptsSpent, 2));
    let failed = run.summary.legs.iter().filter(|leg| leg.arrived == Some(false)).count();
    assert_eq!(failed, 2);
    assert!(run.summary.brier().expect("legs ended") > 0.1, "both were promised");
}

#[test]
fn a_wall_leaves_the_weaker_directive_which_needs_no_way_in() {
    let run = go(small_mission(&walled(), &WARMTH_ONLY));
    let eroded = run
        .decisions
        .iter()
        .flat_map(|d| &d.verdicts)
        .find(|v| v.reason == Reason::Eroded)
        .expect("the first try fails");
    assert_eq!((eroded.action, eroded.cause), (Action::Modify, Cause::Execution));
    let directives = &run.mission.spec.directives;
    assert_eq!(directives[eroded.goal.directive].name, "image");
    let achieved = &run.summary.achieved;
    assert!(achieved.iter().all(|a| a.directive == "image"), "{achieved:?}");
}

/// One goal, driven with scattered slip and no hazard, worked on at no cost.
const FREE_WORK: [(&str, &str); 5] = [
    ("kind = \"averaged\"", "kind = \"complete\""),
    ("time-s = 1800.0\nenergy-j = 6.0e4\n", ""),
    (
        "time-s = 120.0\nenergy-j = 3.0e3\n\n[[operator]]\nname = \"analyse\"",
        "\n[[operator]]\nname = \"analyse\"",
    ),
    (
        "[rover.vehicle]",
        "[execution]\nslip-scatter = 1.0\n\n[rover.vehicle]\nhazard-floor-per-m = 1e-12",
    ),
    ("min-ignorance = 0.15", "return-home = false\nmin-ignorance = 1.0"),
];

#[test]
fn a_budget_that_ends_on_the_way_is_no_failed_try() {
    let ground = one_goal("");
    let plenty = go(small_mission(&ground, &FREE_WORK));
    assert_eq!(plenty.summary.status, RunStatus::Waiting);
    let planned_s = plenty.decisions[0].plan().plan.total.time_s;
    let mut ended_on_the_way = 0;
    for seed in 1..=20 {
        let seed = format!("seed = {seed}");
        let budget = format!("time-s = {:.3}", planned_s + 1.0);
        let mut changes = FREE_WORK.to_vec();
        changes.extend([("seed = 1", seed.as_str()), ("time-s = 30000.0", budget.as_str())]);
        let run = go(small_mission(&ground, &changes));
        assert!(run.summary.legs.iter().all(|leg| leg.arrived != Some(false)), "no leg failed");
        assert!(run.summary.brier().is_none_or(|score| score < 1e-9), "{:?}", run.summary.brier());
        let manager = &run.decisions.last().expect("there is one").manager_after;
        assert!(manager.goals.values().all(|goal| goal.attempts == 0) && manager.tries.is_empty());
        let cut_short = run.summary.achieved.is_empty();
        if cut_short {
            // Either the budget ended under way, or the rover saw in time that the rest no longer fits.
            if run.summary.status == RunStatus::Waiting {
                let told = &run.decisions.last().expect("it decided").verdicts[0];
                assert_eq!((told.action, told.reason), (Action::Defer, Reason::Time), "{told:?}");
            } else {
                assert_eq!(run.summary.status, RunStatus::BudgetSpent);
            }
            let last = run.outcomes.last().expect("it set out");
            assert!(matches!(last.result, StepResult::Interrupted(_)), "{last:?}");
        }
        let on_the_way = run.summary.legs.last().is_some_and(|leg| leg.arrived.is_none());
        assert!(cut_short || !on_the_way);
        if on_the_way {
            let told = run.decisions.last().expect("a last decision follows the last outcome");
            assert!(matches!(told.act, Act::Wait { .. }) && told.plan().sequence.stops.is_empty());
        }
        ended_on_the_way += u32::from(on_the_way);
    }
    assert!(ended_on_the_way > 0, "some of twenty seeds slip more than planned");
}

#[test]
fn a_rover_that_cannot_drive_any_more_waits() {
    // Nothing stows the arm: the first analysis is the last thing done.
    let stow = "[[operator]]\nname = \"stow-arm\"\npreconditions = [\"arm-deployed\"]\n\
                adds = [\"arm-stowed\"]\ndeletes = [\"arm-deployed\"]\ntime-s = 120.0\nenergy-j = 3.0e3\n";
    let home = ("look-range-m = 15.0", "return-home = true\nlook-range-m = 15.0");
    let complete = ("kind = \"averaged\"", "kind = \"complete\"");
    let run = go(small_mission(&one_goal(""), &[(stow, ""), home, complete]));
    assert_eq!(run.summary.status, RunStatus::Waiting);
    assert_eq!(run.summary.achieved.len(), 1);
    // It would drive home, and cannot: the run ends there.
    let last = run.decisions.last().expect("there is one");
    assert!(matches!(last.act, Act::Home { .. } | Act::Wait { .. }), "{:?}", last.act);
    assert_ne!(last.state.pose.cell, run.mission.world.execution().start);
    assert_eq!(run.summary.decisions, 2);
}

#[test]
fn next_to_no_budget_ends_the_run_at_once() {
    for (time_s, energy_j) in [("0.0", "0.0"), ("1.0", "1.0"), ("500.0", "2.0e4"), ("30.0", "1e6")]
    {
        let (time, energy) = (format!("time-s = {time_s}"), format!("energy-j = {energy_j}"));
        let changes = [("time-s = 30000.0", time.as_str()), ("energy-j = 1.2e6", energy.as_str())];
        let run = go(small_mission(&scene(3), &changes));
        assert!(run.summary.decisions < 10, "{} decisions", run.summary.decisions);
    }
    let run = go(load("paper", &[("budget.time-s", "0"), ("goals.expansions", "1")]));
    assert!(run.summary.achieved.is_empty());
}

#[test]
fn a_rover_without_instruments_lives_on_what_it_was_told() {
    let text = String::from_utf8(small::files("")["mission.toml"].clone()).expect("it is text");
    let from = text.find("[[instrument]]").expect("it has one");
    let to = text.find("[rover]").expect("it has one");
    let blind = (&text[from..to], "");
    let told = go(small_mission(&scene(5), &[blind]));
    assert_eq!(told.summary.observations as usize, 1 + closer_looks(&told));
    let nothing = ("kind = \"averaged\"\nblock = 8\nu = 0.6", "kind = \"none\"");
    let untold = go(small_mission(&scene(5), &[blind, nothing]));
    assert!(untold.summary.achieved.is_empty());
    assert!(untold.decisions.iter().all(|d| d.verdicts.is_empty()));
}

/// Looks of the hazard cameras, which every rover has: one a blocked drive.
fn closer_looks(run: &Run) -> usize {
    let bumped = |leg: &&Outcome| {
        matches!(leg.result, StepResult::Blocked(_))
            || (leg.result == StepResult::Stopped
                && leg.pose.cell != run.mission.world.execution().start)
    };
    run.outcomes.iter().filter(bumped).count()
}

#[test]
fn a_watcher_can_stop_the_run_and_keeps_what_was_done() {
    let mission = small_mission(&scene(1), &[]);
    let mut seen = 0;
    let mut memory = wisdom_mission::Memory::default();
    let mut watch = |progress: &Progress<'_>| {
        seen += u32::from(progress.decision.is_some());
        seen < 2
    };
    let summary = run(&mission, &mut memory, &mut watch).expect("it stops in order");
    assert_eq!(summary.status, RunStatus::Stopped);
    assert_eq!((summary.decisions, memory.decisions.len()), (2, 2));
    assert_eq!(memory.outcomes.len(), 1);
    assert!(summary.spent.time_s > 0.0 || summary.observations > 1);
}

/// Alternatives of legs are offered, checked and driven; and however soon the search is cut short, they never make the
/// first decision worth less.
#[test]
fn more_ways_of_each_leg_are_worth_no_less() {
    let first = |alternatives: &str| {
        let changes = [
            ("goals.expansions", "3000"),
            ("budget.time-s", "9000.0"),
            ("routes.alternatives", alternatives),
        ];
        let run = go(load("paper", &changes));
        let decision = run.decisions[0].clone();
        (decision.family[0].sequence.value, decision)
    };
    let (narrow, _) = first("1");
    let (wide, decision) = first("3");
    assert!(wide >= narrow, "{wide} with three ways, {narrow} with one");
    // Nothing known for the order chosen is better than what was chosen.
    let chosen = decision.plan();
    for option in decision.family.iter().filter(|o| o.front.best == decision.chosen) {
        assert!(option.sequence.goals().eq(chosen.sequence.goals()));
        assert!(chosen.sequence.rank(&option.sequence).is_le(), "{option:?}");
    }
    assert!(decision.family.iter().any(|o| o.sequence.stops.iter().any(|s| s.alternative > 0)));
}

/// Ground with steps that no map from orbit shows, instruments that never agree with themselves, and a rover that
/// decides anew at the least change: it must end all the same, and sooner than what its decisions must cost allows.
#[test]
fn however_the_map_flickers_a_mission_ends_within_its_bound() {
    let mut most = 0.0_f64;
    for seed in 1..=6 {
        let changes = [
            ("seed = 1", format!("seed = {seed}")),
            (
                "name = \"elevation\"\nunit = \"m\"\nsigma = 0.1",
                "name = \"elevation\"\nunit = \"m\"\nsigma = 0.6\nupdate = \"latest\"".to_owned(),
            ),
            (
                "name = \"temperature\"\nsigma = 1.0",
                "name = \"temperature\"\nsigma = 6.0\nupdate = \"latest\"".to_owned(),
            ),
            (
                "kind = \"class\"\nclasses = [1, 2, 3, 4]",
                "kind = \"class\"\nclasses = [1, 2, 3, 4]\nupdate = \"latest\"".to_owned(),
            ),
            ("[fallback]", "[triggers]\ninterest-change = 0.0\n\n[fallback]".to_owned()),
        ];
        let changes: Vec<(&str, &str)> = changes.iter().map(|(a, b)| (*a, b.as_str())).collect();
        let mission = small::mission(small::LEVEL, &changes).expect("the mission is sound");
        let bound = DecisionBound::of(&mission);
        let mut memory = wisdom_mission::Memory::default();
        let summary = run(&mission, &mut memory, &mut |_| true).expect("the run ends");
        assert_ne!(summary.status, RunStatus::DecisionLimit, "seed {seed}");
        assert!(u64::from(summary.decisions) <= bound.decisions(), "seed {seed}: {bound:?}");
        most = most.max(f64::from(summary.decisions) / bound.decisions() as f64);
        // Nothing is tried again without a reason: failures at one place end it.
        let attempts = mission.spec.directives.iter().map(|d| d.max_attempts).max().unwrap_or(0);
        let goals = memory.decisions.iter().flat_map(|d| &d.verdicts).map(|v| &v.goal);
        assert!(goals.into_iter().all(|goal| goal.attempts <= attempts), "seed {seed}");
    }
    println!("at most {:.2} % of the bound", 100.0 * most);
}
