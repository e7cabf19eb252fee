//! Tests of the characterisation.

mod coverage;
mod synthetic;
mod variances;
