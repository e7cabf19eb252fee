//! Tables of the fields of every payload.

use super::field::{Field, FieldType};
use crate::MessageKind;
use crate::message::Reason;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};

const fn field(
    at: usize,
    ty: FieldType,
    name: &'static str,
    unit: &'static str,
    about: &'static str,
) -> Field {
    Field { at, ty, name, lsb: 1.0, unit, values: &[], about }
}

const fn zero(at: usize, bytes: usize) -> Field {
    field(at, FieldType::Zero(bytes), "", "", "")
}

const fn choice(
    at: usize,
    name: &'static str,
    values: &'static [&'static str],
    about: &'static str,
) -> Field {
    Field { at, ty: FieldType::U8, name, lsb: 1.0, unit: "", values, about }
}

const fn count(
    at: usize,
    name: &'static str,
    lsb: f64,
    unit: &'static str,
    about: &'static str,
) -> Field {
    Field { at, ty: FieldType::I32, name, lsb, unit, values: &[], about }
}

const ROLES: &[&str] = &["harness", "device", "instrument"];
const PACINGS: &[&str] = &["lock_step", "real_time"];
const REFERENCES: &[&str] = &["velocity", "position"];
const MODES: &[&str] = &["aligning", "calibrating", "refused", "navigating", "done"];
const CONDITIONS: &[&str] = &["waiting", "ready", "stepping", "ended", "failed"];
const NO_YES: &[&str] = &["no", "yes"];

const HELLO: &[Field] = &[
    field(0, FieldType::U16, "version", "", "version that the sender speaks; never moves"),
    choice(2, "role", ROLES, "who sends"),
    choice(3, "pacing", PACINGS, "the harness chooses, the others repeat it"),
    field(4, FieldType::U32, "session", "", "drawn by the harness, not 0; the others repeat it"),
    field(8, FieldType::U32, "capabilities", "", "bits, see below"),
    field(12, FieldType::U64, "sample_period_ns", "ns", "sample period that it is configured with"),
    field(
        20,
        FieldType::U16,
        "window",
        "",
        "samples that it takes before it has answered the first",
    ),
    field(
        22,
        FieldType::U16,
        "silence_ms",
        "ms",
        "silence after which the other is gone; 0: never",
    ),
    field(24, FieldType::U32, "shortest_period_ns", "ns", "shortest sample period in real time"),
    field(
        28,
        FieldType::Bytes(32),
        "configuration",
        "",
        "hash of the configuration; zeros: not known",
    ),
    field(60, FieldType::Text(24), "name", "", "name of the sender"),
    field(84, FieldType::Text(24), "firmware", "", "its firmware or program, with version"),
];

const SAMPLE: &[Field] = &[
    field(
        0,
        FieldType::Step(Some("aided")),
        "step",
        "",
        "aided: an aiding of this step came before",
    ),
    field(2, FieldType::U16, "status", "", "bits, see below"),
    field(4, FieldType::U64, "sequence", "", "number of the sample"),
    field(
        12,
        FieldType::U64,
        "device_time_ns",
        "ns",
        "end of the interval, by the instrument's clock",
    ),
    count(20, "delta_theta_x", DELTA_THETA_LSB_RAD, "rad", "integrated angular rate, body x"),
    count(24, "delta_theta_y", DELTA_THETA_LSB_RAD, "rad", "the same, body y"),
    count(28, "delta_theta_z", DELTA_THETA_LSB_RAD, "rad", "the same, body z"),
    count(32, "delta_velocity_x", DELTA_VELOCITY_LSB_MPS, "m/s", "integrated specific force, x"),
    count(36, "delta_velocity_y", DELTA_VELOCITY_LSB_MPS, "m/s", "the same, body y"),
    count(40, "delta_velocity_z", DELTA_VELOCITY_LSB_MPS, "m/s", "the same, body z"),
    count(44, "azimuth", GIMBAL_LSB_RAD, "rad", "inner gimbal"),
    count(48, "roll", GIMBAL_LSB_RAD, "rad", "outer gimbal"),
];

const AIDING: &[Field] = &[
    field(0, FieldType::Step(None), "step", "", "of the sample that it goes with"),
    choice(2, "reference", REFERENCES, "what was measured"),
    zero(3, 1),
    field(4, FieldType::U64, "device_time_ns", "ns", "stamp of the reference"),
    field(12, FieldType::F64, "north_or_latitude", "m/s or rad", "velocity north, or latitude"),
    field(20, FieldType::F64, "east_or_longitude", "m/s or rad", "velocity east, or longitude"),
    field(28, FieldType::F64, "down_or_height", "m/s or m", "velocity down, or height"),
];

const OUTPUT: &[Field] = &[
    field(
        0,
        FieldType::Step(Some("parameters_follow")),
        "step",
        "",
        "of what it answers; parameters_follow: they changed, and follow",
    ),
    field(2, FieldType::U16, "stop", "", "stop of the sequence, from 0"),
    field(4, FieldType::U64, "sequence", "", "of the sample that it answers"),
    field(12, FieldType::U64, "device_time_ns", "ns", "of the sample that it answers"),
    choice(20, "mode", MODES, "mode after the step"),
    choice(21, "moving", NO_YES, "the gimbals are on their way to the stop"),
    zero(22, 2),
    field(24, FieldType::U32, "health", "", "bits, see below"),
    count(28, "azimuth_command", GIMBAL_LSB_RAD, "rad", "set point of the inner gimbal"),
    count(32, "roll_command", GIMBAL_LSB_RAD, "rad", "set point of the outer gimbal"),
    field(36, FieldType::U32, "parameters_revision", "", "how often the parameters have changed"),
    field(40, FieldType::U32, "computing_ns", "ns", "time the core took; 0: not measured"),
    field(44, FieldType::F64, "latitude", "rad", "geodetic latitude"),
    field(52, FieldType::F64, "longitude", "rad", "longitude, not wrapped"),
    field(60, FieldType::F64, "height", "m", "height above the ellipsoid"),
    field(68, FieldType::F64, "velocity_north", "m/s", "velocity over ground, north"),
    field(76, FieldType::F64, "velocity_east", "m/s", "the same, east"),
    field(84, FieldType::F64, "velocity_down", "m/s", "the same, down"),
    field(92, FieldType::F64, "attitude_w", "", "q_nb, Hamilton: takes a vector in body into n"),
    field(100, FieldType::F64, "attitude_x", "", ""),
    field(108, FieldType::F64, "attitude_y", "", ""),
    field(116, FieldType::F64, "attitude_z", "", ""),
    field(124, FieldType::F64, "nis", "", "normalized innovation squared; NaN: nothing measured"),
];

const PARAMETERS: &[Field] = &[
    field(0, FieldType::Step(None), "step", "", "of the output that announced them"),
    field(2, FieldType::U8, "segment", "", "which five of the thirty parameters: 0 to 5"),
    zero(3, 1),
    field(4, FieldType::U32, "revision", "", "parameters_revision of that output"),
    zero(8, 4),
    field(12, FieldType::F64, "value_0", "SI", "estimate of parameter 5 · segment"),
    field(20, FieldType::F64, "value_1", "SI", "and so on"),
    field(28, FieldType::F64, "value_2", "SI", ""),
    field(36, FieldType::F64, "value_3", "SI", ""),
    field(44, FieldType::F64, "value_4", "SI", ""),
    field(52, FieldType::F64, "sigma_0", "SI", "1σ of parameter 5 · segment"),
    field(60, FieldType::F64, "sigma_1", "SI", "and so on"),
    field(68, FieldType::F64, "sigma_2", "SI", ""),
    field(76, FieldType::F64, "sigma_3", "SI", ""),
    field(84, FieldType::F64, "sigma_4", "SI", ""),
];

const RESTART: &[Field; 2 + PARAMETER_COUNT] = &{
    let mut fields = [zero(2, 2); 2 + PARAMETER_COUNT];
    fields[0] = field(
        0,
        FieldType::Step(Some("offset")),
        "step",
        "",
        "offset: the stored parameters are off by what follows, else by nothing",
    );
    let mut i = 0;
    while i < PARAMETER_COUNT {
        fields[2 + i] = field(4 + 8 * i, FieldType::F64, NAMES[i], parameter_unit(i), "");
        i += 1;
    }
    fields
};

const STEP_ALONE: &[Field] = &[field(0, FieldType::Step(None), "step", "", ""), zero(2, 2)];

const HEARTBEAT: &[Field] = &[
    field(0, FieldType::Step(None), "step", "", "last step sent (harness), answered or made"),
    choice(2, "condition", CONDITIONS, "what the sender is about"),
    field(3, FieldType::U8, "queued", "", "samples that wait for their step"),
    field(4, FieldType::U64, "clock_ns", "ns", "the sender's clock"),
];

const STATUS: &[Field] = &[
    field(0, FieldType::Step(None), "step", "", "last step answered"),
    zero(2, 2),
    field(4, FieldType::U32, "steps", "", "steps done"),
    field(8, FieldType::U32, "repeated", "", "requests that came again and were answered again"),
    field(12, FieldType::U32, "skipped", "", "steps that never came: gaps in their numbers"),
    field(16, FieldType::U32, "aiding_missing", "", "samples whose announced aiding wasn't there"),
    field(20, FieldType::U32, "queue_full", "", "samples dropped because the queue was full"),
    field(24, FieldType::U32, "late", "", "steps that took longer than a sample period"),
    field(28, FieldType::U32, "received", "", "messages received"),
    field(32, FieldType::U32, "lost", "", "bytes (CAN: frames) that belong to no message"),
    field(36, FieldType::U32, "damaged", "", "frames (CAN: messages) that arrived damaged"),
    field(40, FieldType::U32, "missing", "", "frames (CAN: segments) that never arrived"),
    field(44, FieldType::U32, "out_of_order", "", "those that arrived again, or after later ones"),
    field(48, FieldType::U32, "unreadable", "", "intact ones that could not be understood"),
];

const TIME_REQUEST: &[Field] = &[
    field(0, FieldType::U16, "id", "", "tells requests apart"),
    zero(2, 2),
    field(4, FieldType::U64, "harness_sent_ns", "ns", "the harness's clock when it sent this"),
];

const TIME_REPLY: &[Field] = &[
    field(0, FieldType::U16, "id", "", "of the request"),
    zero(2, 2),
    field(4, FieldType::U64, "harness_sent_ns", "ns", "of the request"),
    field(12, FieldType::U64, "received_ns", "ns", "the replier's clock when the request arrived"),
    field(20, FieldType::U64, "sent_ns", "ns", "the replier's clock when it sent this"),
];

const BYE: &[Field] = &[
    choice(0, "reason", &Reason::NAMES, "why"),
    zero(1, 3),
    field(4, FieldType::Text(40), "text", "", "why, in words"),
];

pub(super) fn fields(kind: MessageKind) -> &'static [Field] {
    match kind {
        MessageKind::Hello => HELLO,
        MessageKind::Sample => SAMPLE,
        MessageKind::Aiding => AIDING,
        MessageKind::Output => OUTPUT,
        MessageKind::Parameters => PARAMETERS,
        MessageKind::Restart => RESTART,
        MessageKind::End | MessageKind::Ready => STEP_ALONE,
        MessageKind::Heartbeat => HEARTBEAT,
        MessageKind::Status => STATUS,
        MessageKind::TimeRequest => TIME_REQUEST,
        MessageKind::TimeReply => TIME_REPLY,
        MessageKind::Bye => BYE,
    }
}

pub(super) const fn parameter_unit(index: usize) -> &'static str {
    let mut i = 0;
    while i < ParameterGroup::ALL.len() {
        let group = ParameterGroup::ALL[i];
        let range = group.range();
        if range.start <= index && index < range.end {
            return match group {
                ParameterGroup::GyroBias => "rad/s",
                ParameterGroup::GyroScale | ParameterGroup::AccelScale => "",
                ParameterGroup::GyroMisalignment | ParameterGroup::AccelMisalignment => "rad",
                ParameterGroup::GDependent => "(rad/s)/(m/s2)",
                ParameterGroup::AccelBias => "m/s2",
            };
        }
        i += 1;
    }
    ""
}
