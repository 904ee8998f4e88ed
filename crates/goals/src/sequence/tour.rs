//! A sequence while it is being improved.

use wisdom_planner::CostVector;

use super::model::{Call, Model, Standing};
use super::net::{Mode, NO_WAY, Net};

/// A sequence as rows of a [`Net`], with what it costs. Index 0 of the route is the start.
#[derive(Debug, Clone)]
pub(super) struct Tour {
    pub route: Vec<u32>,
    /// Index in the route of each visit; 0 if it is not there.
    pub place: Vec<u32>,
    /// Whether each candidate is served.
    pub held: Vec<bool>,
    /// How many goals of the route each candidate may not stand beside.
    pub barred: Vec<u16>,
    pub time_s: f64,
    pub energy_j: f64,
    pub data_mb: f64,
    pub neg_ln_r: f64,
    pub reliability: f64,
    pub gain: f64,
    pub value: f64,
    pub missed: u32,
    /// Share of the budgets used.
    pub weight: f64,
    /// When each stop is left, and the latest beginning of its work that lets the rest be in time (with windows).
    finish: Vec<f64>,
    latest: Vec<f64>,
    /// The chance of getting to each stop, and the gain up to it (where chances are weighed).
    chance: Vec<f64>,
    gained: Vec<f64>,
    /// The prefix up to each stop (where insertions are weighed by walking).
    prefix: Vec<Standing>,
}

/// What an insertion changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    /// Of the value.
    pub value: f64,
    /// Of the share of the budgets used.
    pub weight: f64,
}

impl Tour {
    pub(super) fn empty(model: &mut Model<'_>, net: &Net) -> Self {
        let candidates = model.problem.candidates.len();
        let mut tour = Self {
            route: vec![0],
            place: vec![0; net.visits.len()],
            held: vec![false; candidates],
            barred: vec![0; candidates],
            time_s: 0.0,
            energy_j: 0.0,
            data_mb: 0.0,
            neg_ln_r: 0.0,
            reliability: 1.0,
            gain: 0.0,
            value: 0.0,
            missed: 0,
            weight: 0.0,
            finish: Vec::new(),
            latest: Vec::new(),
            chance: Vec::new(),
            gained: Vec::new(),
            prefix: Vec::new(),
        };
        tour.settle(model, net);
        tour
    }

    /// Becomes a copy of another, keeping its memory.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.route.clone_from(&other.route);
        self.place.clone_from(&other.place);
        self.held.clone_from(&other.held);
        self.barred.clone_from(&other.barred);
        self.finish.clone_from(&other.finish);
        self.latest.clone_from(&other.latest);
        self.chance.clone_from(&other.chance);
        self.gained.clone_from(&other.gained);
        self.prefix.clone_from(&other.prefix);
        let Self {
            time_s,
            energy_j,
            data_mb,
            neg_ln_r,
            reliability,
            gain,
            value,
            missed,
            weight,
            ..
        } = *other;
        (self.time_s, self.energy_j, self.data_mb, self.neg_ln_r) =
            (time_s, energy_j, data_mb, neg_ln_r);
        (self.reliability, self.gain, self.value, self.missed) = (reliability, gain, value, missed);
        self.weight = weight;
    }

    pub(super) fn len(&self) -> usize {
        self.route.len() - 1
    }

    /// Whether the first ranks before the second.
    pub(super) fn beats(&self, other: &Self) -> bool {
        let key = |t: &Self| (-f64::from(t.missed), t.value, t.reliability, -t.time_s);
        key(self) > key(other)
    }

    /// The column that follows an index of the route.
    pub(super) fn after(&self, net: &Net, index: usize) -> usize {
        self.route.get(index + 1).map_or(net.end(), |&row| row as usize - 1)
    }

    /// The stops, for the model.
    pub(super) fn calls(&self, net: &Net) -> Vec<Call> {
        let legs = self.route.windows(2).map(|pair| {
            let visit = net.visits[pair[1] as usize - 1];
            let alternative = net.alternative(net.leg(pair[0], pair[1] as usize - 1));
            Call { candidate: visit.candidate as usize, node: visit.node as usize, alternative }
        });
        legs.collect()
    }

    /// Whether a visit may be added at all.
    pub(super) fn may_hold(&self, model: &Model<'_>, net: &Net, visit: usize) -> bool {
        let candidate = net.visits[visit].candidate as usize;
        !self.held[candidate]
            && self.barred[candidate] == 0
            && model.after[candidate].iter().all(|&before| self.held[before])
    }

    /// The first index of the route after which precedence lets a candidate come.
    pub(super) fn earliest(&self, model: &Model<'_>, net: &Net, candidate: usize) -> usize {
        let index_of = |before: usize| {
            net.poses_of[before].clone().map(|visit| self.place[visit as usize] as usize).max()
        };
        model.after[candidate].iter().filter_map(|&before| index_of(before)).max().unwrap_or(0)
    }

    /// Whether a stop at this index is left too late for any further one to be begun by then.
    pub(super) fn left_after(&self, net: &Net, index: usize, close_s: f64) -> bool {
        net.mode == Mode::Windows && self.finish[index] > close_s
    }

    /// The legs to a visit after an index of the route and on from there, and the one that is driven instead.
    fn legs(&self, net: &Net, visit: usize, index: usize) -> (usize, usize, usize) {
        let (row, next) = (self.route[index], self.after(net, index));
        (net.leg(row, visit), net.leg(visit as u32 + 1, next), net.leg(row, next))
    }

    /// What adding a visit after an index of the route would change, if it can be done there.
    pub(super) fn weigh(
        &self,
        model: &mut Model<'_>,
        net: &Net,
        visit: usize,
        index: usize,
    ) -> Option<Change> {
        let (there, back, instead) = self.legs(net, visit, index);
        if net.time[instead] >= NO_WAY {
            return self.reach_the_end(model, net, visit, index);
        }
        let mut weight = net.weight[there] + net.weight[back] - net.weight[instead];
        if weight >= NO_WAY / 2.0 {
            return None;
        }
        if net.mode == Mode::Walk {
            return self.walk(model, net, visit, index).map(|value| Change { value, weight });
        }
        let goal = &net.visits[visit];
        let service = match net.mode {
            Mode::Facts => model.cost_in(self.prefix[index].facts, goal.candidate as usize)?,
            _ => goal.service,
        };
        let limits = &model.problem.limits;
        let detour = |of: &[f64]| of[there] + of[back] - of[instead];
        let time_s = self.time_s + detour(&net.time) + service.time_s;
        if net.mode == Mode::Windows {
            let begin = (self.finish[index] + net.time[there] + goal.lead_s).max(goal.open_s);
            if begin > goal.close_s {
                return None;
            }
            let arrival = begin + (goal.service.time_s - goal.lead_s) + net.time[back];
            let late = match self.route.get(index + 1) {
                Some(&row) => {
                    arrival + net.visits[row as usize - 1].lead_s > self.latest[index + 1]
                }
                None => arrival > limits.time_s,
            };
            if late {
                return None;
            }
            // What follows is put off by the waiting, too.
            weight = (arrival - self.finish[index] - net.time[instead]) * net.per_second;
        } else if time_s > limits.time_s {
            return None;
        }
        let data_mb = self.data_mb + service.data_mb;
        if data_mb > limits.data_mb {
            return None;
        }
        let mut energy_j = self.energy_j;
        if net.energy_counts {
            energy_j += detour(&net.energy) + service.energy_j;
            if energy_j > limits.energy_j {
                return None;
            }
        }
        let (mut neg_ln_r, mut reliability) = (self.neg_ln_r, self.reliability);
        if net.risk_counts {
            neg_ln_r += detour(&net.risk);
            reliability *=
                net.safe[there] * net.safe[back] / net.safe[instead].max(f64::MIN_POSITIVE);
            if reliability < model.floor {
                return None;
            }
        }
        let mut gain = self.gain + goal.prize;
        if net.chances {
            let (chance, gained) = match net.mode {
                Mode::Facts => (self.prefix[index].reliability, self.prefix[index].gain),
                _ => (self.chance[index], self.gained[index]),
            };
            let rest = self.gain - gained;
            let mut later = 0.0;
            if rest > 0.0 {
                later = rest * net.safe[there] * net.safe[back] / net.safe[instead];
            }
            gain = gained + goal.prize * chance * net.safe[there] + later;
        }
        let charge = model.charge(time_s, energy_j, data_mb, neg_ln_r);
        let value = model.objective.value(gain, charge, reliability) - self.value;
        Some(Change { value, weight })
    }

    /// What a visit changes where no plan can end yet: there is nothing to take the difference to.
    fn reach_the_end(
        &self,
        model: &mut Model<'_>,
        net: &Net,
        visit: usize,
        index: usize,
    ) -> Option<Change> {
        let mut with = self.clone();
        with.route.insert(index + 1, visit as u32 + 1);
        with.settle(model, net);
        let ends = with.len() == self.len() + 1 && with.value > f64::NEG_INFINITY;
        ends.then(|| Change { value: with.value.abs().max(1.0), weight: with.weight })
    }

    /// The same, but where [`Tour::weigh`] takes it that what follows costs what it did, by walking through it.
    pub(super) fn weigh_surely(
        &self,
        model: &mut Model<'_>,
        net: &Net,
        visit: usize,
        index: usize,
    ) -> Option<f64> {
        let (_, _, instead) = self.legs(net, visit, index);
        match net.mode {
            Mode::Facts if net.time[instead] < NO_WAY => self.walk(model, net, visit, index),
            _ => self.weigh(model, net, visit, index).map(|change| change.value),
        }
    }

    /// The change of value, found by serving everything that follows anew.
    fn walk(&self, model: &mut Model<'_>, net: &Net, visit: usize, index: usize) -> Option<f64> {
        let mut at = serve(model, net, &self.prefix[index], self.route[index], visit)?;
        let mut row = visit as u32 + 1;
        for &next in &self.route[index + 1..] {
            at = serve(model, net, &at, row, next as usize - 1)?;
            row = next;
        }
        let whole = model.whole(&at)?;
        Some(whole.value - self.value)
    }

    /// Puts a visit after an index of the route and works out what it all costs now.
    pub(super) fn insert(&mut self, model: &mut Model<'_>, net: &Net, visit: usize, index: usize) {
        let (there, back, instead) = self.legs(net, visit, index);
        let unended = net.time[instead] >= NO_WAY;
        if net.mode != Mode::Plain || unended {
            self.route.insert(index + 1, visit as u32 + 1);
            self.settle(model, net);
            return;
        }
        // Sums are kept up here, and made anew before the route is believed to be the best.
        let goal = &net.visits[visit];
        let detour = |of: &[f64]| of[there] + of[back] - of[instead];
        self.time_s += detour(&net.time) + goal.service.time_s;
        self.data_mb += goal.service.data_mb;
        if net.energy_counts {
            self.energy_j += detour(&net.energy) + goal.service.energy_j;
        }
        if net.risk_counts {
            self.neg_ln_r += detour(&net.risk);
            self.reliability = libm::exp(-self.neg_ln_r);
        }
        self.gain += goal.prize;
        self.weight += detour(&net.weight);
        let charge = model.charge(self.time_s, self.energy_j, self.data_mb, self.neg_ln_r);
        self.value = model.objective.value(self.gain, charge, self.reliability);
        self.route.insert(index + 1, visit as u32 + 1);
        for index in index + 1..self.route.len() {
            self.place[self.route[index] as usize - 1] = index as u32;
        }
        let candidate = goal.candidate as usize;
        self.held[candidate] = true;
        self.missed -= u32::from(model.problem.candidates[candidate].mandatory);
        for &other in &model.excludes[candidate] {
            self.barred[other] += 1;
        }
    }

    /// Works out from the route alone what everything costs, leaving out what cannot be done.
    pub(super) fn settle(&mut self, model: &mut Model<'_>, net: &Net) {
        loop {
            let kept = match net.mode {
                Mode::Walk | Mode::Facts => self.settle_walking(model, net),
                Mode::Plain | Mode::Chance | Mode::Windows => self.settle_adding(model, net),
            };
            // Where the end is out of reach, the last stop goes.
            if kept || self.route.len() == 1 {
                break;
            }
            self.route.pop();
        }
        let candidates = model.problem.candidates;
        self.place.fill(0);
        self.held.fill(false);
        self.barred.fill(0);
        let mut mandatory = 0;
        for (index, &row) in self.route.iter().enumerate().skip(1) {
            let visit = row as usize - 1;
            let candidate = net.visits[visit].candidate as usize;
            self.place[visit] = index as u32;
            self.held[candidate] = true;
            mandatory += u32::from(candidates[candidate].mandatory);
            for &other in &model.excludes[candidate] {
                self.barred[other] += 1;
            }
        }
        let all = candidates.iter().filter(|c| c.mandatory).count() as u32;
        self.missed = all - mandatory;
        self.weight = net.weight[net.leg(self.route[self.len()], net.end())];
        for pair in self.route.windows(2) {
            self.weight += net.weight[net.leg(pair[0], pair[1] as usize - 1)];
        }
    }

    /// Takes out the stops marked by their index in the route.
    pub(super) fn remove(&mut self, model: &mut Model<'_>, net: &Net, gone: &[bool]) {
        if net.mode != Mode::Plain || !model.after.iter().all(Vec::is_empty) {
            let mut index = 0;
            self.route.retain(|_| {
                index += 1;
                !gone[index - 1]
            });
            self.settle(model, net);
            return;
        }
        let mut skipped = false;
        for (&row, _) in self.route.iter().zip(gone).filter(|(_, gone)| **gone) {
            skipped = true;
            let visit = row as usize - 1;
            let goal = &net.visits[visit];
            let candidate = goal.candidate as usize;
            self.place[visit] = 0;
            self.held[candidate] = false;
            self.missed += u32::from(model.problem.candidates[candidate].mandatory);
            for &other in &model.excludes[candidate] {
                self.barred[other] -= 1;
            }
            self.gain -= goal.prize;
            self.time_s -= goal.service.time_s;
            self.data_mb -= goal.service.data_mb;
            if net.energy_counts {
                self.energy_j -= goal.service.energy_j;
            }
        }
        if !skipped {
            return;
        }
        // Legs: what is no longer driven goes, what is driven instead comes.
        let end = net.end();
        let mut last = 0;
        for (index, gone) in gone.iter().copied().chain([false]).enumerate().skip(1) {
            let column = self.route.get(index).map_or(end, |&row| row as usize - 1);
            let stays = !gone;
            let old = net.leg(self.route[index - 1], column);
            if stays && last == index - 1 {
                last = index;
            } else {
                self.swap_leg(net, old, -1.0);
                if stays {
                    let new = net.leg(self.route[last], column);
                    self.swap_leg(net, new, 1.0);
                    last = index;
                }
            }
        }
        let mut marks = gone.iter();
        self.route.retain(|_| !marks.next().copied().unwrap_or(false));
        for (index, &row) in self.route.iter().enumerate().skip(1) {
            self.place[row as usize - 1] = index as u32;
        }
        if net.risk_counts {
            self.reliability = libm::exp(-self.neg_ln_r);
        }
        let charge = model.charge(self.time_s, self.energy_j, self.data_mb, self.neg_ln_r);
        self.value = model.objective.value(self.gain, charge, self.reliability);
        let limits = &model.problem.limits;
        let within = self.time_s <= limits.time_s
            && self.energy_j <= limits.energy_j
            && self.reliability >= model.floor;
        if !within {
            // Without the triangle inequality fewer stops may cost more.
            self.settle(model, net);
        }
    }

    fn swap_leg(&mut self, net: &Net, leg: usize, sign: f64) {
        self.time_s += sign * net.time[leg];
        self.weight += sign * net.weight[leg];
        if net.energy_counts {
            self.energy_j += sign * net.energy[leg];
        }
        if net.risk_counts {
            self.neg_ln_r += sign * net.risk[leg];
        }
    }

    fn settle_adding(&mut self, model: &Model<'_>, net: &Net) -> bool {
        let limits = &model.problem.limits;
        let windows = net.mode == Mode::Windows;
        let (mut time_s, mut energy_j, mut data_mb, mut neg_ln_r, mut gain) =
            (0.0, 0.0, 0.0, 0.0, 0.0);
        let chances = net.chances;
        self.finish.clear();
        self.finish.push(0.0);
        if chances {
            self.chance.clear();
            self.chance.push(1.0);
            self.gained.clear();
            self.gained.push(0.0);
        }
        let mut kept = 1;
        for index in 1..self.route.len() {
            let row = self.route[kept - 1];
            let visit = self.route[index] as usize - 1;
            let goal = &net.visits[visit];
            let leg = net.leg(row, visit);
            if net.time[leg] >= NO_WAY {
                continue;
            }
            let mut next_s = time_s + net.time[leg] + goal.service.time_s;
            if windows {
                let arrival_s = time_s + net.time[leg] + goal.lead_s;
                if arrival_s.max(goal.open_s) > goal.close_s {
                    continue;
                }
                if arrival_s < goal.open_s {
                    next_s = goal.open_s + (goal.service.time_s - goal.lead_s);
                }
            }
            let next_j = energy_j + net.energy[leg] + goal.service.energy_j;
            let next_mb = data_mb + goal.service.data_mb;
            let within =
                next_s <= limits.time_s && next_j <= limits.energy_j && next_mb <= limits.data_mb;
            if !within || !self.precedence_holds(model, net, kept, goal.candidate as usize) {
                continue;
            }
            (time_s, energy_j, data_mb) = (next_s, next_j, next_mb);
            neg_ln_r += net.risk[leg];
            if chances {
                let chance = self.chance[kept - 1] * net.safe[leg];
                gain += goal.prize * chance;
                self.chance.push(chance);
                self.gained.push(gain);
            } else {
                gain += goal.prize;
            }
            self.route[kept] = self.route[index];
            kept += 1;
            self.finish.push(time_s);
        }
        self.route.truncate(kept);
        let home = net.leg(self.route[kept - 1], net.end());
        time_s += net.time[home];
        energy_j += net.energy[home];
        neg_ln_r += net.risk[home];
        let reliability = if net.risk_counts { libm::exp(-neg_ln_r) } else { 1.0 };
        let within = net.time[home] < NO_WAY
            && time_s <= limits.time_s
            && energy_j <= limits.energy_j
            && reliability >= model.floor;
        if windows {
            self.latest.resize(kept, 0.0);
            self.latest.truncate(kept);
            let mut latest = limits.time_s - net.time[home];
            for index in (1..kept).rev() {
                let goal = &net.visits[self.route[index] as usize - 1];
                let begin = (latest - (goal.service.time_s - goal.lead_s)).min(goal.close_s);
                self.latest[index] = begin;
                let leg = net.leg(self.route[index - 1], self.route[index] as usize - 1);
                latest = begin - goal.lead_s - net.time[leg];
            }
        }
        let charge = model.charge(time_s, energy_j, data_mb, neg_ln_r);
        (self.time_s, self.energy_j, self.data_mb, self.neg_ln_r) =
            (time_s, energy_j, data_mb, neg_ln_r);
        (self.reliability, self.gain) = (reliability, gain);
        self.value = if within {
            model.objective.value(gain, charge, reliability)
        } else {
            f64::NEG_INFINITY
        };
        within
    }

    fn settle_walking(&mut self, model: &mut Model<'_>, net: &Net) -> bool {
        self.prefix.clear();
        self.prefix.push(Model::start());
        let mut kept = 1;
        for index in 1..self.route.len() {
            let visit = self.route[index] as usize - 1;
            let candidate = net.visits[visit].candidate as usize;
            if !self.precedence_holds(model, net, kept, candidate) {
                continue;
            }
            let next = serve(model, net, &self.prefix[kept - 1], self.route[kept - 1], visit);
            let Some(next) = next else { continue };
            self.prefix.push(next);
            self.route[kept] = self.route[index];
            kept += 1;
        }
        self.route.truncate(kept);
        let at = self.prefix[kept - 1];
        let whole = model.whole(&at);
        let whole_or = whole.map_or(
            (f64::NEG_INFINITY, at.time_s, at.energy_j, at.neg_ln_r, at.reliability),
            |w| (w.value, w.time_s, w.energy_j, w.neg_ln_r, w.reliability),
        );
        (self.value, self.time_s, self.energy_j, self.neg_ln_r, self.reliability) = whole_or;
        (self.data_mb, self.gain) = (at.data_mb, at.gain);
        whole.is_some()
    }

    fn precedence_holds(
        &self,
        model: &Model<'_>,
        net: &Net,
        kept: usize,
        candidate: usize,
    ) -> bool {
        let after = &model.after[candidate];
        after.is_empty()
            || after.iter().all(|&before| {
                let is_it = |&row: &u32| net.visits[row as usize - 1].candidate as usize == before;
                self.route[1..kept].iter().any(is_it)
            })
    }
}

/// A prefix with one more visit.
fn serve(
    model: &mut Model<'_>,
    net: &Net,
    at: &Standing,
    row: u32,
    visit: usize,
) -> Option<Standing> {
    let leg = net.leg(row, visit);
    if net.time[leg] >= NO_WAY {
        return None;
    }
    let cost = CostVector {
        length_m: 0.0,
        time_s: net.time[leg],
        energy_j: net.energy[leg],
        neg_ln_r: net.risk[leg],
    };
    let goal = &net.visits[visit];
    model.serve(at, goal.candidate as usize, goal.node as usize, &cost)
}
