//! Keys of the source: the plant, a recording, text files of a real instrument.

use super::definition::{Bounds, Default, Key, Kind, Section, key, section};
use super::fmu::SOURCE_FMU;
use crate::quantity::Dimension;

pub(crate) static SOURCE: Section = section(&[
    key(
        "uri",
        Kind::Uri(&[
            ("plant", "simulated"),
            ("replay", "a recording of this program or another MCAP file: replay:FILE"),
            ("text", "columns of numbers: text:FILE"),
            (
                "fmu",
                "an FMU: Octant's plant, another instrument, or the ship under the plant: fmu:FILE",
            ),
            ("serial", "an instrument on a serial line: serial:/dev/ttyUSB0?baud=921600"),
            ("udp", "an instrument that sends to a UDP port of this host: udp:HOST:PORT"),
            ("can", "an instrument on a CAN interface: can:can0"),
            (
                "slcan",
                "one behind a CAN adapter on a serial line: slcan:/dev/ttyACM0?bitrate=500000",
            ),
        ]),
        Default::Value("plant"),
        "Where samples come from. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.",
    ),
    key(
        "text",
        Kind::Table(&TEXT),
        Default::Derived("needed by text:FILE"),
        "How the text files are read.",
    ),
    key(
        "mcap",
        Kind::Table(&MCAP),
        Default::Derived("replay: the channels that this program writes"),
        "Which channels and fields of another program's MCAP file are read.",
    ),
    key(
        "fmu",
        Kind::Table(&SOURCE_FMU),
        Default::Derived("fmu: the defaults of its keys"),
        "How the FMU of source.uri is run, and what its variables are.",
    ),
    key(
        "live",
        Kind::Table(&SOURCE_LIVE),
        Default::Derived("serial, udp, can and slcan: the defaults of its keys"),
        "What the instrument of source.uri speaks, and how it is mounted.",
    ),
]);

pub(crate) static SOURCE_LIVE: Section = section(&[
    key(
        "protocol",
        Kind::Choice(&crate::choices::PROTOCOLS),
        Default::Derived("\"octant\"; on a CAN bus \"dbc\""),
        "What the instrument speaks.",
    ),
    key(
        "database",
        Kind::Text,
        Default::Absent("needed by protocol = \"dbc\""),
        "The maker's CAN database, a DBC file. Relative to the scenario.",
    ),
    key(
        "mapping",
        Kind::Text,
        Default::Absent("needed by protocol = \"dbc\""),
        "Which signals of the database are which channels, a TOML file. Relative to the scenario.",
    ),
    key(
        "axes",
        Kind::Text,
        Default::Value("x y z"),
        "Which axes of the instrument body x, y and z are, with a minus for the opposite: x -y -z.",
    ),
    key(
        "silence",
        Kind::Quantity(&[Dimension::TIME], Bounds::Within(1e-3, 3600.0, "from 1 ms to 1 h")),
        Default::Value("5 s"),
        "How long a reading is waited for; then the instrument is gone.",
    ),
]);

static TEXT: Section = section(&[
    key(
        "rate",
        Kind::Quantity(&[Dimension::FREQUENCY], Bounds::Within(1.0, 10e3, "from 1 Hz to 10 kHz")),
        Default::Derived("imu.rate divided by split"),
        "Nominal rate of the rows: times split, it is imu.rate.",
    ),
    SPLIT,
    key(
        "delimiter",
        Kind::Choice(&[
            ("whitespace", "any run of blanks and tabs"),
            ("comma", ","),
            ("semicolon", ";"),
            ("tab", "one tab"),
        ]),
        Default::Value("whitespace"),
        "What separates columns.",
    ),
    key(
        "skip_lines",
        Kind::Integer(0, 1_000_000),
        Default::Value("0"),
        "Lines to skip at the start.",
    ),
    key(
        "header",
        Kind::Boolean,
        Default::Value("false"),
        "Whether the first line after those skipped names the columns.",
    ),
    key("comment", Kind::Text, Default::Value("#"), "Lines that start with this are skipped."),
    key("time_column", Kind::Column, Default::Value("1"), "Column of the time stamp."),
    key(
        "time_unit",
        Kind::Choice(&[
            ("s", "seconds"),
            ("ms", "milliseconds"),
            ("us", "microseconds"),
            ("ns", "nanoseconds"),
        ]),
        Default::Value("s"),
        "Unit of the time stamp.",
    ),
    key("gyro", Kind::Table(&GYRO), Default::Required, "Columns of the gyros."),
    key(
        "accelerometer",
        Kind::Table(&ACCELEROMETER),
        Default::Required,
        "Columns of the accelerometers.",
    ),
    key(
        "gimbal",
        Kind::Table(&GIMBAL),
        Default::Absent("no gimbals: their angles are flagged invalid"),
        "Columns of the gimbal angles, in the gyro's file.",
    ),
]);

const SPLIT: Key = key(
    "split",
    Kind::Integer(1, crate::recorded::SPLIT_MAX as i64),
    Default::Value("1"),
    "Samples that a row or message becomes, equal parts of its interval, so that counts hold faster rates (179 deg/s at 100 Hz, 358 deg/s at 200 Hz).",
);
const FILE_DOC: &str = "File of these columns, where it isn't that of source.uri.";
const AXES: Kind = Kind::Choices(&["x", "-x", "y", "-y", "z", "-z"]);
const AXES_DOC: &str = "Which instrument axis, with its sign, lies along body x, y and z.";
const QUANTITY: Kind = Kind::Choice(&[
    ("rate", "a rate or specific force"),
    ("increment", "its integral over the sample's interval"),
]);
const SCALE_DOC: &str =
    "Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale.";

pub(crate) static GYRO: Section = section(&[
    key("file", Kind::Text, Default::Absent("the file of source.uri"), FILE_DOC),
    key("x", Kind::Column, Default::Required, "Column of x: its number from 1, or its name."),
    key("y", Kind::Column, Default::Required, "Column of y."),
    key("z", Kind::Column, Default::Required, "Column of z."),
    key(
        "unit",
        Kind::Choice(&[
            ("rad/s", ""),
            ("deg/s", ""),
            ("deg/h", ""),
            ("rad", ""),
            ("deg", ""),
            ("arcsec", ""),
        ]),
        Default::Value("rad/s"),
        "Unit after scaling: of a rate, or of an angle for increments.",
    ),
    key("quantity", QUANTITY, Default::Value("rate"), "Rates or increments."),
    key("scale", Kind::Numbers(3), Default::Value("[1.0, 1.0, 1.0]"), SCALE_DOC),
    key(
        "offset",
        Kind::Numbers(3),
        Default::Value("[0.0, 0.0, 0.0]"),
        "Raw number of zero, x, y, z.",
    ),
    key("axes", AXES, Default::Value(r#"["x", "y", "z"]"#), AXES_DOC),
]);

pub(crate) static ACCELEROMETER: Section = section(&[
    key("file", Kind::Text, Default::Absent("the file of source.uri"), FILE_DOC),
    key("x", Kind::Column, Default::Required, "Column of x: its number from 1, or its name."),
    key("y", Kind::Column, Default::Required, "Column of y."),
    key("z", Kind::Column, Default::Required, "Column of z."),
    key(
        "unit",
        Kind::Choice(&[("m/s^2", ""), ("g", ""), ("mg", ""), ("m/s", ""), ("mm/s", "")]),
        Default::Value("m/s^2"),
        "Unit after scaling: of specific force, or of a velocity for increments.",
    ),
    key("quantity", QUANTITY, Default::Value("rate"), "Specific force or increments."),
    key("scale", Kind::Numbers(3), Default::Value("[1.0, 1.0, 1.0]"), SCALE_DOC),
    key(
        "offset",
        Kind::Numbers(3),
        Default::Value("[0.0, 0.0, 0.0]"),
        "Raw number of zero, x, y, z.",
    ),
    key("axes", AXES, Default::Value(r#"["x", "y", "z"]"#), AXES_DOC),
]);

static GIMBAL: Section = section(&[
    key("azimuth", Kind::Column, Default::Required, "Column of the inner gimbal."),
    key("roll", Kind::Column, Default::Required, "Column of the outer gimbal."),
    key(
        "unit",
        Kind::Choice(&[("deg", ""), ("rad", ""), ("arcsec", "")]),
        Default::Value("deg"),
        "Unit of both.",
    ),
]);

static MCAP: Section = section(&[
    key("topic", Kind::Text, Default::Required, "Topic of the inertial samples."),
    key(
        "time_field",
        Kind::Text,
        Default::Derived("the message's log time"),
        "Dotted name of the field with the time stamp, a number.",
    ),
    key(
        "nanoseconds_field",
        Kind::Text,
        Default::Absent("the time stamp is one number"),
        "Dotted name of a field with nanoseconds to add, as stamps of ROS have them.",
    ),
    key(
        "time_unit",
        Kind::Choice(&[
            ("s", "seconds"),
            ("ms", "milliseconds"),
            ("us", "microseconds"),
            ("ns", "nanoseconds"),
        ]),
        Default::Value("ns"),
        "Unit of the time stamp.",
    ),
    key(
        "rate",
        Kind::Quantity(&[Dimension::FREQUENCY], Bounds::Within(1.0, 10e3, "from 1 Hz to 10 kHz")),
        Default::Derived("imu.rate divided by split"),
        "Nominal rate of the messages: times split, it is imu.rate.",
    ),
    SPLIT,
    key("gyro", Kind::Table(&MCAP_GYRO), Default::Required, "Fields of the gyros."),
    key(
        "accelerometer",
        Kind::Table(&MCAP_ACCELEROMETER),
        Default::Required,
        "Fields of the accelerometers.",
    ),
]);

static MCAP_GYRO: Section = section(&[
    key("x", Kind::Text, Default::Required, "Dotted name of the field of x."),
    key("y", Kind::Text, Default::Required, "Field of y."),
    key("z", Kind::Text, Default::Required, "Field of z."),
    key(
        "unit",
        Kind::Choice(&[
            ("rad/s", ""),
            ("deg/s", ""),
            ("deg/h", ""),
            ("rad", ""),
            ("deg", ""),
            ("arcsec", ""),
        ]),
        Default::Value("rad/s"),
        "Unit after scaling.",
    ),
    key("quantity", QUANTITY, Default::Value("rate"), "Rates or increments."),
    key("scale", Kind::Numbers(3), Default::Value("[1.0, 1.0, 1.0]"), SCALE_DOC),
    key(
        "offset",
        Kind::Numbers(3),
        Default::Value("[0.0, 0.0, 0.0]"),
        "Raw number of zero, x, y, z.",
    ),
    key("axes", AXES, Default::Value(r#"["x", "y", "z"]"#), AXES_DOC),
]);

static MCAP_ACCELEROMETER: Section = section(&[
    key("x", Kind::Text, Default::Required, "Dotted name of the field of x."),
    key("y", Kind::Text, Default::Required, "Field of y."),
    key("z", Kind::Text, Default::Required, "Field of z."),
    key(
        "unit",
        Kind::Choice(&[("m/s^2", ""), ("g", ""), ("mg", ""), ("m/s", ""), ("mm/s", "")]),
        Default::Value("m/s^2"),
        "Unit after scaling.",
    ),
    key("quantity", QUANTITY, Default::Value("rate"), "Specific force or increments."),
    key("scale", Kind::Numbers(3), Default::Value("[1.0, 1.0, 1.0]"), SCALE_DOC),
    key(
        "offset",
        Kind::Numbers(3),
        Default::Value("[0.0, 0.0, 0.0]"),
        "Raw number of zero, x, y, z.",
    ),
    key("axes", AXES, Default::Value(r#"["x", "y", "z"]"#), AXES_DOC),
]);
