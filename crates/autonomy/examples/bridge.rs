//! A bridge from a rover's own software to the core: frames in as JSON lines, decisions out as JSON lines. No
//! simulator, no mission file, no log: what an integrator would write to put the core into a rover.
//!
//! ```sh
//! cargo run --example bridge -p wisdom-autonomy < crates/autonomy/examples/bridge/frames.jsonl
//! ```
//!
//! `bridge/README.md` says what the lines hold, `bridge/rover.rs` what the core is told once. With `--strict` the first
//! line that is refused ends it; without, reading goes on and the exit code is 1 at the end.

#[path = "bridge/lines.rs"]
mod lines;
#[path = "bridge/rover.rs"]
mod rover;
#[path = "bridge/serve.rs"]
mod serve;

use std::error::Error;
use std::io::{stderr, stdin, stdout};
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let refusals = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => serve::Refusals::GoOn,
        ["--strict"] => serve::Refusals::End,
        _ => return Err(format!("found {arguments:?}; expected nothing, or --strict").into()),
    };
    let refused =
        serve::serve(rover::spec()?, stdin().lock(), stdout().lock(), stderr().lock(), refusals)?;
    Ok(if refused == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
