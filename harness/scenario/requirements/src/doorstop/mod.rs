//! A document of Doorstop: a folder with `.doorstop.yml` and a YAML file for each item.
//!
//! `text` is the text and `header` the title; `links` are parents. Sections and indentation are `level`:
//! an item that isn't normative and whose level ends in 0 is the heading of a section. Octant's keys are
//! attributes by their own names.

mod read;
mod write;
mod yaml;

pub use read::read;
pub use write::write;

/// File with the settings of a document.
const SETTINGS: &str = ".doorstop.yml";
/// Keys of the head of a document for the settings of Doorstop.
const HEAD: [(&str, &str); 4] = [
    ("prefix", "DOORSTOP_PREFIX"),
    ("sep", "DOORSTOP_SEP"),
    ("digits", "DOORSTOP_DIGITS"),
    ("parent", "DOORSTOP_PARENT"),
];
/// Extension of the settings with the title of a document.
const TITLE: &str = "octant_title";
/// Attributes of every item.
const STANDARD: [&str; 10] = [
    "active",
    "derived",
    "header",
    "level",
    "links",
    "normative",
    "ref",
    "references",
    "reviewed",
    "text",
];

/// A file of the folder: its name and text.
pub type DoorstopFile = (String, String);
