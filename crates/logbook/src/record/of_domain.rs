//! Domain types into records.

use wisdom_autonomy as core;
use wisdom_goals as goals;
use wisdom_grid as grid;
use wisdom_planner as planner;

use super::{
    Act, Candidates, Cell, Change, Choice, Command, Cost, DECISION_VERSION, Decision, Event, Frame,
    Fused, Goal, Gradient, LayerWindow, LeftOut, Leg, LegSummary, ManagerState, Masses, Message,
    Objective, Objectives, Observation, Order, Outcome, Plan, PlanOption, Pose, Retired, Route,
    Routes, Sequence, Service, Site, Spent, State, Stop, Term, Transition, Tries, Trigger, Verdict,
    hex,
};
use crate::Setting;

/// A number, or nothing where it is not finite: records hold no infinity.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// BLAKE3 of the cells in their order, as hexadecimal digits.
fn cells_digest(cells: &[grid::Cell]) -> String {
    let mut hasher = blake3::Hasher::new();
    for cell in cells {
        hasher.update(&(cell.row as u32).to_le_bytes());
        hasher.update(&(cell.col as u32).to_le_bytes());
    }
    hex(hasher.finalize().as_bytes())
}

impl From<grid::Cell> for Cell {
    fn from(cell: grid::Cell) -> Self {
        Self { row: cell.row as u32, col: cell.col as u32 }
    }
}

impl From<core::Pose> for Pose {
    fn from(pose: core::Pose) -> Self {
        Self { cell: Some(pose.cell.into()), heading_rad: pose.heading_rad }
    }
}

impl From<core::Spent> for Spent {
    fn from(spent: core::Spent) -> Self {
        let core::Spent { time_s, energy_j, data_mb, length_m } = spent;
        Self { time_s, energy_j, data_mb, length_m }
    }
}

impl From<planner::CostVector> for Cost {
    fn from(cost: planner::CostVector) -> Self {
        let planner::CostVector { length_m, time_s, energy_j, neg_ln_r } = cost;
        Self { length_m, time_s, energy_j, neg_ln_r: finite(neg_ln_r) }
    }
}

impl From<planner::Service> for Service {
    fn from(service: planner::Service) -> Self {
        Self { time_s: service.time_s, energy_j: service.energy_j, data_mb: 0.0 }
    }
}

impl From<goals::ServiceCost> for Service {
    fn from(cost: goals::ServiceCost) -> Self {
        Self { time_s: cost.time_s, energy_j: cost.energy_j, data_mb: cost.data_mb }
    }
}

impl From<&planner::Route> for Route {
    fn from(route: &planner::Route) -> Self {
        Self {
            cells: route.cells.iter().map(|&cell| cell.into()).collect(),
            cost: Some(route.cost.into()),
        }
    }
}

impl From<&core::LayerWindow> for LayerWindow {
    fn from(reading: &core::LayerWindow) -> Self {
        let grid::Window { row, col, rows, cols } = reading.window;
        Self {
            layer: reading.layer.clone(),
            row: row as u32,
            col: col as u32,
            rows: rows as u32,
            cols: cols as u32,
            values: reading.values.clone(),
            uncertainty: reading.uncertainty.clone(),
        }
    }
}

impl From<&core::Observation> for Observation {
    fn from(observation: &core::Observation) -> Self {
        Self {
            number: observation.number,
            pose: Some(observation.pose.into()),
            spent: Some(observation.spent.into()),
            windows: observation.windows.iter().map(Into::into).collect(),
        }
    }
}

impl From<&core::Outcome> for Outcome {
    fn from(outcome: &core::Outcome) -> Self {
        use core::StepResult as Result;
        let (result, goal) = match outcome.result {
            Result::Achieved(goal) => ("achieved", Some(goal.0)),
            Result::Blocked(goal) => ("blocked", Some(goal.0)),
            Result::Aborted(goal) => ("aborted", Some(goal.0)),
            Result::Interrupted(goal) => ("interrupted", Some(goal.0)),
            Result::Arrived => ("arrived", None),
            Result::Stopped => ("stopped", None),
            _ => (UNNAMED, None),
        };
        Self {
            decision: outcome.decision,
            result: result.to_owned(),
            goal,
            operators: outcome.operators.clone(),
            pose: Some(outcome.pose.into()),
            spent: Some(outcome.spent.into()),
            predicted_reliability: outcome.predicted_reliability,
            track: outcome.track.iter().map(|&cell| cell.into()).collect(),
        }
    }
}

/// For a variant that this crate was not told of; reading it back is an error that shows it.
const UNNAMED: &str = "unnamed";

fn trigger(trigger: &core::Trigger) -> Trigger {
    use core::Trigger as Why;
    let named = Trigger { name: trigger.name().to_owned(), ..Trigger::default() };
    match *trigger {
        Why::GoalEnded(goal) | Why::LegFailed(goal) | Why::LegInterrupted(goal) => {
            Trigger { goal: Some(goal.0), ..named }
        }
        Why::InterestChanged { goal, before, after } | Why::Conflict { goal, before, after } => {
            Trigger { goal: Some(goal.0), before: finite(before), after: finite(after), ..named }
        }
        Why::NewCandidate { cell, prize } => {
            Trigger { cell: Some(cell.into()), prize: finite(prize), ..named }
        }
        Why::BudgetDrift { share } => Trigger { share: finite(share), ..named },
        Why::Risk { reliability, floor } => {
            Trigger { reliability: finite(reliability), floor: finite(floor), ..named }
        }
        Why::CorridorChanged { cell, before, after } => Trigger {
            cell: Some(cell.into()),
            before: finite(before),
            after: finite(after),
            ..named
        },
        Why::WindowClosing { goal, left_s } => {
            Trigger { goal: Some(goal.0), seconds: finite(left_s), ..named }
        }
        Why::Command { number } | Why::Facts { number } => {
            Trigger { message: Some(number), ..named }
        }
        Why::Cadence { since_s } | Why::Watchdog { since_s } => {
            Trigger { seconds: finite(since_s), ..named }
        }
        Why::RouteBlocked(cell) => Trigger { cell: Some(cell.into()), ..named },
        _ => named,
    }
}

fn goal(goal: &goals::Goal, setting: &Setting) -> Goal {
    // Taken apart field by field, so that nothing it comes to know is left out of the log.
    let goals::Goal {
        id,
        directive,
        target,
        interest,
        prize,
        prominence,
        ignorance,
        paradox,
        contradiction,
        credit,
        region_cells,
        extent,
        doubt,
        attempts,
        born,
        parent,
        order,
        pose,
        operators,
        life,
    } = goal;
    let order = order.as_ref().map(|order| Order {
        name: order.name.clone(),
        prize: order.prize,
        mandatory: order.mandatory,
        directive_before: order.before.map(|(directive, _)| directive as u32),
        target_before: order.before.map(|(_, target)| target.into()),
    });
    Goal {
        id: id.0,
        directive: *directive as u32,
        directive_name: setting.directive(*directive),
        target: Some((*target).into()),
        interest: *interest,
        prize: *prize,
        prominence: *prominence,
        ignorance: *ignorance,
        paradox: *paradox,
        credit: credit.clone(),
        region_cells: *region_cells as u32,
        attempts: *attempts,
        born: *born,
        status: life.status().to_string(),
        contradiction: *contradiction,
        extent_first: Some(grid::Cell { row: extent.row, col: extent.col }.into()),
        extent_rows: extent.rows as u32,
        extent_cols: extent.cols as u32,
        doubt: *doubt,
        parent: parent.map(|parent| parent.0),
        order,
        pose: pose.map(Into::into),
        operators: operators.iter().map(|&index| index as u32).collect(),
        kind: setting.kind(*directive),
    }
}

fn retired(place: &goals::Retired) -> Retired {
    let &goals::Retired { goal, kind, target, radius_m, reason, heard, ground, reopenings, closed } =
        place;
    Retired {
        goal: goal.0,
        target: Some(target.into()),
        radius_m,
        reason: reason.to_string(),
        ground,
        reopenings,
        closed,
        kind: kind.to_string(),
        heard,
    }
}

fn command(command: &goals::Command) -> Command {
    let named = Command { name: command.name.clone(), ..Command::default() };
    match command.wish {
        goals::Wish::Withdraw => named,
        goals::Wish::Pursue { directive, target, prize, mandatory } => Command {
            directive: Some(directive as u32),
            target: Some(target.into()),
            prize,
            mandatory,
            ..named
        },
    }
}

fn tries(&goals::Tries { target, failed }: &goals::Tries) -> Tries {
    Tries { target: Some(target.into()), failed }
}

fn event((goal, event): (goals::GoalId, goals::Event)) -> Event {
    let kind = match event {
        goals::Event::Achieved => "achieved",
        goals::Event::Failed => "failed",
    };
    Event { goal: goal.0, kind: kind.to_owned() }
}

impl ManagerState {
    /// The record of what a goal manager remembers.
    #[must_use]
    pub fn of(state: &goals::ManagerState, setting: &Setting) -> Self {
        // Taken apart field by field, so that nothing it comes to remember is left out of the log.
        let goals::ManagerState {
            goals,
            agenda,
            retired: places,
            tries: failed,
            events,
            commands,
            next_id,
            decision,
        } = state;
        Self {
            goals: goals.values().map(|known| goal(known, setting)).collect(),
            agenda: agenda.iter().map(|id| id.0).collect(),
            retired: places.iter().map(retired).collect(),
            tries: failed.iter().map(tries).collect(),
            commands: commands.iter().map(command).collect(),
            events: events.iter().copied().map(event).collect(),
            next_id: *next_id,
            decision: *decision,
        }
    }
}

fn state(state: &core::RoverState, setting: &Setting) -> State {
    State {
        pose: Some(state.pose.into()),
        spent: Some(state.spent.into()),
        facts: setting.facts(state.facts),
        underway: state.underway.map(|goal| goal.0),
        idle_looks: state.idle_looks,
        manager: Some(ManagerState::of(&state.manager, setting)),
    }
}

fn site(site: &goals::Site) -> Site {
    Site {
        peak: Some(site.peak.into()),
        prominence: site.prominence,
        prize: site.prize,
        region_cells: site.region.len() as u32,
        region_digest: cells_digest(&site.region),
    }
}

fn candidates(decision: &core::Decision) -> Candidates {
    let goals::Shortlist { kept, left_out } = &decision.shortlist;
    Candidates {
        sites: decision.sites.iter().map(site).collect(),
        shortlist: kept.iter().map(|id| id.0).collect(),
        left_out: left_out.iter().map(|&(id, bound)| LeftOut { goal: id.0, bound }).collect(),
        promises: decision.promises.iter().map(site).collect(),
        disputes: decision.disputes.iter().map(site).collect(),
    }
}

fn stop(stop: &goals::Stop, setting: &Setting) -> Stop {
    let goals::Expansion { before, after, facts, cost } = &stop.expansion;
    Stop {
        goal: stop.goal.0,
        node: stop.pose as u32,
        alternative: stop.alternative as u32,
        before: setting.operators(before),
        after: setting.operators(after),
        facts_after: setting.facts(*facts),
        cost: Some((*cost).into()),
    }
}

fn sequence(sequence: &goals::GoalSequence, setting: &Setting) -> Sequence {
    Sequence {
        stops: sequence.stops.iter().map(|s| stop(s, setting)).collect(),
        value: sequence.value,
        prize: sequence.prize,
        expected: sequence.expected,
        reliability: sequence.reliability,
        time_s: sequence.time_s,
        energy_j: sequence.energy_j,
        data_mb: sequence.data_mb,
    }
}

fn leg_summary(leg: &planner::Leg) -> LegSummary {
    LegSummary {
        stop: leg.stop as u32,
        pose: Some(leg.pose.into()),
        cost: Some(leg.route.cost.into()),
        service: Some(leg.service.into()),
        route_digest: cells_digest(&leg.route.cells),
    }
}

fn objectives(objectives: core::Objectives) -> Objectives {
    Objectives {
        expected_interest: objectives.expected_interest,
        most_interesting: objectives.most_interesting,
        all_or_nothing: objectives.all_or_nothing,
        chance_constrained: objectives.chance_constrained,
        net_benefit: finite(objectives.net_benefit),
        utility: finite(objectives.utility),
    }
}

fn option(option: &core::PlanOption, setting: &Setting) -> PlanOption {
    PlanOption {
        sequence: Some(sequence(&option.sequence, setting)),
        legs: option.plan.legs.iter().map(leg_summary).collect(),
        total: Some(option.plan.total.into()),
        objectives: Some(objectives(option.objectives)),
        front_best: option.front.best as u32,
        front_plans: option.front.plans as u32,
        front_complete: option.front.complete,
    }
}

fn objective(decision: &core::Decision, setting: &Setting) -> Objective {
    let (proof, bound) = match decision.proof {
        goals::Proof::Proven => ("proven", None),
        goals::Proof::Bound(bound) => ("bound", finite(bound)),
    };
    Objective {
        family: decision.family.iter().map(|member| option(member, setting)).collect(),
        proof: proof.to_owned(),
        bound,
        expansions: decision.expansions,
        held: decision.held,
        committed_value: decision.committed_value.and_then(finite),
    }
}

fn plan(plan: &planner::Plan) -> Plan {
    let leg = |leg: &planner::Leg| Leg {
        stop: leg.stop as u32,
        pose: Some(leg.pose.into()),
        route: Some((&leg.route).into()),
        service: Some(leg.service.into()),
    };
    Plan {
        start: Some(plan.start.into()),
        legs: plan.legs.iter().map(leg).collect(),
        total: Some(plan.total.into()),
    }
}

fn act(act: &core::Act, cost: planner::CostVector) -> Act {
    let named = Act { name: act.name().to_owned(), cost: Some(cost.into()), ..Act::default() };
    match act {
        core::Act::Pursue(goal) => Act { goal: Some(goal.0), ..named },
        core::Act::Look { route, ignorance } => {
            Act { route: Some(route.into()), ignorance: finite(*ignorance), ..named }
        }
        core::Act::Home { route } => Act { route: Some(route.into()), ..named },
        core::Act::Wait { wake } => Act { wake: Some(wake.to_string()), ..named },
        _ => named,
    }
}

fn term(term: &goals::Term) -> Term {
    Term {
        name: term.name.to_owned(),
        value: finite(term.value),
        limit: term.limit.and_then(finite),
    }
}

fn change(change: &goals::Change) -> Change {
    Change {
        transformation: change.transformation.to_string(),
        reason: change.reason.to_string(),
        other: change.other.map(|other| other.0),
        terms: change.terms.iter().map(term).collect(),
    }
}

fn transition(step: goals::Transition) -> Transition {
    Transition {
        goal: step.goal.0,
        from: step.from.to_string(),
        to: step.to.to_string(),
        reason: step.reason.to_string(),
        outcome: step.outcome.map(|outcome| outcome.to_string()),
    }
}

fn verdict(verdict: &goals::Verdict, setting: &Setting) -> Verdict {
    let transformation = goals::Transformation::of(verdict.action, verdict.reason);
    Verdict {
        goal: Some(goal(&verdict.goal, setting)),
        action: verdict.action.to_string(),
        reason: verdict.reason.to_string(),
        cause: verdict.cause.to_string(),
        turn: verdict.turn.map(|turn| turn as u32),
        other: verdict.other.map(|other| other.0),
        terms: verdict.terms.iter().map(term).collect(),
        transformation: transformation.to_string(),
        changes: verdict.changes.iter().map(change).collect(),
    }
}

impl From<&core::Message> for Message {
    fn from(message: &core::Message) -> Self {
        let numbered = Self { number: message.number, ..Self::default() };
        match &message.word {
            core::Word::Pursue { name, directive, target, prize, mandatory } => Self {
                kind: "pursue".to_owned(),
                name: name.clone(),
                directive: directive.clone(),
                target: Some((*target).into()),
                prize: finite(*prize),
                mandatory: *mandatory,
                ..numbered
            },
            core::Word::Withdraw { name } => {
                Self { kind: "withdraw".to_owned(), name: name.clone(), ..numbered }
            }
            core::Word::Facts { adds, deletes } => Self {
                kind: "facts".to_owned(),
                adds: adds.clone(),
                deletes: deletes.clone(),
                ..numbered
            },
            _ => Self { kind: UNNAMED.to_owned(), ..numbered },
        }
    }
}

impl Decision {
    /// The record of a decision, not yet linked to the chain of its run.
    #[must_use]
    pub fn of(decision: &core::Decision, setting: &Setting) -> Self {
        let digests = &decision.digests;
        Self {
            number: decision.number,
            decision_version: DECISION_VERSION,
            triggers: decision.triggers.iter().map(trigger).collect(),
            state: Some(state(&decision.state, setting)),
            frame: Some(Frame {
                digest: hex(&digests.frame.0),
                map_changed: decision.map_changed,
                seen: decision.seen,
                version: decision.map_version,
            }),
            gradient: Some(Gradient { digest: hex(&digests.derived.0) }),
            masses: Some(Masses { digest: hex(&digests.masses.0) }),
            fusion: Some(Fused { digest: hex(&digests.fusion.0), background: decision.background }),
            candidates: Some(candidates(decision)),
            routes: Some(Routes {
                ground_digest: hex(&digests.ground.0),
                travel_digest: hex(&digests.travel.0),
            }),
            objective: Some(objective(decision, setting)),
            choice: Some(Choice {
                chosen: decision.chosen as u32,
                act: Some(act(&decision.act, decision.act_cost)),
                plan: decision.family.get(decision.chosen).map(|member| plan(&member.plan)),
                verdicts: decision.verdicts.iter().map(|v| verdict(v, setting)).collect(),
                manager: Some(ManagerState::of(&decision.manager_after, setting)),
                transitions: decision.transitions.iter().copied().map(transition).collect(),
            }),
            chain: String::new(),
        }
    }
}
