//! Known-answer tests of the Earth model against an independent implementation.

use octant_earth::ellipsoid::{Ellipsoid, meridian_radius_m, transverse_radius_m};
use octant_earth::frames::c_cb;
use octant_earth::units::{DEG, DEG_PER_HOUR};
use octant_earth::{Matrix3, Vector3};
use serde_json::Value;

fn golden(name: &str) -> Value {
    let path = format!("{}/../../../fixtures/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Compares within 1e-9 relative, and within 1e-15 absolute where zero is expected.
fn assert_close(actual: f64, expected: f64, what: &str) {
    let bound = (1e-9 * expected.abs()).max(1e-15);
    assert!((actual - expected).abs() <= bound, "{what}: {actual} against {expected}");
}

#[test]
fn radii_gravity_earth_rate_and_schuler_period() {
    for row in golden("earth.json")["rows"].as_array().unwrap() {
        let field = |key: &str| row[key].as_f64().unwrap();
        let latitude_rad = field("latitude_deg") * DEG;
        let earth = Ellipsoid::at(latitude_rad, 0.0);
        let rate = earth.earth_rate() / DEG_PER_HOUR;
        assert_close(meridian_radius_m(earth.sin_latitude), field("meridian_radius_m"), "R_M");
        assert_close(transverse_radius_m(earth.sin_latitude), field("transverse_radius_m"), "R_N");
        assert_close(earth.gravity_mps2, field("normal_gravity_ms2"), "gravity");
        assert_close(rate.x, field("earth_rate_north_dph"), "Earth rate north");
        assert_close(rate.z, field("earth_rate_down_dph"), "Earth rate down");
        assert_close(earth.schuler_period_s(), field("schuler_period_meridian_s"), "Schuler");
    }
}

#[test]
fn g_dependent_bias_by_orientation() {
    let golden = golden("g_dependent_bias.json");
    let vector = |value: &Value| {
        Vector3::from_iterator(value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()))
    };
    let g = Matrix3::from_rows(
        &[0, 1, 2].map(|i| vector(&golden["g_matrix_dph_per_g"][i]).transpose()),
    );
    for row in golden["rows"].as_array().unwrap() {
        let angle = |key: &str| row[key].as_f64().unwrap() * DEG;
        let c = c_cb(angle("azimuth_deg"), angle("roll_deg"));
        let f_b = c.transpose() * Vector3::new(0.0, 0.0, -1.0);
        let error_b = g * f_b;
        for (actual, key) in [
            (f_b, "specific_force_body_g"),
            (error_b, "gyro_error_body_dph"),
            (c * error_b, "gyro_error_navigation_dph"),
        ] {
            let difference = (actual - vector(&row[key])).amax();
            assert!(difference < 1e-9, "{key} of {row}: {actual}");
        }
    }
}
