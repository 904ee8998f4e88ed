//! Every topic and message path that the layout for viewers names is one of a log's.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{FieldDescriptorProto, FileDescriptorSet};
use serde_json::Value;
use wisdom_logbook::{record, topic};

/// Topics whose messages are ours, with their schemas.
const OURS: [(&str, &str); 5] = [
    (topic::OBSERVATION, "Observation"),
    (topic::OUTCOME, "Outcome"),
    (topic::MESSAGE, "Message"),
    (topic::FAULT, "Fault"),
    (topic::DECISION, "Decision"),
];

/// Fields by which topics that are drawn may be coloured.
const DRAWN: [(&str, &[&str]); 5] = [
    (topic::INTEREST, &["value"]),
    ("/map/elevation", &["value"]),
    (topic::CLOUD, &["x", "y", "z", "interest"]),
    (topic::SCENE, &[]),
    (topic::POSE, &[]),
];

/// What a message path leads to.
#[derive(Debug, PartialEq, Eq)]
enum Leaf {
    Number,
    Text,
    Message,
    Messages,
}

/// Messages of the records, with their fields.
struct Schemas(BTreeMap<String, Vec<FieldDescriptorProto>>);

impl Schemas {
    fn ours() -> Self {
        let set = FileDescriptorSet::decode(record::DESCRIPTOR).expect("a descriptor set");
        let messages = set.file.into_iter().flat_map(|file| file.message_type);
        Self(messages.map(|m| (m.name().to_owned(), m.field)).collect())
    }

    /// What `/topic.field[0].field` leads to: the topic is the longest that the path begins with.
    fn leaf(&self, path: &str) -> Result<Leaf, String> {
        let (topic, fields) = path.split_once('.').unwrap_or((path, ""));
        let (_, schema) = OURS
            .iter()
            .find(|(name, _)| *name == topic)
            .ok_or_else(|| format!("{path}: no topic {topic}"))?;
        let (mut message, mut leaf) = ((*schema).to_owned(), Leaf::Message);
        for step in fields.split('.').filter(|step| !step.is_empty()) {
            if leaf != Leaf::Message {
                return Err(format!("{path}: `{step}` has no single message before it"));
            }
            let (name, index) = match step.split_once('[') {
                Some((name, index)) => {
                    let index = index.strip_suffix(']').unwrap_or_default();
                    index.parse::<usize>().map_err(|_| format!("{path}: `{index}` is no index"))?;
                    (name, true)
                }
                None => (step, false),
            };
            let field = self.0[&message]
                .iter()
                .find(|field| field.name() == name)
                .ok_or_else(|| format!("{path}: {message} has no `{name}`"))?;
            let many = field.label() == Label::Repeated;
            if index && !many {
                return Err(format!("{path}: `{name}` is no list"));
            }
            leaf = match field.r#type() {
                Type::Message if many && !index => Leaf::Messages,
                Type::Message => Leaf::Message,
                Type::String => Leaf::Text,
                _ => Leaf::Number,
            };
            if leaf == Leaf::Message {
                message = field.type_name().trim_start_matches(".wisdom.v1.").to_owned();
            }
        }
        Ok(leaf)
    }
}

fn layout() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/layouts/wisdom.lichtblick.json");
    serde_json::from_str(&fs::read_to_string(path).expect("the layout")).expect("JSON")
}

/// The panels that a part of the layout shows: a name, or two parts side by side.
fn panels(part: &Value, found: &mut Vec<String>) {
    if let Some(name) = part.as_str() {
        found.push(name.to_owned());
    } else {
        assert!(["row", "column"].contains(&part["direction"].as_str().expect("a direction")));
        panels(&part["first"], found);
        panels(&part["second"], found);
    }
}

#[test]
fn every_path_of_the_layout_leads_to_what_its_panel_shows() {
    let (layout, schemas) = (layout(), Schemas::ours());
    let leaf = |path: &Value| {
        let path = path.as_str().expect("a path");
        schemas.leaf(path).unwrap_or_else(|error| panic!("{error}"))
    };
    let mut seen = BTreeMap::<String, usize>::new();
    for (name, panel) in layout["configById"].as_object().expect("panels") {
        let kind = name.split('!').next().expect("a kind");
        *seen.entry(kind.to_owned()).or_default() += 1;
        let paths = || panel["paths"].as_array().expect("paths").iter().map(|path| &path["value"]);
        match kind {
            "Table" => assert_eq!(leaf(&panel["topicPath"]), Leaf::Messages, "{name}"),
            "RawMessages" => assert_eq!(leaf(&panel["topicPath"]), Leaf::Message, "{name}"),
            "StateTransitions" => assert!(paths().all(|path| leaf(path) == Leaf::Text), "{name}"),
            "Plot" => assert!(paths().all(|path| leaf(path) == Leaf::Number), "{name}"),
            "RosOut" => assert_eq!(panel["topicToRender"], topic::LOG),
            "3D" => {
                for (topic, look) in panel["topics"].as_object().expect("topics") {
                    let (_, fields) = DRAWN
                        .iter()
                        .find(|(name, _)| name == topic)
                        .unwrap_or_else(|| panic!("{name}: nothing is drawn of {topic}"));
                    let field = look.get("colorField").and_then(Value::as_str);
                    assert!(field.is_none_or(|f| fields.contains(&f)), "{name}: {topic} {field:?}");
                }
            }
            "Tab" => {}
            other => panic!("{name}: {other} is no panel that was tried"),
        }
    }
    for kind in ["3D", "Table", "StateTransitions", "Plot", "RosOut", "RawMessages"] {
        assert!(seen.contains_key(kind), "no {kind}");
    }
}

#[test]
fn every_panel_of_the_layout_is_shown_once() {
    let layout = layout();
    let known = layout["configById"].as_object().expect("panels");
    let mut shown = Vec::new();
    panels(&layout["layout"], &mut shown);
    for (_, tabs) in known.iter().filter(|(name, _)| name.starts_with("Tab!")) {
        for tab in tabs["tabs"].as_array().expect("tabs") {
            panels(&tab["layout"], &mut shown);
        }
    }
    shown.sort_unstable();
    assert_eq!(shown, known.keys().cloned().collect::<Vec<_>>());
}

#[test]
fn the_walker_tells_a_wrong_path() {
    let schemas = Schemas::ours();
    for (path, words) in [
        ("/decisions.number", "no topic"),
        ("/decision.numbers", "has no `numbers`"),
        ("/decision.triggers.name", "no single message"),
        ("/decision.number[0]", "no list"),
        ("/decision.triggers[x].name", "no index"),
        ("/decision.number.digits", "no single message"),
    ] {
        let error = schemas.leaf(path).expect_err(path);
        assert!(error.contains(words), "{error}");
    }
}
