//! The known name that is nearest to an unknown one.

/// Known name most similar to `found`, if any is similar.
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

/// Text `did you mean "X"?`, if a name is similar, with the list of known names.
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
