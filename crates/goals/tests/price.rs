//! Price tags: applying one brings the goal in, 1 % less does not, and nothing smaller does.

mod oracle;
#[expect(dead_code, reason = "no ground is driven on here")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Choice, GoalId, Known, Lever, Limits, ManagerSpec, Policy, Price, PrizeQuestion,
    price_tag,
};

use oracle::{Draws, Instance, best_plan};

/// Settings of a lever tried below each price.
const GRID: usize = 200;

/// Enough for every instance here.
fn spec() -> ManagerSpec {
    ManagerSpec { expansions: 2_000_000, ..ManagerSpec::default() }
}

/// A decision in the midst of a mission: an order committed to, which need not be a good one, and a leg under way.
struct Midst {
    instance: Instance,
    spec: ManagerSpec,
    agenda: Vec<GoalId>,
    pinned: Option<GoalId>,
    policy: Policy,
}

impl Midst {
    fn drawn(goals: usize, alternatives: usize, policy: Policy, seed: u64) -> Self {
        let instance = oracle::drawn(goals, 1, alternatives, goals.min(3), seed);
        let mut draws = Draws(seed ^ 0x5EED);
        let mut agenda: Vec<GoalId> =
            instance.candidates.iter().map(|c| c.goal).filter(|_| draws.happens(0.3)).collect();
        if draws.happens(0.5) {
            agenda.reverse();
        }
        let pinned = agenda.first().copied().filter(|_| draws.happens(0.3));
        if draws.happens(0.3) {
            agenda.clear();
        }
        Self { instance, spec: spec(), agenda, pinned, policy }
    }

    fn choice(&self) -> Choice<'_> {
        Choice {
            problem: self.instance.problem(self.policy),
            spec: &self.spec,
            agenda: &self.agenda,
            pinned: self.pinned,
        }
    }

    /// The goals that the decision leaves out.
    fn out(&self) -> Vec<GoalId> {
        let chosen = self.choice().decide();
        let all = self.instance.candidates.iter().map(|c| c.goal);
        all.filter(|goal| !chosen.sequence().goals().any(|id| id == *goal)).collect()
    }

    fn prized(&self, goal: GoalId, prize: f64) -> Vec<Candidate> {
        let mut candidates = self.instance.candidates.clone();
        for candidate in candidates.iter_mut().filter(|c| c.goal == goal) {
            candidate.prize = prize;
        }
        candidates
    }

    fn holds_at(&self, goal: GoalId, lever: Lever, change: f64) -> bool {
        holds(&self.choice().loosened(lever, change), goal)
    }

    fn holds_for(&self, goal: GoalId, change: f64) -> bool {
        let now = self.instance.candidates.iter().find(|c| c.goal == goal).expect("it is one");
        let none = |_| Vec::new();
        let asked = PrizeQuestion { goal, now: now.prize, least: now.prize, candidates: &none };
        holds(&self.choice().among(&self.prized(goal, asked.prize(change))), goal)
    }
}

fn holds(choice: &Choice<'_>, goal: GoalId) -> bool {
    choice.decide().sequence().goals().any(|id| id == goal)
}

/// What became of the prices of some instances.
#[derive(Debug, Default)]
struct Tally {
    least: usize,
    nothing: usize,
    searched: usize,
    unknown: usize,
}

/// Holds a price against decisions taken anew, `holds_at` being one of them.
fn check(price: &Price, loosest: f64, holds_at: impl Fn(f64) -> bool, tally: &mut Tally) {
    match price {
        Price::Least { change, known } => {
            tally.least += 1;
            assert!(*change > 0.0, "a goal that is out has a price");
            assert!(holds_at(*change), "{price:?} does not bring it in");
            assert!(!holds_at(0.99 * change), "99 % of {price:?} brings it in");
            if *known == Known::Exactly {
                for step in 1..GRID {
                    let less = 0.99 * change * step as f64 / GRID as f64;
                    assert!(!holds_at(less), "{less} brings it in, and {price:?} is told");
                }
            } else {
                tally.searched += 1;
            }
        }
        Price::Nothing { known, .. } => {
            tally.nothing += 1;
            assert!(!holds_at(loosest), "{price:?}, and yet it is in");
            tally.searched += usize::from(*known == Known::Searched);
        }
        Price::Unknown => tally.unknown += 1,
    }
}

fn check_tags(midst: &Midst, tally: &mut Tally) {
    for goal in midst.out() {
        let tag = price_tag(&midst.choice(), goal, 400);
        let at = |lever| move |change| midst.holds_at(goal, lever, change);
        check(&tag.energy_j, f64::INFINITY, at(Lever::Energy), tally);
        check(&tag.time_s, f64::INFINITY, at(Lever::Time), tally);
        check(&tag.reliability, 1.0, at(Lever::Reliability), tally);
        check(&tag.prize, 65_000.0, |change| midst.holds_for(goal, change), tally);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn a_price_brings_its_goal_in_and_less_does_not(
        goals in 2usize..=5,
        alternatives in 1usize..=2,
        policy in prop::sample::select(&Policy::ALL[..]),
        seed in any::<u64>(),
    ) {
        check_tags(&Midst::drawn(goals, alternatives, policy, seed), &mut Tally::default());
    }
}

/// Small instances are searched to the end: their prices are exact.
#[test]
fn small_instances_have_exact_prices() {
    let mut tally = Tally::default();
    for seed in 0..40 {
        let policy = Policy::ALL[seed as usize % Policy::ALL.len()];
        check_tags(&Midst::drawn(4, 1, policy, seed), &mut tally);
    }
    assert_eq!((tally.searched, tally.unknown), (0, 0), "{tally:?}");
    assert!(tally.least >= 40 && tally.nothing >= 40, "too little was asked: {tally:?}");
}

/// The price of energy against trying every plan: sums of prizes are exact, so that both must agree.
#[test]
fn the_price_of_energy_is_that_of_trying_everything() {
    let mut priced = 0;
    for seed in 0..60 {
        let mut midst = Midst::drawn(4, 2, Policy::MostInteresting, seed);
        (midst.agenda, midst.pinned) = (Vec::new(), None);
        // Energy alone is short.
        let energy_j = 20_000.0 + 1_000.0 * seed as f64;
        midst.instance.limits = Limits { energy_j, ..oracle::NO_LIMITS };
        let choice = midst.choice();
        for goal in midst.out() {
            let price = choice.prices(Lever::Energy, &[goal], 400).swap_remove(0);
            let best = |change| {
                let problem = choice.loosened(Lever::Energy, change).problem;
                best_plan(&problem, |_| true).is_some_and(|plan| plan.goals.contains(&goal))
            };
            match price.change() {
                Some(change) => {
                    assert!(best(change) && !best(0.99 * change), "seed {seed}, {goal}: {price:?}");
                    priced += 1;
                }
                None => assert!(!best(f64::INFINITY), "seed {seed}, {goal}: {price:?}"),
            }
        }
    }
    assert!(priced >= 20, "only {priced} goals had a price");
}
