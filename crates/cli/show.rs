//! `wisdom show`: a map of a logged decision, drawn.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use wisdom_autonomy::{Act, Decision, ELEVATION};
use wisdom_goals::{Action, Status};
use wisdom_grid::{Cell, Raster, Window};
use wisdom_logbook::{Entry, LogReader, Past, PlaneGroup, PlaneInfo};

use crate::exit::InputError;
use crate::figure::{Axes, ColourMap, Figure, Ink, Markers, Shape, Stroke, Track};

/// Draw a map of a logged decision.
#[derive(clap::Args, Debug)]
pub(crate) struct ShowArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// interest, ignorance, paradox, conflict, contradiction, prize, hazard, blocked, reliability (the chance to reach the
    /// cell from the rover), any layer of the mission, NAME-u for a layer's uncertainty; of an expert credit-NAME,
    /// mass-interesting-NAME, mass-not-interesting-NAME, mass-ignorance-NAME, mass-paradox-NAME.
    #[arg(long, default_value = "interest")]
    layer: String,
    /// The decision; the last one by default.
    #[arg(long, value_name = "N")]
    decision: Option<u32>,
    /// Where the picture goes.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// A plane to draw.
struct Plane {
    raster: Raster<f32>,
    label: String,
    map: ColourMap,
    range: Option<(f64, f64)>,
    known: Option<Raster<bool>>,
}

/// Whether a picture may go there: a name that ends in `.png`, and nothing there but an older picture.
fn check_output(path: &Path) -> Result<(), InputError> {
    let refuse = |why: &str| Err(InputError(format!("-o {}: {why}", path.display())));
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return refuse("a picture's name ends in .png");
    }
    match std::fs::read(path) {
        Ok(bytes) if !bytes.starts_with(b"\x89PNG") => {
            refuse("is there already, and is no picture")
        }
        _ => Ok(()),
    }
}

pub(crate) fn run(args: &ShowArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.output)?;
    let log = LogReader::open(&args.log)?;
    let mission = wisdom_logbook::mission_of(&log)?;
    let info = info(&mission, &args.layer)?;
    let count = log.decisions().count();
    let number = match args.decision {
        Some(number) => number,
        None => log.decisions().last().map(|d| d.number).ok_or_else(|| {
            InputError(format!("{}: the log holds no decision", args.log.display()))
        })?,
    };
    let Some(past) = wisdom_logbook::derive_at(&log, number)? else {
        let message = format!(
            "{}: no decision {number}; the log holds {count}, counted from 0",
            args.log.display()
        );
        return Err(InputError(message).into());
    };
    let maps = past.maps();
    let plane = plane(&past, &info).context("a plane of every decision is not there")?;
    let elevation = &maps.layers[ELEVATION];
    let shade = wisdom_terrain::hillshade(elevation, 315f64.to_radians(), 45f64.to_radians());
    let name = log.metadata.get("mission").map_or("mission", String::as_str);
    let rule = log.metadata.get("rule").map_or("?", String::as_str);
    let mut title = format!("{name}: {} at decision {number} ({rule})", args.layer);
    let (map, grid) = (plane.raster.spec().window(), mission.spec.grid.window());
    if map != grid {
        let (south, east) = (map.row + map.rows - 1, map.col + map.cols - 1);
        let Window { row, col, .. } = map;
        let whole = format!("{} x {}", grid.rows, grid.cols);
        title = format!("{title}; rows {row} to {south}, columns {col} to {east} of {whole}");
    }
    let mut figure = Figure::new(&title, &plane.raster, plane.map)
        .value_label(&plane.label)
        .hillshade(&shade)
        .axes(Axes::Metres);
    if let Some((low, high)) = plane.range {
        figure = figure.range(low, high);
    }
    if let Some(known) = &plane.known {
        figure = figure.known(known);
    }
    let driven = driven(&log, number, past.decision.state.pose.cell);
    let on_map = |cell: Cell| plane.raster.spec().contains(cell);
    figure = overlays(figure, &past.decision, &past.achieved, &driven, &on_map);
    figure.save(&args.output)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", args.output.display())?;
    Ok(crate::exit::of_log(&log))
}

/// The layer asked for, among those that the mission's decisions have, before anything is derived.
fn info(mission: &wisdom_mission::Mission, name: &str) -> Result<PlaneInfo, InputError> {
    let all = wisdom_logbook::planes(&mission.spec);
    let names: Vec<&str> = all.iter().map(|plane| plane.name.as_str()).collect();
    let list = names.join(", ");
    let found = all.into_iter().find(|plane| plane.name == name);
    found.ok_or_else(|| InputError(format!("--layer {name}: the log has {list}")))
}

fn plane(past: &Past, info: &PlaneInfo) -> Option<Plane> {
    let raster = wisdom_logbook::plane(&past.rover, &info.name)?.into_owned();
    let maps = past.maps();
    let read = |layer: &str| Some(maps.layers.get(layer)?.uncertainty().map(|&u| u < 1.0));
    let (range, known) = match info.group {
        // Of ground that no expert knows anything of, an interest of 0 would be a claim.
        PlaneGroup::Interest if info.name != "ignorance" => {
            (Some((0.0, 1.0)), Some(maps.interest.ignorance.map(|&ignorance| ignorance < 1.0)))
        }
        PlaneGroup::Credit => (Some((-1.0, 1.0)), None),
        PlaneGroup::Layer => (None, read(&info.name)),
        PlaneGroup::Ground if info.name == "hazard" => (None, read(ELEVATION)),
        _ => (Some((0.0, 1.0)), None),
    };
    let map = if range.is_some() { ColourMap::Viridis } else { ColourMap::Cividis };
    let unit = if matches!(info.unit.as_str(), "1" | "") {
        String::new()
    } else {
        format!(", {}", info.unit)
    };
    Some(Plane { raster, label: format!("{}{unit}", info.label), map, range, known })
}

/// Every cell driven before a decision.
fn driven(log: &LogReader, number: u32, here: Cell) -> Vec<Cell> {
    let mut cells = Vec::new();
    for entry in &log.entries {
        if let Entry::Outcome(outcome) = entry
            && outcome.decision < number
        {
            cells.extend(outcome.track.iter().map(|c| Cell::new(c.row as usize, c.col as usize)));
        }
    }
    cells.push(here);
    cells.dedup();
    cells
}

fn overlays<'a>(
    figure: Figure<'a>,
    decision: &Decision,
    achieved: &[(Cell, String)],
    driven: &[Cell],
    on_map: &dyn Fn(Cell) -> bool,
) -> Figure<'a> {
    let mut planned: Vec<Cell> = Vec::new();
    for leg in &decision.plan().plan.legs {
        planned.extend(&leg.route.cells);
    }
    if let Act::Look { route, .. } | Act::Home { route } = &decision.act {
        planned.extend(&route.cells);
    }
    planned.dedup();
    let mut chosen = Vec::new();
    let mut known = Vec::new();
    let mut reached = achieved.to_vec();
    for verdict in &decision.verdicts {
        let at = (verdict.goal.target, verdict.goal.id.to_string());
        match (verdict.action, verdict.goal.status()) {
            (Action::Achieve, _) => reached.push(at),
            (_, Status::Committed | Status::Dispatched) => chosen.push(at),
            (Action::Drop, _) => {}
            _ => known.push((at.0, String::new())),
        }
    }
    let markers = |name: &str, shape, ink, mut at: Vec<(Cell, String)>| {
        at.retain(|(cell, _)| on_map(*cell));
        Markers { name: name.into(), shape, ink, at }
    };
    let mut figure = figure;
    for track in tracks("driven", driven, Stroke::Solid, Ink::White, on_map) {
        figure = figure.track(track);
    }
    if !reached.is_empty() {
        figure = figure.markers(markers("achieved", Shape::Square, Ink::Purple, reached));
    }
    figure = figure
        .markers(markers("deferred", Shape::Circle, Ink::SkyBlue, known))
        .markers(markers("in the sequence", Shape::Star, Ink::Orange, chosen))
        .markers(markers(
            "rover",
            Shape::Triangle,
            Ink::Vermilion,
            vec![(decision.state.pose.cell, String::new())],
        ));
    for track in tracks("planned", &planned, Stroke::Dashed, Ink::Orange, on_map) {
        figure = figure.track(track);
    }
    figure
}

/// The pieces of a way that lie on the map, which may have moved on with the rover; the first one bears the name.
fn tracks(
    name: &str,
    way: &[Cell],
    stroke: Stroke,
    ink: Ink,
    on_map: &dyn Fn(Cell) -> bool,
) -> Vec<Track> {
    let pieces = way.split(|cell| !on_map(*cell)).filter(|piece| piece.len() > 1);
    let named = |(i, piece): (usize, &[Cell])| Track {
        name: if i == 0 { name.to_owned() } else { String::new() },
        cells: piece.to_vec(),
        stroke,
        ink,
    };
    pieces.enumerate().map(named).collect()
}
