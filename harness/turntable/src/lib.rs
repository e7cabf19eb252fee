//! Two-axis turntables: driven, stopped and simulated.
//!
//! [`Turntable`] is what the harness asks of a table: go to an angle, turn with a rate, stop, home, say where
//! you are. [`Driver`] does that over any port for any command language of lines, which a table of
//! patterns describes ([`Dialect`]); that of Aerotech's Ensemble controllers comes with it.
//!
//! A table is a machine that can hurt people, so what stops it is apart from what drives it:
//!
//! - the driver refuses angles beyond the soft limits and rates beyond the largest one, before anything is sent;
//! - [`Supervisor`] looks at the table many times a second and stops it where it goes beyond them, answers
//!   nonsense or nothing;
//! - [`EmergencyStop`] has a handle of its own on the port and its bytes ready: it writes them on demand, on a
//!   panic, on a signal and when the driver is dropped, and then nothing moves until it is reset;
//! - [`Guard`] is a process of its own with another handle: it writes them when the harness dies of whatever
//!   it be, SIGKILL too, or hangs;
//! - [`Button`] lets another program of the host press the stop, also where the port takes one peer at a time;
//! - the watchdog of the controller, where it has one and is told to: it stops a table that hears nothing, when
//!   the line is cut or the computer fails.
//!
//! None of this replaces the emergency stop button.

mod button;
mod by_hand;
mod dialect;
mod driver;
mod error;
mod follow;
mod following;
mod guard;
mod limits;
mod port;
pub mod simulate;
mod stop;
mod supervisor;
mod table;
mod track;

pub use button::{Button, Pressed, press};
pub use by_hand::{Move, look, move_by_hand};
pub use dialect::Dialect;
pub use driver::{Driver, Settings};
pub use error::Error;
pub use follow::Follower;
pub use following::{Following, Plan, Told};
pub use guard::{Guard, run_guard};
pub use limits::{AxisLimits, Limits};
pub use port::{Port, check_port, open};
pub use stop::{EmergencyStop, on_panic, on_signals, stop_all, stop_by_hand, stop_line};
pub use supervisor::Supervisor;
pub use table::{Axis, AxisStatus, Status, Turntable};
pub use track::{Place, Track};
