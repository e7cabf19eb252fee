//! Canonical bytes, over which the stream hash is taken: the same for every realisation.
//!
//! Little-endian, fixed layout, no padding; f64 as its 64 bits. Host time is not part of it.

use crate::parameters::PARAMETER_COUNT;
use crate::{Aiding, Output, Parameters, Reference, Sample};

/// Bytes of a sample.
pub const SAMPLE_BYTES: usize = 8 + 8 + 6 * 4 + 2 * 4 + 2;
/// Bytes of an aiding message.
pub const AIDING_BYTES: usize = 8 + 1 + 3 * 8;
/// Bytes of an output.
pub const OUTPUT_BYTES: usize = 8 + 8 + 1 + 2 + 1 + 8 + 10 * 8 + 4 + 8 + 4;
/// Bytes of a sample and an output, without aiding between them.
pub const PLAIN_BYTES: usize = SAMPLE_BYTES + OUTPUT_BYTES;
/// Bytes of the parameters with their σ.
pub const PARAMETERS_BYTES: usize = 2 * PARAMETER_COUNT * 8;

/// A cursor over a fixed buffer; every layout below fills its buffer exactly.
struct Writer<'a> {
    rest: &'a mut [u8],
}

impl Writer<'_> {
    #[inline]
    fn put(&mut self, bytes: &[u8]) {
        let (head, tail) = core::mem::take(&mut self.rest).split_at_mut(bytes.len());
        head.copy_from_slice(bytes);
        self.rest = tail;
    }

    #[inline]
    fn f64(&mut self, value: f64) {
        self.put(&value.to_bits().to_le_bytes());
    }
}

/// Writes a sample: sequence u64, device time ns u64, delta_theta 3×i32, delta_velocity 3×i32,
/// azimuth i32, roll i32, status u16.
#[inline]
pub fn sample(sample: &Sample, bytes: &mut [u8; SAMPLE_BYTES]) {
    put_sample(sample, &mut Writer { rest: bytes });
}

#[inline(always)]
fn put_sample(sample: &Sample, w: &mut Writer<'_>) {
    w.put(&sample.sequence.to_le_bytes());
    w.put(&sample.device_time.ns.to_le_bytes());
    // Each field by itself: through a chained iterator, every write would check the room that is left.
    let [[x, y, z], [u, v, s]] = [sample.delta_theta, sample.delta_velocity];
    for count in [x, y, z, u, v, s] {
        w.put(&count.to_le_bytes());
    }
    w.put(&sample.gimbal.azimuth.to_le_bytes());
    w.put(&sample.gimbal.roll.to_le_bytes());
    w.put(&sample.status.bits().to_le_bytes());
}

/// Writes an aiding message: device time ns u64, kind u8 (0 velocity, 1 position), three f64
/// (north, east, down in m/s; or latitude, longitude in rad and height in m).
#[inline]
pub fn aiding(aiding: &Aiding, bytes: &mut [u8; AIDING_BYTES]) {
    let mut w = Writer { rest: bytes };
    w.put(&aiding.device_time.ns.to_le_bytes());
    let (kind, values) = match aiding.reference {
        Reference::Velocity(velocity) => (0u8, velocity),
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            (1, [latitude_rad, longitude_rad, height_m])
        }
    };
    w.put(&[kind]);
    for value in values {
        w.f64(value);
    }
}

/// Writes an output: sequence u64, device time ns u64, mode u8, stop u16, moving u8, azimuth and
/// roll set points i32, latitude, longitude, height, velocity 3×, q_nb 4× as f64, health u32, NIS
/// f64, parameters revision u32.
#[inline]
pub fn output(output: &Output, bytes: &mut [u8; OUTPUT_BYTES]) {
    put_output(output, &mut Writer { rest: bytes });
}

/// Writes a sample, then an output.
#[inline]
pub fn sample_and_output(sample: &Sample, output: &Output, bytes: &mut [u8; PLAIN_BYTES]) {
    let mut w = Writer { rest: bytes };
    put_sample(sample, &mut w);
    put_output(output, &mut w);
}

#[inline(always)]
fn put_output(output: &Output, w: &mut Writer<'_>) {
    w.put(&output.sequence.to_le_bytes());
    w.put(&output.device_time.ns.to_le_bytes());
    w.put(&[output.mode as u8]);
    w.put(&output.stop.to_le_bytes());
    w.put(&[u8::from(output.moving)]);
    w.put(&output.gimbal_command.target.azimuth.to_le_bytes());
    w.put(&output.gimbal_command.target.roll.to_le_bytes());
    let navigation = &output.navigation;
    w.f64(navigation.latitude_rad);
    w.f64(navigation.longitude_rad);
    w.f64(navigation.height_m);
    let ([north, east, down], [q0, q1, q2, q3]) = (navigation.velocity_mps, navigation.q_nb);
    for value in [north, east, down, q0, q1, q2, q3] {
        w.f64(value);
    }
    w.put(&output.health.bits().to_le_bytes());
    w.f64(output.nis);
    w.put(&output.parameters_revision.to_le_bytes());
}

/// Writes parameters and σ: the thirty estimates, then their thirty 1σ, as f64, in the order of
/// [`crate::parameters::NAMES`].
#[inline]
pub fn parameters(
    parameters: &Parameters,
    sigma: &[f64; PARAMETER_COUNT],
    bytes: &mut [u8; PARAMETERS_BYTES],
) {
    let mut w = Writer { rest: bytes };
    for value in parameters.to_array().iter().chain(sigma) {
        w.f64(*value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_fills_its_buffer() {
        // The writers panic on overflow; a byte left over would stay 0xAA in these patterns.
        let (mut a, mut b, mut c) =
            ([0xAA; SAMPLE_BYTES], [0xAA; AIDING_BYTES], [0xAA; OUTPUT_BYTES]);
        let mut d = [0xAA; PARAMETERS_BYTES];
        sample(&Sample::default(), &mut a);
        aiding(
            &Aiding {
                device_time: crate::DeviceTime::default(),
                reference: Reference::Velocity([0.0; 3]),
            },
            &mut b,
        );
        output(&Output::default(), &mut c);
        parameters(&Parameters::default(), &[0.0; PARAMETER_COUNT], &mut d);
        assert!(a.iter().chain(&b).chain(&c).chain(&d).all(|byte| *byte == 0));
    }
}
