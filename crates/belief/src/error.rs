//! What can be wrong with frames, masses and their combination.

use crate::frame::{MAX_EXCLUSIVE_ATOMS, MAX_OVERLAPPING_ATOMS};

/// Why something is not a frame, an element or a mass function, or why sources cannot be combined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BeliefError {
    /// A frame has no atom or more than its model can hold.
    #[error(
        "a frame of {atoms} atoms; it must have 1 to {limit} under this model \
         ({MAX_EXCLUSIVE_ATOMS} when they are exclusive, {MAX_OVERLAPPING_ATOMS} when they may overlap)"
    )]
    FrameSize {
        /// Atoms asked for.
        atoms: usize,
        /// The most the model holds.
        limit: usize,
    },
    /// An atom's name cannot be read back from an expression.
    #[error(
        "atom name {name:?}; a name has no spaces, &, |, parentheses and is not `empty` or `Theta`"
    )]
    AtomName {
        /// The rejected name.
        name: String,
    },
    /// Two atoms have the same name.
    #[error("atom `{name}` is named twice")]
    RepeatedAtom {
        /// The name.
        name: String,
    },
    /// The constraints of a hybrid model leave nothing that could be true.
    #[error("the model empties every element of the frame {{{atoms}}}")]
    EmptyFrame {
        /// The atoms of the frame.
        atoms: String,
    },
    /// An element was made on another frame or under another model.
    #[error("element of Venn regions {regions:#x} is not an element of the frame {{{atoms}}}")]
    ForeignElement {
        /// The element's bit mask.
        regions: u128,
        /// The atoms of the frame.
        atoms: String,
    },
    /// A refinement was given the wrong number of names.
    #[error("{names} names for {regions} Venn regions; each region becomes one atom")]
    RegionNames {
        /// Names given.
        names: usize,
        /// Regions of the model.
        regions: usize,
    },
    /// An expression does not follow the grammar.
    #[error("expression {text:?}, byte {at}: expected {expected}")]
    Expression {
        /// The whole expression.
        text: String,
        /// Byte offset of the fault.
        at: usize,
        /// What would have been right there.
        expected: &'static str,
    },
    /// An expression names something that is not an atom.
    #[error("expression {text:?}, byte {at}: `{name}` is not an atom; known: {known}")]
    UnknownAtom {
        /// The whole expression.
        text: String,
        /// Byte offset of the name.
        at: usize,
        /// The unknown name.
        name: String,
        /// The frame's atoms.
        known: String,
    },
    /// A mass that cannot be one: below 0, above 1 or NaN.
    #[error("m({element}) is {mass}; a mass lies in [0, 1]")]
    OutOfRange {
        /// Whose mass it is, as expressions write it.
        element: String,
        /// What was given.
        mass: f64,
    },
    /// An element is given a mass twice.
    #[error("m({element}) is given twice")]
    RepeatedElement {
        /// The element, as written in expressions.
        element: String,
    },
    /// All masses together are not 1.
    #[error("masses sum to {sum}; they must sum to 1 within {}", crate::SUM_TOLERANCE)]
    SumNotOne {
        /// What they come to.
        sum: f64,
    },
    /// The masses of an opinion, whose rest is ignorance, add up to more than one.
    #[error("masses of an opinion sum to {sum}; they must sum to at most 1")]
    SumAboveOne {
        /// The sum found.
        sum: f64,
    },
    /// An uncertainty is not in [0, 1].
    #[error("uncertainty is {value}; it lies in [0, 1]")]
    Uncertainty {
        /// The rejected value.
        value: f64,
    },
    /// A name that is none of the known ones.
    #[error("unknown {what} `{name}`; known: {known}")]
    UnknownName {
        /// What was to be named: a rule, a policy.
        what: &'static str,
        /// The name found.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The classic rule of DSmT was asked for on a model with empty intersections.
    #[error(
        "rule dsmc needs the free model; on the frame {{{atoms}}} some intersections are empty"
    )]
    NotFreeModel {
        /// The atoms of the frame.
        atoms: String,
    },
    /// A source commits mass to the empty element under a rule that gives it no meaning.
    #[error("source {index} has m(empty) = {mass}; rule {rule} needs 0")]
    MassOnEmpty {
        /// Which source, from 0.
        index: usize,
        /// Its mass on the empty element.
        mass: f64,
        /// The rule.
        rule: crate::Rule,
    },
    /// Dempster's rule has nothing left to divide by: every product fell on the empty element.
    #[error("{sources} sources contradict each other totally; Dempster's rule is undefined")]
    TotalConflict {
        /// How many sources were combined.
        sources: usize,
    },
    /// A rule that must visit every product of focal elements would visit too many.
    #[error("{products} products of focal elements; rule {rule} visits at most {limit}")]
    TooManyProducts {
        /// Products asked for (saturating).
        products: u64,
        /// The most that are visited.
        limit: u64,
        /// The rule.
        rule: crate::Rule,
    },
}
