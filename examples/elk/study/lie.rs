//! How maps and goals lie against the real stops and targets.

use anyhow::Context;
use rayon::prelude::*;
use wisdom_autonomy::{Derivation, ELEVATION};
use wisdom_belief::Rule;
use wisdom_grid::{Cell, Raster};
use wisdom_mission::{Memory, Mission, run};

use super::auc::{Ends, Groups, Scored, auc, by_cell, by_group, ends, share_by_group};
use super::known::Known;
use super::places::{Places, Point};

/// What is compared, and how.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms {
    /// Ground within this distance of a stop is what targets are held against, cells.
    pub(crate) near: f64,
    /// A goal within this distance of a target has met it, cells.
    pub(crate) met: f64,
    /// Resamples of each bootstrap.
    pub(crate) resamples: usize,
    /// Seed of the bootstraps.
    pub(crate) seed: u64,
}

/// One map against the targets.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// What the map shows.
    pub(crate) name: String,
    /// AUC over all targets, several of which may share a cell.
    pub(crate) auc: f64,
    /// Its interval if every target and cell were an independent draw.
    pub(crate) by_cell: Ends,
    /// Its interval if sols are drawn for the targets, and stops for the ground.
    pub(crate) by_sol: Ends,
    /// Its interval if stops are drawn, with all targets and ground next to each.
    pub(crate) by_stop: Ends,
    /// The AUC in each resample of stops.
    pub(crate) resampled: Vec<f64>,
    /// AUC with every cell that holds targets counted once.
    pub(crate) by_distinct_cell: f64,
    /// AUC against the ground no further from a stop than each of these.
    pub(crate) nearer: Vec<f64>,
}

/// The map that the others are held against: the simplest there is.
pub(crate) const SLOPE: &str = "slope";

/// Radii about the stops that the ground is narrowed to, cells: nearness to a stop matters less and less.
pub(crate) const NEARER: [f64; 2] = [15.0, 7.0];

/// Ground that targets are held against: near a stop, and no target's own cell.
pub(crate) fn ground(places: &Places, mission: &Mission, near: f64) -> Vec<(Cell, usize)> {
    let targets: Vec<Cell> = places.targets.iter().map(|target| target.at.cell()).collect();
    let cells = mission.spec.grid.cells().filter(|cell| !targets.contains(cell));
    cells
        .filter_map(|cell| {
            let (stop, distance) = places.nearest_stop(Point::middle(cell));
            (distance <= near).then_some((cell, stop))
        })
        .collect()
}

/// Every map of the report: the fused ones, each expert, each layer, and the trap.
pub(crate) fn maps(
    known: &Known<'_>,
    rules: &[Rule],
    places: &Places,
) -> anyhow::Result<Vec<(String, Raster<f32>)>> {
    let mut maps = Vec::new();
    for rule in rules {
        maps.push((format!("interest, {rule}"), known.interest(*rule)?));
    }
    for expert in known.experts() {
        maps.push((format!("expert {} alone", expert.name), known.opinion(expert)?));
    }
    let derived = [
        (SLOPE, Derivation::Slope),
        ("gradient", Derivation::Gradient),
        ("step", Derivation::Step),
        ("roughness", Derivation::Roughness),
    ];
    for (name, derivation) in derived {
        maps.push((name.to_owned(), known.derived(derivation)));
    }
    for name in [ELEVATION, "temperature", "texture"] {
        let layer = known.layer(name).with_context(|| format!("no layer `{name}`"))?;
        maps.push((format!("{name}, as it is"), layer.clone()));
    }
    let spec = maps[0].1.spec();
    let near = |cell| -places.nearest_stop(Point::middle(cell)).1 as f32;
    maps.push(("nearness to a stop (trap)".to_owned(), Raster::from_fn(spec, near)));
    Ok(maps)
}

/// How one map ranks the targets over the ground near the stops.
pub(crate) fn line(
    name: &str,
    map: &Raster<f32>,
    places: &Places,
    ground: &[(Cell, usize)],
    terms: &Terms,
) -> anyhow::Result<Line> {
    let at = |cell: Cell| f64::from(map[cell]);
    let scores: Vec<f64> = places.targets.iter().map(|target| at(target.at.cell())).collect();
    let of_ground: Vec<f64> = ground.iter().map(|(cell, _)| at(*cell)).collect();
    let targets = |group: &dyn Fn(usize) -> usize| -> Vec<Scored> {
        let scored = |(n, score): (usize, &f64)| Scored { score: *score, group: group(n) };
        scores.iter().enumerate().map(scored).collect()
    };
    let by_stop: Vec<Scored> =
        ground.iter().map(|(cell, stop)| Scored { score: at(*cell), group: *stop }).collect();
    let stop_of = |n: usize| places.nearest_stop(places.targets[n].at).0;
    let sol_of = |n: usize| places.targets[n].sol as usize;
    let mut cells: Vec<Cell> = places.targets.iter().map(|target| target.at.cell()).collect();
    cells.sort_unstable();
    cells.dedup();
    let distinct: Vec<f64> = cells.into_iter().map(at).collect();
    let nearer = |near: f64| {
        let inside =
            |(cell, _): &&(Cell, usize)| places.nearest_stop(Point::middle(*cell)).1 <= near;
        let scores_there: Vec<f64> =
            ground.iter().filter(inside).map(|(cell, _)| at(*cell)).collect();
        let reached: Vec<f64> = places
            .targets
            .iter()
            .filter(|target| places.nearest_stop(target.at).1 <= near)
            .map(|target| at(target.at.cell()))
            .collect();
        auc(&reached, &scores_there)
    };
    let Terms { resamples, seed, .. } = *terms;
    let resampled = by_group(&targets(&stop_of), &by_stop, Groups::Shared, resamples, seed);
    let found = || {
        Some(Line {
            name: name.to_owned(),
            auc: auc(&scores, &of_ground)?,
            by_cell: by_cell(&scores, &of_ground, resamples, seed)?,
            by_sol: ends(by_group(&targets(&sol_of), &by_stop, Groups::Apart, resamples, seed))?,
            by_stop: ends(resampled.clone())?,
            resampled: resampled.clone(),
            by_distinct_cell: auc(&distinct, &of_ground)?,
            nearer: NEARER.into_iter().map(nearer).collect::<Option<_>>()?,
        })
    };
    found().context("there are targets, and ground near the stops")
}

impl Line {
    /// By how much the AUC of this map is above another's, with the 95 % interval of the difference: the same stops are
    /// drawn for both.
    pub(crate) fn above(&self, other: &Self) -> (f64, Option<Ends>) {
        let pairs = self.resampled.iter().zip(&other.resampled);
        (self.auc - other.auc, ends(pairs.map(|(a, b)| a - b).collect()))
    }
}

/// A share of places that met a target.
#[derive(Debug, Clone)]
pub(crate) struct Share {
    /// What the places are.
    pub(crate) name: String,
    /// How many there are.
    pub(crate) count: usize,
    /// How many of them lie near a target.
    pub(crate) met: usize,
    /// 95 % interval of the share; none without places.
    pub(crate) ends: Option<Ends>,
    /// What was drawn anew for the interval.
    pub(crate) drawn: &'static str,
}

/// The share of some places that met a target, the places in groups.
fn share(
    name: String,
    groups: &[Vec<Cell>],
    drawn: &'static str,
    places: &Places,
    terms: &Terms,
) -> Share {
    let met = |cells: &Vec<Cell>| {
        cells.iter().filter(|cell| places.to_target(Point::middle(**cell)) <= terms.met).count()
    };
    let counted: Vec<(usize, usize)> =
        groups.iter().map(|cells| (cells.len(), met(cells))).collect();
    Share {
        name,
        count: counted.iter().map(|group| group.0).sum(),
        met: counted.iter().map(|group| group.1).sum(),
        ends: share_by_group(&counted, terms.resamples, terms.seed),
        drawn,
    }
}

/// The shares of the sites of the fully known map that met a target, all of them and those near the stops; and of
/// ground near the stops.
pub(crate) fn site_shares(
    known: &Known<'_>,
    rules: &[Rule],
    places: &Places,
    mission: &Mission,
    terms: &Terms,
) -> anyhow::Result<Vec<Share>> {
    let near = |cell: Cell| places.nearest_stop(Point::middle(cell)).1 <= terms.near;
    let mut shares = Vec::new();
    for rule in rules {
        let peaks: Vec<Cell> = known.sites(*rule)?.into_iter().map(|site| site.peak).collect();
        let one_by_one = |cells: Vec<Cell>| cells.into_iter().map(|c| vec![c]).collect::<Vec<_>>();
        let close: Vec<Cell> = peaks.iter().copied().filter(|cell| near(*cell)).collect();
        let all = format!("sites, {rule}, whole ground");
        shares.push(share(all, &one_by_one(peaks), "sites", places, terms));
        let close_by = format!("sites, {rule}, near the stops");
        shares.push(share(close_by, &one_by_one(close), "sites", places, terms));
    }
    // A target's own cells are ground too here: a goal may stand on one.
    let mut by_stop = vec![Vec::new(); places.stops.len()];
    for cell in mission.spec.grid.cells() {
        let (stop, distance) = places.nearest_stop(Point::middle(cell));
        if distance <= terms.near {
            by_stop[stop].push(cell);
        }
    }
    shares.push(share("random ground near the stops".to_owned(), &by_stop, "stops", places, terms));
    Ok(shares)
}

/// The targets of the goals that missions achieved, mission by mission.
pub(crate) fn achieved(
    missions: Vec<Mission>,
    done: impl Fn() + Sync,
) -> anyhow::Result<Vec<Vec<Cell>>> {
    missions
        .into_par_iter()
        .map(|mission| {
            let summary = run(&mission, &mut Memory::default(), &mut |_| true)?;
            done();
            Ok(summary.achieved.into_iter().map(|goal| goal.target).collect())
        })
        .collect()
}

/// The shares of achieved goals that met a target, all of them and those near the stops.
pub(crate) fn goal_shares(
    name: &str,
    runs: &[Vec<Cell>],
    places: &Places,
    terms: &Terms,
) -> [Share; 2] {
    let near = |cell: &Cell| places.nearest_stop(Point::middle(*cell)).1 <= terms.near;
    let close: Vec<Vec<Cell>> =
        runs.iter().map(|run| run.iter().copied().filter(near).collect()).collect();
    let all = format!("goals achieved, {name}, whole ground");
    let close_by = format!("goals achieved, {name}, near the stops");
    [share(all, runs, "runs", places, terms), share(close_by, &close, "runs", places, terms)]
}
