//! `wisdom terrain convert`.

use std::path::PathBuf;

use wisdom_grid::{GridSpec, Window};
use wisdom_terrain::format::GridFile;
use wisdom_terrain::{Resampling, covering, resample};

use super::input::{CellWindow, Ground};
use super::output::{Kind, band_of, keep_inputs, spare, write};
use crate::exit::InputError;

/// Write a terrain file as a GeoTIFF.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct ConvertArgs {
    /// The file to read.
    input: PathBuf,
    /// The GeoTIFF to write.
    output: PathBuf,
    /// Only this part of it.
    #[arg(long, value_name = "ROW,COL,ROWS,COLS")]
    window: Option<CellWindow>,
    /// Onto another grid, by: nearest, bilinear, average or mode. Needs --spacing-m or --like.
    #[arg(long, value_name = "METHOD")]
    resample: Option<Resampling>,
    /// Spacing of the new grid, metres; it begins at the same north-west corner.
    #[arg(long, value_name = "M", requires = "resample", conflicts_with = "like")]
    spacing_m: Option<f64>,
    /// What stands for "no data" in the GeoTIFF.
    #[arg(long, value_name = "V", default_value_t = -32767.0)]
    nodata: f64,
    /// Of a file of several bands this one, counted from 1.
    #[arg(long, value_name = "N")]
    band: Option<usize>,
    /// The grid of this file, which must be of the same projection.
    #[arg(long, value_name = "FILE", requires = "resample")]
    like: Option<PathBuf>,
}

pub(super) fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    let path = args.output.as_path();
    if !path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("tif") || e.eq_ignore_ascii_case("tiff"))
    {
        let message =
            format!("{}: expected a name that ends in .tif: GeoTIFF is written", path.display());
        return Err(InputError(message).into());
    }
    spare(path, &[b"II", b"MM"], "GeoTIFF")?;
    let inputs = [Some(args.input.as_path()), args.like.as_deref()];
    keep_inputs(path, &inputs.into_iter().flatten().collect::<Vec<_>>())?;
    let ground = Ground::open(&args.input, args.window, args.band)?;
    let crs = ground.reader.crs();
    let mut options = Kind::floats("", "").options();
    options.nodata = Some(args.nodata);
    let Some(way) = args.resample else {
        return write(path, ground.spec(), crs, &options, |rows| {
            let window =
                Window { row: ground.window.row + rows.start, rows: rows.len(), ..ground.window };
            Ok(band_of(ground.read(window)?))
        });
    };
    let onto = grid(args, &ground)?;
    // Of the file only what lies in the window counts.
    let from = ground.spec();
    if covering(from, onto).is_none() {
        let message = "--like: the two grids do not meet anywhere".to_owned();
        return Err(InputError(message).into());
    }
    write(path, onto, crs, &options, |rows| {
        let band = Window { row: rows.start, col: 0, rows: rows.len(), cols: onto.cols() };
        let part = onto.sub(band).map_err(|e| InputError(e.to_string()))?;
        let Some(under) = covering(from, part) else { return Ok(band_of(GridFile::unknown(part))) };
        let shifted = Window {
            row: under.row + ground.window.row,
            col: under.col + ground.window.col,
            ..under
        };
        Ok(band_of(resample(&ground.read(shifted)?, part, way)))
    })
}

/// The grid to write on.
fn grid(args: &ConvertArgs, ground: &Ground) -> Result<GridSpec, InputError> {
    if let Some(like) = &args.like {
        let other = Ground::open(like, None, Some(1))?;
        if let (Some(a), Some(b)) = (ground.reader.crs(), other.reader.crs())
            && !a.same_projection(b)
        {
            return Err(InputError(format!(
                "--like {}: its map projection ({b}) is not that of {} ({a})",
                like.display(),
                args.input.display()
            )));
        }
        return Ok(other.reader.spec());
    }
    let Some(spacing_m) = args.spacing_m else {
        return Err(InputError(
            "--resample: onto which grid? Add --spacing-m M or --like FILE".to_owned(),
        ));
    };
    if !(spacing_m.is_finite() && spacing_m > 0.0) {
        return Err(InputError(format!("--spacing-m {spacing_m}: expected a number above 0")));
    }
    let spec = ground.spec();
    let cells = |count: usize| (count as f64 * spec.spacing_m() / spacing_m - 1e-9).ceil().max(1.0);
    let (rows, cols) = (cells(spec.rows()), cells(spec.cols()));
    let grid = GridSpec::new(rows as usize, cols as usize, spacing_m);
    let grid = grid.map_err(|e| InputError(format!("--spacing-m {spacing_m}: {e}")))?;
    Ok(grid.at(spec.west_m(), spec.north_m()))
}
