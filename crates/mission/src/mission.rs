//! A mission: everything its folder says, checked.

use std::collections::BTreeMap;
use std::path::Path;

use toml_edit::{DocumentMut, Item, Value};
use wisdom_autonomy::{
    ApproachSpec, Budget, Derivation, ELEVATION, Fallback, LayerSpec, MapUpdate, Pace, RouteSpec,
    Source, Spec, Triggers, Word,
};
use wisdom_belief::{InterestMass, Opinion, ParadoxPolicy, Rule};
use wisdom_fusion::{Band, Class, Expert, Fusion, FusionError, LookupTable, Rows, Statistic};
use wisdom_goals::{
    Directive, Domain, DomainError, Extraction, FactSet, Fade, GroundError, GroundPlace, Kind,
    Lifted, MAX_SEQUENCED, ManagerSpec, ObjectText, OperatorPart, OperatorText, Policy,
    Preferences, Prices, PrizeScale, SchemaText, ServiceCost, Taxonomy, TaxonomyError, TypeText,
    UnknownKind, Window as PlanWindow,
};
use wisdom_grid::{Cell, GridSpec};
use wisdom_planner::{PlannerError, Preset, Vehicle};

use crate::MissionError;
use crate::fault::{Fault, FaultKind};
use crate::file::{
    DerivedName, ExpertFile, FaultFile, FaultName, FirstLookU, LabelFile, MissionFile, PriorKind,
    UpdateName,
};
use crate::label::Label;
use crate::supply::{Carried, Files, Folder, Supply};
use crate::truth::{LayerTruth, ReadingKind};
use crate::world::{Execution, Instrument, Prior, World};

/// The name of the file that a mission's folder is read from.
pub const MISSION_FILE: &str = "mission.toml";

/// A change to `mission.toml`, as `--set key=value` gives it: a dotted path (`budget.energy-j`,
/// `directive.0.weight`) and a TOML value; text that is no TOML value is taken as a string.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    /// The dotted path.
    pub key: String,
    /// The value as written.
    pub value: String,
}

impl Override {
    /// A change of one key.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.into() }
    }
}

/// A mission, ready to run.
#[derive(Debug, Clone)]
pub struct Mission {
    /// Its name.
    pub name: String,
    /// One line on what it is.
    pub summary: String,
    /// Seed of everything random in its world.
    pub seed: u64,
    /// What the core is told.
    pub spec: Spec,
    /// What is true, and how the rover senses and moves.
    pub world: World,
    /// Places known to be worth a visit: for scoring, and told to no rover.
    pub labels: Vec<Label>,
    /// The changes it was read with.
    pub overrides: Vec<Override>,
    /// Every file it consists of, by its path in the mission's folder, unchanged but for
    /// `mission.toml`, which has the overrides applied.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Digest over all files, the mission's identity.
    pub digest: [u8; 32],
}

impl Mission {
    /// Reads a mission from its folder, or from its `mission.toml`.
    ///
    /// # Errors
    /// [`MissionError`] naming file, line, column, key, the value found and what was expected.
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self, MissionError> {
        let file = if path.is_dir() { path.join(MISSION_FILE) } else { path.to_path_buf() };
        let name = file
            .file_name()
            .map_or_else(|| MISSION_FILE.into(), |n| n.to_string_lossy().into_owned());
        Self::read(&mut Folder { file: &file }, &name, overrides)
    }

    /// Reads a mission from the files that a log carries.
    ///
    /// # Errors
    /// [`MissionError`] as [`Mission::load`], and for a file that is not among them.
    pub fn from_files(files: &BTreeMap<String, Vec<u8>>) -> Result<Self, MissionError> {
        Self::from_files_with(files, &[])
    }

    /// [`Mission::from_files`] with changes on top of those that its `mission.toml` has applied already.
    ///
    /// # Errors
    /// As [`Mission::from_files`].
    pub fn from_files_with(
        files: &BTreeMap<String, Vec<u8>>,
        overrides: &[Override],
    ) -> Result<Self, MissionError> {
        Self::read(&mut Carried(files), MISSION_FILE, overrides)
    }

    /// Reads all files; `name` is what the mission's own file is called in errors.
    fn read(
        supply: &mut dyn Supply,
        name: &str,
        overrides: &[Override],
    ) -> Result<Self, MissionError> {
        let text = text_of(name, supply.bytes(MISSION_FILE)?)?;
        let text = changed(text, overrides)?;
        let parsed: MissionFile =
            toml::from_str(&text).map_err(|e| MissionError::of_toml(name, &text, &e))?;
        let own = (MISSION_FILE.to_owned(), text.clone().into_bytes());
        let mut files = Files { supply, taken: BTreeMap::from([own]) };
        let reader = Reader { name, file: &parsed, text: &text };
        let (spec, world) = reader.assemble(&mut files)?;
        let labels = reader.labels(spec.grid)?;
        let files = files.taken;
        let mut digest = blake3::Hasher::new();
        for (path, bytes) in &files {
            digest.update(&(path.len() as u64).to_le_bytes());
            digest.update(path.as_bytes());
            digest.update(&(bytes.len() as u64).to_le_bytes());
            digest.update(bytes);
        }
        Ok(Self {
            name: parsed.name.clone(),
            summary: parsed.summary.clone(),
            seed: parsed.seed,
            spec,
            world,
            labels,
            overrides: overrides.to_vec(),
            digest: *digest.finalize().as_bytes(),
            files,
        })
    }
}

pub(crate) fn text_of(file: &str, bytes: Vec<u8>) -> Result<String, MissionError> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let found = error.as_bytes()[valid];
        // What is shown keeps the place: everything before it is UTF-8.
        let text = String::from_utf8_lossy(error.as_bytes());
        let message = format!("byte {found:#04x}; expected UTF-8 text");
        MissionError::at(file, &text, valid..valid + 1, message)
    })
}

/// The text with the overrides applied.
fn changed(text: String, overrides: &[Override]) -> Result<String, MissionError> {
    if overrides.is_empty() {
        return Ok(text);
    }
    // A file that does not parse gets its own error, with its place, later.
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text) };
    for change in overrides {
        apply(change, document.as_item_mut()).map_err(|message| {
            MissionError::of_file("--set", format!("{}={}: {message}", change.key, change.value))
        })?;
    }
    Ok(document.to_string())
}

/// Puts one change into a document; the error says what is wrong with its key.
fn apply(change: &Override, mut item: &mut Item) -> Result<(), String> {
    let value = change.value.parse().unwrap_or_else(|_| Value::from(change.value.as_str()));
    let keys: Vec<&str> = change.key.split('.').collect();
    if keys.iter().any(|key| key.is_empty()) {
        return Err("expected a dotted path such as `budget.energy-j`".into());
    }
    for (depth, key) in keys.iter().enumerate() {
        let is_last = depth + 1 == keys.len();
        let above =
            if depth == 0 { "the file".into() } else { format!("`{}`", keys[..depth].join(".")) };
        if item.as_table_like().is_some() {
            if is_last {
                item[*key] = Item::Value(value);
                return Ok(());
            }
            if item.get(key).is_none() {
                item[*key] = toml_edit::table();
            }
            item = item.get_mut(key).ok_or_else(|| format!("`{key}` cannot be set"))?;
        } else if item.is_array() || item.is_array_of_tables() {
            let index: usize = key
                .parse()
                .map_err(|_| format!("{above} is a list; expected a number, not `{key}`"))?;
            let count = match &*item {
                Item::ArrayOfTables(tables) => tables.len(),
                other => other.as_array().map_or(0, toml_edit::Array::len),
            };
            item = item
                .get_mut(index)
                .ok_or_else(|| format!("{above} has {count} entries, numbered from 0"))?;
            if is_last && item.is_table() {
                return Err(format!("`{}` is a table; expected one of its keys", change.key));
            }
            if is_last {
                *item = Item::Value(value);
                return Ok(());
            }
        } else {
            return Err(format!("{above} is a plain value and holds no `{key}`"));
        }
    }
    Ok(())
}

/// The largest length a mission may name, metres: far beyond any grid, far below overflow in cells.
pub(crate) const FAR_M: f64 = 1e6;

/// The largest cost of one operator, in seconds, joules or megabytes: sums of thousands stay exact enough to
/// compare, and fit the integers the search counts milliseconds in.
pub(crate) const MAX_COST: f64 = 1e9;

/// The widest footprint, in cells of radius: every cell's roughness is fitted over that many, squared.
const MAX_FOOTPRINT_CELLS: f64 = 16.0;

/// The most goals that may be known at once.
pub(crate) const MAX_KNOWN: usize = 1000;

/// The most sequences a family may hold.
pub(crate) const MAX_FAMILY: usize = 100;

/// The most alternatives of one leg: each is a search of its own.
pub(crate) const MAX_ALTERNATIVES: usize = 16;

/// The most plans of one order that a family may hold.
pub(crate) const MAX_FRONT: usize = 1000;

/// The latest mission time a fault may speak of, seconds: some thirty thousand years, and sums of it stay finite.
pub(crate) const LATEST_S: f64 = 1e12;

/// The highest price, in units of prize.
pub(crate) const DEAR: f64 = 1e9;

/// The most poses of one goal.
pub(crate) const MAX_POSES: usize = 4;

/// The set of facts with these names, which may name objects where the mission has some.
fn facts_of(domain: &Domain, lifted: Option<&Lifted>, names: &[String]) -> Result<FactSet, String> {
    let named = |name: &String| {
        lifted.map_or_else(|| Ok(name.clone()), |l| l.fact(name).map_err(|e| e.to_string()))
    };
    let names = names.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    domain.set(&names).map_err(|e| e.to_string())
}

/// Turns the shape of a file into a spec and a world.
pub(crate) struct Reader<'a> {
    /// What the mission's file is called in errors.
    name: &'a str,
    pub(crate) file: &'a MissionFile,
    text: &'a str,
}

impl Reader<'_> {
    pub(crate) fn error(&self, path: &[&str], message: impl std::fmt::Display) -> MissionError {
        MissionError::at_key(self.name, self.text, path, message)
    }

    /// A number that must lie in a range.
    pub(crate) fn within(
        &self,
        path: &[&str],
        value: f64,
        low: f64,
        high: f64,
    ) -> Result<f64, MissionError> {
        if value.is_finite() && value >= low && value <= high {
            return Ok(value);
        }
        let expected = if high.is_infinite() {
            format!("expected a finite number of at least {low}")
        } else {
            format!("expected a number from {low} to {high}")
        };
        Err(self.error(path, format!("{value}; {expected}")))
    }

    /// A count that must lie in a range.
    pub(crate) fn counted<T>(
        &self,
        path: &[&str],
        value: T,
        low: T,
        high: T,
    ) -> Result<T, MissionError>
    where
        T: Copy + PartialOrd + std::fmt::Display,
    {
        if value >= low && value <= high {
            return Ok(value);
        }
        Err(self.error(path, format!("{value}; expected {low} to {high}")))
    }

    /// A name that must be one of a list.
    fn named<T: std::str::FromStr + Default>(
        &self,
        key: &str,
        name: Option<&str>,
    ) -> Result<T, MissionError>
    where
        T::Err: std::fmt::Display,
    {
        name.map_or_else(|| Ok(T::default()), |n| n.parse().map_err(|e| self.error(&[key], e)))
    }

    fn assemble(&self, files: &mut Files<'_>) -> Result<(Spec, World), MissionError> {
        let file = self.file;
        let fits = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        if file.name.is_empty() || file.name.starts_with('.') || !file.name.chars().all(fits) {
            let message = "expected letters, digits, `.`, `_` and `-`: logs are named after it";
            return Err(self.error(&["name"], format!("`{}`; {message}", file.name)));
        }
        let mut truth = self.truth(files)?;
        let grid = truth[ELEVATION].grid;
        self.within(&["terrain", "spacing-m"], grid.spacing_m(), 1e-3, FAR_M)?;
        let layers = self.layers(&truth)?;
        let experts = file
            .experts
            .iter()
            .enumerate()
            .map(|(i, path)| Self::expert(i, path, &layers, files))
            .collect::<Result<Vec<_>, _>>()?;
        if experts.is_empty() {
            return Err(self.error(&["experts"], "none; expected at least one table"));
        }
        for (i, expert) in experts.iter().enumerate() {
            if experts[..i].iter().any(|earlier| earlier.name == expert.name) {
                let message = format!("a second expert is named `{}`", expert.name);
                return Err(self.error(&["experts", &i.to_string()], message));
            }
        }
        let fusion = Fusion {
            rule: self.named::<Rule>("rule", file.rule.as_deref())?,
            paradox_policy: self.named::<ParadoxPolicy>("paradox", file.paradox.as_deref())?,
            statistic: self.named::<Statistic>("statistic", file.statistic.as_deref())?,
            inagaki_k: file.inagaki_k.unwrap_or(Fusion::default().inagaki_k),
        };
        fusion.check(experts.len()).map_err(|e| {
            let key = match &e {
                FusionError::NotOnMaps { .. } => "rule",
                FusionError::PolicyNotAdmitted { .. } => "paradox",
                FusionError::InagakiK { .. } => "inagaki-k",
                _ => "experts",
            };
            self.error(&[key], e)
        })?;
        let lifted = self.lifted()?;
        let domain = self.domain(lifted.as_ref())?;
        let taxonomy = self.taxonomy()?;
        let directives = self.directives(&domain, lifted.as_ref(), &experts, &taxonomy)?;
        let manager = ManagerSpec { taxonomy, ..self.manager()? };
        let start = self.start(grid, &truth[ELEVATION])?;
        let vehicle = self.vehicle(files)?;
        let slip_layer = self.class_layer(
            &["rover", "slip-layer"],
            self.file.rover.slip_layer.as_ref(),
            &layers,
            &truth,
        )?;
        let class_layer =
            self.class_layer(&["class-layer"], self.file.class_layer.as_ref(), &layers, &truth)?;
        if class_layer.is_none() && file.directive.iter().any(|d| d.object.is_some()) {
            let message =
                "directives ask for types of objects; expected the layer of their classes";
            return Err(self.error(&["class-layer"], message));
        }
        let instruments = self.instruments(&layers)?;
        let readings = self.readings(grid, &layers, &truth)?;
        vehicle.validate().map_err(|e| match &e {
            PlannerError::Vehicle { field, .. } => self.error(&["rover", "vehicle", field], &e),
            PlannerError::SlipClass { class, .. }
            | PlannerError::ClassRange { class }
            | PlannerError::RepeatedClass { class } => {
                let row = vehicle.slip_class.iter().rposition(|c| c.class == *class);
                let row = row.unwrap_or_default().to_string();
                self.error(&["rover", "vehicle", "slip-class", &row], &e)
            }
            _ => self.error(&["rover", "vehicle"], &e),
        })?;
        self.within(
            &["rover", "vehicle", "footprint-radius-m"],
            vehicle.footprint_radius_m,
            0.0,
            MAX_FOOTPRINT_CELLS * grid.spacing_m(),
        )?;
        let budget = self.budget()?;
        let within = |path: &[&str], value, low, high| self.within(path, value, low, high);
        let spec = Spec {
            grid,
            working_cells: self.working_cells(grid)?,
            layers,
            experts,
            fusion,
            prize: self.named::<PrizeScale>("prize", file.prize.as_deref())?,
            policy: self.named::<Policy>("policy", file.policy.as_deref())?,
            preferences: self.preferences()?,
            domain,
            directives,
            manager,
            vehicle,
            class_layer,
            close_look: close_look(&instruments),
            slip_layer,
            routes: RouteSpec {
                alternatives: self.counted(
                    &["routes", "alternatives"],
                    file.routes.alternatives,
                    1,
                    MAX_ALTERNATIVES,
                )?,
                front: self.counted(&["routes", "front"], file.routes.front, 1, MAX_FRONT)?,
            },
            budget,
            triggers: self.triggers()?,
            fallback: Fallback {
                max_looks: file.fallback.max_looks,
                look_range_m: within(
                    &["fallback", "look-range-m"],
                    file.fallback.look_range_m,
                    0.0,
                    FAR_M,
                )?,
                min_ignorance: within(
                    &["fallback", "min-ignorance"],
                    file.fallback.min_ignorance,
                    0.0,
                    1.0,
                )?,
                home: start,
                return_home: file.fallback.return_home,
            },
            approach: ApproachSpec {
                eye_height_m: within(
                    &["rover", "eye-height-m"],
                    file.rover.eye_height_m,
                    0.0,
                    FAR_M,
                )?,
                poses: self.counted(&["rover", "poses"], file.rover.poses, 1, MAX_POSES)?,
            },
        };
        wisdom_autonomy::Autonomy::new(spec.clone())
            .map_err(|e| MissionError::of_file(self.name, e))?;
        let world = World::new(
            file.seed,
            std::mem::take(&mut truth),
            &spec.vehicle,
            instruments,
            self.prior(grid, &spec.layers)?,
            Execution {
                start,
                heading_rad: within(
                    &["rover", "heading-deg"],
                    file.rover.heading_deg,
                    -360.0,
                    360.0,
                )?
                .to_radians(),
                look_every_m: within(
                    &["rover", "look-every-m"],
                    file.rover.look_every_m,
                    1e-3,
                    FAR_M,
                )?,
                slip_scatter: within(
                    &["execution", "slip-scatter"],
                    file.execution.slip_scatter,
                    0.0,
                    1.0,
                )?,
                operator_scatter: within(
                    &["execution", "operator-scatter"],
                    file.execution.operator_scatter,
                    0.0,
                    1.0,
                )?,
                hazard_factor: within(
                    &["execution", "hazard-factor"],
                    file.execution.hazard_factor,
                    0.0,
                    1e3,
                )?,
                recovery_s: within(
                    &["execution", "recovery-s"],
                    file.execution.recovery_s,
                    0.0,
                    f64::INFINITY,
                )?,
                hazard_camera_m: within(
                    &["execution", "hazard-camera-m"],
                    file.execution.hazard_camera_m,
                    0.0,
                    FAR_M,
                )?,
                max_decisions: self.counted(
                    &["execution", "max-decisions"],
                    file.execution.max_decisions,
                    1,
                    1_000_000,
                )?,
                slip_layer: spec.slip_layer.clone(),
                faults: self.faults(&spec.domain)?,
                commands: self.commands(&spec)?,
                readings,
            },
            file.terrain
                .body_radius_m
                .map(|r| within(&["terrain", "body-radius-m"], r, 1.0, f64::INFINITY))
                .transpose()?,
        )
        .map_err(|e| MissionError::of_file(self.name, e))?;
        Ok((spec, world))
    }

    /// The true layers, from a landscape or from files, all on one grid.
    fn layers(&self, truth: &BTreeMap<String, LayerTruth>) -> Result<Vec<LayerSpec>, MissionError> {
        self.file
            .layer
            .iter()
            .enumerate()
            .map(|(i, layer)| {
                let source = match layer.derived {
                    Some(DerivedName::Gradient) => Source::Derived(Derivation::Gradient),
                    Some(DerivedName::Slope) => Source::Derived(Derivation::Slope),
                    Some(DerivedName::Step) => Source::Derived(Derivation::Step),
                    Some(DerivedName::Roughness) => Source::Derived(Derivation::Roughness),
                    None => Source::Measured(match layer.update.unwrap_or(UpdateName::Best) {
                        UpdateName::Best => MapUpdate::Best,
                        UpdateName::Latest => MapUpdate::Latest,
                        UpdateName::Weighted => MapUpdate::Weighted,
                    }),
                };
                let classes = truth.get(&layer.name).is_some_and(|t| matches!(t.kind, ReadingKind::Class { .. }));
                if classes && source == Source::Measured(MapUpdate::Weighted) {
                    let index = i.to_string();
                    return Err(self.error(
                        &["layer", &index, "update"],
                        "`weighted` means averaging, and classes have no mean; expected `best` or `latest`",
                    ));
                }
                Ok(LayerSpec { name: layer.name.clone(), unit: layer.unit.clone(), source })
            })
            .collect()
    }

    fn expert(
        index: usize,
        path: &str,
        layers: &[LayerSpec],
        files: &mut Files<'_>,
    ) -> Result<Expert, MissionError> {
        let text = text_of(path, files.bytes(path)?)?;
        let file: ExpertFile =
            toml::from_str(&text).map_err(|e| MissionError::of_toml(path, &text, &e))?;
        let error =
            |keys: &[&str], message: String| MissionError::at_key(path, &text, keys, message);
        let opinion = |keys: &[&str], paradox, not_interesting, interesting| {
            let opinion = Opinion { paradox, not_interesting, interesting };
            InterestMass::try_from(opinion).map_err(|e| error(keys, e.to_string())).map(|_| opinion)
        };
        let outside = opinion(
            &["outside"],
            file.outside.paradox,
            file.outside.not_interesting,
            file.outside.interesting,
        )?;
        if !file.band.is_empty() && !file.class.is_empty() {
            return Err(error(&["class"], "a table has bands or classes, not both".into()));
        }
        let rows = if file.class.is_empty() {
            let bands = file.band.iter().enumerate().map(|(i, b)| {
                let opinion = opinion(
                    &["band", &i.to_string()],
                    b.paradox,
                    b.not_interesting,
                    b.interesting,
                )?;
                Ok(Band { lo: b.from, hi: b.to, opinion })
            });
            Rows::Bands(bands.collect::<Result<_, MissionError>>()?)
        } else {
            let classes = file.class.iter().enumerate().map(|(i, c)| {
                let opinion = opinion(
                    &["class", &i.to_string()],
                    c.paradox,
                    c.not_interesting,
                    c.interesting,
                )?;
                Ok(Class { class: c.value, opinion })
            });
            Rows::Classes(classes.collect::<Result<_, MissionError>>()?)
        };
        let table = LookupTable::new(
            file.name.clone(),
            file.quantity.clone(),
            file.unit.clone(),
            rows,
            outside,
        )
        .map_err(|e| match row_at_fault(&file, &e) {
            Some((kind, row)) => error(&[kind, &row.to_string()], e.to_string()),
            None => MissionError::of_file(path, e),
        })?;
        let Some(layer) = layers.iter().find(|l| l.name == file.layer) else {
            let known: Vec<&str> = layers.iter().map(|l| l.name.as_str()).collect();
            let message =
                format!("`{}` is no layer of the mission; it has {}", file.layer, known.join(", "));
            return Err(error(&["layer"], message));
        };
        if layer.unit != file.unit {
            let message = format!(
                "`{}`, but layer `{}` is in `{}` (experts[{index}])",
                file.unit, layer.name, layer.unit
            );
            return Err(error(&["unit"], message));
        }
        Ok(Expert { name: file.name, layer: file.layer, table })
    }

    fn operators(&self) -> Result<Vec<OperatorText>, MissionError> {
        let operators: Vec<OperatorText> = self
            .file
            .operator
            .iter()
            .map(|o| OperatorText {
                name: o.name.clone(),
                preconditions: o.preconditions.clone(),
                adds: o.adds.clone(),
                deletes: o.deletes.clone(),
                cost: ServiceCost { time_s: o.time_s, energy_j: o.energy_j, data_mb: o.data_mb },
            })
            .collect();
        for (i, operator) in operators.iter().enumerate() {
            let index = i.to_string();
            let cost = operator.cost;
            for (key, value) in
                [("time-s", cost.time_s), ("energy-j", cost.energy_j), ("data-mb", cost.data_mb)]
            {
                self.within(&["operator", &index, key], value, 0.0, MAX_COST)?;
            }
        }
        Ok(operators)
    }

    /// The domain with its types; none where the mission has neither types nor objects nor parameters: there any text is
    /// the name of a fact.
    fn lifted(&self) -> Result<Option<Lifted>, MissionError> {
        let file = self.file;
        let is_flat = file.operator.iter().all(|o| o.parameters.is_empty());
        if is_flat && file.object.is_empty() {
            return Ok(None);
        }
        let types = file.types.iter().map(|t| {
            let (name, parent) = (t.name.clone(), t.parent.clone());
            TypeText { name, parent }
        });
        let objects =
            file.object.iter().map(|o| ObjectText { name: o.name.clone(), kind: o.kind.clone() });
        let schemas = self.operators()?.into_iter().zip(&file.operator);
        let schemas = schemas.map(|(operator, of)| {
            let parameters = of.parameters.clone();
            SchemaText { parameters, operator }
        });
        let (types, objects): (Vec<_>, Vec<_>) = (types.collect(), objects.collect());
        let schemas: Vec<_> = schemas.collect();
        Lifted::new(&types, &objects, &file.facts, &schemas)
            .map(Some)
            .map_err(|error| self.not_ground(&error))
    }

    /// A mistake in a domain with types, shown where it stands.
    fn not_ground(&self, error: &GroundError) -> MissionError {
        let path = match error.place {
            GroundPlace::Type(i) => ["type".into(), i.to_string(), "name".into()],
            GroundPlace::Parent(i) => ["type".into(), i.to_string(), "parent".into()],
            GroundPlace::Object(i) => ["object".into(), i.to_string(), "name".into()],
            GroundPlace::Kind(i) => ["object".into(), i.to_string(), "type".into()],
            GroundPlace::Fact(i) => ["facts".into(), i.to_string(), String::new()],
            GroundPlace::Operator(i, part) => {
                let key = match part {
                    OperatorPart::Name => "name",
                    OperatorPart::Parameters => "parameters",
                    OperatorPart::Preconditions => "preconditions",
                    OperatorPart::Adds => "adds",
                    OperatorPart::Deletes => "deletes",
                };
                ["operator".into(), i.to_string(), key.into()]
            }
            _ => ["operator".into(), String::new(), String::new()],
        };
        let path: Vec<&str> = path.iter().map(String::as_str).filter(|k| !k.is_empty()).collect();
        self.error(&path, &error.fault)
    }

    fn domain(&self, lifted: Option<&Lifted>) -> Result<Domain, MissionError> {
        let Some(lifted) = lifted else {
            let operators = self.operators()?;
            let schema: Vec<usize> = (0..operators.len()).collect();
            return self.grounded(&operators, &schema, &self.file.facts);
        };
        // Facts that no directive asks for need not be kept; one that is no fact is shown where directives are read.
        let asked = self.file.directive.iter().flat_map(|d| d.achieves.iter().chain(&d.requires));
        // What a fault may take away does not always hold, though no operator deletes it.
        let asked = asked.chain(self.file.fault.iter().flat_map(|f| f.facts.iter().flatten()));
        let asked: Vec<String> = asked.filter_map(|fact| lifted.fact(fact).ok()).collect();
        let ground = lifted.ground(&asked).map_err(|error| self.not_ground(&error))?;
        self.grounded(&ground.operators, &ground.schema, &ground.facts)
    }

    /// The domain of ground operators; `schema` tells for each the operator in the file.
    fn grounded(
        &self,
        operators: &[OperatorText],
        schema: &[usize],
        facts: &[String],
    ) -> Result<Domain, MissionError> {
        Domain::new(operators, facts).map_err(|e| {
            let place = match &e {
                DomainError::DuplicateOperator { name } => {
                    operators.iter().rposition(|o| o.name == *name).map(|i| (i, "name"))
                }
                DomainError::UnknownFact { name } => operators
                    .iter()
                    .position(|o| o.preconditions.contains(name))
                    .map(|i| (i, "preconditions")),
                _ => None,
            };
            match place {
                Some((i, key)) => self.error(&["operator", &schema[i].to_string(), key], e),
                None => self.error(&["operator", "0"], e),
            }
        })
    }

    fn directives(
        &self,
        domain: &Domain,
        lifted: Option<&Lifted>,
        experts: &[Expert],
        taxonomy: &Taxonomy,
    ) -> Result<Vec<Directive>, MissionError> {
        let files = &self.file.directive;
        for (i, d) in files.iter().enumerate() {
            if files[..i].iter().any(|earlier| earlier.name == d.name) {
                let message = format!("directive `{}` is given twice", d.name);
                return Err(self.error(&["directive", &i.to_string(), "name"], message));
            }
        }
        let mut directives = Vec::new();
        for (i, d) in files.iter().enumerate() {
            let index = i.to_string();
            let at = |key: &'static str| ["directive".to_owned(), index.clone(), key.to_owned()];
            let error = |key: &'static str, message: String| {
                self.error(&at(key).each_ref().map(String::as_str), message)
            };
            let number = |key: &'static str, value: f64, low: f64, high: f64| {
                self.within(&at(key).each_ref().map(String::as_str), value, low, high)
            };
            let experts = d
                .experts
                .iter()
                .map(|name| {
                    experts.iter().position(|e| e.name == *name).ok_or_else(|| {
                        let known: Vec<&str> = experts.iter().map(|e| e.name.as_str()).collect();
                        error(
                            "experts",
                            format!("`{name}` is no expert; there are {}", known.join(", ")),
                        )
                    })
                })
                .collect::<Result<Vec<_>, _>>()?;
            let substitute = match &d.substitute {
                None => None,
                Some(name) => {
                    Some(files.iter().position(|o| o.name == *name).ok_or_else(|| {
                        let known: Vec<&str> = files.iter().map(|o| o.name.as_str()).collect();
                        let known = known.join(", ");
                        error("substitute", format!("`{name}` is no directive; there are {known}"))
                    })?)
                }
            };
            if substitute == Some(i) {
                return Err(error("substitute", "a directive cannot stand in for itself".into()));
            }
            let facts = |key: &'static str, names: &[String]| {
                facts_of(domain, lifted, names).map_err(|message| error(key, message))
            };
            let achieves = facts("achieves", &d.achieves)?;
            if achieves == wisdom_goals::FactSet::EMPTY {
                return Err(error("achieves", "a directive must want at least one fact".into()));
            }
            if domain.expand(domain.initial(), achieves).is_none() {
                let message = "no sequence of operators brings this about from the initial facts";
                return Err(error("achieves", message.into()));
            }
            let object = match &d.object {
                None => None,
                Some(name) => Some(taxonomy.index(name).ok_or_else(|| {
                    let known = taxonomy.names().collect::<Vec<_>>().join(", ");
                    let known = if known.is_empty() { "none".to_owned() } else { known };
                    error("object", format!("`{name}` is no type of objects; there are: {known}"))
                })?),
            };
            let kind = match &d.kind {
                None => Kind::Inspect,
                Some(name) => {
                    name.parse().map_err(|e: UnknownKind| error("kind", e.to_string()))?
                }
            };
            let window = match d.window_s {
                None => None,
                Some([open_s, close_s])
                    if (0.0..=close_s).contains(&open_s) && close_s <= LATEST_S =>
                {
                    Some(PlanWindow { open_s, close_s })
                }
                Some([open_s, close_s]) => {
                    let wanted = "expected the first and the last second at which work may begin";
                    return Err(error("window-s", format!("[{open_s}, {close_s}]; {wanted}")));
                }
            };
            directives.push(Directive {
                name: d.name.clone(),
                kind,
                min_signal: number("min-signal", d.min_signal, 0.0, 1.0)?,
                object,
                generalise_m: number("generalise-m", d.generalise_m, 0.0, FAR_M)?,
                window,
                experts,
                min_credit: number("min-credit", d.min_credit, 0.0, 1.0)?,
                min_interest: number("min-interest", d.min_interest, 0.0, 1.0)?,
                weight: number("weight", d.weight, 1e-6, 1e3)?,
                requires: facts("requires", &d.requires)?,
                achieves,
                standoff_m: number("standoff-m", d.standoff_m, 0.0, 1e4)?,
                max_attempts: self.counted(
                    &at("max-attempts").each_ref().map(String::as_str),
                    d.max_attempts,
                    1,
                    1000,
                )?,
                exclusion_radius_m: number("exclusion-radius-m", d.exclusion_radius_m, 0.0, FAR_M)?,
                substitute,
                mandatory: d.mandatory,
                fade: match d.fade_s {
                    None => None,
                    Some([full, nothing]) if (0.0..=nothing).contains(&full) && nothing.is_finite() => {
                        Some(Fade { full_until_s: full, nothing_from_s: nothing })
                    }
                    Some([full, nothing]) => {
                        let wanted = "expected the last second at which the whole prize counts, then the first at \
                                      which nothing of it does";
                        return Err(error("fade-s", format!("[{full}, {nothing}]; {wanted}")));
                    }
                },
            });
        }
        for (i, directive) in directives.iter().enumerate() {
            let mut at = directive.substitute;
            for _ in 0..directives.len() {
                at = at.and_then(|next: usize| directives[next].substitute);
            }
            if at.is_some() {
                let message = format!(
                    "the substitutes of `{}` go round in a circle; expected ever weaker directives",
                    directive.name
                );
                return Err(self.error(&["directive", &i.to_string(), "substitute"], message));
            }
        }
        if directives.is_empty() {
            return Err(self.error(&["directive"], "expected at least one directive"));
        }
        Ok(directives)
    }

    fn preferences(&self) -> Result<Preferences, MissionError> {
        let o = &self.file.objective;
        let number = |key: &str, value, high| self.within(&["objective", key], value, 0.0, high);
        Ok(Preferences {
            confidence: number("confidence", o.confidence, 1.0)?,
            prices: Prices {
                risk: number("risk-price", o.risk_price, DEAR)?,
                energy_per_j: number("price-per-kj", o.price_per_kj, DEAR)? / 1000.0,
                time_per_s: number("price-per-h", o.price_per_h, DEAR)? / 3600.0,
                data_per_mb: number("price-per-mb", o.price_per_mb, DEAR)?,
            },
        })
    }

    fn manager(&self) -> Result<ManagerSpec, MissionError> {
        let goals = &self.file.goals;
        let number = |key: &str, value, low, high| self.within(&["goals", key], value, low, high);
        if let Some(floor) = goals.percentile_floor {
            number("percentile-floor", floor, 0.0, 100.0)?;
        }
        Ok(ManagerSpec {
            extraction: Extraction {
                min_prominence: number("min-prominence", goals.min_prominence, 1e-6, 1.0)?,
                min_separation_m: number("min-separation-m", goals.min_separation_m, 0.0, FAR_M)?,
                percentile_floor: goals.percentile_floor,
                max_sites: self.counted(&["goals", "max-known"], goals.max_known, 1, MAX_KNOWN)?,
            },
            hysteresis: number("hysteresis", goals.hysteresis, 0.0, 10.0)?,
            identity_radius_m: number("identity-radius-m", goals.identity_radius_m, 0.0, FAR_M)?,
            max_sequenced: self.counted(
                &["goals", "max-sequenced"],
                goals.max_sequenced,
                1,
                MAX_SEQUENCED,
            )?,
            family: self.counted(&["goals", "family"], goals.family, 1, MAX_FAMILY)?,
            expansions: self.counted(&["goals", "expansions"], goals.expansions, 1, u64::MAX)?,
            max_reopenings: goals.max_reopenings,
            taxonomy: Taxonomy::default(),
            clear_below: number("clear-below", goals.clear_below, 0.0, 1.0)?,
        })
    }

    fn start(&self, grid: GridSpec, elevation: &LayerTruth) -> Result<Cell, MissionError> {
        let error = |message: String| self.error(&["rover", "start"], message);
        let [row, col] = self.file.rover.start[..] else {
            let found = self.file.rover.start.len();
            return Err(error(format!("{found} numbers; expected two, [row, col]")));
        };
        let start = Cell { row, col };
        if !grid.contains(start) {
            return Err(error(format!("{start} is off {}", shown(grid))));
        }
        // Ground that is not at hand is not asked: a log's own mission was checked when it ran.
        if elevation.is_at_hand() {
            let here = elevation.window(grid.around(start, 0)).map_err(|e| error(e.to_string()))?;
            if !here.is_known(start) {
                return Err(error(format!("nothing is known of the ground at {start}")));
            }
        }
        Ok(start)
    }

    fn budget(&self) -> Result<Budget, MissionError> {
        let b = &self.file.budget;
        let number = |key: &str, value, low, high| self.within(&["budget", key], value, low, high);
        let energy_j = number("energy-j", b.energy_j, 0.0, f64::INFINITY)?;
        Ok(Budget {
            time_s: number("time-s", b.time_s, 0.0, f64::INFINITY)?,
            energy_j,
            reserve_j: number("reserve-j", b.reserve_j, 0.0, energy_j)?,
            data_mb: match b.data_mb {
                None => f64::INFINITY,
                Some(mb) => number("data-mb", mb, 0.0, f64::INFINITY)?,
            },
            min_reliability: number("min-reliability", b.min_reliability, 0.0, 1.0)?,
        })
    }

    fn instruments(&self, layers: &[LayerSpec]) -> Result<Vec<Instrument>, MissionError> {
        let mut instruments = Vec::new();
        for (i, file) in self.file.instrument.iter().enumerate() {
            let index = i.to_string();
            let number = |key: &str, value, low, high| {
                self.within(&["instrument", &index, key], value, low, high)
            };
            for name in &file.layers {
                if self.is_handed_in(name) {
                    let message = format!("`{name}` is handed in; no instrument reads it");
                    return Err(self.error(&["instrument", &index, "layers"], message));
                }
                let measured = layers
                    .iter()
                    .any(|l| l.name == *name && matches!(l.source, Source::Measured(_)));
                if !measured {
                    let message = format!("`{name}` is no measured layer of the mission");
                    return Err(self.error(&["instrument", &index, "layers"], message));
                }
            }
            instruments.push(Instrument {
                name: file.name.clone(),
                layers: file.layers.clone(),
                height_m: number("height-m", file.height_m, 0.0, FAR_M)?,
                range_m: number("range-m", file.range_m, 1e-3, FAR_M)?,
                u0: number("u0", file.u0, 0.0, 0.999)?,
                field_of_view_rad: number("field-of-view-deg", file.field_of_view_deg, 1.0, 360.0)?
                    .to_radians(),
            });
        }
        Ok(instruments)
    }

    /// The mission's own vehicle, or a preset with the mission's keys over it.
    ///
    /// The preset's file is one of the mission's from then on, so that logs and campaigns keep it.
    fn vehicle(&self, files: &mut Files<'_>) -> Result<Vehicle, MissionError> {
        let rover = &self.file.rover;
        let Some(name) = &rover.preset else { return Ok(rover.vehicle.clone()) };
        let path = format!("presets/{name}.toml");
        let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
        let text = if let Some(Ok(bytes)) = plain.then(|| files.bytes(&path)) {
            text_of(&path, bytes)?
        } else {
            let built_in = Preset::named(name);
            let text = built_in.map_err(|e| self.error(&["rover", "preset"], e))?.text();
            files.taken.insert(path.clone(), text.as_bytes().to_vec());
            text.to_owned()
        };
        let mut table =
            Preset::table_of(&text).map_err(|e| MissionError::of_toml(&path, &text, &e))?;
        // What the file says, key by key: a vehicle that was read has defaults where the file is silent.
        let own = self.text.parse::<toml::Table>().ok();
        let own = own.as_ref().and_then(|file| file.get("rover")?.get("vehicle")?.as_table());
        table.extend(own.cloned().unwrap_or_default());
        table.try_into().map_err(|e| self.error(&["rover", "vehicle"], e))
    }

    /// A layer that must be measured, and of classes.
    fn class_layer(
        &self,
        key: &[&str],
        name: Option<&String>,
        layers: &[LayerSpec],
        truth: &BTreeMap<String, LayerTruth>,
    ) -> Result<Option<String>, MissionError> {
        let Some(name) = name else { return Ok(None) };
        let classes = |layer: &&LayerSpec| {
            truth
                .get(&layer.name)
                .is_some_and(|t| matches!(t.kind, ReadingKind::Class { .. }) && !t.is_handed_in())
        };
        if layers.iter().filter(classes).any(|layer| layer.name == *name) {
            return Ok(Some(name.clone()));
        }
        let known: Vec<&str> = layers.iter().filter(classes).map(|l| l.name.as_str()).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        let message = format!("`{name}` is no measured layer of classes; there are: {known}");
        Err(self.error(key, message))
    }

    /// When decisions are taken, and what calls for one.
    fn triggers(&self) -> Result<Triggers, MissionError> {
        let t = &self.file.triggers;
        let number =
            |key: &str, value, low, high| self.within(&["triggers", key], value, low, high);
        let or_never = |key: &str, value: Option<f64>, low| {
            value.map_or(Ok(f64::INFINITY), |value| number(key, value, low, f64::INFINITY))
        };
        let pace = match &t.pace {
            None => Pace::default(),
            Some(name) => {
                Pace::ALL.into_iter().find(|pace| pace.name() == name).ok_or_else(|| {
                    let known = Pace::ALL.map(Pace::name).join(", ");
                    self.error(&["triggers", "pace"], format!("`{name}`; expected one of {known}"))
                })?
            }
        };
        Ok(Triggers {
            pace,
            cadence_s: number("cadence-s", t.cadence_s, 1.0, f64::INFINITY)?,
            interest_change: number("interest-change", t.interest_change, 0.0, 1.0)?,
            corridor_change: or_never("corridor-change", t.corridor_change, 0.0)?,
            budget_drift: number("budget-drift", t.budget_drift, 0.0, f64::INFINITY)?,
            window_closing_s: number("window-closing-s", t.window_closing_s, 0.0, f64::INFINITY)?,
            conflict: number("conflict", t.conflict, 0.0, 1.0)?,
            watchdog_s: or_never("watchdog-s", t.watchdog_s, 1.0)?,
        })
    }

    /// Types of objects and their classes.
    fn taxonomy(&self) -> Result<Taxonomy, MissionError> {
        let mut tree = Taxonomy::default();
        for (i, of) in self.file.types.iter().enumerate() {
            tree.add(&of.name, of.parent.as_deref(), &of.classes).map_err(|e| {
                let key = match &e {
                    TaxonomyError::Repeated { .. } => "name",
                    TaxonomyError::Class { .. } => "classes",
                    _ => "parent",
                };
                self.error(&["type", &i.to_string(), key], e)
            })?;
        }
        Ok(tree)
    }

    /// What the ground will ask for, and take back.
    fn commands(&self, spec: &Spec) -> Result<Vec<(f64, Word)>, MissionError> {
        let mut commands = Vec::new();
        let files = &self.file.command;
        for (i, file) in files.iter().enumerate() {
            let index = i.to_string();
            let error = |key: &str, message: String| self.error(&["command", &index, key], message);
            let number = |key: &str, value, low, high| {
                self.within(&["command", &index, key], value, low, high)
            };
            if files[..i].iter().any(|earlier| earlier.name == file.name) {
                return Err(error("name", format!("command `{}` is given twice", file.name)));
            }
            let known: Vec<&str> = spec.directives.iter().map(|d| d.name.as_str()).collect();
            if !known.contains(&file.directive.as_str()) {
                let known = known.join(", ");
                let message = format!("`{}` is no directive; there are {known}", file.directive);
                return Err(error("directive", message));
            }
            let [row, col] = file.target[..] else {
                let found = file.target.len();
                return Err(error("target", format!("{found} numbers; expected [row, col]")));
            };
            let target = Cell { row, col };
            if !spec.grid.contains(target) {
                return Err(error("target", format!("{target} is off {}", shown(spec.grid))));
            }
            let at_s = number("at-s", file.at_s, 0.0, LATEST_S)?;
            let name = file.name.clone();
            commands.push((
                at_s,
                Word::Pursue {
                    name: name.clone(),
                    directive: file.directive.clone(),
                    target,
                    prize: number("prize", file.prize, 1e-6, 1e3)?,
                    mandatory: file.mandatory,
                },
            ));
            if let Some(withdrawn) = file.withdraw_at_s {
                let withdrawn = number("withdraw-at-s", withdrawn, at_s, LATEST_S)?;
                commands.push((withdrawn, Word::Withdraw { name }));
            }
        }
        // Stable: of commands at one time, the one the mission names first comes first.
        commands.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(commands)
    }

    /// Places known to be worth a visit.
    fn labels(&self, grid: GridSpec) -> Result<Vec<Label>, MissionError> {
        let files = &self.file.label;
        let label = |(i, file): (usize, &LabelFile)| {
            let index = i.to_string();
            let error = |key: &str, message: String| self.error(&["label", &index, key], message);
            if files[..i].iter().any(|earlier| earlier.name == file.name) {
                return Err(error("name", format!("label `{}` is given twice", file.name)));
            }
            let [row, col] = file.at[..] else {
                return Err(error("at", format!("{} numbers; expected [row, col]", file.at.len())));
            };
            let at = Cell { row, col };
            if !grid.contains(at) {
                return Err(error("at", format!("{at} is off {}", shown(grid))));
            }
            let number =
                |key: &str, value, high| self.within(&["label", &index, key], value, 0.0, high);
            Ok(Label {
                name: file.name.clone(),
                at,
                radius_m: number("radius-m", file.radius_m, FAR_M)?,
                worth: number("worth", file.worth, 1e3)?,
            })
        };
        files.iter().enumerate().map(label).collect()
    }

    /// What may break.
    fn faults(&self, domain: &Domain) -> Result<Vec<Fault>, MissionError> {
        let files = &self.file.fault;
        let mut faults = Vec::new();
        for (i, file) in files.iter().enumerate() {
            let index = i.to_string();
            let error = |key: &str, message: String| self.error(&["fault", &index, key], message);
            // Names go to terminals and into tables, several in a cell.
            let fits = |c: char| !c.is_control() && c != ';';
            if file.name.trim().is_empty() || !file.name.chars().all(fits) {
                let message = "expected some text without `;` and control characters";
                return Err(error("name", format!("{:?}; {message}", file.name)));
            }
            if files[..i].iter().any(|earlier| earlier.name == file.name) {
                return Err(error("name", format!("fault `{}` is given twice", file.name)));
            }
            let number = |key: &str, value, low, high| {
                self.within(&["fault", &index, key], value, low, high)
            };
            let [from_s, to_s] = file.between_s.unwrap_or([0.0, self.file.budget.time_s]);
            for value in [from_s, to_s] {
                number("between-s", value, 0.0, LATEST_S)?;
            }
            if from_s > to_s {
                let message = format!("[{from_s}, {to_s}]; expected the earlier time first");
                return Err(error("between-s", message));
            }
            faults.push(Fault {
                name: file.name.clone(),
                kind: self.fault_kind(file, &index, domain)?,
                probability: number("probability", file.probability, 0.0, 1.0)?,
                between_s: (from_s, to_s),
                lasts_s: match file.lasts_s {
                    None => f64::INFINITY,
                    Some(s) => number("lasts-s", s, 0.0, LATEST_S)?,
                },
            });
        }
        Ok(faults)
    }

    fn fault_kind(
        &self,
        file: &FaultFile,
        index: &str,
        domain: &Domain,
    ) -> Result<FaultKind, MissionError> {
        let error = |key: &str, message: String| self.error(&["fault", index, key], message);
        let (kind, own) = match file.kind {
            FaultName::InstrumentLost => ("instrument-lost", "instrument"),
            FaultName::WheelDrag => ("wheel-drag", "factor"),
            FaultName::DemBias => ("dem-bias", "bias-m"),
            FaultName::FactsLost => ("facts-lost", "facts"),
            FaultName::CommDelay => ("comm-delay", "delay-s"),
        };
        let given = [
            ("instrument", file.instrument.is_some()),
            ("factor", file.factor.is_some()),
            ("bias-m", file.bias_m.is_some()),
            ("delay-s", file.delay_s.is_some()),
            ("facts", file.facts.is_some()),
        ];
        if let Some((key, _)) = given.into_iter().find(|&(key, given)| given && key != own) {
            return Err(error(key, format!("a {kind} fault has `{own}`, not `{key}`")));
        }
        let number = |key: &str, value: Option<f64>, low, high| {
            let value =
                value.ok_or_else(|| error("kind", format!("a {kind} fault needs `{own}`")))?;
            self.within(&["fault", index, key], value, low, high)
        };
        Ok(match file.kind {
            FaultName::InstrumentLost => {
                let name = file
                    .instrument
                    .clone()
                    .ok_or_else(|| error("kind", format!("a {kind} fault needs `{own}`")))?;
                let known: Vec<&str> =
                    self.file.instrument.iter().map(|i| i.name.as_str()).collect();
                if !known.contains(&name.as_str()) {
                    let known = known.join(", ");
                    let message = format!("`{name}` is no instrument; there are {known}");
                    return Err(error("instrument", message));
                }
                FaultKind::InstrumentLost { instrument: name }
            }
            FaultName::WheelDrag => {
                FaultKind::WheelDrag { factor: number(own, file.factor, 1.0, 1e3)? }
            }
            FaultName::DemBias => {
                FaultKind::DemBias { bias_m: number(own, file.bias_m, -1e4, 1e4)? }
            }
            FaultName::FactsLost => {
                let facts = file.facts.clone().unwrap_or_default();
                if facts.is_empty() {
                    return Err(error("kind", format!("a {kind} fault needs `{own}`")));
                }
                domain.set(&facts).map_err(|e| error("facts", e.to_string()))?;
                FaultKind::FactsLost { facts }
            }
            FaultName::CommDelay => {
                FaultKind::CommDelay { delay_s: number(own, file.delay_s, 0.0, LATEST_S)? }
            }
        })
    }

    fn prior(&self, grid: GridSpec, layers: &[LayerSpec]) -> Result<Prior, MissionError> {
        let p = &self.file.prior;
        let measured = |name: &str| {
            !self.is_handed_in(name)
                && layers.iter().any(|l| l.name == name && matches!(l.source, Source::Measured(_)))
        };
        match p.kind {
            PriorKind::None => Ok(Prior::None),
            PriorKind::Complete => Ok(Prior::Complete),
            PriorKind::Averaged => {
                let block = p.block.unwrap_or(8);
                if block == 0 {
                    return Err(self.error(&["prior", "block"], "0; expected at least 1"));
                }
                Ok(Prior::Averaged {
                    block,
                    u: self.within(&["prior", "u"], p.u.unwrap_or(0.6), 0.0, 1.0)?,
                })
            }
            PriorKind::FirstLook => {
                for (name, how) in &p.uncertainty {
                    if !measured(name) {
                        let message = format!("`{name}` is no measured layer of the mission");
                        return Err(self.error(&["prior", "uncertainty", name], message));
                    }
                    if let FirstLookU::Sight(noise) = how {
                        self.within(&["prior", "uncertainty", name, "sight"], *noise, 0.0, 1.0)?;
                    }
                }
                let mut pinned = Vec::new();
                for (i, pin) in p.pinned.iter().enumerate() {
                    let cell = Cell { row: pin.row, col: pin.col };
                    let index = i.to_string();
                    if !grid.contains(cell) || !measured(&pin.layer) {
                        let message = format!("no cell {cell} of a measured layer `{}`", pin.layer);
                        return Err(self.error(&["prior", "pinned", &index], message));
                    }
                    let u = self.within(&["prior", "pinned", &index, "u"], pin.u, 0.0, 1.0)?;
                    pinned.push((pin.layer.clone(), cell, u as f32));
                }
                let height = p.camera_height_m.unwrap_or(self.file.rover.eye_height_m);
                Ok(Prior::FirstLook {
                    uncertainty: p.uncertainty.clone(),
                    pinned,
                    camera_height_m: self.within(
                        &["prior", "camera-height-m"],
                        height,
                        0.0,
                        FAR_M,
                    )?,
                })
            }
        }
    }
}

/// The uncertainty that the best instrument leaves of each layer, from near.
fn close_look(instruments: &[Instrument]) -> BTreeMap<String, f32> {
    let mut least: BTreeMap<String, f32> = BTreeMap::new();
    for instrument in instruments {
        for layer in &instrument.layers {
            let u = least.entry(layer.clone()).or_insert(1.0);
            *u = u.min(instrument.u0 as f32);
        }
    }
    least
}

/// The row of a table that an error is about: of two that clash, the later in the file.
fn row_at_fault(file: &ExpertFile, error: &FusionError) -> Option<(&'static str, usize)> {
    let band = |lo: f64, hi: f64| {
        let same = |b: &crate::file::BandFile| {
            b.from.total_cmp(&lo).is_eq() && b.to.total_cmp(&hi).is_eq()
        };
        file.band.iter().rposition(same)
    };
    match *error {
        FusionError::Band { lo, hi, .. } => band(lo, hi).map(|row| ("band", row)),
        FusionError::Overlap { first, second, .. } => {
            Some(("band", band(first.0, first.1)?.max(band(second.0, second.1)?)))
        }
        FusionError::RepeatedClass { class, .. } | FusionError::ClassRange { class, .. } => {
            file.class.iter().rposition(|c| c.value == class).map(|row| ("class", row))
        }
        _ => None,
    }
}

/// A grid in words.
pub(crate) fn shown(grid: GridSpec) -> String {
    format!(
        "a grid of {} x {} cells of {} m with its north-west corner at ({}, {})",
        grid.rows(),
        grid.cols(),
        grid.spacing_m(),
        grid.west_m(),
        grid.north_m()
    )
}
