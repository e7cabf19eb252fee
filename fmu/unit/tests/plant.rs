//! The plant as a component: outputs at the start, faults by hand, refusals, and its state. A test
//! in the harness compares its outputs with those of the plant in one process.

use octant_faults::kinds;
use octant_fmu::component::ModelComponent;
use octant_fmu::plant::table::{FAULT_KIND, FAULT_NUMBERS, MODEL, slot};
use octant_fmu::plant::{PlantFmu, faults, numbers};
use octant_fmu::values::CellValues;

fn at(name: &str) -> usize {
    let (name, element) = match name.rsplit_once('@') {
        Some((name, element)) => (name, element.parse::<usize>().unwrap() - 1),
        None => (name, 0),
    };
    MODEL.find(name).unwrap().0 + element
}

fn item(kind: &str) -> i32 {
    FAULT_KIND.items.iter().find(|item| item.1 == kind).unwrap().0
}

/// Sets a bias on the x gyro for a fault: 1e-3 rad/s.
fn bias_step(place: usize, values: &mut CellValues) {
    let of = |name: &str| at(&format!("fault[{place}].{name}"));
    values.set_integer(of("kind"), item("bias-step"));
    // Channels, the bias, and its dimension (that of gyros).
    values.set_reals(of("values"), &[1.0, 1e-3, 0.0]);
}

fn made(mut values: CellValues) -> (PlantFmu, CellValues) {
    let plant = PlantFmu::initialize(&mut values).unwrap();
    (plant, values)
}

fn refused(change: impl FnOnce(&mut CellValues)) -> String {
    let mut values = CellValues::new(&MODEL);
    change(&mut values);
    match PlantFmu::initialize(&mut values) {
        Ok(_) => panic!("it was taken: {:?}", faults(&values)),
        Err(error) => error.to_string(),
    }
}

#[test]
fn before_the_first_sample_there_is_truth_and_nothing_else() {
    let mut values = CellValues::new(&MODEL);
    bias_step(2, &mut values);
    let (plant, values) = made(values);
    assert_eq!(plant.period_ns(), 5_000_000);
    assert!(!values.boolean(at("imu.valid")));
    assert_eq!(values.integer(at("reference.kind")), 0);
    assert_eq!(values.count(at("imu.sequence")), 0);
    assert_eq!(values.real(at("truth.latitude")), values.real(at("site.latitude")));
    assert_eq!(values.reals(at("truth.attitude")), [1.0, 0.0, 0.0, 0.0]);
    let armed = |place| values.boolean(at(&format!("fault[{place}].armed")));
    assert_eq!([1, 2, 3, 4].map(armed), [false, true, false, false]);
}

#[test]
fn the_reference_comes_once_a_second_and_truth_can_be_left_out() {
    let mut values = CellValues::new(&MODEL);
    values.set_boolean(at("truth.enabled"), false);
    values.set_real(at("gimbal_command.azimuth"), 1.0);
    let (mut plant, mut values) = made(values);
    let mut references = Vec::new();
    for k in 1..=600 {
        plant.step(&mut values).unwrap();
        assert_eq!(values.count(at("imu.sequence")), k);
        assert_eq!(values.count(at("imu.device_time_ns")), k * 5_000_000);
        if values.integer(at("reference.kind")) == 1 {
            assert_eq!(values.real(at("reference.age_ns")), 0.0);
            references.push(k);
        }
    }
    assert_eq!(references, [200, 400, 600]);
    assert_eq!(values.real(at("truth.gimbal.azimuth")), 0.0, "as at the start");
    assert!(values.real(at("gimbal.azimuth")) > 0.1);
}

#[test]
fn outputs_of_a_longer_communication_step_are_sums_over_its_periods() {
    let (mut single, mut one) = made(CellValues::new(&MODEL));
    let (mut several, mut sums) = made(CellValues::new(&MODEL));
    let mut references = 0;
    // Steps of three periods, in which the reference comes in any of them.
    for step in 1..=400u64 {
        let (mut theta, mut velocity, mut kind, mut age) = ([0.0; 3], [0.0; 3], 0, 0.0);
        for period in 0..3 {
            single.step(&mut one).unwrap();
            for axis in 0..3 {
                theta[axis] += one.real(at("gyro.delta_theta") + axis);
                velocity[axis] += one.real(at("accelerometer.delta_velocity") + axis);
            }
            age += 5e6;
            if one.integer(at("reference.kind")) != 0 {
                (kind, age) = (one.integer(at("reference.kind")), one.real(at("reference.age_ns")));
                references += 1;
            }
            match period {
                0 => several.step(&mut sums).unwrap(),
                _ => several.step_further(&mut sums).unwrap(),
            }
        }
        assert_eq!(sums.reals(at("gyro.delta_theta")), theta);
        assert_eq!(sums.reals(at("accelerometer.delta_velocity")), velocity);
        assert_eq!(sums.count(at("imu.sequence")), 3 * step);
        assert_eq!(sums.count(at("imu.device_time_ns")), 15_000_000 * step);
        assert_eq!(sums.integer(at("reference.kind")), kind);
        if kind != 0 {
            assert_eq!(sums.real(at("reference.age_ns")), age);
        }
    }
    assert_eq!(references, 6);
}

#[test]
fn a_fault_by_hand_is_held_or_lasts_its_duration() {
    let mut values = CellValues::new(&MODEL);
    for place in [1, 2] {
        bias_step(place, &mut values);
        values.set_boolean(at(&format!("fault[{place}].by_hand")), true);
    }
    values.set_real(at("fault[2].duration"), 0.02);
    let (mut plant, mut values) = made(values);
    let (mut clean, mut twin) = made(CellValues::new(&MODEL));
    let mut altered = Vec::new();
    let mut remarks = Vec::new();
    for k in 1..=100 {
        values.set_boolean(at("fault[1].fire"), (10..20).contains(&k) || (30..32).contains(&k));
        values.set_boolean(at("fault[2].fire"), k >= 50);
        plant.step(&mut values).unwrap();
        clean.step(&mut twin).unwrap();
        remarks.extend(plant.remark());
        if values.real(at("gyro.delta_theta")) != twin.real(at("gyro.delta_theta")) {
            altered.push(k);
        }
        let active = values.boolean(at("fault[1].active")) || values.boolean(at("fault[2].active"));
        assert_eq!(active, altered.last() == Some(&k), "{k}");
    }
    let expected: Vec<u64> = (10..20).chain(30..32).chain(50..54).collect();
    assert_eq!(altered, expected);
    assert_eq!(values.count(at("fault[1].samples_altered")), 12);
    assert_eq!(values.count(at("fault[2].samples_altered")), 4);
    assert_eq!(remarks[0], "fault[1] (bias-step) sets in at sample 10");
    assert_eq!(remarks[1], "fault[1] (bias-step) has ended at sample 20");
    assert_eq!(remarks.len(), 6);
}

#[test]
fn a_lost_sample_is_not_valid() {
    let mut values = CellValues::new(&MODEL);
    values.set_integer(at("fault[1].kind"), item("dropout"));
    // All samples are lost, and aiding with them; from 0.05 s on for 0.1 s.
    values.set_reals(at("fault[1].values"), &[1.0, 0.0]);
    values.set_real(at("fault[1].start"), 0.05);
    values.set_real(at("fault[1].duration"), 0.1);
    let (mut plant, mut values) = made(values);
    let mut lost = Vec::new();
    for k in 1..=100 {
        plant.step(&mut values).unwrap();
        if !values.boolean(at("imu.valid")) {
            lost.push(k);
            assert_eq!(values.count(at("imu.sequence")), 10, "as with the last sample");
        }
    }
    assert_eq!(lost, (11..31).collect::<Vec<u64>>());
}

#[test]
fn what_is_wrong_is_said() {
    let kind = |name: &'static str| {
        move |values: &mut CellValues| {
            let all: Vec<_> = kinds::all().map(|kind| kind.name).collect();
            let place = all.iter().position(|known| *known == name).unwrap();
            values.set_integer(at("fault[3].kind"), place as i32 + 1);
        }
    };
    assert_eq!(
        refused(kind("restart")),
        format!(
            "fault[3].kind is {} (restart): it acts on the unit under test, and a plant has none",
            kinds::all().position(|kind| kind.name == "restart").unwrap() + 1
        )
    );
    assert!(refused(kind("duplicate")).ends_with(
        "(duplicate): it can deliver several samples at once, and a plant gives one sample a step"
    ));
    assert_eq!(
        refused(|values| values.set_integer(at("fault[3].kind"), 999)),
        "fault[3].kind is 999, which is none of its items"
    );
    let with = |numbers: [f64; 4]| {
        refused(move |values| {
            bias_step(1, values);
            values.set_reals(at("fault[1].values"), &numbers);
        })
    };
    assert_eq!(
        with([0.0, 1e-3, 0.0, 0.0]),
        "fault[1].values[1] (channels of bias-step) is 0, a sum of channels, 1 to 63, is expected"
    );
    assert_eq!(
        with([64.0, 1e-3, 0.0, 0.0]),
        "fault[1].values[1] (channels of bias-step) is 64, a whole number from 0 to 63 is expected"
    );
    assert_eq!(
        with([1.0, 0.0, 0.0, 0.0]),
        "fault[1].values[2] (amplitude of bias-step) is 0, a number other than 0 is expected"
    );
    assert_eq!(
        with([1.0, 1e-3, 0.5, 0.0]),
        "fault[1].values[3] (amplitude of bias-step) is 0.5, a whole number from 0 to 1 is expected"
    );
    assert_eq!(
        with([1.0, 1e-3, 1.0, 0.0]),
        "fault[1]: amplitude: a value for accelerometers, and gyros are among the channels"
    );
    assert_eq!(
        with([1.0, 1e-3, 0.0, 7.0]),
        "fault[1].values[4] is 7, and bias-step takes fewer numbers: 0 is expected"
    );
    assert_eq!(
        refused(|values| {
            bias_step(1, values);
            values.set_real(at("fault[1].duration"), 0.001);
        }),
        "fault[1].duration is 0.001 s, which is less than half a sample"
    );
    assert_eq!(
        refused(|values| {
            values.set_integer(at("fault[1].kind"), item("dropout"));
            values.set_reals(at("fault[1].values"), &[1.0, 0.0]);
            values.set_real(at("fault[1].recovery"), 1.0);
        }),
        "fault[1].recovery is 1 s, and a fault of the kind dropout doesn't fade: 0 is expected"
    );
    assert_eq!(
        refused(|values| {
            values.set_integer(at("motion.kind"), 1);
            values.set_integer(at("motion.roll.count"), 65);
        }),
        "motion.roll.count is 65, 0 to 64 is expected"
    );
}

#[test]
fn every_kind_has_room_for_its_numbers_and_says_what_they_are() {
    let mut most = 0;
    for kind in kinds::all() {
        let all = numbers(kind);
        if FAULT_KIND.items.iter().any(|item| item.1 == kind.name) {
            most = most.max(all.len());
        }
        for (place, number) in (1..).zip(&all) {
            assert_eq!(number.place, place, "{}", kind.name);
            assert!(number.meaning.ends_with('.'), "{}: {}", kind.name, number.meaning);
        }
    }
    assert_eq!(most, FAULT_NUMBERS);
    let bias = numbers(kinds::named("bias-step").unwrap());
    assert_eq!(
        bias.iter().map(|number| number.meaning.as_str()).collect::<Vec<_>>(),
        [
            "Channels that get the bias: gyros or accelerometers, added up: 1, 2, 4 for the gyros \
             x, y, z, 8, 16, 32 for the accelerometers.",
            "The bias that is added: an angular rate for gyros, an acceleration for accelerometers, rad/s or m/s2.",
            "What amplitude is. 0: an angular rate in rad/s, 1: an acceleration in m/s2.",
        ]
    );
}

#[test]
fn a_state_is_of_one_plant_and_whole() {
    let mut values = CellValues::new(&MODEL);
    bias_step(1, &mut values);
    values.set_real(at("fault[1].start"), 0.5);
    let (mut plant, mut values) = made(values);
    for _ in 0..150 {
        plant.step(&mut values).unwrap();
    }
    let mut bytes = Vec::new();
    plant.save(&mut bytes);
    let mut loaded = PlantFmu::load(&bytes, &values).unwrap();
    let mut copy = values.clone();
    for _ in 0..300 {
        plant.step(&mut values).unwrap();
        loaded.step(&mut copy).unwrap();
        assert_eq!(values.cells(), copy.cells());
    }
    for end in 0..bytes.len() {
        assert!(PlantFmu::load(&bytes[..end], &values).is_err());
    }
    for at in 0..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 0x10;
        assert!(PlantFmu::load(&altered, &values).is_err(), "{at}");
    }
    let said = |change: &dyn Fn(&mut CellValues)| {
        let mut values = values.clone();
        change(&mut values);
        PlantFmu::load(&bytes, &values).unwrap_err().to_string()
    };
    assert_eq!(
        said(&|values| values.set_count(at("random.seed"), 2)),
        "values: the parameters are not those that the plant was made from"
    );
    assert_eq!(
        said(&|values| values.set_integer(slot::FAULT_KIND, 0)),
        "values: there are no faults, and the plant had some"
    );
    assert_eq!(
        said(&|values| {
            values.set_integer(slot::FAULT_KIND, item("spike"));
            values.set_reals(slot::FAULT_VALUES, &[1.0, 1e-3, 0.0]);
        }),
        "fault: \"fault[1]\" (bias-step) was found, \"fault[1]\" (spike) is expected"
    );
}
