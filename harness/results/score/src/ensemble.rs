//! Statistics over many runs that the scores use, from [`octant_statistics`].

pub use octant_statistics::paired::{Improvement, improvement};
pub use octant_statistics::position::{PositionStatistics, cep50, position_statistics};
pub use octant_statistics::proportion::{success_lower_bound, success_upper_bound};
pub use octant_statistics::rate::radial_rates;
pub use octant_statistics::sample::{percentile, rms};
