//! Keys of a suite: scenarios and their expected results.

use super::definition::SCHEMA;
use super::table::{At, choice, integer, keys, tables, text};
use octant_verdict::Verdict;

keys! {
    /// A suite.
    pub(crate) struct SuiteKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format.";
        cases: Vec<CaseKeys> = tables(1, 10_000), required, "The scenarios.";
    }
}

keys! {
    /// One of `[[cases]]`.
    pub(crate) struct CaseKeys {
        scenario: At<String> = text(), required, "File, counted from the suite's own folder.";
        expect: Verdict = choice! {
                "none" => Verdict::None, "nothing is required";
                "pass" => Verdict::Pass, "every requirement is kept";
                "fail" => Verdict::Fail, "a requirement is broken, or the calibration refused";
                "inconclusive" => Verdict::Inconclusive, "nothing is shown";
            }, required, "The verdict that it has to end with.";
        because: At<Option<String>> = text(),
            absent("none: a pass is expected, or that nothing is required"),
            "Words that every reason of the verdict has to contain.";
    }
}
