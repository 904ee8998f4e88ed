//! The reading at Elk: it reaches the rover on its way and is logged, the manager says what it makes of it, and the
//! numbers of the report are right where they can be known beforehand.

#[allow(dead_code, reason = "shared with the example, which needs more of it")]
#[path = "../examples/elk/study/mod.rs"]
mod study;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use proptest::prelude::*;
use study::auc::{Ends, Groups, Scored, auc, by_cell, by_group, ends, share_by_group};
use study::fate::{Fate, Until};
use study::known::Known;
use study::lie::ground;
use study::places::{Places, Point};
use study::sweep::{CONDITIONS, Condition, Sweep, Way};
use wisdom_belief::Rule;
use wisdom_grid::Cell;
use wisdom_logbook::{Entry, LogReader};
use wisdom_mission::{Mission, Ruler};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions").join(name)
}

fn elk() -> Mission {
    Mission::load(&folder("marias-pass-elk"), &[]).expect("it ships")
}

fn places(mission: &Mission) -> Places {
    let terrain = folder("marias-pass-elk").join("terrain");
    Places::read(&terrain, mission.spec.grid).expect("they ship")
}

#[test]
fn the_reading_is_logged_as_an_observation_and_the_log_verifies() {
    let kept = tempfile::tempdir().expect("a folder");
    let log = kept.path().join("elk.mcap");
    let log_name = log.to_str().expect("UTF-8");
    let wisdom = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
        let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).output();
        let output = output.expect("the command runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let set = ["--set", "reading.0.value=73", "--set", "budget.time-s=9000", "--quiet"];
    wisdom(&[&["run", "missions/marias-pass-elk", "--log", log_name][..], &set[..]].concat());
    wisdom(&["verify", log_name]);
    let log = LogReader::open(&log).expect("it was written");
    let mut handed_in = Vec::new();
    for entry in &log.entries {
        let Entry::Observation(observation) = entry else { continue };
        let spent = observation.spent.as_ref().expect("what was spent");
        let silica = observation.windows.iter().filter(|window| window.layer == "silica");
        handed_in.extend(silica.map(|window| (spent.time_s, window.clone())));
    }
    let [(time_s, window)] = &handed_in[..] else { panic!("{} readings", handed_in.len()) };
    assert!((3000.0..3600.0).contains(time_s), "{time_s}");
    assert!(window.values.contains(&73.0), "{window:?}");
}

/// The mission's own way, from one of its starts, to the first decision with a reading.
fn decided(condition: Condition, value: Option<f64>) -> Fate {
    let folder = folder("marias-pass-elk");
    let sweep = Sweep::new(&folder).expect("the mission has a reading");
    let spec = elk().spec;
    let way = Way { condition, rule: spec.fusion.rule, prize: spec.prize, policy: spec.policy };
    sweep.fate(&way, value, Until::Decision).expect("the run ends well")
}

#[test]
fn from_sol_992_the_manager_goes_to_elk_before_it_hears_of_silica() {
    for value in [49.0, 73.0] {
        let fate = decided(CONDITIONS[0], Some(value));
        let (number, time_s, _) = fate.decision.expect("it decides after the reading");
        assert!(number > 1 && time_s >= 3000.0, "decision {number} at {time_s} s");
        let done = fate.done_before.as_ref().expect("the ledge at Elk is its first goal");
        assert_eq!(done.achievement.directive, "analyse-outcrop");
        assert!(done.distance < 3.0, "{} cells", done.distance);
        // The ground about it is closed, and what silica says of it does not open it at once.
        assert!(fate.turn().is_none() && fate.why.contains("has closed the place"), "{}", fate.why);
    }
}

#[test]
fn from_sol_997_silica_above_the_highest_edge_puts_elk_into_the_plan() {
    let control = decided(CONDITIONS[1], None);
    assert_eq!(control.turn(), None, "{}", control.why);
    let basalt = decided(CONDITIONS[1], Some(49.0));
    assert_eq!(basalt.turn(), None, "{}", basalt.why);
    let rich = decided(CONDITIONS[1], Some(73.0));
    assert!(rich.turn().is_some(), "{}", rich.why);
    let standing = rich.after.expect("it has a turn");
    let elk = elk().world.execution().readings[0].cell;
    assert_eq!(standing.goal.target, elk, "the maximum is the reading's own cell");
    assert_eq!(standing.directive, "analyse-silica");
}

#[test]
fn the_mission_is_marias_pass_with_a_silica_layer_and_the_stop_of_sol_992() {
    let (elk, base) = (elk(), Mission::load(&folder("marias-pass"), &[]).expect("it ships"));
    let (ours, theirs) = (&elk.spec, &base.spec);
    assert_eq!(ours.experts[..theirs.experts.len()], theirs.experts[..]);
    assert_eq!(ours.layers[..theirs.layers.len()], theirs.layers[..]);
    assert_eq!((&ours.budget, &ours.vehicle), (&theirs.budget, &theirs.vehicle));
    assert_eq!((&ours.manager, &ours.domain), (&theirs.manager, &theirs.domain));
    assert_eq!(
        (ours.fusion, ours.prize, ours.policy),
        (theirs.fusion, theirs.prize, theirs.policy)
    );
    for layer in ["elevation", "texture", "temperature"] {
        assert_eq!(elk.world.truth(layer), base.world.truth(layer), "{layer}");
    }

    let places = places(&elk);
    let stop = places.stops.iter().find(|stop| stop.sol == 992).expect("it is one of them");
    assert_eq!(stop.at.cell(), elk.world.execution().start);
    let target = places.targets.iter().find(|target| target.name == "Elk").expect("it is named");
    let reading = &elk.world.execution().readings[0];
    assert_eq!((reading.cell, target.sol), (target.at.cell(), 992));
}

#[test]
fn the_text_of_the_mission_calls_its_reading_a_stand_in() {
    for file in ["mission.toml", "README.md"] {
        let text = std::fs::read_to_string(folder("marias-pass-elk").join(file)).expect("it ships");
        assert!(text.to_lowercase().contains("stand-in"), "{file}");
    }
}

#[test]
fn the_sweep_asks_once_in_every_band_of_the_expert_s_table() {
    let folder = folder("marias-pass-elk");
    let sweep = Sweep::new(&folder).expect("the mission has a reading");
    assert_eq!(sweep.edges, [45.0, 52.0, 63.0]);
    assert_eq!(sweep.middles(), [42.5, 48.5, 57.5, 71.5]);
}

#[test]
fn the_known_world_is_that_of_the_common_ruler() {
    let mission = elk();
    let known = Known::of(&mission).expect("it lies in memory");
    let (map, ruler) = (known.interest(Rule::Dsmc).expect("experts fit"), Ruler::new(&mission));
    for cell in mission.spec.grid.cells() {
        let true_interest = ruler.interest(cell).expect("it lies in memory");
        assert_eq!(f64::from(map[cell]), true_interest, "{cell}");
    }
    let names: Vec<&str> = known.experts().map(|expert| expert.name.as_str()).collect();
    assert_eq!(names, ["slope", "temperature", "texture"], "of silica nothing is known");
}

#[test]
fn ground_lies_near_its_nearest_stop_and_on_no_target() {
    let mission = elk();
    let places = places(&mission);
    assert_eq!((places.stops.len(), places.targets.len()), (33, 141));
    let targets: BTreeSet<Cell> = places.targets.iter().map(|t| t.at.cell()).collect();
    let ground = ground(&places, &mission, 12.0);
    assert!(ground.len() > 5000);
    for (cell, stop) in &ground {
        let here = Point::middle(*cell);
        let distance = places.stops[*stop].at.distance(here);
        assert!(distance <= 12.0 && !targets.contains(cell), "{cell}");
        assert!(places.stops.iter().all(|other| other.at.distance(here) >= distance), "{cell}");
    }
}

/// Every target against every cell of ground.
fn counted(targets: &[f64], ground: &[f64]) -> f64 {
    let pairs = targets.iter().flat_map(|t| ground.iter().map(move |g| (t, g)));
    let won = pairs.map(|(t, g)| {
        if t > g {
            1.0
        } else if t == g {
            0.5
        } else {
            0.0
        }
    });
    won.sum::<f64>() / (targets.len() * ground.len()) as f64
}

#[test]
fn auc_of_a_hand_made_example() {
    // 3 is above all four; 1 is above 0 and ties with 1: 5.5 of 8 pairs.
    assert_eq!(auc(&[3.0, 1.0], &[0.0, 1.0, 2.0, 2.0]), Some(5.5 / 8.0));
    assert_eq!(auc(&[1.0, 1.0], &[1.0, 1.0, 1.0]), Some(0.5));
    assert_eq!(auc(&[2.0], &[1.0]), Some(1.0));
    assert_eq!(auc(&[], &[1.0]), None);
    assert_eq!(auc(&[1.0], &[]), None);
}

#[test]
fn intervals_have_no_width_where_nothing_can_vary() {
    let apart = by_cell(&[3.0, 4.0], &[0.0, 1.0, 2.0], 200, 1);
    assert_eq!(apart, Some(Ends { low: 1.0, high: 1.0 }));
    let one = |scores: &[f64]| -> Vec<Scored> {
        scores.iter().map(|score| Scored { score: *score, group: 7 }).collect()
    };
    let (targets, ground) = (one(&[3.0, 1.0]), one(&[0.0, 1.0, 2.0, 2.0]));
    for groups in [Groups::Shared, Groups::Apart] {
        let drawn = by_group(&targets, &ground, groups, 50, 1);
        assert_eq!(drawn, vec![5.5 / 8.0; 50], "one group is drawn whole every time");
    }
    assert_eq!(share_by_group(&[(4, 1)], 100, 1), Some(Ends { low: 0.25, high: 0.25 }));
    assert_eq!(share_by_group(&[(0, 0)], 100, 1), None);
}

#[test]
fn groups_that_differ_widen_the_interval() {
    // Ten workspaces of ten targets: in half of them all are above the ground, in the others none.
    let score = |n: usize| if (n / 10).is_multiple_of(2) { 2.0 } else { 0.0 };
    let targets: Vec<f64> = (0..100).map(score).collect();
    let ground = vec![1.0; 1000];
    let single = by_cell(&targets, &ground, 2000, 1).expect("there are both");
    let grouped = |scores: &[f64], size: usize| -> Vec<Scored> {
        let scored = |(n, score): (usize, &f64)| Scored { score: *score, group: n / size };
        scores.iter().enumerate().map(scored).collect()
    };
    let drawn = by_group(&grouped(&targets, 10), &grouped(&ground, 100), Groups::Apart, 2000, 1);
    let whole = ends(drawn).expect("there are draws");
    // Standard errors 0.05 and 0.158.
    let (narrow, wide) = (single.high - single.low, whole.high - whole.low);
    assert!((0.17..0.22).contains(&narrow), "{narrow}");
    assert!((0.5..0.7).contains(&wide), "{wide}");
}

proptest! {
    #[test]
    fn auc_is_the_share_of_pairs_won(
        targets in proptest::collection::vec(0_u8..9, 1..30),
        ground in proptest::collection::vec(0_u8..9, 1..60),
    ) {
        let scores = |of: &[u8]| of.iter().map(|n| f64::from(*n)).collect::<Vec<_>>();
        let (targets, ground) = (scores(&targets), scores(&ground));
        let found = auc(&targets, &ground).expect("there are both");
        prop_assert!((found - counted(&targets, &ground)).abs() < 1e-12);
        let turned = auc(&ground, &targets).expect("there are both");
        prop_assert!((found + turned - 1.0).abs() < 1e-12);
        // A single group, drawn whole, is the plain AUC.
        let one = |of: &[f64]| of.iter().map(|s| Scored { score: *s, group: 0 }).collect::<Vec<_>>();
        let drawn = by_group(&one(&targets), &one(&ground), Groups::Shared, 1, 1);
        prop_assert!((found - drawn[0]).abs() < 1e-12);
    }
}
