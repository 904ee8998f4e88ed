//! All ways from one cell to another that no other is better than in everything.

use std::cmp::Ordering;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use wisdom_grid::Cell;

use crate::traversability::offsets;
use crate::{CostVector, Limits, Route, Traversability};

/// How far a [`front()`] is worked out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontOptions {
    /// What a drive may spend.
    pub limits: Limits,
    /// Labels to close at most; the front is not complete when they do not suffice. A label takes about 100 bytes
    /// while the search lasts.
    pub max_labels: u64,
    /// How much longer or costlier than a route left out its stand-in may be, as a share in [0, 1]; see [`front()`].
    pub precision: f64,
}

impl Default for FrontOptions {
    /// No limits, two million labels, and a millionth: no cost of a drive is known that well, and routes that
    /// differ only by rounding are one.
    fn default() -> Self {
        Self { limits: Limits::NONE, max_labels: 2_000_000, precision: 1e-6 }
    }
}

/// Routes between two cells, none better than another in time, energy and −ln R at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// The routes, most reliable first, then the quickest, then the one that draws least.
    pub routes: Vec<Route>,
    /// Whether these are all (up to the precision asked for). If not, the labels ran out; the routes found are
    /// the most reliable ones of the whole front.
    pub complete: bool,
    /// Labels closed.
    pub labels: u64,
}

/// Finds the routes from one cell to another within the limits that no other route matches or beats in time, energy
/// and −ln R at once; of routes with equal costs, one.
///
/// The search is NAMOA* (Mandow and Pérez de la Cruz 2010) with exact lower bounds: a search backwards from the
/// target for each of the three costs alone. Labels are taken in the order of −ln R first, so that dominance is a
/// matter of the two other costs (Pulido, Mandow and Pérez de la Cruz 2015), and checked when their turn comes
/// (Hernández et al. 2023). The number of labels can grow exponentially with the map; that is what the cap is for.
///
/// **Precision** `p` = 0: every route whose costs, summed first edge to last, are matched or beaten by no other's has
/// its costs in the front, to the last bit. With `p` > 0 a route may be left out if another of the front, no less
/// reliable, takes at most (1 + p) times its time and its energy; where there are limits, this is promised of routes
/// that take at most 1/(1 + p) of them. Without limits the first route has the −ln R of [`field()`](crate::field()),
/// whatever the precision.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_planner::{FrontOptions, Traversability, Vehicle, front};
/// use wisdom_terrain::Layer;
///
/// // A ridge ahead: over it is short, around it is flat.
/// let spec = GridSpec::new(9, 9, 1.0)?;
/// let ridge = |c: Cell| if c.col == 4 && c.row < 7 { 0.25 } else { 0.0 };
/// let heights = Layer::certain(Raster::from_fn(spec, ridge))?;
/// let ground = Traversability::new(&Vehicle::default(), &heights)?;
/// let front = front(&ground, Cell::new(3, 0), Cell::new(3, 8), &FrontOptions::default());
/// assert!(front.complete && front.routes.len() > 1);
/// let (first, last) = (&front.routes[0], &front.routes[front.routes.len() - 1]);
/// assert!(first.cost.neg_ln_r < last.cost.neg_ln_r && first.cost.time_s > last.cost.time_s);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If a cell is not on the grid, the grid has more than some 4·10⁹ cells, or the precision is not in [0, 1].
#[must_use]
pub fn front(ground: &Traversability, from: Cell, to: Cell, options: &FrontOptions) -> Front {
    let spec = ground.spec();
    assert!(spec.contains(from), "source {from} on {spec:?}");
    assert!(spec.contains(to), "target {to} on {spec:?}");
    assert!(u32::try_from(spec.len()).is_ok(), "a search over {spec:?}");
    let precision = options.precision;
    assert!((0.0..=1.0).contains(&precision), "precision {precision}; it must be in [0, 1]");
    Search::new(ground, spec.index(from), spec.index(to), options).run()
}

/// −ln R, time in seconds and energy in joules, in the order in which labels are compared.
type Costs = [f64; 3];

fn costs(edge: CostVector) -> Costs {
    [edge.neg_ln_r, edge.time_s, edge.energy_j]
}

fn sum(a: Costs, b: Costs) -> Costs {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Share of the exact lower bounds that the search uses: what is taken off is more than rounding adds, so that sums
/// grow along every edge and labels of a cell come in their order.
const BOUND_SHARE: f64 = 1.0 - 1e-6;

/// No label is the parent of the first.
const NONE: u32 = u32::MAX;

/// A label that waits for its turn.
#[derive(Clone, Copy)]
struct Label {
    /// Least −ln R of a route through it.
    least: f64,
    /// Its own costs.
    costs: Costs,
    /// The cell's index.
    at: u32,
    /// The closed label it came from.
    parent: u32,
}

impl Ord for Label {
    fn cmp(&self, other: &Self) -> Ordering {
        let by = |a: f64, b: f64| a.total_cmp(&b);
        by(self.least, other.least)
            .then_with(|| by(self.costs[0], other.costs[0]))
            .then_with(|| by(self.costs[1], other.costs[1]))
            .then_with(|| by(self.costs[2], other.costs[2]))
            .then_with(|| (self.at, self.parent).cmp(&(other.at, other.parent)))
    }
}

impl PartialOrd for Label {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Label {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Label {}

/// Pairs (time, energy) of which none is better than another: times rise, energies fall.
#[derive(Clone, Default)]
struct Staircase(Vec<(f64, f64)>);

impl Staircase {
    /// Whether a pair takes no more time and no more energy than these.
    fn covers(&self, time_s: f64, energy_j: f64) -> bool {
        let before = self.0.partition_point(|&(time, _)| time <= time_s);
        before > 0 && self.0[before - 1].1 <= energy_j
    }

    /// Adds a pair that is not covered.
    fn add(&mut self, time_s: f64, energy_j: f64) {
        let from = self.0.partition_point(|&(time, _)| time < time_s);
        let covered = self.0[from..].partition_point(|&(_, energy)| energy >= energy_j);
        self.0.splice(from..from + covered, [(time_s, energy_j)]);
    }
}

/// Which of these costs no other matches or beats in time, energy and −ln R at once (length does not count): their
/// indices, most reliable first, then the quickest, then the one that draws least. Of equal costs the first stays.
///
/// ```
/// use wisdom_planner::{CostVector, non_dominated};
///
/// let cost = |time_s, neg_ln_r| CostVector { time_s, neg_ln_r, ..CostVector::ZERO };
/// assert_eq!(non_dominated(&[cost(9.0, 0.1), cost(5.0, 0.2), cost(5.0, 0.3)]), [0, 1]);
/// ```
#[must_use]
pub fn non_dominated(of: &[CostVector]) -> Vec<usize> {
    let by = |a: &usize, b: &usize| {
        let (a, b) = (costs(of[*a]), costs(of[*b]));
        (0..3).map(|k| a[k].total_cmp(&b[k])).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    let mut indices: Vec<usize> = (0..of.len()).collect();
    indices.sort_by(by);
    let mut known = Staircase::default();
    indices.retain(|&index| {
        let CostVector { time_s, energy_j, .. } = of[index];
        let kept = !known.covers(time_s, energy_j);
        if kept {
            known.add(time_s, energy_j);
        }
        kept
    });
    indices
}

/// A search under way.
struct Search<'a> {
    ground: &'a Traversability,
    from: usize,
    to: usize,
    limits: Limits,
    max_labels: u64,
    /// Factors on time and energy of a label when it is held against those of its cell, and of the target.
    slack: [f64; 2],
    offset: [isize; 8],
    /// Costs of the step `k` from cell `i` at 8·i + k.
    edges: Vec<Costs>,
    /// The least that each cost can be from a cell to the target; infinite where there is no way.
    bounds: Vec<Costs>,
    /// Cells and parents of the closed labels.
    closed: Vec<(u32, u32)>,
    open: BinaryHeap<Reverse<Label>>,
}

impl<'a> Search<'a> {
    fn new(ground: &'a Traversability, from: usize, to: usize, options: &FrontOptions) -> Self {
        let cells = ground.spec().len();
        let offset = offsets(ground.spec().cols());
        let mut edges = vec![[0.0; 3]; 8 * cells];
        for (at, open) in ground.open().iter().enumerate() {
            for step in (0..8).filter(|step| open & (1 << step) != 0) {
                let next = at.wrapping_add_signed(offset[step]);
                edges[8 * at + step] = costs(ground.open_edge(at, next, step));
            }
        }
        let [hazard, time, energy] = [0, 1, 2].map(|k| backwards(ground, to, &edges, k));
        let bounds = (0..cells).map(|i| [hazard[i], time[i], energy[i]]).collect();
        // A route meets each cell once and its stand-in may be replaced in turn at each; a third of the precision is
        // for all of these together and one for the target: (1 + p/3n)ⁿ·(1 + p/3) ≤ 1 + p for p ≤ 1.
        let third = options.precision / 3.0;
        Self {
            ground,
            from,
            to,
            limits: options.limits,
            max_labels: options.max_labels,
            slack: [third / cells as f64, third],
            offset,
            edges,
            bounds,
            closed: Vec::new(),
            open: BinaryHeap::new(),
        }
    }

    fn run(mut self) -> Front {
        let mut known = vec![Staircase::default(); self.ground.spec().len()];
        let mut ends = Vec::new();
        let mut complete = true;
        self.push([0.0; 3], self.from, NONE, &known);
        while let Some(Reverse(label)) = self.open.pop() {
            let at = label.at as usize;
            if self.superseded(&label.costs, at, &known) {
                continue;
            }
            if self.closed.len() as u64 >= self.max_labels.min(u64::from(NONE)) {
                complete = false;
                break;
            }
            let closed = self.closed.len() as u32;
            self.closed.push((label.at, label.parent));
            known[at].add(label.costs[1], label.costs[2]);
            if at == self.to {
                ends.push(closed);
                continue;
            }
            for step in 0..8 {
                if self.ground.open()[at] & (1 << step) != 0 {
                    let next = at.wrapping_add_signed(self.offset[step]);
                    let costs = sum(label.costs, self.edges[8 * at + step]);
                    self.push(costs, next, closed, &known);
                }
            }
        }
        let routes = ends.into_iter().map(|end| self.route(end)).collect();
        Front { routes, complete, labels: self.closed.len() as u64 }
    }

    /// The least that a route through a label can cost.
    fn least(&self, costs: &Costs, at: usize) -> Costs {
        let bound = &self.bounds[at];
        [0, 1, 2].map(|k| costs[k] + BOUND_SHARE * bound[k])
    }

    /// Whether routes closed before, and therefore no less reliable, take no more time and energy than a label at its
    /// cell, or at the target.
    fn superseded(&self, costs: &Costs, at: usize, known: &[Staircase]) -> bool {
        let [_, time_s, energy_j] = self.least(costs, at);
        let [here, there] = self.slack;
        known[at].covers(costs[1] + here * time_s, costs[2] + here * energy_j)
            || known[self.to].covers(time_s + there * time_s, energy_j + there * energy_j)
    }

    fn push(&mut self, costs: Costs, at: usize, parent: u32, known: &[Staircase]) {
        let [least, time_s, energy_j] = self.least(&costs, at);
        let allowed = least.is_finite()
            && time_s <= self.limits.max_time_s
            && energy_j <= self.limits.max_energy_j;
        if allowed && !self.superseded(&costs, at, known) {
            self.open.push(Reverse(Label { least, costs, at: at as u32, parent }));
        }
    }

    fn route(&self, end: u32) -> Route {
        let spec = self.ground.spec();
        let (mut cells, mut label) = (Vec::new(), end);
        while label != NONE {
            let (at, parent) = self.closed[label as usize];
            cells.push(spec.cell(at as usize));
            label = parent;
        }
        cells.reverse();
        let edge = |pair: &[Cell]| self.ground.edge(pair[0], pair[1]).expect("the step was open");
        let cost = cells.windows(2).map(edge).sum();
        Route { cells, cost }
    }
}

/// The least that one cost can be from every cell to the target (Dijkstra 1959, against the steps).
fn backwards(ground: &Traversability, to: usize, edges: &[Costs], which: usize) -> Vec<f64> {
    let spec = ground.spec();
    let mut least = vec![f64::INFINITY; spec.len()];
    least[to] = 0.0;
    // Costs are not negative, so their bits order as they do.
    let mut open = BinaryHeap::from([Reverse((0_u64, to as u32))]);
    while let Some(Reverse((bits, at))) = open.pop() {
        let (at, here) = (at as usize, f64::from_bits(bits));
        if here > least[at] {
            continue;
        }
        let cell = spec.cell(at);
        for (step, &(row, col)) in crate::traversability::STEPS.iter().enumerate() {
            let Some(before) = spec.step(cell, -row, -col).map(|cell| spec.index(cell)) else {
                continue;
            };
            if ground.open()[before] & (1 << step) == 0 {
                continue;
            }
            let offer = here + edges[8 * before + step][which];
            if offer < least[before] {
                least[before] = offer;
                open.push(Reverse((offer.to_bits(), before as u32)));
            }
        }
    }
    least
}
