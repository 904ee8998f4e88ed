//! Travel kept from one decision to the next, as far as the map did not change.

use std::collections::BTreeMap;

use rayon::prelude::*;
use wisdom_grid::{Cell, GridSpec};

use super::{Entry, Survey};
use crate::{Limits, TravelMatrix, TravelOptions, Traversability, Weights};

/// A set of the cells of a grid, a bit each.
#[derive(Debug, Clone)]
pub(super) struct CellSet {
    words_a_row: usize,
    words: Vec<u64>,
}

impl CellSet {
    pub(super) fn empty(spec: GridSpec) -> Self {
        let words_a_row = spec.cols().div_ceil(64);
        Self { words_a_row, words: vec![0; words_a_row * spec.rows()] }
    }

    /// Adds the cells of a row for which the iterator says so.
    pub(super) fn add_row(&mut self, row: usize, cells: &mut dyn Iterator<Item = bool>) {
        let words = &mut self.words[row * self.words_a_row..][..self.words_a_row];
        for (col, _) in cells.enumerate().filter(|&(_, within)| within) {
            words[col / 64] |= 1 << (col % 64);
        }
    }

    fn meets(&self, other: &Self) -> bool {
        self.words.iter().zip(&other.words).any(|(a, b)| a & b != 0)
    }
}

/// Travel between poses that is kept from one decision to the next: the routes from a pose are searched for again
/// only if the map changed where their search had looked.
///
/// What it gives has the same bits as [`travel_alternatives`](crate::travel_alternatives). A search from a pose reads
/// the hazard, open steps, heights and classes of cells it settles, and hazard, heights and classes of the neighbours
/// these lead to; all of these carry a label in the end. Where none of the cells with a label changed, a search of the new map
/// reads the same numbers in the same order of labels, and finds the same routes. (Which queue it uses and how wide
/// the buckets are may change with a hazard elsewhere; routes depend on neither.)
///
/// A new grid, vehicle, limits or weights empty it, and so does asking for a target that a pose's routes do not
/// include, for that pose. It keeps the ground it saw last, and for each pose the routes and a bit a cell, for at most
/// [`TravelCache::MOST_POSES`] poses: those not asked for longest go first.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_planner::{Traversability, TravelCache, TravelOptions, Vehicle};
/// use wisdom_terrain::Layer;
///
/// let plain = Layer::certain(Raster::filled(GridSpec::new(20, 20, 1.0)?, 0.0))?;
/// let ground = Traversability::new(&Vehicle::default(), &plain)?;
/// let (nodes, options) = ([Cell::new(1, 1), Cell::new(9, 9)], TravelOptions::default());
/// let mut cache = TravelCache::new();
/// let first = cache.travel(&ground, &nodes, &options);
/// assert_eq!(cache.travel(&ground, &nodes, &options), first);
/// assert_eq!(cache.searches(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct TravelCache {
    seen: Option<Seen>,
    poses: BTreeMap<Cell, Kept>,
    calls: u64,
    searches: u64,
}

/// What the routes kept were found on and asked with.
#[derive(Debug, Clone)]
struct Seen {
    ground: Traversability,
    limits: Limits,
    weights: Vec<Weights>,
}

/// The routes from a pose.
#[derive(Debug, Clone)]
struct Kept {
    entries: BTreeMap<Cell, Entry>,
    looked_at: CellSet,
    /// Number of the call that last asked for them.
    asked: u64,
}

impl TravelCache {
    /// Poses whose routes are kept at most.
    pub const MOST_POSES: usize = 256;

    /// One that keeps nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Works out the travel between all pairs of poses, as [`travel_alternatives`](crate::travel_alternatives) does.
    ///
    /// # Panics
    /// If a node is not on the grid.
    #[must_use]
    pub fn travel(
        &mut self,
        ground: &Traversability,
        nodes: &[Cell],
        options: &TravelOptions<'_>,
    ) -> TravelMatrix {
        self.calls += 1;
        self.forget_what_changed(ground, options);
        let mut missing: Vec<Cell> = nodes
            .iter()
            .filter(|source| {
                let kept = self.poses.get(source);
                !kept.is_some_and(|kept| nodes.iter().all(|to| kept.entries.contains_key(to)))
            })
            .copied()
            .collect();
        missing.sort_unstable();
        missing.dedup();
        if !missing.is_empty() {
            self.search(ground, nodes, options, &missing);
        }
        let entries = nodes.iter().map(|source| {
            let kept = self.poses.get_mut(source).expect("every source was kept or searched for");
            kept.asked = self.calls;
            nodes.iter().map(|target| kept.entries[target].clone()).collect()
        });
        let matrix = TravelMatrix { nodes: nodes.to_vec(), entries: entries.collect() };
        self.forget_the_oldest();
        matrix
    }

    /// How often routes from a pose were searched for since the cache was made.
    #[must_use]
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// Poses whose routes are kept now.
    #[must_use]
    pub fn poses(&self) -> usize {
        self.poses.len()
    }

    fn search(
        &mut self,
        ground: &Traversability,
        nodes: &[Cell],
        options: &TravelOptions<'_>,
        sources: &[Cell],
    ) {
        let survey = Survey::new(ground, nodes, options);
        let found = survey.departures(sources, Survey::entries_and_cells);
        self.searches += sources.len() as u64;
        for (&source, (entries, looked_at)) in sources.iter().zip(found) {
            let entries = nodes.iter().copied().zip(entries).collect();
            self.poses.insert(source, Kept { entries, looked_at, asked: self.calls });
        }
    }

    /// Drops the routes that a search of the new ground might not find again, and remembers that ground.
    fn forget_what_changed(&mut self, ground: &Traversability, options: &TravelOptions<'_>) {
        let TravelOptions { limits, weights } = *options;
        let comparable = self.seen.as_ref().filter(|seen| {
            seen.ground.spec() == ground.spec()
                && seen.ground.vehicle() == ground.vehicle()
                && (seen.limits, seen.weights.as_slice()) == (limits, weights)
        });
        let changed = comparable.map(|seen| changed(&seen.ground, ground));
        match &changed {
            Some(changed) if changed.words.iter().all(|&word| word == 0) => return,
            Some(changed) => self.poses.retain(|_, kept| !kept.looked_at.meets(changed)),
            None => self.poses.clear(),
        }
        let (ground, weights) = (ground.clone(), weights.to_vec());
        self.seen = Some(Seen { ground, limits, weights });
    }

    fn forget_the_oldest(&mut self) {
        let excess = self.poses.len().saturating_sub(Self::MOST_POSES);
        if excess == 0 {
            return;
        }
        let mut by_age: Vec<(u64, Cell)> =
            self.poses.iter().map(|(&pose, kept)| (kept.asked, pose)).collect();
        by_age.sort_unstable();
        for (_, pose) in &by_age[..excess] {
            self.poses.remove(pose);
        }
    }
}

/// The cells that a search may read something else of.
fn changed(before: &Traversability, now: &Traversability) -> CellSet {
    let spec = now.spec();
    let mut changed = CellSet::empty(spec);
    let (cols, first, words_a_row) = (spec.cols(), spec.first(), changed.words_a_row);
    let class = |ground: &Traversability, cell: Cell| {
        ground.classes().map(|layer| (layer.value(cell).to_bits(), layer.u(cell).to_bits()))
    };
    changed.words.par_chunks_mut(words_a_row).enumerate().for_each(|(row, words)| {
        for col in 0..cols {
            let (at, cell) = (row * cols + col, Cell::new(first.row + row, first.col + col));
            let same = before.hazard().values()[at].to_bits()
                == now.hazard().values()[at].to_bits()
                && before.open()[at] == now.open()[at]
                && before.height_m(cell).map(f32::to_bits) == now.height_m(cell).map(f32::to_bits)
                && class(before, cell) == class(now, cell);
            words[col / 64] |= u64::from(!same) << (col % 64);
        }
    });
    changed
}
