//! What may break: faults that a mission names, and when chance lets them strike.

/// A fault that may strike once in a mission.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Its name.
    pub name: String,
    /// What it does.
    pub kind: FaultKind,
    /// Chance that it strikes in a mission, in [0, 1].
    pub probability: f64,
    /// When it may strike: mission time in seconds, evenly spread from the first to the second.
    pub between_s: (f64, f64),
    /// How long it lasts, seconds; infinite if it stays.
    pub lasts_s: f64,
}

/// What a fault does while it lasts. The rover is not told, but of lost facts: it meets the consequences.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FaultKind {
    /// An instrument reads nothing.
    InstrumentLost {
        /// The instrument's name.
        instrument: String,
    },
    /// Driving takes more time and energy.
    WheelDrag {
        /// The factor on both, at least 1.
        factor: f64,
    },
    /// Heights are read too high or too low; their uncertainties do not tell.
    DemBias {
        /// What is added to every height read, metres.
        bias_m: f64,
    },
    /// Facts cease to hold: a tool broke. This one the rover's health watch notices and tells.
    FactsLost {
        /// The facts, by name.
        facts: Vec<String>,
    },
    /// After a drive that a hazard or blocked ground ended, the rover waits for the ground's word.
    CommDelay {
        /// The wait, seconds.
        delay_s: f64,
    },
}

impl FaultKind {
    /// The kind's name, as a mission file writes it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::InstrumentLost { .. } => "instrument-lost",
            Self::WheelDrag { .. } => "wheel-drag",
            Self::DemBias { .. } => "dem-bias",
            Self::FactsLost { .. } => "facts-lost",
            Self::CommDelay { .. } => "comm-delay",
        }
    }
}

/// A fault that struck.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultEvent {
    /// The fault's name.
    pub name: String,
    /// What it does.
    pub kind: FaultKind,
    /// When it struck: mission time, seconds.
    pub time_s: f64,
    /// When it ends: mission time, seconds; infinite if it stays.
    pub until_s: f64,
}

impl std::fmt::Display for FaultEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "fault `{}` ({}", self.name, self.kind.name())?;
        match &self.kind {
            FaultKind::InstrumentLost { instrument } => write!(f, ": {instrument}")?,
            FaultKind::WheelDrag { factor } => write!(f, ": x {factor}")?,
            FaultKind::DemBias { bias_m } => write!(f, ": {bias_m:+} m")?,
            FaultKind::FactsLost { facts } => write!(f, ": {}", facts.join(", "))?,
            FaultKind::CommDelay { delay_s } => write!(f, ": {delay_s} s")?,
        }
        write!(f, ") strikes at {:.0} s", self.time_s)?;
        if self.until_s.is_finite() { write!(f, " until {:.0} s", self.until_s) } else { Ok(()) }
    }
}

/// The faults that chance lets strike in one world, in the order they strike.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Faults {
    /// Those to come, the earliest last.
    pending: Vec<FaultEvent>,
    struck: Vec<FaultEvent>,
}

impl Faults {
    /// `draw(name, 0)` decides whether the fault of that name strikes, `draw(name, 1)` when; both in [0, 1).
    pub(crate) fn new(faults: &[Fault], draw: impl Fn(&str, u64) -> f64) -> Self {
        let mut pending: Vec<FaultEvent> = faults
            .iter()
            .filter(|fault| draw(&fault.name, 0) < fault.probability)
            .map(|fault| {
                let (from, to) = fault.between_s;
                let time_s = from + (to - from) * draw(&fault.name, 1);
                FaultEvent {
                    name: fault.name.clone(),
                    kind: fault.kind.clone(),
                    time_s,
                    until_s: time_s + fault.lasts_s,
                }
            })
            .collect();
        // Stable: of faults at one time, the one the mission names first strikes first.
        pending.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        pending.reverse();
        Self { pending, struck: Vec::new() }
    }

    /// When the next fault strikes that the rover is told of, if any does.
    pub(crate) fn next_told_s(&self) -> Option<f64> {
        let told = |event: &&FaultEvent| matches!(event.kind, FaultKind::FactsLost { .. });
        self.pending.iter().rev().find(told).map(|next| next.time_s)
    }

    /// The next fault due by a mission time, if any: it has struck then.
    pub(crate) fn strike(&mut self, time_s: f64) -> Option<FaultEvent> {
        let event = self.pending.pop_if(|next| next.time_s <= time_s)?;
        self.struck.push(event.clone());
        Some(event)
    }

    /// What ails the rover at a mission time.
    pub(crate) fn active(&self, time_s: f64) -> impl Iterator<Item = &FaultKind> {
        self.struck.iter().filter(move |event| time_s < event.until_s).map(|event| &event.kind)
    }

    /// Whether an instrument reads nothing.
    pub(crate) fn has_lost(&self, instrument: &str, time_s: f64) -> bool {
        self.active(time_s).any(
            |kind| matches!(kind, FaultKind::InstrumentLost { instrument: lost } if lost == instrument),
        )
    }

    /// The factor on time and energy of driving.
    pub(crate) fn drag(&self, time_s: f64) -> f64 {
        self.active(time_s).fold(1.0, |drag, kind| match kind {
            FaultKind::WheelDrag { factor } => drag * factor,
            _ => drag,
        })
    }

    /// What is added to heights read, metres.
    pub(crate) fn bias_m(&self, time_s: f64) -> f64 {
        self.active(time_s).fold(0.0, |bias, kind| match kind {
            FaultKind::DemBias { bias_m } => bias + bias_m,
            _ => bias,
        })
    }

    /// How long the rover waits for the ground's word, seconds.
    pub(crate) fn delay_s(&self, time_s: f64) -> f64 {
        self.active(time_s).fold(0.0, |delay, kind| match kind {
            FaultKind::CommDelay { delay_s } => delay + delay_s,
            _ => delay,
        })
    }

    pub(crate) fn into_struck(self) -> Vec<FaultEvent> {
        self.struck
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(name: &str, kind: FaultKind, probability: f64) -> Fault {
        Fault {
            name: name.into(),
            kind,
            probability,
            between_s: (100.0, 300.0),
            lasts_s: f64::INFINITY,
        }
    }

    #[test]
    fn faults_strike_by_their_chance_at_their_time_and_end() {
        let drag =
            Fault { lasts_s: 50.0, ..fault("drag", FaultKind::WheelDrag { factor: 1.5 }, 0.5) };
        let never = fault("never", FaultKind::CommDelay { delay_s: 9.0 }, 0.0);
        let later = fault("later", FaultKind::DemBias { bias_m: -0.2 }, 1.0);
        let draw = |name: &str, what: u64| match (name, what) {
            ("drag", 0) => 0.49,
            (_, 0) => 0.0,
            ("drag", _) => 0.25,
            _ => 0.5,
        };
        let mut faults = Faults::new(&[later, never, drag], draw);
        assert!(faults.strike(149.9).is_none());
        let first = faults.strike(1000.0).unwrap();
        assert_eq!((first.name.as_str(), first.time_s, first.until_s), ("drag", 150.0, 200.0));
        assert_eq!(faults.strike(1000.0).unwrap().name, "later");
        assert!(faults.strike(1000.0).is_none());
        assert_eq!((faults.drag(199.0), faults.drag(200.0)), (1.5, 1.0));
        assert_eq!((faults.bias_m(210.0), faults.delay_s(210.0)), (-0.2, 0.0));
        assert_eq!(
            first.to_string(),
            "fault `drag` (wheel-drag: x 1.5) strikes at 150 s until 200 s"
        );
    }
}
