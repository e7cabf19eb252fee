//! Suites: scenarios with their expected results.
//!
//! ```toml
//! schema = 1
//!
//! [[cases]]
//! scenario = "spike.toml"
//! expect = "pass"
//!
//! [[cases]]
//! scenario = "bias-step.toml"
//! expect = "fail"
//! because = "refused"
//! ```

use super::error::{FileProblems, Problem};
use super::keys::{CaseKeys, Keys, SuiteKeys};
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

/// A list of scenarios with their expected results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suite {
    /// Cases, in the order of the file.
    pub cases: Vec<SuiteCase>,
}

/// A scenario with its expected result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SuiteCase {
    /// File of the scenario.
    pub scenario: PathBuf,
    /// Expected verdict.
    pub expect: Verdict,
    /// Text that every reason has to contain; required unless a pass is expected.
    pub because: Option<String>,
}

impl Suite {
    /// Reads a suite file. Names of scenarios are relative to its folder.
    ///
    /// # Errors
    /// If the file can't be read, isn't TOML, or is not a suite: every problem with its place.
    pub fn load(path: &Path) -> Result<Self, FileProblems> {
        let file = path.display().to_string();
        let text = FileProblems::text_of(path)?;
        Self::parse(&text, &file, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads the text of a suite. `file` names it in errors, `folder` is the folder of the scenarios.
    ///
    /// # Errors
    /// If it isn't TOML or not a suite: every problem with its place.
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, FileProblems> {
        crate::other_format::refuse(text, file, "a suite")?;
        SuiteKeys::parse(text, file, |_, _| (), |keys| cases(keys, folder))
    }
}

fn cases(keys: SuiteKeys, folder: &Path) -> Result<Suite, Problem> {
    let mut cases: Vec<SuiteCase> = Vec::new();
    for CaseKeys { scenario: name, expect, because } in keys.cases {
        let scenario = folder.join(&*name);
        if cases.iter().any(|case| case.scenario == scenario) {
            let message = format!("found {:?} a second time, expected one case a scenario", *name);
            return Err(name.problem(message));
        }
        let problem = match (expect, because.as_deref()) {
            (Verdict::None | Verdict::Pass, Some(_)) => {
                Some("found a reason, and a pass or none needs none")
            }
            (Verdict::None | Verdict::Pass, None) => None,
            (_, None) => {
                Some("missing, expected words that the reasons of the verdict have to contain")
            }
            (_, Some(text)) if text.trim().is_empty() => {
                Some("found an empty text, expected words")
            }
            (_, Some(_)) => None,
        };
        if let Some(message) = problem {
            return Err(because.problem(message));
        }
        cases.push(SuiteCase { scenario, expect, because: because.value });
    }
    Ok(Suite { cases })
}

/// Result of a case other than the expected one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "found {} ({}), expected {}{}",
    .found.name(),
    .reasons.join("; "),
    .expected.name(),
    .because.as_ref().map_or_else(String::new, |because| format!(", because of {because:?}"))
)]
pub struct Unexpected {
    /// Verdict.
    pub found: Verdict,
    /// Its reasons.
    pub reasons: Vec<String>,
    /// Expected verdict.
    pub expected: Verdict,
    /// Text that every reason has to contain.
    pub because: Option<String>,
}

impl SuiteCase {
    /// Compares a result with the expected one: the verdict must be equal, and every reason the
    /// expected one.
    ///
    /// # Errors
    /// If they differ: the result found and the result expected.
    pub fn hold(&self, verdict: Verdict, reasons: &[String]) -> Result<(), Unexpected> {
        let alone = |because: &str| {
            !reasons.is_empty() && reasons.iter().all(|reason| reason.contains(because))
        };
        if verdict == self.expect && self.because.as_deref().is_none_or(alone) {
            return Ok(());
        }
        Err(Unexpected {
            found: verdict,
            reasons: reasons.to_vec(),
            expected: self.expect,
            because: self.because.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(cases: &str) -> Result<Suite, String> {
        let text = format!("schema = 1\n{cases}");
        Suite::parse(&text, "s.toml", Path::new("f")).map_err(|error| error.to_string())
    }

    #[test]
    fn a_suite_is_read() {
        let text = "[[cases]]\nscenario = \"a.toml\"\nexpect = \"pass\"\n\n\
                    [[cases]]\nscenario = \"b.toml\"\nexpect = \"fail\"\nbecause = \"refused\"\n";
        let suite = parse(text).unwrap();
        assert_eq!(suite.cases[0].scenario, Path::new("f/a.toml"));
        let [good, bad] = &suite.cases[..] else { panic!() };
        assert_eq!((good.expect, good.because.as_deref()), (Verdict::Pass, None));
        assert_eq!((bad.expect, bad.because.as_deref()), (Verdict::Fail, Some("refused")));
        good.hold(Verdict::Pass, &[]).unwrap();
        let reasons = ["calibration refused: no".to_owned()];
        bad.hold(Verdict::Fail, &reasons).unwrap();
        let more = [reasons[0].clone(), "X: 3".to_owned()];
        assert!(bad.hold(Verdict::Fail, &more).unwrap_err().to_string().contains("X: 3"));
        assert_eq!(
            bad.hold(Verdict::Fail, &["X: 3".to_owned()]).unwrap_err().to_string(),
            "found fail (X: 3), expected fail, because of \"refused\""
        );
        assert_eq!(
            good.hold(Verdict::Fail, &reasons).unwrap_err().to_string(),
            "found fail (calibration refused: no), expected pass"
        );
    }

    #[test]
    fn mistakes_have_file_line_and_field() {
        let case = |more: &str| parse(&format!("[[cases]]\nscenario = \"a.toml\"\n{more}"));
        for (more, problem) in [
            ("expect = \"well\"", "s.toml:4:10: cases[0].expect: found \"well\""),
            ("expect = \"fail\"", "s.toml:2:1: cases[0].because: missing"),
            (
                "expect = \"pass\"\nbecause = \"x\"",
                "s.toml:5:11: cases[0].because: found a reason, and a pass or none needs none",
            ),
            (
                "expct = \"pass\"",
                "s.toml:4:1: cases[0].expct: unknown key, did you mean \"expect\"",
            ),
            (
                "expect = \"pass\"\n[[cases]]\nscenario = \"a.toml\"\nexpect = \"pass\"",
                "s.toml:6:12: cases[1].scenario: found \"a.toml\" a second time",
            ),
        ] {
            let found = case(more).unwrap_err();
            assert!(found.starts_with(problem), "{found}");
        }
        assert!(parse("").unwrap_err().contains("cases: missing"));
    }
}
