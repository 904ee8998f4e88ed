//! What can go wrong with a log.

use std::path::PathBuf;

use wisdom_grid::GridSpec;

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// A log of that name is there, or being written: a log is never written over.
    #[error("{} is already there; a log is never written over", path.display())]
    Exists {
        /// The file in the way.
        path: PathBuf,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// The container library refused.
    #[error("{}: {source}", path.display())]
    Container {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: mcap::McapError,
    },
    /// A file does not begin as an MCAP file does.
    #[error("{} is not an MCAP file: it does not begin with the MCAP magic", path.display())]
    NotALog {
        /// The file.
        path: PathBuf,
    },
    /// A record holds something that its type does not allow.
    #[error("{record}: {field} is {found}; it must be {limit}")]
    Malformed {
        /// The record, with its number.
        record: String,
        /// The field, as the record writes it.
        field: String,
        /// The value found.
        found: String,
        /// What it may be.
        limit: &'static str,
    },
    /// A map to be logged lies on another ground than the run.
    #[error(
        "map {name} lies on {found:?}, the run on {expected:?}; a map covers that grid or a part of it"
    )]
    GridMismatch {
        /// The map.
        name: String,
        /// Where it lies.
        found: GridSpec,
        /// Where the run lies.
        expected: GridSpec,
    },
    /// The log holds no such map.
    #[error("the log holds no {topic} of decision {decision}")]
    NoMap {
        /// The topic asked for.
        topic: String,
        /// The decision asked for.
        decision: u32,
    },
    /// The log holds no such decision.
    #[error("{}: no decision {decision}; the log holds {found}, counted from 0", path.display())]
    NoDecision {
        /// The file.
        path: PathBuf,
        /// The decision asked for.
        decision: u32,
        /// Decisions it holds.
        found: u64,
    },
    /// A part of the file that was asked for is not what was written.
    #[error("{}, at byte {byte}: {detail}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where the part begins.
        byte: u64,
        /// What does not hold.
        detail: String,
    },
}
