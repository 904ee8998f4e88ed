//! The comparison as tables of comma-separated values, one file a table.

use std::path::{Path, PathBuf};

use wisdom_logbook::comparison::AtStates;
use wisdom_mission::statistics::Interval;

use super::against::States;
use super::paired::Paired;
use super::world::{Compared, World};

/// One table: the names of its columns, and rows.
struct Table {
    name: &'static str,
    header: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// Writes all tables into a folder that is there; returns their paths.
pub(super) fn write(
    folder: &Path,
    worlds: &[World],
    paired: Option<&Paired>,
) -> anyhow::Result<Vec<PathBuf>> {
    let tables =
        [runs(worlds), sequences(worlds), edits(worlds), decisions(worlds), regret(worlds)];
    let mut written = Vec::new();
    // A header over nothing would look like states of which none was found.
    let tables = tables.into_iter().filter(|table| table.name != "decisions" || asked(worlds));
    for Table { name, header, rows } in tables.chain(paired.map(differences)) {
        let path = folder.join(format!("{name}.csv"));
        let part = folder.join(format!("{name}.csv.part"));
        let mut file = csv::Writer::from_path(&part)?;
        file.write_record(header)?;
        for row in rows {
            file.write_record(row)?;
        }
        file.flush()?;
        drop(file);
        std::fs::rename(part, &path)?;
        written.push(path);
    }
    Ok(written)
}

/// Whether any rule was to be asked at the states of another's run.
pub(super) fn asked(worlds: &[World]) -> bool {
    all(worlds).any(|(_, _, run)| !matches!(run.against.states, States::Unasked))
}

/// A number in full precision; nothing where there is none.
fn number(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn count<T: ToString>(value: Option<T>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn all(worlds: &[World]) -> impl Iterator<Item = (&World, usize, &Compared)> {
    worlds
        .iter()
        .flat_map(|world| world.runs.iter().enumerate().map(move |(i, run)| (world, i, run)))
}

fn seed(world: &World) -> String {
    world.seeds.join("+")
}

fn runs(worlds: &[World]) -> Table {
    let rows = all(worlds).map(|(world, _, run)| {
        let held = &run.against;
        let lined_up = held.lined_up.as_ref();
        vec![
            seed(world),
            run.name.clone(),
            run.rule.clone(),
            run.policy.clone(),
            run.ended.clone().unwrap_or_default(),
            run.status.to_string(),
            run.goals.len().to_string(),
            run.interest.to_string(),
            number(run.ruler),
            number(run.labels),
            run.spent.length_m.to_string(),
            run.spent.time_s.to_string(),
            run.spent.energy_j.to_string(),
            run.spent.data_mb.to_string(),
            number(run.reliability),
            run.decisions.to_string(),
            run.reallocations.to_string(),
            number(lined_up.map(|lined_up| lined_up.jaccard)),
            number(lined_up.and_then(|lined_up| lined_up.tau)),
            count(lined_up.map(|lined_up| lined_up.alignment.distance())),
            count(lined_up.and_then(|lined_up| lined_up.stop).map(|stop| stop + 1)),
            count(held.divergence.as_ref().map(|divergence| divergence.decision)),
            held.both.to_string(),
            held.apart.to_string(),
        ]
    });
    let mut header = vec!["seed", "run", "rule", "policy", "status", "log_status", "goals"];
    header.extend([
        "interest_own_map",
        "interest_ruler",
        "labels",
        "distance_m",
        "time_s",
        "energy_j",
        "data_mb",
    ]);
    header.extend(["reliability", "decisions", "reallocations", "jaccard", "kendall_tau"]);
    header.extend(["edit_distance", "first_different_stop", "first_divergent_decision"]);
    header.extend(["decisions_both", "decisions_apart"]);
    Table { name: "runs", header, rows: rows.collect() }
}

fn sequences(worlds: &[World]) -> Table {
    let rows = all(worlds).flat_map(|(world, place, run)| {
        run.goals.iter().enumerate().map(move |(turn, goal)| {
            vec![
                seed(world),
                run.name.clone(),
                (turn + 1).to_string(),
                World::place(world.places.sequences[place][turn]),
                format!("G{}", goal.goal),
                goal.directive.clone(),
                goal.target.row.to_string(),
                goal.target.col.to_string(),
                goal.interest.to_string(),
                goal.prize.to_string(),
                number(goal.ruler),
                run.label(goal).unwrap_or_default().to_owned(),
                goal.decision.to_string(),
                goal.spent.time_s.to_string(),
                goal.spent.energy_j.to_string(),
            ]
        })
    });
    let mut header = vec!["seed", "run", "stop", "place", "goal", "directive", "row", "col"];
    header.extend(["interest", "prize", "ruler", "label", "decision", "time_s", "energy_j"]);
    Table { name: "sequences", header, rows: rows.collect() }
}

fn edits(worlds: &[World]) -> Table {
    let rows = all(worlds).filter(|(_, place, _)| *place > 0).flat_map(|(world, _, run)| {
        let edits = run.against.lined_up.iter().flat_map(|lined_up| &lined_up.alignment.edits);
        edits.map(move |&edit| {
            vec![
                seed(world),
                world.runs[0].name.clone(),
                run.name.clone(),
                edit.name().to_owned(),
                World::place(edit.place()),
                count(edit.from().map(|turn| turn + 1)),
                count(edit.to().map(|turn| turn + 1)),
            ]
        })
    });
    let header = vec!["seed", "first", "run", "edit", "place", "first_stop", "run_stop"];
    Table { name: "edits", header, rows: rows.collect() }
}

fn decisions(worlds: &[World]) -> Table {
    let mut rows = Vec::new();
    for (world, _, run) in all(worlds) {
        let States::Asked { of_first, of_this } = &run.against.states else { continue };
        let first = &world.runs[0].name;
        let mut add = |own: &str, other: &str, asked: &AtStates| {
            for state in &asked.states {
                rows.push(vec![
                    seed(world),
                    own.to_owned(),
                    other.to_owned(),
                    state.decision.to_string(),
                    state.parting.is_none().to_string(),
                    count(state.parting),
                    state.own.to_string(),
                    state.other.to_string(),
                    number(state.scores.logged),
                    state.scores.decided.to_string(),
                    state.first.as_ref().map(|d| d.stage.to_owned()).unwrap_or_default(),
                    state.first.as_ref().map(|d| d.path.clone()).unwrap_or_default(),
                ]);
            }
        };
        add(first, &run.name, of_first);
        add(&run.name, first, of_this);
    }
    let mut header =
        vec!["seed", "run", "asked", "decision", "alike", "by", "chose", "would_choose"];
    header.extend(["chose_worth", "would_choose_worth", "stage", "field"]);
    Table { name: "decisions", header, rows }
}

fn regret(worlds: &[World]) -> Table {
    let mut rows = Vec::new();
    for world in worlds {
        let matrix = &world.regret;
        for (run, name) in matrix.runs.iter().enumerate() {
            for (measure, of) in matrix.measures.iter().enumerate() {
                rows.push(vec![
                    seed(world),
                    name.clone(),
                    of.name.clone(),
                    number(matrix.total(run, measure)),
                    number(matrix.regret(run, measure)),
                ]);
            }
        }
    }
    let header = vec!["seed", "run", "measure", "total", "regret"];
    Table { name: "regret", header, rows }
}

fn differences(paired: &Paired) -> Table {
    let ends = |interval: Option<Interval>| match interval {
        Some(Interval { mean, low, high }) => [mean, low, high].map(|end| end.to_string()),
        None => [(); 3].map(|()| String::new()),
    };
    let rows = paired.rows.iter().map(|row| {
        let mut cells =
            vec![row.metric.name.to_owned(), paired.names[row.run].clone(), row.worlds.to_string()];
        cells.extend(ends(row.mean));
        cells.extend(ends(row.difference));
        cells
    });
    let mut header = vec!["metric", "run", "worlds", "mean", "mean_low", "mean_high"];
    header.extend(["less_first", "less_first_low", "less_first_high"]);
    Table { name: "paired", header, rows: rows.collect() }
}
