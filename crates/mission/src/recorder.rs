//! Where a run goes: into a log, or into memory.

use wisdom_autonomy::{Decision, Maps, Message, Observation, Outcome};

use crate::FaultEvent;

/// Why a record could not be kept.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct RecordError(pub String);

/// Keeps what goes into the core and what comes out of it, in order.
pub trait Recorder {
    /// An observation is about to be fed to the core.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be kept; the run ends then.
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError>;

    /// The core decided.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be kept; the run ends then.
    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError>;

    /// The step ended and is about to be reported to the core.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be kept; the run ends then.
    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError>;

    /// Word from the ground or the health watch is about to be passed on to the core.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be kept; the run ends then.
    fn message(&mut self, message: &Message) -> Result<(), RecordError>;

    /// A fault struck. The core is not told.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be kept; the run ends then.
    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError>;
}

/// Keeps decisions and outcomes in memory.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Observations, without their readings' copies: only how many there were.
    pub observations: u32,
    /// Every decision.
    pub decisions: Vec<Decision>,
    /// Every outcome.
    pub outcomes: Vec<Outcome>,
    /// Every message.
    pub messages: Vec<Message>,
    /// Every fault that struck.
    pub faults: Vec<FaultEvent>,
}

impl Recorder for Memory {
    fn observation(&mut self, _: &Observation) -> Result<(), RecordError> {
        self.observations += 1;
        Ok(())
    }

    fn decision(&mut self, decision: &Decision, _: &Maps) -> Result<(), RecordError> {
        self.decisions.push(decision.clone());
        Ok(())
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.outcomes.push(outcome.clone());
        Ok(())
    }

    fn message(&mut self, message: &Message) -> Result<(), RecordError> {
        self.messages.push(message.clone());
        Ok(())
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        self.faults.push(event.clone());
        Ok(())
    }
}
