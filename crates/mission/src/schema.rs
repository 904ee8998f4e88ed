//! The JSON Schema of the files of a mission, for editors: drawn from the very types that read them.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::Value;
use wisdom_autonomy::Pace;
use wisdom_belief::{ParadoxPolicy, Rule};
use wisdom_fusion::Statistic;
use wisdom_goals::{Kind, Policy, PrizeScale};
use wisdom_planner::Preset;
use wisdom_terrain::{Landscape, Resampling};

use crate::file::{ExpertFile, MissionFile};

/// A file of a mission that [`schema`] describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[non_exhaustive]
pub enum Described {
    /// `mission.toml`.
    #[default]
    Mission,
    /// An expert's table.
    Expert,
    /// A synthetic landscape.
    Landscape,
}

impl Described {
    /// Every file there is a schema of.
    pub const ALL: [Self; 3] = [Self::Mission, Self::Expert, Self::Landscape];

    /// Its name in a command: `mission`, `expert`, `landscape`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mission => "mission",
            Self::Expert => "expert",
            Self::Landscape => "landscape",
        }
    }
}

/// The JSON Schema (draft 2020-12) of a file: keys with their meaning, unit and default, ranges that do not hang on
/// other keys, and the names of rules, policies and the like as this version knows them.
///
/// What the schema refuses, reading refuses too (but for names of rules written with underscores); reading asks more, such as a layer for every expert.
///
/// ```
/// use wisdom_mission::{Described, schema};
///
/// let schema = schema(Described::Mission);
/// assert!(schema["properties"]["rule"]["enum"].as_array().is_some_and(|rules| rules.contains(&"dsmc".into())));
/// ```
#[must_use]
pub fn schema(of: Described) -> Value {
    let (schema, title) = match of {
        Described::Mission => (drawn::<MissionFile>(), "Wisdom mission"),
        Described::Expert => (drawn::<ExpertFile>(), "Wisdom expert's table"),
        Described::Landscape => (drawn::<Landscape>(), "Wisdom landscape"),
    };
    let mut schema = schema.to_value();
    schema["title"] = title.into();
    schema
}

fn drawn<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12();
    settings
        .with_transform(RecursiveTransform(told_to_people))
        .into_generator()
        .into_root_schema_for::<T>()
}

/// TOML has no null: an optional key is left out. Rust's number formats and links mean nothing to an editor.
fn told_to_people(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else { return };
    object.remove("format");
    if object.get("default").is_some_and(Value::is_null) {
        object.remove("default");
    }
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            object.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(options)) = object.get_mut("anyOf") {
        options.retain(|option| option["type"] != "null");
        if let [only] = &options[..]
            && let Value::Object(only) = only.clone()
        {
            object.remove("anyOf");
            for (key, value) in only {
                object.entry(key).or_insert(value);
            }
        }
    }
    if let Some(Value::String(text)) = object.get_mut("description") {
        let prose = text.split("\n\n```").next().unwrap_or_default();
        *text = prose.replace("[`", "`").replace("`]", "`");
    }
}

fn names(names: impl IntoIterator<Item = String>) -> Schema {
    json_schema!({ "type": "string", "enum": names.into_iter().collect::<Vec<_>>() })
}

/// Rules of combination that maps can be made with.
pub(crate) fn rules(_: &mut SchemaGenerator) -> Schema {
    names(Rule::ALL.into_iter().filter(|rule| rule.on_maps()).map(|rule| rule.to_string()))
}

pub(crate) fn paradox_policies(_: &mut SchemaGenerator) -> Schema {
    names(ParadoxPolicy::ALL.map(|policy| policy.to_string()))
}

pub(crate) fn statistics(_: &mut SchemaGenerator) -> Schema {
    names(Statistic::ALL.map(|statistic| statistic.to_string()))
}

pub(crate) fn policies(_: &mut SchemaGenerator) -> Schema {
    names(Policy::ALL.map(|policy| policy.to_string()))
}

pub(crate) fn paces(_: &mut SchemaGenerator) -> Schema {
    names(Pace::ALL.map(|pace| pace.name().to_owned()))
}

pub(crate) fn kinds(_: &mut SchemaGenerator) -> Schema {
    names(Kind::ALL.iter().map(ToString::to_string))
}

pub(crate) fn prizes(_: &mut SchemaGenerator) -> Schema {
    names(PrizeScale::ALL.map(|prize| prize.to_string()))
}

pub(crate) fn resamplings(_: &mut SchemaGenerator) -> Schema {
    names(Resampling::ALL.map(|way| way.to_string()))
}

/// A built-in vehicle, or the name of one of the mission's own.
pub(crate) fn presets(_: &mut SchemaGenerator) -> Schema {
    let built_in: Vec<&str> = Preset::all().iter().map(|preset| preset.name()).collect();
    json_schema!({
        "anyOf": [
            { "type": "string", "enum": built_in },
            { "type": "string", "pattern": "^[A-Za-z0-9_-]+$" },
        ]
    })
}
