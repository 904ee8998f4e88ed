//! Worked examples beyond those that ship: the whole collection from which `vectors.json` was taken.
//!
//! The folder is named by the environment variable `WISDOM_DATA`; without it each test says that it was skipped.

use std::{collections::BTreeMap, path::Path};

use serde_json::Value;
use wisdom_belief::{
    Element, Frame, InterestMass, MassFunction, Opinion, ParadoxPolicy, Rule, Uncertainty, rule,
};

/// What the crate computes beside the rules of [`Rule`], by the collection's names.
const OTHERS: [&str; 9] =
    ["conjunctive", "conflict", "discount", "bel", "pl", "q", "betp", "dsmp", "cardinality"];

/// The whole collection, unless there is none: then the test named says so.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so in the test log")]
fn collection(test: &str) -> Option<Vec<Value>> {
    let folder = std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty());
    if folder.is_none() {
        println!("skipped: {test}: WISDOM_DATA is not set");
    }
    let path = Path::new(&folder?).join("vectors/fusion.json");
    let json = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut whole: Value = serde_json::from_str(&json).expect("JSON");
    let cases = whole["cases"].as_array_mut().expect("cases");
    Some(std::mem::take(cases))
}

fn shipped() -> Vec<Value> {
    serde_json::from_str(include_str!("vectors.json")).expect("JSON")
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Whether the crate computes what a case is about: a rule added to [`Rule`] is found by its name.
fn is_computed(case: &Value) -> bool {
    let rule = text(&case["rule"]);
    OTHERS.contains(&rule) || rule.parse::<Rule>().is_ok()
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

fn sources(case: &Value, frame: &Frame) -> Vec<MassFunction> {
    let source = |source: &Value| {
        let masses = source.as_object().expect("masses").iter();
        MassFunction::parse(frame, masses.map(|(text, mass)| (text.as_str(), number(mass))))
            .unwrap_or_else(|error| panic!("{}: {error}", case["id"]))
    };
    case["sources"].as_array().expect("sources").iter().map(source).collect()
}

fn expected(case: &Value, frame: &Frame) -> BTreeMap<Element, f64> {
    let listed = case["expected"].as_object().expect("values").iter();
    listed.map(|(text, value)| (frame.parse(text).expect("an element"), number(value))).collect()
}

fn check(case: &Value, what: &str, found: f64, wanted: f64) {
    let close = (found - wanted).abs() <= number(&case["tolerance"]);
    assert!(close, "{}: {} of {what} is {found}, not {wanted}", case["id"], case["rule"]);
}

/// Every listed element has its value; the others are not focal.
fn check_masses(case: &Value, frame: &Frame, found: &MassFunction) {
    let mut wanted = expected(case, frame);
    for &(element, _) in found.focal() {
        wanted.entry(element).or_insert(0.0);
    }
    for (element, mass) in wanted {
        check(case, &frame.print(element), found.mass(element), mass);
    }
}

fn check_values(case: &Value, frame: &Frame, measure: impl Fn(Element) -> f64) {
    for (element, value) in expected(case, frame) {
        check(case, &frame.print(element), measure(element), value);
    }
}

fn check_case(case: &Value) {
    let frame = frame(case, "model");
    let sources = sources(case, &frame);
    let param = |name: &str| number(&case["params"][name]);
    match text(&case["rule"]) {
        "conjunctive" => {
            let fused = rule::conjunctive(&sources, &frame).expect("one frame");
            check_masses(case, &frame, &fused);
        }
        "conflict" => {
            let found = rule::conflict(&sources, &frame).expect("one frame");
            check(case, "the sources", found, number(&case["expected"]["value"]));
        }
        "discount" => {
            let u = Uncertainty::new(1.0 - param("reliability")).expect("in [0, 1]");
            check_masses(case, &frame, &sources[0].discounted(u, &frame));
        }
        "bel" => check_values(case, &frame, |a| sources[0].belief(a)),
        "pl" => check_values(case, &frame, |a| sources[0].plausibility(a)),
        "q" => check_values(case, &frame, |a| sources[0].commonality(a)),
        "betp" => check_values(case, &frame, |a| sources[0].pignistic(a)),
        "dsmp" => check_values(case, &frame, |a| sources[0].dsmp(a, param("epsilon"))),
        "cardinality" => check_values(case, &frame, |a| f64::from(a.cardinality())),
        name => {
            let rule: Rule = name.parse().expect("a rule");
            let fused = rule::combine(rule, &sources, &frame).expect("no total conflict");
            check_masses(case, &frame, &fused);
        }
    }
}

#[test]
fn every_case_of_a_rule_that_exists_comes_out_as_published() {
    let Some(all) = collection("every_case_of_a_rule_that_exists_comes_out_as_published") else {
        return;
    };
    let computed: Vec<&Value> = all.iter().filter(|case| is_computed(case)).collect();
    assert!(computed.len() >= 45, "{} cases", computed.len());
    computed.into_iter().for_each(check_case);
}

/// Nothing was changed on the way into the crate, and nothing left out.
#[test]
fn the_shipped_cases_are_exactly_those_of_the_rules_that_exist() {
    let Some(all) = collection("the_shipped_cases_are_exactly_those_of_the_rules_that_exist")
    else {
        return;
    };
    let by_id = |cases: Vec<Value>| -> BTreeMap<String, Value> {
        let count = cases.len();
        let without_remark = |mut case: Value| {
            // That the collection's makers recomputed a case is no part of it.
            case.as_object_mut().expect("a case").remove("verified");
            (text(&case["id"]).to_owned(), case)
        };
        let cases: BTreeMap<_, _> = cases.into_iter().map(without_remark).collect();
        assert_eq!(cases.len(), count, "an id is given twice");
        cases
    };
    let shipped = by_id(shipped());
    let computed = by_id(all.into_iter().filter(is_computed).collect());
    let ids = |cases: &BTreeMap<String, Value>| cases.keys().cloned().collect::<Vec<_>>();
    assert_eq!(ids(&shipped), ids(&computed));
    for (id, case) in &shipped {
        assert_eq!(case, &computed[id], "{id}");
    }
}

/// Of every rule, also of those that are not computed here: hybrid models, masses on the empty element.
#[test]
fn the_sources_of_every_case_are_mass_functions() {
    let Some(all) = collection("the_sources_of_every_case_are_mass_functions") else { return };
    let mut count = 0;
    for case in &all {
        let model = if case["source_model"].is_null() { "model" } else { "source_model" };
        let frame = frame(case, model);
        for source in sources(case, &frame) {
            let sum: f64 = source.focal().iter().map(|&(_, mass)| mass).sum();
            // The sum that a mass function may be off by.
            assert!((sum - 1.0).abs() <= wisdom_belief::SUM_TOLERANCE, "{}: {sum}", case["id"]);
            count += 1;
        }
    }
    assert!(all.len() >= 121 && count > all.len(), "{count} sources of {} cases", all.len());
}

/// Table 8: the collection's `reassign` from I ∩ NI to I ∪ NI is a policy here.
#[test]
fn the_paradox_policy_reproduces_table_8() {
    let Some(all) = collection("the_paradox_policy_reproduces_table_8") else { return };
    let table_8: Vec<&Value> = all.iter().filter(|case| case["rule"] == "reassign").collect();
    assert!(table_8.len() >= 2, "{} cases", table_8.len());
    for case in table_8 {
        let mass = |text: &str| case["sources"][0][text].as_f64().unwrap_or(0.0);
        let opinion =
            Opinion { interesting: mass("I"), not_interesting: mass("NI"), paradox: mass("I&NI") };
        let given = InterestMass::new(opinion, mass("I|NI")).expect("a mass function");
        let exclusive = frame(case, "model");
        let moved = ParadoxPolicy::ToIgnorance.apply(given);
        check_masses(case, &exclusive, &moved.mass_function(&exclusive).expect("no paradox left"));
    }
}
