//! What is said of two runs is what differs between them.

use std::collections::BTreeMap;

use wisdom_logbook::comparison::{divergence, inputs, merge, partings};
use wisdom_logbook::{LogError, LogReader, LogWriter, Options, RunHeader};

use crate::story;

/// A log of some observations with other facts, files and readings than the story's.
fn told(change: impl Fn(&mut RunHeader), seen: &[f32]) -> LogReader {
    let mut header = story::header();
    change(&mut header);
    let options = Options::default();
    let mut log = LogWriter::over(Vec::new(), &header, story::setting(), options).unwrap();
    for (number, value) in (0..).zip(seen) {
        let mut observation = story::observation(number);
        observation.windows[0].values[2] = *value;
        log.observation(&observation).unwrap();
    }
    LogReader::from_bytes(log.finish("done", &BTreeMap::new()).unwrap()).unwrap()
}

#[test]
fn runs_that_were_given_and_told_the_same_have_equal_inputs() {
    let runs = [(); 2].map(|()| told(|_| {}, &[1.0, 2.0]));
    let found = inputs(&runs[0], &runs[1]);
    assert!(found.are_equal() && !found.differ_in_rule_alone());
    assert_eq!((found.same_files, found.observations, found.messages), (2, None, None));
}

#[test]
fn facts_files_and_the_first_reading_that_differ_are_named() {
    let ruled = |rule: &'static str, file: &'static str| {
        move |header: &mut RunHeader| {
            header.metadata.insert("rule".to_owned(), rule.to_owned());
            header.attachments[0].2 = file.as_bytes().to_vec();
        }
    };
    let a = told(ruled("dsmc", "seed = 42\nrule = \"dsmc\"\n"), &[1.0, 2.0, 3.0]);
    let b = told(ruled("pcr6", "seed = 42\nrule = \"pcr6\"\n"), &[1.0, 2.5, 3.5]);
    let found = inputs(&a, &b);
    assert!(!found.are_equal() && found.differ_in_rule_alone());
    let fact = &found.facts[0];
    assert_eq!(
        (found.facts.len(), fact.name.as_str(), fact.right.as_deref()),
        (1, "rule", Some("pcr6"))
    );
    let file = &found.files[0];
    assert_eq!((found.files.len(), file.name.as_str(), file.keys.len()), (1, "mission.toml", 1));
    assert_eq!(file.keys[0].key, "rule");
    assert_ne!(file.left, file.right);
    let told_apart = found.observations.unwrap();
    assert_eq!((told_apart.number, told_apart.what.as_str()), (1, "readings of elevation"));
    assert_eq!(told_apart.after_decision, None);

    let more = told(ruled("dsmc", "seed = 43\nrule = \"dsmc\"\n"), &[1.0, 2.0]);
    let found = inputs(&a, &more);
    assert!(!found.differ_in_rule_alone(), "the seed in the file differs too");
    let told_apart = found.observations.unwrap();
    assert_eq!((told_apart.number, told_apart.what.as_str()), (2, "only the left run has it"));
}

#[test]
fn a_run_does_not_part_from_itself_and_parts_from_a_shorter_one_where_that_ends() {
    let whole = story::read(&story::log());
    assert_eq!(divergence(&whole, &whole, 0.0), None);
    assert_eq!(partings(&whole, &whole, 0.0), [None; story::DECISIONS as usize]);
    let none = told(|_| {}, &[1.0]);
    let found = divergence(&none, &whole, 0.0).unwrap();
    assert_eq!((found.decision, found.parting, found.left), (0, None, None));
    assert!(found.right.is_some());
}

#[test]
fn a_merge_that_fails_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let [log, out] = ["log.mcap", "out.mcap"].map(|name| folder.path().join(name));
    std::fs::write(&log, story::log()).unwrap();
    let missing = folder.path().join("missing.mcap");
    assert!(
        matches!(merge(&out, &[&log, &missing]), Err(LogError::Io { path, .. }) if path == missing)
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let merged = merge(&out, &[&log, &log]).unwrap();
    assert_eq!(merged.messages[0], merged.messages[1]);
    assert!(merged.messages[0] > u64::from(story::DECISIONS));
    assert!(matches!(merge(&out, &[&log]), Err(LogError::Exists { .. })));
}

#[test]
fn a_cut_log_is_merged_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, cut, out] = ["a.mcap", "b.mcap", "out.mcap"].map(|name| folder.path().join(name));
    let bytes = story::log();
    let messages = |bytes: &[u8]| story::read(bytes).topics.values().sum::<u64>();
    let all = messages(&bytes);
    let some = |length: &usize| (1..all).contains(&messages(&bytes[..*length]));
    let length = (0..bytes.len()).step_by(16).find(some).unwrap();
    std::fs::write(&whole, &bytes).unwrap();
    std::fs::write(&cut, &bytes[..length]).unwrap();
    let merged = merge(&out, &[&whole, &cut]).unwrap();
    assert_eq!(merged.messages, [all, messages(&bytes[..length])]);
}
