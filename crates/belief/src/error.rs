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
        "atom name {name:?}; a name has no spaces, &, |, parentheses or commas and is not `empty` or `Theta`"
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
    /// Two frames that should be models of the same atoms are not.
    #[error("the source frame has atoms {{{found}}}; it must have {{{expected}}}, in this order")]
    AtomsDiffer {
        /// The atoms of the frame that was given.
        found: String,
        /// The atoms of the frame it should agree with.
        expected: String,
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
    /// A rule has nothing left to divide by: every product fell on the empty element.
    #[error("{sources} sources contradict each other totally; rule {rule} is undefined")]
    TotalConflict {
        /// How many sources were combined.
        sources: usize,
        /// The rule.
        rule: crate::Rule,
    },
    /// A setting that only all sources together can have.
    #[error(
        "{setting} was given where two sources are taken at a time; it belongs to all of them at once"
    )]
    NotWhenFolding {
        /// What was given.
        setting: &'static str,
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
    /// A rule was given sources whose paradox it gives no meaning.
    #[error("rule {rule} does not admit the paradox policy {policy}")]
    PolicyNotAdmitted {
        /// The rule.
        rule: crate::Rule,
        /// The policy.
        policy: crate::ParadoxPolicy,
    },
    /// A rule whose sources can never be whole maps.
    #[error("no maps are made with rule {rule}: an unseen cell leaves it undefined")]
    NotOnMaps {
        /// The rule.
        rule: crate::Rule,
    },
    /// A closed form was given more sources than it takes.
    #[error("{sources} sources; rule {rule} takes at most {limit} here")]
    TooManySources {
        /// Sources found.
        sources: usize,
        /// The most it takes.
        limit: usize,
        /// The rule.
        rule: crate::Rule,
    },
    /// The planes of a map differ in length.
    #[error("plane {plane} has {found} cells; the first one has {expected}")]
    PlaneLength {
        /// What the plane holds, and of which source.
        plane: String,
        /// Its cells.
        found: usize,
        /// What the others have.
        expected: usize,
    },
    /// A table for class numbers has more rows than a byte can tell apart.
    #[error("a table of {rows} rows; a map's has at most {limit}")]
    TableRows {
        /// Rows found.
        rows: usize,
        /// The most there can be.
        limit: usize,
    },
    /// The bounds of bands are not in rising order, or not one less than the table's rows.
    #[error("{found} band bounds, rising up to number {rising}; a table of {rows} rows needs {} rising ones", rows.saturating_sub(1))]
    BandBounds {
        /// Bounds found.
        found: usize,
        /// How many of them rise.
        rising: usize,
        /// Rows of the table.
        rows: usize,
    },
    /// No Venn region of the frame lies inside exactly the named atoms.
    #[error(
        "no region inside exactly {{{named}}}; a region lies in one atom at least, and the model of the frame \
         {{{atoms}}} must not empty it"
    )]
    NoSuchRegion {
        /// The atoms that were named.
        named: String,
        /// The atoms of the frame.
        atoms: String,
    },
    /// A probability or a decision was asked for where all mass is on the empty element.
    #[error("all mass is on the empty element; some must be on another")]
    NothingPossible,
    /// A parameter is out of its range.
    #[error("{name} is {value}; it must be {expected}")]
    Parameter {
        /// Which parameter.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What it should be.
        expected: String,
    },
    /// A measure of a closed world was asked for in an open one.
    #[error("m(empty) is {mass}; {measure} is defined only where it is 0")]
    EmptyHasMass {
        /// The measure.
        measure: &'static str,
        /// The mass on the empty element.
        mass: f64,
    },
    /// A mass function was conditioned on what it holds to be impossible.
    #[error("Pl({element}) is 0; conditioning on it needs more")]
    Implausible {
        /// The element, as expressions write it.
        element: String,
    },
    /// There is nothing to choose from.
    #[error("no alternatives; a choice needs one at least")]
    NoAlternatives,
    /// More elements than an algorithm is meant for.
    #[error("more than {limit} elements; there may be no more here")]
    TooManyElements {
        /// The most there may be.
        limit: usize,
    },
    /// A list of values is not as long as the list of elements it goes with.
    #[error("{found} values; there must be one for each of {expected} elements")]
    ValueCount {
        /// Values found.
        found: usize,
        /// Elements there are.
        expected: usize,
    },
    /// A source leaves no ignorance, so that it has no conjunctive weights and cannot be taken back.
    #[error("source {index} has m(Theta) = 0; it must be above 0 here")]
    Dogmatic {
        /// Which source, from 0.
        index: usize,
    },
    /// A source rules out the empty element, so that it has no disjunctive weights.
    #[error("source {index} has m(empty) = 0; it must be above 0 here")]
    Normal {
        /// Which source, from 0.
        index: usize,
    },
    /// A weight of a canonical decomposition is out of the range of numbers.
    #[error("the weight of {element} comes to {weight}; it must be positive and finite")]
    Weight {
        /// The element, as expressions write it.
        element: String,
        /// What was computed.
        weight: f64,
    },
    /// A mass function that was never combined with what should be taken back.
    #[error("without that source m({element}) would be {mass}; it must be at least 0")]
    NotDecombinable {
        /// The element, as expressions write it.
        element: String,
        /// Its mass.
        mass: f64,
    },
    /// A mass function that cannot have been discounted by so much.
    #[error(
        "m(Theta) is {ignorance} after a discount by {uncertainty}; it must be at least that, which must be below 1"
    )]
    NotDiscounted {
        /// The mass on Θ.
        ignorance: f64,
        /// The discount to take back.
        uncertainty: f64,
    },
}

impl BeliefError {
    /// The kind of error as one word for programs: `total_conflict` (conditioning on what is impossible among
    /// it), `dogmatic`, `mass_on_empty` and so on.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::FrameSize { .. } => "frame_size",
            Self::AtomName { .. } => "atom_name",
            Self::RepeatedAtom { .. } => "repeated_atom",
            Self::EmptyFrame { .. } => "empty_frame",
            Self::ForeignElement { .. } => "foreign_element",
            Self::AtomsDiffer { .. } => "atoms_differ",
            Self::RegionNames { .. } => "region_names",
            Self::Expression { .. } => "expression",
            Self::UnknownAtom { .. } => "unknown_atom",
            Self::OutOfRange { .. } => "out_of_range",
            Self::RepeatedElement { .. } => "repeated_element",
            Self::SumNotOne { .. } => "sum_not_one",
            Self::SumAboveOne { .. } => "sum_above_one",
            Self::Uncertainty { .. } => "uncertainty",
            Self::UnknownName { .. } => "unknown_name",
            Self::NotFreeModel { .. } => "not_free_model",
            Self::MassOnEmpty { .. } => "mass_on_empty",
            Self::TotalConflict { .. } | Self::Implausible { .. } => "total_conflict",
            Self::NotWhenFolding { .. } => "not_when_folding",
            Self::TooManyProducts { .. } => "too_many_products",
            Self::PolicyNotAdmitted { .. } => "policy_not_admitted",
            Self::NotOnMaps { .. } => "not_on_maps",
            Self::TooManySources { .. } => "too_many_sources",
            Self::PlaneLength { .. } => "plane_length",
            Self::TableRows { .. } => "table_rows",
            Self::BandBounds { .. } => "band_bounds",
            Self::NoSuchRegion { .. } => "no_such_region",
            Self::NothingPossible => "nothing_possible",
            Self::Parameter { .. } => "parameter",
            Self::EmptyHasMass { .. } => "empty_has_mass",
            Self::NoAlternatives => "no_alternatives",
            Self::TooManyElements { .. } => "too_many_elements",
            Self::ValueCount { .. } => "value_count",
            Self::Dogmatic { .. } => "dogmatic",
            Self::Normal { .. } => "normal",
            Self::Weight { .. } => "weight",
            Self::NotDecombinable { .. } => "not_decombinable",
            Self::NotDiscounted { .. } => "not_discounted",
        }
    }
}
