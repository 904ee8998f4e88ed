//! What the viewer asks for and a log holds only as digests, made again by the core.

use std::borrow::Cow;
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use serde_json::{Value, json};
use wisdom_autonomy::Spec;
use wisdom_fusion::credit;
use wisdom_grid::{Cell, Raster};
use wisdom_logbook::{
    Deriver, LogReader, Past, PlaneGroup, PlaneInfo, ReplayError, is_plane, plane, planes,
};
use wisdom_viewer::{Answer, Asked, Refusal, Remade};

use crate::explain;

/// Planes kept: most of them take a while, and the reader of a page goes back and forth.
const KEPT_PLANES: usize = 24;

/// A plane at a decision.
struct Kept {
    decision: u32,
    name: String,
    plane: Arc<Raster<f32>>,
}

/// What a file was when it was read: one that grows is another.
type Stamp = Option<(u64, SystemTime)>;

type Opened = Result<Deriver<Arc<LogReader>>, String>;

/// The decisions of one log, for the viewer. The log is read when it is first asked for.
pub(crate) struct OfLog {
    path: PathBuf,
    deriver: Mutex<Option<(Stamp, Opened)>>,
    planes: Mutex<VecDeque<Kept>>,
    prices: Mutex<BTreeMap<u32, Value>>,
}

impl OfLog {
    pub(crate) fn new(path: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            deriver: Mutex::default(),
            planes: Mutex::default(),
            prices: Mutex::default(),
        }
    }

    /// Does something with the deriver, which is made first if this is the first time.
    fn with<T>(
        &self,
        what: impl FnOnce(&mut Deriver<Arc<LogReader>>) -> Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        let mut deriver = self.lock();
        let (_, made) = deriver.get_or_insert_with(|| self.opened());
        made.as_mut().map_or_else(|why| Err(Refusal::Failed(why.clone())), what)
    }

    fn lock(&self) -> MutexGuard<'_, Option<(Stamp, Opened)>> {
        // A panic while deriving leaves the kept decisions whole: they are added when they are ready.
        self.deriver.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn opened(&self) -> (Stamp, Opened) {
        let stamp = self.stamp();
        let log = LogReader::open(&self.path()).map_err(ReplayError::from);
        let made = log.and_then(|log| Deriver::new(Arc::new(log)));
        (stamp, made.map_err(|error| error.to_string()))
    }

    /// Where the log is: a run that ends gives its file the final name.
    fn path(&self) -> PathBuf {
        wisdom_viewer::now_at(&self.path)
    }

    fn stamp(&self) -> Stamp {
        let facts = std::fs::metadata(self.path()).ok()?;
        Some((facts.len(), facts.modified().ok()?))
    }

    /// Forgets what was read of a file that is another by now; whether what was `asked` is such.
    fn forget_if_grown(&self, asked: Stamp) -> bool {
        let now = self.stamp();
        let mut deriver = self.lock();
        // Somebody else may have read it anew meanwhile.
        if deriver.as_ref().is_some_and(|(stamp, _)| *stamp != now) {
            *deriver = None;
        }
        asked != now
    }

    /// Goes through the decisions once, so that each is near one that is kept when it is asked for.
    pub(crate) fn go_through(&self) {
        for decision in 0.. {
            if self.past(decision).is_err() {
                break;
            }
            // Whoever asks meanwhile gets the lock before this goes on.
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn past(&self, decision: u32) -> Result<Arc<Past>, Refusal> {
        let ask = || {
            self.with(|deriver| match deriver.at(decision) {
                Ok(Some(past)) => Ok(past),
                Ok(None) => Err(Refusal::NotThere(format!("the log has no decision {decision}"))),
                Err(error) => Err(Refusal::Failed(error.to_string())),
            })
        };
        let asked = self.lock().as_ref().and_then(|(stamp, _)| *stamp);
        ask().or_else(|refusal| if self.forget_if_grown(asked) { ask() } else { Err(refusal) })
    }

    fn plane(&self, decision: u32, name: &str) -> Result<Arc<Raster<f32>>, Refusal> {
        let lock = || self.planes.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |kept: &&Kept| kept.decision == decision && kept.name == name;
        if let Some(kept) = lock().iter().find(known) {
            return Ok(Arc::clone(&kept.plane));
        }
        let past = self.past(decision)?;
        let made = plane(&past.rover, name).map(Cow::into_owned).map(Arc::new);
        let made = made.ok_or_else(|| no_plane(past.rover.spec(), name))?;
        let mut planes = lock();
        if planes.len() == KEPT_PLANES {
            planes.pop_front();
        }
        planes.push_back(Kept { decision, name: name.to_owned(), plane: Arc::clone(&made) });
        Ok(made)
    }

    fn cell(&self, decision: u32, row: u32, col: u32) -> Result<Value, Refusal> {
        let past = self.past(decision)?;
        let spec = past.rover.spec();
        let cell = Cell::new(row as usize, col as usize);
        let mut values = serde_json::Map::new();
        let mut anywhere = false;
        for PlaneInfo { name, .. } in planes(spec).into_iter().filter(is_told_by_cell) {
            let value = self.plane(decision, &name)?.get(cell).copied();
            anywhere |= value.is_some();
            values.insert(name, json!(value));
        }
        let evidence = &past.maps().evidence;
        let experts: Vec<Value> = if evidence.spec().contains(cell) {
            let credits = credit(evidence, &spec.fusion, cell);
            let told = evidence.experts().zip(credits);
            told.map(|((name, masses), credit)| {
                let [interesting, not_interesting, ignorance, paradox] = masses[cell].masses();
                json!({
                    "name": name,
                    "masses": {
                        "interesting": interesting, "not_interesting": not_interesting,
                        "ignorance": ignorance, "paradox": paradox,
                    },
                    "credit": credit,
                })
            })
            .collect()
        } else if anywhere {
            Vec::new()
        } else {
            return Err(Refusal::NotThere(format!("the map of decision {decision} has no {cell}")));
        };
        Ok(json!({ "planes": values, "experts": experts }))
    }

    fn prices(&self, decision: u32) -> Result<Value, Refusal> {
        let lock = || self.prices.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&decision) {
            return Ok(known.clone());
        }
        let told = explain::left_out(&*self.past(decision)?);
        lock().insert(decision, told.clone());
        Ok(told)
    }
}

/// What experts say is told beside the planes, unrounded.
fn is_told_by_cell(plane: &PlaneInfo) -> bool {
    !matches!(plane.group, PlaneGroup::Mass | PlaneGroup::Credit)
}

fn no_plane(spec: &Spec, name: &str) -> Refusal {
    debug_assert!(!is_plane(spec, name), "{name} is a plane, and was not made");
    Refusal::NotThere(format!("no plane is called `{name}`"))
}

impl Remade for OfLog {
    fn answer(&self, asked: &Asked) -> Result<Answer, Refusal> {
        match asked {
            Asked::Index => {
                // A page that is loaded again shows what is there by now.
                self.forget_if_grown(None);
                let told = self.with(|deriver| Ok(index(deriver.start().spec(), |_| true)));
                let told = told.or_else(|refusal| match refusal {
                    Refusal::Failed(why) => Ok(json!({ "unavailable": why })),
                    refusal @ Refusal::NotThere(_) => Err(refusal),
                });
                told.map(Answer::Json)
            }
            Asked::Plane { decision, name } => {
                self.plane(*decision, name).map(|raster| Answer::Plane(bytes(&raster)))
            }
            Asked::Cell { decision, row, col } => {
                self.cell(*decision, *row, *col).map(Answer::Json)
            }
            Asked::Family { decision } => {
                self.past(*decision).map(|past| Answer::Json(family(&past)))
            }
            Asked::Prices { decision } => self.prices(*decision).map(Answer::Json),
        }
    }
}

/// What there is to be asked of a mission's decisions.
pub(crate) fn index(spec: &Spec, there: impl Fn(&str) -> bool) -> Value {
    let one = |plane: &PlaneInfo| {
        let classes = plane.classes.iter();
        let classes: Vec<Value> =
            classes.map(|(value, name)| json!({ "value": value, "name": name })).collect();
        json!({
            "name": plane.name, "label": plane.label, "unit": plane.unit, "group": plane.group.name(),
            "classes": classes,
        })
    };
    let all = planes(spec);
    let planes: Vec<Value> = all.iter().filter(|plane| there(&plane.name)).map(one).collect();
    let experts: Vec<&str> = spec.experts.iter().map(|expert| expert.name.as_str()).collect();
    json!({ "planes": planes, "experts": experts })
}

/// The way of each plan of a decision's family, from where the rover stood.
pub(crate) fn family(past: &Past) -> Value {
    let plans = past.decision.family.iter().map(|option| {
        let mut cells = vec![past.decision.state.pose.cell];
        cells.extend(option.plan.legs.iter().flat_map(|leg| leg.route.cells.iter().copied()));
        cells.dedup();
        let cells: Vec<[usize; 2]> = cells.iter().map(|cell| [cell.row, cell.col]).collect();
        json!({ "cells": cells })
    });
    json!({ "plans": plans.collect::<Vec<_>>() })
}

/// A plane as the page reads it.
fn bytes(raster: &Raster<f32>) -> Vec<u8> {
    let window = raster.spec().window();
    let place = [window.row, window.col, window.rows, window.cols];
    let place = place.into_iter().flat_map(|number| (number as u32).to_le_bytes());
    place.chain(raster.values().iter().flat_map(|value| value.to_le_bytes())).collect()
}
