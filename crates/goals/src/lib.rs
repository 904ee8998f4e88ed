#![doc = include_str!("../README.md")]

mod approach;
mod causal;
mod directive;
mod front;
mod goal;
pub mod lifecycle;
mod manager;
mod objective;
mod pddl;
mod price;
mod prize;
mod sequence;
mod site;
mod strips;
mod taxonomy;

pub use approach::{Approach, poses, serves};
pub use causal::{CausalGraph, Link, PlanError, Step};
pub use directive::{Directive, Kind, UnknownKind};
pub use front::{PlanFront, plan_front};
pub use goal::{Action, Cause, Change, Goal, GoalId, Order, Reason, Term, Transformation, Verdict};
pub use lifecycle::{Life, Outcome, Status, Transition};
pub use manager::{
    Access, Command, Deliberated, Event, GoalManager, ManagerSpec, ManagerState, Poses, Retired,
    Revision, Selection, Shortlist, Survey, Tries, View, Weighed, Wish,
};
pub use objective::{Gains, Objective, Policy, Preferences, Prices, Served, UnknownPolicy};
pub use pddl::{PDDL_UNITS, PddlError, PddlFiles, pddl};
pub use price::{Choice, Known, Lever, MOST_PRIZE, Price, PriceTag, PrizeQuestion, price_tag};
pub use prize::{PrizeMap, PrizeScale, UnknownPrize, prize_map, quantised};
pub use sequence::{
    Candidate, Effort, End, Fade, GoalSequence, Limits, MAX_SEQUENCED, PrizeFront, Problem, Proof,
    Sequences, Stop, Window, prize_front, sequences, weigh,
};
pub use site::{Extraction, MergeTree, Site, sites};
pub use strips::{
    DRIVE, Domain, DomainError, Expansion, FactSet, Ground, GroundError, GroundFault, GroundPlace,
    Lifted, MAX_FACTS, MAX_GROUND, ObjectText, Operator, OperatorPart, OperatorText, SchemaText,
    ServiceCost, TypeText,
};
pub use taxonomy::{Taxonomy, TaxonomyError};
