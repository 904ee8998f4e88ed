//! `wisdom terrain viewshed`.

use anyhow::bail;
use wisdom_grid::Raster;
use wisdom_terrain::{FieldOfView, Layer, Method, Observer, viewshed_by};

use super::input::{ColRow, Input};
use super::output::{Kind, Output, Target, spinner, write};
use super::picture::{Look, Mark, draw_marked};
use crate::exit::InputError;
use crate::figure::ColourMap;

/// Viewshed.
#[derive(clap::Args, Debug)]
#[command(allow_negative_numbers = true)]
pub(crate) struct ViewshedArgs {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    output: Output,
    /// The cell the camera stands on.
    #[arg(long, value_name = "COL,ROW")]
    observer: ColRow,
    /// Height of the camera above the ground, metres.
    #[arg(long, value_name = "M", default_value_t = 2.0)]
    height: f64,
    /// How far it sees, metres; without a limit if not given.
    #[arg(long, value_name = "M")]
    range: Option<f64>,
    /// Radius of the body, metres, or `file` for the one the file tells: ground at distance d drops by d²/2R. A plane
    /// if not given.
    #[arg(long, value_name = "M|file")]
    radius_m: Option<String>,
    /// Height above its ground at which a target counts as seen, metres.
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    target_height: f64,
    /// exact: every line of sight by the definition. fast: a sampled horizon, some cells in a
    /// thousand wrong, at the edges of shadows.
    #[arg(long, default_value = "exact")]
    method: Method,
    /// Middle of the sector it looks at, degrees clockwise from north.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    azimuth_deg: f64,
    /// Width of the sector, degrees.
    #[arg(long, value_name = "DEG", default_value_t = 360.0)]
    field_of_view_deg: f64,
}

pub(super) fn run(args: &ViewshedArgs) -> anyhow::Result<()> {
    let target = args.output.target(&[args.input.path()])?;
    let ground = args.input.open()?;
    let ColRow(at) = args.observer;
    let cell = ground.local("--observer", at)?;
    let body_radius_m = radius_m(args, ground.reader.crs().and_then(|crs| crs.radius_m))?;
    for (option, value, low, high) in [
        ("--height", args.height, 0.0, 1e6),
        ("--target-height", args.target_height, 0.0, 1e6),
        ("--range", args.range.unwrap_or(1.0), f64::MIN_POSITIVE, 1e9),
        ("--azimuth-deg", args.azimuth_deg, -360.0, 360.0),
        ("--field-of-view-deg", args.field_of_view_deg, f64::MIN_POSITIVE, 360.0),
    ] {
        if !(low..=high).contains(&value) {
            let low =
                if low == f64::MIN_POSITIVE { "above 0".to_owned() } else { format!("{low}") };
            return Err(InputError(format!("{option} {value}: expected {low} to {high}")).into());
        }
    }
    let all_round = args.field_of_view_deg >= 360.0;
    let observer = Observer {
        cell,
        height_m: args.height,
        range_m: args.range,
        target_height_m: args.target_height,
        body_radius_m,
        field_of_view: (!all_round).then_some(FieldOfView {
            azimuth_rad: args.azimuth_deg.to_radians(),
            width_rad: args.field_of_view_deg.to_radians(),
        }),
    };
    let file = ground.whole()?;
    let crs = file.crs.clone();
    let elevation = file.into_layer()?;
    if !elevation.is_known(cell) {
        let message =
            format!("--observer {},{}: nothing is known of the ground there", at.col, at.row);
        return Err(InputError(message).into());
    }
    let busy = spinner("looking around");
    let seen = viewshed_by(args.method, &elevation, &observer);
    busy.finish_and_clear();
    let spec = elevation.spec();
    let sight = Raster::par_from_fn(spec, |cell| f32::from(u8::from(seen.is_visible(cell))));
    let in_sight =
        Layer::new(sight, elevation.uncertainty().map(|&u| if u < 1.0 { 0.0 } else { 1.0 }))?;
    match target {
        Target::Tiff(path) => {
            let kind = Kind::bytes("in sight: 1, hidden: 0");
            write(path, spec, crs.as_ref(), &kind.options(), |rows| {
                let cells = rows.start * spec.cols()..rows.end * spec.cols();
                let known = &elevation.uncertainty().values()[cells.clone()];
                let known = known.iter().map(|&u| u < 1.0).collect();
                Ok((in_sight.values().values()[cells].to_vec(), known))
            })
        }
        Target::Picture(path) => {
            let title = format!(
                "In sight from {} m above column {}, row {}{}",
                args.height,
                at.col,
                at.row,
                ground.part()
            );
            let limited = observer.range_m.is_some() || !all_round;
            let hidden = if limited { "hidden or out of range" } else { "hidden" };
            let classes = [hidden, "in sight"];
            let look = Look::new(&title, "in sight", ColourMap::Classes(2)).classes(&classes);
            let camera = Mark { name: format!("camera, {} m up", args.height), cell };
            draw_marked(path, &in_sight, look, Some(&elevation), Some(camera))
        }
    }
}

fn radius_m(args: &ViewshedArgs, of_file: Option<f64>) -> anyhow::Result<Option<f64>> {
    let Some(text) = &args.radius_m else { return Ok(None) };
    if text == "file" {
        if of_file.is_none() {
            bail!(InputError(
                "--radius-m file: the file does not tell the body's radius".to_owned()
            ));
        }
        return Ok(of_file);
    }
    match text.parse::<f64>() {
        Ok(radius_m) if radius_m.is_finite() && radius_m > 0.0 => Ok(Some(radius_m)),
        _ => bail!(InputError(format!(
            "--radius-m {text}: expected a positive number of metres, or `file`"
        ))),
    }
}
