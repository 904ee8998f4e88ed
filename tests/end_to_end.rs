//! Mission to log to replay to comparison, as a user runs it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mcap::records::Record;
use prost::Message;
use serde_json::Value;
use wisdom_logbook::record;
use wisdom_logbook::{Entry, LogReader};

fn wisdom(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command
}

fn done(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}\n{errors}");
    text
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&done(output)).expect("one JSON object")
}

/// A short run of the paper's scene: enough for several goals, soon over.
const SHORT: [&str; 4] = ["--set", "budget.energy-j=7e5", "--set", "goals.expansions=20000"];

fn short_run(log: &Path, more: &[&str], threads: &str) -> Value {
    let mut args = vec!["run", "missions/paper", "--json", "--log", log.to_str().expect("UTF-8")];
    args.extend(SHORT);
    args.extend(more);
    json(&wisdom(&args).env("RAYON_NUM_THREADS", threads).output().expect("the command runs"))
}

struct Sample {
    _folder: tempfile::TempDir,
    log: PathBuf,
    summary: Value,
}

fn sample() -> Sample {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("run.mcap");
    let summary = short_run(&log, &[], "2");
    Sample { _folder: folder, log, summary }
}

#[test]
fn a_run_is_told_verified_and_drawn() {
    let run = sample();
    let log = run.log.to_str().expect("UTF-8");
    assert!(!run.summary["goals"].as_array().expect("goals").is_empty());

    let told = done(&wisdom(&["replay", log]).output().expect("replay"));
    assert!(told.contains("Decision 0") && told.contains("because    start"), "{told}");
    assert!(told.contains("The run ended"), "{told}");
    let one = done(&wisdom(&["replay", log, "--decision", "1"]).output().expect("replay"));
    assert!(one.contains("all objectives") && !one.contains("Decision 0 "), "{one}");
    let dot = done(&wisdom(&["replay", log, "--decision", "0", "--dot"]).output().expect("replay"));
    assert!(dot.starts_with("digraph") && dot.contains("arm-stowed"), "{dot}");

    let lines = done(&wisdom(&["replay", log, "--json"]).output().expect("replay"));
    let actions = ["add", "keep", "modify", "reorder", "defer", "drop", "achieve"];
    let mut decisions = 0;
    for line in lines.lines() {
        let decision: Value = serde_json::from_str(line).expect("one object a decision");
        for verdict in decision["choice"]["verdicts"].as_array().expect("verdicts") {
            let action = verdict["action"].as_str().expect("an action");
            assert!(actions.contains(&action), "{action}");
            assert!(!verdict["reason"].as_str().expect("a reason").is_empty());
        }
        decisions += 1;
    }
    assert_eq!(Some(decisions), run.summary["decisions"].as_u64());

    let verified = json(&wisdom(&["verify", log, "--json"]).output().expect("verify"));
    assert_eq!(verified["identical"], true);
    assert_eq!(verified["chain"], "intact");
    assert_eq!(verified["decisions"].as_u64(), Some(decisions));

    for layer in ["interest", "hazard", "texture", "elevation-u"] {
        let picture = run.log.with_extension(format!("{layer}.png"));
        let path = picture.to_str().expect("UTF-8");
        done(
            &wisdom(&["show", log, "--layer", layer, "--decision", "1", "-o", path])
                .output()
                .expect("show"),
        );
        let bytes = std::fs::read(&picture).expect("a picture");
        assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000);
    }
    // A picture never takes the place of anything but a picture, the log least of all.
    let posed = run.log.with_extension("png");
    std::fs::copy(&run.log, &posed).expect("a log under a picture's name");
    for output in [log, posed.to_str().expect("UTF-8")] {
        let before = std::fs::read(output).expect("it is there");
        let shown = wisdom(&["show", log, "-o", output]).output().expect("show");
        assert_eq!(shown.status.code(), Some(2), "{output}");
        assert_eq!(std::fs::read(output).expect("it is still there"), before);
    }
    let output = wisdom(&["show", log, "--layer", "colour", "-o", "x.png"]).output().expect("show");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("interest"), "it names what there is");
}

#[test]
fn decisions_are_identical_at_1_2_and_7_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let chains: Vec<String> = ["1", "2", "7"]
        .iter()
        .map(|threads| {
            let log = folder.path().join(format!("{threads}.mcap"));
            short_run(&log, &[], threads);
            LogReader::open(&log).expect("a log").end.expect("an end").chain
        })
        .collect();
    assert_eq!(chains[0], chains[1]);
    assert_eq!(chains[0], chains[2]);
}

#[test]
fn rules_meet_the_same_world_and_are_compared_on_one_ruler() {
    let args = [
        "compare",
        "missions/paper",
        "--rules",
        "dsmc,dsmc,pcr6",
        "--seeds",
        "1..2",
        "--json",
        "--set",
        "budget.energy-j=7e5",
        "--set",
        "goals.expansions=20000",
    ];
    let told = json(&wisdom(&args).output().expect("compare"));
    for world in told["worlds"].as_array().expect("worlds") {
        let runs = world["runs"].as_array().expect("runs");
        // A rule against itself: nothing differs.
        assert_eq!(runs[1]["against_first"]["jaccard"], 1.0);
        assert_eq!(runs[1]["against_first"]["first_divergent_decision"], Value::Null);
        assert_eq!(runs[0]["goals"], runs[1]["goals"]);
        assert!(
            runs[2]["against_first"]["first_divergent_decision"].is_u64(),
            "pcr6 decides otherwise"
        );
    }
    assert_eq!(told["means"].as_array().map(Vec::len), Some(3));
}

#[test]
fn mistakes_are_told_with_their_place_and_exit_code_2() {
    let output =
        wisdom(&["check", "missions/paper", "--set", "budget.enrgy-j=3"]).output().expect("check");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("enrgy-j") && errors.contains("energy-j") && errors.contains('^'),
        "{errors}"
    );
    for args in [
        vec!["run", "missions/nowhere"],
        vec!["replay", "missions/paper/mission.toml"],
        vec!["run", "missions/paper", "--rule", "pcr9"],
        vec!["run", "missions/paper", "--rule", "pcr6", "--set", "rule=dsmc"],
        vec!["compare", "missions/paper", "--seeds", "1..2", "--set", "seed=9"],
        vec!["compare", "missions/paper", "--seeds", "5..1"],
    ] {
        let output = wisdom(&args).output().expect("the command runs");
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(!output.stderr.is_empty());
    }
    let output = wisdom(&["check", "missions/marias-pass", "--json"]).output().expect("check");
    assert_eq!(json(&output)["layers"].as_array().map(Vec::len), Some(4));
}

#[test]
fn a_log_cut_off_reads_back_to_its_last_decision() {
    let run = sample();
    let bytes = std::fs::read(&run.log).expect("a log");
    let cut = run.log.with_extension("mcap.part");
    std::fs::write(&cut, &bytes[..bytes.len() * 2 / 3]).expect("a shorter log");
    let path = cut.to_str().expect("UTF-8");
    let output = wisdom(&["verify", path, "--json"]).output().expect("verify");
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    let told: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(told["identical"], true);
    let decisions = told["decisions"].as_u64().expect("a number");
    assert!(decisions > 0 && decisions < run.summary["decisions"].as_u64().expect("a number"));
    let output = wisdom(&["replay", path]).output().expect("replay");
    assert_eq!(output.status.code(), Some(3));
}

/// A log rewritten record by record, every checksum made anew, after `edit` changed what it holds.
struct Rewrite<'a> {
    metadata: &'a mut dyn FnMut(&str, &mut BTreeMap<String, String>),
    attachment: &'a mut dyn FnMut(&str, &mut Vec<u8>),
    observation: &'a mut dyn FnMut(&mut record::Observation),
}

fn rewrite(bytes: &[u8], edit: &mut Rewrite<'_>) -> Vec<u8> {
    let mut out = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).expect("a writer");
    let mut observations = 0u16;
    for record in mcap::read::ChunkFlattener::new(bytes).expect("a log") {
        match record.expect("a whole record") {
            Record::Schema { header, data } => {
                writer
                    .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
                    .expect("a schema");
            }
            Record::Channel(channel) => {
                if channel.topic == "/in/observation" {
                    observations = channel.id;
                }
                writer
                    .add_channel_with_id(
                        channel.id,
                        channel.schema_id,
                        &channel.topic,
                        &channel.message_encoding,
                        &channel.metadata,
                    )
                    .expect("a channel");
            }
            Record::Message { header, data } => {
                let mut data = data.into_owned();
                if header.channel_id == observations {
                    let mut message =
                        record::Observation::decode(&data[..]).expect("an observation");
                    (edit.observation)(&mut message);
                    data = message.encode_to_vec();
                }
                writer.write_to_known_channel(&header, &data).expect("a message");
            }
            Record::Attachment { header, data, .. } => {
                let mut data = data.into_owned();
                (edit.attachment)(&header.name, &mut data);
                writer
                    .attach(&mcap::Attachment {
                        log_time: header.log_time,
                        create_time: header.create_time,
                        name: header.name.clone(),
                        media_type: header.media_type.clone(),
                        data: data.into(),
                    })
                    .expect("an attachment");
            }
            Record::Metadata(mut metadata) => {
                (edit.metadata)(&metadata.name, &mut metadata.metadata);
                writer
                    .write_metadata(&mcap::records::Metadata { ..metadata })
                    .expect("a metadata record");
            }
            _ => {}
        }
    }
    writer.finish().expect("an end");
    drop(writer);
    out.into_inner()
}

fn verdict_of(log: &Path) -> (Option<i32>, Value) {
    let output =
        wisdom(&["verify", log.to_str().expect("UTF-8"), "--json"]).output().expect("verify");
    let told = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| {
        panic!("{}", String::from_utf8_lossy(&output.stderr));
    });
    (output.status.code(), told)
}

#[test]
fn a_changed_reading_under_a_chosen_goal_is_found_at_its_decision() {
    let run = sample();
    let log = LogReader::open(&run.log).expect("a log");
    // The latest decision after which readings of its goal's place were still taken in.
    let mut wanted: Option<(u32, u32, record::Cell)> = None;
    let mut best: BTreeMap<(u32, u32), f32> = BTreeMap::new();
    let mut goal: Option<record::Cell> = None;
    let mut decided = 0;
    for entry in &log.entries {
        match entry {
            Entry::Decision(decision) => {
                decided = decision.number + 1;
                let choice = decision.choice.as_ref().expect("a choice");
                goal = choice
                    .verdicts
                    .iter()
                    .filter(|v| v.turn == Some(0))
                    .find_map(|v| v.goal.as_ref()?.target);
            }
            Entry::Observation(observation) => {
                for window in observation.windows.iter().filter(|w| w.layer == "temperature") {
                    for (i, u) in window.uncertainty.iter().enumerate() {
                        let (row, col) = (
                            window.row + i as u32 / window.cols,
                            window.col + i as u32 % window.cols,
                        );
                        let known = best.entry((row, col)).or_insert(1.0);
                        if *u < *known {
                            *known = *u;
                            if decided > 0 && goal == Some(record::Cell { row, col }) {
                                wanted =
                                    Some((observation.number, decided, record::Cell { row, col }));
                            }
                        }
                    }
                }
            }
            Entry::Outcome(_) | Entry::Message(_) | Entry::Fault(_) => {}
        }
    }
    let (number, decision, cell) = wanted.expect("the rover looked at a goal on its way");
    assert!(decision > 0);

    let bytes = std::fs::read(&run.log).expect("a log");
    let mut changed = 0;
    let spoiled = rewrite(
        &bytes,
        &mut Rewrite {
            metadata: &mut |_, _| {},
            attachment: &mut |_, _| {},
            observation: &mut |observation| {
                if observation.number != number {
                    return;
                }
                for window in observation.windows.iter_mut().filter(|w| w.layer == "temperature") {
                    let (row, col) = (cell.row - window.row, cell.col - window.col);
                    let value = &mut window.values[(row * window.cols + col) as usize];
                    // Bands of Table 2 are 20 wide: this is another one.
                    *value = (*value + 40.0) % 100.0;
                    changed += 1;
                }
            },
        },
    );
    assert_eq!(changed, 1);
    let path = run.log.with_extension("spoiled.mcap");
    std::fs::write(&path, spoiled).expect("a spoiled log");
    let (code, told) = verdict_of(&path);
    assert_eq!(code, Some(1));
    assert_eq!(told["log_status"], "complete", "only deriving it again can notice");
    assert_eq!(told["chain"], "intact");
    assert_eq!(told["difference"]["decision"].as_u64(), Some(u64::from(decision)), "{told}");
    assert_eq!(told["difference"]["stage"], "frame");
}

#[test]
fn a_table_mass_changed_by_a_millionth_is_found_at_the_masses() {
    let run = sample();
    let bytes = std::fs::read(&run.log).expect("a log");
    let table = "mission/experts/texture.toml";
    let change = |name: &str, data: &mut Vec<u8>| {
        if name == table {
            let text = String::from_utf8(data.clone()).expect("UTF-8");
            let changed = text.replacen("interesting = 0.95", "interesting = 0.949999", 1);
            assert_ne!(changed, text);
            *data = changed.into_bytes();
        }
    };
    // The mission's identity must fit its changed table, or that alone would be noticed.
    let log = LogReader::open(&run.log).expect("a log");
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    for attachment in &log.attachments {
        let mut data = attachment.data.clone();
        change(&attachment.name, &mut data);
        let name = attachment.name.strip_prefix("mission/").expect("only mission files");
        files.insert(name.to_owned(), data);
    }
    let mission = wisdom_mission::Mission::from_files(&files).expect("still a mission");
    let digest = mission.digest.iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"));
    let spoiled = rewrite(
        &bytes,
        &mut Rewrite {
            metadata: &mut |_, metadata| {
                if let Some(value) = metadata.get_mut("mission_digest") {
                    value.clone_from(&digest);
                }
            },
            attachment: &mut |name, data| change(name, data),
            observation: &mut |_| {},
        },
    );
    let path = run.log.with_extension("spoiled.mcap");
    std::fs::write(&path, &spoiled).expect("a spoiled log");
    let (code, told) = verdict_of(&path);
    assert_eq!(code, Some(1));
    assert_eq!(told["difference"]["decision"].as_u64(), Some(0), "{told}");
    assert_eq!(told["difference"]["stage"], "masses");

    // Rewriting alone changes nothing.
    let same = rewrite(
        &bytes,
        &mut Rewrite {
            metadata: &mut |_, _| {},
            attachment: &mut |_, _| {},
            observation: &mut |_| {},
        },
    );
    std::fs::write(&path, same).expect("a copy");
    assert_eq!(verdict_of(&path).0, Some(0));
}

#[test]
fn a_fault_is_in_the_log_and_the_story_and_the_log_is_verified_without_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("run.mcap");
    let fault = "fault=[{ name = \"sticky hub\", kind = \"wheel-drag\", factor = 1.5, \
                 probability = 1.0, between-s = [500.0, 600.0], lasts-s = 3000.0 }]";
    let summary = short_run(&log, &["--set", fault], "2");
    assert_eq!(summary["faults"][0]["name"], "sticky hub");
    let path = log.to_str().expect("UTF-8");
    let told = done(&wisdom(&["replay", path]).output().expect("replay"));
    assert!(told.contains("fault `sticky hub` (wheel-drag: x 1.5) strikes at 5"), "{told}");
    let verified = json(&wisdom(&["verify", path, "--json"]).output().expect("verify"));
    assert_eq!(verified["identical"], true, "the rover never knew");
    let read = LogReader::open(&log).expect("a log");
    let faults: Vec<&record::Fault> = read
        .entries
        .iter()
        .filter_map(|entry| match entry {
            Entry::Fault(fault) => Some(fault),
            _ => None,
        })
        .collect();
    assert_eq!(faults.len(), 1);
    assert_eq!(faults[0].until_s, Some(faults[0].time_s + 3000.0));
}
