//! Terrain files as commands take them.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use wisdom_grid::{Cell, GridSpec, Window};
use wisdom_terrain::format::{GridFile, GridReader, MAX_CELLS};

use crate::exit::InputError;

/// A terrain file, or a window of it.
#[derive(clap::Args, Debug)]
pub(crate) struct Input {
    /// The elevation file, heights in metres.
    dem: PathBuf,
    /// Only this part of it.
    #[arg(long, value_name = "ROW,COL,ROWS,COLS")]
    window: Option<CellWindow>,
    /// Of a file of several bands this one, counted from 1.
    #[arg(long, value_name = "N")]
    band: Option<usize>,
}

impl Input {
    /// The file that is read.
    pub(super) fn path(&self) -> &Path {
        &self.dem
    }

    pub(super) fn open(&self) -> Result<Ground, InputError> {
        Ground::open(&self.dem, self.window, self.band)
    }
}

/// A window as it is typed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellWindow(Window);

impl FromStr for CellWindow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("`{text}`; expected ROW,COL,ROWS,COLS, such as 0,0,512,512");
        let numbers: Result<Vec<usize>, _> = text.split(',').map(|n| n.trim().parse()).collect();
        match numbers.map_err(|_| wanted())?[..] {
            [row, col, rows, cols] => Ok(Self(Window { row, col, rows, cols })),
            _ => Err(wanted()),
        }
    }
}

/// A cell as it is typed, column first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColRow(pub Cell);

impl FromStr for ColRow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let cell = text.split_once(',').and_then(|(col, row)| {
            Some(Cell { row: row.trim().parse().ok()?, col: col.trim().parse().ok()? })
        });
        cell.map(Self).ok_or_else(|| format!("`{text}`; expected COL,ROW, such as 256,256"))
    }
}

/// A terrain file at hand, of which a window is asked for.
pub(super) struct Ground {
    pub(super) reader: GridReader,
    pub(super) window: Window,
    name: String,
    /// Counted from 0.
    band: usize,
}

impl Ground {
    /// Without a band, the file must have one alone.
    pub(super) fn open(
        path: &Path,
        window: Option<CellWindow>,
        band: Option<usize>,
    ) -> Result<Self, InputError> {
        let reader = GridReader::open(path).map_err(|e| InputError(e.to_string()))?;
        let bands = reader.bands();
        let band = match band {
            None if bands == 1 => 0,
            None => {
                let name = path.display();
                let message =
                    format!("{name} has {bands} bands; choose one with --band 1 to {bands}");
                return Err(InputError(message));
            }
            Some(band) if (1..=bands).contains(&band) => band - 1,
            Some(band) => {
                let name = path.display();
                return Err(InputError(format!("--band {band}: {name} has bands 1 to {bands}")));
            }
        };
        let whole = reader.spec().window();
        let window = window.map_or(whole, |CellWindow(window)| window);
        let name = path.display().to_string();
        reader.spec().sub(window).map_err(|e| InputError(format!("{name}: --window: {e}")))?;
        Ok(Self { reader, window, name, band })
    }

    /// The band that is read, counted from 1.
    pub(super) fn band(&self) -> usize {
        self.band + 1
    }

    /// Where the window lies.
    pub(super) fn spec(&self) -> GridSpec {
        self.reader
            .spec()
            .sub(self.window)
            .expect("the window was checked when the file was opened")
    }

    /// A part of the file.
    pub(super) fn read(&self, window: Window) -> Result<GridFile, InputError> {
        let mut bands = self.reader.read_bands(window).map_err(|e| InputError(e.to_string()))?;
        Ok(bands.swap_remove(self.band))
    }

    /// A window and what lies around it in the file, as far as a derived layer reaches.
    pub(super) fn around(&self, window: Window, reach: usize) -> Window {
        let spec = self.reader.spec();
        let (north, west) = (window.row.saturating_sub(reach), window.col.saturating_sub(reach));
        let south = (window.row + window.rows + reach).min(spec.rows());
        let east = (window.col + window.cols + reach).min(spec.cols());
        Window { row: north, col: west, rows: south - north, cols: east - west }
    }

    /// What is asked for, in words; nothing if it is the whole file.
    pub(super) fn part(&self) -> String {
        let Window { row, col, rows, cols } = self.window;
        let spec = self.reader.spec();
        if self.window == spec.window() {
            return String::new();
        }
        format!(
            " (rows {row} to {}, columns {col} to {} of {} x {})",
            row + rows - 1,
            col + cols - 1,
            spec.rows(),
            spec.cols()
        )
    }

    /// The whole window at once, for what needs to see all of it.
    pub(super) fn whole(&self) -> Result<GridFile, InputError> {
        self.check_size()?;
        self.read(self.window)
    }

    /// Refuses a window too large to be looked at as one.
    pub(super) fn check_size(&self) -> Result<(), InputError> {
        if self.spec().len() > MAX_CELLS {
            let Window { rows, cols, .. } = self.window;
            return Err(InputError(format!(
                "{}: {rows} x {cols} cells; at most {MAX_CELLS} at once: choose a part with --window",
                self.name
            )));
        }
        Ok(())
    }

    /// The cell of the window that a cell of the file is.
    pub(super) fn local(&self, option: &str, cell: Cell) -> Result<Cell, InputError> {
        if self.window.contains(cell) {
            return Ok(Cell { row: cell.row - self.window.row, col: cell.col - self.window.col });
        }
        Err(InputError(format!("{option} {},{}: not in the {}", cell.col, cell.row, self.window)))
    }
}
