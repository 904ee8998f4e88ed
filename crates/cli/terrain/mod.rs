//! `wisdom terrain`: elevation files read, cut, resampled, made, and what can be derived from them.

mod convert;
mod info;
mod input;
mod layers;
mod output;
mod picture;
mod synthesize;
mod view;

use std::process::ExitCode;

use clap::Subcommand;

/// Read terrain files, derive layers from them, and make them.
///
/// Reads GeoTIFF, PDS3 images, PDS4 arrays, ISIS cubes, ESRI ASCII grids, 8- and 16-bit PNG and `.npy` arrays. A
/// result goes to a GeoTIFF (-o OUT.tif) at the place of what it was made from, or to a picture (-o OUT.png).
/// Rows count from the north, columns from the west, both from 0.
#[derive(clap::Args, Debug)]
pub(crate) struct TerrainArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Say what a terrain file holds and where it lies.
    Info(info::InfoArgs),
    /// Write a terrain file, or a part of it, as a GeoTIFF, on its own grid or another.
    Convert(convert::ConvertArgs),
    /// Gradient magnitude: rise over run.
    Gradient(layers::GradientArgs),
    /// Angle of the slope, degrees.
    Slope(layers::GradientArgs),
    /// Step height, metres: the largest difference to a neighbour.
    Step(layers::StepArgs),
    /// Roughness, metres: residual of the plane fitted under a footprint.
    Roughness(layers::RoughnessArgs),
    /// How a vehicle may cross each cell: severity, hazard rate, or what is blocked.
    Traversability(layers::TraversabilityArgs),
    /// The cells in sight of a camera on a mast: 1 in sight, 0 not.
    Viewshed(view::ViewshedArgs),
    /// Brightness under a low sun, 0 to 1.
    Hillshade(layers::HillshadeArgs),
    /// Draw a terrain file over its relief, as a map or as a surface.
    Figure(picture::FigureArgs),
    /// Make terrain from a description.
    Synthesize(synthesize::SynthesizeArgs),
}

pub(crate) fn run(args: &TerrainArgs) -> anyhow::Result<ExitCode> {
    match &args.command {
        Command::Info(args) => info::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Gradient(args) => layers::gradient(args),
        Command::Slope(args) => layers::slope(args),
        Command::Step(args) => layers::step(args),
        Command::Roughness(args) => layers::roughness(args),
        Command::Traversability(args) => layers::traversability(args),
        Command::Viewshed(args) => view::run(args),
        Command::Hillshade(args) => layers::hillshade(args),
        Command::Figure(args) => picture::run(args),
        Command::Synthesize(args) => synthesize::run(args),
    }?;
    Ok(ExitCode::SUCCESS)
}
