//! Reads a real table from `[turntable.drive]`.

use crate::error::Problem;
use crate::keys::{At, DriveKeys};
use crate::model::{Drive, FileName, Scenario, SourceSpec};
use octant_plant::config::TurntableConfig;
use octant_turntable::{AxisLimits, DriverSettings, TableAxis, TableLimits};
use std::time::Duration;

/// Reads `[turntable.drive]`.
pub(super) fn drive(keys: &DriveKeys, moves: &TurntableConfig) -> Result<Drive, Problem> {
    octant_turntable::check_port(&keys.port)
        .map_err(|error| keys.port.problem(error.to_string()))?;
    let time = Duration::from_secs_f64;
    let some = |time_s: f64| Some(time(time_s)).filter(|time| !time.is_zero());
    let limits = |axis: TableAxis| -> Result<AxisLimits, Problem> {
        let range = range(keys, axis);
        let [least_rad, most_rad] = **range;
        let limits = AxisLimits {
            least_rad,
            most_rad,
            rate_radps: moves.rate_radps,
            acceleration_radps2: moves.acceleration_radps2,
        };
        let both = TableLimits { axes: [limits; 2] };
        if both.check().is_err() || both.angle(axis, 0.0).is_err() {
            return Err(range.problem(format!(
                "found {}, expected a least and a greatest angle with zero between them, where \
                 every run begins",
                range.text
            )));
        }
        Ok(limits)
    };
    let settings = DriverSettings {
        limits: TableLimits { axes: [limits(TableAxis::Azimuth)?, limits(TableAxis::Roll)?] },
        reply_within: time(keys.reply),
        watchdog: some(*keys.watchdog),
    };
    let drive = Drive {
        port: keys.port.to_string(),
        driver: keys.driver,
        units: keys.units as usize,
        dialect: FileName(keys.dialect.clone()),
        settings,
        look: time(keys.look),
        oldest: time(keys.oldest),
        guard: some(*keys.guard),
        home: keys.home,
        start: time(keys.start),
        tolerance_rad: keys.tolerance,
    };
    // Guard and watchdog hear from the harness once a look, and a look can take as long as a reply.
    let shortest = drive.look + settings.reply_within;
    for (key, silence) in [(&keys.guard, drive.guard), (&keys.watchdog, settings.watchdog)] {
        if silence.is_some_and(|silence| silence < shortest) {
            return Err(key.problem(format!(
                "found {:?}, expected no less than look and reply together, {shortest:?}: it \
                 would stop a table that is well",
                key.text
            )));
        }
    }
    Ok(drive)
}

fn range(keys: &DriveKeys, axis: TableAxis) -> &At<[f64; 2]> {
    match axis {
        TableAxis::Azimuth => &keys.azimuth,
        TableAxis::Roll => &keys.roll,
    }
}

/// Checks that the procedure stays within the limits of the table.
pub(super) fn check_reach(keys: &DriveKeys, scenario: &Scenario) -> Result<(), Problem> {
    let Some(drive) = &scenario.drive else { return Ok(()) };
    if let SourceSpec::Solution(spec) = &scenario.source {
        // The table is turned to the angles of its run-ups alone.
        let beyond = |angle_rad: &&f64| {
            drive.settings.limits.angle(TableAxis::Azimuth, **angle_rad).is_err()
        };
        let Some(angle_rad) = spec.run_ups.azimuths_rad.iter().find(beyond) else { return Ok(()) };
        let range = range(keys, TableAxis::Azimuth);
        return Err(range.problem(format!(
            "found {}, but procedure.heading_test.azimuths has {:.4} deg",
            range.text,
            angle_rad.to_degrees()
        )));
    }
    let calibration = scenario.calibration.iter().chain(&scenario.baseline);
    let sequences = (calibration.map(|calibration| ("calibration", &calibration.sequence)))
        .chain(scenario.navigation.iter().map(|navigation| ("navigation", &navigation.rotation)));
    for (phase, sequence) in sequences {
        for (number, stop) in (1..).zip(sequence.stops()) {
            for (axis, angle_rad) in
                [(TableAxis::Azimuth, stop.azimuth_rad), (TableAxis::Roll, stop.roll_rad)]
            {
                // A set point is a whole count: up to half a count beyond the limit still keeps it.
                let slack = if angle_rad < 0.0 { 1e-8 } else { -1e-8 };
                if drive.settings.limits.angle(axis, angle_rad + slack).is_err() {
                    let range = range(keys, axis);
                    return Err(range.problem(format!(
                        "found {}, but stop {number} of the {phase} is at {:.4} deg",
                        range.text,
                        angle_rad.to_degrees(),
                    )));
                }
            }
        }
    }
    Ok(())
}
