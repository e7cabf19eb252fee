//! Solutions of other systems beside a reference trajectory, whole and damaged.

use super::table::{Case, Counts, Ends, Part};
use octant_earth::ellipsoid::Ellipsoid;
use std::fmt::Write;

/// Seconds of a solution, with one point each, the first and the last included.
const SECONDS: u32 = 600;
const POINTS: u64 = SECONDS as u64 + 1;
/// 2026-11-20T10:00:00 UTC in seconds of its GPS week, which begins on Sunday; GPS time is 18 s ahead.
const OF_WEEK_S: f64 = 5.0 * 86_400.0 + 36_000.0 + 18.0;

const SCENARIO: &str = "schema = 1
[[requirements]]
id = \"NAV-1\"
text = \"The position stays within 1 nmi.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"1 nmi\"
[decision]
position = \"0.5 m\"
";

/// Latitude and longitude, deg, velocity north and east, m/s.
type Motion = [f64; 4];

/// A ship on a circle of 2 km at 5 m/s.
fn truth(t_s: f64) -> Motion {
    const RADIUS_M: f64 = 2000.0;
    const SPEED_MPS: f64 = 5.0;
    let (sine, cosine) = (SPEED_MPS / RADIUS_M * t_s).sin_cos();
    let earth = Ellipsoid::at(45_f64.to_radians(), 0.0);
    let north = (RADIUS_M * sine / earth.meridian_radius_m).to_degrees();
    let across_m = earth.transverse_radius_m * earth.cos_latitude;
    let east = (RADIUS_M * (1.0 - cosine) / across_m).to_degrees();
    [45.0 + north, 10.0 + east, SPEED_MPS * cosine, SPEED_MPS * sine]
}

/// The same with a drift in latitude of an arcminute an hour, and a velocity with a constant error.
fn drifting(t_s: f64) -> Motion {
    let [latitude, longitude, north, east] = truth(t_s);
    [latitude + t_s / 3600.0 / 60.0, longitude, north + 0.5, east]
}

fn seconds() -> impl Iterator<Item = f64> {
    (0..=SECONDS).map(f64::from)
}

fn clock(t_s: f64) -> String {
    let whole = t_s as u64;
    format!("10:{:02}:{:06.3}", whole / 60, t_s - (whole / 60 * 60) as f64)
}

const HEADER: &str = "time_s,latitude_deg,longitude_deg,velocity_north_mps,velocity_east_mps\n";

/// Rows with dates.
fn csv(times_s: impl Iterator<Item = f64>, of: impl Fn(f64) -> Motion) -> String {
    let rows = times_s.map(|t| {
        let [latitude, longitude, north, east] = of(t);
        format!("2026-11-20T{}Z,{latitude:.12},{longitude:.12},{north:.9},{east:.9}\n", clock(t))
    });
    HEADER.to_owned() + &rows.collect::<String>()
}

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

fn hms(t_s: f64) -> String {
    clock(t_s).replace(':', "")
}

/// Degrees and minutes with so many decimals, and the letter.
fn angle(degrees: f64, width: usize, letter: char, decimals: usize) -> String {
    let whole = degrees.floor();
    let minutes = (degrees - whole) * 60.0;
    format!(
        "{whole:0width$}{minutes:0minute_width$.decimals$},{letter}",
        minute_width = 3 + decimals
    )
}

fn position(motion: Motion, decimals: usize) -> String {
    format!("{},{}", angle(motion[0], 2, 'N', decimals), angle(motion[1], 3, 'E', decimals))
}

fn speed_and_course([_, _, north, east]: Motion) -> [String; 2] {
    let knots = north.hypot(east) * 3600.0 / 1852.0;
    [format!("{knots:.5}"), format!("{:.4}", east.atan2(north).to_degrees().rem_euclid(360.0))]
}

fn gga(talker: &str, t_s: f64, motion: Motion, quality: u32) -> String {
    let position = position(motion, 7);
    sentence(&format!("{talker}GGA,{},{position},{quality},09,0.9,12.000,M,48.0,M,,", hms(t_s)))
}

fn rmc(talker: &str, t_s: f64, motion: Motion, status: char, decimals: usize) -> String {
    let [speed, course] = speed_and_course(motion);
    let position = position(motion, decimals);
    sentence(&format!("{talker}RMC,{},{status},{position},{speed},{course},201126,,,A", hms(t_s)))
}

fn vtg(talker: &str, motion: Motion) -> String {
    let [speed, course] = speed_and_course(motion);
    sentence(&format!("{talker}VTG,{course},T,,M,{speed},N,,K,A"))
}

fn zda(talker: &str, t_s: f64) -> String {
    sentence(&format!("{talker}ZDA,{},20,11,2026,00,00", hms(t_s)))
}

/// Sentences of each second.
fn nmea(of: impl Fn(f64) -> String) -> String {
    seconds().map(of).collect()
}

fn both(t_s: f64) -> String {
    gga("GP", t_s, drifting(t_s), 1) + &rmc("GP", t_s, drifting(t_s), 'A', 7)
}

struct Solutions {
    part: Part,
    /// Ending of the solution's file, reference and further arguments.
    ending: &'static str,
    reference: String,
    more: Vec<&'static str>,
}

impl Solutions {
    fn new(mark: &'static str, ending: &'static str) -> Self {
        Self { part: Part::new(mark), ending, reference: csv(seconds(), truth), more: Vec::new() }
    }

    /// Scores a solution. Counts are those of its file.
    fn row(&mut self, holds: &str, solution: impl AsRef<[u8]>, counts: Counts, ends: Ends) {
        let file = format!("ins.{}", self.ending);
        let account = format!("solution {file}");
        let arguments = [
            "score",
            "--solution",
            &file,
            "--reference",
            "ref.csv",
            "--scenario",
            "s.toml",
            "--out",
            "out",
        ];
        let files: [(&str, &[u8]); 3] = [
            ("s.toml", SCENARIO.as_bytes()),
            (&file, solution.as_ref()),
            ("ref.csv", self.reference.as_bytes()),
        ];
        let counts: &[_] =
            if matches!(ends, Ends::Refused(_)) { &[] } else { &[(&*account, counts)] };
        let case = Case { input: self.ending, holds, files: &files, set: &[], counts, ends };
        self.part.ends(&case, &[&arguments[..], &self.more].concat());
    }

    fn refused(&mut self, holds: &str, solution: impl AsRef<[u8]>, words: &'static str) {
        self.row(holds, solution, Counts::default(), Ends::Refused(words));
    }
}

const MISSING: Ends =
    Ends::Inconclusive("of the solution are missing, incomplete, or have no reference");

#[test]
fn solutions_of_nmea() {
    let mut score = Solutions::new("NMEA", "nmea");
    let used = Counts::used;
    score.row("GGA and RMC, one a second", nmea(both), used(2 * POINTS), Ends::Pass);
    let two = |t: f64| both(t) + &both(t).replace("$GP", "$GN");
    let two_talkers = nmea(|t| {
        two(t)
            .lines()
            .map(|line| sentence(line.trim_start_matches('$').split('*').next().unwrap()))
            .collect()
    });
    score.row("two talkers that agree", two_talkers, used(4 * POINTS), Ends::Pass);
    let off = |t: f64| {
        let [latitude, longitude, north, east] = drifting(t);
        [latitude + 12.0 / 111_000.0, longitude, north, east]
    };
    let contradict = nmea(|t| {
        gga("GP", t, drifting(t), 1) + &gga("IN", t, off(t), 1) + &rmc("GP", t, drifting(t), 'A', 7)
    });
    score.refused("two talkers, 12 m apart", &contradict, "talkers GP and IN disagree");
    score.more = vec!["--talker", "IN"];
    score.row(
        "the same, and IN is chosen",
        &contradict,
        used(POINTS).left_out(2 * POINTS),
        Ends::Pass,
    );
    score.more.clear();
    let unsummed: String =
        nmea(both).lines().map(|line| format!("{}\r\n", line.split('*').next().unwrap())).collect();
    score.refused("no checksums", unsummed, "without a checksum, expected each to end in *");
    let wrong =
        nmea(|t| if t % 60.0 == 30.0 { both(t).replacen("GGA,1", "GGA,0", 1) } else { both(t) });
    score.row(
        "ten GGA with a wrong checksum",
        wrong,
        used(2 * POINTS - 10).left_out(10),
        Ends::Pass,
    );
    let no_fix = |t: f64| (200.0..300.0).contains(&t);
    let lost = nmea(|t| {
        if no_fix(t) {
            gga("GP", t, drifting(t), 0) + &rmc("GP", t, drifting(t), 'V', 7)
        } else {
            both(t)
        }
    });
    score.row("no fix for 100 s", lost, used(2 * POINTS - 200).left_out(200), MISSING);
    score.refused(
        "GGA alone: no date",
        nmea(|t| gga("GP", t, drifting(t), 1)),
        "and no date, expected an RMC or a ZDA",
    );
    let first = nmea(|t| vtg("GP", drifting(t)) + &gga("GP", t, drifting(t), 1) + &zda("GP", t));
    score.row("VTG before the GGA of its time", first, used(3 * POINTS), Ends::Pass);
    let behind = nmea(|t| gga("GP", t, drifting(t), 1) + &zda("GP", t) + &vtg("GP", drifting(t)));
    score.row("VTG behind the GGA of its time", behind, used(3 * POINTS), Ends::Pass);
    let early =
        nmea(|t| gga("GP", t, drifting(t), 1) + &zda("GP", t + 1.0) + &vtg("GP", drifting(t)));
    score.row(
        "the ZDA of the next second between GGA and VTG",
        early,
        used(3 * POINTS),
        Ends::Pass,
    );
    let coarse = nmea(|t| rmc("GP", t, drifting(t), 'A', 2) + &gga("GP", t, drifting(t), 1));
    score.row("an RMC of few digits before each GGA", coarse, used(2 * POINTS), Ends::Pass);
    let dead = nmea(|t| gga("GP", t, drifting(t), 6) + &rmc("GP", t, drifting(t), 'A', 7));
    score.row("quality 6, an estimate", dead, used(2 * POINTS), Ends::Pass);
    let gap: String = seconds().filter(|t| !(200.0..300.0).contains(t)).map(both).collect();
    score.row("100 s lost", gap, used(2 * (POINTS - 100)), MISSING);
    score.refused("an empty file", "", "found no sentence of NMEA 0183");
    score.refused("text", csv(seconds(), drifting), "found no sentence of NMEA 0183");
    score.part.finish(14);
}

#[test]
fn solutions_in_columns() {
    let mut score = Solutions::new("columns", "csv");
    let used = Counts::used;
    let whole = csv(seconds(), drifting);
    score.row("one row a second", &whole, used(POINTS), Ends::Pass);
    for rate_hz in [3.0, 7.0, 12.0, 60.0] {
        let count = (100.0 * rate_hz) as u32;
        let rows = csv((0..=count).map(|k| f64::from(k) / rate_hz), drifting);
        score.row(
            &format!("{rate_hz} Hz for 100 s, stamps of 1 ms"),
            rows,
            used(u64::from(count) + 1),
            Ends::Pass,
        );
    }
    let lines: Vec<&str> = whole.lines().collect();
    let without = |lost: std::ops::Range<usize>| {
        [&lines[..lost.start], &lines[lost.end..]].concat().join("\n")
    };
    score.row("one row lost", without(201..202), used(POINTS - 1), Ends::Pass);
    score.row("100 s lost", without(201..301), used(POINTS - 100), MISSING);
    let changed = |change: &dyn Fn(&str) -> String| {
        let lines = lines.iter().enumerate();
        lines.map(|(k, line)| if (201..301).contains(&k) { change(line) } else { (*line).to_owned() } + "\n").collect::<String>()
    };
    let commented = changed(&|line| format!("#{line}"));
    score.row("100 rows with a comment mark", commented, used(POINTS - 100).left_out(100), MISSING);
    let empty = changed(&|line| format!("{},,,0,0", line.split(',').next().unwrap()));
    score.row("100 rows without a position", empty, used(POINTS - 100).left_out(100), MISSING);
    let mut swapped = lines.clone();
    swapped.swap(201, 202);
    score.row(
        "two rows in the wrong order",
        swapped.join("\n"),
        used(POINTS - 1).left_out(1),
        Ends::Pass,
    );
    let turned = csv(seconds(), |t| {
        let [latitude, longitude, north, east] = drifting(t);
        [latitude, longitude - 360.0, north, east]
    });
    score.row("longitudes from -360° on", turned, used(POINTS), Ends::Pass);
    // Copies.
    score.row(
        "a copy of the reference",
        csv(seconds(), truth),
        used(POINTS),
        Ends::Inconclusive("of the reference"),
    );
    let rounded = csv(seconds(), |t| truth(t).map(|number| (number * 1e6).round() / 1e6));
    score.row(
        "a copy, rounded to 0.1 m",
        rounded,
        used(POINTS),
        Ends::Inconclusive("of the reference"),
    );
    let late = csv(seconds(), |t| truth(t - 1.0));
    score.row("a copy, 1 s late", late, used(POINTS), Ends::Inconclusive("of the reference"));
    // References.
    let reference = std::mem::replace(
        &mut score.reference,
        csv(seconds().filter(|t| !(200.0..300.0).contains(t)), truth),
    );
    score.row("100 s of the reference lost", &whole, used(POINTS), MISSING);
    score.reference = csv(seconds().take(300), truth);
    score.row("the reference ends at half", &whole, used(POINTS), Ends::Inconclusive(""));
    score.reference = csv(seconds().map(|t| t + 1000.0), truth);
    score.refused("a reference of another time", &whole, "found no point that has a reference");
    score.reference = reference;
    score.refused(
        "times of its own without an offset",
        seconds().fold(HEADER.to_owned(), |mut text, t| {
            let [latitude, longitude, north, east] = drifting(t);
            writeln!(text, "{t},{latitude:.12},{longitude:.12},{north:.9},{east:.9}").unwrap();
            text
        }),
        "expected source.trajectory.offset",
    );
    score.refused(
        "two columns of one name",
        whole.replacen("longitude_deg", "latitude_deg", 1),
        "found two columns \"latitude_deg\"",
    );
    score.refused(
        "no latitude",
        whole.replacen("latitude_deg", "lat", 1),
        "found no column \"latitude_deg\"",
    );
    score.refused("a word in a row", whole.replacen(",45.", ",none", 1), "found \"none");
    score.refused("a header alone", HEADER, "found 0 points with a position");
    score.refused("an empty file", "", "expected a line with the names of the columns");
    score.part.finish(20);
}

/// A solution of RTKLIB in GPS time.
fn rtklib(quality: impl Fn(f64) -> u32) -> String {
    let rows = seconds().map(|t| {
        let [latitude, longitude, north, east] = drifting(t);
        format!(
            "2445 {:10.3} {latitude:.9} {longitude:.9} 60.0 {} 9 0.01 0.01 0.02 0 0 0 0 1.0 {north:.5} {east:.5} 0.0 0 0 0 0 0 0\n",
            OF_WEEK_S + t,
            quality(t)
        )
    });
    "% program   : RTKPOST\n%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu sdvne sdveu sdvun\n"
        .to_owned()
        + &rows.collect::<String>()
}

/// Records of SBET, from a second of the week on.
fn sbet(from_s: f64) -> Vec<u8> {
    let record = |t: f64| {
        let [latitude, longitude, ..] = drifting(t);
        let mut fields = [0.0; 17];
        fields[0] = (from_s + t).rem_euclid(604_800.0);
        fields[1] = latitude.to_radians();
        fields[2] = longitude.to_radians();
        fields.into_iter().flat_map(f64::to_le_bytes)
    };
    seconds().flat_map(record).collect()
}

#[test]
fn solutions_of_other_formats() {
    let mut score = Solutions::new("RTKLIB and SBET", "pos");
    let used = Counts::used;
    let whole = rtklib(|_| 1);
    score.row("fixed, one a second", &whole, used(POINTS), Ends::Pass);
    score.row(
        "Q = 5 for 100 s",
        rtklib(|t| if (200.0..300.0).contains(&t) { 5 } else { 1 }),
        used(POINTS),
        Ends::Pass,
    );
    score.refused(
        "coordinates of the Earth's centre",
        whole.replace("latitude(deg)", "x-ecef(m)"),
        "found the column x-ecef(m)",
    );
    score.refused(
        "no line of names",
        whole.lines().skip(2).collect::<Vec<_>>().join("\n"),
        "found no line before it that begins with %",
    );
    score.refused(
        "Japan's time",
        whole.replace("GPST", "JST"),
        "found times in JST, expected GPST or UTC",
    );
    score.refused("a row cut short", &whole[..whole.len() - 150], "");
    score.ending = "sbet";
    score.row("records of each second", sbet(OF_WEEK_S), used(POINTS), Ends::Pass);
    let torn = sbet(OF_WEEK_S);
    score.refused(
        "cut off within a record",
        &torn[..torn.len() - 5],
        "expected records of 136 bytes",
    );
    score.refused("an empty file", [], "found 0 bytes, expected records of 136 bytes");
    score.part.finish(9);
}
