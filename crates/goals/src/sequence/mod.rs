//! The best ordered sets of goals: an orienteering problem whose legs have several costs and whose services depend on
//! the STRIPS facts that earlier goals leave behind.
//!
//! Three parts share one [`Model`] of what a stop does to a plan: a large-neighbourhood search that is never without
//! an answer ([`Improver`]), an exact label search that proves one where it can ([`Search`]), and a Lagrangian bound
//! that says how far off the answer may be where it cannot ([`bound`]).

mod bound;
mod exact;
mod improve;
mod model;
mod net;
mod order;
mod problem;
mod tour;

use std::collections::BTreeSet;

pub use exact::{PrizeFront, prize_front};
pub(crate) use model::{Model, Whole};
pub(crate) use order::Way;
pub use order::weigh;
pub use problem::{
    Candidate, Effort, End, Fade, GoalSequence, Limits, MAX_SEQUENCED, Problem, Proof, Sequences,
    Stop, Window,
};

use bound::Bound;
use exact::{MAX_LABELLED, Mark, Outcome, Search, Until};
use improve::{Allowance, Improver};
use model::Call;

/// Searches for the best sequence.
///
/// A little effort goes into a first answer. Up to 64 goals the label search follows, which may prove it, relative to the
/// goals, poses and leg alternatives given. Where that is cut short, and for more goals, large-neighbourhood search has
/// the rest, and a Lagrangian bound says how far off its answer may be.
///
/// The same problem and number of expansions give the same sequences; with a clock they depend on the machine.
///
/// # Panics
/// If there are more than [`MAX_SEQUENCED`] candidates, or one names a pose or directive that there is not.
#[must_use]
pub fn sequences(problem: &Problem<'_>, effort: Effort<'_>) -> Sequences {
    assert!(
        problem.candidates.len() <= MAX_SEQUENCED,
        "candidates are cut before they are sequenced"
    );
    let mut model = Model::new(*problem);
    let way = model.turns(effort.first).and_then(|turns| {
        // There is no need to be able to end right after what has to come first.
        let calls = model.best_calls(&turns).or_else(|| model.any_calls(&turns))?;
        Some((turns, calls))
    });
    let Some((turns, first)) = way else {
        let best = vec![model.sequence(&[]).unwrap_or_else(|| model.stranded())];
        return Sequences { best, proof: Proof::Proven, expansions: 0 };
    };
    let found = Sequencer::new(&mut model, effort).run(&turns, &first);
    if found.proof == Proof::Proven || !problem.travel.has_alternatives() {
        return found;
    }
    // Alternatives multiply the labels: a search that was cut short may have met less than it would have
    // without them, and more ways must never lead to a worse plan.
    let travel = problem.travel.most_reliable();
    let mut model = Model::new(Problem { travel: &travel, ..*problem });
    let narrow = Sequencer::new(&mut model, effort).run(&turns, &first);
    found.or(narrow, effort.keep)
}

/// The best sequence of each set, at most so many, best first.
fn best_of_sets(mut plans: Vec<GoalSequence>, keep: usize) -> Vec<GoalSequence> {
    plans.sort_by(GoalSequence::rank);
    let mut best: Vec<GoalSequence> = Vec::new();
    let set = |s: &GoalSequence| s.goals().collect::<BTreeSet<_>>();
    for plan in plans {
        if best.len() < keep.max(1) && best.iter().all(|other| set(other) != set(&plan)) {
            best.push(plan);
        }
    }
    best
}

impl Sequences {
    /// What two searches found together, the first having had all the ways that the second had.
    fn or(self, narrower: Self, keep: usize) -> Self {
        let plans = self.best.into_iter().chain(narrower.best).collect();
        let best = best_of_sets(plans, keep);
        let proof = match self.proof {
            Proof::Proven => Proof::Proven,
            Proof::Bound(bound) => Proof::Bound(bound.max(best[0].value)),
        };
        Self { best, proof, expansions: self.expansions + narrower.expansions }
    }
}

/// A search with all its parts.
struct Sequencer<'m, 'a, 'e> {
    model: &'m mut Model<'a>,
    effort: Effort<'e>,
    expansions: u64,
    plans: Vec<GoalSequence>,
}

/// Shares of the effort that have passed when the first answer, and the label search, must be done.
const FIRST_ANSWER: f64 = 0.08;
const LABELS: f64 = 0.25;

impl<'m, 'a, 'e> Sequencer<'m, 'a, 'e> {
    fn new(model: &'m mut Model<'a>, effort: Effort<'e>) -> Self {
        Self { model, effort, expansions: 0, plans: Vec::new() }
    }

    fn run(mut self, turns: &[usize], first: &[Call]) -> Sequences {
        /// Up to so many goals the label search needs no first answer.
        const FEW: usize = 9;
        /// Expansions of a first answer for each goal.
        const GLANCE: u64 = 60;
        let goals = self.model.problem.candidates.len();
        // What has to come first is an answer, if it can end.
        self.plans.extend(self.model.sequence(first));
        let mut improver = Improver::new(self.model, first, self.effort.keep);
        if goals > FEW
            && let Some(improver) = &mut improver
        {
            let glance = (GLANCE * goals as u64).min(self.share(FIRST_ANSWER));
            self.improve(improver, glance, FIRST_ANSWER);
        }
        let mut proof = Proof::Bound(f64::INFINITY);
        if goals <= MAX_LABELLED {
            proof = self.label(turns);
            if proof == Proof::Proven {
                return self.answer(proof);
            }
        }
        let mut bound = Bound::new(self.model);
        self.tighten(&mut bound, 0.08);
        if let Some(improver) = &mut improver
            && !self.is_proven(&bound)
        {
            let most = self.left() - self.left() / 6;
            self.improve(improver, most, 0.85);
        }
        self.tighten(&mut bound, 1.0);
        let bound = bound.value(self.model);
        if let Proof::Bound(labels) = proof {
            let best = self.plans.iter().map(|plan| plan.value).fold(f64::NEG_INFINITY, f64::max);
            // Sums of prizes in another order differ by rounding.
            proof = Proof::Bound(labels.min(bound).max(best));
        }
        self.answer(proof)
    }

    /// So much of all expansions.
    fn share(&self, of: f64) -> u64 {
        (self.effort.expansions as f64 * of) as u64
    }

    fn left(&self) -> u64 {
        self.effort.expansions.saturating_sub(self.expansions)
    }

    /// Large-neighbourhood search until the expansions or the time are over.
    fn improve(&mut self, improver: &mut Improver, expansions: u64, until: f64) {
        let allowance =
            Allowance { expansions: expansions.min(self.left()), clock: self.effort.clock, until };
        self.expansions += improver.run(self.model, &allowance);
        let found: Vec<Vec<Call>> = improver.plans().map(<[Call]>::to_vec).collect();
        for calls in found {
            self.take(&calls, Proof::Bound(f64::INFINITY));
        }
    }

    /// Takes a plan in. Of a search that was cut short the same order may be served better, from other poses or by other
    /// ways.
    fn take(&mut self, calls: &[Call], proof: Proof) {
        self.plans.extend(self.model.sequence(calls));
        if proof != Proof::Proven {
            let turns: Vec<usize> = calls.iter().map(|call| call.candidate).collect();
            self.plans.extend(self.model.best_way(&turns));
        }
    }

    /// Label search for something better than what was found.
    fn label(&mut self, turns: &[usize]) -> Proof {
        /// Up to so many goals the label search may have nearly all of the effort.
        const SURE: usize = 16;
        const NEARLY: f64 = 0.9;
        let goals = self.model.problem.candidates.len();
        let clock = self.effort.clock;
        let until = if goals <= SURE { NEARLY } else { LABELS };
        let over = || clock.is_some_and(|clock| clock() >= until);
        let most = self.share(until).min(self.left());
        let mark =
            self.plans.iter().min_by(|a, b| a.rank(b)).map(|plan| Mark::of(plan, self.model));
        let search = Search::new(self.model, turns, mark);
        let Outcome { best, proof, expansions } =
            search.run(&Until { expansions: most, over: &over }, self.effort.keep);
        self.expansions += expansions;
        for calls in best {
            self.take(&calls, proof);
        }
        proof
    }

    /// Steps of the Lagrangian bound, up to this share of the expansions left or of the time.
    fn tighten(&mut self, bound: &mut Bound, share: f64) {
        let known = self.plans.iter().map(|plan| plan.value).fold(0.0, f64::max);
        let price = bound.price();
        let steps = (self.left() as f64 * share) as u64 / price;
        let clock = self.effort.clock;
        let start = clock.map_or(0.0, |clock| clock());
        let until = if share < 1.0 { start + share * (1.0 - start) } else { 1.0 };
        let over = || clock.is_some_and(|clock| clock() >= until);
        self.expansions += price * bound.improve(known, steps, &over);
    }

    /// Whether the best plan reaches the bound and misses no mandatory goal, so that none can be better but for the order
    /// of ties.
    fn is_proven(&self, bound: &Bound) -> bool {
        let best = self.plans.iter().min_by(|a, b| a.rank(b));
        best.is_some_and(|plan| plan.missed == 0 && plan.value >= bound.value(self.model))
    }

    fn answer(mut self, proof: Proof) -> Sequences {
        let mut best = best_of_sets(std::mem::take(&mut self.plans), self.effort.keep);
        if best.is_empty() {
            best.push(self.model.stranded());
        }
        Sequences { best, proof, expansions: self.expansions }
    }
}
