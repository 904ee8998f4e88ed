//! What the rover knows of the ground: measured layers in tiles made on first sight.

use std::collections::BTreeMap;

use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_terrain::Layer;

use crate::{AutonomyError, LayerWindow, MapUpdate};

/// Side of a tile, cells.
const TILE: usize = 64;

/// Readings and uncertainties of one tile, row by row.
#[derive(Debug, Clone)]
struct Tile {
    values: Vec<f32>,
    uncertainty: Vec<f32>,
}

impl Tile {
    fn unknown() -> Self {
        Self { values: vec![0.0; TILE * TILE], uncertainty: vec![1.0; TILE * TILE] }
    }
}

/// One measured layer.
#[derive(Debug, Clone)]
struct Measured {
    update: MapUpdate,
    tiles: BTreeMap<(usize, usize), Tile>,
}

impl Measured {
    /// Takes in a window of readings, tile by tile along each row. Returns the smallest window that holds what changed.
    fn take_in(&mut self, read: &LayerWindow) -> Option<Window> {
        let Window { row: north, col: west, rows, cols } = read.window;
        let mut changed: Option<Window> = None;
        for row in north..north + rows {
            let mut col = west;
            while col < west + cols {
                let end = ((col / TILE + 1) * TILE).min(west + cols);
                let from = (row - north) * cols + (col - west);
                let here = from..from + (end - col);
                let strip = self.take_in_strip(
                    Cell { row, col },
                    &read.values[here.clone()],
                    &read.uncertainty[here],
                );
                changed = changed.into_iter().chain(strip).reduce(Window::union);
                col = end;
            }
        }
        changed
    }

    /// Takes in readings of cells of one tile that lie in a row, the westernmost at `first`.
    fn take_in_strip(
        &mut self,
        first: Cell,
        values: &[f32],
        uncertainty: &[f32],
    ) -> Option<Window> {
        // A cell of which nothing was read makes no tile.
        uncertainty.iter().find(|&&u| u < 1.0)?;
        let tile =
            self.tiles.entry((first.row / TILE, first.col / TILE)).or_insert_with(Tile::unknown);
        let at = (first.row % TILE) * TILE + first.col % TILE;
        let known = tile.values[at..].iter_mut().zip(&mut tile.uncertainty[at..]);
        let mut changed: Option<(usize, usize)> = None;
        for (index, ((value, u), (&read, &read_u))) in
            known.zip(values.iter().zip(uncertainty)).enumerate()
        {
            if read_u >= 1.0 {
                continue;
            }
            let known = (*value, *u);
            let now = updated(self.update, known, (read, read_u));
            if now != known {
                (*value, *u) = now;
                changed = Some((changed.map_or(index, |(first, _)| first), index));
            }
        }
        changed.map(|(west, east)| Window {
            row: first.row,
            col: first.col + west,
            rows: 1,
            cols: east - west + 1,
        })
    }
}

/// The measured layers as the rover knows them. Only ground that was ever seen takes memory.
#[derive(Debug, Clone)]
pub struct Knowledge {
    spec: GridSpec,
    layers: BTreeMap<String, Measured>,
    version: u64,
}

impl Knowledge {
    /// Knows nothing yet of the named layers.
    #[must_use]
    pub fn new(spec: GridSpec, layers: impl IntoIterator<Item = (String, MapUpdate)>) -> Self {
        let layers = layers
            .into_iter()
            .map(|(name, update)| (name, Measured { update, tiles: BTreeMap::new() }))
            .collect();
        Self { spec, layers, version: 0 }
    }

    /// Grows by one with every observation that changed a reading.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Takes in windows of readings, each by its layer's map update. Returns the smallest window that holds every cell
    /// of which a reading changed; none if none did.
    ///
    /// # Errors
    /// [`AutonomyError`] if a window names no measured layer, leaves the grid, has the wrong number of values
    /// or holds a value that is not a number or an uncertainty outside [0, 1]; nothing is taken in then.
    pub fn take_in(&mut self, windows: &[LayerWindow]) -> Result<Option<Window>, AutonomyError> {
        for window in windows {
            self.check(window)?;
        }
        let changed = windows
            .iter()
            .filter_map(|read| self.layers.get_mut(&read.layer)?.take_in(read))
            .reduce(Window::union);
        self.version += u64::from(changed.is_some());
        Ok(changed)
    }

    fn check(&self, read: &LayerWindow) -> Result<(), AutonomyError> {
        if !self.layers.contains_key(&read.layer) {
            return Err(AutonomyError::NotMeasured { layer: read.layer.clone() });
        }
        let spec = self.spec.part(read.window)?;
        if read.values.len() != spec.len() || read.uncertainty.len() != spec.len() {
            return Err(AutonomyError::WindowLength {
                layer: read.layer.clone(),
                window: read.window,
                values: read.values.len(),
                uncertainties: read.uncertainty.len(),
            });
        }
        let mut readings = read.values.iter().zip(&read.uncertainty);
        match readings.position(|(value, u)| !value.is_finite() || !(0.0..=1.0).contains(u)) {
            None => Ok(()),
            Some(at) => Err(AutonomyError::Reading {
                layer: read.layer.clone(),
                cell: spec.cell(at),
                value: read.values[at],
                uncertainty: read.uncertainty[at],
            }),
        }
    }

    /// A window of a layer, unknown where no tile is; its cells keep the grid's numbers.
    ///
    /// # Errors
    /// [`AutonomyError`] if the layer is not measured or the window leaves the grid.
    pub fn layer(&self, name: &str, window: Window) -> Result<Layer, AutonomyError> {
        let measured = self
            .layers
            .get(name)
            .ok_or_else(|| AutonomyError::NotMeasured { layer: name.to_owned() })?;
        let spec = self.spec.part(window)?;
        let mut values = Raster::filled(spec, 0.0f32);
        let mut uncertainty = Raster::filled(spec, 1.0f32);
        for (&(tile_row, tile_col), tile) in &measured.tiles {
            let place =
                Window { row: tile_row * TILE, col: tile_col * TILE, rows: TILE, cols: TILE };
            let Some(part) = place.intersection(window) else { continue };
            for row in part.row..part.row + part.rows {
                let from = (row - place.row) * TILE + (part.col - place.col);
                let to = spec.index(Cell::new(row, part.col));
                values.values_mut()[to..to + part.cols]
                    .copy_from_slice(&tile.values[from..from + part.cols]);
                uncertainty.values_mut()[to..to + part.cols]
                    .copy_from_slice(&tile.uncertainty[from..from + part.cols]);
            }
        }
        Ok(Layer::new(values, uncertainty)?)
    }
}

/// A known (value, u) after a new one was read.
fn updated(update: MapUpdate, known: (f32, f32), read: (f32, f32)) -> (f32, f32) {
    match update {
        MapUpdate::Best if read.1 < known.1 => read,
        MapUpdate::Best => known,
        MapUpdate::Latest => read,
        MapUpdate::Weighted if known.1 >= 1.0 || read.1 <= 0.0 => read,
        MapUpdate::Weighted if known.1 <= 0.0 => known,
        MapUpdate::Weighted => {
            let (a, b) = (1.0 / f64::from(known.1), 1.0 / f64::from(read.1));
            let mean = (f64::from(known.0) * a + f64::from(read.0) * b) / (a + b);
            (mean as f32, (1.0 / (a + b)) as f32)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(layer: &str, at: (usize, usize), values: &[f32], u: f32) -> LayerWindow {
        LayerWindow {
            layer: layer.into(),
            window: Window { row: at.0, col: at.1, rows: 1, cols: values.len() },
            values: values.to_vec(),
            uncertainty: vec![u; values.len()],
        }
    }

    fn knowledge(update: MapUpdate) -> Knowledge {
        Knowledge::new(GridSpec::new(100, 200, 1.0).unwrap(), [("t".to_owned(), update)])
    }

    fn read(k: &Knowledge, cell: Cell) -> (f32, f32) {
        let layer = k.layer("t", k.spec.window()).unwrap();
        (layer.value(cell), layer.u(cell))
    }

    #[test]
    fn the_better_reading_stays_and_windows_may_cross_tiles() {
        let mut k = knowledge(MapUpdate::Best);
        let whole = Window { row: 63, col: 60, rows: 1, cols: 10 };
        assert_eq!(k.take_in(&[window("t", (63, 60), &[1.0; 10], 0.5)]).unwrap(), Some(whole));
        assert_eq!(k.take_in(&[window("t", (63, 60), &[2.0; 10], 0.6)]).unwrap(), None);
        assert_eq!(read(&k, Cell::new(63, 66)), (1.0, 0.5));
        let one = Window { col: 66, cols: 1, ..whole };
        assert_eq!(k.take_in(&[window("t", (63, 66), &[3.0], 0.2)]).unwrap(), Some(one));
        assert_eq!(read(&k, Cell::new(63, 66)), (3.0, 0.2));
        assert_eq!(read(&k, Cell::new(64, 66)), (0.0, 1.0));
        assert_eq!(k.version(), 2);
        // Two changes far apart lie in one window; what was no news beside them widens nothing.
        let apart = [window("t", (2, 4), &[5.0], 0.3), window("t", (7, 130), &[6.0], 0.4)];
        let both = Window { row: 2, col: 4, rows: 6, cols: 127 };
        assert_eq!(k.take_in(&apart).unwrap(), Some(both));
        let mut wider = window("t", (7, 129), &[6.0; 3], 0.4);
        wider.uncertainty = vec![1.0, 0.1, 1.0];
        let inner = Window { row: 7, col: 130, rows: 1, cols: 1 };
        assert_eq!(k.take_in(&[wider]).unwrap(), Some(inner));
        // A part of the map is the same as that part of the whole.
        let part = k.layer("t", Window { row: 60, col: 62, rows: 8, cols: 8 }).unwrap();
        assert_eq!(part.value(Cell::new(63, 66)), 3.0);
    }

    #[test]
    fn the_weighted_mean_leans_to_the_surer_reading() {
        let mut k = knowledge(MapUpdate::Weighted);
        k.take_in(&[window("t", (0, 0), &[10.0], 0.25)]).unwrap();
        k.take_in(&[window("t", (0, 0), &[20.0], 0.5)]).unwrap();
        let (value, u) = read(&k, Cell::new(0, 0));
        assert!((value - 40.0 / 3.0).abs() < 1e-5 && (u - 1.0 / 6.0).abs() < 1e-6);
        let mut k = knowledge(MapUpdate::Latest);
        k.take_in(&[window("t", (0, 0), &[10.0], 0.25)]).unwrap();
        k.take_in(&[window("t", (0, 0), &[20.0], 0.5)]).unwrap();
        assert_eq!(read(&k, Cell::new(0, 0)), (20.0, 0.5));
    }

    #[test]
    fn bad_readings_are_refused_whole() {
        let mut k = knowledge(MapUpdate::Best);
        let good = window("t", (0, 0), &[1.0], 0.0);
        for bad in [
            window("x", (0, 0), &[1.0], 0.0),
            window("t", (99, 199), &[1.0, 2.0], 0.0),
            window("t", (0, 0), &[f32::NAN], 0.0),
            window("t", (0, 0), &[1.0], 1.5),
        ] {
            assert!(k.take_in(&[good.clone(), bad]).is_err());
        }
        assert_eq!(k.version(), 0);
        assert_eq!(read(&k, Cell::new(0, 0)), (0.0, 1.0));
    }
}
