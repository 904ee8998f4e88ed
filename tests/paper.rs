//! `wisdom paper`, as a reader of the paper runs it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn paper(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wisdom"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .arg("paper")
        .args(args)
        .output()
        .expect("the command runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn rows(output: &Output) -> Vec<Value> {
    let object: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    object["rows"].as_array().expect("rows").clone()
}

/// The computed number of a row, by its group and name.
fn computed(rows: &[Value], group: &str, name: &str) -> f64 {
    let row = rows.iter().find(|row| row["group"] == group && row["name"] == name);
    row.unwrap_or_else(|| panic!("no row `{group}` / `{name}`"))["computed"]
        .as_f64()
        .expect("a number")
}

fn assert_near(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "{found}, not {wanted} within {within}");
}

/// A copy of the paper's mission, with one change to one file.
fn copy(file: &str, from: &str, to: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper");
    fs::create_dir(folder.path().join("experts")).expect("a folder of experts");
    for part in ["", "experts"] {
        for entry in fs::read_dir(source.join(part)).expect("the mission") {
            let entry = entry.expect("an entry");
            if entry.path().is_file() {
                let copy = folder.path().join(part).join(entry.file_name());
                fs::copy(entry.path(), copy).expect("a copy");
            }
        }
    }
    let path = folder.path().join(file);
    let text = fs::read_to_string(&path).expect("the file to change");
    let changed = text.replacen(from, to, 1);
    assert_ne!(text, changed, "`{from}` stands in {file}");
    fs::write(path, changed).expect("the change");
    folder
}

#[test]
fn every_printed_number_and_claim_of_the_paper_is_reproduced() {
    let output = paper(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let object: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let rows = rows(&output);
    let judged = rows.iter().filter(|row| !row["pass"].is_null()).count();
    assert_eq!(object["checks"], judged);
    assert_eq!(object["failed"], 0);
    assert!(judged > 100, "only {judged} checks");
    for row in rows.iter().filter(|row| row["pass"] != true) {
        assert!(row["pass"].is_null() && row["must_be"] == "anything", "{row}");
    }
}

#[test]
fn the_key_numbers_are_those_of_the_paper() {
    let rows = rows(&paper(&["--json"]));
    let of = |group, name| computed(&rows, group, name);
    assert_near(of("Table 5, DST", "Bel(I)"), 0.4975, 5e-5);
    assert_near(of("Table 5, DSmT", "m(I ∩ NI)"), 0.9801, 1e-12);
    assert_near(of("Table 5, DSmT", "Bel(I)"), 0.99, 1e-12);
    assert_near(of("Table 6", "texture: m(I)"), 0.323, 1e-12);
    assert_near(of("Table 7", "m(I ∩ NI)"), 0.822_93, 1e-12);
    assert_near(of("Table 7", "Bel(I)"), 0.972_346, 1e-12);
    assert_near(of("Table 8", "temperature: m(I ∪ NI)"), 0.352, 1e-12);
    assert_near(of("Table 9", "m(I)"), 0.6881, 5e-5);
    assert_near(of("Fig. 9 at (67, 20)", "Bel(I)"), 0.972_346, 1e-6);
    let eq_8 = "gradient and texture: m'12(X) = m12(I ∩ NI)";
    assert_near(of("Eqs. 8 and 9", eq_8), 0.1806, 1e-12);
}

/// What the paper says of Table 8's choice, and what is so.
#[test]
fn where_the_paradox_goes_changes_dempsters_belief_by_more_than_a_tenth() {
    let rows = rows(&paper(&["--json"]));
    let interest = |policy: &str| computed(&rows, "Table 8's choice", &format!("{policy}: m(I)"));
    assert_near(interest("to-ignorance"), 0.6881, 5e-5);
    assert_near(interest("split"), 0.7538, 5e-5);
    assert_near(interest("renormalise"), 0.8438, 5e-5);
}

#[test]
fn the_tables_end_with_the_count_of_checks() {
    let output = paper(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    let last = told.lines().last().expect("a last line");
    let count = last.strip_suffix(" checks, 0 failed").expect("the count");
    assert_eq!(count.parse::<usize>().ok(), Some(told.matches("  pass\n").count()), "{last}");
    assert!(told.contains("0.97234600") && told.contains("0.97234607"), "{told}");
}

#[test]
fn the_figures_are_pictures_of_the_whole_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("new").join("figures");
    let output = paper(&["--json", "--figures", target.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let object: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let told = object["figures"].as_array().expect("figures");
    for figure in ["3", "4", "5", "6", "7", "8a", "8b", "9"] {
        let start = format!("figure-{figure}-");
        let named = |path: &&Value| path.as_str().is_some_and(|path| path.contains(&start));
        let path = told.iter().find(named).unwrap_or_else(|| panic!("no {start}"));
        let bytes = fs::read(path.as_str().expect("a path")).expect("the picture");
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n", "{path}");
        // Width and height stand in the header: at least eight pixels a cell.
        let side =
            |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
        assert!(side(16) >= 808 && side(20) >= 808, "{path}: {} x {}", side(16), side(20));
    }
    assert_eq!(told.len(), 8);
}

#[test]
fn a_spoiled_table_fails_the_checks_that_rest_on_it_and_no_other() {
    // Table 1, [5, 7): the first 0.80 after a band that starts at 5.
    let from = "from = 5.0\nto = 7.0\nparadox = 0.15\nnot-interesting = 0.05\ninteresting = 0.80";
    let to = "from = 5.0\nto = 7.0\nparadox = 0.15\nnot-interesting = 0.05\ninteresting = 0.70";
    let folder = copy("experts/dem.toml", from, to);
    let mission = folder.path().to_str().expect("UTF-8");

    let output = paper(&["--mission", mission]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    let failed: Vec<&str> = told.lines().filter(|line| line.starts_with("failed  ")).collect();
    let names = |group: &str, name: &str| {
        failed.iter().any(|line| line.contains(group) && line.ends_with(&format!(" / {name}")))
    };
    assert!(names("Tables 1 to 3", "Table 1, [5, 7)"), "{failed:?}");
    assert!(names("Table 6", "gradient: m(I)"), "{failed:?}");
    assert!(names("Table 7", "Bel(I)"), "{failed:?}");
    assert!(names("Table 9", "m(I)"), "{failed:?}");
    assert!(names("Fig. 9 at (67, 20)", "Bel(I)"), "{failed:?}");
    assert!(
        !names("Table 6", "texture: m(I)") && !failed.iter().any(|line| line.contains("Table 5"))
    );
    let last = told.lines().last().expect("a last line");
    assert!(last.ends_with(&format!(" checks, {} failed", failed.len())), "{last}");

    let json = paper(&["--json", "--mission", mission]);
    assert_eq!(json.status.code(), Some(1));
    let wrong = rows(&json).iter().filter(|row| row["pass"] == false).count();
    assert_eq!(wrong, failed.len());
}

/// The equations hold for any masses, so that a spoiled table leaves them alone; a claim on the map does not.
#[test]
fn a_scene_without_its_hot_disc_fails_areas_l_and_m() {
    let folder = copy("landscape.toml", "peak = 88.0", "peak = 4.0");
    let output = paper(&["--json", "--mission", folder.path().to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let rows = rows(&output);
    let fails = |group: &str| rows.iter().any(|row| row["group"] == group && row["pass"] == false);
    assert!(fails("Fig. 9, L") && fails("Fig. 9, M"));
    assert!(!fails("Eq. 7") && !fails("Eqs. 8 and 9") && !fails("Table 7"));
    // No cell of the rock's border is hot: a mean of no cells is no number, and does not pass.
    let mean = rows.iter().find(|row| row["group"] == "Fig. 9, M" && row["name"] == "mean Bel(I)");
    let mean = mean.expect("the mean of area M");
    assert!(mean["computed"].is_null() && mean["pass"] == false, "{mean}");
}

#[test]
fn bad_input_exits_with_2_and_says_what_is_wrong() {
    let told = |args: &[&str]| {
        let output = paper(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", text(&output.stderr));
        text(&output.stderr)
    };
    let missing = told(&["--mission", "missions/no-such-mission"]);
    assert!(missing.contains("no-such-mission"), "{missing}");
    let other = told(&["--mission", "missions/marias-pass"]);
    assert!(other.contains("expected.toml"), "{other}");
    for (from, to, what) in [
        ("at = [67, 20]", "at = [67, 0]", "(67, 0)"),
        ("rock = \"C\"", "rock = \"Z\"", "`Z`"),
        ("texture_uncertainty = 0.66", "texture_uncertainty = 66", "66"),
        ("core = 8.0", "corr = 8.0", "corr"),
    ] {
        let folder = copy("expected.toml", from, to);
        let error = told(&["--mission", folder.path().to_str().expect("UTF-8")]);
        assert!(error.contains("expected.toml:") && error.contains(what), "{error}");
    }
}
