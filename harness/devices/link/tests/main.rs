//! Tests of ports and sessions, in one program.
#![allow(clippy::unwrap_used)]

mod arrivals;
mod asking;
#[cfg(target_os = "linux")]
mod can;
#[cfg(unix)]
mod clients;
mod clock;
mod common;
#[cfg(unix)]
mod exec;
#[cfg(unix)]
mod faults;
mod hostile;
mod load;
mod misbehaving;
#[cfg(unix)]
mod no_allocation;
#[cfg(unix)]
mod power;
mod seal;
mod sealed;
#[cfg(unix)]
mod sessions;
mod slcan;
#[cfg(all(target_os = "linux", feature = "can"))]
mod socket_can;
mod uri;
