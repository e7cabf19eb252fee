//! Bundles: the plan of a campaign with every file that its cases need, as one file that is run anywhere.
//!
//! A bundle is a ZIP archive: [`contents`] is its list, [`mod@write`] makes it from the folder of a
//! campaign, and [`unpack`] makes a folder of a campaign from it. In both the names of files are
//! relative ([`entry_name`]), and the content of each file is checked by its BLAKE3. The scenarios keep their bytes, and with
//! them the cases their ids: the plan names the place of each file that a scenario names.

mod collect;
pub mod contents;
pub mod entry_name;
pub mod error;
pub mod unpack;
pub mod write;
