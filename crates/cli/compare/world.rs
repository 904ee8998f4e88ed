//! What comes of comparing the runs of one world.

use std::path::PathBuf;

use wisdom_autonomy::Spent;
use wisdom_logbook::Status;
use wisdom_logbook::comparison::{Measure, Reached, RegretMatrix, final_map, worth_on};
use wisdom_mission::{Label, Places, Ruler, labels_found};

use super::against::Against;
use super::runs::Run;

/// A run of a world and how it stands against the first.
pub(super) struct Compared {
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) rule: String,
    pub(super) policy: String,
    pub(super) status: Status,
    pub(super) ended: Option<String>,
    pub(super) goals: Vec<Reached>,
    pub(super) spent: Spent,
    pub(super) decisions: u32,
    /// Mission time of each decision, seconds, and whether it changed anything about a goal.
    pub(super) decided: Vec<(f64, bool)>,
    pub(super) reallocations: u32,
    pub(super) reliability: Option<f64>,
    pub(super) interest: f64,
    pub(super) ruler: Option<f64>,
    pub(super) labels: Option<f64>,
    pub(super) against: Against,
}

/// What comes of comparing the runs of one world.
pub(super) struct World {
    pub(super) mission: String,
    /// The seeds of its runs: one, unless logs of several were given.
    pub(super) seeds: Vec<String>,
    pub(super) places: Places,
    pub(super) labels: Vec<Label>,
    pub(super) runs: Vec<Compared>,
    /// Empty if the runs lie on different ground.
    pub(super) regret: RegretMatrix,
}

impl World {
    /// Compares some runs. `ask` says whether to ask each rule what it would have chosen at the other's states; `each` is
    /// told of every such decision.
    pub(super) fn of(runs: &[Run], ask: bool, each: &(dyn Fn(u32) + Sync)) -> anyhow::Result<Self> {
        let targets: Vec<_> = runs
            .iter()
            .map(|run| (run.account.identity_radius_cells(), run.account.targets()))
            .collect();
        let places = Places::among(&targets);
        let compared = (0..runs.len())
            .map(|place| compared(&runs[place], Against::of(runs, place, &places, ask, each)))
            .collect();
        let mut seeds: Vec<String> = runs.iter().map(|run| run.fact("seed")).collect();
        seeds.dedup();
        Ok(Self {
            mission: runs[0].fact("mission"),
            seeds,
            labels: runs[0].account.mission.labels.clone(),
            regret: regret(runs)?,
            places,
            runs: compared,
        })
    }

    /// What it is called.
    pub(super) fn title(&self) -> String {
        let what = if self.seeds.len() == 1 { "world of seed" } else { "worlds of seeds" };
        format!("{}, {what} {}", self.mission, self.seeds.join(", "))
    }

    /// The name of a place.
    pub(super) fn place(place: usize) -> String {
        format!("P{}", place + 1)
    }
}

fn compared(run: &Run, against: Against) -> Compared {
    let account = &run.account;
    Compared {
        name: run.name.clone(),
        path: run.path.clone(),
        rule: run.fact("rule"),
        policy: run.fact("policy"),
        status: run.log.status.clone(),
        ended: account.ended.clone(),
        goals: account.goals.clone(),
        spent: account.spent,
        decisions: account.decisions,
        decided: account.decided.clone(),
        reallocations: account.reallocations,
        reliability: account.reliability,
        interest: account.interest(),
        ruler: account.ruler(),
        labels: account.labels(),
        against,
    }
}

/// The sequences on the map each run ended with, on the common ruler, and by labels. The last two are those of the first
/// run's world.
fn regret(runs: &[Run]) -> anyhow::Result<RegretMatrix> {
    let mission = &runs[0].account.mission;
    let grid = mission.spec.grid;
    if runs.iter().any(|run| run.account.mission.spec.grid != grid) {
        return Ok(RegretMatrix::default());
    }
    let targets: Vec<_> = runs.iter().map(|run| run.account.targets()).collect();
    let mut measures = Vec::new();
    for run in runs {
        let map = final_map(&run.log)?;
        let of = |targets: &Vec<_>| map.as_ref().and_then(|map| worth_on(map, targets));
        let totals = targets.iter().map(of).collect();
        measures.push(Measure { name: format!("map of {}", run.name), totals });
    }
    let ruler = Ruler::new(mission);
    let ruled = |targets: &Vec<_>| {
        let mut interests = targets.iter().map(|&target| ruler.interest(target).ok());
        interests.try_fold(0.0, |sum, interest| Some(sum + interest?))
    };
    let totals = targets.iter().map(ruled).collect();
    measures.push(Measure { name: "ruler".to_owned(), totals });
    if !mission.labels.is_empty() {
        let worth = |targets: &Vec<_>| {
            let found = labels_found(&mission.labels, grid, targets).into_iter().flatten();
            Some(found.fold(0.0, |sum, label| sum + mission.labels[label].worth))
        };
        let totals = targets.iter().map(worth).collect();
        measures.push(Measure { name: "labels".to_owned(), totals });
    }
    Ok(RegretMatrix::new(runs.iter().map(|run| run.name.clone()).collect(), measures))
}
