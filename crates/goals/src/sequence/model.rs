//! What a stop does to a plan: the one place where a prefix grows.

use std::collections::BTreeMap;

use wisdom_planner::CostVector;

use super::problem::{Candidate, End, GoalSequence, Problem, Stop};
use crate::objective::{Gains, Objective, Prices, Served};
use crate::prize::Ladder;
use crate::{FactSet, GoalId, ServiceCost};

/// Facts reached before the search starts; of more than these the cheapest services are not known.
const FACTS_EXPLORED: usize = 1024;

/// A prefix of a sequence, but for the goals it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Standing {
    /// The facts that hold, by their number.
    pub facts: u32,
    /// Where the rover stands, as a node of the travel matrix.
    pub node: u32,
    pub time_s: f64,
    pub energy_j: f64,
    pub data_mb: f64,
    pub neg_ln_r: f64,
    pub reliability: f64,
    /// Of the mission's objective.
    pub gain: f64,
}

/// One stop of a sequence, by indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Call {
    pub candidate: usize,
    /// The pose, as a node of the travel matrix.
    pub node: usize,
    pub alternative: usize,
}

/// What a directive's operators do in some state of the facts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Service {
    /// The facts afterwards, by their number.
    facts: u32,
    cost: ServiceCost,
    /// The part of the time that passes before the rover arrives.
    before_s: f64,
}

/// What is known of a directive in some state of the facts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    Nothing,
    Impossible,
    Possible(Service),
}

impl Known {
    fn service(self) -> Option<Service> {
        match self {
            Self::Possible(service) => Some(service),
            Self::Impossible | Self::Nothing => None,
        }
    }
}

/// A prefix as a whole plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Whole {
    pub value: f64,
    pub neg_ln_r: f64,
    pub reliability: f64,
    pub time_s: f64,
    pub energy_j: f64,
    pub end: Option<End>,
}

/// A problem with its names resolved and its services worked out.
pub(crate) struct Model<'a> {
    pub problem: Problem<'a>,
    pub objective: &'static dyn Objective,
    pub prices: Prices,
    /// Least reliability of a whole plan: the mission's floor and the objective's.
    pub floor: f64,
    /// For each candidate those that must come before it, by index.
    pub after: Vec<Vec<usize>>,
    /// For each candidate those that may not stand beside it, by index, both ways round.
    pub excludes: Vec<Vec<usize>>,
    /// Whether each candidate names a goal in `after` that is none of the candidates, and so can never be done.
    pub orphaned: Vec<bool>,
    states: Vec<FactSet>,
    numbers: BTreeMap<FactSet, u32>,
    /// For each state of the facts and each directive.
    services: Vec<Vec<Known>>,
    /// Whether all states that the directives can lead to were reached.
    explored: bool,
}

impl<'a> Model<'a> {
    pub(crate) fn new(problem: Problem<'a>) -> Self {
        let objective = problem.policy.objective();
        let floor = problem.limits.min_reliability.max(objective.floor(&problem.preferences));
        let index: BTreeMap<GoalId, usize> =
            problem.candidates.iter().enumerate().map(|(i, c)| (c.goal, i)).collect();
        let known = |ids: &[GoalId]| ids.iter().filter_map(|id| index.get(id).copied()).collect();
        let after: Vec<Vec<usize>> = problem.candidates.iter().map(|c| known(&c.after)).collect();
        let mut excludes: Vec<Vec<usize>> =
            problem.candidates.iter().map(|c| known(&c.excludes)).collect();
        for one in 0..excludes.len() {
            for other in excludes[one].clone() {
                if other != one && !excludes[other].contains(&one) {
                    excludes[other].push(one);
                }
            }
            excludes[one].retain(|&other| other != one);
        }
        let orphaned = problem
            .candidates
            .iter()
            .map(|c| c.after.iter().any(|id| !index.contains_key(id)))
            .collect();
        let mut model = Self {
            objective,
            prices: objective.prices(&problem.preferences),
            floor,
            after,
            excludes,
            orphaned,
            states: Vec::new(),
            numbers: BTreeMap::new(),
            services: Vec::new(),
            explored: false,
            problem,
        };
        model.number(problem.facts);
        model.explore();
        model
    }

    fn number(&mut self, facts: FactSet) -> u32 {
        if let Some(&number) = self.numbers.get(&facts) {
            return number;
        }
        let number = self.states.len() as u32;
        self.states.push(facts);
        self.numbers.insert(facts, number);
        self.services.push(vec![Known::Nothing; self.problem.directives.len()]);
        number
    }

    /// Reaches the states of the facts that the candidates' directives lead to.
    fn explore(&mut self) {
        let mut wanted: Vec<usize> = self.problem.candidates.iter().map(|c| c.directive).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let mut at = 0;
        while at < self.states.len() && self.states.len() <= FACTS_EXPLORED {
            for &directive in &wanted {
                self.service(at as u32, directive);
            }
            at += 1;
        }
        self.explored = at == self.states.len();
    }

    fn service(&mut self, facts: u32, directive: usize) -> Option<Service> {
        let known = self.services[facts as usize][directive];
        if known != Known::Nothing {
            return known.service();
        }
        let state = self.states[facts as usize];
        let wanted = &self.problem.directives[directive];
        let domain = self.problem.domain;
        let expansion = state
            .contains(wanted.requires)
            .then(|| domain.expand(state, wanted.achieves))
            .flatten();
        let service = expansion.map(|expansion| {
            let time = |operator: usize| domain.operators()[operator].cost.time_s;
            let before_s = expansion.before.iter().map(|&o| time(o)).sum::<f64>();
            Service {
                facts: self.number(expansion.facts),
                cost: expansion.cost,
                before_s: before_s + time(domain.drive()),
            }
        });
        let known = service.map_or(Known::Impossible, Known::Possible);
        self.services[facts as usize][directive] = known;
        service
    }

    /// The least time, energy and data (each on its own) that a candidate's operators and place cost in any state of
    /// the facts that can be reached, and the least time before the arrival; none if no state allows it.
    pub(crate) fn cheapest_service(&self, candidate: &Candidate) -> Option<(ServiceCost, f64)> {
        let here = candidate.service;
        if !self.explored {
            return Some((here, 0.0));
        }
        let known = self.services.iter().filter_map(|of| of[candidate.directive].service());
        let least = known.map(|s| (s.cost, s.before_s)).reduce(|(a, before_a), (b, before_b)| {
            let cost = ServiceCost {
                time_s: a.time_s.min(b.time_s),
                energy_j: a.energy_j.min(b.energy_j),
                data_mb: a.data_mb.min(b.data_mb),
            };
            (cost, before_a.min(before_b))
        });
        least.map(|(mut cost, before_s)| {
            cost += here;
            (cost, before_s)
        })
    }

    /// What the service of each candidate costs, if neither that nor whether it is possible depends on what was done
    /// before.
    pub(crate) fn steady_services(&self) -> Option<Vec<Option<ServiceCost>>> {
        if !self.explored {
            return None;
        }
        let steady = |candidate: &Candidate| {
            let mut all = self
                .services
                .iter()
                .map(|of| of[candidate.directive].service().map(|s| (s.cost, s.before_s)));
            let first = all.next().flatten();
            all.all(|other| other == first).then(|| {
                first.map(|(mut cost, _)| {
                    cost += candidate.service;
                    cost
                })
            })
        };
        self.problem.candidates.iter().map(steady).collect()
    }

    /// What sums of prizes can be, where the gain is such a sum and nothing is charged.
    pub(crate) fn ladder(&self) -> Option<Ladder> {
        let sums = self.objective.gains() == Gains::Prize && self.prices == Prices::NONE;
        sums.then(|| Ladder::of(self.problem.candidates.iter().map(|c| c.prize))).flatten()
    }

    /// What a candidate costs where these facts hold; none if they do not allow it.
    pub(crate) fn cost_in(&mut self, facts: u32, candidate: usize) -> Option<ServiceCost> {
        let wanted = &self.problem.candidates[candidate];
        let service = self.service(facts, wanted.directive)?;
        let mut cost = service.cost;
        cost += wanted.service;
        Some(cost)
    }

    /// What candidates cost at their turns of an order, if the facts allow it.
    pub(crate) fn services_in(&mut self, turns: &[usize]) -> Option<Vec<ServiceCost>> {
        let mut facts = 0;
        let mut services = Vec::new();
        for &turn in turns {
            let candidate = &self.problem.candidates[turn];
            let service = self.service(facts, candidate.directive)?;
            facts = service.facts;
            let mut cost = service.cost;
            cost += candidate.service;
            services.push(cost);
        }
        Some(services)
    }

    /// Time that a candidate's operators take before the rover arrives, in the facts that hold now.
    pub(crate) fn before_s(&mut self, candidate: usize) -> f64 {
        let directive = self.problem.candidates[candidate].directive;
        self.service(0, directive).map_or(0.0, |s| s.before_s)
    }

    /// Before the first goal.
    pub(crate) fn start() -> Standing {
        Standing {
            facts: 0,
            node: 0,
            time_s: 0.0,
            energy_j: 0.0,
            data_mb: 0.0,
            neg_ln_r: 0.0,
            reliability: 1.0,
            gain: 0.0,
        }
    }

    /// A prefix with one more goal, if facts, window and limits allow it.
    pub(crate) fn serve(
        &mut self,
        at: &Standing,
        candidate: usize,
        node: usize,
        leg: &CostVector,
    ) -> Option<Standing> {
        let wanted = &self.problem.candidates[candidate];
        let service = self.service(at.facts, wanted.directive)?;
        let mut cost = service.cost;
        if wanted.service != ServiceCost::default() {
            cost += wanted.service;
        }
        let mut time_s = at.time_s + leg.time_s + cost.time_s;
        let mut energy_j = at.energy_j + leg.energy_j + cost.energy_j;
        if let Some(window) = wanted.window {
            let arrival_s = at.time_s + leg.time_s + service.before_s;
            if arrival_s.max(window.open_s) > window.close_s {
                return None;
            }
            if arrival_s < window.open_s {
                energy_j += self.problem.waiting_w * (window.open_s - arrival_s);
                time_s = window.open_s + (cost.time_s - service.before_s);
            }
        }
        let data_mb = at.data_mb + cost.data_mb;
        let limits = &self.problem.limits;
        if !(time_s <= limits.time_s && energy_j <= limits.energy_j && data_mb <= limits.data_mb) {
            return None;
        }
        let neg_ln_r = at.neg_ln_r + leg.neg_ln_r;
        let reliability = if leg.neg_ln_r == 0.0 { at.reliability } else { libm::exp(-neg_ln_r) };
        if reliability < self.floor {
            return None;
        }
        let freshness = wanted.fade.map_or(1.0, |fade| fade.freshness(time_s));
        let served = Served { prize: wanted.prize, reliability, freshness };
        Some(Standing {
            facts: service.facts,
            node: node as u32,
            time_s,
            energy_j,
            data_mb,
            neg_ln_r,
            reliability,
            gain: at.gain + self.objective.gain(served),
        })
    }

    /// What the resources cost under the objective.
    pub(crate) fn charge(&self, time_s: f64, energy_j: f64, data_mb: f64, neg_ln_r: f64) -> f64 {
        let Prices { risk, energy_per_j, time_per_s, data_per_mb } = self.prices;
        risk * neg_ln_r + energy_per_j * energy_j + time_per_s * time_s + data_per_mb * data_mb
    }

    /// All ways to end a plan here that are within the limits.
    pub(crate) fn endings(&self, at: &Standing, mut visit: impl FnMut(Whole)) {
        let Problem { ends, travel, limits, .. } = self.problem;
        let ended = |time_s: f64, energy_j: f64, neg_ln_r: f64, reliability: f64, end| {
            let charge = self.charge(time_s, energy_j, at.data_mb, neg_ln_r);
            let value = self.objective.value(at.gain, charge, reliability);
            Whole { value, neg_ln_r, reliability, time_s, energy_j, end }
        };
        if ends.is_empty() {
            visit(ended(at.time_s, at.energy_j, at.neg_ln_r, at.reliability, None));
        }
        for &pose in ends {
            let legs = travel.alternatives(at.node as usize, pose);
            for (alternative, leg) in legs.iter().enumerate() {
                let time_s = at.time_s + leg.time_s;
                let energy_j = at.energy_j + leg.energy_j;
                let neg_ln_r = at.neg_ln_r + leg.neg_ln_r;
                let reliability =
                    if leg.neg_ln_r == 0.0 { at.reliability } else { libm::exp(-neg_ln_r) };
                let within = time_s <= limits.time_s && energy_j <= limits.energy_j;
                if within && reliability >= self.floor {
                    let end = Some(End { pose, alternative });
                    visit(ended(time_s, energy_j, neg_ln_r, reliability, end));
                }
            }
        }
    }

    /// The best way to end a plan here, if any is within the limits.
    pub(crate) fn whole(&self, at: &Standing) -> Option<Whole> {
        let mut best: Option<Whole> = None;
        self.endings(at, |way| {
            if best.is_none_or(|b| way.ranks_before(&b)) {
                best = Some(way);
            }
        });
        best
    }

    /// Doing nothing where no end can be reached: the last resort.
    pub(crate) fn stranded(&self) -> GoalSequence {
        let missed = self.problem.candidates.iter().filter(|c| c.mandatory).count();
        GoalSequence { missed, ..GoalSequence::empty() }
    }

    /// The sequence of these stops, ended in the best way, if it can be done.
    pub(crate) fn sequence(&mut self, stops: &[Call]) -> Option<GoalSequence> {
        self.sequence_to(stops, Self::whole)
    }

    /// The sequence of these stops, ended as wished.
    pub(crate) fn sequence_to(
        &mut self,
        stops: &[Call],
        end: impl FnOnce(&Self, &Standing) -> Option<Whole>,
    ) -> Option<GoalSequence> {
        let mut at = Self::start();
        let mut sequence = GoalSequence::empty();
        for &Call { candidate, node, alternative } in stops {
            let leg = *self.problem.travel.alternatives(at.node as usize, node).get(alternative)?;
            let next = self.serve(&at, candidate, node, &leg)?;
            let Candidate { goal, directive, prize, service, .. } =
                self.problem.candidates[candidate].clone();
            let facts = self.states[at.facts as usize];
            let achieves = self.problem.directives[directive].achieves;
            let expansion = self.problem.domain.expand(facts, achieves)?;
            let mut spent = expansion.cost;
            spent += service;
            let wait_s = (next.time_s - (at.time_s + leg.time_s + spent.time_s)).max(0.0);
            // What is lost in the rounding of sums is no waiting.
            let wait_s =
                if self.problem.candidates[candidate].window.is_some() { wait_s } else { 0.0 };
            spent.time_s += wait_s;
            spent.energy_j += self.problem.waiting_w * wait_s;
            sequence.prize += prize;
            let fade = self.problem.candidates[candidate].fade;
            sequence.fresh += prize * fade.map_or(1.0, |fade| fade.freshness(next.time_s));
            sequence.expected += prize * next.reliability;
            sequence.stops.push(Stop {
                goal,
                pose: node,
                alternative,
                expansion,
                wait_s,
                service: spent,
            });
            at = next;
        }
        let whole = end(self, &at)?;
        let done = |index: usize| stops.iter().any(|stop| stop.candidate == index);
        let mandatory = self.problem.candidates.iter().enumerate().filter(|(_, c)| c.mandatory);
        sequence.missed = mandatory.filter(|&(index, _)| !done(index)).count();
        sequence.end = whole.end;
        sequence.value = whole.value;
        sequence.reliability = whole.reliability;
        sequence.time_s = whole.time_s;
        sequence.energy_j = whole.energy_j;
        sequence.data_mb = at.data_mb;
        Some(sequence)
    }
}

impl Whole {
    /// What the plan costs, its length aside.
    pub(crate) fn cost(&self) -> CostVector {
        let Self { neg_ln_r, time_s, energy_j, .. } = *self;
        CostVector { length_m: 0.0, time_s, energy_j, neg_ln_r }
    }

    /// Whether this is the better way for the same goals.
    pub(crate) fn ranks_before(&self, other: &Self) -> bool {
        let key = |w: &Self| (w.value, w.reliability, -w.time_s);
        key(self) > key(other)
    }
}
