//! Earth and rotations.

use super::numbers::Found;
use octant_earth::Vector3;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::case_of_phi;
use octant_earth::rotation;
use octant_earth::units::{DEG, DEG_PER_HOUR_PER_G, DEG_PER_SQRT_HOUR};
use octant_score::reference::{isotropic_g_sigma, vertical_drift};
use std::hint::black_box;

/// Sites with their names: latitude in deg, height in m.
const SITES: [(&str, f64, f64); 4] = [
    ("0 deg", 0.0, 0.0),
    ("30.5 deg", 30.5, 0.0),
    ("-60 deg, 4000 m", -60.0, 4000.0),
    ("85 deg, 12 m", 85.0, 12.0),
];

/// Rotation vectors with their names, rad.
const TURNS: [(&str, [f64; 3]); 4] = [
    ("small", [0.03, -0.05, 0.04]),
    ("edge", [0.0999, 0.0, 0.0]),
    ("large", [1.1, -0.7, 2.2]),
    ("tiny", [1e-5, 2e-5, -3e-5]),
];

pub(super) fn found() -> Found {
    let mut all = Found::new();
    for (site, degrees, height_m) in black_box(SITES) {
        let latitude_rad = degrees * DEG;
        let mut put = |name: &str, value: f64| all.insert(format!("{name}, {site}"), value);
        let earth = Ellipsoid::at(latitude_rad, height_m);
        put("meridian radius", earth.meridian_radius_m);
        put("transverse radius", earth.transverse_radius_m);
        put("gravity", earth.gravity_mps2);
        put("earth rate north", earth.earth_rate().x);
        put("earth rate down", earth.earth_rate().z);
        put("schuler period", earth.schuler_period_s());
        let velocity = Vector3::new(10.0, 7.0, 0.0);
        let transport = earth.transport_rate(&velocity);
        put("transport rate north", transport.x);
        put("transport rate east", transport.y);
        put("transport rate down", transport.z);
        let (latitude, longitude) = earth.position_rate(&velocity);
        put("latitude rate", latitude);
        put("longitude rate", longitude);
        let drift = vertical_drift(5e-4 * DEG_PER_HOUR_PER_G, latitude_rad, height_m);
        put("g_zz longitude per day", drift.longitude_arcmin_per_day);
        put("g_zz latitude", drift.latitude_bound_arcmin);
        let noise = 0.0007 * DEG_PER_SQRT_HOUR;
        let floor = isotropic_g_sigma(noise, latitude_rad, height_m, 14_400.0);
        put("isotropic g after 4 h", floor);
    }
    for (name, turn) in black_box(TURNS) {
        let q = rotation::exp(&Vector3::from(turn));
        let back = rotation::log(&q);
        all.insert(format!("quaternion w, {name}"), q.w);
        for (axis, part, angle) in [("x", q.i, back.x), ("y", q.j, back.y), ("z", q.k, back.z)] {
            all.insert(format!("quaternion {axis}, {name}"), part);
            all.insert(format!("rotation vector {axis}, {name}"), angle);
        }
    }
    let to_case = case_of_phi(black_box(0.7), black_box(0.4));
    for (row, angle) in ["heading", "pitch", "roll"].into_iter().enumerate() {
        for (column, axis) in ["north", "east", "down"].into_iter().enumerate() {
            all.insert(format!("{angle} by phi {axis}"), to_case[(row, column)]);
        }
    }
    all
}
