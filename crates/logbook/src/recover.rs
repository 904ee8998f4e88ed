//! Saves what a broken log still holds into a whole container.
//!
//! Everything before the fault goes over as it is: messages byte for byte, with their numbers, time stamps,
//! channels and schemas, the files and facts the log carries, the same chunks. Indexes and checksums are made
//! anew. Nothing after the fault is taken: a log with a hole would not verify.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use mcap::records::{Metadata, Record};
use mcap::{Attachment, McapError};

use crate::container::{self, Container, failure};
use crate::read::stream::Story;
use crate::read::walk::{Found, PRIVATE, walk};
use crate::write::END;
use crate::{LogError, PartFile, Status, Store, SyncPolicy};

/// Name of the metadata record in which a recovered log says what was lost.
pub const RECOVERED: &str = "wisdom.recovered";

/// What a recovery saved, and what it did not.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Recovery {
    /// How whole the broken log was.
    pub status: Status,
    /// Where its last record ends that was kept, bytes.
    pub kept_to: u64,
    /// Bytes behind it that were left out; 0 if only indexes were lost, which are made anew.
    pub left_out: u64,
    /// Whether the run's own end was kept: the recovered log is complete then.
    pub ended: bool,
    /// Decisions kept.
    pub decisions: u32,
    /// Messages kept, decisions among them.
    pub messages: u64,
    /// Files kept.
    pub attachments: u64,
    /// Whether anything was lost that making indexes anew could not bring back: records, the run's end, or the
    /// certainty about facts and header, which have no checksum of their own but that over all data.
    pub lossy: bool,
}

/// Copies what a log holds before its first fault to the new file `to`, which is never one that exists.
///
/// A log whose run did not end gets no end: it gets the metadata `wisdom.recovered` instead, which says what
/// was lost, and readers call it truncated.
///
/// # Errors
/// [`LogError::Io`] if a file cannot be read or written; [`LogError::NotALog`] if `from` is another kind of
/// file; [`LogError::Exists`] if `to` or its part file is there. What was begun is removed then.
pub fn recover(from: &Path, to: &Path) -> Result<Recovery, LogError> {
    let failed = |source| LogError::Io { path: from.to_owned(), source };
    let mut file = BufReader::new(File::open(from).map_err(failed)?);
    let store = PartFile::create(to, SyncPolicy::End)?;
    let part = store.name();
    let saved = recover_into(from, &mut file, store);
    if saved.is_err() && part.exists() {
        // The error at hand says more than one about a file that is of no use.
        std::fs::remove_file(&part).ok();
    }
    Ok(saved?.0)
}

/// The same from any bytes, called `name`, to any store.
///
/// # Errors
/// As [`recover`].
pub fn recover_into<S: Store>(
    name: &Path,
    bytes: &mut (impl Read + Seek),
    store: S,
) -> Result<(Recovery, S::Closed), LogError> {
    let mut copy = Copy::new(store);
    let mut failed = None;
    let walked = walk(bytes, &mut |found| {
        copy.story.follow(&found)?;
        Ok(match copy.take(found) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        })
    });
    let walked = walked.map_err(|source| LogError::Io { path: name.to_owned(), source })?;
    if let Some(error) = failed {
        return Err(failure(&copy.name, error));
    }
    let status = copy.story.status(&walked);
    let status = status.ok_or_else(|| LogError::NotALog { path: name.to_owned() })?;
    let ended = !walked.doubtful && copy.story.ending() == Ok(true);
    // Behind the end of the data, and behind the run's end, there are only indexes.
    let indexes_only = walked.sealed || walked.doubtful || ended;
    let left_out = if indexes_only { 0 } else { walked.whole - walked.sound };
    let end_lost = copy.story.end.is_some() && !ended;
    let recovery = Recovery {
        status,
        kept_to: walked.sound,
        left_out,
        ended,
        decisions: copy.story.decisions(),
        messages: copy.messages,
        attachments: copy.attachments,
        // A file of which nothing is left has lost everything.
        lossy: left_out > 0 || walked.doubtful || end_lost || walked.whole == 0,
    };
    let closed = copy.finish(&recovery)?;
    Ok((recovery, closed))
}

/// The new container, and what has gone into it.
struct Copy<S: Store> {
    name: PathBuf,
    /// Until the first record says which profile the container has.
    store: Option<S>,
    container: Option<Container<S>>,
    story: Story,
    /// The run's end, which is held back until it is known to be true.
    end: Option<Metadata>,
    messages: u64,
    attachments: u64,
}

impl<S: Store> Copy<S> {
    fn new(store: S) -> Self {
        Self {
            name: store.name(),
            store: Some(store),
            container: None,
            story: Story::default(),
            end: None,
            messages: 0,
            attachments: 0,
        }
    }

    /// The container, begun with a profile if it is not yet.
    fn container(&mut self, profile: &str) -> Result<&mut Container<S>, McapError> {
        if let Some(store) = self.store.take() {
            self.container = Some(container::open(store, profile, None)?);
        }
        self.container.as_mut().ok_or(McapError::AttemptedWriteAfterFailure)
    }

    #[expect(
        clippy::default_trait_access,
        reason = "the options of private records have a type that the container's library keeps to itself"
    )]
    fn take(&mut self, found: Found<'_>) -> Result<(), McapError> {
        match found.record {
            Record::Header(header) => self.container(&header.profile).map(|_| ()),
            // The chunks stay those of the broken log.
            Record::Chunk { .. } => self.container("")?.flush(),
            Record::Schema { header, data } => self
                .container("")?
                .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
                .map(|_| ()),
            Record::Channel(c) => self
                .container("")?
                .add_channel_with_id(c.id, c.schema_id, &c.topic, &c.message_encoding, &c.metadata)
                .map(|_| ()),
            Record::Message { header, data } => {
                self.messages += 1;
                self.container("")?.write_to_known_channel(&header, &data)
            }
            Record::Attachment { header, data, .. } => {
                self.attachments += 1;
                let attachment = Attachment {
                    log_time: header.log_time,
                    create_time: header.create_time,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                };
                self.container("")?.attach(&attachment)
            }
            Record::Metadata(metadata) if metadata.name == END => {
                self.end = Some(metadata);
                Ok(())
            }
            Record::Metadata(metadata) => self.container("")?.write_metadata(&metadata),
            Record::Unknown { opcode, data } if opcode >= PRIVATE => {
                self.container("")?.write_private_record(opcode, &data, Default::default())
            }
            _ => Ok(()),
        }
    }

    fn finish(mut self, recovery: &Recovery) -> Result<S::Closed, LogError> {
        let told_before = self.story.recovered.is_some();
        let last = match self.end.take() {
            Some(end) if recovery.ended => Some(end),
            _ if told_before && !recovery.lossy => None,
            _ => Some(Metadata { name: RECOVERED.to_owned(), metadata: facts(recovery) }),
        };
        let written = self.container("").and_then(|container| match &last {
            Some(last) => container.write_metadata(last),
            None => Ok(()),
        });
        written.map_err(|error| failure(&self.name, error))?;
        let container = self.container.take().expect("it was just written to");
        container::close(container, &self.name)
    }
}

/// What a recovered log says of its recovery.
fn facts(recovery: &Recovery) -> BTreeMap<String, String> {
    [
        ("log_was", recovery.status.to_string()),
        ("kept_to_byte", recovery.kept_to.to_string()),
        ("bytes_left_out", recovery.left_out.to_string()),
        ("decisions", recovery.decisions.to_string()),
        ("messages", recovery.messages.to_string()),
        ("attachments", recovery.attachments.to_string()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}
