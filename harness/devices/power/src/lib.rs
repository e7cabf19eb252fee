//! Power supplies and relays of the bench, by SCPI.
//!
//! | module | idea |
//! |---|---|
//! | `line` | a connection over TCP or a serial port that carries lines of text |
//! | [`scpi`] | the dialogue: a command or a query, and the error queue after it |
//! | [`plan`] | what feeds the device: a channel of a supply or a relay, and how it is left |
//! | [`outlet`] | the output itself: begun, cut, lowered, measured, and brought to its end |
//! | `last_words` | the end state for a program that can't go on |
//! | [`simulate`] | a simulated supply with relays, for tests |
//!
//! The commands are those of SCPI-1999 and IEEE 488.2; `docs/power.md` has each with its source. No real instrument was
//! met yet.

mod error;
mod last_words;
mod line;
pub mod outlet;
pub mod plan;
pub mod scpi;
pub mod simulate;

pub use error::PowerError;
pub use last_words::write_all_ends;
pub use line::{POWER_PORT, check_power_port, port_help};
pub use outlet::{PowerOutlet, PowerReading, Switching};
pub use plan::{Outlet, PowerPlan, SupplySetting};
pub use scpi::ScpiDialogue;
