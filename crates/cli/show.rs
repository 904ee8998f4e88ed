//! `wisdom show`: a map of a logged decision, drawn.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use wisdom_autonomy::{Act, Decision, ELEVATION, Maps};
use wisdom_goals::{Action, Status};
use wisdom_grid::{Cell, Raster};
use wisdom_logbook::{Entry, LogReader};

use crate::exit::InputError;
use crate::figure::{Axes, ColourMap, Figure, Ink, Markers, Shape, Stroke, Track};

/// Draw a map of a logged decision.
#[derive(clap::Args, Debug)]
pub(crate) struct ShowArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// interest, ignorance, paradox, conflict, contradiction, prize, hazard, blocked, any layer of the
    /// mission, or NAME-u for a layer's uncertainty.
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

pub(crate) fn run(args: &ShowArgs) -> anyhow::Result<ExitCode> {
    let log = LogReader::open(&args.log)?;
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
    let plane = plane(&past.maps, &args.layer)?;
    let elevation = &past.maps.layers[ELEVATION];
    let shade =
        wisdom_terrain::hillshade(elevation.values(), 315f64.to_radians(), 45f64.to_radians());
    let name = log.metadata.get("mission").map_or("mission", String::as_str);
    let rule = log.metadata.get("rule").map_or("?", String::as_str);
    let title = format!("{name}: {} at decision {number} ({rule})", args.layer);
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
    figure = overlays(figure, &past.decision, &past.achieved, driven);
    figure.save(&args.output)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", args.output.display())?;
    Ok(ExitCode::SUCCESS)
}

fn plane(maps: &Maps, name: &str) -> Result<Plane, InputError> {
    let unit = |raster: &Raster<f32>, label: &str| Plane {
        raster: raster.clone(),
        label: label.to_owned(),
        map: ColourMap::Viridis,
        range: Some((0.0, 1.0)),
        known: None,
    };
    let interest = &maps.interest;
    let free = |raster: Raster<f32>, label: &str, known: Option<Raster<bool>>| Plane {
        raster,
        label: label.to_owned(),
        map: ColourMap::Cividis,
        range: None,
        known,
    };
    Ok(match name {
        "interest" => unit(&interest.interest, "Bel(I)"),
        "ignorance" => unit(&interest.ignorance, "m(I or NI)"),
        "paradox" => unit(&interest.paradox, "m(I and NI)"),
        "conflict" => unit(&interest.conflict, "K"),
        "contradiction" => unit(&interest.contradiction, "largest m_a(I) m_b(NI)"),
        "prize" => unit(&maps.prize.prize, "prize"),
        "hazard" => free(
            maps.ground.hazard().clone(),
            "hazard rate, 1/m",
            Some(maps.ground.blocked().map(|b| !b)),
        ),
        "blocked" => unit(&maps.ground.blocked().map(|&b| f32::from(u8::from(b))), "blocked"),
        name => {
            let layer = |n: &str| maps.layers.get(n);
            if let Some(found) = layer(name) {
                let known = found.uncertainty().map(|u| *u < 1.0);
                free(found.values().clone(), name, Some(known))
            } else if let Some(found) = name.strip_suffix("-u").and_then(layer) {
                unit(found.uncertainty(), "u")
            } else {
                let mut known: Vec<&str> = vec![
                    "interest",
                    "ignorance",
                    "paradox",
                    "conflict",
                    "contradiction",
                    "prize",
                    "hazard",
                    "blocked",
                ];
                known.extend(maps.layers.keys().map(String::as_str));
                let list = known.join(", ");
                return Err(InputError(format!(
                    "--layer {name}: the log has {list} (and NAME-u for a layer's uncertainty)"
                )));
            }
        }
    })
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
    driven: Vec<Cell>,
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
        match (verdict.action, verdict.goal.status) {
            (Action::Achieve, _) => reached.push(at),
            (_, Status::Committed) => chosen.push(at),
            (Action::Drop, _) => {}
            _ => known.push((at.0, String::new())),
        }
    }
    let markers = |name: &str, shape, ink, at| Markers { name: name.into(), shape, ink, at };
    let mut figure = figure
        .track(Track {
            name: "driven".into(),
            cells: driven,
            stroke: Stroke::Solid,
            ink: Ink::White,
        })
        .markers(markers("deferred", Shape::Circle, Ink::SkyBlue, known))
        .markers(markers("in the sequence", Shape::Star, Ink::Orange, chosen))
        .markers(markers("achieved", Shape::Square, Ink::Purple, reached))
        .markers(markers(
            "rover",
            Shape::Triangle,
            Ink::Vermilion,
            vec![(decision.state.pose.cell, String::new())],
        ));
    if planned.len() > 1 {
        figure = figure.track(Track {
            name: "planned".into(),
            cells: planned,
            stroke: Stroke::Dashed,
            ink: Ink::Orange,
        });
    }
    figure
}
