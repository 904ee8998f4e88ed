//! The layers as they truly are: in memory, or read or drawn piece by piece from ground larger than that.

use std::borrow::Cow;
use std::sync::Arc;

use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_terrain::format::{GridFile, GridReader};
use wisdom_terrain::{Landscape, Layer, Resampling, SceneLayer, TerrainError, covering, resample};

/// How a layer is read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ReadingKind {
    /// A quantity: its error is normal with standard deviation `sigma`·u.
    Scalar { sigma: f64 },
    /// A class: another one of these with probability u/2.
    Class { classes: Vec<f32> },
}

/// Where true values come from.
#[derive(Debug, Clone)]
pub(crate) enum Values {
    /// All of them in memory.
    Memory(Layer),
    /// A file, tile by tile.
    File(FileValues),
    /// A scene that is drawn where it is looked at.
    Scene { scene: Arc<Landscape>, layer: SceneLayer, seed: u64 },
    /// A file that is known by its digest alone.
    Elsewhere { name: String },
    /// Nobody's: what is known of it is handed in.
    HandedIn,
}

/// A file's values, on its own grid or resampled onto the mission's.
#[derive(Debug, Clone)]
pub(crate) struct FileValues {
    pub reader: Arc<GridReader>,
    pub resampling: Option<Resampling>,
}

impl FileValues {
    /// The values of a part of the mission's grid.
    fn read(&self, part: GridSpec) -> Result<GridFile, TerrainError> {
        let Some(resampling) = self.resampling else { return self.reader.read(part.window()) };
        let place = part.numbered_from(Cell::new(0, 0));
        match covering(self.reader.spec(), place) {
            Some(window) => Ok(resample(&self.reader.read(window)?, place, resampling)),
            None => Ok(GridFile::unknown(place)),
        }
    }
}

/// The data's own uncertainty.
#[derive(Debug, Clone)]
pub(crate) enum SiteU {
    /// All of it in memory.
    Memory(Raster<f32>),
    /// A file, tile by tile.
    File(FileValues),
}

/// A measured layer as it truly is.
#[derive(Debug, Clone)]
pub(crate) struct LayerTruth {
    /// The mission's grid.
    pub grid: GridSpec,
    pub values: Values,
    /// The data's own uncertainty, where a file gives one.
    pub site_u: Option<SiteU>,
    pub kind: ReadingKind,
}

impl LayerTruth {
    /// The whole layer, if it lies in memory.
    pub(crate) fn in_memory(&self) -> Option<&Layer> {
        match &self.values {
            Values::Memory(layer) => Some(layer),
            _ => None,
        }
    }

    /// Whether its values can be had at all.
    pub(crate) fn is_at_hand(&self) -> bool {
        !matches!(self.values, Values::Elsewhere { .. })
    }

    /// Whether nothing is known of it but what is handed in.
    pub(crate) fn is_handed_in(&self) -> bool {
        matches!(self.values, Values::HandedIn)
    }

    /// At least a window of the layer, its cells numbered as the mission's.
    pub(crate) fn window(&self, window: Window) -> Result<Cow<'_, Layer>, TerrainError> {
        if let Values::Memory(layer) = &self.values {
            return Ok(Cow::Borrowed(layer));
        }
        let part = self.grid.part(window)?;
        let layer = match &self.values {
            Values::Memory(layer) => layer.clone(),
            Values::File(file) => file.read(part)?.into_layer()?,
            Values::Scene { scene, layer, seed } => {
                Layer::certain(scene.render_layer(*layer, part, *seed))?
            }
            Values::Elsewhere { name } => {
                let reason = "it is known by its digest alone, and not at hand".to_owned();
                return Err(TerrainError::File { name: name.clone(), reason });
            }
            Values::HandedIn => Layer::unknown(part),
        };
        Ok(Cow::Owned(layer.numbered_from(part.first())))
    }

    /// At least a window of the data's own uncertainty: 1 where there is none.
    fn site_u(&self, window: Window) -> Result<Option<Cow<'_, Raster<f32>>>, TerrainError> {
        match &self.site_u {
            None => Ok(None),
            Some(SiteU::Memory(u)) => Ok(Some(Cow::Borrowed(u))),
            Some(SiteU::File(file)) => {
                let part = self.grid.part(window)?;
                let read = site_u(&file.read(part)?).map_err(|(cell, u)| {
                    let at =
                        Cell { row: part.first().row + cell.row, col: part.first().col + cell.col };
                    TerrainError::Uncertainty { cell: at, u }
                })?;
                Ok(Some(Cow::Owned(read.numbered_from(part.first()))))
            }
        }
    }

    /// Block means of a window of the truth, as from orbit: bilinear between the middles of the blocks for quantities
    /// (steps at block edges would be cliffs to a slope expert), the commonest class of each block for classes. The
    /// uncertainty is `u`, or the data's own where larger. Blocks are those of the whole ground, whatever the window.
    pub(crate) fn averaged(
        &self,
        block: usize,
        u: f32,
        window: Window,
    ) -> Result<(Raster<f32>, Raster<f32>), TerrainError> {
        let part = self.grid.part(window)?;
        let blocks = Blocks::over(self.grid, block, window);
        let layer = self.window(blocks.cells())?;
        let own = self.site_u(window)?;
        let u = Raster::from_fn(part, |cell| {
            let own = own.as_ref().map_or(0.0, |own| own[cell]);
            if layer.is_known(cell) { u.max(own) } else { 1.0 }
        });
        let values = match &self.kind {
            ReadingKind::Class { classes } => {
                let commonest = blocks.each(|cells| commonest(&layer, classes, cells));
                Raster::from_fn(part, |cell| commonest[blocks.of(cell)])
            }
            ReadingKind::Scalar { .. } => {
                let means = blocks.each(|cells| mean(&layer, cells));
                Raster::from_fn(part, |cell| blocks.between(&means, cell))
            }
        };
        let seen = Raster::from_fn(part, |cell| if u[cell] < 1.0 { values[cell] } else { 0.0 });
        Ok((seen, u))
    }
}

/// An uncertainty file as it is used: 1 where it has no value. A number that is no share is told with its cell.
pub(crate) fn site_u(file: &GridFile) -> Result<Raster<f32>, (Cell, f32)> {
    let off = |(cell, u): &(Cell, &f32)| file.known[*cell] && !(0.0..=1.0).contains(*u);
    if let Some((cell, &u)) = file.raster.iter().find(off) {
        return Err((cell, u));
    }
    let of = |cell| if file.known[cell] { file.raster[cell] } else { 1.0 };
    Ok(Raster::from_fn(file.raster.spec(), of))
}

/// The class most cells of a block have; of several, the one listed first; 0 where nothing is known.
fn commonest(layer: &Layer, classes: &[f32], cells: Window) -> f32 {
    let known: Vec<Cell> = cells.cells().filter(|c| layer.is_known(*c)).collect();
    let count = |class: f32| known.iter().filter(|c| layer.value(**c) == class).count();
    let mut best = (count(0.0), 0.0f32);
    for &class in classes {
        if count(class) > best.0 {
            best = (count(class), class);
        }
    }
    best.1
}

/// Mean of a block. One of which nothing is known has none, and must not be mixed into its neighbours.
fn mean(layer: &Layer, cells: Window) -> Option<f64> {
    let known: Vec<Cell> = cells.cells().filter(|c| layer.is_known(*c)).collect();
    let first = f64::from(layer.value(*known.first()?));
    let above: f64 = known.iter().map(|c| f64::from(layer.value(*c)) - first).sum();
    Some(first + above / known.len() as f64)
}

/// Square blocks that a ground is divided into, from its north-west corner on; those around a window.
struct Blocks {
    grid: GridSpec,
    side: usize,
    /// Blocks of the whole ground, down and across.
    rows: usize,
    cols: usize,
    /// Those that matter to the window.
    near: Window,
}

impl Blocks {
    /// The blocks under a window and one around it.
    fn over(grid: GridSpec, side: usize, window: Window) -> Self {
        let (rows, cols) = (grid.rows().div_ceil(side), grid.cols().div_ceil(side));
        let along = |from: usize, cells: usize, blocks: usize| {
            let low = (from / side).saturating_sub(1);
            (low, ((from + cells - 1) / side + 2).min(blocks) - low)
        };
        let ((row, near_rows), (col, near_cols)) =
            (along(window.row, window.rows, rows), along(window.col, window.cols, cols));
        let near = Window { row, col, rows: near_rows, cols: near_cols };
        Self { grid, side, rows, cols, near }
    }

    /// The cells of a block, given by its row and column among the blocks.
    fn block(&self, row: usize, col: usize) -> Window {
        let (row, col) = (row * self.side, col * self.side);
        let rows = self.side.min(self.grid.rows() - row);
        Window { row, col, rows, cols: self.side.min(self.grid.cols() - col) }
    }

    /// The cells of all blocks that matter.
    fn cells(&self) -> Window {
        let Window { row, col, rows, cols } = self.near;
        self.block(row, col).union(self.block(row + rows - 1, col + cols - 1))
    }

    /// Something of each block that matters.
    fn each<T>(&self, of: impl Fn(Window) -> T) -> Vec<T> {
        self.near.cells().map(|block| of(self.block(block.row, block.col))).collect()
    }

    /// Index among those of [`Blocks::each`].
    fn index(&self, row: usize, col: usize) -> usize {
        (row - self.near.row) * self.near.cols + col - self.near.col
    }

    /// The index of the block that a cell lies in.
    fn of(&self, cell: Cell) -> usize {
        self.index(cell.row / self.side, cell.col / self.side)
    }

    /// What lies at a cell, bilinear between the middles of the blocks.
    fn between(&self, means: &[Option<f64>], cell: Cell) -> f32 {
        let along = |at: usize, count: usize| {
            let place = ((at as f64 + 0.5) / self.side as f64 - 0.5).clamp(0.0, (count - 1) as f64);
            let low = (place as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), place - low as f64)
        };
        let ((north, south, down), (west, east, right)) =
            (along(cell.row, self.rows), along(cell.col, self.cols));
        let mix = |a: Option<f64>, b: Option<f64>, share: f64| match (a, b) {
            (Some(a), Some(b)) => Some(a + (b - a) * share),
            (one, other) => one.or(other),
        };
        let at = |row, col| means[self.index(row, col)];
        let upper = mix(at(north, west), at(north, east), right);
        let lower = mix(at(south, west), at(south, east), right);
        mix(upper, lower, down).unwrap_or(0.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn block_means_of_a_plane_are_the_plane_inside() {
        let grid = GridSpec::new(24, 24, 1.0).unwrap();
        let plane = Raster::from_fn(grid, |c| c.row as f32 * 2.0 - c.col as f32);
        let truth = LayerTruth {
            grid,
            values: Values::Memory(Layer::certain(plane.clone()).unwrap()),
            site_u: None,
            kind: ReadingKind::Scalar { sigma: 0.0 },
        };
        let (values, u) = truth.averaged(8, 0.6, grid.window()).unwrap();
        for row in 4..20 {
            for col in 4..20 {
                let cell = Cell { row, col };
                assert!((values[cell] - plane[cell]).abs() < 1e-4, "{cell}");
            }
        }
        assert!(u.values().iter().all(|u| *u == 0.6));
    }

    #[test]
    fn a_window_of_the_view_from_orbit_is_that_part_of_the_whole_view() {
        let grid = GridSpec::new(53, 47, 1.0).unwrap();
        let scene: Arc<Landscape> = Arc::new(
            toml::from_str(
                r#"
                [roughness]
                amplitude_m = 9.0
                wavelength_cells = 11.0
                octaves = 4
                gain = 0.5
                [[rock]]
                centre = [20.0, 30.0]
                half-axes = [4.0, 3.0]
                height_m = 5.0
                wall = "dome"
                wall_cells = 3.0
                [[patch]]
                class = 2
                shape = { disc = { centre = [20.0, 30.0], radius_cells = 9.0 } }
                "#,
            )
            .unwrap(),
        );
        for (layer, kind) in [
            (SceneLayer::Elevation, ReadingKind::Scalar { sigma: 0.0 }),
            (SceneLayer::Texture, ReadingKind::Class { classes: vec![0.0, 2.0] }),
        ] {
            let whole = Layer::certain(scene.render_layer(layer, grid, 7)).unwrap();
            let truth = |values| LayerTruth { grid, values, site_u: None, kind: kind.clone() };
            let memory = truth(Values::Memory(whole));
            let drawn = truth(Values::Scene { scene: Arc::clone(&scene), layer, seed: 7 });
            let (values, u) = memory.averaged(8, 0.6, grid.window()).unwrap();
            for window in [
                Window { row: 0, col: 0, rows: 10, cols: 9 },
                Window { row: 17, col: 21, rows: 20, cols: 3 },
                Window { row: 50, col: 40, rows: 3, cols: 7 },
                grid.window(),
            ] {
                let (part, part_u) = drawn.averaged(8, 0.6, window).unwrap();
                for cell in window.cells() {
                    assert_eq!((part[cell], part_u[cell]), (values[cell], u[cell]), "{cell}");
                }
            }
        }
    }

    #[test]
    fn a_block_without_data_is_not_mixed_into_its_neighbours() {
        let grid = GridSpec::new(16, 16, 1.0).expect("a grid");
        let values = Raster::from_fn(grid, |c| if c.col < 8 { -4500.0f32 } else { 0.0 });
        let u = Raster::from_fn(grid, |c| if c.col < 8 { 0.0f32 } else { 1.0 });
        let truth = LayerTruth {
            grid,
            values: Values::Memory(Layer::new(values, u).expect("a layer")),
            site_u: None,
            kind: ReadingKind::Scalar { sigma: 0.0 },
        };
        let (values, u) = truth.averaged(8, 0.6, grid.window()).unwrap();
        for cell in grid.cells() {
            let expected = if cell.col < 8 { (-4500.0, 0.6) } else { (0.0, 1.0) };
            assert_eq!((values[cell], u[cell]), expected, "{cell}");
        }
    }

    #[test]
    fn the_commonest_class_stands_for_its_block() {
        let grid = GridSpec::new(4, 4, 1.0).unwrap();
        let classes = Raster::from_fn(grid, |c| if c.col < 3 { 2.0f32 } else { 1.0 });
        let truth = LayerTruth {
            grid,
            values: Values::Memory(Layer::certain(classes).unwrap()),
            site_u: Some(SiteU::Memory(Raster::filled(grid, 0.9))),
            kind: ReadingKind::Class { classes: vec![1.0, 2.0] },
        };
        let (values, u) = truth.averaged(4, 0.6, grid.window()).unwrap();
        assert!(values.values().iter().all(|c| *c == 2.0));
        assert!(u.values().iter().all(|u| *u == 0.9));
    }
}
