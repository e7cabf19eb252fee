//! Functional Mock-up Units: ours made, anybody's checked, loaded and stepped.
//!
//! | module | idea |
//! |---|---|
//! | [`description`] | what a `modelDescription.xml` says, of both standards in one form |
//! | [`mapping`] | which of its variables is what |
//! | [`instance`] | an FMU that runs, of both standards and both kinds, behind one trait |

pub mod description;
pub mod instance;
pub mod mapping;
