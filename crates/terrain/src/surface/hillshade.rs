//! Ground as it looks in a figure.

use rayon::prelude::*;
use wisdom_grid::Raster;

use super::stencil::per_two_cells;
use super::width::{Instructions, Job, Single, Width};
use crate::Layer;

/// Brightness in [0, 1] of an elevation layer in metres, lit from `azimuth_rad` (clockwise from north) and
/// `altitude_rad` (above the horizon), with Horn's gradient (Horn, "Hill shading and the reflectance map", 1981);
/// edges repeat their outermost cells, and where a neighbour is unknown the ground goes on level. For figures only.
#[must_use]
pub fn hillshade(elevation: &Layer, azimuth_rad: f64, altitude_rad: f64) -> Raster<f32> {
    let spec = elevation.spec();
    let light = Light {
        east: (libm::sin(azimuth_rad) * libm::cos(altitude_rad)) as f32,
        north: (libm::cos(azimuth_rad) * libm::cos(altitude_rad)) as f32,
        up: libm::sin(altitude_rad) as f32,
        per_eight_cells: 0.25 * per_two_cells(spec),
    };
    let (last_row, cols) = (spec.rows() - 1, spec.cols());
    let mut shade = Raster::filled(spec, 0.0);
    shade.values_mut().par_chunks_mut(cols).enumerate().with_min_len(16).for_each(
        |(row, shade)| {
            let rows = [row.saturating_sub(1), row, (row + 1).min(last_row)];
            let here = ShadeRow {
                light,
                rows: rows.map(|row| elevation.values().row(spec.first().row + row)),
                shade,
            };
            let u = rows.map(|row| elevation.uncertainty().row(spec.first().row + row));
            let whole = elevation.alike().is_some_and(|u| u < 1.0)
                || u.iter().all(|row| row.iter().all(|&u| u < 1.0));
            if whole { Instructions::widest().run(here) } else { here.beside_holes(u) }
        },
    );
    shade
}

/// Direction towards the light, of length one, and one over eight cell spacings, per metre.
#[derive(Clone, Copy)]
struct Light {
    east: f32,
    north: f32,
    up: f32,
    per_eight_cells: f32,
}

/// One row to be shaded, and the heights of the rows north of it, its own, and south of it.
struct ShadeRow<'a> {
    light: Light,
    rows: [&'a [f32]; 3],
    shade: &'a mut [f32],
}

impl ShadeRow<'_> {
    /// Cell by cell, each in the middle of what is known around it.
    fn beside_holes(self, u: [&[f32]; 3]) {
        let last = self.shade.len() - 1;
        for col in 0..=last {
            let beside = [col.saturating_sub(1), col, (col + 1).min(last)];
            let middle = self.rows[1][col];
            // A hole itself is level: there is no height to compare its neighbours with.
            let in_hole = u[1][col] >= 1.0;
            let near: [[f32; 3]; 3] = std::array::from_fn(|row| {
                let height = |col: usize| {
                    if in_hole || u[row][col] >= 1.0 { middle } else { self.rows[row][col] }
                };
                beside.map(height)
            });
            let rows = near.each_ref().map(<[f32; 3]>::as_slice);
            self.shade[col] = brightness(Single, self.light, rows, [0, 1, 2]);
        }
    }
}

impl Job for ShadeRow<'_> {
    #[inline(always)]
    fn run<W: Width>(self, w: W) {
        let last = self.shade.len() - 1;
        let mut col = 1;
        while col + W::CELLS <= last {
            let bright = brightness(w, self.light, self.rows, [col - 1, col, col + 1]);
            w.store(bright, self.shade, col);
            col += W::CELLS;
        }
        for col in std::iter::once(0).chain(col.min(last)..=last) {
            let beside = [col.saturating_sub(1), col, (col + 1).min(last)];
            self.shade[col] = brightness(Single, self.light, self.rows, beside);
        }
    }
}

/// Cosine of the angle between the ground's normal and the light; `beside` are the columns west of the cells, their
/// own and east of them.
#[inline(always)]
fn brightness<W: Width>(w: W, light: Light, rows: [&[f32]; 3], beside: [usize; 3]) -> W::Lanes {
    let ([north, here, south], [west, middle, east]) = (rows, beside);
    let (nw, n, ne) = (w.load(north, west), w.load(north, middle), w.load(north, east));
    let (sw, s, se) = (w.load(south, west), w.load(south, middle), w.load(south, east));
    let (along_row, along_col) = (w.load(here, east) - w.load(here, west), n - s);
    let scale = w.splat(light.per_eight_cells);
    let eastward = (((ne - nw) + (se - sw)) + (along_row + along_row)) * scale;
    let northward = (((nw - sw) + (ne - se)) + (along_col + along_col)) * scale;
    let towards =
        w.splat(light.up) - (eastward * w.splat(light.east) + northward * w.splat(light.north));
    let one = w.splat(1.0);
    let length = w.root((eastward * eastward + northward * northward) + one);
    // Written so that not-a-number, which only absurd heights give, is dark.
    w.smaller(w.larger(towards / length, w.splat(0.0)), one)
}
