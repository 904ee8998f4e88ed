#![doc = include_str!("../README.md")]

mod campaign;
mod closed_loop;
mod error;
mod fault;
mod file;
mod ground;
mod mission;
mod recorder;
mod ruler;
mod supply;
mod truth;
mod world;

pub use campaign::{
    CampaignRun, Places, first_difference, first_divergent_decision, jaccard, kendall_tau, run_all,
};
pub use closed_loop::{Achievement, LegRecord, Progress, RunError, RunStatus, RunSummary, run};
pub use error::MissionError;
pub use fault::{Fault, FaultEvent, FaultKind};
pub use mission::{MISSION_FILE, Mission, Override};
pub use recorder::{Memory, RecordError, Recorder};
pub use ruler::Ruler;
pub use world::{Execution, Instrument, Step, World};
