//! How much of the maps a log holds: less to write, nothing lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use wisdom_logbook::{
    LogReader, LogWriter, MapMode, Options, Reel, Setting, Status, SyncPolicy, VerifyLevel, expand,
    topic, verify,
};
use wisdom_mission::{Mission, Override};

fn mission() -> Mission {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper");
    let changes = [
        Override::new("goals.expansions", "2000"),
        Override::new("goals.max-sequenced", "8"),
        Override::new("budget.energy-j", "9e5"),
    ];
    Mission::load(&folder, &changes).expect("the mission loads")
}

fn run(folder: &Path, maps: MapMode) -> PathBuf {
    let mission = mission();
    let path = folder.join(format!("{maps}.mcap"));
    let options = Options { sync: SyncPolicy::End, maps };
    let mut log = wisdom_logbook::begin(&path, &mission, options).expect("a new log");
    let summary = wisdom_mission::run(&mission, &mut log, &mut |_| true).expect("it runs");
    log.finish(&summary.status.to_string(), &BTreeMap::new()).expect("it is closed")
}

fn open(path: &Path) -> LogReader {
    LogReader::open(path).expect("a log")
}

fn decided(log: &LogReader) -> u32 {
    log.decisions().count() as u32
}

#[test]
fn patches_and_digests_are_expanded_to_the_bytes_of_a_full_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let logs = MapMode::ALL.map(|mode| run(folder.path(), mode));
    let [full, patch, digest] = logs.clone().map(|path| fs::read(path).expect("it is there"));
    assert!(digest.len() < patch.len() && patch.len() < full.len());
    for path in &logs {
        let log = open(path);
        assert_eq!(log.status, Status::Complete);
        let verified = verify(path, VerifyLevel::Resimulate, &mut |_| {}).expect("it can be told");
        assert!(verified.holds(), "{path:?}: {verified:?}");
        let mode = &log.metadata["maps"];
        // Elevation once, and the interest of each decision where it is told.
        let maps = if mode == "digest" { 0 } else { decided(&log) + 1 };
        assert_eq!(verified.maps, maps, "{mode}");

        let expanded = folder.path().join(format!("{mode}-expanded.mcap"));
        let mut told = 0;
        expand(&log, &expanded, MapMode::Full, &[], &mut |_| told += 1)
            .expect("it follows from its inputs");
        assert_eq!(told, decided(&log));
        assert!(fs::read(&expanded).expect("it is there") == full, "{mode}");
    }
}

#[test]
fn patches_put_together_are_the_whole_maps_in_any_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let (full, patch) = (run(folder.path(), MapMode::Full), run(folder.path(), MapMode::Patch));
    let (full, patch) = (open(&full), open(&patch));
    let patches = patch.maps().filter(|(_, name)| *name == topic::PATCH).count();
    assert!(patches > 3, "{patches} patches");
    let mut reel = Reel::new();
    for number in (0..decided(&full)).chain((0..decided(&full)).rev()) {
        let whole = full.map(topic::INTEREST, number).expect("a whole map");
        let turned = reel.turn_to(&patch, number).expect("patches fit").expect("a map");
        assert!(*turned == whole, "decision {number}");
        assert!(patch.interest(number).expect("patches fit") == Some(whole));
    }
}

#[test]
fn other_planes_are_made_on_demand_and_an_unknown_one_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = open(&run(folder.path(), MapMode::Digest));
    assert_eq!(log.maps().count(), 0);
    let to = folder.path().join("more.mcap");
    let refused =
        expand(&log, &to, MapMode::Full, &["intrest".to_owned()], &mut |_| {}).expect_err("a slip");
    assert!(refused.to_string().contains("`intrest`"), "{refused}");
    assert!(!to.exists() && !folder.path().join("more.mcap.part").exists());

    let planes = ["ignorance", "temperature-u", "reliability", "credit-dem"].map(str::to_owned);
    let mut sizes = Vec::new();
    for maps in [MapMode::Full, MapMode::Patch] {
        let to = folder.path().join(format!("{maps}.mcap"));
        expand(&log, &to, maps, &planes, &mut |_| {}).expect("they are planes");
        sizes.push(fs::metadata(&to).expect("it is there").len());
        let more = open(&to);
        let mut reels = planes.each_ref().map(|name| Reel::of(name));
        for number in 0..decided(&log) {
            let past =
                wisdom_logbook::derive_at(&log, number).expect("it follows").expect("it is there");
            for (name, reel) in planes.iter().zip(&mut reels) {
                let written = reel.turn_to(&more, number).expect("they fit").expect("a plane");
                let derived = wisdom_logbook::plane(&past.rover, name).expect("a plane");
                assert!(*written == *derived, "{name} of decision {number}, {maps}");
            }
        }
        let verified = verify(&to, VerifyLevel::Redecide, &mut |_| {}).expect("it can be told");
        assert!(verified.holds(), "{maps}");
    }
    assert!(2 * sizes[1] < sizes[0], "patches save more than half: {sizes:?}");
}

#[test]
fn a_log_whose_run_did_not_end_is_expanded_to_one_that_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let mission = mission();
    let path = folder.path().join("cut.mcap");
    let options = Options { maps: MapMode::Patch, ..Options::default() };
    let setting = Setting::from(&mission.spec);
    let header = wisdom_logbook::header(&mission);
    let mut log = LogWriter::create(&path, &header, setting, options).expect("a new log");
    let mut decisions = 0;
    wisdom_mission::run(&mission, &mut log, &mut |progress| {
        decisions += u32::from(progress.decision.is_some());
        decisions < 3
    })
    .expect("it runs");
    drop(log);
    let cut = open(&folder.path().join("cut.mcap.part"));
    let to = folder.path().join("expanded.mcap");
    expand(&cut, &to, MapMode::Full, &[], &mut |_| {}).expect("what there is follows");
    let expanded = open(&to);
    assert!(matches!(expanded.status, Status::Truncated { .. }), "{:?}", expanded.status);
    assert_eq!(expanded.entries, cut.entries);
    assert_eq!(decided(&expanded), 3);
}
