//! Messages of a run as messages of ROS 2: the fields of [`published`](super::published), in CDR.
//!
//! Their types are those of the package `octant_msgs`, whose definitions are in the file: no package has to be
//! installed. A number that a message in JSON leaves out, or that is null there, is NaN.

use super::published::PublishedChannel;
use super::ros::{HEADER, RosMessage, SEPARATOR, TIME};
use octant_recorder::further::FurtherChannel;
use octant_sample::parameters::NAMES;
use serde_json::Value;

/// Kind of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FieldKind {
    /// `float64`.
    Number,
    /// `uint64`; 0 where there is none.
    Count,
    /// `bool`.
    Flag,
    /// `string`.
    Text,
    /// `string[]`.
    Texts,
    /// `octant_msgs/Parameter`.
    Parameter,
    /// `octant_msgs/Fault[]`.
    Faults,
}

use FieldKind::{Count, Faults, Flag, Number, Parameter, Text, Texts};

const PARAMETER: [(&str, FieldKind); 2] = [("value", Number), ("sigma", Number)];
const FAULT: [(&str, FieldKind); 5] =
    [("id", Text), ("kind", Text), ("when", Text), ("acts", Flag), ("firings", Count)];

/// Fields of a message behind its header, in their order.
fn fields(channel: PublishedChannel) -> Vec<(&'static str, FieldKind)> {
    match channel {
        PublishedChannel::State => vec![
            ("time_s", Number),
            ("done_percent", Number),
            ("mode", Text),
            ("mode_number", Count),
            ("stop", Count),
            ("position", Count),
            ("moving", Flag),
            ("health", Texts),
            ("health_bits", Count),
        ],
        PublishedChannel::Error => {
            ["latitude_arcmin", "longitude_arcmin", "radial_nmi"].map(|name| (name, Number)).into()
        }
        PublishedChannel::Parameters => NAMES.map(|name| (name, Parameter)).into(),
        PublishedChannel::Gimbals => {
            ["azimuth_deg", "roll_deg", "command_azimuth_deg", "command_roll_deg"]
                .map(|name| (name, Number))
                .into()
        }
        PublishedChannel::Nis => ["nis", "mean"].map(|name| (name, Number)).into(),
        PublishedChannel::Pacing => vec![
            ("samples", Count),
            ("latest_us", Number),
            ("overruns", Count),
            ("late_answers", Count),
        ],
        PublishedChannel::Faults => {
            vec![("armed", Count), ("fired", Count), ("acting", Count), ("faults", Faults)]
        }
    }
}

/// Definition of fields.
fn definition(fields: &[(&str, FieldKind)]) -> String {
    let line = |(name, kind): &(&str, FieldKind)| {
        let kind = match kind {
            Number => "float64",
            Count => "uint64",
            Flag => "bool",
            Text => "string",
            Texts => "string[]",
            Parameter => "octant_msgs/Parameter",
            Faults => "octant_msgs/Fault[]",
        };
        format!("{kind} {name}\n")
    };
    fields.iter().map(line).collect()
}

/// Returns the channel of messages in CDR.
#[must_use]
pub fn ros_channel(channel: PublishedChannel) -> FurtherChannel {
    let own = fields(channel);
    let mut text = format!("std_msgs/Header header\n{}", definition(&own));
    let mut part = |part: &str| {
        text.push_str(SEPARATOR);
        text.push_str(part);
    };
    part(HEADER);
    part(TIME);
    if own.iter().any(|(_, kind)| *kind == Parameter) {
        part(&format!("MSG: octant_msgs/Parameter\n{}", definition(&PARAMETER)));
    }
    if own.iter().any(|(_, kind)| *kind == Faults) {
        part(&format!("MSG: octant_msgs/Fault\n{}", definition(&FAULT)));
    }
    FurtherChannel {
        topic: channel.topic(),
        schema_name: match channel {
            PublishedChannel::State => "octant_msgs/msg/State",
            PublishedChannel::Error => "octant_msgs/msg/NavigationError",
            PublishedChannel::Parameters => "octant_msgs/msg/Parameters",
            PublishedChannel::Gimbals => "octant_msgs/msg/Gimbals",
            PublishedChannel::Nis => "octant_msgs/msg/Nis",
            PublishedChannel::Pacing => "octant_msgs/msg/Pacing",
            PublishedChannel::Faults => "octant_msgs/msg/Faults",
        },
        schema_encoding: "ros2msg",
        schema: text,
        message_encoding: "cdr",
    }
}

/// Appends a message in CDR.
pub fn write(channel: PublishedChannel, time_ns: u64, message: &Value, bytes: &mut Vec<u8>) {
    let mut to = RosMessage::new(bytes, time_ns, "");
    write_fields(&fields(channel), message, &mut to);
}

fn write_fields(fields: &[(&str, FieldKind)], message: &Value, to: &mut RosMessage<'_>) {
    for (name, kind) in fields {
        let value = &message[*name];
        let entries = || value.as_array().map(Vec::as_slice).unwrap_or_default();
        match kind {
            Number => to.numbers(&[value.as_f64().unwrap_or(f64::NAN)]),
            Count => to.put(&value.as_u64().unwrap_or(0).to_le_bytes()),
            Flag => to.put(&[u8::from(value.as_bool().unwrap_or(false))]),
            Text => to.text(value.as_str().unwrap_or("")),
            Texts => {
                to.put(&(entries().len() as u32).to_le_bytes());
                entries().iter().for_each(|text| to.text(text.as_str().unwrap_or("")));
            }
            Parameter => write_fields(&PARAMETER, value, to),
            Faults => {
                to.put(&(entries().len() as u32).to_le_bytes());
                entries().iter().for_each(|fault| write_fields(&FAULT, fault, to));
            }
        }
    }
}
