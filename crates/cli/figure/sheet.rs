//! Several figures on one page.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::Figure;
use super::canvas::Canvas;

/// Figures beside and below each other, as PNG and as SVG: the latter holds the same pixels, for maps have no others.
pub(crate) struct Sheet {
    canvas: Canvas,
}

impl Sheet {
    /// Puts figures on one page, from left to right and then down, so many abreast.
    ///
    /// # Errors
    /// As [`Figure::save`], if a figure cannot be drawn.
    pub(crate) fn of(figures: &[Figure<'_>], abreast: usize) -> anyhow::Result<Self> {
        let drawn = figures.iter().map(Figure::draw).collect::<anyhow::Result<Vec<_>>>()?;
        let rows: Vec<&[Canvas]> = drawn.chunks(abreast.max(1)).collect();
        let height = |row: &[Canvas]| row.iter().map(|canvas| canvas.height).max().unwrap_or(0);
        let width = |row: &[Canvas]| row.iter().map(|canvas| canvas.width).sum::<i32>();
        let whole = (
            rows.iter().map(|row| width(row)).max().unwrap_or(1),
            rows.iter().map(|row| height(row)).sum::<i32>().max(1),
        );
        let mut canvas = Canvas::blank(whole.0, whole.1);
        let mut top = 0;
        for row in rows {
            let mut left = 0;
            for figure in row {
                canvas.paste(figure, (left, top));
                left += figure.width;
            }
            top += height(row);
        }
        Ok(Self { canvas })
    }

    /// Writes `NAME.svg` and `NAME.png` into a folder that is there; returns their paths.
    ///
    /// # Errors
    /// If a file cannot be written; what was there before is kept then.
    pub(crate) fn write(&self, folder: &Path, name: &str) -> anyhow::Result<[PathBuf; 2]> {
        let [svg, png] = ["svg", "png"].map(|kind| folder.join(format!("{name}.{kind}")));
        let told = || format!("cannot write figure {}", svg.display());
        let part = folder.join(format!("{name}.svg.part"));
        fs::write(&part, self.svg()?).with_context(told)?;
        fs::rename(&part, &svg).with_context(told)?;
        self.canvas
            .write(&png)
            .with_context(|| format!("cannot write figure {}", png.display()))?;
        Ok([svg, png])
    }

    fn svg(&self) -> anyhow::Result<String> {
        let mut bytes = Vec::new();
        self.canvas.encode(&mut bytes)?;
        let (width, height) = (self.canvas.width, self.canvas.height);
        let mut svg = String::new();
        writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <image width=\"{width}\" height=\"{height}\" xlink:href=\"data:image/png;base64,{}\"/>\n</svg>",
            base64(&bytes)
        )?;
        Ok(svg)
    }
}

/// Bytes as base64 (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let sign = SIGNS[(word >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= three.len() { char::from(sign) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use wisdom_grid::{GridSpec, Raster};

    use super::*;
    use crate::figure::ColourMap;

    #[test]
    fn base64_is_that_of_the_standard() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        let told = texts.map(|text| base64(text.as_bytes()));
        assert_eq!(told, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }

    #[test]
    fn a_sheet_holds_its_figures_side_by_side_and_the_svg_the_same_pixels() {
        let spec = GridSpec::new(20, 30, 1.0).unwrap();
        let raster = Raster::from_fn(spec, |cell| cell.col as f32);
        let figure = || Figure::new("a map", &raster, ColourMap::Viridis);
        let one = figure().draw().unwrap();
        let sheet = Sheet::of(&[figure(), figure(), figure()], 2).unwrap();
        assert_eq!((sheet.canvas.width, sheet.canvas.height), (2 * one.width, 2 * one.height));
        let row = |canvas: &Canvas, y: i32, left: i32| {
            let begin = (y * canvas.width + left) as usize;
            canvas.pixels[begin..begin + one.width as usize].to_vec()
        };
        let middle = one.height / 2;
        assert_eq!(row(&sheet.canvas, middle, one.width), row(&one, middle, 0));
        assert_eq!(row(&sheet.canvas, one.height + middle, 0), row(&one, middle, 0));
        let svg = sheet.svg().unwrap();
        let parsed = roxmltree::Document::parse(&svg).expect("XML");
        assert!(parsed.descendants().any(|node| node.has_tag_name("image")));
    }
}
