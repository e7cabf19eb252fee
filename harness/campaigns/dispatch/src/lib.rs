//! Campaigns on other computers.
//!
//! | module | idea |
//! |---|---|
//! | [`bundle`] | the plan with every file that its cases need, as one file |
//! | [`emit`] | files with which schedulers and workflow engines run a campaign in parts |

pub mod bundle;
pub mod emit;
