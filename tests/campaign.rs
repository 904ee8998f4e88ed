//! A campaign as a user runs it: interrupted, run by run, with one thread or two, it ends with the same bytes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;

fn wisdom(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args)
        .output()
        .expect("the command runs")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// Two hours of the paper's scene, with a search cut short: soon over.
const SHORT: [&str; 4] = ["--set", "budget.time-s=7200", "--set", "goals.expansions=1000"];

fn campaign<'a>(folder: &'a Path, seeds: &'a str, more: &[&'a str]) -> Output {
    let mut args = vec!["campaign", "missions/paper", "--seeds", seeds, "--rules", "dsmc,pcr6"];
    args.extend(["--json", "-o", text(folder)]);
    args.extend(SHORT);
    args.extend(more);
    wisdom(&args)
}

fn told(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", errors(output));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// All that a campaign's folder says of its runs: every file but wall times.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for part in [folder.to_path_buf(), folder.join("runs")] {
        for entry in std::fs::read_dir(part).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                let name = path.strip_prefix(folder).expect("it lies in it").to_path_buf();
                files.insert(name, std::fs::read(&path).expect("a file"));
            }
        }
    }
    files
}

/// One whole campaign of four runs, made once; it lies with what the build leaves behind, as nobody clears it away.
static WHOLE: LazyLock<(PathBuf, Value)> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("whole-campaign");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).expect("that of the last time is ours");
    }
    let said = told(&campaign(&folder, "1..2", &["--jobs", "2"]));
    (folder, said)
});

/// A copy of the whole campaign.
fn copy() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    copy_into(&WHOLE.0, folder.path());
    folder
}

fn copy_into(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let to = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_into(&path, &to);
        } else {
            std::fs::copy(&path, &to).expect("a copy");
        }
    }
}

#[test]
fn a_campaign_leaves_a_table_that_reads_back_and_a_summary_of_it() {
    let (folder, said) = &*WHOLE;
    assert_eq!(said["computed"], 4);
    assert!(said["missions_per_minute"].as_f64().is_some_and(|rate| rate > 0.0));
    let summary: Value =
        serde_json::from_slice(&std::fs::read(folder.join("summary.json")).expect("a summary"))
            .expect("JSON");
    assert_eq!(summary, said["summary"]);

    let mut table = csv::Reader::from_path(folder.join("runs.csv")).expect("a table");
    let header = table.headers().expect("a header").clone();
    let rows: Vec<BTreeMap<String, String>> = table
        .records()
        .map(|row| {
            let row = row.expect("a row");
            header.iter().map(str::to_owned).zip(row.iter().map(str::to_owned)).collect()
        })
        .collect();
    assert_eq!(rows.len(), 4);
    let order: Vec<(&str, &str)> =
        rows.iter().map(|row| (row["seed"].as_str(), row["rule"].as_str())).collect();
    assert_eq!(order, [("1", "dsmc"), ("1", "pcr6"), ("2", "dsmc"), ("2", "pcr6")]);
    let number = |row: &BTreeMap<String, String>, name: &str| row[name].parse::<f64>();
    for (index, row) in rows.iter().enumerate() {
        let file = folder.join(format!("runs/{index:06}.json"));
        let kept: Value =
            serde_json::from_slice(&std::fs::read(file).expect("a row")).expect("JSON");
        let run = &kept["result"]["finished"];
        for name in ["distance_m", "time_s", "energy_j", "data_mb", "reliability"] {
            assert_eq!(number(row, name).ok(), run[name].as_f64(), "{name}: to the last bit");
        }
        assert_eq!(row["goals"].parse().ok(), run["goals"].as_array().map(Vec::len));
        assert_eq!(row["status"], run["status"].as_str().expect("a status"));
        assert_eq!(row["error"], "");
    }

    // The summary's paired difference is that of the table.
    let distance: Vec<f64> =
        rows.iter().map(|row| number(row, "distance_m").expect("a number")).collect();
    let difference = f64::midpoint(distance[1] - distance[0], distance[3] - distance[2]);
    let stated = &summary["variants"][1]["less_first"]["distance_m"];
    let mean = stated["mean"].as_f64().expect("a mean");
    assert!((mean - difference).abs() < 1e-9 * distance[0], "{mean} {difference}");

    let mut legs = csv::Reader::from_path(folder.join("legs.csv")).expect("a table");
    let ended = legs.records().filter(|leg| !leg.as_ref().expect("a leg")[3].is_empty()).count();
    let stated: f64 = rows.iter().map(|row| number(row, "legs_ended").expect("a number")).sum();
    assert!(ended > 0);
    assert_eq!(ended as f64, stated);
}

#[test]
fn a_broken_off_campaign_goes_on_to_the_same_bytes_and_names_what_is_spoiled() {
    let folder = copy();
    let runs = folder.path().join("runs");
    let before = results(folder.path());
    std::fs::remove_file(runs.join("000001.json")).expect("it was there");
    let cut = runs.join("000002.json");
    let bytes = std::fs::read(&cut).expect("a row");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("half a row");
    std::fs::remove_file(folder.path().join("runs.csv")).expect("it was there");

    let output = campaign(folder.path(), "1..2", &[]);
    assert_eq!(told(&output)["computed"], 2, "the others are left alone");
    let remarks = errors(&output);
    assert!(remarks.contains("000002.json") && remarks.contains("again"), "{remarks}");
    assert_eq!(results(folder.path()), before);
    assert_eq!(told(&campaign(folder.path(), "1..2", &[]))["computed"], 0);
}

#[test]
fn an_edited_row_is_named_and_computed_again() {
    let folder = copy();
    let before = results(folder.path());
    let row = folder.path().join("runs/000001.json");
    let text = std::fs::read_to_string(&row).expect("a row");
    let start = text.find("\"distance_m\":").expect("its distance") + "\"distance_m\":".len();
    let end = start + text[start..].find(',').expect("more behind it");
    // A number as this program writes it, in a file that is otherwise as it was.
    std::fs::write(&row, format!("{}1.5{}", &text[..start], &text[end..])).expect("it can be");

    let output = wisdom(&["campaign", "gather", self::text(folder.path()), "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    let said: Value = serde_json::from_slice(&output.stdout).expect("JSON although quiet");
    assert_eq!((&said["summary"]["finished"], &said["summary"]["missing"]), (&3.into(), &1.into()));
    let output = campaign(folder.path(), "1..2", &[]);
    assert_eq!(told(&output)["computed"], 1);
    let remarks = errors(&output);
    assert!(remarks.contains("000001.json") && remarks.contains("edited"), "{remarks}");
    assert!(remarks.contains("run 1 has to be computed again"), "{remarks}");
    assert_eq!(results(folder.path()), before);
}

#[test]
fn what_a_killed_process_left_of_a_row_is_cleared_away() {
    let folder = copy();
    let part = folder.path().join("runs/.000001.json.4711-0.part");
    std::fs::write(&part, "{\"version\":").expect("a part");
    assert_eq!(told(&campaign(folder.path(), "1..2", &[]))["computed"], 0);
    assert!(!part.exists());
    assert_eq!(results(folder.path()), results(&WHOLE.0));
}

#[test]
fn a_reliability_diagram_is_drawn_for_each_rule() {
    for (name, is_there) in
        [("reliability_dsmc", true), ("reliability_pcr6", true), ("reliability", false)]
    {
        for kind in ["svg", "png"] {
            assert_eq!(WHOLE.0.join(format!("{name}.{kind}")).exists(), is_there, "{name}.{kind}");
        }
    }
    let drawn = std::fs::read_to_string(WHOLE.0.join("reliability_pcr6.svg")).expect("a plot");
    assert!(drawn.contains("Brier score") && drawn.contains("Wilson"), "{drawn}");
}

#[test]
fn one_world_has_means_and_no_intervals() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = told(&campaign(folder.path(), "1", &[]));
    let goals = &said["summary"]["variants"][0]["means"]["goals"];
    assert!(goals["mean"].is_number() && goals["low"].is_null() && goals["high"].is_null());
    let output = wisdom(&["campaign", "gather", text(folder.path())]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("means over 1 world,") && told.contains(" [-]"), "{told}");
    assert!(told.contains("time, s") && told.contains("energy, J"), "{told}");
}

#[test]
fn runs_done_one_by_one_in_any_order_make_the_same_campaign() {
    let folder = tempfile::tempdir().expect("a folder");
    let prepared = told(&campaign(folder.path(), "1..2", &["--prepare", "--quiet"]));
    assert_eq!(prepared["runs"], 4, "JSON although quiet");
    let one = |index: &str| {
        wisdom(&["campaign", "run-one", text(folder.path()), "--index", index, "--json"])
    };
    let gather = |code: i32| {
        let output = wisdom(&["campaign", "gather", text(folder.path()), "--quiet"]);
        assert_eq!(output.status.code(), Some(code), "{}", errors(&output));
        errors(&output)
    };
    assert_eq!(told(&one("3"))["computed"], true);
    let remarks = gather(3);
    assert!(remarks.contains("3 of 4 runs are still to be done"), "{remarks}");
    for index in ["0", "2", "1"] {
        assert_eq!(told(&one(index))["computed"], true);
    }
    let row = folder.path().join("runs/000002.json");
    let made = row.metadata().and_then(|file| file.modified()).expect("a time");
    assert_eq!(told(&one("2"))["computed"], false, "a finished run is left alone");
    assert_eq!(row.metadata().and_then(|file| file.modified()).expect("a time"), made);
    gather(0);
    assert_eq!(results(folder.path()), results(&WHOLE.0));

    let output = one("4");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("4 runs, 0 to 3"), "{}", errors(&output));
}

#[test]
fn one_job_makes_the_same_bytes_as_two_and_seeds_can_be_added_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = told(&campaign(folder.path(), "1", &["--jobs", "1"]));
    assert_eq!(first["computed"], 2);
    let second = told(&campaign(folder.path(), "1..2", &["--jobs", "1"]));
    assert_eq!(second["computed"], 2, "only the new seed is run");
    assert_eq!(results(folder.path()), results(&WHOLE.0));
}

#[test]
fn a_folder_of_another_campaign_is_refused_with_the_difference() {
    let folder = copy();
    let before = results(folder.path());
    let refused = |seeds: &str, more: &[&str], wanted: &str| {
        let output = campaign(folder.path(), seeds, more);
        let errors = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains("another campaign") && errors.contains(wanted), "{errors}");
        assert!(
            errors.contains("; give ") && errors.contains("another folder with -o"),
            "{errors}"
        );
    };
    refused("2..3", &[], "its seed number 1 is 1, and the call's 2");
    refused("1", &[], "it has 2 seeds, and the call names the first 1");
    refused("1..2", &["--set", "budget.energy-j=1e6"], "budget.energy-j=1e6");
    refused(
        "1..2",
        &["--rules", "yager"],
        "its rules are dsmc,pcr6, and the call's dsmc,pcr6,yager",
    );
    refused("1..2", &["--policies", "expected-interest"], "its policies are most-interesting");
    // What the call leaves out is the mission's.
    let mut args = vec!["campaign", "missions/paper", "--seeds", "1..2", "-o", text(folder.path())];
    args.extend(SHORT);
    let output = wisdom(&args);
    assert_eq!(output.status.code(), Some(2));
    let told = errors(&output);
    assert!(
        told.contains("its rules are dsmc,pcr6, and the mission's dsmc; give the same"),
        "{told}"
    );
    assert_eq!(results(folder.path()), before, "nothing was touched");

    // A mission changed behind the campaign's back.
    let file = folder.path().join("mission/mission.toml");
    let changed = std::fs::read_to_string(&file).expect("a mission") + "\n# changed\n";
    std::fs::write(&file, changed).expect("it can be changed");
    std::fs::remove_file(folder.path().join("runs/000000.json")).expect("it was there");
    let output = wisdom(&["campaign", "run-one", text(folder.path()), "--index", "0"]);
    assert_eq!(output.status.code(), Some(2));
    let told = errors(&output);
    assert!(told.contains("mission/ was changed since the campaign was made (digest"), "{told}");
    assert!(told.contains("put it back, or start anew with another -o"), "{told}");
    assert!(!folder.path().join("runs/000000.json").exists());
}

#[test]
fn results_of_another_version_of_the_program_are_not_mixed_with_ours() {
    let folder = copy();
    let manifest = folder.path().join("campaign.toml");
    let text_now = std::fs::read_to_string(&manifest).expect("a manifest");
    let (mine, older) = (env!("CARGO_PKG_VERSION"), "0.0.9");
    let was = text_now.replace(&format!("product = \"{mine}\""), &format!("product = \"{older}\""));
    assert_ne!(was, text_now);
    std::fs::write(&manifest, was).expect("it can be changed");
    std::fs::remove_file(folder.path().join("runs/000000.json")).expect("it was there");
    let wanted = format!("it was made by wisdom {older}, this is {mine}; results are not mixed");
    let one = wisdom(&["campaign", "run-one", text(folder.path()), "--index", "0"]);
    for output in [campaign(folder.path(), "1..2", &[]), campaign(folder.path(), "1..3", &[]), one]
    {
        assert_eq!(output.status.code(), Some(2));
        assert!(errors(&output).contains(&wanted), "{}", errors(&output));
    }
    assert!(!folder.path().join("runs/000000.json").exists());
    let output = wisdom(&["campaign", "gather", text(folder.path()), "--quiet"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(errors(&output).contains(&wanted), "{}", errors(&output));
}

#[test]
fn mistakes_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("new");
    let refused = |args: &[&str], wanted: &str| {
        let mut all = vec!["campaign", "missions/paper", "-o", text(&target)];
        all.extend(args);
        let output = wisdom(&all);
        let errors = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(wanted), "{args:?}: {errors}");
        assert!(!target.exists(), "{args:?}");
    };
    refused(&[], "--seeds");
    refused(&["--seeds", "5..1"], "5 is larger than 1");
    refused(&["--seeds", "1..10001"], "at most 10000");
    refused(&["--seeds", "1..3,2"], "seed 2 is given twice");
    refused(&["--seeds", "9223372036854775808"], "expected at most");
    refused(&["--seeds", "1", "--rules", "pcr9"], "--rules: unknown rule `pcr9`");
    // Known, but not on maps: the mission refuses it.
    refused(&["--seeds", "1", "--rules", "dsmc,bold"], "bold");
    refused(&["--seeds", "1", "--policies", "laziest"], "--policies: `laziest`");
    // What the campaign varies has an option of its own, given or not.
    let ruled = "--set rule=pcr6: a campaign's rules are given with --rules";
    refused(&["--seeds", "1", "--set", "rule=pcr6"], ruled);
    refused(&["--seeds", "1", "--rules", "dsmc", "--set", "rule=pcr6"], ruled);
    refused(&["--seeds", "1", "--set", "seed=3"], "seeds are given with --seeds");
    refused(&["--seeds", "1", "--set", "policy=\"x\""], "policies are given with --policies");
    refused(&["--seeds", "1", "--jobs", "0"], "--jobs 0");
    if !cfg!(feature = "parquet") {
        refused(&["--seeds", "1", "--parquet"], "--features parquet");
    }

    let output = wisdom(&["campaign", "missions/nope", "--seeds", "1", "-o", text(&target)]);
    assert_eq!(output.status.code(), Some(2));
    let told = errors(&output);
    assert!(told.contains("missions/nope") && told.contains("mission.toml is expected"), "{told}");
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").expect("a file");
    let output = campaign(&file, "1", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("is a file; a folder is expected"), "{}", errors(&output));
    assert_eq!(std::fs::read(&file).expect("it is there"), b"mine");

    // A folder that holds something else is left as it is.
    let mine = folder.path().join("mine");
    std::fs::create_dir(&mine).expect("a folder");
    std::fs::write(mine.join("thesis.txt"), "years of work").expect("a file");
    let output = campaign(&mine, "1", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("thesis.txt"), "{}", errors(&output));
    assert_eq!(std::fs::read_dir(&mine).expect("a folder").count(), 1);
    for args in [["run-one", "--index", "0"].as_slice(), ["gather"].as_slice()] {
        let mut all = vec!["campaign", args[0], text(&mine)];
        all.extend(&args[1..]);
        let output = wisdom(&all);
        assert_eq!(output.status.code(), Some(2));
        assert!(errors(&output).contains("no campaign's folder"), "{}", errors(&output));
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_what_is_finished_and_the_same_call_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("campaign");
    let mut args = vec!["campaign", "missions/paper", "--seeds", "1..40", "--rules", "dsmc"];
    args.extend(["--jobs", "1", "-o", text(&place)]);
    args.extend(SHORT);
    let child = Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(&args)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the command runs");
    let first = place.join("runs/000000.json");
    for _ in 0..60_000 {
        if first.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(first.exists(), "no run within ten minutes");
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.is_ok_and(|status| status.success()));
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    let remarks = errors(&output);
    assert!(remarks.contains("still to be done") && remarks.contains("goes on"), "{remarks}");
    let files: Vec<PathBuf> = std::fs::read_dir(place.join("runs"))
        .expect("rows")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    assert!(!files.is_empty() && files.len() < 40);
    for file in &files {
        let bytes = std::fs::read(file).expect("a row");
        let row: Value = serde_json::from_slice(&bytes).expect("whole rows only");
        assert!(row["result"]["finished"].is_object(), "{row}");
    }
    let lines = std::fs::read_to_string(place.join("runs.csv")).expect("a table");
    assert_eq!(lines.lines().count(), files.len() + 1, "a header and a line a run");
}

#[test]
fn a_mission_with_files_outside_its_folder_is_read_where_it_was_and_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let mission = folder.path().join("scene");
    copy_into(&Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper"), &mission);
    let landscape = folder.path().join("landscape.toml");
    std::fs::rename(mission.join("landscape.toml"), &landscape).expect("it can be moved");
    let place = folder.path().join("campaign");
    let mut args =
        vec!["campaign", text(&mission), "--seeds", "1", "-o", text(&place), "--prepare"];
    args.extend(["--set", "terrain.landscape=../landscape.toml"]);
    args.extend(SHORT);
    let output = wisdom(&args);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert!(!place.join("mission").exists(), "nothing is written outside the campaign's folder");

    let one = ["campaign", "run-one", text(&place), "--index", "0", "--json"];
    let row = &told(&wisdom(&one))["row"]["result"]["finished"];
    // The same files elsewhere are the same world.
    let whole = std::fs::read(WHOLE.0.join("runs/000000.json")).expect("a row");
    let whole: Value = serde_json::from_slice(&whole).expect("JSON");
    assert_eq!(row, &whole["result"]["finished"]);

    std::fs::remove_file(place.join("runs/000000.json")).expect("it was there");
    let changed = std::fs::read_to_string(&landscape).expect("a landscape") + "\n# changed\n";
    std::fs::write(&landscape, changed).expect("it can be changed");
    let output = wisdom(&one);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("was changed since"), "{}", errors(&output));
}

#[cfg(feature = "parquet")]
#[test]
fn the_parquet_table_holds_what_the_csv_table_holds() {
    use parquet::file::reader::{FileReader, SerializedFileReader};

    let folder = copy();
    let output = wisdom(&["campaign", "gather", text(folder.path()), "--parquet", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let file = std::fs::File::open(folder.path().join("runs.parquet")).expect("a table");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let mut table = csv::Reader::from_path(folder.path().join("runs.csv")).expect("a table");
    let header = table.headers().expect("a header").clone();
    let lines: Vec<csv::StringRecord> = table.records().map(|row| row.expect("a row")).collect();
    let rows = reader.get_row_iter(None).expect("rows");
    let mut read = 0;
    for (row, line) in rows.zip(&lines) {
        let row = row.expect("a row");
        for ((name, value), (column, stated)) in row.get_column_iter().zip(header.iter().zip(line))
        {
            use parquet::record::Field;
            assert_eq!(name, column);
            let same = match value {
                Field::Long(n) => n.to_string() == stated,
                Field::Double(x) => stated.parse() == Ok(*x),
                Field::Str(text) => text == stated,
                Field::Null => stated.is_empty(),
                other => panic!("{name}: {other:?}"),
            };
            assert!(same, "{name}: {value:?} and {stated}");
        }
        read += 1;
    }
    assert_eq!(read, 4);
}

#[test]
fn a_folder_left_half_made_is_finished_by_the_same_call() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("c");
    let call = || told(&campaign(&place, "1..2", &["--prepare"]));
    call();
    let manifest = std::fs::read(place.join("campaign.toml")).expect("a manifest");
    // Killed before the mission was copied, and before the manifest was.
    std::fs::remove_dir_all(place.join("mission")).expect("it was there");
    call();
    assert!(place.join("mission/mission.toml").exists());
    std::fs::remove_dir_all(&place).expect("it was there");
    std::fs::create_dir(&place).expect("a folder");
    std::fs::write(place.join(".campaign.toml.77-0.part"), &manifest[..40]).expect("half of it");
    call();
    assert_eq!(std::fs::read(place.join("campaign.toml")).expect("a manifest"), manifest);
    // A folder of somebody's own stays as it is.
    let own = folder.path().join("own");
    std::fs::create_dir_all(own.join("mission")).expect("a folder");
    let refused = campaign(&own, "1", &["--prepare"]);
    assert_eq!(refused.status.code(), Some(2));
}
