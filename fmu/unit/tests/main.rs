//! The FMUs as their importers get them, in one program.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod abuse;
mod calibrator_config;
mod can_bus;
#[cfg(target_os = "linux")]
mod exports;
