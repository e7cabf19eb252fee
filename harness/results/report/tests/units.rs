//! Units of measures, as the pages show them.

use octant_base::display::DisplayUnits;
use octant_report::units::{is_of_place, shown, unit};

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
        ("counterfactual.worst_shift_published_sigma", "σ"),
        ("counterfactual.parameters.g_zz.shift", "deg/h/g"),
        ("counterfactual.parameters.g_zz.sigma", "σ"),
        ("counterfactual.detection_delay_max_s", "s"),
        ("pacing.lateness_us.p99", "µs"),
        ("pacing.overruns", ""),
        ("calibration.parameters.gyro_bias.error_rms", "deg/h"),
        ("navigation.of_a_newer_program", ""),
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

#[test]
fn errors_have_the_display_units_and_other_measures_their_own() {
    let units = DisplayUnits { arcmin_m: [1850.0, 930.0], ..DisplayUnits::default() };
    let chosen = units.with("km,deg,kn".parse().unwrap());
    for (path, factor, name) in [
        ("navigation.latitude_error_arcmin.max", 1.85, "km"),
        ("|navigation.longitude_error_arcmin.slope_per_day|", 0.93, "km/day"),
        ("baseline.navigation.marks.24h.longitude_max_arcmin", 0.93, "km"),
        ("reference.residual_g_zz.longitude_arcmin_per_day", 0.93, "km/day"),
        ("navigation.radial_error_nmi.rate_per_h", 1.852, "km/h"),
        ("counterfactual.navigation.radial_max_nmi", 1.852, "km"),
        ("navigation.heading_error_arcmin.rms", 1.0 / 60.0, "deg"),
        ("calibration.solution.roll_arcmin.sigma", 1.0 / 60.0, "deg"),
        ("navigation.velocity_north_error_mps.slope_per_day", 3600.0 / 1852.0, "kn/day"),
        // No errors: an attitude, a misalignment, a multiple of σ, times.
        ("calibration.solution.heading_deg", 1.0, "deg"),
        ("calibration.parameters.gyro_misalignment_xy.error", 1.0, "arcsec"),
        ("calibration.solution.roll_arcmin.normalized", 1.0, "σ"),
        ("navigation.duration_h", 1.0, "h"),
        ("calibration.nis_mean", 1.0, ""),
    ] {
        let found = shown(path, &chosen);
        assert!((found.factor / factor - 1.0).abs() < 1e-12, "{path}: {found:?}");
        assert_eq!(found.name, name, "{path}");
        let default = shown(path, &units);
        assert_eq!((default.factor, default.name.as_ref()), (1.0, unit(path)), "{path}");
    }
    assert!(is_of_place("navigation.marks.72h.latitude_arcmin"));
    assert!(!is_of_place("navigation.radial_error_nmi.max"));
    assert!(!is_of_place("calibration.solution.heading_arcmin.error"));
}
