//! Two sequences lined up: what both keep, and what is deleted, inserted or moved.

use std::collections::BTreeMap;

/// One line of an [`Alignment`]; turns count from 0, places are numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edit {
    /// In both, in the same order among what is kept.
    Keep {
        /// Turn in the left sequence.
        from: usize,
        /// Turn in the right sequence.
        to: usize,
        /// The place.
        place: usize,
    },
    /// In the left one only.
    Delete {
        /// Turn in the left sequence.
        from: usize,
        /// The place.
        place: usize,
    },
    /// In the right one only.
    Insert {
        /// Turn in the right sequence.
        to: usize,
        /// The place.
        place: usize,
    },
    /// In both, at another turn among what is kept.
    Move {
        /// Turn in the left sequence.
        from: usize,
        /// Turn in the right sequence.
        to: usize,
        /// The place.
        place: usize,
    },
}

impl Edit {
    /// In a word: `keep`, `delete`, `insert` or `move`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Keep { .. } => "keep",
            Self::Delete { .. } => "delete",
            Self::Insert { .. } => "insert",
            Self::Move { .. } => "move",
        }
    }

    /// The place spoken of.
    #[must_use]
    pub fn place(self) -> usize {
        match self {
            Self::Keep { place, .. }
            | Self::Delete { place, .. }
            | Self::Insert { place, .. }
            | Self::Move { place, .. } => place,
        }
    }

    /// Turn in the left sequence, if the place is there.
    #[must_use]
    pub fn from(self) -> Option<usize> {
        match self {
            Self::Keep { from, .. } | Self::Delete { from, .. } | Self::Move { from, .. } => {
                Some(from)
            }
            Self::Insert { .. } => None,
        }
    }

    /// Turn in the right sequence, if the place is there.
    #[must_use]
    pub fn to(self) -> Option<usize> {
        match self {
            Self::Keep { to, .. } | Self::Insert { to, .. } | Self::Move { to, .. } => Some(to),
            Self::Delete { .. } => None,
        }
    }
}

/// An edit script from one sequence of places to another.
///
/// A longest common subsequence is kept (Wagner and Fischer 1974); a place deleted at one turn and inserted at another is
/// one move. No script of insertions, deletions and moves of single places is shorter: each of them changes
/// |a| + |b| − (longest common subsequence) − (places in common) by one at most, and the script has as many edits as that
/// number says. For sequences without repeats of the same places it is Ulam's distance of permutations (Ulam 1972).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Alignment {
    /// What is done, in the order of the left sequence, insertions where they come to stand.
    pub edits: Vec<Edit>,
}

impl Alignment {
    /// Lines two sequences up. Where several scripts are equally short, the left sequence's earlier places are kept.
    #[must_use]
    pub fn between(a: &[usize], b: &[usize]) -> Self {
        let common = common_tails(a, b);
        let (mut i, mut j) = (0, 0);
        let mut edits = Vec::new();
        while i < a.len() || j < b.len() {
            if i < a.len() && j < b.len() && a[i] == b[j] {
                edits.push(Edit::Keep { from: i, to: j, place: a[i] });
                (i, j) = (i + 1, j + 1);
            } else if i < a.len() && (j == b.len() || common[i + 1][j] >= common[i][j + 1]) {
                edits.push(Edit::Delete { from: i, place: a[i] });
                i += 1;
            } else {
                edits.push(Edit::Insert { to: j, place: b[j] });
                j += 1;
            }
        }
        Self { edits: with_moves(edits) }
    }

    /// How many places are inserted, deleted or moved: the edit distance. It is a metric.
    #[must_use]
    pub fn distance(&self) -> usize {
        self.edits.iter().filter(|edit| !matches!(edit, Edit::Keep { .. })).count()
    }

    /// How many edits go by that name (see [`Edit::name`]).
    #[must_use]
    pub fn count(&self, name: &str) -> usize {
        self.edits.iter().filter(|edit| edit.name() == name).count()
    }

    /// What the script makes of a sequence; none if it was made for another one.
    #[must_use]
    pub fn apply(&self, a: &[usize]) -> Option<Vec<usize>> {
        let mut used = vec![false; a.len()];
        let mut placed: Vec<(usize, usize)> = Vec::new();
        for &edit in &self.edits {
            let place = match edit.from() {
                Some(from) => {
                    if std::mem::replace(used.get_mut(from)?, true) || a[from] != edit.place() {
                        return None;
                    }
                    a[from]
                }
                None => edit.place(),
            };
            placed.extend(edit.to().map(|to| (to, place)));
        }
        placed.sort_unstable();
        let in_order = placed.iter().enumerate().all(|(turn, (to, _))| turn == *to);
        (in_order && used.iter().all(|used| *used))
            .then(|| placed.into_iter().map(|(_, place)| place).collect())
    }
}

/// Lengths of the longest common subsequences of all pairs of tails.
fn common_tails(a: &[usize], b: &[usize]) -> Vec<Vec<usize>> {
    let mut common = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in (0..a.len()).rev() {
        for j in (0..b.len()).rev() {
            common[i][j] = if a[i] == b[j] {
                common[i + 1][j + 1] + 1
            } else {
                common[i + 1][j].max(common[i][j + 1])
            };
        }
    }
    common
}

/// Makes one move of a deletion and an insertion of the same place, the earliest of each first.
fn with_moves(edits: Vec<Edit>) -> Vec<Edit> {
    let mut inserted: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for edit in edits.iter().rev() {
        if let Edit::Insert { to, place } = *edit {
            inserted.entry(place).or_default().push(to);
        }
    }
    let mut moved = Vec::new();
    let edits: Vec<Edit> = edits
        .into_iter()
        .map(|edit| match edit {
            Edit::Delete { from, place } => match inserted.get_mut(&place).and_then(Vec::pop) {
                Some(to) => {
                    moved.push(to);
                    Edit::Move { from, to, place }
                }
                None => edit,
            },
            edit => edit,
        })
        .collect();
    let gone = |edit: &Edit| matches!(edit, Edit::Insert { to, .. } if moved.contains(to));
    edits.into_iter().filter(|edit| !gone(edit)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    fn distance(a: &[usize], b: &[usize]) -> usize {
        Alignment::between(a, b).distance()
    }

    #[test]
    fn a_place_that_comes_later_is_moved_and_not_deleted_and_inserted() {
        let script = Alignment::between(&[7, 1, 2], &[1, 2, 7]);
        let kept = |from, to, place| Edit::Keep { from, to, place };
        assert_eq!(
            script.edits,
            [Edit::Move { from: 0, to: 2, place: 7 }, kept(1, 0, 1), kept(2, 1, 2)]
        );
        assert_eq!((script.distance(), script.count("keep")), (1, 2));
    }

    #[test]
    fn a_script_is_not_applied_to_what_it_was_not_made_for() {
        let script = Alignment::between(&[1, 2], &[2, 3]);
        assert_eq!(script.apply(&[1, 2]), Some(vec![2, 3]));
        assert_eq!(script.apply(&[1, 4]), None);
        assert_eq!(script.apply(&[1, 2, 3]), None);
        assert_eq!(script.apply(&[1]), None);
    }

    /// Fewest insertions, deletions and moves, by trying all of them breadth first.
    fn by_search(a: &[usize], b: &[usize], places: usize) -> usize {
        let mut seen = BTreeSet::from([a.to_vec()]);
        let mut edge = vec![a.to_vec()];
        for steps in 0.. {
            if seen.contains(b) {
                return steps;
            }
            let mut next = Vec::new();
            for sequence in &edge {
                let mut tried = Vec::new();
                for at in 0..sequence.len() {
                    let mut without = sequence.clone();
                    let place = without.remove(at);
                    for to in 0..=without.len() {
                        let mut moved = without.clone();
                        moved.insert(to, place);
                        tried.push(moved);
                    }
                    tried.push(without);
                }
                for at in 0..=sequence.len() {
                    for place in 0..places {
                        let mut more = sequence.clone();
                        more.insert(at, place);
                        tried.push(more);
                    }
                }
                // No shortest script needs to be longer than both on its way.
                tried.retain(|sequence| sequence.len() <= a.len().max(b.len()));
                next.extend(tried.into_iter().filter(|sequence| seen.insert(sequence.clone())));
            }
            edge = next;
        }
        unreachable!("every sequence can be reached")
    }

    fn places(longest: usize) -> impl Strategy<Value = Vec<usize>> {
        proptest::collection::vec(0_usize..3, 0..=longest)
    }

    proptest! {
        #[test]
        fn no_script_is_shorter(a in places(4), b in places(4)) {
            prop_assert_eq!(distance(&a, &b), by_search(&a, &b, 3));
        }

        #[test]
        fn the_script_turns_the_one_into_the_other(a in places(12), b in places(12)) {
            prop_assert_eq!(Alignment::between(&a, &b).apply(&a), Some(b));
        }

        #[test]
        fn the_distance_is_a_metric(a in places(8), b in places(8), c in places(8)) {
            prop_assert_eq!(distance(&a, &b) == 0, a == b);
            prop_assert_eq!(distance(&a, &b), distance(&b, &a));
            prop_assert!(distance(&a, &c) <= distance(&a, &b) + distance(&b, &c));
        }
    }
}
