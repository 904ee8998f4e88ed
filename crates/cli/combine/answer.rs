//! What a case comes to.

use serde::ser::{Serialize, Serializer};

/// The value of each expression asked for, or one number.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Answer {
    /// Expressions and their values, in the order in which they are written.
    Values(Vec<(String, f64)>),
    /// One number.
    Scalar(f64),
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Values(values) => serializer.collect_map(values.iter().map(|(k, v)| (k, v))),
            Self::Scalar(value) => serializer.collect_map([("value", value)]),
        }
    }
}
