//! Messages of ROS 2: their definitions, and their fields as CDR.
//!
//! The definitions are the standard ones: `sensor_msgs/Imu`, `sensor_msgs/NavSatFix` and
//! `geometry_msgs/Vector3Stamped` with what they contain. CDR is plain version 1, little-endian (OMG DDS-XTypes): each
//! field is aligned to its size, counted from the end of the four bytes of encapsulation.

use nalgebra::{Quaternion, UnitQuaternion};

/// Type of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RosType {
    /// `sensor_msgs/Imu`.
    Imu,
    /// `sensor_msgs/NavSatFix`.
    NavSatFix,
    /// `geometry_msgs/Vector3Stamped`.
    Vector3Stamped,
}

/// Line between a definition and those that it contains.
pub(super) const SEPARATOR: &str =
    "================================================================================\n";

pub(super) const TIME: &str = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
pub(super) const HEADER: &str =
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
const VECTOR3: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const QUATERNION: &str = "MSG: geometry_msgs/Quaternion\n\
    float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const NAV_SAT_STATUS: &str = "MSG: sensor_msgs/NavSatStatus\n\
    int8 STATUS_NO_FIX = -1\nint8 STATUS_FIX = 0\nint8 STATUS_SBAS_FIX = 1\nint8 STATUS_GBAS_FIX = 2\n\
    int8 status\nuint16 SERVICE_GPS = 1\nuint16 SERVICE_GLONASS = 2\nuint16 SERVICE_COMPASS = 4\n\
    uint16 SERVICE_GALILEO = 8\nuint16 service\n";

impl RosType {
    /// Name of the type in ROS 2.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Imu => "sensor_msgs/msg/Imu",
            Self::NavSatFix => "sensor_msgs/msg/NavSatFix",
            Self::Vector3Stamped => "geometry_msgs/msg/Vector3Stamped",
        }
    }

    /// Definition in the form `ros2msg` of MCAP.
    #[must_use]
    pub fn definition(self) -> String {
        let (own, parts) = match self {
            Self::Imu => (
                "std_msgs/Header header\n\
                 geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
                 geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
                 geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
                &[HEADER, TIME, QUATERNION, VECTOR3][..],
            ),
            Self::NavSatFix => (
                "std_msgs/Header header\nsensor_msgs/NavSatStatus status\n\
                 float64 latitude\nfloat64 longitude\nfloat64 altitude\nfloat64[9] position_covariance\n\
                 uint8 COVARIANCE_TYPE_UNKNOWN = 0\nuint8 COVARIANCE_TYPE_APPROXIMATED = 1\n\
                 uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2\nuint8 COVARIANCE_TYPE_KNOWN = 3\n\
                 uint8 position_covariance_type\n",
                &[HEADER, TIME, NAV_SAT_STATUS][..],
            ),
            Self::Vector3Stamped => (
                "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n",
                &[HEADER, TIME, VECTOR3][..],
            ),
        };
        let mut text = own.to_owned();
        for part in parts {
            text.push_str(SEPARATOR);
            text.push_str(part);
        }
        text
    }
}

/// Message that is appended to a buffer.
pub struct RosMessage<'a> {
    bytes: &'a mut Vec<u8>,
    /// End of the encapsulation, from which alignment counts.
    start: usize,
}

/// Encapsulation of little-endian plain CDR.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl<'a> RosMessage<'a> {
    /// Begins a message with its header.
    pub fn new(bytes: &'a mut Vec<u8>, time_ns: u64, frame_id: &str) -> Self {
        bytes.extend_from_slice(&ENCAPSULATION);
        let start = bytes.len();
        let mut message = Self { bytes, start };
        // Run time of 68 years is beyond every run; a larger one stays at the largest.
        let seconds = i32::try_from(time_ns / 1_000_000_000).unwrap_or(i32::MAX);
        message.put(&seconds.to_le_bytes());
        message.put(&((time_ns % 1_000_000_000) as u32).to_le_bytes());
        message.text(frame_id);
        message
    }

    /// Appends a text, with its end.
    pub fn text(&mut self, text: &str) {
        self.put(&(text.len() as u32 + 1).to_le_bytes());
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    /// Appends a field at a multiple of its size.
    pub fn put<const N: usize>(&mut self, field: &[u8; N]) {
        let at = (self.bytes.len() - self.start).next_multiple_of(N) + self.start;
        self.bytes.resize(at, 0);
        self.bytes.extend_from_slice(field);
    }

    /// Appends numbers of eight bytes.
    pub fn numbers(&mut self, values: &[f64]) {
        values.iter().for_each(|value| self.put(&value.to_le_bytes()));
    }
}

/// Vector of axes forward, right, down in the axes of REP 103: forward, left, up.
#[must_use]
pub fn flu([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, -z]
}

/// Vector of axes north, east, down in the axes of REP 103: east, north, up.
#[must_use]
pub fn enu([north, east, down]: [f64; 3]) -> [f64; 3] {
    [east, north, -down]
}

/// Covariance of a vector of axes north, east, down, by its upper triangle, as the nine elements of that
/// of axes east, north, up.
#[must_use]
pub fn enu_covariance([nn, ne, nd, ee, ed, dd]: [f64; 6]) -> [f64; 9] {
    [ee, ne, -ed, ne, nn, -nd, -ed, -nd, dd]
}

/// Attitude of REP 103, x y z w: takes a vector in forward, left, up into east, north, up.
#[must_use]
pub fn orientation(q_nb: &UnitQuaternion<f64>) -> [f64; 4] {
    let half = core::f64::consts::FRAC_1_SQRT_2;
    // Half turns: about the line between north and east, and about the forward axis.
    let enu_of_ned = Quaternion::new(0.0, half, half, 0.0);
    let frd_of_flu = Quaternion::new(0.0, 1.0, 0.0, 0.0);
    let q = enu_of_ned * q_nb.quaternion() * frd_of_flu;
    [q.i, q.j, q.k, q.w]
}
