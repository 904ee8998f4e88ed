//! The most reliable way from one cell to all others.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use wisdom_grid::Cell;

use crate::traversability::offsets;
use crate::{CostVector, Route, Traversability};

/// What a drive may spend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Longest drive, seconds.
    pub max_time_s: f64,
    /// Largest energy drawn by a drive, joules.
    pub max_energy_j: f64,
}

impl Limits {
    /// No limit at all.
    pub const NONE: Self = Self { max_time_s: f64::INFINITY, max_energy_j: f64::INFINITY };

    fn allow(self, time_s: f64, energy_j: f64) -> bool {
        time_s <= self.max_time_s && energy_j <= self.max_energy_j
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// How far a [`field()`] is worked out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FieldOptions<'a> {
    /// The cells asked for: the search ends when all of them are settled, and other cells may be missing from
    /// the field. None asks for every cell.
    pub targets: Option<&'a [Cell]>,
    /// What a drive may spend; see [`field()`] for what this promises.
    pub limits: Limits,
}

/// The most reliable routes from one cell, over the ground they were found on.
#[derive(Debug, Clone)]
pub struct Field<'a> {
    ground: &'a Traversability,
    source: Cell,
    /// Distance between the beginnings of two rows in `nodes`.
    stride: usize,
    nodes: Vec<Node>,
}

/// All that the search asks of a cell, side by side: the cells in hand lie scattered along a front that is longer than
/// the nearest caches hold, so what counts is how many places a cell's data lie in.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Smallest −ln R found so far.
    label: f64,
    /// Hazard rate λ, per metre.
    hazard: f32,
    /// Steps that may be taken from here, as in `Traversability`.
    open: u8,
    /// Step back to the parent, and flags.
    state: u8,
}

/// A state byte: the step back to the parent in the low bits, and these flags.
const STEP_BACK: u8 = 0b0000_0111;
const TARGET: u8 = 0b0010_0000;
const OVER_LIMIT: u8 = 0b0100_0000;
const SETTLED: u8 = 0b1000_0000;

/// Buckets of the ring at most; beyond this ratio of the largest to the smallest edge the heap is used.
const MOST_BUCKETS: usize = 1 << 14;

/// Nodes in a cache line of 64 bytes.
const NODES_A_LINE: usize = 4;

/// Distance between the beginnings of two rows: an odd number of cache lines, because rows a power of two apart
/// would crowd into a few sets of the cache.
fn stride(cols: usize) -> usize {
    (cols.div_ceil(NODES_A_LINE) | 1) * NODES_A_LINE
}

/// Bucket width as a share of the smallest edge: the rest is room for rounding.
const BUCKET_SHARE: f64 = 0.999;

/// Finds the most reliable route (smallest −ln R) from `source` to every cell, or to the targets.
///
/// The search is label-setting (Dijkstra 1959) and exact: a label is the smallest of the sums, first edge to
/// last, over all routes. The queue is a ring of buckets no wider than the smallest edge (Dial 1969), or a
/// binary heap where hazards differ too much for that; the result is the same. Of equally reliable routes the one
/// through the smaller [`Cell`] is kept, so the routes depend on neither queue nor order.
///
/// **Limits** cut a cell when time or energy of its most reliable route exceeds them: it counts as not reached
/// and nothing is reached through it. Hence a route of the field keeps the limits; and where the most reliable
/// route of all keeps them, it is found, since each of its beginnings is most reliable too and spends less. Where
/// it does not, the cell may be missing although a less reliable route within the limits exists, and if a route
/// around the cut cells is found, it need not be the most reliable one within the limits.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_planner::{FieldOptions, Traversability, Vehicle, field};
/// use wisdom_terrain::Layer;
///
/// let plain = Layer::certain(Raster::filled(GridSpec::new(20, 20, 1.0)?, 0.0))?;
/// let ground = Traversability::new(&Vehicle::default(), &plain)?;
/// let field = field(&ground, Cell::new(0, 0), &FieldOptions::default());
/// let route = field.route(Cell::new(0, 10)).expect("nothing is in the way");
/// assert_eq!(route.cells.len(), 11);
/// assert!((route.cost.reliability() - (-0.001f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If the source or a target is not on the grid, or the grid has more than some 4·10⁹ cells.
#[must_use]
pub fn field<'a>(
    ground: &'a Traversability,
    source: Cell,
    options: &FieldOptions<'_>,
) -> Field<'a> {
    let spec = ground.spec();
    assert!(spec.contains(source), "source {source} on {spec:?}");
    let mut search = Search::new(ground, source, options);
    if search.finished() {
        return search.field;
    }
    let start = search.field.slot(source);
    let hazard = f64::from(ground.hazard_per_m(source));
    let (low, high) = ground.hazard_range();
    let (low, high) = (hazard.min(f64::from(low)), hazard.max(f64::from(high)));
    let width = BUCKET_SHARE * spec.spacing_m() * low;
    let widest = std::f64::consts::SQRT_2 * spec.spacing_m() * high;
    if widest / width < (MOST_BUCKETS - 2) as f64 {
        search.with_ring(start, width, widest);
    } else {
        search.with_heap(start);
    }
    search.field
}

impl Field<'_> {
    /// The cell the routes start from.
    #[must_use]
    pub fn source(&self) -> Cell {
        self.source
    }

    /// −ln R of the route to a cell; none if it was not reached or is not on the grid.
    #[must_use]
    pub fn neg_ln_r(&self, cell: Cell) -> Option<f64> {
        let spec = self.ground.spec();
        let node = spec.contains(cell).then(|| self.nodes[self.slot(cell)])?;
        (node.state & (SETTLED | OVER_LIMIT) == SETTLED).then_some(node.label)
    }

    /// The cost of the route to a cell; none if it was not reached. Walks the route.
    #[must_use]
    pub fn cost(&self, cell: Cell) -> Option<CostVector> {
        self.route(cell).map(|route| route.cost)
    }

    /// The route to a cell; none if it was not reached. The source's own route is the source alone.
    #[must_use]
    pub fn route(&self, cell: Cell) -> Option<Route> {
        let steps = self.steps(cell)?;
        Some(follow(self.ground, self.source, &steps))
    }

    /// The steps of the route to a cell, first to last.
    pub(crate) fn steps(&self, cell: Cell) -> Option<Vec<u8>> {
        self.neg_ln_r(cell)?;
        let (offset, start) = (offsets(self.stride), self.slot(self.source));
        let mut at = self.slot(cell);
        let mut steps = Vec::new();
        while at != start {
            let back = self.nodes[at].state & STEP_BACK;
            steps.push(7 - back);
            at = at.wrapping_add_signed(offset[usize::from(back)]);
        }
        steps.reverse();
        Some(steps)
    }

    /// Where a cell lies in `nodes`.
    fn slot(&self, cell: Cell) -> usize {
        let first = self.ground.spec().first();
        (cell.row - first.row) * self.stride + (cell.col - first.col)
    }

    /// The cell's index in a raster.
    fn index(&self, slot: usize) -> usize {
        slot - slot / self.stride * (self.stride - self.ground.spec().cols())
    }
}

/// The route that open steps from a cell make.
pub(crate) fn follow(ground: &Traversability, from: Cell, steps: &[u8]) -> Route {
    let spec = ground.spec();
    let offset = offsets(spec.cols());
    let mut at = spec.index(from);
    let mut route = Route { cells: vec![from], cost: CostVector::ZERO };
    for &step in steps {
        let step = usize::from(step);
        let to = at.wrapping_add_signed(offset[step]);
        route.cost += ground.open_edge(at, to, step);
        route.cells.push(spec.cell(to));
        at = to;
    }
    route
}

/// A search under way.
struct Search<'a> {
    field: Field<'a>,
    limits: Limits,
    /// Time and energy of the settled labels, where limits ask for them.
    spent: Option<Vec<(f64, f64)>>,
    /// Targets not settled yet; none if every cell is asked for.
    missing: Option<usize>,
    offset: [isize; 8],
    half_length_m: [f64; 8],
}

/// What settling a cell asks for.
#[derive(PartialEq)]
enum Settled {
    Expand,
    Skip,
    Finished,
}

impl<'a> Search<'a> {
    fn new(ground: &'a Traversability, source: Cell, options: &FieldOptions<'_>) -> Self {
        let spec = ground.spec();
        let stride = stride(spec.cols());
        assert!(u32::try_from(stride * spec.rows()).is_ok(), "a search over {spec:?}");
        let outside = Node { label: f64::INFINITY, hazard: 0.0, open: 0, state: 0 };
        let mut nodes = Vec::with_capacity(stride * spec.rows());
        for (hazard, open) in
            ground.hazard().values().chunks(spec.cols()).zip(ground.open().chunks(spec.cols()))
        {
            let row = hazard.iter().zip(open);
            nodes.extend(row.map(|(&hazard, &open)| Node { hazard, open, ..outside }));
            nodes.resize(nodes.len().next_multiple_of(stride), outside);
        }
        let mut field = Field { ground, source, stride, nodes };
        let start = field.slot(source);
        field.nodes[start].label = 0.0;
        let missing = options.targets.map(|targets| {
            let mut missing = 0;
            for &target in targets {
                assert!(spec.contains(target), "target {target} on {spec:?}");
                let slot = field.slot(target);
                let state = &mut field.nodes[slot].state;
                missing += usize::from(*state & TARGET == 0);
                *state |= TARGET;
            }
            missing
        });
        let spent = (options.limits != Limits::NONE).then(|| vec![(0.0, 0.0); field.nodes.len()]);
        Self {
            field,
            limits: options.limits,
            spent,
            missing,
            offset: offsets(stride),
            half_length_m: ground.length_m().map(|length| 0.5 * length),
        }
    }

    fn finished(&self) -> bool {
        self.missing == Some(0)
    }

    fn with_ring(&mut self, start: usize, width: f64, widest: f64) {
        let buckets = ((widest / width) as usize + 2).next_power_of_two();
        let (mask, per_width) = (buckets - 1, 1.0 / width);
        let mut ring: Vec<Vec<u32>> = vec![Vec::new(); buckets];
        ring[0].push(start as u32);
        let (mut now, mut waiting) = (0, 1);
        while waiting > 0 {
            // New labels are at least a bucket ahead and less than a turn: this one gets no more of them.
            let mut bucket = std::mem::take(&mut ring[now & mask]);
            waiting -= bucket.len();
            for &at in &bucket {
                match self.settle(at as usize) {
                    Settled::Expand => self.expand(at as usize, |label, to| {
                        ring[(label * per_width) as usize & mask].push(to);
                        waiting += 1;
                    }),
                    Settled::Skip => {}
                    Settled::Finished => return,
                }
            }
            bucket.clear();
            ring[now & mask] = bucket;
            now += 1;
        }
    }

    fn with_heap(&mut self, start: usize) {
        // Labels are not negative, so their bits order as they do.
        let mut heap = BinaryHeap::from([Reverse((0_u64, start as u32))]);
        while let Some(Reverse((_, at))) = heap.pop() {
            match self.settle(at as usize) {
                Settled::Expand => self.expand(at as usize, |label, to| {
                    heap.push(Reverse((label.to_bits(), to)));
                }),
                Settled::Skip => {}
                Settled::Finished => return,
            }
        }
    }

    /// Makes a cell's label final. The same cell may come again with an older, larger label.
    #[inline]
    fn settle(&mut self, at: usize) -> Settled {
        let state = self.field.nodes[at].state;
        if state & SETTLED != 0 {
            return Settled::Skip;
        }
        self.field.nodes[at].state |= SETTLED;
        let over = self.spent.is_some() && !self.keeps_limits(at);
        if over {
            self.field.nodes[at].state |= OVER_LIMIT;
        }
        if let Some(missing) = &mut self.missing
            && state & TARGET != 0
        {
            *missing -= 1;
            if *missing == 0 {
                return Settled::Finished;
            }
        }
        if over { Settled::Skip } else { Settled::Expand }
    }

    /// Whether the route to a cell keeps the limits; notes what it spends.
    fn keeps_limits(&mut self, at: usize) -> bool {
        let Some(spent) = &mut self.spent else { return true };
        let field = &self.field;
        if at != field.slot(field.source) {
            let back = usize::from(field.nodes[at].state & STEP_BACK);
            let parent = at.wrapping_add_signed(self.offset[back]);
            let edge = field.ground.open_edge(field.index(parent), field.index(at), 7 - back);
            let (time_s, energy_j) = spent[parent];
            spent[at] = (time_s + edge.time_s, energy_j + edge.energy_j);
        }
        let (time_s, energy_j) = spent[at];
        self.limits.allow(time_s, energy_j)
    }

    /// Offers a settled cell's label to its neighbours.
    #[inline]
    fn expand(&mut self, at: usize, mut push: impl FnMut(f64, u32)) {
        let (offset, half_length_m) = (self.offset, self.half_length_m);
        let nodes = self.field.nodes.as_mut_slice();
        let Node { label: base, hazard, open, .. } = nodes[at];
        let here = f64::from(hazard);
        for step in 0..8_u8 {
            if open & (1 << step) == 0 {
                continue;
            }
            let k = usize::from(step);
            let to = at.wrapping_add_signed(offset[k]);
            let node = &mut nodes[to];
            let offer = base + half_length_m[k] * (here + f64::from(node.hazard));
            if offer < node.label {
                node.label = offer;
                node.state = (node.state & TARGET) | (7 - step);
                push(offer, to as u32);
            } else if offer == node.label
                && node.state & SETTLED == 0
                && 7 - step < node.state & STEP_BACK
            {
                node.state = (node.state & TARGET) | (7 - step);
            }
        }
    }
}
