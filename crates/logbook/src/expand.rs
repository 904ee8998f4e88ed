//! The maps of a log made again.

use std::path::{Path, PathBuf};

use wisdom_autonomy::{Autonomy, AutonomyError, Message, Observation, Outcome, Spec};

use crate::replay::same_version;
use crate::store::part_of;
use crate::write::PLANES;
use crate::{
    Entry, LogReader, LogWriter, MapMode, Options, Past, ReplayError, RunHeader, Setting,
    SyncPolicy, first_difference, is_plane, mission_of, plane, planes as planes_of, record,
};

/// Writes a log again with maps at every decision: those that a log of that mode holds, and further `planes`
/// ([`plane`]), whole or in patches likewise. They are derived from the logged inputs and held against the decisions, so what
/// comes out, but for the further planes, is byte for byte what a run in that mode would have written. A log whose run
/// did not end gives one that says so. `progress` is told of every decision.
///
/// # Errors
/// [`ReplayError`] if the log's mission does not load, the log does not follow from its own inputs, a plane is not known, or
/// the new log cannot be written.
pub fn expand(
    log: &LogReader,
    to: &Path,
    maps: MapMode,
    planes: &[String],
    progress: &mut dyn FnMut(u32),
) -> Result<PathBuf, ReplayError> {
    let mission = mission_of(log)?;
    if let Some(name) = planes.iter().find(|name| !is_plane(&mission.spec, name)) {
        return Err(no_plane(&mission.spec, name));
    }
    same_version(log)?;
    let rover = Autonomy::new(mission.spec.clone())?;
    let options = Options { sync: SyncPolicy::End, maps };
    let setting = Setting::from(&mission.spec);
    let writer = LogWriter::create(to, &header(log), setting, options)?;
    let made = write(log, rover, writer, planes, progress);
    // Half a log that nobody ran helps nobody, and would stand in the way.
    if made.is_err() {
        std::fs::remove_file(part_of(to)).ok();
    }
    made
}

/// Planes of decisions that were derived again, in an MCAP file of their own: what goes beside a log that is to stay as it
/// is. In patches; with the log's facts, so that it is known where the planes lie.
pub struct PlaneLog {
    writer: LogWriter<Vec<u8>>,
    planes: Vec<String>,
}

impl PlaneLog {
    /// Begins one of these planes ([`plane`]).
    ///
    /// # Errors
    /// [`ReplayError::NoPlane`] if the mission's decisions have no such plane.
    pub fn new(log: &LogReader, spec: &Spec, planes: &[String]) -> Result<Self, ReplayError> {
        if let Some(name) = planes.iter().find(|name| !is_plane(spec, name)) {
            return Err(no_plane(spec, name));
        }
        let mut metadata = log.metadata.clone();
        metadata.insert(PLANES.to_owned(), planes.join(","));
        let header = RunHeader { metadata, attachments: Vec::new() };
        let options = Options { sync: SyncPolicy::End, maps: MapMode::Patch };
        let writer = LogWriter::over(Vec::new(), &header, Setting::from(spec), options)?;
        Ok(Self { writer, planes: planes.to_vec() })
    }

    /// Adds the planes of a decision. Decisions come in their order.
    ///
    /// # Errors
    /// [`ReplayError::NoPlane`] if the decision is of another mission.
    pub fn add(&mut self, past: &Past) -> Result<(), ReplayError> {
        let mut made = Vec::new();
        for name in &self.planes {
            let plane = plane(&past.rover, name);
            made.push((name.as_str(), plane.ok_or_else(|| no_plane(past.rover.spec(), name))?));
        }
        let made: Vec<_> = made.iter().map(|(name, plane)| (*name, &**plane)).collect();
        Ok(self.writer.planes(&past.decision, &made)?)
    }

    /// Ends the file: its bytes.
    ///
    /// # Errors
    /// [`LogError`](crate::LogError) if it cannot be closed.
    pub fn close(self) -> Result<Vec<u8>, ReplayError> {
        Ok(self.writer.close()?)
    }
}

fn no_plane(spec: &Spec, name: &str) -> ReplayError {
    let known = planes_of(spec).into_iter().map(|plane| plane.name).collect();
    ReplayError::NoPlane { name: name.to_owned(), known }
}

/// The facts and files of the log, as a new one begins with them.
fn header(log: &LogReader) -> RunHeader {
    let files = log.attachments.iter();
    let files = files.map(|a| (a.name.clone(), a.media_type.clone(), a.data.clone()));
    RunHeader { metadata: log.metadata.clone(), attachments: files.collect() }
}

fn write(
    log: &LogReader,
    mut rover: Autonomy,
    mut writer: LogWriter,
    planes: &[String],
    progress: &mut dyn FnMut(u32),
) -> Result<PathBuf, ReplayError> {
    let setting = Setting::from(rover.spec());
    for entry in &log.entries {
        match entry {
            Entry::Observation(logged) => {
                let observation = Observation::try_from(logged)?;
                writer.observation(&observation)?;
                rover.observe(&observation)?;
            }
            Entry::Message(logged) => {
                let message = Message::try_from(logged)?;
                writer.heard(&message)?;
                rover.hear(&message)?;
            }
            Entry::Fault(fault) => writer.fault(fault)?,
            Entry::Outcome(logged) => {
                let outcome = Outcome::try_from(logged)?;
                writer.outcome(&outcome)?;
                rover.report(&outcome)?;
            }
            Entry::Decision(logged) => {
                let decision = rover.decide()?;
                let derived = record::Decision::of(&decision, &setting);
                if let Some(difference) = first_difference(logged, &derived) {
                    return Err(ReplayError::Differs(Box::new(difference)));
                }
                let maps = rover.maps().ok_or(AutonomyError::NothingObserved)?;
                let mut more = Vec::new();
                for name in planes {
                    let plane = plane(&rover, name).ok_or_else(|| no_plane(rover.spec(), name));
                    more.push((name.as_str(), plane?));
                }
                let more: Vec<_> = more.iter().map(|(name, plane)| (*name, &**plane)).collect();
                writer.decided(&decision, maps, &more)?;
                progress(decision.number);
            }
        }
    }
    Ok(match &log.end {
        Some(end) => writer.finish(&end.status, &end.facts)?,
        None => writer.close()?,
    })
}
