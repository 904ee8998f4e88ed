//! No result depends on the instructions, on how rows are handed out, or on holes elsewhere.

use fearless_simd::Level;
use wisdom_grid::{Cell, GridSpec, Raster};

use super::stencil::{Ground, Stencil};
use super::*;
use crate::unit_noise;

const MEASURES: [Measure; 8] = [
    Measure::Gradient(Kernel::Central),
    Measure::SlopeDeg(Kernel::Central),
    Measure::SlopeDeg(Kernel::Horn),
    Measure::Gradient(Kernel::Horn),
    Measure::Step,
    Measure::Roughness { radius_cells: 1 },
    Measure::Roughness { radius_cells: 2 },
    Measure::Roughness { radius_cells: 4 },
];

/// Every instruction set of this machine, and none.
fn instruction_sets() -> Vec<Instructions> {
    let widest = Level::new();
    #[cfg(target_arch = "x86_64")]
    let levels = {
        use fearless_simd::Simd;
        [Some(widest), widest.as_avx2().map(Simd::level), widest.as_sse2().map(Simd::level)]
    };
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(widest)];
    let wide = levels.into_iter().flatten().map(|level| Instructions(Some(level)));
    wide.chain([Instructions(None)]).collect()
}

/// Heights of a decimetre's noise on a tilt, far below the datum, with a share of holes.
fn rough_ground(rows: usize, cols: usize, holes: f64, u: impl Fn(Cell) -> f32) -> Layer {
    let mut layer = Layer::unknown(GridSpec::new(rows, cols, 0.7).expect("a small grid"));
    for cell in layer.spec().cells() {
        let key = [cell.row as u64, cell.col as u64];
        let z = -4500.0 + 0.3 * cell.row as f64 + 0.1 * unit_noise(&[key[0], key[1], 1]);
        let hole = unit_noise(&[key[0], key[1], 2]) < holes;
        layer.set(cell, z as f32, if hole { 1.0 } else { u(cell) });
    }
    layer
}

fn made_by(instructions: Instructions, block_cells: usize, ground: &Layer) -> [Layer; 8] {
    let mut layers = MEASURES.map(|_| Layer::zero(ground.spec()));
    derive(instructions, block_cells, ground, &MEASURES, layers.each_mut());
    layers
}

fn bits(layer: &Layer) -> Vec<(u32, u32)> {
    let planes = layer.values().values().iter().zip(layer.uncertainty().values());
    planes.map(|(value, u)| (value.to_bits(), u.to_bits())).collect()
}

fn grounds() -> Vec<Layer> {
    let mixed = |cell: Cell| 0.9 * unit_noise(&[cell.row as u64, cell.col as u64, 3]) as f32;
    let mut grounds = Vec::new();
    for (rows, cols) in [(1, 1), (1, 40), (40, 1), (2, 2), (5, 9), (9, 5), (23, 41), (37, 67)] {
        for holes in [0.0, 0.02, 0.4, 1.0] {
            grounds.push(rough_ground(rows, cols, holes, |_| 0.0));
            grounds.push(rough_ground(rows, cols, holes, |_| 0.25));
            grounds.push(rough_ground(rows, cols, holes, mixed));
        }
    }
    grounds
}

#[test]
fn every_instruction_set_and_every_cut_into_blocks_gives_the_same_bits() {
    for ground in grounds() {
        let expected = made_by(Instructions(None), usize::MAX, &ground).map(|layer| bits(&layer));
        for instructions in instruction_sets() {
            for block_cells in [1, 3 * ground.spec().cols(), usize::MAX] {
                let made = made_by(instructions, block_cells, &ground).map(|layer| bits(&layer));
                assert!(made == expected, "{:?} in blocks of {block_cells}", ground.spec());
            }
        }
    }
}

#[test]
fn layers_written_over_have_the_bits_of_fresh_ones() {
    for ground in grounds() {
        let mut used = MEASURES.map(|_| rough_ground(37, 67, 0.3, |_| 0.5));
        measure_into(&ground, MEASURES, used.each_mut());
        for ((used, fresh), what) in used.iter().zip(measure(&ground, MEASURES)).zip(MEASURES) {
            assert!(bits(used) == bits(&fresh), "{what:?} on {:?}", ground.spec());
            assert_eq!(used.spec(), ground.spec());
        }
    }
}

#[test]
fn a_measure_alone_has_the_bits_it_has_in_company() {
    let ground = rough_ground(23, 41, 0.1, |cell| if cell.row < 9 { 0.0 } else { 0.5 });
    for (together, what) in measure(&ground, MEASURES).iter().zip(MEASURES) {
        let [alone] = measure(&ground, [what]);
        assert!(bits(&alone) == bits(together), "{what:?}");
    }
}

/// A hole makes its own rows take the cell-by-cell way around it; nothing beyond its reach may move.
#[test]
fn a_hole_changes_no_bit_beyond_its_reach() {
    let whole = rough_ground(30, 50, 0.0, |_| 0.125);
    let before = measure(&whole, MEASURES);
    for hole in [Cell::new(0, 0), Cell::new(12, 20), Cell::new(29, 30), Cell::new(15, 49)] {
        let mut holed = whole.clone();
        holed.set(hole, 0.0, 1.0);
        for ((before, after), what) in before.iter().zip(measure(&holed, MEASURES)).zip(MEASURES) {
            let reach = match what {
                Measure::Roughness { radius_cells } => radius_cells,
                _ => 1,
            };
            for (index, cell) in whole.spec().cells().enumerate() {
                let away = cell.row.abs_diff(hole.row).max(cell.col.abs_diff(hole.col));
                if away > reach {
                    assert_eq!(bits(before)[index], bits(&after)[index], "{what:?} at {cell}");
                }
            }
        }
    }
}

/// The closed form and the general fit meet: within the bound that [`Measure::Roughness`] states.
#[test]
fn a_whole_disc_has_the_residual_of_the_general_fit() {
    for radius in 1..=8 {
        let layer = rough_ground(40, 40, 0.0, |_| 0.5);
        let ground = Ground::of(&layer);
        let fit = PlaneFit::new(radius, layer.spec());
        let made = roughness(&layer, radius);
        for cell in layer.spec().cells() {
            let far = |at: usize| (radius..40 - radius).contains(&at);
            if !far(cell.row) || !far(cell.col) {
                continue;
            }
            let (expected, u) = fit.reading(&ground, cell);
            let rise = 0.3 * radius as f32 + 0.1;
            assert!((made.value(cell) - expected).abs() <= 1e-6 * rise, "{radius} at {cell}");
            assert_eq!(made.u(cell), u);
        }
    }
}

/// Rows and columns change places without a bit of the closed forms changing.
#[test]
fn a_transposed_map_has_the_transposed_bits() {
    let ground = rough_ground(30, 30, 0.0, |_| 0.0);
    let turned = Raster::from_fn(ground.spec(), |c| ground.value(Cell::new(c.col, c.row)));
    let turned = Layer::certain(turned).expect("finite heights");
    let closed = [1, 2].map(|radius_cells| Measure::Roughness { radius_cells });
    for (a, b) in measure(&ground, closed).iter().zip(measure(&turned, closed)) {
        for cell in ground.spec().cells() {
            if cell.row.min(cell.col) >= 2 && cell.row.max(cell.col) < 28 {
                let other = Cell::new(cell.col, cell.row);
                assert_eq!(a.value(cell).to_bits(), b.value(other).to_bits(), "at {cell}");
            }
        }
    }
}
