//! A workspace that has grown to the size of its work allocates nothing more.

use wisdom_belief::rule::{Settings, Workspace};
use wisdom_belief::{Frame, MassFunction, Rule};

fn bodies(frame: &Frame, texts: [[&str; 4]; 3]) -> Vec<MassFunction> {
    let body = |texts: [&str; 4]| {
        MassFunction::parse(frame, texts.into_iter().zip([0.4, 0.3, 0.2, 0.1])).expect("masses")
    };
    texts.map(body).to_vec()
}

#[test]
fn combining_again_allocates_nothing() {
    let free = Frame::free(["A", "B", "C", "D", "E", "F", "G"]).expect("a frame");
    let shafer = Frame::shafer(["A", "B", "C", "D"]).expect("a frame");
    let overlapping = bodies(
        &free,
        [
            ["A", "B & C", "D | E", "Theta"],
            ["F", "A & G", "B", "C"],
            ["G", "E & (A | F)", "B | D", "C"],
        ],
    );
    let exclusive = bodies(
        &shafer,
        [["A", "B", "C | D", "Theta"], ["B", "A | B", "C", "Theta"], ["D", "A", "B | C", "Theta"]],
    );
    let rules = [
        Rule::Conjunctive,
        Rule::Dsmc,
        Rule::Dempster,
        Rule::Disjunctive,
        Rule::Yager,
        Rule::DuboisPrade,
        Rule::Inagaki,
        Rule::Dsmh,
        Rule::Jaccard,
        Rule::Pcr1,
        Rule::Pcr2,
        Rule::Pcr5,
        Rule::Pcr5Plus,
        Rule::Pcr6,
        Rule::Pcr6Plus,
        Rule::Urr,
        Rule::Purr,
    ];
    for rule in rules {
        let (frame, sources) =
            if rule == Rule::Dsmc { (&free, &overlapping) } else { (&shafer, &exclusive) };
        let mut workspace = Workspace::new();
        let settings = Settings::default();
        let mut combine = || {
            let fused = workspace.combine_with(rule, sources, frame, &settings);
            assert!(fused.expect("no total conflict").focal().len() > 3, "{rule}");
        };
        let first = allocation_counter::measure(&mut combine);
        assert!(first.count_total > 0, "{rule}: the counter counts");
        let again = allocation_counter::measure(&mut combine);
        assert_eq!(again.count_total, 0, "{rule}");
    }
}
