//! One run held against the first of its world.

use wisdom_logbook::comparison::{
    Alignment, AtStates, Divergence, Inputs, at_states, divergence, inputs, partings,
};
use wisdom_logbook::{ReplayError, record::DECISION_VERSION};
use wisdom_mission::{Places, first_difference, jaccard, kendall_tau};

use super::runs::Run;

/// What each of two rules would have chosen at the states of the other's run.
pub(super) enum States {
    /// Nobody asked.
    Unasked,
    /// It cannot be asked, and why.
    Unfit(String),
    Asked {
        /// This run's rule at the first run's states.
        of_first: AtStates,
        /// The first run's rule at this run's states.
        of_this: AtStates,
    },
}

/// How a sequence lines up with the first.
pub(super) struct LinedUp {
    pub(super) jaccard: f64,
    pub(super) tau: Option<f64>,
    /// The stop, from 0, at which the sequences first differ.
    pub(super) stop: Option<usize>,
    pub(super) alignment: Alignment,
}

/// A run held against the first of its world.
pub(super) struct Against {
    pub(super) inputs: Inputs,
    pub(super) divergence: Option<Divergence>,
    /// Decisions that both runs took.
    pub(super) both: usize,
    /// Those of them that chose differently.
    pub(super) apart: usize,
    /// How its sequence lines up with the first run's; none if that lies on another grid.
    pub(super) lined_up: Option<LinedUp>,
    pub(super) states: States,
}

impl Against {
    /// Holds the run at a place in its world against the first.
    pub(super) fn of(
        runs: &[Run],
        place: usize,
        places: &Places,
        ask: bool,
        each: &(dyn Fn(u32) + Sync),
    ) -> Self {
        let (first, this) = (&runs[0], &runs[place]);
        let radius = first.account.identity_radius_cells();
        let (a, b) = (&places.sequences[0], &places.sequences[place]);
        let parted = partings(&first.log, &this.log, radius);
        let one_ground = first.account.mission.spec.grid == this.account.mission.spec.grid;
        let states = if ask && place > 0 { states(first, this, each) } else { States::Unasked };
        Self {
            inputs: inputs(&first.log, &this.log),
            divergence: divergence(&first.log, &this.log, radius),
            both: parted.len(),
            apart: parted.iter().flatten().count(),
            lined_up: one_ground.then(|| LinedUp {
                jaccard: jaccard(a, b),
                tau: kendall_tau(a, b),
                stop: first_difference(a, b),
                alignment: Alignment::between(a, b),
            }),
            states,
        }
    }
}

fn states(first: &Run, this: &Run, each: &(dyn Fn(u32) + Sync)) -> States {
    for run in [first, this] {
        let version = run.fact("decision_version");
        if version != DECISION_VERSION.to_string() {
            let what = format!(
                "{} was decided by version {version} of the core, and this is {DECISION_VERSION}",
                run.name
            );
            return States::Unfit(what);
        }
    }
    let (of_first, of_this) = rayon::join(
        || at_states(&first.log, &this.account.mission, &mut |n| each(n)),
        || at_states(&this.log, &first.account.mission, &mut |n| each(n)),
    );
    match (of_first, of_this) {
        (Ok(of_first), Ok(of_this)) => States::Asked { of_first, of_this },
        // That missions do not fit each other is no failure: there is nothing to ask, and the rest still holds.
        (Err(ReplayError::Unfit { what }), _) | (_, Err(ReplayError::Unfit { what })) => {
            States::Unfit(what)
        }
        (Err(error), _) | (_, Err(error)) => States::Unfit(error.to_string()),
    }
}
