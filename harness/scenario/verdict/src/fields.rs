//! Fields for Octant's keys of a requirement in other formats.

use crate::measures::without_secant;
use crate::requirement::{
    Check, EnsembleRequirement, Limit, Requirement, Verification, confidence, percent, probability,
};
use crate::verdict::Comparison;

/// The measure.
pub const MEASURE: &str = "MEASURE";
/// Sign of the comparison.
pub const COMPARISON: &str = "COMPARISON";
/// The limit.
pub const LIMIT: &str = "LIMIT";
/// `true`: the limit is multiplied by the secant of the site's latitude.
pub const SECANT_LATITUDE: &str = "SECANT_LATITUDE";
/// Required probability that a run passes.
pub const PASS: &str = "PASS";
/// Confidence with which it is shown.
pub const CONFIDENCE: &str = "CONFIDENCE";
/// Verification, by its name.
pub const VERIFICATION: &str = "VERIFICATION";
/// Names of tests, separated by `; `.
pub const TESTS: &str = "TESTS";
/// Document and clause of the origin.
pub const CLAUSE: &str = "CLAUSE";
/// The reason.
pub const RATIONALE: &str = "RATIONALE";
/// Fields that every format names in its own way.
pub const OF_FORMATS: [&str; 4] = ["MID", "UID", "TITLE", "STATEMENT"];
/// All fields, in the order of writing.
pub const ALL: [&str; 10] = [
    MEASURE,
    COMPARISON,
    LIMIT,
    SECANT_LATITUDE,
    PASS,
    CONFIDENCE,
    VERIFICATION,
    TESTS,
    CLAUSE,
    RATIONALE,
];

/// Fields of a requirement beside id, title and text, as names and values.
pub fn own_fields(requirement: &Requirement) -> Vec<(&'static str, String)> {
    let mut fields = Vec::new();
    match &requirement.verification {
        Verification::Test(Check { measure, comparison, limit, secant_latitude, ensemble }) => {
            fields.push((MEASURE, measure.clone()));
            fields.push((COMPARISON, comparison.sign().to_owned()));
            fields.push((LIMIT, limit.text()));
            if *secant_latitude {
                fields.push((SECANT_LATITUDE, true.to_string()));
            }
            if let Some(ensemble) = ensemble {
                fields.push((PASS, percent(ensemble.pass)));
                fields.push((CONFIDENCE, percent(ensemble.confidence)));
            }
        }
        tested @ Verification::Tests(tests) => {
            fields.push((VERIFICATION, tested.name().to_owned()));
            fields.push((TESTS, tests.join("; ")));
        }
        other @ (Verification::Analysis | Verification::Inspection) => {
            fields.push((VERIFICATION, other.name().to_owned()));
        }
        Verification::Open => {}
    }
    fields.extend(requirement.clause.iter().map(|text| (CLAUSE, text.clone())));
    fields.extend(requirement.rationale.iter().map(|text| (RATIONALE, text.clone())));
    fields
}

/// Reason why these can't be names of tests.
pub fn misnamed(tests: &[String]) -> Option<String> {
    if tests.is_empty() {
        return Some("found no test, expected at least one".to_owned());
    }
    let bad = tests.iter().find(|name| {
        name.is_empty() || name.trim() != name.as_str() || name.contains([';', '\n'])
    })?;
    Some(format!("found {bad:?}, expected the name of a test: one line without \";\""))
}

/// Function that finds the line and value of a field.
pub type Lookup<'a> = dyn Fn(&str) -> Option<(usize, &'a str)> + 'a;

/// A verification, and the fields that describe it.
pub type Said = (Verification, Vec<&'static str>);

/// Verification of a requirement, and the fields that describe it; `None`: there are none.
///
/// # Errors
/// Line and reason, if the fields are incomplete or invalid.
pub fn verification(of: &Lookup<'_>) -> Result<Option<Said>, (usize, String)> {
    if let Some((line, measure)) = of(MEASURE) {
        let limit = of(LIMIT).ok_or_else(|| (line, format!("{MEASURE} without {LIMIT}")))?;
        let comparison = match of(COMPARISON) {
            None => Comparison::AtMost,
            Some((line, sign)) => Comparison::of_sign(sign).ok_or_else(|| {
                (line, format!("{COMPARISON} is {sign:?}, expected <=, <, >= or >"))
            })?,
        };
        let part = |name: &'static str| match of(name) {
            None => Ok(None),
            Some((line, text)) => {
                match if name == CONFIDENCE { confidence(text) } else { probability(text) } {
                    Ok(probability) => Ok(Some(probability)),
                    Err(error) => Err((line, format!("{name}: {error}"))),
                }
            }
        };
        let ensemble = match (part(PASS)?, part(CONFIDENCE)?) {
            (Some(pass), Some(confidence)) => Some(EnsembleRequirement { pass, confidence }),
            (None, None) => None,
            _ => {
                return Err((line, format!("{PASS} and {CONFIDENCE} say something only together")));
            }
        };
        let secant_latitude = match of(SECANT_LATITUDE) {
            None => false,
            Some((line, flag)) => {
                let found = flag.trim().to_ascii_lowercase().parse();
                let refused = || format!("{SECANT_LATITUDE} is {flag:?}, expected true or false");
                let flag = found.map_err(|_| (line, refused()))?;
                if flag && let Some(message) = without_secant(measure) {
                    return Err((line, format!("{SECANT_LATITUDE}: {message}")));
                }
                flag
            }
        };
        let check = Check {
            measure: measure.to_owned(),
            comparison,
            limit: Limit::of_text(limit.1)
                .map_err(|error| (limit.0, format!("{LIMIT}: {error}")))?,
            secant_latitude,
            ensemble,
        };
        let mut used = vec![MEASURE, COMPARISON, LIMIT, SECANT_LATITUDE, PASS, CONFIDENCE];
        // Beside a measure this field adds nothing.
        if of(VERIFICATION).is_some_and(|(_, how)| how.eq_ignore_ascii_case("test")) {
            used.push(VERIFICATION);
        }
        return Ok(Some((Verification::Test(check), used)));
    }
    let Some((line, how)) = of(VERIFICATION) else { return Ok(None) };
    let (method, is_only) = method(how);
    // The field of several methods stays an attribute.
    let used = |fields: &[&'static str]| {
        fields.iter().copied().filter(|field| is_only || *field != VERIFICATION).collect()
    };
    let verification = match method.as_str() {
        "analysis" => Verification::Analysis,
        "inspection" => Verification::Inspection,
        // The field stays an attribute.
        "open" => return Ok(Some((Verification::Open, Vec::new()))),
        "test" => {
            let Some((line, names)) = of(TESTS) else {
                let reason =
                    format!("{VERIFICATION} is by test, and there is no {MEASURE} and no {TESTS}");
                return Err((line, reason));
            };
            let tests: Vec<String> = names.split(';').map(|name| name.trim().to_owned()).collect();
            if let Some(reason) = misnamed(&tests) {
                return Err((line, format!("{TESTS}: {reason}")));
            }
            return Ok(Some((Verification::Tests(tests), used(&[VERIFICATION, TESTS]))));
        }
        _ => return Err((line, format!("{VERIFICATION} is {how:?}"))),
    };
    Ok(Some((verification, used(&[VERIFICATION]))))
}

/// Method that decides among those of a field, in small letters, and whether it is the only one. A requirement that is
/// verified by test and by analysis too is tested; the first of others counts, if all of them are known.
fn method(how: &str) -> (String, bool) {
    let all: Vec<String> = how
        .split([',', ';', '\n'])
        .map(|method| method.trim().to_ascii_lowercase())
        .filter(|method| !method.is_empty())
        .collect();
    let known = ["test", "analysis", "inspection", "open"];
    let rank = |method: &&String| known.iter().position(|known| known == method);
    let decides = match all.iter().all(|method| known.contains(&method.as_str())) {
        // An open one is decided by nobody, whatever the others are; a test alone is more.
        true if all.iter().any(|method| method == "test") => all.iter().min_by_key(rank),
        true if all.iter().any(|method| method == "open") => all.iter().max_by_key(rank),
        true => all.first(),
        false => None,
    };
    (decides.cloned().unwrap_or_else(|| how.trim().to_ascii_lowercase()), all.len() == 1)
}
