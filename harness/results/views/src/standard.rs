//! Standard messages of ROS 2 about an epoch.
//!
//! | topic | message | content |
//! |---|---|---|
//! | `/imu/data` | `sensor_msgs/Imu` | rates and specific force of a sample, mean of its interval; attitude of the core |
//! | `/fix` | `sensor_msgs/NavSatFix` | solution of the core |
//! | `/velocity` | `geometry_msgs/Vector3Stamped` | velocity of the core, east, north, up, m/s |
//! | `/truth/fix`, `/truth/velocity` | the same | truth |
//! | `/error/position`, `/error/velocity` | `geometry_msgs/Vector3Stamped` | navigation minus truth, east, north, up, m and m/s |
//! | `/error/attitude` | `geometry_msgs/Vector3Stamped` | rotation vector, east, north, up, rad |
//!
//! Axes are those of REP 103. Position and orientation have the covariance of the filter in epochs
//! with a measurement, about the axes east, north, up; everywhere else a covariance is marked as
//! unknown, as the definitions of the messages say.

use super::ros::{RosMessage, RosType, enu, enu_covariance, flu, orientation};
use super::solution::{NavigationErrors, is_solution, unit_attitude};
use octant_recorder::further::{FurtherChannel, FurtherMessages};
use octant_recorder::reader::Item;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{NavigationCovariance, Output, Sample, Status, Truth};

/// Frame of inertial samples.
const BODY: &str = "imu_link";
/// Frame of positions, velocities and errors.
const LOCAL: &str = "enu";

/// COVARIANCE_TYPE_UNKNOWN of a `NavSatFix`.
const COVARIANCE_UNKNOWN: u8 = 0;
/// COVARIANCE_TYPE_KNOWN of a `NavSatFix`.
const COVARIANCE_KNOWN: u8 = 3;

/// Topic with standard messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardTopic {
    /// A sample, and the attitude of the core.
    Imu,
    /// Position of the core.
    Fix,
    /// Velocity of the core.
    Velocity,
    /// True position.
    TrueFix,
    /// True velocity.
    TrueVelocity,
    /// Position error.
    PositionError,
    /// Velocity error.
    VelocityError,
    /// Attitude error.
    AttitudeError,
}

impl StandardTopic {
    /// All topics.
    pub const ALL: [Self; 8] = [
        Self::Imu,
        Self::Fix,
        Self::Velocity,
        Self::TrueFix,
        Self::TrueVelocity,
        Self::PositionError,
        Self::VelocityError,
        Self::AttitudeError,
    ];

    /// Topics of recordings and live runs. What the others have follows from these.
    pub const BRIEF: [Self; 5] =
        [Self::Imu, Self::Fix, Self::PositionError, Self::VelocityError, Self::AttitudeError];

    /// Name of the topic.
    #[must_use]
    pub const fn topic(self) -> &'static str {
        match self {
            Self::Imu => "/imu/data",
            Self::Fix => "/fix",
            Self::Velocity => "/velocity",
            Self::TrueFix => "/truth/fix",
            Self::TrueVelocity => "/truth/velocity",
            Self::PositionError => "/error/position",
            Self::VelocityError => "/error/velocity",
            Self::AttitudeError => "/error/attitude",
        }
    }

    /// Channel of the topic.
    #[must_use]
    pub fn channel(self) -> FurtherChannel {
        let kind = match self {
            Self::Imu => RosType::Imu,
            Self::Fix | Self::TrueFix => RosType::NavSatFix,
            _ => RosType::Vector3Stamped,
        };
        FurtherChannel {
            topic: self.topic(),
            schema_name: kind.name(),
            schema_encoding: "ros2msg",
            schema: kind.definition(),
            message_encoding: "cdr",
        }
    }
}

/// Joins the messages of a recording into epochs, and makes their standard messages.
#[derive(Debug)]
pub struct StandardEpochs {
    /// Chosen topics, each with the number of its channel.
    topics: Vec<(StandardTopic, usize)>,
    /// Interval of the samples, s.
    interval_s: Option<f64>,
    /// Log time of the epoch, ns.
    time_ns: u64,
    sample: Option<Sample>,
    output: Option<Output>,
    covariance: Option<NavigationCovariance>,
    truth: Option<Truth>,
}

impl StandardEpochs {
    /// Makes messages on these topics, on channels of the numbers from `first` on. Without the period of
    /// the samples, ns, there are none of these.
    #[must_use]
    pub fn new(topics: &[StandardTopic], first: usize, sample_period_ns: Option<u64>) -> Self {
        Self {
            topics: topics.iter().copied().zip(first..).collect(),
            interval_s: sample_period_ns.map(|period_ns| period_ns as f64 / 1e9),
            time_ns: 0,
            sample: None,
            output: None,
            covariance: None,
            truth: None,
        }
    }

    /// Takes a message of the present epoch, with its log time.
    pub fn take(&mut self, time_ns: u64, item: &Item) {
        // Events are no part of an epoch.
        if !matches!(item, Item::Event(_)) {
            self.time_ns = time_ns;
        }
        match item {
            Item::Sample(sample) => self.sample = Some(*sample),
            Item::Output(output) => self.output = Some(*output),
            Item::Covariance(_, covariance) => self.covariance = Some(*covariance),
            Item::Truth(truth) => self.truth = Some(*truth),
            Item::CleanSample(_)
            | Item::CleanAiding(_)
            | Item::Aiding(_)
            | Item::Innovation(..)
            | Item::Parameters(..)
            | Item::Event(_) => {}
        }
    }

    /// Ends the epoch, and makes its messages if it is due.
    pub fn end(&mut self, is_due: bool, messages: &mut FurtherMessages) {
        if is_due {
            for (topic, channel) in &self.topics {
                self.message(*topic, *channel, messages);
            }
        }
        self.sample = None;
        self.output = None;
        self.covariance = None;
        self.truth = None;
    }

    fn message(&self, topic: StandardTopic, channel: usize, messages: &mut FurtherMessages) {
        let solution = self.output.filter(|output| is_solution(output.mode));
        let errors = solution.zip(self.truth.as_ref());
        let errors = || errors.map(|(output, truth)| NavigationErrors::of(&output, truth));
        let vector = match topic {
            StandardTopic::Imu => return self.imu(channel, messages),
            StandardTopic::Fix => return self.fix(channel, messages),
            // Truth stands beside an output.
            StandardTopic::TrueFix => {
                if let (Some(truth), Some(_)) = (&self.truth, &self.output) {
                    let place = [truth.latitude_rad, truth.longitude_rad, truth.height_m];
                    self.place(channel, place, (true, None), messages);
                }
                return;
            }
            StandardTopic::Velocity => solution.map(|output| output.navigation.velocity_mps),
            StandardTopic::TrueVelocity => {
                self.truth.filter(|_| self.output.is_some()).map(|truth| truth.velocity_mps)
            }
            StandardTopic::PositionError => errors().map(|errors| errors.position_ned_m),
            StandardTopic::VelocityError => errors().map(|errors| errors.velocity_ned_mps),
            StandardTopic::AttitudeError => errors().and_then(|errors| errors.attitude_ned_rad),
        };
        if let Some(vector) = vector {
            messages.add(channel, |bytes| {
                RosMessage::new(bytes, self.time_ns, LOCAL).numbers(&enu(vector));
            });
        }
    }

    /// Makes the message of the mean rates of a sample's interval. A sample that the instrument marks
    /// as invalid, or whose interval is unknown, has none.
    fn imu(&self, channel: usize, messages: &mut FurtherMessages) {
        let valid = self.sample.filter(|sample| !sample.status.contains(Status::INERTIAL_INVALID));
        let (Some(sample), Some(interval_s)) = (valid, self.interval_s) else { return };
        let rate = |count: i32, lsb: f64| f64::from(count) * lsb / interval_s;
        let q_nb = self.output.and_then(|output| unit_attitude(&output.navigation.q_nb));
        // The first element is −1 where there is no orientation; zeros are an unknown covariance.
        let covariance = match (&q_nb, &self.covariance) {
            (None, _) => [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            (Some(_), None) => [0.0; 9],
            (Some(_), Some(covariance)) => enu_covariance(covariance.attitude_rad2),
        };
        let q_xyzw = q_nb.map_or([0.0, 0.0, 0.0, 1.0], |q_nb| orientation(&q_nb));
        messages.add(channel, |bytes| {
            let mut message = RosMessage::new(bytes, self.time_ns, BODY);
            message.numbers(&q_xyzw);
            message.numbers(&covariance);
            message.numbers(&flu(sample.delta_theta.map(|count| rate(count, DELTA_THETA_LSB_RAD))));
            message.numbers(&[0.0; 9]);
            let lsb = DELTA_VELOCITY_LSB_MPS;
            message.numbers(&flu(sample.delta_velocity.map(|count| rate(count, lsb))));
            message.numbers(&[0.0; 9]);
        });
    }

    /// Makes the message of the core's position.
    fn fix(&self, channel: usize, messages: &mut FurtherMessages) {
        let Some(output) = &self.output else { return };
        let navigation = &output.navigation;
        let place = [navigation.latitude_rad, navigation.longitude_rad, navigation.height_m];
        let is_fix = is_solution(output.mode);
        let covariance = self.covariance.filter(|_| is_fix).map(|found| found.position_m2);
        self.place(channel, place, (is_fix, covariance), messages);
    }

    fn place(
        &self,
        channel: usize,
        [latitude_rad, longitude_rad, height_m]: [f64; 3],
        (is_fix, covariance_ned_m2): (bool, Option<[f64; 6]>),
        messages: &mut FurtherMessages,
    ) {
        messages.add(channel, |bytes| {
            let mut message = RosMessage::new(bytes, self.time_ns, LOCAL);
            // STATUS_FIX or STATUS_NO_FIX, of no satellites.
            message.put(&(if is_fix { 0i8 } else { -1 }).to_le_bytes());
            message.put(&0u16.to_le_bytes());
            message.numbers(&[latitude_rad.to_degrees(), longitude_rad.to_degrees(), height_m]);
            message.numbers(&covariance_ned_m2.map_or([0.0; 9], enu_covariance));
            let kind =
                if covariance_ned_m2.is_some() { COVARIANCE_KNOWN } else { COVARIANCE_UNKNOWN };
            message.put(&[kind]);
        });
    }
}
