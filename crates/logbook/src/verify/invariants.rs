//! What must hold of every mission, whatever was decided.

use std::collections::BTreeMap;

use wisdom_autonomy::{Decision, Maps, Pose, Spent};
use wisdom_goals::{Reason, Status};
use wisdom_grid::Cell;
use wisdom_mission::{DecisionBound, Mission};
use wisdom_planner::{Budget, CostVector, Leg, Plan, Route, Service, validate};

use crate::record;
use crate::{Entry, LogReader};

/// The invariants by name, and what each says.
pub const INVARIANTS: [(&str, &str); 6] = [
    (
        "never-idle",
        "every decision names an act that can be carried out, or a wait with what would end it",
    ),
    (
        "no-livelock",
        "something happens between two decisions, and no mission takes more of them than its bound",
    ),
    ("lives", "a goal goes only from a status to one that may follow it, for a reason there is"),
    (
        "valid-plan",
        "the plan chosen passes its validation on the map it was made on, within what is left",
    ),
    (
        "conserved",
        "time, energy, data and way only grow, by what was told, and the rover is where its way ends",
    ),
    ("masses", "every expert's masses in every cell are at least 0 and sum to 1"),
];

/// How far a sum of rounded numbers may be off, as a share.
const ROUNDING: f64 = 1e-9;

/// An invariant that does not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Breach {
    /// The decision at, or after, which it shows.
    pub decision: u32,
    /// Its name, one of [`INVARIANTS`].
    pub invariant: &'static str,
    /// What was found.
    pub detail: String,
}

impl std::fmt::Display for Breach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "decision {}, {}: {}", self.decision, self.invariant, self.detail)
    }
}

/// Watches a log go by.
pub(super) struct Watcher<'a> {
    mission: &'a Mission,
    breaches: Vec<Breach>,
    decision: u32,
    /// Whether anything came in, or something was to be carried out, since the last decision.
    news: bool,
    spent: Spent,
    pose: Option<Pose>,
    /// What was spent when the last decision was taken, and where.
    departed: Option<(Spent, Cell)>,
    statuses: BTreeMap<u32, Status>,
    last: Option<record::Decision>,
}

impl<'a> Watcher<'a> {
    pub(super) fn new(mission: &'a Mission, log: &LogReader) -> Self {
        let mut watcher = Self {
            mission,
            breaches: Vec::new(),
            decision: 0,
            news: true,
            spent: Spent::default(),
            pose: None,
            departed: None,
            statuses: BTreeMap::new(),
            last: None,
        };
        let (taken, bound) =
            (log.decisions().count() as u64, DecisionBound::of(mission).decisions());
        if taken > bound {
            watcher.decision = log.decisions().last().map_or(0, |d| d.number);
            watcher.breach("no-livelock", format!("{taken} decisions where {bound} are the most"));
        }
        watcher
    }

    pub(super) fn breaches(self) -> Vec<Breach> {
        self.breaches
    }

    fn breach(&mut self, invariant: &'static str, detail: String) {
        self.breaches.push(Breach { decision: self.decision, invariant, detail });
    }

    /// A record is about to be fed to the core.
    pub(super) fn entry(&mut self, entry: &Entry) {
        match entry {
            Entry::Observation(observation) => {
                self.news = true;
                self.moved(observation.pose.as_ref(), observation.spent.as_ref());
            }
            Entry::Message(_) | Entry::Fault(_) => self.news = true,
            Entry::Outcome(outcome) => {
                self.news = true;
                self.moved(outcome.pose.as_ref(), outcome.spent.as_ref());
                self.driven(outcome);
            }
            Entry::Decision(decision) => self.decided(decision),
        }
    }

    /// Nothing that was spent comes back.
    fn moved(&mut self, pose: Option<&record::Pose>, spent: Option<&record::Spent>) {
        let Some(spent) = spent else { return };
        let before = self.spent;
        let pairs = [
            ("time_s", before.time_s, spent.time_s),
            ("energy_j", before.energy_j, spent.energy_j),
            ("data_mb", before.data_mb, spent.data_mb),
            ("length_m", before.length_m, spent.length_m),
        ];
        for (name, before, now) in pairs.into_iter().filter(|(_, before, now)| now < before) {
            self.breach("conserved", format!("{name} falls from {before} to {now}"));
        }
        let record::Spent { time_s, energy_j, data_mb, length_m } = *spent;
        self.spent = Spent { time_s, energy_j, data_mb, length_m };
        let heading_rad = pose.map_or(0.0, |pose| pose.heading_rad);
        let cell = pose.and_then(|pose| pose.cell).map(Cell::from);
        self.pose = cell.map(|cell| Pose { cell, heading_rad }).or(self.pose);
    }

    /// The way of a step begins where the decision was taken, leads from neighbour to neighbour to where the rover stands,
    /// and is as long as what was driven.
    fn driven(&mut self, outcome: &record::Outcome) {
        let Some((spent, from)) = self.departed else { return };
        let track: Vec<Cell> = outcome.track.iter().map(|&cell| cell.into()).collect();
        let (Some(first), Some(last)) = (track.first(), track.last()) else { return };
        if *first != from {
            self.breach("conserved", format!("a way begins at {first}; the rover stood at {from}"));
        }
        if let Some(pose) = self.pose.filter(|pose| pose.cell != *last) {
            let stands = pose.cell;
            self.breach("conserved", format!("a way ends at {last}; the rover stands at {stands}"));
        }
        let spacing_m = self.mission.spec.grid.spacing_m();
        let mut length_m = 0.0;
        for pair in track.windows(2) {
            if !pair[0].touches(pair[1]) {
                self.breach("conserved", format!("a way leaps from {} to {}", pair[0], pair[1]));
            }
            length_m += pair[0].distance(pair[1]) * spacing_m;
        }
        let driven = self.spent.length_m - spent.length_m;
        if !close(driven, length_m, self.spent.length_m) {
            self.breach("conserved", format!("{driven} m were driven on a way of {length_m} m"));
        }
    }

    fn decided(&mut self, decision: &record::Decision) {
        self.decision = decision.number;
        if !std::mem::replace(&mut self.news, false) {
            self.breach("no-livelock", "nothing happened since the last decision".to_owned());
        }
        if let Ok((pose, spent)) = decision.whereabouts() {
            if spent != self.spent {
                let (found, told) = (spent, self.spent);
                self.breach("conserved", format!("decided with {found:?}; told was {told:?}"));
            }
            if let Some(told) = self.pose.filter(|told| told.cell != pose.cell) {
                let (at, told) = (pose.cell, told.cell);
                self.breach(
                    "conserved",
                    format!("decided at {at}; the rover was told to be at {told}"),
                );
            }
            self.departed = Some((spent, pose.cell));
        }
        self.acts(decision);
        self.lives(decision);
        self.last = Some(decision.clone());
    }

    fn acts(&mut self, decision: &record::Decision) {
        let Some(choice) = &decision.choice else {
            return self.breach("never-idle", "the decision has no choice".to_owned());
        };
        let Some(act) = &choice.act else {
            return self.breach("never-idle", "the decision has no act".to_owned());
        };
        let first = |goal: u32| {
            let mut stops = choice.plan.iter().flat_map(|plan| &plan.legs);
            let chosen =
                decision.objective.as_ref().and_then(|o| o.family.get(choice.chosen as usize));
            let sequence = chosen.and_then(|option| option.sequence.as_ref());
            let begins = sequence.and_then(|s| s.stops.first()).is_some_and(|s| s.goal == goal);
            begins && stops.next().is_some()
        };
        let route = |act: &record::Act| act.route.as_ref().is_some_and(|r| !r.cells.is_empty());
        let sound = match act.name.as_str() {
            "pursue" => act.goal.is_some_and(first),
            "look" | "home" => route(act),
            "wait" => act.wake.as_ref().is_some_and(|wake| !wake.is_empty()),
            _ => false,
        };
        if !sound {
            let name = &act.name;
            self.breach("never-idle", format!("the act `{name}` cannot be carried out"));
        }
    }

    fn lives(&mut self, decision: &record::Decision) {
        let Some(choice) = &decision.choice else { return };
        let status = |name: &str| Status::ALL.iter().copied().find(|s| s.name() == name);
        for step in &choice.transitions {
            let goal = step.goal;
            let (Some(from), Some(to)) = (status(&step.from), status(&step.to)) else {
                let (from, to) = (&step.from, &step.to);
                self.breach("lives", format!("G{goal} goes from `{from}` to `{to}`"));
                continue;
            };
            let known = self.statuses.insert(goal, to);
            if let Some(known) = known.filter(|known| *known != from) {
                self.breach("lives", format!("G{goal} leaves {from}; it was {known}"));
            }
            if !to.may_follow(from) {
                self.breach("lives", format!("G{goal} goes from {from} to {to}"));
            }
            if !Reason::ALL.iter().any(|reason| reason.to_string() == step.reason) {
                let reason = &step.reason;
                self.breach(
                    "lives",
                    format!("G{goal} goes to {to} for no reason that there is: `{reason}`"),
                );
            }
        }
        for verdict in &choice.verdicts {
            let Some(goal) = &verdict.goal else { continue };
            let known = self.statuses.get(&goal.id).copied();
            if !Reason::ALL.iter().any(|reason| reason.to_string() == verdict.reason) {
                let (id, reason) = (goal.id, &verdict.reason);
                self.breach("lives", format!("of G{id} is said `{reason}`, which is no reason"));
            }
            // A goal under way is dispatched after what was said of it.
            let told = status(&goal.status);
            let after = known == Some(Status::Dispatched) && told == Some(Status::Committed);
            if let Some(known) = known.filter(|known| Some(*known) != told && !after) {
                let (id, told) = (goal.id, &goal.status);
                self.breach(
                    "lives",
                    format!("G{id} is told to be {told}; its steps lead to {known}"),
                );
            }
        }
    }

    /// The maps that a decision was made from, derived again.
    pub(super) fn maps(&mut self, number: u32, decision: &Decision, maps: &Maps) {
        self.decision = number;
        for (expert, masses) in maps.evidence.experts() {
            let bad = masses.iter().find(|(_, mass)| {
                let parts =
                    [mass.interesting(), mass.not_interesting(), mass.ignorance(), mass.paradox()];
                let sum: f64 = parts.iter().sum();
                !((sum - 1.0).abs() <= ROUNDING && parts.iter().all(|part| *part >= 0.0))
            });
            if let Some((cell, mass)) = bad {
                let detail = format!("`{expert}` at {cell} gives {mass:?}");
                self.breaches.push(Breach { decision: number, invariant: "masses", detail });
            }
        }
        self.plan(decision, maps);
    }

    /// The plan as it is written in the log, on the ground as it was derived.
    fn plan(&mut self, decision: &Decision, maps: &Maps) {
        let written = self.last.as_ref().and_then(|last| last.choice.as_ref()?.plan.as_ref());
        let Some(plan) = written.map(plan) else {
            return self.breach("valid-plan", "the decision has no plan".to_owned());
        };
        let Some(plan) = plan else {
            return self
                .breach("valid-plan", "a leg of the plan lacks its way or its cost".to_owned());
        };
        let (spec, spent) = (&self.mission.spec, decision.state.spent);
        let left = Budget {
            time_s: (spec.budget.time_s - spent.time_s).max(0.0),
            energy_j: (spec.budget.energy_j - spec.budget.reserve_j - spent.energy_j).max(0.0),
            min_reliability: spec.budget.min_reliability,
        };
        if plan.start != decision.state.pose.cell {
            let (start, at) = (plan.start, decision.state.pose.cell);
            self.breach("valid-plan", format!("it begins at {start}; the rover stands at {at}"));
        }
        if let Err(violation) = validate(&plan, &maps.ground, &spec.vehicle, &left) {
            self.breach("valid-plan", violation.to_string());
        }
    }
}

fn close(a: f64, b: f64, of: f64) -> bool {
    (a - b).abs() <= ROUNDING * of.abs().max(1.0)
}

fn cost(cost: &record::Cost) -> CostVector {
    let record::Cost { length_m, time_s, energy_j, neg_ln_r } = *cost;
    CostVector { length_m, time_s, energy_j, neg_ln_r: neg_ln_r.unwrap_or(f64::INFINITY) }
}

/// A plan as it was written; none if a part of it is missing.
fn plan(record: &record::Plan) -> Option<Plan> {
    let leg = |leg: &record::Leg| {
        let route = leg.route.as_ref()?;
        let service = leg.service.as_ref()?;
        Some(Leg {
            stop: leg.stop as usize,
            pose: leg.pose?.into(),
            route: Route {
                cells: route.cells.iter().map(|&cell| cell.into()).collect(),
                cost: cost(route.cost.as_ref()?),
            },
            service: Service { time_s: service.time_s, energy_j: service.energy_j },
        })
    };
    Some(Plan {
        start: record.start?.into(),
        legs: record.legs.iter().map(leg).collect::<Option<_>>()?,
        total: cost(record.total.as_ref()?),
    })
}
