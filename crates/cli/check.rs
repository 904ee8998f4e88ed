//! `wisdom check`: validates a mission without running it.

use std::io::Write;
use std::process::ExitCode;

use serde_json::json;
use wisdom_autonomy::Source;
use wisdom_mission::Mission;

use crate::mission_args::MissionArgs;

/// Check a mission without running it.
#[derive(clap::Args, Debug)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    mission: MissionArgs,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let mission = args.mission.load(&[])?;
    let remarks = remarks(&mission);
    let mut out = std::io::stdout().lock();
    let spec = &mission.spec;
    let grid = spec.grid;
    if args.json {
        let object = json!({
            "mission": mission.name,
            "seed": mission.seed,
            "rule": spec.fusion.rule.to_string(),
            "policy": spec.policy.to_string(),
            "prize": spec.prize.to_string(),
            "grid": { "rows": grid.rows(), "cols": grid.cols(), "spacing_m": grid.spacing_m() },
            "layers": spec.layers.iter().map(|l| &l.name).collect::<Vec<_>>(),
            "experts": spec.experts.iter().map(|e| &e.name).collect::<Vec<_>>(),
            "directives": spec.directives.iter().map(|d| &d.name).collect::<Vec<_>>(),
            "operators": spec.domain.operators().iter().map(|o| &o.name).collect::<Vec<_>>(),
            "files": mission.files.keys().collect::<Vec<_>>(),
            "remarks": remarks,
        });
        writeln!(out, "{object}")?;
        return Ok(ExitCode::SUCCESS);
    }
    writeln!(out, "{}: {}", mission.name, mission.summary)?;
    writeln!(
        out,
        "  grid        {} x {} cells of {} m, start at {}",
        grid.rows(),
        grid.cols(),
        grid.spacing_m(),
        mission.world.execution().start
    )?;
    writeln!(
        out,
        "  fusion      rule {}, statistic {}, prize {}, policy {}, seed {}",
        spec.fusion.rule, spec.fusion.statistic, spec.prize, spec.policy, mission.seed
    )?;
    write_rover(&mut out, &mission)?;
    for layer in &spec.layers {
        let source = match layer.source {
            Source::Measured(_) => "measured",
            Source::Derived(_) => "derived",
        };
        let unit = if layer.unit.is_empty() { "no unit" } else { &layer.unit };
        let readers: Vec<&str> = spec
            .experts
            .iter()
            .filter(|e| e.layer == layer.name)
            .map(|e| e.name.as_str())
            .collect();
        let readers = if readers.is_empty() { "no expert".into() } else { readers.join(", ") };
        writeln!(out, "  layer       {} ({unit}, {source}), read by {readers}", layer.name)?;
    }
    for directive in &spec.directives {
        let wants: Vec<&str> = spec.domain.names(directive.achieves).collect();
        let plan = spec.domain.expand(spec.domain.initial(), directive.achieves);
        let operators: Vec<&str> = plan
            .iter()
            .flat_map(|p| {
                p.before.iter().copied().chain([spec.domain.drive()]).chain(p.after.iter().copied())
            })
            .map(|i| spec.domain.operators()[i].name.as_str())
            .collect();
        writeln!(
            out,
            "  directive   {} wants {} by {}",
            directive.name,
            wants.join(", "),
            operators.join(", ")
        )?;
    }
    for remark in &remarks {
        writeln!(out, "  remark      {remark}")?;
    }
    writeln!(out, "ok: {} files, nothing wrong", mission.files.len())?;
    Ok(ExitCode::SUCCESS)
}

/// What the rover is, which ways are weighed, and what may break.
fn write_rover(out: &mut dyn Write, mission: &Mission) -> std::io::Result<()> {
    let spec = &mission.spec;
    let v = &spec.vehicle;
    let classes: Vec<String> =
        v.slip_class.iter().map(|c| format!("{} {}", c.class, c.name).trim().to_owned()).collect();
    let slip = match &spec.slip_layer {
        Some(layer) => format!("by {layer} ({})", classes.join(", ")),
        None => "the same everywhere".to_owned(),
    };
    writeln!(
        out,
        "  vehicle     {} kg, slopes to {}\u{b0}, steps to {} m, risk level {}, slip {slip}",
        v.mass_kg, v.slope_max_deg, v.step_max_m, v.risk_level
    )?;
    let ways = match spec.routes.alternatives {
        1 => "the most reliable way of each leg".to_owned(),
        n => format!("up to {n} ways of each leg"),
    };
    writeln!(out, "  routes      {ways}, up to {} plans of an order", spec.routes.front)?;
    for fault in &mission.world.execution().faults {
        let (name, kind, p) = (&fault.name, fault.kind.name(), fault.probability);
        writeln!(out, "  fault       {name} ({kind}), in {p} of all missions")?;
    }
    Ok(())
}

/// What is allowed and yet may not be meant.
fn remarks(mission: &Mission) -> Vec<String> {
    let mut remarks = Vec::new();
    for expert in &mission.spec.experts {
        for (lo, hi) in expert.table.gaps() {
            remarks.push(format!(
                "expert `{}`: no band covers [{lo}, {hi}); readings there take the row `outside`",
                expert.name
            ));
        }
    }
    for layer in &mission.spec.layers {
        let seen = mission.world.instruments().iter().any(|i| i.layers.contains(&layer.name));
        if matches!(layer.source, Source::Measured(_)) && !seen {
            remarks.push(format!("layer `{}`: no instrument reads it", layer.name));
        }
    }
    let spec = &mission.spec;
    match &spec.slip_layer {
        None if mission_lists_classes(mission) => remarks.push(
            "rover.vehicle.slip-class has no effect: no rover.slip-layer says where the classes are"
                .to_owned(),
        ),
        None => {}
        Some(layer) => {
            let known = mission.world.classes(layer).unwrap_or_default();
            for listed in &spec.vehicle.slip_class {
                if !known.contains(&(listed.class as f32)) {
                    let class = listed.class;
                    remarks.push(format!("slip class {class}: layer `{layer}` has no such class"));
                }
            }
        }
    }
    for fault in &mission.world.execution().faults {
        let name = &fault.name;
        if fault.between_s.0 >= spec.budget.time_s {
            remarks.push(format!("fault `{name}`: it strikes after the time budget, so never"));
        }
        if fault.lasts_s == 0.0 {
            remarks.push(format!("fault `{name}`: it lasts no time, so it does nothing"));
        }
    }
    remarks
}

/// Whether the mission itself, not a preset, lists slip classes.
fn mission_lists_classes(mission: &Mission) -> bool {
    let file = mission.files.get(wisdom_mission::MISSION_FILE);
    let text = file.and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or_default();
    let table = text.parse::<toml::Table>().unwrap_or_default();
    let vehicle = table.get("rover").and_then(|rover| rover.get("vehicle"));
    vehicle.is_some_and(|vehicle| vehicle.get("slip-class").is_some())
}
