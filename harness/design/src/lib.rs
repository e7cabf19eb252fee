//! Design of a calibration: the sequence and the rotation with the least drift, and the bound of all of
//! them.
//!
//! | module | idea |
//! |---|---|
//! | [`setup`] | what a scenario gives to a design, and what it must not ask for |
//! | [`measure`] | what is minimised |
//! | [`evaluate`] | covariance of a candidate, in about a millisecond |
//! | [`navigation`] | free navigation as weights of the errors at its start |
//! | [`bound`](mod@bound) | what no attitude history can beat, with its certificate |
//! | [`candidate`] | stops on a grid of angles, within the limits of the gimbals |
//! | [`search`] | local moves of several chains, on any number of threads with the same result |
//! | [`contribution`] | what each stop adds |
//! | [`report`] | a design beside the published sequences and the bound |
//! | [`shortest`] | the shortest calibration that keeps a drift |

pub mod bound;
pub mod candidate;
pub mod contribution;
mod dwell;
pub mod evaluate;
pub mod measure;
mod mutate;
pub mod navigation;
mod platform;
pub mod report;
pub mod search;
pub mod setup;
pub mod shortest;

pub use setup::{DesignError, DesignSetup, Judge, Rotation};
