//! Where two decisions first differ: the stage, the field, and both values.

use std::fmt::{self, Write as _};

use serde_json::Value;

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
#[derive(Debug, Clone, PartialEq, Eq)]
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
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { decision, stage, path, left, right, ulps } = self;
        write!(f, "decision {decision}, {stage}: {path} is {left} against {right}")?;
        match ulps {
            Some(ulps) => write!(f, " ({ulps} ulp)"),
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
    let (left, right) = (json(a), json(b));
    STAGES.into_iter().filter(|&(_, field)| field != "chain").find_map(|(stage, field)| {
        let mut path = field.to_owned();
        let (left, right) = differ(left.get(field), right.get(field), &mut path)?;
        let ulps = left.zip(right).and_then(|(left, right)| ulps(left, right));
        let (left, right) = (show(left), show(right));
        Some(Difference { decision: a.number, stage, path, left, right, ulps })
    })
}

fn json(decision: &Decision) -> Value {
    serde_json::to_value(decision).expect("a record has text keys and finite numbers or nulls")
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
