//! Tests of the numerical core against closed forms.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]
mod coverage;
mod honest;
