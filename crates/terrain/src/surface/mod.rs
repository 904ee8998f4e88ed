//! The shape of the ground at each cell: gradient, slope, step, roughness; and its look in a figure.
//!
//! [`measure`] derives any of them in one pass over the heights; [`gradient`], [`slope`], [`step`], [`roughness`]
//! and [`hazards`] are short for it.
//!
//! All is in single precision, as the heights are. Heights are subtracted before anything else: near −4500 m they
//! step by 0.5 mm, but the difference of two that lie within a factor of two of each other is exact, and that of any
//! others is rounded once, so what follows is good to some 1e-7 of the height differences around the cell whatever
//! the height above the datum. Heights so far apart that their difference, or its square, is beyond the largest `f32`
//! (some 1e19 m) count as just that number, so that no layer holds an infinity or a NaN; differences below 1e-19 m
//! may count as none.
//!
//! No result depends on the number of threads, on how rows are handed out to them, or on the processor's vector
//! instructions: each cell is the same few operations in the same order.
#![expect(
    clippy::inline_always,
    reason = "code for an instruction set is compiled only where it is inlined"
)]

mod angle;
mod gradient;
mod hazard;
mod hillshade;
mod plane;
mod stencil;
mod width;

pub use gradient::{Kernel, UnknownKernel};
pub use hillshade::hillshade;

use rayon::prelude::*;
use wisdom_grid::GridSpec;

use crate::Layer;
use angle::Degrees;
use gradient::{Central, Horn};
use hazard::Step;
use plane::PlaneFit;
use stencil::{Ground, Row, Seen, Stencil};
use width::Instructions;

/// Something to derive from an elevation layer in metres, cell by cell.
///
/// Its u is the worst u among the cells it is derived from; u = 1 where it cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Gradient magnitude |∇z|: rise over run, no unit (the paper's "modulus of the gradient", Table 1).
    ///
    /// With w the cell spacing, the rise along rows and along columns alike is
    /// - [`Kernel::Central`]: `next − previous` over 2w. Where one of the two is off the map or unknown, the cell
    ///   itself takes its place, over w.
    /// - [`Kernel::Horn`]: the mean of the central differences of the cell's own line, which counts twice, and the
    ///   two beside it; lines that lack one of their ends do not count. If all three do, the mean of their one-sided
    ///   differences by the same weights takes its place (as at the map's edge).
    ///
    /// Unknown only where an axis has no difference to take.
    Gradient(Kernel),
    /// Angle of the slope, **degrees**: atan |∇z|, off by at most 2e-7 rad; unknown where the gradient is.
    SlopeDeg(Kernel),
    /// Step height, metres: the largest difference to a known neighbour among the eight (a hazard of Goldberg,
    /// Maimone and Matthies, 2002). Unknown where the cell itself or each of its neighbours is.
    Step,
    /// Roughness, metres: root mean square residual of the plane fitted to the known cells within a radius, as in
    /// GESTALT (Goldberg, Maimone and Matthies, 2002).
    ///
    /// Unknown where the cell itself is, or where the known cells number fewer than four or lie on one line (three
    /// cells leave no residual).
    ///
    /// Around a hole or at the edge the fit is in double precision. Over a whole disc it is a closed form in single
    /// precision, off by at most 1e-6 of the largest height difference within discs of up to eight cells' radius.
    Roughness {
        /// Radius of the footprint in cells: Euclidean, between centres.
        radius_cells: usize,
    },
}

/// All layers of hazard, made in one pass by [`hazards`].
#[derive(Debug, Clone, PartialEq)]
pub struct Hazards {
    /// Gradient magnitude by central differences: rise over run.
    pub gradient: Layer,
    /// Angle of that slope, degrees.
    pub slope_deg: Layer,
    /// Step height, metres.
    pub step_m: Layer,
    /// Roughness, metres.
    pub roughness_m: Layer,
}

/// Derives layers from an elevation layer in metres, all in one pass and no others.
///
/// ```
/// # use wisdom_grid::{Cell, GridSpec, Raster};
/// # use wisdom_terrain::{Kernel, Layer, Measure, measure};
/// let ramp = Raster::from_fn(GridSpec::new(5, 5, 2.0)?, |cell| 3.0 * cell.col as f32);
/// let [gradient, roughness] = measure(
///     &Layer::certain(ramp)?,
///     [Measure::Gradient(Kernel::Horn), Measure::Roughness { radius_cells: 2 }],
/// );
/// assert_eq!(gradient.value(Cell::new(0, 0)), 1.5);
/// assert_eq!(roughness.value(Cell::new(2, 2)), 0.0);
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
#[must_use]
pub fn measure<const N: usize>(elevation: &Layer, measures: [Measure; N]) -> [Layer; N] {
    let mut layers = measures.map(|_| Layer::zero(elevation.spec()));
    derive(Instructions::widest(), BLOCK_CELLS, elevation, &measures, layers.each_mut());
    layers
}

/// Derives layers as [`measure`] does, writing over layers that there are already: no memory is allocated, and
/// none touched for the first time, where their grid is that of the elevation. Others are replaced.
pub fn measure_into<const N: usize>(
    elevation: &Layer,
    measures: [Measure; N],
    layers: [&mut Layer; N],
) {
    let spec = elevation.spec();
    let layers = layers.map(|layer| {
        if layer.spec() != spec {
            *layer = Layer::zero(spec);
        }
        layer
    });
    derive(Instructions::widest(), BLOCK_CELLS, elevation, &measures, layers);
}

/// Gradient magnitude |∇z| of an elevation layer in metres: rise over run, dimensionless (the paper's
/// "modulus of the gradient", Table 1). By central differences: [`Measure::Gradient`] has the rules.
///
/// ```
/// # use wisdom_grid::{Cell, GridSpec, Raster};
/// # use wisdom_terrain::{Layer, gradient};
/// let ramp = Raster::from_fn(GridSpec::new(3, 3, 2.0)?, |cell| 3.0 * cell.col as f32);
/// assert_eq!(gradient(&Layer::certain(ramp)?).value(Cell::new(1, 1)), 1.5);
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
#[must_use]
pub fn gradient(elevation: &Layer) -> Layer {
    gradient_by(elevation, Kernel::Central)
}

/// Gradient magnitude |∇z| of an elevation layer in metres by the kernel named: rise over run, dimensionless.
#[must_use]
pub fn gradient_by(elevation: &Layer, kernel: Kernel) -> Layer {
    only(elevation, Measure::Gradient(kernel))
}

/// Slope angle of an elevation layer in **degrees**: atan of the [`gradient`], with the gradient's u.
#[must_use]
pub fn slope(elevation: &Layer) -> Layer {
    only(elevation, Measure::SlopeDeg(Kernel::Central))
}

/// Step height of an elevation layer, metres: [`Measure::Step`].
#[must_use]
pub fn step(elevation: &Layer) -> Layer {
    only(elevation, Measure::Step)
}

/// Roughness of an elevation layer, metres, within `radius_cells`: [`Measure::Roughness`].
#[must_use]
pub fn roughness(elevation: &Layer, radius_cells: usize) -> Layer {
    only(elevation, Measure::Roughness { radius_cells })
}

/// Gradient, slope, step and roughness of an elevation layer in metres in one pass, roughness within
/// `radius_cells`.
#[must_use]
pub fn hazards(elevation: &Layer, radius_cells: usize) -> Hazards {
    let [gradient, slope_deg, step_m, roughness_m] = measure(
        elevation,
        [
            Measure::Gradient(Kernel::Central),
            Measure::SlopeDeg(Kernel::Central),
            Measure::Step,
            Measure::Roughness { radius_cells },
        ],
    );
    Hazards { gradient, slope_deg, step_m, roughness_m }
}

fn only(elevation: &Layer, measure_one: Measure) -> Layer {
    let [layer] = measure(elevation, [measure_one]);
    layer
}

/// Cells that one thread derives at a time: the heights they share with the next ones weigh little, and what is
/// made for one row is still in the cache for the next.
const BLOCK_CELLS: usize = 1 << 16;

/// How a layer is made.
enum Task {
    Gradient(Kernel),
    /// From the gradient by a kernel, which an earlier task makes or nobody does.
    Slope(Kernel, Option<usize>),
    Step,
    Roughness(PlaneFit),
}

impl Task {
    fn all(measures: &[Measure], spec: GridSpec) -> Vec<Self> {
        let task = |(index, &wanted): (usize, &Measure)| match wanted {
            Measure::Gradient(kernel) => Self::Gradient(kernel),
            Measure::SlopeDeg(kernel) => {
                let gradient = |&earlier: &Measure| earlier == Measure::Gradient(kernel);
                Self::Slope(kernel, measures[..index].iter().position(gradient))
            }
            Measure::Step => Self::Step,
            Measure::Roughness { radius_cells } => {
                Self::Roughness(PlaneFit::new(radius_cells, spec))
            }
        };
        measures.iter().enumerate().map(task).collect()
    }

    /// Rows that it reaches to either side.
    fn reach(&self) -> usize {
        match self {
            Self::Roughness(fit) => fit.reach(),
            _ => 1,
        }
    }
}

/// The planes of a derived layer, or some rows of them.
struct Sheet<'a> {
    values: &'a mut [f32],
    u: &'a mut [f32],
    /// The u that all cells hold already, if that is known.
    alike: Option<f32>,
}

impl<'a> Sheet<'a> {
    /// Some cells at a time.
    fn chunks(self, cells: usize) -> impl Iterator<Item = Sheet<'a>> {
        let Self { values, u, alike } = self;
        let both = values.chunks_mut(cells).zip(u.chunks_mut(cells));
        both.map(move |(values, u)| Sheet { values, u, alike })
    }

    fn row(&mut self, row: usize, cols: usize) -> Row<'_> {
        let cells = row * cols..(row + 1) * cols;
        Row { values: &mut self.values[cells.clone()], u: &mut self.u[cells], alike: self.alike }
    }
}

/// Makes layers block by block, on all threads if there is more than one block.
fn derive<const N: usize>(
    instructions: Instructions,
    block_cells: usize,
    elevation: &Layer,
    measures: &[Measure; N],
    mut layers: [&mut Layer; N],
) {
    let ground = Ground::of(elevation);
    let tasks = Task::all(measures, ground.spec);
    let (rows, cols) = (ground.spec.rows(), ground.spec.cols());
    let block_rows = (block_cells / cols).max(1);
    let mut blocks: Vec<Block<'_>> = (0..rows)
        .step_by(block_rows)
        .map(|first| Block {
            ground,
            tasks: &tasks,
            first,
            rows: block_rows.min(rows - first),
            sheets: Vec::with_capacity(N),
        })
        .collect();
    for layer in &mut layers {
        let alike = layer.alike();
        let (values, u) = layer.planes_mut();
        let sheet = Sheet { values, u, alike };
        for (block, sheet) in blocks.iter_mut().zip(sheet.chunks(block_rows * cols)) {
            block.sheets.push(sheet);
        }
    }
    let alike: Vec<[Option<f32>; N]> = if blocks.len() == 1 {
        blocks.into_iter().map(|block| block.derive(instructions)).collect()
    } else {
        blocks.into_par_iter().map(|block| block.derive(instructions)).collect()
    };
    for (task, layer) in layers.into_iter().enumerate() {
        let same = alike.iter().map(|block| block[task]).reduce(both).flatten();
        layer.set_alike(same);
    }
}

/// The u that two parts of a layer share, if they do.
fn both(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    a.filter(|a| b.is_some_and(|b| a.to_bits() == b.to_bits()))
}

/// Some rows of the layers to be made.
struct Block<'a> {
    ground: Ground<'a>,
    tasks: &'a [Task],
    /// The first row.
    first: usize,
    /// How many rows.
    rows: usize,
    /// A sheet a task.
    sheets: Vec<Sheet<'a>>,
}

impl Block<'_> {
    /// Makes the rows, and says for each task which u all cells share, if they do.
    fn derive<const N: usize>(mut self, instructions: Instructions) -> [Option<f32>; N] {
        let reach = self.tasks.iter().map(Task::reach).max().unwrap_or(0);
        let around = self.first.saturating_sub(reach)
            ..(self.first + self.rows + reach).min(self.ground.spec.rows());
        let north = around.start;
        let see = |row| match self.ground.alike {
            Some(u) if u < 1.0 => Seen::Alike(u + 0.0),
            _ => Seen::of(instructions, self.ground.u_of_row(row)),
        };
        let seen: Vec<Seen> = around.map(see).collect();
        let mut alike = [None; N];
        for row in self.first..self.first + self.rows {
            for (index, task) in self.tasks.iter().enumerate() {
                let reach = task.reach();
                let near = row.saturating_sub(reach).max(north) - north
                    ..(row - north + reach + 1).min(seen.len());
                let of_row = derive_row(
                    instructions,
                    &self.ground,
                    task,
                    (row, row - self.first),
                    Seen::together(&seen[near]),
                    self.sheets.split_at_mut(index),
                );
                let so_far = if row == self.first { of_row } else { alike[index] };
                alike[index] = both(so_far, of_row);
            }
        }
        alike
    }
}

/// Makes one row of one layer, and says which u all its cells share, if they do; the sheets before the layer's own are made.
fn derive_row(
    instructions: Instructions,
    ground: &Ground<'_>,
    task: &Task,
    (row, row_of_sheet): (usize, usize),
    seen: Seen,
    (made, rest): (&mut [Sheet<'_>], &mut [Sheet<'_>]),
) -> Option<f32> {
    let cols = ground.spec.cols();
    let mut out = rest[0].row(row_of_sheet, cols);
    let alike = match task {
        Task::Gradient(Kernel::Central) | Task::Slope(Kernel::Central, None) => {
            out.derive(instructions, &Central, ground, row, seen)
        }
        Task::Gradient(Kernel::Horn) | Task::Slope(Kernel::Horn, None) => {
            out.derive(instructions, &Horn, ground, row, seen)
        }
        Task::Slope(_, Some(gradient)) => {
            let gradient = made[*gradient].row(row_of_sheet, cols);
            out.values.copy_from_slice(gradient.values);
            out.copy_u(gradient.u, seen)
        }
        Task::Step => out.derive(instructions, &Step, ground, row, seen),
        Task::Roughness(fit) => {
            let seen = if fit.is_possible() { seen } else { Seen::Nothing };
            out.derive(instructions, fit, ground, row, seen)
        }
    };
    if let Task::Slope(..) = task {
        instructions.run(Degrees(out.values));
    }
    alike
}

#[cfg(test)]
mod tests;
