//! Four masses: what one source, or all of them together, say of the interest of one cell.

use crate::{
    BeliefError, Element, Frame, MassFunction, Model, SUM_TOLERANCE, mass::in_range, measure::share,
};

/// Ignorance below this is the rounding of decimals, as in 1 − (0.3 + 0.6 + 0.1), and counts as none.
const ROUNDING: f64 = 1e-12;

/// A row of an expert's table: masses before discounting; the rest, up to 1, is ignorance (paper Tables 1 to 3).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Opinion {
    /// m(I ∩ NI).
    pub paradox: f64,
    /// m(NI).
    pub not_interesting: f64,
    /// m(I).
    pub interesting: f64,
}

/// A mass function on {I, NI}: m(I), m(NI), m(I ∪ NI) and m(I ∩ NI), which sum to 1.
///
/// Serves the free model and Shafer's: under the latter the paradox is the empty element, and is 0 once a
/// [`ParadoxPolicy`](crate::ParadoxPolicy) was applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterestMass {
    pub(crate) interesting: f64,
    pub(crate) not_interesting: f64,
    pub(crate) ignorance: f64,
    pub(crate) paradox: f64,
}

impl InterestMass {
    /// Nothing is known: all mass on I ∪ NI.
    pub const VACUOUS: Self =
        Self { interesting: 0.0, not_interesting: 0.0, ignorance: 1.0, paradox: 0.0 };

    /// The mass function of an opinion and its ignorance, which must sum to 1 within [`SUM_TOLERANCE`].
    /// (An opinion alone, whose rest is ignorance, converts by `try_from`.)
    ///
    /// # Errors
    /// [`BeliefError::OutOfRange`] or [`BeliefError::SumNotOne`].
    pub fn new(opinion: Opinion, ignorance: f64) -> Result<Self, BeliefError> {
        let Opinion { paradox, not_interesting, interesting } = opinion;
        let mass = Self { interesting, not_interesting, ignorance, paradox };
        mass.check_range()?;
        let sum = paradox + not_interesting + interesting + ignorance;
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            return Err(BeliefError::SumNotOne { sum });
        }
        Ok(mass)
    }

    fn check_range(&self) -> Result<(), BeliefError> {
        let named = [
            ("I & NI", self.paradox),
            ("NI", self.not_interesting),
            ("I", self.interesting),
            ("I | NI", self.ignorance),
        ];
        match named.into_iter().find(|&(_, mass)| !in_range(mass)) {
            None => Ok(()),
            Some((element, mass)) => {
                Err(BeliefError::OutOfRange { element: element.to_owned(), mass })
            }
        }
    }

    /// m(I).
    #[must_use]
    pub const fn interesting(&self) -> f64 {
        self.interesting
    }

    /// m(NI).
    #[must_use]
    pub const fn not_interesting(&self) -> f64 {
        self.not_interesting
    }

    /// m(I ∪ NI).
    #[must_use]
    pub const fn ignorance(&self) -> f64 {
        self.ignorance
    }

    /// m(I ∩ NI).
    #[must_use]
    pub const fn paradox(&self) -> f64 {
        self.paradox
    }

    /// Bel(I) = m(I) + m(I ∩ NI) on the free model (paper Eq. 3). What a rule on Shafer's model fused has
    /// no paradox, so that this is its Bel(I) too.
    #[must_use]
    pub fn belief(&self) -> f64 {
        self.interesting + self.paradox
    }

    /// Pl(I) under a model (paper Eq. 3): always 1 on the free one, m(I) + m(I ∪ NI) on Shafer's.
    #[must_use]
    pub fn plausibility(&self, model: &Model) -> f64 {
        match model {
            Model::Free => 1.0,
            _ => self.sum_over(existing(model), |x| f64::from((x & I).min(1))),
        }
    }

    /// BetP(I) under a model: on the free one m(I ∩ NI) + m(I) + m(NI)/2 + 2 m(I ∪ NI)/3, on Shafer's
    /// m(I) + m(I ∪ NI)/2, without the mass of elements that the model empties (Smets 1994; Dezert and
    /// Smarandache 2004). 0 if that is all mass.
    #[must_use]
    pub fn pignistic(&self, model: &Model) -> f64 {
        let part = |x: u32| f64::from((x & I).count_ones()) / f64::from(x.count_ones());
        self.spread(existing(model), part)
    }

    /// `DSmP_ε(I)` under a model (Dezert and Smarandache 2008), ε ≥ 0: as [`MassFunction::dsmp`].
    #[must_use]
    pub fn dsmp(&self, model: &Model, epsilon: f64) -> f64 {
        let exists = existing(model);
        let weight = |x: u32| {
            let single = |b: u32| if b.is_power_of_two() && b & !x == 0 { 1.0 } else { 0.0 };
            self.sum_over(exists, single) + epsilon * f64::from(x.count_ones())
        };
        self.spread(exists, |x| match weight(x) {
            0.0 => f64::from((x & I).count_ones()) / f64::from(x.count_ones()),
            whole => weight(x & I) / whole,
        })
    }

    /// The same masses on a frame made by [`Frame::interest`]; what the frame empties goes to ∅.
    ///
    /// # Errors
    /// [`BeliefError::FrameSize`] if the frame has not two atoms.
    pub fn mass_function(&self, frame: &Frame) -> Result<MassFunction, BeliefError> {
        let (Some(i), Some(ni), 2) = (frame.atom(0), frame.atom(1), frame.atoms().len()) else {
            return Err(BeliefError::FrameSize { atoms: frame.atoms().len(), limit: 2 });
        };
        let mut masses = std::collections::BTreeMap::<Element, f64>::new();
        for (element, mass) in [
            (i, self.interesting),
            (ni, self.not_interesting),
            (i | ni, self.ignorance),
            (i & ni, self.paradox),
        ] {
            *masses.entry(element).or_default() += mass;
        }
        Ok(MassFunction::from_map(masses))
    }

    /// The sum of the masses of the non-empty elements, each times its part.
    fn sum_over(&self, exists: u32, part: impl Fn(u32) -> f64) -> f64 {
        let masses = [
            (PARADOX, self.paradox),
            (I, self.interesting),
            (NI, self.not_interesting),
            (THETA, self.ignorance),
        ];
        let possible = masses.into_iter().filter(|(x, mass)| x & exists != 0 && *mass > 0.0);
        possible.map(|(x, mass)| mass * part(x & exists)).sum()
    }

    fn spread(&self, exists: u32, part: impl Fn(u32) -> f64) -> f64 {
        let sum = self.sum_over(exists, part);
        if exists & PARADOX != 0 || self.paradox == 0.0 && exists == EXCLUSIVE {
            return sum;
        }
        share(sum, self.sum_over(exists, |_| 1.0))
    }
}

// Elements as bits of Venn regions, in the order of `Frame`: I alone, NI alone, both.
const I: u32 = 0b101;
const NI: u32 = 0b110;
const PARADOX: u32 = 0b100;
const THETA: u32 = 0b111;
const EXCLUSIVE: u32 = 0b011;

/// The Venn regions of {I, NI} that exist under a model.
fn existing(model: &Model) -> u32 {
    match model {
        Model::Free => THETA,
        Model::Shafer => EXCLUSIVE,
        Model::Hybrid { empty } => {
            empty.iter().fold(THETA, |regions, element| regions & !(element.0 as u32))
        }
    }
}

impl TryFrom<Opinion> for InterestMass {
    type Error = BeliefError;

    /// Fails with [`BeliefError::OutOfRange`] or [`BeliefError::SumAboveOne`].
    fn try_from(opinion: Opinion) -> Result<Self, BeliefError> {
        let Opinion { paradox, not_interesting, interesting } = opinion;
        let sum = paradox + not_interesting + interesting;
        let rest = 1.0 - sum;
        let ignorance = if rest > ROUNDING { rest } else { 0.0 };
        let mass = Self { interesting, not_interesting, ignorance, paradox };
        mass.check_range()?;
        if rest < -SUM_TOLERANCE {
            return Err(BeliefError::SumAboveOne { sum });
        }
        Ok(mass)
    }
}
