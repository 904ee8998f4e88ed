//! A raster of heights as shaded triangles in orthographic projection, drawn through a depth buffer.
//!
//! Every cell is a patch of eight triangles about its centre, which has the cell's own height and value. The points
//! around it, its corners and the middles of its sides, have the mean of the known cells that meet there, so that the
//! surface is closed, except over unknown cells.

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use rayon::prelude::*;

use super::canvas::{Canvas, Point2, off_line};

/// Samples a side of a pixel.
const SAMPLES: usize = 3;
/// Rows of pixels that are drawn together, by one thread.
const BAND: usize = 16;
/// Share of the light that comes from all sides.
const AMBIENT: f32 = 0.5;
/// How far the colour of ground brighter than level ground goes to white.
const GLOSS: f32 = 0.55;
/// Colours kept ready for values that are no classes.
const SHADES: usize = 1024;
/// The sides where the ground is cut off.
const CUT: Rgb888 = Rgb888::new(188, 180, 170);
/// How bright the darkest cut is.
const LEAST_OF_CUT: f32 = 0.5;
/// Ground without a value.
pub(super) const BARE: Rgb888 = Rgb888::new(176, 176, 180);
/// How much nearer a rod counts as it is, pixels: else the ground that it stands on would cover its foot.
const ROD_BIAS: f64 = 1.0;

pub(super) type Point3 = [f64; 3];

fn dot(a: Point3, b: Point3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The direction that an azimuth (clockwise from north) and an altitude point to: east, north, up.
fn direction(azimuth_rad: f64, altitude_rad: f64) -> Point3 {
    let (sin, cos) = azimuth_rad.sin_cos();
    let (up, level) = altitude_rad.sin_cos();
    [sin * level, cos * level, up]
}

/// A viewer so far away that parallel lines stay parallel, and a light as far.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Toward the viewer: east, north, up, of length one.
    pub(super) toward: Point3,
    /// To the viewer's right, level.
    right: Point3,
    /// Up in the picture.
    up: Point3,
    /// Toward the light.
    light: Point3,
    /// Pixels in a unit.
    pub(super) scale: f64,
    /// Where the origin stands in the picture, pixels.
    pub(super) origin: (f64, f64),
}

impl View {
    /// From an azimuth (clockwise from north) and an altitude, with the light as far to the viewer's left as
    /// `light_left_rad` and at `light_altitude_rad`; one pixel a unit, the origin in the corner.
    pub(super) fn new(azimuth_rad: f64, altitude_rad: f64, light: (f64, f64)) -> Self {
        let toward = direction(azimuth_rad, altitude_rad);
        let (sin, cos) = azimuth_rad.sin_cos();
        let right = [-cos, sin, 0.0];
        let up = [
            toward[1] * right[2] - toward[2] * right[1],
            toward[2] * right[0] - toward[0] * right[2],
            toward[0] * right[1] - toward[1] * right[0],
        ];
        let light = direction(azimuth_rad + light.0, light.1);
        Self { toward, right, up, light, scale: 1.0, origin: (0.0, 0.0) }
    }

    /// Width and height in the picture of a box about the origin, by half its sides.
    pub(super) fn extent(&self, half: Point3) -> (f64, f64) {
        let long = |axis: Point3| 2.0 * self.scale * dot(axis.map(f64::abs), half);
        (long(self.right), long(self.up))
    }

    /// Where a point stands in the picture, and how near it is to the viewer, all in pixels.
    pub(super) fn project(&self, point: Point3) -> Point3 {
        [
            self.origin.0 + self.scale * dot(self.right, point),
            self.origin.1 - self.scale * dot(self.up, point),
            self.scale * dot(self.toward, point),
        ]
    }

    /// Where a point stands in the picture.
    pub(super) fn flat(&self, point: Point3) -> Point2 {
        let [x, y, _] = self.project(point);
        (x as f32, y as f32)
    }

    /// How bright ground is, by its normal: 1 if level.
    fn brightness(&self, normal: [f32; 3]) -> f32 {
        let [x, y, z] = normal;
        let [to_x, to_y, to_z] = self.light.map(|v| v as f32);
        let length = (x * x + y * y + z * z).sqrt();
        let lambert = (x * to_x + y * to_y + z * to_z).max(0.0) / (length * to_z);
        AMBIENT + (1.0 - AMBIENT) * lambert
    }
}

/// A colour under a light; 1 leaves it as it is.
fn shaded(colour: Rgb888, brightness: f32) -> [u8; 3] {
    let gloss = (GLOSS * (brightness - 1.0)).clamp(0.0, 1.0);
    [colour.r(), colour.g(), colour.b()].map(|channel| {
        let channel = f32::from(channel);
        let shaded = if brightness <= 1.0 {
            channel * brightness
        } else {
            channel + gloss * (255.0 - channel)
        };
        shaded.round() as u8
    })
}

/// The ground as a grid of patches, in the units of its axes.
#[derive(Debug)]
pub(super) struct Ground {
    /// Where the grid lines between the cells run: west to east, and north to south.
    pub(super) easts: Vec<f64>,
    /// See `easts`.
    pub(super) norths: Vec<f64>,
    /// Heights, row by row from the north; none where not known.
    pub(super) heights: Vec<Option<f64>>,
    /// Values for the colours; none where there is nothing to show.
    pub(super) values: Vec<Option<f32>>,
    /// Level of the floor, down to which the ground is cut off at its outer sides.
    pub(super) floor: f64,
}

/// How the ground takes its colours.
pub(super) enum Paint<'p> {
    /// Values blend into each other; the colour at a share of the way from the first number to the second.
    Blended(f64, f64, &'p (dyn Fn(f64) -> Rgb888 + Sync)),
    /// Every cell has the colour of its own value.
    Classes(&'p (dyn Fn(f32) -> Rgb888 + Sync)),
}

/// A straight line in space, as wide as on paper.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rod {
    pub(super) from: Point3,
    pub(super) to: Point3,
    /// Half its width, pixels.
    pub(super) half: f64,
    pub(super) colour: Rgb888,
}

/// A corner of a triangle: place in the picture and nearness, normal, value.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    at: [f64; 3],
    normal: [f32; 3],
    value: f32,
}

impl Ground {
    fn rows(&self) -> usize {
        self.norths.len() - 1
    }

    fn cols(&self) -> usize {
        self.easts.len() - 1
    }

    fn height(&self, row: usize, col: usize) -> Option<f64> {
        let inside = row < self.rows() && col < self.cols();
        if inside { self.heights[row * self.cols() + col] } else { None }
    }

    /// The middle of a cell, on its ground.
    pub(super) fn centre(&self, row: usize, col: usize) -> Option<Point3> {
        Some([
            f64::midpoint(self.easts[col], self.easts[col + 1]),
            f64::midpoint(self.norths[row], self.norths[row + 1]),
            self.height(row, col)?,
        ])
    }

    /// Rise toward the positive side of an axis, from the known neighbours on it: both, one, or none.
    fn rise(low: Option<Point3>, here: Point3, high: Option<Point3>, axis: usize) -> f64 {
        let (low, high) = (low.unwrap_or(here), high.unwrap_or(here));
        let run = high[axis] - low[axis];
        if run > 0.0 { (high[2] - low[2]) / run } else { 0.0 }
    }

    /// The normal of a cell.
    fn normal(&self, row: usize, col: usize) -> Option<[f32; 3]> {
        let here = self.centre(row, col)?;
        let beside = |row: Option<usize>, col: Option<usize>| {
            let (row, col) = (row?, col?);
            (row < self.rows() && col < self.cols()).then(|| self.centre(row, col)).flatten()
        };
        let west = beside(Some(row), col.checked_sub(1));
        let east = beside(Some(row), Some(col + 1));
        let north = beside(row.checked_sub(1), Some(col));
        let south = beside(Some(row + 1), Some(col));
        let slope = [Self::rise(west, here, east, 0), Self::rise(south, here, north, 1)];
        let length = (slope[0] * slope[0] + slope[1] * slope[1] + 1.0).sqrt();
        Some([-slope[0] / length, -slope[1] / length, 1.0 / length].map(|v| v as f32))
    }

    /// Everything that the triangles need, projected.
    fn vertices(&self, view: &View) -> Vertices {
        let (rows, cols) = (self.rows(), self.cols());
        let centres: Vec<Option<Vertex>> = (0..rows * cols)
            .into_par_iter()
            .map(|index| {
                let (row, col) = (index / cols, index % cols);
                Some(Vertex {
                    at: view.project(self.centre(row, col)?),
                    normal: self.normal(row, col)?,
                    value: self.values[index].unwrap_or(0.0),
                })
            })
            .collect();
        // A lattice of half cells: even lines run along the cells' sides, odd ones through their middles.
        let wide = 2 * cols + 1;
        let lattice = (0..(2 * rows + 1) * wide)
            .into_par_iter()
            .map(|index| {
                let (row, col) = (index / wide, index % wide);
                if row % 2 == 1 && col % 2 == 1 {
                    centres[row / 2 * cols + col / 2]
                } else {
                    self.joint(row, col, view, &centres)
                }
            })
            .collect();
        Vertices { wide, lattice }
    }

    /// A point of the lattice between cells: the mean of the known cells that meet in it.
    fn joint(
        &self,
        row: usize,
        col: usize,
        view: &View,
        centres: &[Option<Vertex>],
    ) -> Option<Vertex> {
        let (mut count, mut valued) = (0.0, 0.0_f32);
        let (mut height, mut value, mut normal) = (0.0, 0.0_f32, [0.0_f32; 3]);
        for row in meeting(row, self.rows()) {
            for col in meeting(col, self.cols()) {
                let index = row * self.cols() + col;
                let (Some(here), Some(vertex)) = (self.heights[index], &centres[index]) else {
                    continue;
                };
                count += 1.0;
                height += here;
                normal = std::array::from_fn(|axis| normal[axis] + vertex.normal[axis]);
                if let Some(found) = self.values[index] {
                    valued += 1.0;
                    value += found;
                }
            }
        }
        if count == 0.0 {
            return None;
        }
        let [east, north] = self.half_way(row, col);
        let at = view.project([east, north, height / count]);
        let value = if valued > 0.0 { value / valued } else { 0.0 };
        Some(Vertex { at, normal, value })
    }

    /// Where a point of the lattice lies.
    fn half_way(&self, row: usize, col: usize) -> [f64; 2] {
        let place = |lines: &[f64], at: usize| f64::midpoint(lines[at / 2], lines[at.div_ceil(2)]);
        [place(&self.easts, col), place(&self.norths, row)]
    }
}

/// The rows (or columns) of cells that meet in a line of the lattice.
fn meeting(line: usize, cells: usize) -> std::ops::Range<usize> {
    if line % 2 == 1 {
        return line / 2..line / 2 + 1;
    }
    (line / 2).saturating_sub(1)..(line / 2 + 1).min(cells)
}

#[derive(Debug)]
struct Vertices {
    /// Points in a row of the lattice.
    wide: usize,
    lattice: Vec<Option<Vertex>>,
}

impl Vertices {
    fn at(&self, row: usize, col: usize) -> Option<&Vertex> {
        self.lattice[row * self.wide + col].as_ref()
    }

    /// The eight triangles of a cell; none where it is not known.
    fn patch(&self, row: usize, col: usize) -> Option<[[&Vertex; 3]; 8]> {
        let (row, col) = (2 * row, 2 * col);
        let centre = self.at(row + 1, col + 1)?;
        let ring = [
            self.at(row, col)?,
            self.at(row, col + 1)?,
            self.at(row, col + 2)?,
            self.at(row + 1, col + 2)?,
            self.at(row + 2, col + 2)?,
            self.at(row + 2, col + 1)?,
            self.at(row + 2, col)?,
            self.at(row + 1, col)?,
        ];
        Some(std::array::from_fn(|i| [centre, ring[i], ring[(i + 1) % 8]]))
    }
}

/// A triangle with its colours.
struct Triangle<'v> {
    corners: [&'v Vertex; 3],
    fill: Fill,
}

#[derive(Clone, Copy)]
enum Fill {
    /// The colour of the interpolated value, under the light.
    Value,
    /// One colour, under the light.
    Plain(Rgb888),
    /// The cut through the ground, as bright as this.
    Cut(f32),
}

/// Ground drawn, ready to be laid over a canvas.
#[derive(Debug)]
pub(super) struct Rendering {
    width: usize,
    bands: Vec<Band>,
}

/// Some rows of a rendering, by pixel: how many samples are covered, the sum of their colours, and the nearness at
/// the pixel's middle.
#[derive(Debug)]
struct Band {
    covered: Vec<u16>,
    sum: Vec<[u16; 3]>,
    near: Vec<f64>,
}

/// Draws the ground and the rods in a picture of so many pixels.
pub(super) fn render(
    ground: &Ground,
    view: &View,
    paint: &Paint<'_>,
    rods: &[Rod],
    size: (usize, usize),
) -> Rendering {
    let (width, height) = size;
    let vertices = ground.vertices(view);
    let sides = ground.sides(view, &vertices);
    let bands = height.div_ceil(BAND);
    let lists = cells_by_band(&vertices, ground, bands);
    let table: Vec<Rgb888> = match paint {
        Paint::Blended(_, _, colour) => {
            (0..SHADES).map(|i| colour(i as f64 / (SHADES - 1) as f64)).collect()
        }
        Paint::Classes(_) => Vec::new(),
    };
    let shader = Shader { view, paint, table };
    let bands = lists
        .par_iter()
        .enumerate()
        .map(|(number, cells)| {
            let rows = BAND.min(height - number * BAND);
            let mut samples = Samples::empty(width, rows, number * BAND);
            for &cell in cells {
                let (row, col) = (cell / ground.cols(), cell % ground.cols());
                let fill = shader.fill(ground.values[cell]);
                for corners in vertices.patch(row, col).into_iter().flatten() {
                    samples.triangle(&Triangle { corners, fill }, &shader);
                }
            }
            for ([a, b, c, d], lit) in &sides {
                for corners in [[a, b, c], [a, c, d]] {
                    samples.triangle(&Triangle { corners, fill: Fill::Cut(*lit) }, &shader);
                }
            }
            for rod in rods {
                samples.rod(rod, view);
            }
            samples.resolved()
        })
        .collect();
    Rendering { width, bands }
}

impl Ground {
    /// The cut sides that face the viewer, half a cell each: corners in order, and their brightness.
    fn sides(&self, view: &View, vertices: &Vertices) -> Vec<([Vertex; 4], f32)> {
        let (south, east) = (2 * self.rows(), 2 * self.cols());
        let mut sides = Vec::new();
        let mut side = |ends: [(usize, usize); 2], outward: Point3| {
            let normal = outward.map(|v| v as f32);
            let top = ends.map(|(row, col)| vertices.at(row, col));
            // Both ends also belong to a neighbour: only a known middle says that there is ground between them.
            let middle = vertices.at(inner(ends, 0, south), inner(ends, 1, east));
            if let ([Some(&a), Some(&b)], Some(_)) = (top, middle) {
                let foot = ends.map(|(row, col)| {
                    let [east, north] = self.half_way(row, col);
                    Vertex { at: view.project([east, north, self.floor]), normal, value: 0.0 }
                });
                let lit = LEAST_OF_CUT + (1.0 - LEAST_OF_CUT) * view.brightness(normal).min(1.0);
                sides.push(([a, b, foot[1], foot[0]], lit));
            }
        };
        for (row, outward) in [(0, 1.0), (south, -1.0)] {
            if outward * view.toward[1] > 0.0 {
                (0..east).for_each(|col| side([(row, col), (row, col + 1)], [0.0, outward, 0.0]));
            }
        }
        for (col, outward) in [(0, -1.0), (east, 1.0)] {
            if outward * view.toward[0] > 0.0 {
                (0..south).for_each(|row| side([(row, col), (row + 1, col)], [outward, 0.0, 0.0]));
            }
        }
        sides
    }
}

/// The line of the lattice through the middle of the cell that a piece of the outer side belongs to.
fn inner(ends: [(usize, usize); 2], axis: usize, last: usize) -> usize {
    let [a, b] = ends.map(|(row, col)| [row, col][axis]);
    if a == b { a.clamp(1, last - 1) } else { a.min(b) / 2 * 2 + 1 }
}

/// The known cells that reach into each band.
fn cells_by_band(vertices: &Vertices, ground: &Ground, bands: usize) -> Vec<Vec<usize>> {
    let mut lists = vec![Vec::new(); bands];
    for cell in 0..ground.heights.len() {
        let (row, col) = (cell / ground.cols(), cell % ground.cols());
        let Some(triangles) = vertices.patch(row, col) else { continue };
        let ys = || triangles.iter().flatten().map(|vertex| vertex.at[1]);
        let (top, bottom) =
            (ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max));
        let band = |y: f64| (y.max(0.0) as usize / BAND).min(bands - 1);
        for list in &mut lists[band(top)..=band(bottom)] {
            list.push(cell);
        }
    }
    lists
}

/// What a sample of the ground looks like.
struct Shader<'s> {
    view: &'s View,
    paint: &'s Paint<'s>,
    table: Vec<Rgb888>,
}

impl Shader<'_> {
    /// How a cell is filled.
    fn fill(&self, value: Option<f32>) -> Fill {
        match (value, self.paint) {
            (None, _) => Fill::Plain(BARE),
            (Some(value), Paint::Classes(colour)) => Fill::Plain(colour(value)),
            (Some(_), Paint::Blended(..)) => Fill::Value,
        }
    }

    fn colour(&self, fill: Fill, value: f32) -> Rgb888 {
        match (fill, self.paint) {
            (Fill::Plain(colour), _) => colour,
            (Fill::Value, Paint::Blended(low, high, _)) => {
                let t = ((f64::from(value) - low) / (high - low)).clamp(0.0, 1.0);
                self.table[(t * (SHADES - 1) as f64).round() as usize]
            }
            (Fill::Cut(_), _) => CUT,
            (Fill::Value, Paint::Classes(_)) => BARE,
        }
    }

    fn sample(&self, triangle: &Triangle<'_>, weights: [f32; 3]) -> [u8; 3] {
        let [a, b, c] = triangle.corners;
        let mixed = |of: [f32; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        let normal =
            std::array::from_fn(|axis| mixed([a.normal[axis], b.normal[axis], c.normal[axis]]));
        let colour = self.colour(triangle.fill, mixed([a.value, b.value, c.value]));
        let brightness = match triangle.fill {
            Fill::Cut(lit) => lit,
            Fill::Value | Fill::Plain(_) => self.view.brightness(normal),
        };
        shaded(colour, brightness)
    }
}

/// The samples of a band.
struct Samples {
    width: usize,
    rows: usize,
    /// The first row of pixels.
    top: usize,
    near: Vec<f64>,
    colour: Vec<[u8; 3]>,
}

impl Samples {
    fn empty(width: usize, rows: usize, top: usize) -> Self {
        let count = width * rows * SAMPLES * SAMPLES;
        Self { width, rows, top, near: vec![f64::NEG_INFINITY; count], colour: vec![[0; 3]; count] }
    }

    /// Samples whose middles lie between two pixel coordinates, counted from `first`, at most `most`.
    fn between(low: f64, high: f64, first: usize, most: usize) -> std::ops::Range<usize> {
        let count = SAMPLES as f64;
        let at = |v: f64| ((v - first as f64) * count).clamp(-1.0, most as f64 + 1.0);
        let from = (at(low) - 0.5).ceil().max(0.0) as usize;
        let to = ((at(high) - 0.5).floor() + 1.0).max(0.0) as usize;
        from..to.min(most)
    }

    fn triangle(&mut self, triangle: &Triangle<'_>, shader: &Shader<'_>) {
        let [a, b, c] = triangle.corners.map(|vertex| vertex.at);
        let sides = [Side::between(b, c), Side::between(c, a), Side::between(a, b)];
        let area = sides[0].off(a[0], a[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let least = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let most = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        let across = Self::between(least(0), most(0), 0, self.width * SAMPLES);
        let step = 1.0 / SAMPLES as f64;
        for line in Self::between(least(1), most(1), self.top, self.rows * SAMPLES) {
            let y = self.top as f64 + (line as f64 + 0.5) * step;
            for col in across.clone() {
                let x = (col as f64 + 0.5) * step;
                // Of one sign on the inside; a sample on a side belongs to both its triangles, so that no gap opens.
                let off = sides.map(|side| side.off(x, y) / area);
                if off[0] < 0.0 || off[1] < 0.0 || off[2] < 0.0 {
                    continue;
                }
                let near = off[0] * a[2] + off[1] * b[2] + off[2] * c[2];
                let index = line * self.width * SAMPLES + col;
                if near > self.near[index] {
                    self.near[index] = near;
                    self.colour[index] = shader.sample(triangle, off.map(|weight| weight as f32));
                }
            }
        }
    }

    fn rod(&mut self, rod: &Rod, view: &View) {
        let (from, to) = (view.project(rod.from), view.project(rod.to));
        let along = [to[0] - from[0], to[1] - from[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let reach = |axis: usize| {
            (from[axis].min(to[axis]) - rod.half, from[axis].max(to[axis]) + rod.half)
        };
        let ((left, right), (top, bottom)) = (reach(0), reach(1));
        let step = 1.0 / SAMPLES as f64;
        let ends = ((from[0] as f32, from[1] as f32), (to[0] as f32, to[1] as f32));
        for line in Self::between(top, bottom, self.top, self.rows * SAMPLES) {
            let y = self.top as f64 + (line as f64 + 0.5) * step;
            for col in Self::between(left, right, 0, self.width * SAMPLES) {
                let x = (col as f64 + 0.5) * step;
                if f64::from(off_line(ends.0, ends.1, (x as f32, y as f32))) > rod.half {
                    continue;
                }
                let dot = (x - from[0]) * along[0] + (y - from[1]) * along[1];
                let t = if square > 0.0 { (dot / square).clamp(0.0, 1.0) } else { 0.0 };
                let near = from[2] + t * (to[2] - from[2]) + ROD_BIAS;
                let index = line * self.width * SAMPLES + col;
                if near > self.near[index] {
                    self.near[index] = near;
                    self.colour[index] = [rod.colour.r(), rod.colour.g(), rod.colour.b()];
                }
            }
        }
    }

    /// Samples gathered into pixels.
    fn resolved(&self) -> Band {
        let count = self.width * self.rows;
        let mut band =
            Band { covered: vec![0; count], sum: vec![[0; 3]; count], near: vec![0.0; count] };
        for pixel in 0..count {
            let (row, col) = (pixel / self.width, pixel % self.width);
            let index = |line: usize, at: usize| {
                (row * SAMPLES + line) * self.width * SAMPLES + col * SAMPLES + at
            };
            for (line, at) in (0..SAMPLES).flat_map(|line| (0..SAMPLES).map(move |at| (line, at))) {
                let index = index(line, at);
                if self.near[index] > f64::NEG_INFINITY {
                    band.covered[pixel] += 1;
                    for (sum, channel) in band.sum[pixel].iter_mut().zip(self.colour[index]) {
                        *sum += u16::from(channel);
                    }
                }
            }
            band.near[pixel] = self.near[index(SAMPLES / 2, SAMPLES / 2)];
        }
        band
    }
}

/// The line through a side of a triangle, the same to the last bit for both triangles that share it.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: [f64; 2],
    along: [f64; 2],
    sign: f64,
}

impl Side {
    fn between(a: [f64; 3], b: [f64; 3]) -> Self {
        let (a, b) = ([a[0], a[1]], [b[0], b[1]]);
        let (from, to, sign) = if a < b { (a, b, 1.0) } else { (b, a, -1.0) };
        Self { from, along: [to[0] - from[0], to[1] - from[1]], sign }
    }

    /// Twice the signed area of the triangle of the side and a point.
    fn off(&self, x: f64, y: f64) -> f64 {
        self.sign * ((x - self.from[0]) * self.along[1] - (y - self.from[1]) * self.along[0])
    }
}

impl Rendering {
    /// Lays the ground over a canvas of the same size.
    pub(super) fn lay(&self, canvas: &mut Canvas) {
        let all = (SAMPLES * SAMPLES) as u16;
        for (number, band) in self.bands.iter().enumerate() {
            for (pixel, (&covered, sum)) in band.covered.iter().zip(&band.sum).enumerate() {
                if covered == 0 {
                    continue;
                }
                let (x, y) = (pixel % self.width, number * BAND + pixel / self.width);
                let [r, g, b] = sum.map(|channel| ((channel + covered / 2) / covered) as u8);
                let share = f32::from(covered) / f32::from(all);
                canvas.blend(x as i32, y as i32, Rgb888::new(r, g, b), share);
            }
        }
    }

    /// Whether a projected point is in front of all that is drawn, or less than `slack` pixels behind.
    pub(super) fn shows(&self, at: Point3, slack: f64) -> bool {
        let (x, y) = (at[0].floor(), at[1].floor());
        if x < 0.0 || y < 0.0 || x >= self.width as f64 {
            return true;
        }
        let (x, y) = (x as usize, y as usize);
        let near =
            self.bands.get(y / BAND).and_then(|band| band.near.get((y % BAND) * self.width + x));
        near.is_none_or(|&near| at[2] + slack >= near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_darkest_ground_of_a_light_grey_is_lighter_than_the_brightest_of_a_dark_one() {
        let view = View::new(3.8, 0.6, (1.1, 0.8));
        let facing = view.light.map(|v| v as f32);
        let away = facing.map(|v| -v);
        let [dark, light] = [64, 236].map(|level| Rgb888::new(level, level, level));
        let (most, least) = (view.brightness(facing), view.brightness(away));
        assert!(most > 1.0 && least < 1.0);
        assert!(shaded(light, least)[0] > shaded(dark, most)[0] + 20);
    }

    #[test]
    fn level_ground_keeps_its_colour() {
        let view = View::new(1.0, 0.5, (1.1, 0.8));
        let colour = Rgb888::new(12, 130, 250);
        assert_eq!(shaded(colour, view.brightness([0.0, 0.0, 1.0])), [12, 130, 250]);
    }

    #[test]
    fn the_viewer_in_the_south_has_the_east_to_the_right_and_the_north_farther_away() {
        let view = View::new(std::f64::consts::PI, 0.5, (1.1, 0.8));
        let middle = view.project([0.0; 3]);
        let [east, north, up] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|p| view.project(p));
        assert!((east[0] - middle[0] - 1.0).abs() < 1e-12 && (east[1] - middle[1]).abs() < 1e-12);
        assert!(
            north[2] < middle[2] && north[1] < middle[1] && (north[0] - middle[0]).abs() < 1e-12
        );
        assert!(up[1] < middle[1] && up[2] > middle[2]);
    }

    /// Bumps from side to side, seen from above: every sample inside is covered, once and for all.
    #[test]
    fn the_surface_is_closed() {
        let (rows, cols) = (37, 23);
        let mut view = View::new(std::f64::consts::PI, std::f64::consts::FRAC_PI_2, (1.1, 0.8));
        view.scale = 7.3;
        view.origin = (3.0, 283.0);
        let ground = Ground {
            easts: (0..=cols).map(f64::from).collect(),
            norths: (0..=rows).rev().map(f64::from).collect(),
            heights: (0..rows * cols).map(|i| Some(f64::from(i * 7919 % 13))).collect(),
            values: vec![Some(1.0); 37 * 23],
            floor: 0.0,
        };
        let paint = Paint::Classes(&|_| Rgb888::new(200, 0, 0));
        let drawn = render(&ground, &view, &paint, &[], (190, 290));
        for y in 14..282 {
            for x in 4..170 {
                let covered = drawn.bands[y / BAND].covered[y % BAND * 190 + x];
                assert_eq!(usize::from(covered), SAMPLES * SAMPLES, "at {x}, {y}");
            }
        }
        let outside = drawn.bands[0].covered[..190].iter().all(|&covered| covered == 0);
        assert!(outside, "nothing is drawn above the ground");
    }
}
