//! The rules of combination once more: straight from their definitions, over every product of focal elements,
//! on plain sets and exact rationals. Slow, and written without a look at how the library does it.

pub(crate) mod rational;
pub(crate) mod redistribution;
pub(crate) mod rules;
pub(crate) mod venn;

pub(crate) use rational::Exact;
pub(crate) use rules::{Body, Question, Undefined};
pub(crate) use venn::{Set, Venn};
