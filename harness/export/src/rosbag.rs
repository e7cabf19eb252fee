//! MCAP with standard messages of ROS 2, and the messages that a live run publishes.
//!
//! | topic | message | content |
//! |---|---|---|
//! | `/imu/data` | `sensor_msgs/Imu` | rates and specific force of a sample, mean of its interval; attitude of the core |
//! | `/fix` | `sensor_msgs/NavSatFix` | solution of the core |
//! | `/velocity` | `geometry_msgs/Vector3Stamped` | velocity of the core, east, north, up, m/s |
//! | `/truth/fix`, `/truth/velocity` | the same | truth |
//! | `/error/position`, `/error/velocity` | `geometry_msgs/Vector3Stamped` | navigation minus truth, east, north, up, m and m/s |
//! | `/error/attitude` | `geometry_msgs/Vector3Stamped` | rotation vector, east, north, up, rad |
//! | `/octant/…` | JSON | as `octant run --live` publishes |
//!
//! Axes are those of REP 103. Covariances are marked as unknown where the recording has none.

use super::attitude;
use super::error::ExportFailure;
use super::job::{EXPORT_VERSION, Job, NewFile};
use super::resample::Grid;
use super::ros::{RosMessage, RosType, enu, flu, orientation};
use super::rows::{NavigationErrors, each_item, is_solution};
use mcap::records::{MessageHeader, Metadata};
use octant_recorder::message::Topic;
use octant_recorder::reader::Item;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Output, Sample, Status, Truth};
use octant_watch::about::About;
use octant_watch::published::{PublishedChannel, faults, messages};
use octant_watch::state::RunState;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Frame of inertial samples.
const BODY: &str = "imu_link";
/// Frame of positions, velocities and errors.
const LOCAL: &str = "enu";

/// Topics with standard messages.
const TOPICS: [(&str, RosType); 8] = [
    ("/imu/data", RosType::Imu),
    ("/fix", RosType::NavSatFix),
    ("/velocity", RosType::Vector3Stamped),
    ("/truth/fix", RosType::NavSatFix),
    ("/truth/velocity", RosType::Vector3Stamped),
    ("/error/position", RosType::Vector3Stamped),
    ("/error/velocity", RosType::Vector3Stamped),
    ("/error/attitude", RosType::Vector3Stamped),
];

/// Writes the file.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let interval_s = interval_s(&job.choice.recording)?;
    let new = NewFile::create(job.out, job.force)?;
    let mut bag = Bag::begin(job, new.file()?, interval_s).map_err(|error| new.format(error))?;
    let folder = job.choice.recording.parent().unwrap_or(Path::new(""));
    let mut state = RunState::new(About::of(&job.info, folder));
    bag.json(PublishedChannel::Faults, 0, &faults(&state)).map_err(|error| new.format(error))?;
    let mut samples = Grid::new(job.choice.every_ns);
    let mut outputs = Grid::new(job.choice.every_ns);
    let mut epoch = Joined::default();
    each_item(&job.choice.recording, &mut |time_ns, item| {
        let topic = item.topic();
        if topic != Topic::Event {
            if epoch.last.is_some_and(|last| time_ns != epoch.time_ns || topic <= last) {
                bag.epoch(&epoch).map_err(|error| new.format(error))?;
                epoch = Joined::default();
            }
            epoch.last = Some(topic);
            epoch.time_ns = time_ns;
        }
        state.take(time_ns, &item);
        match &item {
            Item::Sample(sample) => epoch.sample = Some(*sample).filter(|_| samples.keeps(time_ns)),
            Item::Output(output) => {
                epoch.q_nb = attitude::unit(&output.navigation.q_nb).map(|q| orientation(&q));
                epoch.output = Some(*output).filter(|_| outputs.keeps(time_ns));
            }
            Item::Truth(truth) => epoch.truth = Some(*truth),
            _ => {}
        }
        // Parameters, faults and pacing are rare; what belongs to an output comes with it.
        let is_rare = matches!(item, Item::Parameters(..) | Item::Event(_));
        let mut failed = None;
        if is_rare || epoch.output.is_some() {
            messages(&state, &item, |channel, message| {
                if failed.is_none() {
                    failed = bag.json(channel, time_ns, &message).err();
                }
            });
        }
        failed.map_or(Ok(()), |error| Err(new.format(error)))
    })?;
    bag.epoch(&epoch).map_err(|error| new.format(error))?;
    bag.mcap.finish().map_err(|error| new.format(error))?;
    drop(bag);
    Ok(vec![new.finish()?])
}

/// Interval of the samples, s, from the first two of the recording with their numbers: those between them may not be
/// recorded.
fn interval_s(path: &Path) -> Result<Option<f64>, ExportFailure> {
    let wrong = |source| ExportFailure::Recording { path: path.to_owned(), source };
    let mut recording = octant_recorder::reader::Recording::open(path).map_err(wrong)?;
    let mut first: Option<Sample> = None;
    while let Some((_, item)) = recording.next_item().map_err(wrong)? {
        let Item::Sample(sample) = item else { continue };
        let Some(first) = &first else {
            first = Some(sample);
            continue;
        };
        let numbers = sample.sequence.checked_sub(first.sequence).filter(|n| *n > 0);
        let time_ns = sample.device_time.ns.checked_sub(first.device_time.ns).filter(|t| *t > 0);
        if let Some((numbers, time_ns)) = numbers.zip(time_ns) {
            return Ok(Some(time_ns as f64 / 1e9 / numbers as f64));
        }
    }
    Ok(None)
}

/// Messages of one epoch.
#[derive(Default)]
struct Joined {
    time_ns: u64,
    last: Option<Topic>,
    sample: Option<Sample>,
    output: Option<Output>,
    /// Attitude of the core, in the axes of ROS.
    q_nb: Option<[f64; 4]>,
    truth: Option<Truth>,
}

/// File under construction.
struct Bag {
    mcap: mcap::Writer<BufWriter<File>>,
    ros: [u16; TOPICS.len()],
    live: Vec<u16>,
    interval_s: Option<f64>,
    sequence: u32,
}

impl Bag {
    fn begin(job: &Job<'_>, file: File, interval_s: Option<f64>) -> Result<Self, mcap::McapError> {
        let mut mcap = mcap::WriteOptions::new()
            .profile("ros2")
            .library(concat!("octant ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(BufWriter::new(file))?;
        let mut metadata = BTreeMap::from([
            ("version".to_owned(), EXPORT_VERSION.to_string()),
            ("octant".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("stamps".to_owned(), "run time, ns since the start of the run".to_owned()),
            ("axes".to_owned(), "REP 103: east, north, up; forward, left, up".to_owned()),
        ]);
        metadata
            .extend(job.info.run.iter().map(|(key, value)| (format!("run.{key}"), value.clone())));
        mcap.write_metadata(&Metadata { name: "octant.export".to_owned(), metadata })?;
        let mut schemas = BTreeMap::new();
        let mut ros = [0; TOPICS.len()];
        for (place, (topic, kind)) in ros.iter_mut().zip(TOPICS) {
            let schema = match schemas.get(&kind) {
                Some(schema) => *schema,
                None => mcap.add_schema(kind.name(), "ros2msg", kind.definition().as_bytes())?,
            };
            schemas.insert(kind, schema);
            *place = mcap.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        }
        let mut live = Vec::new();
        for channel in PublishedChannel::ALL {
            let text = channel.schema().to_string();
            let schema = mcap.add_schema(channel.schema_name(), "jsonschema", text.as_bytes())?;
            live.push(mcap.add_channel(schema, channel.topic(), "json", &BTreeMap::new())?);
        }
        Ok(Self { mcap, ros, live, interval_s, sequence: 0 })
    }

    fn put(&mut self, channel_id: u16, time_ns: u64, bytes: &[u8]) -> Result<(), mcap::McapError> {
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.mcap.write_to_known_channel(&header, bytes)
    }

    fn json(
        &mut self,
        channel: PublishedChannel,
        time_ns: u64,
        message: &serde_json::Value,
    ) -> Result<(), mcap::McapError> {
        self.put(self.live[channel as usize], time_ns, message.to_string().as_bytes())
    }

    fn epoch(&mut self, epoch: &Joined) -> Result<(), mcap::McapError> {
        let time_ns = epoch.time_ns;
        if let Some(sample) = &epoch.sample {
            self.imu(time_ns, sample, epoch.q_nb)?;
        }
        let Some(output) = &epoch.output else { return Ok(()) };
        let navigation = &output.navigation;
        let position = [navigation.latitude_rad, navigation.longitude_rad, navigation.height_m];
        let is_solution = is_solution(output.mode);
        self.fix(1, time_ns, position, is_solution)?;
        if is_solution {
            self.vector(2, time_ns, enu(navigation.velocity_mps))?;
        }
        let Some(truth) = &epoch.truth else { return Ok(()) };
        self.fix(3, time_ns, [truth.latitude_rad, truth.longitude_rad, truth.height_m], true)?;
        self.vector(4, time_ns, enu(truth.velocity_mps))?;
        if is_solution {
            let errors = NavigationErrors::of(output, truth);
            self.vector(5, time_ns, enu(errors.position_ned_m))?;
            self.vector(6, time_ns, enu(errors.velocity_ned_mps))?;
            if let Some(attitude) = errors.attitude_ned_rad {
                self.vector(7, time_ns, enu(attitude))?;
            }
        }
        Ok(())
    }

    /// Writes the mean rates of a sample's interval. A sample that the instrument marks as invalid, or whose interval
    /// is unknown, has none.
    fn imu(
        &mut self,
        time_ns: u64,
        sample: &Sample,
        q_xyzw: Option<[f64; 4]>,
    ) -> Result<(), mcap::McapError> {
        let Some(interval_s) = self.interval_s else { return Ok(()) };
        if sample.status.contains(Status::INERTIAL_INVALID) {
            return Ok(());
        }
        let rate = |count: i32, lsb: f64| f64::from(count) * lsb / interval_s;
        let mut message = RosMessage::new(time_ns, BODY);
        // The first element is −1 where there is no orientation; zeros are an unknown covariance.
        let mut covariance = [0.0; 9];
        if q_xyzw.is_none() {
            covariance[0] = -1.0;
        }
        message.numbers(&q_xyzw.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        message.numbers(&covariance);
        message.numbers(&flu(sample.delta_theta.map(|count| rate(count, DELTA_THETA_LSB_RAD))));
        message.numbers(&[0.0; 9]);
        message
            .numbers(&flu(sample.delta_velocity.map(|count| rate(count, DELTA_VELOCITY_LSB_MPS))));
        message.numbers(&[0.0; 9]);
        self.put(self.ros[0], time_ns, message.bytes())
    }

    fn fix(
        &mut self,
        topic: usize,
        time_ns: u64,
        [latitude_rad, longitude_rad, height_m]: [f64; 3],
        is_fix: bool,
    ) -> Result<(), mcap::McapError> {
        let mut message = RosMessage::new(time_ns, LOCAL);
        // STATUS_FIX or STATUS_NO_FIX, of no satellites.
        message.put(&(if is_fix { 0i8 } else { -1 }).to_le_bytes());
        message.put(&0u16.to_le_bytes());
        message.numbers(&[latitude_rad.to_degrees(), longitude_rad.to_degrees(), height_m]);
        message.numbers(&[0.0; 9]);
        // COVARIANCE_TYPE_UNKNOWN.
        message.put(&[0u8]);
        self.put(self.ros[topic], time_ns, message.bytes())
    }

    fn vector(
        &mut self,
        topic: usize,
        time_ns: u64,
        vector: [f64; 3],
    ) -> Result<(), mcap::McapError> {
        let mut message = RosMessage::new(time_ns, LOCAL);
        message.numbers(&vector);
        self.put(self.ros[topic], time_ns, message.bytes())
    }
}
