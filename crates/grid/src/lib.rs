#![doc = include_str!("../README.md")]

mod cell;
mod raster;
mod spec;
mod window;

pub use cell::{Cell, NEIGHBOURS};
pub use raster::Raster;
pub use spec::{GridError, GridSpec, MAX_SIDE};
pub use window::Window;
