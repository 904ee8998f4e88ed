//! Bounded persistence: an adversary blocks, aborts, flickers, commands and breaks things, and every mission still ends,
//! without trying anything more often than it may.

#[path = "scenarios/stage.rs"]
mod stage;

use std::collections::BTreeMap;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use stage::{PIT_M, Stage, directive, level, route, updated};
use wisdom_autonomy::{
    Act, Budget, Decision, Fallback, LayerWindow, MapUpdate, Spec, StepResult, Word,
};
use wisdom_goals::{Action, Directive, Extraction, GoalId, Kind, ManagerSpec, Proof, Reason};
use wisdom_grid::Cell;
use wisdom_planner::{FieldOptions, Limits, field};
use wisdom_terrain::unit_noise;

/// Maxima within this distance are one place, metres; so far apart are two maxima at least, and so far does an achieved
/// goal close its ground.
const PLACE_M: f64 = 3.0;
/// Tries of a goal.
const ATTEMPTS: usize = 2;
/// Times a place may be tried anew after its ground changed.
const REOPENINGS: usize = 1;
/// Commands that the ground sends at most.
const COMMANDS: usize = 3;
/// Ground around a place whose change is a reason to try anew, cells.
const LOCAL_GROUND: usize = 8;

/// An adversary and its ground.
#[derive(Debug, Clone)]
struct Case {
    side: usize,
    seed: u64,
    /// Whether look-again and adjudicate goals are in the pool besides inspect goals.
    all_kinds: bool,
    /// Chance that a reading is another one at the next look.
    flicker: f64,
    /// Chance that a leg does not go as planned.
    malice: f64,
    energy_j: f64,
}

fn any_case() -> impl Strategy<Value = Case> {
    let numbers = (0.0..0.7_f64, 0.2..1.0_f64, 60_000.0..500_000.0_f64);
    (12..=20_usize, any::<u64>(), any::<bool>(), numbers).prop_map(
        |(side, seed, all_kinds, (flicker, malice, energy_j))| Case {
            side,
            seed,
            all_kinds,
            flicker,
            malice,
            energy_j,
        },
    )
}

impl Case {
    /// A number in [0, 1) for a purpose at a moment.
    fn draw(&self, purpose: u64, moment: u64, what: u64) -> f64 {
        unit_noise(&[self.seed, purpose, moment, what])
    }

    fn kinds(&self) -> usize {
        if self.all_kinds { 3 } else { 1 }
    }

    fn spec(&self) -> Spec {
        let mut picture = vec![vec!['.'; self.side]; self.side];
        picture[self.side / 2][self.side / 2] = 'R';
        let lines: Vec<String> = picture.into_iter().map(|row| row.into_iter().collect()).collect();
        let base = stage::spec(&lines.join("\n"));
        let of = |operator: &str| Directive { exclusion_radius_m: PLACE_M, ..directive(operator) };
        let sample = Directive { substitute: Some(1), weight: 1.5, ..of("sample") };
        let mut directives = vec![sample, of("image")];
        if self.all_kinds {
            directives.extend([of("look"), of("judge")]);
        }
        let manager = ManagerSpec {
            identity_radius_m: PLACE_M,
            extraction: Extraction { min_separation_m: PLACE_M, ..Extraction::default() },
            max_reopenings: REOPENINGS as u32,
            max_sequenced: 9,
            ..base.manager
        };
        let fallback = Fallback {
            max_looks: 2,
            look_range_m: 3.0,
            min_ignorance: 0.25,
            return_home: true,
            ..base.fallback
        };
        let budget = Budget { energy_j: self.energy_j, ..base.budget };
        let spec = Spec { directives, manager, fallback, budget, ..base };
        ["elevation", "glow", "trace"]
            .into_iter()
            .fold(spec, |spec, layer| updated(spec, layer, MapUpdate::Latest))
    }

    /// The most decisions that a mission can take.
    ///
    /// Whatever moves the rover costs a metre of level ground at least, so there are `moves` of them. What does not move
    /// it is a try that fails where it stands, a goal that is done there, or a look around. The cells of a square of
    /// `side` cells lie within one place's radius, so each square has the tries and the goals of one place; commands add
    /// theirs. It looks around where it stands once after a pursuit, and waits once.
    fn bound(&self, spec: &Spec) -> usize {
        let moves = (self.energy_j / level(&spec.vehicle).energy_j).ceil() as usize;
        let side = (PLACE_M / std::f64::consts::SQRT_2).floor() as usize + 1;
        let places = self.side.div_ceil(side).pow(2) * self.kinds() + COMMANDS;
        let tries = places * ATTEMPTS * (1 + REOPENINGS);
        2 * (moves + tries + places) + 2
    }
}

/// The adversary at work.
struct Mission {
    case: Case,
    stage: Stage,
    /// Pits that there are.
    pits: Vec<Cell>,
    looks: u64,
    commands: Vec<Cell>,
    arm_works: bool,
    /// Tries that failed: the goal, what it looked for, its target.
    failed: Vec<(GoalId, Kind, Cell)>,
    given_up: Vec<GivenUp>,
    /// The first decision that was another one when it was taken again.
    fickle: Option<u32>,
}

/// A place given up, and the ground around it then.
struct GivenUp {
    target: Cell,
    kind: Kind,
    ground: Vec<bool>,
    changed: bool,
}

impl Mission {
    fn new(case: Case) -> Self {
        let stage = Stage::new(case.spec());
        Self {
            case,
            stage,
            pits: Vec::new(),
            looks: 0,
            commands: Vec::new(),
            arm_works: true,
            failed: Vec::new(),
            given_up: Vec::new(),
            fickle: None,
        }
    }

    /// Looks at everything: lamps on every fourth cell of every fourth row, each of its own brightness unless it
    /// flickers, and the pits, unless they flicker too.
    fn look(&mut self) {
        let (case, moment) = (&self.case, self.looks);
        let window = self.stage.rover.spec().grid.window();
        let index = |cell: Cell| (cell.row * case.side + cell.col) as u64;
        // A number that stays what it was at the first look unless it flickers.
        let steady = |cell: Cell, purpose: u64| {
            let flickers = case.draw(purpose, moment, index(cell)) < case.flicker;
            case.draw(purpose + 1, if flickers { moment } else { 0 }, index(cell)) as f32
        };
        let lamp = |cell: Cell, purpose: u64| {
            let lit = cell.row % 4 == 1 && cell.col % 4 == 2;
            if lit { 10.0 * steady(cell, purpose) } else { 0.5 }
        };
        let u = |cell: Cell, purpose: u64| 0.05 + 0.9 * steady(cell, purpose);
        let layer = |name: &str, value: &dyn Fn(Cell) -> f32, u: &dyn Fn(Cell) -> f32| {
            let (values, uncertainty) = window.cells().map(|c| (value(c), u(c))).unzip();
            LayerWindow { layer: name.into(), window, values, uncertainty }
        };
        let hidden = |cell: &Cell| case.draw(9, moment, index(*cell)) < 0.3 * case.flicker;
        let pit = |cell: Cell| self.pits.iter().any(|p| *p == cell && !hidden(p));
        let mut windows = vec![
            layer("elevation", &|c| if pit(c) { PIT_M } else { 0.0 }, &|_| 0.1),
            layer("glow", &|c| lamp(c, 1), &|c| u(c, 3)),
        ];
        if case.all_kinds {
            windows.push(layer("trace", &|c| lamp(c, 5), &|c| u(c, 7)));
        }
        self.stage.observe(windows);
        self.looks += 1;
    }

    /// Word from the ground and from the health watch.
    fn talk(&mut self, step: u64) {
        let case = &self.case;
        let draw = |what: u64| case.draw(20, step, what);
        let side = case.side as f64;
        if draw(0) < 0.15 && self.commands.len() < COMMANDS {
            let target = Cell::new((draw(1) * side) as usize, (draw(2) * side) as usize);
            self.stage.hear(Word::Pursue {
                name: format!("C{}", self.commands.len()),
                directive: if draw(3) < 0.5 { "image" } else { "sample" }.into(),
                target,
                prize: 0.1 + 2.0 * draw(4),
                mandatory: draw(5) < 0.5,
            });
            self.commands.push(target);
        }
        if draw(6) < 0.1 {
            let name = format!("C{}", (draw(7) * COMMANDS as f64) as usize);
            self.stage.hear(Word::Withdraw { name });
        }
        if draw(8) < 0.15 {
            let arm = vec!["arm-works".to_owned()];
            let (adds, deletes) = if self.arm_works { (vec![], arm) } else { (arm, vec![]) };
            self.stage.hear(Word::Facts { adds, deletes });
            self.arm_works = !self.arm_works;
        }
    }

    /// Carries out an act as the adversary likes.
    fn carry_out(&mut self, decision: &Decision, step: u64) {
        let draw = |what: u64| self.case.draw(30, step, what);
        let (fails, way_there, price) = (draw(0) < self.case.malice, draw(1), 1.0 + 2.0 * draw(2));
        let (blocks, shows) = (draw(3) < 0.5, draw(4) < 0.5);
        let cells = route(decision).cells.len() - 1;
        let Act::Pursue(goal) = decision.act else {
            let driven = if fails { (way_there * cells as f64).ceil() as usize } else { cells };
            self.stage.advance(decision, driven, price);
            let arrived = driven == cells;
            let result = if arrived { StepResult::Arrived } else { StepResult::Stopped };
            self.stage.report(decision, result, &[]);
            self.look();
            return;
        };
        if !fails {
            let driven = cells.min(1);
            self.stage.advance(decision, driven, price);
            if driven > 0 {
                self.look();
                if !self.stage.rover.triggers().is_empty() {
                    self.stage.interrupt(decision);
                    return;
                }
            }
            self.stage.achieve(decision);
            return;
        }
        // A leg is blocked where the rover comes near, or ends anywhere.
        let driven =
            if blocks { cells.saturating_sub(1) } else { (way_there * cells as f64) as usize };
        self.stage.advance(decision, driven, price);
        let next = route(decision).cells[(driven + 1).min(cells)];
        let tried = &decision.manager_after.goals[&goal];
        let kind = self.stage.rover.spec().directives[tried.directive].kind;
        self.failed.push((goal, kind, tried.target));
        let result = if blocks { StepResult::Blocked(goal) } else { StepResult::Aborted(goal) };
        self.stage.report(decision, result, &[]);
        if blocks && shows && next != self.stage.at {
            self.pits.push(next);
        }
        self.look();
    }

    /// Flies the whole mission.
    fn fly(mut self) -> Flown {
        let bound = self.case.bound(self.stage.rover.spec());
        self.look();
        for step in 0..bound {
            self.talk(step as u64);
            let decision = self.stage.decide();
            self.check(&decision);
            if let Act::Wait { .. } = decision.act {
                self.check_wait(&decision);
                self.check_tries();
                let (missed, fickle) = (self.vantage(&decision), self.fickle);
                return Flown { bound, took: step + 1, missed, fickle };
            }
            self.carry_out(&decision, step as u64);
        }
        panic!("{bound} decisions and no end: {:?}", self.case);
    }

    fn check(&mut self, decision: &Decision) {
        // Without an event on the same map it stays with what it chose, if what it chose from was all there is: goals that
        // leave the sequence make room on a shortlist that was too short.
        let order: Vec<GoalId> = decision.plan().sequence.goals().collect();
        let again = self.stage.rover.clone().decide().expect("a decision");
        let whole = decision.shortlist.left_out.is_empty() && decision.proof == Proof::Proven;
        let same = !whole || again.plan().sequence.goals().eq(order.iter().copied());
        let ended =
            decision.verdicts.iter().any(|v| matches!(v.action, Action::Drop | Action::Achieve));
        assert!(same || ended, "no event, another sequence, decision {}", decision.number);
        if !same && self.fickle.is_none() {
            self.fickle = Some(decision.number);
        }
        self.check_hysteresis(decision, &order);
        self.check_places(decision);
    }

    /// What is committed to is left for something that is better by the hysteresis, and for nothing less.
    fn check_hysteresis(&self, decision: &Decision, order: &[GoalId]) {
        let Some(committed) = decision.committed_value else { return };
        let open = |id: &&GoalId| decision.shortlist.kept.contains(id);
        let before: Vec<GoalId> =
            decision.state.manager.agenda.iter().filter(open).copied().collect();
        if before == order {
            return;
        }
        let least = self.stage.rover.spec().manager.hysteresis;
        let chosen = &decision.plan().sequence;
        let gain = chosen.value - committed;
        let mandatory = |id: &GoalId| {
            let order = decision.manager_after.goals.get(id).and_then(|goal| goal.order.as_ref());
            order.is_some_and(|order| order.mandatory)
        };
        // Mandatory goals come before any value, and of equals the safer one may be taken.
        let fulfils_more = order.iter().any(|id| mandatory(id) && !before.contains(id));
        let equal = gain == 0.0;
        assert!(
            fulfils_more || equal || (gain > 0.0 && gain >= least * committed.abs()),
            "{before:?} worth {committed} was left for {order:?} worth {}",
            chosen.value
        );
    }

    /// No place that was given up comes back while its ground is as it was.
    fn check_places(&mut self, decision: &Decision) {
        let spec = self.stage.rover.spec();
        let blocked = self.stage.rover.maps().expect("maps").ground.blocked();
        let ground = |target: Cell| -> Vec<bool> {
            spec.grid.around(target, LOCAL_GROUND).cells().map(|cell| blocked[cell]).collect()
        };
        for place in &mut self.given_up {
            place.changed |= ground(place.target) != place.ground;
        }
        for (id, goal) in &decision.manager_after.goals {
            let kind = spec.directives[goal.directive].kind;
            let is_new = !decision.state.manager.goals.contains_key(id);
            let is_next = decision.act == Act::Pursue(*id);
            if goal.order.is_some() || !(is_new || is_next) {
                continue;
            }
            let shut = self.given_up.iter().find(|place| {
                !place.changed
                    && place.kind.closes(kind)
                    && place.target.distance(goal.target) <= PLACE_M
            });
            if let Some(place) = shut {
                panic!(
                    "{id} at {} although {} is given up, decision {}",
                    goal.target, place.target, decision.number
                );
            }
        }
        for verdict in &decision.verdicts {
            let given_up = matches!(verdict.reason, Reason::AttemptsSpent | Reason::Unreachable);
            if verdict.action == Action::Drop && given_up {
                let target = verdict.goal.target;
                let kind = spec.directives[verdict.goal.directive].kind;
                let ground = ground(target);
                self.given_up.push(GivenUp { target, kind, ground, changed: false });
            }
        }
    }

    /// The rover only waits without a plan and without a way home that it can afford.
    fn check_wait(&self, decision: &Decision) {
        assert!(decision.plan().sequence.stops.is_empty(), "it waits with a plan");
        let home = self.stage.rover.spec().fallback.home;
        let can_go = |to: Cell| self.affordable(&[to]).is_some();
        assert!(self.stage.at == home || !can_go(home), "it could have gone home");
    }

    /// The first of some cells to which there is a way that is safe and within what is left.
    fn affordable(&self, cells: &[Cell]) -> Option<Cell> {
        let spec = self.stage.rover.spec();
        let ground = &self.stage.rover.maps().expect("maps").ground;
        let everywhere = FieldOptions { targets: None, limits: Limits::NONE };
        let reach = field(ground, self.stage.at, &everywhere);
        let left_j = spec.budget.energy_j - self.stage.spent.energy_j;
        let can_go = |cell: &&Cell| {
            let cost = reach.cost(**cell);
            cost.is_some_and(|c| {
                c.reliability() >= spec.budget.min_reliability && c.energy_j <= left_j
            })
        };
        cells.iter().find(can_go).copied()
    }

    /// A cell that it could have driven to, to look at ground it knows little of, when it decided to wait.
    fn vantage(&self, decision: &Decision) -> Option<Cell> {
        let spec = self.stage.rover.spec();
        if decision.state.idle_looks >= spec.fallback.max_looks {
            return None;
        }
        let ignorance = &self.stage.rover.maps().expect("maps").interest.ignorance;
        let range = spec.fallback.look_range_m as usize;
        let teaches = |cell: &Cell| {
            let near = spec.grid.around(*cell, range);
            let sum: f64 = near.cells().map(|c| f64::from(ignorance[c])).sum();
            // Sums of the same numbers in another order may differ by as much.
            sum / (near.rows * near.cols) as f64 >= spec.fallback.min_ignorance + 1e-9
        };
        let elsewhere = |cell: &Cell| *cell != self.stage.at || decision.state.idle_looks == 0;
        let vantages: Vec<Cell> = spec.grid.cells().filter(elsewhere).filter(teaches).collect();
        self.affordable(&vantages)
    }

    /// No goal fails more often than it may, and no place: one that is given up by a goal of one kind may still hold
    /// something for another, and a command asks for it anew.
    fn check_tries(&self) {
        let mut of_goal: BTreeMap<GoalId, usize> = BTreeMap::new();
        for (goal, _, _) in &self.failed {
            *of_goal.entry(*goal).or_default() += 1;
        }
        for (goal, tries) in of_goal {
            assert!(tries <= ATTEMPTS, "{goal} failed {tries} times");
        }
        for cell in self.stage.rover.spec().grid.cells() {
            // Targets within half the radius of a cell are within the radius of each other.
            let near = |target: &Cell, by_m: f64| target.distance(cell) <= by_m;
            let commands = self.commands.iter().filter(|t| near(t, 2.0 * PLACE_M)).count();
            let most = ATTEMPTS * (1 + REOPENINGS) * (1 + commands);
            for kind in Kind::ALL {
                let here = self.failed.iter().filter(|(_, k, _)| k == kind);
                let tries = here.filter(|(_, _, t)| near(t, PLACE_M / 2.0)).count();
                assert!(tries <= most, "{tries} {kind} tries around {cell}, at most {most}");
            }
        }
    }
}

/// How a mission went.
struct Flown {
    /// The most decisions that it could take.
    bound: usize,
    /// Those that it took.
    took: usize,
    /// Where it could have looked from when it decided to wait.
    missed: Option<Cell>,
    /// The first decision that chose another sequence when it was taken again on the same map without an event.
    fickle: Option<u32>,
}

fn fly(check: impl Fn(Flown)) {
    let config = Config { cases: 64, failure_persistence: None, ..Config::default() };
    // The same missions at every run.
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let flown = runner.run(&any_case(), |case| {
        check(Mission::new(case).fly());
        Ok(())
    });
    if let Err(error) = flown {
        panic!("{error}");
    }
}

#[test]
fn every_mission_against_an_adversary_ends_within_its_bound() {
    // The mission that came nearest to its bound: its decisions and its bound.
    let nearest = std::cell::Cell::new((0, 1));
    fly(|Flown { bound, took, .. }| {
        let (most, of) = nearest.get();
        if took * of > most * bound {
            nearest.set((took, bound));
        }
    });
    let (most, of) = nearest.get();
    println!("bound {of} decisions; most needed {most}");
}

#[test]
fn a_rover_that_waits_could_afford_no_look() {
    fly(|flown| assert_eq!(flown.missed, None, "it could have looked from there"));
}

#[test]
fn a_decision_taken_again_without_an_event_is_the_same() {
    fly(|flown| assert_eq!(flown.fickle, None, "this decision was another one the second time"));
}

/// A goal stood 2.8 m from a place that the same decision gave up as unreachable, and was dropped one decision too late.
#[test]
fn a_place_given_up_as_unreachable_explains_its_neighbours_at_once() {
    let case = Case {
        side: 15,
        seed: 18_163_999_380_873_671_365,
        all_kinds: false,
        flicker: 0.552_368_949_316_823_8,
        malice: 0.512_449_985_752_590_7,
        energy_j: 300_500.062_024_540_4,
    };
    assert_eq!(Mission::new(case).fly().fickle, None);
}
