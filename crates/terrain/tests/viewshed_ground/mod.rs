//! Ground to measure viewsheds on: fractal relief with half-ellipsoid rocks, one unit a cell.

use wisdom_grid::{Cell, GridSpec};
use wisdom_terrain::{Landscape, Layer, Rock, Roughness, Wall, unit_noise};

const SEED: u64 = 5;

/// Cells for each rock.
const CELLS_A_ROCK: usize = 2600;

/// Longest half-axis of a rock, cells.
const LARGEST_ROCK_CELLS: f64 = 12.0;

/// A square map of fractal relief (±24 m over some 128 cells) with domes up to 12 m high.
pub(crate) fn rocky_relief(side: usize) -> Layer {
    let spec = GridSpec::new(side, side, 1.0).expect("a small grid");
    let relief = Roughness { amplitude_m: 12.0, wavelength_cells: 128.0, octaves: 7, gain: 0.5 };
    let scene = Landscape { roughness: Some(relief), ..Landscape::default() };
    let mut heights = scene.render(spec, SEED).remove("elevation").expect("every scene has one");
    for number in 0..(side * side / CELLS_A_ROCK) as u64 {
        // Drawn on its own small map: a scene of all rocks would try each of them at each cell.
        let rock = rock(number, side as f64);
        let patch = spec.around(nearest(rock.centre), LARGEST_ROCK_CELLS as usize + 1);
        let local = [rock.centre[0] - patch.col as f64, rock.centre[1] - patch.row as f64];
        let alone =
            Landscape { rock: vec![Rock { centre: local, ..rock }], ..Landscape::default() };
        let layers = alone.render(spec.sub(patch).expect("a patch of the map"), SEED);
        for (cell, height) in layers["elevation"].iter() {
            heights[Cell::new(cell.row + patch.row, cell.col + patch.col)] += height;
        }
    }
    Layer::certain(heights).expect("heights are finite")
}

fn nearest([col, row]: [f64; 2]) -> Cell {
    Cell::new(row as usize, col as usize)
}

fn rock(number: u64, side: f64) -> Rock {
    let draw = |what: u64| unit_noise(&[SEED, number, what]);
    let radius = 2.0 + (LARGEST_ROCK_CELLS - 2.0) * draw(2) * draw(3);
    Rock {
        name: String::new(),
        centre: [draw(0) * side, draw(1) * side],
        half_axes: [radius, radius * (0.6 + 0.4 * draw(4))],
        turned_deg: 180.0 * draw(6),
        height_m: radius * (0.5 + 0.5 * draw(5)),
        wall: Wall::Dome,
        wall_cells: radius,
    }
}
