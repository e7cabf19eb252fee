use super::*;
use crate::configure::configurations;
use crate::{Epoch, Source};
use octant_fmu_bind::convert::ChannelConversion;
use octant_fmu_bind::testing::{Scripted, With, description, variable};
use octant_fmu_host::description::{Causality, Description, VariableType};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalAngles, GimbalCommand, Reference, Status};
use octant_scenario::{self as scenario, Method};
use std::path::Path;

fn sine() -> Description {
    use Causality::{Input, Output, Parameter};
    description(
        "imu",
        vec![
            variable("w", 1, VariableType::Float64, Output).array(3).in_unit("deg/h"),
            variable("fx", 4, VariableType::Float64, Output),
            variable("fy", 5, VariableType::Float64, Output),
            variable("fz", 6, VariableType::Float64, Output),
            variable("az", 7, VariableType::Float64, Output).in_unit("deg"),
            variable("el", 8, VariableType::Float64, Output).in_unit("deg"),
            variable("cmd[1]", 9, VariableType::Float64, Input).in_unit("deg"),
            variable("cmd[2]", 10, VariableType::Float64, Input).in_unit("deg"),
            variable("vn", 11, VariableType::Float64, Output).in_unit("m/s"),
            variable("lat", 12, VariableType::Float64, Output).in_unit("deg"),
            variable("ok", 13, VariableType::Boolean, Output),
            variable("mass", 14, VariableType::Float64, Parameter).in_unit("kg"),
            variable("length", 15, VariableType::Float64, Parameter).in_unit("m"),
            variable("mode", 16, VariableType::Int32, Parameter),
        ],
    )
}

const MAP: &str = "[source.fmu.map]\ngyro.rate = \"w\"\n\
    accelerometer.specific_force = [{ variable = \"fx\", unit = \"g\" }, \
    { variable = \"-fy\", unit = \"g\" }, { variable = \"fz\", unit = \"g\" }]\n";

fn scenario(more: &str) -> Scenario {
    let text = format!(
        "schema = 1\n[procedure.calibration]\nduration = \"4 min\"\n[source]\n\
         uri = \"fmu:imu.fmu\"\n{more}"
    );
    Scenario::parse(&text, "imu.toml", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn open(
    scenario: &Scenario,
    description: Description,
    behaviour: impl FnMut(&mut [f64], f64) -> Result<bool, String> + Send + 'static,
) -> Result<AnySource, SourceError> {
    let scenario::SourceSpec::Fmu(fmu) = &scenario.source else { panic!("an FMU") };
    let (plant, ..) = configurations(scenario, Method::Primary, 1).unwrap();
    let instance = Scripted::boxed(description, behaviour);
    of_instance(scenario, fmu, &plant, NamedInstance { instance, uri: "fmu:imu.fmu".to_owned() })
}

#[test]
fn rates_of_any_unit_become_counts_with_remainders_carried() {
    let scenario = scenario(MAP);
    let mut source = open(&scenario, sine(), |cells, time_s| {
        cells[1] = 3600.0 * (2.0 * time_s).sin();
        cells[4..7].copy_from_slice(&[0.1, 0.2, -1.0]);
        Ok(true)
    })
    .unwrap();
    let (mut epoch, mut sum) = (Epoch::default(), [0i64; 4]);
    let (mut turned, mut last_ns) = (0.0, 0);
    for k in 1..=48_000u64 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        let sample = epoch.sample;
        assert_eq!((sample.sequence, sample.status), (k, Status::GIMBAL_INVALID));
        assert_eq!(sample.device_time.ns, last_ns + 5_000_000);
        last_ns = sample.device_time.ns;
        // The closed form: 1 deg/s · sin(2 t) at the end of each interval, held over 5 ms.
        turned += (2.0 * (k as f64 * 0.005)).sin().to_radians() * 0.005;
        sum[0] += i64::from(sample.delta_theta[0]);
        for axis in 0..3 {
            sum[1 + axis] += i64::from(sample.delta_velocity[axis]);
        }
        assert!((sum[0] as f64 - turned / DELTA_THETA_LSB_RAD).abs() < 0.51, "at {k}");
        for (axis, g) in [(0, 0.1), (1, -0.2), (2, -1.0)] {
            let velocity = g * 9.806_65 * (k as f64 * 0.005) / DELTA_VELOCITY_LSB_MPS;
            assert!((sum[1 + axis] as f64 - velocity).abs() < 0.51, "at {k}");
        }
    }
    assert!(!source.next(&GimbalCommand::default(), &mut epoch).unwrap(), "four minutes");
    assert!(source.truth().is_none() && !source.has_true_parameters());
}

#[test]
fn a_command_acts_from_the_end_of_the_interval_that_it_comes_with() {
    let more = "gimbal.azimuth = \"az\"\ngimbal.roll = \"el\"\n\
        gimbal_command.azimuth = \"cmd[1]\"\ngimbal_command.roll = \"cmd[2]\"\n";
    let scenario = scenario(&format!("{MAP}{more}"));
    // The table reaches a target given at the start of a step at once.
    let mut source = open(&scenario, sine(), |cells, _| {
        cells[7] = cells[9];
        cells[8] = cells[10];
        Ok(true)
    })
    .unwrap();
    let mut epoch = Epoch::default();
    let target =
        |k: i32| GimbalCommand { target: GimbalAngles { azimuth: k << 20, roll: -k << 20 } };
    for k in 1..=10 {
        assert!(source.next(&target(k), &mut epoch).unwrap());
        // A command given with the previous call acts in this interval.
        assert_eq!(epoch.sample.gimbal, target(k - 1).target);
        assert_eq!(epoch.sample.status, Status::empty());
    }
}

#[test]
fn references_come_with_the_period_or_when_the_fmu_says() {
    let velocity =
        "reference.velocity = [\"vn\", { constant = \"0 m/s\" }, { constant = \"1 mm/s\" }]\n";
    let every = scenario(&format!("{MAP}{velocity}"));
    let fresh = scenario(&format!("{MAP}{velocity}reference.valid = \"ok\"\n"));
    for (scenario, due) in [
        (every, Box::new(|k: u64| k.is_multiple_of(200)) as Box<dyn Fn(u64) -> bool>),
        (fresh, Box::new(|k| k.is_multiple_of(7))),
    ] {
        let mut source = open(&scenario, sine(), |cells, time_s| {
            let k = (time_s / 0.005).round() as u64;
            cells[11] = k as f64;
            cells[13] = f64::from(u8::from(k.is_multiple_of(7)));
            Ok(true)
        })
        .unwrap();
        let mut epoch = Epoch::default();
        for k in 1..=1000 {
            assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
            assert_eq!(epoch.aiding.is_some(), due(k), "{k}");
            if let Some(aiding) = epoch.aiding {
                assert_eq!(aiding.device_time, epoch.sample.device_time);
                assert_eq!(aiding.reference, Reference::Velocity([k as f64, 0.0, 1e-3]));
            }
        }
    }
}

#[test]
fn increments_of_short_steps_add_up_and_steps_without_a_sample_give_none() {
    let text = "[source.fmu]\nstep = \"1 ms\"\n[source.fmu.map]\n\
        gyro.delta_theta = [{ variable = \"fx\", unit = \"rad\" }, { constant = \"0 rad\" }, { constant = \"0 rad\" }]\n\
        accelerometer.delta_velocity = [{ variable = \"fy\", unit = \"mm/s\", scale = 2.0 }, \
        { constant = \"0 m/s\" }, { constant = \"0 m/s\" }]\nimu.valid = \"ok\"\n";
    let scenario = scenario(text);
    let mut steps = 0u64;
    let mut source = open(&scenario, sine(), move |cells, time_s| {
        steps += 1;
        assert!((time_s - steps as f64 * 1e-3).abs() < 1e-12);
        cells[4] = DELTA_THETA_LSB_RAD * 3.0;
        cells[5] = DELTA_VELOCITY_LSB_MPS * 1e3;
        // Every second sample is invalid.
        cells[13] = f64::from(u8::from(steps.div_ceil(5) % 2 == 1));
        Ok(true)
    })
    .unwrap();
    let mut epoch = Epoch::default();
    for k in 1..=100u64 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        assert_eq!(epoch.sample.delta_theta, [15, 0, 0]);
        assert_eq!(epoch.sample.delta_velocity, [10, 0, 0]);
        assert_eq!(epoch.sample.sequence, k);
        assert_eq!(epoch.sample.device_time.ns, (2 * k - 1) * 5_000_000);
    }
}

#[test]
fn truth_is_known_where_it_is_mapped() {
    let more = "truth.latitude = \"lat\"\ntruth.longitude = { constant = \"10 deg\" }\n\
        truth.height = { constant = \"5 m\" }\n";
    let scenario = scenario(&format!("{MAP}{more}"));
    let mut source = open(&scenario, sine(), |cells, _| {
        cells[12] = 45.0;
        Ok(true)
    })
    .unwrap();
    assert!(source.next(&GimbalCommand::default(), &mut Epoch::default()).unwrap());
    let truth = source.truth().unwrap();
    assert!((truth.latitude_rad - 45f64.to_radians()).abs() < 1e-15);
    assert_eq!((truth.height_m, truth.time.ns), (5.0, 5_000_000));
}

#[test]
fn an_fmu_that_ends_is_the_end_and_one_that_crashes_is_gone() {
    let scenario = scenario(MAP);
    let run = |end: Result<bool, String>| {
        let mut source =
            open(
                &scenario,
                sine(),
                move |_, time_s| {
                    if time_s > 0.02 { end.clone() } else { Ok(true) }
                },
            )
            .unwrap();
        let mut samples = 0;
        loop {
            match source.next(&GimbalCommand::default(), &mut Epoch::default()) {
                Ok(true) => samples += 1,
                Ok(false) => return (samples, String::new()),
                Err(error) => return (samples, error.to_string()),
            }
        }
    };
    assert_eq!(run(Ok(false)), (4, String::new()));
    let (samples, error) = run(Err("gave no answer to fmi3DoStep for 10 s".to_owned()));
    assert_eq!(samples, 4);
    assert_eq!(
        error,
        "source fmu:imu.fmu is gone: at 0.02 s the process of imu gave no answer to fmi3DoStep for \
         10 s"
    );
}

#[test]
fn what_doesnt_fit_an_instrument_is_told_with_its_place() {
    for (more, expected) in [
        (
            "[source.fmu.map]\ngyro.rate = \"az\"\n",
            "imu.toml:7:13: source.fmu.map.gyro.rate: the Float64 az has 1 elements, expected 3",
        ),
        ("", "neither gyro.delta_theta nor gyro.rate is mapped"),
        (
            "[source.fmu.map]\ngyro.rate = \"w\"\naccelerometer.specific_force = [\"fx\", \"fy\", \"fz\"]\n",
            "fx has no unit in its description, and accelerometer.specific_force is an acceleration: \
             say which, as in { variable = \"fx\", unit = \"m/s^2\" }",
        ),
        (
            "[source.fmu.map]\ngyro.rate = [\"w[1]\", \"az\", \"w[3]\"]\n",
            "source.fmu.map.gyro.rate[1]: az is in deg, an angle, and gyro.rate is an angular rate",
        ),
        (
            "[source.fmu.map]\ngyro.rate = [\"w[1]\", \"w[2]\", { variable = \"w[3]\", unit = \"rad/s\" }]\n",
            "found unit = \"rad/s\", and the description says that w is in deg/h",
        ),
        (
            "[source.fmu.map]\ngyro.rate = \"w\"\ngimbal.azimuth = \"az\"\n",
            "gimbal.roll is mapped to nothing",
        ),
        (
            "[source.fmu.map]\ngimbal_command.azimuth = \"az\"\n",
            "az is an output of the FMU, expected an input",
        ),
        (
            "[source.fmu.map]\nimu.valid = \"az\"\n",
            "az is a Float64, and imu.valid is true or false",
        ),
        (
            "[source.fmu]\nparameters = { mas = 3.0 }\n",
            "imu.toml:7:22: source.fmu.parameters.mas: the FMU has no variable \"mas\"; nearest are \"mass\"",
        ),
        (
            "[source.fmu]\nparameters = { length = \"3 s\" }\n",
            "length is in m, a length, and the value is a time, such as s",
        ),
        (
            "[source.fmu]\nparameters = { mode = 1.5 }\n",
            "mode is an Int32: expected a whole number from",
        ),
        (
            "[source.fmu]\nparameters = { mode = true }\n",
            "found true, and mode is an Int32: expected a whole number",
        ),
        (
            "[source.fmu]\nparameters = { az = 3.0 }\n",
            "az can't be set: it is an output that the FMU calculates",
        ),
        ("[source.fmu]\nparameters = { w = 3.0 }\n", "found 1 values, and w has 3 elements"),
    ] {
        let scenario = scenario(more);
        let error = open(&scenario, sine(), |_, _| Ok(true)).err();
        let error = error.map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(expected), "{more}:\n  {error}\n  {expected}");
    }
}

#[test]
fn parameters_are_set_in_their_units() {
    let more = "[source.fmu]\nparameters = { mass = 3.2e6, length = \"5 cm\", mode = 7 }\n";
    let scenario = scenario(&format!("{more}{MAP}"));
    let mut source = open(&scenario, sine(), |cells, _| {
        assert_eq!(&cells[14..17], &[3.2e6, 0.05, 7.0]);
        Ok(true)
    })
    .unwrap();
    assert!(source.next(&GimbalCommand::default(), &mut Epoch::default()).unwrap());
}

/// Scenario whose case motion comes from a ship FMU that outputs its position.
fn ship(geodetic: bool) -> Description {
    let output = |name: &str, reference, unit: &str| {
        variable(name, reference, VariableType::Float64, Causality::Output).in_unit(unit)
    };
    let mut variables =
        vec![output("psi", 1, "deg"), output("theta", 2, "rad"), output("phi", 3, "mrad")];
    if geodetic {
        variables.extend([output("lat", 4, "rad"), output("lon", 5, "rad"), output("h", 6, "m")]);
    } else {
        variables.extend([output("n", 4, "m"), output("e", 5, "m"), output("d", 6, "cm")]);
    }
    description("ship", variables)
}

const SHIP: &str = "[motion]\nkind = \"dockside\"\nheading = \"175 deg\"\npitch = \"2 deg\"\n\
    [motion.ship]\n\
    roll = [{ amplitude = \"3 deg\", period = \"8 s\", phase = \"20 deg\" }]\n\
    pitch = [{ amplitude = \"1.5 deg\", period = \"6 s\", phase = \"50 deg\" }]\n\
    yaw = [{ amplitude = \"10 deg\", period = \"10 s\", phase = \"0 deg\" }]\n\
    surge = [{ amplitude = \"0.2 m\", period = \"6 s\", phase = \"80 deg\" }]\n\
    sway = [{ amplitude = \"0.3 m\", period = \"7 s\", phase = \"10 deg\" }]\n\
    heave = [{ amplitude = \"0.2 m\", period = \"8 s\", phase = \"30 deg\" }]\n";

fn swaying(map: &str, step: &str) -> Scenario {
    let text = format!(
        "schema = 1\n[procedure.calibration]\nduration = \"4 min\"\n{SHIP}\
         [source]\nuri = \"fmu:ship.fmu\"\n[source.fmu]\nstep = \"{step}\"\n[source.fmu.map]\n{map}"
    );
    Scenario::parse(&text, "ship.toml", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// Sway at a time: heading (deg, wrapped), pitch (rad), roll (mrad), north, east, down.
fn sway_at(time_s: f64) -> [f64; 6] {
    let sine = |amplitude: f64, period_s: f64, phase_deg: f64| {
        amplitude
            * libm::sin(2.0 * std::f64::consts::PI * time_s / period_s + phase_deg.to_radians())
    };
    let heading = 175.0 + sine(10.0, 10.0, 0.0);
    let (surge, sway) = (sine(0.2, 6.0, 80.0), sine(0.3, 7.0, 10.0));
    let (s, c) = libm::sincos(175f64.to_radians());
    [
        if heading > 180.0 { heading - 360.0 } else { heading },
        (2.0 + sine(1.5, 6.0, 50.0)).to_radians(),
        1e3 * sine(3.0, 8.0, 20.0).to_radians(),
        c * surge - s * sway,
        s * surge + c * sway,
        sine(0.2, 8.0, 30.0),
    ]
}

const METRES: &str = "case.heading = \"psi\"\ncase.pitch = \"theta\"\ncase.roll = \"phi\"\n\
    case.north = \"n\"\ncase.east = \"e\"\ncase.down = \"d\"\n";
const GEODETIC: &str = "case.heading = \"psi\"\ncase.pitch = \"theta\"\ncase.roll = \"phi\"\n\
    case.latitude = \"lat\"\ncase.longitude = \"lon\"\ncase.height = \"h\"\n";

/// A ship FMU with the sway of the plant's own motion gives the same counts, with the same noise.
///
/// With a step of H the rate at a point is off by H⁴/30 of the fifth derivative, and between points
/// the acceleration by 0.19 H³ of it. The fifth derivatives here are 0.040 rad/s⁵ and 0.31 m/s⁵, all
/// axes together: with 50 ms 8.3e-9 rad/s and 7.4e-6 m/s², or 3 and 40 counts in a sample; with 5 ms
/// nothing. At the first point, which has neighbours on one side alone, they are H⁴/5 and 5H³/6: 17
/// and 173 counts. One count is for rounding. Positions in radians of latitude have a last digit of
/// 7e-10 m, whose second difference over 5 ms is 1e-4 m/s² at most, 540 counts.
#[test]
fn a_ship_that_sways_as_the_plants_own_gives_the_same_counts() {
    use octant_earth::ellipsoid::Ellipsoid;
    let own = {
        let text = format!("schema = 1\n[procedure.calibration]\nduration = \"4 min\"\n{SHIP}");
        Scenario::parse(&text, "own.toml", Path::new(""), &[]).unwrap()
    };
    let (config, ..) = configurations(&own, Method::Primary, 1).unwrap();
    let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
    let site = config.site;
    for (geodetic, period, later, at_start) in [
        (false, "5 ms", [1, 1], [1, 1]),
        (true, "5 ms", [1, 540], [1, 540]),
        (false, "50 ms", [4, 41], [18, 174]),
    ] {
        let map = if geodetic { GEODETIC } else { METRES };
        let scenario = swaying(map, period);
        let scenario::SourceSpec::Fmu(fmu) = &scenario.source else { panic!("an FMU") };
        let give = move |cells: &mut [f64], time_s: f64| {
            let [heading, pitch, roll, north, east, down] = sway_at(time_s);
            cells[1..4].copy_from_slice(&[heading, pitch, roll]);
            if geodetic {
                let parallel_m = earth.transverse_radius_m * earth.cos_latitude;
                cells[4] = site.latitude_rad + north / earth.meridian_radius_m;
                cells[5] = site.longitude_rad + east / parallel_m;
                cells[6] = site.height_m - down;
            } else {
                cells[4..7].copy_from_slice(&[north, east, 100.0 * down]);
            }
        };
        let mut instance = Scripted::boxed(ship(geodetic), move |cells, time_s| {
            give(cells, time_s);
            Ok(true)
        });
        // Outputs at the start.
        let mut cells = [0.0; 64];
        give(&mut cells, 0.0);
        for variable in ship(geodetic).variables {
            let group =
                octant_fmu_host::instance::VariableGroup::of(&ship(geodetic), &variable).unwrap();
            instance.set(&group, &[cells[variable.reference as usize]]).unwrap();
        }
        let kept = NamedInstance { instance, uri: "fmu:ship.fmu".to_owned() };
        let mut source = of_instance(&scenario, fmu, &config, kept).unwrap();
        let mut plant = octant_plant::Plant::new(&config).unwrap();
        let command = GimbalCommand { target: GimbalAngles { azimuth: 1 << 27, roll: -1 << 26 } };
        let mut epoch = Epoch::default();
        for k in 0..4000 {
            let mut worst = [0; 2];
            let step = plant.step(&command);
            assert!(source.next(&command, &mut epoch).unwrap());
            assert_eq!(epoch.sample.gimbal, step.sample.gimbal);
            assert_eq!(epoch.aiding, step.aiding, "the dock's position, with its noise");
            for axis in 0..3 {
                let apart = |a: i32, b: i32| (i64::from(a) - i64::from(b)).abs();
                let theta = apart(epoch.sample.delta_theta[axis], step.sample.delta_theta[axis]);
                let velocity =
                    apart(epoch.sample.delta_velocity[axis], step.sample.delta_velocity[axis]);
                worst = [worst[0].max(theta), worst[1].max(velocity)];
            }
            let [theta, velocity] = if k < 20 { at_start } else { later };
            assert!(worst[0] <= theta && worst[1] <= velocity, "{period} {k}: {worst:?}");
        }
        let (found, truth) = (source.truth().unwrap(), plant.truth());
        let north_m = (found.latitude_rad - truth.latitude_rad) * 6.4e6;
        assert!(north_m.abs() < 1e-8 && (found.height_m - truth.height_m).abs() < 1e-8);
        for axis in 0..3 {
            assert!((found.velocity_mps[axis] - truth.velocity_mps[axis]).abs() < 1e-6);
        }
        let dot: f64 = (0..4).map(|i| found.q_nb[i] * truth.q_nb[i]).sum();
        assert!((dot.abs() - 1.0).abs() < 1e-15, "{dot}");
        assert!(source.has_true_parameters() && source.disturbed().is_some());
    }
}

#[test]
fn what_doesnt_fit_a_motion_is_told() {
    for (map, expected) in [
        ("case.heading = \"n\"\n", "n is in m, a length, and case.heading is an angle"),
        ("case.north = \"n\"\ncase.height = \"d\"\n", "found beside case.north"),
        ("case.latitude = { constant = \"30 deg\" }\n", "case.longitude is mapped to nothing"),
    ] {
        let scenario = swaying(map, "5 ms");
        let scenario::SourceSpec::Fmu(fmu) = &scenario.source else { panic!("an FMU") };
        let own = format!("schema = 1\n[procedure.calibration]\nduration = \"4 min\"\n{SHIP}");
        let own = Scenario::parse(&own, "own.toml", Path::new(""), &[]).unwrap();
        let (config, ..) = configurations(&own, Method::Primary, 1).unwrap();
        let instance = Scripted::boxed(ship(false), |_, _| Ok(true));
        let kept = NamedInstance { instance, uri: "fmu:ship.fmu".to_owned() };
        let error = of_instance(&scenario, fmu, &config, kept).err();
        let error = error.map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(expected), "{map}:\n  {error}\n  {expected}");
    }
}

#[test]
fn a_conversion_and_its_inverse() {
    let celsius = ChannelConversion { factor: 1.0, offset: 273.15 };
    assert_eq!(celsius.to_si(20.0), 293.15);
    assert!((celsius.from_si(293.15) - 20.0).abs() < 1e-12);
    assert_eq!(ChannelConversion::IDENTITY.to_si(-0.0).to_bits(), (-0.0f64).to_bits());
    assert_eq!(ChannelConversion::IDENTITY.from_si(-0.0).to_bits(), (-0.0f64).to_bits());
}
