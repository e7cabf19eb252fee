//! Live endpoints: the ports that messages of [`octant_wire`] cross, and the two ends of a session.
//!
//! - [`uri`]: what a port is called: `serial:/dev/ttyUSB0?baud=921600`, `can:can0`, `udp:host:port`.
//! - [`port`]: ports as they are: lines of bytes, datagrams, CAN frames.
//! - [`wire`]: messages across a port, and counts of what was lost on it.
//! - [`harness`]: the end that tests: it sends samples and gets outputs.
//! - [`device`]: the end that is tested: it steps a core on each sample, and never twice.
//! - [`clock`]: how far two clocks are apart, and how fast they drift.
//! - [`fault`]: what can go wrong on a wire, done on purpose.
//! - [`load`]: whether a line or bus carries a sample rate, before anything is sent.
//!
//! In lock-step nothing is ever lost: what isn't answered is asked for again. So the outputs are the
//! same to the last bit over every line, however bad it is.

mod asking;
pub mod clock;
pub mod device;
pub mod fault;
pub mod harness;
pub mod load;
pub mod port;
pub mod uri;
pub mod wire;

pub use port::PortError;
pub use uri::Uri;
pub use wire::Wire;
