//! Forms of what units send.

use crate::described::{FixedRecords, LineDescription, RecordDescription};

/// Form of what a unit sends.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one for each port or file")]
pub enum UnitForm {
    /// Frames with bytes that they begin with.
    Frames(RecordDescription),
    /// Records of one length, in a file.
    Records(FixedRecords),
    /// Lines of text.
    Lines(LineDescription),
}
