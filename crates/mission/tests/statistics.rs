//! Statistics of campaigns: published values, laws, and how often the tests and intervals are right.

use proptest::prelude::*;
use wisdom_mission::statistics::{
    Brier, Calibration, Forecast, Interval, chi_square_survival, mean_interval, normal_two_sided,
    paired_difference, wilson,
};
use wisdom_terrain::{normal_noise, unit_noise};

fn near(found: f64, wanted: f64, within: f64) {
    assert!((found - wanted).abs() <= within, "{found}; wanted {wanted} within {within}");
}

/// `happened` forecasts of a probability that came true, and `not` that did not.
fn of_one(predicted: f64, happened: usize, not: usize) -> Vec<Forecast> {
    (0..happened + not).map(|i| Forecast { predicted, happened: i < happened }).collect()
}

/// Forecasts uniform in [low, 1], which come true with the chance stated to the power `hazard`: as legs do
/// whose hazard rate is that many times the one believed.
fn simulated(seed: u64, count: u64, low: f64, hazard: f64) -> Vec<Forecast> {
    (0..count)
        .map(|i| {
            let predicted = low + (1.0 - low) * unit_noise(&[seed, 1, i]);
            Forecast { predicted, happened: unit_noise(&[seed, 2, i]) < predicted.powf(hazard) }
        })
        .collect()
}

/// Largest distance of the values' distribution from the uniform one (Kolmogorov).
fn off_uniform(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len() as f64;
    let steps = values.iter().enumerate();
    steps.fold(0.0, |most: f64, (i, value)| {
        most.max((value - i as f64 / count).abs()).max((value - (i + 1) as f64 / count).abs())
    })
}

#[test]
fn chi_square_tails_are_those_of_the_printed_table() {
    // Percentage points, Abramowitz and Stegun (1964), table 26.8.
    for (tail, degrees, point) in [
        (0.05, 1, 3.84146),
        (0.05, 2, 5.99147),
        (0.05, 3, 7.81473),
        (0.05, 10, 18.3070),
        (0.05, 30, 43.7729),
        (0.05, 100, 124.342),
        (0.01, 1, 6.63490),
        (0.01, 10, 23.2093),
        (0.01, 9, 21.6660),
        (0.001, 10, 29.588),
        (0.5, 10, 9.34182),
        (0.995, 10, 2.15585),
        (0.995, 99, 66.5101),
    ] {
        near(chi_square_survival(point, degrees), tail, 2e-5 * tail.max(0.05));
    }
}

#[test]
fn chi_square_tails_hold_far_out() {
    // Two degrees of freedom: e^(−x/2).
    near(chi_square_survival(1400.0, 2) / (-700.0f64).exp(), 1.0, 1e-12);
    assert_eq!(chi_square_survival(5000.0, 10), 0.0);
    assert_eq!(chi_square_survival(0.0, 3), 1.0);
    assert_eq!(chi_square_survival(1.0, 0), 0.0);
    // About the mean of many degrees of freedom, a half.
    near(chi_square_survival(2000.0, 2000), 0.5, 0.01);
}

#[test]
fn normal_tails_are_the_usual_ones() {
    near(normal_two_sided(1.959_964), 0.05, 1e-7);
    near(normal_two_sided(-2.575_829), 0.01, 1e-7);
    assert_eq!(normal_two_sided(0.0), 1.0);
}

#[test]
fn wilson_intervals_are_those_of_newcombe() {
    // Newcombe (1998), table I, method 3.
    for (happened, count, low, high) in [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ] {
        let found = wilson(happened, count).expect("there is something to count");
        near(found.low, low, 5e-5);
        near(found.high, high, 5e-5);
        near(found.mean, happened as f64 / count as f64, 1e-15);
    }
    assert_eq!(wilson(7, 7).expect("seven").high, 1.0);
    assert_eq!(wilson(0, 0), None);
}

/// Brier's own measure halves: his sums over both classes of an event count each error twice.
#[test]
fn brier_score_and_its_parts_come_out_as_by_hand() {
    // Ten at 0.8, of which 6 happened; ten at 0.2, of which 3 happened.
    let forecasts = [of_one(0.8, 6, 4), of_one(0.2, 3, 7)].concat();
    let brier = Calibration::of(&forecasts, 2).expect("forecasts").brier;
    near(brier.score, (6.0 * 0.04 + 4.0 * 0.64 + 3.0 * 0.64 + 7.0 * 0.04) / 20.0, 1e-15);
    near(brier.expected, 0.16, 1e-15);
    near(brier.reliability, 0.5 * (0.04 + 0.01), 1e-15);
    near(brier.resolution, 0.15 * 0.15, 1e-15);
    near(brier.uncertainty, 0.45 * 0.55, 1e-15);
    near(brier.within, 0.0, 1e-15);
}

#[test]
fn hosmer_lemeshow_comes_out_as_by_hand() {
    // (14 − 10)²/5 + (10 − 10)²/7.5 = 3.2, with two degrees of freedom: p = e^(−1.6).
    let forecasts = [of_one(0.5, 14, 6), of_one(0.25, 10, 30)].concat();
    let calibration = Calibration::of(&forecasts, 2).expect("forecasts");
    let test = calibration.hosmer_lemeshow.expect("enough is expected");
    near(test.statistic, 3.2, 1e-12);
    assert_eq!(test.degrees_of_freedom, 2);
    near(test.p, (-1.6f64).exp(), 1e-12);
}

#[test]
fn spiegelhalters_z_comes_out_as_by_hand() {
    // (7 − 8)(1 − 1.6) / √(10 · 0.36 · 0.16) = 0.6 / 0.7589.
    let calibration = Calibration::of(&of_one(0.8, 7, 3), 1).expect("forecasts");
    let test = calibration.spiegelhalter.expect("the score can vary");
    near(test.z, 0.6 / 0.576f64.sqrt(), 1e-12);
    near(test.p, normal_two_sided(test.z), 0.0);
    // At one half, the score is a quarter whatever happens.
    assert_eq!(Calibration::of(&of_one(0.5, 7, 3), 1).expect("forecasts").spiegelhalter, None);
}

#[test]
fn groups_that_expect_too_few_failures_are_joined() {
    // Expected failures from the lowest bin up: 10, 4, 2, 1. The second needs the third; the last joins them.
    let forecasts =
        [of_one(0.5, 10, 10), of_one(0.8, 16, 4), of_one(0.9, 18, 2), of_one(0.95, 19, 1)].concat();
    let calibration = Calibration::of(&forecasts, 4).expect("forecasts");
    assert_eq!(calibration.bins.len(), 4);
    let test = calibration.hosmer_lemeshow.expect("enough is expected");
    assert_eq!(test.degrees_of_freedom, 2);
    near(test.statistic, 0.0, 1e-12);
    // Fewer than five failures expected in all: no test.
    assert_eq!(Calibration::of(&of_one(0.95, 76, 4), 4).expect("forecasts").hosmer_lemeshow, None);
}

#[test]
fn equal_forecasts_share_a_bin() {
    let counts = |forecasts: &[Forecast], bins| {
        let calibration = Calibration::of(forecasts, bins).expect("forecasts");
        calibration.bins.iter().map(|bin| bin.count).collect::<Vec<_>>()
    };
    let apart: Vec<Forecast> = (0..10)
        .map(|i| Forecast { predicted: f64::from(i) / 10.0, happened: i % 2 == 0 })
        .collect();
    assert_eq!(counts(&apart, 4), [2, 3, 2, 3]);
    // Of 3, 4 and 3 equal ones, the cut at 5 goes to the run's lower end, both being two away.
    let runs = [of_one(0.1, 1, 2), of_one(0.5, 2, 2), of_one(0.9, 2, 1)].concat();
    assert_eq!(counts(&runs, 2), [3, 7]);
    assert_eq!(counts(&runs, 10), [3, 4, 3]);
    assert_eq!(counts(&of_one(0.7, 50, 20), 10), [70]);
}

#[test]
fn what_is_no_forecast_has_no_calibration() {
    assert_eq!(Calibration::of(&[], 10), None);
    assert_eq!(Calibration::of(&of_one(0.5, 1, 1), 0), None);
    assert_eq!(Calibration::of(&of_one(f64::NAN, 1, 1), 2), None);
    assert_eq!(Calibration::of(&of_one(1.01, 1, 1), 2), None);
}

/// True forecasts: the p-values of both tests are uniform.
#[test]
fn true_forecasts_are_rejected_as_often_as_the_level_says() {
    let sets = 400;
    let (mut grouped, mut ungrouped, mut excess) = (Vec::new(), Vec::new(), 0.0);
    for seed in 0..sets {
        let calibration = Calibration::of(&simulated(seed, 1000, 0.5, 1.0), 10).expect("forecasts");
        grouped.push(calibration.hosmer_lemeshow.expect("enough is expected").p);
        ungrouped.push(calibration.spiegelhalter.expect("the score varies").p);
        excess += calibration.brier.score - calibration.brier.expected;
    }
    for p in [grouped, ungrouped] {
        // 5 % of 400 are 20, with a standard deviation of 4.4; four of them either way.
        let rejected = p.iter().filter(|p| **p < 0.05).count();
        assert!((3..=37).contains(&rejected), "{rejected}");
        // Kolmogorov's distance of 400 uniform values exceeds 1.95/√400 in one case of a thousand.
        let off = off_uniform(p);
        assert!(off < 1.95 / 20.0, "{off}");
    }
    // One score's standard deviation is about √(E (1 − 2p)² p(1 − p) / 1000) = 0.0070, the mean's a twentieth of it.
    near(excess / sets as f64, 0.0, 4.0 * 0.0070 / 20.0);
}

/// A truth half again as hazardous as believed costs 0.1 of a reliability of 0.75, 13 standard deviations over 3000 legs.
#[test]
fn a_hazard_half_again_as_large_is_detected_in_3000_legs() {
    for seed in 0..20 {
        let calibration = Calibration::of(&simulated(seed, 3000, 0.5, 1.5), 10).expect("forecasts");
        assert!(calibration.hosmer_lemeshow.expect("enough is expected").p < 1e-6);
        let test = calibration.spiegelhalter.expect("the score varies");
        // Forecasts above one half that promise too much: z is positive.
        assert!(test.z > 4.0 && test.p < 1e-4, "{test:?}");
        assert!(calibration.brier.score > calibration.brier.expected);
    }
}

#[test]
fn bootstrap_intervals_cover_the_true_mean_in_about_95_percent() {
    let (sets, count) = (400u64, 50);
    let covered = (0..sets)
        .filter(|&set| {
            let values: Vec<f64> = (0..count).map(|i| 3.0 + normal_noise(&[set, 11, i])).collect();
            let found = mean_interval(&values, 500, set).expect("values");
            found.low <= 3.0 && 3.0 <= found.high
        })
        .count();
    // For 50 values about 94 % are expected, with a standard deviation of 1.2 %: four of them either way.
    let share = covered as f64 / sets as f64;
    assert!((0.89..=0.985).contains(&share), "{share}");
}

#[test]
fn bootstrap_interval_of_many_values_is_the_normal_one() {
    let values: Vec<f64> = (0..2000).map(|i| normal_noise(&[5, i])).collect();
    let found = mean_interval(&values, 4000, 1).expect("values");
    let mean = values.iter().sum::<f64>() / 2000.0;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 2000.0;
    let reach = 1.96 * (variance / 2000.0).sqrt();
    near(found.mean, mean, 1e-15);
    // An end's standard deviation, of 4000 resamples, is 2.1 % of the reach; five of them.
    near(found.low, mean - reach, 0.11 * reach);
    near(found.high, mean + reach, 0.11 * reach);
}

#[test]
fn pairs_take_out_what_their_worlds_have_in_common() {
    let world = |i| 10.0 * normal_noise(&[1, i]);
    let a: Vec<f64> = (0..100).map(|i| world(i) + 1.0 + 0.1 * normal_noise(&[2, i])).collect();
    let b: Vec<f64> = (0..100).map(|i| world(i) + 0.1 * normal_noise(&[3, i])).collect();
    let paired = paired_difference(&a, &b, 1000, 9).expect("pairs");
    assert!(paired.low > 0.9 && paired.high < 1.1, "{paired:?}");
    let alone = mean_interval(&a, 1000, 9).expect("values");
    assert!(alone.high - alone.low > 20.0 * (paired.high - paired.low));
    let turned = paired_difference(&b, &a, 1000, 9).expect("pairs");
    near(turned.mean, -paired.mean, 1e-15);
}

#[test]
fn an_interval_has_the_same_bits_at_any_thread_count() {
    let values: Vec<f64> = (0..123).map(|i| normal_noise(&[4, i])).collect();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| mean_interval(&values, 777, 3))
    };
    assert_eq!(on(1), on(4));
    assert_ne!(mean_interval(&values, 777, 3), mean_interval(&values, 777, 4));
}

#[test]
fn too_few_values_say_so() {
    assert_eq!(mean_interval(&[], 100, 1), None);
    assert_eq!(mean_interval(&[1.0], 0, 1), None);
    assert_eq!(mean_interval(&[1.0, f64::NAN], 100, 1), None);
    let point = Interval { mean: 2.5, low: 2.5, high: 2.5 };
    assert_eq!(mean_interval(&[2.5], 100, 1), Some(point));
    assert_eq!(paired_difference(&[3.5], &[1.0], 1, 1), Some(point));
}

fn any_forecasts() -> impl Strategy<Value = Vec<Forecast>> {
    let one = (prop_oneof![0.0..=1.0, Just(0.25), Just(1.0)], any::<bool>())
        .prop_map(|(predicted, happened)| Forecast { predicted, happened });
    prop::collection::vec(one, 1..200)
}

proptest! {
    /// The parts of the score make it up, whatever the bins.
    #[test]
    fn the_parts_of_a_brier_score_add_up(forecasts in any_forecasts(), bins in 1usize..20) {
        let Brier { score, reliability, resolution, uncertainty, within, .. } =
            Calibration::of(&forecasts, bins).expect("forecasts").brier;
        prop_assert!((reliability - resolution + uncertainty + within - score).abs() < 1e-12);
    }

    /// Every forecast is in one bin, bins do not overlap, and the order of the forecasts does not matter.
    #[test]
    fn bins_part_the_forecasts(forecasts in any_forecasts(), bins in 1usize..20) {
        let found = Calibration::of(&forecasts, bins).expect("forecasts");
        prop_assert!(found.bins.len() <= bins);
        prop_assert_eq!(found.bins.iter().map(|bin| bin.count).sum::<usize>(), forecasts.len());
        prop_assert!(found.bins.windows(2).all(|pair| pair[0].high < pair[1].low));
        for bin in &found.bins {
            prop_assert!(bin.observed.low <= bin.observed.mean && bin.observed.mean <= bin.observed.high);
            prop_assert!(bin.low <= bin.mean_predicted + 1e-12 && bin.mean_predicted <= bin.high + 1e-12);
        }
        let turned: Vec<Forecast> = forecasts.iter().rev().copied().collect();
        prop_assert_eq!(Calibration::of(&turned, bins), Some(found));
    }
}
