#![doc = include_str!("../README.md")]

mod cost;
mod error;
mod field;
mod matrix;
mod plan;
mod preset;
mod route;
mod traversability;
mod validate;
mod vehicle;

pub use cost::CostVector;
pub use error::PlannerError;
pub use field::{Field, FieldOptions, Limits, field};
pub use matrix::{TravelMatrix, travel_matrix};
pub use plan::{Leg, Plan, PlanFamily, Service};
pub use preset::Preset;
pub use route::Route;
pub use traversability::{Ground, Traversability};
pub use validate::{Budget, RELATIVE_TOLERANCE, Violation, validate};
pub use vehicle::{SlipClass, Vehicle};
