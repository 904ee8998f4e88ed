//! Maps as pictures: a raster seen from above, with its colours, axes, tracks and markers.
//!
//! A figure shows one layer. Each cell is a square of whole pixels in the colour of its value, and nothing is
//! interpolated: what is seen is what is in the raster. Large rasters show every n-th cell instead.

use std::path::Path;

use anyhow::{Context, ensure};
use wisdom_grid::{Cell, Raster};

use super::axis::{Axes, Tick, apart_across, apart_down, flipped};
use super::canvas::{Area, Canvas, Stencil};
use super::colour::{ColourMap, DARK, Span, hatch, lit};
use super::key::{ColourKey, Palette};
use super::legend::{Entry, Key, SWATCH, legend};
use super::marks::{
    HALO, LABEL_MOST, Label, MARKER, Markers, TRACK, Track, pieces, place_labels, stroke,
};
use super::text::{BODY, LABEL, TITLE, advance, latin, line_height, widest, width, wrap};
use super::{GAP, MARGIN, TICK};

/// The length that the longer side of a map aims at, pixels.
const MAP_SIDE: usize = 800;

/// A map never grows longer than this, pixels: beyond it only every n-th cell is drawn.
const MAP_SIDE_MOST: usize = 1200;
/// The least width of a figure and the least height of the map's row, pixels: room for title and bar.
const LEAST: (i32, i32) = (520, 180);

/// A map of one raster, to be saved as a picture.
///
/// Text is drawn in Latin-1; a few signs are spelt in it (`−` as `-`, `≤` as `<=`, `∩` as `&`, `∪` as `|`), and any other
/// character becomes `?`.
#[derive(Debug, Clone)]
pub(crate) struct Figure<'a> {
    title: String,
    layer: &'a Raster<f32>,
    palette: Palette,
    axes: Axes,
    hillshade: Option<&'a Raster<f32>>,
    /// What the hillshade is, in the legend; not there if empty.
    shading: String,
    /// Whether the colours are explained beside the map.
    keyed: bool,
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
            palette: Palette::new(map),
            axes: Axes::Metres,
            hillshade: None,
            shading: String::new(),
            keyed: true,
            known: None,
            tracks: Vec::new(),
            markers: Vec::new(),
        }
    }

    /// Says beside the colours what they show, with its unit.
    pub(crate) fn value_label(mut self, label: &str) -> Self {
        self.palette.label = latin(label);
        self
    }

    /// Names the classes of [`ColourMap::Classes`] in order; a class without a name goes by its number, one with an
    /// empty name is left out of the legend.
    pub(crate) fn class_names(mut self, names: &[&str]) -> Self {
        self.palette.name_classes(names);
        self
    }

    /// Fixes the values at the ends of the colour bar, so that figures can be compared; values beyond take the end's
    /// colour, and the bar says so by a tip.
    pub(crate) fn range(mut self, low: f64, high: f64) -> Self {
        self.palette.range = Some((low, high));
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

    /// Says in the legend what the hillshade shows.
    pub(crate) fn shading(mut self, what: &str) -> Self {
        self.shading = latin(what);
        self
    }

    /// Leaves out what explains the colours: another figure beside this one has it.
    pub(crate) fn without_key(mut self) -> Self {
        self.keyed = false;
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
        self.markers.push(markers.spelt());
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
    pub(super) fn draw(&self) -> anyhow::Result<Canvas> {
        self.check()?;
        let span = self.span();
        let layout = self.layout(span);
        let mut canvas = Canvas::blank(layout.width, layout.height);
        for (i, line) in (0..).zip(&layout.title) {
            canvas.text(TITLE, line, (layout.map.left, MARGIN + i * line_height(TITLE)), DARK);
        }
        self.draw_cells(&mut canvas, &layout, span);
        self.draw_axes(&mut canvas, &layout);
        if self.keyed {
            layout.key.draw(&self.palette, &mut canvas);
        }
        let drawn = self.draw_tracks(&mut canvas, &layout);
        self.draw_markers(&mut canvas, &layout);
        for label in self.place_labels(&layout, &drawn) {
            label.draw(&mut canvas);
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
        self.palette.check()
    }

    /// The value to show at a cell; none where it is not known, not finite, or no class.
    fn value(&self, cell: Cell) -> Option<f32> {
        let value = self.layer[cell];
        let known = self.known.is_none_or(|known| known[cell]);
        (known && self.palette.shows(value)).then_some(value)
    }

    /// The values at the ends of the colours, and whether the layer goes beyond.
    fn span(&self) -> Span {
        let known = self.layer.spec().cells().filter_map(|cell| self.value(cell));
        self.palette.span(known.map(f64::from))
    }

    fn draw_cells(&self, canvas: &mut Canvas, layout: &Layout, span: Span) {
        let map = layout.map;
        for y in 0..map.height {
            for x in 0..map.width {
                let cell = layout.scale.cell(self.layer, x, y);
                let colour = match self.value(cell) {
                    Some(value) => {
                        let colour = self.palette.colour(f64::from(value), span);
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

    /// Finds each label a place beside its marker, off the tracks where it can be.
    fn place_labels(&self, layout: &Layout, drawn: &Stencil) -> Vec<Label> {
        let marked: Vec<_> = self
            .markers
            .iter()
            .flat_map(|kind| &kind.at)
            .map(|(cell, text)| (layout.centre(*cell), text.as_str()))
            .collect();
        place_labels(&marked, layout.label_room, |area| drawn.count(area))
    }

    fn axis_labels(&self) -> (&'static str, &'static str) {
        self.axes.labels(self.layer.spec())
    }

    /// Ticks of an axis of `cells` cells: distance from its west or south end in pixels, and the number.
    fn axis_ticks(&self, cells: usize, scale: Scale, fits: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
        let place = |at: f64, text| Tick { at: (at * scale.pixels()) as i32, text };
        self.axes.ticks(self.layer.spec(), cells, place, fits)
    }

    /// What the legend below the map names.
    fn legend_keys(&self) -> Vec<(Key, String)> {
        let tracks = self.tracks.iter().map(|t| (Key::Track(t.stroke, t.ink), t.name.clone()));
        let kinds = self.markers.iter().map(|m| (Key::Marker(m.shape, m.ink), m.name.clone()));
        let unseen = self.layer.spec().cells().any(|cell| self.value(cell).is_none());
        let unknown = unseen.then(|| (Key::Unknown, "not known".to_owned()));
        let shading = self.hillshade.map(|_| (Key::Shading, self.shading.clone()));
        let named = tracks.chain(kinds).chain(shading).filter(|(_, name)| !name.is_empty());
        named.chain(unknown).collect()
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
        let body_height =
            map_height.max(LEAST.1).max(self.palette.least_height()).max(width(BODY, y_label));

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
        let key = self.palette.key(span, body_height);
        let key_width = if self.keyed { key.body.width } else { 0 };
        let width = (bar_left + key_width + MARGIN).max(LEAST.0);

        let title = wrap(&self.title, ((width - map_left - MARGIN) / advance(TITLE)) as usize);
        let body_top = MARGIN
            + title.len() as i32 * line_height(TITLE)
            + if title.is_empty() { line_height(BODY) / 2 } else { GAP };
        let map = Area { left: map_left, top: body_top, width: map_width, height: map_height };
        let label_room =
            Area { width: label_width, height: map_height.max(line_height(LABEL) + 6), ..map }
                .grown(-3);
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
            map,
            label_room,
            key: key.at(bar_left, body_top),
            y_label_left,
            x_ticks,
            y_ticks,
            legend,
            first: spec.first(),
        }
    }
}

/// Where everything goes, pixels.
#[derive(Debug)]
struct Layout {
    width: i32,
    height: i32,
    title: Vec<String>,
    scale: Scale,
    /// The map's north-west cell.
    first: Cell,
    body_top: i32,
    map: Area,
    label_room: Area,
    key: ColourKey,
    y_label_left: i32,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
    legend: Vec<Entry>,
}

impl Layout {
    /// The middle of a cell in the picture.
    fn centre(&self, cell: Cell) -> (f32, f32) {
        let middle = |at: usize, first: usize| {
            ((at as f64 - first as f64 + 0.5) * self.scale.pixels()) as f32
        };
        let across = middle(cell.col, self.first.col);
        (self.map.left as f32 + across, self.map.top as f32 + middle(cell.row, self.first.row))
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
        let (spec, first) = (raster.spec(), raster.spec().first());
        Cell::new(first.row + index(y, spec.rows()), first.col + index(x, spec.cols()))
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
    use wisdom_grid::GridSpec;

    use super::super::colour::{Ink, UNKNOWN, UNKNOWN_STRIPE};
    use super::super::legend::ROW;
    use super::super::marks::{Shape, Stroke, off_area};
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
        assert_eq!(figure.palette.class_list(), [(1, "sand".to_owned()), (2, "2".to_owned())]);
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
    fn a_label_no_nearer_to_its_own_marker_than_to_another_has_a_line_to_its_own() {
        let raster = ramp(101, 101);
        let near = [40, 44, 48, 52];
        let crowd: Vec<_> = near
            .iter()
            .flat_map(|&row| near.map(|col| Cell::new(row, col)))
            .map(|cell| (cell, format!("P{}-{}", cell.row, cell.col)))
            .collect();
        let figure = Figure::new("", &raster, ColourMap::Grey).markers(stars("", crowd.clone()));
        let layout = laid_out(&figure);
        let labels = figure.place_labels(&layout, &Stencil::empty(layout.map));
        let mut lines = 0;
        for (label, (cell, _)) in labels.iter().zip(&crowd) {
            let own = off_area(label.area, layout.centre(*cell));
            let others = crowd.iter().filter(|(other, _)| other != cell);
            let nearer = others
                .map(|(other, _)| off_area(label.area, layout.centre(*other)))
                .any(|other| other <= own);
            assert!(!nearer || label.leader.is_some(), "{label:?}");
            lines += usize::from(label.leader.is_some());
            if let Some((from, _)) = label.leader {
                let (x, y) = layout.centre(*cell);
                assert!((from.0 - x).hypot(from.1 - y) < MARKER + 0.01, "{label:?}");
            }
        }
        assert!(lines > 0, "so close together some label must stand away");
        let lone = Figure::new("", &raster, ColourMap::Grey)
            .markers(stars("", vec![(Cell::new(50, 50), "P1".to_owned())]));
        let labels = lone.place_labels(&laid_out(&lone), &Stencil::empty(layout.map));
        assert_eq!(labels[0].leader, None);
    }

    #[test]
    fn a_figure_without_its_key_is_narrower_and_its_map_the_same() {
        let raster = ramp(30, 30);
        let figure = || Figure::new("", &raster, ColourMap::Viridis).value_label("interest");
        let (with, without) = (laid_out(&figure()), laid_out(&figure().without_key()));
        assert!(without.width + 20 < with.width);
        assert_eq!((without.map, without.height), (with.map, with.height));
    }

    #[test]
    fn the_legend_says_what_the_shadows_are_if_there_are_any() {
        let raster = ramp(3, 3);
        let lit = |figure: &Figure<'_>| {
            figure.legend_keys().contains(&(Key::Shading, "relief".to_owned()))
        };
        assert!(lit(&Figure::new("", &raster, ColourMap::Grey)
            .hillshade(&raster)
            .shading("relief")));
        assert!(!lit(&Figure::new("", &raster, ColourMap::Grey).shading("relief")));
    }

    #[test]
    fn a_label_longer_than_a_narrow_map_stays_inside_the_picture_and_off_the_colour_bar() {
        let raster = ramp(500, 4);
        let long = "a label that is much longer than anyone should write".to_owned();
        let figure = Figure::new("", &raster, ColourMap::Grey)
            .markers(stars("", vec![(Cell::new(0, 0), long.clone()), (Cell::new(499, 3), long)]));
        let layout = laid_out(&figure);
        for label in figure.place_labels(&layout, &Stencil::empty(layout.map)) {
            assert!(label.area.left >= 0 && label.area.right() <= layout.key.bar.left);
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
        let filled = [Shape::Circle, Shape::Cross, Shape::Triangle, Shape::Star, Shape::Square];
        for shape in filled.into_iter().chain([Shape::Small]) {
            let at = vec![(Cell::new(60, 60), String::new())];
            let markers = Markers { name: String::new(), shape, ink: Ink::Vermilion, at };
            let figure = Figure::new("", &raster, ColourMap::Grey).markers(markers);
            assert_eq!(pixel(&figure, Cell::new(60, 60)), Ink::Vermilion.rgb(), "{shape:?}");
        }
    }

    #[test]
    fn a_frame_is_hollow_and_leaves_room_for_another_marker() {
        let raster = ramp(100, 100);
        let cell = Cell::new(60, 60);
        let markers = |shape, ink| {
            let at = vec![(cell, String::new())];
            Markers { name: String::new(), shape, ink, at }
        };
        let bare = Figure::new("", &raster, ColourMap::Grey);
        let framed = bare.clone().markers(markers(Shape::Frame, Ink::Vermilion));
        assert_eq!(pixel(&framed, cell), pixel(&bare, cell));
        let both = framed.markers(markers(Shape::Star, Ink::Green));
        assert_eq!(pixel(&both, cell), Ink::Green.rgb());
        let (x, y) = laid_out(&both).centre(cell);
        let canvas = both.draw().unwrap();
        let edge = canvas.index((x + 1.3 * MARKER) as i32, y as i32).unwrap();
        assert_eq!(canvas.pixels[edge], Ink::Vermilion.rgb());
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
}
