//! A bound on what any sequence can be worth, however many goals there are.
//!
//! The budgets and the condition that a visited goal has two legs are relaxed with multipliers (Held and Karp 1970); what
//! is left is a spanning forest: goals that are not visited hang on a dummy instead of on the route. Such a forest may still
//! have goals that are visited and yet joined to the route by nothing but the dummy: what forbids that (generalised
//! subtour constraints, Fischetti, Salazar and Toth 1998) is added where it is met, with multipliers of its own (relax and
//! cut, Lucena 2005). Every choice of multipliers gives a bound; the subgradient method looks for good ones.

use wisdom_planner::CostVector;

use super::model::Model;
use crate::objective::Served;
use crate::prize::Ladder;

const RESOURCES: usize = 4;

/// What one resource takes, as a share of its budget (or in its price, where it has no budget).
struct Resource {
    /// Leg between goals, the cheaper of both directions, over all poses and alternatives; row by row.
    legs: Vec<f64>,
    /// Leg from the start to each goal, and from each goal to the end.
    out: Vec<f64>,
    home: Vec<f64>,
    service: Vec<f64>,
    /// Whether there is a budget.
    limited: bool,
    /// Price of the whole budget.
    price: f64,
}

/// Goals without the start: if one of them, `visited`, is visited, the route has fewer legs among them than it visits of
/// them.
#[derive(Debug, Clone, PartialEq)]
struct Cut {
    goals: Vec<u32>,
    member: Vec<bool>,
    visited: u32,
    /// In units of the mean worth.
    multiplier: f64,
    /// Steps for which it was 0.
    idle: u32,
}

/// Multipliers and the best bound so far.
pub(super) struct Bound {
    count: usize,
    resources: Vec<Resource>,
    /// The most that each goal can add to the gain.
    worth: Vec<f64>,
    total: f64,
    /// Multipliers of the budgets, as shares of all there is to gain.
    budget: Vec<f64>,
    /// Multipliers of the goals, in units of the mean worth.
    goal: Vec<f64>,
    best: f64,
    cuts: Vec<Cut>,
    /// What the cuts add to the legs, row by row, and to the worth of the goals.
    dearer: Vec<f64>,
    dearer_at: Vec<usize>,
    richer: Vec<f64>,
    at_best: (Vec<f64>, Vec<f64>, Vec<Cut>),
    stride: f64,
    stale: u32,
    ladder: Option<Ladder>,
    /// Reliability of the safest way to a goal, rounded up.
    safest: f64,
    /// Of a plan that does nothing.
    nothing: f64,
    forest: Forest,
}

/// The forest of one step, and memory for it.
#[derive(Default)]
struct Forest {
    key: Vec<f64>,
    parent: Vec<u32>,
    open: Vec<u32>,
    degree: Vec<i32>,
    /// Whether each goal hangs on the dummy.
    skipped: Vec<bool>,
    /// The goal whose edge to its parent is left out.
    cut_off: usize,
}

impl Forest {
    /// How far a cut is from being broken; negative if it is.
    fn slack(&self, cut: &Cut) -> f64 {
        let mut slack = 0.0;
        for &i in &cut.goals {
            let i = i as usize;
            if !self.skipped[i] && i != cut.visited as usize {
                slack += 1.0;
            }
            let parent = self.parent[i] as usize;
            if i != self.cut_off && parent < cut.member.len() && cut.member[parent] {
                slack -= 1.0;
            }
        }
        slack
    }

    /// The groups of goals, not larger than this, that hang on the dummy by one of them; each sorted.
    fn strays(&self, largest: usize) -> Vec<Vec<u32>> {
        let count = self.parent.len();
        // The goal by which each hangs on the dummy, or by which the route's part is cut off.
        let mut root: Vec<usize> = vec![usize::MAX; count];
        let mut groups = vec![Vec::new(); count];
        for start in 0..count {
            let (mut at, mut path) = (start, Vec::new());
            let found = loop {
                if root[at] != usize::MAX {
                    break root[at];
                }
                path.push(at);
                if at == self.cut_off || self.parent[at] as usize == count {
                    break at;
                }
                at = self.parent[at] as usize;
            };
            for i in path {
                root[i] = found;
            }
            if found != self.cut_off {
                groups[found].push(start as u32);
            }
        }
        groups.retain(|group| (2..=largest).contains(&group.len()));
        groups
    }
}

const NO_WAY: f64 = 1e30;

impl Bound {
    /// Without a step yet: the bound is the sum of all that can be gained.
    pub(super) fn new(model: &Model<'_>) -> Self {
        let problem = model.problem;
        let limits = problem.limits;
        let max_risk = if model.floor > 0.0 { -libm::log(model.floor) } else { f64::INFINITY };
        let services: Vec<_> =
            problem.candidates.iter().map(|c| model.cheapest_service(c)).collect();
        let able: Vec<usize> = (0..problem.candidates.len())
            .filter(|&i| services[i].is_some() && !model.orphaned[i])
            .collect();
        let count = able.len();
        let nodes_of = |i: usize| problem.candidates[able[i]].poses.as_slice();
        let costs = |leg: &CostVector| [leg.time_s, leg.energy_j, 0.0, leg.neg_ln_r];
        let least = |from: &[usize], to: &[usize]| {
            let mut best = [NO_WAY, NO_WAY, 0.0, NO_WAY];
            for &a in from {
                for &b in to {
                    for leg in problem.travel.alternatives(a, b) {
                        let cost = costs(leg);
                        for k in 0..RESOURCES {
                            best[k] = best[k].min(cost[k]);
                        }
                    }
                }
            }
            best
        };
        let mut legs = vec![[0.0; RESOURCES]; count * count];
        for from in 0..count {
            for to in 0..count {
                if from != to {
                    legs[from * count + to] = least(nodes_of(from), nodes_of(to));
                }
            }
        }
        let out: Vec<[f64; RESOURCES]> = (0..count).map(|i| least(&[0], nodes_of(i))).collect();
        let home: Vec<[f64; RESOURCES]> = (0..count)
            .map(|i| {
                if problem.ends.is_empty() {
                    [0.0; RESOURCES]
                } else {
                    least(nodes_of(i), problem.ends)
                }
            })
            .collect();
        let service: Vec<[f64; RESOURCES]> = able
            .iter()
            .map(|&i| {
                services[i]
                    .map_or([0.0; RESOURCES], |(s, _)| [s.time_s, s.energy_j, s.data_mb, 0.0])
            })
            .collect();

        // The safest and the quickest way to each goal, over any others.
        let nearest = |k: usize| {
            let mut reach: Vec<f64> = out.iter().map(|o| o[k]).collect();
            let mut done = vec![false; count];
            for _ in 0..count {
                let open = (0..count).filter(|&i| !done[i]);
                let Some(next) = open.min_by(|&a, &b| reach[a].total_cmp(&reach[b])) else { break };
                done[next] = true;
                for to in 0..count {
                    reach[to] = reach[to].min(reach[next] + legs[next * count + to][k]);
                }
            }
            reach
        };
        let (quickest, safest) = (nearest(0), nearest(3));
        let worth: Vec<f64> = (0..count)
            .map(|i| {
                let goal = &problem.candidates[able[i]];
                let done_s = quickest[i] + service[i][0];
                let freshness = goal.fade.map_or(1.0, |fade| fade.freshness(done_s));
                let reliability = libm::exp(-safest[i]);
                model.objective.gain(Served { prize: goal.prize, reliability, freshness })
            })
            .collect();

        let budgets = [limits.time_s, limits.energy_j, limits.data_mb, max_risk];
        let prices = &model.prices;
        let prices = [prices.time_per_s, prices.energy_per_j, prices.data_per_mb, prices.risk];
        let mut resources = Vec::new();
        for k in 0..RESOURCES {
            let limited = budgets[k] < f64::INFINITY;
            if !limited && prices[k] == 0.0 {
                continue;
            }
            // A budget of nothing still tells what costs something from what does not.
            let unit = if limited { budgets[k].max(1e-9) } else { 1.0 };
            let scaled =
                |of: &[[f64; RESOURCES]]| of.iter().map(|c| c[k] / unit).collect::<Vec<f64>>();
            let both = |from: usize, to: usize| {
                legs[from * count + to][k].min(legs[to * count + from][k]) / unit
            };
            resources.push(Resource {
                legs: (0..count * count).map(|at| both(at / count, at % count)).collect(),
                out: scaled(&out),
                home: scaled(&home),
                service: scaled(&service),
                limited,
                price: prices[k] * unit,
            });
        }
        let total: f64 = worth.iter().sum();
        let budget: Vec<f64> =
            resources.iter().map(|r| if r.limited { 1.0 } else { 0.0 }).collect();
        let goal = vec![0.0; count];
        Self {
            count,
            at_best: (budget.clone(), goal.clone(), Vec::new()),
            cuts: Vec::new(),
            dearer: vec![0.0; count * count],
            dearer_at: Vec::new(),
            richer: vec![0.0; count],
            resources,
            worth,
            total,
            budget,
            goal,
            best: total,
            stride: 1.0,
            stale: 0,
            ladder: model.ladder(),
            safest: (libm::exp(-safest.iter().copied().fold(f64::INFINITY, f64::min))
                * (1.0 + 1e-9))
                .min(1.0),
            nothing: model.whole(&Model::start()).map_or(0.0, |whole| whole.value),
            forest: Forest::default(),
        }
    }

    /// No sequence has more value than this.
    pub(super) fn value(&self, model: &Model<'_>) -> f64 {
        /// More than the rounding of a few thousand sums.
        const ROUNDING: f64 = 1e-9;
        let gain = self.best + ROUNDING * self.total;
        let gain = self.ladder.map_or(gain, |ladder| ladder.below(gain));
        // No plan that visits a goal is safer than the safest way to one.
        model.objective.value(gain, 0.0, self.safest).max(self.nothing)
    }

    /// What a step costs in expansions.
    pub(super) fn price(&self) -> u64 {
        1 + (self.count * self.count) as u64 / 1024
    }

    /// Some steps towards better multipliers, given the value of a known plan; ends early where no more is to be had.
    pub(super) fn improve(&mut self, known: f64, steps: u64, over: &dyn Fn() -> bool) -> u64 {
        /// Steps without a better bound before strides are halved.
        const PATIENCE: u32 = 50;
        if self.count == 0 || self.total <= 0.0 {
            return 0;
        }
        let mean = self.total / self.count as f64;
        for step in 0..steps {
            if self.stride < 1e-5 || step % 16 == 0 && over() {
                return step;
            }
            let (bound, used) = self.step(mean);
            if bound < self.best {
                if bound < self.best - 1e-4 * self.total {
                    self.stale = 0;
                }
                self.best = bound;
                self.at_best = (self.budget.clone(), self.goal.clone(), self.cuts.clone());
            }
            self.stale += 1;
            if self.stale > PATIENCE {
                self.stale = 0;
                self.stride *= 0.7;
                (self.budget, self.goal, self.cuts) = self.at_best.clone();
                continue;
            }
            // Polyak's step towards what is known to be possible.
            let slack: Vec<f64> = used.iter().map(|used| self.total * (1.0 - used)).collect();
            let uneven = |forest: &Forest, i: usize| {
                mean * f64::from(forest.degree[i] - if forest.skipped[i] { 0 } else { 2 })
            };
            let mut norm = 0.0;
            for (k, resource) in self.resources.iter().enumerate() {
                if resource.limited && !(self.budget[k] <= 0.0 && slack[k] > 0.0) {
                    norm += slack[k] * slack[k];
                }
            }
            norm += (0..self.count).map(|i| uneven(&self.forest, i)).map(|g| g * g).sum::<f64>();
            self.cut();
            let loose: Vec<f64> =
                self.cuts.iter().map(|cut| mean * self.forest.slack(cut)).collect();
            for (cut, &loose) in self.cuts.iter().zip(&loose) {
                if loose < 0.0 || cut.multiplier > 0.0 {
                    norm += loose * loose;
                }
            }
            if norm <= 0.0 {
                return step + 1;
            }
            let length = self.stride * (bound - known).max(1e-6 * self.total) / norm;
            for (k, resource) in self.resources.iter().enumerate() {
                if resource.limited {
                    self.budget[k] = (self.budget[k] - length * slack[k]).max(0.0);
                }
            }
            for i in 0..self.count {
                self.goal[i] -= length * uneven(&self.forest, i);
            }
            for (cut, loose) in self.cuts.iter_mut().zip(loose) {
                cut.multiplier = (cut.multiplier - length * loose).max(0.0);
                cut.idle = if cut.multiplier > 0.0 { 0 } else { cut.idle + 1 };
            }
            self.cuts.retain(|cut| cut.idle < 30);
        }
        steps
    }

    /// Adds a cut for every group of goals that the forest visits though only the dummy joins them to the route.
    fn cut(&mut self) {
        const LARGEST: usize = 64;
        const MOST: usize = 400;
        for goals in self.forest.strays(LARGEST) {
            if self.cuts.len() >= MOST {
                break;
            }
            let worth = |&i: &&u32| self.worth[*i as usize];
            let visited = goals.iter().filter(|&&i| !self.forest.skipped[i as usize]);
            let Some(&visited) = visited.max_by(|a, b| worth(a).total_cmp(&worth(b))) else {
                continue;
            };
            if self.cuts.iter().any(|cut| cut.visited == visited && cut.goals == goals) {
                continue;
            }
            let mut member = vec![false; self.count];
            for &i in &goals {
                member[i as usize] = true;
            }
            self.cuts.push(Cut { goals, member, visited, multiplier: 0.0, idle: 0 });
        }
    }

    /// Works out what the cuts add to legs and goals.
    fn apply_cuts(&mut self, mean: f64) {
        for at in self.dearer_at.drain(..) {
            self.dearer[at] = 0.0;
        }
        self.richer.fill(0.0);
        for cut in self.cuts.iter().filter(|cut| cut.multiplier > 0.0) {
            let price = cut.multiplier * mean;
            for &i in &cut.goals {
                if i != cut.visited {
                    self.richer[i as usize] += price;
                }
                for &j in &cut.goals {
                    let at = i as usize * self.count + j as usize;
                    self.dearer[at] += price;
                    self.dearer_at.push(at);
                }
            }
        }
    }

    /// The bound of the present multipliers and the share of each resource that its solution uses.
    fn step(&mut self, mean: f64) -> (f64, Vec<f64>) {
        self.apply_cuts(mean);
        let count = self.count;
        let dummy = count;
        let rates: Vec<f64> = self
            .resources
            .iter()
            .zip(&self.budget)
            .map(|(resource, budget)| resource.price + budget * self.total)
            .collect();
        let goal: Vec<f64> = self.goal.iter().map(|b| b * mean).collect();
        let cost = |of: fn(&Resource) -> &Vec<f64>, at: usize| {
            self.resources.iter().zip(&rates).map(|(r, rate)| rate * of(r)[at]).sum::<f64>()
        };
        // What is lost by leaving a goal out.
        let loss: Vec<f64> = (0..count)
            .map(|i| self.worth[i] + self.richer[i] - cost(|r| &r.service, i) - 2.0 * goal[i])
            .collect();

        let forest = &mut self.forest;
        forest.key.clear();
        forest.key.extend_from_slice(&loss);
        forest.parent.clear();
        forest.parent.resize(count, dummy as u32);
        forest.open.clear();
        forest.open.extend(0..count as u32);
        forest.degree.clear();
        forest.degree.resize(count, 0);
        forest.skipped.clear();
        forest.skipped.resize(count, false);
        // Prim's tree from the dummy; its dearest edge is then left out, for route and dummy are not joined.
        let mut weight = 0.0;
        let mut dearest = (f64::NEG_INFINITY, 0usize);
        while !forest.open.is_empty() {
            let mut nearest = 0;
            for (index, &i) in forest.open.iter().enumerate() {
                if forest.key[i as usize] < forest.key[forest.open[nearest] as usize] {
                    nearest = index;
                }
            }
            let next = forest.open.swap_remove(nearest) as usize;
            let edge = forest.key[next];
            weight += edge;
            if edge > dearest.0 {
                dearest = (edge, next);
            }
            let row = next * count..(next + 1) * count;
            if let [resource] = self.resources.as_slice() {
                let (legs, dearer) = (&resource.legs[row.clone()], &self.dearer[row]);
                let (rate, mine) = (rates[0], goal[next]);
                for &to in &forest.open {
                    let to = to as usize;
                    let edge = rate * legs[to] + dearer[to] - mine - goal[to];
                    if edge < forest.key[to] {
                        forest.key[to] = edge;
                        forest.parent[to] = next as u32;
                    }
                }
            } else {
                for &to in &forest.open {
                    let to = to as usize;
                    let legs = self.resources.iter().zip(&rates);
                    let edge = legs.map(|(r, rate)| rate * r.legs[next * count + to]).sum::<f64>()
                        + self.dearer[next * count + to]
                        - goal[next]
                        - goal[to];
                    if edge < forest.key[to] {
                        forest.key[to] = edge;
                        forest.parent[to] = next as u32;
                    }
                }
            }
        }
        weight -= dearest.0;
        let cheapest = |of: fn(&Resource) -> &Vec<f64>| {
            let reduced = (0..count).map(|i| (cost(of, i) - goal[i], i));
            reduced.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
        };
        let (first, last) = (cheapest(|r| &r.out), cheapest(|r| &r.home));
        weight += first.0 + last.0;

        let limited = self.resources.iter().zip(&self.budget).filter(|(r, _)| r.limited);
        let budgets: f64 = limited.map(|(_, budget)| budget * self.total).sum();
        let bound = budgets + loss.iter().sum::<f64>() - weight;

        forest.cut_off = dearest.1;
        let mut used = vec![0.0; self.resources.len()];
        for i in 0..count {
            if i != dearest.1 {
                let parent = forest.parent[i] as usize;
                if parent == dummy {
                    forest.skipped[i] = true;
                } else {
                    forest.degree[i] += 1;
                    forest.degree[parent] += 1;
                    for (used, resource) in used.iter_mut().zip(&self.resources) {
                        *used += resource.legs[i * count + parent];
                    }
                }
            }
        }
        for i in 0..count {
            if !forest.skipped[i] {
                for (used, resource) in used.iter_mut().zip(&self.resources) {
                    *used += resource.service[i];
                }
            }
        }
        forest.degree[first.1] += 1;
        forest.degree[last.1] += 1;
        for (used, resource) in used.iter_mut().zip(&self.resources) {
            *used += resource.out[first.1] + resource.home[last.1];
        }
        (bound, used)
    }
}
