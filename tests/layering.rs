//! A crate uses only crates before it: the manifests prove it.

use std::collections::BTreeSet;
use std::path::Path;

/// The crates in their order.
const ORDER: [&str; 10] = [
    "grid", "belief", "terrain", "fusion", "planner", "goals", "autonomy", "mission", "logbook",
    "viewer",
];

fn manifest(folder: &Path) -> toml::Table {
    let text =
        std::fs::read_to_string(folder.join("Cargo.toml")).expect("every crate has a manifest");
    text.parse().expect("a manifest is TOML")
}

/// Names in every dependency section of a manifest.
fn dependencies(manifest: &toml::Table) -> BTreeSet<String> {
    ["dependencies", "dev-dependencies", "build-dependencies"]
        .iter()
        .filter_map(|section| manifest.get(*section)?.as_table())
        .flat_map(|table| table.keys().cloned())
        .collect()
}

#[test]
fn a_crate_uses_only_crates_before_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (place, name) in ORDER.iter().enumerate() {
        let used = dependencies(&manifest(&root.join("crates").join(name)));
        for (other_place, other) in ORDER.iter().enumerate() {
            let uses = used.contains(&format!("wisdom-{other}"));
            assert!(!uses || other_place < place, "`{name}` uses `{other}`, which comes after it");
        }
    }
}

#[test]
fn every_crate_folder_is_in_the_order() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found: Vec<String> = std::fs::read_dir(root.join("crates"))
        .expect("the crates")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.join("Cargo.toml").exists())
        .map(|path| path.file_name().expect("a name").to_string_lossy().into_owned())
        .collect();
    found.sort_unstable();
    let mut expected: Vec<String> = ORDER.iter().map(ToString::to_string).collect();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn only_the_logbook_knows_the_container_and_only_goals_and_below_stay_free_of_masses() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ORDER {
        let used = dependencies(&manifest(&root.join("crates").join(name)));
        for container in ["mcap", "foxglove", "prost"] {
            assert!(!used.contains(container) || name == "logbook", "`{name}` uses `{container}`");
        }
    }
    for name in ["planner", "goals"] {
        let used = dependencies(&manifest(&root.join("crates").join(name)));
        assert!(
            !used.contains("wisdom-belief") && !used.contains("wisdom-fusion"),
            "`{name}` sees masses"
        );
    }
}
