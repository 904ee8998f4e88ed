//! The study's tables, charts and files.

use std::fmt::Write as _;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::{Value, json};
use wisdom_mission::statistics::Interval;

use crate::chart::Intervals;
use crate::study::instance::{Generator, PRIZE, SIDE_M};
use crate::study::rule::Rule;
use crate::study::summary::{Step, Summary, ranking, summaries};
use crate::study::{Found, Study};

/// What one generator gave.
pub(crate) struct Outcome {
    generator: Generator,
    /// By instance, then by rule.
    found: Vec<Vec<Found>>,
    summaries: Vec<Summary>,
    ranking: Vec<Step>,
}

impl Outcome {
    /// Sums up what was found.
    pub(crate) fn new(generator: Generator, found: Vec<Vec<Found>>, study: &Study) -> Self {
        let summaries = summaries(&found, study.seed);
        let ranking = ranking(&found, study.seed);
        Self { generator, found, summaries, ranking }
    }

    /// Instances in which every plan of the sequencer is proven best in its own terms.
    fn proven(&self) -> usize {
        self.found.iter().filter(|rules| rules.iter().all(|found| found.proven)).count()
    }

    /// The rules by mean loss: `<` where two are told apart, `~` where they are not.
    fn order(&self) -> String {
        let mut text = self.ranking[0].better.key().to_owned();
        for step in &self.ranking {
            let sign = if step.is_clear() { '<' } else { '~' };
            write!(text, " {sign} {}", step.worse.key())
                .expect("a string takes all that is written");
        }
        text
    }
}

pub(crate) fn write_tables(
    out: &mut dyn Write,
    study: &Study,
    results: &[Outcome],
) -> std::io::Result<()> {
    let Study { instances, goals, seed } = study;
    writeln!(
        out,
        "Loss in expected interest (J1) against the optimum: {instances} instances of {goals} goals, seed {seed}"
    )?;
    for result in results {
        let Generator { key, title, .. } = result.generator;
        writeln!(out, "\n{key}: {title}")?;
        for line in told(result, study) {
            writeln!(out, "    {line}")?;
        }
        writeln!(out, "{}", table(result, *instances).trim_fmt())?;
    }
    writeln!(
        out,
        "\nBy mean loss; < where the 95 % interval of the paired difference leaves out 0, ~ where it does not:"
    )?;
    for result in results {
        writeln!(out, "  {}: {}", result.generator.key, result.order())?;
    }
    writeln!(
        out,
        "\noptimal: share of the instances without loss; 95 %: bootstrap interval of the mean loss;\n\
         best of the rest: share of the instances in which no rule but J1 does better, ties shared;\n\
         R: mean reliability of the plans; goals: their mean number; greedy-rate: greedy interest / cost;\n\
         greedy-reliable-rate: greedy R x interest / cost"
    )
}

fn told(result: &Outcome, study: &Study) -> [String; 2] {
    let Generator { budget_share, hazard_per_m: [least, most], .. } = result.generator;
    [
        format!(
            "hazard {least} to {most:.4} per m, budget {budget_share} of the shortest way through all goals"
        ),
        format!(
            "J1 proven in {} of {} instances, all of the sequencer's plans in {}",
            result.summaries[0].proven,
            study.instances,
            result.proven()
        ),
    ]
}

fn table(result: &Outcome, instances: usize) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "rule",
        "optimal",
        "mean\nloss",
        "95 %",
        "median",
        "95th\npercentile",
        "worst",
        "best of\nthe rest",
        "R",
        "goals",
    ]);
    for summary in &result.summaries {
        table.add_row([
            summary.rule.title().to_owned(),
            percent(summary.optimal as f64 / instances as f64),
            percent(summary.mean.mean),
            format!("{:.1} to {}", 100.0 * summary.mean.low, percent(summary.mean.high)),
            percent(summary.median),
            percent(summary.percentile_95),
            percent(summary.worst),
            summary.best_of_rest.map_or_else(|| "-".to_owned(), percent),
            format!("{:.3}", summary.reliability),
            format!("{:.1}", summary.goals),
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn percent(share: f64) -> String {
    // A sum's last bit is no loss, and no gain.
    let share = if share.abs() < 1e-9 { 0.0 } else { share };
    format!("{:.1} %", 100.0 * share)
}

pub(crate) fn json(study: &Study, results: &[Outcome]) -> Value {
    let generators: Vec<Value> = results
        .iter()
        .map(|result| {
            let Generator { key, title, budget_share, hazard_per_m } = result.generator;
            json!({
                "generator": key,
                "title": title,
                "budget_share": budget_share,
                "hazard_per_m": hazard_per_m,
                "all_proven": result.proven(),
                "rules": result.summaries.iter().map(rule).collect::<Vec<_>>(),
                "ranking": result.ranking.iter().map(step).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "instances": study.instances,
        "goals": study.goals,
        "seed": study.seed,
        "side_m": SIDE_M,
        "prize": PRIZE,
        "generators": generators,
    })
}

fn rule(summary: &Summary) -> Value {
    let Interval { mean, low, high } = summary.mean;
    json!({
        "rule": summary.rule.key(),
        "title": summary.rule.title(),
        "optimal": summary.optimal,
        "best_of_rest": summary.best_of_rest,
        "mean_loss": mean,
        "mean_loss_95": [low, high],
        "median_loss": summary.median,
        "loss_95th_percentile": summary.percentile_95,
        "worst_loss": summary.worst,
        "mean_reliability": summary.reliability,
        "mean_goals": summary.goals,
        "proven": summary.proven,
    })
}

fn step(step: &Step) -> Value {
    let Interval { mean, low, high } = step.difference;
    json!({
        "better": step.better.key(),
        "worse": step.worse.key(),
        "difference": mean,
        "difference_95": [low, high],
        "clear": step.is_clear(),
    })
}

/// Writes the charts, the numbers and the plans; returns the files' paths.
pub(crate) fn write_files(
    folder: &Path,
    study: &Study,
    results: &[Outcome],
    object: &Value,
) -> anyhow::Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    for result in results {
        let name = format!("losses-{}", result.generator.key);
        let paths = draw(folder, &name, study, result)
            .with_context(|| format!("{name} in {}", folder.display()))?;
        written.extend(paths);
    }
    for (name, text) in
        [("rules_of_thumb.json", format!("{object:#}\n")), ("plans.csv", plans(results))]
    {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| path.display().to_string())?;
        written.push(path);
    }
    Ok(written)
}

fn draw(
    folder: &Path,
    name: &str,
    study: &Study,
    result: &Outcome,
) -> anyhow::Result<[PathBuf; 2]> {
    let percents = |Interval { mean, low, high }: Interval| Interval {
        mean: 100.0 * mean,
        low: 100.0 * low,
        high: 100.0 * high,
    };
    let row = |summary: &Summary| (summary.rule.title().to_owned(), percents(summary.mean));
    // The optimum's loss is 0 by definition.
    let rows: Vec<_> = result.summaries[1..].iter().map(row).collect();
    let Study { instances, goals, seed } = study;
    let [drawn, proven] = told(result, study);
    let remarks = [
        format!("{}; {instances} instances of {goals} goals, seed {seed}", result.generator.title),
        drawn,
        proven,
        "Whiskers: 95 % (bootstrap). Dashed: the optimum of J1.".to_owned(),
    ];
    let chart = Intervals {
        title: "What rules of thumb lose in expected interest",
        remarks: &remarks,
        quantity: "mean loss (% of the optimum)",
        rows: &rows,
        zero_line: true,
        whiskers: *instances > 1,
    };
    chart.drawing().write(folder, name)
}

/// What every rule found in every instance, a line each.
fn plans(results: &[Outcome]) -> String {
    let mut text =
        "generator,instance,rule,expected,prize,reliability,length_m,goals,loss,proven\n"
            .to_owned();
    for result in results {
        for (number, found) in result.found.iter().enumerate() {
            for (rule, Found { drive, goals, loss, proven }) in Rule::ALL.iter().zip(found) {
                let (key, rule) = (result.generator.key, rule.key());
                let (expected, prize, r) = (drive.expected, drive.prize, drive.reliability);
                let length = drive.length_m;
                writeln!(
                    text,
                    "{key},{number},{rule},{expected},{prize},{r},{length},{goals},{loss},{proven}"
                )
                .expect("a string takes all that is written");
            }
        }
    }
    text
}
