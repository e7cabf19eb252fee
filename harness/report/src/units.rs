//! Units of the measures that a requirement can have, as the pages show them.

use octant_sample::parameters::{NAMES, ParameterGroup};

/// Ends of names with the unit that they stand for.
const SUFFIXES: [(&str, &str); 12] = [
    ("_deg_per_h_per_g", "deg/h/g"),
    ("_arcmin_per_day", "arcmin/day"),
    ("_arcmin", "arcmin"),
    ("_nmi", "nmi"),
    ("_mps", "m/s"),
    ("_deg", "deg"),
    ("_us", "µs"),
    ("_ppm", "ppm"),
    ("_min", "min"),
    ("_sigma", "σ"),
    ("_h", "h"),
    ("_s", "s"),
];

/// Returns the unit of the measure at a path of the summary, with or without bars: `arcmin`, `nmi/h`,
/// `ppm`; empty for counts, ratios and paths that no run has.
#[must_use]
pub fn unit(path: &str) -> &'static str {
    let parts: Vec<&str> = path.trim_matches('|').split('.').collect();
    match parts.as_slice() {
        [.., "parameters", name, "true" | "estimate" | "sigma" | "error"]
            if !parts.contains(&"counterfactual") =>
        {
            parameter(name)
        }
        [.., "parameters", name, "shift"] => parameter(name),
        [.., "normalized"] | [.., "worst_normalized_error"] | [.., "parameters", _, "sigma"] => "σ",
        [.., of, "slope_per_day"] => match suffix(of) {
            "arcmin" => "arcmin/day",
            "m/s" => "m/s/day",
            _ => "",
        },
        [.., "radial_error_nmi", "rate_per_h"] => "nmi/h",
        [.., "slope_window", "hours"] => "h",
        [.., of, last] => match suffix(last) {
            "" => suffix(of),
            unit => unit,
        },
        [only] => suffix(only),
        [] => "",
    }
}

/// Unit of a parameter by its name.
fn parameter(name: &str) -> &'static str {
    NAMES.iter().position(|other| *other == name).map_or("", |i| ParameterGroup::of(i).unit())
}

/// Unit that the end of a name stands for.
fn suffix(name: &str) -> &'static str {
    SUFFIXES.iter().find(|(end, _)| name.ends_with(end)).map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_have_the_units_of_their_names() {
        for (path, expected) in [
            ("navigation.longitude_error_arcmin.max", "arcmin"),
            ("|navigation.longitude_error_arcmin.final|", "arcmin"),
            ("navigation.latitude_error_arcmin.slope_per_day", "arcmin/day"),
            ("navigation.velocity_north_error_mps.rms", "m/s"),
            ("navigation.velocity_north_error_mps.slope_per_day", "m/s/day"),
            ("navigation.radial_error_nmi.rate_per_h", "nmi/h"),
            ("navigation.radial_error_nmi.rms", "nmi"),
            ("navigation.marks.24h.radial_max_nmi", "nmi"),
            ("navigation.slope_window.hours", "h"),
            ("navigation.slope_window.periods", ""),
            ("navigation.duration_h", "h"),
            ("baseline.navigation.longitude_error_arcmin.max", "arcmin"),
            ("calibration.solution.heading_arcmin.error", "arcmin"),
            ("calibration.solution.heading_arcmin.normalized", "σ"),
            ("|calibration.parameters.g_zz.error|", "deg/h/g"),
            ("calibration.parameters.g_zz.normalized", "σ"),
            ("calibration.nis_mean", ""),
            ("calibration.nees.gyro_bias", ""),
            ("calibration.health.rejected", ""),
            ("calibration.health.drifting", ""),
            ("calibration.worst_normalized_error", "σ"),
            ("counterfactual.worst_shift_sigma", "σ"),
            ("counterfactual.parameters.g_zz.shift", "deg/h/g"),
            ("counterfactual.parameters.g_zz.sigma", "σ"),
            ("counterfactual.detection_delay_max_s", "s"),
            ("pacing.lateness_us.p99", "µs"),
            ("pacing.overruns", ""),
            ("pacing.device_clock.skew_ppm", "ppm"),
            ("pacing.device_clock.exchanges", ""),
            ("done.calibration_s", "s"),
            ("reference.schuler_period_min", "min"),
            ("reference.residual_g_zz.longitude_arcmin_per_day", "arcmin/day"),
            ("reference.isotropic_g_sigma_floor_deg_per_h_per_g", "deg/h/g"),
        ] {
            assert_eq!(unit(path), expected, "{path}");
        }
    }
}
