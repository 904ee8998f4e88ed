//! The search itself: label-setting over a map, whatever its steps cost.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use wisdom_grid::{Cell, GridSpec};

use super::{FieldOptions, Limits};
use crate::Traversability;
use crate::traversability::offsets;

/// Where cells lie in the arrays of a search: row by row, with a margin behind each row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    rows: usize,
    cols: usize,
    first: Cell,
    stride: usize,
    offset: [isize; 8],
}

impl Layout {
    /// Rows begin an odd number of cache lines of labels apart: a power of two would crowd them into a few sets of
    /// the cache.
    pub(crate) fn new(spec: GridSpec) -> Self {
        const LABELS_A_LINE: usize = 8;
        let stride = ((spec.cols() + 1).div_ceil(LABELS_A_LINE) | 1) * LABELS_A_LINE;
        let (rows, cols, first) = (spec.rows(), spec.cols(), spec.first());
        assert!(u32::try_from(stride * rows).is_ok(), "a search over {spec:?}");
        Self { rows, cols, first, stride, offset: offsets(stride) }
    }

    pub(crate) fn slots(&self) -> usize {
        self.rows * self.stride
    }

    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// What each step adds to a slot.
    pub(crate) fn offset(&self) -> &[isize; 8] {
        &self.offset
    }

    pub(crate) fn slot(&self, cell: Cell) -> usize {
        (cell.row - self.first.row) * self.stride + (cell.col - self.first.col)
    }

    /// The cell's index in a raster.
    pub(crate) fn index(&self, slot: usize) -> usize {
        slot - slot / self.stride * (self.stride - self.cols)
    }
}

/// A map as the search sees it: a label a cell, and what the open steps cost.
///
/// A label is infinite where none was found, and −∞ where the search cut the cell: nothing lowers it further, and
/// it equals no sum of costs.
pub(crate) trait Net {
    fn layout(&self) -> &Layout;
    fn label(&self, at: usize) -> f64;
    fn set_label(&mut self, at: usize, label: f64);
    /// The cost of a step; none if it is closed.
    fn step_cost(&self, from: usize, to: usize, step: usize) -> Option<f64>;
    /// Offers a cell's label to its neighbours, lowers those it improves and says which.
    fn expand(&mut self, at: usize, push: impl FnMut(f64, usize));
    /// Smallest and largest cost of a step that a search from a cell may take.
    fn cost_range(&self, ground: &Traversability, source: Cell) -> (f64, f64);
}

/// Memory that one search after another can use.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    ring: Vec<Vec<u32>>,
    live: Vec<u32>,
}

/// The best routes from a cell.
#[derive(Debug, Clone)]
pub(crate) struct Tree<N> {
    net: N,
    source: Cell,
    settled: Settled,
}

/// Which labels are final.
#[derive(Debug, Clone)]
enum Settled {
    /// Those of the buckets up to `last`.
    Ring { per_width: f64, last: f64 },
    /// Those flagged; a state has the step back to the parent in its low bits.
    Heap(Vec<u8>),
}

/// A state byte of the heap: the step back to the parent, and a flag.
const STEP_BACK: u8 = 0b0000_0111;
const SETTLED: u8 = 0b1000_0000;

/// Buckets of the ring at most; beyond this ratio of the largest to the smallest edge the heap is used.
const MOST_BUCKETS: usize = 1 << 14;

/// Bucket width as a share of the smallest edge: the rest is room for rounding.
const BUCKET_SHARE: f64 = 0.999;

/// Widths that a label may have at most: a thousandth of a width must be well above the rounding of a label.
const MOST_WIDTHS: f64 = 1e12;

/// The label of a cell that the search cut.
const CUT: f64 = f64::NEG_INFINITY;

/// 2⁵²: a number of widths added to it is rounded to a whole one, which its low bits then show. (Which way it is
/// rounded does not matter, as long as larger labels never get smaller buckets.)
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Finds the cheapest route from a cell to all others, or to the targets.
pub(crate) fn search<N: Net>(
    ground: &Traversability,
    mut net: N,
    source: Cell,
    options: &FieldOptions<'_>,
    worst: Option<WorstStep>,
    scratch: &mut Scratch,
) -> Tree<N> {
    let spec = ground.spec();
    assert!(spec.contains(source), "source {source} on {spec:?}");
    let layout = *net.layout();
    let slot = |&target: &Cell| {
        assert!(spec.contains(target), "target {target} on {spec:?}");
        layout.slot(target)
    };
    let targets = options.targets.map(|targets| targets.iter().map(slot).collect());
    net.set_label(layout.slot(source), 0.0);
    let (low, high) = net.cost_range(ground, source);
    let limited = worst.map(|worst| Spending::new(options.limits, worst, low));
    let width = BUCKET_SHARE * low;
    let tree = Tree { net, source, settled: Settled::Ring { per_width: 1.0 / width, last: 0.0 } };
    let mut search = Search { ground, tree, targets, limited };
    let turn = high / width;
    if turn < (MOST_BUCKETS - 2) as f64 && turn * (layout.slots() as f64) < MOST_WIDTHS {
        search.with_ring((turn as usize + 2).next_power_of_two(), scratch);
    } else {
        search.tree.settled = Settled::Heap(vec![0; layout.slots()]);
        search.with_heap();
    }
    search.tree
}

impl<N: Net> Tree<N> {
    pub(crate) fn source(&self) -> Cell {
        self.source
    }

    pub(crate) fn net(&self) -> &N {
        &self.net
    }

    pub(crate) fn into_net(self) -> N {
        self.net
    }

    /// The label of a cell; none if it was not reached or is not on the grid.
    pub(crate) fn label(&self, ground: &Traversability, cell: Cell) -> Option<f64> {
        let at = ground.spec().contains(cell).then(|| self.net.layout().slot(cell))?;
        let label = self.net.label(at);
        (label >= 0.0 && self.is_settled(at)).then_some(label)
    }

    /// The steps of the route to a cell, first to last; none if it was not reached or is not on the grid.
    pub(crate) fn steps(&self, ground: &Traversability, cell: Cell) -> Option<Vec<u8>> {
        self.label(ground, cell)?;
        let layout = self.net.layout();
        let (start, mut at) = (self.start(), layout.slot(cell));
        let mut steps = Vec::new();
        while at != start {
            let back = self.step_back(at);
            steps.push(7 - back as u8);
            at = at.wrapping_add_signed(layout.offset()[back]);
        }
        steps.reverse();
        Some(steps)
    }

    /// Calls for each row of the map, first to last, with what the search looked at in it: cells settled or
    /// offered a label.
    pub(crate) fn looked_at(&self, mut row: impl FnMut(usize, &mut dyn Iterator<Item = bool>)) {
        let layout = self.net.layout();
        for r in 0..layout.rows {
            let first = r * layout.stride;
            row(r, &mut (first..first + layout.cols).map(|at| self.net.label(at) < f64::INFINITY));
        }
    }

    fn start(&self) -> usize {
        self.net.layout().slot(self.source)
    }

    /// The states of a search by the heap.
    fn states(&mut self) -> &mut [u8] {
        match &mut self.settled {
            Settled::Heap(states) => states,
            Settled::Ring { .. } => &mut [],
        }
    }

    fn is_settled(&self, at: usize) -> bool {
        let label = self.net.label(at);
        match &self.settled {
            Settled::Ring { per_width, last } => {
                label < f64::INFINITY && label * per_width + WHOLE <= *last
            }
            Settled::Heap(states) => states[at] & SETTLED != 0,
        }
    }

    /// The step back to the parent of a cell that has one and whose label is final.
    ///
    /// The ring keeps no parents: they are the neighbours whose label and step make up the cell's own label, to the
    /// last bit, and of these the smallest cell. A neighbour whose label is not final cannot be one of them, since
    /// a final label is smaller than the cell's own by more than a bucket.
    fn step_back(&self, at: usize) -> usize {
        if let Settled::Heap(states) = &self.settled {
            return usize::from(states[at] & STEP_BACK);
        }
        let (net, layout) = (&self.net, self.net.layout());
        let label = net.label(at);
        let leads_here = |&back: &usize| {
            let from = at.wrapping_add_signed(layout.offset()[back]);
            from < layout.slots()
                && net
                    .step_cost(from, at, 7 - back)
                    .is_some_and(|cost| net.label(from) + cost == label)
        };
        (0..8).find(leads_here).expect("a final label is the sum of a label and a step")
    }
}

/// A search under way.
struct Search<'a, N> {
    ground: &'a Traversability,
    tree: Tree<N>,
    /// Slots of the targets, those settled taken off the end; none if every cell is asked for.
    targets: Option<Vec<usize>>,
    limited: Option<Spending>,
}

impl<N: Net> Search<'_, N> {
    fn with_ring(&mut self, buckets: usize, scratch: &mut Scratch) {
        let Settled::Ring { per_width, .. } = self.tree.settled else { return };
        let Scratch { ring, live } = scratch;
        ring.iter_mut().for_each(Vec::clear);
        if ring.len() < buckets {
            ring.resize_with(buckets, Vec::new);
        }
        let mask = ring.len() - 1;
        let number = |label: f64| label * per_width + WHOLE;
        let place = |number: f64| number.to_bits() as usize & mask;
        ring[0].push(self.tree.start() as u32);
        let (mut now, mut waiting) = (WHOLE, 1);
        // The last bucket whose labels are known to be final; there is none yet.
        let mut last = WHOLE - 1.0;
        while waiting > 0 && !self.has_settled_targets(|label| number(label) <= last) {
            let mut bucket = std::mem::take(&mut ring[place(now)]);
            waiting -= bucket.len();
            // New labels are at least a bucket ahead and less than a turn: this one gets no more of them, and its
            // labels are final. Labels that got smaller since they came here were settled from an earlier bucket.
            // They are sorted out first, without a branch, which fetches the others ahead of their expansion.
            live.resize(live.len().max(bucket.len()), 0);
            let mut count = 0;
            for &at in &bucket {
                live[count] = at;
                count += usize::from(number(self.tree.net.label(at as usize)) == now);
            }
            last = now;
            let live = &live[..count];
            if self.limited.is_some() {
                for &at in live {
                    self.cut_where_over(at as usize);
                }
            }
            if self.has_settled_targets(|label| number(label) <= last) {
                break;
            }
            for &at in live {
                if self.limited.is_some() && self.tree.net.label(at as usize) == CUT {
                    continue;
                }
                self.tree.net.expand(at as usize, |label, to| {
                    ring[place(number(label))].push(to as u32);
                    waiting += 1;
                });
            }
            bucket.clear();
            ring[place(now)] = bucket;
            now += 1.0;
        }
        self.tree.settled = Settled::Ring { per_width, last };
    }

    fn with_heap(&mut self) {
        let is_final = |label: f64| label == CUT;
        // Labels are not negative, so their bits order as they do.
        let mut heap = BinaryHeap::from([Reverse((0_u64, self.tree.start() as u32))]);
        let mut passed = f64::NEG_INFINITY;
        while let Some(Reverse((label, at))) = heap.pop() {
            // Cells of one label may lead to each other by steps too small to add to it: a target is settled for
            // sure only when a larger label comes up.
            let label = f64::from_bits(label);
            if label > passed {
                let before = label;
                if self.has_settled_targets(|label| is_final(label) || label < before) {
                    return;
                }
                passed = label;
            }
            let at = at as usize;
            if self.tree.is_settled(at) {
                continue;
            }
            self.tree.states()[at] |= SETTLED;
            if self.limited.is_some() {
                self.cut_where_over(at);
            }
            if self.tree.net.label(at) != CUT {
                self.expand_onto(&mut heap, at);
            }
        }
    }

    /// Offers a settled cell's label to its neighbours, and notes whose parent it becomes.
    fn expand_onto(&mut self, heap: &mut BinaryHeap<Reverse<(u64, u32)>>, at: usize) {
        let (label, layout) = (self.tree.net.label(at), *self.tree.net.layout());
        for step in 0..8 {
            let to = at.wrapping_add_signed(layout.offset()[step]);
            if to >= layout.slots() {
                continue;
            }
            let Some(cost) = self.tree.net.step_cost(at, to, step) else { continue };
            let (offer, back) = (label + cost, 7 - step as u8);
            let found = self.tree.net.label(to);
            let state = &mut self.tree.states()[to];
            if offer < found {
                *state = back;
                self.tree.net.set_label(to, offer);
                heap.push(Reverse((offer.to_bits(), to as u32)));
            } else if offer == found && *state & SETTLED == 0 && back < *state & STEP_BACK {
                *state = back;
            }
        }
    }

    /// Whether there are targets and all of them are settled, by a rule on labels.
    fn has_settled_targets(&mut self, is_settled: impl Fn(f64) -> bool) -> bool {
        let Some(targets) = &mut self.targets else { return false };
        while let Some(&target) = targets.last() {
            if !is_settled(self.tree.net.label(target)) {
                return false;
            }
            targets.pop();
        }
        true
    }

    /// Cuts a settled cell whose route exceeds the limits.
    fn cut_where_over(&mut self, at: usize) {
        if let Some(spending) = &mut self.limited
            && self.tree.net.label(at) != CUT
            && !spending.allows(self.ground, &self.tree, at)
        {
            self.tree.net.set_label(at, CUT);
        }
    }
}

/// A bound on what any open step of a map spends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorstStep {
    time_s: f64,
    energy_j: f64,
}

impl WorstStep {
    /// The bound, if there are limits that ask for it.
    pub(crate) fn where_limited(ground: &Traversability, limits: Limits) -> Option<Self> {
        (limits != Limits::NONE).then(|| Self::new(ground))
    }

    /// `Vehicle::drive` over the longest step and the largest rise of the map, at the slip that closes steps.
    fn new(ground: &Traversability) -> Self {
        let vehicle = ground.vehicle();
        let (length_m, rise_m) = (ground.length_m()[0], largest_rise_m(ground));
        let kept = 1.0 - vehicle.slip_max;
        let time_s = libm::hypot(length_m, rise_m) / (vehicle.speed_m_s * kept);
        let force_way = vehicle.rolling_resistance * length_m + rise_m;
        let drive_j =
            vehicle.mass_kg * vehicle.gravity_m_s2 * force_way / (vehicle.drive_efficiency * kept);
        Self { time_s, energy_j: drive_j + vehicle.hotel_power_w * time_s }
    }
}

/// The largest height difference of neighbouring known cells (of the cells of a square of four, at least).
fn largest_rise_m(ground: &Traversability) -> f64 {
    const NONE: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);
    let joined = |a: (f32, f32), b: (f32, f32)| (a.0.min(b.0), a.1.max(b.1));
    let (spec, first) = (ground.spec(), ground.spec().first());
    let mut above = vec![NONE; spec.cols()];
    let mut rise_m: f64 = 0.0;
    for row in 0..spec.rows() {
        let mut west = NONE;
        for (col, above) in above.iter_mut().enumerate() {
            let height = ground.height_m(Cell::new(first.row + row, first.col + col));
            let here = height.map_or(NONE, |z| (z, z));
            let pair = joined(west, here);
            let (low, high) = joined(*above, pair);
            rise_m = rise_m.max(f64::from(high) - f64::from(low));
            (west, *above) = (here, pair);
        }
    }
    rise_m
}

/// Time and energy of routes, worked out where they may exceed the limits.
struct Spending {
    limits: Limits,
    /// No route of a smaller label exceeds the limits.
    sure: f64,
    /// Time and energy of the routes looked into; not a number elsewhere. Empty until the first.
    spent: Vec<(f64, f64)>,
    /// Cells of a route yet to be looked into, with the steps to them, last to first.
    ahead: Vec<(usize, usize)>,
}

impl Spending {
    /// Room for the rounding of sums over as many steps as a map may have cells.
    const ROUNDING: f64 = 1e-6;

    fn new(limits: Limits, worst: WorstStep, cheapest_step: f64) -> Self {
        // A label of n steps is at least n of the cheapest ones, and the route spends at most n of the worst.
        let steps = (limits.max_time_s / worst.time_s).min(limits.max_energy_j / worst.energy_j);
        let sure = (1.0 - Self::ROUNDING) * cheapest_step * steps;
        Self { limits, sure, spent: Vec::new(), ahead: Vec::new() }
    }

    /// Whether the route to a settled cell keeps the limits.
    fn allows<N: Net>(&mut self, ground: &Traversability, tree: &Tree<N>, at: usize) -> bool {
        if tree.net.label(at) <= self.sure {
            return true;
        }
        let layout = tree.net.layout();
        if self.spent.is_empty() {
            self.spent = vec![(f64::NAN, f64::NAN); layout.slots()];
            self.spent[tree.start()] = (0.0, 0.0);
        }
        let mut here = at;
        while self.spent[here].0.is_nan() {
            let back = tree.step_back(here);
            self.ahead.push((here, 7 - back));
            here = here.wrapping_add_signed(layout.offset()[back]);
        }
        while let Some((to, step)) = self.ahead.pop() {
            let edge = ground.open_edge(layout.index(here), layout.index(to), step);
            let (time_s, energy_j) = self.spent[here];
            self.spent[to] = (time_s + edge.time_s, energy_j + edge.energy_j);
            here = to;
        }
        let (time_s, energy_j) = self.spent[at];
        self.limits.allow(time_s, energy_j)
    }
}
