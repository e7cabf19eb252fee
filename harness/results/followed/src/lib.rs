//! Whether a navigation followed the samples that its unit was given.
//!
//! A unit that ignores its samples can answer with any error that a good one has. It can't have their noise. In unaided
//! navigation the errors x of attitude, velocity and position obey the error dynamics, so that
//!
//! ```text
//! r(t) = x(t + Δ) − Φ(Δ) x(t) = w(t) + P(t) p + e(t)
//! ```
//!
//! where w is the noise of the samples between t and t + Δ turned into n, p are the errors of the 30 parameters that the
//! unit compensates with, and e is what the output rounds. Where w is known, r regressed on w and P has the slope 1 on w
//! if the unit integrated its samples, and 0 if it didn't. Errors themselves can't show that: all of them share the
//! Schuler period and that of the Earth.
//!
//! - [`interval`] has the error dynamics from one comparison with the truth to the next, and the effects of noise and
//!   parameters in it
//! - [`window`] sums them up over Δ
//! - [`regression`] has the normal equations, with the parameters as nuisance
//! - [`follower`] takes the comparisons of a run as they come
//! - [`score`] derives the result
//!
//! Nothing here allocates memory after [`Follower::new`](follower::Follower::new).

pub mod follower;
pub mod interval;
pub mod regression;
pub mod score;
pub mod window;

pub use follower::{Compared, Follower};
pub use interval::Told;
pub use score::{Channel, Followed, FollowedScore, KnownNoise};
