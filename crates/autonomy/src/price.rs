//! What would have had to be otherwise for the goals that a decision left out.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;
use wisdom_goals::{
    Action, Approach, Candidate, Choice, Goal, GoalId, GoalManager, Kind, Lever, MOST_PRIZE,
    ManagerState, Poses, Price, PriceTag, PrizeQuestion, PrizeScale, Reason, Term, Verdict, poses,
    quantised,
};
use wisdom_grid::Cell;
use wisdom_planner::{
    CostVector, FieldOptions, Limits as DriveLimits, TravelMatrix, TravelOptions, Weights, field,
    travel_alternatives,
};

use crate::{Autonomy, Deliberation, ELEVATION, Maps, Spec};

/// Decisions taken anew for a lever of all goals together, and for the prize of each.
const SOLVES: usize = 96;

/// Prizes are quantised to 2⁻³²: this much more rounds them up.
const HALF_A_STEP: f64 = 1.0 / 8_589_934_592.0;

/// The price tag of a goal that a decision left out.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalPrice {
    /// What the decision said of it.
    pub verdict: Verdict,
    /// What would bring it in.
    pub tag: PriceTag,
    /// The interest at its target that the prize asked for stands for, all else on the map being as it is. Above 1, no
    /// interest is enough; none where there is no price, or the prize says nothing of the interest.
    pub interest: Option<f64>,
}

/// Whether a goal is in the sequence at its price, and at 1 % less.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Applied {
    /// At the price.
    pub at: bool,
    /// At 99 % of it.
    pub under: bool,
}

impl Applied {
    /// Whether the price is what it says.
    #[must_use]
    pub fn confirms(self) -> bool {
        self.at && !self.under
    }
}

/// A price tag held against decisions taken anew: for each lever that has a price, whether it does what it says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Confirmation {
    /// Of the energy.
    pub energy_j: Option<Applied>,
    /// Of the time.
    pub time_s: Option<Applied>,
    /// Of the floor on reliability.
    pub reliability: Option<Applied>,
    /// Of the prize.
    pub prize: Option<Applied>,
}

impl Autonomy {
    /// The price tags of all goals that the latest decision deferred or dropped, by their numbers; none before the first
    /// decision. Worked out on demand: seconds, where a decision takes a fraction of one.
    ///
    /// Each tag says what would have had to be otherwise at that decision: the limits, or the goal's own prize, and nothing
    /// else. A goal outside the shortlist has no price in limits, as these do not bring it in; a higher prize may. A
    /// goal that was dropped has none, but for one that lost its interest.
    ///
    /// The prices of goals outside the shortlist need the maps of the decision: once the rover has seen more or moved on
    /// they are [`Price::Unknown`].
    #[must_use]
    pub fn price_tags(&self) -> Vec<GoalPrice> {
        self.priced(|_| true)
    }

    /// The price tag of one goal; none if the latest decision did not leave it out.
    #[must_use]
    pub fn price_tag(&self, goal: GoalId) -> Option<GoalPrice> {
        self.priced(|id| id == goal).pop()
    }

    /// Takes the decision again at each price of some tags, and at 1 % less; in the order of the tags.
    #[must_use]
    pub fn confirmed(&self, prices: &[GoalPrice]) -> Vec<Confirmation> {
        let verdicts: Vec<Verdict> = prices.iter().map(|price| price.verdict.clone()).collect();
        let Some(counter) = Counterfactual::new(self, &verdicts) else { return Vec::new() };
        prices.par_iter().map(|price| counter.confirmed(price)).collect()
    }

    fn priced(&self, wanted: impl Fn(GoalId) -> bool) -> Vec<GoalPrice> {
        let Some(decided) = self.deliberation() else { return Vec::new() };
        let left_out =
            |v: &&Verdict| matches!(v.action, Action::Defer | Action::Drop) && wanted(v.goal.id);
        let verdicts: Vec<Verdict> = decided.verdicts.iter().filter(left_out).cloned().collect();
        let Some(counter) = Counterfactual::new(self, &verdicts) else { return Vec::new() };
        let sequenced: Vec<GoalId> = verdicts
            .iter()
            .map(|v| v.goal.id)
            .filter(|id| decided.shortlist.kept.contains(id))
            .collect();
        let choice = decided.choice(self.spec());
        // All goals share the decisions taken anew for a limit.
        let limits: Vec<Vec<Price>> = if sequenced.is_empty() {
            vec![Vec::new(); Lever::ALL.len()]
        } else {
            Lever::ALL.par_iter().map(|l| choice.prices(*l, &sequenced, SOLVES)).collect()
        };
        let prizes: Vec<Price> = verdicts.par_iter().map(|v| counter.prize(v)).collect();
        verdicts
            .into_iter()
            .zip(prizes)
            .map(|(verdict, prize)| {
                let goal = verdict.goal.id;
                let turn = sequenced.iter().position(|id| *id == goal);
                let on = |lever: usize| {
                    turn.map_or_else(
                        || decided.barred(&verdict),
                        |turn| limits[lever][turn].clone(),
                    )
                };
                let tag =
                    PriceTag { goal, energy_j: on(0), time_s: on(1), reliability: on(2), prize };
                let directive = &self.spec().directives[verdict.goal.directive];
                // Only these have their prize from the interest at their target.
                let from_interest = directive.kind == Kind::Inspect && verdict.goal.order.is_none();
                let change = tag.prize.change().filter(|_| from_interest);
                let interest = change.and_then(|change| {
                    let prize = (prize_now(&verdict) + change) / directive.weight;
                    interest_for(self.spec().prize, prize, decided.background)
                });
                GoalPrice { verdict, tag, interest }
            })
            .collect()
    }
}

/// The interest that has a prize (before its directive's weight), where the scale can be turned round.
fn interest_for(scale: PrizeScale, prize: f64, background: f64) -> Option<f64> {
    match scale {
        PrizeScale::Belief => Some(prize),
        PrizeScale::Contrast => Some(background + prize * (1.0 - background)),
        _ => None,
    }
}

/// The prize that a rise is counted from: that on the map, where a goal was dropped for it.
fn prize_now(verdict: &Verdict) -> f64 {
    let on_map = verdict.terms.iter().find(|t| may_come_back(verdict) && t.name == "prize");
    on_map.map_or(verdict.goal.prize, |term| term.value)
}

fn holds(choice: &Choice<'_>, goal: GoalId) -> bool {
    choice.decide().sequence().goals().any(|id| id == goal)
}

impl Deliberation {
    /// The decision, to be taken again; `spec` is the core's.
    #[must_use]
    pub fn choice<'a>(&'a self, spec: &'a Spec) -> Choice<'a> {
        Choice {
            problem: self.problem(spec),
            spec: &spec.manager,
            agenda: &self.agenda,
            pinned: self.pinned,
        }
    }

    /// The price in limits of a goal that was not sequenced: there is none.
    fn barred(&self, verdict: &Verdict) -> Price {
        let goal = verdict.goal.id;
        let cut = self.shortlist.left_out.iter().find(|(id, _)| *id == goal);
        match cut {
            Some(&(_, bound)) => {
                Price::nothing(Reason::BeyondExact, vec![Term::of("bound", bound)])
            }
            None => Price::nothing(verdict.reason, verdict.terms.clone()),
        }
    }
}

/// A decision with the goals that it did not sequence: as if their prizes had been others.
struct Counterfactual<'a> {
    spec: &'a Spec,
    decided: &'a Deliberation,
    /// Poses of the open goals and of those asked about.
    poses: Poses,
    /// Travel between the poses of all goals that some prize may bring into the shortlist, and their nodes; none if the
    /// maps are no longer those of the decision.
    travel: Option<(TravelMatrix, BTreeMap<GoalId, Vec<usize>>)>,
}

impl<'a> Counterfactual<'a> {
    fn new(rover: &'a Autonomy, verdicts: &[Verdict]) -> Option<Self> {
        let (spec, decided, maps) = (rover.spec(), rover.deliberation()?, rover.maps()?);
        let mut counter = Self { spec, decided, poses: decided.poses.clone(), travel: None };
        let valid = rover.maps_are_those_decided_on();
        if valid {
            for verdict in verdicts.iter().filter(|v| may_come_back(v)) {
                let found = counter.approach(maps, &verdict.goal);
                counter.poses.insert(verdict.goal.id, found);
            }
        }
        let mut needed: BTreeSet<GoalId> = BTreeSet::new();
        for verdict in verdicts {
            needed.extend(counter.shortlisted(&verdict.goal));
        }
        let kept = &decided.shortlist.kept;
        let inside = needed.iter().all(|goal| kept.contains(goal));
        counter.travel = if inside {
            let candidates = decided.candidates.iter();
            let nodes = candidates.map(|c| (c.goal, c.poses.clone())).collect();
            Some((decided.travel.clone(), nodes))
        } else if valid {
            needed.extend(kept);
            Some(counter.matrix(maps, &needed))
        } else {
            None
        };
        Some(counter)
    }

    /// The poses of a goal that was dropped.
    fn approach(&self, maps: &Maps, goal: &Goal) -> Vec<(Cell, CostVector)> {
        let everywhere = FieldOptions { targets: None, limits: DriveLimits::NONE };
        let reach = field(&maps.ground, self.decided.nodes[0], &everywhere);
        let approach = Approach {
            standoff_m: self.spec.directives[goal.directive].standoff_m,
            eye_height_m: self.spec.approach.eye_height_m,
            poses: self.spec.approach.poses,
        };
        poses(&reach, &maps.layers[ELEVATION], goal.target, &approach)
    }

    fn matrix(
        &self,
        maps: &Maps,
        goals: &BTreeSet<GoalId>,
    ) -> (TravelMatrix, BTreeMap<GoalId, Vec<usize>>) {
        let mut cells = vec![self.decided.nodes[0]];
        let mut nodes = BTreeMap::new();
        for goal in goals {
            let first = cells.len();
            cells.extend(self.poses[goal].iter().map(|(cell, _)| *cell));
            nodes.insert(*goal, (first..cells.len()).collect());
        }
        let weights = Weights::sweep(&maps.ground, self.spec.routes.alternatives - 1);
        let options = TravelOptions { limits: DriveLimits::NONE, weights: &weights };
        (travel_alternatives(&maps.ground, &cells, &options), nodes)
    }

    /// The manager as it was, but for the prize of one goal.
    fn manager(&self, goal: &Goal, prize: f64) -> GoalManager {
        let mut manager = GoalManager::new(self.spec.manager.clone(), self.spec.directives.clone());
        let mut state =
            ManagerState { agenda: self.decided.agenda.clone(), ..self.decided.manager.clone() };
        state.goals.insert(goal.id, Goal { prize, ..goal.clone() });
        manager.restore(state);
        manager
    }

    /// All goals that are shortlisted at some prize of one of them.
    fn shortlisted(&self, goal: &Goal) -> BTreeSet<GoalId> {
        let spacing_m = self.spec.grid.spacing_m();
        let at = |prize| self.manager(goal, prize).shortlist(&self.poses, spacing_m).kept;
        let safest = |id: GoalId| {
            let ways = self.poses.get(&id).into_iter().flatten();
            ways.map(|(_, way)| way.reliability()).fold(0.0, f64::max)
        };
        let mine = safest(goal.id);
        let mut found: BTreeSet<GoalId> = at(goal.prize).into_iter().collect();
        if mine > 0.0 {
            found.extend(at(MOST_PRIZE));
            // The list changes where its bound passes another's.
            for (id, other) in &self.decided.manager.goals {
                let level = other.prize * safest(*id) / mine;
                if level > goal.prize {
                    found.extend(at(level));
                    found.extend(at(level * (1.0 + 1e-9)));
                }
            }
        }
        found
    }

    /// How much higher a goal's prize must be.
    fn prize(&self, verdict: &Verdict) -> Price {
        if verdict.action == Action::Drop && !may_come_back(verdict) {
            return Price::nothing(verdict.reason, verdict.terms.clone());
        }
        if self.travel.is_some() && self.poses.get(&verdict.goal.id).is_none_or(Vec::is_empty) {
            return Price::nothing(Reason::Unreachable, vec![Term::against("poses", 0.0, 1.0)]);
        }
        let price = self.asked(verdict, |choice, question| choice.price_of_prize(question, SOLVES));
        match price {
            // With all the prize there is only a committed goal beside it is sequenced in its stead.
            Some(Price::Nothing { reason: Reason::BeyondExact, .. }) if self.has_room() => {
                let terms =
                    if verdict.reason == Reason::Excluded { &verdict.terms[..] } else { &[] };
                Price::nothing(Reason::Excluded, terms.to_vec())
            }
            price => price.unwrap_or(Price::Unknown),
        }
    }

    /// Whether the committed goals leave room in the shortlist.
    fn has_room(&self) -> bool {
        self.decided.agenda.len() < self.spec.manager.max_sequenced
    }

    fn confirmed(&self, price: &GoalPrice) -> Confirmation {
        let goal = price.tag.goal;
        let choice = self.decided.choice(self.spec);
        let limit = |lever, price: &Price| {
            let holds = |change| holds(&choice.loosened(lever, change), goal);
            price.change().map(|change| Applied { at: holds(change), under: holds(0.99 * change) })
        };
        let prize = price.tag.prize.change().and_then(|change| {
            self.asked(&price.verdict, |choice, question| {
                let holds = |change| {
                    let prize = question.prize(change);
                    let candidates = (question.candidates)(prize);
                    prize >= question.least && holds(&choice.among(&candidates), goal)
                };
                Applied { at: holds(change), under: holds(0.99 * change) }
            })
        });
        Confirmation {
            energy_j: limit(Lever::Energy, &price.tag.energy_j),
            time_s: limit(Lever::Time, &price.tag.time_s),
            reliability: limit(Lever::Reliability, &price.tag.reliability),
            prize,
        }
    }

    /// Asks about the prize of a goal; none if the maps are gone.
    fn asked<T>(
        &self,
        verdict: &Verdict,
        ask: impl FnOnce(&Choice<'_>, &PrizeQuestion<'_>) -> T,
    ) -> Option<T> {
        let (travel, nodes) = self.travel.as_ref()?;
        let goal = &verdict.goal;
        let (spacing_m, spent_s) = (self.spec.grid.spacing_m(), self.decided.spent_s);
        // A search looks at every node of its matrix: only those of this goal's rivals are given to it.
        let rivals = self.shortlisted(goal);
        let mut kept = vec![0];
        let mut mine: BTreeMap<GoalId, Vec<usize>> = BTreeMap::new();
        for id in &rivals {
            let first = kept.len();
            kept.extend(&nodes[id]);
            mine.insert(*id, (first..kept.len()).collect());
        }
        let cells: Vec<_> = kept.iter().map(|&node| travel.nodes()[node]).collect();
        let travel = TravelMatrix::from_costs(&cells, |from, to| {
            travel.alternatives(kept[from], kept[to]).to_vec()
        });
        let candidates = |prize: f64| -> Vec<Candidate> {
            let manager = self.manager(goal, prize);
            let shortlist = manager.shortlist(&self.poses, spacing_m);
            manager.candidates(&shortlist, &mine, spacing_m, spent_s)
        };
        let mut choice = self.decided.choice(self.spec);
        choice.problem.travel = &travel;
        let question = PrizeQuestion {
            goal: goal.id,
            now: prize_now(verdict),
            least: self.least(verdict),
            candidates: &candidates,
        };
        Some(ask(&choice, &question))
    }

    /// The prize at which a goal that lost its interest would have been kept.
    fn least(&self, verdict: &Verdict) -> f64 {
        let goal = &verdict.goal;
        let mut least = prize_now(verdict);
        if may_come_back(verdict) {
            let directive = &self.spec.directives[goal.directive];
            let background = self.decided.background;
            let prize = match self.spec.prize {
                _ if directive.kind != Kind::Inspect => 0.0,
                PrizeScale::Contrast => {
                    ((directive.min_interest - background) / (1.0 - background)).max(0.0)
                }
                PrizeScale::Belief => directive.min_interest,
                _ => 0.0,
            };
            least = least.max(directive.weight * prize);
            for term in verdict.terms.iter().filter(|t| t.name == "prize") {
                least = least.max(term.limit.unwrap_or(0.0));
            }
        }
        quantised(least + HALF_A_STEP)
    }
}

/// Whether more interest would have kept a goal that was dropped.
fn may_come_back(verdict: &Verdict) -> bool {
    verdict.action == Action::Drop && verdict.reason == Reason::LostInterest
}
