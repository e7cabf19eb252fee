//! What every part of the harness uses and no part owns.
//!
//! | module | idea |
//! |---|---|
//! | [`names`] | the known name that is nearest to one that isn't known |
//! | [`number`] | numbers as people read them |
//! | [`child`] | processes that hear nothing of keys |

pub mod child;
pub mod names;
pub mod number;
