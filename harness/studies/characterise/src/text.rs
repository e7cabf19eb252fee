//! The summary on the terminal.

use super::analysis::ChannelAnalysis;
use super::kernel::RandomTerm;
use super::result::Characterisation;
use super::temperature::{STEADY, TemperatureDependence, TemperatureFit};
use octant_base::number::{counted, plain, significant};
use octant_scenario::UnitDimension;
use std::fmt::Write as _;

/// Unit in which a term of a triad is shown, and its size in SI units.
#[must_use]
pub fn unit(term: Option<RandomTerm>, is_gyro: bool) -> (&'static str, f64) {
    let dimension = match (term, is_gyro) {
        (Some(RandomTerm::Quantization), true) => UnitDimension::SMALL_ANGLE,
        (Some(RandomTerm::Quantization), false) => UnitDimension::VELOCITY,
        (Some(RandomTerm::RandomWalk), true) => UnitDimension::ANGLE_RANDOM_WALK,
        (Some(RandomTerm::RandomWalk), false) => UnitDimension::VELOCITY_RANDOM_WALK,
        (Some(RandomTerm::RateRandomWalk), true) => UnitDimension::RATE_RANDOM_WALK,
        (Some(RandomTerm::RateRandomWalk), false) => UnitDimension::ACCEL_RANDOM_WALK,
        (Some(RandomTerm::BiasInstability | RandomTerm::GaussMarkov), true) => {
            UnitDimension::GYRO_BIAS
        }
        (Some(RandomTerm::BiasInstability | RandomTerm::GaussMarkov), false) => {
            UnitDimension::ACCEL_BIAS
        }
        (None, true) => return ("deg/h/h", octant_earth::units::DEG_PER_HOUR / 3600.0),
        (None, false) => return ("ug/h", octant_earth::units::MICRO_G / 3600.0),
    };
    let one = octant_scenario::quantity_of(&format!("1 {}", dimension.unit));
    (dimension.unit, one.map_or(1.0, |quantity| quantity.si))
}

/// Unit in which the rates of a channel are shown, that of its bias, and its size in SI units.
#[must_use]
pub fn rate_unit(channel: &ChannelAnalysis) -> (&'static str, f64) {
    unit(Some(RandomTerm::BiasInstability), channel.name.starts_with("gyro"))
}

/// Title of a term.
#[must_use]
pub const fn title(term: RandomTerm) -> &'static str {
    match term {
        RandomTerm::Quantization => "quantization Q",
        RandomTerm::RandomWalk => "random walk N",
        RandomTerm::BiasInstability => "bias instability B",
        RandomTerm::RateRandomWalk => "rate random walk K",
        RandomTerm::GaussMarkov => "Gauss-Markov σ",
    }
}

/// A value with its interval, or a limit.
#[must_use]
pub fn estimate(value: Option<f64>, interval: [f64; 2], size: f64) -> String {
    let digits = |value: f64| significant(value / size, 3);
    match value {
        Some(value) => {
            format!("{} [{}, {}]", digits(value), digits(interval[0]), digits(interval[1]))
        }
        None => format!("below {}", digits(interval[1])),
    }
}

/// Formats the result as text.
#[must_use]
pub fn of(result: &Characterisation) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{}: {} s at {} Hz, {} s at rest in {}",
        result.recording,
        plain(result.duration_s, 6),
        plain(result.rate_hz, 6),
        plain(result.rest_s, 6),
        counted(result.analysis.stretches.len() as u64, "stretch", "stretches")
    );
    if result.gaps > 0 || result.invalid > 0 {
        let _ = writeln!(
            out,
            "  left out: {}, {}",
            counted(result.gaps, "gap", "gaps"),
            counted(result.invalid, "invalid or saturated sample", "invalid or saturated samples")
        );
    }
    if let Some(cut) = &result.cut_short {
        let _ = writeln!(out, "  cut short: {cut}");
    }
    if let Some(time) = &result.assumed_time {
        let _ = writeln!(out, "  {time}");
    }
    let _ = writeln!(out, "noise terms, [interval of 95 %]");
    for (number, (triad, channels)) in
        ["gyro", "accelerometer"].iter().zip(result.analysis.channels.chunks(3)).enumerate()
    {
        columns(&mut out, result, number, triad);
        for term in RandomTerm::ALL {
            let (name, size) = unit(Some(term), *triad == "gyro");
            let cell = |channel: &ChannelAnalysis| match &channel.noise {
                None => "not told".to_owned(),
                Some(noise) => noise
                    .term(term)
                    .map_or_else(|| "not seen".to_owned(), |t| estimate(t.value, t.interval, size)),
            };
            row(&mut out, &format!("{triad} {}, {name}", title(term)), channels.iter().map(cell));
        }
        let time = |channel: &ChannelAnalysis| {
            let time = channel.noise.as_ref().and_then(|noise| noise.correlation_time);
            time.map_or_else(|| "–".to_owned(), |t| estimate(Some(t.value_s), t.interval_s, 1.0))
        };
        if channels.iter().any(|c| c.noise.as_ref().is_some_and(|n| n.correlation_time.is_some())) {
            row(&mut out, &format!("{triad} correlation time, s"), channels.iter().map(time));
        }
        let (name, size) = unit(None, *triad == "gyro");
        let ramp = |channel: &ChannelAnalysis| {
            channel
                .ramp
                .map_or_else(|| "not told".to_owned(), |r| estimate(r.value, r.interval, size))
        };
        row(&mut out, &format!("{triad} rate ramp R, {name}"), channels.iter().map(ramp));
    }
    for channel in &result.analysis.channels {
        if let Some(noise) = channel.noise.as_ref().filter(|noise| noise.probability < 0.01) {
            let _ = writeln!(
                out,
                "  {}: the terms don't describe it (probability {})",
                result.names_in_file.channel(channel.name),
                significant(noise.probability.max(1e-12), 2)
            );
        }
    }
    lines(&mut out, result);
    earth(&mut out, result);
    temperature(&mut out, result);
    twin(&mut out, result);
    out
}

/// Row with the file's names of a triad's axes, where it has any.
fn columns(out: &mut String, result: &Characterisation, number: usize, triad: &str) {
    let names = (0..3).map(|axis| result.names_in_file.column(number, axis));
    if let Some(names) = names.collect::<Option<Vec<&str>>>() {
        let cells = ["x", "y", "z"].iter().zip(names).map(|(axis, name)| format!("{axis}: {name}"));
        row(out, &format!("{triad} x, y, z: columns of the file"), cells);
    }
}

fn row(out: &mut String, name: &str, cells: impl Iterator<Item = String>) {
    let cells: Vec<String> = cells.map(|cell| format!("{cell:<28}")).collect();
    let _ = writeln!(out, "  {name:44} {}", cells.join(" ").trim_end());
}

fn lines(out: &mut String, result: &Characterisation) {
    let _ = writeln!(
        out,
        "spectral lines, false alarms below {} % a channel",
        plain(100.0 * super::spectrum::FALSE_ALARM, 2)
    );
    if result.analysis.segments == 0 {
        let _ = writeln!(out, "  not told: no stretch has a whole segment");
        return;
    }
    let mut none = true;
    for channel in &result.analysis.channels {
        for line in &channel.lines {
            none = false;
            let (unit, size) = rate_unit(channel);
            let mains =
                line.mains.as_ref().map_or_else(String::new, |name| format!(", mains {name}"));
            let _ = writeln!(
                out,
                "  {} {} ± {} Hz, amplitude {} {}{mains}",
                result.names_in_file.channel(channel.name),
                plain(line.frequency_hz, 6),
                significant(line.resolution_hz, 2),
                significant(line.amplitude / size, 3),
                unit
            );
        }
    }
    if none {
        let _ = writeln!(out, "  none");
    }
}

fn earth(out: &mut String, result: &Characterisation) {
    let check = &result.earth_rate;
    match (check.latitude_rad, check.latitude_interval_rad, &check.reason) {
        (Some(latitude), Some([low, high]), _) => {
            let deg = |rad: f64| format!("{:.3}", rad.to_degrees());
            let _ = writeln!(
                out,
                "latitude from {} attitudes: {} [{}, {}] deg",
                check.attitudes,
                deg(latitude),
                deg(low),
                deg(high)
            );
            if let Some([cosine, sigma]) = check.cosine {
                let _ = writeln!(
                    out,
                    "  rate across the vertical {} ± {} of Earth's, expected {}",
                    significant(cosine, 4),
                    significant(1.96 * sigma, 2),
                    significant(libm::cos(latitude), 4)
                );
            }
            let headings: Vec<String> = check
                .headings_rad
                .iter()
                .take(8)
                .map(|heading| {
                    heading.map_or_else(
                        || "–".to_owned(),
                        |[heading, sigma]| {
                            format!(
                                "{:.2} ± {:.2}",
                                heading.to_degrees(),
                                1.96 * sigma.to_degrees()
                            )
                        },
                    )
                })
                .collect();
            if !headings.is_empty() {
                let _ = writeln!(out, "  headings of body x, deg: {}", headings.join(", "));
            }
        }
        (_, _, Some(reason)) => {
            let _ = writeln!(out, "latitude: not told, {reason}");
        }
        _ => {}
    }
}

/// Unit in which a coefficient of temperature is shown, and its size in SI units.
#[must_use]
pub fn unit_per_k(is_gyro: bool) -> (&'static str, f64) {
    let dimension = match is_gyro {
        true => UnitDimension::GYRO_BIAS_PER_K,
        false => UnitDimension::ACCEL_BIAS_PER_K,
    };
    let one = octant_scenario::quantity_of(&format!("1 {}", dimension.unit));
    (dimension.unit, one.map_or(1.0, |quantity| quantity.si))
}

/// A coefficient of temperature with its interval, or the interval alone where it has zero; "not told" without one.
#[must_use]
pub fn per_k(fit: &TemperatureFit, size: f64) -> String {
    let digits = |value: f64| significant(value / size, 3);
    let Some([low, high]) = fit.interval else { return "not told".to_owned() };
    let interval = format!("[{}, {}]", digits(low), digits(high));
    fit.per_k.map_or_else(|| interval.clone(), |value| format!("{} {interval}", digits(value)))
}

/// What a steady change of the temperature can't tell.
#[must_use]
pub fn steadiness(found: &TemperatureDependence) -> Option<String> {
    let steady = found.steady.filter(|steady| *steady > STEADY)?;
    Some(format!(
        "{} % of the temperature's change are steady in time: a drift with time would look the same",
        plain((100.0 * steady).floor(), 3)
    ))
}

fn temperature(out: &mut String, result: &Characterisation) {
    let found = &result.temperature;
    if let Some(reason) = &found.reason {
        let _ = writeln!(out, "temperature: not told, {reason}");
        return;
    }
    let [low, high] = found.range_c.unwrap_or_default().map(|t| plain(t, 4));
    let _ =
        writeln!(out, "temperature from {low} to {high} degC, bias per kelvin, [interval of 95 %]");
    for (number, (triad, fits)) in
        ["gyro", "accelerometer"].iter().zip(found.channels.chunks(3)).enumerate()
    {
        columns(out, result, number, triad);
        let (name, size) = unit_per_k(*triad == "gyro");
        row(out, &format!("{triad} bias, {name}"), fits.iter().map(|fit| per_k(fit, size)));
    }
    if let Some(words) = steadiness(found) {
        let _ = writeln!(out, "  {words}");
    }
}

fn twin(out: &mut String, result: &Characterisation) {
    for words in &result.left_out {
        let _ = writeln!(out, "not in the scenario: {words}");
    }
    let Some(twin) = &result.twin else { return };
    let _ = writeln!(
        out,
        "simulated twin, seed {}: each comparison at a level of {} %",
        twin.seed,
        plain(100.0 * twin.level, 2)
    );
    let named = |name: &str| result.names_in_file.channel(name);
    let width =
        twin.channels.iter().map(|c| named(c.name).chars().count()).max().unwrap_or(0).max(16);
    for channel in &twin.channels {
        let said = |probability: f64| if probability >= twin.level { "agrees" } else { "differs" };
        let _ = writeln!(
            out,
            "  {:width$} Allan deviations {} ({} of {} within), spectrum {}, increments {}",
            named(channel.name),
            said(channel.allan_probability),
            channel.allan_within,
            channel.allan_points,
            said(channel.spectrum_probability),
            said(channel.increments_probability)
        );
    }
}
