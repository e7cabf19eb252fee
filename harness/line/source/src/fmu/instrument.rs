//! An FMU that is an instrument: it outputs rates, specific force or increments, and accepts the
//! gimbal command if it can.
//!
//! A command that the core computes from sample k is set two steps later: it acts from the end of
//! interval k + 1 on, as with two FMUs stepped in parallel.

use crate::triads::Triads;
use crate::{Epoch, Source, SourceError};
use octant_fmu_bind::bind::{BindError, Binder, Bound, Cells, ChannelCell, Handle};
use octant_fmu_bind::find::ValueWay;
use octant_fmu_bind::stepper::Stepper;
use octant_fmu_host::description::Description;
use octant_plant::Truth;
use octant_recorder::event::BenchRecord;
use octant_sample::time::SimulatedTime;
use octant_sample::{Aiding, DeviceTime, GimbalAngles, GimbalCommand, Reference, Sample, Status};
use octant_scenario::Fmu;
use octant_scenario::channel::{Channel, sample, truth};

/// Timing that a run requires of an instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Timing {
    /// Sample period, ns.
    pub(super) period_ns: u64,
    /// Number of samples in the run.
    pub(super) samples: u64,
    /// Number of samples in the calibration: references are given only with these.
    pub(super) calibration_samples: u64,
    /// Number of samples between references, where the FMU doesn't signal them.
    pub(super) reference_samples: u64,
    /// True for a position reference, where the FMU outputs both kinds and doesn't say which one is
    /// valid.
    pub(super) position: bool,
}

/// Sensors of one kind.
#[derive(Clone, Copy, Debug)]
enum Triad {
    /// Rate or specific force.
    Rates(Cells<3>),
    /// Integral of rate or specific force over the communication step.
    Increments(Cells<3>),
}

/// Cells of a position.
#[derive(Clone, Copy, Debug)]
struct Position {
    latitude: ChannelCell,
    longitude: ChannelCell,
    height: ChannelCell,
}

/// Cells of the reference that the FMU outputs.
#[derive(Clone, Copy, Debug)]
struct References {
    kind: Option<ChannelCell>,
    valid: Option<ChannelCell>,
    velocity: Option<Cells<3>>,
    position: Option<Position>,
    age_ns: Option<ChannelCell>,
}

/// Cells of truth that the FMU outputs.
#[derive(Clone, Copy, Debug)]
struct Truths {
    position: Position,
    velocity: Option<Cells<3>>,
    attitude: Option<Cells<4>>,
    gimbal: Option<[ChannelCell; 2]>,
}

/// Cells of all outputs of the FMU.
#[derive(Clone, Copy, Debug)]
struct Gives {
    gyro: Triad,
    accelerometer: Triad,
    gimbal: Option<[ChannelCell; 2]>,
    valid: Option<ChannelCell>,
    status: Option<ChannelCell>,
    sequence: Option<ChannelCell>,
    device_time: Option<ChannelCell>,
    reference: References,
    truth: Option<Truths>,
}

/// The channels of an instrument, bound to the variables of an FMU.
pub(super) struct Instrument {
    inputs: Bound,
    outputs: Bound,
    command: Option<[ChannelCell; 2]>,
    gives: Gives,
}

impl Instrument {
    /// Binds an FMU through the mapping of a scenario.
    ///
    /// # Errors
    /// If a required channel is missing or doesn't fit.
    pub(super) fn bind(description: &Description, fmu: &Fmu) -> Result<Self, BindError> {
        let mut inputs = Binder::new(description, fmu, ValueWay::In);
        let azimuth = inputs.channel(&sample::COMMAND_AZIMUTH);
        let roll = inputs.channel(&sample::COMMAND_ROLL);
        if azimuth.is_some() != roll.is_some() {
            let missing =
                if roll.is_none() { &sample::COMMAND_ROLL } else { &sample::COMMAND_AZIMUTH };
            inputs.needed(missing);
        }
        let inputs = inputs.finish()?;
        let command = inputs.cell(azimuth).zip(inputs.cell(roll)).map(|(a, r)| [a, r]);

        let mut outputs = Binder::new(description, fmu, ValueWay::Out);
        let gyro = outputs.one_of(&sample::DELTA_THETA, &sample::RATE);
        let accelerometer = outputs.one_of(&sample::DELTA_VELOCITY, &sample::SPECIFIC_FORCE);
        let gimbal = pair(&mut outputs, &sample::AZIMUTH, &sample::ROLL);
        let valid = outputs.channel(&sample::VALID);
        let status = outputs.channel(&sample::STATUS);
        let sequence = outputs.channel(&sample::SEQUENCE);
        let device_time = outputs.channel(&sample::DEVICE_TIME);
        let kind = outputs.channel(&sample::REFERENCE_KIND);
        let reference_valid = outputs.channel(&sample::REFERENCE_VALID);
        let velocity = outputs.channel(&sample::REFERENCE_VELOCITY);
        let position = three(
            &mut outputs,
            [&sample::REFERENCE_LATITUDE, &sample::REFERENCE_LONGITUDE, &sample::REFERENCE_HEIGHT],
        );
        let age = outputs.channel(&sample::REFERENCE_AGE);
        let true_position =
            three(&mut outputs, [&truth::LATITUDE, &truth::LONGITUDE, &truth::HEIGHT]);
        let true_velocity = outputs.channel(&truth::VELOCITY);
        let true_attitude = outputs.channel(&truth::ATTITUDE);
        let true_gimbal = pair(&mut outputs, &truth::AZIMUTH, &truth::ROLL);
        let outputs = outputs.finish()?;

        let cells = |(increments, handle): (bool, Handle)| {
            let cells = outputs.cells::<3>(Some(handle))?;
            Some(if increments { Triad::Increments(cells) } else { Triad::Rates(cells) })
        };
        let place = |handles: Option<[Handle; 3]>| {
            let [latitude, longitude, height] = handles?.map(|handle| outputs.cell(Some(handle)));
            Some(Position { latitude: latitude?, longitude: longitude?, height: height? })
        };
        let both = |handles: Option<[Handle; 2]>| {
            let [a, b] = handles?.map(|handle| outputs.cell(Some(handle)));
            Some([a?, b?])
        };
        let (Some(gyro), Some(accelerometer)) =
            (gyro.and_then(cells), accelerometer.and_then(cells))
        else {
            // Missing channels were already reported as problems.
            return Err(BindError::Mapping(Vec::new()));
        };
        let gives = Gives {
            gyro,
            accelerometer,
            gimbal: both(gimbal),
            valid: outputs.cell(valid),
            status: outputs.cell(status),
            sequence: outputs.cell(sequence),
            device_time: outputs.cell(device_time),
            reference: References {
                kind: outputs.cell(kind),
                valid: outputs.cell(reference_valid),
                velocity: outputs.cells(velocity),
                position: place(position),
                age_ns: outputs.cell(age),
            },
            truth: place(true_position).map(|position| Truths {
                position,
                velocity: outputs.cells(true_velocity),
                attitude: outputs.cells(true_attitude),
                gimbal: both(true_gimbal),
            }),
        };
        Ok(Self { inputs, outputs, command, gives })
    }
}

/// Binds two channels that are mapped together or not at all.
fn pair(binder: &mut Binder<'_>, a: &'static Channel, b: &'static Channel) -> Option<[Handle; 2]> {
    match (binder.channel(a), binder.channel(b)) {
        (Some(a), Some(b)) => Some([a, b]),
        (None, None) => None,
        (found, _) => {
            binder.needed(if found.is_none() { a } else { b });
            None
        }
    }
}

/// Binds three channels that are mapped together or not at all.
fn three(binder: &mut Binder<'_>, channels: [&'static Channel; 3]) -> Option<[Handle; 3]> {
    let found = channels.map(|channel| binder.channel(channel));
    if let [Some(a), Some(b), Some(c)] = found {
        return Some([a, b, c]);
    }
    if found.iter().any(Option::is_some) {
        for (channel, found) in channels.into_iter().zip(found) {
            if found.is_none() {
                binder.needed(channel);
            }
        }
    }
    None
}

/// A running instrument.
pub(crate) struct FmuSource {
    stepper: Stepper,
    instrument: Instrument,
    timing: Timing,
    /// Communication steps per sample.
    steps: u64,
    step_s: f64,
    /// Command that is set with the next step.
    command: GimbalCommand,
    /// Sample periods that have passed.
    passed: u64,
    /// Samples that were delivered.
    delivered: u64,
    triads: Triads,
    truth: Option<Truth>,
    true_parameters: bool,
}

impl FmuSource {
    /// Creates a source at time 0. `true_parameters`: its instrument has the scenario's errors.
    #[must_use]
    pub(super) fn new(
        stepper: Stepper,
        instrument: Instrument,
        timing: Timing,
        step_ns: u64,
        true_parameters: bool,
    ) -> Self {
        Self {
            stepper,
            instrument,
            timing,
            steps: timing.period_ns / step_ns,
            step_s: step_ns as f64 * 1e-9,
            command: GimbalCommand::default(),
            passed: 0,
            delivered: 0,
            triads: Triads::default(),
            truth: None,
            true_parameters,
        }
    }

    /// Steps over one sample period. Returns the increments in it, rad and m/s; `None` if the FMU
    /// has ended.
    fn period(&mut self) -> Result<Option<[[f64; 3]; 2]>, SourceError> {
        let Self { instrument: Instrument { inputs, outputs, command, gives }, .. } = self;
        if let Some([azimuth, roll]) = command {
            let target = self.command.target;
            azimuth.write(&mut inputs.numbers, target.azimuth_rad());
            roll.write(&mut inputs.numbers, target.roll_rad());
        }
        let mut sums: Option<[[f64; 3]; 2]> = None;
        for _ in 0..self.steps {
            match self.stepper.exchange(inputs, outputs) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(error) => {
                    let uri = self.stepper.uri().to_owned();
                    return Err(SourceError::Gone { uri, reason: error.to_string() });
                }
            }
            let read = |triad: &Triad| match triad {
                Triad::Rates(cells) => cells.read(&outputs.numbers).map(|rate| rate * self.step_s),
                Triad::Increments(cells) => cells.read(&outputs.numbers),
            };
            let these = [read(&gives.gyro), read(&gives.accelerometer)];
            sums = Some(match sums {
                None => these,
                Some(mut sums) => {
                    for (sum, this) in sums.iter_mut().flatten().zip(these.iter().flatten()) {
                        *sum += this;
                    }
                    sums
                }
            });
        }
        Ok(sums)
    }

    /// Returns the reference that belongs to a sample.
    fn reference(&self, sample: &Sample) -> Option<Aiding> {
        let numbers = &self.instrument.outputs.numbers;
        let of = &self.instrument.gives.reference;
        if self.passed > self.timing.calibration_samples {
            return None;
        }
        let read = |cell: &Option<ChannelCell>| cell.as_ref().map(|cell| cell.read(numbers));
        let position = match read(&of.kind) {
            Some(1.0) => false,
            Some(2.0) => true,
            Some(_) => return None,
            None => {
                let due = match read(&of.valid) {
                    Some(valid) => valid != 0.0,
                    None => self.passed.is_multiple_of(self.timing.reference_samples),
                };
                if !due {
                    return None;
                }
                of.velocity.is_none() || (of.position.is_some() && self.timing.position)
            }
        };
        let reference = if position {
            let Position { latitude, longitude, height } = of.position?;
            Reference::Position {
                latitude_rad: latitude.read(numbers),
                longitude_rad: longitude.read(numbers),
                height_m: height.read(numbers),
            }
        } else {
            Reference::Velocity(of.velocity?.read(numbers))
        };
        let age_ns = read(&of.age_ns).unwrap_or(0.0);
        // The age is a whole number within ±2⁵³ ns; a stamp before the start of time is clamped to
        // it.
        let stamp_ns = i128::from(sample.device_time.ns) - age_ns as i128;
        let device_time = DeviceTime::from_ns(u64::try_from(stamp_ns.max(0)).unwrap_or(u64::MAX));
        Some(Aiding { device_time, reference })
    }

    fn true_state(&self) -> Option<Truth> {
        let numbers = &self.instrument.outputs.numbers;
        let of = self.instrument.gives.truth.as_ref()?;
        Some(Truth {
            time: SimulatedTime::from_ns(self.passed * self.timing.period_ns),
            latitude_rad: of.position.latitude.read(numbers),
            longitude_rad: of.position.longitude.read(numbers),
            height_m: of.position.height.read(numbers),
            velocity_mps: of.velocity.map_or([f64::NAN; 3], |cells| cells.read(numbers)),
            q_nb: of.attitude.map_or([f64::NAN; 4], |cells| cells.read(numbers)),
            gimbal_rad: of
                .gimbal
                .or(self.instrument.gives.gimbal)
                .map_or([0.0; 2], |cells| cells.map(|cell| cell.read(numbers))),
        })
    }
}

impl Source for FmuSource {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        loop {
            if self.passed >= self.timing.samples {
                return Ok(false);
            }
            let Some([theta, velocity]) = self.period()? else { return Ok(false) };
            self.passed += 1;
            self.command = *command;
            let numbers = &self.instrument.outputs.numbers;
            let gives = &self.instrument.gives;
            if gives.valid.is_some_and(|valid| valid.read(numbers) == 0.0) {
                continue;
            }
            self.delivered += 1;
            let sample = &mut epoch.sample;
            let mut status = gives.status.map_or(Status::empty(), |status| {
                Status::from_bits_retain(status.read(numbers) as u16)
            });
            status |= self.triads.count(
                &theta,
                &velocity,
                &mut sample.delta_theta,
                &mut sample.delta_velocity,
            );
            match gives.gimbal {
                Some([azimuth, roll]) => {
                    sample.gimbal =
                        GimbalAngles::from_rad(azimuth.read(numbers), roll.read(numbers));
                }
                None => {
                    sample.gimbal = GimbalAngles::default();
                    status |= Status::GIMBAL_INVALID;
                }
            }
            sample.status = status;
            let whole = |cell: Option<ChannelCell>| cell.map(|cell| cell.read(numbers) as u64);
            sample.sequence = whole(gives.sequence).unwrap_or(self.delivered);
            sample.device_time = DeviceTime::from_ns(
                whole(gives.device_time).unwrap_or(self.passed * self.timing.period_ns),
            );
            let sample = *sample;
            epoch.aiding = self.reference(&sample);
            self.truth = self.true_state();
            return Ok(true);
        }
    }

    fn truth(&self) -> Option<Truth> {
        self.truth
    }

    fn samples_total(&self) -> Option<u64> {
        Some(self.timing.samples)
    }

    fn has_true_parameters(&self) -> bool {
        self.true_parameters
    }

    fn conclude(&mut self, _: Option<&str>) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        (None, super::ending::freed(&mut self.stepper))
    }
}
