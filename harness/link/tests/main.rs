//! Tests of ports and sessions, in one program.
#![allow(clippy::unwrap_used)]

#[cfg(target_os = "linux")]
mod can;
#[cfg(unix)]
mod clients;
mod common;
#[cfg(unix)]
mod faults;
mod hostile;
mod misbehaving;
#[cfg(unix)]
mod no_allocation;
#[cfg(unix)]
mod sessions;
