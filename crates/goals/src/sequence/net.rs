//! Costs between visits, laid out for the improver: one alternative a leg, one number a resource.

use super::model::Model;
use crate::ServiceCost;
use crate::objective::Gains;

/// One pose of one goal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Visit {
    pub candidate: u32,
    /// The pose, as a node of the travel matrix.
    pub node: u32,
    pub prize: f64,
    /// What its service costs, where that does not depend on what came before.
    pub service: ServiceCost,
    /// The part of the service's time that passes before the arrival.
    pub lead_s: f64,
    /// When work may begin.
    pub open_s: f64,
    pub close_s: f64,
}

/// How an insertion is weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// Costs add up and gains are prizes: by the detour alone.
    Plain,
    /// Costs add up and gains are prizes times the chance of getting there: by the detour and what it takes from the
    /// chances of what follows.
    Chance,
    /// As plain, with windows: by the detour and the latest beginnings of what follows.
    Windows,
    /// Services hang on the facts: by the detour first, as if what follows cost what it did, then by walking through it.
    Facts,
    /// By walking through all that follows.
    Walk,
}

/// Visits and the legs between them. Row 0 is the start, row `v + 1` leaves visit `v`; column `v` leads to visit `v`,
/// the last column to the end.
pub(super) struct Net {
    pub visits: Vec<Visit>,
    /// Visits of each candidate: its poses.
    pub poses_of: Vec<std::ops::Range<u32>>,
    pub mode: Mode,
    /// Whether energy and −ln R are limited or priced; time always counts.
    pub energy_counts: bool,
    pub risk_counts: bool,
    pub time: Vec<f64>,
    pub energy: Vec<f64>,
    pub risk: Vec<f64>,
    /// Whether gains are prizes times the chance of getting there.
    pub chances: bool,
    /// Reliability of each leg; only where it counts.
    pub safe: Vec<f64>,
    /// Alternative of each leg; empty where there is but one.
    alternative: Vec<u8>,
    /// Share of the budgets that each leg uses, the largest that counts.
    pub weight: Vec<f64>,
    /// Share of the budgets in a second.
    pub per_second: f64,
    /// For each visit the rows nearest to it, nearest first.
    pub near: Vec<Vec<u32>>,
    columns: usize,
}

/// A cost that forbids a leg.
pub(super) const NO_WAY: f64 = 1e300;

impl Net {
    /// The net of a model. Of the alternatives of a leg the one that uses least of the budgets is taken; the others come in
    /// when a finished order is weighed.
    pub(super) fn new(model: &mut Model<'_>) -> Self {
        /// Rows that a visit may be inserted beside; more are never looked through.
        const NEIGHBOURS: usize = 80;
        let problem = model.problem;
        let limits = problem.limits;
        let steady = model.steady_services();
        let mut visits = Vec::new();
        let mut poses_of = Vec::new();
        for (index, candidate) in problem.candidates.iter().enumerate() {
            let first = visits.len() as u32;
            let service = match &steady {
                Some(services) => services[index],
                None => Some(candidate.service),
            };
            let lead_s = model.before_s(index);
            let window = candidate.window;
            for &node in &candidate.poses {
                if let Some(service) = service.filter(|_| !model.orphaned[index]) {
                    visits.push(Visit {
                        candidate: index as u32,
                        node: node as u32,
                        prize: candidate.prize,
                        service,
                        lead_s,
                        open_s: window.map_or(f64::NEG_INFINITY, |w| w.open_s),
                        close_s: window.map_or(f64::INFINITY, |w| w.close_s),
                    });
                }
            }
            poses_of.push(first..visits.len() as u32);
        }
        let windows = problem.candidates.iter().any(|c| c.window.is_some());
        let prices = model.prices;
        let energy_counts = limits.energy_j < f64::INFINITY || prices.energy_per_j > 0.0;
        let waiting_counts = windows && problem.waiting_w > 0.0 && energy_counts;
        let risky = model.floor > 0.0 || prices.risk > 0.0 || !problem.ends.is_empty();
        let mut net = Self {
            columns: visits.len() + 1,
            visits,
            poses_of,
            mode: Mode::Walk,
            energy_counts,
            risk_counts: true,
            time: Vec::new(),
            energy: Vec::new(),
            risk: Vec::new(),
            safe: Vec::new(),
            chances: false,
            alternative: Vec::new(),
            weight: Vec::new(),
            per_second: 0.0,
            near: Vec::new(),
        };
        net.lay_out(model);
        let safe = net.risk.iter().all(|&risk| risk == 0.0 || risk >= NO_WAY);
        let value_is_gain = model.objective.value(1.0, 0.0, 0.5) == 1.0;
        net.risk_counts = !safe && (risky || !value_is_gain);
        // Without risk every gain that depends on reliability alone is the prize.
        let fades = problem.candidates.iter().any(|c| c.fade.is_some());
        let gains = model.objective.gains();
        let prizes = gains == Gains::Prize || (safe && !fades);
        net.chances = !prizes && gains == Gains::Chance;
        if net.risk_counts || net.chances {
            net.safe = net.risk.iter().map(|&risk| libm::exp(-risk)).collect();
        }
        net.mode = match (&steady, windows) {
            (Some(_), false) if net.chances => Mode::Chance,
            (Some(_), false) if prizes => Mode::Plain,
            (Some(_), true) if prizes && !waiting_counts => Mode::Windows,
            (None, false) if prizes || net.chances => Mode::Facts,
            _ => Mode::Walk,
        };
        net.near = (0..net.visits.len()).map(|visit| net.nearest(visit, NEIGHBOURS)).collect();
        net
    }

    /// Chooses one alternative for each leg and notes its costs.
    fn lay_out(&mut self, model: &Model<'_>) {
        let problem = model.problem;
        let limits = problem.limits;
        let max_risk = if model.floor > 0.0 { -libm::log(model.floor) } else { 1.0 };
        let share =
            |limit: f64| if limit > 0.0 && limit < f64::INFINITY { 1.0 / limit } else { 0.0 };
        let mut per = [share(limits.time_s), share(limits.energy_j), share(max_risk.max(1e-6))];
        if per[0] == 0.0 && per[1] == 0.0 {
            // Nothing is short: seconds will do.
            per[0] = 1e-6;
        }
        let weigh = |cost: &wisdom_planner::CostVector| {
            per[0] * cost.time_s + per[1] * cost.energy_j + per[2] * cost.neg_ln_r
        };
        self.per_second = per[0];
        let service = |service: &ServiceCost| {
            let data = if limits.data_mb > 0.0 && limits.data_mb < f64::INFINITY {
                service.data_mb / limits.data_mb
            } else {
                0.0
            };
            per[0] * service.time_s + per[1] * service.energy_j + data
        };
        let several = problem.travel.has_alternatives() || problem.ends.len() > 1;
        let nodes = std::iter::once(0).chain(self.visits.iter().map(|v| v.node as usize));
        for from in nodes {
            for column in 0..self.columns {
                let one;
                let targets: &[usize] = match self.visits.get(column) {
                    Some(visit) => {
                        one = [visit.node as usize];
                        &one
                    }
                    None => problem.ends,
                };
                let mut best: Option<(f64, u8, wisdom_planner::CostVector)> = None;
                for &to in targets {
                    for (alternative, leg) in
                        problem.travel.alternatives(from, to).iter().enumerate()
                    {
                        let weight = weigh(leg);
                        if best.is_none_or(|(least, ..)| weight < least) {
                            best = Some((weight, alternative.min(255) as u8, *leg));
                        }
                    }
                }
                if best.is_none() && self.visits.get(column).is_none() && problem.ends.is_empty() {
                    best = Some((0.0, 0, wisdom_planner::CostVector::ZERO));
                }
                let (weight, alternative, leg) = best.unwrap_or((
                    NO_WAY,
                    0,
                    wisdom_planner::CostVector {
                        length_m: 0.0,
                        time_s: NO_WAY,
                        energy_j: NO_WAY,
                        neg_ln_r: NO_WAY,
                    },
                ));
                self.time.push(leg.time_s);
                self.energy.push(leg.energy_j);
                self.risk.push(leg.neg_ln_r);
                let work = self.visits.get(column).map_or(0.0, |visit| service(&visit.service));
                self.weight.push(weight + work);
                if several {
                    self.alternative.push(alternative);
                }
            }
        }
    }

    fn nearest(&self, visit: usize, most: usize) -> Vec<u32> {
        let mine = self.visits[visit].candidate;
        let apart = |row: u32| {
            let there = self.weight[self.leg(row, visit)];
            if row == 0 {
                there
            } else {
                there.min(self.weight[self.leg(visit as u32 + 1, row as usize - 1)])
            }
        };
        let mut rows: Vec<u32> = (0..=self.visits.len() as u32)
            .filter(|&row| row == 0 || self.visits[row as usize - 1].candidate != mine)
            .collect();
        rows.sort_by(|&a, &b| apart(a).total_cmp(&apart(b)).then(a.cmp(&b)));
        rows.truncate(most);
        rows
    }

    /// Where a leg's costs stand.
    pub(super) fn leg(&self, row: u32, column: usize) -> usize {
        row as usize * self.columns + column
    }

    /// The column of the end.
    pub(super) fn end(&self) -> usize {
        self.columns - 1
    }

    pub(super) fn alternative(&self, leg: usize) -> usize {
        self.alternative.get(leg).map_or(0, |&a| usize::from(a))
    }
}
