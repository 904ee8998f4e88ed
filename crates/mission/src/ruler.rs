//! The common ruler: what the rule `dsmc` makes of the world as it truly is, without noise or hidden ground.

use std::collections::BTreeMap;

use wisdom_autonomy::{ELEVATION, Source};
use wisdom_belief::Rule;
use wisdom_fusion::{Fusion, belief_map};
use wisdom_grid::{Cell, Raster};
use wisdom_terrain::Layer;

use crate::Mission;

/// Interest as it truly is, the same for every rule that is compared.
#[derive(Debug, Clone)]
pub struct Ruler(Raster<f32>);

impl Ruler {
    /// The ruler of a mission's world.
    ///
    /// # Panics
    /// Never for a mission that was loaded: loading checks what is looked up here.
    #[must_use]
    pub fn new(mission: &Mission) -> Self {
        let spec = &mission.spec;
        let mut layers: BTreeMap<String, Layer> = BTreeMap::new();
        let elevation = mission.world.truth(ELEVATION).expect("a mission has an elevation");
        for layer in &spec.layers {
            let values = match layer.source {
                Source::Measured(_) => {
                    mission.world.truth(&layer.name).expect("measured layers have a truth").clone()
                }
                Source::Derived(derivation) => {
                    derivation.of(elevation, spec.vehicle.footprint_radius_m)
                }
            };
            layers.insert(layer.name.clone(), values);
        }
        let fusion = Fusion { rule: Rule::Dsmc, ..Fusion::default() };
        Self(belief_map(&spec.experts, &layers, &fusion).expect("loading checked the experts"))
    }

    /// True interest at a cell.
    #[must_use]
    pub fn interest(&self, cell: Cell) -> f64 {
        f64::from(self.0[cell])
    }

    /// The whole map.
    #[must_use]
    pub fn map(&self) -> &Raster<f32> {
        &self.0
    }
}
