//! A number of ours beside a number of the paper.

use serde_json::{Value, json};

/// What a computed number is held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Against {
    /// A printed number, equal within a tolerance.
    Printed { value: f64, within: f64 },
    /// A limit that must be passed.
    Above(f64),
    /// A limit that must be reached.
    AtLeast(f64),
    /// A limit that must not be reached.
    Below(f64),
    /// A limit that may just be reached.
    AtMost(f64),
    /// Nothing: the number is told for its own sake.
    Nothing,
}

/// A computed number and what it is held against.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Check {
    /// The table, equation or area of the paper, a colon, and what it is.
    pub(super) group: &'static str,
    /// What was computed.
    pub(super) name: String,
    computed: f64,
    against: Against,
    decimals: usize,
}

impl Check {
    /// A number of a group, held against something, to be shown with four decimals.
    pub(super) fn new(
        group: &'static str,
        name: impl Into<String>,
        computed: f64,
        against: Against,
    ) -> Self {
        Self { group, name: name.into(), computed, against, decimals: 4 }
    }

    /// A number held against a printed one.
    pub(super) fn printed(
        group: &'static str,
        name: impl Into<String>,
        computed: f64,
        value: f64,
        within: f64,
    ) -> Self {
        Self::new(group, name, computed, Against::Printed { value, within })
    }

    /// A number of things, held against another.
    pub(super) fn count(
        group: &'static str,
        name: impl Into<String>,
        computed: usize,
        against: Against,
    ) -> Self {
        Self::new(group, name, computed as f64, against).decimals(0)
    }

    /// How many decimals to show.
    pub(super) fn decimals(self, decimals: usize) -> Self {
        Self { decimals, ..self }
    }

    /// Whether it holds; none if it is held against nothing. What cannot be computed (NaN) never holds.
    pub(super) fn passes(&self) -> Option<bool> {
        let computed = self.computed;
        match self.against {
            Against::Printed { value, within } => Some((computed - value).abs() <= within),
            Against::Above(limit) => Some(computed > limit),
            Against::AtLeast(limit) => Some(computed >= limit),
            Against::Below(limit) => Some(computed < limit),
            Against::AtMost(limit) => Some(computed <= limit),
            Against::Nothing => None,
        }
    }

    /// Its row of a table.
    pub(super) fn cells(&self) -> [String; 5] {
        let shown = |value: f64| show(value, self.decimals);
        let (other, within) = match self.against {
            Against::Printed { value, within } => (shown(value), show_tolerance(within)),
            Against::Above(limit) => (format!("> {limit}"), String::new()),
            Against::AtLeast(limit) => (format!(">= {limit}"), String::new()),
            Against::Below(limit) => (format!("< {limit}"), String::new()),
            Against::AtMost(limit) => (format!("<= {limit}"), String::new()),
            Against::Nothing => Default::default(),
        };
        let verdict = match self.passes() {
            Some(true) => "pass",
            Some(false) => "FAIL",
            None => "",
        };
        [self.name.clone(), shown(self.computed), other, within, verdict.to_owned()]
    }

    /// Its row of the JSON object: `printed` and `tolerance`, or `limit` and how the number must lie to it;
    /// `pass` is null if it is held against nothing.
    pub(super) fn json(&self) -> Value {
        let (printed, tolerance, must_be, limit) = match self.against {
            Against::Printed { value, within } => (Some(value), Some(within), "equal", None),
            Against::Above(limit) => (None, None, "above", Some(limit)),
            Against::AtLeast(limit) => (None, None, "at least", Some(limit)),
            Against::Below(limit) => (None, None, "below", Some(limit)),
            Against::AtMost(limit) => (None, None, "at most", Some(limit)),
            Against::Nothing => (None, None, "anything", None),
        };
        let (group, about) = self.group.split_once(": ").unwrap_or((self.group, ""));
        json!({
            "group": group,
            "about": about,
            "name": self.name,
            "computed": self.computed,
            "printed": printed,
            "tolerance": tolerance,
            "limit": limit,
            "must_be": must_be,
            "pass": self.passes(),
        })
    }
}

/// A number with so many decimals; with an exponent if those would show nothing of it.
fn show(value: f64, decimals: usize) -> String {
    let least = 0.5 * 10f64.powi(-(decimals as i32));
    if value != 0.0 && value.abs() < least {
        return format!("{value:.1e}");
    }
    format!("{value:.decimals$}")
}

fn show_tolerance(within: f64) -> String {
    if within == 0.0 { "0".to_owned() } else { format!("{within:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_holds_up_to_its_limit_and_nothing_holds_for_nan() {
        let passes = |computed, against| Check::new("g", "n", computed, against).passes();
        let printed = Against::Printed { value: 1.0, within: 0.25 };
        assert_eq!(passes(1.25, printed), Some(true));
        assert_eq!(passes(1.5, printed), Some(false));
        assert_eq!(passes(1.0, Against::Above(1.0)), Some(false));
        assert_eq!(passes(1.0, Against::AtLeast(1.0)), Some(true));
        assert_eq!(passes(1.0, Against::Below(1.0)), Some(false));
        assert_eq!(passes(1.0, Against::AtMost(1.0)), Some(true));
        assert_eq!(passes(1.0, Against::Nothing), None);
        for against in [
            printed,
            Against::Above(0.0),
            Against::AtLeast(0.0),
            Against::Below(1.0),
            Against::AtMost(1.0),
        ] {
            assert_eq!(passes(f64::NAN, against), Some(false));
        }
    }

    #[test]
    fn a_number_too_small_for_its_decimals_is_shown_with_an_exponent() {
        assert_eq!(show(0.000_1, 4), "0.0001");
        assert_eq!(show(2.5e-17, 4), "2.5e-17");
        assert_eq!(show(0.0, 4), "0.0000");
        assert_eq!(show(0.972_346, 8), "0.97234600");
    }
}
