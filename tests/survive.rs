//! Runs that are killed, stopped or out of disk: what was acknowledged can be read back, and is true.

#![cfg(unix)]

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use wisdom_logbook::{LogReader, Status, VerifyLevel};

/// Kills of the first test.
const KILLS: usize = 50;

fn wisdom(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    // Two kills are waited for at once; a run that takes all cores would only be slower.
    command.env("RAYON_NUM_THREADS", "1");
    command
}

/// A run of the paper's scene with a few decisions.
fn a_run(log: &Path) -> Command {
    let log = log.to_str().expect("UTF-8");
    let mut command = wisdom(&["run", "missions/paper", "--quiet", "--acknowledge", "--log", log]);
    command.args(["--set", "budget.energy-j=3e5", "--set", "goals.expansions=2000"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn part(log: &Path) -> PathBuf {
    log.with_extension("mcap.part")
}

fn path(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[expect(clippy::disallowed_methods, reason = "a run is killed at a moment of the wall clock")]
fn now() -> Instant {
    Instant::now()
}

/// The number of the last decision that the run acknowledged.
fn acknowledged(output: &str) -> Option<u32> {
    let lines: Vec<&str> = output.lines().collect();
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(*line, format!("decision {number}"));
    }
    u32::try_from(lines.len()).expect("few decisions").checked_sub(1)
}

/// Sends a signal, as a terminal or an operating system would.
fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}

/// Waits until a run has acknowledged a decision; what it acknowledges later is lost.
fn wait_for(child: &mut Child, decision: u32) {
    let mut lines = BufReader::new(child.stdout.as_mut().expect("piped")).lines();
    let wanted = format!("decision {decision}");
    assert!(lines.any(|line| line.expect("text") == wanted), "{wanted} was never acknowledged");
}

#[test]
fn a_run_killed_at_any_moment_keeps_every_acknowledged_decision() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = folder.path().join("whole.mcap");
    let start = now();
    let output = a_run(&whole).output().expect("the run");
    let took = start.elapsed();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let decisions = acknowledged(&String::from_utf8_lossy(&output.stdout)).expect("decisions");
    assert!(decisions >= 5, "{decisions}");
    let reference = LogReader::open(&whole).expect("a log");
    assert_eq!(reference.status, Status::Complete);
    assert_eq!(
        wisdom_logbook::verify(&whole, VerifyLevel::Redecide, &mut |_| {})
            .expect("a log")
            .difference,
        None
    );

    // Knuth's linear congruential generator: moments all over the run, the same every time.
    let mut state = 1_u64;
    let mut moment = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        took.mul_f64((state >> 11) as f64 / (1_u64 << 53) as f64)
    };
    let moments: Vec<Duration> = (0..KILLS).map(|_| moment()).collect();
    let (sender, kept) = mpsc::channel();
    std::thread::scope(|scope| {
        for half in 0..2 {
            let (sender, moments, folder) = (sender.clone(), &moments, folder.path());
            scope.spawn(move || {
                for (number, moment) in moments.iter().enumerate().filter(|(n, _)| n % 2 == half) {
                    let log = folder.join(format!("{number}.mcap"));
                    let mut child = a_run(&log).spawn().expect("the run");
                    std::thread::sleep(*moment);
                    child.kill().expect("SIGKILL");
                    let output = child.wait_with_output().expect("it is gone");
                    let told = String::from_utf8_lossy(&output.stdout).into_owned();
                    sender.send((number, log, acknowledged(&told))).expect("the test waits");
                }
            });
        }
    });
    drop(sender);
    let (mut killed, mut with_decisions) = (0, 0);
    for (number, log, last) in kept {
        let ended = log.exists();
        let file = if ended { log } else { part(&log) };
        if !file.exists() {
            assert_eq!(last, None, "kill {number}: acknowledged, and no log");
            continue;
        }
        let read = LogReader::open(&file).expect("a log");
        // One that was killed between its last byte and its final name is whole under the other name.
        let whole = matches!(read.status, Status::Complete);
        let cut = matches!(read.status, Status::Truncated { .. });
        assert!(whole || (cut && !ended), "kill {number}: {:?}", read.status);
        let there = read.decisions().count();
        assert!(last.is_none_or(|last| there > last as usize), "kill {number}: {last:?}, {there}");
        // The same mission and seed: what was kept is the beginning of the run that was verified.
        assert_eq!(read.entries[..], reference.entries[..read.entries.len()], "kill {number}");
        killed += u32::from(!ended);
        if there == 0 {
            continue;
        }
        with_decisions += 1;
        if number % 5 == 0 {
            let wanted = if whole { 0 } else { 3 };
            for command in ["verify", "replay"] {
                let output = wisdom(&[command, path(&file)]).output().expect(command);
                assert_eq!(output.status.code(), Some(wanted), "{command}, kill {number}");
            }
        }
    }
    assert!(
        killed >= 20 && with_decisions >= 20,
        "{killed} killed, {with_decisions} with decisions"
    );
}

fn stopped_by(name: &str, times: u32) {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("run.mcap");
    let mut child = a_run(&log).spawn().expect("the run");
    wait_for(&mut child, 1);
    for _ in 0..times {
        signal(&child, name);
    }
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(3), "{name}");
    let read = LogReader::open(&log).expect("the log has its final name");
    assert_eq!(read.status, Status::Complete, "{name}");
    let end = read.end.as_ref().expect("an end record");
    assert_eq!(end.status, "stopped", "{name}");
    assert!(end.decisions >= 2, "{name}: {}", end.decisions);
    let verified = wisdom_logbook::verify(&log, VerifyLevel::Redecide, &mut |_| {}).expect("a log");
    assert_eq!(verified.difference, None, "{name}");
    assert_eq!(verified.decisions, end.decisions, "{name}");
}

#[test]
fn an_interrupt_stops_the_run_with_a_whole_log() {
    stopped_by("-INT", 1);
}

#[test]
fn a_request_to_terminate_stops_the_run_with_a_whole_log() {
    stopped_by("-TERM", 1);
}

#[test]
fn an_impatient_second_interrupt_does_not_cost_the_log() {
    stopped_by("-INT", 3);
}

#[test]
fn a_watcher_that_goes_away_does_not_stop_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("run.mcap");
    let mut child = a_run(&log).spawn().expect("the run");
    wait_for(&mut child, 0);
    drop(child.stdout.take());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(LogReader::open(&log).expect("a log").status, Status::Complete);
}

/// A file system of its own, small, taken down when the test ends.
struct SmallDisk {
    folder: tempfile::TempDir,
}

impl SmallDisk {
    fn mount(kib: u64) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let size = format!("size={kib}k");
        let mounted: Output = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &size, "wisdom-test"])
            .arg(folder.path())
            .output()
            .map_err(|error| error.to_string())?;
        if mounted.status.success() {
            Ok(Self { folder })
        } else {
            Err(String::from_utf8_lossy(&mounted.stderr).trim().to_owned())
        }
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let gone = Command::new("umount").arg(self.folder.path()).status();
        assert!(std::thread::panicking() || gone.is_ok_and(|status| status.success()));
    }
}

#[test]
fn a_full_disk_ends_the_run_with_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = folder.path().join("whole.mcap");
    assert!(a_run(&whole).output().expect("the run").status.success());
    let reference = LogReader::open(&whole).expect("a log");
    let kib = std::fs::metadata(&whole).expect("a file").len() / 1024;
    // Room for two thirds of the log.
    let disk = match SmallDisk::mount(kib * 2 / 3) {
        Ok(disk) => disk,
        Err(why) => {
            eprintln!("skipped: no file system could be mounted: {why}");
            return;
        }
    };
    let log = disk.folder.path().join("run.mcap");
    let mut child = a_run(&log).spawn().expect("the run");
    let mut told = String::new();
    child.stdout.take().expect("piped").read_to_string(&mut told).expect("text");
    let output = child.wait_with_output().expect("it ends");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("No space left on device"), "{error}");
    assert!(error.contains(path(&log)), "{error}");
    let last = acknowledged(&told).expect("some decisions fit");
    let read = LogReader::open(&part(&log)).expect("the part file stays");
    assert!(matches!(read.status, Status::Truncated { .. }), "{:?}", read.status);
    assert!(read.decisions().count() > last as usize);
    assert_eq!(read.entries[..], reference.entries[..read.entries.len()]);
    let verified =
        wisdom_logbook::verify(&part(&log), VerifyLevel::Redecide, &mut |_| {}).expect("a log");
    assert_eq!(verified.difference, None);
}
