//! Tests of the numerical core against closed forms.
#![allow(clippy::unwrap_used, missing_docs)]
mod coverage;
