//! Worked examples from the literature (`vectors.json`: each case names its source), every one of them through
//! the library.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use wisdom_belief::{
    Element, Frame, InterestMass, MassFunction, Opinion, ParadoxPolicy, Rule, Settings,
    Uncertainty, rule,
};

/// What a case is about: values of elements that are listed, masses of all elements, or one number.
enum Found {
    Masses(MassFunction),
    Values(Box<dyn Fn(Element) -> f64>),
    Number(f64),
}

fn cases() -> Vec<Value> {
    serde_json::from_str(include_str!("vectors.json")).expect("JSON")
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn frame(case: &Value, model: &str) -> Frame {
    let atoms = case["frame"].as_array().expect("atoms").iter().map(text);
    match &case[model] {
        Value::String(name) if name == "free" => Frame::free(atoms),
        Value::String(name) if name == "shafer" => Frame::shafer(atoms),
        model => {
            let empty: Vec<&str> =
                model["empty"].as_array().expect("expressions").iter().map(text).collect();
            Frame::with_empty(atoms, &empty)
        }
    }
    .expect("a frame")
}

/// The frame on which the sources spoke, if that is another than the one on which they are combined.
fn source_frame(case: &Value) -> Option<Frame> {
    (!case["source_model"].is_null()).then(|| frame(case, "source_model"))
}

fn sources(case: &Value, frame: &Frame) -> Vec<MassFunction> {
    let source = |source: &Value| {
        let masses = source.as_object().expect("masses").iter();
        MassFunction::parse(frame, masses.map(|(text, mass)| (text.as_str(), number(mass))))
            .expect("a mass function")
    };
    case["sources"].as_array().expect("sources").iter().map(source).collect()
}

fn combined(case: &Value, frame: &Frame, name: &str) -> MassFunction {
    let given = source_frame(case);
    let sources = sources(case, given.as_ref().unwrap_or(frame));
    let settings = Settings::default();
    let fused = match (name.strip_suffix("_sequential"), &given) {
        (Some(name), None) => rule::fold(name.parse().expect("a rule"), &sources, frame, &settings),
        (Some(_), Some(_)) => panic!("{}: no case folds sources of another model", case["id"]),
        (None, Some(given)) => {
            let settings = settings.with_source_frame(given);
            rule::combine_with(name.parse().expect("a rule"), &sources, frame, &settings)
        }
        (None, None) => rule::combine(name.parse().expect("a rule"), &sources, frame),
    };
    fused.unwrap_or_else(|error| panic!("{}: {error}", case["id"]))
}

/// Table 8 moves the paradox to ignorance, which is a policy of the frame {I, NI}.
fn reassigned(case: &Value, frame: &Frame) -> MassFunction {
    let params = &case["params"];
    assert_eq!((text(&params["from"]), text(&params["to"])), ("I&NI", "I|NI"));
    let mass = |text: &str| case["sources"][0][text].as_f64().unwrap_or(0.0);
    let opinion =
        Opinion { interesting: mass("I"), not_interesting: mass("NI"), paradox: mass("I&NI") };
    let given = InterestMass::new(opinion, mass("I|NI")).expect("a mass function");
    let moved = ParadoxPolicy::ToIgnorance.apply(given);
    moved.mass_function(frame).expect("no paradox is left")
}

fn contextually_discounted(case: &Value, frame: &Frame, source: &MassFunction) -> MassFunction {
    let reliabilities = case["params"]["reliabilities"].as_object().expect("contexts").iter();
    let contexts: Vec<(Element, f64)> = reliabilities
        .map(|(text, value)| (frame.parse(text).expect("an element"), number(value)))
        .collect();
    source.contextually_discounted(&contexts, frame).expect("a partition")
}

fn found(case: &Value, frame: &Frame) -> Found {
    let param = |name: &str| number(&case["params"][name]);
    let all = || sources(case, frame);
    let one = || sources(case, frame).swap_remove(0);
    match text(&case["rule"]) {
        "bel" => {
            let m = one();
            Found::Values(Box::new(move |a| m.belief(a)))
        }
        "pl" => {
            let m = one();
            Found::Values(Box::new(move |a| m.plausibility(a)))
        }
        "q" => {
            let m = one();
            Found::Values(Box::new(move |a| m.commonality(a)))
        }
        "betp" => {
            let m = one();
            Found::Values(Box::new(move |a| m.pignistic(a)))
        }
        "dsmp" => {
            let (m, epsilon) = (one(), param("epsilon"));
            Found::Values(Box::new(move |a| m.dsmp(a, epsilon)))
        }
        "cardinality" => Found::Values(Box::new(|a| f64::from(a.cardinality()))),
        "conflict" => Found::Number(rule::conflict(&all(), frame).expect("one frame")),
        "jousselme" => Found::Number(all()[0].jousselme_distance(&all()[1])),
        "deng_entropy" => Found::Number(one().deng_entropy().expect("no mass on ∅")),
        "nonspecificity" => Found::Number(one().nonspecificity().expect("no mass on ∅")),
        "pic_betp" => {
            let distribution = one().pignistic_distribution(frame).expect("something possible");
            Found::Number(distribution.information_content())
        }
        "pic_dsmp" => {
            let distribution = one().dsmp_distribution(param("epsilon"), frame);
            Found::Number(distribution.expect("something possible").information_content())
        }
        "hyper_power_size" => {
            let size = frame.elements().count();
            assert_eq!(frame.element_count(), size as u128);
            Found::Number(size as f64)
        }
        "discount" => {
            let u = Uncertainty::new(1.0 - param("reliability")).expect("in [0, 1]");
            Found::Masses(one().discounted(u, frame))
        }
        "contextual_discount" => Found::Masses(contextually_discounted(case, frame, &one())),
        "condition" => {
            let on = frame.parse(text(&case["params"]["on"])).expect("an element");
            Found::Masses(one().conditioned(on, frame).expect("plausible"))
        }
        "reassign" => Found::Masses(reassigned(case, frame)),
        name => Found::Masses(combined(case, frame, name)),
    }
}

/// The listed values, each with what was found instead if it differs; and every mass that is not listed.
fn slips(case: &Value) -> Vec<String> {
    let (frame, tolerance) = (frame(case, "model"), number(&case["tolerance"]));
    let found = found(case, &frame);
    let differ = |what: &str, found: f64, wanted: f64| {
        // Not `>`: NaN differs from everything.
        let close = (found - wanted).abs() <= tolerance;
        let (id, rule) = (&case["id"], &case["rule"]);
        (!close).then(|| format!("{id}: {rule} of {what} is {found}, not {wanted}"))
    };
    let expected = case["expected"].as_object().expect("values");
    if let Found::Number(found) = found {
        return differ("the sources", found, number(&expected["value"])).into_iter().collect();
    }
    let listed = expected
        .iter()
        .map(|(text, value)| (frame.parse(text).expect("an element"), number(value)));
    let mut wanted: BTreeMap<Element, f64> = listed.collect();
    assert_eq!(wanted.len(), expected.len(), "{}: an element is listed twice", case["id"]);
    if let Found::Masses(masses) = &found {
        for &(element, _) in masses.focal() {
            wanted.entry(element).or_insert(0.0);
        }
    }
    let value = |element| match &found {
        Found::Masses(masses) => masses.mass(element),
        Found::Values(values) => values(element),
        Found::Number(number) => *number,
    };
    wanted
        .into_iter()
        .filter_map(|(element, wanted)| differ(&frame.print(element), value(element), wanted))
        .collect()
}

#[test]
fn every_published_case_comes_out_as_published() {
    let cases = cases();
    let ids: BTreeSet<&str> = cases.iter().map(|case| text(&case["id"])).collect();
    assert_eq!((cases.len(), ids.len()), (121, 121));
    let slips: Vec<String> = cases.iter().flat_map(slips).collect();
    assert!(slips.is_empty(), "{}", slips.join("\n"));
}

/// The rules whose published examples are in the collection; the others are held to their definitions alone
/// (`exact.rs`).
#[test]
fn most_rules_have_a_published_case() {
    let cases = cases();
    let named: BTreeSet<Rule> =
        cases.iter().filter_map(|case| text(&case["rule"]).parse().ok()).collect();
    assert_eq!(named.len(), 18, "{named:?}");
}

/// A case whose sources are changed a little must no longer come out: the comparison sees what it should.
#[test]
fn a_changed_case_is_noticed() {
    for mut case in cases() {
        let expected = case["expected"].as_object_mut().expect("values");
        let tolerance = 1e-3; // beyond that of any case
        for value in expected.values_mut() {
            *value = Value::from(number(value) + tolerance);
        }
        assert!(!slips(&case).is_empty(), "{}", case["id"]);
    }
}
