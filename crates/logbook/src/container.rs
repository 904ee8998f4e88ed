//! The container as every file of ours is written: begun, and brought to its end.

use std::io::BufWriter;
use std::path::Path;

use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions};

use crate::store::Guarded;
use crate::{LogError, Store};

/// A container in a store.
pub(crate) type Container<S> = mcap::Writer<NoSeek<BufWriter<Guarded<S>>>>;

/// Begins a container. A chunk is made in memory and written whole: where the writer is flushed, and once it has `chunk`
/// bytes, if that is given.
pub(crate) fn open<S: Store>(
    store: S,
    profile: &str,
    chunk: Option<u64>,
) -> Result<Container<S>, McapError> {
    WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(chunk)
        .disable_seeking(true)
        .library("wisdom")
        .profile(profile)
        .create(NoSeek::new(BufWriter::new(Guarded::new(store))))
}

/// Writes a container's indexes and footer, and closes its store. `name` is what errors speak of.
pub(crate) fn close<S: Store>(
    mut container: Container<S>,
    name: &Path,
) -> Result<S::Closed, LogError> {
    container.finish().map_err(|error| failure(name, error))?;
    let io = |source| LogError::Io { path: name.to_owned(), source };
    let buffered = container.into_inner().into_inner();
    let guarded = buffered.into_inner().map_err(|error| io(error.into_error()))?;
    guarded.into_inner().close().map_err(io)
}

/// An error of the container, with the file's name.
pub(crate) fn failure(name: &Path, error: McapError) -> LogError {
    let path = name.to_owned();
    match error {
        McapError::Io(source) => LogError::Io { path, source },
        source => LogError::Container { path, source },
    }
}
