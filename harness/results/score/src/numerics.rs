//! The numerics version, which tells which programs give the same bits from the same scenario and seed.
//!
//! The version of the program describes its functions; the numerics version tells whether numbers can
//! be compared to the last bit. It is stored in `summary.json` and so in the results of cases, in
//! merged tables, in manifests and in nightly results.

/// Numerics version of this program.
///
/// The version is raised by one, once in a release, by this rule: for some scenario that the last release runs,
/// this release gives another stream hash or another published number (of `summary.json`, a table or a
/// report). The changelog of that release says so. A change of words, files or verdicts alone doesn't
/// raise it. Between releases it stays the same, and the hash of the program distinguishes builds.
pub const NUMERICS: u32 = 1;

/// Warning about results of another numerics version; `None`: they have this program's.
#[must_use]
pub fn differs(found: Option<u32>) -> Option<String> {
    (found != Some(NUMERICS)).then(|| {
        format!(
            "made with {}, this program has numerics version {NUMERICS}: verdicts can be compared, bits can't",
            in_words(found)
        )
    })
}

/// Text `numerics version 1`.
#[must_use]
pub fn in_words(version: Option<u32>) -> String {
    version.map_or_else(
        || "no numerics version (an Octant from before there was one)".to_owned(),
        |version| format!("numerics version {version}"),
    )
}
