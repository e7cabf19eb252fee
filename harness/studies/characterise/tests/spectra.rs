//! Spectral densities, lines and their false alarms.

use crate::synthetic::{Coefficients, stream};
use octant_characterise::spectrum::{FALSE_ALARM, WelchSpectrum};
use std::f64::consts::TAU;

const DT: f64 = 0.005;

fn white() -> Coefficients {
    Coefficients { random_walk: 1e-4, ..Coefficients::default() }
}

#[test]
fn white_noise_has_its_density() {
    let mut spectrum = WelchSpectrum::new(DT, 1 << 17);
    stream(3, &white(), DT, 1 << 17, |rate| spectrum.push(rate));
    assert_eq!(spectrum.segments(), 8);
    for channel in 0..6 {
        let density = spectrum.density(channel);
        let mean = density[2..density.len() - 1].iter().sum::<f64>() / (density.len() - 3) as f64;
        // One-sided: 2 N². Of 8000 bins by 8 segments.
        assert!((mean / 2e-8 - 1.0).abs() < 0.02, "{mean}");
    }
}

#[test]
fn lines_have_their_frequency_and_amplitude() {
    let mut spectrum = WelchSpectrum::new(DT, 1 << 15);
    let mut sample = 0.0;
    let lines = [(50.0, 4e-4), (13.37, 6e-4), (80.0, 3e-4)];
    stream(4, &white(), DT, 1 << 15, |rate| {
        let mut rate = *rate;
        for (frequency, amplitude) in lines {
            rate[0] += amplitude * (TAU * frequency * sample * DT).sin();
        }
        sample += 1.0;
        spectrum.push(&rate);
    });
    let mut found = spectrum.lines(0);
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    assert_eq!(found.len(), 3, "{found:?}");
    for (line, (frequency, amplitude)) in found.iter().zip([lines[1], lines[0], lines[2]]) {
        assert!((line.frequency_hz - frequency).abs() < line.resolution_hz, "{line:?}");
        assert!((line.amplitude / amplitude - 1.0).abs() < 0.1, "{line:?}");
    }
    assert_eq!(found[1].mains.as_deref(), Some("50 Hz"));
    assert_eq!(found[0].mains, None);
    // At 200 samples a second 120 Hz is seen at 80 Hz.
    assert_eq!(found[2].mains.as_deref(), Some("2 × 60 Hz, folded"));
    assert!(spectrum.lines(1).is_empty());
}

/// Counts the channels with a line that isn't there.
fn alarms(of: &Coefficients, seeds: std::ops::Range<u64>) -> (usize, usize) {
    let (mut alarms, mut channels) = (0, 0);
    for seed in seeds {
        let mut spectrum = WelchSpectrum::new(DT, 1 << 13);
        stream(100 + seed, of, DT, 1 << 13, |rate| spectrum.push(rate));
        for channel in 0..6 {
            alarms += usize::from(!spectrum.lines(channel).is_empty());
            channels += 1;
        }
    }
    (alarms, channels)
}

/// Noises of every slope, alone and together.
fn noises() -> [(&'static str, Coefficients); 6] {
    let none = Coefficients::default();
    let flicker = Coefficients { bias_instability: 1e-4, ..none };
    let walk = Coefficients { rate_random_walk: 1e-4, ..none };
    let quantization = Coefficients { quantization: 1e-6, ..none };
    [
        ("white", white()),
        ("flicker", flicker),
        ("rate random walk", walk),
        ("quantization", quantization),
        ("white and flicker", Coefficients { bias_instability: 1e-4, ..white() }),
        (
            "all",
            Coefficients {
                bias_instability: 1e-4,
                rate_random_walk: 1e-4,
                quantization: 1e-6,
                ..white()
            },
        ),
    ]
}

#[allow(clippy::print_stdout, reason = "figures of the page")]
fn hold(of: &str, (alarms, channels): (usize, usize)) {
    println!("{of}: {alarms} of {channels} channels have a line");
    let expected = FALSE_ALARM * channels as f64;
    // Above it by chance once in a thousand.
    assert!(
        alarms as f64 <= expected + 3.1 * expected.sqrt(),
        "{of}: {alarms} of {channels} channels, expected {FALSE_ALARM} of them at most"
    );
}

#[test]
fn false_alarms_hold_on_white_noise() {
    hold("white", alarms(&white(), 0..200));
}

#[test]
fn false_alarms_hold_on_noise_of_any_slope() {
    for (name, of) in &noises()[1..] {
        hold(name, alarms(of, 0..30));
    }
}

/// A thousand streams of each noise: the figures of docs/characterise.md.
#[test]
#[ignore = "minutes: run by hand"]
fn a_thousand_streams_of_each_noise() {
    for (name, of) in &noises() {
        hold(name, alarms(of, 0..1000));
    }
}

#[test]
fn a_line_on_a_slope_is_found() {
    for (name, of) in &noises() {
        let mut spectrum = WelchSpectrum::new(DT, 1 << 13);
        let mut clean = WelchSpectrum::new(DT, 1 << 13);
        stream(7, of, DT, 1 << 13, |rate| clean.push(rate));
        let density = clean.density(0);
        let bin = 40;
        let frequency_hz = bin as f64 * clean.bin_hz();
        // Power of fifteen bins of the noise there.
        let amplitude = (2.0 * 15.0 * density[bin - 4..bin + 5].iter().sum::<f64>() / 9.0
            * clean.bin_hz())
        .sqrt();
        let mut sample = 0.0;
        stream(7, of, DT, 1 << 13, |rate| {
            let mut rate = *rate;
            rate[0] += amplitude * (TAU * frequency_hz * sample * DT).sin();
            sample += 1.0;
            spectrum.push(&rate);
        });
        let found = spectrum.lines(0);
        assert!(
            found.iter().any(|line| (line.frequency_hz - frequency_hz).abs() < line.resolution_hz),
            "{name}: {found:?}"
        );
    }
}

#[test]
fn a_line_beside_a_folded_harmonic_has_no_name() {
    // At 200 Hz, 3 × 60 Hz is seen at 20 Hz.
    for (frequency_hz, mains) in
        [(20.0, Some("3 × 60 Hz, folded")), (20.3, None), (49.96, Some("50 Hz")), (50.5, None)]
    {
        let mut spectrum = WelchSpectrum::new(DT, 1 << 15);
        let mut sample = 0.0;
        stream(9, &white(), DT, 1 << 15, |rate| {
            let mut rate = *rate;
            rate[0] += 1e-3 * (TAU * frequency_hz * sample * DT).sin();
            sample += 1.0;
            spectrum.push(&rate);
        });
        let found = spectrum.lines(0);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].mains.as_deref(), mains, "{found:?}");
    }
}
