//! Bel(I) of a whole map straight from what was read, at the speed of memory: nothing is kept in between.

use std::collections::BTreeMap;

use rayon::prelude::*;
use wisdom_belief::map::{self, MAX_MAP_SOURCES, MAX_ROWS, Outputs, Source, Table};
use wisdom_grid::Raster;
use wisdom_terrain::Layer;

use crate::expert::readings;
use crate::{Expert, Fusion, FusionError, Statistic, interest_map, judge};

/// Cells a thread takes at a time: enough to forget what it costs to hand them out.
const CHUNK: usize = 1 << 16;

/// Bel(I) of every cell, whatever [`Fusion::statistic`] says, straight from readings and their uncertainty: within
/// 1e-6 of what [`judge`] and [`interest_map`] give, many times as fast and without the
/// memory for what each expert says. For those who want the map and not its reasons. The same bits at any
/// number of threads.
///
/// ```
/// # use std::collections::BTreeMap;
/// # use wisdom_belief::Opinion;
/// # use wisdom_fusion::{Class, Expert, Fusion, LookupTable, Rows, belief_map};
/// # use wisdom_grid::{Cell, GridSpec, Raster};
/// # use wisdom_terrain::Layer;
/// let dull = Opinion { paradox: 0.2, not_interesting: 0.8, interesting: 0.0 };
/// let rare = Opinion { paradox: 0.05, not_interesting: 0.0, interesting: 0.95 };
/// let rows = Rows::Classes(vec![Class { class: 4, opinion: rare }]);
/// let table = LookupTable::new("texture", "texture class", "1", rows, dull)?;
/// let expert = Expert { name: "texture".into(), layer: "texture".into(), table };
///
/// let spec = GridSpec::new(1, 3, 1.0)?;
/// let (values, u) =
///     (Raster::from_vec(spec, vec![4.0, 4.0, 1.0])?, Raster::from_vec(spec, vec![0.0, 0.5, 0.0])?);
/// let layers = BTreeMap::from([("texture".to_owned(), Layer::new(values, u)?)]);
/// let belief = belief_map(&[expert], &layers, &Fusion::default())?;
/// assert_eq!(belief.values(), [1.0, 0.5, 0.2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// (A table of more than [`MAX_ROWS`] intervals, those between its rows among them, and more than
/// [`MAX_MAP_SOURCES`] experts take the slow road.)
///
/// # Errors
/// As [`judge`] and [`Fusion::check`].
#[expect(clippy::missing_panics_doc, reason = "what was checked above cannot be refused below")]
pub fn belief_map(
    experts: &[Expert],
    layers: &BTreeMap<String, Layer>,
    fusion: &Fusion,
) -> Result<Raster<f32>, FusionError> {
    fusion.check(experts.len())?;
    let readings = readings(experts, layers)?;
    let columns = experts.iter().map(columns).collect::<Option<Vec<_>>>();
    let Some(columns) = columns.filter(|_| experts.len() <= MAX_MAP_SOURCES) else {
        let fusion = Fusion { statistic: Statistic::Belief, ..*fusion };
        return Ok(interest_map(&judge(experts, layers)?, &fusion).interest);
    };
    let spec = readings[0].1.spec();
    let settings = fusion.settings();
    let mut belief = vec![0.0_f32; spec.len()];
    belief.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, belief)| {
        let cells = chunk * CHUNK..chunk * CHUNK + belief.len();
        let sources: Vec<Source<'_, f32>> = readings
            .iter()
            .zip(&columns)
            .map(|((_, layer), (bounds, table))| Source::Readings {
                values: &layer.values().values()[cells.clone()],
                bounds,
                table,
                uncertainty: &layer.uncertainty().values()[cells.clone()],
            })
            .collect();
        let outputs = Outputs { belief: Some(belief), ..Outputs::default() };
        map::fuse(fusion.rule, &sources, fusion.paradox_policy, &settings, outputs)
            .expect("the fusion was checked, and all planes are as long as the grid");
    });
    Ok(Raster::from_vec(spec, belief).expect("one value a cell"))
}

/// A table as the map kernels read it, if they can.
fn columns(expert: &Expert) -> Option<(Vec<f32>, Table<f32>)> {
    let (bounds, rows) = expert.table.intervals();
    (rows.len() <= MAX_ROWS).then(|| {
        let table = Table::new(&rows).expect("a look-up table checks its opinions");
        (bounds, table)
    })
}
