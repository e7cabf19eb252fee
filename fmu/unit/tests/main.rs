//! The FMUs as their importers get them, in one program.
#![allow(clippy::unwrap_used)]

mod abuse;
mod calibrator_config;
mod can_bus;
#[cfg(target_os = "linux")]
mod exports;
