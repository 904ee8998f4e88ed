//! The reliability diagram: what was stated against what came true (Murphy and Winkler 1977).

use wisdom_mission::statistics::{Bin, Calibration, wilson};

use crate::figure::canvas::Area;
use crate::figure::text::{BODY, line_height};

use super::drawing::{Drawing, RIM, Tint, long};
use super::scale::{Scale, Tick};
use super::{CAP, DOT, GAP, MARGIN, PLOT, ROOM, TICK, WHISKER};

/// Height of the bars' panel, pixels.
const BARS: i32 = 90;
/// The narrowest bar, pixels: forecasts of one probability are a bar too.
const NARROWEST: i32 = 3;

/// A reliability diagram: a dot a bin, its mean forecast across and the share that came true up, with the share's 95 %
/// interval; dots on the dashed line keep their word. Bars below count the forecasts of each bin, over the range
/// of its probabilities.
///
/// Each axis is as long as its data: predictions near 1 would merge on an axis that has room for wide intervals. The
/// axis up holds the dashed line at every dot too. Bins whose dots would touch are drawn as one.
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
        let ends = |bin: &Bin| [bin.low, bin.high];
        let share = Scale::of_shares(bins.iter().flat_map(ends), PLOT).with_room(ROOM);
        let bins = &joined(bins, |bin, next| share.at(next) - share.at(bin) < 2.0 * (DOT + RIM));
        let ends = |bin: &Bin| [bin.observed.low, bin.observed.high, bin.mean_predicted];
        let observed = Scale::of_shares(bins.iter().flat_map(ends), PLOT).with_room(ROOM);
        let most = bins.iter().map(|bin| bin.count).max().unwrap_or(0);
        let count = Scale::around([0.0, most as f64].into_iter(), BARS);
        let (across, up, counts) =
            (share.ticks_across(0.0), observed.ticks_up(0.0), count.ticks_up(1.0));
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

        let at = |x: f64, y: f64| {
            (plot.left as f32 + share.at(x), plot.bottom() as f32 - observed.at(y))
        };
        // Where both axes have it; they do at every dot.
        let (low, high) = (share.low.max(observed.low), share.high.min(observed.high));
        drawing.dashed(at(low, low), at(high, high), 0.75, Tint::Dark);
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

/// Bins from the lowest up, each joined to the one before if their mean forecasts are `near`.
fn joined(bins: &[Bin], near: impl Fn(f64, f64) -> bool) -> Vec<Bin> {
    let mut joined: Vec<Bin> = Vec::with_capacity(bins.len());
    for bin in bins {
        match joined.last_mut() {
            Some(last) if near(last.mean_predicted, bin.mean_predicted) => *last = both(last, bin),
            _ => joined.push(*bin),
        }
    }
    joined
}

/// One bin of two neighbours.
fn both(below: &Bin, above: &Bin) -> Bin {
    let (count, happened) = (below.count + above.count, below.happened + above.happened);
    let sum = |bin: &Bin| bin.mean_predicted * bin.count as f64;
    Bin {
        low: below.low,
        high: above.high,
        count,
        happened,
        mean_predicted: (sum(below) + sum(above)) / count as f64,
        observed: wilson(happened, count).expect("a bin holds a forecast at least"),
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
        let (low, high) = diagonal(&drawing);
        let up = (high.1 - low.1) / (high.0 - low.0);
        let dots = dots(&drawing);
        assert_eq!(dots.len(), 3);
        for (x, y) in dots {
            assert!((y - (low.1 + up * (x - low.0))).abs() < 0.01, "{x} {y}: {low:?} {high:?}");
        }
    }

    #[test]
    fn predictions_near_one_fill_the_frame_and_stay_inside_it() {
        let forecasts: Vec<Forecast> = (0..400)
            .map(|i| Forecast {
                predicted: 0.96 + 1e-4 * f64::from(i),
                happened: i > 199 || i % 20 > 0,
            })
            .collect();
        let drawing = diagram(&forecasts);
        let dots = dots(&drawing);
        let room = ROOM as f32;
        let (first, last) = (dots[0].0, dots[dots.len() - 1].0);
        assert!(dots.len() >= 5 && last - first > 0.8 * PLOT as f32, "{dots:?}");
        let frame = drawing.marks.iter().find_map(|mark| match mark {
            Mark::Fill { area, tint: Tint::Dark } if area.width == PLOT => Some(*area),
            _ => None,
        });
        let frame = frame.expect("the plot's frame");
        let (left, top) = (frame.left as f32, frame.top as f32);
        let inside = |(x, y): (f32, f32), beside: f32, above: f32| {
            (left + beside..=left + PLOT as f32 - beside).contains(&x)
                && (top + above..=top + PLOT as f32 - above).contains(&y)
        };
        for dot in dots {
            assert!(inside(dot, room - 0.01, room - 0.01), "{dot:?}");
        }
        let (mut upper, mut lower) = (f32::INFINITY, 0f32);
        for mark in &drawing.marks {
            let Mark::Lines { pieces, tint: Tint::Data, .. } = mark else { continue };
            for &end in pieces.iter().flat_map(|(a, b)| [a, b]) {
                assert!(inside(end, room - 0.01 - CAP, room - 0.01), "{end:?}");
                (upper, lower) = (upper.min(end.1), lower.max(end.1));
            }
        }
        // The axis up is no longer than the intervals and its room.
        let height = PLOT as f32 - 2.0 * room;
        assert!((lower - upper - height).abs() < 0.1, "{upper} {lower}");
    }

    #[test]
    fn bins_whose_dots_would_touch_are_drawn_as_one_and_lose_no_forecast() {
        let near = |i: u32| if i == 0 { 0.5 } else { 0.99 + 1e-5 * f64::from(i % 100) };
        let forecasts: Vec<Forecast> =
            (0..1000).map(|i| Forecast { predicted: near(i), happened: i % 50 > 0 }).collect();
        let calibration = Calibration::of(&forecasts, 10).expect("forecasts");
        assert!(calibration.bins.len() > 2);
        let touch = |a: f64, b: f64| b - a < 0.01;
        let joined = joined(&calibration.bins, touch);
        assert!(joined.len() < calibration.bins.len());
        assert_eq!(joined.iter().map(|bin| bin.count).sum::<usize>(), 1000);
        assert_eq!(joined.iter().map(|bin| bin.happened).sum::<usize>(), 980);
        let sum: f64 = joined.iter().map(|bin| bin.mean_predicted * bin.count as f64).sum();
        assert!((sum / 1000.0 - calibration.mean_predicted).abs() < 1e-12);
        for pair in joined.windows(2) {
            assert!(
                pair[0].high < pair[1].low
                    && !touch(pair[0].mean_predicted, pair[1].mean_predicted)
            );
        }
        let across: Vec<f32> = dots(&diagram(&forecasts)).iter().map(|dot| dot.0).collect();
        assert!(across.windows(2).all(|pair| pair[1] - pair[0] >= 2.0 * DOT), "{across:?}");
    }

    fn dots(drawing: &Drawing) -> Vec<(f32, f32)> {
        let centre = |mark: &Mark| match mark {
            Mark::Dot { centre, .. } => Some(*centre),
            _ => None,
        };
        drawing.marks.iter().filter_map(centre).collect()
    }

    /// The ends of the dashed line, the lower first.
    fn diagonal(drawing: &Drawing) -> ((f32, f32), (f32, f32)) {
        let dashed = drawing.marks.iter().find_map(|mark| match mark {
            Mark::Lines { pieces, tint: Tint::Dark, .. } => Some(pieces),
            _ => None,
        });
        let pieces = dashed.expect("a dashed line");
        (pieces[0].0, pieces[pieces.len() - 1].1)
    }
}
