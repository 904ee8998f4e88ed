//! Whether stated probabilities come true.

use super::{Interval, chi_square_survival, normal_two_sided, wilson};

/// Least expected number, of what happens and of what does not, in a group of the Hosmer-Lemeshow test: below 5, the
/// chi-square distribution is a poor stand-in (Cochran 1954).
const LEAST_EXPECTED: f64 = 5.0;

/// A stated probability, and whether the thing happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// The probability stated before, in [0, 1].
    pub predicted: f64,
    /// Whether it happened.
    pub happened: bool,
}

/// Forecasts of neighbouring probabilities: a point of the reliability diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// The least probability stated in it.
    pub low: f64,
    /// The largest.
    pub high: f64,
    /// How many forecasts it holds, at least one.
    pub count: usize,
    /// In how many of them the thing happened.
    pub happened: usize,
    /// Mean of the probabilities stated.
    pub mean_predicted: f64,
    /// The share in which it happened, with its 95 % interval (Wilson 1927).
    pub observed: Interval,
}

/// Mean squared difference of forecast and outcome, Σ (p − o)²/n (Brier 1950); none without forecasts.
#[must_use]
pub fn brier(forecasts: impl IntoIterator<Item = Forecast>) -> Option<f64> {
    let (count, sum) = forecasts.into_iter().fold((0u32, 0.0), |(count, sum), forecast| {
        let off = forecast.predicted - outcome(&forecast);
        (count + 1, sum + off * off)
    });
    (count > 0).then(|| sum / f64::from(count))
}

/// The Brier score and its parts.
///
/// `score = reliability − resolution + uncertainty + within`. Over bins of one probability each, `within` is 0 and the
/// other three are Murphy's (1973); bins that hold several probabilities need the fourth (Stephenson, Coelho and
/// Jolliffe 2008).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Brier {
    /// Mean squared difference of forecast and outcome, Σ (p − o)²/n (Brier 1950); 0 is best.
    pub score: f64,
    /// What the score is on average if every forecast is true, Σ p(1 − p)/n.
    pub expected: f64,
    /// Mean squared distance of the bins from the diagonal, Σ `n_k` (`p̄_k` − `ō_k`)²/n; 0 is best.
    pub reliability: f64,
    /// How far the bins part the outcomes, Σ `n_k` (`ō_k` − ō)²/n; more is better.
    pub resolution: f64,
    /// Variance of the outcomes, ō(1 − ō): no merit or fault of the forecasts.
    pub uncertainty: f64,
    /// Variance of the forecasts within the bins, less twice their covariance with the outcomes there.
    pub within: f64,
}

/// The Hosmer-Lemeshow test of forecasts that were not fitted to the outcomes they are held against.
///
/// Over groups g of `n_g` forecasts with the mean probability `p̄_g`, of which `o_g` came true, the statistic is
/// `Σ (o_g − n_g·p̄_g)² / (n_g·p̄_g·(1 − p̄_g))`. If the forecasts are true it is about chi-square distributed with as
/// many degrees of freedom as there are groups; the two less of the usual test pay for a fit, and here none was
/// made (Hosmer, Lemeshow and Sturdivant 2013, section 5.2.2). The variance at the mean probability is never less
/// than that of the forecasts, so in wide groups the test errs to the side of not rejecting.
///
/// The groups are the bins; from the lowest up, a bin is joined to the next until the group expects at least 5
/// to happen and 5 not to, and what is left over at the top joins the last group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HosmerLemeshow {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom: the number of groups.
    pub degrees_of_freedom: usize,
    /// Chance of so large a statistic if the forecasts are true.
    pub p: f64,
}

/// Spiegelhalter's test (1986): the Brier score's distance from what it should be, in standard deviations.
///
/// `z = Σ (o − p)(1 − 2p) / √(Σ (1 − 2p)²·p(1 − p))`, about normal if the forecasts are true. It needs no groups. With
/// forecasts above one half, z is positive if they promise too much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spiegelhalter {
    /// The distance, in standard deviations.
    pub z: f64,
    /// Chance of so large a distance, to either side, if the forecasts are true.
    pub p: f64,
}

/// Forecasts held against what happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The forecasts in bins of about equal count, from the lowest probability to the highest.
    pub bins: Vec<Bin>,
    /// How many forecasts there are.
    pub count: usize,
    /// In how many of them the thing happened.
    pub happened: usize,
    /// Mean of the probabilities stated.
    pub mean_predicted: f64,
    /// The Brier score, its parts over the bins, and its expectation.
    pub brier: Brier,
    /// The Hosmer-Lemeshow test; none if all forecasts together expect fewer than 5 to happen, or not to.
    pub hosmer_lemeshow: Option<HosmerLemeshow>,
    /// Spiegelhalter's test; none if every forecast is 0, one half or 1, as the score then cannot vary.
    pub spiegelhalter: Option<Spiegelhalter>,
}

impl Calibration {
    /// Holds forecasts against what happened, in up to `bins` bins.
    ///
    /// The bins cut the forecasts, in order of their probability, at every n/`bins`-th (rounded down). Forecasts of one
    /// probability stay together: a cut between two of them moves to the nearer end of their run, to the lower
    /// end if both are as near. Cuts that meet are one, so there may be fewer bins, and none is empty. The
    /// order in which the forecasts are given does not matter.
    ///
    /// None without forecasts or bins, or if a forecast is no probability.
    #[must_use]
    pub fn of(forecasts: &[Forecast], bins: usize) -> Option<Self> {
        let sound = forecasts.iter().all(|f| (0.0..=1.0).contains(&f.predicted));
        if forecasts.is_empty() || bins == 0 || !sound {
            return None;
        }
        let mut sorted = forecasts.to_vec();
        sorted.sort_unstable_by(|a, b| {
            a.predicted.total_cmp(&b.predicted).then(a.happened.cmp(&b.happened))
        });
        let parts = parts(&sorted, bins);
        let all = Tally::of(&sorted);
        let bins: Vec<Bin> = parts.iter().map(|part| Bin::of(part)).collect::<Option<_>>()?;
        Some(Self {
            brier: Brier::of(&sorted, &parts),
            hosmer_lemeshow: HosmerLemeshow::of(&parts),
            spiegelhalter: Spiegelhalter::of(&sorted),
            bins,
            count: all.count,
            happened: all.happened,
            mean_predicted: all.mean_predicted(),
        })
    }
}

/// Cuts sorted forecasts into bins of about equal count, none of them empty.
fn parts(sorted: &[Forecast], bins: usize) -> Vec<&[Forecast]> {
    let count = sorted.len();
    let bins = bins.min(count);
    let mut parts = Vec::new();
    let mut from = 0;
    for k in 1..=bins {
        let cut = if k == bins { count } else { off_ties(sorted, k * count / bins) };
        if cut > from {
            parts.push(&sorted[from..cut]);
            from = cut;
        }
    }
    parts
}

/// Moves a cut out of a run of equal forecasts, to its nearer end.
fn off_ties(sorted: &[Forecast], cut: usize) -> usize {
    let here = sorted[cut].predicted;
    let start = sorted.partition_point(|f| f.predicted < here);
    let end = sorted.partition_point(|f| f.predicted <= here);
    if cut - start <= end - cut { start } else { end }
}

/// How many forecasts there are, how many came true, and how many were expected to.
#[derive(Clone, Copy)]
struct Tally {
    count: usize,
    happened: usize,
    expected: f64,
}

impl Tally {
    fn of(part: &[Forecast]) -> Self {
        Self {
            count: part.len(),
            happened: part.iter().filter(|f| f.happened).count(),
            expected: sum(part, |f| f.predicted),
        }
    }

    fn with(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            happened: self.happened + other.happened,
            expected: self.expected + other.expected,
        }
    }

    fn mean_predicted(self) -> f64 {
        self.expected / self.count as f64
    }

    fn observed(self) -> f64 {
        self.happened as f64 / self.count as f64
    }

    /// Whether it expects too few of either outcome for the chi-square distribution.
    fn is_small(self) -> bool {
        self.expected < LEAST_EXPECTED || self.count as f64 - self.expected < LEAST_EXPECTED
    }
}

impl Bin {
    fn of(part: &[Forecast]) -> Option<Self> {
        let tally = Tally::of(part);
        Some(Self {
            low: part.first()?.predicted,
            high: part.last()?.predicted,
            count: tally.count,
            happened: tally.happened,
            mean_predicted: tally.mean_predicted(),
            observed: wilson(tally.happened, tally.count)?,
        })
    }
}

impl Brier {
    fn of(all: &[Forecast], parts: &[&[Forecast]]) -> Self {
        let count = all.len() as f64;
        let observed = Tally::of(all).observed();
        let (mut reliability, mut resolution, mut within) = (0.0, 0.0, 0.0);
        for part in parts {
            let tally = Tally::of(part);
            let (p_mean, o_mean) = (tally.mean_predicted(), tally.observed());
            let size = tally.count as f64;
            reliability += size * (p_mean - o_mean) * (p_mean - o_mean);
            resolution += size * (o_mean - observed) * (o_mean - observed);
            within += sum(part, |f| {
                let off = f.predicted - p_mean;
                off * off - 2.0 * off * (outcome(f) - o_mean)
            });
        }
        Self {
            score: sum(all, |f| (f.predicted - outcome(f)) * (f.predicted - outcome(f))) / count,
            expected: sum(all, variance) / count,
            reliability: reliability / count,
            resolution: resolution / count,
            uncertainty: observed * (1.0 - observed),
            within: within / count,
        }
    }
}

impl HosmerLemeshow {
    fn of(parts: &[&[Forecast]]) -> Option<Self> {
        let mut groups: Vec<Tally> = Vec::new();
        for part in parts {
            let tally = Tally::of(part);
            match groups.last_mut() {
                Some(group) if group.is_small() => *group = group.with(tally),
                _ => groups.push(tally),
            }
        }
        if groups.last()?.is_small() {
            let rest = groups.pop()?;
            let last = groups.last_mut()?;
            *last = last.with(rest);
        }
        let statistic = groups.iter().fold(0.0, |sum, group| {
            let off = group.happened as f64 - group.expected;
            sum + off * off / (group.expected * (1.0 - group.mean_predicted()))
        });
        let degrees_of_freedom = groups.len();
        let p = chi_square_survival(statistic, degrees_of_freedom);
        Some(Self { statistic, degrees_of_freedom, p })
    }
}

impl Spiegelhalter {
    fn of(all: &[Forecast]) -> Option<Self> {
        let lean = |f: &Forecast| 1.0 - 2.0 * f.predicted;
        let square = sum(all, |f| lean(f) * lean(f) * variance(f));
        if square <= 0.0 {
            return None;
        }
        let z = sum(all, |f| (outcome(f) - f.predicted) * lean(f)) / libm::sqrt(square);
        Some(Self { z, p: normal_two_sided(z) })
    }
}

fn sum(part: &[Forecast], of: impl Fn(&Forecast) -> f64) -> f64 {
    part.iter().fold(0.0, |sum, f| sum + of(f))
}

fn outcome(forecast: &Forecast) -> f64 {
    f64::from(u8::from(forecast.happened))
}

/// Variance of the outcome, if the forecast is true.
fn variance(forecast: &Forecast) -> f64 {
    forecast.predicted * (1.0 - forecast.predicted)
}
