//! The messages of a recording: topics, schemas and byte layouts.
//!
//! Messages are CDR, little-endian, as ROS 2 stores them (OMG DDS-XTypes, plain CDR version 1): four
//! bytes of encapsulation, then the fields, each aligned to its size. The order of the fields needs no
//! padding, so a message has a fixed number of bytes. Numbers are stored as their bits: NaN payloads
//! and signed zeros survive.

pub use super::cdr::MessageError;

use super::cdr::{Decoder, Encoder};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_sample::time::SimulatedTime;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Innovation, InnovationOf, Mode,
    Navigation, Output, Parameters, Reference, Sample, Status, Truth,
};

/// Content of a recording's channel.
///
/// The order is that of the messages of one epoch in the file: an item of lower or equal rank begins
/// the next epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// Sample that the source delivered, only if it differs from [`Topic::Imu`].
    ImuClean,
    /// Aiding that the source delivered, only if it differs from [`Topic::Aiding`].
    AidingClean,
    /// Aiding that reached the core.
    Aiding,
    /// Sample that reached the core.
    Imu,
    /// Output of the core.
    Output,
    /// Innovation of each axis of a measurement.
    Innovation,
    /// Estimated parameters with their σ.
    Parameters,
    /// Truth.
    Truth,
    /// Rare events, JSON.
    Event,
}

impl Topic {
    /// All topics.
    pub const ALL: [Self; 9] = [
        Self::ImuClean,
        Self::AidingClean,
        Self::Aiding,
        Self::Imu,
        Self::Output,
        Self::Innovation,
        Self::Parameters,
        Self::Truth,
        Self::Event,
    ];

    /// Name of the topic in the file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ImuClean => "/imu/clean",
            Self::AidingClean => "/aiding/clean",
            Self::Aiding => "/aiding",
            Self::Imu => "/imu",
            Self::Output => "/output",
            Self::Innovation => "/innovation",
            Self::Parameters => "/parameters",
            Self::Truth => "/truth",
            Self::Event => "/event",
        }
    }

    /// Topic of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// Name of the schema.
    #[must_use]
    pub const fn schema_name(self) -> &'static str {
        match self {
            Self::ImuClean | Self::Imu => "octant_msgs/msg/InertialSample",
            Self::AidingClean | Self::Aiding => "octant_msgs/msg/Aiding",
            Self::Output => "octant_msgs/msg/Output",
            Self::Innovation => "octant_msgs/msg/Innovation",
            Self::Parameters => "octant_msgs/msg/Parameters",
            Self::Truth => "octant_msgs/msg/Truth",
            Self::Event => "octant.Event",
        }
    }

    /// Encoding of the schema and of the messages.
    #[must_use]
    pub const fn encodings(self) -> (&'static str, &'static str) {
        match self {
            Self::Event => ("jsonschema", "json"),
            _ => ("ros2msg", "cdr"),
        }
    }

    /// Text of the schema.
    #[must_use]
    pub fn schema(self) -> String {
        match self {
            Self::ImuClean | Self::Imu => IMU_SCHEMA.into(),
            Self::AidingClean | Self::Aiding => AIDING_SCHEMA.into(),
            Self::Output => OUTPUT_SCHEMA.into(),
            Self::Innovation => INNOVATION_SCHEMA.into(),
            Self::Parameters => parameters_schema(),
            Self::Truth => TRUTH_SCHEMA.into(),
            Self::Event => EVENT_SCHEMA.into(),
        }
    }
}

const IMU_SCHEMA: &str = "\
# Increments over the interval that ends at device_time_ns, body axes x y z, as integer counts.
# delta_theta: 2^-36 rad per count; delta_velocity: 2^-30 m/s per count; gimbals: 2^-27 rad.
uint64 sequence
uint64 device_time_ns
int32[3] delta_theta
int32[3] delta_velocity
int32 gimbal_azimuth
int32 gimbal_roll
# bit 0 gyro saturated, 1 accelerometer saturated, 2 gimbal invalid, 3 inertial invalid
uint16 status
";

const AIDING_SCHEMA: &str = "\
# kind 0: velocity north, east, down, m/s. kind 1: latitude rad, longitude rad, height m.
# kind 255 (only on /aiding/clean): the source delivered none.
uint8 VELOCITY=0
uint8 POSITION=1
uint8 NONE=255
uint64 device_time_ns
float64[3] value
uint8 kind
";

const OUTPUT_SCHEMA: &str = "\
# What the core answered. q_nb: w, x, y, z, takes a vector in body axes into north-east-down.
# nis is NaN where there was no measurement. Commands: 2^-27 rad per count.
uint8 ALIGNING=0
uint8 CALIBRATING=1
uint8 REFUSED=2
uint8 NAVIGATING=3
uint8 DONE=4
uint64 sequence
uint64 device_time_ns
float64 latitude_rad
float64 longitude_rad
float64 height_m
float64[3] velocity_mps
float64[4] q_nb
float64 nis
int32 command_azimuth
int32 command_roll
uint32 health
uint32 parameters_revision
uint16 stop
uint8 mode
bool moving
";

const INNOVATION_SCHEMA: &str = "\
# Innovation of a measurement, computed minus reference, north, east, down; its NIS is in the output.
# kind 0: velocity, m/s. kind 1: position, m. sigma: what the filter expects of it, same unit.
uint8 VELOCITY=0
uint8 POSITION=1
uint64 sequence
float64[3] innovation
float64[3] sigma
uint8 kind
";

const TRUTH_SCHEMA: &str = "\
# Truth at the stamp of the sample. q_nb: w, x, y, z.
uint64 time_ns
float64 latitude_rad
float64 longitude_rad
float64 height_m
float64[3] velocity_mps
float64[4] q_nb
float64 gimbal_azimuth_rad
float64 gimbal_roll_rad
";

const EVENT_SCHEMA: &str = r#"{
  "type": "object",
  "properties": {
    "kind": { "type": "string" },
    "detail": {}
  },
  "required": ["kind", "detail"]
}
"#;

/// Schema with one field for each parameter, so that a plotting tool shows them by name.
fn parameters_schema() -> String {
    let mut text = String::from(
        "# Coefficients of the error, measured minus true, SI: rad/s, rad, (rad/s)/(m/s^2), m/s^2.\n\
         # sigma_*: 1 sigma of each.\nuint64 sequence\n",
    );
    for prefix in ["", "sigma_"] {
        for name in NAMES {
            text.push_str("float64 ");
            text.push_str(prefix);
            text.push_str(name);
            text.push('\n');
        }
    }
    text.push_str("uint32 revision\n");
    text
}

const IMU_LENGTH: usize = 4 + 16 + 24 + 8 + 2;
const AIDING_LENGTH: usize = 4 + 8 + 24 + 1;
const OUTPUT_LENGTH: usize = 4 + 16 + 11 * 8 + 8 + 8 + 4;
const INNOVATION_LENGTH: usize = 4 + 8 + 2 * 24 + 1;
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
