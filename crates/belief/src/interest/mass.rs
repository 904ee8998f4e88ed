//! Four masses: what one source, or all of them together, say of the interest of one cell.

use crate::number::sum;
use crate::{
    BeliefError, Element, Frame, MassFunction, Model, Number, SUM_TOLERANCE, mass::in_range,
    measure::share,
};

/// Ignorance below this is the rounding of decimals, as in 1 − (0.3 + 0.6 + 0.1), and counts as none.
pub(crate) const ROUNDING: f64 = 1e-12;

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
/// [`ParadoxPolicy`](crate::ParadoxPolicy) but `KeepForDsmh` and `ToEmpty` was applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterestMass<F = f64> {
    pub(crate) interesting: F,
    pub(crate) not_interesting: F,
    pub(crate) ignorance: F,
    pub(crate) paradox: F,
}

impl InterestMass {
    /// Nothing is known: all mass on I ∪ NI. (Of other numbers: [`InterestMass::vacuous`].)
    pub const VACUOUS: Self =
        Self { interesting: 0.0, not_interesting: 0.0, ignorance: 1.0, paradox: 0.0 };

    /// The mass function of an opinion and its ignorance, which must sum to 1 within [`SUM_TOLERANCE`].
    /// (An opinion alone, whose rest is ignorance, converts by `try_from`.)
    ///
    /// # Errors
    /// [`BeliefError::OutOfRange`] or [`BeliefError::SumNotOne`].
    pub fn new(opinion: Opinion, ignorance: f64) -> Result<Self, BeliefError> {
        let Opinion { paradox, not_interesting, interesting } = opinion;
        Self::from_masses([interesting, not_interesting, ignorance, paradox])
    }
}

impl<F: Number> InterestMass<F> {
    /// Nothing is known: all mass on I ∪ NI.
    #[must_use]
    pub fn vacuous() -> Self {
        Self::from_array([F::zero(), F::zero(), F::one(), F::zero()])
    }

    /// The mass function of m(I), m(NI), m(I ∪ NI), m(I ∩ NI), in this order, which must sum to 1 within
    /// [`Number::SUM_TOLERANCE`].
    ///
    /// # Errors
    /// [`BeliefError::OutOfRange`] or [`BeliefError::SumNotOne`].
    pub fn from_masses(masses: [F; 4]) -> Result<Self, BeliefError> {
        let mass = Self::from_array(masses);
        mass.check_range()?;
        let [i, n, u, p] = masses;
        let sum = (p + n + i + u).to_f64();
        if (sum - 1.0).abs() > F::SUM_TOLERANCE {
            return Err(BeliefError::SumNotOne { sum });
        }
        Ok(mass)
    }

    pub(crate) fn from_array([interesting, not_interesting, ignorance, paradox]: [F; 4]) -> Self {
        Self { interesting, not_interesting, ignorance, paradox }
    }

    /// m(I), m(NI), m(I ∪ NI), m(I ∩ NI), in this order.
    #[must_use]
    pub fn masses(&self) -> [F; 4] {
        [self.interesting, self.not_interesting, self.ignorance, self.paradox]
    }

    /// The same masses as other numbers, each rounded to the nearest.
    #[must_use]
    pub fn to<G: Number>(self) -> InterestMass<G> {
        InterestMass::from_array(self.masses().map(|mass| G::from_f64(mass.to_f64())))
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
                Err(BeliefError::OutOfRange { element: element.to_owned(), mass: mass.to_f64() })
            }
        }
    }

    /// m(I).
    #[must_use]
    pub const fn interesting(&self) -> F {
        self.interesting
    }

    /// m(NI).
    #[must_use]
    pub const fn not_interesting(&self) -> F {
        self.not_interesting
    }

    /// m(I ∪ NI).
    #[must_use]
    pub const fn ignorance(&self) -> F {
        self.ignorance
    }

    /// m(I ∩ NI).
    #[must_use]
    pub const fn paradox(&self) -> F {
        self.paradox
    }

    /// Bel(I) = m(I) + m(I ∩ NI) on the free model (paper Eq. 3). On Shafer's model it is the same where no mass
    /// is left on ∅; see [`InterestMass::belief_under`].
    #[must_use]
    pub fn belief(&self) -> F {
        self.interesting + self.paradox
    }

    /// Bel(I) under a model (paper Eq. 3): on Shafer's only m(I), since ∅ supports nothing.
    #[must_use]
    pub fn belief_under(&self, model: &Model) -> F {
        let implies = |x: u32| if x & !I == 0 { F::one() } else { F::zero() };
        self.sum_over(existing(model), implies)
    }

    /// Pl(I) under a model (paper Eq. 3): always 1 on the free one, m(I) + m(I ∪ NI) on Shafer's.
    #[must_use]
    pub fn plausibility(&self, model: &Model) -> F {
        match model {
            Model::Free => F::one(),
            _ => self.sum_over(existing(model), |x| F::count((x & I).min(1))),
        }
    }

    /// BetP(I) under a model: on the free one m(I ∩ NI) + m(I) + m(NI)/2 + 2 m(I ∪ NI)/3, on Shafer's
    /// m(I) + m(I ∪ NI)/2, without the mass of elements that the model empties (Smets 1994; Dezert and
    /// Smarandache 2004). 0 if that is all mass.
    #[must_use]
    pub fn pignistic(&self, model: &Model) -> F {
        self.spread(existing(model), even_part)
    }

    /// `DSmP_ε(I)` under a model (Dezert and Smarandache 2008), ε ≥ 0: as [`MassFunction::dsmp`].
    #[must_use]
    pub fn dsmp(&self, model: &Model, epsilon: F) -> F {
        let exists = existing(model);
        let weight = |x: u32| {
            let single = |b: u32| {
                if b.is_power_of_two() && b & !x == 0 { F::one() } else { F::zero() }
            };
            self.sum_over(exists, single) + epsilon * F::count(x.count_ones())
        };
        self.spread(exists, |x| {
            let whole = weight(x);
            if whole > F::zero() { weight(x & I) / whole } else { even_part(x) }
        })
    }

    /// The same masses on a frame made by [`Frame::interest`]; what the frame empties goes to ∅.
    ///
    /// # Errors
    /// [`BeliefError::FrameSize`] if the frame has not two atoms.
    pub fn mass_function(&self, frame: &Frame) -> Result<MassFunction<F>, BeliefError> {
        let (Some(i), Some(ni), 2) = (frame.atom(0), frame.atom(1), frame.atoms().len()) else {
            return Err(BeliefError::FrameSize { atoms: frame.atoms().len(), limit: 2 });
        };
        let mut masses = std::collections::BTreeMap::<Element, F>::new();
        for (element, mass) in [
            (i, self.interesting),
            (ni, self.not_interesting),
            (i | ni, self.ignorance),
            (i & ni, self.paradox),
        ] {
            *masses.entry(element).or_insert_with(F::zero) += mass;
        }
        Ok(MassFunction::from_map(masses))
    }

    /// The sum of the masses of the non-empty elements, each times its part.
    fn sum_over(&self, exists: u32, part: impl Fn(u32) -> F) -> F {
        let masses = [
            (PARADOX, self.paradox),
            (I, self.interesting),
            (NI, self.not_interesting),
            (THETA, self.ignorance),
        ];
        let possible = masses.into_iter().filter(|(x, mass)| x & exists != 0 && *mass > F::zero());
        sum(possible.map(|(x, mass)| mass * part(x & exists)))
    }

    fn spread(&self, exists: u32, part: impl Fn(u32) -> F) -> F {
        let sum = self.sum_over(exists, part);
        if exists & PARADOX != 0 || self.paradox == F::zero() && exists == EXCLUSIVE {
            return sum;
        }
        share(sum, self.sum_over(exists, |_| F::one()))
    }
}

/// The share of an element's Venn regions that lie in I.
fn even_part<F: Number>(x: u32) -> F {
    F::count((x & I).count_ones()) / F::count(x.count_ones())
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
