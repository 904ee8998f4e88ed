//! The runs of one world, read.

use wisdom_logbook::comparison::Account;
use wisdom_logbook::{LogReader, Status};

use super::source::Logged;
use crate::exit::InputError;

/// A run of the world at hand: its log and what it came to.
pub(super) struct Run {
    /// What it is called.
    pub(super) name: String,
    pub(super) path: std::path::PathBuf,
    pub(super) log: LogReader,
    pub(super) account: Account,
}

impl Run {
    pub(super) fn decisions(&self) -> u64 {
        u64::from(self.account.decisions)
    }

    /// A fact that the log states of itself.
    pub(super) fn fact(&self, name: &str) -> String {
        self.log.metadata.get(name).cloned().unwrap_or_else(|| "?".to_owned())
    }
}

/// Reads the logs of one world.
pub(super) fn read(of_world: &[Logged]) -> anyhow::Result<Vec<Run>> {
    of_world
        .iter()
        .map(|Logged { name, path }| {
            let log = LogReader::open(path)?;
            let whole = log.attachments.iter().any(|file| file.name == "mission/mission.toml");
            if log.status != Status::Complete && !whole {
                let message = format!(
                    "{} is {}; there is no mission in what is left of it",
                    path.display(),
                    log.status
                );
                return Err(InputError(message).into());
            }
            let account = Account::of(&log)?;
            Ok(Run { name: name.clone(), path: path.clone(), log, account })
        })
        .collect()
}
