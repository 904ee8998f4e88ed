//! Checks everything about a log that can be checked without deciding anything again.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::{AttachmentIndex, ChunkIndex, Footer, MetadataIndex, Record, Statistics, op};

use super::Status;
use super::stream::{Names, Story};
use super::walk::{Fault, Found, walk};
use crate::LogError;

/// Whether something holds.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// It holds, throughout what was read.
    Holds,
    /// It does not; the first place where.
    Fails(String),
    /// It could not be checked; why.
    Unchecked(String),
}

/// One thing that was checked.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finding {
    /// What should hold.
    pub what: &'static str,
    /// Whether it does.
    pub verdict: Verdict,
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Check {
    /// Whether the log is whole: [`Status::Corrupt`] as soon as one finding fails.
    pub status: Status,
    /// Everything that was checked.
    pub findings: Vec<Finding>,
    /// Decisions before the first fault.
    pub decisions: u32,
    /// Messages before the first fault.
    pub messages: u64,
    /// Bytes of the file.
    pub bytes: u64,
    /// Where the last record ends before the first fault, bytes.
    pub sound: u64,
}

/// Checks a log: every checksum, that indexes and summary say what the data hold, that numbers have no gaps,
/// that decisions follow from their chain and end as the end record says, and that no two time stamps are equal or
/// fall.
///
/// # Errors
/// [`LogError::Io`] if the file cannot be read; [`LogError::NotALog`] if it is another kind of file.
pub fn check(path: &Path) -> Result<Check, LogError> {
    let failed = |source| LogError::Io { path: path.to_owned(), source };
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    check_bytes(path, &mut file)
}

/// The same for any bytes, called `name`.
///
/// # Errors
/// As [`check`].
pub fn check_bytes(name: &Path, bytes: &mut (impl Read + Seek)) -> Result<Check, LogError> {
    let mut story = Story::default();
    let mut seen = Seen::default();
    let mut out_of_story = None;
    let walked = walk(bytes, &mut |found| {
        seen.note(&found);
        if seen.in_data()
            && let Err(detail) = story.follow(&found)
        {
            out_of_story = Some(detail.clone());
            return Err(detail);
        }
        Ok(ControlFlow::Continue(()))
    });
    let walked = walked.map_err(|source| LogError::Io { path: name.to_owned(), source })?;
    let mut status =
        story.status(&walked).ok_or_else(|| LogError::NotALog { path: name.to_owned() })?;
    // A fault is told where it belongs: what ends a walk may be any of three checksums.
    let in_summary = walked.sealed && seen.footer.is_none();
    let container = match (&walked.fault, &out_of_story) {
        (Some(Fault::Ends(detail)), None) => Verdict::Unchecked(detail.clone()),
        (Some(fault), None) if !(walked.doubtful || in_summary) => {
            Verdict::Fails(fault.to_string())
        }
        _ => Verdict::Holds,
    };
    let fault = match &walked.fault {
        Some(Fault::Wrong(detail)) => Some(detail.as_str()),
        _ => None,
    };
    let finding = |what, verdict| Finding { what, verdict };
    let findings = vec![
        finding("frames, and checksums of chunks and attachments", container),
        finding("checksum of all data", seen.data_sum(fault.filter(|_| walked.doubtful))),
        finding("checksum of the summary", seen.summary_sum(fault.filter(|_| in_summary))),
        finding("message indexes point at the messages", seen.indexes()),
        finding("the summary says what the data hold", seen.summary(&story.names)),
        finding(
            "records without gaps, decisions by their chain",
            match out_of_story {
                Some(detail) => Verdict::Fails(detail),
                None => Verdict::Holds,
            },
        ),
        finding(
            "the run ended as its end record says",
            match story.ending() {
                Ok(true) => Verdict::Holds,
                Ok(false) => Verdict::Unchecked("there is no wisdom.end".to_owned()),
                Err(detail) => Verdict::Fails(detail),
            },
        ),
        finding("time stamps rise", seen.stamps.map_or(Verdict::Holds, Verdict::Fails)),
    ];
    let first = findings.iter().find_map(|finding| match &finding.verdict {
        Verdict::Fails(detail) => Some(format!("{}: {detail}", finding.what)),
        _ => None,
    });
    if let (Some(detail), false) = (first, matches!(status, Status::Corrupt { .. })) {
        status = Status::Corrupt { byte: walked.byte, detail };
    }
    Ok(Check {
        status,
        findings,
        decisions: story.decisions(),
        messages: seen.statistics.message_count,
        bytes: walked.whole,
        sound: walked.sound,
    })
}

/// What the data hold, and what the summary says of it.
#[derive(Default)]
struct Seen {
    statistics: Statistics,
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    metadata: Vec<MetadataIndex>,
    /// Of the last chunk, by channel: time stamp and place of each message.
    open: BTreeMap<u16, Vec<(u64, u64)>>,
    /// Its first and last time stamp and its bytes, as its header says and as they are.
    header: Option<((u64, u64), u64)>,
    bounds: Option<(u64, u64)>,
    unpacked: u64,
    last_stamp: Option<u64>,
    stamps: Option<String>,
    index_fault: Option<String>,
    /// Saved checksum of the data, once they ended.
    data_end: Option<u32>,
    /// Of the summary: the records it repeats, its groups as (kind, first byte, bytes), and its offsets.
    names: Names,
    told: Told,
    groups: Vec<(u8, u64, u64)>,
    offsets: Vec<(u8, u64, u64)>,
    offsets_start: u64,
    summary_start: Option<u64>,
    footer: Option<Footer>,
    summary_fault: Option<String>,
}

/// What the summary says.
#[derive(Default)]
struct Told {
    statistics: Option<Statistics>,
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    metadata: Vec<MetadataIndex>,
}

impl Seen {
    /// Whether the data have not ended yet.
    fn in_data(&self) -> bool {
        self.data_end.is_none()
    }

    fn note(&mut self, found: &Found<'_>) {
        if self.in_data() { self.note_data(found) } else { self.note_summary(found) }
    }

    fn note_data(&mut self, found: &Found<'_>) {
        if found.offset.is_none() && !matches!(found.record, Record::MessageIndex(_)) {
            self.close_chunk();
        }
        match &found.record {
            Record::Chunk { header, .. } => {
                self.statistics.chunk_count += 1;
                self.header = Some((
                    (header.message_start_time, header.message_end_time),
                    header.uncompressed_size,
                ));
                self.chunks.push(ChunkIndex {
                    message_start_time: header.message_start_time,
                    message_end_time: header.message_end_time,
                    chunk_start_offset: found.start,
                    chunk_length: found.length,
                    message_index_offsets: BTreeMap::new(),
                    message_index_length: 0,
                    compression: header.compression.clone(),
                    compressed_size: header.compressed_size,
                    uncompressed_size: header.uncompressed_size,
                });
            }
            Record::Message { header, data } => {
                let statistics = &mut self.statistics;
                statistics.message_count += 1;
                *statistics.channel_message_counts.entry(header.channel_id).or_default() += 1;
                let stamp = header.log_time;
                let all = (statistics.message_start_time, statistics.message_end_time);
                let first = statistics.message_count == 1;
                let (earliest, latest) = if first { (stamp, stamp) } else { all };
                statistics.message_start_time = earliest.min(stamp);
                statistics.message_end_time = latest.max(stamp);
                let (earliest, latest) = self.bounds.unwrap_or((stamp, stamp));
                self.bounds = Some((earliest.min(stamp), latest.max(stamp)));
                if let Some(last) = self.last_stamp.filter(|last| *last >= stamp)
                    && self.stamps.is_none()
                {
                    let (channel, number) = (header.channel_id, header.sequence);
                    self.stamps = Some(format!(
                        "message {number} of channel {channel} is at {stamp} ns, the one before it at {last} ns"
                    ));
                }
                self.last_stamp = Some(stamp);
                if let Some(offset) = found.offset {
                    self.open.entry(header.channel_id).or_default().push((stamp, offset));
                    // Opcode, length, channel, number and two time stamps go before the data.
                    self.unpacked = offset + 31 + data.len() as u64;
                }
            }
            Record::MessageIndex(index) => {
                let mut entries: Vec<_> =
                    index.records.iter().map(|entry| (entry.log_time, entry.offset)).collect();
                entries.sort_unstable();
                let mut messages = self.open.remove(&index.channel_id).unwrap_or_default();
                messages.sort_unstable();
                if entries != messages {
                    let (channel, start) = (index.channel_id, found.start);
                    self.index_fault.get_or_insert(format!(
                        "the index of channel {channel} at byte {start} names other messages"
                    ));
                }
                if let Some(chunk) = self.chunks.last_mut() {
                    if !index.records.is_empty() {
                        chunk.message_index_offsets.insert(index.channel_id, found.start);
                    }
                    chunk.message_index_length += found.length;
                }
            }
            Record::Attachment { header, data, .. } => {
                self.statistics.attachment_count += 1;
                self.attachments.push(AttachmentIndex {
                    offset: found.start,
                    length: found.length,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name.clone(),
                    media_type: header.media_type.clone(),
                });
            }
            Record::Metadata(metadata) => {
                self.statistics.metadata_count += 1;
                self.metadata.push(MetadataIndex {
                    offset: found.start,
                    length: found.length,
                    name: metadata.name.clone(),
                });
            }
            Record::DataEnd(end) => self.data_end = Some(end.data_section_crc),
            _ => {}
        }
    }

    /// Ends the last chunk: its header must have told the truth, and every message must have been indexed.
    fn close_chunk(&mut self) {
        if let Some((told, bytes)) = self.header.take() {
            let found = self.bounds.unwrap_or((0, 0));
            if told != found {
                self.index_fault.get_or_insert(format!(
                    "a chunk says its messages are from {} to {} ns; they are from {} to {} ns",
                    told.0, told.1, found.0, found.1
                ));
            }
            if self.bounds.is_some() && bytes < self.unpacked {
                let unpacked = self.unpacked;
                self.index_fault
                    .get_or_insert(format!("a chunk of {unpacked} bytes says it has {bytes}"));
            }
        }
        if let Some(channel) = self.open.keys().next() {
            self.index_fault
                .get_or_insert(format!("messages of channel {channel} are in no index"));
        }
        (self.bounds, self.unpacked) = (None, 0);
        self.open.clear();
    }

    fn note_summary(&mut self, found: &Found<'_>) {
        let opcode = found.record.opcode();
        if opcode != op::FOOTER {
            self.summary_start.get_or_insert(found.start);
        }
        match &found.record {
            Record::SummaryOffset(offset) => {
                if self.offsets.is_empty() {
                    self.offsets_start = found.start;
                }
                self.offsets.push((offset.group_opcode, offset.group_start, offset.group_length));
                return;
            }
            Record::Footer(footer) => {
                self.footer = Some(*footer);
                return;
            }
            Record::Statistics(statistics) => self.told.statistics = Some(statistics.clone()),
            Record::ChunkIndex(index) => self.told.chunks.push(index.clone()),
            Record::AttachmentIndex(index) => self.told.attachments.push(index.clone()),
            Record::MetadataIndex(index) => self.told.metadata.push(index.clone()),
            record => {
                if let Err(detail) = self.names.learn(record) {
                    self.summary_fault.get_or_insert(detail);
                }
            }
        }
        match self.groups.last_mut() {
            Some((kind, _, length)) if *kind == opcode => *length += found.length,
            _ => self.groups.push((opcode, found.start, found.length)),
        }
    }

    fn data_sum(&self, fault: Option<&str>) -> Verdict {
        match self.data_end {
            _ if fault.is_some() => Verdict::Fails(fault.unwrap_or_default().to_owned()),
            None => Verdict::Unchecked("the end of the data was not reached".to_owned()),
            Some(0) => Verdict::Unchecked("the file has none".to_owned()),
            Some(_) => Verdict::Holds,
        }
    }

    fn summary_sum(&self, fault: Option<&str>) -> Verdict {
        match self.footer {
            _ if fault.is_some() => Verdict::Fails(fault.unwrap_or_default().to_owned()),
            None => Verdict::Unchecked("the footer was not reached".to_owned()),
            Some(Footer { summary_crc: 0, .. }) => {
                Verdict::Unchecked("the file has none".to_owned())
            }
            Some(_) => Verdict::Holds,
        }
    }

    fn indexes(&self) -> Verdict {
        self.index_fault.clone().map_or(Verdict::Holds, Verdict::Fails)
    }

    /// Whether the summary repeats and counts what the data hold.
    fn summary(&self, names: &Names) -> Verdict {
        let Some(footer) = self.footer else {
            return Verdict::Unchecked("the footer was not reached".to_owned());
        };
        if let Some(detail) = &self.summary_fault {
            return Verdict::Fails(detail.clone());
        }
        let Some(start) = self.summary_start else {
            return match footer.summary_start {
                0 => Verdict::Unchecked("the file has none".to_owned()),
                told => Verdict::Fails(format!("the footer says it begins at byte {told}")),
            };
        };
        let statistics = Statistics {
            schema_count: names.schema_count() as u16,
            channel_count: names.channel_count() as u32,
            ..self.statistics.clone()
        };
        let Told { statistics: told, chunks, attachments, metadata } = &self.told;
        let fails = [
            (footer.summary_start != start, "where the summary begins"),
            (footer.summary_offset_start != self.offsets_start, "where its offsets begin"),
            (self.offsets != self.groups, "where each kind of record begins and ends"),
            (self.names != *names, "schemas and channels"),
            (told.as_ref() != Some(&statistics), "how many of each kind there are, and when"),
            (*chunks != self.chunks, "where the chunks are"),
            (*attachments != self.attachments, "where the attachments are"),
            (*metadata != self.metadata, "where the metadata are"),
        ];
        let first = fails.into_iter().find_map(|(differs, what)| differs.then_some(what));
        first.map_or(Verdict::Holds, |what| Verdict::Fails(format!("it errs about {what}")))
    }
}
