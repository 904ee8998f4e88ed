//! What is left of a broken log can be saved: all of it before the fault, nothing after, and it says so.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor};
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader};
use proptest::prelude::*;
use wisdom_logbook::read::check_bytes;
use wisdom_logbook::{
    IndexedLog, LogError, LogReader, RECOVERED, Recovery, Status, recover, recover_into, topic,
};

use crate::story;

fn saved(bytes: &[u8]) -> Result<(Recovery, Vec<u8>), LogError> {
    recover_into(Path::new("broken.mcap"), &mut Cursor::new(bytes), Vec::new())
}

fn indexed(bytes: &[u8]) -> Result<IndexedLog<Cursor<&[u8]>>, LogError> {
    IndexedLog::over(Path::new("broken.mcap"), Cursor::new(bytes))
}

/// Channel, number, both time stamps and bytes of every message of a whole container, and its metadata.
fn messages(bytes: &[u8]) -> (Vec<(MessageHeader, Vec<u8>)>, Vec<String>) {
    let (mut messages, mut names) = (Vec::new(), Vec::new());
    let (mut reader, mut source) = (LinearReader::new(), bytes);
    while let Some(event) = reader.next_event() {
        match event.unwrap() {
            LinearReadEvent::ReadRequest(need) => {
                let read = io::Read::read(&mut source, reader.insert(need)).unwrap();
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => {
                match mcap::parse_record(opcode, data).unwrap() {
                    Record::Message { header, data } => messages.push((header, data.into_owned())),
                    Record::Metadata(metadata) => names.push(metadata.name),
                    _ => {}
                }
            }
        }
    }
    (messages, names)
}

#[test]
fn what_a_cut_at_any_byte_leaves_is_saved() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    let (all, _) = messages(&bytes);
    let (mut kept_before, mut most) = (None, 0);
    for length in 0..=bytes.len() {
        let part = &bytes[..length];
        let (recovery, out) = saved(part).unwrap();
        assert!(recovery.decisions >= most, "at {length}");
        most = recovery.decisions;
        let ended = recovery.ended;
        // Of an empty file nothing is left out, and all is lost.
        assert_eq!(recovery.left_out > 0 || length == 0, recovery.lossy, "at {length}");
        // What is kept only changes where one more record is whole; between, the same need not be read again.
        if kept_before.replace((recovery.kept_to, ended)) == Some((recovery.kept_to, ended)) {
            continue;
        }
        let before = story::read(part);
        assert_eq!(recovery.status, before.status, "at {length}");
        assert_eq!(recovery.decisions as usize, before.decisions().count(), "at {length}");
        assert_eq!(ended, before.end.is_some(), "at {length}");
        let after = story::read(&out);
        assert_eq!(after.entries, before.entries, "at {length}");
        assert_eq!(after.metadata, before.metadata, "at {length}");
        assert_eq!(after.attachments, before.attachments, "at {length}");
        assert_eq!(after.topics, before.topics, "at {length}");
        // Only the run's own end makes a log complete, and what was lost is said.
        assert_eq!(after.end, before.end, "at {length}");
        assert_eq!(after.status == Status::Complete, ended, "at {length}: {:?}", after.status);
        assert!(ended || matches!(after.status, Status::Truncated { .. }), "at {length}");
        let (kept, names) = messages(&out);
        assert_eq!(kept[..], all[..kept.len()], "at {length}");
        assert_eq!(names.contains(&RECOVERED.to_owned()), !ended, "at {length}");
        let found = check_bytes(Path::new("saved.mcap"), &mut Cursor::new(&out)).unwrap();
        assert_eq!(found.status, after.status, "at {length}");
    }
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(recovery.ended && !recovery.lossy);
    assert_eq!(story::read(&out).entries, whole.entries);
}

#[test]
fn a_log_cut_at_any_byte_opens_by_index_or_without() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    for length in 0..=bytes.len() {
        let part = &bytes[..length];
        let mut opened = indexed(part).unwrap();
        assert_eq!(opened.without_index.is_none(), length == bytes.len(), "at {length}");
        assert!(opened.metadata.is_empty() || opened.metadata == whole.metadata, "at {length}");
        // Answers without an index read everything: now and then is enough, and where the file ends.
        if length % 61 != 0 && length + 200 < bytes.len() {
            continue;
        }
        let found = opened.contents().unwrap().decisions();
        let last = u32::try_from(found).unwrap();
        if let Some(number) = last.checked_sub(1) {
            let decision = opened.decision(number).unwrap();
            assert_eq!(Some(&decision), whole.decisions().nth(number as usize), "at {length}");
        }
        let next = opened.decision(last).unwrap_err();
        assert!(matches!(next, LogError::NoDecision { found: f, .. } if f == found), "{next}");
    }
}

#[test]
fn a_hole_ends_what_is_saved_and_is_measured() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    // A bit in the second chunk, which is that of decision 1: packed records begin with the mark of zstd.
    let packed = bytes.windows(4).enumerate().filter(|(_, four)| *four == [0x28, 0xb5, 0x2f, 0xfd]);
    let chunk = packed.map(|(at, _)| at).nth(1).unwrap() + 50;
    let mut hurt = bytes.clone();
    hurt[chunk] ^= 4;
    let before = story::read(&hurt);
    assert!(matches!(before.status, Status::Corrupt { .. }));
    let (recovery, out) = saved(&hurt).unwrap();
    assert!(recovery.lossy && !recovery.ended);
    assert!(recovery.kept_to < chunk as u64);
    assert_eq!(recovery.kept_to + recovery.left_out, bytes.len() as u64);
    let after = story::read(&out);
    assert!(matches!(after.status, Status::Truncated { .. }), "{:?}", after.status);
    assert_eq!(after.entries[..], whole.entries[..after.entries.len()]);
    assert!(after.decisions().count() >= 1);
    assert!(after.status.to_string().contains("left out"), "{}", after.status);
    // Saving again loses nothing more, and says nothing new.
    let (again, twice) = saved(&out).unwrap();
    assert!(!again.lossy);
    assert_eq!(messages(&twice), messages(&out));
}

#[test]
fn doubt_about_what_has_no_checksum_of_its_own_is_a_loss() {
    let mut bytes = story::log();
    let seed = bytes.windows(4).position(|four| four == b"seed").unwrap();
    bytes[seed] ^= 1;
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(recovery.lossy && !recovery.ended, "{recovery:?}");
    assert_eq!(recovery.left_out, 0);
    let after = story::read(&out);
    assert!(matches!(after.status, Status::Truncated { .. }), "{:?}", after.status);
    assert_eq!(after.decisions().count(), story::DECISIONS as usize);
}

#[test]
fn a_broken_summary_costs_nothing() {
    let mut bytes = story::log();
    let end = bytes.len();
    bytes[end - 60] ^= 1;
    assert!(matches!(story::read(&bytes).status, Status::Corrupt { .. }));
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(recovery.ended && !recovery.lossy && recovery.left_out == 0, "{recovery:?}");
    assert_eq!(story::read(&out).status, Status::Complete);
}

#[test]
fn nothing_is_ever_saved_over_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let (log, taken) = (folder.path().join("log.mcap"), folder.path().join("taken.mcap"));
    fs::write(&log, &story::log()[..3000]).unwrap();
    fs::write(&taken, "precious").unwrap();
    for to in [&taken, &log] {
        let before = fs::read(to).unwrap();
        let refused = recover(&log, to).unwrap_err();
        assert!(matches!(refused, LogError::Exists { .. }), "{refused}");
        assert_eq!(fs::read(to).unwrap(), before);
    }
    let other = folder.path().join("other.txt");
    fs::write(&other, "no log at all, but long enough to be one").unwrap();
    let to = folder.path().join("new.mcap");
    assert!(matches!(recover(&other, &to).unwrap_err(), LogError::NotALog { .. }));
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().path()).collect();
    assert_eq!(names.len(), 3, "what was begun is removed: {names:?}");
    let recovery = recover(&log, &to).unwrap();
    assert!(recovery.lossy);
    assert!(matches!(LogReader::open(&to).unwrap().status, Status::Truncated { .. }));
}

/// Whatever the bytes, everything that reads them answers.
fn all_answer(bytes: &[u8]) {
    let name = Path::new("fuzz.mcap");
    let read = LogReader::from_bytes(bytes.to_vec());
    let checked = check_bytes(name, &mut Cursor::new(bytes));
    let rescued = saved(bytes);
    if let Ok(mut log) = indexed(bytes) {
        for number in 0..4 {
            let _answered = log.decision(number);
            let _answered = log.cycle(number, &mut |_| std::ops::ControlFlow::Continue(()));
        }
        let _answered = log.contents();
        let _answered = log.attachment("mission.toml");
    }
    assert_eq!(read.is_ok(), checked.is_ok());
    assert_eq!(read.is_ok(), rescued.is_ok());
    if let (Ok(read), Ok((recovery, out))) = (read, rescued) {
        for (decision, topic) in read.maps() {
            let _answered = read.map(topic, decision);
        }
        let after = story::read(&out);
        assert_eq!(after.entries, read.entries, "{recovery:?}");
        assert!(!matches!(after.status, Status::Corrupt { .. }), "{:?}", after.status);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..2000),
        with_magic in any::<bool>(),
    ) {
        let mut bytes = bytes;
        if with_magic {
            bytes.splice(..0, mcap::MAGIC.iter().copied());
        }
        all_answer(&bytes);
    }

    #[test]
    fn frames_of_random_records_never_panic(
        frames in prop::collection::vec((0..=20_u8, prop::collection::vec(any::<u8>(), 0..80)), 0..12),
        ended in any::<bool>(),
    ) {
        let mut bytes = mcap::MAGIC.to_vec();
        for (kind, body) in frames {
            bytes.push(kind);
            bytes.extend((body.len() as u64).to_le_bytes());
            bytes.extend(body);
        }
        if ended {
            bytes.extend(mcap::MAGIC);
        }
        all_answer(&bytes);
    }

    #[test]
    fn mutations_of_a_good_log_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..6),
    ) {
        let mut bytes = story::log();
        for (place, value, kind) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = place.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => { bytes.remove(at); }
                _ => { bytes.drain(at..(at + usize::from(value)).min(bytes.len())); }
            }
        }
        all_answer(&bytes);
    }
}

#[test]
#[expect(clippy::default_trait_access, reason = "the container's library keeps the type to itself")]
fn topics_of_others_are_saved_too() {
    let bytes = story::log();
    let mut out = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    let channel = writer.add_channel(0, "/weather", "json", &BTreeMap::new()).unwrap();
    let header =
        MessageHeader { channel_id: channel, sequence: 9, log_time: u64::MAX, publish_time: 5 };
    writer.write_to_known_channel(&header, b"{\"wind\": 3}").unwrap();
    writer.write_private_record(0x90, b"ours alone", Default::default()).unwrap();
    writer.finish().unwrap();
    drop(writer);
    let foreign = out.into_inner();
    let (recovery, kept) = saved(&foreign[..foreign.len() - 40]).unwrap();
    assert!(!recovery.ended);
    assert_eq!(messages(&kept).0, messages(&foreign).0);
    assert!(kept.windows(10).any(|ten| ten == b"ours alone"));
    let log = story::read(&kept);
    assert_eq!(log.unknown_topics().collect::<Vec<_>>(), [("/weather", 1)]);
    assert_eq!(log.topics[topic::DECISION], u64::from(story::DECISIONS));
}
