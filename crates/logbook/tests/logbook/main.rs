//! What a log promises: what goes in comes out, a broken file says so, and differences are named.

#![allow(clippy::unwrap_used, reason = "test code: a failed step is a failed test")]

mod compare;
mod comparison;
mod damage;
mod indexed;
mod recover;
mod round_trip;
mod story;
mod viewers;
