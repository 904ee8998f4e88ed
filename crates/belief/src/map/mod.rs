//! Whole maps: the closed forms on {I, NI}, some cells side by side, one thread, no allocation.
//!
//! Maps are planes, one a mass, all in the same order of cells; callers who want more threads hand out rows.
//! [`fuse`] takes any number of [`Source`]s up to [`MAX_MAP_SOURCES`], from planes of masses or straight from
//! classes and readings, and writes the [`Outputs`] that are asked for, and no others.
//!
//! ```
//! use wisdom_belief::map::{self, Outputs, Planes, Source};
//! use wisdom_belief::{ParadoxPolicy, Rule, Settings};
//!
//! // Two sources, three cells.
//! let texture = Planes { interesting: &[0.9_f32, 0.2, 0.0], not_interesting: &[0.0, 0.5, 0.0], paradox: None };
//! let thermal = Planes { interesting: &[0.5, 0.0, 0.0], not_interesting: &[0.4, 0.8, 0.0], paradox: None };
//! let sources = [Source::Planes(texture), Source::Planes(thermal)];
//!
//! let mut belief = [0.0; 3];
//! let outputs = Outputs { belief: Some(&mut belief), ..Outputs::default() };
//! map::fuse(Rule::Dsmc, &sources, ParadoxPolicy::ToIgnorance, &Settings::default(), outputs)?;
//! assert!((belief[0] - (1.0 - 0.1 * 0.5)).abs() < 1e-6); // what both doubt
//! assert_eq!(belief[2], 0.0); // nobody has seen it
//! # Ok::<(), wisdom_belief::BeliefError>(())
//! ```
//!
//! Memory sets the pace of the plainer rules. Large planes that all begin at the same place in a page (as those that
//! were allocated one by one do) compete for the same lines of the caches, and may take up to twice as long; planes that
//! begin some cache lines apart, as views into one buffer can, do not.
//!
//! The widest instructions that the processor has are found out when the program runs. No result depends on
//! them: every step is one addition, subtraction, multiplication, division, square root or comparison of
//! IEEE 754, in the same order, whatever the width.
#![expect(
    clippy::inline_always,
    reason = "code for an instruction set is compiled only where it is inlined"
)]

mod belief;
mod discount;
mod fuse;
mod number;
mod outputs;
mod source;
mod table;
mod width;

pub use discount::{PlanesMut, discount};
pub use fuse::{MAX_MAP_SOURCES, fuse};
pub use number::{MapNumber, instruction_set};
pub use outputs::Outputs;
pub use source::{Planes, Source};
pub use table::{MAX_ROWS, Table};

#[cfg(test)]
mod tests;
