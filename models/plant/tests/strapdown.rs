//! A perfect strapdown integrates the plant's counts and must arrive at the plant's truth:
//! increments, Coriolis, transport rate, curvature and gravity are then consistent with the motion.

use super::common::strapdown::Strapdown;
use super::common::*;
use octant_plant::config::*;
use octant_plant::{Plant, motion};

/// Runs through the commands, each for its seconds; returns the largest errors at whole seconds.
fn worst(config: &PlantConfig, commands: &[(f64, f64, u64)], hold_height: bool) -> (f64, f64, f64) {
    let mut plant = Plant::new(config).unwrap();
    let mut strapdown = Strapdown::start(&plant.truth(), hold_height, DT);
    let mut worst = (0.0f64, 0.0f64, 0.0f64);
    for (azimuth, roll, seconds) in commands {
        let target = command(*azimuth, *roll);
        for _ in 0..seconds * 200 {
            let step = plant.step(&target);
            assert_eq!(step.sample.status.bits(), 0);
            strapdown.step(&step.sample, step.sample.sequence == 1);
            if step.sample.sequence.is_multiple_of(200) {
                let error = strapdown.error(&plant.truth());
                worst = (worst.0.max(error.0), worst.1.max(error.1), worst.2.max(error.2));
            }
        }
    }
    worst
}

#[test]
fn dockside_for_ten_minutes() {
    let mut config = perfect();
    let mut ship = motion::dockside_default(7);
    ship.mean = CaseAttitude { heading_rad: 0.7, pitch_rad: 0.02, roll_rad: -0.01 };
    ship.mooring_offset_m = [120.0, -80.0, 1.5];
    config.motion = Motion::Dockside(ship);
    let (position, velocity, attitude) = worst(&config, &[(0.0, 0.0, 600)], false);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 1e-5 && attitude < 1e-8);
}

#[test]
fn dockside_with_moves() {
    let mut config = perfect();
    config.motion = Motion::Dockside(motion::dockside_iso_8728(3));
    config.turntable.non_orthogonality_rad = 1e-3;
    config.turntable.errors.mounting_rad = [3e-3, -2e-3, 1e-3];
    config.turntable.backlash_rad = 2e-4;
    let moves = [(0.0, 90.0, 60), (90.0, 90.0, 60), (90.0, -45.0, 60), (180.0, 0.0, 120)];
    let (position, velocity, attitude) = worst(&config, &moves, false);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 2e-5 && attitude < 1e-8);
}

#[test]
fn static_with_moves_for_an_hour() {
    let mut config = perfect();
    config.turntable.non_orthogonality_rad = -2e-3;
    config.turntable.errors.mounting_rad = [3e-3, -2e-3, 1e-3];
    config.motion =
        Motion::Static(CaseAttitude { heading_rad: 1.1, pitch_rad: 0.03, roll_rad: -0.02 });
    let moves: Vec<(f64, f64, u64)> = (0..24)
        .map(|i| (f64::from((i + 1) / 2 % 4) * 90.0, f64::from(i / 2 % 3) * 135.0 - 90.0, 150))
        .collect();
    let (position, velocity, attitude) = worst(&config, &moves, true);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 1e-6 && attitude < 1e-8);
}
