//! What the ground asks for, and takes back.

use super::revise::Ending;
use super::{Command, GoalManager, Revision, Survey, Wish};
use crate::lifecycle::Life;
use crate::prize::quantised;
use crate::{Change, Goal, GoalId, Order, Reason, Term};
use wisdom_grid::Cell;

impl GoalManager {
    /// Carries out what the ground asked for.
    pub(super) fn obey(&mut self, survey: &Survey<'_>, revision: &mut Revision) {
        for Command { name, wish } in std::mem::take(&mut self.state.commands) {
            match wish {
                Wish::Withdraw => {
                    self.state.commands.retain(|waiting| waiting.name != name);
                    self.withdraw(&name, survey, revision);
                }
                Wish::Pursue { directive, target, prize, mandatory }
                    if survey.grid().contains(target) =>
                {
                    let prize = quantised(prize);
                    let order = Order { name, prize, mandatory, before: None };
                    self.accept(order, directive, target, survey, revision);
                }
                // It waits for the map that the rover works on to reach its place.
                Wish::Pursue { .. } => self.state.commands.push(Command { name, wish }),
            }
        }
    }

    /// A goal for a command: the one that is there already, or a new one.
    fn accept(
        &mut self,
        mut order: Order,
        directive: usize,
        target: Cell,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) {
        let kind = self.directives[directive].kind;
        let near = self.state.goals.values().filter(|goal| {
            goal.order.is_none()
                && self.directives[goal.directive].kind == kind
                && self.same_place(goal.target, target, survey)
        });
        let nearest = near.min_by(|a, b| {
            a.target.distance(target).total_cmp(&b.target.distance(target)).then(a.id.cmp(&b.id))
        });
        let terms = vec![Term::of("prize", order.prize)];
        let id = if let Some(goal) = nearest {
            order.before = Some((goal.directive, goal.target));
            goal.id
        } else {
            let id = GoalId(self.state.next_id);
            self.state.next_id += 1;
            let goal = Goal {
                id,
                directive,
                target,
                interest: 0.0,
                prize: order.prize,
                prominence: 0.0,
                ignorance: 0.0,
                paradox: 0.0,
                contradiction: 0.0,
                credit: Vec::new(),
                region_cells: 0,
                extent: survey.grid().around(target, 0),
                doubt: (survey.doubt)(target),
                attempts: 0,
                born: self.state.decision,
                parent: None,
                order: None,
                pose: None,
                operators: Vec::new(),
                life: Life::BORN,
            };
            revision.born.insert(id);
            self.state.goals.insert(id, goal);
            id
        };
        let goal = self.state.goals.get_mut(&id).expect("the goal is open");
        if goal.target != target {
            goal.pose = None;
        }
        (goal.directive, goal.target, goal.order) = (directive, target, Some(order));
        revision.change(id, Change::new(Reason::Commanded, terms));
        self.weigh_anew(id, survey, revision);
    }

    /// Ends the goal of a command that was taken back, or leaves it to the map that had it before.
    fn withdraw(&mut self, name: &str, survey: &Survey<'_>, revision: &mut Revision) {
        let wanted = |goal: &&Goal| goal.order.as_ref().is_some_and(|order| order.name == name);
        let Some(goal) = self.state.goals.values().find(wanted) else { return };
        let (id, prize) = (goal.id, goal.prize);
        let before = goal.order.as_ref().and_then(|order| order.before);
        let terms = vec![Term::of("prize", prize)];
        if let Some((directive, target)) = before {
            let goal = self.state.goals.get_mut(&id).expect("the goal is open");
            (goal.directive, goal.target, goal.order, goal.pose) = (directive, target, None, None);
            revision.change(id, Change::new(Reason::Withdrawn, terms));
        } else {
            self.end(id, Ending::drop(Reason::Withdrawn, terms, None), survey, revision);
        }
    }
}
