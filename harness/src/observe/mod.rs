//! What a sequence can observe and what it will reach, before anyone turns a gimbal.

pub mod covariance;
