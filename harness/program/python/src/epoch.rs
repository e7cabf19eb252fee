//! Samples, answers and truth as Python objects.

use crate::failure::argument;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{
    Aiding, DeviceTime, Epoch, GimbalAngles, Health, Mode, Output, Parameters, Reference, Sample,
    Status, Truth,
};
use pyo3::prelude::*;

/// Kind of a reference, and its three numbers.
type Given = (String, [f64; 3]);

/// One sample with its reference, if one is due.
///
/// Counts are whole numbers: ``delta_theta`` in 2**-36 rad and ``delta_velocity`` in 2**-30 m/s over
/// the interval that ends at ``time_ns``, body axes; ``gimbal`` (azimuth, roll) in 2**-27 rad.
///
/// Parameters
/// ----------
/// sequence : int
///     Number of the sample, from 1.
/// time_ns : int
///     Device time at the end of the interval, ns.
/// delta_theta, delta_velocity : (int, int, int)
///     Counts.
/// gimbal : (int, int)
///     Counts of the encoders, azimuth and roll.
/// status : int
///     Bit 0 gyro saturated, 1 accelerometer saturated, 2 gimbal invalid, 3 inertial invalid.
/// aiding : (str, (float, float, float)) or None
///     ``("velocity", (north, east, down))`` in m/s, or ``("position", (latitude, longitude, height))``
///     in rad, rad, m.
#[pyclass(module = "octant", name = "Epoch", from_py_object)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct PyEpoch {
    pub(crate) epoch: Epoch,
}

#[pymethods]
impl PyEpoch {
    #[new]
    #[pyo3(signature = (sequence, time_ns, delta_theta, delta_velocity, gimbal=[0, 0], status=0, aiding=None))]
    fn new(
        sequence: u64,
        time_ns: u64,
        delta_theta: [i32; 3],
        delta_velocity: [i32; 3],
        gimbal: [i32; 2],
        status: u16,
        aiding: Option<Given>,
    ) -> PyResult<Self> {
        let sample = Sample {
            sequence,
            device_time: DeviceTime { ns: time_ns },
            delta_theta,
            delta_velocity,
            gimbal: GimbalAngles { azimuth: gimbal[0], roll: gimbal[1] },
            status: Status::from_bits_retain(status),
        };
        let mut epoch = Self { epoch: Epoch { sample, aiding: None } };
        epoch.set_aiding(aiding)?;
        Ok(epoch)
    }

    /// Number of the sample, from 1; a jump is a loss.
    #[getter]
    fn sequence(&self) -> u64 {
        self.epoch.sample.sequence
    }

    #[setter]
    fn set_sequence(&mut self, sequence: u64) {
        self.epoch.sample.sequence = sequence;
    }

    /// Device time at the end of the interval, ns.
    #[getter]
    fn time_ns(&self) -> u64 {
        self.epoch.sample.device_time.ns
    }

    #[setter]
    fn set_time_ns(&mut self, ns: u64) {
        self.epoch.sample.device_time.ns = ns;
    }

    /// Device time at the end of the interval, s.
    #[getter]
    fn time_s(&self) -> f64 {
        self.epoch.sample.device_time.seconds()
    }

    /// Integrated angular rate in body axes, counts of 2**-36 rad.
    #[getter]
    fn delta_theta(&self) -> (i32, i32, i32) {
        self.epoch.sample.delta_theta.into()
    }

    #[setter]
    fn set_delta_theta(&mut self, counts: [i32; 3]) {
        self.epoch.sample.delta_theta = counts;
    }

    /// Integrated specific force in body axes, counts of 2**-30 m/s.
    #[getter]
    fn delta_velocity(&self) -> (i32, i32, i32) {
        self.epoch.sample.delta_velocity.into()
    }

    #[setter]
    fn set_delta_velocity(&mut self, counts: [i32; 3]) {
        self.epoch.sample.delta_velocity = counts;
    }

    /// Integrated angular rate in body axes, rad.
    #[getter]
    fn delta_theta_rad(&self) -> (f64, f64, f64) {
        self.epoch.sample.delta_theta.map(|n| f64::from(n) * DELTA_THETA_LSB_RAD).into()
    }

    /// Integrated specific force in body axes, m/s.
    #[getter]
    fn delta_velocity_mps(&self) -> (f64, f64, f64) {
        self.epoch.sample.delta_velocity.map(|n| f64::from(n) * DELTA_VELOCITY_LSB_MPS).into()
    }

    /// Encoder angles (azimuth, roll), rad.
    #[getter]
    fn gimbal_rad(&self) -> (f64, f64) {
        let gimbal = self.epoch.sample.gimbal;
        (gimbal.azimuth_rad(), gimbal.roll_rad())
    }

    /// Encoder angles (azimuth, roll), counts of 2**-27 rad.
    #[getter]
    fn gimbal(&self) -> (i32, i32) {
        let gimbal = self.epoch.sample.gimbal;
        (gimbal.azimuth, gimbal.roll)
    }

    #[setter]
    fn set_gimbal(&mut self, counts: [i32; 2]) {
        let [azimuth, roll] = counts;
        self.epoch.sample.gimbal = GimbalAngles { azimuth, roll };
    }

    /// Flags of the instrument.
    #[getter]
    fn status(&self) -> u16 {
        self.epoch.sample.status.bits()
    }

    #[setter]
    fn set_status(&mut self, bits: u16) {
        self.epoch.sample.status = Status::from_bits_retain(bits);
    }

    /// The reference that goes with the sample, or None.
    #[getter]
    fn aiding(&self) -> Option<(&'static str, (f64, f64, f64))> {
        self.epoch.aiding.map(|aiding| match aiding.reference {
            Reference::Velocity(velocity) => ("velocity", velocity.into()),
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                ("position", (latitude_rad, longitude_rad, height_m))
            }
        })
    }

    #[setter]
    fn set_aiding(&mut self, aiding: Option<Given>) -> PyResult<()> {
        let Some((kind, values)) = aiding else {
            self.epoch.aiding = None;
            return Ok(());
        };
        let reference = match kind.as_str() {
            "velocity" => Reference::Velocity(values),
            "position" => {
                let [latitude_rad, longitude_rad, height_m] = values;
                Reference::Position { latitude_rad, longitude_rad, height_m }
            }
            other => {
                let expected = "expected \"velocity\" or \"position\"";
                return Err(argument(format!("aiding of kind {other:?}, {expected}")));
            }
        };
        self.epoch.aiding = Some(Aiding { device_time: self.epoch.sample.device_time, reference });
        Ok(())
    }

    fn __repr__(&self) -> String {
        let sample = &self.epoch.sample;
        format!("Epoch(sequence={}, time_s={})", sample.sequence, sample.device_time.seconds())
    }
}

/// Answer of the unit under test to one sample.
///
/// The harness makes it and fills in number and stamp of the sample; the unit fills in the rest. What it
/// doesn't set stays as in its answer before.
#[pyclass(module = "octant", name = "Output")]
#[derive(Debug)]
pub(crate) struct PyOutput {
    pub(crate) output: Output,
    pub(crate) estimate: ParameterEstimate,
}

impl PyOutput {
    /// Makes the answer before the first sample: at rest at latitude and longitude 0.
    pub(crate) fn first() -> Self {
        let mut output = Output { nis: f64::NAN, ..Output::default() };
        output.navigation.q_nb = [1.0, 0.0, 0.0, 0.0];
        let sigma = [f64::NAN; PARAMETER_COUNT];
        let estimate = ParameterEstimate { revision: 0, parameters: Parameters::default(), sigma };
        Self { output, estimate }
    }

    /// Begins the answer to a sample.
    pub(crate) fn begin(&mut self, sample: &Sample) {
        self.output.sequence = sample.sequence;
        self.output.device_time = sample.device_time;
        self.output.nis = f64::NAN;
        self.output.health = Health::empty();
    }
}

#[pymethods]
impl PyOutput {
    /// Number of the sample that this answers.
    #[getter]
    fn sequence(&self) -> u64 {
        self.output.sequence
    }

    /// Stamp of the sample that this answers, ns.
    #[getter]
    fn time_ns(&self) -> u64 {
        self.output.device_time.ns
    }

    /// Mode: "aligning", "calibrating", "refused", "navigating" or "done". "refused" and "done" end the
    /// run; a mode never goes back.
    #[getter]
    fn mode(&self) -> &'static str {
        self.output.mode.name()
    }

    #[setter]
    fn set_mode(&mut self, name: &str) -> PyResult<()> {
        let Some(mode) = Mode::ALL.into_iter().find(|mode| mode.name() == name) else {
            let known =
                octant_base::names::suggestion(name, Mode::ALL.iter().map(|m| m.name()), "modes");
            return Err(argument(format!("mode {name:?}, {known}")));
        };
        self.output.mode = mode;
        Ok(())
    }

    /// Stop of the sequence that the gimbals are at or move to, from 0.
    #[getter]
    fn stop(&self) -> u16 {
        self.output.stop
    }

    #[setter]
    fn set_stop(&mut self, stop: u16) {
        self.output.stop = stop;
    }

    /// Whether the gimbals move to ``stop``.
    #[getter]
    fn moving(&self) -> bool {
        self.output.moving
    }

    #[setter]
    fn set_moving(&mut self, moving: bool) {
        self.output.moving = moving;
    }

    /// Set point of the gimbals (azimuth, roll), rad. Computed from sample k it is felt in sample k + 2.
    #[getter]
    fn command_rad(&self) -> (f64, f64) {
        let target = self.output.gimbal_command.target;
        (target.azimuth_rad(), target.roll_rad())
    }

    #[setter]
    fn set_command_rad(&mut self, angles: (f64, f64)) {
        let (azimuth, roll) = angles;
        self.output.gimbal_command.target = GimbalAngles::from_rad(azimuth, roll);
    }

    /// Latitude, rad.
    #[getter]
    fn latitude_rad(&self) -> f64 {
        self.output.navigation.latitude_rad
    }

    #[setter]
    fn set_latitude_rad(&mut self, value: f64) {
        self.output.navigation.latitude_rad = value;
    }

    /// Longitude, rad, not wrapped.
    #[getter]
    fn longitude_rad(&self) -> f64 {
        self.output.navigation.longitude_rad
    }

    #[setter]
    fn set_longitude_rad(&mut self, value: f64) {
        self.output.navigation.longitude_rad = value;
    }

    /// Height above the ellipsoid, m.
    #[getter]
    fn height_m(&self) -> f64 {
        self.output.navigation.height_m
    }

    #[setter]
    fn set_height_m(&mut self, value: f64) {
        self.output.navigation.height_m = value;
    }

    /// Velocity over ground (north, east, down), m/s.
    #[getter]
    fn velocity_mps(&self) -> (f64, f64, f64) {
        self.output.navigation.velocity_mps.into()
    }

    #[setter]
    fn set_velocity_mps(&mut self, value: [f64; 3]) {
        self.output.navigation.velocity_mps = value;
    }

    /// Attitude (w, x, y, z): takes a vector in body axes into north-east-down.
    #[getter]
    fn q_nb(&self) -> (f64, f64, f64, f64) {
        self.output.navigation.q_nb.into()
    }

    #[setter]
    fn set_q_nb(&mut self, value: [f64; 4]) {
        self.output.navigation.q_nb = value;
    }

    /// Health flags of this sample; 0 in every new answer.
    #[getter]
    fn health(&self) -> u32 {
        self.output.health.bits()
    }

    #[setter]
    fn set_health(&mut self, bits: u32) {
        self.output.health = Health::from_bits_retain(bits);
    }

    /// Normalized innovation squared of the measurement, three axes; NaN in every new answer.
    #[getter]
    fn nis(&self) -> f64 {
        self.output.nis
    }

    #[setter]
    fn set_nis(&mut self, value: f64) {
        self.output.nis = value;
    }

    /// Report new parameters.
    ///
    /// Parameters
    /// ----------
    /// values, sigma : sequence of 30 floats
    ///     Estimates and their standard deviations, SI, in the order of ``octant.PARAMETERS``; sigma is
    ///     NaN where a parameter isn't estimated.
    fn set_parameters(&mut self, values: Vec<f64>, sigma: Vec<f64>) -> PyResult<()> {
        let all = |what: &str, values: Vec<f64>| -> PyResult<[f64; PARAMETER_COUNT]> {
            let found = values.len();
            values
                .try_into()
                .map_err(|_| argument(format!("found {found} {what}, expected {PARAMETER_COUNT}")))
        };
        let (values, sigma) = (all("values", values)?, all("sigma", sigma)?);
        let revision = self.output.parameters_revision + 1;
        self.output.parameters_revision = revision;
        let parameters = Parameters::from_array(&values);
        self.estimate = ParameterEstimate { revision, parameters, sigma };
        Ok(())
    }
}

/// True state at one instant.
///
/// Parameters
/// ----------
/// time_ns : int
///     Simulated time, ns.
/// latitude_rad, longitude_rad, height_m : float
///     Position, rad, rad, m.
/// velocity_mps : (float, float, float)
///     Velocity over ground (north, east, down), m/s.
/// q_nb : (float, float, float, float)
///     Attitude (w, x, y, z): takes a vector in body axes into north-east-down.
/// gimbal_rad : (float, float)
///     Gimbal angles (azimuth, roll), rad.
#[pyclass(module = "octant", name = "Truth", frozen, from_py_object)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct PyTruth {
    pub(crate) truth: Truth,
}

#[pymethods]
impl PyTruth {
    #[new]
    #[pyo3(signature = (time_ns, latitude_rad, longitude_rad, height_m=0.0, velocity_mps=[0.0; 3],
        q_nb=[1.0, 0.0, 0.0, 0.0], gimbal_rad=[0.0; 2]))]
    fn new(
        time_ns: u64,
        latitude_rad: f64,
        longitude_rad: f64,
        height_m: f64,
        velocity_mps: [f64; 3],
        q_nb: [f64; 4],
        gimbal_rad: [f64; 2],
    ) -> Self {
        let time = octant_sample::time::SimulatedTime { ns: time_ns };
        let truth =
            Truth { time, latitude_rad, longitude_rad, height_m, velocity_mps, q_nb, gimbal_rad };
        Self { truth }
    }

    /// Simulated time, ns.
    #[getter]
    fn time_ns(&self) -> u64 {
        self.truth.time.ns
    }

    /// Latitude, rad.
    #[getter]
    fn latitude_rad(&self) -> f64 {
        self.truth.latitude_rad
    }

    /// Longitude, rad.
    #[getter]
    fn longitude_rad(&self) -> f64 {
        self.truth.longitude_rad
    }

    /// Height above the ellipsoid, m.
    #[getter]
    fn height_m(&self) -> f64 {
        self.truth.height_m
    }

    /// Velocity over ground (north, east, down), m/s.
    #[getter]
    fn velocity_mps(&self) -> (f64, f64, f64) {
        self.truth.velocity_mps.into()
    }

    /// Attitude (w, x, y, z).
    #[getter]
    fn q_nb(&self) -> (f64, f64, f64, f64) {
        self.truth.q_nb.into()
    }

    /// Gimbal angles (azimuth, roll), rad.
    #[getter]
    fn gimbal_rad(&self) -> (f64, f64) {
        self.truth.gimbal_rad.into()
    }
}
