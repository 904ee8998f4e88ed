//! What a viewer finds that knows MCAP and Foxglove's messages but nothing of Wisdom.

use std::collections::{BTreeMap, BTreeSet};

use foxglove::messages::{FrameTransform, Log, PoseInFrame, SceneUpdate};
use mcap::MessageStream;
use prost::Message;
use wisdom_autonomy::Decision;
use wisdom_grid::Window;
use wisdom_logbook::{DecisionMaps, Drape, LogError, LogWriter, MapMode, Options, record, topic};

use crate::story;

/// The messages of one topic, decoded.
fn all<M: Message + Default>(wanted: &str) -> Vec<M> {
    let bytes = story::log();
    MessageStream::new(&bytes)
        .unwrap()
        .map(|message| message.unwrap())
        .filter(|message| message.channel.topic == wanted)
        .map(|message| M::decode(&message.data[..]).unwrap())
        .collect()
}

#[test]
fn every_topic_names_its_schema() {
    let bytes = story::log();
    let mut schemas = BTreeMap::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let channel = message.unwrap().channel;
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(
            (schema.encoding.as_str(), channel.message_encoding.as_str()),
            ("protobuf", "protobuf")
        );
        schemas.insert(channel.topic.clone(), schema.name.clone());
        if schema.name.starts_with("wisdom.") {
            assert_eq!(*schema.data, *record::DESCRIPTOR);
        }
    }
    let expected = [
        (topic::DECISION, "wisdom.v1.Decision"),
        (topic::OBSERVATION, "wisdom.v1.Observation"),
        (topic::OUTCOME, "wisdom.v1.Outcome"),
        (topic::LOG, "foxglove.Log"),
        ("/map/elevation", "foxglove.Grid"),
        (topic::INTEREST, "foxglove.Grid"),
        (topic::CLOUD, "foxglove.PointCloud"),
        (topic::POSE, "foxglove.PoseInFrame"),
        (topic::SCENE, "foxglove.SceneUpdate"),
        (topic::TRANSFORM, "foxglove.FrameTransform"),
    ];
    let expected: BTreeMap<String, String> =
        expected.into_iter().map(|(topic, name)| (topic.to_owned(), name.to_owned())).collect();
    assert_eq!(schemas, expected);
}

#[test]
fn the_descriptor_names_every_record() {
    let set = prost_types::FileDescriptorSet::decode(record::DESCRIPTOR).unwrap();
    let names: BTreeSet<&str> = set
        .file
        .iter()
        .flat_map(|file| &file.message_type)
        .map(prost_types::DescriptorProto::name)
        .collect();
    assert!(["Observation", "Outcome", "Decision"].iter().all(|name| names.contains(name)));
}

#[test]
fn no_two_messages_share_a_time_and_none_goes_back() {
    let bytes = story::log();
    let times: Vec<u64> =
        MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().log_time).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    // The last outcome ends at three steps of 60.25 s each.
    let end = 180_750_000_000;
    assert!((end..end + 10).contains(times.last().unwrap()));
}

#[test]
fn a_run_told_twice_is_the_same_log() {
    assert!(story::log() == story::log());
}

#[test]
fn the_scene_shows_goals_the_path_and_the_track() {
    let scenes: Vec<SceneUpdate> = all(topic::SCENE);
    assert_eq!(scenes.len(), story::DECISIONS as usize);
    let last = &scenes[2];
    let ids: Vec<&str> = last.entities.iter().map(|entity| entity.id.as_str()).collect();
    assert_eq!(ids, ["goal/G2", "goal/G3", "goal/G4", "path", "track"]);
    assert_eq!(last.entities[0].texts[0].text, "G2 turn 0, prize 0.800");
    assert_eq!(last.entities[1].texts[0].text, "G3 drop: energy");
    assert_ne!(last.entities[0].spheres[0].color, last.entities[1].spheres[0].color);
    let points = |index: usize| -> Vec<(f64, f64)> {
        last.entities[index].lines[0].points.iter().map(|point| (point.x, point.y)).collect()
    };
    // Row 1 of 4 lies 2.5 cells of 2 m north of the south edge.
    assert_eq!(points(3), [(5.0, 5.0), (7.0, 5.0)]);
    assert_eq!(points(4), [(1.0, 5.0), (3.0, 5.0), (5.0, 5.0)]);
    assert!(scenes[0].entities.last().unwrap().lines.is_empty(), "nothing was driven yet");
}

/// Decisions that a log shows a cloud with, of those made on so many versions of the map.
fn clouds(options: Options, versions: &[u64]) -> Vec<u32> {
    let mut writer =
        LogWriter::over(Vec::new(), &story::header(), story::setting(), options).unwrap();
    let interest = story::interest(0);
    let drape = Some(Drape { elevation: &interest, uncertainty: &interest });
    let maps = DecisionMaps { interest: &interest, others: &[], drape };
    for (number, &map_version) in versions.iter().enumerate() {
        let decision = Decision { map_version, ..story::decision(number as u32) };
        writer.decision(&decision, &maps).unwrap();
    }
    let bytes = writer.finish("done", &BTreeMap::new()).unwrap();
    MessageStream::new(&bytes)
        .unwrap()
        .map(|message| message.unwrap())
        .filter(|message| message.channel.topic == topic::CLOUD)
        .map(|message| message.sequence)
        .collect()
}

#[test]
fn the_draped_map_is_shown_when_it_changed_and_not_without_maps() {
    assert_eq!(clouds(Options::default(), &[1, 1, 2, 2, 2, 5]), [0, 2, 5]);
    let lean = Options { maps: MapMode::Digest, ..Options::default() };
    assert!(clouds(lean, &[1, 2]).is_empty());
}

#[test]
fn a_drape_of_another_shape_is_refused() {
    let mut writer =
        LogWriter::over(Vec::new(), &story::header(), story::setting(), Options::default())
            .unwrap();
    let interest = story::interest(0);
    let other = interest.crop(Window { row: 0, col: 0, rows: 2, cols: 2 }).unwrap();
    let drape = Some(Drape { elevation: &interest, uncertainty: &other });
    let maps = DecisionMaps { interest: &interest, others: &[], drape };
    let refused = writer.decision(&story::decision(0), &maps).unwrap_err();
    let LogError::GridMismatch { name, .. } = refused else { panic!("{refused}") };
    assert_eq!(name, "elevation uncertainty");
}

#[test]
fn pose_and_transform_agree() {
    let poses: Vec<PoseInFrame> = all(topic::POSE);
    let transforms: Vec<FrameTransform> = all(topic::TRANSFORM);
    assert_eq!(poses.len(), 2 * story::DECISIONS as usize);
    assert_eq!(poses.len(), transforms.len());
    for (pose, transform) in poses.iter().zip(&transforms) {
        let pose = pose.pose.as_ref().unwrap();
        assert_eq!((pose.position, pose.orientation), (transform.translation, transform.rotation));
        assert_eq!(
            (transform.parent_frame_id.as_str(), transform.child_frame_id.as_str()),
            ("map", "rover")
        );
    }
}

#[test]
fn the_text_log_tells_triggers_and_changes_but_not_what_stayed() {
    let lines: Vec<Log> = all(topic::LOG);
    let first: Vec<&str> = lines[..4].iter().map(|line| line.message.as_str()).collect();
    assert_eq!(
        first,
        [
            "decision 0: start",
            "decision 0: interest-changed (G1: 0.500 -> 0.750)",
            "decision 0: G0 add: new-maximum, energy_j 400.0000 against 350.0000, data_mb 1.0000 against inf",
            "decision 0: G1 drop: energy, energy_j 400.0000 against 350.0000, data_mb 1.0000 against inf",
        ]
    );
    assert_eq!(lines.len(), 4 * story::DECISIONS as usize);
}
