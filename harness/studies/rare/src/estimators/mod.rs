//! Estimates of small probabilities by simulation, of anything that runs points of random inputs.
//!
//! A [bench](point::RareBench) runs points and says how severe each run was. The [estimate](mod@estimate) is the
//! probability that the severity is above a limit, with its interval, or the severity that is exceeded with a
//! probability. [`mod@subset`] looks for the region of failures, [`mixture`] describes it, [`proposal`] chooses the
//! distribution that the samples of the estimate come from.
//!
//! Nothing here knows scenarios or files: the tests compare intervals with closed forms.

pub mod estimate;
pub mod mixture;
pub mod point;
pub mod proposal;
pub mod slope;
pub mod subset;
