//! Functional Mock-up Units: ours made, anybody's mapped, run and put together.
//!
//! | module | idea |
//! |---|---|
//! | [`build`] | our own FMUs, from their tables |
//! | [`mapping`] | which of its variables is what |
//! | [`run`] | any FMU stepped with inputs from a file |
//! | [`master`] | several FMUs together: system structures, order, loops, faults on connections |

pub mod build;
pub mod mapping;
pub mod master;
pub mod run;
