//! The STRIPS state: facts, operators, and the small forward search that turns a goal into operators
//! (Fikes & Nilsson 1971; the paper's reference 6).

mod ground;
mod search;

use std::ops::AddAssign;

pub use ground::{
    Ground, GroundError, GroundFault, GroundPlace, Lifted, MAX_GROUND, ObjectText, OperatorPart,
    SchemaText, TypeText,
};

/// The most facts a domain may name: a state is one machine word.
pub const MAX_FACTS: usize = 64;

/// A set of facts that hold; everything else is false (closed world).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct FactSet(u64);

impl FactSet {
    /// No fact.
    pub const EMPTY: Self = Self(0);

    /// The set as bits, in the order of [`Domain::facts`].
    #[must_use]
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// A set from its bits.
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// Whether every fact of `other` holds.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Facts of either.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Facts of `self` that are not in `other`.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether both name a fact in common.
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// What an operator or a service at a stop costs, the drive itself aside.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ServiceCost {
    /// Time, seconds.
    pub time_s: f64,
    /// Energy, joules.
    pub energy_j: f64,
    /// Data to be kept or sent, megabytes.
    pub data_mb: f64,
}

impl AddAssign for ServiceCost {
    fn add_assign(&mut self, other: Self) {
        self.time_s += other.time_s;
        self.energy_j += other.energy_j;
        self.data_mb += other.data_mb;
    }
}

/// A STRIPS operator with numeric costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Operator {
    /// Name, unique in its domain.
    pub name: String,
    /// Facts that must hold before.
    pub preconditions: FactSet,
    /// Facts that hold afterwards.
    pub adds: FactSet,
    /// Facts that cease to hold (adds win where a fact is in both, as in STRIPS).
    pub deletes: FactSet,
    /// What it costs; for the driving operator, what it costs beyond the route.
    pub cost: ServiceCost,
}

impl Operator {
    /// The state after the operator, if its preconditions hold in `facts`.
    #[must_use]
    pub fn apply(&self, facts: FactSet) -> Option<FactSet> {
        facts.contains(self.preconditions).then(|| facts.without(self.deletes).with(self.adds))
    }
}

/// An operator as a file names it, before its facts are numbered.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OperatorText {
    /// Name, unique in its domain.
    pub name: String,
    /// Names of the facts that must hold before.
    pub preconditions: Vec<String>,
    /// Names of the facts that hold afterwards.
    pub adds: Vec<String>,
    /// Names of the facts that cease to hold.
    pub deletes: Vec<String>,
    /// What it costs.
    pub cost: ServiceCost,
}

/// Why operators and facts are not a domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// More facts than fit a state.
    #[error("the domain names {found} facts; at most {MAX_FACTS} are possible")]
    TooManyFacts {
        /// Facts found.
        found: usize,
    },
    /// Two operators share a name.
    #[error("operator `{name}` is given twice")]
    DuplicateOperator {
        /// The name.
        name: String,
    },
    /// There must be exactly one operator that drives.
    #[error("no operator is named `{name}`; the domain needs one that drives")]
    NoDrive {
        /// The name looked for.
        name: &'static str,
    },
    /// A directive wants facts that no operators can bring about.
    #[error("no sequence of operators brings about `{wanted}` from the initial facts")]
    Impossible {
        /// The facts wanted.
        wanted: String,
    },
    /// A fact is used that no operator or initial state mentions.
    #[error("fact `{name}` is never made true: no operator adds it and it is not an initial fact")]
    UnknownFact {
        /// The fact.
        name: String,
    },
    /// A cost is negative or not a number.
    #[error("operator `{operator}`: {field} = {value}; it must be zero or more")]
    Cost {
        /// The operator.
        operator: String,
        /// The cost.
        field: &'static str,
        /// The value found.
        value: f64,
    },
}

/// The name of the operator that moves the rover along a route.
pub const DRIVE: &str = "drive";

/// Facts and operators of a mission.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    facts: Vec<String>,
    operators: Vec<Operator>,
    initial: FactSet,
    drive: usize,
}

/// The operators that bring about a goal: those before the drive, then the drive, then those at the site.
#[derive(Debug, Clone, PartialEq)]
pub struct Expansion {
    /// Operators (by index) before driving off.
    pub before: Vec<usize>,
    /// Operators (by index) at the site.
    pub after: Vec<usize>,
    /// Facts that hold when all is done.
    pub facts: FactSet,
    /// What the operators cost together, the route itself aside.
    pub cost: ServiceCost,
}

impl Domain {
    /// Numbers the facts of `operators` and `initial` in order of first mention and checks them.
    ///
    /// # Errors
    /// A [`DomainError`] naming what does not fit.
    pub fn new(operators: &[OperatorText], initial: &[String]) -> Result<Self, DomainError> {
        let mut facts: Vec<String> = Vec::new();
        let mut set = |names: &[String]| {
            let mut bits = 0u128;
            for name in names {
                let index = facts.iter().position(|f| f == name).unwrap_or_else(|| {
                    facts.push(name.clone());
                    facts.len() - 1
                });
                bits |= 1 << index.min(127);
            }
            FactSet(bits as u64)
        };
        let initial = set(initial);
        let mut numbered: Vec<Operator> = Vec::new();
        for text in operators {
            if numbered.iter().any(|o| o.name == text.name) {
                return Err(DomainError::DuplicateOperator { name: text.name.clone() });
            }
            let costs = [
                ("time_s", text.cost.time_s),
                ("energy_j", text.cost.energy_j),
                ("data_mb", text.cost.data_mb),
            ];
            if let Some((field, value)) =
                costs.into_iter().find(|(_, v)| !(v.is_finite() && *v >= 0.0))
            {
                return Err(DomainError::Cost { operator: text.name.clone(), field, value });
            }
            numbered.push(Operator {
                name: text.name.clone(),
                preconditions: set(&text.preconditions),
                adds: set(&text.adds),
                deletes: set(&text.deletes),
                cost: text.cost,
            });
        }
        if facts.len() > MAX_FACTS {
            return Err(DomainError::TooManyFacts { found: facts.len() });
        }
        let drive = numbered
            .iter()
            .position(|o| o.name == DRIVE)
            .ok_or(DomainError::NoDrive { name: DRIVE })?;
        let possible = numbered.iter().fold(initial, |all, o| all.with(o.adds));
        let domain = Self { facts, operators: numbered, initial, drive };
        let needed =
            domain.operators.iter().fold(FactSet::EMPTY, |all, o| all.with(o.preconditions));
        if let Some(name) = domain.names(needed.without(possible)).next() {
            return Err(DomainError::UnknownFact { name: name.to_owned() });
        }
        Ok(domain)
    }

    /// All facts, in the order of their bits.
    #[must_use]
    pub fn facts(&self) -> &[String] {
        &self.facts
    }

    /// All operators.
    #[must_use]
    pub fn operators(&self) -> &[Operator] {
        &self.operators
    }

    /// Index of the operator that drives.
    #[must_use]
    pub fn drive(&self) -> usize {
        self.drive
    }

    /// The facts that hold when the mission starts.
    #[must_use]
    pub fn initial(&self) -> FactSet {
        self.initial
    }

    /// The set of the named facts.
    ///
    /// # Errors
    /// [`DomainError::UnknownFact`] for a name the domain does not mention.
    pub fn set(&self, names: &[String]) -> Result<FactSet, DomainError> {
        names.iter().try_fold(FactSet::EMPTY, |set, name| {
            let index = self
                .facts
                .iter()
                .position(|f| f == name)
                .ok_or_else(|| DomainError::UnknownFact { name: name.clone() })?;
            Ok(set.with(FactSet(1 << index)))
        })
    }

    /// The names of the facts in a set.
    pub fn names(&self, set: FactSet) -> impl Iterator<Item = &str> {
        self.facts
            .iter()
            .enumerate()
            .filter(move |(i, _)| set.0 >> i & 1 == 1)
            .map(|(_, name)| name.as_str())
    }

    /// The state after one operator of a goal that wants `wanted`, if its preconditions hold.
    #[must_use]
    pub fn step(&self, facts: FactSet, operator: usize, wanted: FactSet) -> Option<FactSet> {
        let after = self.operators[operator].apply(facts)?;
        Some(if operator == self.drive { after.without(wanted) } else { after })
    }

    /// The operators that lead from `facts`, through exactly one drive, to a state where `wanted` holds: those that take
    /// the least time (each counted in whole milliseconds), among these the fewest, among these the first in the order of
    /// their numbers; `None` if there are none.
    ///
    /// The facts wanted speak of the goal's own site, so what was true of them elsewhere does not count:
    /// the drive clears them.
    ///
    /// The search is A* (Hart, Nilsson and Raphael 1968) with the heuristic `h_max` (Bonet and Geffner 2001), which never
    /// promises too much; the answer does not depend on it.
    ///
    /// # Panics
    /// Never: every step the search takes is an operator's.
    #[must_use]
    pub fn expand(&self, facts: FactSet, wanted: FactSet) -> Option<Expansion> {
        search::expand(self, facts, wanted, search::Heuristic::Max).0
    }

    /// The same operators under other costs; with the same times every expansion stays what it is.
    /// `cost` is told each operator's number and time.
    pub(crate) fn costed(&self, cost: impl Fn(usize, f64) -> ServiceCost) -> Self {
        let mut domain = self.clone();
        for (index, operator) in domain.operators.iter_mut().enumerate() {
            operator.cost = cost(index, operator.cost.time_s);
        }
        domain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(ToString::to_string).collect()
    }

    fn operator(name: &str, pre: &[&str], add: &[&str], del: &[&str], time_s: f64) -> OperatorText {
        OperatorText {
            name: name.into(),
            preconditions: names(pre),
            adds: names(add),
            deletes: names(del),
            cost: ServiceCost { time_s, ..ServiceCost::default() },
        }
    }

    fn rover() -> Domain {
        Domain::new(
            &[
                operator("drive", &["arm-stowed"], &["at-site"], &[], 0.0),
                operator("stow", &["arm-out"], &["arm-stowed"], &["arm-out"], 30.0),
                operator("unstow", &["arm-stowed"], &["arm-out"], &["arm-stowed"], 40.0),
                operator("calibrate", &["arm-out"], &["calibrated"], &[], 100.0),
                operator(
                    "analyse",
                    &["at-site", "arm-out", "calibrated"],
                    &["analysed"],
                    &[],
                    600.0,
                ),
                operator("image", &["at-site", "arm-stowed"], &["imaged"], &[], 60.0),
            ],
            &names(&["arm-stowed"]),
        )
        .unwrap()
    }

    fn written(domain: &Domain, list: &[usize]) -> Vec<String> {
        list.iter().map(|&i| domain.operators()[i].name.clone()).collect()
    }

    #[test]
    fn an_analysis_unstows_calibrates_and_analyses_after_the_drive() {
        let domain = rover();
        let wanted = domain.set(&names(&["analysed"])).unwrap();
        let plan = domain.expand(domain.initial(), wanted).unwrap();
        assert_eq!(written(&domain, &plan.before), Vec::<String>::new());
        assert_eq!(written(&domain, &plan.after), ["unstow", "calibrate", "analyse"]);
        assert_eq!(plan.cost.time_s, 740.0);
    }

    #[test]
    fn what_one_goal_leaves_behind_changes_what_the_next_one_costs() {
        let domain = rover();
        let analysed = domain.set(&names(&["analysed"])).unwrap();
        let first = domain.expand(domain.initial(), analysed).unwrap();
        let second = domain.expand(first.facts, analysed).unwrap();
        // The arm must be stowed before driving (a delete effect undone), but the calibration still holds.
        assert_eq!(written(&domain, &second.before), ["stow"]);
        assert_eq!(written(&domain, &second.after), ["unstow", "analyse"]);
        assert_eq!(second.cost.time_s, 670.0);
        let image = domain.expand(first.facts, domain.set(&names(&["imaged"])).unwrap()).unwrap();
        assert_eq!(written(&domain, &image.before), ["stow"]);
        assert_eq!(written(&domain, &image.after), ["image"]);
    }

    #[test]
    fn a_fact_nobody_can_make_true_is_refused() {
        let operators = [operator("drive", &["brakes-off"], &[], &[], 0.0)];
        let error = Domain::new(&operators, &[]).unwrap_err();
        assert_eq!(error, DomainError::UnknownFact { name: "brakes-off".into() });
    }

    #[test]
    fn a_goal_out_of_reach_has_no_expansion() {
        let domain = Domain::new(
            &[
                operator("drive", &["arm-stowed"], &[], &[], 0.0),
                operator("break", &["arm-stowed"], &["broken"], &["arm-stowed"], 1.0),
                operator("weld", &["broken", "arm-stowed"], &["welded"], &[], 1.0),
            ],
            &names(&["arm-stowed"]),
        )
        .unwrap();
        let welded = domain.set(&names(&["welded"])).unwrap();
        assert_eq!(domain.expand(domain.initial(), welded), None);
    }
}
