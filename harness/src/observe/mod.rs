//! What a position sequence can observe, before anyone turns a gimbal.

pub mod static_rank;

pub use static_rank::{StaticRank, static_rank};
