//! What a chart is made of, and its pixels.

use std::fs;
use std::path::{Path, PathBuf};

use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::pixelcolor::Rgb888;

use crate::figure::canvas::{Area, Canvas, Point2};
use crate::figure::colour::{DARK, Ink};
use crate::figure::marks::{Stroke, pieces};
use crate::figure::text::{BODY, TITLE, advance, latin, line_height, width, wrap};

use super::{GAP, MARGIN, TICK, svg};

/// Lines that help to read a value off an axis.
const GRID: Rgb888 = Rgb888::new(228, 228, 230);

/// What is there but says little.
const MUTED: Rgb888 = Rgb888::new(168, 168, 174);

/// The colours of a chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tint {
    /// Text, axes.
    Dark,
    /// Lines that help to read a value.
    Grid,
    /// The data.
    Data,
    /// Areas of the data.
    Pale,
    /// What is passed over.
    Muted,
    /// The page.
    White,
    /// What is to be noticed.
    Alert,
    /// The run at that place among several.
    Run(usize),
}

/// Colours of runs that readers with colour vision deficiency can tell apart (Okabe and Ito, 2008).
const RUNS: [Ink; 6] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Purple, Ink::SkyBlue, Ink::Black];

impl Tint {
    pub(super) fn rgb(self) -> Rgb888 {
        match self {
            Self::Dark => DARK,
            Self::Grid => GRID,
            Self::Data => Ink::Blue.rgb(),
            Self::Pale => Ink::SkyBlue.rgb(),
            Self::Muted => MUTED,
            Self::White => Ink::White.rgb(),
            Self::Alert => Ink::Vermilion.rgb(),
            Self::Run(place) => RUNS[place % RUNS.len()].rgb(),
        }
    }
}

/// How large text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// The title.
    Title,
    /// Everything else.
    Body,
}

impl Size {
    pub(super) fn font(self) -> &'static MonoFont<'static> {
        match self {
            Self::Title => TITLE,
            Self::Body => BODY,
        }
    }
}

/// Text in its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Words {
    pub(super) text: String,
    pub(super) size: Size,
    /// The room it takes.
    pub(super) area: Area,
    /// Turned to run upwards.
    pub(super) upright: bool,
}

/// One thing drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Mark {
    /// Round-ended lines, from the middle to either side `half` wide.
    Lines { pieces: Vec<(Point2, Point2)>, half: f32, tint: Tint },
    /// A rectangle.
    Fill { area: Area, tint: Tint },
    /// A disc with a thin white rim.
    Dot { centre: Point2, radius: f32, tint: Tint },
    /// Dark text.
    Text(Words),
}

/// A chart laid out: marks in pixels, later ones on top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    pub(super) width: i32,
    pub(super) height: i32,
    pub(super) title: String,
    pub(super) marks: Vec<Mark>,
}

/// Pixels of a PNG to one of the drawing, a side: lines and text stay sharp on fine screens.
const SCALE: i32 = 2;

/// Rim of a disc, pixels.
pub(super) const RIM: f32 = 1.0;

impl Drawing {
    /// A white page with a title and remarks at its top, and the first free row below them; its height is set once
    /// the rest is there.
    pub(super) fn begin(page: i32, title: &str, remarks: &[String]) -> (Self, i32) {
        let mut drawing =
            Self { width: page, height: 0, title: title.to_owned(), marks: Vec::new() };
        let mut top = MARGIN;
        let titles = [(Size::Title, title)];
        let remarks = remarks.iter().map(|remark| (Size::Body, remark.as_str()));
        for (size, text) in titles.into_iter().chain(remarks) {
            let font = size.font();
            for line in wrap(text, ((page - 2 * MARGIN) / advance(font)).max(1) as usize) {
                drawing.text_at(size, &line, MARGIN, top);
                top += line_height(font) + 3;
            }
        }
        (drawing, top + GAP)
    }

    /// Text from its upper left corner.
    pub(super) fn text_at(&mut self, size: Size, text: &str, left: i32, top: i32) {
        let font = size.font();
        let area = Area { left, top, width: long(font, text), height: line_height(font) };
        self.marks.push(Mark::Text(Words { text: text.to_owned(), size, area, upright: false }));
    }

    /// Text about the middle of its upper edge.
    pub(super) fn text_below(&mut self, text: &str, middle: i32, top: i32) {
        self.text_at(Size::Body, text, middle - long(BODY, text) / 2, top);
    }

    /// Text that ends at `right`, about the row `middle`.
    pub(super) fn text_before(&mut self, text: &str, right: i32, middle: i32) {
        let top = middle - line_height(BODY) / 2;
        self.text_at(Size::Body, text, right - long(BODY, text), top);
    }

    /// Text that begins at `left`, about the row `middle`.
    pub(super) fn text_after(&mut self, text: &str, left: i32, middle: i32) {
        self.text_at(Size::Body, text, left, middle - line_height(BODY) / 2);
    }

    /// Text that runs upwards about the row `middle`.
    pub(super) fn text_upright(&mut self, text: &str, left: i32, middle: i32) {
        let length = long(BODY, text);
        let area =
            Area { left, top: middle - length / 2, width: line_height(BODY), height: length };
        let text = text.to_owned();
        self.marks.push(Mark::Text(Words { text, size: Size::Body, area, upright: true }));
    }

    pub(super) fn fill(&mut self, area: Area, tint: Tint) {
        self.marks.push(Mark::Fill { area, tint });
    }

    pub(super) fn dot(&mut self, centre: Point2, radius: f32, tint: Tint) {
        self.marks.push(Mark::Dot { centre, radius, tint });
    }

    pub(super) fn line(&mut self, from: Point2, to: Point2, half: f32, tint: Tint) {
        self.marks.push(Mark::Lines { pieces: vec![(from, to)], half, tint });
    }

    pub(super) fn dashed(&mut self, from: Point2, to: Point2, half: f32, tint: Tint) {
        let pieces = pieces(&[from, to], Stroke::Dashed);
        self.marks.push(Mark::Lines { pieces, half, tint });
    }

    /// A thin dark line around an area, on its outermost pixels.
    pub(super) fn frame(&mut self, area: Area) {
        for side in [
            Area { height: 1, ..area },
            Area { top: area.bottom() - 1, height: 1, ..area },
            Area { width: 1, ..area },
            Area { left: area.right() - 1, width: 1, ..area },
        ] {
            self.fill(side, Tint::Dark);
        }
    }

    /// A tick below an area, at a column of it.
    pub(super) fn tick_below(&mut self, area: Area, column: i32) {
        let tick = Area { left: area.left + column, top: area.bottom(), width: 1, height: TICK };
        self.fill(tick, Tint::Dark);
    }

    /// A tick to the left of an area, at a row of it.
    pub(super) fn tick_before(&mut self, area: Area, row: i32) {
        let tick = Area { left: area.left - TICK, top: area.top + row, width: TICK, height: 1 };
        self.fill(tick, Tint::Dark);
    }

    /// Writes `NAME.svg` and `NAME.png` into a folder that is there; returns their paths.
    ///
    /// # Errors
    /// If a file cannot be written; what was there before is kept then.
    pub(crate) fn write(&self, folder: &Path, name: &str) -> anyhow::Result<[PathBuf; 2]> {
        let [svg, png] = ["svg", "png"].map(|kind| folder.join(format!("{name}.{kind}")));
        let part = folder.join(format!("{name}.svg.part"));
        fs::write(&part, svg::text(self))?;
        fs::rename(&part, &svg)?;
        self.canvas().write(&png)?;
        Ok([svg, png])
    }

    fn canvas(&self) -> Canvas {
        let mut canvas = Canvas::blank(SCALE * self.width, SCALE * self.height);
        let wide = SCALE as f32;
        let scaled = |(x, y): Point2| (wide * x, wide * y);
        for mark in &self.marks {
            match mark {
                Mark::Lines { pieces, half, tint } => {
                    for (from, to) in pieces {
                        canvas.line(scaled(*from), scaled(*to), wide * half, tint.rgb());
                    }
                }
                Mark::Fill { area, tint } => canvas.fill(area.scaled(SCALE), tint.rgb()),
                Mark::Dot { centre, radius, tint } => {
                    // A line of no length and round ends is a disc.
                    let centre = scaled(*centre);
                    canvas.line(centre, centre, wide * (radius + RIM), Ink::White.rgb());
                    canvas.line(centre, centre, wide * radius, tint.rgb());
                }
                Mark::Text(Words { text, size, area, upright }) => {
                    let (font, text) = (size.font(), latin(text));
                    // The fonts have one size, so their signs are drawn in it and then enlarged.
                    let mut written = Canvas::blank(area.width.max(1), area.height.max(1));
                    if *upright {
                        written.upright(font, &text, (0, area.height), DARK);
                    } else {
                        written.text(font, &text, (0, 0), DARK);
                    }
                    canvas.stamp(&written, area.scaled(SCALE), SCALE, DARK);
                }
            }
        }
        canvas
    }
}

/// How long a text is, as the fonts spell it.
pub(super) fn long(font: &MonoFont<'_>, text: &str) -> i32 {
    width(font, &latin(text))
}

#[cfg(test)]
impl Drawing {
    /// Checks that all marks are on the page and that no two texts overlap.
    pub(super) fn check(&self) {
        let page = Area { left: 0, top: 0, width: self.width, height: self.height };
        let inside = |area: Area| area.overlap(page) == area.width * area.height;
        let mut texts: Vec<&Words> = Vec::new();
        for mark in &self.marks {
            match mark {
                Mark::Text(words) => {
                    assert!(inside(words.area), "{words:?}");
                    for other in &texts {
                        assert_eq!(words.area.overlap(other.area), 0, "{words:?} {other:?}");
                    }
                    texts.push(words);
                }
                Mark::Fill { area, .. } => assert!(inside(*area), "{mark:?}"),
                Mark::Dot { centre, radius, .. } => {
                    assert!(centre.0 - radius > 0.0 && centre.0 + radius < self.width as f32);
                    assert!(centre.1 - radius > 0.0 && centre.1 + radius < self.height as f32);
                }
                Mark::Lines { pieces, .. } => {
                    for (x, y) in pieces.iter().flat_map(|(a, b)| [a, b]) {
                        assert!((0.0..=self.width as f32).contains(x), "{mark:?}");
                        assert!((0.0..=self.height as f32).contains(y), "{mark:?}");
                    }
                }
            }
        }
    }

    /// Every text, in the order of drawing.
    pub(super) fn texts(&self) -> Vec<&str> {
        let mut texts = Vec::new();
        for mark in &self.marks {
            if let Mark::Text(words) = mark {
                texts.push(words.text.as_str());
            }
        }
        texts
    }
}
