#![doc = include_str!("../README.md")]

mod approach;
mod causal;
mod directive;
mod front;
mod goal;
mod manager;
mod objective;
mod prize;
mod sequence;
mod site;
mod strips;

pub use approach::{Approach, poses};
pub use causal::{CausalGraph, PlanError};
pub use directive::Directive;
pub use front::{PlanFront, plan_front};
pub use goal::{Action, Cause, Goal, GoalId, Reason, Status, Term, Verdict};
pub use manager::{
    Event, GoalManager, ManagerSpec, ManagerState, Poses, Retired, Revision, Selection, Shortlist,
    Survey, Tries,
};
pub use objective::{Gains, Objective, Policy, Preferences, Prices, Served, UnknownPolicy};
pub use prize::{PrizeMap, PrizeScale, UnknownPrize, prize_map, quantised};
pub use sequence::{
    Candidate, Effort, End, Fade, GoalSequence, Limits, MAX_SEQUENCED, PrizeFront, Problem, Proof,
    Sequences, Stop, Window, prize_front, sequences, weigh,
};
pub use site::{Extraction, MergeTree, Site, sites};
pub use strips::{
    DRIVE, Domain, DomainError, Expansion, FactSet, MAX_FACTS, Operator, OperatorText, ServiceCost,
};
