//! The shape of the ground at each cell: gradient, slope, step, roughness; and its look in a figure.

use nalgebra::{Matrix3, Vector3};
use wisdom_grid::{Cell, Raster};

use crate::Layer;

/// A reading of something derived from a layer, with its uncertainty; u = 1 if it cannot be derived.
type Reading = (f32, f32);

const UNKNOWN: Reading = (0.0, 1.0);

/// Gradient magnitude |∇z| of an elevation layer in metres: rise over run, dimensionless (the paper's
/// "modulus of the gradient", Table 1).
///
/// Along rows and columns alike `(next − previous) / 2w`, w being the cell spacing; where one of the two is off the
/// map or unknown, the cell itself takes its place, over w. The result has the worst u among the cells used, and 1
/// where an axis has no known neighbour (or only one, and the cell itself is unknown, so that there is nothing to
/// take a difference with). Heights are subtracted before they are scaled.
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
    derive(elevation, |cell| {
        let along_row = slope_along(elevation, cell, (0, 1));
        let along_col = slope_along(elevation, cell, (1, 0));
        let (Some((gx, ux)), Some((gy, uy))) = (along_row, along_col) else { return UNKNOWN };
        (libm::sqrt(gx * gx + gy * gy) as f32, ux.max(uy))
    })
}

/// Slope angle of an elevation layer in **degrees**: atan of the [`gradient`], with the gradient's u.
#[must_use]
pub fn slope(elevation: &Layer) -> Layer {
    let rise_over_run = gradient(elevation);
    derive(elevation, |cell| {
        let angle_rad = libm::atan(f64::from(rise_over_run.value(cell)));
        (angle_rad.to_degrees() as f32, rise_over_run.u(cell))
    })
}

/// Step height of an elevation layer, metres: the largest difference to a known neighbour among the eight
/// (a hazard of Goldberg, Maimone and Matthies, 2002). The worst u among them is its own.
#[must_use]
pub fn step(elevation: &Layer) -> Layer {
    derive(elevation, |cell| {
        if !elevation.is_known(cell) {
            return UNKNOWN;
        }
        let here = f64::from(elevation.value(cell));
        elevation
            .spec()
            .neighbours(cell)
            .filter(|&next| elevation.is_known(next))
            .map(|next| ((f64::from(elevation.value(next)) - here).abs() as f32, elevation.u(next)))
            .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
            .map_or(UNKNOWN, |(height, u)| (height, u.max(elevation.u(cell))))
    })
}

/// Roughness of an elevation layer, metres: root mean square residual of the plane fitted to the known cells
/// within `radius_cells` (Euclidean, between centres), as in GESTALT (Goldberg, Maimone and Matthies, 2002).
///
/// The worst u in the fit is its own; unknown where the cell itself is, or where the known cells
/// number fewer than four or lie on one line (three cells leave no residual).
#[must_use]
pub fn roughness(elevation: &Layer, radius_cells: usize) -> Layer {
    let footprint = disc(radius_cells);
    derive(elevation, |cell| {
        if elevation.is_known(cell) { plane_residual(elevation, cell, &footprint) } else { UNKNOWN }
    })
}

/// Brightness in [0, 1] of an elevation raster in metres, lit from `azimuth_rad` (clockwise from north) and
/// `altitude_rad` (above the horizon), with Horn's gradient (Horn, 1981); edges repeat their outermost cells. For
/// figures only.
#[must_use]
pub fn hillshade(elevation: &Raster<f32>, azimuth_rad: f64, altitude_rad: f64) -> Raster<f32> {
    let spec = elevation.spec();
    let light = Vector3::new(
        libm::sin(azimuth_rad) * libm::cos(altitude_rad),
        libm::cos(azimuth_rad) * libm::cos(altitude_rad),
        libm::sin(altitude_rad),
    );
    Raster::par_from_fn(spec, |cell| {
        let z = |d_row: usize, d_col: usize| {
            let row = (cell.row + d_row).saturating_sub(1).min(spec.rows() - 1);
            let col = (cell.col + d_col).saturating_sub(1).min(spec.cols() - 1);
            f64::from(elevation[Cell { row, col }])
        };
        let run = 8.0 * spec.spacing_m();
        let side = |a: f64, b: f64, c: f64| a + 2.0 * b + c;
        let west_to_east =
            (side(z(0, 2), z(1, 2), z(2, 2)) - side(z(0, 0), z(1, 0), z(2, 0))) / run;
        let south_to_north =
            (side(z(0, 0), z(0, 1), z(0, 2)) - side(z(2, 0), z(2, 1), z(2, 2))) / run;
        let normal = Vector3::new(-west_to_east, -south_to_north, 1.0);
        (normal.dot(&light) / libm::sqrt(normal.norm_squared())).max(0.0) as f32
    })
}

/// A layer computed cell by cell on all threads, each cell from its own surroundings alone. A reading too large for
/// an `f32` is held at the largest one, so that no layer holds an infinity.
fn derive(from: &Layer, reading: impl Fn(Cell) -> Reading + Sync) -> Layer {
    let both = Raster::par_from_fn(from.spec(), reading);
    let uncertainty = both.map(|&(_, u)| u);
    let values = both.map(|&(value, _)| value.clamp(f32::MIN, f32::MAX));
    Layer::new(values, uncertainty)
        .expect("derived readings are clamped, their u taken from a layer")
}

/// Derivative along one axis and the largest u of the two cells it was taken from.
fn slope_along(
    elevation: &Layer,
    cell: Cell,
    (d_row, d_col): (isize, isize),
) -> Option<(f64, f32)> {
    let spec = elevation.spec();
    let known = |at: Option<Cell>| at.filter(|&at| elevation.is_known(at));
    let before = known(spec.step(cell, -d_row, -d_col));
    let after = known(spec.step(cell, d_row, d_col));
    let (from, to, cells) = match (before, after) {
        (Some(before), Some(after)) => (before, after, 2.0),
        (Some(before), None) => (before, known(Some(cell))?, 1.0),
        (None, Some(after)) => (known(Some(cell))?, after, 1.0),
        (None, None) => return None,
    };
    let rise = f64::from(elevation.value(to)) - f64::from(elevation.value(from));
    Some((rise / (cells * spec.spacing_m()), elevation.u(from).max(elevation.u(to))))
}

/// Row and column steps to all cells within a radius, row by row.
fn disc(radius_cells: usize) -> Vec<(isize, isize)> {
    let r = radius_cells.min(wisdom_grid::MAX_SIDE) as isize;
    (-r..=r)
        .flat_map(|d_row| (-r..=r).map(move |d_col| (d_row, d_col)))
        .filter(|(d_row, d_col)| d_row * d_row + d_col * d_col <= r * r)
        .collect()
}

/// Least squares plane z = a + b·col + c·row over the footprint's known cells, heights taken from the centre's.
fn plane_residual(elevation: &Layer, centre: Cell, footprint: &[(isize, isize)]) -> Reading {
    let spec = elevation.spec();
    let base = f64::from(elevation.value(centre));
    let known = || {
        footprint.iter().filter_map(|&(d_row, d_col)| {
            let cell = spec.step(centre, d_row, d_col).filter(|&at| elevation.is_known(at))?;
            let rise = f64::from(elevation.value(cell)) - base;
            Some((Vector3::new(1.0, d_col as f64, d_row as f64), rise, elevation.u(cell)))
        })
    };
    let (mut normal, mut right, mut cells, mut u) =
        (Matrix3::zeros(), Vector3::zeros(), 0.0, 0.0_f32);
    for (at, rise, u_there) in known() {
        normal += at * at.transpose();
        right += at * rise;
        cells += 1.0;
        u = u.max(u_there);
    }
    // The entries are sums of whole numbers, so the determinant of cells on one line is 0 up to rounding and
    // that of any others at least 1.
    if cells < 4.0 || normal.determinant() < 0.5 {
        return UNKNOWN;
    }
    let Some(inverse) = normal.try_inverse() else { return UNKNOWN };
    let plane = inverse * right;
    let squares: f64 = known().map(|(at, rise, _)| (rise - plane.dot(&at)).powi(2)).sum();
    (libm::sqrt(squares / cells) as f32, u)
}
