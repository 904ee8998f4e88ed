//! The rover presets: each is a whole vehicle, and each drives as one.

use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{PlannerError, Preset, SlipClass, Traversability, Vehicle};
use wisdom_terrain::Layer;

#[test]
fn every_preset_states_every_number_of_a_sound_vehicle() {
    for preset in Preset::all() {
        let name = preset.name();
        // Unknown keys are errors, so as many keys as a vehicle has fields are all of them.
        assert_eq!(preset.table().len(), 20, "{name}");
        assert_eq!(preset.vehicle().validate(), Ok(()), "{name}");
        assert!(!preset.summary().is_empty(), "{name}");
    }
}

fn preset(name: &str) -> Preset {
    Preset::named(name).expect("a preset")
}

#[test]
fn every_preset_says_that_it_is_one_and_where_its_numbers_come_from() {
    for preset in Preset::all() {
        let (name, text) = (preset.name(), preset.text());
        assert!(text.contains("This is a preset"), "{name}");
        assert!(text.contains("Heverly et al. (2013)"), "{name}");
        // Whatever stands together begins with a comment.
        let vehicle = &text[text.find("[rover.vehicle]").expect("a vehicle")..];
        for together in vehicle.split("\n\n") {
            let first = together.lines().find(|line| !line.starts_with('['));
            assert!(first.is_some_and(|line| line.starts_with("# ")), "{name}: {together}");
        }
    }
}

#[test]
fn presets_differ() {
    let vehicles: Vec<Vehicle> = Preset::all().iter().map(|preset| preset.vehicle()).collect();
    assert_eq!(vehicles.len(), 4);
    for (index, vehicle) in vehicles.iter().enumerate() {
        assert!(!vehicles[..index].contains(vehicle), "{index}");
    }
    assert!(preset("mer").vehicle().mass_kg < preset("exomars").vehicle().mass_kg);
    assert!(preset("exomars").vehicle().speed_m_s < preset("m2020").vehicle().speed_m_s);
    assert!(preset("mer").vehicle().step_max_m < preset("msl").vehicle().step_max_m);
}

#[test]
fn an_unknown_preset_is_refused_with_the_names_there_are() {
    let refused = Preset::named("sojourner").unwrap_err();
    assert_eq!(
        refused,
        PlannerError::UnknownPreset {
            name: "sojourner".into(),
            known: "mer, msl, m2020, exomars".into()
        }
    );
    assert_eq!(
        refused.to_string(),
        "no preset is named `sojourner`; there are mer, msl, m2020, exomars"
    );
    for preset in Preset::all() {
        assert_eq!(Preset::named(preset.name()).as_ref(), Ok(preset));
    }
}

/// A plain, and a cliff of three metres across it.
#[test]
fn every_preset_drives_a_plain_and_stops_at_a_cliff() {
    let spec = GridSpec::new(20, 20, 1.0).expect("a small grid");
    let cliff = |cell: Cell| if cell.col < 10 { 0.0 } else { 3.0 };
    let heights = Layer::certain(Raster::from_fn(spec, cliff)).expect("heights are finite");
    for preset in Preset::all() {
        let ground = Traversability::new(&preset.vehicle(), &heights).expect("a sound vehicle");
        for row in 0..20 {
            assert!(!ground.is_blocked(Cell::new(row, 2)), "{}", preset.name());
            assert!(!ground.is_blocked(Cell::new(row, 17)), "{}", preset.name());
            assert!(ground.is_blocked(Cell::new(row, 9)), "{}", preset.name());
            assert!(ground.is_blocked(Cell::new(row, 10)), "{}", preset.name());
        }
        let step = ground.edge(Cell::new(5, 2), Cell::new(5, 3)).expect("flat ground is driven");
        assert!(step.time_s > 1.0 / preset.vehicle().speed_m_s);
    }
}

/// Sand of 20 degrees stops each of them, bedrock none; what is not known counts as sand.
#[test]
fn every_preset_slips_on_sand() {
    let spec = GridSpec::new(12, 12, 1.0).expect("a small grid");
    let slope = |cell: Cell| (cell.row as f64 * 20f64.to_radians().tan()) as f32;
    let heights = Layer::certain(Raster::from_fn(spec, slope)).expect("heights are finite");
    let middle = Cell::new(6, 6);
    for preset in Preset::all() {
        let on = |class: f32, u: f32| {
            let classes = Layer::new(Raster::filled(spec, class), Raster::filled(spec, u));
            let classes = classes.expect("a class and its u");
            Traversability::on_classes(&preset.vehicle(), &heights, Some(&classes))
                .expect("a sound vehicle")
                .is_blocked(middle)
        };
        assert!(on(1.0, 0.0), "{}", preset.name());
        assert!(!on(3.0, 0.0), "{}", preset.name());
        assert!(on(3.0, 1.0), "{}", preset.name());
    }
}

/// As a mission file would: the preset's table, some keys replaced.
#[test]
fn single_keys_of_a_preset_can_be_replaced() {
    let mut table = preset("m2020").table();
    let own: toml::Table = toml::from_str(
        "mass-kg = 950.0\nslip-class = [{ class = 7, name = \"dune\", base = 0.1, growth-per-deg = 0.2 }]",
    )
    .expect("TOML");
    table.extend(own);
    let vehicle: Vehicle = table.try_into().expect("known keys");
    let dune = SlipClass { class: 7, name: "dune".into(), base: 0.1, growth_per_deg: 0.2 };
    assert_eq!(
        vehicle,
        Vehicle { mass_kg: 950.0, slip_class: vec![dune], ..preset("m2020").vehicle() }
    );
    assert_eq!(vehicle.validate(), Ok(()));
}
