//! Reads a real table from `[turntable.drive]`.

use super::reader::Reader;
use crate::error::Problem;
use crate::model::{Drive, FileName, Scenario};
use octant_plant::config::Turntable;
use octant_turntable::{Axis, AxisLimits, Limits, Settings};
use std::time::Duration;

/// Reads `[turntable.drive]`.
pub(super) fn drive(turntable: &Reader<'_>, moves: &Turntable) -> Result<Option<Drive>, Problem> {
    let Some(table) = turntable.optional_table("drive") else { return Ok(None) };
    let port = table.text("port")?;
    octant_turntable::check_port(port).map_err(|error| table.problem("port", error.to_string()))?;
    let time = |key: &str| table.si(key).map(Duration::from_secs_f64);
    let some = |key: &str| time(key).map(|time| (!time.is_zero()).then_some(time));
    let limits = |axis: Axis| -> Result<AxisLimits, Problem> {
        let [least_rad, most_rad] = table.si_array(axis.name())?;
        let limits = AxisLimits {
            least_rad,
            most_rad,
            rate_radps: moves.rate_radps,
            acceleration_radps2: moves.acceleration_radps2,
        };
        let both = Limits { axes: [limits; 2] };
        if both.check().is_err() || both.angle(axis, 0.0).is_err() {
            let found = table.texts(axis.name()).join(" to ");
            let message = format!(
                "found {found}, expected a least and a greatest angle with zero between them, where \
                 every run begins"
            );
            return Err(table.problem(axis.name(), message));
        }
        Ok(limits)
    };
    let settings = Settings {
        limits: Limits { axes: [limits(Axis::Azimuth)?, limits(Axis::Roll)?] },
        reply_within: time("reply")?,
        watchdog: some("watchdog")?,
    };
    let drive = Drive {
        port: port.to_owned(),
        dialect: FileName(table.text("dialect")?.to_owned()),
        settings,
        look: time("look")?,
        oldest: time("oldest")?,
        guard: some("guard")?,
        home: table.boolean("home")?,
        start: time("start")?,
        tolerance_rad: table.si("tolerance")?,
    };
    // Guard and watchdog hear from the harness once a look, and a look can take as long as a reply.
    let shortest = drive.look + settings.reply_within;
    for (key, silence) in [("guard", drive.guard), ("watchdog", settings.watchdog)] {
        if silence.is_some_and(|silence| silence < shortest) {
            let found = table.text(key)?;
            let message = format!(
                "found {found:?}, expected no less than look and reply together, {shortest:?}: it \
                 would stop a table that is well"
            );
            return Err(table.problem(key, message));
        }
    }
    Ok(Some(drive))
}

/// Checks that the procedure stays within the limits of the table.
pub(super) fn check_reach(root: &Reader<'_>, scenario: &Scenario) -> Result<(), Problem> {
    let Some(drive) = &scenario.drive else { return Ok(()) };
    let table = root.table("turntable")?.table("drive")?;
    let calibration = scenario.calibration.iter().chain(&scenario.baseline);
    let sequences = (calibration.map(|calibration| ("calibration", &calibration.sequence)))
        .chain(scenario.navigation.iter().map(|navigation| ("navigation", &navigation.rotation)));
    for (phase, sequence) in sequences {
        for (number, stop) in (1..).zip(sequence.stops()) {
            for (axis, angle_rad) in
                [(Axis::Azimuth, stop.azimuth_rad), (Axis::Roll, stop.roll_rad)]
            {
                // A set point is a whole count: up to half a count beyond the limit still keeps it.
                let slack = if angle_rad < 0.0 { 1e-8 } else { -1e-8 };
                if drive.settings.limits.angle(axis, angle_rad + slack).is_err() {
                    let message = format!(
                        "found {}, but stop {number} of the {phase} is at {:.4} deg",
                        table.texts(axis.name()).join(" to "),
                        angle_rad.to_degrees(),
                    );
                    return Err(table.problem(axis.name(), message));
                }
            }
        }
    }
    Ok(())
}
