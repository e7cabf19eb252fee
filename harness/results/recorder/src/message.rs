//! The messages of a recording: topics, schemas and byte layouts.
//!
//! Messages are CDR, little-endian, as ROS 2 stores them (OMG DDS-XTypes, plain CDR version 1): four
//! bytes of encapsulation, then the fields, each aligned to its size. The order of the fields needs no
//! padding, so a message has a fixed number of bytes. Numbers are stored as their bits: NaN payloads
//! and signed zeros survive.

pub use super::cdr::MessageError;
pub use super::topic::Topic;

use super::cdr::{Decoder, Encoder};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::time::SimulatedTime;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Innovation, InnovationOf, Mode,
    Navigation, NavigationCovariance, Output, Parameters, Reference, Sample, Status, Truth,
};

const IMU_LENGTH: usize = 4 + 16 + 24 + 8 + 2;
const AIDING_LENGTH: usize = 4 + 8 + 24 + 1;
const OUTPUT_LENGTH: usize = 4 + 16 + 11 * 8 + 8 + 8 + 4;
const INNOVATION_LENGTH: usize = 4 + 8 + 2 * 24 + 1;
const COVARIANCE_LENGTH: usize = 4 + 8 + 3 * 48;
const PARAMETERS_LENGTH: usize = 4 + 8 + 2 * PARAMETER_COUNT * 8 + 4;
const TRUTH_LENGTH: usize = 4 + 8 + 12 * 8;

/// Encodes a sample.
pub fn encode_sample(sample: &Sample, bytes: &mut Vec<u8>) {
    let mut e = Encoder::new(bytes);
    e.put(sample.sequence.to_le_bytes());
    e.put(sample.device_time.ns.to_le_bytes());
    for count in sample.delta_theta.iter().chain(&sample.delta_velocity) {
        e.put(count.to_le_bytes());
    }
    e.put(sample.gimbal.azimuth.to_le_bytes());
    e.put(sample.gimbal.roll.to_le_bytes());
    e.put(sample.status.bits().to_le_bytes());
}

/// Decodes a sample.
///
/// # Errors
/// If the bytes are not those of a sample.
pub fn decode_sample(bytes: &[u8]) -> Result<Sample, MessageError> {
    let mut d = Decoder::new(bytes, IMU_LENGTH)?;
    Ok(Sample {
        sequence: d.u64(),
        device_time: DeviceTime::from_ns(d.u64()),
        delta_theta: std::array::from_fn(|_| d.i32()),
        delta_velocity: std::array::from_fn(|_| d.i32()),
        gimbal: GimbalAngles { azimuth: d.i32(), roll: d.i32() },
        // Bits that this version doesn't know are kept.
        status: Status::from_bits_retain(d.u16()),
    })
}

const KIND_VELOCITY: u8 = 0;
const KIND_POSITION: u8 = 1;
const KIND_NONE: u8 = 255;

/// Stamp, kind and bits of the values.
pub(super) fn aiding_bits(aiding: &Aiding) -> (u64, u8, [u64; 3]) {
    let (kind, values) = match aiding.reference {
        Reference::Velocity(velocity) => (KIND_VELOCITY, velocity),
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            (KIND_POSITION, [latitude_rad, longitude_rad, height_m])
        }
    };
    (aiding.device_time.ns, kind, values.map(f64::to_bits))
}

/// Encodes aiding; `None` means that there was none.
pub fn encode_aiding(aiding: Option<&Aiding>, bytes: &mut Vec<u8>) {
    let (ns, kind, values) = aiding.map_or((0, KIND_NONE, [0; 3]), aiding_bits);
    let mut e = Encoder::new(bytes);
    e.put(ns.to_le_bytes());
    for value in values {
        e.put(value.to_le_bytes());
    }
    e.put([kind]);
}

/// Decodes aiding.
///
/// # Errors
/// If the bytes are not those of aiding.
pub fn decode_aiding(bytes: &[u8]) -> Result<Option<Aiding>, MessageError> {
    let mut d = Decoder::new(bytes, AIDING_LENGTH)?;
    let device_time = DeviceTime::from_ns(d.u64());
    let value: [f64; 3] = d.f64s();
    let reference = match d.take::<1>()[0] {
        KIND_VELOCITY => Reference::Velocity(value),
        KIND_POSITION => Reference::Position {
            latitude_rad: value[0],
            longitude_rad: value[1],
            height_m: value[2],
        },
        KIND_NONE => return Ok(None),
        kind => {
            return Err(MessageError::Value {
                field: "kind",
                found: kind.into(),
                expected: "0 (velocity), 1 (position) or 255 (none)",
            });
        }
    };
    Ok(Some(Aiding { device_time, reference }))
}

/// Encodes an output.
pub fn encode_output(output: &Output, bytes: &mut Vec<u8>) {
    let navigation = &output.navigation;
    let mut e = Encoder::new(bytes);
    e.put(output.sequence.to_le_bytes());
    e.put(output.device_time.ns.to_le_bytes());
    e.f64s(&[navigation.latitude_rad, navigation.longitude_rad, navigation.height_m]);
    e.f64s(&navigation.velocity_mps);
    e.f64s(&navigation.q_nb);
    e.f64s(&[output.nis]);
    e.put(output.gimbal_command.target.azimuth.to_le_bytes());
    e.put(output.gimbal_command.target.roll.to_le_bytes());
    e.put(output.health.bits().to_le_bytes());
    e.put(output.parameters_revision.to_le_bytes());
    e.put(output.stop.to_le_bytes());
    e.put([output.mode as u8]);
    e.put([u8::from(output.moving)]);
}

/// Decodes an output.
///
/// # Errors
/// If the bytes are not those of an output.
pub fn decode_output(bytes: &[u8]) -> Result<Output, MessageError> {
    let mut d = Decoder::new(bytes, OUTPUT_LENGTH)?;
    let (sequence, device_time) = (d.u64(), DeviceTime::from_ns(d.u64()));
    let navigation = Navigation {
        latitude_rad: d.f64(),
        longitude_rad: d.f64(),
        height_m: d.f64(),
        velocity_mps: d.f64s(),
        q_nb: d.f64s(),
    };
    let nis = d.f64();
    let target = GimbalAngles { azimuth: d.i32(), roll: d.i32() };
    let health = Health::from_bits_retain(d.u32());
    let (parameters_revision, stop) = (d.u32(), d.u16());
    let [mode, moving] = d.take();
    let mode = *Mode::ALL.get(usize::from(mode)).ok_or(MessageError::Value {
        field: "mode",
        found: mode.into(),
        expected: "0 to 4",
    })?;
    let moving = match moving {
        0 => false,
        1 => true,
        other => {
            return Err(MessageError::Value {
                field: "moving",
                found: other.into(),
                expected: "0 or 1",
            });
        }
    };
    Ok(Output {
        sequence,
        device_time,
        mode,
        stop,
        moving,
        gimbal_command: GimbalCommand { target },
        navigation,
        health,
        nis,
        parameters_revision,
    })
}

/// Encodes an innovation with the sequence number of its epoch.
pub fn encode_innovation(sequence: u64, innovation: &Innovation, bytes: &mut Vec<u8>) {
    let mut e = Encoder::new(bytes);
    e.put(sequence.to_le_bytes());
    e.f64s(&innovation.value);
    e.f64s(&innovation.sigma);
    e.put([match innovation.of {
        InnovationOf::Velocity => KIND_VELOCITY,
        InnovationOf::Position => KIND_POSITION,
    }]);
}

/// Decodes an innovation with the sequence number of its epoch.
///
/// # Errors
/// If the bytes are not those of an innovation.
pub fn decode_innovation(bytes: &[u8]) -> Result<(u64, Innovation), MessageError> {
    let mut d = Decoder::new(bytes, INNOVATION_LENGTH)?;
    let (sequence, value, sigma) = (d.u64(), d.f64s(), d.f64s());
    let of = match d.take::<1>()[0] {
        KIND_VELOCITY => InnovationOf::Velocity,
        KIND_POSITION => InnovationOf::Position,
        kind => {
            return Err(MessageError::Value {
                field: "kind",
                found: kind.into(),
                expected: "0 (velocity) or 1 (position)",
            });
        }
    };
    Ok((sequence, Innovation { of, value, sigma }))
}

/// Encodes a covariance with the sequence number of its epoch.
pub fn encode_covariance(sequence: u64, covariance: &NavigationCovariance, bytes: &mut Vec<u8>) {
    let mut e = Encoder::new(bytes);
    e.put(sequence.to_le_bytes());
    e.f64s(&covariance.position_m2);
    e.f64s(&covariance.velocity_m2ps2);
    e.f64s(&covariance.attitude_rad2);
}

/// Decodes a covariance with the sequence number of its epoch.
///
/// # Errors
/// If the bytes are not those of a covariance.
pub fn decode_covariance(bytes: &[u8]) -> Result<(u64, NavigationCovariance), MessageError> {
    let mut d = Decoder::new(bytes, COVARIANCE_LENGTH)?;
    let sequence = d.u64();
    let covariance = NavigationCovariance {
        position_m2: d.f64s(),
        velocity_m2ps2: d.f64s(),
        attitude_rad2: d.f64s(),
    };
    Ok((sequence, covariance))
}

/// Encodes parameters with their σ and the sequence number of their epoch.
pub fn encode_parameters(sequence: u64, estimate: &ParameterEstimate, bytes: &mut Vec<u8>) {
    let mut e = Encoder::new(bytes);
    e.put(sequence.to_le_bytes());
    e.f64s(&estimate.parameters.to_array());
    e.f64s(&estimate.sigma);
    e.put(estimate.revision.to_le_bytes());
}

/// Decodes parameters with the sequence number of their epoch.
///
/// # Errors
/// If the bytes are not those of parameters.
pub fn decode_parameters(bytes: &[u8]) -> Result<(u64, ParameterEstimate), MessageError> {
    let mut d = Decoder::new(bytes, PARAMETERS_LENGTH)?;
    let sequence = d.u64();
    let parameters = Parameters::from_array(&d.f64s());
    let sigma = d.f64s();
    Ok((sequence, ParameterEstimate { revision: d.u32(), parameters, sigma }))
}

/// Encodes truth.
pub fn encode_truth(truth: &Truth, bytes: &mut Vec<u8>) {
    let mut e = Encoder::new(bytes);
    e.put(truth.time.ns.to_le_bytes());
    e.f64s(&[truth.latitude_rad, truth.longitude_rad, truth.height_m]);
    e.f64s(&truth.velocity_mps);
    e.f64s(&truth.q_nb);
    e.f64s(&truth.gimbal_rad);
}

/// Decodes truth.
///
/// # Errors
/// If the bytes are not those of truth.
pub fn decode_truth(bytes: &[u8]) -> Result<Truth, MessageError> {
    let mut d = Decoder::new(bytes, TRUTH_LENGTH)?;
    Ok(Truth {
        time: SimulatedTime::from_ns(d.u64()),
        latitude_rad: d.f64(),
        longitude_rad: d.f64(),
        height_m: d.f64(),
        velocity_mps: d.f64s(),
        q_nb: d.f64s(),
        gimbal_rad: d.f64s(),
    })
}
