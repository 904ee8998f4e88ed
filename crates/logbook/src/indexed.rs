//! Opens a log by its index: what it holds and any one decision, without reading the rest.
//!
//! Header, footer and summary are read and the summary's checksum is checked; a chunk is read when something in it
//! is asked for, and its checksum is checked then. The checksum over all data, and that decisions follow from each
//! other, are the business of [`LogReader`](crate::LogReader) and [`check`](crate::check()). A log without a footer,
//! or with a summary that does not hold, is read from its beginning, as far as the answer needs.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use mcap::MAGIC;
use mcap::records::{AttachmentIndex, ChunkIndex, MetadataIndex, Record, Statistics};

use crate::read::stream::{Names, Story, entry, run_end};
use crate::read::walk::{DATA_END, FOOTER, Fault, Frames, PREFIX, Stop};
use crate::read::{Attachment, Entry, Item, RunEnd, Status, one_chunk};
use crate::recover::RECOVERED;
use crate::write::{END, RUN};
use crate::{LogError, record, topic};

/// A file that a log carries, unread.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct AttachmentAt {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its size, bytes.
    pub bytes: u64,
}

/// What a log holds, counted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Contents {
    /// Messages of each topic.
    pub topics: BTreeMap<String, u64>,
    /// First and last time stamp, nanoseconds of mission time; absent if there are no messages.
    pub span_ns: Option<(u64, u64)>,
    /// How the run ended; absent if it did not.
    pub end: Option<RunEnd>,
    /// What was lost in a recovery, if the log comes out of one.
    pub recovered: Option<BTreeMap<String, String>>,
    /// How whole the log is, if it had to be read to its end; absent if its index answered for it.
    pub status: Option<Status>,
}

impl Contents {
    /// Decisions in the log.
    #[must_use]
    pub fn decisions(&self) -> u64 {
        self.topics.get(topic::DECISION).copied().unwrap_or_default()
    }
}

/// A log that is read piece by piece.
#[derive(Debug)]
pub struct IndexedLog<R = BufReader<File>> {
    /// What was true of the whole run, by name; empty if the file ends before it.
    pub metadata: BTreeMap<String, String>,
    /// The files it carries; without an index those before its first message, which is where a run's are.
    pub attachments: Vec<AttachmentAt>,
    /// Why there is no index to go by, if so.
    pub without_index: Option<String>,
    path: PathBuf,
    bytes: R,
    names: Names,
    index: Option<Index>,
}

/// The summary of a whole file.
#[derive(Debug, Default)]
struct Index {
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    metadata: Vec<MetadataIndex>,
    statistics: Statistics,
    end: Option<RunEnd>,
    recovered: Option<BTreeMap<String, String>>,
}

impl IndexedLog {
    /// Opens a log file, finished or not.
    ///
    /// # Errors
    /// [`LogError::Io`] if the file cannot be read; [`LogError::NotALog`] if it is another kind of file.
    ///
    /// ```no_run
    /// let mut log = wisdom_logbook::IndexedLog::open("logs/run.mcap".as_ref())?;
    /// let decision = log.decision(7)?;
    /// println!("{} chose {:?}", log.metadata["mission"], decision.choice);
    /// # Ok::<(), wisdom_logbook::LogError>(())
    /// ```
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let file =
            File::open(path).map_err(|source| LogError::Io { path: path.to_owned(), source })?;
        Self::over(path, BufReader::new(file))
    }
}

impl<R: Read + Seek> IndexedLog<R> {
    /// Opens a log in any bytes; errors call it `name`.
    ///
    /// # Errors
    /// As [`IndexedLog::open`].
    pub fn over(name: &Path, bytes: R) -> Result<Self, LogError> {
        let mut log = Self {
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            without_index: None,
            path: name.to_owned(),
            bytes,
            names: Names::default(),
            index: None,
        };
        match log.by_index() {
            Ok(()) => return Ok(log),
            Err(Stop::Io(source)) => return Err(log.io(source)),
            Err(Stop::Fault(Fault::NotALog)) => return Err(LogError::NotALog { path: log.path }),
            Err(Stop::Fault(fault)) => log.without_index = Some(fault.to_string()),
            Err(Stop::Enough) => {}
        }
        log.by_stream()?;
        Ok(log)
    }

    fn io(&self, source: io::Error) -> LogError {
        LogError::Io { path: self.path.clone(), source }
    }

    fn by_index(&mut self) -> Result<(), Stop> {
        let wrong = |detail: &str| Stop::Fault(Fault::Wrong(detail.to_owned()));
        let whole = self.bytes.seek(SeekFrom::End(0))?;
        let magic = MAGIC.len() as u64;
        let footer_bytes = PREFIX + FOOTER as u64 + magic;
        let mut first = [0; MAGIC.len()];
        let there = whole.min(magic) as usize;
        self.bytes.seek(SeekFrom::Start(0))?;
        self.bytes.read_exact(&mut first[..there])?;
        if first[..there] != MAGIC[..there] {
            return Err(Stop::Fault(Fault::NotALog));
        }
        if whole < magic + DATA_END + footer_bytes {
            return Err(wrong("the file ends before its footer"));
        }
        let footer_start = whole - footer_bytes;
        self.bytes.seek(SeekFrom::Start(footer_start))?;
        let mut frames = Frames::new(&mut self.bytes, footer_start, whole);
        let summary_start = match frames.advance().and_then(|()| frames.record()) {
            Ok(Record::Footer(footer)) => footer.summary_start,
            Err(Stop::Io(error)) => return Err(Stop::Io(error)),
            _ => return Err(wrong("the file does not end with a footer")),
        };
        if summary_start < magic + DATA_END || summary_start > footer_start {
            return Err(wrong("the file has no summary"));
        }
        let data_end = summary_start - DATA_END;
        self.bytes.seek(SeekFrom::Start(data_end))?;
        let mut frames = Frames::new(&mut self.bytes, data_end, whole);
        let (mut index, mut names, mut counted) = (Index::default(), Names::default(), false);
        frames.advance()?;
        frames.tail(None, &mut |found| {
            match found.record {
                Record::Statistics(statistics) => (index.statistics, counted) = (statistics, true),
                Record::ChunkIndex(chunk) => index.chunks.push(chunk),
                Record::AttachmentIndex(attachment) => index.attachments.push(attachment),
                Record::MetadataIndex(metadata) => index.metadata.push(metadata),
                record => names.learn(&record)?,
            }
            Ok(ControlFlow::Continue(()))
        })?;
        let indexed = index.chunks.len() as u64 == u64::from(index.statistics.chunk_count);
        if !counted || !indexed {
            return Err(wrong("the summary has no index of all chunks"));
        }
        index.chunks.sort_by_key(|chunk| chunk.chunk_start_offset);
        self.facts(&mut index, whole)?;
        self.attachments = index
            .attachments
            .iter()
            .map(|at| AttachmentAt {
                name: at.name.clone(),
                media_type: at.media_type.clone(),
                bytes: at.data_size,
            })
            .collect();
        (self.names, self.index) = (names, Some(index));
        Ok(())
    }

    /// Reads the facts that the index points to.
    fn facts(&mut self, index: &mut Index, whole: u64) -> Result<(), Stop> {
        let wrong = |detail: String| Stop::Fault(Fault::Wrong(detail));
        for at in std::mem::take(&mut index.metadata) {
            let read = frame_at(&mut self.bytes, at.offset, whole)?;
            let found = match read.record()? {
                Record::Metadata(found) if found.name == at.name => found.metadata,
                _ => return Err(wrong(format!("no {} at byte {}", at.name, at.offset))),
            };
            match at.name.as_str() {
                RUN => self.metadata = found,
                END => index.end = Some(run_end(found).map_err(wrong)?),
                RECOVERED => index.recovered = Some(found),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads the beginning, up to the first message.
    fn by_stream(&mut self) -> Result<(), LogError> {
        let Self { metadata, attachments, bytes, .. } = self;
        (*metadata, *attachments) = (BTreeMap::new(), Vec::new());
        let mut story = Story::default();
        let walked = story.read(bytes, &mut |item| {
            match item {
                Item::Metadata { name: RUN, facts } => metadata.clone_from(facts),
                Item::Metadata { .. } => {}
                Item::Attachment { name, media_type, data } => attachments.push(AttachmentAt {
                    name: name.to_owned(),
                    media_type: media_type.to_owned(),
                    bytes: data.len() as u64,
                }),
                Item::Entry { .. } | Item::View { .. } => return ControlFlow::Break(()),
            }
            ControlFlow::Continue(())
        });
        match walked {
            Err(source) => Err(self.io(source)),
            Ok(walked) if matches!(walked.fault, Some(Fault::NotALog)) => {
                Err(LogError::NotALog { path: self.path.clone() })
            }
            Ok(_) => Ok(()),
        }
    }

    /// What the log holds, counted: from the index, or by reading all of it.
    ///
    /// # Errors
    /// [`LogError::Io`] if the file cannot be read.
    pub fn contents(&mut self) -> Result<Contents, LogError> {
        let Some(index) = &self.index else { return self.counted() };
        let statistics = &index.statistics;
        let mut topics = BTreeMap::new();
        for (channel, count) in &statistics.channel_message_counts {
            let topic = self.names.topic(*channel).unwrap_or("?");
            *topics.entry(topic.to_owned()).or_default() += count;
        }
        let span = (statistics.message_start_time, statistics.message_end_time);
        Ok(Contents {
            topics,
            span_ns: (statistics.message_count > 0).then_some(span),
            end: index.end.clone(),
            recovered: index.recovered.clone(),
            status: None,
        })
    }

    fn counted(&mut self) -> Result<Contents, LogError> {
        let mut contents = Contents::default();
        let mut story = Story::default();
        let walked = story.read(&mut self.bytes, &mut |item| {
            if let Item::Entry { at, .. } | Item::View { at, .. } = item {
                *contents.topics.entry(at.topic.to_owned()).or_default() += 1;
                let stamp = at.stamp_ns;
                let (first, last) = contents.span_ns.unwrap_or((stamp, stamp));
                contents.span_ns = Some((first.min(stamp), last.max(stamp)));
            }
            ControlFlow::Continue(())
        });
        let walked = walked.map_err(|source| self.io(source))?;
        contents.status = story.status(&walked);
        (contents.end, contents.recovered) = (story.end, story.recovered);
        Ok(contents)
    }

    /// The decision `number`, counted from 0.
    ///
    /// # Errors
    /// [`LogError::NoDecision`] if the log has no such decision before its first fault; [`LogError::Damaged`] if what
    /// the index points at is not what was written; [`LogError::Io`] if the file cannot be read.
    pub fn decision(&mut self, number: u32) -> Result<record::Decision, LogError> {
        let mut wanted = None;
        let mut take = |item: Item<'_>| match item {
            Item::Entry { entry: Entry::Decision(decision), .. } if decision.number == number => {
                wanted = Some(*decision);
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        };
        if self.index.is_some() {
            let chunk = self.chunk_of(number)?;
            let found = self.chunk(chunk, &mut take)?.is_break();
            let missing = || self.damaged(chunk, format!("no decision {number} here"));
            return wanted.filter(|_| found).ok_or_else(missing);
        }
        let found = self.scan_until(&mut take)?;
        wanted.ok_or_else(|| self.no_decision(number, found))
    }

    /// Everything that was logged after decision `number - 1`, or from the beginning, up to decision `number`.
    ///
    /// # Errors
    /// As [`Self::decision`].
    pub fn cycle(
        &mut self,
        number: u32,
        take: &mut dyn FnMut(Item<'_>) -> ControlFlow<()>,
    ) -> Result<(), LogError> {
        let mut begun = number == 0;
        let (mut ended, mut stopped) = (false, false);
        let mut within = |item: Item<'_>| {
            let decision = match &item {
                Item::Entry { entry: Entry::Decision(decision), .. } => Some(decision.number),
                Item::Metadata { .. } | Item::Attachment { .. } => return ControlFlow::Continue(()),
                _ => None,
            };
            if begun && take(item).is_break() {
                stopped = true;
                return ControlFlow::Break(());
            }
            begun |= decision.is_some_and(|found| found + 1 == number);
            ended = decision == Some(number);
            if ended { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let Some(index) = &self.index else {
            let found = self.scan_until(&mut within)?;
            return if ended || stopped { Ok(()) } else { Err(self.no_decision(number, found)) };
        };
        let starts: Vec<u64> = index.chunks.iter().map(|chunk| chunk.chunk_start_offset).collect();
        let last = self.chunk_of(number)?;
        // The decision before it says where the cycle begins.
        let first = match number.checked_sub(1) {
            Some(before) => self.chunk_of(before)?,
            None => 0,
        };
        for start in starts.into_iter().filter(|start| (first..=last).contains(start)) {
            if self.chunk(start, &mut within)?.is_break() {
                break;
            }
        }
        Ok(())
    }

    /// The first attachment of a name, if there is one.
    ///
    /// # Errors
    /// [`LogError::Damaged`] if it is not what was written; [`LogError::Io`] if the file cannot be read.
    pub fn attachment(&mut self, name: &str) -> Result<Option<Attachment>, LogError> {
        let Some(index) = &self.index else {
            let mut wanted = None;
            self.scan_until(&mut |item| match item {
                Item::Attachment { name: found, media_type, data } if found == name => {
                    let media_type = media_type.to_owned();
                    wanted =
                        Some(Attachment { name: name.to_owned(), media_type, data: data.to_vec() });
                    ControlFlow::Break(())
                }
                _ => ControlFlow::Continue(()),
            })?;
            return Ok(wanted);
        };
        let Some(at) = index.attachments.iter().find(|at| at.name == name).map(|at| at.offset)
        else {
            return Ok(None);
        };
        let whole = self.bytes.seek(SeekFrom::End(0)).map_err(|source| self.io(source))?;
        let read = frame_at(&mut self.bytes, at, whole).and_then(|frame| match frame.record()? {
            Record::Attachment { header, data, .. } if header.name == name => Ok(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            _ => Err(Stop::Fault(Fault::Wrong(format!("no attachment {name} here")))),
        });
        read.map(Some).map_err(|stop| self.stopped(at, stop))
    }

    fn no_decision(&self, decision: u32, found: u64) -> LogError {
        LogError::NoDecision { path: self.path.clone(), decision, found }
    }

    fn damaged(&self, byte: u64, detail: String) -> LogError {
        LogError::Damaged { path: self.path.clone(), byte, detail }
    }

    fn stopped(&self, byte: u64, stop: Stop) -> LogError {
        match stop {
            Stop::Io(source) => self.io(source),
            Stop::Fault(fault) => self.damaged(byte, fault.to_string()),
            Stop::Enough => self.damaged(byte, "nothing here".to_owned()),
        }
    }

    /// Reads from the beginning until `take` breaks; returns the decisions met.
    fn scan_until(
        &mut self,
        take: &mut dyn FnMut(Item<'_>) -> ControlFlow<()>,
    ) -> Result<u64, LogError> {
        let mut story = Story::default();
        story.read(&mut self.bytes, take).map_err(|source| self.io(source))?;
        Ok(u64::from(story.decisions()))
    }

    /// Where the chunk begins that holds a decision.
    fn chunk_of(&mut self, number: u32) -> Result<u64, LogError> {
        let whole = self.bytes.seek(SeekFrom::End(0)).map_err(|source| self.io(source))?;
        let Some(index) = &self.index else { return Err(self.no_decision(number, 0)) };
        let channels: Vec<u16> = self.names.channels_of(topic::DECISION).collect();
        let counts = &index.statistics.channel_message_counts;
        let all: u64 = channels.iter().filter_map(|channel| counts.get(channel)).sum();
        if u64::from(number) >= all {
            return Err(self.no_decision(number, all));
        }
        let holds = |chunk: &&ChunkIndex| {
            channels.iter().any(|channel| chunk.message_index_offsets.contains_key(channel))
        };
        let with: Vec<&ChunkIndex> = index.chunks.iter().filter(holds).collect();
        if with.len() as u64 == all {
            return Ok(with[number as usize].chunk_start_offset);
        }
        // Another tool put several into a chunk: the messages' own indexes tell how many.
        let mut before = 0;
        for chunk in with {
            let indexes =
                channels.iter().filter_map(|channel| chunk.message_index_offsets.get(channel));
            for &at in indexes {
                let read = frame_at(&mut self.bytes, at, whole).and_then(|frame| {
                    match frame.record()? {
                        Record::MessageIndex(messages) => Ok(messages.records.len() as u64),
                        _ => Err(Stop::Fault(Fault::Wrong("no message index here".to_owned()))),
                    }
                });
                before += match read {
                    Ok(count) => count,
                    Err(stop) => return Err(self.stopped(at, stop)),
                };
            }
            if u64::from(number) < before {
                return Ok(chunk.chunk_start_offset);
            }
        }
        Err(self.no_decision(number, before))
    }

    /// Reads the chunk that begins at a byte until `take` breaks.
    fn chunk(
        &mut self,
        start: u64,
        take: &mut dyn FnMut(Item<'_>) -> ControlFlow<()>,
    ) -> Result<ControlFlow<()>, LogError> {
        let mut flow = ControlFlow::Continue(());
        let names = &self.names;
        let read = one_chunk(&mut self.bytes, start, &mut |found| {
            if let Record::Message { header, data } = &found.record {
                let at = names.at(header, data.len(), start)?;
                flow = take(match entry(at, data)? {
                    Some(entry) => Item::Entry { at, entry },
                    None => Item::View { at, data },
                });
            }
            Ok(flow)
        });
        match read {
            Ok(Ok(())) => Ok(flow),
            Ok(Err(detail)) => Err(self.damaged(start, detail)),
            Err(source) => Err(self.io(source)),
        }
    }
}

/// The record that begins at a byte.
fn frame_at<R: Read + Seek>(bytes: &mut R, at: u64, whole: u64) -> Result<Frames<&mut R>, Stop> {
    bytes.seek(SeekFrom::Start(at))?;
    let mut frame = Frames::new(bytes, at, whole);
    frame.advance()?;
    Ok(frame)
}
