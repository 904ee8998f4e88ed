//! Proportional conflict redistribution: conflict goes back to those who made it.
//!
//! `sums` comes in holding the products that met, and K is taken out of it; each rule adds the shares of the
//! conflict. Shares are added up by place, so that only as many additions by element are left as there are
//! focal elements. An element that the model empties takes no share; where that leaves none, Θ does.

use super::Rule;
use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::walk::{Choice, Odometer};
use crate::Number;
use crate::number::sum;

/// Memory for the shares, used again.
#[derive(Debug, Clone)]
pub(super) struct Shares<M, F> {
    /// What each focal element gets, by its place among all.
    by_place: Vec<F>,
    /// What nobody may take.
    unclaimed: F,
    /// The distinct elements of one product.
    groups: Vec<Group<M, F>>,
    /// What all sources together give to each element.
    columns: Accumulator<M, F>,
    /// The elements that take a share of the whole conflict, and their weights.
    takers: Accumulator<M, F>,
}

/// The sources of one product that said the same.
#[derive(Debug, Clone, Copy)]
struct Group<M, F> {
    place: usize,
    element: M,
    weight: F,
    takes: bool,
}

impl<M: Mask, F: Number> Shares<M, F> {
    pub(super) fn new() -> Self {
        Self {
            by_place: Vec::new(),
            unclaimed: F::zero(),
            groups: Vec::new(),
            columns: Accumulator::new(),
            takers: Accumulator::new(),
        }
    }

    fn clear(&mut self, places: usize) {
        self.by_place.clear();
        self.by_place.resize(places, F::zero());
        self.unclaimed = F::zero();
    }

    /// Shares an amount over the groups that take part, in proportion to their weights.
    fn share(&mut self, amount: F) {
        let taking = || self.groups.iter().filter(|group| group.takes);
        let whole = sum(taking().map(|group| group.weight));
        if whole > F::zero() {
            for group in self.groups.iter().filter(|group| group.takes) {
                self.by_place[group.place] += amount * group.weight / whole;
            }
        } else {
            self.unclaimed += amount;
        }
    }

    fn add_to(&self, sums: &mut Accumulator<M, F>, bodies: &Bodies<M, F>, theta: M) {
        for (&share, &(element, _)) in self.by_place.iter().zip(bodies.focal()) {
            sums.add(element, share);
        }
        sums.add(theta, self.unclaimed);
    }
}

/// PCR6 (Martin and Osswald 2006): each conflicting product is shared in proportion to the masses that made it.
///
/// The same as [`redistribute`] with weights that add up, with all that one choice of the first S − 1 elements
/// has in common taken out of the loop over the last source's: this is the rule that fuses most.
pub(super) fn pcr6<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    shares.clear(bodies.focal().len());
    let Shares { by_place, unclaimed, .. } = shares;
    let last = bodies.range(bodies.len() - 1);
    odometer.each_choice(bodies, bodies.len() - 1, theta, |Choice { places, meet, product }| {
        let weight = sum(places.iter().map(|&place| claim(bodies.focal()[place])));
        let mut of_each_unit = F::zero();
        for place in last.clone() {
            let (element, mass) = bodies.focal()[place];
            if !(meet & element).is_empty() {
                continue;
            }
            let claim = claim((element, mass));
            let (conflict, whole) = (product * mass, weight + claim);
            if whole > F::zero() {
                let of_a_unit = conflict / whole;
                by_place[place] += of_a_unit * claim;
                of_each_unit += of_a_unit;
            } else {
                *unclaimed += conflict;
            }
        }
        for &place in places {
            by_place[place] += of_each_unit * claim(bodies.focal()[place]);
        }
    });
    shares.add_to(sums, bodies, theta);
}

/// The mass with which a focal element asks for its share.
#[inline]
fn claim<M: Mask, F: Number>((element, mass): (M, F)) -> F {
    if element.is_empty() { F::zero() } else { mass }
}

/// The rules that redistribute product by product among the elements of the product.
pub(super) fn redistribute<M: Mask, F: Number>(
    rule: Rule,
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    shares.clear(bodies.focal().len());
    shares.columns.sum_up(bodies);
    let weights = Weights::new(rule, bodies, sums, &shares.columns);
    odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, product }| {
        if meet.is_empty() {
            weights.group(bodies, places, &mut shares.groups);
            shares.share(product);
        }
    });
    shares.add_to(sums, bodies, theta);
}

/// How the elements of a conflicting product are weighed against each other.
enum Weights<F> {
    /// By the products of the masses given to each (PCR5).
    Products(Takers),
    /// By their sums (PCR6).
    Sums(Takers),
    /// By what all sources together give (PCR3).
    Columns(Vec<F>),
    /// By what the conjunctive rule gives, where all have some; else as PCR3 (PCR4).
    Met { met: Vec<F>, columns: Vec<F> },
    /// All the same, and as often as it was said (PURR).
    Occurrences,
}

/// Which elements of a conflicting product take a share of it.
#[derive(Clone, Copy)]
enum Takers {
    All,
    /// Those whose binary keeping index is 1 (Dezert, Dezert and Smarandache 2021).
    Kept,
    /// Those that contain no other.
    Minimal,
}

impl<F: Number> Weights<F> {
    fn new<M: Mask>(
        rule: Rule,
        bodies: &Bodies<M, F>,
        met: &Accumulator<M, F>,
        columns: &Accumulator<M, F>,
    ) -> Self {
        let by_place = |sums: &Accumulator<M, F>| {
            bodies.focal().iter().map(|&(element, _)| sums.mass(element)).collect()
        };
        match rule {
            Rule::Pcr3 => Self::Columns(by_place(columns)),
            Rule::Pcr4 => Self::Met { met: by_place(met), columns: by_place(columns) },
            Rule::Pcr5 => Self::Products(Takers::All),
            Rule::Pcr5Plus => Self::Products(Takers::Kept),
            Rule::Pcr5Canonical => Self::Products(Takers::Minimal),
            Rule::Pcr6 => Self::Sums(Takers::All),
            Rule::Pcr6Plus => Self::Sums(Takers::Kept),
            Rule::Pcr6Canonical => Self::Sums(Takers::Minimal),
            Rule::Purr => Self::Occurrences,
            other => unreachable!("rule {other} does not redistribute product by product"),
        }
    }

    /// Groups the sources of one conflicting product by what they said, weighs them, and says who takes a share.
    fn group<M: Mask>(
        &self,
        bodies: &Bodies<M, F>,
        places: &[usize],
        groups: &mut Vec<Group<M, F>>,
    ) {
        groups.clear();
        for &place in places {
            let (element, mass) = bodies.focal()[place];
            if element.is_empty() {
                continue;
            }
            let weight = match self {
                Self::Products(_) | Self::Sums(_) => mass,
                Self::Columns(columns) => columns[place],
                Self::Met { met, .. } => met[place],
                Self::Occurrences => F::one(),
            };
            match groups.iter_mut().find(|group| group.element == element) {
                None => groups.push(Group { place, element, weight, takes: true }),
                Some(group) => match self {
                    Self::Products(_) => group.weight = group.weight * weight,
                    Self::Sums(_) | Self::Occurrences => group.weight += weight,
                    Self::Columns(_) | Self::Met { .. } => {}
                },
            }
        }
        match self {
            Self::Products(takers) | Self::Sums(takers) => takers.choose(groups),
            Self::Columns(_) => Takers::Minimal.choose(groups),
            Self::Met { columns, .. } => {
                Takers::Minimal.choose(groups);
                if groups.iter().any(|group| group.takes && group.weight == F::zero()) {
                    for group in groups.iter_mut() {
                        group.weight = columns[group.place];
                    }
                }
            }
            Self::Occurrences => {}
        }
    }
}

impl Takers {
    fn choose<M: Mask, F: Number>(self, groups: &mut [Group<M, F>]) {
        match self {
            Self::All => {}
            Self::Kept => keep(groups),
            Self::Minimal => {
                for index in 0..groups.len() {
                    groups[index].takes = is_minimal(groups, index);
                }
            }
        }
    }
}

fn is_minimal<M: Mask, F: Number>(groups: &[Group<M, F>], index: usize) -> bool {
    let element = groups[index].element;
    !groups.iter().any(|other| other.element != element && other.element.is_subset_of(element))
}

/// The binary keeping index: from the largest element down, one is kept if a strictly larger one was, and
/// otherwise unless it contains every other element that is no larger.
fn keep<M: Mask, F: Number>(groups: &mut [Group<M, F>]) {
    let size = |group: &Group<M, F>| group.element.cardinality();
    // What comes first among equally large ones does not matter: a taker must be strictly larger.
    groups.sort_unstable_by_key(|group| std::cmp::Reverse(size(group)));
    for index in 0..groups.len() {
        let Group { element, .. } = groups[index];
        let larger = groups[..index].iter().any(|g| g.takes && size(g) > element.cardinality());
        let contains_the_rest = || {
            let mut no_larger = groups.iter().filter(|g| size(g) <= element.cardinality());
            no_larger.all(|g| g.element.is_subset_of(element))
        };
        groups[index].takes = larger || !contains_the_rest();
    }
}

/// The rules that redistribute the whole conflict at once: PCR1 over all that was said, PCR2 over the minimal
/// elements of the conflicting products, both by column sums; URR over all that was said, evenly.
pub(super) fn redistribute_whole<M: Mask, F: Number>(
    rule: Rule,
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    let conflict = sums.take(M::EMPTY);
    let Shares { columns, takers, groups, .. } = shares;
    columns.sum_up(bodies);
    takers.clear();
    if rule == Rule::Pcr2 {
        odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, .. }| {
            if meet.is_empty() {
                Weights::Sums(Takers::Minimal).group(bodies, places, groups);
                let minimal = groups.iter().filter(|group| group.takes);
                minimal.for_each(|group| takers.add(group.element, F::zero()));
            }
        });
        takers.scale(|element, _| columns.mass(element));
    } else {
        let weight = |column| if rule == Rule::Urr { F::one() } else { column };
        takers.add_each(columns.entries(), |element, column| (element, weight(column)));
    }
    let whole = sum(takers.entries().iter().map(|&(_, weight)| weight));
    if whole > F::zero() {
        sums.add_each(takers.entries(), |element, weight| (element, conflict * weight / whole));
    } else {
        sums.add(theta, conflict);
    }
}

impl<M: Mask, F: Number> Accumulator<M, F> {
    /// c(X): what all sources together give to each element; ∅ aside, which takes no share.
    fn sum_up(&mut self, bodies: &Bodies<M, F>) {
        self.clear();
        let said = bodies.focal().iter().filter(|(element, _)| !element.is_empty());
        said.for_each(|&(element, mass)| self.add(element, mass));
    }
}
