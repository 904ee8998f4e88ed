//! All elements of a frame, and the transforms over them, on every model.

mod bodies;

use std::collections::BTreeSet;

use bodies::{Ratio, any_bodies, body, frames};
use proptest::prelude::*;
use wisdom_belief::{
    BeliefError, Element, Frame, Lattice, MAX_DENSE_ELEMENTS, MassFunction, Number,
};

const NAMES: [&str; 7] = ["A", "B", "C", "D", "E", "F", "G"];

fn free(n: usize) -> Frame {
    Frame::free(NAMES.into_iter().take(n)).expect("a frame")
}

/// The closure of the atoms under ∩ and ∪, with ∅.
fn closure(frame: &Frame) -> BTreeSet<Element> {
    let mut all: BTreeSet<Element> =
        (0..frame.atoms().len()).filter_map(|atom| frame.atom(atom)).collect();
    all.insert(Element::EMPTY);
    loop {
        let of_two = |&a: &Element| all.iter().flat_map(move |&b| [a & b, a | b]);
        let more: Vec<Element> = all.iter().flat_map(of_two).collect();
        let before = all.len();
        all.extend(more);
        if all.len() == before {
            return all;
        }
    }
}

/// |D^Θ| of one to six atoms (Dezert and Smarandache 2003).
#[test]
fn free_frames_have_dedekind_many_elements_and_yield_them_all() {
    for (n, known) in (1..).zip([2, 5, 19, 167, 7580, 7_828_353]) {
        assert_eq!(free(n).elements().count(), known, "{n} atoms");
        assert_eq!(free(n).element_count(), known as u128);
    }
    assert_eq!(free(7).element_count(), 2_414_682_040_997);
}

#[test]
fn elements_are_those_that_atoms_make_each_once_in_rising_order() {
    for frame in frames().into_iter().chain([free(1), free(4)]) {
        let elements: Vec<Element> = frame.elements().collect();
        assert!(elements.is_sorted_by(|a, b| a.regions() < b.regions()), "{frame:?}");
        assert_eq!(elements.iter().copied().collect::<BTreeSet<_>>(), closure(&frame), "{frame:?}");
        assert_eq!(elements.len() as u128, frame.element_count(), "{frame:?}");
    }
}

#[test]
fn larger_hybrid_frames_are_counted_as_they_are_walked() {
    for empty in [&["A & B"][..], &["A & B & C", "D & E", "F"], &["A & B & C & D & E & F"]] {
        let frame = Frame::with_empty(NAMES[..6].to_vec(), empty).expect("a frame");
        let mut last = None;
        for element in frame.elements() {
            assert!(last < Some(element.regions()), "{empty:?}");
            last = Some(element.regions());
        }
        assert_eq!(frame.elements().count() as u128, frame.element_count(), "{empty:?}");
        assert!(frame.elements().step_by(997).all(|element| frame.contains(element)));
    }
}

/// Where no three of seven atoms meet, an element is a choice of k whole atoms and of pairs among the others:
/// Σ C(7, k) 2^C(7 − k, 2) = 2 350 602.
#[test]
fn seven_atoms_that_meet_in_pairs_only_have_as_many_elements_as_graphs() {
    let triples: Vec<String> = (0..7)
        .flat_map(|c| (0..c).flat_map(move |b| (0..b).map(move |a| [a, b, c])))
        .map(|triple| triple.map(|atom| NAMES[atom]).join(" & "))
        .collect();
    let triples: Vec<&str> = triples.iter().map(String::as_str).collect();
    let frame = Frame::with_empty(NAMES, &triples).expect("a frame");
    assert_eq!(frame.element_count(), 2_350_602);
    assert_eq!(frame.elements().count(), 2_350_602);
}

#[test]
fn frames_too_large_to_walk_still_yield_their_first_elements() {
    let seven = free(7);
    let first: Vec<Element> = seven.elements().take(10_000).collect();
    assert!(first.iter().all(|&element| seven.contains(element)));
    assert!(first.is_sorted_by(|a, b| a.regions() < b.regions()));
    let wide = Frame::shafer((0..64).map(|atom| format!("t{atom}"))).expect("64 atoms");
    assert_eq!(wide.elements().nth(5).map(Element::regions), Some(5));
    assert_eq!(wide.element_count(), 1 << 64);
}

#[test]
fn lattices_stop_at_their_limit() {
    let refused = Lattice::new(&free(6)).map(|_| ());
    assert_eq!(refused, Err(BeliefError::TooManyElements { limit: MAX_DENSE_ELEMENTS }));
    let lattice = Lattice::new(&free(2)).expect("five elements");
    let few = lattice.mass_function(&[0.5, 0.5]);
    assert_eq!(few, Err(BeliefError::ValueCount { found: 2, expected: 5 }));
    let foreign = lattice.masses(&MassFunction::<f64>::vacuous(&free(3)));
    assert!(matches!(foreign, Err(BeliefError::ForeignElement { .. })));
}

/// Both dense transforms and their inverses, against sums over all elements.
fn check_dense(frame: &Frame, m: &MassFunction<Ratio>) {
    let lattice = Lattice::new(frame).expect("a small frame");
    let masses = lattice.masses(m).expect("of this frame");
    let [mut q, mut b] = [masses.clone(), masses.clone()];
    lattice.to_commonalities(&mut q);
    lattice.to_implicabilities(&mut b);
    for (index, &element) in lattice.elements().iter().enumerate() {
        assert_eq!(q[index], m.commonality(element), "q({})", frame.print(element));
        assert_eq!(b[index], m.implicability(element), "b({})", frame.print(element));
    }
    lattice.from_commonalities(&mut q);
    lattice.from_implicabilities(&mut b);
    assert_eq!([&q, &b], [&masses, &masses]);
    assert_eq!(lattice.mass_function(&q).as_ref(), Ok(m));
}

/// The sparse forms, against the definition on every element.
fn check_sparse(frame: &Frame, m: &MassFunction<Ratio>) {
    let (q, b) = (m.commonalities().expect("few"), m.implicabilities().expect("few"));
    for element in frame.elements() {
        assert_eq!(q.of(element), m.commonality(element), "q({})", frame.print(element));
        assert_eq!(b.of(element), m.implicability(element), "b({})", frame.print(element));
    }
    assert_eq!(q.to_masses(frame).as_ref(), Ok(m));
    assert_eq!(b.to_masses(frame).as_ref(), Ok(m));
}

proptest! {
    #[test]
    fn transforms_agree_with_their_definition_and_invert_exactly(
        (frame, numbers) in any_bodies(1),
        open in any::<bool>(),
    ) {
        let also: &[Element] = if open { &[Element::EMPTY] } else { &[] };
        let m = body(&frame, &numbers[0], also);
        check_dense(&frame, &m);
        check_sparse(&frame, &m);
    }

    /// Masses of any sign: the transforms are linear, whatever they are given.
    #[test]
    fn transforms_invert_on_any_values(values in prop::collection::vec(-9..9_i128, 167)) {
        let lattice = Lattice::new(&free(4)).expect("167 elements");
        let values: Vec<Ratio> = values.into_iter().map(|value| Ratio::new(value, 1)).collect();
        let mut there = values.clone();
        lattice.to_commonalities(&mut there);
        for (&element, &q) in lattice.elements().iter().zip(&there) {
            let above = lattice.elements().iter().zip(&values).filter(|(b, _)| element.is_subset_of(**b));
            prop_assert_eq!(q, above.fold(Ratio::zero(), |sum, (_, &value)| sum + value));
        }
        lattice.from_commonalities(&mut there);
        prop_assert_eq!(&there, &values);
        lattice.to_implicabilities(&mut there);
        lattice.from_implicabilities(&mut there);
        prop_assert_eq!(&there, &values);
    }
}

/// Rounded to binary, a body comes back with errors of some units in the last place of 1, times the additions.
const ROUNDING: f64 = 1e-12;

proptest! {
    #[test]
    fn in_floating_point_the_way_back_ends_close_to_the_start((frame, numbers) in any_bodies(1)) {
        let exact = body(&frame, &numbers[0], &[]);
        let masses = exact.focal().iter().map(|&(element, mass)| (element, mass.to_f64()));
        let m = MassFunction::new(&frame, masses).expect("masses");
        let lattice = Lattice::new(&frame).expect("a small frame");
        let mut values = lattice.masses(&m).expect("of this frame");
        lattice.to_commonalities(&mut values);
        lattice.from_commonalities(&mut values);
        let ways = [
            lattice.mass_function(&values),
            m.commonalities().and_then(|q| q.to_masses(&frame)),
            m.implicabilities().and_then(|b| b.to_masses(&frame)),
        ];
        for back in ways {
            let back = back.expect("rounded zeros are zeros");
            for element in frame.elements() {
                prop_assert!((back.mass(element) - m.mass(element)).abs() < ROUNDING);
            }
        }
    }
}

#[test]
fn values_that_are_no_masses_are_refused() {
    let frame = free(2);
    let lattice = Lattice::new(&frame).expect("five elements");
    let negative = lattice.mass_function(&[0.0, -0.25, 0.5, 0.5, 0.25]);
    let element = "A & B".to_owned();
    assert_eq!(negative, Err(BeliefError::OutOfRange { element, mass: -0.25 }));
    let nan = lattice.mass_function(&[0.0, f64::NAN, 0.5, 0.5, 0.0]);
    assert!(matches!(nan, Err(BeliefError::OutOfRange { .. })));
    let half = lattice.mass_function(&[0.0, 0.0, 0.25, 0.25, 0.0]);
    assert_eq!(half, Err(BeliefError::SumNotOne { sum: 0.5 }));
}

#[test]
fn five_free_atoms_transform_exactly() {
    let frame = free(5);
    let focal = ["A & B", "A | C & D", "(B | E) & C", "Theta"];
    let m = MassFunction::parse(&frame, focal.map(|text| (text, Ratio::new(1, 4))));
    check_dense(&frame, &m.expect("masses"));
}
