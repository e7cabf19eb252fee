//! Simulated controller of a table: the command language of a [`crate::Dialect`], with the plant's
//! gimbals behind it.
//!
//! The simulation answers and refuses commands like a real controller, has limits of its own and a watchdog that
//! stops the table when it isn't fed. On demand it misbehaves: it is silent, answers nonsense, or hangs
//! up. [`SimulatedServer`] puts it on a TCP port or a pseudo-terminal.

mod controller;
mod listen;
mod server;

pub use controller::{Controller, ControllerBehaviour};
pub use listen::listen;
pub use server::SimulatedServer;
