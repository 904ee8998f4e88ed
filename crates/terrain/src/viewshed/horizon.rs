//! The outline of the ground in front, as straight pieces in the picture plane of an octant.
//!
//! A point `across` and `along` steps away is drawn at t = across/along, y = (height − eye)/along. This is a
//! central projection: edges of the grid become straight pieces, and what hides what is a matter of
//! which piece is higher at a given t. The outline is the upper envelope of the pieces drawn so far, from near to
//! far (the horizon of De Floriani and Magillo, 1994, grown row by row).

/// A straight piece of an outline, closed at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) start: f64,
    pub(super) end: f64,
    /// A point of the line the piece lies on, and the line's slope: not rounded again when the piece is cut.
    t: f64,
    y: f64,
    slope: f64,
}

impl Piece {
    /// The piece between two points, the first at the smaller t.
    pub(super) fn between((t0, y0): (f64, f64), (t1, y1): (f64, f64)) -> Self {
        Self { start: t0, end: t1, t: t0, y: y0, slope: (y1 - y0) / (t1 - t0) }
    }

    pub(super) fn at(&self, t: f64) -> f64 {
        self.y + (t - self.t) * self.slope
    }

    pub(super) fn slope(&self) -> f64 {
        self.slope
    }

    /// The part from `start` on.
    pub(super) fn from(self, start: f64) -> Self {
        Self { start, ..self }
    }

    fn until(self, end: f64) -> Self {
        Self { end, ..self }
    }

    fn is_same_line(&self, other: &Self) -> bool {
        self.t == other.t && self.y == other.y && self.slope == other.slope
    }
}

/// Appends a piece, joined to the last one if it goes on with it.
fn push(outline: &mut Vec<Piece>, piece: Piece) {
    if piece.start >= piece.end {
        return;
    }
    match outline.last_mut() {
        Some(last) if last.end == piece.start && last.is_same_line(&piece) => last.end = piece.end,
        _ => outline.push(piece),
    }
}

/// The upper envelope of two outlines, as far as `limit`, written over `upper`.
pub(super) fn merge(old: &[Piece], fresh: &[Piece], limit: f64, upper: &mut Vec<Piece>) {
    upper.clear();
    let (mut olds, mut freshes) = (old.iter().copied(), fresh.iter().copied());
    let (mut a, mut b) = (olds.next(), freshes.next());
    loop {
        match (a, b) {
            (None, None) => break,
            (Some(piece), None) => {
                if piece.start > limit {
                    break;
                }
                push(upper, piece);
                a = olds.next();
            }
            (None, Some(piece)) => {
                push(upper, piece);
                b = freshes.next();
            }
            (Some(p), Some(q)) if p.end <= q.start => {
                push(upper, p);
                a = olds.next();
            }
            (Some(p), Some(q)) if q.end <= p.start => {
                push(upper, q);
                b = freshes.next();
            }
            (Some(p), Some(q)) if p.start < q.start => {
                push(upper, p.until(q.start));
                a = Some(p.from(q.start));
            }
            (Some(p), Some(q)) if q.start < p.start => {
                push(upper, q.until(p.start));
                b = Some(q.from(p.start));
            }
            (Some(p), Some(q)) => {
                let end = p.end.min(q.end);
                push_upper(upper, p.until(end), q.until(end));
                a = if p.end > end { Some(p.from(end)) } else { olds.next() };
                b = if q.end > end { Some(q.from(end)) } else { freshes.next() };
            }
        }
    }
}

/// Appends the upper one of two pieces over the same interval, changing over where they cross.
fn push_upper(upper: &mut Vec<Piece>, p: Piece, q: Piece) {
    let (first, last) = (p.at(p.start) - q.at(p.start), p.at(p.end) - q.at(p.end));
    if first >= 0.0 && last >= 0.0 {
        return push(upper, p);
    }
    if first <= 0.0 && last <= 0.0 {
        return push(upper, q);
    }
    let crossing = p.start + (p.end - p.start) * (first / (first - last));
    let crossing = crossing.clamp(p.start, p.end);
    let (left, right) = if first > 0.0 { (p, q) } else { (q, p) };
    push(upper, left.until(crossing));
    push(upper, right.from(crossing));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(points: &[(f64, f64)]) -> Vec<Piece> {
        points.windows(2).map(|ends| Piece::between(ends[0], ends[1])).collect()
    }

    fn heights(outline: &[Piece]) -> Vec<(f64, f64, f64, f64)> {
        outline.iter().map(|p| (p.start, p.at(p.start), p.end, p.at(p.end))).collect()
    }

    #[test]
    fn crossing_pieces_change_over_where_they_cross() {
        let mut upper = Vec::new();
        merge(
            &outline(&[(0.0, 0.0), (1.0, 1.0)]),
            &outline(&[(0.0, 1.0), (1.0, 0.0)]),
            1.0,
            &mut upper,
        );
        assert_eq!(heights(&upper), [(0.0, 1.0, 0.5, 0.5), (0.5, 0.5, 1.0, 1.0)]);
    }

    #[test]
    fn gaps_let_the_other_outline_through() {
        let mut upper = Vec::new();
        let old = [Piece::between((0.0, 5.0), (0.25, 5.0)), Piece::between((0.5, 1.0), (1.0, 1.0))];
        merge(&old, &outline(&[(0.0, 2.0), (0.75, 2.0)]), 1.0, &mut upper);
        assert_eq!(
            heights(&upper),
            [(0.0, 5.0, 0.25, 5.0), (0.25, 2.0, 0.75, 2.0), (0.75, 1.0, 1.0, 1.0)]
        );
    }

    #[test]
    fn a_lower_outline_changes_nothing() {
        let old = outline(&[(0.0, 3.0), (0.4, 2.0), (1.0, 4.0)]);
        let mut upper = Vec::new();
        merge(&old, &outline(&[(0.0, 0.0), (0.3, 1.0), (0.6, 0.5), (1.0, 1.0)]), 1.0, &mut upper);
        assert_eq!(upper, old);
    }
}
