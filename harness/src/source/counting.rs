//! Measured quantities of a real instrument into the integer counts of a sample.

use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};

/// What a file's inertial columns hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Angular rate, rad/s, and specific force, m/s², taken as constant over the interval that ends
    /// at the stamp.
    #[default]
    Rates,
    /// Angle increments, rad, and velocity increments, m/s, over that interval.
    Increments,
}

/// One row of a file in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Stamp, ns.
    pub(super) time_ns: u64,
    /// Gyros x y z: rad/s or rad.
    pub(super) gyro: [f64; 3],
    /// Accelerometers x y z: m/s² or m/s.
    pub(super) accel: [f64; 3],
    /// Gimbal azimuth and roll, rad, where the file has them.
    pub(super) gimbal_rad: Option<[f64; 2]>,
}

/// Counts what comes and carries the remainder of each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    quantity: Quantity,
    /// Interval that the first sample stands for, ns.
    nominal_ns: u64,
    previous_ns: Option<u64>,
    sequence: u64,
    gyro: [Accumulator; 3],
    accel: [Accumulator; 3],
    saturated: u64,
}

impl Counting {
    pub(super) fn new(quantity: Quantity, nominal_ns: u64) -> Self {
        Self {
            quantity,
            nominal_ns,
            previous_ns: None,
            sequence: 0,
            gyro: Default::default(),
            accel: Default::default(),
            saturated: 0,
        }
    }

    /// Samples in which at least one count saturated.
    pub(super) fn saturated(&self) -> u64 {
        self.saturated
    }

    /// Stamp of the last sample.
    pub(super) fn previous_ns(&self) -> Option<u64> {
        self.previous_ns
    }

    /// The sample of one row. `None` if its stamp is not after that of the row before.
    pub(super) fn sample(&mut self, row: &Measured) -> Option<Sample> {
        let interval_ns = match self.previous_ns {
            None => self.nominal_ns,
            Some(previous) => row.time_ns.checked_sub(previous).filter(|interval| *interval > 0)?,
        };
        self.previous_ns = Some(row.time_ns);
        self.sequence += 1;
        let factor = match self.quantity {
            Quantity::Rates => interval_ns as f64 * 1e-9,
            Quantity::Increments => 1.0,
        };
        let mut status = Status::empty();
        let mut count = |accumulator: &mut Accumulator, value: f64, lsb: f64, flag: Status| {
            let count = accumulator.count(value * factor / lsb);
            if count.saturated {
                status |= flag;
            }
            count.value
        };
        let mut sample = Sample {
            sequence: self.sequence,
            device_time: DeviceTime::from_ns(row.time_ns),
            ..Sample::default()
        };
        for axis in 0..3 {
            sample.delta_theta[axis] = count(
                &mut self.gyro[axis],
                row.gyro[axis],
                DELTA_THETA_LSB_RAD,
                Status::GYRO_SATURATED,
            );
            sample.delta_velocity[axis] = count(
                &mut self.accel[axis],
                row.accel[axis],
                DELTA_VELOCITY_LSB_MPS,
                Status::ACCELEROMETER_SATURATED,
            );
        }
        if !status.is_empty() {
            self.saturated += 1;
        }
        match row.gimbal_rad {
            Some([azimuth, roll]) => sample.gimbal = GimbalAngles::from_rad(azimuth, roll),
            None => status |= Status::GIMBAL_INVALID,
        }
        sample.status = status;
        Some(sample)
    }
}
