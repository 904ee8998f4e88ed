//! Charts, as SVG and as PNG from one description. Of a campaign's statistics: a [`ReliabilityDiagram`], and [`Intervals`] for
//! means by group and for paired differences. Of runs held against each other: their goals as [`Lanes`], what they did
//! when as a [`Timeline`], and what they gained as [`Steps`].
//!
//! A chart lays itself out as a [`Drawing`], a list of lines, areas, discs and texts in pixels, and a drawing is written
//! either way. Text is measured once, in the bitmap fonts that the pictures of maps use: a fresh machine needs no fonts
//! of its own for a PNG, and an SVG keeps its text as text, told to be as long as measured, so that nothing
//! overlaps in either. The same chart gives the same bytes.

mod drawing;
mod intervals;
mod lanes;
mod reliability;
mod scale;
mod steps;
mod svg;
mod timeline;

pub(crate) use drawing::Drawing;
pub(crate) use intervals::Intervals;
pub(crate) use lanes::{Lane, Lanes, Link, Stop};
pub(crate) use reliability::ReliabilityDiagram;
pub(crate) use steps::{Curve, Steps};
pub(crate) use timeline::{Course, Timeline};

/// White border around everything, pixels.
const MARGIN: i32 = 18;
/// Space between the parts of a chart, pixels.
const GAP: i32 = 10;
/// Length of a tick, pixels.
const TICK: i32 = 6;
/// Width of what is plotted, pixels.
const PLOT: i32 = 440;
/// Half the width of a whisker, pixels.
const WHISKER: f32 = 1.25;
/// Radius of a dot, pixels.
const DOT: f32 = 5.0;
/// Room between the frame and a mark at the end of an axis, pixels: a dot, its rim, and a gap.
const ROOM: i32 = 9;
/// From the middle of a whisker to the end of its cap, pixels.
const CAP: f32 = 5.0;
