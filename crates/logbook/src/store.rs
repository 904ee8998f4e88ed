//! Where the bytes of a log go.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::LogError;

/// A place for the bytes of a log: a file, or memory.
///
/// `flush` is called when everything written so far should survive a crash.
pub trait Store: Write {
    /// What is left when the log is closed.
    type Closed;

    /// The name that errors speak of.
    fn name(&self) -> PathBuf;

    /// Ends the log.
    ///
    /// # Errors
    /// What the file system says.
    fn close(self) -> io::Result<Self::Closed>;
}

/// A log in memory.
impl Store for Vec<u8> {
    type Closed = Self;

    fn name(&self) -> PathBuf {
        PathBuf::from("log in memory")
    }

    fn close(self) -> io::Result<Self> {
        Ok(self)
    }
}

/// When a log file is made to survive a loss of power. The loss of the process never costs a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SyncPolicy {
    /// After each decision.
    #[default]
    Cycle,
    /// At the beginning and at the end of the run only.
    End,
}

impl SyncPolicy {
    /// Every policy.
    pub const ALL: [Self; 2] = [Self::Cycle, Self::End];

    /// The name that the command line takes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cycle => "cycle",
            Self::End => "end",
        }
    }
}

impl std::fmt::Display for SyncPolicy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A log file while it is written: `NAME.mcap.part`, which becomes `NAME.mcap` once it is whole.
#[derive(Debug)]
pub struct PartFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    sync: SyncPolicy,
    begun: bool,
}

/// What a file is called while it is written.
#[must_use]
pub fn part_of(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    PathBuf::from(part)
}

impl PartFile {
    /// Begins the file that is to become `path`.
    ///
    /// # Errors
    /// [`LogError::Exists`] if `path` or its part file is there already; [`LogError::Io`] if it cannot be
    /// made.
    pub fn create(path: &Path, sync: SyncPolicy) -> Result<Self, LogError> {
        if path.exists() {
            return Err(LogError::Exists { path: path.to_owned() });
        }
        let part = part_of(path);
        let made = OpenOptions::new().write(true).create_new(true).open(&part);
        let file = made.map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => LogError::Exists { path: part.clone() },
            _ => LogError::Io { path: part.clone(), source },
        })?;
        Ok(Self { file, part, path: path.to_owned(), sync, begun: false })
    }

    /// Makes the folder remember what it holds.
    fn sync_folder(&self) -> io::Result<()> {
        if cfg!(unix) {
            let folder = match self.path.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            };
            File::open(folder)?.sync_all()?;
        }
        Ok(())
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        if !self.begun {
            self.begun = true;
            self.file.sync_all()?;
            self.sync_folder()
        } else if self.sync == SyncPolicy::Cycle {
            self.file.sync_data()
        } else {
            Ok(())
        }
    }
}

impl Store for PartFile {
    type Closed = PathBuf;

    fn name(&self) -> PathBuf {
        self.part.clone()
    }

    fn close(self) -> io::Result<PathBuf> {
        self.file.sync_all()?;
        if self.path.exists() {
            let message = format!("{} was made while the run went on", self.path.display());
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
        }
        std::fs::rename(&self.part, &self.path)?;
        self.sync_folder()?;
        Ok(self.path)
    }
}

/// A store that refuses everything after its first error, so that a log whose disk was full for a moment
/// ends in a torn record, which readers know, and not in a hole.
pub(crate) struct Guarded<S> {
    store: S,
    failed: bool,
}

impl<S: Store> Guarded<S> {
    pub(crate) fn new(store: S) -> Self {
        Self { store, failed: false }
    }

    pub(crate) fn into_inner(self) -> S {
        self.store
    }

    fn guard<T>(&mut self, act: impl FnOnce(&mut S) -> io::Result<T>) -> io::Result<T> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed; nothing more is written"));
        }
        let result = act(&mut self.store);
        self.failed = result.as_ref().is_err_and(|e| e.kind() != io::ErrorKind::Interrupted);
        result
    }
}

impl<S: Store> Write for Guarded<S> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.guard(|store| store.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.guard(S::flush)
    }
}
