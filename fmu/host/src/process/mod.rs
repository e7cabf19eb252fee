//! An FMU in a process of its own: it can crash, hang, end the process and print what it likes, and
//! who steps it gets an error that says which.
//!
//! | module | idea |
//! |---|---|
//! | `message` | what the two processes say to each other, over a socket |
//! | `shared` | memory of both, through which an exchange goes |
//! | `watch` | the child: how long it may take, and how it ended |
//! | `remote` | the FMU seen from this process |
//! | [`host`] | the other process: `octant fmu host` |
//!
//! The other process gets its end of the socket as standard input and the shared memory as standard
//! output, and moves both away before it loads anything: what the FMU reads is empty, and what it
//! prints goes to standard error. An exchange is one way there and back through shared memory, for
//! which both sides look a while before they sleep; everything else goes over the socket. When this
//! process ends, however it does, the socket closes, and the other process ends too.

#[cfg(target_os = "linux")]
pub mod host;
#[cfg(target_os = "linux")]
mod message;
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
    _: super::description::Description,
    _: &super::instance::Options,
) -> Result<Box<dyn super::instance::Instance>, super::instance::InstanceError> {
    Err(super::instance::InstanceError::unsupported(
        name,
        "run in a process of its own",
        "this works on Linux alone; it can run in this process",
    ))
}
