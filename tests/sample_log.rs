//! Later versions must still read the committed sample logs; those whose decisions mean the same decide them again.

use std::path::{Path, PathBuf};

use wisdom_logbook::{LogReader, Status, VerifyLevel, record};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("logs/sample").join(name)
}

#[test]
fn sample_logs_of_every_version_read_back_whole() {
    for name in [
        "paper-0.1.0.mcap",
        "paper-decisions-2.mcap",
        "paper-decisions-3.mcap",
        "paper-decisions-4.mcap",
        "paper-decisions-5.mcap",
    ] {
        let log = LogReader::open(&sample(name)).expect("the sample is a log");
        assert_eq!(log.status, Status::Complete, "{name}");
        assert_eq!(log.metadata["mission"], "paper");
        let end = log.end.as_ref().expect("the run ended");
        assert_eq!(end.decisions as usize, log.decisions().count());
        assert!(log.decisions().count() >= 3);
        let unknown: Vec<_> = log.unknown_topics().collect();
        assert!(unknown.is_empty(), "{name}: {unknown:?}");
        let interest = log.map("/map/interest", 0).expect("a map");
        assert_eq!((interest.spec().rows(), interest.spec().cols()), (101, 101));
    }
}

#[test]
fn the_newest_sample_is_decided_again() {
    let path = sample("paper-decisions-5.mcap");
    let log = LogReader::open(&path).expect("the sample is a log");
    let versions: Vec<u32> = log.decisions().map(|d| d.decision_version).collect();
    assert!(
        versions.iter().all(|v| *v == record::DECISION_VERSION),
        "DECISION_VERSION was raised: add a sample made with it"
    );
    let verified = wisdom_logbook::verify(&path, VerifyLevel::Redecide, &mut |_| {})
        .expect("the mission inside loads");
    assert_eq!(verified.difference, None, "decisions changed: raise DECISION_VERSION and say why");
}

#[test]
fn logs_that_another_version_decided_are_not_comparable_whatever_is_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["paper-0.1.0.mcap", "paper-decisions-2.mcap", "paper-decisions-4.mcap"] {
        let path = sample(name);
        let verified = wisdom_logbook::verify(&path, VerifyLevel::Redecide, &mut |_| {});
        let verified = verified.expect("the mission inside loads");
        assert!(verified.not_comparable.is_some() && verified.difference.is_none(), "{name}");
        let path = path.to_str().expect("UTF-8");
        let out = folder.path().join("out.mcap");
        let out = out.to_str().expect("UTF-8");
        for args in [
            &["verify", path][..],
            &["redecide", path, "--rule", "pcr6"],
            &["explain", path],
            &["log", "expand", path, out],
        ] {
            let output = std::process::Command::new(env!("CARGO_BIN_EXE_wisdom"))
                .args(args)
                .output()
                .expect("the command runs");
            let told = [&output.stdout[..], &output.stderr[..]].concat();
            let told = String::from_utf8_lossy(&told).into_owned();
            assert_eq!(output.status.code(), Some(2), "{args:?}: {told}");
            assert!(told.contains("not comparable"), "{args:?}: {told}");
        }
        assert!(!std::path::Path::new(out).exists());
    }
}
