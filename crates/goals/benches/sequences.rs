//! How long the label search takes to prove a sequence of 14 goals.
//!
//! `cargo bench -p wisdom-goals --bench sequences [-- INSTANCES [GOALS]]`: 100 instances of 14 goals unless told; sites in
//! a square of 100 m, prizes in 0.1 to 1, a hazard drawn for each leg, time and energy that do not run in parallel (a
//! slope is dear upwards), operators that leave facts behind. A budget is tight, medium or loose when it is a quarter, a
//! half or three quarters of what the nearest-neighbour tour of all goals takes. One core.
#![expect(clippy::disallowed_methods, reason = "a bench measures time")]
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use std::time::Instant;

use wisdom_goals::{
    Candidate, Directive, Domain, Effort, GoalId, Limits, OperatorText, Policy, Preferences,
    Problem, Proof, ServiceCost, quantised, sequences,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix};

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Draws(u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// An arm that must be stowed to drive and is calibrated once; images need no arm.
fn domain() -> (Domain, Vec<Directive>) {
    let names = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
    let operator =
        |name: &str, [pre, adds, deletes]: [&[&str]; 3], time_s: f64, energy_j: f64| OperatorText {
            name: name.into(),
            preconditions: names(pre),
            adds: names(adds),
            deletes: names(deletes),
            cost: ServiceCost { time_s, energy_j, data_mb: 5.0 },
        };
    let domain = Domain::new(
        &[
            operator("drive", [&["stowed"], &["at-site"], &[]], 0.0, 0.0),
            operator("stow", [&["out"], &["stowed"], &["out"]], 3.0, 5.0),
            operator("unstow", [&["stowed"], &["out"], &["stowed"]], 4.0, 7.0),
            operator("calibrate", [&["out"], &["calibrated"], &[]], 10.0, 30.0),
            operator(
                "analyse",
                [&["at-site", "out", "calibrated"], &["analysed"], &[]],
                30.0,
                45.0,
            ),
            operator("image", [&["at-site", "stowed"], &["imaged"], &[]], 6.0, 10.0),
        ],
        &names(&["stowed"]),
    )
    .expect("the operators fit each other");
    let directive = |name: &str| {
        Directive::new(name, domain.set(&names(&[name])).expect("the domain has this fact"))
    };
    let directives = vec![directive("analysed"), directive("imaged")];
    (domain, directives)
}

struct Instance {
    candidates: Vec<Candidate>,
    travel: TravelMatrix,
    limits: Limits,
}

fn instance(goals: usize, alternatives: usize, share: f64, seed: u64) -> Instance {
    let mut draws = Draws(seed);
    let sites: Vec<(f64, f64, f64)> = (0..=goals)
        .map(|_| (draws.between(0.0, 100.0), draws.between(0.0, 100.0), draws.between(0.0, 15.0)))
        .collect();
    let cells: Vec<Cell> = (0..=goals).map(|i| Cell::new(0, i)).collect();
    let travel = TravelMatrix::from_costs(&cells, |from, to| {
        let (a, b) = (sites[from], sites[to]);
        let length_m = (a.0 - b.0).hypot(a.1 - b.1);
        let climb = (b.2 - a.2).max(0.0);
        (0..alternatives)
            .map(|way| {
                // Each further way is quicker and riskier.
                let quick = 1.0 - 0.15 * way as f64;
                let risky = 1.0 + 0.6 * way as f64;
                CostVector {
                    length_m,
                    time_s: length_m * quick * draws.between(0.95, 1.05),
                    energy_j: (length_m + 8.0 * climb) * quick * draws.between(0.95, 1.05),
                    neg_ln_r: length_m * risky * draws.between(0.0005, 0.006),
                }
            })
            .collect()
    });
    let candidates: Vec<Candidate> = (1..=goals)
        .map(|i| {
            let prize = quantised(draws.between(0.1, 1.0));
            Candidate::new(GoalId(i as u32), i % 2, prize, vec![i])
        })
        .collect();
    let (mut here, mut open) = (0, (1..=goals).collect::<Vec<_>>());
    let (mut time_s, mut energy_j) = (0.0, 0.0);
    while let Some(nearest) = (0..open.len()).min_by(|&a, &b| {
        let cost = |i: usize| travel.alternatives(here, open[i])[0].time_s;
        cost(a).total_cmp(&cost(b))
    }) {
        let next = open.swap_remove(nearest);
        let leg = travel.alternatives(here, next)[0];
        time_s += leg.time_s + 20.0;
        energy_j += leg.energy_j + 35.0;
        here = next;
    }
    let limits = Limits {
        time_s: time_s * share,
        energy_j: energy_j * share,
        data_mb: f64::INFINITY,
        min_reliability: 0.5,
    };
    Instance { candidates, travel, limits }
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<usize>().ok());
    let count = numbers.next().unwrap_or(100);
    let goals = numbers.next().unwrap_or(14);
    let (domain, directives) = domain();
    println!("{count} instances of {goals} goals, time and energy, one core");
    println!(
        "policy              ways  budget   median ms    90 %     max   expansions  proven  mean gap %"
    );
    for policy in Policy::ALL {
        for (alternatives, name, share) in
            [(1, "tight", 0.25), (1, "medium", 0.5), (1, "loose", 0.75), (3, "medium", 0.5)]
        {
            let mut times = Vec::new();
            let mut expansions = Vec::new();
            let (mut proven, mut gaps) = (0, 0.0);
            for seed in 0..count {
                let Instance { candidates, travel, limits } =
                    instance(goals, alternatives, share, seed as u64);
                let problem = Problem {
                    candidates: &candidates,
                    travel: &travel,
                    ends: &[],
                    domain: &domain,
                    directives: &directives,
                    facts: domain.initial(),
                    limits,
                    waiting_w: 0.0,
                    policy,
                    preferences: Preferences::default(),
                };
                let effort = Effort { expansions: 50_000, keep: 5, first: &[], clock: None };
                let start = Instant::now();
                let found = sequences(&problem, effort);
                times.push(start.elapsed().as_secs_f64() * 1e3);
                expansions.push(found.expansions);
                match found.proof {
                    Proof::Proven => proven += 1,
                    Proof::Bound(bound) => gaps += bound / found.best[0].value - 1.0,
                }
            }
            times.sort_by(f64::total_cmp);
            expansions.sort_unstable();
            let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
            println!(
                "{:18} {alternatives:5}  {name:6} {:11.2} {:7.1} {:7.1} {:12} {proven:4}/{count} {:9.2}",
                policy.to_string(),
                at(0.5),
                at(0.9),
                at(1.0),
                expansions[expansions.len() / 2],
                100.0 * gaps / f64::from(count as u32),
            );
        }
    }
}
