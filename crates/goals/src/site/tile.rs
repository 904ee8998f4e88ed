//! The reduced merge tree of one tile of a map of heights.

/// Rows and columns of a tile.
pub(super) const SIDE: usize = 64;

/// Row length of a tile with the ring of foreign cells around it.
const STRIDE: usize = SIDE + 2;

/// Cells of a tile with its ring.
const PADDED: usize = STRIDE * STRIDE;

/// Steps to the eight neighbours within a padded tile, north first, clockwise.
const RING: [isize; 8] = {
    let row = STRIDE as isize;
    [-row, 1 - row, 1, 1 + row, row, row - 1, -1, -1 - row]
};

/// The upper link of a cell: of each group of higher neighbours that touch each other, one.
///
/// Such a group is joined above the cell already, so the cell joins no more than one watershed a group.
#[derive(Clone, Copy)]
struct UpperLink {
    groups: u8,
    first: [u8; 4],
}

/// The upper link of every set of higher neighbours (bit k: the neighbour at `RING[k]`).
const LINKS: [UpperLink; 256] = {
    let mut links = [UpperLink { groups: 0, first: [0; 4] }; 256];
    let mut set = 0;
    while set < 256 {
        links[set] = upper_link(set as u8);
        set += 1;
    }
    links
};

/// Where the path uphill leaves a cell with this set of higher neighbours: a step, 0 from a maximum.
const UPHILL: [i16; 256] = {
    let mut steps = [0; 256];
    let mut set = 1;
    while set < 256 {
        steps[set] = RING[LINKS[set].first[0] as usize] as i16;
        set += 1;
    }
    steps
};

const fn upper_link(set: u8) -> UpperLink {
    let mut link = UpperLink { groups: 0, first: [0; 4] };
    let mut left = set;
    while left != 0 {
        let first = left.trailing_zeros() as u8;
        link.first[link.groups as usize] = first;
        link.groups += 1;
        let mut group: u8 = 1 << first;
        // Four rounds reach the farthest of eight: the group spreads both ways round the cell.
        let mut round = 0;
        while round < 4 {
            // Neighbours in the ring touch; so do those two apart that share a side with the cell.
            let sides = group & 0b0101_0101;
            group |= set
                & (group.rotate_left(1)
                    | group.rotate_right(1)
                    | sides.rotate_left(2)
                    | sides.rotate_right(2));
            round += 1;
        }
        left &= !group;
    }
    link
}

/// A maximum and the saddle where its watershed meets a higher one; none for the highest of an island.
///
/// Both are row-major indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pair {
    pub(super) peak: u32,
    pub(super) saddle: Option<u32>,
}

/// A saddle where two watersheds meet of which the tile cannot tell which ends: the rest of the map may make either
/// of them higher.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) saddle: u32,
    pub(super) ends: [u32; 2],
}

/// What the rest of the map has to know of a tile.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Tile {
    /// Maxima whose watershed ends inside the tile, whatever lies around it; those no higher than their saddle are
    /// left out.
    pub(super) pairs: Vec<Pair>,
    /// A cell and one that it is joined to without a step below the cell: every cell beside another tile, each with
    /// a maximum of this tile or with a higher foreign cell, and every maximum so named with itself.
    pub(super) links: Vec<(u32, u32)>,
    /// Undecided saddles.
    pub(super) edges: Vec<Edge>,
}

/// Where a tile lies: its first row and column, and the sides of the map, in cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) row: usize,
    pub(super) col: usize,
    pub(super) rows: usize,
    pub(super) cols: usize,
}

/// Memory to work on tile after tile. All of it is indexed by padded cell.
pub(super) struct Workspace {
    heights: Vec<f32>,
    /// Set of higher neighbours.
    higher: Vec<u8>,
    /// Union-find: uphill at first, then from ended watersheds to those they met.
    parent: Vec<u16>,
    /// Whether the watershed of a root may reach beyond the tile.
    open: Vec<bool>,
    /// Whether a maximum is linked to itself already.
    named: Vec<bool>,
    /// Cells where a watershed begins.
    maxima: Vec<u16>,
    /// Cells where watersheds may meet or leave the tile, as sortable keys: highest first, ties by cell.
    events: Vec<u64>,
    /// What is `open` before anything met: the ring.
    ring: Vec<bool>,
}

impl Workspace {
    pub(super) fn new() -> Self {
        let on_ring = |i: usize| {
            let (row, col) = (i / STRIDE, i % STRIDE);
            row == 0 || row > SIDE || col == 0 || col > SIDE
        };
        Self {
            heights: vec![0.0; PADDED],
            higher: vec![0; PADDED],
            parent: vec![0; PADDED],
            open: vec![false; PADDED],
            named: vec![false; PADDED],
            maxima: Vec::new(),
            events: Vec::new(),
            ring: (0..PADDED).map(on_ring).collect(),
        }
    }

    /// Reduces the tile at a place of a map, given row by row.
    pub(super) fn reduce(&mut self, map: &[f32], place: Place) -> Tile {
        self.take(map, place);
        self.compare();
        self.list(place);
        self.join(place)
    }

    /// Copies the tile and its ring; beyond the map there is no ground.
    fn take(&mut self, map: &[f32], place: Place) {
        self.heights.fill(0.0);
        let (west, pad) = (place.col.saturating_sub(1), usize::from(place.col == 0));
        let width = (place.col + SIDE + 1).min(place.cols) - west;
        let north = place.row.saturating_sub(1);
        for row in north..(place.row + SIDE + 1).min(place.rows) {
            let to = (row + 1 - place.row) * STRIDE + pad;
            let from = row * place.cols + west;
            self.heights[to..to + width].copy_from_slice(&map[from..from + width]);
        }
        self.open.copy_from_slice(&self.ring);
        self.named.fill(false);
        for (i, parent) in self.parent.iter_mut().enumerate() {
            *parent = i as u16;
        }
    }

    /// Finds the higher neighbours of every cell. Of two equal cells the one that comes first is the higher.
    fn compare(&mut self) {
        let row_of = |row: usize| -> &[f32; STRIDE] {
            self.heights[row * STRIDE..][..STRIDE].try_into().expect("a row of the padded tile")
        };
        for row in 1..=SIDE {
            let (north, here, south) = (row_of(row - 1), row_of(row), row_of(row + 1));
            let mut sets = [0u8; SIDE];
            for (c, set) in sets.iter_mut().enumerate() {
                let height = here[c + 1];
                let bit = |higher: bool, k: u32| u32::from(higher) << k;
                let found = bit(north[c + 1] >= height, 0)
                    | bit(north[c + 2] >= height, 1)
                    | bit(here[c + 2] > height, 2)
                    | bit(south[c + 2] > height, 3)
                    | bit(south[c + 1] > height, 4)
                    | bit(south[c] > height, 5)
                    | bit(here[c] >= height, 6)
                    | bit(north[c] >= height, 7);
                *set = if height > 0.0 { found as u8 } else { 0 };
            }
            let at = row * STRIDE + 1;
            self.higher[at..at + SIDE].copy_from_slice(&sets);
            for (c, (parent, set)) in self.parent[at..at + SIDE].iter_mut().zip(sets).enumerate() {
                *parent = ((at + c) as u16).wrapping_add_signed(UPHILL[usize::from(set)]);
            }
        }
    }

    /// Lists maxima, and in falling order the cells where something may happen: saddles, and cells beside another tile.
    fn list(&mut self, place: Place) {
        self.maxima.clear();
        self.events.clear();
        let mut critical = [0u16; SIDE];
        for row in 1..=SIDE {
            let at = row * STRIDE + 1;
            let cells = self.heights[at..at + SIDE].iter().zip(&self.higher[at..at + SIDE]);
            // On rough ground a quarter of the cells are critical, in no order: a branch would often go wrong.
            let mut count = 0;
            for (c, (&height, &set)) in cells.enumerate() {
                critical[count] = (at + c) as u16;
                count += usize::from(height > 0.0 && LINKS[usize::from(set)].groups != 1);
            }
            for &i in &critical[..count] {
                match LINKS[usize::from(self.higher[usize::from(i)])].groups {
                    0 => self.maxima.push(i),
                    _ => self.events.push(self.key(i)),
                }
            }
        }
        for i in beside_other_tiles(place) {
            let groups = LINKS[usize::from(self.higher[usize::from(i)])].groups;
            if self.heights[usize::from(i)] > 0.0 && groups < 2 {
                self.events.push(self.key(i));
            }
        }
        self.events.sort_unstable();
    }

    /// Sorts before the keys of all lower cells.
    fn key(&self, i: u16) -> u64 {
        (u64::from(!self.heights[usize::from(i)].to_bits()) << 16) | u64::from(i)
    }

    /// Joins watersheds from the highest event down.
    fn join(&mut self, place: Place) -> Tile {
        let mut tile = Tile::default();
        let events = std::mem::take(&mut self.events);
        for &event in &events {
            let i = event as u16;
            let link = LINKS[usize::from(self.higher[usize::from(i)])];
            let mut top = self.root(i);
            for &k in link.first[..usize::from(link.groups)].iter().skip(1) {
                let other = self.root(i.wrapping_add_signed(RING[usize::from(k)] as i16));
                if other != top {
                    top = self.meet(top, other, i, place, &mut tile);
                }
            }
            if is_beside_other_tile(i, place) {
                self.open[usize::from(top)] = true;
                self.name(top, place, &mut tile);
                if top != i {
                    tile.links.push((index(i, place), index(top, place)));
                }
            }
        }
        self.events = events;
        let ends_nowhere =
            |&&i: &&u16| self.parent[usize::from(i)] == i && !self.open[usize::from(i)];
        let islands = self.maxima.iter().filter(ends_nowhere);
        tile.pairs.extend(islands.map(|&i| Pair { peak: index(i, place), saddle: None }));
        tile
    }

    /// Joins two watersheds at a saddle and gives the root of both, the higher of theirs.
    fn meet(&mut self, a: u16, b: u16, saddle: u16, place: Place, tile: &mut Tile) -> u16 {
        let height = |i: u16| self.heights[usize::from(i)];
        let (kept, ended) = if self.key(a) < self.key(b) { (a, b) } else { (b, a) };
        if self.open[usize::from(ended)] {
            let ends = [index(kept, place), index(ended, place)];
            tile.edges.push(Edge { saddle: index(saddle, place), ends });
            self.name(kept, place, tile);
            self.name(ended, place, tile);
            self.open[usize::from(kept)] = true;
        } else if height(ended) > height(saddle) {
            let saddle = Some(index(saddle, place));
            tile.pairs.push(Pair { peak: index(ended, place), saddle });
        }
        self.parent[usize::from(ended)] = kept;
        kept
    }

    /// Links a maximum of the tile to itself, once. Foreign cells are linked by their own tile.
    fn name(&mut self, i: u16, place: Place, tile: &mut Tile) {
        if !self.ring[usize::from(i)] && !std::mem::replace(&mut self.named[usize::from(i)], true) {
            tile.links.push((index(i, place), index(i, place)));
        }
    }

    /// The root of a cell's watershed, halving the path on the way.
    fn root(&mut self, mut i: u16) -> u16 {
        let parent = self.parent.as_mut_slice();
        loop {
            let up = parent[usize::from(i)];
            if up == i {
                return i;
            }
            let next = parent[usize::from(up)];
            parent[usize::from(i)] = next;
            i = next;
        }
    }
}

/// Row-major index on the map of a padded cell of a tile.
fn index(i: u16, place: Place) -> u32 {
    let (row, col) = (usize::from(i) / STRIDE, usize::from(i) % STRIDE);
    ((place.row + row - 1) * place.cols + place.col + col - 1) as u32
}

/// Whether a padded cell of the tile touches a cell of another tile.
fn is_beside_other_tile(i: u16, place: Place) -> bool {
    let (row, col) = (usize::from(i) / STRIDE, usize::from(i) % STRIDE);
    (row == 1 && place.row > 0)
        || (row == SIDE && place.row + SIDE < place.rows)
        || (col == 1 && place.col > 0)
        || (col == SIDE && place.col + SIDE < place.cols)
}

/// The padded cells of the tile that touch a cell of another tile.
fn beside_other_tiles(place: Place) -> impl Iterator<Item = u16> {
    let row = |row: usize| (1..=SIDE).map(move |col| row * STRIDE + col);
    let sides = (2..SIDE).flat_map(|row| [row * STRIDE + 1, row * STRIDE + SIDE]);
    row(1)
        .chain(sides)
        .chain(row(SIDE))
        .map(|i| i as u16)
        .filter(move |&i| is_beside_other_tile(i, place))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groups of touching cells among the chosen neighbours, by walking.
    fn groups_by_walking(set: u8) -> usize {
        let at = |k: usize| (RING[k] + 2 * STRIDE as isize) as usize;
        let touch = |a: usize, b: usize| {
            let apart = |f: fn(usize) -> usize| f(at(a)).abs_diff(f(at(b)));
            // Shifted by a column, so that no neighbour lies across a row's end.
            apart(|i| (i + 1) / STRIDE) <= 1 && apart(|i| (i + 1) % STRIDE) <= 1
        };
        let mut left: Vec<usize> = (0..8).filter(|k| set & (1 << k) != 0).collect();
        let mut groups = 0;
        while let Some(first) = left.pop() {
            groups += 1;
            let mut open = vec![first];
            while let Some(a) = open.pop() {
                let (near, far) = left.iter().copied().partition(|&b| touch(a, b));
                left = far;
                open.extend::<Vec<usize>>(near);
            }
        }
        groups
    }

    #[test]
    fn an_upper_link_has_one_neighbour_of_every_group_that_touches() {
        for set in 0..=u8::MAX {
            let link = LINKS[usize::from(set)];
            assert_eq!(usize::from(link.groups), groups_by_walking(set), "{set:#010b}");
            let chosen = &link.first[..usize::from(link.groups)];
            assert!(chosen.iter().all(|k| set & (1 << k) != 0), "{set:#010b}");
            let apart = chosen.iter().fold(0, |all, k| all | (1u8 << k));
            assert_eq!(groups_by_walking(apart), chosen.len(), "{set:#010b}");
        }
    }

    #[test]
    fn a_lone_tile_decides_everything() {
        let map = [0.0, 0.9, 0.4, 0.7, 0.0, 0.2];
        let place = Place { row: 0, col: 0, rows: 1, cols: 6 };
        let tile = Workspace::new().reduce(&map, place);
        let pairs = vec![
            Pair { peak: 3, saddle: Some(2) },
            Pair { peak: 1, saddle: None },
            Pair { peak: 5, saddle: None },
        ];
        assert_eq!(tile, Tile { pairs, ..Tile::default() });
    }
}
