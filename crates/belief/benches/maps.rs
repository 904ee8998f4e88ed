//! What an interest map costs, beside how fast this machine moves memory at all.
//!
//! The measure is a triad `a = b + s * c` in the same process, with the same instructions and the same ordinary
//! stores, run in turns with the kernels; a kernel is as fast as memory if it moves its bytes as fast as the
//! triad does. A written plane counts twice: ordinary stores read what they overwrite. Times are medians.
//!
//! With a Python that has numpy (named by the variable `PYTHON`, or `python3`) the same closed forms in numpy
//! are run, too.
#![expect(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a bench reads the clock and prints what it finds"
)]

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

use fearless_simd::{Level, Simd, SimdBase, dispatch};
use wisdom_belief::map::{self, MapNumber, Outputs, Planes, PlanesMut, Source, Table};
use wisdom_belief::{Opinion, ParadoxPolicy, Rule, Settings};

/// A plane that begins where a cache line does, some lines into a page.
struct Plane<T> {
    values: Vec<T>,
    start: usize,
    cells: usize,
}

/// Bytes of a cache line, and of the pages at whose distance lines compete for the same places in a cache.
const LINE: usize = 64;
const PAGE: usize = 4096;

impl<T: Copy> Plane<T> {
    fn from_fn(cells: usize, zero: T, lines: usize, value: impl FnMut(usize) -> T) -> Self {
        let page = PAGE / size_of::<T>();
        let mut values = vec![zero; cells + 2 * page];
        let aligned = values.as_ptr().align_offset(PAGE).min(page);
        let start = aligned + lines % (PAGE / LINE) * (LINE / size_of::<T>());
        for (cell, value) in (0..cells).map(value).enumerate() {
            values[start + cell] = value;
        }
        Self { values, start, cells }
    }

    fn get(&self) -> &[T] {
        &self.values[self.start..self.start + self.cells]
    }

    fn get_mut(&mut self) -> &mut [T] {
        &mut self.values[self.start..self.start + self.cells]
    }
}

/// How far apart planes begin, in cache lines beyond whole pages: a caller's choice that the caches notice.
/// Planes allocated one by one begin alike; planes laid out in one buffer can be kept apart.
#[derive(Clone, Copy)]
struct Layout {
    lines_apart: usize,
}

impl Layout {
    const APART: Self = Self { lines_apart: 5 };
    const ALIKE: Self = Self { lines_apart: 0 };

    fn plane<T: Copy>(
        self,
        index: usize,
        cells: usize,
        zero: T,
        value: impl FnMut(usize) -> T,
    ) -> Plane<T> {
        Plane::from_fn(cells, zero, index * self.lines_apart, value)
    }
}

/// A number in [0, 1) that is always the same for a cell and a purpose (splitmix64).
fn noise(cell: usize, purpose: u64) -> f64 {
    let mut z = (cell as u64).wrapping_add(purpose << 40).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

/// Masses on I, NI, I ∩ NI; the rest is ignorance.
struct Masses<F> {
    interesting: Plane<F>,
    not_interesting: Plane<F>,
    paradox: Plane<F>,
}

impl<F: MapNumber> Masses<F> {
    fn random(layout: Layout, cells: usize, source: u64) -> Self {
        let share = |of: u64| {
            move |cell: usize| {
                let weights = [0, 1, 2, 3].map(|part| noise(cell, source * 4 + part) + 0.01);
                F::from_f64(weights[of as usize] / weights.iter().sum::<f64>())
            }
        };
        let plane =
            |part: u64| layout.plane((source * 3 + part) as usize, cells, F::zero(), share(part));
        Self { interesting: plane(0), not_interesting: plane(1), paradox: plane(2) }
    }

    fn source(&self, paradox: bool) -> Source<'_, F> {
        Source::Planes(Planes {
            interesting: self.interesting.get(),
            not_interesting: self.not_interesting.get(),
            paradox: paradox.then(|| self.paradox.get()),
        })
    }
}

/// Which planes a kernel writes.
#[derive(Clone, Copy, PartialEq)]
enum Wanted {
    Belief,
    Three,
    Four,
}

/// A measured call: planes read, planes written.
struct Case {
    name: &'static str,
    rule: Rule,
    read_paradox: bool,
    wanted: Wanted,
    policy: ParadoxPolicy,
}

impl Case {
    /// Bytes moved a cell by three sources, a written plane counted twice.
    fn bytes<F>(&self) -> usize {
        // Paradox that goes to ignorance is not looked at; Bel(I) under DSmC does not look at m(NI).
        let moved = self.rule != Rule::Dsmc && self.policy == ParadoxPolicy::ToIgnorance;
        let alone = self.rule == Rule::Dsmc && self.wanted == Wanted::Belief;
        let planes = 2 + usize::from(self.read_paradox && !moved) - usize::from(alone);
        let written = match self.wanted {
            Wanted::Belief => 1,
            Wanted::Three => 3,
            Wanted::Four => 4,
        };
        (3 * planes + 2 * written) * size_of::<F>()
    }
}

const fn case(name: &'static str, rule: Rule, read_paradox: bool, wanted: Wanted) -> Case {
    Case { name, rule, read_paradox, wanted, policy: ParadoxPolicy::ToIgnorance }
}

const CASES: [Case; 12] = [
    case("dsmc, four masses", Rule::Dsmc, true, Wanted::Four),
    case("dsmc, belief", Rule::Dsmc, true, Wanted::Belief),
    case("dempster", Rule::Dempster, true, Wanted::Three),
    Case {
        policy: ParadoxPolicy::Split,
        ..case("dempster, paradox split", Rule::Dempster, true, Wanted::Three)
    },
    case("dempster, belief", Rule::Dempster, true, Wanted::Belief),
    case("yager", Rule::Yager, true, Wanted::Three),
    case("dubois-prade", Rule::DuboisPrade, true, Wanted::Three),
    case("pcr6", Rule::Pcr6, true, Wanted::Three),
    case("pcr6-plus", Rule::Pcr6Plus, true, Wanted::Three),
    case("pcr5", Rule::Pcr5, true, Wanted::Three),
    case("cautious", Rule::Cautious, true, Wanted::Four),
    case("deng", Rule::Deng, true, Wanted::Three),
];

/// Seconds of one call.
fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// Shorter work is repeated within one measurement.
const SHORTEST_S: f64 = 0.01;

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[expect(
    clippy::inline_always,
    reason = "code for an instruction set is compiled only where it is inlined"
)]
#[inline(always)]
fn triad_loop<S: Simd>(simd: S, a: &mut [f32], b: &[f32], c: &[f32]) {
    let lanes = S::f32s::LEN;
    let scale = S::f32s::splat(simd, 0.5);
    let sources = b.chunks_exact(lanes).zip(c.chunks_exact(lanes));
    for (a, (b, c)) in a.chunks_exact_mut(lanes).zip(sources) {
        (S::f32s::from_slice(simd, b) + scale * S::f32s::from_slice(simd, c)).store_slice(a);
    }
}

fn triad(a: &mut [f32], b: &[f32], c: &[f32]) {
    dispatch!(Level::new(), simd => triad_loop(simd, a, b, c));
}

/// Bytes a cell: b and c read, a read and written.
const TRIAD_BYTES: usize = 16;

fn fuse<F: MapNumber>(case: &Case, sources: &[Source<'_, F>], out: &mut [Plane<F>; 4]) {
    let [i, n, u, p] = out.each_mut().map(|plane| Some(plane.get_mut()));
    let outputs = match case.wanted {
        Wanted::Belief => Outputs { belief: i, ..Outputs::default() },
        Wanted::Three => {
            Outputs { interesting: i, not_interesting: n, ignorance: u, ..Outputs::default() }
        }
        Wanted::Four => Outputs {
            interesting: i,
            not_interesting: n,
            ignorance: u,
            paradox: p,
            ..Outputs::default()
        },
    };
    map::fuse(case.rule, sources, case.policy, &Settings::default(), outputs)
        .expect("planes of one length and an admitted policy");
}

/// Work to be measured: its name, the bytes it moves a cell, and a call.
struct Work<'a> {
    name: String,
    bytes: usize,
    call: Box<dyn FnMut() + 'a>,
}

/// Triad and kernels in turns; prints each kernel's rate and its share of what the triad would reach, and gives
/// the seconds of a call.
fn measure(
    title: &str,
    cells: usize,
    rounds: usize,
    work: &mut [Work<'_>],
) -> BTreeMap<String, f64> {
    let value = |cell: usize| noise(cell, 7) as f32;
    let [mut a, b, c] = [40, 41, 42].map(|plane| Layout::APART.plane(plane, cells, 0.0_f32, value));
    // Small maps are over too soon for the clock.
    let repeats = |seconds: f64| (SHORTEST_S / seconds).ceil().max(1.0) as usize;
    let repeat = |call: &mut dyn FnMut()| {
        let times = repeats(time(&mut *call));
        time(|| (0..times).for_each(|_| call())) / times as f64
    };
    let mut times = vec![Vec::new(); work.len()];
    let mut triads = Vec::new();
    for _ in 0..rounds {
        for (work, times) in work.iter_mut().zip(&mut times) {
            triads.push(repeat(&mut || triad(black_box(a.get_mut()), b.get(), c.get())));
            times.push(repeat(&mut work.call));
        }
    }
    let triad_rate = (TRIAD_BYTES * cells) as f64 / median(&mut triads);
    println!("\n{title}: triad {:.1} GB/s", triad_rate / 1e9);
    println!("{:34} {:>7} {:>8} {:>7} {:>9}", "", "B/cell", "Mpx/s", "GB/s", "of triad");
    let mut calls = BTreeMap::new();
    for (Work { name, bytes, .. }, times) in work.iter().zip(&mut times) {
        let call = median(times);
        let (cells_a_second, rate) = (cells as f64 / call, (bytes * cells) as f64 / call);
        let share = rate / triad_rate;
        println!(
            "{name:34} {bytes:>7} {:>8.1} {:>7.1} {share:>9.2}",
            cells_a_second / 1e6,
            rate / 1e9
        );
        calls.insert(name.clone(), call);
    }
    calls
}

/// Three sources as planes.
fn planes<F: MapNumber>(
    side: usize,
    layout: Layout,
    rounds: usize,
    title: &str,
) -> BTreeMap<String, f64> {
    let cells = side * side;
    let masses = [0, 1, 2].map(|source| Masses::<F>::random(layout, cells, source));
    let value = |cell: usize| F::from_f64(noise(cell, 99));
    let u = layout.plane(9, cells, F::zero(), value);
    let out = [10, 11, 12, 13].map(|plane| layout.plane(plane, cells, F::zero(), |_| F::zero()));
    let out = RefCell::new(out);
    let mut work: Vec<Work<'_>> = CASES
        .iter()
        .map(|case| {
            let (masses, out) = (&masses, &out);
            Work {
                name: case.name.to_owned(),
                bytes: case.bytes::<F>(),
                call: Box::new(move || {
                    let sources = masses.each_ref().map(|m| m.source(case.read_paradox));
                    fuse(case, &sources, black_box(&mut out.borrow_mut()));
                }),
            }
        })
        .collect();
    work.push(Work {
        name: "discount (one source)".to_owned(),
        bytes: (4 + 2 * 3) * size_of::<F>(),
        call: Box::new(|| discount(&masses[0], &u, black_box(&mut out.borrow_mut()))),
    });
    measure(title, cells, rounds, &mut work)
}

/// Classes or readings and u, straight to Bel(I).
fn straight_from_readings<F: MapNumber>(side: usize, rounds: usize, title: &str) {
    let cells = side * side;
    let opinion = |row: usize| Opinion {
        interesting: noise(row, 50) / 3.0,
        not_interesting: noise(row, 51) / 3.0,
        paradox: noise(row, 52) / 3.0,
    };
    let table = |rows: usize| {
        Table::<F>::new(&(0..rows).map(opinion).collect::<Vec<_>>()).expect("opinions")
    };
    let (seven, forty) = (table(7), table(40));
    let layout = Layout::APART;
    let u = [0, 1, 2]
        .map(|s| layout.plane(s, cells, F::zero(), |cell| F::from_f64(noise(cell, 60 + s as u64))));
    let rows = |of: usize| {
        [3, 4, 5].map(|s| {
            layout.plane(s, cells, 0_u8, |cell| (noise(cell, 70 + s as u64) * of as f64) as u8)
        })
    };
    let (few, many) = (rows(7), rows(40));
    let values = [6, 7, 8]
        .map(|s| layout.plane(s, cells, 0.0_f32, |cell| (noise(cell, 80 + s as u64) * 7.0) as f32));
    let bounds = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let belief = RefCell::new(layout.plane(9, cells, F::zero(), |_| F::zero()));
    let call = |rule: Rule, sources: &[Source<'_, F>]| {
        let mut belief = belief.borrow_mut();
        let outputs = Outputs { belief: Some(black_box(belief.get_mut())), ..Outputs::default() };
        let (policy, settings) = (ParadoxPolicy::ToIgnorance, Settings::default());
        map::fuse(rule, sources, policy, &settings, outputs).expect("planes of one length");
    };
    let bytes = 3 * (1 + size_of::<F>()) + 2 * size_of::<F>();
    let mut work = Vec::new();
    for rule in [Rule::Dsmc, Rule::Dempster, Rule::Yager, Rule::Pcr6] {
        for (rows, table, kind) in [(&few, &seven, "7 classes"), (&many, &forty, "40 classes")] {
            let (call, u) = (&call, &u);
            work.push(Work {
                name: format!("{rule}, belief from {kind}"),
                bytes,
                call: Box::new(move || {
                    let sources = [0, 1, 2].map(|s| Source::Classes {
                        rows: rows[s].get(),
                        table,
                        uncertainty: u[s].get(),
                    });
                    call(rule, &sources);
                }),
            });
        }
        let (call, values, u, bounds, seven) = (&call, &values, &u, &bounds, &seven);
        work.push(Work {
            name: format!("{rule}, belief from 7 bands"),
            bytes: 3 * (4 + size_of::<F>()) + 2 * size_of::<F>(),
            call: Box::new(move || {
                let sources = [0, 1, 2].map(|s| Source::Readings {
                    values: values[s].get(),
                    bounds,
                    table: seven,
                    uncertainty: u[s].get(),
                });
                call(rule, &sources);
            }),
        });
    }
    measure(title, cells, rounds, &mut work);
}

/// PCR6 of more sources: all assignments up to some number, an integral beyond (see the source of the rule).
fn many_sources<F: MapNumber>(side: usize, rounds: usize, title: &str) {
    let cells = side * side;
    let masses: Vec<Masses<F>> =
        (0..9).map(|source| Masses::random(Layout::APART, cells, source)).collect();
    let out = [10, 11, 12, 13].map(|p| Layout::APART.plane(p, cells, F::zero(), |_| F::zero()));
    let out = RefCell::new(out);
    let mut work = Vec::new();
    let case = &CASES[7];
    for count in 2..=9 {
        let (masses, out) = (&masses, &out);
        work.push(Work {
            name: format!("pcr6, {count} sources"),
            bytes: (2 * count + 2 * 3) * size_of::<F>(),
            call: Box::new(move || {
                let sources: Vec<_> = masses[..count].iter().map(|m| m.source(true)).collect();
                fuse(case, &sources, black_box(&mut out.borrow_mut()));
            }),
        });
    }
    measure(title, cells, rounds, &mut work);
}

fn discount<F: MapNumber>(masses: &Masses<F>, u: &Plane<F>, out: &mut [Plane<F>; 4]) {
    let [i, n, p, _] = out.each_mut().map(Plane::get_mut);
    let source = Planes {
        interesting: masses.interesting.get(),
        not_interesting: masses.not_interesting.get(),
        paradox: Some(masses.paradox.get()),
    };
    let discounted = PlanesMut { interesting: i, not_interesting: n, paradox: Some(p) };
    map::discount(source, u.get(), discounted).expect("planes of one length");
}

/// The peer's seconds for each rule at 512², if there is a Python with numpy.
fn numpy(side: usize) -> Option<BTreeMap<String, f64>> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/numpy_closed_form.py");
    let run = Command::new(python).arg(script).arg(side.to_string()).output().ok()?;
    let text = String::from_utf8(run.stdout).ok()?;
    let line = |line: &str| {
        let (rule, seconds) = line.split_once(' ')?;
        Some((rule.to_owned(), seconds.parse().ok()?))
    };
    let times: BTreeMap<String, f64> = text.lines().filter_map(line).collect();
    (!times.is_empty()).then_some(times)
}

fn beside_numpy(ours: &BTreeMap<String, f64>, side: usize) {
    let Some(theirs) = numpy(side) else {
        println!("\nno Python with numpy: no comparison (set PYTHON)");
        return;
    };
    println!("\n{side} x {side}, f32, numpy closed forms, times as long as here:");
    for (rule, name) in [
        ("dsmc", "dsmc, four masses"),
        ("belief", "dsmc, belief"),
        ("dempster", "dempster"),
        ("yager", "yager"),
        ("pcr6", "pcr6"),
    ] {
        if let (Some(theirs), Some(ours)) = (theirs.get(rule), ours.get(name)) {
            println!("{name:34} {:>7.1}", theirs / ours);
        }
    }
}

fn main() {
    // `cargo bench` hands over its own flags; any other word chooses the parts whose title has it.
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let chosen =
        |title: &str| words.is_empty() || words.iter().any(|word| title.contains(word.as_str()));
    println!("instructions: {}; ordinary stores; one thread", map::instruction_set());
    println!("a written plane counts twice, in the triad (16 B a cell) as in the kernels");
    let (large, small) = (2048, 512);
    let part = |title: &str, run: &dyn Fn(&str)| {
        if chosen(title) {
            run(title);
        }
    };
    part("planes 2048², f32", &|title| {
        planes::<f32>(large, Layout::APART, 15, title);
    });
    part("planes 2048², f32, all at the same place in a page", &|title| {
        planes::<f32>(large, Layout::ALIKE, 5, title);
    });
    part("planes 2048², f64", &|title| {
        planes::<f64>(large, Layout::APART, 7, title);
    });
    part("readings 2048², f32", &|title| straight_from_readings::<f32>(large, 7, title));
    part("readings 512², f32", &|title| straight_from_readings::<f32>(small, 7, title));
    part("planes 512², f32, in the cache, beside numpy", &|title| {
        let ours = planes::<f32>(small, Layout::APART, 15, title);
        beside_numpy(&ours, small);
    });
    part("sources 128², f32", &|title| many_sources::<f32>(128, 5, title));
    part("sources 128², f64", &|title| many_sources::<f64>(128, 5, title));
}
