//! The sequencer solves orienteering problems of the literature to their best known scores, and their files are read to
//! the letter.

#[path = "../examples/orienteering/instance.rs"]
mod instance;
#[path = "../examples/orienteering/metric.rs"]
mod metric;
#[path = "../examples/orienteering/reader/mod.rs"]
mod reader;
#[path = "../examples/orienteering/solve.rs"]
mod solve;

use std::fs;
use std::path::{Path, PathBuf};

use instance::{Instance, Node, Window};
use metric::Metric;
use proptest::prelude::*;
use reader::read;
use solve::solve;

/// A search stops after so many expansions: a limit of time would make the tests depend on the machine.
const EXPANSIONS: u64 = 60_000;

/// The shipped problems with their best known scores.
const SHIPPED: [(&str, f64); 7] = [
    ("tsiligirides_problem_1_budget_46.txt", 175.0),
    ("tsiligirides_problem_2_budget_27.txt", 230.0),
    ("tsiligirides_problem_3_budget_060.txt", 580.0),
    ("set_64_1_45.txt", 816.0),
    ("set_66_1_055.txt", 825.0),
    ("c101.txt", 320.0),
    ("pr01.txt", 308.0),
];

fn shipped(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join("data").join("op");
    fs::read(folder.join(name)).expect("the file is shipped")
}

fn load(name: &str, bytes: &[u8]) -> Instance {
    read(name, bytes).unwrap_or_else(|error| panic!("{error}"))
}

/// A problem in the way of `OPLib`: a square of 10 x 10 with the depot in a corner, which scores itself.
const SQUARE: &str = "NAME : square\n\
                      COMMENT : made by hand\n\
                      TYPE : OP\n\
                      DIMENSION : 4\n\
                      COST_LIMIT : 34\n\
                      EDGE_WEIGHT_TYPE : EUC_2D\n\
                      NODE_COORD_SECTION\n\
                      1 0 0\n\
                      2 1.0e+01 0\n\
                      3 10 10\n\
                      4 0 10\n\
                      NODE_SCORE_SECTION\n\
                      1 5\n\
                      2 1\n\
                      3 7\n\
                      4 2\n\
                      DEPOT_SECTION\n\
                      1\n\
                      -1\n\
                      EOF\n";

/// Two vertices and a depot, each with a window; the file says by its last number that lengths go down to tenths.
const WINDOWS: &str = "4 1 2 1\n\
                       0 200\n\
                       0 0.00 0.00 0 0 0 0 0 100\n\
                       1 3.00 4.00 10 6 1 2 8 8 20 30\n\
                       2 1.00 1.00 10 4 1 1 1 0 50\n";

const TEXT: &str = "10\t1\n0 0 0\n6 0 0\n3 0 5\n3 4 8\n";

#[test]
fn shipped_problems_are_solved_to_their_best_known_scores() {
    for (name, best) in SHIPPED {
        let instance = load(name, &shipped(name));
        let answer = solve(&instance, EXPANSIONS, None);
        let route = answer.route.expect("a route to the end");
        let worth = instance.check(&route).expect("the route keeps the rules");
        assert!(worth.score >= best, "{name}: {}, {best} is known", worth.score);
        assert!(answer.bound >= worth.score, "{name}: {} above {}", worth.score, answer.bound);
    }
}

#[test]
fn problems_made_by_hand_are_solved_and_proven() {
    for (text, score, length, route) in [
        // 14 + 10 + 10: the far corner and the better one beside it.
        (SQUARE, 14.0, 34.0, vec![0, 2, 3, 0]),
        (WINDOWS, 10.0, 10.0, vec![0, 2, 1, 0]),
        (TEXT, 8.0, 10.0, vec![0, 3, 1]),
    ] {
        let instance = load("by hand", text.as_bytes());
        let answer = solve(&instance, EXPANSIONS, None);
        let found = answer.route.expect("a route to the end");
        let worth = instance.check(&found).expect("the route keeps the rules");
        assert_eq!((worth.score, answer.bound), (score, score), "{text}");
        assert!((worth.length - length).abs() < 1e-12, "{text}: {}", worth.length);
        // A closed tour is as good the other way round, if there are no windows.
        let backwards: Vec<usize> = found.iter().rev().copied().collect();
        assert!(found == route || backwards == route, "{text}: {found:?}");
    }
}

#[test]
fn an_end_out_of_reach_has_no_route() {
    let instance = load("far", b"5 1\n0 0 0\n6 0 0\n1 0 9\n");
    assert_eq!(solve(&instance, EXPANSIONS, None).route, None);
}

#[test]
fn the_reader_knows_each_format_by_its_content() {
    let square = load("square", SQUARE.as_bytes());
    assert_eq!((square.nodes.len(), square.start, square.end), (4, 0, 0));
    assert_eq!((square.limit, square.metric), (34.0, Metric::Nearest));
    assert_eq!(square.nodes[1].point, (10.0, 0.0));
    let scores: Vec<f64> = square.nodes.iter().map(|node| node.score).collect();
    assert_eq!(scores, [5.0, 1.0, 7.0, 2.0]);

    let windows = load("windows", WINDOWS.as_bytes());
    assert_eq!((windows.start, windows.end, windows.limit), (0, 0, 1000.0));
    assert_eq!(windows.metric, Metric::DownToTenths);
    assert_eq!(windows.nodes[0].window, None);
    let window = Some(Window { open: 200.0, close: 300.0 });
    let node = Node { point: (3.0, 4.0), score: 6.0, service: 100.0, window };
    assert_eq!(windows.nodes[1], node);
    let cordeau = load("windows", WINDOWS.replace("4 1 2 1", "5 1 2 4").as_bytes());
    assert_eq!((cordeau.metric, cordeau.limit), (Metric::DownToHundredths, 10_000.0));

    let text = load("text", TEXT.as_bytes());
    assert_eq!((text.start, text.end, text.limit), (0, 1, 10.0));
    assert_eq!((text.metric, text.nodes.len()), (Metric::Exact, 4));
}

#[test]
fn files_from_other_systems_read_the_same() {
    for text in [SQUARE, WINDOWS, TEXT] {
        let known = load("unix", text.as_bytes());
        assert_eq!(known, load("dos", text.replace('\n', "\r\n").as_bytes()));
        assert_eq!(known, load("marked", format!("\u{feff}{text}\n\n").as_bytes()));
    }
    // Colons stand where their writers like them, and nothing need follow the depot.
    let other = SQUARE.replace(" : ", ": ").replace("EOF\n", "");
    assert_eq!(load("square", SQUARE.as_bytes()), load("square", other.as_bytes()));
}

#[test]
fn a_route_that_breaks_a_rule_is_told_from_one_that_keeps_them() {
    let square = load("square", SQUARE.as_bytes());
    let told = |instance: &Instance, route: &[usize]| {
        instance.check(route).map(|worth| (worth.score, worth.length))
    };
    assert_eq!(told(&square, &[0, 0]), Ok((5.0, 0.0)));
    assert_eq!(told(&square, &[0, 1, 2, 0]), Ok((13.0, 34.0)));
    for (route, message) in [
        (&[][..], "a route of 0; it has at least a start and an end"),
        (&[0], "a route of 1; it has at least a start and an end"),
        (&[0, 1], "from node 0 to node 1; this route goes from 0 to 0"),
        (&[1, 0], "from node 1 to node 0; this route goes from 0 to 0"),
        (&[0, 4, 0], "node 4; the last one is 3"),
        (&[0, 1, 1, 0], "node 1 is visited twice"),
        (&[0, 1, 0, 0], "node 0 is visited twice"),
        (&[0, 1, 2, 3, 0], "the route takes 40; the limit is 34"),
    ] {
        assert_eq!(told(&square, route), Err(message.to_owned()));
    }

    let text = load("text", TEXT.as_bytes());
    assert_eq!(told(&text, &[0, 3, 1]), Ok((8.0, 10.0)));
    assert_eq!(told(&text, &[0, 2, 3, 1]), Err("the route takes 12; the limit is 10".to_owned()));
    assert_eq!(told(&text, &[0, 1, 1]), Err("node 1 is visited twice".to_owned()));

    // 1.4 there, 10 of service, 3.6 on: 15, and 5 of waiting; 10 of service and 5 home.
    let mut windows = load("windows", WINDOWS.as_bytes());
    assert_eq!(told(&windows, &[0, 2, 1, 0]), Ok((10.0, 10.0)));
    windows.nodes[2].window = Some(Window { open: 0.0, close: 13.0 });
    assert_eq!(
        told(&windows, &[0, 2, 1, 0]),
        Err("node 2 is reached at 1.4; it closes at 1.3".to_owned())
    );
    windows.nodes[2].window = None;
    windows.limit = 350.0;
    assert!(windows.check(&[0, 2, 1, 0]).is_ok());
    windows.limit = 349.0;
    assert_eq!(
        told(&windows, &[0, 2, 1, 0]),
        Err("the route takes 35; the limit is 34.9".to_owned())
    );
}

fn refused(text: &str) -> String {
    read("f", text.as_bytes()).expect_err("a broken file").to_string()
}

#[test]
fn a_broken_oplib_file_is_refused_with_its_line_and_what_was_expected() {
    for (from, to, message) in [
        ("TYPE : OP\n", "TYPE : TSP\n", "3: found `TYPE : TSP`; expected `TYPE : OP`"),
        (
            "DIMENSION : 4",
            "DIMENSION : 0",
            "4: found `0`; expected DIMENSION, a whole number from 1 to 2500",
        ),
        ("DIMENSION : 4\n", "", "6: found `NODE_COORD_SECTION`; expected DIMENSION before it"),
        ("COST_LIMIT : 34\n", "", "20: found the end of the file; expected COST_LIMIT"),
        (
            "COST_LIMIT : 34",
            "COST_LIMIT : 3 4",
            "5: found `3 4`; expected COST_LIMIT, a number from 0 to 1000000000",
        ),
        (
            "COST_LIMIT : 34\n",
            "COST_LIMIT : 34\nCOST_LIMIT : 34\n",
            "6: found `COST_LIMIT` again; expected it once",
        ),
        (
            "EUC_2D",
            "MAN_2D",
            "6: found `EDGE_WEIGHT_TYPE : MAN_2D`; expected EDGE_WEIGHT_TYPE to be EUC_2D, CEIL_2D, ATT or GEO",
        ),
        (
            "EDGE_WEIGHT_TYPE : EUC_2D\n",
            "",
            "20: found the end of the file; expected EDGE_WEIGHT_TYPE",
        ),
        ("2 1.0e+01 0", "3 1.0e+01 0", "9: found node `3`; expected node 2"),
        ("3 10 10", "2 10 10", "10: found node `2`; expected node 3"),
        ("3 10 10", "3 10", "10: found 2 fields; expected 3: `i x y`"),
        ("3 10 10", "3 10 inf", "10: found `inf`; expected y, a number up to 1000000000"),
        ("3 10 10\n", "", "10: found node `4`; expected node 3"),
        ("4 0 10\n", "", "11: found 1 field; expected 3: `i x y`"),
        ("3 7", "3 -7", "15: found `-7`; expected the score, a number from 0 to 1000000000"),
        (
            "4 2\n",
            "4 2\n5 2\n",
            "17: found `5 2`; expected a keyword (NAME, COMMENT, TYPE, DIMENSION, COST_LIMIT, EDGE_WEIGHT_TYPE), a section (NODE_COORD, NODE_SCORE, DEPOT) or `EOF`",
        ),
        (
            "SECTION\n1\n-1",
            "SECTION\n5\n-1",
            "18: found `5`; expected the depot, a whole number from 1 to 4",
        ),
        (
            "SECTION\n1\n-1",
            "SECTION\n1\n2\n-1",
            "19: found `2`; expected `-1`, the end of the depots: a tour has one",
        ),
        ("DEPOT_SECTION\n1\n-1\n", "", "18: found the end of the file; expected DEPOT_SECTION"),
    ] {
        let broken = SQUARE.replacen(from, to, 1);
        assert_ne!(broken, SQUARE, "{from}");
        assert_eq!(refused(&broken), format!("f, line {message}"));
    }
    let cut = SQUARE.find("3 7").expect("a score");
    let told = refused(&SQUARE[..cut]);
    assert_eq!(told, "f, line 15: found the end of the file; expected node 3 of 4");
    let cut = SQUARE.find("NODE_SCORE").expect("the scores");
    let told = refused(&SQUARE[..cut]);
    assert_eq!(told, "f, line 12: found the end of the file; expected NODE_SCORE_SECTION");
}

#[test]
fn a_broken_file_with_windows_is_refused_with_its_line_and_what_was_expected() {
    for (from, to, message) in [
        (
            "4 1 2 1",
            "4 1 2 0",
            "1: found `0`; expected t, a whole number from 1 to 18446744073709551615",
        ),
        ("4 1 2 1", "4 1 -2 1", "1: found `-2`; expected N, a whole number from 0 to 2499"),
        (
            "4 1 2 1",
            "4 1 1 1",
            "5: found `2 1.00 1.00 10 4 1 1 1 0 50`; expected the end: N, the number of the last vertex, is 1",
        ),
        (
            "4 1 2 1",
            "4 1 3 1",
            "6: found the end of the file; expected vertex 3 of 3, `i x y d S f a list O C`",
        ),
        ("0 200\n", "", "2: found 9 fields; expected 2: `D Q`"),
        ("1 3.00", "2 3.00", "4: found vertex `2`; expected vertex 1"),
        ("2 1.00 1.00", "1 1.00 1.00", "5: found vertex `1`; expected vertex 2"),
        (
            "20 30",
            "30 20",
            "4: found a window from 30 to 20; expected one that closes when it opens or later",
        ),
        ("20 30", "20", "4: found 10 fields; expected 11, for a is 2: `i x y d S f a list O C`"),
        (
            "1 2 8 8",
            "1 -2 8 8",
            "4: found `-2`; expected a, the length of the list, a whole number from 0 to 11",
        ),
        (
            "3.00 4.00 10",
            "3.00 4.00 NaN",
            "4: found `NaN`; expected d, the service time, a number from 0 to 1000000000",
        ),
        ("3.00 4.00", "3.00 1e10", "4: found `1e10`; expected y, a number up to 1000000000"),
        ("0 100\n", "5 100\n", "3: found a depot that opens at 5; expected 0: a route starts then"),
    ] {
        let broken = WINDOWS.replacen(from, to, 1);
        assert_ne!(broken, WINDOWS, "{from}");
        assert_eq!(refused(&broken), format!("f, line {message}"));
    }
    let told = refused("4 1 2 1\n0 200\n0 1 2\n");
    assert_eq!(told, "f, line 3: found 3 fields; expected `i x y d S f a list O C`");
}

#[test]
fn a_broken_text_is_refused_with_its_line_and_what_was_expected() {
    for (from, to, message) in [
        ("10\t1", "10\t2", "1: found `2` paths; expected `1`, a single path"),
        ("10\t1", "-10\t1", "1: found `-10`; expected Tmax, a number from 0 to 1000000000"),
        ("3 0 5", "3 0", "4: found 2 fields; expected 3: `x y score`"),
        ("3 0 5", "3 0 -5", "4: found `-5`; expected the score, a number from 0 to 1000000000"),
        (
            "6 0 0\n3 0 5\n3 4 8\n",
            "",
            "3: found the end of the file; expected `x y score` of the start and of the end",
        ),
    ] {
        let broken = TEXT.replacen(from, to, 1);
        assert_ne!(broken, TEXT, "{from}");
        assert_eq!(refused(&broken), format!("f, line {message}"));
    }
    let many = format!("10 1\n{}", "0 0 0\n".repeat(2501));
    assert_eq!(refused(&many), "f, line 2502: found one more point; expected at most 2500");
}

#[test]
fn a_file_of_no_format_is_refused() {
    const FORMATS: &str = "expected the first line of a problem: a keyword (OPLib), `Tmax P` \
                           (Tsiligirides, Chao) or `k v N t` (with windows)";
    assert_eq!(refused(""), format!("f, line 1: found the end of the file; {FORMATS}"));
    assert_eq!(refused("\n\n"), format!("f, line 3: found the end of the file; {FORMATS}"));
    assert_eq!(refused("1 2 3\n"), format!("f, line 1: found `1 2 3`; {FORMATS}"));
    let told = read("f", b"10 1\n0 0 \xff\n").expect_err("no text").to_string();
    assert_eq!(told, "f, line 2: found the byte 0xff; expected text (UTF-8)");
}

/// The best score of all routes, by trying them.
fn best_of_all(instance: &Instance) -> Option<f64> {
    let others: Vec<usize> = (0..instance.nodes.len())
        .filter(|node| ![instance.start, instance.end].contains(node))
        .collect();
    let mut best = None;
    let mut routes = vec![Vec::new()];
    while let Some(inner) = routes.pop() {
        let mut route = vec![instance.start];
        route.extend(&inner);
        route.push(instance.end);
        if let Ok(worth) = instance.check(&route) {
            best = Some(worth.score).max_by_score(best);
        }
        for &node in others.iter().filter(|node| !inner.contains(node)) {
            routes.push([&inner[..], &[node]].concat());
        }
    }
    best
}

/// The larger of two scores, none being the least.
trait MaxByScore {
    fn max_by_score(self, other: Self) -> Self;
}

impl MaxByScore for Option<f64> {
    fn max_by_score(self, other: Self) -> Self {
        match (self, other) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        }
    }
}

prop_compose! {
    fn any_node()(
        x in -10..10i32,
        y in -10..10i32,
        score in 0..9u32,
        service in 0..4u32,
        window in proptest::option::of((0..40u32, 0..20u32)),
    ) -> Node {
        let window = window.map(|(open, lasts)| Window {
            open: f64::from(open),
            close: f64::from(open + lasts),
        });
        Node {
            point: (f64::from(x), f64::from(y)),
            score: f64::from(score),
            service: f64::from(service),
            window,
        }
    }
}

prop_compose! {
    /// At most five nodes besides the ends; the ends have no windows, as in the files.
    fn small_problem()(
        mut nodes in proptest::collection::vec(any_node(), 2..8),
        end in 0..2usize,
        limit in 0..80u32,
        metric in prop_oneof![Just(Metric::Exact), Just(Metric::Nearest), Just(Metric::Up)],
    ) -> Instance {
        for node in &mut nodes[..2] {
            node.window = None;
        }
        Instance { nodes, start: 0, end, limit: f64::from(limit), metric }
    }
}

/// A file that was cut, and of which some bytes were changed.
fn damaged() -> impl Strategy<Value = Vec<u8>> {
    let files: Vec<Vec<u8>> = SHIPPED
        .iter()
        .map(|(name, _)| shipped(name))
        .chain([SQUARE, WINDOWS, TEXT].map(|text| text.as_bytes().to_vec()))
        .collect();
    let byte =
        prop_oneof![any::<u8>(), proptest::sample::select(b"0123456789 \n-+.:eENaif".to_vec())];
    let changes = proptest::collection::vec((any::<proptest::sample::Index>(), byte), 0..8);
    let cut = proptest::option::of(any::<proptest::sample::Index>());
    (proptest::sample::select(files), changes, cut).prop_map(|(mut file, changes, cut)| {
        for (place, byte) in changes {
            let place = place.index(file.len());
            file[place] = byte;
        }
        if let Some(cut) = cut {
            file.truncate(cut.index(file.len()));
        }
        file
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// No panic; and what is read can be worked with.
    #[test]
    fn a_damaged_file_is_an_instance_or_an_error(bytes in damaged()) {
        match read("damaged", &bytes) {
            Ok(instance) => {
                let Instance { nodes, start, end, limit, .. } = &instance;
                prop_assert!(*start < nodes.len() && *end < nodes.len());
                prop_assert!(limit.is_finite() && *limit >= 0.0);
                for (index, node) in nodes.iter().enumerate() {
                    let length = instance.length(*start, index);
                    prop_assert!(length.is_finite() && length >= 0.0, "{length}");
                    prop_assert!(node.score >= 0.0 && node.service >= 0.0);
                    prop_assert!(node.window.is_none_or(|w| w.open <= w.close));
                }
            }
            Err(error) => prop_assert!(error.line >= 1 && !error.expected.is_empty()),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn small_problems_are_solved_as_well_as_by_trying_all_routes(instance in small_problem()) {
        let answer = solve(&instance, u64::MAX, None);
        let score = answer.route.map(|route| instance.check(&route).map(|worth| worth.score));
        let score = score.transpose().map_err(TestCaseError::fail)?;
        prop_assert_eq!(score, best_of_all(&instance));
        if let Some(score) = score {
            prop_assert_eq!(answer.bound, score, "not proven");
        }
    }
}

/// The folder of the whole benchmark, if it is at hand.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so")]
fn benchmark(test: &str) -> Option<PathBuf> {
    let Some(data) = std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty()) else {
        println!("skipped: {test}: WISDOM_DATA is not set");
        return None;
    };
    Some(Path::new(&data).join("benchmarks").join("op"))
}

/// A line of the table of best known scores.
struct Known {
    set: String,
    file: String,
    nodes: usize,
    limit: f64,
    score: f64,
    /// Length and nodes of a route with that score, if one is known.
    route: Option<(f64, Vec<usize>)>,
}

fn best_known(folder: &Path) -> Vec<Known> {
    let mut table =
        csv::Reader::from_path(folder.join("best_known.csv")).expect("the table can be read");
    let known = table.records().map(|record| {
        let record = record.expect("a line of the table");
        let number = |field: usize| record[field].parse::<f64>().expect("a number");
        let nodes: Vec<usize> =
            record[8].split_whitespace().map(|node| node.parse().expect("a node")).collect();
        Known {
            set: record[0].to_owned(),
            file: record[1].to_owned(),
            nodes: record[2].parse().expect("a number of nodes"),
            limit: number(3),
            score: number(4),
            route: (!nodes.is_empty()).then(|| (number(5), nodes)),
        }
    });
    known.collect()
}

fn load_known(folder: &Path, known: &Known) -> Instance {
    let path = folder.join(&known.set).join(&known.file);
    load(&known.file, &fs::read(path).expect("the file can be read"))
}

#[test]
fn every_file_is_read_and_every_known_route_is_worth_what_is_said() {
    const TEST: &str = "every_file_is_read_and_every_known_route_is_worth_what_is_said";
    let Some(folder) = benchmark(TEST) else { return };
    let table = best_known(&folder);
    assert!(table.len() >= 159, "{} files", table.len());
    for known in &table {
        let (file, instance) = (&known.file, load_known(&folder, known));
        assert_eq!(instance.nodes.len(), known.nodes, "{file}");
        assert_eq!(instance.limit / instance.metric.units_per_one(), known.limit, "{file}");
        if let Some((length, route)) = &known.route {
            let worth = instance.check(route).unwrap_or_else(|error| panic!("{file}: {error}"));
            assert_eq!(worth.score, known.score, "{file}");
            // The table prints four decimals.
            assert!((worth.length - length).abs() <= 5.1e-5, "{file}: {} {length}", worth.length);
        }
    }
}

#[test]
fn every_problem_of_tsiligirides_and_chao_is_solved_to_its_best_known_score() {
    const TEST: &str = "every_problem_of_tsiligirides_and_chao_is_solved_to_its_best_known_score";
    let Some(folder) = benchmark(TEST) else { return };
    let mut table = best_known(&folder);
    table.retain(|known| ["tsiligirides", "chao"].contains(&known.set.as_str()));
    assert!(table.len() >= 45, "{} files", table.len());
    for known in &table {
        let instance = load_known(&folder, known);
        let route = solve(&instance, EXPANSIONS, None).route.expect("a route to the end");
        let worth = instance.check(&route).expect("the route keeps the rules");
        assert!(worth.score >= known.score, "{}: {}", known.file, worth.score);
    }
}

/// Bounds of hurried searches, which is when they would be wrong.
#[test]
fn no_bound_is_below_the_best_known_score_of_any_problem() {
    const TEST: &str = "no_bound_is_below_the_best_known_score_of_any_problem";
    let Some(folder) = benchmark(TEST) else { return };
    for known in &best_known(&folder) {
        let instance = load_known(&folder, known);
        for expansions in [500, 6000] {
            let answer = solve(&instance, expansions, None);
            assert!(answer.bound >= known.score, "{}: {}", known.file, answer.bound);
            let score = answer.route.map_or(0.0, |route| {
                instance.check(&route).expect("the route keeps the rules").score
            });
            assert!(answer.bound >= score, "{}: {score} above {}", known.file, answer.bound);
        }
    }
}
