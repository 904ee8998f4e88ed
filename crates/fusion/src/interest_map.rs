//! The interest map: everyone's evidence fused, cell by cell (paper section III.B).

use rayon::prelude::*;
use wisdom_belief::{Fused, InterestMass, MAX_SOURCES, Model, ParadoxPolicy, Rule, Settings};
use wisdom_grid::{GridSpec, Raster};

use crate::{Evidence, FusionError, Statistic};

/// The most experts under a rule whose credit is shared by coalitions: 4096 of them, a tenth of a second a goal
/// where the rule is slow.
pub const MAX_EXPERTS: usize = 12;

/// How evidence becomes interest; by default as in the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fusion {
    /// The rule of combination.
    pub rule: Rule,
    /// Where each source's paradox goes before a rule on Shafer's model.
    pub paradox_policy: ParadoxPolicy,
    /// The number that goals read.
    pub statistic: Statistic,
    /// k of the rule `inagaki`, in [0, 1]; others do not ask.
    pub inagaki_k: f64,
}

impl Default for Fusion {
    fn default() -> Self {
        Self {
            rule: Rule::default(),
            paradox_policy: ParadoxPolicy::default(),
            statistic: Statistic::default(),
            inagaki_k: Settings::default().inagaki_k,
        }
    }
}

impl Fusion {
    /// Whether so many experts can be fused this way: under `dsmc` any number; under others [`MAX_EXPERTS`],
    /// since [`credit`](crate::credit) asks what every coalition of them would have said; under `pcr5` and its
    /// kin, which visit 3^S assignments a cell, [`MAX_SOURCES`]. To be asked where rule and experts first meet:
    /// in the mission's spec, not on the map.
    ///
    /// # Errors
    /// [`FusionError::NotOnMaps`], [`FusionError::PolicyNotAdmitted`], [`FusionError::InagakiK`],
    /// [`FusionError::TooManyExperts`].
    pub fn check(self, experts: usize) -> Result<(), FusionError> {
        let Self { rule, paradox_policy: policy, inagaki_k: k, .. } = self;
        if !rule.on_maps() {
            return Err(FusionError::NotOnMaps { rule });
        }
        if !rule.admits(policy) {
            let admitted = ParadoxPolicy::ALL.into_iter().filter(|&policy| rule.admits(policy));
            let admitted = admitted.map(ParadoxPolicy::name).collect::<Vec<_>>().join(", ");
            return Err(FusionError::PolicyNotAdmitted { policy, rule, admitted });
        }
        if !(0.0..=1.0).contains(&k) {
            return Err(FusionError::InagakiK { k });
        }
        let limit = match rule {
            Rule::Dsmc => return Ok(()),
            Rule::Pcr5 | Rule::Pcr5Plus | Rule::Pcr5Canonical => MAX_SOURCES,
            _ => MAX_EXPERTS,
        };
        if experts > limit {
            return Err(FusionError::TooManyExperts { experts, limit, rule });
        }
        Ok(())
    }

    pub(crate) fn settings(&self) -> Settings<'static> {
        Settings::default().with_inagaki_k(self.inagaki_k)
    }

    /// All sources of one cell at once.
    pub(crate) fn fuse(self, sources: &[InterestMass]) -> Fused {
        let fused = self.rule.fuse_with(sources, self.paradox_policy, &self.settings());
        fused.expect("Fusion::check admits rule, policy and settings")
    }

    /// The statistic of what these sources say together: the interest of one cell, in [0, 1].
    ///
    /// # Panics
    /// If [`Fusion::check`] refuses as many experts.
    #[must_use]
    pub fn interest(self, sources: &[InterestMass]) -> f64 {
        self.statistic.of(self.fuse(sources).mass, &self.rule.model())
    }

    /// Panics where [`Fusion::check`] would have refused.
    pub(crate) fn assert_admits(self, evidence: &Evidence) {
        if let Err(error) = self.check(evidence.len()) {
            panic!("Fusion::check was not asked: {error}");
        }
    }
}

/// The interest of every cell, and what else the fused evidence says; no plane has a unit, all lie in [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub struct InterestMap {
    /// The statistic that goals read: Bel(I), unless the fusion names another (paper Fig. 9).
    pub interest: Raster<f32>,
    /// Fused m(I ∪ NI).
    pub ignorance: Raster<f32>,
    /// Fused m(I ∩ NI): it only ever grows with more sources; 0 under rules on Shafer's model.
    pub paradox: Raster<f32>,
    /// K: what fell on ∅ before the rule dealt with it; 0 under `dsmc`, 1 in total conflict.
    pub conflict: Raster<f32>,
    /// The largest `m_a(I)·m_b(NI)` over ordered pairs of experts, from their discounted opinions: whether two
    /// of them contradict each other, under any rule; 0 with one expert.
    pub contradiction: Raster<f32>,
}

/// Fuses the evidence of all experts, cell by cell on all threads; the same bits at any number of threads.
///
/// # Panics
/// If [`Fusion::check`] refuses as many experts.
#[must_use]
pub fn interest_map(evidence: &Evidence, fusion: &Fusion) -> InterestMap {
    fusion.assert_admits(evidence);
    let (spec, model) = (evidence.spec(), fusion.rule.model());
    let cells: Vec<[f32; 5]> = (0..spec.len())
        .into_par_iter()
        .with_min_len(1024)
        .map_init(Vec::new, |sources, index| {
            sources.clear();
            sources.extend(evidence.at(spec.cell(index)));
            let Fused { mass, conflict } = fusion.fuse(sources);
            let interest = fusion.statistic.of(mass, &model);
            // Under an exclusive model that slot is the empty element, which `conflict` tells of.
            let paradox = if model == Model::Free { mass.paradox() } else { 0.0 };
            [interest, mass.ignorance(), paradox, conflict, contradiction(sources)]
                .map(|value| value as f32)
        })
        .collect();
    InterestMap {
        interest: plane(spec, &cells, 0),
        ignorance: plane(spec, &cells, 1),
        paradox: plane(spec, &cells, 2),
        conflict: plane(spec, &cells, 3),
        contradiction: plane(spec, &cells, 4),
    }
}

fn plane(spec: GridSpec, cells: &[[f32; 5]], which: usize) -> Raster<f32> {
    let values = cells.iter().map(|cell| cell[which]).collect();
    Raster::from_vec(spec, values).expect("one value a cell")
}

fn contradiction(sources: &[InterestMass]) -> f64 {
    let mut largest = 0.0_f64;
    for (index, a) in sources.iter().enumerate() {
        for b in &sources[..index] {
            let (ab, ba) =
                (a.interesting() * b.not_interesting(), b.interesting() * a.not_interesting());
            largest = largest.max(ab).max(ba);
        }
    }
    largest
}
