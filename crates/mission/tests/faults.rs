//! What a mission says may break does break, by its chance, and does what it says, and the rover meets the rest.

mod small;

use wisdom_autonomy::{Decision, LayerWindow, Maps, Message, Observation, Outcome};
use wisdom_mission::{FaultEvent, FaultKind, Mission, RecordError, Recorder, RunSummary, run};

/// Level ground with a hot disc in a corner: one goal, one drive, many looks.
fn one_goal() -> String {
    format!(
        "{}\n[[hot_spot]]\ncentre = [7.0, 7.0]\nradius_cells = 3.0\nedge_cells = 1.0\npeak = 50.0\n",
        small::LEVEL
    )
}

/// The small mission with faults written behind its last line.
fn mission(faults: &str, changes: &[(&str, &str)]) -> Mission {
    let plain = small::mission(&one_goal(), changes).expect("a sound mission");
    let mut files = plain.files;
    let text = files.get_mut("mission.toml").expect("every mission has one");
    text.extend_from_slice(faults.as_bytes());
    Mission::from_files(&files).unwrap_or_else(|error| panic!("{error}"))
}

#[derive(Default)]
struct Story {
    observations: Vec<Observation>,
    outcomes: Vec<Outcome>,
    faults: Vec<FaultEvent>,
}

impl Recorder for Story {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        self.observations.push(observation.clone());
        Ok(())
    }

    fn decision(&mut self, _: &Decision, _: &Maps) -> Result<(), RecordError> {
        Ok(())
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.outcomes.push(outcome.clone());
        Ok(())
    }

    fn message(&mut self, _: &Message) -> Result<(), RecordError> {
        Ok(())
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        self.faults.push(event.clone());
        Ok(())
    }
}

fn go(mission: &Mission) -> (RunSummary, Story) {
    let mut story = Story::default();
    let summary = run(mission, &mut story, &mut |_| true).expect("the run ends well");
    assert_eq!(summary.faults, story.faults, "what is told is what is summed up");
    (summary, story)
}

/// A fault that is sure to strike at the first look.
fn at_once(kind: &str) -> String {
    format!("\n[[fault]]\nname = \"f\"\nprobability = 1.0\nbetween-s = [0.0, 0.0]\n{kind}\n")
}

fn heights(windows: &[LayerWindow]) -> Vec<(f32, f32)> {
    windows
        .iter()
        .filter(|w| w.layer == "elevation")
        .flat_map(|w| w.values.iter().copied().zip(w.uncertainty.iter().copied()))
        .collect()
}

#[test]
fn a_lost_instrument_reads_nothing_more() {
    let lost = at_once("kind = \"instrument-lost\"\ninstrument = \"cameras\"");
    let (_, plain) = go(&mission("", &[]));
    let (summary, story) = go(&mission(&lost, &[]));
    assert_eq!(summary.faults.len(), 1);
    // The first observation is what was known beforehand; all others are looks.
    assert!(plain.observations[1..].iter().any(|o| !o.windows.is_empty()));
    assert!(story.observations.len() > 1);
    assert!(story.observations[1..].iter().all(|o| o.windows.is_empty()));
    assert_eq!(plain.observations[0], story.observations[0]);
}

#[test]
fn a_passing_fault_ends_when_it_says() {
    let lost = at_once("kind = \"instrument-lost\"\ninstrument = \"cameras\"\nlasts-s = 30.0");
    let (summary, story) = go(&mission(&lost, &[]));
    assert_eq!(summary.faults[0].until_s, 30.0);
    for look in &story.observations[1..] {
        assert_eq!(look.windows.is_empty(), look.spent.time_s < 30.0, "at {} s", look.spent.time_s);
    }
    assert!(story.observations.iter().any(|o| o.spent.time_s > 30.0));
}

#[test]
fn dragging_wheels_cost_their_factor_in_time_and_energy() {
    let drag = at_once("kind = \"wheel-drag\"\nfactor = 1.5");
    let (_, plain) = go(&mission("", &[]));
    let (_, story) = go(&mission(&drag, &[]));
    // The rover sets out the same way, so that the second look under way is at the same place.
    let spent = |story: &Story| {
        let moved = story.observations.iter().find(|o| o.spent.length_m > 0.0);
        moved.expect("it drives").spent
    };
    let (easy, hard) = (spent(&plain), spent(&story));
    assert_eq!(easy.length_m, hard.length_m);
    assert!((hard.time_s / easy.time_s - 1.5).abs() < 1e-12);
    assert!((hard.energy_j / easy.energy_j - 1.5).abs() < 1e-12);
}

#[test]
fn a_biased_camera_reads_every_height_off_by_its_bias_and_nothing_else() {
    let bias = at_once("kind = \"dem-bias\"\nbias-m = 0.25");
    let (_, plain) = go(&mission("", &[]));
    let (_, story) = go(&mission(&bias, &[]));
    let (fair, off) = (&plain.observations[1].windows, &story.observations[1].windows);
    let mut read = 0;
    for ((z, u), (biased, same_u)) in heights(fair).into_iter().zip(heights(off)) {
        assert_eq!(u, same_u);
        assert_eq!(biased, if u < 1.0 { z + 0.25 } else { 0.0 });
        read += usize::from(u < 1.0);
    }
    assert!(read > 100);
    for (a, b) in fair.iter().zip(off).filter(|(w, _)| w.layer != "elevation") {
        assert_eq!(a, b);
    }
}

#[test]
fn with_a_slow_link_every_drive_that_ends_early_waits() {
    let delay = at_once("kind = \"comm-delay\"\ndelay-s = 700.0");
    // Ground so hazardous that drives are aborted, with a known recovery time and no scatter.
    let wild = [
        ("step-max-m = 0.4", "step-max-m = 0.4\nhazard-floor-per-m = 0.05"),
        ("[budget]", "[execution]\nrecovery-s = 100.0\nslip-scatter = 0.0\n\n[budget]"),
        ("data-mb = 600.0", "data-mb = 600.0\nmin-reliability = 0.0"),
    ];
    let (_, plain) = go(&mission("", &wild));
    let (_, story) = go(&mission(&delay, &wild));
    // Up to the first drive that ends early both runs are the same; there the second one waits longer.
    let (a, b) = plain
        .outcomes
        .iter()
        .zip(&story.outcomes)
        .find(|(a, b)| a.spent != b.spent)
        .expect("some drive ends early");
    assert_eq!((a.decision, a.result, a.pose), (b.decision, b.result, b.pose));
    assert!((b.spent.time_s - a.spent.time_s - 700.0).abs() < 1e-9);
    assert_eq!(a.spent.energy_j, b.spent.energy_j);
}

#[test]
fn faults_strike_as_often_as_they_say_and_when_they_may() {
    let text = "\n[[fault]]\nname = \"f\"\nkind = \"wheel-drag\"\nfactor = 2.0\nprobability = 0.3\n\
                between-s = [10.0, 20.0]\n";
    let (worlds, mut struck, mut mean_s) = (60, 0, 0.0);
    for seed in 1..=worlds {
        let seed = format!("seed = {seed}");
        let changes = [("seed = 1", seed.as_str()), ("time-s = 30000.0", "time-s = 2000.0")];
        let (summary, _) = go(&mission(text, &changes));
        for fault in &summary.faults {
            assert!((10.0..20.0).contains(&fault.time_s));
            assert_eq!(fault.kind, FaultKind::WheelDrag { factor: 2.0 });
            struck += 1;
            mean_s += fault.time_s;
        }
    }
    // Binomial with mean 18 and deviation 3.5; the mean time of as many draws has deviation 0.7 s.
    assert!((8..=28).contains(&struck), "{struck} of {worlds}");
    assert!(
        (f64::from(struck) * 15.0 - mean_s).abs() < 3.0 * f64::from(struck),
        "{mean_s} s in all"
    );
}

#[test]
fn the_true_hazard_may_be_a_multiple_of_the_model_s() {
    let world = |factor: &str| {
        let text = format!("[execution]\nhazard-factor = {factor}\n\n[budget]");
        mission("", &[("[budget]", text.as_str())]).world
    };
    let (right, worse) = (world("1.0"), world("1.5"));
    let (a, b) = (wisdom_grid::Cell::new(20, 20), wisdom_grid::Cell::new(20, 21));
    let cost = |world: &wisdom_mission::World| world.edge(a, b).expect("it reads").expect("open");
    assert_eq!(cost(&worse).neg_ln_r, 1.5 * cost(&right).neg_ln_r);
    assert_eq!(cost(&worse).energy_j, cost(&right).energy_j);
}

#[test]
fn a_fault_that_makes_no_sense_is_an_error_at_its_key() {
    let error = |fault: &str| {
        let mut files = small::mission(&one_goal(), &[]).expect("a sound mission").files;
        let text = files.get_mut("mission.toml").expect("every mission has one");
        text.extend_from_slice(format!("\n[[fault]]\nname = \"f\"\n{fault}\n").as_bytes());
        Mission::from_files(&files).expect_err("it makes no sense").to_string()
    };
    let drag = "kind = \"wheel-drag\"\n";
    for (fault, words) in [
        ("probability = 1.0\nkind = \"gremlin\"".to_owned(), "unknown variant `gremlin`"),
        (format!("{drag}probability = 1.0"), "a wheel-drag fault needs `factor`"),
        (format!("{drag}factor = 0.5\nprobability = 1.0"), "0.5; expected a number from 1 to 1000"),
        (format!("{drag}factor = 2.0\nprobability = 1.5"), "1.5; expected a number from 0 to 1"),
        (format!("{drag}factor = 2.0\nprobability = nan"), "expected a number from 0 to 1"),
        (
            format!("{drag}factor = 2.0\nprobability = 1.0\nbias-m = 1.0"),
            "a wheel-drag fault has `factor`, not `bias-m`",
        ),
        (
            format!("{drag}factor = 2.0\nprobability = 1.0\nbetween-s = [9.0, 3.0]"),
            "expected the earlier time first",
        ),
        (
            "kind = \"instrument-lost\"\ninstrument = \"nose\"\nprobability = 1.0".to_owned(),
            "`nose` is no instrument; there are cameras",
        ),
        (
            format!(
                "{drag}factor = 2.0\nprobability = 1.0\n[[fault]]\nname = \"f\"\n{drag}factor = 2.0\nprobability = 0.1"
            ),
            "fault `f` is given twice",
        ),
    ] {
        let said = error(&fault);
        assert!(said.contains(words) && said.contains("mission.toml:"), "{fault}\n{said}");
    }
}

/// Aborted drives of the one-goal mission where wheels keep a fifth of their way, and what a step costs scatters so much
/// that some keep a tenth.
fn aborted_where_slip_stops_at(slip_max: f64) -> usize {
    let vehicle = format!(
        "step-max-m = 0.4\nhazard-floor-per-m = 1e-12\nslip-base = 0.8\nslip-growth-per-deg = 0.0\n\
         slip-max = {slip_max}"
    );
    let changes = [
        ("step-max-m = 0.4", vehicle.as_str()),
        ("[budget]", "[execution]\nslip-scatter = 1.0\n\n[budget]"),
    ];
    let (summary, story) = go(&mission("", &changes));
    let aborted = |o: &&Outcome| matches!(o.result, wisdom_autonomy::StepResult::Aborted(_));
    for outcome in story.outcomes.iter().filter(aborted) {
        // The step was paid for and not made: the rover stands where its track ends.
        assert_eq!(outcome.track.last(), Some(&outcome.pose.cell));
    }
    assert!(summary.spent.length_m > 0.0);
    story.outcomes.iter().filter(aborted).count()
}

#[test]
fn wheels_that_slip_to_the_limit_spin_and_end_the_drive() {
    assert!(aborted_where_slip_stops_at(0.9) > 0);
    assert_eq!(aborted_where_slip_stops_at(0.95), 0, "the hazards themselves never strike here");
}

#[test]
fn the_wheels_slip_by_the_true_class_and_the_hazard_cameras_see_it() {
    let slope = "[base]\nelevation_m = 0.0\nrise_east = 0.0\nrise_north = 0.3\ntexture = 2\ntemperature = 3.0\n";
    let classes = "step-max-m = 0.4\n\
                   slip-class = [{ class = 2, base = 0.05, growth-per-deg = 0.15 }]";
    let changes = [
        ("step-max-m = 0.4", classes),
        ("eye-height-m = 3.0", "eye-height-m = 3.0\nslip-layer = \"texture\""),
    ];
    let world = small::mission(slope, &changes).expect("a sound mission").world;
    let (here, north) = (wisdom_grid::Cell::new(20, 20), wisdom_grid::Cell::new(19, 20));
    let slope_deg = 0.3_f64.atan().to_degrees();
    let up = world.step(here, north).expect("it reads").expect("open");
    let down = world.step(north, here).expect("it reads").expect("open");
    assert!((up.slip - 0.05 * (0.15 * slope_deg).exp()).abs() < 1e-6, "{}", up.slip);
    assert!((down.slip - 0.05 * (-0.15 * slope_deg).exp()).abs() < 1e-6, "{}", down.slip);
    assert!(up.cost.time_s > down.cost.time_s);
    let seen = world.close_look(here).expect("it reads");
    let texture = seen.iter().find(|w| w.layer == "texture").expect("slip depends on it");
    assert!(texture.values.iter().all(|&class| class == 2.0));
    assert!(texture.uncertainty.iter().all(|&u| u == 0.0));
}
