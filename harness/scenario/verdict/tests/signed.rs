//! Measures with a sign.

use octant_verdict::Comparison;
use octant_verdict::measures::is_signed;
use octant_verdict::signed::{one_sided, unbreakable};

#[test]
fn signs_are_known() {
    for signed in [
        "navigation.latitude_error_arcmin.final",
        "navigation.longitude_error_arcmin.slope_per_day",
        "baseline.navigation.longitude_error_arcmin.final",
        "navigation.heading_error_arcmin.final",
        "navigation.velocity_north_error_mps.slope_per_day",
        "navigation.marks.24h.longitude_arcmin",
        "alignment.solution.heading_arcmin.error",
        "calibration.solution.roll_arcmin.normalized",
        "alignment.solution.heading_deg",
        "calibration.parameters.g_zz.error",
        "calibration.parameters.g_zz.normalized",
        "counterfactual.parameters.g_zz.shift",
        // It is the shift over σ of the twin, with the sign of the shift.
        "counterfactual.parameters.g_zz.sigma",
        "reference.residual_g_zz.longitude_arcmin_per_day",
        "reference.residual_g_zz.latitude_bound_arcmin",
        "pacing.device_clock.skew_ppm",
    ] {
        assert!(is_signed(signed), "{signed}");
    }
    for magnitude in [
        "navigation.latitude_error_arcmin.max",
        "navigation.radial_error_nmi.final",
        "navigation.heading_error_arcmin.schuler_amplitude",
        "navigation.marks.24h.longitude_max_arcmin",
        "calibration.parameters.g_zz.sigma",
        "calibration.solution.heading_arcmin.sigma",
        "calibration.nis_mean",
        "counterfactual.worst_shift_sigma",
        "reference.random_walk.latitude_final_arcmin",
        "reference.random_walk.solution.heading_arcmin.final",
    ] {
        assert!(!is_signed(magnitude), "{magnitude}");
    }
}

#[test]
fn one_side_of_a_sign_is_refused_with_the_spelling_to_use() {
    let slope = "navigation.longitude_error_arcmin.slope_per_day";
    let upper = (slope, Comparison::AtMost);
    let lower = (slope, Comparison::Above);
    let text = one_sided(upper, [upper]).unwrap();
    assert!(text.contains(&format!("\"|{slope}|\"")) && text.contains("with >= for"), "{text}");
    assert!(one_sided(lower, [lower, lower]).unwrap().contains("with <= for"));
    assert_eq!(one_sided(upper, [upper, lower]), None);
    let bars = format!("|{slope}|");
    assert_eq!(one_sided((&bars, Comparison::AtMost), []), None);
    assert_eq!(one_sided(("calibration.nis_mean", Comparison::AtMost), []), None);
}

#[test]
fn a_limit_that_no_magnitude_breaks_is_refused() {
    let refused = |measure: &str, comparison, limit| unbreakable((measure, comparison), limit);
    let sigma = "counterfactual.worst_shift_sigma";
    let text = refused(sigma, Comparison::AtLeast, 0.0).unwrap();
    assert!(
        text.contains("\"counterfactual.worst_shift_sigma\" >= 0")
            && text.contains("never negative"),
        "{text}"
    );
    assert!(refused(sigma, Comparison::Above, -1.0).is_some());
    assert!(refused("|calibration.parameters.g_zz.error|", Comparison::AtLeast, 0.0).is_some());
    assert_eq!(refused(sigma, Comparison::Above, 0.0), None);
    assert_eq!(refused(sigma, Comparison::AtLeast, 3.0), None);
    assert_eq!(refused(sigma, Comparison::AtMost, 0.0), None);
    assert_eq!(refused("calibration.parameters.g_zz.error", Comparison::AtLeast, -1.0), None);
}
