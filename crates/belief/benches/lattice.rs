//! What it costs to walk over the elements of a frame and to transform masses on all of them: paid once a
//! frame, and once a mass function that is decomposed or decombined.

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use wisdom_belief::{Frame, Lattice, MassFunction, Rule, rule};

const NAMES: [&str; 6] = ["A", "B", "C", "D", "E", "F"];

fn free(n: usize) -> Frame {
    Frame::free(NAMES.into_iter().take(n)).expect("a frame")
}

/// Goals: 50 µs for five atoms, 0.1 s for six.
fn elements(c: &mut Criterion) {
    let mut group = c.benchmark_group("elements");
    for (n, count) in (4..).zip([167, 7580, 7_828_353]) {
        let frame = free(n);
        group.throughput(Throughput::Elements(count)).sample_size(20);
        group.bench_with_input(BenchmarkId::new("free", n), &frame, |bench, frame| {
            bench.iter(|| {
                black_box(frame).elements().fold(0, |all, element| all ^ element.regions())
            });
        });
    }
    group.finish();
}

fn counts(c: &mut Criterion) {
    let mut group = c.benchmark_group("element_count");
    group.sample_size(10);
    for n in [5, 6, 7] {
        // The most there can be short of the free model: only the atoms all together are empty.
        let names = &["A", "B", "C", "D", "E", "F", "G"][..n];
        let frame = Frame::with_empty(names.to_vec(), &[&names.join(" & ")]).expect("a frame");
        group.bench_function(BenchmarkId::new("hybrid", n), |bench| {
            bench.iter(|| black_box(&frame).element_count());
        });
    }
    group.finish();
}

/// Goals: 1 µs on four free atoms, 60 µs on five.
fn transforms(c: &mut Criterion) {
    let mut group = c.benchmark_group("to_commonalities");
    let exclusive = |n: usize| Frame::shafer((0..n).map(|atom| format!("t{atom}")));
    let frames = [
        ("free/4", free(4)),
        ("free/5", free(5)),
        ("shafer/10", exclusive(10).expect("a frame")),
        ("shafer/20", exclusive(20).expect("a frame")),
    ];
    for (name, frame) in frames {
        let lattice = Lattice::new(&frame).expect("small enough");
        let masses = vec![1.0 / lattice.elements().len() as f64; lattice.elements().len()];
        group.bench_function(name, |bench| {
            bench.iter_batched_ref(
                || masses.clone(),
                |values| lattice.to_commonalities(black_box(values)),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
    c.bench_function("lattice/free/5", |bench| bench.iter(|| Lattice::new(black_box(&free(5)))));
}

/// Two sources of four focal elements each, on four free atoms.
fn cautious(c: &mut Criterion) {
    let frame = free(4);
    let source = |texts: [&str; 4]| {
        let masses = texts.into_iter().zip([0.4, 0.3, 0.2, 0.1]);
        MassFunction::parse(&frame, masses).expect("masses")
    };
    let sources =
        [source(["A", "B & C", "C | D", "Theta"]), source(["A & D", "B", "(A | B) & C", "Theta"])];
    c.bench_function("cautious/free/4", |bench| {
        bench.iter(|| rule::combine(Rule::Cautious, black_box(&sources), &frame));
    });
}

criterion_group!(benches, elements, counts, transforms, cautious);
criterion_main!(benches);
