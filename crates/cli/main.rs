//! The `wisdom` command.
fn main() {}
