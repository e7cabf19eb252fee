//! Measures of one method: alignment, calibration, navigation.

use super::need::MeasureNeed::{
    Calibration, Day, Further, Navigation, SchulerPeriod, Sigma, ThreeDays, Truth,
};
use super::place::{
    ARCMIN, DEG, HOUR, Keys, MPS, NMI, Names, Place, SECOND, Unit, count, magnitude, signed, table,
    with,
};

pub(super) const ALIGNMENT: Place = table(
    "alignment",
    &[],
    &[
        ("duration_s", magnitude(SECOND, "time to the first answer with an attitude")),
        ("solution", table("at its end", &[], SOLUTION)),
    ],
);

/// Solution at one time.
const SOLUTION: Keys = &[
    ("heading_deg", signed(DEG, "heading of the case, clockwise from north")),
    ("pitch_deg", signed(DEG, "pitch of the case, bow up")),
    ("roll_deg", signed(DEG, "roll of the case, starboard down")),
    ("heading_arcmin", table("heading", &[], POINT_ARCMIN)),
    ("pitch_arcmin", table("pitch", &[], POINT_ARCMIN)),
    ("roll_arcmin", table("roll", &[], POINT_ARCMIN)),
    ("velocity_north_mps", table("velocity north", &[], POINT_MPS)),
    ("velocity_east_mps", table("velocity east", &[], POINT_MPS)),
];

const POINT_ARCMIN: Keys = &[
    ("error", with(&[Truth], signed(ARCMIN, "error, computed − true"))),
    ("sigma", with(&[Sigma], magnitude(ARCMIN, "standard deviation of the filter"))),
    ("normalized", with(&[Truth, Sigma], signed(Unit::Sigma, "error over standard deviation"))),
];
const POINT_MPS: Keys = &[
    ("error", with(&[Truth], signed(MPS, "error, computed − true"))),
    ("sigma", with(&[Sigma], magnitude(MPS, "standard deviation of the filter"))),
    ("normalized", with(&[Truth, Sigma], signed(Unit::Sigma, "error over standard deviation"))),
];

pub(super) const CALIBRATION: Place = table(
    "calibration",
    &[Calibration],
    &[
        ("duration_h", magnitude(HOUR, "duration")),
        ("solution", table("at its end", &[], SOLUTION)),
        (
            "parameters",
            Place::Each { meaning: "", needs: &[], names: Names::Parameters, of: &PARAMETER },
        ),
        (
            "further",
            Place::Each { meaning: "", needs: &[Further], names: Names::Further, of: &PARAMETER },
        ),
        (
            "nis_mean",
            magnitude(Unit::One, "mean normalized innovation squared over three axes, expected 3"),
        ),
        (
            "nees",
            Place::Each {
                meaning: "squared normalized errors of a group over its size, expected 1",
                needs: &[Truth, Sigma],
                names: Names::Groups,
                of: &GROUP,
            },
        ),
        (
            "worst_normalized_error",
            with(
                &[Truth, Sigma],
                magnitude(Unit::Sigma, "largest |error| over standard deviation of a parameter"),
            ),
        ),
        (
            "least_gain",
            with(
                &[Sigma],
                magnitude(
                    Unit::One,
                    "least standard deviation before over that after the calibration, of the parameters that were to be estimated",
                ),
            ),
        ),
        ("health", table("reports of the core", &[], HEALTH)),
    ],
);

const PARAMETER: Place = table(
    "",
    &[],
    &[
        ("true", with(&[Truth], signed(Unit::Parameter, "true value"))),
        ("estimate", signed(Unit::Parameter, "estimate")),
        ("sigma", with(&[Sigma], magnitude(Unit::Parameter, "standard deviation of the estimate"))),
        (
            "gain",
            with(
                &[Sigma],
                magnitude(Unit::One, "standard deviation before over that after the calibration"),
            ),
        ),
        ("error", with(&[Truth], signed(Unit::Parameter, "error, estimate − true"))),
        ("normalized", with(&[Truth, Sigma], signed(Unit::Sigma, "error over standard deviation"))),
    ],
);

const GROUP: Place = count("");

const HEALTH: Keys = &[
    ("measurements", count("measurements offered to the filter")),
    ("rejected", count("measurements rejected by the innovation gate")),
    ("recoveries", count("recoveries of the filter")),
    ("gyro_stuck", count("samples with identical counts of a gyro")),
    ("accelerometer_stuck", count("samples with identical counts of an accelerometer")),
    ("gaps", count("samples with others missing before them")),
    ("out_of_order", count("samples that did not advance")),
    ("inertial_invalid", count("samples with saturated or invalid counts")),
    (
        "gimbal_disagrees",
        count("samples in which the encoders did not show the commanded position"),
    ),
    ("aiding_lost", count("samples whose aiding was due and did not come")),
    ("inconsistent", count("samples in which innovations contradicted the tuning")),
    ("numeric", count("samples with numbers that are not finite")),
    ("jumps", count("samples whose increments jumped more than any motion can")),
    ("gimbal_slips", count("samples in which gyros and encoders did not show the same turn")),
    ("drifting", count("samples in which a parameter was found to drift")),
    ("aiding_stale", count("samples whose aiding had another stamp")),
    (
        "solution_steps",
        count(
            "steps of the solution that its samples don't explain, while a correction was at work",
        ),
    ),
];

pub(super) const NAVIGATION: Place = table(
    "navigation",
    &[Navigation, Truth],
    &[
        ("duration_h", magnitude(HOUR, "duration")),
        ("latitude_error_arcmin", table("latitude error", &[], ERROR_ARCMIN)),
        ("longitude_error_arcmin", table("longitude error", &[], ERROR_ARCMIN)),
        (
            "radial_error_nmi",
            table(
                "radial error",
                &[],
                &[
                    ("max", magnitude(NMI, "largest")),
                    ("rms", magnitude(NMI, "root mean square over time")),
                    ("final", magnitude(NMI, "at the end")),
                    (
                        "rate_per_h",
                        magnitude(Unit::Named("nmi/h"), "regression on time through the origin"),
                    ),
                ],
            ),
        ),
        ("heading_error_arcmin", table("heading error of the case", &[], ERROR_ARCMIN)),
        ("pitch_error_arcmin", table("pitch error of the case", &[], ERROR_ARCMIN)),
        ("roll_error_arcmin", table("roll error of the case", &[], ERROR_ARCMIN)),
        ("velocity_north_error_mps", table("velocity error north", &[], ERROR_MPS)),
        ("velocity_east_error_mps", table("velocity error east", &[], ERROR_MPS)),
        ("heading_output", table("output of the heading", &[], HEADING_OUTPUT)),
        (
            "slope_window",
            table(
                "window of the slopes",
                &[SchulerPeriod],
                &[
                    ("periods", count("number of Schuler periods or sidereal days")),
                    ("hours", magnitude(HOUR, "length")),
                ],
            ),
        ),
        (
            "marks",
            table(
                "",
                &[],
                &[
                    ("24h", table("at 24 h", &[Day], MARK)),
                    ("72h", table("at 72 h", &[ThreeDays], MARK)),
                ],
            ),
        ),
    ],
);

/// Of a solution that was made elsewhere.
const HEADING_OUTPUT: Keys = &[
    ("resolution_deg", magnitude(DEG, "change by one in the last digit")),
    ("constant_error_deg", signed(DEG, "constant error")),
    ("transmission_error_deg", magnitude(DEG, "error without constant and latency, largest")),
    ("transmission_rms_deg", magnitude(DEG, "error without constant and latency, rms")),
    (
        "transmission_uncertainty_deg",
        magnitude(DEG, "expanded uncertainty of both (95 %), without that of the reference"),
    ),
    ("latency_s", signed(SECOND, "latency against the reference")),
    ("latency_uncertainty_s", magnitude(SECOND, "expanded uncertainty of the latency (95 %)")),
    ("follow_up_10", table("follow-up error up to 10 deg/s", &[], FOLLOW_UP)),
    ("follow_up_20", table("follow-up error from 10 to 20 deg/s", &[], FOLLOW_UP)),
];
const FOLLOW_UP: Keys = &[
    ("max_deg", magnitude(DEG, "largest magnitude")),
    ("rms_deg", magnitude(DEG, "root mean square over the points")),
    ("rate_max_degps", magnitude(Unit::Named("deg/s"), "largest rate of turn")),
    ("points", count("number of points")),
];

const ERROR_ARCMIN: Keys = &[
    ("max", magnitude(ARCMIN, "largest magnitude")),
    ("rms", magnitude(ARCMIN, "root mean square over time")),
    ("final", signed(ARCMIN, "at the end")),
    ("slope_per_day", with(&[SchulerPeriod], signed(Unit::Named("arcmin/day"), "secular slope"))),
    (
        "schuler_amplitude",
        with(&[SchulerPeriod], magnitude(ARCMIN, "amplitude of the Schuler oscillation")),
    ),
];
const ERROR_MPS: Keys = &[
    ("max", magnitude(MPS, "largest magnitude")),
    ("rms", magnitude(MPS, "root mean square over time")),
    ("final", signed(MPS, "at the end")),
    ("slope_per_day", with(&[SchulerPeriod], signed(Unit::Named("m/s/day"), "secular slope"))),
    (
        "schuler_amplitude",
        with(&[SchulerPeriod], magnitude(MPS, "amplitude of the Schuler oscillation")),
    ),
];

const MARK: Keys = &[
    ("latitude_arcmin", signed(ARCMIN, "latitude error")),
    ("longitude_arcmin", signed(ARCMIN, "longitude error")),
    ("radial_nmi", magnitude(NMI, "radial error")),
    ("latitude_max_arcmin", magnitude(ARCMIN, "largest latitude error up to it")),
    ("longitude_max_arcmin", magnitude(ARCMIN, "largest longitude error up to it")),
    ("radial_max_nmi", magnitude(NMI, "largest radial error up to it")),
];
