//! Surfaces as pictures: the heights of a raster as ground seen from the side, in the colours of another raster, with
//! axes around it and markers on it or on masts.
//!
//! The projection is orthographic: parallel lines stay parallel, and lengths along an axis can be compared. Light falls
//! from the viewer's left. Unknown cells are holes; large rasters show every n-th cell, and the figure says so.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use anyhow::{Context, ensure};
use embedded_graphics::pixelcolor::Rgb888;
use wisdom_grid::{Cell, Raster};

use super::axis::Axes;
use super::canvas::{Area, Canvas, Point2};
use super::colour::{ColourMap, DARK, Span};
use super::frame::{Axis, FLOOR, Frame};
use super::key::{ColourKey, Palette};
use super::legend::{Entry, Key, SWATCH, legend};
use super::marks::{MARKER, Markers, place_labels};
use super::mesh::{BARE, Ground, Paint, Point3, Rendering, Rod, View, render};
use super::text::{BODY, TITLE, advance, latin, line_height, wrap};
use super::{GAP, MARGIN};

/// More cells a side than these are not drawn: a cell would be less than a pixel.
const CELLS_MOST: usize = 700;
/// The viewer's usual place: to the south-west, as plotting programs have it.
const AZIMUTH_RAD: f64 = 217.5 / 360.0 * TAU;
const ALTITUDE_RAD: f64 = 36.0 / 360.0 * TAU;
/// The light: this far to the viewer's left, and this high.
const LIGHT: (f64, f64) = (65.0 / 360.0 * TAU, 45.0 / 360.0 * TAU);
/// Half the width of a mast, pixels.
const MAST: f64 = 1.1;
/// How far behind the surface a marker may seem to be and still stand on it, pixels.
const ON_GROUND: f64 = 4.0;
/// How much of a marker shows that stands behind a rise.
const FAINT: f32 = 0.35;
/// The most that a colour bar is long, pixels.
const BAR_MOST: i32 = 420;
/// The least width of a figure and the least height of its box, pixels: room for title and bar.
const LEAST: (i32, i32) = (640, 220);

const QUIET: Rgb888 = Rgb888::new(96, 98, 106);

/// What a marker stands on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Mast {
    /// A mast so long, in the unit of the heights; on the ground itself if 0.
    Long(f64),
    /// A mast that reaches up to a height, so that markers stand level; on the ground where that is higher.
    UpTo(f64),
}

impl Mast {
    /// The height of its head over ground of a height.
    fn head(self, ground: f64) -> f64 {
        match self {
            Self::Long(above) => ground + above,
            Self::UpTo(height) => ground.max(height),
        }
    }
}

/// A surface over one raster of heights, coloured by another, to be saved as a picture.
///
/// Text is spelt as in [`Figure`](super::Figure).
#[derive(Debug, Clone)]
pub(crate) struct Surface<'a> {
    title: String,
    heights: &'a Raster<f32>,
    values: &'a Raster<f32>,
    palette: Palette,
    axes: Axes,
    height_label: String,
    known: Option<&'a Raster<bool>>,
    exaggeration: f64,
    azimuth_rad: f64,
    altitude_rad: f64,
    markers: Vec<(Markers, Mast)>,
}

#[allow(dead_code, reason = "a set of choices; no command needs every one")]
impl<'a> Surface<'a> {
    /// A surface of `heights` (metres, as the cells' spacing) in the colours of `map` for `values`, with metric axes,
    /// to scale, seen from the south-west.
    pub(crate) fn new(
        title: &str,
        heights: &'a Raster<f32>,
        values: &'a Raster<f32>,
        map: ColourMap,
    ) -> Self {
        Self {
            title: title.lines().map(latin).collect::<Vec<_>>().join("\n"),
            heights,
            values,
            palette: Palette::new(map),
            axes: Axes::Metres,
            height_label: "z (m)".to_owned(),
            known: None,
            exaggeration: 1.0,
            azimuth_rad: AZIMUTH_RAD,
            altitude_rad: ALTITUDE_RAD,
            markers: Vec::new(),
        }
    }

    /// Says beside the colours what they show, with its unit.
    pub(crate) fn value_label(mut self, label: &str) -> Self {
        self.palette.label = latin(label);
        self
    }

    /// Says beside the upright axis what the heights are, with their unit.
    pub(crate) fn height_label(mut self, label: &str) -> Self {
        self.height_label = latin(label);
        self
    }

    /// Names the classes of [`ColourMap::Classes`] or [`ColourMap::Shades`] in order; a class without a name goes by
    /// its number, one with an empty name is left out of the legend.
    pub(crate) fn class_names(mut self, names: &[&str]) -> Self {
        self.palette.name_classes(names);
        self
    }

    /// Fixes the values at the ends of the colour bar; values beyond take the end's colour, and the bar says so by a
    /// tip.
    pub(crate) fn range(mut self, low: f64, high: f64) -> Self {
        self.palette.range = Some((low, high));
        self
    }

    /// Chooses how the level axes count.
    pub(crate) fn axes(mut self, axes: Axes) -> Self {
        self.axes = axes;
        self
    }

    /// Leaves out the cells of a mask of the same shape that are `false`: they become holes.
    pub(crate) fn known(mut self, known: &'a Raster<bool>) -> Self {
        self.known = Some(known);
        self
    }

    /// Draws heights so many times as high as they are; the figure says so.
    pub(crate) fn exaggeration(mut self, times: f64) -> Self {
        self.exaggeration = times;
        self
    }

    /// Looks from an azimuth (clockwise from north) and an altitude above the horizon, radians.
    pub(crate) fn view(mut self, azimuth_rad: f64, altitude_rad: f64) -> Self {
        (self.azimuth_rad, self.altitude_rad) = (azimuth_rad, altitude_rad);
        self
    }

    /// Puts markers on the ground; those behind a rise are faint.
    pub(crate) fn markers(self, markers: Markers) -> Self {
        self.masts(markers, Mast::Long(0.0))
    }

    /// Puts markers on masts.
    pub(crate) fn masts(mut self, markers: Markers, mast: Mast) -> Self {
        self.markers.push((markers.spelt(), mast));
        self
    }

    /// Writes the surface as an RGB PNG.
    ///
    /// # Errors
    /// If the file cannot be written, a raster has another shape than the heights, no height is known, a marker lies
    /// off the map, or a range, exaggeration or view is none; each error names the file.
    pub(crate) fn save(&self, path: &Path) -> anyhow::Result<()> {
        let (canvas, _) = self.draw().with_context(|| format!("figure {}", path.display()))?;
        canvas.write(path).with_context(|| format!("cannot write figure {}", path.display()))
    }

    /// The finished picture, and where its parts are.
    fn draw(&self) -> anyhow::Result<(Canvas, Layout)> {
        self.check()?;
        let sampled = Sampled::of(self.heights.spec().rows().max(self.heights.spec().cols()));
        let view = View::new(self.azimuth_rad, self.altitude_rad, LIGHT);
        let frame = Frame::new(self.heights.spec(), self.ends()?, self.exaggeration, view);
        let ground = self.ground(&frame, sampled);
        let span = self.span();
        let layout = self.layout(frame, sampled, span);

        let mut canvas = Canvas::blank(layout.width, layout.height);
        for (i, line) in (0..).zip(&layout.title) {
            canvas.text(TITLE, line, (MARGIN, MARGIN + i * line_height(TITLE)), DARK);
        }
        for (i, line) in (0..).zip(&layout.note) {
            canvas.text(BODY, line, (MARGIN, layout.note_top + i * line_height(BODY)), QUIET);
        }
        layout.frame.draw_behind(&mut canvas, &layout.axes);
        let rendering = self.render(&ground, &layout, span);
        rendering.lay(&mut canvas);
        for axis in &layout.axes {
            axis.draw(&layout.frame.view, &mut canvas);
        }
        layout.key.draw(&self.palette, &mut canvas);
        self.draw_markers(&mut canvas, &layout, &rendering);
        for entry in &layout.legend {
            entry.draw(&mut canvas);
        }
        Ok((canvas, layout))
    }

    /// Refuses what cannot be drawn honestly.
    fn check(&self) -> anyhow::Result<()> {
        let spec = self.heights.spec();
        let shapes = [
            ("values have", Some(self.values.spec())),
            ("mask of known cells has", self.known.map(Raster::spec)),
        ];
        for (what, shape) in shapes {
            if let Some(other) = shape {
                ensure!(
                    (other.rows(), other.cols()) == (spec.rows(), spec.cols()),
                    "the {what} {} x {} cells, the heights {} x {}",
                    other.rows(),
                    other.cols(),
                    spec.rows(),
                    spec.cols()
                );
            }
        }
        for (kind, mast) in &self.markers {
            let fits = match *mast {
                Mast::Long(above) => above.is_finite() && above >= 0.0,
                Mast::UpTo(height) => height.is_finite(),
            };
            ensure!(
                fits,
                "`{}` stands on a mast that is {mast:?}; a length from 0 on is wanted",
                kind.name
            );
            for &(cell, _) in &kind.at {
                ensure!(
                    spec.contains(cell),
                    "`{}` at {cell} lies off the map of {} x {} cells",
                    kind.name,
                    spec.rows(),
                    spec.cols()
                );
            }
        }
        ensure!(
            self.exaggeration > 0.0 && self.exaggeration.is_finite(),
            "heights drawn {} times as high; a number above 0 is wanted",
            self.exaggeration
        );
        ensure!(
            self.azimuth_rad.is_finite()
                && self.altitude_rad > 0.0
                && self.altitude_rad <= FRAC_PI_2,
            "the view is from azimuth {} and altitude {} degrees; an altitude above 0 and up to 90 is wanted",
            self.azimuth_rad.to_degrees(),
            self.altitude_rad.to_degrees()
        );
        self.palette.check()
    }

    /// The height of a cell, if it is known.
    fn height(&self, cell: Cell) -> Option<f64> {
        let height = self.heights[cell];
        let known = self.known.is_none_or(|known| known[cell]) && height.is_finite();
        known.then_some(f64::from(height))
    }

    /// The value of a cell, if it has one and there is ground to show it on.
    fn value(&self, cell: Cell) -> Option<f32> {
        let value = self.values[cell];
        (self.height(cell).is_some() && self.palette.shows(value)).then_some(value)
    }

    fn span(&self) -> Span {
        let shown = self.values.spec().cells().filter_map(|cell| self.value(cell));
        self.palette.span(shown.map(f64::from))
    }

    /// The lowest and the highest point of ground and masts.
    fn ends(&self) -> anyhow::Result<(f64, f64)> {
        let spec = self.heights.spec();
        let known = spec.cells().filter_map(|cell| self.height(cell));
        let (low, high) =
            known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
        ensure!(low <= high, "no height is known, so that there is no surface to draw");
        let heads = self.markers.iter().flat_map(|(kind, mast)| {
            kind.at.iter().map(move |&(cell, _)| mast.head(self.height(cell).unwrap_or(low)))
        });
        Ok((low, heads.fold(high, f64::max)))
    }

    /// The ground as patches, each n-th cell.
    fn ground(&self, frame: &Frame, sampled: Sampled) -> Ground {
        let spec = self.heights.spec();
        let (rows, cols) = (sampled.count(spec.rows()), sampled.count(spec.cols()));
        let cells = || {
            (0..rows).flat_map(move |row| {
                (0..cols).map(move |col| {
                    let first = spec.first();
                    Cell::new(
                        first.row + sampled.index(row, spec.rows()),
                        first.col + sampled.index(col, spec.cols()),
                    )
                })
            })
        };
        let lines = |count: usize, most: usize| {
            (0..=count).map(move |i| (i * sampled.every).min(most) as f64)
        };
        Ground {
            easts: lines(cols, spec.cols()).map(|at| frame.east(at)).collect(),
            norths: lines(rows, spec.rows())
                .map(|at| frame.north(spec.rows() as f64 - at))
                .collect(),
            heights: cells().map(|cell| self.height(cell).map(|z| frame.level(z))).collect(),
            values: cells().map(|cell| self.value(cell)).collect(),
            floor: frame.level(frame.low),
        }
    }

    fn render(&self, ground: &Ground, layout: &Layout, span: Span) -> Rendering {
        let map = self.palette.map;
        let of_share = |t: f64| map.colour(0.0, t);
        let of_class = |value: f32| map.colour(f64::from(value), 0.0);
        let paint = match map.classes() {
            Some(_) => Paint::Classes(&of_class),
            None => Paint::Blended(span.low, span.high, &of_share),
        };
        let rods: Vec<Rod> = self
            .markers
            .iter()
            .flat_map(|(kind, mast)| kind.at.iter().map(move |&(cell, _)| (cell, *mast)))
            .map(|(cell, mast)| self.stand(&layout.frame, cell, mast))
            .filter(|[foot, head]| head[2] > foot[2])
            .map(|[from, to]| Rod { from, to, half: MAST, colour: DARK })
            .collect();
        let size = (layout.width as usize, layout.height as usize);
        render(ground, &layout.frame.view, &paint, &rods, size)
    }

    /// The foot and the head of a mast on a cell; where the ground is not known, it stands on the floor.
    fn stand(&self, frame: &Frame, cell: Cell, mast: Mast) -> [Point3; 2] {
        let (rows, first) = (self.heights.spec().rows(), self.heights.spec().first());
        let (row, col) = (cell.row - first.row, cell.col - first.col);
        let ground = self.height(cell).unwrap_or(frame.low);
        let (east, north) = (frame.east(col as f64 + 0.5), frame.north((rows - row) as f64 - 0.5));
        [ground, mast.head(ground)].map(|height| [east, north, frame.level(height)])
    }

    fn draw_markers(&self, canvas: &mut Canvas, layout: &Layout, rendering: &Rendering) {
        let mut marked: Vec<(Point2, &str)> = Vec::new();
        for (kind, mast) in &self.markers {
            for (cell, label) in &kind.at {
                let at = layout.frame.view.project(self.stand(&layout.frame, *cell, *mast)[1]);
                let centre = (at[0] as f32, at[1] as f32);
                let share = if rendering.shows(at, ON_GROUND) { 1.0 } else { FAINT };
                canvas.marker_through(kind.shape, centre, kind.ink, share);
                marked.push((centre, label));
            }
        }
        for label in place_labels(&marked, layout.plot, |_| 0) {
            label.draw(canvas);
        }
    }

    /// What the legend below names.
    fn legend_keys(&self) -> Vec<(Key, String)> {
        let kinds = self.markers.iter().map(|(m, _)| (Key::Marker(m.shape, m.ink), m.name.clone()));
        let cells = || self.heights.spec().cells();
        let bare = cells().any(|cell| self.height(cell).is_some() && self.value(cell).is_none());
        let bare = bare.then(|| (Key::Fill(BARE), "no value".to_owned()));
        let hole = cells().any(|cell| self.height(cell).is_none());
        let hole = hole.then(|| (Key::Fill(FLOOR), "hole: not known".to_owned()));
        kinds.filter(|(_, name)| !name.is_empty()).chain(bare).chain(hole).collect()
    }

    /// From where and how the surface is shown.
    fn note(&self, sampled: Sampled) -> String {
        let compass = [
            "north",
            "north-east",
            "east",
            "south-east",
            "south",
            "south-west",
            "west",
            "north-west",
        ];
        let eighth = (self.azimuth_rad / (TAU / 8.0)).round().rem_euclid(8.0) as usize % 8;
        let altitude = self.altitude_rad.to_degrees().round();
        let from = if altitude >= 90.0 {
            "seen from above".to_owned()
        } else {
            format!("seen from the {}, {altitude}° above the horizon", compass[eighth])
        };
        let scale = if self.exaggeration == 1.0 {
            "heights to scale".to_owned()
        } else {
            format!("heights drawn {} times as high", self.exaggeration)
        };
        let note = format!("{from}; {scale}");
        if sampled.every > 1 {
            return format!("{note}; one cell in {} a side is drawn", sampled.every);
        }
        note
    }

    /// Puts every part in its place.
    fn layout(&self, mut frame: Frame, sampled: Sampled, span: Span) -> Layout {
        // Around the origin first: the extent of the numbers decides where the box goes.
        let mut axes = frame.axes(self.axes, &self.height_label);
        let mut plot = frame.extent();
        for area in axes.iter().flat_map(Axis::areas) {
            plot = plot.with(area);
        }
        plot = plot.grown(MARKER as i32 / 2);

        let body_height = plot.height.max(LEAST.1).max(self.palette.least_height());
        let key =
            self.palette.key(span, body_height.min(BAR_MOST.max(self.palette.least_height())));
        let width = (MARGIN + plot.width + 3 * GAP + key.body.width + MARGIN).max(LEAST.0);
        let line = |font| ((width - 2 * MARGIN) / advance(font)) as usize;
        let title = wrap(&self.title, line(TITLE));
        let note = wrap(&latin(&self.note(sampled)), line(BODY));
        let note_top = MARGIN + title.len() as i32 * line_height(TITLE) + 4;
        let body_top = note_top + note.len() as i32 * line_height(BODY) + GAP;

        let (right, down) =
            (MARGIN - plot.left, body_top + (body_height - plot.height) / 2 - plot.top);
        frame.view.origin = (f64::from(right), f64::from(down));
        for axis in &mut axes {
            axis.shift(right, down);
        }
        let plot = Area { left: plot.left + right, top: plot.top + down, ..plot };
        let key_left = width - MARGIN - key.body.width;
        let key_top = body_top + (body_height - key.body.height) / 2;
        let legend_top = body_top + body_height + GAP + 4;
        let legend = legend(self.legend_keys(), MARGIN, legend_top, width);
        let bottom = legend.last().map_or(legend_top - GAP - 4, |entry| entry.top + SWATCH.1);
        Layout {
            width,
            height: bottom + MARGIN,
            key: key.at(key_left, key_top),
            title,
            note,
            note_top,
            frame,
            plot,
            axes,
            legend,
        }
    }
}

/// Every how many cells one is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sampled {
    every: usize,
}

impl Sampled {
    /// For a raster whose longer side has `cells` cells.
    fn of(cells: usize) -> Self {
        Self { every: cells.div_ceil(CELLS_MOST) }
    }

    /// Cells drawn of so many.
    fn count(self, cells: usize) -> usize {
        cells.div_ceil(self.every)
    }

    /// The cell that is drawn for the `nth` step, in its middle.
    fn index(self, nth: usize, cells: usize) -> usize {
        (nth * self.every + self.every / 2).min(cells - 1)
    }
}

/// Where everything goes, pixels.
#[derive(Debug)]
struct Layout {
    width: i32,
    height: i32,
    title: Vec<String>,
    note: Vec<String>,
    note_top: i32,
    frame: Frame,
    /// The box with the numbers around it.
    plot: Area,
    axes: Vec<Axis>,
    key: ColourKey,
    legend: Vec<Entry>,
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_6, PI};

    use embedded_graphics::pixelcolor::RgbColor;
    use wisdom_grid::GridSpec;

    use super::super::marks::Shape;
    use super::super::{Ink, frame};
    use super::*;

    fn raster(rows: usize, cols: usize, of: impl Fn(Cell) -> f32) -> Raster<f32> {
        Raster::from_fn(GridSpec::new(rows, cols, 1.0).unwrap(), of)
    }

    fn level(rows: usize, cols: usize) -> Raster<f32> {
        raster(rows, cols, |_| 2.0)
    }

    fn bumps(rows: usize, cols: usize) -> Raster<f32> {
        raster(rows, cols, |c| 4.0 * (c.row as f32 / 5.0).sin() * (c.col as f32 / 4.0).cos())
    }

    fn star(cell: Cell) -> Markers {
        let at = vec![(cell, String::new())];
        Markers { name: "goal".to_owned(), shape: Shape::Star, ink: Ink::Vermilion, at }
    }

    /// The pixel that shows a height above the middle of a cell, if nothing is in front of it.
    fn pixel(surface: &Surface<'_>, cell: Cell, height: f64) -> Rgb888 {
        let (canvas, layout) = surface.draw().unwrap();
        let frame = &layout.frame;
        let rows = surface.heights.spec().rows();
        let (east, north) = (cell.col as f64 + 0.5, (rows - cell.row) as f64 - 0.5);
        let at = [frame.east(east), frame.north(north), frame.level(height)];
        let [x, y, _] = frame.view.project(at);
        canvas.pixels[canvas.index(x as i32, y as i32).unwrap()]
    }

    #[test]
    fn a_rock_in_front_hides_the_ground_behind_it() {
        let wall = |cell: Cell| cell.row == 20;
        let classes = raster(41, 41, |cell| f32::from(u8::from(wall(cell))));
        let heights = raster(41, 41, |cell| if wall(cell) { 12.0 } else { 0.0 });
        let flat = classes.map(|_| 0.0);
        let seen = |heights: &Raster<f32>, azimuth_rad, row| {
            let surface = Surface::new("", heights, &classes, ColourMap::Classes(2))
                .view(azimuth_rad, FRAC_PI_6);
            pixel(&surface, Cell::new(row, 20), 0.0)
        };
        // Class 0 is blue, class 1 orange, under any light.
        let orange = |colour: Rgb888| colour.r() > colour.b();
        assert!(orange(seen(&heights, PI, 6)) && !orange(seen(&heights, PI, 34)));
        assert!(!orange(seen(&heights, 0.0, 6)) && orange(seen(&heights, 0.0, 34)));
        assert!(!orange(seen(&flat, PI, 6)));
    }

    #[test]
    fn hidden_ground_is_darker_than_ground_in_sight() {
        let heights = bumps(60, 60);
        let sight = raster(60, 60, |cell| f32::from(u8::from((cell.row + cell.col) % 7 > 2)));
        let surface = Surface::new("", &heights, &sight, ColourMap::Shades(2)).view(PI, FRAC_PI_2);
        let (canvas, layout) = surface.draw().unwrap();
        let (mut dark, mut light) = (0, 255);
        for cell in heights.spec().cells() {
            let at = surface.stand(&layout.frame, cell, Mast::Long(0.0))[0];
            let [x, y, _] = layout.frame.view.project(at);
            let level = canvas.pixels[canvas.index(x as i32, y as i32).unwrap()].r();
            if sight[cell] > 0.5 { light = light.min(level) } else { dark = dark.max(level) }
        }
        assert!(dark + 20 < light, "hidden up to {dark}, in sight from {light}");
    }

    #[test]
    fn level_ground_has_the_colour_of_its_value() {
        let heights = level(30, 30);
        let values = raster(30, 30, |cell| cell.col as f32);
        let surface = Surface::new("", &heights, &values, ColourMap::Viridis);
        for col in [0, 10, 29] {
            let want = ColourMap::Viridis.colour(0.0, col as f64 / 29.0);
            let found = pixel(&surface, Cell::new(12, col), 2.0);
            let near = |a: u8, b: u8| a.abs_diff(b) <= 4;
            let alike = near(found.r(), want.r()) && near(found.g(), want.g());
            assert!(alike && near(found.b(), want.b()), "{found:?}, not {want:?}");
        }
    }

    #[test]
    fn unknown_cells_are_holes_that_show_the_floor() {
        let heights = bumps(40, 40);
        let hole = |cell: Cell| (15..25).contains(&cell.row) && (15..25).contains(&cell.col);
        let known = Raster::from_fn(heights.spec(), |cell| !hole(cell));
        let torn = raster(40, 40, |cell| if hole(cell) { f32::NAN } else { heights[cell] });
        let seen = |heights: &Raster<f32>, known: Option<&Raster<bool>>| {
            let mut surface = Surface::new("", heights, heights, ColourMap::Viridis);
            surface = surface.view(PI, FRAC_PI_2);
            if let Some(known) = known {
                surface = surface.known(known);
            }
            pixel(&surface, Cell::new(18, 17), 0.0)
        };
        assert_eq!(seen(&heights, Some(&known)), frame::FLOOR);
        assert_eq!(seen(&torn, None), frame::FLOOR);
        assert_ne!(seen(&heights, None), frame::FLOOR);
    }

    #[test]
    fn ground_without_a_value_is_grey_and_named() {
        let heights = level(20, 20);
        let values = raster(20, 20, |cell| if cell.row < 10 { f32::NAN } else { 1.0 });
        let surface = Surface::new("", &heights, &values, ColourMap::Viridis);
        assert_eq!(pixel(&surface, Cell::new(5, 10), 2.0), BARE);
        assert_eq!(surface.legend_keys(), [(Key::Fill(BARE), "no value".to_owned())]);
    }

    #[test]
    fn a_mast_carries_its_marker_over_what_would_hide_it() {
        let heights = raster(41, 41, |cell| if cell.row == 30 { 15.0 } else { 0.0 });
        let behind = Cell::new(28, 20);
        let surface = || Surface::new("", &heights, &heights, ColourMap::Grey).view(PI, FRAC_PI_6);
        let ink = Rgb888::new(213, 94, 0);
        assert_ne!(pixel(&surface().markers(star(behind)), behind, 0.0), ink);
        assert_eq!(pixel(&surface().masts(star(behind), Mast::Long(25.0)), behind, 25.0), ink);
        assert_eq!(pixel(&surface().masts(star(behind), Mast::UpTo(30.0)), behind, 30.0), ink);
        let front = Cell::new(35, 20);
        assert_eq!(pixel(&surface().markers(star(front)), front, 0.0), ink);
        // The mast itself: dark in front of the wall, hidden behind it.
        let masted = |cell| surface().masts(star(cell), Mast::Long(25.0));
        assert!(pixel(&masted(front), front, 5.0).r() < 60);
        // Another mast of the same length keeps the box as it is.
        let elsewhere = masted(Cell::new(28, 2));
        let (with, without) = (pixel(&masted(behind), behind, 5.0), pixel(&elsewhere, behind, 5.0));
        assert_eq!(with, without);
    }

    #[test]
    fn the_same_surface_gives_the_same_pixels_at_any_number_of_threads() {
        let heights = bumps(90, 70);
        let known = heights.map(|&z| z > -3.0);
        let surface = Surface::new("twice", &heights, &heights, ColourMap::Sand).known(&known);
        let drawn = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| surface.draw().unwrap().0.pixels)
        };
        assert_eq!(drawn(1), drawn(3));
    }

    /// From all around, at any altitude, for any shape: numbers and labels stand inside the picture, off each other.
    #[test]
    fn the_axes_are_readable_from_everywhere() {
        for (rows, cols) in [(101, 101), (30, 200), (200, 7), (1, 1)] {
            let heights = bumps(rows, cols);
            for (azimuth, altitude) in
                (0..24).flat_map(|i| [4, 20, 36, 60, 90].map(|altitude| (15 * i, altitude)))
            {
                let [azimuth_rad, altitude_rad] =
                    [azimuth, altitude].map(|degrees: i32| f64::from(degrees).to_radians());
                let surface = Surface::new("", &heights, &heights, ColourMap::Viridis)
                    .view(azimuth_rad, altitude_rad.min(FRAC_PI_2));
                surface.check().unwrap();
                let view = View::new(azimuth_rad, altitude_rad, LIGHT);
                let frame = Frame::new(heights.spec(), surface.ends().unwrap(), 1.0, view);
                let layout = surface.layout(frame, Sampled { every: 1 }, surface.span());
                let all: Vec<Area> = layout.axes.iter().flat_map(Axis::areas).collect();
                let what = format!("{rows} x {cols} from {azimuth}, {altitude} up");
                for (i, area) in all.iter().enumerate() {
                    assert!(area.left >= 0 && area.top >= layout.note_top, "{what}: {area:?}");
                    let (right, bottom) = (layout.key.body.left, layout.height);
                    assert!(area.right() <= right && area.bottom() <= bottom, "{what}: {area:?}");
                    assert!(
                        all[..i].iter().all(|other| other.overlap(*area) == 0),
                        "{what}: {area:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn one_row_one_column_one_cell_and_level_ground_are_surfaces() {
        for (rows, cols) in [(1, 1), (1, 50), (50, 1), (2, 2)] {
            for height in [0.0, -4500.0, 1e-30, 3e20] {
                let heights = raster(rows, cols, |_| height);
                let surface = Surface::new("", &heights, &heights, ColourMap::Cividis);
                let (canvas, _) = surface.draw().unwrap();
                let colour = ColourMap::Cividis.colour(0.0, 0.5);
                let shown = canvas.pixels.iter().filter(|&&pixel| pixel == colour).count();
                assert!(shown > 50 || height > 1e3, "{rows} x {cols} at {height}: {shown}");
            }
        }
    }

    #[test]
    fn heights_at_the_end_of_what_numbers_hold_are_drawn() {
        let heights = raster(3, 3, |cell| if cell.row == 1 { f32::MAX } else { f32::MIN });
        assert!(Surface::new("", &heights, &heights, ColourMap::Grey).draw().is_ok());
    }

    #[test]
    fn a_large_raster_shows_every_nth_cell_and_says_so() {
        let heights = level(4, 1500);
        let surface = Surface::new("", &heights, &heights, ColourMap::Grey);
        let sampled = Sampled::of(1500);
        assert_eq!(sampled, Sampled { every: 3 });
        assert_eq!(Sampled::of(700), Sampled { every: 1 });
        let (_, layout) = surface.draw().unwrap();
        assert!(
            layout.note.join(" ").contains("one cell in 3 a side is drawn"),
            "{:?}",
            layout.note
        );
        let ground = surface.ground(&layout.frame, sampled);
        assert_eq!((ground.norths.len(), ground.easts.len()), (3, 501));
        // The last patch is smaller rather than past the side.
        assert_eq!(ground.norths, [2.0, -1.0, -2.0]);
        assert_eq!(ground.easts[500], 750.0);
    }

    #[test]
    fn the_note_says_whence_and_how_high() {
        let heights = level(3, 3);
        let note = |surface: Surface<'_>| surface.note(Sampled { every: 1 });
        let surface = || Surface::new("", &heights, &heights, ColourMap::Grey);
        assert_eq!(
            note(surface()),
            "seen from the south-west, 36° above the horizon; heights to scale"
        );
        let turned = note(surface().view(-0.1, 0.5).exaggeration(2.5));
        assert!(turned.contains("from the north, 29°") && turned.contains("2.5 times as high"));
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_by_name() {
        let (heights, other) = (level(3, 3), level(3, 4));
        let known = other.map(|_| true);
        let surface = || Surface::new("", &heights, &heights, ColourMap::Grey);
        let told = |surface: Surface<'_>| surface.draw().unwrap_err().to_string();
        let values = Surface::new("", &heights, &other, ColourMap::Grey);
        assert!(told(values).contains("values have 3 x 4 cells, the heights 3 x 3"));
        assert!(told(surface().known(&known)).contains("mask of known cells has 3 x 4"));
        assert!(
            told(surface().markers(star(Cell::new(3, 0)))).contains("`goal` at (row 3, col 0)")
        );
        let sunk = surface().masts(star(Cell::new(0, 0)), Mast::Long(-1.0));
        assert!(told(sunk).contains("`goal` stands on a mast"));
        assert!(told(surface().exaggeration(0.0)).contains("drawn 0 times as high"));
        assert!(told(surface().view(0.0, -0.1)).contains("altitude above 0"));
        assert!(told(surface().view(f64::NAN, 0.5)).contains("azimuth NaN"));
        assert!(told(surface().range(2.0, 1.0)).contains("range from 2 to 1"));
        let nothing = heights.map(|_| f32::NAN);
        let nothing = Surface::new("", &nothing, &heights, ColourMap::Grey);
        assert!(told(nothing).contains("no height is known"));
    }

    #[test]
    fn an_error_names_the_file() {
        let heights = level(2, 2);
        let path = Path::new("no such folder/surface.png");
        let error = Surface::new("", &heights, &heights, ColourMap::Grey).save(path).unwrap_err();
        assert!(format!("{error:#}").contains("no such folder/surface.png"), "{error:#}");
    }
}
