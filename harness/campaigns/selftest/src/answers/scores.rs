//! Scores of known drifts, and the floor of the noise.

use super::numbers::Found;
use octant_campaign::report::rows::Curve;
use octant_earth::units::{DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_score::attitude::CaseAngles;
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::floor::Floor;
use octant_score::summary::HeightChannel;
use std::f64::consts::PI;
use std::hint::black_box;

// Drifts as in answers.py.
const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
const RAD_PER_ARCMIN: f64 = PI / 10_800.0;

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    drift(&mut all, 30)?;
    drift(&mut all, 3)?;
    floors(&mut all)?;
    curves(&mut all)?;
    Ok(all)
}

/// Resamples drifts of campaigns onto their common grids: a straight line stays one. Their lengths,
/// s, are near those at which the grid step changes.
fn curves(all: &mut Found) -> Result<(), String> {
    for length_s in [49.999, 4989.899, 4989.901, 4999.98, 5000.02, 29_999.9, 30_001.0, 250_000.0] {
        let row = |k: u32| {
            let hours = black_box(length_s) * f64::from(k) / (4.0 * 3600.0);
            [hours, 0.3 + 0.1 * hours, -0.2 * hours]
        };
        let series: Vec<[f64; 3]> = (0..=4).map(row).collect();
        let curve = Curve::of(&series).ok_or("put a drift onto a grid")?;
        let last = curve.latitude_arcmin.len() - 1;
        let mut put = |name: &str, value: f64| all.insert(format!("{name}, {length_s} s"), value);
        put("grid step", curve.step_s);
        put("grid points", last as f64);
        put("latitude on the grid", curve.latitude_arcmin[1]);
        put("longitude on the grid", curve.longitude_arcmin[last - 1]);
    }
    Ok(())
}

fn drift(all: &mut Found, hours: u32) -> Result<(), String> {
    let schuler_s =
        super::numbers::input("schuler period of the drift, s").ok_or("find the drift")?;
    let mut scorer = DriftScorer::new();
    for k in 0..=hours * 120 {
        let t_s = 30.0 * f64::from(k);
        let (s, c) = libm::sincos(2.0 * PI * t_s / schuler_s);
        let mut latitude = 0.3 + 0.9 * t_s / 86_400.0 + 0.2 * s - 0.1 * c;
        let mut longitude = -0.2 + 1.7 * t_s / 86_400.0 + 0.15 * s + 0.25 * c;
        if hours == 30 {
            let (s, c) = libm::sincos(black_box(EARTH_RATE_RADPS) * t_s);
            (latitude, longitude) = (latitude + 0.4 * s, longitude - 0.3 * c);
        }
        scorer.push(&DriftSample {
            t_s,
            position_error_rad: Some([
                latitude * black_box(RAD_PER_ARCMIN),
                longitude * black_box(RAD_PER_ARCMIN),
            ]),
            attitude_error: Some(CaseAngles {
                heading_rad: 2.0 * latitude * black_box(RAD_PER_ARCMIN),
                pitch_rad: -longitude * black_box(RAD_PER_ARCMIN),
                roll_rad: 0.5 * longitude * black_box(RAD_PER_ARCMIN),
            }),
            velocity_error_mps: Some([0.1 * latitude, -0.1 * longitude]),
            latitude_rad: black_box(30.5) * (PI / 180.0),
            height_m: 120.0,
        });
    }
    let scores = scorer.finish(HeightChannel::Held).map_err(|error| error.to_string())?;
    let mut put = |name: &str, value: f64| all.insert(format!("{name}, {hours} h"), value);
    for (axis, _, score) in scores.errors() {
        let score = score.ok_or_else(|| format!("find the score of the {axis}"))?;
        put(&format!("{axis} max"), score.max);
        put(&format!("{axis} rms"), score.rms);
        put(&format!("{axis} final"), score.r#final);
        put(&format!("{axis} slope per day"), score.slope_per_day.ok_or("find the slope")?);
        let schuler = score.schuler_amplitude.ok_or("find the Schuler part")?;
        put(&format!("{axis} schuler amplitude"), schuler);
    }
    let radial = scores.radial_error_nmi.ok_or("find the radial error")?;
    put("radial max", radial.max);
    put("radial rms", radial.rms);
    put("radial final", radial.r#final);
    put("rate per h", radial.rate_per_h);
    put("duration", scores.duration_h);
    let [_, latitude, longitude] = scores.series_hours.last().ok_or("find the series")?;
    put("latitude of the last point of the series", *latitude);
    put("longitude of the last point of the series", *longitude);
    put("slope window hours", scores.slope_window.ok_or("find the window of the slope")?.hours);
    if hours == 30 {
        let mark = scores.marks.get("24h").ok_or("find the scores at 24 h")?;
        for (axis, at, max) in [
            ("latitude", mark.latitude_arcmin, mark.latitude_max_arcmin),
            ("longitude", mark.longitude_arcmin, mark.longitude_max_arcmin),
            ("radial", mark.radial_nmi, mark.radial_max_nmi),
        ] {
            all.insert(format!("{axis} at 24 h"), at);
            all.insert(format!("{axis} max at 24 h"), max);
        }
    }
    Ok(())
}

fn floors(all: &mut Found) -> Result<(), String> {
    for (name, degrees) in black_box([("30.5 deg", 30.5), ("-60 deg", -60.0)]) {
        let noise = (0.0007 * DEG_PER_SQRT_HOUR, 50.0 * MICRO_G);
        let floor = Floor::new(degrees * DEG, 0.0, noise.0, noise.1).at_heading(90.0 * DEG);
        let summary = floor.summary(14_400.0);
        let last = summary.sigma.last().ok_or("find the points of the floor")?;
        for what in ["heading", "pitch", "roll", "north", "east"] {
            let value = summary.solution.and_then(|solution| solution.of(what));
            let value = value.ok_or_else(|| format!("find the floor of the {what}"))?;
            all.insert(format!("floor {what} final, {name}"), value.r#final);
            all.insert(format!("floor {what} rms, {name}"), value.rms);
        }
        for (what, value) in [
            ("latitude final", summary.latitude_final_arcmin),
            ("longitude final", summary.longitude_final_arcmin),
            ("latitude rms", summary.latitude_rms_arcmin),
            ("longitude rms", summary.longitude_rms_arcmin),
            ("radial rms", summary.radial_rms_nmi),
            ("first hours", summary.sigma[1].hours),
            ("last hours", last.hours),
            ("latitude of the last point", last.latitude_arcmin),
            ("longitude of the last point", last.longitude_arcmin),
        ] {
            all.insert(format!("floor {what}, {name}"), value);
        }
        let most = floor.maxima(&[2.0], 2, 7);
        let most = most.first().ok_or("find the largest errors")?;
        for (what, value) in
            [("latitude", most.latitude_arcmin), ("longitude", most.longitude_arcmin)]
        {
            all.insert(format!("floor largest {what} of two members, {name}"), value);
        }
        let gyro = 0.01 * DEG_PER_HOUR;
        for (error, of) in [
            ("gyro north", [gyro, 0.0, 0.0, 0.0, 0.0]),
            ("gyro east", [0.0, gyro, 0.0, 0.0, 0.0]),
            ("gyro down", [0.0, 0.0, gyro, 0.0, 0.0]),
            ("accel north", [0.0, 0.0, 0.0, 100.0 * MICRO_G, 0.0]),
        ] {
            let [latitude, longitude] = floor.propagate([0.0; 7], &of, 7200.0);
            let states = floor.propagate_states([0.0; 7], &of, 7200.0);
            let names = ["phi north", "phi east", "phi down", "velocity north", "velocity east"];
            for (what, state) in names.into_iter().zip(states) {
                all.insert(format!("{error} after 2 h, {what}, {name}"), state);
            }
            all.insert(format!("{error} after 2 h, latitude, {name}"), latitude);
            all.insert(format!("{error} after 2 h, longitude, {name}"), longitude);
        }
    }
    Ok(())
}
