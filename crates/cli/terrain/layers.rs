//! Layers derived from elevation cell by cell.

use std::path::{Path, PathBuf};

use wisdom_grid::{GridSpec, Raster, Window};
use wisdom_planner::{Preset, Traversability, Vehicle};
use wisdom_terrain::format::GridFile;
use wisdom_terrain::{Kernel, Layer, Measure, hillshade as shade, measure};

use super::input::{Ground, Input};
use super::output::{Kind, Output, Target, derive};
use super::picture::{Look, draw};
use crate::exit::InputError;
use crate::figure::ColourMap;

/// Gradient or slope.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct GradientArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// How differences are taken: central (two neighbours) or horn (all eight; Horn, 1981).
    #[arg(long, default_value = "central")]
    kernel: Kernel,
}

/// Step height.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct StepArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
}

/// Roughness.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct RoughnessArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Radius of the ground that the plane is fitted to, metres; at least one cell.
    #[arg(long, value_name = "M", default_value_t = Vehicle::default().footprint_radius_m)]
    footprint_m: f64,
}

/// Traversability.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct TraversabilityArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// What to give: severity (share of the vehicle's limits, 1 or more is blocked), hazard (rate per metre; blocked
    /// cells have that of the limits), or blocked (1 or 0).
    #[arg(long, value_enum, default_value = "severity")]
    what: What,
    /// The vehicle: a preset (mer, msl, m2020, exomars), or a TOML file with the keys of `[rover.vehicle]` in
    /// mission.toml, each optional.
    #[arg(long, value_name = "PRESET|FILE.toml")]
    vehicle: Option<PathBuf>,
    /// Uncertainty of the heights, 0 to 1, on the same grid: it raises the hazard.
    #[arg(long, value_name = "FILE")]
    uncertainty: Option<PathBuf>,
}

#[derive(clap::ValueEnum, Debug, Clone, Copy)]
enum What {
    Severity,
    Hazard,
    Blocked,
}

/// Hillshade.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct HillshadeArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// Where the light comes from, degrees clockwise from north.
    #[arg(long, value_name = "DEG", default_value_t = 315.0)]
    azimuth_deg: f64,
    /// How high the light stands, degrees above the horizon.
    #[arg(long, value_name = "DEG", default_value_t = 45.0)]
    altitude_deg: f64,
}

pub(super) fn gradient(args: &GradientArgs) -> anyhow::Result<()> {
    let look = Look::new("Gradient magnitude", "|grad z|", ColourMap::Viridis);
    let kind = Kind::floats("gradient magnitude", "");
    measured(&args.input, &args.output, Measure::Gradient(args.kernel), 1, kind, look)
}

pub(super) fn slope(args: &GradientArgs) -> anyhow::Result<()> {
    let look = Look::new("Slope", "slope, degrees", ColourMap::Viridis);
    let kind = Kind::floats("slope", "degree");
    measured(&args.input, &args.output, Measure::SlopeDeg(args.kernel), 1, kind, look)
}

pub(super) fn step(args: &StepArgs) -> anyhow::Result<()> {
    let look = Look::new("Step height", "step, m", ColourMap::Viridis);
    measured(
        &args.input,
        &args.output,
        Measure::Step,
        1,
        Kind::floats("step height", "metre"),
        look,
    )
}

pub(super) fn roughness(args: &RoughnessArgs) -> anyhow::Result<()> {
    let ground = args.input.open()?;
    let radius_cells = footprint_cells(args.footprint_m, ground.spec())?;
    let look = Look::new("Roughness", "residual, m", ColourMap::Viridis);
    let kind = Kind::floats("roughness", "metre");
    let measure = Measure::Roughness { radius_cells };
    measured(&args.input, &args.output, measure, radius_cells, kind, look)
}

/// The widest footprint, in cells of radius: every cell's roughness is fitted over that many, squared.
const MAX_FOOTPRINT_CELLS: f64 = 64.0;

fn footprint_cells(footprint_m: f64, spec: GridSpec) -> Result<usize, InputError> {
    let cells = (footprint_m / spec.spacing_m()).round().max(1.0);
    if footprint_m > 0.0 && cells <= MAX_FOOTPRINT_CELLS {
        return Ok(cells as usize);
    }
    Err(InputError(format!(
        "a footprint of {footprint_m} m radius; expected above 0 and at most {MAX_FOOTPRINT_CELLS} cells, {} m here",
        MAX_FOOTPRINT_CELLS * spec.spacing_m()
    )))
}

/// One measure of a terrain file.
fn measured(
    input: &Input,
    output: &Output,
    what: Measure,
    reach: usize,
    kind: Kind,
    look: Look<'_>,
) -> anyhow::Result<()> {
    each(input, output, reach, kind, look, |elevation| {
        let [layer] = measure(elevation, [what]);
        Ok(layer)
    })
}

/// A layer of a terrain file, as a GeoTIFF or as a picture.
fn each(
    input: &Input,
    output: &Output,
    reach: usize,
    kind: Kind,
    look: Look<'_>,
    make: impl Fn(&Layer) -> anyhow::Result<Layer>,
) -> anyhow::Result<()> {
    let target = output.target(&[input.path()])?;
    let ground = input.open()?;
    match target {
        Target::Tiff(path) => derive(&ground, path, kind, reach, make),
        Target::Picture(path) => draw_part(&ground, None, path, reach, look, make),
    }
}

/// Draws a derived layer of a part of a file, whose edges see what lies beyond them.
fn draw_part(
    ground: &Ground,
    uncertainty: Option<&Ground>,
    path: &std::path::Path,
    reach: usize,
    look: Look<'_>,
    make: impl Fn(&Layer) -> anyhow::Result<Layer>,
) -> anyhow::Result<()> {
    ground.check_size()?;
    let near = ground.around(ground.window, reach);
    let u = uncertainty.map(|file| file.read(near)).transpose()?;
    let elevation = with_u(ground.read(near)?.into_layer()?, u)?;
    let (row, col) = (ground.window.row - near.row, ground.window.col - near.col);
    let cut = Window { row, col, ..ground.window };
    let title = format!("{}{}", look.title, ground.part());
    let look = Look { title: &title, ..look };
    draw(path, &make(&elevation)?.crop(cut)?, look, Some(&elevation.crop(cut)?))
}

pub(super) fn hillshade(args: &HillshadeArgs) -> anyhow::Result<()> {
    for (option, degrees, most) in
        [("--azimuth-deg", args.azimuth_deg, 360.0), ("--altitude-deg", args.altitude_deg, 90.0)]
    {
        if !(0.0..=most).contains(&degrees) {
            let message = format!("{option} {degrees}: expected 0 to {most}");
            return Err(InputError(message).into());
        }
    }
    let (azimuth_rad, altitude_rad) =
        (args.azimuth_deg.to_radians(), args.altitude_deg.to_radians());
    let title = format!(
        "Hillshade, light from {} degrees, {} above the horizon",
        args.azimuth_deg, args.altitude_deg
    );
    let look = Look { relief: false, ..Look::new(&title, "brightness", ColourMap::Grey) };
    each(&args.input, &args.output, 1, Kind::floats("hillshade", ""), look, |elevation| {
        let light = shade(elevation, azimuth_rad, altitude_rad);
        Ok(Layer::new(light, elevation.uncertainty().clone())?)
    })
}

pub(super) fn traversability(args: &TraversabilityArgs) -> anyhow::Result<()> {
    let is_file = |path: &&Path| path.to_str().is_none_or(|name| Preset::named(name).is_err());
    let vehicle_file = args.vehicle.as_deref().filter(is_file);
    let inputs = [Some(args.input.path()), vehicle_file, args.uncertainty.as_deref()];
    let inputs: Vec<_> = inputs.into_iter().flatten().collect();
    let target = args.output.target(&inputs)?;
    let ground = args.input.open()?;
    let vehicle = vehicle(args)?;
    let spec = ground.spec();
    let radius_cells = footprint_cells(vehicle.footprint_radius_m, spec)?;
    let uncertainty = match &args.uncertainty {
        None => None,
        Some(path) => {
            let file = Ground::open(path, None, None)?;
            if file.reader.spec() != ground.reader.spec() {
                let message = format!(
                    "--uncertainty {}: it lies on another grid than the elevation; bring it there with \
                     `wisdom terrain convert --like`",
                    path.display()
                );
                return Err(InputError(message).into());
            }
            Some(file)
        }
    };
    let judge = |elevation: &Layer| -> anyhow::Result<Layer> {
        let found = Traversability::new(&vehicle, elevation)?;
        let values = match args.what {
            What::Severity => found.severities().clone(),
            What::Hazard => found.hazard().clone(),
            What::Blocked => found.blocked().map(|&blocked| f32::from(u8::from(blocked))),
        };
        let unseen = elevation.uncertainty().map(|&u| if u < 1.0 { 0.0 } else { 1.0 });
        Ok(Layer::new(values, unseen)?)
    };
    let (kind, look) = match args.what {
        What::Severity => (
            Kind::floats("share of the vehicle's limits", ""),
            Look {
                range: Some((0.0, 1.0)),
                ..Look::new("Severity (1: blocked)", "share of limits", ColourMap::Cividis)
            },
        ),
        What::Hazard => (
            Kind::floats("hazard rate", "1/metre"),
            Look::new("Hazard rate", "per metre", ColourMap::Cividis),
        ),
        What::Blocked => (
            Kind::bytes("blocked: 1, free: 0"),
            Look::new("Blocked ground", "blocked", ColourMap::Classes(2))
                .classes(&["free", "blocked"]),
        ),
    };
    // The worst of slope and step under the footprint, which themselves reach one cell further.
    let reach = radius_cells + 1;
    match target {
        Target::Tiff(path) => {
            super::output::derive_with(&ground, uncertainty.as_ref(), path, kind, reach, judge)
        }
        Target::Picture(path) => draw_part(&ground, uncertainty.as_ref(), path, reach, look, judge),
    }
}

/// Heights with their uncertainty; cells of which that is not a share from 0 to 1 are refused.
pub(super) fn with_u(elevation: Layer, u: Option<GridFile>) -> anyhow::Result<Layer> {
    let Some(file) = u else { return Ok(elevation) };
    // Where the file has no uncertainty, nothing is certain.
    let u = Raster::from_fn(elevation.spec(), |cell| {
        if elevation.is_known(cell) && file.known[cell] { file.raster[cell] } else { 1.0 }
    });
    let layer = Layer::new(elevation.values().clone(), u);
    layer.map_err(|error| InputError(format!("--uncertainty: {error}")).into())
}

fn vehicle(args: &TraversabilityArgs) -> anyhow::Result<Vehicle> {
    let Some(path) = &args.vehicle else { return Ok(Vehicle::default()) };
    if let Some(preset) = path.to_str().and_then(|name| Preset::named(name).ok()) {
        return Ok(preset.vehicle());
    }
    let name = path.display();
    let wrong = |error: &dyn std::fmt::Display| InputError(format!("--vehicle {name}: {error}"));
    let text = std::fs::read_to_string(path).map_err(|error| {
        let presets: Vec<&str> = Preset::all().iter().map(|preset| preset.name()).collect();
        wrong(&format!("neither a preset ({}) nor a file: {error}", presets.join(", ")))
    })?;
    // The keys alone, or as they stand in a mission: there a preset may lie under them.
    let table: toml::Table = toml::from_str(&text).map_err(|error| wrong(&error))?;
    let (preset, keys) = match table.get("rover").and_then(toml::Value::as_table) {
        Some(rover) => {
            let keys = rover.get("vehicle").and_then(toml::Value::as_table).cloned();
            (rover.get("preset").cloned(), keys.unwrap_or_default())
        }
        None => (None, table),
    };
    let mut whole = match preset {
        Some(preset) => {
            let name = preset.as_str().ok_or_else(|| wrong(&"rover.preset is no text"))?;
            Preset::named(name).map_err(|error| wrong(&error))?.table()
        }
        None => toml::Table::new(),
    };
    whole.extend(keys);
    let vehicle: Vehicle = whole.try_into().map_err(|error| wrong(&error))?;
    vehicle.validate().map_err(|error| InputError(format!("--vehicle {name}: {error}")))?;
    Ok(vehicle)
}
