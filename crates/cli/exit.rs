//! How the command ends.

use std::process::ExitCode;

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

/// Prints an error and tells its exit code.
pub(crate) fn report(error: &anyhow::Error) -> ExitCode {
    // A reader that closed the pipe early (`wisdom replay LOG | head`) is no failure of ours.
    let closed = |e: &(dyn std::error::Error + 'static)| {
        e.downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    };
    if error.chain().any(closed) {
        return ExitCode::SUCCESS;
    }
    if let Some(mission) = error.downcast_ref::<wisdom_mission::MissionError>() {
        complain(&mission.to_string());
        return ExitCode::from(BAD_INPUT);
    }
    complain(&format!("error: {error:#}"));
    let input =
        error.chain().any(|e| e.is::<InputError>() || e.is::<wisdom_mission::MissionError>());
    ExitCode::from(if input { BAD_INPUT } else { FAILED })
}

#[expect(clippy::print_stderr, reason = "this is where the command speaks of its errors")]
fn complain(text: &str) {
    eprintln!("{text}");
}
