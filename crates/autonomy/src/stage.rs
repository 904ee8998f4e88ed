//! The stages that a decision goes through, for those who hold a clock.

use std::fmt;

/// A part of the work between an observation and the decision that follows, in the order of the work.
///
/// The core knows no clock: [`Autonomy::observe_watched`](crate::Autonomy::observe_watched) and
/// [`Autonomy::decide_watched`](crate::Autonomy::decide_watched) say when a stage has ended, and what listens may look
/// at its watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Readings are checked and taken in.
    Readings,
    /// Measured layers are put together, and others derived from elevation.
    Layers,
    /// Every expert judges every cell.
    Masses,
    /// The masses are fused.
    Fusion,
    /// Interest becomes prizes, and their maxima sites.
    Sites,
    /// The ground is judged as the vehicle meets it.
    Traversability,
    /// What the observation says that a decision should know of.
    Triggers,
    /// Goals are revised after the sites.
    Goals,
    /// The most reliable way from the rover to every cell.
    Reach,
    /// Poses from which each goal can be done.
    Poses,
    /// Ways between the poses of the goals to be sequenced.
    Travel,
    /// The best ordered sets of goals, and the front of each order.
    Sequences,
    /// Every goal gets its verdict, with the numbers behind it.
    Verdicts,
    /// Plans are laid out and validated, and one gives the next act.
    Family,
    /// The digests of the record.
    Digests,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Self; 15] = [
        Self::Readings,
        Self::Layers,
        Self::Masses,
        Self::Fusion,
        Self::Sites,
        Self::Traversability,
        Self::Triggers,
        Self::Goals,
        Self::Reach,
        Self::Poses,
        Self::Travel,
        Self::Sequences,
        Self::Verdicts,
        Self::Family,
        Self::Digests,
    ];
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Readings => "readings",
            Self::Layers => "layers",
            Self::Masses => "masses",
            Self::Fusion => "fusion",
            Self::Sites => "sites",
            Self::Traversability => "traversability",
            Self::Triggers => "triggers",
            Self::Goals => "goals",
            Self::Reach => "reach",
            Self::Poses => "poses",
            Self::Travel => "travel",
            Self::Sequences => "sequences",
            Self::Verdicts => "verdicts",
            Self::Family => "family",
            Self::Digests => "digests",
        })
    }
}

/// Whoever wants to know when a stage has ended. It hears of it and changes nothing.
pub type Watch<'a> = &'a mut dyn FnMut(Stage);
