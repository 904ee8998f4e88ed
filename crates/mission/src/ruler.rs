//! The common ruler: what the rule `dsmc` makes of the world as it truly is, without noise or hidden ground.

use std::borrow::Cow;
use std::collections::BTreeMap;

use wisdom_autonomy::{ELEVATION, Source, Spec};
use wisdom_belief::Rule;
use wisdom_fusion::{Fusion, belief_map};
use wisdom_grid::{Cell, Raster, Window};
use wisdom_terrain::{Layer, TerrainError};

use crate::{Mission, World};

/// Interest as it truly is, the same for every rule that is compared.
#[derive(Debug, Clone)]
pub struct Ruler(Measure);

#[derive(Debug, Clone)]
enum Measure {
    /// The whole map.
    Whole(Raster<f32>),
    /// Ground that does not lie in memory is measured where it is asked for.
    Local { spec: Box<Spec>, world: Box<World> },
}

impl Ruler {
    /// The ruler of a mission's world.
    ///
    /// # Panics
    /// Never for a mission that was loaded: loading checks what is looked up here.
    #[must_use]
    pub fn new(mission: &Mission) -> Self {
        let (spec, world) = (&mission.spec, &mission.world);
        if world.ground().is_none() {
            let (spec, world) = (Box::new(spec.clone()), Box::new(world.clone()));
            return Self(Measure::Local { spec, world });
        }
        let whole = measured(spec, world, spec.grid.window());
        Self(Measure::Whole(whole.expect("what lies in memory can be read")))
    }

    /// True interest at a cell.
    ///
    /// # Errors
    /// [`TerrainError`] if the ground there cannot be read.
    pub fn interest(&self, cell: Cell) -> Result<f64, TerrainError> {
        let interest = match &self.0 {
            Measure::Whole(map) => map[cell],
            Measure::Local { spec, world } => {
                // A derived layer reaches as far as the rover's footprint, at least one cell.
                let reach = spec.vehicle.footprint_radius_m / spec.grid.spacing_m();
                let near = spec.grid.around(cell, reach.round().max(1.0) as usize);
                measured(spec, world, near)?[cell]
            }
        };
        Ok(f64::from(interest))
    }
}

/// That window of a layer and no more: of layers in memory, [`World::truth_near`] gives all there is.
fn cut(layer: Cow<'_, Layer>, window: Window) -> Result<Cow<'_, Layer>, TerrainError> {
    if layer.spec().window() == window {
        return Ok(layer);
    }
    let first = Cell { row: window.row, col: window.col };
    Ok(Cow::Owned(layer.crop(window)?.numbered_from(first)))
}

/// True interest of a window, of which the cells at its edges may lack neighbours.
fn measured(spec: &Spec, world: &World, window: Window) -> Result<Raster<f32>, TerrainError> {
    let mut layers: BTreeMap<String, Layer> = BTreeMap::new();
    let elevation = cut(world.truth_near(ELEVATION, window)?, window)?;
    for layer in &spec.layers {
        let values = match layer.source {
            Source::Measured(_) => cut(world.truth_near(&layer.name, window)?, window)?,
            Source::Derived(derivation) => {
                Cow::Owned(derivation.of(&elevation, spec.vehicle.footprint_radius_m))
            }
        };
        layers.insert(layer.name.clone(), values.into_owned());
    }
    let fusion = Fusion { rule: Rule::Dsmc, ..Fusion::default() };
    Ok(belief_map(&spec.experts, &layers, &fusion).expect("loading checked the experts"))
}
