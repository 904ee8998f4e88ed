//! `wisdom terrain info`.

use std::io::Write;
use std::path::PathBuf;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use serde_json::{Value, json};
use wisdom_grid::Window;
use wisdom_terrain::Crs;

use super::input::Ground;
use super::output::bar;

/// What a terrain file holds.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct InfoArgs {
    /// The file.
    file: PathBuf,
    /// The band whose values are told, counted from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    band: usize,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

/// Cells looked at together.
const BAND_CELLS: usize = 1 << 22;

/// What the values are like.
#[derive(Default)]
struct Summary {
    known: u64,
    least: Option<f32>,
    largest: Option<f32>,
    sum: f64,
}

impl Summary {
    /// Sums are taken above the first value: heights of −4500 m would leave little of a mean of millions.
    fn of(ground: &Ground, name: &str) -> anyhow::Result<Self> {
        let spec = ground.spec();
        let bar = bar(name, spec.rows())?;
        let step = (BAND_CELLS / spec.cols()).max(1);
        let mut summary = Self::default();
        let mut first = None;
        for row in (0..spec.rows()).step_by(step) {
            bar.set_position(row as u64);
            let rows = step.min(spec.rows() - row);
            let file = ground.read(Window { row, col: 0, rows, cols: spec.cols() })?;
            let values = file.raster.values().iter().zip(file.known.values());
            for (&value, _) in values.filter(|(_, known)| **known) {
                let first = *first.get_or_insert(f64::from(value));
                summary.known += 1;
                summary.sum += f64::from(value) - first;
                summary.least = Some(summary.least.map_or(value, |least| least.min(value)));
                summary.largest = Some(summary.largest.map_or(value, |most| most.max(value)));
            }
        }
        bar.finish_and_clear();
        summary.sum += first.unwrap_or(0.0) * summary.known as f64;
        Ok(summary)
    }

    fn mean(&self) -> Option<f64> {
        (self.known > 0).then(|| self.sum / self.known as f64)
    }
}

pub(super) fn run(args: &InfoArgs) -> anyhow::Result<()> {
    let name = args.file.display().to_string();
    let ground = Ground::open(&args.file, None, Some(args.band))?;
    let summary = Summary::of(&ground, &name)?;
    let mut out = std::io::stdout().lock();
    if args.json {
        writeln!(out, "{}", as_json(&name, &ground, &summary))?;
    } else {
        for line in as_table(&name, &ground, &summary).to_string().lines() {
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    Ok(())
}

fn as_json(name: &str, ground: &Ground, summary: &Summary) -> Value {
    let (spec, about) = (ground.spec(), ground.reader.about());
    let crs = ground.reader.crs();
    json!({
        "file": name,
        "format": about.format,
        "storage": about.storage,
        "rows": spec.rows(),
        "cols": spec.cols(),
        "bands": ground.reader.bands(),
        "spacing_m": spec.spacing_m(),
        "west_m": spec.west_m(),
        "north_m": spec.north_m(),
        "east_m": spec.west_m() + spec.cols() as f64 * spec.spacing_m(),
        "south_m": spec.north_m() - spec.rows() as f64 * spec.spacing_m(),
        "nodata": about.nodata,
        "scale": about.scale,
        "offset": about.offset,
        "body_radius_m": crs.and_then(|crs| crs.radius_m),
        "polar_radius_m": crs.and_then(|crs| crs.polar_radius_m),
        "crs": crs.map(|crs| crs.name.as_str()),
        "projection": crs.map(Crs::to_string),
        "centre_lon_lat_deg": crs.and_then(|crs| middle(ground, crs)),
        "known_cells": summary.known,
        "min": summary.least,
        "max": summary.largest,
        "mean": summary.mean(),
    })
}

/// Longitude and latitude of the grid's middle, degrees.
fn middle(ground: &Ground, crs: &Crs) -> Option<(f64, f64)> {
    let spec = ground.spec();
    let half = |cells: usize| cells as f64 * spec.spacing_m() / 2.0;
    crs.lon_lat_deg(spec.west_m() + half(spec.cols()), spec.north_m() - half(spec.rows()))
}

fn as_table(name: &str, ground: &Ground, summary: &Summary) -> Table {
    let (spec, about) = (ground.spec(), ground.reader.about());
    let mut table = Table::new();
    table.load_style(NOTHING);
    let mut row = |key: &str, value: String| {
        table.add_row([key.to_owned(), value]);
    };
    let side = |cells: usize| cells as f64 * spec.spacing_m();
    row("file", name.to_owned());
    row("format", format!("{}: {}", about.format, about.storage));
    row(
        "grid",
        format!("{} rows x {} columns of {} m", spec.rows(), spec.cols(), spec.spacing_m()),
    );
    row("west, north", format!("{}, {} m", spec.west_m(), spec.north_m()));
    row(
        "east, south",
        format!("{}, {} m", spec.west_m() + side(spec.cols()), spec.north_m() - side(spec.rows())),
    );
    match ground.reader.crs() {
        None => row("projection", "the file tells none".to_owned()),
        Some(crs) => {
            if !crs.name.is_empty() {
                row("map", crs.name.clone());
            }
            row("projection", crs.to_string());
            if let Some(radius_m) = crs.radius_m {
                let polar = crs.polar_radius_m.filter(|polar| *polar != radius_m);
                let polar = polar.map_or(String::new(), |polar| format!(", {polar} m to the pole"));
                row("body radius", format!("{radius_m} m{polar}"));
            }
            if let Some((lon, lat)) = middle(ground, crs) {
                row("middle", format!("{lon:.5} E, {lat:.5} N"));
            }
        }
    }
    if ground.reader.bands() > 1 {
        row(
            "bands",
            format!("{}; what follows is of band {}", ground.reader.bands(), ground.band()),
        );
    }
    row("no data", about.nodata.clone().unwrap_or_else(|| "no value stands for it".to_owned()));
    if (about.scale, about.offset) != (1.0, 0.0) {
        let sign = if about.offset < 0.0 { '-' } else { '+' };
        row("values", format!("stored x {} {sign} {}", about.scale, about.offset.abs()));
    }
    // Never rounded up: a file with one hole is not whole.
    let share = (1e4 * summary.known as f64 / spec.len() as f64).floor() / 100.0;
    row("known", format!("{} of {} cells ({share:.2} %)", summary.known, spec.len()));
    if let (Some(least), Some(largest), Some(mean)) =
        (summary.least, summary.largest, summary.mean())
    {
        row("range", format!("{least} to {largest}, mean {mean:.3}"));
    }
    table
}
