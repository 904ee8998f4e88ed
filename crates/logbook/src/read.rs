//! Reads a log back, whole or broken, and says which.
//!
//! Every check the container offers is on: a chunk is only read after its checksum agreed, and the data and
//! summary sections are checked when they end. What comes out of a broken file is therefore always the true
//! beginning of the run.

pub(crate) mod check;
mod sketch;
pub(crate) mod stream;
pub(crate) mod walk;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::ops::ControlFlow;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use foxglove::messages::Grid;
use mcap::records::Record;
use prost::Message as _;
use wisdom_grid::{GridSpec, MAX_SIDE, Raster, Window};

pub use self::check::{Check, Finding, Verdict, check, check_bytes};
pub use self::sketch::sketch;
use self::stream::Story;
pub use self::stream::{Item, MessageAt, stream};
use crate::record;
use crate::write::RUN;
use crate::{LogError, topic, view};

/// Every map topic begins so.
const MAPS: &str = "/map/";

/// One record of the run, in the order they were written.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// What the core was told.
    Observation(record::Observation),
    /// What it decided.
    Decision(Box<record::Decision>),
    /// What came of it.
    Outcome(record::Outcome),
    /// What word reached it.
    Message(record::Message),
    /// What broke in the world meanwhile, of which the core knows nothing.
    Fault(record::Fault),
}

/// A file that the log carries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its bytes.
    pub data: Vec<u8>,
}

/// How a run ended, by its last record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunEnd {
    /// How the run ended, in its own words.
    pub status: String,
    /// Decisions it says it took.
    pub decisions: u32,
    /// Digest of them all, hexadecimal.
    pub chain: String,
    /// Whatever else was noted.
    pub facts: BTreeMap<String, String>,
}

/// Whether a log is whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// The run ended and every check holds.
    Complete,
    /// The file ends before the run did; what there is was checked.
    Truncated {
        /// Bytes read.
        byte: u64,
        /// What is missing.
        detail: String,
    },
    /// Something in the file is not what was written; what was read before it was checked.
    Corrupt {
        /// Bytes read when it showed; the fault lies at or before it.
        byte: u64,
        /// What does not hold.
        detail: String,
    },
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Complete => f.write_str("complete"),
            Self::Truncated { byte, detail } => write!(f, "truncated after byte {byte}: {detail}"),
            Self::Corrupt { byte, detail } => {
                write!(f, "corrupt at or before byte {byte}: {detail}")
            }
        }
    }
}

/// Where the bytes are, to be read again when a map is asked for.
#[derive(Debug, Clone)]
enum Source {
    File(PathBuf),
    Memory(Vec<u8>),
}

trait Bytes: Read + Seek {}
impl<T: Read + Seek> Bytes for T {}

impl Source {
    fn name(&self) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Memory(_) => PathBuf::from("log in memory"),
        }
    }

    fn open(&self) -> io::Result<Box<dyn Bytes + '_>> {
        Ok(match self {
            Self::File(path) => Box::new(BufReader::new(File::open(path)?)),
            Self::Memory(bytes) => Box::new(Cursor::new(bytes)),
        })
    }
}

/// A map in the log.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct MapAt {
    topic: String,
    channel: u16,
    /// Where its chunk begins.
    chunk: u64,
}

/// A log that was read.
#[derive(Debug, Clone)]
pub struct LogReader {
    /// What was true of the whole run, by name; empty if the file ends before it.
    pub metadata: BTreeMap<String, String>,
    /// The files it carries.
    pub attachments: Vec<Attachment>,
    /// Observations, decisions and outcomes, in the order they were written.
    pub entries: Vec<Entry>,
    /// Whether it is whole.
    pub status: Status,
    /// How the run ended; absent if it did not.
    pub end: Option<RunEnd>,
    /// Messages of each topic, those of topics that this version does not know among them.
    pub topics: BTreeMap<String, u64>,
    source: Source,
    /// The maps of each decision, in the order they were written.
    maps: BTreeMap<u32, Vec<MapAt>>,
}

impl LogReader {
    /// Reads a log file, finished or not. A broken file is not an error: see [`LogReader::status`].
    ///
    /// # Errors
    /// [`LogError::Io`] if the file cannot be read; [`LogError::NotALog`] if it is another kind of file.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Self::read(Source::File(path.to_owned()))
    }

    /// Reads a log from memory.
    ///
    /// # Errors
    /// [`LogError::NotALog`] if it is something else.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, LogError> {
        Self::read(Source::Memory(bytes))
    }

    fn read(source: Source) -> Result<Self, LogError> {
        let name = source.name();
        let mut log = Self {
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            entries: Vec::new(),
            status: Status::Complete,
            end: None,
            topics: BTreeMap::new(),
            // The source itself moves in once it was read.
            source: Source::Memory(Vec::new()),
            maps: BTreeMap::new(),
        };
        let mut story = Story::default();
        let walked = source
            .open()
            .and_then(|mut bytes| {
                story.read(&mut bytes, &mut |item| {
                    log.keep(item);
                    ControlFlow::Continue(())
                })
            })
            .map_err(|source| LogError::Io { path: name.clone(), source })?;
        log.status = story.status(&walked).ok_or(LogError::NotALog { path: name })?;
        log.end = story.end;
        log.source = source;
        Ok(log)
    }

    fn keep(&mut self, item: Item<'_>) {
        match item {
            Item::Metadata { name: RUN, facts } => self.metadata.clone_from(facts),
            Item::Metadata { .. } => {}
            Item::Attachment { name, media_type, data } => self.attachments.push(Attachment {
                name: name.to_owned(),
                media_type: media_type.to_owned(),
                data: data.to_vec(),
            }),
            Item::Entry { at, entry } => {
                self.count(at.topic);
                self.entries.push(entry);
            }
            Item::View { at, .. } => {
                self.count(at.topic);
                if at.topic.starts_with(MAPS) {
                    let MessageAt { number: decision, channel, chunk, .. } = at;
                    let map = MapAt { topic: at.topic.to_owned(), channel, chunk };
                    self.maps.entry(decision).or_default().push(map);
                }
            }
        }
    }

    fn count(&mut self, topic: &str) {
        if let Some(count) = self.topics.get_mut(topic) {
            *count += 1;
        } else {
            self.topics.insert(topic.to_owned(), 1);
        }
    }

    /// The decisions, in their order.
    pub fn decisions(&self) -> impl Iterator<Item = &record::Decision> {
        self.entries.iter().filter_map(|entry| match entry {
            Entry::Decision(decision) => Some(&**decision),
            Entry::Observation(_) | Entry::Outcome(_) | Entry::Message(_) | Entry::Fault(_) => None,
        })
    }

    /// Topics that this version does not know, with their messages.
    pub fn unknown_topics(&self) -> impl Iterator<Item = (&str, u64)> {
        self.topics
            .iter()
            .filter(|(topic, _)| !is_known(topic))
            .map(|(topic, &count)| (topic.as_str(), count))
    }

    /// The maps in the log: decision and topic.
    pub fn maps(&self) -> impl Iterator<Item = (u32, &str)> {
        let maps = self.maps.iter();
        maps.flat_map(|(decision, maps)| maps.iter().map(|map| (*decision, map.topic.as_str())))
    }

    /// The topics of a decision's maps.
    pub fn maps_of(&self, decision: u32) -> impl Iterator<Item = &str> {
        self.maps.get(&decision).into_iter().flatten().map(|map| map.topic.as_str())
    }

    /// The decisions from one to another that have a map of a topic, in their order.
    pub(crate) fn decisions_with(
        &self,
        topic: &str,
        decisions: RangeInclusive<u32>,
    ) -> impl DoubleEndedIterator<Item = u32> {
        let of_topic = move |maps: &[MapAt]| maps.iter().any(|map| map.topic == topic);
        // A range that ends before it begins is none, and no panic.
        let maps = (!decisions.is_empty()).then(|| self.maps.range(decisions));
        let maps = maps.into_iter().flatten();
        maps.filter(move |(_, maps)| of_topic(maps)).map(|(decision, _)| *decision)
    }

    /// A map of a decision, for instance [`topic::INTEREST`], at the place of the run's grid.
    ///
    /// # Errors
    /// [`LogError::NoMap`] if there is none; [`LogError::Malformed`] if it is not a map of ours;
    /// [`LogError::Io`] or [`LogError::Damaged`] if the file changed since it was opened.
    pub fn map(&self, topic: &str, decision: u32) -> Result<Raster<f32>, LogError> {
        let missing = || LogError::NoMap { topic: topic.to_owned(), decision };
        let at = self
            .maps
            .get(&decision)
            .and_then(|maps| maps.iter().find(|map| map.topic == topic))
            .ok_or_else(missing)?;
        let path = self.source.name();
        let io = |source| LogError::Io { path: path.clone(), source };
        let mut bytes = self.source.open().map_err(io)?;
        let mut found = None;
        let read = one_chunk(&mut bytes, at.chunk, &mut |record| {
            if let Record::Message { header, data } = record.record
                && (header.channel_id, header.sequence) == (at.channel, decision)
            {
                found = Some(data.into_owned());
                return Ok(ControlFlow::Break(()));
            }
            Ok(ControlFlow::Continue(()))
        });
        read.map_err(io)?.map_err(|detail| LogError::Damaged {
            path: path.clone(),
            byte: at.chunk,
            detail,
        })?;
        let data = found.ok_or_else(missing)?;
        let malformed = |(field, found, limit): (&str, String, &'static str)| LogError::Malformed {
            record: format!("{topic} of decision {decision}"),
            field: field.to_owned(),
            found,
            limit,
        };
        let grid = Grid::decode(data.as_slice())
            .map_err(|error| malformed(("message", error.to_string(), "a foxglove.Grid")))?;
        let plane = view::plane(&grid).map_err(malformed)?;
        let Some(run) = self.run_grid() else { return Ok(plane) };
        // The map may cover a part of the run's grid; where it begins says how many cells lie before it.
        let corner = grid.pose.and_then(|pose| pose.position);
        let off = |at: &dyn std::fmt::Debug| {
            let place = ("pose.position", format!("{at:?}"), "on the corners of the run's cells");
            malformed(place)
        };
        let cells = |metres: f64| {
            let cells = (metres / run.spacing_m()).round();
            let on_corner = (cells * run.spacing_m() - metres).abs() <= 1e-6 * run.spacing_m();
            (on_corner && (0.0..=MAX_SIDE as f64).contains(&cells)).then_some(cells as usize)
        };
        let (west, south) = match &corner {
            None => (0, 0),
            Some(at) => cells(at.x).zip(cells(at.y)).ok_or_else(|| off(at))?,
        };
        let (rows, cols) = (plane.spec().rows(), plane.spec().cols());
        let row = run.rows().checked_sub(south + rows).ok_or_else(|| off(&corner))?;
        let spec = run.part(Window { row, col: west, rows, cols }).map_err(|error| {
            malformed(("pose.position", error.to_string(), "a part of the run's grid"))
        })?;
        Raster::from_vec(spec, plane.values().to_vec())
            .map_err(|error| malformed(("data", error.to_string(), "rows x columns")))
    }

    /// The run's grid, if the log says where it lies.
    fn run_grid(&self) -> Option<GridSpec> {
        let number = |key: &str| self.metadata.get(key)?.parse::<f64>().ok();
        let count = |key: &str| self.metadata.get(key)?.parse::<usize>().ok();
        let spec =
            GridSpec::new(count("grid_rows")?, count("grid_cols")?, number("grid_spacing_m")?);
        Some(spec.ok()?.at(number("grid_west_m")?, number("grid_north_m")?))
    }
}

/// Whether this version knows what goes to a topic.
#[must_use]
pub fn is_known(topic: &str) -> bool {
    topic.starts_with(MAPS) || topic::ALL.contains(&topic)
}

/// Gives the records of the chunk that begins at a byte, or says what is wrong with it.
pub(crate) fn one_chunk(
    bytes: &mut (impl Read + Seek),
    start: u64,
    each: &mut walk::Each<'_>,
) -> io::Result<Result<(), String>> {
    let whole = bytes.seek(io::SeekFrom::End(0))?;
    bytes.seek(io::SeekFrom::Start(start))?;
    let mut frames = walk::Frames::new(bytes, start, whole);
    match frames.advance().and_then(|()| frames.chunk(each)) {
        Ok(()) | Err(walk::Stop::Enough) => Ok(Ok(())),
        Err(walk::Stop::Io(error)) => Err(error),
        Err(walk::Stop::Fault(fault)) => Ok(Err(fault.to_string())),
    }
}
