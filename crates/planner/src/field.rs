//! The most reliable way from one cell to all others.

mod hazard;
mod search;
mod weighed;

use wisdom_grid::Cell;

use crate::traversability::offsets;
use crate::{CostVector, Route, Traversability};

use hazard::HazardNet;
pub(crate) use hazard::Node;
pub(crate) use search::{Scratch, Tree, WorstStep};
pub use weighed::{WeighedField, WeighedGround, Weights};

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

/// Finds the most reliable route (smallest −ln R) from `source` to every cell, or to the targets.
///
/// The search is label-setting (Dijkstra 1959) and exact: a label is the smallest of the sums, first edge to
/// last, over all routes. The queue is a ring of buckets no wider than the smallest edge (Dial 1969), or a
/// binary heap where hazards differ too much for that; the result is the same. Of equally reliable routes the one
/// through the smaller [`Cell`] is kept, so the routes depend on neither queue nor order. The field keeps 16 bytes a
/// cell.
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
    let worst = WorstStep::where_limited(ground, options.limits);
    field_in(&mut Scratch::default(), Vec::new(), ground, source, options, worst)
}

/// [`field()`] in memory that was used before.
pub(crate) fn field_in<'a>(
    scratch: &mut Scratch,
    nodes: Vec<Node>,
    ground: &'a Traversability,
    source: Cell,
    options: &FieldOptions<'_>,
    worst: Option<WorstStep>,
) -> Field<'a> {
    let net = HazardNet::new(ground, nodes);
    let tree = search::search(ground, net, source, options, worst, scratch);
    Field { ground, tree }
}

/// The most reliable routes from one cell, over the ground they were found on.
#[derive(Debug, Clone)]
pub struct Field<'a> {
    ground: &'a Traversability,
    tree: Tree<HazardNet>,
}

impl Field<'_> {
    /// The cell the routes start from.
    #[must_use]
    pub fn source(&self) -> Cell {
        self.tree.source()
    }

    /// −ln R of the route to a cell; none if it was not reached or is not on the grid.
    #[must_use]
    pub fn neg_ln_r(&self, cell: Cell) -> Option<f64> {
        self.tree.label(self.ground, cell)
    }

    /// The cost of the route to a cell; none if it was not reached. Walks the route.
    #[must_use]
    pub fn cost(&self, cell: Cell) -> Option<CostVector> {
        self.route(cell).map(|route| route.cost)
    }

    /// The route to a cell; none if it was not reached. The source's own route is the source alone.
    #[must_use]
    pub fn route(&self, cell: Cell) -> Option<Route> {
        let steps = self.tree.steps(self.ground, cell)?;
        Some(follow(self.ground, self.source(), &steps))
    }

    pub(crate) fn tree(&self) -> &Tree<HazardNet> {
        &self.tree
    }

    /// Gives the memory back for another field.
    pub(crate) fn into_nodes(self) -> Vec<Node> {
        self.tree.into_net().into_nodes()
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
