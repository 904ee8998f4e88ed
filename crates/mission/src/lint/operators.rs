//! What the operators bring about, and who needs it.

use std::collections::BTreeSet;

use wisdom_goals::FactSet;

use super::{Lint, Linter};

/// The most states that are looked at: domains of missions have a handful.
const MOST_STATES: usize = 20_000;

/// What directives make of the domain when they are served one after another, in any order.
struct Served {
    /// The states between and within services.
    states: BTreeSet<FactSet>,
    /// The operators used.
    used: BTreeSet<usize>,
}

impl Linter<'_> {
    /// Facts and operators nobody needs, and preconditions that never hold together.
    pub(super) fn operators(&mut self) {
        let Some(served) = self.served() else {
            let message = format!(
                "effect-nobody-needs and directive-never-fires: the operators lead to more than {MOST_STATES} states"
            );
            self.warn(Lint::NotChecked, &["operator"], message);
            return;
        };
        self.requirements(&served);
        self.effects(&served);
    }

    /// Facts that a directive requires and that never hold together.
    fn requirements(&mut self, served: &Served) {
        let (spec, domain) = (&self.mission.spec, &self.mission.spec.domain);
        for (i, directive) in spec.directives.iter().enumerate() {
            if served.states.iter().any(|state| state.contains(directive.requires)) {
                continue;
            }
            let closest =
                |state: &&FactSet| directive.requires.without(**state).bits().count_ones();
            let state = served.states.iter().min_by_key(closest).copied().unwrap_or_default();
            let wanted: Vec<&str> = domain.names(directive.requires).collect();
            let missing: Vec<&str> = domain.names(directive.requires.without(state)).collect();
            let message = format!(
                "`{}` requires {} together, which no service of the directives leaves behind in any of {} states; at \
                 best {} is missing. Require less, or let an operator that is used add it",
                directive.name,
                wanted.join(" and "),
                served.states.len(),
                missing.join(" and "),
            );
            let path = ["directive", &i.to_string(), "requires"];
            self.warn(Lint::DirectiveNeverFires, &path, message);
        }
    }

    fn effects(&mut self, served: &Served) {
        let (spec, domain) = (&self.mission.spec, &self.mission.spec.domain);
        let conditions = domain.operators().iter().map(|operator| operator.preconditions);
        let wishes = spec.directives.iter().map(|d| d.requires.with(d.achieves));
        let needed = conditions.chain(wishes).fold(FactSet::EMPTY, FactSet::with);
        for (i, operator) in domain.operators().iter().enumerate() {
            let index = i.to_string();
            let idle: Vec<&str> = domain.names(operator.adds.without(needed)).collect();
            if !idle.is_empty() {
                let message = format!(
                    "`{}` adds {}, which none of {} operators has as a precondition and none of {} directives \
                     requires or achieves. Drop it, or say who needs it",
                    operator.name,
                    idle.join(" and "),
                    domain.operators().len(),
                    spec.directives.len()
                );
                self.warn(Lint::EffectNobodyNeeds, &["operator", &index, "adds"], message);
            } else if i != domain.drive() && !served.used.contains(&i) {
                let message = format!(
                    "`{}` is used by none of {} directives, whatever was done before: none needs what it does, or \
                     another does it in less time. Drop it, or let a directive want it",
                    operator.name,
                    spec.directives.len()
                );
                self.warn(Lint::EffectNobodyNeeds, &["operator", &index, "name"], message);
            }
        }
        let facts = self.file.facts.clone();
        for (i, fact) in facts.iter().enumerate() {
            let set = domain.set(std::slice::from_ref(fact)).unwrap_or_default();
            if !needed.contains(set) {
                let message = format!(
                    "`{fact}` holds at the start, and no precondition, `requires` or `achieves` of {} operators and \
                     {} directives mentions it. Drop it, or correct its name",
                    domain.operators().len(),
                    spec.directives.len()
                );
                self.warn(Lint::EffectNobodyNeeds, &["facts", &i.to_string()], message);
            }
        }
    }

    /// All states that serving directives leads to; none if there are too many.
    fn served(&self) -> Option<Served> {
        let (spec, domain) = (&self.mission.spec, &self.mission.spec.domain);
        let mut served = Served { states: BTreeSet::new(), used: BTreeSet::new() };
        let mut open = vec![domain.initial()];
        while let Some(state) = open.pop() {
            if !served.states.insert(state) {
                continue;
            }
            if served.states.len() > MOST_STATES {
                return None;
            }
            for directive in spec.directives.iter().filter(|d| state.contains(d.requires)) {
                let Some(plan) = domain.expand(state, directive.achieves) else { continue };
                let operators = plan.before.into_iter().chain([domain.drive()]).chain(plan.after);
                // A drive or an activity may be broken off: states on the way count too.
                let mut on_the_way = state;
                for operator in operators {
                    served.used.insert(operator);
                    on_the_way = domain
                        .step(on_the_way, operator, directive.achieves)
                        .expect("an expansion's operators follow each other");
                    open.push(on_the_way);
                }
            }
        }
        Some(served)
    }
}
