//! Where two decisions first differ: the stage, the field, and both values.

use std::fmt::{self, Write as _};

use prost::Message as _;
use serde_json::Value;
use wisdom_grid::{Cell, Raster};

use crate::record::Decision;

/// The stages of a decision in the order they are made, each with the field of the record that holds it.
///
/// What a stage makes feeds the ones after it, so the first stage that differs is where to look. The chain
/// is not compared: it speaks of the decisions before.
pub const STAGES: [(&str, &str); 13] = [
    ("record", "number"),
    ("record", "decision_version"),
    ("state", "state"),
    ("frame", "frame"),
    ("gradient", "gradient"),
    ("masses", "masses"),
    ("fusion", "fusion"),
    // Triggers speak of prizes and hazards: they follow from the maps, whatever calls for a decision.
    ("trigger", "triggers"),
    ("candidates", "candidates"),
    ("routes", "routes"),
    ("objective", "objective"),
    ("choice", "choice"),
    ("record", "chain"),
];

/// What stands for a field that one side does not have.
const ABSENT: &str = "absent";

/// The first difference of two decisions.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Number of the left decision.
    pub decision: u32,
    /// The stage that made the field.
    pub stage: &'static str,
    /// The field, from the decision down: `choice.verdicts[2].reason`.
    pub path: String,
    /// The left value, in full precision; `absent` if there is none.
    pub left: String,
    /// The right value, in full precision; `absent` if there is none.
    pub right: String,
    /// How many numbers an f64 can be lie between the two, if both are such numbers.
    pub ulps: Option<u64>,
    /// Where the maps behind the two lie furthest apart, if both are at hand and differ.
    pub map: Option<MapDifference>,
}

/// The cell at which two maps lie furthest apart.
#[derive(Debug, Clone, PartialEq)]
pub struct MapDifference {
    /// The plane's name, such as `interest`.
    pub plane: String,
    /// The cell.
    pub cell: Cell,
    /// The left value there.
    pub left: f32,
    /// The right value there.
    pub right: f32,
    /// Cells that differ.
    pub cells: usize,
}

impl MapDifference {
    /// Where two planes differ most, bit for bit; none if they are the same. Planes of other ground have no cell in
    /// common to speak of: the left one's first is named, with what it holds on both sides.
    #[must_use]
    pub fn between(name: &str, left: &Raster<f32>, right: &Raster<f32>) -> Option<Self> {
        let mut found: Option<Self> = None;
        let mut cells = 0;
        for (cell, &here) in left.iter() {
            let there = right.get(cell).copied().unwrap_or(f32::NAN);
            if here.to_bits() == there.to_bits() {
                continue;
            }
            cells += 1;
            // What is on one side alone lies further apart than anything.
            let apart = |a: f32, b: f32| {
                let apart = (f64::from(a) - f64::from(b)).abs();
                if apart.is_nan() { f64::INFINITY } else { apart }
            };
            if found.as_ref().is_none_or(|f| apart(here, there) > apart(f.left, f.right)) {
                let plane = name.to_owned();
                found = Some(Self { plane, cell, left: here, right: there, cells: 0 });
            }
        }
        found.map(|found| Self { cells, ..found })
    }
}

impl fmt::Display for MapDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plane, cell, left, right, cells } = self;
        write!(f, "{plane} differs in {cells} cells, most at {cell}: {left} against {right}")
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { decision, stage, path, left, right, ulps, map } = self;
        write!(f, "decision {decision}, {stage}: {path} is {left} against {right}")?;
        if let Some(ulps) = ulps {
            write!(f, " ({ulps} ulp)")?;
        }
        match map {
            Some(map) => write!(f, "; {map}"),
            None => Ok(()),
        }
    }
}

/// The first difference of two decisions, stage by stage; none if they are the same but for their chains.
///
/// ```
/// use wisdom_logbook::first_difference;
/// use wisdom_logbook::record::{Decision, Frame};
///
/// let seen = |seen| Decision { frame: Some(Frame { seen, ..Frame::default() }), ..Decision::default() };
/// let difference = first_difference(&seen(0.5), &seen(0.25)).expect("they differ");
/// assert_eq!((difference.stage, difference.path.as_str()), ("frame", "frame.seen"));
/// assert_eq!(first_difference(&seen(0.5), &seen(0.5)), None);
/// ```
#[must_use]
pub fn first_difference(a: &Decision, b: &Decision) -> Option<Difference> {
    let bare = |decision: &Decision| {
        let mut decision = decision.clone();
        decision.chain.clear();
        decision.encode_to_vec()
    };
    // Field by field is for those that differ.
    if bare(a) == bare(b) {
        return None;
    }
    let (left, right) = (json(a), json(b));
    STAGES.into_iter().filter(|&(_, field)| field != "chain").find_map(|(stage, field)| {
        let mut path = field.to_owned();
        let pair = differ(left.get(field), right.get(field), &mut path)?;
        Some(Difference::of(a.number, stage, path, pair))
    })
}

/// The first difference of two records of one kind, said of a decision and a stage.
pub(crate) fn record_difference<R: serde::Serialize>(
    decision: u32,
    stage: &'static str,
    name: String,
    a: &R,
    b: &R,
) -> Option<Difference> {
    let (left, right) = (json(a), json(b));
    let mut path = name;
    let pair = differ(Some(&left), Some(&right), &mut path)?;
    Some(Difference::of(decision, stage, path, pair))
}

impl Difference {
    fn of(decision: u32, stage: &'static str, path: String, pair: Pair<'_>) -> Self {
        let (left, right) = pair;
        let ulps = left.zip(right).and_then(|(left, right)| ulps(left, right));
        let (left, right) = (show(left), show(right));
        Self { decision, stage, path, left, right, ulps, map: None }
    }

    /// A difference that is told in words.
    pub(crate) fn told(
        decision: u32,
        stage: &'static str,
        path: impl Into<String>,
        left: impl Into<String>,
        right: impl Into<String>,
    ) -> Self {
        let (path, left, right) = (path.into(), left.into(), right.into());
        Self { decision, stage, path, left, right, ulps: None, map: None }
    }
}

fn json<R: serde::Serialize>(record: &R) -> Value {
    serde_json::to_value(record).expect("a record has text keys and finite numbers or nulls")
}

type Pair<'a> = (Option<&'a Value>, Option<&'a Value>);

/// The first pair of values that differ, depth first; `path` is left at their field.
fn differ<'a>(
    left: Option<&'a Value>,
    right: Option<&'a Value>,
    path: &mut String,
) -> Option<Pair<'a>> {
    let known = path.len();
    match (left, right) {
        (Some(Value::Object(a)), Some(Value::Object(b))) => a.iter().find_map(|(key, value)| {
            path.truncate(known);
            path.push('.');
            path.push_str(key);
            differ(Some(value), b.get(key), path)
        }),
        (Some(Value::Array(a)), Some(Value::Array(b))) => {
            (0..a.len().max(b.len())).find_map(|index| {
                path.truncate(known);
                write!(path, "[{index}]").expect("a string takes every text");
                differ(a.get(index), b.get(index), path)
            })
        }
        (a, b) if a == b => None,
        pair => Some(pair),
    }
}

/// A value as text; one of many fields is cut short.
fn show(value: Option<&Value>) -> String {
    const LONGEST: usize = 120;
    match value {
        None | Some(Value::Null) => ABSENT.to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(value) => {
            let text = value.to_string();
            match text.char_indices().nth(LONGEST) {
                Some((end, _)) => format!("{}..", &text[..end]),
                None => text,
            }
        }
    }
}

/// Steps from one f64 to the other, if both values are such.
fn ulps(left: &Value, right: &Value) -> Option<u64> {
    if !(left.is_f64() && right.is_f64()) {
        return None;
    }
    // Negative numbers run backwards from zero, so that neighbours differ by one.
    let place = |value: &Value| {
        let bits = value.as_f64()?.to_bits() as i64;
        Some(if bits < 0 { i64::MIN - bits } else { bits })
    };
    Some(place(left)?.abs_diff(place(right)?))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn neighbouring_numbers_are_one_ulp_apart_across_zero_too() {
        let ulp = |a: f64, b: f64| ulps(&json!(a), &json!(b)).unwrap();
        assert_eq!(ulp(1.0, 1.0_f64.next_up()), 1);
        assert_eq!(ulp(-1.0, (-1.0_f64).next_up()), 1);
        assert_eq!(ulp(0.0, f64::from_bits(1)), 1);
        assert_eq!(ulp(-0.0, f64::from_bits(1)), 1);
        assert_eq!(ulps(&json!(1), &json!(2)), None);
    }

    #[test]
    fn every_field_of_the_record_belongs_to_a_stage() {
        let Value::Object(fields) = super::json(&Decision::default()) else { panic!("a record") };
        let mut staged: Vec<&str> = STAGES.iter().map(|(_, field)| *field).collect();
        staged.sort_unstable();
        assert_eq!(fields.keys().map(String::as_str).collect::<Vec<_>>(), staged);
    }
}
