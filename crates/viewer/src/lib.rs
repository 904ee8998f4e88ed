#![doc = include_str!("../README.md")]

mod page;
mod remade;
mod server;

pub use page::{PAGE, Page, Slot};
pub use remade::{Answer, Asked, Refusal, Remade};
pub use server::{Server, Shown, now_at};
