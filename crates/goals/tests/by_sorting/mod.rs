//! Sites by the textbook: all cells sorted, watersheds joined cell by cell.

use std::collections::BTreeSet;

use wisdom_goals::{Extraction, Site};
use wisdom_grid::{Cell, Raster};

/// What [`wisdom_goals::sites`] finds, for any positive least prominence.
pub(crate) fn sites_by_sorting(prize: &Raster<f32>, extraction: &Extraction) -> Vec<Site> {
    const UNSEEN: u32 = u32::MAX;
    let spec = prize.spec();
    let values = prize.values();
    let higher_first =
        |a: u32, b: u32| values[b as usize].total_cmp(&values[a as usize]).then(a.cmp(&b));
    let mut order: Vec<u32> =
        (0..values.len() as u32).filter(|&i| values[i as usize] > 0.0).collect();
    order.sort_unstable_by(|&a, &b| higher_first(a, b));
    let floor = extraction.percentile_floor.map_or(0.0, |percent| {
        let rank = ((1.0 - percent / 100.0) * order.len() as f64) as usize;
        order.get(rank.min(order.len().saturating_sub(1))).map_or(0.0, |&i| values[i as usize])
    });
    let mut parent = vec![UNSEEN; values.len()];
    let mut peaks: Vec<(u32, f64)> = Vec::new();
    for &i in &order {
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
            let (kept, ended) = if higher_first(a, b).is_lt() { (a, b) } else { (b, a) };
            peaks.push((ended, f64::from(values[ended as usize]) - f64::from(values[i as usize])));
            parent[ended as usize] = kept;
        }
    }
    let islands = order.iter().filter(|&&i| parent[i as usize] == i);
    peaks.extend(islands.map(|&i| (i, f64::from(values[i as usize]))));
    peaks.retain(|&(i, prominence)| {
        prominence >= extraction.min_prominence && values[i as usize] >= floor
    });
    peaks.sort_unstable_by(|a, b| higher_first(a.0, b.0));

    let mut found: Vec<Site> = Vec::new();
    let separation = extraction.min_separation_m / spec.spacing_m();
    for (i, prominence) in peaks {
        if found.len() == extraction.max_sites {
            break;
        }
        let top = values[i as usize];
        let level = f64::from(top) - extraction.min_prominence / 2.0;
        let region = flooded(prize, spec.cell(i as usize), level);
        let peak = middle(region.iter().copied().filter(|&c| prize[c] == top).collect());
        if found.iter().all(|better| better.peak.distance(peak) >= separation) {
            found.push(Site { peak, prominence, prize: f64::from(top), region });
        }
    }
    found
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Cells joined to `start` whose prize is positive and at least `level`, in row order.
pub(crate) fn flooded(prize: &Raster<f32>, start: Cell, level: f64) -> Vec<Cell> {
    let mut reached = BTreeSet::from([start]);
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
fn middle(cells: Vec<Cell>) -> Cell {
    let count = cells.len();
    let rows: usize = cells.iter().map(|c| c.row).sum();
    let cols: usize = cells.iter().map(|c| c.col).sum();
    let off = |a: usize, sum: usize| (a * count).abs_diff(sum) as u128;
    let near = |c: &Cell| (off(c.row, rows).pow(2) + off(c.col, cols).pow(2), *c);
    cells.into_iter().min_by_key(near).expect("a peak is in its own region")
}
