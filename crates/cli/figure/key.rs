//! What the colours of a figure mean: a colour bar with numbers, or a list of classes.

use anyhow::ensure;
use embedded_graphics::pixelcolor::Rgb888;

use super::axis::{Tick, flipped, value_ticks};
use super::canvas::{Area, Canvas, TIP};
use super::colour::{ColourMap, DARK, Span};
use super::legend::{ROW, SWATCH};
use super::text::{BODY, advance, fit, latin, line_height, widest, width, wrap};
use super::{GAP, TICK};

/// Width of the colour bar, pixels.
const BAR: i32 = 22;

/// A colour map with the range and the names that a figure gives it.
#[derive(Debug, Clone)]
pub(super) struct Palette {
    pub(super) map: ColourMap,
    /// What the values are, with their unit; Latin-1.
    pub(super) label: String,
    pub(super) class_names: Vec<String>,
    pub(super) range: Option<(f64, f64)>,
}

impl Palette {
    pub(super) fn new(map: ColourMap) -> Self {
        Self { map, label: String::new(), class_names: Vec::new(), range: None }
    }

    pub(super) fn name_classes(&mut self, names: &[&str]) {
        self.class_names = names.iter().map(|name| latin(name)).collect();
    }

    /// Refuses a range without extent.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        if let Some((low, high)) = self.range {
            ensure!(
                low < high && (high - low).is_finite(),
                "the colours range from {low} to {high}; the first must be below the second"
            );
        }
        Ok(())
    }

    /// Whether a value has a colour: finite, or one of the classes.
    pub(super) fn shows(&self, value: f32) -> bool {
        match self.map.classes() {
            Some(n) => value.round() >= 0.0 && value.round() < n as f32,
            None => value.is_finite(),
        }
    }

    /// The values at the ends of the colours, and whether the values shown go beyond.
    pub(super) fn span(&self, shown: impl Iterator<Item = f64>) -> Span {
        let (least, most) =
            shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
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
    pub(super) fn colour(&self, value: f64, span: Span) -> Rgb888 {
        self.map.colour(value, (value - span.low) / (span.high - span.low))
    }

    /// The label over the list of classes.
    fn heading(&self) -> Vec<String> {
        wrap(&self.label, 20)
    }

    /// The classes that the list names.
    pub(super) fn class_list(&self) -> Vec<(usize, String)> {
        let name = |class: usize| self.class_names.get(class).cloned();
        (0..self.map.classes().unwrap_or(0))
            .map(|class| (class, name(class).unwrap_or(class.to_string())))
            .filter(|(_, name)| !name.is_empty())
            .map(|(class, name)| (class, fit(&name, 24)))
            .collect()
    }

    /// Height that the list of classes takes, pixels; a bar takes any.
    pub(super) fn least_height(&self) -> i32 {
        if self.map.classes().is_none() {
            return 0;
        }
        let heading = self.heading().len() as i32 * (line_height(BODY) + 2);
        self.class_list().len() as i32 * ROW + GAP + heading
    }

    /// The key of a figure whose body is `height` pixels high, at the origin.
    pub(super) fn key(&self, span: Span, height: i32) -> ColourKey {
        let tips = TIP * (i32::from(span.over) + i32::from(span.under));
        let top = if span.over { TIP } else { 0 };
        let bar = Area { left: 0, top, width: BAR, height: height - tips };
        let ticks = flipped(value_ticks(span, bar.height), bar.height);
        let across = if self.map.classes().is_some() {
            let (names, heading) = (self.class_list(), self.heading());
            let names = widest(BODY, names.iter().map(|(_, name)| name.as_str()));
            (SWATCH.0 + 8 + names).max(widest(BODY, heading.iter().map(String::as_str)))
        } else {
            let label = if self.label.is_empty() { 0 } else { GAP + line_height(BODY) };
            BAR + 1 + TICK + 4 + widest(BODY, ticks.iter().map(Tick::text)) + label
        };
        ColourKey { body: Area { left: 0, top: 0, width: across, height }, bar, ticks, span }
    }
}

/// A colour bar or a list of classes in its place.
#[derive(Debug)]
pub(super) struct ColourKey {
    /// All of it.
    pub(super) body: Area,
    /// The bar alone, without the tips; of no meaning for classes.
    pub(super) bar: Area,
    ticks: Vec<Tick>,
    span: Span,
}

impl ColourKey {
    /// The same key with its body's north-west corner at a place.
    pub(super) fn at(self, left: i32, top: i32) -> Self {
        let moved = |area: Area| Area { left: area.left + left, top: area.top + top, ..area };
        Self { body: moved(self.body), bar: moved(self.bar), ..self }
    }

    pub(super) fn draw(&self, palette: &Palette, canvas: &mut Canvas) {
        if palette.map.classes().is_some() {
            self.draw_classes(palette, canvas);
        } else {
            self.draw_bar(palette, canvas);
        }
    }

    fn draw_bar(&self, palette: &Palette, canvas: &mut Canvas) {
        let (bar, span) = (self.bar, self.span);
        for y in 0..bar.height {
            let t = (f64::from(y) + 0.5) / f64::from(bar.height);
            let colour = palette.colour(span.high + t * (span.low - span.high), span);
            canvas.fill(Area { top: bar.top + y, height: 1, ..bar }, colour);
        }
        canvas.frame(bar);
        if span.over {
            canvas.tip(bar, bar.top - 2, -1, palette.colour(span.high, span));
        }
        if span.under {
            canvas.tip(bar, bar.bottom() + 1, 1, palette.colour(span.low, span));
        }
        for tick in &self.ticks {
            let y = bar.top + tick.at;
            canvas.fill(Area { left: bar.right() + 1, top: y, width: TICK, height: 1 }, DARK);
            let at = (bar.right() + 1 + TICK + 4, y - line_height(BODY) / 2);
            canvas.text(BODY, &tick.text, at, DARK);
        }
        let label = fit(&palette.label, (self.body.height / advance(BODY)) as usize);
        let up = (bar.top + i32::midpoint(bar.height, width(BODY, &label)))
            .max(self.body.top + width(BODY, &label));
        let left = bar.right() + 1 + TICK + 4 + widest(BODY, self.ticks.iter().map(Tick::text));
        canvas.upright(BODY, &label, (left + GAP, up), DARK);
    }

    fn draw_classes(&self, palette: &Palette, canvas: &mut Canvas) {
        let (left, mut top) = (self.body.left, self.body.top);
        for line in palette.heading() {
            canvas.text(BODY, &line, (left, top), DARK);
            top += line_height(BODY) + 2;
        }
        top += GAP / 2;
        for (class, name) in palette.class_list() {
            let swatch = Area { left, top, width: SWATCH.0, height: SWATCH.1 };
            canvas.fill(swatch, palette.map.colour(class as f64, 0.0));
            canvas.frame(swatch);
            canvas.text(BODY, &name, (left + SWATCH.0 + 8, top), DARK);
            top += ROW;
        }
    }
}
