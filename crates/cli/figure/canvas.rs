//! The pixels of a figure, and what is drawn on them.

use std::convert::Infallible;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use embedded_graphics::{
    mono_font::{MonoFont, MonoTextStyle},
    pixelcolor::Rgb888,
    prelude::*,
    text::{Baseline, Text},
};

use super::colour::{DARK, Ink, WHITE};
use super::marks::{HALO, MARKER, Shape, off_shape};
use super::text::LABEL;

/// Height of the tip that says "values go on beyond the bar", pixels.
pub(super) const TIP: i32 = 12;

pub(crate) type Point2 = (f32, f32);

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl Area {
    /// The first column to the right of it.
    pub(crate) fn right(self) -> i32 {
        self.left + self.width
    }

    /// The first row below it.
    pub(crate) fn bottom(self) -> i32 {
        self.top + self.height
    }

    pub(super) fn grown(self, by: i32) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2 * by,
            height: self.height + 2 * by,
        }
    }

    /// Moved no further than needed to lie in `room` (at its north-west if larger than it).
    pub(super) fn pushed_into(self, room: Self) -> Self {
        Self {
            left: self.left.min(room.right() - self.width).max(room.left),
            top: self.top.min(room.bottom() - self.height).max(room.top),
            ..self
        }
    }

    /// The same area in pixels of which so many go into one of its own, a side.
    pub(crate) fn scaled(self, by: i32) -> Self {
        Self {
            left: by * self.left,
            top: by * self.top,
            width: by * self.width,
            height: by * self.height,
        }
    }

    /// The least rectangle around both.
    pub(super) fn with(self, other: Self) -> Self {
        let (left, top) = (self.left.min(other.left), self.top.min(other.top));
        Self {
            left,
            top,
            width: self.right().max(other.right()) - left,
            height: self.bottom().max(other.bottom()) - top,
        }
    }

    /// Pixels in both.
    pub(crate) fn overlap(self, other: Self) -> i32 {
        let across = self.right().min(other.right()) - self.left.max(other.left);
        let down = self.bottom().min(other.bottom()) - self.top.max(other.top);
        across.max(0) * down.max(0)
    }
}

/// How much of each pixel of an area is covered, so that lines that touch are drawn once.
#[derive(Debug)]
pub(super) struct Stencil {
    pub(super) area: Area,
    pub(super) covered: Vec<f32>,
}

impl Stencil {
    pub(super) fn empty(area: Area) -> Self {
        Self { area, covered: vec![0.0; (area.width * area.height) as usize] }
    }

    pub(super) fn index(&self, x: i32, y: i32) -> usize {
        ((y - self.area.top) * self.area.width + x - self.area.left) as usize
    }

    /// Covers a round-ended line of half width `half`.
    pub(super) fn line(&mut self, from: Point2, to: Point2, half: f32) {
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
    pub(super) fn count(&self, area: Area) -> i32 {
        let rows = area.top.max(self.area.top)..area.bottom().min(self.area.bottom());
        let cols = area.left.max(self.area.left)..area.right().min(self.area.right());
        rows.flat_map(|y| cols.clone().map(move |x| (x, y)))
            .map(|(x, y)| i32::from(self.covered[self.index(x, y)] > 0.5))
            .sum()
    }
}

/// Share of a pixel inside an outline, from the signed distance of its middle (negative inside).
pub(super) fn share(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

/// Distance of a point from a line piece.
pub(super) fn off_line(from: Point2, to: Point2, point: Point2) -> f32 {
    let (along, off) = ((to.0 - from.0, to.1 - from.1), (point.0 - from.0, point.1 - from.1));
    let square = along.0 * along.0 + along.1 * along.1;
    let t = if square > 0.0 { (off.0 * along.0 + off.1 * along.1) / square } else { 0.0 };
    let t = t.clamp(0.0, 1.0);
    (off.0 - t * along.0).hypot(off.1 - t * along.1)
}

/// The lines through the sides of a convex polygon: unit normal, outward, and the lines' distance from the origin.
fn outlines(corners: &[Point2]) -> Vec<[f32; 3]> {
    let count = corners.len() as f32;
    let sum = corners.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0, sum.1 + at.1));
    let middle = (sum.0 / count, sum.1 / count);
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    sides
        .filter_map(|(a, b)| {
            let along = (b.0 - a.0, b.1 - a.1);
            let length = along.0.hypot(along.1);
            let (across, down) = (along.1 / length, -along.0 / length);
            let from = across * a.0 + down * a.1;
            let side = if across * middle.0 + down * middle.1 <= from { 1.0 } else { -1.0 };
            (length > 0.0).then_some([side * across, side * down, side * from])
        })
        .collect()
}

/// The pixels of a figure.
#[derive(Debug)]
pub(crate) struct Canvas {
    pub(super) width: i32,
    pub(super) height: i32,
    pub(super) pixels: Vec<Rgb888>,
}

impl Canvas {
    pub(crate) fn blank(width: i32, height: i32) -> Self {
        Self { width, height, pixels: vec![WHITE; (width * height) as usize] }
    }

    /// Where a pixel is kept, if it is in the picture.
    pub(super) fn index(&self, x: i32, y: i32) -> Option<usize> {
        let inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        inside.then(|| (y * self.width + x) as usize)
    }

    pub(super) fn put(&mut self, x: i32, y: i32, colour: Rgb888) {
        if let Some(index) = self.index(x, y) {
            self.pixels[index] = colour;
        }
    }

    /// Lays a colour over a share of a pixel.
    pub(super) fn blend(&mut self, x: i32, y: i32, colour: Rgb888, share: f32) {
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

    pub(crate) fn fill(&mut self, area: Area, colour: Rgb888) {
        for y in area.top..area.bottom() {
            for x in area.left..area.right() {
                self.put(x, y, colour);
            }
        }
    }

    /// A thin line around an area, outside it.
    pub(super) fn frame(&mut self, area: Area) {
        let outer = area.grown(1);
        self.fill(Area { height: 1, ..outer }, DARK);
        self.fill(Area { top: area.bottom(), height: 1, ..outer }, DARK);
        self.fill(Area { width: 1, ..outer }, DARK);
        self.fill(Area { left: area.right(), width: 1, ..outer }, DARK);
    }

    /// A tip on the end of a colour bar, its base on row `base`, pointing up (−1) or down (1).
    pub(super) fn tip(&mut self, bar: Area, base: i32, way: i32, colour: Rgb888) {
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

    pub(super) fn ink(&mut self, stencil: &Stencil, colour: Rgb888) {
        let area = stencil.area;
        for y in area.top..area.bottom() {
            for x in area.left..area.right() {
                self.blend(x, y, colour, stencil.covered[stencil.index(x, y)]);
            }
        }
    }

    pub(super) fn marker(&mut self, shape: Shape, centre: Point2, ink: Ink) {
        self.marker_through(shape, centre, ink, 1.0);
    }

    /// A marker of which only a share shows through what is in front of it.
    pub(super) fn marker_through(&mut self, shape: Shape, centre: Point2, ink: Ink, shown: f32) {
        let reach = (1.6 * MARKER + HALO) as i32 + 2;
        let (x0, y0) = (centre.0 as i32, centre.1 as i32);
        for (halo, colour) in [(HALO, ink.rim()), (0.0, ink.rgb())] {
            for y in y0 - reach..=y0 + reach {
                for x in x0 - reach..=x0 + reach {
                    let off = (x as f32 + 0.5 - centre.0, y as f32 + 0.5 - centre.1);
                    self.blend(x, y, colour, shown * share(off_shape(shape, off) - halo));
                }
            }
        }
    }

    /// A line of half width `half` in one colour, without a rim.
    pub(crate) fn line(&mut self, from: Point2, to: Point2, half: f32, colour: Rgb888) {
        // Walked along its longer direction, so that a slanted line does not cost the box around it.
        let steep = (to.1 - from.1).abs() > (to.0 - from.0).abs();
        let turned = |(x, y): Point2| if steep { (y, x) } else { (x, y) };
        let (a, b) = (turned(from), turned(to));
        let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
        let slope = if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { 0.0 };
        let reach = 1.5 * half + 1.5;
        for along in (a.0 - reach).floor() as i32..=(b.0 + reach).ceil() as i32 {
            let middle = a.1 + slope * ((along as f32 + 0.5).clamp(a.0, b.0) - a.0);
            for beside in (middle - reach).floor() as i32..=(middle + reach).ceil() as i32 {
                let (x, y) = if steep { (beside, along) } else { (along, beside) };
                let off = off_line(from, to, (x as f32 + 0.5, y as f32 + 0.5));
                self.blend(x, y, colour, share(off - half));
            }
        }
    }

    /// A convex polygon in one colour.
    pub(super) fn polygon(&mut self, corners: &[Point2], colour: Rgb888) {
        let sides = outlines(corners);
        let ends = |of: fn(&Point2) -> f32| {
            let least = corners.iter().map(of).fold(f32::INFINITY, f32::min);
            let most = corners.iter().map(of).fold(f32::NEG_INFINITY, f32::max);
            (least.floor() as i32 - 1, most.ceil() as i32 + 1)
        };
        let ((left, right), (top, bottom)) = (ends(|p| p.0), ends(|p| p.1));
        for y in top.max(0)..=bottom.min(self.height - 1) {
            for x in left.max(0)..=right.min(self.width - 1) {
                let (at_x, at_y) = (x as f32 + 0.5, y as f32 + 0.5);
                let off = sides
                    .iter()
                    .map(|[across, down, from]| across * at_x + down * at_y - from)
                    .fold(f32::NEG_INFINITY, f32::max);
                self.blend(x, y, colour, share(off));
            }
        }
    }

    pub(crate) fn text(&mut self, font: &MonoFont<'_>, text: &str, at: (i32, i32), colour: Rgb888) {
        write_text(self, font, text, Point::new(at.0, at.1), colour);
    }

    /// White text with a dark rim: readable on any colour.
    pub(super) fn haloed(&mut self, text: &str, at: (i32, i32)) {
        let rim = (-2i32..=2).flat_map(|y| (-2i32..=2).map(move |x| (x, y)));
        for (x, y) in rim.filter(|(x, y)| x * x + y * y <= 5) {
            self.text(LABEL, text, (at.0 + x, at.1 + y), DARK);
        }
        self.text(LABEL, text, at, WHITE);
    }

    /// Text that runs upwards from `at`, its bottom left corner when turned.
    pub(crate) fn upright(
        &mut self,
        font: &MonoFont<'_>,
        text: &str,
        at: (i32, i32),
        colour: Rgb888,
    ) {
        write_text(&mut Upright { canvas: self, at }, font, text, Point::zero(), colour);
    }

    pub(crate) fn write(&self, path: &Path) -> anyhow::Result<()> {
        // Beside its place first: a failure leaves what was there.
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = Path::new(&part);
        let mut file = BufWriter::new(File::create(part)?);
        self.encode(&mut file)?;
        // Here, where an error can still be told; a dropped buffer would swallow it.
        file.flush()?;
        drop(file);
        std::fs::rename(part, path)?;
        Ok(())
    }

    /// Writes the picture as an RGB PNG.
    pub(super) fn encode(&self, file: impl Write) -> anyhow::Result<()> {
        let mut encoder = png::Encoder::new(file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(())
    }

    /// Copies the pixels of one colour of another picture into an area of this one, each as a square of that side.
    pub(crate) fn stamp(&mut self, other: &Self, area: Area, side: i32, colour: Rgb888) {
        for y in 0..other.height {
            for x in 0..other.width {
                if other.pixels[(y * other.width + x) as usize] == colour {
                    let (left, top) = (area.left + side * x, area.top + side * y);
                    self.fill(Area { left, top, width: side, height: side }, colour);
                }
            }
        }
    }

    /// Copies another picture into this one, its upper left corner at a place; what does not fit is left out.
    pub(super) fn paste(&mut self, other: &Self, (left, top): (i32, i32)) {
        for y in 0..other.height {
            for x in 0..other.width {
                self.put(left + x, top + y, other.pixels[(y * other.width + x) as usize]);
            }
        }
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
pub(super) struct Upright<'c> {
    pub(super) canvas: &'c mut Canvas,
    pub(super) at: (i32, i32),
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

pub(super) fn write_text<D>(
    target: &mut D,
    font: &MonoFont<'_>,
    text: &str,
    at: Point,
    colour: Rgb888,
) where
    D: DrawTarget<Color = Rgb888, Error = Infallible>,
{
    let style = MonoTextStyle::new(font, colour);
    let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(target);
}
