//! Where the rover can stand to do a goal.

use wisdom_grid::Cell;
use wisdom_planner::{CostVector, Field};
use wisdom_terrain::{Layer, line_of_sight};

/// How a goal may be approached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Farthest distance from the target, metres.
    pub standoff_m: f64,
    /// Height of the eye that must see the target, metres above the ground.
    pub eye_height_m: f64,
    /// How many poses to offer at most; each further one lies in another direction.
    pub poses: usize,
}

/// Poses from which a target can be done: reachable cells within the stand-off that see it, safest way
/// first; each after the first at least 60° round the target from those before it.
///
/// What draws the rover may be what it cannot drive on, a steep face for one: the target's own cell need not be
/// one of them.
#[must_use]
pub fn poses(
    field: &Field<'_>,
    elevation: &Layer,
    target: Cell,
    approach: &Approach,
) -> Vec<(Cell, CostVector)> {
    /// cos 60°: directions closer than this are the same side of the target.
    const SAME_SIDE: f64 = 0.5;
    let spec = elevation.spec();
    let reach = approach.standoff_m / spec.spacing_m();
    let mut near: Vec<(Cell, f64)> = spec
        .around(target, reach.ceil() as usize)
        .cells()
        .filter(|cell| cell.distance(target) <= reach)
        .filter_map(|cell| Some((cell, field.neg_ln_r(cell)?)))
        .collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let mut found: Vec<(Cell, CostVector)> = Vec::new();
    for (cell, _) in near {
        if found.len() == approach.poses.max(1) {
            break;
        }
        let other_side = found.iter().all(|&(pose, _)| cosine(target, pose, cell) < SAME_SIDE);
        if other_side && line_of_sight(elevation, cell, approach.eye_height_m, target, 0.0) {
            found.extend(field.cost(cell).map(|cost| (cell, cost)));
        }
    }
    found
}

/// Whether a pose that was offered once still serves a target: reachable, within the stand-off, and in sight of it.
#[must_use]
pub fn serves(
    field: &Field<'_>,
    elevation: &Layer,
    pose: Cell,
    target: Cell,
    approach: &Approach,
) -> bool {
    let spec = elevation.spec();
    let on_map = spec.contains(pose) && spec.contains(target);
    on_map
        && pose.distance(target) * spec.spacing_m() <= approach.standoff_m
        && field.neg_ln_r(pose).is_some()
        && line_of_sight(elevation, pose, approach.eye_height_m, target, 0.0)
}

/// Cosine of the angle at `target` between two cells; 1 if either is the target itself.
fn cosine(target: Cell, a: Cell, b: Cell) -> f64 {
    let away = |c: Cell| (c.col as f64 - target.col as f64, c.row as f64 - target.row as f64);
    let ((ax, ay), (bx, by)) = (away(a), away(b));
    let lengths = ((ax * ax + ay * ay) * (bx * bx + by * by)).sqrt();
    if lengths > 0.0 { (ax * bx + ay * by) / lengths } else { 1.0 }
}
