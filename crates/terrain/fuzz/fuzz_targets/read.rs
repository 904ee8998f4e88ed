//! Any bytes as any format: no panic, no room made for what is not there, and only finite readings.

#![no_main]

use libfuzzer_sys::fuzz_target;
use wisdom_terrain::format;

/// Parts the file from the one beside it.
const BESIDE: &[u8] = b"\n<BESIDE>\n";

fuzz_target!(|input: &[u8]| {
    let cut = input.windows(BESIDE.len()).position(|window| window == BESIDE);
    let (file, beside) = match cut {
        Some(at) => (&input[..at], Some(&input[at + BESIDE.len()..])),
        None => (input, None),
    };
    // By this name bytes of no known format are read as a text grid.
    let bands = format::read_bands_with("fuzz.asc", file, &mut |_| beside.map(<[u8]>::to_vec));
    for band in bands.into_iter().flatten() {
        let layer = band.into_layer().expect("readings are finite, each u is 0 or 1");
        assert!(layer.values().values().iter().all(|value| value.is_finite()));
    }
});
