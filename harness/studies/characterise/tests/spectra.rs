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

#[test]
fn false_alarms_hold_on_white_noise() {
    let (mut alarms, mut channels) = (0, 0);
    for seed in 0..200 {
        let mut spectrum = WelchSpectrum::new(DT, 1 << 13);
        stream(100 + seed, &white(), DT, 1 << 13, |rate| spectrum.push(rate));
        for channel in 0..6 {
            alarms += usize::from(!spectrum.lines(channel).is_empty());
            channels += 1;
        }
    }
    // 1200 channels at 1 %: 12 expected, above 23 by chance in one of a thousand.
    assert!(
        alarms <= 23,
        "{alarms} of {channels} channels, expected {FALSE_ALARM} of them at most"
    );
}
