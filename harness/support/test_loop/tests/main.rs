//! The core in a closed loop with the plant: consistency, faults, states, and the predicted ensembles. One program, with a
//! module for each subject.
#![allow(unreachable_pub)]
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::float_cmp)]

mod coloured_sway;
mod core_arbitrary;
mod core_behaviour;
mod core_consistency;
mod core_faults;
mod core_hardened;
mod core_spikes;
mod drift_power;
mod earth_golden;
mod ensemble_prediction;
mod ensembles;
mod expected_nis;
mod further_states;
mod gimbal_angles;
mod presets;
mod quiet_instruments;
mod rest;
mod sigma_limits;
mod smoothing;
mod state_core;
mod sway_conditions;
