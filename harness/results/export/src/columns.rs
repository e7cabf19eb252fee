//! Columns of every table. A name ends in its unit; angles are in degrees, errors of position and attitude in
//! arcminutes, parameters in the units of the reports.

use super::table::CellKind::{Boolean, Integer, Number, Text};
use super::table::{CellKind, Column, Table};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};

/// Columns of a table, in the order of the cells of its rows.
#[must_use]
pub fn columns(table: Table) -> Vec<Column> {
    let mut all = fixed(&[("time_s", "s", Number, "run time: simulated time since the start")]);
    match table {
        Table::Navigation => {
            all.extend(fixed(&NAVIGATION));
            all.extend(fixed(&TRUTH));
            all.extend(fixed(&ERRORS));
        }
        Table::Samples => {
            all.extend(sample("", "reached the core"));
            all.extend(sample("clean_", "of the source, where another or none reached the core"));
        }
        Table::Aiding => all.extend(fixed(&AIDING)),
        Table::Parameters => all.extend(parameters()),
        Table::Innovations => all.extend(fixed(&INNOVATIONS)),
        Table::Faults => all.extend(fixed(&FAULTS)),
        Table::Events => all.extend(fixed(&EVENTS)),
    }
    all
}

type Fixed = (&'static str, &'static str, CellKind, &'static str);

fn fixed(columns: &[Fixed]) -> Vec<Column> {
    let one = |&(name, unit, kind, text): &Fixed| Column::new(name, unit, kind, text);
    columns.iter().map(one).collect()
}

const NAVIGATION: [Fixed; 24] = [
    ("sequence", "", Integer, "number of the sample that the output answers"),
    ("mode", "", Integer, "0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done"),
    ("stop", "", Integer, "stop of the sequence, from 0, over all passes"),
    ("moving", "", Boolean, "gimbals on their way to the stop"),
    ("latitude_deg", "deg", Number, "geodetic latitude"),
    ("longitude_deg", "deg", Number, "longitude, not wrapped"),
    ("height_m", "m", Number, "height above the ellipsoid"),
    ("velocity_north_mps", "m/s", Number, "velocity over ground, north"),
    ("velocity_east_mps", "m/s", Number, "velocity over ground, east"),
    ("velocity_down_mps", "m/s", Number, "velocity over ground, down"),
    ("q_nb_w", "", Number, "attitude q_nb, which takes a vector in b into n: scalar part"),
    ("q_nb_x", "", Number, "attitude q_nb, x"),
    ("q_nb_y", "", Number, "attitude q_nb, y"),
    ("q_nb_z", "", Number, "attitude q_nb, z"),
    ("roll_deg", "deg", Number, "roll of the case c, from q_nb and the encoders"),
    ("pitch_deg", "deg", Number, "pitch of the case c, positive with the bow up"),
    ("heading_deg", "deg", Number, "heading of the case c from north by east, 0 to 360"),
    ("gimbal_azimuth_deg", "deg", Number, "inner gimbal by its encoder, cumulative"),
    ("gimbal_roll_deg", "deg", Number, "outer gimbal by its encoder, cumulative"),
    ("command_azimuth_deg", "deg", Number, "set point of the inner gimbal"),
    ("command_roll_deg", "deg", Number, "set point of the outer gimbal"),
    ("nis", "", Number, "normalized innovation squared of three axes; empty without a measurement"),
    ("health", "", Integer, "bits of the core's health, as in the recording"),
    ("parameters_revision", "", Integer, "number of changes of the parameters so far"),
];

const TRUTH: [Fixed; 12] = [
    ("true_latitude_deg", "deg", Number, "true geodetic latitude"),
    ("true_longitude_deg", "deg", Number, "true longitude"),
    ("true_height_m", "m", Number, "true height above the ellipsoid"),
    ("true_velocity_north_mps", "m/s", Number, "true velocity over ground, north"),
    ("true_velocity_east_mps", "m/s", Number, "true velocity over ground, east"),
    ("true_velocity_down_mps", "m/s", Number, "true velocity over ground, down"),
    ("true_q_nb_w", "", Number, "true attitude q_nb, scalar part"),
    ("true_q_nb_x", "", Number, "true attitude q_nb, x"),
    ("true_q_nb_y", "", Number, "true attitude q_nb, y"),
    ("true_q_nb_z", "", Number, "true attitude q_nb, z"),
    ("true_gimbal_azimuth_deg", "deg", Number, "inner gimbal, without encoder error"),
    ("true_gimbal_roll_deg", "deg", Number, "outer gimbal, without encoder error"),
];

const ERRORS: [Fixed; 10] = [
    (
        "latitude_error_arcmin",
        "arcmin",
        Number,
        "navigation minus truth, while the core calibrates or navigates, and at the end",
    ),
    ("longitude_error_arcmin", "arcmin", Number, "navigation minus truth"),
    ("radial_error_nmi", "nmi", Number, "horizontal distance between navigation and truth"),
    ("height_error_m", "m", Number, "navigation minus truth"),
    ("velocity_north_error_mps", "m/s", Number, "navigation minus truth"),
    ("velocity_east_error_mps", "m/s", Number, "navigation minus truth"),
    ("velocity_down_error_mps", "m/s", Number, "navigation minus truth"),
    (
        "attitude_north_error_arcmin",
        "arcmin",
        Number,
        "rotation vector in n that turns the true attitude into the estimated one, north",
    ),
    ("attitude_east_error_arcmin", "arcmin", Number, "the same, east"),
    ("attitude_down_error_arcmin", "arcmin", Number, "the same, down: the error of heading"),
];

const AIDING: [Fixed; 7] = [
    ("kind", "", Integer, "0 velocity, 1 position"),
    ("velocity_north_mps", "m/s", Number, "measured velocity over ground, north"),
    ("velocity_east_mps", "m/s", Number, "measured velocity over ground, east"),
    ("velocity_down_mps", "m/s", Number, "measured velocity over ground, down"),
    ("latitude_deg", "deg", Number, "measured geodetic latitude"),
    ("longitude_deg", "deg", Number, "measured longitude"),
    ("height_m", "m", Number, "measured height above the ellipsoid"),
];

const INNOVATIONS: [Fixed; 16] = [
    ("sequence", "", Integer, "number of the sample with the measurement"),
    ("mode", "", Integer, "0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done"),
    ("nis", "", Number, "normalized innovation squared of three axes, expected 3"),
    ("rejected", "", Boolean, "rejected by the innovation gate"),
    ("velocity_north_innovation_mps", "m/s", Number, "velocity north: computed minus reference"),
    ("velocity_east_innovation_mps", "m/s", Number, "velocity east: computed minus reference"),
    ("velocity_down_innovation_mps", "m/s", Number, "velocity down: computed minus reference"),
    (
        "velocity_north_sigma_mps",
        "m/s",
        Number,
        "velocity north: expected standard deviation of the innovation",
    ),
    (
        "velocity_east_sigma_mps",
        "m/s",
        Number,
        "velocity east: expected standard deviation of the innovation",
    ),
    (
        "velocity_down_sigma_mps",
        "m/s",
        Number,
        "velocity down: expected standard deviation of the innovation",
    ),
    ("position_north_innovation_m", "m", Number, "position north: computed minus reference"),
    ("position_east_innovation_m", "m", Number, "position east: computed minus reference"),
    ("position_down_innovation_m", "m", Number, "position down: computed minus reference"),
    (
        "position_north_sigma_m",
        "m",
        Number,
        "position north: expected standard deviation of the innovation",
    ),
    (
        "position_east_sigma_m",
        "m",
        Number,
        "position east: expected standard deviation of the innovation",
    ),
    (
        "position_down_sigma_m",
        "m",
        Number,
        "position down: expected standard deviation of the innovation",
    ),
];

const FAULTS: [Fixed; 4] = [
    ("id", "", Text, "id in the scenario"),
    ("kind", "", Text, "kind of the fault"),
    ("begins", "", Boolean, "true for an onset, false for an end"),
    ("sample", "", Integer, "number of the step, from 1"),
];

const EVENTS: [Fixed; 2] = [
    ("kind", "", Text, "kind of the event, as in the recording"),
    ("detail", "", Text, "details as JSON"),
];

fn sample(prefix: &str, words: &str) -> Vec<Column> {
    let mut all = vec![
        Column::new(
            format!("{prefix}sequence"),
            "",
            Integer,
            format!("number of the sample that {words}, from 1"),
        ),
        Column::new(
            format!("{prefix}device_time_s"),
            "s",
            Number,
            format!("stamp of the sample {words}: end of its interval"),
        ),
    ];
    for (quantity, unit, suffix, about) in [
        ("delta_theta", "rad", "rad", "integral of the angular rate over the interval, body axis"),
        ("delta_velocity", "m/s", "mps", "integral of the specific force, body axis"),
    ] {
        for axis in ["x", "y", "z"] {
            all.push(Column::new(
                format!("{prefix}{quantity}_{axis}_{suffix}"),
                unit,
                Number,
                format!("{about} {axis}"),
            ));
        }
    }
    for (gimbal, about) in [("azimuth", "inner gimbal"), ("roll", "outer gimbal")] {
        all.push(Column::new(
            format!("{prefix}gimbal_{gimbal}_deg"),
            "deg",
            Number,
            format!("{about} by its encoder, cumulative"),
        ));
    }
    all.push(Column::new(
        format!("{prefix}status"),
        "",
        Integer,
        "bits: 0 gyro saturated, 1 accelerometer saturated, 2 gimbal invalid, 3 inertial invalid",
    ));
    all
}

/// Suffix of a column's name for the unit of a group of parameters.
#[must_use]
pub const fn parameter_suffix(group: ParameterGroup) -> &'static str {
    match group {
        ParameterGroup::GyroBias => "dph",
        ParameterGroup::GyroScale | ParameterGroup::AccelScale => "ppm",
        ParameterGroup::GyroMisalignment | ParameterGroup::AccelMisalignment => "arcsec",
        ParameterGroup::GDependent => "dph_per_g",
        ParameterGroup::AccelBias => "ug",
    }
}

fn parameters() -> Vec<Column> {
    let mut all = vec![
        Column::new("sequence", "", Integer, "number of the sample that they belong to"),
        Column::new("revision", "", Integer, "number of changes of the parameters so far"),
    ];
    for (prefix, about) in [
        ("", "estimate of the error, measured minus true"),
        ("sigma_", "1σ of the estimate, empty where it isn't estimated"),
        ("error_", "estimate minus the true value of the scenario"),
    ] {
        for (i, name) in NAMES.iter().enumerate().take(PARAMETER_COUNT) {
            let group = ParameterGroup::of(i);
            all.push(Column::new(
                format!("{prefix}{name}_{}", parameter_suffix(group)),
                group.unit(),
                Number,
                about,
            ));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_end_in_their_unit() {
        for table in Table::ALL {
            let columns = columns(table);
            let names: BTreeSet<&str> = columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names.len(), columns.len(), "{}", table.name());
            for column in &columns {
                let suffix = match column.unit {
                    "" => continue,
                    "m/s" => "mps",
                    "deg/h" => "dph",
                    "deg/h/g" => "dph_per_g",
                    unit => unit,
                };
                assert!(column.name.ends_with(&format!("_{suffix}")), "{}", column.name);
                assert!(column.kind == CellKind::Number, "{}", column.name);
            }
        }
    }
}
