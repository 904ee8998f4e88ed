//! What a rule is asked, and the rules whose products go to one place each.

use std::collections::BTreeMap;

use wisdom_belief::{Number, Rule};

use super::venn::{Set, Venn};
use super::{Exact, redistribution};

/// Masses of elements; the focal ones only.
pub(crate) type Body = BTreeMap<Set, Exact>;

/// Why a rule has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Undefined {
    /// Nothing is left to scale up.
    TotalConflict,
    /// A source has no mass on Θ.
    Dogmatic,
    /// A source has no mass on ∅.
    Normal,
    /// The classic rule of `DSmT` where an intersection is empty.
    NotFreeModel,
    /// A source commits mass to ∅.
    MassOnEmpty,
}

/// Sources given under one model, to be combined under another (often the same).
#[derive(Debug, Clone)]
pub(crate) struct Question {
    pub(crate) sources: Vec<Body>,
    /// The model under which the sources spoke, if that was another.
    pub(crate) given: Option<Venn>,
    /// The model under which they are combined.
    pub(crate) venn: Venn,
    pub(crate) inagaki_k: Exact,
    pub(crate) weights: Option<Vec<Exact>>,
}

/// One focal element of each source, with its mass.
pub(crate) type Product = Vec<(Set, Exact)>;

/// Adds to a mass.
pub(crate) fn give(body: &mut Body, set: Set, mass: Exact) {
    let sum = body.get(&set).map_or(mass, |&before| before + mass);
    body.insert(set, sum);
}

pub(crate) fn sum(numbers: impl IntoIterator<Item = Exact>) -> Exact {
    numbers.into_iter().fold(Exact::zero(), |a, b| a + b)
}

pub(crate) fn product_of(numbers: impl IntoIterator<Item = Exact>) -> Exact {
    numbers.into_iter().fold(Exact::one(), |a, b| a * b)
}

fn count(set: &Set) -> Exact {
    Exact::count(u32::try_from(set.len()).expect("few regions"))
}

/// Every way to pick one focal element of each source.
pub(crate) fn products(sources: &[Body]) -> Vec<Product> {
    let mut products = vec![Product::new()];
    for source in sources {
        let longer = |product: &Product| {
            let product = product.clone();
            source.iter().map(move |(set, &mass)| [&product[..], &[(set.clone(), mass)]].concat())
        };
        products = products.iter().flat_map(longer).collect();
    }
    products
}

/// π: the product of the masses.
pub(crate) fn weight(product: &[(Set, Exact)]) -> Exact {
    product_of(product.iter().map(|&(_, mass)| mass))
}

/// The intersection of all, Θ for no source.
pub(crate) fn meet(product: &[(Set, Exact)], venn: &Venn) -> Set {
    product.iter().fold(venn.theta.clone(), |meet, (set, _)| &meet & set)
}

/// The union of all.
pub(crate) fn join(product: &[(Set, Exact)]) -> Set {
    product.iter().fold(Set::new(), |join, (set, _)| &join | set)
}

impl Question {
    /// The sources as the target model sees them: what it empties becomes ∅, what it makes equal adds up.
    pub(crate) fn seen(&self) -> Vec<Body> {
        let seen = |source: &Body| {
            let mut seen = Body::new();
            for (set, &mass) in source {
                give(&mut seen, self.venn.project(set), mass);
            }
            seen
        };
        self.sources.iter().map(seen).collect()
    }

    fn refuse_empty(&self, rule: Rule) -> Result<(), Undefined> {
        let open_world = matches!(
            rule,
            Rule::Conjunctive
                | Rule::Dempster
                | Rule::Disjunctive
                | Rule::Average
                | Rule::Murphy
                | Rule::Cautious
                | Rule::Bold
        );
        let committed = self.sources.iter().any(|source| source.contains_key(&Set::new()));
        if committed && !open_world { Err(Undefined::MassOnEmpty) } else { Ok(()) }
    }

    /// The masses that a rule makes of the sources, all at once; zeros are left out.
    pub(crate) fn answer(&self, rule: Rule) -> Result<Body, Undefined> {
        if self.sources.is_empty() {
            return Ok(Body::from([(self.venn.theta.clone(), Exact::one())]));
        }
        if rule == Rule::Dsmc && !self.venn.is_free() {
            return Err(Undefined::NotFreeModel);
        }
        self.refuse_empty(rule)?;
        let mut body = self.answer_with_zeros(rule)?;
        body.retain(|_, mass| *mass != Exact::zero());
        Ok(body)
    }

    fn answer_with_zeros(&self, rule: Rule) -> Result<Body, Undefined> {
        let (sources, venn) = (&self.seen()[..], &self.venn);
        match rule {
            Rule::Dsmc | Rule::Conjunctive => Ok(conjunctive(sources, venn)),
            Rule::Disjunctive => Ok(disjunctive(sources)),
            Rule::Dempster => dempster(sources, venn),
            Rule::Yager => Ok(inagaki(sources, venn, Exact::zero())),
            Rule::Inagaki => Ok(inagaki(sources, venn, self.inagaki_k)),
            Rule::DuboisPrade => Ok(dubois_prade(sources, venn)),
            Rule::Dsmh => Ok(self.dsmh()),
            Rule::Florea => Ok(florea(sources, venn)),
            Rule::Average => Ok(mean(sources, self.weights.as_deref())),
            Rule::Murphy => self_combined(&mean(sources, None), sources.len(), venn),
            Rule::Deng => deng(sources, venn),
            Rule::Zhang | Rule::Jaccard => centre(sources, venn, rule),
            Rule::Cautious => cautious(sources, venn),
            Rule::Bold => bold(sources, venn),
            _ => Ok(redistribution::answer(rule, sources, venn)),
        }
    }

    /// S1, S2 and S3 of Dezert and Smarandache (2004). An element that the target empties still has its atoms.
    fn dsmh(&self) -> Body {
        let given = self.given.as_ref().unwrap_or(&self.venn);
        let mut body = Body::new();
        for product in products(&self.sources) {
            let target = |set: &Set| self.venn.project(set);
            let meet = target(&meet(&product, given));
            let home = if !meet.is_empty() {
                meet
            } else if product.iter().all(|(set, _)| target(set).is_empty()) {
                let atoms = product.iter().map(|(set, _)| given.union_of_atoms(set));
                let union = target(&atoms.fold(Set::new(), |all, atoms| &all | &atoms));
                if union.is_empty() { self.venn.theta.clone() } else { union }
            } else {
                target(&join(&product))
            };
            give(&mut body, home, weight(&product));
        }
        body
    }
}

pub(crate) fn conjunctive(sources: &[Body], venn: &Venn) -> Body {
    let mut body = Body::new();
    for product in products(sources) {
        give(&mut body, meet(&product, venn), weight(&product));
    }
    body
}

fn disjunctive(sources: &[Body]) -> Body {
    let mut body = Body::new();
    for product in products(sources) {
        give(&mut body, join(&product), weight(&product));
    }
    body
}

/// Divides by what is left without ∅.
fn normalised(mut body: Body) -> Result<Body, Undefined> {
    body.remove(&Set::new());
    let left = sum(body.values().copied());
    if left == Exact::zero() {
        return Err(Undefined::TotalConflict);
    }
    Ok(body.into_iter().map(|(set, mass)| (set, mass / left)).collect())
}

fn dempster(sources: &[Body], venn: &Venn) -> Result<Body, Undefined> {
    normalised(conjunctive(sources, venn))
}

/// m(A)(1 + kK), and Θ gets (1 + kK − k)K more.
fn inagaki(sources: &[Body], venn: &Venn, k: Exact) -> Body {
    let mut body = conjunctive(sources, venn);
    let conflict = body.remove(&Set::new()).unwrap_or_else(Exact::zero);
    let factor = Exact::one() + k * conflict;
    body = body.into_iter().map(|(set, mass)| (set, mass * factor)).collect();
    give(&mut body, venn.theta.clone(), (factor - k) * conflict);
    body
}

fn dubois_prade(sources: &[Body], venn: &Venn) -> Body {
    let mut body = Body::new();
    for product in products(sources) {
        let meet = meet(&product, venn);
        let home = if meet.is_empty() { join(&product) } else { meet };
        give(&mut body, home, weight(&product));
    }
    body.remove(&Set::new());
    body
}

/// K/(1 − K + K²) of the disjunctive and (1 − K)/(1 − K + K²) of the conjunctive mass of each A ≠ ∅.
fn florea(sources: &[Body], venn: &Venn) -> Body {
    let (meets, joins) = (conjunctive(sources, venn), disjunctive(sources));
    let k = meets.get(&Set::new()).copied().unwrap_or_else(Exact::zero);
    let one = Exact::one();
    let below = one - k + k * k;
    let mut body = Body::new();
    for (masses, share) in [(joins, k / below), (meets, (one - k) / below)] {
        for (set, mass) in masses.into_iter().filter(|(set, _)| !set.is_empty()) {
            give(&mut body, set, mass * share);
        }
    }
    body
}

fn mean(sources: &[Body], weights: Option<&[Exact]>) -> Body {
    let equal = vec![Exact::one(); sources.len()];
    let weights = weights.unwrap_or(&equal);
    let all = sum(weights.iter().copied());
    let mut body = Body::new();
    for (source, &weight) in sources.iter().zip(weights) {
        for (set, &mass) in source {
            give(&mut body, set.clone(), mass * weight / all);
        }
    }
    body
}

/// Dempster's rule of so many copies.
fn self_combined(body: &Body, copies: usize, venn: &Venn) -> Result<Body, Undefined> {
    let positive = body.iter().filter(|&(_, &mass)| mass != Exact::zero());
    let body: Body = positive.map(|(set, &mass)| (set.clone(), mass)).collect();
    dempster(&vec![body; copies], venn)
}

/// |A ∩ B| / |A ∪ B|, 1 for two empty ones.
fn overlap(a: &Set, b: &Set) -> Exact {
    if a == b { Exact::one() } else { count(&(a & b)) / count(&(a | b)) }
}

/// Jousselme's distance: √(½ Σ d(A) d(B) |A ∩ B| / |A ∪ B|) of d = a − b; exact but for the root.
pub(crate) fn jousselme(a: &Body, b: &Body) -> Exact {
    let mut difference = a.clone();
    for (set, &mass) in b {
        give(&mut difference, set.clone(), Exact::zero() - mass);
    }
    let mut square = Exact::zero();
    for (x, &of_x) in &difference {
        for (y, &of_y) in &difference {
            square += of_x * of_y * overlap(x, y);
        }
    }
    (square / Exact::count(2)).sqrt()
}

/// Each source weighs as much as it agrees with the others in all; the weighted mean combines as Murphy's does.
/// Sources that do not agree at all weigh the same, which the publication leaves open.
fn deng(sources: &[Body], venn: &Venn) -> Result<Body, Undefined> {
    let support = |s: usize| {
        let others = (0..sources.len()).filter(|&r| r != s);
        sum(others.map(|r| Exact::one() - jousselme(&sources[s], &sources[r])))
    };
    let weights: Vec<Exact> = (0..sources.len()).map(support).collect();
    let agree = weights.iter().any(|&weight| weight > Exact::zero());
    self_combined(&mean(sources, agree.then_some(&weights[..])), sources.len(), venn)
}

/// Zhang: π times |∩| over the product of all |X|, to ∩. Jaccard: π times |∩| over |∪|.
fn centre(sources: &[Body], venn: &Venn, rule: Rule) -> Result<Body, Undefined> {
    let mut body = Body::new();
    for product in products(sources) {
        let meet = meet(&product, venn);
        if meet.is_empty() {
            continue;
        }
        let below = match rule {
            Rule::Zhang => product_of(product.iter().map(|(set, _)| count(set))),
            _ => count(&join(&product)),
        };
        let share = weight(&product) * count(&meet) / below;
        give(&mut body, meet, share);
    }
    normalised(body)
}

/// The elements from large to small.
fn descending(venn: &Venn) -> Vec<Set> {
    let mut elements: Vec<Set> = venn.elements().into_iter().collect();
    elements.sort_by_key(|set| std::cmp::Reverse(set.len()));
    elements
}

fn mass_of(body: &Body, set: &Set) -> Exact {
    body.get(set).copied().unwrap_or_else(Exact::zero)
}

/// The minimum of the weights w(A) = m(Θ) / (q(A) Π w(B)), B ⊋ A, over every element A ≠ Θ; then back from
/// q(X) = Π w(A), A ⊉ X, to masses.
fn cautious(sources: &[Body], venn: &Venn) -> Result<Body, Undefined> {
    let elements = descending(venn);
    let mut least = BTreeMap::<Set, Exact>::new();
    for source in sources {
        if mass_of(source, &venn.theta) == Exact::zero() {
            return Err(Undefined::Dogmatic);
        }
        for (set, weight) in conjunctive_weights(source, &elements, venn) {
            let other = least.get(&set).copied().unwrap_or(weight);
            least.insert(set, weight.least(other));
        }
    }
    let commonality = |x: &Set| {
        product_of(least.iter().filter(|(a, _)| !x.is_subset(a)).map(|(_, &weight)| weight))
    };
    let mut body = Body::new();
    for set in &elements {
        let above = body.iter().filter(|(other, _)| set.is_subset(other)).map(|(_, &mass)| mass);
        let mass = commonality(set) - sum(above);
        body.insert(set.clone(), mass);
    }
    Ok(body)
}

fn conjunctive_weights(source: &Body, elements: &[Set], venn: &Venn) -> BTreeMap<Set, Exact> {
    let mut weights = BTreeMap::<Set, Exact>::new();
    for a in elements.iter().filter(|&a| *a != venn.theta) {
        let above = source.iter().filter(|(set, _)| a.is_subset(set));
        let commonality = sum(above.map(|(_, &mass)| mass));
        let larger = weights.iter().filter(|(b, _)| a.is_subset(b)).map(|(_, &weight)| weight);
        let weight = mass_of(source, &venn.theta) / (commonality * product_of(larger));
        weights.insert(a.clone(), weight);
    }
    weights
}

/// The dual: the minimum of v(A) = m(∅) / (b(A) Π v(B)), ∅ ≠ B ⊊ A, over every A ≠ ∅; then back from
/// b(X) = Π v(A), A ⊄ X, to masses.
fn bold(sources: &[Body], venn: &Venn) -> Result<Body, Undefined> {
    let elements: Vec<Set> = descending(venn).into_iter().rev().collect();
    let mut least = BTreeMap::<Set, Exact>::new();
    for source in sources {
        if mass_of(source, &Set::new()) == Exact::zero() {
            return Err(Undefined::Normal);
        }
        for (set, weight) in disjunctive_weights(source, &elements) {
            let other = least.get(&set).copied().unwrap_or(weight);
            least.insert(set, weight.least(other));
        }
    }
    let implicability = |x: &Set| {
        product_of(least.iter().filter(|(a, _)| !a.is_subset(x)).map(|(_, &weight)| weight))
    };
    let mut body = Body::new();
    for set in &elements {
        let below = body.iter().filter(|(other, _)| other.is_subset(set)).map(|(_, &mass)| mass);
        let mass = implicability(set) - sum(below);
        body.insert(set.clone(), mass);
    }
    Ok(body)
}

fn disjunctive_weights(source: &Body, elements: &[Set]) -> BTreeMap<Set, Exact> {
    let mut weights = BTreeMap::<Set, Exact>::new();
    for a in elements.iter().filter(|a| !a.is_empty()) {
        let below = source.iter().filter(|(set, _)| set.is_subset(a));
        let implicability = sum(below.map(|(_, &mass)| mass));
        let smaller = weights.iter().filter(|(b, _)| b.is_subset(a)).map(|(_, &weight)| weight);
        let weight = mass_of(source, &Set::new()) / (implicability * product_of(smaller));
        weights.insert(a.clone(), weight);
    }
    weights
}
