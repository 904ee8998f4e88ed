//! Results as commands give them: a GeoTIFF, written row by row, or a picture.

use std::io::{IsTerminal, Read, Write};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use wisdom_grid::{GridSpec, Raster, Window};
use wisdom_terrain::format::{GeoTiffOptions, GridFile, Sample, write_geotiff_by};
use wisdom_terrain::{Crs, Layer, TerrainError};

use super::input::Ground;
use super::layers::with_u;
use crate::exit::InputError;

/// Cells worked on at once: a band of whole rows.
const BAND_CELLS: usize = 1 << 22;

/// Where a result goes.
#[derive(clap::Args, Debug)]
pub(crate) struct Output {
    /// Where the result goes: a GeoTIFF (.tif, .tiff) or a picture (.png).
    #[arg(short, long = "output", value_name = "FILE")]
    output: PathBuf,
}

/// What the name of the result asks for.
pub(super) enum Target<'a> {
    Tiff(&'a Path),
    Picture(&'a Path),
}

impl Output {
    /// What the result is to be. Nothing but a GeoTIFF or a picture is written over, and none of the files that are read.
    pub(super) fn target(&self, inputs: &[&Path]) -> Result<Target<'_>, InputError> {
        let path = self.output.as_path();
        keep_inputs(path, inputs)?;
        let extension = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
        match extension.as_ref().and_then(|e| e.to_str()) {
            Some("tif" | "tiff") => {
                spare(path, &[b"II", b"MM"], "GeoTIFF")?;
                Ok(Target::Tiff(path))
            }
            Some("png") => {
                spare(path, &[b"\x89PNG"], "picture")?;
                Ok(Target::Picture(path))
            }
            _ => Err(InputError(format!(
                "-o {}: expected a name that ends in .tif (a GeoTIFF) or .png (a picture)",
                path.display()
            ))),
        }
    }
}

/// Refuses a name that is one of the files that are read, and a folder that is not there.
pub(super) fn keep_inputs(path: &Path, inputs: &[&Path]) -> Result<(), InputError> {
    let name = path.display();
    let place = |path: &Path| path.canonicalize().ok();
    if let Some(here) = place(path)
        && inputs.iter().any(|input| place(input).is_some_and(|there| there == here))
    {
        return Err(InputError(format!("-o {name}: it is read here; choose another name")));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            Err(InputError(format!("-o {name}: there is no folder {}", folder.display())))
        }
        _ => Ok(()),
    }
}

/// Refuses to write over what is not of the kind that is written.
pub(super) fn spare(path: &Path, magics: &[&[u8]], what: &str) -> Result<(), InputError> {
    let mut begin = Vec::new();
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(InputError(format!("-o {}: {error}", path.display()))),
    };
    let read = file.take(8).read_to_end(&mut begin);
    let older = magics.iter().any(|magic| begin.starts_with(magic));
    if read.is_ok() && (older || begin.is_empty()) {
        return Ok(());
    }
    Err(InputError(format!("-o {}: is there already, and is no {what}", path.display())))
}

/// What a GeoTIFF of a result says of itself.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub(super) description: &'static str,
    pub(super) unit: &'static str,
    pub(super) sample: Sample,
}

impl Kind {
    pub(super) fn floats(description: &'static str, unit: &'static str) -> Self {
        Self { description, unit, sample: Sample::F32 }
    }

    pub(super) fn bytes(description: &'static str) -> Self {
        Self { description, unit: "", sample: Sample::U8 }
    }

    pub(super) fn options(self) -> GeoTiffOptions {
        let mut options = GeoTiffOptions::new(self.sample);
        self.description.clone_into(&mut options.description);
        self.unit.clone_into(&mut options.unit);
        options
    }
}

/// Values and whether they are known, row by row.
pub(super) type Band = (Vec<f32>, Vec<bool>);

/// Writes a GeoTIFF band by band, each a number of whole rows that `make` gives, and tells how far it is.
pub(super) fn write(
    path: &Path,
    spec: GridSpec,
    crs: Option<&Crs>,
    options: &GeoTiffOptions,
    mut make: impl FnMut(std::ops::Range<usize>) -> Result<Band, InputError>,
) -> anyhow::Result<()> {
    let bar = bar(&path.display().to_string(), spec.rows())?;
    let step = (BAND_CELLS / spec.cols()).max(1);
    let written = write_geotiff_by(path, spec, crs, options, |writer| {
        for from in (0..spec.rows()).step_by(step) {
            let rows = from..(from + step).min(spec.rows());
            bar.set_position(rows.start as u64);
            let (values, known) = make(rows).map_err(Stop::Input)?;
            writer.write_rows(&values, &known)?;
        }
        Ok(())
    });
    bar.finish_and_clear();
    match written {
        Ok(()) => told(path),
        Err(Stop::Input(error)) => Err(error.into()),
        Err(Stop::Terrain(error)) => Err(error.into()),
    }
}

/// Why writing stopped.
enum Stop {
    Input(InputError),
    Terrain(TerrainError),
}

impl From<TerrainError> for Stop {
    fn from(error: TerrainError) -> Self {
        Self::Terrain(error)
    }
}

/// Derives a layer whose cells depend on those within `reach` of them, band by band.
pub(super) fn derive(
    ground: &Ground,
    path: &Path,
    kind: Kind,
    reach: usize,
    make: impl Fn(&Layer) -> anyhow::Result<Layer>,
) -> anyhow::Result<()> {
    derive_with(ground, None, path, kind, reach, make)
}

/// As [`derive()`], with the uncertainty of the heights from another file on the same grid.
pub(super) fn derive_with(
    ground: &Ground,
    uncertainty: Option<&Ground>,
    path: &Path,
    kind: Kind,
    reach: usize,
    make: impl Fn(&Layer) -> anyhow::Result<Layer>,
) -> anyhow::Result<()> {
    let window = ground.window;
    let mut failed = None;
    let written = write(path, ground.spec(), ground.reader.crs(), &kind.options(), |rows| {
        let wanted = Window { row: window.row + rows.start, rows: rows.len(), ..window };
        let near = ground.around(wanted, reach);
        let read = ground.read(near)?;
        let u = uncertainty.map(|file| file.read(near)).transpose()?;
        let layer = read.into_layer().map_err(|e| InputError(e.to_string()))?;
        let derived = with_u(layer, u).and_then(|layer| make(&layer)).map_err(|error| {
            let message = InputError(error.to_string());
            failed = Some(error);
            message
        })?;
        let cut = Window { row: wanted.row - near.row, col: wanted.col - near.col, ..wanted };
        let derived = derived.crop(cut).map_err(|e| InputError(e.to_string()))?;
        Ok(band_of_layer(&derived))
    });
    match (written, failed) {
        (Err(_), Some(error)) => Err(error),
        (written, _) => written,
    }
}

/// A layer's values, and where it has them.
fn band_of_layer(layer: &Layer) -> Band {
    (layer.values().values().to_vec(), known(layer).into_values())
}

/// Where a layer has a value.
pub(super) fn known(layer: &Layer) -> Raster<bool> {
    layer.uncertainty().map(|&u| u < 1.0)
}

/// Where a file has a value, beside its values.
pub(super) fn band_of(file: GridFile) -> Band {
    (file.raster.into_values(), file.known.into_values())
}

/// A bar for work on so many rows, if somebody watches.
pub(super) fn bar(name: &str, rows: usize) -> anyhow::Result<ProgressBar> {
    let shown = std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(rows as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{prefix} {bar:30} {percent:>3} %  {elapsed}, {eta} to go",
    )?);
    bar.set_prefix(name.to_owned());
    Ok(bar)
}

/// Shows that work goes on of which nobody knows how long it takes, if somebody watches.
pub(super) fn spinner(text: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let spinner = ProgressBar::new_spinner().with_message(text.to_owned());
    spinner.enable_steady_tick(std::time::Duration::from_millis(100));
    spinner
}

/// Says what was written.
pub(super) fn told(path: &Path) -> anyhow::Result<()> {
    writeln!(std::io::stdout().lock(), "{}", path.display())?;
    Ok(())
}
