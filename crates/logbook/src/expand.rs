//! Every map of a log made again.

use std::path::{Path, PathBuf};

use wisdom_autonomy::{Autonomy, AutonomyError, Message, Observation, Outcome};
use wisdom_mission::Mission;

use crate::{
    Entry, LogError, LogReader, LogWriter, MapMode, Options, ReplayError, RunHeader, Setting,
    SyncPolicy, first_difference, is_plane, mission_of, plane, record,
};

/// Writes a log again with whole maps at every decision: those that a log of mode [`MapMode::Full`] holds, and further
/// `planes` ([`plane`]). They are derived from the logged inputs and held against the decisions, so what comes out of a
/// log of patches or digests is byte for byte what a run that logged whole maps would have written. A log whose run did
/// not end gives one that says so. `progress` is told of every decision.
///
/// # Errors
/// [`ReplayError`] if the log's mission does not load, the log does not follow from its own inputs, a plane is not known, or
/// the new log cannot be written.
pub fn expand(
    log: &LogReader,
    to: &Path,
    planes: &[String],
    progress: &mut dyn FnMut(u32),
) -> Result<PathBuf, ReplayError> {
    let mission = mission_of(log)?;
    if let Some(name) = planes.iter().find(|name| !is_plane(&mission.spec, name)) {
        return Err(ReplayError::NoPlane { name: name.clone() });
    }
    let made = write(log, mission, to, planes, progress);
    // Half a log that nobody ran helps nobody, and would stand in the way.
    if made.is_err() && !matches!(made, Err(ReplayError::Log(LogError::Exists { .. }))) {
        let mut part = to.as_os_str().to_owned();
        part.push(".part");
        let _ = std::fs::remove_file(part);
    }
    made
}

fn write(
    log: &LogReader,
    mission: Mission,
    to: &Path,
    planes: &[String],
    progress: &mut dyn FnMut(u32),
) -> Result<PathBuf, ReplayError> {
    let header = RunHeader {
        metadata: log.metadata.clone(),
        attachments: log
            .attachments
            .iter()
            .map(|a| (a.name.clone(), a.media_type.clone(), a.data.clone()))
            .collect(),
    };
    let setting = Setting::from(&mission.spec);
    let options = Options { sync: SyncPolicy::End, maps: MapMode::Full };
    let mut rover = Autonomy::new(mission.spec)?;
    let mut writer = LogWriter::create(to, &header, setting.clone(), options)?;
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
                    let unknown = || ReplayError::NoPlane { name: name.clone() };
                    more.push((name.as_str(), plane(maps, name).ok_or_else(unknown)?));
                }
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
