//! The known name that is nearest to one that isn't known.

/// The name most like `found` among `known`, if any is like it.
#[must_use]
pub fn nearest<'a>(found: &str, known: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    let contained = known.clone().find(|name| name.starts_with(found) && found.len() > 2);
    known
        .map(|name| (strsim::jaro_winkler(found, name), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
        .or(contained)
}

/// `did you mean X?` and the list of what is known.
#[must_use]
pub fn suggestion<'a>(
    found: &str,
    known: impl Iterator<Item = &'a str> + Clone,
    what: &str,
) -> String {
    let list = known.clone().collect::<Vec<_>>().join(", ");
    match nearest(found, known) {
        Some(name) => format!("did you mean \"{name}\"? {what}: {list}"),
        None => format!("{what}: {list}"),
    }
}
