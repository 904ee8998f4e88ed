#![doc = include_str!("../README.md")]

pub mod compare;
pub mod comparison;
mod container;
mod derive;
mod error;
mod expand;
mod indexed;
mod life;
mod planes;
pub mod read;
pub mod record;
mod recover;
mod redecide;
mod reel;
mod replay;
mod setting;
mod store;
mod verify;
mod view;
pub mod write;

pub use compare::{Difference, MapDifference, first_difference};
pub use derive::{Deriver, Past, derive_at};
pub use error::LogError;
pub use expand::{PlaneLog, expand};
pub use indexed::{AttachmentAt, Contents, IndexedLog};
pub use life::{GoalLife, Weighing};
pub use planes::{PlaneGroup, PlaneInfo, is_plane, plane, planes};
pub use read::{Check, Entry, Item, LogReader, RunEnd, Status, check};
pub use recover::{RECOVERED, Recovery, recover, recover_into};
pub use redecide::{
    Parting, Redecided, Retaken, Scores, Terms, mission_with, parting, redecide, side_by_side,
};
pub use reel::Reel;
pub use replay::{ReplayError, begin, causal_dot, header, mission_of};
pub use setting::{DecisionMaps, Drape, Setting};
pub use store::{PartFile, Store, SyncPolicy, part_of};
pub use verify::{Breach, INVARIANTS, Verification, VerifyLevel, verify, verify_log};
pub use write::{KEY_EVERY, Level, LogWriter, MapMode, Options, RunHeader};

/// Where each kind of record goes.
pub mod topic {
    /// What the core was told: [`crate::record::Observation`].
    pub const OBSERVATION: &str = "/in/observation";
    /// What came of a step: [`crate::record::Outcome`].
    pub const OUTCOME: &str = "/in/outcome";
    /// What word reached the core: [`crate::record::Message`].
    pub const MESSAGE: &str = "/in/message";
    /// What broke in the simulated world: [`crate::record::Fault`].
    pub const FAULT: &str = "/truth/fault";
    /// What was decided: [`crate::record::Decision`].
    pub const DECISION: &str = "/decision";
    /// The interest map of a decision: `foxglove.Grid`. Every other plane is `/map/` and its name.
    pub const INTEREST: &str = "/map/interest";
    /// What changed of the interest map since the decision before, in a log of patches: `foxglove.Grid`. Likewise for every
    /// other plane.
    pub const PATCH: &str = "/map/interest/patch";
    /// The interest map draped over the ground, thinned: `foxglove.PointCloud`. Viewers draw a Grid flat or not at all.
    pub const CLOUD: &str = "/terrain/interest";
    /// Goals, the planned path and the driven track: `foxglove.SceneUpdate`.
    pub const SCENE: &str = "/scene";
    /// Where the rover stands: `foxglove.PoseInFrame`.
    pub const POSE: &str = "/rover/pose";
    /// From map to rover: `foxglove.FrameTransform`.
    pub const TRANSFORM: &str = "/tf";
    /// Triggers and changes, in words: `foxglove.Log`.
    pub const LOG: &str = "/log";
    /// Where a plane goes.
    #[must_use]
    pub fn map_of(plane: &str) -> String {
        format!("/map/{plane}")
    }

    /// Where what changed of a plane goes.
    #[must_use]
    pub fn patch_of(plane: &str) -> String {
        format!("/map/{plane}/patch")
    }

    /// The plane whose map, or what changed of it, goes to a topic.
    #[must_use]
    pub fn plane_of(topic: &str) -> Option<&str> {
        let plane = topic.strip_prefix("/map/")?;
        Some(plane.strip_suffix("/patch").unwrap_or(plane))
    }

    /// Every topic of these names; planes besides the interest are `/map/` and their name.
    pub const ALL: [&str; 12] = [
        OBSERVATION,
        OUTCOME,
        MESSAGE,
        FAULT,
        DECISION,
        INTEREST,
        PATCH,
        CLOUD,
        SCENE,
        POSE,
        TRANSFORM,
        LOG,
    ];
}
