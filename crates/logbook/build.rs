//! Generates the record types from `proto/wisdom.proto`, and keeps its descriptor for the logs.

use std::path::PathBuf;
use std::{env, fs};

use prost::Message as _;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=proto/wisdom.proto");
    let descriptors = protox::compile(["proto/wisdom.proto"], ["proto"])?;
    // What the logs carry needs neither comments nor positions.
    let mut embedded = descriptors.clone();
    for file in &mut embedded.file {
        file.source_code_info = None;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    fs::write(out.join("wisdom.binpb"), embedded.encode_to_vec())?;
    prost_build::Config::new()
        .enable_type_names()
        .type_attribute(".", "#[derive(serde::Serialize)]")
        .compile_fds(descriptors)?;
    Ok(())
}
