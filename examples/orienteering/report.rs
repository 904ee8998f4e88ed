//! What was found of each file: a line of JSON, a row of a table, a summary by set.

use std::collections::BTreeMap;

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde::{Serialize, Serializer};

use crate::best::Known;
use crate::instance::Worth;

/// A file solved; a line of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Row {
    /// The file, as the user named it.
    pub(crate) file: String,
    /// Score of the route; none if there is no route.
    #[serde(serialize_with = "whole_if_whole")]
    pub(crate) score: Option<f64>,
    /// Length of the route, in the file's numbers.
    pub(crate) length: Option<f64>,
    /// Nodes from 0, start and end included.
    pub(crate) route: Option<Vec<usize>>,
    /// No route has a higher score.
    #[serde(serialize_with = "whole_if_whole")]
    pub(crate) bound: Option<f64>,
    /// `proven`, `gap x.xx %` or `no route`.
    pub(crate) status: String,
    /// Time the solver took.
    pub(crate) seconds: f64,
    /// The best score known, if a table of them was given.
    #[serde(flatten)]
    pub(crate) against: Option<Against>,
    /// How many nodes the file has.
    #[serde(skip)]
    pub(crate) nodes: usize,
}

/// How a score compares with the best known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Against {
    /// The best score known; none if the table does not have the file.
    #[serde(serialize_with = "whole_if_whole")]
    best: Option<f64>,
    /// By how much the score misses it, in percent of it; negative if the score is higher.
    gap_percent: Option<f64>,
    #[serde(skip)]
    set: Option<String>,
}

/// Scores are whole in all sets: they are written without a point.
#[expect(clippy::ref_option, reason = "serde passes a field by reference")]
fn whole_if_whole<S: Serializer>(number: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    // Above this not every whole number is an `f64`.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    match *number {
        None => to.serialize_none(),
        Some(number) if number.fract() == 0.0 && number.abs() < EXACT => {
            to.serialize_i64(number as i64)
        }
        Some(number) => to.serialize_f64(number),
    }
}

/// What is missing of `whole`, in percent of it.
fn gap_percent(score: f64, whole: f64) -> f64 {
    if whole > 0.0 { 100.0 * (whole - score) / whole } else { 0.0 }
}

impl Against {
    /// A score (0 without a route) against what is known of the file.
    pub(crate) fn new(score: Option<f64>, known: Option<&Known>) -> Self {
        Self {
            best: known.map(|known| known.score),
            gap_percent: known.map(|known| gap_percent(score.unwrap_or(0.0), known.score)),
            set: known.map(|known| known.set.clone()),
        }
    }
}

/// Says how far the score of a route may be from the best there is.
pub(crate) fn status(worth: Option<Worth>, bound: f64) -> String {
    match worth {
        None => "no route".to_owned(),
        Some(worth) if worth.score >= bound => "proven".to_owned(),
        Some(worth) => format!("gap {:.2} %", gap_percent(worth.score, bound)),
    }
}

impl Row {
    /// By how much the score misses the bound, in percent of the bound.
    fn bound_gap(&self) -> f64 {
        self.bound.map_or(0.0, |bound| gap_percent(self.score.unwrap_or(0.0), bound))
    }

    /// What to say when the file is done.
    pub(crate) fn progress(&self) -> String {
        let score = shown(self.score);
        format!("{}: score {score}, {}, {:.2} s", self.file, self.status, self.seconds)
    }
}

fn shown(number: Option<f64>) -> String {
    number.map_or("-".to_owned(), |number| number.to_string())
}

fn rounded(number: Option<f64>, digits: usize) -> String {
    number.map_or("-".to_owned(), |number| format!("{number:.digits$}"))
}

/// All rows as aligned columns.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut header =
        vec!["file", "nodes", "visited", "score", "length", "bound", "status", "seconds"];
    let compared = rows.iter().any(|row| row.against.is_some());
    if compared {
        header.extend(["best", "gap %"]);
    }
    let lines = rows.iter().map(|row| {
        let mut line = vec![
            row.file.clone(),
            row.nodes.to_string(),
            // The ends are no choice.
            row.route.as_ref().map_or("-".to_owned(), |route| (route.len() - 2).to_string()),
            shown(row.score),
            rounded(row.length, 3),
            shown(row.bound),
            row.status.clone(),
            format!("{:.2}", row.seconds),
        ];
        if let Some(against) = &row.against {
            line.push(shown(against.best));
            line.push(rounded(against.gap_percent, 2));
        }
        line
    });
    aligned(&header, lines)
}

/// One row a set of the files whose best score is known; empty if there is none.
pub(crate) fn summary(rows: &[Row]) -> String {
    let mut sets: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for row in rows {
        if let Some(Against { gap_percent: Some(gap), set: Some(set), .. }) = &row.against {
            sets.entry(set).or_default().push((*gap, row.bound_gap()));
        }
    }
    if sets.is_empty() {
        return String::new();
    }
    let header = ["set", "files", "at best", "mean gap %", "worst gap %", "mean gap of bound %"];
    let lines = sets.into_iter().map(|(set, gaps)| {
        let count = gaps.len() as f64;
        let mean = gaps.iter().map(|(gap, _)| gap).sum::<f64>() / count;
        let worst = gaps.iter().map(|(gap, _)| *gap).fold(f64::NEG_INFINITY, f64::max);
        let bound = gaps.iter().map(|(_, bound)| bound).sum::<f64>() / count;
        vec![
            set.to_owned(),
            gaps.len().to_string(),
            gaps.iter().filter(|(gap, _)| *gap <= 0.0).count().to_string(),
            format!("{mean:.2}"),
            format!("{worst:.2}"),
            format!("{bound:.2}"),
        ]
    });
    aligned(&header, lines)
}

fn aligned(header: &[&str], lines: impl Iterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(header);
    for line in lines {
        table.add_row(line);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(file: &str, score: f64, bound: f64) -> Row {
        let worth = Worth { score, length: 12.5 };
        Row {
            file: file.to_owned(),
            score: Some(score),
            length: Some(worth.length),
            route: Some(vec![0, 2, 1, 0]),
            bound: Some(bound),
            status: status(Some(worth), bound),
            seconds: 0.25,
            against: None,
            nodes: 3,
        }
    }

    fn against(mut row: Row, set: &str, best: f64) -> Row {
        let known = Known { set: set.to_owned(), score: best };
        row.against = Some(Against::new(row.score, Some(&known)));
        row
    }

    fn json(row: &Row) -> String {
        serde_json::to_string(row).expect("a row is JSON")
    }

    #[test]
    fn a_line_of_json_has_the_keys_in_their_order_and_whole_scores() {
        let line = r#"{"file":"a.txt","score":9,"length":12.5,"route":[0,2,1,0],"bound":10,"status":"gap 10.00 %","seconds":0.25"#;
        let row = row("a.txt", 9.0, 10.0);
        assert_eq!(json(&row), format!("{line}}}"));
        let known = against(row.clone(), "chao", 12.0);
        assert_eq!(json(&known), format!(r#"{line},"best":12,"gap_percent":25.0}}"#));
        let unknown = Row { against: Some(Against::new(row.score, None)), ..row };
        assert_eq!(json(&unknown), format!(r#"{line},"best":null,"gap_percent":null}}"#));
    }

    #[test]
    fn without_a_route_there_is_nothing_but_the_bound() {
        let none = Row {
            score: None,
            length: None,
            route: None,
            status: status(None, 4.5),
            ..row("a", 0.0, 4.5)
        };
        assert_eq!(
            json(&none),
            r#"{"file":"a","score":null,"length":null,"route":null,"bound":4.5,"status":"no route","seconds":0.25}"#
        );
        assert_eq!(none.progress(), "a: score -, no route, 0.25 s");
        let known = against(none, "chao", 5.0);
        assert_eq!(known.against.and_then(|against| against.gap_percent), Some(100.0));
    }

    #[test]
    fn a_score_at_its_bound_is_proven() {
        assert_eq!(row("a", 10.0, 10.0).status, "proven");
        assert_eq!(row("a", 0.0, 0.0).status, "proven");
    }

    #[test]
    fn the_summary_counts_each_set_and_leaves_out_files_that_are_not_known() {
        let rows = [
            against(row("a", 9.0, 10.0), "chao", 12.0),
            against(row("b", 12.0, 12.0), "chao", 12.0),
            against(row("c", 11.0, 11.0), "oplib", 10.0),
            row("d", 1.0, 100.0),
        ];
        let told = summary(&rows);
        let words: Vec<Vec<&str>> =
            told.lines().map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(words[1], ["chao", "2", "1", "12.50", "25.00", "5.00"]);
        assert_eq!(words[2], ["oplib", "1", "1", "-10.00", "-10.00", "0.00"]);
        assert_eq!(words.len(), 3);
        assert_eq!(summary(&rows[3..]), "");
    }

    #[test]
    fn a_table_has_the_best_known_only_where_a_table_of_them_was_given() {
        let plain = table(&[row("a", 9.0, 10.0)]);
        assert!(!plain.contains("best"), "{plain}");
        assert!(plain.contains("12.500") && plain.contains("gap 10.00 %"), "{plain}");
        let compared = table(&[against(row("a", 9.0, 10.0), "chao", 12.0)]);
        assert!(compared.contains("best") && compared.contains("25.00"), "{compared}");
    }
}
