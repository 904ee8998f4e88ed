//! Logged decisions taken again under another rule, policy or mission.
//!
//! Each is taken from its own logged state: the readings are those the rover had, and its memory, pose, facts and
//! purse are what the record says. What comes out is what the changed rover would have done in that rover's place, so a
//! difference is the change's own and not that of a path driven before.

use std::collections::BTreeMap;

use wisdom_autonomy::{Autonomy, Maps, Moment, Observation, Source, Spec};
use wisdom_goals::{Kind, ManagerState, Wish};
use wisdom_grid::{Cell, GridSpec};
use wisdom_mission::{Mission, Override};

use crate::compare::Difference;
use crate::record::{self, Verdict};
use crate::replay::{files_of, same_version};
use crate::{Entry, LogReader, ReplayError, Setting, first_difference, mission_of};

/// A logged decision and the one that would have been taken in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Retaken {
    /// As it was logged.
    pub logged: record::Decision,
    /// As the changed mission takes it, from the same state and readings.
    pub decided: record::Decision,
    /// The first stage and field that differ, whether or not the choice does.
    pub difference: Option<Difference>,
    /// What differs about the choice; none if they choose alike.
    pub parting: Option<Parting>,
    /// Both choices on the changed mission's map.
    pub scores: Scores,
    /// Interest on the changed map at the target of each goal that the logged decision speaks of, by the goal's id;
    /// without those off that map.
    pub interests: BTreeMap<u32, f64>,
}

/// Two choices on one map: expected interest (J1, [`wisdom_goals::Policy::ExpectedInterest`]) of the sequences chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scores {
    /// Of the logged sequence, its legs as reliable as they were logged; none if a target lies off the changed map.
    pub logged: Option<f64>,
    /// Of the sequence chosen in its place.
    pub decided: f64,
}

/// The first thing about two choices that differs. Places within the identity radius of each other are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parting {
    /// One pursues, looks, goes home or waits where the other does something else.
    Act,
    /// What is to be done next is the same; where, or following what directive, is not.
    Goal,
    /// The next goal is the same; the sequence goes on otherwise.
    Order,
}

impl Parting {
    /// In a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Act => "act",
            Self::Goal => "goal",
            Self::Order => "order",
        }
    }
}

impl std::fmt::Display for Parting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What two deliberations say of one place, side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
    /// On the one side.
    pub left: Option<Verdict>,
    /// On the other.
    pub right: Option<Verdict>,
}

/// What became of re-deciding a log.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Redecided {
    /// Decisions taken again.
    pub decisions: u32,
    /// Those that choose alike.
    pub alike: u32,
    /// The first that does not.
    pub first: Option<u32>,
    /// What a reader should know: layers that are not read, and the like.
    pub remarks: Vec<String>,
}

/// The mission inside a log with changes made to it.
///
/// # Errors
/// [`ReplayError::Mission`] if it is not there or does not load so.
pub fn mission_with(log: &LogReader, overrides: &[Override]) -> Result<Mission, ReplayError> {
    Ok(Mission::from_files_with(&files_of(log)?, overrides)?)
}

/// Takes every logged decision again under another mission, each from its logged state; `each` is given every one and
/// says whether to go on.
///
/// # Errors
/// [`ReplayError`] if the log's own mission does not load, a record cannot be read, or the two missions do not fit: other
/// ground, or a directive, operator or fact that the log speaks of and the other mission does not have; or if another
/// version of the core decided the log.
///
/// # Panics
/// Never: a core that has decided has maps.
pub fn redecide(
    log: &LogReader,
    under: &Mission,
    each: &mut dyn FnMut(Retaken) -> bool,
) -> Result<Redecided, ReplayError> {
    same_version(log)?;
    let own = mission_of(log)?.spec;
    let spec = &under.spec;
    if spec.grid != own.grid {
        let told = |grid: &GridSpec| {
            format!("{} x {} cells of {} m", grid.rows(), grid.cols(), grid.spacing_m())
        };
        let (there, here) = (told(&spec.grid), told(&own.grid));
        let apart = if there == here { ", at another place" } else { "" };
        let what = format!("its ground is {there}, the log's {here}{apart}");
        return Err(ReplayError::Unfit { what });
    }
    let words = Words::new(&own, spec);
    let setting = Setting::from(spec);
    let radius_cells = spec.manager.identity_radius_m / spec.grid.spacing_m();
    let mut rover = Autonomy::new(spec.clone())?;
    let mut found = Redecided { remarks: remarks(&own, spec), ..Redecided::default() };
    for entry in &log.entries {
        match entry {
            Entry::Observation(logged) => {
                let mut observation = Observation::try_from(logged)?;
                observation.windows.retain(|window| spec.measures(&window.layer));
                rover.observe(&observation)?;
            }
            Entry::Decision(logged) => {
                let moment = words.moment(logged, spec)?;
                let decision = rover.decide_at(moment)?;
                let decided = record::Decision::of(&decision, &setting);
                let maps = rover.maps().expect("a core that has decided has maps");
                let retaken = Retaken {
                    difference: first_difference(logged, &decided),
                    parting: parting(logged, &decided, radius_cells),
                    scores: Scores {
                        logged: score(logged, &decided, maps, spec),
                        decided: decision.plan().sequence.expected,
                    },
                    interests: interests(logged, maps),
                    logged: (**logged).clone(),
                    decided,
                };
                found.decisions += 1;
                if retaken.parting.is_none() {
                    found.alike += 1;
                } else {
                    found.first = found.first.or(Some(logged.number));
                }
                if !each(retaken) {
                    break;
                }
            }
            // What came of a step, and what was heard, is in the state of the decision after it.
            Entry::Outcome(_) | Entry::Message(_) | Entry::Fault(_) => {}
        }
    }
    Ok(found)
}

/// Layers that only one of them reads.
fn remarks(own: &Spec, other: &Spec) -> Vec<String> {
    let measured = |spec: &Spec| -> Vec<String> {
        let layers = spec.layers.iter().filter(|l| matches!(l.source, Source::Measured(_)));
        layers.map(|l| l.name.clone()).collect()
    };
    let (mine, theirs) = (measured(own), measured(other));
    let unread = mine.iter().filter(|name| !theirs.contains(name));
    let unlogged = theirs.iter().filter(|name| !mine.contains(name));
    let unread = unread.map(|n| format!("layer `{n}` is in the log and not read"));
    unread
        .chain(unlogged.map(|n| format!("layer `{n}` is not in the log: it stays unknown")))
        .collect()
}

/// How the words of one mission are said in another: by name.
struct Words<'a> {
    directives: Vec<(&'a str, Option<usize>)>,
    operators: Vec<(&'a str, Option<usize>)>,
    experts: Vec<Option<usize>>,
}

impl<'a> Words<'a> {
    fn new(own: &'a Spec, other: &Spec) -> Self {
        let directive = |name: &str| other.directives.iter().position(|d| d.name == name);
        let operator = |name: &str| other.domain.operators().iter().position(|o| o.name == name);
        let expert = |name: &str| other.experts.iter().position(|e| e.name == name);
        Self {
            directives: own.directives.iter().map(|d| (&*d.name, directive(&d.name))).collect(),
            operators: {
                let all = own.domain.operators().iter();
                all.map(|o| (&*o.name, operator(&o.name))).collect()
            },
            experts: own.experts.iter().map(|e| expert(&e.name)).collect(),
        }
    }

    /// The moment of a logged decision in the other mission's words.
    fn moment(&self, logged: &record::Decision, other: &Spec) -> Result<Moment, ReplayError> {
        let mut moment = logged.moment(|names| other.domain.set(names))?;
        let number = logged.number;
        let unknown = |what: &str| ReplayError::Unfit {
            what: format!("decision {number} speaks of {what}, which it does not have"),
        };
        let word =
            |words: &[(&str, Option<usize>)], kind: &str, index: usize| match words.get(index) {
                Some((_, Some(there))) => Ok(*there),
                Some((name, None)) => Err(unknown(&format!("{kind} `{name}`"))),
                None => Err(unknown(&format!("{kind} {index}"))),
            };
        let directive = |index| word(&self.directives, "directive", index);
        let ManagerState { goals, retired, commands, .. } = &mut moment.state.manager;
        for goal in goals.values_mut() {
            goal.directive = directive(goal.directive)?;
            for operator in &mut goal.operators {
                *operator = word(&self.operators, "operator", *operator)?;
            }
            if let Some((before, _)) = goal.order.as_mut().and_then(|order| order.before.as_mut()) {
                *before = directive(*before)?;
            }
        }
        for place in retired {
            let bit = |index: usize| 1u64.checked_shl(index as u32).unwrap_or(0);
            let heard = self.experts.iter().enumerate();
            let heard = heard.filter(|(index, _)| place.heard & bit(*index) != 0);
            place.heard = heard.fold(0, |all, (_, there)| all | there.map_or(0, bit));
        }
        for command in commands {
            if let Wish::Pursue { directive: followed, .. } = &mut command.wish {
                *followed = directive(*followed)?;
            }
        }
        Ok(moment)
    }
}

/// A goal as a choice names it: where, and following what.
type Place<'a> = (Cell, &'a str);

/// What a decision says of each goal, by the goal's id.
fn verdicts(decision: &record::Decision) -> BTreeMap<u32, &Verdict> {
    let all = decision.choice.iter().flat_map(|choice| &choice.verdicts);
    all.filter_map(|verdict| Some((verdict.goal.as_ref()?.id, verdict))).collect()
}

fn place(verdict: &Verdict) -> Option<Place<'_>> {
    let goal = verdict.goal.as_ref()?;
    Some((goal.target?.into(), &goal.directive_name))
}

/// The places of the sequence that a decision chose, in order.
fn chosen(decision: &record::Decision) -> Vec<Option<Place<'_>>> {
    let verdicts = verdicts(decision);
    let stops = sequence(decision).into_iter().flat_map(|sequence| &sequence.stops);
    stops.map(|stop| verdicts.get(&stop.goal).and_then(|verdict| place(verdict))).collect()
}

fn sequence(decision: &record::Decision) -> Option<&record::Sequence> {
    let chosen = decision.choice.as_ref()?.chosen as usize;
    decision.objective.as_ref()?.family.get(chosen)?.sequence.as_ref()
}

/// What differs first about the choices of two decisions; none if they do the same and mean to do the same afterwards.
/// Places at most `radius_cells` apart that follow the same directive are one place, whatever the goals are called.
#[must_use]
pub fn parting(a: &record::Decision, b: &record::Decision, radius_cells: f64) -> Option<Parting> {
    let act = |decision: &record::Decision| {
        let act = decision.choice.as_ref().and_then(|choice| choice.act.clone());
        act.unwrap_or_default()
    };
    let (left, right) = (act(a), act(b));
    if left.name != right.name {
        return Some(Parting::Act);
    }
    let one_place = |a: Option<Place<'_>>, b: Option<Place<'_>>| match (a, b) {
        (Some((a, followed)), Some((b, other))) => {
            followed == other && a.distance(b) <= radius_cells
        }
        (a, b) => a.is_none() && b.is_none(),
    };
    // Where a look or the way home ends.
    let end =
        |act: &record::Act| act.route.as_ref()?.cells.last().map(|&cell| (Cell::from(cell), ""));
    if !one_place(end(&left), end(&right)) {
        return Some(Parting::Goal);
    }
    let (a, b) = (chosen(a), chosen(b));
    let differs = (0..a.len().max(b.len())).find(|&turn| match (a.get(turn), b.get(turn)) {
        (Some(a), Some(b)) => !one_place(*a, *b),
        _ => true,
    });
    match differs {
        None => None,
        Some(0) if left.name == "pursue" => Some(Parting::Goal),
        Some(_) => Some(Parting::Order),
    }
}

/// What two decisions say of the goals that one of them sequences, and of those of which they say different things, side
/// by side: in the order of the left sequence, then of the right one, then of ids. Goals known before the decision are
/// matched by id, others by place.
#[must_use]
pub fn side_by_side(a: &record::Decision, b: &record::Decision, radius_cells: f64) -> Vec<Terms> {
    let (left, right) = (verdicts(a), verdicts(b));
    // Ids below this one were given before the decision: equal on both sides if they began in the same state.
    let next = |decision: &record::Decision| {
        let state = decision.state.as_ref().and_then(|state| state.manager.as_ref());
        state.map_or(0, |manager| manager.next_id)
    };
    let known = next(a).min(next(b));
    let mut rest: Vec<&Verdict> = right.values().copied().collect();
    let mut pairs: Vec<Terms> = Vec::new();
    for verdict in left.values() {
        let twin = rest.iter().position(|other| {
            let (Some(mine), Some(theirs)) = (&verdict.goal, &other.goal) else { return false };
            if mine.id < known || theirs.id < known {
                return mine.id == theirs.id;
            }
            let (Some((a, x)), Some((b, y))) = (place(verdict), place(other)) else { return false };
            x == y && a.distance(b) <= radius_cells
        });
        let right = twin.map(|at| rest.remove(at).clone());
        pairs.push(Terms { left: Some((*verdict).clone()), right });
    }
    pairs
        .extend(rest.into_iter().map(|verdict| Terms { left: None, right: Some(verdict.clone()) }));
    let turn = |side: &Option<Verdict>| side.as_ref().and_then(|v| v.turn).unwrap_or(u32::MAX);
    pairs.retain(|Terms { left, right }| {
        let said = |side: &Option<Verdict>| {
            side.as_ref().map(|v| (v.action.clone(), v.reason.clone(), v.turn))
        };
        turn(left) != u32::MAX || turn(right) != u32::MAX || said(left) != said(right)
    });
    pairs.sort_by_key(|terms| (turn(&terms.left), turn(&terms.right)));
    pairs
}

/// What a map says of the targets that a decision speaks of.
fn interests(logged: &record::Decision, maps: &Maps) -> BTreeMap<u32, f64> {
    let targets = verdicts(logged).into_iter().filter_map(|(id, v)| Some((id, place(v)?.0)));
    let interest = &maps.interest.interest;
    targets.filter_map(|(id, target)| Some((id, f64::from(*interest.get(target)?)))).collect()
}

/// Expected interest of the logged sequence with the prizes of the changed map.
fn score(
    logged: &record::Decision,
    decided: &record::Decision,
    maps: &Maps,
    spec: &Spec,
) -> Option<f64> {
    let (before, now) = (verdicts(logged), verdicts(decided));
    let legs = &logged.choice.as_ref()?.plan.as_ref()?.legs;
    let mut reliability = 1.0;
    let mut score = 0.0;
    for (turn, stop) in sequence(logged)?.stops.iter().enumerate() {
        let neg_ln_r = legs.get(turn)?.route.as_ref()?.cost.as_ref()?.neg_ln_r?;
        reliability *= libm::exp(-neg_ln_r);
        let goal = before.get(&stop.goal)?.goal.as_ref()?;
        let same = now.get(&stop.goal).and_then(|verdict| verdict.goal.as_ref());
        let same =
            same.filter(|g| (&g.target, &g.directive_name) == (&goal.target, &goal.directive_name));
        let prize = match (same, &goal.order) {
            (Some(same), _) => same.prize,
            (None, Some(order)) => order.prize,
            (None, None) => {
                let directive = spec.directives.iter().find(|d| d.name == goal.directive_name)?;
                let signal = match directive.kind {
                    Kind::Inspect => &maps.prize.prize,
                    Kind::LookAgain => &maps.promise.as_ref()?.gain,
                    Kind::Adjudicate => &maps.interest.contradiction,
                };
                directive.weight * f64::from(*signal.get(goal.target?.into())?)
            }
        };
        score += prize * reliability;
    }
    Some(score)
}
