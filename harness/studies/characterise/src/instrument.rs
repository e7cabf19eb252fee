//! The `[imu]` section of a scenario with the noise that a recording shows.
//!
//! A scenario has one value for the three axes of a triad: the root of the mean square of the axes, where an axis that
//! doesn't show a term counts as none of it. The correlation time is the geometric mean of the axes that show it.
//! Coefficients of temperature are those of each axis.

use super::analysis::{ChannelAnalysis, RestAnalysis};
use super::kernel::RandomTerm;
use super::temperature::{TemperatureDependence, TemperatureFit};
use octant_scenario::UnitDimension;
use std::fmt::Write as _;

/// A scenario with the instrument, and what it can't hold.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentFile {
    /// The scenario, TOML.
    pub text: String,
    /// What the recording shows and the plant doesn't model.
    pub left_out: Vec<String>,
}

/// Value of a triad: root of the mean square over its axes.
fn triad(channels: &[ChannelAnalysis], term: RandomTerm) -> f64 {
    let square = |channel: &ChannelAnalysis| {
        let fit = channel.noise.as_ref().and_then(|noise| noise.term(term));
        let value = fit.and_then(|fit| fit.value).unwrap_or(0.0);
        value * value
    };
    libm::sqrt(channels.iter().map(square).sum::<f64>() / channels.len().max(1) as f64)
}

/// Correlation time of a triad, s.
fn correlation_time_s(channels: &[ChannelAnalysis]) -> Option<f64> {
    let times: Vec<f64> = channels
        .iter()
        .filter_map(|channel| Some(channel.noise.as_ref()?.correlation_time?.value_s))
        .collect();
    let count = times.len() as f64;
    (!times.is_empty())
        .then(|| libm::exp(times.iter().map(|time| libm::log(*time)).sum::<f64>() / count))
}

/// Writes the scenario of an instrument; without a temperature its biases stay as they are.
#[must_use]
pub fn instrument_file(
    analysis: &RestAnalysis,
    (period_ns, name): (u64, &str),
    warmth: Option<&TemperatureDependence>,
) -> InstrumentFile {
    let (gyros, accelerometers) = analysis.channels.split_at(3.min(analysis.channels.len()));
    let mut left_out = Vec::new();
    let mut text = String::new();
    let title = name.replace(['"', '\\'], "_");
    let _ = writeln!(
        text,
        "# The noise of an instrument as octant characterise found it in a recording at rest. Biases, scale"
    );
    let _ = writeln!(
        text,
        "# factors and misalignments are not seen at rest: they are those of imu.model."
    );
    let _ = writeln!(text, "schema = 1\ntitle = \"noise of {title}\"\n\n[imu]");
    let _ = writeln!(text, "rate = \"{} Hz\"", 1e9 / period_ns as f64);
    let walk =
        [triad(gyros, RandomTerm::RandomWalk), triad(accelerometers, RandomTerm::RandomWalk)];
    let _ = writeln!(
        text,
        "angle_random_walk = \"{}\"",
        quantity(UnitDimension::ANGLE_RANDOM_WALK, walk[0])
    );
    let _ = writeln!(
        text,
        "velocity_random_walk = \"{}\"",
        quantity(UnitDimension::VELOCITY_RANDOM_WALK, walk[1])
    );
    let _ = writeln!(text, "\n[imu.extensions]");
    let span_s =
        analysis.stretches.iter().copied().max().unwrap_or(0) as f64 * period_ns as f64 * 1e-9;
    extensions(&mut text, ("gyro", gyros), span_s);
    if extensions(&mut text, ("accel", accelerometers), span_s) {
        left_out.push(
            "the rate random walk of the accelerometers: the plant has one Gauss-Markov process beside it".to_owned(),
        );
    }
    let lines: usize = analysis.channels.iter().map(|channel| channel.lines.len()).sum();
    if lines > 0 {
        left_out.push(format!(
            "{}: a line of a sensor alone isn't modelled",
            octant_base::number::counted(lines as u64, "spectral line", "spectral lines")
        ));
    }
    if let Some(warmth) = warmth {
        temperature(&mut text, warmth, &mut left_out);
    }
    // A procedure, so that the file can be run as it is.
    let _ = writeln!(text, "\n[procedure.calibration]");
    InstrumentFile { text, left_out }
}

/// Writes the extensions of a triad; true where its rate random walk has no place.
fn extensions(
    text: &mut String,
    (name, channels): (&str, &[ChannelAnalysis]),
    span_s: f64,
) -> bool {
    let is_gyro = name == "gyro";
    let units = match is_gyro {
        true => [UnitDimension::SMALL_ANGLE, UnitDimension::GYRO_BIAS],
        false => [UnitDimension::VELOCITY, UnitDimension::ACCEL_BIAS],
    };
    let mut key = |key: &str, value: &str| {
        let _ = writeln!(text, "{name}_{key} = {value}");
    };
    // A count's rounding is even within half of it: Q = count / √12.
    let count = libm::sqrt(12.0) * triad(channels, RandomTerm::Quantization);
    if count > 0.0 {
        key("quantization", &format!("\"{}\"", quantity(units[0], count)));
    }
    let flicker = triad(channels, RandomTerm::BiasInstability);
    if flicker > 0.0 {
        key("bias_instability", &format!("\"{}\"", quantity(units[1], flicker)));
    }
    let wander = triad(channels, RandomTerm::RateRandomWalk);
    if is_gyro && wander > 0.0 {
        key(
            "rate_random_walk",
            &format!("\"{}\"", quantity(UnitDimension::RATE_RANDOM_WALK, wander)),
        );
    }
    // The plant has no random walk of the accelerometers' bias: it is the beginning of a slow Gauss-Markov process.
    let slow_s = 10.0 * span_s;
    let slow = (!is_gyro && wander > 0.0).then(|| (wander * libm::sqrt(slow_s / 2.0), slow_s));
    let process = correlation_time_s(channels)
        .map(|time_s| (triad(channels, RandomTerm::GaussMarkov), time_s));
    if let Some((sigma, time_s)) = process.or(slow) {
        let (sigma, time) = (quantity(units[1], sigma), octant_base::number::plain(time_s, 4));
        key("gauss_markov", &format!("{{ sigma = \"{sigma}\", correlation_time = \"{time} s\" }}"));
    }
    slow.is_some() && process.is_some()
}

/// Writes the coefficients of temperature, where there are any.
fn temperature(text: &mut String, warmth: &TemperatureDependence, left_out: &mut Vec<String>) {
    let (true, Some([change_k, time_s])) = (warmth.is_shown(), warmth.change) else { return };
    let _ = writeln!(
        text,
        "\n# Ramp and plateau are the largest change of the temperature from its first value, in the time that it took:\n\
         # the plant has no other course. Coefficients of scale factors are not seen at rest: times gravity they are in\n\
         # accel_bias. A channel that shows no coefficient has 0.\n[imu.extensions.temperature]"
    );
    let per_hour = change_k / time_s * 3600.0;
    let _ = writeln!(text, "ramp = \"{}\"", number(per_hour, "K/h"));
    let _ = writeln!(text, "plateau = \"{}\"", number(change_k, "K"));
    let triads = [
        ("gyro_bias", UnitDimension::GYRO_BIAS_PER_K),
        ("accel_bias", UnitDimension::ACCEL_BIAS_PER_K),
    ];
    for ((key, dimension), fits) in triads.into_iter().zip(warmth.channels.chunks(3)) {
        let of =
            |fit: &TemperatureFit| format!("\"{}\"", quantity(dimension, fit.per_k.unwrap_or(0.0)));
        let _ = writeln!(text, "{key} = [{}]", fits.iter().map(of).collect::<Vec<_>>().join(", "));
    }
    left_out.push(
        "the course of the temperature: the plant has a ramp that ends at a plateau".to_owned(),
    );
}

/// Writes a quantity with five digits, in the unit of its dimension.
fn quantity(dimension: UnitDimension, value: f64) -> String {
    let unit = dimension.unit;
    let size = octant_scenario::quantity_of(&format!("1 {unit}")).map_or(1.0, |one| one.si);
    number(value / size, unit)
}

/// Writes a number with five digits as a scenario reads it, which has a hyphen for minus.
fn number(value: f64, unit: &str) -> String {
    format!("{} {unit}", octant_base::number::plain(value, 5).replace('\u{2212}', "-"))
}
