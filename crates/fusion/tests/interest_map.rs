//! From readings to interest: the paper's point, hidden and dull ground, credit, threads.

use std::collections::BTreeMap;

use proptest::prelude::*;
use wisdom_belief::{InterestMass, Opinion, ParadoxPolicy, Rule};
use wisdom_fusion::{
    Band, Class, Evidence, Expert, Fusion, FusionError, InterestMap, LookupTable, Rows, Statistic,
    belief_map, credit, interest_map, judge,
};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::Layer;

/// The paper prints u with two digits; as f32 it is off by 3e-8, and a fused mass by no more.
const READING: f64 = 1e-7;

/// Planes are f32.
const PLANE: f64 = 1e-6;

fn opinion(paradox: f64, not_interesting: f64, interesting: f64) -> Opinion {
    Opinion { paradox, not_interesting, interesting }
}

fn banded(name: &str, rows: &[(f64, f64, Opinion)], outside: Opinion) -> LookupTable {
    let rows = rows.iter().map(|&(lo, hi, opinion)| Band { lo, hi, opinion }).collect();
    LookupTable::new(name, name, "1", Rows::Bands(rows), outside).expect("a table")
}

fn expert(name: &str, table: LookupTable) -> Expert {
    Expert { name: name.to_owned(), layer: name.to_owned(), table }
}

/// Tables 1, 3 and 2 of the paper.
fn experts() -> Vec<Expert> {
    let dull = opinion(0.2, 0.8, 0.0);
    let gradient = [
        (0.0, 1.0, dull),
        (1.0, 3.0, opinion(0.3, 0.6, 0.1)),
        (3.0, 5.0, opinion(0.1, 0.1, 0.8)),
        (5.0, 7.0, opinion(0.15, 0.05, 0.8)),
        (7.0, 9.0, opinion(0.05, 0.05, 0.9)),
        (9.0, f64::INFINITY, opinion(0.05, 0.0, 0.95)),
    ];
    let thermal = [
        (0.0, 20.0, dull),
        (20.0, 40.0, opinion(0.4, 0.5, 0.1)),
        (40.0, 60.0, opinion(0.05, 0.0, 0.95)),
        (60.0, 80.0, opinion(0.15, 0.05, 0.8)),
        (80.0, 100.0, opinion(0.05, 0.05, 0.9)),
    ];
    let texture = [
        Class { class: 1, opinion: opinion(0.3, 0.6, 0.1) },
        Class { class: 2, opinion: opinion(0.1, 0.1, 0.8) },
        Class { class: 3, opinion: opinion(0.15, 0.05, 0.8) },
        Class { class: 4, opinion: opinion(0.05, 0.0, 0.95) },
    ];
    let texture = LookupTable::new("texture", "class", "1", Rows::Classes(texture.to_vec()), dull);
    vec![
        expert("dem", banded("dem", &gradient, dull)),
        expert("texture", texture.expect("a table")),
        expert("thermal", banded("thermal", &thermal, dull)),
    ]
}

/// Reading and u of dem, texture and thermal at one cell.
type Readings = [(f32, f32); 3];

/// One cell a column.
fn layers(cells: &[Readings]) -> BTreeMap<String, Layer> {
    let spec = GridSpec::new(1, cells.len(), 1.0).expect("a grid");
    let raster = |f: &dyn Fn(&Readings) -> f32| {
        Raster::from_vec(spec, cells.iter().map(f).collect()).expect("a raster")
    };
    let layer = |index: usize| {
        Layer::new(raster(&|cell| cell[index].0), raster(&|cell| cell[index].1)).expect("a layer")
    };
    ["dem", "texture", "thermal"]
        .into_iter()
        .enumerate()
        .map(|(index, name)| (name.to_owned(), layer(index)))
        .collect()
}

/// Table 6, the border of rock D; dull ground in clear sight; hidden ground.
fn evidence() -> Evidence {
    let border = [(6.088, 0.0), (4.0, 0.66), (10.23, 0.19)];
    let dull = [(0.5, 0.0), (0.0, 0.0), (4.0, 0.0)];
    let hidden = [(12.0, 1.0), (4.0, 1.0), (50.0, 1.0)];
    judge(&experts(), &layers(&[border, dull, hidden])).expect("three experts on one grid")
}

const BORDER: Cell = Cell { row: 0, col: 0 };
const DULL: Cell = Cell { row: 0, col: 1 };
const HIDDEN: Cell = Cell { row: 0, col: 2 };

/// The rules that make maps.
fn map_rules() -> Vec<Rule> {
    Rule::ALL.into_iter().filter(|rule| rule.on_maps()).collect()
}

fn by(rule: Rule) -> Fusion {
    Fusion { rule, ..Fusion::default() }
}

fn assert_near(found: impl Into<f64>, expected: f64, tolerance: f64) {
    let found = found.into();
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

#[test]
fn table_6_readings_become_the_papers_masses() {
    let expected = [[0.15, 0.05, 0.8, 0.0], [0.017, 0.0, 0.323, 0.66], [0.162, 0.648, 0.0, 0.19]];
    for (mass, expected) in evidence().at(BORDER).zip(expected) {
        let found = [mass.paradox(), mass.not_interesting(), mass.interesting(), mass.ignorance()];
        for (found, expected) in found.into_iter().zip(expected) {
            assert_near(found, expected, READING);
        }
    }
}

#[test]
fn table_7_falls_out_of_the_map() {
    let map = interest_map(&evidence(), &by(Rule::Dsmc));
    assert_near(map.interest[BORDER], 0.972_346, PLANE);
    assert_near(map.paradox[BORDER], 0.822_93, PLANE);
    assert_near(map.ignorance[BORDER], 0.0, PLANE);
    assert_eq!(map.conflict[BORDER], 0.0);
    // The DEM finds it interesting, the thermal expert does not.
    assert_near(map.contradiction[BORDER], 0.8 * 0.648, PLANE);
}

#[test]
fn table_9_falls_out_of_the_map() {
    let map = interest_map(&evidence(), &by(Rule::Dempster));
    assert_near(map.interest[BORDER], 0.6881, 5e-5);
    assert_near(map.ignorance[BORDER], 0.0824, 5e-5);
    assert_eq!(map.paradox[BORDER], 0.0);
    assert!(map.conflict[BORDER] > 0.5);
    assert_near(map.contradiction[BORDER], 0.8 * 0.648, PLANE);
}

#[test]
fn the_mission_chooses_rule_policy_and_statistic() {
    let interest = |fusion: Fusion| f64::from(interest_map(&evidence(), &fusion).interest[BORDER]);
    let pcr6 = by(Rule::Pcr6);
    assert_near(interest(pcr6), 0.5518, 5e-5);
    assert_near(interest(Fusion { statistic: Statistic::Pignistic, ..pcr6 }), 0.6291, 5e-5);
    let split = Fusion { paradox_policy: ParadoxPolicy::Split, ..by(Rule::Dempster) };
    assert_near(interest(split), 0.7538, 5e-5);
    // DSmP under Dempster: 0.6881 + 0.0824 × 0.6891 / 0.9197.
    let dsmp = Fusion { statistic: Statistic::Dsmp, ..by(Rule::Dempster) };
    assert_near(interest(dsmp), 0.7498, 1e-4);
}

#[test]
fn the_dem_has_most_credit_for_the_rock_border() {
    let shares = credit(&evidence(), &by(Rule::Dsmc), BORDER);
    for (share, expected) in shares.iter().zip([0.835, 0.116, 0.049]) {
        assert_near(*share, expected, 5e-4);
    }
    assert_near(shares.iter().sum::<f64>(), 1.0, 1e-12);
}

#[test]
fn an_expert_who_speaks_against_the_outcome_has_a_negative_share() {
    for rule in [Rule::Dempster, Rule::Pcr6] {
        let shares = credit(&evidence(), &by(rule), BORDER);
        assert_near(shares.iter().sum::<f64>(), 1.0, 1e-12);
        assert!(shares[2] < 0.0 && shares[0] + shares[1] > 1.0, "{rule}: {shares:?}");
    }
}

/// The definition, order by order.
#[test]
fn credit_is_the_mean_contribution_over_all_orders_of_speaking() {
    let evidence = evidence();
    let sources: Vec<InterestMass> = evidence.at(BORDER).collect();
    for (rule, statistic) in [Rule::Dempster, Rule::Pcr6]
        .into_iter()
        .flat_map(|rule| Statistic::ALL.map(|statistic| (rule, statistic)))
    {
        let fusion = Fusion { statistic, ..by(rule) };
        let worth = |speakers: &[usize]| {
            let some: Vec<InterestMass> = speakers.iter().map(|&s| sources[s]).collect();
            statistic.of(rule.fuse(&some, fusion.paradox_policy).mass, &rule.model())
        };
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let mut mean = [0.0; 3];
        for order in orders {
            for place in 0..3 {
                mean[order[place]] += (worth(&order[..=place]) - worth(&order[..place])) / 6.0;
            }
        }
        let whole = worth(&[0, 1, 2]) - worth(&[]);
        for (share, mean) in credit(&evidence, &fusion, BORDER).into_iter().zip(mean) {
            assert_near(share, mean / whole, 1e-12);
        }
    }
}

#[test]
fn dull_ground_in_clear_sight_has_interest_0_488() {
    let map = interest_map(&evidence(), &Fusion::default());
    assert_near(map.interest[DULL], 0.488, PLANE);
    assert_eq!(map.contradiction[DULL], 0.0);
}

#[test]
fn hidden_ground_has_no_interest_no_credit_and_is_all_ignorance() {
    let evidence = evidence();
    for rule in map_rules() {
        let map = interest_map(&evidence, &by(rule));
        assert_eq!((map.interest[HIDDEN], map.ignorance[HIDDEN]), (0.0, 1.0), "{rule}");
        assert_eq!((map.conflict[HIDDEN], map.paradox[HIDDEN]), (0.0, 0.0), "{rule}");
        assert_eq!(credit(&evidence, &by(rule), HIDDEN), [0.0; 3], "{rule}");
    }
}

#[test]
fn total_conflict_is_a_value() {
    let certain = |name, opinion| expert(name, banded(name, &[(0.0, 9.0, opinion)], opinion));
    let experts =
        [certain("dem", opinion(0.0, 0.0, 1.0)), certain("texture", opinion(0.0, 1.0, 0.0))];
    let evidence = judge(&experts, &layers(&[[(1.0, 0.0); 3]])).expect("two experts");
    let map = interest_map(&evidence, &by(Rule::Dempster));
    assert_eq!(
        (map.conflict[BORDER], map.ignorance[BORDER], map.interest[BORDER]),
        (1.0, 1.0, 0.0)
    );
    assert_eq!(credit(&evidence, &by(Rule::Dempster), BORDER), [0.0; 2]);
}

/// Doubts below a millionth count as a millionth: certain experts share, none gets NaN.
#[test]
fn certain_experts_share_their_credit() {
    let certain = |name| {
        expert(name, banded(name, &[(0.0, 9.0, opinion(0.0, 0.0, 1.0))], Opinion::default()))
    };
    let experts = [certain("dem"), certain("texture")];
    let evidence = judge(&experts, &layers(&[[(1.0, 0.0); 3]])).expect("two experts");
    assert_eq!(credit(&evidence, &by(Rule::Dsmc), BORDER), [0.5, 0.5]);
}

proptest! {
    #[test]
    fn shares_sum_to_one_where_there_is_interest(
        cell in prop::array::uniform3((0.0..100.0_f32, 0.0..0.99_f32)),
        rule in prop::sample::select(map_rules()),
        statistic in prop::sample::select(Statistic::ALL.to_vec()),
    ) {
        let evidence = judge(&experts(), &layers(&[cell])).expect("three experts");
        let fusion = Fusion { rule, statistic, ..Fusion::default() };
        let shares = credit(&evidence, &fusion, BORDER);
        if shares == [0.0; 3] {
            let interest = f64::from(interest_map(&evidence, &fusion).interest[BORDER]);
            let of_ignorance = statistic.of(InterestMass::VACUOUS, &rule.model());
            prop_assert!((interest - of_ignorance).abs() < PLANE, "{}", interest);
            return Ok(());
        }
        // Large shares of opposite sign lose digits in their own sum.
        let largest = shares.iter().fold(1.0, |largest: f64, share| largest.max(share.abs()));
        prop_assert!((shares.iter().sum::<f64>() - 1.0).abs() <= 1e-12 * largest, "{:?}", shares);
    }
}

#[test]
fn one_thread_and_four_make_the_same_bits() {
    let spec = GridSpec::new(150, 170, 1.0).expect("a grid");
    let layer = |scale: usize, modulus: usize| {
        let value = move |cell: Cell| ((cell.row * scale + cell.col * 7) % modulus) as f32 * 0.37;
        let u = move |cell: Cell| ((cell.row * 3 + cell.col * scale) % 101) as f32 / 100.0;
        Layer::new(Raster::from_fn(spec, value), Raster::from_fn(spec, u)).expect("a layer")
    };
    let layers = BTreeMap::from([
        ("dem".to_owned(), layer(5, 31)),
        ("texture".to_owned(), layer(11, 14)),
        ("thermal".to_owned(), layer(13, 270)),
    ]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let evidence = judge(&experts(), &layers).expect("three experts");
            map_rules()
                .into_iter()
                .map(|rule| interest_map(&evidence, &by(rule)))
                .collect::<Vec<_>>()
        })
    };
    let (one, four) = (on(1), on(4));
    let bits = |map: &InterestMap| {
        let planes =
            [&map.interest, &map.ignorance, &map.paradox, &map.conflict, &map.contradiction];
        planes.map(|plane| plane.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>())
    };
    for (one, four) in one.iter().zip(&four) {
        assert!(bits(one) == bits(four));
    }
}

#[test]
fn a_missing_layer_is_named_with_its_expert() {
    let mut layers = layers(&[[(0.0, 0.0); 3]]);
    layers.remove("texture");
    let error = judge(&experts(), &layers).expect_err("no texture").to_string();
    assert_eq!(
        error,
        "expert `texture` reads layer `texture`, which does not exist; known: dem, thermal"
    );
}

#[test]
fn layers_on_different_grids_are_refused_with_both_named() {
    let mut layers = layers(&[[(0.0, 0.0); 3]]);
    let other = GridSpec::new(2, 1, 0.5).expect("a grid");
    layers.insert("thermal".to_owned(), Layer::unknown(other));
    let error = judge(&experts(), &layers).expect_err("two grids").to_string();
    assert!(
        error.starts_with("layers `dem` and `thermal` must share one grid: 1 x 1 cells of 1 m")
    );
    assert!(error.contains("against 2 x 1 cells of 0.5 m"), "{error}");
}

#[test]
fn nobody_and_namesakes_cannot_judge() {
    let layers = layers(&[[(0.0, 0.0); 3]]);
    assert_eq!(judge(&[], &layers), Err(FusionError::NoExperts));
    let twice = [experts()[0].clone(), experts()[0].clone()];
    assert_eq!(judge(&twice, &layers), Err(FusionError::RepeatedExpert { name: "dem".to_owned() }));
}

#[test]
fn how_many_experts_a_rule_takes_depends_on_what_they_cost() {
    assert_eq!(by(Rule::Dsmc).check(100), Ok(()));
    for (rule, limit) in
        [(Rule::Dempster, 12), (Rule::Pcr6, 12), (Rule::Pcr5, 8), (Rule::Pcr5Plus, 8)]
    {
        assert_eq!(by(rule).check(limit), Ok(()));
        let experts = limit + 1;
        let refused = FusionError::TooManyExperts { experts, limit, rule };
        assert_eq!(by(rule).check(experts), Err(refused));
    }
}

/// As many experts as there may be, most of whom have not seen the cell.
#[test]
fn twelve_experts_are_fused_and_credited() {
    let mut panel = experts();
    for number in 3..12 {
        let name = format!("dem-{number}");
        panel.push(Expert { name, ..panel[0].clone() });
    }
    let cell = [(6.088, 0.7), (4.0, 0.66), (10.23, 0.19)];
    let evidence = judge(&panel, &layers(&[cell])).expect("twelve experts");
    for rule in [Rule::Pcr6, Rule::Pcr6Plus, Rule::Cautious] {
        let fusion = by(rule);
        let map = interest_map(&evidence, &fusion);
        let straight = belief_map(&panel, &layers(&[cell]), &fusion).expect("a map");
        assert_near(straight[BORDER], map.interest[BORDER].into(), PLANE);
        let shares = credit(&evidence, &fusion, BORDER);
        assert_near(shares.iter().sum::<f64>(), 1.0, 1e-9);
        // The same reading by the same table earns the same.
        assert!(shares[3..].iter().all(|share| (share - shares[0]).abs() < 1e-9), "{shares:?}");
    }
}

#[test]
fn plausibility_is_refused_because_it_is_constant() {
    for statistic in Statistic::ALL {
        assert_eq!(statistic.to_string().parse(), Ok(statistic));
    }
    let error = "plausibility".parse::<Statistic>().expect_err("constant").to_string();
    assert!(error.contains("constant 1"), "{error}");
    let error = "entropy".parse::<Statistic>().expect_err("unknown").to_string();
    assert_eq!(error, "unknown statistic `entropy`; known: belief, pignistic, dsmp");
}

/// Layers on which every row, gap and degree of uncertainty comes up.
fn varied_layers(rows: usize, cols: usize) -> BTreeMap<String, Layer> {
    let spec = GridSpec::new(rows, cols, 1.0).expect("a grid");
    let layer = |scale: usize, modulus: usize, unit: f32| {
        let value = move |cell: Cell| ((cell.row * scale + cell.col * 7) % modulus) as f32 * unit;
        let u = move |cell: Cell| ((cell.row * 3 + cell.col * scale) % 101) as f32 / 100.0;
        Layer::new(Raster::from_fn(spec, value), Raster::from_fn(spec, u)).expect("a layer")
    };
    BTreeMap::from([
        ("dem".to_owned(), layer(5, 31, 0.37)),
        ("texture".to_owned(), layer(11, 14, 0.5)),
        ("thermal".to_owned(), layer(13, 270, 0.5)),
    ])
}

#[test]
fn belief_straight_from_readings_is_that_of_the_evidence() {
    let layers = varied_layers(150, 170);
    let mut experts = experts();
    // Gaps, a band without an end, and one that starts where another stops.
    let rare = opinion(0.1, 0.0, 0.7);
    let gaps = [(2.0, 3.0, rare), (7.5, f64::INFINITY, rare), (3.0, 4.0, opinion(0.0, 0.5, 0.2))];
    experts.push(Expert { layer: "dem".to_owned(), ..expert("gaps", banded("gaps", &gaps, rare)) });
    let evidence = judge(&experts, &layers).expect("four experts");
    for rule in map_rules() {
        for paradox_policy in ParadoxPolicy::ALL.into_iter().filter(|&policy| rule.admits(policy)) {
            let fusion = Fusion { paradox_policy, ..by(rule) };
            let kept = interest_map(&evidence, &fusion).interest;
            let straight = belief_map(&experts, &layers, &fusion).expect("a map");
            for (cell, (kept, straight)) in kept.values().iter().zip(straight.values()).enumerate()
            {
                let close = (kept - straight).abs() <= PLANE as f32;
                assert!(close, "{rule}, {paradox_policy}, cell {cell}: {straight}, not {kept}");
            }
        }
    }
}

#[test]
fn belief_straight_from_readings_is_the_same_at_any_number_of_threads() {
    let layers = varied_layers(300, 500);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| belief_map(&experts(), &layers, &by(Rule::Pcr6)).expect("a map"))
    };
    assert_eq!(on(1), on(3));
}

/// More rows than the kernels hold: slower, and the same.
#[test]
fn a_table_of_any_length_makes_a_map() {
    let rows =
        (0..200).map(|class| Class { class, opinion: opinion(0.1, 0.0, f64::from(class) / 250.0) });
    let table =
        LookupTable::new("t", "class", "1", Rows::Classes(rows.collect()), Opinion::default());
    let experts = [expert("texture", table.expect("a table"))];
    let cells = [[(0.0, 0.0), (100.0, 0.5), (0.0, 0.0)], [(0.0, 0.0), (999.0, 0.0), (0.0, 0.0)]];
    let belief = belief_map(&experts, &layers(&cells), &Fusion::default()).expect("a map");
    assert_near(belief[BORDER], 0.25, PLANE);
    assert_near(belief[DULL], 0.0, PLANE);
}

/// `dsmc` takes any number of experts; the kernels hold sixteen.
#[test]
fn more_experts_than_the_kernels_hold_make_a_map() {
    let layers = varied_layers(20, 20);
    for count in [16, 17, 40] {
        let panel: Vec<Expert> = (0..count)
            .map(|number| Expert { name: format!("e{number}"), ..experts()[number % 3].clone() })
            .collect();
        let kept = interest_map(&judge(&panel, &layers).expect("experts"), &Fusion::default());
        let straight = belief_map(&panel, &layers, &Fusion::default()).expect("a map");
        for (kept, straight) in kept.interest.values().iter().zip(straight.values()) {
            assert_near(*straight, (*kept).into(), PLANE);
        }
    }
}

#[test]
fn what_makes_no_sense_on_maps_is_refused_with_what_would() {
    let told = |fusion: Fusion| fusion.check(3).expect_err("makes no sense").to_string();
    assert!(told(by(Rule::Bold)).starts_with("rule bold cannot make a map"));
    let policy = |rule, paradox_policy| Fusion { paradox_policy, ..by(rule) };
    assert_eq!(
        told(policy(Rule::Pcr6, ParadoxPolicy::KeepForDsmh)),
        "paradox policy keep-for-dsmh means nothing to rule pcr6; it takes to-ignorance, split, renormalise"
    );
    assert_eq!(policy(Rule::Dsmh, ParadoxPolicy::KeepForDsmh).check(3), Ok(()));
    assert_eq!(policy(Rule::Conjunctive, ParadoxPolicy::ToEmpty).check(3), Ok(()));
    for k in [-0.1, 1.1, f64::NAN] {
        let error = told(Fusion { inagaki_k: k, ..by(Rule::Inagaki) });
        assert_eq!(
            error,
            format!("inagaki-k is {k}; it lies in [0, 1], where it suits every cell")
        );
    }
    assert!(belief_map(&experts(), &varied_layers(2, 2), &by(Rule::Bold)).is_err());
}

/// Table 8's last policy: the paradox is kept, and the hybrid rule learns only then that nothing is both.
#[test]
fn the_hybrid_rule_can_be_told_of_the_model_at_the_end() {
    let fusion = Fusion { paradox_policy: ParadoxPolicy::KeepForDsmh, ..by(Rule::Dsmh) };
    let map = interest_map(&evidence(), &fusion);
    assert_near(map.interest[BORDER], 0.2013, 5e-5);
    assert_near(map.ignorance[BORDER], 0.7687, 5e-5);
    assert_eq!(map.paradox[BORDER], 0.0);
}

/// Inagaki's family runs from Yager's rule at k = 0 towards Dempster's.
#[test]
fn inagakis_k_chooses_between_yager_and_more() {
    let interest = |fusion: Fusion| interest_map(&evidence(), &fusion).interest[BORDER];
    let inagaki = |inagaki_k| interest(Fusion { inagaki_k, ..by(Rule::Inagaki) });
    assert_near(inagaki(0.0), interest(by(Rule::Yager)).into(), PLANE);
    assert!(inagaki(0.0) < inagaki(0.5) && inagaki(0.5) < inagaki(1.0));
    assert!(inagaki(1.0) < interest(by(Rule::Dempster)));
}

/// Mass on ∅ is no reason to go there.
#[test]
fn conflict_that_is_kept_counts_as_conflict_and_not_as_interest() {
    let map = interest_map(&evidence(), &by(Rule::Conjunctive));
    assert_near(map.interest[BORDER], 0.2987, 5e-5);
    assert_eq!(map.paradox[BORDER], 0.0);
    assert!(map.conflict[BORDER] > 0.5);
}
