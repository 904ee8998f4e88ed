//! Cells, windows and rasters agree on where things lie.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridError, GridSpec, Raster, Window};

proptest! {
    /// A cell's index leads back to the cell, and indices count row by row.
    #[test]
    fn index_and_cell_are_inverse(rows in 1usize..40, cols in 1usize..40) {
        let spec = GridSpec::new(rows, cols, 0.5).unwrap();
        for (i, cell) in spec.cells().enumerate() {
            prop_assert_eq!(spec.index(cell), i);
            prop_assert_eq!(spec.cell(i), cell);
        }
    }

    /// A cropped window keeps each cell's value and its place on the map.
    #[test]
    fn a_crop_keeps_values_and_places(
        (row, rows) in (0usize..6, 1usize..6), (col, cols) in (0usize..6, 1usize..6),
    ) {
        let spec = GridSpec::new(12, 12, 2.0).unwrap().at(100.0, 50.0);
        let raster = Raster::from_fn(spec, |c| c.row * 100 + c.col);
        let crop = raster.crop(Window { row, col, rows, cols }).unwrap();
        for (cell, value) in crop.iter() {
            let there = Cell::new(cell.row + row, cell.col + col);
            prop_assert_eq!(*value, raster[there]);
            prop_assert_eq!(crop.spec().centre_m(cell), spec.centre_m(there));
        }
    }

    /// A part of a grid keeps the whole one's cells, in the same places, and its own indices.
    #[test]
    fn a_part_keeps_the_numbers_of_the_whole(
        (row, rows) in (0usize..6, 1usize..6), (col, cols) in (0usize..6, 1usize..6),
        radius in 0usize..4,
    ) {
        let whole = GridSpec::new(12, 12, 2.0).unwrap().at(100.0, 50.0);
        let window = Window { row, col, rows, cols };
        let part = whole.part(window).unwrap();
        prop_assert_eq!(part.window(), window);
        for (i, cell) in part.cells().enumerate() {
            prop_assert_eq!((part.index(cell), part.cell(i)), (i, cell));
            prop_assert_eq!(part.centre_m(cell), whole.centre_m(cell));
            let inside = whole.neighbours(cell).filter(|c| window.contains(*c));
            prop_assert!(part.neighbours(cell).eq(inside));
            let around = whole.around(cell, radius).intersection(window);
            prop_assert_eq!(Some(part.around(cell, radius)), around);
        }
        let contained = whole.cells().filter(|c| part.contains(*c)).count();
        prop_assert_eq!(contained, rows * cols);
        // A part of a part is that part of the whole; a crop is numbered anew.
        let inner = Window { row: row + rows / 2, col: col + cols / 2, rows: 1, cols: 1 };
        prop_assert_eq!(part.part(inner).unwrap(), whole.part(inner).unwrap());
        let raster = Raster::from_fn(part, |c| c.row * 100 + c.col);
        let crop = raster.crop(inner).unwrap();
        prop_assert_eq!(crop.values(), &[inner.row * 100 + inner.col]);
        prop_assert_eq!(crop.spec().first(), Cell::new(0, 0));
        prop_assert_eq!(raster.row(row)[0], row * 100 + col);
        let beyond = Window { row: row + rows, ..inner };
        prop_assert!(part.part(beyond).is_err());
        let endless = Window { rows: usize::MAX, ..inner };
        prop_assert!(part.part(endless).is_err());
    }

    /// What is left of a window covers each of its other cells once.
    #[test]
    fn a_window_minus_another_leaves_the_rest(
        a in (0usize..9, 0usize..9, 1usize..9, 1usize..9),
        b in (0usize..9, 0usize..9, 1usize..9, 1usize..9),
    ) {
        let window = |(row, col, rows, cols)| Window { row, col, rows, cols };
        let (a, b) = (window(a), window(b));
        let mut left: Vec<Cell> = a.minus(b).into_iter().flat_map(|part| part.cells()).collect();
        left.sort_unstable();
        let rest: Vec<Cell> = a.cells().filter(|cell| !b.contains(*cell)).collect();
        prop_assert_eq!(left, rest);
    }

    /// The window around a cell holds exactly the cells within the radius that are on the grid.
    #[test]
    fn around_is_a_clipped_square(row in 0usize..9, col in 0usize..9, radius in 0usize..6) {
        let spec = GridSpec::new(9, 9, 1.0).unwrap();
        let centre = Cell::new(row, col);
        let window = spec.around(centre, radius);
        for cell in spec.cells() {
            let near = cell.row.abs_diff(row) <= radius && cell.col.abs_diff(col) <= radius;
            prop_assert_eq!(window.contains(cell), near);
        }
    }
}

#[test]
fn a_serial_and_a_parallel_raster_are_equal() {
    let spec = GridSpec::new(97, 131, 1.0).unwrap();
    let f = |c: Cell| (c.row as f32).sqrt() * c.col as f32;
    assert_eq!(Raster::from_fn(spec, f), Raster::par_from_fn(spec, f));
}

#[test]
fn windows_join_and_meet() {
    let a = Window { row: 0, col: 0, rows: 4, cols: 4 };
    let b = Window { row: 2, col: 3, rows: 4, cols: 4 };
    assert_eq!(a.union(b), Window { row: 0, col: 0, rows: 6, cols: 7 });
    assert_eq!(a.intersection(b), Some(Window { row: 2, col: 3, rows: 2, cols: 1 }));
    assert_eq!(a.intersection(Window { row: 4, ..b }), None);
}

#[test]
fn bad_shapes_are_refused_with_their_numbers() {
    assert_eq!(GridSpec::new(0, 3, 1.0), Err(GridError::Shape { rows: 0, cols: 3 }));
    assert!(GridSpec::new(3, 3, f64::NAN).is_err());
    let spec = GridSpec::new(3, 3, 1.0).unwrap();
    let error = Raster::from_vec(spec, vec![0; 8]).unwrap_err();
    assert_eq!(error.to_string(), "8 values for a grid of 3 x 3 cells");
    assert!(spec.sub(Window { row: 1, col: 1, rows: 3, cols: 1 }).is_err());
}
