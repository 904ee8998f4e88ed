//! Fields of a weighed cost: −ln R, seconds and joules in one sum.

use rayon::prelude::*;
use wisdom_grid::Cell;

use super::search::{self, Layout, Net, Scratch, Tree, WorstStep};
use super::{FieldOptions, follow};
use crate::traversability::offsets;
use crate::{CostVector, Route, Traversability};

/// What −ln R, a second and a joule weigh in one cost.
///
/// ```
/// use wisdom_planner::{CostVector, Weights};
///
/// let weights = Weights::new(1000.0, 1.0, 0.0).expect("weights are not negative");
/// let drive = CostVector { length_m: 3.0, time_s: 75.0, energy_j: 9e3, neg_ln_r: 0.01 };
/// assert_eq!(weights.of(drive), 85.0);
/// assert_eq!(Weights::new(0.0, 0.0, 0.0), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    neg_ln_r: f64,
    per_s: f64,
    per_j: f64,
}

impl Weights {
    /// The weights of −ln R, of a second and of a joule; none unless each lies in [0, 1e30] and one is positive.
    #[must_use]
    pub fn new(neg_ln_r: f64, per_s: f64, per_j: f64) -> Option<Self> {
        let all = [neg_ln_r, per_s, per_j];
        let sound = all.iter().all(|weight| (0.0..=1e30).contains(weight));
        (sound && all.iter().any(|&weight| weight > 0.0)).then_some(Self { neg_ln_r, per_s, per_j })
    }

    /// The weighed cost of a drive: its −ln R, seconds and joules times their weights, summed in this order.
    #[must_use]
    pub fn of(self, cost: CostVector) -> f64 {
        self.neg_ln_r * cost.neg_ln_r + self.per_s * cost.time_s + self.per_j * cost.energy_j
    }

    /// A sweep of `count` weights that lead away from the most reliable routes, towards quick ones (the first, third,
    /// ...) and frugal ones (the second, fourth, ...).
    ///
    /// Weights mean something relative to a scale: one unit of each cost is what a metre of flat ground at the
    /// map's lowest hazard costs. The share of time or energy is 31/32 first, then 1/2, 1/4, 3/4, 1/8, ... (van
    /// der Corput 1935), so that a longer sweep contains the shorter ones; the third cost has 1/64 and −ln R the
    /// rest. All three being positive, the routes found are not dominated by any other (Geoffrion 1968).
    #[must_use]
    pub fn sweep(ground: &Traversability, count: usize) -> Vec<Self> {
        const TRACE: f64 = 1.0 / 64.0;
        let (hazard, _) = ground.hazard_range();
        let (time_s, energy_j) = ground.vehicle().drive(1.0, 0.0).unwrap_or((1.0, 1.0));
        // A unit that is no number (nothing can be entered; driving draws no energy) scales nothing.
        let per = |unit: f64| if unit > 0.0 && unit.is_finite() { 1.0 / unit } else { 1.0 };
        let share = |index: usize| match index {
            0 => 1.0 - 2.0 * TRACE,
            _ => (1.0 - 2.0 * TRACE) * van_der_corput(index),
        };
        (0..count)
            .map(|index| {
                let main = share(index / 2);
                let (time, energy) = if index % 2 == 0 { (main, TRACE) } else { (TRACE, main) };
                Self {
                    neg_ln_r: (1.0 - main - TRACE) * per(f64::from(hazard)),
                    per_s: time * per(time_s),
                    per_j: energy * per(energy_j),
                }
            })
            .collect()
    }
}

/// The digits of a number in base 2, mirrored at the point: 1/2, 1/4, 3/4, 1/8, ...
fn van_der_corput(index: usize) -> f64 {
    let (mut left, mut digit, mut value) = (index, 0.5, 0.0);
    while left > 0 {
        value += digit * (left & 1) as f64;
        left >>= 1;
        digit *= 0.5;
    }
    value
}

/// Weighed costs of the steps from a cell; infinite where closed. One cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Steps([f64; 8]);

const CLOSED: Steps = Steps([f64::INFINITY; 8]);

/// Ground with the weighed cost of every step worked out once, for any number of fields.
///
/// It keeps 64 bytes a cell (17 MB for 512² cells), and each field of it 8 more.
#[derive(Debug, Clone)]
pub struct WeighedGround<'a> {
    ground: &'a Traversability,
    weights: Weights,
    layout: Layout,
    steps: Vec<Steps>,
    /// Smallest and largest cost of an open step.
    cost_range: (f64, f64),
}

impl<'a> WeighedGround<'a> {
    /// Works out the weighed cost of every open step, all threads at once.
    #[must_use]
    pub fn new(ground: &'a Traversability, weights: Weights) -> Self {
        Self::all(ground, &[weights]).swap_remove(0)
    }

    /// One for each of the weights; time and energy of a step are worked out once for all of them.
    #[must_use]
    pub fn all(ground: &'a Traversability, weights: &[Weights]) -> Vec<Self> {
        let spec = ground.spec();
        let layout = Layout::new(spec);
        let mut tables = vec![vec![CLOSED; layout.slots()]; weights.len()];
        let mut by_row: Vec<Vec<&mut [Steps]>> = (0..spec.rows()).map(|_| Vec::new()).collect();
        for table in &mut tables {
            for (rows, row) in by_row.iter_mut().zip(table.chunks_mut(layout.stride())) {
                rows.push(row);
            }
        }
        let offset = offsets(spec.cols());
        let fill = |(row, mut tables): (usize, Vec<&mut [Steps]>)| {
            let mut ranges = vec![(f64::INFINITY, 0.0_f64); weights.len()];
            for col in 0..spec.cols() {
                let at = row * spec.cols() + col;
                for step in (0..8).filter(|step| ground.open()[at] & (1 << step) != 0) {
                    let edge = ground.open_edge(at, at.wrapping_add_signed(offset[step]), step);
                    for ((weights, table), range) in
                        weights.iter().zip(&mut tables).zip(&mut ranges)
                    {
                        let cost = weights.of(edge);
                        table[col].0[step] = cost;
                        *range = (range.0.min(cost), range.1.max(cost));
                    }
                }
            }
            ranges
        };
        let ranges: Vec<Vec<(f64, f64)>> = by_row.into_par_iter().enumerate().map(fill).collect();
        let of_all = |k: usize| {
            ranges.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), row| {
                (low.min(row[k].0), high.max(row[k].1))
            })
        };
        weights
            .iter()
            .zip(tables)
            .enumerate()
            .map(|(k, (&weights, steps))| Self {
                ground,
                weights,
                layout,
                steps,
                cost_range: of_all(k),
            })
            .collect()
    }

    /// What the costs weigh.
    #[must_use]
    pub fn weights(&self) -> Weights {
        self.weights
    }

    /// Finds the routes of least weighed cost from a cell to all others, or to the targets.
    ///
    /// Exact: the label of a cell is the smallest of the sums of [`Weights::of`] over the steps, first to last, over
    /// all routes, in the direction of travel. Ties and limits are as in [`field()`](crate::field()), with the weighed
    /// cost in the place of −ln R.
    ///
    /// # Panics
    /// If the source or a target is not on the grid.
    #[must_use]
    pub fn field(&self, source: Cell, options: &FieldOptions<'_>) -> WeighedField<'_> {
        let worst = WorstStep::where_limited(self.ground, options.limits);
        self.field_in(&mut Scratch::default(), Vec::new(), source, options, worst)
    }

    /// [`WeighedGround::field`] in memory that was used before.
    pub(crate) fn field_in(
        &self,
        scratch: &mut Scratch,
        mut labels: Vec<f64>,
        source: Cell,
        options: &FieldOptions<'_>,
        worst: Option<WorstStep>,
    ) -> WeighedField<'_> {
        labels.clear();
        labels.resize(self.layout.slots(), f64::INFINITY);
        let net = WeighedNet { map: self, labels };
        let tree = search::search(self.ground, net, source, options, worst, scratch);
        WeighedField { tree }
    }
}

/// Labels over weighed ground.
#[derive(Debug, Clone)]
pub(crate) struct WeighedNet<'a> {
    map: &'a WeighedGround<'a>,
    labels: Vec<f64>,
}

impl WeighedNet<'_> {
    /// The labels of a row from a slot on.
    #[inline]
    fn three(&self, first: usize) -> [f64; 3] {
        *self.labels[first..].first_chunk().expect("the slots before and after a row away exist")
    }
}

/// The steps, as bits, whose offers are smaller than the labels they lead to.
#[inline]
fn smaller_offers(base: f64, costs: &[f64; 8], labels: [f64; 8]) -> u32 {
    let mut smaller = 0;
    for (step, (cost, label)) in costs.iter().zip(labels).enumerate() {
        smaller |= u32::from(base + cost < label) << step;
    }
    smaller
}

impl Net for WeighedNet<'_> {
    fn layout(&self) -> &Layout {
        &self.map.layout
    }

    #[inline]
    fn label(&self, at: usize) -> f64 {
        self.labels[at]
    }

    #[inline]
    fn set_label(&mut self, at: usize, label: f64) {
        self.labels[at] = label;
    }

    #[inline]
    fn step_cost(&self, from: usize, _: usize, step: usize) -> Option<f64> {
        let cost = self.map.steps[from].0[step];
        (cost < f64::INFINITY).then_some(cost)
    }

    #[inline]
    fn expand(&mut self, at: usize, mut push: impl FnMut(f64, usize)) {
        let (base, costs) = (self.labels[at], &self.map.steps[at].0);
        let layout = &self.map.layout;
        let (offset, stride) = (layout.offset(), layout.stride());
        // All offers are compared before any is taken, as over hazard rates.
        let smaller = if at > stride && at + stride + 1 < self.labels.len() {
            let [a, b, c] = self.three(at - stride - 1);
            let [d, _, e] = self.three(at - 1);
            let [f, g, h] = self.three(at + stride - 1);
            smaller_offers(base, costs, [a, b, c, d, e, f, g, h])
        } else {
            // A step that would leave the arrays is closed, and its offer infinite.
            let label = |offset| self.labels.get(at.wrapping_add_signed(offset));
            let around = offset.map(|offset| label(offset).copied().unwrap_or(f64::INFINITY));
            smaller_offers(base, costs, around)
        };
        let mut left = smaller;
        while left != 0 {
            let step = left.trailing_zeros() as usize & 7;
            left &= left - 1;
            let (offer, to) = (base + costs[step], at.wrapping_add_signed(offset[step]));
            self.labels[to] = offer;
            push(offer, to);
        }
    }

    fn cost_range(&self, _: &Traversability, _: Cell) -> (f64, f64) {
        self.map.cost_range
    }
}

/// The routes of least weighed cost from one cell.
#[derive(Debug, Clone)]
pub struct WeighedField<'a> {
    tree: Tree<WeighedNet<'a>>,
}

impl WeighedField<'_> {
    /// The cell the routes start from.
    #[must_use]
    pub fn source(&self) -> Cell {
        self.tree.source()
    }

    /// The weighed cost of the route to a cell; none if it was not reached or is not on the grid.
    #[must_use]
    pub fn weighed(&self, cell: Cell) -> Option<f64> {
        self.tree.label(self.ground(), cell)
    }

    /// What the route to a cell costs; none if it was not reached. Walks the route.
    #[must_use]
    pub fn cost(&self, cell: Cell) -> Option<CostVector> {
        self.route(cell).map(|route| route.cost)
    }

    /// The route to a cell; none if it was not reached. The source's own route is the source alone.
    #[must_use]
    pub fn route(&self, cell: Cell) -> Option<Route> {
        let steps = self.tree.steps(self.ground(), cell)?;
        Some(follow(self.ground(), self.source(), &steps))
    }

    pub(crate) fn tree(&self) -> &Tree<WeighedNet<'_>> {
        &self.tree
    }

    /// Gives the memory back for another field.
    pub(crate) fn into_labels(self) -> Vec<f64> {
        self.tree.into_net().labels
    }

    fn ground(&self) -> &Traversability {
        self.tree.net().map.ground
    }
}
