//! The comparison as one JSON object.

use serde_json::{Map, Value, json};
use wisdom_logbook::Parting;
use wisdom_logbook::comparison::{
    AtState, AtStates, Chosen, Divergence, Edit, Inputs, ToldDifference,
};
use wisdom_mission::statistics::Interval;

use super::against::{Against, LinedUp, States};
use super::paired::{METRICS, Paired};
use super::world::{Compared, World};

/// All worlds, and what holds over them.
pub(super) fn of(worlds: &[World], paired: Option<&Paired>) -> Value {
    json!({
        "mission": worlds.first().map(|world| &world.mission),
        "worlds": worlds.iter().map(world).collect::<Vec<_>>(),
        "means": paired.map_or_else(|| means_of_one(worlds), means),
        "paired": paired.map(differences),
    })
}

fn world(world: &World) -> Value {
    let seed = |text: &String| text.parse::<u64>().map_or_else(|_| json!(text), |n| json!(n));
    let runs = world.runs.iter().enumerate();
    json!({
        "seed": world.seeds.first().map(seed),
        "warning": world.warning(),
        "seeds": world.seeds.iter().map(seed).collect::<Vec<_>>(),
        "places": world.places.places.iter().enumerate()
            .map(|(i, c)| json!({ "name": World::place(i), "row": c.row, "col": c.col }))
            .collect::<Vec<_>>(),
        "labels": world.runs[0].known.iter().map(|label| json!({
            "name": label.name, "row": label.at.row, "col": label.at.col,
            "radius_m": label.radius_m, "worth": label.worth,
        })).collect::<Vec<_>>(),
        "runs": runs.map(|(place, compared)| run(world, place, compared)).collect::<Vec<_>>(),
        "regret": {
            "measures": world.regret.measures.iter().map(|m| &m.name).collect::<Vec<_>>(),
            "rows": (0..world.regret.runs.len()).map(|run| json!({
                "name": world.regret.runs[run],
                "totals": (0..world.regret.measures.len())
                    .map(|m| world.regret.total(run, m)).collect::<Vec<_>>(),
                "regrets": (0..world.regret.measures.len())
                    .map(|m| world.regret.regret(run, m)).collect::<Vec<_>>(),
            })).collect::<Vec<_>>(),
        },
    })
}

fn run(world: &World, place: usize, run: &Compared) -> Value {
    let sequence = &world.places.sequences[place];
    json!({
        "name": run.name,
        "rule": run.rule,
        "policy": run.policy,
        "log": run.path.display().to_string(),
        "log_status": run.status.to_string(),
        "status": run.ended,
        "sequence": sequence.iter().map(|p| World::place(*p)).collect::<Vec<_>>(),
        "goals": run.goals.iter().map(|goal| json!({
            "goal": format!("G{}", goal.goal), "directive": goal.directive,
            "row": goal.target.row, "col": goal.target.col,
            "interest": goal.interest, "prize": goal.prize, "ruler": goal.ruler,
            "label": run.label(goal),
            "decision": goal.decision, "time_s": goal.spent.time_s, "energy_j": goal.spent.energy_j,
        })).collect::<Vec<_>>(),
        "interest_own_map": run.interest,
        "interest_ruler": run.ruler,
        "labels": run.labels,
        "distance_m": run.spent.length_m,
        "time_s": run.spent.time_s,
        "energy_j": run.spent.energy_j,
        "data_mb": run.spent.data_mb,
        "reliability": run.reliability,
        "decisions": run.decisions,
        "reallocations": run.reallocations,
        "against_first": against(&run.against),
    })
}

fn against(held: &Against) -> Value {
    let lined_up = held.lined_up.as_ref();
    let edits = |lined_up: &LinedUp| -> Vec<Value> {
        lined_up.alignment.edits.iter().map(|&edit| self::edit(edit)).collect()
    };
    json!({
        "inputs": inputs(&held.inputs),
        "jaccard": lined_up.map(|lined_up| lined_up.jaccard),
        "kendall_tau": lined_up.and_then(|lined_up| lined_up.tau),
        "edit_distance": lined_up.map(|lined_up| lined_up.alignment.distance()),
        "edits": lined_up.map(edits),
        "first_different_stop": lined_up.and_then(|lined_up| lined_up.stop).map(|stop| stop + 1),
        "first_divergent_decision": held.divergence.as_ref().map(|d| d.decision),
        "divergence": held.divergence.as_ref().map(divergence),
        "decisions_both": held.both,
        "decisions_apart": held.apart,
        "at_states": match &held.states {
            States::Unasked => Value::Null,
            States::Unfit(what) => json!({ "unfit": what }),
            States::Asked { of_first, of_this } => json!({
                "of_first": states(of_first), "of_this": states(of_this),
            }),
        },
    })
}

fn inputs(inputs: &Inputs) -> Value {
    let told = |told: &Option<ToldDifference>| {
        told.as_ref().map(|told| {
            json!({
                "number": told.number, "what": told.what, "after_decision": told.after_decision,
            })
        })
    };
    json!({
        "equal": inputs.are_equal(),
        "rule_alone": inputs.differ_in_rule_alone(),
        "facts": inputs.facts.iter().map(|fact| json!({
            "name": fact.name, "first": fact.left, "this": fact.right,
        })).collect::<Vec<_>>(),
        "files": inputs.files.iter().map(|file| json!({
            "name": file.name, "first": file.left, "this": file.right,
            "keys": file.keys.iter().map(|key| json!({
                "key": key.key, "first": key.left, "this": key.right,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "same_files": inputs.same_files,
        "first_different_observation": told(&inputs.observations),
        "first_different_message": told(&inputs.messages),
    })
}

/// Stops count from 1, as everywhere that people read.
fn edit(edit: Edit) -> Value {
    json!({
        "edit": edit.name(),
        "place": World::place(edit.place()),
        "first_stop": edit.from().map(|turn| turn + 1),
        "this_stop": edit.to().map(|turn| turn + 1),
    })
}

fn chosen(chosen: &Chosen) -> Value {
    json!({
        "act": chosen.act,
        "places": chosen.places.iter().map(|(cell, directive)| json!({
            "row": cell.row, "col": cell.col, "directive": directive,
        })).collect::<Vec<_>>(),
    })
}

fn divergence(divergence: &Divergence) -> Value {
    json!({
        "decision": divergence.decision,
        "by": divergence.parting.map(Parting::name),
        "first": divergence.left.as_ref().map(chosen),
        "this": divergence.right.as_ref().map(chosen),
        "same_readings": divergence.same_readings,
        "same_rover": divergence.same_rover,
        "same_memory": divergence.same_memory,
        "stage": divergence.first.as_ref().map(|difference| difference.stage),
        "field": divergence.first.as_ref().map(|difference| &difference.path),
    })
}

fn states(states: &AtStates) -> Value {
    let state = |state: &AtState| {
        json!({
            "decision": state.decision,
            "by": state.parting.map(Parting::name),
            "own": chosen(&state.own),
            "other": chosen(&state.other),
            "own_worth_to_other": state.scores.logged,
            "other_worth_to_other": state.scores.decided,
            "stage": state.first.as_ref().map(|difference| difference.stage),
            "field": state.first.as_ref().map(|difference| &difference.path),
        })
    };
    json!({
        "decisions": states.states.len(),
        "alike": states.alike(),
        "states": states.states.iter().map(state).collect::<Vec<_>>(),
        "remarks": states.remarks,
    })
}

fn interval(interval: Interval) -> Value {
    json!({ "mean": interval.mean, "low": interval.low, "high": interval.high })
}

/// The mean of every metric, by run.
fn means(paired: &Paired) -> Value {
    let of_run = |(run, name): (usize, &String)| {
        let mut told = Map::new();
        told.insert("rule".to_owned(), json!(name));
        for metric in &METRICS {
            let mean = paired.row(metric.name, run).and_then(|row| row.mean);
            told.insert(metric.name.to_owned(), json!(mean.map(|mean| mean.mean)));
        }
        Value::Object(told)
    };
    paired.names.iter().enumerate().map(of_run).collect()
}

/// Of a single world, its own numbers.
fn means_of_one(worlds: &[World]) -> Value {
    let runs = worlds.iter().flat_map(|world| &world.runs);
    runs.map(|run| {
        json!({
            "rule": run.name, "goals": run.goals.len(), "interest_own_map": run.interest,
            "interest_ruler": run.ruler, "labels": run.labels, "distance_m": run.spent.length_m,
            "reallocations": run.reallocations,
        })
    })
    .collect()
}

fn differences(paired: &Paired) -> Value {
    paired
        .rows
        .iter()
        .map(|row| {
            json!({
                "metric": row.metric.name,
                "run": paired.names[row.run],
                "worlds": row.worlds,
                "mean": row.mean.map(interval),
                "less_first": row.difference.map(interval),
            })
        })
        .collect()
}
