//! Fuses the sources of a whole map.

use super::MapNumber;
use super::belief::DsmcBelief;
use super::number::{Instructions, Job};
use super::outputs::Outputs;
use super::source::{BLOCK, Cells, Planes, Room, Source, Step, Wanted, sweep_again};
use super::width::Width;
use crate::interest::closed::{ClosedForm, Outcome, Visitor};
use crate::{BeliefError, Number, ParadoxPolicy, Rule, Settings};

/// The most sources of a map. (The rules that visit 3^S assignments take [`MAX_SOURCES`](crate::MAX_SOURCES).)
pub const MAX_MAP_SOURCES: usize = 16;

/// Sources up to this number are looked up with little room to prepare.
const FEW_SOURCES: usize = 4;

/// Fuses all sources of every cell by a rule, and writes what is asked for.
///
/// Each cell is what [`Rule::fuse_with`] makes of it, but for rounding: within 1e-6 in single precision, a few
/// units in the last place in double. Where that is undefined, the masses are vacuous and K is 1. No sources:
/// vacuous everywhere.
///
/// # Errors
/// [`BeliefError::NotOnMaps`], [`BeliefError::PlaneLength`], [`BeliefError::BandBounds`],
/// [`BeliefError::TooManySources`], and those of [`Rule::fuse_with`].
pub fn fuse<F: MapNumber>(
    rule: Rule,
    sources: &[Source<'_, F>],
    policy: ParadoxPolicy,
    settings: &Settings<'_>,
    outputs: Outputs<'_, F>,
) -> Result<(), BeliefError> {
    fuse_by(Instructions::widest(), rule, sources, policy, settings, outputs)
}

/// [`fuse`] with given instructions.
pub(super) fn fuse_by<F: MapNumber>(
    instructions: Instructions,
    rule: Rule,
    sources: &[Source<'_, F>],
    policy: ParadoxPolicy,
    settings: &Settings<'_>,
    outputs: Outputs<'_, F>,
) -> Result<(), BeliefError> {
    let cells = check(rule, sources, policy, settings, &outputs)?;
    if sources.is_empty() {
        instructions.run(cells, Unknown { outputs, cells, free: rule == Rule::Dsmc });
        return Ok(());
    }
    let policy = (rule != Rule::Dsmc).then_some(policy);
    let call = Call { instructions, rule, sources, policy, settings };
    if sources.len() <= FEW_SOURCES {
        call.by_blocks::<FEW_SOURCES>(cells, outputs);
    } else {
        call.by_blocks::<MAX_MAP_SOURCES>(cells, outputs);
    }
    Ok(())
}

fn check<F: MapNumber>(
    rule: Rule,
    sources: &[Source<'_, F>],
    policy: ParadoxPolicy,
    settings: &Settings<'_>,
    outputs: &Outputs<'_, F>,
) -> Result<usize, BeliefError> {
    if !rule.on_maps() {
        return Err(BeliefError::NotOnMaps { rule });
    }
    rule.check_call(sources.len(), policy, settings)?;
    if sources.len() > MAX_MAP_SOURCES {
        let (sources, limit) = (sources.len(), MAX_MAP_SOURCES);
        return Err(BeliefError::TooManySources { sources, limit, rule });
    }
    let cells = sources.first().map(Source::cells).or(outputs.cells()).unwrap_or(0);
    sources.iter().enumerate().try_for_each(|(index, source)| source.check(index, cells))?;
    outputs.check(cells)?;
    Ok(cells)
}

/// A checked call.
struct Call<'a, 's, F> {
    instructions: Instructions,
    rule: Rule,
    sources: &'a [Source<'a, F>],
    /// None on the free model.
    policy: Option<ParadoxPolicy>,
    settings: &'a Settings<'s>,
}

impl<F: MapNumber> Call<'_, '_, F> {
    /// Fuses N sources or fewer. Planes are taken where they are; everything else is looked up a block at a
    /// time.
    fn by_blocks<const N: usize>(&self, cells: usize, mut outputs: Outputs<'_, F>) {
        let all_planes = self.sources.iter().all(|source| matches!(source, Source::Planes(_)));
        let block = if all_planes { cells.max(1) } else { BLOCK };
        let mut room = [[[F::zero(); BLOCK]; 3]; N];
        for from in (0..cells).step_by(block) {
            let to = (from + block).min(cells);
            self.fuse_block([from, to], &mut room, outputs.window(from, to));
        }
    }

    fn fuse_block<const N: usize>(
        &self,
        block: [usize; 2],
        room: &mut [Room<F>; N],
        outputs: Outputs<'_, F>,
    ) {
        let (instructions, sources, cells) = (self.instructions, self.sources, block[1] - block[0]);
        let wanted = match self.policy {
            None if outputs.belief_alone() => Wanted::Supporting,
            Some(ParadoxPolicy::ToIgnorance) => Wanted::Opinion,
            _ => Wanted::Paradox,
        };
        if sources.iter().any(|source| !matches!(source, Source::Planes(_))) {
            instructions.run(cells, LookUp { sources, block, wanted, room });
        }
        let nothing = Planes { interesting: &[], not_interesting: &[], paradox: None };
        let mut planes = [nothing; N];
        for ((slot, source), room) in planes.iter_mut().zip(sources).zip(&*room) {
            *slot = source.planes(block, room, wanted);
        }
        let planes = &planes[..sources.len()];
        match outputs.belief {
            Some(belief) if wanted == Wanted::Supporting => {
                instructions.run(cells, DsmcBelief { planes, belief });
            }
            _ => {
                let fusion = Fusion { instructions, planes, policy: self.policy, outputs, cells };
                F::fuse_planes(fusion, self.rule, self.settings);
            }
        }
    }
}

/// Looks up a block of every source.
struct LookUp<'a, F> {
    sources: &'a [Source<'a, F>],
    block: [usize; 2],
    wanted: Wanted,
    room: &'a mut [Room<F>],
}

impl<F: MapNumber> Job<F> for LookUp<'_, F> {
    #[inline(always)]
    fn run<W: Width<F>>(self, width: W) {
        for (source, room) in self.sources.iter().zip(self.room) {
            source.look_up(width, self.block, room, self.wanted);
        }
    }
}

/// Planes to be fused, before the rule's closed form is known; then with it.
pub struct Fusion<'a, F> {
    instructions: Instructions,
    planes: &'a [Planes<'a, F>],
    policy: Option<ParadoxPolicy>,
    outputs: Outputs<'a, F>,
    cells: usize,
}

impl<'a, F: MapNumber> Visitor<'a> for Fusion<'_, F> {
    type Output = ();

    fn visit(self, form: impl ClosedForm + 'a) {
        let Self { instructions, planes, policy, outputs, cells } = self;
        instructions.run(cells, Fuse { form, planes, policy, outputs, cells });
    }
}

/// Fuses planes of masses.
struct Fuse<'a, F, C> {
    form: C,
    planes: &'a [Planes<'a, F>],
    policy: Option<ParadoxPolicy>,
    outputs: Outputs<'a, F>,
    cells: usize,
}

impl<F: MapNumber, C: ClosedForm> Job<F> for Fuse<'_, F, C> {
    #[inline(always)]
    fn run<W: Width<F>>(self, width: W) {
        sweep_again(width, self.cells, self);
    }
}

impl<F: Number, C: ClosedForm> Step<F> for Fuse<'_, F, C> {
    #[inline(always)]
    fn step<W: Width<F>>(&mut self, width: W, at: usize) {
        let cells = Cells { width, planes: self.planes, policy: self.policy, at };
        let outcome = self.form.fuse(&cells);
        if let Some(belief) = &mut self.outputs.belief {
            width.store(self.form.belief(&cells, outcome.masses), belief, at);
        }
        self.outputs.write(width, at, outcome, C::FREE);
    }
}

/// Writes that nothing is known.
struct Unknown<'a, F> {
    outputs: Outputs<'a, F>,
    cells: usize,
    free: bool,
}

impl<F: MapNumber> Job<F> for Unknown<'_, F> {
    #[inline(always)]
    fn run<W: Width<F>>(self, width: W) {
        sweep_again(width, self.cells, self);
    }
}

impl<F: Number> Step<F> for Unknown<'_, F> {
    #[inline(always)]
    fn step<W: Width<F>>(&mut self, width: W, at: usize) {
        let (zero, one) = (width.splat(F::zero()), width.splat(F::one()));
        if let Some(belief) = &mut self.outputs.belief {
            width.store(zero, belief, at);
        }
        let outcome = Outcome { masses: [zero, zero, one, zero], conflict: zero };
        self.outputs.write(width, at, outcome, self.free);
    }
}
