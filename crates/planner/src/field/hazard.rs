//! The hazard of a map as the search asks for it: −ln R of each step, and the labels beside it.

use wisdom_grid::Cell;

use super::search::{Layout, Net};
use crate::Traversability;

/// All that the search asks of a cell, side by side: the cells in hand lie scattered along a front that is longer than
/// the nearest caches hold, so what counts is how many places a cell's data lie in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Smallest −ln R found so far.
    label: f64,
    /// Hazard rate λ, per metre.
    hazard: f32,
    /// Steps that may be taken from here, as in `Traversability`.
    open: u8,
}

const OUTSIDE: Node = Node { label: f64::INFINITY, hazard: 0.0, open: 0 };

const ALL_OPEN: u8 = 0xFF;

/// Labels of −ln R over hazard rates: a step costs `length·(λ_from + λ_to)/2`.
#[derive(Debug, Clone)]
pub(crate) struct HazardNet {
    nodes: Vec<Node>,
    layout: Layout,
    half_length_m: [f64; 8],
}

impl HazardNet {
    /// Labels not found yet over a ground, in memory that was used before (or in none).
    pub(super) fn new(ground: &Traversability, mut nodes: Vec<Node>) -> Self {
        let layout = Layout::new(ground.spec());
        let cols = ground.spec().cols();
        nodes.clear();
        nodes.reserve(layout.slots());
        for (hazard, open) in ground.hazard().values().chunks(cols).zip(ground.open().chunks(cols))
        {
            let row = hazard.iter().zip(open);
            nodes.extend(row.map(|(&hazard, &open)| Node { hazard, open, ..OUTSIDE }));
            nodes.extend(std::iter::repeat_n(OUTSIDE, layout.stride() - cols));
        }
        Self { nodes, layout, half_length_m: ground.length_m().map(|length| 0.5 * length) }
    }

    pub(super) fn into_nodes(self) -> Vec<Node> {
        self.nodes
    }

    /// The three nodes of a row from one on.
    #[inline]
    fn three(&self, first: usize) -> &[Node; 3] {
        self.nodes[first..].first_chunk().expect("every step from the middle one is open")
    }
}

impl Net for HazardNet {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    #[inline]
    fn label(&self, at: usize) -> f64 {
        self.nodes[at].label
    }

    #[inline]
    fn set_label(&mut self, at: usize, label: f64) {
        self.nodes[at].label = label;
    }

    #[inline]
    fn step_cost(&self, from: usize, to: usize, step: usize) -> Option<f64> {
        let Node { hazard, open, .. } = self.nodes[from];
        (open & (1 << step) != 0).then(|| {
            self.half_length_m[step] * (f64::from(hazard) + f64::from(self.nodes[to].hazard))
        })
    }

    #[inline]
    fn expand(&mut self, at: usize, mut push: impl FnMut(f64, usize)) {
        let Node { label, hazard, open } = self.nodes[at];
        let here = f64::from(hazard);
        if open == ALL_OPEN {
            // Most cells. All offers are compared before any is taken: which are smaller nobody can foretell, and a
            // wrong guess costs more than a comparison.
            let stride = self.layout.stride();
            let [a, b, c] = self.three(at - stride - 1);
            let [d, _, e] = self.three(at - 1);
            let [f, g, h] = self.three(at + stride - 1);
            let (mut offers, mut smaller) = ([0.0; 8], 0_u32);
            for (k, node) in [a, b, c, d, e, f, g, h].into_iter().enumerate() {
                offers[k] = label + self.half_length_m[k] * (here + f64::from(node.hazard));
                smaller |= u32::from(offers[k] < node.label) << k;
            }
            while smaller != 0 {
                let step = smaller.trailing_zeros() as usize & 7;
                smaller &= smaller - 1;
                let to = at.wrapping_add_signed(self.layout.offset()[step]);
                self.nodes[to].label = offers[step];
                push(offers[step], to);
            }
            return;
        }
        for step in (0..8).filter(|step| open & (1 << step) != 0) {
            let to = at.wrapping_add_signed(self.layout.offset()[step]);
            let node = &mut self.nodes[to];
            let offer = label + self.half_length_m[step] * (here + f64::from(node.hazard));
            if offer < node.label {
                node.label = offer;
                push(offer, to);
            }
        }
    }

    fn cost_range(&self, ground: &Traversability, source: Cell) -> (f64, f64) {
        let here = f64::from(ground.hazard_per_m(source));
        let (low, high) = ground.hazard_range();
        let spacing_m = ground.spec().spacing_m();
        (
            spacing_m * here.min(f64::from(low)),
            std::f64::consts::SQRT_2 * spacing_m * here.max(f64::from(high)),
        )
    }
}
