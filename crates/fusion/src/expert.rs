//! Experts: each reads one layer by one table.

use std::collections::BTreeMap;

use wisdom_belief::{InterestMass, Uncertainty};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::Layer;

use crate::{FusionError, LookupTable};

/// An instrument seen as a scientist: a layer and the table by which to judge it (paper section III.B).
#[derive(Debug, Clone, PartialEq)]
pub struct Expert {
    /// The expert's name, by which it gets its credit.
    pub name: String,
    /// The name of the layer it reads.
    pub layer: String,
    /// What it says of each reading.
    pub table: LookupTable,
}

/// What each expert says of each cell: discounted mass functions, before fusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    spec: GridSpec,
    experts: Vec<(String, Raster<InterestMass>)>,
}

impl Evidence {
    /// Where the evidence lies.
    #[must_use]
    pub fn spec(&self) -> GridSpec {
        self.spec
    }

    /// Number of experts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.experts.len()
    }

    /// Never true: somebody judged. Here because `len` is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.experts.is_empty()
    }

    /// The experts' names and masses, in the order in which they were asked to judge.
    pub fn experts(&self) -> impl Iterator<Item = (&str, &Raster<InterestMass>)> {
        self.experts.iter().map(|(name, masses)| (name.as_str(), masses))
    }

    /// What each expert says of one cell, in their order.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    pub fn at(&self, cell: Cell) -> impl Iterator<Item = InterestMass> {
        self.experts.iter().map(move |(_, masses)| masses[cell])
    }
}

/// Asks every expert for its opinion of every cell, discounted by the uncertainty of what it read (paper
/// section III.B, Eq. 4). Of a cell where nothing is known (u = 1) it says nothing: all mass is ignorance.
///
/// ```
/// use std::collections::BTreeMap;
/// use wisdom_belief::{InterestMass, Opinion};
/// use wisdom_fusion::{Class, Expert, LookupTable, Rows, judge};
/// use wisdom_grid::{Cell, GridSpec, Raster};
/// use wisdom_terrain::Layer;
///
/// let dull = Opinion { paradox: 0.2, not_interesting: 0.8, interesting: 0.0 };
/// let rare = Opinion { paradox: 0.05, not_interesting: 0.0, interesting: 0.95 };
/// let rows = Rows::Classes(vec![Class { class: 4, opinion: rare }]);
/// let table = LookupTable::new("texture", "texture class", "1", rows, dull)?;
/// let expert = Expert { name: "texture".into(), layer: "texture".into(), table };
///
/// let spec = GridSpec::new(1, 2, 1.0)?;
/// let (values, u) = (Raster::filled(spec, 4.0), Raster::from_vec(spec, vec![0.0, 1.0])?);
/// let layers = BTreeMap::from([("texture".to_owned(), Layer::new(values, u)?)]);
/// let evidence = judge(&[expert], &layers)?;
/// let of = |col| evidence.at(Cell { row: 0, col }).next();
/// assert_eq!(of(0), Some(InterestMass::try_from(rare)?));
/// assert_eq!(of(1), Some(InterestMass::VACUOUS));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FusionError::NoExperts`], [`FusionError::RepeatedExpert`], [`FusionError::MissingLayer`] or
/// [`FusionError::GridMismatch`].
pub fn judge(
    experts: &[Expert],
    layers: &BTreeMap<String, Layer>,
) -> Result<Evidence, FusionError> {
    let readings = readings(experts, layers)?;
    let spec = readings[0].1.spec();
    let experts = readings
        .into_iter()
        .map(|(expert, layer)| (expert.name.clone(), opinions(&expert.table, layer)))
        .collect();
    Ok(Evidence { spec, experts })
}

/// Each expert with its layer; all on one grid.
pub(crate) fn readings<'a>(
    experts: &'a [Expert],
    layers: &'a BTreeMap<String, Layer>,
) -> Result<Vec<(&'a Expert, &'a Layer)>, FusionError> {
    check_names(experts)?;
    let read = |expert| Ok((expert, layer_of(expert, layers)?));
    let readings: Vec<(&Expert, &Layer)> =
        experts.iter().map(read).collect::<Result<_, FusionError>>()?;
    let Some(&(first, layer)) = readings.first() else { return Err(FusionError::NoExperts) };
    let spec = layer.spec();
    match readings.iter().find(|(_, layer)| layer.spec() != spec) {
        None => Ok(readings),
        Some((second, layer)) => Err(FusionError::GridMismatch {
            first: first.layer.clone(),
            second: second.layer.clone(),
            grids: Box::new((spec, layer.spec())),
        }),
    }
}

fn check_names(experts: &[Expert]) -> Result<(), FusionError> {
    for (index, Expert { name, .. }) in experts.iter().enumerate() {
        if experts[..index].iter().any(|earlier| earlier.name == *name) {
            return Err(FusionError::RepeatedExpert { name: name.clone() });
        }
    }
    Ok(())
}

fn layer_of<'a>(
    expert: &Expert,
    layers: &'a BTreeMap<String, Layer>,
) -> Result<&'a Layer, FusionError> {
    layers.get(&expert.layer).ok_or_else(|| FusionError::MissingLayer {
        expert: expert.name.clone(),
        layer: expert.layer.clone(),
        known: layers.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
    })
}

fn opinions(table: &LookupTable, layer: &Layer) -> Raster<InterestMass> {
    let (values, uncertainty) = (layer.values(), layer.uncertainty());
    Raster::par_from_fn(layer.spec(), |cell| {
        let u = Uncertainty::new(f64::from(uncertainty[cell]))
            .expect("a layer checks that its u lies in [0, 1]");
        if u == Uncertainty::UNKNOWN {
            return InterestMass::VACUOUS;
        }
        table.mass(values[cell]).discounted(u)
    })
}
