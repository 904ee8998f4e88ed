//! `wisdom log`: what it says of logs that are whole, cut and hurt, and how it ends.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use wisdom_logbook::{LogReader, Status, VerifyLevel};

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("logs/sample/paper-decisions-5.mcap")
}

fn log(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wisdom")).arg("log").args(args).output().expect("it runs")
}

fn path(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&text(output)).expect("one JSON object")
}

/// The sample whole, cut short, and with a bit flipped in its middle.
struct Logs {
    folder: tempfile::TempDir,
    whole: PathBuf,
    cut: PathBuf,
    hurt: PathBuf,
}

fn logs() -> Logs {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = std::fs::read(sample()).expect("the sample");
    let cut = folder.path().join("cut.mcap.part");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 8;
    let hurt = folder.path().join("hurt.mcap");
    std::fs::write(&hurt, &bytes).expect("written");
    Logs { folder, whole: sample(), cut, hurt }
}

#[test]
fn the_exit_code_tells_whole_corrupt_and_truncated_logs_apart() {
    let logs = logs();
    let nothing = logs.folder.path().join("nothing.mcap");
    let codes = [(&logs.whole, 0), (&logs.hurt, 1), (&nothing, 2), (&logs.cut, 3)];
    for (file, code) in codes {
        let output = log(&["check", path(file)]);
        assert_eq!(output.status.code(), Some(code), "{}: {output:?}", file.display());
        let output = log(&["check", path(file), "--json"]);
        assert_eq!(output.status.code(), Some(code), "{}: {output:?}", file.display());
        if code == 2 {
            continue;
        }
        let told = json(&output);
        let findings = told["findings"].as_array().expect("findings");
        let failing = findings.iter().filter(|finding| finding["verdict"] == "fails").count();
        assert_eq!(failing > 0, code == 1, "{told}");
    }
}

#[test]
fn info_counts_what_the_reader_counts() {
    let logs = logs();
    for (file, indexed, code) in [(&logs.whole, true, 0), (&logs.cut, false, 3)] {
        let output = log(&["info", path(file), "--json"]);
        assert_eq!(output.status.code(), Some(code), "{output:?}");
        let told = json(&output);
        let read = LogReader::open(file).expect("a log");
        assert_eq!(told["indexed"], indexed);
        assert_eq!(told["decisions"].as_u64(), Some(read.decisions().count() as u64));
        for (topic, count) in &read.topics {
            assert_eq!(told["topics"][topic].as_u64(), Some(*count), "{topic}");
        }
        assert_eq!(told["run"]["mission"], "paper");
        let files = told["attachments"].as_array().expect("files");
        assert_eq!(files.len(), read.attachments.len());
        assert_eq!(told["end"].is_null(), read.end.is_none());
        let output = log(&["info", path(file)]);
        assert_eq!(output.status.code(), Some(code));
        assert!(text(&output).contains("mission/mission.toml"), "{}", text(&output));
    }
}

#[test]
fn what_a_broken_log_holds_is_saved_and_tells_its_story() {
    let logs = logs();
    for (number, file) in [&logs.cut, &logs.hurt].into_iter().enumerate() {
        let saved = logs.folder.path().join(format!("saved-{number}.mcap"));
        let output = log(&["recover", path(file), path(&saved), "--json"]);
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let told = json(&output);
        assert!(told["bytes_left_out"].as_u64().expect("a number") > 0);
        let (before, after) = (LogReader::open(file), LogReader::open(&saved));
        let (before, after) = (before.expect("a log"), after.expect("a log"));
        assert_eq!(after.entries, before.entries);
        assert_eq!(after.attachments, before.attachments);
        assert_eq!(told["decisions"].as_u64(), Some(after.decisions().count() as u64));
        assert!(matches!(after.status, Status::Truncated { .. }), "{:?}", after.status);
        assert!(after.decisions().count() > 0);
        let verified = wisdom_logbook::verify(&saved, VerifyLevel::Redecide, &mut |_| {})
            .expect("its mission loads");
        assert_eq!(verified.difference, None);
        assert_eq!(log(&["check", path(&saved)]).status.code(), Some(3));
        assert!(text(&log(&["info", path(&saved)])).contains("recovered"));
        // Never over what is there.
        let before = std::fs::read(&saved).expect("bytes");
        assert_eq!(log(&["recover", path(file), path(&saved)]).status.code(), Some(2));
        assert_eq!(std::fs::read(&saved).expect("bytes"), before);
    }
    let copy = logs.folder.path().join("copy.mcap");
    assert_eq!(log(&["recover", path(&logs.whole), path(&copy)]).status.code(), Some(0));
    assert_eq!(LogReader::open(&copy).expect("a log").status, Status::Complete);
}

#[test]
fn cat_prints_each_message_once_and_decisions_whole() {
    let logs = logs();
    let read = LogReader::open(&logs.whole).expect("a log");
    let all: u64 = read.topics.values().sum();
    let output = log(&["cat", path(&logs.whole)]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output).lines().count() as u64, all);
    let output = log(&["cat", path(&logs.whole), "--json", "--topic", "/decision"]);
    let printed: Vec<Value> =
        text(&output).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let decisions: Vec<Value> = read
        .decisions()
        .map(|decision| serde_json::to_value(decision).expect("a record is JSON"))
        .collect();
    assert_eq!(printed.iter().map(|p| p["message"].clone()).collect::<Vec<_>>(), decisions);
    // One decision, with what came after the one before it.
    for file in [&logs.whole, &logs.cut] {
        let output = log(&["cat", path(file), "--json", "--decision", "1", "--topic", "/decision"]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let told: Value = serde_json::from_str(text(&output).trim()).expect("one line");
        assert_eq!(told["message"], decisions[1]);
    }
    let output = log(&["cat", path(&logs.whole), "--decision", "1"]);
    assert!(text(&output).lines().any(|line| line.contains("/map/interest")));
    assert_eq!(log(&["cat", path(&logs.whole), "--decision", "99"]).status.code(), Some(2));
    assert_eq!(log(&["cat", path(&logs.cut)]).status.code(), Some(3));
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let file = sample();
    for command in ["cat", "info", "check"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_wisdom"))
            .args(["log", command, path(&file), "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it runs");
        let mut first = [0; 1];
        child.stdout.take().expect("piped").read_exact(&mut first).expect("a byte");
        let output = child.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{command}: {output:?}");
        assert!(output.stderr.is_empty(), "{command}: {output:?}");
    }
}
