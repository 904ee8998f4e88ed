//! First half of a deliberation: goals that are done, spent, gone or merged end, those whose place or purpose changed are
//! transformed, and new ones are formulated.

use std::collections::BTreeMap;

use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;
use wisdom_grid::{Cell, Window};

use super::{
    Command, Event, GROUND_UNSEEN, GoalManager, Retired, Revision, Survey, Tries, View, Wish,
};
use crate::lifecycle::{
    Committed, Diary, Dispatched, Dropped, Evaluated, Expanded, Finished, Found, In, Life, Outcome,
    Selected,
};
use crate::prize::quantised;
use crate::{
    Action, Cause, Change, Directive, Goal, GoalId, Kind, Order, Reason, Site, Term, Verdict,
};

/// A contradiction is settled once the uncertainty of the readings behind it has fallen to this share of what it was.
const SETTLED_SHARE: f64 = 0.5;

/// How a goal leaves the open ones.
pub(super) struct Ending {
    action: Action,
    reason: Reason,
    other: Option<GoalId>,
    terms: Vec<Term>,
}

impl Ending {
    pub(super) fn drop(reason: Reason, terms: Vec<Term>, other: Option<GoalId>) -> Self {
        Self { action: Action::Drop, reason, other, terms }
    }
}

/// The maxima of one kind, those that an ended goal stands for, and those that an open goal has.
struct Scene<'a> {
    kind: Kind,
    view: View<'a>,
    explained: Vec<Option<GoalId>>,
    matches: BTreeMap<GoalId, usize>,
    /// By maximum: whether an open goal has it.
    taken: Vec<bool>,
}

impl Scene<'_> {
    fn owner(&self, site: usize) -> Option<GoalId> {
        self.matches.iter().find(|&(_, &s)| s == site).map(|(goal, _)| *goal)
    }

    /// Maxima that nobody has and nothing explains.
    fn free(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.taken.len()).filter(|&s| !self.taken[s] && self.explained[s].is_none())
    }
}

impl GoalManager {
    /// The ended goal that stands for this maximum of a kind, if it shall bring forth no goal, and no open goal answers for
    /// the place: the maximum lies within the radius of a closed place, or its region holds the target of one: of one
    /// that was given up wherever it is, of one that was done if it is not far, for what was done at one end of a plateau
    /// says little of the other.
    ///
    /// An expert that had said nothing of a place when a goal was done there brings news: `speaks` tells the interest and the
    /// experts' shares of a cell now.
    #[must_use]
    pub fn explained_by(
        &self,
        site: &Site,
        kind: Kind,
        spacing_m: f64,
        speaks: &dyn Fn(Cell) -> (f64, Vec<f64>),
    ) -> Option<GoalId> {
        let same_place = |r: &&Retired| {
            let distance_m = r.target.distance(site.peak) * spacing_m;
            let near_m = 2.0 * r.radius_m.max(self.spec.identity_radius_m);
            distance_m <= r.radius_m
                || (site.region.binary_search(&r.target).is_ok()
                    && (r.is_given_up() || distance_m <= near_m))
        };
        self.in_force(kind)
            .find(|r| same_place(r) && !self.brings_news(r, site.peak, kind, speaks))
            .map(|r| r.goal)
    }

    /// Places that keep goals of a kind away.
    fn in_force(&self, kind: Kind) -> impl Iterator<Item = &Retired> {
        self.state.retired.iter().filter(move |r| {
            // An open goal answers for a place that was opened again; one that left a place for another of its kind does
            // not.
            let answered = r.reopenings > 0 && self.state.goals.contains_key(&r.goal);
            r.closed && r.kind.closes(kind) && !answered
        })
    }

    /// Whether a directive looks for what experts say of a cell now that had said nothing when a goal was done there.
    fn brings_news(
        &self,
        place: &Retired,
        cell: Cell,
        kind: Kind,
        speaks: &dyn Fn(Cell) -> (f64, Vec<f64>),
    ) -> bool {
        let new = |expert: &&usize| place.heard >> (**expert).min(63) & 1 == 0;
        let hopeful = |d: &&Directive| d.kind == kind && d.experts.iter().any(|e| new(&e));
        let mut hopeful = self.directives.iter().filter(hopeful).peekable();
        if place.is_given_up() || hopeful.peek().is_none() {
            return false;
        }
        let (interest, credit) = speaks(cell);
        hopeful.any(|directive| {
            let news = directive.experts.iter().filter(new);
            let share: f64 = news.filter_map(|&expert| credit.get(expert)).sum();
            interest >= directive.min_interest && share > 0.0 && share >= directive.min_credit
        })
    }

    /// First half of a deliberation: ends goals that are done, spent, gone or merged, transforms those whose place or
    /// purpose changed, and formulates new ones.
    pub fn revise(&mut self, survey: &Survey<'_>) -> Revision {
        let mut revision = Revision::default();
        self.evaluate(&mut revision);
        self.apply_events(survey, &mut revision);
        self.let_go_off_map(survey, &mut revision);
        self.let_go_too_late(survey, &mut revision);
        self.obey(survey, &mut revision);
        self.fall_back(survey, &mut revision);
        self.reopen(survey);
        revision.before = self.state.goals.values().map(|g| (g.id, g.extent)).collect();
        self.see(survey, &mut revision);
        revision
    }

    /// Looks after the goals that are there until nothing ends any more, and formulates those that are not.
    pub(super) fn see(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        let scenes = loop {
            let mut scenes: Vec<Scene<'_>> =
                Kind::ALL.iter().filter_map(|&kind| self.scene(kind, survey)).collect();
            let ended = revision.ended.len();
            self.look_after(survey, &mut scenes, revision);
            // What a goal that ended stood for, or kept away, is seen anew.
            if revision.ended.len() == ended {
                break scenes;
            }
        };
        for scene in &scenes {
            for index in scene.free() {
                let site = &scene.view.sites[index];
                if site.prominence >= self.spec.extraction.min_prominence {
                    self.formulate(site, scene, survey, revision);
                }
            }
        }
    }

    /// Follows the goals whose maxima are there, and sees what becomes of the others.
    fn look_after(
        &mut self,
        survey: &Survey<'_>,
        scenes: &mut [Scene<'_>],
        revision: &mut Revision,
    ) {
        let open: Vec<GoalId> = self.state.goals.keys().copied().collect();
        let seen: BTreeMap<GoalId, (usize, usize)> = scenes
            .iter()
            .enumerate()
            .flat_map(|(s, scene)| scene.matches.iter().map(move |(g, site)| (*g, (s, *site))))
            .collect();
        let (followed, lost): (Vec<GoalId>, Vec<GoalId>) =
            open.into_iter().partition(|id| seen.contains_key(id));
        for id in followed {
            let (scene, site) = seen[&id];
            self.follow(id, &scenes[scene].view.sites[site], survey, revision);
        }
        // Afterwards, so that no goal is merged into one that just went.
        for id in lost {
            self.survive(id, survey, scenes, revision);
        }
    }

    /// What was under way is looked at: it came back, however it went.
    fn evaluate(&mut self, revision: &mut Revision) {
        for goal in self.state.goals.values_mut() {
            let Found::Dispatched(at) = goal.life.found() else { continue };
            let events = &self.state.events;
            let reason = match events.iter().rev().find(|(id, _)| *id == goal.id) {
                Some((_, Event::Achieved)) => Reason::Done,
                Some((_, Event::Failed)) => Reason::Failed,
                None => Reason::Interrupted,
            };
            goal.life = at.then::<Evaluated>(reason, revision.diary(goal.id)).life();
        }
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
                    let done = Ending::drop(Reason::Done, terms, None);
                    self.end(id, Ending { action: Action::Achieve, ..done }, survey, revision);
                    self.retire(id, radius_m, Reason::Done, survey, revision);
                }
                Event::Failed => {
                    let target = goal.target;
                    let here = self.failed_at(target, survey) + 1;
                    self.remember_failure(target, survey);
                    let goal = self.state.goals.get_mut(&id).expect("the goal is open");
                    goal.attempts = here.max(goal.attempts + 1);
                    let directive = &self.directives[goal.directive];
                    let (tried, most) = (goal.attempts, directive.max_attempts);
                    let tries = Term::against("attempts", f64::from(tried), f64::from(most));
                    if tried >= most {
                        let radius_m = self.spec.identity_radius_m;
                        let spent = Ending::drop(Reason::AttemptsSpent, vec![tries], None);
                        self.end(id, spent, survey, revision);
                        self.retire(id, radius_m, Reason::AttemptsSpent, survey, revision);
                        continue;
                    }
                    revision.failed.insert(id);
                    if let Some(weaker) = directive.substitute {
                        goal.directive = weaker;
                        revision.change(id, Change::new(Reason::Eroded, vec![tries]));
                    }
                }
            }
        }
    }

    /// Ends goals whose targets lie beyond the planes of the survey: the working map moved on with the rover.
    /// Their places are not closed; whoever comes back finds them again.
    fn let_go_off_map(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        let map = survey.grid();
        let off = |goal: &&Goal| !map.contains(goal.target);
        let lost: Vec<(GoalId, Cell)> =
            self.state.goals.values().filter(off).map(|g| (g.id, g.target)).collect();
        for (id, target) in lost {
            let distance_m = survey.stand.distance(target) * map.spacing_m();
            let terms = vec![Term::of("distance_m", distance_m)];
            let goal = &self.state.goals[&id];
            if let Some(Order { name, prize, mandatory, .. }) = goal.order.clone() {
                let directive = goal.directive;
                let wish = Wish::Pursue { directive, target, prize, mandatory };
                self.state.commands.push(Command { name, wish });
            }
            self.end(id, Ending::drop(Reason::OffMap, terms, None), survey, revision);
        }
    }

    /// Ends goals whose window has closed.
    fn let_go_too_late(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        let close = |goal: &Goal| self.directives[goal.directive].window.map(|w| w.close_s);
        let late: Vec<(GoalId, f64)> = self
            .state
            .goals
            .values()
            .filter_map(|goal| Some((goal.id, close(goal)?)))
            .filter(|&(_, close_s)| survey.time_s > close_s)
            .collect();
        for (id, close_s) in late {
            let terms = vec![Term::against("time_s", survey.time_s, close_s)];
            self.end(id, Ending::drop(Reason::Window, terms, None), survey, revision);
        }
    }

    /// Goals whose directive nothing can bring about any more follow the first of its substitutes that still can be.
    fn fall_back(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        let able: Vec<bool> = (0..self.directives.len()).map(survey.able).collect();
        for goal in self.state.goals.values_mut().filter(|goal| !able[goal.directive]) {
            let mut weaker = self.directives[goal.directive].substitute;
            // Substitutes may go round in a circle.
            for _ in 0..self.directives.len() {
                let Some(at) = weaker.filter(|&at| !able[at]) else { break };
                weaker = self.directives[at].substitute;
            }
            if let Some(weaker) = weaker.filter(|&at| able[at]) {
                goal.directive = weaker;
                let terms = vec![Term::against("directives able", 0.0, 1.0)];
                revision.change(goal.id, Change::new(Reason::Fault, terms));
            }
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

    pub(super) fn same_place(&self, a: Cell, b: Cell, survey: &Survey<'_>) -> bool {
        a.distance(b) * survey.spacing_m() <= self.spec.identity_radius_m
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

    /// The maxima of a kind and whose they are.
    fn scene<'a>(&self, kind: Kind, survey: &Survey<'a>) -> Option<Scene<'a>> {
        let view = survey.view(kind)?;
        let spacing_m = survey.spacing_m();
        let speaks = |cell: Cell| (f64::from(view.interest[cell]), (survey.credit)(cell));
        let explained: Vec<Option<GoalId>> = view
            .sites
            .iter()
            .map(|site| self.explained_by(site, kind, spacing_m, &speaks))
            .collect();
        let matches = self.identify(kind, view, &explained, spacing_m);
        let mut taken = vec![false; view.sites.len()];
        for &site in matches.values() {
            taken[site] = true;
        }
        Some(Scene { kind, view, explained, matches, taken })
    }

    /// Assigns maxima to known goals of a kind: the assignment of least total distance within the identity radius
    /// (Kuhn-Munkres), a maximum whose region holds the goal's target before one that is merely near.
    fn identify(
        &self,
        kind: Kind,
        view: View<'_>,
        explained: &[Option<GoalId>],
        spacing_m: f64,
    ) -> BTreeMap<GoalId, usize> {
        const NEAR_MM: i64 = 1_000_000;
        let goals: Vec<&Goal> = self
            .state
            .goals
            .values()
            .filter(|g| self.directives[g.directive].kind == kind)
            .collect();
        let weight = |goal: &Goal, site: usize| -> i64 {
            if explained[site].is_some() {
                return 0;
            }
            let found = &view.sites[site];
            let distance_m = goal.target.distance(found.peak) * spacing_m;
            let overlaps = found.region.binary_search(&goal.target).is_ok();
            if distance_m > self.spec.identity_radius_m && !overlaps {
                return 0;
            }
            let near = (NEAR_MM - (distance_m * 1000.0) as i64).max(1);
            if overlaps { near + NEAR_MM } else { near }
        };
        if goals.is_empty() || view.sites.is_empty() {
            return BTreeMap::new();
        }
        let columns = view.sites.len().max(goals.len());
        let weights = Matrix::from_fn(goals.len(), columns, |(g, s)| {
            if s < view.sites.len() { weight(goals[g], s) } else { 0 }
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
        let goal = self.state.goals.get_mut(&id).expect("the goal is open");
        let kind = self.directives[goal.directive].kind;
        let Some(view) = survey.view(kind) else { return };
        let here = f64::from(view.signal[goal.target]);
        // The old cell is as good while it lies within half the least prominence of the peak: noise in the
        // readings must not push targets around. What the ground named stays where it is.
        let moved =
            goal.order.is_none() && here < site.prize - self.spec.extraction.min_prominence / 2.0;
        if moved {
            let distance_m = goal.target.distance(site.peak) * survey.spacing_m();
            let terms = vec![
                Term::against("prize at the old target", here, site.prize),
                Term::of("moved_m", distance_m),
            ];
            revision.change(id, Change::new(Reason::PeakMoved, terms));
            goal.target = site.peak;
            goal.pose = None;
        }
        goal.prominence = site.prominence;
        goal.region_cells = site.region.len();
        goal.extent = extent(site);
        if self.weigh_anew(id, survey, revision) && !self.settle(id, survey, revision) {
            self.reclassify(id, survey, revision);
            self.refine(id, survey, revision);
        }
    }

    /// Gives a goal that was never tried the directive that a new goal in its place would have, if that is a heavier one: more
    /// is known of it now than when it was formulated. What it was eroded from stays behind.
    fn refine(&mut self, id: GoalId, survey: &Survey<'_>, revision: &mut Revision) {
        let Some(goal) = self.state.goals.get(&id) else { return };
        let (current, target) = (goal.directive, goal.target);
        if goal.attempts > 0 || goal.order.is_some() {
            return;
        }
        let Some(best) = self.directive_for(self.directives[current].kind, target, survey) else {
            return;
        };
        let (weight, was) = (self.directives[best].weight, self.directives[current].weight);
        if weight <= was || !(survey.able)(best) || self.erodes_to(best, current) {
            return;
        }
        self.state.goals.get_mut(&id).expect("the goal is open").directive = best;
        let terms = vec![Term::against("weight", weight, was)];
        revision.change(id, Change::new(Reason::Refined, terms));
        self.weigh_anew(id, survey, revision);
    }

    /// Whether a directive is among the substitutes of another.
    fn erodes_to(&self, strong: usize, weak: usize) -> bool {
        let mut at = self.directives[strong].substitute;
        // Substitutes may go round in a circle.
        for _ in 0..self.directives.len() {
            let Some(index) = at else { return false };
            if index == weak {
                return true;
            }
            at = self.directives[index].substitute;
        }
        false
    }

    /// A goal without a maximum: what stands out there may be something else now, or it is merged into another, kept
    /// while it is committed and still worth half its prize, or gone.
    fn survive(
        &mut self,
        id: GoalId,
        survey: &Survey<'_>,
        scenes: &mut [Scene<'_>],
        revision: &mut Revision,
    ) {
        let goal = &self.state.goals[&id];
        let kind = self.directives[goal.directive].kind;
        if goal.order.is_some() {
            self.weigh_anew(id, survey, revision);
            return;
        }
        let spacing = survey.spacing_m();
        let radius_m = self.spec.identity_radius_m;
        let near = |site: &Site| {
            site.region.binary_search(&goal.target).is_ok()
                || site.peak.distance(goal.target) * spacing <= radius_m
        };
        let here = survey.view(kind).map_or(0.0, |view| f64::from(view.signal[goal.target]));
        if let Some(scene) = scenes.iter().find(|scene| scene.kind == kind)
            && let Some(site) = scene.view.sites.iter().position(near)
        {
            let terms = vec![Term::against("prize", here, scene.view.sites[site].prize)];
            if let Some(by) = scene.explained[site] {
                self.end(id, Ending::drop(Reason::Explained, terms, Some(by)), survey, revision);
                return;
            }
            let open = |by: &GoalId| self.state.goals.contains_key(by);
            if let Some(by) = scene.owner(site).filter(open) {
                self.end(id, Ending::drop(Reason::Merged, terms, Some(by)), survey, revision);
                return;
            }
        }
        if self.retype(id, survey, scenes, revision) {
            return;
        }
        let goal = &self.state.goals[&id];
        let (prize, floor) = (self.prize_at(goal, survey), goal.prize / 2.0);
        if goal.status().is_committed() && prize >= floor && prize > 0.0 {
            if self.weigh_anew(id, survey, revision) && !self.settle(id, survey, revision) {
                self.reclassify(id, survey, revision);
            }
            return;
        }
        let interest = f64::from(survey.inspect.interest[goal.target]);
        let doubt = (survey.doubt)(goal.target);
        let mut terms = vec![
            Term::against("prize", prize, floor),
            Term::against("interest", interest, goal.interest),
        ];
        let reason = if kind == Kind::Adjudicate && prize < floor && doubt < goal.doubt {
            terms.push(Term::against("uncertainty", doubt, goal.doubt));
            Reason::Settled
        } else if prize < floor {
            Reason::LostInterest
        } else {
            Reason::NoMaximum
        };
        self.end(id, Ending::drop(reason, terms, None), survey, revision);
    }

    /// Gives a goal whose maximum is gone a directive of another kind, if a maximum of that kind stands where it was. Says
    /// whether it did.
    fn retype(
        &mut self,
        id: GoalId,
        survey: &Survey<'_>,
        scenes: &mut [Scene<'_>],
        revision: &mut Revision,
    ) -> bool {
        let goal = &self.state.goals[&id];
        let was = self.directives[goal.directive].kind;
        let spacing = survey.spacing_m();
        let before = self.prize_at(goal, survey);
        for scene in scenes.iter_mut().filter(|scene| scene.kind != was) {
            let near = |&site: &usize| {
                let site = &scene.view.sites[site];
                site.prominence >= self.spec.extraction.min_prominence
                    && (site.region.binary_search(&goal.target).is_ok()
                        || site.peak.distance(goal.target) * spacing <= self.spec.identity_radius_m)
            };
            let Some(index) = scene.free().find(near) else { continue };
            let site = &scene.view.sites[index];
            let Some(directive) = self.directive_for(scene.kind, site.peak, survey) else {
                continue;
            };
            scene.taken[index] = true;
            scene.matches.insert(id, index);
            let terms = vec![
                Term::against(
                    "prize",
                    quantised(self.directives[directive].weight * site.prize),
                    before,
                ),
                Term::of("ignorance", f64::from(survey.ignorance[site.peak])),
                Term::of("contradiction", f64::from(survey.contradiction[site.peak])),
            ];
            let goal = self.state.goals.get_mut(&id).expect("the goal is open");
            goal.directive = directive;
            goal.target = site.peak;
            goal.pose = None;
            goal.prominence = site.prominence;
            goal.region_cells = site.region.len();
            goal.extent = extent(site);
            goal.doubt = (survey.doubt)(site.peak);
            revision.change(id, Change::new(Reason::Retyped, terms));
            self.weigh_anew(id, survey, revision);
            return true;
        }
        false
    }

    /// Ends an adjudication whose readings have become much surer: whatever the experts say now, they have seen it. Says
    /// whether it did.
    fn settle(&mut self, id: GoalId, survey: &Survey<'_>, revision: &mut Revision) -> bool {
        let goal = &self.state.goals[&id];
        if self.directives[goal.directive].kind != Kind::Adjudicate || goal.order.is_some() {
            return false;
        }
        let (doubt, limit) = ((survey.doubt)(goal.target), SETTLED_SHARE * goal.doubt);
        let settled = doubt < limit;
        if settled {
            let terms = vec![
                Term::against("uncertainty", doubt, limit),
                Term::of("contradiction", goal.contradiction),
            ];
            self.end(id, Ending::drop(Reason::Settled, terms, None), survey, revision);
            self.retire(id, self.spec.identity_radius_m, Reason::Settled, survey, revision);
        }
        settled
    }

    /// The type of the object at a cell, as far as its class is clear.
    pub(super) fn type_at(&self, cell: Cell, survey: &Survey<'_>) -> Option<usize> {
        let (class, u) = (survey.class)(cell)?;
        self.spec.taxonomy.type_of(class, u, self.spec.clear_below)
    }

    /// Whether a directive is for objects like the one at a cell.
    pub(super) fn suits(&self, directive: usize, object: Option<usize>) -> bool {
        match (self.directives[directive].object, object) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(wanted), Some(object)) => self.spec.taxonomy.is_of(object, wanted),
        }
    }

    /// Moves a goal up or down the tree of types as its object's class becomes unclear or clear.
    fn reclassify(&mut self, id: GoalId, survey: &Survey<'_>, revision: &mut Revision) {
        let goal = &self.state.goals[&id];
        if goal.order.is_some() || !self.directives.iter().any(|d| d.object.is_some()) {
            return;
        }
        let current = &self.directives[goal.directive];
        let object = self.type_at(goal.target, survey);
        let suits = self.suits(goal.directive, object);
        let best = self.directive_for(current.kind, goal.target, survey);
        let narrower = |new: usize| match (self.directives[new].object, current.object) {
            (Some(_), None) => true,
            (Some(new), Some(old)) => new != old && self.spec.taxonomy.is_of(new, old),
            (None, _) => false,
        };
        let u = (survey.class)(goal.target).map_or(1.0, |(_, u)| u);
        let terms = vec![Term::against("class uncertainty", u, self.spec.clear_below)];
        match best {
            // A goal that failed, or was eroded, keeps its weaker directive.
            Some(new)
                if suits
                    && narrower(new)
                    && (goal.attempts > 0 || self.erodes_to(new, goal.directive)) => {}
            Some(new) if suits && narrower(new) => {
                self.state.goals.get_mut(&id).expect("the goal is open").directive = new;
                revision.change(id, Change::new(Reason::Concretised, terms));
                self.weigh_anew(id, survey, revision);
            }
            _ if suits => {}
            Some(new) => {
                let clear = u < self.spec.clear_below && self.directives[new].object.is_some();
                self.state.goals.get_mut(&id).expect("the goal is open").directive = new;
                revision.change(id, Change::new(Reason::Abstracted, terms.clone()));
                if clear {
                    // Up to what both types are of, and down again to the one it turned out to be.
                    revision.change(id, Change::new(Reason::Concretised, terms));
                }
                self.weigh_anew(id, survey, revision);
            }
            None => self.end(id, Ending::drop(Reason::LostInterest, terms, None), survey, revision),
        }
    }

    /// What a goal is worth on the map: its directive's weight times what that looks for; a command's own prize.
    fn prize_at(&self, goal: &Goal, survey: &Survey<'_>) -> f64 {
        if let Some(order) = &goal.order {
            return order.prize;
        }
        let directive = &self.directives[goal.directive];
        let signal = survey.view(directive.kind).map_or(0.0, |v| f64::from(v.signal[goal.target]));
        quantised(directive.weight * signal)
    }

    /// Reads a goal's numbers off the map, and drops it if its interest is below what its directive asks or
    /// its prize is gone; says whether it stays. (Credit chose the directive when the goal was born; it does not end a
    /// goal.)
    pub(super) fn weigh_anew(
        &mut self,
        id: GoalId,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) -> bool {
        let prize = self.prize_at(&self.state.goals[&id], survey);
        let goal = self.state.goals.get_mut(&id).expect("the goal is open");
        let before = goal.interest;
        goal.interest = f64::from(survey.inspect.interest[goal.target]);
        goal.ignorance = f64::from(survey.ignorance[goal.target]);
        goal.paradox = f64::from(survey.paradox[goal.target]);
        goal.contradiction = f64::from(survey.contradiction[goal.target]);
        goal.credit = (survey.credit)(goal.target);
        goal.prize = prize;
        let directive = &self.directives[goal.directive];
        let view = survey.view(directive.kind);
        let asked = view.map_or(0.0, |view| f64::from(view.interest[goal.target]));
        let least = directive.min_interest;
        let signal = prize / directive.weight;
        let stays = goal.order.is_some()
            || (asked >= least && signal >= directive.min_signal && prize > 0.0);
        if !stays {
            let terms = vec![
                Term::against("interest", asked, least),
                Term::of("interest before", before),
                Term::of("prize", prize),
            ];
            self.end(id, Ending::drop(Reason::LostInterest, terms, None), survey, revision);
        }
        stays
    }

    /// The directive of a kind that looks for such a place (the heaviest; ties by order in the pool), of those that can
    /// still be carried out if there is one.
    fn directive_for(&self, kind: Kind, target: Cell, survey: &Survey<'_>) -> Option<usize> {
        let view = survey.view(kind)?;
        let (asked, signal) = (f64::from(view.interest[target]), f64::from(view.signal[target]));
        let credit = (survey.credit)(target);
        let object = self.type_at(target, survey);
        let mut best: Option<(bool, usize)> = None;
        for (index, directive) in self.directives.iter().enumerate() {
            let fits = directive.kind == kind
                && directive.accepts(asked, &credit)
                && signal >= directive.min_signal
                && directive.window.is_none_or(|w| survey.time_s <= w.close_s)
                && self.suits(index, object);
            let able = (survey.able)(index);
            let better = best.is_none_or(|(was_able, b)| {
                (able, directive.weight) > (was_able, self.directives[b].weight)
            });
            if fits && better {
                best = Some((able, index));
            }
        }
        best.map(|(_, index)| index)
    }

    /// A new goal, if some directive looks for such a site.
    fn formulate(
        &mut self,
        site: &Site,
        scene: &Scene<'_>,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) {
        // Of the cells that share the highest prize, the one nearest to the rover: it is on the side that can
        // be seen and reached, where the middle of a plateau may lie inside a rock.
        let on_top = |c: &&Cell| f64::from(scene.view.signal[**c]) >= site.prize;
        // Ground that was done already is no target, though the maximum reaches further.
        let spacing = survey.spacing_m();
        let closed: Vec<&Retired> = self.in_force(scene.kind).collect();
        let open = |c: &&Cell| closed.iter().all(|r| r.target.distance(**c) * spacing > r.radius_m);
        let nearest = site.region.iter().filter(on_top).filter(open).min_by(|a, b| {
            a.distance(survey.stand).total_cmp(&b.distance(survey.stand)).then(a.cmp(b))
        });
        let target = nearest.copied().unwrap_or(site.peak);
        let Some(directive) = self.directive_for(scene.kind, target, survey) else { return };
        let prize = quantised(self.directives[directive].weight * site.prize);
        if prize <= 0.0 {
            return;
        }
        let id = GoalId(self.state.next_id);
        self.state.next_id += 1;
        let news = self
            .in_force(scene.kind)
            .any(|r| !r.is_given_up() && r.target.distance(site.peak) * spacing <= r.radius_m);
        let reopened = self.answer_for_reopened(id, scene.kind, site, survey);
        // An open goal of the kind whose region held this peak when it was last seen.
        let parent = self.state.goals.values().find(|goal| {
            self.directives[goal.directive].kind == scene.kind
                && goal.order.is_none()
                && revision.before.get(&goal.id).is_some_and(|was| was.contains(site.peak))
        });
        // Or a goal that was done elsewhere on the same plateau.
        let done = |r: &&Retired| !r.is_given_up() && site.region.binary_search(&r.target).is_ok();
        let parent = parent
            .map(|goal| goal.id)
            .or_else(|| self.in_force(scene.kind).find(done).map(|r| r.goal));
        // What failed here before counts; one try remains.
        let most = self.directives[directive].max_attempts.saturating_sub(1);
        let attempts = self.failed_at(site.peak, survey).min(most);
        let goal = Goal {
            id,
            directive,
            target,
            interest: f64::from(survey.inspect.interest[target]),
            prize,
            prominence: site.prominence,
            ignorance: f64::from(survey.ignorance[target]),
            paradox: f64::from(survey.paradox[target]),
            contradiction: f64::from(survey.contradiction[target]),
            credit: (survey.credit)(target),
            region_cells: site.region.len(),
            extent: extent(site),
            doubt: (survey.doubt)(target),
            attempts,
            born: self.state.decision,
            parent,
            order: None,
            pose: None,
            operators: Vec::new(),
            life: Life::BORN,
        };
        let reason = if reopened {
            Reason::Reopened
        } else if news {
            Reason::NewEvidence
        } else if parent.is_some() {
            Reason::Split
        } else {
            Reason::NewMaximum
        };
        let terms = vec![
            Term::of("prize", prize),
            Term::against("prominence", site.prominence, self.spec.extraction.min_prominence),
        ];
        revision.change(id, Change { other: parent, ..Change::new(reason, terms) });
        revision.born.insert(id);
        self.state.goals.insert(id, goal);
    }

    /// Puts reopened places around a site on trial: the new goal answers for them, and when it ends, however
    /// it does, they are closed again. Says whether there are any.
    fn answer_for_reopened(
        &mut self,
        id: GoalId,
        kind: Kind,
        site: &Site,
        survey: &Survey<'_>,
    ) -> bool {
        let spacing = survey.spacing_m();
        let mut targets = Vec::new();
        for place in self.state.retired.iter_mut().filter(|r| !r.closed && r.kind.closes(kind)) {
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
    pub(super) fn end(
        &mut self,
        id: GoalId,
        ending: Ending,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) {
        let Ending { action, reason, other, terms } = ending;
        let Some(mut goal) = self.state.goals.remove(&id) else { return };
        let changes = revision.changes.remove(&id).unwrap_or_default();
        if revision.born.remove(&id) {
            // Formulated and refused in the same breath: nothing was ever promised.
            revision.diaries.remove(&id);
            return;
        }
        let diary = revision.diary(id);
        goal.life = if action == Action::Achieve {
            evaluated(goal.life, reason, diary).map_or(goal.life, |at| {
                at.judged::<Finished>(Outcome::Finish, reason, diary).life()
            })
        } else {
            match goal.life.found() {
                Found::Formulated(at) => at.then::<Dropped>(reason, diary).life(),
                Found::Committed(at) => at.then::<Dropped>(reason, diary).life(),
                Found::Evaluated(at) => at.judged::<Dropped>(Outcome::Drop, reason, diary).life(),
                // Goals do not rest in the other phases while a deliberation goes on.
                _ => goal.life,
            }
        };
        let by_execution = matches!(
            reason,
            Reason::Done | Reason::AttemptsSpent | Reason::Explained | Reason::Window
        );
        let cause = if reason == Reason::Withdrawn {
            Cause::Command
        } else if survey.map_changed && !by_execution {
            Cause::Discovery
        } else {
            Cause::Execution
        };
        let verdict = Verdict { goal, action, reason, cause, turn: None, other, terms, changes };
        revision.ended.push(verdict);
    }

    /// Remembers where the goal that just ended was.
    pub(super) fn retire(
        &mut self,
        id: GoalId,
        radius_m: f64,
        reason: Reason,
        survey: &Survey<'_>,
        revision: &Revision,
    ) {
        let Some(ended) = revision.ended.iter().find(|v| v.goal.id == id) else { return };
        let target = ended.goal.target;
        let kind = self.directives[ended.goal.directive].kind;
        let spacing = survey.spacing_m();
        // Trials of the same place add up: those this goal answered for, and one that was open to any.
        let mut reopenings = 0;
        self.state.retired.retain(|r| {
            let here = r.kind == kind && r.target.distance(target) * spacing <= r.radius_m;
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
            kind,
            target,
            radius_m,
            reason,
            heard: (survey.heard)(target),
            ground: (survey.ground)(target).unwrap_or(GROUND_UNSEEN),
            reopenings,
            closed: true,
        });
    }
}

/// The smallest window around a site's region.
pub(super) fn extent(site: &Site) -> Window {
    let one = |cell: &Cell| Window { row: cell.row, col: cell.col, rows: 1, cols: 1 };
    site.region.iter().map(one).reduce(Window::union).unwrap_or_else(|| one(&site.peak))
}

/// The way of a goal to its evaluation, if its life has not ended: whatever was not noted on the way is noted now.
fn evaluated(life: Life, reason: Reason, diary: &mut Diary) -> Option<In<Evaluated>> {
    let committed = match life.found() {
        Found::Formulated(at) => {
            at.then::<Selected>(reason, diary).then::<Expanded>(reason, diary).then(reason, diary)
        }
        Found::Selected(at) => at.then::<Expanded>(reason, diary).then(reason, diary),
        Found::Expanded(at) => at.then::<Committed>(reason, diary),
        Found::Committed(at) => at,
        Found::Dispatched(at) => return Some(at.then(reason, diary)),
        Found::Evaluated(at) => return Some(at),
        Found::Finished(_) | Found::Dropped(_) => return None,
    };
    Some(committed.then::<Dispatched>(reason, diary).then(reason, diary))
}
