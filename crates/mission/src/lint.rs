//! What a mission file allows and can hardly mean, found by asking its own tables, rule and operators.

mod evidence;
mod operators;
mod readings;

use std::fmt;

use crate::file::MissionFile;
use crate::{MISSION_FILE, Mission, MissionError};

/// What a [`Warning`] is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Lint {
    /// A directive's `min-interest` is not above the interest of dull ground, so that it turns nothing away.
    ThresholdBelowBackground,
    /// A directive that no site can come to.
    DirectiveNeverFires,
    /// A fact, or a whole operator, that serves no directive.
    EffectNobodyNeeds,
    /// Two experts judge one reading, which fusion takes for two independent ones.
    SensorCountedTwice,
    /// A row of a table that no reading can meet.
    RowNeverRead,
    /// All ground that was seen is worth the same, or too little to count.
    ConstantPrize,
    /// No warning, but a remark: one of the others could not be asked, and why.
    NotChecked,
}

impl Lint {
    /// Every lint, in the order in which they are reported.
    pub const ALL: [Self; 7] = [
        Self::ThresholdBelowBackground,
        Self::DirectiveNeverFires,
        Self::EffectNobodyNeeds,
        Self::SensorCountedTwice,
        Self::RowNeverRead,
        Self::ConstantPrize,
        Self::NotChecked,
    ];

    /// Its name, in kebab-case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ThresholdBelowBackground => "threshold-below-background",
            Self::DirectiveNeverFires => "directive-never-fires",
            Self::EffectNobodyNeeds => "effect-nobody-needs",
            Self::SensorCountedTwice => "sensor-counted-twice",
            Self::RowNeverRead => "row-never-read",
            Self::ConstantPrize => "constant-prize",
            Self::NotChecked => "not-checked",
        }
    }
}

impl fmt::Display for Lint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Something in a mission's files that is allowed and can hardly be meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// What it is about.
    pub lint: Lint,
    /// The file, relative to the mission's folder.
    pub file: String,
    /// Line and column (from 1); none if the key is not written in the file.
    pub place: Option<(usize, usize)>,
    /// The dotted path of the key.
    pub key: String,
    /// The value found, the number it was compared with, and what to do.
    pub message: String,
}

impl fmt::Display for Warning {
    /// `file:line:column: key: message [lint]`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some((line, column)) = self.place {
            write!(f, ":{line}:{column}")?;
        }
        write!(f, ": {}: {} [{}]", self.key, self.message, self.lint)
    }
}

/// What a mission's files allow and can hardly mean, by [`Lint`] and then by place. A mission without warnings may
/// still be a bad one; one with warnings runs.
///
/// Interest is asked of the mission's own tables under its own rule and statistic; ground, of the true layers. What
/// would take too long or is not at hand is said by [`Lint::NotChecked`].
///
/// ```
/// use wisdom_mission::{Lint, Mission, Override, lint};
///
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../missions/paper");
/// // Dull ground, seen well, has Bel(I) = 0.488 under the paper's tables.
/// let changes = [Override::new("directive.2.min-interest", "0.45")];
/// let warnings = lint(&Mission::load(folder.as_ref(), &changes)?);
/// assert_eq!(warnings[0].lint, Lint::ThresholdBelowBackground);
/// assert!(warnings[0].message.contains("0.488"));
/// # Ok::<(), wisdom_mission::MissionError>(())
/// ```
///
/// # Panics
/// If the mission's files were changed after it was read.
#[must_use]
pub fn lint(mission: &Mission) -> Vec<Warning> {
    let text = text(mission, MISSION_FILE);
    let file = toml::from_str(text).expect("the mission was read from it");
    let mut linter = Linter { mission, file, found: Vec::new() };
    linter.thresholds();
    linter.operators();
    linter.sensors();
    linter.rows();
    linter.prize();
    // Stable: within a lint, in the order of the files.
    linter.found.sort_by_key(|warning| warning.lint);
    linter.found
}

fn text<'a>(mission: &'a Mission, file: &str) -> &'a str {
    let bytes = mission.files.get(file).map_or(&[][..], Vec::as_slice);
    std::str::from_utf8(bytes).expect("the mission was read from it")
}

/// A mission, its file, and what was found so far.
struct Linter<'a> {
    mission: &'a Mission,
    file: MissionFile,
    found: Vec<Warning>,
}

impl Linter<'_> {
    /// A warning about a key of `mission.toml`.
    fn warn(&mut self, lint: Lint, path: &[&str], message: String) {
        self.warn_in(MISSION_FILE.to_owned(), lint, path, message);
    }

    fn warn_in(&mut self, file: String, lint: Lint, path: &[&str], message: String) {
        let place = MissionError::at_key(&file, text(self.mission, &file), path, "").place;
        self.found.push(Warning { lint, file, place, key: path.join("."), message });
    }
}

/// A number to six places, without zeros at its end.
fn short(number: f64) -> String {
    let text = format!("{number:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
