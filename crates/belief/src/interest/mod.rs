//! The paper's frame {I, NI} without allocation, for cells and, in closed form, for maps.

pub(crate) mod closed;
mod fuse;
mod mass;
mod policy;

pub(crate) use closed::exponential;
pub use fuse::Fused;
pub(crate) use mass::ROUNDING;
pub use mass::{InterestMass, Opinion};
pub use policy::ParadoxPolicy;
