//! Labels of `KEY = VALUE` lines in nested blocks: the Object Description Language of PDS3 (PDS Standards Reference
//! 3.8, chapter 12) and the Parameter Value Language of ISIS cubes, which differ too little to be told apart here.

use std::borrow::Cow;

use super::{damaged, raw::MAX_WHOLE};
use crate::TerrainError;

/// The longest label that is looked through. Those of real products have some tens of kilobytes.
const MAX_LABEL_BYTES: usize = 1 << 22;

/// The most statements in a label.
const MAX_STATEMENTS: usize = 1 << 16;

/// The block that holds all others.
pub(super) const ROOT: usize = 0;

/// One statement.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry<'a> {
    block: usize,
    key: Cow<'a, str>,
    value: Value<'a>,
    /// Counted from 1.
    line: usize,
}

/// A value as it is written, and its unit without the angle brackets.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Value<'a> {
    text: Cow<'a, str>,
    unit: Cow<'a, str>,
}

/// A label: its blocks in the order of their beginning, and all their statements.
#[derive(Debug)]
pub(super) struct Label<'a> {
    name: &'a str,
    /// Names and the blocks that they are in.
    blocks: Vec<(Cow<'a, str>, usize)>,
    entries: Vec<Entry<'a>>,
}

impl<'a> Label<'a> {
    /// The label at the beginning of `bytes`, up to its `END`.
    pub(super) fn of(name: &'a str, bytes: &'a [u8]) -> Result<Self, TerrainError> {
        let bytes = &bytes[..bytes.len().min(MAX_LABEL_BYTES)];
        let mut text = Scanner { bytes, at: 0, line: 1 };
        let mut label = Self { name, blocks: vec![(Cow::Borrowed(""), ROOT)], entries: Vec::new() };
        let mut open = ROOT;
        loop {
            text.skip_blank();
            let line = text.line;
            let wrong =
                |what: &str| Err(damaged(name, format!("line {line} of its label: {what}")));
            let key = text.word();
            if key.is_empty() {
                return if text.at == bytes.len() {
                    Err(damaged(name, format!("its label has no END in {line} lines")))
                } else {
                    wrong("a key is wanted")
                };
            }
            if key.eq_ignore_ascii_case("END") {
                // Samples may follow: their bytes are not looked at.
                return Ok(label);
            }
            text.skip_blank();
            let value = if text.accept(b'=') {
                text.skip_blank();
                match text.value() {
                    Some(value) => Some(value),
                    None => return wrong(&format!("the value of {} does not end", shorten(&key))),
                }
            } else {
                None
            };
            match (&key.to_ascii_uppercase()[..], value) {
                ("END_OBJECT" | "END_GROUP", _) if open == ROOT => {
                    return wrong(&format!("{key} ends nothing"));
                }
                ("END_OBJECT" | "END_GROUP", _) => open = label.blocks[open].1,
                (_, None) if label.entries.is_empty() && key.starts_with("CCSD") => {
                    // A wrapper of its time that begins some labels; it says nothing of the image.
                }
                (_, None) => return wrong(&format!("{} has no value", shorten(&key))),
                ("OBJECT" | "GROUP" | "BEGIN_OBJECT" | "BEGIN_GROUP", Some(value)) => {
                    label.blocks.push((value.text, open));
                    open = label.blocks.len() - 1;
                }
                (_, Some(value)) => {
                    label.entries.push(Entry { block: open, key, value, line });
                }
            }
            if label.entries.len() + label.blocks.len() > MAX_STATEMENTS {
                return wrong(&format!("more than {MAX_STATEMENTS} statements"));
            }
        }
    }

    /// The first block that is named so, at any depth.
    pub(super) fn block(&self, name: &str) -> Option<Section<'_, 'a>> {
        self.block_where(|found| found.eq_ignore_ascii_case(name))
    }

    /// The first block whose name is wanted, at any depth.
    pub(super) fn block_where(&self, wanted: impl Fn(&str) -> bool) -> Option<Section<'_, 'a>> {
        let found = self.blocks.iter().skip(1).position(|(name, _)| wanted(unquoted(name)))?;
        Some(Section { label: self, block: found + 1 })
    }

    /// What stands in no block.
    pub(super) fn root(&self) -> Section<'_, 'a> {
        Section { label: self, block: ROOT }
    }
}

/// One block of a label.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'l, 'a> {
    label: &'l Label<'a>,
    block: usize,
}

impl<'l, 'a> Section<'l, 'a> {
    pub(super) fn name(self) -> &'l str {
        unquoted(&self.label.blocks[self.block].0)
    }

    /// The block around this one.
    pub(super) fn outer(self) -> Self {
        Self { block: self.label.blocks[self.block].1, ..self }
    }

    /// A key's value in this very block.
    pub(super) fn find(self, key: &str) -> Option<&'l Entry<'a>> {
        let here =
            |entry: &&Entry<'a>| entry.block == self.block && entry.key.eq_ignore_ascii_case(key);
        self.label.entries.iter().find(here)
    }

    /// A key that has to be there.
    pub(super) fn need(self, key: &str) -> Result<&'l Entry<'a>, TerrainError> {
        self.find(key).ok_or_else(|| {
            let block = match self.block {
                ROOT => String::new(),
                _ => format!(" in its {}", shorten(self.name())),
            };
            damaged(self.label.name, format!("no {key}{block}"))
        })
    }

    /// An error about what a key says: what was found and what is wanted.
    pub(super) fn wrong(self, entry: &Entry<'_>, wanted: &str) -> TerrainError {
        let Entry { key, value, line, .. } = entry;
        let unit = if value.unit.is_empty() { String::new() } else { format!(" <{}>", value.unit) };
        let found = shorten(&value.text);
        damaged(
            self.label.name,
            format!(
                "line {line} of its label: {} is {found}{unit}; {wanted} is wanted",
                shorten(key)
            ),
        )
    }

    /// A word, without quotes.
    pub(super) fn text(self, key: &str) -> Option<&'l str> {
        self.find(key).map(Entry::text)
    }

    /// A finite number.
    pub(super) fn number(self, key: &str) -> Result<Option<f64>, TerrainError> {
        self.find(key)
            .map(|entry| {
                let number: Option<f64> = entry.text().parse().ok();
                number.filter(|x| x.is_finite()).ok_or_else(|| self.wrong(entry, "a number"))
            })
            .transpose()
    }

    /// A finite number that has to be there.
    pub(super) fn need_number(self, key: &str) -> Result<f64, TerrainError> {
        self.need(key)?;
        Ok(self.number(key)?.expect("the key was found"))
    }

    /// A whole number from `least` on.
    pub(super) fn whole(self, key: &str, least: u64) -> Result<Option<u64>, TerrainError> {
        self.find(key)
            .map(|entry| {
                let number = entry.text().parse::<u64>().ok();
                number.filter(|x| (least..=MAX_WHOLE).contains(x)).ok_or_else(|| {
                    self.wrong(entry, &format!("a whole number from {least} to {MAX_WHOLE}"))
                })
            })
            .transpose()
    }

    /// A whole number from `least` on that has to be there.
    pub(super) fn need_whole(self, key: &str, least: u64) -> Result<u64, TerrainError> {
        self.need(key)?;
        Ok(self.whole(key, least)?.expect("the key was found"))
    }
}

impl Entry<'_> {
    /// The value without its quotes.
    pub(super) fn text(&self) -> &str {
        unquoted(&self.value.text)
    }

    /// The unit, empty if there is none.
    pub(super) fn unit(&self) -> &str {
        self.value.unit.trim()
    }

    /// Whether the value is a string in quotes.
    pub(super) fn is_quoted(&self) -> bool {
        self.value.text.starts_with(['"', '\''])
    }

    /// The members of `(A, B <UNIT>)` as pairs of text and unit; a plain value is its own only member.
    pub(super) fn members(&self) -> Vec<(&str, &str)> {
        let text = self.value.text.trim();
        let Some(inner) = text.strip_prefix(['(', '{']).and_then(|t| t.strip_suffix([')', '}']))
        else {
            return vec![(self.text(), self.unit())];
        };
        let mut quoted = false;
        let comma = |c: char| {
            quoted ^= c == '"';
            c == ',' && !quoted
        };
        let bracket = |c: char| c == '<' || c == '>' || c.is_whitespace();
        inner
            .split(comma)
            .map(|member| {
                let (text, unit) = member.split_at(member.find('<').unwrap_or(member.len()));
                (unquoted(text), unit.trim_matches(bracket))
            })
            .collect()
    }
}

/// Without the white space and the quotes around it.
fn unquoted(text: &str) -> &str {
    let text = text.trim();
    let inner = |quote| text.strip_prefix(quote)?.strip_suffix(quote);
    inner('"').or_else(|| inner('\'')).unwrap_or(text).trim()
}

/// As much of a text as belongs into a message.
pub(super) fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{:?}..", &text[..end]),
        None => format!("{text:?}"),
    }
}

struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Scanner<'a> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn step(&mut self) {
        self.line += usize::from(self.peek() == Some(b'\n'));
        self.at += 1;
    }

    fn accept(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        if found {
            self.step();
        }
        found
    }

    fn starts(&self, text: &[u8]) -> bool {
        self.bytes[self.at..].starts_with(text)
    }

    /// Skips white space and comments, `/* .. */` and lines that begin with `#`.
    fn skip_blank(&mut self) {
        while let Some(byte) = self.peek() {
            if byte.is_ascii_whitespace() {
                self.step();
            } else if self.starts(b"/*") {
                while self.at < self.bytes.len() && !self.starts(b"*/") {
                    self.step();
                }
                self.at = (self.at + 2).min(self.bytes.len());
            } else if byte == b'#' {
                self.until(|byte| byte == b'\n');
            } else {
                return;
            }
        }
    }

    fn until(&mut self, is_end: impl Fn(u8) -> bool) -> Cow<'a, str> {
        let from = self.at;
        while self.peek().is_some_and(|byte| !is_end(byte)) {
            self.step();
        }
        String::from_utf8_lossy(&self.bytes[from..self.at])
    }

    fn word(&mut self) -> Cow<'a, str> {
        self.until(|byte| byte.is_ascii_whitespace() || byte == b'=')
    }

    /// A value with its unit; nothing if it does not end.
    fn value(&mut self) -> Option<Value<'a>> {
        let from = self.at;
        match self.peek()? {
            b'"' | b'\'' => self.skip_quoted()?,
            b'(' | b'{' => self.skip_members()?,
            _ => {
                while self.peek().is_some_and(|byte| byte != b'\n' && byte != b'<')
                    && !self.starts(b"/*")
                {
                    self.step();
                }
            }
        }
        let text = trimmed(String::from_utf8_lossy(&self.bytes[from..self.at]));
        while matches!(self.peek(), Some(b' ' | b'\t')) {
            self.step();
        }
        let mut unit = Cow::Borrowed("");
        if self.accept(b'<') {
            unit = self.until(|byte| byte == b'>' || byte == b'\n');
            self.accept(b'>').then_some(())?;
        }
        Some(Value { text, unit })
    }

    fn skip_quoted(&mut self) -> Option<()> {
        let quote = self.peek()?;
        self.step();
        while self.peek()? != quote {
            self.step();
        }
        self.step();
        Some(())
    }

    fn skip_members(&mut self) -> Option<()> {
        let mut depth = 0_usize;
        loop {
            match self.peek()? {
                b'"' => {
                    self.skip_quoted()?;
                    continue;
                }
                b'(' | b'{' => depth += 1,
                b')' | b'}' => depth -= 1,
                _ => {}
            }
            self.step();
            if depth == 0 {
                return Some(());
            }
        }
    }
}

fn trimmed(text: Cow<'_, str>) -> Cow<'_, str> {
    match text {
        Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
        Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_keep_their_block_unit_and_line() {
        let text = b"A = 1 <KM> /* one */\r\n^IMAGE = (\"F,1.IMG\", 5 <BYTES>)\nOBJECT = IMAGE\n \
            NOTE = \"two\n lines\"\n A = 'x'\nEND_OBJECT = IMAGE\nB = 2\nEND\n = \xFF\xFE";
        let label = Label::of("f", text).unwrap();
        let root = label.root();
        assert_eq!((root.text("a"), root.find("A").unwrap().unit()), (Some("1"), "KM"));
        assert_eq!(root.find("^image").unwrap().members(), [("F,1.IMG", ""), ("5", "BYTES")]);
        let image = label.block("image").unwrap();
        assert_eq!((image.text("A"), image.outer().text("B")), (Some("x"), Some("2")));
        assert_eq!(image.text("NOTE"), Some("two\n lines"));
        let error = image.wrong(image.find("A").unwrap(), "a number").to_string();
        assert_eq!(error, "f: line 6 of its label: \"A\" is \"'x'\"; a number is wanted");
    }

    #[test]
    fn a_label_that_does_not_end_is_refused() {
        let message = |text: &[u8]| Label::of("f", text).unwrap_err().to_string();
        assert_eq!(message(b"A = 1\n"), "f: its label has no END in 2 lines");
        assert_eq!(
            message(b"A = \"1\nEND\n"),
            "f: line 1 of its label: the value of \"A\" does not end"
        );
        assert_eq!(message(b"A\nEND\n"), "f: line 1 of its label: \"A\" has no value");
        assert_eq!(message(b"END_GROUP\nEND\n"), "f: line 1 of its label: END_GROUP ends nothing");
        assert_eq!(message(b" = 1\nEND\n"), "f: line 1 of its label: a key is wanted");
    }
}
