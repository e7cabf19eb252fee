//! Checks of a configuration: every configuration that passes can be computed with.

use crate::config::{
    AidingKind, Dockside, Extensions, GaussMarkov, GimbalErrors, Motion, MotionTimes, PlantConfig,
    Sinusoid,
};
use octant_earth::units::DEG;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

/// Field of a configuration with a value out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct PlantConfigError {
    /// The field, as a path in the configuration.
    pub field: String,
    /// Value found.
    pub found: String,
    /// Values expected.
    pub expected: String,
}

type Check = Result<(), PlantConfigError>;

fn require(holds: bool, field: &str, found: impl ToString, expected: &str) -> Check {
    if holds {
        return Ok(());
    }
    let (field, found, expected) = (field.to_owned(), found.to_string(), expected.to_owned());
    Err(PlantConfigError { field, found, expected })
}

fn finite(field: &str, value: f64) -> Check {
    require(value.is_finite(), field, value, "a finite number")
}

fn all_finite(field: &str, values: &[f64]) -> Check {
    values
        .iter()
        .enumerate()
        .try_for_each(|(index, value)| finite(&format!("{field}[{index}]"), *value))
}

fn not_negative(field: &str, value: f64) -> Check {
    require(value.is_finite() && value >= 0.0, field, value, "a finite number, 0 or more")
}

fn positive(field: &str, value: f64) -> Check {
    require(value.is_finite() && value > 0.0, field, value, "a finite number above 0")
}

fn within(field: &str, value: f64, limit: f64, expected: &str) -> Check {
    require(value.abs() <= limit, field, value, expected)
}

/// Checks every field.
pub(crate) fn validate(config: &PlantConfig) -> Check {
    let period_ns = config.sample_period_ns;
    require(
        (10_000..=1_000_000_000).contains(&period_ns),
        "sample_period_ns",
        period_ns,
        "10000 (100 kHz) to 1000000000 (1 Hz)",
    )?;
    within("site.latitude_rad", config.site.latitude_rad, 89.9 * DEG, "within ±89.9 deg")?;
    finite("site.longitude_rad", config.site.longitude_rad)?;
    within("site.height_m", config.site.height_m, 1e5, "within ±100 km")?;
    let gravity = &config.site.gravity;
    for (field, angle) in [
        ("site.gravity.deflection_north_rad", gravity.deflection_north_rad),
        ("site.gravity.deflection_east_rad", gravity.deflection_east_rad),
    ] {
        within(field, angle, 0.01, "within ±0.01 rad")?;
    }
    within("site.gravity.anomaly_mps2", gravity.anomaly_mps2, 0.1, "within ±0.1 m/s²")?;
    match &config.motion {
        Motion::Static(attitude) => all_finite(
            "motion.attitude",
            &[attitude.heading_rad, attitude.pitch_rad, attitude.roll_rad],
        )?,
        Motion::Dockside(ship) => dockside(ship)?,
    }

    let table = &config.turntable;
    positive("turntable.rate_radps", table.rate_radps)?;
    within("turntable.rate_radps", table.rate_radps, 100.0, "at most 100 rad/s")?;
    positive("turntable.acceleration_radps2", table.acceleration_radps2)?;
    not_negative("turntable.encoder_sigma_rad", table.encoder_sigma_rad)?;
    within(
        "turntable.non_orthogonality_rad",
        table.non_orthogonality_rad,
        10.0 * DEG,
        "within ±10 deg",
    )?;
    not_negative("turntable.backlash_rad", table.backlash_rad)?;
    gimbals(&table.errors)?;

    let imu = &config.imu;
    for (value, name) in imu.parameters.to_array().iter().zip(octant_sample::parameters::NAMES) {
        finite(&format!("imu.parameters.{name}"), *value)?;
    }
    not_negative("imu.angle_random_walk", imu.angle_random_walk)?;
    not_negative("imu.velocity_random_walk", imu.velocity_random_walk)?;
    extensions(&imu.extensions, period_ns as f64 * 1e-9)?;

    let aiding_ns = config.aiding.period_ns;
    require(
        aiding_ns > 0 && aiding_ns.is_multiple_of(period_ns),
        "aiding.period_ns",
        aiding_ns,
        &format!("a multiple of the sample period, {period_ns} ns"),
    )?;
    match config.aiding.kind {
        AidingKind::ZeroVelocity { sigma_mps } | AidingKind::Velocity { sigma_mps } => {
            not_negative("aiding.sigma_mps", sigma_mps)
        }
        AidingKind::DockPosition { sigma_m } => not_negative("aiding.sigma_m", sigma_m),
    }
}

fn gimbals(errors: &GimbalErrors) -> Check {
    let GimbalErrors { mounting_rad, encoder_zero_rad, eccentricity_rad, encoder_noise_rad } =
        errors;
    for (name, angles) in [
        ("mounting_rad", &mounting_rad[..]),
        ("encoder_zero_rad", &encoder_zero_rad[..]),
        ("eccentricity_rad", eccentricity_rad.as_flattened()),
    ] {
        for (index, angle) in angles.iter().enumerate() {
            let field = format!("turntable.errors.{name}[{index}]");
            within(&field, *angle, 10.0 * DEG, "within ±10 deg")?;
        }
    }
    not_negative("turntable.errors.encoder_noise_rad", *encoder_noise_rad)
}

fn dockside(ship: &Dockside) -> Check {
    let mean = &ship.mean;
    all_finite("motion.mean", &[mean.heading_rad, mean.pitch_rad, mean.roll_rad])?;
    for (index, offset) in ship.mooring_offset_m.iter().enumerate() {
        let field = format!("motion.mooring_offset_m[{index}]");
        within(&field, *offset, 1e4, "within ±10 km")?;
    }
    let groups: [(&str, &[Sinusoid], f64); 6] = [
        ("roll", &ship.roll, 1.5),
        ("pitch", &ship.pitch, 1.5),
        ("yaw", &ship.yaw, 3.2),
        ("surge", &ship.surge, 1e3),
        ("sway", &ship.sway, 1e3),
        ("heave", &ship.heave, 1e3),
    ];
    for (name, sinusoids, limit) in groups {
        for (index, sinusoid) in sinusoids.iter().enumerate() {
            let field = |part: &str| format!("motion.{name}[{index}].{part}");
            let expected = format!("within ±{limit} rad or m");
            within(&field("amplitude"), sinusoid.amplitude, limit, &expected)?;
            let period_s = sinusoid.period_s;
            let allowed = (0.01..=1e7).contains(&period_s);
            require(allowed, &field("period_s"), period_s, "0.01 s to 1e7 s")?;
            finite(&field("phase_rad"), sinusoid.phase_rad)?;
        }
    }
    times(&ship.times)
}

/// Checks that intervals follow one another, and are as long as their two ramps.
fn times(MotionTimes { during_s, ramp_s }: &MotionTimes) -> Check {
    not_negative("motion.times.ramp_s", *ramp_s)?;
    let mut last_s = f64::NEG_INFINITY;
    for (index, [from_s, to_s]) in during_s.iter().enumerate() {
        let field = |end: usize| format!("motion.times.during_s[{index}][{end}]");
        finite(&field(0), *from_s)?;
        require(*from_s >= last_s, &field(0), *from_s, "after the interval before it")?;
        finite(&field(1), *to_s)?;
        let long = *to_s > *from_s && to_s - from_s >= 2.0 * ramp_s;
        require(long, &field(1), *to_s, "after the interval's beginning, by two ramps or more")?;
        last_s = *to_s;
    }
    Ok(())
}

fn gauss_markov(field: &str, process: Option<&GaussMarkov>) -> Check {
    let Some(process) = process else { return Ok(()) };
    not_negative(&format!("{field}.sigma"), process.sigma)?;
    positive(&format!("{field}.correlation_time_s"), process.correlation_time_s)
}

fn extensions(e: &Extensions, period_s: f64) -> Check {
    let path = |name: &str| format!("imu.extensions.{name}");
    gauss_markov(&path("gyro_gauss_markov"), e.gyro_gauss_markov.as_ref())?;
    gauss_markov(&path("accel_gauss_markov"), e.accel_gauss_markov.as_ref())?;
    not_negative(&path("gyro_rate_random_walk"), e.gyro_rate_random_walk)?;
    not_negative(&path("gyro_bias_instability"), e.gyro_bias_instability)?;
    not_negative(&path("accel_bias_instability"), e.accel_bias_instability)?;
    let quanta = [
        ("gyro_quantization_rad", e.gyro_quantization_rad, DELTA_THETA_LSB_RAD),
        ("accel_quantization_mps", e.accel_quantization_mps, DELTA_VELOCITY_LSB_MPS),
    ];
    for (name, quantum, lsb) in quanta {
        require(
            quantum == 0.0 || (quantum.is_finite() && quantum >= lsb),
            &path(name),
            quantum,
            &format!("0, or at least the resolution of the format, {lsb:e}"),
        )?;
    }
    not_negative(&path("gyro_range_radps"), e.gyro_range_radps)?;
    not_negative(&path("accel_range_mps2"), e.accel_range_mps2)?;
    if let Some(t) = &e.temperature {
        finite(&path("temperature.ramp_kps"), t.ramp_kps)?;
        finite(&path("temperature.plateau_k"), t.plateau_k)?;
        require(
            t.ramp_kps * t.plateau_k > 0.0 || (t.ramp_kps == 0.0 && t.plateau_k == 0.0),
            &path("temperature.plateau_k"),
            t.plateau_k,
            "of the sign of the ramp (a ramp that never reaches its plateau is an error)",
        )?;
        all_finite(&path("temperature.gyro_bias_per_k"), &t.gyro_bias_per_k)?;
        all_finite(&path("temperature.accel_bias_per_k"), &t.accel_bias_per_k)?;
        all_finite(&path("temperature.gyro_scale_per_k"), &t.gyro_scale_per_k)?;
        all_finite(&path("temperature.accel_scale_per_k"), &t.accel_scale_per_k)?;
    }
    if let Some(v) = &e.vibration {
        positive(&path("vibration.frequency_hz"), v.frequency_hz)?;
        require(
            v.frequency_hz * period_s <= 100.0,
            &path("vibration.frequency_hz"),
            v.frequency_hz,
            "at most 100 cycles in a sample period",
        )?;
        for axis in 0..3 {
            let displacement = path(&format!("vibration.displacement_m[{axis}]"));
            within(&displacement, v.displacement_m[axis], 1.0, "within ±1 m")?;
            let angle = path(&format!("vibration.angle_rad[{axis}]"));
            within(&angle, v.angle_rad[axis], 0.1, "within ±0.1 rad")?;
        }
        finite(&path("vibration.phase_rad"), v.phase_rad)?;
    }
    for (row, arm) in e.lever_arm_m.iter().enumerate() {
        for (column, value) in arm.iter().enumerate() {
            let field = path(&format!("lever_arm_m[{row}][{column}]"));
            within(&field, *value, 10.0, "within ±10 m")?;
        }
    }
    for (name, values, limit) in [
        ("gyro_asymmetry", &e.gyro_asymmetry, 0.5),
        ("accel_asymmetry", &e.accel_asymmetry, 0.5),
        ("accel_quadratic", &e.accel_quadratic, 0.01),
    ] {
        for (axis, value) in values.iter().enumerate() {
            let field = path(&format!("{name}[{axis}]"));
            within(&field, *value, limit, &format!("within ±{limit}"))?;
        }
    }
    require(
        (0.0..=1.0).contains(&e.time_skew_s),
        &path("time_skew_s"),
        e.time_skew_s,
        "0 to 1 s (a stamp can't be before the motion that it stands for)",
    )
}
