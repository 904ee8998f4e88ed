//! `wisdom compare`, as a user runs it: a mission under several rules, and logs that are there.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader};
use serde_json::Value;
use wisdom_logbook::{LogReader, Status};

fn wisdom(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).output().expect("the command runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> Value {
    let told = text(&output.stdout);
    serde_json::from_str(&told).unwrap_or_else(|e| panic!("{e}: {told}\n{}", text(&output.stderr)))
}

fn utf8(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("a list, not {value}"))
}

/// A short run of the paper's scene: enough for several goals, soon over. One label lies where no goal is worth going, and one
/// is all the ground.
const SHORT: [&str; 6] = [
    "--set",
    "budget.energy-j=7e5",
    "--set",
    "goals.expansions=20000",
    "--set",
    "label=[{name=\"all\",at=[50,50],radius-m=200,worth=2.5},{name=\"off\",at=[0,100],radius-m=1}]",
];

/// A comparison with everything that can be written, made once for all tests.
struct Made {
    folder: tempfile::TempDir,
    told: Value,
}

impl Made {
    fn log(&self, name: &str) -> PathBuf {
        self.folder.path().join("logs").join(format!("paper-seed1-{name}.mcap"))
    }

    fn runs(&self) -> &[Value] {
        list(&self.told["worlds"][0]["runs"])
    }
}

fn made() -> &'static Made {
    static MADE: OnceLock<Made> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| utf8(&folder.path().join(name)).to_owned();
        let (logs, csv, figures, merged) = (at("logs"), at("csv"), at("figures"), at("all.mcap"));
        let mut args = vec!["compare", "missions/paper", "--rules", "dsmc,dsmc,pcr6", "--json"];
        args.extend(["--logs", &logs, "--csv", &csv, "--figures", &figures, "--mcap", &merged]);
        args.extend(SHORT);
        let output = wisdom(&args);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        Made { told: json(&output), folder }
    })
}

#[test]
fn a_rule_against_itself_agrees_in_everything() {
    let runs = made().runs();
    let held = &runs[1]["against_first"];
    assert_eq!(held["inputs"]["equal"], true);
    assert_eq!(held["inputs"]["first_different_observation"], Value::Null);
    assert_eq!(held["divergence"], Value::Null);
    assert_eq!((&held["edit_distance"], &held["decisions_apart"]), (&0.into(), &0.into()));
    assert_eq!(held["jaccard"], 1.0);
    assert_eq!(runs[0]["goals"], runs[1]["goals"]);
    for side in ["of_first", "of_this"] {
        let asked = &held["at_states"][side];
        assert_eq!(asked["alike"], asked["decisions"], "{side}");
        assert_eq!(asked["decisions"], runs[0]["decisions"]);
    }
    let rows = list(&made().told["worlds"][0]["regret"]["rows"]);
    assert_eq!(rows[0]["totals"], rows[1]["totals"]);
}

#[test]
fn what_is_told_of_a_run_is_what_the_run_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("run.mcap");
    let mut args = vec!["run", "missions/paper", "--json", "--rule", "pcr6", "--log", utf8(&log)];
    args.extend(SHORT);
    let run = json(&wisdom(&args));
    let told = &made().runs()[2];
    for key in [
        "interest_own_map",
        "interest_ruler",
        "reliability",
        "distance_m",
        "time_s",
        "energy_j",
        "data_mb",
        "decisions",
        "reallocations",
        "status",
        "rule",
        "policy",
    ] {
        assert_eq!(told[key], run[key], "{key}");
    }
    let (told, run) = (list(&told["goals"]), list(&run["goals"]));
    assert!(run.len() > 1 && told.len() == run.len());
    for (told, run) in told.iter().zip(run) {
        for key in ["goal", "directive", "row", "col", "interest", "prize", "ruler", "time_s"] {
            assert_eq!(told[key], run[key], "{key}");
        }
    }
}

#[test]
fn runs_part_where_their_rule_makes_them() {
    let held = &made().runs()[2]["against_first"];
    assert_eq!(held["inputs"]["rule_alone"], true);
    let keys = list(&held["inputs"]["files"][0]["keys"]);
    assert_eq!((keys.len(), &keys[0]["key"]), (1, &"rule".into()));
    let parted = &held["divergence"];
    assert_eq!(held["first_divergent_decision"], parted["decision"]);
    if parted["decision"] == 0 {
        for same in ["same_readings", "same_rover", "same_memory"] {
            assert_eq!(parted[same], true, "nothing was done before decision 0: {same}");
        }
        assert_eq!(parted["stage"], "fusion");
        // At the first state both rules were asked, and each says what its own run did there.
        let asked = &held["at_states"];
        assert_eq!(asked["of_first"]["states"][0]["other"], parted["this"]);
        assert_eq!(asked["of_this"]["states"][0]["other"], parted["first"]);
    }
    for side in ["of_first", "of_this"] {
        let asked = &held["at_states"][side];
        let states = list(&asked["states"]);
        let alike = states.iter().filter(|state| state["by"].is_null()).count();
        assert_eq!(asked["alike"], alike);
        assert_eq!(asked["decisions"], states.len());
        // A state that both choose alike at is one that the edit of the choice says nothing of.
        for state in states.iter().filter(|state| state["by"].is_null()) {
            assert_eq!(state["own"]["act"], state["other"]["act"]);
        }
    }
    let of_first = &held["at_states"]["of_first"];
    assert_eq!(of_first["decisions"], made().runs()[0]["decisions"]);
}

#[test]
fn the_edits_turn_the_first_sequence_into_the_other() {
    for run in made().runs() {
        let (first, this) = (list(&made().runs()[0]["sequence"]), list(&run["sequence"]));
        let edits = list(&run["against_first"]["edits"]);
        let mut made_of = vec![Value::Null; this.len()];
        let mut used = 0;
        for edit in edits {
            if let Some(from) = edit["first_stop"].as_u64() {
                assert_eq!(first[from as usize - 1], edit["place"]);
                used += 1;
            }
            if let Some(to) = edit["this_stop"].as_u64() {
                made_of[to as usize - 1] = edit["place"].clone();
            }
        }
        assert_eq!((made_of.as_slice(), used), (this, first.len()));
        let changed = edits.iter().filter(|edit| edit["edit"] != "keep").count();
        assert_eq!(run["against_first"]["edit_distance"], changed);
        // The Jaccard index again, from the names of the places.
        let set =
            |s: &[Value]| s.iter().map(Value::to_string).collect::<std::collections::BTreeSet<_>>();
        let (a, b) = (set(first), set(this));
        let share = a.intersection(&b).count() as f64 / a.union(&b).count() as f64;
        assert_eq!(run["against_first"]["jaccard"], share);
    }
}

#[test]
fn regret_is_what_the_best_sequence_has_more() {
    let regret = &made().told["worlds"][0]["regret"];
    let measures = list(&regret["measures"]);
    assert_eq!(measures.len(), 3 + 2, "{measures:?}");
    let number = |run: usize, what: &str, measure: usize| {
        regret["rows"][run][what][measure].as_f64().expect("a number")
    };
    for measure in 0..measures.len() {
        let best = (0..3).map(|run| number(run, "totals", measure)).fold(f64::MIN, f64::max);
        for run in 0..3 {
            let missed = best - number(run, "totals", measure);
            assert_eq!(number(run, "regrets", measure), missed);
        }
    }
    for (run, told) in made().runs().iter().enumerate() {
        assert_eq!(told["interest_ruler"].as_f64(), Some(number(run, "totals", 3)));
        // One label holds all the ground and is found by the first goal; the other is out of reach.
        assert_eq!((told["labels"].as_f64(), number(run, "totals", 4)), (Some(2.5), 2.5));
        let found: Vec<&Value> = list(&told["goals"]).iter().map(|goal| &goal["label"]).collect();
        assert_eq!(found[0], "all");
        assert!(found[1..].iter().all(|label| label.is_null()));
    }
}

fn table(name: &str) -> Vec<BTreeMap<String, String>> {
    let path = made().folder.path().join("csv").join(format!("{name}.csv"));
    let whole = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = whole.lines().map(cells);
    let header = lines.next().expect("a header");
    lines
        .map(|cells| {
            assert_eq!(cells.len(), header.len(), "{name}: {cells:?}");
            header.iter().cloned().zip(cells).collect()
        })
        .collect()
}

/// The cells of a line of comma-separated values, of which some are in quotes.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for sign in line.chars() {
        match sign {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            sign => cells.last_mut().expect("one at least").push(sign),
        }
    }
    cells
}

#[test]
fn the_tables_hold_what_the_object_holds() {
    let runs = table("runs");
    assert_eq!(runs.len(), 3);
    let stops = table("sequences");
    for (row, told) in runs.iter().zip(made().runs()) {
        assert_eq!(row["run"], told["name"].as_str().expect("a name"));
        let of_run: Vec<_> = stops.iter().filter(|stop| stop["run"] == row["run"]).collect();
        assert_eq!(row["goals"], of_run.len().to_string());
        let sum =
            of_run.iter().fold(0.0, |sum, s| sum + s["ruler"].parse::<f64>().expect("a number"));
        assert_eq!(row["interest_ruler"].parse(), Ok(sum));
        assert_eq!(told["interest_ruler"].as_f64(), Some(sum));
    }
    let held = |run: usize| &made().runs()[run]["against_first"];
    let edits: usize = (1..3).map(|run| list(&held(run)["edits"]).len()).sum();
    assert_eq!(table("edits").len(), edits);
    let states = |run: usize, side: &str| list(&held(run)["at_states"][side]["states"]).len();
    let asked: usize = (1..3).map(|run| states(run, "of_first") + states(run, "of_this")).sum();
    assert_eq!(table("decisions").len(), asked);
    assert_eq!(table("regret").len(), 3 * 5);
}

#[test]
fn every_figure_is_there_twice_and_shows_something() {
    let folder = made().folder.path().join("figures");
    let names = ["interest", "difference_pcr6", "difference_dsmc__2_", "sequences", "timeline"];
    let gains = ["gain_time", "gain_energy", "gain_distance"];
    for name in names.into_iter().chain(gains) {
        let svg = fs::read_to_string(folder.join(format!("{name}.svg"))).expect(name);
        let parsed = roxmltree::Document::parse(&svg).expect("XML");
        let side = |key: &str| -> u32 {
            let root = parsed.root_element();
            root.attribute(key).expect("a side").parse().expect("a whole number")
        };
        let (width, height, colours) = picture(&folder.join(format!("{name}.png")));
        // Charts have two pixels of a PNG to one of the drawing; of maps the SVG holds the PNG's.
        let map = name.starts_with("interest") || name.starts_with("difference");
        let scale = if map { 1 } else { 2 };
        assert_eq!((width, height), (scale * side("width"), scale * side("height")), "{name}");
        let least = if name.starts_with("interest") { 100 } else { 5 };
        assert!(colours >= least, "{name}: {colours} colours");
    }
}

/// Width, height and number of colours of a PNG.
fn picture(path: &Path) -> (u32, u32, usize) {
    let file = std::io::BufReader::new(fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    let colours: std::collections::BTreeSet<&[u8]> = bytes.chunks_exact(3).collect();
    (info.width, info.height, colours.len())
}

/// What an MCAP file holds, by a plain reader of the format with all its checks on.
#[derive(Default)]
struct Held {
    /// Topic, time, schema and payload of each message, in the order of the file.
    messages: Vec<(String, u64, String, Vec<u8>)>,
    metadata: Vec<String>,
    attachments: BTreeMap<String, Vec<u8>>,
}

fn held(path: &Path) -> Held {
    let bytes = fs::read(path).expect("a file");
    mcap::Summary::read(&bytes).expect("a whole file").expect("an index");
    let options = mcap::sans_io::LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true);
    let mut reader = LinearReader::new_with_options(options);
    let (mut held, mut read) = (Held::default(), 0);
    let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
    while let Some(event) = reader.next_event() {
        match event.expect("a whole file") {
            LinearReadEvent::ReadRequest(need) => {
                let part = &bytes[read..bytes.len().min(read + need)];
                reader.insert(need)[..part.len()].copy_from_slice(part);
                reader.notify_read(part.len());
                read += part.len();
            }
            LinearReadEvent::Record { opcode, data } => {
                match mcap::parse_record(opcode, data).expect("a record") {
                    Record::Schema { header, .. } => {
                        schemas.insert(header.id, header.name);
                    }
                    Record::Channel(channel) => {
                        let schema = schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                        channels.insert(channel.id, (channel.topic, schema));
                    }
                    Record::Message { header, data } => {
                        let (topic, schema) = channels[&header.channel_id].clone();
                        held.messages.push((topic, header.log_time, schema, data.into_owned()));
                    }
                    Record::Metadata(metadata) => held.metadata.push(metadata.name),
                    Record::Attachment { header, data, .. } => {
                        held.attachments.insert(header.name, data.into_owned());
                    }
                    _ => {}
                }
            }
        }
    }
    held
}

#[test]
fn the_merged_file_holds_all_of_every_log() {
    let merged = held(&made().folder.path().join("all.mcap"));
    let times: Vec<u64> = merged.messages.iter().map(|message| message.1).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "each has a time of its own");
    let mut count = 0;
    for (letter, name) in [("a", "dsmc"), ("b", "dsmc-2"), ("c", "pcr6")] {
        let own = held(&made().log(name));
        let under: Vec<_> = merged
            .messages
            .iter()
            .filter(|message| message.0.starts_with(&format!("/{letter}/")))
            .collect();
        assert_eq!(under.len(), own.messages.len());
        count += under.len();
        for (merged, own) in under.iter().zip(&own.messages) {
            assert_eq!(merged.0, format!("/{letter}{}", own.0));
            assert_eq!(merged.2, own.2);
            // A nanosecond later for every message that another run has at its time.
            let later = merged.1.checked_sub(own.1);
            assert!(later.is_some_and(|later| later < 1000), "{later:?}");
            if own.2.starts_with("wisdom.") || own.2 == "foxglove.Log" {
                assert_eq!(merged.3, own.3, "{}", own.0);
            } else {
                let frame = format!("{letter}/map");
                let has = merged.3.windows(frame.len()).any(|part| part == frame.as_bytes());
                assert!(has, "{}: no frame {frame}", merged.0);
                assert!(merged.3.len() > own.3.len());
            }
        }
        for metadata in ["wisdom.run", "wisdom.end"] {
            assert!(merged.metadata.contains(&format!("{letter}/{metadata}")));
        }
        for (name, bytes) in &own.attachments {
            assert_eq!(merged.attachments.get(&format!("{letter}/{name}")), Some(bytes));
        }
    }
    // What is left are the transforms that put the maps beside each other.
    let rest = merged.messages.iter().filter(|message| message.0 == "/tf").count();
    assert_eq!((rest, merged.messages.len()), (3, count + 3));
}

#[test]
fn a_file_that_is_there_is_not_merged_over() {
    let (a, b) = (made().log("dsmc"), made().log("pcr6"));
    let before = fs::read(&b).expect("a log");
    let output = wisdom(&["compare", utf8(&a), utf8(&a), "--mcap", utf8(&b)]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("never written over"));
    assert_eq!(fs::read(&b).expect("a log"), before);
}

#[test]
fn logs_are_compared_as_the_runs_were() {
    let (a, b) = (made().log("dsmc"), made().log("pcr6"));
    let told = json(&wisdom(&["compare", utf8(&a), utf8(&b), "--json"]));
    let runs = list(&told["worlds"][0]["runs"]);
    let (of_logs, of_mission) = (&runs[1], &made().runs()[2]);
    assert_eq!(of_logs["against_first"], of_mission["against_first"]);
    assert_eq!(
        of_logs["goals"].as_array().map(Vec::len),
        of_mission["goals"].as_array().map(Vec::len)
    );
    let text = text(&wisdom(&["compare", utf8(&a), utf8(&b), "--at-states=never"]).stdout);
    assert!(text.contains("nothing else") && text.contains("regret"), "{text}");
    assert!(!text.contains("would have chosen") && !text.contains("its own, worth"), "{text}");
}

#[test]
fn why_the_own_choice_may_be_worth_less_is_told_under_the_states() {
    let (a, b) = (made().log("dsmc"), made().log("pcr6"));
    let told = text(&wisdom(&["compare", utf8(&a), utf8(&b), "--quiet"]).stdout);
    let (_, under) = told.split_once("would have chosen").expect("a table of states");
    assert_eq!(under.matches("`its own, worth` may be below `chosen, worth`").count(), 1, "{told}");
    // Nobody asks a rule that always chooses alike.
    let same = text(&wisdom(&["compare", utf8(&a), utf8(&a), "--quiet"]).stdout);
    assert!(same.contains("nowhere") && !same.contains("its own, worth"), "{same}");
}

#[test]
fn logs_of_two_missions_are_compared_as_far_as_that_goes() {
    let folder = tempfile::tempdir().expect("a folder");
    let other = folder.path().join("other.mcap");
    let one = ["--set", "execution.max-decisions=1", "--quiet"];
    let run = ["run", "missions/marias-pass", "--log", utf8(&other)];
    assert!(wisdom(&[&run[..], &one[..]].concat()).status.success());
    let output = wisdom(&["compare", utf8(&made().log("dsmc")), utf8(&other)]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(told.contains("mission paper against marias-pass"), "{told}");
    assert!(told.contains("the first run does not have it"), "{told}");
    let first = told.lines().next().expect("a line");
    assert!(
        first.starts_with("these are runs of different missions: paper, marias-pass"),
        "{told}"
    );
    assert!(first.contains("what needs a common ground is left out"), "{told}");
    let ground = "not asked what each would have chosen: its ground is";
    assert!(told.contains(ground) && told.contains("the log's 101 x 101 cells of 1 m"), "{told}");
    assert!(told.contains("different grids") && told.contains("not lined up"), "{told}");
    assert!(!told.contains('{') && !told.contains("Jaccard 0"), "{told}");

    let (csv, drawn) = (folder.path().join("csv"), folder.path().join("drawn"));
    let outputs = ["--json", "--csv", utf8(&csv), "--figures", utf8(&drawn)];
    let told = json(&wisdom(
        &[&["compare", utf8(&made().log("dsmc")), utf8(&other)][..], &outputs].concat(),
    ));
    let held = &told["worlds"][0]["runs"][1]["against_first"];
    for key in ["jaccard", "kendall_tau", "edit_distance", "edits", "first_different_stop"] {
        assert!(held[key].is_null(), "{key}: {}", held[key]);
    }
    assert!(
        told["worlds"][0]["warning"].as_str().expect("a warning").contains("different missions")
    );
    let edits = fs::read_to_string(csv.join("edits.csv")).expect("a table");
    assert_eq!(edits.lines().count(), 1, "{edits}");
    assert!(drawn.join("interest.png").exists() && !drawn.join("difference_other.png").exists());
    // A place of one ground is none of the other.
    let places = |run: usize| list(&told["worlds"][0]["runs"][run]["sequence"]).to_vec();
    assert!(places(0).iter().all(|place| !places(1).contains(place)));
}

#[test]
fn logs_of_older_versions_are_compared_but_not_asked() {
    let [old, new] = ["logs/sample/paper-0.1.0.mcap", "logs/sample/paper-decisions-5.mcap"];
    let told = json(&wisdom(&["compare", old, new, "--json"]));
    let held = &list(&told["worlds"][0]["runs"])[1]["against_first"];
    let why = held["at_states"]["unfit"].as_str().expect("a reason");
    assert!(why.contains("decided by version"), "{why}");
    let facts = list(&held["inputs"]["facts"]);
    assert!(facts.iter().any(|fact| fact["name"] == "decision_version"), "{facts:?}");
}

#[test]
fn a_log_that_is_not_whole_is_compared_and_said_to_be_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = fs::read(made().log("dsmc")).expect("a log");
    let cut = folder.path().join("cut.mcap.part");
    fs::write(&cut, &whole[..whole.len() / 2]).expect("a file");
    let log = LogReader::open(&cut).expect("a log");
    assert!(matches!(log.status, Status::Truncated { .. }));
    let dsmc = made().log("dsmc");
    let args = ["compare", utf8(&dsmc), utf8(&cut), "--json", "--at-states=never"];
    let output = wisdom(&args);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("truncated"), "{}", text(&output.stderr));
    let told = json(&output);
    let held = &told["worlds"][0]["runs"][1]["against_first"];
    assert_eq!(held["decisions_both"], log.decisions().count());
    assert_eq!(held["decisions_apart"], 0);
    assert_eq!(held["divergence"]["by"], Value::Null);
    assert_eq!(held["first_divergent_decision"], log.decisions().count());

    // Whoever reads the tables alone is told so, at each of them.
    let csv = folder.path().join("csv");
    let args =
        ["compare", utf8(&dsmc), utf8(&cut), "--at-states=never", "--quiet", "--csv", utf8(&csv)];
    let tables = text(&wisdom(&args).stdout);
    let footnotes = tables.lines().filter(|line| line.starts_with("* the log ends at "));
    assert_eq!(footnotes.count(), 3, "{tables}");
    assert!(tables.contains(" h, before the run did: counts are of that much"), "{tables}");
    let heads =
        tables.lines().filter(|line| line.starts_with("dsmc (2)* ") || line.contains("cut* "));
    assert!(heads.count() >= 3, "{tables}");
    let runs = fs::read_to_string(csv.join("runs.csv")).expect("a table");
    let rows: Vec<Vec<String>> = runs.lines().map(cells).collect();
    let column = rows[0].iter().position(|name| name == "log_status").expect("a column");
    assert_eq!(rows[1][column], "complete");
    assert!(rows[2][column].starts_with("truncated after byte"), "{runs}");
    assert!(!csv.join("decisions.csv").exists(), "nobody was asked");

    let mut broken = whole.clone();
    let middle = broken.len() / 2;
    broken[middle] ^= 1;
    let bad = folder.path().join("bad.mcap");
    fs::write(&bad, &broken).expect("a file");
    let output = wisdom(&["compare", utf8(&bad), utf8(&made().log("pcr6")), "--at-states=never"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("corrupt"), "{}", text(&output.stderr));
    let tables = text(&output.stdout);
    assert!(tables.contains("* the log is damaged after "), "{tables}");
}

#[test]
fn what_cannot_be_compared_is_refused_by_name() {
    let log = made().log("dsmc");
    let log = utf8(&log);
    let cases: [(&[&str], &str); 7] = [
        (&[log], "one log"),
        (&[log, "missions/paper"], "taken for a mission"),
        (&["missions/paper", "missions/marias-pass"], "one mission is compared"),
        (&[log, log, "--rules", "pcr6"], "--rules"),
        (&[log, log, "--set", "seed=3"], "--set"),
        (&["missions/paper", "--rules", "pcr9"], "pcr9"),
        (&[log, "nowhere.mcap"], "nowhere.mcap"),
    ];
    for (args, word) in cases {
        let output = wisdom(&[&["compare"], args].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", text(&output.stdout));
        assert!(text(&output.stderr).contains(word), "{args:?}: {}", text(&output.stderr));
    }
}

#[test]
fn several_worlds_are_compared_pair_by_pair_and_leave_nothing_behind() {
    let room = tempfile::tempdir().expect("a folder");
    let kept = tempfile::tempdir().expect("a folder");
    let mut args = vec!["compare", "missions/paper", "--rules", "dsmc,pcr6", "--seeds", "1..3"];
    args.extend(SHORT);
    let outputs = kept.path().join("out");
    args.extend(["--json", "--csv", utf8(&outputs), "--figures", utf8(&outputs)]);
    let output = Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(&args)
        .env("TMPDIR", room.path())
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(fs::read_dir(room.path()).expect("a folder").count(), 0, "the logs are removed");
    let told = json(&output);
    let worlds = list(&told["worlds"]);
    assert_eq!(worlds.len(), 3);
    let remarks = text(&output.stderr);
    assert!(remarks.contains("decisions.csv is not written") && remarks.contains("--at-states"));
    assert!(remarks.contains("are of paper, world of seed 1, the first of 3 worlds"), "{remarks}");
    assert!(outputs.join("runs.csv").exists() && !outputs.join("decisions.csv").exists());
    let axis = fs::read_to_string(outputs.join("paired_energy_j.svg")).expect("a chart");
    assert!(axis.contains("energy, MJ: difference") && !axis.contains("energy_j"), "{axis}");
    assert!(worlds.iter().all(|world| world["runs"][1]["against_first"]["at_states"].is_null()));
    for metric in ["goals", "interest_ruler", "distance_m", "energy_j"] {
        let number = |world: &Value, run: usize| {
            let run = &world["runs"][run];
            let count = run[metric].as_array().map(|goals| goals.len() as f64);
            count.or_else(|| run[metric].as_f64()).expect("a number")
        };
        let less: Vec<f64> = worlds.iter().map(|w| number(w, 1) - number(w, 0)).collect();
        let row = list(&told["paired"])
            .iter()
            .find(|row| row["metric"] == metric && row["run"] == "pcr6")
            .expect("a row");
        let interval = &row["less_first"];
        let at = |end: &str| interval[end].as_f64().expect("a number");
        let mean = less.iter().sum::<f64>() / 3.0;
        assert!((at("mean") - mean).abs() <= 1e-9 * mean.abs().max(1.0), "{metric}");
        let least = less.iter().copied().fold(f64::MAX, f64::min);
        let most = less.iter().copied().fold(f64::MIN, f64::max);
        let slack = 1e-9 * least.abs().max(most.abs()).max(1.0);
        assert!(least - slack <= at("low") && at("high") <= most + slack, "{metric}: {row}");
        assert!(at("low") <= at("mean") && at("mean") <= at("high"));
    }
}

#[test]
fn means_over_worlds_are_told_in_the_units_of_a_run_with_the_warning_before_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let logs = folder.path().join("logs");
    let mut args = vec!["compare", "missions/paper", "--rules", "dsmc,pcr6", "--seeds", "1,2"];
    args.extend(["--set", "execution.max-decisions=2", "--logs", utf8(&logs)]);
    let told = text(&wisdom(&args).stdout);
    let lines: Vec<&str> = told.lines().collect();
    let header = lines.iter().position(|line| line.contains("means over 2 worlds")).expect("means");
    assert!(lines[header].contains("too short for so few worlds"), "{told}");
    let energy = lines[header..].iter().find(|line| line.trim().starts_with("energy, MJ"));
    let log = logs.join("paper-seed1-dsmc.mcap");
    let other = logs.join("paper-seed2-dsmc.mcap");
    let one = json(&wisdom(&["compare", utf8(&log), utf8(&other), "--json", "--at-states=never"]));
    let spent =
        |run: usize| one["worlds"][0]["runs"][run]["energy_j"].as_f64().expect("a number") / 1e6;
    let mean = format!("{:.3} [", f64::midpoint(spent(0), spent(1)));
    assert!(energy.expect("a row").contains(&mean), "{mean}: {told}");
    for raw in ["time_s", "energy_j", "distance_m"] {
        assert!(lines[header..].iter().all(|line| !line.contains(raw)), "{raw}: {told}");
    }
    for shown in ["time, h", "distance, m"] {
        assert!(lines[header..].iter().any(|line| line.trim().starts_with(shown)), "{told}");
    }
}
