//! Frames, elements, expressions; and what is refused.

use proptest::prelude::*;
use wisdom_belief::{
    BeliefError, Element, Frame, InterestMass, MassFunction, Model, Opinion, ParadoxPolicy, Rule,
    Uncertainty, rule,
};

fn abc() -> Frame {
    Frame::free(["A", "B", "C"]).expect("a frame")
}

/// All elements of a frame: the closure of its atoms under ∩ and ∪.
fn all_elements(frame: &Frame) -> Vec<Element> {
    let mut all: std::collections::BTreeSet<Element> =
        (0..frame.atoms().len()).filter_map(|atom| frame.atom(atom)).collect();
    all.insert(Element::EMPTY);
    loop {
        let more: Vec<Element> =
            all.iter().flat_map(|&a| all.iter().flat_map(move |&b| [a & b, a | b])).collect();
        let before = all.len();
        all.extend(more);
        if all.len() == before {
            return all.into_iter().collect();
        }
    }
}

/// |D^Θ|, with ∅, is 2, 5, 19, 167 for one to four atoms (Dezert and Smarandache 2003; Dedekind numbers).
#[test]
fn the_hyper_power_set_has_its_known_sizes() {
    let names = ["A", "B", "C", "D"];
    let sizes: Vec<usize> = (1..=4)
        .map(|n| all_elements(&Frame::free(names[..n].to_vec()).expect("a frame")).len())
        .collect();
    assert_eq!(sizes, [2, 5, 19, 167]);
    assert_eq!(all_elements(&Frame::shafer(names).expect("a frame")).len(), 16);
}

#[test]
fn every_element_reads_back_as_printed() {
    let frames = [
        Frame::free(["A", "B", "C", "D"]),
        Frame::shafer(["A", "B", "C", "D"]),
        Frame::with_empty(["A", "B", "C", "D"], &["A & B", "C & D & A"]),
        Frame::with_empty(["A", "B", "C"], &["A"]),
    ];
    for frame in frames {
        let frame = frame.expect("a frame");
        for element in all_elements(&frame) {
            let text = frame.print(element);
            assert_eq!(frame.parse(&text), Ok(element), "{text}");
            assert!(frame.contains(element), "{text}");
        }
    }
}

#[test]
fn elements_print_in_their_shorter_form() {
    let frame = abc();
    for (text, printed) in [
        ("A&B|A&C", "A & (B | C)"),
        ("(A|B)&(A|C)", "A | B & C"),
        ("A&B|B&C|A&C", "A & B | A & C | B & C"),
        ("C & (A | B)", "(A | B) & C"),
        ("A|(B|(C))", "Theta"),
        ("A & empty", "empty"),
        ("B | A", "A | B"),
    ] {
        assert_eq!(frame.print(frame.parse(text).expect(text)), printed);
    }
}

#[test]
fn intersection_binds_tighter_than_union() {
    let frame = abc();
    assert_eq!(frame.parse("A | B & C"), frame.parse("A | (B & C)"));
    assert_ne!(frame.parse("A | B & C"), frame.parse("(A | B) & C"));
}

#[test]
fn a_bad_expression_says_where_and_what() {
    let frame = abc();
    let fault = |text: &str| match frame.parse(text) {
        Err(BeliefError::Expression { at, expected, .. }) => (at, expected),
        other => panic!("{text}: {other:?}"),
    };
    assert_eq!(fault(""), (0, "an atom, `empty`, `Theta` or `(`"));
    assert_eq!(fault("A & "), (4, "an atom, `empty`, `Theta` or `(`"));
    assert_eq!(fault("(A | B"), (6, "`)`"));
    assert_eq!(fault("A B"), (2, "`&`, `|` or the end"));
    let deep = "(".repeat(100_000);
    assert_eq!(fault(&deep).1, "at most 64 parentheses within each other");
    let unknown = frame.parse("A & Ω").expect_err("no such atom").to_string();
    assert_eq!(unknown, "expression \"A & Ω\", byte 4: `Ω` is not an atom; known: A, B, C");
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(text in "[ABC&|() é]{0,40}") {
        let frame = abc();
        if let Ok(element) = frame.parse(&text) {
            prop_assert!(frame.contains(element));
        }
    }
}

#[test]
fn frames_hold_as_many_atoms_as_their_model_allows() {
    let names = |n: usize| (0..n).map(|atom| format!("t{atom}")).collect::<Vec<_>>();
    let seven = Frame::free(names(7)).expect("seven overlapping atoms");
    assert_eq!(seven.theta().cardinality(), 127);
    assert_eq!(seven.parse("t0 & t1 & t2 & t3 & t4 & t5 & t6").expect("all").cardinality(), 1);
    assert_eq!(seven.parse("t6").expect("an atom").cardinality(), 64);
    assert_eq!(Frame::shafer(names(64)).expect("64 atoms").theta().cardinality(), 64);
    assert_eq!(Frame::free(names(8)), Err(BeliefError::FrameSize { atoms: 8, limit: 7 }));
    assert_eq!(Frame::shafer(names(65)), Err(BeliefError::FrameSize { atoms: 65, limit: 64 }));
    assert_eq!(Frame::shafer(names(0)), Err(BeliefError::FrameSize { atoms: 0, limit: 64 }));
}

#[test]
fn bad_atoms_and_models_are_refused() {
    let name = |name: &str| BeliefError::AtomName { name: name.to_owned() };
    assert_eq!(Frame::free(["A", "Theta"]), Err(name("Theta")));
    assert_eq!(Frame::free(["A b"]), Err(name("A b")));
    assert_eq!(Frame::free(["A", "A"]), Err(BeliefError::RepeatedAtom { name: "A".to_owned() }));
    let nothing = Frame::with_empty(["A", "B"], &["A", "B"]);
    assert_eq!(nothing, Err(BeliefError::EmptyFrame { atoms: "A, B".to_owned() }));
    let theta = abc().theta();
    let foreign = Frame::new(["A", "B"], Model::Hybrid { empty: vec![theta] });
    assert!(matches!(foreign, Err(BeliefError::ForeignElement { .. })));
}

#[test]
fn an_element_of_another_frame_is_refused() {
    let (free, shafer) = (abc(), Frame::shafer(["A", "B", "C"]).expect("a frame"));
    // Bit 0 alone: atom A under Shafer's model, but "A and nothing else" on the free one, which D^Θ lacks.
    let a = shafer.parse("A").expect("an atom");
    assert!(!free.contains(a));
    let sure = MassFunction::new(&shafer, [(a, 1.0)]).expect("a body");
    for rule in Rule::ALL {
        let mixed = rule::combine(rule, std::slice::from_ref(&sure), &free);
        assert!(matches!(mixed, Err(BeliefError::ForeignElement { .. })), "{rule}");
    }
}

#[test]
fn refining_needs_a_name_for_each_region() {
    let free = abc();
    let few = free.refined(["X", "Y"]);
    assert_eq!(few, Err(BeliefError::RegionNames { names: 2, regions: 7 }));
    let refined = free.refined(["ABC", "AB", "AC", "BC", "a", "b", "c"]).expect("seven regions");
    let a = refined.element(free.parse("A").expect("an atom"));
    assert_eq!(refined.frame().print(a), "ABC | AB | AC | a");
}

#[test]
fn bad_masses_are_refused() {
    let frame = abc();
    let body = |masses: &[(&'static str, f64)]| MassFunction::parse(&frame, masses.iter().copied());
    let at = |mass| BeliefError::OutOfRange { element: "A".to_owned(), mass };
    assert_eq!(body(&[("A", -0.1), ("B", 1.1)]), Err(at(-0.1)));
    assert_eq!(body(&[("A", 1.5)]), Err(at(1.5)));
    assert!(matches!(body(&[("A", f64::NAN)]), Err(BeliefError::OutOfRange { .. })));
    assert_eq!(body(&[("A", 0.4), ("B", 0.5)]), Err(BeliefError::SumNotOne { sum: 0.9 }));
    assert_eq!(
        body(&[("A & B", 0.5), ("B & A", 0.5)]),
        Err(BeliefError::RepeatedElement { element: "A & B".to_owned() })
    );
    assert!(
        body(&[("A", 0.1), ("B", 0.2), ("C", 0.7)]).is_ok(),
        "decimals need not add up to the bit"
    );
}

#[test]
fn bad_opinions_and_uncertainties_are_refused() {
    let opinion = |interesting, not_interesting| Opinion {
        interesting,
        not_interesting,
        ..Opinion::default()
    };
    let sum = InterestMass::try_from(opinion(0.8, 0.5)).expect_err("more than all mass");
    assert_eq!(sum, BeliefError::SumAboveOne { sum: 1.3 });
    assert!(InterestMass::try_from(opinion(f64::NAN, 0.5)).is_err());
    assert!(InterestMass::try_from(opinion(-0.1, 0.5)).is_err());
    assert_eq!(
        InterestMass::new(opinion(0.5, 0.25), 0.5),
        Err(BeliefError::SumNotOne { sum: 1.25 })
    );
    for value in [-0.1, 1.1, f64::INFINITY] {
        assert_eq!(Uncertainty::new(value), Err(BeliefError::Uncertainty { value }));
    }
    assert!(Uncertainty::new(f64::NAN).is_err());
}

/// 1 − (0.3 + 0.6 + 0.1) is 1e-16 in binary; an opinion written so claims no ignorance.
#[test]
fn the_rounding_of_decimals_is_not_ignorance() {
    let row = Opinion { paradox: 0.3, not_interesting: 0.6, interesting: 0.1 };
    assert_eq!(InterestMass::try_from(row).expect("a row of Table 1").ignorance(), 0.0);
    let half = Opinion { interesting: 0.5, ..Opinion::default() };
    assert_eq!(InterestMass::try_from(half).expect("half known").ignorance(), 0.5);
}

#[test]
fn mass_on_the_empty_element_is_refused_where_it_has_no_meaning() {
    let frame = Frame::free(["A", "B"]).expect("a frame");
    let open = MassFunction::parse(&frame, [("empty", 0.25), ("A", 0.75)]).expect("a body");
    for rule in [Rule::Dsmc, Rule::Pcr6] {
        assert_eq!(
            rule::combine(rule, std::slice::from_ref(&open), &frame),
            Err(BeliefError::MassOnEmpty { index: 0, mass: 0.25, rule })
        );
    }
    assert_eq!(open.pignistic(frame.parse("A").expect("an atom")), 1.0);
}

#[test]
fn pcr6_refuses_more_products_than_it_could_visit() {
    let frame = Frame::shafer(["A", "B"]).expect("a frame");
    let body = MassFunction::parse(&frame, [("A", 0.5), ("B", 0.5)]).expect("a body");
    let refused = rule::combine(Rule::Pcr6, &vec![body; 70], &frame);
    assert!(matches!(refused, Err(BeliefError::TooManyProducts { products: u64::MAX, .. })));
}

#[test]
fn names_of_rules_and_policies_read_back_and_unknown_ones_list_the_known() {
    for rule in Rule::ALL {
        assert_eq!(rule.to_string().parse(), Ok(rule));
    }
    for policy in ParadoxPolicy::ALL {
        assert_eq!(policy.to_string().parse(), Ok(policy));
    }
    assert_eq!("pcr5_plus".parse(), Ok(Rule::Pcr5Plus));
    let names = Rule::ALL.map(Rule::name).join(", ");
    let error = "dempsters".parse::<Rule>().expect_err("not a rule").to_string();
    assert_eq!(error, format!("unknown rule `dempsters`; known: {names}"));
    let names = ParadoxPolicy::ALL.map(ParadoxPolicy::name).join(", ");
    let error = "drop".parse::<ParadoxPolicy>().expect_err("not a policy").to_string();
    assert_eq!(error, format!("unknown paradox policy `drop`; known: {names}"));
}
