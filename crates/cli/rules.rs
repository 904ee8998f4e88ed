//! `wisdom rules`: the rules of combination.

use std::io::Write;
use std::process::ExitCode;

use serde_json::json;
use wisdom_belief::Rule;

use crate::combine::operation;

/// List the rules of combination, or explain one.
#[derive(clap::Args, Debug)]
pub(crate) struct RulesArgs {
    /// Explain this rule: formula, model, order, source, examples.
    rule: Option<String>,
    /// Print JSON instead of text, an object a line.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &RulesArgs) -> anyhow::Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    let rules = match &args.rule {
        None => Rule::ALL.to_vec(),
        Some(name) => {
            let rule: Rule =
                name.parse().map_err(|error| crate::exit::InputError(format!("{error}")))?;
            vec![rule]
        }
    };
    if args.json {
        for rule in rules {
            let (algebra, params) = (rule.algebra(), operation::rule_params(rule));
            let object = json!({
                "name": rule.name(),
                "operation": operation::rule_name(rule),
                "summary": rule.summary(),
                "on_maps": rule.on_maps(),
                "associative": algebra.associative,
                "vacuous_is_neutral": algebra.vacuous_is_neutral,
                "idempotent": algebra.idempotent,
                "params": params.iter().map(|param| param.name).collect::<Vec<_>>(),
            });
            writeln!(out, "{object}")?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    if args.rule.is_some() {
        write!(out, "{}", rules[0].page())?;
        return Ok(ExitCode::SUCCESS);
    }
    for rule in rules {
        let maps = if rule.on_maps() { "" } else { " (not on maps)" };
        writeln!(out, "{:16} {}{maps}", rule.name(), rule.summary())?;
    }
    Ok(ExitCode::SUCCESS)
}
