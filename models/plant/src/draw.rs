//! Drawing an instrument from a seed: true parameters, further errors, initial alignment, phases of the sway.
//!
//! Every group has its own stream, so that a change of one distribution changes no other group.

use octant_earth::units::{ARCSEC, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, MICRO_G, PPM};
use octant_random::normal::{Ziggurat, uniform};
use octant_random::philox::block;
use octant_random::stream::{Phase, key};
use octant_sample::Parameters;
use octant_sample::further::{FURTHER_COUNT, FurtherGroup};

/// Distribution of a group of N parameters, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw<const N: usize> {
    /// Independent, Gaussian, mean zero.
    Normal {
        /// Standard deviation.
        sigma: f64,
    },
    /// Independent, uniform within ± the half width.
    Uniform {
        /// Largest magnitude.
        half_width: f64,
    },
    /// Constant, not drawn.
    Constant([f64; N]),
}

/// Distributions of all groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterDraws {
    /// b_g, rad/s.
    pub gyro_bias: Draw<3>,
    /// Diagonal of M_g.
    pub gyro_scale: Draw<3>,
    /// Off-diagonal of M_g, rad.
    pub gyro_misalignment: Draw<6>,
    /// G, (rad/s)/(m/s²).
    pub g_dependent: Draw<9>,
    /// b_a, m/s².
    pub accel_bias: Draw<3>,
    /// Diagonal of M_a.
    pub accel_scale: Draw<3>,
    /// Lower triangle of M_a, rad.
    pub accel_misalignment: Draw<3>,
}

impl ParameterDraws {
    /// The reference instrument of Zheng, Han and Zheng (2015), table 1: biases and G Gaussian,
    /// scale factors and misalignments uniform within the table's limits.
    #[must_use]
    pub fn table_1() -> Self {
        Self {
            gyro_bias: Draw::Normal { sigma: 0.005 * DEG_PER_HOUR },
            gyro_scale: Draw::Uniform { half_width: 30.0 * PPM },
            gyro_misalignment: Draw::Uniform { half_width: 40.0 * ARCSEC },
            g_dependent: Draw::Normal { sigma: 0.0005 * DEG_PER_HOUR_PER_G },
            accel_bias: Draw::Normal { sigma: 100.0 * MICRO_G },
            accel_scale: Draw::Uniform { half_width: 30.0 * PPM },
            accel_misalignment: Draw::Uniform { half_width: 40.0 * ARCSEC },
        }
    }
}

/// N standard normals of a stream.
fn normals<const N: usize>(seed: u64, name: &str) -> [f64; N] {
    let key = key(seed, name, Phase::Draw);
    let mut all = [0.0; N];
    for (counter, chunk) in all.chunks_mut(3).enumerate() {
        let drawn = Ziggurat::shared().three(key, counter as u64);
        chunk.copy_from_slice(&drawn[..chunk.len()]);
    }
    all
}

/// Uniform number in (0, 1) at an index of a stream.
pub(crate) fn uniform_at(seed: u64, name: &str, index: u64) -> f64 {
    uniform(block(key(seed, name, Phase::Draw), [index, 0, 0, 0])[0])
}

fn group<const N: usize>(seed: u64, name: &str, draw: &Draw<N>) -> [f64; N] {
    match draw {
        Draw::Normal { sigma } => normals(seed, name).map(|n: f64| sigma * n),
        Draw::Uniform { half_width } => {
            core::array::from_fn(|i| half_width * (2.0 * uniform_at(seed, name, i as u64) - 1.0))
        }
        Draw::Constant(values) => *values,
    }
}

/// Draws the true parameters of the instrument with this seed.
#[must_use]
pub fn parameters(seed: u64, draws: &ParameterDraws) -> Parameters {
    Parameters {
        gyro_bias: group(seed, "draw.gyro_bias", &draws.gyro_bias),
        gyro_scale: group(seed, "draw.gyro_scale", &draws.gyro_scale),
        gyro_misalignment: group(seed, "draw.gyro_misalignment", &draws.gyro_misalignment),
        g_dependent: group(seed, "draw.g_dependent", &draws.g_dependent),
        accel_bias: group(seed, "draw.accel_bias", &draws.accel_bias),
        accel_scale: group(seed, "draw.accel_scale", &draws.accel_scale),
        accel_misalignment: group(seed, "draw.accel_misalignment", &draws.accel_misalignment),
    }
}

/// Draws the errors beside the parameters, in the order of [`octant_sample::further::FURTHER_NAMES`], from the
/// distribution of each group. The stream of a group is `draw.NAME`, and its errors are the first numbers of it.
#[must_use]
pub fn further(seed: u64, draws: &[Draw<9>; 15]) -> [f64; FURTHER_COUNT] {
    let mut all = [0.0; FURTHER_COUNT];
    for (of, draw) in FurtherGroup::ALL.iter().zip(draws) {
        let drawn = group(seed, &format!("draw.{}", of.name()), draw);
        let errors = &mut all[of.range()];
        errors.copy_from_slice(&drawn[..errors.len()]);
    }
    all
}

/// Error of an initial alignment: computed − true.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlignmentError {
    /// Attitude error φ in n (north, east, down), rad: `c_nb(computed) = (I − [φ×]) c_nb(true)`.
    pub phi_rad: [f64; 3],
    /// Velocity error in n, m/s.
    pub velocity_mps: [f64; 3],
}

/// Draws a Gaussian alignment error: tilt (north and east) and azimuth in rad, velocity of each
/// axis in m/s, 1σ.
#[must_use]
pub fn alignment_error(
    seed: u64,
    tilt_sigma_rad: f64,
    azimuth_sigma_rad: f64,
    velocity_sigma_mps: f64,
) -> AlignmentError {
    let [north, east, down] = normals(seed, "draw.alignment.attitude");
    AlignmentError {
        phi_rad: [tilt_sigma_rad * north, tilt_sigma_rad * east, azimuth_sigma_rad * down],
        velocity_mps: normals(seed, "draw.alignment.velocity").map(|n: f64| velocity_sigma_mps * n),
    }
}

/// Draws `n` phases, uniform in (0, 2π) rad, from the stream `draw.phase.NAME`.
#[must_use]
pub fn phases(seed: u64, name: &str, n: usize) -> Vec<f64> {
    let stream = format!("draw.phase.{name}");
    (0..n as u64).map(|i| 2.0 * core::f64::consts::PI * uniform_at(seed, &stream, i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_drawn_apart() {
        let all = parameters(3, &ParameterDraws::table_1());
        let mut draws = ParameterDraws::table_1();
        draws.gyro_bias = Draw::Constant([1.0, 2.0, 3.0]);
        draws.g_dependent = Draw::Normal { sigma: 0.005 * DEG_PER_HOUR_PER_G };
        let other = parameters(3, &draws);
        assert_eq!(other.gyro_bias, [1.0, 2.0, 3.0]);
        assert_eq!(other.accel_bias, all.accel_bias);
        assert_eq!(other.gyro_misalignment, all.gyro_misalignment);
        for i in 0..9 {
            assert!((other.g_dependent[i] / all.g_dependent[i] - 10.0).abs() < 1e-12);
        }
        assert_ne!(parameters(4, &ParameterDraws::table_1()).gyro_scale, all.gyro_scale);
    }

    /// Each group has numbers of its own, its own alone, and none of the parameters'.
    #[test]
    fn further_errors_are_drawn_apart() {
        let none = Draw::Constant([0.0; 9]);
        let all = further(3, &[Draw::Normal { sigma: 1.0 }; 15]);
        let parameters = parameters(3, &ParameterDraws::table_1()).to_array();
        for (place, of) in FurtherGroup::ALL.into_iter().enumerate() {
            let mut draws = [none; 15];
            draws[place] = Draw::Normal { sigma: 2.0 };
            for (index, value) in further(3, &draws).into_iter().enumerate() {
                let expected = if of.range().contains(&index) { 2.0 * all[index] } else { 0.0 };
                assert_eq!(value, expected, "{}: {index}", of.name());
            }
        }
        let (mut sorted, count) = (all.to_vec(), all.len());
        sorted.extend(parameters.iter().map(|value| value / (0.005 * DEG_PER_HOUR)));
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        assert_eq!(sorted.len(), count + parameters.len());
        let mut uniform = [none; 15];
        uniform[0] = Draw::Uniform { half_width: 0.5 };
        assert!(further(3, &uniform)[..9].iter().all(|value| value.abs() < 0.5 && *value != 0.0));
    }

    #[test]
    fn distributions_over_many_seeds() {
        let (n, mut squares, mut largest, mut uniform_squares) = (4000, 0.0, 0.0f64, 0.0);
        let mut products = 0.0;
        for seed in 0..n {
            let p = parameters(seed, &ParameterDraws::table_1());
            squares += (p.gyro_bias[1] / (0.005 * DEG_PER_HOUR)).powi(2);
            products += p.gyro_bias[0] * p.gyro_bias[1] / (0.005 * DEG_PER_HOUR).powi(2);
            largest = largest.max((p.accel_scale[2] / (30.0 * PPM)).abs());
            uniform_squares += (p.accel_scale[2] / (30.0 * PPM)).powi(2);
        }
        let n = n as f64;
        // Five standard errors: Var x² is 2 for the normal, 1/5 − 1/9 for the uniform, 1 for xy.
        assert!((squares / n - 1.0).abs() < 5.0 * (2.0 / n).sqrt());
        assert!((products / n).abs() < 5.0 / n.sqrt());
        assert!((uniform_squares / n - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt());
        assert!(largest < 1.0 && largest > 0.99);
    }

    #[test]
    fn alignment_errors_have_their_sizes() {
        let (mut tilt, mut azimuth, mut velocity) = (0.0, 0.0, 0.0);
        for seed in 0..4000 {
            let error = alignment_error(seed, 2.0, 3.0, 4.0);
            tilt += error.phi_rad[1].powi(2);
            azimuth += error.phi_rad[2].powi(2);
            velocity += error.velocity_mps[0].powi(2);
        }
        let bound = 5.0 * (2.0f64 / 4000.0).sqrt();
        assert!((tilt / 4000.0 / 4.0 - 1.0).abs() < bound);
        assert!((azimuth / 4000.0 / 9.0 - 1.0).abs() < bound);
        assert!((velocity / 4000.0 / 16.0 - 1.0).abs() < bound);
    }
}
