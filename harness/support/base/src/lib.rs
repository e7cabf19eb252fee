//! Small parts that the whole harness shares.
//!
//! | module | idea |
//! |---|---|
//! | [`names`] | the known name that is nearest to one that isn't known |
//! | [`display`] | units in which errors are shown |
//! | [`encoding`] | text of files whose encoding isn't said |
//! | [`number`] | numbers as people read them |
//! | [`not_finite`] | JSON of numbers that may not be finite |
//! | [`printable`] | text from outside, without what acts on a terminal or breaks a file |
//! | [`decimal`] | times as decimal text |
//! | [`control`] | progress of a run, and the request to end it |
//! | [`regular`] | regular files, opened as nothing else |
//! | [`pool`] | tasks on several threads, their results in order |
//! | [`chained_lines`] | files of lines that grow, by which an interrupted program goes on |
//! | [`code`] | the file that this code is in |
//! | [`failing`] | kinds of failures, for exit statuses |
//! | [`hash`] | SHA-256 of files |
//! | [`child`] | processes that hear nothing of keys, with time limits |
//! | [`interrupt`] | signals that end the program |
//! | [`address`] | addresses of ports as text, the same for every device |
//! | [`memory`] | ends of the program where the system refuses memory or a thread |
//! | [`serial`] | serial ports and pseudo terminals |
//! | [`arrow`] | units of columns, in the metadata of Parquet files |
//! | [`utc`] | times of the host as text |
//! | [`whole_file`] | files that are written in one piece |

pub mod address;
pub mod arrow;
pub mod attendance;
pub mod chained_lines;
pub mod child;
pub mod code;
pub mod control;
pub mod decimal;
pub mod display;
pub mod encoding;
pub mod failing;
pub mod hash;
pub mod interrupt;
pub mod memory;
pub mod names;
pub mod not_finite;
pub mod number;
pub mod pool;
pub mod printable;
pub mod regular;
pub mod serial;
pub mod utc;
pub mod whole_file;
