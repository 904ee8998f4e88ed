//! The `wisdom` command: run missions, replay and verify their logs, compare rules.

mod campaign;
mod chart;
mod check;
mod combine;
mod compare;
mod exit;
mod explain;
mod export;
mod figure;
mod log;
mod mission_args;
mod paper;
mod redecide;
mod remade;
mod replay;
mod report;
mod rules;
mod run;
mod schema;
mod show;
mod terrain;
mod verify;
mod view;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Run, replay, verify and compare missions of a planetary rover that chooses its own goals.
///
/// Exit codes: 0 all went well; 1 a run or a check failed; 2 a mistake in what was given; 3 the log or campaign at
/// hand is not complete.
#[derive(Parser, Debug)]
#[command(name = "wisdom", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Run a mission in closed loop and log it.
    Run(run::RunArgs),
    /// Tell a logged mission as a story, decision by decision.
    Replay(replay::ReplayArgs),
    /// Tell why a logged decision left goals out, and what would have brought them in.
    Explain(explain::ExplainArgs),
    /// Derive every decision of a log again from its logged inputs and compare.
    Verify(verify::VerifyArgs),
    /// Take every logged decision again under another rule, policy or value.
    Redecide(redecide::RedecideArgs),
    // Without a doc comment: one here would hide that of `CompareArgs`, which says what is told.
    Compare(compare::CompareArgs),
    // Without a doc comment: one here would hide that of `CampaignArgs`, which says what the folder holds.
    Campaign(campaign::CampaignArgs),
    // As above.
    View(view::ViewArgs),
    // As above.
    Report(report::ReportArgs),
    /// Draw a map of a logged decision.
    Show(show::ShowArgs),
    /// Hand a logged decision to other tools: PDDL for planners, DOT for drawings.
    Export(export::ExportArgs),
    /// Look into a log, check it, or save what a broken one still holds.
    Log(log::LogArgs),
    /// Check a mission without running it.
    Check(check::CheckArgs),
    // Without a doc comment, as above.
    Schema(schema::SchemaArgs),
    /// List the rules of combination, or explain one.
    Rules(rules::RulesArgs),
    // As above.
    Combine(combine::CombineArgs),
    // As above.
    Terrain(terrain::TerrainArgs),
    /// Recompute the paper's tables, equations and claims, beside the printed values.
    Paper(paper::PaperArgs),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Redecide(args) => redecide::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Campaign(args) => campaign::run(&args),
        Command::View(args) => view::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Show(args) => show::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Log(args) => log::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Schema(args) => schema::run(&args),
        Command::Rules(args) => rules::run(&args),
        Command::Combine(args) => combine::run(&args),
        Command::Terrain(args) => terrain::run(&args),
        Command::Paper(args) => paper::run(&args),
    };
    outcome.unwrap_or_else(|error| exit::report(&error))
}
