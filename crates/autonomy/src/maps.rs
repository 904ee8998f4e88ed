//! The maps a decision is made from, derived from what is known, stage by stage.

use std::collections::BTreeMap;

use rayon::prelude::*;
use wisdom_fusion::{Evidence, Expert, InterestMap, interest_map, judge};
use wisdom_goals::{Extraction, Kind, MergeTree, PrizeMap, PrizeScale, Site, prize_map, sites};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::{Ground, Traversability};
use wisdom_terrain::{Layer, gradient, roughness, slope, step};

use crate::{AutonomyError, Derivation, Digest, ELEVATION, Knowledge, Source, Spec, Stage, Watch};

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
    /// How the maxima of the interest, or of the prize, meet.
    peaks: MergeTree,
    /// Maxima, at half the least prominence (see the goal manager).
    pub sites: Vec<Site>,
    /// What a close look promises; none if no directive asks.
    pub promise: Option<Promise>,
    /// Maxima of the contradiction, likewise; none if no directive asks.
    pub disputes: Option<Vec<Site>>,
    /// How each cell may be crossed.
    pub ground: Traversability,
    /// Share of the working map of which anything is known.
    pub seen: f64,
}

/// What a close look could bring: the value of looking, not of being there.
#[derive(Debug, Clone)]
pub struct Promise {
    /// The interest there would be if every reading at hand were as certain as the instruments can make it.
    pub interest: Raster<f32>,
    /// The prize of that, less the prize there is; in [0, 1].
    pub gain: Raster<f32>,
    /// Maxima of the gain, at half the least prominence.
    pub sites: Vec<Site>,
}

/// Which kinds of goals the mission's directives ask for.
fn asks_for(spec: &Spec, kind: Kind) -> bool {
    spec.directives.iter().any(|directive| directive.kind == kind)
}

impl Promise {
    fn new(interest: Raster<f32>, prize: &PrizeMap, survival: &Extraction) -> Self {
        let mut gain = interest.map(|&promised| prize.of(promised));
        for (gain, now) in gain.values_mut().iter_mut().zip(prize.prize.values()) {
            *gain = (*gain - now).max(0.0);
        }
        let sites = sites(&gain, survival);
        Self { interest, gain, sites }
    }
}

/// The layers as they would be if what was read were as certain as a close look makes it. What was not read stays unknown.
fn sharpened(spec: &Spec, layers: &BTreeMap<String, Layer>) -> BTreeMap<String, Layer> {
    let limit = |name: &str| {
        let derived =
            spec.layers.iter().any(|l| l.name == name && matches!(l.source, Source::Derived(_)));
        let read = if derived { ELEVATION } else { name };
        spec.close_look.get(read).copied().unwrap_or(0.0)
    };
    let sharper = |(name, layer): (&String, &Layer)| {
        let mut sharp = layer.clone();
        let least = limit(name);
        for cell in layer.spec().cells() {
            let u = layer.u(cell);
            if u < 1.0 && u > least {
                sharp.set(cell, layer.value(cell), least);
            }
        }
        (name.clone(), sharp)
    };
    layers.iter().map(sharper).collect()
}

/// The interest that certain readings would give, if a directive asks for it.
fn promised(
    spec: &Spec,
    layers: &BTreeMap<String, Layer>,
) -> Result<Option<Raster<f32>>, AutonomyError> {
    if !asks_for(spec, Kind::LookAgain) {
        return Ok(None);
    }
    let evidence = judge(&spec.experts, &sharpened(spec, layers))?;
    Ok(Some(interest_map(&evidence, &spec.fusion).interest))
}

impl Maps {
    /// Derives all maps of a window from what is known of it.
    pub(crate) fn new(
        spec: &Spec,
        knowledge: &Knowledge,
        working: Window,
        survival: &Extraction,
        watch: Watch<'_>,
    ) -> Result<Self, AutonomyError> {
        let layers = layers(spec, knowledge, working)?;
        watch(Stage::Layers);
        let evidence = judge(&spec.experts, &layers)?;
        watch(Stage::Masses);
        let interest = interest_map(&evidence, &spec.fusion);
        watch(Stage::Fusion);
        let prize = prize_map(&interest.interest, &interest.ignorance, spec.prize);
        let peaks = MergeTree::new(raised(spec, &interest, &prize));
        let sites = peaks.sites(&prize.prize, survival);
        let promise = promised(spec, &layers)?.map(|p| Promise::new(p, &prize, survival));
        let disputes = disputes(spec, &interest, survival);
        watch(Stage::Sites);
        let ground = ground(spec, &layers)?;
        watch(Stage::Traversability);
        let seen = seen(&interest);
        Ok(Self {
            layers,
            evidence,
            interest,
            prize,
            peaks,
            sites,
            promise,
            disputes,
            ground,
            seen,
        })
    }

    /// The maps after readings inside a window changed, bit for bit those that [`Maps::new`] would derive: what hangs
    /// on a few cells is made anew around that window and put into the old maps, the rest is made anew whole.
    pub(crate) fn revised(
        self,
        spec: &Spec,
        knowledge: &Knowledge,
        changed: Window,
        survival: &Extraction,
        watch: Watch<'_>,
    ) -> Result<Self, AutonomyError> {
        let working = self.ground.spec().window();
        let Some(changed) = changed.intersection(working) else { return Ok(self) };
        let touched = grown(changed, reach(spec), working);
        let around = grown(touched, reach(spec), working);
        if 2 * around.rows * around.cols > working.rows * working.cols {
            return Self::new(spec, knowledge, working, survival, watch);
        }
        let Self {
            layers: mut known, mut interest, mut peaks, ground: old_ground, promise, ..
        } = self;
        let part = layers(spec, knowledge, around)?;
        for (name, layer) in &mut known {
            let part = &part[name];
            for cell in touched.cells() {
                layer.set(cell, part.value(cell), part.u(cell));
            }
        }
        watch(Stage::Layers);
        let evidence = judge(&spec.experts, &known)?;
        watch(Stage::Masses);
        let fused = interest_map(&judge(&spec.experts, &part)?, &spec.fusion);
        paste(&mut interest.interest, &fused.interest, touched);
        paste(&mut interest.ignorance, &fused.ignorance, touched);
        paste(&mut interest.paradox, &fused.paradox, touched);
        paste(&mut interest.conflict, &fused.conflict, touched);
        paste(&mut interest.contradiction, &fused.contradiction, touched);
        watch(Stage::Fusion);
        let prize = prize_map(&interest.interest, &interest.ignorance, spec.prize);
        peaks.update(raised(spec, &interest, &prize));
        let sites = peaks.sites(&prize.prize, survival);
        let promise = match (promise, promised(spec, &part)?) {
            (Some(Promise { interest: mut whole, .. }), Some(part)) => {
                paste(&mut whole, &part, touched);
                Some(Promise::new(whole, &prize, survival))
            }
            _ => None,
        };
        let disputes = disputes(spec, &interest, survival);
        watch(Stage::Sites);
        let ground = ground_revised(spec, &old_ground, &ground(spec, &part)?, &known, touched)?;
        watch(Stage::Traversability);
        let seen = seen(&interest);
        let layers = known;
        Ok(Self {
            layers,
            evidence,
            interest,
            prize,
            peaks,
            sites,
            promise,
            disputes,
            ground,
            seen,
        })
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
            let masses = masses.values();
            digest.each(masses.len(), |i| {
                let mass = masses[i];
                let parts =
                    [mass.interesting(), mass.not_interesting(), mass.ignorance(), mass.paradox()];
                let mut bytes = [0; 32];
                for (into, part) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(parts) {
                    *into = Digester::bits(part);
                }
                bytes
            });
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
        let (blocked, hazard) = (self.ground.blocked().values(), self.ground.hazard().values());
        digest.each(blocked.len(), |i| {
            let [a, b, c, d] = hazard[i].to_bits().to_le_bytes();
            [u8::from(blocked[i]), a, b, c, d]
        });
        digest.finish()
    }

    /// The experts that have read anything in a cell, a bit each.
    pub(crate) fn heard(&self, spec: &Spec, cell: Cell) -> u64 {
        let read = |expert: &Expert| self.layers[&expert.layer].u(cell) < 1.0;
        let bits = spec.experts.iter().enumerate().filter(|(_, expert)| read(expert));
        bits.fold(0, |heard, (bit, _)| heard | 1 << bit)
    }

    /// Sum of the uncertainties of what the experts read in a cell.
    pub(crate) fn doubt(&self, spec: &Spec, cell: Cell) -> f64 {
        spec.experts.iter().map(|expert| f64::from(self.layers[&expert.layer].u(cell))).sum()
    }

    /// The class of the ground in a cell and its uncertainty, by the layer that types of objects go by.
    pub(crate) fn class(&self, spec: &Spec, cell: Cell) -> Option<(u16, f64)> {
        let layer = self.layers.get(spec.class_layer.as_ref()?)?;
        let u = f64::from(layer.u(cell));
        (u < 1.0).then(|| (layer.value(cell) as u16, u))
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

/// Maxima of the contradiction, if a directive asks for them.
fn disputes(spec: &Spec, interest: &InterestMap, survival: &Extraction) -> Option<Vec<Site>> {
    asks_for(spec, Kind::Adjudicate).then(|| sites(&interest.contradiction, survival))
}

/// The measured layers of a window, and those derived from them.
fn layers(
    spec: &Spec,
    knowledge: &Knowledge,
    window: Window,
) -> Result<BTreeMap<String, Layer>, AutonomyError> {
    let mut layers = BTreeMap::new();
    for layer in spec.layers.iter().filter(|l| matches!(l.source, Source::Measured(_))) {
        layers.insert(layer.name.clone(), knowledge.layer(&layer.name, window)?);
    }
    let elevation = layers.get(ELEVATION).ok_or(AutonomyError::NoElevation)?;
    let derived: Vec<(String, Layer)> = spec
        .layers
        .iter()
        .filter_map(|layer| match layer.source {
            Source::Measured(_) => None,
            Source::Derived(derivation) => {
                let derived = derivation.of(elevation, spec.vehicle.footprint_radius_m);
                Some((layer.name.clone(), derived))
            }
        })
        .collect();
    layers.extend(derived);
    Ok(layers)
}

/// How the vehicle meets the ground of some layers.
fn ground(spec: &Spec, layers: &BTreeMap<String, Layer>) -> Result<Traversability, AutonomyError> {
    let classes = spec.slip_layer.as_ref().map(|name| &layers[name]);
    Ok(Traversability::on_classes(&spec.vehicle, &layers[ELEVATION], classes)?)
}

/// The old ground with a window of it taken from ground judged anew.
fn ground_revised(
    spec: &Spec,
    old: &Traversability,
    new: &Traversability,
    layers: &BTreeMap<String, Layer>,
    window: Window,
) -> Result<Traversability, AutonomyError> {
    let mut ground = Ground {
        elevation: layers[ELEVATION].clone(),
        blocked: old.blocked().clone(),
        severity: old.severities().clone(),
        hazard_per_m: old.hazard().clone(),
    };
    paste(&mut ground.blocked, new.blocked(), window);
    paste(&mut ground.severity, new.severities(), window);
    paste(&mut ground.hazard_per_m, new.hazard(), window);
    let classes = spec.slip_layer.as_ref().map(|name| &layers[name]);
    Ok(Traversability::from_ground_on_classes(&spec.vehicle, ground, classes)?)
}

/// The plane whose maxima are those of the prize: the interest, where the prize only rescales it, for that changes only
/// where something was read.
fn raised<'a>(spec: &Spec, interest: &'a InterestMap, prize: &'a PrizeMap) -> &'a Raster<f32> {
    match spec.prize {
        PrizeScale::Belief | PrizeScale::Contrast => &interest.interest,
        // These may take different interests for equal.
        _ => &prize.prize,
    }
}

/// Share of the cells of which anything is known.
fn seen(interest: &InterestMap) -> f64 {
    let known = interest.ignorance.values().iter().filter(|u| **u < 1.0).count();
    known as f64 / interest.ignorance.spec().len() as f64
}

/// How far a reading makes itself felt in derived layers and on the ground, cells: a footprint, and at least one.
fn reach(spec: &Spec) -> usize {
    footprint_cells(spec.vehicle.footprint_radius_m, spec.grid)
}

fn footprint_cells(footprint_radius_m: f64, grid: GridSpec) -> usize {
    (footprint_radius_m / grid.spacing_m()).round().max(1.0) as usize
}

/// A window and what lies around it, as far as that lies within another.
fn grown(window: Window, by: usize, within: Window) -> Window {
    let along = |from: usize, count: usize, first: usize, most: usize| {
        let start = from.saturating_sub(by).max(first);
        let end = from.saturating_add(count).saturating_add(by).min(first + most);
        (start, end - start)
    };
    let (row, rows) = along(window.row, window.rows, within.row, within.rows);
    let (col, cols) = along(window.col, window.cols, within.col, within.cols);
    Window { row, col, rows, cols }
}

/// Copies a window from one raster into another; both number their cells alike.
fn paste<T: Copy>(into: &mut Raster<T>, from: &Raster<T>, window: Window) {
    let (to, west) = (into.spec(), window.col - from.spec().first().col);
    for row in window.row..window.row + window.rows {
        let start = to.index(Cell { row, col: window.col });
        into.values_mut()[start..start + window.cols]
            .copy_from_slice(&from.row(row)[west..west + window.cols]);
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
                roughness(elevation, footprint_cells(footprint_radius_m, elevation.spec()))
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
        self.bytes(&Self::bits(number));
    }

    pub(crate) fn raster(&mut self, raster: &Raster<f32>) {
        let values = raster.values();
        self.each(values.len(), |i| (values[i] + 0.0).to_bits().to_le_bytes());
    }

    /// The bytes of many things one after another, on all threads.
    fn each<const N: usize>(&mut self, count: usize, bytes: impl Fn(usize) -> [u8; N] + Sync) {
        /// Bytes laid out at a time: few enough to stay in the cache, enough to be shared out.
        const BLOCK: usize = 1 << 20;
        let most = (BLOCK / N).min(count);
        let mut block = vec![[0; N]; most];
        for first in (0..count).step_by(most.max(1)) {
            let block = &mut block[..most.min(count - first)];
            let places = block.par_iter_mut().enumerate().with_min_len(4096);
            places.for_each(|(i, place)| *place = bytes(first + i));
            self.0.update_rayon(block.as_flattened());
        }
    }

    fn bits(number: f64) -> [u8; 8] {
        (number + 0.0).to_bits().to_le_bytes()
    }

    pub(crate) fn finish(self) -> Digest {
        Digest(*self.0.finalize().as_bytes())
    }
}
