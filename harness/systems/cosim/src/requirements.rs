//! Requirements on signals of a system: limits on the largest, smallest or last value that a recorded
//! number has at the communication points.

use super::convert::WireUnit;
use super::faults::in_unit_of;
use super::values::number_of;
use octant_base::names::suggestion;
use octant_faults::catalogue::Takes;
use octant_fmu_host::description::VariableType;
use octant_fmu_host::instance::whole;
use octant_scenario::{FileProblems, Given, Problem, SystemRequirement};
use octant_score::verdict::RequirementResult;
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};

/// Beginning of every measure.
const START: &str = "signal.";

/// Value of a signal that is required.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SignalValue {
    Max,
    Min,
    Final,
}

/// A signal that can be required.
#[derive(Clone, Debug)]
pub struct NamedSignal {
    /// Name: FMU and variable.
    pub name: String,
    /// Unit, if it has one.
    pub unit: Option<WireUnit>,
    /// Type.
    pub kind: VariableType,
}

/// Requirements of a run, with the values of their signals so far.
#[derive(Debug, Default)]
pub struct Requiring {
    all: Vec<Required>,
}

#[derive(Debug)]
struct Required {
    check: LimitCheck,
    /// Place of the signal among the recorded numbers.
    place: usize,
    kind: VariableType,
    value: SignalValue,
    magnitude: bool,
    /// Value so far.
    found: Option<f64>,
    /// Time at which the signal was no number, s.
    nan_s: Option<f64>,
}

impl Requiring {
    /// Finds the signals of requirements; `file` names their file in errors.
    ///
    /// # Errors
    /// If a measure is none of a signal, or a limit has another unit.
    pub fn new(
        requirements: &[SystemRequirement],
        file: &str,
        signals: &[NamedSignal],
    ) -> Result<Self, FileProblems> {
        let all = requirements.iter().map(|one| required(one, signals));
        let all = all.collect::<Result<_, Problem>>();
        all.map(|all| Self { all })
            .map_err(|problem| FileProblems { file: file.to_owned(), problems: vec![problem] })
    }

    /// True if nothing is required.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Takes the recorded numbers of a communication point, as they are exchanged.
    pub fn look(&mut self, time_s: f64, numbers: &[f64]) {
        for one in &mut self.all {
            let Some(&number) = numbers.get(one.place) else { continue };
            let Some(number) = number_of(one.kind, number).filter(|number| !number.is_nan()) else {
                one.nan_s.get_or_insert(time_s);
                continue;
            };
            one.found = Some(match (one.value, one.found) {
                (SignalValue::Max, Some(found)) => found.max(number),
                (SignalValue::Min, Some(found)) => found.min(number),
                _ => number,
            });
        }
    }

    /// Compares the values with their limits. A signal that wasn't a number at some point shows
    /// nothing, and a run that isn't whole only what the rest of it could not change.
    #[must_use]
    pub fn results(&self, is_whole: bool) -> Vec<RequirementResult> {
        self.all.iter().map(|one| one.result(is_whole)).collect()
    }
}

impl Required {
    /// True if a limit that is broken stays broken, whatever the signal does afterwards.
    fn stays_broken(&self) -> bool {
        match (self.value, self.check.comparison) {
            (SignalValue::Max, Comparison::AtMost | Comparison::Below) => !self.magnitude,
            (SignalValue::Min, Comparison::AtLeast | Comparison::Above) => !self.magnitude,
            _ => false,
        }
    }

    fn result(&self, is_whole: bool) -> RequirementResult {
        let LimitCheck { id, measure, comparison, limit, secant_latitude: _ } = self.check.clone();
        let found = self.found.map(|value| if self.magnitude { value.abs() } else { value });
        let (value, reason) = match (self.nan_s, found) {
            (Some(nan_s), _) if whole::is_wide(self.kind) => {
                let reason =
                    format!("{measure}: it is beyond 2^53 at {nan_s} s, where limits aren't exact");
                (None, Some(reason))
            }
            (Some(nan_s), _) => (None, Some(format!("{measure}: it isn't a number at {nan_s} s"))),
            (None, None) => (None, Some(format!("{measure}: there is no value"))),
            (None, value) => (value, None),
        };
        let verdict = match value.map(|value| comparison.holds(value, limit)) {
            None => Verdict::Inconclusive,
            Some(false) if is_whole || self.stays_broken() => Verdict::Fail,
            Some(true) if is_whole => Verdict::Pass,
            Some(_) => Verdict::Inconclusive,
        };
        let early = || format!("{measure}: the run ended before its stop");
        let reason = reason.or_else(|| (verdict == Verdict::Inconclusive).then(early));
        let margin = value.map(|value| Comparison::margin(comparison, value, limit));
        let uncertainty = None;
        RequirementResult {
            id,
            measure,
            comparison,
            limit,
            at_equator: None,
            value,
            margin,
            uncertainty,
            verdict,
            reason,
        }
    }
}

fn required(one: &SystemRequirement, signals: &[NamedSignal]) -> Result<Required, Problem> {
    let bare = one.measure.strip_prefix('|').and_then(|rest| rest.strip_suffix('|'));
    let (path, magnitude) = (bare.unwrap_or(&one.measure), bare.is_some());
    let parts = path.strip_prefix(START).and_then(|rest| rest.rsplit_once('.'));
    let value = parts.and_then(|(_, value)| match value {
        "max" => Some(SignalValue::Max),
        "min" => Some(SignalValue::Min),
        "final" => Some(SignalValue::Final),
        _ => None,
    });
    let (Some((name, _)), Some(value)) = (parts, value) else {
        return Err(one.measure_problem(format!(
            "found {:?}, expected signal.NAME.max, signal.NAME.min or signal.NAME.final, with NAME as \
             in the recording",
            one.measure
        )));
    };
    let Some(place) = signals.iter().position(|signal| signal.name == name) else {
        let names = signals.iter().map(|signal| signal.name.as_str());
        return Err(one.measure_problem(format!(
            "found {:?}, and the system has no signal {name:?}, {}",
            one.measure,
            suggestion(name, names, "signals")
        )));
    };
    let limit = match &one.limit {
        Given::Number(number) => *number,
        Given::Text(text) => in_unit_of(text, signals[place].unit.as_ref(), Takes::Value)
            .map_err(|message| one.limit_problem(format!("found {text:?}, {message}")))?,
        Given::Flag(flag) => {
            return Err(one.limit_problem(format!("found {flag}, expected a number")));
        }
    };
    if !limit.is_finite() {
        return Err(one.limit_problem(format!("found {limit}, expected a finite number")));
    }
    Ok(Required {
        check: LimitCheck {
            id: one.id.clone(),
            measure: one.measure.clone(),
            comparison: one.comparison,
            limit,
            secant_latitude: false,
        },
        place,
        kind: signals[place].kind,
        value,
        magnitude,
        found: None,
        nan_s: None,
    })
}
