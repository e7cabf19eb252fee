//! Keys of the source: the plant, a recording, text files of a real instrument.

use super::columns::{column, temperature_unit, time_unit};
use super::definition::{Bounds, Kind};
use super::fmu::SourceFmuKeys;
use super::table::{
    At, Of, boolean, choice, integer, keys, number, numbers, si, table, text, time, within,
};
use super::trajectory::{ReferenceTrajectoryKeys, SolutionKeys};
use crate::quantity::UnitDimension;
use crate::recorded::{
    Delimiter, RecordedColumn, RecordedQuantity, SPLIT_MAX, TemperatureUnit, TimeUnit,
};
use octant_instruments::StampScale;

keys! {
    /// `[source]`.
    pub(crate) struct SourceKeys {
        uri: At<String> = Of::<String>::kind(Kind::Uri(&[
            ("plant", "simulated"),
            ("replay", "a recording of this program or another MCAP file: replay:FILE"),
            ("text", "columns of numbers: text:FILE"),
            (
                "solution",
                "no samples: an instrument's own solution, which is scored: solution:FILE, or solution:serial:PORT, solution:udp:… and solution:tcp:… of one that sends it now",
            ),
            ("log", "the bytes that an instrument sent, as a file: log:FILE"),
            (
                "fmu",
                "an FMU: Octant's plant, another instrument, or the ship under the plant: fmu:FILE",
            ),
            (
                "serial",
                "an instrument on a serial line: serial:/dev/ttyUSB0?baud=921600 (the default rate)",
            ),
            ("udp", "an instrument that sends to a UDP port of this host: udp:HOST:PORT"),
            (
                "tcp",
                "an instrument on TCP, or the server of its serial line: tcp:HOST:PORT, to which this host connects; tcp:HOST:PORT?listen=1 where the instrument connects",
            ),
            ("can", "an instrument on a CAN interface: can:can0"),
            (
                "slcan",
                "one behind a CAN adapter on a serial line: slcan:/dev/ttyACM0?bitrate=500000",
            ),
        ])), "plant",
            "Where samples come from. A file name is relative to the scenario, and may start with ${OCTANT_RECORDINGS}.";
        text: At<Option<TextKeys>> = table::<TextKeys>(), derived("needed by text:FILE"),
            "How the text files are read.";
        mcap: Option<McapKeys>
            = table::<McapKeys>(), derived("replay: the channels that this program writes"),
            "Which channels and fields of another program's MCAP file are read.";
        fmu: Option<SourceFmuKeys>
            = table::<SourceFmuKeys>(), derived("fmu: the defaults of its keys"),
            "How the FMU of source.uri is run, and what its variables are.";
        reference: At<Option<SourceReferenceKeys>>
            = table::<SourceReferenceKeys>(),
            absent("the source brings its own, or there is none"),
            "The reference of a calibration, where the source brings none: what is known of the motion of text, another program's MCAP file or an instrument on a port, or what was measured and recorded beside the samples.";
        solution: Option<SolutionKeys>
            = table::<SolutionKeys>(), derived("solution: the defaults of its keys"),
            "How the solution of source.uri is read.";
        trajectory: At<Option<ReferenceTrajectoryKeys>>
            = table::<ReferenceTrajectoryKeys>(), absent("needed by solution:FILE, besides a heading test that has none"),
            "The reference trajectory that a solution is scored against.";
        dither: At<Option<f64>> = number(Bounds::Within(0.05, 1.0, "between 0.05 and 1")), absent("nothing is added"),
            "Noise that the harness adds to the samples of an instrument whose own noise isn't known, from the seed, in parts of imu.angle_random_walk and imu.velocity_random_walk: shows whether the unit follows its samples. Their noise grows by the root of 1 + dither².";
        live: Option<SourceLiveKeys>
            = table::<SourceLiveKeys>(),
            derived("serial, udp, tcp, can and slcan: the defaults of its keys"),
            "What the instrument of source.uri speaks, and how it is mounted.";
        log: At<Option<SourceLogKeys>>
            = table::<SourceLogKeys>(), derived("needed by log:FILE"),
            "What the instrument spoke whose bytes source.uri names, and how it was mounted.";
    }
}

/// Reference of a source that brings none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ReferenceKind {
    Static,
    Velocity,
    Position,
}

const REFERENCE_FILE: &str = "the gyros' file";
const AS_TEXT: &str = "a file of its own: as source.text";

keys! {
    /// `[source.reference]`.
    pub(crate) struct SourceReferenceKeys {
        kind: At<ReferenceKind> = choice! {
                "static" => ReferenceKind::Static, "the instrument stands at the site: zero velocity and a fixed position, as procedure.calibration.aiding says, whose sigma is the filter's";
                "velocity" => ReferenceKind::Velocity, "a velocity over ground that was measured: columns of a text file, fields of a topic";
                "position" => ReferenceKind::Position, "a position that was measured, likewise";
            }, "static",
            "What is known, or was measured.";
        north: At<Option<RecordedColumn>> = column(), absent("needed by kind = \"velocity\""),
            "Velocity north: its column, number from 1 or name; in an MCAP file the dotted name of its field.";
        east: At<Option<RecordedColumn>> = column(), absent("needed by kind = \"velocity\""),
            "Velocity east.";
        down: At<Option<RecordedColumn>> = column(), absent("up is given"),
            "Velocity down.";
        up: At<Option<RecordedColumn>> = column(), absent("down is given"),
            "Velocity up, in place of down.";
        latitude: At<Option<RecordedColumn>> = column(), absent("needed by kind = \"position\""),
            "Geodetic latitude.";
        longitude: At<Option<RecordedColumn>> = column(), absent("needed by kind = \"position\""),
            "Longitude, east of Greenwich.";
        height: At<Option<RecordedColumn>> = column(), absent("needed by kind = \"position\""),
            "Height above the ellipsoid, m.";
        unit: At<String>
            = Of::<String>::kind(Kind::Choice(&[
                ("m/s", "of a velocity"), ("mm/s", "of a velocity"), ("kn", "of a velocity"),
                ("deg", "of latitude and longitude"), ("rad", "of latitude and longitude"),
            ])), derived("velocity: \"m/s\"; position: \"deg\""),
            "Unit of the velocities, or of latitude and longitude.";
        file: At<Option<String>> = text(), absent(REFERENCE_FILE),
            "Text: file of these columns, with stamps of the same clock. Relative to the scenario.";
        delimiter: Delimiter = choice! {
                "whitespace" => Delimiter::Blanks, "any run of blanks and tabs";
                "comma" => Delimiter::Character(b','), ",";
                "semicolon" => Delimiter::Character(b';'), ";";
                "tab" => Delimiter::Character(b'\t'), "one tab";
            }, derived(AS_TEXT), "What separates columns.";
        skip_lines: usize = integer(0, 1_000_000), derived(AS_TEXT), "Lines to skip at the start.";
        header: bool = boolean(), derived(AS_TEXT),
            "Whether the first line after those skipped names the columns.";
        comment: String = text(), derived(AS_TEXT), "Lines that start with this are skipped.";
        time_column: At<RecordedColumn> = column(), derived("text: that of source.text"),
            "Column of the time at which the reference was measured.";
        topic: At<Option<String>> = text(), absent("needed in an MCAP file"),
            "Topic of the reference's messages.";
        time_field: Option<String> = text(), derived("the message's log time"),
            "Dotted name of the field with the time at which the reference was measured.";
        nanoseconds_field: At<Option<String>> = text(), absent("the time stamp is one number"),
            "Dotted name of a field with nanoseconds to add.";
        time_unit: TimeUnit = time_unit(), derived("text: that of source.text; MCAP: ns"),
            "Unit of the time stamp.";
    }
}

const AXES_DOC: &str =
    "Which axes of the instrument body x, y and z are, with a minus for the opposite: x -y -z.";
const DESCRIPTION_DOC: &str = "Description of the unit's frames: a TOML file, relative to the scenario, or the name of one that comes with Octant, such as kvh-1775-rate.";
const GYRO_COUNT_DOC: &str = "Angle of one gyro count of a NovAtel receiver's unit, in place of the table's, for a kind that the table lacks; with accel_count.";
const ACCEL_COUNT_DOC: &str = "Velocity of one accelerometer count, likewise.";

keys! {
    /// `[source.live]`.
    pub(crate) struct SourceLiveKeys {
        protocol: At<String> = Of::<String>::kind(Kind::Choice(&crate::choices::PROTOCOLS)), derived("\"octant\"; on a CAN bus \"dbc\""),
            "What the instrument speaks.";
        database: At<Option<String>> = text(), absent("needed by protocol = \"dbc\""),
            "The maker's CAN database, a DBC file. Relative to the scenario.";
        mapping: At<Option<String>> = text(), absent("needed by protocol = \"dbc\""),
            "Which signals of the database are which channels, a TOML file. Relative to the scenario.";
        description: At<Option<String>> = text(), absent("needed by protocol = \"described\""),
            DESCRIPTION_DOC;
        axes: At<String> = text(), "x y z",
            AXES_DOC;
        gyro_count: At<Option<f64>> = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), absent("by the kind of unit"),
            GYRO_COUNT_DOC;
        accel_count: At<Option<f64>> = si(&[UnitDimension::VELOCITY], Bounds::Positive), absent("by the kind of unit"),
            ACCEL_COUNT_DOC;
        silence: f64 = time(1e-3, 3600.0, "from 1 ms to 1 h"), "5 s",
            "How long a reading is waited for; then the instrument is gone.";
        pps: Option<String> = text(), absent("samples have the time of their arrival"),
            "Pulses at the whole seconds of the unit's stamps (1PPS), which give samples their time: a device such as /dev/pps0, or a file of the kernel's form.";
        pps_edge: bool = choice! {
                "assert" => false, "the edge that the kernel calls assert";
                "clear" => true, "the other one";
            }, "assert",
            "Edge of the pulse at which the second begins.";
        pps_silence: f64 = time(2.0, 3600.0, "from 2 s to 1 h"), "10 s",
            "How long a pulse is waited for; then the run ends.";
        stamps: At<Option<StampScale>> = choice! {
                "own" => None, "a clock of the unit's own";
                "utc" => Some(StampScale::Utc), "UTC since 1970";
                "tai" => Some(StampScale::Tai), "TAI since 1970, as PTP has it";
                "gps" => Some(StampScale::Gps), "GPS time since 6 January 1980";
            }, "own",
            "Time scale of the unit's stamps. By a known one a stamp is the time itself.";
        stamps_within: Option<f64> = time(0.0, 0.1, "from 0 s to 100 ms"), absent("20 us with source.live.pps, the latency of an interrupt"),
            "Bound of the error of the stamps; with source.live.pps of the time between a whole second of them and the kernel's stamp of its pulse. It is part of the uncertainty of a sample's time.";
        host_clock: Option<String> = text(), absent("the host's realtime clock"),
            "Clock of a network card that PTP keeps at TAI, such as /dev/ptp0, by which the stamps are related to the host's time.";
        host_within: Option<f64> = time(0.0, 0.1, "from 0 s to 100 ms"), absent("what the kernel says of its realtime clock, which has to be synchronised"),
            "Bound of the error of the host's clock, with source.live.stamps.";
        tai_offset: Option<u32> = integer::<u32>(10, 100), absent("the kernel's"),
            "Seconds by which TAI is ahead of UTC, for stamps by tai and gps: 37 since 2017.";
    }
}

keys! {
    /// `[source.log]`.
    pub(crate) struct SourceLogKeys {
        protocol: At<String> = Of::<String>::kind(Kind::Choice(&crate::choices::LINES)), required,
            "What the instrument spoke.";
        description: At<Option<String>> = text(), absent("needed by protocol = \"described\""),
            DESCRIPTION_DOC;
        axes: At<String> = text(), "x y z",
            AXES_DOC;
        gyro_count: At<Option<f64>> = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), absent("by the kind of unit"),
            GYRO_COUNT_DOC;
        accel_count: At<Option<f64>> = si(&[UnitDimension::VELOCITY], Bounds::Positive), absent("by the kind of unit"),
            ACCEL_COUNT_DOC;
    }
}

keys! {
    /// `[source.text]`.
    pub(crate) struct TextKeys {
        rate: At<f64>
            = within(&[UnitDimension::FREQUENCY], 1.0, 10e3, "from 1 Hz to 10 kHz"),
            derived("imu.rate divided by split"),
            "Nominal rate of the rows: times split, it is imu.rate.";
        split: u32 = integer(1, SPLIT_MAX as i64), "1", SPLIT_DOC;
        delimiter: Delimiter = choice! {
                "whitespace" => Delimiter::Blanks, "any run of blanks and tabs";
                "comma" => Delimiter::Character(b','), ",";
                "semicolon" => Delimiter::Character(b';'), ";";
                "tab" => Delimiter::Character(b'\t'), "one tab";
            }, "whitespace",
            "What separates columns.";
        skip_lines: usize = integer(0, 1_000_000), "0", "Lines to skip at the start.";
        header: bool = boolean(), "false",
            "Whether the first line after those skipped names the columns.";
        comment: String = text(), "#", "Lines that start with this are skipped.";
        time_column: At<RecordedColumn> = column(), "1",
            "Column of the time stamp, in time_unit or such as 2027-03-31T08:00:00.5Z; \"none\": rows without one, which follow each other at the nominal rate.";
        time_unit: TimeUnit = time_unit(), "s", "Unit of the time stamp.";
        temperature_column: At<Option<RecordedColumn>> = column(), absent("the file has no temperature"),
            "Column of the instrument's temperature, in the gyro's file; octant characterise reads it.";
        temperature_unit: TemperatureUnit = temperature_unit(), "degC", "Unit of the temperature.";
        gyro: GyroKeys = table(), required, "Columns of the gyros.";
        accelerometer: AccelerometerKeys = table(), required, "Columns of the accelerometers.";
        gimbal: Option<GimbalKeys>
            = table::<GimbalKeys>(), absent("no gimbals: their angles are flagged invalid"),
            "Columns of the gimbal angles, in the gyro's file.";
    }
}

const SPLIT_DOC: &str = "Samples that a row or message becomes, equal parts of its interval, so that counts hold faster rates (179 deg/s at 100 Hz, 358 deg/s at 200 Hz).";
const FILE_DOC: &str = "File of these columns, where it isn't that of source.uri.";

/// Conversion of a sensor's raw numbers, whatever they come from.
pub(crate) struct SignalKeys<'a> {
    pub(crate) unit: &'a At<String>,
    pub(crate) quantity: &'a At<RecordedQuantity>,
    pub(crate) scale: &'a At<[f64; 3]>,
    pub(crate) offset: &'a [f64; 3],
    pub(crate) axes: &'a At<Vec<String>>,
}

/// Keys of a sensor: where its numbers are, and their conversion.
macro_rules! sensor {
    ($(#[$attribute:meta])* $name:ident { $($columns:tt)+ }
     $unit:literal [$($units:literal)+] $unit_doc:literal, $quantity_doc:literal) => {
        keys! {
            $(#[$attribute])*
            pub(crate) struct $name {
                $($columns)+
                unit: At<String> = Of::<String>::kind(Kind::Choice(&[$(($units, "")),+])), $unit, $unit_doc;
                quantity: At<RecordedQuantity> = choice! {
                        "rate" => RecordedQuantity::Rates, "a rate or specific force";
                        "increment" => RecordedQuantity::Increments, "its integral over the sample's interval";
                    }, "rate", $quantity_doc;
                scale: At<[f64; 3]> = numbers(), "[1.0, 1.0, 1.0]",
                    "Unit per raw number, x, y, z, before axes are exchanged: value = (raw − offset) · scale.";
                offset: [f64; 3] = numbers(), "[0.0, 0.0, 0.0]", "Raw number of zero, x, y, z.";
                axes: At<Vec<String>> = Of::<Vec<String>>::kind(Kind::Choices(&["x", "-x", "y", "-y", "z", "-z"])),
                    r#"["x", "y", "z"]"#,
                    "Which instrument axis, with its sign, lies along body x, y and z.";
            }
        }

        impl $name {
            pub(crate) fn signal(&self) -> SignalKeys<'_> {
                let Self { unit, quantity, scale, offset, axes, .. } = self;
                SignalKeys { unit, quantity, scale, offset, axes }
            }
        }
    };
}
sensor! {
    /// `[source.text.gyro]`.
    GyroKeys {
        file: Option<String> = text(), absent("the file of source.uri"), FILE_DOC;
        x: At<RecordedColumn> = column(), required, "Column of x: its number from 1, or its name.";
        y: At<RecordedColumn> = column(), required, "Column of y.";
        z: At<RecordedColumn> = column(), required, "Column of z.";
    }
    "rad/s" ["rad/s" "deg/s" "deg/h" "rad" "deg" "arcsec"]
        "Unit after scaling: of a rate, or of an angle for increments.", "Rates or increments."
}

sensor! {
    /// `[source.text.accelerometer]`.
    AccelerometerKeys {
        file: Option<String> = text(), absent("the file of source.uri"), FILE_DOC;
        x: At<RecordedColumn> = column(), required, "Column of x: its number from 1, or its name.";
        y: At<RecordedColumn> = column(), required, "Column of y.";
        z: At<RecordedColumn> = column(), required, "Column of z.";
    }
    "m/s^2" ["m/s^2" "g" "mg" "m/s" "mm/s"]
        "Unit after scaling: of specific force, or of a velocity for increments.", "Specific force or increments."
}

keys! {
    /// `[source.text.gimbal]`.
    pub(crate) struct GimbalKeys {
        azimuth: At<RecordedColumn> = column(), required, "Column of the inner gimbal.";
        roll: At<RecordedColumn> = column(), required, "Column of the outer gimbal.";
        unit: At<String>
            = Of::<String>::kind(Kind::Choice(&[("deg", ""), ("rad", ""), ("arcsec", "")])), "deg",
            "Unit of both.";
    }
}

keys! {
    /// `[source.mcap]`.
    pub(crate) struct McapKeys {
        topic: String = text(), required, "Topic of the inertial samples, or of the gyros.";
        time_field: Option<String> = text(), derived("the message's log time"),
            "Dotted name of the field with the time stamp, a number.";
        nanoseconds_field: At<Option<String>> = text(), absent("the time stamp is one number"),
            "Dotted name of a field with nanoseconds to add, as stamps of ROS have them.";
        time_unit: TimeUnit = time_unit(), "ns", "Unit of the time stamp.";
        temperature_field: Option<String> = text(), absent("the messages have no temperature"),
            "Dotted name of the field with the instrument's temperature; octant characterise reads it.";
        temperature_unit: TemperatureUnit = temperature_unit(), "degC", "Unit of the temperature.";
        rate: At<f64>
            = within(&[UnitDimension::FREQUENCY], 1.0, 10e3, "from 1 Hz to 10 kHz"),
            derived("imu.rate divided by split"),
            "Nominal rate of the messages: times split, it is imu.rate.";
        split: u32 = integer(1, SPLIT_MAX as i64), "1", SPLIT_DOC;
        gyro: McapGyroKeys = table(), required, "Fields of the gyros.";
        accelerometer: McapAccelerometerKeys = table(), required, "Fields of the accelerometers.";
    }
}

sensor! {
    /// `[source.mcap.gyro]`.
    McapGyroKeys {
        x: String = text(), required, "Dotted name of the field of x.";
        y: String = text(), required, "Field of y.";
        z: String = text(), required, "Field of z.";
    }
    "rad/s" ["rad/s" "deg/s" "deg/h" "rad" "deg" "arcsec"]
        "Unit after scaling.", "Rates or increments."
}

sensor! {
    /// `[source.mcap.accelerometer]`.
    McapAccelerometerKeys {
        topic: Option<String> = text(), derived("source.mcap.topic"),
            "Topic of the accelerometers, where it isn't that of the gyros: messages with equal stamps are taken together.";
        x: String = text(), required, "Dotted name of the field of x.";
        y: String = text(), required, "Field of y.";
        z: String = text(), required, "Field of z.";
    }
    "m/s^2" ["m/s^2" "g" "mg" "m/s" "mm/s"]
        "Unit after scaling.", "Specific force or increments."
}
