//! `wisdom terrain synthesize`.

use std::path::PathBuf;

use wisdom_grid::{GridSpec, Window};
use wisdom_terrain::{Crs, Landscape, Projection, SceneLayer};

use super::output::{Kind, Output, Target, write};
use super::picture::{Look, draw};
use crate::exit::InputError;
use crate::figure::ColourMap;

/// Make terrain from a description.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct SynthesizeArgs {
    /// The description (see missions/paper/landscape.toml).
    landscape: PathBuf,
    #[command(flatten)]
    output: Output,
    /// Rows of the grid.
    #[arg(long, value_name = "N")]
    rows: usize,
    /// Columns of the grid.
    #[arg(long, value_name = "N")]
    cols: usize,
    /// Side of a cell, metres.
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    spacing_m: f64,
    /// What to draw: elevation, texture or temperature.
    #[arg(long, default_value = "elevation", value_parser = layer)]
    layer: SceneLayer,
    /// Seed of the relief and of scattered rocks.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Map coordinate of the west edge, metres.
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true)]
    west_m: f64,
    /// Map coordinate of the north edge, metres [default: the south edge at 0].
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    north_m: Option<f64>,
    /// Radius of the body, metres: the map becomes an equirectangular one of it.
    #[arg(long, value_name = "M")]
    radius_m: Option<f64>,
}

fn layer(text: &str) -> Result<SceneLayer, String> {
    let known = SceneLayer::ALL.into_iter().find(|layer| layer.to_string() == text);
    known.ok_or_else(|| {
        format!("expected {}", SceneLayer::ALL.map(|layer| layer.to_string()).join(", "))
    })
}

pub(super) fn run(args: &SynthesizeArgs) -> anyhow::Result<()> {
    let target = args.output.target(&[&args.landscape])?;
    let name = args.landscape.display();
    let text = std::fs::read_to_string(&args.landscape)
        .map_err(|error| InputError(format!("{name}: {error}")))?;
    let scene: Landscape =
        toml::from_str(&text).map_err(|error| InputError(format!("{name}: {error}")))?;
    let spec = GridSpec::new(args.rows, args.cols, args.spacing_m)
        .map_err(|error| InputError(error.to_string()))?;
    let north_m = args.north_m.unwrap_or(spec.north_m());
    if !(args.west_m.is_finite() && north_m.is_finite()) {
        return Err(InputError(format!("a corner at ({}, {north_m})", args.west_m)).into());
    }
    let spec = spec.at(args.west_m, north_m);
    let crs = match args.radius_m {
        None => None,
        Some(radius_m) if radius_m.is_finite() && radius_m > 0.0 => Some(Crs {
            name: String::new(),
            body: String::new(),
            radius_m: Some(radius_m),
            polar_radius_m: Some(radius_m),
            projection: Projection::Equirectangular {
                centre_lon_deg: 0.0,
                standard_parallel_deg: 0.0,
                false_easting_m: 0.0,
                false_northing_m: 0.0,
            },
        }),
        Some(radius_m) => {
            let message = format!("--radius-m {radius_m}: expected a positive number");
            return Err(InputError(message).into());
        }
    };
    match target {
        Target::Tiff(path) => {
            let kind = match args.layer {
                SceneLayer::Elevation => Kind::floats("elevation", "metre"),
                SceneLayer::Temperature => Kind::floats("temperature", ""),
                SceneLayer::Texture => Kind::floats("texture class", ""),
            };
            write(path, spec, crs.as_ref(), &kind.options(), |rows| {
                let window =
                    Window { row: rows.start, col: 0, rows: rows.len(), cols: spec.cols() };
                let part = spec.part(window).map_err(|e| InputError(e.to_string()))?;
                let drawn = scene.render_layer(args.layer, part, args.seed).into_values();
                let known = vec![true; drawn.len()];
                Ok((drawn, known))
            })
        }
        Target::Picture(path) => {
            if spec.len() > wisdom_terrain::format::MAX_CELLS {
                let message =
                    format!("{} x {} cells are too many for a picture", args.rows, args.cols);
                return Err(InputError(message).into());
            }
            let layer =
                |layer| wisdom_terrain::Layer::certain(scene.render_layer(layer, spec, args.seed));
            let elevation = layer(SceneLayer::Elevation)?;
            let name = args.layer.to_string();
            let (title, map) = match args.layer {
                SceneLayer::Texture => ("Texture", ColourMap::Viridis),
                SceneLayer::Temperature => ("Temperature", ColourMap::Cividis),
                SceneLayer::Elevation => ("Elevation", ColourMap::Viridis),
            };
            draw(path, &layer(args.layer)?, Look::new(title, &name, map), Some(&elevation))
        }
    }
}
