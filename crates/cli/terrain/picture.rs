//! Terrain as pictures: maps over a hillshade, and surfaces.

use std::path::{Path, PathBuf};

use wisdom_grid::{Cell, Raster};
use wisdom_terrain::{Layer, hillshade};

use super::input::{Ground, Input};
use super::output::{keep_inputs, known, spare, spinner, told};
use crate::exit::InputError;
use crate::figure::{Axes, ColourMap, Figure, Ink, Markers, Shape, Surface};

/// How a layer is to look.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a> {
    pub(super) title: &'a str,
    pub(super) label: &'a str,
    pub(super) map: ColourMap,
    pub(super) range: Option<(f64, f64)>,
    /// Whether the colours are shaded by the relief.
    pub(super) relief: bool,
    pub(super) classes: &'a [&'a str],
}

impl<'a> Look<'a> {
    pub(super) fn new(title: &'a str, label: &'a str, map: ColourMap) -> Self {
        Self { title, label, map, range: None, relief: true, classes: &[] }
    }

    /// Names of the classes.
    pub(super) fn classes(self, classes: &'a [&'a str]) -> Self {
        Self { classes, ..self }
    }
}

/// A place to be marked.
pub(super) struct Mark {
    pub(super) name: String,
    pub(super) cell: Cell,
}

/// Draws a layer, over the relief of the ground if that is given.
pub(super) fn draw(
    path: &Path,
    layer: &Layer,
    look: Look<'_>,
    elevation: Option<&Layer>,
) -> anyhow::Result<()> {
    draw_marked(path, layer, look, elevation, None)
}

/// Draws a layer and a mark in it.
pub(super) fn draw_marked(
    path: &Path,
    layer: &Layer,
    look: Look<'_>,
    elevation: Option<&Layer>,
    mark: Option<Mark>,
) -> anyhow::Result<()> {
    let known = known(layer);
    let shade = elevation
        .filter(|_| look.relief)
        .map(|elevation| hillshade(elevation, 315f64.to_radians(), 45f64.to_radians()));
    let mut figure = Figure::new(look.title, layer.values(), look.map)
        .value_label(look.label)
        .known(&known)
        .axes(Axes::Metres);
    if let Some((low, high)) = look.range {
        figure = figure.range(low, high);
    }
    if !look.classes.is_empty() {
        figure = figure.class_names(look.classes);
    }
    if let Some(shade) = &shade {
        figure = figure.hillshade(shade);
    }
    if let Some(Mark { name, cell }) = mark {
        let at = vec![(cell, String::new())];
        figure = figure.markers(Markers { name, shape: Shape::Star, ink: Ink::Vermilion, at });
    }
    let busy = spinner("drawing");
    figure.save(path)?;
    busy.finish_and_clear();
    told(path)
}

/// Draw a terrain file.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct FigureArgs {
    #[command(flatten)]
    input: Input,
    /// Where the picture goes.
    #[arg(short, long = "output", value_name = "FILE.png")]
    output: PathBuf,
    /// A layer on the same grid to give the colours, instead of the heights.
    #[arg(long, value_name = "FILE")]
    drape: Option<PathBuf>,
    /// The colours stand for classes, not for quantities.
    #[arg(long)]
    classes: bool,
    /// A surface seen from the side, instead of a map.
    #[arg(long)]
    surface: bool,
    /// With --surface: how many times heights are stretched.
    #[arg(long, value_name = "N", default_value_t = 1.0, requires = "surface")]
    exaggerate: f64,
    /// With --surface: where it is seen from, degrees clockwise from north.
    #[arg(long, value_name = "DEG", default_value_t = 217.5, requires = "surface")]
    from_deg: f64,
    /// What it is called.
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// What the colours stand for.
    #[arg(long, value_name = "TEXT")]
    label: Option<String>,
}

/// How many classes a layer has: whole numbers from 0 on.
fn classes(layer: &Layer) -> Result<usize, InputError> {
    let mut most = 0.0_f32;
    for (cell, &value) in layer.values().iter().filter(|(cell, _)| layer.is_known(*cell)) {
        if value.fract() != 0.0 || !(0.0..=255.0).contains(&value) {
            let message =
                format!("--classes: {value} at {cell}; classes are whole numbers from 0 to 255");
            return Err(InputError(message));
        }
        most = most.max(value);
    }
    Ok(most as usize + 1)
}

pub(super) fn run(args: &FigureArgs) -> anyhow::Result<()> {
    let path = args.output.as_path();
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        let message = format!("-o {}: a picture's name ends in .png", path.display());
        return Err(InputError(message).into());
    }
    spare(path, &[b"\x89PNG"], "picture")?;
    let inputs = [Some(args.input.path()), args.drape.as_deref()];
    keep_inputs(path, &inputs.into_iter().flatten().collect::<Vec<_>>())?;
    if !(args.exaggerate.is_finite() && args.exaggerate > 0.0) {
        let message = format!("--exaggerate {}: expected a number above 0", args.exaggerate);
        return Err(InputError(message).into());
    }
    let ground = args.input.open()?;
    let elevation = ground.whole()?.into_layer()?;
    let drape = match &args.drape {
        None => None,
        Some(drape) => {
            let file = Ground::open(drape, None, None)?;
            if file.reader.spec() != ground.reader.spec() {
                let message = format!(
                    "--drape {}: it lies on another grid than the elevation; bring it there with `wisdom terrain \
                     convert --like`",
                    drape.display()
                );
                return Err(InputError(message).into());
            }
            Some(file.read(ground.window)?.into_layer()?)
        }
    };
    let layer = drape.as_ref().unwrap_or(&elevation);
    let shown = args.drape.as_deref().unwrap_or(args.input.path());
    let stem = shown.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let title = args.title.clone().or(stem).unwrap_or_default() + &ground.part();
    let title = title.as_str();
    let (label, map) = match (&drape, args.classes) {
        (_, true) => ("class", ColourMap::Classes(classes(layer)?)),
        (None, false) => ("elevation, m", ColourMap::Viridis),
        (Some(_), false) => ("value", ColourMap::Viridis),
    };
    let label = args.label.as_deref().unwrap_or(label);
    if !args.surface {
        // Class numbers are no relief.
        let relief = drape.is_some() || !args.classes;
        let look = Look { relief, ..Look::new(title, label, map) };
        return draw(path, layer, look, Some(&elevation));
    }
    let known = known(&elevation);
    // Ground that is known may lack a value to colour it by.
    let values = Raster::from_fn(layer.spec(), |cell| {
        if layer.is_known(cell) { layer.value(cell) } else { f32::NAN }
    });
    Surface::new(title, elevation.values(), &values, map)
        .value_label(label)
        .known(&known)
        .exaggeration(args.exaggerate)
        .view(args.from_deg.to_radians(), 36f64.to_radians())
        .save(path)?;
    told(path)
}
