//! A small mission on 40 x 40 cells, for tests that need their own ground.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::collections::BTreeMap;
use std::path::PathBuf;

use wisdom_mission::{MISSION_FILE, Mission, MissionError};

/// The folder of a mission that ships with the workspace.
pub(crate) fn shipped(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../missions").join(name)
}

/// Level ground, nothing on it.
pub(crate) const LEVEL: &str = "\
[base]
elevation_m = 0.0
rise_east = 0.0
rise_north = 0.0
texture = 0
temperature = 3.0
";

const MISSION: &str = r#"
name = "small"
seed = 1
policy = "most-interesting"
prize = "belief"
facts = ["arm-stowed"]
experts = ["experts/dem.toml", "experts/temperature.toml", "experts/texture.toml"]

[terrain]
landscape = "landscape.toml"
rows = 40
cols = 40

[[layer]]
name = "elevation"
unit = "m"
sigma = 0.1

[[layer]]
name = "temperature"
sigma = 1.0

[[layer]]
name = "texture"
kind = "class"
classes = [1, 2, 3, 4]

[[layer]]
name = "gradient"
derived = "gradient"

[prior]
kind = "averaged"
block = 8
u = 0.6

[[instrument]]
name = "cameras"
layers = ["elevation", "texture", "temperature"]
height-m = 3.0
range-m = 15.0
u0 = 0.02

[rover]
start = [20, 20]
eye-height-m = 3.0

[rover.vehicle]
step-max-m = 0.4
roughness-max-m = 0.3

[budget]
time-s = 30000.0
energy-j = 1.2e6
data-mb = 600.0

[goals]
max-sequenced = 8
expansions = 20000
min-separation-m = 6.0

[fallback]
look-range-m = 15.0
min-ignorance = 0.15

[[operator]]
name = "drive"
preconditions = ["arm-stowed"]

[[operator]]
name = "stow-arm"
preconditions = ["arm-deployed"]
adds = ["arm-stowed"]
deletes = ["arm-deployed"]
time-s = 120.0
energy-j = 3.0e3

[[operator]]
name = "unstow-arm"
preconditions = ["arm-stowed"]
adds = ["arm-deployed"]
deletes = ["arm-stowed"]
time-s = 120.0
energy-j = 3.0e3

[[operator]]
name = "analyse"
preconditions = ["arm-deployed"]
adds = ["analysed"]
time-s = 1800.0
energy-j = 6.0e4
data-mb = 60.0

[[operator]]
name = "image"
preconditions = ["arm-stowed"]
adds = ["imaged"]
time-s = 300.0
energy-j = 1.0e4
data-mb = 40.0

[[directive]]
name = "analyse"
min-interest = 0.7
achieves = ["analysed"]
standoff-m = 3.0
exclusion-radius-m = 6.0
substitute = "image"

[[directive]]
name = "image"
min-interest = 0.6
weight = 0.5
achieves = ["imaged"]
standoff-m = 8.0
exclusion-radius-m = 6.0
"#;

/// The files of the small mission on a landscape.
pub(crate) fn files(landscape: &str) -> BTreeMap<String, Vec<u8>> {
    [
        (MISSION_FILE, MISSION),
        ("landscape.toml", landscape),
        ("experts/dem.toml", include_str!("../../../../missions/paper/experts/dem.toml")),
        (
            "experts/temperature.toml",
            include_str!("../../../../missions/paper/experts/temperature.toml"),
        ),
        ("experts/texture.toml", include_str!("../../../../missions/paper/experts/texture.toml")),
    ]
    .map(|(path, text)| (path.to_owned(), text.as_bytes().to_vec()))
    .into()
}

/// The small mission with lines of its file replaced, each of which must be there.
pub(crate) fn mission(landscape: &str, changes: &[(&str, &str)]) -> Result<Mission, MissionError> {
    let mut files = files(landscape);
    for (from, to) in changes {
        let file = files.get_mut(MISSION_FILE).expect("the mission has its file");
        let text = String::from_utf8(file.clone()).expect("it is text");
        assert!(text.contains(from), "`{from}` is not in the small mission");
        *file = text.replacen(from, to, 1).into_bytes();
    }
    Mission::from_files(&files)
}
