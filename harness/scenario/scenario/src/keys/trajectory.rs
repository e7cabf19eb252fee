//! Keys of an instrument's own solution, and of the trajectory that it is scored against.

use super::columns::{column, time_unit};
use super::definition::Kind;
use super::table::{At, Of, boolean, choice, integer, keys, text, time, within};
use crate::quantity::UnitDimension;
use crate::recorded::{Delimiter, RecordedColumn, TimeUnit};
use crate::trajectory::{HeadingTime, NmeaPoints};
use octant_instruments::navigation::NavigationProtocol;

use std::f64::consts::{PI, TAU};

/// Form of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TrajectoryForm {
    Csv,
    Nmea,
    Rtklib,
    Sbet,
    Messages(NavigationProtocol),
}

const BY_NAME: &str =
    "by the name's ending: nmea and nma; pos; sbet and out; others are columns of text";
const POINTS: &str =
    "headings, where the reference is true_heading or the file has no position; else positions";
const THERE: &str = "the name of Octant's exports, where the header has it";

/// Largest offset, s: from a clock that begins with zero to any time of GPS.
const OFFSET_MAX_S: f64 = 4e9;

/// Keys of a file with positions over time.
macro_rules! trajectory {
    ($(#[$attribute:meta])* $name:ident { $($more:tt)* }) => {
        keys! {
            $(#[$attribute])*
            pub(crate) struct $name {
                $($more)*
                format: Option<TrajectoryForm> = choice! {
                        "csv" => TrajectoryForm::Csv, "columns of text";
                        "nmea" => TrajectoryForm::Nmea, "sentences of NMEA 0183 (IEC 61162-1)";
                        "rtklib" => TrajectoryForm::Rtklib, "a solution of RTKLIB, .pos";
                        "sbet" => TrajectoryForm::Sbet, "a smoothed best estimate of trajectory, binary";
                        "novatel" => TrajectoryForm::Messages(NavigationProtocol::Novatel), "what a NovAtel receiver sent: INSPVA, INSPVAS or INSPVAX";
                        "sbg" => TrajectoryForm::Messages(NavigationProtocol::Sbg), "what an SBG unit sent: EKF_NAV, with EKF_EULER or EKF_QUAT and UTC_TIME";
                        "vectornav" => TrajectoryForm::Messages(NavigationProtocol::VectorNav), "what a VectorNav unit sent in binary, with its position";
                        "xsens" => TrajectoryForm::Messages(NavigationProtocol::Xsens), "what an Xsens unit sent as MTData2, with LatLon";
                    }, derived(BY_NAME), "What the file is.";
                talker: At<Option<String>> = text(), absent("all talkers, which have to agree"),
                    "NMEA: letters of the talker whose sentences count, such as IN; dates count from all. PASHR has no talker, and always counts.";
                points: At<Option<NmeaPoints>> = choice! {
                        "positions" => NmeaPoints::Positions, "positions, each with the heading behind it";
                        "headings" => NmeaPoints::Headings, "headings, each alone: position and velocity are not scored";
                    }, derived(POINTS),
                    "NMEA: sentences that make a point each.";
                heading_time: At<Option<HeadingTime>> = choice! {
                        "tag" => HeadingTime::Tag, "parameter c of the TAG block before the sentence (IEC 61162-450)";
                        "stamp" => HeadingTime::Stamp, "the date and time that a logger wrote before the sentence";
                        "cycle" => HeadingTime::Cycle, "sentences with a time of day, such as ZDA: the headings behind one are spread evenly to the next";
                    }, derived("the first of tag, stamp and cycle that the file has"),
                    "NMEA: time of headings without one, such as HDT and THS.";
                heading_rate: At<Option<f64>> = within(&[UnitDimension::FREQUENCY], 0.1, 1000.0, "from 0.1 Hz to 1 kHz"),
                    absent("they have times"),
                    "NMEA: even rate of headings in a file without any time. Sentences that are missing can't be seen.";
                heading_start: At<Option<String>> = text(), absent("0 s on a scale of its own"),
                    "NMEA: time of the first heading of heading_rate, such as 2027-03-31T08:00:00Z.";
                heading_delay: At<Option<f64>> = time(-86400.0, 86400.0, "from -1 day to 1 day"),
                    absent("not known: the time to the next one is in doubt"),
                    "NMEA: time from a time of day to the measurement of the first heading behind it that has no time; negative: it was measured before.";
                heading_delay_uncertainty: At<f64> = time(0.0, 10.0, "from 0 to 10 s"), "0 s",
                    "NMEA: how far heading_delay may be off, 95 %.";
                delimiter: Delimiter = choice! {
                        "whitespace" => Delimiter::Blanks, "any run of blanks and tabs";
                        "comma" => Delimiter::Character(b','), ",";
                        "semicolon" => Delimiter::Character(b';'), ";";
                        "tab" => Delimiter::Character(b'\t'), "one tab";
                    }, "comma", "Columns of text: what separates them.";
                skip_lines: usize = integer(0, 1_000_000), "0", "Columns of text: lines to skip at the start.";
                comment: String = text(), "#", "Columns of text: lines that start with this are skipped.";
                time_column: At<Option<RecordedColumn>> = column(), derived(THERE),
                    "Time of each row, in time_unit, or as 2027-03-31T08:00:00.5Z: its column, a name in the header or a number from 1.";
                time_unit: TimeUnit = time_unit(), "s", "Unit of a time that is a number.";
                latitude: At<Option<RecordedColumn>> = column(), derived(THERE), "Geodetic latitude.";
                longitude: At<Option<RecordedColumn>> = column(), derived(THERE), "Longitude, east of Greenwich.";
                height: At<Option<RecordedColumn>> = column(), derived(THERE), "Height above the ellipsoid, m.";
                north: At<Option<RecordedColumn>> = column(), derived(THERE), "Velocity over ground, north.";
                east: At<Option<RecordedColumn>> = column(), derived(THERE), "Velocity over ground, east.";
                heading: At<Option<RecordedColumn>> = column(), derived(THERE), "Heading from north by east.";
                pitch: At<Option<RecordedColumn>> = column(), derived(THERE), "Pitch, positive with the bow up.";
                roll: At<Option<RecordedColumn>> = column(), derived(THERE), "Roll, positive with the starboard side down.";
                sigma_north: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the position to the north, m.";
                sigma_east: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the position to the east, m.";
                sigma_velocity_north: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the velocity to the north, in velocity_unit.";
                sigma_velocity_east: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the velocity to the east, in velocity_unit.";
                sigma_roll: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the roll, in angle_unit.";
                sigma_pitch: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the pitch, in angle_unit.";
                sigma_heading: At<Option<RecordedColumn>> = column(), absent("not stated"), "Standard deviation of the heading, in angle_unit.";
                quality: At<Option<RecordedColumn>> = column(), absent("not stated"),
                    "Quality of a row, in words or numbers of its own, which the account counts.";
                quality_left_out: At<Vec<String>> = Of::<Vec<String>>::kind(Kind::Names), "[]",
                    "Qualities whose rows are left out, such as [\"0\", \"no fix\"].";
                angle_unit: At<String> = Of::<String>::kind(Kind::Choice(&[("deg", ""), ("rad", "")])), "deg",
                    "Unit of the columns of angles: position and attitude.";
                velocity_unit: At<String> = Of::<String>::kind(Kind::Choice(&[("m/s", ""), ("kn", ""), ("mm/s", "")])), "m/s",
                    "Unit of the columns of velocities.";
            }
        }
    };
}

trajectory! {
    /// `[source.solution]`.
    SolutionKeys {
        skip: f64 = time(0.0, 1e6, "from 0 to 1e6 s"), "0 s",
            "Time at its beginning that isn't scored, such as an alignment.";
        switched_on: At<Option<Vec<String>>> = Of::<Vec<String>>::kind(Kind::Names),
            absent("one run-up, from the first point on; a run with a port notes them itself"),
            "Heading test: times at which the unit was switched on, one for each run-up, such as [\"2027-03-31T08:00:00Z\"].";
        silence: f64 = time(0.0, 86400.0, "from 0 s to 1 day"), "10 s",
            "Of a port: time without a byte after which the run ends, and is inconclusive. 0 s: as long as it takes.";
        rehearsal: bool = boolean(), "false",
            "The time of a run with a port is that of the TAG blocks that a simulated unit sends. Always inconclusive.";
    }
}

trajectory! {
    /// `[source.trajectory]`.
    ReferenceTrajectoryKeys {
        file: At<Option<String>> = text(), absent("true_heading is the reference, or a heading test has none"), "Its file. Relative to the scenario.";
        true_heading: Option<f64> = within(&[UnitDimension::ANGLE], -TAU, TAU, "within ±360 deg"),
            absent("the reference is a file"),
            "Heading that was surveyed, as by a theodolite, of an instrument that stands still: it is the reference, instead of a file.";
        true_heading_uncertainty: At<Option<f64>> = within(&[UnitDimension::ANGLE], 0.0, PI, "from 0 to 180 deg"),
            absent("that of [decision]"), "How far true_heading may be off, 95 %.";
        offset: Option<f64> = time(-OFFSET_MAX_S, OFFSET_MAX_S, "from -4e9 to 4e9 s"),
            absent("0 s, if both files tell the time on a scale that is known; else it has to be given"),
            "What is added to the solution's times to get those of this file.";
        offset_uncertainty: f64 = time(0.0, 60.0, "from 0 to 60 s"), "0 s",
            "How far that may be wrong, 95 %: what moves by it is in doubt, and so are the verdicts.";
        gap: f64 = time(1e-3, 3600.0, "from 1 ms to 1 h"), "2 s",
            "Rows further apart than this have a gap between them, in which nothing is scored.";
    }
}
