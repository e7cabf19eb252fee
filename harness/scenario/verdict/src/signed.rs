//! Signs of measures: a limit on only one side of a measure with a sign lets any value on the other side pass, and a
//! lower limit of zero on a magnitude lets every value pass.

use crate::measures::is_signed;
use crate::verdict::Comparison;

/// Finds a limit on only one side of a measure that has a sign, and returns the error text; `None` if
/// there is no error. `all` are the limits set together with it: one on the other side makes the pair
/// complete.
#[must_use]
pub fn one_sided<'a>(
    (measure, comparison): (&str, Comparison),
    all: impl IntoIterator<Item = (&'a str, Comparison)>,
) -> Option<String> {
    let is_upper = |comparison| matches!(comparison, Comparison::AtMost | Comparison::Below);
    if measure.starts_with('|') || !is_signed(measure) {
        return None;
    }
    let other_side = |(other, against): (&str, Comparison)| {
        other == measure && is_upper(against) != is_upper(comparison)
    };
    if all.into_iter().any(other_side) {
        return None;
    }
    let (sign, other) = (comparison.sign(), if is_upper(comparison) { ">=" } else { "<=" });
    Some(format!(
        "found {measure:?} with {sign} alone: it has a sign, and on the other side any value would pass; expected \
         \"|{measure}|\" for its magnitude, or a second requirement with {other} for the other side"
    ))
}

/// Finds a limit that a magnitude can't break, and returns the error text; `None` if there is no error.
#[must_use]
pub fn unbreakable((measure, comparison): (&str, Comparison), limit: f64) -> Option<String> {
    let any_value = match comparison {
        Comparison::AtLeast => limit <= 0.0,
        Comparison::Above => limit < 0.0,
        Comparison::AtMost | Comparison::Below => false,
    };
    let is_magnitude = measure.starts_with('|') || !is_signed(measure);
    (any_value && is_magnitude).then(|| {
        format!(
            "found {measure:?} {} {limit}: it is never negative, and every value would pass; expected a limit above 0",
            comparison.sign()
        )
    })
}
