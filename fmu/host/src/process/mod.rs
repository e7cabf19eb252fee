//! An FMU in a process of its own: it can crash, hang, end the process and print without harm, and
//! the caller gets an error that names the case.
//!
//! | module | idea |
//! |---|---|
//! | `message` | messages between the two processes, over a socket |
//! | `shared` | memory of both processes, for exchanges |
//! | `watch` | the child process: its time limit, and its end |
//! | `patience` | time that an answer may take |
//! | `remote` | the FMU seen from this process |
//! | [`guard`] | the process between both: `octant fmu host` |
//! | [`host`] | the other process: `octant fmu host --unguarded` |
//!
//! The other process gets its end of the socket as standard input and the shared memory as standard
//! output, and moves both away before it loads anything: standard input is then empty for the FMU,
//! and its output goes to standard error. An exchange is one round trip through shared memory, for
//! which both sides poll a while before they sleep; everything else goes over the socket. When this
//! process ends, for whatever reason, the socket closes, and the other process ends too, with every
//! process that the FMU started: the guard between them ends these.

#[cfg(target_os = "linux")]
pub mod guard;
#[cfg(target_os = "linux")]
pub mod host;
#[cfg(target_os = "linux")]
mod message;
#[cfg(target_os = "linux")]
mod patience;
#[cfg(target_os = "linux")]
mod remote;
#[cfg(target_os = "linux")]
mod shared;
#[cfg(target_os = "linux")]
mod watch;

#[cfg(target_os = "linux")]
pub(super) use remote::open;

/// Opens an unpacked FMU in a process of its own.
#[cfg(not(target_os = "linux"))]
pub(super) fn open(
    name: &str,
    _: super::archive::Unpacked,
    _: std::sync::Arc<super::description::Description>,
    _: &super::instance::OpenOptions,
) -> Result<Box<dyn super::instance::Instance>, super::instance::InstanceError> {
    Err(super::instance::InstanceError::unsupported(
        name,
        "run in a process of its own",
        "this works on Linux alone; it can run in this process",
    ))
}
