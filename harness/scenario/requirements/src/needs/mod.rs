//! `needs.json` of sphinx-needs: the file that `needimport` reads and the builder `needs` writes.
//!
//! `content` is the text, `links` and other fields of links are parents, `parent_needs` is the requirement
//! that another stands below, and `sections` are the sections from the innermost. Octant's keys are extra
//! fields by their own names. The JSON schema in the file has the types of extra fields.
//!
//! Texts of sphinx-needs are reStructuredText. A document whose texts are plain is written with the
//! necessary escapes and says so, for the way back.

mod json;
mod read;
mod schema;
mod write;

pub use read::read;
pub use write::write;

/// Version of the format of the file.
const FORMAT: u64 = 1;
/// Key of a version whose texts were escaped by this program.
const ESCAPED: &str = "octant_escaped";
/// Type of a plain requirement.
const REQ: &str = "req";
const LINKS: &str = "links";
const PARENT_NEEDS: &str = "parent_needs";
/// Key of the head of a document for the version.
const VERSION: &str = "VERSION";

/// Fields that sphinx-needs computes, and doesn't import.
const COMPUTED: [&str; 27] = [
    "docname",
    "lineno",
    "lineno_content",
    "is_import",
    "is_external",
    "external_url",
    "external_css",
    "type_name",
    "type_prefix",
    "type_color",
    "type_style",
    "is_modified",
    "modifications",
    "is_need",
    "is_part",
    "id_parent",
    "id_complete",
    "pre_content",
    "post_content",
    "has_dead_links",
    "has_forbidden_dead_links",
    "constraints_results",
    "constraints_passed",
    "constraints_error",
    "section_name",
    "parent_need",
    "jinja_content",
];
/// Fields of a need that are no attributes.
const CORE: [&str; 4] = ["id", "type", "sections", "doctype"];
/// Fields that are lists, even of one entry.
const LISTS: [&str; 2] = ["tags", "constraints"];
/// Types of needs that require nothing.
const NO_REQUIREMENTS: [&str; 4] = ["impl", "test", "test_case", "testcase"];
