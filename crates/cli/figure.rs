//! Maps as pictures: a raster with its colours, axes, tracks and markers, written as a PNG.
//!
//! A figure shows one layer. Each cell is a square of whole pixels in the colour of its value, and nothing is
//! interpolated: what is seen is what is in the raster. Large rasters show every n-th cell instead.

use std::{
    convert::Infallible,
    fs::File,
    io::{BufWriter, Write},
    path::Path,
};

use anyhow::{Context, ensure};
use embedded_graphics::{
    mono_font::{
        MonoFont, MonoTextStyle,
        iso_8859_1::{FONT_9X15, FONT_9X15_BOLD, FONT_10X20},
    },
    pixelcolor::Rgb888,
    prelude::*,
    text::{Baseline, Text},
};
use wisdom_grid::{Cell, Raster};

/// The length that the longer side of a map aims at, pixels.
const MAP_SIDE: usize = 800;
/// A map never grows longer than this, pixels: beyond it only every n-th cell is drawn.
const MAP_SIDE_MOST: usize = 1200;
/// White border around everything, pixels.
const MARGIN: i32 = 18;
/// Space between the parts of a figure, pixels.
const GAP: i32 = 10;
/// Length of a tick, pixels.
const TICK: i32 = 6;
/// Width of the colour bar, pixels.
const BAR: i32 = 22;
/// Height of the tip that says "values go on beyond the bar", pixels.
const TIP: i32 = 12;
/// Width and height of a swatch in a legend, pixels.
const SWATCH: (i32, i32) = (28, 15);
/// Height of a row of a legend, pixels.
const ROW: i32 = 24;
/// The least height of the map's row and the least width of a figure, pixels: room for bar and title.
const LEAST: (i32, i32) = (520, 180);
/// Half the width of a track, pixels.
const TRACK: f32 = 1.5;
/// Distance from a marker's centre to its outline, pixels.
const MARKER: f32 = 8.0;
/// Width of the contrasting rim around tracks and markers, pixels.
const HALO: f32 = 1.4;
/// The longest label of a marker, characters.
const LABEL_MOST: usize = 32;
/// Drawn and bare length of a dashed track, pixels.
const DASH: (f32, f32) = (9.0, 9.0);

const TITLE: &MonoFont<'_> = &FONT_10X20;
const BODY: &MonoFont<'_> = &FONT_9X15;
const LABEL: &MonoFont<'_> = &FONT_9X15_BOLD;

const WHITE: Rgb888 = Rgb888::new(255, 255, 255);
const DARK: Rgb888 = Rgb888::new(24, 24, 28);
const UNKNOWN: Rgb888 = Rgb888::new(226, 226, 226);
const UNKNOWN_STRIPE: Rgb888 = Rgb888::new(192, 192, 192);

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum ColourMap {
    /// Dark violet to yellow, even in lightness (van der Walt and Smith, 2015).
    Viridis,
    /// Dark blue to yellow, alike for readers with and without colour vision deficiency (Nuñez et al., 2018).
    Cividis,
    /// Black to white.
    Grey,
    /// Blue over white to red; centred on zero unless a range is given.
    Diverging,
    /// That many classes, 0 to n − 1, each with a colour of its own and a name in the legend.
    Classes(usize),
}

/// How the axes count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Axes {
    /// Metres (kilometres above 10 km) east and north of the map's outer south-west corner.
    Metres,
    /// Cells, x to the east and y to the north, both counted from 1 at the south-west cell, as the paper does.
    Counted,
}

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
}

/// Colours of tracks and markers that readers with colour vision deficiency can tell apart (Okabe and Ito, 2008),
/// with white and black.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Ink {
    /// Orange.
    Orange,
    /// Light blue.
    SkyBlue,
    /// Bluish green.
    Green,
    /// Yellow.
    Yellow,
    /// Blue.
    Blue,
    /// Red leaning to orange.
    Vermilion,
    /// Reddish purple.
    Purple,
    /// White.
    White,
    /// Black.
    Black,
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

/// A map of one raster, to be saved as a picture.
///
/// Text is drawn in Latin-1; a few signs are spelt in it (`−` as `-`, `≤` as `<=`, `∩` as `&`, `∪` as `|`), and any other
/// character becomes `?`.
#[derive(Debug, Clone)]
pub(crate) struct Figure<'a> {
    title: String,
    layer: &'a Raster<f32>,
    map: ColourMap,
    value_label: String,
    class_names: Vec<String>,
    range: Option<(f64, f64)>,
    axes: Axes,
    hillshade: Option<&'a Raster<f32>>,
    known: Option<&'a Raster<bool>>,
    tracks: Vec<Track>,
    markers: Vec<Markers>,
}

impl<'a> Figure<'a> {
    /// A figure of `layer` in the colours of `map`, with metric axes, the range of the known values and nothing drawn over it.
    pub(crate) fn new(title: &str, layer: &'a Raster<f32>, map: ColourMap) -> Self {
        Self {
            title: title.lines().map(latin).collect::<Vec<_>>().join("\n"),
            layer,
            map,
            value_label: String::new(),
            class_names: Vec::new(),
            range: None,
            axes: Axes::Metres,
            hillshade: None,
            known: None,
            tracks: Vec::new(),
            markers: Vec::new(),
        }
    }

    /// Says beside the colours what they show, with its unit.
    pub(crate) fn value_label(mut self, label: &str) -> Self {
        self.value_label = latin(label);
        self
    }

    /// Names the classes of [`ColourMap::Classes`] in order; a class without a name goes by its number, one with an
    /// empty name is left out of the legend.
    pub(crate) fn class_names(mut self, names: &[&str]) -> Self {
        self.class_names = names.iter().map(|name| latin(name)).collect();
        self
    }

    /// Fixes the values at the ends of the colour bar, so that figures can be compared; values beyond take the end's
    /// colour, and the bar says so by a tip.
    pub(crate) fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// Chooses how the axes count.
    pub(crate) fn axes(mut self, axes: Axes) -> Self {
        self.axes = axes;
        self
    }

    /// Darkens the map where a hillshade (0 in shadow, 1 facing the light) of the same shape is low.
    pub(crate) fn hillshade(mut self, shade: &'a Raster<f32>) -> Self {
        self.hillshade = Some(shade);
        self
    }

    /// Hatches the cells of a mask of the same shape that are `false`; their values count nowhere.
    pub(crate) fn known(mut self, known: &'a Raster<bool>) -> Self {
        self.known = Some(known);
        self
    }

    /// Draws a line over the map, above the lines drawn before.
    pub(crate) fn track(mut self, track: Track) -> Self {
        self.tracks.push(Track { name: latin(&track.name), ..track });
        self
    }

    /// Draws markers over the map and its tracks.
    pub(crate) fn markers(mut self, markers: Markers) -> Self {
        let at = markers.at.into_iter().map(|(cell, label)| (cell, latin(&label))).collect();
        self.markers.push(Markers { name: latin(&markers.name), at, ..markers });
        self
    }

    /// Writes the figure as an RGB PNG.
    ///
    /// # Errors
    /// If the file cannot be written, a mask or hillshade has another shape than the layer, a track or marker lies off
    /// the map, or a range is empty; each error names the file.
    pub(crate) fn save(&self, path: &Path) -> anyhow::Result<()> {
        let canvas = self.draw().with_context(|| format!("figure {}", path.display()))?;
        canvas.write(path).with_context(|| format!("cannot write figure {}", path.display()))
    }

    /// The finished picture.
    fn draw(&self) -> anyhow::Result<Canvas> {
        self.check()?;
        let span = self.span();
        let layout = self.layout(span);
        let mut canvas = Canvas::blank(layout.width, layout.height);
        for (i, line) in (0..).zip(&layout.title) {
            canvas.text(TITLE, line, (layout.map.left, MARGIN + i * line_height(TITLE)), DARK);
        }
        self.draw_cells(&mut canvas, &layout, span);
        self.draw_axes(&mut canvas, &layout);
        if let ColourMap::Classes(_) = self.map {
            self.draw_classes(&mut canvas, &layout);
        } else {
            self.draw_bar(&mut canvas, &layout, span);
        }
        let drawn = self.draw_tracks(&mut canvas, &layout);
        self.draw_markers(&mut canvas, &layout);
        for label in self.place_labels(&layout, &drawn) {
            canvas.haloed(&label.text, (label.area.left, label.area.top));
        }
        for entry in &layout.legend {
            entry.draw(&mut canvas);
        }
        Ok(canvas)
    }

    /// Refuses what cannot be drawn honestly.
    fn check(&self) -> anyhow::Result<()> {
        let spec = self.layer.spec();
        let shapes = [
            ("hillshade", self.hillshade.map(Raster::spec)),
            ("mask of known cells", self.known.map(Raster::spec)),
        ];
        for (what, shape) in shapes {
            if let Some(other) = shape {
                ensure!(
                    (other.rows(), other.cols()) == (spec.rows(), spec.cols()),
                    "the {what} has {} x {} cells, the layer {} x {}",
                    other.rows(),
                    other.cols(),
                    spec.rows(),
                    spec.cols()
                );
            }
        }
        let tracks = self.tracks.iter().flat_map(|t| t.cells.iter().map(|&c| (&t.name, c)));
        let marked = self.markers.iter().flat_map(|m| m.at.iter().map(|(c, _)| (&m.name, *c)));
        for (name, cell) in tracks.chain(marked) {
            ensure!(
                spec.contains(cell),
                "`{name}` at {cell} lies off the map of {} x {} cells",
                spec.rows(),
                spec.cols()
            );
        }
        if let Some((low, high)) = self.range {
            ensure!(
                low < high && (high - low).is_finite(),
                "the colours range from {low} to {high}; the first must be below the second"
            );
        }
        Ok(())
    }

    /// The value to show at a cell; none where it is not known, not finite, or no class.
    fn value(&self, cell: Cell) -> Option<f32> {
        let value = self.layer[cell];
        let known = self.known.is_none_or(|known| known[cell]);
        let shown = match self.map {
            ColourMap::Classes(n) => value.round() >= 0.0 && value.round() < n as f32,
            _ => value.is_finite(),
        };
        (known && shown).then_some(value)
    }

    /// The values at the ends of the colours, and whether the layer goes beyond.
    fn span(&self) -> Span {
        let values = self.layer.spec().cells().filter_map(|cell| self.value(cell)).map(f64::from);
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if least > most {
            let (low, high) = self.range.unwrap_or((0.0, 1.0));
            return Span { low, high, under: false, over: false };
        }
        let (low, high) = self.range.unwrap_or_else(|| match self.map {
            ColourMap::Diverging => (-least.abs().max(most.abs()), least.abs().max(most.abs())),
            _ => (least, most),
        });
        // A constant raster still gets a bar: its value in the middle, of a width that f64 can tell from nothing.
        let half = if low < high { 0.0 } else { (low.abs() * 1e-6).max(0.5) };
        Span { low: low - half, high: high + half, under: least < low, over: most > high }
    }

    /// The colour of a value.
    fn colour(&self, value: f64, span: Span) -> Rgb888 {
        let t = ((value - span.low) / (span.high - span.low)).clamp(0.0, 1.0);
        let colour = match self.map {
            ColourMap::Viridis => colorous::VIRIDIS.eval_continuous(t),
            ColourMap::Cividis => colorous::CIVIDIS.eval_continuous(t),
            ColourMap::Grey => colorous::GREYS.eval_continuous(1.0 - t),
            ColourMap::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - t),
            ColourMap::Classes(n) => class_colour(value.round() as usize, n),
        };
        Rgb888::new(colour.r, colour.g, colour.b)
    }

    fn draw_cells(&self, canvas: &mut Canvas, layout: &Layout, span: Span) {
        let map = layout.map;
        for y in 0..map.height {
            for x in 0..map.width {
                let cell = layout.scale.cell(self.layer, x, y);
                let colour = match self.value(cell) {
                    Some(value) => {
                        let colour = self.colour(f64::from(value), span);
                        self.hillshade.map_or(colour, |shade| lit(colour, shade[cell]))
                    }
                    None => hatch(x, y),
                };
                canvas.put(map.left + x, map.top + y, colour);
            }
        }
    }

    fn draw_axes(&self, canvas: &mut Canvas, layout: &Layout) {
        let map = layout.map;
        canvas.frame(map);
        for tick in &layout.x_ticks {
            let x = map.left + tick.at;
            canvas.fill(Area { left: x, top: map.bottom() + 1, width: 1, height: TICK }, DARK);
            let left = x - width(BODY, &tick.text) / 2;
            canvas.text(BODY, &tick.text, (left, map.bottom() + TICK + 4), DARK);
        }
        for tick in &layout.y_ticks {
            let y = map.top + tick.at;
            let ticked = Area { left: map.left - 1 - TICK, top: y, width: TICK, height: 1 };
            canvas.fill(ticked, DARK);
            let left = map.left - TICK - 5 - width(BODY, &tick.text);
            canvas.text(BODY, &tick.text, (left, y - line_height(BODY) / 2), DARK);
        }
        let (x_label, y_label) = self.axis_labels();
        let x = map.left + (map.width - width(BODY, x_label)) / 2;
        let y = map.bottom() + TICK + 4 + line_height(BODY) + GAP / 2;
        canvas.text(BODY, x_label, (x, y), DARK);
        let up = (map.top + i32::midpoint(map.height, width(BODY, y_label)))
            .max(layout.body_top + width(BODY, y_label));
        canvas.upright(BODY, y_label, (layout.y_label_left, up), DARK);
    }

    fn draw_bar(&self, canvas: &mut Canvas, layout: &Layout, span: Span) {
        let bar = layout.bar;
        for y in 0..bar.height {
            let t = (f64::from(y) + 0.5) / f64::from(bar.height);
            let colour = self.colour(span.high + t * (span.low - span.high), span);
            canvas.fill(Area { top: bar.top + y, height: 1, ..bar }, colour);
        }
        canvas.frame(bar);
        if span.over {
            canvas.tip(bar, bar.top - 2, -1, self.colour(span.high, span));
        }
        if span.under {
            canvas.tip(bar, bar.bottom() + 1, 1, self.colour(span.low, span));
        }
        for tick in &layout.value_ticks {
            let y = bar.top + tick.at;
            canvas.fill(Area { left: bar.right() + 1, top: y, width: TICK, height: 1 }, DARK);
            let at = (bar.right() + 1 + TICK + 4, y - line_height(BODY) / 2);
            canvas.text(BODY, &tick.text, at, DARK);
        }
        let label = fit(&self.value_label, (layout.body_height / advance(BODY)) as usize);
        let up = (bar.top + i32::midpoint(bar.height, width(BODY, &label)))
            .max(layout.body_top + width(BODY, &label));
        let left =
            bar.right() + 1 + TICK + 4 + widest(BODY, layout.value_ticks.iter().map(Tick::text));
        canvas.upright(BODY, &label, (left + GAP, up), DARK);
    }

    fn draw_classes(&self, canvas: &mut Canvas, layout: &Layout) {
        let ColourMap::Classes(n) = self.map else { return };
        let (left, mut top) = (layout.bar.left, layout.body_top);
        for line in self.class_heading() {
            canvas.text(BODY, &line, (left, top), DARK);
            top += line_height(BODY) + 2;
        }
        top += GAP / 2;
        for (class, name) in self.class_list(n) {
            let colour = class_colour(class, n);
            let swatch = Area { left, top, width: SWATCH.0, height: SWATCH.1 };
            canvas.fill(swatch, Rgb888::new(colour.r, colour.g, colour.b));
            canvas.frame(swatch);
            canvas.text(BODY, &name, (left + SWATCH.0 + 8, top), DARK);
            top += ROW;
        }
    }

    /// Draws the tracks; returns where they are, so that labels can keep away.
    fn draw_tracks(&self, canvas: &mut Canvas, layout: &Layout) -> Stencil {
        let mut all = Stencil::empty(layout.map);
        for track in &self.tracks {
            let points: Vec<_> = track.cells.iter().map(|&cell| layout.centre(cell)).collect();
            let pieces = pieces(&points, track.stroke);
            stroke(canvas, layout.map, &pieces, track.ink);
            for &(from, to) in &pieces {
                all.line(from, to, TRACK + HALO);
            }
        }
        all
    }

    fn draw_markers(&self, canvas: &mut Canvas, layout: &Layout) {
        for kind in &self.markers {
            for (cell, _) in &kind.at {
                canvas.marker(kind.shape, layout.centre(*cell), kind.ink);
            }
        }
    }

    /// Finds each label a place beside its marker: inside the map, off other labels and markers, off the tracks where it
    /// can be.
    fn place_labels(&self, layout: &Layout, drawn: &Stencil) -> Vec<Label> {
        let marked = self.markers.iter().flat_map(|kind| &kind.at);
        let mut taken: Vec<Area> =
            marked.clone().map(|(cell, _)| around(layout.centre(*cell))).collect();
        let mut labels = Vec::new();
        for (cell, text) in marked.filter(|(_, text)| !text.is_empty()) {
            let text = fit(text, LABEL_MOST);
            let size = (width(LABEL, &text), line_height(LABEL));
            let area = candidates(layout.centre(*cell), size)
                .into_iter()
                .map(|area| area.pushed_into(layout.label_room))
                .min_by_key(|area| {
                    let covered: i32 = taken.iter().map(|other| area.overlap(*other)).sum();
                    4 * covered + drawn.count(*area)
                })
                .expect("there is always a candidate");
            taken.push(area.grown(2));
            labels.push(Label { text, area });
        }
        labels
    }

    fn axis_labels(&self) -> (&'static str, &'static str) {
        match self.axes {
            Axes::Metres if self.metric_unit().0 > 1.0 => ("x east (km)", "y north (km)"),
            Axes::Metres => ("x east (m)", "y north (m)"),
            Axes::Counted => ("x (cells)", "y (cells)"),
        }
    }

    /// Metres in a unit of the axes, and units in a cell.
    fn metric_unit(&self) -> (f64, f64) {
        let spec = self.layer.spec();
        let long_m = spec.rows().max(spec.cols()) as f64 * spec.spacing_m();
        let unit = if long_m > 10_000.0 { 1000.0 } else { 1.0 };
        (unit, spec.spacing_m() / unit)
    }

    /// Ticks of an axis of `cells` cells: distance from its west or south end in pixels, and the number.
    fn axis_ticks(&self, cells: usize, scale: Scale, fits: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
        let long = cells as f64;
        let (low, high, least_step) = match self.axes {
            Axes::Metres => (0.0, long * self.metric_unit().1, 0.0),
            Axes::Counted => (1.0, long, 1.0),
        };
        let place = |value: f64| match self.axes {
            Axes::Metres => value / self.metric_unit().1,
            Axes::Counted => value - 0.5,
        };
        let ticks = |most| {
            let (step, values) = ticks(low, high, most, least_step);
            let tick = |value: &f64| Tick {
                at: (place(*value) * scale.pixels()) as i32,
                text: number(*value, step, low.abs().max(high.abs())),
            };
            values.iter().map(tick).collect::<Vec<_>>()
        };
        (1..=10).rev().map(ticks).find(|found| fits(found)).unwrap_or_default()
    }

    /// What the legend below the map names.
    fn legend_keys(&self) -> Vec<(Key, String)> {
        let tracks = self.tracks.iter().map(|t| (Key::Track(t.stroke, t.ink), t.name.clone()));
        let kinds = self.markers.iter().map(|m| (Key::Marker(m.shape, m.ink), m.name.clone()));
        let unseen = self.layer.spec().cells().any(|cell| self.value(cell).is_none());
        let unknown = unseen.then(|| (Key::Unknown, "not known".to_owned()));
        tracks.chain(kinds).filter(|(_, name)| !name.is_empty()).chain(unknown).collect()
    }

    fn class_heading(&self) -> Vec<String> {
        wrap(&self.value_label, 20)
    }

    /// The classes that the legend names.
    fn class_list(&self, n: usize) -> Vec<(usize, String)> {
        (0..n)
            .map(|class| (class, self.class_names.get(class).cloned().unwrap_or(class.to_string())))
            .filter(|(_, name)| !name.is_empty())
            .map(|(class, name)| (class, fit(&name, 24)))
            .collect()
    }

    /// Puts every part in its place.
    fn layout(&self, span: Span) -> Layout {
        let spec = self.layer.spec();
        let scale = Scale::of(spec.rows().max(spec.cols()));
        let (map_width, map_height) = (scale.length(spec.cols()), scale.length(spec.rows()));
        let (x_label, y_label) = self.axis_labels();
        let x_ticks = self.axis_ticks(spec.cols(), scale, apart_across);
        let y_ticks = flipped(self.axis_ticks(spec.rows(), scale, apart_down), map_height);

        // Down: the title is known last, so first everything below it.
        let class_rows = match self.map {
            ColourMap::Classes(n) => self.class_list(n).len() as i32,
            _ => 0,
        };
        let class_height =
            class_rows * ROW + GAP + self.class_heading().len() as i32 * (line_height(BODY) + 2);
        let body_height = map_height.max(LEAST.1).max(class_height).max(width(BODY, y_label));

        // Across: y label, y numbers, map, bar or classes with their words.
        let y_label_left = MARGIN;
        let y_numbers = widest(BODY, y_ticks.iter().map(Tick::text));
        let map_left = y_label_left + line_height(BODY) + GAP + y_numbers + 5 + TICK;
        // A map narrower than its labels leaves room for them to its right.
        let longest =
            widest(LABEL, self.markers.iter().flat_map(|m| &m.at).map(|(_, text)| text.as_str()))
                .min(LABEL_MOST as i32 * advance(LABEL));
        let label_width = map_width.max(map_width / 2 + 2 * MARKER as i32 + longest);
        let last_number = x_ticks.last().map_or(0, |tick| tick.at + width(BODY, &tick.text) / 2);
        let under_map = map_width / 2 + width(BODY, x_label) / 2;
        let bar_left = map_left + label_width.max(last_number).max(under_map) + 2 * GAP;
        let bar_height = body_height - TIP * (i32::from(span.over) + i32::from(span.under));
        let value_ticks = flipped(value_ticks(span, bar_height), bar_height);
        let key_width = if let ColourMap::Classes(n) = self.map {
            let (names, heading) = (self.class_list(n), self.class_heading());
            let names = widest(BODY, names.iter().map(|(_, name)| name.as_str()));
            (SWATCH.0 + 8 + names).max(widest(BODY, heading.iter().map(String::as_str)))
        } else {
            let label = if self.value_label.is_empty() { 0 } else { GAP + line_height(BODY) };
            BAR + 1 + TICK + 4 + widest(BODY, value_ticks.iter().map(Tick::text)) + label
        };
        let width = (bar_left + key_width + MARGIN).max(LEAST.0);

        let title = wrap(&self.title, ((width - map_left - MARGIN) / advance(TITLE)) as usize);
        let body_top = MARGIN
            + title.len() as i32 * line_height(TITLE)
            + if title.is_empty() { line_height(BODY) / 2 } else { GAP };
        let map = Area { left: map_left, top: body_top, width: map_width, height: map_height };
        let label_room =
            Area { width: label_width, height: map_height.max(line_height(LABEL) + 6), ..map }
                .grown(-3);
        let bar = Area {
            left: bar_left,
            top: body_top + if span.over { TIP } else { 0 },
            width: BAR,
            height: bar_height,
        };
        let axis_bottom = map.bottom() + TICK + 4 + 2 * line_height(BODY) + GAP / 2;
        let legend_top = axis_bottom.max(body_top + body_height) + GAP + 4;
        let legend = legend(self.legend_keys(), MARGIN.max(map_left.min(120)), legend_top, width);
        let bottom = legend.last().map_or(legend_top - GAP - 4, |entry| entry.top + SWATCH.1);
        Layout {
            width,
            height: bottom + MARGIN,
            title,
            scale,
            body_top,
            body_height,
            map,
            label_room,
            bar,
            y_label_left,
            x_ticks,
            y_ticks,
            value_ticks,
            legend,
        }
    }
}

impl Ink {
    fn rgb(self) -> Rgb888 {
        match self {
            Self::Orange => Rgb888::new(230, 159, 0),
            Self::SkyBlue => Rgb888::new(86, 180, 233),
            Self::Green => Rgb888::new(0, 158, 115),
            Self::Yellow => Rgb888::new(240, 228, 66),
            Self::Blue => Rgb888::new(0, 114, 178),
            Self::Vermilion => Rgb888::new(213, 94, 0),
            Self::Purple => Rgb888::new(204, 121, 167),
            Self::White => WHITE,
            Self::Black => DARK,
        }
    }

    /// The colour of the rim that sets this one off from any ground.
    fn rim(self) -> Rgb888 {
        match self {
            Self::Black | Self::Blue => WHITE,
            _ => DARK,
        }
    }
}

/// The ends of the colours, and whether values lie beyond them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Span {
    low: f64,
    high: f64,
    under: bool,
    over: bool,
}

/// A number on an axis: pixels from the start of the axis, and its text.
#[derive(Debug, Clone, PartialEq)]
struct Tick {
    at: i32,
    text: String,
}

impl Tick {
    fn text(&self) -> &str {
        &self.text
    }
}

/// A label in its place.
#[derive(Debug, Clone, PartialEq)]
struct Label {
    text: String,
    area: Area,
}

/// Where everything goes, pixels.
#[derive(Debug)]
struct Layout {
    width: i32,
    height: i32,
    title: Vec<String>,
    scale: Scale,
    body_top: i32,
    body_height: i32,
    map: Area,
    label_room: Area,
    bar: Area,
    y_label_left: i32,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
    value_ticks: Vec<Tick>,
    legend: Vec<Entry>,
}

impl Layout {
    /// The middle of a cell in the picture.
    fn centre(&self, cell: Cell) -> (f32, f32) {
        let middle = |index: usize| ((index as f64 + 0.5) * self.scale.pixels()) as f32;
        (self.map.left as f32 + middle(cell.col), self.map.top as f32 + middle(cell.row))
    }
}

/// Pixels a cell, or cells a pixel; one of the two is 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Scale {
    zoom: usize,
    shrink: usize,
}

impl Scale {
    /// The scale of a map whose longer side has `cells` cells.
    fn of(cells: usize) -> Self {
        if cells > MAP_SIDE_MOST {
            return Self { zoom: 1, shrink: cells.div_ceil(MAP_SIDE_MOST) };
        }
        Self { zoom: ((MAP_SIDE + cells / 2) / cells).max(1), shrink: 1 }
    }

    /// Pixels a cell.
    fn pixels(self) -> f64 {
        self.zoom as f64 / self.shrink as f64
    }

    /// Pixels that `cells` cells take.
    fn length(self, cells: usize) -> i32 {
        (cells * self.zoom).div_ceil(self.shrink) as i32
    }

    /// The cell that a pixel of the map shows.
    fn cell(self, raster: &Raster<f32>, x: i32, y: i32) -> Cell {
        let index = |at: i32, cells: usize| {
            (at as usize * self.shrink / self.zoom + self.shrink / 2).min(cells - 1)
        };
        Cell::new(index(y, raster.spec().rows()), index(x, raster.spec().cols()))
    }
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Area {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl Area {
    /// The first column to the right of it.
    fn right(self) -> i32 {
        self.left + self.width
    }

    /// The first row below it.
    fn bottom(self) -> i32 {
        self.top + self.height
    }

    fn grown(self, by: i32) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2 * by,
            height: self.height + 2 * by,
        }
    }

    /// Moved no further than needed to lie in `room` (at its north-west if larger than it).
    fn pushed_into(self, room: Self) -> Self {
        Self {
            left: self.left.min(room.right() - self.width).max(room.left),
            top: self.top.min(room.bottom() - self.height).max(room.top),
            ..self
        }
    }

    /// Pixels in both.
    fn overlap(self, other: Self) -> i32 {
        let across = self.right().min(other.right()) - self.left.max(other.left);
        let down = self.bottom().min(other.bottom()) - self.top.max(other.top);
        across.max(0) * down.max(0)
    }
}

/// What a row of the legend shows beside its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Key {
    Track(Stroke, Ink),
    Marker(Shape, Ink),
    Unknown,
}

/// A key and its name in their place.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Entry {
    key: Key,
    name: String,
    left: i32,
    top: i32,
}

impl Entry {
    fn draw(&self, canvas: &mut Canvas) {
        let swatch = Area { left: self.left, top: self.top, width: SWATCH.0, height: SWATCH.1 };
        let middle = swatch.top as f32 + swatch.height as f32 / 2.0;
        let (from, to) = (swatch.left as f32 + 1.5, swatch.right() as f32 - 1.5);
        match self.key {
            Key::Track(style, ink) => {
                stroke(
                    canvas,
                    swatch.grown(2),
                    &pieces(&[(from, middle), (to, middle)], style),
                    ink,
                );
            }
            Key::Marker(shape, ink) => canvas.marker(shape, (f32::midpoint(from, to), middle), ink),
            Key::Unknown => {
                for (y, x) in
                    (0..swatch.height).flat_map(|y| (0..swatch.width).map(move |x| (y, x)))
                {
                    canvas.put(swatch.left + x, swatch.top + y, hatch(x, y));
                }
                canvas.frame(swatch);
            }
        }
        canvas.text(BODY, &self.name, (swatch.right() + 8, swatch.top), DARK);
    }
}

/// Sets keys in rows that fit `width`.
fn legend(keys: Vec<(Key, String)>, left: i32, top: i32, width: i32) -> Vec<Entry> {
    let most = (width - MARGIN - left - SWATCH.0 - 8) / advance(BODY);
    let (mut at, mut row) = (left, top);
    let mut entries = Vec::new();
    for (key, name) in keys {
        let name = fit(&name, most as usize);
        let wide = SWATCH.0 + 8 + self::width(BODY, &name);
        if at > left && at + wide > width - MARGIN {
            (at, row) = (left, row + ROW);
        }
        entries.push(Entry { key, name, left: at, top: row });
        at += wide + 2 * GAP;
    }
    entries
}

/// At most `most` + 1 round numbers (1, 2 or 5 times a power of ten apart) from `low` to `high`, and their step.
fn ticks(low: f64, high: f64, most: usize, least_step: f64) -> (f64, Vec<f64>) {
    let raw = ((high - low) / most as f64).max(least_step);
    if raw <= 0.0 {
        return (1.0, vec![low]);
    }
    // Room for the rounding of a division: 0.3 / 0.1 is not quite 3.
    let slack = 1e-9;
    let decade = 10f64.powf((raw.log10() + slack).floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * decade)
        .into_iter()
        .find(|step| *step >= raw * (1.0 - slack))
        .unwrap_or(10.0 * decade);
    let (first, last) = ((low / step - slack).ceil() as i64, (high / step + slack).floor() as i64);
    (step, (first..=last).map(|i| i as f64 * step).collect())
}

/// A tick's number, with the decimals that its step needs; `largest` is the largest number on the axis.
fn number(value: f64, step: f64, largest: f64) -> String {
    let places = |x: f64| (x.abs().log10() + 1e-9).floor() as i32;
    if value.abs() < step / 2.0 {
        return "0".to_owned();
    }
    if largest >= 1e7 || step < 1e-5 {
        let digits = (places(value) - places(step)).clamp(0, 12) as usize;
        return format!("{value:.digits$e}");
    }
    let decimals = (-places(step)).max(0) as usize;
    format!("{value:.decimals$}")
}

/// Ticks of a colour bar, from its low end.
fn value_ticks(span: Span, height: i32) -> Vec<Tick> {
    let most = (height / 35).clamp(3, 10) as usize;
    let (step, values) = ticks(span.low, span.high, most, 0.0);
    let largest = span.low.abs().max(span.high.abs());
    let share = |value: f64| ((value - span.low) / (span.high - span.low)).clamp(0.0, 1.0);
    let tick = |value: &f64| Tick {
        at: (share(*value) * f64::from(height)) as i32,
        text: number(*value, step, largest),
    };
    values.iter().map(tick).collect()
}

/// Ticks counted from the top instead of from the bottom, on the last pixel rather than past it.
fn flipped(ticks: Vec<Tick>, height: i32) -> Vec<Tick> {
    ticks.into_iter().map(|tick| Tick { at: (height - tick.at).min(height - 1), ..tick }).collect()
}

/// Whether numbers beside each other leave a gap.
fn apart_across(ticks: &[Tick]) -> bool {
    ticks.windows(2).all(|pair| {
        let needed =
            i32::midpoint(width(BODY, &pair[0].text), width(BODY, &pair[1].text)) + 2 * GAP;
        pair[1].at - pair[0].at >= needed
    })
}

/// Whether numbers above each other leave a gap.
fn apart_down(ticks: &[Tick]) -> bool {
    ticks.windows(2).all(|pair| pair[1].at - pair[0].at >= line_height(BODY) + 2 * GAP)
}

/// The colour of a class: as unlike as `n` colours can be.
fn class_colour(class: usize, n: usize) -> colorous::Color {
    match n {
        0..=10 => colorous::TABLEAU10[class],
        11..=12 => colorous::PAIRED[class],
        _ => colorous::TURBO.eval_rational(class, n),
    }
}

/// A colour under a light: full at 1, at two fifths in full shadow, so that its value can still be read.
fn lit(colour: Rgb888, shade: f32) -> Rgb888 {
    let kept = 0.4 + 0.6 * if shade.is_finite() { shade.clamp(0.0, 1.0) } else { 1.0 };
    let dim = |channel: u8| (f32::from(channel) * kept).round() as u8;
    Rgb888::new(dim(colour.r()), dim(colour.g()), dim(colour.b()))
}

/// The pattern of what is not known.
fn hatch(x: i32, y: i32) -> Rgb888 {
    if (x + y).rem_euclid(9) < 2 { UNKNOWN_STRIPE } else { UNKNOWN }
}

/// A marker's surroundings.
fn around(centre: (f32, f32)) -> Area {
    let reach = (MARKER + HALO).ceil();
    let side = 2 * reach as i32 + 1;
    Area {
        left: (centre.0 - reach) as i32,
        top: (centre.1 - reach) as i32,
        width: side,
        height: side,
    }
}

/// Places for a label of `size` about a marker, best first, in two rings.
fn candidates(centre: (f32, f32), size: (i32, i32)) -> Vec<Area> {
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
    let reach = (MARKER + HALO) as i32 + 4;
    ring(reach)
        .into_iter()
        .chain(ring(2 * reach))
        .map(|(left, top)| Area { left, top, width: size.0, height: size.1 })
        .collect()
}

type Point2 = (f32, f32);

/// The pieces of a line that are drawn.
fn pieces(points: &[Point2], style: Stroke) -> Vec<(Point2, Point2)> {
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
fn stroke(canvas: &mut Canvas, area: Area, pieces: &[(Point2, Point2)], ink: Ink) {
    for (half, colour) in [(TRACK + HALO, ink.rim()), (TRACK, ink.rgb())] {
        let mut stencil = Stencil::empty(area);
        for &(from, to) in pieces {
            stencil.line(from, to, half);
        }
        canvas.ink(&stencil, colour);
    }
}

/// How much of each pixel of an area is covered, so that lines that touch are drawn once.
#[derive(Debug)]
struct Stencil {
    area: Area,
    covered: Vec<f32>,
}

impl Stencil {
    fn empty(area: Area) -> Self {
        Self { area, covered: vec![0.0; (area.width * area.height) as usize] }
    }

    fn index(&self, x: i32, y: i32) -> usize {
        ((y - self.area.top) * self.area.width + x - self.area.left) as usize
    }

    /// Covers a round-ended line of half width `half`.
    fn line(&mut self, from: Point2, to: Point2, half: f32) {
        let reach = half + 1.0;
        let left = ((from.0.min(to.0) - reach) as i32).max(self.area.left);
        let top = ((from.1.min(to.1) - reach) as i32).max(self.area.top);
        let right = ((from.0.max(to.0) + reach) as i32).min(self.area.right() - 1);
        let bottom = ((from.1.max(to.1) + reach) as i32).min(self.area.bottom() - 1);
        for y in top..=bottom {
            for x in left..=right {
                let share = share(off_line(from, to, (x as f32 + 0.5, y as f32 + 0.5)) - half);
                let index = self.index(x, y);
                self.covered[index] = self.covered[index].max(share);
            }
        }
    }

    /// Covered pixels in an area.
    fn count(&self, area: Area) -> i32 {
        let rows = area.top.max(self.area.top)..area.bottom().min(self.area.bottom());
        let cols = area.left.max(self.area.left)..area.right().min(self.area.right());
        rows.flat_map(|y| cols.clone().map(move |x| (x, y)))
            .map(|(x, y)| i32::from(self.covered[self.index(x, y)] > 0.5))
            .sum()
    }
}

/// Share of a pixel inside an outline, from the signed distance of its middle (negative inside).
fn share(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

/// Distance of a point from a line piece.
fn off_line(from: Point2, to: Point2, point: Point2) -> f32 {
    let (along, off) = ((to.0 - from.0, to.1 - from.1), (point.0 - from.0, point.1 - from.1));
    let square = along.0 * along.0 + along.1 * along.1;
    let t = if square > 0.0 { (off.0 * along.0 + off.1 * along.1) / square } else { 0.0 };
    let t = t.clamp(0.0, 1.0);
    (off.0 - t * along.0).hypot(off.1 - t * along.1)
}

/// Signed distance of a point from a marker about the origin, negative inside.
fn off_shape(shape: Shape, point: Point2) -> f32 {
    match shape {
        Shape::Circle => point.0.hypot(point.1) - 0.85 * MARKER,
        Shape::Square => point.0.abs().max(point.1.abs()) - 0.75 * MARKER,
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
fn corners(n: usize, far: f32, near: f32) -> Vec<Point2> {
    (0..n)
        .map(|i| {
            let (angle, radius) =
                (std::f32::consts::TAU * i as f32 / n as f32, if i % 2 == 0 { far } else { near });
            (radius * angle.sin(), -radius * angle.cos())
        })
        .collect()
}

/// Signed distance of a point from a polygon, negative inside.
fn off_polygon(corners: &[Point2], point: Point2) -> f32 {
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

fn advance(font: &MonoFont<'_>) -> i32 {
    (font.character_size.width + font.character_spacing) as i32
}

fn line_height(font: &MonoFont<'_>) -> i32 {
    font.character_size.height as i32
}

fn width(font: &MonoFont<'_>, text: &str) -> i32 {
    text.chars().count() as i32 * advance(font)
}

fn widest<'t>(font: &MonoFont<'_>, texts: impl Iterator<Item = &'t str>) -> i32 {
    texts.map(|text| width(font, text)).max().unwrap_or(0)
}

/// The text as the fonts can draw it.
fn latin(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\n' => out.push(' '),
            ' '..='~' | '\u{a0}'..='\u{ff}' => out.push(c),
            '−' | '–' | '—' => out.push('-'),
            '‘' | '’' => out.push('\''),
            '“' | '”' => out.push('"'),
            '∩' => out.push('&'),
            '∪' => out.push('|'),
            '≤' => out.push_str("<="),
            '≥' => out.push_str(">="),
            '→' => out.push_str("->"),
            '…' => out.push_str(".."),
            _ => out.push('?'),
        }
    }
    out
}

/// The text, or as much of it as fits in `most` characters with `..` at its end.
fn fit(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(2)).chain("..".chars()).collect()
}

/// Lines of at most `most` characters, broken between words.
fn wrap(text: &str, most: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > most {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(&fit(word, most));
        }
        lines.push(line);
    }
    lines
}

/// The pixels of a figure.
#[derive(Debug)]
struct Canvas {
    width: i32,
    height: i32,
    pixels: Vec<Rgb888>,
}

impl Canvas {
    fn blank(width: i32, height: i32) -> Self {
        Self { width, height, pixels: vec![WHITE; (width * height) as usize] }
    }

    /// Where a pixel is kept, if it is in the picture.
    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then(|| (y * self.width + x) as usize)
    }

    fn put(&mut self, x: i32, y: i32, colour: Rgb888) {
        if let Some(index) = self.index(x, y) {
            self.pixels[index] = colour;
        }
    }

    /// Lays a colour over a share of a pixel.
    fn blend(&mut self, x: i32, y: i32, colour: Rgb888, share: f32) {
        if let Some(index) = self.index(x, y) {
            let under = self.pixels[index];
            let mix =
                |a: u8, b: u8| (f32::from(a) + share * (f32::from(b) - f32::from(a))).round() as u8;
            self.pixels[index] = Rgb888::new(
                mix(under.r(), colour.r()),
                mix(under.g(), colour.g()),
                mix(under.b(), colour.b()),
            );
        }
    }

    fn fill(&mut self, area: Area, colour: Rgb888) {
        for y in area.top..area.bottom() {
            for x in area.left..area.right() {
                self.put(x, y, colour);
            }
        }
    }

    /// A thin line around an area, outside it.
    fn frame(&mut self, area: Area) {
        let outer = area.grown(1);
        self.fill(Area { height: 1, ..outer }, DARK);
        self.fill(Area { top: area.bottom(), height: 1, ..outer }, DARK);
        self.fill(Area { width: 1, ..outer }, DARK);
        self.fill(Area { left: area.right(), width: 1, ..outer }, DARK);
    }

    /// A tip on the end of a colour bar, its base on row `base`, pointing up (−1) or down (1).
    fn tip(&mut self, bar: Area, base: i32, way: i32, colour: Rgb888) {
        for i in 0..TIP - 2 {
            let inset = i * bar.width / (2 * (TIP - 2));
            let line = Area {
                left: bar.left + inset,
                top: base + way * i,
                width: bar.width - 2 * inset,
                height: 1,
            };
            self.fill(Area { left: line.left - 1, width: line.width + 2, ..line }, DARK);
            self.fill(line, colour);
        }
    }

    fn ink(&mut self, stencil: &Stencil, colour: Rgb888) {
        let area = stencil.area;
        for y in area.top..area.bottom() {
            for x in area.left..area.right() {
                self.blend(x, y, colour, stencil.covered[stencil.index(x, y)]);
            }
        }
    }

    fn marker(&mut self, shape: Shape, centre: Point2, ink: Ink) {
        let reach = (1.3 * MARKER + HALO) as i32 + 2;
        let (x0, y0) = (centre.0 as i32, centre.1 as i32);
        for (halo, colour) in [(HALO, ink.rim()), (0.0, ink.rgb())] {
            for y in y0 - reach..=y0 + reach {
                for x in x0 - reach..=x0 + reach {
                    let off = (x as f32 + 0.5 - centre.0, y as f32 + 0.5 - centre.1);
                    self.blend(x, y, colour, share(off_shape(shape, off) - halo));
                }
            }
        }
    }

    fn text(&mut self, font: &MonoFont<'_>, text: &str, at: (i32, i32), colour: Rgb888) {
        write_text(self, font, text, Point::new(at.0, at.1), colour);
    }

    /// White text with a dark rim: readable on any colour.
    fn haloed(&mut self, text: &str, at: (i32, i32)) {
        let rim = (-2i32..=2).flat_map(|y| (-2i32..=2).map(move |x| (x, y)));
        for (x, y) in rim.filter(|(x, y)| x * x + y * y <= 5) {
            self.text(LABEL, text, (at.0 + x, at.1 + y), DARK);
        }
        self.text(LABEL, text, at, WHITE);
    }

    /// Text that runs upwards from `at`, its bottom left corner when turned.
    fn upright(&mut self, font: &MonoFont<'_>, text: &str, at: (i32, i32), colour: Rgb888) {
        write_text(&mut Upright { canvas: self, at }, font, text, Point::zero(), colour);
    }

    fn write(&self, path: &Path) -> anyhow::Result<()> {
        let mut file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        // Here, where an error can still be told; a dropped buffer would swallow it.
        file.flush()?;
        Ok(())
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(at, colour) in pixels {
            self.put(at.x, at.y, colour);
        }
        Ok(())
    }
}

/// A canvas turned a quarter to the left about a point of it.
struct Upright<'c> {
    canvas: &'c mut Canvas,
    at: (i32, i32),
}

impl OriginDimensions for Upright<'_> {
    fn size(&self) -> Size {
        Size::new(self.canvas.height as u32, self.canvas.width as u32)
    }
}

impl DrawTarget for Upright<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(at, colour) in pixels {
            self.canvas.put(self.at.0 + at.y, self.at.1 - 1 - at.x, colour);
        }
        Ok(())
    }
}

fn write_text<D>(target: &mut D, font: &MonoFont<'_>, text: &str, at: Point, colour: Rgb888)
where
    D: DrawTarget<Color = Rgb888, Error = Infallible>,
{
    let style = MonoTextStyle::new(font, colour);
    let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(target);
}

#[cfg(test)]
mod tests {
    use wisdom_grid::GridSpec;

    use super::*;

    fn ramp(rows: usize, cols: usize) -> Raster<f32> {
        let spec = GridSpec::new(rows, cols, 1.0).unwrap();
        Raster::from_fn(spec, |cell| (cell.row * cols + cell.col) as f32)
    }

    fn laid_out(figure: &Figure<'_>) -> Layout {
        figure.layout(figure.span())
    }

    /// The pixel in the middle of a cell.
    fn pixel(figure: &Figure<'_>, cell: Cell) -> Rgb888 {
        let (x, y) = laid_out(figure).centre(cell);
        let canvas = figure.draw().unwrap();
        canvas.pixels[canvas.index(x as i32, y as i32).unwrap()]
    }

    fn rgb(colour: colorous::Color) -> Rgb888 {
        Rgb888::new(colour.r, colour.g, colour.b)
    }

    fn stars(name: &str, at: Vec<(Cell, String)>) -> Markers {
        Markers { name: name.to_owned(), shape: Shape::Star, ink: Ink::White, at }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let ends = [(0.0, 348.0), (-4523.4, -4448.1), (0.488, 1.0), (1.0, 101.0), (-1e-7, 3e-7)];
        for ((low, high), most) in ends.into_iter().flat_map(|e| (1..=10).map(move |m| (e, m))) {
            let (step, values) = ticks(low, high, most, 0.0);
            let lead = step / 10f64.powf(step.log10().floor());
            assert!([1.0, 2.0, 5.0, 10.0].iter().any(|n| (lead - n).abs() < 1e-6), "{step}");
            assert!(values.len() <= most + 1, "{low} to {high}: {values:?}");
            for value in values {
                assert!(value >= low - step * 1e-6 && value <= high + step * 1e-6, "{value}");
                assert!((value / step - (value / step).round()).abs() < 1e-6, "{value}");
            }
        }
    }

    #[test]
    fn ten_steps_show_the_range_from_end_to_end() {
        let (step, values) = ticks(0.0, 1.0, 10, 0.0);
        let texts: Vec<_> = values.iter().map(|&value| number(value, step, 1.0)).collect();
        let all = ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1.0"];
        assert_eq!(texts, all);
    }

    #[test]
    fn numbers_too_large_or_small_to_read_are_written_with_an_exponent() {
        assert_eq!(number(2.5e8, 5e7, 3e8), "2.5e8");
        assert_eq!(number(-3e-7, 1e-7, 4e-7), "-3e-7");
        assert_eq!(number(-1e-17, 0.1, 1.0), "0");
    }

    #[test]
    fn counted_axes_put_one_at_the_south_west_cell() {
        let raster = ramp(4, 4);
        let figure = Figure::new("", &raster, ColourMap::Grey).axes(Axes::Counted);
        let layout = laid_out(&figure);
        let (x, y) = layout.centre(Cell::new(3, 0));
        let (right, down) = (x as i32 - layout.map.left, y as i32 - layout.map.top);
        assert_eq!(layout.x_ticks[0], Tick { at: right, text: "1".to_owned() });
        assert_eq!(layout.y_ticks[0], Tick { at: down, text: "1".to_owned() });
        assert_eq!(layout.x_ticks.last().unwrap().text, "4");
    }

    #[test]
    fn metric_axes_put_zero_at_the_outer_south_west_corner() {
        let raster = Raster::filled(GridSpec::new(100, 100, 0.5).unwrap(), 0.0);
        let layout = laid_out(&Figure::new("", &raster, ColourMap::Grey));
        assert_eq!(layout.x_ticks[0], Tick { at: 0, text: "0".to_owned() });
        assert_eq!(layout.y_ticks[0], Tick { at: 799, text: "0".to_owned() });
        let ten_m = layout.x_ticks.iter().find(|tick| tick.text == "10").unwrap();
        assert_eq!(ten_m.at, 160);
        let top = layout.y_ticks.iter().find(|tick| tick.text == "50").unwrap();
        assert_eq!(top.at, 0);
    }

    #[test]
    fn numbers_beside_each_other_never_touch() {
        for (rows, cols) in [(348, 337), (3, 700), (2500, 40), (101, 101)] {
            let raster = ramp(rows, cols);
            for axes in [Axes::Metres, Axes::Counted] {
                let layout = laid_out(&Figure::new("", &raster, ColourMap::Grey).axes(axes));
                for pair in layout.x_ticks.windows(2) {
                    let half = |tick: &Tick| width(BODY, &tick.text) / 2;
                    assert!(pair[0].at + half(&pair[0]) + 8 < pair[1].at - half(&pair[1]));
                }
                for pair in layout.y_ticks.windows(2) {
                    assert!(pair[0].at - pair[1].at > line_height(BODY) + 8);
                }
            }
        }
    }

    #[test]
    fn a_known_cell_has_the_colour_of_its_value() {
        let raster = ramp(5, 5);
        let figure = Figure::new("ramp", &raster, ColourMap::Viridis);
        let t = 7.0 / 24.0;
        assert_eq!(pixel(&figure, Cell::new(1, 2)), rgb(colorous::VIRIDIS.eval_continuous(t)));
        let fixed = figure.range(0.0, 14.0);
        assert_eq!(pixel(&fixed, Cell::new(1, 2)), rgb(colorous::VIRIDIS.eval_continuous(0.5)));
        assert_eq!(pixel(&fixed, Cell::new(4, 4)), rgb(colorous::VIRIDIS.eval_continuous(1.0)));
    }

    #[test]
    fn zero_is_the_middle_of_the_diverging_colours() {
        let raster = ramp(3, 3).map(|value| value - 2.0);
        let figure = Figure::new("", &raster, ColourMap::Diverging);
        assert_eq!(pixel(&figure, Cell::new(0, 2)), rgb(colorous::RED_BLUE.eval_continuous(0.5)));
    }

    #[test]
    fn an_unknown_cell_is_hatched_and_does_not_stretch_the_range() {
        let raster = ramp(3, 3);
        let known = raster.map(|&value| value < 8.0);
        let figure = Figure::new("", &raster, ColourMap::Grey).known(&known);
        assert!([UNKNOWN, UNKNOWN_STRIPE].contains(&pixel(&figure, Cell::new(2, 2))));
        assert_eq!(figure.span(), Span { low: 0.0, high: 7.0, under: false, over: false });
        assert!(figure.legend_keys().contains(&(Key::Unknown, "not known".to_owned())));
        assert!(Figure::new("", &raster, ColourMap::Grey).legend_keys().is_empty());
    }

    #[test]
    fn classes_have_their_own_colours_and_what_is_no_class_is_unknown() {
        let raster = ramp(1, 4);
        let figure = Figure::new("", &raster, ColourMap::Classes(3)).class_names(&["", "sand"]);
        assert_eq!(pixel(&figure, Cell::new(0, 1)), rgb(colorous::TABLEAU10[1]));
        assert!([UNKNOWN, UNKNOWN_STRIPE].contains(&pixel(&figure, Cell::new(0, 3))));
        assert_eq!(figure.class_list(3), [(1, "sand".to_owned()), (2, "2".to_owned())]);
    }

    #[test]
    fn shadow_darkens_and_light_keeps_the_colour() {
        let raster = ramp(1, 2);
        let shade = Raster::from_vec(raster.spec(), vec![1.0, 0.0]).unwrap();
        let figure = Figure::new("", &raster, ColourMap::Viridis).hillshade(&shade);
        let full = rgb(colorous::VIRIDIS.eval_continuous(1.0));
        assert_eq!(pixel(&figure, Cell::new(0, 0)), rgb(colorous::VIRIDIS.eval_continuous(0.0)));
        assert_eq!(pixel(&figure, Cell::new(0, 1)).r(), (f32::from(full.r()) * 0.4).round() as u8);
    }

    #[test]
    fn labels_stay_inside_the_map_and_off_each_other() {
        let raster = ramp(101, 101);
        let edges = [0, 7, 14, 50, 93, 100];
        let at = edges
            .iter()
            .flat_map(|&row| edges.iter().map(move |&col| Cell::new(row, col)))
            .map(|cell| (cell, format!("G{}-{}", cell.row, cell.col)))
            .collect();
        let figure = Figure::new("", &raster, ColourMap::Grey).markers(stars("goals", at));
        let layout = laid_out(&figure);
        let labels = figure.place_labels(&layout, &Stencil::empty(layout.map));
        assert_eq!(labels.len(), 36);
        for (i, label) in labels.iter().enumerate() {
            assert_eq!(label.area.overlap(layout.map), label.area.width * label.area.height);
            assert!(
                labels[..i].iter().all(|other| other.area.overlap(label.area) == 0),
                "{label:?}"
            );
        }
    }

    #[test]
    fn a_label_longer_than_a_narrow_map_stays_inside_the_picture_and_off_the_colour_bar() {
        let raster = ramp(500, 4);
        let long = "a label that is much longer than anyone should write".to_owned();
        let figure = Figure::new("", &raster, ColourMap::Grey)
            .markers(stars("", vec![(Cell::new(0, 0), long.clone()), (Cell::new(499, 3), long)]));
        let layout = laid_out(&figure);
        for label in figure.place_labels(&layout, &Stencil::empty(layout.map)) {
            assert!(label.area.left >= 0 && label.area.right() <= layout.bar.left);
            assert!(label.area.top >= 0 && label.area.bottom() <= layout.height);
            assert!(label.text.ends_with(".."));
        }
    }

    #[test]
    fn a_label_keeps_off_a_track_when_it_can() {
        let raster = ramp(100, 100);
        let cells = (50..90).map(|col| Cell::new(50, col)).collect();
        let figure = Figure::new("", &raster, ColourMap::Grey)
            .markers(stars("", vec![(Cell::new(50, 50), "rover".to_owned())]))
            .track(Track { name: String::new(), cells, stroke: Stroke::Solid, ink: Ink::White });
        let layout = laid_out(&figure);
        let drawn = figure.draw_tracks(&mut Canvas::blank(layout.width, layout.height), &layout);
        let labels = figure.place_labels(&layout, &drawn);
        assert!(labels[0].area.right() < layout.centre(Cell::new(50, 50)).0 as i32);
    }

    #[test]
    fn tracks_and_markers_show_their_ink() {
        let raster = ramp(100, 100);
        let cells: Vec<_> = (10..90).map(|col| Cell::new(20, col)).collect();
        let track =
            |stroke| Track { name: String::new(), cells: cells.clone(), stroke, ink: Ink::Orange };
        let inked = |stroke| {
            let figure = Figure::new("", &raster, ColourMap::Grey).track(track(stroke));
            let canvas = figure.draw().unwrap();
            canvas.pixels.iter().filter(|&&pixel| pixel == Ink::Orange.rgb()).count()
        };
        let (solid, dashed) = (inked(Stroke::Solid), inked(Stroke::Dashed));
        assert!(solid > 600 && dashed > solid / 3 && dashed < 4 * solid / 5, "{solid}, {dashed}");
        for shape in [Shape::Circle, Shape::Cross, Shape::Triangle, Shape::Star, Shape::Square] {
            let at = vec![(Cell::new(60, 60), String::new())];
            let markers = Markers { name: String::new(), shape, ink: Ink::Vermilion, at };
            let figure = Figure::new("", &raster, ColourMap::Grey).markers(markers);
            assert_eq!(pixel(&figure, Cell::new(60, 60)), Ink::Vermilion.rgb(), "{shape:?}");
        }
    }

    #[test]
    fn every_part_of_the_legend_lies_inside_the_picture() {
        let raster = ramp(30, 20);
        let mut figure = Figure::new("", &raster, ColourMap::Grey);
        for i in 0..9 {
            figure = figure.markers(stars(&format!("a kind of goal, number {i}"), Vec::new()));
        }
        figure = figure.markers(stars(&"long ".repeat(60), Vec::new()));
        let layout = laid_out(&figure);
        assert_eq!(layout.legend.len(), 10);
        for entry in &layout.legend {
            assert!(entry.left + SWATCH.0 + 8 + width(BODY, &entry.name) <= layout.width);
            assert!(entry.top >= layout.map.bottom() && entry.top + ROW <= layout.height);
        }
    }

    #[test]
    fn one_cell_is_a_figure() {
        let raster = ramp(1, 1);
        let figure = Figure::new("one", &raster, ColourMap::Cividis).axes(Axes::Counted);
        assert_eq!(pixel(&figure, Cell::new(0, 0)), rgb(colorous::CIVIDIS.eval_continuous(0.5)));
        assert_eq!(laid_out(&figure).map.width, 800);
    }

    #[test]
    fn a_constant_raster_lies_in_the_middle_of_its_bar() {
        for value in [0.0, -4500.0, 3e20, 1e-30] {
            let raster = ramp(3, 3).map(|_| value);
            for map in [ColourMap::Grey, ColourMap::Viridis] {
                let span = Figure::new("", &raster, map).span();
                let t = (f64::from(value) - span.low) / (span.high - span.low);
                assert!((t - 0.5).abs() < 1e-6, "{value} at {t}");
                assert!(!Figure::new("", &raster, map).draw().unwrap().pixels.is_empty());
            }
        }
    }

    #[test]
    fn a_raster_with_nothing_known_is_all_hatch() {
        let raster = ramp(2, 2).map(|_| f32::NAN);
        for map in [ColourMap::Viridis, ColourMap::Diverging, ColourMap::Classes(0)] {
            let seen = pixel(&Figure::new("", &raster, map), Cell::new(1, 1));
            assert!([UNKNOWN, UNKNOWN_STRIPE].contains(&seen));
        }
    }

    #[test]
    fn a_large_raster_shows_every_nth_cell() {
        let raster = ramp(30, 3000);
        let layout = laid_out(&Figure::new("", &raster, ColourMap::Grey));
        assert_eq!((layout.map.width, layout.map.height), (1000, 10));
        assert_eq!(layout.scale.cell(&raster, 999, 9), Cell::new(28, 2998));
        assert_eq!(Scale::of(348), Scale { zoom: 2, shrink: 1 });
        assert_eq!(Scale::of(101), Scale { zoom: 8, shrink: 1 });
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_by_name() {
        let (raster, other) = (ramp(3, 3), ramp(3, 4));
        let figure = || Figure::new("", &raster, ColourMap::Grey);
        let told = |figure: Figure<'_>| figure.draw().unwrap_err().to_string();
        assert!(told(figure().hillshade(&other)).contains("hillshade has 3 x 4 cells"));
        assert!(told(figure().range(1.0, 1.0)).contains("range from 1 to 1"));
        assert!(told(figure().range(f64::NAN, 1.0)).contains("range from NaN"));
        let off = stars("goal", vec![(Cell::new(3, 0), String::new())]);
        assert!(told(figure().markers(off)).contains("`goal` at (row 3, col 0)"));
    }

    #[test]
    fn the_file_reads_back_as_the_picture() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        let raster = ramp(20, 30);
        let figure = Figure::new("Bel(I) − 0.5 ≤ ∩", &raster, ColourMap::Cividis);
        figure.save(&path).unwrap();
        let file = std::io::BufReader::new(File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let drawn = figure.draw().unwrap();
        let want: Vec<u8> = drawn.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
        assert_eq!(bytes, want);
    }

    #[test]
    fn an_error_names_the_file() {
        let raster = ramp(2, 2);
        let path = Path::new("no such folder/map.png");
        let error = Figure::new("", &raster, ColourMap::Grey).save(path).unwrap_err();
        assert!(format!("{error:#}").contains("no such folder/map.png"), "{error:#}");
    }

    #[test]
    fn text_is_spelt_in_the_signs_that_the_fonts_have() {
        assert_eq!(latin("m(I ∩ NI) − 5 °, u ≤ 1 → λ"), "m(I & NI) - 5 °, u <= 1 -> ?");
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(fit("abcdef", 4), "ab..");
    }
}
