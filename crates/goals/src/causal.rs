//! Causal links of a goal sequence: which operator makes true what a later one needs.

use petgraph::algo::toposort;
use petgraph::dot::{Config, Dot};
use petgraph::graph::{DiGraph, NodeIndex};

use crate::{Directive, Domain, Expansion, FactSet, GoalId, GoalSequence};

/// The operators of a sequence as a graph: an edge leads from the operator that last made a fact true to
/// one that needs it, and is named by the fact; each operator follows the one before it by an edge without a
/// fact.
#[derive(Debug, Clone)]
pub struct CausalGraph(DiGraph<String, String>);

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

impl CausalGraph {
    /// Walks through the operators of a sequence from the facts that hold now, checking every precondition.
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
        let mut graph = DiGraph::new();
        let start = graph.add_node("now".to_owned());
        let mut makers: Vec<NodeIndex> = vec![start; domain.facts().len()];
        let mut state = facts;
        let mut last = start;
        for stop in &sequence.stops {
            let directive = directive_of(stop.goal);
            if let Some(fact) = domain.names(directive.requires.without(state)).next() {
                return Err(PlanError::NotReady { goal: stop.goal, fact: fact.to_owned() });
            }
            let mut asked = directive.requires;
            let Expansion { before, after, .. } = &stop.expansion;
            for index in before.iter().copied().chain([domain.drive()]).chain(after.iter().copied())
            {
                let operator = &domain.operators()[index];
                let node = graph.add_node(format!("{} {}", stop.goal, operator.name));
                graph.add_edge(last, node, String::new());
                // What the directive requires is needed by the first operator that serves the goal.
                let needed = operator.preconditions.with(std::mem::take(&mut asked));
                for (bit, fact) in domain.facts().iter().enumerate() {
                    if needed.meets(FactSet::from_bits(1 << bit)) {
                        graph.add_edge(makers[bit], node, fact.clone());
                    }
                }
                let Some(after) = domain.step(state, index, directive.achieves) else {
                    let missing = operator.preconditions.without(state);
                    return Err(PlanError::Precondition {
                        goal: stop.goal,
                        operator: operator.name.clone(),
                        fact: domain.names(missing).next().unwrap_or_default().to_owned(),
                    });
                };
                for (bit, maker) in makers.iter_mut().enumerate() {
                    if operator.adds.meets(FactSet::from_bits(1 << bit)) {
                        *maker = node;
                    }
                }
                state = after;
                last = node;
            }
            if let Some(fact) = domain.names(directive.achieves.without(state)).next() {
                return Err(PlanError::NotAchieved { goal: stop.goal, fact: fact.to_owned() });
            }
        }
        Ok(Self(graph))
    }

    /// The operators in an order that respects every link.
    ///
    /// # Panics
    /// Never: links only lead to later operators, so there is no cycle.
    #[must_use]
    pub fn order(&self) -> Vec<&str> {
        let order = toposort(&self.0, None).expect("links lead forward in time");
        order.into_iter().map(|node| self.0[node].as_str()).collect()
    }

    /// The graph in the DOT language of Graphviz.
    #[must_use]
    pub fn dot(&self) -> String {
        let name = |_, (_, label): (NodeIndex, &String)| format!("label={label:?}");
        let link = |_, edge: petgraph::graph::EdgeReference<'_, String>| {
            let fact = edge.weight();
            if fact.is_empty() { "style=dotted".to_owned() } else { format!("label={fact:?}") }
        };
        format!(
            "{:?}",
            Dot::with_attr_getters(
                &self.0,
                &[Config::EdgeNoLabel, Config::NodeNoLabel],
                &link,
                &name,
            )
        )
    }
}
