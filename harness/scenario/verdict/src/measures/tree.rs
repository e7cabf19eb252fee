//! Tree of all measures: the summary, in its own order.

use super::heading::HEADING;
use super::method::{ALIGNMENT, CALIBRATION, NAVIGATION};
use super::need::MeasureNeed::{
    Baseline, Calibration, Clock, DeviceClock, KnownNoise, Navigation, Sigma, Truth, Twin,
};
use super::place::{
    ARCMIN, G_DEPENDENT, Keys, MICROSECOND, MPS, NMI, Names, Place, SECOND, Unit, count, magnitude,
    signed, table, with,
};

/// The summary.
pub(super) static SUMMARY: Place = table(
    "",
    &[],
    &[
        ("alignment", ALIGNMENT),
        ("calibration", CALIBRATION),
        ("navigation", NAVIGATION),
        ("followed", FOLLOWED),
        ("heading", HEADING),
        ("counterfactual", COUNTERFACTUAL),
        ("false_alarms", count("reports of the core in the run without faults, or in the twin")),
        (
            "baseline",
            table(
                "second method",
                &[Baseline],
                &[
                    ("alignment", ALIGNMENT),
                    ("calibration", CALIBRATION),
                    ("navigation", NAVIGATION),
                    ("followed", FOLLOWED),
                    ("counterfactual", COUNTERFACTUAL),
                    ("planned", PLANNED),
                    ("done", DONE),
                ],
            ),
        ),
        ("reference", REFERENCE),
        ("pacing", PACING),
        ("planned", PLANNED),
        ("done", DONE),
    ],
);

const FOLLOWED: Place = table(
    "errors on the known noise of the samples",
    &[Navigation, Truth, KnownNoise],
    &[
        ("attitude", table("attitude", &[], REGRESSION)),
        ("velocity", table("velocity", &[], REGRESSION)),
    ],
);

const REGRESSION: Keys = &[
    ("slope", signed(Unit::One, "slope, expected 1")),
    ("sigma", magnitude(Unit::One, "standard deviation of the slope")),
    ("information", magnitude(Unit::One, "information on the slope, 1/σ²")),
    ("residual", magnitude(Unit::One, "rms of the rest over rms of the known noise")),
    ("window_s", magnitude(SECOND, "length of the windows")),
    ("lag_s", magnitude(SECOND, "lag of the answers behind the samples")),
    ("windows", count("number of windows")),
];

const COUNTERFACTUAL: Place = table(
    "effect of the faults",
    &[Twin],
    &[
        (
            "outputs_differ_after_s",
            magnitude(SECOND, "time up to which the outputs are those of the twin"),
        ),
        (
            "parameters",
            Place::Each {
                meaning: "",
                needs: &[Calibration, Sigma],
                names: Names::Parameters,
                of: &SHIFT,
            },
        ),
        (
            "worst_shift_sigma",
            with(
                &[Calibration, Sigma],
                magnitude(
                    Unit::Sigma,
                    "largest |shift| of a parameter over posterior standard deviation of the twin",
                ),
            ),
        ),
        (
            "worst_shift_published_sigma",
            with(
                &[Calibration, Sigma],
                magnitude(
                    Unit::Sigma,
                    "largest |shift| of a parameter over the standard deviation that the run with the faults published",
                ),
            ),
        ),
        (
            "navigation",
            table(
                "navigation",
                &[Navigation, Truth],
                &[
                    ("latitude_max_arcmin", magnitude(ARCMIN, "largest difference of latitude")),
                    ("longitude_max_arcmin", magnitude(ARCMIN, "largest difference of longitude")),
                    ("radial_max_nmi", magnitude(NMI, "largest distance of the two solutions")),
                    ("twin_radial_max_nmi", magnitude(NMI, "largest radial error of the twin")),
                ],
            ),
        ),
        ("undetected", count("faults that fired and were not noticed")),
        (
            "detection_delay_max_s",
            magnitude(SECOND, "longest time until a fault was noticed, of those that were"),
        ),
        ("false_alarms", count("reports of the core that no fault explains")),
    ],
);

const SHIFT: Place = table(
    "",
    &[],
    &[
        ("shift", signed(Unit::Parameter, "shift, run − twin")),
        ("sigma", signed(Unit::Sigma, "shift over posterior standard deviation of the twin")),
    ],
);

const REFERENCE: Place = table(
    "reference",
    &[],
    &[
        ("schuler_period_min", magnitude(Unit::Named("min"), "Schuler period at the site")),
        ("table_g_zz", table("drift by a g_zz of 5e-4 deg/h/g", &[], VERTICAL_DRIFT)),
        ("true_g_zz", table("drift by the true g_zz, not compensated", &[Truth], VERTICAL_DRIFT)),
        (
            "residual_g_zz",
            table(
                "drift by the error of the estimated g_zz",
                &[Calibration, Truth],
                VERTICAL_DRIFT,
            ),
        ),
        (
            "baseline_residual_g_zz",
            table(
                "drift by the error of the g_zz that the second method estimates",
                &[Calibration, Truth, Baseline],
                VERTICAL_DRIFT,
            ),
        ),
        (
            "isotropic_g_sigma_floor_deg_per_h_per_g",
            with(
                &[Calibration],
                magnitude(
                    G_DEPENDENT,
                    "least standard deviation of the isotropic part of G after such a calibration",
                ),
            ),
        ),
        (
            "random_walk",
            table(
                "error by the noise of the sensors alone",
                &[Navigation],
                &[
                    ("latitude_final_arcmin", magnitude(ARCMIN, "1σ of latitude at the end")),
                    ("longitude_final_arcmin", magnitude(ARCMIN, "1σ of longitude at the end")),
                    ("latitude_rms_arcmin", magnitude(ARCMIN, "time-RMS of latitude")),
                    ("longitude_rms_arcmin", magnitude(ARCMIN, "time-RMS of longitude")),
                    ("radial_rms_nmi", magnitude(NMI, "time-RMS of the radial error")),
                    (
                        "solution",
                        table(
                            "",
                            &[],
                            &[
                                ("heading_arcmin", table("heading", &[], WALK_ARCMIN)),
                                ("pitch_arcmin", table("pitch", &[], WALK_ARCMIN)),
                                ("roll_arcmin", table("roll", &[], WALK_ARCMIN)),
                                ("velocity_north_mps", table("velocity north", &[], WALK_MPS)),
                                ("velocity_east_mps", table("velocity east", &[], WALK_MPS)),
                            ],
                        ),
                    ),
                ],
            ),
        ),
    ],
);

const VERTICAL_DRIFT: Keys = &[
    ("g_zz_deg_per_h_per_g", signed(G_DEPENDENT, "its g_zz")),
    ("longitude_arcmin_per_day", signed(Unit::Named("arcmin/day"), "secular longitude error")),
    ("latitude_bound_arcmin", signed(ARCMIN, "largest latitude error")),
];

const WALK_ARCMIN: Keys =
    &[("rms", magnitude(ARCMIN, "time-RMS")), ("final", magnitude(ARCMIN, "1σ at the end"))];
const WALK_MPS: Keys =
    &[("rms", magnitude(MPS, "time-RMS")), ("final", magnitude(MPS, "1σ at the end"))];

const PACING: Place = table(
    "time keeping",
    &[Clock],
    &[
        ("frames", count("frames")),
        ("period_us", magnitude(MICROSECOND, "period of the frames")),
        ("lateness_us", table("lateness of the samples", &[], QUANTILES)),
        ("overrun_us", magnitude(MICROSECOND, "lateness above which a sample is an overrun")),
        ("overruns", count("overruns")),
        ("overruns_in_a_row", count("most overruns in a row")),
        ("first_overrun", count("number of the first frame with an overrun")),
        (
            "slack_p1_us",
            magnitude(
                MICROSECOND,
                "part of the period that 99 % of the frames left unused at least",
            ),
        ),
        ("answer_us", table("time from sending a sample to its answer", &[], QUANTILES)),
        ("late_answers", count("frames that ended without their answer")),
        (
            "missed_answers",
            count("samples whose answer never came, while later ones were answered"),
        ),
        ("not_sent", count("samples that could not be sent")),
        (
            "device_clock",
            table(
                "clock of the device",
                &[DeviceClock],
                &[
                    ("offset_us", signed(MICROSECOND, "time by which it was ahead of the host")),
                    ("bound_us", magnitude(MICROSECOND, "bound of the error of that time")),
                    ("skew_ppm", signed(Unit::Named("ppm"), "rate by which it is fast")),
                    ("exchanges", count("exchanges of the time")),
                ],
            ),
        ),
        ("dropped_records", count("steps that found no room on their way to the recorder")),
    ],
);

const QUANTILES: Keys = &[
    ("p50", magnitude(MICROSECOND, "median")),
    ("p99", magnitude(MICROSECOND, "99 % quantile")),
    ("p999", magnitude(MICROSECOND, "99.9 % quantile")),
    ("max", magnitude(MICROSECOND, "largest")),
];

const PLANNED: Place = table("planned", &[], WORK);
const DONE: Place = table("done", &[], WORK);

const WORK: Keys = &[
    (
        "stops",
        with(&[Calibration], count("stops of the calibration at which the gimbals were held")),
    ),
    ("calibration_s", with(&[Calibration], magnitude(SECOND, "duration of the calibration"))),
    ("references", with(&[Calibration], count("references of the source for the calibration"))),
    ("navigation_s", with(&[Navigation], magnitude(SECOND, "duration of the navigation"))),
];
