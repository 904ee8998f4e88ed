//! Goals and what becomes of them.

use std::fmt;

use wisdom_grid::Cell;

/// A goal's name for life, written `G7`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GoalId(pub u32);

impl fmt::Display for GoalId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{}", self.0)
    }
}

/// A site with a directive: something to do somewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Goal {
    /// Its name.
    pub id: GoalId,
    /// The directive it follows, by index.
    pub directive: usize,
    /// The cell it is about (not where the rover will stand).
    pub target: Cell,
    /// Interest at the target when last weighed.
    pub interest: f64,
    /// Directive weight times the prize at the target, quantised.
    pub prize: f64,
    /// Prominence of its site, on the prize scale.
    pub prominence: f64,
    /// Ignorance m(I ∪ NI) at the target.
    pub ignorance: f64,
    /// Paradox m(I ∩ NI) at the target.
    pub paradox: f64,
    /// Share of each expert in the interest; sums to one, or all zero where there is no interest.
    pub credit: Vec<f64>,
    /// Cells in its site's region.
    pub region_cells: usize,
    /// Failed tries so far, of its own or at its place before it.
    pub attempts: u32,
    /// The decision that formulated it.
    pub born: u32,
    /// Where it stands in its life.
    pub status: Status,
}

/// Where a goal stands in its life (after Roberts et al. 2014).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Status {
    /// Known, in no sequence.
    Formulated,
    /// In the committed sequence.
    Committed,
    /// Done.
    Achieved,
    /// Given up; see the verdict that dropped it.
    Dropped,
}

impl Status {
    /// Every status.
    pub const ALL: [Self; 4] = [Self::Formulated, Self::Committed, Self::Achieved, Self::Dropped];

    /// Whether the goal can still be pursued.
    #[must_use]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Formulated | Self::Committed)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Formulated => "formulated",
            Self::Committed => "committed",
            Self::Achieved => "achieved",
            Self::Dropped => "dropped",
        })
    }
}

/// What a deliberation did with a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Action {
    /// Entered the sequence.
    Add,
    /// Stays in the sequence as it was.
    Keep,
    /// Stays in the sequence, changed.
    Modify,
    /// Stays in the sequence, in another order.
    Reorder,
    /// Is known, and not in the sequence.
    Defer,
    /// Is given up.
    Drop,
    /// Is done.
    Achieve,
}

impl Action {
    /// Every action.
    pub const ALL: [Self; 7] = [
        Self::Add,
        Self::Keep,
        Self::Modify,
        Self::Reorder,
        Self::Defer,
        Self::Drop,
        Self::Achieve,
    ];
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Add => "add",
            Self::Keep => "keep",
            Self::Modify => "modify",
            Self::Reorder => "reorder",
            Self::Defer => "defer",
            Self::Drop => "drop",
            Self::Achieve => "achieve",
        })
    }
}

/// Why the action was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Reason {
    /// A maximum that no known goal explains.
    NewMaximum,
    /// A place given up before, on trial again because its ground changed.
    Reopened,
    /// A known goal that the best sequence now contains.
    Promoted,
    /// Nothing about it changed enough.
    Unchanged,
    /// Its maximum moved to another cell.
    PeakMoved,
    /// It follows a weaker directive after a failed try.
    Eroded,
    /// The best sequence visits it at another turn.
    BetterOrder,
    /// It does not fit the remaining time.
    Time,
    /// It does not fit the remaining energy.
    Energy,
    /// It does not fit the remaining data volume.
    Data,
    /// It would take the plan below the reliability floor.
    Risk,
    /// Other goals are worth more together.
    Outweighed,
    /// With it the plan would be better, but not by enough to change the committed sequence.
    Held,
    /// With it the plan would be better, but the search ended before it met that.
    SearchCut,
    /// Its bound was not among those of the goals sequenced.
    BeyondExact,
    /// No pose from which it can be done is reachable.
    Unreachable,
    /// Its operators or required facts cannot be brought about.
    Preconditions,
    /// Its interest is gone.
    LostInterest,
    /// It is as interesting as before, but no longer a maximum.
    NoMaximum,
    /// Its place lies beyond the map that the rover works on, which moved on with it.
    OffMap,
    /// Another goal stands for its maximum now.
    Merged,
    /// All its tries failed.
    AttemptsSpent,
    /// An achieved goal explains the place.
    Explained,
    /// A goal of the sequence stands so near that doing it will explain the place.
    Excluded,
    /// Its operators were carried out.
    Done,
}

impl Reason {
    /// Every reason.
    pub const ALL: [Self; 25] = [
        Self::NewMaximum,
        Self::Reopened,
        Self::Promoted,
        Self::Unchanged,
        Self::PeakMoved,
        Self::Eroded,
        Self::BetterOrder,
        Self::Time,
        Self::Energy,
        Self::Data,
        Self::Risk,
        Self::Outweighed,
        Self::Held,
        Self::SearchCut,
        Self::BeyondExact,
        Self::Unreachable,
        Self::Preconditions,
        Self::LostInterest,
        Self::NoMaximum,
        Self::OffMap,
        Self::Merged,
        Self::AttemptsSpent,
        Self::Explained,
        Self::Excluded,
        Self::Done,
    ];
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NewMaximum => "new-maximum",
            Self::Reopened => "reopened",
            Self::Promoted => "promoted",
            Self::Unchanged => "unchanged",
            Self::PeakMoved => "peak-moved",
            Self::Eroded => "eroded",
            Self::BetterOrder => "better-order",
            Self::Time => "time",
            Self::Energy => "energy",
            Self::Data => "data",
            Self::Risk => "risk",
            Self::Outweighed => "outweighed",
            Self::Held => "held",
            Self::SearchCut => "search-cut",
            Self::BeyondExact => "beyond-exact",
            Self::Unreachable => "unreachable",
            Self::Preconditions => "preconditions",
            Self::LostInterest => "lost-interest",
            Self::NoMaximum => "no-maximum",
            Self::OffMap => "off-map",
            Self::Merged => "merged",
            Self::AttemptsSpent => "attempts-spent",
            Self::Explained => "explained",
            Self::Excluded => "excluded",
            Self::Done => "done",
        })
    }
}

/// What brought the change about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The first deliberation: everything is new.
    Start,
    /// What the instruments showed since the last decision.
    Discovery,
    /// What the rover did or spent since the last decision.
    Execution,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Discovery => "discovery",
            Self::Execution => "execution",
        })
    }
}

/// A number that was compared, and what with.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What the number is, with its unit.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// What it was compared with, if anything.
    pub limit: Option<f64>,
}

impl Term {
    /// A number on its own.
    #[must_use]
    pub fn of(name: &'static str, value: f64) -> Self {
        Self { name, value, limit: None }
    }

    /// A number and its limit.
    #[must_use]
    pub fn against(name: &'static str, value: f64, limit: f64) -> Self {
        Self { name, value, limit: Some(limit) }
    }
}

/// What a deliberation says of one goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The goal, as it stands after the deliberation.
    pub goal: Goal,
    /// What was done with it.
    pub action: Action,
    /// Why.
    pub reason: Reason,
    /// What brought it about.
    pub cause: Cause,
    /// Its turn in the sequence, from 0.
    pub turn: Option<usize>,
    /// The goal that the reason speaks of (merged into, explained by).
    pub other: Option<GoalId>,
    /// The numbers compared.
    pub terms: Vec<Term>,
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Records carry names and are read back by searching the lists: a variant that a list forgets would be
    /// lost. Debug names come from the compiler; every variant up to the last must be there, in order.
    #[test]
    fn the_lists_hold_every_variant_once() {
        let reasons: BTreeSet<String> = Reason::ALL.iter().map(ToString::to_string).collect();
        assert_eq!(reasons.len(), Reason::ALL.len());
        assert!(Reason::ALL.iter().enumerate().all(|(i, reason)| *reason as usize == i));
        assert_eq!(Reason::ALL.last(), Some(&Reason::Done), "Done stays the last variant");
        assert!(Status::ALL.iter().enumerate().all(|(i, status)| *status as usize == i));
        assert_eq!(Status::ALL.last(), Some(&Status::Dropped), "Dropped stays the last variant");
        assert!(Action::ALL.iter().enumerate().all(|(i, action)| *action as usize == i));
        assert_eq!(Action::ALL.last(), Some(&Action::Achieve), "Achieve stays the last variant");
    }
}
