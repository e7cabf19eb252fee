//! The largest change of each channel between two streams of epochs.

use crate::{Epoch, GimbalCommand, Reference};

/// Largest change of each channel, without a sign, in the units of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LargestChange {
    /// Gyros x, y, z, counts of 2⁻³⁶ rad.
    pub delta_theta: [u32; 3],
    /// Accelerometers x, y, z, counts of 2⁻³⁰ m/s.
    pub delta_velocity: [u32; 3],
    /// Encoder angles, or set points, azimuth and roll, counts of 2⁻²⁷ rad.
    pub gimbal: [u32; 2],
    /// Stamp of the sample, ns.
    pub device_time_ns: u64,
    /// Aiding: north, east, down, m/s, or latitude, longitude, rad, and height, m. A change from or to a value that is
    /// no finite number has no size.
    pub aiding: [f64; 3],
}

/// Replaces a value by a larger one.
fn raise<T: PartialOrd>(largest: &mut T, found: T) {
    if found > *largest {
        *largest = found;
    }
}

fn values(reference: &Reference) -> (bool, [f64; 3]) {
    match *reference {
        Reference::Velocity(velocity) => (false, velocity),
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            (true, [latitude_rad, longitude_rad, height_m])
        }
    }
}

impl LargestChange {
    /// Takes a pair of epochs.
    pub fn take(&mut self, clean: &Epoch, faulted: &Epoch) {
        let (a, b) = (&clean.sample, &faulted.sample);
        for axis in 0..3 {
            let theta = a.delta_theta[axis].abs_diff(b.delta_theta[axis]);
            raise(&mut self.delta_theta[axis], theta);
            let velocity = a.delta_velocity[axis].abs_diff(b.delta_velocity[axis]);
            raise(&mut self.delta_velocity[axis], velocity);
        }
        raise(&mut self.gimbal[0], a.gimbal.azimuth.abs_diff(b.gimbal.azimuth));
        raise(&mut self.gimbal[1], a.gimbal.roll.abs_diff(b.gimbal.roll));
        raise(&mut self.device_time_ns, a.device_time.ns.abs_diff(b.device_time.ns));
        let (Some(a), Some(b)) = (&clean.aiding, &faulted.aiding) else { return };
        let ((a_is_position, a), (b_is_position, b)) = (values(&a.reference), values(&b.reference));
        if a_is_position == b_is_position {
            for axis in 0..3 {
                let change = (b[axis] - a[axis]).abs();
                if change.is_finite() {
                    raise(&mut self.aiding[axis], change);
                }
            }
        }
    }

    /// Takes a pair of set points.
    pub fn take_command(&mut self, clean: &GimbalCommand, faulted: &GimbalCommand) {
        let (a, b) = (&clean.target, &faulted.target);
        raise(&mut self.gimbal[0], a.azimuth.abs_diff(b.azimuth));
        raise(&mut self.gimbal[1], a.roll.abs_diff(b.roll));
    }
}
