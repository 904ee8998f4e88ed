//! Walks the records of a container: frames, checksums and chunks, for every reader of ours.
//!
//! A record is only given on after every checksum over it that can be known by then agreed: a chunk's before
//! its first message, an attachment's with it, those of the data and summary sections when they end. No more
//! than one record, packed and unpacked, is in memory.

use std::collections::BTreeSet;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::ControlFlow;

use crc32fast::Hasher;
use mcap::records::{ChunkHeader, Footer, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, parse_record};

/// The largest record or chunk a reader takes into memory, bytes.
const RECORD_LIMIT: u64 = 1 << 30;
/// The profile of our containers.
const PROFILE: &str = "wisdom";
/// Records from here on belong to applications; those below are the container's.
pub(crate) const PRIVATE: u8 = 0x80;
/// Bytes of a record's opcode and length.
pub(crate) const PREFIX: u64 = 9;
/// Bytes of a chunk's header without the name of its compression.
const CHUNK_HEADER: usize = 40;
/// Bytes of a footer's body, and how many of them its checksum covers.
pub(crate) const FOOTER: usize = 20;
const FOOTER_SUMMED: usize = 16;
/// Bytes of the record that ends the data section.
pub(crate) const DATA_END: u64 = PREFIX + 4;
/// Bytes handed to a decompressor at a time.
const STEP: usize = 1 << 20;

/// A record, and where it lies.
pub(crate) struct Found<'a> {
    /// Where it begins in the file; of a record in a chunk, where the chunk does.
    pub(crate) start: u64,
    /// Bytes of it, or of the chunk, with opcode and length.
    pub(crate) length: u64,
    /// Of a record in a chunk: where it begins among the unpacked bytes.
    pub(crate) offset: Option<u64>,
    pub(crate) record: Record<'a>,
}

/// What takes the records; `Err` says what is wrong with one.
pub(crate) type Each<'e> = dyn FnMut(Found<'_>) -> Result<ControlFlow<()>, String> + 'e;

/// What takes the kind and the body of each record in a chunk.
type Take<'t> = dyn FnMut(u8, &[u8]) -> Result<(), Stop> + 't;

/// Why a walk did not find a whole file.
pub(crate) enum Fault {
    /// It is another kind of file.
    NotALog,
    /// It ends too early.
    Ends(String),
    /// Something in it is not what was written.
    Wrong(String),
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotALog => f.write_str("it does not begin with the MCAP magic"),
            Self::Ends(detail) | Self::Wrong(detail) => f.write_str(detail),
        }
    }
}

/// How a walk went.
pub(crate) struct Walked {
    /// What is wrong; nothing if the whole file was walked, or as much of it as was wanted.
    pub(crate) fault: Option<Fault>,
    /// Whether the caller had enough before the end.
    pub(crate) stopped: bool,
    /// Bytes read.
    pub(crate) byte: u64,
    /// Where the last data record ends that was given on and taken.
    pub(crate) sound: u64,
    /// Whether the data section came to its end and its checksum agreed.
    pub(crate) sealed: bool,
    /// Whether that checksum did not agree: then what is wrong has no checksum of its own.
    pub(crate) doubtful: bool,
    /// Bytes of the file.
    pub(crate) whole: u64,
}

/// Why a walk ends before the file does.
pub(crate) enum Stop {
    Fault(Fault),
    Enough,
    Io(io::Error),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        // The file became shorter while it was read.
        if error.kind() == io::ErrorKind::UnexpectedEof { ends() } else { Self::Io(error) }
    }
}

fn ends() -> Stop {
    Stop::Fault(Fault::Ends("the file ends before its footer".to_owned()))
}

fn wrong(detail: impl Into<String>) -> Stop {
    Stop::Fault(Fault::Wrong(detail.into()))
}

/// Gives every record of a file to `each`, from the first to the last, as long as everything agrees.
pub(crate) fn walk(bytes: &mut (impl Read + Seek), each: &mut Each<'_>) -> io::Result<Walked> {
    let whole = bytes.seek(SeekFrom::End(0))?;
    let magic = MAGIC.len() as u64;
    let mut tail = [0; MAGIC.len()];
    if whole > magic {
        bytes.seek(SeekFrom::Start(whole - magic))?;
        bytes.read_exact(&mut tail)?;
    }
    bytes.seek(SeekFrom::Start(0))?;
    let mut frames = Frames::new(bytes, 0, whole);
    let (fault, stopped) = match frames.all(each) {
        Ok(()) => (None, false),
        Err(Stop::Enough) => (None, true),
        Err(Stop::Io(error)) => return Err(error),
        // A file that lost its end does not end in the magic; one whose lengths lie may.
        Err(Stop::Fault(Fault::Ends(_))) if tail == *MAGIC => {
            (Some(Fault::Wrong("the file ends in the middle of a record".to_owned())), false)
        }
        Err(Stop::Fault(fault)) => (Some(fault), false),
    };
    let byte = if matches!(fault, Some(Fault::Ends(_))) { whole } else { frames.at };
    let Frames { sound, sealed, doubtful, .. } = frames;
    Ok(Walked { fault, stopped, byte, sound, sealed, doubtful, whole })
}

/// What may follow what among the data. Of a file without an end, which has no checksum over all data, this is all that
/// tells of a record whose kind is not what was written.
#[derive(Default)]
struct Order {
    begun: bool,
    /// Whether the container was written by us, who write no records of our own kinds.
    ours: bool,
    /// Whether the record before was a chunk or an index of one.
    after_chunk: bool,
    /// Channels of the chunk's messages that no index has named yet.
    awaited: BTreeSet<u16>,
}

impl Order {
    fn chunk(&mut self) -> Result<(), Stop> {
        if !self.begun {
            return Err(wrong("a chunk before the header"));
        }
        self.after_chunk = true;
        self.awaited.clear();
        Ok(())
    }

    fn in_chunk(&mut self, found: &Found<'_>) {
        if let Record::Message { header, .. } = &found.record {
            self.awaited.insert(header.channel_id);
        }
    }

    fn outside(&mut self, opcode: u8, record: &Record<'_>) -> Result<(), String> {
        let stray = || Err(format!("a record of kind {opcode:#04x} among the data"));
        match record {
            Record::Header(header) if !self.begun => {
                self.begun = true;
                self.ours = header.profile == PROFILE;
            }
            _ if !self.begun => return Err("the first record is no header".to_owned()),
            Record::MessageIndex(index) => {
                let named = index.records.is_empty() || self.awaited.remove(&index.channel_id);
                if !(self.after_chunk && named) {
                    let channel = index.channel_id;
                    return Err(format!("an index of channel {channel} without its messages"));
                }
                return Ok(());
            }
            Record::Schema { .. }
            | Record::Channel(_)
            | Record::Message { .. }
            | Record::Attachment { .. }
            | Record::Metadata(_) => {}
            Record::Unknown { opcode, .. } if *opcode >= PRIVATE && !self.ours => {}
            _ => return stray(),
        }
        if !self.awaited.is_empty() {
            return Err("a chunk with messages that no index names".to_owned());
        }
        self.after_chunk = false;
        Ok(())
    }
}

/// Records as they follow each other in a file.
pub(crate) struct Frames<R> {
    bytes: R,
    whole: u64,
    /// Where the record begins that was read last, and where it ends.
    pub(crate) start: u64,
    pub(crate) at: u64,
    prefix: [u8; PREFIX as usize],
    body: Vec<u8>,
    sound: u64,
    sealed: bool,
    doubtful: bool,
}

impl<R: Read> Frames<R> {
    /// Reads records from the byte `at`, where `bytes` stands, of a file of `whole` bytes.
    pub(crate) fn new(bytes: R, at: u64, whole: u64) -> Self {
        let prefix = [0; PREFIX as usize];
        Self {
            bytes,
            whole,
            start: at,
            at,
            prefix,
            body: Vec::new(),
            sound: 0,
            sealed: false,
            doubtful: false,
        }
    }

    fn all(&mut self, each: &mut Each<'_>) -> Result<(), Stop> {
        let mut magic = [0; MAGIC.len()];
        let there = self.whole.min(MAGIC.len() as u64) as usize;
        self.bytes.read_exact(&mut magic[..there])?;
        self.at = there as u64;
        if magic[..there] != MAGIC[..there] {
            return Err(Stop::Fault(Fault::NotALog));
        }
        if there < MAGIC.len() {
            return Err(ends());
        }
        let mut sum = Hasher::new();
        sum.update(MAGIC);
        let mut order = Order::default();
        loop {
            self.advance()?;
            if self.opcode() == op::DATA_END {
                return self.tail(Some(sum.finalize()), each);
            }
            sum.update(&self.prefix);
            sum.update(&self.body);
            if self.opcode() == op::CHUNK {
                order.chunk()?;
                self.chunk(&mut |found| {
                    order.in_chunk(&found);
                    each(found)
                })?;
            } else {
                order.outside(self.opcode(), &self.record()?).map_err(wrong)?;
                self.give(each)?;
            }
            self.sound = self.at;
        }
    }

    /// Takes the record that ends the data, which was just read, and everything after it.
    pub(crate) fn tail(&mut self, data: Option<u32>, each: &mut Each<'_>) -> Result<(), Stop> {
        let Record::DataEnd(end) = self.record()? else {
            return Err(wrong("no end of the data before the summary"));
        };
        if let Some(found) = data
            && end.data_section_crc != 0
            && end.data_section_crc != found
        {
            let saved = end.data_section_crc;
            self.doubtful = true;
            return Err(wrong(format!("checksum of the data is {found:08x}, not {saved:08x}")));
        }
        self.give(each)?;
        self.sealed = data.is_some();
        let mut sum = Hasher::new();
        loop {
            self.advance()?;
            sum.update(&self.prefix);
            if self.opcode() == op::FOOTER {
                break;
            }
            sum.update(&self.body);
            self.give(each)?;
        }
        let Record::Footer(Footer { summary_crc: saved, .. }) = self.record()? else {
            return Err(wrong("no footer"));
        };
        // The parser asked for more bytes than these.
        sum.update(&self.body[..FOOTER_SUMMED]);
        let found = sum.finalize();
        if saved != 0 && saved != found {
            return Err(wrong(format!("checksum of the summary is {found:08x}, not {saved:08x}")));
        }
        self.give(each)?;
        let rest = self.whole - self.at;
        if rest < MAGIC.len() as u64 {
            return Err(ends());
        }
        let mut magic = [0; MAGIC.len()];
        self.bytes.read_exact(&mut magic)?;
        self.at += MAGIC.len() as u64;
        if magic != *MAGIC || self.at != self.whole {
            return Err(wrong("the file does not end with the magic after its footer"));
        }
        Ok(())
    }

    pub(crate) fn opcode(&self) -> u8 {
        self.prefix[0]
    }

    /// Reads the next record. Its length is held against the file's before any memory is asked for.
    pub(crate) fn advance(&mut self) -> Result<(), Stop> {
        if self.whole.saturating_sub(self.at) < PREFIX {
            return Err(ends());
        }
        self.bytes.read_exact(&mut self.prefix)?;
        let [_, length @ ..] = self.prefix;
        let length = u64::from_le_bytes(length);
        if length > self.whole - self.at - PREFIX {
            return Err(ends());
        }
        if length > RECORD_LIMIT {
            return Err(wrong(format!(
                "a record of {length} bytes; this reader takes {RECORD_LIMIT}"
            )));
        }
        self.body.clear();
        self.body.reserve_exact(length as usize);
        let read = self.bytes.by_ref().take(length).read_to_end(&mut self.body)?;
        if (read as u64) < length {
            return Err(ends());
        }
        (self.start, self.at) = (self.at, self.at + PREFIX + length);
        Ok(())
    }

    /// The record that was read last.
    pub(crate) fn record(&self) -> Result<Record<'_>, Stop> {
        parse(self.opcode(), &self.body).map_err(wrong)
    }

    fn give(&self, each: &mut Each<'_>) -> Result<(), Stop> {
        let (start, length) = (self.start, self.at - self.start);
        hand(each, Found { start, length, offset: None, record: self.record()? })
    }

    /// Gives on a chunk, which was just read, and then every record in it.
    pub(crate) fn chunk(&self, each: &mut Each<'_>) -> Result<(), Stop> {
        let (start, length) = (self.start, self.at - self.start);
        let Record::Chunk { header, data } = self.record()? else {
            return Err(wrong(format!("no chunk at byte {start}")));
        };
        if header.uncompressed_size > RECORD_LIMIT {
            let size = header.uncompressed_size;
            return Err(wrong(format!(
                "a chunk of {size} bytes; this reader takes {RECORD_LIMIT}"
            )));
        }
        let packed = CHUNK_HEADER + header.compression.len() + data.len();
        let record = Record::Chunk { header: header.clone(), data };
        hand(each, Found { start, length, offset: None, record })?;
        let mut offset = 0;
        unpack(&header, &self.body[..packed], &mut |opcode, body| {
            let record = parse(opcode, body).map_err(wrong)?;
            if !matches!(
                record,
                Record::Schema { .. } | Record::Channel(_) | Record::Message { .. }
            ) {
                return Err(wrong(format!("a record of kind {opcode:#04x} in a chunk")));
            }
            hand(each, Found { start, length, offset: Some(offset), record })?;
            offset += PREFIX + body.len() as u64;
            Ok(())
        })
    }
}

fn hand(each: &mut Each<'_>, found: Found<'_>) -> Result<(), Stop> {
    match each(found).map_err(wrong)? {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Stop::Enough),
    }
}

/// Gives the records of a chunk, whose record body is `chunk`, once its checksum agreed.
fn unpack(header: &ChunkHeader, chunk: &[u8], take: &mut Take<'_>) -> Result<(), Stop> {
    if header.compression.is_empty() {
        let plain = &chunk[CHUNK_HEADER..];
        let (saved, found) = (header.uncompressed_crc, crc32fast::hash(plain));
        if saved != 0 && saved != found {
            return Err(wrong(format!("checksum of a chunk is {found:08x}, not {saved:08x}")));
        }
        return split(plain, take);
    }
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(RECORD_LIMIT as usize);
    let mut reader = LinearReader::new_with_options(options);
    // What may follow the packed records in a chunk is not read: the frame is made to fit them.
    let mut prefix = [op::CHUNK; PREFIX as usize];
    prefix[1..].copy_from_slice(&(chunk.len() as u64).to_le_bytes());
    let mut source = prefix.chain(chunk);
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| wrong(error.to_string()))? {
            LinearReadEvent::ReadRequest(need) => {
                let read = source.read(reader.insert(need.min(STEP)))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
        }
    }
    Ok(())
}

/// Splits bytes into records.
fn split(mut bytes: &[u8], take: &mut Take<'_>) -> Result<(), Stop> {
    while let Some((&[opcode], rest)) = bytes.split_first_chunk() {
        let (length, rest) =
            rest.split_first_chunk().ok_or_else(|| wrong("a chunk ends within a record"))?;
        let body = usize::try_from(u64::from_le_bytes(*length))
            .ok()
            .and_then(|length| rest.get(..length))
            .ok_or_else(|| wrong("a chunk ends within a record"))?;
        take(opcode, body)?;
        bytes = &rest[body.len()..];
    }
    Ok(())
}

/// Parses a record, and checks an attachment's checksum.
fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    // The container's library counts on room for an attachment's checksum.
    if opcode == op::ATTACHMENT && !is_attachment(body) {
        return Err("an attachment that ends within its header".to_owned());
    }
    parse_record(opcode, body).map_err(|error| error.to_string())
}

/// Whether a body has room for what every attachment has: two times, two strings, a length and a checksum.
fn is_attachment(body: &[u8]) -> bool {
    let after_string = |at: usize| {
        let length = body.get(at..)?.first_chunk()?;
        Some(at + size_of::<u32>() + u32::from_le_bytes(*length) as usize)
    };
    let least = after_string(2 * size_of::<u64>()).and_then(after_string);
    least.is_some_and(|end| end + size_of::<u64>() + size_of::<u32>() <= body.len())
}
