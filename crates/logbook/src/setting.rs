//! What the records of one run have in common: its ground and its words.

use wisdom_autonomy::Spec;
use wisdom_goals::FactSet;
use wisdom_grid::{GridSpec, Raster};

/// The ground and the words of a run, so that records can say names where the core has numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The mission's grid.
    pub grid: GridSpec,
    /// Names of the facts, in the order of their bits.
    pub facts: Vec<String>,
    /// Names of the operators.
    pub operators: Vec<String>,
    /// Names of the directives.
    pub directives: Vec<String>,
    /// What each directive looks for.
    pub kinds: Vec<String>,
}

impl From<&Spec> for Setting {
    fn from(spec: &Spec) -> Self {
        Self {
            grid: spec.grid,
            facts: spec.domain.facts().to_vec(),
            operators: spec.domain.operators().iter().map(|o| o.name.clone()).collect(),
            directives: spec.directives.iter().map(|d| d.name.clone()).collect(),
            kinds: spec.directives.iter().map(|d| d.kind.to_string()).collect(),
        }
    }
}

impl Setting {
    /// The names of the facts in a set, in the order of their bits.
    pub(crate) fn facts(&self, set: FactSet) -> Vec<String> {
        (0..u64::BITS as usize)
            .filter(|bit| set.bits() >> bit & 1 == 1)
            .map(|bit| name(&self.facts, bit))
            .collect()
    }

    pub(crate) fn operators(&self, indices: &[usize]) -> Vec<String> {
        indices.iter().map(|&index| name(&self.operators, index)).collect()
    }

    pub(crate) fn directive(&self, index: usize) -> String {
        name(&self.directives, index)
    }

    pub(crate) fn kind(&self, directive: usize) -> String {
        name(&self.kinds, directive)
    }
}

/// A name, or `#index` where the setting has none.
fn name(names: &[String], index: usize) -> String {
    names.get(index).cloned().unwrap_or_else(|| format!("#{index}"))
}

/// The maps that go into the log with a decision. All lie on the run's grid, or on one part of it.
#[derive(Debug, Clone, Copy)]
pub struct DecisionMaps<'a> {
    /// The interest that the goals were drawn from, in [0, 1]: `/map/interest`.
    pub interest: &'a Raster<f32>,
    /// Further planes, each logged as `/map/` and its name (ignorance, elevation, ..).
    pub others: &'a [(&'a str, &'a Raster<f32>)],
    /// The ground to drape the interest over: `/terrain/interest`. Without it no cloud of points is logged.
    pub drape: Option<Drape<'a>>,
}

/// The ground under an interest map, cell by cell of the same grid.
#[derive(Debug, Clone, Copy)]
pub struct Drape<'a> {
    /// Elevation, metres; 0 where it is not known.
    pub elevation: &'a Raster<f32>,
    /// Its uncertainty, in [0, 1]; 1 where it is not known, and no point is drawn there.
    pub uncertainty: &'a Raster<f32>,
}
