//! A short run, told twice over: two goals, three decisions, with every kind of record in it.

use std::collections::BTreeMap;

use wisdom_autonomy::{
    Act, Decision, Digest, Digests, FrontOf, LayerWindow, Objectives, Observation, Outcome,
    PlanOption, Pose, RoverState, Spent, StepResult, Trigger,
};
use wisdom_goals::{
    Action, Cause, Change, Command, Event, Expansion, FactSet, Goal, GoalId, GoalSequence, Kind,
    Life, ManagerState, Order, Proof, Reason, Retired, ServiceCost, Shortlist, Site, Status, Stop,
    Term, Transition, Tries, Verdict, Wish,
};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_logbook::{
    DecisionMaps, Drape, LogError, LogReader, LogWriter, Options, RunHeader, Setting, Store,
};
use wisdom_planner::{CostVector, Leg, Plan, Route, Service};

/// Decisions in the story.
pub(crate) const DECISIONS: u32 = 3;

pub(crate) fn setting() -> Setting {
    Setting {
        grid: GridSpec::new(4, 6, 2.0).unwrap().at(100.0, 50.0),
        facts: vec!["warm".to_owned(), "sampled".to_owned()],
        operators: vec!["drive".to_owned(), "unfold".to_owned(), "drill".to_owned()],
        directives: vec!["contact".to_owned(), "look".to_owned()],
        kinds: vec!["inspect".to_owned(), "look-again".to_owned()],
    }
}

pub(crate) fn header() -> RunHeader {
    RunHeader {
        metadata: BTreeMap::from([("seed".to_owned(), "42".to_owned())]),
        attachments: vec![
            ("mission.toml".to_owned(), "application/toml".to_owned(), b"seed = 42\n".to_vec()),
            ("terrain.tif".to_owned(), "image/tiff".to_owned(), vec![7; 300]),
        ],
    }
}

pub(crate) fn interest(number: u32) -> Raster<f32> {
    let spec = setting().grid;
    Raster::from_fn(spec, |cell| (number as usize * 100 + spec.index(cell)) as f32 / 1000.0)
}

fn spent(number: u32) -> Spent {
    let steps = f64::from(number);
    Spent {
        time_s: 60.25 * steps,
        energy_j: 1e3 / 3.0 * steps,
        data_mb: 0.1 * steps,
        length_m: 2.0 * steps,
    }
}

fn pose(number: u32) -> Pose {
    Pose { cell: Cell::new(1, number as usize), heading_rad: 0.1 + f64::from(number) }
}

pub(crate) fn observation(number: u32) -> Observation {
    let window = Window { row: 0, col: 1, rows: 2, cols: 2 };
    Observation {
        number,
        pose: pose(number),
        spent: spent(number),
        windows: vec![LayerWindow {
            layer: "elevation".to_owned(),
            window,
            values: vec![-4500.25, 0.0, 1.0 / 3.0, 7.0],
            uncertainty: vec![0.0, 1.0, 0.5, 0.123_456_7],
        }],
    }
}

pub(crate) fn outcome(decision: u32) -> Outcome {
    Outcome {
        decision,
        result: StepResult::Achieved(GoalId(decision)),
        operators: vec!["drive".to_owned(), "drill".to_owned()],
        pose: pose(decision + 1),
        spent: spent(decision + 1),
        predicted_reliability: 0.975,
        track: vec![pose(decision).cell, pose(decision + 1).cell],
    }
}

fn goal(id: u32) -> Goal {
    Goal {
        id: GoalId(id),
        directive: 1,
        target: Cell::new(2, id as usize),
        interest: 0.9,
        prize: 0.8,
        prominence: 0.3,
        ignorance: 0.05,
        paradox: 0.01,
        credit: vec![0.25, 0.75],
        region_cells: 4,
        attempts: 1,
        born: 0,
        contradiction: 0.2,
        extent: Window { row: 1, col: 0, rows: 2, cols: 3 },
        doubt: 0.4,
        parent: (id > 0).then(|| GoalId(id - 1)),
        order: id.is_multiple_of(2).then(|| Order {
            name: "go there".to_owned(),
            prize: 0.8,
            mandatory: true,
            before: Some((0, Cell::new(1, 1))),
        }),
        pose: Some(Cell::new(2, 1)),
        operators: vec![1, 2],
        life: Life::recorded(Status::Dispatched),
    }
}

pub(crate) fn manager(number: u32) -> ManagerState {
    ManagerState {
        goals: [goal(number), goal(number + 1)].into_iter().map(|g| (g.id, g)).collect(),
        agenda: vec![GoalId(number), GoalId(number + 1)],
        retired: vec![Retired {
            goal: GoalId(90),
            kind: Kind::Adjudicate,
            heard: 0b101,
            target: Cell::new(0, 0),
            radius_m: 8.0,
            reason: Reason::AttemptsSpent,
            ground: u64::MAX - 1,
            reopenings: 1,
            closed: true,
        }],
        tries: vec![Tries { target: Cell::new(3, 3), failed: 1 }],
        events: vec![(GoalId(number), Event::Achieved), (GoalId(number + 1), Event::Failed)],
        commands: vec![
            Command {
                name: "go there".to_owned(),
                wish: Wish::Pursue {
                    directive: 1,
                    target: Cell::new(3, 2),
                    prize: 0.5,
                    mandatory: false,
                },
            },
            Command { name: "go there".to_owned(), wish: Wish::Withdraw },
        ],
        next_id: number + 2,
        decision: number,
    }
}

fn plan(number: u32) -> Plan {
    let (from, to) = (pose(number).cell, pose(number + 1).cell);
    let cost = CostVector { length_m: 2.0, time_s: 50.0, energy_j: 300.0, neg_ln_r: 0.025 };
    let leg = Leg {
        stop: 0,
        pose: to,
        route: Route { cells: vec![from, to], cost },
        service: Service { time_s: 10.25, energy_j: 33.0 },
    };
    Plan::new(from, vec![leg])
}

fn sequence(number: u32) -> GoalSequence {
    let cost = ServiceCost { time_s: 10.25, energy_j: 33.0, data_mb: 0.1 };
    let expansion =
        Expansion { before: vec![], after: vec![1, 2], facts: FactSet::from_bits(0b11), cost };
    let service = expansion.cost;
    let stop =
        Stop { goal: GoalId(number), pose: 1, alternative: 0, expansion, wait_s: 0.0, service };
    GoalSequence {
        end: None,
        missed: 0,
        fresh: 0.8,
        stops: vec![stop],
        value: 0.78,
        prize: 0.8,
        expected: 0.78,
        reliability: 0.975,
        time_s: 60.25,
        energy_j: 333.0,
        data_mb: 0.1,
    }
}

fn verdict(id: u32, action: Action, reason: Reason) -> Verdict {
    Verdict {
        goal: goal(id),
        action,
        reason,
        cause: Cause::Discovery,
        turn: (action == Action::Add).then_some(0),
        other: None,
        terms: vec![
            Term::against("energy_j", 400.0, 350.0),
            Term::against("data_mb", 1.0, f64::INFINITY),
        ],
        changes: vec![Change::new(Reason::Retyped, vec![Term::of("ignorance", 0.5)])],
    }
}

pub(crate) fn decision(number: u32) -> Decision {
    let digest = |salt: u8| Digest([salt ^ number as u8; 32]);
    let objectives = Objectives {
        expected_interest: 0.78,
        most_interesting: 0.8,
        all_or_nothing: 0.78,
        chance_constrained: 0.8,
        net_benefit: f64::NEG_INFINITY,
        utility: 0.7,
    };
    let front = FrontOf { best: 0, plans: 1, complete: true };
    let chosen = PlanOption { sequence: sequence(number), plan: plan(number), objectives, front };
    let idle = PlanOption {
        sequence: GoalSequence::empty(),
        plan: Plan::new(pose(number).cell, Vec::new()),
        objectives,
        front: FrontOf { best: 1, ..front },
    };
    Decision {
        number,
        triggers: vec![
            Trigger::Start,
            Trigger::InterestChanged { goal: GoalId(1), before: 0.5, after: 0.75 },
        ],
        state: RoverState {
            pose: pose(number),
            spent: spent(number),
            facts: FactSet::from_bits(0b01),
            underway: Some(GoalId(number)),
            idle_looks: 0,
            manager: manager(number),
        },
        digests: Digests {
            frame: digest(1),
            derived: digest(2),
            masses: digest(3),
            fusion: digest(4),
            ground: digest(5),
            travel: digest(6),
        },
        map_changed: true,
        map_version: 3,
        promises: Vec::new(),
        disputes: Vec::new(),
        transitions: vec![Transition {
            goal: GoalId(number),
            from: Status::Committed,
            to: Status::Dispatched,
            reason: Reason::Unchanged,
            outcome: None,
        }],
        background: 0.488,
        seen: 0.25,
        sites: vec![Site {
            peak: Cell::new(2, 1),
            prominence: 0.3,
            prize: 0.8,
            region: vec![Cell::new(2, 1), Cell::new(2, 2)],
        }],
        verdicts: vec![
            verdict(number, Action::Add, Reason::NewMaximum),
            verdict(number + 1, Action::Drop, Reason::Energy),
            verdict(number + 2, Action::Keep, Reason::Unchanged),
        ],
        shortlist: Shortlist {
            kept: vec![GoalId(number)],
            left_out: vec![(GoalId(number + 1), 0.1)],
        },
        family: vec![chosen, idle],
        chosen: 0,
        proof: Proof::Bound(1.5),
        expansions: 17,
        committed_value: None,
        held: false,
        act: Act::Pursue(GoalId(number)),
        act_cost: CostVector { neg_ln_r: f64::INFINITY, ..CostVector::ZERO },
        manager_after: manager(number + 1),
    }
}

/// Tells the story to a writer.
pub(crate) fn tell<S: Store>(writer: &mut LogWriter<S>) -> Result<(), LogError> {
    for number in 0..DECISIONS {
        writer.observation(&observation(number))?;
        let (interest, elevation) = (interest(number), Raster::filled(setting().grid, -4500.0));
        let first = [("elevation", &elevation)];
        let others = if number == 0 { &first[..] } else { &[] };
        let uncertainty = Raster::filled(setting().grid, 0.25);
        let drape = Some(Drape { elevation: &elevation, uncertainty: &uncertainty });
        writer.decision(&decision(number), &DecisionMaps { interest: &interest, others, drape })?;
        writer.outcome(&outcome(number))?;
    }
    Ok(())
}

/// The story as the bytes of a whole log.
pub(crate) fn log() -> Vec<u8> {
    let mut writer = LogWriter::over(Vec::new(), &header(), setting(), Options::default()).unwrap();
    tell(&mut writer).unwrap();
    writer.finish("goals-achieved", &BTreeMap::new()).unwrap()
}

pub(crate) fn read(bytes: &[u8]) -> LogReader {
    LogReader::from_bytes(bytes.to_vec()).unwrap()
}
