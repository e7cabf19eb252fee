//! Clocks of FMI 3.0.

use super::finding::Findings;
use super::model::{Declared, Model};
use super::rules::{
    CLOCK_CAUSALITY, CLOCK_EVENT_MODE, CLOCK_FRACTION, CLOCK_INTERVAL, CLOCK_PERIODIC,
    CLOCK_PRIORITY,
};
use octant_fmu_host::description::{Causality, ClockProperties, IntervalVariability, Variability};

/// Checks the clocks.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    let mut first = None;
    for declared in &model.variables {
        let Some(clock) = declared.variable.clock else { continue };
        first.get_or_insert(declared);
        let variable = declared.variable;
        if !matches!(variable.causality, Causality::Input | Causality::Output | Causality::Local)
            || !matches!(variable.variability, Variability::Discrete | Variability::Tunable)
        {
            let found =
                format!("{} and {}", variable.causality.name(), variable.variability.name());
            let expected = "input, output or local, and discrete or tunable";
            model.broken(findings, &CLOCK_CAUSALITY, declared, found, expected);
        }
        interval(model, declared, &clock, findings);
        if model.description.scheduled_execution.is_some()
            && variable.causality == Causality::Input
            && clock.priority.is_none()
        {
            let found = "an input clock without priority";
            model.broken(findings, &CLOCK_PRIORITY, declared, found, "a priority");
        }
    }
    let event_mode = model.description.co_simulation.as_ref().is_none_or(|cs| cs.event_mode);
    if let Some(declared) = first
        && !event_mode
    {
        let found = "a clock without hasEventMode";
        model.broken(findings, &CLOCK_EVENT_MODE, declared, found, "hasEventMode");
    }
}

fn interval(
    model: &Model<'_, '_>,
    declared: &Declared<'_, '_>,
    clock: &ClockProperties,
    findings: &mut Findings,
) {
    use IntervalVariability::{Constant, Countdown, Fixed, Triggered};
    let mut wrong = |rule, found: String, expected: &str| {
        model.broken(findings, rule, declared, found, expected);
    };
    if matches!(clock.interval_variability, Countdown | Triggered) {
        if clock.interval_s.is_some() || clock.interval_counter.is_some() {
            let found = "an interval of a clock that isn't periodic".to_owned();
            wrong(&CLOCK_PERIODIC, found, "none: it ticks when it wants");
        }
        return;
    }
    let needed = matches!(clock.interval_variability, Constant | Fixed);
    if let Some(interval) = clock.interval_s.filter(|&s| !(s > 0.0 && s.is_finite())) {
        wrong(&CLOCK_INTERVAL, format!("interval {interval} s"), "more than 0 s");
    } else if !(clock.shift_s >= 0.0 && clock.shift_s.is_finite()) {
        wrong(&CLOCK_INTERVAL, format!("shift {} s", clock.shift_s), "0 s or more");
    } else if needed && clock.interval_s.is_none() && clock.interval_counter.is_none() {
        wrong(&CLOCK_INTERVAL, "no interval".into(), "intervalDecimal or intervalCounter");
    }
    let counts = clock.interval_counter.is_some() || clock.shift_counter != 0;
    if counts && !clock.supports_fraction {
        wrong(&CLOCK_FRACTION, "counts without supportsFraction".into(), "supportsFraction");
    } else if counts && clock.resolution.is_none_or(|resolution| resolution == 0) {
        wrong(&CLOCK_FRACTION, "counts without resolution".into(), "counts in a second");
    } else if clock.interval_counter == Some(0) {
        wrong(&CLOCK_FRACTION, "intervalCounter 0".into(), "more than 0");
    }
}
