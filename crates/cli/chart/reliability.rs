//! The reliability diagram: what was stated against what came true (Murphy and Winkler 1977).

use wisdom_mission::statistics::{Bin, Calibration};

use crate::figure::canvas::Area;
use crate::figure::text::{BODY, line_height};

use super::drawing::{Drawing, Tint, long};
use super::scale::{Scale, Tick};
use super::{CAP, DOT, GAP, MARGIN, PLOT, TICK, WHISKER};

/// Height of the bars' panel, pixels.
const BARS: i32 = 90;
/// The narrowest bar, pixels: forecasts of one probability are a bar too.
const NARROWEST: i32 = 3;

/// A reliability diagram: a dot a bin, its mean forecast across and the share that came true up, with the share's 95 %
/// interval; dots on the dashed diagonal keep their word. Bars below count the forecasts of each bin, over the range
/// of its probabilities.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReliabilityDiagram<'a> {
    /// Title.
    pub(crate) title: &'a str,
    /// Remarks under the title, a line each.
    pub(crate) remarks: &'a [String],
    /// What was forecast: the axis across.
    pub(crate) predicted: &'a str,
    /// What came true: the axis up.
    pub(crate) observed: &'a str,
    /// What was counted: the bars' axis.
    pub(crate) counted: &'a str,
    /// Forecasts and what came of them.
    pub(crate) calibration: &'a Calibration,
}

impl ReliabilityDiagram<'_> {
    /// Lays the diagram out.
    pub(crate) fn drawing(&self) -> Drawing {
        let bins = &self.calibration.bins;
        let ends = |bin: &Bin| [bin.low, bin.high, bin.observed.low, bin.observed.high];
        // One range on both axes, so that the diagonal is one.
        let share = Scale::around(bins.iter().flat_map(ends), PLOT).within(0.0, 1.0);
        let most = bins.iter().map(|bin| bin.count).max().unwrap_or(0);
        let count = Scale::around([0.0, most as f64].into_iter(), BARS);
        let (across, up, counts) =
            (share.ticks_across(0.0), share.ticks_up(0.0), count.ticks_up(1.0));
        let numbers = up.iter().chain(&counts).map(|tick| long(BODY, &tick.text)).max();

        let line = line_height(BODY);
        let left = MARGIN + line + GAP + numbers.unwrap_or(0) + 2 + TICK;
        let page = left + PLOT + 2 * MARGIN;
        let (mut drawing, top) = Drawing::begin(page, self.title, self.remarks);
        let plot = Area { left, top, width: PLOT, height: PLOT };
        let bars = Area { top: plot.bottom() + 2 * GAP, height: BARS, ..plot };
        for area in [plot, bars] {
            for tick in &across {
                let line = Area { left: area.left + tick.at, width: 1, ..area };
                drawing.fill(line, Tint::Grid);
            }
        }
        label_rows(&mut drawing, plot, &up, self.observed);
        label_rows(&mut drawing, bars, &counts, self.counted);
        for tick in &across {
            drawing.tick_below(bars, tick.at);
            let below = bars.bottom() + TICK + 2;
            drawing.text_below(&tick.text, bars.left + tick.at, below);
        }
        let below = bars.bottom() + TICK + 2 + line + 4;
        drawing.text_below(self.predicted, bars.left + PLOT / 2, below);
        drawing.height = below + line + MARGIN;

        let at =
            |x: f64, y: f64| (plot.left as f32 + share.at(x), plot.bottom() as f32 - share.at(y));
        drawing.dashed(at(share.low, share.low), at(share.high, share.high), 0.75, Tint::Dark);
        for bin in bins {
            draw_bar(&mut drawing, bars, share, count, bin);
        }
        drawing.frame(plot);
        drawing.frame(bars);
        for bin in bins {
            let (low, high) = (
                at(bin.mean_predicted, bin.observed.low),
                at(bin.mean_predicted, bin.observed.high),
            );
            drawing.line(low, high, WHISKER, Tint::Data);
            for (x, y) in [low, high] {
                drawing.line((x - CAP, y), (x + CAP, y), WHISKER, Tint::Data);
            }
        }
        for bin in bins {
            drawing.dot(at(bin.mean_predicted, bin.observed.mean), DOT, Tint::Data);
        }
        drawing
    }
}

/// Numbers to the left of an area, lines across it, and the axis' name.
fn label_rows(drawing: &mut Drawing, area: Area, ticks: &[Tick], name: &str) {
    for tick in ticks {
        let row = area.height - 1 - tick.at;
        drawing.fill(Area { top: area.top + row, height: 1, ..area }, Tint::Grid);
        drawing.tick_before(area, row);
        drawing.text_before(&tick.text, area.left - TICK - 2, area.top + row);
    }
    drawing.text_upright(name, MARGIN, area.top + area.height / 2);
}

fn draw_bar(drawing: &mut Drawing, bars: Area, share: Scale, count: Scale, bin: &Bin) {
    let [low, high] = [bin.low, bin.high].map(|end| share.column(end));
    // A pixel's gap between neighbours, where there is room for it.
    let width = (high - low - 1).max(NARROWEST);
    let left = i32::midpoint(low, high) - width / 2;
    let left = left.clamp(0, bars.width - width);
    let height = count.column(bin.count as f64) + 1;
    let top = bars.bottom() - height;
    drawing.fill(Area { left: bars.left + left, top, width, height }, Tint::Pale);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Mark;
    use wisdom_mission::statistics::Forecast;

    fn diagram(forecasts: &[Forecast]) -> Drawing {
        let calibration = Calibration::of(forecasts, 10).expect("forecasts");
        let remarks = ["One remark.".to_owned(), "Another, ".repeat(30)];
        ReliabilityDiagram {
            title: "Legs of a mission, as stated and as driven",
            remarks: &remarks,
            predicted: "predicted reliability",
            observed: "share that arrived",
            counted: "legs",
            calibration: &calibration,
        }
        .drawing()
    }

    fn spread(count: u32) -> Vec<Forecast> {
        let share = |i: u32| f64::from(i) / f64::from(count);
        (0..count).map(|i| Forecast { predicted: share(i), happened: i % 3 > 0 }).collect()
    }

    #[test]
    fn everything_is_on_the_page_and_no_text_hides_another() {
        diagram(&spread(1000)).check();
        diagram(&spread(1)).check();
        let one = |predicted, happened| vec![Forecast { predicted, happened }; 70_000];
        for forecasts in [one(1.0, true), one(0.0, false), one(0.731, false), one(1.0, false)] {
            diagram(&forecasts).check();
        }
    }

    #[test]
    fn there_is_a_dot_and_a_bar_a_bin() {
        let drawing = diagram(&spread(1000));
        let dots = drawing.marks.iter().filter(|mark| matches!(mark, Mark::Dot { .. })).count();
        let bar = |mark: &&Mark| matches!(mark, Mark::Fill { tint: Tint::Pale, .. });
        assert_eq!((dots, drawing.marks.iter().filter(bar).count()), (10, 10));
        assert!(drawing.texts().contains(&"share that arrived"));
    }

    #[test]
    fn forecasts_that_keep_their_word_lie_on_the_diagonal() {
        let forecasts: Vec<Forecast> = [0.25, 0.5, 0.75]
            .into_iter()
            .flat_map(|predicted: f64| {
                let happened = move |i: u32| f64::from(i) < 100.0 * predicted;
                (0..100).map(move |i| Forecast { predicted, happened: happened(i) })
            })
            .collect();
        let drawing = diagram(&forecasts);
        let dots: Vec<(f32, f32)> = drawing
            .marks
            .iter()
            .filter_map(
                |mark| if let Mark::Dot { centre, .. } = mark { Some(*centre) } else { None },
            )
            .collect();
        for pair in dots.windows(2) {
            let (across, up) = (pair[1].0 - pair[0].0, pair[0].1 - pair[1].1);
            assert!(across > 50.0 && (across - up).abs() < 0.01, "{dots:?}");
        }
    }
}
