//! Look-up tables: what they read and what they refuse.

use wisdom_belief::{BeliefError, Opinion};
use wisdom_fusion::{Band, Class, FusionError, LookupTable, Rows};

const DULL: Opinion = Opinion { paradox: 0.2, not_interesting: 0.8, interesting: 0.0 };
const FINE: Opinion = Opinion { paradox: 0.05, not_interesting: 0.0, interesting: 0.95 };

fn band(lo: f64, hi: f64) -> Band {
    Band { lo, hi, opinion: FINE }
}

fn bands(rows: Vec<Band>) -> Result<LookupTable, FusionError> {
    LookupTable::new("thermal", "temperature", "1", Rows::Bands(rows), DULL)
}

fn classes(classes: &[i32]) -> Result<LookupTable, FusionError> {
    let rows = classes.iter().map(|&class| Class { class, opinion: FINE }).collect();
    LookupTable::new("texture", "texture class", "1", Rows::Classes(rows), DULL)
}

#[test]
fn bands_hold_their_lower_bound_and_not_their_upper() {
    let table = bands(vec![band(0.0, 0.7), band(0.7, 100.0)]).expect("a table");
    assert_eq!(table.row_of(0.0), Some(0));
    assert_eq!(table.row_of(0.7), Some(1), "0.7 as f32 lies below 0.7 as f64");
    assert_eq!(table.row_of(99.999), Some(1));
    assert_eq!(table.row_of(100.0), None);
    assert_eq!(table.row_of(-0.001), None);
    assert_eq!((table.opinion(50.0), table.opinion(100.0)), (FINE, DULL));
}

#[test]
fn rows_keep_the_place_they_were_given() {
    let infinite = bands(vec![band(9.0, f64::INFINITY), band(f64::NEG_INFINITY, 9.0)]);
    let infinite = infinite.expect("a table");
    assert_eq!((infinite.row_of(1e30), infinite.row_of(-1e30)), (Some(0), Some(1)));
}

#[test]
fn classes_match_exactly() {
    let table = classes(&[1, 4, -2]).expect("a table");
    assert_eq!((table.row_of(4.0), table.row_of(-2.0)), (Some(1), Some(2)));
    assert_eq!((table.row_of(4.5), table.row_of(0.0)), (None, None));
    assert_eq!(table.gaps(), []);
}

#[test]
fn gaps_between_bands_are_reported() {
    let table = bands(vec![band(60.0, 80.0), band(0.0, 20.0), band(20.0, 40.0)]).expect("a table");
    assert_eq!(table.gaps(), [(40.0, 60.0)]);
}

#[test]
fn overlapping_bands_are_refused() {
    let error = bands(vec![band(20.0, 40.0), band(0.0, 21.0)]).expect_err("an overlap");
    assert_eq!(
        error,
        FusionError::Overlap {
            table: "thermal".to_owned(),
            first: (0.0, 21.0),
            second: (20.0, 40.0)
        }
    );
    assert_eq!(error.to_string(), "table `thermal`: bands [0, 21) and [20, 40) overlap");
}

#[test]
fn bands_without_readings_are_refused() {
    for (lo, hi) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
        assert!(matches!(bands(vec![band(lo, hi)]), Err(FusionError::Band { .. })), "[{lo}, {hi})");
    }
}

#[test]
fn bad_masses_are_refused_with_their_row() {
    let heavy = Opinion { paradox: 0.5, not_interesting: 0.5, interesting: 0.5 };
    let error = bands(vec![band(0.0, 1.0), Band { lo: 1.0, hi: 2.0, opinion: heavy }]);
    let error = error.expect_err("1.5 is more than all mass");
    assert_eq!(
        error,
        FusionError::Opinion {
            table: "thermal".to_owned(),
            row: "[1, 2)".to_owned(),
            source: Box::new(BeliefError::SumAboveOne { sum: 1.5 })
        }
    );
    let negative = Opinion { interesting: -0.1, ..DULL };
    let rows = Rows::Classes(vec![Class { class: 1, opinion: FINE }]);
    let error = LookupTable::new("texture", "texture class", "1", rows, negative);
    assert_eq!(
        error.expect_err("a negative mass").to_string(),
        "table `texture`, row outside: m(I) is -0.1; a mass lies in [0, 1]"
    );
}

#[test]
fn repeated_and_unreadable_classes_are_refused() {
    let table = || "texture".to_owned();
    assert_eq!(classes(&[1, 2, 1]), Err(FusionError::RepeatedClass { table: table(), class: 1 }));
    let class = (1 << 24) + 1;
    assert_eq!(classes(&[class]), Err(FusionError::ClassRange { table: table(), class }));
    assert_eq!(classes(&[]), Err(FusionError::NoRows { table: table() }));
}
