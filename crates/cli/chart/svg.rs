//! A drawing as SVG 1.1.

use std::fmt::{self, Write};

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};

use super::drawing::{Drawing, Mark, RIM, Words};

/// Fonts of even width, the usual one of each system, then any.
const FAMILY: &str = "'DejaVu Sans Mono', Menlo, Consolas, monospace";

/// Height of a letter's em over that of a line of the bitmap fonts.
const EM: f32 = 0.95;

/// The drawing as the text of an SVG file.
pub(super) fn text(drawing: &Drawing) -> String {
    let mut out = String::new();
    write(&mut out, drawing).expect("a string takes all that is written");
    out
}

fn write(out: &mut String, drawing: &Drawing) -> fmt::Result {
    let Drawing { width, height, title, marks } = drawing;
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILY}\">"
    )?;
    writeln!(out, "<title>{}</title>", Escaped(title))?;
    writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>")?;
    for mark in marks {
        match mark {
            Mark::Lines { pieces, half, tint } => {
                write!(out, "<path d=\"")?;
                for (from, to) in pieces {
                    write!(
                        out,
                        "M{} {}L{} {}",
                        Short(from.0),
                        Short(from.1),
                        Short(to.0),
                        Short(to.1)
                    )?;
                }
                writeln!(
                    out,
                    "\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" fill=\"none\"/>",
                    Hex(tint.rgb()),
                    Short(2.0 * half)
                )?;
            }
            Mark::Fill { area, tint } => writeln!(
                out,
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
                area.left,
                area.top,
                area.width,
                area.height,
                Hex(tint.rgb())
            )?,
            Mark::Dot { centre, radius, tint } => writeln!(
                out,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"{}\"/>",
                Short(centre.0),
                Short(centre.1),
                // The rim straddles the outline.
                Short(radius + 0.5 * RIM),
                Hex(tint.rgb()),
                Short(RIM)
            )?,
            Mark::Text(words) => write_words(out, words)?,
        }
    }
    writeln!(out, "</svg>")
}

/// Text, made as long as it was measured whatever font is found.
fn write_words(out: &mut String, words: &Words) -> fmt::Result {
    let Words { text, size, area, upright } = words;
    if text.is_empty() {
        return Ok(());
    }
    let font = size.font();
    let (line, baseline) = (font.character_size.height, font.baseline as i32);
    let (place, length) = if *upright {
        let (x, y) = (area.left + baseline, area.bottom());
        (format!("transform=\"translate({x} {y}) rotate(-90)\""), area.height)
    } else {
        (format!("x=\"{}\" y=\"{}\"", area.left, area.top + baseline), area.width)
    };
    writeln!(
        out,
        "<text {place} font-size=\"{}\" fill=\"{}\" textLength=\"{length}\" \
         lengthAdjust=\"spacingAndGlyphs\">{}</text>",
        Short(EM * line as f32),
        Hex(super::drawing::Tint::Dark.rgb()),
        Escaped(text)
    )
}

/// A colour as SVG writes it.
struct Hex(Rgb888);

impl fmt::Display for Hex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0.r(), self.0.g(), self.0.b())
    }
}

/// A length to a hundredth of a pixel, without idle zeros.
struct Short(f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.2}", self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// Text with XML's own signs spelt out; what XML cannot hold becomes a question mark.
struct Escaped<'t>(&'t str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\u{fffe}' | '\u{ffff}' => f.write_char('?')?,
                c if c.is_control() => f.write_char('?')?,
                c => f.write_char(c)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Size;

    #[test]
    fn text_stays_text_and_the_file_is_xml() {
        let (mut drawing, top) = Drawing::begin(400, "a < b & \"c\" \u{7}", &[]);
        drawing.text_at(Size::Body, "λ ≤ 1", 20, top);
        drawing.text_upright("up", 20, 150);
        drawing.height = 200;
        let svg = text(&drawing);
        let parsed = roxmltree::Document::parse(&svg).expect("XML");
        let texts: Vec<&str> = parsed
            .descendants()
            .filter(|n| n.has_tag_name("text"))
            .filter_map(|n| n.text())
            .collect();
        assert_eq!(texts, ["a < b & \"c\" ?", "λ ≤ 1", "up"]);
        let turned = parsed.descendants().filter_map(|n| n.attribute("transform")).count();
        assert_eq!(turned, 1);
    }

    #[test]
    fn lengths_are_written_short() {
        let texts: Vec<String> =
            [1.0f32, 0.5, 12.345, 100.0].iter().map(|x| Short(*x).to_string()).collect();
        assert_eq!(texts, ["1", "0.5", "12.35", "100"]);
    }
}
