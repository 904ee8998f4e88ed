//! The maps a decision is made from, derived from what is known, stage by stage.

use std::collections::BTreeMap;

use wisdom_fusion::{Evidence, InterestMap, interest_map, judge};
use wisdom_goals::{PrizeMap, Site, prize_map, sites};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::Traversability;
use wisdom_terrain::{Layer, gradient, roughness, slope, step};

use crate::{AutonomyError, Derivation, Digest, ELEVATION, Knowledge, Source, Spec};

/// Everything between the readings and the goals.
#[derive(Debug, Clone)]
pub struct Maps {
    /// The measured and derived layers, by name.
    pub layers: BTreeMap<String, Layer>,
    /// What each expert says of each cell.
    pub evidence: Evidence,
    /// The fused map.
    pub interest: InterestMap,
    /// What each cell is worth.
    pub prize: PrizeMap,
    /// Maxima, at half the least prominence (see the goal manager).
    pub sites: Vec<Site>,
    /// How each cell may be crossed.
    pub ground: Traversability,
    /// Share of the working map of which anything is known.
    pub seen: f64,
}

impl Maps {
    /// Derives all maps of a window from what is known of it.
    pub(crate) fn new(
        spec: &Spec,
        knowledge: &Knowledge,
        working: Window,
        survival: &wisdom_goals::Extraction,
    ) -> Result<Self, AutonomyError> {
        let mut layers = BTreeMap::new();
        for layer in spec.layers.iter().filter(|l| matches!(l.source, Source::Measured(_))) {
            layers.insert(layer.name.clone(), knowledge.layer(&layer.name, working)?);
        }
        let elevation = layers.get(ELEVATION).ok_or(AutonomyError::NoElevation)?.clone();
        for layer in &spec.layers {
            if let Source::Derived(derivation) = layer.source {
                layers.insert(
                    layer.name.clone(),
                    derivation.of(&elevation, spec.vehicle.footprint_radius_m),
                );
            }
        }
        let evidence = judge(&spec.experts, &layers)?;
        let interest = interest_map(&evidence, &spec.fusion);
        let prize = prize_map(&interest.interest, &interest.ignorance, spec.prize);
        let sites = sites(&prize.prize, survival);
        let classes = spec.slip_layer.as_ref().map(|name| &layers[name]);
        let ground = Traversability::on_classes(&spec.vehicle, &elevation, classes)?;
        let known = interest.ignorance.values().iter().filter(|u| **u < 1.0).count();
        let seen = known as f64 / elevation.spec().len() as f64;
        Ok(Self { layers, evidence, interest, prize, sites, ground, seen })
    }

    /// Digest of the measured layers.
    pub(crate) fn frame_digest(&self, spec: &Spec) -> Digest {
        self.layer_digest(spec, |source| matches!(source, Source::Measured(_)))
    }

    /// Digest of the derived layers.
    pub(crate) fn derived_digest(&self, spec: &Spec) -> Digest {
        self.layer_digest(spec, |source| matches!(source, Source::Derived(_)))
    }

    fn layer_digest(&self, spec: &Spec, wanted: impl Fn(Source) -> bool) -> Digest {
        let mut digest = Digester::default();
        for layer in spec.layers.iter().filter(|l| wanted(l.source)) {
            digest.text(&layer.name);
            digest.raster(self.layers[&layer.name].values());
            digest.raster(self.layers[&layer.name].uncertainty());
        }
        digest.finish()
    }

    /// Digest of the experts' masses.
    pub(crate) fn masses_digest(&self) -> Digest {
        let mut digest = Digester::default();
        for (name, masses) in self.evidence.experts() {
            digest.text(name);
            for mass in masses.values() {
                for m in
                    [mass.interesting(), mass.not_interesting(), mass.ignorance(), mass.paradox()]
                {
                    digest.number(m);
                }
            }
        }
        digest.finish()
    }

    /// Digest of the fused map.
    pub(crate) fn fusion_digest(&self) -> Digest {
        let mut digest = Digester::default();
        let map = &self.interest;
        for plane in
            [&map.interest, &map.ignorance, &map.paradox, &map.conflict, &map.contradiction]
        {
            digest.raster(plane);
        }
        digest.finish()
    }

    /// Digest of traversability.
    pub(crate) fn ground_digest(&self) -> Digest {
        let mut digest = Digester::default();
        for cell in self.ground.spec().cells() {
            digest.bytes(&[u8::from(self.ground.is_blocked(cell))]);
            digest.bytes(&self.ground.hazard_per_m(cell).to_bits().to_le_bytes());
        }
        digest.finish()
    }

    /// Digest of what is blocked within `radius` cells of a cell: the ground of a place given up.
    /// None if a part of it lies on the grid but beyond the working map.
    pub(crate) fn local_ground(&self, grid: GridSpec, cell: Cell, radius: usize) -> Option<u64> {
        let near = grid.around(cell, radius);
        if self.ground.spec().around(cell, radius) != near {
            return None;
        }
        let mut digest = Digester::default();
        for near in near.cells() {
            digest.bytes(&[u8::from(self.ground.is_blocked(near))]);
        }
        let first = digest.finish().0[..8].try_into().expect("a digest has 32 bytes");
        Some(u64::from_le_bytes(first))
    }
}

impl Derivation {
    /// The layer, derived from elevation for a vehicle that stands on `footprint_radius_m`.
    #[must_use]
    pub fn of(self, elevation: &Layer, footprint_radius_m: f64) -> Layer {
        match self {
            Self::Gradient => gradient(elevation),
            Self::Slope => slope(elevation),
            Self::Step => step(elevation),
            Self::Roughness => {
                let cells = (footprint_radius_m / elevation.spec().spacing_m()).round().max(1.0);
                roughness(elevation, cells as usize)
            }
        }
    }
}

/// BLAKE3 over exact bits; −0 counts as 0, so that equal numbers have equal digests.
#[derive(Default)]
pub(crate) struct Digester(blake3::Hasher);

impl Digester {
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    pub(crate) fn number(&mut self, number: f64) {
        self.bytes(&(number + 0.0).to_bits().to_le_bytes());
    }

    pub(crate) fn raster(&mut self, raster: &Raster<f32>) {
        let bytes: Vec<u8> =
            raster.values().iter().flat_map(|v| (v + 0.0).to_bits().to_le_bytes()).collect();
        self.bytes(&bytes);
    }

    pub(crate) fn finish(self) -> Digest {
        Digest(*self.0.finalize().as_bytes())
    }
}
