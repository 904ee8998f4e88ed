#![doc = include_str!("../README.md")]

mod astar;
mod cost;
mod error;
mod field;
mod front;
mod matrix;
mod plan;
mod preset;
mod route;
mod traversability;
mod validate;
mod vehicle;

pub use astar::{Found, Router, route};
pub use cost::CostVector;
pub use error::PlannerError;
pub use field::{Field, FieldOptions, Limits, WeighedField, WeighedGround, Weights, field};
pub use front::{Front, FrontOptions, front, non_dominated};
pub use matrix::{TravelCache, TravelMatrix, TravelOptions, travel_alternatives, travel_matrix};
pub use plan::{Leg, Plan, PlanFamily, Service};
pub use preset::Preset;
pub use route::Route;
pub use traversability::{Ground, Traversability};
pub use validate::{Budget, RELATIVE_TOLERANCE, Violation, validate};
pub use vehicle::{SlipClass, Vehicle};
