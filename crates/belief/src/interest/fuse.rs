//! One cell: all its sources at once, in closed form.

use super::closed::{ClosedForm, Masses, Outcome, Sources, Visitor};
use crate::{BeliefError, InterestMass, MAX_SOURCES, Number, ParadoxPolicy, Rule, Settings};

/// What all sources together say of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fused<F = f64> {
    /// The fused masses. Under a rule on Shafer's model the paradox is m(∅), which only `conjunctive`, `cautious`,
    /// `bold` and, of sources with such a mass, `disjunctive` and `average` leave above 0.
    pub mass: InterestMass<F>,
    /// K: the mass that falls on ∅ when all sources are intersected, before the rule deals with it; 0 under
    /// `dsmc`, where nothing is empty.
    ///
    /// 1 is total conflict: nothing survives. Rules that are undefined there (`dempster`, `minc`, `zhang`,
    /// `jaccard-centre`, and `murphy` and `deng` of sources that are all ∅) then give the vacuous mass. So do `cautious` if a
    /// source leaves nothing on I ∪ NI, and `bold` if one has nothing on ∅; they too say 1 there.
    pub conflict: F,
}

impl Rule {
    /// Fuses all sources of one cell at once; the same as [`combine`](crate::rule::combine) on {I, NI} under
    /// [`Rule::model`]. The policy is applied to each source if that model is Shafer's; a policy that the rule
    /// does not [admit](Rule::admits) counts as [`ParadoxPolicy::ToIgnorance`]. No sources: vacuous.
    ///
    /// The cost grows with the number of sources; with 3 to its power under `pcr5`, `pcr5-plus` and
    /// `pcr5-canonical`, which should not be given more than [`MAX_SOURCES`]. `pcr6`, `pcr6-plus` and
    /// `pcr6-canonical` take any number: above [`MAX_SOURCES`] by an integral that errs by less than 1e-12.
    ///
    /// ```
    /// # use wisdom_belief::{InterestMass, Opinion, ParadoxPolicy, Rule};
    /// // Paper Tables 4 and 5: flat ground (dull) with a very interesting texture.
    /// let sure = 0.99;
    /// let sources = [
    ///     InterestMass::try_from(Opinion { interesting: sure, ..Opinion::default() })?,
    ///     InterestMass::try_from(Opinion { not_interesting: sure, ..Opinion::default() })?,
    /// ];
    /// let belief = |rule: Rule| rule.fuse(&sources, ParadoxPolicy::ToIgnorance).mass.belief();
    /// assert!((belief(Rule::Dsmc) - 0.99).abs() < 1e-12);
    /// assert!((belief(Rule::Dempster) - 0.4975).abs() < 1e-4);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    #[must_use]
    pub fn fuse<F: Number>(self, sources: &[InterestMass<F>], policy: ParadoxPolicy) -> Fused<F> {
        let policy = if self.admits(policy) { policy } else { ParadoxPolicy::ToIgnorance };
        self.fuse_admitted(sources, policy, &Settings::default())
    }

    /// As [`Rule::fuse`], with settings: Inagaki's k (finite and not negative; one beyond the cell's limit counts
    /// as the limit) and the weights of the average. [`Settings::source_frame`] has no meaning here: that
    /// sources are given on the free model is said by [`ParadoxPolicy::KeepForDsmh`].
    ///
    /// # Errors
    /// [`BeliefError::PolicyNotAdmitted`], [`BeliefError::Parameter`], or [`BeliefError::TooManySources`] for the
    /// rules that visit 3^S assignments.
    pub fn fuse_with<F: Number>(
        self,
        sources: &[InterestMass<F>],
        policy: ParadoxPolicy,
        settings: &Settings<'_>,
    ) -> Result<Fused<F>, BeliefError> {
        self.check_call(sources.len(), policy, settings)?;
        Ok(self.fuse_admitted(sources, policy, settings))
    }

    /// Whether the rule gives the policy a meaning: [`ParadoxPolicy::KeepForDsmh`] only `dsmh`;
    /// [`ParadoxPolicy::ToEmpty`] only rules that know what to do with a source's mass on ∅ (`conjunctive`,
    /// `dempster`, `disjunctive`, `cautious`, `bold`, `average`, `murphy`); `bold` no other. `dsmc`, which
    /// keeps all paradox, is indifferent to the rest.
    #[must_use]
    pub const fn admits(self, policy: ParadoxPolicy) -> bool {
        match policy {
            ParadoxPolicy::KeepForDsmh => matches!(self, Self::Dsmh),
            ParadoxPolicy::ToEmpty => matches!(
                self,
                Self::Conjunctive
                    | Self::Dempster
                    | Self::Disjunctive
                    | Self::Cautious
                    | Self::Bold
                    | Self::Average
                    | Self::Murphy
            ),
            _ => !matches!(self, Self::Bold),
        }
    }

    /// Whether maps can be made with the rule: not with `bold`, since each of its sources must doubt the frame
    /// itself (m(∅) > 0), which no source does of a cell that it has not seen.
    #[must_use]
    pub const fn on_maps(self) -> bool {
        !matches!(self, Self::Bold)
    }

    /// Whether the rule visits all 3^S assignments, at any number of sources.
    const fn is_exponential(self) -> bool {
        matches!(self, Self::Pcr5 | Self::Pcr5Plus | Self::Pcr5Canonical)
    }

    /// What can be wrong with a call, whatever the masses.
    pub(crate) fn check_call(
        self,
        sources: usize,
        policy: ParadoxPolicy,
        settings: &Settings<'_>,
    ) -> Result<(), BeliefError> {
        if !self.admits(policy) {
            return Err(BeliefError::PolicyNotAdmitted { rule: self, policy });
        }
        if self.is_exponential() && sources > MAX_SOURCES {
            return Err(BeliefError::TooManySources { sources, limit: MAX_SOURCES, rule: self });
        }
        match self {
            Self::Inagaki => settings.check_inagaki_k(),
            Self::Average => settings.check_weights(sources),
            _ => Ok(()),
        }
    }

    fn fuse_admitted<F: Number>(
        self,
        sources: &[InterestMass<F>],
        policy: ParadoxPolicy,
        settings: &Settings<'_>,
    ) -> Fused<F> {
        if sources.is_empty() {
            return Fused { mass: InterestMass::vacuous(), conflict: F::zero() };
        }
        let policy = (self != Self::Dsmc).then_some(policy);
        self.closed_form(settings, Cell { sources, policy })
    }
}

/// The sources of one cell, and what their paradox means (nothing special, if there is no policy).
#[derive(Clone, Copy)]
struct Cell<'a, F> {
    sources: &'a [InterestMass<F>],
    policy: Option<ParadoxPolicy>,
}

impl<F: Number> Sources<F> for Cell<'_, F> {
    const MAP: bool = false;

    #[inline]
    fn count(&self) -> usize {
        self.sources.len()
    }

    #[inline]
    fn masses(&self, source: usize) -> Masses<F> {
        let source = self.sources[source];
        self.policy.map_or(source, |policy| policy.apply(source)).masses()
    }
}

impl<'a, F: Number> Visitor<'a> for Cell<'_, F> {
    type Output = Fused<F>;

    fn visit(self, form: impl ClosedForm + 'a) -> Fused<F> {
        let Outcome { masses, conflict } = form.fuse(&self);
        Fused { mass: InterestMass::from_array(masses), conflict }
    }
}
