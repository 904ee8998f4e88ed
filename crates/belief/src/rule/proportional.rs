//! Proportional conflict redistribution: conflict goes back to those who made it.
//!
//! `sums` comes in holding the products that met, and K is taken out of it; each rule adds the shares of the
//! conflict. Shares are added up by place, so that only as many additions by element are left as there are
//! focal elements. An element that the model empties takes no share; where that leaves none, Θ does.

use super::Rule;
use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::walk::{Choice, each_choice};
use crate::Number;
use crate::number::sum;

/// Memory for the shares, used again.
#[derive(Debug, Clone)]
pub(super) struct Shares<M, F> {
    /// What each focal element gets, by its place among all.
    by_place: Vec<F>,
    /// What nobody may take.
    unclaimed: F,
    /// The distinct elements of one product, or of all sources.
    groups: Vec<Group<M, F>>,
    /// Those of one product while `groups` holds those of all.
    of_product: Vec<Group<M, F>>,
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
            of_product: Vec::new(),
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
    places: &mut Vec<usize>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    shares.clear(bodies.focal().len());
    places.clear();
    let none = Prefix { meet: theta, product: F::one(), weight: F::zero() };
    pcr6_from(bodies, none, places, shares);
    shares.add_to(sums, bodies, theta);
}

/// What the elements chosen so far come to.
#[derive(Clone, Copy)]
struct Prefix<M, F> {
    meet: M,
    product: F,
    /// The sum of the masses of those that may take a share.
    weight: F,
}

/// The mass with which a focal element asks for its share.
#[inline]
fn claim<M: Mask, F: Number>((element, mass): (M, F)) -> F {
    if element.is_empty() { F::zero() } else { mass }
}

fn pcr6_from<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    Prefix { meet, product, weight }: Prefix<M, F>,
    places: &mut Vec<usize>,
    shares: &mut Shares<M, F>,
) {
    let range = bodies.range(places.len());
    if places.len() + 1 < bodies.len() {
        for place in range {
            let (element, mass) = bodies.focal()[place];
            let weight = weight + claim((element, mass));
            places.push(place);
            let next = Prefix { meet: meet & element, product: product * mass, weight };
            pcr6_from(bodies, next, places, shares);
            places.pop();
        }
        return;
    }
    let mut of_each_unit = F::zero();
    for place in range {
        let (element, mass) = bodies.focal()[place];
        if !(meet & element).is_empty() {
            continue;
        }
        let claim = claim((element, mass));
        let (conflict, whole) = (product * mass, weight + claim);
        if whole > F::zero() {
            let of_a_unit = conflict / whole;
            shares.by_place[place] += of_a_unit * claim;
            of_each_unit += of_a_unit;
        } else {
            shares.unclaimed += conflict;
        }
    }
    for &place in places.iter() {
        shares.by_place[place] += of_each_unit * claim(bodies.focal()[place]);
    }
}

/// The rules that redistribute product by product among the elements of the product.
pub(super) fn redistribute<M: Mask, F: Number>(
    rule: Rule,
    bodies: &Bodies<M, F>,
    theta: M,
    places: &mut Vec<usize>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    shares.clear(bodies.focal().len());
    let weights = Weights::new(rule, bodies, sums);
    each_choice(bodies, theta, places, &mut |Choice { places, meet, product }| {
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
    fn new<M: Mask>(rule: Rule, bodies: &Bodies<M, F>, met: &Accumulator<M, F>) -> Self {
        let places = 0..bodies.focal().len();
        let columns = || places.clone().map(|place| bodies.column(place)).collect();
        match rule {
            Rule::Pcr3 => Self::Columns(columns()),
            Rule::Pcr4 => Self::Met {
                met: bodies.focal().iter().map(|&(element, _)| met.mass(element)).collect(),
                columns: columns(),
            },
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
    groups.sort_by_key(|group| std::cmp::Reverse(size(group)));
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
    places: &mut Vec<usize>,
    shares: &mut Shares<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    let conflict = sums.take(M::EMPTY);
    shares.clear(bodies.focal().len());
    let Shares { groups, of_product, .. } = shares;
    distinct(bodies, groups);
    match rule {
        Rule::Urr => {
            for group in groups.iter_mut() {
                group.weight = F::one();
            }
        }
        Rule::Pcr2 if conflict > F::zero() => {
            for group in groups.iter_mut() {
                group.takes = false;
            }
            each_choice(bodies, theta, places, &mut |Choice { places, meet, .. }| {
                if !meet.is_empty() {
                    return;
                }
                Weights::Sums(Takers::Minimal).group(bodies, places, of_product);
                for found in of_product.iter().filter(|found| found.takes) {
                    let known = groups.iter_mut().find(|group| group.element == found.element);
                    known.expect("every focal element has a group").takes = true;
                }
            });
        }
        _ => {}
    }
    shares.share(conflict);
    shares.add_to(sums, bodies, theta);
}

/// The distinct elements of all sources, weighed by what all sources together give.
fn distinct<M: Mask, F: Number>(bodies: &Bodies<M, F>, groups: &mut Vec<Group<M, F>>) {
    groups.clear();
    for (place, &(element, _)) in bodies.focal().iter().enumerate() {
        if !element.is_empty() && bodies.first(place) == place {
            groups.push(Group { place, element, weight: bodies.column(place), takes: true });
        }
    }
}
