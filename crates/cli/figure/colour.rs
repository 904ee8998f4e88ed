//! How values become colours.

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};

pub(super) const WHITE: Rgb888 = Rgb888::new(255, 255, 255);

pub(crate) const DARK: Rgb888 = Rgb888::new(24, 24, 28);

/// Greys of the first and the last class of [`ColourMap::Shades`].
const DARKEST_CLASS: f64 = 64.0;
const LIGHTEST_CLASS: f64 = 236.0;
pub(super) const UNKNOWN: Rgb888 = Rgb888::new(226, 226, 226);

pub(super) const UNKNOWN_STRIPE: Rgb888 = Rgb888::new(192, 192, 192);

/// How values become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum ColourMap {
    /// Dark violet to yellow, even in lightness (van der Walt and Smith, 2015).
    Viridis,
    /// Dark blue to yellow, alike for readers with and without colour vision deficiency (Nuñez et al., 2018).
    Cividis,
    /// Black to white.
    Grey,
    /// Blue over white to red; centred on zero unless a range is given.
    Diverging,
    /// Pale sand to dark brown, even in lightness (Harrower and Brewer, 2003): low ground stays light enough for
    /// shadows to show.
    Sand,
    /// That many classes, 0 to n − 1, each with a colour of its own and a name in the legend.
    Classes(usize),
    /// That many classes, 0 to n − 1, in greys from dark to light, each with a name in the legend.
    Shades(usize),
}

impl ColourMap {
    /// How many classes there are, if the values are classes.
    pub(super) fn classes(self) -> Option<usize> {
        match self {
            Self::Classes(n) | Self::Shades(n) => Some(n),
            _ => None,
        }
    }

    /// The colour of a value that lies the share `t` of the way from the low to the high end of the colours; classes
    /// go by the value, all others by the share.
    pub(super) fn colour(self, value: f64, t: f64) -> Rgb888 {
        let t = t.clamp(0.0, 1.0);
        let colour = match self {
            Self::Viridis => colorous::VIRIDIS.eval_continuous(t),
            Self::Cividis => colorous::CIVIDIS.eval_continuous(t),
            Self::Grey => colorous::GREYS.eval_continuous(1.0 - t),
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - t),
            // Without the ends of the scheme: its white is the paper's, its last brown nearly black.
            Self::Sand => colorous::YELLOW_ORANGE_BROWN.eval_continuous(0.08 + 0.84 * t),
            Self::Classes(n) => class_colour(value.round() as usize, n),
            Self::Shades(n) => {
                let t = value.round() / n.saturating_sub(1).max(1) as f64;
                let level = DARKEST_CLASS + t.clamp(0.0, 1.0) * (LIGHTEST_CLASS - DARKEST_CLASS);
                return Rgb888::new(level as u8, level as u8, level as u8);
            }
        };
        Rgb888::new(colour.r, colour.g, colour.b)
    }
}

/// Colours of tracks and markers that readers with colour vision deficiency can tell apart (Okabe and Ito, 2008),
/// with white and black.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(dead_code, reason = "a set of choices; no command needs every one")]
pub(crate) enum Ink {
    /// Orange.
    Orange,
    /// Light blue.
    SkyBlue,
    /// Bluish green.
    Green,
    /// Yellow.
    Yellow,
    /// Blue.
    Blue,
    /// Red leaning to orange.
    Vermilion,
    /// Reddish purple.
    Purple,
    /// White.
    White,
    /// Black.
    Black,
}

impl Ink {
    pub(crate) fn rgb(self) -> Rgb888 {
        match self {
            Self::Orange => Rgb888::new(230, 159, 0),
            Self::SkyBlue => Rgb888::new(86, 180, 233),
            Self::Green => Rgb888::new(0, 158, 115),
            Self::Yellow => Rgb888::new(240, 228, 66),
            Self::Blue => Rgb888::new(0, 114, 178),
            Self::Vermilion => Rgb888::new(213, 94, 0),
            Self::Purple => Rgb888::new(204, 121, 167),
            Self::White => WHITE,
            Self::Black => DARK,
        }
    }

    /// The colour of the rim that sets this one off from any ground.
    pub(super) fn rim(self) -> Rgb888 {
        match self {
            Self::Black | Self::Blue => WHITE,
            _ => DARK,
        }
    }
}

/// The ends of the colours, and whether values lie beyond them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) under: bool,
    pub(super) over: bool,
}

/// The colour of a class: as unlike as `n` colours can be.
fn class_colour(class: usize, n: usize) -> colorous::Color {
    match n {
        0..=10 => colorous::TABLEAU10[class],
        11..=12 => colorous::PAIRED[class],
        _ => colorous::TURBO.eval_rational(class, n),
    }
}

/// A colour under a light: full at 1, at two fifths in full shadow, so that its value can still be read.
pub(super) fn lit(colour: Rgb888, shade: f32) -> Rgb888 {
    let kept = 0.4 + 0.6 * if shade.is_finite() { shade.clamp(0.0, 1.0) } else { 1.0 };
    let dim = |channel: u8| (f32::from(channel) * kept).round() as u8;
    Rgb888::new(dim(colour.r()), dim(colour.g()), dim(colour.b()))
}

/// The pattern of what is not known.
pub(super) fn hatch(x: i32, y: i32) -> Rgb888 {
    if (x + y).rem_euclid(9) < 2 { UNKNOWN_STRIPE } else { UNKNOWN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_go_from_dark_to_light_and_sand_from_light_to_dark() {
        let grey = |n: usize, class: usize| ColourMap::Shades(n).colour(class as f64, 0.0);
        for n in 2..6 {
            assert!((1..n).all(|class| luma(grey(n, class - 1)) < luma(grey(n, class))));
        }
        assert_eq!(grey(2, 0), grey(5, 0));
        assert_eq!(grey(2, 1), grey(5, 4));
        let sand: Vec<_> =
            (0..=20).map(|i| ColourMap::Sand.colour(0.0, f64::from(i) / 20.0)).collect();
        assert!(sand.windows(2).all(|pair| luma(pair[0]) > luma(pair[1])));
    }

    fn luma(colour: Rgb888) -> u32 {
        299 * u32::from(colour.r()) + 587 * u32::from(colour.g()) + 114 * u32::from(colour.b())
    }
}
