//! Word from outside: commands that come and go, tools that break, windows that open.

mod small;

use wisdom_autonomy::{Act, Trigger, Wake, Word};
use wisdom_goals::{Action, Reason};
use wisdom_mission::{Memory, Mission, RunStatus, RunSummary, run};

const HILLS: &str = "\
[base]
elevation_m = 0.0
rise_east = 0.0
rise_north = 0.0
texture = 0
temperature = 3.0

[[rock]]
name = \"A\"
centre = [30.0, 10.0]
half-axes = [3.0, 2.5]
height_m = 4.0
wall = \"ramp\"
wall_cells = 1.2

[[rock]]
name = \"B\"
centre = [28.0, 31.0]
half-axes = [2.5, 3.0]
height_m = 4.0
wall = \"ramp\"
wall_cells = 1.2
";

/// The analyser works at first, and is needed to analyse.
const ANALYSER_HOLDS: (&str, &str) =
    ("facts = [\"arm-stowed\"]", "facts = [\"arm-stowed\", \"analyser-works\"]");
const ANALYSER_NEEDED: (&str, &str) = (
    "name = \"analyse\"\npreconditions = [\"arm-deployed\"]",
    "name = \"analyse\"\npreconditions = [\"arm-deployed\", \"analyser-works\"]",
);

fn told(mission: &Mission) -> (RunSummary, Memory) {
    let mut memory = Memory::default();
    let summary = run(mission, &mut memory, &mut |_| true).expect("the run ends");
    for decision in &memory.decisions {
        assert!(!decision.triggers.is_empty(), "decision {} has no trigger", decision.number);
    }
    (summary, memory)
}

fn level(changes: &[(&str, &str)]) -> (RunSummary, Memory) {
    let mission = small::mission(small::LEVEL, changes).expect("the mission is sound");
    told(&mission)
}

const COMMAND: &str = "[[directive]]
name = \"image\"";

#[test]
fn a_command_makes_a_goal_where_the_map_has_none() {
    let command = "[[command]]
name = \"look there\"
at-s = 0.0
directive = \"image\"
target = [30, 30]
prize = 0.5

[[directive]]
name = \"image\"";
    let (summary, memory) = level(&[(COMMAND, command)]);
    let Word::Pursue { name, .. } = &memory.messages[0].word else {
        panic!("{:?}", memory.messages)
    };
    assert_eq!(name, "look there");
    let done = &summary.achieved[..];
    assert!(
        done.iter().any(|a| a.directive == "image" && (a.target.row, a.target.col) == (30, 30)),
        "{done:?}"
    );
    let first = memory.decisions[0].verdicts.iter().find(|v| v.goal.order.is_some());
    let first = first.expect("the command made a goal");
    assert_eq!((first.action, first.reason), (Action::Add, Reason::Commanded));
    assert_eq!(first.goal.prize, 0.5);
}

#[test]
fn a_sleeping_rover_is_woken_by_a_command_and_the_command_may_be_taken_back() {
    let command = "[[command]]
name = \"later\"
at-s = 20000.0
directive = \"image\"
target = [38, 38]
prize = 0.5
withdraw-at-s = 20010.0

[[directive]]
name = \"image\"";
    let (summary, memory) = level(&[(COMMAND, command)]);
    let waits = memory.decisions.iter().filter(|d| matches!(d.act, Act::Wait { wake: Wake::Word }));
    assert!(waits.count() >= 2, "it waits before the command and after it was taken back");
    let woken = memory
        .decisions
        .iter()
        .find(|d| d.triggers.iter().any(|t| matches!(t, Trigger::Command { number: 0 })))
        .expect("the command asks for a decision");
    assert!(woken.state.spent.time_s >= 20_000.0);
    let gone = memory.decisions.iter().flat_map(|d| &d.verdicts);
    let gone = gone.filter(|v| v.reason == Reason::Withdrawn).collect::<Vec<_>>();
    assert_eq!(gone.len(), 1, "{gone:?}");
    assert_eq!(gone[0].action, Action::Drop);
    assert_eq!(memory.messages.len(), 2);
    assert_eq!(summary.status, RunStatus::Waiting);
}

#[test]
fn goals_whose_tool_breaks_follow_their_substitute() {
    let changes = [
        ANALYSER_HOLDS,
        ANALYSER_NEEDED,
        (
            "[[operator]]\nname = \"drive\"",
            "[[fault]]
name = \"arm motor\"
kind = \"facts-lost\"
facts = [\"analyser-works\"]
probability = 1.0
between-s = [400.0, 400.0]

[[operator]]
name = \"drive\"",
        ),
    ];
    let mission = small::mission(HILLS, &changes).expect("the mission is sound");
    let (summary, memory) = told(&mission);
    assert!(
        memory.messages.iter().any(
            |m| matches!(&m.word, Word::Facts { deletes, .. } if deletes == &["analyser-works"])
        )
    );
    let eroded = memory.decisions.iter().flat_map(|d| &d.verdicts).flat_map(|v| &v.changes);
    assert!(eroded.into_iter().any(|change| change.reason == Reason::Fault));
    let late = summary.achieved.iter().filter(|a| a.time_s > 4000.0);
    assert!(late.into_iter().all(|a| a.directive == "image"), "{:?}", summary.achieved);
}

#[test]
fn the_rover_waits_at_a_site_until_its_window_opens() {
    let changes = [(
        "name = \"analyse\"\nmin-interest",
        "name = \"analyse\"\nwindow-s = [9000.0, 25000.0]\nmin-interest",
    )];
    let mission = small::mission(HILLS, &changes).expect("the mission is sound");
    let (summary, memory) = told(&mission);
    let analysed: Vec<f64> =
        summary.achieved.iter().filter(|a| a.directive == "analyse").map(|a| a.time_s).collect();
    assert!(!analysed.is_empty(), "{:?}", summary.achieved);
    assert!(analysed.iter().all(|&time_s| time_s >= 9000.0), "{analysed:?}");
    // It came early and waited there, or did something else meanwhile; either way no plan begins before.
    for decision in &memory.decisions {
        let mut at_s = decision.state.spent.time_s;
        let plan = decision.plan();
        for (stop, leg) in plan.sequence.stops.iter().zip(&plan.plan.legs) {
            at_s += leg.route.cost.time_s + stop.service.time_s;
            let goal = &decision.manager_after.goals[&stop.goal];
            if mission.spec.directives[goal.directive].name == "analyse" {
                // The analysis alone takes half an hour.
                assert!(at_s - 1800.0 >= 9000.0 - 1e-6, "decision {}: {at_s}", decision.number);
            }
        }
    }
}

#[test]
fn the_end_of_a_fault_gives_back_only_what_held_and_no_operator_tends() {
    let changes = [
        ANALYSER_HOLDS,
        ANALYSER_NEEDED,
        (
            "[[operator]]\nname = \"drive\"",
            "[[fault]]
name = \"arm motor\"
kind = \"facts-lost\"
facts = [\"analyser-works\", \"arm-stowed\", \"arm-deployed\"]
probability = 1.0
between-s = [400.0, 400.0]
lasts-s = 1000.0

[[object]]
name = \"arm\"
type = \"tool\"

[[type]]
name = \"tool\"

[[operator]]
name = \"drive\"",
        ),
    ];
    let mission = small::mission(HILLS, &changes).expect("the mission is sound");
    let (_, memory) = told(&mission);
    let words: Vec<&Word> = memory.messages.iter().map(|m| &m.word).collect();
    let [Word::Facts { deletes, .. }, Word::Facts { adds, .. }] = words[..] else {
        panic!("{words:?}")
    };
    assert_eq!(deletes.len(), 3);
    assert_eq!(adds, &["analyser-works"], "the arm is for its operators to stow");
}

#[test]
fn substitutes_that_go_round_in_a_circle_are_refused() {
    let circle = (
        "[[directive]]\nname = \"image\"",
        "[[directive]]\nname = \"image\"\nsubstitute = \"analyse\"",
    );
    let error = small::mission(small::LEVEL, &[circle]).expect_err("a circle").to_string();
    assert!(error.contains("circle") && error.contains("substitute"), "{error}");
}
