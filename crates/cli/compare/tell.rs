//! The comparison in tables, for people.

use std::io::{self, Write};

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use wisdom_grid::Cell;
use wisdom_logbook::comparison::{AtStates, Chosen, Divergence, Edit, Inputs};
use wisdom_mission::statistics::Interval;

use super::against::States;
use super::paired::{FEW_WORLDS, METRICS, Paired};
use super::world::{Compared, World};

/// The most states that are told one by one; `--csv` and `--json` have all of them.
const STATES_TOLD: usize = 8;
/// The most differing keys that are told one by one.
const KEYS_TOLD: usize = 6;
/// The most places of a choice that are told.
const PLACES_TOLD: usize = 3;

pub(super) fn write(
    out: &mut dyn Write,
    worlds: &[World],
    paired: Option<&Paired>,
) -> io::Result<()> {
    for world in worlds {
        if let Some(warning) = world.warning() {
            writeln!(out, "{warning}\n")?;
        }
        sequences(out, world)?;
        runs(out, world)?;
        for run in &world.runs[1..] {
            against(out, world, run)?;
        }
        regret(out, world)?;
    }
    paired.map_or(Ok(()), |paired| over_worlds(out, paired, worlds))
}

fn table<T: ToString>(header: impl IntoIterator<Item = T>) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(header.into_iter().map(|name| name.to_string()));
    table
}

fn dash() -> String {
    "-".to_owned()
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(dash, |value| format!("{value:.decimals$}"))
}

fn sequences(out: &mut dyn Write, world: &World) -> io::Result<()> {
    writeln!(out, "{}: goals reached, in order (same name, same place)", world.title())?;
    let names = world.runs.iter().map(Compared::marked);
    let mut table = table(std::iter::once("stop".to_owned()).chain(names));
    let longest = world.runs.iter().map(|run| run.goals.len()).max().unwrap_or(0);
    for turn in 0..longest {
        let mut row = vec![(turn + 1).to_string()];
        for (run, sequence) in world.runs.iter().zip(&world.places.sequences) {
            row.push(run.goals.get(turn).map_or_else(String::new, |goal| {
                format!(
                    "{} ({}, {}) {}",
                    World::place(sequence[turn]),
                    goal.target.row,
                    goal.target.col,
                    number(goal.ruler, 3)
                )
            }));
        }
        table.add_row(row);
    }
    writeln!(out, "{table}")?;
    writeln!(out, "P: place (row, col) and its interest on the common ruler")?;
    footnotes(out, world)
}

/// What stars beside names say, and an empty line.
fn footnotes(out: &mut dyn Write, world: &World) -> io::Result<()> {
    for footnote in world.footnotes() {
        writeln!(out, "{footnote}")?;
    }
    writeln!(out)
}

fn runs(out: &mut dyn Write, world: &World) -> io::Result<()> {
    let labelled = world.runs.iter().any(|run| !run.known.is_empty());
    let mut header = vec![
        "run",
        "goals",
        "interest\nown map",
        "interest\nruler",
        "labels\nfound",
        "distance\nm",
    ];
    header.extend(["reliab.", "realloc.", "Jaccard", "Kendall", "edits", "parts at\nstop"]);
    header.push("parts at\ndecision");
    header.retain(|name| labelled || *name != "labels\nfound");
    let mut table = table(header);
    for run in &world.runs {
        let held = &run.against;
        let lined_up = held.lined_up.as_ref();
        let mut row = vec![
            run.marked(),
            run.goals.len().to_string(),
            format!("{:.3}", run.interest),
            number(run.ruler, 3),
        ];
        if labelled {
            let found = run.goals.iter().filter(|goal| goal.label.is_some()).count();
            row.push(format!("{found} of {}", run.known.len()));
        }
        row.extend([
            format!("{:.0}", run.spent.length_m),
            number(run.reliability, 3),
            run.reallocations.to_string(),
            number(lined_up.map(|lined_up| lined_up.jaccard), 2),
            number(lined_up.and_then(|lined_up| lined_up.tau), 2),
            lined_up.map_or_else(dash, |lined_up| lined_up.alignment.distance().to_string()),
            lined_up
                .and_then(|lined_up| lined_up.stop)
                .map_or_else(dash, |stop| (stop + 1).to_string()),
            held.divergence.as_ref().map_or_else(dash, |d| d.decision.to_string()),
        ]);
        table.add_row(row);
    }
    writeln!(out, "{table}")?;
    writeln!(
        out,
        "Jaccard, Kendall, edits and where they part: against {}. Ruler: interest on the noise-free, fully\n\
         known world under dsmc.",
        world.runs[0].marked()
    )?;
    footnotes(out, world)
}

fn against(out: &mut dyn Write, world: &World, run: &Compared) -> io::Result<()> {
    let (first, this) = (&world.runs[0].marked(), &run.marked());
    writeln!(out, "{this} against {first}")?;
    let held = &run.against;
    for (i, line) in given(&held.inputs).into_iter().enumerate() {
        writeln!(out, "  {:<9} {line}", if i == 0 { "given" } else { "" })?;
    }
    writeln!(out, "  {:<9} {}", "told", told(&held.inputs))?;
    match &held.divergence {
        None => writeln!(out, "  {:<9} nowhere: all {} decisions agree", "part", held.both)?,
        Some(divergence) => part(out, divergence, first, this)?,
    }
    aligned(out, run)?;
    match &held.states {
        States::Unasked => {}
        States::Unfit(what) => {
            writeln!(out, "  {:<9} not asked what each would have chosen: {what}", "states")?;
        }
        States::Asked { of_first, of_this } => {
            let agree =
                |states: &AtStates| format!("{} of {}", states.alike(), states.states.len());
            writeln!(
                out,
                "  {:<9} at {} states of {first}, {} chooses alike; at {} of {}, {first} does",
                "rule",
                agree(of_first),
                this,
                agree(of_this),
                this,
            )?;
            writeln!(
                out,
                "  {:<9} the runs themselves, each on its own way, choose alike at {} of {} decisions",
                "path",
                held.both - held.apart,
                held.both
            )?;
            states(out, first, this, of_first)?;
            states(out, this, first, of_this)?;
            if of_first.alike() + of_this.alike() < of_first.states.len() + of_this.states.len() {
                writeln!(
                    out,
                    "  `its own, worth` may be below `chosen, worth`: another policy, or places that are no goals there"
                )?;
            }
        }
    }
    writeln!(out)
}

/// What differs in what two runs were given, a line each.
fn given(inputs: &Inputs) -> Vec<String> {
    if inputs.are_equal() {
        return vec![format!("the same: all facts, and {} files byte for byte", inputs.same_files)];
    }
    let mut lines = Vec::new();
    let or_none = |value: &Option<String>| value.clone().unwrap_or_else(|| "none".to_owned());
    let facts: Vec<String> = inputs
        .facts
        .iter()
        .map(|fact| {
            format!("{} {} against {}", fact.name, or_none(&fact.left), or_none(&fact.right))
        })
        .collect();
    let rest = if inputs.differ_in_rule_alone() { "; nothing else" } else { "" };
    if !facts.is_empty() {
        lines.push(format!("{}{rest}", facts.join("; ")));
    }
    for file in &inputs.files {
        let name = file.name.strip_prefix("mission/").unwrap_or(&file.name);
        let mut told: Vec<String> = file
            .keys
            .iter()
            .take(KEYS_TOLD)
            .map(|key| {
                format!("{} = {} against {}", key.key, or_none(&key.left), or_none(&key.right))
            })
            .collect();
        let more = file.keys.len().saturating_sub(KEYS_TOLD);
        if more > 0 {
            told.push(format!("{more} keys more"));
        }
        let what = match (&file.left, &file.right) {
            (Some(_), None) => "only the first run has it".to_owned(),
            (None, Some(_)) => "the first run does not have it".to_owned(),
            _ if told.is_empty() => "differs".to_owned(),
            _ => format!("differs in {}", told.join(", ")),
        };
        lines.push(format!("{name} {what}"));
    }
    lines
}

fn told(inputs: &Inputs) -> String {
    match &inputs.observations {
        None => "the same: every observation".to_owned(),
        Some(told) => {
            let after = told.after_decision.map_or_else(
                || "before any decision".to_owned(),
                |decision| format!("after decision {decision}"),
            );
            format!("the same up to observation {}, {after}: {}", told.number, told.what)
        }
    }
}

fn part(out: &mut dyn Write, divergence: &Divergence, first: &str, this: &str) -> io::Result<()> {
    let Divergence { decision, parting, left, right, .. } = divergence;
    let Some(parting) = parting else {
        let only = if left.is_some() { first } else { this };
        return writeln!(
            out,
            "  {:<9} nowhere before decision {decision}, which only {only} took",
            "part"
        );
    };
    let knew = match (divergence.same_readings, divergence.same_rover, divergence.same_memory) {
        (true, true, true) => "readings, rover and memory still equal: the rule's own doing",
        (true, true, false) => {
            "readings and rover still equal, but not what the goal managers remember"
        }
        (true, false, _) => "readings still equal, but not the rovers",
        (false, true, _) => "rovers still equal, but not the readings",
        (false, false, _) => "neither readings nor rovers equal any more",
    };
    writeln!(out, "  {:<9} at decision {decision}, by {parting}: {knew}", "part")?;
    let width = first.chars().count().max(this.chars().count());
    for (name, chosen) in [(first, left), (this, right)] {
        if let Some(chosen) = chosen {
            writeln!(out, "            {name:<width$} {}", short(chosen))?;
        }
    }
    if let Some(difference) = &divergence.first {
        writeln!(
            out,
            "            first differing record: {}, {}",
            difference.stage, difference.path
        )?;
    }
    Ok(())
}

/// A choice with its first few places.
fn short(chosen: &Chosen) -> String {
    let mut told = chosen.clone();
    told.places.truncate(PLACES_TOLD);
    let more = chosen.places.len() - told.places.len();
    if more > 0 { format!("{told} > {more} more") } else { told.to_string() }
}

/// A choice with its first place, and those about a turn.
fn around(chosen: &Chosen, turn: usize) -> String {
    // One place before it shows where it is.
    let from = turn.saturating_sub(1);
    if from < 2 {
        return short(chosen);
    }
    let place = |(cell, _): &(Cell, String)| format!("({}, {})", cell.row, cell.col);
    let mut told = vec![chosen.places.first().map(place).unwrap_or_default(), "..".to_owned()];
    told.extend(chosen.places.iter().skip(from).take(PLACES_TOLD - 1).map(place));
    let more = chosen.places.len().saturating_sub(from + PLACES_TOLD - 1);
    if more > 0 {
        told.push(format!("{more} more"));
    }
    format!("{} {}", chosen.act, told.join(" > "))
}

/// The edit script in one line: kept places by name, and what was done with the others.
fn aligned(out: &mut dyn Write, run: &Compared) -> io::Result<()> {
    let Some(script) = run.against.lined_up.as_ref().map(|lined_up| &lined_up.alignment) else {
        return writeln!(out, "  {:<9} not lined up: they lie on different grids", "goals");
    };
    let count = |name: &str| script.count(name);
    writeln!(
        out,
        "  {:<9} {} edits: {} moved, {} inserted, {} deleted; {} kept",
        "goals",
        script.distance(),
        count("move"),
        count("insert"),
        count("delete"),
        count("keep")
    )?;
    let line: Vec<String> = script
        .edits
        .iter()
        .map(|&edit| {
            let place = World::place(edit.place());
            match edit {
                Edit::Keep { .. } => place,
                Edit::Delete { .. } => format!("-{place}"),
                Edit::Insert { .. } => format!("+{place}"),
                Edit::Move { from, to, .. } => format!("{place}({}>{})", from + 1, to + 1),
            }
        })
        .collect();
    if script.distance() > 0 { writeln!(out, "            {}", line.join(" ")) } else { Ok(()) }
}

/// The states at which two rules choose differently.
fn states(out: &mut dyn Write, own: &str, other: &str, asked: &AtStates) -> io::Result<()> {
    for remark in &asked.remarks {
        writeln!(out, "  {:<9} {remark}", "remark")?;
    }
    let differ: Vec<_> = asked.states.iter().filter(|state| state.parting.is_some()).collect();
    if differ.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n  at the states of {own}, where they differ")?;
    let worth = |name: &str| format!("{name} worth\nto {other}");
    let mut table = table([
        "decision".to_owned(),
        "by".to_owned(),
        format!("{own} chose"),
        format!("{other} would have chosen"),
        worth("chosen,"),
        worth("its own,"),
    ]);
    for state in differ.iter().take(STATES_TOLD) {
        let (own, other) = (&state.own.places, &state.other.places);
        let turns = 0..own.len().max(other.len());
        let parts = turns.into_iter().find(|&turn| own.get(turn) != other.get(turn)).unwrap_or(0);
        table.add_row([
            state.decision.to_string(),
            state.parting.map_or_else(dash, |parting| parting.to_string()),
            around(&state.own, parts),
            around(&state.other, parts),
            number(state.scores.logged, 3),
            format!("{:.3}", state.scores.decided),
        ]);
    }
    for line in table.to_string().lines() {
        writeln!(out, "  {line}")?;
    }
    let more = differ.len().saturating_sub(STATES_TOLD);
    if more > 0 { writeln!(out, "   and {more} more (--csv, --json)") } else { Ok(()) }
}

fn regret(out: &mut dyn Write, world: &World) -> io::Result<()> {
    let matrix = &world.regret;
    if matrix.measures.is_empty() {
        return writeln!(
            out,
            "The runs lie on different grids: their sequences are not scored on each other's maps.\n"
        );
    }
    writeln!(out, "What each sequence is worth, and its regret: what the best of them has more")?;
    let marked = |name: &String| {
        let run = world.runs.iter().find(|run| run.name == *name);
        run.map_or_else(|| name.clone(), Compared::marked)
    };
    let of_run = |name: &str| name.strip_prefix("map of ").map(str::to_owned);
    let names = matrix.measures.iter().map(|measure| match of_run(&measure.name) {
        Some(run) => format!("map of {}", marked(&run)),
        None => measure.name.clone(),
    });
    let mut table = table(std::iter::once("sequence of".to_owned()).chain(names));
    for (run, name) in matrix.runs.iter().enumerate() {
        let cells = (0..matrix.measures.len()).map(|measure| {
            let total = matrix.total(run, measure).zip(matrix.regret(run, measure));
            total.map_or_else(dash, |(total, regret)| format!("{total:.3} ({regret:.3})"))
        });
        table.add_row(std::iter::once(marked(name)).chain(cells));
    }
    writeln!(out, "{table}")?;
    footnotes(out, world)
}

fn over_worlds(out: &mut dyn Write, paired: &Paired, of: &[World]) -> io::Result<()> {
    let worlds = paired.seeds.len();
    // Before the numbers: who reads them has read it.
    let few = worlds < FEW_WORLDS;
    let short = if few { " (too short for so few worlds)" } else { "" };
    writeln!(
        out,
        "{}: means over {worlds} worlds, 95 % bootstrap intervals{short}",
        paired.mission
    )?;
    let mut means = table(std::iter::once("").chain(paired.marked.iter().map(String::as_str)));
    let mut differences =
        table(std::iter::once("").chain(paired.marked.iter().skip(1).map(String::as_str)));
    for metric in &METRICS {
        let cell = |run: usize, of: &dyn Fn(&super::paired::Row) -> Option<Interval>| {
            let found = paired.row(metric.name, run).and_then(of);
            found.map_or_else(dash, |interval| with_interval(metric.told(interval), worlds))
        };
        let mean = |run| cell(run, &|row| row.mean);
        let all: Vec<String> = (0..paired.names.len()).map(mean).collect();
        if all.iter().any(|cell| *cell != "-") {
            means.add_row(std::iter::once(metric.told_name()).chain(all));
        }
        let less: Vec<String> =
            (1..paired.names.len()).map(|run| cell(run, &|row| row.difference)).collect();
        if less.iter().any(|cell| *cell != "-") {
            differences.add_row(std::iter::once(metric.told_name()).chain(less));
        }
    }
    writeln!(out, "{means}\n")?;
    writeln!(
        out,
        "Differences from {}, world by world, with their intervals{short}",
        paired.marked[0]
    )?;
    writeln!(out, "{differences}")?;
    for world in of {
        for footnote in world.footnotes() {
            writeln!(
                out,
                "* seed {}: {}",
                world.seeds.join("+"),
                footnote.trim_start_matches("* ")
            )?;
        }
    }
    writeln!(out)
}

fn with_interval(interval: Interval, worlds: usize) -> String {
    let Interval { mean, low, high } = interval;
    let large = mean.abs().max(low.abs()).max(high.abs()) >= 1e5;
    let told = |value: f64| if large { format!("{value:.3e}") } else { format!("{value:.3}") };
    if worlds > 1 { format!("{} [{}, {}]", told(mean), told(low), told(high)) } else { told(mean) }
}
