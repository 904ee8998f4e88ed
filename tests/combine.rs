//! The door for scripts: `wisdom combine` and `wisdom rules` as a user's program sees them.

use std::io::Write;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use wisdom_belief::{Frame, Rule};

/// What `wisdom combine` answers to these lines; it must not fail.
fn combine(input: &[u8]) -> Vec<Value> {
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
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    text.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect()
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
        let named = line.starts_with("{\"id\": 1, \"frame\": ");
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
    for line in String::from_utf8(rules(&["--json"]).stdout).expect("UTF-8").lines() {
        let rule: Value = serde_json::from_str(line).expect("an object");
        assert!(text(&rule["name"]).parse::<Rule>().is_ok() && rule["associative"].is_boolean());
    }
    let page = String::from_utf8(rules(&["dubois_prade"]).stdout).expect("UTF-8");
    assert_eq!(page, Rule::DuboisPrade.page());
    let unknown = rules(&["bayes"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("unknown rule `bayes`; known: dsmc"));
}
