//! Why a goal was left out, and that its price brings it in: the budget raised by it, and the mission decided again.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use wisdom_autonomy::{Autonomy, Decision, Observation, Spec};
use wisdom_goals::{Action, GoalId};
use wisdom_logbook::{Entry, LogReader, mission_of};

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

/// A run of the paper's scene with too little energy for its goals.
fn tight_run(folder: &Path) -> PathBuf {
    let log = folder.join("run.mcap");
    let path = log.to_str().expect("UTF-8");
    let tight = ["--set", "budget.energy-j=5e5", "--set", "goals.expansions=8000"];
    let args = [&["run", "missions/paper", "--json", "--log", path], &tight[..]].concat();
    done(&wisdom(&args).output().expect("the command runs"));
    log
}

fn explained(log: &Path, more: &[&str]) -> Output {
    let args = [&["explain", log.to_str().expect("UTF-8")], more].concat();
    wisdom(&args).output().expect("the command runs")
}

/// The first decision of a log under another spec.
fn first_decision(log: &LogReader, spec: Spec) -> Decision {
    let mut rover = Autonomy::new(spec).expect("the spec is whole");
    for entry in &log.entries {
        match entry {
            Entry::Observation(logged) => {
                let observation = Observation::try_from(logged).expect("it was logged");
                rover.observe(&observation).expect("it was observed before");
            }
            Entry::Decision(_) => return rover.decide().expect("a decision"),
            Entry::Outcome(_) | Entry::Message(_) | Entry::Fault(_) => {}
        }
    }
    panic!("the log holds no decision");
}

fn holds(decision: &Decision, goal: GoalId) -> bool {
    decision.plan().sequence.goals().any(|id| id == goal)
}

#[test]
fn a_budget_raised_by_the_price_brings_the_goal_in_and_less_does_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = tight_run(folder.path());
    let told: Value =
        serde_json::from_str(&done(&explained(&path, &["--decision", "0", "--json"])))
            .expect("one JSON object");
    let log = LogReader::open(&path).expect("a log");
    let spec = mission_of(&log).expect("the mission inside loads").spec;
    let before = first_decision(&log, spec.clone());
    let left_out = told["left_out"].as_array().expect("goals");
    let open = before.verdicts.iter().filter(|v| matches!(v.action, Action::Defer | Action::Drop));
    assert_eq!(left_out.len(), open.count(), "every goal left out is told of");

    let mut raised = 0;
    for goal in left_out {
        let id = GoalId(goal["goal"].as_str().expect("a name")[1..].parse().expect("a number"));
        assert!(!holds(&before, id));
        for lever in ["energy_j", "time_s", "reliability", "prize"] {
            let price = &goal["price"][lever];
            let found = price["least"].is_number() && price["confirmed"] == true;
            assert!(found || price["nothing"].is_string(), "{id}, {lever}: {price}");
        }
        for lever in ["energy_j", "time_s"] {
            let Some(price) = goal["price"][lever]["least"].as_f64() else { continue };
            let decided = |change: f64| {
                let mut spec = spec.clone();
                let budget = &mut spec.budget;
                *(if lever == "time_s" { &mut budget.time_s } else { &mut budget.energy_j }) +=
                    change;
                holds(&first_decision(&log, spec), id)
            };
            // The budget is counted before the reserve is taken off: the sums round otherwise.
            assert!(decided(price * (1.0 + 1e-9)), "{id}: {price} more of {lever} is not enough");
            assert!(!decided(0.99 * price), "{id}: less than {price} of {lever} is enough");
            raised += 1;
        }
    }
    assert!(raised >= 3, "only {raised} prices of budgets: {told}");
}

#[test]
fn one_goal_is_explained_in_full_and_mistakes_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = tight_run(folder.path());
    let log = LogReader::open(&path).expect("a log");
    let spec = mission_of(&log).expect("the mission inside loads").spec;
    let first = first_decision(&log, spec);
    let kept = &first.shortlist.kept;
    let out = kept.iter().find(|id| !holds(&first, **id)).expect("a goal was left out").to_string();
    let within = first.plan().sequence.stops[0].goal.to_string();

    let full = |threads: &str| {
        let args = ["explain", path.to_str().expect("UTF-8"), "--decision", "0", "--why-not", &out];
        done(&wisdom(&args).env("RAYON_NUM_THREADS", threads).output().expect("the command runs"))
    };
    let text = full("1");
    for part in ["because    start", "chose", "energy", "floor", "pose  ", "with it", "displaces"] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    assert!(text.contains(&out) && text.contains("1 goal left out"), "{text}");
    assert!(!text.contains("NOT CONFIRMED"), "{text}");
    assert_eq!(text, full("3"), "the threads do not matter");

    for (args, word) in [
        (["--decision", "0", "--why-not", &within], "is in the sequence"),
        (["--decision", "0", "--why-not", "G4000"], "nothing is said of G4000"),
        (["--decision", "4000", "--why-not", "G0"], "no decision 4000"),
        (["--decision", "0", "--why-not", "all"], "written G7 or 7"),
    ] {
        let output = explained(&path, &args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(errors.contains(word), "{args:?}: {errors}");
    }
}

#[test]
fn a_goals_life_is_told_from_its_evidence_to_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = tight_run(folder.path());
    let log = LogReader::open(&path).expect("a log");
    let mut goals: Vec<u32> = log
        .decisions()
        .flat_map(|d| &d.choice.as_ref().expect("a choice").verdicts)
        .map(|v| v.goal.as_ref().expect("a goal").id)
        .collect();
    goals.sort_unstable();
    goals.dedup();
    let mut ends = [0, 0];
    for &id in goals.iter().step_by(3) {
        let name = format!("G{id}");
        let told = done(&explained(&path, &["--goal", &name, "--json"]));
        let told: Value = serde_json::from_str(&told).expect("one JSON object");
        let number = |value: &Value| value.as_f64().expect("a number");
        let sum = |of: &mut dyn Iterator<Item = f64>| of.fold(0.0, |sum, x| sum + x);

        let born = &told["born"];
        assert_eq!(born["decision"], born["goal"]["born"], "{name}");
        let evidence = born["evidence"].as_array().expect("experts");
        assert_eq!(evidence.len(), 3, "the paper has three experts");
        let credit = sum(&mut evidence.iter().map(|said| number(&said["credit"])));
        assert!((credit - 1.0).abs() < 1e-9, "{name}: under dsmc credits add up: {credit}");
        for said in evidence {
            let masses = said["masses"].as_object().expect("masses");
            let all = sum(&mut masses.values().map(number));
            assert!((all - 1.0).abs() < 1e-9, "{name}: {said}");
        }
        let region = born["region"].as_array().expect("cells").len() as u64;
        assert_eq!(Some(region), born["goal"]["region_cells"].as_u64(), "{name}");

        let weighings = told["weighings"].as_array().expect("weighings");
        let of_it = |d: &&wisdom_logbook::record::Decision| {
            let verdicts = &d.choice.as_ref().expect("a choice").verdicts;
            verdicts.iter().any(|v| v.goal.as_ref().expect("a goal").id == id)
        };
        assert_eq!(weighings.len(), log.decisions().filter(of_it).count(), "{name}");
        let last = &weighings[weighings.len() - 1]["verdict"];
        let ended = matches!(last["action"].as_str(), Some("achieve" | "drop"));
        assert_eq!(ended, !told["end"].is_null(), "{name}: {last}");
        ends[usize::from(ended)] += 1;
        if ended {
            assert_eq!(told["end"]["reason"], last["reason"]);
        }
    }
    assert!(ends[0] > 0 && ends[1] > 0, "some goals end, some do not: {ends:?}");

    let text = done(&explained(&path, &["--goal", "0"]));
    for part in ["new-maximum", "evidence", "credit", "weighed", "formulation: ", "end  "] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    let refused = explained(&path, &["--goal", "G4000"]);
    assert_eq!(refused.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert!(errors.contains("no decision speaks of G4000; its goals are G0 to"), "{errors}");
}
