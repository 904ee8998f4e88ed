//! What is compared: a mission's runs, or logs that are there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use indicatif::ProgressBar;
use rayon::prelude::*;
use wisdom_logbook::{LogReader, Options, SyncPolicy};
use wisdom_mission::{Mission, Override, RunStatus};

use super::CompareArgs;
use crate::exit::InputError;
use crate::mission_args::{MissionArgs, quoted};

/// What a mission is run under if nothing else is said.
const RULES: [&str; 3] = ["dsmc", "dempster", "pcr6"];
/// The most seeds from one to another: more is a slip of the pen.
const MOST_SEEDS: u64 = 10_000;
/// Runs at a time: each is parallel in itself, and two fill the gaps.
const AT_A_TIME: usize = 2;

/// What `--seeds` names.
pub(crate) fn seeds(text: &str) -> Result<Vec<u64>, InputError> {
    let error = || InputError(format!("--seeds {text}: expected `3`, `1,4,7` or `1..5`"));
    let number = |s: &str| s.trim().parse::<u64>().map_err(|_| error());
    let mut seeds = Vec::new();
    for part in text.split(',') {
        match part.split_once("..") {
            Some((from, to)) => {
                let (from, to) = (number(from)?, number(to.trim_start_matches('='))?);
                if from > to {
                    let message = format!("--seeds {text}: {from} is larger than {to}");
                    return Err(InputError(message));
                }
                if to - from >= MOST_SEEDS {
                    let message = format!(
                        "--seeds {text}: expected at most {MOST_SEEDS} from one seed to another"
                    );
                    return Err(InputError(message));
                }
                seeds.extend(from..=to);
            }
            None => seeds.push(number(part)?),
        }
    }
    Ok(seeds)
}

/// A run to be made.
pub(super) struct Case {
    name: String,
    file: String,
    seed: u64,
    mission: Mission,
}

/// A run that has a log.
pub(super) struct Logged {
    /// What it is called: its rule, or its file.
    pub(super) name: String,
    pub(super) path: PathBuf,
}

/// What the command was given.
pub(super) enum Given {
    Mission(Vec<Case>),
    Logs(Vec<PathBuf>),
}

impl Given {
    /// How many runs the first world has, at most.
    pub(super) fn first_world(&self) -> usize {
        match self {
            Self::Mission(cases) => cases.iter().filter(|case| case.seed == cases[0].seed).count(),
            Self::Logs(paths) => paths.len(),
        }
    }
}

/// Reads what the command was given.
pub(super) fn given(args: &CompareArgs) -> anyhow::Result<Given> {
    let (logs, missions): (Vec<_>, Vec<_>) = args.given.iter().partition(|path| is_log(path));
    match (&missions[..], &logs[..]) {
        ([mission], []) => cases(args, mission).map(Given::Mission),
        ([], [only]) => {
            let message =
                format!("{}: one log; expected two or more, or a mission", only.display());
            Err(InputError(message).into())
        }
        ([], logs) => {
            let of_missions = [
                ("--rules", args.rules.is_some()),
                ("--seeds", args.seeds.is_some()),
                ("--set", !args.set.is_empty()),
                ("--policy", args.policy.is_some()),
                ("--logs", args.logs.is_some()),
            ];
            if let Some((option, _)) = of_missions.iter().find(|(_, given)| *given) {
                let message =
                    format!("{option}: logs are compared as they are; it asks for a mission");
                return Err(InputError(message).into());
            }
            Ok(Given::Logs(logs.iter().map(|&path| path.clone()).collect()))
        }
        ([mission, other, ..], []) => {
            let message = format!(
                "{} and {}: one mission is compared under several --rules; of two, compare the logs",
                mission.display(),
                other.display()
            );
            Err(InputError(message).into())
        }
        ([mission, ..], [log, ..]) => {
            let message = format!(
                "{} is taken for a mission, {} for a log; expected one mission, or logs alone",
                mission.display(),
                log.display()
            );
            Err(InputError(message).into())
        }
    }
}

/// Whether a path is meant for a log: by its name, or by what it begins with.
fn is_log(path: &Path) -> bool {
    let named = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if named("mcap") || named("part") {
        return true;
    }
    let begins = || -> std::io::Result<[u8; 8]> {
        let mut bytes = [0; 8];
        std::io::Read::read_exact(&mut std::fs::File::open(path)?, &mut bytes)?;
        Ok(bytes)
    };
    path.is_file() && begins().is_ok_and(|bytes| bytes.starts_with(b"\x89MCAP0\r\n"))
}

/// A mission under every seed and rule, seeds first.
fn cases(args: &CompareArgs, mission: &Path) -> anyhow::Result<Vec<Case>> {
    let files = MissionArgs {
        mission: mission.to_owned(),
        set: args.set.clone(),
        policy: args.policy.clone(),
    };
    let own = files.load(&[])?;
    let seeds = match &args.seeds {
        Some(text) => seeds(text)?,
        None => vec![own.seed],
    };
    let given = RULES.map(str::to_owned).to_vec();
    let rules = args.rules.as_ref().unwrap_or(&given);
    let mut cases = Vec::new();
    for seed in seeds {
        let mut names: BTreeMap<String, usize> = BTreeMap::new();
        for rule in rules {
            let overrides = [
                Override::new("seed", seed.to_string()),
                Override::new("rule", quoted(rule.trim())),
            ];
            let mission = files.load(&overrides)?;
            let rule = mission.spec.fusion.rule.to_string();
            let count = names.entry(rule.clone()).and_modify(|n| *n += 1).or_insert(1);
            // A rule may be held against itself.
            let (name, ending) = match *count {
                1 => (rule.clone(), String::new()),
                n => (format!("{rule} ({n})"), format!("-{n}")),
            };
            let file = format!("{}-seed{seed}-{rule}{ending}.mcap", mission.name);
            cases.push(Case { name, file, seed, mission });
        }
    }
    Ok(cases)
}

/// A folder of logs: one that stays, or one that goes with this value.
pub(super) struct Logs {
    path: PathBuf,
    stays: bool,
}

impl Logs {
    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Logs {
    fn drop(&mut self) {
        if !self.stays {
            // What cannot be removed is the system's own to clear away.
            let _ = std::fs::remove_dir_all(&self.path);
        }
    }
}

/// Where the logs of a mission's runs go.
pub(super) fn log_folder(args: &CompareArgs, given: &Given) -> anyhow::Result<Logs> {
    if let Given::Logs(_) = given {
        return Ok(Logs { path: PathBuf::new(), stays: true });
    }
    if let Some(folder) = &args.logs {
        std::fs::create_dir_all(folder)
            .map_err(|e| InputError(format!("--logs {}: {e}", folder.display())))?;
        return Ok(Logs { path: folder.clone(), stays: true });
    }
    let (room, process) = (std::env::temp_dir(), std::process::id());
    for n in 0..1000 {
        let path = room.join(format!("wisdom-compare-{process}-{n}"));
        match std::fs::create_dir(&path) {
            Ok(()) => return Ok(Logs { path, stays: false }),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error).context(format!("{}", path.display())),
        }
    }
    Err(InputError(format!("{}: no free name for the logs; give --logs", room.display())).into())
}

/// Makes all runs, two at a time; the logs of each world, in the order of the cases.
pub(super) fn perform(
    cases: &[Case],
    folder: &Path,
    stop: &AtomicBool,
    bar: &ProgressBar,
) -> anyhow::Result<Vec<Vec<Logged>>> {
    let failed: Mutex<Option<anyhow::Error>> = Mutex::new(None);
    for some in cases.chunks(AT_A_TIME) {
        some.par_iter().for_each(|case| {
            if let Err(error) = log(case, folder, stop) {
                let mut failed = failed.lock().expect("nothing panics while it is held");
                failed.get_or_insert(error);
            }
            bar.inc(1);
        });
        if let Some(error) = failed.lock().expect("nothing panics while it is held").take() {
            return Err(error);
        }
    }
    bar.finish_and_clear();
    let mut worlds: Vec<(u64, Vec<Logged>)> = Vec::new();
    for case in cases {
        let logged = Logged { name: case.name.clone(), path: folder.join(&case.file) };
        match worlds.last_mut() {
            Some((seed, runs)) if *seed == case.seed => runs.push(logged),
            _ => worlds.push((case.seed, vec![logged])),
        }
    }
    Ok(worlds.into_iter().map(|(_, runs)| runs).collect())
}

/// One run into its log.
fn log(case: &Case, folder: &Path, stop: &AtomicBool) -> anyhow::Result<()> {
    let path = folder.join(&case.file);
    // A run that is lost with the power is run again: nobody drives by it.
    let options = Options { sync: SyncPolicy::End, ..Options::default() };
    let mut log = wisdom_logbook::begin(&path, &case.mission, options)?;
    let going_on = &mut |_: &wisdom_mission::Progress<'_>| !stop.load(Ordering::Relaxed);
    let ran = wisdom_mission::run(&case.mission, &mut log, going_on);
    let told = || format!("seed {} under {}", case.seed, case.name);
    match ran {
        Ok(summary) => {
            log.finish(&summary.status.to_string(), &BTreeMap::new())?;
            anyhow::ensure!(summary.status != RunStatus::Stopped, "{}: interrupted", told());
            Ok(())
        }
        Err(error) => {
            // What was written says why it ends here; that it could not be closed either adds nothing.
            let _ = log.finish("failed", &BTreeMap::new());
            Err(anyhow::Error::from(error).context(told()))
        }
    }
}

/// Groups logs into worlds. Logs of several seeds that hold the same rules are as many worlds; else all of them are held
/// against the first.
pub(super) fn by_world(paths: &[PathBuf]) -> anyhow::Result<Vec<Vec<Logged>>> {
    let mut facts = Vec::new();
    for path in paths {
        // Only the facts are kept: a log may be large, and there may be many.
        facts.push(LogReader::open(path)?.metadata);
    }
    let fact = |run: usize, name: &str| facts[run].get(name).cloned().unwrap_or_default();
    let runs = 0..paths.len();
    let mut worlds: Vec<(String, Vec<usize>)> = Vec::new();
    for run in runs.clone() {
        let seed = fact(run, "seed");
        match worlds.iter_mut().find(|(other, _)| *other == seed) {
            Some((_, runs)) => runs.push(run),
            None => worlds.push((seed, vec![run])),
        }
    }
    let of_one = ["mission", "policy", "prize"]
        .iter()
        .all(|name| runs.clone().all(|run| fact(run, name) == fact(0, name)));
    let rules = |runs: &[usize]| -> Vec<String> {
        let mut rules: Vec<String> = runs.iter().map(|&run| fact(run, "rule")).collect();
        rules.sort_unstable();
        rules
    };
    let first = rules(&worlds[0].1);
    let distinct = |rules: &[String]| rules.windows(2).all(|pair| pair[0] != pair[1]);
    let paired = of_one
        && first.len() > 1
        && distinct(&first)
        && worlds.iter().all(|(_, runs)| rules(runs) == first);
    if !paired {
        worlds = vec![(String::new(), runs.collect())];
    }
    let by_rule = distinct(&rules(&worlds[0].1)) && of_one;
    let leaders: Vec<String> = worlds[0].1.iter().map(|&run| fact(run, "rule")).collect();
    let logged = |run: usize| {
        let file = paths[run].file_name().map(|name| name.to_string_lossy().into_owned());
        let file = file.unwrap_or_default();
        let stem = file.trim_end_matches(".part").trim_end_matches(".mcap").to_owned();
        let name = if by_rule { fact(run, "rule") } else { stem };
        Logged { name, path: paths[run].clone() }
    };
    Ok(worlds
        .into_iter()
        .map(|(_, mut runs)| {
            if paired {
                // In the first world's order, whatever the order of the others.
                runs.sort_by_key(|&run| leaders.iter().position(|rule| *rule == fact(run, "rule")));
            }
            told_apart(runs.into_iter().map(logged).collect())
        })
        .collect())
}

/// Gives runs of the same name a number.
fn told_apart(mut runs: Vec<Logged>) -> Vec<Logged> {
    let mut names: BTreeMap<String, usize> = BTreeMap::new();
    for run in &mut runs {
        let count = names.entry(run.name.clone()).and_modify(|n| *n += 1).or_insert(1);
        if *count > 1 {
            run.name = format!("{} ({count})", run.name);
        }
    }
    runs
}
