//! The paper's scene: what section IV says of its interest map comes true for many seeds.
//!
//! Fusion is a later crate; here Bel(I) is taken from its closed form under the classical rule DSmC,
//! 1 − Π (m(NI) + m(I ∪ NI)) over the experts, each discounted by its u (Eq. 4).

use std::collections::VecDeque;

use serde::Deserialize;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{Landscape, Layer, Observer, gradient, slope, unit_noise, viewshed};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=24;
const SIDE: usize = 101;
const CAMERA: Cell = Cell { row: 50, col: 50 };
const CAMERA_HEIGHT_M: f64 = 40.0;

/// An expert's table, as far as the closed form needs it: the mass on NI of each row.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    layer: String,
    #[allow(dead_code, reason = "read so that unknown keys stay errors")]
    quantity: String,
    #[allow(dead_code, reason = "read so that unknown keys stay errors")]
    unit: String,
    #[serde(default)]
    band: Vec<Row>,
    #[serde(default)]
    class: Vec<Row>,
    outside: Row,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Row {
    from: Option<f64>,
    to: Option<f64>,
    value: Option<f64>,
    paradox: f64,
    not_interesting: f64,
    interesting: f64,
}

impl Table {
    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.band.iter().chain(&self.class).chain([&self.outside])
    }

    /// m(NI) + m(I ∪ NI) for a reading with uncertainty u.
    fn doubt(&self, reading: f32, u: f64) -> f64 {
        let reading = f64::from(reading);
        let holds = |row: &&Row| match row.from {
            Some(from) => reading >= from && row.to.is_none_or(|to| reading < to),
            None => row.value == Some(reading),
        };
        let row = self.band.iter().chain(&self.class).find(holds).unwrap_or(&self.outside);
        u + (1.0 - u) * row.not_interesting
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Expected {
    rocks: Rocks,
    rock: Vec<Rock>,
    hot_disc: HotDisc,
    most_interesting: MostInteresting,
    texture_edge: TextureEdge,
    point: Point,
    ground: Ground,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rocks {
    border_gradient: f32,
    in_sight_mean_above: f64,
    in_sight_mean_of_all_above: f64,
    hidden_mean_below: f64,
    drop_above: f64,
    hidden_texture_is_not: f32,
    noticeable: Vec<String>,
    noticeable_hidden_cells: usize,
    noticeable_drop_above: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rock {
    name: String,
    centre: [f64; 2],
    reach: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HotDisc {
    #[serde(rename = "name")]
    _name: String,
    centre: [f64; 2],
    core: f64,
    belief_above: f64,
    temperature_credit_above: f64,
    outside: f64,
    cold_below: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MostInteresting {
    #[serde(rename = "name")]
    _name: String,
    rock: String,
    hot_from: f32,
    best_belief_above: f64,
    best_in_top_share: f64,
    mean_belief_above: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TextureEdge {
    #[serde(rename = "name")]
    _name: String,
    left: Rectangle,
    right: Vec<Rectangle>,
    jump_above: f64,
    fall_above: f64,
    gradient_below: f32,
    temperature_below: f32,
    dem_uncertainty_below: f64,
    texture_uncertainty_below: f64,
    thermal_uncertainty_above: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rectangle {
    from: [usize; 2],
    to: [usize; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    at: [usize; 2],
    gradient: f32,
    gradient_within: f32,
    texture: f32,
    temperature: f32,
    temperature_within: f32,
    dem_uncertainty: f64,
    texture_uncertainty: f64,
    thermal_uncertainty: f64,
    belief: f64,
    belief_within: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ground {
    slope_deg_below: f32,
    reached_share_above: f64,
}

fn mission<T: serde::de::DeserializeOwned>(name: &str) -> T {
    let path = format!("{}/../../missions/paper/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("a file of the paper's mission");
    toml::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The paper's (x, y) of a cell.
fn paper(cell: Cell) -> [f64; 2] {
    [(cell.col + 1) as f64, (SIDE - cell.row) as f64]
}

fn within(cell: Cell, centre: [f64; 2], radius: f64) -> bool {
    let [x, y] = paper(cell);
    (x - centre[0]).hypot(y - centre[1]) <= radius
}

fn inside(cell: Cell, area: &Rectangle) -> bool {
    let [x, y] = paper(cell).map(|v| v as usize);
    (area.from[0]..=area.to[0]).contains(&x) && (area.from[1]..=area.to[1]).contains(&y)
}

/// The first look at the scene under one seed.
struct Look {
    expected: Expected,
    elevation: Layer,
    gradient: Layer,
    texture: Raster<f32>,
    temperature: Raster<f32>,
    visible: Raster<bool>,
    /// Uncertainty of elevation, temperature, texture.
    u: Raster<[f64; 3]>,
    /// Doubt of the elevation, temperature and texture experts.
    doubt: Raster<[f64; 3]>,
}

impl Look {
    fn take(seed: u64) -> Self {
        let expected: Expected = mission("expected.toml");
        let scene: Landscape = mission("landscape.toml");
        let [dem, thermal, patterns] = tables();
        let spec = GridSpec::new(SIDE, SIDE, 1.0).expect("the paper's grid");
        let mut layers = scene.render(spec, seed);
        let mut layer = |name: &str| layers.remove(name).expect("a layer of the landscape");
        let (texture, temperature) = (layer("texture"), layer("temperature"));
        let elevation = Layer::certain(layer("elevation")).expect("finite heights");
        let gradient = gradient(&elevation);
        let shed = viewshed(&elevation, &Observer::all_round(CAMERA, CAMERA_HEIGHT_M));
        let visible = Raster::from_fn(spec, |cell| shed.is_visible(cell));
        let [x, y] = expected.point.at;
        let pinned = Cell { row: SIDE - y, col: x - 1 };
        let u = Raster::from_fn(spec, |cell| {
            let [x, y] = paper(cell);
            let noise = 0.2 * unit_noise(&[seed, 0x0044_454D, spec.index(cell) as u64]);
            let sight = if visible[cell] { 0.0 } else { 1.0 };
            let dem = if cell == pinned { expected.point.dem_uncertainty } else { sight + noise };
            [dem.min(1.0), (y - 1.0) / 100.0, (x - 1.0) / 100.0]
        });
        let doubt = Raster::from_fn(spec, |cell| {
            [
                dem.doubt(gradient.value(cell), u[cell][0]),
                thermal.doubt(temperature[cell], u[cell][1]),
                patterns.doubt(texture[cell], u[cell][2]),
            ]
        });
        Self { expected, elevation, gradient, texture, temperature, visible, u, doubt }
    }

    fn belief(&self, cell: Cell) -> f64 {
        1.0 - self.doubt[cell].iter().product::<f64>()
    }

    fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        self.texture.spec().cells()
    }

    fn mean_belief(&self, cells: &[Cell]) -> f64 {
        assert!(!cells.is_empty(), "a mean of no cells");
        cells.iter().map(|&cell| self.belief(cell)).sum::<f64>() / cells.len() as f64
    }

    /// Border cells of a rock: in sight, hidden.
    fn border(&self, rock: &Rock) -> (Vec<Cell>, Vec<Cell>) {
        self.cells()
            .filter(|&cell| within(cell, rock.centre, rock.reach))
            .filter(|&cell| self.gradient.value(cell) >= self.expected.rocks.border_gradient)
            .partition(|&cell| self.visible[cell])
    }
}

fn tables() -> [Table; 3] {
    ["dem", "temperature", "texture"].map(|name| mission(&format!("experts/{name}.toml")))
}

fn each_look(claim: impl Fn(u64, &Look)) {
    for seed in SEEDS {
        claim(seed, &Look::take(seed));
    }
}

#[test]
fn tables_1_to_3_read_the_scenes_layers_and_sum_to_one() {
    for (table, layer) in tables().iter().zip(["gradient", "temperature", "texture"]) {
        assert_eq!(table.layer, layer, "{}", table.name);
        for row in table.rows() {
            let sum = row.paradox + row.not_interesting + row.interesting;
            assert!((sum - 1.0).abs() < 1e-12, "{}: a row sums to {sum}", table.name);
        }
        for pair in table.band.windows(2) {
            assert_eq!(pair[0].to, pair[1].from, "{}: bands meet", table.name);
        }
    }
}

#[test]
fn rock_borders_in_sight_are_very_interesting_and_hidden_ones_are_not() {
    each_look(|seed, look| {
        let Rocks { in_sight_mean_above, hidden_mean_below, drop_above, .. } = look.expected.rocks;
        let mut all = Vec::new();
        for rock in &look.expected.rock {
            let (in_sight, hidden) = look.border(rock);
            let (seen, unseen) = (look.mean_belief(&in_sight), look.mean_belief(&hidden));
            let name = &rock.name;
            assert!(seen > in_sight_mean_above, "seed {seed}, {name}: {seen} in sight");
            assert!(unseen < hidden_mean_below, "seed {seed}, {name}: {unseen} hidden");
            assert!(seen - unseen > drop_above, "seed {seed}, {name}: {seen} to {unseen}");
            all.extend(in_sight);
        }
        let mean = look.mean_belief(&all);
        assert!(mean > look.expected.rocks.in_sight_mean_of_all_above, "seed {seed}: {mean}");
    });
}

#[test]
fn hidden_sides_are_particularly_noticeable_at_b_c_d_and_g() {
    each_look(|seed, look| {
        let rocks = &look.expected.rocks;
        assert_eq!(rocks.noticeable, ["B", "C", "D", "G"]);
        for rock in look.expected.rock.iter().filter(|rock| rocks.noticeable.contains(&rock.name)) {
            let (in_sight, hidden) = look.border(rock);
            let drop = look.mean_belief(&in_sight) - look.mean_belief(&hidden);
            let name = &rock.name;
            assert!(hidden.len() >= rocks.noticeable_hidden_cells, "seed {seed}, {name}");
            assert!(drop > rocks.noticeable_drop_above, "seed {seed}, {name}: {drop}");
        }
    });
}

#[test]
fn no_texture_4_lies_behind_a_rock() {
    each_look(|seed, look| {
        for rock in &look.expected.rock {
            for cell in look.border(rock).1 {
                let class = look.texture[cell];
                let [x, y] = paper(cell);
                assert_ne!(
                    class, look.expected.rocks.hidden_texture_is_not,
                    "seed {seed}, ({x}, {y})"
                );
            }
        }
    });
}

#[test]
fn the_hot_disc_is_interesting_to_the_infrared_expert_on_cold_ground() {
    each_look(|seed, look| {
        let disc = &look.expected.hot_disc;
        for cell in look.cells() {
            if within(cell, disc.centre, disc.core) {
                let [dem, thermal, texture] = look.doubt[cell].map(f64::ln);
                let credit = thermal / (dem + thermal + texture);
                assert!(look.belief(cell) > disc.belief_above, "seed {seed} {cell}");
                assert!(credit > disc.temperature_credit_above, "seed {seed} {cell}: {credit}");
                assert!(look.visible[cell], "seed {seed} {cell}");
            } else if !within(cell, disc.centre, disc.outside) {
                assert!(look.temperature[cell] < disc.cold_below, "seed {seed} {cell}");
            }
        }
    });
}

#[test]
fn the_rock_border_in_the_hot_disc_is_the_most_interesting_place() {
    each_look(|seed, look| {
        let m = &look.expected.most_interesting;
        let border = |rock: &Rock| look.border(rock).0;
        let rock = look.expected.rock.iter().find(|rock| rock.name == m.rock).expect("rock C");
        let area: Vec<Cell> =
            border(rock).into_iter().filter(|&cell| look.temperature[cell] >= m.hot_from).collect();
        let best = area.iter().map(|&cell| look.belief(cell)).fold(0.0, f64::max);
        let above = look.cells().filter(|&cell| look.belief(cell) > best).count();
        assert!(best > m.best_belief_above, "seed {seed}: {best}");
        let top = m.best_in_top_share * (SIDE * SIDE) as f64;
        assert!((above as f64) < top, "seed {seed}: {above} cells above");
        let mean = look.mean_belief(&area);
        assert!(mean > m.mean_belief_above, "seed {seed}: {mean}");
        for other in &look.expected.rock {
            let theirs = look.mean_belief(&border(other));
            assert!(mean > theirs, "seed {seed}: M {mean}, {} {theirs}", other.name);
        }
    });
}

#[test]
fn interest_jumps_at_the_texture_edge_and_falls_to_the_right() {
    each_look(|seed, look| {
        let edge = &look.expected.texture_edge;
        let area = |rectangle: &Rectangle| -> Vec<Cell> {
            look.cells().filter(|&cell| inside(cell, rectangle)).collect()
        };
        let left = look.mean_belief(&area(&edge.left));
        let right: Vec<f64> = edge.right.iter().map(|r| look.mean_belief(&area(r))).collect();
        assert!(right[0] - left > edge.jump_above, "seed {seed}: {left} to {right:?}");
        assert!(right.windows(2).all(|w| w[0] - w[1] > edge.fall_above), "seed {seed}: {right:?}");
        for cell in edge.right.iter().flat_map(area) {
            let [dem, thermal, texture] = look.u[cell];
            assert!(look.gradient.value(cell) < edge.gradient_below, "seed {seed} {cell}");
            assert!(look.temperature[cell] < edge.temperature_below, "seed {seed} {cell}");
            assert!(dem < edge.dem_uncertainty_below, "seed {seed} {cell}: {dem}");
            assert!(texture < edge.texture_uncertainty_below, "seed {seed} {cell}: {texture}");
            assert!(thermal > edge.thermal_uncertainty_above, "seed {seed} {cell}: {thermal}");
        }
    });
}

/// Tables 6 and 7: each reading, each u, and the belief they add up to.
#[test]
fn the_border_of_rock_d_is_the_point_of_tables_6_and_7() {
    each_look(|seed, look| {
        let point = &look.expected.point;
        let cell = Cell { row: SIDE - point.at[1], col: point.at[0] - 1 };
        let gradient = look.gradient.value(cell);
        let off = (gradient - point.gradient).abs();
        assert!(
            (5.0..7.0).contains(&gradient) && off < point.gradient_within,
            "seed {seed}: {gradient}"
        );
        assert_eq!(look.texture[cell], point.texture);
        let temperature = look.temperature[cell];
        assert!(
            (temperature - point.temperature).abs() < point.temperature_within,
            "{temperature}"
        );
        let u = [point.dem_uncertainty, point.thermal_uncertainty, point.texture_uncertainty];
        assert_eq!(look.u[cell], u);
        assert!(look.visible[cell], "seed {seed}: the point is in sight");
        assert!((look.belief(cell) - point.belief).abs() < point.belief_within);
    });
}

#[test]
fn a_rover_reaches_nearly_all_level_ground_from_the_middle() {
    each_look(|seed, look| {
        let ground = &look.expected.ground;
        let slopes = slope(&look.elevation);
        let mut reached = Raster::filled(slopes.spec(), false);
        let mut queue = VecDeque::from([CAMERA]);
        while let Some(cell) = queue.pop_front() {
            if reached[cell] || slopes.value(cell) >= ground.slope_deg_below {
                continue;
            }
            reached[cell] = true;
            queue.extend(slopes.spec().neighbours(cell));
        }
        let share = reached.values().iter().filter(|&&r| r).count() as f64 / (SIDE * SIDE) as f64;
        assert!(share > ground.reached_share_above, "seed {seed}: {share}");
    });
}
