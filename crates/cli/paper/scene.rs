//! Section IV: the scene at first sight, and what the paper says of its interest map.

use std::collections::{BTreeMap, VecDeque};

use serde::Deserialize;
use wisdom_belief::Rule;
use wisdom_fusion::{Evidence, Fusion, Statistic, credit, interest_map, judge};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_mission::{MISSION_FILE, Mission};
use wisdom_terrain::{Layer, Observer, gradient, slope, viewshed};

use super::check::{Against, Check};
use super::expected::{Expected, Point, Rectangle, Rock, cell_at, within};
use super::tables::Panel;
use crate::exit::InputError;

/// Uncertainties are kept as f32, whose spacing below 1 is 6e-8.
const AS_F32: f64 = 1e-7;
/// "A noise component, with a value in the interval [0, 0.2]" (section IV).
const NOISE_MOST: f64 = 0.2;

/// The one key of mission.toml that the mission keeps to itself.
#[derive(Deserialize)]
struct MissionText {
    prior: PriorText,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct PriorText {
    camera_height_m: f64,
}

/// The paper's first look: true readings, the first look's uncertainties, and the interest map of both under
/// DSmC. As in the paper, the gradient is that of the whole true DEM, with the DEM's u cell by cell.
pub(super) struct Look {
    pub(super) grid: GridSpec,
    pub(super) camera: Cell,
    pub(super) camera_height_m: f64,
    pub(super) elevation: Layer,
    pub(super) gradient: Raster<f32>,
    pub(super) temperature: Raster<f32>,
    pub(super) texture: Raster<f32>,
    pub(super) dem_u: Raster<f32>,
    pub(super) temperature_u: Raster<f32>,
    pub(super) texture_u: Raster<f32>,
    pub(super) visible: Raster<bool>,
    pub(super) interest: Raster<f32>,
    evidence: Evidence,
    fusion: Fusion,
    /// Place of the infrared expert among the experts.
    infrared: usize,
}

impl Look {
    pub(super) fn take(mission: &Mission) -> anyhow::Result<Self> {
        let grid = mission.spec.grid;
        let truth = |layer: &str| {
            mission.world.truth(layer).ok_or_else(|| {
                InputError(format!("mission `{}` has no layer `{layer}`", mission.name))
            })
        };
        let prior = mission.world.prior(&mission.spec.layers, grid.window())?;
        let first_look = |layer: &str| -> anyhow::Result<Raster<f32>> {
            let window = prior.iter().find(|w| w.layer == layer && w.window == grid.window());
            let window = window.ok_or_else(|| {
                InputError(format!("mission `{}` has no first look of `{layer}`", mission.name))
            })?;
            Ok(Raster::from_vec(grid, window.uncertainty.clone())?)
        };
        let elevation = truth("elevation")?.clone();
        let gradient = gradient(&elevation).values().clone();
        let temperature = truth("temperature")?.values().clone();
        let texture = truth("texture")?.values().clone();
        let (dem_u, temperature_u, texture_u) =
            (first_look("elevation")?, first_look("temperature")?, first_look("texture")?);

        let camera = mission.world.execution().start;
        let camera_height_m = camera_height_m(mission)?;
        let shed = viewshed(&elevation, &Observer::all_round(camera, camera_height_m));
        let visible = Raster::from_fn(grid, |cell| shed.is_visible(cell));

        let layers = BTreeMap::from([
            ("gradient".to_owned(), Layer::new(gradient.clone(), dem_u.clone())?),
            ("temperature".to_owned(), Layer::new(temperature.clone(), temperature_u.clone())?),
            ("texture".to_owned(), Layer::new(texture.clone(), texture_u.clone())?),
        ]);
        let experts = &mission.spec.experts;
        let evidence =
            judge(experts, &layers).map_err(|error| InputError(format!("experts: {error}")))?;
        let fusion = Fusion { rule: Rule::Dsmc, statistic: Statistic::Belief, ..Fusion::default() };
        let interest = interest_map(&evidence, &fusion).interest;
        let infrared = experts
            .iter()
            .position(|expert| expert.layer == "temperature")
            .ok_or_else(|| InputError("no expert reads `temperature`".to_owned()))?;
        Ok(Self {
            grid,
            camera,
            camera_height_m,
            elevation,
            gradient,
            temperature,
            texture,
            dem_u,
            temperature_u,
            texture_u,
            visible,
            interest,
            evidence,
            fusion,
            infrared,
        })
    }

    fn belief(&self, cell: Cell) -> f64 {
        f64::from(self.interest[cell])
    }

    /// NaN, which no check lets pass, of no cells.
    fn mean_belief(&self, cells: &[Cell]) -> f64 {
        cells.iter().map(|&cell| self.belief(cell)).sum::<f64>() / cells.len() as f64
    }

    fn cells_where(&self, holds: impl Fn(Cell) -> bool) -> Vec<Cell> {
        self.grid.cells().filter(|&cell| holds(cell)).collect()
    }

    fn area(&self, rectangle: &Rectangle) -> Vec<Cell> {
        self.cells_where(|cell| rectangle.contains(self.grid, cell))
    }

    /// The border cells of a rock: those in sight, and those hidden.
    fn border(&self, rock: &Rock, least_gradient: f32) -> (Vec<Cell>, Vec<Cell>) {
        let steep = |cell| self.gradient[cell] >= least_gradient;
        self.cells_where(|cell| within(self.grid, cell, rock.centre, rock.reach) && steep(cell))
            .into_iter()
            .partition(|&cell| self.visible[cell])
    }

    /// Area M: where the border of its rock, in sight, is hot.
    fn hot_border(&self, expected: &Expected) -> Vec<Cell> {
        let m = &expected.most_interesting;
        let rocks = expected.rock.iter().filter(|rock| rock.name == m.rock);
        let borders = rocks.flat_map(|rock| self.border(rock, expected.rocks.border_gradient).0);
        borders.filter(|&cell| self.temperature[cell] >= m.hot_from).collect()
    }

    /// The most interesting cell of area M.
    pub(super) fn best_of_hot_border(&self, expected: &Expected) -> Option<Cell> {
        let area = self.hot_border(expected);
        area.into_iter().max_by(|&a, &b| self.interest[a].total_cmp(&self.interest[b]))
    }
}

fn camera_height_m(mission: &Mission) -> anyhow::Result<f64> {
    let bytes = mission.files.get(MISSION_FILE).map_or(&[][..], Vec::as_slice);
    let text: MissionText = toml::from_slice(bytes).map_err(|error| {
        InputError(format!("{MISSION_FILE}: the height of the first look: {}", error.message()))
    })?;
    Ok(text.prior.camera_height_m)
}

/// Every predicate of expected.toml.
pub(super) fn checks(look: &Look, expected: &Expected, panel: &Panel<'_>) -> Vec<Check> {
    let mut checks = first_look(look);
    checks.extend(rocks(look, expected));
    checks.extend(hot_disc(look, expected));
    checks.extend(most_interesting(look, expected));
    checks.extend(texture_edge(look, expected));
    checks.extend(point(look, &expected.point, panel));
    checks.extend(ground(look, expected));
    checks
}

const NONE: Against = Against::Printed { value: 0.0, within: 0.0 };

/// Figs. 3 and 4: "zero (point in sight) or one (hidden point)", and noise.
fn first_look(look: &Look) -> Vec<Check> {
    let group = "Figs. 3 and 4: what the camera sees, and the DEM's u";
    let hidden = look.cells_where(|cell| !look.visible[cell]);
    let in_sight = look.cells_where(|cell| look.visible[cell]);
    let certain = hidden.iter().filter(|&&cell| look.dem_u[cell] < 1.0).count();
    let share = hidden.len() as f64 / look.grid.len() as f64;
    let u = in_sight.iter().map(|&cell| look.dem_u[cell]);
    // To the digits that an f32 holds.
    let most_u = (largest(u) / AS_F32).round() * AS_F32;
    vec![
        Check::new(group, "share of cells hidden", share, Against::Nothing),
        Check::count(group, "hidden cells with u below 1", certain, NONE),
        Check::new(group, "largest u of a cell in sight", most_u, Against::AtMost(NOISE_MOST)),
    ]
}

/// "Rock borders are marked as very interesting"; "only the parts in sight are".
fn rocks(look: &Look, expected: &Expected) -> Vec<Check> {
    let group = "Fig. 9, A to I: rock borders in sight are very interesting, hidden ones are not";
    let limits = &expected.rocks;
    let mut checks = Vec::new();
    let mut check = |name, value, against| checks.push(Check::new(group, name, value, against));
    let mut counts = Vec::new();
    let mut all = Vec::new();
    let mut promising = 0_usize;
    for rock in &expected.rock {
        let name = &rock.name;
        let (in_sight, hidden) = look.border(rock, limits.border_gradient);
        let (seen, unseen) = (look.mean_belief(&in_sight), look.mean_belief(&hidden));
        let least_seen = Against::Above(limits.in_sight_mean_above);
        check(format!("{name}: mean Bel(I) in sight"), seen, least_seen);
        let most_unseen = Against::Below(limits.hidden_mean_below);
        check(format!("{name}: mean Bel(I) hidden"), unseen, most_unseen);
        let noticeable = limits.noticeable.contains(name);
        let drop = if noticeable { limits.noticeable_drop_above } else { limits.drop_above };
        check(format!("{name}: drop from one to the other"), seen - unseen, Against::Above(drop));
        if noticeable {
            let least = Against::AtLeast(limits.noticeable_hidden_cells as f64);
            let name = format!("{name}: hidden cells, \"particularly noticeable\"");
            counts.push(Check::count(group, name, hidden.len(), least));
        }
        let unwanted = |cell: &&Cell| look.texture[**cell] == limits.hidden_texture_is_not;
        promising += hidden.iter().filter(unwanted).count();
        all.extend(in_sight);
    }
    let least = Against::Above(limits.in_sight_mean_of_all_above);
    check("all rocks: mean Bel(I) in sight".to_owned(), look.mean_belief(&all), least);
    let texture = limits.hidden_texture_is_not;
    let name = format!("all rocks: hidden cells of texture {texture}");
    counts.push(Check::count(group, name, promising, NONE));
    checks.extend(counts);
    checks
}

/// "Interesting mainly by the expert of the infrared map"; "cold apart from a single circular hot area".
fn hot_disc(look: &Look, expected: &Expected) -> Vec<Check> {
    let group = "Fig. 9, L: the hot disc";
    let disc = &expected.hot_disc;
    let core = look.cells_where(|cell| within(look.grid, cell, disc.centre, disc.core));
    let outside = look.cells_where(|cell| !within(look.grid, cell, disc.centre, disc.outside));
    let belief = least(core.iter().map(|&cell| look.interest[cell]));
    let share = |&cell: &Cell| credit(&look.evidence, &look.fusion, cell)[look.infrared];
    let warmest = largest(outside.iter().map(|&cell| look.temperature[cell]));
    let hidden = core.iter().filter(|&&cell| !look.visible[cell]).count();
    vec![
        Check::new(group, "least Bel(I) of its core", belief, Against::Above(disc.belief_above)),
        Check::new(
            group,
            "least share of the infrared expert in it",
            least(core.iter().map(share)),
            Against::Above(disc.temperature_credit_above),
        ),
        Check::count(group, "hidden cells of its core", hidden, NONE),
        Check::new(group, "warmest cell outside", warmest, Against::Below(disc.cold_below)),
    ]
}

/// "The most interesting of the whole map, with a value close to one".
fn most_interesting(look: &Look, expected: &Expected) -> Vec<Check> {
    let group = "Fig. 9, M: the rock border in the hot disc";
    let m = &expected.most_interesting;
    let area = look.hot_border(expected);
    let best = area.iter().map(|&cell| look.interest[cell]).fold(f32::NAN, f32::max);
    let above = look.cells_where(|cell| look.interest[cell] > best).len();
    let mean = look.mean_belief(&area);
    let borders = expected
        .rock
        .iter()
        .map(|rock| look.mean_belief(&look.border(rock, expected.rocks.border_gradient).0));
    let top = m.best_in_top_share * look.grid.len() as f64;
    vec![
        Check::count(group, "cells of the area", area.len(), Against::AtLeast(1.0)),
        Check::new(group, "best Bel(I)", best.into(), Against::Above(m.best_belief_above)),
        Check::count(group, "cells of the map above it", above, Against::Below(top)),
        Check::new(group, "mean Bel(I)", mean, Against::Above(m.mean_belief_above)),
        Check::new(
            group,
            "mean Bel(I) less that of the best whole border",
            mean - largest(borders),
            Against::Above(0.0),
        ),
    ]
}

/// "A consequence of the discontinuity of the soil texture"; "moving right, interest gradually decreases".
fn texture_edge(look: &Look, expected: &Expected) -> Vec<Check> {
    let group = "Fig. 9, N: the texture edge";
    let edge = &expected.texture_edge;
    let left = look.mean_belief(&look.area(&edge.left));
    let right: Vec<f64> = edge.right.iter().map(|r| look.mean_belief(&look.area(r))).collect();
    let mut checks = vec![Check::new(
        group,
        "mean Bel(I): jump at the edge",
        right.first().map_or(f64::NAN, |first| first - left),
        Against::Above(edge.jump_above),
    )];
    for (k, pair) in right.windows(2).enumerate() {
        let (from, to) = (edge.right[k].from[0], edge.right[k + 1].from[0]);
        let name = format!("mean Bel(I): fall from x = {from} on to x = {to} on");
        checks.push(Check::new(group, name, pair[0] - pair[1], Against::Above(edge.fall_above)));
    }
    let cells: Vec<Cell> = edge.right.iter().flat_map(|rectangle| look.area(rectangle)).collect();
    let most = |raster: &Raster<f32>| largest(cells.iter().map(|&cell| raster[cell]));
    let thermal_u = least(cells.iter().map(|&cell| look.temperature_u[cell]));
    for (name, value, against) in [
        ("largest gradient", most(&look.gradient), Against::Below(edge.gradient_below)),
        ("highest temperature", most(&look.temperature), Against::Below(edge.temperature_below)),
        ("largest u of the DEM", most(&look.dem_u), Against::Below(edge.dem_uncertainty_below)),
        (
            "largest u of the texture",
            most(&look.texture_u),
            Against::Below(edge.texture_uncertainty_below),
        ),
        ("least u of the temperature", thermal_u, Against::Above(edge.thermal_uncertainty_above)),
    ] {
        checks.push(Check::new(group, format!("right of the edge: {name}"), value, against));
    }
    checks
}

/// Tables 6 and 7 on the map: the border of rock D.
fn point(look: &Look, point: &Point, panel: &Panel<'_>) -> Vec<Check> {
    let group = "Fig. 9 at (67, 20): Tables 6 and 7 on the map";
    let cell = cell_at(look.grid, point.at);
    let value = |raster: &Raster<f32>| f64::from(raster[cell]);
    let row = |gradient: f32| panel.gradient.row_of(gradient).map_or(0.0, |row| (row + 1) as f64);
    let check = |name, computed, printed, within| {
        Check::printed(group, name, computed, printed, within).decimals(6)
    };
    vec![
        check("gradient magnitude", value(&look.gradient), point.gradient, point.gradient_within),
        check("row of Table 1", row(look.gradient[cell]), row(point.gradient as f32), 0.0)
            .decimals(0),
        check("texture", value(&look.texture), point.texture.into(), 0.0).decimals(0),
        check("temperature", value(&look.temperature), point.temperature, point.temperature_within),
        check("u of the DEM", value(&look.dem_u), point.dem_uncertainty, AS_F32),
        check("u of the texture", value(&look.texture_u), point.texture_uncertainty, AS_F32),
        check(
            "u of the temperature",
            value(&look.temperature_u),
            point.thermal_uncertainty,
            AS_F32,
        ),
        check("in sight (1) or hidden (0)", f64::from(u8::from(look.visible[cell])), 1.0, 0.0)
            .decimals(0),
        check("Bel(I)", look.belief(cell), point.belief, point.belief_within).decimals(8),
    ]
}

/// Not the paper's claim, but its use: the planner is to reach what is interesting.
fn ground(look: &Look, expected: &Expected) -> Vec<Check> {
    let group = "The ground: for the rover that drives here";
    let limits = &expected.ground;
    let slopes = slope(&look.elevation);
    let mut reached = Raster::filled(look.grid, false);
    let mut queue = VecDeque::from([look.camera]);
    while let Some(cell) = queue.pop_front() {
        if reached[cell] || f64::from(slopes.value(cell)) >= limits.slope_deg_below {
            continue;
        }
        reached[cell] = true;
        queue.extend(look.grid.neighbours(cell));
    }
    let cells = reached.values().iter().filter(|&&reached| reached).count();
    let name = format!("share reached over slopes below {} degrees", limits.slope_deg_below);
    let share = cells as f64 / look.grid.len() as f64;
    vec![Check::new(group, name, share, Against::Above(limits.reached_share_above))]
}

/// NaN, which no check lets pass, if there are none.
fn largest<V: Into<f64>>(values: impl Iterator<Item = V>) -> f64 {
    values.map(Into::into).fold(f64::NAN, f64::max)
}

/// NaN, which no check lets pass, if there are none.
fn least<V: Into<f64>>(values: impl Iterator<Item = V>) -> f64 {
    values.map(Into::into).fold(f64::NAN, f64::min)
}
