//! Worked examples from the literature (`vectors.json`: each case names its source).

use std::collections::BTreeMap;

use serde_json::Value;
use wisdom_belief::{BeliefError, Element, Frame, MassFunction, Model, Rule, Uncertainty, rule};

fn cases(rules: &[&str]) -> Vec<Value> {
    let all: Vec<Value> = serde_json::from_str(include_str!("vectors.json")).expect("JSON");
    all.into_iter().filter(|case| rules.contains(&text(&case["rule"]))).collect()
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn frame(case: &Value) -> Frame {
    let atoms = case["frame"].as_array().expect("atoms").iter().map(text);
    match &case["model"] {
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
            .expect("a mass function")
    };
    case["sources"].as_array().expect("sources").iter().map(source).collect()
}

fn expected(case: &Value, frame: &Frame) -> BTreeMap<Element, f64> {
    let listed = case["expected"].as_object().expect("values").iter();
    listed.map(|(text, value)| (frame.parse(text).expect("an element"), number(value))).collect()
}

/// Every listed element has its value; the others are not focal.
fn check_masses(case: &Value, frame: &Frame, found: &MassFunction) {
    let (mut wanted, tolerance) = (expected(case, frame), number(&case["tolerance"]));
    for &(element, _) in found.focal() {
        wanted.entry(element).or_insert(0.0);
    }
    for (element, value) in wanted {
        let (found, id) = (found.mass(element), text(&case["id"]));
        assert!(
            (found - value).abs() <= tolerance,
            "{id}: m({}) = {found}, not {value}",
            frame.print(element)
        );
    }
}

fn check_measure(
    names: &[&str],
    least: usize,
    measure: impl Fn(&Value, &MassFunction, Element) -> f64,
) {
    let cases = cases(names);
    assert!(cases.len() >= least, "{} cases of {names:?}", cases.len());
    for case in &cases {
        let frame = frame(case);
        let m = &sources(case, &frame)[0];
        for (element, value) in expected(case, &frame) {
            let (found, id) = (measure(case, m, element), text(&case["id"]));
            let close = (found - value).abs() <= number(&case["tolerance"]);
            assert!(close, "{id}: of {} {found}, not {value}", frame.print(element));
        }
    }
}

#[test]
fn rules_reproduce_published_combinations() {
    let cases = cases(&["dsmc", "dempster", "pcr6"]);
    assert_eq!(cases.len(), 24);
    for case in &cases {
        let (frame, rule) = (frame(case), text(&case["rule"]).parse::<Rule>().expect("a rule"));
        let fused = rule::combine(rule, &sources(case, &frame), &frame);
        check_masses(case, &frame, &fused.expect("no total conflict"));
    }
}

#[test]
fn the_conjunctive_rule_reproduces_published_combinations() {
    let cases = cases(&["conjunctive"]);
    assert_eq!(cases.len(), 5);
    for case in &cases {
        let frame = frame(case);
        let fused = rule::conjunctive(&sources(case, &frame), &frame).expect("one frame");
        check_masses(case, &frame, &fused);
    }
}

#[test]
fn conflict_is_the_published_one() {
    let cases = cases(&["conflict"]);
    assert_eq!(cases.len(), 1);
    for case in &cases {
        let frame = frame(case);
        let found = rule::conflict(&sources(case, &frame), &frame).expect("one frame");
        assert!((found - number(&case["expected"]["value"])).abs() < 1e-12);
    }
}

#[test]
fn discounting_reproduces_table_6() {
    let cases = cases(&["discount"]);
    assert_eq!(cases.len(), 2);
    for case in &cases {
        let frame = frame(case);
        let u = Uncertainty::new(1.0 - number(&case["params"]["reliability"])).expect("in [0, 1]");
        check_masses(case, &frame, &sources(case, &frame)[0].discounted(u, &frame));
    }
}

#[test]
fn measures_reproduce_published_values() {
    check_measure(&["bel"], 2, |_, m, a| m.belief(a));
    check_measure(&["pl"], 2, |_, m, a| m.plausibility(a));
    check_measure(&["q"], 1, |_, m, a| m.commonality(a));
    check_measure(&["betp"], 3, |_, m, a| m.pignistic(a));
    check_measure(&["dsmp"], 4, |case, m, a| m.dsmp(a, number(&case["params"]["epsilon"])));
}

#[test]
fn cardinality_counts_the_venn_regions_of_a_hybrid_model() {
    let cases = cases(&["cardinality"]);
    assert_eq!(cases.len(), 1);
    let frame = frame(&cases[0]);
    assert!(matches!(frame.model(), Model::Hybrid { .. }));
    for (element, value) in expected(&cases[0], &frame) {
        assert_eq!(f64::from(element.cardinality()), value, "{}", frame.print(element));
    }
}

#[test]
fn a_hybrid_frame_refuses_the_classic_rule() {
    let frame = Frame::with_empty(["A", "B", "C"], &["A & B"]).expect("a frame");
    let refused = rule::combine(Rule::Dsmc, &[MassFunction::vacuous(&frame)], &frame);
    assert_eq!(refused, Err(BeliefError::NotFreeModel { atoms: "A, B, C".to_owned() }));
}
