//! Whole maps, beside the same cells one by one.

use wisdom_belief::map::{
    self, MAX_MAP_SOURCES, MAX_ROWS, MapNumber, Outputs, Planes, PlanesMut, Source, Table,
};
use wisdom_belief::{
    BeliefError, InterestMass, Opinion, ParadoxPolicy, Rule, Settings, Uncertainty,
};

/// Contract of single precision: absolute, of masses and of belief.
const SINGLE: f64 = 1e-6;

/// A few units in the last place of 1: planes leave ignorance as the rest, cells add it up.
const DOUBLE: f64 = 32.0 * f64::EPSILON;

/// The integral that PCR6 of many sources is, in double precision.
const INTEGRAL: f64 = 1e-12;

/// Neither a power of two nor a multiple of a register.
const CELLS: usize = 203;

/// A fixed stream of numbers below `below`.
struct Numbers(u32);

impl Numbers {
    fn next(&mut self, below: u32) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) % below
    }
}

/// Planes of masses in 256ths, which both precisions hold exactly: so the rest is exact, too. Often 0 or 1.
struct Masses<F> {
    interesting: Vec<F>,
    not_interesting: Vec<F>,
    paradox: Vec<F>,
}

impl<F: MapNumber> Masses<F> {
    fn random(source: usize) -> Self {
        let mut numbers = Numbers(source as u32 * 977 + 5);
        let mut masses = Self { interesting: vec![], not_interesting: vec![], paradox: vec![] };
        for _ in 0..CELLS {
            let mut cuts = [(); 3].map(|()| match numbers.next(8) {
                0 => 0,
                1 => 256,
                _ => numbers.next(257),
            });
            cuts.sort_unstable();
            let part = |from: u32, to: u32| F::from_f64(f64::from(to - from) / 256.0);
            masses.interesting.push(part(0, cuts[0]));
            masses.not_interesting.push(part(cuts[0], cuts[1]));
            masses.paradox.push(part(cuts[1], cuts[2]));
        }
        masses
    }

    fn source(&self) -> Source<'_, F> {
        Source::Planes(Planes {
            interesting: &self.interesting,
            not_interesting: &self.not_interesting,
            paradox: Some(&self.paradox),
        })
    }

    /// The same masses of one cell in double precision.
    fn cell(&self, cell: usize) -> InterestMass {
        let [i, n, p] = [&self.interesting, &self.not_interesting, &self.paradox]
            .map(|plane| plane[cell].to_f64());
        InterestMass::from_masses([i, n, 1.0 - (i + n + p), p]).expect("they sum to 1")
    }
}

/// All planes that can be asked for.
struct Fused<F> {
    belief: Vec<F>,
    interesting: Vec<F>,
    not_interesting: Vec<F>,
    ignorance: Vec<F>,
    paradox: Vec<F>,
    conflict: Vec<F>,
    pignistic: Vec<F>,
}

impl<F: MapNumber> Fused<F> {
    fn new() -> Self {
        // Nothing that a rule could give.
        let plane = || vec![F::from_f64(-7.0); CELLS];
        Self {
            belief: plane(),
            interesting: plane(),
            not_interesting: plane(),
            ignorance: plane(),
            paradox: plane(),
            conflict: plane(),
            pignistic: plane(),
        }
    }

    fn outputs(&mut self) -> Outputs<'_, F> {
        Outputs {
            belief: Some(&mut self.belief),
            interesting: Some(&mut self.interesting),
            not_interesting: Some(&mut self.not_interesting),
            ignorance: Some(&mut self.ignorance),
            paradox: Some(&mut self.paradox),
            conflict: Some(&mut self.conflict),
            pignistic: Some(&mut self.pignistic),
        }
    }

    fn of(rule: Rule, sources: &[Source<'_, F>], policy: ParadoxPolicy) -> Self {
        let mut fused = Self::new();
        map::fuse(rule, sources, policy, &Settings::default(), fused.outputs()).expect("a map");
        fused
    }

    fn planes(&self) -> [&[F]; 7] {
        [
            &self.belief,
            &self.interesting,
            &self.not_interesting,
            &self.ignorance,
            &self.paradox,
            &self.conflict,
            &self.pignistic,
        ]
    }
}

/// What each plane should hold, from one cell alone.
fn expected(rule: Rule, sources: &[InterestMass], policy: ParadoxPolicy) -> [f64; 7] {
    let fused = rule.fuse(sources, policy);
    let (mass, model) = (fused.mass, rule.model());
    let [i, n, u, p] = mass.masses();
    [mass.belief_under(&model), i, n, u, p, fused.conflict, mass.pignistic(&model)]
}

fn is_exponential(rule: Rule) -> bool {
    matches!(rule, Rule::Pcr5 | Rule::Pcr5Plus | Rule::Pcr5Canonical)
}

fn is_integral(rule: Rule) -> bool {
    matches!(rule, Rule::Pcr6 | Rule::Pcr6Plus | Rule::Pcr6Canonical)
}

fn maps_are_their_cells<F: MapNumber>(tolerance: f64) {
    let masses: Vec<Masses<F>> = (0..9).map(Masses::random).collect();
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        for policy in ParadoxPolicy::ALL.into_iter().filter(|&policy| rule.admits(policy)) {
            for count in 1..=9 {
                if is_exponential(rule) && count > 6 {
                    continue;
                }
                let tolerance = if is_integral(rule) && count > 6 {
                    tolerance.max(INTEGRAL)
                } else {
                    tolerance
                };
                let sources: Vec<_> = masses[..count].iter().map(Masses::source).collect();
                let fused = Fused::of(rule, &sources, policy);
                for cell in 0..CELLS {
                    let alone: Vec<_> = masses[..count].iter().map(|m| m.cell(cell)).collect();
                    let expected = expected(rule, &alone, policy);
                    let found = fused.planes().map(|plane| plane[cell].to_f64());
                    let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
                    assert!(close, "{rule} {policy} {count}: {found:?} {expected:?} of {alone:?}");
                }
            }
        }
    }
}

#[test]
fn maps_in_double_precision_are_their_cells() {
    maps_are_their_cells::<f64>(DOUBLE);
}

#[test]
fn maps_in_single_precision_are_their_cells_within_a_millionth() {
    maps_are_their_cells::<f32>(SINGLE);
}

#[test]
fn what_else_is_asked_for_changes_no_bit() {
    let masses: Vec<Masses<f32>> = (0..3).map(Masses::random).collect();
    let sources: Vec<_> = masses.iter().map(Masses::source).collect();
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        let all = Fused::of(rule, &sources, ParadoxPolicy::Split);
        for wanted in 0_u8..128 {
            let mut some = Fused::new();
            let mut outputs = some.outputs();
            let planes = [
                &mut outputs.belief,
                &mut outputs.interesting,
                &mut outputs.not_interesting,
                &mut outputs.ignorance,
                &mut outputs.paradox,
                &mut outputs.conflict,
                &mut outputs.pignistic,
            ];
            for (bit, plane) in planes.into_iter().enumerate() {
                if wanted & (1 << bit) == 0 {
                    *plane = None;
                }
            }
            map::fuse(rule, &sources, ParadoxPolicy::Split, &Settings::default(), outputs)
                .expect("a map");
            for (bit, (some, all)) in some.planes().into_iter().zip(all.planes()).enumerate() {
                let expected = if wanted & (1 << bit) == 0 { &[-7.0; CELLS][..] } else { all };
                assert_eq!(some, expected, "{rule} {wanted:#b}");
            }
        }
    }
}

#[test]
fn little_belief_keeps_its_digits_in_single_precision() {
    let (faint, none) = ([1e-12_f32; 3], [0.0; 3]);
    let planes = Planes { interesting: &faint, not_interesting: &none, paradox: None };
    let mut belief = [0.0; 3];
    let outputs = Outputs { belief: Some(&mut belief), ..Outputs::default() };
    let sources = [Source::Planes(planes); 3];
    map::fuse(Rule::Dsmc, &sources, ParadoxPolicy::Split, &Settings::default(), outputs)
        .expect("a map");
    assert!((belief[0] / 3e-12 - 1.0).abs() < 1e-6, "{belief:?}");
}

#[test]
fn undefined_cells_are_vacuous_with_all_in_conflict() {
    let (all, none) = ([1.0_f64, 0.5], [0.0, 0.25]);
    let sources = [
        Source::Planes(Planes { interesting: &all, not_interesting: &none, paradox: None }),
        Source::Planes(Planes { interesting: &none, not_interesting: &all, paradox: None }),
    ];
    for rule in [Rule::Dempster, Rule::MinC, Rule::Zhang, Rule::Jaccard, Rule::Cautious] {
        let (mut ignorance, mut conflict) = ([0.0; 2], [0.0; 2]);
        let outputs = Outputs {
            ignorance: Some(&mut ignorance),
            conflict: Some(&mut conflict),
            ..Outputs::default()
        };
        map::fuse(rule, &sources, ParadoxPolicy::Split, &Settings::default(), outputs)
            .expect("a map");
        assert_eq!((ignorance[0], conflict[0]), (1.0, 1.0), "{rule}");
        assert!(ignorance[1] < 1.0 && conflict[1] < 1.0, "{rule}");
    }
}

/// 1 − (0.3 + 0.7) is not 0 in single precision, nor is the rest of some tenths in double.
#[test]
fn ignorance_that_is_only_rounding_is_none() {
    let sources = |of: [f64; 2]| of.map(|mass| [mass as f32]);
    let [i, n] = sources([0.3, 0.7]);
    let sources = [Source::Planes(Planes { interesting: &i, not_interesting: &n, paradox: None })];
    let mut ignorance = [1.0];
    let outputs = Outputs { ignorance: Some(&mut ignorance), ..Outputs::default() };
    map::fuse(Rule::Yager, &sources, ParadoxPolicy::Split, &Settings::default(), outputs)
        .expect("a map");
    assert_eq!(ignorance[0], 0.0);
}

#[test]
fn no_sources_know_nothing() {
    let fused = Fused::<f64>::of(Rule::Dempster, &[], ParadoxPolicy::Split);
    let found = fused.planes().map(|plane| plane[CELLS - 1]);
    assert_eq!(found, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5]);
    let fused = Fused::<f64>::of(Rule::Dsmc, &[], ParadoxPolicy::Split);
    assert!((fused.pignistic[0] - 2.0 / 3.0).abs() < DOUBLE);
}

fn opinions(rows: usize) -> Vec<Opinion> {
    let mut numbers = Numbers(3);
    let row = |_| {
        let [i, n, p] = [numbers.next(80), numbers.next(80), numbers.next(80)];
        Opinion {
            interesting: f64::from(i) / 256.0,
            not_interesting: f64::from(n) / 256.0,
            paradox: f64::from(p) / 256.0,
        }
    };
    (0..rows).map(row).collect()
}

/// The sources of a cell from a row number and an uncertainty; a row that is not there says nothing.
fn looked_up(opinions: &[Opinion], row: Option<usize>, u: f64) -> InterestMass {
    let opinion = row.and_then(|row| opinions.get(row).copied()).unwrap_or_default();
    let u = Uncertainty::new(u).expect("in [0, 1]");
    InterestMass::try_from(opinion).expect("an opinion").discounted(u)
}

fn classes_and_readings_are_looked_up<F: MapNumber>(table_rows: usize, tolerance: f64) {
    let opinions = opinions(table_rows);
    let table = Table::<F>::new(&opinions).expect("opinions");
    let bounds: Vec<f32> = (1..table_rows).map(|bound| bound as f32 * 0.5).collect();
    let mut numbers = Numbers(11);
    let rows: Vec<u8> = (0..CELLS).map(|_| numbers.next(256) as u8).collect();
    let values: Vec<f32> = (0..CELLS)
        .map(|cell| match cell % 9 {
            0 => f32::NAN,
            1 => bounds.first().copied().unwrap_or(0.0),
            _ => numbers.next(4096) as f32 / 4096.0 * (table_rows as f32 * 0.5 + 2.0) - 1.0,
        })
        .collect();
    let u: Vec<F> = (0..CELLS).map(|_| F::from_f64(f64::from(numbers.next(257)) / 256.0)).collect();
    let masses = Masses::<F>::random(1);
    let sources = [
        Source::Classes { rows: &rows, table: &table, uncertainty: &u },
        Source::Readings { values: &values, bounds: &bounds, table: &table, uncertainty: &u },
        masses.source(),
    ];
    let cell = |cell: usize| {
        let value = values[cell];
        let band = bounds.iter().filter(|&&bound| bound <= value).count();
        let band = (!value.is_nan()).then_some(band);
        let u = u[cell].to_f64();
        [
            looked_up(&opinions, Some(usize::from(rows[cell])), u),
            looked_up(&opinions, band, u),
            masses.cell(cell),
        ]
    };
    for rule in Rule::ALL.into_iter().filter(|rule| rule.on_maps()) {
        let fused = Fused::of(rule, &sources, ParadoxPolicy::ToIgnorance);
        let mut belief = vec![F::zero(); CELLS];
        let outputs = Outputs { belief: Some(&mut belief), ..Outputs::default() };
        map::fuse(rule, &sources, ParadoxPolicy::ToIgnorance, &Settings::default(), outputs)
            .expect("a map");
        for at in 0..CELLS {
            let expected = expected(rule, &cell(at), ParadoxPolicy::ToIgnorance);
            let found = fused.planes().map(|plane| plane[at].to_f64());
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
            assert!(close, "{rule} {at}: {found:?} {expected:?}");
            assert!((belief[at].to_f64() - expected[0]).abs() <= tolerance, "{rule} {at}");
        }
    }
}

#[test]
fn classes_and_readings_are_looked_up_in_tables_of_any_length() {
    for rows in [1, 2, 7, 15, 16, 40, MAX_ROWS] {
        classes_and_readings_are_looked_up::<f32>(rows, SINGLE);
        classes_and_readings_are_looked_up::<f64>(rows, DOUBLE);
    }
}

#[test]
fn discounted_planes_are_discounted_cells() {
    let masses = Masses::<f64>::random(4);
    let u: Vec<f64> = (0..CELLS).map(|cell| cell as f64 / CELLS as f64).collect();
    let [mut i, mut n, mut p] = [(); 3].map(|()| vec![0.0; CELLS]);
    let discounted =
        PlanesMut { interesting: &mut i, not_interesting: &mut n, paradox: Some(&mut p) };
    let Source::Planes(planes) = masses.source() else { unreachable!("they are planes") };
    map::discount(planes, &u, discounted).expect("planes of one length");
    for cell in 0..CELLS {
        let u = Uncertainty::new(u[cell]).expect("in [0, 1]");
        let [by_i, by_n, _, by_p] = masses.cell(cell).discounted(u).masses();
        assert_eq!([i[cell], n[cell], p[cell]], [by_i, by_n, by_p]);
    }
}

#[test]
fn maps_that_make_no_sense_are_refused() {
    let masses = Masses::<f32>::random(0);
    let call = |rule, sources: &[Source<'_, f32>], policy, outputs: Outputs<'_, f32>| {
        map::fuse(rule, sources, policy, &Settings::default(), outputs)
    };
    let bold = call(Rule::Bold, &[masses.source()], ParadoxPolicy::ToEmpty, Outputs::default());
    assert_eq!(bold, Err(BeliefError::NotOnMaps { rule: Rule::Bold }));

    let policy = ParadoxPolicy::KeepForDsmh;
    let kept = call(Rule::Pcr6, &[masses.source()], policy, Outputs::default());
    assert_eq!(kept, Err(BeliefError::PolicyNotAdmitted { rule: Rule::Pcr6, policy }));

    let many = vec![masses.source(); MAX_MAP_SOURCES + 1];
    let found = call(Rule::Dsmc, &many, ParadoxPolicy::Split, Outputs::default());
    let (sources, limit) = (MAX_MAP_SOURCES + 1, MAX_MAP_SOURCES);
    assert_eq!(found, Err(BeliefError::TooManySources { sources, limit, rule: Rule::Dsmc }));

    let mut short = [0.0; 5];
    let outputs = Outputs { conflict: Some(&mut short), ..Outputs::default() };
    let found = call(Rule::Dsmc, &[masses.source()], ParadoxPolicy::Split, outputs);
    let message = found.expect_err("five cells are too few").to_string();
    assert_eq!(message, format!("plane output conflict has 5 cells; the first one has {CELLS}"));

    let table = Table::new(&opinions(3)).expect("opinions");
    let (values, u) = (vec![0.0; CELLS], vec![0.0; CELLS]);
    for bounds in [&[1.0, 1.0][..], &[1.0], &[1.0, f32::NAN], &[2.0, 1.0], &[]] {
        let source = Source::Readings { values: &values, bounds, table: &table, uncertainty: &u };
        let found = call(Rule::Dsmc, &[source], ParadoxPolicy::Split, Outputs::default());
        assert!(matches!(found, Err(BeliefError::BandBounds { rows: 3, .. })), "{bounds:?}");
    }
    assert!(Table::<f32>::new(&[Opinion { paradox: 1.5, ..Opinion::default() }]).is_err());
    assert!(Table::<f32>::new(&[Opinion::default(); MAX_ROWS + 1]).is_err());
}
