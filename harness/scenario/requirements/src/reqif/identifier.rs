//! Identifiers of ReqIF objects.

use octant_verdict::requirement::Requirement;

/// Makes an identifier from the id for people: letters, digits, `-` and `.` stay, other characters
/// become their number.
pub(super) fn identifier(id: &str) -> String {
    encoded("octant-", id)
}

/// Beginning of an identifier that stands for one which XML doesn't take, as a MID that begins with a digit.
const ENCODED: &str = "octant_id-";

fn encoded(prefix: &str, id: &str) -> String {
    let mut out = String::from(prefix);
    for c in id.chars() {
        match c {
            c if c.is_ascii_alphanumeric() || c == '-' || c == '.' => out.push(c),
            c => out.push_str(&format!("_{:x}_", u32::from(c))),
        }
    }
    out
}

pub(super) fn object_id(requirement: &Requirement) -> String {
    match &requirement.identifier {
        None => identifier(&requirement.id),
        Some(own) if legal(own) && !own.starts_with(ENCODED) => own.clone(),
        Some(own) => encoded(ENCODED, own),
    }
}

/// Identifier that one of a file stands for: itself, but for those that [`object_id`] made.
pub(super) fn decoded(id: &str) -> String {
    let Some(rest) = id.strip_prefix(ENCODED) else { return id.to_owned() };
    let mut out = String::new();
    let mut parts = rest.split('_');
    out.push_str(parts.next().unwrap_or_default());
    while let (Some(code), Some(text)) = (parts.next(), parts.next()) {
        let Some(c) = u32::from_str_radix(code, 16).ok().and_then(char::from_u32) else {
            return id.to_owned();
        };
        out.push(c);
        out.push_str(text);
    }
    out
}

/// True for an NCName, the form of an identifier in XML.
pub(super) fn legal(id: &str) -> bool {
    let first = |c: char| c.is_alphabetic() || c == '_';
    id.starts_with(first) && id.chars().all(|c| first(c) || c.is_numeric() || "-.".contains(c))
}
