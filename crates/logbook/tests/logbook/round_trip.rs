//! What goes into a log comes out of it.

use std::collections::BTreeMap;

use proptest::collection::vec;
use proptest::prelude::*;
use wisdom_autonomy::{LayerWindow, Observation, Outcome, Pose, Spent, StepResult};
use wisdom_goals::{GoalId, ManagerState};
use wisdom_grid::{Cell, Raster, Window};
use wisdom_logbook::record::{self, CHAIN_START};
use wisdom_logbook::{
    DecisionMaps, Entry, LogError, LogReader, LogWriter, MapMode, Options, RunEnd, Status, topic,
};

use crate::story;

#[test]
fn every_record_comes_back_in_its_order() {
    let log = story::read(&story::log());
    assert_eq!(log.status, Status::Complete);
    assert_eq!(log.entries.len(), 3 * story::DECISIONS as usize);
    let mut chain = CHAIN_START;
    for (number, entries) in log.entries.chunks(3).enumerate() {
        let number = number as u32;
        let [Entry::Observation(told), Entry::Decision(decided), Entry::Outcome(came)] = entries
        else {
            panic!("{entries:?}")
        };
        assert_eq!(Observation::try_from(told).unwrap(), story::observation(number));
        assert_eq!(Outcome::try_from(came).unwrap(), story::outcome(number));
        let mut expected = record::Decision::of(&story::decision(number), &story::setting());
        chain = expected.link(&chain);
        expected.chain.clone_from(&decided.chain);
        assert_eq!(**decided, expected);
        assert_eq!(decided.chain, hex(&chain));
    }
    let told = log.end.unwrap();
    let chain = hex(&chain);
    let (status, facts) = ("goals-achieved".to_owned(), BTreeMap::new());
    assert_eq!(told, RunEnd { status, decisions: story::DECISIONS, chain, facts });
}

fn hex(bytes: &[u8; 32]) -> String {
    blake3::Hash::from_bytes(*bytes).to_hex().to_string()
}

#[test]
fn the_run_carries_its_facts_and_its_files() {
    let log = story::read(&story::log());
    assert_eq!(log.metadata["seed"], "42");
    assert_eq!(log.metadata["grid_spacing_m"], "2");
    let files = story::header().attachments;
    assert_eq!(log.attachments.len(), files.len());
    for (found, (name, media_type, data)) in log.attachments.iter().zip(files) {
        assert_eq!((&found.name, &found.media_type), (&name, &media_type));
        assert_eq!(found.data, data);
    }
}

#[test]
fn a_map_comes_back_where_it_was_cell_by_cell() {
    let log = story::read(&story::log());
    for number in 0..story::DECISIONS {
        assert_eq!(log.map(topic::INTEREST, number).unwrap(), story::interest(number));
    }
    let elevation = log.map("/map/elevation", 0).unwrap();
    assert_eq!(elevation, Raster::filled(story::setting().grid, -4500.0));
    let missing = log.map("/map/elevation", 1).unwrap_err();
    assert_eq!(missing.to_string(), "the log holds no /map/elevation of decision 1");
}

#[test]
fn a_map_too_large_for_its_chunk_comes_back_with_its_decision() {
    let mut setting = story::setting();
    setting.grid = wisdom_grid::GridSpec::new(2100, 2100, 1.0).unwrap();
    let header = story::header();
    let mut writer =
        LogWriter::over(Vec::new(), &header, setting.clone(), Options::default()).unwrap();
    let interest = Raster::from_fn(setting.grid, |cell| (cell.row % 7 + cell.col % 5) as f32);
    let others = &[("ignorance", &interest)];
    let maps = DecisionMaps { interest: &interest, others, drape: None };
    writer.decision(&story::decision(0), &maps).unwrap();
    let log = story::read(&writer.finish("done", &BTreeMap::new()).unwrap());
    assert_eq!(log.status, Status::Complete);
    assert_eq!(log.map("/map/ignorance", 0).unwrap(), interest);
    assert_eq!(log.decisions().count(), 1);
}

#[test]
fn a_map_of_other_ground_is_refused() {
    let header = story::header();
    let options = Options::default();
    let mut writer = LogWriter::over(Vec::new(), &header, story::setting(), options).unwrap();
    let here = story::setting().grid;
    let map = Raster::filled(here.at(0.0, 0.0), 0.0);
    let maps = DecisionMaps { interest: &map, others: &[], drape: None };
    let refused = writer.decision(&story::decision(0), &maps).unwrap_err();
    let LogError::GridMismatch { name, expected, .. } = refused else { panic!("{refused}") };
    assert_eq!((name.as_str(), expected), ("interest", here));
}

#[test]
fn without_maps_the_decisions_are_the_same() {
    let options = Options { maps: MapMode::Digest, ..Options::default() };
    let mut writer =
        LogWriter::over(Vec::new(), &story::header(), story::setting(), options).unwrap();
    story::tell(&mut writer).unwrap();
    let lean = story::read(&writer.finish("goals-achieved", &BTreeMap::new()).unwrap());
    let full = story::read(&story::log());
    assert_eq!(lean.maps().count(), 0);
    assert_eq!(lean.entries, full.entries);
    assert_eq!(lean.end, full.end);
}

#[test]
fn the_goal_managers_memory_comes_back_whole() {
    let memory = story::manager(5);
    let record = record::ManagerState::of(&memory, &story::setting());
    assert_eq!(record.goals[0].directive_name, "look");
    assert_eq!(ManagerState::try_from(&record).unwrap(), memory);
}

#[test]
fn a_record_holds_no_infinity() {
    let decision = record::Decision::of(&story::decision(0), &story::setting());
    let choice = decision.choice.unwrap();
    assert_eq!(choice.act.unwrap().cost.unwrap().neg_ln_r, None);
    assert_eq!(choice.verdicts[0].terms[1].value, Some(1.0));
    assert_eq!(choice.verdicts[0].terms[1].limit, None);
    let option = &decision.objective.unwrap().family[0];
    assert_eq!(option.objectives.unwrap().net_benefit, None);
}

#[test]
fn facts_and_operators_are_written_by_name() {
    let decision = record::Decision::of(&story::decision(0), &story::setting());
    assert_eq!(decision.state.unwrap().facts, ["warm"]);
    let stop = &decision.objective.unwrap().family[0].sequence.as_ref().unwrap().stops[0].clone();
    assert_eq!(stop.after, ["unfold", "drill"]);
    assert_eq!(stop.facts_after, ["warm", "sampled"]);
}

/// A change to a sound record, and the field that the error must name.
type Wound<R> = (fn(&mut R), &'static str);

#[test]
fn a_malformed_observation_is_refused_by_field() {
    let wounds: [Wound<record::Observation>; 6] = [
        (|o| o.pose = None, "pose"),
        (|o| o.spent.as_mut().unwrap().time_s = f64::NAN, "spent.time_s"),
        (|o| o.windows[0].cols = 70_000, "elevation.cols"),
        (|o| o.windows[0].values.truncate(3), "elevation.values"),
        (|o| o.windows[0].values[1] = f32::INFINITY, "elevation.values"),
        (|o| o.windows[0].uncertainty[1] = 1.5, "elevation.uncertainty"),
    ];
    for (wound, named) in wounds {
        let mut record = record::Observation::from(&story::observation(4));
        wound(&mut record);
        let refused = Observation::try_from(&record).unwrap_err();
        let LogError::Malformed { record, field, .. } = refused else { panic!("{refused}") };
        assert_eq!((record.as_str(), field.as_str()), ("observation 4", named));
    }
}

#[test]
fn a_malformed_outcome_is_refused_by_field() {
    let wounds: [Wound<record::Outcome>; 4] = [
        (|o| o.result = "vanished".to_owned(), "result"),
        (|o| o.goal = None, "goal"),
        (|o| o.predicted_reliability = f64::NAN, "predicted_reliability"),
        (|o| o.track[0].row = 1 << 20, "track"),
    ];
    for (wound, named) in wounds {
        let mut record = record::Outcome::from(&story::outcome(4));
        wound(&mut record);
        let refused = Outcome::try_from(&record).unwrap_err();
        let LogError::Malformed { field, .. } = refused else { panic!("{refused}") };
        assert_eq!(field, named);
    }
}

#[test]
fn a_malformed_memory_is_refused_by_field() {
    let wounds: [Wound<record::ManagerState>; 5] = [
        (|m| m.goals[0].status = "lost".to_owned(), "manager.goals[G4].status"),
        (|m| m.goals[1].id = 4, "manager.goals"),
        (|m| m.retired[0].reason = "boredom".to_owned(), "manager.retired[G90].reason"),
        (|m| m.events[0].kind = "unnamed".to_owned(), "manager.events.kind"),
        (|m| m.tries[0].target = None, "manager.tries.target"),
    ];
    for (wound, named) in wounds {
        let mut record = record::ManagerState::of(&story::manager(4), &story::setting());
        wound(&mut record);
        let refused = ManagerState::try_from(&record).unwrap_err();
        let LogError::Malformed { field, .. } = refused else { panic!("{refused}") };
        assert_eq!(field, named);
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO
}

fn any_cell() -> impl Strategy<Value = Cell> {
    (0usize..=65_535, 0usize..=65_535).prop_map(|(row, col)| Cell { row, col })
}

fn any_pose() -> impl Strategy<Value = Pose> {
    (any_cell(), number()).prop_map(|(cell, heading_rad)| Pose { cell, heading_rad })
}

fn any_spent() -> impl Strategy<Value = Spent> {
    (number(), number(), number(), number()).prop_map(|(time_s, energy_j, data_mb, length_m)| {
        Spent { time_s, energy_j, data_mb, length_m }
    })
}

fn any_window() -> impl Strategy<Value = LayerWindow> {
    (1usize..5, 1usize..5, 0usize..100, 0usize..100, ".{0,8}").prop_flat_map(
        |(rows, cols, row, col, layer)| {
            let values = vec(prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL, rows * cols);
            let uncertainty = vec(0.0_f32..=1.0, rows * cols);
            (values, uncertainty).prop_map(move |(values, uncertainty)| LayerWindow {
                layer: layer.clone(),
                window: Window { row, col, rows, cols },
                values,
                uncertainty,
            })
        },
    )
}

fn any_observation() -> impl Strategy<Value = Observation> {
    (any::<u32>(), any_pose(), any_spent(), vec(any_window(), 0..4))
        .prop_map(|(number, pose, spent, windows)| Observation { number, pose, spent, windows })
}

fn any_result() -> impl Strategy<Value = StepResult> {
    let goal = any::<u32>().prop_map(GoalId);
    prop_oneof![
        goal.clone().prop_map(StepResult::Achieved),
        goal.clone().prop_map(StepResult::Blocked),
        goal.clone().prop_map(StepResult::Aborted),
        goal.prop_map(StepResult::Interrupted),
        Just(StepResult::Arrived),
        Just(StepResult::Stopped),
    ]
}

fn any_outcome() -> impl Strategy<Value = Outcome> {
    (
        any::<u32>(),
        any_result(),
        vec(".{0,8}", 0..4),
        any_pose(),
        any_spent(),
        number(),
        vec(any_cell(), 0..9),
    )
        .prop_map(
            |(decision, result, operators, pose, spent, predicted_reliability, track)| Outcome {
                decision,
                result,
                operators,
                pose,
                spent,
                predicted_reliability,
                track,
            },
        )
}

proptest! {
    /// Observations and outcomes pass through the bytes of a log without losing a bit, whatever they hold.
    #[test]
    fn inputs_survive_the_log(
        mut told in vec(any_observation(), 0..3),
        mut came in vec(any_outcome(), 0..3),
    ) {
        let header = story::header();
        let options = Options::default();
        let mut writer = LogWriter::over(Vec::new(), &header, story::setting(), options).unwrap();
        for (number, observation) in told.iter_mut().enumerate() {
            observation.number = number as u32;
            writer.observation(observation).unwrap();
        }
        let interest = story::interest(0);
        let maps = DecisionMaps { interest: &interest, others: &[], drape: None };
        writer.decision(&story::decision(0), &maps).unwrap();
        for outcome in &mut came {
            outcome.decision = 0;
            writer.outcome(outcome).unwrap();
        }
        let bytes = writer.finish("done", &BTreeMap::new()).unwrap();
        let log = LogReader::from_bytes(bytes).unwrap();
        prop_assert_eq!(&log.status, &Status::Complete);
        let (mut told_again, mut came_again) = (Vec::new(), Vec::new());
        for entry in &log.entries {
            match entry {
                Entry::Observation(record) => told_again.push(Observation::try_from(record).unwrap()),
                Entry::Outcome(record) => came_again.push(Outcome::try_from(record).unwrap()),
                Entry::Decision(decision) => prop_assert_eq!(decision.number, 0),
                Entry::Message(message) => prop_assert!(false, "nobody spoke, but {message:?}"),
                Entry::Fault(fault) => prop_assert!(false, "nothing broke, but {fault:?}"),
            }
        }
        prop_assert_eq!(told_again, told);
        prop_assert_eq!(came_again, came);
    }
}
