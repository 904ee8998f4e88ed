//! No result depends on the instructions.

use fearless_simd::Level;

use super::fuse::fuse_by;
use super::number::Instructions;
use super::{MapNumber, Outputs, Planes, Source, Table};
use crate::{Opinion, ParadoxPolicy, Rule, Settings};

/// More than two of the widest registers, and some left over.
const CELLS: usize = 39;

/// Every instruction set of this machine.
fn instruction_sets() -> Vec<Instructions> {
    let widest = Level::new();
    #[cfg(target_arch = "x86_64")]
    let levels = {
        use fearless_simd::Simd;
        [
            Some(widest),
            widest.as_avx2().map(Simd::level),
            widest.as_sse4_2().map(Simd::level),
            widest.as_sse2().map(Simd::level),
        ]
    };
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(widest)];
    levels.into_iter().flatten().map(|level| Instructions(Some(level))).collect()
}

/// Whole weights by a fixed congruence, zeros among them.
fn planes<F: MapNumber>(source: usize) -> [Vec<F>; 3] {
    let mut state = source as u32 * 7919 + 17;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) % 8
    };
    let mut planes = [const { Vec::new() }; 3];
    for _ in 0..CELLS {
        let weights = [next(), next(), next(), next() + 1];
        let sum = f64::from(weights.iter().sum::<u32>());
        for (plane, weight) in planes.iter_mut().zip(weights) {
            plane.push(F::from_f64(f64::from(weight) / sum));
        }
    }
    planes
}

/// All outputs, one after the other.
fn fused<F: MapNumber>(
    instructions: Instructions,
    rule: Rule,
    policy: ParadoxPolicy,
    sources: &[Source<'_, F>],
) -> Vec<F> {
    let mut all = vec![F::zero(); 7 * CELLS];
    let mut parts = all.chunks_exact_mut(CELLS);
    let mut part = || parts.next();
    let outputs = Outputs {
        belief: part(),
        interesting: part(),
        not_interesting: part(),
        ignorance: part(),
        paradox: part(),
        conflict: part(),
        pignistic: part(),
    };
    fuse_by(instructions, rule, sources, policy, &Settings::default(), outputs).expect("a map");
    all
}

fn assert_same_bits<F: MapNumber>(rule: Rule, policy: ParadoxPolicy, sources: &[Source<'_, F>]) {
    let one_by_one = fused(Instructions(None), rule, policy, sources);
    for instructions in instruction_sets() {
        let wide = fused(instructions, rule, policy, sources);
        assert!(
            // In double precision all bits of either kind are seen.
            one_by_one.iter().zip(&wide).all(|(a, b)| a.to_f64().to_bits() == b.to_f64().to_bits()),
            "{rule} {policy}, {} sources",
            sources.len()
        );
    }
}

fn every_rule_has_the_same_bits<F: MapNumber>() {
    let masses: Vec<[Vec<F>; 3]> = (0..9).map(planes).collect();
    let sources: Vec<Source<'_, F>> = masses
        .iter()
        .map(|[i, n, p]| {
            Source::Planes(Planes { interesting: i, not_interesting: n, paradox: Some(p) })
        })
        .collect();
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        for policy in ParadoxPolicy::ALL.into_iter().filter(|&policy| rule.admits(policy)) {
            for count in [1, 2, 3, 4, 6, 9] {
                let sums = !matches!(rule, Rule::Pcr5 | Rule::Pcr5Plus | Rule::Pcr5Canonical);
                if count <= 6 || sums {
                    assert_same_bits(rule, policy, &sources[..count]);
                }
            }
        }
    }
}

#[test]
fn every_rule_has_the_same_bits_with_any_instructions_in_single_precision() {
    every_rule_has_the_same_bits::<f32>();
}

#[test]
fn every_rule_has_the_same_bits_with_any_instructions_in_double_precision() {
    every_rule_has_the_same_bits::<f64>();
}

fn look_ups_have_the_same_bits<F: MapNumber>() {
    let opinion =
        |interesting, not_interesting, paradox| Opinion { paradox, not_interesting, interesting };
    let table =
        Table::new(&[opinion(0.9, 0.05, 0.0), opinion(0.1, 0.3, 0.2), opinion(0.0, 0.7, 0.1)])
            .expect("three opinions");
    let rows: Vec<u8> = (0..CELLS).map(|cell| [0, 1, 2, 3, 15, 16, 255][cell % 7]).collect();
    let values: Vec<f32> =
        (0..CELLS).map(|cell| [f32::NAN, -1.0, 0.0, 0.5, 2.0, 7.0][cell % 6]).collect();
    let [u, ..] = planes::<F>(5);
    let sources = [
        Source::Classes { rows: &rows, table: &table, uncertainty: &u },
        Source::Readings { values: &values, bounds: &[0.0, 2.0], table: &table, uncertainty: &u },
    ];
    for rule in [Rule::Dsmc, Rule::Dempster, Rule::Pcr6] {
        assert_same_bits(rule, ParadoxPolicy::Split, &sources);
    }
}

#[test]
fn look_ups_have_the_same_bits_with_any_instructions() {
    look_ups_have_the_same_bits::<f32>();
    look_ups_have_the_same_bits::<f64>();
}
