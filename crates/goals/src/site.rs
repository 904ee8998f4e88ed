//! Local maxima of the prize map, by topological persistence.

mod merge_tree;
mod tile;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use wisdom_grid::{Cell, Raster};

pub use merge_tree::MergeTree;

use merge_tree::Forest;
use tile::Pair;

/// What counts as a maximum worth a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// Least prominence on the prize scale (default 0.1); at 0 every maximum counts.
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
/// Watersheds are joined from the highest cell down; two that meet at a saddle end the life of the lower one, whose
/// prominence is its height above that saddle (topological persistence, Edelsbrunner, Letscher & Zomorodian
/// 2002). Plateaus are one maximum, cells without a prize are no ground. Regions of different sites never overlap,
/// because every saddle lies at least the least prominence below the lower of its peaks.
///
/// [`MergeTree`] gives the same while a map changes, for less.
#[must_use]
pub fn sites(prize: &Raster<f32>, extraction: &Extraction) -> Vec<Site> {
    pick(prize, Forest::new(prize).pairs(), extraction)
}

/// The best of the maxima, far enough from each other.
fn pick(
    prize: &Raster<f32>,
    pairs: impl Iterator<Item = Pair>,
    extraction: &Extraction,
) -> Vec<Site> {
    let spec = prize.spec();
    let values = prize.values();
    let floor =
        extraction.percentile_floor.map_or(0.0, |percent| percentile_floor(values, percent));
    let peaks = pairs.filter_map(|Pair { peak, saddle }| {
        let top = values[peak as usize];
        let prominence = f64::from(top) - f64::from(saddle.map_or(0.0, |s| values[s as usize]));
        let counts = prominence > 0.0 && prominence >= extraction.min_prominence && top >= floor;
        // Positive numbers sort as their bits do.
        counts.then(|| (top.to_bits(), Reverse(peak), prominence.to_bits()))
    });
    let mut peaks: BinaryHeap<_> = peaks.collect::<Vec<_>>().into();

    let mut found: Vec<Site> = Vec::new();
    let mut flood = Flood::new(prize);
    let separation = extraction.min_separation_m / spec.spacing_m();
    while found.len() < extraction.max_sites
        && let Some((top, Reverse(peak), prominence)) = peaks.pop()
    {
        let top = f32::from_bits(top);
        let region = flood.from(peak as usize, f64::from(top) - extraction.min_prominence / 2.0);
        let peak = middle(region.iter().copied().filter(|&c| prize[c] == top));
        if found.iter().all(|better| better.peak.distance(peak) >= separation) {
            let prominence = f64::from_bits(prominence);
            found.push(Site { peak, prominence, prize: f64::from(top), region });
        }
    }
    found
}

/// The prize that `percent` of the positive prizes lie below; 0 if there is none.
fn percentile_floor(values: &[f32], percent: f64) -> f32 {
    let mut positive: Vec<u32> = values.iter().filter(|v| **v > 0.0).map(|v| v.to_bits()).collect();
    let Some(last) = positive.len().checked_sub(1) else { return 0.0 };
    let above = ((1.0 - percent / 100.0) * positive.len() as f64) as usize;
    f32::from_bits(*positive.select_nth_unstable(last - above.min(last)).1)
}

/// Finds the cells joined to a peak.
struct Flood<'a> {
    prize: &'a Raster<f32>,
    /// By cell; all false between two floods.
    reached: Vec<bool>,
}

impl<'a> Flood<'a> {
    fn new(prize: &'a Raster<f32>) -> Self {
        Self { prize, reached: vec![false; prize.spec().len()] }
    }

    /// Cells joined to `start` whose prize is positive and at least `level`, in row order.
    fn from(&mut self, start: usize, level: f64) -> Vec<Cell> {
        let spec = self.prize.spec();
        let values = self.prize.values();
        let (rows, cols) = (spec.rows(), spec.cols());
        self.reached[start] = true;
        let mut region = vec![start as u32];
        let mut done = 0;
        while done < region.len() {
            let (row, col) = (region[done] as usize / cols, region[done] as usize % cols);
            done += 1;
            for r in row.saturating_sub(1)..(row + 2).min(rows) {
                for c in col.saturating_sub(1)..(col + 2).min(cols) {
                    let i = r * cols + c;
                    let joins = values[i] > 0.0 && f64::from(values[i]) >= level;
                    if joins && !self.reached[i] {
                        self.reached[i] = true;
                        region.push(i as u32);
                    }
                }
            }
        }
        for &i in &region {
            self.reached[i as usize] = false;
        }
        region.sort_unstable();
        region.into_iter().map(|i| spec.cell(i as usize)).collect()
    }
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
