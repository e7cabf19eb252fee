//! Alignment of a unit's clock by pulses at its whole seconds.

use octant_instruments::align::ClockAlignment;
use octant_instruments::pulses::{
    PULSE_OFF_NS, PULSES, PULSES_LEAST, PulseAlignment, PulseCounts, PulseMismatch, PulseUse,
};

/// A unit with a clock of its own, on a line, with pulses.
struct SimulatedUnit {
    /// Host time at the unit's stamp zero, ns.
    offset_ns: i128,
    skew: f64,
    /// Constant delay of the line.
    delay_ns: i128,
    /// Stamp of the first reading.
    first_ns: u64,
}

impl SimulatedUnit {
    fn host_ns(&self, stamp_ns: u64) -> i128 {
        let since_ns = i128::from(stamp_ns - self.first_ns);
        self.offset_ns + since_ns + (self.skew * since_ns as f64) as i128
    }

    /// Adds a second of readings at 200 Hz.
    fn reads(&self, second: u64, arrivals: &mut ClockAlignment) {
        for number in 0..200 {
            let stamp_ns = self.first_ns + second * 1_000_000_000 + number * 5_000_000;
            arrivals.add(stamp_ns, (self.host_ns(stamp_ns) + self.delay_ns) as u64);
        }
    }

    /// Whole second of the stamps that follows a second of readings.
    fn whole(&self, second: u64) -> u64 {
        (self.first_ns / 1_000_000_000 + second + 1) * 1_000_000_000
    }

    fn pulse_ns(&self, second: u64, jitter_ns: i128) -> u64 {
        (self.host_ns(self.whole(second)) + jitter_ns) as u64
    }
}

/// Stamps of GPS time in ns, and a unit that is switched on anew.
const STARTS: [u64; 2] = [1_450_000_000_123_456_789, 77_000_000];

fn unit(first_ns: u64, delay_ns: i128) -> SimulatedUnit {
    SimulatedUnit { offset_ns: 3_600_000_000_000, skew: 37e-6, delay_ns, first_ns }
}

/// Jitter between −1000 and 1000 ns, the same in each run.
fn jitter_ns(second: u64) -> i128 {
    i128::from((second * 7919 + 13) % 2001) - 1000
}

#[test]
fn arrivals_are_off_by_the_delay_and_pulses_within_their_jitter() {
    for first_ns in STARTS {
        let unit = unit(first_ns, 23_000_000);
        let (mut arrivals, mut pulses) = (ClockAlignment::new(), PulseAlignment::new());
        for second in 0..300 {
            unit.reads(second, &mut arrivals);
            let found =
                pulses.add(unit.pulse_ns(second, jitter_ns(second)), &arrivals.estimate().unwrap());
            assert_eq!(found, Ok(PulseUse::Taken));
            assert_eq!(pulses.estimate().is_some(), second + 1 >= PULSES_LEAST as u64);
        }
        let (by_arrivals, by_pulses) = (arrivals.estimate().unwrap(), pulses.estimate().unwrap());
        for stamp_ns in [unit.whole(260) + 123_456_789, unit.whole(299), unit.whole(300)] {
            let truth_ns = unit.host_ns(stamp_ns) as f64;
            let off_ns = by_arrivals.host_ns(stamp_ns) - truth_ns;
            assert!((off_ns - 23e6).abs() < 10.0, "{off_ns}");
            let off_ns = by_pulses.host_ns(stamp_ns) - truth_ns;
            assert!(off_ns.abs() < 1000.0, "{off_ns}");
            assert!(off_ns.abs() < by_pulses.within_ns(stamp_ns), "{off_ns} {by_pulses:?}");
        }
        // The error of a slope through n points a second apart: σ·sqrt(12 / n³). A uniform ±1000 ns has
        // σ = 577 ns.
        let slope_sigma = 577e-9 * (12.0 / (PULSES as f64).powi(3)).sqrt();
        assert!((by_pulses.skew - 37e-6).abs() < 4.0 * slope_sigma, "{by_pulses:?}");
        assert!((by_pulses.sigma_ns - 577.0).abs() < 150.0, "{by_pulses:?}");
        assert!(by_pulses.residual_ns < 1300.0, "{by_pulses:?}");
        assert_eq!(pulses.counts(), PulseCounts { taken: 300, off: 0, missing: 0 });
    }
}

#[test]
fn without_jitter_offset_and_rate_are_exact() {
    let unit = unit(STARTS[1], 2_000_000);
    let (mut arrivals, mut pulses) = (ClockAlignment::new(), PulseAlignment::new());
    for second in 0..10 {
        unit.reads(second, &mut arrivals);
        pulses.add(unit.pulse_ns(second, 0), &arrivals.estimate().unwrap()).unwrap();
    }
    let estimate = pulses.estimate().unwrap();
    let stamp_ns = unit.whole(9) + 500_000_000;
    assert!((estimate.host_ns(stamp_ns) - unit.host_ns(stamp_ns) as f64).abs() < 2.0);
    assert!((estimate.skew - 37e-6).abs() < 1e-9 && estimate.residual_ns < 2.0, "{estimate:?}");
}

#[test]
fn missing_and_stray_pulses_are_counted_and_left_out() {
    let unit = unit(STARTS[0], 5_000_000);
    let (mut arrivals, mut pulses) = (ClockAlignment::new(), PulseAlignment::new());
    for second in 0..40 {
        unit.reads(second, &mut arrivals);
        if (10..15).contains(&second) {
            continue;
        }
        // Less than the delay of the line, so that it doesn't contradict the arrivals.
        let stray = second == 20;
        let off_ns = if stray { -3_000_000 } else { jitter_ns(second) };
        let found = pulses.add(unit.pulse_ns(second, off_ns), &arrivals.estimate().unwrap());
        assert_eq!(found, Ok(if stray { PulseUse::Off } else { PulseUse::Taken }));
    }
    assert_eq!(pulses.counts(), PulseCounts { taken: 34, off: 1, missing: 6 });
    let stamp_ns = unit.whole(39);
    let off_ns = pulses.estimate().unwrap().host_ns(stamp_ns) - unit.host_ns(stamp_ns) as f64;
    assert!(off_ns.abs() < 1000.0, "{off_ns}");
}

#[test]
fn the_bound_grows_while_no_pulse_comes() {
    let unit = unit(STARTS[0], 5_000_000);
    let (mut arrivals, mut pulses) = (ClockAlignment::new(), PulseAlignment::new());
    for second in 0..11 {
        unit.reads(second, &mut arrivals);
        pulses
            .add(unit.pulse_ns(second, jitter_ns(second)), &arrivals.estimate().unwrap())
            .unwrap();
    }
    let estimate = pulses.estimate().unwrap();
    // A line of 11 pulses over 10 s, 20 s after its end: (1 + 4 / 9) · (1 + 2 · 20 / 10).
    let few = 1.0 + 4.0 / 9.0;
    let grown = estimate.within_ns(unit.whole(30)) / (few * estimate.residual_ns);
    assert!((grown - 5.0).abs() < 1e-9, "{grown}");
    let off_ns = estimate.host_ns(unit.whole(30)) - unit.host_ns(unit.whole(30)) as f64;
    assert!(off_ns.abs() < estimate.within_ns(unit.whole(30)), "{off_ns}");
}

/// Refusal of a unit's fourth pulse, which comes later than its second by so much.
fn refused(delay_ns: i128, late_ns: i128) -> PulseMismatch {
    let unit = unit(STARTS[0], delay_ns);
    let mut arrivals = ClockAlignment::new();
    unit.reads(0, &mut arrivals);
    let pulse_ns = unit.pulse_ns(0, late_ns);
    PulseAlignment::new().add(pulse_ns, &arrivals.estimate().unwrap()).unwrap_err()
}

#[test]
fn a_second_that_cannot_be_told_is_refused() {
    let ambiguous = refused(450_000_000, 0);
    assert!(matches!(ambiguous, PulseMismatch::Ambiguous { .. }), "{ambiguous}");
    assert!(ambiguous.to_string().contains("450 ms"), "{ambiguous}");
    // The end of a pulse of 100 ms in place of its beginning.
    let early = refused(3_000_000, 100_000_000);
    assert!(early.to_string().contains("ms before the second"), "{early}");
}

#[test]
fn a_clock_that_jumps_is_noticed() {
    let unit = unit(STARTS[1], 50_000_000);
    let (mut arrivals, mut pulses) = (ClockAlignment::new(), PulseAlignment::new());
    for second in 0..10 {
        unit.reads(second, &mut arrivals);
        pulses.add(unit.pulse_ns(second, 0), &arrivals.estimate().unwrap()).unwrap();
    }
    let mut jumped = |second: u64| {
        unit.reads(second, &mut arrivals);
        let off_ns = 2 * PULSE_OFF_NS as i128;
        pulses.add(unit.pulse_ns(second, off_ns), &arrivals.estimate().unwrap())
    };
    assert_eq!((jumped(10), jumped(11)), (Ok(PulseUse::Off), Ok(PulseUse::Off)));
    let error = jumped(12).unwrap_err();
    assert!(error.to_string().contains("the last by +1.000 ms"), "{error}");
}
