//! Plants without disturbances beside a disturbed one: each is the plant that never had them, bit for bit, and a
//! disturbance goes on as long as something that it has set in motion.

use super::common::*;
use super::disturbed_arbitrary::{Event, event};
use super::state::{disturbances, everything, ground, target};
use octant_earth::units::DEG;
use octant_plant::config::{Motion, PlantConfig};
use octant_plant::{COMPARED_STATE_FORMAT, ComparedPlant, Plant, motion};
use octant_sample::Epoch;
use octant_sample::disturbance::*;
use octant_state::{Writer, assert_layout};
use proptest::prelude::*;

/// Handles of the events.
const HANDLES: u32 = 5;

fn saved(plant: &ComparedPlant) -> Vec<u8> {
    let mut bytes = Vec::new();
    plant.save(&mut bytes);
    bytes
}

/// The epoch without a handle and larger ones, as far as there is another one.
fn without(plant: &ComparedPlant, handle: u32, epoch: &Epoch) -> Epoch {
    *(handle..HANDLES).find_map(|handle| plant.without(handle)).unwrap_or(epoch)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn each_copy_is_the_plant_without_the_disturbances(
        events in prop::collection::vec((event(), 1..25u64), 1..12),
        ship in any::<bool>(),
        skew in any::<bool>(),
    ) {
        let mut config = noisy();
        if ship {
            config.motion = Motion::Dockside(motion::dockside_default(2));
        }
        config.imu.extensions.time_skew_s = if skew { 0.0123 } else { 0.0 };
        let mut plant = ComparedPlant::new(&config).unwrap();
        // The plants with the disturbances of smaller handles alone.
        let mut alone: Vec<Plant> = (0..=HANDLES).map(|_| Plant::new(&config).unwrap()).collect();
        let mut to = command(0.0, 0.0);
        for (event, samples) in &events {
            match event {
                Event::Begin(handle, disturbance) => {
                    plant.begin(*handle, disturbance);
                    alone[*handle as usize + 1..].iter_mut().for_each(|it| it.begin(*handle, disturbance));
                }
                Event::End(handle) => {
                    plant.end(*handle);
                    alone[*handle as usize + 1..].iter_mut().for_each(|it| it.end(*handle));
                }
                Event::Command(azimuth, roll) => to = command(*azimuth, *roll),
            }
            let (mut clone, mut loaded) = (plant.clone(), ComparedPlant::load(&saved(&plant)).unwrap());
            for _ in 0..*samples {
                let step = plant.step(&to);
                prop_assert_eq!(step, clone.step(&to));
                prop_assert_eq!(step, loaded.step(&to));
                let epoch = Epoch { sample: step.sample, aiding: step.aiding };
                for (handle, other) in (0..).zip(&mut alone) {
                    let expected = other.step(&to);
                    let expected = Epoch { sample: expected.sample, aiding: expected.aiding };
                    prop_assert!(without(&plant, handle, &epoch).same_bits(&expected), "{handle}");
                    if handle < HANDLES {
                        prop_assert_eq!(plant.without(handle), loaded.without(handle));
                        prop_assert_eq!(plant.goes_on(handle), loaded.goes_on(handle));
                    }
                }
            }
            prop_assert_eq!(saved(&plant), saved(&clone));
            prop_assert_eq!(saved(&plant), saved(&loaded));
        }
    }
}

/// Samples from the onset until nothing of a disturbance goes on, which ends after 400 samples.
fn going_on(config: &PlantConfig, disturbance: &Disturbance) -> u64 {
    let mut plant = ComparedPlant::new(config).unwrap();
    let rest = command(0.0, 0.0);
    for _ in 0..100 {
        plant.step(&rest);
    }
    assert!(!plant.goes_on(3));
    plant.begin(3, disturbance);
    for k in 0..4000 {
        if k == 400 {
            plant.end(3);
        }
        if !plant.goes_on(3) && k >= 400 {
            return k;
        }
        // Half a turn of the table: 1 s after the onset, and still under way at the end.
        plant.step(&if k < 200 { rest } else { command(120.0, 0.0) });
    }
    panic!("{disturbance:?} goes on")
}

#[test]
fn a_disturbance_goes_on_until_its_edge_recoil_or_return_is_over() {
    let config = perfect();
    let line = SpectralLine {
        frequency_hz: 30.0,
        displacement_m: [1e-5, 0.0, 0.0],
        angle_rad: [0.0; 3],
        phase_rad: 0.0,
        angle_phase_rad: 0.0,
    };
    let gimbal = |action| Disturbance::Gimbal { gimbal: Gimbal::Azimuth, action };
    let shock = |recoil_s| Disturbance::Shock { peak_mps2: [9.0; 3], width_s: 0.1, recoil_s };
    let warm = Disturbance::Temperature {
        ramp_kps: 0.5,
        plateau_k: 0.8,
        gyro_bias_per_k: [1e-7; 3],
        accel_bias_per_k: [0.0; 3],
        gyro_scale_per_k: [0.0; 3],
        accel_scale_per_k: [0.0; 3],
    };
    let slip = GimbalAction::Slip { angle_rad: 0.01, within_s: 2.5, seen: false };
    let cases = [
        (Disturbance::Vibration { lines: vec![line], edge_s: 0.5 }, 500),
        (shock(3.002), 621),
        (Disturbance::LeverArm([[0.1; 3]; 3]), 400),
        // 0.8 K at 0.5 K/s: 1.6 s there, and as long back.
        (warm, 720),
        (Disturbance::Case { lines: vec![line], edge_s: 1.0 }, 600),
        (
            Disturbance::Excursion { displacement_m: [0.1; 3], angle_rad: [0.0; 3], length_s: 2.5 },
            500,
        ),
        (gimbal(slip), 500),
        (gimbal(GimbalAction::EncoderSlip { angle_rad: 0.1, flagged: false }), 400),
        // The play closes in 0.1 s.
        (gimbal(GimbalAction::Backlash { play_rad: 1e-4 }), 420),
    ];
    for (disturbance, expected) in cases {
        assert_eq!(going_on(&config, &disturbance), expected, "{disturbance:?}");
        // The increments of an instrument that lags its stamps by 12 ms come up to three samples later.
        let mut late = config.clone();
        late.imu.extensions.time_skew_s = 0.012;
        assert_eq!(going_on(&late, &disturbance), expected + 3, "{disturbance:?}");
    }
    // Over before its end.
    assert_eq!(going_on(&config, &shock(0.2)), 400);
    // A drive that was held comes to its set point later: as late as it set out.
    let turn = 120.0 * DEG;
    let (rate, acceleration) = (config.turntable.rate_radps, config.turntable.acceleration_radps2);
    let move_s = turn / rate + rate / acceleration;
    let arrives = 400 + (move_s / DT).ceil() as u64;
    assert_eq!(going_on(&config, &gimbal(GimbalAction::Stall)), arrives);
}

/// Once nothing of a disturbance is left, not even in the counters, there is no copy.
#[test]
fn a_copy_that_can_not_differ_any_more_is_gone() {
    let config = noisy();
    let (mut plant, mut twin) =
        (ComparedPlant::new(&config).unwrap(), Plant::new(&config).unwrap());
    let slip = GimbalAction::EncoderSlip { angle_rad: 0.1, flagged: true };
    let slip = Disturbance::Gimbal { gimbal: Gimbal::Roll, action: slip };
    for k in 0..600 {
        match k {
            100 | 300 => plant.begin(0, &slip),
            200 | 400 => plant.end(0),
            _ => {}
        }
        let (step, expected) = (plant.step(&target(k)), twin.step(&target(k)));
        let lasts = (100..200).contains(&k) || (300..400).contains(&k);
        assert_eq!(step != expected, lasts, "{k}");
        assert_eq!(plant.goes_on(0), lasts, "{k}");
        let copies = usize::from((100..202).contains(&k) || (300..402).contains(&k));
        assert_eq!(plant.copies(), copies, "{k}");
    }
}

#[test]
fn the_layout_is_the_stored_one() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    let mut plant = ComparedPlant::new(&everything(ground(), 0.0)).unwrap();
    for (handle, disturbance) in (0..).zip(&disturbances()[..3]) {
        plant.begin(handle, disturbance);
    }
    for k in 0..50 {
        plant.step(&target(k));
    }
    let version = COMPARED_STATE_FORMAT.version;
    let outlines = [("three disturbances", Writer::outline(&plant))];
    assert_layout(&format!("{folder}/compared.txt"), version, &outlines);

    // Bytes of that version have to remain readable.
    let path = format!("{folder}/compared-{version}.bin");
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(&path, saved(&plant)).unwrap();
    }
    let stored = std::fs::read(&path).unwrap();
    assert_eq!(saved(&ComparedPlant::load(&stored).unwrap()), stored);
}
