//! What viewers know how to show: Foxglove's well-known messages, made from ours.
//!
//! Coordinates are metres east (x) and north (y) of the grid's south-west corner. Everything lies at z = 0,
//! because viewers draw a `foxglove.Grid` flat: goals at their elevations would hang kilometres off the map.

use std::f64::consts::FRAC_PI_2;

use foxglove::messages::{
    Color, FrameTransform, Grid, LinePrimitive, Log, PackedElementField, Point3, PointCloud, Pose,
    PoseInFrame, Quaternion, SceneEntity, SceneUpdate, SpherePrimitive, TextPrimitive, Timestamp,
    Vector2, Vector3, line_primitive, log, packed_element_field::NumericType,
};
use wisdom_autonomy as core;
use wisdom_goals::{Action, Term, Verdict};
use wisdom_grid::{Cell, GridSpec, Raster};

/// The frame whose origin is the grid's south-west corner.
const MAP: &str = "map";
/// The frame that moves with the rover: x ahead, y to its left.
const ROVER: &str = "rover";
/// What a Grid's only field is called.
const VALUE: &str = "value";
/// What a point of a cloud holds, each an f32.
const POINT_FIELDS: [&str; 4] = ["x", "y", "z", "interest"];
/// Most points of a cloud.
const CLOUD_POINTS: usize = 8192;
/// Bytes of one f32.
const CELL_BYTES: usize = size_of::<f32>();

/// Colours that stay apart for colour-blind eyes (Okabe & Ito 2008).
const ORANGE: Color = Color { r: 0.90, g: 0.62, b: 0.0, a: 1.0 };
const SKY: Color = Color { r: 0.34, g: 0.71, b: 0.91, a: 1.0 };
const GREEN: Color = Color { r: 0.0, g: 0.62, b: 0.45, a: 1.0 };
const GREY: Color = Color { r: 0.5, g: 0.5, b: 0.5, a: 0.6 };
const VERMILION: Color = Color { r: 0.84, g: 0.37, b: 0.0, a: 1.0 };
const BLUE: Color = Color { r: 0.0, g: 0.45, b: 0.70, a: 1.0 };

const UPRIGHT: Quaternion = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

/// Nanoseconds of mission time as a Foxglove time stamp.
pub(crate) fn timestamp(stamp_ns: u64) -> Timestamp {
    const SECOND_NS: u64 = 1_000_000_000;
    let seconds = u32::try_from(stamp_ns / SECOND_NS).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (stamp_ns % SECOND_NS) as u32)
}

/// A map plane over the run's grid, or over a part of it. Foxglove's rows begin in the south, ours in the north,
/// so the rows are flipped.
pub(crate) fn grid(stamp_ns: u64, run: GridSpec, plane: &Raster<f32>) -> Grid {
    let spec = plane.spec();
    let data: Vec<u8> = plane
        .values()
        .chunks(spec.cols())
        .rev()
        .flat_map(|row| row.iter().flat_map(|value| value.to_le_bytes()))
        .collect();
    let cells_from = |edge: usize, to: usize| (to - edge) as f64 * spec.spacing_m();
    let south_west = Vector3 {
        x: cells_from(run.first().col, spec.first().col),
        y: cells_from(spec.first().row + spec.rows(), run.first().row + run.rows()),
        z: 0.0,
    };
    Grid {
        timestamp: Some(timestamp(stamp_ns)),
        frame_id: MAP.to_owned(),
        pose: Some(Pose { position: Some(south_west), orientation: Some(UPRIGHT) }),
        column_count: spec.cols() as u32,
        cell_size: Some(Vector2 { x: spec.spacing_m(), y: spec.spacing_m() }),
        row_stride: (spec.cols() * CELL_BYTES) as u32,
        cell_stride: CELL_BYTES as u32,
        fields: vec![PackedElementField {
            name: VALUE.to_owned(),
            offset: 0,
            r#type: NumericType::Float32 as i32,
        }],
        data: data.into(),
    }
}

/// The plane that [`grid`] made a message of, or what is wrong with the message.
pub(crate) fn plane(grid: &Grid) -> Result<Raster<f32>, (&'static str, String, &'static str)> {
    let cols = grid.column_count as usize;
    let layout = (grid.row_stride as usize, grid.cell_stride as usize, grid.fields.as_slice());
    let field = match layout {
        (row, CELL_BYTES, [field]) if row == cols * CELL_BYTES && row > 0 => field,
        _ => {
            let found = format!(
                "{} fields, {} bytes a cell, {} a row of {cols} cells",
                grid.fields.len(),
                grid.cell_stride,
                grid.row_stride
            );
            return Err(("fields", found, "one f32 field, without gaps"));
        }
    };
    if field.r#type != NumericType::Float32 as i32 {
        return Err(("fields[0].type", field.r#type.to_string(), "7, which is f32"));
    }
    let row_bytes = cols * CELL_BYTES;
    if !grid.data.len().is_multiple_of(row_bytes) {
        let found = format!("{} bytes", grid.data.len());
        return Err(("data", found, "whole rows"));
    }
    let spacing_m = grid.cell_size.as_ref().map_or(0.0, |size| size.x);
    let spec = GridSpec::new(grid.data.len() / row_bytes, cols, spacing_m)
        .map_err(|error| ("cell_size", error.to_string(), "a grid"))?;
    let values = grid
        .data
        .chunks_exact(row_bytes)
        .rev()
        .flat_map(|row| row.chunks_exact(CELL_BYTES))
        .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
        .collect();
    Raster::from_vec(spec, values).map_err(|error| ("data", error.to_string(), "rows x columns"))
}

/// Rows and columns from one point of a cloud to the next: the smallest step at which no part of this shape has more
/// than [`CLOUD_POINTS`] of them. It hangs on the shape alone, so that the points of a run stay where they are.
fn thinning(rows: usize, cols: usize) -> usize {
    let points = |step: usize| rows.div_ceil(step) * cols.div_ceil(step);
    let most = rows.max(cols);
    (1..=most).find(|&step| points(step) <= CLOUD_POINTS).expect("one point for all is few enough")
}

/// The interest map draped over the ground: x, y, z in metres and the interest, four f32 a point, row by row from the
/// north-west. Cells whose elevation is not known are left out; of the others, those whose row and column in the run's
/// grid are multiples of [`thinning`].
///
/// Heights are above the lowest known cell of the map, because everything else in the scene lies at z = 0.
pub(crate) fn cloud(
    stamp_ns: u64,
    run: GridSpec,
    elevation: &Raster<f32>,
    uncertainty: &Raster<f32>,
    interest: &Raster<f32>,
) -> PointCloud {
    let spec = elevation.spec();
    let step = thinning(spec.rows(), spec.cols());
    let known = |cell: Cell| uncertainty[cell] < 1.0;
    let heights = spec.cells().filter(|&cell| known(cell)).map(|cell| elevation[cell]);
    let lowest_m = heights.fold(f32::INFINITY, f32::min);
    let mut data = Vec::new();
    let drawn = |cell: &Cell| cell.row.is_multiple_of(step) && cell.col.is_multiple_of(step);
    for cell in spec.cells().filter(drawn).filter(|&cell| known(cell)) {
        let Vector3 { x, y, .. } = centre(run, cell);
        for value in [x as f32, y as f32, elevation[cell] - lowest_m, interest[cell]] {
            data.extend_from_slice(&value.to_le_bytes());
        }
    }
    let origin = Vector3 { x: 0.0, y: 0.0, z: 0.0 };
    let field = |(index, name): (usize, &str)| PackedElementField {
        name: name.to_owned(),
        offset: (index * CELL_BYTES) as u32,
        r#type: NumericType::Float32 as i32,
    };
    PointCloud {
        timestamp: Some(timestamp(stamp_ns)),
        frame_id: MAP.to_owned(),
        pose: Some(Pose { position: Some(origin), orientation: Some(UPRIGHT) }),
        point_stride: (POINT_FIELDS.len() * CELL_BYTES) as u32,
        fields: POINT_FIELDS.into_iter().enumerate().map(field).collect(),
        data: data.into(),
    }
}

/// A cell's centre in metres from the south-west corner.
fn centre(spec: GridSpec, cell: Cell) -> Vector3 {
    let (x, y) = spec.centre_m(cell);
    let south_m = spec.north_m() - spec.rows() as f64 * spec.spacing_m();
    Vector3 { x: x - spec.west_m(), y: y - south_m, z: 0.0 }
}

fn place(spec: GridSpec, pose: core::Pose) -> (Vector3, Quaternion) {
    // Headings turn clockwise from north, yaw turns anticlockwise from east.
    let half_yaw = (FRAC_PI_2 - pose.heading_rad) / 2.0;
    (centre(spec, pose.cell), Quaternion { x: 0.0, y: 0.0, z: half_yaw.sin(), w: half_yaw.cos() })
}

/// Where the rover stands.
pub(crate) fn pose(stamp_ns: u64, spec: GridSpec, pose: core::Pose) -> PoseInFrame {
    let (position, orientation) = place(spec, pose);
    PoseInFrame {
        timestamp: Some(timestamp(stamp_ns)),
        frame_id: MAP.to_owned(),
        pose: Some(Pose { position: Some(position), orientation: Some(orientation) }),
    }
}

/// From the map's frame to the rover's.
pub(crate) fn transform(stamp_ns: u64, spec: GridSpec, pose: core::Pose) -> FrameTransform {
    let (translation, rotation) = place(spec, pose);
    FrameTransform {
        timestamp: Some(timestamp(stamp_ns)),
        parent_frame_id: MAP.to_owned(),
        child_frame_id: ROVER.to_owned(),
        translation: Some(translation),
        rotation: Some(rotation),
    }
}

/// A line of the text log.
pub(crate) fn log(stamp_ns: u64, level: log::Level, text: &str) -> Log {
    Log {
        timestamp: Some(timestamp(stamp_ns)),
        level: level as i32,
        message: text.to_owned(),
        name: "wisdom".to_owned(),
        file: String::new(),
        line: 0,
    }
}

/// What a goal looks like after a deliberation.
fn colour(verdict: &Verdict) -> Color {
    match verdict.action {
        Action::Achieve => GREEN,
        Action::Drop => GREY,
        Action::Defer => SKY,
        Action::Add | Action::Keep | Action::Modify | Action::Reorder => ORANGE,
    }
}

/// A verdict in a line: what was done with the goal, why, and the numbers compared.
pub(crate) fn sentence(verdict: &Verdict) -> String {
    let other = verdict.other.map(|other| format!(" ({other})")).unwrap_or_default();
    let term = |term: &Term| match term.limit {
        Some(limit) => format!(", {} {:.4} against {limit:.4}", term.name, term.value),
        None => format!(", {} {:.4}", term.name, term.value),
    };
    let terms: String = verdict.terms.iter().map(term).collect();
    format!("{} {}: {}{other}{terms}", verdict.goal.id, verdict.action, verdict.reason)
}

fn entity(stamp_ns: u64, id: String) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(stamp_ns)),
        frame_id: MAP.to_owned(),
        id,
        ..SceneEntity::default()
    }
}

fn goal(stamp_ns: u64, spec: GridSpec, verdict: &Verdict) -> SceneEntity {
    let position = centre(spec, verdict.goal.target);
    let pose = Pose { position: Some(position), orientation: Some(UPRIGHT) };
    let size = 2.0 * spec.spacing_m();
    let label = match verdict.turn {
        Some(turn) => format!("{} turn {turn}, prize {:.3}", verdict.goal.id, verdict.goal.prize),
        None => format!("{} {}: {}", verdict.goal.id, verdict.action, verdict.reason),
    };
    SceneEntity {
        spheres: vec![SpherePrimitive {
            pose: Some(pose),
            size: Some(Vector3 { x: size, y: size, z: size }),
            color: Some(colour(verdict)),
        }],
        texts: vec![TextPrimitive {
            pose: Some(pose),
            billboard: true,
            font_size: 14.0,
            scale_invariant: true,
            color: Some(colour(verdict)),
            text: label,
        }],
        ..entity(stamp_ns, format!("goal/{}", verdict.goal.id))
    }
}

/// A line through cells; an entity without a line, which clears the last one, if there are fewer than two.
fn line(stamp_ns: u64, spec: GridSpec, id: &str, cells: &[Cell], color: Color) -> SceneEntity {
    let point = |&cell: &Cell| {
        let Vector3 { x, y, z } = centre(spec, cell);
        Point3 { x, y, z }
    };
    let strip = LinePrimitive {
        r#type: line_primitive::Type::LineStrip as i32,
        pose: Some(Pose {
            position: Some(Vector3 { x: 0.0, y: 0.0, z: 0.0 }),
            orientation: Some(UPRIGHT),
        }),
        thickness: 3.0,
        scale_invariant: true,
        points: cells.iter().map(point).collect(),
        color: Some(color),
        colors: Vec::new(),
        indices: Vec::new(),
    };
    SceneEntity {
        lines: if cells.len() > 1 { vec![strip] } else { Vec::new() },
        ..entity(stamp_ns, id.to_owned())
    }
}

/// The cells that a decision means to drive: its whole plan, or the way to its vantage or home.
fn planned(decision: &core::Decision) -> Vec<Cell> {
    match &decision.act {
        core::Act::Look { route, .. } | core::Act::Home { route } => route.cells.clone(),
        core::Act::Pursue(_) => decision
            .family
            .get(decision.chosen)
            .into_iter()
            .flat_map(|member| &member.plan.legs)
            .flat_map(|leg| leg.route.cells.iter().copied())
            .collect(),
        _ => Vec::new(),
    }
}

/// Goals, the planned path and the driven track after a decision. Goals that ended keep their last colour.
pub(crate) fn scene(
    stamp_ns: u64,
    spec: GridSpec,
    decision: &core::Decision,
    track: &[Cell],
) -> SceneUpdate {
    let mut entities: Vec<SceneEntity> =
        decision.verdicts.iter().map(|verdict| goal(stamp_ns, spec, verdict)).collect();
    entities.push(line(stamp_ns, spec, "path", &planned(decision), VERMILION));
    entities.push(line(stamp_ns, spec, "track", track, BLUE));
    SceneUpdate { deletions: Vec::new(), entities }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use wisdom_grid::Window;

    use super::*;

    #[test]
    fn the_first_row_of_a_foxglove_grid_is_the_south() {
        let spec = GridSpec::new(2, 2, 0.5).unwrap();
        let map = Raster::from_vec(spec, vec![1.0, 2.0, 3.0, 4.0]).unwrap();
        let message = grid(0, spec, &map);
        assert_eq!(message.data[..4], 3.0_f32.to_le_bytes());
        assert_eq!(plane(&message).unwrap(), map);
    }

    #[test]
    fn a_map_of_a_part_of_the_ground_lies_where_the_part_lies() {
        let run = GridSpec::new(100, 200, 0.5).unwrap().at(1000.0, -500.0);
        let part = run.part(Window { row: 10, col: 20, rows: 30, cols: 40 }).unwrap();
        let message = grid(0, run, &Raster::filled(part, 1.0));
        let place = message.pose.and_then(|pose| pose.position).unwrap();
        assert_eq!((place.x, place.y), (10.0, 30.0));
    }

    /// The points of a cloud: x, y, z, interest.
    fn points(cloud: &PointCloud) -> Vec<[f32; 4]> {
        let number = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap());
        let point =
            |p: &[u8]| -> [f32; 4] { std::array::from_fn(|i| number(&p[4 * i..4 * i + 4])) };
        cloud.data.chunks_exact(cloud.point_stride as usize).map(point).collect()
    }

    #[test]
    fn a_cloud_hangs_the_known_ground_over_its_lowest_cell() {
        let run = GridSpec::new(3, 4, 2.0).unwrap().at(1000.0, -500.0);
        let part = run.part(Window { row: 0, col: 1, rows: 2, cols: 2 }).unwrap();
        let plane = |values: [f32; 4]| Raster::from_vec(part, values.to_vec()).unwrap();
        // The unknown cell keeps no height: its 0 must not become the lowest.
        let elevation = plane([12.5, 0.0, 10.0, 11.0]);
        let uncertainty = plane([0.2, 1.0, 0.0, 0.5]);
        let cloud = cloud(0, run, &elevation, &uncertainty, &plane([0.1, 0.2, 0.3, 0.4]));
        assert_eq!(
            points(&cloud),
            [[3.0, 5.0, 2.5, 0.1], [3.0, 3.0, 0.0, 0.3], [5.0, 3.0, 1.0, 0.4]]
        );
        let fields: Vec<_> = cloud.fields.iter().map(|f| (f.name.as_str(), f.offset)).collect();
        assert_eq!(fields, [("x", 0), ("y", 4), ("z", 8), ("interest", 12)]);
    }

    #[test]
    fn ground_that_nothing_is_known_of_has_no_points() {
        let spec = GridSpec::new(3, 4, 2.0).unwrap();
        let (none, unknown) = (Raster::filled(spec, 0.0), Raster::filled(spec, 1.0));
        assert!(cloud(0, spec, &none, &unknown, &none).data.is_empty());
    }

    #[test]
    fn a_cloud_is_thinned_no_more_than_it_must_be() {
        for (rows, cols) in [(1, 1), (101, 101), (128, 128), (129, 128), (512, 512), (65_535, 3)] {
            let step = thinning(rows, cols);
            let points = |step: usize| rows.div_ceil(step) * cols.div_ceil(step);
            assert!(points(step) <= CLOUD_POINTS, "{rows} x {cols}");
            assert!(step == 1 || points(step - 1) > CLOUD_POINTS, "{rows} x {cols}");
        }
    }

    #[test]
    fn points_stay_where_they_are_when_the_working_map_moves_on() {
        let run = GridSpec::new(400, 400, 1.0).unwrap();
        let drawn = |row: usize| {
            let part = run.part(Window { row, col: 7, rows: 200, cols: 300 }).unwrap();
            let (level, known) = (Raster::filled(part, 1.0), Raster::filled(part, 0.0));
            let places = points(&cloud(0, run, &level, &known, &level));
            places.iter().map(|p| (p[0] as u32, p[1] as u32)).collect::<BTreeSet<_>>()
        };
        let (before, after) = (drawn(0), drawn(101));
        let both = |&(_, y): &(u32, u32)| (200..299).contains(&y);
        let shared = |places: &BTreeSet<_>| places.iter().copied().filter(both).collect::<Vec<_>>();
        assert!(shared(&before).len() > 1000);
        assert_eq!(shared(&before), shared(&after));
    }

    #[test]
    fn a_grid_that_is_not_ours_is_refused_by_field() {
        let spec = GridSpec::new(2, 2, 0.5).unwrap();
        let whole = grid(0, spec, &Raster::filled(spec, 1.0));
        let cut = Grid { data: whole.data.slice(..9), ..whole.clone() };
        let wide = Grid { column_count: 0, row_stride: 0, ..whole.clone() };
        let flat = Grid { cell_size: None, ..whole.clone() };
        let told = [cut, wide, flat].map(|grid| plane(&grid).unwrap_err().0);
        assert_eq!(told, ["data", "fields", "cell_size"]);
    }

    #[test]
    fn the_south_west_cell_lies_half_a_cell_from_the_origin_wherever_the_grid_is() {
        let spec = GridSpec::new(3, 4, 2.0).unwrap().at(1000.0, -500.0);
        let Vector3 { x, y, z } = centre(spec, Cell::new(2, 0));
        assert_eq!((x, y, z), (1.0, 1.0, 0.0));
    }

    #[test]
    fn a_rover_that_faces_east_is_not_turned() {
        let spec = GridSpec::new(3, 3, 1.0).unwrap();
        let turn = |heading_rad| place(spec, core::Pose { cell: Cell::new(1, 1), heading_rad }).1;
        assert_eq!(turn(FRAC_PI_2), UPRIGHT);
        // North is a quarter turn to the left of east.
        assert!((turn(0.0).z - (FRAC_PI_2 / 2.0).sin()).abs() < 1e-15);
    }
}
