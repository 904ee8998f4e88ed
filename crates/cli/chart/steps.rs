//! What runs gained on the way, as steps.

use crate::figure::canvas::Area;
use crate::figure::text::{BODY, fit, line_height};

use super::drawing::{Drawing, Tint, long};
use super::scale::Scale;
use super::{GAP, MARGIN, PLOT, ROOM, TICK};

/// Height of the plot, pixels.
const HEIGHT: i32 = 320;
/// Width of the plot, pixels.
const WIDTH: i32 = PLOT + 160;
/// Half the width of a curve, pixels.
const CURVE: f32 = 1.5;
/// Radius of a dot at a step, pixels.
const STEP: f32 = 4.0;
/// Length of a curve in the legend, pixels.
const SAMPLE: i32 = 28;
/// The longest name in the legend, characters.
const LONGEST: usize = 32;

/// The steps of one run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Its name.
    pub(crate) name: String,
    /// Where it rises, and to what, from left to right.
    pub(crate) steps: Vec<(f64, f64)>,
    /// Where it ends.
    pub(crate) end: f64,
}

/// Curves that rise in steps from nothing: a dot a step, a line between, to where each run ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps<'a> {
    /// Title.
    pub(crate) title: &'a str,
    /// Remarks under the title, a line each.
    pub(crate) remarks: &'a [String],
    /// What goes on, with its unit: the axis across.
    pub(crate) across: &'a str,
    /// What rises: the axis up.
    pub(crate) up: &'a str,
    /// The curves.
    pub(crate) curves: &'a [Curve],
}

impl Steps<'_> {
    /// Lays the chart out.
    pub(crate) fn drawing(&self) -> Drawing {
        let ends =
            |curve: &Curve| curve.steps.iter().map(|s| s.0).chain([curve.end]).collect::<Vec<_>>();
        let across = Scale::around(self.curves.iter().flat_map(ends).chain([0.0]), WIDTH);
        let tops = self.curves.iter().flat_map(|curve| curve.steps.iter().map(|step| step.1));
        let up = Scale::around(tops.chain([0.0]), HEIGHT);
        let (across, up) = (across.with_room(ROOM), up.with_room(ROOM));
        let (columns, rows) = (across.ticks_across(0.0), up.ticks_up(0.0));
        let line = line_height(BODY);
        let numbers = rows.iter().map(|tick| long(BODY, &tick.text)).max().unwrap_or(0);
        let left = MARGIN + line + GAP + numbers + 2 + TICK;
        let names: Vec<String> =
            self.curves.iter().map(|curve| fit(&curve.name, LONGEST)).collect();
        let beside = names.iter().map(|name| long(BODY, name)).max().unwrap_or(0);
        let page = left + WIDTH + 2 * GAP + SAMPLE + GAP + beside + MARGIN;
        let (mut drawing, top) = Drawing::begin(page, self.title, self.remarks);
        let plot = Area { left, top, width: WIDTH, height: HEIGHT };
        for tick in &rows {
            let row = plot.height - 1 - tick.at;
            drawing.fill(Area { top: plot.top + row, height: 1, ..plot }, Tint::Grid);
            drawing.tick_before(plot, row);
            drawing.text_before(&tick.text, plot.left - TICK - 2, plot.top + row);
        }
        for tick in &columns {
            drawing.fill(Area { left: plot.left + tick.at, width: 1, ..plot }, Tint::Grid);
            drawing.tick_below(plot, tick.at);
            drawing.text_below(&tick.text, plot.left + tick.at, plot.bottom() + TICK + 2);
        }
        drawing.text_upright(self.up, MARGIN, plot.top + plot.height / 2);
        let below = plot.bottom() + TICK + 2 + line + 4;
        drawing.text_below(self.across, plot.left + WIDTH / 2, below);
        drawing.height = below + line + MARGIN;
        drawing.frame(plot);
        let at =
            |x: f64, y: f64| (plot.left as f32 + across.at(x), plot.bottom() as f32 - up.at(y));
        for (place, curve) in self.curves.iter().enumerate() {
            let tint = Tint::Run(place);
            let mut from = (0.0, 0.0);
            for &(x, y) in &curve.steps {
                drawing.line(at(from.0, from.1), at(x, from.1), CURVE, tint);
                drawing.line(at(x, from.1), at(x, y), CURVE, tint);
                from = (x, y);
            }
            drawing.line(at(from.0, from.1), at(curve.end, from.1), CURVE, tint);
            for &(x, y) in &curve.steps {
                drawing.dot(at(x, y), STEP, tint);
            }
            let row = plot.top + GAP + place as i32 * (line + 6) + line / 2;
            let sample = (plot.right() + 2 * GAP) as f32;
            let end = (sample + SAMPLE as f32, row as f32);
            drawing.line((sample, row as f32), end, CURVE, tint);
            drawing.dot((sample + SAMPLE as f32 / 2.0, row as f32), STEP, tint);
            drawing.text_after(&names[place], plot.right() + 3 * GAP + SAMPLE, row);
        }
        let legend = plot.top + 2 * GAP + self.curves.len() as i32 * (line + 6);
        drawing.height = drawing.height.max(legend + MARGIN);
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Mark;

    #[test]
    fn everything_is_on_the_page_and_every_step_has_a_dot() {
        let curve = |name: &str, steps: &[(f64, f64)], end| Curve {
            name: name.to_owned(),
            steps: steps.to_vec(),
            end,
        };
        let curves = [
            curve("dsmc", &[(1.0, 0.9), (2.5, 1.8), (8.0, 2.6)], 9.0),
            curve("a name that is longer than there is any need for", &[(4.0, 0.5)], 7.0),
            curve("nothing", &[], 3.0),
        ];
        let chart = |curves| Steps {
            title: "Interest gained over mission time",
            remarks: &[],
            across: "mission time, h",
            up: "interest on the ruler",
            curves,
        };
        let drawing = chart(&curves).drawing();
        drawing.check();
        let dots = drawing.marks.iter().filter(|m| matches!(m, Mark::Dot { .. })).count();
        // One a step, and one a name in the legend.
        assert_eq!(dots, 4 + 3);
        chart(&curves[2..]).drawing().check();
        chart(&[]).drawing().check();
    }
}
