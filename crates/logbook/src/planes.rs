//! The planes of a decision's maps, by name.

use std::borrow::Cow;
use std::collections::BTreeSet;

use wisdom_autonomy::{Autonomy, Spec};
use wisdom_fusion::{Rows, credit};
use wisdom_grid::Raster;
use wisdom_planner::{FieldOptions, field};

/// What kind of thing a plane tells of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneGroup {
    /// The fused evidence and what it is worth.
    Interest,
    /// A layer as the decision used it: everything read until then, or derived from that.
    Layer,
    /// A layer's uncertainty u.
    Uncertainty,
    /// How the ground may be crossed.
    Ground,
    /// What one expert says, discounted, before fusion.
    Mass,
    /// One expert's share in the interest.
    Credit,
}

impl PlaneGroup {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Interest => "interest",
            Self::Layer => "layer",
            Self::Uncertainty => "uncertainty",
            Self::Ground => "ground",
            Self::Mass => "mass",
            Self::Credit => "credit",
        }
    }
}

/// A plane that every decision of a mission has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlaneInfo {
    /// Its name: what [`plane`] is asked, and after `/map/` the topic it is logged on.
    pub name: String,
    /// What it tells, in words.
    pub label: String,
    /// Its unit; `1` for shares and chances.
    pub unit: String,
    /// What kind of thing it tells of.
    pub group: PlaneGroup,
    /// Classes that its values stand for, with their names, where it is no quantity.
    pub classes: Vec<(i32, String)>,
}

impl PlaneInfo {
    fn share(name: impl Into<String>, label: impl Into<String>, group: PlaneGroup) -> Self {
        Self {
            name: name.into(),
            label: label.into(),
            unit: "1".to_owned(),
            group,
            classes: vec![],
        }
    }
}

/// The masses of an expert by the names they have in planes, in the order of [`wisdom_belief::InterestMass::masses`].
const MASSES: [(&str, &str); 4] = [
    ("interesting", "m(I)"),
    ("not-interesting", "m(NI)"),
    ("ignorance", "m(I ∪ NI)"),
    ("paradox", "m(I ∩ NI)"),
];

/// Every plane of a mission's decisions: `interest`, `ignorance`, `paradox`, `conflict`, `contradiction` and `prize`; the
/// mission's layers, and each with `-u` for its uncertainty; `hazard` (per metre), `blocked` (0 or 1) and `reliability`, the
/// chance to reach a cell from where the rover stood; for each expert `mass-interesting-NAME`, `mass-not-interesting-NAME`,
/// `mass-ignorance-NAME`, `mass-paradox-NAME` and `credit-NAME`.
#[must_use]
pub fn planes(spec: &Spec) -> Vec<PlaneInfo> {
    use PlaneGroup::{Credit, Ground, Interest, Layer, Mass, Uncertainty};
    let statistic = spec.fusion.statistic;
    let mut all = vec![
        PlaneInfo::share("interest", format!("interest ({statistic})"), Interest),
        PlaneInfo::share("ignorance", "ignorance, fused m(I ∪ NI)", Interest),
        PlaneInfo::share("paradox", "paradox, fused m(I ∩ NI)", Interest),
        PlaneInfo::share("conflict", "conflict K", Interest),
        PlaneInfo::share(
            "contradiction",
            "contradiction, largest m_a(I)·m_b(NI) of two experts",
            Interest,
        ),
        PlaneInfo::share("prize", "prize", Interest),
    ];
    for layer in &spec.layers {
        let label = format!("{}, as used", layer.name);
        let share = PlaneInfo::share(&layer.name, label, Layer);
        let classes = classes_of(spec, &layer.name);
        all.push(PlaneInfo { unit: layer.unit.clone(), classes, ..share });
    }
    for layer in &spec.layers {
        let name = &layer.name;
        all.push(PlaneInfo::share(format!("{name}-u"), format!("u of {name}"), Uncertainty));
    }
    all.push(PlaneInfo {
        unit: "1/m".to_owned(),
        ..PlaneInfo::share("hazard", "hazard rate of driving", Ground)
    });
    all.push(PlaneInfo {
        classes: vec![(0, "open".to_owned()), (1, "blocked".to_owned())],
        ..PlaneInfo::share("blocked", "where the rover cannot stand", Ground)
    });
    all.push(PlaneInfo::share("reliability", "chance to reach the cell from the rover", Ground));
    for expert in &spec.experts {
        for (name, symbol) in MASSES {
            let name = format!("mass-{name}-{}", expert.name);
            all.push(PlaneInfo::share(name, format!("{symbol} of {}", expert.name), Mass));
        }
    }
    for expert in &spec.experts {
        let label = format!("credit of {}", expert.name);
        all.push(PlaneInfo::share(format!("credit-{}", expert.name), label, Credit));
    }
    let mut seen = BTreeSet::new();
    all.retain(|plane| seen.insert(plane.name.clone()));
    all
}

/// The classes that experts know of a layer, by the names of the mission's types where it has some.
fn classes_of(spec: &Spec, layer: &str) -> Vec<(i32, String)> {
    let readers = spec.experts.iter().filter(|expert| expert.layer == layer);
    let mut known = BTreeSet::new();
    for expert in readers {
        if let Rows::Classes(rows) = expert.table.rows() {
            known.extend(rows.iter().map(|row| row.class));
        }
    }
    let typed = spec.class_layer.as_deref() == Some(layer);
    let name = |class: i32| {
        let types = &spec.manager.taxonomy;
        let of =
            u16::try_from(class).ok().filter(|_| typed).and_then(|c| types.type_of(c, 0.0, 1.0));
        let name = of.and_then(|of| types.names().nth(of));
        name.map_or_else(|| format!("class {class}"), |name| format!("{class}, {name}"))
    };
    known.into_iter().map(|class| (class, name(class))).collect()
}

/// Whether every decision of such a mission has a plane of that name.
#[must_use]
pub fn is_plane(spec: &Spec, name: &str) -> bool {
    planes(spec).iter().any(|plane| plane.name == name)
}

/// A plane ([`planes`]) that the latest decision of a core was made from, or that follows from it, at the working map's
/// place; none by another name, or before the first decision. What a decision did not need is worked out on the way.
#[must_use]
pub fn plane<'a>(rover: &'a Autonomy, name: &str) -> Option<Cow<'a, Raster<f32>>> {
    let maps = rover.maps()?;
    let fused = &maps.interest;
    let kept = match name {
        "interest" => &fused.interest,
        "ignorance" => &fused.ignorance,
        "paradox" => &fused.paradox,
        "conflict" => &fused.conflict,
        "contradiction" => &fused.contradiction,
        "prize" => &maps.prize.prize,
        _ => match layer(rover, name) {
            Some(layer) => layer,
            None => return made(rover, name).map(Cow::Owned),
        },
    };
    Some(Cow::Borrowed(kept))
}

/// A layer, or its uncertainty.
fn layer<'a>(rover: &'a Autonomy, name: &str) -> Option<&'a Raster<f32>> {
    let layers = &rover.maps()?.layers;
    match (layers.get(name), name.strip_suffix("-u").and_then(|name| layers.get(name))) {
        (Some(layer), _) => Some(layer.values()),
        (None, Some(layer)) => Some(layer.uncertainty()),
        (None, None) => None,
    }
}

/// A plane that is not kept.
fn made(rover: &Autonomy, name: &str) -> Option<Raster<f32>> {
    let maps = rover.maps()?;
    match name {
        "hazard" => return Some(maps.ground.hazard().clone()),
        "blocked" => return Some(maps.ground.blocked().map(|&blocked| f32::from(blocked))),
        "reliability" => return reliability(rover),
        _ => {}
    }
    if let Some(expert) = name.strip_prefix("credit-") {
        return credits(rover, expert);
    }
    let name = name.strip_prefix("mass-")?;
    let (mass, expert) = MASSES
        .iter()
        .enumerate()
        .find_map(|(mass, (kind, _))| Some((mass, name.strip_prefix(kind)?.strip_prefix('-')?)))?;
    let (_, masses) = maps.evidence.experts().find(|(name, _)| *name == expert)?;
    Some(masses.map(|of| of.masses()[mass] as f32))
}

/// The chance to reach each cell from where the rover stood, by the most reliable way; 0 where no way is known.
fn reliability(rover: &Autonomy) -> Option<Raster<f32>> {
    let (maps, decided) = (rover.maps()?, rover.deliberation()?);
    let from = *decided.nodes.first()?;
    let reach = field(&maps.ground, from, &FieldOptions::default());
    let chance = |neg_ln_r: f64| libm::exp(-neg_ln_r) as f32;
    Some(Raster::from_fn(maps.ground.spec(), |cell| reach.neg_ln_r(cell).map_or(0.0, chance)))
}

/// An expert's credit in every cell's interest.
fn credits(rover: &Autonomy, expert: &str) -> Option<Raster<f32>> {
    let maps = rover.maps()?;
    let place = maps.evidence.experts().position(|(name, _)| name == expert)?;
    let (evidence, fusion) = (&maps.evidence, &rover.spec().fusion);
    Some(Raster::par_from_fn(evidence.spec(), |cell| credit(evidence, fusion, cell)[place] as f32))
}
