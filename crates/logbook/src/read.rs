//! Reads a log back, whole or broken, and says which.
//!
//! Every check the container offers is on: a chunk is only read after its checksum agreed, and the data and
//! summary sections are checked when they end. What comes out of a broken file is therefore always the true
//! beginning of the run.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use foxglove::messages::Grid;
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError, parse_record};
use prost::Message as _;
use wisdom_grid::{GridSpec, Raster, Window};

use crate::record::{self, CHAIN_START, hex};
use crate::write::{END, RUN};
use crate::{LogError, topic, view};

/// The largest record or chunk a reader takes into memory.
const RECORD_LIMIT: usize = 1 << 30;
/// Bytes asked of the file at a time, so that a broken length cannot ask for more memory than there is file.
const STEP: usize = 1 << 20;
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
    decision: u32,
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
    maps: Vec<MapAt>,
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
        let mut scan = Scan::default();
        let fault = source
            .open()
            .and_then(|mut bytes| scan.run(&mut bytes))
            .map_err(|source| LogError::Io { path: name.clone(), source })?;
        let status = match fault {
            Some(Fault::NotALog) => return Err(LogError::NotALog { path: name }),
            Some(Fault::Ends(detail)) => Status::Truncated { byte: scan.byte, detail },
            Some(Fault::Wrong(detail)) => Status::Corrupt { byte: scan.byte, detail },
            None => Status::Complete,
        };
        let Scan { metadata, attachments, entries, end, topics, maps, .. } = scan;
        Ok(Self { metadata, attachments, entries, status, end, topics, source, maps })
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
        self.maps.iter().map(|map| (map.decision, map.topic.as_str()))
    }

    /// A map of a decision, for instance [`topic::INTEREST`], at the place of the run's grid.
    ///
    /// # Errors
    /// [`LogError::NoMap`] if there is none; [`LogError::Malformed`] if it is not a map of ours;
    /// [`LogError::Io`] or [`LogError::Container`] if the file changed since it was opened.
    pub fn map(&self, topic: &str, decision: u32) -> Result<Raster<f32>, LogError> {
        let missing = || LogError::NoMap { topic: topic.to_owned(), decision };
        let at = self
            .maps
            .iter()
            .find(|map| map.decision == decision && map.topic == topic)
            .ok_or_else(missing)?;
        let path = self.source.name();
        let io = |source| LogError::Io { path: path.clone(), source };
        let mut bytes = self.source.open().map_err(io)?;
        bytes.seek(SeekFrom::Start(at.chunk)).map_err(io)?;
        let mut found = None;
        let options = checks().with_skip_start_magic(true).with_validate_data_section_crc(false);
        let scanned = scan(&mut bytes, options, |_, record| {
            if let Record::Message { header, data } = record
                && (header.channel_id, header.sequence) == (at.channel, decision)
            {
                found = Some(data.into_owned());
            }
            Ok(found.is_none())
        });
        if let Err(source) = scanned {
            return Err(match source {
                McapError::Io(source) => io(source),
                source => LogError::Container { path, source },
            });
        }
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
        let cells = |metres: f64| (metres / run.spacing_m()).round() as usize;
        let (west, south) = corner.map_or((0, 0), |at| (cells(at.x), cells(at.y)));
        let (rows, cols) = (plane.spec().rows(), plane.spec().cols());
        let row = run.rows().saturating_sub(south.saturating_add(rows));
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

/// Whether this version knows what goes there.
fn is_known(topic: &str) -> bool {
    topic.starts_with(MAPS)
        || [
            topic::OBSERVATION,
            topic::OUTCOME,
            topic::MESSAGE,
            topic::FAULT,
            topic::DECISION,
            topic::CLOUD,
            topic::SCENE,
            topic::POSE,
            topic::TRANSFORM,
            topic::LOG,
        ]
        .contains(&topic)
}

/// Every check that the container offers.
fn checks() -> LinearReaderOptions {
    LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_check_finishes_after_end_magic(true)
        .with_record_length_limit(RECORD_LIMIT)
}

/// Gives each record, with the byte that follows it, to `take` until that says no, the file ends, or a check
/// fails.
fn scan(
    bytes: &mut impl Read,
    options: LinearReaderOptions,
    mut take: impl FnMut(u64, Record<'_>) -> Result<bool, McapError>,
) -> Result<(), McapError> {
    let mut reader = LinearReader::new_with_options(options);
    let mut byte = 0;
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let read = loop {
                    match bytes.read(reader.insert(need.min(STEP))) {
                        Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                        read => break read?,
                    }
                };
                byte += read as u64;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => {
                if !take(byte, parse_record(opcode, data)?)? {
                    break;
                }
            }
        }
    }
    Ok(())
}

/// Why a scan did not find a whole log.
enum Fault {
    NotALog,
    Ends(String),
    Wrong(String),
}

/// What a scan has found so far.
#[derive(Default)]
struct Scan {
    metadata: BTreeMap<String, String>,
    attachments: Vec<Attachment>,
    entries: Vec<Entry>,
    end: Option<RunEnd>,
    topics: BTreeMap<String, u64>,
    maps: Vec<MapAt>,
    channels: BTreeMap<u16, String>,
    chain: Option<[u8; 32]>,
    observations: u32,
    messages: u32,
    decisions: u32,
    /// Bytes read.
    byte: u64,
    /// Where the last record outside a chunk ended: the chunk after it begins there.
    boundary: u64,
    footer: bool,
}

impl Scan {
    fn run(&mut self, bytes: &mut (impl Read + Seek)) -> io::Result<Option<Fault>> {
        let whole = bytes.seek(SeekFrom::End(0))?;
        let mut tail = [0; MAGIC.len()];
        if whole >= MAGIC.len() as u64 {
            bytes.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
            bytes.read_exact(&mut tail)?;
        }
        bytes.seek(SeekFrom::Start(0))?;
        let mut wrong = None;
        let mut counted = Counted { bytes, read: 0 };
        let scanned = scan(&mut counted, checks(), |byte, record| {
            self.byte = byte;
            wrong = self.take(record).err();
            Ok(wrong.is_none())
        });
        self.byte = counted.read;
        let ends_in_magic = tail == *MAGIC;
        if let Some(detail) = wrong {
            return Ok(Some(Fault::Wrong(detail)));
        }
        Ok(match scanned {
            Ok(()) => self.verdict(),
            Err(McapError::Io(error)) if error.kind() != io::ErrorKind::UnexpectedEof => {
                // A decompressor that stumbles says so through the same variant as the file system.
                Some(Fault::Wrong(error.to_string()))
            }
            Err(McapError::BadMagic) if self.byte <= MAGIC.len() as u64 => Some(Fault::NotALog),
            // A file that lost its end does not end in the magic; one whose lengths lie may.
            Err(McapError::UnexpectedEof) if ends_in_magic && whole > MAGIC.len() as u64 => {
                Some(Fault::Wrong("the file ends in the middle of a record".to_owned()))
            }
            Err(McapError::UnexpectedEof) => {
                Some(Fault::Ends("the file ends before its footer".to_owned()))
            }
            Err(error) => Some(Fault::Wrong(error.to_string())),
        })
    }

    /// What is to be said of a file that was read to its end without a fault.
    fn verdict(&self) -> Option<Fault> {
        let Some(end) = &self.end else {
            return Some(Fault::Ends("the run did not end: there is no wisdom.end".to_owned()));
        };
        let chain = hex(&self.chain.unwrap_or(CHAIN_START));
        if end.decisions != self.decisions {
            let (told, found) = (end.decisions, self.decisions);
            return Some(Fault::Wrong(format!("{found} decisions; the run ended with {told}")));
        }
        if end.chain != chain {
            let told = &end.chain;
            return Some(Fault::Wrong(format!("chain {chain}; the run ended with {told}")));
        }
        None
    }

    fn take(&mut self, record: Record<'_>) -> Result<(), String> {
        match record {
            Record::Schema { .. } => return Ok(()),
            Record::Channel(channel) => {
                self.channels.insert(channel.id, channel.topic);
                return Ok(());
            }
            Record::Message { header, data } => {
                return self.message(header.channel_id, header.sequence, &data);
            }
            Record::Metadata(metadata) if metadata.name == RUN => self.metadata = metadata.metadata,
            Record::Metadata(metadata) if metadata.name == END => {
                self.end = Some(run_end(metadata.metadata)?);
            }
            Record::Attachment { header, data, .. } => self.attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            Record::Footer(_) => self.footer = true,
            _ => {}
        }
        self.boundary = self.byte;
        Ok(())
    }

    fn message(&mut self, channel: u16, sequence: u32, data: &[u8]) -> Result<(), String> {
        let Some(topic) = self.channels.get(&channel).cloned() else {
            return Err(format!("a message on channel {channel}, which has no topic"));
        };
        let failed = |error: prost::DecodeError| format!("{topic} {sequence}: {error}");
        let entry = match topic.as_str() {
            topic::OBSERVATION => {
                let observation = record::Observation::decode(data).map_err(failed)?;
                due("observation", observation.number, self.observations)?;
                self.observations += 1;
                Entry::Observation(observation)
            }
            topic::OUTCOME => {
                let outcome = record::Outcome::decode(data).map_err(failed)?;
                match self.decisions.checked_sub(1) {
                    Some(last) => due("outcome of decision", outcome.decision, last)?,
                    None => return Err("an outcome before any decision".to_owned()),
                }
                Entry::Outcome(outcome)
            }
            topic::MESSAGE => {
                let message = record::Message::decode(data).map_err(failed)?;
                due("message", message.number, self.messages)?;
                self.messages += 1;
                Entry::Message(message)
            }
            topic::FAULT => Entry::Fault(record::Fault::decode(data).map_err(failed)?),
            topic::DECISION => {
                let decision = record::Decision::decode(data).map_err(failed)?;
                self.link(&decision)?;
                Entry::Decision(Box::new(decision))
            }
            plane if plane.starts_with(MAPS) => {
                let chunk = self.boundary;
                self.maps.push(MapAt { decision: sequence, topic: topic.clone(), channel, chunk });
                *self.topics.entry(topic).or_default() += 1;
                return Ok(());
            }
            _ => {
                *self.topics.entry(topic).or_default() += 1;
                return Ok(());
            }
        };
        *self.topics.entry(topic).or_default() += 1;
        self.entries.push(entry);
        Ok(())
    }

    /// A decision must follow the one before it, by number and by chain.
    fn link(&mut self, decision: &record::Decision) -> Result<(), String> {
        due("decision", decision.number, self.decisions)?;
        let link = decision.link(&self.chain.unwrap_or(CHAIN_START));
        if decision.chain != hex(&link) {
            let number = decision.number;
            return Err(format!("decision {number} does not follow from its chain"));
        }
        self.chain = Some(link);
        self.decisions += 1;
        Ok(())
    }
}

/// Records come without gaps: a chunk that got lost between two others would else go unseen.
fn due(kind: &str, found: u32, due: u32) -> Result<(), String> {
    if found == due { Ok(()) } else { Err(format!("{kind} {found} where {due} was due")) }
}

fn run_end(mut facts: BTreeMap<String, String>) -> Result<RunEnd, String> {
    let mut take = |key: &str| facts.remove(key).ok_or_else(|| format!("{END} has no {key}"));
    let (status, decisions, chain) = (take("status")?, take("decisions")?, take("chain")?);
    let decisions =
        decisions.parse().map_err(|_| format!("{END} has {decisions} decisions, not a number"))?;
    Ok(RunEnd { status, decisions, chain, facts })
}

/// Counts the bytes that are read.
struct Counted<'a, R> {
    bytes: &'a mut R,
    read: u64,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.bytes.read(buffer)?;
        self.read += read as u64;
        Ok(read)
    }
}
