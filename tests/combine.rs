//! The door for scripts: `wisdom combine` and `wisdom rules` as a user's program sees them.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use wisdom_belief::{Frame, Rule};

/// What `wisdom combine` writes when it is given these lines; it must not fail.
fn output(input: &[u8]) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .arg("combine")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut stdin = child.stdin.take().expect("piped");
    let input = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().expect("it ends");
    writer.join().expect("no panic").expect("it reads all");
    assert!(output.status.success(), "{:?}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn combine(input: &[u8]) -> Vec<Value> {
    output(input)
        .lines()
        .map(|line| serde_json::from_str(line).expect("an object a line"))
        .collect()
}

fn one(case: &Value) -> Value {
    let mut answers = combine(case.to_string().as_bytes());
    assert_eq!(answers.len(), 1);
    answers.remove(0)
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

fn frame(case: &Value) -> Frame {
    let atoms = case["frame"].as_array().expect("atoms").iter().map(text);
    match &case["model"] {
        Value::String(name) if name == "free" => Frame::free(atoms),
        Value::String(name) if name == "shafer" => Frame::shafer(atoms),
        model => {
            let empty = model["empty"].as_array().expect("expressions");
            Frame::with_empty(atoms, &empty.iter().map(text).collect::<Vec<_>>())
        }
    }
    .expect("a frame")
}

/// What `wisdom` prints when it is called so.
fn printed(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_wisdom")).args(args).output().expect("it runs");
    assert!(output.status.success(), "{:?}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Every operation that `--operations` lists, and the names of its parameters.
fn operations() -> BTreeMap<String, BTreeSet<String>> {
    let listed = printed(&["combine", "--operations"]);
    let read = |line: &str| {
        let words = line.split_whitespace().map(|word| word.trim_end_matches(':'));
        let params = words.clone().filter_map(|word| word.strip_prefix("params."));
        let name = words.clone().next().expect("a name");
        (name.to_owned(), params.map(str::to_owned).collect())
    };
    listed.lines().map(read).collect()
}

/// Operations that answer for the expressions asked for.
const PER_ELEMENT: [&str; 6] = ["bel", "pl", "q", "betp", "dsmp", "cardinality"];

#[test]
fn every_published_case_comes_out_as_published() {
    let cases: Vec<Value> =
        serde_json::from_str(include_str!("../crates/belief/tests/vectors.json")).expect("JSON");
    let asked = |case: &Value| {
        let mut line = case.clone();
        let expected = line["expected"].as_object().expect("values").clone();
        if PER_ELEMENT.contains(&text(&case["rule"])) {
            line["keys"] = expected.keys().cloned().collect();
        }
        line.as_object_mut().expect("a case").remove("expected");
        line
    };
    let lines: Vec<String> = cases.iter().map(|case| asked(case).to_string()).collect();
    let answers = combine(lines.join("\n").as_bytes());
    assert_eq!(answers.len(), cases.len());
    for (case, answer) in cases.iter().zip(&answers) {
        assert_eq!(answer["id"], case["id"]);
        check(case, answer);
    }
}

/// Compares elements, not strings; what is listed on neither side is 0.
fn check(case: &Value, answer: &Value) {
    let (id, frame) = (&case["id"], frame(case));
    let tolerance = case["tolerance"].as_f64().expect("a number");
    let result = answer["result"].as_object().unwrap_or_else(|| panic!("{id}: {answer}"));
    let wanted = case["expected"].as_object().expect("values");
    let near = |found: f64, wanted: &Value, what: &str| {
        let wanted = wanted.as_f64().expect("a number");
        assert!((found - wanted).abs() <= tolerance, "{id}: {what} is {found}, not {wanted}");
    };
    if let Some(value) = wanted.get("value") {
        return near(result["value"].as_f64().expect("a number"), value, "value");
    }
    let element = |text: &String| frame.parse(text).expect("an element");
    let value_in = |values: &serde_json::Map<String, Value>, wanted: &String| {
        let same = values.iter().find(|(text, _)| element(text) == element(wanted));
        same.map_or(json!(0.0), |(_, value)| value.clone())
    };
    for key in wanted.keys().chain(result.keys()) {
        let found = value_in(result, key).as_f64().expect("a number");
        near(found, &value_in(wanted, key), key);
    }
}

#[test]
fn a_bad_line_is_answered_by_what_is_wrong_and_stops_nothing() {
    let good = r#"{"id": "good", "frame": ["A", "B"], "model": "shafer", "rule": "yager",
        "sources": [{"A": 0.5, "Theta": 0.5}, {"B": 0.5, "Theta": 0.5}]}"#
        .replace('\n', " ");
    let bad = [
        ("{\"id\": 1, \"frame\"", "malformed", "column"),
        ("[1, 2]", "malformed", "expected a JSON object"),
        (r#"{"id": 1, "frame": ["A"], "model": "shafer"}"#, "malformed", "missing field `rule`"),
        (
            r#"{"id": 1, "frame": ["A"], "model": "shafer", "rule": "yager", "param": {}}"#,
            "malformed",
            "unknown field `param`",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "bayes", "rule": "yager"}"#,
            "malformed",
            r#"model: "bayes"; expected "free", "shafer""#,
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "yaeger"}"#,
            "unknown_rule",
            "rule `yaeger` is unknown; known: dsmc, dempster",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": []}"#,
            "malformed",
            "0 sources; operation `bel` takes 1",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 0.4}]}"#,
            "sum_not_one",
            "source 0: masses sum to 0.4",
        ),
        (
            r#"{"id": 1, "frame": ["A", "B"], "model": "free", "rule": "bel", "sources": [{"A | B": 0.4, "B|A": 0.6}]}"#,
            "repeated_element",
            "source 0: m(Theta) is given twice",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 1}], "keys": ["A &"]}"#,
            "expression",
            "keys: expression",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 1e999}]}"#,
            "malformed",
            "number out of range",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "discount", "params": {"reliability": 0.5, "reliability": 0.9}, "sources": [{"A": 1}]}"#,
            "malformed",
            "`reliability` is given twice",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "contextual_discount", "params": {"reliabilities": {"A": 0.5, "\u0041": 0.9}}, "sources": [{"A": 1}]}"#,
            "malformed",
            "`A` is given twice",
        ),
        (
            r#"{"id": 1, "frame": ["A", "B"], "model": {"empty": ["A&B"], "empty": []}, "rule": "bel", "sources": [{"A": 1}]}"#,
            "malformed",
            "`empty` is given twice",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "rule": "pl", "sources": [{"A": 1}]}"#,
            "malformed",
            "duplicate field `rule`",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 1}], "keys": ["Theta", "A", "Theta"]}"#,
            "malformed",
            "keys: `Theta` is asked for twice",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "pcr6"}"#,
            "malformed",
            "missing field `sources`; operation `pcr6` needs it",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "bel", "sources": null}"#,
            "malformed",
            "invalid type: null",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "cardinality", "sources": [{"A": 1}]}"#,
            "malformed",
            "1 sources; operation `cardinality` takes none",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "auto_conflict", "params": {"order": 1001}, "sources": [{"A": 1}]}"#,
            "parameter",
            "params.order is 1001; expected a whole number from 1 to 1000",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "decide", "params": {"criterion": "bel", "alpha": 1}, "sources": [{"A": 1}]}"#,
            "malformed",
            "params.alpha means nothing to operation `decide`; known: criterion",
        ),
        ("{\"id\": 1, \"frame\": [\"A", "malformed", "column 22: EOF while parsing a string"),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "dsmp", "sources": [{"A": 1}]}"#,
            "malformed",
            "operation `dsmp` needs params.epsilon, a number",
        ),
        (
            r#"{"id": 1, "frame": ["A"], "model": "free", "rule": "yager", "params": {"k": 1}, "sources": [{"A": 1}]}"#,
            "malformed",
            "params.k means nothing to operation `yager`; known: none",
        ),
        ("\u{fffe}", "malformed", "expected a JSON object"),
    ];
    for (line, code, message) in bad {
        let answers = combine(format!("{good}\n{line}\n\n{good}\n").as_bytes());
        assert_eq!(answers.len(), 3, "{line}");
        assert_eq!(answers[1]["error"], code, "{line}: {}", answers[1]);
        assert!(text(&answers[1]["message"]).contains(message), "{line}: {}", answers[1]);
        assert_eq!(answers[1]["line"], 2);
        let named = line.starts_with("{\"id\": 1, \"frame\": ") && line.ends_with('}');
        assert_eq!(answers[1]["id"], if named { json!(1) } else { Value::Null }, "{line}");
        assert_eq!(answers[0], answers[2]);
        assert_eq!(answers[0]["result"], json!({ "A": 0.25, "B": 0.25, "Theta": 0.5 }));
    }
}

#[test]
fn undefined_combinations_say_so_by_name() {
    let case = |rule: &str, model: Value, sources: Value| {
        let case = json!({ "id": rule, "frame": ["A", "B"], "model": model, "rule": rule, "sources": sources });
        text(&one(&case)["error"]).to_owned()
    };
    let shafer = || json!("shafer");
    let opposed = || json!([{ "A": 1 }, { "B": 1 }]);
    for rule in ["dempster", "zhang", "jaccard_centre", "dempster_sequential"] {
        assert_eq!(case(rule, shafer(), opposed()), "total_conflict");
    }
    assert_eq!(case("cautious", shafer(), opposed()), "dogmatic");
    assert_eq!(case("bold", shafer(), opposed()), "normal");
    assert_eq!(case("dsmc", shafer(), opposed()), "not_free_model");
    assert_eq!(case("dsmc", json!({ "empty": ["A & B"] }), opposed()), "not_free_model");
    assert_eq!(case("pcr6", shafer(), json!([{ "A": 0.5, "empty": 0.5 }])), "mass_on_empty");
}

#[test]
fn regions_weights_and_settings_are_at_hand() {
    let case = json!({ "frame": ["A", "B"], "model": "free", "rule": "betp_region",
        "sources": [{ "A": 0.5, "Theta": 0.5 }], "keys": ["A", "B,A", "B"] });
    let near = |answer: &Value, wanted: &[(&str, f64)]| {
        for (key, value) in wanted {
            let found = answer["result"][*key].as_f64().expect("a number");
            assert!((found - value).abs() < 1e-12, "{key}: {answer}");
        }
    };
    let sixth = 1.0 / 6.0;
    near(&one(&case), &[("A", 0.25 + sixth), ("B,A", 0.25 + sixth), ("B", sixth)]);
    let case = json!({ "frame": ["A", "B"], "model": "shafer", "rule": "conjunctive_weights",
        "sources": [{ "A": 0.5, "Theta": 0.5 }], "keys": ["A", "B"] });
    near(&one(&case), &[("A", 0.5), ("B", 1.0)]);
    let case = json!({ "frame": ["A", "B"], "model": "shafer", "rule": "inagaki", "params": { "k": 0.5 },
        "sources": [{ "A": 0.5, "Theta": 0.5 }, { "B": 0.5, "Theta": 0.5 }] });
    near(&one(&case), &[("A", 0.28125), ("B", 0.28125), ("Theta", 0.4375)]);
    let case = json!({ "frame": ["A", "B"], "model": "shafer", "rule": "average",
        "params": { "weights": [1, 3] }, "sources": [{ "A": 1 }, { "B": 1 }], "keys": ["B|empty"] });
    // The expression as it was asked for.
    near(&one(&case), &[("A", 0.25), ("B|empty", 0.75)]);
}

#[test]
fn an_id_comes_back_byte_for_byte() {
    let case = r#""frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 1}]"#;
    let ids = [
        "123456789012345678901234567890",
        "1.10",
        "-0",
        "1e999",
        r#"{"z": 1,  "a": [1.0, "\u0041"], "z": 2}"#,
        "null",
    ];
    for id in ids {
        let answer = output(format!("{{{case}, \"id\": {id} }}").as_bytes());
        assert_eq!(answer, format!("{{\"id\":{id},\"result\":{{\"Theta\":1.0}}}}\n"));
        let refused = output(format!("{{\"id\":{id}, \"rules\": []}}").as_bytes());
        assert!(
            refused.starts_with(&format!("{{\"id\":{id},\"error\":\"malformed\"")),
            "{refused}"
        );
    }
    let absent = output(format!("{{{case}}}").as_bytes());
    assert!(absent.starts_with("{\"id\":null,\"result\""), "{absent}");
}

#[test]
fn how_lines_end_and_a_file_begins_does_not_matter() {
    let case = r#"{"frame": ["A"], "model": "free", "rule": "bel", "sources": [{"A": 1}]}"#;
    let answer = "{\"id\":null,\"result\":{\"Theta\":1.0}}\n";
    for input in [
        format!("{case}\n{case}\n"),
        format!("{case}\r\n{case}\r\n"),
        format!("\r\n{case}\n \n{case}"),
        format!("\u{feff}{case}\r\n{case}"),
        format!("\u{feff}\n{case}\n{case}"),
    ] {
        assert_eq!(output(input.as_bytes()), [answer; 2].concat(), "{input:?}");
    }
    // Only files begin with the mark.
    let marked = combine(format!("{case}\n\u{feff}{case}\n").as_bytes());
    assert_eq!(marked[1]["error"], "malformed");
}

#[test]
fn messages_stay_short_whatever_they_are_about() {
    let long = "x".repeat(1 << 20);
    let case = json!({ "frame": ["A"], "model": "free", "rule": "bel", "sources": [{ "A": 1 }] });
    for (field, value) in [
        ("rule", json!(long)),
        ("model", json!(long)),
        ("frame", json!([format!("{long} {long}")])),
        ("keys", json!([format!("{}A", "A&é&".repeat(1 << 18))])),
        ("params", json!({ &*long: 1 })),
        (&*long, json!(1)),
    ] {
        let mut line = case.clone();
        line[field] = value;
        let answer = one(&line);
        let chars = text(&answer["message"]).chars().count();
        assert!(chars <= 500 && text(&answer["message"]).contains('…'), "{chars} characters");
    }
}

#[test]
fn without_sources_there_is_total_ignorance_if_they_are_left_out_on_purpose() {
    for rule in Rule::ALL {
        for sequential in ["", "_sequential"] {
            let rule = format!("{}{sequential}", rule.name().replace('-', "_"));
            let mut case =
                json!({ "frame": ["A", "B"], "model": "free", "rule": rule, "sources": [] });
            if rule.starts_with("inagaki") {
                case["params"] = json!({ "k": 1 });
            }
            assert_eq!(one(&case)["result"], json!({ "Theta": 1.0 }), "{rule}");
            case.as_object_mut().expect("a case").remove("sources");
            assert_eq!(one(&case)["error"], "malformed", "{rule}");
        }
    }
    for rule in ["cardinality", "hyper_power_size"] {
        let case = json!({ "frame": ["A", "B"], "model": "free", "rule": rule });
        assert!(one(&case)["result"].is_object(), "{rule}");
    }
}

/// A sound case of an operation, with the parameters it knows.
fn sound(rule: &str) -> Vec<Value> {
    let whole = json!({ "A": 0.5, "B|C": 0.25, "Theta": 0.25 });
    let other = json!({ "B": 0.5, "Theta": 0.5 });
    let base = rule.trim_end_matches("_sequential");
    let is_rule = base.parse::<Rule>().is_ok();
    let sources = match base {
        "bold" => json!([{ "empty": 0.25, "A": 0.75 }, { "empty": 0.5, "B": 0.5 }]),
        "disjunctive_weights" => json!([{ "empty": 0.25, "A": 0.75 }]),
        "decombine" | "decombine_normalised" => json!([whole, { "Theta": 1 }]),
        "jousselme" | "conflict" => json!([whole, other]),
        "cardinality" | "hyper_power_size" => json!([]),
        _ if is_rule => json!([whole, other, { "A": 0.25, "Theta": 0.75 }]),
        _ => json!([whole]),
    };
    let params = match base {
        "inagaki" => vec![json!({ "k": 0.5 })],
        "average" if base == rule => vec![json!({ "weights": [1, 2, 3] })],
        "discount" | "undiscount" => vec![json!({ "reliability": 0.875 })],
        "contextual_discount" | "contextual_reinforcement" => {
            vec![json!({ "reliabilities": { "A": 0.5, "B|C": 0.75 } })]
        }
        "condition" | "condition_unnormalised" => vec![json!({ "on": "A|B" })],
        "reassign" => vec![json!({ "from": "A", "to": "Theta" })],
        "dsmp" | "dsmp_region" | "pic_dsmp" => vec![json!({ "epsilon": 0.125 })],
        "auto_conflict" => vec![json!({ "order": 3 })],
        "decide" => vec![
            json!({ "criterion": "bel" }),
            json!({ "criterion": "pl" }),
            json!({ "criterion": "betp" }),
            json!({ "criterion": "dsmp", "epsilon": 0 }),
            json!({ "criterion": "hurwicz", "alpha": 0.5 }),
        ],
        _ => vec![json!({})],
    };
    let model = if base == "dsmc" { "free" } else { "shafer" };
    let case = |params| json!({ "id": rule, "frame": ["A", "B", "C"], "model": model, "rule": rule, "params": params, "sources": sources });
    params.into_iter().map(case).collect()
}

#[test]
fn every_operation_that_is_listed_answers_as_promised() {
    let operations = operations();
    assert!(operations.len() > 60);
    for (operation, params) in &operations {
        let is_rule = operation.parse::<Rule>().is_ok();
        let cases = sound(operation);
        let given =
            cases.iter().flat_map(|case| case["params"].as_object().expect("params").keys());
        assert_eq!(&given.cloned().collect::<BTreeSet<_>>(), params, "{operation}");
        let sequential = format!("{operation}_sequential");
        let more = if is_rule { sound(&sequential) } else { Vec::new() };
        for case in cases.iter().chain(&more) {
            let answer = one(case);
            assert_eq!(answer.as_object().map(serde_json::Map::len), Some(2), "{answer}");
            assert_eq!(answer["id"], case["rule"]);
            let result = answer["result"].as_object().unwrap_or_else(|| panic!("{answer}"));
            assert!(!result.is_empty(), "{answer}");
            let numbers: Vec<f64> = result.values().filter_map(Value::as_f64).collect();
            assert!(numbers.len() == result.len() && numbers.iter().all(|x| x.is_finite()));
            let sum: f64 = numbers.iter().sum();
            assert!(!is_rule || (sum - 1.0).abs() < 1e-9, "{answer}");
        }
        if !is_rule {
            let case =
                json!({ "frame": ["A"], "model": "shafer", "rule": sequential, "sources": [] });
            assert_eq!(one(&case)["error"], "unknown_rule");
        }
    }
}

#[test]
fn what_was_combined_and_discounted_can_be_taken_back_and_decided_on() {
    let ask = |rule: &str, params: Value, sources: Value| {
        let case = json!({ "frame": ["A", "B"], "model": "shafer", "rule": rule, "params": params, "sources": sources });
        one(&case)["result"].clone()
    };
    let (a, b) = (json!({ "A": 0.5, "Theta": 0.5 }), json!({ "B": 0.5, "Theta": 0.5 }));
    let half = || json!({ "reliability": 0.5 });
    let discounted = ask("discount", half(), json!([a]));
    assert_eq!(ask("undiscount", half(), json!([discounted])), a);
    for (rule, back) in [("conjunctive", "decombine"), ("dempster", "decombine_normalised")] {
        let fused = ask(rule, json!({}), json!([a, b]));
        let rest = ask(back, json!({}), json!([fused, b]));
        let near = |key: &str| (rest[key].as_f64().expect("a number") - 0.5).abs() < 1e-12;
        assert!(near("A") && near("Theta"), "{rest}");
    }
    let even = json!({ "A": 0.25, "B": 0.25, "Theta": 0.5 });
    assert_eq!(
        ask("decide", json!({ "criterion": "betp" }), json!([even])),
        json!({ "A": 0.5, "B": 0.5 })
    );
    assert_eq!(ask("decide", json!({ "criterion": "pl" }), json!([a])), json!({ "A": 1.0 }));
}

#[test]
fn the_help_tells_a_newcomer_what_to_write_and_what_comes_back() {
    let help = printed(&["combine", "--help"]);
    let fields = ["id", "frame", "model", "source_model", "rule", "params", "sources", "keys"];
    for field in fields {
        let line = format!("  {field} ");
        assert!(help.lines().any(|found| found.starts_with(&line)), "{field}");
    }
    for word in [
        "_sequential",
        "--operations",
        "docs/combine.md",
        "\"result\"",
        "\"error\"",
        "\"message\"",
        "\"line\"",
        "\"value\"",
    ] {
        assert!(help.contains(word), "{word}");
    }
    let listed = printed(&["combine", "--operations"]);
    assert!(Rule::ALL.iter().all(|rule| {
        listed.contains(&format!("; also {}_sequential\n", rule.name().replace('-', "_")))
    }));
}

const PAGE: &str = include_str!("../docs/combine.md");

#[test]
fn the_page_has_a_row_for_every_operation_with_its_params() {
    let row = |name: &str| {
        let rows: Vec<&str> =
            PAGE.lines().filter(|line| line.starts_with(&format!("| `{name}` |"))).collect();
        assert_eq!(rows.len(), 1, "{name}");
        rows[0].split(" | ").nth(1).expect("a column of params")
    };
    for (name, params) in operations() {
        let told = row(&name);
        assert_eq!(told == "none", params.is_empty(), "{name}");
        let named: BTreeSet<String> =
            told.split('`').skip(1).step_by(2).map(str::to_owned).collect();
        assert_eq!(named, params, "{name}");
    }
}

#[test]
fn the_page_names_kinds_of_errors_that_there_are() {
    let (_, section) = PAGE.split_once("## Kinds of errors").expect("a section");
    let source = include_str!("../crates/belief/src/error.rs");
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let kinds: Vec<&str> = rows
        .flat_map(|row| row.split(" | ").next().expect("a column").split('`').skip(1).step_by(2))
        .collect();
    assert!(kinds.len() > 20);
    for kind in kinds {
        let ours = ["malformed", "unknown_rule"].contains(&kind);
        assert!(ours || source.contains(&format!("\"{kind}\"")), "{kind}");
    }
}

/// Equal but for the last bits of numbers.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let number = |x: &serde_json::Number| x.as_f64().expect("a number");
            (number(a) - number(b)).abs() < 1e-12
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter().all(|(key, value)| b.get(key).is_some_and(|other| same(value, other)))
        }
        _ => a == b,
    }
}

#[test]
fn the_examples_of_the_page_come_out_as_printed() {
    let blocks: Vec<Value> = PAGE
        .split("```json\n")
        .skip(1)
        .map(|rest| rest.split("```").next().expect("a block"))
        .map(|block| serde_json::from_str(block).expect("JSON"))
        .collect();
    let (pairs, rest) = blocks.as_chunks::<2>();
    assert!(pairs.len() > 5 && rest.is_empty());
    for [case, answer] in pairs {
        let found = one(case);
        assert!(same(&found, answer), "{found}, not {answer}");
    }
}

/// xorshift64 (Marsaglia 2003).
fn next(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 33) as usize
}

/// Published cases with bytes changed, doubled and left out: every line still gets one answer.
#[test]
fn no_line_is_too_broken_to_be_answered() {
    let cases: Vec<Value> =
        serde_json::from_str(include_str!("../crates/belief/tests/vectors.json")).expect("JSON");
    let mut state = 0x2545_f491_4f6c_dd1d;
    let mut input = Vec::new();
    let lines = 6000;
    for _ in 0..lines {
        let mut line = cases[next(&mut state) % cases.len()].to_string().into_bytes();
        for _ in 0..=next(&mut state) % 4 {
            let at = next(&mut state) % line.len();
            match next(&mut state) % 4 {
                0 => line[at] = b"{}[]\",:&|()0123456789.-eE Theta\xff"[next(&mut state) % 32],
                1 => line.insert(at, line[next(&mut state) % line.len()]),
                2 => line.truncate(at.max(1)),
                _ => drop(line.remove(at)),
            }
            line.push(b' ');
        }
        line.insert(0, b' ');
        line.retain(|&byte| byte != b'\n');
        if line.trim_ascii().is_empty() {
            line.push(b'?');
        }
        input.extend(line);
        input.push(b'\n');
    }
    let answers = combine(&input);
    assert_eq!(answers.len(), lines);
    let refused = answers.iter().filter(|answer| answer["error"].is_string()).count();
    assert!(refused > lines / 2 && refused < lines, "{refused} of {lines}");
    for answer in &answers {
        assert!(answer["error"].is_string() != answer["result"].is_object(), "{answer}");
    }
}

#[test]
fn rules_are_listed_one_a_line_and_explained_by_name() {
    let rules = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
        command.arg("rules").args(args).output().expect("the binary runs")
    };
    let listed = String::from_utf8(rules(&[]).stdout).expect("UTF-8");
    let names: Vec<&str> =
        listed.lines().map(|line| line.split_whitespace().next().expect("a name")).collect();
    assert_eq!(names, Rule::ALL.map(Rule::name));
    let operations = operations();
    for line in String::from_utf8(rules(&["--json"]).stdout).expect("UTF-8").lines() {
        let rule: Value = serde_json::from_str(line).expect("an object");
        assert!(text(&rule["name"]).parse::<Rule>().is_ok() && rule["associative"].is_boolean());
        let params = operations.get(text(&rule["operation"])).expect("an operation of this name");
        assert_eq!(rule["params"], json!(params));
    }
    let page = String::from_utf8(rules(&["dubois_prade"]).stdout).expect("UTF-8");
    assert_eq!(page, Rule::DuboisPrade.page());
    let unknown = rules(&["bayes"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("unknown rule `bayes`; known: dsmc"));
}
