//! Campaigns on object storage: S3-compatible services, and folders as the same thing without a service.
//!
//! [`StorageAddress`] is what a user writes, [`Storage`] reads and writes the objects under it, [`mod@layout`]
//! names them. [`WorkFolder`] is the local folder in which every command does its work: it is made from the
//! objects, and [`SegmentUploads`] or [`put_back`](WorkFolder::put_back) store what was added.
//!
//! Nothing that a worker stores is changed: its results are numbered segments, each written at once, and only
//! if nothing has its name ([`SegmentUploads`]). Whatever is written is read back before it counts as stored. Tables and
//! reports can be made again from them, and are overwritten.

pub mod address;
pub mod error;
pub mod layout;
pub mod objects;
pub mod uploads;
pub mod work_folder;

pub use address::StorageAddress;
pub use error::StorageError;
pub use objects::{PutOutcome, Storage, StorageOptions};
pub use uploads::{SegmentUploads, UploadLimits};
pub use work_folder::{WorkFolder, WorkScope};
