//! Many worlds: each run against the first of its world, world by world.

use wisdom_logbook::Status;
use wisdom_mission::statistics::{Interval, mean_interval, paired_difference};

use super::world::World;

/// Bootstrap samples of each interval, as in a campaign's summary.
const RESAMPLES: usize = 4000;
/// Seed of the bootstrap: a fixed one, so that equal logs give equal intervals.
const RESAMPLING_SEED: u64 = 1;
/// Below so many worlds, percentile intervals are remarked upon: they cover the true mean clearly less often than stated.
pub(super) const FEW_WORLDS: usize = 10;

/// A number of a run.
pub(super) struct Metric {
    /// Its name, with its unit.
    pub(super) name: &'static str,
    /// In words, for plots.
    pub(super) title: &'static str,
    /// How people are told it, where that is not as it is written down.
    told: Option<Told>,
    of: fn(&World, usize) -> Option<f64>,
    /// Whether it is about two runs already, so that a difference from the first means nothing.
    pub(super) between: bool,
}

/// A number in the unit that people are told.
struct Told {
    name: &'static str,
    /// What one of that unit is.
    unit: f64,
}

impl Metric {
    /// Its name with the unit that people are told.
    pub(super) fn told_name(&self) -> String {
        self.told.as_ref().map_or_else(|| self.name.replace('_', " "), |told| told.name.to_owned())
    }

    /// An interval of it in that unit.
    pub(super) fn told(&self, Interval { mean, low, high }: Interval) -> Interval {
        let unit = self.told.as_ref().map_or(1.0, |told| told.unit);
        Interval { mean: mean / unit, low: low / unit, high: high / unit }
    }
}

/// What is compared over worlds.
pub(super) const METRICS: [Metric; 12] = [
    Metric {
        name: "goals",
        title: "Goals achieved",
        told: None,
        of: |world, run| Some(world.runs[run].goals.len() as f64),
        between: false,
    },
    Metric {
        name: "interest_own_map",
        title: "Interest on the own map",
        told: None,
        of: |world, run| Some(world.runs[run].interest),
        between: false,
    },
    Metric {
        name: "interest_ruler",
        title: "Interest on the common ruler",
        told: None,
        of: |world, run| world.runs[run].ruler,
        between: false,
    },
    Metric {
        name: "labels",
        title: "Worth of labels found",
        told: None,
        of: |world, run| world.runs[run].labels,
        between: false,
    },
    Metric {
        name: "distance_m",
        title: "Distance driven",
        told: Some(Told { name: "distance, m", unit: 1.0 }),
        of: |world, run| Some(world.runs[run].spent.length_m),
        between: false,
    },
    Metric {
        name: "time_s",
        title: "Mission time",
        told: Some(Told { name: "time, h", unit: 3600.0 }),
        of: |world, run| Some(world.runs[run].spent.time_s),
        between: false,
    },
    Metric {
        name: "energy_j",
        title: "Energy spent",
        told: Some(Told { name: "energy, MJ", unit: 1e6 }),
        of: |world, run| Some(world.runs[run].spent.energy_j),
        between: false,
    },
    Metric {
        name: "reallocations",
        title: "Reallocations",
        told: None,
        of: |world, run| Some(f64::from(world.runs[run].reallocations)),
        between: false,
    },
    Metric {
        name: "reliability",
        title: "Reliability of all that was driven",
        told: None,
        of: |world, run| world.runs[run].reliability,
        between: false,
    },
    Metric {
        name: "jaccard",
        title: "Jaccard index of the places",
        told: None,
        of: |world, run| Some(world.runs[run].against.lined_up.as_ref()?.jaccard),
        between: true,
    },
    Metric {
        name: "kendall_tau",
        title: "Kendall's tau of their order",
        told: None,
        of: |world, run| world.runs[run].against.lined_up.as_ref()?.tau,
        between: true,
    },
    Metric {
        name: "edit_distance",
        title: "Edit distance of the sequences",
        told: None,
        of: |world, run| {
            let lined_up = world.runs[run].against.lined_up.as_ref()?;
            Some(lined_up.alignment.distance() as f64)
        },
        between: true,
    },
];

/// A metric of one run over the worlds.
pub(super) struct Row {
    pub(super) metric: &'static Metric,
    /// The run, by its place in each world.
    pub(super) run: usize,
    /// Worlds in which it and the first run have the number.
    pub(super) worlds: usize,
    pub(super) mean: Option<Interval>,
    /// Less the first run's, world by world; none for the first, and for what is about two runs already.
    pub(super) difference: Option<Interval>,
}

/// Every metric of every run over the worlds.
pub(super) struct Paired {
    pub(super) mission: String,
    pub(super) seeds: Vec<String>,
    pub(super) names: Vec<String>,
    /// The names in tables: with a star if a log of theirs is not whole.
    pub(super) marked: Vec<String>,
    pub(super) rows: Vec<Row>,
}

impl Paired {
    /// None for a single world: it says nothing of how worlds differ.
    pub(super) fn of(worlds: &[World]) -> Option<Self> {
        let first = worlds.first().filter(|_| worlds.len() > 1)?;
        let mut rows = Vec::new();
        for metric in &METRICS {
            for run in usize::from(metric.between)..first.runs.len() {
                let pairs: Vec<(f64, f64)> = worlds
                    .iter()
                    .filter_map(|world| {
                        let own = (metric.of)(world, run)?;
                        let of_first = if metric.between { own } else { (metric.of)(world, 0)? };
                        Some((own, of_first))
                    })
                    .collect();
                let (own, of_first): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
                let difference = || paired_difference(&own, &of_first, RESAMPLES, RESAMPLING_SEED);
                rows.push(Row {
                    metric,
                    run,
                    worlds: own.len(),
                    mean: mean_interval(&own, RESAMPLES, RESAMPLING_SEED),
                    difference: (run > 0 && !metric.between).then(difference).flatten(),
                });
            }
        }
        rows.retain(|row| row.worlds > 0);
        Some(Self {
            mission: first.mission.clone(),
            seeds: worlds.iter().map(|world| world.seeds.join("+")).collect(),
            marked: (0..first.runs.len())
                .map(|run| {
                    let mut of_worlds = worlds.iter().map(|world| &world.runs[run]);
                    let star = of_worlds.find(|run| run.status != Status::Complete);
                    star.unwrap_or(&first.runs[run]).marked()
                })
                .collect(),
            names: first.runs.iter().map(|run| run.name.clone()).collect(),
            rows,
        })
    }

    /// The row of a metric and a run.
    pub(super) fn row(&self, metric: &str, run: usize) -> Option<&Row> {
        self.rows.iter().find(|row| row.metric.name == metric && row.run == run)
    }
}
