//! The rules held against the optimum: objectives solved to the end, and what is done by hand.

use wisdom_goals::{Effort, Policy, Proof, sequences};

use super::instance::{Hazards, Instance, Posed};

/// Expansions allowed to the sequencer; a dozen goals need a small part of them.
const EXPANSIONS: u64 = 20_000_000;

/// A way to choose goals and their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The best plan under a policy.
    Best(Policy),
    /// J0: the greatest sum of prizes, the shortest of such plans, every leg taken to be safe.
    MostPrize,
    /// Again and again to the goal within reach with the most reliability × prize per metre of the leg to it.
    NextByExpectedRate,
    /// Again and again to the goal within reach with the most prize per metre of the leg to it.
    NextByRate,
    /// Goals by falling prize, each put where it lengthens the plan least, if it still fits.
    PlacedByPrize,
    /// Goals by falling prize, each put at the end of the plan, if it still fits.
    NextByPrize,
}

/// What a rule chose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Choice {
    /// Goals in the order of their visit.
    pub(crate) order: Vec<usize>,
    /// Whether it is proven best in the rule's own terms; rules done by hand are what they are.
    pub(crate) proven: bool,
}

impl Rule {
    /// All rules; the first is the one that the others are held against.
    pub(crate) const ALL: [Self; 10] = [
        Self::Best(Policy::ExpectedInterest),
        Self::Best(Policy::NetBenefit),
        Self::Best(Policy::AllOrNothing),
        Self::Best(Policy::ChanceConstrained),
        Self::Best(Policy::MostInteresting),
        Self::MostPrize,
        Self::NextByExpectedRate,
        Self::NextByRate,
        Self::PlacedByPrize,
        Self::NextByPrize,
    ];

    /// Its short name.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Best(Policy::ExpectedInterest) => "j1",
            Self::Best(Policy::NetBenefit) => "net",
            Self::Best(Policy::AllOrNothing) => "j2",
            Self::Best(Policy::ChanceConstrained) => "cc",
            Self::Best(Policy::MostInteresting) => "lex",
            Self::Best(_) => unreachable!("not one of the rules"),
            Self::MostPrize => "j0",
            Self::NextByExpectedRate => "greedy-reliable-rate",
            Self::NextByRate => "greedy-rate",
            Self::PlacedByPrize => "greedy-placed",
            Self::NextByPrize => "greedy-in-turn",
        }
    }

    /// Its name for readers.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Best(Policy::ExpectedInterest) => "J1 (optimum)",
            Self::Best(Policy::NetBenefit) => "NET, lambda = 1",
            Self::Best(Policy::AllOrNothing) => "J2",
            Self::Best(Policy::ChanceConstrained) => "CC, 0.8",
            Self::Best(Policy::MostInteresting) => "LEX",
            Self::Best(_) => unreachable!("not one of the rules"),
            Self::MostPrize => "J0, no reliability",
            Self::NextByExpectedRate => "greedy R x interest / cost",
            Self::NextByRate => "greedy interest / cost",
            Self::PlacedByPrize => "greedy interest, placed",
            Self::NextByPrize => "greedy interest, in turn",
        }
    }

    /// The goals it chooses, and their order.
    pub(crate) fn choose(self, instance: &Instance) -> Choice {
        let by_hand = |order| Choice { order, proven: true };
        match self {
            Self::Best(policy) => best(instance, policy, Hazards::Told),
            // Where every leg is safe, J1 is the sum of the prizes, and ties go to the shorter way.
            Self::MostPrize => best(instance, Policy::ExpectedInterest, Hazards::Hidden),
            Self::NextByExpectedRate => by_hand(next_by(instance, |at, goal| {
                let leg = instance.leg(at, goal + 1);
                libm::exp(-leg.neg_ln_r) * instance.prizes[goal] / leg.length_m
            })),
            Self::NextByRate => by_hand(next_by(instance, |at, goal| {
                instance.prizes[goal] / instance.leg(at, goal + 1).length_m
            })),
            Self::PlacedByPrize => by_hand(placed_by_prize(instance)),
            Self::NextByPrize => by_hand(next_by(instance, |_, goal| instance.prizes[goal])),
        }
    }
}

fn best(instance: &Instance, policy: Policy, hazards: Hazards) -> Choice {
    let posed = Posed::of(instance, hazards);
    let effort = Effort { expansions: EXPANSIONS, keep: 1, first: &[], clock: None };
    let found = sequences(&posed.problem(policy), effort);
    Choice {
        order: found.best[0].goals().map(|goal| goal.0 as usize).collect(),
        proven: found.proof == Proof::Proven,
    }
}

/// Goes to the goal of the highest score from where it stands, as long as one fits; of equals the first.
fn next_by(instance: &Instance, score: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::new();
    loop {
        let at = order.last().map_or(0, |goal| goal + 1);
        let next = (0..instance.prizes.len())
            .filter(|goal| {
                !order.contains(goal) && instance.fits(&with(&order, order.len(), *goal))
            })
            .max_by(|&a, &b| score(at, a).total_cmp(&score(at, b)).then(b.cmp(&a)));
        match next {
            Some(goal) => order.push(goal),
            None => return order,
        }
    }
}

/// Puts the goals into the plan by falling prize, each where it lengthens it least (of equal places the first); those
/// that do not fit stay out.
fn placed_by_prize(instance: &Instance) -> Vec<usize> {
    let mut goals: Vec<usize> = (0..instance.prizes.len()).collect();
    goals.sort_by(|&a, &b| instance.prizes[b].total_cmp(&instance.prizes[a]).then(a.cmp(&b)));
    let mut order: Vec<usize> = Vec::new();
    for goal in goals {
        let length = |plan: &Vec<usize>| instance.drive(plan).length_m;
        let shortest = (0..=order.len())
            .map(|place| with(&order, place, goal))
            .min_by(|a, b| length(a).total_cmp(&length(b)))
            .expect("a plan has at least one place for a goal");
        if instance.fits(&shortest) {
            order = shortest;
        }
    }
    order
}

fn with(order: &[usize], place: usize, goal: usize) -> Vec<usize> {
    let mut order = order.to_vec();
    order.insert(place, goal);
    order
}
