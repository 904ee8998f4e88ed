//! What is wrong with a mission's files is said: where (file, line, column, key), what is there, what would be right.

mod small;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;
use wisdom_belief::Rule;
use wisdom_mission::{MISSION_FILE, Mission, MissionError, Override};

type Files = BTreeMap<String, Vec<u8>>;

static PAPER: LazyLock<Files> = LazyLock::new(|| load("paper", &[]).expect("it ships").files);

fn load(name: &str, overrides: &[(&str, &str)]) -> Result<Mission, MissionError> {
    let overrides: Vec<Override> =
        overrides.iter().map(|(key, value)| Override::new(*key, *value)).collect();
    Mission::load(&small::shipped(name), &overrides)
}

fn text<'a>(files: &'a Files, file: &str) -> &'a str {
    std::str::from_utf8(&files[file]).expect("it is text")
}

/// Line and column, from 1, of the first occurrence of a piece of text.
fn place_of(text: &str, piece: &str) -> (usize, usize) {
    let at = text.find(piece).unwrap_or_else(|| panic!("`{piece}` is not in the file"));
    let line_start = text[..at].rfind('\n').map_or(0, |i| i + 1);
    (text[..at].matches('\n').count() + 1, text[line_start..at].chars().count() + 1)
}

/// Replaces `from` by `to` in one of the paper's files and checks that the error stands at `at` (a piece of the
/// changed file), shows that place and a caret, and says all of `words`.
fn check(file: &str, (from, to): (&str, &str), at: &str, words: &[&str]) {
    check_in(&PAPER, file, (from, to), at, words);
}

fn check_in(files: &Files, file: &str, (from, to): (&str, &str), at: &str, words: &[&str]) {
    let mut files = files.clone();
    let before = text(&files, file);
    assert!(before.contains(from), "`{from}` is not in {file}");
    let after = before.replacen(from, to, 1);
    files.insert(file.to_owned(), after.clone().into_bytes());
    let error = Mission::from_files(&files).expect_err("the change is a mistake");
    let shown = error.to_string();
    assert_eq!(error.file, file, "{shown}");
    let (line, column) = place_of(&after, at);
    assert_eq!(error.place, Some((line, column)), "{shown}");
    assert!(shown.contains(&format!("{file}:{line}:{column}")) && shown.contains('^'), "{shown}");
    for word in words {
        assert!(shown.contains(word), "`{word}` is not said:\n{shown}");
    }
}

#[test]
fn unknown_keys_are_errors_on_every_level() {
    let m = MISSION_FILE;
    check(m, ("seed = 1", "sed = 1"), "sed = 1", &["unknown field `sed`", "seed"]);
    check(m, ("look-every-m", "look-evry-m"), "look-evry-m", &["look-evry-m", "look-every-m"]);
    check(m, ("slope-max-deg", "slope-max"), "slope-max ", &["`slope-max`", "slope-max-deg"]);
    check(m, ("standoff-m", "stand-off"), "stand-off", &["`stand-off`", "standoff-m"]);
    check(m, ("{ sight = 0.2 }", "{ sigth = 0.2 }"), "sigth", &["sigth", "sight"]);
    check("experts/dem.toml", ("paradox", "pardox"), "pardox", &["`pardox`", "paradox"]);
    check("landscape.toml", ("rise_east", "rise_west"), "rise_west", &["rise_west", "rise_east"]);
}

#[test]
fn a_missing_key_names_the_table_that_lacks_it() {
    let at = "[[directive]]";
    check(MISSION_FILE, ("standoff-m = 5.0\n", ""), at, &["missing field `standoff-m`"]);
    check(MISSION_FILE, ("rows = 101\n", ""), "[terrain]", &["`rows` and `cols`"]);
    check("experts/texture.toml", ("value = 1\n", ""), "[[class]]", &["missing field `value`"]);
}

#[test]
fn wrong_types_show_the_value_and_what_was_expected() {
    let m = MISSION_FILE;
    check(m, ("rows = 101", "rows = \"x\""), "\"x\"", &["rows", "string \"x\"", "usize"]);
    check(m, ("seed = 1", "seed = -4"), "-4", &["seed", "-4", "u64"]);
    check(m, ("experts = [\"e", "experts = [7, \"e"), "7, ", &["experts", "7", "string"]);
    check(m, ("kind = \"class\"", "kind = \"clas\""), "\"clas\"", &["`clas`", "`class`"]);
    check("experts/dem.toml", ("to = 1.0", "to = \"a\""), "\"a\"", &["to", "\"a\"", "f64"]);
    check("landscape.toml", ("octaves = 4", "octaves = 99"), "99", &["octaves", "99", "16"]);
}

#[test]
fn text_that_is_no_toml_is_shown_where_it_breaks() {
    check(MISSION_FILE, ("rows = 101", "rows = = 3"), "= 3", &["rows = = 3"]);
    let mut files = PAPER.clone();
    for file in [MISSION_FILE, "experts/dem.toml", "landscape.toml"] {
        let mut broken = files.clone();
        let bytes = broken.get_mut(file).expect("the mission has it");
        let second_line = bytes.iter().position(|b| *b == b'\n').expect("it has lines") + 1;
        bytes[second_line] = 0xff;
        let error = Mission::from_files(&broken).expect_err("it is no text");
        assert_eq!((error.file.as_str(), error.place), (file, Some((2, 1))));
        assert!(error.message.contains("0xff") && error.message.contains("UTF-8"), "{error}");
    }
    files.clear();
    let error = Mission::from_files(&files).expect_err("there is no file at all");
    assert_eq!(error.file, MISSION_FILE);
}

#[test]
fn names_that_are_not_known_come_with_those_that_are() {
    let m = MISSION_FILE;
    check(m, ("rule = \"dsmc\"", "rule = \"dsmx\""), "\"dsmx\"", &["rule", "dsmx", "pcr6"]);
    check(m, ("\"most-interesting\"", "\"best\""), "\"best\"", &["best", "expected-interest"]);
    check(m, ("prize = \"belief\"", "prize = \"gold\""), "\"gold\"", &["gold", "contrast"]);
    let rule = "rule = \"dsmc\"";
    let statistic = format!("{rule}\nstatistic = \"beleif\"");
    check(m, (rule, &statistic), "\"beleif\"", &["statistic", "beleif", "pignistic"]);
    let constant = format!("{rule}\nstatistic = \"plausibility\"");
    check(m, (rule, &constant), "\"plausibility\"", &["statistic", "constant"]);
    let paradox = format!("{rule}\nparadox = \"away\"");
    check(m, (rule, &paradox), "\"away\"", &["paradox", "away"]);
}

#[test]
fn every_rule_that_makes_maps_is_a_missions_to_choose() {
    for rule in Rule::ALL {
        let loaded = load("paper", &[("rule", rule.name())]);
        assert_eq!(loaded.is_ok(), rule.on_maps(), "{rule}");
    }
    let told = [("rule", "dsmh"), ("paradox", "keep-for-dsmh")];
    assert!(load("paper", &told).is_ok());
    let told = [("rule", "inagaki"), ("inagaki-k", "0.25")];
    assert_eq!(load("paper", &told).expect("a mission").spec.fusion.inagaki_k, 0.25);
}

#[test]
fn what_makes_no_sense_together_is_shown_where_it_is_said() {
    let (m, rule) = (MISSION_FILE, "rule = \"dsmc\"");
    check(m, (rule, "rule = \"bold\""), "\"bold\"", &["rule", "bold", "cannot make a map"]);
    let paradox = "rule = \"pcr6\"\nparadox = \"keep-for-dsmh\"";
    let words = ["paradox", "keep-for-dsmh means nothing to rule pcr6", "to-ignorance, split"];
    check(m, (rule, paradox), "\"keep-for-dsmh\"", &words);
    let k = "rule = \"inagaki\"\ninagaki-k = 1.5";
    check(m, (rule, k), "1.5", &["inagaki-k", "lies in [0, 1]"]);
}

#[test]
fn numbers_out_of_range_show_the_range() {
    let m = MISSION_FILE;
    for (from, to, at, words) in [
        ("time-s = 40000.0", "time-s = -3.0", "-3.0", ["budget.time-s: -3;", "at least 0"]),
        ("reserve-j = 1.0e5", "reserve-j = 9.0e9", "9.0e9", ["budget.reserve-j", "to 1600000"]),
        ("data-mb = 600.0", "data-mb = nan", "nan", ["budget.data-mb", "at least 0"]),
        ("energy-j = 1.6e6", "energy-j = inf", "inf\n", ["budget.energy-j", "at least 0"]),
        ("min-reliability = 0.5", "min-reliability = 1.5", "1.5", ["min-reliability", "0 to 1"]),
        ("slope-max-deg = 25.0", "slope-max-deg = 95.0", "95.0", ["slope-max-deg", "(0, 90)"]),
        ("step-max-m = 0.4", "step-max-m = 0.4\nfootprint-radius-m = 99.0", "99.0", ["99", "16"]),
        ("poses = 2", "poses = 0", "0\n\n[rover.vehicle]", ["rover.poses: 0", "1 to 4"]),
        ("range-m = 25.0", "range-m = 0.0", "0.0\nu0", ["instrument.0.range-m", "0.001"]),
        ("sight = 0.2", "sight = nan", "nan", ["prior.uncertainty.elevation", "0 to 1"]),
        ("u = 0.0 }", "u = 2.0 }", "2.0 }", ["prior.pinned.0.u", "0 to 1"]),
        ("weight = 0.3", "weight = 0.0", "0.0\nachieves = [\"im", ["directive.2.weight", "1000"]),
        ("sigma = 0.1", "sigma = -1.0", "-1.0", ["layer.0.sigma", "at least 0"]),
        ("classes = [1, 2, 3, 4]", "classes = [1]", "[1]", ["layer.2.classes", "two"]),
        ("time-s = 600.0", "time-s = -6.0", "-6.0", ["operator.3.time-s", "1000000000"]),
        ("min-prominence = 0.1", "max-sequenced = 9999", "9999", ["goals.max-sequenced", "1 to "]),
        ("rows = 101", "rows = 0", "[terrain]", ["0 x 101", "65535"]),
        (
            "rows = 101\ncols = 101",
            "rows = 65535\ncols = 65534",
            "65535",
            ["terrain.rows", "at most"],
        ),
    ] {
        check(m, (from, to), at, &words);
    }
}

#[test]
fn the_start_and_pinned_cells_must_lie_on_the_grid() {
    let m = MISSION_FILE;
    let words = ["rover.start", "(row 101, col 3)", "101 x 101"];
    check(m, ("start = [50, 50]", "start = [101, 3]"), "[101, 3]", &words);
    let at = "{ layer = \"elevation\", row = 800";
    check(m, ("row = 81,", "row = 800,"), at, &["prior.pinned.0", "(row 800, col 66)"]);
}

#[test]
fn tables_that_are_not_opinions_are_shown_at_their_row() {
    let (dem, texture) = ("experts/dem.toml", "experts/texture.toml");
    let heavy = ("paradox = 0.30", "paradox = 0.90");
    check(dem, heavy, "[[band]]\nfrom = 1.0", &["band.1", "1.6"]);
    let over = ("from = 3.0\nto = 5.0", "from = 2.5\nto = 5.0");
    check(dem, over, "[[band]]\nfrom = 2.5", &["[1, 3)", "[2.5, 5)", "overlap"]);
    let empty = ("from = 1.0\nto = 3.0", "from = 3.0\nto = 1.0");
    check(dem, empty, "[[band]]\nfrom = 3.0\nto = 1.0", &["[3, 1)", "below"]);
    let nan = ("from = 1.0\nto = 3.0", "from = nan\nto = 3.0");
    check(dem, nan, "[[band]]\nfrom = nan", &["NaN", "below"]);
    let again = ("value = 2", "value =  1");
    check(texture, again, "[[class]]\nvalue =  1", &["class 1 has two rows"]);
    let both =
        ("[outside]", "[[band]]\nparadox = 0\nnot-interesting = 0\ninteresting = 0\n[outside]");
    check(texture, both, "[[class]]", &["bands or classes, not both"]);
}

#[test]
fn a_table_must_fit_the_mission_s_layers() {
    let dem = "experts/dem.toml";
    let words = ["`gradent`", "elevation, temperature, texture, gradient"];
    check(dem, ("layer = \"gradient\"", "layer = \"gradent\""), "\"gradent\"", &words);
    let words = ["unit: `deg`", "layer `gradient` is in ``"];
    check(dem, ("unit = \"\"", "unit = \"deg\""), "\"deg\"", &words);
}

#[test]
fn experts_must_exist_once_and_be_some() {
    let m = MISSION_FILE;
    let all = text(&PAPER, m).lines().find(|l| l.starts_with("experts =")).expect("it has some");
    check(m, (all, "experts = []"), "[]", &["experts: none", "at least one"]);
    let twice = "experts = [\"experts/dem.toml\", \"experts/dem.toml\"]";
    let error = changed(m, all, twice);
    assert!(error.message.contains("experts.1: a second expert is named `dem`"), "{error}");
    assert_eq!(error.place.map(|p| p.1), Some("experts = [\"experts/dem.toml\", ".len() + 1));
    let error = changed(m, all, "experts = [\"experts/none.toml\"]");
    assert_eq!(error.file, "experts/none.toml");
    assert!(error.to_string().contains("--> experts/none.toml"), "{error}");
}

fn changed(file: &str, from: &str, to: &str) -> MissionError {
    let mut files = PAPER.clone();
    let after = text(&files, file).replacen(from, to, 1);
    files.insert(file.to_owned(), after.into_bytes());
    Mission::from_files(&files).expect_err("the change is a mistake")
}

#[test]
fn directives_name_what_the_mission_has() {
    let m = MISSION_FILE;
    let words = ["directive.0.experts", "`dme`", "dem, temperature, texture"];
    check(m, ("experts = [\"dem\"]", "experts = [\"dme\"]"), "[\"dme\"]", &words);
    let substitute = ("substitute = \"image-site\"", "substitute = \"nap\"");
    check(m, substitute, "\"nap\"", &["directive.0.substitute", "`nap`", "image-site"]);
    let itself = ("substitute = \"image-site\"", "substitute = \"analyse-rock-face\"");
    let at = "\"analyse-rock-face\"\n\n[[directive]]";
    check(m, itself, at, &["directive.0.substitute", "itself"]);
    let fact = ("achieves = [\"imaged\"]", "achieves = [\"imagined\"]");
    check(m, fact, "[\"imagined\"]", &["directive.2.achieves", "`imagined`", "never made true"]);
    let nothing = ("achieves = [\"imaged\"]", "achieves = []");
    check(m, nothing, "[]", &["directive.2.achieves", "at least one fact"]);
    let twice = ("name = \"image-site\"", "name = \"analyse-warm-ground\"");
    let error = changed(m, twice.0, twice.1);
    assert!(error.message.starts_with("directive.2.name: "), "{error}");
}

#[test]
fn operators_must_drive_and_their_preconditions_must_be_possible() {
    let m = MISSION_FILE;
    let words = ["operator.4.preconditions", "`sterile`", "no operator adds it"];
    let from = "preconditions = [\"arm-deployed\", \"calibrated\"]";
    let to = "preconditions = [\"arm-deployed\", \"sterile\"]";
    check(m, (from, to), "[\"arm-deployed\", \"sterile\"]", &words);
    let no_drive = ("name = \"drive\"", "name = \"glide\"");
    check(m, no_drive, "[[operator]]", &["no operator is named `drive`"]);
    let error = changed(m, "name = \"calibrate\"", "name = \"stow-arm\"");
    assert!(error.message.starts_with("operator.3.name: operator `stow-arm`"), "{error}");
    // An arm neither stowed nor deployed: nothing can ever be done.
    let neither = ("facts = [\"arm-stowed\"]", "facts = []");
    let words = ["directive.0.achieves", "no sequence of operators"];
    check(m, neither, "[\"analysed\"]\nstandoff-m", &words);
}

#[test]
fn layers_must_be_measured_or_derived_and_some_must_be_the_elevation() {
    let m = MISSION_FILE;
    let words = ["layer.1.name", "`heat`", "elevation, temperature, texture"];
    check(m, ("name = \"temperature\"", "name = \"heat\""), "\"heat\"", &words);
    let twice = ("name = \"texture\"", "name = \"temperature\"");
    let error = changed(m, twice.0, twice.1);
    assert!(error.message.contains("layer `temperature` is given twice"), "{error}");
    let lonely = ("derived = \"gradient\"", "derived = \"gradient\"\nsigma = 0.5");
    check(m, lonely, "0.5\n\n# The first look", &["layer.3.sigma", "derived"]);
    let mean = ("kind = \"class\"", "kind = \"class\"\nupdate = \"weighted\"");
    check(m, mean, "\"weighted\"", &["layer.2.update", "no mean"]);
    let instrument = ("layers = [\"temperature\"]", "layers = [\"gradient\"]");
    check(m, instrument, "[\"gradient\"]", &["instrument.1.layers", "no measured layer"]);
    let prior = ("texture = \"west-to-east\"", "slope = \"west-to-east\"");
    check(m, prior, "\"west-to-east\"", &["prior.uncertainty.slope", "no measured layer"]);
}

/// A mission on ground from files: 4 x 3 cells.
fn on_files() -> Files {
    let mut files = small::files("");
    let grid = |cell: &str| {
        let row = [cell; 3].join(" ");
        let rows = [row.as_str(); 4].join("\n");
        format!("ncols 3\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n{rows}\n").into_bytes()
    };
    let text = text(&files, MISSION_FILE)
        .replace("landscape = \"landscape.toml\"\nrows = 40\ncols = 40\n", "")
        .replace("sigma = 0.1", "sigma = 0.1\nfile = \"z.asc\"\nuncertainty-file = \"z_u.asc\"")
        .replace("sigma = 1.0", "sigma = 1.0\nfile = \"t.asc\"")
        .replace("kind = \"class\"", "kind = \"class\"\nfile = \"c.asc\"")
        .replace("start = [20, 20]", "start = [1, 1]");
    files.insert(MISSION_FILE.into(), text.into_bytes());
    for (name, cell) in [("z.asc", "2.5"), ("z_u.asc", "0.25"), ("t.asc", "3"), ("c.asc", "1")] {
        files.insert(name.into(), grid(cell));
    }
    files
}

#[test]
fn ground_may_come_from_files() {
    let mission = Mission::from_files(&on_files()).expect("the files are sound");
    assert_eq!((mission.spec.grid.rows(), mission.spec.grid.cols()), (4, 3));
    let error = mission_with("t.asc", None);
    assert_eq!(error.file, "t.asc");
}

fn mission_with(file: &str, bytes: Option<&[u8]>) -> MissionError {
    let mut files = on_files();
    match bytes {
        None => files.remove(file),
        Some(bytes) => files.insert(file.to_owned(), bytes.to_vec()),
    };
    Mission::from_files(&files).expect_err("the change is a mistake")
}

#[test]
fn layers_on_other_grids_are_refused_with_both_grids() {
    let other = b"ncols 2\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 1\n1 1\n1 1\n1 1\n";
    for (file, key, name) in [
        ("t.asc", "\"t.asc\"", "layer.1.file: `temperature`"),
        ("z_u.asc", "\"z_u.asc\"", "layer.0.uncertainty-file: the uncertainty"),
    ] {
        let error = mission_with(file, Some(other));
        assert_eq!(error.place, Some(place_of(text(&on_files(), MISSION_FILE), key)), "{error}");
        for word in [name, "4 x 2 cells", "4 x 3 cells", "share one grid"] {
            assert!(error.message.contains(word), "{error}");
        }
    }
    // The same shape elsewhere is another grid.
    let moved = String::from_utf8(on_files()["t.asc"].clone()).expect("it is text");
    let error = mission_with("t.asc", Some(moved.replace("xllcorner 0", "xllcorner 7").as_bytes()));
    assert!(error.message.contains("(7, 4)") && error.message.contains("(0, 4)"), "{error}");
}

#[test]
fn terrain_files_that_are_none_are_said_at_the_key_that_names_them() {
    let at = place_of(text(&on_files(), MISSION_FILE), "\"t.asc\"");
    let error = mission_with("t.asc", Some(b"hello"));
    assert_eq!((error.file.as_str(), error.place), (MISSION_FILE, Some(at)), "{error}");
    assert!(error.message.contains("layer.1.file") && error.message.contains("t.asc"), "{error}");
    let mut files = load("marias-pass", &[]).expect("it ships").files;
    files.insert("terrain/thermal_u.tif".into(), b"II*\0 and then nothing".to_vec());
    let error = Mission::from_files(&files).expect_err("it is no TIFF");
    let at = place_of(text(&files, MISSION_FILE), "\"terrain/thermal_u.tif\"");
    assert_eq!(error.place, Some(at), "{error}");
    assert!(error.message.contains("terrain/thermal_u.tif"), "{error}");
    let over = String::from_utf8(on_files()["z_u.asc"].clone()).expect("it is text");
    let error = mission_with("z_u.asc", Some(over.replacen("0.25", "1.5", 1).as_bytes()));
    assert!(error.message.contains("1.5 at (row 0, col 0)"), "{error}");
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let error = Mission::load(Path::new("no/such/mission"), &[]).expect_err("there is none");
    assert!(error.file.starts_with("no/such/mission"), "{error}");
}

#[test]
fn a_mission_file_may_have_any_name_and_errors_use_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, bytes) in &small::files(small::LEVEL) {
        let name = if path == MISSION_FILE { "mine.toml" } else { path };
        let place = folder.path().join(name);
        std::fs::create_dir_all(place.parent().expect("it lies in a folder")).expect("a folder");
        std::fs::write(place, bytes).expect("a file");
    }
    let mine = folder.path().join("mine.toml");
    let mission = Mission::load(&mine, &[]).expect("it is sound");
    assert!(mission.files.contains_key(MISSION_FILE));
    let set = [Override::new("rover.start", "[99, 0]")];
    let error = Mission::load(&mine, &set).expect_err("the start is off the grid");
    assert_eq!(error.file, "mine.toml");
}

#[test]
fn a_name_that_is_no_file_name_is_refused() {
    for name in ["", "../escaped", "a/b", ".hidden"] {
        let error = load("paper", &[("name", name)]).expect_err("logs are named after it");
        assert!(error.message.contains("expected letters"), "{error}");
    }
}

#[test]
fn overrides_change_values_by_path_and_index() {
    let mission = load(
        "paper",
        &[
            ("budget.energy-j", "2.0e6"),
            ("directive.1.weight", "0.25"),
            ("rover.start.1", "40"),
            ("prior.pinned.0.u", "0.5"),
            ("statistic", "pignistic"),
            ("execution.slip-scatter", "0"),
            ("summary", "a \"quoted\" summary"),
            ("layer.0.sigma", "0.3"),
        ],
    );
    let mission = mission.expect("the changes are sound");
    assert_eq!(mission.spec.budget.energy_j, 2.0e6);
    assert_eq!(mission.spec.directives[1].weight, 0.25);
    assert_eq!(mission.world.execution().start.col, 40);
    assert_eq!(mission.spec.fusion.statistic.name(), "pignistic");
    assert_eq!(mission.world.execution().slip_scatter, 0.0);
    assert_eq!(mission.summary, "a \"quoted\" summary");
    assert_eq!(mission.overrides.len(), 8);
    let layers = &mission.spec.layers;
    let prior = mission.world.prior(layers, mission.spec.grid.window()).expect("it is in memory");
    let elevation = prior.iter().find(|w| w.layer == "elevation").expect("it is known");
    assert_eq!(elevation.uncertainty[81 * 101 + 66], 0.5);
}

#[test]
fn the_control_prior_is_one_override_away() {
    for name in ["paper", "marias-pass"] {
        let mission = load(name, &[("prior.kind", "complete")]).expect("the other keys may stay");
        let prior = mission
            .world
            .prior(&mission.spec.layers, mission.spec.grid.window())
            .expect("it is in memory");
        assert!(prior.iter().all(|w| w.uncertainty.iter().all(|u| *u == 0.0 || *u == 1.0)));
    }
}

#[test]
fn bad_overrides_are_shown_in_the_changed_text_or_as_the_option() {
    let error = load("paper", &[("budget.enrgy", "1")]).expect_err("no such key");
    assert!(error.place.is_some() && error.to_string().contains("enrgy = 1"), "{error}");
    assert!(error.message.contains("unknown field `enrgy`"), "{error}");
    let error = load("paper", &[("budget.energy-j", "lots")]).expect_err("no number");
    assert!(error.to_string().contains("energy-j = \"lots\""), "{error}");
    for (key, words) in [
        ("name.first", "`name` is a plain value"),
        ("name.first.second", "`name` is a plain value"),
        ("experts.9", "`experts` has 3 entries"),
        ("experts.x", "`experts` is a list"),
        ("directive.7.weight", "`directive` has 3 entries"),
        ("directive.0", "is a table"),
        ("", "expected a dotted path"),
        ("budget..x", "expected a dotted path"),
    ] {
        let error = load("paper", &[(key, "1")]).expect_err("the key leads nowhere");
        assert_eq!(error.file, "--set", "{error}");
        assert!(error.message.contains(words), "{key}: {error}");
        assert!(error.message.starts_with(&format!("{key}=1: ")), "{error}");
    }
}

#[test]
fn a_mission_read_from_its_own_files_is_the_same_mission() {
    for (name, overrides) in [
        ("paper", &[][..]),
        ("paper", &[("rule", "pcr6"), ("budget.time-s", "1000.0")][..]),
        ("marias-pass", &[("seed", "9")][..]),
    ] {
        let first = load(name, overrides).expect("it is sound");
        let second = Mission::from_files(&first.files).expect("nothing is missing");
        assert_eq!(first.digest, second.digest);
        assert_eq!(first.files, second.files);
        assert_eq!(first.spec, second.spec);
        assert_eq!((first.seed, &first.name), (second.seed, &second.name));
    }
    let (plain, set) = (load("paper", &[]), load("paper", &[("seed", "2")]));
    assert_ne!(plain.expect("it ships").digest, set.expect("it is sound").digest);
}

/// One random edit of a file: overwrite, insert or delete at a share of its length.
fn edit(bytes: &mut Vec<u8>, (kind, share, byte): (u8, f64, u8)) {
    let at = ((bytes.len() as f64 * share) as usize).min(bytes.len().saturating_sub(1));
    match kind {
        _ if bytes.is_empty() => bytes.push(byte),
        0 => bytes[at] = byte,
        1 => bytes.insert(at, byte),
        2 => drop(bytes.remove(at)),
        _ => bytes.truncate(at),
    }
}

/// Bytes that change meaning more often than they break the syntax, and any other.
fn any_byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        4 => proptest::sample::select(b"0123456789-.e\"[]=#\n'{},_nai".to_vec()),
        1 => any::<u8>(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    /// Whatever becomes of the text, a mission loads or says where it is wrong.
    #[test]
    fn edited_files_load_or_say_where_they_are_wrong(
        real in proptest::bool::weighted(0.1),
        which in 0usize..8,
        edits in proptest::collection::vec((0u8..3, 0.0..1.0f64, any_byte()), 1..4),
        cut in proptest::option::weighted(0.1, 0.0..1.0f64),
    ) {
        static REAL: LazyLock<Files> =
            LazyLock::new(|| load("marias-pass", &[]).expect("it ships").files);
        let mut files = if real { REAL.clone() } else { PAPER.clone() };
        // Half of the edits go to the mission's own file, the others to its tables and landscape.
        let texts: Vec<String> =
            files.keys().filter(|f| Path::new(f).extension().is_some_and(|e| e == "toml")).cloned().collect();
        let file = if which < 4 { MISSION_FILE.to_owned() } else { texts[which % texts.len()].clone() };
        let bytes = files.get_mut(&file).expect("it is one of them");
        for change in edits {
            edit(bytes, change);
        }
        if let Some(share) = cut {
            edit(bytes, (3, share, 0));
        }
        if let Err(error) = Mission::from_files(&files) {
            prop_assert!(!error.file.is_empty() && !error.message.is_empty());
            prop_assert!(error.to_string().contains(&format!("--> {}", error.file)), "{}", error);
        }
    }
}

/// The keys that an unknown one is told to be mistaken for.
fn keys_of(table: &str) -> Vec<String> {
    let mut files = PAPER.clone();
    let text = text(&files, MISSION_FILE).to_owned();
    let text = if table.is_empty() { format!("zzz = 1\n{text}") } else { text };
    let changed = if table.is_empty() {
        text
    } else if text.contains(table) {
        text.replacen(table, &format!("{table}\nzzz = 1"), 1)
    } else {
        format!("{text}\n{table}\nzzz = 1\n")
    };
    files.insert(MISSION_FILE.to_owned(), changed.into_bytes());
    let said = Mission::from_files(&files).expect_err("no such key").to_string();
    assert!(said.contains("unknown field `zzz`"), "{table}: {said}");
    let (_, expected) = said.split_once(", expected ").expect("it lists the keys");
    let line = expected.lines().next().expect("a line");
    line.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_guide_to_mission_files_names_every_key() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/mission.md");
    let guide = std::fs::read_to_string(path).expect("it ships");
    let tables = [
        "",
        "[terrain]",
        "[[layer]]",
        "[prior]",
        "[[instrument]]",
        "[rover]",
        "[rover.vehicle]",
        "[budget]",
        "[goals]",
        "[routes]",
        "[objective]",
        "[triggers]",
        "[fallback]",
        "[[type]]",
        "[[object]]",
        "[[operator]]",
        "[[directive]]",
        "[execution]",
        "[[fault]]",
        "[[reading]]",
    ];
    for table in tables {
        let keys = keys_of(table);
        assert!(keys.len() > 1, "{table}: {keys:?}");
        for key in keys {
            let named = [format!("`{key}`"), format!("[{key}]"), format!(".{key}]")];
            assert!(named.iter().any(|n| guide.contains(n)), "{table}: `{key}` is not in it");
        }
    }
}

#[test]
fn a_preset_s_vehicle_takes_the_mission_s_keys_over_its_own() {
    let preset = wisdom_planner::Preset::named("m2020").expect("it is built in").vehicle();
    let with = |more: &[(&str, &str)]| {
        let mut changes = vec![("rover.preset", "m2020")];
        changes.extend(more);
        load("marias-pass", &changes).expect("a sound mission").spec.vehicle
    };
    // Marias Pass sets four keys; all others are the preset's.
    let vehicle = with(&[]);
    assert_eq!(vehicle.slope_max_deg, 28.0);
    assert_eq!(vehicle.mass_kg, preset.mass_kg);
    assert_eq!(vehicle.slip_class, preset.slip_class);
    assert_eq!(with(&[("rover.vehicle.mass-kg", "500.0")]).mass_kg, 500.0);
    let error = load("marias-pass", &[("rover.preset", "tricycle")]).expect_err("no such rover");
    let said = error.to_string();
    assert!(
        said.contains("no preset is named `tricycle`; there are mer, msl, m2020, exomars"),
        "{said}"
    );
    assert!(said.contains("mission.toml:"), "{said}");
}

#[test]
fn slip_depends_on_a_measured_layer_of_classes_or_it_is_an_error() {
    let mission = load("marias-pass", &[("rover.slip-layer", "texture")]).expect("classes");
    assert_eq!(mission.spec.slip_layer.as_deref(), Some("texture"));
    for name in ["temperature", "slope", "colour"] {
        let error = load("marias-pass", &[("rover.slip-layer", name)]).expect_err("no classes");
        let said = error.to_string();
        let words = format!("`{name}` is no measured layer of classes; there are: texture");
        assert!(said.contains(&words) && said.contains("slip-layer"), "{said}");
    }
}
