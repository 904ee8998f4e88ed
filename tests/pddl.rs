//! What is exported as PDDL means what the sequencer solved: a small interpreter of PDDL here, and planners and a
//! validator from outside where they can be had, agree with it on the optimum.

mod venv;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use wisdom_goals::{
    Candidate, Directive, Domain, Effort, GoalId, Limits, OperatorText, PddlFiles, Policy,
    Preferences, Prices, Problem, Proof, ServiceCost, pddl,
};
use wisdom_grid::Cell;
use wisdom_mission::Mission;
use wisdom_planner::{CostVector, TravelMatrix};

/// PDDL as lists of words.
#[derive(Debug, Clone, PartialEq)]
enum Expr {
    Word(String),
    List(Vec<Expr>),
}

impl Expr {
    fn parse(text: &str) -> Self {
        let plain: String = text
            .lines()
            .map(|line| line.split(';').next().unwrap_or_default().to_owned() + "\n")
            .collect();
        let spaced = plain.replace('(', " ( ").replace(')', " ) ");
        let mut open: Vec<Vec<Self>> = vec![Vec::new()];
        for word in spaced.split_whitespace() {
            match word {
                "(" => open.push(Vec::new()),
                ")" => {
                    let list = open.pop().expect("never more closed than opened");
                    open.last_mut()
                        .expect("a bracket closes what was opened")
                        .push(Self::List(list));
                }
                _ => open.last_mut().expect("the text itself").push(Self::Word(word.to_owned())),
            }
        }
        assert_eq!(open.len(), 1, "brackets are balanced");
        let mut all = open.remove(0);
        assert_eq!(all.len(), 1, "one definition");
        all.remove(0)
    }

    fn list(&self) -> &[Self] {
        match self {
            Self::List(list) => list,
            Self::Word(word) => panic!("`{word}` is no list"),
        }
    }

    fn word(&self) -> &str {
        match self {
            Self::Word(word) => word,
            Self::List(list) => panic!("{list:?} is no word"),
        }
    }

    fn head(&self) -> &str {
        self.list().first().map_or("", |first| match first {
            Self::Word(word) => word,
            Self::List(_) => "",
        })
    }

    /// The parts with this head.
    fn parts<'a>(&'a self, head: &'a str) -> impl Iterator<Item = &'a Self> {
        let lists = self.list().iter().filter(|e| matches!(e, Self::List(_)));
        lists.filter(move |e| e.head() == head)
    }
}

/// `a b - kind c - other`, as names with their kinds.
fn typed(words: &[Expr]) -> Vec<(String, String)> {
    let mut names = Vec::new();
    let mut typed = Vec::new();
    let mut words = words.iter().map(Expr::word);
    while let Some(word) = words.next() {
        if word == "-" {
            let kind = words.next().expect("a type follows the hyphen");
            typed.extend(names.drain(..).map(|name| (name, kind.to_owned())));
        } else {
            names.push(word.to_owned());
        }
    }
    assert!(names.is_empty(), "{names:?} have no type");
    typed
}

/// A predicate or function with its arguments.
type Atom = Vec<String>;

fn atom(expr: &Expr) -> Atom {
    expr.list().iter().map(|e| e.word().to_owned()).collect()
}

fn bound(atom: &Atom, binding: &BTreeMap<&str, &str>) -> Atom {
    atom.iter()
        .map(|w| binding.get(w.as_str()).map_or_else(|| w.clone(), |o| (*o).to_owned()))
        .collect()
}

struct Schema {
    parameters: Vec<(String, String)>,
    needs: Vec<Atom>,
    needs_not: Vec<Atom>,
    adds: Vec<Atom>,
    deletes: Vec<Atom>,
    /// Constants and functions that the cost is raised by.
    costs: Vec<Result<u64, Atom>>,
}

/// A domain and a problem, read from their text alone.
struct Task {
    kinds: BTreeMap<String, String>,
    actions: BTreeMap<String, Schema>,
    initial: BTreeSet<Atom>,
    functions: BTreeMap<Atom, u64>,
    goal: Vec<Atom>,
}

impl Task {
    fn read(domain: &str, problem: &str) -> Self {
        let (domain, problem) = (Expr::parse(domain), Expr::parse(problem));
        let part = |of: &Expr, head: &str| {
            of.parts(head).next().map_or(Vec::new(), |e| e.list()[1..].to_vec())
        };
        let kinds: BTreeMap<String, String> = typed(&part(&domain, ":constants"))
            .into_iter()
            .chain(typed(&part(&problem, ":objects")))
            .collect();
        // Every predicate that is used is declared, with as many arguments.
        let arities: BTreeMap<String, usize> = part(&domain, ":predicates")
            .iter()
            .map(|p| (p.head().to_owned(), typed(&p.list()[1..]).len()))
            .collect();
        let check = |atom: Atom| {
            assert_eq!(arities.get(&atom[0]), Some(&(atom.len() - 1)), "{atom:?}");
            atom
        };
        let conjuncts = |expr: &Expr| -> (Vec<Atom>, Vec<Atom>, Vec<Expr>) {
            assert_eq!(expr.head(), "and");
            let (mut yes, mut no, mut other) = (Vec::new(), Vec::new(), Vec::new());
            for e in &expr.list()[1..] {
                match e.head() {
                    "not" => no.push(check(atom(&e.list()[1]))),
                    "increase" => other.push(e.list()[2].clone()),
                    _ => yes.push(check(atom(e))),
                }
            }
            (yes, no, other)
        };
        let mut actions = BTreeMap::new();
        for action in domain.parts(":action") {
            let [_, name, _, parameters, _, precondition, _, effect] = action.list() else {
                panic!("{action:?}")
            };
            let (needs, needs_not, _) = conjuncts(precondition);
            let (adds, deletes, costs) = conjuncts(effect);
            let costs = costs.iter().map(|c| match c {
                Expr::Word(number) => Ok(number.parse().expect("whole costs")),
                Expr::List(_) => Err(atom(c)),
            });
            let costs = costs.collect();
            let parameters = typed(parameters.list());
            let schema = Schema { parameters, needs, needs_not, adds, deletes, costs };
            assert!(actions.insert(name.word().to_owned(), schema).is_none(), "{name:?} twice");
        }
        let (mut initial, mut functions) = (BTreeSet::new(), BTreeMap::new());
        for e in part(&problem, ":init") {
            if e.head() == "=" {
                functions.insert(atom(&e.list()[1]), e.list()[2].word().parse().expect("whole"));
            } else {
                initial.insert(check(atom(&e)));
            }
        }
        let (goal, _, _) = conjuncts(&part(&problem, ":goal")[0]);
        Self { kinds, actions, initial, functions, goal }
    }

    fn cost(&self, schema: &Schema, binding: &BTreeMap<&str, &str>) -> u64 {
        let of = |cost: &Result<u64, Atom>| match cost {
            Ok(number) => *number,
            Err(function) => {
                let function = bound(function, binding);
                *self
                    .functions
                    .get(&function)
                    .unwrap_or_else(|| panic!("{function:?} has no value"))
            }
        };
        schema.costs.iter().map(of).sum()
    }

    /// Carries a plan out and says what it costs, or where it fails.
    fn carry_out<'a>(&self, plan: impl IntoIterator<Item = &'a str>) -> Result<u64, String> {
        let mut state = self.initial.clone();
        let mut total = 0;
        for line in plan {
            let words: Vec<&str> = line.trim_matches(['(', ')']).split_whitespace().collect();
            let schema = self.actions.get(words[0]).ok_or(format!("no action {line}"))?;
            if schema.parameters.len() != words.len() - 1 {
                return Err(format!("{line}: wrong number of objects"));
            }
            let mut binding = BTreeMap::new();
            for ((variable, kind), object) in schema.parameters.iter().zip(&words[1..]) {
                if self.kinds.get(*object) != Some(kind) {
                    return Err(format!("{line}: {object} is no {kind}"));
                }
                binding.insert(variable.as_str(), *object);
            }
            let holds = |a: &Atom| state.contains(&bound(a, &binding));
            if !schema.needs.iter().all(holds) || schema.needs_not.iter().any(holds) {
                return Err(format!("{line}: is not possible"));
            }
            for gone in &schema.deletes {
                state.remove(&bound(gone, &binding));
            }
            state.extend(schema.adds.iter().map(|a| bound(a, &binding)));
            total += self.cost(schema, &binding);
        }
        let reached = self.goal.iter().all(|g| state.contains(g));
        reached.then_some(total).ok_or("the goal is not reached".to_owned())
    }

    /// All ground actions that what never changes allows.
    fn ground(&self) -> Vec<Ground> {
        let changed: BTreeSet<&str> = self
            .actions
            .values()
            .flat_map(|a| a.adds.iter().chain(&a.deletes))
            .map(|a| a[0].as_str())
            .collect();
        let mut all = Vec::new();
        for schema in self.actions.values() {
            let mut bindings: Vec<BTreeMap<&str, &str>> = vec![BTreeMap::new()];
            for (variable, kind) in &schema.parameters {
                let mut longer = Vec::new();
                for binding in &bindings {
                    for (object, _) in self.kinds.iter().filter(|(_, k)| *k == kind) {
                        let mut binding = binding.clone();
                        binding.insert(variable, object);
                        let is_known =
                            |a: &Atom| !bound(a, &binding).iter().any(|w| w.starts_with('?'));
                        let possible = schema
                            .needs
                            .iter()
                            .filter(|a| !changed.contains(a[0].as_str()) && is_known(a))
                            .all(|a| self.initial.contains(&bound(a, &binding)));
                        if possible {
                            longer.push(binding);
                        }
                    }
                }
                bindings = longer;
            }
            for binding in &bindings {
                let of = |atoms: &[Atom]| -> Vec<Atom> {
                    atoms.iter().map(|a| bound(a, binding)).collect()
                };
                all.push(Ground {
                    needs: of(&schema.needs),
                    needs_not: of(&schema.needs_not),
                    adds: of(&schema.adds),
                    deletes: of(&schema.deletes),
                    cost: self.cost(schema, binding),
                });
            }
        }
        all
    }

    /// The least total cost of any plan, found by going through all states (Dijkstra).
    fn optimum(&self) -> Option<u64> {
        let actions = self.ground();
        let mut best: BTreeMap<BTreeSet<Atom>, u64> = BTreeMap::from([(self.initial.clone(), 0)]);
        let mut open = BinaryHeap::from([Reverse((0, self.initial.clone()))]);
        while let Some(Reverse((cost, state))) = open.pop() {
            if cost > best[&state] {
                continue;
            }
            if self.goal.iter().all(|g| state.contains(g)) {
                return Some(cost);
            }
            for action in &actions {
                let holds = |a: &Atom| state.contains(a);
                if !action.needs.iter().all(holds) || action.needs_not.iter().any(holds) {
                    continue;
                }
                let mut next = state.clone();
                for gone in &action.deletes {
                    next.remove(gone);
                }
                next.extend(action.adds.iter().cloned());
                let price = cost + action.cost;
                if best.get(&next).is_none_or(|known| price < *known) {
                    best.insert(next.clone(), price);
                    open.push(Reverse((price, next)));
                }
            }
        }
        None
    }
}

struct Ground {
    needs: Vec<Atom>,
    needs_not: Vec<Atom>,
    adds: Vec<Atom>,
    deletes: Vec<Atom>,
    cost: u64,
}

/// The actions of a plan's text, and the cost that it names.
fn plan(text: &str) -> (Vec<&str>, u64) {
    let actions = text.lines().filter(|l| l.starts_with('(')).collect();
    let cost = text.lines().find_map(|l| l.strip_prefix("; cost = ")).expect("it names its cost");
    let cost = cost.split(' ').next().and_then(|n| n.parse().ok()).expect("a whole number");
    (actions, cost)
}

/// `SplitMix64` (Steele, Lea and Flood 2014): instances from one number.
struct Draws(u64);

impl Draws {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    fn happens(&mut self, chance: f64) -> bool {
        self.unit() < chance
    }
}

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(ToString::to_string).collect()
}

/// An arm that must be stowed to drive, a calibration that drilling spoils, a lamp that drilling lights; some names are
/// not PDDL's.
fn domain() -> Domain {
    let operator =
        |name: &str, [pre, add, del]: [&[&str]; 3], time_s: f64, energy_j: f64| OperatorText {
            name: name.into(),
            preconditions: names(pre),
            adds: names(add),
            deletes: names(del),
            cost: ServiceCost { time_s, energy_j, data_mb: 1.0 },
        };
    let operators = [
        operator("drive", [&["Stowed"], &["at-site"], &["lit"]], 5.0, 100.0),
        operator("stow", [&["out"], &["Stowed"], &["out"]], 30.0, 500.0),
        operator("unstow", [&["Stowed"], &["out"], &["Stowed"]], 40.0, 700.0),
        operator("calibrate(apxs)", [&["out"], &["calibrated(apxs)"], &[]], 100.0, 3000.0),
        operator(
            "analyse",
            [&["at-site", "out", "calibrated(apxs)"], &["done"], &["lit"]],
            600.0,
            9e3,
        ),
        operator("object", [&["at-site", "Stowed"], &["imaged"], &[]], 60.0, 2e3),
        operator(
            "drill",
            [&["at-site", "out"], &["drilled", "lit"], &["calibrated(apxs)"]],
            300.0,
            5e4,
        ),
    ];
    Domain::new(&operators, &names(&["Stowed"])).expect("the operators fit each other")
}

/// A problem and what it borrows.
struct Instance {
    candidates: Vec<Candidate>,
    travel: TravelMatrix,
    ends: Vec<usize>,
    domain: Domain,
    directives: Vec<Directive>,
    preferences: Preferences,
}

impl Instance {
    fn drawn(goals: usize, seed: u64) -> Self {
        let mut draws = Draws(seed);
        let base = Mission::load(&root("missions/paper"), &[]).expect("it ships").spec.directives;
        let domain = domain();
        let directive = |name: &str, requires: &[&str], achieves: &[&str]| {
            let mut directive = base[0].clone();
            directive.name = name.into();
            directive.substitute = None;
            directive.requires = domain.set(&names(requires)).expect("facts");
            directive.achieves = domain.set(&names(achieves)).expect("facts");
            directive
        };
        let directives = vec![
            directive("analyse", &[], &["done"]),
            directive("take a picture", &[], &["imaged"]),
            directive("drill", &["imaged"], &["drilled"]),
        ];
        // Some poses are shared, some goals lie where the rover stands.
        let nodes = 1 + goals + goals / 2;
        let mut candidates: Vec<Candidate> = (0..goals)
            .map(|i| {
                let poses: BTreeSet<usize> =
                    (0..=draws.below(2)).map(|_| draws.below(nodes)).collect();
                let prize = 0.2 + 1.5 * draws.unit();
                let poses = poses.into_iter().collect();
                let mut candidate = Candidate::new(GoalId(i as u32), draws.below(3), prize, poses);
                candidate.mandatory = draws.happens(0.15);
                candidate.service.energy_j = if draws.happens(0.3) { 5e3 } else { 0.0 };
                candidate
            })
            .collect();
        if draws.happens(0.4) {
            candidates[0].excludes.push(GoalId(1));
        }
        if draws.happens(0.4) {
            candidates[1].after.push(GoalId(2));
        }
        if draws.happens(0.1) {
            candidates[2].after.push(GoalId(77));
        }
        let cells: Vec<Cell> = (0..nodes).map(|col| Cell::new(0, col)).collect();
        let travel = TravelMatrix::from_costs(&cells, |from, to| {
            let ways = if from == to { 1 } else { [0, 1, 1, 2, 2][draws.below(5)] };
            let way = |_| CostVector {
                length_m: 1.0,
                time_s: 10.0,
                energy_j: if from == to { 0.0 } else { 5e4 * draws.unit() },
                neg_ln_r: if from == to { 0.0 } else { 0.5 * draws.unit() },
            };
            (0..ways).map(way).collect()
        });
        let ends = if draws.happens(0.3) { vec![0, draws.below(nodes)] } else { Vec::new() };
        let prices = Prices {
            risk: 1.0,
            energy_per_j: if draws.happens(0.7) { 5e-6 } else { 0.0 },
            ..Prices::NONE
        };
        let preferences = Preferences { prices, ..Preferences::default() };
        Self { candidates, travel, ends, domain, directives, preferences }
    }

    fn files(&self) -> PddlFiles {
        let problem = Problem {
            candidates: &self.candidates,
            travel: &self.travel,
            ends: &self.ends,
            domain: &self.domain,
            directives: &self.directives,
            facts: self.domain.initial(),
            // Limits that nothing could be done in: they are not part of what is exported.
            limits: Limits { time_s: 0.0, energy_j: 0.0, data_mb: 0.0, min_reliability: 1.0 },
            waiting_w: 0.0,
            policy: Policy::ExpectedInterest,
            preferences: self.preferences,
        };
        let effort = Effort { expansions: 1_000_000, keep: 1, first: &[], clock: None };
        pddl(&problem, "an instance of the tests", effort).expect("it can be written")
    }
}

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Reads the files back, carries the plan out and returns the task.
fn checked(files: &PddlFiles) -> Task {
    let task = Task::read(&files.domain, &files.problem);
    let (actions, cost) = plan(&files.plan);
    assert_eq!(cost, files.cost);
    assert_eq!(task.carry_out(actions), Ok(files.cost), "{}", files.plan);
    task
}

#[test]
fn our_plan_is_the_optimum_of_what_is_written() {
    let (mut done, mut forgone, mut stays, mut missed) = (0, 0, 0, 0);
    for seed in 0..120 {
        let instance = Instance::drawn(3 + seed as usize % 2, seed);
        let files = instance.files();
        assert_eq!(files.proof, Proof::Proven);
        let task = checked(&files);
        let no_end = !instance.ends.is_empty() && files.sequence.end.is_none();
        assert!(!no_end, "the rover stands at an end");
        assert_eq!(
            task.optimum(),
            Some(files.cost),
            "seed {seed}\n{}\n{}",
            files.problem,
            files.plan
        );
        done += files.sequence.stops.len();
        forgone += files.plan.matches("(forgo").count();
        stays += files.plan.matches("(stay").count();
        missed += files.sequence.missed;
    }
    // The instances hold something of everything.
    assert!(
        done > 120 && forgone > 60 && stays > 5 && missed > 3,
        "{done} {forgone} {stays} {missed}"
    );
}

#[test]
fn a_plan_that_skips_an_operator_is_refused_by_the_interpreter() {
    let files = Instance::drawn(4, 5).files();
    let task = checked(&files);
    let (actions, _) = plan(&files.plan);
    for left_out in 0..actions.len() {
        let shorter = actions.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, a)| *a);
        assert!(task.carry_out(shorter).is_err(), "{} is not needed", actions[left_out]);
    }
}

fn wisdom(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_wisdom")).args(args).output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {said}");
    String::from_utf8(output.stdout).expect("text")
}

/// A log of the paper's mission with few goals a decision, made once for this process.
fn paper_log(folder: &Path) -> String {
    let log = folder.join("paper.mcap").display().to_string();
    let mission = root("missions/paper").display().to_string();
    // With a price on energy the operators cost something.
    let price = "objective.price-per-kj=0.001";
    wisdom(&[
        "run",
        &mission,
        "--set",
        "goals.max-sequenced=5",
        "--set",
        price,
        "--log",
        &log,
        "--json",
    ]);
    log
}

fn read(folder: &Path) -> PddlFilesText {
    let text = |name: &str| fs::read_to_string(folder.join(name)).expect("it was written");
    PddlFilesText {
        domain: text("domain.pddl"),
        problem: text("problem.pddl"),
        plan: text("plan.txt"),
    }
}

struct PddlFilesText {
    domain: String,
    problem: String,
    plan: String,
}

#[test]
fn a_logged_decision_is_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = paper_log(folder.path());
    let out = folder.path().join("out");
    let told =
        wisdom(&["export", "pddl", &log, "--decision", "1", "-o", &out.display().to_string()]);
    assert!(told.contains("without limits") && told.contains("The decision itself"), "{told}");
    let files = read(&out);
    let task = Task::read(&files.domain, &files.problem);
    let (actions, cost) = plan(&files.plan);
    assert_eq!(task.carry_out(actions), Ok(cost));
    assert!(told.contains(&format!("total cost {cost} ")), "{told}");
    let readme = fs::read_to_string(out.join("README.txt")).expect("it was written");
    assert!(readme.contains("pyval domain.pddl problem.pddl plan.txt"), "{readme}");
    // An older export is written over, other files are not.
    wisdom(&["export", "pddl", &log, "--decision", "0", "-o", &out.display().to_string()]);
    fs::write(out.join("plan.txt"), "my own").expect("a file");
    let args = ["export", "pddl", &log, "--decision", "0", "-o", &out.display().to_string()];
    let refused = Command::new(env!("CARGO_BIN_EXE_wisdom")).args(args).output().expect("it runs");
    assert_eq!(refused.status.code(), Some(2));
    let missing = ["export", "pddl", &log, "--decision", "9999", "-o", "nowhere"];
    let refused =
        Command::new(env!("CARGO_BIN_EXE_wisdom")).args(missing).output().expect("it runs");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no decision 9999"));
    let dot = wisdom(&["export", "dot", &log, "--decision", "0"]);
    assert!(dot.starts_with("digraph") && dot.contains("subgraph \"cluster G"), "{dot}");
    assert_eq!(dot, wisdom(&["replay", &log, "--decision", "0", "--dot"]));
    let file = folder.path().join("links.dot").display().to_string();
    wisdom(&["export", "dot", &log, "--decision", "0", "-o", &file]);
    assert_eq!(fs::read_to_string(&file).expect("it was written"), dot);
}

/// Solves each folder's problem and validates its plan; a line for each, then the planner's own plan.
const OUTSIDE: &str = r#"
import subprocess, sys, warnings
warnings.simplefilter("ignore")
from unified_planning.io import PDDLReader
from unified_planning.shortcuts import OneshotPlanner, get_environment
get_environment().credits_stream = None
for folder in sys.argv[1:]:
    domain, problem, plan = (f"{folder}/{n}" for n in ("domain.pddl", "problem.pddl", "plan.txt"))
    task = PDDLReader().parse_problem(domain, problem)
    with OneshotPlanner(name="fast-downward-opt") as planner:
        result = planner.solve(task, timeout=30)
    valid = subprocess.run(["PYVAL", domain, problem, plan], capture_output=True)
    print("FOLDER", folder, result.status.name, "valid" if valid.returncode == 0 else "invalid", flush=True)
    for action in (result.plan.actions if result.plan else []):
        words = [action.action.name] + [str(p) for p in action.actual_parameters]
        print("(" + " ".join(words) + ")", flush=True)
"#;

/// The planner and the validator.
const OUTSIDERS: [&str; 3] =
    ["unified-planning==1.3.0", "up-fast-downward==1.0.0", "pddl-pyvalidator==0.1.5"];

#[test]
fn outside_planners_agree_on_the_optimum() {
    let programs = match venv::environment("pddl-venv", &OUTSIDERS) {
        Ok(programs) => programs,
        Err(why) => {
            println!("skipped: outside_planners_agree_on_the_optimum: {why}");
            return;
        }
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut folders = Vec::new();
    let log = paper_log(folder.path());
    for decision in ["0", "2", "4"] {
        let out = folder.path().join(format!("paper-decision-{decision}"));
        wisdom(&["export", "pddl", &log, "--decision", decision, "-o", &out.display().to_string()]);
        folders.push(out);
    }
    for (goals, seed) in [(3, 1), (3, 2), (4, 3), (4, 4), (5, 5), (5, 6), (6, 7), (6, 8)] {
        let out = folder.path().join(format!("drawn-{goals}-goals-{seed}"));
        fs::create_dir(&out).expect("a folder");
        let files = Instance::drawn(goals, seed).files();
        assert_eq!(files.proof, Proof::Proven);
        for (name, text) in [
            ("domain.pddl", &files.domain),
            ("problem.pddl", &files.problem),
            ("plan.txt", &files.plan),
        ] {
            fs::write(out.join(name), text).expect("a file");
        }
        folders.push(out);
    }
    let script = OUTSIDE.replace("PYVAL", &programs.join("pyval").display().to_string());
    let output = Command::new(programs.join("python"))
        .args(["-c", &script])
        .args(&folders)
        .output()
        .expect("Python runs");
    let told = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
    let answers: Vec<&str> = told.split("FOLDER ").skip(1).collect();
    assert_eq!(answers.len(), folders.len(), "{told}");
    for (answer, folder) in answers.into_iter().zip(&folders) {
        let mut lines = answer.lines();
        let head: Vec<&str> = lines.next().expect("a line").split(' ').collect();
        let [_, status, validity] = head[..] else { panic!("{answer}") };
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        let files = read(folder);
        let (_, ours) = plan(&files.plan);
        // What the planner found is carried out here, by another reader of the same files.
        let theirs = Task::read(&files.domain, &files.problem)
            .carry_out(lines.filter(|l| l.starts_with('(')));
        println!(
            "{name}: ours {ours}, fast-downward-opt {theirs:?} {status}, pyval: our plan is {validity}"
        );
        assert_eq!(status, "SOLVED_OPTIMALLY", "{name}");
        assert_eq!(validity, "valid", "{name}");
        assert_eq!(theirs, Ok(ours), "{name}");
    }
}
