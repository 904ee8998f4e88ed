//! The plain text of Tsiligirides (1984) and of Chao, Golden and Wasil (1996).
//!
//! `Tmax P`, then one point a line, `x y score`: the first is the start, the second the end. The file does not say how
//! many points there are, so one that was cut between two lines cannot be told from a whole one.

use super::{Lines, MAX_NODES, ReadError, quoted};
use crate::instance::{Instance, Node};
use crate::metric::Metric;

pub(super) fn read(mut lines: Lines<'_>) -> Result<Instance, ReadError> {
    let first = lines.wanted("`Tmax P`")?;
    let [limit, paths] = first.fields("`Tmax P`, the budget and the number of paths")?;
    let limit = first.amount(limit, "Tmax")?;
    if paths != "1" {
        return Err(first.error(format!("{} paths", quoted(paths)), "`1`, a single path"));
    }
    let mut nodes = Vec::new();
    while let Some(line) = lines.next() {
        if nodes.len() == MAX_NODES {
            return Err(line.error("one more point", format!("at most {MAX_NODES}")));
        }
        let [x, y, score] = line.fields("`x y score`")?;
        let point = (line.number(x, "x")?, line.number(y, "y")?);
        let score = line.amount(score, "the score")?;
        nodes.push(Node { point, score, service: 0.0, window: None });
    }
    if nodes.len() < 2 {
        return Err(lines.ended("`x y score` of the start and of the end"));
    }
    Ok(Instance { nodes, start: 0, end: 1, limit, metric: Metric::Exact })
}
