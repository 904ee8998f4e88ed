//! The planes of a decision's maps, by name.

use wisdom_autonomy::{Maps, Spec};
use wisdom_grid::Raster;

/// A plane that a decision was made from, at the working map's place: `interest`, `ignorance`, `paradox`, `conflict`,
/// `contradiction`, `prize`, `hazard`, a layer of the mission, or a layer and `-u` for its uncertainty; none by another
/// name.
#[must_use]
pub fn plane<'a>(maps: &'a Maps, name: &str) -> Option<&'a Raster<f32>> {
    let fused = &maps.interest;
    Some(match name {
        "interest" => &fused.interest,
        "ignorance" => &fused.ignorance,
        "paradox" => &fused.paradox,
        "conflict" => &fused.conflict,
        "contradiction" => &fused.contradiction,
        "prize" => &maps.prize.prize,
        "hazard" => maps.ground.hazard(),
        name => {
            let layer = |name: &str| maps.layers.get(name);
            match (layer(name), name.strip_suffix("-u").and_then(layer)) {
                (Some(layer), _) => layer.values(),
                (None, Some(layer)) => layer.uncertainty(),
                (None, None) => return None,
            }
        }
    })
}

/// Whether every decision of such a mission has a plane of that name.
#[must_use]
pub fn is_plane(spec: &Spec, name: &str) -> bool {
    const ALWAYS: [&str; 7] =
        ["interest", "ignorance", "paradox", "conflict", "contradiction", "prize", "hazard"];
    let layer = |name: &str| spec.layers.iter().any(|layer| layer.name == name);
    ALWAYS.contains(&name) || layer(name) || name.strip_suffix("-u").is_some_and(layer)
}
