//! Requirements without which a unit can pass that doesn't do its work, where a set lacks them.

/// Kind of requirement that a set can lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unasked {
    /// Example of a measure.
    pub measure: &'static str,
    /// Unit that passes without it, in words.
    pub passes: &'static str,
}

/// A kind, and whether a measure (without bars) is of it.
type Kind = (Unasked, fn(&str) -> bool);

const KINDS: [Kind; 3] = [
    (
        Unasked {
            measure: "calibration.worst_normalized_error",
            passes: "errors far beyond the standard deviations that the unit states",
        },
        |measure| {
            measure == "calibration.worst_normalized_error"
                || measure.starts_with("calibration.nees.")
                || measure.ends_with(".normalized")
        },
    ),
    (
        Unasked {
            measure: "calibration.least_gain",
            passes: "a calibration that leaves the parameters as uncertain as they were",
        },
        |measure| {
            measure == "calibration.least_gain"
                || (measure.starts_with("calibration.")
                    && (measure.ends_with(".gain") || measure.ends_with(".sigma")))
        },
    ),
    (Unasked { measure: "false_alarms", passes: "alarms without a fault" }, |measure| {
        matches!(measure, "false_alarms" | "counterfactual.false_alarms")
            || measure.starts_with("calibration.health.")
    }),
];

/// Lists the kinds that no measure of a set is of: none for a set without a measure of a calibration or a navigation.
pub fn unasked<'a>(measures: impl Iterator<Item = &'a str> + Clone) -> Vec<Unasked> {
    let measures = measures.map(|measure| measure.trim_matches('|'));
    let of_work =
        |measure: &str| measure.starts_with("calibration.") || measure.starts_with("navigation.");
    if !measures.clone().any(of_work) {
        return Vec::new();
    }
    let lacks = |is_one: fn(&str) -> bool| !measures.clone().any(is_one);
    KINDS.into_iter().filter(|(_, is_one)| lacks(*is_one)).map(|(kind, _)| kind).collect()
}

impl Unasked {
    /// Says what is lacking.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!("no requirement of the kind of {}: {} would pass", self.measure, self.passes)
    }
}
