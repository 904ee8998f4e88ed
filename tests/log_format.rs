//! `docs/log-format.md` names every topic, key, message and field of a log, and none that there is not.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use mcap::MessageStream;
use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{FieldDescriptorProto, FileDescriptorSet};
use wisdom_logbook::{LogReader, Options, record, topic};
use wisdom_mission::Mission;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn document() -> String {
    fs::read_to_string(root().join("docs/log-format.md")).expect("the document")
}

/// The rows of a table as their cells, without the backticks of the first.
fn row(line: &str) -> Option<Vec<&str>> {
    let cells = line.strip_prefix("| ")?.strip_suffix(" |")?;
    Some(cells.split(" | ").map(|cell| cell.trim_matches('`')).collect())
}

/// The part of the document under a heading, up to the next of the same or a higher rank.
fn section<'a>(document: &'a str, heading: &str) -> &'a str {
    let rank = heading.split(' ').next().expect("a rank");
    let start = document.find(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no {heading}"));
    let body = &document[start + heading.len() + 2..];
    let end = (1..=rank.len())
        .filter_map(|rank| body.find(&format!("\n{} ", "#".repeat(rank))))
        .min()
        .unwrap_or(body.len());
    &body[..end]
}

/// Names in backticks in the first column of a section's tables.
fn first_column(section: &str) -> BTreeSet<String> {
    section
        .lines()
        .filter(|line| line.starts_with("| `"))
        .filter_map(|line| line.split(" | ").next())
        .flat_map(|cell| cell.split('`').skip(1).step_by(2).map(ToOwned::to_owned))
        .collect()
}

/// A field as the document writes it: tag and type.
fn written(field: &FieldDescriptorProto) -> (String, String) {
    let name = match field.r#type() {
        Type::Double => "double",
        Type::Float => "float",
        Type::Uint32 => "uint32",
        Type::Uint64 => "uint64",
        Type::Fixed64 => "fixed64",
        Type::Bool => "bool",
        Type::String => "string",
        Type::Message => field.type_name().trim_start_matches(".wisdom.v1."),
        other => panic!("{}: the document knows no {other:?}", field.name()),
    };
    let kind = match field.label() {
        Label::Repeated => format!("repeated {name}"),
        _ if field.proto3_optional() => format!("optional {name}"),
        _ => name.to_owned(),
    };
    (field.number().to_string(), kind)
}

/// Messages with their fields.
fn messages(descriptor: &[u8]) -> BTreeMap<String, Vec<FieldDescriptorProto>> {
    let set = FileDescriptorSet::decode(descriptor).expect("a descriptor set");
    set.file
        .into_iter()
        .filter(|file| file.package() == "wisdom.v1")
        .flat_map(|file| file.message_type)
        .map(|message| (message.name().to_owned(), message.field))
        .collect()
}

/// The decision version of the first sample log that knew each message and field.
fn firsts() -> BTreeMap<String, String> {
    let mut firsts = BTreeMap::new();
    let samples = [
        ("1", "paper-0.1.0"),
        ("2", "paper-decisions-2"),
        ("3", "paper-decisions-3"),
        ("4", "paper-decisions-4"),
        ("5", "paper-decisions-5"),
    ];
    for (version, name) in samples {
        let bytes = fs::read(root().join(format!("logs/sample/{name}.mcap"))).expect("a sample");
        let schema = MessageStream::new(&bytes)
            .expect("a log")
            .filter_map(|message| message.expect("a message").channel.schema.clone())
            .find(|schema| schema.name == "wisdom.v1.Decision")
            .expect("every log has decisions");
        for (message, fields) in messages(&schema.data) {
            for field in fields {
                let path = format!("{message}.{}", field.name());
                firsts.entry(path).or_insert_with(|| version.to_owned());
            }
        }
    }
    firsts
}

#[test]
fn every_message_and_field_is_told_with_its_tag_type_and_first_version() {
    let document = document();
    let described = section(&document, "## Messages");
    let known = messages(record::DESCRIPTOR);
    let told: BTreeSet<&str> = described
        .lines()
        .filter_map(|line| line.strip_prefix("### `")?.strip_suffix('`'))
        .collect();
    assert_eq!(told, known.keys().map(String::as_str).collect());
    let firsts = firsts();
    for (message, fields) in &known {
        let rows: Vec<Vec<&str>> = section(&document, &format!("### `{message}`"))
            .lines()
            .filter(|line| line.starts_with("| `"))
            .filter_map(row)
            .collect();
        let told: Vec<[&str; 4]> = rows.iter().map(|r| [r[0], r[1], r[2], r[3]]).collect();
        let expected: Vec<[String; 4]> = fields
            .iter()
            .map(|field| {
                let (tag, kind) = written(field);
                let path = format!("{message}.{}", field.name());
                let since = firsts.get(&path).map_or("next", String::as_str).to_owned();
                [field.name().to_owned(), tag, kind, since]
            })
            .collect();
        assert_eq!(told, expected, "{message}");
        for row in &rows {
            assert!(row.len() == 5 && row[4].len() > 3, "{message}.{} is not told", row[0]);
        }
    }
}

#[test]
fn every_topic_is_told_with_its_schema() {
    let document = document();
    let told = first_column(section(&document, "## Topics"));
    let named = topic::ALL.into_iter().chain(["/map/NAME"]);
    let expected: BTreeSet<String> = named.map(ToOwned::to_owned).collect();
    assert_eq!(told, expected);
    let bytes = fs::read(root().join("logs/sample/paper-decisions-5.mcap")).expect("a sample");
    for message in MessageStream::new(&bytes).expect("a log") {
        let channel = message.expect("a message").channel;
        let schema = &channel.schema.as_ref().expect("every channel has one").name;
        let name =
            if channel.topic == "/map/elevation" { "/map/NAME" } else { channel.topic.as_str() };
        assert!(document.contains(&format!("| `{name}` | `{schema}` |")), "{name} {schema}");
    }
}

#[test]
fn every_plane_is_told() {
    let document = document();
    let section = section(&document, "## Planes");
    let rows = section.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let told: BTreeSet<String> =
        rows.flat_map(|names| names.split(", ")).map(|name| name.replace('`', "")).collect();
    let mission = Mission::load(&root().join("missions/paper"), &[]).expect("it loads");
    let spec = &mission.spec;
    let named = spec.layers.iter().map(|layer| &layer.name);
    let names: Vec<&String> = named.chain(spec.experts.iter().map(|expert| &expert.name)).collect();
    let general = |plane: String| {
        let part = |name: &&&String| plane.split('-').any(|part| part == name.as_str());
        names.iter().find(part).map_or_else(|| plane.clone(), |name| plane.replace(*name, "NAME"))
    };
    let all = wisdom_logbook::planes(spec).into_iter().map(|plane| general(plane.name));
    let expected: BTreeSet<String> = all.chain(["plane", "---"].map(ToOwned::to_owned)).collect();
    assert_eq!(told, expected);
}

#[test]
fn every_metadata_key_of_a_run_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("empty.mcap");
    let mission = Mission::load(&root().join("missions/paper"), &[]).expect("it loads");
    let log = wisdom_logbook::begin(&path, &mission, Options::default()).expect("a log");
    log.finish("stopped", &BTreeMap::new()).expect("it is written");
    let log = LogReader::open(&path).expect("a log");
    let document = document();
    let told = first_column(section(&document, "### Metadata `wisdom.run`"));
    assert_eq!(told, log.metadata.keys().cloned().collect());
    let end = log.end.expect("the run ended");
    let mut keys: BTreeSet<String> = end.facts.into_keys().collect();
    keys.extend(["status", "decisions", "chain"].map(ToOwned::to_owned));
    assert_eq!(first_column(section(&document, "### Metadata `wisdom.end`")), keys);
}

#[test]
fn links_of_the_document_lead_somewhere() {
    let document = document();
    for link in document.split("](").skip(1) {
        let link = link.split(')').next().expect("a link ends");
        if let Some(anchor) = link.strip_prefix('#') {
            let title = |line: &str| {
                let name = line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
                line.starts_with('#') && name == anchor
            };
            assert!(document.lines().any(title), "#{anchor}");
        } else if !link.starts_with("https://") {
            assert!(root().join("docs").join(link).exists(), "{link}");
        }
    }
}
