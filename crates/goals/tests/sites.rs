//! Sites are the maxima that the definition of prominence names, found whole or after each change.

mod by_sorting;

use std::collections::BTreeSet;

use by_sorting::{flooded, sites_by_sorting};
use proptest::prelude::*;
use wisdom_goals::{Extraction, MergeTree, PrizeScale, Site, prize_map, sites};
use wisdom_grid::{Cell, GridSpec, Raster};

/// A prize map drawn with digits, tenths of the prize.
fn picture(rows: &[&str]) -> Raster<f32> {
    let spec = GridSpec::new(rows.len(), rows[0].len(), 1.0).expect("the sides of a test");
    Raster::from_fn(spec, |c| f32::from(rows[c.row].as_bytes()[c.col] - b'0') / 10.0)
}

fn near(min_separation_m: f64) -> Extraction {
    Extraction { min_separation_m, ..Extraction::default() }
}

/// Every maximum of at least this prominence.
fn all(min_prominence: f64) -> Extraction {
    let max_sites = usize::MAX;
    Extraction { min_prominence, min_separation_m: 0.0, percentile_floor: None, max_sites }
}

/// A map to try: few or many levels, smooth or rough, with holes.
#[derive(Debug, Clone, Copy)]
struct Sketch {
    rows: usize,
    cols: usize,
    levels: u32,
    /// Cells over which heights are averaged, along rows and columns.
    blur: usize,
    /// Share of cells, in eighths, that are no ground.
    holes: u64,
    seed: u64,
}

impl Sketch {
    fn up_to(side: usize) -> impl Strategy<Value = Self> {
        let levels = prop_oneof![1u32..4, 4u32..40, Just(1 << 20)];
        (1..=side, 1..=side, levels, 1usize..6, 0u64..6, any::<u64>()).prop_map(
            |(rows, cols, levels, blur, holes, seed)| Self {
                rows,
                cols,
                levels,
                blur,
                holes,
                seed,
            },
        )
    }

    /// A fixed hash of a cell and a purpose.
    fn draw(self, row: usize, col: usize, purpose: u64) -> u64 {
        let at = (row as u64) << 32 | (col as u64) << 8 | purpose;
        let mixed = (at ^ self.seed).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB) >> 33
    }

    fn height(self, cell: Cell) -> f32 {
        if self.draw(cell.row / self.blur, cell.col / self.blur, 1) % 8 < self.holes {
            return 0.0;
        }
        let part = |r: usize, c: usize| self.draw(cell.row + r, cell.col + c, 0) as f64;
        let near = (0..self.blur).flat_map(|r| (0..self.blur).map(move |c| (r, c)));
        let mean = near.map(|(r, c)| part(r, c)).sum::<f64>()
            / (self.blur.pow(2) as f64 * f64::from(1u32 << 31));
        let levels = f64::from(self.levels);
        ((mean * levels).floor() / levels) as f32
    }

    fn map(self) -> Raster<f32> {
        let spec = GridSpec::new(self.rows, self.cols, 1.0).expect("the sides of a test");
        Raster::from_fn(spec, |cell| self.height(cell))
    }
}

fn extractions() -> impl Strategy<Value = Extraction> {
    let prominence = prop_oneof![Just(f64::MIN_POSITIVE), Just(0.1), Just(0.25), 0.001..1.0];
    let floor = proptest::option::of(0.0..100.0);
    (prominence, 0.0..12.0, floor, prop_oneof![Just(100), 0usize..9]).prop_map(
        |(min_prominence, min_separation_m, percentile_floor, max_sites)| Extraction {
            min_prominence,
            min_separation_m,
            percentile_floor,
            max_sites,
        },
    )
}

/// Heights of `side`² cells, all different, in an order drawn by the strategy.
fn distinct(side: usize) -> impl Strategy<Value = Raster<f32>> {
    let ranks: Vec<u16> = (0..(side * side) as u16).collect();
    Just(ranks).prop_shuffle().prop_map(move |ranks| {
        let spec = GridSpec::new(side, side, 1.0).expect("the sides of a test");
        let highest = (side * side) as f32;
        Raster::from_vec(spec, ranks.iter().map(|r| f32::from(*r) / highest).collect())
            .expect("a value a cell")
    })
}

/// Maps of 7 × 7 cells and at most five heights, 0 among them: all plateaus and holes.
fn tied() -> impl Strategy<Value = Raster<f32>> {
    proptest::collection::vec(0u8..5, 49).prop_map(|heights| {
        let spec = GridSpec::new(7, 7, 1.0).expect("the sides of a test");
        Raster::from_vec(spec, heights.iter().map(|h| f32::from(*h)).collect())
            .expect("a value a cell")
    })
}

/// The plateaus that nothing beside them is higher than: height and first cell, the highest and first in front.
fn summits(map: &Raster<f32>) -> Vec<(f32, Cell)> {
    let mut summits: Vec<(f32, Cell)> = Vec::new();
    for start in map.spec().cells().filter(|&c| map[c] > 0.0) {
        let joined = flooded(map, start, f64::from(map[start]));
        if joined[0] == start && joined.iter().all(|&c| map[c] == map[start]) {
            summits.push((map[start], start));
        }
    }
    summits.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    summits
}

/// Height and prominence of every summit, by definition: the drop that a walk to a higher summit, or to an equal one
/// that comes first, cannot avoid; the whole height where there is no way.
fn prominences_by_flooding(map: &Raster<f32>) -> Vec<(f64, f64)> {
    let mut levels: Vec<f32> = map.values().iter().copied().filter(|v| *v > 0.0).collect();
    levels.sort_unstable_by(|a, b| b.total_cmp(a));
    let summits = summits(map);
    let drop = |rank: usize| {
        let (top, start) = summits[rank];
        let met = levels.iter().filter(|l| **l <= top).find(|level| {
            let joined = flooded(map, start, f64::from(**level));
            summits[..rank].iter().any(|(_, higher)| joined.contains(higher))
        });
        (f64::from(top), f64::from(top) - met.map_or(0.0, |l| f64::from(*l)))
    };
    (0..summits.len()).map(drop).collect()
}

/// What does not hang on which of a plateau's cells stands for it, in order.
fn heights(found: &[Site]) -> Vec<(f64, f64)> {
    let mut heights: Vec<_> = found.iter().map(|s| (s.prize, s.prominence)).collect();
    heights.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    heights
}

#[test]
fn prominence_is_the_height_above_the_saddle() {
    let tenths = |map: &Raster<f32>| -> Vec<_> {
        let found = sites(map, &near(1.0));
        found.iter().map(|s| (s.peak.col, (s.prominence * 10.0).round())).collect()
    };
    assert_eq!(tenths(&picture(&["00000000", "09440700", "00000000"])), [(1, 9.0), (5, 7.0)]);
    assert_eq!(tenths(&picture(&["00000000", "09447000", "00000000"])), [(1, 9.0), (4, 3.0)]);
}

#[test]
fn a_plateau_is_one_site_in_its_middle() {
    let map = picture(&["00000", "08880", "08880", "08880", "00000"]);
    let found = sites(&map, &near(1.0));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].peak, Cell::new(2, 2));
    assert_eq!(found[0].region.len(), 9);
}

#[test]
fn a_plateau_across_tiles_is_one_site() {
    let spec = GridSpec::new(200, 200, 1.0).unwrap();
    let ring = |c: Cell| (90.0..95.0).contains(&c.distance(Cell::new(99, 99)));
    let found = sites(&Raster::from_fn(spec, |c| f32::from(u8::from(ring(c)))), &all(0.1));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].prominence, 1.0);
    assert_eq!(found[0].region, spec.cells().filter(|&c| ring(c)).collect::<Vec<_>>());
}

#[test]
fn a_map_without_a_prize_has_no_sites() {
    let spec = GridSpec::new(70, 3, 1.0).unwrap();
    let floor = Extraction { percentile_floor: Some(50.0), ..all(0.1) };
    assert_eq!(sites(&Raster::filled(spec, 0.0), &floor), []);
}

#[test]
fn with_no_least_prominence_every_maximum_counts_and_nothing_else() {
    let map = picture(&["0565", "0555", "0505", "4441"]);
    let found = sites(&map, &all(0.0));
    assert_eq!(found.iter().map(|s| s.peak).collect::<Vec<_>>(), [Cell::new(0, 2)]);
    assert_eq!(found, sites(&map, &all(f64::MIN_POSITIVE)));
}

#[test]
fn of_two_near_maxima_the_better_stays() {
    let map = picture(&["080900"]);
    assert_eq!(sites(&map, &near(1.0)).len(), 2);
    let far = sites(&map, &near(5.0));
    assert_eq!(far.iter().map(|s| s.peak.col).collect::<Vec<_>>(), [3]);
}

#[test]
fn the_percentile_floor_cuts_small_peaks() {
    let map = picture(&["0204080"]);
    let floor = Extraction { percentile_floor: Some(60.0), ..near(1.0) };
    assert_eq!(sites(&map, &near(1.0)).len(), 3);
    assert_eq!(sites(&map, &floor).iter().map(|s| s.peak.col).collect::<Vec<_>>(), [5, 3]);
}

#[test]
fn sites_of_a_part_carry_the_numbers_of_the_whole() {
    let first = Cell::new(1000, 300);
    let part = picture(&["0000", "0090", "0000"]).numbered_from(first);
    assert_eq!(sites(&part, &near(1.0))[0].peak, Cell::new(1001, 302));
    assert_eq!(MergeTree::new(&part).sites(&part, &near(1.0)), sites(&part, &near(1.0)));
}

#[test]
fn only_tiles_with_a_changed_cell_in_or_beside_them_are_redone() {
    let spec = GridSpec::new(200, 130, 1.0).unwrap();
    let mut map = Raster::filled(spec, 0.5);
    let mut tree = MergeTree::new(&map);
    assert_eq!(tree.update(&map), 0);
    // Tiles are 64 cells wide: inside one, at a side, at a corner, at the corner of the map.
    for (cell, tiles) in [((30, 30), 1), ((30, 63), 2), ((64, 64), 4), ((199, 128), 2), ((0, 0), 1)]
    {
        map[Cell::new(cell.0, cell.1)] = 0.75;
        assert_eq!(tree.update(&map), tiles, "{cell:?}");
        assert_eq!(tree.sites(&map, &all(0.1)), sites(&map, &all(0.1)), "{cell:?}");
    }
    assert_eq!(tree.update(&Raster::filled(GridSpec::new(65, 64, 1.0).unwrap(), 0.5)), 2);
}

#[test]
#[should_panic(expected = "same sides")]
fn a_tree_refuses_prizes_of_another_map() {
    let map = picture(&["0900"]);
    let _ = MergeTree::new(&map).sites(&picture(&["090"]), &near(1.0));
}

/// Different interests above the background have different prizes: the tree of the one serves for the other.
#[test]
fn contrast_keeps_neighbouring_numbers_apart() {
    for exponent in 0..40 {
        for share in [1.0, 1.25, 1.5, 1.999_999_9] {
            let background = 0.5 * share * 0.5f32.powi(exponent);
            for start in [0.01f32, 0.25, 0.499_99, 0.5, 0.75, 0.999_99] {
                let ladder = (0..400).map(|k| f32::from_bits(start.max(background).to_bits() + k));
                let above: Vec<f32> = ladder.filter(|v| *v > background && *v <= 1.0).collect();
                let mut interest = vec![background; above.len() + 1];
                interest.extend(&above);
                let spec = GridSpec::new(1, interest.len(), 1.0).unwrap();
                let interest = Raster::from_vec(spec, interest).unwrap();
                let map = prize_map(&interest, &Raster::filled(spec, 0.0), PrizeScale::Contrast);
                assert!(above.is_empty() || map.background == f64::from(background));
                let prizes = &map.prize.values()[interest.values().len() - above.len()..];
                assert!(prizes.is_sorted_by(|a, b| a < b), "{background} {start}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Tile by tile or cell by cell: the same sites to the bit.
    #[test]
    fn sites_are_those_of_sorting_all_cells(sketch in Sketch::up_to(150), wanted in extractions()) {
        let map = sketch.map();
        prop_assert_eq!(sites(&map, &wanted), sites_by_sorting(&map, &wanted));
    }

    /// However the map changes, the tree follows to the bit.
    #[test]
    fn a_tree_that_follows_changes_is_one_made_anew(
        sketch in Sketch::up_to(200),
        changes in proptest::collection::vec((Sketch::up_to(80), 0usize..200, 0usize..200), 1..5),
        wanted in extractions(),
    ) {
        let mut map = sketch.map();
        let mut tree = MergeTree::new(&map);
        for (patch, row, col) in changes {
            for cell in patch.map().spec().cells() {
                let to = Cell::new(cell.row + row, cell.col + col);
                if map.spec().contains(to) {
                    map[to] = patch.height(cell);
                }
            }
            tree.update(&map);
            prop_assert_eq!(tree.sites(&map, &wanted), sites_by_sorting(&map, &wanted));
        }
    }

    /// One tree of the interest serves for every prize that only rescales it, wherever the background lies.
    #[test]
    fn the_tree_of_the_interest_gives_the_sites_of_the_prize(
        sketch in Sketch::up_to(150),
        unseen in 0u64..8,
        wanted in extractions(),
    ) {
        let interest = sketch.map();
        let ignorance = Raster::from_fn(interest.spec(), |c| {
            f32::from(u8::from(sketch.draw(c.row, c.col, 2) % 8 < unseen))
        });
        let tree = MergeTree::new(&interest);
        for scale in [PrizeScale::Belief, PrizeScale::Contrast] {
            let prize = prize_map(&interest, &ignorance, scale).prize;
            prop_assert_eq!(tree.sites(&prize, &wanted), sites(&prize, &wanted));
        }
    }

    /// On plateaus and round holes too, sites are the summits whose prominence, by definition, is large enough.
    #[test]
    fn sites_are_the_summits_that_flooding_finds(map in tied(), least in 0.5f64..5.0) {
        let mut wanted = prominences_by_flooding(&map);
        wanted.retain(|(_, prominence)| *prominence >= least);
        wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        prop_assert_eq!(heights(&sites(&map, &all(least))), wanted);
    }

    /// The highest peak of an island stands on it with its whole height, and nothing else does.
    #[test]
    fn each_island_has_one_peak_of_its_whole_height(map in tied()) {
        let found = sites(&map, &all(0.5));
        let mut left: BTreeSet<Cell> = map.spec().cells().filter(|&c| map[c] > 0.0).collect();
        let mut islands = 0;
        while let Some(start) = left.pop_first() {
            islands += 1;
            let island = flooded(&map, start, 0.0);
            left.retain(|c| !island.contains(c));
            let top = island.iter().map(|&c| map[c]).fold(0.0, f32::max);
            let whole: Vec<_> = found
                .iter()
                .filter(|s| s.prominence == s.prize && island.contains(&s.peak))
                .collect();
            prop_assert_eq!(whole.len(), 1);
            prop_assert_eq!(whole[0].prize, f64::from(top));
        }
        prop_assert_eq!(found.iter().filter(|s| s.prominence == s.prize).count(), islands);
    }

    /// Peaks hang on the order of the heights only: squared, they and their saddles stay where they are.
    #[test]
    fn a_rising_map_of_the_heights_keeps_peaks_and_saddles(map in tied()) {
        let found = sites(&map, &all(0.5));
        let squared = sites(&map.map(|h| h * h), &all(0.5));
        let cells = |of: &[Site]| of.iter().map(|s| (s.peak, s.region.clone())).collect::<Vec<_>>();
        prop_assert_eq!(cells(&found), cells(&squared));
        for (plain, squared) in found.iter().zip(&squared) {
            let saddle = plain.prize - plain.prominence;
            prop_assert_eq!(squared.prominence, squared.prize - saddle * saddle);
        }
    }

    /// Nothing hangs on which way the map lies, unless heights are equal.
    #[test]
    fn a_turned_map_has_turned_sites(map in distinct(9), separation in 0.0f64..4.0) {
        let wanted = Extraction { min_separation_m: separation, ..all(0.05) };
        let found = sites(&map, &wanted);
        prop_assert!(!found.is_empty());
        let turns: [fn(Cell) -> Cell; 3] = [
            |c| Cell::new(c.row, 8 - c.col),
            |c| Cell::new(8 - c.row, c.col),
            |c| Cell::new(c.col, c.row),
        ];
        for turn in turns {
            // Each turn is its own inverse.
            let turned = Raster::from_fn(map.spec(), |c| map[turn(c)]);
            let back = sites(&turned, &wanted).into_iter().map(|mut site| {
                site.peak = turn(site.peak);
                site.region = site.region.into_iter().map(turn).collect();
                site.region.sort_unstable();
                site
            });
            prop_assert_eq!(back.collect::<Vec<_>>(), found.clone());
        }
    }

    /// A higher bar lets through some of the same sites, and no others.
    #[test]
    fn raising_the_least_prominence_only_removes_sites(
        map in distinct(9),
        low in 0.01f64..1.0,
        high in 0.01f64..1.0,
    ) {
        let (low, high) = (low.min(high), low.max(high));
        let told = |least| {
            let found = sites(&map, &all(least));
            found.into_iter().map(|s| (s.peak, s.prominence)).collect::<Vec<_>>()
        };
        let mut kept = told(low);
        kept.retain(|(_, prominence)| *prominence >= high);
        prop_assert_eq!(told(high), kept);
    }

    /// No two sites are nearer than asked, and each maximum left out has a better site near it.
    #[test]
    fn separation_is_kept_and_costs_no_more_than_it_must(
        sketch in Sketch::up_to(60),
        separation in 0.0f64..10.0,
    ) {
        let map = sketch.map();
        let kept = sites(&map, &Extraction { min_separation_m: separation, ..all(0.1) });
        for (i, site) in kept.iter().enumerate() {
            prop_assert!(kept[..i].iter().all(|s| s.peak.distance(site.peak) >= separation));
        }
        for site in sites(&map, &all(0.1)) {
            let crowded = |s: &Site| s.prize >= site.prize && s.peak.distance(site.peak) < separation;
            prop_assert!(kept.contains(&site) || kept.iter().any(crowded), "{}", site.peak);
        }
    }

    /// A site's region is joined to its peak, on ground as good, and nobody else's.
    #[test]
    fn regions_hold_their_peak_and_never_overlap(sketch in Sketch::up_to(60)) {
        let map = sketch.map();
        let mut taken = BTreeSet::new();
        for site in sites(&map, &all(0.1)) {
            prop_assert!(site.region.contains(&site.peak));
            prop_assert_eq!(&site.region, &flooded(&map, site.peak, site.prize - 0.05));
            prop_assert!(site.region.iter().all(|c| taken.insert(*c)));
        }
    }
}
