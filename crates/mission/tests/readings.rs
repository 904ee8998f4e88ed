//! Readings that are handed in: they reach the rover when their time has come, as observations like any other, and what
//! is wrong with one is said.

mod small;

use wisdom_autonomy::{Decision, LayerWindow, Maps, Message, Observation, Outcome};
use wisdom_grid::{Cell, Window};
use wisdom_mission::{
    FaultEvent, Mission, MissionError, RecordError, Recorder, Ruler, RunSummary, run,
};

/// A layer of which nothing is known but what is handed in, and an expert for it.
const SILICA: &str = "\
[[layer]]
name = \"silica\"
unit = \"%\"
handed-in = true
";

const TABLE: &str = "\
name = \"silica\"
layer = \"silica\"
quantity = \"SiO2\"
unit = \"%\"

[[band]]
from = 60.0
paradox = 0.05
not-interesting = 0.0
interesting = 0.95

[outside]
paradox = 0.2
not-interesting = 0.8
interesting = 0.0
";

/// The small mission with the silica layer, its expert, and some readings.
fn mission(readings: &str, changes: &[(&str, &str)]) -> Result<Mission, MissionError> {
    let mut files = small::files(small::LEVEL);
    files.insert("experts/silica.toml".into(), TABLE.into());
    let text = std::str::from_utf8(&files["mission.toml"]).expect("it is text");
    let mut text = text
        .replacen(
            "\"experts/texture.toml\"]",
            "\"experts/texture.toml\", \"experts/silica.toml\"]",
            1,
        )
        .replacen("[prior]", &format!("{SILICA}\n[prior]"), 1);
    text.push_str(readings);
    for (from, to) in changes {
        assert!(text.contains(from), "`{from}` is not in the mission");
        text = text.replacen(from, to, 1);
    }
    files.insert("mission.toml".into(), text.into_bytes());
    Mission::from_files(&files)
}

/// No error in what instruments read.
const QUIET: [(&str, &str); 2] = [
    ("layers = [\"elevation\", \"texture\", \"temperature\"]", "layers = [\"elevation\"]"),
    ("sigma = 0.1", "sigma = 0.0"),
];

fn reading(cell: (usize, usize), value: f64, at_s: f64, more: &str) -> String {
    let (row, col) = cell;
    format!(
        "\n[[reading]]\nlayer = \"silica\"\ncell = [{row}, {col}]\nvalue = {value:.1}\nu = 0.1\n\
         at-s = {at_s:.1}\n{more}"
    )
}

/// What was observed of silica, with the mission time then, and how many windows there were in all.
#[derive(Default)]
struct Story {
    handed_in: Vec<(f64, LayerWindow)>,
    windows: usize,
}

impl Recorder for Story {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        let silica = observation.windows.iter().filter(|w| w.layer == "silica");
        self.handed_in.extend(silica.map(|w| (observation.spent.time_s, w.clone())));
        self.windows += observation.windows.len();
        Ok(())
    }

    fn decision(&mut self, _: &Decision, _: &Maps) -> Result<(), RecordError> {
        Ok(())
    }

    fn outcome(&mut self, _: &Outcome) -> Result<(), RecordError> {
        Ok(())
    }

    fn message(&mut self, _: &Message) -> Result<(), RecordError> {
        Ok(())
    }

    fn fault(&mut self, _: &FaultEvent) -> Result<(), RecordError> {
        Ok(())
    }
}

fn story(mission: &Mission) -> (RunSummary, Story) {
    let mut story = Story::default();
    let summary = run(mission, &mut story, &mut |_| true).expect("the run ends well");
    (summary, story)
}

#[test]
fn a_reading_is_observed_once_and_not_before_its_time() {
    let late = reading((5, 30), 70.0, 500.0, "radius-m = 3.0\n");
    let early = reading((30, 5), 50.0, 0.0, "");
    let mission = mission(&format!("{late}{early}"), &[]).expect("a sound mission");
    let (_, story) = story(&mission);
    let [(first_s, first), (second_s, second)] = &story.handed_in[..] else {
        panic!("two readings were handed in, {} observed", story.handed_in.len())
    };
    assert_eq!(*first_s, 0.0, "what is known from the start comes with the first look");
    assert_eq!(first.window, Window { row: 30, col: 5, rows: 1, cols: 1 });
    assert_eq!((&first.values[..], &first.uncertainty[..]), (&[50.0][..], &[0.1][..]));
    assert!((500.0..5000.0).contains(second_s), "{second_s}");
    assert_eq!(second.window, Window { row: 2, col: 27, rows: 7, cols: 7 });
}

#[test]
fn around_its_cell_a_reading_fades_as_an_instrument_s_does() {
    let mission = mission(&reading((5, 30), 70.0, 0.0, "radius-m = 3.0\n"), &[]).expect("sound");
    let (_, story) = story(&mission);
    let (_, window) = &story.handed_in[0];
    let middle = Cell { row: 5, col: 30 };
    for ((cell, value), u) in window.window.cells().zip(&window.values).zip(&window.uncertainty) {
        let share = middle.distance(cell) / 3.0;
        if share >= 1.0 {
            assert_eq!(
                (*value, *u),
                (0.0, 1.0),
                "{cell}: nothing is read at the radius and beyond"
            );
        } else {
            let expected = 0.1 + 0.9 * share * share;
            assert_eq!(*value, 70.0, "{cell}");
            assert!((f64::from(*u) - expected).abs() < 1e-6, "{cell}: {u}, not {expected}");
        }
    }
}

#[test]
fn a_reading_makes_the_goal_that_its_expert_calls_for() {
    let at = |value| {
        let text = reading((28, 26), value, 0.0, "radius-m = 3.0\n");
        story(&mission(&text, &QUIET).expect("a sound mission")).0
    };
    // On level ground, seen without error, nothing else is worth a drive.
    let (dull, rich) = (at(50.0), at(70.0));
    let there = |summary: &RunSummary| {
        let target = Cell { row: 28, col: 26 };
        summary.achieved.iter().any(|goal| goal.target.distance(target) < 3.0)
    };
    assert!(!there(&dull) && there(&rich), "{:?}\n{:?}", dull.achieved, rich.achieved);
    assert!(dull.achieved.is_empty());
}

#[test]
fn without_readings_the_layer_says_nothing_and_changes_nothing() {
    let plain = small::mission(small::LEVEL, &[]).expect("a sound mission");
    let with = mission("", &[]).expect("a sound mission");
    let (plain, plain_story) = story(&plain);
    let (silent, silent_story) = story(&with);
    assert!(silent_story.handed_in.is_empty());
    assert_eq!(plain_story.windows, silent_story.windows);
    assert_eq!((plain.achieved, plain.track), (silent.achieved, silent.track));
    assert!(with.world.is_handed_in("silica") && !with.world.is_handed_in("texture"));
    assert!(with.world.truth("silica").is_none());
}

#[test]
fn the_common_ruler_takes_a_layer_that_is_handed_in_for_unknown() {
    let plain = Ruler::new(&small::mission(small::LEVEL, &[]).expect("a sound mission"));
    let with = mission(&reading((5, 5), 70.0, 0.0, ""), &[]).expect("a sound mission");
    let ruler = Ruler::new(&with);
    for cell in with.spec.grid.cells() {
        let (a, b) = (plain.interest(cell), ruler.interest(cell));
        assert_eq!(a.expect("in memory"), b.expect("in memory"), "{cell}");
    }
}

#[test]
fn the_control_prior_knows_nothing_of_what_is_handed_in() {
    let control = ("kind = \"averaged\"\nblock = 8\nu = 0.6", "kind = \"complete\"");
    let mission = mission("", &[control]).expect("a sound mission");
    let spec = &mission.spec;
    let prior = mission.world.prior(&spec.layers, spec.grid.window()).expect("it is in memory");
    let known: Vec<&str> = prior.iter().map(|window| window.layer.as_str()).collect();
    assert_eq!(known, ["elevation", "temperature", "texture"]);
}

#[test]
fn readings_of_measured_layers_may_be_handed_in_too() {
    let of = |layer: &str, value: &str| {
        let text = reading((5, 5), 70.0, 0.0, "");
        mission(
            &text,
            &[
                ("[[reading]]\nlayer = \"silica\"", &format!("[[reading]]\nlayer = \"{layer}\"")),
                ("value = 70.0", value),
            ],
        )
    };
    let mission = of("texture", "value = 4").expect("a sound mission");
    assert_eq!(mission.world.execution().readings[0].value, 4.0);
    let error = of("texture", "value = 2.5").expect_err("no such class").to_string();
    assert!(error.contains("1, 2, 3, 4") && error.contains("value = 2.5"), "{error}");
    let error = of("gradient", "value = 2.5").expect_err("it is derived").to_string();
    assert!(error.contains("no measured layer"), "{error}");
}

#[test]
fn what_is_wrong_with_a_reading_is_said_where_it_stands() {
    let text = reading((5, 30), 70.0, 500.0, "radius-m = 3.0\n");
    for (from, to, words) in [
        (
            "[[reading]]\nlayer = \"silica\"",
            "[[reading]]\nlayer = \"gold\"",
            "`gold` is no measured layer",
        ),
        ("cell = [5, 30]", "cell = [5, 40]", "is off a grid of 40 x 40"),
        ("cell = [5, 30]", "cell = [5]", "expected two, [row, col]"),
        ("value = 70.0", "value = nan", "NaN"),
        ("value = 70.0", "value = 1e39", "expected a number from"),
        ("\nu = 0.1\n", "\nu = 1.0\n", "expected a number from 0 to 0.999"),
        ("\nu = 0.1\n", "\nu = -0.1\n", "expected a number from 0 to 0.999"),
        ("radius-m = 3.0", "radius-m = -1.0", "reading.0.radius-m"),
        ("at-s = 500.0", "at-s = -1.0", "reading.0.at-s"),
        ("at-s = 500.0", "at-s = inf", "reading.0.at-s"),
        ("at-s = 500.0", "at_s = 500.0", "unknown field `at_s`"),
        ("at-s = 500.0\n", "", "missing field `at-s`"),
    ] {
        let error = mission(&text, &[(from, to)]).expect_err(to);
        assert!(error.place.is_some(), "{error}");
        assert!(error.to_string().contains(words), "{to}: {error}");
    }
}

#[test]
fn a_layer_that_is_handed_in_takes_nothing_else() {
    for (from, to, words) in [
        ("handed-in = true", "handed-in = true\nfile = \"a.tif\"", "takes no `file`"),
        ("handed-in = true", "handed-in = true\nsigma = 1.0", "takes no `sigma`"),
        ("handed-in = true", "handed-in = true\nderived = \"slope\"", "takes no `derived`"),
        ("unit = \"m\"\nsigma = 0.1", "unit = \"m\"\nhanded-in = true", "routes need"),
        (
            "layers = [\"elevation\"",
            "layers = [\"silica\", \"elevation\"",
            "no instrument reads it",
        ),
        ("handed-in = true\n", "", "nothing gives `silica`"),
        (
            "kind = \"averaged\"\nblock = 8\nu = 0.6",
            "kind = \"first-look\"\nuncertainty = { silica = { sight = 0.1 } }",
            "`silica` is no measured layer",
        ),
    ] {
        let error = mission("", &[(from, to)]).expect_err(to);
        assert!(error.place.is_some(), "{error}");
        assert!(error.to_string().contains(words), "{to}: {error}");
    }
    let classes = ("handed-in = true", "handed-in = true\nkind = \"class\"\nclasses = [1, 2]");
    let slips = ("start = [20, 20]", "start = [20, 20]\nslip-layer = \"silica\"");
    let error = mission("", &[classes, slips]).expect_err("wheels slip by true ground");
    assert!(error.to_string().contains("there are: texture"), "{error}");
}
