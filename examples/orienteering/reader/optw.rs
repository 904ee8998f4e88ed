//! Problems with windows, made from the vehicle routing problems of Solomon (1987) and of Cordeau, Gendreau and
//! Laporte (1997) by Righini and Salani (2009) and Montemanni and Gambardella (2009).
//!
//! `k v N t`, then `D Q`, then vertex 0 (the depot) and N more, `i x y d S f a list O C`: service time d, score S, a list
//! of a numbers, window from O to C. The depot's C is the budget. k, v, D, Q, f and the list belong to
//! vehicle routing and are not used.
//!
//! Lengths are rounded down, to tenths in Solomon's problems, to hundredths in Cordeau's. The file itself says which it
//! is: t, the number of days or depots, is 1 in all of Solomon's and more in all of Cordeau's.

use super::{Line, Lines, MAX_NODES, ReadError, quoted};
use crate::instance::{Instance, Node, Window};
use crate::metric::Metric;

const VERTEX: &str = "`i x y d S f a list O C`";

pub(super) fn read(mut lines: Lines<'_>) -> Result<Instance, ReadError> {
    let first = lines.wanted("`k v N t`")?;
    let [kind, vehicles, vertices, days] = first.fields("`k v N t`")?;
    first.amount(kind, "k")?;
    first.amount(vehicles, "v")?;
    let vertices = first.count(vertices, "N", [0, MAX_NODES - 1])?;
    let metric = match first.count(days, "t", [1, usize::MAX])? {
        1 => Metric::DownToTenths,
        _ => Metric::DownToHundredths,
    };
    let second = lines.wanted("`D Q`")?;
    let [duration, load] = second.fields("`D Q`")?;
    second.amount(duration, "D")?;
    second.amount(load, "Q")?;

    let mut nodes = Vec::with_capacity(lines.left().min(vertices + 1));
    for index in 0..=vertices {
        let line = lines.wanted(&format!("vertex {index} of {vertices}, {VERTEX}"))?;
        nodes.push(vertex(&line, index, metric)?);
    }
    if let Some(line) = lines.next() {
        let expected = format!("the end: N, the number of the last vertex, is {vertices}");
        return Err(line.error(quoted(line.text), expected));
    }
    // The end of the depot's window is the budget of the whole route.
    let limit = nodes[0].window.take().map_or(0.0, |window| window.close);
    Ok(Instance { nodes, start: 0, end: 0, limit, metric })
}

fn vertex(line: &Line<'_>, index: usize, metric: Metric) -> Result<Node, ReadError> {
    let words = line.words();
    let &[id, x, y, service, score, _, listed, ref rest @ ..] = &words[..] else {
        return Err(line.error(format!("{} fields", words.len()), VERTEX));
    };
    if id.parse() != Ok(index) {
        return Err(line.error(format!("vertex {}", quoted(id)), format!("vertex {index}")));
    }
    let listed = line.count(listed, "a, the length of the list", [0, words.len()])?;
    let &[open, close] = rest.get(listed..).unwrap_or_default() else {
        let found = format!("{} fields", words.len());
        return Err(line.error(found, format!("{}, for a is {listed}: {VERTEX}", 9 + listed)));
    };
    let window = Window {
        open: metric.units(line.amount(open, "O, the start of the window")?),
        close: metric.units(line.amount(close, "C, the end of the window")?),
    };
    if window.close < window.open {
        let found = format!("a window from {open} to {close}");
        return Err(line.error(found, "one that closes when it opens or later"));
    }
    if index == 0 && window.open > 0.0 {
        return Err(line.error(format!("a depot that opens at {open}"), "0: a route starts then"));
    }
    Ok(Node {
        point: (line.number(x, "x")?, line.number(y, "y")?),
        score: line.amount(score, "S, the score")?,
        service: metric.units(line.amount(service, "d, the service time")?),
        window: Some(window),
    })
}
