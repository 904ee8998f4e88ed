//! The paper's frame {I, NI} without allocation, for maps.

mod kernels;
mod mass;
mod policy;

pub use kernels::Fused;
pub use mass::{InterestMass, Opinion};
pub use policy::ParadoxPolicy;
