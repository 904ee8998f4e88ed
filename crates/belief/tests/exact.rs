//! The library against the definitions, on random bodies: exactly equal on rationals, to the last digits in
//! floating point.

mod definition;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use definition::venn::{Region, read, write};
use definition::{Body, Exact, Question, Set, Undefined, Venn};
use proptest::prelude::*;
use serde_json::Value;
use wisdom_belief::rule::{self, Workspace};
use wisdom_belief::{
    BeliefError, Frame, Fused, InterestMass, MassFunction, Number, ParadoxPolicy, Rule, Settings,
};

/// How far f64 may be off for each source: four units in the last place of 1.
const F64_PER_SOURCE: f64 = 4.0 * f64::EPSILON;

/// How far f32 may be off: what map planes are promised.
const F32: f64 = 1e-6;

/// Deng's weights take square roots, which rationals do not have: ours are off by 2^-128, about 3e-39, of which
/// weights as small as the share of a small mass beside a large one (1e-8) keep 30 digits.
const ROOT: f64 = 1e-28;

/// A frame, the same by its regions, and elements of it to speak of (not ∅).
struct Space {
    frame: Frame,
    venn: Venn,
    elements: Vec<Set>,
}

const NAMES: [&str; 8] = ["A", "B", "C", "D", "E", "F", "G", "H"];

/// Up to so many atoms all elements are spoken of; on more, the unions of two intersections of atoms.
const FEW_ATOMS: u32 = 4;

impl Space {
    fn new(frame: Frame, venn: Venn) -> Self {
        assert_eq!(Venn::of(&frame), venn, "the frame has other regions");
        let elements =
            if venn.atoms <= FEW_ATOMS { venn.elements() } else { venn.short_elements() };
        let elements = elements.into_iter().filter(|set| !set.is_empty()).collect();
        Self { frame, venn, elements }
    }

    fn free(atoms: u32) -> Self {
        let names = &NAMES[..atoms as usize];
        Self::new(Frame::free(names.to_vec()).expect("a frame"), Venn::without(atoms, &[]))
    }

    fn shafer(atoms: u32) -> Self {
        let names = &NAMES[..atoms as usize];
        Self::new(Frame::shafer(names.to_vec()).expect("a frame"), Venn::exclusive(atoms))
    }

    /// The hybrid model that empties the intersections of these atoms.
    fn hybrid(atoms: u32, empty: &[Region]) -> Self {
        let names = &NAMES[..atoms as usize];
        let text = |set: &Region| {
            let inside = (0..atoms).filter(|atom| set >> atom & 1 == 1);
            inside.map(|atom| NAMES[atom as usize]).collect::<Vec<_>>().join(" & ")
        };
        let texts: Vec<String> = empty.iter().map(text).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let frame = Frame::with_empty(names.to_vec(), &texts).expect("a frame");
        Self::new(frame, Venn::without(atoms, empty))
    }
}

/// Frames on which sources speak and are combined.
static SPACES: LazyLock<[Space; 11]> = LazyLock::new(|| {
    [
        Space::free(2),
        Space::free(3),
        Space::shafer(2),
        Space::shafer(3),
        Space::shafer(4),
        Space::hybrid(3, &[0b011]),
        Space::hybrid(3, &[0b101, 0b110]),
        Space::hybrid(3, &[0b111]),
        Space::hybrid(3, &[0b011, 0b101, 0b110]),
        Space::hybrid(3, &[0b001]),
        Space::hybrid(4, &[0b0011, 0b1100, 0b1010]),
    ]
});

/// Frames of more atoms, with up to 127 regions: too many elements to visit them all.
static WIDE_SPACES: LazyLock<[Space; 5]> = LazyLock::new(|| {
    [
        Space::free(5),
        Space::free(7),
        Space::shafer(8),
        Space::hybrid(7, &[0b11, 0b1100, 0b101_0000]),
        Space::hybrid(7, &[0b111_1111]),
    ]
});

/// Frames on which sources spoke, and what was learned of them later.
static REVISIONS: LazyLock<[(Space, Space); 11]> = LazyLock::new(|| {
    [
        (Space::free(2), Space::shafer(2)),
        (Space::free(2), Space::hybrid(2, &[0b01])),
        (Space::free(3), Space::shafer(3)),
        (Space::free(3), Space::hybrid(3, &[0b011])),
        (Space::free(3), Space::hybrid(3, &[0b001, 0b110])),
        (Space::free(3), Space::free(3)),
        (Space::shafer(3), Space::hybrid(3, &[0b011, 0b101, 0b110, 0b100])),
        (Space::shafer(4), Space::hybrid(4, &[0b0011, 0b0101, 0b1001, 0b0110, 0b0100, 0b1000])),
        (Space::hybrid(3, &[0b011]), Space::shafer(3)),
        (Space::hybrid(3, &[0b011]), Space::hybrid(3, &[0b011, 0b100])),
        (Space::free(4), Space::hybrid(4, &[0b0011, 0b1100, 0b1010])),
    ]
});

/// What one source says, before it is known of what frame: elements by number, and weights. ∅ and Θ come extra,
/// since rules care for them.
#[derive(Debug, Clone)]
struct Saying {
    of: Vec<(usize, u32)>,
    of_theta: u32,
    of_empty: u32,
}

/// A small weight, or now and then one beside which the others are next to nothing.
fn weight() -> impl Strategy<Value = u32> {
    prop_oneof![7 => 1..=12_u32, 1 => Just(10_000_000)]
}

fn saying(open_world: bool) -> impl Strategy<Value = Saying> {
    let of = prop::collection::vec((0..1000_usize, weight()), 1..=3);
    let extra = || prop_oneof![Just(0), weight()];
    let of_empty = if open_world { extra().boxed() } else { Just(0).boxed() };
    (of, extra(), of_empty).prop_map(|(of, of_theta, of_empty)| Saying { of, of_theta, of_empty })
}

fn sayings(open_world: bool) -> impl Strategy<Value = Vec<Saying>> {
    prop::collection::vec(saying(open_world), 1..=4)
}

/// Fewer sources, for frames on which each costs more.
fn few_sayings() -> impl Strategy<Value = Vec<Saying>> {
    prop::collection::vec(saying(false), 1..=3)
}

/// The weights of the elements that a source names on a space.
fn weights(saying: &Saying, space: &Space) -> BTreeMap<Set, u32> {
    let mut weights = BTreeMap::new();
    for &(number, weight) in &saying.of {
        let element = &space.elements[number % space.elements.len()];
        *weights.entry(element.clone()).or_insert(0) += weight;
    }
    *weights.entry(space.venn.theta.clone()).or_insert(0) += saying.of_theta;
    *weights.entry(Set::new()).or_insert(0) += saying.of_empty;
    weights.retain(|_, weight| *weight > 0);
    weights
}

fn bodies(sayings: &[Saying], space: &Space) -> Vec<Body> {
    let body = |saying| {
        let weights = weights(saying, space);
        let all = weights.values().sum();
        weights.into_iter().map(|(set, weight)| (set, Exact::ratio(weight, all))).collect()
    };
    sayings.iter().map(body).collect()
}

/// The same bodies for the library, in a number type of its choice.
fn mass_functions<F: Number>(
    bodies: &[Body],
    frame: &Frame,
    number: impl Fn(Exact) -> F,
) -> Vec<MassFunction<F>> {
    let mass_function = |body: &Body| {
        let masses = body.iter().map(|(set, &mass)| (write(frame, set), number(mass)));
        MassFunction::new(frame, masses).expect("masses that sum to 1")
    };
    bodies.iter().map(mass_function).collect()
}

fn undefined(error: &BeliefError) -> Option<Undefined> {
    Some(match error {
        BeliefError::TotalConflict { .. } => Undefined::TotalConflict,
        BeliefError::Dogmatic { .. } => Undefined::Dogmatic,
        BeliefError::Normal { .. } => Undefined::Normal,
        BeliefError::NotFreeModel { .. } => Undefined::NotFreeModel,
        BeliefError::MassOnEmpty { .. } => Undefined::MassOnEmpty,
        _ => return None,
    })
}

/// The largest difference between an answer of the library and the definition's, over all elements.
fn difference<F: Number>(
    found: &MassFunction<F>,
    wanted: &Body,
    frame: &Frame,
    number: impl Fn(F) -> Exact,
) -> f64 {
    let mut left = wanted.clone();
    for &(element, mass) in found.focal() {
        let set = read(frame, element);
        let of_set = left.get(&set).copied().unwrap_or_else(Exact::zero);
        left.insert(set, of_set - number(mass));
    }
    left.into_values().fold(0.0, |most, off| most.max(off.to_f64().abs()))
}

fn of_double(mass: f64) -> Exact {
    Exact::from_f64(mass)
}

fn of_single(mass: f32) -> Exact {
    Exact::from_f64(f64::from(mass))
}

fn exactly(found: &MassFunction<Exact>, frame: &Frame) -> Body {
    found.focal().iter().map(|&(element, mass)| (read(frame, element), mass)).collect()
}

/// How the answers of the library, in three number types, differ from the definition's.
fn disagreement(
    rule: Rule,
    wanted: &Result<Body, Undefined>,
    frame: &Frame,
    sources: usize,
    answers: Answers,
) -> Option<String> {
    let Answers { exact, double, single } = answers;
    let (wanted, exact, double, single) = match (wanted, exact, double, single) {
        (Ok(wanted), Ok(exact), Ok(double), Ok(single)) => (wanted, exact, double, single),
        (Err(why), Err(exact), Err(double), Err(single)) => {
            let found = [exact, double, single].map(|error| undefined(&error));
            let agree = found.iter().all(|found| *found == Some(*why));
            return (!agree).then(|| format!("{rule}: {found:?}, not {why:?}"));
        }
        (wanted, exact, double, single) => {
            return Some(format!("{rule}: {exact:?} {double:?} {single:?}, not {wanted:?}"));
        }
    };
    let root = if rule == Rule::Deng { ROOT } else { 0.0 };
    let off = difference(&exact, wanted, frame, |mass| mass);
    if off > root || rule != Rule::Deng && exactly(&exact, frame) != *wanted {
        return Some(format!("{rule}: {:?}, not {wanted:?}", exactly(&exact, frame)));
    }
    let off = difference(&double, wanted, frame, of_double);
    if off > F64_PER_SOURCE * sources as f64 {
        return Some(format!("{rule}: f64 is off by {off:e}"));
    }
    let off = difference(&single, wanted, frame, of_single);
    (off > F32).then(|| format!("{rule}: f32 is off by {off:e}"))
}

/// What the library makes of one question.
struct Answers {
    exact: Result<MassFunction<Exact>, BeliefError>,
    double: Result<MassFunction<f64>, BeliefError>,
    single: Result<MassFunction<f32>, BeliefError>,
}

/// Weights of a mean, one of them 0.
const WEIGHTS: [f64; 4] = [2.0, 0.5, 0.0, 1.0];

/// What is asked: k of Inagaki's family and weights of a mean beside the sources.
fn question(sayings: &[Saying], space: &Space, given: Option<&Space>, k: f64) -> Question {
    Question {
        sources: bodies(sayings, given.unwrap_or(space)),
        given: given.map(|given| given.venn.clone()),
        venn: space.venn.clone(),
        inagaki_k: Exact::from_f64(k),
        weights: Some(WEIGHTS[..sayings.len()].iter().map(|&w| Exact::from_f64(w)).collect()),
    }
}

fn check_rules(
    rules: impl IntoIterator<Item = Rule>,
    sayings: &[Saying],
    space: &Space,
    given: Option<&Space>,
    k: f64,
) -> Result<(), TestCaseError> {
    Exact::forget_all();
    let question = question(sayings, space, given, k);
    let (frame, source_frame) = (&space.frame, &given.unwrap_or(space).frame);
    let exact = mass_functions(&question.sources, source_frame, |mass| mass);
    let double = mass_functions(&question.sources, source_frame, Exact::to_f64);
    let single = mass_functions(&question.sources, source_frame, |mass| mass.to_f64() as f32);
    // One for all rules, as it is left by the one before.
    let mut workspace = Workspace::new();
    let mut found = Vec::new();
    for rule in rules {
        let mut settings = Settings::default().with_inagaki_k(k);
        settings.source_frame = given.map(|given| &given.frame);
        if rule == Rule::Average {
            settings = settings.with_weights(&WEIGHTS[..sayings.len()]);
        }
        let answers = Answers {
            exact: rule::combine_with(rule, &exact, frame, &settings),
            double: rule::combine_with(rule, &double, frame, &settings),
            single: rule::combine_with(rule, &single, frame, &settings),
        };
        let again = workspace.combine_with(rule, &double, frame, &settings).cloned();
        if again != answers.double {
            found.push(format!("{rule}: {again:?} in a used workspace, {:?} anew", answers.double));
        }
        let wanted = question.answer(rule);
        found.extend(disagreement(rule, &wanted, frame, sayings.len(), answers));
    }
    prop_assert!(found.is_empty(), "{}", found.join("\n"));
    Ok(())
}

/// k of Inagaki's family that suit any conflict.
fn any_k() -> impl Strategy<Value = f64> {
    prop::sample::select(vec![0.0, 0.25, 0.5, 1.0])
}

/// The definition's fold: two at a time, from the left to the right.
fn folded(rule: Rule, question: &Question) -> Result<Body, Undefined> {
    let pair = |sources: Vec<Body>| Question { sources, ..question.clone() }.answer(rule);
    let Some((first, rest)) = question.sources.split_first() else { return question.answer(rule) };
    if rest.is_empty() {
        return question.answer(rule);
    }
    rest.iter().try_fold(first.clone(), |fused, next| pair(vec![fused, next.clone()]))
}

proptest! {
    #[test]
    fn every_rule_is_its_definition(
        sayings in sayings(false), space in 0..SPACES.len(), k in any_k(),
    ) {
        check_rules(Rule::ALL, &sayings, &SPACES[space], None, k)?;
    }

    /// Some sources hold that none of the hypotheses may be true.
    #[test]
    fn every_rule_is_its_definition_in_an_open_world(
        sayings in sayings(true), space in 0..SPACES.len(), k in any_k(),
    ) {
        check_rules(Rule::ALL, &sayings, &SPACES[space], None, k)?;
    }

    #[test]
    fn a_fold_takes_two_at_a_time_from_the_left_to_the_right(
        sayings in sayings(false), space in 0..SPACES.len(),
    ) {
        Exact::forget_all();
        let space = &SPACES[space];
        let k = 0.5;
        let question = Question { weights: None, ..question(&sayings, space, None, k) };
        let exact = mass_functions(&question.sources, &space.frame, |mass| mass);
        let settings = Settings::default().with_inagaki_k(k);
        for rule in Rule::ALL {
            let found = rule::fold(rule, &exact, &space.frame, &settings);
            match (found, folded(rule, &question)) {
                (Ok(found), Ok(wanted)) if rule == Rule::Deng => {
                    prop_assert!(difference(&found, &wanted, &space.frame, |mass| mass) <= ROOT);
                }
                (Ok(found), wanted) => {
                    prop_assert_eq!(Ok(exactly(&found, &space.frame)), wanted, "{}", rule);
                }
                (Err(found), wanted) => {
                    let found = undefined(&found);
                    prop_assert!(found.is_some(), "{}: another error than the definition knows", rule);
                    prop_assert_eq!(found, wanted.err(), "{}", rule);
                }
            }
        }
    }
}

proptest! {
    // Sets of many regions and of many elements take their time.
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The sources spoke before the model was known.
    #[test]
    fn every_rule_is_its_definition_on_a_model_learned_later(
        sayings in sayings(false), pair in 0..REVISIONS.len(), k in any_k(),
    ) {
        let (given, space) = &REVISIONS[pair];
        check_rules(Rule::ALL, &sayings, space, Some(given), k)?;
    }

    /// The definitions of the cautious and the bold rule visit all elements, which are too many here.
    #[test]
    fn every_other_rule_is_its_definition_on_wide_frames(
        sayings in few_sayings(), space in 0..WIDE_SPACES.len(), k in any_k(),
    ) {
        let by_elements = |rule: &Rule| matches!(rule, Rule::Cautious | Rule::Bold);
        let rules = Rule::ALL.into_iter().filter(|rule| !by_elements(rule));
        check_rules(rules, &sayings, &WIDE_SPACES[space], None, k)?;
    }
}

/// The definitions are not only the author's: they reproduce what was published, case by case.
#[test]
fn the_definitions_reproduce_the_published_cases() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("vectors.json")).expect("JSON");
    let text = |value: &Value| value.as_str().expect("a string").to_owned();
    let mut count = 0;
    for case in &cases {
        // Measures and folds are none of the definitions.
        let Ok(rule) = text(&case["rule"]).parse::<Rule>() else { continue };
        Exact::forget_all();
        let (frame, given) =
            (published_frame(case, "model"), published_frame(case, "source_model"));
        let frame = frame.expect("every case has a model");
        let source_frame = given.as_ref().unwrap_or(&frame);
        let sources = case["sources"].as_array().expect("sources").iter();
        let question = Question {
            sources: sources.map(|source| published(source, source_frame)).collect(),
            given: given.as_ref().map(Venn::of),
            venn: Venn::of(&frame),
            inagaki_k: Exact::one(),
            weights: None,
        };
        let answer = question.answer(rule).expect("no published case is undefined");
        let mut wanted = published(&case["expected"], &frame);
        for (set, mass) in answer {
            let before = wanted.get(&set).copied().unwrap_or_else(Exact::zero);
            wanted.insert(set, before - mass);
        }
        let tolerance = case["tolerance"].as_f64().expect("a number");
        let off = wanted.values().fold(0.0_f64, |most, off| most.max(off.to_f64().abs()));
        assert!(off <= tolerance, "{}: {rule} is off by {off:e}", case["id"]);
        count += 1;
    }
    assert_eq!(count, 81);
}

fn published_frame(case: &Value, model: &str) -> Option<Frame> {
    let texts = |list: &Value| -> Vec<String> {
        let list = list.as_array().expect("a list").iter();
        list.map(|text| text.as_str().expect("a string").to_owned()).collect()
    };
    let atoms = texts(&case["frame"]);
    let frame = match &case[model] {
        Value::Null => return None,
        Value::String(name) if name == "free" => Frame::free(atoms),
        Value::String(name) if name == "shafer" => Frame::shafer(atoms),
        hybrid => {
            let empty = texts(&hybrid["empty"]);
            Frame::with_empty(atoms, &empty.iter().map(String::as_str).collect::<Vec<_>>())
        }
    };
    Some(frame.expect("a frame"))
}

fn published(masses: &Value, frame: &Frame) -> Body {
    let masses = masses.as_object().expect("masses").iter();
    let read = |(text, mass): (&String, &Value)| {
        let set = read(frame, frame.parse(text).expect("an element"));
        (set, Exact::from_f64(mass.as_f64().expect("a number")))
    };
    masses.map(read).collect()
}

/// Weights of I, NI, I ∪ NI and I ∩ NI on one cell, often 0.
fn cell() -> impl Strategy<Value = [u32; 4]> {
    let mass = || prop_oneof![1 => Just(0), 2 => weight()];
    [mass(), mass(), mass(), mass()]
        .prop_filter("some mass", |masses| masses.iter().sum::<u32>() > 0)
}

/// What becomes of the paradox of one source, by the name of the policy, before a rule on Shafer's model.
fn paradox_moved([i, n, u, p]: [Exact; 4], policy: ParadoxPolicy) -> [Exact; 4] {
    let (zero, one, two) = (Exact::zero(), Exact::one(), Exact::count(2));
    match policy {
        ParadoxPolicy::ToIgnorance => [i, n, u + p, zero],
        ParadoxPolicy::Split => [i + p / two, n + p / two, u, zero],
        ParadoxPolicy::Renormalise if p == one => [zero, zero, one, zero],
        ParadoxPolicy::Renormalise => {
            let [i, n, u] = [i, n, u].map(|mass| mass / (one - p));
            [i, n, u, zero]
        }
        _ => [i, n, u, p],
    }
}

/// The four elements under a model: I, NI, I ∪ NI, and I ∩ NI or ∅.
fn four(venn: &Venn) -> [Set; 4] {
    let [i, n] = [0, 1].map(|atom| venn.atom(atom));
    [i.clone(), n.clone(), &i | &n, &i & &n]
}

/// One cell's question: the free model for the rule that keeps paradox, or the one whose sources may have any.
fn cell_question(rule: Rule, cells: &[[Exact; 4]], policy: ParadoxPolicy, k: f64) -> Question {
    let (free, exclusive) = (Venn::without(2, &[]), Venn::exclusive(2));
    let keeps = policy == ParadoxPolicy::KeepForDsmh;
    let (venn, given) = match rule {
        Rule::Dsmc => (free, None),
        _ if keeps => (exclusive, Some(free)),
        _ => (exclusive, None),
    };
    let elements = four(given.as_ref().unwrap_or(&venn));
    let body = |&masses: &[Exact; 4]| {
        let masses = if rule == Rule::Dsmc { masses } else { paradox_moved(masses, policy) };
        let all = elements.iter().cloned().zip(masses);
        all.filter(|(_, mass)| *mass > Exact::zero()).collect()
    };
    let weights = WEIGHTS.iter().cycle().take(cells.len());
    Question {
        sources: cells.iter().map(body).collect(),
        given,
        venn,
        inagaki_k: Exact::from_f64(k),
        weights: Some(weights.map(|&weight| Exact::from_f64(weight)).collect()),
    }
}

/// The definition's four masses and K; where the rule is undefined, the vacuous ones and 1.
fn cell_answer(rule: Rule, question: &Question) -> ([Exact; 4], Exact) {
    let (zero, one) = (Exact::zero(), Exact::one());
    let Ok(answer) = question.answer(rule) else { return ([zero, zero, one, zero], one) };
    let meets = Question { sources: question.seen(), given: None, ..question.clone() };
    let meets = meets.answer(Rule::Conjunctive).expect("always defined");
    let of = |body: &Body, set: &Set| body.get(set).copied().unwrap_or(zero);
    (four(&question.venn).map(|set| of(&answer, &set)), of(&meets, &Set::new()))
}

fn largest_difference<F: Number>(
    fused: &Fused<F>,
    (masses, conflict): ([Exact; 4], Exact),
    number: impl Fn(F) -> Exact,
) -> f64 {
    let pairs = fused.mass.masses().into_iter().zip(masses).chain([(fused.conflict, conflict)]);
    pairs.fold(0.0, |most, (found, wanted)| most.max((number(found) - wanted).to_f64().abs()))
}

/// How the library's closed form, in three number types, differs from the definition.
fn cell_disagreements(
    rule: Rule,
    cells: &[[u32; 4]],
    policy: ParadoxPolicy,
    k: f64,
) -> Vec<String> {
    Exact::forget_all();
    let ratios = |cell: &[u32; 4]| cell.map(|weight| Exact::ratio(weight, cell.iter().sum()));
    let cells: Vec<[Exact; 4]> = cells.iter().map(ratios).collect();
    let weights: Vec<f64> = WEIGHTS.iter().cycle().take(cells.len()).copied().collect();
    let mut settings = Settings::default().with_inagaki_k(k);
    if rule == Rule::Average {
        settings = settings.with_weights(&weights);
    }
    let wanted = cell_answer(rule, &cell_question(rule, &cells, policy, k));
    let exact = cells.iter().map(|&cell| InterestMass::from_masses(cell).expect("masses"));
    let exact: Vec<InterestMass<Exact>> = exact.collect();
    let double: Vec<InterestMass> = exact.iter().map(|cell| cell.to()).collect();
    let single: Vec<InterestMass<f32>> = exact.iter().map(|cell| cell.to()).collect();
    let exact = rule.fuse_with(&exact, policy, &settings).expect("admitted");
    let double = rule.fuse_with(&double, policy, &settings).expect("admitted");
    let single = rule.fuse_with(&single, policy, &settings).expect("admitted");
    let (root, sources) = (if rule == Rule::Deng { ROOT } else { 0.0 }, cells.len() as f64);
    let mut found = Vec::new();
    let equal = (exact.mass.masses(), exact.conflict) == wanted;
    if !equal && (rule != Rule::Deng || largest_difference(&exact, wanted, |mass| mass) > root) {
        found.push(format!("{rule}, {policy}: {exact:?}, not {wanted:?}"));
    }
    let off = largest_difference(&double, wanted, of_double);
    if off > F64_PER_SOURCE * sources {
        found.push(format!("{rule}, {policy}: f64 is off by {off:e}"));
    }
    let off = largest_difference(&single, wanted, of_single);
    if off > F32 {
        found.push(format!("{rule}, {policy}: f32 is off by {off:e}"));
    }
    found
}

proptest! {
    /// Exactly, but for Deng's square roots; and in floating point as far as the general algorithm is held to.
    #[test]
    fn every_closed_form_is_its_definition(
        cells in prop::collection::vec(cell(), 1..=4),
        policy in prop::sample::select(ParadoxPolicy::ALL.to_vec()),
        k in any_k(),
    ) {
        let rules = Rule::ALL.into_iter().filter(|rule| rule.admits(policy));
        let found: Vec<String> =
            rules.flat_map(|rule| cell_disagreements(rule, &cells, policy, k)).collect();
        prop_assert!(found.is_empty(), "{}", found.join("\n"));
    }
}
