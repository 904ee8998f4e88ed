//! What is kept of each run of a campaign.

use serde::{Deserialize, Serialize};
use wisdom_goals::Action;

use crate::statistics::{Forecast, brier};
use crate::{Case, RunSummary};

/// The version of [`Row`]: a row of another one is computed again.
pub const ROW_VERSION: u32 = 2;

/// What is kept of one run. Nothing in it depends on the machine, the number of threads or the clock on the wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// [`ROW_VERSION`] when it was written.
    pub version: u32,
    /// Its place in the campaign, from 0.
    pub index: usize,
    /// Seed of its world.
    pub seed: u64,
    /// The rule of combination.
    pub rule: String,
    /// The objective over goal sequences.
    pub policy: String,
    /// What came of it.
    pub result: RowResult,
    /// Digest of all the above (BLAKE3, hexadecimal); empty in rows of version 1, which had none.
    #[serde(default)]
    pub digest: String,
}

/// What came of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RowResult {
    /// It ran to its end.
    Finished(Box<RunRow>),
    /// It could not go on.
    Failed {
        /// Why.
        error: String,
    },
}

/// The numbers of a run that ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRow {
    /// Why it ended, by its name in a log.
    pub status: String,
    /// Decisions taken.
    pub decisions: u32,
    /// Observations made.
    pub observations: u32,
    /// Way driven, metres.
    pub distance_m: f64,
    /// Mission time, seconds.
    pub time_s: f64,
    /// Energy, joules.
    pub energy_j: f64,
    /// Data volume, megabytes.
    pub data_mb: f64,
    /// Chance that a rover survives all steps driven, by the true hazards.
    pub reliability: f64,
    /// Changes of goals after the first decision: added, modified, reordered or dropped.
    pub reallocations: u32,
    /// How often a goal was added, at the first decision too.
    pub added: u32,
    /// How often a goal was modified.
    pub modified: u32,
    /// How often a goal got another turn.
    pub reordered: u32,
    /// How often a goal was dropped.
    pub dropped: u32,
    /// Goals achieved, in order.
    pub goals: Vec<GoalRow>,
    /// The legs driven, in order.
    pub legs: Vec<LegRow>,
    /// Names of the faults that struck, in order.
    pub faults: Vec<String>,
}

/// A goal that was achieved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalRow {
    /// The goal's name.
    pub goal: String,
    /// Its directive's name.
    pub directive: String,
    /// Row of its target, from the north.
    pub row: usize,
    /// Column of its target, from the west.
    pub col: usize,
    /// Interest there on the run's own map when it was achieved.
    pub interest: f64,
    /// Its prize then.
    pub prize: f64,
    /// Interest there on the common ruler.
    pub ruler: f64,
    /// Mission time, seconds.
    pub time_s: f64,
}

/// A leg as predicted and as it went.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LegRow {
    /// Reliability predicted when it was decided.
    pub predicted: f64,
    /// Whether the rover arrived; none if the leg was cut short, which says nothing of the ground.
    pub arrived: Option<bool>,
}

impl Row {
    /// The row of a run that ended.
    #[must_use]
    pub fn finished(case: &Case, summary: &RunSummary) -> Self {
        Self::of(case, RowResult::Finished(Box::new(RunRow::of(summary))))
    }

    /// The row of a run that could not go on.
    #[must_use]
    pub fn failed(case: &Case, error: String) -> Self {
        Self::of(case, RowResult::Failed { error })
    }

    fn of(case: &Case, result: RowResult) -> Self {
        let mut row = Self {
            version: ROW_VERSION,
            index: case.index,
            seed: case.seed,
            rule: case.variant.rule.to_string(),
            policy: case.variant.policy.to_string(),
            result,
            digest: String::new(),
        };
        row.digest = row.content_digest().expect("the numbers of a run fit TOML's");
        row
    }

    /// Digest of everything but the digest. TOML spells every number in one way only, so that rows differ in it if
    /// they differ at all; the seed stands apart as it may be larger than TOML's integers.
    fn content_digest(&self) -> Result<String, toml::ser::Error> {
        let Self { version, index, seed, rule, policy, result, digest: _ } = self;
        let head = format!("{version}\n{index}\n{seed}\n{rule}\n{policy}\n");
        let result = toml::to_string(result)?;
        Ok(blake3::hash((head + &result).as_bytes()).to_hex().to_string())
    }

    /// Whether it is as it was made: its digest is that of its content.
    #[must_use]
    pub fn is_unchanged(&self) -> bool {
        self.content_digest().is_ok_and(|digest| digest == self.digest)
    }

    /// Its numbers, if it ran to its end.
    #[must_use]
    pub fn run(&self) -> Option<&RunRow> {
        match &self.result {
            RowResult::Finished(run) => Some(run),
            RowResult::Failed { .. } => None,
        }
    }

    /// Whether it is the row of that run, as this version writes it.
    #[must_use]
    pub fn is_of(&self, case: &Case) -> bool {
        self.version == ROW_VERSION
            && self.index == case.index
            && self.seed == case.seed
            && self.rule == case.variant.rule.to_string()
            && self.policy == case.variant.policy.to_string()
    }
}

impl RunRow {
    fn of(summary: &RunSummary) -> Self {
        Self {
            status: summary.status.to_string(),
            decisions: summary.decisions,
            observations: summary.observations,
            distance_m: summary.spent.length_m,
            time_s: summary.spent.time_s,
            energy_j: summary.spent.energy_j,
            data_mb: summary.spent.data_mb,
            reliability: summary.reliability(),
            reallocations: summary.reallocations(),
            added: summary.count(Action::Add),
            modified: summary.count(Action::Modify),
            reordered: summary.count(Action::Reorder),
            dropped: summary.count(Action::Drop),
            goals: summary
                .achieved
                .iter()
                .map(|a| GoalRow {
                    goal: a.goal.to_string(),
                    directive: a.directive.clone(),
                    row: a.target.row,
                    col: a.target.col,
                    interest: a.interest,
                    prize: a.prize,
                    ruler: a.ruler,
                    time_s: a.time_s,
                })
                .collect(),
            legs: summary
                .legs
                .iter()
                .map(|leg| LegRow { predicted: leg.predicted, arrived: leg.arrived })
                .collect(),
            faults: summary.faults.iter().map(|fault| fault.name.clone()).collect(),
        }
    }

    /// Interest gained on the run's own map.
    #[must_use]
    pub fn interest(&self) -> f64 {
        self.goals.iter().fold(0.0, |sum, goal| sum + goal.interest)
    }

    /// Interest gained on the common ruler.
    #[must_use]
    pub fn ruler(&self) -> f64 {
        self.goals.iter().fold(0.0, |sum, goal| sum + goal.ruler)
    }

    /// Legs that ended by themselves: the reliability predicted, and whether the rover arrived.
    pub fn forecasts(&self) -> impl Iterator<Item = Forecast> + '_ {
        self.legs
            .iter()
            .filter_map(|leg| Some(Forecast { predicted: leg.predicted, happened: leg.arrived? }))
    }

    /// Mean squared difference between predicted reliability and what happened, over legs that ended by
    /// themselves (Brier 1950); none without such legs.
    #[must_use]
    pub fn brier(&self) -> Option<f64> {
        brier(self.forecasts())
    }
}
