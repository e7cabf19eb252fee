//! Documents of StrictDoc, `.sdoc`: read and written in the form of its version 0.30.
//!
//! A node's UID, TITLE, STATEMENT, RATIONALE and MID correspond to keys of a requirement; measure,
//! limit and the rest are fields MEASURE, COMPARISON, LIMIT, SECANT_LATITUDE, PASS, CONFIDENCE, VERIFICATION, TESTS and
//! CLAUSE, declared in the document's grammar. Every other field is an attribute, and is written
//! unchanged.
//!
//! Texts are plain unless the document names another markup (`OPTIONS.MARKUP`).

mod grammar;
pub(crate) mod markup;
mod read;
mod write;

pub use read::read;
pub(crate) use write::metadata_name;
pub use write::write;

/// Fields of a document's head, in the order of StrictDoc's grammar.
pub(crate) const HEAD: [&str; 8] =
    ["MID", "UID", "VERSION", "DATE", "CLASSIFICATION", "REQ_PREFIX", "PREFIX", "ROOT"];

/// Options of a document, in the order of StrictDoc's grammar.
pub(crate) const OPTIONS: [&str; 10] = [
    "ENABLE_MID",
    "RELATION_FIELD",
    "MARKUP",
    "AUTO_LEVELS",
    "LAYOUT",
    "VIEW_STYLE",
    "REQUIREMENT_STYLE",
    "NODE_IN_TOC",
    "REQUIREMENT_IN_TOC",
    "DEFAULT_VIEW",
];

/// Type of a plain requirement.
pub(crate) const REQUIREMENT: &str = "REQUIREMENT";

/// True if StrictDoc accepts this as UID: a letter, digit or `_`, then also `()-/.:` and space.
pub(crate) fn legal_uid(id: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    id.starts_with(word) && id.chars().all(|c| word(c) || "()-/.: ".contains(c))
}

/// True if StrictDoc accepts this as the name of a field: a capital, then letters, digits, `_`, `-`.
pub(crate) fn legal_field(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
        // The grammar would take these for the beginning of something else.
        && !name.starts_with("RELATIONS")
        && !name.starts_with("UID")
}

/// True if StrictDoc accepts this as the type of a node: words of capitals, joined by `_`.
pub(crate) fn legal_kind(name: &str) -> bool {
    let word = |w: &str| !w.is_empty() && w.chars().all(|c| c.is_ascii_uppercase());
    let reserved = ["DOCUMENT", "GRAMMAR", "SECTION", "DOCUMENT_FROM_FILE", "TEXT"];
    name.split('_').all(word) && !reserved.contains(&name)
}
