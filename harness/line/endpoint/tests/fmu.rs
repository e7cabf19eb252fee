//! FMUs as the core: our own one against the core in process, and one of another shape.

use octant_endpoint::{Endpoint, FmuEndpoint, InProcess};
use octant_fmu::calibrator::Calibrator;
use octant_fmu_bind::open::NamedInstance;
use octant_fmu_bind::testing::{OwnModel, Scripted, With, description, variable};
use octant_fmu_host::description::{Causality, VariableType};
use octant_recorder::StreamHash;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Epoch, Mode, Output, Parameters, Reference};
use octant_scenario::{self as scenario, Fmu, Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{PlantSource, Source};
use std::path::Path;

fn scenario(text: &str) -> Scenario {
    let text = format!("schema = 1\n{text}\n[endpoint]\nuri = \"fmu:core.fmu\"\n");
    Scenario::parse(&text, "core.toml", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn fmu_of(scenario: &Scenario) -> &Fmu {
    match &scenario.endpoint {
        scenario::EndpointSpec::Fmu(fmu) => fmu,
        scenario::EndpointSpec::InProcess | scenario::EndpointSpec::Live(_) => panic!("an FMU"),
    }
}

fn kept(instance: Box<dyn octant_fmu_host::instance::Instance>) -> NamedInstance {
    NamedInstance { instance, uri: "fmu:core.fmu".to_owned() }
}

/// Returns the hash over the first samples of a scenario, and the last mode.
fn hash(scenario: &Scenario, endpoint: &mut dyn Endpoint, samples: u64) -> (String, Mode) {
    let (plant, ..) = configurations(scenario, Method::Primary, 1).unwrap();
    let mut source = PlantSource::new(&plant, samples).unwrap();
    let (mut epoch, mut output) = (Epoch::default(), Output::default());
    let (mut hash, mut revision) = (StreamHash::new(), 0);
    while source.next(&output.gimbal_command, &mut epoch).unwrap() {
        endpoint.step(&epoch, &mut output).unwrap();
        hash.epoch(&epoch.sample, epoch.aiding.as_ref(), &output);
        if output.parameters_revision != revision {
            revision = output.parameters_revision;
            hash.parameters(&endpoint.parameters());
        }
    }
    (hash.hex(), output.mode)
}

const LOCKSTEP: &str = "[procedure.calibration]\nduration = \"40 s\"\n\
    stops = [{ roll = \"0 deg\" }, { roll = \"45 deg\" }, { azimuth = \"30 deg\", roll = \"45 deg\" }]\n\
    [procedure.navigation]\nduration = \"20 s\"\n";

#[test]
fn our_calibrator_answers_as_the_core_does_also_after_a_restart() {
    let scenario = scenario(LOCKSTEP);
    let (_, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let mut inside = InProcess::new(&core).unwrap();
    let instance = kept(OwnModel::<Calibrator>::boxed());
    let mut fmu = FmuEndpoint::of_instance(&scenario, fmu_of(&scenario), &core, instance).unwrap();
    let expected = hash(&scenario, &mut inside, 12_000);
    assert_eq!(expected.1, Mode::Done);
    assert_eq!(hash(&scenario, &mut fmu, 12_000), expected);
    let mut offset = [0.0; PARAMETER_COUNT];
    offset[0] = 1e-9;
    let offset = Parameters::from_array(&offset);
    for offset in [None, Some(&offset)] {
        inside.restart(offset).unwrap();
        fmu.restart(offset).unwrap();
        assert_eq!(hash(&scenario, &mut fmu, 9000), hash(&scenario, &mut inside, 9000));
    }
}

#[test]
fn the_end_of_the_source_reaches_our_calibrator() {
    let scenario = scenario(LOCKSTEP);
    let (_, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let mut inside = InProcess::new(&core).unwrap();
    let instance = kept(OwnModel::<Calibrator>::boxed());
    let mut fmu = FmuEndpoint::of_instance(&scenario, fmu_of(&scenario), &core, instance).unwrap();
    hash(&scenario, &mut inside, 4000);
    hash(&scenario, &mut fmu, 4000);
    let (a, b) = (inside.end_of_stream().unwrap().unwrap(), fmu.end_of_stream().unwrap().unwrap());
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
    let (a, b) = (inside.conclusion(), fmu.conclusion());
    assert_eq!(a.refused, b.refused);
    let (a, b) = (inside.parameters(), fmu.parameters());
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

fn foreign() -> octant_fmu_host::description::Description {
    use Causality::{Input, Output};
    description(
        "core",
        vec![
            variable("w", 1, VariableType::Float64, Input).array(3).in_unit("deg/s"),
            variable("f", 4, VariableType::Float64, Input).array(3).in_unit("m/s2"),
            variable("fresh", 7, VariableType::Boolean, Input),
            variable("v", 8, VariableType::Float64, Input).array(3).in_unit("km/h"),
            variable("az", 11, VariableType::Float64, Output).in_unit("deg"),
            variable("el", 12, VariableType::Float64, Output).in_unit("deg"),
            variable("phase", 13, VariableType::Int32, Output),
            variable("bias", 14, VariableType::Float64, Output).array(3).in_unit("deg/h"),
        ],
    )
}

const FOREIGN: &str = "[endpoint.fmu]\nmodes = { calibrating = [1, 2], navigating = 7 }\n\
    [endpoint.fmu.map]\ngyro.rate = \"w\"\naccelerometer.specific_force = [\"f[1]\", \"f[2]\", \"-f[3]\"]\n\
    reference.valid = \"fresh\"\nreference.velocity = \"v\"\ngimbal_command.azimuth = \"az\"\n\
    gimbal_command.roll = \"el\"\nmode = \"phase\"\nparameters.gyro_bias = \"bias\"\n";

#[test]
fn a_foreign_core_gets_its_units_and_its_modes_are_understood() {
    let text = format!(
        "schema = 1\n[procedure.calibration]\n[endpoint]\nuri = \"fmu:core.fmu\"\n{FOREIGN}"
    );
    let scenario = Scenario::parse(&text, "core.toml", Path::new(""), &[]).unwrap();
    let (_, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let seen = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    let saw = std::sync::Arc::clone(&seen);
    let mut steps = 0;
    let instance = Scripted::boxed(foreign(), move |cells, _| {
        steps += 1;
        saw.lock().unwrap().push(cells[1..11].to_vec());
        cells[11] = 90.0;
        cells[12] = -45.0;
        cells[13] = if steps < 3 { 2.0 } else { 7.0 };
        cells[14] = if steps < 2 { 0.0 } else { 0.5 };
        Ok(true)
    });
    let fmu = fmu_of(&scenario);
    let mut endpoint = FmuEndpoint::of_instance(&scenario, fmu, &core, kept(instance)).unwrap();
    let mut epoch = Epoch::default();
    let mut output = Output::default();
    // 2³⁰ counts of 2⁻³⁶ rad in 5 ms are 3.125 rad/s, 2²⁸ of 2⁻³⁰ m/s are 50 m/s².
    epoch.sample.delta_theta = [1 << 30, 0, 0];
    epoch.sample.delta_velocity = [0, 0, 1 << 28];
    epoch.sample.sequence = 9;
    endpoint.step(&epoch, &mut output).unwrap();
    let degrees = 3.125f64.to_degrees();
    {
        let seen = seen.lock().unwrap();
        assert!((seen[0][0] - degrees).abs() < 1e-12 * degrees, "{:?}", seen[0]);
        assert_eq!(seen[0][5], -50.0);
        assert_eq!(seen[0][6], 0.0, "no reference");
    }
    assert_eq!(
        (output.sequence, output.mode, output.parameters_revision),
        (9, Mode::Calibrating, 0)
    );
    assert!(
        (output.gimbal_command.target.azimuth_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-8
    );
    assert!(output.nis.is_nan());
    epoch.aiding = Some(octant_sample::Aiding {
        device_time: epoch.sample.device_time,
        reference: Reference::Velocity([10.0, 0.0, -1.0]),
    });
    endpoint.step(&epoch, &mut output).unwrap();
    {
        let seen = seen.lock().unwrap();
        assert_eq!(seen[1][6], 1.0);
        assert!((seen[1][7] - 36.0).abs() < 1e-12 && (seen[1][9] + 3.6).abs() < 1e-12);
    }
    assert_eq!(output.parameters_revision, 1, "an estimate has changed");
    let bias = endpoint.parameters().parameters.gyro_bias[0];
    assert!((bias / (0.5 / 3600.0f64).to_radians() - 1.0).abs() < 1e-12, "{bias}");
    endpoint.step(&epoch, &mut output).unwrap();
    assert_eq!((output.mode, output.parameters_revision), (Mode::Navigating, 1));
    let error = endpoint.restart(Some(&Parameters::default())).unwrap_err().to_string();
    assert!(error.contains("can't be set"), "{error}");
    endpoint.restart(None).unwrap();
}

#[test]
fn a_core_that_ends_or_crashes_is_gone() {
    let text = format!(
        "schema = 1\n[procedure.calibration]\n[endpoint]\nuri = \"fmu:core.fmu\"\n{FOREIGN}"
    );
    let scenario = Scenario::parse(&text, "core.toml", Path::new(""), &[]).unwrap();
    let (_, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let failing = |result: Result<bool, String>| {
        let instance = Scripted::boxed(foreign(), move |_, _| result.clone());
        let fmu = fmu_of(&scenario);
        let mut endpoint = FmuEndpoint::of_instance(&scenario, fmu, &core, kept(instance)).unwrap();
        let mut output = Output::default();
        endpoint.step(&Epoch::default(), &mut output).unwrap_err().to_string()
    };
    assert_eq!(failing(Ok(false)), "endpoint fmu:core.fmu is gone: it ended the simulation");
    assert_eq!(
        failing(Err("was ended by SIGSEGV in fmi3DoStep".to_owned())),
        "endpoint fmu:core.fmu is gone: at 0 s the process of core was ended by SIGSEGV in fmi3DoStep"
    );
    // The scenario names no mode with value 0.
    assert!(
        failing(Ok(true)).contains("mode is 0, expected a value that the scenario's modes name")
    );
}

#[test]
fn what_doesnt_fit_a_core_is_told_with_its_place() {
    for (map, expected) in [
        (
            "gyro.rate = \"f\"\n",
            "core.toml:6:13: endpoint.fmu.map.gyro.rate: f is in m/s2, an acceleration, and gyro.rate \
             is an angular rate, such as deg/s",
        ),
        ("gyro.rate = \"ww\"\n", "the FMU has no variable \"ww\"; nearest are \"w\""),
        ("gyro.rate = \"az\"\n", "Float64 az has 1 elements, expected 3"),
        ("gyro.rate = [\"w[1]\", \"w[2]\", \"w[2]\"]\n", "w is set by gyro.rate already"),
        (
            "gyro.rate = [\"w[1]\", \"w[2]\", { constant = \"0 deg/s\" }]\n",
            "expected a variable; inputs that are held are set in endpoint.fmu.parameters",
        ),
        (
            "gyro.rate = [\"w[1]\", \"w[2]\", \"az\"]\n",
            "az is an output of the FMU, expected an input",
        ),
        (
            "gyro.rate = \"w\"\ngyro.delta_theta = \"w\"\n",
            "found beside gyro.delta_theta, expected one of them",
        ),
        (
            "gyro.rate = \"w\"\n",
            "neither accelerometer.delta_velocity nor accelerometer.specific_force is mapped",
        ),
        (
            "gyro.rate = \"w\"\naccelerometer.specific_force = \"f\"\n",
            "found neither gimbal_command, navigation nor parameters",
        ),
        (
            "gyro.rate = \"w\"\naccelerometer.specific_force = \"f\"\nhealth = \"az\"\nmode = \"bias[1]\"\n\
             moving = \"az\"\ngimbal_command.roll = \"el\"\n",
            "az is a Float64, and moving is true or false",
        ),
    ] {
        let text = format!(
            "schema = 1\n[procedure.calibration]\n[endpoint]\nuri = \"fmu:core.fmu\"\n\
             [endpoint.fmu.map]\n{map}"
        );
        let scenario = Scenario::parse(&text, "core.toml", Path::new(""), &[]).unwrap();
        let (_, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
        let instance = Scripted::boxed(foreign(), |_, _| Ok(true));
        let fmu = fmu_of(&scenario);
        let error = FmuEndpoint::of_instance(&scenario, fmu, &core, kept(instance));
        let error = error.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains(expected), "{map}:\n  {error}\n  {expected}");
    }
}
