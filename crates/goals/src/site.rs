//! Local maxima of the prize map, by topological persistence.

use wisdom_grid::{Cell, Raster};

/// What counts as a maximum worth a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// Least prominence on the prize scale (default 0.1).
    pub min_prominence: f64,
    /// Least distance between two sites, metres; of two nearer ones the better stays.
    pub min_separation_m: f64,
    /// Cells below this percentile (0 to 100) of the positive prizes start no site.
    pub percentile_floor: Option<f64>,
    /// The most sites kept, best first (default 100).
    pub max_sites: usize,
}

impl Default for Extraction {
    fn default() -> Self {
        Self { min_prominence: 0.1, min_separation_m: 5.0, percentile_floor: None, max_sites: 100 }
    }
}

/// A maximum of the prize map.
#[derive(Debug, Clone, PartialEq)]
pub struct Site {
    /// The cell that stands for it: of the cells that share the highest prize, the one nearest to their
    /// middle.
    pub peak: Cell,
    /// Height of the peak over the highest saddle that leads to a higher one, on the prize scale; for the
    /// highest peak of an island of positive prize, its whole height.
    pub prominence: f64,
    /// Prize at the peak, in [0, 1].
    pub prize: f64,
    /// Cells joined to the peak whose prize is within half the least prominence of it, in row order.
    pub region: Vec<Cell>,
}

/// The sites of a prize map, best prize first (ties by cell).
///
/// Watersheds are joined from the highest cell down (union-find); two that meet at a saddle end the life of
/// the lower one, whose prominence is its height above that saddle (topological persistence, Edelsbrunner,
/// Letscher & Zomorodian 2002). Plateaus are one maximum. Regions of different sites never overlap, because
/// every saddle lies at least the least prominence below the lower of its peaks.
#[must_use]
pub fn sites(prize: &Raster<f32>, extraction: &Extraction) -> Vec<Site> {
    const UNSEEN: u32 = u32::MAX;
    let spec = prize.spec();
    let values = prize.values();
    let mut order: Vec<u32> =
        (0..values.len() as u32).filter(|&i| values[i as usize] > 0.0).collect();
    order.sort_unstable_by(|&a, &b| {
        values[b as usize].total_cmp(&values[a as usize]).then(a.cmp(&b))
    });
    let floor = extraction.percentile_floor.map_or(0.0, |percent| {
        let rank = ((1.0 - percent / 100.0) * order.len() as f64) as usize;
        order.get(rank.min(order.len().saturating_sub(1))).map_or(0.0, |&i| values[i as usize])
    });

    let mut parent = vec![UNSEEN; values.len()];
    let mut peaks: Vec<(u32, f64)> = Vec::new();
    for &i in &order {
        let height = values[i as usize];
        parent[i as usize] = i;
        for neighbour in spec.neighbours(spec.cell(i as usize)) {
            let n = spec.index(neighbour) as u32;
            if parent[n as usize] == UNSEEN {
                continue;
            }
            let (a, b) = (root(&mut parent, i), root(&mut parent, n));
            if a == b {
                continue;
            }
            // The root of a watershed is its highest cell, the first in the order among equals.
            let higher = |x: u32, y: u32| {
                values[y as usize].total_cmp(&values[x as usize]).then(x.cmp(&y)).is_lt()
            };
            let (kept, ended) = if higher(a, b) { (a, b) } else { (b, a) };
            let prominence = f64::from(values[ended as usize]) - f64::from(height);
            if prominence >= extraction.min_prominence {
                peaks.push((ended, prominence));
            }
            parent[ended as usize] = kept;
        }
    }
    peaks.extend(
        order
            .iter()
            .filter(|&&i| parent[i as usize] == i)
            .map(|&i| (i, f64::from(values[i as usize])))
            .filter(|(_, prominence)| *prominence >= extraction.min_prominence),
    );
    peaks.retain(|&(i, _)| values[i as usize] >= floor);
    peaks.sort_unstable_by(|a, b| {
        values[b.0 as usize].total_cmp(&values[a.0 as usize]).then(a.0.cmp(&b.0))
    });

    let mut found: Vec<Site> = Vec::new();
    let separation = extraction.min_separation_m / spec.spacing_m();
    for (i, prominence) in peaks {
        if found.len() == extraction.max_sites {
            break;
        }
        let top = values[i as usize];
        let region =
            flood(prize, spec.cell(i as usize), f64::from(top) - extraction.min_prominence / 2.0);
        let peak = middle(region.iter().copied().filter(|&c| prize[c] == top));
        if found.iter().all(|better| better.peak.distance(peak) >= separation) {
            found.push(Site { peak, prominence, prize: f64::from(top), region });
        }
    }
    found
}

/// The root of a cell's watershed, halving the path on the way.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Cells joined to `start` whose prize is at least `level`, in row order.
fn flood(prize: &Raster<f32>, start: Cell, level: f64) -> Vec<Cell> {
    let mut reached = std::collections::BTreeSet::from([start]);
    let mut open = vec![start];
    while let Some(cell) = open.pop() {
        for next in prize.spec().neighbours(cell) {
            if f64::from(prize[next]) >= level && prize[next] > 0.0 && reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached.into_iter().collect()
}

/// The cell nearest to the mean position of the given ones (ties by cell).
fn middle(cells: impl Iterator<Item = Cell> + Clone) -> Cell {
    let (mut rows, mut cols, mut count) = (0usize, 0usize, 0usize);
    for cell in cells.clone() {
        (rows, cols, count) = (rows + cell.row, cols + cell.col, count + 1);
    }
    // Scaled by the count so that squared distances to the mean compare as integers.
    let off = |a: usize, sum: usize| (a * count).abs_diff(sum) as u128;
    cells
        .min_by_key(|c| (off(c.row, rows).pow(2) + off(c.col, cols).pow(2), *c))
        .expect("a plateau holds at least its first cell")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use wisdom_grid::GridSpec;

    use super::*;

    /// A prize map drawn with digits, tenths of the prize.
    fn picture(rows: &[&str]) -> Raster<f32> {
        let spec = GridSpec::new(rows.len(), rows[0].len(), 1.0).unwrap();
        Raster::from_fn(spec, |c| f32::from(rows[c.row].as_bytes()[c.col] - b'0') / 10.0)
    }

    fn near(min_separation_m: f64) -> Extraction {
        Extraction { min_separation_m, ..Extraction::default() }
    }

    #[test]
    fn prominence_is_the_height_above_the_saddle() {
        let map = picture(&["00000000", "09440700", "00000000"]);
        let found = sites(&map, &near(1.0));
        let told: Vec<_> =
            found.iter().map(|s| (s.peak.col, (s.prominence * 10.0).round())).collect();
        assert_eq!(told, [(1, 9.0), (5, 7.0)]);
        let joined = picture(&["00000000", "09447000", "00000000"]);
        let found = sites(&joined, &near(1.0));
        assert_eq!(
            found.iter().map(|s| (s.prominence * 10.0).round()).collect::<Vec<_>>(),
            [9.0, 3.0]
        );
    }

    #[test]
    fn a_plateau_is_one_site_in_its_middle() {
        let map = picture(&["00000", "08880", "08880", "08880", "00000"]);
        let found = sites(&map, &near(1.0));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].peak, Cell::new(2, 2));
        assert_eq!(found[0].region.len(), 9);
    }

    #[test]
    fn of_two_near_maxima_the_better_stays() {
        let map = picture(&["080900"]);
        assert_eq!(sites(&map, &near(1.0)).len(), 2);
        let far = sites(&map, &near(5.0));
        assert_eq!(far.iter().map(|s| s.peak.col).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn the_percentile_floor_cuts_small_peaks() {
        let map = picture(&["0204080"]);
        let floor = Extraction { percentile_floor: Some(60.0), ..near(1.0) };
        assert_eq!(sites(&map, &near(1.0)).len(), 3);
        assert_eq!(sites(&map, &floor).iter().map(|s| s.peak.col).collect::<Vec<_>>(), [5, 3]);
    }

    /// Prominence by its definition: the lowest drop needed to walk to strictly higher ground.
    fn prominence_by_flooding(map: &Raster<f32>, peak: Cell) -> f64 {
        let top = map[peak];
        let mut levels: Vec<f32> = map.values().iter().copied().filter(|v| *v > 0.0).collect();
        levels.sort_unstable_by(f32::total_cmp);
        for level in levels.into_iter().rev().filter(|l| *l <= top) {
            if flood(map, peak, f64::from(level)).iter().any(|c| map[*c] > top) {
                return f64::from(top) - f64::from(level);
            }
        }
        f64::from(top)
    }

    proptest! {
        /// Every site's prominence is the one its definition gives, and no maximum is missed.
        #[test]
        fn prominence_agrees_with_its_definition(
            heights in proptest::collection::vec(0u16..1000, 36),
        ) {
            // Distinct heights, so that no tie decides which of two equal peaks outlives the other.
            let spec = GridSpec::new(6, 6, 1.0).unwrap();
            let values: Vec<f32> =
                heights.iter().enumerate().map(|(i, h)| (f32::from(*h) * 36.0 + i as f32) / 36_000.0).collect();
            let map = Raster::from_vec(spec, values).unwrap();
            let found = sites(&map, &near(0.0));
            for site in &found {
                prop_assert!((site.prominence - prominence_by_flooding(&map, site.peak)).abs() < 1e-9);
            }
            for cell in spec.cells().filter(|&c| map[c] > 0.0) {
                let is_peak = spec.neighbours(cell).all(|n| map[n] < map[cell]);
                let listed = found.iter().any(|s| s.peak == cell);
                let prominent = is_peak && prominence_by_flooding(&map, cell) >= 0.1;
                prop_assert_eq!(listed, prominent, "{}", cell);
            }
        }
    }
}
