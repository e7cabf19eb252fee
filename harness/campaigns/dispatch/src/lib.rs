//! Campaigns on other computers.
//!
//! | module | idea |
//! |---|---|
//! | [`bundle`] | the plan with every file that its cases need, as one file |
//! | [`emit`] | files with which schedulers and workflow engines run a campaign in parts |
//! | `storage` | campaigns on object storage, in builds with the feature `object-storage` |

pub mod bundle;
pub mod emit;
#[cfg(feature = "object-storage")]
pub mod storage;
