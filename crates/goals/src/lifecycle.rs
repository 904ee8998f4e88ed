//! The life of a goal, in types: a transition that this file does not allow does not compile.
//!
//! Formulated, selected, expanded, committed, dispatched, evaluated, finished; and after an evaluation: continue, adjust,
//! repair, re-expand, reformulate, defer or drop (after Roberts et al. 2014, 2016).

use std::marker::PhantomData;

use crate::{GoalId, Reason};

/// Something with a name that records carry.
macro_rules! named {
    ($(#[$doc:meta])* $name:ident { $($(#[$of:meta])* $variant:ident = $text:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $name {
            $($(#[$of])* $variant),*
        }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The name that records carry.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text),*
                }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

pub(crate) use named;

named! {
    /// Where a goal stands in its life.
    #[non_exhaustive]
    Status {
        /// Known, in no sequence.
        Formulated = "formulated",
        /// Taken into the best sequence.
        Selected = "selected",
        /// Given operators.
        Expanded = "expanded",
        /// In the sequence that the rover follows.
        Committed = "committed",
        /// Being carried out: its leg is the one under way.
        Dispatched = "dispatched",
        /// Come back from being carried out, and looked at.
        Evaluated = "evaluated",
        /// Done.
        Finished = "finished",
        /// Given up; see the verdict that dropped it.
        Dropped = "dropped",
    }
}

named! {
    /// What is made of a goal that was being carried out.
    Outcome {
        /// Go on as before.
        Continue = "continue",
        /// Go on with another turn, pose or target.
        Adjust = "adjust",
        /// Try again after a failure.
        Repair = "repair",
        /// Go on with other operators.
        ReExpand = "re-expand",
        /// Go on as a goal of another directive.
        Reformulate = "reformulate",
        /// Not now.
        Defer = "defer",
        /// Not any more.
        Drop = "drop",
        /// It is done.
        Finish = "finish",
    }
}

impl Status {
    /// Whether the goal can still be pursued.
    #[must_use]
    pub fn is_open(self) -> bool {
        !matches!(self, Self::Finished | Self::Dropped)
    }

    /// Whether the rover counts on it: committed to, under way or just back.
    #[must_use]
    pub fn is_committed(self) -> bool {
        matches!(self, Self::Committed | Self::Dispatched | Self::Evaluated)
    }
}

/// A phase of a goal's life, as a type.
pub trait Phase: sealed::Sealed {
    /// The same as a value.
    const STATUS: Status;
}

/// From a phase to one that may follow it.
pub trait LeadsTo<Next: Phase>: Phase {}

mod sealed {
    pub trait Sealed {}
}

/// The phases and what may follow each.
macro_rules! phases {
    ($($phase:ident => [$($next:ident),*]),* $(,)?) => {
        $(
            #[doc = concat!("[`Status::", stringify!($phase), "`] as a type.")]
            #[derive(Debug, Clone, Copy, PartialEq, Eq)]
            pub struct $phase;
            impl sealed::Sealed for $phase {}
            impl Phase for $phase {
                const STATUS: Status = Status::$phase;
            }
            $(impl LeadsTo<$next> for $phase {})*
        )*

        impl Status {
            /// Whether this status may follow right after another: the check of records, whose phases are no types.
            #[must_use]
            pub fn may_follow(self, before: Self) -> bool {
                match before {
                    $(Self::$phase => [$(Self::$next),*].as_slice().contains(&self)),*
                }
            }
        }

        /// A goal's phase, found out.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Found {
            $($phase(In<$phase>)),*
        }

        impl Life {
            /// The phase as a type.
            pub(crate) fn found(self) -> Found {
                match self.0 {
                    $(Status::$phase => Found::$phase(In(PhantomData))),*
                }
            }
        }
    };
}

phases! {
    Formulated => [Selected, Dropped],
    Selected => [Expanded],
    Expanded => [Committed],
    Committed => [Expanded, Dispatched, Formulated, Dropped],
    Dispatched => [Evaluated],
    Evaluated => [Committed, Expanded, Formulated, Dropped, Finished],
    Finished => [],
    Dropped => [],
}

/// Where a goal stands. It can only be moved on by [`In::then`], from a phase to one that may follow it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Life(Status);

impl Life {
    /// The beginning of every goal.
    pub const BORN: Self = Self(Status::Formulated);

    /// As a record tells it.
    #[must_use]
    pub const fn recorded(status: Status) -> Self {
        Self(status)
    }

    /// Where it stands.
    #[must_use]
    pub const fn status(self) -> Status {
        self.0
    }
}

/// The knowledge that a goal is in a phase.
///
/// ```
/// use wisdom_goals::lifecycle::{Committed, Diary, Expanded, In, Selected};
/// use wisdom_goals::{GoalId, Reason, Status};
///
/// let mut diary = Diary::new(GoalId(7));
/// let goal = In::born();
/// let goal = goal.then::<Selected>(Reason::NewMaximum, &mut diary);
/// let goal = goal.then::<Expanded>(Reason::NewMaximum, &mut diary);
/// let goal = goal.then::<Committed>(Reason::NewMaximum, &mut diary);
/// assert_eq!(goal.life().status(), Status::Committed);
/// assert_eq!(diary.transitions.len(), 3);
/// ```
///
/// A goal that was never selected cannot be committed to:
///
/// ```compile_fail,E0277
/// # use wisdom_goals::lifecycle::{Committed, Diary, In};
/// # use wisdom_goals::{GoalId, Reason};
/// In::born().then::<Committed>(Reason::NewMaximum, &mut Diary::new(GoalId(7)));
/// ```
///
/// and what is done is done:
///
/// ```compile_fail,E0277
/// # use wisdom_goals::lifecycle::{Diary, Finished, Formulated, In};
/// # use wisdom_goals::{GoalId, Reason};
/// fn again(done: In<Finished>, diary: &mut Diary) {
///     done.then::<Formulated>(Reason::Reopened, diary);
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub struct In<P>(PhantomData<P>);

impl In<Formulated> {
    /// A goal that was just formulated.
    pub fn born() -> Self {
        Self(PhantomData)
    }
}

impl<P: Phase> In<P> {
    /// Moves on to a phase that may follow, and writes it down.
    pub fn then<Next: Phase>(self, reason: Reason, diary: &mut Diary) -> In<Next>
    where
        P: LeadsTo<Next>,
    {
        let Diary { goal, transitions } = diary;
        let (from, to) = (P::STATUS, Next::STATUS);
        transitions.push(Transition { goal: *goal, from, to, reason, outcome: None });
        In(PhantomData)
    }

    /// Where the goal stands.
    #[must_use]
    pub fn life(self) -> Life {
        Life(P::STATUS)
    }
}

impl In<Evaluated> {
    /// Moves on after an evaluation, and writes down what was made of it.
    pub fn judged<Next: Phase>(
        self,
        outcome: Outcome,
        reason: Reason,
        diary: &mut Diary,
    ) -> In<Next>
    where
        Evaluated: LeadsTo<Next>,
    {
        let next = self.then(reason, diary);
        if let Some(last) = diary.transitions.last_mut() {
            last.outcome = Some(outcome);
        }
        next
    }
}

/// A step in a goal's life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The goal.
    pub goal: GoalId,
    /// Where it stood.
    pub from: Status,
    /// Where it stands.
    pub to: Status,
    /// Why; the verdict of the same deliberation has the numbers.
    pub reason: Reason,
    /// What was made of it, if it had been under way.
    pub outcome: Option<Outcome>,
}

/// What happened to one goal, in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diary {
    /// The goal.
    pub goal: GoalId,
    /// Its steps.
    pub transitions: Vec<Transition>,
}

impl Diary {
    /// Nothing yet.
    #[must_use]
    pub fn new(goal: GoalId) -> Self {
        Self { goal, transitions: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_follow_as_a_value_is_what_may_follow_as_a_type() {
        // Two samples of what the types say (the macro writes both from one list), and the ends.
        assert!(Status::Committed.may_follow(Status::Expanded));
        assert!(!Status::Committed.may_follow(Status::Formulated));
        for next in Status::ALL {
            assert!(!next.may_follow(Status::Finished), "{next} after the end");
            assert!(!next.may_follow(Status::Dropped), "{next} after the end");
        }
        assert!(
            Status::ALL.iter().all(|s| s.is_open() == Status::ALL.iter().any(|n| n.may_follow(*s)))
        );
    }
}
