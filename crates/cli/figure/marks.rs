//! Tracks, markers and their labels.

use wisdom_grid::Cell;

use super::canvas::{Area, Canvas, Point2, Stencil, off_line};
use super::colour::{DARK, Ink, WHITE};
use super::text::{LABEL, fit, latin, line_height, width};

/// Half the width of a track, pixels.
pub(super) const TRACK: f32 = 1.5;

/// Distance from a marker's centre to its outline, pixels.
pub(super) const MARKER: f32 = 8.0;

/// Width of the contrasting rim around tracks and markers, pixels.
pub(super) const HALO: f32 = 1.4;

/// Half the width of the line from a label to its marker, pixels.
const LEADER: f32 = 0.75;

/// What a label covers weighs its pixels. A line to its marker weighs as if it covered so many, ...
const LEADER_WEIGHT: i32 = 200;

/// ... and another marker under that line so many.
const CROSSED_WEIGHT: i32 = 400;

/// The longest label of a marker, characters.
pub(super) const LABEL_MOST: usize = 32;

/// Drawn and bare length of a dashed track, pixels.
pub(super) const DASH: (f32, f32) = (9.0, 9.0);

/// How a track is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Stroke {
    /// One line, as for what was driven.
    Solid,
    /// Dashes, as for what is planned.
    Dashed,
}

/// The shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Shape {
    /// A disc.
    Circle,
    /// Two crossed strokes.
    Cross,
    /// A triangle, point up.
    Triangle,
    /// A star of five points.
    Star,
    /// A square.
    Square,
    /// A square about the others, of which only the outline is drawn.
    Frame,
    /// A small square: another marker is still seen around it.
    Small,
}

/// A line over the map through the centres of cells.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    /// Name in the legend; none if empty.
    pub(crate) name: String,
    /// Cells in the order of travel; all on the map.
    pub(crate) cells: Vec<Cell>,
    /// Solid or dashed.
    pub(crate) stroke: Stroke,
    /// Colour.
    pub(crate) ink: Ink,
}

/// Markers of one kind.
#[derive(Debug, Clone)]
pub(crate) struct Markers {
    /// Name of the kind in the legend; none if empty.
    pub(crate) name: String,
    /// Shape.
    pub(crate) shape: Shape,
    /// Colour.
    pub(crate) ink: Ink,
    /// The cells marked, all on the map, each with a short label (none if empty).
    pub(crate) at: Vec<(Cell, String)>,
}

/// A label in its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub(super) text: String,
    pub(super) area: Area,
    /// The line to its marker, where another marker stands nearer.
    pub(super) leader: Option<(Point2, Point2)>,
}

impl Label {
    pub(super) fn draw(&self, canvas: &mut Canvas) {
        if let Some((from, to)) = self.leader {
            canvas.line(from, to, LEADER + 1.0, DARK);
            canvas.line(from, to, LEADER, WHITE);
        }
        canvas.haloed(&self.text, (self.area.left, self.area.top));
    }
}

impl Markers {
    /// The same markers, their text spelt in the signs that the fonts have.
    pub(super) fn spelt(self) -> Self {
        let at = self.at.into_iter().map(|(cell, label)| (cell, latin(&label))).collect();
        Self { name: latin(&self.name), at, ..self }
    }
}

/// Finds the label of each marker, given by its centre, a place beside it: inside `room`, off other labels and
/// markers, off the pixels that `drawn` counts where it can be. One that stands no nearer to its own marker than to
/// another gets a line to its own.
pub(super) fn place_labels(
    marked: &[(Point2, &str)],
    room: Area,
    drawn: impl Fn(Area) -> i32,
) -> Vec<Label> {
    let mut taken: Vec<Area> = marked.iter().map(|&(centre, _)| around(centre)).collect();
    let mut labels = Vec::new();
    for &(centre, text) in marked.iter().filter(|(_, text)| !text.is_empty()) {
        let text = fit(text, LABEL_MOST);
        let size = (width(LABEL, &text), line_height(LABEL));
        let others = || marked.iter().map(|(other, _)| *other).filter(|other| *other != centre);
        let (area, leader) = candidates(centre, size)
            .into_iter()
            .map(|area| area.pushed_into(room))
            .map(|area| (area, leader(area, centre, others())))
            .min_by_key(|(area, leader)| {
                let covered: i32 = taken.iter().map(|other| area.overlap(*other)).sum();
                let line = leader.map_or(0, |(from, to)| {
                    let under = |other: &Point2| off_line(from, to, *other) < MARKER;
                    let crossed = others().filter(under).count() as i32;
                    LEADER_WEIGHT + CROSSED_WEIGHT * crossed
                });
                4 * covered + drawn(*area) + line
            })
            .expect("there is always a candidate");
        taken.push(area.grown(2));
        labels.push(Label { text, area, leader });
    }
    labels
}

/// The line from a label to its marker, if the label stands far from it or no nearer to it than to another.
fn leader(
    area: Area,
    own: Point2,
    mut others: impl Iterator<Item = Point2>,
) -> Option<(Point2, Point2)> {
    let (foot, far) = (nearest(area, own), off_area(area, own));
    let lone = far < 2.5 * MARKER && others.all(|other| off_area(area, other) > 1.25 * far);
    if lone || far <= MARKER {
        return None;
    }
    // From the marker's rim: its own shape stays as it is.
    let t = MARKER / far;
    Some(((own.0 + t * (foot.0 - own.0), own.1 + t * (foot.1 - own.1)), foot))
}

/// The point of an area nearest to another.
fn nearest(area: Area, point: Point2) -> Point2 {
    let within = |at: f32, low: i32, high: i32| at.max(low as f32).min(high as f32);
    (within(point.0, area.left, area.right()), within(point.1, area.top, area.bottom()))
}

/// Distance of a point from an area.
pub(super) fn off_area(area: Area, point: Point2) -> f32 {
    let foot = nearest(area, point);
    (foot.0 - point.0).hypot(foot.1 - point.1)
}

/// A marker's surroundings.
pub(super) fn around(centre: (f32, f32)) -> Area {
    let reach = (MARKER + HALO).ceil();
    let side = 2 * reach as i32 + 1;
    Area {
        left: (centre.0 - reach) as i32,
        top: (centre.1 - reach) as i32,
        width: side,
        height: side,
    }
}

/// Places for a label of `size` about a marker, best first, in four rings.
pub(super) fn candidates(centre: (f32, f32), size: (i32, i32)) -> Vec<Area> {
    let (x, y) = (centre.0 as i32, centre.1 as i32);
    let ring = |gap: i32| {
        let (east, west, middle) = (x + gap, x - gap - size.0, x - size.0 / 2);
        let (north, south, level) = (y - gap - size.1, y + gap, y - size.1 / 2);
        let near = gap * 2 / 3;
        [
            (east, level),
            (west, level),
            (middle, north),
            (middle, south),
            (x + near, y - near - size.1),
            (x + near, y + near),
            (x - near - size.0, y - near - size.1),
            (x - near - size.0, y + near),
        ]
    };
    let reach = (MARKER + HALO) as i32 + 6;
    ring(reach)
        .into_iter()
        .chain(ring(2 * reach))
        .chain(ring(3 * reach))
        .chain(ring(5 * reach))
        .map(|(left, top)| Area { left, top, width: size.0, height: size.1 })
        .collect()
}

/// The pieces of a line that are drawn.
pub(crate) fn pieces(points: &[Point2], style: Stroke) -> Vec<(Point2, Point2)> {
    if let [only] = points {
        return vec![(*only, *only)];
    }
    let whole = points.windows(2).map(|pair| (pair[0], pair[1]));
    if style == Stroke::Solid {
        return whole.collect();
    }
    let (on, period) = (DASH.0, DASH.0 + DASH.1);
    let (mut drawn, mut phase) = (Vec::new(), 0.0);
    for (from, to) in whole {
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let at = |s: f32| {
            let t = if length > 0.0 { s / length } else { 0.0 };
            (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1))
        };
        let mut start = -phase;
        while start < length {
            if start + on > 0.0 {
                drawn.push((at(start.max(0.0)), at((start + on).min(length))));
            }
            start += period;
        }
        phase = (phase + length) % period;
    }
    drawn
}

/// Draws the pieces of a line, with a rim, inside `area`.
pub(super) fn stroke(canvas: &mut Canvas, area: Area, pieces: &[(Point2, Point2)], ink: Ink) {
    for (half, colour) in [(TRACK + HALO, ink.rim()), (TRACK, ink.rgb())] {
        let mut stencil = Stencil::empty(area);
        for &(from, to) in pieces {
            stencil.line(from, to, half);
        }
        canvas.ink(&stencil, colour);
    }
}

/// Signed distance of a point from a marker about the origin, negative inside.
pub(super) fn off_shape(shape: Shape, point: Point2) -> f32 {
    match shape {
        Shape::Circle => point.0.hypot(point.1) - 0.85 * MARKER,
        Shape::Square => point.0.abs().max(point.1.abs()) - 0.75 * MARKER,
        Shape::Frame => (point.0.abs().max(point.1.abs()) - 1.3 * MARKER).abs() - 0.15 * MARKER,
        Shape::Small => point.0.abs().max(point.1.abs()) - 0.5 * MARKER,
        Shape::Cross => {
            let arm = 0.7 * MARKER;
            let stroke = off_line((-arm, -arm), (arm, arm), point);
            stroke.min(off_line((-arm, arm), (arm, -arm), point)) - 0.25 * MARKER
        }
        Shape::Triangle => {
            off_polygon(&corners(3, 1.1 * MARKER, 1.1 * MARKER), (point.0, point.1 - 1.0))
        }
        Shape::Star => off_polygon(&corners(10, 1.15 * MARKER, 0.5 * MARKER), point),
    }
}

/// Corners of a polygon, the first at the top, alternately `far` and `near` the origin.
pub(super) fn corners(n: usize, far: f32, near: f32) -> Vec<Point2> {
    (0..n)
        .map(|i| {
            let (angle, radius) =
                (std::f32::consts::TAU * i as f32 / n as f32, if i % 2 == 0 { far } else { near });
            (radius * angle.sin(), -radius * angle.cos())
        })
        .collect()
}

/// Signed distance of a point from a polygon, negative inside.
pub(super) fn off_polygon(corners: &[Point2], point: Point2) -> f32 {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let (mut distance, mut inside) = (f32::INFINITY, false);
    for (&a, &b) in sides {
        distance = distance.min(off_line(a, b, point));
        if (a.1 > point.1) != (b.1 > point.1)
            && point.0 < a.0 + (point.1 - a.1) / (b.1 - a.1) * (b.0 - a.0)
        {
            inside = !inside;
        }
    }
    if inside { -distance } else { distance }
}
