//! Allan variance of a sensor at rest: estimated while samples go by, with its uncertainty and the noise
//! terms that describe it (IEEE Std 952-1997, annex C; Riley, NIST Special Publication 1065).
//!
//! - [`cascade`] takes samples and keeps the squared differences of neighbouring averages, octave by
//!   octave
//! - [`term`] has the noise terms: Allan variance, and correlation of the differences
//! - [`freedom`] has the degrees of freedom of an estimate, and its interval
//! - [`fit`] finds the terms that describe the estimates, each with an interval or a bound
//!
//! With the averages ȳ over neighbouring stretches of length τ the Allan variance is
//! `σ²(τ) = ½ ⟨(ȳ(t + τ) − ȳ(t))²⟩`. A constant (a bias, Earth's rate at a fixed attitude) cancels. So
//! stretches at different attitudes can be pooled: the differences are taken within each of them.

pub mod cascade;
pub mod fit;
pub mod freedom;
pub mod term;

pub use cascade::{AllanCascade, AllanTally};
pub use fit::{AllanAnalysis, AllanEstimate, AllanPoint, NoiseFit, TermEstimate, analyse};
pub use freedom::DifferenceCounts;
pub use term::NoiseTerm;
