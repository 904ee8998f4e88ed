//! One line of input: a case, read and checked.

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::value::RawValue;
use serde_json::{Map, Value};
use wisdom_belief::{BeliefError, Element, Frame, MassFunction};

use super::json::{Object, Strict};

/// The `id` of a case, byte for byte as it was written; none where it is absent, null or unreadable.
pub(super) type Id = Option<Box<RawValue>>;

/// Why a case has no answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CaseError {
    /// The kind, as one word.
    pub(super) code: &'static str,
    /// What was found and what was expected.
    pub(super) message: String,
}

impl CaseError {
    pub(super) fn malformed(message: String) -> Self {
        Self { code: "malformed", message }
    }

    /// A parameter out of its range.
    pub(super) fn parameter(message: String) -> Self {
        Self { code: "parameter", message }
    }

    /// Says where in the case the error is.
    fn at(self, place: impl fmt::Display) -> Self {
        Self { message: format!("{place}: {}", self.message), ..self }
    }
}

impl From<BeliefError> for CaseError {
    fn from(error: BeliefError) -> Self {
        Self { code: error.code(), message: error.to_string() }
    }
}

/// The fields of a line. Those that only describe a case, as in published collections, are let through.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    id: Id,
    frame: Vec<String>,
    model: Strict,
    source_model: Option<Strict>,
    rule: String,
    #[serde(default)]
    params: Object,
    #[serde(default, deserialize_with = "not_null")]
    sources: Option<Vec<Masses>>,
    keys: Option<Vec<String>>,
    #[serde(rename = "source")]
    _source: Option<IgnoredAny>,
    #[serde(rename = "expected")]
    _expected: Option<IgnoredAny>,
    #[serde(rename = "tolerance")]
    _tolerance: Option<IgnoredAny>,
    #[serde(rename = "verified")]
    _verified: Option<IgnoredAny>,
    #[serde(rename = "note")]
    _note: Option<IgnoredAny>,
}

/// What can be told of a line that is no case.
#[derive(serde::Deserialize)]
struct Named {
    id: Id,
}

/// A field that may be absent, but not null.
fn not_null<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// A reader's complaint, with its column; the line is ours to count.
fn told(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
    format!("column {}: {what}", error.column())
}

/// The masses of one source, as written: an expression that is given twice is not lost, but refused later.
struct Masses(Vec<(String, f64)>);

impl<'de> Deserialize<'de> for Masses {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Masses;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a source, {expression: mass}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Masses, A::Error> {
                let mut masses = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    masses.push(entry);
                }
                Ok(Masses(masses))
            }
        }
        deserializer.deserialize_map(Read)
    }
}

/// A case whose frames and sources are sound.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) frame: Frame,
    pub(super) source_frame: Option<Frame>,
    pub(super) rule: String,
    pub(super) params: Map<String, Value>,
    /// On the source frame, where there is one.
    sources: Option<Vec<MassFunction>>,
    pub(super) keys: Option<Vec<String>>,
}

impl Case {
    /// Reads a line. The `id` is told even of a line that is no case, if only the line is JSON.
    pub(super) fn read(line: &[u8]) -> (Id, Result<Self, CaseError>) {
        // A list would be read as the fields in their order, which nobody means.
        if line.trim_ascii_start().first() != Some(&b'{') {
            return (None, Err(CaseError::malformed("expected a JSON object".to_owned())));
        }
        match serde_json::from_slice::<Line>(line) {
            Ok(mut read) => (read.id.take(), Self::check(read)),
            Err(error) => {
                let named: Option<Named> = serde_json::from_slice(line).ok();
                (named.and_then(|named| named.id), Err(CaseError::malformed(told(&error))))
            }
        }
    }

    fn check(line: Line) -> Result<Self, CaseError> {
        let frame = model(&line.frame, &line.model).map_err(|error| error.at("model"))?;
        let source_frame = match &line.source_model {
            None => None,
            Some(given) => {
                Some(model(&line.frame, given).map_err(|error| error.at("source_model"))?)
            }
        };
        let given_on = source_frame.as_ref().unwrap_or(&frame);
        let source = |(index, Masses(masses)): (usize, &Masses)| {
            let masses = masses.iter().map(|(text, mass)| (text.as_str(), *mass));
            MassFunction::parse(given_on, masses)
                .map_err(|error| CaseError::from(error).at(format_args!("source {index}")))
        };
        let all = |sources: &Vec<Masses>| sources.iter().enumerate().map(source).collect();
        let sources = line.sources.as_ref().map(all).transpose()?;
        let Line { rule, params: Object(params), keys, .. } = line;
        check_keys(keys.as_deref().unwrap_or_default())?;
        Ok(Self { frame, source_frame, rule, params, sources, keys })
    }

    /// The sources as they were given, on the source frame where there is one.
    pub(super) fn sources(&self) -> Result<&[MassFunction], CaseError> {
        let missing = || {
            let rule = &self.rule;
            CaseError::malformed(format!("missing field `sources`; operation `{rule}` needs it"))
        };
        self.sources.as_deref().ok_or_else(missing)
    }

    /// Refuses sources, for operations that only look at the frame.
    pub(super) fn without_sources(&self) -> Result<(), CaseError> {
        match self.sources.as_deref() {
            None | Some([]) => Ok(()),
            Some(sources) => Err(self.source_count(sources.len(), "none")),
        }
    }

    /// The expressions asked for, each with its element.
    pub(super) fn asked(&self) -> Result<Vec<(String, Element)>, CaseError> {
        let Some(keys) = &self.keys else {
            let atoms = self.frame.alternatives().into_iter();
            return Ok(atoms.map(|atom| (self.frame.print(atom), atom)).collect());
        };
        let read = |key: &String| match self.frame.parse(key) {
            Ok(element) => Ok((key.clone(), element)),
            Err(error) => Err(CaseError::from(error).at("keys")),
        };
        keys.iter().map(read).collect()
    }

    /// The source of an operation on one, as the frame of the answer sees it.
    pub(super) fn only_source(&self) -> Result<MassFunction, CaseError> {
        let [source] = self.exactly()?;
        Ok(source)
    }

    /// The two sources of an operation on a pair.
    pub(super) fn pair(&self) -> Result<[MassFunction; 2], CaseError> {
        self.exactly()
    }

    fn exactly<const N: usize>(&self) -> Result<[MassFunction; N], CaseError> {
        let counted = |sources: Vec<_>| self.source_count(sources.len(), &N.to_string());
        self.translated()?.try_into().map_err(counted)
    }

    /// All sources on the frame of the answer.
    pub(super) fn translated(&self) -> Result<Vec<MassFunction>, CaseError> {
        let translate = |source: &MassFunction| match &self.source_frame {
            None => Ok(source.clone()),
            Some(from) => self.frame.translate_mass(from, source),
        };
        Ok(self.sources()?.iter().map(translate).collect::<Result<_, _>>()?)
    }

    pub(super) fn source_count(&self, found: usize, expected: &str) -> CaseError {
        let rule = &self.rule;
        CaseError::malformed(format!("{found} sources; operation `{rule}` takes {expected}"))
    }

    /// A parameter as a number.
    pub(super) fn number(&self, name: &str) -> Result<f64, CaseError> {
        self.optional_number(name)?.ok_or_else(|| self.missing(name, "a number"))
    }

    /// A parameter as a number, if it is there.
    pub(super) fn optional_number(&self, name: &str) -> Result<Option<f64>, CaseError> {
        let Some(value) = self.params.get(name) else { return Ok(None) };
        let number = value.as_f64().ok_or_else(|| Self::wrong(name, value, "a number"))?;
        Ok(Some(number))
    }

    /// A parameter as a list of numbers, if it is there.
    pub(super) fn optional_numbers(&self, name: &str) -> Result<Option<Vec<f64>>, CaseError> {
        let Some(value) = self.params.get(name) else { return Ok(None) };
        let wrong = || Self::wrong(name, value, "a list of numbers");
        let list = value.as_array().ok_or_else(wrong)?;
        let numbers = list.iter().map(Value::as_f64).collect::<Option<_>>().ok_or_else(wrong)?;
        Ok(Some(numbers))
    }

    /// A parameter as text.
    pub(super) fn text(&self, name: &str, expected: &str) -> Result<&str, CaseError> {
        let value = self.params.get(name).ok_or_else(|| self.missing(name, expected))?;
        value.as_str().ok_or_else(|| Self::wrong(name, value, expected))
    }

    /// A parameter as an element of a frame.
    pub(super) fn element(&self, name: &str, frame: &Frame) -> Result<Element, CaseError> {
        let text = self.text(name, "an expression")?;
        frame.parse(text).map_err(|error| CaseError::from(error).at(format_args!("params.{name}")))
    }

    /// A parameter as numbers by element.
    pub(super) fn by_element(&self, name: &str) -> Result<Vec<(Element, f64)>, CaseError> {
        const EXPECTED: &str = "an object {expression: number}";
        let value = self.params.get(name).ok_or_else(|| self.missing(name, EXPECTED))?;
        let object = value.as_object().ok_or_else(|| Self::wrong(name, value, EXPECTED))?;
        let read = |(text, number): (&String, &Value)| {
            let element = self.frame.parse(text);
            let element = element
                .map_err(|error| CaseError::from(error).at(format_args!("params.{name}")))?;
            let number = number.as_f64().ok_or_else(|| Self::wrong(name, value, EXPECTED))?;
            Ok((element, number))
        };
        object.iter().map(read).collect()
    }

    fn missing(&self, name: &str, expected: &str) -> CaseError {
        let rule = &self.rule;
        CaseError::malformed(format!("operation `{rule}` needs params.{name}, {expected}"))
    }

    pub(super) fn wrong(name: &str, value: &Value, expected: &str) -> CaseError {
        CaseError::malformed(format!("params.{name} is {value}; expected {expected}"))
    }
}

/// Refuses an expression that is asked for twice: an answer has one value of a name.
fn check_keys(keys: &[String]) -> Result<(), CaseError> {
    let mut seen = BTreeSet::new();
    match keys.iter().find(|key| !seen.insert(key.as_str())) {
        None => Ok(()),
        Some(key) => Err(CaseError::malformed(format!("keys: `{key}` is asked for twice"))),
    }
}

fn model(atoms: &[String], Strict(model): &Strict) -> Result<Frame, CaseError> {
    let wrong = || {
        CaseError::malformed(format!(
            "{model}; expected \"free\", \"shafer\" or {{\"empty\": [expressions]}}"
        ))
    };
    match model {
        Value::String(name) if name == "free" => Ok(Frame::free(atoms)?),
        Value::String(name) if name == "shafer" => Ok(Frame::shafer(atoms)?),
        Value::Object(object) if object.len() == 1 => {
            let empty = object.get("empty").and_then(Value::as_array).ok_or_else(wrong)?;
            let empty = empty.iter().map(Value::as_str).collect::<Option<Vec<_>>>();
            Ok(Frame::with_empty(atoms, &empty.ok_or_else(wrong)?)?)
        }
        _ => Err(wrong()),
    }
}
