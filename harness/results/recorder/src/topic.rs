//! Topics of a recording and their schemas.

use octant_sample::parameters::NAMES;

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
    /// Covariance of the solution after a measurement.
    Covariance,
    /// Estimated parameters with their σ.
    Parameters,
    /// Truth.
    Truth,
    /// Rare events, JSON.
    Event,
}

impl Topic {
    /// All topics.
    pub const ALL: [Self; 10] = [
        Self::ImuClean,
        Self::AidingClean,
        Self::Aiding,
        Self::Imu,
        Self::Output,
        Self::Innovation,
        Self::Covariance,
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
            Self::Covariance => "/covariance",
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
            Self::Covariance => "octant_msgs/msg/Covariance",
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
            Self::Covariance => COVARIANCE_SCHEMA.into(),
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

const COVARIANCE_SCHEMA: &str = "\
# Covariance of the filter after a measurement, axes north, east, down: upper triangles by rows,
# north-north, north-east, north-down, east-east, east-down, down-down. m^2, (m/s)^2, rad^2.
uint64 sequence
float64[6] position_m2
float64[6] velocity_m2ps2
float64[6] attitude_rad2
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
