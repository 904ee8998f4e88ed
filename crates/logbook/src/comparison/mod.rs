//! Runs held against each other, by their logs: what each was told, where they part, what each rule would have done in
//! the other's place, how their goals line up, and what they gained by every measure at hand.
//!
//! ```
//! use wisdom_logbook::comparison::{Alignment, Edit};
//!
//! // Places in the order in which two runs reached them.
//! let lined_up = Alignment::between(&[0, 1, 2, 3], &[1, 2, 0, 4]);
//! assert_eq!(lined_up.edits[0], Edit::Move { from: 0, to: 2, place: 0 });
//! // One move, one place left out, one added.
//! assert_eq!(lined_up.distance(), 3);
//! ```

mod account;
mod align;
mod divergence;
mod inputs;
mod merge;
mod regret;
mod states;

pub use account::{Account, Reached, final_map, observed};
pub use align::{Alignment, Edit};
pub use divergence::{Chosen, Divergence, divergence, partings};
pub use inputs::{FactDifference, FileDifference, Inputs, KeyDifference, ToldDifference, inputs};
pub(crate) use merge::MERGED;
pub use merge::{Merged, merge};
pub use regret::{Measure, RegretMatrix, worth_on};
pub use states::{AtState, AtStates, at_states};
