//! Means with their intervals, a row each.

use wisdom_mission::statistics::Interval;

use crate::figure::axis::number;
use crate::figure::canvas::Area;
use crate::figure::text::{BODY, advance, fit, line_height, wrap};

use super::drawing::{Drawing, Tint, long};
use super::scale::Scale;
use super::{CAP, DOT, GAP, MARGIN, PLOT, ROOM, TICK, WHISKER};

/// Height of a row, pixels.
const ROW: i32 = 30;
/// The longest name of a row, characters.
const LONGEST: usize = 40;

/// Means with intervals: a row each, its name to the left, a dot with whiskers, and the numbers to the right.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Intervals<'a> {
    /// Title.
    pub(crate) title: &'a str,
    /// Remarks under the title, a line each.
    pub(crate) remarks: &'a [String],
    /// What was averaged, with its unit: the axis.
    pub(crate) quantity: &'a str,
    /// Each row's name and interval, from the top.
    pub(crate) rows: &'a [(String, Interval)],
    /// Whether zero is to be on the axis, with a dashed line: for differences.
    pub(crate) zero_line: bool,
    /// Whether the intervals are known: those of a single value are not, and only the mean is drawn.
    pub(crate) whiskers: bool,
}

impl Intervals<'_> {
    /// Lays the chart out.
    pub(crate) fn drawing(&self) -> Drawing {
        let zero = self.zero_line.then_some(0.0);
        let ends = |(_, i): &(String, Interval)| [i.low, i.mean, i.high];
        let scale = Scale::around(self.rows.iter().flat_map(ends).chain(zero), PLOT);
        let scale = scale.with_room(ROOM);
        let names: Vec<String> = self.rows.iter().map(|(name, _)| fit(name, LONGEST)).collect();
        let numbers: Vec<String> = self.rows.iter().map(|(_, i)| self.told(scale, *i)).collect();
        let widest = |texts: &[String]| texts.iter().map(|t| long(BODY, t)).max().unwrap_or(0);

        let left = MARGIN + widest(&names) + GAP;
        // The last number of the axis may reach past the plot even where the rows' numbers do not.
        let beside = (GAP + widest(&numbers)).max(3 * GAP);
        let page = left + PLOT + beside + MARGIN;
        let (mut drawing, top) = Drawing::begin(page, self.title, self.remarks);
        let rows = self.rows.len().max(1) as i32;
        let plot = Area { left, top, width: PLOT, height: ROW * rows };
        let below = plot.bottom() + TICK + 2;
        for tick in scale.ticks_across(0.0) {
            drawing.fill(Area { left: plot.left + tick.at, width: 1, ..plot }, Tint::Grid);
            drawing.tick_below(plot, tick.at);
            drawing.text_below(&tick.text, plot.left + tick.at, below);
        }
        let mut below = below + line_height(BODY) + 4;
        for line in wrap(self.quantity, (PLOT / advance(BODY)) as usize) {
            drawing.text_below(&line, plot.left + PLOT / 2, below);
            below += line_height(BODY);
        }
        drawing.height = below + MARGIN;

        drawing.frame(plot);
        let x = |value: f64| plot.left as f32 + scale.at(value);
        if self.zero_line {
            let ends = [plot.top, plot.bottom()].map(|row| (x(0.0), row as f32));
            drawing.dashed(ends[0], ends[1], 0.75, Tint::Dark);
        }
        for (i, (_, interval)) in self.rows.iter().enumerate() {
            let row = plot.top + ROW * i as i32 + ROW / 2;
            drawing.text_before(&names[i], plot.left - GAP, row);
            drawing.text_after(&numbers[i], plot.right() + GAP, row);
            let y = row as f32;
            if self.whiskers {
                let (low, high) = (x(interval.low), x(interval.high));
                drawing.line((low, y), (high, y), WHISKER, Tint::Data);
                for end in [low, high] {
                    drawing.line((end, y - CAP), (end, y + CAP), WHISKER, Tint::Data);
                }
            }
            drawing.dot((x(interval.mean), y), DOT, Tint::Data);
        }
        drawing
    }

    /// An interval's numbers, as finely as the axis can show them and with the same decimals in every row.
    fn told(&self, scale: Scale, interval: Interval) -> String {
        let step = (scale.high - scale.low) / f64::from(PLOT);
        let largest = scale.high.abs().max(scale.low.abs());
        // A zero has its decimals too.
        let zero = number(step, step, largest).replace(|c: char| c.is_ascii_digit(), "0");
        let number = |value: f64| {
            if value.abs() < step / 2.0 && !zero.contains('e') {
                return zero.clone();
            }
            number(value, step, largest)
        };
        if !self.whiskers {
            return number(interval.mean);
        }
        format!("{} [{}, {}]", number(interval.mean), number(interval.low), number(interval.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Mark;

    fn chart(rows: &[(&str, f64, f64, f64)], zero_line: bool) -> Drawing {
        let rows: Vec<(String, Interval)> = rows
            .iter()
            .map(|&(name, low, mean, high)| (name.to_owned(), Interval { mean, low, high }))
            .collect();
        let (title, quantity) = ("Interest by rule of combination", "interest gained (sites)");
        Intervals { title, remarks: &[], quantity, rows: &rows, zero_line, whiskers: true }
            .drawing()
    }

    #[test]
    fn everything_is_on_the_page_and_no_text_hides_another() {
        let long = "a name that is longer than any name of a group has a right to be";
        chart(&[("dsmc", 4.1, 4.5, 4.9), (long, 3.0, 3.8, 4.4)], false).check();
        chart(&[("one", 5.0, 5.0, 5.0)], false).check();
        chart(&[("far", 1e8, 1.5e8, 2e8), ("farther", 2e8, 3e8, 9e8)], true).check();
        chart(&[("small", -3e-7, -2e-7, 1e-7)], true).check();
        chart(&[], true).check();
    }

    #[test]
    fn differences_have_zero_in_sight() {
        let (dashes, rows) = (2, [("pcr6 - dsmc", 3.0, 3.5, 4.0)]);
        let dashed = |drawing: &Drawing| {
            let several =
                |m: &&Mark| matches!(m, Mark::Lines { pieces, .. } if pieces.len() >= dashes);
            drawing.marks.iter().filter(several).count()
        };
        let (with, without) = (chart(&rows, true), chart(&rows, false));
        assert_eq!((dashed(&with), dashed(&without)), (1, 0));
        assert!(with.texts().contains(&"0") && !without.texts().contains(&"0"));
    }

    #[test]
    fn numbers_are_told_as_finely_as_drawn() {
        let drawing = chart(&[("dsmc", 4.1, 4.5, 4.9)], false);
        assert!(drawing.texts().contains(&"4.500 [4.100, 4.900]"), "{:?}", drawing.texts());
        let drawing = chart(&[("pcr6", -0.25, 0.0, 0.5)], true);
        assert!(drawing.texts().contains(&"0.000 [-0.250, 0.500]"), "{:?}", drawing.texts());
    }

    #[test]
    fn marks_at_the_ends_of_the_axis_lie_inside_the_frame() {
        for (rows, zero_line) in [
            (vec![("a", 4.0, 4.0, 5.0), ("b", 4.5, 5.0, 5.0)], false),
            (vec![("c", 0.0, 0.0, 2.0)], true),
        ] {
            let drawing = chart(&rows, zero_line);
            let frame = drawing.marks.iter().find_map(|mark| match mark {
                Mark::Fill { area, tint: Tint::Dark } if area.width == PLOT => Some(*area),
                _ => None,
            });
            let frame = frame.expect("a frame");
            for mark in &drawing.marks {
                let Mark::Dot { centre, radius, .. } = mark else { continue };
                assert!(centre.0 - radius > frame.left as f32, "{mark:?}");
                assert!(centre.0 + radius < frame.right() as f32, "{mark:?}");
            }
        }
    }
}
