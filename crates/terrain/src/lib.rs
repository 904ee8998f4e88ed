#![doc = include_str!("../README.md")]

mod crs;
mod error;
pub mod format;
mod landscape;
mod layer;
mod noise;
mod surface;
mod viewshed;

pub use crs::{Crs, GeoKeys, Projection};
pub use error::TerrainError;
pub use format::GridFile;
pub use landscape::{Base, Crater, HotSpot, Landscape, Patch, Ridge, Rock, Roughness, Shape, Wall};
pub use layer::Layer;
pub use noise::{normal_noise, unit_noise};
pub use surface::{gradient, hillshade, roughness, slope, step};
pub use viewshed::{FieldOfView, Observer, Viewshed, line_of_sight, viewshed};
