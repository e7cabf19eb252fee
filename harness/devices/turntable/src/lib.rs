//! Two-axis turntables: driven, stopped and simulated.
//!
//! [`Turntable`] is the interface of a table: go to an angle, turn with a rate, stop, home, report the
//! status. [`Driver`] implements it over any port for any line-based command language, which a table of
//! patterns describes ([`Dialect`]); that of Aerotech's Ensemble controllers is built in.
//!
//! A table is a machine that can hurt people, so the ways to stop it are separate from its driver:
//!
//! - the driver refuses angles beyond the soft limits and rates beyond the largest one, before anything is sent;
//! - [`Supervisor`] checks the table many times a second, and stops it if it exceeds them, or its
//!   answers are invalid or missing;
//! - [`EmergencyStop`] has its own handle of the port with its bytes ready: it writes them on demand,
//!   on a panic, on a signal and when the driver is dropped, and then nothing moves until it is reset;
//! - [`Guard`] is a separate process with another handle: it writes them when the harness dies, for any
//!   reason including SIGKILL, or hangs;
//! - [`Button`] lets another program of the host press the stop, even if the port accepts only one peer
//!   at a time;
//! - the watchdog of the controller, if it has one and is told to use it, stops a table that receives
//!   nothing, when the line is cut or the computer fails.
//!
//! Several runs may share a table: one drives it ([`TableHost`]), the others get its angles ([`TableGuest`]).
//!
//! None of this replaces the hardware emergency stop button.

mod axis;
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
mod shared;
pub mod simulate;
mod stop;
mod supervisor;
mod table;
mod track;

pub use axis::{AxisStatus, TableAxis, TableStatus};
pub use button::{Button, Pressed, press};
pub use by_hand::{Move, look, move_by_hand, stop_by_hand, stop_line};
pub use dialect::Dialect;
pub use driver::{Driver, DriverSettings};
pub use error::Error;
pub use follow::Follower;
pub use following::{Following, TablePlan, TableTraffic, packed, unpacked};
pub use guard::{FAREWELL, Guard, guard, run_guard};
pub use limits::{AxisLimits, TableLimits};
pub use port::{TABLE_PORT, TablePort, check_port, open, port_help};
pub use shared::{GuestEnd, TableGuest, TableHost};
pub use stop::{EmergencyStop, on_panic, on_signals, stop_all};
pub use supervisor::Supervisor;
pub use table::Turntable;
pub use track::{Track, TrackPoint};
