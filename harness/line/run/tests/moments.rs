//! Solutions at the ends of alignment and calibration are those of their moments.

use octant_plant::Truth;
use octant_run::Observers;
use octant_run::observers::done::PlannedWork;
use octant_sample::{DeviceTime, Epoch, Mode, Navigation, Output, Sample};
use octant_score::alignment::SolutionPoint;

/// Modes of a run of 40 s at 10 Hz, by sample number from 1.
fn mode(number: u64) -> Mode {
    match number {
        ..=100 => Mode::Aligning,
        101..=200 => Mode::Calibrating,
        _ => Mode::Navigating,
    }
}

/// Watches a unit whose heading is its sample number, degrees; the truth, where there is one, has a heading of zero.
fn watched(truth: Option<Truth>) -> Observers {
    let mut observers = Observers::new(PlannedWork::default());
    for number in 1..=300_u64 {
        let half_rad = (number as f64).to_radians() / 2.0;
        let device_time = DeviceTime::from_ns(number * 100_000_000);
        let sent = Epoch {
            sample: Sample { sequence: number, device_time, ..Sample::default() },
            ..Epoch::default()
        };
        let output = Output {
            sequence: number,
            device_time,
            mode: mode(number),
            navigation: Navigation {
                q_nb: [half_rad.cos(), 0.0, 0.0, half_rad.sin()],
                ..Navigation::default()
            },
            nis: f64::NAN,
            ..Output::default()
        };
        observers.source(&sent);
        if observers.answer(&sent, false, &output)
            && let Some(truth) = &truth
        {
            observers.truth(&output, truth);
        }
    }
    assert_eq!(observers.answers.misbehaved, None);
    observers
}

fn heading_deg(point: &Option<SolutionPoint>) -> f64 {
    point.as_ref().unwrap().attitude.unwrap().heading_rad.to_degrees().rem_euclid(360.0)
}

#[test]
fn a_moment_is_noted_once_with_and_without_truth() {
    for truth in [None, Some(Truth { q_nb: [1.0, 0.0, 0.0, 0.0], ..Truth::default() })] {
        let observers = watched(truth);
        assert!(
            (heading_deg(&observers.moments.aligned) - 101.0).abs() < 1e-9,
            "{:?}",
            observers.moments.aligned
        );
        assert!(
            (heading_deg(&observers.moments.calibrated) - 201.0).abs() < 1e-9,
            "{:?}",
            observers.moments.calibrated
        );
        let errors = [&observers.moments.aligned, &observers.moments.calibrated]
            .map(|point| point.as_ref().unwrap().attitude_error.is_some());
        assert_eq!(errors, [truth.is_some(); 2], "errors are those of the moment or none");
    }
}
