//! `wisdom schema`: the JSON Schema of a mission's files, for editors.

use std::io::Write;
use std::process::ExitCode;

use wisdom_mission::{Described, schema};

/// Print the JSON Schema (draft 2020-12) of mission.toml, of an expert's table or of a landscape.
///
/// Editors with the TOML language server taplo (Even Better TOML) complete and check a file whose first line is
/// `#:schema PATH`, the path of this command's output.
#[derive(clap::Args, Debug)]
pub(crate) struct SchemaArgs {
    /// The file to describe.
    #[arg(long, value_enum, default_value_t = File::Mission)]
    of: File,
}

#[derive(clap::ValueEnum, Debug, Clone, Copy)]
enum File {
    /// mission.toml
    Mission,
    /// An expert's table
    Expert,
    /// A synthetic landscape
    Landscape,
}

pub(crate) fn run(args: &SchemaArgs) -> anyhow::Result<ExitCode> {
    let schema = schema(match args.of {
        File::Mission => Described::Mission,
        File::Expert => Described::Expert,
        File::Landscape => Described::Landscape,
    });
    writeln!(std::io::stdout().lock(), "{schema:#}")?;
    Ok(ExitCode::SUCCESS)
}
