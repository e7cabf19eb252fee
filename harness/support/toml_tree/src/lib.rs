//! TOML as it was written: a tree of values with their places, and problems that name a place.
//!
//! It is the one reader of TOML that tells places: whoever reads keys on its own reads them from this tree.

mod controls;
pub mod error;
mod read;
mod tree;
mod write;

pub use controls::controls_of_argument;
pub use read::{number_as_written, parse, parse_argument, parse_default, read, read_as};
pub use tree::{Entry, Node, Table, Value, join, number};
pub use write::{json, write_value};
