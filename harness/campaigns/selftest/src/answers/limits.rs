//! Values on both sides of limits of which no result consists: what is accepted, and where a screen
//! gives up.

use super::numbers::{Found, input};
use nalgebra::Vector3;
use octant_calibration::config::{
    Base, BaseMotion, GyroReference, LeastSquares, Noise, Screening, Site, StaticIntervals,
    TurntableRates,
};
use octant_calibration::least_squares::LeastSquaresEstimator;
use octant_calibration::screen::Screen;
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{Parameters, Sample};
use octant_scenario::Scenario;
use std::hint::black_box;
use std::path::Path;

/// Keys of a scenario with the unit of their limits; the values next to the limits are inputs.
const KEYS: [(&str, &str, &str); 1] = [("site", "latitude", "deg")];

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    keys(&mut all)?;
    jumps(&mut all)?;
    turned(&mut all)?;
    Ok(all)
}

fn given(name: &str) -> Result<f64, String> {
    input(name).ok_or_else(|| format!("find the input {name}"))
}

/// Reads scenarios with a value just inside and just outside of a limit: 1 is accepted, 0 refused.
fn keys(all: &mut Found) -> Result<(), String> {
    for (section, key, unit) in KEYS {
        for side in ["low", "high"] {
            for place in ["inside", "outside"] {
                let name = format!("{section}.{key}, {side}, {place}");
                let value = given(&name)?;
                let text = format!(
                    "schema = 1\n[procedure.navigation]\nduration = \"1 h\"\n[{section}]\n\
                     {key} = \"{value} {unit}\"\n"
                );
                let read = Scenario::parse(&text, "answers.toml", Path::new("."), &[]);
                all.insert(name, f64::from(u8::from(read.is_ok())));
            }
        }
    }
    Ok(())
}

/// Makes screens of accelerometers whose jump limit is just below and just above the largest one
/// that is still tested; a limit that isn't is larger than every difference.
fn jumps(all: &mut Found) -> Result<(), String> {
    for side in ["below", "above"] {
        let name = format!("jump limit {side} the largest");
        let screening = Screening {
            base: Base::Moving(BaseMotion {
                angle_rad: 0.0,
                rate_radps: 0.0,
                acceleration_radps2: 0.0,
                force_mps2: 0.0,
                jerk_mps3: given(&format!("{name}, jerk"))?,
            }),
            jumps: true,
            ..Screening::none()
        };
        let noise = Noise { angle_random_walk: 1e-3, velocity_random_walk: 0.3 };
        let still = TurntableRates { rate_radps: 0.0, acceleration_radps2: 0.0 };
        let text = format!("{:?}", black_box(Screen::new(&screening, &noise, &still, 0.005)));
        let limits = super::core::of_field(&text, "limits")?;
        for (gimbals, at) in [("resting", 3), ("moving", 9)] {
            let limit = limits.get(at).copied().ok_or("find the limits")?;
            all.insert(format!("{name}, gimbals {gimbals}"), limit);
        }
    }
    Ok(())
}

/// Turns between two static intervals of the least-squares estimator, by nearly a fifth of a radian
/// a sample about a skew axis. Counts end at a 32nd: the gyros show a quarter of the turn.
fn turned(all: &mut Found) -> Result<(), String> {
    let settings = LeastSquares {
        gravity_mps2: None,
        gyro: GyroReference::EarthRate,
        intervals: StaticIntervals::Commanded,
    };
    let site = Site { latitude_rad: 0.5, longitude_rad: 0.2, height_m: 0.0 };
    let period_s = 0.01;
    let quarter = Parameters { gyro_scale: [-0.75; 3], ..Parameters::default() };
    let mut estimator = LeastSquaresEstimator::new(&settings, &site, 10_000_000, &quarter)
        .map_err(|why| why.to_string())?;
    let turn = Vector3::new(given("turn x")?, given("turn y")?, given("turn z")?);
    let counts = turn.map(|angle| (angle / DELTA_THETA_LSB_RAD) as i32);
    let moving = 200..200 + given("samples of the turn")? as u64;
    for sequence in 0..moving.end + 200 {
        let moves = moving.contains(&sequence);
        let delta_theta = if moves { counts.into() } else { [0; 3] };
        let sample = Sample { sequence, delta_theta, ..Sample::default() };
        estimator.step(&black_box(sample), period_s, Some(!moves));
    }
    let text = format!("{estimator:?}");
    // The move up to the present standstill.
    let at = text.find(" arrival: ").ok_or("find the move")?;
    let rotation = super::core::of_field(&text[at..], "rotation")?;
    for (name, part) in ["i", "j", "k", "w"].into_iter().zip(rotation) {
        all.insert(format!("turned {name}"), part);
    }
    Ok(())
}
