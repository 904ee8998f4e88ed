//! Random drives with more goals than their budget allows, each leg with a length and a hazard.

use wisdom_goals::{
    Candidate, DRIVE, Directive, Domain, FactSet, GoalId, Limits, OperatorText, Policy,
    Preferences, Problem, quantised,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix, Vehicle};
use wisdom_terrain::unit_noise;

/// Side of the square the sites lie in, metres; the rover starts in its middle.
pub(crate) const SIDE_M: f64 = 100.0;

/// Prizes are uniform between these.
pub(crate) const PRIZE: [f64; 2] = [0.1, 1.0];

/// The most goals of an instance: the budget asks for the shortest way through all of them.
pub(crate) const MOST_GOALS: usize = 14;

/// First word of every key drawn here, so that no draw is one of a mission's with the same seed.
const DRAWING: u64 = 0x7123;

/// Second word: what is drawn.
const SITE_X: u64 = 0;
const SITE_Y: u64 = 1;
const PRIZE_OF: u64 = 2;
const HAZARD_OF: u64 = 3;

/// A law that instances are drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Generator {
    /// Its name, in files too.
    pub(crate) key: &'static str,
    /// What it is.
    pub(crate) title: &'static str,
    /// Budget of length, as a share of the shortest way from the start through all goals.
    pub(crate) budget_share: f64,
    /// Hazard rate of a leg, per metre: its logarithm is uniform between those of the two.
    pub(crate) hazard_per_m: [f64; 2],
}

impl Generator {
    /// The generators of the study. The same seed gives the same sites and prizes under each, and the same order
    /// of the legs by hazard.
    pub(crate) fn all() -> [Self; 4] {
        let vehicle = Vehicle::default();
        let floor = vehicle.hazard_floor_per_m;
        let base = Self {
            key: "base",
            title: "moderate budget and hazard",
            budget_share: 0.55,
            hazard_per_m: [0.0005, 0.012],
        };
        [
            base,
            Self { key: "tight", title: "tight budget", budget_share: 0.3, ..base },
            Self {
                key: "hazardous",
                title: "hazard tripled",
                hazard_per_m: [0.0015, 0.036],
                ..base
            },
            Self {
                key: "rover",
                title: "hazard of the default rover",
                hazard_per_m: [floor, floor * libm::exp(vehicle.hazard_exponent)],
                ..base
            },
        ]
    }
}

/// What it takes to drive from one place to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leg {
    /// Length, metres.
    pub(crate) length_m: f64,
    /// −ln of the chance of arriving.
    pub(crate) neg_ln_r: f64,
}

/// Goals, the legs between them, and how far the rover may drive. Place 0 is the start; goal g is place g + 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Instance {
    /// Prize of each goal, quantised.
    pub(crate) prizes: Vec<f64>,
    /// Longest way that may be driven, metres.
    pub(crate) budget_m: f64,
    /// From every place to every other.
    legs: Vec<Vec<Leg>>,
}

/// What an order of goals comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Length, metres.
    pub(crate) length_m: f64,
    /// Sum of the prizes.
    pub(crate) prize: f64,
    /// J1: sum of each prize times the chance of getting that far.
    pub(crate) expected: f64,
    /// Chance of getting to the end.
    pub(crate) reliability: f64,
}

impl Instance {
    /// Goals with the legs between all places, the start first.
    ///
    /// # Panics
    /// If there is not one place more than goals.
    pub(crate) fn new(prizes: &[f64], legs: Vec<Vec<Leg>>, budget_m: f64) -> Self {
        let places = prizes.len() + 1;
        assert!(
            legs.len() == places && legs.iter().all(|row| row.len() == places),
            "a square of legs"
        );
        Self { prizes: prizes.iter().copied().map(quantised).collect(), budget_m, legs }
    }

    /// The instance of this number: sites uniform in the square, uniform prizes, and for every pair of places a hazard
    /// rate of its own, the same in both directions.
    ///
    /// # Panics
    /// If there are more than [`MOST_GOALS`] goals.
    pub(crate) fn draw(generator: &Generator, goals: usize, seed: u64, number: usize) -> Self {
        assert!(goals <= MOST_GOALS, "the shortest way is sought among few goals");
        let unit = |what, of: usize, with: usize| {
            unit_noise(&[DRAWING, what, seed, number as u64, of as u64, with as u64])
        };
        let centre = (SIDE_M / 2.0, SIDE_M / 2.0);
        let site = |goal| (SIDE_M * unit(SITE_X, goal, 0), SIDE_M * unit(SITE_Y, goal, 0));
        let places: Vec<(f64, f64)> = std::iter::once(centre).chain((0..goals).map(site)).collect();
        let [least, most] = generator.hazard_per_m;
        let leg = |a: usize, b: usize| {
            let (dx, dy) = (places[a].0 - places[b].0, places[a].1 - places[b].1);
            let length_m = (dx * dx + dy * dy).sqrt();
            let quantile = unit(HAZARD_OF, a.min(b), a.max(b));
            let hazard_per_m = least * libm::exp(quantile * libm::log(most / least));
            Leg { length_m, neg_ln_r: hazard_per_m * length_m }
        };
        let row = |a| (0..=goals).map(|b| leg(a, b)).collect();
        let prize = |goal| PRIZE[0] + (PRIZE[1] - PRIZE[0]) * unit(PRIZE_OF, goal, 0);
        let prizes: Vec<f64> = (0..goals).map(prize).collect();
        let mut instance = Self::new(&prizes, (0..=goals).map(row).collect(), 0.0);
        instance.budget_m = generator.budget_share * instance.shortest_way_m();
        instance
    }

    /// The leg from one place to another.
    pub(crate) fn leg(&self, from: usize, to: usize) -> Leg {
        self.legs[from][to]
    }

    /// What an order of goals comes to, budget or not.
    pub(crate) fn drive(&self, order: &[usize]) -> Drive {
        let (mut at, mut neg_ln_r) = (0, 0.0);
        let mut drive = Drive { length_m: 0.0, prize: 0.0, expected: 0.0, reliability: 1.0 };
        for &goal in order {
            let leg = self.leg(at, goal + 1);
            neg_ln_r += leg.neg_ln_r;
            drive.length_m += leg.length_m;
            drive.prize += self.prizes[goal];
            drive.reliability = libm::exp(-neg_ln_r);
            drive.expected += self.prizes[goal] * drive.reliability;
            at = goal + 1;
        }
        drive
    }

    /// Whether an order of goals is within the budget.
    pub(crate) fn fits(&self, order: &[usize]) -> bool {
        self.drive(order).length_m <= self.budget_m
    }

    /// Length of the shortest way from the start through all goals, wherever it ends, metres (dynamic programming over
    /// sets, Held and Karp 1962).
    pub(crate) fn shortest_way_m(&self) -> f64 {
        let goals = self.prizes.len();
        let all = (1usize << goals) - 1;
        // By the set visited and the goal stood at.
        let mut shortest = vec![f64::INFINITY; (all + 1) * goals];
        for goal in 0..goals {
            shortest[(1 << goal) * goals + goal] = self.leg(0, goal + 1).length_m;
        }
        for set in 1..=all {
            for at in (0..goals).filter(|at| set & 1 << at != 0) {
                let so_far = shortest[set * goals + at];
                for next in (0..goals).filter(|next| set & 1 << next == 0) {
                    let entry = &mut shortest[(set | 1 << next) * goals + next];
                    *entry = entry.min(so_far + self.leg(at + 1, next + 1).length_m);
                }
            }
        }
        shortest[all * goals..].iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Whether the sequencer is told of the hazards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hazards {
    /// As they are.
    Told,
    /// Every leg is said to be safe.
    Hidden,
}

/// An instance as the sequencer sees it: one pose a goal, one way a leg, a metre a second, work at a site for
/// nothing.
pub(crate) struct Posed {
    candidates: Vec<Candidate>,
    travel: TravelMatrix,
    domain: Domain,
    directives: Vec<Directive>,
    budget_m: f64,
}

impl Posed {
    /// Poses an instance.
    pub(crate) fn of(instance: &Instance, hazards: Hazards) -> Self {
        let goals = instance.prizes.len();
        let candidate = |(goal, &prize): (usize, &f64)| {
            Candidate::new(GoalId(goal as u32), 0, prize, vec![goal + 1])
        };
        let nodes: Vec<Cell> = (0..=goals).map(|col| Cell { row: 0, col }).collect();
        let travel = TravelMatrix::from_costs(&nodes, |from, to| {
            let Leg { length_m, neg_ln_r } = instance.leg(from, to);
            let neg_ln_r = if hazards == Hazards::Told { neg_ln_r } else { 0.0 };
            vec![CostVector { length_m, time_s: length_m, energy_j: 0.0, neg_ln_r }]
        });
        let drive = OperatorText { name: DRIVE.to_owned(), ..OperatorText::default() };
        Self {
            candidates: instance.prizes.iter().enumerate().map(candidate).collect(),
            travel,
            domain: Domain::new(&[drive], &[]).expect("driving alone is a domain"),
            directives: vec![visit()],
            budget_m: instance.budget_m,
        }
    }

    /// The problem under a policy, with the default preferences: CC asks for 0.8, and NET's λ is 1.
    pub(crate) fn problem(&self, policy: Policy) -> Problem<'_> {
        Problem {
            candidates: &self.candidates,
            travel: &self.travel,
            ends: &[],
            domain: &self.domain,
            directives: &self.directives,
            facts: FactSet::EMPTY,
            limits: Limits {
                time_s: self.budget_m,
                energy_j: f64::INFINITY,
                data_mb: f64::INFINITY,
                min_reliability: 0.0,
            },
            waiting_w: 0.0,
            policy,
            preferences: Preferences::default(),
        }
    }
}

/// Being there is all that is asked for.
fn visit() -> Directive {
    Directive { max_attempts: 1, ..Directive::new("visit", FactSet::EMPTY) }
}
