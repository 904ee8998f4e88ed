//! `wisdom check`: validates a mission without running it.

use std::io::Write;
use std::process::ExitCode;

use serde_json::json;
use wisdom_autonomy::Source;
use wisdom_goals::{Directive, Policy};
use wisdom_mission::{DecisionBound, Lint, Mission, Warning, lint};

use crate::exit::FAILED;
use crate::mission_args::MissionArgs;

/// Check a mission without running it.
#[derive(clap::Args, Debug)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    mission: MissionArgs,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// End with exit code 1 if there are warnings.
    #[arg(long)]
    strict: bool,
}

pub(crate) fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let mission = args.mission.load(&[])?;
    let mut remarks = remarks(&mission);
    let (unchecked, warnings): (Vec<Warning>, Vec<Warning>) =
        lint(&mission).into_iter().partition(|warning| warning.lint == Lint::NotChecked);
    remarks.extend(unchecked.into_iter().map(|remark| format!("not checked: {}", remark.message)));
    let code = if args.strict && !warnings.is_empty() { FAILED } else { 0 };
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
            "objective": {
                "confidence": spec.preferences.confidence,
                "risk_price": spec.preferences.prices.risk,
                "energy_price_per_j": spec.preferences.prices.energy_per_j,
                "time_price_per_s": spec.preferences.prices.time_per_s,
                "data_price_per_mb": spec.preferences.prices.data_per_mb,
            },
            "mandatory": spec
                .directives
                .iter()
                .filter(|d| d.mandatory)
                .map(|d| &d.name)
                .collect::<Vec<_>>(),
            "decisions_at_most": DecisionBound::of(&mission).decisions(),
            "remarks": remarks,
            "warnings": warnings.iter().map(json_of).collect::<Vec<_>>(),
        });
        writeln!(out, "{object}")?;
        return Ok(ExitCode::from(code));
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
    write_objective(&mut out, &mission)?;
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
            "  directive   {} wants {} by {}{}",
            directive.name,
            wants.join(", "),
            operators.join(", "),
            urgency(directive)
        )?;
    }
    writeln!(
        out,
        "  decisions   at most {}, by what each must cost; the mission's own limit is {}",
        DecisionBound::of(&mission).decisions(),
        mission.world.execution().max_decisions
    )?;
    for remark in &remarks {
        writeln!(out, "  remark      {remark}")?;
    }
    for warning in &warnings {
        writeln!(out, "  warning     {warning}")?;
    }
    let found = match warnings.len() {
        0 => "nothing wrong".to_owned(),
        1 => "1 warning".to_owned(),
        n => format!("{n} warnings"),
    };
    writeln!(out, "ok: {} files, {found}", mission.files.len())?;
    Ok(ExitCode::from(code))
}

fn json_of(warning: &Warning) -> serde_json::Value {
    json!({
        "rule": warning.lint.name(),
        "file": warning.file,
        "line": warning.place.map(|(line, _)| line),
        "column": warning.place.map(|(_, column)| column),
        "key": warning.key,
        "message": warning.message,
    })
}

/// What the policy is told besides the plan, and which of it this policy asks for.
fn write_objective(out: &mut dyn Write, mission: &Mission) -> std::io::Result<()> {
    let spec = &mission.spec;
    let (confidence, prices) = (spec.preferences.confidence, &spec.preferences.prices);
    let asked = match spec.policy {
        Policy::ChanceConstrained => "the confidence",
        Policy::NetBenefit => "the prices of risk and energy",
        Policy::Utility => "all four prices",
        _ => "none of it",
    };
    writeln!(
        out,
        "  objective   confidence {confidence}; prices {} of -ln R, {} a kJ, {} an hour, {} a MB; {} asks for {asked}",
        prices.risk,
        prices.energy_per_j * 1e3,
        prices.time_per_s * 3600.0,
        prices.data_per_mb,
        spec.policy
    )
}

/// Whether a directive comes before others, or is worth less with time.
fn urgency(directive: &Directive) -> String {
    let mandatory = if directive.mandatory { "; mandatory" } else { "" };
    match directive.fade {
        None => mandatory.to_owned(),
        Some(fade) => format!(
            "{mandatory}; whole until {} s, worth nothing from {} s on",
            fade.full_until_s, fade.nothing_from_s
        ),
    }
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
        let readings = &mission.world.execution().readings;
        let handed_in = readings.iter().any(|reading| reading.layer == layer.name);
        if mission.world.is_handed_in(&layer.name) {
            if !handed_in {
                remarks.push(format!("layer `{}`: no reading of it is handed in", layer.name));
            }
        } else if matches!(layer.source, Source::Measured(_)) && !seen && !handed_in {
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
