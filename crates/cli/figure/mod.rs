//! Pictures of rasters, written as PNG: maps seen from above ([`Figure`]) and surfaces seen from the side
//! ([`Surface`]), with their colours, axes, tracks and markers.
//!
//! The same figure gives the same bytes, at any thread count.

pub(crate) mod axis;
pub(crate) mod canvas;
pub(crate) mod colour;
mod frame;
mod key;
mod legend;
mod map;
pub(crate) mod marks;
mod mesh;
mod sheet;
mod surface;
pub(crate) mod text;

pub(crate) use axis::Axes;
pub(crate) use colour::{ColourMap, Ink};
pub(crate) use map::Figure;
pub(crate) use marks::{Markers, Shape, Stroke, Track};
pub(crate) use sheet::Sheet;
pub(crate) use surface::{Mast, Surface};

/// White border around everything, pixels.
const MARGIN: i32 = 18;
/// Space between the parts of a figure, pixels.
const GAP: i32 = 10;
/// Length of a tick, pixels.
const TICK: i32 = 6;
