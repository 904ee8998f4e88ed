//! What in a goal sequence truly has to come before what: a partial order of its operators.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use petgraph::algo::toposort;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;

use crate::{Directive, Domain, Expansion, FactSet, GoalId, GoalSequence};

/// One step of a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// The goal it serves; none for the facts that hold now.
    pub goal: Option<GoalId>,
    /// The operator, by index; none for `now` and for the moment at which a goal is done.
    pub operator: Option<usize>,
    /// `now`, the goal and the operator (`G4 drive`), or the goal done (`G4 done`).
    pub label: String,
}

/// Why one step comes before another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Link {
    /// The first makes this fact true, the second needs it.
    Causal(String),
    /// One of the two makes this fact false, the other needs it or makes it true for one that does: the other way round
    /// it would be missing.
    Threat(String),
    /// A goal is done before the rover drives to the next one.
    Drive,
    /// Everything comes after now.
    Start,
}

/// The steps of a sequence and what orders them: a partial-order plan (Weld 1994) in which each fact that a step needs
/// has one step that makes it true, and whatever would undo it in between is kept out.
///
/// Every order that respects the links is a valid STRIPS plan for the same goals at the same stops, the one it was made
/// from among them. Each goal has a step besides its operators: the moment when all that its directive wants holds.
#[derive(Debug, Clone)]
pub struct CausalGraph(DiGraph<Step, Link>);

/// Why a sequence is not a valid STRIPS plan.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A precondition does not hold when its operator's turn comes.
    #[error("{goal}: operator `{operator}` needs `{fact}`, which does not hold at its turn")]
    Precondition {
        /// The goal served.
        goal: GoalId,
        /// The operator.
        operator: String,
        /// The missing fact.
        fact: String,
    },
    /// A fact that the goal's directive asks for does not hold when its turn comes.
    #[error("{goal}: its directive requires `{fact}`, which does not hold at its turn")]
    NotReady {
        /// The goal served.
        goal: GoalId,
        /// The missing fact.
        fact: String,
    },
    /// A goal's operators do not bring about what its directive wants.
    #[error("{goal}: `{fact}` does not hold after its last operator")]
    NotAchieved {
        /// The goal served.
        goal: GoalId,
        /// The missing fact.
        fact: String,
    },
}

/// A step on the way: what it needs, makes true and makes false.
struct Turn {
    step: Step,
    needs: FactSet,
    makes: FactSet,
    breaks: FactSet,
    is_drive: bool,
}

impl Turn {
    fn new(step: Step, needs: FactSet) -> Self {
        let (makes, breaks) = (FactSet::EMPTY, FactSet::EMPTY);
        Self { step, needs, makes, breaks, is_drive: false }
    }
}

/// The steps in the order of the sequence, each checked at its turn.
fn turns(
    sequence: &GoalSequence,
    domain: &Domain,
    facts: FactSet,
    directive_of: impl Fn(GoalId) -> Directive,
) -> Result<Vec<Turn>, PlanError> {
    let now = Step { goal: None, operator: None, label: "now".to_owned() };
    let mut turns = vec![Turn { makes: facts, ..Turn::new(now, FactSet::EMPTY) }];
    let mut state = facts;
    for stop in &sequence.stops {
        let goal = stop.goal;
        let directive = directive_of(goal);
        if let Some(fact) = domain.names(directive.requires.without(state)).next() {
            return Err(PlanError::NotReady { goal, fact: fact.to_owned() });
        }
        let mut asked = directive.requires;
        let Expansion { before, after, .. } = &stop.expansion;
        for index in before.iter().copied().chain([domain.drive()]).chain(after.iter().copied()) {
            let operator = &domain.operators()[index];
            let is_drive = index == domain.drive();
            let Some(after) = domain.step(state, index, directive.achieves) else {
                let missing = operator.preconditions.without(state);
                return Err(PlanError::Precondition {
                    goal,
                    operator: operator.name.clone(),
                    fact: domain.names(missing).next().unwrap_or_default().to_owned(),
                });
            };
            // The drive clears what is wanted at its end, whatever it adds; otherwise adds win.
            let cleared = if is_drive { directive.achieves } else { FactSet::EMPTY };
            let makes = operator.adds.without(cleared);
            let label = format!("{goal} {}", operator.name);
            turns.push(Turn {
                step: Step { goal: Some(goal), operator: Some(index), label },
                // What the directive requires is needed by the first operator that serves the goal.
                needs: operator.preconditions.with(std::mem::take(&mut asked)),
                makes,
                breaks: operator.deletes.with(cleared).without(makes),
                is_drive,
            });
            state = after;
        }
        if let Some(fact) = domain.names(directive.achieves.without(state)).next() {
            return Err(PlanError::NotAchieved { goal, fact: fact.to_owned() });
        }
        let done = Step { goal: Some(goal), operator: None, label: format!("{goal} done") };
        turns.push(Turn::new(done, directive.achieves));
    }
    Ok(turns)
}

impl CausalGraph {
    /// Walks through the operators of a sequence from the facts that hold now, checking every precondition, and links
    /// what orders them.
    ///
    /// `directive_of` tells which directive each goal follows.
    ///
    /// # Errors
    /// A [`PlanError`] if the sequence is not valid when its operators are applied one by one. This is the
    /// independent check of what the forward search put together.
    pub fn new(
        sequence: &GoalSequence,
        domain: &Domain,
        facts: FactSet,
        directive_of: impl Fn(GoalId) -> Directive,
    ) -> Result<Self, PlanError> {
        let turns = turns(sequence, domain, facts, directive_of)?;
        let mut links: BTreeSet<(usize, usize, Link)> = BTreeSet::new();
        for (bit, fact) in domain.facts().iter().enumerate() {
            let fact_set = FactSet::from_bits(1 << bit);
            let mut maker = 0;
            for (user, turn) in turns.iter().enumerate() {
                if turn.needs.meets(fact_set) {
                    links.insert((maker, user, Link::Causal(fact.clone())));
                    // What breaks the fact stays on the side where it stands in the sequence.
                    for (breaker, other) in turns.iter().enumerate() {
                        if breaker == user || !other.breaks.meets(fact_set) {
                            continue;
                        }
                        let (first, then) =
                            if breaker < user { (breaker, maker) } else { (user, breaker) };
                        links.insert((first, then, Link::Threat(fact.clone())));
                    }
                }
                if turn.makes.meets(fact_set) {
                    maker = user;
                }
            }
        }
        let is_done = |turn: &Turn| turn.step.operator.is_none() && turn.step.goal.is_some();
        for (drive, _) in turns.iter().enumerate().filter(|(_, t)| t.is_drive) {
            if let Some(done) = turns[..drive].iter().rposition(is_done) {
                links.insert((done, drive, Link::Drive));
            }
        }
        for step in 1..turns.len() {
            if !links.iter().any(|(_, to, _)| *to == step) {
                links.insert((0, step, Link::Start));
            }
        }
        let links = reduced(turns.len(), links);
        let mut graph = DiGraph::new();
        let nodes: Vec<NodeIndex> =
            turns.into_iter().map(|turn| graph.add_node(turn.step)).collect();
        for (from, to, link) in links {
            graph.add_edge(nodes[from], nodes[to], link);
        }
        Ok(Self(graph))
    }

    /// The steps in the order of the sequence; the first is `now`.
    pub fn steps(&self) -> impl Iterator<Item = &Step> {
        self.0.node_weights()
    }

    /// All links: the numbers of two steps and why the first comes before the second. What other links imply is left out,
    /// but for the causal ones.
    pub fn links(&self) -> impl Iterator<Item = (usize, usize, &Link)> {
        self.0.edge_references().map(|e| (e.source().index(), e.target().index(), e.weight()))
    }

    /// The steps in an order that respects every link.
    ///
    /// # Panics
    /// Never: links only lead to later steps, so there is no cycle.
    #[must_use]
    pub fn order(&self) -> Vec<&str> {
        let order = toposort(&self.0, None).expect("links lead forward in time");
        order.into_iter().map(|node| self.0[node].label.as_str()).collect()
    }

    /// The graph in the DOT language of Graphviz: a cluster for each goal; causal links solid and named by their fact,
    /// threats dashed and named, other orderings dotted.
    #[must_use]
    pub fn dot(&self) -> String {
        let mut text = "digraph {\n    rankdir = LR\n    node [shape = box]\n".to_owned();
        // What is written to a `String` is never refused.
        let mut line = |indent: &str, words: std::fmt::Arguments<'_>| {
            let _ = writeln!(text, "{indent}{words}");
        };
        let mut at: Option<GoalId> = None;
        for (number, step) in self.steps().enumerate() {
            if step.goal != at {
                if at.is_some() {
                    line("    ", format_args!("}}"));
                }
                at = step.goal;
                if let Some(goal) = at {
                    line("    ", format_args!("subgraph \"cluster {goal}\" {{"));
                    line("        ", format_args!("label = \"{goal}\""));
                }
            }
            let shape = if step.operator.is_none() { ", shape=plaintext" } else { "" };
            let indent = if at.is_some() { "        " } else { "    " };
            line(indent, format_args!("{number} [label={:?}{shape}]", step.label));
        }
        if at.is_some() {
            line("    ", format_args!("}}"));
        }
        for (from, to, link) in self.links() {
            let style = match link {
                Link::Causal(fact) => format!("label={fact:?}"),
                Link::Threat(fact) => format!("label={fact:?}, style=dashed"),
                Link::Drive | Link::Start => "style=dotted".to_owned(),
            };
            line("    ", format_args!("{from} -> {to} [{style}]"));
        }
        text.push('}');
        text
    }
}

/// The links without those that say nothing new: of the ones that are not causal, those that others imply.
fn reduced(steps: usize, links: BTreeSet<(usize, usize, Link)>) -> Vec<(usize, usize, Link)> {
    let mut after: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); steps];
    for &(from, to, _) in &links {
        after[from].insert(to);
    }
    // Links lead to later steps: what lies beyond a step is known once all later ones are done.
    let mut beyond: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); steps];
    for step in (0..steps).rev() {
        for &next in &after[step] {
            let further = beyond[next].clone();
            beyond[step].extend(further);
            beyond[step].insert(next);
        }
    }
    let is_causal = |link: &Link| matches!(link, Link::Causal(_));
    let causal: BTreeSet<(usize, usize)> =
        links.iter().filter(|(.., link)| is_causal(link)).map(|&(a, b, _)| (a, b)).collect();
    links
        .into_iter()
        .filter(|(from, to, link)| {
            let is_implied = causal.contains(&(*from, *to))
                || after[*from].iter().any(|next| next != to && beyond[*next].contains(to));
            is_causal(link) || !is_implied
        })
        .collect()
}
