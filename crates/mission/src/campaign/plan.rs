//! What a campaign varies, and the order of its runs.

use std::fmt;

use wisdom_belief::Rule;
use wisdom_goals::Policy;

use crate::Override;

/// The most runs of one campaign: beyond it a folder with a file a run is no longer handy.
pub const MAX_RUNS: usize = 1_000_000;

/// The largest seed: integers of a mission file have a sign.
pub const MAX_SEED: u64 = i64::MAX as u64;

/// Why a campaign cannot be planned so.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// Nothing was named.
    #[error("no {what}; a campaign needs at least one")]
    Empty {
        /// What there is none of: seeds, rules or policies.
        what: &'static str,
    },
    /// Something was named twice.
    #[error("{what} {value} is given twice; a campaign runs each once")]
    Repeated {
        /// Seed, rule or policy.
        what: &'static str,
        /// Which one.
        value: String,
    },
    /// A seed does not fit a mission file.
    #[error("seed {seed}; expected at most {MAX_SEED}")]
    Seed {
        /// The seed.
        seed: u64,
    },
    /// More runs than a campaign may have.
    #[error(
        "{seeds} seeds x {rules} rules x {policies} policies; expected at most {MAX_RUNS} runs"
    )]
    TooMany {
        /// Number of seeds.
        seeds: usize,
        /// Number of rules.
        rules: usize,
        /// Number of policies.
        policies: usize,
    },
}

/// One rule and one policy: what is compared over the seeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Variant {
    /// The rule of combination.
    pub rule: Rule,
    /// The objective over goal sequences.
    pub policy: Policy,
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.rule, self.policy)
    }
}

/// One run of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Case {
    /// Its place in the campaign, from 0.
    pub index: usize,
    /// Seed of its world.
    pub seed: u64,
    /// How its rover fuses and chooses.
    pub variant: Variant,
}

impl Case {
    /// The changes to the mission that make it this run.
    #[must_use]
    pub fn overrides(&self) -> [Override; 3] {
        let quoted = |name: String| format!("\"{name}\"");
        [
            Override::new("seed", self.seed.to_string()),
            Override::new("rule", quoted(self.variant.rule.to_string())),
            Override::new("policy", quoted(self.variant.policy.to_string())),
        ]
    }
}

/// The runs of a campaign: every seed under every rule and policy.
///
/// Runs are numbered seed by seed, then by rule, then by policy, so that more seeds at the end leave the numbers
/// of the others as they are.
///
/// ```
/// use wisdom_mission::Plan;
///
/// let rules = ["dsmc".parse()?, "pcr6".parse()?];
/// let plan = Plan::new(vec![1, 2, 3], &rules, &["most-interesting".parse()?])?;
/// assert_eq!(plan.len(), 6);
/// let case = plan.case(3).expect("one of six");
/// assert_eq!((case.seed, case.variant.rule.to_string().as_str()), (2, "pcr6"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    seeds: Vec<u64>,
    variants: Vec<Variant>,
}

impl Plan {
    /// A campaign over seeds, rules and policies, each in the order given.
    ///
    /// # Errors
    /// [`CampaignError`] if there is none of something, something is named twice, a seed is above [`MAX_SEED`], or
    /// there are more than [`MAX_RUNS`] runs.
    pub fn new(
        seeds: Vec<u64>,
        rules: &[Rule],
        policies: &[Policy],
    ) -> Result<Self, CampaignError> {
        distinct("seed", "seeds", &seeds)?;
        distinct("rule", "rules", rules)?;
        distinct("policy", "policies", policies)?;
        if let Some(&seed) = seeds.iter().find(|seed| **seed > MAX_SEED) {
            return Err(CampaignError::Seed { seed });
        }
        let runs = seeds.len().saturating_mul(rules.len()).saturating_mul(policies.len());
        if runs > MAX_RUNS {
            return Err(CampaignError::TooMany {
                seeds: seeds.len(),
                rules: rules.len(),
                policies: policies.len(),
            });
        }
        let variants = rules
            .iter()
            .flat_map(|&rule| policies.iter().map(move |&policy| Variant { rule, policy }))
            .collect();
        Ok(Self { seeds, variants })
    }

    /// Number of runs.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a plan has at least one run")]
    pub fn len(&self) -> usize {
        self.seeds.len() * self.variants.len()
    }

    /// The seeds, in order.
    #[must_use]
    pub fn seeds(&self) -> &[u64] {
        &self.seeds
    }

    /// Rules and policies, in order; the first is the one that the others are held against.
    #[must_use]
    pub fn variants(&self) -> &[Variant] {
        &self.variants
    }

    /// The run of a number; none if there are not so many.
    #[must_use]
    pub fn case(&self, index: usize) -> Option<Case> {
        let seed = *self.seeds.get(index / self.variants.len())?;
        Some(Case { index, seed, variant: self.variants[index % self.variants.len()] })
    }

    /// All runs, in order.
    pub fn cases(&self) -> impl Iterator<Item = Case> + '_ {
        (0..self.len()).filter_map(|index| self.case(index))
    }
}

fn distinct<T: PartialEq + Ord + fmt::Display>(
    what: &'static str,
    all: &'static str,
    values: &[T],
) -> Result<(), CampaignError> {
    if values.is_empty() {
        return Err(CampaignError::Empty { what: all });
    }
    let mut sorted: Vec<&T> = values.iter().collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(CampaignError::Repeated { what, value: pair[0].to_string() }),
        None => Ok(()),
    }
}
