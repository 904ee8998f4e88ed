//! Later versions must still read the committed sample log; those whose decisions mean the same decide it again.

use std::path::Path;

use wisdom_logbook::{LogReader, Status, record};

#[test]
fn the_sample_log_reads_back_whole() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("logs/sample/paper-0.1.0.mcap");
    let log = LogReader::open(&path).expect("the sample is a log");
    assert_eq!(log.status, Status::Complete);
    assert_eq!(log.metadata["mission"], "paper");
    let end = log.end.as_ref().expect("the run ended");
    assert_eq!(end.decisions as usize, log.decisions().count());
    assert!(log.decisions().count() >= 3);
    let unknown: Vec<_> = log.unknown_topics().collect();
    assert!(unknown.is_empty(), "{unknown:?}");
    let interest = log.map("/map/interest", 0).expect("a map");
    assert_eq!((interest.spec().rows(), interest.spec().cols()), (101, 101));

    let versions: Vec<u32> = log.decisions().map(|d| d.decision_version).collect();
    if versions.iter().all(|v| *v == record::DECISION_VERSION) {
        let verified =
            wisdom_logbook::verify(&path, &mut |_| {}).expect("the mission inside loads");
        assert_eq!(
            verified.difference, None,
            "decisions changed: raise DECISION_VERSION and say why"
        );
    }
}
