//! `OPLib` (Kobeaga, Merino, Lozano 2018): TSPLIB's keywords (Reinelt 1991) with a `COST_LIMIT` and scores.
//!
//! A closed tour through the depot, whose own score counts. Nodes are numbered from 1 in the file.

use super::{Line, Lines, MAX_NODES, ReadError, quoted};
use crate::instance::{Instance, Node};
use crate::metric::Metric;

/// What was read so far.
#[derive(Default)]
struct Header {
    dimension: Option<usize>,
    limit: Option<f64>,
    metric: Option<Metric>,
    points: Option<Vec<(f64, f64)>>,
    scores: Option<Vec<f64>>,
    depot: Option<usize>,
}

pub(super) fn read(mut lines: Lines<'_>) -> Result<Instance, ReadError> {
    let mut header = Header::default();
    while let Some(line) = lines.next() {
        let (key, value) = line.text.split_once(':').unwrap_or((line.text, ""));
        match (key.trim(), value.trim()) {
            ("EOF", _) => break,
            ("TYPE", "OP") | ("NAME" | "COMMENT" | "TSPSOL", _) => {}
            ("TYPE", _) => return Err(line.error(quoted(line.text), "`TYPE : OP`")),
            ("DIMENSION", value) => {
                let dimension = line.count(value, "DIMENSION", [1, MAX_NODES])?;
                once(&line, &mut header.dimension, dimension)?;
            }
            ("COST_LIMIT", value) => {
                let limit = line.amount(value, "COST_LIMIT")?;
                once(&line, &mut header.limit, limit)?;
            }
            ("EDGE_WEIGHT_TYPE", value) => {
                once(&line, &mut header.metric, metric(&line, value)?)?;
            }
            ("NODE_COORD_SECTION", _) => {
                let points = section(&mut lines, &line, header.dimension, |line, index| {
                    let [id, x, y] = line.fields("`i x y`")?;
                    numbered(line, id, index)?;
                    Ok((line.number(x, "x")?, line.number(y, "y")?))
                })?;
                once(&line, &mut header.points, points)?;
            }
            ("NODE_SCORE_SECTION", _) => {
                let scores = section(&mut lines, &line, header.dimension, |line, index| {
                    let [id, score] = line.fields("`i score`")?;
                    numbered(line, id, index)?;
                    line.amount(score, "the score")
                })?;
                once(&line, &mut header.scores, scores)?;
            }
            ("DEPOT_SECTION", _) => {
                let depot = depot(&mut lines, &line, header.dimension)?;
                once(&line, &mut header.depot, depot)?;
            }
            _ => {
                let expected = "a keyword (NAME, COMMENT, TYPE, DIMENSION, COST_LIMIT, EDGE_WEIGHT_TYPE), \
                                a section (NODE_COORD, NODE_SCORE, DEPOT) or `EOF`";
                return Err(line.error(quoted(line.text), expected));
            }
        }
    }
    let lines = &lines;
    let missing = |name| move || lines.ended(name);
    let points = header.points.ok_or_else(missing("NODE_COORD_SECTION"))?;
    let scores = header.scores.ok_or_else(missing("NODE_SCORE_SECTION"))?;
    let depot = header.depot.ok_or_else(missing("DEPOT_SECTION"))?;
    let limit = header.limit.ok_or_else(missing("COST_LIMIT"))?;
    let metric = header.metric.ok_or_else(missing("EDGE_WEIGHT_TYPE"))?;
    let nodes = points.into_iter().zip(scores);
    let nodes = nodes.map(|(point, score)| Node { point, score, service: 0.0, window: None });
    Ok(Instance { nodes: nodes.collect(), start: depot, end: depot, limit, metric })
}

/// Keeps what may be given once.
fn once<T>(line: &Line<'_>, kept: &mut Option<T>, value: T) -> Result<(), ReadError> {
    if kept.replace(value).is_some() {
        let key = line.text.split(':').next().unwrap_or_default().trim();
        return Err(line.error(format!("{} again", quoted(key)), "it once"));
    }
    Ok(())
}

fn metric(line: &Line<'_>, name: &str) -> Result<Metric, ReadError> {
    match name {
        "EUC_2D" => Ok(Metric::Nearest),
        "CEIL_2D" => Ok(Metric::Up),
        "ATT" => Ok(Metric::PseudoEuclidean),
        "GEO" => Ok(Metric::Geographical),
        _ => {
            Err(line.error(quoted(line.text), "EDGE_WEIGHT_TYPE to be EUC_2D, CEIL_2D, ATT or GEO"))
        }
    }
}

/// The dimension, which must come before the section that begins at a line.
fn dimension_of(line: &Line<'_>, dimension: Option<usize>) -> Result<usize, ReadError> {
    dimension.ok_or_else(|| line.error(quoted(line.text), "DIMENSION before it"))
}

/// One line for each node.
fn section<T>(
    lines: &mut Lines<'_>,
    title: &Line<'_>,
    dimension: Option<usize>,
    read: impl Fn(&Line<'_>, usize) -> Result<T, ReadError>,
) -> Result<Vec<T>, ReadError> {
    let dimension = dimension_of(title, dimension)?;
    let mut rows = Vec::with_capacity(lines.left().min(dimension));
    for index in 0..dimension {
        let expected = format!("node {} of {dimension}", index + 1);
        rows.push(read(&lines.wanted(&expected)?, index)?);
    }
    Ok(rows)
}

/// Nodes come in their order, none left out, none twice.
fn numbered(line: &Line<'_>, id: &str, index: usize) -> Result<(), ReadError> {
    if id.parse() == Ok(index + 1) {
        return Ok(());
    }
    Err(line.error(format!("node {}", quoted(id)), format!("node {}", index + 1)))
}

/// The one depot, by its number from 0.
fn depot(
    lines: &mut Lines<'_>,
    title: &Line<'_>,
    dimension: Option<usize>,
) -> Result<usize, ReadError> {
    let dimension = dimension_of(title, dimension)?;
    let line = lines.wanted("the depot")?;
    let depot = line.count(line.text, "the depot", [1, dimension])?;
    let line = lines.wanted("`-1`, the end of the depots")?;
    if line.text != "-1" {
        return Err(line.error(quoted(line.text), "`-1`, the end of the depots: a tour has one"));
    }
    Ok(depot - 1)
}
