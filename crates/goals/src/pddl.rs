//! A decision's problem in PDDL, for outside planners and validators: net benefit with the soft goals compiled away
//! (Keyder and Geffner 2009), and our own optimum of the very same whole numbers.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use wisdom_planner::{CostVector, TravelMatrix};

use crate::{
    Candidate, Directive, Domain, Effort, Expansion, FactSet, GoalSequence, Limits, Policy, Prices,
    Problem, Proof, ServiceCost, sequences,
};

/// Cost units of one unit of prize, where nothing is too large for them.
pub const PDDL_UNITS: u64 = 1_000_000;

/// No plan may cost more, so that planners with 32 bits for a cost are not led astray.
const MOST: u64 = 1_000_000_000;

/// The most states of the facts that services are written out for.
const MAX_STATES: usize = 1024;

/// A problem in PDDL, and our plan for it.
#[derive(Debug, Clone, PartialEq)]
pub struct PddlFiles {
    /// The text of `domain.pddl`.
    pub domain: String,
    /// The text of `problem.pddl`.
    pub problem: String,
    /// The text of `plan.txt`: an action a line, as validators read it.
    pub plan: String,
    /// Total cost of the plan, in units of which [`PddlFiles::units`] make one unit of prize: prizes forgone, and the
    /// prices of risk and energy.
    pub cost: u64,
    /// Cost units of one unit of prize: a power of ten, at most [`PDDL_UNITS`].
    pub units: u64,
    /// The sequence that the plan carries out; its value and energy are in cost units, its legs have one alternative.
    pub sequence: GoalSequence,
    /// Whether the plan is known to be an optimum.
    pub proof: Proof,
}

/// Why a problem has no form in PDDL.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PddlError {
    /// Prizes or prices too large for whole numbers of 32 bits, even coarsely rounded.
    #[error(
        "a plan could cost {most:e} units of prize; at most {MOST} can be written as whole numbers"
    )]
    TooLarge {
        /// The most a plan could cost.
        most: f64,
    },
    /// More states of the facts than can be written out.
    #[error(
        "the candidates lead to more than {MAX_STATES} states of the facts; restrict the goals or the domain"
    )]
    TooManyStates,
}

/// Writes a problem under [`Policy::NetBenefit`] and without limits of time, energy, data, reliability and windows as
/// PDDL, and solves it by [`sequences`] with this effort.
///
/// All numbers are rounded to whole cost units first; the plan is that of the rounded problem. Operators serve a goal as
/// the rover would: in each state of the facts by the series that [`Domain::expand`] chooses. `name` goes into the
/// texts as the name of the problem.
///
/// # Errors
/// [`PddlError`] if the numbers or the states of the facts are too many to be written.
///
/// # Panics
/// As [`sequences`].
pub fn pddl(problem: &Problem<'_>, name: &str, effort: Effort<'_>) -> Result<PddlFiles, PddlError> {
    let rounded = Rounded::new(problem)?;
    let found = sequences(&rounded.problem(problem), effort);
    let sequence = found.best.into_iter().next().unwrap_or_else(GoalSequence::empty);
    let services = Services::new(problem)?;
    let writer = Writer {
        problem,
        rounded: &rounded,
        services: &services,
        names: Names::new(problem, &services),
        // A mandatory goal that no sequence can hold would leave the problem without a plan.
        all_optional: sequence.missed > 0,
        title: name,
    };
    let (plan, cost) = writer.plan(&sequence, found.proof);
    Ok(PddlFiles {
        domain: writer.domain(),
        problem: writer.problem(),
        plan,
        cost,
        units: rounded.units,
        sequence,
        proof: found.proof,
    })
}

/// All numbers in whole cost units.
struct Rounded {
    units: u64,
    prizes: Vec<u64>,
    /// Cost of a candidate's place.
    places: Vec<u64>,
    /// Cost of each operator.
    operators: Vec<u64>,
    /// The cheapest alternative of each leg: its cost and number.
    legs: Vec<Vec<Option<(u64, usize)>>>,
    /// What leaving a mandatory goal out costs: more than any difference between plans.
    stake: u64,
    candidates: Vec<Candidate>,
    travel: TravelMatrix,
    domain: Domain,
}

impl Rounded {
    fn new(problem: &Problem<'_>) -> Result<Self, PddlError> {
        let mut units = PDDL_UNITS;
        loop {
            let rounded = Self::at(problem, units);
            match rounded {
                Some(rounded) => return Ok(rounded),
                None if units > 1 => units /= 10,
                None => {
                    let prizes: f64 = problem.candidates.iter().map(|c| c.prize).sum();
                    return Err(PddlError::TooLarge { most: prizes.max(MOST as f64) });
                }
            }
        }
    }

    /// With so many units; none if a plan could cost too many of them.
    fn at(problem: &Problem<'_>, units: u64) -> Option<Self> {
        let prices = problem.preferences.prices;
        let whole = |value: f64| {
            let scaled = (value * units as f64).round();
            (scaled <= MOST as f64).then_some(scaled.max(0.0) as u64)
        };
        let energy = |joules: f64| whole(prices.energy_per_j * joules);
        let leg = |cost: &CostVector| {
            whole(prices.risk * cost.neg_ln_r + prices.energy_per_j * cost.energy_j)
        };
        let list =
            |values: &mut dyn Iterator<Item = Option<u64>>| values.collect::<Option<Vec<_>>>();
        let prizes = list(&mut problem.candidates.iter().map(|c| whole(c.prize)))?;
        let places = list(&mut problem.candidates.iter().map(|c| energy(c.service.energy_j)))?;
        let operators =
            list(&mut problem.domain.operators().iter().map(|o| energy(o.cost.energy_j)))?;
        let nodes = problem.travel.nodes().len();
        let mut legs = Vec::new();
        for from in 0..nodes {
            let mut row = Vec::new();
            for to in 0..nodes {
                // Of several alternatives the cheapest is the only one that a plan needs.
                let ways = problem.travel.alternatives(from, to).iter().enumerate();
                let best = ways.filter_map(|(i, way)| Some((leg(way)?, i))).min();
                if best.is_none() && !problem.travel.alternatives(from, to).is_empty() {
                    return None;
                }
                row.push(best);
            }
            legs.push(row);
        }
        let most_leg = legs.iter().flatten().flatten().map(|(cost, _)| *cost).max().unwrap_or(0);
        // A service holds no operator twice in the same facts, but may hold one often in others: what it costs at most is
        // what the dearest one found costs.
        let services = Services::new(problem).ok()?;
        let most_service = services.most(&operators) + places.iter().max().unwrap_or(&0);
        let turns = prizes.len() as u64 + 1;
        let most = prizes.iter().sum::<u64>() + turns * (most_leg + most_service);
        let mandatory = problem.candidates.iter().filter(|c| c.mandatory).count() as u64;
        let stake = if mandatory > 0 { most + 1 } else { 0 };
        if most + mandatory * stake > MOST {
            return None;
        }
        let mut candidates = problem.candidates.to_vec();
        for (i, candidate) in candidates.iter_mut().enumerate() {
            candidate.prize = prizes[i] as f64;
            candidate.service =
                ServiceCost { energy_j: places[i] as f64, ..ServiceCost::default() };
            candidate.window = None;
            candidate.fade = None;
        }
        let travel = TravelMatrix::from_costs(problem.travel.nodes(), |from, to| {
            let cost =
                |(cost, _): (u64, usize)| CostVector { energy_j: cost as f64, ..CostVector::ZERO };
            legs[from][to].map(cost).into_iter().collect()
        });
        // Times stay as they are: they choose the operators.
        let domain = problem.domain.costed(|index, time_s| ServiceCost {
            time_s,
            energy_j: operators[index] as f64,
            data_mb: 0.0,
        });
        Some(Self { units, prizes, places, operators, legs, stake, candidates, travel, domain })
    }

    /// The rounded problem: each cost unit is a joule, and a joule costs one unit.
    fn problem<'a>(&'a self, problem: &Problem<'a>) -> Problem<'a> {
        let mut preferences = problem.preferences;
        preferences.prices = Prices { energy_per_j: 1.0, ..Prices::NONE };
        Problem {
            candidates: &self.candidates,
            travel: &self.travel,
            domain: &self.domain,
            limits: Limits {
                time_s: f64::INFINITY,
                energy_j: f64::INFINITY,
                data_mb: f64::INFINITY,
                min_reliability: 0.0,
            },
            waiting_w: 0.0,
            policy: Policy::NetBenefit,
            preferences,
            ..*problem
        }
    }
}

/// What operators serve which directive in which facts.
struct Services {
    states: Vec<FactSet>,
    /// By directive and state: the expansion.
    of: BTreeMap<(usize, usize), Expansion>,
    /// The series of operators, the drive among them, each with its number.
    series: BTreeMap<Vec<usize>, usize>,
}

impl Services {
    fn new(problem: &Problem<'_>) -> Result<Self, PddlError> {
        let directives: BTreeSet<usize> = problem.candidates.iter().map(|c| c.directive).collect();
        let mut services =
            Self { states: vec![problem.facts], of: BTreeMap::new(), series: BTreeMap::new() };
        let mut at = 0;
        while at < services.states.len() {
            if at >= MAX_STATES {
                return Err(PddlError::TooManyStates);
            }
            let state = services.states[at];
            for &d in &directives {
                let Directive { requires, achieves, .. } = &problem.directives[d];
                let expansion = state
                    .contains(*requires)
                    .then(|| problem.domain.expand(state, *achieves))
                    .flatten();
                let Some(expansion) = expansion else { continue };
                if !services.states.contains(&expansion.facts) {
                    services.states.push(expansion.facts);
                }
                let count = services.series.len();
                services.series.entry(Self::series(&expansion, problem.domain)).or_insert(count);
                services.of.insert((d, at), expansion);
            }
            at += 1;
        }
        Ok(services)
    }

    fn series(expansion: &Expansion, domain: &Domain) -> Vec<usize> {
        let Expansion { before, after, .. } = expansion;
        before.iter().copied().chain([domain.drive()]).chain(after.iter().copied()).collect()
    }

    fn state(&self, facts: FactSet) -> Option<usize> {
        self.states.iter().position(|s| *s == facts)
    }

    /// What the dearest series costs.
    fn most(&self, operators: &[u64]) -> u64 {
        self.series.keys().map(|s| s.iter().map(|&o| operators[o]).sum()).max().unwrap_or(0)
    }

    /// The operators that occur, and the drive.
    fn operators(&self, domain: &Domain) -> BTreeSet<usize> {
        self.series.keys().flatten().copied().chain([domain.drive()]).collect()
    }
}

/// Names that PDDL takes: each is used once, whatever their case.
struct Namer(BTreeSet<String>);

impl Namer {
    fn new(ranks: usize) -> Self {
        let own = "object number pose goal step rank directive and or not when forall exists imply \
                   either increase decrease assign define domain problem total-cost leg-cost \
                   place-cost end-cost prize at way end-way serves stay follows open turn waiting \
                   free todo then done ended settling settled rank-of next optional all-done \
                   end-plan end-at collect forgo";
        let ranks = (0..=ranks).map(|r| format!("r{r}"));
        Self(own.split_whitespace().map(str::to_owned).chain(ranks).collect())
    }

    /// A name like the one wished for.
    fn name(&mut self, wish: &str) -> String {
        let lower = wish.to_ascii_lowercase();
        let fits = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
        let mut name: String = lower.chars().map(fits).collect();
        while name.contains("--") {
            name = name.replace("--", "-");
        }
        let name = name.trim_matches(|c| c == '-' || c == '_');
        // Actions and predicates that are named after others begin so.
        let taken = ["take-up-", "begin-", "drive-", "stay-", "finish-", "does-"];
        let is_taken = taken.iter().any(|prefix| name.starts_with(prefix));
        let name = if name.starts_with(|c: char| c.is_ascii_lowercase()) && !is_taken {
            name.to_owned()
        } else {
            format!("x-{name}").trim_end_matches('-').to_owned()
        };
        let all = std::iter::once(name.clone()).chain((2..).map(|n| format!("{name}-{n}")));
        let free = all.into_iter().find(|n| !self.0.contains(n));
        let name = free.expect("some number is free");
        self.0.insert(name.clone());
        name
    }
}

/// What everything is called.
struct Names {
    facts: Vec<String>,
    operators: Vec<String>,
    /// Of the directives that some candidate follows.
    directives: BTreeMap<usize, String>,
    goals: Vec<String>,
    poses: Vec<String>,
    /// By series and place in it.
    steps: BTreeMap<(usize, usize), String>,
}

impl Names {
    fn new(problem: &Problem<'_>, services: &Services) -> Self {
        let mut namer = Namer::new(problem.candidates.len());
        let goals = problem.candidates.iter().map(|c| namer.name(&c.goal.to_string())).collect();
        let poses = (0..problem.travel.nodes().len()).map(|p| namer.name(&format!("p{p}")));
        let poses = poses.collect();
        let steps = services
            .series
            .iter()
            .flat_map(|(series, &number)| (0..series.len()).map(move |place| (number, place)))
            .map(|(number, place)| ((number, place), namer.name(&format!("s{number}-{place}"))))
            .collect();
        let facts = problem.domain.facts().iter().map(|f| namer.name(f)).collect();
        let operators = problem.domain.operators().iter().map(|o| namer.name(&o.name)).collect();
        let used: BTreeSet<usize> = problem.candidates.iter().map(|c| c.directive).collect();
        let directives =
            used.into_iter().map(|d| (d, namer.name(&problem.directives[d].name))).collect();
        Self { facts, operators, directives, goals, poses, steps }
    }
}

/// Puts lines together; what is written to a `String` is never refused.
macro_rules! line {
    ($text:expr, $($words:tt)*) => {{
        let _ = writeln!($text, $($words)*);
    }};
}

struct Writer<'a> {
    problem: &'a Problem<'a>,
    rounded: &'a Rounded,
    services: &'a Services,
    names: Names,
    all_optional: bool,
    title: &'a str,
}

/// An action in the making.
struct Action {
    name: String,
    parameters: &'static str,
    preconditions: Vec<String>,
    effects: Vec<String>,
}

impl Action {
    fn write(&self, text: &mut String) {
        line!(text, "\n  (:action {}", self.name);
        line!(text, "    :parameters ({})", self.parameters);
        line!(text, "    :precondition (and {})", self.preconditions.join(" "));
        line!(text, "    :effect (and {}))", self.effects.join(" "));
    }
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(ToString::to_string).collect()
}

impl Writer<'_> {
    /// The literals of a set of facts.
    fn facts(&self, set: FactSet) -> impl Iterator<Item = String> {
        let holds = move |bit: &usize| set.bits() >> bit & 1 == 1;
        (0..self.names.facts.len()).filter(holds).map(|bit| format!("({})", self.names.facts[bit]))
    }

    fn head(&self, text: &mut String, file: &str) {
        line!(text, "; {file}: {}", self.title.replace('\n', " "));
        line!(
            text,
            "; One decision of a rover as a problem of classical planning: the prizes of goals against the risk and"
        );
        line!(
            text,
            "; the energy of getting them (policy net-benefit). Limits of time, energy, data and reliability, and"
        );
        line!(
            text,
            "; windows, are left out: classical planners know none. {} cost units are one unit of prize.",
            self.rounded.units
        );
    }

    fn domain(&self) -> String {
        let mut text = String::new();
        let names = &self.names;
        let model = self.problem.domain;
        self.head(&mut text, "domain.pddl");
        line!(
            text,
            ";\n; A goal is taken up, one series of operators is begun and carried out with one drive in it, and the goal is"
        );
        line!(
            text,
            "; finished. Which series serves a directive depends on the facts that hold; it is the rover's own choice,"
        );
        line!(
            text,
            "; the quickest one. The drive clears the facts wanted: they speak of the place it leads to. When the plan has"
        );
        line!(
            text,
            "; ended, each goal is collected if it is done, or forgone at the cost of its prize."
        );
        for (kind, given, taken) in [
            ("fact", model.facts().to_vec(), &names.facts),
            (
                "operator",
                model.operators().iter().map(|o| o.name.clone()).collect(),
                &names.operators,
            ),
        ] {
            for (given, taken) in given.iter().zip(taken).filter(|(g, t)| g != t) {
                line!(text, "; {kind} {taken} is {given:?}");
            }
        }
        line!(text, "(define (domain rover)");
        line!(text, "  (:requirements :strips :typing :negative-preconditions :action-costs)");
        line!(text, "  (:types pose goal step rank directive - object)");
        let directives: Vec<&str> = names.directives.values().map(String::as_str).collect();
        let steps: Vec<&str> = names.steps.values().map(String::as_str).collect();
        line!(text, "  (:constants");
        if !directives.is_empty() {
            line!(text, "    {} - directive", directives.join(" "));
        }
        if !names.goals.is_empty() {
            line!(text, "    {} - goal", names.goals.join(" "));
        }
        line!(text, "    {} all-done - step", steps.join(" "));
        line!(text, "    r0 - rank)");
        line!(text, "  (:predicates");
        for fact in &names.facts {
            line!(text, "    ({fact})");
        }
        for o in self.services.operators(model) {
            line!(text, "    (does-{} ?q - step)", names.operators[o]);
        }
        line!(text, "    (then ?q ?r - step) (todo ?q - step)");
        line!(text, "    (at ?p - pose) (way ?from ?to - pose) (serves ?p - pose ?g - goal)");
        line!(
            text,
            "    (follows ?g - goal ?d - directive) (open ?g - goal) (turn ?g - goal) (done ?g - goal)"
        );
        line!(text, "    (free) (waiting) (ended) (optional ?g - goal) (settled ?g - goal)");
        line!(text, "    (settling ?r - rank) (rank-of ?g - goal ?r - rank) (next ?r ?s - rank)");
        if self.problem.ends.is_empty() {
            line!(text, "  )\n  (:functions (total-cost) - number");
        } else {
            line!(text, "    (end-way ?from ?to - pose))\n  (:functions (total-cost) - number");
            line!(text, "    (end-cost ?from ?to - pose) - number");
        }
        line!(
            text,
            "    (leg-cost ?from ?to - pose) - number (place-cost ?g - goal) - number (prize ?g - goal) - number)"
        );
        self.turns(&mut text);
        self.begins(&mut text);
        self.steps(&mut text);
        self.endings(&mut text);
        line!(text, ")");
        text
    }

    /// Taking up each goal, once, where no other is under way and none that it excludes is done.
    fn turns(&self, text: &mut String) {
        for (i, candidate) in self.problem.candidates.iter().enumerate() {
            let goal = &self.names.goals[i];
            let before: Option<Vec<usize>> =
                candidate.after.iter().map(|id| self.candidate(*id)).collect();
            // A goal that comes after one that is none of the candidates can never be done.
            let Some(before) = before else { continue };
            let mut preconditions = vec!["(free)".to_owned(), format!("(open {goal})")];
            preconditions.extend(before.iter().map(|&b| format!("(done {})", self.names.goals[b])));
            let excluded = self.problem.candidates.iter().enumerate().filter(|(j, other)| {
                *j != i
                    && (candidate.excludes.contains(&other.goal)
                        || other.excludes.contains(&candidate.goal))
            });
            preconditions
                .extend(excluded.map(|(j, _)| format!("(not (done {}))", self.names.goals[j])));
            let mut effects = words(&["(not (free))", "(waiting)"]);
            effects.extend([format!("(turn {goal})"), format!("(not (open {goal}))")]);
            let name = format!("take-up-{goal}");
            Action { name, parameters: "", preconditions, effects }.write(text);
        }
    }

    fn candidate(&self, goal: crate::GoalId) -> Option<usize> {
        self.problem.candidates.iter().position(|c| c.goal == goal)
    }

    fn begin(&self, directive: usize, state: usize) -> String {
        format!("begin-{}-{state}", self.names.directives[&directive])
    }

    /// Beginning the series that serves a directive in a state of the facts.
    fn begins(&self, text: &mut String) {
        let model = self.problem.domain;
        for (&(directive, state), expansion) in &self.services.of {
            let series = Services::series(expansion, model);
            let told: Vec<&str> =
                series.iter().map(|&o| model.operators()[o].name.as_str()).collect();
            line!(text, "\n  ; {}", told.join(", ").replace('\n', " "));
            let number = self.services.series[&series];
            let facts = self.services.states[state];
            let all = FactSet::from_bits(u64::MAX);
            let mut preconditions = words(&["(waiting)", "(turn ?g)"]);
            preconditions.push(format!("(follows ?g {})", self.names.directives[&directive]));
            preconditions.extend(self.facts(facts));
            preconditions.extend(self.facts(all.without(facts)).map(|f| format!("(not {f})")));
            let first = &self.names.steps[&(number, 0)];
            let effects = vec!["(not (waiting))".to_owned(), format!("(todo {first})")];
            let name = self.begin(directive, state);
            Action { name, parameters: "?g - goal", preconditions, effects }.write(text);
        }
    }

    /// What a fact set's change is as effects: adds win.
    fn change(&self, adds: FactSet, deletes: FactSet) -> impl Iterator<Item = String> {
        let gone = self.facts(deletes.without(adds)).map(|f| format!("(not {f})"));
        self.facts(adds).chain(gone)
    }

    /// The operators, each where its turn in a series has come, and the moment when a goal is done.
    fn steps(&self, text: &mut String) {
        let model = self.problem.domain;
        let turn = |operator: usize| {
            let name = &self.names.operators[operator];
            let mut conditions = words(&["(todo ?q)", "(then ?q ?r)"]);
            conditions.push(format!("(does-{name} ?q)"));
            conditions.extend(self.facts(model.operators()[operator].preconditions));
            conditions
        };
        for operator in self.services.operators(model) {
            if operator == model.drive() {
                continue;
            }
            let of = &model.operators()[operator];
            let mut effects = words(&["(not (todo ?q))", "(todo ?r)"]);
            effects.extend(self.change(of.adds, of.deletes));
            effects.extend(increase(self.rounded.operators[operator]));
            Action {
                name: self.names.operators[operator].clone(),
                parameters: "?q ?r - step",
                preconditions: turn(operator),
                effects,
            }
            .write(text);
        }
        let drive = &model.operators()[model.drive()];
        for (&directive, name) in &self.names.directives {
            let wanted = self.problem.directives[directive].achieves;
            let follows = format!("(follows ?g {name})");
            let mut conditions = turn(model.drive());
            conditions.extend(["(turn ?g)".to_owned(), follows.clone()]);
            let mut effects = words(&["(not (todo ?q))", "(todo ?r)"]);
            effects.extend(self.change(drive.adds.without(wanted), drive.deletes.with(wanted)));
            let with = |more: &[&str], list: &[String]| {
                list.iter().cloned().chain(words(more)).collect::<Vec<_>>()
            };
            Action {
                name: format!("drive-{name}"),
                parameters: "?g - goal ?from ?to - pose ?q ?r - step",
                preconditions: with(
                    &["(at ?from)", "(way ?from ?to)", "(serves ?to ?g)"],
                    &conditions,
                ),
                effects: with(
                    &[
                        "(not (at ?from))",
                        "(at ?to)",
                        "(increase (total-cost) (leg-cost ?from ?to))",
                    ],
                    &effects,
                ),
            }
            .write(text);
            // A goal that is served where the rover stands already: not to be left and reached at once.
            if self.stays().next().is_some() {
                Action {
                    name: format!("stay-{name}"),
                    parameters: "?g - goal ?p - pose ?q ?r - step",
                    preconditions: with(&["(at ?p)", "(way ?p ?p)", "(serves ?p ?g)"], &conditions),
                    effects: with(&["(increase (total-cost) (leg-cost ?p ?p))"], &effects),
                }
                .write(text);
            }
            let mut preconditions = words(&["(turn ?g)", "(todo all-done)"]);
            preconditions.push(follows);
            preconditions.extend(self.facts(wanted));
            Action {
                name: format!("finish-{name}"),
                parameters: "?g - goal",
                preconditions,
                effects: words(&[
                    "(not (turn ?g))",
                    "(not (todo all-done))",
                    "(free)",
                    "(done ?g)",
                    "(increase (total-cost) (place-cost ?g))",
                ]),
            }
            .write(text);
        }
    }

    fn endings(&self, text: &mut String) {
        let effects = words(&["(not (free))", "(ended)", "(settling r0)"]);
        if self.problem.ends.is_empty() {
            let name = "end-plan".to_owned();
            Action { name, parameters: "", preconditions: words(&["(free)"]), effects }.write(text);
        } else {
            let mut effects = effects;
            effects.push("(increase (total-cost) (end-cost ?from ?to))".to_owned());
            let preconditions = words(&["(free)", "(at ?from)", "(end-way ?from ?to)"]);
            let parameters = "?from ?to - pose";
            Action { name: "end-at".to_owned(), parameters, preconditions, effects }.write(text);
        }
        let settle = ["(settling ?r)", "(rank-of ?g ?r)", "(next ?r ?s)"];
        for (name, conditions, cost) in [
            ("collect", vec!["(done ?g)"], None),
            (
                "forgo",
                vec!["(optional ?g)", "(not (done ?g))"],
                Some("(increase (total-cost) (prize ?g))"),
            ),
        ] {
            let mut effects = words(&["(not (settling ?r))", "(settling ?s)", "(settled ?g)"]);
            effects.extend(cost.map(str::to_owned));
            Action {
                name: name.to_owned(),
                parameters: "?g - goal ?r ?s - rank",
                preconditions: settle.iter().chain(&conditions).map(ToString::to_string).collect(),
                effects,
            }
            .write(text);
        }
    }

    /// Poses that two goals share, or where the rover stands, and that can be driven to from themselves.
    fn stays(&self) -> impl Iterator<Item = usize> {
        let users = |p: usize| {
            let goals = self.problem.candidates.iter().filter(|c| c.poses.contains(&p)).count();
            goals + usize::from(p == 0 && goals > 0)
        };
        (0..self.names.poses.len()).filter(move |&p| users(p) > 1 && self.way(p, p).is_some())
    }

    /// Cost and alternative of a way that some goal may need.
    fn way(&self, from: usize, to: usize) -> Option<(u64, usize)> {
        let is_pose = self.problem.candidates.iter().any(|c| c.poses.contains(&to));
        self.rounded.legs[from][to].filter(|_| is_pose)
    }

    /// What leaving a goal out costs.
    fn forgone(&self, candidate: usize) -> u64 {
        let stake = if self.problem.candidates[candidate].mandatory && self.all_optional {
            self.rounded.stake
        } else {
            0
        };
        self.rounded.prizes[candidate] + stake
    }

    fn problem(&self) -> String {
        let mut text = String::new();
        let names = &self.names;
        self.head(&mut text, "problem.pddl");
        if self.all_optional {
            line!(
                text,
                "; No sequence holds all mandatory goals: each is optional at a cost above all others."
            );
        }
        line!(text, ";\n; Where the nodes lie (row, column):");
        for (name, cell) in names.poses.iter().zip(self.problem.travel.nodes()) {
            line!(text, ";   {name}: {}, {}", cell.row, cell.col);
        }
        line!(text, "(define (problem decision)\n  (:domain rover)\n  (:objects");
        line!(text, "    {} - pose", names.poses.join(" "));
        let ranks: Vec<String> = (1..=names.goals.len()).map(|r| format!("r{r}")).collect();
        if ranks.is_empty() {
            line!(text, "  )");
        } else {
            line!(text, "    {} - rank)", ranks.join(" "));
        }
        line!(text, "  (:init\n    (= (total-cost) 0)\n    (free) (at {})", names.poses[0]);
        for fact in self.facts(self.problem.facts) {
            line!(text, "    {fact}");
        }
        for (i, candidate) in self.problem.candidates.iter().enumerate() {
            let goal = &names.goals[i];
            let directive = &names.directives[&candidate.directive];
            line!(
                text,
                "    (open {goal}) (follows {goal} {directive}) (rank-of {goal} r{i}) (next r{i} r{})",
                i + 1
            );
            let optional = if !candidate.mandatory || self.all_optional {
                format!(" (optional {goal})")
            } else {
                String::new()
            };
            line!(
                text,
                "    (= (prize {goal}) {}) (= (place-cost {goal}) {}){optional}",
                self.forgone(i),
                self.rounded.places[i]
            );
            for pose in candidate.poses.iter().copied().collect::<BTreeSet<_>>() {
                line!(text, "    (serves {} {goal})", names.poses[pose]);
            }
        }
        for (series, number) in &self.services.series {
            for (place, &operator) in series.iter().enumerate() {
                let step = &names.steps[&(*number, place)];
                let next = names.steps.get(&(*number, place + 1)).map_or("all-done", |s| s);
                line!(text, "    (does-{} {step}) (then {step} {next})", names.operators[operator]);
            }
        }
        // What the driving operator itself costs is part of every leg.
        let own = self.rounded.operators[self.problem.domain.drive()];
        let stays: BTreeSet<usize> = self.stays().collect();
        for (from, leaving) in names.poses.iter().enumerate() {
            for (to, arriving) in names.poses.iter().enumerate() {
                if from == to && !stays.contains(&from) {
                    continue;
                }
                if let Some((cost, alternative)) = self.way(from, to) {
                    let cost = cost + own;
                    line!(
                        text,
                        "    (way {leaving} {arriving}) (= (leg-cost {leaving} {arriving}) {cost}) ; alternative {alternative}"
                    );
                }
            }
        }
        for (from, leaving) in names.poses.iter().enumerate() {
            for &to in self.problem.ends {
                if let Some((cost, _)) = self.rounded.legs[from][to] {
                    let arriving = &names.poses[to];
                    line!(
                        text,
                        "    (end-way {leaving} {arriving}) (= (end-cost {leaving} {arriving}) {cost})"
                    );
                }
            }
        }
        line!(text, "  )");
        let settled: Vec<String> = names.goals.iter().map(|g| format!(" (settled {g})")).collect();
        line!(text, "  (:goal (and (ended){}))", settled.concat());
        line!(text, "  (:metric minimize (total-cost)))");
        text
    }

    /// The plan of a sequence, and what it costs.
    fn plan(&self, sequence: &GoalSequence, proof: Proof) -> (String, u64) {
        let names = &self.names;
        let mut steps = String::new();
        let mut cost = 0;
        let mut facts = self.problem.facts;
        let mut at = 0;
        let mut done = BTreeSet::new();
        for stop in &sequence.stops {
            let i = self.candidate(stop.goal).expect("the search serves candidates");
            let directive = self.problem.candidates[i].directive;
            let name = &names.directives[&directive];
            let goal = &names.goals[i];
            let state = self.services.state(facts).expect("all states were reached");
            line!(steps, "(take-up-{goal})");
            line!(steps, "({} {goal})", self.begin(directive, state));
            let series = Services::series(&stop.expansion, self.problem.domain);
            let number = self.services.series[&series];
            for (place, &operator) in series.iter().enumerate() {
                let step = &names.steps[&(number, place)];
                let next = names.steps.get(&(number, place + 1)).map_or("all-done", |s| s);
                cost += self.rounded.operators[operator];
                if operator != self.problem.domain.drive() {
                    line!(steps, "({} {step} {next})", names.operators[operator]);
                    continue;
                }
                let (leg, _) = self.way(at, stop.pose).expect("the search takes ways there are");
                cost += leg;
                let (from, to) = (&names.poses[at], &names.poses[stop.pose]);
                if at == stop.pose {
                    line!(steps, "(stay-{name} {goal} {to} {step} {next})");
                } else {
                    line!(steps, "(drive-{name} {goal} {from} {to} {step} {next})");
                }
                at = stop.pose;
            }
            line!(steps, "(finish-{name} {goal})");
            cost += self.rounded.places[i];
            facts = stop.expansion.facts;
            done.insert(i);
        }
        match sequence.end {
            Some(end) => {
                let (leg, _) =
                    self.rounded.legs[at][end.pose].expect("the search takes ways there are");
                cost += leg;
                line!(steps, "(end-at {} {})", names.poses[at], names.poses[end.pose]);
            }
            None => line!(steps, "(end-plan)"),
        }
        for (i, goal) in names.goals.iter().enumerate() {
            if done.contains(&i) {
                line!(steps, "(collect {goal} r{i} r{})", i + 1);
            } else {
                cost += self.forgone(i);
                line!(steps, "(forgo {goal} r{i} r{})", i + 1);
            }
        }
        let known = match proof {
            Proof::Proven => "proven to be an optimum".to_owned(),
            Proof::Bound(bound) => format!(
                "not proven to be an optimum: the search was cut short; no plan costs less than {}",
                (self.prizes() - bound).ceil().clamp(0.0, cost as f64)
            ),
        };
        let mut text = String::new();
        line!(text, "; plan.txt: {}", self.title.replace('\n', " "));
        line!(text, "; Wisdom's plan for problem.pddl, {known}.");
        text.push_str(&steps);
        line!(text, "; cost = {cost} (general cost)");
        (text, cost)
    }

    /// All prizes together, in cost units.
    fn prizes(&self) -> f64 {
        (0..self.names.goals.len()).map(|i| self.forgone(i)).sum::<u64>() as f64
    }
}

/// The effect of an operator's cost, if it has one.
fn increase(cost: u64) -> Option<String> {
    (cost > 0).then(|| format!("(increase (total-cost) {cost})"))
}
