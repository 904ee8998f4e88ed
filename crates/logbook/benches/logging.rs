//! What logging costs a run in every map mode and sync policy, and what verifying costs beside it:
//! `cargo bench -p wisdom-logbook --bench logging [-- ROUNDS [MISSION]]`, by default 5 rounds of missions/marias-pass. The ways
//! of logging take turns in every round; medians are printed. The share is the time in the log, opening and closing
//! included, over the wall time of the run.
#![expect(clippy::print_stdout, reason = "a program that reports measurements")]
#![expect(clippy::disallowed_methods, reason = "a program that takes time")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use wisdom_autonomy::{Decision, Maps, Message, Observation, Outcome};
use wisdom_logbook::{MapMode, Options, SyncPolicy, VerifyLevel, verify};
use wisdom_mission::{FaultEvent, Memory, Mission, RecordError, Recorder};

/// Times what a recorder does.
struct Timed<R> {
    inner: R,
    spent: Duration,
}

impl<R> Timed<R> {
    fn keep(
        &mut self,
        act: impl FnOnce(&mut R) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        let begun = Instant::now();
        let kept = act(&mut self.inner);
        self.spent += begun.elapsed();
        kept
    }
}

impl<R: Recorder> Recorder for Timed<R> {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        self.keep(|inner| inner.observation(observation))
    }

    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError> {
        self.keep(|inner| inner.decision(decision, maps))
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.keep(|inner| inner.outcome(outcome))
    }

    fn message(&mut self, message: &Message) -> Result<(), RecordError> {
        self.keep(|inner| inner.message(message))
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        self.keep(|inner| inner.fault(event))
    }
}

/// What one way of logging took, run by run.
#[derive(Default)]
struct Measured {
    run_s: Vec<f64>,
    share: Vec<f64>,
    verify_s: Vec<f64>,
    bytes: u64,
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn measure(
    mission: &Mission,
    path: &Path,
    options: Options,
    into: &mut Measured,
) -> Result<(), Box<dyn std::error::Error>> {
    let begun = Instant::now();
    let log = wisdom_logbook::begin(path, mission, options)?;
    let mut timed = Timed { inner: log, spent: begun.elapsed() };
    let summary = wisdom_mission::run(mission, &mut timed, &mut |_| true)?;
    let closing = Instant::now();
    timed.inner.finish(&summary.status.to_string(), &BTreeMap::new())?;
    let (logging, run) = (timed.spent + closing.elapsed(), begun.elapsed());
    into.run_s.push(run.as_secs_f64());
    into.share.push(logging.as_secs_f64() / run.as_secs_f64());
    into.bytes = std::fs::metadata(path)?.len();
    let begun = Instant::now();
    if !verify(path, VerifyLevel::Redecide, &mut |_| {})?.holds() {
        return Err("the log does not verify".into());
    }
    into.verify_s.push(begun.elapsed().as_secs_f64());
    Ok(std::fs::remove_file(path)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let rounds: usize = args.first().map_or(Ok(5), |rounds| rounds.parse())?;
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../missions/marias-pass");
    let mission = Mission::load(&args.get(1).map_or(shipped, PathBuf::from), &[])?;
    let folder = tempfile::tempdir()?;
    let ways: Vec<Options> = SyncPolicy::ALL
        .into_iter()
        .flat_map(|sync| MapMode::ALL.map(|maps| Options { sync, maps }))
        .collect();
    let mut found: Vec<Measured> = ways.iter().map(|_| Measured::default()).collect();
    let mut bare_s = Vec::new();
    for round in 0..rounds {
        let begun = Instant::now();
        wisdom_mission::run(&mission, &mut Memory::default(), &mut |_| true)?;
        bare_s.push(begun.elapsed().as_secs_f64());
        // Each round begins elsewhere, so that no way always follows the same one.
        for turn in 0..ways.len() {
            let way = (turn + round) % ways.len();
            measure(&mission, &folder.path().join("run.mcap"), ways[way], &mut found[way])?;
        }
    }
    println!("{}, {rounds} rounds; {:.2} s without a log", mission.name, median(&bare_s));
    println!("maps    sync      run s    share       bytes  verify s  verify/run");
    for (way, measured) in ways.iter().zip(&found) {
        let (run_s, verify_s) = (median(&measured.run_s), median(&measured.verify_s));
        println!(
            "{:<8}{:<6}{run_s:>9.2}{:>8.1}%{:>12}{verify_s:>10.2}{:>12.2}",
            way.maps.name(),
            way.sync.name(),
            100.0 * median(&measured.share),
            measured.bytes,
            verify_s / run_s
        );
    }
    Ok(())
}
