//! The schema that `wisdom schema` prints, against the missions that ship, the reader and docs/mission.md.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use wisdom_belief::Rule;
use wisdom_mission::{Described, Mission, Override, schema};
use wisdom_planner::Preset;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A TOML file as JSON. Infinite bounds have no JSON and are left out, as a file may leave them out.
fn as_json(text: &str) -> Value {
    let table: toml::Table = text.parse().expect("it is TOML");
    serde_json::to_value(table).expect("TOML is JSON")
}

/// What a schema has against a file.
fn complaints(of: Described, file: &Value) -> Vec<String> {
    let schema = schema(of);
    let mut found = Vec::new();
    validate(&schema, &schema, file, "", &mut found);
    found
}

/// The part of JSON Schema that our schemas use (draft 2020-12, Validation); a keyword not known here fails the test, so
/// that none is passed over.
fn validate(root: &Value, schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let keywords = match schema {
        Value::Bool(true) => return,
        Value::Bool(false) => return found.push(format!("{path}: nothing is allowed here")),
        schema => schema.as_object().expect("a schema is an object"),
    };
    let passes = |schema: &Value| {
        let mut found = Vec::new();
        validate(root, schema, value, path, &mut found);
        found.is_empty()
    };
    let number = value.as_f64();
    let count = value.as_array().map(Vec::len);
    for (keyword, asked) in keywords {
        let limit = || asked.as_f64().expect("a limit is a number");
        let length = || asked.as_u64().expect("a length is a count") as usize;
        let fits = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" => true,
            "$ref" => {
                let place = asked.as_str().expect("a reference").trim_start_matches('#');
                validate(root, root.pointer(place).expect("a definition"), value, path, found);
                true
            }
            "type" => match asked.as_str().expect("one type") {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => number.is_some_and(|n| n.fract() == 0.0),
                other => panic!("{path}: type {other}"),
            },
            "enum" => asked.as_array().expect("a list").contains(value),
            "const" => asked == value,
            "minimum" => number.is_none_or(|n| n >= limit()),
            "maximum" => number.is_none_or(|n| n <= limit()),
            "exclusiveMinimum" => number.is_none_or(|n| n > limit()),
            "exclusiveMaximum" => number.is_none_or(|n| n < limit()),
            "minItems" => count.is_none_or(|n| n >= length()),
            "maxItems" => count.is_none_or(|n| n <= length()),
            // Ours are all of names made of these.
            "pattern" => value.as_str().is_none_or(|text| {
                assert!(asked.as_str().is_some_and(|p| p.starts_with("^[A-Za-z0-9_-]")));
                !text.is_empty()
                    && text.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c))
            }),
            "anyOf" => asked.as_array().expect("a list").iter().any(passes),
            "oneOf" => {
                asked.as_array().expect("a list").iter().filter(|one| passes(one)).count() == 1
            }
            "required" => value.as_object().is_none_or(|table| {
                let names = asked.as_array().expect("a list").iter();
                names.clone().all(|name| table.contains_key(name.as_str().expect("a name")))
            }),
            "properties" => {
                for (key, schema) in asked.as_object().expect("a table") {
                    if let Some(value) = value.get(key) {
                        validate(root, schema, value, &format!("{path}.{key}"), found);
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = &keywords.get("properties").unwrap_or(&Value::Null);
                for (key, value) in value.as_object().into_iter().flatten() {
                    if known.get(key).is_none() {
                        validate(root, asked, value, &format!("{path}.{key}"), found);
                    }
                }
                true
            }
            "items" => {
                for (i, value) in value.as_array().into_iter().flatten().enumerate() {
                    validate(root, asked, value, &format!("{path}.{i}"), found);
                }
                true
            }
            other => panic!("{path}: keyword {other} is not known here"),
        };
        if !fits {
            found.push(format!("{path}: {value} against {keyword} {asked}"));
        }
    }
}

/// The folders of the missions that ship.
fn missions() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join("missions")).expect("missions ship");
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    folders.retain(|folder| folder.join("mission.toml").is_file());
    folders.sort();
    assert!(folders.len() >= 2, "{folders:?}");
    folders
}

#[test]
fn every_shipped_file_is_as_the_schema_says() {
    let mut landscapes = 0;
    for folder in missions() {
        let mission = as_json(&read(&folder.join("mission.toml")));
        assert_eq!(complaints(Described::Mission, &mission), [""; 0], "{}", folder.display());
        for expert in mission["experts"].as_array().expect("experts") {
            let path = folder.join(expert.as_str().expect("a path"));
            let table = as_json(&read(&path));
            assert_eq!(complaints(Described::Expert, &table), [""; 0], "{}", path.display());
        }
        if let Some(landscape) = mission["terrain"]["landscape"].as_str() {
            let scene = as_json(&read(&folder.join(landscape)));
            assert_eq!(complaints(Described::Landscape, &scene), [""; 0], "{}", folder.display());
            landscapes += 1;
        }
    }
    assert!(landscapes > 0, "the paper's scene is a landscape");
    for preset in Preset::all() {
        let mut mission = as_json(&read(&root().join("missions/paper/mission.toml")));
        mission["rover"]["vehicle"] = serde_json::to_value(preset.table()).expect("TOML is JSON");
        assert_eq!(complaints(Described::Mission, &mission), [""; 0], "{}", preset.name());
    }
}

/// The paper's mission with one value put at a path of keys and indices.
fn paper_with(path: &[&str], value: Value) -> Value {
    let mut mission = as_json(&read(&root().join("missions/paper/mission.toml")));
    let mut at = &mut mission;
    for key in path {
        at = match key.parse::<usize>() {
            Ok(index) => &mut at[index],
            Err(_) => &mut at[*key],
        };
    }
    *at = value;
    mission
}

#[test]
fn unknown_keys_wrong_types_and_wrong_names_are_refused() {
    let cases: [(&[&str], Value); 13] = [
        (&["sed"], json!(1)),
        (&["rover", "look-evry-m"], json!(5.0)),
        (&["directive", "0", "stand-off"], json!(5.0)),
        (&["rover", "vehicle", "slope-max"], json!(5.0)),
        (&["prior", "uncertainty", "elevation"], json!({ "sigth": 0.2 })),
        (&["seed"], json!("one")),
        (&["budget", "time-s"], json!("long")),
        (&["experts"], json!("experts/dem.toml")),
        (&["rule"], json!("dsmk")),
        (&["rule"], json!("bold")),
        (&["statistic"], json!("plausibility")),
        (&["layer", "0", "update"], json!("newest")),
        (&["rover", "start"], json!([50])),
    ];
    for (path, value) in cases {
        let found = complaints(Described::Mission, &paper_with(path, value.clone()));
        assert!(!found.is_empty(), "{path:?} = {value} passes");
    }
    for needed in ["name", "terrain", "layer", "experts", "rover", "budget", "operator"] {
        let mut mission = paper_with(&["seed"], json!(1));
        mission.as_object_mut().expect("a table").remove(needed);
        assert!(!complaints(Described::Mission, &mission).is_empty(), "without {needed} it passes");
    }
    let expert = json!({ "name": "a", "layer": "b", "quantity": "c", "outside": { "paradox": 2.0, "not-interesting": 0, "interesting": 0 } });
    assert!(!complaints(Described::Expert, &expert).is_empty());
    assert!(!complaints(Described::Landscape, &json!({ "base": { "rise_west": 1.0 } })).is_empty());
}

#[test]
fn names_are_those_the_code_knows() {
    let schema = schema(Described::Mission);
    let names = |key: &str| -> BTreeSet<String> {
        let list = schema["properties"][key]["enum"].as_array().expect("names");
        list.iter().map(|name| name.as_str().expect("a name").to_owned()).collect()
    };
    let load = |key: &str, value: &str| {
        let paper = root().join("missions/paper");
        Mission::load(&paper, &[Override::new(key, format!("\"{value}\""))])
    };
    let known: BTreeSet<String> = Rule::ALL.map(|rule| rule.to_string()).into();
    let refused: Vec<&String> = known.iter().filter(|rule| load("rule", rule).is_err()).collect();
    let told = names("rule");
    let missing: Vec<&String> = known.difference(&told).collect();
    assert_eq!(missing, refused);
    for key in ["statistic", "policy", "prize"] {
        for name in names(key) {
            assert!(load(key, &name).is_ok(), "{key} = {name}");
        }
    }
}

/// Follows a reference, and a list to what it is a list of.
fn shape<'a>(schema: &'a Value, mut at: &'a Value) -> &'a Value {
    loop {
        if let Some(reference) = at["$ref"].as_str() {
            at = schema.pointer(reference.trim_start_matches('#')).expect("a definition");
        } else if at["items"].is_object() {
            at = &at["items"];
        } else {
            return at;
        }
    }
}

/// Every key of a schema that has a number: its path, as an override gives it, and its definition.
fn numbers(schema: &Value, at: &Value, path: &str, into: &mut Vec<(String, Value)>) {
    let Some(properties) = at["properties"].as_object() else { return };
    for (key, value) in properties {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        if value["type"] == "number" || value["type"] == "integer" {
            into.push((path, value.clone()));
        } else if value["items"]["$ref"].is_string() {
            numbers(schema, shape(schema, value), &format!("{path}.0"), into);
        } else {
            numbers(schema, shape(schema, value), &path, into);
        }
    }
}

#[test]
fn what_a_range_of_the_schema_refuses_the_reader_refuses() {
    let schema = schema(Described::Mission);
    let mut all = Vec::new();
    numbers(&schema, &schema, "", &mut all);
    let paper = root().join("missions/paper");
    let fault = Override::new(
        "fault",
        "[{ name = \"hub\", kind = \"wheel-drag\", factor = 1.5, probability = 1.0 }]",
    );
    let mut asked = 0;
    for (key, definition) in all {
        // What is not in the paper's file, or means nothing there, is not asked about.
        let absent = ["fault.0.bias-m", "fault.0.delay-s", "prior.block", "prior.u"];
        if absent.contains(&key.as_str()) || key.starts_with("rover.vehicle.slip-class") {
            continue;
        }
        let is_integer = definition["type"] == "integer";
        let written =
            |number: f64| if is_integer { format!("{number:.0}") } else { format!("{number:e}") };
        let beyond = |name: &str, by: f64| {
            let limit = definition[name].as_f64()?;
            Some(if is_integer { limit + by } else { limit + by * limit.abs().max(1e-3) * 0.01 })
        };
        let outside = [
            beyond("minimum", -1.0),
            beyond("maximum", 1.0),
            definition["exclusiveMinimum"].as_f64(),
            definition["exclusiveMaximum"].as_f64(),
        ];
        for number in outside.into_iter().flatten() {
            let value = written(number);
            let changes = [fault.clone(), Override::new(&key, &value)];
            let refused = Mission::load(&paper, &changes);
            assert!(refused.is_err(), "the schema refuses {key} = {value}, the reader does not");
            asked += 1;
        }
    }
    assert!(asked > 120, "only {asked} limits");
}

#[test]
fn every_key_is_told_in_the_schema() {
    for of in Described::ALL {
        let schema = schema(of);
        let mut tables: Vec<&Value> = vec![&schema];
        tables.extend(schema["$defs"].as_object().expect("definitions").values());
        let mut told = 0;
        for table in tables {
            for (key, value) in table["properties"].as_object().into_iter().flatten() {
                let text = value["description"].as_str().unwrap_or_default();
                assert!(text.len() > 5, "{} {key}: `{text}`", table["title"]);
                assert!(!text.contains("[`") && !text.contains("```"), "{key}: {text}");
                told += 1;
            }
        }
        assert!(told > 10, "{}: {told}", of.name());
    }
    // Defaults are told in words and as values; the values are the code's.
    let mission = schema(Described::Mission);
    let mut compared = 0;
    for table in mission["$defs"].as_object().expect("definitions").values() {
        for (key, value) in table["properties"].as_object().into_iter().flatten() {
            let text = value["description"].as_str().unwrap_or_default();
            if let (Some(default), Some((_, told))) =
                (value["default"].as_f64(), text.split_once("Default: "))
            {
                assert_eq!(told.trim_end_matches('.').parse(), Ok(default), "{key}: {text}");
                compared += 1;
            }
        }
    }
    assert!(compared > 30, "{compared}");
    assert!(!mission.to_string().contains("null"), "TOML has no null");
}

/// The words in backticks.
fn ticked(text: &str) -> BTreeSet<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_manual_and_the_schema_have_the_same_keys() {
    let mission = schema(Described::Mission);
    let expert = schema(Described::Expert);
    let manual = read(&root().join("docs/mission.md"));
    let mut sections = 0;
    let mut described = BTreeSet::new();
    for section in manual.split("\n## ").skip(1) {
        let (heading, body) = section.split_once('\n').expect("a section has a body");
        // A heading without a table of the file is prose about all of them.
        let tables: Vec<&Value> = if heading == "Top level" {
            vec![&mission]
        } else if heading == "An expert's table" {
            let rows = ["band", "class", "outside"];
            let rows = rows.map(|key| shape(&expert, &expert["properties"][key]));
            rows.into_iter().chain([&expert]).collect()
        } else {
            let names = ticked(heading).into_iter().filter(|name| name.starts_with('['));
            names
                .map(|name| {
                    let path = name.trim_matches(['[', ']']);
                    described.insert(path.to_owned());
                    path.split('.').fold(&mission, |at, key| {
                        let at = &shape(&mission, at)["properties"][key];
                        assert!(at.is_object(), "{heading}: no such table");
                        at
                    })
                })
                .map(|at| shape(&mission, at))
                .collect()
        };
        if tables.is_empty() {
            continue;
        }
        sections += 1;
        let rows = body.lines().filter(|line| line.starts_with("| `"));
        let first_column = rows.map(|row| row.trim_start_matches('|').split('|').next());
        let manual: BTreeSet<String> = first_column.flatten().flat_map(ticked).collect();
        let of = |table: &&Value| -> Vec<String> {
            table["properties"].as_object().expect("a table").keys().cloned().collect()
        };
        let mut keys: BTreeSet<String> = tables.iter().flat_map(of).collect();
        if heading == "Top level" {
            keys.retain(|key| !manual_has_table(&mission, key));
        }
        keys.remove("vehicle");
        for row in ["band", "class", "outside"] {
            if heading == "An expert's table" {
                keys.remove(row);
                assert!(body.contains(row));
            }
        }
        assert_eq!(manual, keys, "{heading}");
    }
    assert!(sections > 10, "{sections}");
    let tables = mission["properties"].as_object().expect("a table").keys();
    for table in tables.filter(|key| manual_has_table(&mission, key)) {
        assert!(described.contains(table), "docs/mission.md has no section on [{table}]");
    }
}

/// Whether a key of the top level is a table, or a list of tables, with a section of its own.
fn manual_has_table(schema: &Value, key: &str) -> bool {
    shape(schema, &schema["properties"][key])["properties"].is_object()
}

#[test]
fn the_command_prints_the_schemas() {
    for (args, title) in [
        (&["schema"][..], "Wisdom mission"),
        (&["schema", "--of", "expert"], "Wisdom expert's table"),
        (&["schema", "--of", "landscape"], "Wisdom landscape"),
    ] {
        let output =
            Command::new(env!("CARGO_BIN_EXE_wisdom")).args(args).output().expect("it runs");
        assert!(output.status.success());
        let schema: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(schema["title"], title);
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    }
}
