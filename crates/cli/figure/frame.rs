//! The box around a surface: its walls behind, its numbered axes in front.

use embedded_graphics::pixelcolor::Rgb888;
use wisdom_grid::GridSpec;

use super::axis::{Axes, number, ticks};
use super::canvas::{Area, Canvas, Point2};
use super::colour::DARK;
use super::mesh::{Point3, View};
use super::text::{BODY, line_height, width};
use super::{GAP, TICK};

/// The most that the box takes, pixels.
const BOX: (f64, f64) = (900.0, 640.0);
/// The least height of the box, as a share of its longer side: level ground needs some, too.
const FLATTEST: f64 = 0.04;
/// The most steps between numbers on the upright axis.
const LEVELS_MOST: usize = 5;
/// An axis shorter than this has no numbers, pixels.
const AXIS_LEAST: f64 = 24.0;
/// How often a label is moved to find it a free place.
const PUSHES: i32 = 60;
/// A direction less than this off the picture's plane lies in it.
const EDGE_ON: f64 = 1e-9;
/// Space between numbers beside each other, pixels.
const APART: i32 = 8;

const WALL: Rgb888 = Rgb888::new(247, 248, 250);
pub(super) const FLOOR: Rgb888 = Rgb888::new(234, 236, 240);
const GRID_LINE: Rgb888 = Rgb888::new(208, 211, 218);
const WALL_EDGE: Rgb888 = Rgb888::new(150, 153, 162);

/// The box: how places and heights become points about its middle, and those points pixels.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) view: View,
    /// Half its length to the east, to the north and up.
    half: Point3,
    /// Heights of its floor and its top.
    pub(super) low: f64,
    pub(super) high: f64,
    spec: GridSpec,
    exaggeration: f64,
}

impl Frame {
    /// The box around ground on `spec` from a lowest to a highest height, as large as there is room for, its middle
    /// at the picture's origin.
    pub(super) fn new(
        spec: GridSpec,
        (low, high): (f64, f64),
        exaggeration: f64,
        view: View,
    ) -> Self {
        let [east, north] = [spec.cols(), spec.rows()].map(|cells| cells as f64 * spec.spacing_m());
        // Level ground stands in the middle of a low box, of a height that f64 can tell from nothing.
        let flattest = (FLATTEST * east.max(north) / exaggeration).max(low.abs() * 1e-6);
        let widened = ((flattest - (high - low)) / 2.0).max(0.0);
        let (low, high) = (low - widened, high + widened);
        let (step, _) = ticks(low, high, LEVELS_MOST, 0.0);
        let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
        let half = [east / 2.0, north / 2.0, (high - low) * exaggeration / 2.0];
        let mut frame = Self { view, half, low, high, spec, exaggeration };
        let (across, down) = frame.view.extent(half);
        frame.view.scale = (BOX.0 / across).min(BOX.1 / down);
        frame
    }

    /// Place of a grid line, counted from the west.
    pub(super) fn east(&self, cells: f64) -> f64 {
        cells * self.spec.spacing_m() - self.half[0]
    }

    /// Place of a grid line, counted from the south.
    pub(super) fn north(&self, cells: f64) -> f64 {
        cells * self.spec.spacing_m() - self.half[1]
    }

    /// Level of a height.
    pub(super) fn level(&self, height: f64) -> f64 {
        (height - f64::midpoint(self.low, self.high)) * self.exaggeration
    }

    /// The rectangle around the box in the picture.
    pub(super) fn extent(&self) -> Area {
        let (across, down) = self.view.extent(self.half);
        let [x, y] = [across, down].map(|long| (long / 2.0).ceil() as i32);
        Area { left: -x, top: -y, width: 2 * x, height: 2 * y }
    }

    /// The sides of the box that the viewer sees from within: axis that they stand across, and place on it.
    fn walls(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)]
            .into_iter()
            .filter(|&(axis, side)| side * self.view.toward[axis] < -EDGE_ON)
            .map(|(axis, side)| (axis, side * self.half[axis]))
    }

    /// Draws the walls behind the ground, its floor, and lines on them at the numbers of the axes.
    pub(super) fn draw_behind(&self, canvas: &mut Canvas, axes: &[Axis]) {
        let [east, north, up] = self.half;
        let flat = |point: Point3| self.view.flat(point);
        let line = |canvas: &mut Canvas, a: Point3, b: Point3, colour| {
            canvas.line(flat(a), flat(b), 0.5, colour);
        };
        let floor = [[-east, -north], [east, -north], [east, north], [-east, north]];
        canvas.polygon(&floor.map(|[x, y]| flat([x, y, -up])), FLOOR);
        // A quad of the wall across an axis at a place, its first two corners on the floor.
        let wall = |axis: usize, at: f64| {
            let long = self.half[1 - axis];
            [(-long, -up), (long, -up), (long, up), (-long, up)]
                .map(|(along, z)| if axis == 0 { [at, along, z] } else { [along, at, z] })
        };
        for (axis, at) in self.walls() {
            canvas.polygon(&wall(axis, at).map(flat), WALL);
        }
        for axis in axes {
            for tick in &axis.ticks {
                let at = tick.at[axis.along];
                match axis.along {
                    0 => line(canvas, [at, -north, -up], [at, north, -up], GRID_LINE),
                    1 => line(canvas, [-east, at, -up], [east, at, -up], GRID_LINE),
                    _ => {}
                }
                for (across, place) in self.walls().filter(|(across, _)| *across != axis.along) {
                    let [a, b, _, d] = wall(across, place);
                    let (from, to) = if axis.along == 2 {
                        ([a[0], a[1], at], [b[0], b[1], at])
                    } else {
                        let moved = |mut point: Point3| {
                            point[axis.along] = at;
                            point
                        };
                        (moved(a), moved(d))
                    };
                    line(canvas, from, to, GRID_LINE);
                }
            }
        }
        for (axis, at) in self.walls() {
            let [a, b, c, d] = wall(axis, at);
            for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
                line(canvas, from, to, WALL_EDGE);
            }
        }
    }

    /// The three axes, numbered as closely as there is room: to the east and to the north along the floor's sides
    /// nearest to the viewer, up along the corner farthest to the left.
    pub(super) fn axes(&self, axes: Axes, height_label: &str) -> Vec<Axis> {
        let [east, north, up] = self.half;
        let [x, y] = [0, 1].map(|axis| {
            let side = if self.view.toward[axis] > EDGE_ON { 1.0 } else { -1.0 };
            side * self.half[axis]
        });
        let corner = self.leftmost();
        let (east_label, north_label) = axes.labels(self.spec);
        let edges = [
            Edge::new(self, 0, [[-east, y, -up], [east, y, -up]], self.spec.cols() as f64),
            Edge::new(self, 1, [[x, -north, -up], [x, north, -up]], self.spec.rows() as f64),
            Edge::new(
                self,
                2,
                [[corner[0], corner[1], -up], [corner[0], corner[1], up]],
                self.high - self.low,
            ),
        ];
        let labels = [east_label, north_label, height_label];
        let mut placed: Vec<Axis> = Vec::new();
        for (edge, label) in edges.into_iter().zip(labels) {
            if edge.length < AXIS_LEAST {
                continue;
            }
            let ticks = match edge.along {
                0 => edge.counted(axes, self.spec, self.spec.cols()),
                1 => edge.counted(axes, self.spec, self.spec.rows()),
                _ => edge.levels(self.low, self.high),
            };
            let taken: Vec<Area> = placed.iter().flat_map(Axis::areas).collect();
            placed.push(edge.axis(label, ticks, &taken));
        }
        placed
    }

    /// The upright edge of the box farthest to the left in the picture; of two, the farther one.
    fn leftmost(&self) -> [f64; 2] {
        let [east, north, _] = self.half;
        let corners = [[-east, -north], [east, -north], [east, north], [-east, north]];
        let place = |&[x, y]: &[f64; 2]| {
            let [across, _, near] = self.view.project([x, y, 0.0]);
            // To a thousandth of a pixel: else rounding decides between two that are one above the other.
            ((across * 1e3).round(), near)
        };
        let by = |a: &[f64; 2], b: &[f64; 2]| {
            let (a, b) = (place(a), place(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        };
        corners.into_iter().min_by(by).expect("a box has four corners")
    }
}

/// An edge of the box that carries an axis.
#[derive(Debug)]
struct Edge {
    /// 0 to the east, 1 to the north, 2 up.
    along: usize,
    ends: [Point3; 2],
    /// Its ends in the picture.
    flat: [Point2; 2],
    /// Its length in the picture, pixels.
    length: f64,
    /// Steps of its numbers from end to end.
    steps: f64,
    /// Away from the box, in the picture.
    outward: Point2,
}

impl Edge {
    fn new(frame: &Frame, along: usize, ends: [Point3; 2], steps: f64) -> Self {
        let flat = ends.map(|end| frame.view.flat(end));
        let (x, y) = (flat[1].0 - flat[0].0, flat[1].1 - flat[0].1);
        let length = x.hypot(y);
        let across = if length > 0.0 { (y / length, -x / length) } else { (0.0, 0.0) };
        let middle = frame.view.flat([0.0; 3]);
        let off = (
            f32::midpoint(flat[0].0, flat[1].0) - middle.0,
            f32::midpoint(flat[0].1, flat[1].1) - middle.1,
        );
        let away = off.0 * across.0 + off.1 * across.1 >= 0.0;
        let outward = if away { across } else { (-across.0, -across.1) };
        Self { along, ends, flat, length: f64::from(length), steps, outward }
    }

    /// A number so many steps from the edge's first end.
    fn tick(&self, at: f64, text: String) -> SpaceTick {
        let t = at / self.steps;
        let [from, to] = self.ends;
        let point = std::array::from_fn(|axis| from[axis] + t * (to[axis] - from[axis]));
        let [from, to] = self.flat;
        let foot = (from.0 + t as f32 * (to.0 - from.0), from.1 + t as f32 * (to.1 - from.1));
        let area = self.beside(foot, TICK as f32 + 4.0, (width(BODY, &text), line_height(BODY)));
        SpaceTick { at: point, text, area }
    }

    /// How far a rectangle reaches along the outward direction.
    fn depth(&self, (across, down): (i32, i32)) -> f32 {
        self.outward.0.abs() * across as f32 + self.outward.1.abs() * down as f32
    }

    /// The rectangle of a size that begins `gap` outward of a point on the edge.
    fn beside(&self, foot: Point2, gap: f32, size: (i32, i32)) -> Area {
        let far = gap + self.depth(size) / 2.0;
        let left = foot.0 + self.outward.0 * far - size.0 as f32 / 2.0;
        let top = foot.1 + self.outward.1 * far - size.1 as f32 / 2.0;
        Area { left: left.round() as i32, top: top.round() as i32, width: size.0, height: size.1 }
    }

    fn counted(&self, axes: Axes, spec: GridSpec, cells: usize) -> Vec<SpaceTick> {
        axes.ticks(spec, cells, |at, text| self.tick(at, text), apart)
    }

    fn levels(&self, low: f64, high: f64) -> Vec<SpaceTick> {
        let numbered = |most| {
            let (step, levels) = ticks(low, high, most, 0.0);
            let text = |z| number(z, step, low.abs().max(high.abs()));
            levels.iter().map(|&z| self.tick(z - low, text(z))).collect::<Vec<_>>()
        };
        (1..=2 * LEVELS_MOST).rev().map(numbered).find(|ticks| apart(ticks)).unwrap_or_default()
    }

    /// The axis, its numbers and its label off what is taken.
    fn axis(self, label: &str, mut ticks: Vec<SpaceTick>, taken: &[Area]) -> Axis {
        for tick in &mut ticks {
            if taken.iter().any(|area| area.overlap(tick.area.grown(2)) > 0) {
                tick.text.clear();
            }
        }
        let numbers = ticks.iter().map(|tick| self.depth((tick.area.width, tick.area.height)));
        let gap = TICK as f32 + 4.0 + numbers.fold(0.0, f32::max) + GAP as f32;
        let upright = self.along == 2;
        let size = (width(BODY, label), line_height(BODY));
        let size = if upright { (size.1, size.0) } else { size };
        let middle = (
            f32::midpoint(self.flat[0].0, self.flat[1].0),
            f32::midpoint(self.flat[0].1, self.flat[1].1),
        );
        let free = |area: &Area| {
            let numbers = ticks.iter().filter(|tick| !tick.text.is_empty()).map(|tick| tick.area);
            taken.iter().copied().chain(numbers).all(|other| other.overlap(area.grown(3)) == 0)
        };
        // Farther out, and the upright one also up, where nothing but the walls is, until it stands free.
        let places = (0..PUSHES).map(|push| {
            let area = self.beside(middle, gap + 2.0 * push as f32, size);
            if upright { Area { top: area.top - 4 * push, ..area } } else { area }
        });
        let nearest = self.beside(middle, gap, size);
        let label_area = places.into_iter().find(free).unwrap_or(nearest);
        Axis {
            along: self.along,
            ends: self.ends,
            outward: self.outward,
            ticks,
            label: label.to_owned(),
            label_area,
        }
    }
}

/// A number on an axis: its point in space, its text and where that stands.
#[derive(Debug)]
struct SpaceTick {
    at: Point3,
    text: String,
    area: Area,
}

/// Whether numbers beside each other leave a gap.
fn apart(ticks: &[SpaceTick]) -> bool {
    ticks.windows(2).all(|pair| pair[0].area.grown(APART).overlap(pair[1].area) == 0)
}

/// An axis in its place.
#[derive(Debug)]
pub(super) struct Axis {
    along: usize,
    ends: [Point3; 2],
    outward: Point2,
    ticks: Vec<SpaceTick>,
    label: String,
    label_area: Area,
}

impl Axis {
    /// Where its texts stand.
    pub(super) fn areas(&self) -> impl Iterator<Item = Area> + '_ {
        let numbers = self.ticks.iter().filter(|tick| !tick.text.is_empty());
        numbers.map(|tick| tick.area).chain([self.label_area])
    }

    /// Moves its texts, as the view's origin was moved.
    pub(super) fn shift(&mut self, right: i32, down: i32) {
        let areas = self.ticks.iter_mut().map(|tick| &mut tick.area);
        for area in areas.chain([&mut self.label_area]) {
            area.left += right;
            area.top += down;
        }
    }

    pub(super) fn draw(&self, view: &View, canvas: &mut Canvas) {
        let [from, to] = self.ends.map(|end| view.flat(end));
        canvas.line(from, to, 0.7, DARK);
        for tick in &self.ticks {
            let foot = view.flat(tick.at);
            let long = TICK as f32;
            let tip = (foot.0 + long * self.outward.0, foot.1 + long * self.outward.1);
            canvas.line(foot, tip, 0.5, DARK);
            canvas.text(BODY, &tick.text, (tick.area.left, tick.area.top), DARK);
        }
        let area = self.label_area;
        if self.along == 2 {
            canvas.upright(BODY, &self.label, (area.left, area.bottom()), DARK);
        } else {
            canvas.text(BODY, &self.label, (area.left, area.top), DARK);
        }
    }
}
