//! Very many sources, very large and very small numbers: an answer or an error, and never a wrong one.

use wisdom_belief::rule::{self, Settings};
use wisdom_belief::{BeliefError, Element, Frame, MassFunction, Rule};

fn shafer(n: usize) -> Frame {
    Frame::shafer((0..n).map(|atom| format!("x{atom}"))).expect("a frame")
}

fn body<'a>(frame: &Frame, masses: impl IntoIterator<Item = (&'a str, f64)>) -> MassFunction {
    MassFunction::parse(frame, masses).expect("a mass function")
}

/// No rule recurses over its sources: a hundred thousand that say one thing each are fused or refused, on a
/// stack as small as those of worker threads.
#[test]
fn no_number_of_sources_is_too_many_to_be_answered() {
    let frame = Frame::free(["x0", "x1"]).expect("a frame");
    let sources = vec![body(&frame, [("x0", 1.0)]); 100_000];
    let answers = std::thread::Builder::new()
        .stack_size(256 << 10)
        .spawn(move || {
            Rule::ALL.map(|rule| match rule::combine(rule, &sources, &frame) {
                Ok(fused) => (fused.mass(frame.atom(0).expect("x0")) - 1.0).abs() < 1e-9,
                Err(BeliefError::TooManySources { sources: 100_000, limit, .. }) => limit > 1000,
                Err(BeliefError::Dogmatic { index: 0 }) => rule == Rule::Cautious,
                Err(BeliefError::Normal { index: 0 }) => rule == Rule::Bold,
                Err(_) => false,
            })
        })
        .expect("a thread")
        .join()
        .expect("no rule panics");
    for (rule, sound) in Rule::ALL.into_iter().zip(answers) {
        assert!(sound, "{rule}");
    }
}

#[test]
fn a_thousand_sources_are_walked() {
    let frame = shafer(3);
    let mut sources = vec![body(&frame, [("x0 | x1", 1.0)]); 1000];
    sources.push(body(&frame, [("x2", 0.5), ("Theta", 0.5)]));
    for rule in [Rule::Pcr6, Rule::Pcr6Plus, Rule::DuboisPrade, Rule::Purr, Rule::MinC] {
        let fused = rule::combine(rule, &sources, &frame).expect("two products");
        assert!((fused.sum() - 1.0).abs() < 1e-9, "{rule}");
    }
}

/// Focal elements that double with every source stop at an error, not at the end of memory.
#[test]
fn what_grows_beyond_all_use_is_refused() {
    let frame = shafer(64);
    let but_one = |atom: usize| {
        Element::EMPTY | {
            let others = (0..64).filter(|&other| other != atom);
            others.fold(Element::EMPTY, |all, other| all | frame.atom(other).expect("an atom"))
        }
    };
    let simple =
        |atom| MassFunction::new(&frame, [(but_one(atom), 0.5), (frame.theta(), 0.5)]).expect("m");
    let sources: Vec<MassFunction> = (0..64).map(simple).collect();
    for rule in [Rule::Conjunctive, Rule::Dempster, Rule::Yager, Rule::Zhang, Rule::Cautious] {
        let found = rule::combine(rule, &sources, &frame);
        assert!(matches!(found, Err(BeliefError::TooManyElements { .. })), "{rule}");
    }
    let atoms: Vec<(Element, f64)> =
        (0..64).map(|atom| (frame.atom(atom).expect("an atom"), 0.5)).collect();
    let first = MassFunction::new(&frame, [(frame.atom(0).expect("an atom"), 1.0)]).expect("m");
    let corrected = first.contextually_discounted(&atoms, &frame);
    assert!(matches!(corrected, Err(BeliefError::TooManyElements { .. })));
}

/// Products of a thousand masses lie below the least double; what survives of them does not.
#[test]
fn rules_that_scale_what_survives_do_not_mistake_small_for_nothing() {
    let frame = shafer(2);
    let (x0, x1) = (frame.atom(0).expect("x0"), frame.atom(1).expect("x1"));
    let undecided = vec![body(&frame, [("x0", 0.5), ("x1", 0.5)]); 1100];
    for rule in [Rule::Dempster, Rule::Murphy, Rule::Deng, Rule::Zhang] {
        let fused = rule::combine(rule, &undecided, &frame).expect("no total conflict");
        assert_eq!((fused.mass(x0), fused.mass(x1)), (0.5, 0.5), "{rule}");
    }
    let wide = shafer(64);
    let mut sources = vec![MassFunction::vacuous(&wide); 180];
    let said = body(&wide, [("x0", 0.5), ("Theta", 0.5)]);
    sources.push(said.clone());
    assert_eq!(rule::combine(Rule::Zhang, &sources, &wide), Ok(said));
    let single = Frame::shafer(["A", "B"]).expect("a frame");
    let opposed = [("A", 0.999_f32), ("B", 0.001)];
    let opposed = MassFunction::parse(&single, opposed).expect("m");
    let fused = rule::combine(Rule::Dempster, &vec![opposed; 100], &single).expect("it survives");
    assert_eq!(fused.mass(single.parse("A").expect("A")), 1.0);
}

#[test]
fn weights_count_by_their_ratios_however_large() {
    let frame = shafer(2);
    let sources = [body(&frame, [("x0", 1.0)]), body(&frame, [("x1", 1.0)])];
    for scale in [1e-300, 1.0, 1e307] {
        let weights = [scale, 3.0 * scale];
        let settings = Settings::default().with_weights(&weights);
        let mean = rule::combine_with(Rule::Average, &sources, &frame, &settings).expect("a mean");
        assert!((mean.mass(frame.atom(0).expect("x0")) - 0.25).abs() < 1e-15, "{scale}");
    }
}

#[test]
fn an_epsilon_that_sums_cannot_hold_is_refused() {
    let frame = shafer(2);
    let m = body(&frame, [("x0", 0.4), ("Theta", 0.6)]);
    let x0 = frame.atom(0).expect("x0");
    let large = m.dsmp_distribution(1e30, &frame).expect("in range").probability(x0);
    assert!((large - m.pignistic(x0)).abs() < 1e-12, "all ignorance is shared evenly");
    for epsilon in [-1.0, 1e300, f64::INFINITY, f64::NAN] {
        let refused = m.dsmp_distribution(epsilon, &frame);
        assert!(
            matches!(refused, Err(BeliefError::Parameter { name: "epsilon", .. })),
            "{epsilon}"
        );
    }
}

#[test]
fn what_is_taken_back_leaves_no_crumbs() {
    let frame = shafer(3);
    let part = body(&frame, [("x0 | x1", 0.3), ("x2", 0.2), ("Theta", 0.5)]);
    let rest = body(&frame, [("x0", 0.35), ("x1 | x2", 0.45), ("Theta", 0.2)]);
    let whole = rule::conjunctive(&[part.clone(), rest.clone()], &frame).expect("one frame");
    let found = whole.decombined(&part, &frame).expect("it was combined");
    assert_eq!(found.focal().len(), rest.focal().len(), "{found:?}");
}
