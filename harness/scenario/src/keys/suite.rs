//! Keys of a suite: scenarios and their expected results.

use super::definition::{Default, Kind, SCHEMA, Section, key, section};

pub(crate) static SUITE: Section = section(&[
    key("schema", Kind::Integer(SCHEMA, SCHEMA), Default::Required, "Version of the format."),
    key("cases", Kind::Tables(&CASE, 1, 10_000), Default::Required, "The scenarios."),
]);

static CASE: Section = section(&[
    key("scenario", Kind::Text, Default::Required, "File, counted from the suite's own folder."),
    key(
        "expect",
        Kind::Choice(&[
            ("none", "nothing is required"),
            ("pass", "every requirement is kept"),
            ("fail", "a requirement is broken, or the calibration refused"),
            ("inconclusive", "nothing is shown"),
        ]),
        Default::Required,
        "The verdict that it has to end with.",
    ),
    key(
        "because",
        Kind::Text,
        Default::Absent("none: a pass is expected, or that nothing is required"),
        "Words that every reason of the verdict has to contain.",
    ),
]);
