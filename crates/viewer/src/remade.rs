//! What a log holds only as digests, and somebody can make again for the page.

use serde_json::Value;

/// Something the page may ask for beside the log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Asked {
    /// Which planes there are: `{"planes": [{"name", "label", "unit", "group", "classes"}], "experts": []}`, or
    /// `{"unavailable": why}`.
    Index,
    /// A plane at a decision.
    Plane {
        /// The decision.
        decision: u32,
        /// The plane's name.
        name: String,
    },
    /// Every value at a cell and what each expert says there: `{"planes": {}, "experts": [{"name", "masses", "credit"}]}`.
    Cell {
        /// The decision.
        decision: u32,
        /// Row from the north.
        row: u32,
        /// Column from the west.
        col: u32,
    },
    /// The ways of all plans of a decision's family: `{"plans": [{"cells": [[row, col]]}]}`.
    Family {
        /// The decision.
        decision: u32,
    },
    /// The price tags of the goals that a decision left out, and what was left to spend: `{"limits": {}, "left_out": []}`.
    Prices {
        /// The decision.
        decision: u32,
    },
}

/// Why the page does not get what it asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// There is no such thing.
    NotThere(String),
    /// It could not be made.
    Failed(String),
}

/// What comes back.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Records.
    Json(Value),
    /// A plane: row and column of its north-west cell, rows, columns, each a u32, then the values as f32 from the north, all
    /// little-endian.
    Plane(Vec<u8>),
}

/// Makes again what a log leaves out. Asked from several threads.
pub trait Remade: Send + Sync {
    /// Answers the page; may take seconds.
    ///
    /// # Errors
    /// [`Refusal`], whose text the page shows.
    fn answer(&self, asked: &Asked) -> Result<Answer, Refusal>;
}
