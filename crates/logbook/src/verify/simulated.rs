//! The closed loop driven again: every record of the run held against the logged one.

use wisdom_autonomy::{Decision, Maps, Message, Observation, Outcome};
use wisdom_mission::{FaultEvent, Mission, RecordError, Recorder, RunError, RunStatus};

use crate::compare::{Difference, first_difference, record_difference};
use crate::replay::fault;
use crate::{Entry, LogReader, ReplayError, Setting, record};

/// Drives the mission again and gives the first record that is not the logged one. A log that was cut, or whose run was
/// stopped, is held against the run as far as it goes.
pub(super) fn difference(
    log: &LogReader,
    mission: &Mission,
) -> Result<Option<Difference>, ReplayError> {
    let mut held = Held {
        entries: log.entries.iter(),
        setting: Setting::from(&mission.spec),
        decisions: 0,
        met: Met::Equal,
    };
    let ran = wisdom_mission::run(mission, &mut held, &mut |_| true);
    let stopped = RunStatus::Stopped.to_string();
    let cut = log.end.as_ref().is_none_or(|end| end.status == stopped);
    let next = held.entries.next().map(kind);
    let number = held.decisions;
    let told = |path: &str, left: String, right: String| {
        Some(Difference::told(number, "simulation", path, left, right))
    };
    Ok(match (held.met, ran) {
        (Met::Differs(difference), _) => Some(*difference),
        (Met::End(_), _) if cut => None,
        (Met::End(what), _) => {
            let end = log.end.as_ref().map_or_else(String::new, |end| end.status.clone());
            told("end", format!("the run ended ({end})"), format!("it goes on: {what}"))
        }
        (Met::Equal, Err(RunError::Autonomy(error))) => return Err(error.into()),
        (Met::Equal, Err(error)) => {
            told("run", "logged".to_owned(), format!("it cannot be driven again: {error}"))
        }
        (Met::Equal, Ok(summary)) => match (next, &log.end) {
            (Some(what), _) => told(
                "end",
                format!("the run goes on: {what}"),
                format!("it ends ({})", summary.status),
            ),
            (None, Some(end)) if end.status != summary.status.to_string() => {
                told("end.status", end.status.clone(), summary.status.to_string())
            }
            (None, _) => None,
        },
    })
}

fn kind(entry: &Entry) -> &'static str {
    match entry {
        Entry::Observation(_) => "an observation",
        Entry::Decision(_) => "a decision",
        Entry::Outcome(_) => "an outcome",
        Entry::Message(_) => "a message",
        Entry::Fault(_) => "a fault",
    }
}

/// How far run and log are alike.
enum Met {
    Equal,
    /// The log has no further record; the run has one of this kind.
    End(&'static str),
    Differs(Box<Difference>),
}

/// Holds each record of a run against the next one of a log.
struct Held<'a> {
    entries: std::slice::Iter<'a, Entry>,
    setting: Setting,
    decisions: u32,
    met: Met,
}

impl Held<'_> {
    fn meet(&mut self, made: &Entry) -> Result<(), RecordError> {
        let number = self.decisions;
        let differs = match (self.entries.next(), made) {
            (None, made) => {
                self.met = Met::End(kind(made));
                return Err(RecordError("the log ends here".to_owned()));
            }
            (Some(Entry::Decision(a)), Entry::Decision(b)) => {
                self.decisions += 1;
                first_difference(a, b)
            }
            (Some(logged), made) if logged == made => None,
            (Some(Entry::Observation(a)), Entry::Observation(b)) => {
                record_difference(number, "simulation", format!("observation {}", a.number), a, b)
            }
            (Some(Entry::Outcome(a)), Entry::Outcome(b)) => {
                record_difference(number, "simulation", "outcome".to_owned(), a, b)
            }
            (Some(Entry::Message(a)), Entry::Message(b)) => {
                record_difference(number, "simulation", format!("message {}", a.number), a, b)
            }
            (Some(Entry::Fault(a)), Entry::Fault(b)) => {
                record_difference(number, "simulation", "fault".to_owned(), a, b)
            }
            (Some(logged), made) => {
                Some(Difference::told(number, "simulation", "record", kind(logged), kind(made)))
            }
        };
        match differs {
            None => Ok(()),
            Some(difference) => {
                self.met = Met::Differs(Box::new(difference));
                Err(RecordError("the log has another record here".to_owned()))
            }
        }
    }
}

impl Recorder for Held<'_> {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        self.meet(&Entry::Observation(observation.into()))
    }

    fn decision(&mut self, decision: &Decision, _: &Maps) -> Result<(), RecordError> {
        let record = record::Decision::of(decision, &self.setting);
        self.meet(&Entry::Decision(Box::new(record)))
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.meet(&Entry::Outcome(outcome.into()))
    }

    fn message(&mut self, message: &Message) -> Result<(), RecordError> {
        self.meet(&Entry::Message(message.into()))
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        self.meet(&Entry::Fault(fault(event)))
    }
}
