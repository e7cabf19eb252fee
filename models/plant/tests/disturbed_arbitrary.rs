//! Any disturbances in any order: no panic, bounded work, and a clone, or a plant that was saved
//! and loaded, continues as the original.

use super::common::*;
use octant_plant::config::Motion;
use octant_plant::{Plant, motion};
use octant_sample::disturbance::*;
use proptest::prelude::*;

/// Usual sizes, and values that every kind would refuse.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-4.0..1.0f64, any::<bool>())
            .prop_map(|(p, minus)| 10f64.powf(p) * if minus { -1.0 } else { 1.0 }),
        1 => prop::sample::select(vec![
            0.0, -0.0, 1e-300, 1e300, -1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY,
        ]),
    ]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn line() -> impl Strategy<Value = SpectralLine> {
    (number(), vector(), vector(), number(), number()).prop_map(
        |(frequency_hz, displacement_m, angle_rad, phase_rad, angle_phase_rad)| SpectralLine {
            frequency_hz,
            displacement_m,
            angle_rad,
            phase_rad,
            angle_phase_rad,
        },
    )
}

fn action() -> impl Strategy<Value = GimbalAction> {
    prop_oneof![
        (number(), number(), any::<bool>()).prop_map(|(angle_rad, within_s, seen)| {
            GimbalAction::Slip { angle_rad, within_s, seen }
        }),
        (number(), any::<bool>())
            .prop_map(|(angle_rad, flagged)| GimbalAction::EncoderSlip { angle_rad, flagged }),
        Just(GimbalAction::Stall),
        number().prop_map(|rate_radps| GimbalAction::Runaway { rate_radps }),
        number().prop_map(|angle_rad| GimbalAction::Overshoot { angle_rad }),
        (number(), number(), number()).prop_map(|(amplitude_rad, frequency_hz, decay_s)| {
            GimbalAction::Ringing { amplitude_rad, frequency_hz, decay_s }
        }),
        number().prop_map(|play_rad| GimbalAction::Backlash { play_rad }),
    ]
}

fn disturbance() -> impl Strategy<Value = Disturbance> {
    let lines = || prop::collection::vec(line(), 0..3);
    prop_oneof![
        1 => (lines(), number())
            .prop_map(|(lines, edge_s)| Disturbance::Vibration { lines, edge_s }),
        1 => (lines(), number()).prop_map(|(lines, edge_s)| Disturbance::Case { lines, edge_s }),
        1 => (vector(), number(), number()).prop_map(|(peak_mps2, width_s, recoil_s)| {
            Disturbance::Shock { peak_mps2, width_s, recoil_s }
        }),
        1 => [vector(), vector(), vector()].prop_map(Disturbance::LeverArm),
        1 => (number(), number(), vector(), vector(), vector(), vector()).prop_map(
            |(ramp_kps, plateau_k, a, b, c, d)| Disturbance::Temperature {
                ramp_kps,
                plateau_k,
                gyro_bias_per_k: a,
                accel_bias_per_k: b,
                gyro_scale_per_k: c,
                accel_scale_per_k: d,
            }
        ),
        1 => (vector(), vector(), number()).prop_map(|(displacement_m, angle_rad, length_s)| {
            Disturbance::Excursion { displacement_m, angle_rad, length_s }
        }),
        4 => (any::<bool>(), action()).prop_map(|(inner, action)| Disturbance::Gimbal {
            gimbal: if inner { Gimbal::Azimuth } else { Gimbal::Roll },
            action,
        }),
    ]
}

/// One event: a disturbance begins or ends, or the turntable gets a set point.
#[derive(Clone, Debug)]
pub(super) enum Event {
    Begin(u32, Disturbance),
    End(u32),
    Command(f64, f64),
}

pub(super) fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => (0..4u32, disturbance()).prop_map(|(handle, it)| Event::Begin(handle, it)),
        2 => (0..5u32).prop_map(Event::End),
        2 => (-200.0..200.0f64, -200.0..200.0f64).prop_map(|(a, r)| Event::Command(a, r)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn nothing_panics(
        events in prop::collection::vec((event(), 1..25u64), 1..12),
        ship in any::<bool>(),
        skew in any::<bool>(),
        play in any::<bool>(),
    ) {
        let mut config = noisy();
        if ship {
            config.motion = Motion::Dockside(motion::dockside_default(2));
        }
        config.imu.extensions.time_skew_s = if skew { 0.0123 } else { 0.0 };
        config.turntable.backlash_rad = if play { 1e-3 } else { 0.0 };
        let mut plant = Plant::new(&config).unwrap();
        let mut target = command(0.0, 0.0);
        for (event, samples) in &events {
            match event {
                Event::Begin(handle, disturbance) => plant.begin(*handle, disturbance),
                Event::End(handle) => plant.end(*handle),
                Event::Command(azimuth, roll) => target = command(*azimuth, *roll),
            }
            let _ = plant.motor();
            let mut clone = plant.clone();
            let mut bytes = Vec::new();
            plant.save(&mut bytes);
            let mut loaded = Plant::load(&bytes).unwrap();
            for _ in 0..*samples {
                let step = plant.step(&target);
                prop_assert_eq!(step, clone.step(&target));
                prop_assert_eq!(step, loaded.step(&target));
            }
            let bits = |plant: &Plant| plant.truth().q_nb.map(f64::to_bits);
            prop_assert_eq!(bits(&plant), bits(&clone));
            prop_assert_eq!(bits(&plant), bits(&loaded));
            let saved = |plant: &Plant| {
                let mut bytes = Vec::new();
                plant.save(&mut bytes);
                bytes
            };
            prop_assert_eq!(saved(&plant), saved(&loaded));
        }
    }

    /// Disturbances that come and go leave the drive free: it arrives, and once it is at rest the
    /// samples of a static base without noise are those of one that was never disturbed.
    #[test]
    fn what_ends_leaves_the_table_as_it_was(
        actions in prop::collection::vec((any::<bool>(), action(), 1..300u64), 1..5),
    ) {
        let keeps = |action: &GimbalAction| match action {
            GimbalAction::Slip { .. } => false,
            GimbalAction::Runaway { rate_radps } => rate_radps.abs() < 1.0,
            GimbalAction::Overshoot { angle_rad } => angle_rad.abs() < 1.0,
            GimbalAction::Backlash { play_rad } => play_rad.abs() < 1.0,
            GimbalAction::Ringing { amplitude_rad, frequency_hz, decay_s } => {
                amplitude_rad.abs() < 0.1 && frequency_hz.abs() < 50.0 && *decay_s < 0.5
            }
            _ => true,
        };
        let (mut plant, mut twin) =
            (Plant::new(&perfect()).unwrap(), Plant::new(&perfect()).unwrap());
        let go = command(20.0, -30.0);
        for (handle, (inner, action, samples)) in (0..).zip(&actions) {
            if !keeps(action) {
                continue;
            }
            let gimbal = if *inner { Gimbal::Azimuth } else { Gimbal::Roll };
            plant.begin(handle, &Disturbance::Gimbal { gimbal, action: *action });
            run(&mut plant, &go, *samples);
            run(&mut twin, &go, *samples);
        }
        for handle in 0..actions.len() as u32 {
            plant.end(handle);
        }
        // Runaways below 1 rad/s for 1200 samples, 6 rad, and 2.9 rad to brake: back within 52 s.
        for _ in 0..20_000 {
            plant.step(&go);
            twin.step(&go);
        }
        let (a, b) = (plant.truth(), twin.truth());
        for axis in 0..2 {
            prop_assert!((a.gimbal_rad[axis] - b.gimbal_rad[axis]).abs() < 1e-14);
        }
        let mut sums = [0i64; 6];
        for _ in 0..1000 {
            let (a, b) = (plant.step(&go).sample, twin.step(&go).sample);
            prop_assert_eq!((a.gimbal, a.status), (b.gimbal, b.status));
            for axis in 0..3 {
                sums[axis] += i64::from(a.delta_theta[axis] - b.delta_theta[axis]);
                sums[3 + axis] += i64::from(a.delta_velocity[axis] - b.delta_velocity[axis]);
            }
            prop_assert!(sums.iter().all(|sum| sum.abs() <= 1), "{:?}", sums);
        }
    }
}
