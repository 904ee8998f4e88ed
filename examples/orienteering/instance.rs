//! An orienteering problem: points with scores, a budget, perhaps windows; and whether a route keeps its rules.

use crate::metric::Metric;

/// When a service may start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    /// First moment, units.
    pub(crate) open: f64,
    /// Last moment, units.
    pub(crate) close: f64,
}

/// A point that may be visited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    /// Where it lies, in the file's numbers.
    pub(crate) point: (f64, f64),
    /// What a visit is worth.
    pub(crate) score: f64,
    /// How long a visit takes, units; that of the ends of a route is not counted.
    pub(crate) service: f64,
    /// When a visit may start; always if there is none.
    pub(crate) window: Option<Window>,
}

/// A problem. Lengths and times share one unit (see [`Metric`]): one unit of length takes one of time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Instance {
    /// The nodes, numbered from 0.
    pub(crate) nodes: Vec<Node>,
    /// Where a route starts.
    pub(crate) start: usize,
    /// Where it ends; the start again for a closed tour.
    pub(crate) end: usize,
    /// Most that travel, waiting and services may take together, units.
    pub(crate) limit: f64,
    /// How far two points are apart.
    pub(crate) metric: Metric,
}

/// What a route is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Worth {
    /// Sum of the scores of its nodes, each once.
    pub(crate) score: f64,
    /// Length travelled, in the file's numbers.
    pub(crate) length: f64,
}

/// Share of an unrounded limit by which a sum of lengths may pass it: the sums of a thousand legs differ by less
/// from one order of adding to another.
const ROUNDING: f64 = 1e-12;

impl Instance {
    /// From node to node, units.
    pub(crate) fn length(&self, from: usize, to: usize) -> f64 {
        // Some roundings give a point a length to itself.
        if from == to {
            return 0.0;
        }
        self.metric.length(self.nodes[from].point, self.nodes[to].point)
    }

    /// The limit, units; with room for rounding where lengths are not whole.
    pub(crate) fn budget(&self) -> f64 {
        match self.metric {
            Metric::Exact => self.limit * (1.0 + ROUNDING),
            _ => self.limit,
        }
    }

    /// Score of the ends of a route, which every route has.
    pub(crate) fn score_of_ends(&self) -> f64 {
        let end = if self.end == self.start { 0.0 } else { self.nodes[self.end].score };
        self.nodes[self.start].score + end
    }

    /// Whether all scores are whole, so that no sum of them lies between.
    pub(crate) fn has_whole_scores(&self) -> bool {
        self.nodes.iter().all(|node| node.score.fract() == 0.0)
    }

    /// Follows a route, start and end included, and says what it is worth.
    ///
    /// It knows nothing of how the route was found.
    ///
    /// # Errors
    /// The first rule broken: the ends, a node twice, a window missed, the limit passed.
    pub(crate) fn check(&self, route: &[usize]) -> Result<Worth, String> {
        let &[first, ref inner @ .., last] = route else {
            let count = route.len();
            return Err(format!("a route of {count}; it has at least a start and an end"));
        };
        if (first, last) != (self.start, self.end) {
            return Err(format!(
                "from node {first} to node {last}; this route goes from {} to {}",
                self.start, self.end
            ));
        }
        let mut visited = vec![false; self.nodes.len()];
        visited[first] = true;
        visited[last] = true;
        let mut worth = Worth { score: self.score_of_ends(), length: 0.0 };
        let (mut here, mut time, mut service) = (first, 0.0, 0.0);
        for &next in inner.iter().chain([&last]) {
            let Some(node) = self.nodes.get(next) else {
                return Err(format!("node {next}; the last one is {}", self.nodes.len() - 1));
            };
            worth.length += self.length(here, next);
            time += service + self.length(here, next);
            (here, service) = (next, node.service);
            if let Some(window) = node.window {
                time = window.open.max(time);
                if time > window.close {
                    let per_one = self.metric.units_per_one();
                    let (late, close) = (time / per_one, window.close / per_one);
                    return Err(format!("node {next} is reached at {late}; it closes at {close}"));
                }
            }
        }
        for &node in inner {
            if std::mem::replace(&mut visited[node], true) {
                return Err(format!("node {node} is visited twice"));
            }
            worth.score += self.nodes[node].score;
        }
        let per_one = self.metric.units_per_one();
        worth.length /= per_one;
        if time > self.budget() {
            let (spent, limit) = (time / per_one, self.limit / per_one);
            return Err(format!("the route takes {spent}; the limit is {limit}"));
        }
        Ok(worth)
    }
}
