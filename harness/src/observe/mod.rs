//! What a position sequence can observe and what it will reach, before anyone turns a gimbal.

pub mod covariance;
pub mod static_rank;

pub use static_rank::{StaticRank, static_rank};
