//! Whether two runs were given and told the same, and what differs if not.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Entry, LogReader, record};

/// Facts of a run that decisions hang on, as a log's metadata names them. Digest and overrides stand for what the files
/// say, and are told by them.
const FACTS: [&str; 13] = [
    "mission",
    "seed",
    "rule",
    "paradox",
    "statistic",
    "policy",
    "prize",
    "version",
    "decision_version",
    "grid_rows",
    "grid_cols",
    "grid_spacing_m",
    "log_version",
];

/// A fact of the runs that differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactDifference {
    /// Its name.
    pub name: String,
    /// Of the left run; none if its log does not say.
    pub left: Option<String>,
    /// Of the right run; none if its log does not say.
    pub right: Option<String>,
}

/// A file of the missions that differs, or that only one of them has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileDifference {
    /// Its name in the logs.
    pub name: String,
    /// BLAKE3 of the left one, hexadecimal; none if there is none.
    pub left: Option<String>,
    /// BLAKE3 of the right one, hexadecimal; none if there is none.
    pub right: Option<String>,
    /// If both are TOML, the keys that differ.
    pub keys: Vec<KeyDifference>,
}

/// A key of two TOML files that differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyDifference {
    /// Its dotted path: `directive.0.weight`.
    pub key: String,
    /// Its value in the left file, as TOML; none if it is not there.
    pub left: Option<String>,
    /// Its value in the right file, as TOML; none if it is not there.
    pub right: Option<String>,
}

/// The first observation or message that differs between two runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ToldDifference {
    /// Number of the observation or message, each counted from 0.
    pub number: u32,
    /// What differs: `pose`, `spent`, `readings of LAYER`, or that one run ends before.
    pub what: String,
    /// The last decision of the left run before it; none if it comes before all.
    pub after_decision: Option<u32>,
}

/// What two runs were given and told.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Inputs {
    /// Facts that differ.
    pub facts: Vec<FactDifference>,
    /// Files that differ.
    pub files: Vec<FileDifference>,
    /// How many files are the same.
    pub same_files: usize,
    /// The first observation that differs.
    pub observations: Option<ToldDifference>,
    /// The first message that differs.
    pub messages: Option<ToldDifference>,
}

impl Inputs {
    /// Whether both were given the same: same facts and files. What they were told after that hangs on what they did.
    #[must_use]
    pub fn are_equal(&self) -> bool {
        self.facts.is_empty() && self.files.is_empty()
    }

    /// Whether nothing differs but the rule of combination, and what follows from it.
    #[must_use]
    pub fn differ_in_rule_alone(&self) -> bool {
        let of_rule = |name: &str| name == "rule" || name == "paradox";
        self.facts.iter().any(|fact| fact.name == "rule")
            && self.facts.iter().all(|fact| of_rule(&fact.name))
            && self
                .files
                .iter()
                .all(|file| !file.keys.is_empty() && file.keys.iter().all(|key| of_rule(&key.key)))
    }
}

/// Holds what two runs were given and told against each other.
#[must_use]
pub fn inputs(a: &LogReader, b: &LogReader) -> Inputs {
    let facts = FACTS
        .iter()
        .filter_map(|&name| {
            let (left, right) = (a.metadata.get(name).cloned(), b.metadata.get(name).cloned());
            (left != right).then(|| FactDifference { name: name.to_owned(), left, right })
        })
        .collect();
    let (left, right) = (files(a), files(b));
    let names: BTreeSet<&str> = left.keys().chain(right.keys()).copied().collect();
    let mut found = Inputs { facts, ..Inputs::default() };
    for name in names {
        let (left, right) = (left.get(name).copied(), right.get(name).copied());
        if left == right {
            found.same_files += 1;
            continue;
        }
        let digest = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
        let keys = left.zip(right).and_then(|(left, right)| keys(left, right)).unwrap_or_default();
        let (left, right) = (left.map(digest), right.map(digest));
        found.files.push(FileDifference { name: name.to_owned(), left, right, keys });
    }
    found.observations = observations(a, b);
    found.messages = messages(a, b);
    found
}

fn files(log: &LogReader) -> BTreeMap<&str, &[u8]> {
    log.attachments.iter().map(|file| (file.name.as_str(), file.data.as_slice())).collect()
}

/// The keys that differ between two TOML files; none if one is no TOML.
fn keys(left: &[u8], right: &[u8]) -> Option<Vec<KeyDifference>> {
    let parsed = |bytes: &[u8]| {
        let table: toml::Table = std::str::from_utf8(bytes).ok()?.parse().ok()?;
        let mut flat = BTreeMap::new();
        flatten("", &toml::Value::Table(table), &mut flat);
        Some(flat)
    };
    let (left, right) = (parsed(left)?, parsed(right)?);
    let names: BTreeSet<&String> = left.keys().chain(right.keys()).collect();
    let differing = names.into_iter().filter_map(|key| {
        let (left, right) = (left.get(key).cloned(), right.get(key).cloned());
        (left != right).then(|| KeyDifference { key: key.clone(), left, right })
    });
    Some(differing.collect())
}

/// Every value of a TOML file by its dotted path; tables in lists count from 0.
fn flatten(path: &str, value: &toml::Value, into: &mut BTreeMap<String, String>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                flatten(&below(key), value, into);
            }
        }
        toml::Value::Array(list) if list.iter().any(toml::Value::is_table) => {
            for (index, value) in list.iter().enumerate() {
                flatten(&below(&index.to_string()), value, into);
            }
        }
        value => {
            into.insert(path.to_owned(), value.to_string());
        }
    }
}

/// The observations of a log, each with the last decision before it.
fn observed(log: &LogReader) -> impl Iterator<Item = (Option<u32>, &record::Observation)> {
    told(log, |entry| match entry {
        Entry::Observation(observation) => Some(observation),
        _ => None,
    })
}

/// Some records of a log, each with the last decision before it.
fn told<'a, T: 'a>(
    log: &'a LogReader,
    of: impl Fn(&'a Entry) -> Option<&'a T> + 'a,
) -> impl Iterator<Item = (Option<u32>, &'a T)> {
    let mut decided = None;
    log.entries.iter().filter_map(move |entry| {
        if let Entry::Decision(decision) = entry {
            decided = Some(decision.number);
        }
        of(entry).map(|record| (decided, record))
    })
}

fn observations(a: &LogReader, b: &LogReader) -> Option<ToldDifference> {
    first(observed(a), observed(b), |left, right| {
        if left.pose != right.pose {
            return Some("pose".to_owned());
        }
        if left.spent != right.spent {
            return Some("spent".to_owned());
        }
        let (mut lefts, mut rights) = (left.windows.iter(), right.windows.iter());
        loop {
            match (lefts.next(), rights.next()) {
                (None, None) => return None,
                (Some(left), Some(right)) if left == right => {}
                (left, right) => {
                    let layer = left.or(right).map_or("a layer", |window| &window.layer);
                    return Some(format!("readings of {layer}"));
                }
            }
        }
    })
}

fn messages(a: &LogReader, b: &LogReader) -> Option<ToldDifference> {
    fn heard(log: &LogReader) -> impl Iterator<Item = (Option<u32>, &record::Message)> {
        told(log, |entry| match entry {
            Entry::Message(message) => Some(message),
            _ => None,
        })
    }
    first(heard(a), heard(b), |left, right| (left != right).then(|| "the message".to_owned()))
}

/// The first pair that differs.
fn first<'a, T: 'a>(
    mut lefts: impl Iterator<Item = (Option<u32>, &'a T)>,
    mut rights: impl Iterator<Item = (Option<u32>, &'a T)>,
    differ: impl Fn(&T, &T) -> Option<String>,
) -> Option<ToldDifference> {
    for number in 0.. {
        let (after_decision, what) = match (lefts.next(), rights.next()) {
            (None, None) => return None,
            (Some((after, left)), Some((_, right))) => (after, differ(left, right)),
            (Some((after, _)), None) => (after, Some("only the left run has it".to_owned())),
            (None, Some((after, _))) => (after, Some("only the right run has it".to_owned())),
        };
        if let Some(what) = what {
            return Some(ToldDifference { number, what, after_decision });
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_named_by_their_path() {
        let left = b"a = 1\nx = [1, 2]\n[b]\nc = \"d\"\n[[e]]\nf = 1\n[[e]]\nf = 2\n";
        let right = b"a = 1\nx = [1, 3]\n[b]\nc = \"D\"\n[[e]]\nf = 1\n[[e]]\ng = 2\n";
        let told: Vec<(String, Option<String>, Option<String>)> =
            keys(left, right).unwrap().into_iter().map(|k| (k.key, k.left, k.right)).collect();
        let text = |s: &str| Some(s.to_owned());
        assert_eq!(
            told,
            [
                ("b.c".to_owned(), text("\"d\""), text("\"D\"")),
                ("e.1.f".to_owned(), text("2"), None),
                ("e.1.g".to_owned(), None, text("2")),
                ("x".to_owned(), text("[1, 2]"), text("[1, 3]")),
            ]
        );
        assert_eq!(keys(left, left), Some(vec![]));
        assert_eq!(keys(left, b"\xff"), None);
    }
}
