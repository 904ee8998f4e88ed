//! `wisdom paper`: the paper's numbers and claims, recomputed and held against what it prints.

mod check;
mod expected;
mod figures;
mod refined;
mod scene;
mod tables;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::json;
use wisdom_mission::Mission;

use crate::exit::FAILED;
use check::Check;
use expected::Expected;
use scene::Look;
use tables::Panel;

/// Recompute the paper's tables, equations and claims, beside the printed values.
///
/// Sections III and IV of Ceriotti et al., "An Approach to Model Interest for Planetary Rover through DSmT".
/// Rows without a verdict are there to be read. Exit code 1 if a check fails.
#[derive(clap::Args, Debug)]
pub(crate) struct PaperArgs {
    /// Draw Figs. 2 to 10 into this folder, as PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// The folder of the paper's mission, with its expected.toml.
    #[arg(long, value_name = "PATH", default_value = "missions/paper")]
    mission: PathBuf,
}

pub(crate) fn run(args: &PaperArgs) -> anyhow::Result<ExitCode> {
    let mission = Mission::load(&args.mission, &[])?;
    let expected = Expected::load(&args.mission, mission.spec.grid)?;
    let panel = Panel::of(&mission)?;
    let look = Look::take(&mission)?;

    let mut checks = tables::checks(&panel, &expected.point)?;
    checks.extend(refined::checks(&panel.table_6(&expected.point)?)?);
    checks.extend(scene::checks(&look, &expected, &panel));
    let drawn = match &args.figures {
        Some(folder) => figures::draw(&look, &expected, folder)?,
        None => Vec::new(),
    };

    let mut out = std::io::stdout().lock();
    let failed: Vec<&Check> = checks.iter().filter(|c| c.passes() == Some(false)).collect();
    let judged = checks.iter().filter(|c| c.passes().is_some()).count();
    if args.json {
        let object = json!({
            "mission": mission.name,
            "seed": mission.seed,
            "checks": judged,
            "failed": failed.len(),
            "rows": checks.iter().map(Check::json).collect::<Vec<_>>(),
            "figures": drawn,
        });
        writeln!(out, "{object}")?;
    } else {
        write_tables(&mut out, &checks)?;
        for path in &drawn {
            writeln!(out, "drawn   {}", path.display())?;
        }
        for check in &failed {
            writeln!(out, "failed  {} / {}", check.group, check.name)?;
        }
        writeln!(out, "{judged} checks, {} failed", failed.len())?;
    }
    Ok(if failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

/// One table a group, in the order of the paper.
fn write_tables(out: &mut dyn Write, checks: &[Check]) -> std::io::Result<()> {
    let widest = checks.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    for group in checks.chunk_by(|a, b| a.group == b.group) {
        writeln!(out, "{}", group[0].group)?;
        let mut table = Table::new();
        // Without lines: there are more than a hundred rows.
        table.load_style(NOTHING);
        let name = format!("{:widest$}", "");
        table.set_header([name.as_str(), "computed", "printed or limit", "within", ""]);
        for check in group {
            table.add_row(check.cells());
        }
        for numbers in 1..=3 {
            if let Some(column) = table.column_mut(numbers) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        writeln!(out, "{}\n", table.trim_fmt())?;
    }
    Ok(())
}
