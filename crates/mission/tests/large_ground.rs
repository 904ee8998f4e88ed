//! Ground larger than what one decision looks at: the working map moves with the rover, and what lies beyond it is
//! neither read nor kept in memory.

mod small;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use wisdom_autonomy::{Decision, ELEVATION, Maps, Message, Observation, Outcome};
use wisdom_goals::{Action, Reason};
use wisdom_grid::{Cell, Window};
use wisdom_mission::{FaultEvent, Mission, RecordError, Recorder, RunSummary, run};
use wisdom_terrain::unit_noise;

/// What a run decided, and on which maps.
#[derive(Default)]
struct Story {
    decisions: Vec<Decision>,
    maps: Vec<Window>,
    priors: Vec<Window>,
    looked_at: BTreeSet<Cell>,
}

impl Recorder for Story {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        // A view from orbit has one u; what an instrument reads has many.
        for read in &observation.windows {
            let from_orbit = read.uncertainty.iter().all(|u| *u == 0.6);
            if read.layer == ELEVATION && from_orbit {
                self.priors.push(read.window);
            }
        }
        Ok(())
    }

    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError> {
        self.decisions.push(decision.clone());
        let elevation = &maps.layers[ELEVATION];
        self.maps.push(elevation.spec().window());
        // Ground that was looked at stays better known than from orbit.
        for cell in elevation.spec().cells() {
            if elevation.u(cell) == 0.6 {
                assert!(!self.looked_at.contains(&cell), "{cell} at decision {}", decision.number);
            } else {
                self.looked_at.insert(cell);
            }
        }
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

fn tell(mission: &Mission) -> (Story, RunSummary) {
    let mut story = Story::default();
    let summary = run(mission, &mut story, &mut |_| true).expect("the mission runs");
    (story, summary)
}

/// Level ground with a rock of interesting texture every so often.
fn rocks(side: usize) -> String {
    let mut text = small::LEVEL.replace("texture = 0", "texture = 1");
    for block in 0..(side / 12) * (side / 12) {
        let (row, col) = (block / (side / 12) * 12 + 6, block % (side / 12) * 12 + 6);
        if unit_noise(&[5, block as u64]) < 0.5 {
            write!(
                text,
                "[[rock]]\ncentre = [{col}.0, {row}.0]\nhalf-axes = [1.6, 1.6]\nheight_m = 1.5\nwall = \"dome\"\n\
                 wall_cells = 1.2\n[[patch]]\nclass = 4\nshape = {{ disc = {{ centre = [{col}.0, {row}.0], \
                 radius_cells = 2.5 }} }}\n"
            )
            .expect("a string takes text");
        }
    }
    text
}

#[test]
fn a_working_map_that_holds_all_the_ground_changes_nothing() {
    let landscape = rocks(40);
    let whole = small::mission(&landscape, &[]).expect("sound");
    let change = [("cols = 40", "cols = 40\nworking-cells = 64")];
    let pieces = small::mission(&landscape, &change).expect("sound");
    assert!(whole.world.truth(ELEVATION).is_some() && pieces.world.truth(ELEVATION).is_none());
    let ((a, all), (b, parts)) = (tell(&whole), tell(&pieces));
    assert_eq!(a.decisions, b.decisions);
    assert_eq!(all, parts);
    assert!(all.achieved.len() > 2, "{all:?}");
}

#[test]
fn the_working_map_moves_on_with_the_rover() {
    let changes = [
        ("rows = 40\ncols = 40", "rows = 600\ncols = 600\nworking-cells = 64"),
        ("start = [20, 20]", "start = [300, 300]"),
        ("energy-j = 1.2e6", "energy-j = 4.0e6"),
        ("time-s = 30000.0", "time-s = 90000.0"),
        ("data-mb = 600.0", "data-mb = 2000.0"),
    ];
    let mission = small::mission(&rocks(600), &changes).expect("sound");
    let (story, summary) = tell(&mission);
    let latest = ("sigma = 0.1", "sigma = 0.1\nupdate = \"latest\"");
    let mission = small::mission(&rocks(600), &[&changes[..], &[latest]].concat()).expect("sound");
    assert!(tell(&mission).0.decisions.len() > 4, "what was seen last counts, orbit came first");
    let places: BTreeSet<Window> = story.maps.iter().copied().collect();
    assert!(places.len() > 1, "the rover went {:?}", summary.track.last());
    for (decision, map) in story.decisions.iter().zip(&story.maps) {
        assert_eq!((map.rows, map.cols), (64, 64));
        assert!(map.contains(decision.state.pose.cell), "decision {}", decision.number);
        for verdict in decision.verdicts.iter().filter(|v| v.action != Action::Drop) {
            let target = verdict.goal.target;
            assert!(map.contains(target) || verdict.action == Action::Achieve, "{verdict:?}");
        }
    }
    // The view from orbit is handed over for every place the map moves to, and once for each cell.
    let mut seen = BTreeSet::new();
    for cell in story.priors.iter().flat_map(Window::cells) {
        assert!(seen.insert(cell), "{cell} twice");
    }
    assert!(places.iter().flat_map(Window::cells).all(|cell| seen.contains(&cell)));
    // Goals that the map leaves behind are let go by name, and nothing else is.
    let left = |d: &Decision| {
        d.verdicts.iter().filter(|v| v.reason == Reason::OffMap).map(|v| v.goal.target).collect()
    };
    let behind: Vec<_> = story.decisions.iter().map(left).collect();
    for (targets, map) in behind.iter().zip(&story.maps) {
        let targets: &Vec<Cell> = targets;
        assert!(targets.iter().all(|target| !map.contains(*target)));
    }
    assert!(behind.iter().any(|targets| !targets.is_empty()), "no goal was left behind");
    assert!(summary.achieved.len() > 4);
}

#[test]
fn layers_in_memory_and_layers_read_piecewise_go_together() {
    let landscape = rocks(40);
    let mut files = small::files(&landscape);
    let mut text = "ncols 40\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 1\n".to_owned();
    for _ in 0..40 {
        writeln!(text, "{}", ["3"; 40].join(" ")).expect("a string takes text");
    }
    files.insert("heat.asc".to_owned(), text.into_bytes());
    let file = files.get_mut(wisdom_mission::MISSION_FILE).expect("it has its file");
    let text = String::from_utf8(file.clone()).expect("it is text");
    *file = text
        .replace("cols = 40", "cols = 40\nworking-cells = 64")
        .replace("sigma = 1.0", "sigma = 1.0\nfile = \"heat.asc\"")
        .into_bytes();
    let mixed = Mission::from_files(&files).expect("sound");
    assert!(mixed.world.truth("temperature").is_some() && mixed.world.truth(ELEVATION).is_none());
    // The file holds what the landscape draws, so everything goes as if all were drawn.
    let drawn = [("cols = 40", "cols = 40\nworking-cells = 64")];
    let drawn = tell(&small::mission(&landscape, &drawn).expect("sound")).1;
    assert!(!drawn.achieved.is_empty());
    assert_eq!(tell(&mixed).1, drawn);
}

#[test]
fn a_working_map_has_a_least_and_a_largest_side_and_bounds_the_way_between_looks() {
    for (cells, words) in [
        ("working-cells = 63", "63; expected 64 to 4096"),
        ("working-cells = 5000", "5000; expected 64 to 4096"),
    ] {
        let change = format!("cols = 40\n{cells}");
        let error = small::mission(small::LEVEL, &[("cols = 40", &change)]).expect_err("refused");
        assert!(error.message.contains(words), "{error}");
    }
    let changes = [
        ("cols = 40", "cols = 40\nworking-cells = 64"),
        ("eye-height-m = 3.0", "eye-height-m = 3.0\nlook-every-m = 8.5"),
    ];
    let error = small::mission(small::LEVEL, &changes).expect_err("refused");
    assert!(error.message.contains("8.5; expected at most 8"), "{error}");
    let changes =
        [("cols = 40", "cols = 40\nworking-cells = 64"), ("range-m = 15.0", "range-m = 32.5")];
    let error = small::mission(small::LEVEL, &changes).expect_err("refused");
    assert!(error.message.contains("32.5; expected at most 32"), "{error}");
}
