//! A little theatre: ground drawn by hand, a rover that is told what the drawing shows, and a check of every decision
//! that it takes.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::collections::{BTreeMap, BTreeSet};

use wisdom_autonomy::{
    Act, ApproachSpec, Autonomy, Budget, Decision, Fallback, LayerSpec, LayerWindow, MapUpdate,
    Message, Observation, Outcome as Told, Pose, RouteSpec, Source, Spec, Spent, StepResult,
    Trigger, Triggers, Word,
};
use wisdom_belief::Opinion;
use wisdom_fusion::{Band, Expert, Fusion, LookupTable, Rows};
use wisdom_goals::{
    Action, Directive, Domain, Extraction, FactSet, GoalId, Kind, ManagerSpec, OperatorText,
    Outcome, Policy, Preferences, PrizeScale, Reason, ServiceCost, Status, Term, Transformation,
    Verdict,
};
use wisdom_grid::{Cell, GridSpec, Window};
use wisdom_planner::{CostVector, Route, Vehicle};

/// How deep a cell drawn as `#` lies, metres. It and the cells beside it are a step too high; the eye sees across.
pub(crate) const PIT_M: f32 = -5.0;
/// How much one letter is higher than the letter before it, metres.
const LETTER_M: f32 = 0.2;

/// A drawing: `0` to `9` is how interesting a reading says a cell is, `.` is dull, `?` was not seen, `#` is a pit, and in a
/// drawing of heights `a` is level, `b` higher. Any other sign marks a place on dull ground.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    rows: Vec<Vec<char>>,
}

impl Drawing {
    pub(crate) fn of(text: &str) -> Self {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let rows: Vec<Vec<char>> = lines.map(|line| line.chars().collect()).collect();
        assert!(rows.iter().all(|row| row.len() == rows[0].len()), "a drawing is a rectangle");
        Self { rows }
    }

    fn window(&self) -> Window {
        Window { row: 0, col: 0, rows: self.rows.len(), cols: self.rows[0].len() }
    }

    fn at(&self, cell: Cell) -> char {
        self.rows[cell.row][cell.col]
    }

    /// The first cell that bears a sign.
    pub(crate) fn find(&self, sign: char) -> Cell {
        self.window().cells().find(|&cell| self.at(cell) == sign).expect("the sign is drawn")
    }
}

/// The first cell of a drawing that bears a sign.
pub(crate) fn place(picture: &str, sign: char) -> Cell {
    Drawing::of(picture).find(sign)
}

/// What one look shows.
#[derive(Debug, Clone)]
pub(crate) struct Look {
    glow: Drawing,
    u: f32,
    doubts: Option<Drawing>,
    ground_u: f32,
    heights: Option<Drawing>,
    trace: Option<(Drawing, f32)>,
    soil: Option<(Drawing, f32)>,
}

impl Look {
    /// Readings of the glow, and the pits in the ground, all with one uncertainty.
    pub(crate) fn of(picture: &str, u: f32) -> Self {
        let glow = Drawing::of(picture);
        Self { glow, u, doubts: None, ground_u: u, heights: None, trace: None, soil: None }
    }

    /// Another uncertainty of the heights.
    pub(crate) fn ground(self, ground_u: f32) -> Self {
        Self { ground_u, ..self }
    }

    /// Heights by letter.
    pub(crate) fn heights(self, picture: &str) -> Self {
        Self { heights: Some(Drawing::of(picture)), ..self }
    }

    /// Tenths of uncertainty of the glow where a digit is drawn.
    pub(crate) fn doubts(self, picture: &str) -> Self {
        Self { doubts: Some(Drawing::of(picture)), ..self }
    }

    /// Readings of the second instrument.
    pub(crate) fn trace(self, picture: &str, u: f32) -> Self {
        Self { trace: Some((Drawing::of(picture), u)), ..self }
    }

    /// Classes of the ground.
    pub(crate) fn soil(self, picture: &str, u: f32) -> Self {
        Self { soil: Some((Drawing::of(picture), u)), ..self }
    }

    fn windows(&self) -> Vec<LayerWindow> {
        let window = self.glow.window();
        let layer = |name: &str, value: &dyn Fn(Cell) -> f32, u: &dyn Fn(Cell) -> f32| {
            let (values, uncertainty) = window.cells().map(|c| (value(c), u(c))).unzip();
            LayerWindow { layer: name.into(), window, values, uncertainty }
        };
        let digit = |drawing: &Drawing, cell: Cell| drawing.at(cell).to_digit(10);
        let seen = |drawing: &Drawing, cell: Cell, u: f32| {
            if drawing.at(cell) == '?' { 1.0 } else { u }
        };
        let height = |cell: Cell| {
            let letter = self.heights.as_ref().map_or('a', |heights| heights.at(cell));
            let up = if letter.is_ascii_lowercase() { letter as u8 - b'a' } else { 0 };
            if self.glow.at(cell) == '#' { PIT_M } else { LETTER_M * f32::from(up) }
        };
        let middle = |drawing: &Drawing, cell: Cell| digit(drawing, cell).unwrap_or(0) as f32 + 0.5;
        let doubt = |cell: Cell| {
            let tenths = self.doubts.as_ref().and_then(|doubts| digit(doubts, cell));
            seen(&self.glow, cell, tenths.map_or(self.u, |tenths| tenths as f32 / 10.0))
        };
        let mut windows = vec![
            layer("elevation", &height, &|cell| seen(&self.glow, cell, self.ground_u)),
            layer("glow", &|cell| middle(&self.glow, cell), &doubt),
        ];
        if let Some((trace, u)) = &self.trace {
            windows.push(layer("trace", &|c| middle(trace, c), &|c| seen(trace, c, *u)));
        }
        if let Some((soil, u)) = &self.soil {
            let class = |cell: Cell| digit(soil, cell).unwrap_or(0) as f32;
            windows.push(layer("soil", &class, &|c| seen(soil, c, *u)));
        }
        windows
    }
}

/// An expert that believes a tenth of what it reads, from 0 to 10, and is against the rest.
fn expert(name: &str) -> Expert {
    let band = |i: u32| {
        let interesting = f64::from(i) / 10.0;
        let opinion = Opinion { paradox: 0.0, not_interesting: 1.0 - interesting, interesting };
        Band { lo: f64::from(i), hi: f64::from(i + 1), opinion }
    };
    let outside = Opinion { paradox: 0.0, not_interesting: 1.0, interesting: 0.0 };
    let rows = Rows::Bands((0..10).map(band).collect());
    let table = LookupTable::new(name, name, "", rows, outside).expect("sound bands");
    Expert { name: name.into(), layer: name.into(), table }
}

/// What the rover of the theatre can do.
fn domain() -> Domain {
    let names = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
    let operator = |name: &str, needs: &[&str], adds: &[&str], time_s: f64, energy_j: f64| {
        let cost = ServiceCost { time_s, energy_j, data_mb: 0.0 };
        OperatorText {
            name: name.into(),
            preconditions: names(needs),
            adds: names(adds),
            deletes: vec![],
            cost,
        }
    };
    let operators = [
        operator("drive", &[], &[], 0.0, 0.0),
        operator("raise", &[], &["mast-up"], 30.0, 500.0),
        operator("image", &["mast-up"], &["imaged"], 60.0, 1000.0),
        operator("sample", &["arm-works"], &["sampled"], 600.0, 60_000.0),
        operator("look", &[], &["looked"], 60.0, 1000.0),
        operator("judge", &[], &["judged"], 60.0, 1000.0),
    ];
    Domain::new(&operators, &names(&["mast-up", "arm-works"])).expect("a sound domain")
}

fn fact(name: &str) -> FactSet {
    domain().set(&[name.to_owned()]).expect("a fact of the domain")
}

/// A directive to carry out the operator of a name: `image`, `sample`, `look` or `judge`.
pub(crate) fn directive(operator: &str) -> Directive {
    let (kind, achieves) = match operator {
        "image" => (Kind::Inspect, "imaged"),
        "sample" => (Kind::Inspect, "sampled"),
        "look" => (Kind::LookAgain, "looked"),
        "judge" => (Kind::Adjudicate, "judged"),
        other => panic!("`{other}` is no operator of the theatre"),
    };
    Directive {
        kind,
        min_interest: if kind == Kind::Inspect { 0.2 } else { 0.0 },
        min_signal: 0.2,
        standoff_m: 1.0,
        exclusion_radius_m: 2.0,
        ..Directive::new(operator, fact(achieves))
    }
}

/// A layer of the theatre that new readings meet in some way.
pub(crate) fn updated(spec: Spec, layer: &str, update: MapUpdate) -> Spec {
    let layers = spec.layers.into_iter().map(|known| {
        let source = if known.name == layer { Source::Measured(update) } else { known.source };
        LayerSpec { source, ..known }
    });
    Spec { layers: layers.collect(), ..spec }
}

/// A mission on the ground of a drawing whose home is at `R`, with one directive: to take an image.
pub(crate) fn spec(picture: &str) -> Spec {
    let drawing = Drawing::of(picture);
    let Window { rows, cols, .. } = drawing.window();
    let layer = |name: &str, unit: &str| LayerSpec {
        name: name.into(),
        unit: unit.into(),
        source: Source::Measured(MapUpdate::Best),
    };
    Spec {
        working_cells: None,
        grid: GridSpec::new(rows, cols, 1.0).expect("a small grid"),
        layers: vec![
            layer("elevation", "m"),
            layer("glow", ""),
            layer("trace", ""),
            layer("soil", ""),
        ],
        experts: vec![expert("glow"), expert("trace")],
        fusion: Fusion::default(),
        prize: PrizeScale::Belief,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
        domain: domain(),
        directives: vec![directive("image")],
        manager: ManagerSpec {
            identity_radius_m: 2.0,
            extraction: Extraction { min_separation_m: 2.0, ..Extraction::default() },
            ..ManagerSpec::default()
        },
        vehicle: Vehicle {
            step_max_m: 1.0,
            slope_max_deg: 45.0,
            roughness_max_m: 1.0,
            ..Vehicle::default()
        },
        class_layer: Some("soil".into()),
        close_look: BTreeMap::new(),
        slip_layer: None,
        routes: RouteSpec::default(),
        budget: Budget {
            time_s: 1e6,
            energy_j: 1e8,
            reserve_j: 0.0,
            data_mb: f64::INFINITY,
            min_reliability: 0.5,
        },
        triggers: Triggers::default(),
        fallback: Fallback {
            max_looks: 0,
            look_range_m: 3.0,
            min_ignorance: 0.1,
            home: drawing.find('R'),
            return_home: false,
        },
        approach: ApproachSpec { eye_height_m: 2.0, poses: 1 },
    }
}

/// What came to pass on the stage.
#[derive(Debug, Clone, Default)]
pub(crate) struct Played {
    pub(crate) transformations: BTreeSet<Transformation>,
    pub(crate) outcomes: BTreeSet<Outcome>,
    pub(crate) triggers: BTreeSet<&'static str>,
    pub(crate) reasons: BTreeSet<Reason>,
}

impl Played {
    pub(crate) fn join(mut self, other: Self) -> Self {
        self.transformations.extend(other.transformations);
        self.outcomes.extend(other.outcomes);
        self.triggers.extend(other.triggers);
        self.reasons.extend(other.reasons);
        self
    }
}

/// The rover, the world as it is told to it, and what every decision is held against.
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    pub(crate) rover: Autonomy,
    pub(crate) at: Cell,
    pub(crate) spent: Spent,
    observations: u32,
    messages: u32,
    /// Where each goal stood after the last decision.
    status: BTreeMap<GoalId, Status>,
    next_id: u32,
    played: Played,
}

impl Stage {
    pub(crate) fn new(spec: Spec) -> Self {
        let at = spec.fallback.home;
        Self {
            rover: Autonomy::new(spec).expect("a sound spec"),
            at,
            spent: Spent::default(),
            observations: 0,
            messages: 0,
            status: BTreeMap::new(),
            next_id: 0,
            played: Played::default(),
        }
    }

    /// What came to pass.
    pub(crate) fn played(self) -> Played {
        self.played
    }

    /// Looks at everything from where the rover stands.
    pub(crate) fn look(&mut self, look: &Look) {
        self.observe(look.windows());
    }

    /// Tells clock and pose alone.
    pub(crate) fn tick(&mut self) {
        self.observe(vec![]);
    }

    pub(crate) fn observe(&mut self, windows: Vec<LayerWindow>) {
        let observation = Observation {
            number: self.observations,
            pose: self.pose(),
            spent: self.spent,
            windows,
        };
        self.rover.observe(&observation).expect("a sound observation");
        self.observations += 1;
    }

    fn pose(&self) -> Pose {
        Pose { cell: self.at, heading_rad: 0.0 }
    }

    pub(crate) fn hear(&mut self, word: Word) {
        let message = Message { number: self.messages, word };
        self.rover.hear(&message).expect("a sound message");
        self.messages += 1;
    }

    /// Names of what calls for a decision.
    pub(crate) fn due(&self) -> Vec<&'static str> {
        self.rover.triggers().iter().map(Trigger::name).collect()
    }

    /// A decision that something called for, checked.
    pub(crate) fn decide(&mut self) -> Decision {
        assert!(!self.rover.triggers().is_empty(), "nothing calls for a decision");
        let decision = self.rover.decide().expect("a decision");
        assert!(!decision.triggers.is_empty(), "a decision names what called for it");
        self.check_lives(&decision);
        self.check_verdicts(&decision);
        let ids = decision.verdicts.iter().map(|v| v.goal.id);
        for id in ids.filter(|id| !decision.state.manager.goals.contains_key(id)) {
            assert!(id.0 >= self.next_id, "{id} was used before");
        }
        self.next_id = decision.manager_after.next_id;
        if let Act::Pursue(goal) = decision.act {
            assert_eq!(decision.manager_after.goals[&goal].status(), Status::Dispatched);
            assert_eq!(decision.plan().sequence.goals().next(), Some(goal), "it pursues its first");
        }
        decision
    }

    /// Every step in a goal's life begins where the last one ended, and is one that may be.
    fn check_lives(&mut self, decision: &Decision) {
        for step in &decision.transitions {
            let stood = self.status.entry(step.goal).or_insert(Status::Formulated);
            assert_eq!(*stood, step.from, "{step:?}");
            assert!(step.to.may_follow(step.from), "{step:?}");
            assert_eq!(step.outcome.is_some(), step.from == Status::Evaluated, "{step:?}");
            *stood = step.to;
            self.played.outcomes.extend(step.outcome);
            assert!(decision.verdicts.iter().any(|v| v.goal.id == step.goal), "{step:?}");
        }
        for (id, goal) in &decision.manager_after.goals {
            let stands = self.status.entry(*id).or_insert(Status::Formulated);
            assert_eq!(*stands, goal.status(), "{id}");
        }
        for (id, stands) in &self.status {
            let open = decision.manager_after.goals.contains_key(id);
            assert_eq!(open, stands.is_open(), "{id} is {stands}");
        }
    }

    /// Every known goal has one verdict, with a reason that fits it and the numbers compared.
    fn check_verdicts(&mut self, decision: &Decision) {
        let told: Vec<GoalId> = decision.verdicts.iter().map(|v| v.goal.id).collect();
        assert!(told.is_sorted_by(|a, b| a < b), "one verdict a goal: {told:?}");
        let before = decision.state.manager.goals.keys();
        for id in before.chain(decision.manager_after.goals.keys()) {
            assert!(told.contains(id), "nothing is said of {id}");
        }
        for verdict in &decision.verdicts {
            let Verdict { goal, action, reason, terms, changes, turn, .. } = verdict;
            let order: Vec<GoalId> = decision.plan().sequence.goals().collect();
            assert_eq!(*turn, order.iter().position(|id| *id == goal.id), "{verdict:?}");
            check_terms(terms, verdict);
            self.played.transformations.insert(Transformation::of(*action, *reason));
            self.played.reasons.insert(*reason);
            for change in changes {
                check_terms(&change.terms, verdict);
                self.played.transformations.insert(change.transformation);
                self.played.reasons.insert(change.reason);
            }
        }
        self.played.triggers.extend(decision.triggers.iter().map(Trigger::name));
    }

    /// Drives some more cells of the act's way, at a multiple of what the map says it costs.
    pub(crate) fn advance(&mut self, decision: &Decision, cells: usize, price: f64) {
        let way = &route(decision).cells;
        let from = way.iter().position(|cell| *cell == self.at).expect("it stands on its way");
        let way = &way[from..=from + cells];
        let ground = &self.rover.maps().expect("maps").ground;
        for pair in way.windows(2) {
            let cost = ground.edge(pair[0], pair[1]).unwrap_or_else(|| level(ground.vehicle()));
            self.spent.time_s += cost.time_s * price;
            self.spent.energy_j += cost.energy_j * price;
            self.spent.length_m += cost.length_m;
        }
        self.at = way[cells];
    }

    /// Drives the rest of the act's way.
    fn finish_way(&mut self, decision: &Decision) {
        let way = &route(decision).cells;
        let at = way.iter().position(|cell| *cell == self.at).expect("it stands on its way");
        self.advance(decision, way.len() - 1 - at, 1.0);
    }

    /// Reports how the step went, with the operators carried out.
    pub(crate) fn report(&mut self, decision: &Decision, result: StepResult, operators: &[String]) {
        let outcome = Told {
            decision: decision.number,
            result,
            operators: operators.to_vec(),
            pose: self.pose(),
            spent: self.spent,
            predicted_reliability: decision.act_cost.reliability(),
            track: vec![self.at],
        };
        self.rover.report(&outcome).expect("a sound outcome");
    }

    /// Drives the rest of the way and does the goal's work.
    pub(crate) fn achieve(&mut self, decision: &Decision) {
        let goal = pursued(decision);
        self.finish_way(decision);
        let expansion = &decision.plan().sequence.stops[0].expansion;
        let known = self.rover.spec().domain.operators();
        let name = |&index: &usize| known[index].name.clone();
        let mut names: Vec<String> = expansion.before.iter().map(name).collect();
        names.push("drive".into());
        names.extend(expansion.after.iter().map(name));
        self.spent.time_s += expansion.cost.time_s;
        self.spent.energy_j += expansion.cost.energy_j;
        self.report(decision, StepResult::Achieved(goal), &names);
    }

    /// Ends the leg under way because something calls for a decision.
    pub(crate) fn interrupt(&mut self, decision: &Decision) {
        self.report(decision, StepResult::Interrupted(pursued(decision)), &[]);
    }

    /// Drives to the vantage or home.
    pub(crate) fn arrive(&mut self, decision: &Decision) {
        self.finish_way(decision);
        self.report(decision, StepResult::Arrived, &[]);
    }
}

/// What a metre of level ground costs: what the map closes meanwhile is driven at that.
pub(crate) fn level(vehicle: &Vehicle) -> CostVector {
    let (time_s, energy_j) = vehicle.drive(1.0, 0.0).expect("level ground can be driven on");
    CostVector { length_m: 1.0, time_s, energy_j, neg_ln_r: 0.0 }
}

fn check_terms(terms: &[Term], verdict: &Verdict) {
    assert!(!terms.is_empty(), "no numbers: {verdict:?}");
    for term in terms {
        assert!(!term.name.is_empty() && term.value.is_finite(), "{verdict:?}");
        assert!(term.limit.is_none_or(f64::is_finite), "{verdict:?}");
    }
}

/// The way of an act.
pub(crate) fn route(decision: &Decision) -> &Route {
    match &decision.act {
        Act::Pursue(_) => &decision.plan().plan.legs[0].route,
        Act::Look { route, .. } | Act::Home { route } => route,
        other => panic!("drives nowhere: {other:?}"),
    }
}

/// The goal that is pursued next.
pub(crate) fn pursued(decision: &Decision) -> GoalId {
    match decision.act {
        Act::Pursue(goal) => goal,
        ref other => panic!("pursues nothing: {other:?}"),
    }
}

/// What is said of a goal.
pub(crate) fn said(decision: &Decision, goal: GoalId) -> &Verdict {
    let found = decision.verdicts.iter().find(|v| v.goal.id == goal);
    found.unwrap_or_else(|| panic!("nothing is said of {goal}"))
}

/// The goal at a cell.
pub(crate) fn goal_at(decision: &Decision, target: Cell) -> GoalId {
    let found = decision.verdicts.iter().find(|v| v.goal.target == target);
    found.unwrap_or_else(|| panic!("no goal at {target}: {:?}", decision.verdicts)).goal.id
}

/// What was done with a goal, why, how that transformed it, and what was made of it if it was under way.
pub(crate) fn fate(
    decision: &Decision,
    goal: GoalId,
) -> (Action, Reason, Transformation, Option<Outcome>) {
    let Verdict { action, reason, .. } = *said(decision, goal);
    let mine = decision.transitions.iter().filter(|step| step.goal == goal);
    let outcome = mine.filter_map(|step| step.outcome).next_back();
    (action, reason, Transformation::of(action, reason), outcome)
}

/// A number compared, and what with.
pub(crate) fn term(verdict: &Verdict, name: &str) -> (f64, Option<f64>) {
    let found = verdict.terms.iter().find(|term| term.name == name);
    let found = found.unwrap_or_else(|| panic!("no `{name}` among {:?}", verdict.terms));
    (found.value, found.limit)
}

/// Planes are `f32` and prizes are quantised: what is worked out by hand agrees to this.
pub(crate) const NEAR: f64 = 1e-6;

/// Asserts a number compared and its limit.
#[track_caller]
pub(crate) fn compared(verdict: &Verdict, name: &str, value: f64, limit: Option<f64>) {
    let (found, against) = term(verdict, name);
    assert!((found - value).abs() < NEAR, "{name} is {found}, by hand {value}");
    match (against, limit) {
        (Some(a), Some(b)) => assert!((a - b).abs() < NEAR, "{name}: limit {a}, by hand {b}"),
        (None, None) => {}
        _ => panic!("{name}: limit {against:?}, by hand {limit:?}"),
    }
}
