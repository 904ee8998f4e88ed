//! Planes made again from a log: what they hold, and that any order of asking gives the same.

use std::path::Path;
use std::sync::Arc;

use wisdom_fusion::credit;
use wisdom_grid::Raster;
use wisdom_logbook::{Deriver, LogReader, Past, PlaneGroup, derive_at, plane, planes};

fn sample() -> LogReader {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("logs/sample/paper-decisions-5.mcap");
    LogReader::open(&path).expect("the sample is a log")
}

fn last(log: &LogReader) -> Past {
    let number = log.decisions().last().expect("a decision").number;
    derive_at(log, number).expect("it follows").expect("it is there")
}

fn made(past: &Past, name: &str) -> Raster<f32> {
    plane(&past.rover, name).unwrap_or_else(|| panic!("no plane {name}")).into_owned()
}

#[test]
fn every_plane_that_is_named_can_be_made_and_no_other() {
    let past = last(&sample());
    let spec = past.rover.spec();
    let all = planes(spec);
    assert_eq!(all.len(), 6 + 2 * spec.layers.len() + 3 + 5 * spec.experts.len());
    for info in &all {
        let raster = made(&past, &info.name);
        assert_eq!(raster.spec(), past.maps().interest.interest.spec(), "{}", info.name);
        assert!(raster.values().iter().all(|value| value.is_finite()), "{}", info.name);
    }
    for name in ["", "mass-", "mass-interesting-nobody", "credit-nobody", "elevation-u-u", "-u"] {
        assert!(plane(&past.rover, name).is_none(), "`{name}`");
    }
    let texture = all.iter().find(|info| info.name == "texture").expect("a layer of the mission");
    let classes: Vec<i32> = texture.classes.iter().map(|(class, _)| *class).collect();
    assert_eq!((classes, texture.group), (vec![1, 2, 3, 4], PlaneGroup::Layer));
}

#[test]
fn masses_sum_to_one_and_credits_share_the_interest_out() {
    let past = last(&sample());
    let maps = past.maps();
    let cells = maps.evidence.spec().cells();
    let names: Vec<&str> = maps.evidence.experts().map(|(name, _)| name).collect();
    let of = |kind: &str| -> Vec<Raster<f32>> {
        names.iter().map(|name| made(&past, &format!("{kind}-{name}"))).collect()
    };
    let kinds = ["mass-interesting", "mass-not-interesting", "mass-ignorance", "mass-paradox"];
    let masses = kinds.map(of);
    let credits = of("credit");
    let mut shared = 0;
    for cell in cells {
        for expert in 0..names.len() {
            let sum: f32 = masses.iter().map(|mass| mass[expert][cell]).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{} at {cell}: {sum}", names[expert]);
        }
        let exact = credit(&maps.evidence, &past.rover.spec().fusion, cell);
        let told: Vec<f64> = credits.iter().map(|credit| f64::from(credit[cell])).collect();
        assert!(told.iter().zip(&exact).all(|(told, exact)| (told - exact).abs() < 1e-6));
        let sum: f64 = told.iter().sum();
        assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-5, "{cell}: {sum}");
        shared += usize::from(sum != 0.0);
    }
    assert!(shared > 1000, "{shared} cells with an interest to share");
}

#[test]
fn the_ground_is_certain_under_the_rover_and_as_reliable_as_the_plan_says() {
    let log = sample();
    let past = derive_at(&log, 0).expect("it follows").expect("it is there");
    let reliability = made(&past, "reliability");
    let blocked = made(&past, "blocked");
    assert_eq!(reliability[past.decision.state.pose.cell], 1.0);
    // Nothing is in a leg's first way but the rover's own: the plan's number is that of the field.
    let leg = past.decision.plan().plan.legs.first().expect("it has somewhere to go");
    let end = *leg.route.cells.last().expect("a way has cells");
    let told = leg.route.cost.reliability();
    assert!((f64::from(reliability[end]) - told).abs() < 1e-6, "{} {told}", reliability[end]);
    let through: Vec<f32> = leg.route.cells.iter().map(|cell| blocked[*cell]).collect();
    assert!(through.iter().all(|blocked| *blocked == 0.0), "{through:?}");
    assert!(blocked.values().contains(&1.0) && reliability.values().contains(&0.0));
}

#[test]
fn decisions_asked_for_in_any_order_are_those_of_the_log() {
    let log = Arc::new(sample());
    let count = log.decisions().count() as u32;
    let mut deriver = Deriver::new(Arc::clone(&log)).expect("this build's decisions");
    let order = [count - 1, 0, 2, 2, 1, count - 1, 0, count];
    for number in order {
        let past = deriver.at(number).expect("it follows");
        let alone = derive_at(&log, number).expect("it follows");
        match (past, alone) {
            (Some(past), Some(alone)) => {
                assert_eq!(past.decision, alone.decision);
                assert_eq!(past.achieved, alone.achieved);
                assert_eq!(past.maps().interest, alone.maps().interest);
            }
            (None, None) => assert_eq!(number, count),
            (past, alone) => panic!("{number}: {} {}", past.is_some(), alone.is_some()),
        }
    }
}
