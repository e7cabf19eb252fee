//! An instrument without errors that stands level and heads north: rates, their noise, and the scenario that calibrates it.

/// Latitude of the instrument, deg.
const LATITUDE_DEG: f64 = 30.5;
/// Gravity there on the ellipsoid, m/s².
const GRAVITY_MPS2: f64 = 9.793_24;
/// Time of the first reading, s.
pub const BEGIN_S: f64 = 10.0;
/// Number of readings of a whole run, at [`RATE_HZ`].
pub const COUNT: u64 = 3000;
/// Rate, Hz.
pub const RATE_HZ: f64 = 50.0;

/// A reading with its stamp.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// Stamp, s.
    pub time_s: f64,
    /// Rates, rad/s, and specific force, m/s².
    pub values: [f64; 6],
}

/// Readings at a rate, Hz. Their noise is a fixed sequence, a twentieth of what the scenario states.
pub fn readings(rate_hz: f64, count: u64) -> Vec<Rest> {
    const EARTH_RATE_RADPS: f64 = 7.292_115e-5;
    let (sine, cosine) = LATITUDE_DEG.to_radians().sin_cos();
    let rates = [EARTH_RATE_RADPS * cosine, 0.0, -EARTH_RATE_RADPS * sine, 0.0, 0.0, -GRAVITY_MPS2];
    let mut uniform = uniform(1);
    (0..count)
        .map(|k| {
            let mut values = rates;
            for (axis, value) in values.iter_mut().enumerate() {
                // A sum of four uniform numbers has a standard deviation of 1/√3.
                let sum: f64 = (0..4).map(|_| uniform() - 0.5).sum();
                *value += sum * 3_f64.sqrt() * if axis < 3 { 1e-6 } else { 1e-4 };
            }
            Rest { time_s: BEGIN_S + k as f64 / rate_hz, values }
        })
        .collect()
}

/// Fixed sequence of numbers from 0 to 1.
pub fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Scenario that calibrates it for a minute, with the source's tables.
pub fn scenario(source: &str) -> String {
    format!(
        "schema = 1
[site]
latitude = \"{LATITUDE_DEG} deg\"
longitude = \"114 deg\"
[imu]
rate = \"{RATE_HZ} Hz\"
angle_random_walk = \"0.01 deg/sqrt(h)\"
velocity_random_walk = \"50 ug/sqrt(Hz)\"
[procedure.alignment]
method = \"given\"
[procedure.calibration]
duration = \"1 min\"
stops = [{{ azimuth = \"0 deg\", roll = \"0 deg\" }}]
[source]
{source}
[source.reference]
kind = \"static\"
[[requirements]]
id = \"BIAS\"
text = \"The vertical accelerometer bias is known.\"
measure = \"calibration.parameters.accel_bias_z.sigma\"
limit = \"0.1 mg\"
"
    )
}
