//! What becomes of one place in one run: whether the plan holds a goal there before and after a reading, and why.

use std::fmt::Write as _;

use wisdom_autonomy::{Act, Decision};
use wisdom_goals::{Action, Goal, Reason, Retired, Term, Verdict};
use wisdom_grid::Cell;
use wisdom_mission::{Achievement, Memory, Mission, RunError, run};

/// The place a reading is of, and when it is handed in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    /// Its cell.
    pub(crate) cell: Cell,
    /// Goals within this distance of it count as there, cells.
    pub(crate) radius: f64,
    /// From which mission time on the reading is known, seconds.
    pub(crate) at_s: f64,
    /// Side of a cell, metres.
    spacing_m: f64,
}

impl Spot {
    /// The place of a mission's first reading; there is what the goal manager takes for the same place.
    pub(crate) fn of(mission: &Mission) -> Option<Self> {
        let reading = mission.world.execution().readings.first()?;
        let spacing_m = mission.spec.grid.spacing_m();
        let radius = mission.spec.manager.identity_radius_m / spacing_m;
        Some(Self { cell: reading.cell, radius, at_s: reading.at_s, spacing_m })
    }

    fn holds(&self, cell: Cell) -> bool {
        self.cell.distance(cell) <= self.radius
    }

    /// Whether a decision was taken with the reading known, as it is once its time has come: readings are handed over
    /// before anything is decided.
    fn is_known_to(&self, decision: &Decision) -> bool {
        decision.state.spent.time_s >= self.at_s
    }
}

/// How long a run is followed after the reading, seconds: two or three goals' worth.
pub(crate) const FOLLOWED_S: f64 = 7200.0;

/// How far a run is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Until {
    /// To the first decision with the reading.
    Decision,
    /// If that plans a goal at the place, until the place is done, or for [`FOLLOWED_S`].
    Done,
}

/// What a decision says of the goal at the place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standing {
    /// The goal as it is after the decision.
    pub(crate) goal: Goal,
    /// Its directive's name.
    pub(crate) directive: String,
    /// What was done with it.
    pub(crate) action: Action,
    /// Why.
    pub(crate) reason: Reason,
    /// Its turn in the sequence, from 0.
    pub(crate) turn: Option<usize>,
    /// The numbers compared.
    pub(crate) terms: Vec<Term>,
}

/// A goal carried out at the place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Done {
    /// What was done.
    pub(crate) achievement: Achievement,
    /// How far from the place its target lies, cells.
    pub(crate) distance: f64,
}

/// What became of the place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fate {
    /// What the last decision without the reading said of a goal there.
    pub(crate) before: Option<Standing>,
    /// Number, time and place of the first decision with it; none if the mission ended earlier.
    pub(crate) decision: Option<(u32, f64, Cell)>,
    /// What that decision said of a goal there.
    pub(crate) after: Option<Standing>,
    /// Whether that decision sends the rover there at once.
    pub(crate) sent: bool,
    /// The reason in words, with its numbers.
    pub(crate) why: String,
    /// Done there when that decision was taken: before the reading came, or in the step in which it came.
    pub(crate) done_before: Option<Done>,
    /// Done there afterwards.
    pub(crate) done_after: Option<Done>,
}

impl Fate {
    /// The goal's turn in the first sequence chosen with the reading.
    pub(crate) fn turn(&self) -> Option<usize> {
        self.after.as_ref().and_then(|standing| standing.turn)
    }

    /// Its turn in the last sequence chosen without.
    pub(crate) fn turn_before(&self) -> Option<usize> {
        self.before.as_ref().and_then(|standing| standing.turn)
    }

    /// Whether the reading makes the rover turn to the place: it is sent there, and was on its way elsewhere.
    pub(crate) fn turns_back(&self) -> bool {
        self.sent && self.turn_before() != Some(0)
    }
}

/// Runs a mission and follows what becomes of a place in it.
pub(crate) fn fate(mission: &Mission, spot: &Spot, until: Until) -> Result<Fate, RunError> {
    let mut record = Memory::default();
    let mut planned = None;
    let summary = run(mission, &mut record, &mut |progress| {
        let Some(decision) = progress.decision.filter(|d| spot.is_known_to(d)) else { return true };
        // What the first decision with the reading says of the place.
        let planned = *planned.get_or_insert_with(|| {
            standing(mission, decision, spot).is_some_and(|standing| standing.turn.is_some())
        });
        let late = progress.spent.time_s >= spot.at_s + FOLLOWED_S;
        until == Until::Done && planned && !late && !is_closed(mission, decision, spot)
    })?;
    let decisions = &record.decisions;
    let after = decisions.iter().find(|decision| spot.is_known_to(decision));
    let before = decisions.iter().rev().find(|decision| !spot.is_known_to(decision));
    let taken_s = after.map_or(spot.at_s, |decision| decision.state.spent.time_s);
    let done = |late: bool| {
        let here = |goal: &&Achievement| spot.holds(goal.target) && (goal.time_s > taken_s) == late;
        summary.achieved.iter().find(here).map(|goal| Done {
            achievement: goal.clone(),
            distance: spot.cell.distance(goal.target),
        })
    };
    let after_standing = after.and_then(|decision| standing(mission, decision, spot));
    let sent = after.is_some_and(|decision| {
        let id = after_standing.as_ref().map(|standing| standing.goal.id);
        matches!(decision.act, Act::Pursue(goal) if Some(goal) == id)
    });
    Ok(Fate {
        before: before.and_then(|decision| standing(mission, decision, spot)),
        decision: after.map(|d| (d.number, d.state.spent.time_s, d.state.pose.cell)),
        why: after.map_or_else(
            || "the mission ended before the reading".to_owned(),
            |decision| why(decision, after_standing.as_ref(), spot),
        ),
        after: after_standing,
        sent,
        done_before: done(false),
        done_after: done(true),
    })
}

/// Whether the place was done, and no goal there is left.
fn is_closed(mission: &Mission, decision: &Decision, spot: &Spot) -> bool {
    let done = |retired: &Retired| {
        retired.closed && retired.reason == Reason::Done && spot.holds(retired.target)
    };
    let open = standing(mission, decision, spot).is_some_and(|s| s.goal.status().is_open());
    !open && decision.manager_after.retired.iter().any(done)
}

/// What a decision says of the place: of several goals there of the first in the sequence, then of the nearest open one,
/// then of the nearest that it gave up.
fn standing(mission: &Mission, decision: &Decision, spot: &Spot) -> Option<Standing> {
    let here = decision
        .verdicts
        .iter()
        .filter(|v| spot.holds(v.goal.target) && v.action != Action::Achieve);
    let rank = |v: &&Verdict| (v.turn.unwrap_or(usize::MAX), !v.goal.status().is_open());
    let distance = |v: &&Verdict| spot.cell.distance(v.goal.target);
    let best =
        here.min_by(|a, b| rank(a).cmp(&rank(b)).then(distance(a).total_cmp(&distance(b))))?;
    Some(Standing {
        directive: mission.spec.directives[best.goal.directive].name.clone(),
        goal: best.goal.clone(),
        action: best.action,
        reason: best.reason,
        turn: best.turn,
        terms: best.terms.clone(),
    })
}

fn why(decision: &Decision, standing: Option<&Standing>, spot: &Spot) -> String {
    let Some(standing) = standing else { return why_none(decision, spot) };
    let Standing { goal, directive, action, reason, turn, terms } = standing;
    let turn = turn.map_or_else(String::new, |turn| format!(", turn {}", turn + 1));
    let mut text = format!(
        "{} {directive} at ({}, {}): {action} {reason}{turn}; interest {:.4}, prize {:.4}",
        goal.id, goal.target.row, goal.target.col, goal.interest, goal.prize
    );
    for Term { name, value, limit } in terms {
        write!(text, "; {name} {value:.4}").expect("a string takes all that is written");
        if let Some(limit) = limit {
            write!(text, " against {limit:.4}").expect("a string takes all that is written");
        }
    }
    text
}

/// Why a decision knows of no goal at the place: what stands out there, and what was done about it.
fn why_none(decision: &Decision, spot: &Spot) -> String {
    let distance = |cell: Cell| spot.cell.distance(cell);
    let here = decision.sites.iter().filter(|site| spot.holds(site.peak));
    let site = here.min_by(|a, b| distance(a.peak).total_cmp(&distance(b.peak)));
    let place = site.map_or(spot.cell, |site| site.peak);
    let closes = |retired: &&Retired| {
        retired.closed && retired.target.distance(place) * spot.spacing_m <= retired.radius_m
    };
    let mut text = site.map_or_else(
        || "no goal: no maximum there stands out enough".to_owned(),
        |site| {
            format!(
                "no goal: the maximum at ({}, {}) with prize {:.4} and prominence {:.4} brings forth none",
                site.peak.row, site.peak.col, site.prize, site.prominence
            )
        },
    );
    if let Some(Retired { goal, target, reason, .. }) =
        decision.manager_after.retired.iter().find(closes)
    {
        write!(
            text,
            "; {goal} at ({}, {}), {:.1} cells off, has closed the place ({reason})",
            target.row,
            target.col,
            target.distance(place)
        )
        .expect("a string takes all that is written");
    }
    text
}
