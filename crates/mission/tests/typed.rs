//! Types, objects and operators with parameters in a mission file.

mod small;

use std::collections::BTreeMap;

use wisdom_mission::{MISSION_FILE, Memory, Mission, MissionError, run};

/// The paper's mission with two instruments on its arm, of which one is asked for.
fn typed(changes: &[(&str, &str)]) -> (String, Result<Mission, MissionError>) {
    let shipped = Mission::load(&small::shipped("paper"), &[]).expect("it ships");
    let mut files: BTreeMap<String, Vec<u8>> = shipped.files;
    let mut text = String::from_utf8(files[MISSION_FILE].clone()).expect("text");
    let objects = "\
# What the rover can do.
[[type]]
name = \"tool\"

[[type]]
name = \"instrument\"
parent = \"tool\"

[[object]]
name = \"apxs\"
type = \"instrument\"

[[object]]
name = \"mahli\"
type = \"instrument\"

[[object]]
name = \"brush\"
type = \"tool\"

#";
    let own = [
        ("# What the rover can do.", objects),
        (
            "facts = [\"arm-stowed\"]",
            "facts = [\"arm-stowed\", \"on-arm(apxs)\", \"on-arm( mahli )\"]",
        ),
        (
            "name = \"calibrate\"\npreconditions = [\"arm-deployed\"]\nadds = [\"calibrated\"]",
            "name = \"calibrate\"\nparameters = [\"?i - instrument\"]\n\
             preconditions = [\"arm-deployed\", \"on-arm(?i)\"]\nadds = [\"calibrated(?i)\"]",
        ),
        (
            "name = \"analyse\"\npreconditions = [\"arm-deployed\", \"calibrated\"]\nadds = [\"analysed\"]",
            "name = \"analyse\"\nparameters = [\"?i - instrument\"]\n\
             preconditions = [\"arm-deployed\", \"calibrated(?i)\"]\nadds = [\"analysed(?i)\"]",
        ),
        ("achieves = [\"analysed\"]", "achieves = [\"analysed(apxs)\"]"),
        ("achieves = [\"analysed\"]", "achieves = [\"analysed( mahli )\"]"),
    ];
    for (from, to) in own.iter().chain(changes) {
        assert!(text.contains(from), "`{from}` is not in the file");
        text = text.replacen(from, to, 1);
    }
    files.insert(MISSION_FILE.to_owned(), text.clone().into_bytes());
    let mission = Mission::from_files(&files);
    (text, mission)
}

#[test]
fn a_typed_mission_has_the_operators_of_its_objects() {
    let mission = typed(&[]).1.expect("a sound mission");
    let domain = &mission.spec.domain;
    let operators: Vec<&str> = domain.operators().iter().map(|o| o.name.as_str()).collect();
    assert_eq!(
        operators,
        [
            "drive",
            "unstow-arm",
            "stow-arm",
            "calibrate(apxs)",
            "calibrate(mahli)",
            "analyse(apxs)",
            "analyse(mahli)",
            "image"
        ]
    );
    let wanted = |i: usize| domain.names(mission.spec.directives[i].achieves).collect::<Vec<_>>();
    assert_eq!((wanted(0), wanted(1)), (vec!["analysed(apxs)"], vec!["analysed(mahli)"]));
    // What is on the arm stays there, and nobody asks.
    assert!(!domain.facts().iter().any(|fact| fact.starts_with("on-arm")), "{:?}", domain.facts());
}

/// Each instrument is calibrated once, and the story names which.
#[test]
fn a_typed_mission_is_driven_and_told_by_its_ground_names() {
    let mission = typed(&[]).1.expect("a sound mission");
    let mut memory = Memory::default();
    run(&mission, &mut memory, &mut |_| true).expect("it runs to its end");
    let done: Vec<&str> =
        memory.outcomes.iter().flat_map(|o| &o.operators).map(String::as_str).collect();
    let times = |name: &str| done.iter().filter(|o| **o == name).count();
    assert!(times("analyse(apxs)") > 0, "{done:?}");
    assert_eq!(times("calibrate(apxs)"), 1);
    assert!(times("calibrate(mahli)") <= 1);
    assert_eq!(times("analyse"), 0);
}

#[test]
fn mistakes_with_types_are_shown_where_they_stand() {
    let check = |(from, to): (&str, &str), at: &str, words: &[&str]| {
        let (text, mission) = typed(&[(from, to)]);
        let error = mission.expect_err("the change is a mistake");
        let shown = error.to_string();
        let before = &text[..text.find(at).unwrap_or_else(|| panic!("no `{at}`"))];
        let line = before.matches('\n').count() + 1;
        let column = before.len() - before.rfind('\n').map_or(0, |i| i + 1) + 1;
        assert_eq!(error.place, Some((line, column)), "{shown}");
        for word in words {
            assert!(shown.contains(word), "`{word}` is not said:\n{shown}");
        }
    };
    let parameters = "parameters = [\"?i - instrument\"]";
    check(
        (parameters, "parameters = [\"?i - gadget\"]"),
        "[\"?i - gadget\"]",
        &["operator.3.parameters", "`gadget` is no type", "object, instrument, tool"],
    );
    check(
        (parameters, "parameters = [\"?j - instrument\"]"),
        "[\"arm-deployed\", \"on-arm(?i)\"]",
        &["operator.3.preconditions", "`?i` in `on-arm(?i)` is bound by no parameter"],
    );
    check(
        ("parent = \"tool\"", "parent = \"instrument\""),
        "\"instrument\"\n\n[[object]]",
        &["type.1.parent", "instrument < instrument", "leads up to `object`"],
    );
    check(("type = \"tool\"", "type = \"tol\""), "\"tol\"", &["object.2.type", "`tol` is no type"]);
    check(
        ("\"on-arm(apxs)\"", "\"on-arm(apsx)\""),
        "\"on-arm(apsx)\"",
        &["facts.1", "`apsx`", "apxs, mahli, brush"],
    );
    check(
        ("\"on-arm(apxs)\"", "\"on-arm(brush)\""),
        "\"on-arm(brush)\"",
        &["facts.1", "`brush` in `on-arm(brush)` is of type `tool`; operators have `instrument`"],
    );
    check(
        ("\"analysed(apxs)\"", "\"analysed(apxs, mahli)\""),
        "[\"analysed(apxs, mahli)\"]",
        &["directive.0.achieves", "has 2 arguments; `analysed` has 1"],
    );
    check(
        ("\"analysed(apxs)\"", "\"analysed(brush)\""),
        "[\"analysed(brush)\"]",
        &["directive.0.achieves", "`brush`"],
    );
    check(
        (", \"on-arm(apxs)\", \"on-arm( mahli )\"", ""),
        "[\"arm-deployed\", \"on-arm(?i)\"]",
        &["operator.3.preconditions", "`on-arm(apxs)` is never made true"],
    );
    check(
        (parameters, "parameters = [\"?i - instrument\", \"?k\"]"),
        "[\"?i - instrument\", \"?k\"]",
        &["operator.3.parameters", "`?k` is in no fact"],
    );
}

#[test]
fn without_types_any_text_is_the_name_of_a_fact() {
    let shipped = Mission::load(&small::shipped("paper"), &[]).expect("it ships");
    let mut files = shipped.files;
    let text = String::from_utf8(files[MISSION_FILE].clone()).expect("text");
    let text = text.replace("\"calibrated\"", "\"calibrated (by hand, twice\"");
    files.insert(MISSION_FILE.to_owned(), text.into_bytes());
    let mission = Mission::from_files(&files).expect("a sound mission");
    assert!(mission.spec.domain.facts().iter().any(|f| f == "calibrated (by hand, twice"));
}
