//! A whole log opens by its index: little is read, little is held, and it is the same as reading everything.

use std::cell::Cell;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;

use wisdom_grid::{GridSpec, Raster};
use wisdom_logbook::{
    DecisionMaps, IndexedLog, Item, LogError, LogWriter, Options, Setting, topic,
};

use crate::story;

/// Counts what is read of a file, and the largest piece asked for at once.
#[derive(Clone)]
struct Counting {
    bytes: Rc<Vec<u8>>,
    at: u64,
    read: Rc<Cell<u64>>,
    largest: Rc<Cell<usize>>,
}

impl Counting {
    fn new(bytes: Vec<u8>) -> Self {
        Self { bytes: Rc::new(bytes), at: 0, read: Rc::default(), largest: Rc::default() }
    }
}

impl Read for Counting {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = &self.bytes[(self.at as usize).min(self.bytes.len())..];
        let read = buffer.len().min(rest.len());
        buffer[..read].copy_from_slice(&rest[..read]);
        self.at += read as u64;
        self.read.set(self.read.get() + read as u64);
        self.largest.set(self.largest.get().max(buffer.len()));
        Ok(read)
    }
}

impl Seek for Counting {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let mut cursor = Cursor::new(&self.bytes[..]);
        cursor.set_position(self.at);
        self.at = cursor.seek(to)?;
        Ok(self.at)
    }
}

/// A log of many maps that do not compress.
fn noisy_log(decisions: u32, side: usize) -> Vec<u8> {
    let setting = Setting { grid: GridSpec::new(side, side, 2.0).unwrap(), ..story::setting() };
    let grid = setting.grid;
    let mut writer =
        LogWriter::over(Vec::new(), &story::header(), setting, Options::default()).unwrap();
    let mut state = 1_u64;
    for number in 0..decisions {
        let interest = Raster::from_fn(grid, |_| {
            // Knuth's linear congruential generator; its upper bits are noise enough.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f32 / (1 << 24) as f32
        });
        writer.observation(&story::observation(number)).unwrap();
        let maps = DecisionMaps { interest: &interest, others: &[], drape: None };
        writer.decision(&story::decision(number), &maps).unwrap();
    }
    writer.finish("done", &std::collections::BTreeMap::new()).unwrap()
}

#[test]
fn the_first_and_last_decisions_of_a_large_log_are_read_from_one_chunk_each() {
    let decisions = 120;
    let bytes = noisy_log(decisions, 256);
    let whole = bytes.len() as u64;
    assert!(whole > 25_000_000, "{whole}");
    let source = Counting::new(bytes);
    let mut log = IndexedLog::over(Path::new("large.mcap"), source.clone()).unwrap();
    let opened = source.read.get();
    assert!(opened * 100 < whole, "{opened} of {whole} bytes to open it");
    assert_eq!(log.contents().unwrap().decisions(), u64::from(decisions));
    assert_eq!(log.metadata["seed"], "42");
    for number in [0, decisions - 1] {
        source.read.set(0);
        assert_eq!(log.decision(number).unwrap().number, number);
        // A chunk holds one map of 256 x 256 cells and what goes with it.
        let read = source.read.get();
        assert!(read * 100 < whole, "{read} of {whole} bytes for decision {number}");
    }
    // One chunk packed at most is asked of the file at a time, with the slack a growing buffer has.
    assert!(source.largest.get() <= 2 * 256 * 256 * 4, "{}", source.largest.get());
}

#[test]
fn without_a_footer_reading_stops_where_the_answer_is() {
    let mut bytes = noisy_log(20, 128);
    bytes.truncate(bytes.len() - 100);
    let whole = bytes.len() as u64;
    let source = Counting::new(bytes);
    let mut log = IndexedLog::over(Path::new("cut.mcap"), source.clone()).unwrap();
    assert!(log.without_index.is_some());
    assert_eq!((log.metadata["seed"].as_str(), log.attachments.len()), ("42", 2));
    assert_eq!(log.decision(0).unwrap().number, 0);
    assert!(source.read.get() * 5 < whole, "{} of {whole}", source.read.get());
    assert_eq!(log.contents().unwrap().decisions(), 20);
    assert!(matches!(log.decision(20), Err(LogError::NoDecision { found: 20, .. })));
}

#[test]
fn the_index_tells_what_the_whole_log_does() {
    let bytes = story::log();
    let whole = story::read(&bytes);
    let mut log = IndexedLog::over(Path::new("log.mcap"), Cursor::new(&bytes)).unwrap();
    assert_eq!(log.without_index, None);
    assert_eq!(log.metadata, whole.metadata);
    let contents = log.contents().unwrap();
    assert_eq!(contents.topics, whole.topics);
    assert_eq!((contents.end, contents.status), (whole.end.clone(), None));
    for attachment in &whole.attachments {
        assert_eq!(log.attachment(&attachment.name).unwrap().as_ref(), Some(attachment));
        let listed = log.attachments.iter().find(|at| at.name == attachment.name).unwrap();
        assert_eq!(listed.bytes, attachment.data.len() as u64);
    }
    assert_eq!(log.attachment("nothing").unwrap(), None);
    let mut entries = Vec::new();
    for number in 0..story::DECISIONS {
        let mut maps = 0;
        log.cycle(number, &mut |item| {
            match item {
                Item::Entry { entry, .. } => entries.push(entry),
                Item::View { at, .. } => maps += u32::from(at.topic == topic::INTEREST),
                _ => {}
            }
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(maps, 1, "decision {number}");
    }
    // The last outcome comes after the last decision.
    assert_eq!(entries[..], whole.entries[..whole.entries.len() - 1]);
    for decision in whole.decisions() {
        assert_eq!(log.decision(decision.number).unwrap(), *decision);
    }
}

#[test]
fn several_decisions_in_a_chunk_are_found_too() {
    let bytes = story::log();
    let mut out = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut out).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let foreign = out.into_inner();
    let mut log = IndexedLog::over(Path::new("foreign.mcap"), Cursor::new(&foreign)).unwrap();
    assert_eq!(log.without_index, None);
    for decision in story::read(&bytes).decisions() {
        assert_eq!(log.decision(decision.number).unwrap(), *decision);
    }
    assert!(matches!(log.decision(3), Err(LogError::NoDecision { found: 3, .. })));
}

#[test]
fn a_chunk_that_is_not_what_was_written_is_refused_when_it_is_asked_for() {
    let mut bytes = story::log();
    let map = story::read(&bytes).maps().count();
    assert!(map > 0);
    // The last chunk that holds a decision lies in the second half of the data.
    let mut log = IndexedLog::over(Path::new("log.mcap"), Cursor::new(bytes.clone())).unwrap();
    let good = log.decision(2).unwrap();
    let needle = bytes.windows(4).rposition(|four| four == [0x28, 0xb5, 0x2f, 0xfd]).unwrap();
    let before = bytes[..needle].windows(4).rposition(|four| four == [0x28, 0xb5, 0x2f, 0xfd]);
    bytes[before.unwrap() + 50] ^= 1;
    let mut log = IndexedLog::over(Path::new("log.mcap"), Cursor::new(bytes)).unwrap();
    assert_eq!(log.without_index, None, "the summary is good");
    let answers: Vec<_> = (0..3).map(|number| log.decision(number)).collect();
    assert!(answers.iter().any(|a| matches!(a, Err(LogError::Damaged { .. }))), "{answers:?}");
    for decision in answers.into_iter().flatten() {
        assert!(decision.number < 2 || decision == good);
    }
}
