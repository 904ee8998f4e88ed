//! The instances, the rules, and what they lose.

pub(crate) mod instance;
pub(crate) mod rule;
pub(crate) mod summary;

use rayon::prelude::*;

use instance::{Drive, Generator, Instance};
use rule::{Choice, Rule};

/// A loss up to this is none: the same plan's sums, added in another order, differ by less, and different plans
/// hardly come so near.
pub(crate) const OPTIMAL: f64 = 1e-9;

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Study {
    /// Instances of each generator.
    pub(crate) instances: usize,
    /// Goals of each instance.
    pub(crate) goals: usize,
    /// Seed of the draws.
    pub(crate) seed: u64,
}

/// What a rule found in an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    /// Its plan's numbers.
    pub(crate) drive: Drive,
    /// Goals in its plan.
    pub(crate) goals: usize,
    /// Share of the optimum's J1 that it misses; 0 where the optimum has nothing either.
    pub(crate) loss: f64,
    /// Whether the plan is proven best in the rule's own terms.
    pub(crate) proven: bool,
}

impl Study {
    /// What every rule finds in every instance of a generator, the rules in the order of [`Rule::ALL`]; `advance` is
    /// called after each instance. The same bits at any thread count.
    pub(crate) fn run(&self, generator: &Generator, advance: impl Fn() + Sync) -> Vec<Vec<Found>> {
        (0..self.instances)
            .into_par_iter()
            .map(|number| {
                let found = judge(&Instance::draw(generator, self.goals, self.seed, number));
                advance();
                found
            })
            .collect()
    }
}

/// What every rule finds in an instance, in the order of [`Rule::ALL`].
pub(crate) fn judge(instance: &Instance) -> Vec<Found> {
    let choices = Rule::ALL.map(|rule| rule.choose(instance));
    let optimum = instance.drive(&choices[0].order).expected;
    let found = |Choice { order, proven }: &Choice| {
        let drive = instance.drive(order);
        let loss = if optimum > 0.0 { 1.0 - drive.expected / optimum } else { 0.0 };
        Found { drive, goals: order.len(), loss, proven: *proven }
    };
    choices.iter().map(found).collect()
}
