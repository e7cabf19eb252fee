//! What the forms of files have in common.

use super::point::{TimeScale, TrajectoryPoint};

/// Longest line of text, bytes: a file of another kind may have no line ends and must not fill the memory.
pub(crate) const LINE_BYTES_MAX: u64 = 64 * 1024;

/// A form of file.
pub(crate) trait Points: Send {
    /// Returns the next point; `None` at the end.
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String>;
    /// Place of the last point, as in "line 17".
    fn place(&self) -> String;
    fn scale(&self) -> TimeScale;
    /// Latest time that the file told so far, also of what isn't valid and so no point; `None`: that of the last point.
    fn heard_ns(&self) -> Option<i64> {
        None
    }
    /// Choice that was made in reading the file, in words that follow its name; `None`: none.
    fn choice(&self) -> Option<&'static str> {
        None
    }
}
