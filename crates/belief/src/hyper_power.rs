//! All elements of a frame, one after another: the hyper-power set D^Θ, the power set 2^Θ or what a hybrid
//! model leaves of them.
//!
//! On atoms that may overlap an element is a monotone Boolean function of them. Such a function is cut along
//! its last atoms into functions of the first four (of which there are 168), one for each set of last atoms,
//! each holding those below it. So a walk needs small tables only, whatever the number of elements.

use std::iter::FusedIterator;
use std::ops::Range;

use crate::{Element, Frame};

/// |D^Θ| with ∅ on 1 to 7 free atoms: the Dedekind numbers less one (Dezert and Smarandache 2003).
const FREE_COUNTS: [u128; 7] = [2, 5, 19, 167, 7580, 7_828_353, 2_414_682_040_997];

/// Atoms of the functions in the tables: 2⁴ = 16 bits of truth table, 168 functions.
const TABLE_ATOMS: usize = 4;

/// The most parts a function is cut into: one for each set of the last 7 − 4 atoms.
const MAX_PARTS: usize = 8;

impl Frame {
    /// Every element of the frame's power or hyper-power set, ∅ and Θ among them, each once, in rising order
    /// of their bit masks ([`Element::regions`]), so that a part comes before the whole.
    ///
    /// Lazy: on seven free atoms or on many exclusive ones there are more than anyone can wait for.
    ///
    /// ```
    /// # use wisdom_belief::Frame;
    /// let frame = Frame::free(["A", "B"])?;
    /// let all: Vec<String> = frame.elements().map(|element| frame.print(element)).collect();
    /// assert_eq!(all, ["empty", "A & B", "A", "B", "Theta"]);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    #[must_use]
    pub fn elements(&self) -> Elements {
        let walk = if self.exclusive() {
            Walk::Subsets(0..1 << self.atoms().len())
        } else {
            Walk::Monotone(Box::new(Monotone::new(self)))
        };
        Elements { walk }
    }

    /// How many elements there are, ∅ among them: 2^n on n exclusive atoms, a Dedekind number less one on free
    /// ones. Under a hybrid model they are counted without being visited, which takes a millisecond on six
    /// atoms and less than a second on seven.
    ///
    /// ```
    /// # use wisdom_belief::Frame;
    /// assert_eq!(Frame::free(["A", "B", "C", "D"])?.element_count(), 167);
    /// assert_eq!(Frame::with_empty(["A", "B", "C"], &["A & B"])?.element_count(), 13);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    #[must_use]
    pub fn element_count(&self) -> u128 {
        let n = self.atoms().len();
        if self.exclusive() {
            1 << n
        } else if self.is_free() {
            FREE_COUNTS[n - 1]
        } else {
            counted(self)
        }
    }
}

/// The elements of a frame in rising order of their bit masks; made by [`Frame::elements`].
#[derive(Debug, Clone)]
pub struct Elements {
    walk: Walk,
}

#[derive(Debug, Clone)]
enum Walk {
    Subsets(Range<u128>),
    Monotone(Box<Monotone>),
}

impl Iterator for Elements {
    type Item = Element;

    #[inline]
    fn next(&mut self) -> Option<Element> {
        match &mut self.walk {
            Walk::Subsets(range) => range.next().map(Element),
            Walk::Monotone(walk) => walk.next(),
        }
    }
}

impl FusedIterator for Elements {}

/// What the parts of a function may be: those of the functions of the first atoms, cut to the regions that
/// exist there.
#[derive(Debug, Clone)]
struct Part {
    /// The regions that exist here.
    exists: u16,
    /// The truth tables, rising.
    tables: Vec<u16>,
    /// For each table those it holds, itself among them, rising; one list after another.
    held: Vec<u16>,
    /// Where each list starts, and where the last one ends.
    starts: Vec<usize>,
}

impl Part {
    fn new(exists: u16, functions: &[u16]) -> Self {
        let mut tables: Vec<u16> = functions.iter().map(|table| table & exists).collect();
        tables.sort_unstable();
        tables.dedup();
        Self { exists, tables, held: Vec::new(), starts: Vec::new() }
    }

    fn list_held(&mut self) {
        let (tables, held) = (&self.tables, &mut self.held);
        let mut end = 0;
        for (index, &table) in tables.iter().enumerate() {
            self.starts.push(end);
            held.resize(end + index + 1, 0);
            // What a table holds is no greater as a number. Each is written and kept or overwritten, since a
            // branch that is taken half the time costs more than five atoms have to spend.
            for &lower in &tables[..=index] {
                held[end] = lower;
                end += usize::from(lower & !table == 0);
            }
        }
        self.starts.push(end);
        held.truncate(end);
    }

    fn place(&self, table: u16) -> usize {
        self.tables.binary_search(&table).expect("bounds are functions of the same atoms")
    }

    fn held_by(&self, table: u16) -> Range<usize> {
        let place = self.place(table);
        self.starts[place]..self.starts[place + 1]
    }
}

/// The parts of the functions on a frame.
#[derive(Debug, Clone)]
struct Cut {
    /// Bits of a part's truth table.
    width: usize,
    parts: Vec<Part>,
}

impl Cut {
    fn new(frame: &Frame) -> Self {
        let n = frame.atoms().len();
        let first = n.min(TABLE_ATOMS);
        let (width, functions) = (1 << first, functions(first));
        // Bit s of a truth table is the region of the atom set s, of which the empty one does not exist.
        let exists = frame.theta().0 << 1;
        let part = |at: usize| {
            let all = u128::from(u16::MAX >> (u16::BITS as usize - width));
            Part::new((exists >> (at * width) & all) as u16, &functions)
        };
        Self { width, parts: (0..1 << (n - first)).map(part).collect() }
    }

    /// The largest table that part `at` may have, with the given tables above it: each atom more may only add.
    fn bound(&self, at: usize, tables: &[u16; MAX_PARTS]) -> u16 {
        let above = (0..self.parts.len().ilog2()).map(|bit| at | 1 << bit).filter(|&up| up != at);
        above.fold(self.parts[at].exists, |bound, up| bound & self.admits(up, tables[up]))
    }

    /// What a table admits below itself: what it holds, and what does not exist there.
    fn admits(&self, at: usize, table: u16) -> u16 {
        table | !self.parts[at].exists
    }
}

/// A walk over all functions in the order of their truth tables: the last part turns slowest.
#[derive(Debug, Clone)]
struct Monotone {
    cut: Cut,
    /// Each part's table as it is now, but for the first part.
    tables: [u16; MAX_PARTS],
    /// What is still to come of each part's list.
    ahead: [Range<usize>; MAX_PARTS],
    /// The truth table of all parts but the first.
    upper: u128,
}

impl Monotone {
    fn new(frame: &Frame) -> Self {
        let mut cut = Cut::new(frame);
        let last = cut.parts.len() - 1;
        cut.parts[..last].iter_mut().for_each(Part::list_held);
        let top = &mut cut.parts[last];
        top.held.clone_from(&top.tables); // only the list of the largest is asked for
        let mut walk = Self { cut, tables: [0; MAX_PARTS], ahead: Default::default(), upper: 0 };
        walk.ahead[last] = 0..walk.cut.parts[last].held.len();
        if last > 0 {
            walk.ahead[last].start = 1; // the table 0, which is where it stands
            walk.restart_below(last);
        }
        walk
    }

    #[inline]
    fn next(&mut self) -> Option<Element> {
        if self.ahead[0].is_empty() && !self.turn() {
            return None;
        }
        let at = self.ahead[0].next()?;
        Some(Element((self.upper | u128::from(self.cut.parts[0].held[at])) >> 1))
    }

    /// Turns the first part, but for part 0, that has a table left, and starts those before it anew.
    fn turn(&mut self) -> bool {
        for part in 1..self.cut.parts.len() {
            if let Some(at) = self.ahead[part].next() {
                self.tables[part] = self.cut.parts[part].held[at];
                self.restart_below(part);
                return true;
            }
        }
        false
    }

    fn restart_below(&mut self, part: usize) {
        for below in (0..part).rev() {
            let bound = self.cut.bound(below, &self.tables);
            self.ahead[below] = self.cut.parts[below].held_by(bound);
            self.tables[below] = 0;
            if below > 0 {
                self.ahead[below].start += 1;
            }
        }
        let shifted = |part: usize| u128::from(self.tables[part]) << (part * self.cut.width);
        self.upper = (1..self.cut.parts.len()).fold(0, |upper, part| upper | shifted(part));
    }
}

/// The truth tables of all monotone functions of up to four atoms, rising: each is a pair of functions of one
/// atom less, the one where the last atom fails within the one where it holds.
fn functions(atoms: usize) -> Vec<u16> {
    (0..atoms).fold(vec![0, 1], |fewer, atom| {
        let pairs = fewer.iter().flat_map(|&holds| {
            let fails = fewer.iter().filter(move |&fails| fails & !holds == 0);
            fails.map(move |fails| fails | holds << (1_u32 << atom))
        });
        pairs.collect()
    })
}

/// The number of elements on atoms that may overlap.
fn counted(frame: &Frame) -> u128 {
    let cut = Cut::new(frame);
    match cut.parts.len() {
        1 => cut.parts[0].tables.len() as u128,
        2 => {
            let [low, high] = [0, 1].map(|at| &cut.parts[at]);
            let below = |table: u16| within(low, 0, cut.admits(1, table) & low.exists);
            high.tables.iter().map(|&table| u128::from(below(table))).sum()
        }
        4 => counted_in_four(&cut),
        _ => counted_in_eight(&cut),
    }
}

/// The two parts in the middle are free of each other; given them, so are the first and the last.
fn counted_in_four(cut: &Cut) -> u128 {
    let mut count = 0;
    for &x in &cut.parts[1].tables {
        for &y in &cut.parts[2].tables {
            let lowest = cut.admits(1, x) & cut.admits(2, y) & cut.parts[0].exists;
            let highest = (x | y) & cut.parts[3].exists;
            let above = within(&cut.parts[3], highest, cut.parts[3].exists);
            count += u128::from(within(&cut.parts[0], 0, lowest)) * u128::from(above);
        }
    }
    count
}

/// Given the three parts under the last one, the last is free of the others; given the first as well, the
/// three above it are free of each other.
fn counted_in_eight(cut: &Cut) -> u128 {
    let [one, two, four] = [1, 2, 4].map(|at| Between::new(cut, at));
    let top = &cut.parts[7];
    let above: Vec<u32> = top.tables.iter().map(|&low| within(top, low, top.exists)).collect();
    let mut count = 0;
    for &x in &cut.parts[3].tables {
        let x_admits = cut.admits(3, x);
        for &y in &cut.parts[5].tables {
            let y_admits = cut.admits(5, y);
            let below_one = one.row(cut, x_admits & y_admits);
            for &z in &cut.parts[6].tables {
                let z_admits = cut.admits(6, z);
                let rows = below_one
                    .iter()
                    .zip(two.row(cut, x_admits & z_admits))
                    .zip(four.row(cut, y_admits & z_admits));
                let below: u64 = rows.map(|((&a, &b), &c)| u64::from(a * b * c)).sum();
                let above = above[top.place((x | y | z) & top.exists)];
                count += u128::from(below) * u128::from(above);
            }
        }
    }
    count
}

/// For each table a part may have, and each of the first part, how many of the part's tables lie between.
struct Between {
    at: usize,
    counts: Vec<Vec<u32>>,
}

impl Between {
    fn new(cut: &Cut, at: usize) -> Self {
        let (part, first) = (&cut.parts[at], &cut.parts[0]);
        let row = |&high: &u16| {
            first.tables.iter().map(|low| within(part, low & part.exists, high)).collect()
        };
        Self { at, counts: part.tables.iter().map(row).collect() }
    }

    fn row(&self, cut: &Cut, high: u16) -> &[u32] {
        let part = &cut.parts[self.at];
        &self.counts[part.place(high & part.exists)]
    }
}

/// How many tables of a part lie between two.
fn within(part: &Part, low: u16, high: u16) -> u32 {
    part.tables.iter().map(|&table| u32::from(low & !table == 0 && table & !high == 0)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(n: usize) -> Frame {
        Frame::free(["A", "B", "C", "D", "E", "F", "G"].into_iter().take(n)).expect("a frame")
    }

    #[test]
    fn counting_without_visiting_gives_the_dedekind_numbers() {
        for n in 1..=7 {
            assert_eq!(counted(&free(n)), FREE_COUNTS[n - 1], "{n} atoms");
        }
    }

    #[test]
    fn there_are_168_monotone_functions_of_four_atoms() {
        let sizes: Vec<usize> = (0..=4).map(|atoms| functions(atoms).len()).collect();
        assert_eq!(sizes, [2, 3, 6, 20, 168]);
    }
}
