//! The world as it truly is, without noise and all of it known: what maps are held against real places.

use std::collections::BTreeMap;

use anyhow::Context;
use wisdom_autonomy::{Derivation, ELEVATION, Source};
use wisdom_belief::Rule;
use wisdom_fusion::{Expert, Fusion, belief_map, interest_map, judge};
use wisdom_goals::{Site, prize_map, sites};
use wisdom_grid::{Cell, Raster};
use wisdom_mission::Mission;
use wisdom_terrain::Layer;

/// Every layer of a mission, noise-free. A layer that is handed in is unknown: no reading of it is in any map here.
pub(crate) struct Known<'a> {
    mission: &'a Mission,
    layers: BTreeMap<String, Layer>,
}

impl<'a> Known<'a> {
    /// The layers of a mission whose ground lies in memory.
    pub(crate) fn of(mission: &'a Mission) -> anyhow::Result<Self> {
        let (spec, world) = (&mission.spec, &mission.world);
        let window = spec.grid.window();
        let elevation = world.truth(ELEVATION).context("the ground does not lie in memory")?;
        let mut layers = BTreeMap::new();
        for layer in &spec.layers {
            let values = match layer.source {
                Source::Measured(_) => world.truth_near(&layer.name, window)?.into_owned(),
                Source::Derived(derivation) => {
                    derivation.of(elevation, spec.vehicle.footprint_radius_m)
                }
            };
            layers.insert(layer.name.clone(), values);
        }
        Ok(Self { mission, layers })
    }

    /// Bel(I) of all experts under a rule.
    pub(crate) fn interest(&self, rule: Rule) -> anyhow::Result<Raster<f32>> {
        self.belief(&self.mission.spec.experts, rule)
    }

    /// Bel(I) of one expert alone.
    pub(crate) fn opinion(&self, expert: &Expert) -> anyhow::Result<Raster<f32>> {
        self.belief(std::slice::from_ref(expert), Rule::Dsmc)
    }

    fn belief(&self, experts: &[Expert], rule: Rule) -> anyhow::Result<Raster<f32>> {
        let fusion = Fusion { rule, ..self.mission.spec.fusion };
        Ok(belief_map(experts, &self.layers, &fusion)?)
    }

    /// The experts whose layers the world holds: of the others nothing is known anywhere.
    pub(crate) fn experts(&self) -> impl Iterator<Item = &'a Expert> {
        let mission = self.mission;
        mission.spec.experts.iter().filter(|expert| !mission.world.is_handed_in(&expert.layer))
    }

    /// A measured layer's values, or those of something derived from the elevation.
    pub(crate) fn layer(&self, name: &str) -> Option<&Raster<f32>> {
        self.layers.get(name).map(Layer::values)
    }

    /// Something derived from the elevation.
    pub(crate) fn derived(&self, derivation: Derivation) -> Raster<f32> {
        let radius_m = self.mission.spec.vehicle.footprint_radius_m;
        derivation.of(&self.layers[ELEVATION], radius_m).values().clone()
    }

    /// The maxima that would bring forth goals, had the rover seen everything without error: those of the prize under
    /// a rule, by the mission's own limits, that some directive takes.
    pub(crate) fn sites(&self, rule: Rule) -> anyhow::Result<Vec<Site>> {
        let spec = &self.mission.spec;
        let fusion = Fusion { rule, ..spec.fusion };
        let evidence = judge(&spec.experts, &self.layers)?;
        let map = interest_map(&evidence, &fusion);
        let prize = prize_map(&map.interest, &map.ignorance, spec.prize);
        let taken = |cell: Cell| {
            let shares = wisdom_fusion::credit(&evidence, &fusion, cell);
            let interest = f64::from(map.interest[cell]);
            spec.directives.iter().any(|directive| directive.accepts(interest, &shares))
        };
        let mut found = sites(&prize.prize, &spec.manager.extraction);
        found.retain(|site| taken(site.peak));
        Ok(found)
    }
}
