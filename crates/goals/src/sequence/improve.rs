//! Large-neighbourhood search: take some stops out, put others in, keep what is better and now and then what is not
//! (Shaw 1998; string removal and acceptance after Christiaens and Vanden Berghe 2020).

use super::model::{Call, Model};
use super::net::{Mode, Net};
use super::tour::Tour;

/// The best sequences of different sets met, best first.
pub(super) struct Kept {
    most: usize,
    tours: Vec<(Vec<u32>, Tour, Vec<Call>)>,
}

impl Kept {
    fn new(most: usize) -> Self {
        Self { most: most.max(1), tours: Vec::new() }
    }

    /// Whether a tour is not worse than all that are kept.
    fn wants(&self, tour: &Tour) -> bool {
        let full = self.tours.len() >= self.most;
        self.most > 1 && self.tours.last().is_none_or(|(_, worst, _)| !full || tour.beats(worst))
    }

    fn take(&mut self, net: &Net, tour: &Tour) {
        let last = self.tours.last().filter(|_| self.tours.len() >= self.most);
        if last.is_some_and(|(_, worst, _)| !tour.beats(worst)) {
            return;
        }
        let mut set: Vec<u32> =
            tour.route[1..].iter().map(|&row| net.visits[row as usize - 1].candidate).collect();
        set.sort_unstable();
        if let Some(same) = self.tours.iter().position(|(other, ..)| *other == set) {
            if !tour.beats(&self.tours[same].1) {
                return;
            }
            self.tours.remove(same);
        }
        let at = self.tours.partition_point(|(_, other, _)| !tour.beats(other));
        self.tours.insert(at, (set, tour.clone(), tour.calls(net)));
        self.tours.truncate(self.most);
    }
}

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From 0 to `count` − 1.
    fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }
}

/// When to stop.
pub(super) struct Allowance<'a> {
    pub expansions: u64,
    /// The share of the time that has passed, and where to stop.
    pub clock: Option<&'a dyn Fn() -> f64>,
    pub until: f64,
}

/// Where an absent goal would best go.
#[derive(Clone, Copy)]
struct Place {
    visit: u32,
    /// The row it would follow.
    row: u32,
    score: f64,
}

impl Place {
    /// It fits nowhere.
    const NOWHERE: Self = Self { visit: 0, row: 0, score: 0.0 };
}

pub(super) struct Improver {
    net: Net,
    draws: Draws,
    current: Tour,
    trial: Tour,
    best: Tour,
    kept: Kept,
    /// Stops at the head of the route that must stay.
    locked: usize,
    /// Insertions and rounds so far.
    expansions: u64,
    /// And how many there may be.
    limit: u64,
    /// Stops walked through, up to what makes an expansion.
    steps: usize,
    places: Vec<Place>,
    worth: Vec<f64>,
    absent: Vec<u32>,
    /// Visits that a repair considers, and for each visit the last repair that did; repairs so far.
    pool: Vec<u32>,
    marks: Vec<u64>,
    rounds: u64,
    /// Rounds so far.
    turns: u64,
    /// How much chance has to do with this round's choices, and to which power a worth counts in them.
    noise: f64,
    power: f64,
    /// Starts taken so far, the share of the work at which the present one began and ends, and its first heat.
    starts: u32,
    span: (f64, f64),
    hot: f64,
}

/// Heat is in units of the mean worth of a stop: at this much of it a loss of one stop is a matter of chance.
const HOT: f64 = 2.0;
/// Heat at the end.
const COLD: f64 = 0.02;
/// Heat when the best of the starts is taken up again.
const WARM: f64 = 0.5;
/// Starts from nothing at most, and their share of the work. The more goals, the fewer: each start needs its time.
const STARTS: usize = 8;
const STARTING: f64 = 0.6;
/// Worth of unused budget, as a share of what the used one brought.
const SLACK: f64 = 0.5;
/// Most stops that one round takes out.
const OUT: usize = 40;
/// One round in so many considers all absent goals, the others those near what was taken out.
const ALL: usize = 10;
/// How many neighbours of each stop taken out are near.
const NEAR: usize = 12;

impl Improver {
    /// An improver that starts from nothing but the stops that must come first; none if those cannot be done.
    pub(super) fn new(model: &mut Model<'_>, first: &[Call], keep: usize) -> Option<Self> {
        let net = Net::new(model);
        let mut start = Tour::empty(model, &net);
        for call in first {
            let visit = net.poses_of[call.candidate]
                .clone()
                .find(|&v| net.visits[v as usize].node as usize == call.node)?;
            start.route.push(visit + 1);
        }
        start.settle(model, &net);
        if start.len() != first.len() {
            return None;
        }
        let mut kept = Kept::new(keep);
        if start.value > f64::NEG_INFINITY {
            kept.take(&net, &start);
        }
        Some(Self {
            draws: Draws(0),
            current: start.clone(),
            trial: start.clone(),
            best: start,
            kept,
            locked: first.len(),
            expansions: 0,
            limit: 0,
            steps: 0,
            places: Vec::new(),
            worth: Vec::new(),
            absent: Vec::new(),
            pool: Vec::new(),
            marks: vec![0; net.visits.len()],
            rounds: 0,
            turns: 0,
            noise: 0.0,
            power: 1.0,
            starts: 0,
            span: (0.0, 0.0),
            hot: 0.0,
            net,
        })
    }

    /// The best plans of different sets, best first.
    pub(super) fn plans(&self) -> impl Iterator<Item = &[Call]> {
        self.kept.tours.iter().map(|(_, _, calls)| calls.as_slice())
    }

    /// Works until the allowance is spent; gives the expansions.
    pub(super) fn run(&mut self, model: &mut Model<'_>, allowance: &Allowance<'_>) -> u64 {
        /// Rounds between two looks at the clock.
        const BREATH: u64 = 16;
        self.expansions = 0;
        self.limit = allowance.expansions;
        self.starts = 0;
        self.span = (0.0, 0.0);
        if self.net.visits.is_empty() {
            return 0;
        }
        let began = allowance.clock.map_or(0.0, |clock| clock());
        let mut timed = 0.0;
        for round in 0.. {
            if let Some(clock) = allowance.clock
                && round % BREATH == 0
            {
                let now = clock();
                let rest = allowance.until - began;
                timed = if now >= allowance.until { 1.0 } else { (now - began) / rest };
            }
            let spent = self.expansions as f64 / allowance.expansions.max(1) as f64;
            let mut progress = spent.max(timed);
            if progress >= 1.0 && round == 0 && self.limit > 0 && self.best.len() == self.locked {
                // However late it is: some answer.
                progress = 0.0;
            }
            if progress >= 1.0 || self.limit == 0 {
                break;
            }
            if progress >= self.span.1 {
                self.begin(model, progress);
            } else {
                self.round(model, progress);
            }
        }
        self.expansions
    }

    /// Begins anew: a few times from nothing, then from the best found.
    fn begin(&mut self, model: &mut Model<'_>, progress: f64) {
        let starts = (2000 / self.net.visits.len().max(1)).clamp(2, STARTS) as u32;
        let each = STARTING / f64::from(starts);
        if self.starts < starts {
            self.starts += 1;
            self.span = (progress, each * f64::from(self.starts));
            self.hot = HOT;
            let mut gone = vec![true; self.best.route.len()];
            gone[..=self.locked].fill(false);
            self.trial.copy_from(&self.best);
            self.trial.remove(model, &self.net, &gone);
            self.trial.settle(model, &self.net);
            self.pool.clear();
            self.noise = 0.6;
            self.power = [0.5, 1.0, 1.5, 2.0][self.draws.below(4)];
            if self.starts > 1 {
                for _ in
                    0..self.draws.below(4).min(self.limit.saturating_sub(self.expansions) as usize)
                {
                    let visit = self.draws.below(self.net.visits.len());
                    let candidate = self.net.visits[visit].candidate as usize;
                    if let Some(place) = self.best_place(model, candidate) {
                        self.put(model, place);
                    }
                }
            }
            self.repair(model, None);
            self.current.copy_from(&self.trial);
        } else {
            self.span = (progress, 1.0);
            self.hot = WARM;
            self.current.copy_from(&self.best);
        }
        self.trial.settle(model, &self.net);
        if self.trial.beats(&self.best) {
            self.best.copy_from(&self.trial);
            self.kept.take(&self.net, &self.trial);
        }
    }

    fn round(&mut self, model: &mut Model<'_>, progress: f64) {
        /// Rounds after which sums are made anew, before rounding adds up.
        const ANEW: u64 = 512;
        self.turns += 1;
        if self.turns.is_multiple_of(ANEW) {
            self.current.settle(model, &self.net);
        }
        self.trial.copy_from(&self.current);
        self.noise = [0.0, 0.1, 0.3, 0.6][self.draws.below(4)];
        self.power = [0.5, 1.0, 1.0, 1.5, 2.0][self.draws.below(5)];
        let wanted = self.ruin(model);
        self.expansions += 1;
        self.repair(model, wanted);
        self.accept(model, progress);
    }

    fn accept(&mut self, model: &mut Model<'_>, progress: f64) {
        let (hot, cold) = (self.hot, COLD);
        let mean = self.best.value.abs() / self.best.len().max(1) as f64;
        let along = ((progress - self.span.0) / (self.span.1 - self.span.0)).clamp(0.0, 1.0);
        let heat = mean * hot * libm::pow(cold / hot, along);
        let chance = self.draws.unit().max(1e-12);
        let scale = SLACK * self.best.value.abs();
        let merit = |t: &Tour| t.value + scale * (1.0 - t.weight);
        if self.trial.beats(&self.best) {
            self.trial.settle(model, &self.net);
            if self.trial.beats(&self.best) {
                self.best.copy_from(&self.trial);
                self.kept.take(&self.net, &self.trial);
            }
        } else if self.kept.wants(&self.trial) {
            self.trial.settle(model, &self.net);
            self.kept.take(&self.net, &self.trial);
        }
        let (trial, current) = (merit(&self.trial), merit(&self.current));
        let fewer = self.trial.missed < self.current.missed;
        let more = self.trial.missed > self.current.missed;
        if fewer || !more && trial >= current + heat * libm::log(chance) {
            std::mem::swap(&mut self.current, &mut self.trial);
        }
    }

    /// Takes stops out; gives a visit that shall be put in first, if any.
    fn ruin(&mut self, model: &mut Model<'_>) -> Option<usize> {
        let count = self.trial.len() - self.locked;
        if count == 0 {
            return None;
        }
        let most = (count / 3).clamp(3, OUT).min(count);
        let out = 1 + self.draws.below(most);
        let mut gone = vec![false; self.trial.route.len()];
        let mut wanted = None;
        match self.draws.below(4) {
            0 => {
                let first = self.locked + 1 + self.draws.below(count);
                for index in first..(first + out).min(gone.len()) {
                    gone[index] = true;
                }
            }
            1 => {
                for _ in 0..out {
                    gone[self.locked + 1 + self.draws.below(count)] = true;
                }
            }
            _ => {
                // Strings around a seed.
                let seed = self.draws.below(self.net.visits.len());
                if !self.trial.held[self.net.visits[seed].candidate as usize] {
                    wanted = Some(seed);
                } else if self.trial.place[seed] as usize > self.locked {
                    gone[self.trial.place[seed] as usize] = true;
                }
                let mut left = out;
                for &row in &self.net.near[seed] {
                    if left == 0 {
                        break;
                    }
                    if row == 0 {
                        continue;
                    }
                    let place = self.trial.place[row as usize - 1] as usize;
                    if place <= self.locked || gone[place] {
                        continue;
                    }
                    let length = 1 + self.draws.below(left.min(10));
                    let back = self.draws.below(length);
                    let from = place.saturating_sub(back).max(self.locked + 1);
                    for index in from..(from + length).min(gone.len()) {
                        if !gone[index] {
                            gone[index] = true;
                            left = left.saturating_sub(1);
                        }
                    }
                }
            }
        }
        self.pool.clear();
        for (index, &row) in self.trial.route.iter().enumerate() {
            if gone[index] {
                self.pool.push(row - 1);
            }
        }
        self.trial.remove(model, &self.net, &gone);
        wanted
    }

    /// Puts goals in, best share of value for budget first, until none fits.
    fn repair(&mut self, model: &mut Model<'_>, wanted: Option<usize>) {
        if let Some(visit) = wanted
            && self.expansions < self.limit
            && let Some(place) = self.best_place(model, self.net.visits[visit].candidate as usize)
        {
            self.put(model, place);
        }
        if self.net.mode == Mode::Plain {
            self.repair_near(model);
            return;
        }
        self.absent.clear();
        self.places.clear();
        for candidate in 0..self.trial.held.len() {
            if self.trial.held[candidate] || self.net.poses_of[candidate].is_empty() {
                continue;
            }
            self.absent.push(candidate as u32);
            let place = self.best_place(model, candidate);
            self.places.push(place.unwrap_or(Place::NOWHERE));
        }
        loop {
            let mut top: Option<usize> = None;
            for (index, place) in self.places.iter().enumerate() {
                if place.score > 0.0 && top.is_none_or(|t| place.score > self.places[t].score) {
                    top = Some(index);
                }
            }
            let Some(top) = top else { break };
            if self.expansions >= self.limit {
                break;
            }
            let place = self.places[top];
            let candidate = self.absent[top] as usize;
            // What was weighed before other goals came in may no longer hold.
            if !self.still_fits(model, place) {
                let anew = self.best_place(model, candidate);
                self.places[top] = anew.unwrap_or(Place::NOWHERE);
                if anew.is_none_or(|p| p.row == place.row && p.visit == place.visit) {
                    self.places[top].score = 0.0;
                }
                continue;
            }
            self.put(model, place);
            self.places.swap_remove(top);
            self.absent.swap_remove(top);
            self.renew(model, place);
        }
    }

    /// Puts goals in, of those around what was taken out.
    fn repair_near(&mut self, model: &mut Model<'_>) {
        self.rounds += 1;
        let stamp = self.rounds;
        let removed_nothing = self.pool.is_empty();
        let all = self.draws.below(ALL) == 0 || self.trial.len() < 8 || removed_nothing;
        let removed = self.pool.len();
        for index in 0..removed {
            self.marks[self.pool[index] as usize] = stamp;
        }
        if all {
            for visit in 0..self.net.visits.len() {
                if self.marks[visit] != stamp && self.trial.place[visit] == 0 {
                    self.pool.push(visit as u32);
                }
            }
        } else {
            for index in 0..removed {
                let visit = self.pool[index] as usize;
                for near in 0..NEAR.min(self.net.near[visit].len()) {
                    let row = self.net.near[visit][near];
                    if row == 0 {
                        continue;
                    }
                    let other = row as usize - 1;
                    if self.marks[other] != stamp && self.trial.place[other] == 0 {
                        self.marks[other] = stamp;
                        self.pool.push(other as u32);
                    }
                }
            }
        }
        self.places.clear();
        self.worth.clear();
        for index in 0..self.pool.len() {
            let visit = self.pool[index];
            let worth = self.worth(model, visit as usize);
            self.worth.push(worth);
            let place = self.nearest_place(model, visit, worth);
            self.places.push(place);
        }
        loop {
            let mut top: Option<usize> = None;
            let mut most = 0.0;
            for (index, place) in self.places.iter().enumerate() {
                if place.score > most {
                    most = place.score;
                    top = Some(index);
                }
            }
            let Some(top) = top else { break };
            if self.expansions >= self.limit {
                break;
            }
            let place = self.places[top];
            let fits = self.still_fits(model, place);
            if fits {
                self.put(model, place);
            }
            self.places.swap_remove(top);
            self.pool.swap_remove(top);
            self.worth.swap_remove(top);
            if fits {
                self.renew_near(model, place);
            }
        }
    }

    /// What a visit counts for in this round.
    fn worth(&mut self, model: &Model<'_>, visit: usize) -> f64 {
        let goal = &self.net.visits[visit];
        let worth = self.raised(goal.prize) * (1.0 + self.noise * (self.draws.unit() - 0.5));
        if model.problem.candidates[goal.candidate as usize].mandatory {
            1e12 + worth
        } else {
            worth
        }
    }

    /// A worth to this round's power, which is a half, 1, one and a half or 2: roots have the same bits everywhere.
    fn raised(&self, worth: f64) -> f64 {
        match self.power {
            p if p < 1.0 => worth.sqrt(),
            1.0 => worth,
            p if p < 2.0 => worth * worth.sqrt(),
            _ => worth * worth,
        }
    }

    /// The cheapest place for a visit beside the stops near to it.
    fn nearest_place(&self, model: &Model<'_>, visit: u32, worth: f64) -> Place {
        const BESIDE: usize = 5;
        let mut best = Place { visit, row: 0, score: 0.0 };
        if worth <= 0.0 || !self.trial.may_hold(model, &self.net, visit as usize) {
            return best;
        }
        let net = &self.net;
        let candidate = net.visits[visit as usize].candidate as usize;
        let earliest = self.trial.earliest(model, net, candidate).max(self.locked);
        let mut least = f64::INFINITY;
        let mut seen = 0;
        let route = &self.trial.route;
        let mut look = |index: usize| {
            let (row, next) = (route[index], self.trial.after(net, index));
            let detour = net.weight[net.leg(row, visit as usize)]
                + net.weight[net.leg(visit + 1, next)]
                - net.weight[net.leg(row, next)];
            if detour < least {
                least = detour;
                best.row = row;
            }
        };
        if route.len() <= BESIDE + 1 {
            for index in earliest..route.len() {
                look(index);
            }
        } else {
            for &row in &net.near[visit as usize] {
                let index = self.index_of(row);
                if row != 0 && index == 0 {
                    continue;
                }
                seen += 1;
                if index >= earliest {
                    look(index);
                }
                if index > earliest {
                    look(index - 1);
                } else if row == 0 && self.locked == 0 {
                    // Before the end is beside the start, where both are one place.
                    look(route.len() - 1);
                }
                if seen == BESIDE {
                    break;
                }
            }
        }
        best.score = if least < 1e200 { worth / least.max(1e-7) } else { 0.0 };
        best
    }

    /// Looks at the two edges that a new stop made.
    fn renew_near(&mut self, model: &mut Model<'_>, new: Place) {
        let index = self.index_of(new.visit + 1);
        let added = new.visit as usize;
        let (before, after) = (self.trial.route[index - 1], self.trial.after(&self.net, index));
        for at in 0..self.pool.len() {
            let visit = self.pool[at];
            let worth = self.worth[at];
            let old = self.places[at];
            if old.score <= 0.0
                || old.row == new.row
                || !self.trial.may_hold(model, &self.net, visit as usize)
            {
                self.places[at] = self.nearest_place(model, visit, worth);
                continue;
            }
            let candidate = self.net.visits[visit as usize].candidate as usize;
            if index - 1 < self.trial.earliest(model, &self.net, candidate).max(self.locked) {
                continue;
            }
            let net = &self.net;
            let leg = |row: u32, column: usize| net.weight[net.leg(row, column)];
            let (mine, row) = (visit as usize, visit + 1);
            let first = leg(before, mine) + leg(row, added) - leg(before, added);
            let second = leg(new.visit + 1, mine) + leg(row, after) - leg(new.visit + 1, after);
            let (detour, beside) =
                if first <= second { (first, before) } else { (second, new.visit + 1) };
            let score = worth / detour.max(1e-7);
            if score > old.score {
                self.places[at] = Place { visit, row: beside, score };
            }
        }
    }

    fn still_fits(&mut self, model: &mut Model<'_>, place: Place) -> bool {
        let visit = place.visit as usize;
        if !self.trial.may_hold(model, &self.net, visit) {
            return false;
        }
        let index = self.index_of(place.row);
        if matches!(self.net.mode, Mode::Facts | Mode::Walk) {
            self.walk(self.trial.len() - index);
        }
        let value = self.trial.weigh_surely(model, &self.net, visit, index);
        let mandatory =
            model.problem.candidates[self.net.visits[visit].candidate as usize].mandatory;
        value.is_some_and(|value| value > 0.0 || mandatory)
    }

    /// Counts stops walked through: so many of them are as much work as an insertion.
    fn walk(&mut self, stops: usize) {
        const STEPS: usize = 256;
        self.steps += stops + 1;
        self.expansions += (self.steps / STEPS) as u64;
        self.steps %= STEPS;
    }

    fn index_of(&self, row: u32) -> usize {
        if row == 0 { 0 } else { self.trial.place[row as usize - 1] as usize }
    }

    fn put(&mut self, model: &mut Model<'_>, place: Place) {
        let index = self.index_of(place.row);
        self.trial.insert(model, &self.net, place.visit as usize, index);
        self.expansions += 1;
    }

    /// Looks at the two edges that a new stop made.
    fn renew(&mut self, model: &mut Model<'_>, new: Place) {
        let index = self.index_of(new.visit + 1);
        if index == 0 {
            return;
        }
        for at in 0..self.absent.len() {
            let candidate = self.absent[at] as usize;
            let old = self.places[at];
            let broken = old.score > 0.0 && old.row == new.row;
            if broken {
                let anew = self.best_place(model, candidate);
                self.places[at] = anew.unwrap_or(Place::NOWHERE);
                continue;
            }
            for visit in self.net.poses_of[candidate].clone() {
                if !self.trial.may_hold(model, &self.net, visit as usize) {
                    continue;
                }
                let earliest = self.trial.earliest(model, &self.net, candidate).max(self.locked);
                for index in [index - 1, index] {
                    if index >= earliest {
                        let score = self.score(model, visit as usize, index);
                        if score > self.places[at].score {
                            self.places[at] = Place { visit, row: self.trial.route[index], score };
                        }
                    }
                }
            }
        }
    }

    /// The best place for a goal, if it fits anywhere.
    fn best_place(&mut self, model: &mut Model<'_>, candidate: usize) -> Option<Place> {
        /// Neighbours in the route that are looked at.
        const BESIDE: usize = 6;
        let mut best: Option<Place> = None;
        let earliest = self.trial.earliest(model, &self.net, candidate).max(self.locked);
        for visit in self.net.poses_of[candidate].clone() {
            if !self.trial.may_hold(model, &self.net, visit as usize) {
                continue;
            }
            let few = self.trial.len() <= 2 * BESIDE || self.net.mode != Mode::Plain;
            if few {
                let close_s = self.net.visits[visit as usize].close_s;
                for index in earliest..self.trial.route.len() {
                    if self.trial.left_after(&self.net, index, close_s) {
                        break;
                    }
                    let score = self.score(model, visit as usize, index);
                    if score > best.map_or(0.0, |b| b.score) {
                        best = Some(Place { visit, row: self.trial.route[index], score });
                    }
                }
                continue;
            }
            let mut seen = 0;
            for near in 0..self.net.near[visit as usize].len() {
                let row = self.net.near[visit as usize][near];
                let index = self.index_of(row);
                if row != 0 && index == 0 {
                    continue;
                }
                seen += 1;
                for index in [index.wrapping_sub(1), index] {
                    if index < self.trial.route.len() && index >= earliest {
                        let score = self.score(model, visit as usize, index);
                        if score > best.map_or(0.0, |b| b.score) {
                            best = Some(Place { visit, row: self.trial.route[index], score });
                        }
                    }
                }
                if seen == BESIDE {
                    break;
                }
            }
        }
        best
    }

    /// How much value for the budget a visit after an index brings; 0 if it cannot be.
    fn score(&mut self, model: &mut Model<'_>, visit: usize, index: usize) -> f64 {
        if self.net.mode == Mode::Walk {
            self.walk(self.trial.len() - index);
        }
        let Some(change) = self.trial.weigh(model, &self.net, visit, index) else { return 0.0 };
        let candidate = self.net.visits[visit].candidate as usize;
        let mandatory = model.problem.candidates[candidate].mandatory;
        let worth = if mandatory { 1e9 + change.value } else { change.value };
        if worth <= 0.0 {
            return 0.0;
        }
        let ratio = self.raised(worth) / change.weight.max(1e-7);
        ratio * (1.0 + self.noise * (self.draws.unit() - 0.5))
    }
}
