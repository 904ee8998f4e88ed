//! The collection of worked examples from which `vectors.json` was taken, to see that they are the same.
//!
//! Its folder is named by the environment variable `WISDOM_DATA`; without it the test says that it was skipped.

use std::{collections::BTreeMap, path::Path};

use serde_json::Value;

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

fn by_id(cases: Vec<Value>) -> BTreeMap<String, Value> {
    let count = cases.len();
    let without_remark = |mut case: Value| {
        // That the collection's makers recomputed a case is no part of it.
        case.as_object_mut().expect("a case").remove("verified");
        (case["id"].as_str().expect("a string").to_owned(), case)
    };
    let cases: BTreeMap<_, _> = cases.into_iter().map(without_remark).collect();
    assert_eq!(cases.len(), count, "an id is given twice");
    cases
}

/// Nothing was changed on the way into the crate, and nothing left out.
#[test]
fn the_shipped_cases_are_those_of_the_collection() {
    let Some(all) = collection("the_shipped_cases_are_those_of_the_collection") else { return };
    let (shipped, all) = (by_id(shipped()), by_id(all));
    let ids = |cases: &BTreeMap<String, Value>| cases.keys().cloned().collect::<Vec<_>>();
    assert_eq!(ids(&shipped), ids(&all));
    for (id, case) in &shipped {
        assert_eq!(case, &all[id], "{id}");
    }
}
