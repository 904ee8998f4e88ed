//! A log fed back to the core: the second client of the same four functions that a run calls.

use std::collections::BTreeMap;
use std::path::Path;

use wisdom_autonomy::{AutonomyError, Decision, Maps, Message, Observation, Outcome};
use wisdom_goals::{CausalGraph, GoalId};
use wisdom_grid::Raster;
use wisdom_mission::{FaultEvent, Mission, MissionError, RecordError, Recorder};

use crate::compare::Difference;
use crate::derive::derive_at;
use crate::record::{self, hex};
use crate::{
    DecisionMaps, Drape, LogError, LogReader, LogWriter, Options, RunHeader, Setting, Status, Store,
};

/// Where a mission's files lie among a log's attachments.
const MISSION_FOLDER: &str = "mission/";

/// Why a log cannot be fed back.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The mission inside does not load.
    #[error("the mission inside the log does not load:\n{0}")]
    Mission(#[from] MissionError),
    /// The core refuses a logged input.
    #[error("the core refuses what was logged: {0}")]
    Core(#[from] AutonomyError),
    /// What the logged inputs lead to is not what was logged.
    #[error("the log does not follow from its own inputs ({0}); `wisdom verify` says more")]
    Differs(Box<Difference>),
    /// The decisions of the log mean something else than those of this build: it cannot tell.
    #[error(
        "not comparable: the log's decisions mean version {logged}, those of this build {here}"
    )]
    OtherVersion {
        /// What the log's decisions mean.
        logged: u32,
        /// What this build's mean.
        here: u32,
    },
    /// A log that ends before the files it should carry.
    #[error("the log holds no mission: it is {status}")]
    NoMission {
        /// How whole the file is.
        status: Status,
    },
    /// There is no plane of that name.
    #[error("no plane is called `{name}`; there are {}", known.join(", "))]
    NoPlane {
        /// The name.
        name: String,
        /// Those there are.
        known: Vec<String>,
    },
    /// A log cannot be decided again under another mission.
    #[error("the log does not fit the changed mission: {what}")]
    Unfit {
        /// What does not fit.
        what: String,
    },
    /// A chosen sequence is no valid STRIPS plan.
    #[error(transparent)]
    Plan(#[from] wisdom_goals::PlanError),
}

/// Begins the log of a mission: its files, identity and settings go in first.
///
/// # Errors
/// [`LogError`] if the log exists already or cannot be written.
pub fn begin(path: &Path, mission: &Mission, options: Options) -> Result<LogWriter, LogError> {
    LogWriter::create(path, &header(mission), Setting::from(&mission.spec), options)
}

/// What is true of every run of a mission: its facts and its files.
#[must_use]
pub fn header(mission: &Mission) -> RunHeader {
    let spec = &mission.spec;
    let overrides: Vec<String> =
        mission.overrides.iter().map(|o| format!("{}={}", o.key, o.value)).collect();
    let metadata: BTreeMap<String, String> = [
        ("mission", mission.name.clone()),
        ("mission_digest", hex(&mission.digest)),
        ("seed", mission.seed.to_string()),
        ("rule", spec.fusion.rule.to_string()),
        ("paradox", spec.fusion.paradox_policy.to_string()),
        ("statistic", spec.fusion.statistic.to_string()),
        ("policy", spec.policy.to_string()),
        ("prize", spec.prize.to_string()),
        ("overrides", overrides.join("\n")),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect();
    let attachments = mission
        .files
        .iter()
        .map(|(path, bytes)| {
            let media = match path.rsplit('.').next() {
                Some("toml") => "application/toml",
                Some("tif" | "tiff") => "image/tiff",
                _ => "application/octet-stream",
            };
            (format!("{MISSION_FOLDER}{path}"), media.to_owned(), bytes.clone())
        })
        .collect();
    RunHeader { metadata, attachments }
}

impl<S: Store> LogWriter<S> {
    /// Logs a decision with the maps it was made from that every log has, and `more` planes by name.
    pub(crate) fn decided(
        &mut self,
        decision: &Decision,
        maps: &Maps,
        more: &[(&str, &Raster<f32>)],
    ) -> Result<(), LogError> {
        let ground = &maps.layers[wisdom_autonomy::ELEVATION];
        let elevation = ground.values();
        // Later decisions change little of it, and it can be derived again.
        let first = (decision.number == 0).then_some(("elevation", elevation));
        let mut others: Vec<(&str, &Raster<f32>)> = first.into_iter().collect();
        for (name, plane) in more {
            // Each once, whatever was asked for.
            if *name != "interest" && others.iter().all(|(known, _)| known != name) {
                others.push((*name, *plane));
            }
        }
        let drape = Drape { elevation, uncertainty: ground.uncertainty() };
        let interest = &maps.interest.interest;
        let planes = DecisionMaps { interest, others: &others, drape: Some(drape) };
        self.decision(decision, &planes)
    }
}

impl<S: Store> Recorder for LogWriter<S> {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        Self::observation(self, observation).map_err(|e| RecordError(e.to_string()))
    }

    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError> {
        self.decided(decision, maps, &[]).map_err(|e| RecordError(e.to_string()))
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        Self::outcome(self, outcome).map_err(|e| RecordError(e.to_string()))
    }

    fn message(&mut self, message: &Message) -> Result<(), RecordError> {
        Self::heard(self, message).map_err(|e| RecordError(e.to_string()))
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        let record = fault(event);
        Self::fault(self, &record).map_err(|e| RecordError(e.to_string()))
    }
}

/// A fault as a record.
pub(crate) fn fault(event: &FaultEvent) -> record::Fault {
    record::Fault {
        name: event.name.clone(),
        kind: event.kind.name().to_owned(),
        time_s: event.time_s,
        until_s: event.until_s.is_finite().then_some(event.until_s),
        text: event.to_string(),
    }
}

/// The mission inside a log.
///
/// # Errors
/// [`ReplayError::Mission`] if it is not there or does not load.
pub fn mission_of(log: &LogReader) -> Result<Mission, ReplayError> {
    Ok(Mission::from_files(&files_of(log)?)?)
}

/// The mission's files, which a log that was cut early may not hold.
pub(crate) fn files_of(log: &LogReader) -> Result<BTreeMap<String, Vec<u8>>, ReplayError> {
    let files = mission_files(log);
    if files.is_empty() && log.status != Status::Complete {
        return Err(ReplayError::NoMission { status: log.status.clone() });
    }
    Ok(files)
}

/// Whether this build's decisions mean what the log's mean.
///
/// # Errors
/// [`ReplayError::OtherVersion`] if not.
pub(crate) fn same_version(log: &LogReader) -> Result<(), ReplayError> {
    let here = record::DECISION_VERSION;
    match log.decisions().map(|decision| decision.decision_version).find(|logged| *logged != here) {
        Some(logged) => Err(ReplayError::OtherVersion { logged, here }),
        None => Ok(()),
    }
}

/// The mission's files among a log's attachments, by name.
pub(crate) fn mission_files(log: &LogReader) -> BTreeMap<String, Vec<u8>> {
    let files = log.attachments.iter();
    files
        .filter_map(|a| Some((a.name.strip_prefix(MISSION_FOLDER)?.to_owned(), a.data.clone())))
        .collect()
}

/// The causal links of the sequence that a decision chose, in the DOT language.
///
/// # Errors
/// [`ReplayError`] as [`derive_at`], or if the sequence is no valid STRIPS plan.
pub fn causal_dot(log: &LogReader, number: u32) -> Result<String, ReplayError> {
    let mission = mission_of(log)?;
    let Some(past) = derive_at(log, number)? else {
        return Err(
            LogError::NoMap { topic: crate::topic::DECISION.into(), decision: number }.into()
        );
    };
    let goals = &past.decision.manager_after.goals;
    let directive_of = |id: GoalId| mission.spec.directives[goals[&id].directive].clone();
    let facts = past.decision.state.facts;
    let sequence = &past.decision.plan().sequence;
    Ok(CausalGraph::new(sequence, &mission.spec.domain, facts, directive_of)?.dot())
}
