//! What a cell of the interest map is worth to a goal.

use std::fmt;
use std::str::FromStr;

use wisdom_grid::Raster;

/// How interest becomes a prize.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[non_exhaustive]
pub enum PrizeScale {
    /// The interest itself, as in the paper. Summed over goals: at least so many interesting ones may be
    /// expected.
    Belief,
    /// How far a place stands out: `max(0, (interest − b) / (1 − b))`, where b is the background, the median of the
    /// interest of all ground seen.
    /// On real ground half of the map lies above 0.95 and interest itself cannot choose.
    #[default]
    Contrast,
    /// `−ln(1 − interest)`, which adds up over independent experts, as a share of what it is where 1 − interest is 2⁻²⁰:
    /// it still tells places apart that all look certain.
    WeightOfEvidence,
    /// The share of the ground seen that is less interesting, half of what is equally so counted with it.
    Rank,
}

impl PrizeScale {
    /// Every scale, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Belief, Self::Contrast, Self::WeightOfEvidence, Self::Rank];
}

impl fmt::Display for PrizeScale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Belief => "belief",
            Self::Contrast => "contrast",
            Self::WeightOfEvidence => "weight-of-evidence",
            Self::Rank => "rank",
        })
    }
}

/// A name that is no prize scale.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a prize; expected `belief`, `contrast`, `weight-of-evidence` or `rank`")]
pub struct UnknownPrize(pub String);

impl FromStr for PrizeScale {
    type Err = UnknownPrize;

    fn from_str(name: &str) -> Result<Self, UnknownPrize> {
        Self::ALL
            .into_iter()
            .find(|s| s.to_string() == name)
            .ok_or_else(|| UnknownPrize(name.to_owned()))
    }
}

/// The prize of every cell, and what it is measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct PrizeMap {
    /// Prize of each cell in [0, 1]; 0 where nothing was seen.
    pub prize: Raster<f32>,
    /// The median interest over seen ground (logged; used by [`PrizeScale::Contrast`]).
    pub background: f64,
    scale: PrizeScale,
    /// Interest of all ground seen, ascending; for [`PrizeScale::Rank`] only.
    seen: Vec<f32>,
}

impl PrizeMap {
    /// What this interest is worth where the ground is as on this map.
    #[must_use]
    pub fn of(&self, interest: f32) -> f32 {
        /// 1 − interest below this counts as this: the step of an `f32` near 1 is not far below.
        const DOUBT: f64 = 1.0 / 1_048_576.0;
        let (b, background) = (f64::from(interest), self.background);
        match self.scale {
            PrizeScale::Belief => interest,
            PrizeScale::Contrast if background >= 1.0 => 0.0,
            PrizeScale::Contrast => ((b - background) / (1.0 - background)).max(0.0) as f32,
            PrizeScale::WeightOfEvidence => {
                (libm::log((1.0 - b).max(DOUBT)) / libm::log(DOUBT)).max(0.0) as f32
            }
            // Without evidence for it, no place has a rank.
            PrizeScale::Rank if interest <= 0.0 || self.seen.is_empty() => 0.0,
            PrizeScale::Rank => {
                let below = self.seen.partition_point(|other| *other < interest);
                let up_to = self.seen.partition_point(|other| *other <= interest);
                ((below + up_to) as f64 / (2 * self.seen.len()) as f64) as f32
            }
        }
    }
}

/// Turns interest into prizes. Ground is seen where its ignorance is below one.
#[must_use]
pub fn prize_map(interest: &Raster<f32>, ignorance: &Raster<f32>, scale: PrizeScale) -> PrizeMap {
    let mut seen: Vec<f32> = interest
        .values()
        .iter()
        .zip(ignorance.values())
        .filter(|(_, u)| **u < 1.0)
        .map(|(b, _)| *b)
        .collect();
    let background = if seen.is_empty() {
        0.0
    } else {
        let middle = seen.len() / 2;
        f64::from(*seen.select_nth_unstable_by(middle, f32::total_cmp).1)
    };
    if scale == PrizeScale::Rank {
        seen.sort_unstable_by(f32::total_cmp);
    } else {
        seen = Vec::new();
    }
    let mut map = PrizeMap { prize: interest.clone(), background, scale, seen };
    if scale != PrizeScale::Belief {
        map.prize = interest.map(|&b| map.of(b));
    }
    map
}

/// A prize on the ladder of 2⁻³²: sums of such numbers are exact, so that equal sets have equal sums in
/// whatever order they are added.
#[must_use]
pub fn quantised(prize: f64) -> f64 {
    (prize * STEPS_PER_UNIT).round() / STEPS_PER_UNIT
}

/// The numbers that sums of some prizes can be: multiples of the largest step that all of them are multiples of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ladder {
    step: f64,
}

impl Ladder {
    /// The ladder of these prizes, if all of them are quantised and not all are zero.
    pub(crate) fn of(prizes: impl Iterator<Item = f64>) -> Option<Self> {
        // Of larger prizes the sums would no longer be exact.
        const MOST: f64 = 1_048_576.0;
        let mut steps = 0u64;
        for prize in prizes {
            if prize != quantised(prize) || !(0.0..=MOST).contains(&prize) {
                return None;
            }
            let (mut a, mut b) = ((prize * STEPS_PER_UNIT) as u64, steps);
            while b != 0 {
                (a, b) = (b, a % b);
            }
            steps = a;
        }
        (steps > 0).then(|| Self { step: steps as f64 / STEPS_PER_UNIT })
    }

    /// The highest step that is not above a number.
    pub(crate) fn below(self, number: f64) -> f64 {
        (number / self.step).floor() * self.step
    }
}

const STEPS_PER_UNIT: f64 = 4_294_967_296.0;

#[cfg(test)]
mod tests {
    use wisdom_grid::GridSpec;

    use super::*;

    #[test]
    fn contrast_is_zero_at_the_median_of_seen_ground_and_one_at_certainty() {
        let spec = GridSpec::new(1, 5, 1.0).unwrap();
        let interest = Raster::from_vec(spec, vec![0.0, 0.4, 0.5, 0.75, 1.0]).unwrap();
        let ignorance = Raster::from_vec(spec, vec![1.0, 0.1, 0.1, 0.1, 0.1]).unwrap();
        let map = prize_map(&interest, &ignorance, PrizeScale::Contrast);
        assert_eq!(map.background, 0.75);
        assert_eq!(map.prize.values(), [0.0, 0.0, 0.0, 0.0, 1.0]);
        let plain = prize_map(&interest, &ignorance, PrizeScale::Belief);
        assert_eq!(plain.prize, interest);
    }

    #[test]
    fn a_map_that_is_interesting_everywhere_stands_out_nowhere() {
        let spec = GridSpec::new(1, 2, 1.0).unwrap();
        let map =
            prize_map(&Raster::filled(spec, 1.0), &Raster::filled(spec, 0.0), PrizeScale::Contrast);
        assert_eq!(map.prize.values(), [0.0, 0.0]);
    }

    #[test]
    fn quantised_prizes_add_up_alike_in_any_order() {
        let prizes = [0.1, 0.7, 0.3, 0.23].map(quantised);
        let forward: f64 = prizes.iter().sum();
        let backward: f64 = prizes.iter().rev().sum();
        assert_eq!(forward, backward);
    }
}
