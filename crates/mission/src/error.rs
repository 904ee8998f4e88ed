//! Errors in mission files, with the place in the file.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// What is wrong with a mission, and where.
///
/// Its `Display` shows file, line, column and the line itself with a caret.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissionError {
    /// The file, relative to the mission's folder.
    pub file: String,
    /// Line and column (from 1), if the error has a place in the file.
    pub place: Option<(usize, usize)>,
    /// What was found and what was expected.
    pub message: String,
    rendered: String,
}

impl MissionError {
    /// An error about a whole file.
    pub fn of_file(file: &str, message: impl fmt::Display) -> Self {
        let message = message.to_string();
        let rendered = format!("error: {message}\n --> {file}");
        Self { file: file.to_owned(), place: None, message, rendered }
    }

    /// An error at a range of bytes of a file's text.
    pub fn at(file: &str, text: &str, span: Range<usize>, message: impl fmt::Display) -> Self {
        let message = message.to_string();
        let start = span.start.min(text.len());
        let start = (0..=start).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let column = text[line_start..start].chars().count() + 1;
        // A caret under a whole table would mark pages: the first line of it is enough.
        let end = span.end.clamp(start, text.len());
        let end = (end..=text.len()).find(|i| text.is_char_boundary(*i)).unwrap_or(text.len());
        let stop = text[start..end].find('\n').map_or(end, |i| start + i);
        let title = message.lines().next().unwrap_or_default().to_owned();
        let report = [Level::ERROR.primary_title(title).element(
            Snippet::source(text).path(file).annotation(AnnotationKind::Primary.span(start..stop)),
        )];
        let mut rendered = Renderer::plain().render(&report);
        for more in message.lines().skip(1) {
            rendered.push_str("\n  ");
            rendered.push_str(more);
        }
        Self { file: file.to_owned(), place: Some((line, column)), message, rendered }
    }

    /// An error at the value of a key, given as its path from the top of the file. If the key is not there,
    /// the nearest table that is stands for it.
    pub fn at_key(file: &str, text: &str, path: &[&str], message: impl fmt::Display) -> Self {
        let message = format!("{}: {message}", path.join("."));
        match locate(text, path) {
            Some(span) => Self::at(file, text, span, message),
            None => Self::of_file(file, message),
        }
    }

    /// An error from the TOML reader.
    pub(crate) fn of_toml(file: &str, text: &str, error: &toml::de::Error) -> Self {
        match error.span() {
            Some(span) => Self::at(file, text, span, error.message()),
            None => Self::of_file(file, error.message()),
        }
    }
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rendered)
    }
}

impl std::error::Error for MissionError {}

/// The bytes of the value at a path of keys and array indices.
fn locate(text: &str, path: &[&str]) -> Option<Range<usize>> {
    let document = toml_edit::Document::parse(text).ok()?;
    let mut item = document.as_item();
    let mut found = None;
    for key in path {
        let next = match key.parse::<usize>() {
            Ok(index) => item.get(index),
            Err(_) => item.get(key),
        };
        let Some(next) = next else { break };
        item = next;
        found = item.span().or(found);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "name = \"x\"\n\n[budget]\ntime-s = -3\n\n[[directive]]\nname = \"d\"\nweight = 2\n";

    #[test]
    fn an_error_shows_file_line_column_and_a_caret() {
        let error =
            MissionError::at_key("mission.toml", TEXT, &["budget", "time-s"], "-3 is negative");
        assert_eq!(error.place, Some((4, 10)));
        let shown = error.to_string();
        assert!(shown.contains("budget.time-s: -3 is negative"), "{shown}");
        assert!(shown.contains("mission.toml:4:10") && shown.contains("^^"), "{shown}");
    }

    #[test]
    fn keys_inside_arrays_of_tables_are_found() {
        let error = MissionError::at_key("m", TEXT, &["directive", "0", "weight"], "too heavy");
        assert_eq!(error.place, Some((8, 10)));
        let missing = MissionError::at_key("m", TEXT, &["directive", "0", "nothing"], "is missing");
        assert_eq!(missing.place.map(|p| p.0), Some(6));
    }
}
