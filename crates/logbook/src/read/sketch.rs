//! A message in a line, for people who look into a log.

use foxglove::messages::{FrameTransform, Grid, Log, PoseInFrame, SceneUpdate};
use prost::Message as _;

use super::Entry;

/// What a message holds, in one line: its text, its place or its size, never its bulk. A message of a schema that
/// this version does not know, or that does not decode, is its schema and its size.
#[must_use]
pub fn sketch(schema: &str, data: &[u8]) -> String {
    let known = match schema {
        "foxglove.Grid" => Grid::decode(data).ok().map(|grid| grid_line(&grid)),
        "foxglove.Log" => Log::decode(data).ok().map(|log| log.message),
        "foxglove.PoseInFrame" => PoseInFrame::decode(data).ok().map(|told| {
            let at = told.pose.and_then(|pose| pose.position).unwrap_or_default();
            format!("pose in {} at ({:.2}, {:.2}, {:.2}) m", told.frame_id, at.x, at.y, at.z)
        }),
        "foxglove.FrameTransform" => FrameTransform::decode(data).ok().map(|told| {
            let by = told.translation.unwrap_or_default();
            let (parent, child) = (told.parent_frame_id, told.child_frame_id);
            format!("{parent} to {child}: ({:.2}, {:.2}, {:.2}) m", by.x, by.y, by.z)
        }),
        "foxglove.SceneUpdate" => SceneUpdate::decode(data).ok().map(|scene| {
            let ids: Vec<String> = scene.entities.into_iter().map(|entity| entity.id).collect();
            format!("scene of {}: {}", ids.len(), ids.join(", "))
        }),
        _ => None,
    };
    known.unwrap_or_else(|| {
        let name = if schema.is_empty() { "no schema" } else { schema };
        format!("{name}, {} bytes", data.len())
    })
}

fn grid_line(grid: &Grid) -> String {
    // A grid of no columns or no stride has no rows.
    let rows = grid.data.len().checked_div(grid.row_stride as usize).unwrap_or_default();
    let size = grid.cell_size.unwrap_or_default();
    let names: Vec<&str> = grid.fields.iter().map(|field| field.name.as_str()).collect();
    format!(
        "grid of {rows} x {} cells of {} m, {}, {} bytes",
        grid.column_count,
        size.x,
        names.join(" "),
        grid.data.len()
    )
}

impl Entry {
    /// The record in one line.
    #[must_use]
    pub fn sketch(&self) -> String {
        match self {
            Self::Observation(told) => {
                let layers: Vec<String> =
                    told.windows.iter().map(|window| window.layer.clone()).collect();
                format!(
                    "observation {}: {} windows: {}",
                    told.number,
                    layers.len(),
                    layers.join(", ")
                )
            }
            Self::Decision(decision) => {
                let triggers: Vec<&str> =
                    decision.triggers.iter().map(|trigger| trigger.name.as_str()).collect();
                let goals = decision.choice.as_ref().map_or(0, |choice| choice.verdicts.len());
                format!(
                    "decision {} because of {}: {goals} goals judged, chain {:.12}",
                    decision.number,
                    triggers.join(", "),
                    decision.chain
                )
            }
            Self::Outcome(outcome) => format!(
                "outcome of decision {}: {} cells driven",
                outcome.decision,
                outcome.track.len()
            ),
            Self::Message(message) => message.text(),
            Self::Fault(fault) => fault.text.clone(),
        }
    }
}
