#![doc = include_str!("../README.md")]

mod discount;
mod element;
mod error;
mod expression;
mod frame;
mod interest;
mod mass;
mod measure;
mod refine;
pub mod rule;

pub use discount::Uncertainty;
pub use element::Element;
pub use error::BeliefError;
pub use frame::{Frame, MAX_EXCLUSIVE_ATOMS, MAX_OVERLAPPING_ATOMS, Model};
pub use interest::{Fused, InterestMass, Opinion, ParadoxPolicy};
pub use mass::{MassFunction, SUM_TOLERANCE};
pub use refine::Refinement;
pub use rule::{MAX_SOURCES, Rule};
