//! The truth: motion of the case, the two-gimbal turntable, the sensors and their noise.
//!
//! The plant makes integer counts, stamped at the end of their interval, and answers to the gimbal
//! commands of the core. It never sees what the core estimates.

mod case;
pub mod config;
pub mod draw;
mod encoder;
mod gimbal;
mod imu;
mod increments;
pub mod motion;
mod normal;
pub mod philox;
mod plant;
mod processes;
mod reference;
pub mod sea;
pub mod stream;
mod sway;
mod trig;
mod truth;
mod validate;
mod vibration;

pub use plant::{Plant, Step};
pub use truth::Truth;
pub use validate::ConfigError;
