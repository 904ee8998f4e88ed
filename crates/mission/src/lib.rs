#![doc = include_str!("../README.md")]

mod bound;
mod campaign;
mod closed_loop;
mod error;
mod fault;
mod file;
mod ground;
mod label;
mod lint;
mod mission;
mod reading;
mod recorder;
mod ruler;
mod schema;
pub mod statistics;
mod supply;
mod truth;
mod world;

pub use bound::DecisionBound;
pub use campaign::{
    CampaignError, CampaignRun, Case, GoalRow, LegRow, MAX_RUNS, MAX_SEED, METRICS, Metric,
    PairedTable, Places, Plan, ROW_VERSION, Row, RowResult, RunRow, Variant, first_difference,
    first_divergent_decision, jaccard, kendall_tau, run_all, table,
};
pub use closed_loop::{Achievement, LegRecord, Progress, RunError, RunStatus, RunSummary, run};
pub use error::MissionError;
pub use fault::{Fault, FaultEvent, FaultKind};
pub use label::{Label, labels_found};
pub use lint::{Lint, Warning, lint};
pub use mission::{MISSION_FILE, Mission, Override};
pub use reading::Reading;
pub use recorder::{Memory, RecordError, Recorder};
pub use ruler::Ruler;
pub use schema::{Described, schema};
pub use world::{Execution, Instrument, Step, World};
