//! Measures with a sign: a limit on only one side of them lets any value on the other side pass.

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
