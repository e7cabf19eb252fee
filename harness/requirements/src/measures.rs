//! Measures that a requirement can have: the numbers of the summary, by their paths.

use octant_sample::parameters::{NAMES, ParameterGroup};

/// Content at a place of the summary.
enum Shape {
    /// A number.
    Number,
    /// A table with its keys.
    Table(Vec<&'static str>),
}

/// Checks that a run can have the measure at this path (without bars).
///
/// # Errors
/// The place in the path up to which it is valid, the part after it that is unknown (`None` if the path
/// ends at a table), and the keys to choose from.
pub fn check(path: &str) -> Result<(), (String, Option<String>, Vec<&'static str>)> {
    let mut walked: Vec<&str> = Vec::new();
    let mut parts = path.split('.');
    loop {
        let place = if walked.is_empty() { "the summary".to_owned() } else { walked.join(".") };
        match (shape(&walked), parts.next()) {
            (Shape::Number, None) => return Ok(()),
            (Shape::Number, Some(part)) => return Err((place, Some(part.to_owned()), Vec::new())),
            (Shape::Table(keys), None) => return Err((place, None, keys)),
            (Shape::Table(keys), Some(part)) if keys.contains(&part) => walked.push(part),
            (Shape::Table(keys), Some(part)) => {
                return Err((place, Some(part.to_owned()), keys));
            }
        }
    }
}

/// Content at an existing place.
fn shape(path: &[&str]) -> Shape {
    let error = ["max", "rms", "final", "slope_per_day", "schuler_amplitude"];
    let table = |keys: &[&'static str]| Shape::Table(keys.to_vec());
    match path {
        [] => table(&[
            "alignment",
            "calibration",
            "navigation",
            "counterfactual",
            "baseline",
            "reference",
            "pacing",
            "planned",
            "done",
        ]),
        ["pacing"] => table(&[
            "frames",
            "period_us",
            "lateness_us",
            "overrun_us",
            "overruns",
            "overruns_in_a_row",
            "first_overrun",
            "slack_p1_us",
            "answer_us",
            "late_answers",
            "missed_answers",
            "not_sent",
            "device_clock",
            "dropped_records",
        ]),
        ["pacing", "lateness_us" | "answer_us"] => table(&["p50", "p99", "p999", "max"]),
        ["pacing", "device_clock"] => table(&["offset_us", "bound_us", "skew_ppm", "exchanges"]),
        ["planned" | "done"] => table(&["stops", "calibration_s", "references", "navigation_s"]),
        ["alignment"] => table(&["duration_s", "solution"]),
        ["alignment" | "calibration", "solution"] => table(&[
            "heading_deg",
            "pitch_deg",
            "roll_deg",
            "heading_arcmin",
            "pitch_arcmin",
            "roll_arcmin",
            "velocity_north_mps",
            "velocity_east_mps",
        ]),
        [
            "alignment" | "calibration",
            "solution",
            "heading_arcmin" | "pitch_arcmin" | "roll_arcmin" | "velocity_north_mps"
            | "velocity_east_mps",
        ] => table(&["error", "sigma", "normalized"]),
        ["baseline"] => {
            table(&["alignment", "calibration", "navigation", "counterfactual", "planned", "done"])
        }
        ["baseline", rest @ ..] => shape(rest),
        ["counterfactual"] => table(&[
            "outputs_differ_after_s",
            "parameters",
            "worst_shift_sigma",
            "navigation",
            "undetected",
            "detection_delay_max_s",
            "false_alarms",
        ]),
        ["counterfactual", "parameters"] => table(&NAMES),
        ["counterfactual", "parameters", _] => table(&["shift", "sigma"]),
        ["counterfactual", "navigation"] => table(&[
            "latitude_max_arcmin",
            "longitude_max_arcmin",
            "radial_max_nmi",
            "twin_radial_max_nmi",
        ]),
        ["calibration"] => table(&[
            "duration_h",
            "solution",
            "parameters",
            "nis_mean",
            "nees",
            "worst_normalized_error",
            "health",
        ]),
        ["calibration", "parameters"] => table(&NAMES),
        ["calibration", "parameters", _] => {
            table(&["true", "estimate", "sigma", "error", "normalized"])
        }
        ["calibration", "nees"] => {
            Shape::Table(ParameterGroup::ALL.map(ParameterGroup::name).to_vec())
        }
        ["calibration", "health"] => table(&[
            "measurements",
            "rejected",
            "recoveries",
            "gyro_stuck",
            "accelerometer_stuck",
            "gaps",
            "out_of_order",
            "inertial_invalid",
            "gimbal_disagrees",
            "aiding_lost",
            "inconsistent",
            "numeric",
            "jumps",
            "gimbal_slips",
            "drifting",
            "aiding_stale",
        ]),
        ["navigation"] => table(&[
            "duration_h",
            "latitude_error_arcmin",
            "longitude_error_arcmin",
            "radial_error_nmi",
            "heading_error_arcmin",
            "pitch_error_arcmin",
            "roll_error_arcmin",
            "velocity_north_error_mps",
            "velocity_east_error_mps",
            "slope_window",
            "marks",
        ]),
        [
            "navigation",
            "latitude_error_arcmin"
            | "longitude_error_arcmin"
            | "heading_error_arcmin"
            | "pitch_error_arcmin"
            | "roll_error_arcmin"
            | "velocity_north_error_mps"
            | "velocity_east_error_mps",
        ] => table(&error),
        ["navigation", "radial_error_nmi"] => table(&["max", "rms", "final", "rate_per_h"]),
        ["navigation", "slope_window"] => table(&["periods", "hours"]),
        ["navigation", "marks"] => table(&["24h", "72h"]),
        ["navigation", "marks", _] => table(&[
            "latitude_arcmin",
            "longitude_arcmin",
            "radial_nmi",
            "latitude_max_arcmin",
            "longitude_max_arcmin",
            "radial_max_nmi",
        ]),
        ["reference"] => table(&[
            "schuler_period_min",
            "table_g_zz",
            "true_g_zz",
            "residual_g_zz",
            "baseline_residual_g_zz",
            "isotropic_g_sigma_floor_deg_per_h_per_g",
            "random_walk",
        ]),
        ["reference", "table_g_zz" | "true_g_zz" | "residual_g_zz" | "baseline_residual_g_zz"] => {
            table(&["g_zz_deg_per_h_per_g", "longitude_arcmin_per_day", "latitude_bound_arcmin"])
        }
        ["reference", "random_walk"] => table(&[
            "latitude_final_arcmin",
            "longitude_final_arcmin",
            "latitude_rms_arcmin",
            "longitude_rms_arcmin",
            "radial_rms_nmi",
            "solution",
        ]),
        ["reference", "random_walk", "solution"] => table(&[
            "heading_arcmin",
            "pitch_arcmin",
            "roll_arcmin",
            "velocity_north_mps",
            "velocity_east_mps",
        ]),
        ["reference", "random_walk", "solution", _] => table(&["rms", "final"]),
        _ => Shape::Number,
    }
}
