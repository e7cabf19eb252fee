//! Coarse alignment against the gyrocompass's golden values, and the formula for tilt.

use octant_calibration::alignment::CoarseAlignment;
use octant_calibration::config::Site;
use octant_earth::Vector3;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_nc, phi_of, quaternion_from_matrix};
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, MICRO_G};

fn site(latitude_deg: f64) -> Site {
    Site { latitude_rad: latitude_deg * DEG, longitude_rad: 0.0, height_m: 0.0 }
}

/// φ (rad, north, east, down) of an alignment of ten samples with errors given in n.
fn phi(latitude_deg: f64, rate_error: Vector3<f64>, force_error: Vector3<f64>) -> Vector3<f64> {
    let site = site(latitude_deg);
    let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
    let truth = quaternion_from_matrix(&c_nc(2.1, 0.4, -1.3));
    let mut alignment = CoarseAlignment::new(&site);
    for _ in 0..10 {
        let rate = truth.inverse() * (earth.earth_rate() + rate_error);
        let force = truth.inverse() * (Vector3::new(0.0, 0.0, -earth.gravity_mps2) + force_error);
        alignment.step(&(rate * 0.01), &(force * 0.01), 0.01);
    }
    phi_of(&alignment.finish().unwrap(), &truth)
}

#[test]
fn azimuth_error_is_that_of_the_golden_gyrocompass() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/golden/sensor_noise.json");
    let golden: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let cases = golden["gyrocompass"].as_array().unwrap();
    assert_eq!(cases.len(), 9);
    for case in cases {
        let value = |key: &str| case[key].as_f64().unwrap();
        let east = Vector3::new(0.0, value("east_gyro_error_dph") * DEG_PER_HOUR, 0.0);
        let found = phi(value("latitude_deg"), east, Vector3::zeros());
        let expected = value("azimuth_error_arcsec") * ARCSEC;
        // The golden value is δω/(Ω cos L); the alignment turns by its arc tangent. The remaining
        // error is the rounding of a quaternion, some 1e-15 rad.
        let exact = libm::atan(expected);
        assert!((found.z - exact).abs() < 1e-9 * exact, "{case}: {:e}", found.z);
        assert!(found.x.abs() < 1e-14 && found.y.abs() < 1e-14, "{case}: {found:?}");
    }
}

#[test]
fn tilt_error_is_the_accelerometer_error_over_g() {
    // f × φ + ∇ = 0 in the horizon, with f = (0, 0, −g).
    let error = Vector3::new(100.0, -50.0, 0.0) * MICRO_G;
    let found = phi(30.5, Vector3::zeros(), error);
    let gravity = Ellipsoid::at(30.5 * DEG, 0.0).gravity_mps2;
    let (north, east) = (error.y / gravity, -error.x / gravity);
    assert!((found.x - north).abs() < 1e-8, "{found:?}, expected {north:e}");
    assert!((found.y - east).abs() < 1e-8, "{found:?}, expected {east:e}");
    // With no gyro error, φ̇_east = Ω sin L φ_north + Ω cos L φ_down − ε_east = 0.
    let down = -north * libm::tan(30.5 * DEG);
    assert!((found.z - down).abs() < 1e-8, "{found:?}, expected {down:e}");
}

#[test]
fn where_earth_rate_does_not_show_it_gives_no_attitude() {
    let gravity = Vector3::new(0.0, 0.0, -9.8);
    let mut pole = CoarseAlignment::new(&site(89.9));
    pole.step(&(Ellipsoid::at(89.9 * DEG, 0.0).earth_rate() * 0.01), &(gravity * 0.01), 0.01);
    assert_eq!(pole.finish(), None);
    // Gyros with a bias far above Earth rate.
    let mut mems = CoarseAlignment::new(&site(30.0));
    mems.step(&(Vector3::new(0.01, 0.0, 0.0) * 0.01), &(gravity * 0.01), 0.01);
    assert_eq!(mems.finish(), None);
    assert_eq!(CoarseAlignment::new(&site(30.0)).finish(), None, "no sample");
    let mut broken = CoarseAlignment::new(&site(30.0));
    broken.step(&Vector3::repeat(f64::NAN), &(gravity * 0.01), 0.01);
    assert_eq!(broken.finish(), None, "not a number");
}
