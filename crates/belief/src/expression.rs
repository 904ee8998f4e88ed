//! Elements as text: `A & (B | C)`, `empty`, `Theta`.

use crate::{BeliefError, Element, Frame, Model};

/// Parentheses may nest this deep: far beyond any element of seven atoms, and short of any stack.
const MAX_DEPTH: usize = 64;

impl Frame {
    /// Reads an expression: atom names, `&` (∩) binding tighter than `|` (∪), parentheses, `empty`, `Theta`.
    ///
    /// # Errors
    /// [`BeliefError::Expression`] or [`BeliefError::UnknownAtom`], with the place in the text.
    pub fn parse(&self, text: &str) -> Result<Element, BeliefError> {
        let mut parser = Parser { frame: self, text, at: 0 };
        let element = parser.union(0)?;
        match parser.peek() {
            None => Ok(element),
            Some(_) => Err(parser.expected("`&`, `|` or the end")),
        }
    }

    /// Writes an element as the shorter of its two minimal forms, a union of intersections or an
    /// intersection of unions; [`Frame::parse`] reads it back.
    #[must_use]
    pub fn print(&self, element: Element) -> String {
        if element.is_empty() {
            return "empty".to_owned();
        }
        if element == self.theta() {
            return "Theta".to_owned();
        }
        if *self.model() == Model::Shafer {
            let atoms = (0..self.atoms().len() as u32).filter(|atom| element.0 >> atom & 1 == 1);
            return self.join(atoms.fold(0, |set, atom| set | 1 << atom), " | ");
        }
        let (terms, clauses) = self.normal_forms(element);
        let literals = |sets: &[u64]| sets.iter().map(|set| set.count_ones()).sum::<u32>();
        if literals(&terms) <= literals(&clauses) {
            let terms: Vec<_> = terms.iter().map(|&set| self.join(set, " & ")).collect();
            return terms.join(" | ");
        }
        let alone = clauses.len() == 1;
        let clause = |&set: &u64| match self.join(set, " | ") {
            union if alone || set.is_power_of_two() => union,
            union => format!("({union})"),
        };
        clauses.iter().map(clause).collect::<Vec<_>>().join(" & ")
    }

    /// The minimal intersections whose union, and the minimal unions whose intersection, is the element; each
    /// as a bit set of atoms.
    fn normal_forms(&self, element: Element) -> (Vec<u64>, Vec<u64>) {
        let n = self.atoms().len();
        let full = (1_u64 << n) - 1;
        let up = self.up_closure(element).0;
        let holds = |set: u64| set != 0 && up >> (set - 1) & 1 == 1;
        let atoms = |set: u64| (0..n).map(|a| 1_u64 << a).filter(move |a| set & a != 0);
        let term = |&set: &u64| holds(set) && !atoms(set).any(|a| holds(set & !a));
        // A union covers the element unless the region of all other atoms belongs to it.
        let covers = |set: u64| !holds(full & !set);
        let clause = |&set: &u64| covers(set) && !atoms(set).any(|a| covers(set & !a));
        ((1..=full).filter(term).collect(), (1..=full).filter(clause).collect())
    }

    fn join(&self, set: u64, operator: &str) -> String {
        let named = self.atoms().iter().enumerate().filter(|(atom, _)| set >> atom & 1 == 1);
        named.map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(operator)
    }
}

struct Parser<'a> {
    frame: &'a Frame,
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn union(&mut self, depth: usize) -> Result<Element, BeliefError> {
        let mut element = self.intersection(depth)?;
        while self.take('|') {
            element = element | self.intersection(depth)?;
        }
        Ok(element)
    }

    fn intersection(&mut self, depth: usize) -> Result<Element, BeliefError> {
        let mut element = self.operand(depth)?;
        while self.take('&') {
            element = element & self.operand(depth)?;
        }
        Ok(element)
    }

    fn operand(&mut self, depth: usize) -> Result<Element, BeliefError> {
        if self.take('(') {
            if depth == MAX_DEPTH {
                return Err(self.expected("at most 64 parentheses within each other"));
            }
            let element = self.union(depth + 1)?;
            return if self.take(')') { Ok(element) } else { Err(self.expected("`)`")) };
        }
        self.name()
    }

    fn name(&mut self) -> Result<Element, BeliefError> {
        self.peek();
        let rest = &self.text[self.at..];
        let ends = |c: char| c.is_whitespace() || matches!(c, '&' | '|' | '(' | ')');
        let name = &rest[..rest.find(ends).unwrap_or(rest.len())];
        let element = match name {
            "" => return Err(self.expected("an atom, `empty`, `Theta` or `(`")),
            "empty" => Element::EMPTY,
            "Theta" => self.frame.theta(),
            _ => self.atom(name)?,
        };
        self.at += name.len();
        Ok(element)
    }

    fn atom(&self, name: &str) -> Result<Element, BeliefError> {
        let index = self.frame.atoms().iter().position(|atom| atom == name);
        index.and_then(|index| self.frame.atom(index)).ok_or_else(|| BeliefError::UnknownAtom {
            text: self.text.to_owned(),
            at: self.at,
            name: name.to_owned(),
            known: self.frame.atoms().join(", "),
        })
    }

    /// The next character that is not a space.
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += if found { wanted.len_utf8() } else { 0 };
        found
    }

    fn expected(&self, expected: &'static str) -> BeliefError {
        BeliefError::Expression { text: self.text.to_owned(), at: self.at, expected }
    }
}
