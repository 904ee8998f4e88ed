//! The comparison in pictures.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use wisdom_autonomy::{ELEVATION, Spent};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_logbook::comparison::{Alignment, Edit, final_map, observed};
use wisdom_mission::statistics::Interval;

use super::paired::{FEW_WORLDS, METRICS, Paired, Row};
use super::runs::Run;
use super::world::{Compared, World};
use crate::chart::{Course, Curve, Intervals, Lane, Lanes, Link, Steps, Stop, Timeline};
use crate::figure::{ColourMap, Figure, Ink, Markers, Shape, Sheet, Stroke, Track};

/// The most maps abreast.
const ABREAST: usize = 2;
/// What shadows on the maps are.
const RELIEF: &str = "relief, lit from the north-west";
/// Seconds of an hour.
const HOUR_S: f64 = 3600.0;
/// Joules of a megajoule.
const MEGAJOULE: f64 = 1e6;
/// The least half range of a difference map: finer differences of belief say nothing.
const LEAST_DIFFERENCE: f64 = 0.01;

/// How much of the hillshade's shadow lies on a difference map.
const SHADOW: f32 = 0.4;

/// Something that is spent.
type Resource = fn(&Spent) -> f64;

/// Draws a world into a folder that is there; returns what was written.
pub(super) fn draw(folder: &Path, world: &World, runs: &[Run]) -> anyhow::Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    let mut grounds = Vec::new();
    for (place, run) in runs.iter().enumerate() {
        if let Some(ground) = Ground::of(run, world, place)? {
            grounds.push(ground);
        }
    }
    if !grounds.is_empty() {
        let abreast = ABREAST.min(grounds.len());
        // One colour bar a row: all have the same range.
        let keyed = |place: usize| place % abreast + 1 == abreast || place + 1 == grounds.len();
        let figures: Vec<Figure<'_>> = grounds
            .iter()
            .map(Ground::figure)
            .enumerate()
            .map(|(place, figure)| if keyed(place) { figure } else { figure.without_key() })
            .collect();
        written.extend(Sheet::of(&figures, abreast)?.write(folder, "interest")?);
    }
    if let [first, others @ ..] = &grounds[..] {
        for other in others.iter().filter(|other| other.map.spec() == first.map.spec()) {
            let name = format!("difference_{}", file_name(&other.file));
            written.extend(difference(first, other)?.write(folder, &name)?);
        }
    }
    written.extend(sequences(world).write(folder, "sequences")?);
    written.extend(timeline(world).write(folder, "timeline")?);
    let axes: [(&str, &str, Resource); 3] = [
        ("time", "mission time, h", |spent| spent.time_s / HOUR_S),
        ("energy", "energy spent, MJ", |spent| spent.energy_j / MEGAJOULE),
        ("distance", "distance driven, m", |spent| spent.length_m),
    ];
    for (name, across, of) in axes {
        let chart = gained(world, name, across, of);
        written.extend(chart.write(folder, &format!("gain_{name}"))?);
    }
    Ok(written)
}

/// Draws the paired differences over worlds into a folder that is there; returns what was written.
pub(super) fn draw_paired(folder: &Path, paired: &Paired) -> anyhow::Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    let first = &paired.marked[0];
    for metric in &METRICS {
        let of = |row: &Row| if metric.between { row.mean } else { row.difference };
        let rows: Vec<(String, Interval)> = paired
            .rows
            .iter()
            .filter(|row| row.metric.name == metric.name)
            .filter_map(|row| {
                let name = &paired.marked[row.run];
                let against = if metric.between { "and" } else { "less" };
                Some((format!("{name} {against} {first}"), metric.told(of(row)?)))
            })
            .collect();
        if rows.is_empty() {
            continue;
        }
        let worlds = paired.seeds.len();
        let mut remarks =
            vec![format!("{}: {worlds} worlds, 95 % bootstrap intervals", paired.mission)];
        if worlds < FEW_WORLDS {
            remarks.push("Percentile intervals over so few worlds are too short.".to_owned());
        }
        let (title, quantity) = if metric.between {
            (metric.title.to_owned(), metric.told_name())
        } else {
            let what = format!("{}: difference from {first}", metric.title);
            (what, format!("{}: difference", metric.told_name()))
        };
        let chart = Intervals {
            title: &title,
            remarks: &remarks,
            quantity: &quantity,
            rows: &rows,
            zero_line: !metric.between,
            whiskers: true,
        };
        written.extend(chart.drawing().write(folder, &format!("paired_{}", metric.name))?);
    }
    Ok(written)
}

/// A name as part of a file's.
fn file_name(name: &str) -> String {
    let sign = |c: char| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' };
    name.chars().map(sign).collect()
}

/// The ground of a run as it ended, and what it did there.
struct Ground {
    name: String,
    /// The same in the name of a file.
    file: String,
    /// Its mission and seed.
    world: String,
    map: Raster<f32>,
    seen: Raster<bool>,
    shade: Option<Raster<f32>>,
    track: Vec<Cell>,
    /// Targets and names of the goals achieved.
    goals: Vec<(Cell, String)>,
    /// Places that are known to be worth a visit.
    labels: Vec<Cell>,
}

impl Ground {
    /// None of a run that never decided.
    fn of(run: &Run, world: &World, place: usize) -> anyhow::Result<Option<Self>> {
        let Some(map) = final_map(&run.log)? else { return Ok(None) };
        let spec = map.spec();
        let mission = &run.account.mission;
        let seen = observed(&run.log, mission.spec.grid);
        let places = world.places.sequences[place].iter().map(|&place| World::place(place));
        let goals = run.account.targets().into_iter().zip(places);
        let track = run.account.track.iter().copied().filter(|cell| spec.contains(*cell));
        Ok(Some(Self {
            name: world.runs[place].marked(),
            file: run.name.clone(),
            world: format!("{}, seed {}", run.fact("mission"), run.fact("seed")),
            seen: Raster::from_fn(spec, |cell| seen[cell]),
            shade: shade(mission, spec),
            track: track.collect(),
            labels: mission
                .labels
                .iter()
                .map(|label| label.at)
                .filter(|cell| spec.contains(*cell))
                .collect(),
            goals: told_once(goals.filter(|(cell, _)| spec.contains(*cell))),
            map,
        }))
    }

    fn figure(&self) -> Figure<'_> {
        let goals = match self.goals.len() {
            1 => "1 place".to_owned(),
            n => format!("{n} places"),
        };
        let title =
            format!("{}: interest as the run ended, {goals} reached\n{}", self.name, self.world);
        let figure = Figure::new(&title, &self.map, ColourMap::Viridis)
            .value_label("interest")
            .range(0.0, 1.0)
            .known(&self.seen);
        let figure = match &self.shade {
            Some(shade) => figure.hillshade(shade).shading(RELIEF),
            None => figure,
        };
        let figure = self.with_track(figure, "driven", Stroke::Solid, Ink::White);
        let labels = self.labels.iter().map(|&cell| (cell, String::new())).collect();
        let figure = Self::with_goals(figure, "label", (Shape::Cross, Ink::White), labels);
        let look = (Shape::Star, Ink::Orange);
        let figure = Self::with_goals(figure, "goal reached", look, self.goals.clone());
        Self::with_end(self.with_start(figure), "end", Ink::Vermilion, self.end())
    }

    fn with_track<'f>(
        &self,
        figure: Figure<'f>,
        name: &str,
        stroke: Stroke,
        ink: Ink,
    ) -> Figure<'f> {
        if self.track.len() < 2 {
            return figure;
        }
        figure.track(Track { name: name.to_owned(), cells: self.track.clone(), stroke, ink })
    }

    fn with_goals<'f>(
        figure: Figure<'f>,
        name: &str,
        (shape, ink): (Shape, Ink),
        at: Vec<(Cell, String)>,
    ) -> Figure<'f> {
        if at.is_empty() {
            return figure;
        }
        figure.markers(Markers { name: name.to_owned(), shape, ink, at })
    }

    /// Where the way ends.
    fn end(&self) -> Option<Cell> {
        self.track.last().copied()
    }

    fn with_end<'f>(figure: Figure<'f>, name: &str, ink: Ink, at: Option<Cell>) -> Figure<'f> {
        let at = at.into_iter().map(|cell| (cell, String::new())).collect();
        Self::with_goals(figure, name, (Shape::Small, ink), at)
    }

    fn with_start<'f>(&self, figure: Figure<'f>) -> Figure<'f> {
        let Some(&start) = self.track.first() else { return figure };
        figure.markers(Markers {
            name: "start".to_owned(),
            shape: Shape::Triangle,
            ink: Ink::Vermilion,
            at: vec![(start, String::new())],
        })
    }
}

/// Of goals at the same cell, their names together.
fn told_once(goals: impl Iterator<Item = (Cell, String)>) -> Vec<(Cell, String)> {
    let mut told: Vec<(Cell, String)> = Vec::new();
    for (cell, name) in goals {
        match told.iter_mut().find(|(other, _)| *other == cell) {
            Some((_, names)) if names.split(' ').all(|other| other != name) => {
                *names = format!("{names} {name}");
            }
            Some(_) => {}
            None => told.push((cell, name)),
        }
    }
    told
}

/// The shadows of the true ground, if it lies in memory.
fn shade(mission: &wisdom_mission::Mission, spec: GridSpec) -> Option<Raster<f32>> {
    let elevation = mission.world.truth(ELEVATION)?;
    let shade = wisdom_terrain::hillshade(elevation, 315f64.to_radians(), 45f64.to_radians());
    Some(Raster::from_fn(spec, |cell| shade.get(cell).copied().unwrap_or(1.0)))
}

/// What one run's map says more or less than the other's, where both saw anything.
fn difference(first: &Ground, other: &Ground) -> anyhow::Result<Sheet> {
    let spec = first.map.spec();
    let both = Raster::from_fn(spec, |cell| first.seen[cell] && other.seen[cell]);
    let less = Raster::from_fn(spec, |cell| other.map[cell] - first.map[cell]);
    let seen = less.iter().filter(|(cell, _)| both[*cell]).map(|(_, value)| f64::from(value.abs()));
    let most = seen.fold(LEAST_DIFFERENCE, f64::max);
    let title = format!(
        "{} less {}: interest as the runs ended\n{}",
        other.name,
        first.name,
        told_world(first, other)
    );
    let label = format!("interest: {} - {}", other.name, first.name);
    let figure = Figure::new(&title, &less, ColourMap::Diverging)
        .value_label(&label)
        .range(-most, most)
        .known(&both);
    // A weak shadow: no difference has to stay nearly white.
    let shade = first.shade.as_ref().map(|shade| shade.map(|light| 1.0 - SHADOW * (1.0 - light)));
    let figure = match &shade {
        Some(shade) => figure.hillshade(shade).shading(RELIEF),
        None => figure,
    };
    let driven = |ground: &Ground| format!("{} drove", ground.name);
    let reached = |ground: &Ground| format!("{} reached", ground.name);
    let figure = first.with_track(figure, &driven(first), Stroke::Solid, Ink::Black);
    let figure = other.with_track(figure, &driven(other), Stroke::Dashed, Ink::Green);
    let known: BTreeSet<&(Cell, String)> = first.goals.iter().collect();
    // A place of both has its name once.
    let mut unnamed = other.goals.clone();
    for goal in unnamed.iter_mut().filter(|goal| known.contains(*goal)) {
        goal.1.clear();
    }
    let (of_first, of_other) = ((Shape::Square, Ink::Black), (Shape::Star, Ink::Green));
    // Around the other's mark where both are at one cell, so that both are seen.
    let (both, alone): (Vec<_>, Vec<_>) = first
        .goals
        .iter()
        .cloned()
        .partition(|(cell, _)| other.goals.iter().any(|(reached, _)| reached == cell));
    let name = format!("{}, where the other did too", reached(first));
    let figure = Ground::with_goals(figure, &reached(first), of_first, alone);
    let figure = Ground::with_goals(figure, &name, (Shape::Frame, Ink::Black), both);
    let figure = Ground::with_goals(figure, &reached(other), of_other, unnamed);
    let figure = first.with_start(figure);
    let figure = if first.end() == other.end() {
        Ground::with_end(figure, "end of both", Ink::Vermilion, first.end())
    } else {
        let end = |ground: &Ground| format!("end of {}", ground.name);
        let figure = Ground::with_end(figure, &end(first), Ink::Black, first.end());
        Ground::with_end(figure, &end(other), Ink::Green, other.end())
    };
    Sheet::of(&[figure], 1)
}

/// The world of two runs, or the worlds.
fn told_world(first: &Ground, other: &Ground) -> String {
    if first.world == other.world {
        return first.world.clone();
    }
    format!("{}; {}", first.world, other.world)
}

fn remarks(world: &World) -> Vec<String> {
    std::iter::once(world.title()).chain(world.footnotes()).collect()
}

/// The sequences as lanes, each linked with the next.
fn sequences(world: &World) -> crate::chart::Drawing {
    let sequences = &world.places.sequences;
    let mut links = Vec::new();
    for (lane, pair) in sequences.windows(2).enumerate() {
        if world.runs[lane].grid != world.runs[lane + 1].grid {
            continue;
        }
        for edit in Alignment::between(&pair[0], &pair[1]).edits {
            if let (Some(from), Some(to)) = (edit.from(), edit.to()) {
                let moved = matches!(edit, Edit::Move { .. });
                links.push(Link { lane, from, to, moved });
            }
        }
    }
    let linked = |lane: usize, stop: usize| {
        links.iter().any(|link| {
            (link.lane, link.from) == (lane, stop) || (link.lane + 1, link.to) == (lane, stop)
        })
    };
    let lanes: Vec<Lane> = world
        .runs
        .iter()
        .enumerate()
        .map(|(lane, run)| Lane {
            name: run.marked(),
            stops: run
                .goals
                .iter()
                .enumerate()
                .map(|(turn, goal)| Stop {
                    name: World::place(sequences[lane][turn]),
                    number: goal.ruler.map(|ruler| format!("{ruler:.3}")).unwrap_or_default(),
                    shared: linked(lane, turn),
                })
                .collect(),
        })
        .collect();
    let mut remarks = remarks(world);
    remarks.push(
        "A box is a place and its interest on the common ruler; grey: not in the lane above or below."
            .to_owned(),
    );
    remarks.push("Line: keeps its turn among what both reach. Dashed: moved.".to_owned());
    let title = "Goals in the order in which they were reached";
    Lanes { title, remarks: &remarks, rows: &lanes, links: &links }.drawing()
}

fn timeline(world: &World) -> crate::chart::Drawing {
    let hours = |seconds: f64| seconds / HOUR_S;
    let course = |(place, run): (usize, &Compared)| {
        let divergence = run.against.divergence.as_ref();
        let parts = divergence.and_then(|d| run.decided.get(d.decision as usize));
        let names = world.places.sequences[place].iter().map(|&place| World::place(place));
        Course {
            name: run.marked(),
            decisions: run.decided.iter().map(|&(at, changed)| (hours(at), changed)).collect(),
            goals: run.goals.iter().map(|goal| hours(goal.spent.time_s)).zip(names).collect(),
            parts: parts.map(|(at, _)| hours(*at)),
            end: hours(run.spent.time_s),
        }
    };
    let courses: Vec<Course> = world.runs.iter().enumerate().map(course).collect();
    let mut remarks = remarks(world);
    remarks.push("Dot: goal reached. Stroke: decision, pale if it changed no goal.".to_owned());
    if courses.iter().any(|course| course.parts.is_some()) {
        let first = &world.runs[0].name;
        remarks.push(format!(
            "Long black stroke with a flag: the first decision that differs from {first}'s."
        ));
    }
    Timeline {
        title: "Decisions and goals over mission time",
        remarks: &remarks,
        across: "mission time, h",
        courses: &courses,
    }
    .drawing()
}

/// Interest gained on the ruler over something that is spent; on the own map where the ruler is not at hand.
fn gained(world: &World, what: &str, across: &str, of: Resource) -> crate::chart::Drawing {
    let ruled = world.runs.iter().all(|run| run.ruler.is_some());
    let curve = |run: &Compared| {
        let mut sum = 0.0;
        let steps = run
            .goals
            .iter()
            .map(|goal| {
                sum += goal.ruler.filter(|_| ruled).unwrap_or(goal.interest);
                (of(&goal.spent), sum)
            })
            .collect();
        Curve { name: run.marked(), steps, end: of(&run.spent) }
    };
    let curves: Vec<Curve> = world.runs.iter().map(curve).collect();
    let up =
        if ruled { "interest gained, on the ruler" } else { "interest gained, on the own map" };
    let title = format!("Interest gained over {what}");
    Steps { title: &title, remarks: &remarks(world), across, up, curves: &curves }.drawing()
}
