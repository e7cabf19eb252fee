//! Characterises an inertial unit from a recording at rest.
//!
//! - [`deviations`] has Allan, modified Allan and Hadamard variances of any record in bounded memory
//! - [`kernel`] has the noise terms as covariances of the phase; [`freedom`] the degrees of freedom and covariances
//!   of variances that follow
//! - [`fit`] finds the terms that a record shows, each with an interval or a limit; [`drift`] a steady change
//! - [`spectrum`] has the spectral density and its lines
//! - [`recording`] reads any source of samples, [`survey`] finds where it is at rest, [`analysis`] puts all of the above
//!   together
//! - [`temperature`] has the biases' dependence on temperature
//! - [`earth_rate`] checks several attitudes against Earth's rate
//! - [`instrument`] writes the `[imu]` section of a scenario, [`twin`] simulates it and compares
//! - [`result`] is all of it, [`text`] and [`page`] are its terminal and HTML forms

pub mod analysis;
pub mod deviations;
pub mod drift;
pub mod earth_rate;
pub mod error;
pub mod fit;
pub mod freedom;
pub mod instrument;
pub mod kernel;
pub mod page;
pub mod recording;
pub mod result;
pub mod spectrum;
pub mod survey;
pub mod temperature;
pub mod text;
pub mod twin;
