//! The runs themselves: one, or many at once.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use rayon::ThreadPool;
use wisdom_autonomy::{Decision, Maps, Message, Observation, Outcome};
use wisdom_mission::{Case, FaultEvent, RecordError, Recorder, Row, RunStatus, RunSummary};

use super::folder::Folder;

/// Keeps nothing: a campaign's runs are known by their summaries.
struct Unrecorded;

impl Recorder for Unrecorded {
    fn observation(&mut self, _: &Observation) -> Result<(), RecordError> {
        Ok(())
    }

    fn decision(&mut self, _: &Decision, _: &Maps) -> Result<(), RecordError> {
        Ok(())
    }

    fn outcome(&mut self, _: &Outcome) -> Result<(), RecordError> {
        Ok(())
    }

    fn message(&mut self, _: &Message) -> Result<(), RecordError> {
        Ok(())
    }

    fn fault(&mut self, _: &FaultEvent) -> Result<(), RecordError> {
        Ok(())
    }
}

/// The wall clock: what it says never reaches a row.
#[expect(clippy::disallowed_methods, reason = "timing belongs to the command line")]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// Runs a mission of a campaign to its end; none if it was told to stop before.
pub(super) fn perform(
    folder: &Folder,
    case: &Case,
    stop: &AtomicBool,
) -> anyhow::Result<Option<RunSummary>> {
    let mission = folder.mission(case)?;
    let summary =
        wisdom_mission::run(&mission, &mut Unrecorded, &mut |_| !stop.load(Ordering::Relaxed))?;
    Ok((summary.status != RunStatus::Stopped).then_some(summary))
}

/// The row of a run; a run that fails, even by a bug of ours, has one too, so that the others go on.
fn row_of(
    case: &Case,
    perform: &(impl Fn(&Case) -> anyhow::Result<Option<RunSummary>> + Sync),
) -> Option<Row> {
    match catch_unwind(AssertUnwindSafe(|| perform(case))) {
        Ok(Ok(summary)) => summary.map(|summary| Row::finished(case, &summary)),
        Ok(Err(error)) => Some(Row::failed(case, format!("{error:#}"))),
        Err(panic) => {
            let text = panic
                .downcast_ref::<&str>()
                .map(ToString::to_string)
                .or_else(|| panic.downcast_ref::<String>().cloned())
                .unwrap_or_default();
            Some(Row::failed(case, format!("a bug of ours: {text}")))
        }
    }
}

/// Does runs on all threads of a pool and gives every row to `keep`, in whatever order they end.
///
/// Each thread takes the next run when it is done with one. What a run does in parallel goes to the same pool, so
/// that threads that find no more runs help with the last ones. (Were the runs themselves pieces of one parallel
/// loop, a thread that waits for a piece of its run could take up a whole other run meanwhile.)
///
/// # Errors
/// The first row that could not be kept; no further runs are begun then.
pub(super) fn all(
    pool: &ThreadPool,
    cases: &[Case],
    stop: &AtomicBool,
    perform: &(impl Fn(&Case) -> anyhow::Result<Option<RunSummary>> + Sync),
    keep: &(impl Fn(&Row, f64) -> anyhow::Result<()> + Sync),
) -> anyhow::Result<()> {
    let next = AtomicUsize::new(0);
    let broken = Mutex::new(None);
    pool.broadcast(|_| {
        while !stop.load(Ordering::Relaxed) {
            let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let begun = now();
            let Some(row) = row_of(case, perform) else { break };
            if let Err(error) = keep(&row, begun.elapsed().as_secs_f64()) {
                next.store(cases.len(), Ordering::Relaxed);
                broken.lock().expect("nothing panics while it is held").get_or_insert(error);
            }
        }
    });
    match broken.into_inner().expect("nothing panics while it is held") {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use wisdom_mission::{Plan, RowResult};

    use super::*;

    fn plan() -> Plan {
        let policy = "most-interesting".parse().unwrap();
        Plan::new((1..=20).collect(), &["dsmc".parse().unwrap()], &[policy]).unwrap()
    }

    fn pool() -> ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap()
    }

    #[test]
    fn a_run_that_fails_or_panics_does_not_lose_the_others() {
        let cases: Vec<Case> = plan().cases().collect();
        let rows = Mutex::new(Vec::new());
        let perform = |case: &Case| match case.seed {
            3 => anyhow::bail!("no such ground"),
            5 => panic!("off by one"),
            _ => Ok(Some(nothing_done())),
        };
        let keep = |row: &Row, _| {
            rows.lock().unwrap().push(row.clone());
            Ok(())
        };
        all(&pool(), &cases, &AtomicBool::new(false), &perform, &keep).unwrap();
        let rows = rows.into_inner().unwrap();
        let done: BTreeSet<usize> = rows.iter().map(|row| row.index).collect();
        assert_eq!(done, (0..20).collect());
        for row in &rows {
            match (row.seed, &row.result) {
                (3, RowResult::Failed { error }) => assert_eq!(error, "no such ground"),
                (5, RowResult::Failed { error }) => assert_eq!(error, "a bug of ours: off by one"),
                (seed, result) => {
                    assert!(seed != 3 && seed != 5 && matches!(result, RowResult::Finished(_)));
                }
            }
        }
    }

    #[test]
    fn a_stop_ends_the_campaign_without_rows_of_unfinished_runs() {
        let cases: Vec<Case> = plan().cases().collect();
        let stop = AtomicBool::new(false);
        let rows = Mutex::new(Vec::new());
        let perform = |case: &Case| {
            if case.seed == 4 {
                stop.store(true, Ordering::Relaxed);
                return Ok(None);
            }
            Ok(Some(nothing_done()))
        };
        let keep = |row: &Row, _| {
            rows.lock().unwrap().push(row.seed);
            Ok(())
        };
        all(&pool(), &cases, &stop, &perform, &keep).unwrap();
        let rows = rows.into_inner().unwrap();
        assert!(!rows.contains(&4) && rows.len() < 20, "{rows:?}");
    }

    #[test]
    fn a_row_that_cannot_be_kept_ends_the_campaign_with_its_error() {
        let cases: Vec<Case> = plan().cases().collect();
        let kept = AtomicUsize::new(0);
        let keep = |row: &Row, _| {
            if row.seed == 2 {
                anyhow::bail!("the disk is full")
            }
            kept.fetch_add(1, Ordering::Relaxed);
            Ok(())
        };
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let perform = |_: &Case| Ok(Some(nothing_done()));
        let error = all(&one, &cases, &AtomicBool::new(false), &perform, &keep).unwrap_err();
        assert_eq!(error.to_string(), "the disk is full");
        assert_eq!(kept.into_inner(), 1);
    }

    fn nothing_done() -> RunSummary {
        RunSummary {
            status: RunStatus::Waiting,
            achieved: Vec::new(),
            actions: std::collections::BTreeMap::new(),
            spent: wisdom_autonomy::Spent::default(),
            decisions: 1,
            observations: 1,
            legs: Vec::new(),
            neg_ln_r: 0.0,
            track: Vec::new(),
            faults: Vec::new(),
        }
    }
}
