//! `wisdom paper`, as a reader of the paper runs it.

use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
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

/// Draws the figures into a new folder of `folder`; their paths.
fn figures(folder: &Path) -> Vec<PathBuf> {
    let target = folder.join("new").join("figures");
    let output = paper(&["--json", "--figures", target.to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let object: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let told = object["figures"].as_array().expect("figures");
    told.iter().map(|path| PathBuf::from(path.as_str().expect("a path"))).collect()
}

/// Width, height and pixels of a picture.
fn picture(path: &Path) -> (usize, usize, Vec<[u8; 3]>) {
    let file = BufReader::new(fs::File::open(path).expect("the picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut bytes).expect("pixels");
    assert_eq!(frame.color_type, png::ColorType::Rgb, "{}", path.display());
    let pixels = bytes.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
    (frame.width as usize, frame.height as usize, pixels)
}

#[test]
fn the_figures_are_pictures_of_the_whole_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let told = figures(folder.path());
    for figure in ["3-visibility-map", "4", "5", "6", "7", "8a", "8b", "9"] {
        let (width, height, _) = picture(named(&told, figure));
        // At least eight pixels a cell.
        assert!(width >= 808 && height >= 808, "figure {figure}: {width} x {height}");
    }
    for figure in ["2", "3-visibility.", "10"] {
        let (width, height, pixels) = picture(named(&told, figure));
        assert!(width >= 900 && height >= 700, "figure {figure}: {width} x {height}");
        let white = pixels.iter().filter(|pixel| **pixel == [255; 3]).count();
        assert!(white < pixels.len() * 7 / 10, "figure {figure} is nearly empty");
    }
    assert_eq!(told.len(), 11);
}

/// The one picture whose name begins so after "figure-".
fn named<'p>(told: &'p [PathBuf], figure: &str) -> &'p Path {
    let start = format!("figure-{figure}");
    let mut found = told.iter().filter(|path| {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
        name.starts_with(&start) && (figure.contains('-') || name[start.len()..].starts_with('-'))
    });
    let path = found.next().unwrap_or_else(|| panic!("no {start}"));
    assert!(found.next().is_none(), "more than one {start}");
    path
}

/// "In dark grey, surfaces that are not in sight" (Fig. 3): greys of the ground are either dark or light, and the share
/// of the dark ones is about that of the hidden cells.
#[test]
fn fig_3_shows_hidden_ground_in_dark_grey() {
    let folder = tempfile::tempdir().expect("a folder");
    let told = figures(folder.path());
    let (_, _, pixels) = picture(named(&told, "3-visibility."));
    let grey = |low: u8, high: u8| {
        let within = |p: &&[u8; 3]| p[0] == p[1] && p[1] == p[2] && (low..=high).contains(&p[0]);
        pixels.iter().filter(within).count() as f64
    };
    let (dark, between, light) = (grey(28, 90), grey(91, 117), grey(118, 254));
    let share = dark / (dark + between + light);
    let hidden = computed(&rows(&paper(&["--json"])), "Figs. 3 and 4", "share of cells hidden");
    assert!((share - hidden).abs() < 0.06, "{share} of the ground is dark, {hidden} hidden");
    assert!(between < 0.02 * (dark + light), "{between} pixels are neither dark nor light");
}

#[test]
fn the_figures_are_the_same_bytes_twice() {
    let (one, other) =
        (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let bytes = |folder: &Path| -> Vec<Vec<u8>> {
        figures(folder).iter().map(|path| fs::read(path).expect("the picture")).collect()
    };
    assert!(bytes(one.path()) == bytes(other.path()), "a figure differs from itself");
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
