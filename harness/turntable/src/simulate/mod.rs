//! A controller of a table, simulated: the command language of a [`crate::Dialect`], with the plant's gimbals
//! behind it.
//!
//! It answers as a controller does, refuses what one refuses, has limits of its own and a watchdog that
//! stops the table when it isn't fed. On demand it misbehaves: it says nothing, or nonsense, or
//! hangs up. [`Server`] puts it on a TCP port or a pseudo-terminal.

mod controller;
mod listen;
mod server;

pub use controller::{Behaviour, Controller};
pub use listen::listen;
pub use server::Server;
