//! Vehicles made from published figures of rovers.
#![expect(
    clippy::missing_panics_doc,
    reason = "only a built-in file could make it panic, and the tests read each of them"
)]

use serde::Deserialize;

use crate::{PlannerError, Vehicle};

/// A vehicle put together from what is published of a rover: a configuration to start from, not one that flew.
///
/// Its file, [`Preset::text`], gives the source of each number, and says so where a number is recalled or assumed.
/// Slip classes are numbered as the texture classes of the Marias Pass mission are; ground whose classes are
/// numbered otherwise needs a `slip-class` list of its own.
///
/// ```
/// use wisdom_planner::{Preset, Vehicle};
///
/// let preset = Preset::named("msl")?;
/// assert_eq!(preset.vehicle().mass_kg, 899.0);
/// // A mission file changes single keys.
/// let mut table = preset.table();
/// table.insert("slope-max-deg".into(), 15.0.into());
/// let careful: Vehicle = table.try_into().expect("a known key");
/// assert_eq!(careful, Vehicle { slope_max_deg: 15.0, ..preset.vehicle() });
/// # Ok::<(), wisdom_planner::PlannerError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    name: &'static str,
    text: &'static str,
}

const ALL: [Preset; 4] = [
    Preset { name: "mer", text: include_str!("../presets/mer.toml") },
    Preset { name: "msl", text: include_str!("../presets/msl.toml") },
    Preset { name: "m2020", text: include_str!("../presets/m2020.toml") },
    Preset { name: "exomars", text: include_str!("../presets/exomars.toml") },
];

/// A preset's file: a summary, and the vehicle where a mission file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    summary: String,
    rover: Rover,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rover {
    vehicle: toml::Table,
}

impl Preset {
    /// Every preset, in the order the rovers were built.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &ALL
    }

    /// The preset of a name.
    ///
    /// # Errors
    /// [`PlannerError::UnknownPreset`], which lists the names there are.
    pub fn named(name: &str) -> Result<Self, PlannerError> {
        ALL.into_iter().find(|preset| preset.name == name).ok_or_else(|| {
            let known = ALL.map(|preset| preset.name).join(", ");
            PlannerError::UnknownPreset { name: name.into(), known }
        })
    }

    /// Its name, as files and commands give it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    /// One sentence on what it is.
    #[must_use]
    pub fn summary(self) -> String {
        self.file().summary
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(self) -> Vehicle {
        self.table().try_into().expect("built-in presets use a vehicle's keys")
    }

    /// The vehicle's keys and values as the file has them, for a mission file to change some.
    #[must_use]
    pub fn table(self) -> toml::Table {
        self.file().rover.vehicle
    }

    /// The vehicle's keys and values of a preset's file: a `summary` and `[rover.vehicle]`.
    ///
    /// # Errors
    /// What is wrong with the file, as TOML or by its keys.
    pub fn table_of(text: &str) -> Result<toml::Table, toml::de::Error> {
        toml::from_str::<File>(text).map(|file| file.rover.vehicle)
    }

    /// The file, sources and all. Its `[rover.vehicle]` can be pasted into a mission file.
    #[must_use]
    pub fn text(self) -> &'static str {
        self.text
    }

    fn file(self) -> File {
        toml::from_str(self.text).expect("built-in presets have a summary and a vehicle")
    }
}
