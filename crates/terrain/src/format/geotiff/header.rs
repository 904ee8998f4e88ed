//! The first directory of a TIFF: its tags, each checked against the file's length before anything is made of it.
//!
//! The `tiff` crate reads the directory again to decode pixels. What it would make room for, or multiply, is checked
//! here first, so that a header can promise no more than the file holds.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};

use super::tag;
use crate::TerrainError;
use crate::format::damaged;

/// More tags than any writer has; beyond, the file is hostile or damaged.
const MAX_TAGS: u64 = 4096;

/// Tags that the `tiff` crate reads on opening: their values must lie inside the file.
const READ_ON_OPENING: [u16; 20] = [
    tag::IMAGE_WIDTH,
    tag::IMAGE_LENGTH,
    tag::BITS_PER_SAMPLE,
    tag::COMPRESSION,
    tag::PHOTOMETRIC,
    tag::STRIP_OFFSETS,
    tag::SAMPLES_PER_PIXEL,
    tag::ROWS_PER_STRIP,
    tag::STRIP_BYTE_COUNTS,
    tag::PLANAR_CONFIGURATION,
    tag::PREDICTOR,
    tag::TILE_WIDTH,
    tag::TILE_LENGTH,
    tag::TILE_OFFSETS,
    tag::TILE_BYTE_COUNTS,
    tag::EXTRA_SAMPLES,
    tag::SAMPLE_FORMAT,
    tag::JPEG_TABLES,
    tag::CHROMA_SUBSAMPLING,
    tag::GDAL_NODATA,
];

/// The first directory of a TIFF file.
pub(super) struct Header<'a> {
    name: &'a str,
    pub(super) big_endian: bool,
    pub(super) big_tiff: bool,
    entries: BTreeMap<u16, Entry>,
    length: u64,
}

/// A tag's type, number of values, and the values themselves or where they lie.
#[derive(Clone, Copy)]
struct Entry {
    kind: u16,
    count: u64,
    field: [u8; 8],
}

/// Bytes of one value of a TIFF type; `None` for a type that no standard names.
fn size_of_kind(kind: u16) -> Option<u64> {
    match kind {
        1 | 2 | 6 | 7 => Some(1),
        3 | 8 => Some(2),
        4 | 9 | 11 | 13 => Some(4),
        5 | 10 | 12 | 16 | 17 | 18 => Some(8),
        _ => None,
    }
}

/// Where the values of a tag lie.
enum Extent {
    /// In the directory itself, so many bytes.
    Inline(usize),
    /// Elsewhere in the file.
    InFile { place: u64, bytes: u64 },
}

impl<'a> Header<'a> {
    /// Reads the directory of a file of `length` bytes.
    pub(super) fn read(
        name: &'a str,
        from: &mut (impl Read + Seek),
        length: u64,
    ) -> Result<Self, TerrainError> {
        let bytes = bytes_at(name, from, length, 0, 8)?;
        let big_endian = bytes.starts_with(b"MM");
        let version = number(big_endian, &bytes[2..4]);
        let big_tiff = version == 43;
        if !(bytes.starts_with(b"II") || big_endian) || !(version == 42 || big_tiff) {
            return Err(damaged(name, "it does not begin as a TIFF".to_owned()));
        }
        let mut header = Self { name, big_endian, big_tiff, entries: BTreeMap::new(), length };
        let (count_size, entry_size) = if big_tiff { (8, 20) } else { (2, 12) };
        let start = if big_tiff {
            let word = bytes_at(name, from, length, 8, 8)?;
            number(big_endian, &word)
        } else {
            number(big_endian, &bytes[4..8])
        };
        let count = number(big_endian, &bytes_at(name, from, length, start, count_size)?);
        if count > MAX_TAGS {
            return Err(damaged(
                name,
                format!("its directory has {count} tags; at most {MAX_TAGS} are read"),
            ));
        }
        let table = bytes_at(name, from, length, start + count_size, count * entry_size)?;
        for entry in table.chunks_exact(entry_size as usize) {
            let (head, field) = entry.split_at(if big_tiff { 12 } else { 8 });
            let mut padded = [0; 8];
            padded[..field.len()].copy_from_slice(field);
            let kind = number(big_endian, &head[2..4]) as u16;
            // The decoder passes over types it does not know, too: both must see the same tags.
            if size_of_kind(kind).is_none() {
                continue;
            }
            let count = number(big_endian, &head[4..]);
            let tag = number(big_endian, &head[..2]) as u16;
            header.entries.insert(tag, Entry { kind, count, field: padded });
        }
        for tag in READ_ON_OPENING {
            header.extent(tag)?;
        }
        Ok(header)
    }

    /// Where a tag's values lie, and how many bytes they have.
    fn extent(&self, tag: u16) -> Result<Option<Extent>, TerrainError> {
        let Some(entry) = self.entries.get(&tag) else { return Ok(None) };
        let Some(size) = size_of_kind(entry.kind) else { return Ok(None) };
        let inline = if self.big_tiff { 8 } else { 4 };
        let bytes = entry.count.checked_mul(size);
        if let Some(bytes) = bytes.filter(|&bytes| bytes <= inline) {
            return Ok(Some(Extent::Inline(bytes as usize)));
        }
        let place = number(self.big_endian, &entry.field[..inline as usize]);
        match bytes.filter(|&n| place.checked_add(n).is_some_and(|end| end <= self.length)) {
            Some(bytes) => Ok(Some(Extent::InFile { place, bytes })),
            None => Err(damaged(
                self.name,
                format!(
                    "tag {tag} has {} values at byte {place}, beyond the end of the file of {} bytes",
                    entry.count, self.length
                ),
            )),
        }
    }

    /// The raw bytes of a tag with the size of one value, if the file has it.
    fn raw(
        &self,
        from: &mut (impl Read + Seek),
        tag: u16,
    ) -> Result<Option<(u16, Vec<u8>)>, TerrainError> {
        let Some(extent) = self.extent(tag)? else { return Ok(None) };
        let Entry { kind, field, .. } = self.entries[&tag];
        let raw = match extent {
            Extent::Inline(bytes) => field[..bytes].to_vec(),
            Extent::InFile { place, bytes } => {
                bytes_at(self.name, from, self.length, place, bytes)?
            }
        };
        Ok(Some((kind, raw)))
    }

    /// A tag of whole numbers; empty if the file has none of them.
    pub(super) fn whole_numbers(
        &self,
        from: &mut (impl Read + Seek),
        tag: u16,
    ) -> Result<Vec<u64>, TerrainError> {
        let Some((kind, raw)) = self.raw(from, tag)? else { return Ok(Vec::new()) };
        let size = match kind {
            1 | 3 | 4 | 13 | 16 | 18 => size_of_kind(kind).unwrap_or(1) as usize,
            _ => {
                let reason =
                    format!("tag {tag} is of TIFF type {kind}; unsigned numbers are wanted");
                return Err(damaged(self.name, reason));
            }
        };
        Ok(raw.chunks_exact(size).map(|bytes| number(self.big_endian, bytes)).collect())
    }

    /// The first of a tag's whole numbers.
    pub(super) fn whole_number(
        &self,
        from: &mut (impl Read + Seek),
        tag: u16,
    ) -> Result<Option<u64>, TerrainError> {
        Ok(self.whole_numbers(from, tag)?.first().copied())
    }

    /// A tag of doubles; empty if the file has none of them.
    pub(super) fn doubles(
        &self,
        from: &mut (impl Read + Seek),
        tag: u16,
    ) -> Result<Vec<f64>, TerrainError> {
        let Some((kind, raw)) = self.raw(from, tag)? else { return Ok(Vec::new()) };
        let order = self.big_endian;
        match kind {
            12 => Ok(raw.chunks_exact(8).map(|b| f64::from_bits(number(order, b))).collect()),
            11 => Ok(raw
                .chunks_exact(4)
                .map(|b| f64::from(f32::from_bits(number(order, b) as u32)))
                .collect()),
            _ => Err(damaged(
                self.name,
                format!("tag {tag} is of TIFF type {kind}; doubles are wanted"),
            )),
        }
    }

    /// A tag of text up to its first NUL; empty if the file has none. Bytes beyond ASCII become `?`, so that places in
    /// the text stay what they are.
    pub(super) fn text(
        &self,
        from: &mut (impl Read + Seek),
        tag: u16,
    ) -> Result<String, TerrainError> {
        let Some((_, raw)) = self.raw(from, tag)? else { return Ok(String::new()) };
        let plain = raw.iter().take_while(|&&byte| byte != 0);
        Ok(plain.map(|&byte| if byte.is_ascii() { char::from(byte) } else { '?' }).collect())
    }
}

/// An unsigned number of up to eight bytes.
fn number(big_endian: bool, bytes: &[u8]) -> u64 {
    let add = |sum: u64, &byte: &u8| (sum << 8) | u64::from(byte);
    if big_endian { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) }
}

/// Bytes of the file, which must hold them all.
fn bytes_at(
    name: &str,
    from: &mut (impl Read + Seek),
    length: u64,
    place: u64,
    count: u64,
) -> Result<Vec<u8>, TerrainError> {
    if place.checked_add(count).is_none_or(|end| end > length) {
        let found = format!("it ends at byte {length}; {count} bytes are wanted at byte {place}");
        return Err(damaged(name, found));
    }
    let mut bytes = vec![0; count as usize];
    from.seek(SeekFrom::Start(place))
        .and_then(|_| from.read_exact(&mut bytes))
        .map_err(|error| damaged(name, error.to_string()))?;
    Ok(bytes)
}
