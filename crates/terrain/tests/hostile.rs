//! Hostile files: no panic, and no more room than the bytes that are there warrant.

use proptest::prelude::*;
use wisdom_terrain::format;

/// A fixture with the file beside it.
struct Seed {
    name: &'static str,
    file: Vec<u8>,
    beside: Vec<u8>,
}

fn bytes(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(path).expect("a file of tests/data")
}

/// Every format but GeoTIFF, which has a bound of its own below.
fn seeds() -> Vec<Seed> {
    let seed = |name, beside: &str| Seed {
        name,
        file: bytes(name),
        beside: if beside.is_empty() { Vec::new() } else { bytes(beside) },
    };
    vec![
        seed("pds3_hirise_style.img", ""),
        seed("pds4.xml", "pds4.img"),
        seed("isis.cub", ""),
        seed("height16.png", "height16.png.toml"),
        seed("ref.npy", "height16.png.toml"),
        seed("grid.asc", "grid.prj"),
    ]
}

/// Room that reading may take for each byte that is there: the nodes of a label of many tiny elements are the most.
const ROOM_A_BYTE: u64 = 64;
/// And beside that: what the PNG decoder is allowed, and its tables.
const ROOM: u64 = 8 << 20;
/// Deflate makes at most 1032 bytes of one, and each grey byte is a cell of 5 bytes.
const ROOM_A_BYTE_OF_PNG: u64 = 1032 * 6;

/// Reads, and checks what was taken and what came of it.
fn check(name: &str, file: &[u8], beside: &[u8]) {
    let mut result = None;
    let found = allocation_counter::measure(|| {
        let sibling = |_: &str| (!beside.is_empty()).then(|| beside.to_vec());
        result = Some(format::read_bands_with(name, file, &mut { sibling }));
    });
    let each = if file.starts_with(b"\x89PNG") { ROOM_A_BYTE_OF_PNG } else { ROOM_A_BYTE };
    let limit = ROOM + each * (file.len() + beside.len()) as u64;
    assert!(found.bytes_max <= limit, "{name}: {} bytes, at most {limit}", found.bytes_max);
    for band in result.expect("it was read").into_iter().flatten() {
        assert!(band.raster.values().iter().all(|value| value.is_finite()), "{name}");
        assert!(band.into_layer().is_ok(), "{name}");
    }
}

/// Labels and headers at every byte, samples at every 97th.
#[test]
fn a_file_cut_at_any_byte_neither_panics_nor_takes_room() {
    const HEADER: usize = 2048;
    for Seed { name, file, beside } in seeds() {
        let cuts = (0..HEADER.min(file.len())).chain((HEADER..file.len()).step_by(97));
        for cut in cuts {
            check(name, &file[..cut], &beside);
        }
        for cut in (0..beside.len()).step_by(31) {
            check(name, &file, &beside[..cut]);
        }
    }
}

/// Numbers that overflow something: as four bytes, and as digits.
const HOSTILE: [u32; 8] =
    [0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF, 0x0001_0000, 0xFFFF_0000, 0x0400_0001];
const HOSTILE_TEXT: [&str; 12] = [
    "0",
    "-1",
    "65535",
    "65536",
    "67108864",
    "4294967296",
    "1099511627776",
    "18446744073709551615",
    "99999999999999999999",
    "1e308",
    "nan",
    "inf",
];

/// The places where a number stands in the first bytes of a text.
fn numbers(file: &[u8], within: usize) -> Vec<(usize, usize)> {
    let head = &file[..file.len().min(within)];
    let mut found = Vec::new();
    let mut at = 0;
    while at < head.len() {
        let digits = head[at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        if digits > 0 {
            found.push((at, at + digits));
        }
        at += digits.max(1);
    }
    found
}

/// Every number of every label becomes every hostile number, one at a time.
#[test]
fn no_number_of_a_label_makes_the_reader_panic_or_take_room() {
    for Seed { name, file, beside } in seeds() {
        // The header of the text grid, and the whole label of the others.
        let within = if name == "grid.asc" { 120 } else { 7200 };
        for (from, to) in numbers(&file, within) {
            for text in HOSTILE_TEXT {
                check(name, &[&file[..from], text.as_bytes(), &file[to..]].concat(), &beside);
            }
        }
        for (from, to) in numbers(&beside, 1000) {
            for text in HOSTILE_TEXT {
                check(name, &file, &[&beside[..from], text.as_bytes(), &beside[to..]].concat());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn a_file_with_changed_bytes_neither_panics_nor_takes_room(
        which in 0..6_usize,
        changes in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 0..4),
        number in prop::option::of((0.0..1.0_f64, 0..HOSTILE.len(), any::<bool>())),
        in_header in any::<bool>(),
        in_beside in prop::bool::weighted(0.2),
    ) {
        let Seed { name, mut file, mut beside } = seeds().swap_remove(which);
        let target = if in_beside && !beside.is_empty() { &mut beside } else { &mut file };
        let span = if in_header { 2048.min(target.len()) } else { target.len() };
        let at = |place: f64| (place * span as f64) as usize;
        for (place, byte) in changes {
            target[at(place)] = byte;
        }
        if let Some((place, which, big)) = number {
            let number = HOSTILE[which];
            let number = if big { number.to_be_bytes() } else { number.to_le_bytes() };
            let from = at(place).min(target.len() - 4);
            target[from..from + 4].copy_from_slice(&number);
        }
        check(name, &file, &beside);
    }

    #[test]
    fn random_bytes_behind_any_magic_neither_panic_nor_take_room(
        which in 0..8_usize,
        noise in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        let magic: [&[u8]; 8] = [
            b"PDS_VERSION_ID = PDS3\n",
            b"CCSD3ZF0000100000001NJPL3IF0PDSX00000001\nPDS_VERSION_ID = PDS3\n",
            b"<?xml version=\"1.0\"?>",
            b"Object = IsisCube\n",
            b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR",
            b"\x93NUMPY\x01\0",
            b"ncols 3\nnrows ",
            b"<Product_Observational>",
        ];
        check("random.asc", &[magic[which], &noise].concat(), &noise);
    }
}

/// Eight cells in a strip of a GeoTIFF, said to be many more: refused, or read as far as the decoder's own limit.
#[test]
fn numbers_of_a_geotiff_neither_panic_nor_take_more_than_the_largest_image() {
    // The largest image as the decoder's doubles, the stored samples beside them, and the grid made of it.
    let limit = (format::MAX_CELLS * 24) as u64;
    for name in
        ["f32_strip_lzw_p3.tif", "f32_tiled_deflate_p3_bigtiff.tif", "i16_tiled_deflate_p2.tif"]
    {
        let file = bytes(name);
        for at in (0..512).step_by(7) {
            for number in [HOSTILE[2], HOSTILE[4], HOSTILE[6]] {
                let mut file = file.clone();
                file[at..at + 4].copy_from_slice(&number.to_le_bytes());
                let found = allocation_counter::measure(|| {
                    let read = format::read_bands(name, &file);
                    assert!(read.into_iter().flatten().all(|band| band.into_layer().is_ok()));
                });
                assert!(found.bytes_max <= limit, "{name} at {at}: {} bytes", found.bytes_max);
            }
        }
    }
}

/// The little-endian directory of a classic TIFF: places of its entries.
fn entries(file: &[u8]) -> Vec<usize> {
    let start = u32::from_le_bytes(file[4..8].try_into().expect("four bytes")) as usize;
    let count =
        usize::from(u16::from_le_bytes(file[start..start + 2].try_into().expect("two bytes")));
    (0..count).map(|i| start + 2 + 12 * i).collect()
}

#[test]
fn values_at_byte_nought_are_values_of_the_file_not_of_the_directory() {
    let file = bytes("f32_strip_lzw_p3.tif");
    for entry in entries(&file) {
        let mut file = file.clone();
        file[entry + 8..entry + 12].fill(0);
        drop(format::read("nought.tif", &file));
        // More values, all of them said to lie there.
        file[entry + 4..entry + 8].copy_from_slice(&300u32.to_le_bytes());
        drop(format::read("nought.tif", &file));
    }
}

#[test]
fn more_bands_or_longer_texts_than_any_image_has_are_refused() {
    let file = bytes("u16_strip_none.tif");
    let entry = |tag: u16| {
        let all = entries(&file);
        *all.iter().find(|&&at| file[at..at + 2] == tag.to_le_bytes()).expect("the tag is there")
    };
    // SamplesPerPixel
    let mut many = file.clone();
    let at = entry(277);
    many[at + 8..at + 10].copy_from_slice(&u16::MAX.to_le_bytes());
    let told = format::read("many.tif", &many).unwrap_err().to_string();
    assert!(told.contains("65535 bands; at most 64"), "{told}");
    // GDAL's nodata and metadata: texts appended to the file.
    for (tag, length, words) in
        [(42113_u16, 1000_usize, "1000 bytes; a number"), (42112, 2 << 20, "at most")]
    {
        let mut long = file.clone();
        let (at, place) = (entry(tag), file.len() as u32);
        long[at + 4..at + 8].copy_from_slice(&(length as u32).to_le_bytes());
        long[at + 8..at + 12].copy_from_slice(&place.to_le_bytes());
        long.resize(file.len() + length, b'7');
        let told = format::read("long.tif", &long).unwrap_err().to_string();
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn labels_without_end_are_refused() {
    let keys = |head: &str, line: &str, times: usize| {
        format!("{head}\n{}", line.repeat(times)).into_bytes()
    };
    for head in ["PDS_VERSION_ID = PDS3", "Object = IsisCube"] {
        check("endless.lbl", &keys(head, "A=1\n", 1_000_000), &[]);
        check("deep.lbl", &keys(head, "OBJECT=A\n", 500_000), &[]);
        check("sequence.lbl", &keys(head, "A=(((((((((((((((", 200_000), &[]);
        check("quoted.lbl", &keys(head, "A=\"x", 400_001), &[]);
        check("comment.lbl", &keys(head, "/* ", 400_000), &[]);
        check("ends.lbl", &keys(head, "END_GROUP\n", 400_000), &[]);
        let error = format::read("e.lbl", &keys(head, "A=1\n", 1_000_000)).unwrap_err().to_string();
        assert!(error.contains("more than 65536 statements"), "{error}");
        let error = format::read("e.lbl", &keys(head, "  \n", 3_000_000)).unwrap_err().to_string();
        assert!(error.contains("no END"), "{error}");
    }
}

#[test]
fn xml_that_is_deep_wide_or_a_bomb_is_refused() {
    let refused = |text: &str| {
        check("bomb.xml", text.as_bytes(), &[]);
        format::read("bomb.xml", text.as_bytes()).unwrap_err().to_string()
    };
    let bomb = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;&b;\">\
        <!ENTITY d \"&c;&c;&c;&c;\"><!ENTITY e \"&d;&d;&d;&d;\">]><Product_Observational>&e;</Product_Observational>";
    assert!(refused(bomb).contains("DTD"), "{}", refused(bomb));
    let outside =
        "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]><a>&b;</a>";
    assert!(refused(outside).contains("DTD"), "{}", refused(outside));
    let deep = format!("<?xml version=\"1.0\"?>{}", "<a>".repeat(150_000));
    assert!(refused(&deep).contains("not sound XML"), "{}", refused(&deep));
    let closed =
        format!("<?xml version=\"1.0\"?>{}{}", "<a>".repeat(60_000), "</a>".repeat(60_000));
    assert!(refused(&closed).contains("no array"), "{}", refused(&closed));
    let wide = format!("<?xml version=\"1.0\"?><a>{}</a>", "<b/>".repeat(150_000));
    assert!(refused(&wide).contains("not sound XML"), "{}", refused(&wide));
    let start = "<?xml version=\"1.0\"?>".to_owned();
    let attributes =
        (0..100_000).fold(format!("{start}<a"), |text, i| text + &format!(" a{i}=\"\""));
    let found = refused(&attributes);
    assert!(found.contains("100000 attributes in one element; at most 1000"), "{found}");
    let spaces = (0..30_000).fold(start, |text, i| text + &format!("<a xmlns:n{i}=\"u{i}\">"));
    let found = refused(&spaces);
    assert!(found.contains("30000 name spaces; at most 200 are read"), "{found}");
    let long = format!("<?xml version=\"1.0\"?><a>{}</a>", " ".repeat(5_000_000));
    assert!(refused(&long).contains("at most 1048576 are read"), "{}", refused(&long));
}

#[test]
fn side_files_and_projection_files_that_are_deep_or_long_are_refused() {
    let npy = bytes("ref.npy");
    for text in ["[".repeat(60_000), format!("a = {}", "[".repeat(60_000)), "a.".repeat(30_000)] {
        check("ref.npy", &npy, text.as_bytes());
        assert!(
            format::read_with("ref.npy", &npy, &mut |_| Some(text.clone().into_bytes())).is_err()
        );
    }
    let asc = bytes("grid.asc");
    let deep = "PROJCS[".repeat(9000);
    check("grid.asc", &asc, deep.as_bytes());
    assert!(format::read_with("grid.asc", &asc, &mut |_| Some(deep.clone().into_bytes())).is_err());
}

/// What the fuzzer starts from reaches the end of each reader.
#[test]
fn every_seed_of_the_fuzzer_is_read() {
    const BESIDE: &[u8] = b"\n<BESIDE>\n";
    let folder = format!("{}/fuzz/corpus/read", env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the seeds") {
        let path = entry.expect("a folder's entry").path();
        // What a run has added has a name without an extension.
        if path.extension().is_none() {
            continue;
        }
        let all = std::fs::read(&path).expect("a seed");
        let cut = all.windows(BESIDE.len()).position(|window| window == BESIDE);
        let (file, beside) = match cut {
            Some(at) => (&all[..at], Some(&all[at + BESIDE.len()..])),
            None => (&all[..], None),
        };
        let read = format::read_with("seed.asc", file, &mut |_| beside.map(<[u8]>::to_vec));
        assert!(read.is_ok(), "{}: {}", path.display(), read.unwrap_err());
        count += 1;
    }
    assert_eq!(count, 20);
}
