//! Limits of the core's screens, its correction of an attitude, and the units and references beside
//! it.

use super::numbers::Found;
use octant_calibration::config::{
    AidingMode, Base, BaseMotion, ErrorModel, Kalman, Noise, Prior, Screening, SwayNoise,
    TurntableRates,
};
use octant_calibration::continuity::Continuity;
use octant_calibration::screen::Screen;
use octant_calibration::strapdown::{Strapdown, Vertical};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{DEG, DEG_PER_HOUR_PER_G, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_earth::{UnitQuaternion, Vector3};
use octant_observe::covariance::PositionError;
use octant_observe::ensemble::{band, state_unit};
use octant_score::reference::{ReferenceInput, reference};
use std::hint::black_box;

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    breaks(&mut all)?;
    jumps(&mut all)?;
    corrected(&mut all);
    for state in 0..39 {
        all.insert(format!("unit of state {state}"), state_unit(black_box(state)).1);
    }
    references(&mut all)?;
    bands(&mut all);
    Ok(all)
}

/// Converts a predicted position error into the units of its page.
fn bands(all: &mut Found) {
    let at = black_box(PositionError {
        hours: 1.0,
        mean_m: [555.6, -370.4],
        variances_m2: [4_115_884.8, 1_371_961.6],
        covariance_m2: 1_028_971.2,
    });
    for (name, degrees) in black_box([("30.5 deg", 30.5), ("-60 deg", -60.0)]) {
        let band = band(&at, &Ellipsoid::at(degrees * DEG, 0.0));
        for (axis, of) in [("latitude", band.latitude_arcmin), ("longitude", band.longitude_arcmin)]
        {
            for (what, value) in [
                ("mean", of.mean),
                ("sigma", of.sigma),
                ("5 %", of.p5),
                ("50 %", of.p50),
                ("95 %", of.p95),
            ] {
                all.insert(format!("band of {axis}, {what}, {name}"), value);
            }
        }
        all.insert(format!("band of radius, 50 %, {name}"), band.radial_nmi.p50);
        all.insert(format!("band of radius, 95 %, {name}"), band.radial_nmi.p95);
    }
}

/// Extracts the numbers of a field from its `Debug` text: limits aren't exposed otherwise, and
/// needn't be.
pub(super) fn of_field(text: &str, field: &str) -> Result<Vec<f64>, String> {
    let missing = || format!("find {field} in {text}");
    let at = text.find(&format!(" {field}: ")).ok_or_else(missing)?;
    let rest = &text[at + field.len() + 3..];
    // Up to the name of the next field.
    let end = rest.find(": ").unwrap_or(rest.len());
    let numbers = rest[..end].split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
    let numbers: Vec<f64> = numbers.filter_map(|word| word.parse().ok()).collect();
    if numbers.is_empty() { Err(missing()) } else { Ok(numbers) }
}

fn moving(rate: f64, acceleration: f64, force: f64, jerk: f64) -> Base {
    Base::Moving(BaseMotion {
        angle_rad: 0.1,
        rate_radps: rate,
        acceleration_radps2: acceleration,
        force_mps2: force,
        jerk_mps3: jerk,
    })
}

fn breaks(all: &mut Found) -> Result<(), String> {
    let screening = Screening {
        base: moving(0.08, 0.06, 0.5, 0.4),
        encoder_sigma_rad: 1e-4,
        resolution: (1e-8, 2e-5),
        vibration: (3e-8, 4e-5),
        ..Screening::none()
    };
    let kalman = Kalman {
        error_model: ErrorModel::Phi,
        estimated: [true; 7],
        prior: Prior {
            attitude_rad: [3e-4, 3e-4, 0.002],
            velocity_mps: 0.02,
            position_m: 1.0,
            parameters: [1e-8, 30e-6, 2e-4, 1e-9, 1e-3, 3e-5, 2e-4],
        },
        aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
        aiding_period_ns: 1_000_000_000,
        sway: SwayNoise::White,
        refuse_above_mean_nis: 6.0,
        further: Default::default(),
        sigma_limits: Default::default(),
    };
    let noise = Noise { angle_random_walk: 3e-7, velocity_random_walk: 6e-4 };
    let turntable = TurntableRates { rate_radps: 0.2, acceleration_radps2: 0.3 };
    let continuity = black_box(Continuity::new(&screening, &kalman, &noise, &turntable, 0.005))
        .ok_or("make the test of continuity")?;
    let text = format!("{continuity:?}");
    for (i, weight) in of_field(&text, "weights")?.into_iter().enumerate() {
        all.insert(format!("weight {i}"), weight);
    }
    for (i, limit) in of_field(&text, "limits")?.into_iter().enumerate() {
        all.insert(format!("limit {i}"), limit);
    }
    for field in ["axes", "corner", "sway"] {
        all.insert(field.to_owned(), of_field(&text, field)?[0]);
    }
    let sum = of_field(&text, "sum")?;
    all.insert("sum rate".to_owned(), sum[0]);
    all.insert("sum limit".to_owned(), sum.get(1).copied().ok_or("find the limit of the sum")?);
    Ok(())
}

fn jumps(all: &mut Found) -> Result<(), String> {
    let screening = Screening {
        base: moving(1.0, 2.0, 0.5, 4000.0),
        jumps: true,
        resolution: (1e-5, 1e-4),
        vibration: (2e-5, 2e-4),
        ..Screening::none()
    };
    let noise = Noise { angle_random_walk: 1e-3, velocity_random_walk: 0.3 };
    let turntable = TurntableRates { rate_radps: 3.0, acceleration_radps2: 5.0 };
    let screen = black_box(Screen::new(&screening, &noise, &turntable, 0.005));
    let limits = of_field(&format!("{screen:?}"), "limits")?;
    for triad in 0..2 {
        for moving in 0..2 {
            let limit = limits.get(6 * moving + 3 * triad).copied().ok_or("find the limits")?;
            all.insert(format!("jump {triad} {moving}"), limit);
        }
    }
    // Short samples, so that a time contains many of them.
    let screen = black_box(Screen::new(&screening, &noise, &turntable, 1e-6));
    let hold = of_field(&format!("{screen:?}"), "hold")?;
    all.insert("hold last".to_owned(), hold[0]);
    all.insert("hold known".to_owned(), hold.get(1).copied().ok_or("find the holds")?);
    Ok(())
}

fn corrected(all: &mut Found) {
    let mut strapdown = black_box(Strapdown::new(
        &UnitQuaternion::identity(),
        Vector3::zeros(),
        0.5,
        0.2,
        50.0,
        Vertical::Held,
    ));
    let phi = black_box(Vector3::new(0.02, -0.05, 0.07));
    strapdown.correct(&phi, &Vector3::zeros(), &Vector3::new(1000.0, 2000.0, 3.0));
    let text = format!("{strapdown:?}");
    let navigation = |field: &str| of_field(&text, field).ok().and_then(|of| of.first().copied());
    for (name, field) in [
        ("corrected latitude", "latitude_rad"),
        ("corrected longitude", "longitude_rad"),
        ("corrected height", "height_m"),
    ] {
        all.insert(name.to_owned(), navigation(field).unwrap_or(f64::NAN));
    }
    let q = UnitQuaternion::from_matrix(&strapdown.c_nb());
    for (name, part) in [("w", q.w), ("i", q.i), ("j", q.j), ("k", q.k)] {
        all.insert(format!("corrected {name}"), part);
    }
}

fn references(all: &mut Found) -> Result<(), String> {
    for (site, latitude_deg, height_m) in
        black_box([("", 30.5, 0.0), (" at 4000 m", -60.0, 4000.0)])
    {
        let found = reference(&black_box(ReferenceInput {
            latitude_rad: latitude_deg * DEG,
            height_m,
            heading_rad: 0.0,
            angle_random_walk: 0.0007 * DEG_PER_SQRT_HOUR,
            velocity_random_walk: 50.0 * MICRO_G,
            calibration_s: Some(14_400.0),
            navigation_s: None,
            true_g_zz: Some(7e-4 * DEG_PER_HOUR_PER_G),
            estimated_g_zz: Some(5e-4 * DEG_PER_HOUR_PER_G),
            baseline_estimated_g_zz: Some(9e-4 * DEG_PER_HOUR_PER_G),
        }));
        all.insert(format!("reference period{site}"), found.schuler_period_min);
        let floor = found.isotropic_g_sigma_floor_deg_per_h_per_g;
        all.insert(format!("reference isotropic{site}"), floor.ok_or("find the floor of G")?);
        for (name, drift) in [
            ("table", Some(found.table_g_zz)),
            ("true", found.true_g_zz),
            ("residual", found.residual_g_zz),
            ("baseline", found.baseline_residual_g_zz),
        ] {
            let drift = drift.ok_or_else(|| format!("find the reference {name}"))?;
            let mut put = |what: &str, value: f64| {
                all.insert(format!("reference {name} {what}{site}"), value);
            };
            put("g_zz", drift.g_zz_deg_per_h_per_g);
            put("longitude", drift.longitude_arcmin_per_day);
            put("latitude", drift.latitude_bound_arcmin);
        }
    }
    Ok(())
}
