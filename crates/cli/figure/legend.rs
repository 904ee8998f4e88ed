//! The legend below a figure.

use embedded_graphics::pixelcolor::Rgb888;

use super::canvas::{Area, Canvas};
use super::colour::{DARK, Ink, WHITE, hatch, lit};
use super::marks::{Shape, Stroke, pieces, stroke};
use super::text::{BODY, advance, fit, width};
use super::{GAP, MARGIN};

/// Width and height of a swatch in a legend, pixels.
pub(super) const SWATCH: (i32, i32) = (28, 15);

/// Height of a row of a legend, pixels.
pub(super) const ROW: i32 = 24;

/// What a row of the legend shows beside its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Key {
    Track(Stroke, Ink),
    Marker(Shape, Ink),
    Unknown,
    /// An area of one colour.
    Fill(Rgb888),
    /// Light that goes over into shadow.
    Shading,
}

/// A key and its name in their place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) key: Key,
    pub(super) name: String,
    pub(super) left: i32,
    pub(super) top: i32,
}

impl Entry {
    pub(super) fn draw(&self, canvas: &mut Canvas) {
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
            Key::Fill(colour) => {
                canvas.fill(swatch, colour);
                canvas.frame(swatch);
            }
            Key::Shading => {
                for x in 0..swatch.width {
                    let light = 1.0 - x as f32 / (swatch.width - 1) as f32;
                    let column = Area { left: swatch.left + x, width: 1, ..swatch };
                    canvas.fill(column, lit(WHITE, light));
                }
                canvas.frame(swatch);
            }
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
pub(super) fn legend(keys: Vec<(Key, String)>, left: i32, top: i32, width: i32) -> Vec<Entry> {
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
