//! `wisdom export pddl`: a decision's problem, and our optimum of it, for outside planners and validators.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use wisdom_goals::{Effort, GoalSequence, PddlFiles, Policy, Proof};
use wisdom_logbook::{LogReader, Past};

use crate::exit::{FAILED, InputError};

/// Write a decision's problem as domain.pddl, problem.pddl and plan.txt, and say what they hold in README.txt.
///
/// The problem is that of policy net-benefit at the mission's prices, whatever the mission's own policy is, and without
/// limits of time, energy, data and reliability: classical planners know none. The plan is Wisdom's optimum of exactly
/// that problem, in the same whole numbers; what the decision itself chose is printed beside it.
#[derive(clap::Args, Debug)]
pub(crate) struct PddlArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// The decision.
    #[arg(long, value_name = "N")]
    decision: u32,
    /// The folder that the files go to; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How long the search for the optimum may go on.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    expansions: u64,
}

const DOMAIN: &str = "domain.pddl";
const PROBLEM: &str = "problem.pddl";
const PLAN: &str = "plan.txt";
const README: &str = "README.txt";

/// What `README.txt` begins with: a file that begins otherwise is somebody's.
const README_HEAD: &str = "README.txt: ";

/// Refuses to write over files that are not an older export.
fn check_folder(folder: &Path) -> Result<(), InputError> {
    for name in [DOMAIN, PROBLEM, PLAN, README] {
        let path = folder.join(name);
        let head = if name == README { README_HEAD.to_owned() } else { format!("; {name}: ") };
        if std::fs::read(&path).is_ok_and(|bytes| !bytes.starts_with(head.as_bytes())) {
            let refused = format!("{}: is there already, and is no export", path.display());
            return Err(InputError(refused));
        }
    }
    Ok(())
}

pub(super) fn run(args: &PddlArgs) -> anyhow::Result<ExitCode> {
    check_folder(&args.output)?;
    let log = LogReader::open(&args.log)?;
    super::check_decision(&args.log, &log, args.decision)?;
    let past = wisdom_logbook::derive_at(&log, args.decision)?
        .context("a decision that the log holds is derived")?;
    let Some(deliberation) = past.rover.deliberation() else {
        crate::exit::complain(&format!("error: decision {} weighed nothing", args.decision));
        return Ok(ExitCode::from(FAILED));
    };
    let problem = deliberation.problem(past.rover.spec());
    let name = log.metadata.get("mission").map_or("mission", String::as_str);
    let title = format!("mission {name}, decision {}", args.decision);
    let effort = Effort { expansions: args.expansions, keep: 1, first: &[], clock: None };
    let files = match wisdom_goals::pddl(&problem, &title, effort) {
        Ok(files) => files,
        Err(error) => {
            crate::exit::complain(&format!("error: {error}"));
            return Ok(ExitCode::from(FAILED));
        }
    };
    let told = told(&files, &past, problem.candidates.len(), problem.policy);
    let readme = format!("{README_HEAD}{title}\n\n{told}\n{GUIDE}");
    let at = |path: &Path| path.display().to_string();
    std::fs::create_dir_all(&args.output).with_context(|| at(&args.output))?;
    let mut out = std::io::stdout().lock();
    for (file, text) in
        [(DOMAIN, &files.domain), (PROBLEM, &files.problem), (PLAN, &files.plan), (README, &readme)]
    {
        let path = args.output.join(file);
        std::fs::write(&path, text).with_context(|| at(&path))?;
        writeln!(out, "{}", at(&path))?;
    }
    write!(out, "\n{told}")?;
    Ok(crate::exit::of_log(&log))
}

fn order(sequence: &GoalSequence) -> String {
    if sequence.stops.is_empty() {
        return "nothing".into();
    }
    sequence.goals().map(|goal| goal.to_string()).collect::<Vec<_>>().join(" > ")
}

/// What was exported, and what the decision chose.
fn told(files: &PddlFiles, past: &Past, candidates: usize, policy: Policy) -> String {
    let proof = match files.proof {
        Proof::Proven => "proven to be the optimum",
        Proof::Bound(_) => "not proven to be an optimum: the search was cut short",
    };
    let chosen = &past.decision.plan().sequence;
    let first = past
        .rover
        .deliberation()
        .and_then(|d| d.pinned)
        .map(|goal| format!(", beginning with {goal}, the leg under way"))
        .unwrap_or_default();
    format!(
        "Exported: {candidates} goals under policy net-benefit, without limits of time, energy, data and reliability\n\
         \x20 plan.txt:     {}\n\
         \x20               total cost {} ({} are one unit of prize), {proof}\n\
         The decision itself: policy {policy}, within its limits{first}\n\
         \x20 it chose:     {}\n",
        order(&files.sequence),
        files.cost,
        files.units,
        order(chosen),
    )
}

const GUIDE: &str = "\
Any planner for PDDL with action costs and negative preconditions can solve problem.pddl; its least total cost is to
be compared with the last line of plan.txt. A validator can check plan.txt. From the Python Package Index:

    pip install unified-planning up-fast-downward pddl-pyvalidator
    up oneshot-planning --pddl domain.pddl problem.pddl --engine fast-downward-opt
    pyval domain.pddl problem.pddl plan.txt
";
