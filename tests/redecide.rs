//! Logged decisions taken again: the same mission gives the same bits, another one what its own run would have begun with.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use wisdom_logbook::{LogReader, mission_of, redecide};

fn wisdom(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).output().expect("the command runs")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn run(folder: &Path, name: &str, more: &[&str]) -> PathBuf {
    let log = folder.join(name);
    let args = ["run", "missions/paper", "--quiet", "--log", text(&log)];
    let short = ["--set", "goals.expansions=4000", "--set", "goals.max-sequenced=9"];
    let output = wisdom(&[&args[..], &short, more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    log
}

fn asked(log: &Path, more: &[&str]) -> Value {
    let output = wisdom(&[&["redecide", text(log), "--json"], more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

#[test]
fn from_its_logged_state_each_decision_is_taken_alike_to_the_last_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    // With commands, lost facts and a look at the ground the rover knows least.
    for mission in ["missions/paper", "missions/marias-pass-elk"] {
        let log = folder.path().join("run.mcap");
        let args = ["run", mission, "--quiet", "--log", text(&log), "--set", "budget.energy-j=1e6"];
        assert!(wisdom(&args).status.success());
        let log_read = LogReader::open(&log).expect("a log");
        let own = mission_of(&log_read).expect("its mission");
        let mut differences = Vec::new();
        let found = redecide(&log_read, &own, &mut |retaken| {
            let score = retaken.scores.logged.expect("its targets lie on its map");
            assert!((score - retaken.scores.decided).abs() < 1e-9, "{mission}");
            differences.extend(retaken.difference);
            true
        });
        let found = found.expect("it fits itself");
        assert_eq!(differences, [], "{mission}");
        assert_eq!((found.alike, found.first), (found.decisions, None));
        assert!(found.decisions > 5, "{mission}: {}", found.decisions);
        fs::remove_file(log).expect("it is there");
    }
}

#[test]
fn another_rule_begins_as_its_own_run_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) =
        (run(folder.path(), "a.mcap", &[]), run(folder.path(), "b.mcap", &["--rule", "pcr6"]));
    let here = LogReader::open(&a).expect("a log");
    let there = LogReader::open(&b).expect("a log");
    let under = mission_of(&there).expect("its mission");
    let mut first = None;
    redecide(&here, &under, &mut |retaken| {
        first = Some(retaken);
        false
    })
    .expect("both lie on one ground");
    let first = first.expect("a decision");
    let own = there.decisions().next().expect("a decision");
    assert_eq!(wisdom_logbook::first_difference(&first.decided, own), None);
    // The first difference lies in what the rule makes of the same readings, not in the readings.
    let difference = first.difference.expect("another rule");
    assert_eq!(difference.stage, "fusion");

    let told = asked(&a, &["--rule", "pcr6"]);
    let rows = told["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), here.decisions().count());
    assert_eq!(rows[0]["decided"]["act"].as_str().map(|act| act.starts_with("pursue")), Some(true));
    let alike = rows.iter().filter(|row| row["differs_in"].is_null()).count();
    assert_eq!(told["alike"], alike);
    let first = rows.iter().find(|row| !row["differs_in"].is_null());
    assert_eq!(told["first"], first.map_or(Value::Null, |row| row["decision"].clone()));
    assert_eq!(told["terms"]["decision"], told["first"]);
}

#[test]
fn a_change_that_changes_nothing_says_so_and_a_limit_shows_where_it_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = run(folder.path(), "a.mcap", &[]);
    let same = asked(&log, &["--set", "goals.max-sequenced=9"]);
    assert_eq!(same["first"], Value::Null);
    assert_eq!(same["alike"], same["decisions"]);
    let other = asked(&log, &["--set", "budget.min-reliability=0.97"]);
    let rows = other["rows"].as_array().expect("rows");
    let parted: Vec<&Value> = rows.iter().filter(|row| !row["differs_in"].is_null()).collect();
    assert!(!parted.is_empty(), "a higher floor, another choice somewhere");
    for row in parted {
        // The maps are the same: a limit begins to tell where sequences are weighed.
        assert!(
            ["candidates", "objective", "choice"]
                .contains(&row["first_stage"].as_str().expect("a stage")),
            "{row}"
        );
    }
}

#[test]
fn what_does_not_fit_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = run(folder.path(), "a.mcap", &["--set", "budget.energy-j=3e5"]);
    let refused = |more: &[&str]| {
        let output = wisdom(&[&["redecide", text(&log)], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, words) = refused(&[]);
    assert_eq!(code, Some(2));
    assert!(words.contains("--rule, --policy, --set or --mission"), "{words}");
    let (code, words) = refused(&["--mission", "missions/marias-pass"]);
    assert_eq!(code, Some(2));
    assert!(words.contains("ground"), "{words}");
    let (code, words) = refused(&["--set", "directive.0.name=\"elsewhere\""]);
    assert_eq!(code, Some(2), "{words}");
    assert!(words.contains("directive `"), "{words}");
    let (code, words) = refused(&["--rule", "pcr6", "--decision", "999"]);
    assert_eq!(code, Some(2));
    assert!(words.contains("no decision 999"), "{words}");
}
