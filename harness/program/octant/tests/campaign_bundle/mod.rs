//! Bundles of campaigns: a plan with all of its files, run where none of them is, and refused with any
//! damage.

mod bench;
mod damage;
mod round_trip;
