//! Synthetic scenes: base plane, rocks, craters, ridges, roughness, textures and hot spots, described as data.
//!
//! Places and plan lengths are in **cells**: `[col, row]` counts from the north-west cell's centre, columns to the
//! east, rows to the south, fractions allowed. Heights are in metres. Every number in a description is finite
//! and within ±10⁹; the ones that are lengths are positive.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, de::Error};
use wisdom_grid::{Cell, GridSpec, Raster, Window};

use crate::unit_noise;

/// A synthetic scene, usually read from a mission's TOML; unknown keys are errors.
///
/// Elevation is base plane + craters + ridges + roughness + the highest rock at each cell, named or scattered.
/// Texture is the class of a scattered rock, else of the last patch that covers a cell, else the base's. Temperature is the highest hot spot's, else the base's.
///
/// ```
/// # use wisdom_grid::{Cell, GridSpec};
/// # use wisdom_terrain::Landscape;
/// let scene: Landscape = toml::from_str(r#"
///     [[rock]]
///     name = "A"
///     centre = [5.0, 5.0]
///     half-axes = [3.0, 3.0]
///     height_m = 4.0
///     wall = "ramp"
///     wall_cells = 2.0
/// "#)?;
/// let layers = scene.render(GridSpec::new(11, 11, 1.0)?, 1);
/// assert_eq!(layers["elevation"][Cell::new(5, 5)], 4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Landscape {
    /// The plane that everything stands on.
    pub base: Base,
    /// Seeded fractal relief over the whole scene.
    pub roughness: Option<Roughness>,
    /// Rocks.
    pub rock: Vec<Rock>,
    /// Fields of rocks too many to name.
    pub scatter: Vec<Scatter>,
    /// Craters.
    pub crater: Vec<Crater>,
    /// Ridges.
    pub ridge: Vec<Ridge>,
    /// Texture patches, later ones over earlier ones.
    pub patch: Vec<Patch>,
    /// Hot spots.
    pub hot_spot: Vec<HotSpot>,
}

/// What a scene can be drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneLayer {
    /// Heights, metres.
    Elevation,
    /// Texture classes.
    Texture,
    /// Temperatures, in the mission's unit.
    Temperature,
}

impl SceneLayer {
    /// Every layer.
    pub const ALL: [Self; 3] = [Self::Elevation, Self::Texture, Self::Temperature];
}

impl fmt::Display for SceneLayer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Elevation => "elevation",
            Self::Texture => "texture",
            Self::Temperature => "temperature",
        })
    }
}

/// The plane that everything stands on.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Base {
    /// Elevation of the north-west cell, metres.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub elevation_m: f64,
    /// Rise to the east, rise over run.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub rise_east: f64,
    /// Rise to the north, rise over run.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub rise_north: f64,
    /// Texture class where no patch is.
    pub texture: u16,
    /// Temperature away from hot spots, in the mission's unit.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub temperature: f64,
}

/// Seeded fractal relief: octaves of smoothed lattice noise (Perlin, 1985, with values in place of gradients), each of half the wavelength.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Roughness {
    /// Largest departure of the first octave from the plane, metres.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub amplitude_m: f64,
    /// Lattice spacing of the first octave, cells.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub wavelength_cells: f64,
    /// Number of octaves, up to 16.
    #[serde(deserialize_with = "octaves")]
    #[schemars(range(max = 16))]
    pub octaves: u8,
    /// Amplitude of each octave relative to the one before.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub gain: f64,
}

/// An elliptic rock with a flat or domed top.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rock {
    /// What a person calls it; not used in rendering.
    #[serde(default)]
    pub name: String,
    /// Centre, `[col, row]`.
    #[serde(deserialize_with = "finites")]
    #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
    pub centre: [f64; 2],
    /// Half-axes at the foot, cells: along the rock's own east and north.
    #[serde(rename = "half-axes", deserialize_with = "positives")]
    #[schemars(inner(range(min = 0.0, max = LARGEST)))]
    pub half_axes: [f64; 2],
    /// How far the rock is turned, degrees clockwise from above.
    #[serde(default, deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub turned_deg: f64,
    /// Height of the top above the ground under it, metres.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub height_m: f64,
    /// How the wall rises from foot to top.
    pub wall: Wall,
    /// Breadth of the wall in plan, cells, measured on the shorter axis.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub wall_cells: f64,
}

/// A field of half-ellipsoid rocks over the whole scene, each placed and sized by the seed. Where two overlap, the
/// higher one counts.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Rocks on a thousand cells, on average.
    #[serde(deserialize_with = "density")]
    #[schemars(range(max = 1000.0), extend("exclusiveMinimum" = 0.0))]
    pub per_1000_cells: f64,
    /// Smallest and largest radius at the foot, cells.
    #[serde(deserialize_with = "radii")]
    #[schemars(inner(range(min = 0.0, max = 100.0)))]
    pub radius_cells: [f64; 2],
    /// The number of rocks larger than r falls with r to minus this power.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Height of a rock, metres for each cell of its radius.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub height_m_per_cell: f64,
    /// Texture class of the rocks; that of the ground under them if none.
    #[serde(default)]
    pub class: Option<u16>,
}

/// How a rock's wall rises from foot to top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Wall {
    /// At one gradient, `height / breadth`.
    Ramp,
    /// In an S, steepest half-way up at 1.5 × `height / breadth`.
    Smooth,
    /// As a quarter ellipse, steepest at the foot.
    Dome,
}

/// A bowl with a raised rim.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Crater {
    /// Centre, `[col, row]`.
    #[serde(deserialize_with = "finites")]
    #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
    pub centre: [f64; 2],
    /// Radius of the rim, cells.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub radius_cells: f64,
    /// Depth of the middle below the plane, metres.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub depth_m: f64,
    /// Height of the rim above the plane, metres; outside, it falls with the cube of the distance, as ejecta do (`McGetchin`, Settle and Head, 1973).
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub rim_m: f64,
}

/// A straight ridge with rounded ends and an S-shaped flank.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ridge {
    /// One end of the crest, `[col, row]`.
    #[serde(deserialize_with = "finites")]
    #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
    pub from: [f64; 2],
    /// The other end of the crest, `[col, row]`.
    #[serde(deserialize_with = "finites")]
    #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
    pub to: [f64; 2],
    /// Distance from crest to foot, cells.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub half_width_cells: f64,
    /// Height of the crest, metres.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub height_m: f64,
}

/// Ground of one texture class.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patch {
    /// The texture class.
    pub class: u16,
    /// The cells whose centres lie inside have it.
    pub shape: Shape,
}

/// A figure in the plane, `[col, row]` and cells.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Shape {
    /// All between two corners, edges included.
    Rectangle {
        /// One corner, `[col, row]`.
        #[serde(deserialize_with = "finites")]
        #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
        from: [f64; 2],
        /// The opposite corner, `[col, row]`.
        #[serde(deserialize_with = "finites")]
        #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
        to: [f64; 2],
    },
    /// All within a radius.
    Disc {
        /// Centre, `[col, row]`.
        #[serde(deserialize_with = "finites")]
        #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
        centre: [f64; 2],
        /// Radius, cells.
        #[serde(deserialize_with = "positive")]
        #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
        radius_cells: f64,
    },
    /// The part of a disc on one side of a line through a point: the face of a rock turned one way.
    Face {
        /// Centre of the disc, `[col, row]`.
        #[serde(deserialize_with = "finites")]
        #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
        centre: [f64; 2],
        /// Radius of the disc, cells.
        #[serde(deserialize_with = "positive")]
        #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
        radius_cells: f64,
        /// The place the face is turned to, `[col, row]`.
        #[serde(deserialize_with = "finites")]
        #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
        towards: [f64; 2],
        /// How far beyond the disc's centre the face ends, cells towards that place (negative: behind the centre).
        #[serde(deserialize_with = "finite")]
        #[schemars(range(min = -LARGEST, max = LARGEST))]
        beyond_cells: f64,
    },
    /// All inside a closed line (even-odd).
    Polygon {
        /// The corners in turn, `[col, row]` each.
        #[serde(deserialize_with = "corners")]
        #[schemars(length(min = 3))]
        corners: Vec<[f64; 2]>,
    },
}

/// A round warm place with a soft edge.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HotSpot {
    /// Centre, `[col, row]`.
    #[serde(deserialize_with = "finites")]
    #[schemars(inner(range(min = -LARGEST, max = LARGEST)))]
    pub centre: [f64; 2],
    /// Radius at which the warmth ends, cells.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub radius_cells: f64,
    /// Breadth of the ring in which it fades, cells; inside the ring it is at its peak.
    #[serde(deserialize_with = "positive")]
    #[schemars(range(max = LARGEST), extend("exclusiveMinimum" = 0.0))]
    pub edge_cells: f64,
    /// Temperature in the middle, in the mission's unit.
    #[serde(deserialize_with = "finite")]
    #[schemars(range(min = -LARGEST, max = LARGEST))]
    pub peak: f64,
}

impl Landscape {
    /// Draws the scene on a grid: the layers `elevation` (metres), `texture` (class) and `temperature` (the
    /// mission's unit). The seed moves the roughness and the scattered rocks, and nothing else; same seed, same bits at any thread
    /// count.
    #[must_use]
    pub fn render(&self, spec: GridSpec, seed: u64) -> BTreeMap<String, Raster<f32>> {
        let layer = |layer: SceneLayer| (layer.to_string(), self.render_layer(layer, spec, seed));
        SceneLayer::ALL.map(layer).into()
    }

    /// Draws one layer, as [`Landscape::render`] does. On a [part](GridSpec::part) of a grid it is that part of the
    /// whole picture, bit for bit: ground larger than memory is drawn piece by piece.
    #[must_use]
    pub fn render_layer(&self, layer: SceneLayer, spec: GridSpec, seed: u64) -> Raster<f32> {
        let near = self.near(spec.window());
        Raster::par_from_fn(spec, |cell| {
            let value = match layer {
                SceneLayer::Elevation => near.elevation(cell, spec.spacing_m(), seed),
                SceneLayer::Texture => f64::from(near.texture(point(cell), seed)),
                SceneLayer::Temperature => near.temperature(point(cell)),
            };
            value.clamp(f32::MIN.into(), f32::MAX.into()) as f32
        })
    }

    /// The scene without what cannot reach a window. What is left out adds nothing there, so the sums keep their bits.
    fn near(&self, window: Window) -> Self {
        let low = [window.col as f64, window.row as f64];
        let high = [(window.col + window.cols) as f64, (window.row + window.rows) as f64];
        let touches = |centre: Point, reach: f64| {
            (0..2).all(|k| centre[k] + reach >= low[k] && centre[k] - reach <= high[k])
        };
        let mut near = self.clone();
        // Ground away from a rock has height 0 for it, which counts when the highest is taken: one rock that is out of
        // reach stays and says so.
        let mut witness = false;
        near.rock.retain(|rock| {
            let reaches = touches(rock.centre, rock.half_axes[0].max(rock.half_axes[1]));
            reaches || !std::mem::replace(&mut witness, true)
        });
        near.hot_spot.retain(|spot| touches(spot.centre, spot.radius_cells));
        near
    }

    fn elevation(&self, cell: Cell, spacing_m: f64, seed: u64) -> f64 {
        let at = point(cell);
        let plane = self.base.elevation_m
            + spacing_m * (self.base.rise_east * at[0] - self.base.rise_north * at[1]);
        let craters: f64 = self.crater.iter().map(|crater| crater.height(at)).sum();
        let ridges: f64 = self.ridge.iter().map(|ridge| ridge.height(at)).sum();
        let rocks = self.rock.iter().map(|rock| rock.height(at)).reduce(f64::max).unwrap_or(0.0);
        let relief = self.roughness.map_or(0.0, |roughness| roughness.height(at, seed));
        let scattered = self.scatter.iter().enumerate();
        let scattered = scattered.map(|(field, scatter)| scatter.height(at, field, seed));
        let rocks = scattered.fold(rocks, f64::max);
        plane + craters + ridges + relief + rocks
    }

    fn texture(&self, at: Point, seed: u64) -> u16 {
        for (field, scatter) in self.scatter.iter().enumerate().rev() {
            if let Some(class) = scatter.class
                && scatter.height(at, field, seed) > 0.0
            {
                return class;
            }
        }
        let patch = self.patch.iter().rev().find(|patch| patch.shape.contains(at));
        patch.map_or(self.base.texture, |patch| patch.class)
    }

    fn temperature(&self, at: Point) -> f64 {
        let background = self.base.temperature;
        let warmest =
            |a: f64, b: f64| if (b - background).abs() > (a - background).abs() { b } else { a };
        self.hot_spot.iter().map(|spot| spot.temperature(at, background)).fold(background, warmest)
    }
}

/// A place in the plane: col, row.
type Point = [f64; 2];

fn point(cell: Cell) -> Point {
    [cell.col as f64, cell.row as f64]
}

fn distance(a: Point, b: Point) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// Smoothstep: from 0 at 0 to 1 at 1, level at both ends.
fn eased(share: f64) -> f64 {
    let t = share.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Rock {
    /// Height above the ground, from the distance inside the foot as a share of the wall's breadth.
    fn height(&self, at: Point) -> f64 {
        let turn = self.turned_deg.to_radians();
        let (sin, cos) = (libm::sin(turn), libm::cos(turn));
        let (d_col, d_row) = (at[0] - self.centre[0], at[1] - self.centre[1]);
        let (along, across) = (d_col * cos + d_row * sin, d_row * cos - d_col * sin);
        let [a, b] = self.half_axes;
        let inside_cells = (1.0 - libm::hypot(along / a, across / b)) * a.min(b);
        let share = (inside_cells / self.wall_cells).clamp(0.0, 1.0);
        self.height_m
            * match self.wall {
                Wall::Ramp => share,
                Wall::Smooth => eased(share),
                Wall::Dome => libm::sqrt(share * (2.0 - share)),
            }
    }
}

/// The purpose word of scattered rocks in the keys of [`unit_noise`].
const SCATTER: u64 = 0x5343_4154_5445;

impl Scatter {
    /// Height of the highest rock here, 0 between them. Rocks are drawn block by block, so that those near a place are
    /// known without the rest; a block is as wide as the largest of them.
    fn height(&self, at: Point, field: usize, seed: u64) -> f64 {
        let [least, most] = self.radius_cells;
        let side = 2.0 * most;
        let mean = self.per_1000_cells / 1000.0 * side * side;
        let block = |place: f64| (place / side).floor() as i64;
        let mut highest = 0.0_f64;
        for row in block(at[1] - most)..=block(at[1] + most) {
            for col in block(at[0] - most)..=block(at[0] + most) {
                let draw = |rock: u64, what: u64| {
                    unit_noise(&[seed, SCATTER, field as u64, col as u64, row as u64, rock, what])
                };
                let count = (mean + draw(0, 0)).floor() as u64;
                for rock in 1..=count {
                    let centre =
                        [(col as f64 + draw(rock, 1)) * side, (row as f64 + draw(rock, 2)) * side];
                    let away = distance(at, centre);
                    if away >= most {
                        continue;
                    }
                    // The power law's inverse, cut at the largest radius.
                    let share = 1.0 - libm::pow(least / most, self.exponent);
                    let radius =
                        least * libm::pow(1.0 - share * draw(rock, 3), -1.0 / self.exponent);
                    if away < radius {
                        let share = away / radius;
                        let dome = libm::sqrt(1.0 - share * share);
                        highest = highest.max(self.height_m_per_cell * radius * dome);
                    }
                }
            }
        }
        highest
    }
}

impl Crater {
    fn height(&self, at: Point) -> f64 {
        let share = distance(at, self.centre) / self.radius_cells;
        if share < 1.0 {
            let bowl = share * share;
            (self.depth_m + self.rim_m) * bowl - self.depth_m
        } else {
            self.rim_m / (share * share * share)
        }
    }
}

impl Ridge {
    fn height(&self, at: Point) -> f64 {
        let (u, v) = (self.to[0] - self.from[0], self.to[1] - self.from[1]);
        let (p, q) = (at[0] - self.from[0], at[1] - self.from[1]);
        let length_squared = u * u + v * v;
        let t = if length_squared > 0.0 { (p * u + q * v) / length_squared } else { 0.0 };
        let t = t.clamp(0.0, 1.0);
        let off_crest = libm::hypot(p - t * u, q - t * v);
        self.height_m * eased(1.0 - off_crest / self.half_width_cells)
    }
}

/// The purpose word of roughness in the keys of [`unit_noise`].
const ROUGHNESS: u64 = 0x524F_5547_4821;

impl Roughness {
    fn height(&self, at: Point, seed: u64) -> f64 {
        let (mut height, mut amplitude, mut wavelength) =
            (0.0, self.amplitude_m, self.wavelength_cells);
        for octave in 0..u64::from(self.octaves) {
            let lattice = |col: f64, row: f64| {
                let key = [seed, ROUGHNESS, octave, col as i64 as u64, row as i64 as u64];
                2.0 * unit_noise(&key) - 1.0
            };
            let (x, y) = (at[0] / wavelength, at[1] / wavelength);
            let (col, row) = (x.floor(), y.floor());
            let (s, t) = (eased(x - col), eased(y - row));
            let north = lattice(col, row) * (1.0 - s) + lattice(col + 1.0, row) * s;
            let south = lattice(col, row + 1.0) * (1.0 - s) + lattice(col + 1.0, row + 1.0) * s;
            height += amplitude * (north * (1.0 - t) + south * t);
            amplitude *= self.gain;
            wavelength /= 2.0;
        }
        height
    }
}

impl Shape {
    fn contains(&self, at: Point) -> bool {
        let between = |value: f64, a: f64, b: f64| value >= a.min(b) && value <= a.max(b);
        match self {
            Self::Rectangle { from, to } => {
                between(at[0], from[0], to[0]) && between(at[1], from[1], to[1])
            }
            Self::Disc { centre, radius_cells } => distance(at, *centre) <= *radius_cells,
            Self::Face { centre, radius_cells, towards, beyond_cells } => {
                let (u, v) = (towards[0] - centre[0], towards[1] - centre[1]);
                let ahead = (at[0] - centre[0]) * u + (at[1] - centre[1]) * v;
                distance(at, *centre) <= *radius_cells && ahead >= beyond_cells * libm::hypot(u, v)
            }
            Self::Polygon { corners } => {
                let edges = corners.iter().zip(corners.iter().cycle().skip(1));
                edges.filter(|&(&a, &b)| is_west_of_edge(at, a, b)).count() % 2 == 1
            }
        }
    }
}

/// Whether a ray from the point to the east crosses the edge from `a` to `b`.
fn is_west_of_edge(at: Point, a: Point, b: Point) -> bool {
    (a[1] > at[1]) != (b[1] > at[1])
        && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1])
}

impl HotSpot {
    fn temperature(&self, at: Point, background: f64) -> f64 {
        let inside_cells = self.radius_cells - distance(at, self.centre);
        background + (self.peak - background) * eased(inside_cells / self.edge_cells)
    }
}

/// The largest magnitude a number of a description may have: far beyond any landscape, far below overflow.
const LARGEST: f64 = 1e9;

fn checked<E: Error>(value: f64) -> Result<f64, E> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(E::custom(format_args!("{value} where a finite number within ±{LARGEST:e} is wanted")))
}

fn checked_length<E: Error>(value: f64) -> Result<f64, E> {
    if value > 0.0 {
        return checked(value);
    }
    Err(E::custom(format_args!("a length of {value}; it must be above 0")))
}

fn finite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    checked(f64::deserialize(from)?)
}

fn positive<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    checked_length(f64::deserialize(from)?)
}

fn finites<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let [a, b] = <[f64; 2]>::deserialize(from)?;
    Ok([checked(a)?, checked(b)?])
}

fn positives<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let [a, b] = <[f64; 2]>::deserialize(from)?;
    Ok([checked_length(a)?, checked_length(b)?])
}

fn density<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let density = f64::deserialize(from)?;
    if density > 0.0 && density <= 1000.0 {
        return Ok(density);
    }
    let wanted = "above 0 and at most 1000 are wanted";
    Err(D::Error::custom(format_args!("{density} rocks on a thousand cells; {wanted}")))
}

fn radii<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let [least, most] = <[f64; 2]>::deserialize(from)?;
    if least > 0.0 && least < most && most <= 100.0 {
        return Ok([least, most]);
    }
    let wanted = "two that grow, above 0 and at most 100 cells, are wanted";
    Err(D::Error::custom(format_args!("radii from {least} to {most}; {wanted}")))
}

fn octaves<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    let octaves = u8::deserialize(from)?;
    if octaves <= 16 {
        return Ok(octaves);
    }
    Err(D::Error::custom(format_args!("{octaves} octaves; at most 16 are of any use")))
}

fn corners<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<[f64; 2]>, D::Error> {
    let corners = Vec::<[f64; 2]>::deserialize(from)?;
    if corners.len() < 3 {
        return Err(D::Error::custom(format_args!(
            "a polygon of {} corners; it has 3 or more",
            corners.len()
        )));
    }
    corners.into_iter().map(|[a, b]| Ok([checked(a)?, checked(b)?])).collect()
}
