//! Live endpoints: the ports that messages of [`octant_wire`] cross, and the two ends of a session.
//!
//! - [`uri`]: names of ports: `serial:/dev/ttyUSB0?baud=921600`, `can:can0`, `udp:host:port`.
//! - [`port`]: open ports: lines of bytes, datagrams, CAN frames.
//! - [`capture`]: bytes of an instrument that sends on its own, kept in a file.
//! - [`wire`]: messages across a port, and counts of losses.
//! - [`harness`]: the harness end: sends samples and receives outputs.
//! - [`device`]: the device end: steps a core once for each sample, never twice.
//! - [`asking`]: when an unanswered request is sent again.
//! - [`clock`]: offset and drift of the other end's clock.
//! - [`fault`]: faults injected on a wire.
//! - [`load`]: whether a line or bus carries a sample rate, before anything is sent.
//!
//! In lock-step no step is lost: an unanswered request is repeated. So the outputs are bit-identical
//! over every line, however bad it is.

pub mod asking;
pub mod capture;
pub mod clock;
pub mod device;
pub mod fault;
pub mod harness;
pub mod load;
pub mod port;
pub mod uri;
mod waited;
pub mod wire;

pub use port::PortError;
pub use uri::Uri;
pub use wire::Wire;
