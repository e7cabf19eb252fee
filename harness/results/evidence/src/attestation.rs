//! A verified folder as an in-toto attestation: Statement v1 with the predicate test-result v0.1.
//!
//! <https://github.com/in-toto/attestation/blob/main/spec/predicates/test-result.md>. The statement
//! isn't signed here: the user's attestation tool wraps it in its envelope.

use super::manifest::{FILE_NAME, Manifest};
use super::statements::FolderStatements;
use octant_verdict::Verdict;
use serde_json::{Value, json};

/// Returns the result of a test in the predicate's terms. A verdict without evidence is never a
/// pass.
#[must_use]
pub const fn result(verdict: Option<Verdict>) -> &'static str {
    match verdict {
        Some(Verdict::Pass) => "PASSED",
        None | Some(Verdict::None | Verdict::Inconclusive) => "WARNED",
        Some(Verdict::Fail | Verdict::Error) => "FAILED",
    }
}

/// Builds the statement about a folder that was verified; `manifest_sha256` is the SHA-256 of its
/// manifest.
#[must_use]
pub fn statement(manifest: &Manifest, manifest_sha256: &str, stated: &FolderStatements) -> Value {
    let described = |name: &str, sha256: &str| json!({"name": name, "digest": {"sha256": sha256}});
    let own = described(FILE_NAME, manifest_sha256);
    let files = manifest.files.iter().map(|file| described(&file.path, &file.sha256));
    // Configuration of the test: the scenario with every value, the plan, the inputs.
    let configures =
        |path: &str| ["scenario.toml", "plan.json"].contains(&path) || path.starts_with("inputs/");
    let configuration: Vec<Value> = manifest
        .files
        .iter()
        .filter(|file| configures(&file.path))
        .map(|file| described(&file.path, &file.sha256))
        .collect();
    let tests = |wanted: &str| -> Vec<&str> {
        let found = stated.checks.iter().filter(|(_, verdict)| result(Some(*verdict)) == wanted);
        found.map(|(id, _)| id.as_str()).collect()
    };
    json!({
        "_type": "https://in-toto.io/Statement/v1",
        "subject": std::iter::once(own).chain(files).collect::<Vec<_>>(),
        "predicateType": "https://in-toto.io/attestation/test-result/v0.1",
        "predicate": {
            "result": result(stated.verdict),
            "configuration": configuration,
            "passedTests": tests("PASSED"),
            "warnedTests": tests("WARNED"),
            "failedTests": tests("FAILED"),
        },
    })
}
