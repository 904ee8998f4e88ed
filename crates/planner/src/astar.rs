//! The most reliable way from one cell to one other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

use wisdom_grid::Cell;

use crate::traversability::offsets;
use crate::{CostVector, Route, Traversability};

/// The most reliable route between two cells, and what it took to find it.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The route, start and end included.
    pub route: Route,
    /// Cells whose neighbours were looked at; a cell counts again where a better way to it was found later.
    pub expansions: u64,
}

/// Finds the most reliable route (smallest −ln R) from one cell to another; none if there is no way.
///
/// It is the route that [`field()`](crate::field()) has for the pair, to the last bit and, of equally reliable ones,
/// through the same cells. Whoever asks more than once on the same ground keeps a [`Router`], which does this.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_planner::{Traversability, Vehicle, route};
/// use wisdom_terrain::Layer;
///
/// let plain = Layer::certain(Raster::filled(GridSpec::new(20, 20, 1.0)?, 0.0))?;
/// let ground = Traversability::new(&Vehicle::default(), &plain)?;
/// let found = route(&ground, Cell::new(3, 2), Cell::new(3, 17)).expect("nothing is in the way");
/// assert_eq!(found.route.cells.len(), 16);
/// assert!(found.expansions < 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If a cell is not on the grid, or the grid has more than some 4·10⁹ cells.
#[must_use]
pub fn route(ground: &Traversability, from: Cell, to: Cell) -> Option<Found> {
    Router::new(ground).route(from, to)
}

/// Point-to-point search on one ground, its memory kept from one question to the next.
///
/// The search is A* (Hart, Nilsson and Raphael 1968): cells are taken in the order of the cost so far and a bound of
/// the cost to come, the octile distance times the lowest hazard on the map. The queue is a ring of buckets on that
/// sum, or a binary heap where hazards differ too much for one. A bucket is not sorted; a cell that is reached better
/// after its turn gets another, so the labels are exact whatever the order. To return the route of the field rather
/// than any as good, all cells that may lie on an equally good one are looked at; only on ground of one hazard,
/// where most routes are equally good, does that cost much.
#[derive(Debug, Clone)]
pub struct Router<'a> {
    ground: &'a Traversability,
    /// Distance between the beginnings of two rows in `nodes`.
    stride: usize,
    nodes: Vec<Node>,
    /// Which question the nodes' labels must belong to.
    question: u16,
    ring: Vec<Vec<u32>>,
    heap: BinaryHeap<Reverse<(u64, u32)>>,
}

/// All that the search asks of a cell, side by side in a quarter of a cache line.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Smallest −ln R found so far, if it is of the question asked.
    label: f64,
    /// Hazard rate λ, per metre.
    hazard: f32,
    /// Steps that may be taken from here, as in `Traversability`.
    open: u8,
    /// Step back to the parent, and whether the cell waits for its turn.
    state: u8,
    /// The question that the label and the state belong to.
    question: u16,
}

/// A state byte: the step back to the parent in the low bits, and a flag.
const STEP_BACK: u8 = 0b0000_0111;
const WAITING: u8 = 0b1000_0000;

/// Nodes in a cache line of 64 bytes; rows an odd number of lines apart spread over all sets of the cache.
const NODES_A_LINE: usize = 4;

/// Buckets of the ring at most; where hazards differ more than that allows, the heap is used.
const MOST_BUCKETS: usize = 1 << 14;

/// Buckets over the smallest edge. One would do; with some more, few cells are reached better after their turn.
const BUCKETS_AN_EDGE: f64 = 4.0;

/// The bound's share of the octile bound: along each edge it leaves room for rounding, a millionth of the edge. Sums
/// of less than 10⁹ smallest edges are rounded by less.
const BOUND_SHARE: f64 = 1.0 - 1e-6;

impl<'a> Router<'a> {
    /// Gets ready for questions about a ground (16 bytes a cell).
    ///
    /// # Panics
    /// If the grid has more than some 4·10⁹ cells.
    #[must_use]
    pub fn new(ground: &'a Traversability) -> Self {
        let spec = ground.spec();
        let stride = (spec.cols().div_ceil(NODES_A_LINE) | 1) * NODES_A_LINE;
        assert!(u32::try_from(stride * spec.rows()).is_ok(), "a search over {spec:?}");
        let outside = Node { label: f64::INFINITY, hazard: 0.0, open: 0, state: 0, question: 0 };
        let mut nodes = Vec::with_capacity(stride * spec.rows());
        let hazard = ground.hazard().values().chunks(spec.cols());
        for (hazard, open) in hazard.zip(ground.open().chunks(spec.cols())) {
            let row = hazard.iter().zip(open);
            nodes.extend(row.map(|(&hazard, &open)| Node { hazard, open, ..outside }));
            nodes.resize(nodes.len().next_multiple_of(stride), outside);
        }
        Self { ground, stride, nodes, question: 0, ring: Vec::new(), heap: BinaryHeap::new() }
    }

    /// Finds the most reliable route between two cells, as [`route()`].
    ///
    /// # Panics
    /// If a cell is not on the grid.
    pub fn route(&mut self, from: Cell, to: Cell) -> Option<Found> {
        let spec = self.ground.spec();
        assert!(spec.contains(from), "source {from} on {spec:?}");
        assert!(spec.contains(to), "target {to} on {spec:?}");
        if from == to {
            let route = Route { cells: vec![from], cost: CostVector::ZERO };
            return Some(Found { route, expansions: 0 });
        }
        if self.ground.is_blocked(to) {
            return None;
        }
        self.next_question();
        let first = spec.first();
        let place = |cell: Cell| Place { row: cell.row - first.row, col: cell.col - first.col };
        let (start, goal) = (place(from), place(to));
        let (low, high) = self.ground.hazard_range();
        // The first edges may be cheaper or dearer than all others: the rover may stand on a blocked cell.
        let here = self.ground.hazard_per_m(from);
        let (least, most) = (f64::from(low.min(here)), f64::from(high.max(here)));
        let straight = BOUND_SHARE * spec.spacing_m() * f64::from(low);
        let bound = Bound { goal, straight, diagonal: straight * (SQRT_2 - 1.0) };
        let expansions = {
            let mut search = Search {
                nodes: &mut self.nodes,
                stride: self.stride,
                question: self.question,
                offset: offsets(self.stride),
                half_length_m: self.ground.length_m().map(|length| 0.5 * length),
                bound,
                goal_slot: goal.slot(self.stride),
                best: f64::INFINITY,
                expansions: 0,
            };
            search.nodes[start.slot(self.stride)] = Node {
                label: 0.0,
                state: WAITING,
                question: self.question,
                ..search.nodes[start.slot(self.stride)]
            };
            // No cell is taken before the start, and none is pushed further on than an edge and two bounds of one.
            let step = SQRT_2 * spec.spacing_m() * f64::from(low);
            let begin = (bound.to(start) - step).max(0.0);
            let ahead = SQRT_2 * spec.spacing_m() * most + 2.0 * step;
            let width = spec.spacing_m() * least / BUCKETS_AN_EDGE;
            if ahead / width < (MOST_BUCKETS - 2) as f64 {
                let buckets = ((ahead / width) as usize + 2).next_power_of_two();
                if self.ring.len() < buckets {
                    self.ring.resize_with(buckets, Vec::new);
                }
                search.with_ring(&mut self.ring, start, begin, 1.0 / width);
            } else {
                search.with_heap(&mut self.heap, start);
            }
            search.best.is_finite().then_some(search.expansions)
        }?;
        Some(Found { route: self.walk_back(from, to), expansions })
    }

    /// Makes all labels those of an earlier question.
    fn next_question(&mut self) {
        if self.question == u16::MAX {
            self.nodes.iter_mut().for_each(|node| node.question = 0);
            self.question = 0;
        }
        self.question += 1;
    }

    /// The route that the steps back from the target make.
    fn walk_back(&self, from: Cell, to: Cell) -> Route {
        let spec = self.ground.spec();
        let (offset, first) = (offsets(spec.cols()), spec.first());
        let (start, mut at) = (spec.index(from), spec.index(to));
        let mut steps = Vec::new();
        while at != start {
            let cell = spec.cell(at);
            let slot = (cell.row - first.row) * self.stride + (cell.col - first.col);
            let back = usize::from(self.nodes[slot].state & STEP_BACK);
            at = at.wrapping_add_signed(offset[back]);
            steps.push(7 - back);
        }
        let mut route = Route { cells: vec![from], cost: CostVector::ZERO };
        for &step in steps.iter().rev() {
            let next = at.wrapping_add_signed(offset[step]);
            route.cost += self.ground.open_edge(at, next, step);
            route.cells.push(spec.cell(next));
            at = next;
        }
        route
    }
}

/// A cell counted from the first of the grid; a side of a grid fits 16 bits.
#[derive(Debug, Clone, Copy)]
struct Place {
    row: usize,
    col: usize,
}

impl Place {
    fn slot(self, stride: usize) -> usize {
        self.row * stride + self.col
    }

    fn packed(self) -> u32 {
        (self.row as u32) << 16 | self.col as u32
    }

    fn unpacked(packed: u32) -> Self {
        Self { row: (packed >> 16) as usize, col: (packed & 0xFFFF) as usize }
    }
}

/// The least −ln R from a cell to the goal: its octile distance over the lowest hazard.
#[derive(Debug, Clone, Copy)]
struct Bound {
    goal: Place,
    /// Of a straight step.
    straight: f64,
    /// What a diagonal step adds to a straight one.
    diagonal: f64,
}

impl Bound {
    #[inline]
    fn to(&self, from: Place) -> f64 {
        let (rows, cols) = (from.row.abs_diff(self.goal.row), from.col.abs_diff(self.goal.col));
        self.straight * rows.max(cols) as f64 + self.diagonal * rows.min(cols) as f64
    }
}

/// A search under way.
struct Search<'a> {
    nodes: &'a mut [Node],
    stride: usize,
    question: u16,
    offset: [isize; 8],
    half_length_m: [f64; 8],
    bound: Bound,
    goal_slot: usize,
    /// The goal's label.
    best: f64,
    expansions: u64,
}

impl Search<'_> {
    fn with_ring(&mut self, ring: &mut [Vec<u32>], start: Place, begin: f64, per_width: f64) {
        let mask = ring.len() - 1;
        debug_assert!(ring.len().is_power_of_two(), "indices are masked");
        let mut now = (begin * per_width) as usize;
        let mut waiting = 1;
        ring[now & mask].push(start.packed());
        let mut last = usize::MAX;
        while waiting > 0 && now <= last {
            while let Some(at) = ring[now & mask].pop() {
                waiting -= 1;
                self.expand(Place::unpacked(at), |sum, to| {
                    // Rounding never sends a cell behind the bucket in hand, where it would wait for a whole turn.
                    ring[((sum * per_width) as usize).max(now) & mask].push(to);
                    waiting += 1;
                });
            }
            if self.best.is_finite() {
                last = (self.best * per_width) as usize;
            }
            now += 1;
        }
        for ahead in 0..ring.len() {
            if waiting == 0 {
                break;
            }
            let bucket = &mut ring[(now + ahead) & mask];
            waiting -= bucket.len();
            bucket.clear();
        }
    }

    fn with_heap(&mut self, heap: &mut BinaryHeap<Reverse<(u64, u32)>>, start: Place) {
        // Sums are not negative, so their bits order as they do.
        heap.push(Reverse((0, start.packed())));
        while let Some(Reverse((sum, at))) = heap.pop() {
            if f64::from_bits(sum) > self.best {
                break;
            }
            self.expand(Place::unpacked(at), |sum, to| heap.push(Reverse((sum.to_bits(), to))));
        }
        heap.clear();
    }

    /// Offers a waiting cell's label to its neighbours, and pushes those it improves, with the sum of their label
    /// and bound.
    #[inline]
    fn expand(&mut self, place: Place, mut push: impl FnMut(f64, u32)) {
        let at = place.slot(self.stride);
        let nodes = &mut *self.nodes;
        let Node { label: base, hazard, open, state, .. } = nodes[at];
        if state & WAITING == 0 {
            return;
        }
        nodes[at].state = state & STEP_BACK;
        self.expansions += 1;
        let here = f64::from(hazard);
        for step in 0..8_u8 {
            if open & (1 << step) == 0 {
                continue;
            }
            let k = usize::from(step);
            let to = at.wrapping_add_signed(self.offset[k]);
            let node = &mut nodes[to];
            let offer = base + self.half_length_m[k] * (here + f64::from(node.hazard));
            let label = if node.question == self.question { node.label } else { f64::INFINITY };
            if offer < label {
                let place = place.stepped(k);
                let sum = offer + self.bound.to(place);
                if sum > self.best {
                    continue;
                }
                let reached = to == self.goal_slot;
                node.label = offer;
                node.question = self.question;
                node.state = if reached { 7 - step } else { WAITING | (7 - step) };
                if reached {
                    self.best = offer;
                } else {
                    push(sum, place.packed());
                }
            } else if offer == label && base < offer && 7 - step < node.state & STEP_BACK {
                // Of equally reliable ways the one through the smaller cell, as in the field.
                node.state = (node.state & WAITING) | (7 - step);
            }
        }
    }
}

impl Place {
    /// The neighbour that a step leads to; the step is open, so there is one.
    #[inline]
    fn stepped(self, step: usize) -> Self {
        let (row, col) = crate::traversability::STEPS[step];
        Self { row: self.row.wrapping_add_signed(row), col: self.col.wrapping_add_signed(col) }
    }
}
