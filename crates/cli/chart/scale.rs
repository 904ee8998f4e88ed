//! From values to pixels, and the round numbers between.

use crate::figure::axis::{number, ticks};
use crate::figure::text::{BODY, line_height};

use super::GAP;
use super::drawing::long;

/// An axis: values from `low` to `high` over `length` pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) length: i32,
}

/// A number on an axis: pixels from its low end, and its text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) at: i32,
    pub(super) text: String,
}

impl Scale {
    /// An axis around some values, from one round number to another.
    pub(super) fn around(values: impl Iterator<Item = f64>, length: i32) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if low > high {
            return Self { low: 0.0, high: 1.0, length };
        }
        // Values that are all but one need room to either side of it.
        let least = 1e-6 * low.abs().max(high.abs());
        let room = if high - low > least {
            0.0
        } else if least > 0.0 {
            0.1 * high.abs().max(low.abs())
        } else {
            0.5
        };
        let (low, high) = (low - room, high + room);
        let (step, _) = ticks(low, high, 8, 0.0);
        // A value on a round number is its own end, whatever its last bit.
        let slack = 1e-9;
        let outward = [(low / step + slack).floor(), (high / step - slack).ceil()];
        let [low, high] = outward.map(|end| end * step);
        Self { low, high, length }
    }

    /// An axis from the least to the largest of some shares, a thousandth long at least: finer differences of shares
    /// say nothing.
    pub(super) fn of_shares(values: impl Iterator<Item = f64>, length: i32) -> Self {
        const LEAST: f64 = 1e-3;
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if low > high {
            return Self { low: 0.0, high: 1.0, length };
        }
        let room = (LEAST - (high - low)).max(0.0);
        // No further than the ends of all shares, where the other side gets the rest.
        let low = (low - room / 2.0).clamp(0.0, 1.0 - LEAST);
        Self { low, high: high.max(low + LEAST), length }
    }

    /// The same axis with some pixels more at either end, so that marks on its ends lie inside.
    pub(super) fn with_room(self, pixels: i32) -> Self {
        let inner = f64::from(self.length - 2 * pixels);
        let room = (self.high - self.low) * f64::from(pixels) / inner;
        Self { low: self.low - room, high: self.high + room, ..self }
    }

    /// Pixels from the low end to a value.
    pub(super) fn at(self, value: f64) -> f32 {
        ((value - self.low) / (self.high - self.low) * f64::from(self.length)) as f32
    }

    /// Pixels from the low end to a value, whole and on the axis.
    pub(super) fn column(self, value: f64) -> i32 {
        (self.at(value).round() as i32).clamp(0, self.length - 1)
    }

    /// Round numbers whose texts leave gaps beside each other; `least_step` apart at least.
    pub(super) fn ticks_across(self, least_step: f64) -> Vec<Tick> {
        let apart = |pair: &[Tick]| {
            let needed = i32::midpoint(long(BODY, &pair[0].text), long(BODY, &pair[1].text));
            pair[1].at - pair[0].at >= needed + 2 * GAP
        };
        self.ticks(least_step, apart)
    }

    /// Round numbers whose texts leave gaps above each other; `least_step` apart at least.
    pub(super) fn ticks_up(self, least_step: f64) -> Vec<Tick> {
        self.ticks(least_step, |pair| pair[1].at - pair[0].at >= line_height(BODY) + GAP)
    }

    fn ticks(self, least_step: f64, apart: impl Fn(&[Tick]) -> bool) -> Vec<Tick> {
        let found = |most| {
            let (step, values) = ticks(self.low, self.high, most, least_step);
            let text = |value| number(value, step, self.low.abs().max(self.high.abs()));
            let tick = |value: &f64| Tick { at: self.column(*value), text: text(*value) };
            values.iter().map(tick).collect::<Vec<_>>()
        };
        let fits = |found: &Vec<Tick>| found.windows(2).all(&apart);
        (1..=10).rev().map(found).find(fits).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_ends_on_round_numbers_around_its_values() {
        let scale = Scale::around([0.513, 0.97].into_iter(), 440);
        assert!((scale.low - 0.5).abs() < 1e-12 && (scale.high - 1.0).abs() < 1e-12, "{scale:?}");
        let exact = Scale::around([0.3, 0.9].into_iter(), 440);
        assert!((exact.low - 0.3).abs() < 1e-12 && (exact.high - 0.9).abs() < 1e-12, "{exact:?}");
    }

    #[test]
    fn room_is_as_many_pixels_as_asked_for() {
        let scale = Scale::around([0.3, 0.9].into_iter(), 440).with_room(20);
        assert!((scale.at(0.3) - 20.0).abs() < 1e-3 && (scale.at(0.9) - 420.0).abs() < 1e-3);
    }

    #[test]
    fn an_axis_of_shares_is_as_long_as_its_values_and_never_leaves_0_to_1() {
        let scale = Scale::of_shares([0.963, 0.98, 1.0].into_iter(), 440);
        assert_eq!((scale.low, scale.high), (0.963, 1.0));
        for value in [0.0, 0.3, 1.0] {
            let scale = Scale::of_shares([value].into_iter(), 440);
            assert!(0.0 <= scale.low && scale.low <= value, "{scale:?}");
            assert!(value <= scale.high && scale.high <= 1.0, "{scale:?}");
            assert!((scale.high - scale.low - 1e-3).abs() < 1e-12, "{scale:?}");
        }
    }

    #[test]
    fn an_axis_of_one_value_has_room_on_both_sides() {
        for value in [0.0, 5.0, -2e7, 1e-9] {
            let scale = Scale::around([value].into_iter(), 440);
            assert!(scale.low < value && value < scale.high, "{scale:?}");
            assert!(!scale.ticks_across(0.0).is_empty());
        }
        let none = Scale::around(std::iter::empty(), 440);
        assert_eq!((none.low, none.high), (0.0, 1.0));
    }

    #[test]
    fn counts_have_whole_ticks() {
        let ticks = Scale::around([0.0, 3.0].into_iter(), 90).ticks_up(1.0);
        let texts: Vec<&str> = ticks.iter().map(|tick| tick.text.as_str()).collect();
        assert_eq!(texts, ["0", "1", "2", "3"]);
    }
}
