//! Cost of combining three sources on a general frame, all at once, in a workspace that is used again.
//!
//! Bodies have random focal elements with one on Θ; the seed is fixed, so that every run does the same work.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use wisdom_belief::{Element, Frame, MassFunction, Rule, rule::Workspace};

/// xorshift64 (Marsaglia 2003): enough to pick focal elements.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n
    }
}

/// A union of one to three intersections of one to three atoms; under exclusive atoms, of one to three atoms.
fn element(frame: &Frame, random: &mut Random) -> Element {
    let n = frame.atoms().len();
    let width = if frame.is_free() { 3 } else { 1 };
    (0..=random.below(3)).fold(Element::EMPTY, |union, _| {
        let term = (0..=random.below(width))
            .fold(frame.theta(), |meet, _| meet & frame.atom(random.below(n)).expect("an atom"));
        union | term
    })
}

/// Three sources with as many focal elements each, one of them Θ.
fn sources(frame: &Frame, focal: usize) -> Vec<MassFunction> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut source = || {
        let mut elements = vec![frame.theta()];
        while elements.len() < focal {
            let next = element(frame, &mut random);
            if !elements.contains(&next) {
                elements.push(next);
            }
        }
        let weights: Vec<f64> = elements.iter().map(|_| 1.0 + random.below(99) as f64).collect();
        let sum: f64 = weights.iter().sum();
        let masses = elements.into_iter().zip(weights.into_iter().map(|weight| weight / sum));
        MassFunction::new(frame, masses).expect("they sum to 1")
    };
    (0..3).map(|_| source()).collect()
}

fn names(n: usize) -> Vec<String> {
    (0..n).map(|atom| format!("x{atom}")).collect()
}

fn combine(c: &mut Criterion) {
    let free = |n| Frame::free(names(n)).expect("a frame");
    let shafer = |n| Frame::shafer(names(n)).expect("a frame");
    let cases = [
        (Rule::Dsmc, free(4), 4),
        (Rule::Dsmc, free(6), 8),
        (Rule::Dempster, shafer(6), 8),
        (Rule::Pcr6, shafer(6), 4),
        (Rule::Pcr6, shafer(6), 8),
        (Rule::Pcr5, shafer(6), 8),
        (Rule::DuboisPrade, shafer(6), 8),
    ];
    let mut group = c.benchmark_group("three_sources");
    for (rule, frame, focal) in cases {
        let sources = sources(&frame, focal);
        let mut workspace = Workspace::new();
        let found = workspace.combine(rule, &sources, &frame).expect("no total conflict");
        let shape =
            format!("{} atoms, {focal} focal, {} out", frame.atoms().len(), found.focal().len());
        group.bench_function(BenchmarkId::new(rule.name(), shape), |bench| {
            bench.iter(|| {
                let fused = workspace.combine(rule, black_box(&sources), &frame);
                black_box(fused.expect("no total conflict").focal().len())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, combine);
criterion_main!(benches);
