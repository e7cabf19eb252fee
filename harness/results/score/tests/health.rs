//! Reports of the core, counted.

use octant_sample::Mode;
use octant_sample::{DeviceTime, Health, Output};
use octant_score::health::{EPISODES_MAX, HealthMonitor, name};

fn output(second: u64, health: Health, nis: f64) -> Output {
    Output {
        device_time: DeviceTime::from_ns(second * 1_000_000_000),
        mode: Mode::Calibrating,
        health,
        nis,
        ..Output::default()
    }
}

#[test]
fn flags_close_together_are_one_episode_and_one_recovery() {
    let mut monitor = HealthMonitor::new();
    let rejected = Health::INNOVATION_REJECTED;
    for (second, health, nis) in [
        (1, Health::empty(), 2.0),
        (2, rejected, f64::NAN),
        (3, rejected, 40.0),
        (4, Health::RECOVERING, 4.0),
        (5, Health::RECOVERING, f64::NAN),
        (60, Health::RECOVERING | Health::GAP, f64::NAN),
    ] {
        monitor.push(&output(second, health, nis));
    }
    let counts = monitor.counts();
    assert_eq!((counts.measurements, counts.rejected), (4, 2));
    assert_eq!((counts.recoveries, counts.gaps), (2, 1));
    assert_eq!(monitor.nis_mean(), Some(3.0), "a rejected measurement is no innovation used");
    let names: Vec<_> = monitor.episodes().iter().map(|e| (e.name(), e.epochs)).collect();
    assert_eq!(
        names,
        [
            ("measurement rejected", 2),
            ("filter recovering", 2),
            ("filter recovering", 1),
            ("samples missing", 1),
        ]
    );
}

#[test]
fn episodes_are_bounded() {
    let mut monitor = HealthMonitor::new();
    for k in 0..2000 {
        monitor.push(&output(10 * k, Health::GAP, f64::NAN));
    }
    assert_eq!(monitor.episodes().len(), EPISODES_MAX);
    assert_eq!(monitor.unlisted(), 1000);
    assert_eq!(monitor.counts().gaps, 2000);
    for second in 50_000..50_010 {
        monitor.push(&output(second, Health::RECOVERING, f64::NAN));
    }
    assert_eq!(monitor.counts().recoveries, 1, "one recovery of ten seconds, listed or not");
}

#[test]
fn every_flag_has_words() {
    for cause in Health::all().iter() {
        assert_ne!(name(cause), "several causes", "{cause:?}");
    }
}
