#![doc = include_str!("../README.md")]

mod autonomy;
mod decision;
mod deliberation;
mod error;
mod knowledge;
mod maps;
mod observation;
mod price;
mod spec;
mod stage;
mod weighing;

pub use autonomy::Autonomy;
pub use decision::{
    Act, Decision, Digest, Digests, FrontOf, Moment, Objectives, PlanOption, RoverState, Trigger,
    Wake,
};
pub use deliberation::Deliberation;
pub use error::AutonomyError;
pub use knowledge::Knowledge;
pub use maps::{Maps, Promise};
pub use observation::{LayerWindow, Message, Observation, Outcome, Pose, Spent, StepResult, Word};
pub use price::{Applied, Confirmation, GoalPrice};
pub use spec::{
    ApproachSpec, Budget, Derivation, ELEVATION, Fallback, LayerSpec, MIN_WORKING_CELLS, MapUpdate,
    Pace, RouteSpec, Source, Spec, Triggers,
};
pub use stage::{Stage, Watch};
