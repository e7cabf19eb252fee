//! A core in an FMU: our Calibrator, or a foreign one.
//!
//! Sample k is set, one communication step is done, and answer k is read. Inputs and outputs are a
//! list of numbers that is bound once; nothing is looked up during a run.

mod ports;

use super::answer::Misbehaviour;
use super::{Conclusion, Endpoint, EndpointError, Tells};
use octant_calibration::CoreConfig;
use octant_fmu_bind::OpenedFmus;
use octant_fmu_bind::bind::ChannelCell;
use octant_fmu_bind::open::{self, NamedInstance};
use octant_fmu_bind::stepper::{Stepper, UseError};
use octant_sample::Epoch;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{
    DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference,
};
use octant_scenario::{Fmu, Scenario};
use ports::{Ports, Triad};

/// An FMU as the core.
pub struct FmuEndpoint {
    stepper: Stepper,
    ports: Ports,
    /// Configuration of our Calibrator; `None` for a foreign core.
    own: Option<Box<Own>>,
    period_s: f64,
    /// Number of samples of the calibration and of the whole run, for an FMU without a mode
    /// variable.
    procedure: [u64; 2],
    taken: u64,
    estimate: ParameterEstimate,
}

/// Data needed to restart our Calibrator.
struct Own {
    config: CoreConfig,
    scenario: Scenario,
    fmu: Fmu,
}

const NOTHING: ParameterEstimate = ParameterEstimate {
    revision: 0,
    parameters: Parameters {
        gyro_bias: [0.0; 3],
        gyro_scale: [0.0; 3],
        gyro_misalignment: [0.0; 6],
        g_dependent: [0.0; 9],
        accel_bias: [0.0; 3],
        accel_scale: [0.0; 3],
        accel_misalignment: [0.0; 3],
    },
    sigma: [f64::NAN; PARAMETER_COUNT],
};

impl FmuEndpoint {
    /// Opens the FMU of a scenario's endpoint. Our Calibrator is configured by `config`.
    ///
    /// # Errors
    /// If the FMU can't be used, or the scenario's settings for it don't fit.
    pub fn open(
        scenario: &Scenario,
        fmu: &Fmu,
        config: &CoreConfig,
        fmus: &OpenedFmus,
    ) -> Result<Self, UseError> {
        Self::of_instance(scenario, fmu, config, open::instance(scenario, fmu, fmus)?)
    }

    /// Takes an instance of an FMU in place of the scenario's. Our Calibrator is configured by `config`.
    ///
    /// # Errors
    /// If the scenario's settings don't fit the FMU.
    pub fn of_instance(
        scenario: &Scenario,
        fmu: &Fmu,
        config: &CoreConfig,
        NamedInstance { instance, uri }: NamedInstance,
    ) -> Result<Self, UseError> {
        let description = instance.description();
        let own = open::own_calibrator(description, config);
        let problem =
            |message: String| UseError::problems(&scenario.file, vec![fmu.at.problem(message)]);
        if own.is_none() {
            if scenario.baseline.is_some() {
                return Err(problem(
                    "found a core other than Octant's Calibrator, and a [baseline] in the scenario: \
                     only the Calibrator takes a second method"
                        .to_owned(),
                ));
            }
            if let Some(fault) = scenario.faults.iter().find(|f| f.spec.kind.name == "stale-table")
            {
                return Err(problem(format!(
                    "found a core other than Octant's Calibrator, and fault {:?}, which needs stored \
                     parameters: only the Calibrator takes them",
                    fault.spec.id
                )));
            }
        }
        let starts = open::starts(scenario, fmu, &uri, description, own.as_deref())?;
        let ports = Ports::bind(description, fmu)
            .map_err(|error| UseError::binding(&scenario.file, &uri, error))?;
        let stepper = Stepper::start(instance, &uri, starts, fmu.tolerance, fmu.step_ns)?;
        let own = own.map(|_| {
            Box::new(Own { config: config.clone(), scenario: scenario.clone(), fmu: fmu.clone() })
        });
        Ok(Self {
            stepper,
            ports,
            own,
            period_s: scenario.sample_period_ns as f64 * 1e-9,
            procedure: [scenario.calibration_samples(), scenario.samples().unwrap_or(u64::MAX)],
            taken: 0,
            estimate: NOTHING,
        })
    }

    fn gone(&self, reason: String) -> EndpointError {
        EndpointError::Gone { uri: self.stepper.uri().to_owned(), reason }
    }

    /// Writes an epoch into the input numbers.
    fn put(&mut self, epoch: &Epoch) {
        let (takes, numbers) = (&self.ports.takes, &mut self.ports.inputs.numbers);
        let sample = &epoch.sample;
        let period_s = self.period_s;
        let mut triad = |triad: &Triad, counts: &[i32; 3], lsb: f64| {
            let increments = counts.map(|count| f64::from(count) * lsb);
            match triad {
                Triad::Increments(cells) => cells.write(numbers, &increments),
                Triad::Rates(cells) => cells.write(numbers, &increments.map(|x| x / period_s)),
            }
        };
        triad(&takes.gyro, &sample.delta_theta, DELTA_THETA_LSB_RAD);
        triad(&takes.accelerometer, &sample.delta_velocity, DELTA_VELOCITY_LSB_MPS);
        let mut put = |cell: &Option<ChannelCell>, value: f64| {
            if let Some(cell) = cell {
                cell.write(numbers, value);
            }
        };
        put(&takes.gimbal[0], sample.gimbal.azimuth_rad());
        put(&takes.gimbal[1], sample.gimbal.roll_rad());
        put(&takes.valid, 1.0);
        put(&takes.status, f64::from(sample.status.bits()));
        put(&takes.sequence, sample.sequence as f64);
        put(&takes.device_time, sample.device_time.ns as f64);
        let reference = &takes.reference;
        let Some(aiding) = &epoch.aiding else {
            put(&reference.kind, 0.0);
            put(&reference.valid, 0.0);
            return;
        };
        put(&reference.valid, 1.0);
        let age_ns = i128::from(sample.device_time.ns) - i128::from(aiding.device_time.ns);
        put(&reference.age_ns, age_ns as f64);
        match aiding.reference {
            Reference::Velocity(velocity) => {
                put(&reference.kind, 1.0);
                if let Some(cells) = &reference.velocity {
                    cells.write(numbers, &velocity);
                }
            }
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                put(&reference.kind, 2.0);
                put(&reference.position[0], latitude_rad);
                put(&reference.position[1], longitude_rad);
                put(&reference.position[2], height_m);
            }
        }
    }

    /// Reads the answer from the output numbers.
    fn take(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        let numbers = &self.ports.outputs.numbers;
        let answers = &self.ports.answers;
        let read = |cell: &Option<ChannelCell>| cell.as_ref().map(|cell| cell.read(numbers));
        let or_zero = |cell: &Option<ChannelCell>| read(cell).unwrap_or(0.0);
        let wrong = |field: &str, found: f64, expected: &str| {
            EndpointError::Misbehaved(Misbehaviour {
                sample: epoch.sample.sequence,
                field: field.to_owned(),
                found: found.to_string(),
                expected: expected.to_owned(),
            })
        };
        let whole = |field: &str, cell: &Option<ChannelCell>| match read(cell) {
            // Doubles represent every whole number up to here.
            Some(value)
                if !(0.0..=9_007_199_254_740_992.0).contains(&value) || value.fract() != 0.0 =>
            {
                Err(wrong(field, value, "a whole number of 0 or more"))
            }
            value => Ok(value.map(|value| value as u64)),
        };
        let nis = match (read(&answers.measured), read(&answers.nis)) {
            (Some(0.0), _) | (_, None) => f64::NAN,
            (Some(_), Some(nis)) if nis.is_nan() => {
                return Err(wrong(
                    "nis",
                    nis,
                    "a number of 0 or more where something was measured",
                ));
            }
            (_, Some(nis)) => nis,
        };
        let mode = match read(&answers.mode) {
            Some(code) => {
                let known = self.ports.modes.iter().find(|(value, _)| *value as f64 == code);
                known
                    .map(|(_, mode)| *mode)
                    .ok_or_else(|| wrong("mode", code, "a value that the scenario's modes name"))?
            }
            None if self.taken >= self.procedure[1] => Mode::Done,
            None if self.taken >= self.procedure[0] => Mode::Navigating,
            None => Mode::Calibrating,
        };
        *output = Output {
            sequence: whole("sequence", &answers.sequence)?.unwrap_or(epoch.sample.sequence),
            device_time: whole("device_time", &answers.device_time)?
                .map_or(epoch.sample.device_time, DeviceTime::from_ns),
            mode,
            stop: whole("stop", &answers.stop)?.map_or(0, |stop| stop.min(u16::MAX.into()) as u16),
            moving: or_zero(&answers.moving) != 0.0,
            gimbal_command: GimbalCommand {
                target: GimbalAngles::from_rad(
                    or_zero(&answers.command[0]),
                    or_zero(&answers.command[1]),
                ),
            },
            navigation: Navigation {
                latitude_rad: or_zero(&answers.position[0]),
                longitude_rad: or_zero(&answers.position[1]),
                height_m: or_zero(&answers.position[2]),
                velocity_mps: answers.velocity.map_or([0.0; 3], |cells| cells.read(numbers)),
                q_nb: answers.attitude.map_or([1.0, 0.0, 0.0, 0.0], |cells| cells.read(numbers)),
            },
            health: Health::from_bits_retain(whole("health", &answers.health)?.unwrap_or(0) as u32),
            nis,
            parameters_revision: self.estimate.revision,
        };
        match whole("parameters_revision", &answers.revision)? {
            Some(revision) => {
                let revision = revision as u32;
                if revision != self.estimate.revision {
                    self.refresh(revision)?;
                }
            }
            None if self.ports.has_estimates() => {
                let before = self.estimate;
                self.refresh(before.revision)?;
                if !same(&before, &self.estimate) {
                    self.estimate.revision += 1;
                }
            }
            None => {}
        }
        output.parameters_revision = self.estimate.revision;
        Ok(())
    }

    /// Reads the estimates from the FMU.
    #[cold]
    fn refresh(&mut self, revision: u32) -> Result<(), EndpointError> {
        self.stepper
            .get(&mut self.ports.estimated)
            .map_err(|error| self.gone(error.to_string()))?;
        let numbers = &self.ports.estimated.numbers;
        let read = |cell: &Option<ChannelCell>, without: f64| {
            cell.as_ref().map_or(without, |cell| cell.read(numbers))
        };
        let estimates = &self.ports.estimates;
        self.estimate = ParameterEstimate {
            revision,
            parameters: Parameters::from_array(&std::array::from_fn(|i| {
                read(&estimates.parameters[i], 0.0)
            })),
            sigma: std::array::from_fn(|i| read(&estimates.sigma[i], f64::NAN)),
        };
        Ok(())
    }
}

/// Compares all bits, NaN included.
fn same(a: &ParameterEstimate, b: &ParameterEstimate) -> bool {
    let bits = |values: &[f64; PARAMETER_COUNT]| values.map(f64::to_bits);
    bits(&a.parameters.to_array()) == bits(&b.parameters.to_array())
        && bits(&a.sigma) == bits(&b.sigma)
}

impl Endpoint for FmuEndpoint {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.put(epoch);
        match self.stepper.exchange(&self.ports.inputs, &mut self.ports.outputs) {
            Ok(true) => {}
            Ok(false) => return Err(self.gone("it ended the simulation".to_owned())),
            Err(error) => return Err(self.gone(error.to_string())),
        }
        self.taken += 1;
        self.take(epoch, output)
    }

    fn tells(&self) -> Tells {
        let answers = &self.ports.answers;
        Tells {
            commands: answers.command.iter().any(Option::is_some),
            position: answers.position[..2].iter().any(Option::is_some),
            velocity: answers.velocity.is_some(),
            attitude: answers.attitude.is_some(),
            tilt: true,
            follows: true,
        }
    }

    fn uri(&self) -> String {
        self.stepper.uri().to_owned()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        let uri = self.stepper.uri().to_owned();
        let fail = |reason: String| EndpointError::Restart { uri: uri.clone(), reason };
        let starts = match (&self.own, offset) {
            (Some(own), offset) => {
                let mut config = own.config.clone();
                if let Some(offset) = offset {
                    config.initial_parameters = super::sum(&config.initial_parameters, offset);
                }
                let description = self.stepper.instance().description();
                let values = open::own_calibrator(description, &config);
                open::starts(&own.scenario, &own.fmu, &uri, description, values.as_deref())
                    .map_err(|error| fail(error.to_string()))?
            }
            (None, None) => self.stepper.starts().clone(),
            (None, Some(_)) => {
                return Err(fail(
                    "its stored parameters can't be set: only Octant's Calibrator takes them"
                        .to_owned(),
                ));
            }
        };
        self.stepper.restart(starts).map_err(|error| fail(error.to_string()))?;
        self.taken = 0;
        self.estimate = NOTHING;
        // The initial parameters, which a core that was running announces as new.
        if self.own.is_some() { self.refresh(0) } else { Ok(()) }
    }

    fn parameters(&self) -> ParameterEstimate {
        self.estimate
    }

    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        if self.own.is_none() {
            return Ok(None);
        }
        let epoch = Epoch::default();
        let mut output = Output::default();
        self.stepper.end(&mut self.ports.outputs).map_err(|error| self.gone(error.to_string()))?;
        self.take(&epoch, &mut output)?;
        Ok(Some(output))
    }

    fn conclusion(&mut self) -> Conclusion {
        // Parameters may have been withdrawn since their last revision.
        if self.own.is_some() {
            // A failure here was already reported by an earlier call.
            let _ = self.refresh(self.estimate.revision);
        }
        let said = self.stepper.instance().messages();
        let refused = said.iter().rev().find_map(|message| {
            let text = message.text.trim().strip_prefix("refused at sample ")?;
            text.split_once(": ").map(|(_, reason)| reason.to_owned())
        });
        Conclusion { refused, ..Conclusion::default() }
    }

    fn close(&mut self) -> Result<(), EndpointError> {
        self.stepper.finish().map_err(|error| self.gone(error.to_string()))
    }
}
