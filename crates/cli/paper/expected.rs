//! `expected.toml`: what section IV says of its map, as numbers. Places are the paper's (x, y).

use std::path::Path;

use serde::Deserialize;
use wisdom_grid::{Cell, GridSpec};
use wisdom_mission::MissionError;

const FILE: &str = "expected.toml";

/// The file as it is written; what each key means stands in it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expected {
    pub(super) rocks: Rocks,
    pub(super) rock: Vec<Rock>,
    pub(super) hot_disc: HotDisc,
    pub(super) most_interesting: MostInteresting,
    pub(super) texture_edge: TextureEdge,
    pub(super) point: Point,
    pub(super) ground: Ground,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rocks {
    pub(super) border_gradient: f32,
    pub(super) in_sight_mean_above: f64,
    pub(super) in_sight_mean_of_all_above: f64,
    pub(super) hidden_mean_below: f64,
    pub(super) drop_above: f64,
    pub(super) hidden_texture_is_not: f32,
    pub(super) noticeable: Vec<String>,
    pub(super) noticeable_hidden_cells: usize,
    pub(super) noticeable_drop_above: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rock {
    pub(super) name: String,
    pub(super) centre: [f64; 2],
    pub(super) reach: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HotDisc {
    pub(super) name: String,
    pub(super) centre: [f64; 2],
    pub(super) core: f64,
    pub(super) belief_above: f64,
    pub(super) temperature_credit_above: f64,
    pub(super) outside: f64,
    pub(super) cold_below: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MostInteresting {
    pub(super) name: String,
    pub(super) rock: String,
    pub(super) hot_from: f32,
    pub(super) best_belief_above: f64,
    pub(super) best_in_top_share: f64,
    pub(super) mean_belief_above: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureEdge {
    pub(super) name: String,
    pub(super) left: Rectangle,
    pub(super) right: Vec<Rectangle>,
    pub(super) jump_above: f64,
    pub(super) fall_above: f64,
    pub(super) gradient_below: f64,
    pub(super) temperature_below: f64,
    pub(super) dem_uncertainty_below: f64,
    pub(super) texture_uncertainty_below: f64,
    pub(super) thermal_uncertainty_above: f64,
}

/// From one (x, y) to another, both included.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rectangle {
    pub(super) from: [usize; 2],
    pub(super) to: [usize; 2],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Point {
    pub(super) at: [usize; 2],
    pub(super) gradient: f64,
    pub(super) gradient_within: f64,
    pub(super) texture: f32,
    pub(super) temperature: f64,
    pub(super) temperature_within: f64,
    pub(super) dem_uncertainty: f64,
    pub(super) texture_uncertainty: f64,
    pub(super) thermal_uncertainty: f64,
    pub(super) belief: f64,
    pub(super) belief_within: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ground {
    pub(super) slope_deg_below: f64,
    pub(super) reached_share_above: f64,
}

impl Expected {
    /// Reads the file beside a mission, given as its folder or its mission.toml.
    pub(super) fn load(mission: &Path, grid: GridSpec) -> Result<Self, MissionError> {
        let folder = if mission.is_dir() { mission } else { mission.parent().unwrap_or(mission) };
        let path = folder.join(FILE);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| MissionError::of_file(&path.display().to_string(), error))?;
        let expected: Self = toml::from_str(&text).map_err(|error| match error.span() {
            Some(span) => MissionError::at(FILE, &text, span, error.message()),
            None => MissionError::of_file(FILE, error.message()),
        })?;
        expected.check(grid).map_err(|(key, message)| {
            MissionError::at_key(FILE, &text, &key.split('.').collect::<Vec<_>>(), message)
        })?;
        Ok(expected)
    }

    /// What does not hold of the file itself: the key, and why.
    fn check(&self, grid: GridSpec) -> Result<(), (&'static str, String)> {
        let [x, y] = self.point.at;
        let (cols, rows) = (grid.cols(), grid.rows());
        if !(1..=cols).contains(&x) || !(1..=rows).contains(&y) {
            let found = format!("({x}, {y}); expected x from 1 to {cols}, y from 1 to {rows}");
            return Err(("point.at", found));
        }
        let known = |name: &String| self.rock.iter().any(|rock| rock.name == *name);
        let m = &self.most_interesting;
        if !known(&m.rock) {
            return Err(("most_interesting.rock", format!("`{}` is no rock of the file", m.rock)));
        }
        if let Some(name) = self.rocks.noticeable.iter().find(|name| !known(name)) {
            return Err(("rocks.noticeable", format!("`{name}` is no rock of the file")));
        }
        let u = [
            ("point.dem_uncertainty", self.point.dem_uncertainty),
            ("point.texture_uncertainty", self.point.texture_uncertainty),
            ("point.thermal_uncertainty", self.point.thermal_uncertainty),
        ];
        match u.into_iter().find(|(_, u)| !(0.0..=1.0).contains(u)) {
            Some((key, u)) => Err((key, format!("{u}; expected a number from 0 to 1"))),
            None => Ok(()),
        }
    }
}

/// The cell at the paper's (x, y), which count from 1 at the bottom left.
pub(super) fn cell_at(grid: GridSpec, [x, y]: [usize; 2]) -> Cell {
    Cell { row: grid.rows() - y, col: x - 1 }
}

/// The paper's (x, y) of a cell.
fn place_of(grid: GridSpec, cell: Cell) -> [usize; 2] {
    [cell.col + 1, grid.rows() - cell.row]
}

/// Whether a cell's centre is within a distance of a place.
pub(super) fn within(grid: GridSpec, cell: Cell, centre: [f64; 2], radius: f64) -> bool {
    let [x, y] = place_of(grid, cell);
    let (dx, dy) = (x as f64 - centre[0], y as f64 - centre[1]);
    dx * dx + dy * dy <= radius * radius
}

impl Rectangle {
    /// Whether a cell is in it.
    pub(super) fn contains(&self, grid: GridSpec, cell: Cell) -> bool {
        let [x, y] = place_of(grid, cell);
        (self.from[0]..=self.to[0]).contains(&x) && (self.from[1]..=self.to[1]).contains(&y)
    }
}
