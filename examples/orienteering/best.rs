//! The best scores known, a table of `set,file,best` and any further columns.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, ensure};

/// What is known of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    /// The set that it belongs to.
    pub(crate) set: String,
    /// The best score known.
    pub(crate) score: f64,
}

/// Best scores by the names of their files, without folders.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct BestKnown(BTreeMap<String, Known>);

impl BestKnown {
    /// Reads a table; `name` is what errors call it.
    ///
    /// # Errors
    /// The line and what is wrong there.
    pub(crate) fn read(name: &str, bytes: &[u8]) -> anyhow::Result<Self> {
        let mut table = csv::Reader::from_reader(bytes);
        let header = table.headers().with_context(|| name.to_owned())?.clone();
        let column = |title: &str| {
            let place = header.iter().position(|found| found == title);
            place.with_context(|| {
                let found = header.iter().collect::<Vec<_>>().join(",");
                format!("{name}, line 1: found `{found}`; expected a column `{title}`")
            })
        };
        let (set, file, best) = (column("set")?, column("file")?, column("best")?);
        let mut known = BTreeMap::new();
        for record in table.records() {
            let record = record.with_context(|| name.to_owned())?;
            let line = record.position().map_or(0, csv::Position::line);
            let score = record[best].parse().ok();
            let score = score.filter(|score: &f64| score.is_finite() && *score >= 0.0);
            let score = score.with_context(|| {
                let found = &record[best];
                format!("{name}, line {line}: found `{found}`; expected `best` to be 0 or more")
            })?;
            let entry = Known { set: record[set].to_owned(), score };
            ensure!(
                known.insert(record[file].to_owned(), entry).is_none(),
                "{name}, line {line}: found `{}` again; expected a file once",
                &record[file]
            );
        }
        Ok(Self(known))
    }

    /// What is known of a file, whatever its folder.
    pub(crate) fn of(&self, file: &Path) -> Option<&Known> {
        self.0.get(file.file_name()?.to_str()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_known_whatever_its_folder() {
        let table = b"set,file,n,best\nchao,a.txt,3,12\noptw,b.txt,3,7\n";
        let best = BestKnown::read("best.csv", table).expect("a sound table");
        let known = Known { set: "optw".to_owned(), score: 7.0 };
        assert_eq!(best.of(Path::new("there/b.txt")), Some(&known));
        assert_eq!(best.of(Path::new("there/c.txt")), None);
    }

    #[test]
    fn a_broken_table_is_refused_with_its_line_and_what_was_expected() {
        for (table, message) in [
            ("set,file\n", "best.csv, line 1: found `set,file`; expected a column `best`"),
            (
                "set,file,best\na,b,1\na,c,x\n",
                "best.csv, line 3: found `x`; expected `best` to be 0 or more",
            ),
            (
                "set,file,best\na,b,-1\n",
                "best.csv, line 2: found `-1`; expected `best` to be 0 or more",
            ),
            (
                "set,file,best\na,b,1\na,b,2\n",
                "best.csv, line 3: found `b` again; expected a file once",
            ),
        ] {
            let error = BestKnown::read("best.csv", table.as_bytes()).expect_err("a broken table");
            assert_eq!(error.to_string(), message);
        }
        let error = BestKnown::read("best.csv", b"set,file,best\na,b\n").expect_err("two fields");
        assert!(format!("{error:#}").starts_with("best.csv: CSV error"), "{error:#}");
    }
}
