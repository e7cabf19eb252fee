//! The sensors, the gimbals and the motion of the case.

use super::reader::Reader;
use crate::error::Problem;
use crate::model::{Component, Distribution, Dockside, MOTIONS, Motion, ShipSpectrum};
use octant_earth::units::DEG;
use octant_plant::config as plant;
use octant_sample::parameters::Group;

/// Sample period of a rate: whole nanoseconds.
pub(super) fn sample_period_ns(imu: &Reader<'_>) -> Result<u64, Problem> {
    let rate_hz = imu.si("rate")?;
    let period_ns = 1e9 / rate_hz;
    if (period_ns - period_ns.round()).abs() > 1e-6 {
        let found = imu.text("rate")?;
        return Err(imu.problem(
            "rate",
            format!("found {found:?}, a period of {period_ns} ns, expected a whole number of ns"),
        ));
    }
    Ok(period_ns.round() as u64)
}

pub(super) fn parameters(imu: &Reader<'_>) -> Result<[Distribution; 7], Problem> {
    let mut all = [const { Distribution::Normal(0.0) }; 7];
    for (distribution, group) in all.iter_mut().zip(Group::ALL) {
        let table = imu.table(group.name())?;
        *distribution = if let Some(sigma) = table.optional_si("normal") {
            Distribution::Normal(sigma)
        } else if let Some(half_width) = table.optional_si("uniform") {
            Distribution::Uniform(half_width)
        } else if let Some(values) = table.optional_si_vec("constant") {
            Distribution::Constant(values)
        } else {
            return Err(imu.problem(group.name(), "expected one of normal, uniform, constant"));
        };
    }
    Ok(all)
}

pub(super) fn imu(imu: &Reader<'_>) -> Result<plant::Imu, Problem> {
    let more = imu.table("extensions")?;
    let gauss_markov = |key: &str| -> Result<Option<plant::GaussMarkov>, Problem> {
        let Some(table) = more.optional_table(key) else { return Ok(None) };
        Ok(Some(plant::GaussMarkov {
            sigma: table.si("sigma")?,
            correlation_time_s: table.si("correlation_time")?,
        }))
    };
    let arm = more.table("lever_arm")?;
    Ok(plant::Imu {
        parameters: octant_sample::Parameters::default(),
        angle_random_walk: imu.si("angle_random_walk")?,
        velocity_random_walk: imu.si("velocity_random_walk")?,
        extensions: plant::Extensions {
            gyro_gauss_markov: gauss_markov("gyro_gauss_markov")?,
            accel_gauss_markov: gauss_markov("accel_gauss_markov")?,
            gyro_rate_random_walk: more.si("gyro_rate_random_walk")?,
            gyro_quantization_rad: more.si("gyro_quantization")?,
            accel_quantization_mps: more.si("accel_quantization")?,
            gyro_range_radps: more.si("gyro_range")?,
            accel_range_mps2: more.si("accel_range")?,
            temperature: temperature(&more)?,
            vibration: vibration(&more)?,
            lever_arm_m: [arm.si_array("x")?, arm.si_array("y")?, arm.si_array("z")?],
            time_skew_s: more.si("time_skew")?,
        },
    })
}

fn temperature(more: &Reader<'_>) -> Result<Option<plant::Temperature>, Problem> {
    let Some(table) = more.optional_table("temperature") else { return Ok(None) };
    let (ramp_kps, plateau_k) = (table.si("ramp")?, table.si("plateau")?);
    if ramp_kps * plateau_k < 0.0 || (ramp_kps == 0.0) != (plateau_k == 0.0) {
        let (ramp, plateau) = (table.text("ramp")?, table.text("plateau")?);
        return Err(table.problem(
            "plateau",
            format!("found {plateau:?} with a ramp of {ramp:?}, which never gets there"),
        ));
    }
    Ok(Some(plant::Temperature {
        ramp_kps,
        plateau_k,
        gyro_bias_per_k: table.si_array("gyro_bias")?,
        accel_bias_per_k: table.si_array("accel_bias")?,
        gyro_scale_per_k: table.si_array("gyro_scale")?,
        accel_scale_per_k: table.si_array("accel_scale")?,
    }))
}

fn vibration(more: &Reader<'_>) -> Result<Option<plant::Vibration>, Problem> {
    let Some(table) = more.optional_table("vibration") else { return Ok(None) };
    Ok(Some(plant::Vibration {
        frequency_hz: table.si("frequency")?,
        displacement_m: table.si_array("displacement")?,
        angle_rad: table.si_array("angle")?,
        phase_rad: table.si("phase")?,
    }))
}

pub(super) fn turntable(table: &Reader<'_>) -> Result<plant::Turntable, Problem> {
    Ok(plant::Turntable {
        rate_radps: table.si("rate")?,
        acceleration_radps2: table.si("acceleration")?,
        encoder_sigma_rad: table.si("encoder_error")?,
        non_orthogonality_rad: table.si("non_orthogonality")?,
        backlash_rad: table.si("backlash")?,
    })
}

/// Amplitude (deg or m) and period (s) of the presets, in the order of [`MOTIONS`].
const DEFAULT_SWAY: [(f64, f64); 6] =
    [(3.0, 8.0), (1.5, 6.0), (1.0, 10.0), (0.2, 6.0), (0.2, 7.0), (0.2, 8.0)];
/// The dynamic condition of ISO 8728: harmonic roll and pitch of 5°, horizontal acceleration up to
/// 0.22 m/s², periods from 6 to 15 s.
const SEVERE_SWAY: [(f64, f64); 6] =
    [(5.0, 10.0), (5.0, 8.0), (1.0, 12.0), (0.25, 8.5), (0.25, 8.0), (0.3, 8.0)];

pub(super) fn motion(motion: &Reader<'_>) -> Result<Motion, Problem> {
    let mean = plant::CaseAttitude {
        heading_rad: motion.si("heading")?,
        pitch_rad: motion.si("pitch")?,
        roll_rad: motion.si("roll")?,
    };
    if motion.text("kind")? == "static" {
        return Ok(Motion::Static(mean));
    }
    let ship = motion.table("ship")?;
    let preset = match ship.text("preset")? {
        "default" => Some(DEFAULT_SWAY),
        "severe" => Some(SEVERE_SWAY),
        _ => None,
    };
    let mut components: [Vec<Component>; 6] = Default::default();
    for (index, key) in MOTIONS.into_iter().enumerate() {
        if ship.given(key) {
            for table in ship.tables(key) {
                components[index].push(Component {
                    amplitude: table.si("amplitude")?,
                    period_s: table.si("period")?,
                    phase_rad: table.optional_si("phase"),
                });
            }
        } else if let Some(preset) = preset {
            let (amplitude, period_s) = preset[index];
            let unit = if index < 3 { DEG } else { 1.0 };
            let amplitude = amplitude * unit;
            components[index].push(Component { amplitude, period_s, phase_rad: None });
        }
    }
    let spectrum = match ship.optional_table("spectrum") {
        None => None,
        Some(spectrum) => {
            let mut sigma = [0.0; 6];
            for (sigma, key) in sigma.iter_mut().zip(MOTIONS) {
                *sigma = spectrum.si(key)?;
            }
            let components: u32 = spectrum.integer("components")?;
            Some(ShipSpectrum {
                peak_period_s: spectrum.si("peak_period")?,
                sigma,
                components: components as usize,
            })
        }
    };
    let mooring_offset_m = ship.si_array("mooring_offset")?;
    Ok(Motion::Dockside(Dockside { mean, components, spectrum, mooring_offset_m }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_severe_preset_keeps_the_horizontal_acceleration_of_iso_8728() {
        let acceleration =
            |(amplitude, period): (f64, f64)| amplitude * (std::f64::consts::TAU / period).powi(2);
        let [.., surge, sway, _] = SEVERE_SWAY;
        let horizontal = acceleration(surge).hypot(acceleration(sway));
        assert!((0.19..=0.22).contains(&horizontal), "{horizontal} m/s²");
    }
}
