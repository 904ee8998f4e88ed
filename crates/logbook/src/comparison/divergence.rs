//! Where two runs part, and whether they still knew the same when they did.

use wisdom_grid::Cell;

use crate::compare::Difference;
use crate::{LogReader, Parting, first_difference, parting, record};

/// What a decision chose: what to do now, and the places of its sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chosen {
    /// `pursue`, `look`, `home` or `wait`.
    pub act: String,
    /// Targets and directives of the goals of its sequence, in order.
    pub places: Vec<(Cell, String)>,
}

impl Chosen {
    /// What a logged decision chose.
    #[must_use]
    pub fn of(decision: &record::Decision) -> Self {
        let choice = decision.choice.as_ref();
        let act = choice.and_then(|choice| choice.act.as_ref());
        let mut turns: Vec<(u32, (Cell, String))> = choice
            .iter()
            .flat_map(|choice| &choice.verdicts)
            .filter(|verdict| verdict.action != "achieve" && verdict.action != "drop")
            .filter_map(|verdict| {
                let goal = verdict.goal.as_ref()?;
                Some((verdict.turn?, (goal.target?.into(), goal.directive_name.clone())))
            })
            .collect();
        turns.sort_by_key(|(turn, _)| *turn);
        Self {
            act: act.map(|act| act.name.clone()).unwrap_or_default(),
            places: turns.into_iter().map(|(_, place)| place).collect(),
        }
    }
}

/// Pursues and the first place, or what else is done.
impl std::fmt::Display for Chosen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.act)?;
        for (turn, (Cell { row, col }, _)) in self.places.iter().enumerate() {
            write!(f, "{} ({row}, {col})", if turn == 0 { "" } else { " >" })?;
        }
        Ok(())
    }
}

/// The first decision at which two runs choose differently, and what they knew then.
///
/// If readings, rover and memory are all equal, the difference is the rule's own (or whatever else the missions differ in).
/// With equal readings and rover only, it is too, by way of what the rule made of earlier decisions. Otherwise the runs had
/// come to differ before in something that was no choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Divergence {
    /// Its number.
    pub decision: u32,
    /// What differs; none if one of the runs took no such decision.
    pub parting: Option<Parting>,
    /// What the left run chose; none if it ended before.
    pub left: Option<Chosen>,
    /// What the right run chose; none if it ended before.
    pub right: Option<Chosen>,
    /// Whether both had the same readings: equal digests of all measured layers.
    pub same_readings: bool,
    /// Whether both rovers were the same: pose, facts, what was spent, and the leg under way.
    pub same_rover: bool,
    /// Whether both goal managers remembered the same.
    pub same_memory: bool,
    /// The first stage and field of the two records that differ.
    pub first: Option<Difference>,
}

impl Divergence {
    /// A decision that only one of the runs took.
    fn alone(
        only: &record::Decision,
        left: Option<&record::Decision>,
        right: Option<&record::Decision>,
    ) -> Self {
        Self {
            decision: only.number,
            parting: None,
            left: left.map(Chosen::of),
            right: right.map(Chosen::of),
            same_readings: false,
            same_rover: false,
            same_memory: false,
            first: None,
        }
    }
}

/// What differs about each decision that both runs took; none where they choose alike. Places at most `radius_cells` apart
/// are one.
#[must_use]
pub fn partings(a: &LogReader, b: &LogReader, radius_cells: f64) -> Vec<Option<Parting>> {
    let both = a.decisions().zip(b.decisions());
    both.map(|(left, right)| parting(left, right, radius_cells)).collect()
}

/// The first decision at which two runs choose differently, or that only one of them took; none if there is no such
/// decision. Places at most `radius_cells` apart are one.
#[must_use]
pub fn divergence(a: &LogReader, b: &LogReader, radius_cells: f64) -> Option<Divergence> {
    let (mut left, mut right) = (a.decisions(), b.decisions());
    loop {
        let (left, right) = match (left.next(), right.next()) {
            (None, None) => return None,
            (Some(left), Some(right)) => (left, right),
            (Some(only), None) => return Some(Divergence::alone(only, Some(only), None)),
            (None, Some(only)) => return Some(Divergence::alone(only, None, Some(only))),
        };
        let Some(parting) = parting(left, right, radius_cells) else { continue };
        let digest =
            |decision: &record::Decision| decision.frame.as_ref().map(|f| f.digest.clone());
        let rover = |decision: &record::Decision| {
            let state = decision.state.clone().unwrap_or_default();
            record::State { manager: None, ..state }
        };
        let memory = |decision: &record::Decision| {
            decision.state.as_ref().and_then(|state| state.manager.clone())
        };
        return Some(Divergence {
            decision: left.number,
            parting: Some(parting),
            left: Some(Chosen::of(left)),
            right: Some(Chosen::of(right)),
            same_readings: digest(left) == digest(right),
            same_rover: rover(left) == rover(right),
            same_memory: memory(left) == memory(right),
            first: first_difference(left, right),
        });
    }
}
