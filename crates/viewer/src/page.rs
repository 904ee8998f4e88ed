//! The page, and what can be put inside it.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

/// The page as it was built: one HTML file that needs nothing beside it. Without a log inside it asks for one.
pub const PAGE: &str = include_str!("../web/dist/index.html");

/// Bytes encoded at once; base64 goes by threes.
const PIECE: usize = 3 << 16;

/// Which of the two logs that the page can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// The first.
    A,
    /// The one beside it.
    B,
}

impl Slot {
    /// Its name in the page's data and in addresses.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
        }
    }

    fn element(self, what: What) -> &'static str {
        match (self, what) {
            (Self::A, What::Log) => "log",
            (Self::B, What::Log) => "log-b",
            (Self::A, What::Planes) => "planes",
            (Self::B, What::Planes) => "planes-b",
        }
    }
}

/// What a file inside the page is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    Log,
    Planes,
}

/// A file inside the page.
#[derive(Debug, Clone)]
struct Inside {
    slot: Slot,
    what: What,
    name: String,
    bytes: Vec<u8>,
}

/// The page with logs and data inside.
///
/// ```
/// use wisdom_viewer::{Page, Slot};
///
/// let mut page = Page::default();
/// page.log(Slot::A, "run.mcap", vec![0x89, b'M']);
/// let mut html = Vec::new();
/// page.write_to(&mut html)?;
/// assert!(String::from_utf8(html)?.contains(r#"id="log" data-name="run.mcap">iU0=</script>"#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Page {
    files: Vec<Inside>,
    data: Vec<(&'static str, Value)>,
}

impl Page {
    /// Puts a log inside, under the name that it is to be called by.
    pub fn log(&mut self, slot: Slot, name: impl Into<String>, bytes: Vec<u8>) {
        self.files.push(Inside { slot, what: What::Log, name: name.into(), bytes });
    }

    /// Puts further planes beside a log: an MCAP file with `foxglove.Grid` messages on `/map/NAME`, whose sequence numbers are
    /// those of the log's decisions.
    pub fn planes(&mut self, slot: Slot, bytes: Vec<u8>) {
        self.files.push(Inside { slot, what: What::Planes, name: "planes".to_owned(), bytes });
    }

    /// Puts in what was made again of the logs inside.
    pub fn remade(&mut self, value: Value) {
        self.data.push(("derived", value));
    }

    /// Tells the page where the logs are served.
    pub(crate) fn served(&mut self, value: Value) {
        self.data.push(("served", value));
    }

    /// Writes the page. Logs are encoded piece by piece.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_to(&self, out: &mut dyn Write) -> io::Result<()> {
        let (head, tail) = PAGE.split_at(PAGE.rfind("</body>").unwrap_or(PAGE.len()));
        out.write_all(head.as_bytes())?;
        for (id, value) in &self.data {
            // Nothing in the data may end the element.
            let json = value.to_string().replace('<', "\\u003c");
            writeln!(out, r#"<script type="application/json" id="{id}">{json}</script>"#)?;
        }
        for Inside { slot, what, name, bytes } in &self.files {
            let (id, name) = (slot.element(*what), attribute(name));
            write!(
                out,
                r#"<script type="application/octet-stream;base64" id="{id}" data-name="{name}">"#
            )?;
            for piece in bytes.chunks(PIECE) {
                out.write_all(STANDARD.encode(piece).as_bytes())?;
            }
            writeln!(out, "</script>")?;
        }
        out.write_all(tail.as_bytes())
    }
}

/// Text as it stands in a quoted attribute.
fn attribute(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(page: &Page) -> String {
        let mut out = Vec::new();
        page.write_to(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn a_page_with_nothing_inside_is_the_page_as_built() {
        assert_eq!(written(&Page::default()), PAGE);
        assert!(PAGE.contains("</body>") && PAGE.contains("Content-Security-Policy"));
    }

    #[test]
    fn names_and_data_cannot_leave_their_elements() {
        let mut page = Page::default();
        page.log(Slot::B, "\"><script>alert(1)</script>", vec![1, 2, 3]);
        page.remade(serde_json::json!({ "a": { "text": "</script><b>" } }));
        let html = written(&page);
        let added = &html[PAGE.rfind("</body>").unwrap()..];
        assert_eq!(added.matches("</script>").count(), 2, "{added}");
        assert_eq!(added.matches("<script").count(), 2, "{added}");
        assert!(added.contains(r#"id="log-b" data-name="&quot;&gt;&lt;script&gt;"#));
        assert!(added.contains(r"\u003c/script>\u003cb>"));
    }

    #[test]
    fn a_log_comes_back_from_its_pieces() {
        let bytes: Vec<u8> = (0..2 * PIECE + 5).map(|i| (i * 7) as u8).collect();
        let mut page = Page::default();
        page.log(Slot::A, "x", bytes.clone());
        let html = written(&page);
        let text = html.split(r#"data-name="x">"#).nth(1).unwrap().split('<').next().unwrap();
        assert_eq!(STANDARD.decode(text).unwrap(), bytes);
    }
}
