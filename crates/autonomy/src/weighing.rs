//! The middle of a deliberation: poses, travel, and the choice among sequences.

use std::collections::BTreeMap;

use rayon::prelude::*;
use wisdom_goals::{
    Approach, Candidate, FactSet, Goal, GoalId, GoalManager, Limits, Poses, Selection, Shortlist,
    Weighed, poses, serves,
};
use wisdom_grid::Cell;
use wisdom_planner::{
    CostVector, Field, Limits as DriveLimits, TravelCache, TravelMatrix, TravelOptions, Weights,
};

use crate::deliberation::problem;
use crate::{Decision, Deliberation, Maps, Spec, Stage};

/// Where the rover stands on its maps, and how far it gets.
pub(crate) struct Standing<'a> {
    pub spec: &'a Spec,
    pub maps: &'a Maps,
    pub reach: &'a Field<'a>,
}

impl Standing<'_> {
    fn approach(&self, directive: usize) -> Approach {
        Approach {
            standoff_m: self.spec.directives[directive].standoff_m,
            eye_height_m: self.spec.approach.eye_height_m,
            poses: self.spec.approach.poses,
        }
    }

    /// Poses from which a directive can be followed at a target, safest first.
    pub(crate) fn poses(&self, target: Cell, directive: usize) -> Vec<(Cell, CostVector)> {
        let elevation = &self.maps.layers[crate::ELEVATION];
        poses(self.reach, elevation, target, &self.approach(directive))
    }

    /// Whether a pose still serves a target.
    pub(crate) fn serves(&self, pose: Cell, target: Cell, directive: usize) -> bool {
        let elevation = &self.maps.layers[crate::ELEVATION];
        serves(self.reach, elevation, pose, target, &self.approach(directive))
    }

    /// Poses of all open goals.
    pub(crate) fn poses_of(&self, manager: &GoalManager) -> Poses {
        let goals: Vec<&Goal> = manager.state().goals.values().collect();
        goals.par_iter().map(|goal| (goal.id, self.poses(goal.target, goal.directive))).collect()
    }
}

/// What a choice is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Asked {
    pub from: Cell,
    pub facts: FactSet,
    pub limits: Limits,
    pub pinned: Option<GoalId>,
    /// How long the mission has lasted, seconds.
    pub spent_s: f64,
}

/// What was weighed, and the choice.
pub(crate) struct Weighing {
    pub poses: Poses,
    pub shortlist: Shortlist,
    pub candidates: Vec<Candidate>,
    pub travel: TravelMatrix,
    pub nodes: Vec<Cell>,
    pub asked: Asked,
    pub agenda: Vec<GoalId>,
    pub selection: Selection,
}

impl Weighing {
    /// As the goal manager wants it.
    pub(crate) fn weighed<'a>(&'a self, spec: &'a Spec, map_changed: bool) -> Weighed<'a> {
        let Self { poses, shortlist, candidates, travel, nodes, asked, selection, .. } = self;
        Weighed {
            selection,
            shortlist,
            poses,
            problem: problem(spec, candidates, travel, asked.facts, asked.limits),
            nodes,
            spacing_m: spec.grid.spacing_m(),
            map_changed,
        }
    }

    /// What is kept of it after the decision.
    pub(crate) fn into_deliberation(self, decision: &Decision, spent_s: f64) -> Deliberation {
        let Self { poses, shortlist, candidates, travel, nodes, asked, agenda, selection } = self;
        Deliberation {
            candidates,
            travel,
            nodes,
            facts: asked.facts,
            limits: asked.limits,
            agenda,
            pinned: asked.pinned,
            selection,
            shortlist,
            poses,
            verdicts: decision.verdicts.clone(),
            manager: decision.manager_after.clone(),
            background: decision.background,
            spent_s,
        }
    }
}

/// Shortlists the goals, works out the travel between their poses, and chooses a sequence.
pub(crate) fn weigh(
    standing: &Standing<'_>,
    manager: &GoalManager,
    cache: &mut TravelCache,
    poses: Poses,
    asked: Asked,
    watch: &mut dyn FnMut(Stage),
) -> Weighing {
    let Standing { spec, maps, .. } = *standing;
    let spacing_m = spec.grid.spacing_m();
    let shortlist = manager.shortlist(&poses, spacing_m);
    let (nodes, nodes_of) = nodes(asked.from, &shortlist, &poses);
    let weights = Weights::sweep(&maps.ground, spec.routes.alternatives - 1);
    let options = TravelOptions { limits: DriveLimits::NONE, weights: &weights };
    let travel = cache.travel(&maps.ground, &nodes, &options);
    watch(Stage::Travel);
    let candidates = manager.candidates(&shortlist, &nodes_of, spacing_m, asked.spent_s);
    let asked_of = problem(spec, &candidates, &travel, asked.facts, asked.limits);
    let selection = manager.select(&asked_of, asked.pinned);
    watch(Stage::Sequences);
    let agenda = manager.state().agenda.clone();
    Weighing { poses, shortlist, candidates, travel, nodes, asked, agenda, selection }
}

/// The matrix nodes: where the rover stands, then the poses of the shortlisted goals.
fn nodes(
    start: Cell,
    shortlist: &Shortlist,
    poses: &Poses,
) -> (Vec<Cell>, BTreeMap<GoalId, Vec<usize>>) {
    let mut nodes = vec![start];
    let mut of = BTreeMap::new();
    for goal in &shortlist.kept {
        let mine: Vec<usize> = poses[goal]
            .iter()
            .map(|(pose, _)| {
                nodes.push(*pose);
                nodes.len() - 1
            })
            .collect();
        of.insert(*goal, mine);
    }
    (nodes, of)
}
