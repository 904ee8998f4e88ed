//! What turns a goal into operators finds what trying everything finds.

use std::collections::BTreeMap;

use proptest::prelude::*;
use wisdom_goals::{Domain, FactSet, OperatorText, ServiceCost};

/// Preconditions, adds and deletes as bits, and milliseconds.
type Drawn = (u8, u8, u8, u32);

fn few_bits() -> impl Strategy<Value = u8> {
    (any::<u8>(), any::<u8>()).prop_map(|(a, b)| a & b)
}

fn any_operator() -> impl Strategy<Value = Drawn> {
    // Few different times, so that many ways cost the same; some cost nothing.
    (few_bits(), few_bits(), few_bits(), prop::sample::select(vec![0, 1, 2, 1000, 2000]))
}

fn domain(operators: &[Drawn]) -> Domain {
    let names = |bits: u8| -> Vec<String> {
        (0..8).filter(|b| bits >> b & 1 == 1).map(|b| format!("f{b}")).collect()
    };
    let text = |(i, &(preconditions, adds, deletes, ms)): (usize, &Drawn)| OperatorText {
        name: if i == 0 { "drive".into() } else { format!("o{i}") },
        preconditions: names(preconditions),
        adds: names(adds),
        deletes: names(deletes),
        cost: ServiceCost { time_s: f64::from(ms) / 1000.0, ..ServiceCost::default() },
    };
    let operators: Vec<_> = operators.iter().enumerate().map(text).collect();
    Domain::new(&operators, &names(0xff)).expect("every fact can be true")
}

/// Milliseconds and number of operators.
type Price = (u64, usize);

/// The least price of every state that can be reached, found by relaxing until nothing changes.
fn prices(domain: &Domain, from: FactSet, wanted: FactSet) -> BTreeMap<(FactSet, bool), Price> {
    let mut prices = BTreeMap::from([((from, false), (0, 0))]);
    loop {
        let before = prices.clone();
        for (&(facts, driven), &(ms, count)) in &before {
            for (index, operator) in domain.operators().iter().enumerate() {
                let drives = index == domain.drive();
                let holds = operator.preconditions.bits() & !facts.bits() == 0;
                if !holds || drives && driven {
                    continue;
                }
                let mut after = facts.bits() & !operator.deletes.bits() | operator.adds.bits();
                if drives {
                    after &= !wanted.bits();
                }
                let price = (ms + (operator.cost.time_s * 1000.0) as u64, count + 1);
                let known =
                    prices.entry((FactSet::from_bits(after), driven || drives)).or_insert(price);
                *known = price.min(*known);
            }
        }
        if prices == before {
            return prices;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// As cheap as the cheapest way found by relaxation, and a way indeed.
    #[test]
    fn an_expansion_is_as_cheap_as_any(
        operators in prop::collection::vec(any_operator(), 1..12),
        facts in any::<u8>(),
        wanted in few_bits(),
    ) {
        let domain = domain(&operators);
        let (from, wanted) = (FactSet::from_bits(facts.into()), FactSet::from_bits(wanted.into()));
        let prices = prices(&domain, from, wanted);
        let ends = prices.iter().filter(|((facts, driven), _)| *driven && facts.contains(wanted));
        let best = ends.map(|(_, price)| *price).min();
        let expansion = domain.expand(from, wanted);
        let found = expansion.map(|expansion| {
            let (mut facts, mut price) = (from, (0, 0));
            let all = [expansion.before, vec![domain.drive()], expansion.after].concat();
            for index in all {
                facts = domain.step(facts, index, wanted).expect("it is possible at its turn");
                let ms = (domain.operators()[index].cost.time_s * 1000.0) as u64;
                price = (price.0 + ms, price.1 + 1);
            }
            assert_eq!(facts, expansion.facts);
            assert!(facts.contains(wanted));
            price
        });
        prop_assert_eq!(found, best);
    }
}
