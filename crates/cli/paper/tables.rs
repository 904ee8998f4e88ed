//! Tables 1 to 9: the printed numbers, and what the crates make of the same sources.

use anyhow::Context;
use wisdom_belief::{
    BeliefError, Frame, InterestMass, MassFunction, Opinion, ParadoxPolicy, Rule, Uncertainty, rule,
};
use wisdom_fusion::LookupTable;
use wisdom_mission::Mission;

use super::check::{Against, Check};
use super::expected::Point;
use crate::exit::InputError;

/// Sums and products of two-decimal masses are exact but for binary rounding.
pub(super) const EXACT: f64 = 1e-12;
/// Table 7's last digits differ from exact arithmetic by up to 7e-8.
const TABLE_7: f64 = 1e-7;
/// Half of the last of four printed decimals.
const FOUR_DECIMALS: f64 = 5e-5;
/// Half of the last of three printed decimals.
const THREE_DECIMALS: f64 = 5e-4;

/// A row of Tables 1 and 2: the band [lo, hi), and m(I ∩ NI), m(NI), m(I).
type Band = (f32, f32, [f64; 3]);

const TABLE_1: [Band; 6] = [
    (0.0, 1.0, [0.20, 0.80, 0.0]),
    (1.0, 3.0, [0.30, 0.60, 0.10]),
    (3.0, 5.0, [0.10, 0.10, 0.80]),
    (5.0, 7.0, [0.15, 0.05, 0.80]),
    (7.0, 9.0, [0.05, 0.05, 0.90]),
    (9.0, f32::INFINITY, [0.05, 0.0, 0.95]),
];

const TABLE_2: [Band; 5] = [
    (0.0, 20.0, [0.20, 0.80, 0.0]),
    (20.0, 40.0, [0.40, 0.50, 0.10]),
    (40.0, 60.0, [0.05, 0.0, 0.95]),
    (60.0, 80.0, [0.15, 0.05, 0.80]),
    (80.0, 100.0, [0.05, 0.05, 0.90]),
];

/// Table 3; class 0 is in no database.
const TABLE_3: [(u8, [f64; 3]); 5] = [
    (0, [0.20, 0.80, 0.0]),
    (1, [0.30, 0.60, 0.10]),
    (2, [0.10, 0.10, 0.80]),
    (3, [0.15, 0.05, 0.80]),
    (4, [0.05, 0.0, 0.95]),
];

/// Table 5: m(I), m(NI), m(I ∪ NI), m(I ∩ NI), Bel(I).
const TABLE_5_DST: [f64; 5] = [0.4975, 0.4975, 0.005, 0.0, 0.4975];
const TABLE_5_DSMT: [f64; 5] = [0.0099, 0.0099, 0.0001, 0.9801, 0.99];

/// Table 6: m(I), m(NI), m(I ∪ NI), m(I ∩ NI) of the three experts.
const TABLE_6: [(&str, [f64; 4]); 3] = [
    ("gradient", [0.8, 0.05, 0.0, 0.15]),
    ("texture", [0.323, 0.0, 0.66, 0.017]),
    ("temperature", [0.0, 0.648, 0.19, 0.162]),
];

/// Table 7, as Table 5.
const TABLE_7_DSMT: [f64; 5] = [0.149_416, 0.027_654, 0.0, 0.822_930_04, 0.972_346_07];

/// Table 8, as Table 6.
const TABLE_8: [(&str, [f64; 4]); 3] = [
    ("gradient", [0.8, 0.05, 0.15, 0.0]),
    ("texture", [0.323, 0.0, 0.677, 0.0]),
    ("temperature", [0.0, 0.648, 0.352, 0.0]),
];

/// Table 9, as Table 5.
const TABLE_9_DST: [f64; 5] = [0.6881, 0.2296, 0.0824, 0.0, 0.6881];

const NAMES: [&str; 5] = ["m(I)", "m(NI)", "m(I ∪ NI)", "m(I ∩ NI)", "Bel(I)"];

/// The tables of the paper's three experts.
pub(super) struct Panel<'a> {
    pub(super) gradient: &'a LookupTable,
    pub(super) texture: &'a LookupTable,
    pub(super) temperature: &'a LookupTable,
}

impl<'a> Panel<'a> {
    /// The experts of a mission, by the layers they read.
    pub(super) fn of(mission: &'a Mission) -> Result<Self, InputError> {
        let reader = |layer: &str| {
            let mut readers = mission.spec.experts.iter().filter(|expert| expert.layer == layer);
            match (readers.next(), readers.next()) {
                (Some(expert), None) => Ok(&expert.table),
                _ => Err(InputError(format!(
                    "mission `{}`: the paper has one expert that reads `{layer}`",
                    mission.name
                ))),
            }
        };
        Ok(Self {
            gradient: reader("gradient")?,
            texture: reader("texture")?,
            temperature: reader("temperature")?,
        })
    }

    /// What the experts say at the paper's point: rows of their tables, discounted (Eq. 4, Table 6).
    pub(super) fn table_6(&self, point: &Point) -> Result<[InterestMass; 3], BeliefError> {
        let seen = |table: &LookupTable, reading: f32, u| {
            Ok(table.mass(reading).discounted(Uncertainty::new(u)?))
        };
        Ok([
            seen(self.gradient, point.gradient as f32, point.dem_uncertainty)?,
            seen(self.texture, point.texture, point.texture_uncertainty)?,
            seen(self.temperature, point.temperature as f32, point.thermal_uncertainty)?,
        ])
    }
}

/// Tables 1 to 9.
pub(super) fn checks(panel: &Panel<'_>, point: &Point) -> anyhow::Result<Vec<Check>> {
    let mut checks = tables_1_to_3(panel);

    let table_4 = table_4()?;
    let group = "Table 5, DST: contradicting experts under Dempster's rule";
    let within = [FOUR_DECIMALS, FOUR_DECIMALS, THREE_DECIMALS, EXACT, FOUR_DECIMALS];
    fused(&mut checks, group, Rule::Dempster, &table_4, TABLE_5_DST, within)?;
    let group = "Table 5, DSmT: contradicting experts under DSmC";
    fused(&mut checks, group, Rule::Dsmc, &table_4, TABLE_5_DSMT, [EXACT; 5])?;

    let sources = panel.table_6(point).context("Table 6")?;
    sources_as(
        &mut checks,
        "Table 6: the experts at (67, 20), discounted by Eq. 4",
        &sources,
        &TABLE_6,
    );
    let group = "Table 7: (67, 20) under DSmC (the paper's digits are off by up to 7e-8)";
    fused(&mut checks, group, Rule::Dsmc, &sources, TABLE_7_DSMT, [TABLE_7; 5])?;
    let moved = sources.map(|source| ParadoxPolicy::ToIgnorance.apply(source));
    sources_as(&mut checks, "Table 8: the paradox moved to ignorance", &moved, &TABLE_8);
    let group = "Table 9: (67, 20) under Dempster's rule";
    fused(&mut checks, group, Rule::Dempster, &sources, TABLE_9_DST, [FOUR_DECIMALS; 5])?;

    let group =
        "Table 8's choice: other places for the paradox, said not to matter, under Dempster's rule";
    for policy in ParadoxPolicy::ALL.into_iter().filter(|&policy| Rule::Dempster.admits(policy)) {
        let mass = Rule::Dempster.fuse(&sources, policy).mass;
        let values = [mass.interesting(), mass.not_interesting(), mass.ignorance()];
        for (name, value) in NAMES.into_iter().zip(values) {
            checks.push(Check::new(group, format!("{policy}: {name}"), value, Against::Nothing));
        }
    }
    checks.extend(asides(panel, &sources)?);
    Ok(checks)
}

/// Each row of the mission's tables, read at both ends of its band.
fn tables_1_to_3(panel: &Panel<'_>) -> Vec<Check> {
    let group =
        "Tables 1 to 3: largest difference of a row's masses, read at both ends of its band";
    let mut checks = Vec::new();
    let mut row = |name: String, table: &LookupTable, readings: &[f32], printed: [f64; 3]| {
        let off = readings.iter().map(|&reading| {
            let Opinion { paradox, not_interesting, interesting } = table.opinion(reading);
            largest_gap(&[paradox, not_interesting, interesting], &printed)
        });
        checks.push(Check::printed(group, name, off.fold(0.0, f64::max), 0.0, EXACT));
    };
    for (table, name, bands) in
        [(panel.gradient, "Table 1", &TABLE_1[..]), (panel.temperature, "Table 2", &TABLE_2[..])]
    {
        for &(lo, hi, printed) in bands {
            row(format!("{name}, [{lo}, {hi})"), table, &[lo, hi.next_down()], printed);
        }
    }
    for (class, printed) in TABLE_3 {
        row(format!("Table 3, texture {class}"), panel.texture, &[f32::from(class)], printed);
    }
    checks
}

/// Two experts who contradict each other.
fn table_4() -> Result<[InterestMass; 2], BeliefError> {
    let first = Opinion { interesting: 0.99, ..Opinion::default() };
    let second = Opinion { not_interesting: 0.99, ..Opinion::default() };
    Ok([InterestMass::try_from(first)?, InterestMass::try_from(second)?])
}

/// A printed table of fused masses: the closed form against the print, the general algorithm against it.
fn fused(
    checks: &mut Vec<Check>,
    group: &'static str,
    rule: Rule,
    sources: &[InterestMass],
    printed: [f64; 5],
    within: [f64; 5],
) -> Result<(), BeliefError> {
    let mass = rule.fuse(sources, ParadoxPolicy::ToIgnorance).mass;
    let [i, ni, theta, paradox] = masses(mass);
    let computed = [i, ni, theta, paradox, mass.belief()];
    for (k, name) in NAMES.into_iter().enumerate() {
        checks.push(Check::printed(group, name, computed[k], printed[k], within[k]).decimals(8));
    }
    let general = on_a_frame(rule, sources)?;
    let name = "largest difference of the general algorithm";
    checks.push(Check::printed(group, name, largest_gap(&computed, &general), 0.0, EXACT));
    Ok(())
}

/// m(I), m(NI), m(I ∪ NI), m(I ∩ NI) and Bel(I) by the algorithm for any frame.
fn on_a_frame(rule: Rule, sources: &[InterestMass]) -> Result<[f64; 5], BeliefError> {
    let frame = Frame::interest(rule.model())?;
    let exclusive = rule != Rule::Dsmc;
    let bodies = sources
        .iter()
        .map(|&source| {
            let kept = if exclusive { ParadoxPolicy::ToIgnorance.apply(source) } else { source };
            kept.mass_function(&frame)
        })
        .collect::<Result<Vec<MassFunction>, _>>()?;
    let fused = rule::combine(rule, &bodies, &frame)?;
    let [i, ni] = [frame.parse("I")?, frame.parse("NI")?];
    let [i_ni, paradox] = [fused.mass(i | ni), fused.mass(i & ni)];
    Ok([fused.mass(i), fused.mass(ni), i_ni, paradox, fused.belief(i)])
}

/// A printed table of sources.
fn sources_as(
    checks: &mut Vec<Check>,
    group: &'static str,
    sources: &[InterestMass; 3],
    printed: &[(&str, [f64; 4]); 3],
) {
    for (&source, (expert, printed)) in sources.iter().zip(printed) {
        for ((name, computed), &value) in NAMES.into_iter().zip(masses(source)).zip(printed) {
            let name = format!("{expert}: {name}");
            checks.push(Check::printed(group, name, computed, value, EXACT).decimals(6));
        }
    }
}

/// What follows from the paper's choices, and it does not say.
fn asides(panel: &Panel<'_>, table_6: &[InterestMass]) -> Result<Vec<Check>, BeliefError> {
    let group = "Not in the paper: what the free model makes of dull and of hidden ground";
    let dull = [panel.gradient.mass(0.0), panel.temperature.mass(0.0), panel.texture.mass(0.0)];
    let bel = |sources: &[InterestMass]| {
        Rule::Dsmc.fuse(sources, ParadoxPolicy::ToIgnorance).mass.belief()
    };
    let hidden = dull.map(|source| source.discounted(Uncertainty::UNKNOWN));
    let frame = Frame::interest(Rule::Dsmc.model())?;
    let bodies = table_6.iter().map(|s| s.mass_function(&frame)).collect::<Result<Vec<_>, _>>()?;
    let pl = rule::combine(Rule::Dsmc, &bodies, &frame)?.plausibility(frame.parse("I")?);
    let told = |name, value| Check::new(group, name, value, Against::Nothing);
    Ok(vec![
        told("Bel(I) where all three find nothing, for certain", bel(&dull)),
        told("Bel(I) where all three see nothing", bel(&hidden)),
        told("Pl(I) at (67, 20)", pl),
    ])
}

fn masses(mass: InterestMass) -> [f64; 4] {
    [mass.interesting(), mass.not_interesting(), mass.ignorance(), mass.paradox()]
}

fn largest_gap(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
