//! The forward search that turns a goal into operators: A* over the facts that hold and whether the rover has driven.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::{Domain, Expansion, FactSet, MAX_FACTS, ServiceCost};

/// Price of a series of operators: whole milliseconds above, how many operators in the lower half.
type Price = u128;

/// More than any series costs.
const NEVER: Price = Price::MAX;

/// What promises how far the end is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Heuristic {
    /// The dearest single fact wanted, as if nothing were ever deleted (Bonet and Geffner 2001).
    Max,
    /// Nothing is promised, which makes the search Dijkstra's: what others are measured against.
    #[cfg(test)]
    Blind,
}

/// A state of the search: the facts that hold, and whether the drive is behind.
type State = (FactSet, bool);

/// One expansion's search.
struct Search<'a> {
    domain: &'a Domain,
    wanted: FactSet,
    /// Operators that may be of use, by index, with their prices.
    useful: Vec<(usize, Price)>,
    heuristic: Heuristic,
}

/// The best expansion, and how many states were expanded to find it.
pub(super) fn expand(
    domain: &Domain,
    facts: FactSet,
    wanted: FactSet,
    heuristic: Heuristic,
) -> (Option<Expansion>, usize) {
    let search = Search { domain, wanted, useful: useful(domain, wanted), heuristic };
    let start = (facts, false);
    let (known, best) = search.forward(start);
    let expanded = known.values().filter(|known| known.expanded).count();
    let expansion = best.map(|best| search.first_of_the_best(start, &known, best));
    (expansion, expanded)
}

/// The operators that add something wanted, or something that such an operator needs. In a cheapest series there is no
/// other: without it the rest would still be possible, and cheaper.
fn useful(domain: &Domain, wanted: FactSet) -> Vec<(usize, Price)> {
    let mut needed = wanted.with(domain.operators[domain.drive].preconditions);
    loop {
        let more = domain
            .operators
            .iter()
            .filter(|o| o.adds.meets(needed))
            .fold(needed, |all, o| all.with(o.preconditions));
        if more == needed {
            break;
        }
        needed = more;
    }
    let price = |index: usize| {
        let ms = (domain.operators[index].cost.time_s * 1000.0) as u64;
        Price::from(ms) << 64 | 1
    };
    (0..domain.operators.len())
        .filter(|&i| i == domain.drive || domain.operators[i].adds.meets(needed))
        .map(|i| (i, price(i)))
        .collect()
}

/// What is known of a state.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Price of the best way here met so far.
    price: Price,
    /// Promise of what is still to come; never too much.
    ahead: Price,
    expanded: bool,
}

impl Search<'_> {
    fn is_done(&self, (facts, driven): State) -> bool {
        driven && facts.contains(self.wanted)
    }

    /// The states one operator further, in the order of the operators.
    fn successors(&self, (facts, driven): State) -> impl Iterator<Item = (usize, Price, State)> {
        self.useful.iter().filter_map(move |&(index, price)| {
            let drives = index == self.domain.drive;
            if drives && driven {
                return None;
            }
            let after = self.domain.step(facts, index, self.wanted)?;
            let state = (after, driven || drives);
            (state != (facts, driven)).then_some((index, price, state))
        })
    }

    /// A* until all states that some best way may pass through are expanded: the price of the best way, if there is one.
    fn forward(&self, start: State) -> (BTreeMap<State, Known>, Option<Price>) {
        let mut known = BTreeMap::new();
        let mut open = BinaryHeap::new();
        let mut best: Option<Price> = None;
        let ahead = self.ahead(start);
        if ahead == NEVER {
            return (known, None);
        }
        known.insert(start, Known { price: 0, ahead, expanded: false });
        open.push(Reverse((ahead, 0, start)));
        while let Some(Reverse((whole, price, state))) = open.pop() {
            if best.is_some_and(|best| whole > best) {
                break;
            }
            let here = known.get_mut(&state).expect("what is open is known");
            if here.expanded || price > here.price {
                continue;
            }
            here.expanded = true;
            if self.is_done(state) {
                best.get_or_insert(price);
                continue;
            }
            for (_, step, next) in self.successors(state) {
                let price = price + step;
                let there = known.entry(next).or_insert_with(|| Known {
                    price: NEVER,
                    ahead: self.ahead(next),
                    expanded: false,
                });
                if there.ahead != NEVER && price < there.price {
                    there.price = price;
                    there.expanded = false;
                    open.push(Reverse((price + there.ahead, price, next)));
                }
            }
        }
        (known, best)
    }

    /// Of all ways at the best price the first in the order of the operators' numbers.
    fn first_of_the_best(
        &self,
        start: State,
        known: &BTreeMap<State, Known>,
        best: Price,
    ) -> Expansion {
        // States from which a best way goes on, found from its end backwards: every operator has a price.
        let mut by_price: Vec<(Price, State)> =
            known.iter().filter(|(_, k)| k.expanded).map(|(s, k)| (k.price, *s)).collect();
        by_price.sort_unstable();
        let mut leading: BTreeMap<State, Option<(usize, State)>> = BTreeMap::new();
        for &(price, state) in by_price.iter().rev() {
            if self.is_done(state) {
                if price == best {
                    leading.insert(state, None);
                }
                continue;
            }
            let first = self.successors(state).find(|(_, step, next)| {
                leading.contains_key(next) && known[next].price == price + step
            });
            if let Some((index, _, next)) = first {
                leading.insert(state, Some((index, next)));
            }
        }
        let mut expansion = Expansion {
            before: Vec::new(),
            after: Vec::new(),
            facts: start.0,
            cost: ServiceCost::default(),
        };
        let mut at = start;
        while let Some((index, next)) = leading[&at] {
            expansion.cost += self.domain.operators[index].cost;
            if index != self.domain.drive {
                let part = if at.1 { &mut expansion.after } else { &mut expansion.before };
                part.push(index);
            }
            at = next;
        }
        expansion.facts = at.0;
        expansion
    }

    /// A promise of the price still to come: never more than it is, [`NEVER`] only if there is no way.
    fn ahead(&self, state: State) -> Price {
        match self.heuristic {
            Heuristic::Max => self.max(state),
            #[cfg(test)]
            Heuristic::Blind => 0,
        }
    }

    /// `h_max`. A fact before the drive and the same fact after it are two: the drive carries all but the wanted ones over.
    fn max(&self, (facts, driven): State) -> Price {
        let mut before = Relaxed::default();
        let mut after = Relaxed::default();
        if driven {
            after.reach(facts, 0);
        } else {
            before.reach(facts, 0);
            self.spread(&mut before);
            let drive = &self.domain.operators[self.domain.drive];
            let ready = before.dearest(drive.preconditions);
            let price = self.useful.iter().find(|(i, _)| *i == self.domain.drive);
            let (true, Some((_, price))) = (ready != NEVER, price) else { return NEVER };
            let driven = ready + price;
            for fact in before.facts() {
                let known = before.dearest(fact);
                after.reach(fact.without(self.wanted), known.max(ready) + price);
            }
            after.reach(drive.adds.without(self.wanted), driven);
            after.floor = driven;
        }
        self.spread(&mut after);
        after.dearest(self.wanted).max(after.floor)
    }

    /// Applies operators, the drive aside, until nothing gets cheaper.
    fn spread(&self, relaxed: &mut Relaxed) {
        loop {
            let mut changed = false;
            for &(index, price) in &self.useful {
                if index == self.domain.drive {
                    continue;
                }
                let operator = &self.domain.operators[index];
                let ready = relaxed.dearest(operator.preconditions);
                if ready != NEVER {
                    let at = ready.max(relaxed.floor) + price;
                    changed |= relaxed.reach(operator.adds, at);
                }
            }
            if !changed {
                return;
            }
        }
    }
}

/// What each fact costs where nothing is deleted.
struct Relaxed {
    price: [Price; MAX_FACTS],
    reached: FactSet,
    /// What everything costs at least.
    floor: Price,
}

impl Default for Relaxed {
    fn default() -> Self {
        Self { price: [NEVER; MAX_FACTS], reached: FactSet::EMPTY, floor: 0 }
    }
}

impl Relaxed {
    /// Whether some of the facts were dearer before.
    fn reach(&mut self, facts: FactSet, price: Price) -> bool {
        let mut changed = false;
        for bit in bits(facts) {
            if price < self.price[bit] {
                self.price[bit] = price;
                changed = true;
            }
        }
        self.reached = self.reached.with(facts);
        changed
    }

    /// Price of the dearest of these facts.
    fn dearest(&self, facts: FactSet) -> Price {
        if !self.reached.contains(facts) {
            return NEVER;
        }
        bits(facts).map(|bit| self.price[bit]).max().unwrap_or(0)
    }

    /// The facts reached, one by one.
    fn facts(&self) -> impl Iterator<Item = FactSet> + use<> {
        bits(self.reached).map(|bit| FactSet(1 << bit))
    }
}

/// The places of the ones.
fn bits(facts: FactSet) -> impl Iterator<Item = usize> + use<> {
    let mut left = facts.0;
    std::iter::from_fn(move || {
        let bit = left.trailing_zeros() as usize;
        (bit < MAX_FACTS).then(|| {
            left &= left - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::OperatorText;

    /// An operator by bits: preconditions, adds, deletes and seconds.
    type Drawn = (u8, u8, u8, u8);

    fn domain(drive: Drawn, others: &[Drawn]) -> Domain {
        let names = |bits: u8| (0..8).filter(move |b| bits >> b & 1 == 1).map(|b| format!("f{b}"));
        let text = |name: String, (preconditions, adds, deletes, time): Drawn| OperatorText {
            name,
            preconditions: names(preconditions).collect(),
            adds: names(adds).collect(),
            deletes: names(deletes).collect(),
            cost: ServiceCost { time_s: f64::from(time), ..ServiceCost::default() },
        };
        let mut operators = vec![text("drive".into(), drive)];
        operators.extend(others.iter().enumerate().map(|(i, drawn)| text(format!("o{i}"), *drawn)));
        Domain::new(&operators, &names(0xff).collect::<Vec<_>>()).expect("all facts can be true")
    }

    fn few_bits() -> impl Strategy<Value = u8> {
        (any::<u8>(), any::<u8>()).prop_map(|(a, b)| a & b)
    }

    fn any_operator() -> impl Strategy<Value = Drawn> {
        // Few different times, so that many ways cost the same; some cost nothing.
        (few_bits(), few_bits(), few_bits(), 0u8..4)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// The very same operators, whatever the heuristic: ties do not depend on it. And it never costs states.
        #[test]
        fn the_heuristic_changes_the_work_and_not_the_answer(
            drive in any_operator(),
            others in prop::collection::vec(any_operator(), 1..20),
            facts in any::<u8>(),
            wanted in few_bits(),
        ) {
            let domain = domain(drive, &others);
            let (facts, wanted) = (FactSet(facts.into()), FactSet(wanted.into()));
            let (blind, expanded_blind) = expand(&domain, facts, wanted, Heuristic::Blind);
            let (informed, expanded) = expand(&domain, facts, wanted, Heuristic::Max);
            prop_assert_eq!(blind, informed);
            prop_assert!(expanded <= expanded_blind, "{} > {}", expanded, expanded_blind);
        }
    }

    /// Three instruments on one arm: each is warmed, mounted, calibrated and used; lids, a lamp and a brush are in the
    /// way. Twenty-one operators.
    fn workshop() -> (Domain, FactSet) {
        let mut operators = Vec::new();
        let mut add = |name: String, [pre, add, del]: [&[&str]; 3], time_s: f64| {
            let list = |names: &[&str]| names.iter().map(ToString::to_string).collect();
            operators.push(OperatorText {
                name,
                preconditions: list(pre),
                adds: list(add),
                deletes: list(del),
                cost: ServiceCost { time_s, ..ServiceCost::default() },
            });
        };
        add("drive".into(), [&["stowed"], &[], &["aimed"]], 0.0);
        add("unstow".into(), [&["stowed"], &["out"], &["stowed"]], 120.0);
        add("stow".into(), [&["out"], &["stowed"], &["out"]], 120.0);
        add("brush".into(), [&["out", "bare"], &["clean"], &[]], 300.0);
        add("aim".into(), [&["out"], &["aimed"], &[]], 60.0);
        for tool in ["apxs", "mahli", "drill", "scoop"] {
            let fact = |what: &str| format!("{what}-{tool}");
            let (warm, on, ready, done) = (fact("warm"), fact("on"), fact("ready"), fact("done"));
            add(fact("heat"), [&[], &[&warm], &[]], 200.0);
            add(fact("mount"), [&["bare", "out"], &[&on], &["bare"]], 90.0);
            add(fact("unmount"), [&[&on], &["bare"], &[&on, &ready]], 90.0);
            add(fact("calibrate"), [&[&warm, &on], &[&ready], &[]], 400.0);
            add(fact("use"), [&[&ready, "aimed", "clean"], &[&done], &[&warm]], 900.0);
        }
        let initial = ["stowed", "bare"].map(str::to_owned);
        let domain = Domain::new(&operators, &initial).expect("a domain");
        let wanted = domain.set(&["done-apxs".into(), "done-drill".into()]).expect("facts");
        (domain, wanted)
    }

    #[test]
    fn h_max_expands_less_than_dijkstra_among_twenty_operators() {
        let (domain, wanted) = workshop();
        let (blind, many) = expand(&domain, domain.initial(), wanted, Heuristic::Blind);
        let (informed, few) = expand(&domain, domain.initial(), wanted, Heuristic::Max);
        println!(
            "{} operators: {many} states without a heuristic, {few} with h_max",
            domain.operators.len()
        );
        assert_eq!(blind, informed);
        assert!(few < many, "{few} of {many}");
    }

    #[test]
    fn among_equal_series_the_first_operators_are_taken() {
        // Either of o0 and o1 does, in any order after o2; both o2 then o0 and o2 then o1 cost the same.
        let domain = domain(
            (0, 0, 0, 0),
            &[(0b100, 0b1, 0, 1), (0b100, 0b1, 0, 1), (0, 0b100, 0, 1), (0b100, 0b11, 0, 2)],
        );
        let plan = domain.expand(FactSet::EMPTY, FactSet(1)).expect("two do");
        // Operators are numbered after the drive, which comes first where it may.
        assert_eq!((plan.before, plan.after), (vec![], vec![3, 1]));
    }

    #[test]
    fn more_operators_never_win_over_less_time() {
        // One operator of 1 s, or five of no time at all.
        let domain = domain(
            (0, 0, 0, 0),
            &[(0, 1, 0, 1), (0, 2, 0, 0), (2, 4, 0, 0), (4, 8, 0, 0), (8, 16, 0, 0), (16, 1, 0, 0)],
        );
        let plan = domain.expand(FactSet::EMPTY, FactSet(1)).expect("both do");
        assert_eq!(plan.before.len() + plan.after.len(), 5);
    }
}
