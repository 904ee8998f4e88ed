//! The goal manager: goals are born from maxima, keep their name while the map changes, enter and leave the
//! sequence for stated reasons, and are given up when they must be.

mod select;
mod why;

use std::collections::{BTreeMap, BTreeSet};

use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use wisdom_grid::{Cell, Raster};
use wisdom_planner::CostVector;

use crate::prize::quantised;
use crate::sequence::{Candidate, MAX_SEQUENCED, Problem};
use crate::{
    Action, Cause, Directive, Domain, Extraction, Fade, Goal, GoalId, Reason, Site, Status, Term,
    Verdict,
};

pub use select::Selection;
use why::{Tried, bound};

/// How the manager weighs.
#[derive(Debug, Clone, PartialEq)]
pub struct ManagerSpec {
    /// What counts as a maximum worth a goal.
    pub extraction: Extraction,
    /// A new sequence must be better by this share to replace the committed one (default 0.05).
    pub hysteresis: f64,
    /// A maximum within this distance of a known goal is that goal, metres.
    pub identity_radius_m: f64,
    /// Goals sequenced exactly (default 14).
    pub max_sequenced: usize,
    /// Sequences in the family (default 5).
    pub family: usize,
    /// Labels that one search may expand (default 50 000).
    pub expansions: u64,
    /// How often a place given up as unreachable or as failed may be tried anew after its ground changed.
    pub max_reopenings: u32,
}

impl Default for ManagerSpec {
    fn default() -> Self {
        Self {
            extraction: Extraction::default(),
            hysteresis: 0.05,
            identity_radius_m: 8.0,
            max_sequenced: 14,
            family: 5,
            expansions: 50_000,
            max_reopenings: 1,
        }
    }
}

/// In the stead of a digest: the ground around the place was not all on the map when its goal ended. The first digest
/// seen takes its place, and is no change.
const GROUND_UNSEEN: u64 = 0;

/// A place where a goal ended, kept so that the same maximum does not come back for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct Retired {
    /// The goal that ended there.
    pub goal: GoalId,
    /// Its target.
    pub target: Cell,
    /// Maxima within this distance are the same place, metres; so is one whose region holds the target.
    pub radius_m: f64,
    /// Why it ended.
    pub reason: Reason,
    /// Digest of the ground around it when it ended; a change reopens a place given up.
    pub ground: u64,
    /// How often it has been reopened.
    pub reopenings: u32,
    /// Whether it keeps goals away, other than the one that answers for it.
    pub closed: bool,
}

impl Retired {
    /// Whether it ended without success, so that changed ground is a reason to try anew.
    fn is_given_up(&self) -> bool {
        matches!(self.reason, Reason::AttemptsSpent | Reason::Unreachable)
    }
}

/// Failed tries at a place. Places remember them when goals do not: a goal that is lost and found again, or
/// whose maximum wanders, gets no more tries than one that stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tries {
    /// Where the first of them was meant to lead.
    pub target: Cell,
    /// How many failed.
    pub failed: u32,
}

/// Something that happened to a goal between two decisions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Its operators were carried out.
    Achieved,
    /// A try failed.
    Failed,
}

/// Everything the manager remembers. Part of every decision record, so that any decision can be taken again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ManagerState {
    /// The open goals.
    pub goals: BTreeMap<GoalId, Goal>,
    /// The committed sequence.
    pub agenda: Vec<GoalId>,
    /// Places where goals ended.
    pub retired: Vec<Retired>,
    /// Places where tries failed, and no goal was given up for it yet.
    pub tries: Vec<Tries>,
    /// What happened since the last decision.
    pub events: Vec<(GoalId, Event)>,
    /// Number of the next goal.
    pub next_id: u32,
    /// Number of the next decision.
    pub decision: u32,
}

/// The map as goals see it: named scalar planes, no masses.
#[derive(Clone, Copy)]
pub struct Survey<'a> {
    /// Maxima, extracted at half the least prominence: known goals survive a little longer than new ones
    /// need to be born.
    pub sites: &'a [Site],
    /// Prize of each cell.
    pub prize: &'a Raster<f32>,
    /// Interest of each cell.
    pub interest: &'a Raster<f32>,
    /// Ignorance of each cell.
    pub ignorance: &'a Raster<f32>,
    /// Paradox of each cell.
    pub paradox: &'a Raster<f32>,
    /// Share of each expert in a cell's interest.
    pub credit: &'a dyn Fn(Cell) -> Vec<f64>,
    /// Digest of the ground (what is blocked) around a cell; none where that lies beyond the map's planes.
    pub ground: &'a dyn Fn(Cell) -> Option<u64>,
    /// Where the rover stands.
    pub stand: Cell,
    /// Whether any reading changed since the last decision.
    pub map_changed: bool,
}

/// Poses of each open goal, safest first, each with what it costs to get there.
pub type Poses = BTreeMap<GoalId, Vec<(Cell, CostVector)>>;

/// Which goals are sequenced exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shortlist {
    /// Goals sequenced: the committed ones, then the others, best bound first.
    pub kept: Vec<GoalId>,
    /// The others that could be reached, each with the bound that was too low: prize times the reliability of
    /// its safest pose, the most it could add to any sequence on its own.
    pub left_out: Vec<(GoalId, f64)>,
}

/// What a revision already settled, until the sequence is known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Revision {
    ended: Vec<Verdict>,
    born: BTreeSet<GoalId>,
    changed: BTreeMap<GoalId, (Reason, Vec<Term>)>,
    reopened: BTreeSet<GoalId>,
}

/// How a goal leaves the open ones.
struct Ending {
    action: Action,
    reason: Reason,
    other: Option<GoalId>,
    terms: Vec<Term>,
}

impl Ending {
    fn drop(reason: Reason, terms: Vec<Term>, other: Option<GoalId>) -> Self {
        Self { action: Action::Drop, reason, other, terms }
    }
}

/// Adds, drops, transforms and reorders goals.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalManager {
    spec: ManagerSpec,
    directives: Vec<Directive>,
    state: ManagerState,
}

impl GoalManager {
    /// A manager that knows no goal yet.
    #[must_use]
    pub fn new(spec: ManagerSpec, directives: Vec<Directive>) -> Self {
        Self { spec, directives, state: ManagerState::default() }
    }

    /// What it remembers.
    #[must_use]
    pub fn state(&self) -> &ManagerState {
        &self.state
    }

    /// Puts back what a decision record remembered.
    pub fn restore(&mut self, state: ManagerState) {
        self.state = state;
    }

    /// The pool.
    #[must_use]
    pub fn directives(&self) -> &[Directive] {
        &self.directives
    }

    /// How it weighs.
    #[must_use]
    pub fn spec(&self) -> &ManagerSpec {
        &self.spec
    }

    /// The extraction under which known goals survive: half the least prominence.
    #[must_use]
    pub fn survival(&self) -> Extraction {
        let extraction = &self.spec.extraction;
        Extraction { min_prominence: extraction.min_prominence / 2.0, ..extraction.clone() }
    }

    /// Notes what became of a goal; the next decision acts on it.
    pub fn note(&mut self, goal: GoalId, event: Event) {
        self.state.events.push((goal, event));
    }

    /// The ended goal that stands for this maximum, if it shall bring forth no goal: it lies within the radius
    /// of a closed place, or its region holds the target of one, and no open goal answers for that place.
    #[must_use]
    pub fn explained_by(&self, site: &Site, spacing_m: f64) -> Option<GoalId> {
        let same_place = |r: &&Retired| {
            r.target.distance(site.peak) * spacing_m <= r.radius_m
                || site.region.binary_search(&r.target).is_ok()
        };
        let in_force = |r: &&Retired| r.closed && !self.state.goals.contains_key(&r.goal);
        self.state.retired.iter().filter(in_force).find(same_place).map(|r| r.goal)
    }

    /// First half of a deliberation: ends goals that are done, spent, gone or merged, moves those whose
    /// maximum moved, and formulates new ones.
    pub fn revise(&mut self, survey: &Survey<'_>) -> Revision {
        let mut revision = Revision::default();
        self.apply_events(survey, &mut revision);
        self.let_go_off_map(survey, &mut revision);
        self.reopen(survey);
        let spacing = survey.prize.spec().spacing_m();
        let explained: Vec<Option<GoalId>> =
            survey.sites.iter().map(|site| self.explained_by(site, spacing)).collect();
        let matches = self.identify(survey, &explained);
        let open: Vec<GoalId> = self.state.goals.keys().copied().collect();
        let (followed, lost): (Vec<GoalId>, Vec<GoalId>) =
            open.into_iter().partition(|id| matches.contains_key(id));
        for id in followed {
            self.follow(id, &survey.sites[matches[&id]], survey, &mut revision);
        }
        // Afterwards, so that no goal is merged into one that just went.
        for id in lost {
            self.survive(id, survey, &matches, &explained, &mut revision);
        }
        let taken: BTreeSet<usize> = matches.values().copied().collect();
        for (index, site) in survey.sites.iter().enumerate() {
            let new = !taken.contains(&index) && explained[index].is_none();
            if new && site.prominence >= self.spec.extraction.min_prominence {
                self.formulate(site, survey, &mut revision);
            }
        }
        revision
    }

    /// Turns what happened since the last decision into endings and erosions.
    fn apply_events(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        for (id, event) in std::mem::take(&mut self.state.events) {
            let Some(goal) = self.state.goals.get_mut(&id) else { continue };
            match event {
                Event::Achieved => {
                    let radius_m = self.directives[goal.directive].exclusion_radius_m;
                    let terms =
                        vec![Term::of("interest", goal.interest), Term::of("prize", goal.prize)];
                    self.end(
                        id,
                        Ending {
                            action: Action::Achieve,
                            ..Ending::drop(Reason::Done, terms, None)
                        },
                        survey,
                        revision,
                    );
                    self.retire(id, radius_m, Reason::Done, survey, revision);
                }
                Event::Failed => {
                    let target = goal.target;
                    let here = self.failed_at(target, survey) + 1;
                    self.remember_failure(target, survey);
                    let goal = self.state.goals.get_mut(&id).expect("the goal is open");
                    goal.attempts = here.max(goal.attempts + 1);
                    let directive = &self.directives[goal.directive];
                    let tries = Term::against(
                        "attempts",
                        f64::from(goal.attempts),
                        f64::from(directive.max_attempts),
                    );
                    if goal.attempts >= directive.max_attempts {
                        let radius_m = self.spec.identity_radius_m;
                        self.end(
                            id,
                            Ending::drop(Reason::AttemptsSpent, vec![tries], None),
                            survey,
                            revision,
                        );
                        self.retire(id, radius_m, Reason::AttemptsSpent, survey, revision);
                    } else if let Some(weaker) = directive.substitute {
                        goal.directive = weaker;
                        revision.changed.insert(id, (Reason::Eroded, vec![tries]));
                    }
                }
            }
        }
    }

    /// Ends goals whose targets lie beyond the planes of the survey: the working map moved on with the rover.
    /// Their places are not closed; whoever comes back finds them again.
    fn let_go_off_map(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        let map = survey.prize.spec();
        let off = |goal: &&Goal| !map.contains(goal.target);
        let lost: Vec<(GoalId, Cell)> =
            self.state.goals.values().filter(off).map(|g| (g.id, g.target)).collect();
        for (id, target) in lost {
            let distance_m = survey.stand.distance(target) * map.spacing_m();
            let terms = vec![Term::of("distance_m", distance_m)];
            self.end(id, Ending::drop(Reason::OffMap, terms, None), survey, revision);
        }
    }

    /// Failed tries around a cell.
    fn failed_at(&self, target: Cell, survey: &Survey<'_>) -> u32 {
        let near = |t: &&Tries| self.same_place(t.target, target, survey);
        self.state.tries.iter().filter(near).map(|t| t.failed).max().unwrap_or(0)
    }

    /// Counts one more at every remembered place around a cell, or begins a new place there.
    fn remember_failure(&mut self, target: Cell, survey: &Survey<'_>) {
        let mut tries = std::mem::take(&mut self.state.tries);
        let mut known = false;
        for place in &mut tries {
            if self.same_place(place.target, target, survey) {
                place.failed += 1;
                known = true;
            }
        }
        if !known {
            tries.push(Tries { target, failed: 1 });
        }
        self.state.tries = tries;
    }

    /// Forgets the failed tries around a cell.
    fn forget_failures(&mut self, target: Cell, survey: &Survey<'_>) {
        let mut tries = std::mem::take(&mut self.state.tries);
        tries.retain(|place| !self.same_place(place.target, target, survey));
        self.state.tries = tries;
    }

    fn same_place(&self, a: Cell, b: Cell, survey: &Survey<'_>) -> bool {
        a.distance(b) * survey.prize.spec().spacing_m() <= self.spec.identity_radius_m
    }

    /// Opens places again whose ground changed after they were given up, unless a goal answers for them.
    fn reopen(&mut self, survey: &Survey<'_>) {
        for place in &mut self.state.retired {
            let ground = (survey.ground)(place.target);
            if place.ground == GROUND_UNSEEN {
                place.ground = ground.unwrap_or(GROUND_UNSEEN);
            }
            if place.closed
                && place.is_given_up()
                && !self.state.goals.contains_key(&place.goal)
                && place.reopenings < self.spec.max_reopenings
                && ground.is_some_and(|ground| ground != place.ground)
            {
                place.closed = false;
            }
        }
    }

    /// Assigns maxima to known goals: the assignment of least total distance within the identity radius
    /// (Kuhn-Munkres), a maximum whose region holds the goal's target before one that is merely near.
    fn identify(
        &self,
        survey: &Survey<'_>,
        explained: &[Option<GoalId>],
    ) -> BTreeMap<GoalId, usize> {
        const NEAR_MM: i64 = 1_000_000;
        let spacing = survey.prize.spec().spacing_m();
        let goals: Vec<&Goal> = self.state.goals.values().collect();
        let weight = |goal: &Goal, site: usize| -> i64 {
            if explained[site].is_some() {
                return 0;
            }
            let found = &survey.sites[site];
            let distance_m = goal.target.distance(found.peak) * spacing;
            let overlaps = found.region.binary_search(&goal.target).is_ok();
            if distance_m > self.spec.identity_radius_m && !overlaps {
                return 0;
            }
            let near = (NEAR_MM - (distance_m * 1000.0) as i64).max(1);
            if overlaps { near + NEAR_MM } else { near }
        };
        if goals.is_empty() || survey.sites.is_empty() {
            return BTreeMap::new();
        }
        let columns = survey.sites.len().max(goals.len());
        let weights = Matrix::from_fn(goals.len(), columns, |(g, s)| {
            if s < survey.sites.len() { weight(goals[g], s) } else { 0 }
        });
        let (_, assigned) = kuhn_munkres(&weights);
        assigned
            .into_iter()
            .enumerate()
            .filter(|&(g, s)| weights[(g, s)] > 0)
            .map(|(g, s)| (goals[g].id, s))
            .collect()
    }

    /// A goal whose maximum is still there: its numbers, and its target if the peak moved for good.
    fn follow(&mut self, id: GoalId, site: &Site, survey: &Survey<'_>, revision: &mut Revision) {
        let committed = self.state.agenda.contains(&id);
        let goal = self.state.goals.get_mut(&id).expect("the goal is open");
        let here = f64::from(survey.prize[goal.target]);
        // The old cell is as good while it lies within half the least prominence of the peak: noise in the
        // readings must not push targets around.
        let moved = here < site.prize - self.spec.extraction.min_prominence / 2.0;
        if moved {
            let distance_m = goal.target.distance(site.peak) * survey.prize.spec().spacing_m();
            if committed {
                let terms = vec![
                    Term::against("prize at the old target", here, site.prize),
                    Term::of("moved_m", distance_m),
                ];
                revision.changed.entry(id).or_insert((Reason::PeakMoved, terms));
            }
            goal.target = site.peak;
        }
        goal.prominence = site.prominence;
        goal.region_cells = site.region.len();
        self.weigh_anew(id, survey, revision);
    }

    /// A goal without a maximum: merged into another, kept while it is committed and still worth half its
    /// prize, or gone.
    fn survive(
        &mut self,
        id: GoalId,
        survey: &Survey<'_>,
        matches: &BTreeMap<GoalId, usize>,
        explained: &[Option<GoalId>],
        revision: &mut Revision,
    ) {
        let goal = &self.state.goals[&id];
        let spacing = survey.prize.spec().spacing_m();
        let near = |site: &Site| {
            site.region.binary_search(&goal.target).is_ok()
                || site.peak.distance(goal.target) * spacing <= self.spec.identity_radius_m
        };
        let claimed = survey.sites.iter().enumerate().find(|(_, site)| near(site)).map(|(i, _)| i);
        let owner = |site: usize| matches.iter().find(|&(_, &s)| s == site).map(|(g, _)| *g);
        if let Some(site) = claimed {
            let terms = vec![Term::against(
                "prize",
                f64::from(survey.prize[goal.target]),
                survey.sites[site].prize,
            )];
            if let Some(by) = explained[site] {
                self.end(id, Ending::drop(Reason::Explained, terms, Some(by)), survey, revision);
                return;
            }
            if let Some(by) = owner(site).filter(|by| self.state.goals.contains_key(by)) {
                self.end(id, Ending::drop(Reason::Merged, terms, Some(by)), survey, revision);
                return;
            }
        }
        let here = self.prize_at(goal, survey);
        let floor = goal.prize / 2.0;
        if goal.status == Status::Committed && here >= floor && here > 0.0 {
            self.weigh_anew(id, survey, revision);
        } else {
            let terms = vec![
                Term::against("prize", here, floor),
                Term::against("interest", f64::from(survey.interest[goal.target]), goal.interest),
            ];
            let reason = if here < floor { Reason::LostInterest } else { Reason::NoMaximum };
            self.end(id, Ending::drop(reason, terms, None), survey, revision);
        }
    }

    fn prize_at(&self, goal: &Goal, survey: &Survey<'_>) -> f64 {
        let weight = self.directives[goal.directive].weight;
        quantised(weight * f64::from(survey.prize[goal.target]))
    }

    /// Reads a goal's numbers off the map, and drops it if its interest is below what its directive asks or
    /// its prize is gone. (Credit chose the directive when the goal was born; it does not end a goal.)
    fn weigh_anew(&mut self, id: GoalId, survey: &Survey<'_>, revision: &mut Revision) {
        let prize = self.prize_at(&self.state.goals[&id], survey);
        let goal = self.state.goals.get_mut(&id).expect("the goal is open");
        let before = goal.interest;
        goal.interest = f64::from(survey.interest[goal.target]);
        goal.ignorance = f64::from(survey.ignorance[goal.target]);
        goal.paradox = f64::from(survey.paradox[goal.target]);
        goal.credit = (survey.credit)(goal.target);
        goal.prize = prize;
        let least = self.directives[goal.directive].min_interest;
        if goal.interest < least || prize <= 0.0 {
            let terms = vec![
                Term::against("interest", goal.interest, least),
                Term::of("interest before", before),
                Term::of("prize", prize),
            ];
            self.end(id, Ending::drop(Reason::LostInterest, terms, None), survey, revision);
        }
    }

    /// A new goal, if some directive looks for such a site (the heaviest; ties by order in the pool).
    fn formulate(&mut self, site: &Site, survey: &Survey<'_>, revision: &mut Revision) {
        // Of the cells that share the highest prize, the one nearest to the rover: it is on the side that can
        // be seen and reached, where the middle of a plateau may lie inside a rock.
        let on_top = |c: &&Cell| f64::from(survey.prize[**c]) >= site.prize;
        let nearest = site.region.iter().filter(on_top).min_by(|a, b| {
            a.distance(survey.stand).total_cmp(&b.distance(survey.stand)).then(a.cmp(b))
        });
        let target = nearest.copied().unwrap_or(site.peak);
        let interest = f64::from(survey.interest[target]);
        let credit = (survey.credit)(target);
        let mut best: Option<usize> = None;
        for (index, directive) in self.directives.iter().enumerate() {
            let heavier = best.is_none_or(|b| directive.weight > self.directives[b].weight);
            if heavier && directive.accepts(interest, &credit) {
                best = Some(index);
            }
        }
        let Some(directive) = best else { return };
        let prize = quantised(self.directives[directive].weight * site.prize);
        if prize <= 0.0 {
            return;
        }
        let id = GoalId(self.state.next_id);
        self.state.next_id += 1;
        if self.answer_for_reopened(id, site, survey) {
            revision.reopened.insert(id);
        }
        // What failed here before counts; one try remains.
        let most = self.directives[directive].max_attempts.saturating_sub(1);
        let attempts = self.failed_at(site.peak, survey).min(most);
        let goal = Goal {
            id,
            directive,
            target,
            interest,
            prize,
            prominence: site.prominence,
            ignorance: f64::from(survey.ignorance[target]),
            paradox: f64::from(survey.paradox[target]),
            credit,
            region_cells: site.region.len(),
            attempts,
            born: self.state.decision,
            status: Status::Formulated,
        };
        revision.born.insert(id);
        self.state.goals.insert(id, goal);
    }

    /// Puts reopened places around a site on trial: the new goal answers for them, and when it ends, however
    /// it does, they are closed again. Says whether there are any.
    fn answer_for_reopened(&mut self, id: GoalId, site: &Site, survey: &Survey<'_>) -> bool {
        let spacing = survey.prize.spec().spacing_m();
        let mut targets = Vec::new();
        for place in self.state.retired.iter_mut().filter(|r| !r.closed) {
            if place.target.distance(site.peak) * spacing <= place.radius_m
                || site.region.binary_search(&place.target).is_ok()
            {
                place.goal = id;
                place.closed = true;
                place.reopenings += 1;
                place.ground = (survey.ground)(place.target).unwrap_or(place.ground);
                targets.push(place.target);
            }
        }
        for target in &targets {
            self.forget_failures(*target, survey);
        }
        !targets.is_empty()
    }

    /// Takes a goal out of the open ones and writes its last verdict.
    fn end(&mut self, id: GoalId, ending: Ending, survey: &Survey<'_>, revision: &mut Revision) {
        let Ending { action, reason, other, terms } = ending;
        let Some(mut goal) = self.state.goals.remove(&id) else { return };
        goal.status = if action == Action::Achieve { Status::Achieved } else { Status::Dropped };
        let by_execution =
            matches!(reason, Reason::Done | Reason::AttemptsSpent | Reason::Explained);
        let cause =
            if survey.map_changed && !by_execution { Cause::Discovery } else { Cause::Execution };
        revision.changed.remove(&id);
        if revision.born.remove(&id) {
            // Formulated and refused in the same breath: nothing was ever promised.
            return;
        }
        revision.ended.push(Verdict { goal, action, reason, cause, turn: None, other, terms });
    }

    /// Remembers where the goal that just ended was.
    fn retire(
        &mut self,
        id: GoalId,
        radius_m: f64,
        reason: Reason,
        survey: &Survey<'_>,
        revision: &Revision,
    ) {
        let Some(ended) = revision.ended.iter().find(|v| v.goal.id == id) else { return };
        let target = ended.goal.target;
        let spacing = survey.prize.spec().spacing_m();
        // Trials of the same place add up: those this goal answered for, and one that was open to any.
        let mut reopenings = 0;
        self.state.retired.retain(|r| {
            let here = r.target.distance(target) * spacing <= r.radius_m;
            let mine = r.goal == id;
            if mine || (here && !r.closed) {
                reopenings = reopenings.max(r.reopenings + u32::from(!r.closed));
            }
            !(here && (mine || !r.closed))
        });
        if reason != Reason::Unreachable {
            self.forget_failures(target, survey);
        }
        self.state.retired.push(Retired {
            goal: id,
            target,
            radius_m,
            reason,
            ground: (survey.ground)(target).unwrap_or(GROUND_UNSEEN),
            reopenings,
            closed: true,
        });
    }

    /// Gives up committed goals that no pose reaches any more. The others stay known: the map may open.
    pub fn give_up_unreachable(
        &mut self,
        poses: &Poses,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) {
        let lost: Vec<GoalId> = self
            .state
            .goals
            .values()
            .filter(|g| g.status == Status::Committed && poses.get(&g.id).is_none_or(Vec::is_empty))
            .map(|g| g.id)
            .collect();
        for id in lost {
            let radius_m = self.spec.identity_radius_m;
            let terms = vec![Term::against("poses", 0.0, 1.0)];
            self.end(id, Ending::drop(Reason::Unreachable, terms, None), survey, revision);
            self.retire(id, radius_m, Reason::Unreachable, survey, revision);
        }
    }

    /// The goals to be sequenced: mandatory ones, committed ones, then those of highest bound; of goals that no sequence may hold
    /// together the better one, and the others only if there is room for them. Cells are `spacing_m` metres apart.
    #[must_use]
    pub fn shortlist(&self, poses: &Poses, spacing_m: f64) -> Shortlist {
        let mut bounds: Vec<(GoalId, f64)> = self
            .state
            .goals
            .values()
            .filter_map(|goal| Some((goal.id, bound(goal, poses)?)))
            .collect();
        let committed = |id: &GoalId| self.state.agenda.contains(id);
        let mandatory = |id: &GoalId| self.directives[self.state.goals[id].directive].mandatory;
        let first = |id: &GoalId| (mandatory(id), committed(id));
        bounds.sort_by(|a, b| {
            first(&b.0).cmp(&first(&a.0)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0))
        });
        let mut kept: Vec<(GoalId, f64)> = Vec::new();
        let mut beside: Vec<(GoalId, f64)> = Vec::new();
        for (id, bound) in bounds {
            let near = kept.iter().any(|&(other, _)| self.exclude(id, other, spacing_m));
            if near && !committed(&id) { &mut beside } else { &mut kept }.push((id, bound));
        }
        kept.append(&mut beside);
        let most = self.spec.max_sequenced.min(MAX_SEQUENCED);
        let left_out = kept.split_off(kept.len().min(most));
        Shortlist { kept: kept.into_iter().map(|(id, _)| id).collect(), left_out }
    }

    /// Whether doing one of two goals would close the ground around it to the other.
    fn exclude(&self, one: GoalId, other: GoalId, spacing_m: f64) -> bool {
        let (a, b) = (&self.state.goals[&one], &self.state.goals[&other]);
        let closes = |goal: &Goal| self.directives[goal.directive].exclusion_radius_m;
        one != other && a.target.distance(b.target) * spacing_m <= closes(a).max(closes(b))
    }

    /// The shortlisted goals as the search wants them; `nodes` gives the matrix nodes of each goal's poses, `spent_s` how
    /// long the mission has lasted.
    ///
    /// Two goals of which one will close the ground around it (its directive's exclusion radius) to the other do not
    /// stand in one sequence.
    #[must_use]
    pub fn candidates(
        &self,
        shortlist: &Shortlist,
        nodes: &BTreeMap<GoalId, Vec<usize>>,
        spacing_m: f64,
        spent_s: f64,
    ) -> Vec<Candidate> {
        shortlist
            .kept
            .iter()
            .map(|id| {
                let goal = &self.state.goals[id];
                let poses = nodes.get(id).cloned().unwrap_or_default();
                let near = |other: &&GoalId| self.exclude(*id, **other, spacing_m);
                let directive = &self.directives[goal.directive];
                let fade = directive.fade.map(|fade| Fade {
                    full_until_s: fade.full_until_s - spent_s,
                    nothing_from_s: fade.nothing_from_s - spent_s,
                });
                Candidate {
                    mandatory: directive.mandatory,
                    fade,
                    excludes: shortlist.kept.iter().filter(near).copied().collect(),
                    ..Candidate::new(*id, goal.directive, goal.prize, poses)
                }
            })
            .collect()
    }

    /// Chooses a sequence, as [`ManagerSpec::select`] does against the committed one.
    #[must_use]
    pub fn select(&self, problem: &Problem<'_>, pinned: Option<GoalId>) -> Selection {
        self.spec.select(problem, &self.state.agenda, pinned)
    }

    /// Second half of a deliberation: commits to the chosen sequence and says of every goal what was done.
    #[expect(clippy::too_many_arguments, reason = "what a decision settled, piece by piece")]
    pub fn commit(
        &mut self,
        revision: Revision,
        selection: &Selection,
        shortlist: &Shortlist,
        poses: &Poses,
        problem: &Problem<'_>,
        spacing_m: f64,
        map_changed: bool,
    ) -> Vec<Verdict> {
        let mut tried = Tried::new(problem);
        let order: Vec<GoalId> = selection.sequence().goals().collect();
        let steady = common_order(&self.state.agenda, &order);
        let mut verdicts = revision.ended;
        for goal in self.state.goals.values_mut() {
            let turn = order.iter().position(|id| *id == goal.id);
            goal.status = if turn.is_some() { Status::Committed } else { Status::Formulated };
        }
        for goal in self.state.goals.values() {
            let turn = order.iter().position(|id| *id == goal.id);
            let was_committed = self.state.agenda.contains(&goal.id);
            let numbers =
                || vec![Term::of("interest", goal.interest), Term::of("prize", goal.prize)];
            let mut other = None;
            let (action, reason, terms) = if turn.is_some() {
                if !was_committed {
                    let reason = if revision.reopened.contains(&goal.id) {
                        Reason::Reopened
                    } else if revision.born.contains(&goal.id) {
                        Reason::NewMaximum
                    } else {
                        Reason::Promoted
                    };
                    (Action::Add, reason, numbers())
                } else if let Some((reason, terms)) = revision.changed.get(&goal.id) {
                    (Action::Modify, *reason, terms.clone())
                } else if steady.contains(&goal.id) {
                    (Action::Keep, Reason::Unchanged, numbers())
                } else {
                    (Action::Reorder, Reason::BetterOrder, numbers())
                }
            } else if let Some(&near) = order.iter().find(|&&o| self.exclude(goal.id, o, spacing_m))
            {
                let theirs = self.state.goals[&near].prize;
                other = Some(near);
                let terms = vec![Term::against("prize", goal.prize, theirs)];
                (Action::Defer, Reason::Excluded, terms)
            } else {
                let (reason, terms) = self.why_not(goal, selection, shortlist, poses, &mut tried);
                (Action::Defer, reason, terms)
            };
            let cause = if self.state.decision == 0 {
                Cause::Start
            } else if map_changed && reason != Reason::Eroded {
                Cause::Discovery
            } else {
                Cause::Execution
            };
            verdicts.push(Verdict {
                goal: goal.clone(),
                action,
                reason,
                cause,
                turn,
                other,
                terms,
            });
        }
        verdicts.sort_by_key(|v| v.goal.id);
        self.state.agenda = order;
        self.state.decision += 1;
        verdicts
    }

    /// Whether a problem can be stated for this domain: every directive can be achieved from the start.
    ///
    /// # Errors
    /// [`crate::DomainError::Impossible`] naming the facts that no operators bring about.
    pub fn check(&self, domain: &Domain) -> Result<(), crate::DomainError> {
        for directive in &self.directives {
            if domain.expand(domain.initial(), directive.achieves).is_none() {
                let wanted: Vec<&str> = domain.names(directive.achieves).collect();
                return Err(crate::DomainError::Impossible { wanted: wanted.join(", ") });
            }
        }
        Ok(())
    }
}

/// The goals of the longest subsequence common to two orders: those whose turn did not change among the
/// others that stayed.
fn common_order(old: &[GoalId], new: &[GoalId]) -> BTreeSet<GoalId> {
    let mut length = vec![vec![0usize; new.len() + 1]; old.len() + 1];
    for (i, a) in old.iter().enumerate().rev() {
        for (j, b) in new.iter().enumerate().rev() {
            length[i][j] = if a == b {
                length[i + 1][j + 1] + 1
            } else {
                length[i + 1][j].max(length[i][j + 1])
            };
        }
    }
    let (mut i, mut j, mut common) = (0, 0, BTreeSet::new());
    while i < old.len() && j < new.len() {
        if old[i] == new[j] {
            common.insert(old[i]);
            (i, j) = (i + 1, j + 1);
        } else if length[i + 1][j] >= length[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_common_to_two_sequences_is_the_longest() {
        let ids = |list: &[u32]| list.iter().map(|&i| GoalId(i)).collect::<Vec<_>>();
        let common = common_order(&ids(&[1, 2, 3, 4]), &ids(&[2, 3, 1, 4]));
        assert_eq!(common, ids(&[2, 3, 4]).into_iter().collect());
        assert!(common_order(&ids(&[1]), &ids(&[2])).is_empty());
    }
}
