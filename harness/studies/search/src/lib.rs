//! Search for the faults that do most harm unnoticed, over kinds, sizes, times, channels and pairs.
//!
//! A search has a [space](space::Space), derived from the catalogue or read from a file, and a
//! [bench](bench::SearchBench), the scenario without faults and its run. Each [candidate] is run on the
//! instrument and the noise of that run, so that every difference is its effect. The [guide] chooses
//! candidates by the results before; [`latin`](latin::latin) draws them all at once, for comparison. The
//! worst fault is made [smaller](minimal::minimal) in the end.
//!
//! Same scenario, space and seeds give the same candidates and results on any number of threads, and after an
//! interruption.

pub mod bench;
pub mod candidate;
pub mod derived;
pub mod earlier;
pub mod error;
pub mod found;
pub mod guide;
pub mod journal;
pub mod latin;
pub mod minimal;
pub mod page;
#[cfg(test)]
mod planted;
pub mod search;
pub mod space;
pub mod space_file;
#[cfg(test)]
mod tests;
pub mod trial;
