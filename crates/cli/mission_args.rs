//! Options common to the commands that read a mission.

use std::path::PathBuf;

use wisdom_mission::{Mission, MissionError, Override};

/// A mission and changes to it.
#[derive(clap::Args, Debug, Clone)]
pub(crate) struct MissionArgs {
    /// A mission's folder or its mission.toml.
    pub(crate) mission: PathBuf,
    /// Change a key of mission.toml: `budget.energy-j=2e6`, `directive.0.weight=2`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// The objective over goal sequences: expected-interest, most-interesting, all-or-nothing, chance-constrained,
    /// net-benefit or utility.
    #[arg(long, value_name = "POLICY")]
    pub(crate) policy: Option<String>,
}

impl MissionArgs {
    /// Reads the mission with its changes; `more` are further ones, which come first.
    pub(crate) fn load(&self, more: &[Override]) -> Result<Mission, MissionError> {
        let mut overrides = more.to_vec();
        overrides.extend(self.policy.iter().map(|p| Override::new("policy", quoted(p))));
        changes(&mut overrides, &self.set)?;
        Mission::load(&self.mission, &overrides)
    }
}

/// Adds what `--set` asks for to changes that other options ask for.
pub(crate) fn changes(overrides: &mut Vec<Override>, set: &[String]) -> Result<(), MissionError> {
    for change in set {
        let (key, value) = change.split_once('=').ok_or_else(|| {
            MissionError::of_file("--set", format!("`{change}`; expected KEY=VALUE"))
        })?;
        let key = key.trim();
        if overrides.iter().any(|o| o.key == key) {
            let message = format!("`{change}`: `{key}` is given twice");
            return Err(MissionError::of_file("--set", message));
        }
        overrides.push(Override::new(key, value.trim()));
    }
    Ok(())
}

/// Text as a TOML string, so that a name is never taken for a number or a date.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
