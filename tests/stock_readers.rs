//! A log is read without any code of ours: public Python packages find in it what our own reader finds.

mod venv;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use wisdom_grid::{Cell, Raster};
use wisdom_logbook::{Entry, LogReader, Options, Status, begin, record, topic};
use wisdom_mission::{Mission, Override};

use venv::environment;

/// What `read_log.py` asks for.
const PACKAGES: [&str; 5] = [
    "mcap==1.6.0",
    "mcap-protobuf-support==0.6.0",
    "protobuf==7.36.2",
    "zstandard==0.25.0",
    "blake3==1.0.11",
];

/// The Python, or none after saying that the test was skipped.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so")]
fn python_or_skip(test: &str) -> Option<PathBuf> {
    // Tests run side by side, and one environment serves them all.
    static MAKING: std::sync::Mutex<()> = std::sync::Mutex::new(());
    let _one = MAKING.lock().expect("nobody panics while it is made");
    match environment("mcap-venv", &PACKAGES) {
        Ok(programs) => Some(programs.join("python")),
        Err(why) => {
            println!("skipped: {test}: {why}");
            None
        }
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What the stock reader finds in a log.
fn found(python: &Path, log: &Path) -> Value {
    let output = Command::new(python)
        .arg(root().join("tests/data/read_log.py"))
        .arg(log)
        .output()
        .expect("Python runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {errors}", log.display());
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat()
}

fn bits(number: f64) -> String {
    hex(&number.to_le_bytes())
}

fn digest(numbers: &[f32]) -> String {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    blake3::hash(&bytes).to_hex().to_string()
}

/// A decision as the script prints it.
fn decision(decision: &record::Decision) -> Value {
    let choice = decision.choice.as_ref().expect("a choice");
    let act = choice.act.as_ref().expect("an act");
    let family = &decision.objective.as_ref().expect("an objective").family;
    let sequence = family[choice.chosen as usize].sequence.as_ref().expect("a sequence");
    let goal = |v: &record::Verdict| v.goal.clone().expect("a goal");
    json!({
        "number": decision.number,
        "version": decision.decision_version,
        "act": act.name,
        "goal": act.goal,
        "stops": sequence.stops.iter().map(|stop| stop.goal).collect::<Vec<_>>(),
        "prizes": choice.verdicts.iter().map(|v| json!([goal(v).id, bits(goal(v).prize)])).collect::<Vec<_>>(),
        "reasons": choice.verdicts.iter().map(|v| v.reason.as_str()).collect::<Vec<_>>(),
        "triggers": decision.triggers.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(),
        "chain": decision.chain,
        // Our reader refuses a log whose chain breaks.
        "chain_again": decision.chain,
    })
}

/// An observation as the script prints it.
fn observation(observation: &record::Observation) -> Value {
    let cell = observation.pose.and_then(|pose| pose.cell).expect("a pose");
    let windows = observation.windows.iter().map(|w| {
        json!({
            "layer": w.layer,
            "place": [w.row, w.col, w.rows, w.cols],
            "values": digest(&w.values),
            "uncertainty": digest(&w.uncertainty),
        })
    });
    json!({
        "number": observation.number,
        "cell": [cell.row, cell.col],
        "time_s": bits(observation.spent.expect("what was spent").time_s),
        "windows": windows.collect::<Vec<_>>(),
    })
}

/// A map as the script prints it: rows from the north, as ours are.
fn grid(topic: &str, number: u32, map: &Raster<f32>) -> Value {
    let (rows, cols) = (map.spec().rows(), map.spec().cols());
    let corner = |row: usize, col: usize| hex(&map[Cell::new(row, col)].to_le_bytes());
    json!({
        "topic": topic,
        "decision": number,
        "rows": rows,
        "cols": cols,
        "cell_m": map.spec().spacing_m(),
        "corners": [
            corner(0, 0),
            corner(0, cols - 1),
            corner(rows - 1, 0),
            corner(rows - 1, cols - 1),
        ],
        "digest": digest(map.values()),
    })
}

/// What the stock reader must find in a log, its clouds and metadata aside.
fn expected(log: &LogReader) -> Value {
    let observations = log.entries.iter().filter_map(|entry| match entry {
        Entry::Observation(told) => Some(observation(told)),
        _ => None,
    });
    let grids = log
        .maps()
        .map(|(number, topic)| grid(topic, number, &log.map(topic, number).expect("a map")));
    json!({
        "topics": log.topics,
        "decisions": log.decisions().map(decision).collect::<Vec<_>>(),
        "observations": observations.collect::<Vec<_>>(),
        "grids": grids.collect::<Vec<_>>(),
    })
}

/// Holds everything that both readers know of a whole log against each other.
fn compare(log: &LogReader, found: &Value) {
    assert_eq!(log.status, Status::Complete);
    assert_eq!(found["error"], Value::Null);
    let expected = expected(log);
    for part in ["topics", "observations", "decisions", "grids"] {
        assert_eq!(found[part], expected[part], "{part}");
    }
    assert_eq!(found["statistics"], expected["topics"], "the summary counts the same");
    assert_eq!(found["metadata"]["wisdom.run"], json!(log.metadata));
    let end = log.end.as_ref().expect("the run ended");
    let mut facts = end.facts.clone();
    facts.insert("status".into(), end.status.clone());
    facts.insert("decisions".into(), end.decisions.to_string());
    facts.insert("chain".into(), end.chain.clone());
    assert_eq!(found["metadata"]["wisdom.end"], json!(facts));
    let last = found["decisions"].as_array().and_then(|all| all.last()).expect("a decision");
    assert_eq!(last["chain_again"], json!(end.chain));
    let attachments: Vec<Value> = log
        .attachments
        .iter()
        .map(|a| json!([a.name, a.media_type, blake3::hash(&a.data).to_hex().to_string()]))
        .collect();
    assert_eq!(found["attachments"], json!(attachments));
    assert!(!attachments.is_empty());
}

#[test]
fn the_committed_sample_reads_the_same_without_our_code() {
    let Some(python) = python_or_skip("the_committed_sample_reads_the_same_without_our_code")
    else {
        return;
    };
    let path = root().join("logs/sample/paper-decisions-5.mcap");
    let log = LogReader::open(&path).expect("the sample is a log");
    compare(&log, &found(&python, &path));
}

/// A short run of the paper's scene, logged.
fn short_run(path: &Path) {
    let overrides = [("budget.energy-j", "3.5e5"), ("goals.expansions", "2000")]
        .map(|(key, value)| Override::new(key, value.to_owned()));
    let mission = Mission::load(&root().join("missions/paper"), &overrides).expect("it loads");
    let mut log = begin(path, &mission, Options::default()).expect("a log");
    let summary = wisdom_mission::run(&mission, &mut log, &mut |_| true).expect("it runs");
    log.finish(&summary.status.to_string(), &BTreeMap::new()).expect("it is written");
}

/// Every point of a cloud lies over the middle of a cell, at its height over the lowest one, with its interest.
fn check_cloud(log: &LogReader, cloud: &Value) {
    let number = cloud["decision"].as_u64().expect("a number") as u32;
    let interest = log.map(topic::INTEREST, number).expect("a map");
    // Logged with the first decision alone, as is what the rover saw before that.
    let elevation = log.map("/map/elevation", 0).expect("a map");
    let first = log.entries.iter().find_map(|entry| match entry {
        Entry::Observation(told) => told.windows.iter().find(|w| w.layer == "elevation"),
        _ => None,
    });
    let first = first.expect("the first look reads elevation");
    assert_eq!((first.row, first.col, first.rows, first.cols), (0, 0, 101, 101));
    let known = |cell: Cell| first.uncertainty[cell.row * 101 + cell.col] < 1.0;
    let heights = elevation.spec().cells().filter(|cell| known(*cell)).map(|cell| elevation[cell]);
    let lowest = heights.fold(f32::INFINITY, f32::min);
    let points = cloud["points"].as_array().expect("points");
    if number == 0 {
        // 101 x 101 cells are thinned to every second row and column.
        let even = |cell: &Cell| cell.row.is_multiple_of(2) && cell.col.is_multiple_of(2);
        let drawn = elevation.spec().cells().filter(even).filter(|cell| known(*cell)).count();
        assert_eq!(points.len(), drawn);
    }
    assert!(points.len() > 1000, "{}", points.len());
    for point in points {
        let at = |index: usize| point[index].as_f64().expect("a number");
        let cell = Cell::new((101.0 - at(1)) as usize, at(0) as usize);
        assert_eq!((at(0), at(1)), (cell.col as f64 + 0.5, 101.0 - cell.row as f64 - 0.5));
        assert_eq!(at(3) as f32, interest[cell], "{cell}");
        if number == 0 {
            assert_eq!(at(2) as f32, elevation[cell] - lowest, "{cell}");
        }
    }
}

#[test]
fn a_fresh_log_reads_the_same_without_our_code_whole_or_cut() {
    let Some(python) = python_or_skip("a_fresh_log_reads_the_same_without_our_code_whole_or_cut")
    else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    short_run(&path);
    let log = LogReader::open(&path).expect("a log");
    let whole = found(&python, &path);
    compare(&log, &whole);
    let clouds = whole["clouds"].as_array().expect("clouds");
    assert!(!clouds.is_empty());
    for cloud in clouds {
        check_cloud(&log, cloud);
    }

    // Without its second half it is read from the front, as far as it goes: as far as our own reader gets.
    let bytes = fs::read(&path).expect("it was written");
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("a file");
    let ours = LogReader::open(&cut).expect("the beginning of a log");
    assert!(matches!(ours.status, Status::Truncated { .. }), "{}", ours.status);
    let theirs = found(&python, &cut);
    assert_ne!(theirs["error"], Value::Null);
    let expected = expected(&ours);
    assert!(expected["decisions"].as_array().is_some_and(|all| !all.is_empty()));
    assert_eq!(theirs["decisions"], expected["decisions"]);
    assert_eq!(theirs["grids"], expected["grids"]);

    // A flipped bit in the middle of a chunk is told by its checksum.
    let mut broken = bytes;
    let middle = broken.len() / 2;
    broken[middle] ^= 1;
    fs::write(&cut, &broken).expect("a file");
    assert_ne!(found(&python, &cut)["error"], Value::Null);
}
