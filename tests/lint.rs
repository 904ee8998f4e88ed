//! What `wisdom check` warns of: each warning on a mission with the mistake in it, and none on those that ship.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use wisdom_belief::{Opinion, Uncertainty};
use wisdom_fusion::{Fusion, credit_of};
use wisdom_mission::{Lint, MISSION_FILE, Mission, Override, Warning, lint};

const DEM: &str = "experts/dem.toml";
const TEMPERATURE: &str = "experts/temperature.toml";
const TEXTURE: &str = "experts/texture.toml";

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions").join(name)
}

type Files = BTreeMap<String, Vec<u8>>;

/// The paper's files with pieces of text replaced, each of which must be there; `"" -> text` adds at the end, and makes
/// a file that is not there.
fn paper(changes: &[(&str, &str, &str)]) -> Files {
    let mut files = Mission::load(&shipped("paper"), &[]).expect("it ships").files;
    for (file, from, to) in changes {
        let bytes = files.entry((*file).to_owned()).or_default();
        let text = String::from_utf8(bytes.clone()).expect("it is text");
        *bytes = if from.is_empty() {
            format!("{text}{to}").into_bytes()
        } else {
            assert!(text.contains(from), "`{from}` is not in {file}");
            text.replace(from, to).into_bytes()
        };
    }
    files
}

fn warnings(changes: &[(&str, &str, &str)]) -> Vec<Warning> {
    lint(&Mission::from_files(&paper(changes)).expect("it is a mission"))
}

/// The one warning of a mission that has one mistake; it says all of `words` and stands at `piece` of its file.
fn only(changes: &[(&str, &str, &str)], of: Lint, piece: &str, words: &[&str]) {
    let files = paper(changes);
    let found = lint(&Mission::from_files(&files).expect("it is a mission"));
    let shown: Vec<String> = found.iter().map(ToString::to_string).collect();
    let [warning] = &found[..] else { panic!("expected one warning: {shown:#?}") };
    assert_eq!(warning.lint, of, "{shown:?}");
    for word in words {
        assert!(warning.message.contains(word), "`{word}` is not said: {shown:?}");
    }
    let text = std::str::from_utf8(&files[&warning.file]).expect("it is text");
    let (line, column) = warning.place.expect("it has a place");
    let rest: String =
        text.lines().nth(line - 1).expect("a line").chars().skip(column - 1).collect();
    assert!(rest.starts_with(piece), "{line}:{column} is `{rest}`: {shown:?}");
    let place = format!("{}:{line}:{column}: {}: ", warning.file, warning.key);
    assert!(shown[0].starts_with(&place) && shown[0].ends_with(&format!("[{of}]")), "{shown:?}");
}

#[test]
fn missions_that_ship_have_no_warnings() {
    for name in ["paper", "marias-pass"] {
        let mission = Mission::load(&shipped(name), &[]).expect("it ships");
        let shown: Vec<String> = lint(&mission).iter().map(ToString::to_string).collect();
        assert_eq!(shown, [""; 0], "{name}");
    }
}

#[test]
fn a_threshold_below_dull_ground_is_told_with_the_papers_488() {
    let of = Lint::ThresholdBelowBackground;
    let low = [(MISSION_FILE, "min-interest = 0.6\n", "min-interest = 0.48\n")];
    only(&low, of, "0.48", &["0.48 of `image-site`", "0.488, the belief", "fused by dsmc"]);
    let above = [(MISSION_FILE, "min-interest = 0.6\n", "min-interest = 0.489\n")];
    assert_eq!(warnings(&above), []);
    // No threshold is not a low one.
    assert_eq!(warnings(&[(MISSION_FILE, "min-interest = 0.6\n", "")]), []);
}

#[test]
fn dull_ground_is_read_no_better_than_the_mission_reads() {
    let load = |threshold: &str| {
        let changes = [Override::new("directive.2.min-interest", threshold)];
        lint(&Mission::load(&shipped("marias-pass"), &changes).expect("it ships"))
    };
    // Slope from cameras with u0 = 0.02, the two others with 0.05; each table's dullest row has belief 0.2.
    let doubt = |u: f64| 1.0 - 0.2 * (1.0 - u);
    let dull = 1.0 - doubt(0.02) * doubt(0.05) * doubt(0.05);
    let below = load(&format!("{}", dull - 1e-4));
    assert_eq!(below.len(), 1, "{below:?}");
    assert!(below[0].message.contains(&format!("{dull:.6}")), "{below:?}");
    assert_eq!(load(&format!("{}", dull + 1e-4)), []);
}

#[test]
fn dull_ground_is_fused_by_the_missions_own_rule() {
    // On Shafer's model the paradox of a dull row is ignorance: nothing speaks for interest.
    let changes = [
        (MISSION_FILE, "rule = \"dsmc\"", "rule = \"dempster\""),
        (MISSION_FILE, "min-interest = 0.6\n", "min-interest = 0.01\n"),
    ];
    assert_eq!(warnings(&changes), []);
}

#[test]
fn an_interest_that_no_rows_reach_is_told() {
    let of = Lint::DirectiveNeverFires;
    let strict = (MISSION_FILE, "min-interest = 0.6\n", "min-interest = 0.99999\n");
    // A row without doubt makes certain under dsmc; with paradox as ignorance none does.
    assert_eq!(warnings(&[strict]), []);
    let dempster = (MISSION_FILE, "rule = \"dsmc\"", "rule = \"dempster\"");
    let words = ["0.99999 of `image-site`", "0.999875", "combinations of rows"];
    only(&[dempster, strict], of, "0.99999", &words);
    // The same of dsmc, once every row has its doubt.
    let doubting = |file| (file, "interesting = 0.95", "interesting = 0.5");
    let doubts = [doubting(DEM), doubting(TEMPERATURE), doubting(TEXTURE), strict];
    only(&doubts, of, "0.99999", &["0.999875", "the strongest row of each table"]);
}

/// A DEM expert that says little of anything: m(I) + m(I ∩ NI) = 0.2.
const WEAK: &str = "
name = \"dem\"
layer = \"gradient\"
quantity = \"gradient magnitude\"
[[band]]
paradox = 0.1
not-interesting = 0.6
interesting = 0.1
[outside]
paradox = 0.2
not-interesting = 0.8
interesting = 0.0
";

#[test]
fn credit_that_no_rows_give_together_with_the_interest_is_told() {
    let mut files = paper(&[]);
    files.insert(DEM.to_owned(), WEAK.as_bytes().to_vec());
    let mission = Mission::from_files(&files).expect("it is a mission");
    let found = lint(&mission);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0].lint, &*found[0].key),
        (Lint::DirectiveNeverFires, "directive.0.min-credit")
    );
    // Trying what the others may say besides, in small steps, finds the share the message tells, and none above.
    let fusion = Fusion::default();
    let weak = mission.spec.experts[0].table.masses()[0];
    let strong = Opinion { paradox: 0.05, not_interesting: 0.0, interesting: 0.95 };
    let strong = wisdom_belief::InterestMass::try_from(strong).expect("an opinion");
    let mut best = 0.0_f64;
    for step in 0..=10_000 {
        let u = Uncertainty::new(f64::from(step) / 1e4).expect("a share");
        let sources = [weak, strong.discounted(u)];
        if fusion.interest(&sources) >= 0.7 {
            best = best.max(credit_of(&sources, &fusion)[0]);
        }
    }
    let told = found[0].message.split("above ").nth(1).expect("a number");
    let told: f64 = told.split(',').next().expect("a number").parse().expect("a number");
    assert!(best <= told + 1e-6 && best > told - 1e-3, "{best} against {told}");
    assert!(told < 0.35);
}

#[test]
fn facts_that_never_hold_together_are_told() {
    // The other directive that analyses keeps the operators busy.
    let requires = "min-credit = 0.35\nrequires = [\"arm-stowed\", \"arm-deployed\"]";
    let changes = [(MISSION_FILE, "min-credit = 0.35", requires)];
    let words = ["`analyse-rock-face`", "arm-stowed and arm-deployed", "in any of"];
    only(&changes, Lint::DirectiveNeverFires, "[", &words);
    // What an earlier goal leaves behind counts.
    let calibrated = [(MISSION_FILE, "weight = 0.3", "weight = 0.3\nrequires = [\"calibrated\"]")];
    assert_eq!(warnings(&calibrated), []);
}

fn extra(weight: &str, more: &str) -> String {
    format!(
        "\n[[directive]]\nname = \"extra\"\nweight = {weight}\n{more}achieves = [\"imaged\"]\nstandoff-m = 3.0\n\
         exclusion-radius-m = 8.0\n"
    )
}

#[test]
fn a_directive_whose_sites_all_go_to_another_is_told() {
    let of = Lint::DirectiveNeverFires;
    let light = extra("0.2", "min-interest = 0.8\n");
    let words = ["`extra` (weight 0.2)", "`image-site` (weight 0.3)"];
    only(&[(MISSION_FILE, "", &light)], of, "0.2", &words);
    let late = extra("0.3", "min-interest = 0.8\nexperts = [\"dem\"]\nmin-credit = 0.5\n");
    only(&[(MISSION_FILE, "", &late)], of, "0.3", &["`extra` (weight 0.3)"]);
    for fires in [extra("0.31", "min-interest = 0.8\n"), extra("0.2", "min-interest = 0.5\n")] {
        assert_eq!(warnings(&[(MISSION_FILE, "", &fires)]), [], "{fires}");
    }
    // One that stands in for another is not idle.
    let stands_in = [
        (MISSION_FILE, "substitute = \"image-site\"", "substitute = \"extra\""),
        (MISSION_FILE, "", light.as_str()),
    ];
    assert_eq!(warnings(&stands_in), []);
}

#[test]
fn effects_operators_and_facts_that_serve_nobody_are_told() {
    let of = Lint::EffectNobodyNeeds;
    let adds = [(MISSION_FILE, "[\"imaged\"]\ntime-s", "[\"imaged\", \"filed\"]\ntime-s")];
    only(&adds, of, "[\"imaged\"", &["`image` adds filed", "6 operators", "3 directives"]);
    let slow = "\n[[operator]]\nname = \"fold-arm\"\npreconditions = [\"arm-deployed\"]\nadds = [\"arm-stowed\"]\n\
                deletes = [\"arm-deployed\"]\ntime-s = 900.0\n";
    only(&[(MISSION_FILE, "", slow)], of, "\"fold-arm\"", &["`fold-arm` is used by none of 3"]);
    let facts = [(MISSION_FILE, "facts = [\"arm-stowed\"]", "facts = [\"arm-stowed\", \"sunny\"]")];
    only(&facts, of, "\"sunny\"", &["`sunny` holds at the start"]);
}

const SLOPE: &str = "
name = \"slope\"
layer = \"slope\"
quantity = \"slope\"
unit = \"deg\"
[[band]]
from = 20.0
paradox = 0.0
not-interesting = 0.2
interesting = 0.5
[outside]
paradox = 0.0
not-interesting = 0.8
interesting = 0.0
";

#[test]
fn two_experts_on_one_reading_are_told() {
    let of = Lint::SensorCountedTwice;
    let layer = "\n[[layer]]\nname = \"slope\"\nunit = \"deg\"\nderived = \"slope\"\n";
    let experts = "\"experts/texture.toml\"]";
    let derived = [
        (MISSION_FILE, experts, "\"experts/texture.toml\", \"experts/slope.toml\"]"),
        (MISSION_FILE, "", layer),
        ("experts/slope.toml", "", SLOPE),
    ];
    let words =
        ["`dem` and `slope`", "`gradient` and `slope`", "layer `elevation`", "1 reading for 2"];
    only(&derived, of, "\"experts/slope.toml\"", &words);
    let again =
        SLOPE.replace("layer = \"slope\"", "layer = \"temperature\"").replace("\"deg\"", "\"\"");
    let same = [derived[0], ("experts/slope.toml", "", again.as_str())];
    only(&same, of, "\"experts/slope.toml\"", &["both read layer `temperature`"]);
}

#[test]
fn rows_that_no_reading_meets_are_told() {
    let of = Lint::RowNeverRead;
    let far = [(TEMPERATURE, "from = 80.0\nto = 100.0", "from = 800.0\nto = 1000.0")];
    only(&far, of, "[[band]]", &["[800, 1000) holds no reading", "4 sigma"]);
    let steep = [(DEM, "from = 9.0\n", "from = 9000.0\n")];
    only(&steep, of, "[[band]]", &["[9000, inf)", "layer `gradient`", "it reads from 0 to"]);
    let class = [(TEXTURE, "value = 3", "value = 7")];
    only(&class, of, "[[class]]", &["7 is no reading of layer `texture`", "it has 0, 1, 2, 3, 4"]);
    // A class of the ground is met though no wrong reading takes it.
    assert_eq!(warnings(&[(TEXTURE, "value = 3", "value = 0")]), []);
}

#[test]
fn a_reading_may_be_off_by_its_error() {
    // The hot disc is the warmest ground; sigma decides how far beyond it a reading may go.
    let warmest = {
        let mission = Mission::load(&shipped("paper"), &[]).expect("it ships");
        let truth = mission.world.truth("temperature").expect("in memory");
        truth.values().values().iter().copied().fold(f32::MIN, f32::max)
    };
    let from = warmest + 3.0;
    let band = format!("from = {from}\nto = 1000.0");
    let change = (TEMPERATURE, "from = 80.0\nto = 100.0", band.as_str());
    let with = |sigma: &'static str| {
        let sigma = (MISSION_FILE, "sigma = 1.0", sigma);
        warnings(&[change, sigma]).len()
    };
    assert_eq!((with("sigma = 1.0"), with("sigma = 0.7")), (0, 1));
}

#[test]
fn a_prize_that_tells_no_place_from_another_is_told() {
    let of = Lint::ConstantPrize;
    let dempster = (MISSION_FILE, "rule = \"dsmc\"", "rule = \"dempster\"");
    // Without mass on I, Shafer's model believes in no place; on the free model the paradox still speaks for some.
    let mut silent = Vec::new();
    for file in [DEM, TEMPERATURE, TEXTURE] {
        for mass in ["0.95", "0.90", "0.80", "0.10"] {
            silent.push((file, format!("\ninteresting = {mass}")));
        }
    }
    let texts = paper(&[]);
    let mut changes: Vec<(&str, &str, &str)> = silent
        .iter()
        .filter(|(file, mass)| String::from_utf8_lossy(&texts[*file]).contains(mass.as_str()))
        .map(|(file, mass)| (*file, mass.as_str(), "\ninteresting = 0.0"))
        .collect();
    assert!(!warnings(&changes).iter().any(|w| w.lint == of));
    changes.push(dempster);
    let found = warnings(&changes);
    let constant: Vec<&Warning> = found.iter().filter(|w| w.lint == of).collect();
    assert_eq!(constant.len(), 1, "{found:?}");
    assert!(constant[0].message.contains("the belief of any ground that is seen for certain is 0"));
    assert_eq!(constant[0].key, "rule");
    // All directives with a threshold above 0 never fire either, and that is said.
    assert_eq!(found.iter().filter(|w| w.lint == Lint::DirectiveNeverFires).count(), 3);
}

#[test]
fn a_prize_below_the_least_prominence_is_told() {
    let of = Lint::ConstantPrize;
    let least = (MISSION_FILE, "min-prominence = 0.1", "min-prominence = 1.0");
    // A row without doubt has the prize 1.
    assert_eq!(warnings(&[least]), []);
    let dempster = (MISSION_FILE, "rule = \"dsmc\"", "rule = \"dempster\"");
    only(&[dempster, least], of, "\"belief\"", &["the largest belief is 0.999875", "asks for 1"]);
    let contrast = (MISSION_FILE, "prize = \"belief\"", "prize = \"contrast\"");
    only(&[dempster, least, contrast], of, "\"contrast\"", &["the median of the first map"]);
}

fn wisdom(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).output().expect("it runs")
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn check_prints_warnings_and_strict_fails_on_them() {
    let low = ["--set", "directive.2.min-interest=0.3"];
    let call = |more: &[&str]| wisdom(&[&["check", "missions/paper"], more].concat());
    let told = call(&low);
    assert_eq!(told.status.code(), Some(0));
    let shown = text(&told);
    let warning = shown.lines().find(|line| line.starts_with("  warning     ")).expect("a warning");
    assert!(warning.contains("mission.toml:") && warning.contains("0.488"), "{warning}");
    assert!(shown.ends_with(" files, 1 warning\n"), "{shown}");
    assert_eq!(call(&[&low[..], &["--strict"]].concat()).status.code(), Some(1));
    let good = call(&["--strict"]);
    assert_eq!(good.status.code(), Some(0));
    assert!(text(&good).ends_with(" files, nothing wrong\n"));

    let json = call(&[&low[..], &["--json", "--strict"]].concat());
    assert_eq!(json.status.code(), Some(1));
    let object: Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let warning = &object["warnings"][0];
    assert_eq!(warning["rule"], "threshold-below-background");
    assert_eq!(warning["key"], "directive.2.min-interest");
    assert!(warning["line"].is_u64() && warning["column"].is_u64(), "{warning}");
}

#[test]
fn check_shows_the_objective_and_what_is_urgent() {
    let output = wisdom(&[
        "check",
        "missions/paper",
        "--policy",
        "utility",
        "--set",
        "objective.price-per-h=0.25",
        "--set",
        "directive.0.mandatory=true",
        "--set",
        "directive.1.fade-s=[1000.0, 2000.0]",
    ]);
    let shown = text(&output);
    let line = |word: &str| {
        let found = shown.lines().find(|line| line.contains(word));
        found.unwrap_or_else(|| panic!("no {word} in {shown}")).to_owned()
    };
    let objective = line("  objective   ");
    assert!(
        objective.contains("0.25 an hour") && objective.contains("utility asks for all"),
        "{objective}"
    );
    assert!(line("analyse-rock-face").ends_with("; mandatory"));
    assert!(
        line("analyse-warm-ground").ends_with("; whole until 1000 s, worth nothing from 2000 s on")
    );
    assert!(line("image-site wants").ends_with("by drive, image"));
}
