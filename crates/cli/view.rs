//! `wisdom view`: a log, or two, in the browser.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context;
use serde_json::json;
use wisdom_logbook::{IndexedLog, LogError};
use wisdom_viewer::{Server, Shown};

use crate::exit::{self, InputError};
use crate::remade::OfLog;

/// Show a log in the browser; two side by side.
///
/// The page is served to this machine alone, under an address that cannot be guessed, until Ctrl-C. It asks nobody else for
/// anything. What the log holds only as digests (what each expert said, credits, ways of alternatives, price tags) is made again while
/// it is looked at.
#[derive(clap::Args, Debug)]
pub(crate) struct ViewArgs {
    /// The log (NAME.mcap or NAME.mcap.part); it may still grow, the page shows what is there when it is loaded.
    log: PathBuf,
    /// A second log, to be held against the first.
    log_b: Option<PathBuf>,
    /// The port; any free one by default.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Do not open a browser, only say where the page is.
    #[arg(long)]
    no_open: bool,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &ViewArgs) -> anyhow::Result<ExitCode> {
    let first = shown(&args.log)?;
    let second = args.log_b.as_deref().map(shown).transpose()?;
    let server = Server::bind(args.port, first, second)
        .map_err(|error| InputError(format!("--port {}: {error}", args.port)))?;
    let address = server.address();
    let mut out = std::io::stdout().lock();
    if args.json {
        writeln!(out, "{}", json!({ "address": address }))?;
    } else {
        writeln!(out, "{address}\nCtrl-C ends it.")?;
    }
    out.flush()?;
    drop(out);
    if !args.no_open
        && let Err(error) = open::that_detached(&address)
    {
        exit::complain(&format!("remark: no browser could be opened ({error}); open it yourself"));
    }
    server.serve().context("the server stopped")?;
    Ok(ExitCode::SUCCESS)
}

fn shown(path: &Path) -> anyhow::Result<Shown> {
    check(path)?;
    let remade = Arc::new(OfLog::new(path));
    let ahead = Arc::clone(&remade);
    std::thread::spawn(move || ahead.go_through());
    Ok(Shown { name: name(path), log: path.to_path_buf(), remade })
}

/// What a log is called on the page.
pub(crate) fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Refuses what is no MCAP file. A cut or damaged one is let in: the page says what is wrong with it.
pub(crate) fn check(path: &Path) -> Result<(), LogError> {
    IndexedLog::open(path).map(drop)
}
