//! What it costs to drive between poses.

mod cache;

use rayon::prelude::*;
use wisdom_grid::Cell;

use crate::field::{Scratch, WorstStep, field_in, follow};
use crate::{
    CostVector, FieldOptions, Limits, Route, Traversability, WeighedGround, Weights, non_dominated,
};

use cache::CellSet;
pub use cache::TravelCache;

/// Costs and routes between poses, in both directions: climbing costs more than coming down.
///
/// An entry is a list of alternatives, none of them better than another in everything; empty if there is no way. The
/// first is the most reliable; from [`travel_matrix`] it is the only one.
#[derive(Debug, Clone, PartialEq)]
pub struct TravelMatrix {
    nodes: Vec<Cell>,
    entries: Vec<Vec<Entry>>,
}

/// Alternatives of one leg: costs, and the steps driven, a byte each.
#[derive(Debug, Clone, PartialEq, Default)]
struct Entry {
    costs: Vec<CostVector>,
    steps: Vec<Vec<u8>>,
}

/// Which routes a [`TravelMatrix`] holds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TravelOptions<'a> {
    /// What every single leg may spend, as in [`field()`](crate::field()).
    pub limits: Limits,
    /// Weights to sweep for alternatives to the most reliable route; none for that route alone.
    pub weights: &'a [Weights],
}

/// Works out the travel between all pairs of poses, all threads at once; the result does not depend on how many.
///
/// `nodes[0]` is where the rover stands. `limits` bound every single leg, as in [`field()`](crate::field()). A node in
/// a blocked cell is reached from nowhere but itself, though it can be left.
///
/// # Panics
/// If a node is not on the grid.
#[must_use]
pub fn travel_matrix(ground: &Traversability, nodes: &[Cell], limits: Limits) -> TravelMatrix {
    travel_alternatives(ground, nodes, &TravelOptions { limits, weights: &[] })
}

/// [`travel_matrix`] with alternatives: for each pair the most reliable route and the cheapest for each of the
/// weights, less those that another one equals or beats in time, energy and −ln R.
///
/// Sorted by −ln R, then time, then energy; at most one more than there are weights. A sweep finds supported routes
/// only (those that some weights make cheapest), and of these only the ones of the given weights: routes in the
/// hollows of the front, and between two weights, are not found. Without limits, and with all weights positive, no
/// route at all beats an alternative in everything, but for the rounding of sums. With limits a route of the sweep
/// that [`WeighedGround::field`] cuts is missing.
///
/// While it works it keeps 64 bytes a cell for each of the weights.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_planner::{TravelOptions, Traversability, Vehicle, Weights, travel_alternatives};
/// use wisdom_terrain::Layer;
///
/// // A hill between rover and site: straight over it is quickest, around it is safest.
/// let hill = |cell: Cell| {
///     let (x, y) = (cell.col as f32 - 20.0, cell.row as f32 - 20.0);
///     3.0 * (-(x * x + y * y) / 50.0).exp()
/// };
/// let heights = Layer::certain(Raster::from_fn(GridSpec::new(41, 41, 1.0)?, hill))?;
/// let ground = Traversability::new(&Vehicle::default(), &heights)?;
/// let weights = Weights::sweep(&ground, 2);
/// let options = TravelOptions { weights: &weights, ..TravelOptions::default() };
/// let travel = travel_alternatives(&ground, &[Cell::new(20, 2), Cell::new(20, 38)], &options);
/// let ways = travel.alternatives(0, 1);
/// assert!(ways.len() > 1 && ways[1].time_s < ways[0].time_s);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If a node is not on the grid.
#[must_use]
pub fn travel_alternatives(
    ground: &Traversability,
    nodes: &[Cell],
    options: &TravelOptions<'_>,
) -> TravelMatrix {
    let survey = Survey::new(ground, nodes, options);
    let entries = survey.departures(nodes, Survey::entries);
    TravelMatrix { nodes: nodes.to_vec(), entries }
}

/// What all sources of a matrix share.
struct Survey<'a> {
    ground: &'a Traversability,
    weighed: Vec<WeighedGround<'a>>,
    options: FieldOptions<'a>,
    worst: Option<WorstStep>,
}

/// Memory of one thread for one source after another.
#[derive(Default)]
struct Memory {
    scratch: Scratch,
    nodes: Vec<crate::field::Node>,
    labels: Vec<f64>,
}

impl<'a> Survey<'a> {
    fn new(ground: &'a Traversability, nodes: &'a [Cell], options: &TravelOptions<'_>) -> Self {
        Self {
            ground,
            weighed: WeighedGround::all(ground, options.weights),
            options: FieldOptions { targets: Some(nodes), limits: options.limits },
            worst: WorstStep::where_limited(ground, options.limits),
        }
    }

    /// Something for each source, in their order.
    fn departures<T: Send>(
        &self,
        sources: &[Cell],
        of: impl Fn(&Self, Cell, &mut Memory) -> T + Sync,
    ) -> Vec<T> {
        sources
            .par_iter()
            // One at a time: fields differ in size, and there are few of them.
            .with_max_len(1)
            .map_init(Memory::default, |memory, &source| of(self, source, memory))
            .collect()
    }

    fn entries(&self, source: Cell, memory: &mut Memory) -> Vec<Entry> {
        self.leave(source, memory, None)
    }

    /// The entries from a source, and the cells looked at for them.
    fn entries_and_cells(&self, source: Cell, memory: &mut Memory) -> (Vec<Entry>, CellSet) {
        let mut looked_at = CellSet::empty(self.ground.spec());
        let entries = self.leave(source, memory, Some(&mut looked_at));
        (entries, looked_at)
    }

    /// The entries from a source to all targets.
    fn leave(
        &self,
        source: Cell,
        memory: &mut Memory,
        mut looked_at: Option<&mut CellSet>,
    ) -> Vec<Entry> {
        let Self { ground, ref options, worst, .. } = *self;
        let targets = options.targets.unwrap_or_default();
        let mut ways: Vec<Vec<Vec<u8>>> = vec![Vec::new(); targets.len()];

        let nodes = std::mem::take(&mut memory.nodes);
        let field = field_in(&mut memory.scratch, nodes, ground, source, options, worst);
        for (ways, &target) in ways.iter_mut().zip(targets) {
            ways.extend(field.tree().steps(ground, target));
        }
        if let Some(cells) = &mut looked_at {
            field.tree().looked_at(|row, looked| cells.add_row(row, looked));
        }
        memory.nodes = field.into_nodes();

        for weighed in &self.weighed {
            let labels = std::mem::take(&mut memory.labels);
            let field = weighed.field_in(&mut memory.scratch, labels, source, options, worst);
            for (ways, &target) in ways.iter_mut().zip(targets) {
                ways.extend(field.tree().steps(ground, target));
            }
            if let Some(cells) = &mut looked_at {
                field.tree().looked_at(|row, looked| cells.add_row(row, looked));
            }
            memory.labels = field.into_labels();
        }
        ways.into_iter().map(|ways| Entry::of(ground, source, ways)).collect()
    }
}

impl Entry {
    /// The routes that no other one equals or beats, most reliable first; of equals the first stays.
    fn of(ground: &Traversability, source: Cell, ways: Vec<Vec<u8>>) -> Self {
        let costs: Vec<CostVector> =
            ways.iter().map(|steps| follow(ground, source, steps).cost).collect();
        let mut ways: Vec<Option<Vec<u8>>> = ways.into_iter().map(Some).collect();
        let mut entry = Self::default();
        for index in non_dominated(&costs) {
            entry.costs.push(costs[index]);
            entry.steps.extend(ways[index].take());
        }
        entry
    }
}

impl TravelMatrix {
    /// A matrix of costs known from elsewhere, `costs(from, to)` being the alternatives between two poses by their
    /// indices; it has no routes.
    #[must_use]
    pub fn from_costs(
        nodes: &[Cell],
        mut costs: impl FnMut(usize, usize) -> Vec<CostVector>,
    ) -> Self {
        let mut entry = |from, to| Entry { costs: costs(from, to), steps: Vec::new() };
        let entries = (0..nodes.len())
            .map(|from| (0..nodes.len()).map(|to| entry(from, to)).collect())
            .collect();
        Self { nodes: nodes.to_vec(), entries }
    }

    /// Whether some pair of poses has more than one alternative.
    #[must_use]
    pub fn has_alternatives(&self) -> bool {
        self.entries.iter().flatten().any(|entry| entry.costs.len() > 1)
    }

    /// The same poses with the first, most reliable alternative of each pair alone, by costs only: it has no routes.
    #[must_use]
    pub fn most_reliable(&self) -> Self {
        Self::from_costs(&self.nodes, |from, to| {
            self.alternatives(from, to).iter().take(1).copied().collect()
        })
    }

    /// The poses, in the caller's order.
    #[must_use]
    pub fn nodes(&self) -> &[Cell] {
        &self.nodes
    }

    /// Costs of the alternatives from one pose to another, by their indices, most reliable first; empty if there is
    /// no way.
    ///
    /// # Panics
    /// If there is no such pose, as a slice does.
    #[must_use]
    pub fn alternatives(&self, from: usize, to: usize) -> &[CostVector] {
        &self.entries[from][to].costs
    }

    /// The route of an alternative; none if there is no such alternative, or only its costs are known.
    ///
    /// # Panics
    /// If there is no such pose, as a slice does.
    #[must_use]
    pub fn route(&self, from: usize, to: usize, alternative: usize) -> Option<Route> {
        let entry = &self.entries[from][to];
        let (steps, cost) = (entry.steps.get(alternative)?, *entry.costs.get(alternative)?);
        let mut at = self.nodes[from];
        let cells = std::iter::once(at).chain(steps.iter().map(|&step| {
            at = stepped(at, step);
            at
        }));
        Some(Route { cells: cells.collect(), cost })
    }
}

fn stepped(cell: Cell, step: u8) -> Cell {
    let (row, col) = crate::traversability::STEPS[usize::from(step)];
    Cell::new(cell.row.wrapping_add_signed(row), cell.col.wrapping_add_signed(col))
}
