//! Tunable parameters: what they are, what a change does, and the answers of both standards to a wrong one.
#![allow(unsafe_code, reason = "C functions are called")]

mod importer;

use importer::Importer;
use octant_fmi::fmi2::{DISCARD, ERROR, OK};
use octant_fmu::c::ServedStandard::{Fmi2, Fmi3};
use octant_fmu::calibrator::table::MODEL as CALIBRATOR;
use octant_fmu::calibrator_can::table::MODEL as CAN;
use octant_fmu::component::ModelComponent;
use octant_fmu::plant::PlantFmu;
use octant_fmu::plant::table::{FAULT_KIND, MODEL as PLANT};
use octant_fmu::table::{DeclaredCausality, DeclaredVariability, Model};
use octant_fmu::values::CellValues;
use octant_sample::counts::DELTA_THETA_LSB_RAD;

const PERIOD_S: f64 = 0.005;

fn at(name: &str) -> usize {
    PLANT.find(name).unwrap().0
}

fn tunable(model: &Model) -> Vec<&'static str> {
    let is =
        |v: &&octant_fmu::table::DeclaredVariable| v.variability == DeclaredVariability::Tunable;
    model.variables.iter().filter(is).map(|v| v.name).collect()
}

/// The list of the documentation. Rate, seed, sequence and all else that a running model rests on stay fixed.
#[test]
fn these_and_no_others_can_change() {
    let plant = [
        "random",
        "site",
        "motion",
        "turntable",
        "imu.period_ns",
        "imu.gyro_gauss_markov",
        "imu.lever_arm",
        "fault",
    ];
    let all = tunable(&PLANT);
    assert_eq!(all.len(), 3 + 7 + 2 + 2, "{all:?}");
    for name in &all {
        assert!(!plant.iter().any(|fixed| name.starts_with(fixed)), "{name}");
    }
    let calibrator = tunable(&CALIBRATOR);
    assert_eq!(
        calibrator,
        [
            "procedure.calibration.refuse_above_mean_nis",
            "procedure.calibration.aiding.velocity_sigma",
            "procedure.calibration.aiding.position_sigma",
            "screening.gate.enabled",
            "screening.gate.nis",
            "screening.gate.rejections",
            "screening.gate.recovery",
            "screening.gate.reset_attitude",
            "screening.gate.reset_velocity",
            "screening.gate.reset_position",
            "screening.drift.sigmas",
            "screening.aiding_stamps",
        ]
    );
    assert_eq!(tunable(&CAN), calibrator);
    let page = include_str!("../../../../docs/fmu.md");
    for name in all.iter().chain(&calibrator) {
        // Groups are named by their prefix.
        let named = if name.starts_with("imu.parameters.") { "imu.parameters.*" } else { name };
        assert!(page.contains(&format!("`{named}`")), "{name} is not in docs/fmu.md");
    }
    for model in [&PLANT, &CALIBRATOR, &CAN] {
        for variable in model.variables {
            let is_parameter = variable.causality == DeclaredCausality::Parameter;
            assert!(is_parameter || variable.variability == DeclaredVariability::Discrete);
        }
    }
}

/// The fault's path is another one: it adds counts to samples that are made. A whole number of counts a sample
/// leaves no remainder, so that both give the same bits.
#[test]
fn a_tuned_bias_is_the_fault_of_that_bias_to_the_bit() {
    let counts = 4096.0;
    let bias_radps = counts * DELTA_THETA_LSB_RAD / PERIOD_S;
    let start = 400;
    let made = |faulted: bool| {
        let mut values = CellValues::new(&PLANT);
        values.set_reals(at("imu.parameters.gyro_bias"), &[1e-8, -2e-8, 3e-8]);
        if faulted {
            let kind = FAULT_KIND.items.iter().find(|item| item.1 == "bias-step").unwrap().0;
            values.set_integer(at("fault[1].kind"), kind);
            // Channel y, the bias, and its dimension (that of gyros).
            values.set_reals(at("fault[1].values"), &[2.0, bias_radps, 0.0]);
            values.set_real(at("fault[1].start"), start as f64 * PERIOD_S);
        }
        (PlantFmu::initialize(&mut values).unwrap(), values)
    };
    let (mut tuned, mut values) = made(false);
    let (mut faulted, mut expected) = made(true);
    let (mut clean, mut untouched) = made(false);
    let gyro = at("gyro.delta_theta");
    let mut altered = 0;
    for step in 0..3000 {
        if step == start {
            values.set_real(at("imu.parameters.gyro_bias") + 1, -2e-8 + bias_radps);
            tuned.tune(&values).unwrap();
        }
        // Rests, turns, rests: the increments of a plant at rest are kept.
        for values in [&mut values, &mut expected, &mut untouched] {
            values.set_real(at("gimbal_command.roll"), if step > 300 { 0.4 } else { 0.0 });
        }
        tuned.step(&mut values).unwrap();
        faulted.step(&mut expected).unwrap();
        clean.step(&mut untouched).unwrap();
        let of = |values: &CellValues| values.reals::<6>(gyro).map(f64::to_bits);
        assert_eq!(of(&values), of(&expected), "{step}");
        altered += i32::from(of(&values) != of(&untouched));
    }
    assert_eq!(altered, 3000 - start);
}

/// A fault that is a multiple of the noise is one of the noise that there is, before and after a save.
#[test]
fn a_fault_of_the_noise_follows_it() {
    let kind = FAULT_KIND.items.iter().find(|item| item.1 == "noise-gain").unwrap().0;
    let with = |walk: f64| {
        let mut values = CellValues::new(&PLANT);
        values.set_integer(at("fault[1].kind"), kind);
        values.set_reals(at("fault[1].values"), &[1.0, 10.0]);
        values.set_real(at("fault[1].start"), 1.0);
        values.set_real(at("imu.angle_random_walk"), walk);
        (PlantFmu::initialize(&mut values).unwrap(), values)
    };
    let (mut tuned, mut values) = with(1e-7);
    let (mut always, mut expected) = with(4e-7);
    for _ in 0..400 {
        tuned.step(&mut values).unwrap();
        always.step(&mut expected).unwrap();
    }
    values.set_real(at("imu.angle_random_walk"), 4e-7);
    tuned.tune(&values).unwrap();
    let mut bytes = Vec::new();
    tuned.save(&mut bytes);
    let mut loaded = PlantFmu::load(&bytes, &values).unwrap();
    let mut copy = values.clone();
    let (mut sum, mut largest) = (0.0, 0.0_f64);
    for _ in 0..400 {
        tuned.step(&mut values).unwrap();
        loaded.step(&mut copy).unwrap();
        always.step(&mut expected).unwrap();
        assert_eq!(values.cells(), copy.cells());
        let gyro = |values: &CellValues| values.real(at("gyro.delta_theta")) / DELTA_THETA_LSB_RAD;
        sum += gyro(&values) - gyro(&expected);
        largest = largest.max(f64::abs(sum));
    }
    // Remainders of the plant and of the fault, one count each.
    assert!(largest <= 2.0, "{largest}");
}

#[test]
fn truth_can_be_switched_off_and_on() {
    let mut plant = Importer::new(&PLANT, Fmi3, false);
    plant.set_real("gimbal_command.azimuth", &[1.0], OK);
    plant.steps(300);
    let kept = plant.real("truth.gimbal.azimuth");
    plant.set_boolean("truth.enabled", false, OK);
    plant.steps(100);
    assert_eq!(plant.real("truth.gimbal.azimuth"), kept);
    plant.set_boolean("truth.enabled", true, OK);
    plant.steps(1);
    assert!(plant.real("truth.gimbal.azimuth")[0] > kept[0] + 0.01);
}

/// In both standards, without and with event mode, a change gives the bits of a component that is changed directly.
#[test]
fn every_importer_gives_the_same_bits() {
    let mut hashes = Vec::new();
    for (standard, events) in [(Fmi2, false), (Fmi3, false), (Fmi3, true)] {
        let mut plant = Importer::new(&PLANT, standard, events);
        plant.steps(250);
        // The start value is no change.
        let bias = plant.real("imu.parameters.gyro_bias");
        plant.set_real("imu.parameters.gyro_bias", &bias, OK);
        plant.steps(250);
        plant.set_real("imu.parameters.gyro_bias", &[1e-6, 2e-6, -3e-6], OK);
        plant.set_real("imu.angle_random_walk", &[1e-6], OK);
        // Outputs are those of the last step until the next one.
        let sample = plant.real("gyro.delta_theta");
        assert_eq!(sample, plant.real("gyro.delta_theta"));
        plant.steps(500);
        hashes.push(plant.hash);
    }
    let mut values = CellValues::new(&PLANT);
    let mut plant = PlantFmu::initialize(&mut values).unwrap();
    let mut hash = importer::HASH;
    for step in 0..1000 {
        if step == 500 {
            values.set_reals(at("imu.parameters.gyro_bias"), &[1e-6, 2e-6, -3e-6]);
            values.set_real(at("imu.angle_random_walk"), 1e-6);
            plant.tune(&values).unwrap();
        }
        plant.step(&mut values).unwrap();
        let reals = |name| values.reals::<3>(at(name));
        importer::add(&mut hash, &reals("gyro.delta_theta"));
        importer::add(&mut hash, &reals("accelerometer.delta_velocity"));
    }
    assert_eq!(hashes, [hash; 3]);
}

#[test]
fn a_refused_value_changes_nothing() {
    for (standard, events) in [(Fmi2, false), (Fmi3, false), (Fmi3, true)] {
        let (mut plant, mut twin) =
            (Importer::new(&PLANT, standard, events), Importer::new(&PLANT, standard, events));
        plant.steps(100);
        twin.steps(100);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            plant.set_real(
                "imu.parameters.g_dependent",
                &[0.0, 0.0, 1e-9, 0.0, bad, 0.0, 0.0, 0.0, 0.0],
                DISCARD,
            );
            plant.set_real("imu.angle_random_walk", &[bad], DISCARD);
        }
        plant.set_real("imu.velocity_random_walk", &[-1e-9], DISCARD);
        assert!(plant.said("imu.velocity_random_walk can't be"), "{:?}", plant.heard());
        assert_eq!(plant.real("imu.parameters.g_dependent"), [0.0; 9]);
        plant.steps(100);
        twin.steps(100);
        assert_eq!(plant.hash, twin.hash);
        // A fixed one is an error, which ends the simulation, as any other call that isn't allowed now.
        plant.set_real("turntable.rate", &[0.1], ERROR);
        assert!(
            plant.said("turntable.rate is a fixed parameter, and the instance is"),
            "{:?}",
            plant.heard()
        );
    }
    for (model, events) in [(&CALIBRATOR, false), (&CALIBRATOR, true), (&CAN, true)] {
        let mut core = Importer::new(model, Fmi3, events);
        core.set_real("screening.gate.nis", &[25.0], OK);
        // Within the range of the table, and nothing that a core takes.
        core.set_real("screening.gate.nis", &[0.0], DISCARD);
        assert!(
            core.said("gate of the innovations is 0, a positive number is expected"),
            "{:?}",
            core.heard()
        );
        assert_eq!(core.real("screening.gate.nis"), [25.0]);
        core.set_boolean("screening.gate.enabled", false, OK);
        core.set_real("screening.gate.nis", &[0.0], OK);
        core.set_boolean("screening.gate.enabled", true, DISCARD);
        core.set_real("screening.gate.nis", &[36.0], OK);
        core.set_boolean("screening.gate.enabled", true, OK);
        core.set_real("procedure.calibration.duration", &[1000.0], ERROR);
    }
}

#[test]
fn states_have_the_values_that_were_tuned() {
    for (standard, events) in [(Fmi2, false), (Fmi3, true)] {
        let mut plant = Importer::new(&PLANT, standard, events);
        plant.steps(100);
        let first = plant.keep();
        plant.set_real("imu.parameters.accel_bias", &[0.01, 0.02, 0.03], OK);
        let second = plant.keep();
        let bytes = plant.bytes(second);
        let go_on = |plant: &mut Importer| {
            plant.hash = importer::HASH;
            plant.steps(200);
            plant.hash
        };
        let tuned = go_on(&mut plant);
        plant.restore(first);
        assert_eq!(plant.real("imu.parameters.accel_bias"), [0.0; 3]);
        assert_ne!(go_on(&mut plant), tuned);
        plant.restore(second);
        assert_eq!(go_on(&mut plant), tuned);
        let mut other = Importer::new(&PLANT, standard, events);
        let state = other.keep_bytes(&bytes);
        other.restore(state);
        assert_eq!(other.real("imu.parameters.accel_bias"), [0.01, 0.02, 0.03]);
        assert_eq!(go_on(&mut other), tuned);
        // After a reset all is as at the start.
        other.reset();
        assert_eq!(other.real("imu.parameters.accel_bias"), [0.0; 3]);
    }
}
