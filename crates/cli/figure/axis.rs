//! Axes: round numbers and where they stand.

use wisdom_grid::GridSpec;

use super::GAP;
use super::colour::Span;
use super::text::{BODY, line_height, width};

/// How the axes count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Axes {
    /// Metres (kilometres above 10 km) east and north of the map's outer south-west corner.
    Metres,
    /// Cells, x to the east and y to the north, both counted from 1 at the south-west cell, as the paper does.
    Counted,
}

/// A number on an axis: pixels from the start of the axis, and its text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) at: i32,
    pub(super) text: String,
}

impl Axes {
    /// Labels of the axes to the east and to the north.
    pub(super) fn labels(self, spec: GridSpec) -> (&'static str, &'static str) {
        match self {
            Self::Metres if metric_unit(spec).0 > 1.0 => ("x east (km)", "y north (km)"),
            Self::Metres => ("x east (m)", "y north (m)"),
            Self::Counted => ("x (cells)", "y (cells)"),
        }
    }

    /// Round numbers on an axis of `cells` cells, few enough to please `fits`: how far each stands from the west or
    /// south end in cells, and its text.
    pub(super) fn ticks<T>(
        self,
        spec: GridSpec,
        cells: usize,
        place: impl Fn(f64, String) -> T,
        fits: impl Fn(&[T]) -> bool,
    ) -> Vec<T> {
        let long = cells as f64;
        let unit = metric_unit(spec).1;
        let (low, high, least_step) = match self {
            Self::Metres => (0.0, long * unit, 0.0),
            Self::Counted => (1.0, long, 1.0),
        };
        let at = |value: f64| match self {
            Self::Metres => value / unit,
            Self::Counted => value - 0.5,
        };
        let ticks = |most| {
            let (step, values) = ticks(low, high, most, least_step);
            let text = |value| number(value, step, low.abs().max(high.abs()));
            values.iter().map(|&value| place(at(value), text(value))).collect::<Vec<_>>()
        };
        (1..=10).rev().map(ticks).find(|found| fits(found)).unwrap_or_default()
    }
}

/// Metres in a unit of the metric axes, and units in a cell.
fn metric_unit(spec: GridSpec) -> (f64, f64) {
    let long_m = spec.rows().max(spec.cols()) as f64 * spec.spacing_m();
    let unit = if long_m > 10_000.0 { 1000.0 } else { 1.0 };
    (unit, spec.spacing_m() / unit)
}

impl Tick {
    pub(super) fn text(&self) -> &str {
        &self.text
    }
}

/// At most `most` + 1 round numbers (1, 2 or 5 times a power of ten apart) from `low` to `high`, and their step.
pub(crate) fn ticks(low: f64, high: f64, most: usize, least_step: f64) -> (f64, Vec<f64>) {
    let raw = ((high - low) / most as f64).max(least_step);
    if raw <= 0.0 {
        return (1.0, vec![low]);
    }
    // Room for the rounding of a division: 0.3 / 0.1 is not quite 3.
    let slack = 1e-9;
    let decade = 10f64.powf((raw.log10() + slack).floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * decade)
        .into_iter()
        .find(|step| *step >= raw * (1.0 - slack))
        .unwrap_or(10.0 * decade);
    let (first, last) = ((low / step - slack).ceil() as i64, (high / step + slack).floor() as i64);
    (step, (first..=last).map(|i| i as f64 * step).collect())
}

/// A tick's number, with the decimals that its step needs; `largest` is the largest number on the axis.
pub(crate) fn number(value: f64, step: f64, largest: f64) -> String {
    let places = |x: f64| (x.abs().log10() + 1e-9).floor() as i32;
    if value.abs() < step / 2.0 {
        return "0".to_owned();
    }
    if largest >= 1e7 || step < 1e-5 {
        let digits = (places(value) - places(step)).clamp(0, 12) as usize;
        return format!("{value:.digits$e}");
    }
    let decimals = (-places(step)).max(0) as usize;
    format!("{value:.decimals$}")
}

/// Ticks of a colour bar, from its low end.
pub(super) fn value_ticks(span: Span, height: i32) -> Vec<Tick> {
    let most = (height / 35).clamp(3, 10) as usize;
    let (step, values) = ticks(span.low, span.high, most, 0.0);
    let largest = span.low.abs().max(span.high.abs());
    let share = |value: f64| ((value - span.low) / (span.high - span.low)).clamp(0.0, 1.0);
    let tick = |value: &f64| Tick {
        at: (share(*value) * f64::from(height)) as i32,
        text: number(*value, step, largest),
    };
    values.iter().map(tick).collect()
}

/// Ticks counted from the top instead of from the bottom, on the last pixel rather than past it.
pub(super) fn flipped(ticks: Vec<Tick>, height: i32) -> Vec<Tick> {
    ticks.into_iter().map(|tick| Tick { at: (height - tick.at).min(height - 1), ..tick }).collect()
}

/// Whether numbers beside each other leave a gap.
pub(super) fn apart_across(ticks: &[Tick]) -> bool {
    ticks.windows(2).all(|pair| {
        let needed =
            i32::midpoint(width(BODY, &pair[0].text), width(BODY, &pair[1].text)) + 2 * GAP;
        pair[1].at - pair[0].at >= needed
    })
}

/// Whether numbers above each other leave a gap.
pub(super) fn apart_down(ticks: &[Tick]) -> bool {
    ticks.windows(2).all(|pair| pair[1].at - pair[0].at >= line_height(BODY) + 2 * GAP)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let ends = [(0.0, 348.0), (-4523.4, -4448.1), (0.488, 1.0), (1.0, 101.0), (-1e-7, 3e-7)];
        for ((low, high), most) in ends.into_iter().flat_map(|e| (1..=10).map(move |m| (e, m))) {
            let (step, values) = ticks(low, high, most, 0.0);
            let lead = step / 10f64.powf(step.log10().floor());
            assert!([1.0, 2.0, 5.0, 10.0].iter().any(|n| (lead - n).abs() < 1e-6), "{step}");
            assert!(values.len() <= most + 1, "{low} to {high}: {values:?}");
            for value in values {
                assert!(value >= low - step * 1e-6 && value <= high + step * 1e-6, "{value}");
                assert!((value / step - (value / step).round()).abs() < 1e-6, "{value}");
            }
        }
    }

    #[test]
    fn ten_steps_show_the_range_from_end_to_end() {
        let (step, values) = ticks(0.0, 1.0, 10, 0.0);
        let texts: Vec<_> = values.iter().map(|&value| number(value, step, 1.0)).collect();
        let all = ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1.0"];
        assert_eq!(texts, all);
    }

    #[test]
    fn numbers_too_large_or_small_to_read_are_written_with_an_exponent() {
        assert_eq!(number(2.5e8, 5e7, 3e8), "2.5e8");
        assert_eq!(number(-3e-7, 1e-7, 4e-7), "-3e-7");
        assert_eq!(number(-1e-17, 0.1, 1.0), "0");
    }
}
