//! Text: rates and increments, whole and damaged.

use super::rest::{BEGIN_S, COUNT, RATE_HZ, Rest, readings, scenario};
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

#[test]
fn times() {
    let mut text = Text::new("times of text");
    let used = Counts::used;
    // Jitter.
    let rows = moved(|k, t| t + if k % 2 == 0 { 2e-4 } else { -2e-4 });
    text.row("stamps that jitter by ±0.2 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let late = |k: u64| k % 10 == 5 && k > 10;
    let count = (0..COUNT).filter(|k| late(*k)).count() as u64;
    let rows = moved(|k, t| t + if late(k) { 4e-3 } else { 0.0 });
    text.row(
        "one stamp in ten 4 ms late",
        csv(&rows),
        &[],
        used(COUNT - count).repaired(count),
        Ends::Pass,
    );
    let rows = moved(|k, t| t + if k % 2 == 0 { 4e-3 } else { -4e-3 });
    text.row(
        "stamps that jitter by ±4 ms",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    let rows = moved(|k, t| t - 0.02 * (k % 4) as f64);
    text.row(
        "bursts: four rows have the stamp of their first",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    let rows = moved(|_, t| (t * 100.0 + 1e-6).floor() / 100.0);
    text.row("stamps of 10 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let twice = |k: u64| k % 8 == 3;
    let rows = moved(|k, t| if twice(k) { t - 0.02 } else { t });
    // The fit is that of all stamps, 2.5 ms before the most of them.
    text.row(
        "one stamp in eight is that of the row before",
        csv(&rows),
        &[],
        used(UNSETTLED).repaired(COUNT - UNSETTLED),
        Ends::Pass,
    );
    // Rows twice, and in another order.
    let mut rows = regular();
    for k in [2500, 2000, 1500, 1000, 500] {
        rows.insert(k, rows[k]);
    }
    text.row("five rows twice", csv(&rows), &[], used(COUNT).left_out(5), Ends::Pass);
    let mut rows = regular();
    rows.swap(1000, 1001);
    text.row(
        "two rows in the wrong order",
        csv(&rows),
        &[],
        used(COUNT - 2).repaired(2),
        Ends::Pass,
    );
    let mut rows = regular();
    let late = rows.remove(1000);
    rows.insert(1005, late);
    text.row("a row five rows too late", csv(&rows), &[], used(COUNT - 6).repaired(6), Ends::Pass);
    // Clocks that are set.
    let rows = moved(|k, t| if (1000..1100).contains(&k) { t - 1.9 } else { t });
    text.refused(
        "the clock goes back by 1.9 s for 2 s",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    let unix = 1.740_564_858e9;
    let rows = moved(|k, t| if (1000..1100).contains(&k) { 315_965_235.05 + t } else { unix + t });
    text.refused(
        "Unix stamps; the clock is in 1980 for 2 s",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    let rows = moved(|k, t| if k < 1000 { t } else { unix + t });
    text.refused(
        "the clock is set to the date within the file",
        csv(&rows),
        &[],
        "line 1002: the clock jumps ahead from ",
    );
    let rows = moved(|k, t| if k < 1000 { t } else { t - 30.0 + BEGIN_S });
    text.refused(
        "the unit restarts: the clock begins again",
        csv(&rows),
        &[],
        "line 1002: the clock goes back from ",
    );
    // Resolutions.
    let rows = moved(|_, t| f64::from((unix + t) as f32));
    text.refused(
        "Unix stamps in float32: one for 128 s",
        csv(&rows),
        &[],
        "the stamps stand still at ",
    );
    let rows = moved(|_, t| f64::from((10_000.0 + t) as f32));
    text.row("seconds of the day in float32: 1 ms", csv(&rows), &[], used(COUNT), Ends::Pass);
    let rows = moved(|_, _| 0.0);
    text.refused(
        "all stamps 0",
        csv(&rows),
        &[],
        "the stamps stand still at 0 s: they are too coarse for 50 Hz",
    );
    let rows = moved(|_, t| t.floor());
    text.refused("stamps of whole seconds", csv(&rows), &[], "the stamps stand still at ");
    // Units of the stamps.
    for (unit, name, per_s, digits) in [
        ("ms", "milliseconds", 1e3, 3),
        ("us", "microseconds", 1e6, 1),
        ("ns", "nanoseconds", 1e9, 0),
    ] {
        let content = stamped(&regular(), |row| format!("{:.digits$}", row.time_s * per_s));
        let set = format!("source.text.time_unit={unit}");
        text.row(&format!("stamps in {name}"), content, &[&set], used(COUNT), Ends::Pass);
    }
    let content = stamped(&regular(), |row| format!("{:.6}", row.time_s + unix));
    text.row("Unix stamps in s", content, &[], used(COUNT), Ends::Pass);
    let content = stamped(&regular(), |row| format!("{:.3}", row.time_s * 1e3));
    text.refused("stamps in milliseconds, taken as s", content, &[], "");
    let content = stamped(&regular(), |row| format!("{:.9}", row.time_s - 30.0));
    text.refused("stamps from -20 s on", content, &[], "expected a time from 0 to");
    let content = stamped(&regular(), |row| {
        format!("2025-02-26T10:{:02}:{:06.3}Z", row.time_s as u64 / 60, row.time_s % 60.0)
    });
    text.refused(
        "stamps as ISO 8601",
        content,
        &[],
        "line 2: column 1: found \"2025-02-26T10:00:10.000Z\"",
    );
    text.part.finish(20);
}

#[test]
fn gaps() {
    let mut text = Text::new("gaps of text");
    for is_rates in [true, false] {
        text.input = if is_rates { "rates" } else { "increments" };
        let set: &[&str] = if is_rates { &[] } else { &INCREMENTS };
        let write = |rows: &[Rest]| if is_rates { csv(rows) } else { increments(rows) };
        if !is_rates {
            text.row("regular", write(&regular()), set, Counts::used(COUNT), Ends::Pass);
        }
        for (lost, holds) in [
            (1, "one row lost"),
            (2, "2 rows lost"),
            (15, "0.3 s lost"),
            (25, "0.5 s lost"),
            (50, "1 s lost"),
            (250, "5 s lost"),
        ] {
            let rows = without(|k| (1000..1000 + lost).contains(&k));
            let counts = Counts::used(COUNT - lost).missing(lost);
            let ends = if lost < 250 { Ends::Pass } else { LACKING };
            text.row(holds, write(&rows), set, counts, ends);
        }
        let rows =
            without(|k| [600, 1200, 1800, 2400].iter().any(|from| (*from..from + 25).contains(&k)));
        text.row(
            "0.5 s lost four times",
            write(&rows),
            set,
            Counts::used(COUNT - 100).missing(100),
            LACKING,
        );
        let rows = without(|k| (1000..1400).contains(&k));
        let ends = Ends::Inconclusive("unit.csv has gaps: 400 rows missing");
        text.row("8 s lost", write(&rows), set, Counts::used(COUNT - 400).missing(400), ends);
        let rows = without(|k| (3..28).contains(&k));
        text.row(
            "0.5 s lost behind the third row",
            write(&rows),
            set,
            Counts::used(COUNT - 25).missing(25),
            Ends::Pass,
        );
        let rows = without(|k| (2970..2995).contains(&k));
        text.row(
            "0.5 s lost before the last five rows",
            write(&rows),
            set,
            Counts::used(COUNT - 25).missing(25),
            Ends::Pass,
        );
        let rows = without(|k| k >= 2500);
        text.row(
            "10 s missing at the end",
            write(&rows),
            set,
            Counts::used(2500),
            Ends::Inconclusive(""),
        );
        let rows = without(|k| k % 20 == 7);
        text.row(
            "one row in twenty lost",
            write(&rows),
            set,
            Counts::used(2850).missing(150),
            LACKING,
        );
        let rows = without(|k| k % 5 == 2);
        text.row(
            "one row in five lost",
            write(&rows),
            set,
            Counts::used(2400).missing(600),
            Ends::Inconclusive(""),
        );
        text.refused(
            "every other row lost",
            write(&without(|k| k % 2 == 1)),
            set,
            "rows come at 25 Hz",
        );
    }
    text.input = "rates";
    let rows: Vec<Rest> = without(|k| (1000..1050).contains(&k));
    let rows: Vec<Rest> = rows
        .iter()
        .zip(0..)
        .map(|(row, k)| Rest { time_s: row.time_s + if k % 2 == 0 { 4e-3 } else { -4e-3 }, ..*row })
        .collect();
    text.row(
        "1 s lost, stamps that jitter by ±4 ms",
        csv(&rows),
        &[],
        Counts::used(UNSETTLED).repaired(COUNT - 50 - UNSETTLED).missing(50),
        Ends::Pass,
    );
    let rows: Vec<Rest> = without(|k| (1000..1004).contains(&k))
        .iter()
        .map(|row| Rest { time_s: (row.time_s * 12.5 + 1e-6).floor() / 12.5, ..*row })
        .collect();
    text.row(
        "four rows lost in a file of bursts",
        csv(&rows),
        &[],
        Counts::used(UNSETTLED).repaired(COUNT - 4 - UNSETTLED).missing(4),
        Ends::Pass,
    );
    text.scenario = untimed();
    let rows = without(|k| (1000..1050).contains(&k));
    text.row(
        "1 s lost, no times",
        csv(&rows),
        &[],
        Counts::used(COUNT - 50),
        Ends::Inconclusive(""),
    );
    text.part.finish(30);
}

#[test]
fn rates() {
    let mut text = Text::new("rates of text");
    for rate in ["60", "75", "120", "150", "300", "819.2"] {
        let rate_hz: f64 = rate.parse().unwrap();
        let count = (10.0 * rate_hz).round() as u64;
        // Times that are whole samples.
        let (aiding, recorded) = if rate == "819.2" { ("5 s", "0.2 Hz") } else { ("1 s", "1 Hz") };
        let set = [
            format!("imu.rate=\"{rate} Hz\""),
            "procedure.calibration.duration=\"10 s\"".to_owned(),
            format!("procedure.calibration.aiding.period=\"{aiding}\""),
            format!("record.rate=\"{recorded}\""),
        ];
        let clean = text.part.clean.take();
        let content = csv(&readings(rate_hz, count));
        text.row(
            &format!("{rate} Hz"),
            content,
            &set.each_ref().map(String::as_str),
            Counts::used(count),
            Ends::Pass,
        );
        text.part.clean = clean;
    }
    for ppm in [100.0, -100.0, 500.0, -500.0] {
        // Rates, and stamps of a clock that is wrong: the core's time is that of the stamps.
        text.input = "rates";
        let rows = moved(|_, t| BEGIN_S + (t - BEGIN_S) * (1.0 + ppm * 1e-6));
        let clock = if ppm > 0.0 { "fast" } else { "slow" };
        let holds = format!("stamps of a clock that is {clock} by {} ppm", f64::abs(ppm));
        text.row(&holds, csv(&rows), &[], Counts::used(COUNT), Ends::Pass);
        // Increments of a unit whose clock is right, and whose rate isn't that of the scenario.
        text.input = "increments";
        let rate_hz = RATE_HZ * (1.0 - ppm * 1e-6);
        let holds = format!(
            "a rate {} by {} ppm",
            if ppm > 0.0 { "lower" } else { "higher" },
            f64::abs(ppm)
        );
        text.row(
            &holds,
            increments_at(rate_hz, COUNT),
            &INCREMENTS,
            Counts::used(COUNT),
            Ends::Pass,
        );
    }
    // 3000 samples are no minute.
    let slow = Ends::Inconclusive("calibration: planned 60 s, done 58.8239 s");
    text.row(
        "51 Hz, and the scenario says 50 Hz",
        increments_at(51.0, 3060),
        &INCREMENTS,
        Counts::used(COUNT),
        slow,
    );
    text.input = "rates";
    text.row(
        "51 Hz, and the scenario says 50 Hz",
        csv(&readings(51.0, 3060)),
        &[],
        Counts::used(COUNT),
        slow,
    );
    text.input = "rates";
    let content = csv(&regular());
    text.refused(
        "50 Hz, and the scenario says 100 Hz",
        &content,
        &["imu.rate=\"100 Hz\""],
        "rows come at 50 Hz by their stamps, expected 100 Hz",
    );
    text.refused(
        "50 Hz, and the scenario says 40 Hz",
        &content,
        &["imu.rate=\"40 Hz\""],
        "rows come at 50 Hz by their stamps, expected 40 Hz",
    );
    let rows = moved(|k, t| if k < 1500 { t } else { t + 0.02 * (k - 1500) as f64 });
    text.refused("50 Hz, from half on 25 Hz", csv(&rows), &[], "from here on rows come at 25 Hz");
    let rows = moved(|k, t| if k < 1500 { t } else { t - 0.01 * (k - 1500) as f64 });
    text.refused("50 Hz, from half on 100 Hz", csv(&rows), &[], "from here on rows come at 100 Hz");
    let rows = moved(|k, t| if k < 1500 { t } else { t + 0.02 * 5e-5 * (k - 1500) as f64 });
    text.row(
        "stamps of a clock that is faster by 50 ppm from half on",
        csv(&rows),
        &[],
        Counts::used(COUNT),
        Ends::Pass,
    );
    text.scenario = untimed();
    text.row("no times", content, &[], Counts::used(COUNT), Ends::Pass);
    text.part.finish(15);
}

#[test]
fn forms() {
    let mut text = Text::new("forms of text");
    let used = Counts::used(COUNT);
    let content = csv(&regular());
    // Lines that are no rows.
    text.row(
        "comments and empty lines between rows",
        content.replace("\n20", "\n# a comment\n\n20"),
        &[],
        used,
        Ends::Pass,
    );
    text.row(
        "ends of lines of Windows, and a byte order mark",
        format!("\u{feff}{}", content.replace('\n', "\r\n")),
        &[],
        used,
        Ends::Pass,
    );
    text.row("a last line without an end", content.trim_end(), &[], used, Ends::Pass);
    for (name, with) in [("semicolon", ";"), ("tab", "\t"), ("whitespace", " ")] {
        let set = format!("source.text.delimiter={name}");
        text.row(
            &format!("fields by {name}"),
            content.replace(',', with),
            &[&set],
            used,
            Ends::Pass,
        );
    }
    text.row(
        "fields in quotes",
        content.replace(",0", ",\"0\"").replace("t,gx", "\"t\",\"gx\""),
        &[],
        used,
        Ends::Pass,
    );
    let rows = content.strip_prefix(HEADER).unwrap();
    let numbers = [
        "source.text.header=false",
        "source.text.time_column=1",
        "source.text.gyro.x=2",
        "source.text.gyro.y=3",
        "source.text.gyro.z=4",
        "source.text.accelerometer.x=5",
        "source.text.accelerometer.y=6",
        "source.text.accelerometer.z=7",
    ];
    text.row("no header, columns by number", rows, &numbers, used, Ends::Pass);
    text.row(
        "three lines before the header",
        format!("unit 7\n50 Hz\n\n{content}"),
        &["source.text.skip_lines=3"],
        used,
        Ends::Pass,
    );
    // More rows than the run takes.
    let more = csv(&readings(RATE_HZ, COUNT + 500));
    text.row("10 s more than the run takes", more, &[], used, Ends::Pass);
    text.row(
        "each row as two samples",
        &content,
        &["source.text.split=2", "source.text.rate=\"50 Hz\"", "imu.rate=\"100 Hz\""],
        used,
        Ends::Pass,
    );
    let flat = stamped(&regular(), |row| format!("{:.9}", row.time_s)).replace("-9.7", "-97.");
    text.row("one axis ten times too large", flat, &[], used, Ends::Fail(""));
    // Damaged rows.
    let with_row = |row: &str| {
        let lines: Vec<&str> = content.lines().collect();
        let mut lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        lines[1000] = row.to_owned();
        lines.join("\n")
    };
    text.refused(
        "not a number in a row",
        with_row("29.98,NaN,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"NaN\", expected a finite number",
    );
    text.refused(
        "an empty field",
        with_row("29.98,,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"\", expected a finite number",
    );
    text.refused(
        "a word in a row",
        with_row("29.98,reset,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"reset\"",
    );
    text.refused(
        "a row cut short",
        with_row("29.98,1e-5,0,0"),
        &[],
        "line 1001: found 4 columns, expected ",
    );
    text.refused(
        "commas in numbers and between them",
        content.replace(",-9.", ",-9,"),
        &[],
        "line 2: found 8 columns, expected 7 as in the header",
    );
    text.row("a comma at the end of each row", content.replace('\n', ",\n"), &[], used, Ends::Pass);
    text.refused(
        "the last row cut short",
        &content[..content.len() - 30],
        &[],
        "line 3001: found ",
    );
    text.refused(
        "the header again within the file",
        with_row(HEADER.trim()),
        &[],
        "line 1001: column 1: found \"t\"",
    );
    // Headers.
    text.refused(
        "an empty file",
        "",
        &[],
        "the file ends, expected a line with the names of the columns",
    );
    text.refused("a header alone", HEADER, &[], "the file ends, expected rows of numbers");
    text.refused("no header", rows, &[], "no column \"");
    text.refused(
        "another name in the header",
        content.replace("gz", "wz"),
        &[],
        "no column \"gz\", found t, gx, gy, wz",
    );
    text.refused(
        "two columns of one name",
        content.replace("gz", "gy"),
        &[],
        "found two columns \"gy\", 3 and 4",
    );
    text.refused(
        "a comma where the scenario says tab",
        &content,
        &["source.text.delimiter=tab"],
        "with delimiter = \"comma\" the line has 7 columns",
    );
    text.refused(
        "one line of 100 000 bytes without an end",
        "1".repeat(100_000),
        &[],
        "longer than 65536 bytes",
    );
    text.refused("bytes that aren't text", [0xFF; 400], &[], "");
    two_files(&mut text);
    text.part.finish(25);
}

/// Gyros and accelerometers in files of their own.
fn two_files(text: &mut Text) {
    let second = format!(
        "{}file = \"accel.csv\"\n",
        text.scenario.replace(
            "[source.text.accelerometer]\n",
            "[source.text.accelerometer]\nfile = \"accel.csv\"\n"
        )
    );
    let scenario = second.trim_end_matches("file = \"accel.csv\"\n").to_owned();
    let content = csv(&regular());
    let mut run = |holds: &str, accel: &str, ends: Ends| {
        let files: [(&str, &[u8]); 3] = [
            ("s.toml", scenario.as_bytes()),
            (FILE, content.as_bytes()),
            ("accel.csv", accel.as_bytes()),
        ];
        let counts: &[_] = if ends == Ends::Pass { &[(FILE, Counts::used(COUNT))] } else { &[] };
        text.part.run(&Case {
            input: "rates in two files",
            holds,
            files: &files,
            set: &[],
            counts,
            ends,
        });
    };
    run("the same stamps", &content, Ends::Pass);
    let lines: Vec<&str> = content.lines().collect();
    let without_one = [&lines[..1000], &lines[1001..]].concat().join("\n");
    run(
        "a row of the second one lost",
        &without_one,
        Ends::Refused("accel.csv: line 1001: stamp "),
    );
    run(
        "the second one ends early",
        &lines[..2000].join("\n"),
        Ends::Refused("accel.csv: line 2000: the file ends after 1999 rows"),
    );
}
