//! Every rule on any frame: all sources at once, in memory that is used again.

use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::proportional::{Shares, pcr6, redistribute, redistribute_whole};
use super::walk::{Odometer, check_products, check_sources};
use super::{Rule, Settings, average, cautious, conjunctive, hybrid};
use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// Combines all sources at once by a rule, on any frame. Without sources the result is vacuous.
///
/// ```
/// # use wisdom_belief::{BeliefError, Frame, MassFunction, Rule, rule};
/// // Zadeh's two physicians: they agree only on what both find unlikely.
/// let frame = Frame::shafer(["meningitis", "concussion", "tumour"])?;
/// let first = MassFunction::parse(&frame, [("meningitis", 0.99), ("tumour", 0.01)])?;
/// let second = MassFunction::parse(&frame, [("concussion", 0.99), ("tumour", 0.01)])?;
/// let fused = rule::combine(Rule::Dempster, &[first, second], &frame)?;
/// assert_eq!(fused.mass(frame.parse("tumour")?), 1.0);
/// # Ok::<(), BeliefError>(())
/// ```
///
/// # Errors
/// As [`Workspace::combine_with`].
pub fn combine<F: Number>(
    rule: Rule,
    sources: &[MassFunction<F>],
    frame: &Frame,
) -> Result<MassFunction<F>, BeliefError> {
    combine_with(rule, sources, frame, &Settings::default())
}

/// [`combine`] with settings: Inagaki's k, weights of a mean, a source model.
///
/// ```
/// # use wisdom_belief::{BeliefError, Frame, MassFunction, Rule, rule::{self, Settings}};
/// // Two witnesses named three suspects; then C is found to have an alibi.
/// let (open, closed) = (
///     Frame::free(["A", "B", "C"])?,
///     Frame::with_empty(["A", "B", "C"], &["A & B", "C"])?,
/// );
/// let sources = [
///     MassFunction::parse(&open, [("A", 0.4_f64), ("C", 0.6)])?,
///     MassFunction::parse(&open, [("B", 0.5), ("C", 0.5)])?,
/// ];
/// let settings = Settings::default().with_source_frame(&open);
/// let fused = rule::combine_with(Rule::Dsmh, &sources, &closed, &settings)?;
/// assert_eq!(closed.print(fused.focal()[0].0), "A");
/// assert!((fused.mass(closed.theta()) - 0.5).abs() < 1e-12); // A and B, C and C
/// # Ok::<(), BeliefError>(())
/// ```
///
/// # Errors
/// As [`Workspace::combine_with`].
pub fn combine_with<F: Number>(
    rule: Rule,
    sources: &[MassFunction<F>],
    frame: &Frame,
    settings: &Settings<'_>,
) -> Result<MassFunction<F>, BeliefError> {
    let mut workspace = Workspace::new();
    workspace.combine_with(rule, sources, frame, settings)?;
    Ok(workspace.fused)
}

/// Combines two sources at a time, from the left to the right: what a program does that hears one source after
/// another. For rules that are not associative the result depends on the order (see each rule's page), and is
/// not that of [`combine`].
///
/// # Errors
/// As [`Workspace::combine_with`]; [`BeliefError::NotWhenFolding`] for weights, which belong to all sources at once,
/// and for a source model, which an intermediate result no longer has.
pub fn fold<F: Number>(
    rule: Rule,
    sources: &[MassFunction<F>],
    frame: &Frame,
    settings: &Settings<'_>,
) -> Result<MassFunction<F>, BeliefError> {
    if settings.weights.is_some() {
        return Err(BeliefError::NotWhenFolding { setting: "weights" });
    }
    if settings.source_frame.is_some() {
        return Err(BeliefError::NotWhenFolding { setting: "a source model" });
    }
    let Some((first, rest)) = sources.split_first() else {
        return Ok(MassFunction::vacuous(frame));
    };
    // One source alone is taken through the rule as well, so that it is checked and, say, normalised.
    let [second, rest @ ..] = rest else {
        return combine_with(rule, sources, frame, settings);
    };
    let mut workspace = Workspace::new();
    let mut pair = [first.clone(), second.clone()];
    pair[0] = workspace.combine_with(rule, &pair, frame, settings)?.clone();
    for next in rest {
        pair[1].clone_from(next);
        let fused = workspace.combine_with(rule, &pair, frame, settings)?;
        pair[0].clone_from(fused);
    }
    let [fused, _] = pair;
    Ok(fused)
}

/// Memory for combining, used again: once it has grown to the size of the work, rules that need no list of
/// their own (`conjunctive`, `dsmc`, `dempster`, `yager`, `dubois-prade`, `pcr5`, `pcr6` among them) allocate
/// nothing.
///
/// ```
/// # use wisdom_belief::{BeliefError, Frame, MassFunction, Rule, rule::Workspace};
/// let frame = Frame::free(["A", "B"])?;
/// let sources = [
///     MassFunction::parse(&frame, [("A", 0.7), ("Theta", 0.3)])?,
///     MassFunction::parse(&frame, [("B", 0.5), ("Theta", 0.5)])?,
/// ];
/// let mut workspace = Workspace::new();
/// let both = frame.parse("A & B")?;
/// assert!((workspace.combine(Rule::Dsmc, &sources, &frame)?.mass(both) - 0.35_f64).abs() < 1e-12);
/// # Ok::<(), BeliefError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Workspace<F = f64> {
    narrow: Engine<u64, F>,
    wide: Engine<u128, F>,
    fused: MassFunction<F>,
}

impl<F: Number> Default for Workspace<F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<F: Number> Workspace<F> {
    /// An empty workspace.
    #[must_use]
    pub fn new() -> Self {
        let fused = MassFunction { focal: Vec::new() };
        Self { narrow: Engine::new(), wide: Engine::new(), fused }
    }

    /// [`combine`] in this workspace.
    ///
    /// # Errors
    /// As [`Workspace::combine_with`].
    pub fn combine(
        &mut self,
        rule: Rule,
        sources: &[MassFunction<F>],
        frame: &Frame,
    ) -> Result<&MassFunction<F>, BeliefError> {
        self.combine_with(rule, sources, frame, &Settings::default())
    }

    /// [`combine_with`] in this workspace.
    ///
    /// # Errors
    /// - [`BeliefError::ForeignElement`] if a source is not of the frame (or of the source frame);
    /// - [`BeliefError::AtomsDiffer`] if the source frame has other atoms;
    /// - [`BeliefError::NotFreeModel`] for `dsmc` where some intersection is empty;
    /// - [`BeliefError::MassOnEmpty`] if a source has mass on ∅ and the rule gives that no meaning;
    /// - [`BeliefError::TotalConflict`] where a rule divides by what survives, and nothing does: `dempster`,
    ///   `zhang`, `jaccard-centre`, and `murphy` and `deng` where all mass is on ∅;
    /// - [`BeliefError::Dogmatic`] for `cautious` if a source has no mass on Θ, [`BeliefError::Normal`] for `bold`
    ///   if one has none on ∅;
    /// - [`BeliefError::Parameter`] for a setting out of range;
    /// - [`BeliefError::TooManyProducts`] or [`BeliefError::TooManySources`] for a rule that visits every product of focal elements,
    ///   [`BeliefError::TooManyElements`] where so many come up that nobody could use them.
    pub fn combine_with(
        &mut self,
        rule: Rule,
        sources: &[MassFunction<F>],
        frame: &Frame,
        settings: &Settings<'_>,
    ) -> Result<&MassFunction<F>, BeliefError> {
        if rule == Rule::Dsmc && !frame.is_free() {
            return Err(BeliefError::NotFreeModel { atoms: frame.atoms().join(", ") });
        }
        let fused = &mut self.fused.focal;
        if frame.theta().0 >> u64::BITS == 0 {
            self.narrow.combine(rule, sources, frame, settings, fused)?;
        } else {
            self.wide.combine(rule, sources, frame, settings, fused)?;
        }
        Ok(&self.fused)
    }
}

/// The rules on masks of one width, and what they write on.
#[derive(Debug, Clone)]
struct Engine<M, F> {
    bodies: Bodies<M, F>,
    sums: Accumulator<M, F>,
    so_far: Vec<(M, F)>,
    odometer: Odometer<M, F>,
    shares: Shares<M, F>,
    bins: Vec<u8>,
}

impl<M: Mask, F: Number> Engine<M, F> {
    fn new() -> Self {
        Self {
            bodies: Bodies::new(),
            sums: Accumulator::new(),
            so_far: Vec::new(),
            odometer: Odometer::new(),
            shares: Shares::new(),
            bins: Vec::new(),
        }
    }

    fn combine(
        &mut self,
        rule: Rule,
        sources: &[MassFunction<F>],
        frame: &Frame,
        settings: &Settings<'_>,
        fused: &mut Vec<(Element, F)>,
    ) -> Result<(), BeliefError> {
        self.bodies.read(rule, sources, frame, settings, &mut self.sums)?;
        if sources.is_empty() {
            self.sums.clear();
            self.sums.add(M::of(frame.theta()), F::one());
        } else {
            self.fuse(rule, frame, settings)?;
        }
        self.emit(fused);
        Ok(())
    }

    /// Leaves the fused masses in `sums`.
    fn fuse(
        &mut self,
        rule: Rule,
        frame: &Frame,
        settings: &Settings<'_>,
    ) -> Result<(), BeliefError> {
        let theta = M::of(frame.theta());
        let Self { bodies, sums, so_far, odometer, shares, .. } = self;
        if rule.starts_from_meets() {
            conjunctive::gather(bodies.iter(), |x, y| x & y, so_far, sums)?;
        }
        if rule.visits_products() {
            check_products(rule, bodies)?;
        }
        match rule {
            Rule::Dsmc | Rule::Conjunctive => {}
            Rule::Dempster => {
                conjunctive::gather_survivors(bodies.iter(), so_far, sums)?;
                conjunctive::normalise(sums, bodies.len(), rule)?;
            }
            Rule::Yager => conjunctive::inagaki(sums, theta, 0.0)?,
            Rule::Inagaki => conjunctive::inagaki(sums, theta, settings.inagaki_k)?,
            Rule::Disjunctive => conjunctive::gather(bodies.iter(), |x, y| x | y, so_far, sums)?,
            Rule::Zhang => conjunctive::zhang(bodies, theta, so_far, sums)?,
            Rule::Florea => conjunctive::florea(bodies, so_far, sums)?,
            Rule::DuboisPrade => hybrid::dubois_prade(bodies, theta, odometer, sums),
            Rule::Dsmh => hybrid::dsmh(bodies, theta, odometer, sums),
            Rule::Jaccard => hybrid::jaccard(bodies, theta, odometer, sums)?,
            Rule::MinC => hybrid::minc(bodies, theta, odometer, sums),
            Rule::Pcr6 => pcr6(bodies, theta, odometer, shares, sums),
            Rule::Pcr1 | Rule::Pcr2 | Rule::Urr => {
                redistribute_whole(rule, bodies, theta, odometer, shares, sums);
            }
            Rule::Pcr3
            | Rule::Pcr4
            | Rule::Pcr5
            | Rule::Pcr5Plus
            | Rule::Pcr5Canonical
            | Rule::Pcr6Plus
            | Rule::Pcr6Canonical
            | Rule::Purr => redistribute(rule, bodies, theta, odometer, shares, sums),
            Rule::Average => {
                average::average(bodies, &average::weights(bodies.len(), settings)?, sums);
            }
            Rule::Murphy => {
                average::average(bodies, &vec![F::one(); bodies.len()], sums);
                average::with_itself(rule, bodies.len(), so_far, sums)?;
            }
            Rule::Deng => {
                check_sources(rule, bodies.len())?;
                average::average(bodies, &average::credibility(bodies), sums);
                average::with_itself(rule, bodies.len(), so_far, sums)?;
            }
            Rule::Cautious | Rule::Bold => {
                let read: Vec<_> = bodies.mass_functions().collect();
                let fused = match rule {
                    Rule::Cautious => cautious::cautious(&read, frame)?,
                    _ => cautious::bold(&read, frame)?,
                };
                sums.clear();
                fused.focal().iter().for_each(|&(element, mass)| sums.add(M::of(element), mass));
            }
        }
        Ok(())
    }

    /// Writes what was added up in the order of elements: sorted into as many bins as an element can have
    /// regions, whose few elements each find their place among those before them at once.
    fn emit(&mut self, fused: &mut Vec<(Element, F)>) {
        let Self { sums, so_far: sorted, bins, .. } = self;
        let mut ends = [0_u32; u8::MAX as usize + 1];
        bins.clear();
        bins.extend(sums.entries().iter().map(|&(element, _)| {
            let bin = element.cardinality() as u8;
            ends[bin as usize] += 1;
            bin
        }));
        let mut end = 0;
        for bin in &mut ends[..=M::BITS] {
            (*bin, end) = (end, end + *bin);
        }
        sorted.clear();
        sorted.resize(end as usize, (M::EMPTY, F::zero()));
        for (&entry, &bin) in sums.entries().iter().zip(bins.iter()) {
            let end = &mut ends[bin as usize];
            sorted[*end as usize] = entry;
            *end += 1;
        }
        let mut start = 0;
        for &end in &ends[..=M::BITS] {
            let end = end as usize;
            if end - start > 1 {
                sorted[start..end].sort_unstable_by_key(|&(element, _)| element);
            }
            start = end;
        }
        fused.clear();
        let mut all_above_zero = true;
        fused.extend(sorted.iter().map(|&(element, mass)| {
            all_above_zero &= mass > F::zero();
            (element.element(), mass)
        }));
        if !all_above_zero {
            fused.retain(|&(_, mass)| mass > F::zero());
        }
    }
}

impl Rule {
    /// Whether sources may commit mass to ∅, as in an open world.
    pub(super) const fn takes_mass_on_empty(self) -> bool {
        matches!(
            self,
            Self::Conjunctive
                | Self::Dempster
                | Self::Disjunctive
                | Self::Average
                | Self::Murphy
                | Self::Cautious
                | Self::Bold
        )
    }

    /// Whether the rule begins with the products that meet, and K on ∅.
    const fn starts_from_meets(self) -> bool {
        !matches!(
            self,
            Self::Dempster
                | Self::Disjunctive
                | Self::Zhang
                | Self::Florea
                | Self::Jaccard
                | Self::Average
                | Self::Murphy
                | Self::Deng
                | Self::Cautious
                | Self::Bold
        )
    }

    /// Whether the rule visits every choice of one focal element from each source.
    pub(super) const fn visits_products(self) -> bool {
        matches!(
            self,
            Self::DuboisPrade
                | Self::Dsmh
                | Self::Jaccard
                | Self::MinC
                | Self::Pcr2
                | Self::Pcr3
                | Self::Pcr4
                | Self::Pcr5
                | Self::Pcr6
                | Self::Pcr5Plus
                | Self::Pcr6Plus
                | Self::Pcr5Canonical
                | Self::Pcr6Canonical
                | Self::Purr
        )
    }
}
