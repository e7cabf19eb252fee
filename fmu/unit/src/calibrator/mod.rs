//! The calibration core as a component: samples in, set points and navigation out.

mod config;
mod error;
pub mod table;

pub use config::{config, put, start_values};
pub use error::{CalibratorFailure, CalibratorValueError};

use crate::component::ModelComponent;
use crate::table::Model;
use crate::values::CellValues;
use octant_calibration::Core;
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Aiding, DeviceTime, GimbalAngles, Mode, Output, Reference, Sample, Status};
use octant_state::{StateError, StateFormat, check_count};
use table::slot;

/// Writes the state of the core into the Calibrator's outputs.
pub(crate) fn put_outputs(output: &Output, core: &Core, values: &mut CellValues) {
    put_stepped(output, values);
    put_parameters(core, values);
}

/// The core, and the conversion of the variables to its samples.
#[derive(Clone, Debug)]
pub struct Calibrator {
    core: Core,
    period_ns: u64,
    /// True if numbers and stamps come from outside.
    external_stamps: bool,
    /// Conversion of increments to counts, with the remainders carried.
    delta_theta: [Accumulator; 3],
    delta_velocity: [Accumulator; 3],
    /// Number of steps since the first sample, that one included.
    counted: u64,
    mode: Mode,
    mode_changed: bool,
    revision: u32,
    /// Kept between steps: a copy of an output that has just been written waits for the stores.
    output: Output,
}

/// Returns the nearest whole count. An increment that is a whole number of counts is used
/// unchanged, including the ends of the range: an instrument that saturates sends them with a flag
/// of its own.
#[inline]
fn count(accumulator: &mut Accumulator, counts: f64, saturated: &mut bool) -> i32 {
    let whole = counts as i32;
    if accumulator.remainder == 0.0 && f64::from(whole) == counts {
        return whole;
    }
    let counted = accumulator.count(counts);
    *saturated |= counted.saturated;
    counted.value
}

impl Calibrator {
    #[inline]
    fn sample(&mut self, values: &CellValues) -> Sample {
        let mut status = Status::from_bits_retain(values.integer(slot::IMU_STATUS) as u16);
        let [mut gyro_saturated, mut accelerometer_saturated] = [false; 2];
        let delta_theta = core::array::from_fn(|i| {
            let counts = values.real(slot::GYRO + i) / DELTA_THETA_LSB_RAD;
            count(&mut self.delta_theta[i], counts, &mut gyro_saturated)
        });
        let delta_velocity = core::array::from_fn(|i| {
            let counts = values.real(slot::ACCELEROMETER + i) / DELTA_VELOCITY_LSB_MPS;
            count(&mut self.delta_velocity[i], counts, &mut accelerometer_saturated)
        });
        status
            .set(Status::GYRO_SATURATED, gyro_saturated || status.contains(Status::GYRO_SATURATED));
        status.set(
            Status::ACCELEROMETER_SATURATED,
            accelerometer_saturated || status.contains(Status::ACCELEROMETER_SATURATED),
        );
        let (sequence, ns) = if self.external_stamps {
            (values.count(slot::IMU_SEQUENCE), values.count(slot::IMU_DEVICE_TIME))
        } else {
            (self.counted, self.counted.saturating_mul(self.period_ns))
        };
        Sample {
            sequence,
            device_time: DeviceTime::from_ns(ns),
            delta_theta,
            delta_velocity,
            gimbal: GimbalAngles::from_rad(
                values.real(slot::GIMBAL_AZIMUTH),
                values.real(slot::GIMBAL_ROLL),
            ),
            status,
        }
    }
}

/// Reads the reference for a sample of this stamp.
#[inline]
fn aiding(values: &CellValues, stamp: DeviceTime) -> Option<Aiding> {
    let reference = match values.integer(slot::REFERENCE_KIND) {
        1 => Reference::Velocity(values.reals(slot::REFERENCE_VELOCITY)),
        2 => Reference::Position {
            latitude_rad: values.real(slot::REFERENCE_LATITUDE),
            longitude_rad: values.real(slot::REFERENCE_LONGITUDE),
            height_m: values.real(slot::REFERENCE_HEIGHT),
        },
        _ => return None,
    };
    // Whole numbers up to 2⁵³, as the table says.
    let age_ns = values.real(slot::REFERENCE_AGE).round() as i64;
    let ns = if age_ns < 0 {
        stamp.ns.saturating_add(age_ns.unsigned_abs())
    } else {
        stamp.ns.saturating_sub(age_ns.unsigned_abs())
    };
    Some(Aiding { device_time: DeviceTime::from_ns(ns), reference })
}

impl ModelComponent for Calibrator {
    const MODEL: &'static Model = &table::MODEL;

    type Error = CalibratorFailure;

    fn initialize(values: &mut CellValues) -> Result<Self, CalibratorFailure> {
        let config = config(values)?;
        let core = Core::new(&config)?;
        let output = core.latest();
        let this = Self {
            period_ns: config.sample_period_ns,
            external_stamps: values.boolean(slot::EXTERNAL_STAMPS),
            delta_theta: Default::default(),
            delta_velocity: Default::default(),
            counted: 0,
            mode: output.mode,
            mode_changed: false,
            revision: output.parameters_revision,
            output,
            core,
        };
        put_stepped(&this.output, values);
        put_parameters(&this.core, values);
        Ok(this)
    }

    fn period_ns(&self) -> u64 {
        self.period_ns
    }

    fn tune(&mut self, values: &CellValues) -> Result<(), CalibratorFailure> {
        self.core.tune(&config(values)?)?;
        Ok(())
    }

    #[inline]
    fn step(&mut self, values: &mut CellValues) -> Result<(), CalibratorFailure> {
        let valid = values.boolean(slot::IMU_VALID);
        if valid || self.counted > 0 {
            self.counted += 1;
        }
        if !valid {
            return Ok(());
        }
        let sample = self.sample(values);
        let aiding = aiding(values, sample.device_time);
        self.core.step_into(&sample, aiding.as_ref(), &mut self.output);
        put_stepped(&self.output, values);
        // A rejected measurement may restore earlier parameters without a new revision.
        if self.output.parameters_revision != self.revision || !self.output.nis.is_nan() {
            self.revision = self.output.parameters_revision;
            put_parameters(&self.core, values);
        }
        if self.output.mode != self.mode {
            (self.mode, self.mode_changed) = (self.output.mode, true);
        }
        Ok(())
    }

    fn terminate(&mut self, values: &mut CellValues) {
        self.output = self.core.end_of_stream();
        if self.output.mode != self.mode {
            (self.mode, self.mode_changed) = (self.output.mode, true);
        }
        put_stepped(&self.output, values);
        put_parameters(&self.core, values);
    }

    #[inline]
    fn remark(&mut self) -> Option<String> {
        if !core::mem::take(&mut self.mode_changed) {
            return None;
        }
        let sequence = self.output.sequence;
        Some(match self.core.refusal() {
            Some(refusal) if self.mode == Mode::Refused => {
                format!("refused at sample {sequence}: {refusal}")
            }
            _ => format!("{} from sample {sequence} on", self.mode.name()),
        })
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        let mut core = Vec::new();
        self.core.save(&mut core);
        FORMAT.write(bytes, |to| {
            to.value("remainders of delta_theta", &self.delta_theta.map(|axis| axis.remainder));
            let remainders = self.delta_velocity.map(|axis| axis.remainder);
            to.value("remainders of delta_velocity", &remainders);
            to.value("counted", &self.counted);
            to.value("core", &core);
        });
    }

    fn load(bytes: &[u8], values: &CellValues) -> Result<Self, CalibratorFailure> {
        Ok(Self::read(bytes, values)?)
    }
}

/// Format of the bytes of a Calibrator.
const FORMAT: StateFormat =
    StateFormat { magic: "OCTCALIB", version: 1, what: "the state of a Calibrator" };

impl Calibrator {
    fn read(bytes: &[u8], values: &CellValues) -> Result<Self, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let carried = |remainders: [f64; 3]| remainders.map(|remainder| Accumulator { remainder });
        let delta_theta = carried(from.value("remainders of delta_theta")?);
        let delta_velocity = carried(from.value("remainders of delta_velocity")?);
        let counted = from.value("counted")?;
        check_count("counted", counted)?;
        let core: Vec<u8> = from.value("core")?;
        from.end()?;
        let core = Core::load(&core)?;
        let output = core.latest();
        Ok(Self {
            period_ns: values.count(slot::PERIOD),
            external_stamps: values.boolean(slot::EXTERNAL_STAMPS),
            delta_theta,
            delta_velocity,
            counted,
            mode: output.mode,
            mode_changed: false,
            revision: output.parameters_revision,
            output,
            core,
        })
    }
}

/// Writes the outputs that change with every sample.
#[inline]
fn put_stepped(output: &Output, values: &mut CellValues) {
    let target = output.gimbal_command.target;
    values.set_real(slot::COMMAND_AZIMUTH, target.azimuth_rad());
    values.set_real(slot::COMMAND_ROLL, target.roll_rad());
    values.set_integer(slot::MODE, output.mode as i32);
    values.set_integer(slot::STOP, i32::from(output.stop));
    values.set_boolean(slot::MOVING, output.moving);
    let navigation = &output.navigation;
    values.set_real(slot::LATITUDE, navigation.latitude_rad);
    values.set_real(slot::LONGITUDE, navigation.longitude_rad);
    values.set_real(slot::HEIGHT, navigation.height_m);
    values.set_reals(slot::VELOCITY, &navigation.velocity_mps);
    values.set_reals(slot::ATTITUDE, &navigation.q_nb);
    let measured = !output.nis.is_nan();
    values.set_real(slot::NIS, if measured { output.nis } else { 0.0 });
    values.set_boolean(slot::MEASURED, measured);
    values.set_integer(slot::HEALTH, output.health.bits() as i32);
    values.set_count(slot::ANSWER_SEQUENCE, output.sequence);
    values.set_count(slot::ANSWER_DEVICE_TIME, output.device_time.ns);
    values.set_count(slot::REVISION, output.parameters_revision.into());
}

/// Writes the estimated parameters and their standard deviations.
fn put_parameters(core: &Core, values: &mut CellValues) {
    values.set_reals(slot::PARAMETERS, &core.parameters().to_array());
    values.set_reals(slot::SIGMA, core.sigma());
}
