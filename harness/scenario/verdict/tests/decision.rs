//! Guard bands of decisions.

use octant_verdict::decision::{
    Decision, DecisionRule, NavigationContext, TimeDoubt, Uncertainty, in_band,
};

const HERE: NavigationContext = NavigationContext {
    simulated: false,
    latitude_rad: std::f64::consts::FRAC_PI_3,
    height_m: 0.0,
    navigation_s: 86_400.0,
    timing: None,
};

#[test]
fn what_moves_is_in_doubt_by_the_difference_of_the_clocks() {
    let timing = TimeDoubt {
        uncertainty_s: 0.1,
        speed_mps: 10.0,
        acceleration_mps2: 0.5,
        turning_radps: 0.02,
    };
    let moving = NavigationContext { timing: Some(timing), ..HERE };
    let band = |position_m, measure: &str| decision(position_m).uncertainty(measure, &moving);
    // 10 m/s for 0.1 s are a metre; a reference that is uncertain by 0.75 m makes 1.25 of it.
    let radial = "navigation.radial_error_nmi.max";
    assert!((band(Some(0.75), radial).unwrap() - 1.25 / 1852.0).abs() < 1e-15);
    assert!(band(None, radial).is_err(), "the reference itself is unknown");
    let stated = |measure: &str, uncertainty| Decision {
        uncertainties: vec![Uncertainty { measure: measure.to_owned(), uncertainty }],
        ..Decision::default()
    };
    for (measure, expected) in [
        ("navigation.heading_error_arcmin.max", 0.002_f64.to_degrees() * 60.0),
        ("navigation.velocity_north_error_mps.rms", 0.05),
    ] {
        assert!(decision(None).uncertainty(measure, &moving).is_err(), "{measure}");
        // Added to what is stated.
        let found = stated(measure, 0.3).uncertainty(measure, &moving).unwrap();
        assert!((found - (0.3_f64.powi(2) + expected.powi(2)).sqrt()).abs() < 1e-12, "{found}");
    }
    assert_eq!(stated(radial, 2.0).uncertainty("calibration.nis_mean", &moving), Ok(0.0));
    assert!(
        decision(None).decided(&moving).text.contains("times of solution and reference ± 0.1 s")
    );
}

fn decision(position_m: Option<f64>) -> Decision {
    Decision { position_m, ..Decision::default() }
}

#[test]
fn a_position_is_what_it_is_on_the_ellipsoid() {
    let uncertainty = |measure: &str| decision(Some(1852.0)).uncertainty(measure, &HERE).unwrap();
    // At 60° WGS 84 has M = 6 383 454 m and N = 6 394 209 m (NIMA TR8350.2, 3rd edition, by its formulas).
    let latitude = uncertainty("navigation.latitude_error_arcmin.max");
    let longitude = uncertainty("navigation.longitude_error_arcmin.max");
    let arcmin = |radius_m: f64| 1852.0 / radius_m * 3_437.746_770_784_939;
    assert!((latitude / arcmin(6_383_453.86) - 1.0).abs() < 1e-6, "{latitude}");
    assert!((longitude / arcmin(6_394_209.17 * 0.5) - 1.0).abs() < 1e-6, "{longitude}");
    assert_eq!(uncertainty("navigation.radial_error_nmi.max"), 1.0);
    assert_eq!(uncertainty("navigation.radial_error_nmi.rate_per_h"), 1.5 / 24.0);
    let slope = uncertainty("navigation.latitude_error_arcmin.slope_per_day");
    assert!((slope - 2.0 * latitude).abs() < 1e-12);
    assert_eq!(uncertainty("baseline.navigation.marks.24h.radial_nmi"), 1.0);
    // At worst the reference oscillates too.
    let schuler = uncertainty("navigation.latitude_error_arcmin.schuler_amplitude");
    assert_eq!(schuler, latitude);
    // Measures without a position as reference don't get a band.
    assert_eq!(uncertainty("calibration.nis_mean"), 0.0);
    assert_eq!(uncertainty("navigation.duration_h"), 0.0);
    assert_eq!(uncertainty("baseline.navigation.slope_window.hours"), 0.0);
    assert_eq!(uncertainty("counterfactual.navigation.radial_max_nmi"), 0.0);
}

#[test]
fn what_nobody_stated_is_exact_where_it_is_simulated_alone() {
    let measure = "navigation.radial_error_nmi.max";
    let simulated = NavigationContext { simulated: true, ..HERE };
    assert_eq!(decision(None).uncertainty(measure, &simulated), Ok(0.0));
    let error = decision(None).uncertainty(measure, &HERE).unwrap_err().to_string();
    assert!(error.contains("decision.position") && error.contains("simple-acceptance"));
    // The position's uncertainty says nothing of other references.
    for other in ["heading_error_arcmin.max", "velocity_east_error_mps.rms"] {
        let measure = format!("navigation.{other}");
        assert_eq!(decision(Some(1.0)).uncertainty(&measure, &simulated), Ok(0.0));
        assert!(decision(Some(1.0)).uncertainty(&measure, &HERE).is_err(), "{measure}");
    }
    let simple = Decision { rule: Some(DecisionRule::SimpleAcceptance), ..Decision::default() };
    assert_eq!(simple.uncertainty(measure, &HERE), Ok(0.0));
    assert_eq!(decision(None).uncertainty("calibration.nis_mean", &HERE), Ok(0.0));
    let stated = Decision {
        uncertainties: vec![Uncertainty { measure: measure.to_owned(), uncertainty: 0.25 }],
        ..decision(Some(1852.0))
    };
    assert_eq!(stated.uncertainty(&format!("|{measure}|"), &HERE), Ok(0.25));
    assert!(decision(None).decided(&simulated).text.contains("the band is zero"));
}

#[test]
fn a_band_is_as_wide_as_the_uncertainty_on_both_sides() {
    for (value, uncertainty, within) in [
        (0.9, 0.2, true),
        (1.1, 0.2, true),
        (1.0, 0.2, true),
        (0.75, 0.2, false),
        (1.25, 0.2, false),
        (1.0, 0.0, false),
    ] {
        assert_eq!(in_band(value, 1.0, uncertainty), within);
    }
}
