//! Terrain files read window by window: ground larger than memory.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use wisdom_grid::{GridError, GridSpec, MAX_SIDE, Window};

use super::geotiff::{Chunk, Facts, Image};
use super::{About, GridFile, beside, damaged, on_disk, read_bands_with};
use crate::{Crs, TerrainError};

/// How many bytes of decoded strips and tiles a [`GridReader`] keeps if not told otherwise: 64 MiB.
pub const DEFAULT_CACHE_BYTES: usize = 64 << 20;

/// An open terrain file, read window by window.
///
/// Of a GeoTIFF only the strips or tiles that a window touches are decoded; the last ones used stay in memory, up to
/// a bound in bytes. So its image may have any number of cells, with sides up to [`MAX_SIDE`]. Any other format is
/// read whole when it is opened. Threads may share a reader: strips and tiles are decoded one at a time.
///
/// ```
/// # use wisdom_terrain::format::GridReader;
/// # use wisdom_grid::Window;
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/f32_tiled_deflate_p3.tif");
/// let file = GridReader::open(path.as_ref())?;
/// let crop = file.read(Window { row: 4, col: 10, rows: 3, cols: 5 })?;
/// assert_eq!(crop.raster.spec().west_m(), file.spec().west_m() + 10.0);
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
pub struct GridReader {
    name: String,
    length: u64,
    content: Content,
}

enum Content {
    /// A GeoTIFF, decoded as windows ask for it.
    Tiff { facts: Box<Facts>, state: Box<Mutex<State>> },
    /// Another format, in memory, with the digest of its bytes.
    Whole { bands: Vec<GridFile>, digest: [u8; 32] },
}

struct State {
    image: Image<BufReader<File>>,
    cache: Cache,
}

impl fmt::Debug for GridReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GridReader")
            .field("name", &self.name)
            .field("spec", &self.spec())
            .finish_non_exhaustive()
    }
}

impl GridReader {
    /// Opens a file, keeping up to [`DEFAULT_CACHE_BYTES`] of decoded strips and tiles.
    ///
    /// # Errors
    /// [`TerrainError::Io`] if the system refuses; otherwise as [`read_bands`](super::read_bands), but that a GeoTIFF
    /// may have any number of cells. A header that promises more than the file holds (tags, strips or tiles beyond its
    /// end, strips or tiles of more than 2²⁶ samples) is refused before room is made for it.
    pub fn open(path: &Path) -> Result<Self, TerrainError> {
        Self::open_with_cache(path, DEFAULT_CACHE_BYTES)
    }

    /// As [`open`](Self::open), keeping up to `cache_bytes` of decoded strips and tiles; with 0 none is kept.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with_cache(path: &Path, cache_bytes: usize) -> Result<Self, TerrainError> {
        let name = path.display().to_string();
        let refused = |source| TerrainError::Io { name: name.clone(), action: "open", source };
        let mut file = File::open(path).map_err(refused)?;
        let length = file.metadata().map_err(refused)?.len();
        let mut start = Vec::new();
        (&mut file).take(4).read_to_end(&mut start).map_err(refused)?;
        file.seek(SeekFrom::Start(0)).map_err(refused)?;
        let content = if is_tiff(&start) {
            let from = BufReader::new(file);
            let (facts, image) =
                Image::open(&name, from, length, |rows, cols| check_sides(&name, rows, cols))?;
            let cache = Cache { bound: cache_bytes, ..Cache::default() };
            Content::Tiff {
                facts: Box::new(facts),
                state: Box::new(Mutex::new(State { image, cache })),
            }
        } else {
            let bytes = on_disk(path).map_err(refused)?;
            let digest = *blake3::hash(&bytes).as_bytes();
            let bands = read_bands_with(&name, &bytes, &mut |sibling| beside(path, sibling))?;
            Content::Whole { bands, digest }
        };
        Ok(Self { name, length, content })
    }

    /// Whether windows are decoded as they are asked for; otherwise the file lies in memory.
    #[must_use]
    pub fn reads_windows(&self) -> bool {
        matches!(self.content, Content::Tiff { .. })
    }

    /// Where the whole file's grid lies.
    #[must_use]
    pub fn spec(&self) -> GridSpec {
        match &self.content {
            Content::Tiff { facts, .. } => facts.spec,
            Content::Whole { bands, .. } => bands[0].raster.spec(),
        }
    }

    /// What the map coordinates mean, if the file says.
    #[must_use]
    pub fn crs(&self) -> Option<&Crs> {
        match &self.content {
            Content::Tiff { facts, .. } => facts.crs.as_ref(),
            Content::Whole { bands, .. } => bands[0].crs.as_ref(),
        }
    }

    /// How the file holds its first band.
    #[must_use]
    pub fn about(&self) -> &About {
        match &self.content {
            Content::Tiff { facts, .. } => &facts.about[0],
            Content::Whole { bands, .. } => &bands[0].about,
        }
    }

    /// Number of bands.
    #[must_use]
    pub fn bands(&self) -> usize {
        match &self.content {
            Content::Tiff { facts, .. } => facts.about.len(),
            Content::Whole { bands, .. } => bands.len(),
        }
    }

    /// Length of the file in bytes, when it was opened.
    #[must_use]
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads a window of a file of one band.
    ///
    /// # Errors
    /// [`TerrainError::Grid`] if the window is empty or reaches over the edge; [`TerrainError::TooLarge`] if it has more
    /// than [`MAX_CELLS`](super::MAX_CELLS); [`TerrainError::Bands`] if the file has more than one band;
    /// [`TerrainError::File`] if a strip or tile is damaged.
    pub fn read(&self, window: Window) -> Result<GridFile, TerrainError> {
        let bands = self.bands();
        if bands != 1 {
            return Err(TerrainError::Bands { name: self.name.clone(), bands });
        }
        Ok(self.read_bands(window)?.swap_remove(0))
    }

    /// Reads a window of every band.
    ///
    /// # Errors
    /// As [`read`](Self::read), but for the number of bands.
    pub fn read_bands(&self, window: Window) -> Result<Vec<GridFile>, TerrainError> {
        let spec = self.spec();
        let end = window.row.checked_add(window.rows).zip(window.col.checked_add(window.cols));
        if end.is_none() {
            let (rows, cols) = (spec.rows(), spec.cols());
            return Err(GridError::OutsideGrid { window, rows, cols }.into());
        }
        match &self.content {
            Content::Tiff { facts, state } => {
                facts.gather(window, |index| lock(state).chunk(facts, index))
            }
            Content::Whole { bands, .. } => bands
                .iter()
                .map(|band| {
                    Ok(GridFile {
                        raster: band.raster.crop(window)?,
                        known: band.known.crop(window)?,
                        crs: band.crs.clone(),
                        about: band.about.clone(),
                    })
                })
                .collect(),
        }
    }

    /// The BLAKE3 digest of the file's bytes, read in small pieces.
    ///
    /// # Errors
    /// [`TerrainError::Io`] if the system refuses.
    pub fn digest(&self) -> Result<[u8; 32], TerrainError> {
        let state = match &self.content {
            Content::Whole { digest, .. } => return Ok(*digest),
            Content::Tiff { state, .. } => state,
        };
        let mut state = lock(state);
        let file = state.image.file();
        let mut hasher = blake3::Hasher::new();
        file.seek(SeekFrom::Start(0))
            .and_then(|_| hasher.update_reader(file).map(|_| ()))
            .map_err(|source| TerrainError::Io {
                name: self.name.clone(),
                action: "read",
                source,
            })?;
        Ok(*hasher.finalize().as_bytes())
    }

    /// Bytes of decoded strips and tiles in memory now; 0 for a file that was read whole.
    #[must_use]
    pub fn cached_bytes(&self) -> usize {
        match &self.content {
            Content::Tiff { state, .. } => lock(state).cache.bytes,
            Content::Whole { .. } => 0,
        }
    }

    /// How many strips or tiles have been decoded so far: what windows cost.
    #[must_use]
    pub fn decoded_chunks(&self) -> u64 {
        match &self.content {
            Content::Tiff { state, .. } => lock(state).cache.decoded,
            Content::Whole { .. } => 0,
        }
    }
}

/// A thread that died while it held the lock leaves a decoder that seeks before it reads, and a cache of whole chunks.
fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn is_tiff(start: &[u8]) -> bool {
    [b"II\x2a\0", b"MM\0\x2a", b"II\x2b\0", b"MM\0\x2b"].into_iter().any(|magic| start == magic)
}

fn check_sides(name: &str, rows: usize, cols: usize) -> Result<(), TerrainError> {
    if [rows, cols].iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
        return Err(damaged(
            name,
            format!("it has {rows} x {cols} cells; each side must be 1 to {MAX_SIDE}"),
        ));
    }
    Ok(())
}

impl State {
    /// A strip or tile, from the cache or the file.
    fn chunk(&mut self, facts: &Facts, index: usize) -> Result<Arc<Chunk>, TerrainError> {
        if let Some(chunk) = self.cache.find(index) {
            return Ok(chunk);
        }
        let chunk = Arc::new(self.image.chunk(facts, index)?);
        self.cache.keep(index, Arc::clone(&chunk));
        Ok(chunk)
    }
}

/// Decoded strips and tiles; when the bound is reached, the least recently used go first.
#[derive(Default)]
struct Cache {
    bound: usize,
    bytes: usize,
    /// Counts uses: the age of what was used.
    uses: u64,
    decoded: u64,
    chunks: BTreeMap<usize, (u64, Arc<Chunk>)>,
    by_use: BTreeMap<u64, usize>,
}

impl Cache {
    fn find(&mut self, index: usize) -> Option<Arc<Chunk>> {
        let (last_use, chunk) = self.chunks.get_mut(&index)?;
        self.uses += 1;
        self.by_use.remove(last_use);
        self.by_use.insert(self.uses, index);
        *last_use = self.uses;
        Some(Arc::clone(chunk))
    }

    /// Keeps a chunk that is not kept yet, unless it alone is larger than the bound.
    fn keep(&mut self, index: usize, chunk: Arc<Chunk>) {
        self.decoded += 1;
        let bytes = cost(&chunk);
        if bytes > self.bound {
            return;
        }
        while self.bytes + bytes > self.bound {
            let Some((_, oldest)) = self.by_use.pop_first() else { break };
            if let Some((_, gone)) = self.chunks.remove(&oldest) {
                self.bytes -= cost(&gone);
            }
        }
        self.uses += 1;
        self.bytes += bytes;
        self.by_use.insert(self.uses, index);
        self.chunks.insert(index, (self.uses, chunk));
    }
}

/// What a kept chunk counts for: its samples, and its place in the cache, so that empty ones are bounded too.
fn cost(chunk: &Chunk) -> usize {
    const PLACE: usize = 128;
    chunk.bytes() + PLACE
}
