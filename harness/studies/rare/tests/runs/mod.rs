//! Real runs.

mod known;
mod resumed;
