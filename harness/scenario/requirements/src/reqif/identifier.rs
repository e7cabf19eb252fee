//! Identifiers of ReqIF objects.

use octant_verdict::requirement::Requirement;

/// Makes an identifier from the id for people: letters, digits, `-` and `.` stay, other characters
/// become their number.
pub(super) fn identifier(id: &str) -> String {
    let mut out = String::from("octant-");
    for c in id.chars() {
        match c {
            c if c.is_ascii_alphanumeric() || c == '-' || c == '.' => out.push(c),
            c => out.push_str(&format!("_{:x}_", u32::from(c))),
        }
    }
    out
}

pub(super) fn object_id(requirement: &Requirement) -> String {
    requirement.identifier.clone().unwrap_or_else(|| identifier(&requirement.id))
}

/// True for an NCName, the form of an identifier in XML.
pub(super) fn legal(id: &str) -> bool {
    let first = |c: char| c.is_alphabetic() || c == '_';
    id.starts_with(first) && id.chars().all(|c| first(c) || c.is_numeric() || "-.".contains(c))
}
