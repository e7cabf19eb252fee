//! Design of a calibration: the sequence and the rotation with the least drift, and the bound of all of
//! them.
//!
//! | module | idea |
//! |---|---|
//! | [`setup`] | what a scenario gives to a design, and what it must not ask for |
//! | [`measure`] | what is minimised |
//! | [`judge`] | a candidate's measure |
//! | [`evaluate`] | covariance of a candidate, in about a millisecond |
//! | [`navigation`] | free navigation as weights of the errors at its start |
//! | [`largest`] | the largest error of a navigation, by draws |
//! | [`bound`](mod@bound) | what no attitude history can beat, with its certificate |
//! | [`candidate`] | stops on a grid of angles, within the limits of the gimbals |
//! | [`lead_in`] | level alignment and quick round with which a sequence starts |
//! | [`search`] | local moves of several chains, on any number of threads with the same result |
//! | [`contribution`] | what each stop adds |
//! | [`continuous`] | gimbals that turn without a rest, evaluated only |
//! | [`report`] | a design beside the published sequences and the bound |
//! | [`confirm`] | a design against paired runs |
//! | [`shortest`] | the shortest calibration that keeps a drift |

pub mod bound;
pub mod candidate;
pub mod confirm;
pub mod continuous;
pub mod contribution;
mod dwell;
pub mod evaluate;
pub mod judge;
pub mod largest;
pub mod lead_in;
pub mod measure;
mod mutate;
pub mod navigation;
mod platform;
mod ranked;
pub mod report;
pub mod search;
pub mod setup;
pub mod shortest;

pub use judge::{Judge, MeasureWeights};
pub use setup::{DesignError, Rotation, Setup};
