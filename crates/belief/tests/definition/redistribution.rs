//! Rules that give conflict back to what made it.

use std::collections::BTreeMap;

use wisdom_belief::{Number, Rule};

use super::Exact;
use super::rules::{
    Body, Product, conjunctive, give, join, meet, product_of, products, sum, weight,
};
use super::venn::{Set, Venn};

/// The conjunctive mass of what meets, and every conflicting product redistributed.
pub(crate) fn answer(rule: Rule, sources: &[Body], venn: &Venn) -> Body {
    let meets = conjunctive(sources, venn);
    let (conflicts, agreeing): (Vec<Product>, Vec<Product>) =
        products(sources).into_iter().partition(|product| meet(product, venn).is_empty());
    let mut body = Body::new();
    for product in &agreeing {
        give(&mut body, meet(product, venn), weight(product));
    }
    let columns = columns(sources);
    let to_all = |shares: &Body, body: &mut Body| {
        for product in &conflicts {
            share_out(weight(product), shares, venn, body);
        }
    };
    match rule {
        Rule::Pcr1 => to_all(&columns, &mut body),
        Rule::Pcr2 => {
            let involved: Vec<Set> = conflicts.iter().flat_map(minimal).collect();
            to_all(&only(&columns, &involved), &mut body);
        }
        Rule::Urr => {
            let equal = columns.keys().map(|set| (set.clone(), Exact::one())).collect();
            to_all(&equal, &mut body);
        }
        _ => {
            for product in &conflicts {
                let shares = shares(rule, product, &columns, &meets);
                share_out(weight(product), &shares, venn, &mut body);
            }
        }
    }
    body
}

/// c(X): all that the sources give to X ≠ ∅.
fn columns(sources: &[Body]) -> Body {
    let mut columns = Body::new();
    for (set, &mass) in sources.iter().flatten().filter(|(set, _)| !set.is_empty()) {
        give(&mut columns, set.clone(), mass);
    }
    columns
}

fn only(body: &Body, sets: &[Set]) -> Body {
    body.iter()
        .filter(|(set, _)| sets.contains(set))
        .map(|(set, &mass)| (set.clone(), mass))
        .collect()
}

/// Splits a mass in proportion to shares; Θ gets it when nothing has one.
fn share_out(mass: Exact, shares: &Body, venn: &Venn, body: &mut Body) {
    let all = sum(shares.values().copied());
    if all == Exact::zero() {
        give(body, venn.theta.clone(), mass);
        return;
    }
    for (set, &share) in shares {
        give(body, set.clone(), mass * share / all);
    }
}

/// Who has a share in one conflicting product, and how much.
fn shares(rule: Rule, product: &Product, columns: &Body, meets: &Body) -> Body {
    match rule {
        Rule::Pcr3 => only(columns, &minimal(product)),
        Rule::Pcr4 => {
            let by_meets = only(meets, &minimal(product));
            if by_meets.len() == minimal(product).len() {
                by_meets
            } else {
                only(columns, &minimal(product))
            }
        }
        Rule::Pcr5 => groups(product, product_of),
        Rule::Pcr6 => groups(product, sum),
        Rule::Pcr5Plus => only(&groups(product, product_of), &kept(product)),
        Rule::Pcr6Plus => only(&groups(product, sum), &kept(product)),
        Rule::Pcr5Canonical => only(&groups(product, product_of), &minimal(product)),
        Rule::Pcr6Canonical => only(&groups(product, sum), &minimal(product)),
        Rule::Purr => {
            let mut occurrences = Body::new();
            for (set, _) in product.iter().filter(|(set, _)| !set.is_empty()) {
                give(&mut occurrences, set.clone(), Exact::one());
            }
            occurrences
        }
        Rule::MinC => {
            let union = join(product);
            let parts: Vec<Set> =
                meets.keys().filter(|z| !z.is_empty() && z.is_subset(&union)).cloned().collect();
            if parts.is_empty() && !union.is_empty() {
                return Body::from([(union, Exact::one())]);
            }
            only(meets, &parts)
        }
        _ => panic!("{rule} does not redistribute conflict"),
    }
}

/// The distinct elements X ≠ ∅ of a product, each with a function of all the masses it was given there.
fn groups(product: &Product, of: impl Fn(Vec<Exact>) -> Exact) -> Body {
    let mut groups = BTreeMap::<Set, Vec<Exact>>::new();
    for (set, mass) in product.iter().filter(|(set, _)| !set.is_empty()) {
        groups.entry(set.clone()).or_default().push(*mass);
    }
    groups.into_iter().map(|(set, masses)| (set, of(masses))).collect()
}

fn distinct(product: &Product) -> Vec<Set> {
    groups(product, sum).into_keys().collect()
}

/// The elements that hold no other one of the product.
fn minimal(product: &Product) -> Vec<Set> {
    let sets = distinct(product);
    let holds_none = |x: &Set| !sets.iter().any(|y| y != x && y.is_subset(x));
    sets.iter().filter(|x| holds_none(x)).cloned().collect()
}

/// The elements whose keeping index is 1 (Dezert, Dezert and Smarandache 2021): an element that holds all
/// those of no greater cardinality took no part in the conflict, unless a larger one did.
fn kept(product: &Product) -> Vec<Set> {
    let mut sets = distinct(product);
    sets.sort_by_key(|set| std::cmp::Reverse(set.len()));
    let mut kept = Vec::<Set>::new();
    for x in &sets {
        let after_larger = kept.iter().any(|larger| larger.len() > x.len());
        let mut others = sets.iter().filter(|y| *y != x && y.len() <= x.len());
        if after_larger || !others.all(|y| y.is_subset(x)) {
            kept.push(x.clone());
        }
    }
    kept
}
