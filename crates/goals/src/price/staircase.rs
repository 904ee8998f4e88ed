//! The prices of limits, off a staircase: all decisions from the limit there is to none at all.
//!
//! A decision that is proven at some level of a limit stays the same down to the level that its sequence (and the committed
//! one, which it is held against) uses up: what was best among more is best among fewer. One solve so settles an interval,
//! and one just below it the next. Where that is too much work the widest gap is halved first.

use std::collections::BTreeSet;

use super::{Choice, Known, Lever, Price};
use crate::{GoalId, Proof, Selection};

/// Solves for one goal alone, after those for all.
const OF_ONE_GOAL: usize = 16;
/// A gap between two decisions that are not proven is left alone when it is this small a share of the change.
const FINE: f64 = 0.005;

/// Levels at which one decision is taken.
#[derive(Debug, Clone)]
struct Step {
    from: f64,
    to: f64,
    goals: BTreeSet<GoalId>,
    proven: bool,
    /// Whether a solve above met the same decision.
    grown: bool,
}

struct Staircase<'c, 'a> {
    choice: &'c Choice<'a>,
    lever: Lever,
    /// The level there is.
    ground: f64,
    /// In order, with gaps.
    steps: Vec<Step>,
    solves: usize,
    /// The decision without the limit.
    top: Selection,
}

pub(super) fn prices(
    choice: &Choice<'_>,
    lever: Lever,
    goals: &[GoalId],
    solves: usize,
) -> Vec<Price> {
    let mut stairs = Staircase::new(choice, lever);
    while stairs.solves < solves {
        let Some(level) = stairs.widest_gap(goals) else { break };
        stairs.solve(level);
    }
    goals.iter().map(|goal| stairs.price(*goal)).collect()
}

impl<'c, 'a> Staircase<'c, 'a> {
    fn new(choice: &'c Choice<'a>, lever: Lever) -> Self {
        let (ground, unlimited) = (lever.level(&choice.problem), lever.unlimited());
        let top = choice.at(lever, unlimited).decide();
        let mut stairs = Self { choice, lever, ground, steps: Vec::new(), solves: 1, top };
        let step = stairs.step(&stairs.top, unlimited);
        let used = stairs.used(&stairs.top).max(ground);
        stairs.steps.push(step);
        if ground < unlimited {
            stairs.solve(ground);
            stairs.solve(used);
        }
        stairs
    }

    /// The level below which a decision could not have been the same.
    fn used(&self, selection: &Selection) -> f64 {
        let best = self.lever.needs(&selection.family[0]);
        selection.committed.as_ref().map_or(best, |c| best.max(self.lever.needs(c)))
    }

    fn step(&self, selection: &Selection, level: f64) -> Step {
        let proven = selection.proof == Proof::Proven;
        let from = if proven { self.used(selection).max(self.ground).min(level) } else { level };
        let goals = selection.sequence().goals().collect();
        Step { from, to: level, goals, proven, grown: false }
    }

    /// The step that a level lies on; decides anew if none is known.
    fn solve(&mut self, level: f64) -> usize {
        let above = self.steps.partition_point(|step| step.to < level);
        if self.steps.get(above).is_some_and(|step| step.from <= level) {
            return above;
        }
        self.solves += 1;
        let selection = self.choice.at(self.lever, level).decide();
        let mut step = self.step(&selection, level);
        if let Some(below) = above.checked_sub(1).map(|below| &mut self.steps[below])
            && step.from <= below.to
        {
            if below.goals == step.goals && below.proven && step.proven {
                below.to = level;
                below.grown = true;
                return above - 1;
            }
            step.from = below.to.next_up().min(level);
        }
        self.steps.insert(above, step);
        above
    }

    /// Where to decide next: in the gap that is the largest share of the change that leads over it, counted once for
    /// each goal that no lower step holds.
    fn widest_gap(&self, goals: &[GoalId]) -> Option<f64> {
        let mut open: BTreeSet<GoalId> = goals.iter().copied().collect();
        let mut best: Option<(f64, f64)> = None;
        for pair in self.steps.windows(2) {
            let (below, above) = (&pair[0], &pair[1]);
            open.retain(|goal| !below.goals.contains(goal));
            let Some(level) = self.inside(below, above) else { continue };
            let share = (above.from - below.to) / (above.from - self.ground);
            let score = share * open.len() as f64;
            if score > best.map_or(0.0, |(most, _)| most) {
                best = Some((score, level));
            }
        }
        best.map(|(_, level)| level)
    }

    /// A level between two steps: just below the upper one if the lower one may reach up to it, else half-way. None if
    /// nothing is left between them, or too little to be worth a solve that proves nothing.
    fn inside(&self, below: &Step, above: &Step) -> Option<f64> {
        let last = above.from.next_down();
        if last <= below.to || above.from == f64::INFINITY {
            return None;
        }
        let small = (above.from - below.to) <= FINE * (above.from - self.ground);
        if small && !(above.proven && below.proven) {
            return None;
        }
        let middle = below.to + (above.from - below.to) / 2.0;
        Some(if below.grown || small || middle <= below.to { last } else { middle.min(last) })
    }

    fn price(&mut self, goal: GoalId) -> Price {
        let most = self.solves + OF_ONE_GOAL;
        loop {
            let Some(first) = self.steps.iter().position(|step| step.goals.contains(&goal)) else {
                let complete = self.is_complete(self.steps.len());
                let loose = self.choice.at(self.lever, self.lever.unlimited());
                let known = if complete { Known::Exactly } else { Known::Searched };
                return loose.barrier(goal, Some(self.lever), &self.top).price(known);
            };
            let change = self.change_to(self.steps[first].from);
            if !change.is_finite() {
                return Price::Unknown;
            }
            let complete = self.is_complete(first + 1);
            let known = if complete { Known::Exactly } else { Known::Searched };
            if first == 0 || self.is_least(goal, change) {
                return Price::Least { change, known };
            }
            if self.solves >= most {
                return Price::Unknown;
            }
            if let Some(first) = self.steps.iter().position(|step| step.goals.contains(&goal))
                && first > 0
                && let Some(level) = self.inside(&self.steps[first - 1], &self.steps[first])
            {
                self.solve(level);
            }
        }
    }

    /// Whether a goal is in at a change and out at 1 % less.
    fn is_least(&mut self, goal: GoalId, change: f64) -> bool {
        let at = self.solve(self.ground + change);
        if !self.steps[at].goals.contains(&goal) {
            return false;
        }
        let under = self.solve(self.ground + change * 0.99);
        !self.steps[under].goals.contains(&goal)
    }

    /// Whether the decision is known at every level of the first steps and between them.
    fn is_complete(&self, count: usize) -> bool {
        let steps = &self.steps[..count];
        steps.iter().all(|step| step.proven)
            && steps.windows(2).all(|pair| pair[1].from <= pair[0].to.next_up())
    }

    /// The smallest change that leads to a level, when it is added to the limit there is.
    fn change_to(&self, level: f64) -> f64 {
        let mut change = level - self.ground;
        while self.ground + change < level {
            change = change.next_up();
        }
        change
    }
}
