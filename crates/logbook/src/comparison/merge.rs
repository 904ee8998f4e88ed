//! Several logs in one file, so that stock viewers show the runs beside each other on one time line.
//!
//! Everything of the first run goes under `/a/`, of the second under `/b/`, and so on: topics, metadata and attachments.
//! Times are kept, but for a nanosecond where two runs have a message at one time. Payloads are kept byte for byte, but for the frames that viewers draw in: `map` becomes `a/map`, and
//! transforms from a frame `world` put the maps side by side.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use foxglove::Encode as _;
use foxglove::messages::{
    FrameTransform, Grid, PointCloud, PoseInFrame, PosesInFrame, Quaternion, RawImage, SceneUpdate,
    Vector3,
};
use mcap::records::{MessageHeader, Metadata, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Attachment, McapError, parse_record};
use prost::Message as _;

use crate::container::{self, Container, failure};
use crate::view::timestamp;
use crate::write::RUN;
use crate::{LogError, PartFile, Store as _, SyncPolicy, topic};

/// The frame that all maps of a merged file hang on.
const WORLD: &str = "world";
/// Space between two maps, as a share of the one in the west.
const GAP: f64 = 0.1;
/// The largest record or chunk taken into memory.
const RECORD_LIMIT: usize = 1 << 30;
/// Bytes asked of a file at a time.
const STEP: usize = 1 << 20;
/// Uncompressed bytes of a chunk.
const CHUNK: u64 = 4 << 20;
/// The letters that runs go by.
const LETTERS: &str = "abcdefghijklmnopqrstuvwxyz";

/// What became of a merge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Merged {
    /// The file.
    pub path: PathBuf,
    /// Messages of each run, in the runs' order.
    pub messages: Vec<u64>,
}

/// Merges some logs into one new file, in the order of their time stamps. A log that is cut or damaged is merged as far as
/// its checks hold.
///
/// # Errors
/// [`LogError::Exists`] if the file or its part file is there already; [`LogError::Io`] or [`LogError::Container`] if a log
/// cannot be read or the file not be written; [`LogError::Malformed`] if a message is not what its schema says. No file is
/// left behind then.
///
/// # Panics
/// If there are more than 26 logs: runs go by letters.
pub fn merge(path: &Path, logs: &[&Path]) -> Result<Merged, LogError> {
    assert!(logs.len() <= LETTERS.len(), "runs go by letters");
    let store = PartFile::create(path, SyncPolicy::End)?;
    let part = store.name();
    let merged = write(store, logs);
    if merged.is_err() {
        // What is half done is of no use; if it cannot be removed, the first error says more.
        let _ = std::fs::remove_file(part);
    }
    merged
}

fn write(store: PartFile, logs: &[&Path]) -> Result<Merged, LogError> {
    let name = store.name();
    let failed = |error: McapError| failure(&name, error);
    let mut out = container::open(store, "wisdom", Some(CHUNK)).map_err(failed)?;
    let mut runs = Vec::new();
    let mut told = BTreeMap::new();
    for (letter, path) in LETTERS.chars().zip(logs) {
        runs.push(Run::open(letter, path)?);
        let file = path.file_name().unwrap_or(path.as_os_str());
        told.insert(letter.to_string(), file.to_string_lossy().into_owned());
    }
    out.write_metadata(&Metadata { name: MERGED.to_owned(), metadata: told }).map_err(failed)?;
    // What is true of the whole of each run comes first.
    for run in &mut runs {
        run.advance(&mut out, &name)?;
    }
    let begins_ns = runs.iter().filter_map(Run::time_ns).min().unwrap_or(0);
    let mut clock = Clock { next_ns: begins_ns };
    place_maps(&mut out, &runs, &mut clock).map_err(failed)?;
    let due = |runs: &[Run]| {
        let times = runs.iter().enumerate().filter_map(|(i, run)| Some((run.time_ns()?, i)));
        times.min().map(|(_, i)| i)
    };
    while let Some(next) = due(&runs) {
        runs[next].write(&mut out, &mut clock, &name)?;
        runs[next].advance(&mut out, &name)?;
    }
    let path = container::close(out, &name)?;
    Ok(Merged { path, messages: runs.iter().map(|run| run.written).collect() })
}

/// Name of the metadata record that opens a merged log: the file of each run, by its letter.
pub(crate) const MERGED: &str = "wisdom.merged";

type Out = Container<PartFile>;

/// Gives every message a time of its own: runs share theirs, and players do not keep the order of equal ones.
struct Clock {
    next_ns: u64,
}

impl Clock {
    fn at(&mut self, stamp_ns: u64) -> u64 {
        let stamp_ns = stamp_ns.max(self.next_ns);
        self.next_ns = stamp_ns + 1;
        stamp_ns
    }
}

/// Transforms that put the maps beside each other, from west to east.
fn place_maps(out: &mut Out, runs: &[Run], clock: &mut Clock) -> Result<(), McapError> {
    let schema = FrameTransform::get_schema().expect("every well-known message has a schema");
    let schema = out.add_schema(&schema.name, "protobuf", &schema.data)?;
    let channel_id = out.add_channel(schema, topic::TRANSFORM, "protobuf", &BTreeMap::new())?;
    let mut west_m = 0.0;
    for (sequence, run) in (0..).zip(runs) {
        let stamp_ns = clock.at(0);
        let transform = FrameTransform {
            timestamp: Some(timestamp(stamp_ns)),
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: format!("{}/map", run.letter),
            translation: Some(Vector3 { x: west_m, y: 0.0, z: 0.0 }),
            rotation: Some(Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
        };
        let header =
            MessageHeader { channel_id, sequence, log_time: stamp_ns, publish_time: stamp_ns };
        out.write_to_known_channel(&header, &transform.encode_to_vec())?;
        west_m += run.width_m * (1.0 + GAP);
    }
    Ok(())
}

/// A channel of a run, as the merged file has it.
#[derive(Debug, Clone)]
struct Channel {
    id: u16,
    /// Name of its schema, if its messages are protobuf.
    schema: String,
    topic: String,
}

/// One of the logs, read record by record.
struct Run {
    letter: char,
    path: PathBuf,
    bytes: BufReader<File>,
    reader: LinearReader,
    /// Schemas of the log, by its own numbers: name, encoding and data.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    /// Channels by the log's own numbers.
    channels: BTreeMap<u16, Channel>,
    /// The message that is due.
    due: Option<(MessageHeader, Vec<u8>)>,
    /// Width of its map, metres; 0 if the log does not say.
    width_m: f64,
    written: u64,
}

impl Run {
    fn open(letter: char, path: &Path) -> Result<Self, LogError> {
        let file =
            File::open(path).map_err(|source| LogError::Io { path: path.to_owned(), source })?;
        let checks = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(RECORD_LIMIT);
        Ok(Self {
            letter,
            path: path.to_owned(),
            bytes: BufReader::new(file),
            reader: LinearReader::new_with_options(checks),
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            due: None,
            width_m: 0.0,
            written: 0,
        })
    }

    /// Time stamp of the message that is due; none if the log is at its end.
    fn time_ns(&self) -> Option<u64> {
        self.due.as_ref().map(|(header, _)| header.log_time)
    }

    /// Reads up to the next message; what lies between goes into the merged file at once.
    fn advance(&mut self, out: &mut Out, name: &Path) -> Result<(), LogError> {
        self.due = None;
        while self.due.is_none() {
            let Some(record) = self.record()? else { break };
            self.take(record, out).map_err(|error| failure(name, error))?;
        }
        Ok(())
    }

    /// The next record of the log; none at its end, or where its checks no longer hold.
    fn record(&mut self) -> Result<Option<Record<'static>>, LogError> {
        while let Some(event) = self.reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    let read = loop {
                        match self.bytes.read(self.reader.insert(need.min(STEP))) {
                            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                            read => break read,
                        }
                    };
                    let read =
                        read.map_err(|source| LogError::Io { path: self.path.clone(), source })?;
                    self.reader.notify_read(read);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    return Ok(parse_record(opcode, data).ok().map(Record::into_owned));
                }
                // The log is cut or damaged from here on; its reader says so to whoever opens it.
                Err(_) => return Ok(None),
            }
        }
        Ok(None)
    }

    fn take(&mut self, record: Record<'static>, out: &mut Out) -> Result<(), McapError> {
        match record {
            Record::Schema { header, data } => {
                let schema = (header.name, header.encoding, data.into_owned());
                self.schemas.insert(header.id, schema);
            }
            Record::Channel(channel) => {
                if self.channels.contains_key(&channel.id) {
                    return Ok(());
                }
                let known = self.schemas.get(&channel.schema_id);
                let schema = match known {
                    Some((name, encoding, data)) => out.add_schema(name, encoding, data)?,
                    // 0 stands for a channel without a schema.
                    None => 0,
                };
                let topic = format!("/{}{}", self.letter, channel.topic);
                let encoding = &channel.message_encoding;
                let id = out.add_channel(schema, &topic, encoding, &channel.metadata)?;
                let protobuf = encoding == "protobuf";
                let schema = known.filter(|_| protobuf).map(|(name, ..)| name.clone());
                let schema = schema.unwrap_or_default();
                self.channels.insert(channel.id, Channel { id, schema, topic });
            }
            Record::Message { header, data } => self.due = Some((header, data.into_owned())),
            Record::Metadata(metadata) => {
                if metadata.name == RUN {
                    let number = |key: &str| metadata.metadata.get(key)?.parse::<f64>().ok();
                    let (cols, spacing_m) = (number("grid_cols"), number("grid_spacing_m"));
                    self.width_m = cols.zip(spacing_m).map_or(0.0, |(cols, metres)| cols * metres);
                }
                let name = format!("{}/{}", self.letter, metadata.name);
                out.write_metadata(&Metadata { name, ..metadata })?;
            }
            Record::Attachment { header, data, .. } => out.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: format!("{}/{}", self.letter, header.name),
                media_type: header.media_type,
                data: Cow::Owned(data.into_owned()),
            })?,
            _ => {}
        }
        Ok(())
    }

    /// Writes the message that is due.
    fn write(&mut self, out: &mut Out, clock: &mut Clock, name: &Path) -> Result<(), LogError> {
        let Some((mut header, data)) = self.due.take() else { return Ok(()) };
        header.log_time = clock.at(header.log_time);
        header.publish_time = header.log_time;
        let malformed = |found: String| LogError::Malformed {
            record: format!("message {} in {}", header.sequence, self.path.display()),
            field: "channel or data".to_owned(),
            found,
            limit: "a message of a channel of the log, as its schema says",
        };
        let channel = self.channels.get(&header.channel_id);
        let channel = channel.ok_or_else(|| malformed(format!("channel {}", header.channel_id)))?;
        let framed = in_frames_of(self.letter, &channel.schema, &data);
        let framed = framed.map_err(|error| malformed(format!("{}: {error}", channel.topic)))?;
        let header = MessageHeader { channel_id: channel.id, ..header };
        out.write_to_known_channel(&header, &framed.unwrap_or(data))
            .map_err(|error| failure(name, error))?;
        self.written += 1;
        Ok(())
    }
}

/// A well-known message with its frames renamed; none if it has none, or is not known to have.
fn in_frames_of(
    letter: char,
    schema: &str,
    data: &[u8],
) -> Result<Option<Vec<u8>>, prost::DecodeError> {
    let rename = |frame: &mut String| *frame = format!("{letter}/{frame}");
    macro_rules! renamed {
        ($message:ty, $($frame:ident),+) => {{
            let mut message = <$message>::decode(data)?;
            $(rename(&mut message.$frame);)+
            message.encode_to_vec()
        }};
    }
    Ok(Some(match schema {
        "foxglove.Grid" => renamed!(Grid, frame_id),
        "foxglove.PointCloud" => renamed!(PointCloud, frame_id),
        "foxglove.RawImage" => renamed!(RawImage, frame_id),
        "foxglove.PoseInFrame" => renamed!(PoseInFrame, frame_id),
        "foxglove.PosesInFrame" => renamed!(PosesInFrame, frame_id),
        "foxglove.FrameTransform" => renamed!(FrameTransform, parent_frame_id, child_frame_id),
        "foxglove.SceneUpdate" => {
            let mut scene = SceneUpdate::decode(data)?;
            for entity in &mut scene.entities {
                rename(&mut entity.frame_id);
            }
            scene.encode_to_vec()
        }
        _ => return Ok(None),
    }))
}
