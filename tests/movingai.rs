//! The planner's routes on the `MovingAI` maps are as long as published.

#[path = "../examples/movingai/reader.rs"]
mod reader;

use std::fs;
use std::path::Path;

use reader::{Problem, ReadError, ground, read_map, read_scenario};
use wisdom_grid::Raster;
use wisdom_planner::Router;

/// Some scenarios print two decimals.
const TOLERANCE: f64 = 0.01;

const MAP: &str = "type octile\nheight 5\nwidth 7\nmap\n\
                   .......\n\
                   .@@T@..\n\
                   .@...G.\n\
                   .O.@@@.\n\
                   .......\n";

/// Lengths by hand: no corner of a wall is cut, so only the open north-east has room for a diagonal step.
const SCENARIO: &str = "version 1\n\
                        0\tsmall.map\t7\t5\t2\t2\t2\t2\t0\n\
                        0\tsmall.map\t7\t5\t2\t2\t2\t4\t2\n\
                        1\tsmall.map\t7\t5\t2\t2\t0\t4\t4.0\n\
                        1\tmaps/small.map 7 5 2 2 6 0 5.41421\n\
                        \n\
                        2\tsmall.map\t7\t5\t0\t0\t6\t4\t9.41421\n";

fn check(file: &str, blocked: &Raster<bool>, problems: &[Problem]) {
    let ground = ground(blocked.clone()).expect("a hazard of one is sound");
    let mut router = Router::new(&ground);
    for (index, problem) in problems.iter().enumerate() {
        let found = router.route(problem.start, problem.goal).expect("all problems have a way");
        let length = found.route.cost.length_m;
        let expected = problem.length;
        assert!((length - expected).abs() <= TOLERANCE, "{file} {index}: {length}, not {expected}");
    }
}

#[test]
fn a_small_map_has_the_lengths_worked_out_by_hand() {
    let blocked = read_map("small.map", MAP).expect("a sound map");
    let problems = read_scenario("small.scen", SCENARIO, &blocked).expect("a sound scenario");
    assert_eq!(problems.len(), 5);
    check("small", &blocked, &problems);
    // Files from other systems end their lines otherwise.
    let other = read_map("small.map", &MAP.replace('\n', "\r\n")).expect("a sound map");
    assert_eq!(blocked, other);
}

#[test]
fn every_published_length_is_found() {
    let Some(data) = std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty()) else {
        println!("skipped: every_published_length_is_found: WISDOM_DATA is not set");
        return;
    };
    let folder = Path::new(&data).join("benchmarks").join("movingai");
    let mut maps: Vec<_> = fs::read_dir(&folder)
        .expect("the folder of the benchmarks can be listed")
        .map(|entry| entry.expect("an entry can be read").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "map"))
        .collect();
    maps.sort();
    assert!(!maps.is_empty(), "no map in {}", folder.display());
    for path in maps {
        let read = |path: &Path| {
            let name = path.display().to_string();
            (name, fs::read_to_string(path).expect("the file can be read"))
        };
        let (name, text) = read(&path);
        let blocked = read_map(&name, &text).expect("a sound map");
        let (scenario, text) = read(&path.with_extension("map.scen"));
        let problems = read_scenario(&scenario, &text, &blocked).expect("a sound scenario");
        check(&name, &blocked, &problems);
    }
}

fn refused<T: std::fmt::Debug>(result: Result<T, ReadError>) -> String {
    result.expect_err("a broken file").to_string()
}

#[test]
fn a_broken_map_is_refused_with_its_line_and_what_was_expected() {
    for (from, to, message) in [
        ("octile", "tile", "m, line 1: found `type tile`; expected `type octile`"),
        (
            "height 5",
            "height 0",
            "m, line 2: found `height 0`; expected `height` and a number from 1 to 65535",
        ),
        ("width 7", "map", "m, line 3: found `map`; expected `width` and a number from 1 to 65535"),
        ("\nmap", "\nmaps", "m, line 4: found `maps`; expected `map`"),
        (".@@T@..", ".@@T@.", "m, line 6: found 6 cells; expected 7, the width of the map"),
        (
            "G",
            "W",
            "m, line 7: found `W` at column 6; expected `.` or `G` (free), `@`, `O` or `T` (blocked)",
        ),
        ("height 5", "height 6", "m, line 10: found the end of the file; expected row 6 of 6"),
        (
            "height 5",
            "height 4",
            "m, line 9: found `.......`; expected the end: the map has 4 rows",
        ),
    ] {
        assert_eq!(refused(read_map("m", &MAP.replacen(from, to, 1))), message);
    }
    assert_eq!(
        refused(read_map("m", "")),
        "m, line 1: found the end of the file; expected `type octile`"
    );
}

#[test]
fn a_scenario_that_does_not_fit_is_refused_with_its_line_and_what_was_expected() {
    let blocked = read_map("m", MAP).expect("a sound map");
    for (line, message) in [
        (
            "0 m 7 5 2 2 2",
            "7 fields; expected 9: bucket, map, width, height, start x, start y, goal x, goal y and length",
        ),
        ("0 m 5 7 2 2 2 2 0", "a map of 5 x 7; expected 7 x 5 (width x height), as the map has"),
        ("0 m 7 5 2 2 7 2 0", "the goal at x 7, y 2; expected x below 7 and y below 5"),
        ("0 m 7 5 1 2 2 2 0", "the start at x 1, y 2, which is blocked; expected a free cell"),
        ("0 m 7 5 2 -2 2 2 0", "`-2`; expected start y, a whole number"),
        ("0 m 7 5 2 2 2 2 long", "`long`; expected a length of 0 or more"),
        ("0 m 7 5 2 2 2 2 NaN", "`NaN`; expected a length of 0 or more"),
    ] {
        let text = format!("version 1.0\n0 m 7 5 2 2 2 2 0\n{line}\n");
        let told = refused(read_scenario("s", &text, &blocked));
        assert_eq!(told, format!("s, line 3: found {message}"));
    }
    let told = refused(read_scenario("s", "version 2\n", &blocked));
    assert_eq!(told, "s, line 1: found `version 2`; expected `version 1`");
}
