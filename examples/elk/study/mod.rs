//! What is asked of the mission at Marias Pass: whether one reading changes its mind, and how its map lies against
//! where Curiosity's team truly went.

pub(crate) mod auc;
pub(crate) mod fate;
pub(crate) mod known;
pub(crate) mod lie;
pub(crate) mod places;
pub(crate) mod sweep;
