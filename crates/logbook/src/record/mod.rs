//! The records of a log: what `proto/wisdom.proto` says, as types.
//!
//! They are generated, versioned, and apart from the domain's types, so that old logs stay readable while
//! the domain moves on. Observations and outcomes convert both ways, because a replay feeds them to the core
//! again; decisions convert into records, and the goal manager's memory inside them back.

mod of_domain;
mod to_domain;

use prost::Message as _;

mod generated {
    include!(concat!(env!("OUT_DIR"), "/wisdom.v1.rs"));
}

pub use generated::*;

/// What decisions mean. Records of equal versions are made by cores that decide alike; a core whose
/// decisions differ on purpose raises it.
pub const DECISION_VERSION: u32 = 5;

/// The descriptor set of the records, as every log carries it.
pub const DESCRIPTOR: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/wisdom.binpb"));

/// What the chain begins with, before the first decision.
pub const CHAIN_START: [u8; 32] = [0; 32];

impl Decision {
    /// The link that this decision adds to a chain: BLAKE3 of the link before it and of the encoded record
    /// without its own `chain`.
    ///
    /// ```
    /// use wisdom_logbook::record::{CHAIN_START, Decision};
    ///
    /// let first = Decision { number: 0, ..Decision::default() };
    /// let linked = Decision { chain: "not part of it".to_owned(), ..first.clone() };
    /// assert_eq!(first.link(&CHAIN_START), linked.link(&CHAIN_START));
    /// assert_ne!(first.link(&CHAIN_START), first.link(&[1; 32]));
    /// ```
    #[must_use]
    pub fn link(&self, before: &[u8; 32]) -> [u8; 32] {
        let mut hasher = blake3::Hasher::new();
        hasher.update(before);
        if self.chain.is_empty() {
            hasher.update(&self.encode_to_vec());
        } else {
            let bare = Self { chain: String::new(), ..self.clone() };
            hasher.update(&bare.encode_to_vec());
        }
        *hasher.finalize().as_bytes()
    }
}

impl Message {
    /// The message in words.
    #[must_use]
    pub fn text(&self) -> String {
        let Self { number, kind, name, directive, target, .. } = self;
        let place = target.map_or_else(String::new, |c| format!(" at ({}, {})", c.row, c.col));
        match kind.as_str() {
            "pursue" => {
                let must = if self.mandatory { ", mandatory" } else { "" };
                let prize = self.prize.unwrap_or_default();
                format!(
                    "message {number}: command `{name}`: {directive}{place}, prize {prize}{must}"
                )
            }
            "withdraw" => format!("message {number}: command `{name}` is withdrawn"),
            _ => {
                let told = |what: &str, facts: &[String]| match facts {
                    [] => String::new(),
                    facts => format!("; {what}: {}", facts.join(", ")),
                };
                let (holds, lost) = (told("holds now", &self.adds), told("lost", &self.deletes));
                format!("message {number}: facts{holds}{lost}")
            }
        }
    }
}

/// Bytes as lower-case hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a string takes every text");
        text
    })
}
