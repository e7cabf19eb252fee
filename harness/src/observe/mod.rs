//! What a position sequence can observe and what it will reach, before anyone turns a gimbal.
//!
//! [`static_rank`](mod@static_rank) is the algebra of standing positions, [`covariance`] what one
//! configuration reaches, [`ensemble`] what the draws of a scenario make of it, [`against`] that held
//! against the cases of a campaign.

pub mod against;
pub mod covariance;
pub mod ensemble;
mod platform;
pub mod static_rank;
pub mod truth;

pub use static_rank::{StaticRank, static_rank};
