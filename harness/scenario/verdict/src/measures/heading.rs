//! Measures of heading tests.

use super::need::MeasureNeed::{Heading, Truth};
use super::place::{DEG, Keys, Place, Unit, magnitude, over_latitude, signed, table, with};

const MINUTE: Unit = Unit::Named("min");

pub(super) const HEADING: Place = table(
    "heading test",
    &[Heading],
    &[
        ("settling_time_min", SETTLING_TIME),
        (
            "settle_point_heading_deg",
            magnitude(DEG, "settle point of the first run-up: mean of ten readings every 20 min"),
        ),
        ("settle_point_error_deg", POINT_ERROR),
        ("readings_rms_deg", READINGS_RMS),
        ("repeatability_deg", REPEATABILITY),
        ("in_motion", table("while the table moves", &[], IN_MOTION)),
        ("after_motion", table("after the table stopped", &[], AFTER_MOTION)),
        (
            "scorsby_error_deg",
            over_latitude(with(
                &[Truth],
                signed(
                    DEG,
                    "error of the first reading after the table's motion, against the settle point",
                ),
            )),
        ),
        (
            "dynamic_amplitude_deg",
            over_latitude(with(
                &[Truth],
                magnitude(DEG, "largest error while the table moves, against the settle point"),
            )),
        ),
        (
            "dynamic_frequency_hz",
            with(
                &[Truth],
                magnitude(
                    Unit::Named("Hz"),
                    "frequency of the largest component of that error where it is above 0.5 deg; else 0",
                ),
            ),
        ),
    ],
);

const SETTLING_TIME: Place = magnitude(
    MINUTE,
    "longest time from switching on to the third of three readings every 30 min within 0.7 deg",
);
const POINT_ERROR: Place = over_latitude(with(
    &[Truth],
    signed(DEG, "largest settle point error, settle point heading − true heading"),
));
const READINGS_RMS: Place = over_latitude(magnitude(
    DEG,
    "largest root mean square of the ten readings of a settle point about their mean",
));
const REPEATABILITY: Place =
    over_latitude(magnitude(DEG, "greatest difference of the settle points of any two run-ups"));

const IN_MOTION: Keys = &[
    ("settling_time_min", SETTLING_TIME),
    ("settle_point_error_deg", POINT_ERROR),
    ("readings_rms_deg", READINGS_RMS),
    ("repeatability_deg", REPEATABILITY),
];
const AFTER_MOTION: Keys =
    &[("settle_point_error_deg", POINT_ERROR), ("repeatability_deg", REPEATABILITY)];
