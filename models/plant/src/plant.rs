//! The plant, advanced one sample at a time.

mod state;
mod tune;

use crate::config::{PlantConfig, START_TEMPERATURE_C, Temperature};
use crate::course::Course;
use crate::disturbed::Motion;
use crate::encoder::ErrorCurve;
use crate::imu::{Reading, Sensors};
use crate::increments::{Body, Increments};
use crate::reference::Aider;
use crate::validate::{PlantConfigError, validate};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::Ellipsoid;
use octant_random::stream::Triad;
use octant_sample::disturbance::{Disturbance, Motor};
use octant_sample::time::SimulatedTime;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, NoiseIntegral, Sample, Status, Truth,
};

pub use state::FORMAT as STATE_FORMAT;

/// Result of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantStep {
    /// The sample of the interval.
    pub sample: Sample,
    /// The reference, when due, with the stamp of the sample.
    pub aiding: Option<Aiding>,
}

/// Motion, turntable, sensors and reference of one run.
///
/// A clone continues exactly as the original.
#[derive(Clone, Debug)]
pub struct Plant {
    config: Box<PlantConfig>,
    sequence: u64,
    time_ns: u64,
    calibration_samples: u64,
    /// Number of the next sample in its phase, from 0.
    in_phase: u64,
    body: Body,
    sensors: Sensors,
    encoders: [ErrorCurve; 2],
    encoder_noise: Option<Triad>,
    aider: Aider,
    /// Samples until the reference is due.
    until_aiding: u64,
    non_orthogonality_rad: f64,
    /// Rotation of the body on the inner gimbal; `None`: none.
    mounting: Option<UnitQuaternion<f64>>,
    saturated_samples: u64,
    /// Increments and reading of the last sample; `is_still` if every later sample has the same.
    increments: Increments,
    reading: Reading,
    is_still: bool,
    /// Encoder angles; those of a drive at rest are not computed again.
    angles: GimbalAngles,
    /// True for azimuth and roll if the drive rests and its angle has been read.
    resting: [bool; 2],
    /// Flags of the encoders.
    flags: Status,
}

impl Plant {
    /// Makes a plant at time 0, gimbals at rest at (0, 0).
    ///
    /// # Errors
    /// If a field of the configuration is out of its range.
    pub fn new(config: &PlantConfig) -> Result<Self, PlantConfigError> {
        validate(config)?;
        let dt = config.sample_period_ns as f64 * 1e-9;
        let (sigma_rad, errors) = (config.turntable.encoder_sigma_rad, &config.turntable.errors);
        let aider = Aider::new(config);
        Ok(Self {
            config: Box::new(config.clone()),
            sequence: 0,
            time_ns: 0,
            calibration_samples: config.calibration_samples,
            in_phase: 0,
            body: Body::new(config),
            sensors: Sensors::new(&config.imu, dt, config.seed),
            encoders: [("turntable.encoder.azimuth", 0), ("turntable.encoder.roll", 1)].map(
                |(name, axis)| {
                    let (zero, first) =
                        (errors.encoder_zero_rad[axis], errors.eccentricity_rad[axis]);
                    ErrorCurve::new(config.seed, name, sigma_rad, zero, first)
                },
            ),
            encoder_noise: (errors.encoder_noise_rad > 0.0)
                .then(|| Triad::new(config.seed, "turntable.encoder.noise")),
            until_aiding: aider.period_samples(),
            aider,
            non_orthogonality_rad: config.turntable.non_orthogonality_rad,
            mounting: (errors.mounting_rad != [0.0; 3])
                .then(|| octant_earth::rotation::exp(&errors.mounting_rad.into())),
            saturated_samples: 0,
            increments: Increments::default(),
            reading: Reading::default(),
            is_still: false,
            angles: GimbalAngles::default(),
            resting: [false; 2],
            flags: Status::empty(),
        })
    }

    /// Configuration of the plant.
    #[must_use]
    pub fn config(&self) -> &PlantConfig {
        &self.config
    }

    /// Moves the case of a moored ship on a course, beside its sway, in the next interval. The
    /// course has to be given before every interval for which it holds.
    ///
    /// # Errors
    /// If the motion isn't that of a ship, the instrument lags its stamps (the motion before the
    /// start, which it would need, isn't known), or the course isn't [sound](Course::is_sound).
    pub fn follow(&mut self, course: &Course) -> Result<(), PlantConfigError> {
        let problem = |field: &str, found: String, expected: &str| {
            let (field, expected) = (field.to_owned(), expected.to_owned());
            Err(PlantConfigError { field, found, expected })
        };
        if !course.is_sound() {
            return problem("course", format!("{course:?}"), "finite numbers");
        }
        let skew_s = self.config.imu.extensions.time_skew_s;
        if skew_s > 0.0 {
            return problem("imu.extensions.time_skew_s", skew_s.to_string(), "0 on a course");
        }
        if !self.body.case.follow(course) {
            return problem("motion", "static".to_owned(), "a ship that can follow a course");
        }
        if self.sequence == 0 {
            self.body.begin(0.0);
        }
        Ok(())
    }

    /// Makes the next sample.
    ///
    /// `command` is the core's answer to the sample before; it acts from the end of the interval
    /// that this call delivers, and is first felt in the one after.
    ///
    /// Equivalent to [`Self::sample_into`], then [`Self::command`]. A caller that gets a command
    /// between two samples calls them in the other order.
    #[inline]
    pub fn step(&mut self, command: &GimbalCommand) -> PlantStep {
        let mut step = PlantStep { sample: Sample::default(), aiding: None };
        self.step_into(command, &mut step.sample, &mut step.aiding);
        step
    }

    /// [`Self::step`] in place, for callers that make millions of steps: a copy of data that has
    /// just been written waits for the stores.
    #[inline]
    pub fn step_into(
        &mut self,
        command: &GimbalCommand,
        sample: &mut Sample,
        aiding: &mut Option<Aiding>,
    ) {
        self.sample_into(sample, aiding);
        self.command(command);
    }

    /// Takes new set points of the gimbals; they act from now on, the end of the last interval.
    #[inline]
    pub fn command(&mut self, command: &GimbalCommand) {
        if self.body.command(command, self.time_ns) {
            self.is_still = false;
            self.resting = [false; 2];
        }
    }

    /// Makes the sample of the next interval, and the reference, when due, with its stamp.
    #[inline]
    pub fn sample_into(&mut self, sample: &mut Sample, aiding: &mut Option<Aiding>) {
        let start_ns = self.time_ns;
        if self.sequence == self.calibration_samples {
            self.in_phase = 0;
            self.sensors.navigate();
            self.navigate_encoders();
        }
        let number = self.in_phase;
        self.in_phase += 1;
        self.sequence += 1;
        self.time_ns += self.body.period_ns();

        if !self.is_still {
            self.move_on(start_ns);
        }
        let status = self.sensors.count(
            &self.reading,
            &self.increments,
            number,
            start_ns,
            &mut sample.delta_theta,
            &mut sample.delta_velocity,
        );
        self.saturated_samples += u64::from(!status.is_empty());
        if self.resting != [true; 2] {
            self.read_encoders();
        }
        sample.sequence = self.sequence;
        sample.device_time = DeviceTime::from_ns(self.time_ns);
        sample.gimbal = self.angles;
        if self.encoder_noise.is_some() {
            self.add_encoder_noise(&mut sample.gimbal, number);
        }
        sample.status = status | self.flags;
        self.until_aiding -= 1;
        if self.until_aiding == 0 {
            *aiding = self.aid(sample.device_time, number);
        } else {
            *aiding = None;
        }
    }

    #[inline(never)]
    fn move_on(&mut self, start_ns: u64) {
        self.increments = self.body.increments(start_ns);
        self.reading = self.sensors.read(&self.increments);
        self.is_still = self.body.is_constant(start_ns);
    }

    #[inline(never)]
    fn read_encoders(&mut self) {
        let mut read = [self.angles.azimuth, self.angles.roll];
        for (axis, gimbal) in [&self.body.azimuth, &self.body.roll].into_iter().enumerate() {
            if !self.resting[axis] {
                let mut angle = gimbal.read(self.time_ns);
                let mut turns = false;
                if let Some(active) = &self.body.active {
                    angle += active.seen(axis, self.time_ns);
                    turns = active.turns(axis);
                }
                let measured = angle + self.encoders[axis].at(angle);
                read[axis] = GimbalAngles::from_rad(measured, 0.0).azimuth;
                self.resting[axis] = gimbal.rests(self.time_ns) && !turns;
            }
        }
        self.angles = GimbalAngles { azimuth: read[0], roll: read[1] };
    }

    /// Switches the encoders' noise to the numbers of the navigation phase.
    #[cold]
    fn navigate_encoders(&mut self) {
        if let Some(noise) = &mut self.encoder_noise {
            noise.navigate();
        }
    }

    /// Adds the white noise of both encoders; `number` is that of the sample in its phase.
    #[inline(never)]
    fn add_encoder_noise(&self, angles: &mut GimbalAngles, number: u64) {
        let Some(noise) = &self.encoder_noise else { return };
        let [azimuth, roll, _] = noise.at(number);
        let sigma_rad = self.config.turntable.errors.encoder_noise_rad;
        let added = GimbalAngles::from_rad(sigma_rad * azimuth, sigma_rad * roll);
        angles.azimuth = angles.azimuth.saturating_add(added.azimuth);
        angles.roll = angles.roll.saturating_add(added.roll);
    }

    #[inline(never)]
    fn aid(&mut self, device_time: DeviceTime, sample: u64) -> Option<Aiding> {
        self.until_aiding = self.aider.period_samples();
        (self.sequence <= self.calibration_samples).then(|| {
            self.aider.measure(device_time, sample, || self.body.whereabouts(self.time_ns))
        })
    }

    /// Truth at the stamp of the last step; before the first step, at time 0.
    #[must_use]
    pub fn truth(&self) -> Truth {
        let at = self.body.whereabouts(self.time_ns);
        let gimbal_rad = self.body.gimbal_rad(self.time_ns);
        let about = |angle_rad: f64, axis: usize| {
            let (s, c) = libm::sincos(0.5 * angle_rad);
            let mut q = [c, 0.0, 0.0, 0.0];
            q[axis] = s;
            Quaternion::new(q[0], q[1], q[2], q[3])
        };
        let q = about(at.heading_rad, 3)
            * about(at.pitch_rad, 2)
            * about(at.roll_rad, 1)
            * about(gimbal_rad[1], 1)
            * about(self.non_orthogonality_rad, 2)
            * about(gimbal_rad[0], 3);
        let q = self.mounting.map_or(q, |mounting| q * mounting.into_inner());
        let truth = Truth {
            time: SimulatedTime::from_ns(self.time_ns),
            latitude_rad: at.latitude_rad,
            longitude_rad: at.longitude_rad,
            height_m: at.height_m,
            velocity_mps: at.velocity_mps.into(),
            q_nb: [q.w, q.i, q.j, q.k],
            gimbal_rad,
        };
        match self.body.block(self.time_ns) {
            None => truth,
            Some((motion, rate)) => displaced(truth, &motion, &rate),
        }
    }

    /// White noise in the samples so far.
    #[must_use]
    pub fn white_noise(&self) -> NoiseIntegral {
        self.sensors.white_noise()
    }

    /// True if nothing moved in the last interval, neither case nor gimbals: the truth at its end is that
    /// at its beginning.
    #[must_use]
    #[inline]
    pub fn stands(&self) -> bool {
        self.is_still
    }

    /// Number of samples so far in which a count or a sensor's range saturated.
    #[must_use]
    pub fn saturated_samples(&self) -> u64 {
        self.saturated_samples
    }
}

/// Truth of a sensor block that faults have displaced by `motion` against the gimballed body;
/// `rate` is the angular rate of the body in b.
fn displaced(truth: Truth, motion: &Motion, rate: &Vector3<f64>) -> Truth {
    let [w, x, y, z] = truth.q_nb;
    let c_nb = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    let earth = Ellipsoid::at(truth.latitude_rad, truth.height_m);
    let over_ground = rate - c_nb.inverse() * earth.earth_rate();
    let [r, r_rate, _] = motion.displacement;
    let aside = c_nb * r;
    let velocity = Vector3::from(truth.velocity_mps) + c_nb * (r_rate + over_ground.cross(&r));
    let north_rad = aside.x / earth.meridian_radius_m;
    let east_rad = aside.y / earth.transverse_radius_m;
    let per_cos = 1.0 / earth.cos_latitude;
    // North and down are taken at the displaced position.
    let turn = Vector3::new(east_rad, -north_rad, -east_rad * earth.sin_latitude * per_cos);
    let q = octant_earth::rotation::exp(&-turn) * c_nb * motion.rotation();
    Truth {
        latitude_rad: truth.latitude_rad + north_rad,
        longitude_rad: truth.longitude_rad + east_rad * per_cos,
        height_m: truth.height_m - aside.z,
        velocity_mps: velocity.into(),
        q_nb: [q.w, q.i, q.j, q.k],
        ..truth
    }
}

impl Plant {
    /// Temperature of the instrument, °C: mean over the last sample. Its thermometer has no error.
    #[must_use]
    pub fn temperature_c(&self) -> f64 {
        let start_ns = self.time_ns.saturating_sub(self.body.period_ns());
        START_TEMPERATURE_C + self.sensors.warmth_k(start_ns)
    }
}

impl Plant {
    /// State of the turntable.
    #[must_use]
    pub fn motor(&self) -> Motor {
        self.body.motor(self.time_ns)
    }

    /// Begins a disturbance at the start of the next interval. `handle` identifies it until its end.
    pub fn begin(&mut self, handle: u32, disturbance: &Disturbance) {
        if let Disturbance::Temperature {
            ramp_kps,
            plateau_k,
            gyro_bias_per_k,
            accel_bias_per_k,
            gyro_scale_per_k,
            accel_scale_per_k,
        } = *disturbance
        {
            let temperature = Temperature {
                ramp_kps,
                plateau_k,
                gyro_bias_per_k,
                accel_bias_per_k,
                gyro_scale_per_k,
                accel_scale_per_k,
            };
            self.sensors.heat(handle, temperature, self.time_ns);
        }
        self.body.disturb(handle, disturbance, self.time_ns);
        self.look_again();
    }

    /// Ends a disturbance at the start of the next interval.
    pub fn end(&mut self, handle: u32) {
        self.sensors.cool(handle, self.time_ns);
        self.body.calm(handle, self.time_ns);
        self.look_again();
    }

    /// Returns whether a disturbance lasts, or what it has set in motion: not the return of a drive to its set point.
    pub(crate) fn goes_on(&self, handle: u32) -> bool {
        self.sensors.goes_on(handle, self.time_ns) || self.body.goes_on(handle, self.time_ns)
    }

    /// Returns whether both drives move, or rest, as those of another plant at the same time.
    pub(crate) fn drives_as(&self, other: &Self) -> bool {
        self.body.drives_as(&other.body, self.time_ns)
    }

    /// Returns whether every later sample is that of another plant with the same configuration, for the same set points.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let saved = |plant: &Self| {
            let mut bytes = Vec::new();
            plant.save(&mut bytes);
            bytes
        };
        self.sensors.counts_as(&other.sensors) && saved(self) == saved(other)
    }

    /// Number of samples so far.
    pub(crate) fn samples(&self) -> u64 {
        self.sequence
    }

    /// Counts by which the remainders of two counters make sums of counts differ, of a gyro and of an accelerometer.
    pub(crate) fn remainder_counts(&self) -> [i64; 2] {
        self.sensors.remainder_counts()
    }

    /// Forgets that the plant is still and that drives rest, and sets the encoder flags anew.
    fn look_again(&mut self) {
        self.is_still = false;
        self.resting = [false; 2];
        let flagged = self.body.registry.flags_gimbal();
        self.flags = if flagged { Status::GIMBAL_INVALID } else { Status::empty() };
    }
}
