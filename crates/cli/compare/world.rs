//! What comes of comparing the runs of one world.

use std::path::PathBuf;

use wisdom_autonomy::Spent;
use wisdom_grid::{Cell, GridSpec};
use wisdom_logbook::Status;
use wisdom_logbook::comparison::{Measure, Reached, RegretMatrix, final_map, worth_on};
use wisdom_mission::{Label, Places, Ruler, labels_found};

use super::against::Against;
use super::runs::Run;
use crate::run::clock;

/// A run of a world and how it stands against the first.
pub(super) struct Compared {
    pub(super) name: String,
    pub(super) mission: String,
    /// The ground it drove on.
    pub(super) grid: GridSpec,
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
    /// The places of its mission that are known to be worth a visit.
    pub(super) known: Vec<Label>,
    pub(super) against: Against,
}

impl Compared {
    /// Its name in tables: with a star if its log is not whole.
    pub(super) fn marked(&self) -> String {
        let star = if self.status == Status::Complete { "" } else { "*" };
        format!("{}{star}", self.name)
    }

    /// The name of the label that a goal of it found.
    pub(super) fn label(&self, goal: &Reached) -> Option<&str> {
        goal.label.map(|label| self.known[label].name.as_str())
    }

    /// What a star says, if there is one.
    fn footnote(&self) -> Option<String> {
        let read = clock(self.spent.time_s);
        match (&self.status, &self.ended) {
            (Status::Complete, _) => None,
            (Status::Corrupt { .. }, _) => {
                Some(format!("the log is damaged after {read}: counts are of what comes before"))
            }
            (Status::Truncated { .. }, Some(_)) => {
                Some("the log has the end of the run, but not its own".to_owned())
            }
            (Status::Truncated { .. }, None) => {
                Some(format!("the log ends at {read}, before the run did: counts are of that much"))
            }
        }
    }
}

/// What comes of comparing the runs of one world.
pub(super) struct World {
    pub(super) mission: String,
    /// The seeds of its runs: one, unless logs of several were given.
    pub(super) seeds: Vec<String>,
    pub(super) places: Places,
    pub(super) runs: Vec<Compared>,
    /// Empty if the runs lie on different ground.
    pub(super) regret: RegretMatrix,
}

impl World {
    /// Compares some runs. `ask` says whether to ask each rule what it would have chosen at the other's states; `each` is
    /// told of every such decision.
    pub(super) fn of(runs: &[Run], ask: bool, each: &(dyn Fn(u32) + Sync)) -> anyhow::Result<Self> {
        let places = places(runs);
        let compared = (0..runs.len())
            .map(|place| compared(&runs[place], Against::of(runs, place, &places, ask, each)))
            .collect();
        let mut seeds: Vec<String> = runs.iter().map(|run| run.fact("seed")).collect();
        seeds.dedup();
        Ok(Self {
            mission: runs[0].fact("mission"),
            seeds,
            regret: regret(runs)?,
            places,
            runs: compared,
        })
    }

    /// What it is called.
    pub(super) fn title(&self) -> String {
        let what = if self.seeds.len() == 1 { "world of seed" } else { "worlds of seeds" };
        format!("{}, {what} {}", self.missions().join(" and "), self.seeds.join(", "))
    }

    /// What a star beside a name in its tables says, a line each run that has one.
    pub(super) fn footnotes(&self) -> Vec<String> {
        let told: Vec<(&str, String)> =
            self.runs.iter().filter_map(|run| Some((run.name.as_str(), run.footnote()?))).collect();
        match &told[..] {
            [(_, only)] => vec![format!("* {only}")],
            _ => told.iter().map(|(name, what)| format!("* {name}: {what}")).collect(),
        }
    }

    /// The missions of its runs, each once.
    fn missions(&self) -> Vec<&str> {
        let mut missions: Vec<&str> = Vec::new();
        for run in &self.runs {
            if !missions.contains(&run.mission.as_str()) {
                missions.push(&run.mission);
            }
        }
        missions
    }

    /// Whether all its runs drove on the same grid.
    pub(super) fn one_ground(&self) -> bool {
        self.runs.iter().all(|run| run.grid == self.runs[0].grid)
    }

    /// What is to be known before the tables are read: that the runs are of different missions, or on different ground.
    pub(super) fn warning(&self) -> Option<String> {
        let missions = self.missions();
        let left_out = "what needs a common ground is left out";
        if self.one_ground() {
            (missions.len() > 1).then(|| {
                format!(
                    "these are runs of different missions: {}; on grids alike, so places are held \
                     against each other cell by cell",
                    missions.join(", ")
                )
            })
        } else if missions.len() > 1 {
            let told = missions.join(", ");
            Some(format!("these are runs of different missions: {told}; {left_out}"))
        } else {
            let mut grounds: Vec<String> = Vec::new();
            for run in &self.runs {
                let ground = ground(run.grid);
                if !grounds.contains(&ground) {
                    grounds.push(ground);
                }
            }
            let told = match &grounds[..] {
                [only] => format!("{only} at different places"),
                _ => grounds.join(", "),
            };
            Some(format!("these are runs on different ground: {told}; {left_out}"))
        }
    }

    /// The name of a place.
    pub(super) fn place(place: usize) -> String {
        format!("P{}", place + 1)
    }
}

/// A grid in words.
fn ground(grid: GridSpec) -> String {
    format!("{} x {} cells of {} m", grid.rows(), grid.cols(), grid.spacing_m())
}

/// The places that the runs reached. Those of runs on different grids are never the same.
fn places(runs: &[Run]) -> Places {
    let grid = |run: &Run| run.account.mission.spec.grid;
    let mut all = Places { places: Vec::new(), sequences: vec![Vec::new(); runs.len()] };
    for (leader, first) in runs.iter().enumerate() {
        if runs[..leader].iter().any(|before| grid(before) == grid(first)) {
            continue;
        }
        let of_ground: Vec<usize> =
            (leader..runs.len()).filter(|&run| grid(&runs[run]) == grid(first)).collect();
        let targets: Vec<(f64, Vec<Cell>)> = of_ground
            .iter()
            .map(|&run| &runs[run].account)
            .map(|account| (account.identity_radius_cells(), account.targets()))
            .collect();
        let found = Places::among(&targets);
        let before = all.places.len();
        all.places.extend(found.places);
        for (run, sequence) in of_ground.into_iter().zip(found.sequences) {
            all.sequences[run] = sequence.into_iter().map(|place| before + place).collect();
        }
    }
    all
}

fn compared(run: &Run, against: Against) -> Compared {
    let account = &run.account;
    Compared {
        name: run.name.clone(),
        mission: run.fact("mission"),
        grid: account.mission.spec.grid,
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
        known: account.mission.labels.clone(),
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
