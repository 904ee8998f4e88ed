//! Files that were cut, hurt, killed or refused: never a panic, always the true beginning, always said.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use prost::Message as _;
use wisdom_logbook::read::{Verdict, check_bytes};
use wisdom_logbook::{
    Entry, LogError, LogReader, LogWriter, Options, Status, Store, SyncPolicy, record, topic,
};

use crate::story;

fn is_prefix(part: &[Entry], whole: &[Entry]) -> bool {
    part.len() <= whole.len() && part == &whole[..part.len()]
}

#[test]
fn a_log_cut_at_any_byte_reads_back_its_beginning() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    let mut most = 0;
    for length in 0..bytes.len() {
        let cut = story::read(&bytes[..length]);
        assert!(matches!(cut.status, Status::Truncated { .. }), "at {length}: {:?}", cut.status);
        assert!(is_prefix(&cut.entries, &whole.entries), "at {length}");
        assert!(cut.decisions().count() >= most, "at {length}");
        if cut.decisions().count() == most {
            continue;
        }
        most = cut.decisions().count();
        for (number, topic) in cut.maps() {
            assert_eq!(cut.map(topic, number).unwrap(), whole.map(topic, number).unwrap());
        }
    }
    assert_eq!(most, story::DECISIONS as usize);
}

#[test]
fn a_flipped_bit_anywhere_is_reported() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    for byte in 0..bytes.len() {
        let mut hurt = bytes.clone();
        hurt[byte] ^= 1 << (byte % 8);
        match LogReader::from_bytes(hurt) {
            Err(LogError::NotALog { .. }) => assert!(byte < 8, "at {byte}"),
            Err(error) => panic!("at {byte}: {error}"),
            Ok(read) => {
                assert!(
                    matches!(read.status, Status::Corrupt { .. }),
                    "at {byte}: {:?}",
                    read.status
                );
                assert!(is_prefix(&read.entries, &whole.entries), "at {byte}");
            }
        }
    }
}

/// The story in a container whose chunks are not compressed, so that every kind of record can be found in it.
fn unpacked() -> Vec<u8> {
    let bytes = story::log();
    let log = story::read(&bytes);
    let mut out = io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(None).profile("wisdom");
    let mut writer = options.create(&mut out).unwrap();
    let run =
        mcap::records::Metadata { name: "wisdom.run".to_owned(), metadata: log.metadata.clone() };
    writer.write_metadata(&run).unwrap();
    for attachment in &log.attachments {
        let attachment = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: Cow::Borrowed(&attachment.data),
        };
        writer.attach(&attachment).unwrap();
    }
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let ends = message.channel.topic == topic::DECISION;
        writer.write(&message).unwrap();
        if ends {
            writer.flush().unwrap();
        }
    }
    let end = log.end.unwrap();
    let mut facts = end.facts.clone();
    facts.insert("status".to_owned(), end.status);
    facts.insert("decisions".to_owned(), end.decisions.to_string());
    facts.insert("chain".to_owned(), end.chain);
    let end = mcap::records::Metadata { name: "wisdom.end".to_owned(), metadata: facts };
    writer.write_metadata(&end).unwrap();
    writer.finish().unwrap();
    drop(writer);
    out.into_inner()
}

/// Kind and place of every record, those in chunks too: where its opcode is, and where it ends.
fn records(bytes: &[u8]) -> Vec<(u8, std::ops::Range<usize>)> {
    fn split(bytes: &[u8], mut at: usize, end: usize, out: &mut Vec<(u8, std::ops::Range<usize>)>) {
        while at < end {
            let length: [u8; 8] = bytes[at + 1..at + 9].try_into().unwrap();
            let next = at + 9 + u64::from_le_bytes(length) as usize;
            out.push((bytes[at], at..next));
            if bytes[at] == mcap::records::op::CHUNK {
                // A chunk's header has 40 bytes where no compression is named.
                split(bytes, at + 9 + 40, next, out);
            }
            at = next;
        }
        assert_eq!(at, end);
    }
    let mut out = Vec::new();
    split(bytes, 8, bytes.len() - 8, &mut out);
    out
}

#[test]
fn a_flipped_bit_in_every_kind_of_record_is_reported_by_reader_and_check() {
    use mcap::records::op;
    let bytes = unpacked();
    let name = std::path::Path::new("unpacked.mcap");
    let check = |bytes: &[u8]| check_bytes(name, &mut io::Cursor::new(bytes));
    assert_eq!(story::read(&bytes).status, Status::Complete);
    assert_eq!(check(&bytes).unwrap().status, Status::Complete);
    let mut met = std::collections::BTreeMap::<u8, u32>::new();
    for (kind, place) in records(&bytes) {
        let content = place.start + 9..place.end;
        // Opcode; lowest and highest byte of the length; first, middle and last byte of the content, and in a
        // chunk every byte of its header.
        let mut hit = vec![place.start, place.start + 1, place.start + 8];
        hit.extend([content.start, content.start.midpoint(content.end), content.end - 1]);
        if kind == op::CHUNK {
            hit.extend(content.start..content.start + 40);
        }
        for byte in hit {
            let mut hurt = bytes.clone();
            hurt[byte] ^= 0x10;
            let read = story::read(&hurt);
            assert!(
                matches!(read.status, Status::Corrupt { .. }),
                "kind {kind}, byte {byte}: {:?}",
                read.status
            );
            let found = check(&hurt).unwrap();
            assert!(
                matches!(found.status, Status::Corrupt { .. }),
                "kind {kind}, byte {byte}: {found:?}"
            );
            assert!(
                found.findings.iter().any(|f| matches!(f.verdict, Verdict::Fails(_))),
                "kind {kind}, byte {byte}: {found:?}"
            );
        }
        *met.entry(kind).or_default() += 1;
    }
    let kinds = [
        op::HEADER,
        op::FOOTER,
        op::SCHEMA,
        op::CHANNEL,
        op::MESSAGE,
        op::CHUNK,
        op::MESSAGE_INDEX,
        op::CHUNK_INDEX,
        op::ATTACHMENT,
        op::ATTACHMENT_INDEX,
        op::STATISTICS,
        op::METADATA,
        op::METADATA_INDEX,
        op::SUMMARY_OFFSET,
        op::DATA_END,
    ];
    assert_eq!(met.keys().copied().collect::<Vec<_>>(), kinds, "{met:?}");
}

#[test]
fn a_check_holds_the_summary_against_the_data() {
    let bytes = unpacked();
    let name = std::path::Path::new("unpacked.mcap");
    // Without its checksum, a summary is believed by nobody but for what it says.
    let checksum = bytes.len() - 12..bytes.len() - 8;
    let mut unsummed = bytes.clone();
    unsummed[checksum].fill(0);
    let found = check_bytes(name, &mut io::Cursor::new(&unsummed)).unwrap();
    assert_eq!(found.status, Status::Complete);
    let kinds = [
        (mcap::records::op::STATISTICS, "how many"),
        (mcap::records::op::CHUNK_INDEX, "where the chunks are"),
        (mcap::records::op::ATTACHMENT_INDEX, "where the attachments are"),
        (mcap::records::op::METADATA_INDEX, "where the metadata are"),
        (mcap::records::op::SUMMARY_OFFSET, "where each kind of record"),
    ];
    for (wanted, what) in kinds {
        let (_, place) =
            records(&bytes).into_iter().find(|(kind, _)| *kind == wanted).expect("it is there");
        let mut hurt = unsummed.clone();
        // The first field of each is a number, but that of a summary offset: its second is.
        hurt[place.start + 10] ^= 1;
        let found = check_bytes(name, &mut io::Cursor::new(&hurt)).unwrap();
        let Status::Corrupt { detail, .. } = &found.status else { panic!("{what}: {found:?}") };
        assert!(detail.contains(what), "{detail}");
    }
}

#[test]
fn a_check_finds_time_stamps_that_do_not_rise() {
    let bytes = rewritten(|_| (), Some("/weather"));
    let name = std::path::Path::new("log.mcap");
    let stamps = |bytes: &[u8]| {
        let found = check_bytes(name, &mut io::Cursor::new(bytes)).unwrap();
        let all = found.findings.into_iter().find(|f| f.what == "time stamps rise");
        (all.unwrap().verdict, found.status)
    };
    assert_eq!(stamps(&bytes).0, Verdict::Holds);
    let mut out = io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        message.log_time = message.log_time.min(60_250_000_000);
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let (verdict, status) = stamps(&out.into_inner());
    assert!(matches!(verdict, Verdict::Fails(_)), "{verdict:?}");
    assert!(matches!(status, Status::Corrupt { .. }), "{status:?}");
}

#[test]
fn a_whole_file_with_something_after_it_is_corrupt() {
    let mut bytes = story::log();
    bytes.push(0);
    assert!(matches!(story::read(&bytes).status, Status::Corrupt { .. }));
}

/// The messages of a log, written again by the container's own writer with `change` made to its decisions.
fn rewritten(change: impl Fn(&mut record::Decision), extra: Option<&str>) -> Vec<u8> {
    let bytes = story::log();
    let mut out = io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic == topic::DECISION {
            let mut decision = record::Decision::decode(&message.data[..]).unwrap();
            change(&mut decision);
            message.data = Cow::Owned(decision.encode_to_vec());
        }
        writer.write(&message).unwrap();
    }
    if let Some(topic) = extra {
        let channel = writer.add_channel(0, topic, "json", &BTreeMap::new()).unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: u64::MAX,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, b"{}").unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    out.into_inner()
}

#[test]
fn a_decision_changed_with_good_checksums_breaks_the_chain() {
    let forged = |decision: &mut record::Decision| {
        if decision.number == 1 {
            decision.frame.as_mut().unwrap().seen += 1e-16;
        }
    };
    let log = story::read(&rewritten(forged, None));
    let Status::Corrupt { detail, .. } = &log.status else { panic!("{:?}", log.status) };
    assert_eq!(detail, "decision 1 does not follow from its chain");
    assert_eq!(log.decisions().count(), 1);
}

#[test]
fn a_missing_decision_is_reported() {
    let renumbered = |decision: &mut record::Decision| decision.number *= 2;
    let log = story::read(&rewritten(renumbered, None));
    let Status::Corrupt { detail, .. } = &log.status else { panic!("{:?}", log.status) };
    assert_eq!(detail, "decision 2 where 1 was due");
}

#[test]
fn a_log_without_an_end_is_truncated_and_unknown_topics_are_counted() {
    let log = story::read(&rewritten(|_| (), Some("/weather")));
    let Status::Truncated { detail, .. } = &log.status else { panic!("{:?}", log.status) };
    assert_eq!(detail, "the run did not end: there is no wisdom.end");
    assert_eq!(log.unknown_topics().collect::<Vec<_>>(), [("/weather", 1)]);
    assert_eq!(log.topics[topic::DECISION], u64::from(story::DECISIONS));
}

#[test]
fn another_file_is_not_a_log() {
    let other = LogReader::from_bytes(b"seed = 42, and more\n".to_vec()).unwrap_err();
    assert!(matches!(other, LogError::NotALog { .. }));
}

#[test]
fn a_finished_log_has_its_final_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let part = folder.path().join("run.mcap.part");
    let mut writer =
        LogWriter::create(&path, &story::header(), story::setting(), Options::default()).unwrap();
    story::tell(&mut writer).unwrap();
    assert!(part.exists() && !path.exists());
    assert_eq!(writer.finish("goals-achieved", &BTreeMap::new()).unwrap(), path);
    assert!(!part.exists() && path.exists());
    let log = LogReader::open(&path).unwrap();
    assert_eq!(log.status, Status::Complete);
    assert_eq!(log.entries, story::read(&story::log()).entries);
    assert_eq!(log.map(topic::INTEREST, 1).unwrap(), story::interest(1));
}

#[test]
fn a_log_is_never_written_over() {
    for taken in ["run.mcap", "run.mcap.part"] {
        let folder = tempfile::tempdir().unwrap();
        let in_the_way = folder.path().join(taken);
        fs::write(&in_the_way, "precious").unwrap();
        let path = folder.path().join("run.mcap");
        let refused =
            LogWriter::create(&path, &story::header(), story::setting(), Options::default());
        let Err(LogError::Exists { path }) = refused else { panic!("{taken}") };
        assert_eq!(path, in_the_way);
        assert_eq!(fs::read(&in_the_way).unwrap(), b"precious");
    }
}

#[test]
fn a_log_that_appeared_meanwhile_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let options = Options { sync: SyncPolicy::End, ..Options::default() };
    let writer = LogWriter::create(&path, &story::header(), story::setting(), options).unwrap();
    fs::write(&path, "precious").unwrap();
    assert!(matches!(writer.finish("done", &BTreeMap::new()), Err(LogError::Io { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert!(folder.path().join("run.mcap.part").exists());
}

#[test]
fn a_run_that_is_killed_reads_back_to_its_last_decision() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    for sync in [SyncPolicy::Cycle, SyncPolicy::End] {
        let options = Options { sync, ..Options::default() };
        let mut writer =
            LogWriter::create(&path, &story::header(), story::setting(), options).unwrap();
        story::tell(&mut writer).unwrap();
        // Nothing runs when a process is killed, not even destructors.
        std::mem::forget(writer);
        let part = folder.path().join("run.mcap.part");
        let log = LogReader::open(&part).unwrap();
        assert!(matches!(log.status, Status::Truncated { .. }), "{:?}", log.status);
        assert_eq!(log.decisions().count(), story::DECISIONS as usize);
        assert_eq!(log.attachments.len(), 2);
        assert_eq!(log.end, None);
        fs::remove_file(part).unwrap();
    }
}

#[test]
fn a_writer_that_is_dropped_leaves_a_log_that_did_not_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut writer =
        LogWriter::create(&path, &story::header(), story::setting(), Options::default()).unwrap();
    story::tell(&mut writer).unwrap();
    drop(writer);
    let log = LogReader::open(&folder.path().join("run.mcap.part")).unwrap();
    assert!(matches!(log.status, Status::Truncated { .. }), "{:?}", log.status);
    assert_eq!(log.entries, story::read(&story::log()).entries);
}

/// A disk with room for so many bytes, shared so that it can be looked at after the writer is gone.
#[derive(Clone)]
struct SmallDisk {
    room: usize,
    kept: std::rc::Rc<std::cell::RefCell<Vec<u8>>>,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut kept = self.kept.borrow_mut();
        let fits = bytes.len().min(self.room - kept.len());
        if fits == 0 && !bytes.is_empty() {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        kept.extend_from_slice(&bytes[..fits]);
        Ok(fits)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Store for SmallDisk {
    type Closed = ();

    fn name(&self) -> PathBuf {
        PathBuf::from("small-disk.mcap.part")
    }

    fn close(self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_ends_the_run_with_an_error_and_keeps_what_was_written() {
    let whole = story::read(&story::log());
    let size = story::log().len();
    let mut most = 0;
    for room in (0..size).step_by(97).chain([size - 1]) {
        let disk = SmallDisk { room, kept: std::rc::Rc::default() };
        let (header, setting) = (story::header(), story::setting());
        let told = LogWriter::over(disk.clone(), &header, setting, Options::default())
            .and_then(|mut writer| {
                story::tell(&mut writer)?;
                writer.finish("goals-achieved", &BTreeMap::new())
            })
            .unwrap_err();
        let LogError::Io { path, source } = &told else { panic!("{room}: {told}") };
        assert_eq!(path, &disk.name());
        assert_eq!(source.kind(), io::ErrorKind::StorageFull, "{room}");
        let kept = story::read(&disk.kept.borrow());
        assert!(matches!(kept.status, Status::Truncated { .. }), "{room}: {:?}", kept.status);
        assert!(is_prefix(&kept.entries, &whole.entries), "{room}");
        most = most.max(kept.decisions().count());
    }
    assert_eq!(most, story::DECISIONS as usize);
}

#[test]
fn a_writer_goes_on_refusing_after_its_disk_was_full() {
    let disk = SmallDisk { room: 2_000, kept: std::rc::Rc::default() };
    let (header, setting) = (story::header(), story::setting());
    let mut writer = LogWriter::over(disk.clone(), &header, setting, Options::default()).unwrap();
    assert!(story::tell(&mut writer).is_err());
    let kept = disk.kept.borrow().clone();
    assert!(story::tell(&mut writer).is_err());
    assert!(writer.finish("goals-achieved", &BTreeMap::new()).is_err());
    assert_eq!(*disk.kept.borrow(), kept);
}

#[cfg(target_os = "linux")]
#[test]
fn the_operating_systems_full_device_is_an_error_too() {
    struct Full(fs::File);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }
    impl Store for Full {
        type Closed = ();
        fn name(&self) -> PathBuf {
            PathBuf::from("/dev/full")
        }
        fn close(self) -> io::Result<()> {
            Ok(())
        }
    }
    let device = Full(fs::File::options().write(true).open("/dev/full").unwrap());
    let refused = LogWriter::over(device, &story::header(), story::setting(), Options::default());
    let Err(LogError::Io { path, source }) = refused else { panic!("a full device took a log") };
    assert_eq!(path, PathBuf::from("/dev/full"));
    assert_eq!(source.kind(), io::ErrorKind::StorageFull);
}

/// What is on disk when a run is killed: no end, no footer, no checksum over all data.
fn killed() -> Vec<u8> {
    let disk = SmallDisk { room: usize::MAX, kept: std::rc::Rc::default() };
    let (header, setting) = (story::header(), story::setting());
    let mut writer = LogWriter::over(disk.clone(), &header, setting, Options::default()).unwrap();
    story::tell(&mut writer).unwrap();
    std::mem::forget(writer);
    disk.kept.take()
}

#[test]
fn in_a_file_without_an_end_a_record_of_another_kind_is_no_less_reported() {
    let bytes = killed();
    let whole = story::read(&bytes);
    assert!(matches!(whole.status, Status::Truncated { .. }));
    assert_eq!(whole.decisions().count(), story::DECISIONS as usize);
    let mut at = 8;
    let mut kinds = std::collections::BTreeSet::new();
    while at < bytes.len() {
        kinds.insert(bytes[at]);
        for bit in 0..8 {
            let mut hurt = bytes.clone();
            hurt[at] ^= 1 << bit;
            let read = story::read(&hurt);
            let corrupt = matches!(read.status, Status::Corrupt { .. });
            assert!(corrupt, "kind {:#04x} as {:#04x} at {at}", bytes[at], hurt[at]);
            let mut saved = Vec::new();
            let mut hurt = io::Cursor::new(hurt);
            let into = wisdom_logbook::recover_into(&PathBuf::from("hurt"), &mut hurt, Vec::new());
            if let Ok((recovery, out)) = into {
                assert!(recovery.lossy, "at {at}");
                saved = out;
            }
            if !saved.is_empty() {
                assert!(is_prefix(&story::read(&saved).entries, &whole.entries), "at {at}");
            }
        }
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        at += 9 + length as usize;
    }
    // Header, chunk, message index, attachment, metadata.
    assert!([0x01, 0x06, 0x07, 0x09, 0x0c].iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
}

#[test]
fn an_observation_of_nothing_but_empty_windows_is_refused_before_it_fills_memory() {
    let bytes = story::log();
    let mut out = io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic == topic::OBSERVATION {
            // Field 4, no bytes, again and again.
            message.data = Cow::Owned([0x22, 0x00].repeat(200_000));
        }
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let log = story::read(&out.into_inner());
    let Status::Corrupt { detail, .. } = &log.status else { panic!("{:?}", log.status) };
    assert!(detail.contains("no record is like that"), "{detail}");
}
