//! Data exchanged between the stations: inertial samples, aiding, gimbal commands, core outputs.
//!
//! The plant and the calibration core share this vocabulary and nothing else. What they exchange is
//! plain data with one canonical byte form ([`canonical`]), so that a run in one process, through
//! an FMU or over a wire can be compared bit for bit.
//!
//! With the feature `alloc` there is also what faults do to a plant (`disturbance`); no core gets to
//! see it.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod canonical;
pub mod counts;
#[cfg(feature = "alloc")]
pub mod disturbance;
pub mod epoch;
pub mod further;
pub mod gimbal;
pub mod imu;
pub mod innovation;
mod largest_change;
pub mod noise;
pub mod output;
pub mod parameters;
pub mod time;
pub mod truth;

pub use epoch::{Aiding, Epoch, Reference};
pub use gimbal::{GimbalAngles, GimbalCommand};
pub use imu::{Sample, Status};
pub use innovation::{Innovation, InnovationOf, NavigationCovariance};
pub use largest_change::LargestChange;
pub use noise::NoiseIntegral;
pub use output::{Health, Mode, Navigation, Output};
pub use parameters::Parameters;
pub use time::DeviceTime;
pub use truth::Truth;
