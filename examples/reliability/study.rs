//! The conditions, and the missions run under them.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use wisdom_mission::statistics::{Calibration, Forecast};
use wisdom_mission::{
    LegRecord, Memory, Mission, MissionError, Override, RunStatus, run as run_mission,
};

/// Seeds of a block.
pub(crate) const BLOCK: usize = 200;

/// Bins of the forecasts.
pub(crate) const BINS: usize = 10;

/// What all conditions change in the mission; the page of the program says why.
pub(crate) const COMMON: [(&str, &str); 4] = [
    ("rover.vehicle.hazard-floor-per-m", "2e-3"),
    ("rover.look-every-m", "1e6"),
    ("execution.slip-scatter", "0.0"),
    ("execution.operator-scatter", "0.0"),
];

/// What the rover knows of the ground, and what is true of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Condition {
    /// Its name, in files too.
    pub(crate) key: &'static str,
    /// What it is.
    pub(crate) title: &'static str,
    /// What it changes in the mission, besides [`COMMON`].
    pub(crate) changes: &'static [(&'static str, &'static str)],
}

/// The conditions of the study.
pub(crate) const CONDITIONS: [Condition; 3] = [
    Condition { key: "dem-known", title: "DEM known", changes: &[("prior.kind", "\"complete\"")] },
    Condition { key: "dem-sensed", title: "DEM as sensed", changes: &[] },
    Condition {
        key: "hazard-1.5",
        title: "DEM known, true hazard 1.5 times the model's",
        changes: &[("prior.kind", "\"complete\""), ("execution.hazard-factor", "1.5")],
    },
];

/// Which missions are run.
#[derive(Debug)]
pub(crate) struct Plan {
    /// The mission that is varied.
    pub(crate) mission: PathBuf,
    /// The blocks of seeds.
    pub(crate) blocks: Vec<u64>,
    /// Seeds of each, from its first.
    pub(crate) each: usize,
}

impl Plan {
    /// First and last seed of a block.
    pub(crate) fn ends(&self, block: u64) -> (u64, u64) {
        (1000 * block + 1, 1000 * block + self.each as u64)
    }

    /// All seeds, block by block.
    pub(crate) fn seeds(&self) -> impl Iterator<Item = u64> {
        self.blocks.iter().flat_map(|block| {
            let (first, last) = self.ends(*block);
            first..=last
        })
    }
}

/// What one mission came to.
#[derive(Debug)]
pub(crate) struct Driven {
    pub(crate) seed: u64,
    pub(crate) status: RunStatus,
    pub(crate) legs: Vec<LegRecord>,
}

/// Runs all conditions on all worlds; for each condition, its missions in the order of [`Plan::seeds`], whatever the
/// number of threads.
pub(crate) fn run(plan: &Plan, done: impl Fn() + Sync) -> anyhow::Result<Vec<Vec<Driven>>> {
    let seeds: Vec<u64> = plan.seeds().collect();
    let tasks: Vec<(&Condition, u64)> = CONDITIONS
        .iter()
        .flat_map(|condition| seeds.iter().map(move |seed| (condition, *seed)))
        .collect();
    let driven = tasks
        .into_par_iter()
        .map(|(condition, seed)| {
            let driven = drive(plan, condition, seed)?;
            done();
            Ok(driven)
        })
        .collect::<Vec<anyhow::Result<Driven>>>();
    let mut driven = driven.into_iter().collect::<anyhow::Result<Vec<Driven>>>()?.into_iter();
    Ok(CONDITIONS.iter().map(|_| driven.by_ref().take(seeds.len()).collect()).collect())
}

fn drive(plan: &Plan, condition: &Condition, seed: u64) -> anyhow::Result<Driven> {
    let mission = condition.mission(&plan.mission, seed)?;
    let summary = run_mission(&mission, &mut Memory::default(), &mut |_| true)?;
    Ok(Driven { seed, status: summary.status, legs: summary.legs })
}

impl Condition {
    /// The mission under this condition, in the world of a seed.
    fn mission(&self, path: &Path, seed: u64) -> Result<Mission, MissionError> {
        let mut overrides = vec![Override::new("seed", seed.to_string())];
        let changes = COMMON.iter().chain(self.changes);
        overrides.extend(changes.map(|(key, value)| Override::new(*key, *value)));
        Mission::load(path, &overrides)
    }
}

/// Legs of some missions, counted.
#[derive(Debug)]
pub(crate) struct Count {
    /// The missions.
    pub(crate) missions: usize,
    /// Those whose budget ran out on the way.
    pub(crate) spent: usize,
    /// Legs that came to an end of their own.
    pub(crate) legs: usize,
    /// Legs cut short: they say nothing of the ground and are in no other number.
    pub(crate) cut_short: usize,
    /// Predictions held against what happened; none without legs.
    pub(crate) calibration: Option<Calibration>,
}

impl Count {
    pub(crate) fn of(driven: &[Driven]) -> Self {
        let forecasts: Vec<Forecast> = driven
            .iter()
            .flat_map(|mission| &mission.legs)
            .filter_map(|leg| {
                leg.arrived.map(|happened| Forecast { predicted: leg.predicted, happened })
            })
            .collect();
        let begun: usize = driven.iter().map(|mission| mission.legs.len()).sum();
        Self {
            missions: driven.len(),
            spent: driven.iter().filter(|m| m.status == RunStatus::BudgetSpent).count(),
            legs: forecasts.len(),
            cut_short: begun - forecasts.len(),
            calibration: Calibration::of(&forecasts, BINS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wisdom_autonomy::Act;

    /// The premise of the study: where the DEM is known, a leg is promised the world's own chance of it, and 1.5 times
    /// the hazard is that chance to the power 1.5.
    #[test]
    fn on_known_ground_a_leg_is_promised_the_chance_that_the_world_gives_it() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper");
        for (condition, factor) in [(CONDITIONS[0], 1.0), (CONDITIONS[2], 1.5)] {
            let mission = condition.mission(&folder, 1001).expect("the mission loads");
            let mut record = Memory::default();
            // The first few decisions, looks on arrival between them.
            let mut left = 20;
            let mut watch = |_: &wisdom_mission::Progress<'_>| {
                left -= 1;
                left > 0
            };
            run_mission(&mission, &mut record, &mut watch).expect("the mission runs");
            let mut legs = 0;
            for decision in &record.decisions {
                let Act::Pursue(_) = decision.act else { continue };
                let route = &decision.plan().plan.legs[0].route;
                let steps = route.cells.windows(2);
                let hazard: f64 = steps
                    .map(|pair| {
                        let cost = mission.world.edge(pair[0], pair[1]).expect("ground at hand");
                        cost.expect("known ground is open where the map says so").neg_ln_r
                    })
                    .sum();
                let stated = -route.cost.reliability().ln();
                assert!((hazard - factor * stated).abs() < 1e-9, "{hazard}, stated {stated}");
                legs += usize::from(hazard > 0.0);
            }
            assert!(legs >= 3, "{legs}");
        }
    }

    #[test]
    fn every_condition_loads_and_blocks_share_no_seed() {
        let mission = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper");
        let plan = Plan { mission, blocks: vec![1, 2, 3, 4, 5], each: BLOCK };
        for condition in CONDITIONS {
            condition.mission(&plan.mission, 1).expect("the mission loads");
        }
        let seeds: std::collections::BTreeSet<u64> = plan.seeds().collect();
        assert_eq!(seeds.len(), 1000);
        assert_eq!(seeds.first().zip(seeds.last()), Some((&1001, &5200)));
    }
}
