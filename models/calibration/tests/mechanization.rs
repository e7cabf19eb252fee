//! The strapdown against closed forms and an independent error propagation.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use octant_calibration::strapdown::{Strapdown, Vertical};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_cb, quaternion_from_matrix};
use octant_earth::rotation::exp;
use octant_earth::units::*;

/// `∫ R(−a(t)) dt · u` over `h` for a turn about `axis` at constant `rate` from angle `a`: the
/// closed form of a constant vector seen from a turning body.
fn integrated(axis: usize, u: &Vector3<f64>, a: f64, rate: f64, h: f64) -> Vector3<f64> {
    if rate == 0.0 {
        let (s, c) = a.sin_cos();
        return turn(axis, u, c * h, s * h, h);
    }
    let b = a + rate * h;
    turn(axis, u, (b.sin() - a.sin()) / rate, (a.cos() - b.cos()) / rate, h)
}

/// Rotation by −a about `axis` with sums of cos and sin over time in place of their values.
fn turn(axis: usize, u: &Vector3<f64>, c: f64, s: f64, whole: f64) -> Vector3<f64> {
    let (i, j, k) = (axis, (axis + 1) % 3, (axis + 2) % 3);
    let mut out = Vector3::zeros();
    out[i] = u[i] * whole;
    out[j] = c * u[j] + s * u[k];
    out[k] = c * u[k] - s * u[j];
    out
}

/// Largest distance from the start in an hour at 30° N, m. The moves are at constant rate, which
/// has a closed form.
fn drift_m(rotating: bool) -> f64 {
    let (latitude, h) = (30.0 * DEG, 0.005);
    let earth = Ellipsoid::at(latitude, 0.0);
    let earth_rate = earth.earth_rate();
    let force = Vector3::new(0.0, 0.0, -earth.gravity_mps2);
    let mut strapdown = Strapdown::new(
        &UnitQuaternion::identity(),
        Vector3::zeros(),
        latitude,
        0.0,
        0.0,
        Vertical::Held,
    );
    // X+ Z+ X− Z− Z+ X+ Z− X− X− Z− X+ Z+ Z− X− Z+ X+, X roll and Z azimuth.
    let moves: [(usize, f64); 16] = [
        (0, 1.0),
        (2, 1.0),
        (0, -1.0),
        (2, -1.0),
        (2, 1.0),
        (0, 1.0),
        (2, -1.0),
        (0, -1.0),
        (0, -1.0),
        (2, -1.0),
        (0, 1.0),
        (2, 1.0),
        (2, -1.0),
        (0, -1.0),
        (2, 1.0),
        (0, 1.0),
    ];
    let (dwell, turning) = (12_000, 6_000);
    let (mut azimuth, mut roll) = (0.0f64, 0.0f64);
    let mut worst = 0.0f64;
    for k in 0..720_000u32 {
        let (cycle, phase) = (k / (dwell + turning), k % (dwell + turning));
        let (axis, sign) = moves[cycle as usize % 16];
        let rate = if rotating && phase >= dwell { sign * 6.0 * DEG } else { 0.0 };
        let seen = |u: &Vector3<f64>| {
            if axis == 0 {
                // The roll gimbal is the outer one: the case is turned by it first, then by the
                // azimuth gimbal.
                let case = integrated(0, u, roll, rate, h);
                turn(2, &case, azimuth.cos(), azimuth.sin(), 1.0)
            } else {
                let case = turn(0, u, roll.cos(), roll.sin(), 1.0);
                integrated(2, &case, azimuth, rate, h)
            }
        };
        let spin = if axis == 0 {
            turn(2, &Vector3::new(rate * h, 0.0, 0.0), azimuth.cos(), azimuth.sin(), 1.0)
        } else {
            Vector3::new(0.0, 0.0, rate * h)
        };
        strapdown.step(&(seen(&earth_rate) + spin), &seen(&force), h);
        if axis == 0 {
            roll += rate * h;
        } else {
            azimuth += rate * h;
        }
        let n = strapdown.navigation();
        let north = (n.latitude_rad - latitude) * earth.meridian_radius_m;
        let east = n.longitude_rad * earth.transverse_radius_m * earth.cos_latitude;
        worst = worst.max(north.hypot(east));
    }
    let truth = quaternion_from_matrix(&c_cb(azimuth, roll));
    let n = strapdown.navigation().q_nb;
    let computed = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(n[0], n[1], n[2], n[3]));
    assert!(computed.angle_to(&truth) < 1e-9, "attitude {}", computed.angle_to(&truth));
    worst
}

#[test]
fn an_hour_on_a_static_base_drifts_less_than_a_centimetre() {
    let (still, rotating) = (drift_m(false), drift_m(true));
    println!("drift in an hour: still {still:.2e} m, rotating {rotating:.2e} m");
    assert!(still < 0.01, "still {still} m");
    assert!(rotating < 0.01, "rotating {rotating} m");
}

/// Largest difference from the golden rows up to `hours`, arcmin, with the errors scaled.
fn golden_difference_arcmin(scale: f64, hours: f64) -> f64 {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/golden/static_free_inertial.json");
    let golden: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut worst = 0.0f64;
    for row in golden["rows"].as_array().unwrap() {
        let latitude = row["latitude_deg"].as_f64().unwrap() * DEG;
        let si = match row["unit"].as_str().unwrap() {
            "deg/h" => DEG_PER_HOUR,
            "ug" => MICRO_G,
            "arcsec" => ARCSEC,
            "arcmin" => ARCMIN,
            "deg" => DEG,
            "m/s" => 1.0,
            unit => panic!("unit {unit}"),
        };
        let value = scale * row["value"].as_f64().unwrap() * si;
        let (kind, axis) = row["error"].as_str().unwrap().rsplit_once('_').unwrap();
        let vector = match axis {
            "north" => Vector3::x(),
            "east" => Vector3::y(),
            "down" => Vector3::z(),
            axis => panic!("axis {axis}"),
        } * value;
        let (mut rate, mut force, mut phi, mut velocity) =
            (Vector3::zeros(), Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        match kind {
            "gyro_error" => rate = vector,
            "accel_error" => force = vector,
            "initial_phi" => phi = vector,
            "initial_velocity_error" => velocity = vector,
            kind => panic!("error {kind}"),
        }
        let earth = Ellipsoid::at(latitude, 0.0);
        rate += earth.earth_rate();
        force.z -= earth.gravity_mps2;
        let h = 0.1;
        // computed = (I − [φ×]) true, and the truth is level with heading 0.
        let mut strapdown =
            Strapdown::new(&exp(&-phi), velocity, latitude, 0.0, 0.0, Vertical::Held);
        let mut tick = 0u32;
        for mark in row["hours_latitude_longitude_arcmin"].as_array().unwrap() {
            let mark: Vec<f64> =
                mark.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
            if mark[0] > hours {
                break;
            }
            while f64::from(tick) * h < mark[0] * 3600.0 - 0.5 * h {
                strapdown.step(&(rate * h), &(force * h), h);
                tick += 1;
            }
            let n = strapdown.navigation();
            for (error, expected) in
                [(n.latitude_rad - latitude, mark[1]), (n.longitude_rad, mark[2])]
            {
                worst = worst.max((error / ARCMIN - scale * expected).abs());
            }
        }
    }
    worst
}

#[test]
fn free_inertial_errors_grow_as_the_matrix_exponential_says() {
    let (day, three_days) =
        (golden_difference_arcmin(1.0, 24.0), golden_difference_arcmin(1.0, 72.0));
    let (tenth_day, tenth) =
        (golden_difference_arcmin(0.1, 24.0), golden_difference_arcmin(0.1, 72.0));
    println!(
        "difference to 24 h and 72 h: {day:.4}, {three_days:.4}; a tenth: {tenth_day:.5}, {tenth:.5} arcmin"
    );
    assert!(day < 0.02, "{day} arcmin to 24 h");
    assert!(three_days < 0.04, "{three_days} arcmin to 72 h");
    // The remaining difference is of second order in the error, so that a tenth of the error is far
    // closer.
    assert!(tenth_day < 0.002, "{tenth_day} arcmin to 24 h");
    assert!(tenth < 0.004, "{tenth} arcmin to 72 h");
}

/// Largest distance from the positions of an exact integration up to `hours`, m.
fn distance_from_exact_m(rate_hz: u32, hours: f64) -> f64 {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/golden/navigation.json");
    let golden: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
    };
    let h = 1.0 / f64::from(rate_hz);
    let mut worst = 0.0f64;
    for row in golden["rows"].as_array().unwrap() {
        let latitude = row["latitude_deg"].as_f64().unwrap() * DEG;
        let [q, velocity, rate, force] =
            ["q_nb", "velocity_mps", "rate_radps", "force_mps2"].map(|name| numbers(&row[name]));
        let q = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
        let velocity = Vector3::new(velocity[0], velocity[1], 0.0);
        let (dtheta, dv) =
            (Vector3::from_column_slice(&rate) * h, Vector3::from_column_slice(&force) * h);
        let mut strapdown = Strapdown::new(&q, velocity, latitude, 0.0, 0.0, Vertical::Held);
        let mut samples = 0u64;
        for mark in row["hours_latitude_longitude_rad"].as_array().unwrap() {
            let mark = numbers(mark);
            if mark[0] > hours {
                break;
            }
            while samples < mark[0] as u64 * 3600 * u64::from(rate_hz) {
                strapdown.step(&dtheta, &dv, h);
                samples += 1;
            }
            let (n, earth) = (strapdown.navigation(), Ellipsoid::at(mark[1], 0.0));
            let north = (n.latitude_rad - mark[1]) * earth.meridian_radius_m;
            let east = (n.longitude_rad - mark[2]) * earth.transverse_radius_m * earth.cos_latitude;
            worst = worst.max(north.hypot(east));
        }
    }
    worst
}

/// A Schuler oscillation of 4 km: integration of first order in the step would be 7 m off after a
/// day at 20 Hz, and 40 m after three at 10 Hz.
#[test]
fn navigation_is_that_of_an_exact_integration() {
    let (day, three_days) = (distance_from_exact_m(20, 24.0), distance_from_exact_m(10, 72.0));
    println!("24 h at 20 Hz: {day:.2e} m; 72 h at 10 Hz: {three_days:.2e} m");
    assert!(day < 0.1, "{day} m in 24 h at 20 Hz");
    assert!(three_days < 1.0, "{three_days} m in 72 h at 10 Hz");
}

#[test]
fn attitude_of_a_turned_case_is_kept() {
    // A body at rest in an attitude that no axis shares must stay there for an hour.
    let latitude = 50.0 * DEG;
    let earth = Ellipsoid::at(latitude, 0.0);
    let c: Matrix3<f64> = c_cb(0.7, 1.1);
    let q = quaternion_from_matrix(&c);
    let mut strapdown = Strapdown::new(&q, Vector3::zeros(), latitude, 0.0, 0.0, Vertical::Held);
    let rate = c.transpose() * earth.earth_rate() * 0.005;
    let force = c.transpose() * Vector3::new(0.0, 0.0, -earth.gravity_mps2) * 0.005;
    for _ in 0..720_000 {
        strapdown.step(&rate, &force, 0.005);
    }
    let n = strapdown.navigation();
    assert!((strapdown.c_nb() - c).amax() < 1e-10);
    assert!((n.latitude_rad - latitude).abs() * 6.4e6 < 1e-3);
}
