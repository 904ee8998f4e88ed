//! Files of orienteering problems: which format one has, and what all readers share.

mod oplib;
mod optw;
mod text;

use crate::instance::Instance;

/// What is wrong with a file, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ReadError {
    /// The file, as the user named it.
    pub(crate) file: String,
    /// The line, from 1.
    pub(crate) line: usize,
    /// What is there.
    pub(crate) found: String,
    /// What should be there.
    pub(crate) expected: String,
}

impl std::fmt::Display for ReadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { file, line, found, expected } = self;
        write!(f, "{file}, line {line}: found {found}; expected {expected}")
    }
}

impl std::error::Error for ReadError {}

/// The most nodes a problem may have: the solver keeps all lengths between them, some hundred bytes a pair.
pub(crate) const MAX_NODES: usize = 2500;

/// The largest number taken: sums of as many as there are nodes, in hundredths, are still exact.
pub(crate) const MAX_NUMBER: f64 = 1e9;

const FORMATS: &str = "the first line of a problem: a keyword (OPLib), `Tmax P` (Tsiligirides, Chao) or \
                       `k v N t` (with windows)";

/// Reads a problem; its content tells the format.
///
/// A first line that begins with a letter is TSPLIB's (`OPLib`); one of two numbers is Tsiligirides' and Chao's; one of
/// four is that of problems with windows.
///
/// # Errors
/// The first line that does not fit.
pub(crate) fn read(file: &str, bytes: &[u8]) -> Result<Instance, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| ReadError {
        file: file.to_owned(),
        line: bytes[..error.valid_up_to()].split(|&byte| byte == b'\n').count(),
        found: format!("the byte {:#04x}", bytes[error.valid_up_to()]),
        expected: "text (UTF-8)".to_owned(),
    })?;
    let lines = Lines::new(file, text);
    let first = lines.peek(FORMATS)?;
    if first.text.starts_with(|sign: char| sign.is_ascii_alphabetic()) {
        return oplib::read(lines);
    }
    match first.words().len() {
        2 => text::read(lines),
        4 => optw::read(lines),
        _ => Err(first.error(quoted(first.text), FORMATS)),
    }
}

/// The lines of a file that are not blank, one after another.
struct Lines<'a> {
    file: &'a str,
    filled: Vec<Line<'a>>,
    next: usize,
    /// The number of the line after the last.
    end: usize,
}

/// A line with its place.
#[derive(Clone, Copy)]
struct Line<'a> {
    file: &'a str,
    number: usize,
    /// Without blanks around it.
    text: &'a str,
}

impl<'a> Lines<'a> {
    fn new(file: &'a str, text: &'a str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = text.lines().enumerate();
        let lines: Vec<Line<'a>> = lines
            .map(|(index, line)| Line { file, number: index + 1, text: line.trim() })
            .collect();
        let end = lines.len() + 1;
        let filled = lines.into_iter().filter(|line| !line.text.is_empty()).collect();
        Self { file, filled, next: 0, end }
    }

    /// The next line, which stays the next.
    fn peek(&self, expected: &str) -> Result<Line<'a>, ReadError> {
        self.filled.get(self.next).copied().ok_or_else(|| self.ended(expected))
    }

    /// The next line, if there is one.
    fn next(&mut self) -> Option<Line<'a>> {
        let line = self.filled.get(self.next).copied();
        self.next += 1;
        line
    }

    /// The next line, which must be there.
    fn wanted(&mut self, expected: &str) -> Result<Line<'a>, ReadError> {
        let line = self.peek(expected)?;
        self.next += 1;
        Ok(line)
    }

    /// How many lines there are to come.
    fn left(&self) -> usize {
        self.filled.len().saturating_sub(self.next)
    }

    fn ended(&self, expected: &str) -> ReadError {
        let line = Line { file: self.file, number: self.end, text: "" };
        line.error("the end of the file", expected)
    }
}

impl<'a> Line<'a> {
    fn error(&self, found: impl Into<String>, expected: impl Into<String>) -> ReadError {
        let (found, expected) = (found.into(), expected.into());
        ReadError { file: self.file.to_owned(), line: self.number, found, expected }
    }

    fn words(&self) -> Vec<&'a str> {
        self.text.split_whitespace().collect()
    }

    /// The words, which must be so many.
    fn fields<const N: usize>(&self, expected: &str) -> Result<[&'a str; N], ReadError> {
        let words = self.words();
        let count = words.len();
        words.try_into().map_err(|_| {
            let found = format!("{count} {}", if count == 1 { "field" } else { "fields" });
            self.error(found, format!("{N}: {expected}"))
        })
    }

    /// A number of either sign.
    fn number(&self, word: &str, name: &str) -> Result<f64, ReadError> {
        word.parse()
            .ok()
            .filter(|number: &f64| number.abs() <= MAX_NUMBER)
            .ok_or_else(|| self.error(quoted(word), format!("{name}, a number up to {MAX_NUMBER}")))
    }

    /// A number that is not negative.
    fn amount(&self, word: &str, name: &str) -> Result<f64, ReadError> {
        word.parse()
            .ok()
            .filter(|number| (0.0..=MAX_NUMBER).contains(number))
            // A minus zero would be printed as such.
            .map(|number| number + 0.0)
            .ok_or_else(|| {
                self.error(quoted(word), format!("{name}, a number from 0 to {MAX_NUMBER}"))
            })
    }

    /// A whole number from `least` to `most`.
    fn count(&self, word: &str, name: &str, [least, most]: [usize; 2]) -> Result<usize, ReadError> {
        word.parse().ok().filter(|count| (least..=most).contains(count)).ok_or_else(|| {
            self.error(quoted(word), format!("{name}, a whole number from {least} to {most}"))
        })
    }
}

/// A text as an error shows it: long lines are cut.
fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    let cut: String = text.chars().take(SHOWN).collect();
    if cut.len() < text.len() { format!("`{cut}…`") } else { format!("`{cut}`") }
}
