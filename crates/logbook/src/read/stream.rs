//! A log item by item: what each record means, and whether it follows from those before it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::ops::ControlFlow;
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use prost::Message as _;
use prost::encoding::DecodeContext;

use super::walk::{Fault, Found, Walked, walk};
use super::{Entry, MAPS, RunEnd, Status};
use crate::comparison::MERGED;
use crate::record::{self, CHAIN_START, hex};
use crate::recover::RECOVERED;
use crate::write::{END, PLANES, RUN};
use crate::{LogError, topic};

/// Which message an item is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct MessageAt<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// The name of its schema; empty if it has none.
    pub schema: &'a str,
    /// Its channel in the container.
    pub channel: u16,
    /// Its sequence number: for most topics the decision it belongs to.
    pub number: u32,
    /// Its time stamp: mission time in nanoseconds, one more for each message that shares it.
    pub stamp_ns: u64,
    /// Its size as it was logged, bytes.
    pub bytes: usize,
    /// Where its chunk begins in the file, bytes.
    pub chunk: u64,
}

/// One thing that a log holds.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Item<'a> {
    /// Facts by name; `wisdom.run` opens a log, `wisdom.end` closes it.
    Metadata {
        /// What they are about.
        name: &'a str,
        /// The facts.
        facts: &'a BTreeMap<String, String>,
    },
    /// A file that the log carries.
    Attachment {
        /// Its name.
        name: &'a str,
        /// Its media type.
        media_type: &'a str,
        /// Its bytes.
        data: &'a [u8],
    },
    /// A record of the run; it follows from those before it.
    Entry {
        /// Which message it is.
        at: MessageAt<'a>,
        /// The record.
        entry: Entry,
    },
    /// A message for viewers, or of a topic that this version does not know.
    View {
        /// Which message it is.
        at: MessageAt<'a>,
        /// Its bytes.
        data: &'a [u8],
    },
}

/// Reads a log item by item until `take` breaks, the file ends, or something does not hold. No more than one
/// chunk or attachment is in memory. What is given on was checked by everything known so far; the status says
/// at the end what all of it is worth, and is absent if `take` broke.
///
/// # Errors
/// [`LogError::Io`] if the file cannot be read; [`LogError::NotALog`] if it is another kind of file.
///
/// ```no_run
/// use std::ops::ControlFlow;
/// use wisdom_logbook::read::{Item, stream};
///
/// let mut decisions = 0;
/// let status = stream("logs/run.mcap".as_ref(), &mut |item| {
///     decisions += u32::from(matches!(item, Item::Entry { at, .. } if at.topic == "/decision"));
///     ControlFlow::Continue(())
/// })?;
/// # Ok::<(), wisdom_logbook::LogError>(())
/// ```
pub fn stream(
    path: &Path,
    take: &mut dyn FnMut(Item<'_>) -> ControlFlow<()>,
) -> Result<Option<Status>, LogError> {
    let failed = |source| LogError::Io { path: path.to_owned(), source };
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let mut story = Story::default();
    let walked = story.read(&mut file, take).map_err(failed)?;
    if walked.stopped {
        return Ok(None);
    }
    story.status(&walked).map(Some).ok_or_else(|| LogError::NotALog { path: path.to_owned() })
}

/// What channels and schemas are called.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Names {
    /// Name, encoding and bytes of each schema.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    channels: BTreeMap<u16, mcap::records::Channel>,
}

impl Names {
    /// Notes a schema or a channel, which may be said again but not otherwise.
    pub(crate) fn learn(&mut self, record: &Record<'_>) -> Result<(), String> {
        match record {
            Record::Schema { header, data } => {
                let schema =
                    (header.name.clone(), header.encoding.clone(), data.clone().into_owned());
                let id = header.id;
                if id == 0 {
                    return Err("a schema with the number 0".to_owned());
                }
                if *self.schemas.entry(id).or_insert_with(|| schema.clone()) != schema {
                    return Err(format!("schema {id} is said twice, and not the same"));
                }
            }
            Record::Channel(channel) => {
                let (id, schema) = (channel.id, channel.schema_id);
                if schema != 0 && !self.schemas.contains_key(&schema) {
                    return Err(format!("channel {id} has schema {schema}, which is not there"));
                }
                if self.channels.entry(id).or_insert_with(|| channel.clone()) != channel {
                    return Err(format!("channel {id} is said twice, and not the same"));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The channels of a topic.
    pub(crate) fn channels_of(&self, topic: &str) -> impl Iterator<Item = u16> {
        self.channels.values().filter(move |channel| channel.topic == topic).map(|c| c.id)
    }

    /// The topic of a channel.
    pub(crate) fn topic(&self, channel: u16) -> Option<&str> {
        self.channels.get(&channel).map(|channel| channel.topic.as_str())
    }

    pub(crate) fn schema_count(&self) -> usize {
        self.schemas.len()
    }

    pub(crate) fn channel_count(&self) -> usize {
        self.channels.len()
    }

    /// Which message it is.
    pub(crate) fn at(
        &self,
        header: &MessageHeader,
        bytes: usize,
        chunk: u64,
    ) -> Result<MessageAt<'_>, String> {
        let id = header.channel_id;
        let channel = self
            .channels
            .get(&id)
            .ok_or_else(|| format!("a message on channel {id}, which has no topic"))?;
        let schema = self.schemas.get(&channel.schema_id).map_or("", |(name, ..)| name);
        let (number, stamp_ns) = (header.sequence, header.log_time);
        Ok(MessageAt { topic: &channel.topic, schema, channel: id, number, stamp_ns, bytes, chunk })
    }
}

/// The most parts an observation may have: windows, and what little else there is.
const MOST_PARTS: usize = 1 << 16;
/// The most bytes of any other record. Decisions of thousands of goals are a hundredth of it.
const MOST_BYTES: usize = 32 << 20;

/// How many fields an encoded message has at its top, as far as it can be read.
fn parts(mut data: &[u8]) -> usize {
    let mut count = 0;
    while count <= MOST_PARTS
        && let Ok((tag, kind)) = prost::encoding::decode_key(&mut data)
        && prost::encoding::skip_field(kind, tag, &mut data, DecodeContext::default()).is_ok()
    {
        count += 1;
    }
    count
}

/// What a message is if it is a record of ours.
pub(crate) fn entry(at: MessageAt<'_>, data: &[u8]) -> Result<Option<Entry>, String> {
    let failed = |error: prost::DecodeError| format!("{} {}: {error}", at.topic, at.number);
    // Decoded, a message of nothing but empty parts takes a hundred times its bytes.
    let bytes = data.len();
    let too_much = match at.topic {
        topic::OBSERVATION => parts(data) > MOST_PARTS,
        topic::OUTCOME | topic::MESSAGE | topic::FAULT | topic::DECISION => bytes > MOST_BYTES,
        _ => false,
    };
    if too_much {
        return Err(format!("{} {} of {bytes} bytes: no record is like that", at.topic, at.number));
    }
    Ok(Some(match at.topic {
        topic::OBSERVATION => {
            Entry::Observation(record::Observation::decode(data).map_err(failed)?)
        }
        topic::OUTCOME => Entry::Outcome(record::Outcome::decode(data).map_err(failed)?),
        topic::MESSAGE => Entry::Message(record::Message::decode(data).map_err(failed)?),
        topic::FAULT => Entry::Fault(record::Fault::decode(data).map_err(failed)?),
        topic::DECISION => {
            Entry::Decision(Box::new(record::Decision::decode(data).map_err(failed)?))
        }
        _ => return Ok(None),
    }))
}

/// The run as far as it was read: it says what must come next.
#[derive(Debug, Default)]
pub(crate) struct Story {
    pub(crate) names: Names,
    pub(crate) end: Option<RunEnd>,
    /// What an earlier recovery said.
    pub(crate) recovered: Option<BTreeMap<String, String>>,
    /// Whether it is several runs in one file, for viewers.
    merged: bool,
    /// Whether the run's facts were told.
    begun: bool,
    /// Whether it holds planes of a run's decisions alone, and goes beside the run's log.
    beside: bool,
    /// The maps of the decision that comes next.
    planes: BTreeSet<String>,
    next: Next,
}

/// What must come next.
#[derive(Debug, Default)]
struct Next {
    decisions: u32,
    chain: Option<[u8; 32]>,
    observations: u32,
    messages: u32,
}

impl Story {
    /// Reads a whole file.
    pub(crate) fn read(
        &mut self,
        bytes: &mut (impl Read + Seek),
        take: &mut dyn FnMut(Item<'_>) -> ControlFlow<()>,
    ) -> io::Result<Walked> {
        walk(bytes, &mut |found| {
            Ok(self.follow(&found)?.map_or(ControlFlow::Continue(()), &mut *take))
        })
    }

    /// What a record means, if it belongs to the run and follows from what was before.
    pub(crate) fn follow<'a>(
        &'a mut self,
        found: &'a Found<'_>,
    ) -> Result<Option<Item<'a>>, String> {
        let ended = self.end.is_some();
        match &found.record {
            Record::Chunk { .. }
            | Record::Message { .. }
            | Record::Attachment { .. }
            | Record::Metadata(_)
                if ended =>
            {
                Err("something follows the end of the run".to_owned())
            }
            record @ (Record::Schema { .. } | Record::Channel(_)) => {
                self.names.learn(record)?;
                Ok(None)
            }
            Record::Message { header, data } => {
                let at = self.names.at(header, data.len(), found.start)?;
                let Some(entry) = entry(at, data)? else {
                    if at.topic.starts_with(MAPS) {
                        let (topic, number, due) = (at.topic, at.number, self.next.decisions);
                        if self.beside && number > due {
                            self.next.decisions = number;
                            self.planes.clear();
                        } else if number != due {
                            return Err(format!("{topic} of decision {number} before {due}"));
                        }
                        if !self.planes.insert(topic.to_owned()) {
                            return Err(format!("{topic} of decision {number} is there twice"));
                        }
                    }
                    return Ok(Some(Item::View { at, data }));
                };
                self.next.take(&entry)?;
                if matches!(entry, Entry::Decision(_)) {
                    self.planes.clear();
                }
                Ok(Some(Item::Entry { at, entry }))
            }
            Record::Metadata(metadata) => {
                match metadata.name.as_str() {
                    MERGED => self.merged = true,
                    RUN if self.begun => return Err(format!("{RUN} is there twice")),
                    RUN => {
                        self.begun = true;
                        self.beside = metadata.metadata.contains_key(PLANES);
                    }
                    END => self.end = Some(run_end(metadata.metadata.clone())?),
                    RECOVERED => self.recovered = Some(metadata.metadata.clone()),
                    _ => {}
                }
                Ok(Some(Item::Metadata { name: &metadata.name, facts: &metadata.metadata }))
            }
            Record::Attachment { header, data, .. } => Ok(Some(Item::Attachment {
                name: &header.name,
                media_type: &header.media_type,
                data,
            })),
            _ => Ok(None),
        }
    }

    /// What a walk is worth; nothing if the file is no log at all.
    pub(crate) fn status(&self, walked: &Walked) -> Option<Status> {
        let byte = walked.byte;
        Some(match &walked.fault {
            Some(Fault::NotALog) => return None,
            Some(Fault::Ends(detail)) => Status::Truncated { byte, detail: detail.clone() },
            Some(Fault::Wrong(detail)) => Status::Corrupt { byte, detail: detail.clone() },
            None => match self.ending() {
                Ok(true) => Status::Complete,
                Ok(false) => Status::Truncated { byte, detail: self.without_end() },
                Err(detail) => Status::Corrupt { byte, detail },
            },
        })
    }

    /// Whether the run ended as its end record says.
    pub(crate) fn ending(&self) -> Result<bool, String> {
        let Some(end) = &self.end else { return Ok(false) };
        let chain = hex(&self.next.chain.unwrap_or(CHAIN_START));
        if end.decisions != self.decisions() {
            let (told, found) = (end.decisions, self.decisions());
            return Err(format!("{found} decisions; the run ended with {told}"));
        }
        if end.chain != chain {
            let told = &end.chain;
            return Err(format!("chain {chain}; the run ended with {told}"));
        }
        Ok(true)
    }

    fn without_end(&self) -> String {
        if self.merged {
            return "several runs merged for viewers; ask the log of each run".to_owned();
        }
        let missing = "the run did not end: there is no wisdom.end";
        match &self.recovered {
            None => missing.to_owned(),
            Some(facts) => {
                let left_out = facts.get("bytes_left_out").map_or("?", String::as_str);
                format!("{missing}; recovered, {left_out} bytes of the broken log left out")
            }
        }
    }

    /// Decisions so far.
    pub(crate) fn decisions(&self) -> u32 {
        self.next.decisions
    }
}

impl Next {
    /// Records come without gaps: a chunk that got lost between two others would else go unseen.
    fn take(&mut self, entry: &Entry) -> Result<(), String> {
        match entry {
            Entry::Observation(observation) => {
                due("observation", observation.number, self.observations)?;
                self.observations += 1;
            }
            Entry::Outcome(outcome) => match self.decisions.checked_sub(1) {
                Some(last) => due("outcome of decision", outcome.decision, last)?,
                None => return Err("an outcome before any decision".to_owned()),
            },
            Entry::Message(message) => {
                due("message", message.number, self.messages)?;
                self.messages += 1;
            }
            Entry::Fault(_) => {}
            Entry::Decision(decision) => self.link(decision)?,
        }
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

fn due(kind: &str, found: u32, due: u32) -> Result<(), String> {
    if found == due { Ok(()) } else { Err(format!("{kind} {found} where {due} was due")) }
}

pub(crate) fn run_end(mut facts: BTreeMap<String, String>) -> Result<RunEnd, String> {
    let mut take = |key: &str| facts.remove(key).ok_or_else(|| format!("{END} has no {key}"));
    let (status, decisions, chain) = (take("status")?, take("decisions")?, take("chain")?);
    let decisions =
        decisions.parse().map_err(|_| format!("{END} has {decisions} decisions, not a number"))?;
    Ok(RunEnd { status, decisions, chain, facts })
}
