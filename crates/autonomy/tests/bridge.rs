//! The bridge of `examples/bridge`: what a rover's own software says to the core in lines, and what it is answered.
//!
//! The frames of the example are recorded here, from a drawn ground: `WISDOM_RECORD=1 cargo test -p wisdom-autonomy
//! --test bridge` writes them anew.

#![allow(clippy::unwrap_used, reason = "test code: a failed step is a failed test")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wisdom_grid::{Cell, Window};

#[path = "../examples/bridge/lines.rs"]
mod lines;
#[path = "../examples/bridge/rover.rs"]
mod rover;
#[path = "../examples/bridge/serve.rs"]
mod serve;

use lines::{DecisionLine, Frame, Reply};
use serve::{Bridge, Refusals, serve};

/// The rock that is seen from the start: steep and warm.
const ROCK: Window = Window { row: 7, col: 15, rows: 3, cols: 3 };
/// A slab that is only warm, and only a little.
const SLAB: Window = Window { row: 17, col: 17, rows: 2, cols: 2 };
/// A rock that is seen from near only.
const HIDDEN: Window = Window { row: 12, col: 5, rows: 2, cols: 2 };
/// From this far on, cells, `HIDDEN` looks like dust.
const NEAR: f64 = 6.5;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bridge")
}

fn frames() -> String {
    fs::read_to_string(folder().join("frames.jsonl")).unwrap()
}

/// The rover's body on the drawn ground: it carries out what it is told, and writes down every line it says.
struct Body {
    bridge: Bridge,
    said: String,
    at: Cell,
    time_s: f64,
    energy_j: f64,
    data_mb: f64,
    length_m: f64,
    observations: u32,
}

impl Body {
    fn say(&mut self, line: &Value) -> Option<Reply> {
        let text = line.to_string();
        self.said.push_str(&text);
        self.said.push('\n');
        self.bridge.take(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"))
    }

    fn pose(&self) -> Value {
        json!({ "cell": [self.at.row, self.at.col], "heading_rad": 0.0 })
    }

    fn spent(&self) -> Value {
        let Self { time_s, energy_j, data_mb, length_m, .. } = self;
        json!({ "time_s": time_s, "energy_j": energy_j, "data_mb": data_mb, "length_m": length_m })
    }

    /// Reads a square around the rover.
    fn look(&mut self, radius: usize) -> Option<Reply> {
        let first =
            Cell::new(self.at.row.saturating_sub(radius), self.at.col.saturating_sub(radius));
        let last = |at: usize| (at + radius).min(rover::SIDE - 1);
        let window = Window {
            row: first.row,
            col: first.col,
            rows: last(self.at.row) + 1 - first.row,
            cols: last(self.at.col) + 1 - first.col,
        };
        let two_digits = |number: f64| (number * 100.0).round() / 100.0;
        let here = self.at;
        let layer = |name: &str, reading: &dyn Fn(Cell) -> f64| {
            json!({
                "layer": name,
                "first": [window.row, window.col],
                "rows": window.rows,
                "cols": window.cols,
                "values": window.cells().map(|c| two_digits(reading(c))).collect::<Vec<_>>(),
                "uncertainty": window
                    .cells()
                    .map(|c| two_digits((0.05 + 0.02 * c.distance(here)).min(0.9)))
                    .collect::<Vec<_>>(),
            })
        };
        let warmth = |cell: Cell| match cell {
            _ if ROCK.contains(cell) => 250.0,
            _ if SLAB.contains(cell) => 235.0,
            _ if HIDDEN.contains(cell) && cell.distance(here) < NEAR => 250.0,
            _ => 220.0,
        };
        let height = |cell: Cell| {
            let rise = 0.01 * (rover::SIDE - cell.row) as f64;
            if ROCK.contains(cell) { rise + 0.6 } else { rise }
        };
        let line = json!({ "observation": {
            "number": self.observations,
            "pose": self.pose(),
            "spent": self.spent(),
            "windows": [layer("elevation", &height), layer("warmth", &warmth)],
        }});
        self.observations += 1;
        self.say(&line)
    }

    /// Drives a part of a route.
    fn drive(&mut self, decision: &DecisionLine, from: usize, to: usize) {
        let edges = decision.route.len().saturating_sub(1).max(1);
        let share = (to - from) as f64 / edges as f64;
        self.time_s += decision.cost.time_s * share;
        self.energy_j += decision.cost.energy_j * share;
        self.length_m += decision.cost.length_m * share;
        let [row, col] = decision.route[to];
        self.at = Cell::new(row as usize, col as usize);
    }

    fn report(
        &mut self,
        decision: &DecisionLine,
        result: &str,
        operators: &[&str],
        track: &[[u32; 2]],
    ) {
        let line = json!({ "outcome": {
            "decision": decision.number,
            "result": result,
            "operators": operators,
            "pose": self.pose(),
            "spent": self.spent(),
            "track": track,
        }});
        assert!(self.say(&line).is_none(), "an outcome is not answered");
    }

    /// Carries out a decision, with a look on the way; what the next look is answered with.
    fn carry_out(&mut self, decision: &DecisionLine) -> Option<Reply> {
        let end = decision.route.len() - 1;
        let mut operators: Vec<&str> = decision.before.iter().map(String::as_str).collect();
        self.time_s += 30.0 * operators.len() as f64;
        let half = end / 2;
        if half > 0 {
            operators.push("drive");
            self.drive(decision, 0, half);
            if let Some(Reply::Asks(asks)) = self.look(5) {
                assert_eq!(asks.decision, decision.number);
                let result = if decision.act == "pursue" { "interrupted" } else { "stopped" };
                self.report(decision, result, &operators, &decision.route[..=half]);
                return self.look(2);
            }
        }
        if end > half {
            self.drive(decision, half, end);
            if half == 0 {
                operators.push("drive");
            }
        }
        if decision.act == "pursue" {
            operators.extend(decision.after.iter().map(String::as_str));
            self.time_s += 150.0;
            self.energy_j += 3000.0;
            self.data_mb += 20.0;
            self.report(decision, "achieved", &operators, &decision.route);
        } else {
            self.report(decision, "arrived", &operators, &decision.route);
        }
        self.look(3)
    }
}

/// The frames of a run on the drawn ground, and what the core decided.
fn record() -> (String, Vec<DecisionLine>) {
    let mut body = Body {
        bridge: Bridge::new(rover::spec().unwrap()).unwrap(),
        said: String::new(),
        at: rover::HOME,
        time_s: 0.0,
        energy_j: 0.0,
        data_mb: 0.0,
        length_m: 0.0,
        observations: 0,
    };
    let mut decisions = Vec::new();
    let mut answer = body.look(rover::SIDE);
    let mut asked = false;
    while let Some(Reply::Decision(decision)) = answer.take() {
        assert!(decisions.len() < 12, "the run does not end");
        decisions.push((*decision).clone());
        answer = if decision.act != "wait" {
            body.carry_out(&decision)
        } else if asked {
            None
        } else {
            // The ground has seen the first images and wants the slab, which no expert finds interesting enough.
            asked = true;
            body.say(&json!({ "message": { "number": 0, "word": { "pursue": {
                "name": "slab",
                "directive": "image-rock",
                "target": [SLAB.row, SLAB.col],
                "prize": 0.9,
                "mandatory": false,
            }}}}))
        };
    }
    let last = body.say(&json!({ "decide": {} }));
    let Some(Reply::Decision(last)) = last else { panic!("asked for, and not made") };
    decisions.push(*last);
    (body.said, decisions)
}

#[test]
fn the_recorded_frames_are_those_of_the_drawn_ground() {
    let (said, decisions) = record();
    if std::env::var_os("WISDOM_RECORD").is_some() {
        fs::write(folder().join("frames.jsonl"), &said).unwrap();
        for d in &decisions {
            println!("{} {:?} {} {:?} {:?}", d.number, d.triggers, d.act, d.goal, d.target);
        }
    }
    assert!(said == frames(), "decisions changed: record the frames anew, and say why");
}

/// What the bridge says to an input: its decisions and calls, its refusals, and how many these are.
fn told(input: &str, refusals: Refusals) -> (String, String, usize) {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let spec = rover::spec().unwrap();
    let refused = serve(spec, input.as_bytes(), &mut output, &mut errors, refusals).unwrap();
    (String::from_utf8(output).unwrap(), String::from_utf8(errors).unwrap(), refused)
}

fn values(lines: &str) -> Vec<Value> {
    lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The decisions among the answers to the recorded frames.
fn decided() -> Vec<Value> {
    let (output, errors, refused) = told(&frames(), Refusals::GoOn);
    assert_eq!((errors.as_str(), refused), ("", 0));
    values(&output).iter().filter_map(|reply| reply.get("decision").cloned()).collect()
}

fn cell(value: &Value) -> Cell {
    let at = |index: usize| usize::try_from(value[index].as_u64().unwrap()).unwrap();
    Cell::new(at(0), at(1))
}

#[test]
fn the_first_act_pursues_the_rock_that_was_drawn() {
    let first = &decided()[0];
    assert_eq!(first["act"], "pursue");
    assert!(ROCK.contains(cell(&first["target"])), "{}", first["target"]);
    assert_eq!(first["triggers"], json!(["start"]));
    assert_eq!(first["sequence"][0]["goal"], first["goal"]);
    let route: Vec<Cell> = first["route"].as_array().unwrap().iter().map(cell).collect();
    assert_eq!(route[0], rover::HOME);
    assert!(route.windows(2).all(|pair| pair[0].distance(pair[1]) < 1.5), "cell by cell");
    assert!(route.last().unwrap().distance(cell(&first["target"])) <= 3.0, "to its standoff");
    assert_eq!(first["after"], json!(["raise-mast", "image"]));
}

#[test]
fn a_goal_whose_operators_were_carried_out_is_achieved_and_the_next_begins_with_the_mast() {
    let decisions = decided();
    let pursued = &decisions[0]["goal"];
    let achieved = |d: &&Value| {
        d["goals"]
            .as_array()
            .unwrap()
            .iter()
            .any(|g| g["goal"] == *pursued && g["action"] == "achieve")
    };
    let after = decisions.iter().find(achieved).expect("the outcome said so");
    assert!(after["number"].as_u64() > Some(0));
    let told = after["triggers"].as_array().unwrap();
    assert!(
        told.iter().any(|t| *t == json!(format!("goal-ended ({})", pursued.as_str().unwrap())))
    );
    assert_eq!(after["before"], json!(["lower-mast"]), "no wheel turns under a raised mast");
}

#[test]
fn what_is_seen_on_the_way_ends_the_step() {
    let (output, _, _) = told(&frames(), Refusals::GoOn);
    let replies = values(&output);
    let asked = replies.iter().position(|r| r.get("asks").is_some()).expect("a rock came in sight");
    let asks = &replies[asked]["asks"];
    assert_eq!(asks["decision"], replies[asked - 1]["decision"]["number"]);
    assert!(asks["triggers"][0].as_str().unwrap().starts_with("new-candidate"), "{asks}");
    let next = &replies[asked + 1]["decision"];
    let known = next["goals"].as_array().unwrap();
    assert!(known.iter().any(|g| HIDDEN.contains(cell(&g["target"]))), "{next}");
}

#[test]
fn the_ground_s_command_is_followed_and_the_end_is_a_wait() {
    let decisions = decided();
    let commanded = decisions.iter().find(|d| d["triggers"] == json!(["command (message 0)"]));
    let commanded = commanded.expect("it calls for a decision");
    assert_eq!(
        (commanded["act"].as_str(), cell(&commanded["target"])),
        (Some("pursue"), Cell::new(SLAB.row, SLAB.col))
    );
    let last = decisions.last().unwrap();
    assert_eq!((last["act"].as_str(), last["triggers"].clone()), (Some("wait"), json!(["woken"])));
    assert_eq!(cell(&last["pose"]["cell"]), rover::HOME);
}

#[test]
fn the_same_frames_are_answered_with_the_same_bytes() {
    assert!(told(&frames(), Refusals::GoOn) == told(&frames(), Refusals::GoOn));
}

/// Lines that are refused wherever they come after the first decision, each with words of its refusal.
fn bad_lines() -> Vec<(String, &'static str)> {
    let pose = json!({ "cell": [1, 1], "heading_rad": 0.0 });
    let spent = json!({ "time_s": 0.0, "energy_j": 0.0, "data_mb": 0.0, "length_m": 0.0 });
    let outcome = |decision: u32, result: &str, operators: &[&str]| {
        json!({ "outcome": { "decision": decision, "result": result, "operators": operators,
            "pose": pose, "spent": spent, "track": [] } })
        .to_string()
    };
    let reading = |rows: u32, value: &str| {
        let count = if rows == 1 { 1 } else { 4 };
        let list = |text: &str| vec![text; count].join(",");
        format!(
            r#"{{"observation":{{"number":1,"pose":{pose},"spent":{spent},"windows":[{{"layer":"warmth","first":[23,23],"rows":{rows},"cols":{rows},"values":[{}],"uncertainty":[{}]}}]}}}}"#,
            list(value),
            list("0.5"),
        )
    };
    vec![
        ("not a line".to_owned(), "expected"),
        ("{}".to_owned(), "expected"),
        (r#"{"decide":{"now":true}}"#.to_owned(), "unknown field `now`"),
        (r#"{"teleport":{}}"#.to_owned(), "unknown variant `teleport`"),
        (r#"{"decide":{}}"#.to_owned(), "the step of decision 0 is under way"),
        (outcome(7, "achieved", &[]), "the outcome answers decision 7; the last one is 0"),
        (outcome(0, "arrived", &[]), "no end of the act `pursue`"),
        (outcome(0, "achieved", &["drive", "image"]), "operator `image`"),
        (outcome(0, "achieved", &["fly"]), "operator `fly`"),
        (reading(1, "1e60"), "number out of range"),
        (reading(1, "1.0").replace("[0.5]", "[7.5]"), "7.5"),
        (reading(2, "1.0"), "inside a grid"),
        (reading(1, "1.0").replace(r#""number":1"#, r#""number":9"#), "observation 9 came where 1"),
        (reading(1, "1.0").replace("[1,1]", "[99,1]"), "off the grid"),
        (reading(1, "1.0").replace(r#""heading_rad":0.0"#, r#""heading_rad":1e9"#), "heading"),
        (
            r#"{"message":{"number":0,"word":{"facts":{"adds":["wings"],"deletes":[]}}}}"#
                .to_owned(),
            "wings",
        ),
        (
            r#"{"message":{"number":3,"word":{"withdraw":{"name":"x"}}}}"#.to_owned(),
            "message 3 came",
        ),
    ]
}

#[test]
fn a_bad_line_is_refused_by_number_and_loses_nothing() {
    let frames = frames();
    let (first, rest) = frames.split_once('\n').unwrap();
    let bad = bad_lines();
    let lines: Vec<&str> = bad.iter().map(|(line, _)| line.as_str()).collect();
    let lines = lines.join("\n");
    // An empty line counts, and is no frame.
    let input = format!("{first}\n\n{lines}\n{rest}");
    let (output, errors, refused) = told(&input, Refusals::GoOn);
    assert_eq!(refused, bad.len(), "{errors}");
    for ((index, (line, words)), error) in bad.iter().enumerate().zip(values(&errors)) {
        assert_eq!(error["line"], index + 3, "{line}");
        assert!(error["error"].as_str().unwrap().contains(words), "{line}: {error}");
    }
    assert_eq!(output, told(&frames, Refusals::GoOn).0);
}

#[test]
fn an_outcome_before_any_decision_is_refused() {
    let frames = frames();
    let outcome = frames.lines().find(|line| line.starts_with(r#"{"outcome""#)).unwrap();
    let (_, errors, _) = told(&format!("{outcome}\n{frames}"), Refusals::GoOn);
    assert!(errors.contains("no step is under way"), "{errors}");
    assert_eq!(values(&errors).len(), 1);
}

#[test]
fn a_strict_bridge_ends_at_the_first_bad_line() {
    let input = format!("nonsense\n{}", frames());
    let (output, errors, refused) = told(&input, Refusals::End);
    assert_eq!((output.as_str(), refused), ("", 1));
    assert_eq!(values(&errors)[0]["line"], 1);
}

/// Every path of keys in a value; what is in a list has the list's path.
fn keys(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = format!("{path}.{key}");
                found.insert(path.clone());
                keys(value, &path, found);
            }
        }
        Value::Array(list) => list.iter().for_each(|value| keys(value, path, found)),
        _ => {}
    }
}

/// Paths of keys of all values.
fn all_keys(values: &[Value]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for value in values {
        keys(value, "", &mut found);
    }
    found
}

#[test]
fn the_readme_shows_every_key_and_no_other() {
    let readme = fs::read_to_string(folder().join("README.md")).unwrap();
    let shown: Vec<Value> = readme
        .split("```")
        .skip(1)
        .step_by(2)
        .filter_map(|block| block.strip_prefix("json\n"))
        .flat_map(values)
        .collect();
    let (input, rest): (Vec<Value>, Vec<Value>) = shown.into_iter().partition(|line| {
        ["observation", "outcome", "message", "decide"].iter().any(|kind| line.get(kind).is_some())
    });
    // Every frame of the page is one, and all keys that frames can have are shown.
    let frames: Vec<Frame> =
        input.iter().map(|line| serde_json::from_value(line.clone()).unwrap()).collect();
    let again: Vec<Value> = frames.iter().map(|f| serde_json::to_value(f).unwrap()).collect();
    assert_eq!(all_keys(&input), all_keys(&again));
    let words: BTreeSet<&str> = ["pursue", "withdraw", "facts"].into();
    let shown_words: BTreeSet<&str> = input
        .iter()
        .filter_map(|line| line.pointer("/message/word")?.as_object()?.keys().next())
        .map(String::as_str)
        .collect();
    assert_eq!(shown_words, words);
    assert!(input.iter().any(|line| line.get("outcome").is_some()));
    let (output, errors, _) = told(&format!("x\n{}", self::frames()), Refusals::GoOn);
    let answers = [values(&output), values(&errors)].concat();
    assert_eq!(all_keys(&rest), all_keys(&answers));
}
