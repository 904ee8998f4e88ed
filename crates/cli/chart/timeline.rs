//! What runs did when.

use crate::figure::canvas::Area;
use crate::figure::text::{BODY, fit, line_height};

use super::drawing::{Drawing, Tint, long};
use super::scale::Scale;
use super::{DOT, GAP, MARGIN, PLOT, ROOM, TICK};

/// Width of the plot, pixels.
const WIDTH: i32 = PLOT + 360;
/// Rows of labels above a lane: goals reached soon after each other need more than one.
const LEVELS: usize = 4;
/// From a lane's line to the ends of the strokes of decisions, pixels.
const STROKE: f32 = 9.0;
/// From a lane's line to the upper end of the stroke where runs part, pixels; its lower end is that much above the next lane.
const PARTS: f32 = 10.0;
/// What stands beside that stroke.
const FLAG: &str = "parts";
/// Space below a lane's line, pixels.
const BELOW: i32 = 40;
/// The longest name of a lane, characters.
const LONGEST: usize = 32;

/// What one run did when.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course {
    /// Its name.
    pub(crate) name: String,
    /// When it decided, and whether that changed anything.
    pub(crate) decisions: Vec<(f64, bool)>,
    /// When it reached its goals, and what they are called.
    pub(crate) goals: Vec<(f64, String)>,
    /// When it parted from the first.
    pub(crate) parts: Option<f64>,
    /// When it ended.
    pub(crate) end: f64,
}

/// Courses under each other over one time axis: a stroke a decision (pale where nothing changed), a dot a goal with its
/// name, a long flagged stroke where a run parts from the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timeline<'a> {
    /// Title.
    pub(crate) title: &'a str,
    /// Remarks under the title, a line each.
    pub(crate) remarks: &'a [String],
    /// The axis, with its unit.
    pub(crate) across: &'a str,
    /// The courses, from the top.
    pub(crate) courses: &'a [Course],
}

impl Timeline<'_> {
    /// Lays the chart out.
    pub(crate) fn drawing(&self) -> Drawing {
        let scale = Scale::around(self.courses.iter().map(|c| c.end).chain([0.0]), WIDTH);
        let scale = scale.with_room(ROOM);
        let line = line_height(BODY);
        let names: Vec<String> = self.courses.iter().map(|c| fit(&c.name, LONGEST)).collect();
        let widest = names.iter().map(|name| long(BODY, name)).max().unwrap_or(0);
        let left = MARGIN + widest + GAP;
        let (mut drawing, top) =
            Drawing::begin(left + WIDTH + 3 * MARGIN, self.title, self.remarks);
        let above = LEVELS as i32 * (line + 2) + DOT as i32 + 6;
        let lane = above + BELOW;
        let lanes = self.courses.len().max(1) as i32;
        let plot = Area { left, top, width: WIDTH, height: lanes * lane };
        for tick in scale.ticks_across(0.0) {
            drawing.fill(Area { left: plot.left + tick.at, width: 1, ..plot }, Tint::Grid);
            drawing.tick_below(plot, tick.at);
            drawing.text_below(&tick.text, plot.left + tick.at, plot.bottom() + TICK + 2);
        }
        let below = plot.bottom() + TICK + 2 + line + 4;
        drawing.text_below(self.across, plot.left + WIDTH / 2, below);
        drawing.height = below + line + MARGIN;
        drawing.frame(plot);
        let x = |time: f64| plot.left as f32 + scale.at(time);
        for (place, course) in self.courses.iter().enumerate() {
            let row = plot.top + place as i32 * lane + above;
            let y = row as f32;
            drawing.text_before(&names[place], left - GAP, row);
            drawing.line((x(0.0), y), (x(course.end), y), 1.0, Tint::Run(place));
            for &(time, changed) in &course.decisions {
                let (half, tint) =
                    if changed { (STROKE, Tint::Dark) } else { (0.6 * STROKE, Tint::Muted) };
                drawing.line((x(time), y - half), (x(time), y + half), 0.6, tint);
            }
            if let Some(time) = course.parts {
                let foot = y + BELOW as f32 - 4.0;
                drawing.line((x(time), y - PARTS), (x(time), foot), 1.75, Tint::Dark);
                let (at, flag) = (x(time) as i32, row + BELOW - 4 - line / 2);
                if at + GAP + long(BODY, FLAG) < plot.right() {
                    drawing.text_after(FLAG, at + GAP / 2, flag);
                } else {
                    drawing.text_before(FLAG, at - GAP / 2, flag);
                }
            }
            for (time, _) in &course.goals {
                drawing.dot((x(*time), y), DOT, Tint::Run(place));
            }
            let lowest = row - DOT as i32 - 6 - line;
            label(&mut drawing, plot, &course.goals, lowest, |time| x(time) as i32);
        }
        drawing
    }
}

/// Names above a lane, each on the lowest level where it does not touch the one before; one that finds no room is left
/// out: its dot is there.
fn label(
    drawing: &mut Drawing,
    plot: Area,
    goals: &[(f64, String)],
    lowest: i32,
    x: impl Fn(f64) -> i32,
) {
    let mut free = [i32::MIN; LEVELS];
    for (time, name) in goals {
        let width = long(BODY, name);
        let begin = (x(*time) - width / 2).clamp(plot.left + 2, plot.right() - width - 2);
        let Some(level) = free.iter().position(|&free| free <= begin) else { continue };
        free[level] = begin + width + 4;
        let top = lowest - level as i32 * (line_height(BODY) + 2);
        drawing.text_below(name, begin + width / 2, top);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Mark;

    #[test]
    fn everything_is_on_the_page_and_no_name_hides_another() {
        let course = |name: &str, goals: usize, end: f64| Course {
            name: name.to_owned(),
            decisions: (0..40).map(|n| (f64::from(n) * end / 40.0, n % 3 == 0)).collect(),
            goals: (0..goals).map(|n| (end * (n + 1) as f64 / 30.0, format!("P{n}"))).collect(),
            parts: (goals > 3).then_some(end / 2.0),
            end,
        };
        let courses = [course("dsmc", 30, 9.0), course("pcr6", 2, 4.0), course("none", 0, 0.0)];
        let chart = |courses| Timeline {
            title: "Decisions and goals",
            remarks: &[],
            across: "mission time, h",
            courses,
        };
        let drawing = chart(&courses).drawing();
        drawing.check();
        let dots = drawing.marks.iter().filter(|m| matches!(m, Mark::Dot { .. })).count();
        assert_eq!(dots, 32);
        assert_eq!(drawing.texts().iter().filter(|text| **text == FLAG).count(), 1);
        chart(&[]).drawing().check();
    }
}
