//! Whether a log holds what its inputs lead to, at four levels.

mod invariants;
mod simulated;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use wisdom_autonomy::{Autonomy, AutonomyError, Decision, Message, Observation, Outcome};
use wisdom_grid::Raster;
use wisdom_mission::Mission;

use crate::compare::{Difference, MapDifference, first_difference};
use crate::record::{self, CHAIN_START, DECISION_VERSION, hex};
use crate::{
    Entry, LogError, LogReader, Reel, ReplayError, Setting, Status, check, is_plane, mission_of,
    plane, topic,
};

use invariants::Watcher;
pub use invariants::{Breach, INVARIANTS};

/// How much is checked. Each level checks what the ones before it do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum VerifyLevel {
    /// The file: every checksum, numbers without gaps, the digest chain, the end record.
    File,
    /// Whether this build can tell: the mission inside is the one the log names, and its decisions mean what this build's
    /// mean.
    Identity,
    /// Every decision derived again from the logged inputs, and the mission's invariants.
    #[default]
    Redecide,
    /// The closed loop driven again in the world inside the log: the inputs must come out too.
    Resimulate,
}

impl VerifyLevel {
    /// Every level, from the least to the most.
    pub const ALL: [Self; 4] = [Self::File, Self::Identity, Self::Redecide, Self::Resimulate];

    /// The name that the command line takes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Identity => "identity",
            Self::Redecide => "re-decide",
            Self::Resimulate => "re-simulate",
        }
    }
}

impl std::fmt::Display for VerifyLevel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What became of a verification.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The level asked for.
    pub level: VerifyLevel,
    /// Decisions that agree (all of them, or those before the first difference); at the levels below
    /// [`VerifyLevel::Redecide`], decisions in the log.
    pub decisions: u32,
    /// Logged maps that agree with the derived ones, bit for bit.
    pub maps: u32,
    /// How whole the file is.
    pub status: Status,
    /// The digest chain over the decision records: `intact`, or where it breaks.
    pub chain: String,
    /// Why this build cannot tell, if it cannot: that is no difference.
    pub not_comparable: Option<String>,
    /// The first difference between what was logged and what the logged inputs lead to.
    pub difference: Option<Difference>,
    /// Invariants that do not hold, in the order they were met.
    pub breaches: Vec<Breach>,
    /// What else a reader should know.
    pub remarks: Vec<String>,
}

impl Verification {
    /// Whether nothing was found that should not be. A log that was cut short may hold all it promises: see
    /// [`Verification::status`].
    #[must_use]
    pub fn holds(&self) -> bool {
        self.difference.is_none()
            && self.breaches.is_empty()
            && self.not_comparable.is_none()
            && !matches!(self.status, Status::Corrupt { .. })
    }
}

/// Checks a log; see [`VerifyLevel`] for what. `progress` is told of every decision that agrees.
///
/// # Errors
/// [`ReplayError`] if the log cannot be read or its mission does not load. What is found is no error.
pub fn verify(
    path: &Path,
    level: VerifyLevel,
    progress: &mut dyn FnMut(u32),
) -> Result<Verification, ReplayError> {
    let log = LogReader::open(path)?;
    let mut found = verify_log(&log, level, progress)?;
    if found.status == Status::Complete {
        // What only the whole file can tell: checksums that are missing, indexes that say something else.
        found.status = check(path)?.status;
    }
    Ok(found)
}

/// [`verify`] for a log that was read already.
///
/// # Errors
/// As [`verify`].
pub fn verify_log(
    log: &LogReader,
    level: VerifyLevel,
    progress: &mut dyn FnMut(u32),
) -> Result<Verification, ReplayError> {
    let mut found = Verification {
        level,
        decisions: log.decisions().count() as u32,
        maps: 0,
        status: log.status.clone(),
        chain: chain(log),
        not_comparable: None,
        difference: None,
        breaches: Vec::new(),
        remarks: Vec::new(),
    };
    if !found.chain.starts_with("intact") {
        found.remarks.push(format!("digest chain {}", found.chain));
    }
    if level == VerifyLevel::File {
        return Ok(found);
    }
    found.decisions = 0;
    let mission = mission_of(log)?;
    identify(log, &mission, &mut found);
    // A damaged file is not what was written; what comes before the damage may be all the same.
    let cannot_tell = found.difference.is_some() || found.not_comparable.is_some();
    if level == VerifyLevel::Identity || cannot_tell {
        return Ok(found);
    }
    Derivation::new(log, &mission)?.run(log, &mut found, progress)?;
    if level == VerifyLevel::Resimulate && found.difference.is_none() {
        found.difference = simulated::difference(log, &mission)?;
    }
    Ok(found)
}

/// Whether the mission inside is the one the log names, and this build's decisions mean the same.
fn identify(log: &LogReader, mission: &Mission, found: &mut Verification) {
    let logged = |key: &str| log.metadata.get(key).cloned().unwrap_or_default();
    let facts = [
        ("mission_digest", hex(&mission.digest)),
        ("mission", mission.name.clone()),
        ("seed", mission.seed.to_string()),
        ("rule", mission.spec.fusion.rule.to_string()),
        ("policy", mission.spec.policy.to_string()),
        ("prize", mission.spec.prize.to_string()),
    ];
    let other = facts.into_iter().find(|(key, inside)| logged(key) != *inside);
    found.difference =
        other.map(|(key, inside)| Difference::told(0, "identity", key, logged(key), inside));
    let version = env!("CARGO_PKG_VERSION");
    if let Some(other) = log.metadata.get("version").filter(|v| *v != version) {
        found.remarks.push(format!("logged by version {other}, verified by {version}"));
    }
    let meant = log.decisions().map(|d| d.decision_version).find(|v| *v != DECISION_VERSION);
    let meant = meant.map(|v| v.to_string()).or_else(|| {
        let of_run = log.metadata.get("decision_version")?;
        (*of_run != DECISION_VERSION.to_string()).then(|| of_run.clone())
    });
    found.not_comparable = meant.map(|version| {
        format!("its decisions mean version {version}, those of this build {DECISION_VERSION}")
    });
}

/// Whether every decision record carries the digest of itself and of all before it.
fn chain(log: &LogReader) -> String {
    let mut link = CHAIN_START;
    for decision in log.decisions() {
        link = decision.link(&link);
        if decision.chain != hex(&link) {
            return format!("breaks at decision {}", decision.number);
        }
    }
    match &log.end {
        Some(end) if end.chain != hex(&link) => {
            "ends in another digest than the end record says".into()
        }
        Some(_) => "intact".into(),
        None => "intact as far as the log goes".into(),
    }
}

/// Why the core could not be fed with what was logged.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error(transparent)]
    Record(#[from] LogError),
    #[error(transparent)]
    Core(#[from] AutonomyError),
}

/// A core that is fed what a log holds.
struct Derivation<'a> {
    rover: Autonomy,
    setting: Setting,
    watcher: Watcher<'a>,
    reel: Reel,
    /// Those of further planes that the log holds.
    others: BTreeMap<String, Reel>,
}

impl<'a> Derivation<'a> {
    fn new(log: &LogReader, mission: &'a Mission) -> Result<Self, ReplayError> {
        Ok(Self {
            rover: Autonomy::new(mission.spec.clone())?,
            setting: Setting::from(&mission.spec),
            watcher: Watcher::new(mission, log),
            reel: Reel::new(),
            others: BTreeMap::new(),
        })
    }

    fn run(
        mut self,
        log: &LogReader,
        found: &mut Verification,
        progress: &mut dyn FnMut(u32),
    ) -> Result<(), ReplayError> {
        for entry in &log.entries {
            self.watcher.entry(entry);
            let number = found.decisions;
            let rover = &mut self.rover;
            let taken_in = match entry {
                Entry::Observation(logged) => {
                    let what = format!("observation {}", logged.number);
                    let told = Observation::try_from(logged).map_err(Refused::from);
                    told.and_then(|told| Ok(rover.observe(&told)?)).map_err(|e| (e, "frame", what))
                }
                Entry::Message(logged) => {
                    let what = format!("message {}", logged.number);
                    let told = Message::try_from(logged).map_err(Refused::from);
                    told.and_then(|told| Ok(rover.hear(&told)?)).map_err(|e| (e, "state", what))
                }
                Entry::Fault(_) => Ok(()),
                Entry::Outcome(logged) => {
                    let what = format!("outcome of decision {}", logged.decision);
                    let told = Outcome::try_from(logged).map_err(Refused::from);
                    told.and_then(|told| Ok(rover.report(&told)?)).map_err(|e| (e, "state", what))
                }
                Entry::Decision(logged) => match rover.decide() {
                    Err(error) => Err((error.into(), "choice", "decision".to_owned())),
                    Ok(decision) => {
                        found.difference = match self.compare(log, logged, &decision, found) {
                            Err(ReplayError::Log(malformed @ LogError::Malformed { .. })) => {
                                let (what, why) = ("map", malformed.to_string());
                                Some(Difference::told(number, "fusion", what, why, "a map"))
                            }
                            other => other?,
                        };
                        if found.difference.is_none() {
                            found.decisions += 1;
                            progress(found.decisions);
                        }
                        Ok(())
                    }
                },
            };
            if let Err((error, stage, what)) = taken_in {
                let refused = format!("refused: {error}");
                let logged = "logged as an input";
                found.difference = Some(Difference::told(number, stage, what, logged, refused));
            }
            if found.difference.is_some() {
                break;
            }
        }
        found.breaches = self.watcher.breaches();
        Ok(())
    }

    /// What first differs between a logged decision and the derived one: a field of the record, or a map beside it.
    fn compare(
        &mut self,
        log: &LogReader,
        logged: &record::Decision,
        decision: &Decision,
        found: &mut Verification,
    ) -> Result<Option<Difference>, ReplayError> {
        let derived = record::Decision::of(decision, &self.setting);
        let number = decision.number;
        let mut maps = Vec::new();
        if let Some(derived) = self.rover.maps() {
            self.watcher.maps(number, decision, derived);
            if let Some(difference) = promised(log, number) {
                return Ok(Some(difference));
            }
            let interest = self.reel.turn_to(log, number)?;
            let mut written: Vec<(&str, Cow<'_, Raster<f32>>)> = Vec::new();
            written.extend(interest.map(|plane| ("interest", Cow::Borrowed(plane))));
            let others = log.maps_of(number).filter_map(topic::plane_of);
            let spec = self.rover.spec();
            for name in others.filter(|name| *name != "interest" && is_plane(spec, name)) {
                let reel = self.others.entry(name.to_owned()).or_insert_with(|| Reel::of(name));
                let plane = reel.turn_to(log, number)?;
                written.extend(plane.map(|plane| (name, Cow::Owned(plane.clone()))));
            }
            for (name, written) in written {
                let Some(plane) = plane(&self.rover, name) else { continue };
                if written.spec() != plane.spec() {
                    let said = |raster: &Raster<f32>| raster.spec().window().to_string();
                    let (left, right) = (said(&written), said(&plane));
                    return Ok(Some(Difference::told(number, "fusion", name, left, right)));
                }
                maps.extend(MapDifference::between(name, &written, &plane));
                found.maps += u32::from(maps.is_empty());
            }
        }
        let record = first_difference(logged, &derived);
        let map = maps.into_iter().next();
        Ok(match (record, map) {
            (Some(difference), map) => Some(Difference { map, ..difference }),
            (None, Some(map)) => {
                let (left, right) = (map.left.to_string(), map.right.to_string());
                let path = format!("/map/{}{}", map.plane, map.cell);
                let ulps = Some(u64::from(ordinal(map.left).abs_diff(ordinal(map.right))));
                let told = Difference::told(number, "fusion", path, left, right);
                Some(Difference { ulps, map: Some(map), ..told })
            }
            (None, None) => None,
        })
    }
}

/// Whether the log holds the interest map of a decision as its own facts say: each in a full log (as all were before
/// logs said so), the first in a log of patches, none in one of digests.
fn promised(log: &LogReader, number: u32) -> Option<Difference> {
    let mode = log.metadata.get(crate::write::MAPS).map_or("full", String::as_str);
    let there = log.maps_of(number).any(|topic| topic == topic::INTEREST);
    let due = match mode {
        "full" => true,
        "patch" => number == 0,
        _ => false,
    };
    let (left, right) = match (due, there) {
        (true, false) => ("absent", "there"),
        (false, true) if mode == "digest" => ("there", "absent"),
        _ => return None,
    };
    let right = format!("{right}, as the log's maps are {mode}");
    Some(Difference::told(number, "fusion", topic::INTEREST, left, right))
}

/// The place of a number among all that an f32 can be.
fn ordinal(value: f32) -> i32 {
    let bits = value.to_bits() as i32;
    if bits < 0 { i32::MIN.wrapping_sub(bits) } else { bits }
}
