//! Reads `[terrain]` and `[[layer]]`: the layers as they truly are.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use wisdom_autonomy::{ELEVATION, MIN_WORKING_CELLS};
use wisdom_grid::{GridSpec, Raster};
use wisdom_terrain::format::{GridFile, MAX_CELLS, read_with};
use wisdom_terrain::{Crs, Landscape, Layer, Resampling, SceneLayer, TerrainError, resample};

use crate::MissionError;
use crate::file::{FirstLookU, Kind, LayerFile};
use crate::mission::{Reader, shown, text_of};
use crate::supply::Files;
use crate::truth::{FileValues, LayerTruth, ReadingKind, SiteU, Values, site_u};

/// The largest working map, cells a side: decisions on it take tens of times as long as on the usual 512.
pub(crate) const MAX_WORKING_CELLS: usize = 4096;

/// How far two radii of one body may be apart, relative: ellipsoids and spheres of Mars differ by half a per cent.
const SAME_BODY: f64 = 0.01;

/// The part of a working map's side that may be driven between two looks: it moves on only when the rover looks.
const LOOKS_A_SIDE: f64 = 8.0;

/// A file as a layer names it, before all layers share one grid.
enum Source {
    Memory(Box<GridFile>),
    Large(FileValues),
    Elsewhere(GridSpec),
}

impl Source {
    fn grid(&self) -> GridSpec {
        match self {
            Self::Memory(file) => file.raster.spec(),
            Self::Large(file) => file.reader.spec(),
            Self::Elsewhere(grid) => *grid,
        }
    }

    fn crs(&self) -> Option<&Crs> {
        match self {
            Self::Memory(file) => file.crs.as_ref(),
            Self::Large(file) => file.reader.crs(),
            Self::Elsewhere(_) => None,
        }
    }

    /// The same on another grid.
    fn onto(self, grid: GridSpec, resampling: Resampling) -> Self {
        match self {
            Self::Memory(file) => Self::Memory(Box::new(resample(&file, grid, resampling))),
            Self::Large(file) => Self::Large(FileValues { resampling: Some(resampling), ..file }),
            Self::Elsewhere(_) => Self::Elsewhere(grid),
        }
    }
}

/// The scene that layers may be drawn from.
struct Scene {
    landscape: Arc<Landscape>,
    grid: GridSpec,
    /// Where all of it fits into memory.
    drawn: Option<BTreeMap<String, Raster<f32>>>,
}

/// Says what is wrong with a key of one layer.
type Fault<'a> = &'a dyn Fn(&'static str, &dyn Display) -> MissionError;

impl Reader<'_> {
    /// Side of the working map, if the mission has one.
    pub(crate) fn working_cells(&self, grid: GridSpec) -> Result<Option<usize>, MissionError> {
        let Some(side) = self.file.terrain.working_cells else { return Ok(None) };
        let path = ["terrain", "working-cells"];
        self.counted(&path, side, MIN_WORKING_CELLS, MAX_WORKING_CELLS)?;
        let most_m = side as f64 * grid.spacing_m() / LOOKS_A_SIDE;
        let between_m = self.file.rover.look_every_m;
        if between_m > most_m {
            let message = format!(
                "{between_m}; expected at most {most_m}, an eighth of the working map's side, which moves on only \
                 when the rover looks"
            );
            return Err(self.error(&["rover", "look-every-m"], message));
        }
        let far_m = side as f64 * grid.spacing_m() / 2.0;
        let far = |path: &[&str], range_m: f64| {
            if range_m <= far_m {
                return Ok(());
            }
            let message =
                format!("{range_m}; expected at most {far_m}, half the working map's side");
            Err(self.error(path, message))
        };
        for (i, instrument) in self.file.instrument.iter().enumerate() {
            far(&["instrument", &i.to_string(), "range-m"], instrument.range_m)?;
        }
        far(&["execution", "hazard-camera-m"], self.file.execution.hazard_camera_m)?;
        for (i, reading) in self.file.reading.iter().enumerate() {
            far(&["reading", &i.to_string(), "radius-m"], reading.radius_m)?;
        }
        if self.file.prior.uncertainty.values().any(|how| matches!(how, FirstLookU::Sight(_))) {
            let message =
                "a first look by sight covers the whole ground, a working map a part of it";
            return Err(self.error(&["prior", "uncertainty"], message));
        }
        Ok(Some(side))
    }

    /// Every measured layer as it truly is, all on the grid of the elevation.
    pub(crate) fn truth(
        &self,
        files: &mut Files<'_>,
    ) -> Result<BTreeMap<String, LayerTruth>, MissionError> {
        let scene = self.scene(files)?;
        let mut sources = Vec::new();
        for (i, layer) in self.file.layer.iter().enumerate() {
            let index = i.to_string();
            let fault = |key: &'static str, message: &dyn Display| {
                self.error(&["layer", index.as_str(), key], message)
            };
            if self.file.layer[..i].iter().any(|earlier| earlier.name == layer.name) {
                return Err(fault("name", &format!("layer `{}` is given twice", layer.name)));
            }
            if layer.handed_in {
                only_handed_in(layer, &fault)?;
            }
            if layer.derived.is_some() {
                only_derived(layer, &fault)?;
            } else {
                let values = match &layer.file {
                    None => None,
                    Some(path) => Some(self.source(path, files, ("file", &fault))?),
                };
                sources.push((i, layer, values));
            }
        }
        let elevation = sources.iter().find(|(_, layer, _)| layer.name == ELEVATION);
        let Some((_, _, elevation)) = elevation else {
            let message = "no measured layer is named `elevation`; routes need one";
            return Err(self.error(&["layer"], message));
        };
        let first = match (elevation, &scene) {
            (Some(source), _) => Some((source.grid(), source.crs().cloned())),
            (None, Some(scene)) => Some((scene.grid, None)),
            (None, None) => None,
        };
        if let (Some(asked_m), Some((_, Some(crs)))) = (self.file.terrain.body_radius_m, &first)
            && let Some(told_m) = crs.radius_m
            && (asked_m / told_m - 1.0).abs() > SAME_BODY
        {
            let message = format!("{asked_m}, but the file of the elevation tells {told_m}");
            return Err(self.error(&["terrain", "body-radius-m"], message));
        }
        let mut truth = BTreeMap::new();
        for (i, layer, values) in sources {
            let index = i.to_string();
            let fault = |key: &'static str, message: &dyn Display| {
                self.error(&["layer", index.as_str(), key], message)
            };
            let values = match values {
                Some(source) => {
                    let (grid, crs) = first.as_ref().ok_or_else(|| nothing(layer, None, &fault))?;
                    let source = fitted(layer, source, (*grid, crs.as_ref()), ("file", &fault))?;
                    of_file(source, &layer.name).map_err(|e| fault("file", &e))?
                }
                None if layer.handed_in => Values::HandedIn,
                None => self.of_scene(layer, scene.as_ref(), &fault)?,
            };
            let (grid, crs) = first.as_ref().ok_or_else(|| nothing(layer, None, &fault))?;
            if let (None, Some(scene)) = (&layer.file, &scene)
                && !layer.handed_in
                && scene.grid != *grid
            {
                return Err(other_grid(layer, scene.grid, *grid, ("name", &fault)));
            }
            let site_u = match &layer.uncertainty_file {
                None => None,
                Some(path) => {
                    let key = "uncertainty-file";
                    let source = self.source(path, files, (key, &fault))?;
                    let source = fitted(layer, source, (*grid, crs.as_ref()), (key, &fault))?;
                    own_u(path, source).map_err(|e| fault(key, &e))?
                }
            };
            let kind = kind(layer, &fault)?;
            truth.insert(layer.name.clone(), LayerTruth { grid: *grid, values, site_u, kind });
        }
        Ok(truth)
    }

    fn scene(&self, files: &mut Files<'_>) -> Result<Option<Scene>, MissionError> {
        let terrain = &self.file.terrain;
        let Some(path) = &terrain.landscape else {
            let of_landscapes = [
                ("rows", terrain.rows.is_some()),
                ("cols", terrain.cols.is_some()),
                ("spacing-m", terrain.spacing_m.is_some()),
            ];
            if let Some((key, _)) = of_landscapes.into_iter().find(|(_, given)| *given) {
                let message = "only a `landscape` takes this; terrain files bring their own grid";
                return Err(self.error(&["terrain", key], message));
            }
            return Ok(None);
        };
        let text = text_of(path, files.bytes(path)?)?;
        let landscape: Landscape =
            toml::from_str(&text).map_err(|e| MissionError::of_toml(path, &text, &e))?;
        let (Some(rows), Some(cols)) = (terrain.rows, terrain.cols) else {
            return Err(self.error(&["terrain"], "a landscape needs `rows` and `cols`"));
        };
        let grid = GridSpec::new(rows, cols, terrain.spacing_m.unwrap_or(1.0))
            .map_err(|e| self.error(&["terrain"], e))?;
        let piecewise = terrain.working_cells.is_some();
        if grid.len() > MAX_CELLS && !piecewise {
            let message = format!(
                "{rows} x {cols} cells; expected at most {MAX_CELLS} cells, or `working-cells` for a map that moves \
                 with the rover"
            );
            return Err(self.error(&["terrain", "rows"], message));
        }
        let drawn = (!piecewise).then(|| landscape.render(grid, self.file.seed));
        Ok(Some(Scene { landscape: Arc::new(landscape), grid, drawn }))
    }

    /// A layer of the scene.
    fn of_scene(
        &self,
        layer: &LayerFile,
        scene: Option<&Scene>,
        fault: Fault<'_>,
    ) -> Result<Values, MissionError> {
        let known = SceneLayer::ALL.into_iter().find(|known| known.to_string() == layer.name);
        let (Some(scene), Some(known)) = (scene, known) else {
            return Err(nothing(layer, scene, fault));
        };
        let Some(drawn) = &scene.drawn else {
            let (scene, seed) = (Arc::clone(&scene.landscape), self.file.seed);
            return Ok(Values::Scene { scene, layer: known, seed });
        };
        let whole = Layer::certain(drawn[&layer.name].clone()).map_err(|e| fault("name", &e))?;
        Ok(Values::Memory(whole))
    }

    /// A terrain file: read whole, or left where it is if the mission works on a part of it at a time.
    fn source(
        &self,
        path: &str,
        files: &mut Files<'_>,
        (key, fault): (&'static str, Fault<'_>),
    ) -> Result<Source, MissionError> {
        // Other formats than GeoTIFF are read whole anyway, and carried along with the files beside them.
        if self.file.terrain.working_cells.is_some()
            && let Some(large) = files.large_ground(path)?
        {
            return Ok(match large.reader {
                Some(reader) => {
                    Source::Large(FileValues { reader: Arc::new(reader), resampling: None })
                }
                None => Source::Elsewhere(large.grid),
            });
        }
        let bytes = files.bytes(path)?;
        let read = read_with(path, &bytes, &mut |name| files.sibling(path, name));
        let file = read.map_err(|e| match e {
            TerrainError::TooLarge { .. } => {
                let way = "with `working-cells` in [terrain] it is read piece by piece";
                fault(key, &format!("{e}; {way}"))
            }
            e => fault(key, &e),
        })?;
        Ok(Source::Memory(Box::new(file)))
    }
}

/// The data's own uncertainty, of numbers from 0 to 1.
fn own_u(path: &str, source: Source) -> Result<Option<SiteU>, String> {
    match source {
        Source::Memory(file) => match site_u(&file) {
            Ok(u) => Ok(Some(SiteU::Memory(u))),
            Err((cell, u)) => Err(format!("{path}: {u} at {cell}; expected numbers from 0 to 1")),
        },
        Source::Large(file) => Ok(Some(SiteU::File(file))),
        Source::Elsewhere(_) => Ok(None),
    }
}

/// What a derived layer must not say.
fn only_derived(layer: &LayerFile, fault: Fault<'_>) -> Result<(), MissionError> {
    let of_measured = [
        ("file", layer.file.is_some()),
        ("uncertainty-file", layer.uncertainty_file.is_some()),
        ("kind", layer.kind.is_some()),
        ("update", layer.update.is_some()),
        ("sigma", layer.sigma.is_some()),
        ("classes", layer.classes.is_some()),
        ("resample", layer.resample.is_some()),
    ];
    match of_measured.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => {
            let message = format!("`{}` is derived; only measured layers take this", layer.name);
            Err(fault(key, &message))
        }
        None => Ok(()),
    }
}

/// What a layer must not say whose readings are all handed in.
fn only_handed_in(layer: &LayerFile, fault: Fault<'_>) -> Result<(), MissionError> {
    if layer.name == ELEVATION {
        let message = format!("routes need an `{ELEVATION}` that the ground truly has");
        return Err(fault("handed-in", &message));
    }
    let of_true_values = [
        ("file", layer.file.is_some()),
        ("uncertainty-file", layer.uncertainty_file.is_some()),
        ("derived", layer.derived.is_some()),
        ("sigma", layer.sigma.is_some()),
        ("resample", layer.resample.is_some()),
    ];
    match of_true_values.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => {
            let message = format!(
                "`{}` is handed in; nothing else is known of it, so it takes no `{key}`",
                layer.name
            );
            Err(fault(key, &message))
        }
        None => Ok(()),
    }
}

/// Nothing gives a layer its values.
fn nothing(layer: &LayerFile, scene: Option<&Scene>, fault: Fault<'_>) -> MissionError {
    let mut known = SceneLayer::ALL.map(|layer| layer.to_string());
    known.sort_unstable();
    let expected = if scene.is_some() {
        format!("expected a `file`, or a layer of the landscape: {}", known.join(", "))
    } else {
        "expected a `file` with its true values".to_owned()
    };
    fault("name", &format!("nothing gives `{}`; {expected}", layer.name))
}

fn other_grid(
    layer: &LayerFile,
    found: GridSpec,
    expected: GridSpec,
    (key, fault): (&'static str, Fault<'_>),
) -> MissionError {
    let what = match key {
        "uncertainty-file" => format!("the uncertainty of `{}`", layer.name),
        _ => format!("`{}`", layer.name),
    };
    let message = format!(
        "{what} lies on {}, `{ELEVATION}` on {}; the layers of a mission share one grid, or are brought onto it by \
         `resample`",
        shown(found),
        shown(expected)
    );
    fault(key, &message)
}

/// A layer's values on the grid of the elevation: as they are, or resampled where the layer asks for it.
fn fitted(
    layer: &LayerFile,
    source: Source,
    (grid, crs): (GridSpec, Option<&Crs>),
    (key, fault): (&'static str, Fault<'_>),
) -> Result<Source, MissionError> {
    let asked = match &layer.resample {
        None => None,
        Some(name) => Some(name.parse::<Resampling>().map_err(|e| fault("resample", &e))?),
    };
    let is_class = layer.kind == Some(Kind::Class);
    if let Some(name) =
        asked.filter(|way| is_class && matches!(way, Resampling::Bilinear | Resampling::Average))
    {
        let message = format!(
            "`{name}` mixes values, and classes have no mean; expected `nearest` or `mode`"
        );
        return Err(fault("resample", &message));
    }
    if source.grid() == grid {
        return Ok(source);
    }
    let Some(asked) = asked else {
        return Err(other_grid(layer, source.grid(), grid, (key, fault)));
    };
    if let (Some(here), Some(there)) = (source.crs(), crs)
        && !here.same_projection(there)
    {
        let message = format!(
            "`{}` and `{ELEVATION}` are of different map projections ({here} and {there}); resampling moves no \
             ground, project one of them first",
            layer.name
        );
        return Err(fault(key, &message));
    }
    // The uncertainty of the commonest class is that of the ground it stands for.
    let resampling = match (key, asked) {
        ("uncertainty-file", Resampling::Mode) => Resampling::Average,
        (_, asked) => asked,
    };
    Ok(source.onto(grid, resampling))
}

fn of_file(source: Source, name: &str) -> Result<Values, TerrainError> {
    Ok(match source {
        Source::Memory(file) => Values::Memory(file.into_layer()?),
        Source::Large(file) => Values::File(file),
        Source::Elsewhere(_) => Values::Elsewhere { name: name.to_owned() },
    })
}

/// How a layer is read.
fn kind(layer: &LayerFile, fault: Fault<'_>) -> Result<ReadingKind, MissionError> {
    match layer.kind.unwrap_or(Kind::Scalar) {
        Kind::Scalar => {
            let sigma = layer.sigma.unwrap_or(0.0);
            if !(sigma.is_finite() && sigma >= 0.0) {
                return Err(fault("sigma", &format!("{sigma}; expected a number of at least 0")));
            }
            Ok(ReadingKind::Scalar { sigma })
        }
        Kind::Class => {
            let classes = layer.classes.clone().unwrap_or_default();
            if classes.len() < 2 {
                return Err(fault("classes", &"a class layer needs at least two `classes`"));
            }
            Ok(ReadingKind::Class { classes: classes.into_iter().map(f32::from).collect() })
        }
    }
}
