//! How the command ends.

use std::io::ErrorKind;
use std::process::ExitCode;

use wisdom_logbook::{LogError, LogReader, ReplayError, Status, part_of};
use wisdom_mission::MissionError;

/// The input or the call is wrong: exit code 2.
#[derive(Debug)]
pub(crate) struct InputError(pub(crate) String);

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InputError {}

/// The run or check failed.
pub(crate) const FAILED: u8 = 1;
/// The input or the call is wrong.
pub(crate) const BAD_INPUT: u8 = 2;
/// Done, but something was lost.
pub(crate) const LOSSY: u8 = 3;

/// The exit code of a command that told what a log holds: a log that is not whole says so, in words and in
/// the code.
pub(crate) fn of_log(log: &LogReader) -> ExitCode {
    of_status(&log.status)
}

/// The same for a command that did not read the log whole.
pub(crate) fn of_status(status: &Status) -> ExitCode {
    match status {
        Status::Complete => ExitCode::SUCCESS,
        status @ Status::Truncated { .. } => {
            complain(&format!("remark: the log is {status}"));
            ExitCode::from(LOSSY)
        }
        status @ Status::Corrupt { .. } => {
            complain(&format!("error: the log is {status}"));
            ExitCode::from(FAILED)
        }
    }
}

/// An error and its causes, each said once: many of our messages hold their cause already.
fn told(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain() {
        let cause = cause.to_string();
        if !text.contains(&cause) {
            if !text.is_empty() {
                text.push_str(": ");
            }
            text.push_str(&cause);
        }
    }
    text
}

/// What lies beside a log that is not there: that of a run which goes on, or was killed.
fn beside(error: &anyhow::Error) -> String {
    let missing = error.chain().find_map(|cause| match cause.downcast_ref::<LogError>() {
        Some(LogError::Io { path, source }) if source.kind() == ErrorKind::NotFound => Some(path),
        _ => None,
    });
    let part = missing.map(|path| part_of(path)).filter(|part| part.exists());
    part.map_or_else(String::new, |part| {
        let part = part.display();
        format!("; there is {part}, of a run that goes on or was killed")
    })
}

/// Prints an error and tells its exit code.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    // A reader that closed the pipe early (`wisdom replay LOG | head`) is no failure of ours.
    let closed = |e: &(dyn std::error::Error + 'static)| {
        e.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
    };
    if error.chain().any(closed) {
        return ExitCode::SUCCESS;
    }
    if let Some(mission) = error.downcast_ref::<MissionError>() {
        complain(&mission.to_string());
        return ExitCode::from(BAD_INPUT);
    }
    complain(&format!("error: {}{}", told(error), beside(error)));
    if let Some(ReplayError::NoMission { status }) = error.downcast_ref() {
        let damaged = matches!(status, Status::Corrupt { .. });
        return ExitCode::from(if damaged { FAILED } else { LOSSY });
    }
    ExitCode::from(if error.chain().any(is_input) { BAD_INPUT } else { FAILED })
}

/// Whether an error is the fault of what the command was given.
fn is_input(error: &(dyn std::error::Error + 'static)) -> bool {
    if let Some(replay) = error.downcast_ref::<ReplayError>() {
        return match replay {
            ReplayError::Log(log) => is_input(log),
            ReplayError::Mission(_)
            | ReplayError::Unfit { .. }
            | ReplayError::OtherVersion { .. }
            | ReplayError::NoPlane { .. } => true,
            _ => false,
        };
    }
    match error.downcast_ref::<LogError>() {
        Some(LogError::NotALog { .. } | LogError::Exists { .. } | LogError::NoDecision { .. }) => {
            true
        }
        Some(LogError::Io { source, .. }) => matches!(
            source.kind(),
            ErrorKind::NotFound
                | ErrorKind::IsADirectory
                | ErrorKind::NotADirectory
                | ErrorKind::InvalidInput
                | ErrorKind::PermissionDenied
                | ErrorKind::ReadOnlyFilesystem
        ),
        _ => error.is::<InputError>() || error.is::<MissionError>(),
    }
}

#[expect(clippy::print_stderr, reason = "this is where the command speaks of its errors")]
pub(crate) fn complain(text: &str) {
    eprintln!("{text}");
}
