//! Figs. 2 to 10 of the paper, drawn from the first look at the scene: maps, and surfaces for Figs. 2, 3 and 10.

use std::f64::consts::FRAC_PI_4;
use std::path::{Path, PathBuf};

use anyhow::Context;
use wisdom_grid::{Cell, Raster};
use wisdom_terrain::hillshade;

use super::expected::{Expected, cell_at};
use super::scene::Look;
use crate::figure::{Axes, ColourMap, Figure, Ink, Markers, Mast, Shape, Surface};

/// Light from the north-west, where map readers expect it (Imhof, 1982).
const LIGHT_AZIMUTH_RAD: f64 = 7.0 * FRAC_PI_4;
/// Halfway up.
const LIGHT_ALTITUDE_RAD: f64 = FRAC_PI_4;
/// How bright the darkest slope in sight is, where hidden ground is 0: the two must not be mixed up.
const LEAST_IN_SIGHT: f32 = 0.55;

/// How high the letters of Fig. 10 stand: those of the rocks clear of their tops, the others clear of those.
const ROCKS_AT: f64 = 25.0;
const AREAS_AT: f64 = 30.0;

/// Draws the figures into a folder, which is made if it is not there, and says where they are.
pub(super) fn draw(
    look: &Look,
    expected: &Expected,
    folder: &Path,
) -> anyhow::Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let heights = look.elevation.values();
    let shade = hillshade(&look.elevation, LIGHT_AZIMUTH_RAD, LIGHT_ALTITUDE_RAD);
    let sight = Raster::from_fn(look.grid, |cell| {
        let lit = LEAST_IN_SIGHT + (1.0 - LEAST_IN_SIGHT) * shade[cell];
        if look.visible[cell] { lit } else { 0.0 }
    });
    // The bar starts far below the ground, which then is light enough to be darkened.
    let (low, high) = heights
        .values()
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), &z| (low.min(z), high.max(z)));
    let range = (f64::from(low - (high - low)).floor(), f64::from(high).ceil());
    let height = look.camera_height_m;
    let camera = Markers {
        name: format!("camera, {height} units above the ground"),
        shape: Shape::Star,
        ink: Ink::Vermilion,
        at: vec![(look.camera, String::new())],
    };
    let Letters { rocks, areas } = letters(look, expected);
    let u = |title: &str, layer| map(title, layer, ColourMap::Viridis, "u").range(0.0, 1.0);
    let figures = [
        (
            "figure-3-visibility-map",
            map(
                "Fig. 3  Visibility over the DEM (dark: not in sight)",
                heights,
                ColourMap::Viridis,
                "elevation",
            )
            .range(range.0, range.1)
            .hillshade(&sight)
            .markers(camera.clone()),
        ),
        ("figure-4-dem-uncertainty", u("Fig. 4  Uncertainty of the DEM", &look.dem_u)),
        (
            "figure-5-gradient",
            map(
                "Fig. 5  Gradient magnitude of the DEM",
                &look.gradient,
                ColourMap::Viridis,
                "gradient",
            ),
        ),
        (
            "figure-6-temperature",
            map("Fig. 6  Infrared map", &look.temperature, ColourMap::Viridis, "temperature"),
        ),
        (
            "figure-7-texture",
            map("Fig. 7  Texture map", &look.texture, ColourMap::Classes(5), "texture")
                .class_names(&[
                    "not in database",
                    "texture 1",
                    "texture 2",
                    "texture 3",
                    "texture 4",
                ]),
        ),
        (
            "figure-8a-temperature-uncertainty",
            u("Fig. 8a  Uncertainty of the infrared map", &look.temperature_u),
        ),
        (
            "figure-8b-texture-uncertainty",
            u("Fig. 8b  Uncertainty of the texture map", &look.texture_u),
        ),
        (
            "figure-9-interest",
            map("Fig. 9  Interest map under DSmC", &look.interest, ColourMap::Viridis, "Bel(I)")
                .range(0.0, 1.0)
                .markers(named(
                    &[rocks.clone(), areas.clone()].concat(),
                    Ink::White,
                    "areas that the paper names",
                )),
        ),
    ];
    let seen = look.visible.map(|&visible| f32::from(u8::from(visible)));
    let surfaces = [
        (
            "figure-2-dem",
            surface(
                "Fig. 2  DEM of the synthetic landscape: the bumps are rocks",
                look,
                heights,
                ColourMap::Sand,
            )
            .value_label("elevation"),
        ),
        (
            "figure-3-visibility",
            surface("Fig. 3  Visibility over the DEM", look, &seen, ColourMap::Shades(2))
                .class_names(&["not in sight", "in sight"])
                .masts(camera, Mast::Long(height)),
        ),
        (
            "figure-10-interest",
            surface(
                "Fig. 10  Interest map under DSmC over the DEM",
                look,
                &look.interest,
                ColourMap::Viridis,
            )
            .value_label("Bel(I)")
            .range(0.0, 1.0)
            .masts(named(&rocks, Ink::White, "rocks"), Mast::UpTo(ROCKS_AT))
            .masts(
                named(&areas, Ink::SkyBlue, "other areas that the paper names"),
                Mast::UpTo(AREAS_AT),
            ),
        ),
    ];
    let path = |name: &str| folder.join(name).with_extension("png");
    let mut drawn = Vec::new();
    // In the order of the paper, whose last figure is a surface.
    let (before, after) = surfaces.split_at(2);
    for (name, surface) in before {
        surface.save(&path(name))?;
        drawn.push(path(name));
    }
    for (name, figure) in figures {
        figure.save(&path(name))?;
        drawn.push(path(name));
    }
    for (name, surface) in after {
        surface.save(&path(name))?;
        drawn.push(path(name));
    }
    Ok(drawn)
}

/// A figure with the paper's axes.
fn map<'a>(title: &str, layer: &'a Raster<f32>, colours: ColourMap, label: &str) -> Figure<'a> {
    Figure::new(title, layer, colours).axes(Axes::Counted).value_label(label)
}

/// A surface over the DEM with the paper's axes.
fn surface<'a>(
    title: &str,
    look: &'a Look,
    values: &'a Raster<f32>,
    colours: ColourMap,
) -> Surface<'a> {
    Surface::new(title, look.elevation.values(), values, colours)
        .axes(Axes::Counted)
        .height_label("z (units)")
}

/// Markers of areas.
fn named(areas: &[(Cell, String)], ink: Ink, name: &str) -> Markers {
    Markers { name: name.to_owned(), shape: Shape::Circle, ink, at: areas.to_vec() }
}

/// Where the letters of Fig. 9 stand.
struct Letters {
    rocks: Vec<(Cell, String)>,
    areas: Vec<(Cell, String)>,
}

/// The areas A to N of Fig. 9, those on the map: the rocks, and the others.
fn letters(look: &Look, expected: &Expected) -> Letters {
    let grid = look.grid;
    let nearest = |[x, y]: [f64; 2]| {
        let on_map = x >= 1.0 && y >= 1.0 && x <= grid.cols() as f64 && y <= grid.rows() as f64;
        on_map.then(|| cell_at(grid, [x, y].map(|v| v.round() as usize)))
    };
    let disc = &expected.hot_disc;
    let edge = &expected.texture_edge;
    let middle = |from: usize, to: usize| f64::midpoint(from as f64, to as f64);
    let edge_at = edge
        .right
        .first()
        .map(|right| [middle(edge.left.to[0], right.from[0]), middle(right.from[1], right.to[1])]);
    let rocks = expected.rock.iter().map(|rock| (rock.name.as_str(), nearest(rock.centre)));
    let areas: [(&str, Option<Cell>); 3] = [
        (&disc.name, nearest(disc.centre)),
        (&expected.most_interesting.name, look.best_of_hot_border(expected)),
        (&edge.name, edge_at.and_then(nearest)),
    ];
    let on_map = |(name, cell): (&str, Option<Cell>)| Some((cell?, name.to_owned()));
    Letters {
        rocks: rocks.filter_map(on_map).collect(),
        areas: areas.into_iter().filter_map(on_map).collect(),
    }
}
