//! The goal manager: goals are born from maxima, keep their name while the map changes, enter and leave the
//! sequence for stated reasons, and are given up when they must be.

use std::collections::{BTreeMap, BTreeSet};

use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use wisdom_grid::{Cell, Raster};
use wisdom_planner::CostVector;

use crate::prize::quantised;
use crate::sequence::{
    Candidate, Effort, GoalSequence, Limits, Problem, Sequences, sequences, weigh,
};
use crate::{
    Action, Cause, Directive, Domain, Extraction, Goal, GoalId, Proof, Reason, Site, Status, Term,
    Verdict,
};

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
    /// Labels that one search may expand.
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
            expansions: 200_000,
            max_reopenings: 1,
        }
    }
}

/// A place where a goal ended, kept so that the same maximum does not come back for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct Retired {
    /// The goal that ended there.
    pub goal: GoalId,
    /// Its target.
    pub target: Cell,
    /// Maxima within this distance are the same place, metres.
    pub radius_m: f64,
    /// Why it ended.
    pub reason: Reason,
    /// Digest of the ground around it when it ended; a change reopens a place given up.
    pub ground: u64,
    /// How often it has been reopened.
    pub reopenings: u32,
    /// Whether it keeps new goals away.
    pub closed: bool,
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
    /// Digest of the ground (what is blocked) around a cell.
    pub ground: &'a dyn Fn(Cell) -> u64,
    /// Whether any reading changed since the last decision.
    pub map_changed: bool,
}

/// Poses of each open goal, each with what it costs to get there.
pub type Poses = BTreeMap<GoalId, Vec<(Cell, CostVector)>>;

/// Which goals are sequenced exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shortlist {
    /// Goals sequenced, best bound first.
    pub kept: Vec<GoalId>,
    /// The others that could be reached, each with the bound that was too low: prize times the reliability of
    /// its safest pose, the most it could add to any sequence on its own.
    pub left_out: Vec<(GoalId, f64)>,
}

/// The sequence chosen and what it was chosen from.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The family, best first; holds the chosen one.
    pub family: Vec<GoalSequence>,
    /// Index of the chosen sequence.
    pub chosen: usize,
    /// What is known of the best sequence.
    pub proof: Proof,
    /// Labels expanded.
    pub expansions: u64,
    /// The committed sequence weighed on today's map, if it can still be carried out.
    pub committed: Option<GoalSequence>,
    /// Whether the committed sequence was kept although another is better, but not by enough.
    pub held: bool,
}

impl Selection {
    /// The chosen sequence.
    #[must_use]
    pub fn sequence(&self) -> &GoalSequence {
        &self.family[self.chosen]
    }
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

    /// First half of a deliberation: ends goals that are done, spent, gone or merged, moves those whose
    /// maximum moved, and formulates new ones.
    pub fn revise(&mut self, survey: &Survey<'_>) -> Revision {
        let mut revision = Revision::default();
        self.apply_events(survey, &mut revision);
        self.reopen(survey);
        let spacing = survey.prize.spec().spacing_m();
        let retired = |site: &Site| {
            self.state
                .retired
                .iter()
                .find(|r| r.closed && r.target.distance(site.peak) * spacing <= r.radius_m)
                .map(|r| r.goal)
        };
        let explained: Vec<Option<GoalId>> = survey.sites.iter().map(retired).collect();
        let matches = self.identify(survey, &explained);
        let open: Vec<GoalId> = self.state.goals.keys().copied().collect();
        for id in open {
            match matches.get(&id) {
                Some(&site) => self.follow(id, &survey.sites[site], survey, &mut revision),
                None => self.survive(id, survey, &matches, &explained, &mut revision),
            }
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
                    goal.attempts += 1;
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

    /// Opens places again whose ground changed after they were given up.
    fn reopen(&mut self, survey: &Survey<'_>) {
        for place in &mut self.state.retired {
            let given_up = matches!(place.reason, Reason::AttemptsSpent | Reason::Unreachable);
            if place.closed
                && given_up
                && place.reopenings < self.spec.max_reopenings
                && (survey.ground)(place.target) != place.ground
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
            if let Some(by) = owner(site) {
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
            self.end(id, Ending::drop(Reason::LostInterest, terms, None), survey, revision);
        }
    }

    fn prize_at(&self, goal: &Goal, survey: &Survey<'_>) -> f64 {
        let weight = self.directives[goal.directive].weight;
        quantised(weight * f64::from(survey.prize[goal.target]))
    }

    /// Reads a goal's numbers off the map, and drops it if its directive no longer accepts them.
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
        let interest = f64::from(survey.interest[site.peak]);
        let credit = (survey.credit)(site.peak);
        let mut best: Option<usize> = None;
        for (index, directive) in self.directives.iter().enumerate() {
            let heavier = best.is_none_or(|b| directive.weight > self.directives[b].weight);
            if heavier && directive.accepts(interest, &credit) {
                best = Some(index);
            }
        }
        let Some(directive) = best else { return };
        let id = GoalId(self.state.next_id);
        self.state.next_id += 1;
        let goal = Goal {
            id,
            directive,
            target: site.peak,
            interest,
            prize: quantised(self.directives[directive].weight * site.prize),
            prominence: site.prominence,
            ignorance: f64::from(survey.ignorance[site.peak]),
            paradox: f64::from(survey.paradox[site.peak]),
            credit,
            region_cells: site.region.len(),
            attempts: 0,
            born: self.state.decision,
            status: Status::Formulated,
        };
        let spacing = survey.prize.spec().spacing_m();
        let reopened = self
            .state
            .retired
            .iter_mut()
            .find(|r| !r.closed && r.target.distance(site.peak) * spacing <= r.radius_m);
        if let Some(place) = reopened {
            // The place is on trial again: from now on this goal answers for it.
            place.reopenings += 1;
            revision.reopened.insert(id);
        }
        revision.born.insert(id);
        self.state.goals.insert(id, goal);
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
        let earlier = self
            .state
            .retired
            .iter()
            .position(|r| !r.closed && r.target.distance(target) * spacing <= r.radius_m);
        let reopenings = earlier.map_or(0, |i| self.state.retired.remove(i).reopenings);
        self.state.retired.push(Retired {
            goal: id,
            target,
            radius_m,
            reason,
            ground: (survey.ground)(target),
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

    /// The goals to be sequenced exactly: the committed ones, then those of highest bound.
    #[must_use]
    pub fn shortlist(&self, poses: &Poses) -> Shortlist {
        let mut bounds: Vec<(GoalId, f64)> = self
            .state
            .goals
            .values()
            .filter_map(|goal| {
                let best = poses.get(&goal.id)?.iter().map(|(_, cost)| cost.reliability());
                let reliability = best.max_by(f64::total_cmp)?;
                Some((goal.id, goal.prize * reliability))
            })
            .collect();
        bounds.sort_by(|a, b| {
            let committed = |id: &GoalId| self.state.agenda.contains(id);
            committed(&b.0).cmp(&committed(&a.0)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0))
        });
        let left_out = bounds.split_off(bounds.len().min(self.spec.max_sequenced));
        Shortlist { kept: bounds.into_iter().map(|(id, _)| id).collect(), left_out }
    }

    /// The shortlisted goals as the search wants them; `nodes` gives the matrix nodes of each goal's poses.
    #[must_use]
    pub fn candidates(
        &self,
        shortlist: &Shortlist,
        nodes: &BTreeMap<GoalId, Vec<usize>>,
    ) -> Vec<Candidate> {
        shortlist
            .kept
            .iter()
            .map(|id| {
                let goal = &self.state.goals[id];
                Candidate {
                    goal: *id,
                    directive: goal.directive,
                    prize: goal.prize,
                    poses: nodes.get(id).cloned().unwrap_or_default(),
                }
            })
            .collect()
    }

    /// Chooses a sequence: the best, unless the committed one is nearly as good.
    ///
    /// `pinned` is the goal of the leg under way (the commit window): it stays first if it can.
    #[must_use]
    pub fn select(&self, problem: &Problem<'_>, pinned: Option<GoalId>) -> Selection {
        let pin: Vec<GoalId> = pinned.into_iter().collect();
        let effort =
            Effort { expansions: self.spec.expansions, keep: self.spec.family, first: &pin };
        let mut found = sequences(problem, effort);
        if !pin.is_empty() && found.best[0].stops.is_empty() {
            found = sequences(problem, Effort { first: &[], ..effort });
        }
        let Sequences { best: mut family, proof, expansions } = found;
        let known = |id: &GoalId| problem.candidates.iter().any(|c| c.goal == *id);
        let order: Vec<GoalId> = self.state.agenda.iter().copied().filter(known).collect();
        let committed = if order.is_empty() { None } else { weigh(problem, &order) };
        let mut chosen = 0;
        let mut held = false;
        if let Some(committed) = &committed {
            let best = &family[0];
            let factor = 1.0 + self.spec.hysteresis;
            let better_value =
                best.value >= factor * committed.value && best.value > committed.value;
            let safer = best.value == committed.value
                && best.reliability >= factor * committed.reliability
                && best.reliability > committed.reliability;
            let same = best.goals().eq(committed.goals());
            if !same && !better_value && !safer {
                held = true;
                let known = family.iter().position(|s| s.goals().eq(committed.goals()));
                chosen = known.unwrap_or_else(|| {
                    family.push(committed.clone());
                    family.len() - 1
                });
            }
        }
        Selection { family, chosen, proof, expansions, committed, held }
    }

    /// Second half of a deliberation: commits to the chosen sequence and says of every goal what was done.
    pub fn commit(
        &mut self,
        revision: Revision,
        selection: &Selection,
        shortlist: &Shortlist,
        poses: &Poses,
        problem: &Problem<'_>,
        map_changed: bool,
    ) -> Vec<Verdict> {
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
            } else {
                let (reason, terms) = self.why_not(goal, selection, shortlist, poses, problem);
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
                other: None,
                terms,
            });
        }
        verdicts.sort_by_key(|v| v.goal.id);
        self.state.agenda = order;
        self.state.decision += 1;
        verdicts
    }

    /// The first constraint that keeps a goal out of the sequence, with the numbers compared.
    fn why_not(
        &self,
        goal: &Goal,
        selection: &Selection,
        shortlist: &Shortlist,
        poses: &Poses,
        problem: &Problem<'_>,
    ) -> (Reason, Vec<Term>) {
        let Some((_, way)) = poses.get(&goal.id).and_then(|p| p.first()) else {
            return (Reason::Unreachable, vec![Term::against("poses", 0.0, 1.0)]);
        };
        let directive = &self.directives[goal.directive];
        let ready = problem.facts.contains(directive.requires);
        let Some(service) =
            ready.then(|| problem.domain.expand(problem.facts, directive.achieves)).flatten()
        else {
            return (Reason::Preconditions, Vec::new());
        };
        let alone = Limits {
            time_s: way.time_s + service.cost.time_s,
            energy_j: way.energy_j + service.cost.energy_j,
            data_mb: service.cost.data_mb,
            min_reliability: way.reliability(),
        };
        if let Some((reason, term)) = first_violation(&alone, &problem.limits) {
            return (reason, vec![term]);
        }
        if let Some((_, bound)) = shortlist.left_out.iter().find(|(id, _)| *id == goal.id) {
            let last = shortlist.kept.last().map_or(0.0, |id| self.state.goals[id].prize);
            return (Reason::BeyondExact, vec![Term::against("bound", *bound, last)]);
        }
        // Every turn it could take in the chosen sequence: the best value if one is within the limits, or
        // the smallest overrun.
        let chosen = selection.sequence();
        let order: Vec<GoalId> = chosen.goals().collect();
        let boundless = Limits {
            time_s: f64::INFINITY,
            energy_j: f64::INFINITY,
            data_mb: f64::INFINITY,
            min_reliability: 0.0,
        };
        let free = Problem { limits: boundless, ..*problem };
        let mut best_within: Option<f64> = None;
        let mut least_over: Option<(Reason, Term, f64)> = None;
        for turn in 0..=order.len() {
            let mut with = order.clone();
            with.insert(turn, goal.id);
            if let Some(within) = weigh(problem, &with) {
                best_within = Some(best_within.map_or(within.value, |b| b.max(within.value)));
            } else if let Some(over) = weigh(&free, &with) {
                let needs = Limits {
                    time_s: over.time_s,
                    energy_j: over.energy_j,
                    data_mb: over.data_mb,
                    min_reliability: over.reliability,
                };
                if let Some((reason, term)) = first_violation(&needs, &problem.limits) {
                    let limit = term.limit.unwrap_or(1.0);
                    let excess = (term.value - limit).abs() / limit.abs().max(f64::MIN_POSITIVE);
                    if least_over.as_ref().is_none_or(|(_, _, least)| excess < *least) {
                        least_over = Some((reason, term, excess));
                    }
                }
            }
        }
        match (best_within, least_over) {
            (Some(value), _) => {
                (Reason::Outweighed, vec![Term::against("value with it", value, chosen.value)])
            }
            (None, Some((reason, term, _))) => (reason, vec![term]),
            (None, None) => (Reason::Outweighed, vec![Term::of("prize", goal.prize)]),
        }
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

/// The first limit that some needs exceed, in the order time, energy, data, risk.
fn first_violation(needs: &Limits, limits: &Limits) -> Option<(Reason, Term)> {
    if needs.time_s > limits.time_s {
        return Some((Reason::Time, Term::against("time_s", needs.time_s, limits.time_s)));
    }
    if needs.energy_j > limits.energy_j {
        return Some((Reason::Energy, Term::against("energy_j", needs.energy_j, limits.energy_j)));
    }
    if needs.data_mb > limits.data_mb {
        return Some((Reason::Data, Term::against("data_mb", needs.data_mb, limits.data_mb)));
    }
    (needs.min_reliability < limits.min_reliability).then(|| {
        (Reason::Risk, Term::against("reliability", needs.min_reliability, limits.min_reliability))
    })
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
