//! The merge tree of a map, kept tile by tile.

use wisdom_grid::Raster;

use super::tile::{Edge, Pair, Place, SIDE, Tile, Workspace};
use super::{Extraction, Site, pick};

/// The merge tree of a map of heights: which maximum's watershed ends at which saddle (topological persistence,
/// Edelsbrunner, Letscher & Zomorodian 2002). Cells of height 0 are not ground; every cell has eight neighbours.
///
/// The map is cut into tiles, each reduced on its own to the maxima and saddles that the rest of the map could
/// still decide; only these are joined over the whole map. When some cells change, [`MergeTree::update`] redoes their
/// tiles and the join, and the tree is the same as one made anew.
///
/// A map that rises and falls with the heights has the same maxima and saddles, so the tree of the interest serves for
/// [`MergeTree::sites`] of any prize made from it:
///
/// ```
/// # use wisdom_goals::{Extraction, MergeTree, sites};
/// # use wisdom_grid::{Cell, GridSpec, Raster};
/// let spec = GridSpec::new(1, 9, 1.0)?;
/// let mut interest = Raster::from_vec(spec, vec![0.6, 0.9, 0.6, 0.5, 0.6, 0.6, 0.8, 0.7, 0.5])?;
/// let mut tree = MergeTree::new(&interest);
/// let prize = interest.map(|b| (b - 0.5) / 0.5);
/// assert_eq!(tree.sites(&prize, &Extraction::default()), sites(&prize, &Extraction::default()));
///
/// interest[Cell::new(0, 3)] = 0.95;
/// tree.update(&interest);
/// assert_eq!(tree.sites(&interest, &Extraction::default())[0].peak, Cell::new(0, 3));
/// # Ok::<(), wisdom_grid::GridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MergeTree {
    heights: Raster<f32>,
    forest: Forest,
}

impl MergeTree {
    /// The tree of a map of heights, at least 0 and none of them NaN.
    #[must_use]
    pub fn new(heights: &Raster<f32>) -> Self {
        Self { heights: heights.clone(), forest: Forest::new(heights) }
    }

    /// Follows a change of the heights and gives the number of tiles redone: those with a changed cell in them or
    /// beside them, or all of them if the map has other sides.
    pub fn update(&mut self, heights: &Raster<f32>) -> usize {
        if heights.spec() != self.heights.spec() {
            *self = Self::new(heights);
            return self.forest.tiles.len();
        }
        let changed = self.take_changes(heights);
        let redone = changed.iter().filter(|c| **c).count();
        if redone > 0 {
            self.forest.redo(heights, &changed);
        }
        redone
    }

    /// The sites of a prize map, as [`sites`](super::sites) finds them there, if the prize rises and falls with the
    /// heights: of two cells of positive prize the higher one has the larger prize, equal ones have equal
    /// prizes, and where there is no height there is no prize.
    /// ([`prize_map`](crate::prize_map) makes such prizes of the interest.)
    ///
    /// # Panics
    /// If the prize map is not as large as the map of heights.
    #[must_use]
    pub fn sites(&self, prize: &Raster<f32>, extraction: &Extraction) -> Vec<Site> {
        let (found, wanted) = (prize.spec(), self.heights.spec());
        assert!(
            (found.rows(), found.cols()) == (wanted.rows(), wanted.cols()),
            "the prize map and the heights have the same sides"
        );
        pick(prize, self.forest.pairs(), extraction)
    }

    /// Takes over the new heights and says for every tile whether it must be redone.
    fn take_changes(&mut self, heights: &Raster<f32>) -> Vec<bool> {
        let (rows, cols) = (heights.spec().rows(), heights.spec().cols());
        let (down, across) = (rows.div_ceil(SIDE), cols.div_ceil(SIDE));
        let mut changed = vec![false; down * across];
        for row in 0..rows {
            for col in (0..cols).step_by(SIDE) {
                let part = row * cols + col..row * cols + (col + SIDE).min(cols);
                let new = &heights.values()[part.clone()];
                let old = &mut self.heights.values_mut()[part];
                if !differs(old, new) {
                    continue;
                }
                let last = new.len() - 1;
                let west = col.saturating_sub(usize::from(differs(&old[..1], &new[..1])));
                let east = col + last + usize::from(differs(&old[last..], &new[last..]));
                for r in row.saturating_sub(1) / SIDE..=(row + 1).min(rows - 1) / SIDE {
                    let tiles = west / SIDE..=east.min(cols - 1) / SIDE;
                    tiles.for_each(|c| changed[r * across + c] = true);
                }
                old.copy_from_slice(new);
            }
        }
        changed
    }
}

/// Whether any bit differs.
fn differs(old: &[f32], new: &[f32]) -> bool {
    // Without an early end, so that it is compared many cells at a time.
    old.iter().zip(new).fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits())) != 0
}

/// The tiles of a map, and what only the whole map decides.
#[derive(Debug, Clone)]
pub(super) struct Forest {
    /// Row by row.
    tiles: Vec<Tile>,
    /// Pairs across tiles.
    joined: Vec<Pair>,
    /// Union-find over the cells that links and edges name, by index.
    parent: Vec<u32>,
}

impl Forest {
    pub(super) fn new(heights: &Raster<f32>) -> Self {
        let spec = heights.spec();
        let count = spec.rows().div_ceil(SIDE) * spec.cols().div_ceil(SIDE);
        let tiles = vec![Tile::default(); count];
        let mut forest = Self { tiles, joined: Vec::new(), parent: vec![0; spec.len()] };
        forest.redo(heights, &vec![true; count]);
        forest
    }

    /// Every maximum with the saddle where it ends, in no particular order.
    pub(super) fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.tiles.iter().flat_map(|t| &t.pairs).chain(&self.joined).copied()
    }

    /// Reduces the changed tiles anew and joins all.
    fn redo(&mut self, heights: &Raster<f32>, changed: &[bool]) {
        let (rows, cols) = (heights.spec().rows(), heights.spec().cols());
        let across = cols.div_ceil(SIDE);
        let mut workspace = Workspace::new();
        for (i, _) in changed.iter().enumerate().filter(|(_, changed)| **changed) {
            let place = Place { row: i / across * SIDE, col: i % across * SIDE, rows, cols };
            self.tiles[i] = workspace.reduce(heights.values(), place);
        }
        self.join(heights.values());
    }

    /// Joins what the tiles left open, from the highest saddle down.
    fn join(&mut self, heights: &[f32]) {
        self.joined.clear();
        for &(cell, higher) in self.tiles.iter().flat_map(|t| &t.links) {
            self.parent[cell as usize] = higher;
        }
        let edges: Vec<Edge> = self.tiles.iter().flat_map(|t| &t.edges).copied().collect();
        let falling = |(i, edge): (usize, &Edge)| {
            (u64::from(!heights[edge.saddle as usize].to_bits()) << 32) | i as u64
        };
        let mut order: Vec<u64> = edges.iter().enumerate().map(falling).collect();
        order.sort_unstable();
        for key in order {
            let Edge { saddle, ends: [a, b] } = edges[key as u32 as usize];
            let (a, b) = (self.root(a), self.root(b));
            if a == b {
                continue;
            }
            let height = |i: u32| heights[i as usize];
            // The root of a watershed is its highest cell, the first of equals.
            let is_first = height(b).total_cmp(&height(a)).then(a.cmp(&b)).is_lt();
            let (kept, peak) = if is_first { (a, b) } else { (b, a) };
            if height(peak) > height(saddle) {
                self.joined.push(Pair { peak, saddle: Some(saddle) });
            }
            self.parent[peak as usize] = kept;
        }
        let own = self.tiles.iter().flat_map(|t| &t.links).filter(|(cell, higher)| cell == higher);
        let islands = own.filter(|&&(cell, _)| self.parent[cell as usize] == cell);
        self.joined.extend(islands.map(|&(peak, _)| Pair { peak, saddle: None }));
    }

    /// The root of a cell's watershed, halving the path on the way.
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let up = self.parent[i as usize] as usize;
            self.parent[i as usize] = self.parent[up];
            i = self.parent[i as usize];
        }
        i
    }
}
