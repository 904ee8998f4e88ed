#![doc = include_str!("../README.md")]

mod belief_map;
mod credit;
mod error;
mod expert;
mod interest_map;
mod statistic;
mod table;

pub use belief_map::belief_map;
pub use credit::{credit, credit_of};
pub use error::FusionError;
pub use expert::{Evidence, Expert, judge};
pub use interest_map::{Fusion, InterestMap, MAX_EXPERTS, interest_map};
pub use statistic::{DSMP_EPSILON, Statistic};
pub use table::{Band, Class, LookupTable, Rows};
