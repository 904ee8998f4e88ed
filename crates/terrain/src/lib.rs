#![doc = include_str!("../README.md")]

mod crs;
mod error;
pub mod format;
mod landscape;
mod layer;
mod noise;
mod resample;
mod surface;
mod viewshed;

pub use crs::{Crs, GeoKeys, Projection};
pub use error::TerrainError;
pub use format::GridFile;
pub use landscape::{
    Base, Crater, HotSpot, Landscape, Patch, Ridge, Rock, Roughness, Scatter, SceneLayer, Shape,
    Wall,
};
pub use layer::Layer;
pub use noise::{normal_noise, unit_noise};
pub use resample::{Resampling, covering, resample};
pub use surface::{
    Hazards, Kernel, Measure, UnknownKernel, gradient, gradient_by, hazards, hillshade, measure,
    measure_into, roughness, slope, step,
};
pub use viewshed::{
    FieldOfView, Method, MethodError, Observer, Viewshed, line_of_sight, viewshed, viewshed_by,
    viewshed_fast,
};
