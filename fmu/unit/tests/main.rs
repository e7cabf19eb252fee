//! The FMUs as their importers get them, their tables, and the parts of the library, in one program.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod abuse;
mod c_interface;
mod c_parts;
mod calibrator_can_table;
mod calibrator_config;
mod calibrator_table;
mod can_bus;
mod can_parts;
#[cfg(target_os = "linux")]
mod exports;
mod plant;
mod plant_table;
mod quantities;
mod scenario_config;
mod tables;
mod token;
mod tunable;

// Where the files of `c_parts` look for it.
use octant_fmu::table;
