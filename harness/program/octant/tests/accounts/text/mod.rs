//! Text: rates and increments, whole and damaged.

mod forms;
mod gaps;
mod rates;
mod times;

use super::rest::{COUNT, RATE_HZ, Rest, readings, scenario};
use super::table::{Case, Counts, Ends, Part};
use std::fmt::Write;

const FILE: &str = "unit.csv";
const HEADER: &str = "t,gx,gy,gz,ax,ay,az\n";
pub const SOURCE: &str = "uri = \"text:unit.csv\"
[source.text]
header = true
delimiter = \"comma\"
time_column = \"t\"
time_unit = \"s\"
[source.text.gyro]
x = \"gx\"
y = \"gy\"
z = \"gz\"
unit = \"rad/s\"
quantity = \"rate\"
[source.text.accelerometer]
x = \"ax\"
y = \"ay\"
z = \"az\"
unit = \"m/s^2\"
quantity = \"rate\"
";
/// Settings for columns of increments.
const INCREMENTS: [&str; 4] = [
    "source.text.gyro.unit=rad",
    "source.text.gyro.quantity=increment",
    "source.text.accelerometer.unit=\"m/s\"",
    "source.text.accelerometer.quantity=increment",
];
/// Scenario for rows without stamps.
fn untimed() -> String {
    scenario(&SOURCE.replace(
        "time_column = \"t\"\ntime_unit = \"s\"",
        "time_column = \"none\"\nrate = \"50 Hz\"",
    ))
}

/// Number of rows at the beginning whose distance from the fit isn't counted.
const UNSETTLED: u64 = 11;

/// Rows with stamps in s.
pub fn csv(rows: &[Rest]) -> String {
    stamped(rows, |row| format!("{:.9}", row.time_s))
}

fn stamped(rows: &[Rest], stamp: impl Fn(&Rest) -> String) -> String {
    let mut text = HEADER.to_owned();
    for row in rows {
        line(&mut text, &stamp(row), row, 1.0);
    }
    text
}

/// Rows of increments over the true period.
fn increments(rows: &[Rest]) -> String {
    let mut text = HEADER.to_owned();
    for row in rows {
        line(&mut text, &format!("{:.9}", row.time_s), row, 1.0 / RATE_HZ);
    }
    text
}

/// Increments of a unit at a rate, Hz.
fn increments_at(rate_hz: f64, count: u64) -> String {
    let mut text = HEADER.to_owned();
    for row in readings(rate_hz, count) {
        line(&mut text, &format!("{:.9}", row.time_s), &row, 1.0 / rate_hz);
    }
    text
}

fn line(text: &mut String, stamp: &str, row: &Rest, factor: f64) {
    text.push_str(stamp);
    for value in row.values {
        write!(text, ",{:.12e}", value * factor).unwrap();
    }
    text.push('\n');
}

/// Regular rows.
fn regular() -> Vec<Rest> {
    readings(RATE_HZ, COUNT)
}

/// Rows without those of these numbers, from 0.
fn without(lost: impl Fn(u64) -> bool) -> Vec<Rest> {
    let rows = regular().into_iter().zip(0..);
    rows.filter(|(_, number)| !lost(*number)).map(|(row, _)| row).collect()
}

/// Rows whose stamps are changed by a function of number and stamp.
fn moved(stamp_s: impl Fn(u64, f64) -> f64) -> Vec<Rest> {
    let rows = regular().into_iter().zip(0..);
    rows.map(|(row, number)| Rest { time_s: stamp_s(number, row.time_s), ..row }).collect()
}

/// A calibration of which the core would have to fill in too much.
const LACKING: Ends =
    Ends::Inconclusive("the calibration was refused for the samples that it lacks");

struct Text {
    part: Part,
    scenario: String,
    input: &'static str,
}

impl Text {
    fn new(mark: &'static str) -> Self {
        let mut text = Self { part: Part::new(mark), scenario: scenario(SOURCE), input: "rates" };
        let clean = text.row("regular", csv(&regular()), &[], Counts::used(COUNT), Ends::Pass);
        text.part.clean = Some(clean);
        text
    }

    fn row(
        &mut self,
        holds: &str,
        content: impl AsRef<[u8]>,
        set: &[&str],
        counts: Counts,
        ends: Ends,
    ) -> super::table::Parameters {
        let files: [(&str, &[u8]); 2] =
            [("s.toml", self.scenario.as_bytes()), (FILE, content.as_ref())];
        let counts: &[_] = if matches!(ends, Ends::Refused(_)) { &[] } else { &[(FILE, counts)] };
        self.part.run(&Case { input: self.input, holds, files: &files, set, counts, ends })
    }

    fn refused(
        &mut self,
        holds: &str,
        content: impl AsRef<[u8]>,
        set: &[&str],
        words: &'static str,
    ) {
        self.row(holds, content, set, Counts::default(), Ends::Refused(words));
    }
}
