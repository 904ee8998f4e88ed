//! UTIL: Σ prize · freshness − Σ price · resource.

use super::{Objective, Preferences, Prices, Served};

/// A goal is worth less the later after its deadline it is done, and every resource has its price.
pub(super) struct Utility;

impl Objective for Utility {
    fn gain(&self, served: Served) -> f64 {
        served.prize * served.freshness
    }

    fn prices(&self, preferences: &Preferences) -> Prices {
        preferences.prices
    }
}
