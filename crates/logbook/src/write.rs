//! Writes a log while the run goes on.
//!
//! A log is one MCAP file. What was true of the whole run comes first and sits outside the compressed part,
//! so it survives everything: metadata `wisdom.run`, then the mission's files as attachments. Each decision
//! ends a chunk with everything that led to it. Metadata `wisdom.end` comes last: without it, the run did not
//! end. There is no wall clock in it: times are those of the mission.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use foxglove::Encode;
use foxglove::messages::log;
use mcap::Attachment;
use mcap::records::{MessageHeader, Metadata};
use wisdom_autonomy::{Decision, Message, Observation, Outcome, Pose, Spent};
use wisdom_goals::Action;
use wisdom_grid::{Cell, GridSpec, Raster, Window};

use crate::container::{self, Container, failure};
use crate::record::{self, CHAIN_START, DESCRIPTOR, hex};
use crate::{DecisionMaps, Drape, LogError, PartFile, Setting, Store, SyncPolicy, topic, view};

/// Name of the metadata record that opens a log.
pub(crate) const RUN: &str = "wisdom.run";
/// Name of the metadata record that closes it.
pub(crate) const END: &str = "wisdom.end";
/// Key of the metadata that says how much of the maps is in the log.
pub(crate) const MAPS: &str = "maps";
/// Version of what a log holds and where.
pub const LOG_VERSION: u32 = 1;
/// A message of more bytes than this ends its chunk, so that a chunk always fits a reader's memory.
const LARGE: usize = 16 << 20;

/// The latest time of a log, about 136 years: more does not fit the seconds of Foxglove's time stamps, and
/// above it there is room to count on.
const LATEST_NS: u64 = u32::MAX as u64 * 1_000_000_000;

/// How severe a line of the text log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For those who look for a fault.
    Debug,
    /// What went on.
    Info,
    /// What should not have been.
    Warning,
    /// What ended something.
    Error,
}

impl From<Level> for log::Level {
    fn from(level: Level) -> Self {
        match level {
            Level::Debug => Self::Debug,
            Level::Info => Self::Info,
            Level::Warning => Self::Warning,
            Level::Error => Self::Error,
        }
    }
}

/// What is true of the whole run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RunHeader {
    /// Facts by name: software version, seed, rule, policy, digests of mission and terrain, overrides.
    pub metadata: BTreeMap<String, String>,
    /// Files, each with its name, media type and bytes: mission, tables, terrain.
    pub attachments: Vec<(String, String, Vec<u8>)>,
}

/// How much of the maps goes into the log. Their digests always do, and [`crate::expand`] makes every map again from the
/// logged inputs, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MapMode {
    /// The interest at each decision, whole.
    #[default]
    Full,
    /// The interest whole at first, where the working map moved, where most of it changed, and every
    /// [`KEY_EVERY`] decisions; between these the smallest window around the cells that changed.
    Patch,
    /// No maps.
    Digest,
}

impl MapMode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::Full, Self::Patch, Self::Digest];

    /// The name that the command line takes and the log's metadata holds.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Patch => "patch",
            Self::Digest => "digest",
        }
    }
}

impl std::fmt::Display for MapMode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The fact of a file that holds planes of a run's decisions alone: their names.
pub(crate) const PLANES: &str = "planes";

/// Decisions from one whole map to the next in a log of patches.
pub const KEY_EVERY: u32 = 16;

/// How a log is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// When the file is made to survive a loss of power.
    pub sync: SyncPolicy,
    /// How much of the maps it holds.
    pub maps: MapMode,
}

/// Writes a log: the records of a run, and the same for viewers.
pub struct LogWriter<S: Store = PartFile> {
    container: Container<S>,
    name: PathBuf,
    setting: Setting,
    options: Options,
    channels: BTreeMap<String, u16>,
    next_stamp_ns: u64,
    chain: [u8; 32],
    decisions: u32,
    track: Vec<Cell>,
    /// Each plane as a reader of the log knows it, and decisions since it was last written whole.
    known: BTreeMap<String, (Raster<f32>, u32)>,
    /// Which map the last cloud of points showed: how often it had changed, and where it lies.
    draped: Option<(u64, GridSpec)>,
}

impl LogWriter<PartFile> {
    /// Begins a log that is to become the file `path`; until it is finished it is `path` with `.part` added.
    ///
    /// # Errors
    /// [`LogError::Exists`] if either file is there; [`LogError::Io`] if the beginning cannot be written.
    pub fn create(
        path: &Path,
        header: &RunHeader,
        setting: Setting,
        options: Options,
    ) -> Result<Self, LogError> {
        Self::over(PartFile::create(path, options.sync)?, header, setting, options)
    }
}

impl<S: Store> LogWriter<S> {
    /// Begins a log in any store, for instance a `Vec<u8>`.
    ///
    /// # Errors
    /// [`LogError::Io`] if the beginning cannot be written.
    pub fn over(
        store: S,
        header: &RunHeader,
        setting: Setting,
        options: Options,
    ) -> Result<Self, LogError> {
        let name = store.name();
        let container =
            container::open(store, "wisdom", None).map_err(|error| failure(&name, error))?;
        let mut writer = Self {
            container,
            name,
            setting,
            options,
            channels: BTreeMap::new(),
            next_stamp_ns: 0,
            chain: CHAIN_START,
            decisions: 0,
            track: Vec::new(),
            known: BTreeMap::new(),
            draped: None,
        };
        writer.begin(header)?;
        Ok(writer)
    }

    fn begin(&mut self, header: &RunHeader) -> Result<(), LogError> {
        let grid = self.setting.grid;
        let mut metadata = header.metadata.clone();
        for (key, value) in [
            ("log_version", LOG_VERSION.to_string()),
            ("decision_version", record::DECISION_VERSION.to_string()),
            (MAPS, self.options.maps.to_string()),
            ("grid_rows", grid.rows().to_string()),
            ("grid_cols", grid.cols().to_string()),
            ("grid_spacing_m", grid.spacing_m().to_string()),
            ("grid_west_m", grid.west_m().to_string()),
            ("grid_north_m", grid.north_m().to_string()),
        ] {
            metadata.insert(key.to_owned(), value);
        }
        let run = Metadata { name: RUN.to_owned(), metadata };
        self.container.write_metadata(&run).map_err(|error| failure(&self.name, error))?;
        for (name, media_type, data) in &header.attachments {
            let attachment = Attachment {
                log_time: 0,
                create_time: 0,
                name: name.clone(),
                media_type: media_type.clone(),
                data: Cow::Borrowed(data),
            };
            self.container.attach(&attachment).map_err(|error| failure(&self.name, error))?;
        }
        self.flush()
    }

    /// Logs what the core is told. It is safe on disk once the next decision is.
    ///
    /// # Errors
    /// [`LogError::Io`] if it cannot be written.
    pub fn observation(&mut self, observation: &Observation) -> Result<(), LogError> {
        let record = record::Observation::from(observation);
        self.record(topic::OBSERVATION, observation.number, observation.spent, &record)?;
        self.pose(observation.number, observation.pose)
    }

    /// Logs what came of a step. It is safe on disk once the next decision is.
    ///
    /// # Errors
    /// [`LogError::Io`] if it cannot be written.
    pub fn outcome(&mut self, outcome: &Outcome) -> Result<(), LogError> {
        let record = record::Outcome::from(outcome);
        self.record(topic::OUTCOME, outcome.decision, outcome.spent, &record)?;
        self.track.extend(&outcome.track);
        self.track.dedup();
        self.pose(outcome.decision, outcome.pose)
    }

    /// Logs word that reached the core. It is safe on disk once the next decision is.
    ///
    /// # Errors
    /// [`LogError::Io`] if it cannot be written.
    pub fn heard(&mut self, message: &Message) -> Result<(), LogError> {
        let record = record::Message::from(message);
        self.record(topic::MESSAGE, message.number, Spent::default(), &record)?;
        self.message(Level::Info, &record.text())
    }

    /// Logs something that broke in the world, at its own time or, if the log is past that, now.
    ///
    /// # Errors
    /// [`LogError::Io`] if it cannot be written.
    pub fn fault(&mut self, fault: &record::Fault) -> Result<(), LogError> {
        let spent = Spent { time_s: fault.time_s, ..Spent::default() };
        self.record(topic::FAULT, self.decisions, spent, fault)?;
        self.message(Level::Warning, &fault.text)
    }

    /// Logs a decision with its maps and makes it, and everything before it, safe on disk.
    ///
    /// # Errors
    /// [`LogError::GridMismatch`] if a map lies on another grid than the run; [`LogError::Io`] if something
    /// cannot be written.
    pub fn decision(
        &mut self,
        decision: &Decision,
        maps: &DecisionMaps<'_>,
    ) -> Result<(), LogError> {
        let number = decision.number;
        self.advance(decision.state.spent);
        self.maps(number, maps)?;
        self.cloud(decision, maps)?;
        let stamp_ns = self.tick();
        let scene = view::scene(stamp_ns, self.setting.grid, decision, &self.track);
        self.view(topic::SCENE, number, stamp_ns, &scene)?;
        for trigger in &decision.triggers {
            self.message(Level::Info, &format!("decision {number}: {trigger}"))?;
        }
        let changed = decision
            .verdicts
            .iter()
            .filter(|verdict| !matches!(verdict.action, Action::Keep | Action::Defer));
        for verdict in changed {
            let text = format!("decision {number}: {}", view::sentence(verdict));
            self.message(Level::Info, &text)?;
        }
        let mut record = record::Decision::of(decision, &self.setting);
        let link = record.link(&self.chain);
        record.chain = hex(&link);
        self.record(topic::DECISION, number, decision.state.spent, &record)?;
        self.flush()?;
        self.chain = link;
        self.decisions += 1;
        Ok(())
    }

    /// Logs planes of a decision by their names, and nothing else of it.
    pub(crate) fn planes(
        &mut self,
        decision: &Decision,
        planes: &[(&str, &Raster<f32>)],
    ) -> Result<(), LogError> {
        self.advance(decision.state.spent);
        for (name, plane) in planes {
            self.plane(decision.number, name, plane)?;
        }
        self.flush()
    }

    /// Adds a line to the text log, at the time of the last record.
    ///
    /// # Errors
    /// [`LogError::Io`] if it cannot be written.
    pub fn message(&mut self, level: Level, text: &str) -> Result<(), LogError> {
        let stamp_ns = self.tick();
        self.view(topic::LOG, self.decisions, stamp_ns, &view::log(stamp_ns, level.into(), text))
    }

    /// Ends the log with how the run ended and further facts, closes it and gives it its final name.
    ///
    /// # Errors
    /// [`LogError::Io`] if something cannot be written; the part file is left as it is then.
    pub fn finish(
        mut self,
        status: &str,
        facts: &BTreeMap<String, String>,
    ) -> Result<S::Closed, LogError> {
        let mut metadata = facts.clone();
        metadata.insert("status".to_owned(), status.to_owned());
        metadata.insert("decisions".to_owned(), self.decisions.to_string());
        metadata.insert("chain".to_owned(), hex(&self.chain));
        let end = Metadata { name: END.to_owned(), metadata };
        self.container.write_metadata(&end).map_err(|error| failure(&self.name, error))?;
        self.close()
    }

    /// Closes a log whose run did not end: the file is whole, and says that the run is not.
    ///
    /// # Errors
    /// As [`LogWriter::finish`].
    pub fn close(self) -> Result<S::Closed, LogError> {
        container::close(self.container, &self.name)
    }

    /// Digest of all decisions so far, hexadecimal: see [`record::Decision::link`].
    #[must_use]
    pub fn chain(&self) -> String {
        hex(&self.chain)
    }

    fn maps(&mut self, number: u32, maps: &DecisionMaps<'_>) -> Result<(), LogError> {
        let planes =
            std::iter::once(("interest", maps.interest)).chain(maps.others.iter().copied());
        for (name, plane) in planes {
            let (found, expected) = (plane.spec(), self.setting.grid);
            if expected.part(found.window()) != Ok(found) {
                return Err(LogError::GridMismatch { name: name.to_owned(), found, expected });
            }
        }
        if self.options.maps == MapMode::Digest {
            return Ok(());
        }
        self.plane(number, "interest", maps.interest)?;
        for (name, plane) in maps.others {
            self.plane(number, name, plane)?;
        }
        Ok(())
    }

    /// A plane, whole or what changed of it.
    fn plane(&mut self, number: u32, name: &str, plane: &Raster<f32>) -> Result<(), LogError> {
        if self.options.maps == MapMode::Patch {
            if let Some((known, since)) = self.known.get_mut(name)
                && known.spec() == plane.spec()
                && *since + 1 < KEY_EVERY
            {
                *since += 1;
                let Some(changed) = changed(known, plane) else { return Ok(()) };
                if 2 * changed.rows * changed.cols <= plane.spec().len() {
                    for cell in changed.cells() {
                        known[cell] = plane[cell];
                    }
                    let part = plane.crop(changed).map_err(|_| LogError::GridMismatch {
                        name: name.to_owned(),
                        found: plane.spec(),
                        expected: self.setting.grid,
                    })?;
                    let first = Cell::new(changed.row, changed.col);
                    let topic = topic::patch_of(name);
                    return self.map(&topic, number, &part.numbered_from(first));
                }
            }
            self.known.insert(name.to_owned(), (plane.clone(), 0));
        }
        self.map(&topic::map_of(name), number, plane)
    }

    fn map(&mut self, topic: &str, number: u32, plane: &Raster<f32>) -> Result<(), LogError> {
        let stamp_ns = self.tick();
        self.view(topic, number, stamp_ns, &view::grid(stamp_ns, self.setting.grid, plane))
    }

    /// The interest over its ground, if the map changed since it was last shown.
    fn cloud(&mut self, decision: &Decision, maps: &DecisionMaps<'_>) -> Result<(), LogError> {
        let Some(Drape { elevation, uncertainty }) = maps.drape else { return Ok(()) };
        let expected = maps.interest.spec();
        for (name, plane) in [("elevation", elevation), ("elevation uncertainty", uncertainty)] {
            let found = plane.spec();
            if found != expected {
                return Err(LogError::GridMismatch { name: name.to_owned(), found, expected });
            }
        }
        let shown = Some((decision.map_version, expected));
        if self.options.maps != MapMode::Full || self.draped == shown {
            return Ok(());
        }
        self.draped = shown;
        let stamp_ns = self.tick();
        let grid = self.setting.grid;
        let cloud = view::cloud(stamp_ns, grid, elevation, uncertainty, maps.interest);
        self.view(topic::CLOUD, decision.number, stamp_ns, &cloud)
    }

    fn pose(&mut self, number: u32, pose: Pose) -> Result<(), LogError> {
        let grid = self.setting.grid;
        let stamp_ns = self.tick();
        self.view(topic::POSE, number, stamp_ns, &view::pose(stamp_ns, grid, pose))?;
        let stamp_ns = self.tick();
        self.view(topic::TRANSFORM, number, stamp_ns, &view::transform(stamp_ns, grid, pose))
    }

    /// Moves the log's clock to the mission's; it never goes back.
    fn advance(&mut self, spent: Spent) {
        // The cast takes what is negative or no number to 0, and what is too large to the largest.
        let mission_ns = ((spent.time_s * 1e9).round() as u64).min(LATEST_NS);
        self.next_stamp_ns = self.next_stamp_ns.max(mission_ns);
    }

    /// The next time stamp: mission time, plus a nanosecond a message so that no two are equal.
    fn tick(&mut self) -> u64 {
        let stamp_ns = self.next_stamp_ns;
        self.next_stamp_ns += 1;
        stamp_ns
    }

    fn record<M: prost::Message + prost::Name>(
        &mut self,
        topic: &str,
        number: u32,
        spent: Spent,
        record: &M,
    ) -> Result<(), LogError> {
        self.advance(spent);
        let stamp_ns = self.tick();
        let schema = || (M::full_name(), Cow::Borrowed(DESCRIPTOR));
        self.write(topic, number, stamp_ns, schema, &record.encode_to_vec())
    }

    fn view<M: Encode + prost::Message>(
        &mut self,
        topic: &str,
        number: u32,
        stamp_ns: u64,
        message: &M,
    ) -> Result<(), LogError> {
        let schema = || {
            let schema = M::get_schema().expect("every well-known message has a schema");
            (schema.name, schema.data)
        };
        self.write(topic, number, stamp_ns, schema, &message.encode_to_vec())
    }

    fn write(
        &mut self,
        topic: &str,
        sequence: u32,
        stamp_ns: u64,
        schema: impl FnOnce() -> (String, Cow<'static, [u8]>),
        data: &[u8],
    ) -> Result<(), LogError> {
        const ENCODING: &str = "protobuf";
        let channel_id = if let Some(&id) = self.channels.get(topic) {
            id
        } else {
            let (name, descriptor) = schema();
            let id = self
                .container
                .add_schema(&name, ENCODING, &descriptor)
                .and_then(|schema| {
                    self.container.add_channel(schema, topic, ENCODING, &BTreeMap::new())
                })
                .map_err(|error| failure(&self.name, error))?;
            self.channels.insert(topic.to_owned(), id);
            id
        };
        let header =
            MessageHeader { channel_id, sequence, log_time: stamp_ns, publish_time: stamp_ns };
        self.container
            .write_to_known_channel(&header, data)
            .map_err(|error| failure(&self.name, error))?;
        if data.len() > LARGE { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), LogError> {
        self.container.flush().map_err(|error| failure(&self.name, error))
    }
}

/// The smallest window around the cells that differ, bit for bit.
fn changed(before: &Raster<f32>, now: &Raster<f32>) -> Option<Window> {
    let (spec, cols) = (now.spec(), now.spec().cols());
    let rows = before.values().chunks(cols).zip(now.values().chunks(cols)).enumerate();
    let mut found: Option<(usize, usize, usize, usize)> = None;
    for (row, (before, now)) in rows {
        let differs = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
        let Some(first) = before.iter().zip(now).position(differs) else { continue };
        let last = before.iter().zip(now).rposition(differs).unwrap_or(first);
        let (top, left, right) = found.map_or((row, first, last), |(top, _, left, right)| {
            (top, left.min(first), right.max(last))
        });
        found = Some((top, row, left, right));
    }
    let (top, bottom, left, right) = found?;
    Some(Window {
        row: spec.first().row + top,
        col: spec.first().col + left,
        rows: bottom - top + 1,
        cols: right - left + 1,
    })
}
