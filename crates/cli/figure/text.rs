//! Text of figures: fonts, their measures, and spelling in the signs that they have.

use embedded_graphics::mono_font::{
    MonoFont,
    iso_8859_1::{FONT_9X15, FONT_9X15_BOLD, FONT_10X20},
};

pub(crate) const TITLE: &MonoFont<'_> = &FONT_10X20;

pub(crate) const BODY: &MonoFont<'_> = &FONT_9X15;

pub(super) const LABEL: &MonoFont<'_> = &FONT_9X15_BOLD;

pub(crate) fn advance(font: &MonoFont<'_>) -> i32 {
    (font.character_size.width + font.character_spacing) as i32
}

pub(crate) fn line_height(font: &MonoFont<'_>) -> i32 {
    font.character_size.height as i32
}

pub(crate) fn width(font: &MonoFont<'_>, text: &str) -> i32 {
    text.chars().count() as i32 * advance(font)
}

pub(super) fn widest<'t>(font: &MonoFont<'_>, texts: impl Iterator<Item = &'t str>) -> i32 {
    texts.map(|text| width(font, text)).max().unwrap_or(0)
}

/// The text as the fonts can draw it.
pub(crate) fn latin(text: &str) -> String {
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
pub(crate) fn fit(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(2)).chain("..".chars()).collect()
}

/// Lines of at most `most` characters, broken between words.
pub(crate) fn wrap(text: &str, most: usize) -> Vec<String> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_spelt_in_the_signs_that_the_fonts_have() {
        assert_eq!(latin("m(I ∩ NI) − 5 °, u ≤ 1 → λ"), "m(I & NI) - 5 °, u <= 1 -> ?");
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(fit("abcdef", 4), "ab..");
    }
}
