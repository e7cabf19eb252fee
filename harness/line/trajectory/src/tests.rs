//! Files as others write them, and the reference between two of its points.

use crate::point::{SECOND_NS, TimeScale, TrajectoryPoint, WEEK_NS};
use crate::reader::TrajectoryReader;
use crate::survey::TrajectorySurvey;
use crate::track::{ReferenceTrack, q_nc};
use octant_earth::ellipsoid::Ellipsoid;
use octant_scenario::recorded::{Delimiter, RecordedColumn, TimeUnit};
use octant_scenario::trajectory::{NmeaChoice, TrajectoryColumns, TrajectoryFormat};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn all(path: &Path, format: &TrajectoryFormat) -> Result<Vec<TrajectoryPoint>, String> {
    let mut reader = TrajectoryReader::open(path, format).map_err(|error| error.to_string())?;
    let mut points = Vec::new();
    while let Some(point) = reader.next().map_err(|error| error.to_string())? {
        points.push(point);
    }
    Ok(points)
}

const NMEA: TrajectoryFormat = TrajectoryFormat::Nmea(NmeaChoice {
    talker: None,
    fixes_alone: false,
    points: None,
    heading_time: None,
    heading_delay: None,
    tells_none: false,
});

/// Reason why a file is refused once it was read to its end.
fn refused(path: &Path, format: &TrajectoryFormat) -> String {
    TrajectorySurvey::of(path, format).unwrap_err().to_string()
}

fn csv() -> TrajectoryFormat {
    TrajectoryFormat::Csv(Box::default())
}

#[test]
fn columns_are_found_by_the_names_of_exports() {
    let folder = tempfile::tempdir().unwrap();
    let text = "heading_deg,time_s,latitude_deg,longitude_deg,pitch_deg,roll_deg\n\
        90.0,1767225600.123456789,60.0,-10.5,1.0,-2.0\n# a comment\n\n91,1767225601,60.1,-10.4,1,-2\n";
    let points = all(&file(folder.path(), "ins.csv", text), &csv()).unwrap();
    assert_eq!(points.len(), 2);
    let first = points[0];
    assert_eq!(first.time_ns, 1_767_225_600_123_456_789);
    assert_eq!(first.position.unwrap().latitude_rad, 60.0_f64.to_radians());
    assert_eq!((first.position.unwrap().height_m, first.velocity_mps), (0.0, None));
    assert_eq!(first.attitude_rad(), Some([-2.0, 1.0, 90.0].map(f64::to_radians)));
    // Octant's own truth.
    let text = "time_s,latitude_deg,true_longitude_deg,true_latitude_deg\n1,9,2,3\n2,9,2,3\n";
    let points = all(&file(folder.path(), "truth.csv", text), &csv()).unwrap();
    assert_eq!(points[0].position.unwrap().longitude_rad, 2.0_f64.to_radians());
    assert_eq!(points[0].position.unwrap().latitude_rad, 9.0_f64.to_radians());
    let of_reference = TrajectoryColumns { truth_first: true, ..TrajectoryColumns::default() };
    let format = TrajectoryFormat::Csv(Box::new(of_reference));
    let points = all(&folder.path().join("truth.csv"), &format).unwrap();
    assert_eq!(points[0].position.unwrap().latitude_rad, 3.0_f64.to_radians());
    // A solution's heading isn't the truth because the truth has none.
    let text = "time_s,latitude_deg,true_longitude_deg,true_latitude_deg,longitude_deg,roll_deg,pitch_deg,heading_deg\n\
        1,9,2,3,4,5,6,7\n";
    let side_by_side = file(folder.path(), "both.csv", text);
    assert_eq!(all(&side_by_side, &format).unwrap()[0].attitude_rad(), None);
    assert!(all(&side_by_side, &csv()).unwrap()[0].attitude_rad().is_some());
}

#[test]
fn columns_are_found_as_the_scenario_says() {
    let folder = tempfile::tempdir().unwrap();
    let number = |number| Some(RecordedColumn::Number(number));
    let columns = TrajectoryColumns {
        delimiter: Delimiter::Blanks,
        skip_lines: 1,
        time: (number(1), TimeUnit::Millisecond),
        position: [number(2), number(3), None],
        velocity: [number(4), number(5)],
        angle_rad: 1.0,
        velocity_mps: 0.5,
        ..TrajectoryColumns::default()
    };
    let format = TrajectoryFormat::Csv(Box::new(columns));
    let path = file(folder.path(), "a.txt", "made by X\n  10.5  1.0 -3  2 4\n 20 1.1 -3 2 4\n");
    let points = all(&path, &format).unwrap();
    assert_eq!(points[0].time_ns, 10_500_000);
    assert_eq!(
        (points[0].position.unwrap().latitude_rad, points[0].position.unwrap().longitude_rad),
        (1.0, -3.0)
    );
    assert_eq!(points[0].velocity_mps, Some([1.0, 2.0]));
}

#[test]
fn text_that_is_no_trajectory_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let header = "time_s,latitude_deg,longitude_deg\n";
    for (rows, words) in [
        ("1,60,x\n", "line 2: column 3: found \"x\", expected a finite number"),
        ("1,60,nan\n", "line 2: column 3: found \"nan\", expected a finite number"),
        ("x,60,1\n", "line 2: column 1: found \"x\", expected a time"),
        ("1,60\n", "line 2: found 2 columns, expected 3 or more"),
        ("1,60,1\n1,60,1\n", "line 3: found a time 0.000000000 s before the point before it"),
        ("1,90.1,1\n", "line 2: found latitude 90.1"),
        ("1,60,361\n", "longitude 361"),
    ] {
        let path = file(folder.path(), "a.csv", format!("{header}{rows}"));
        let found = refused(&path, &csv());
        assert!(found.contains(words) && found.contains("a.csv"), "{found}");
    }
    for (text, words) in [
        ("time_s,latitude_deg,lon\n1,2,3\n", "found no column \"longitude_deg\", the header has"),
        (
            "time_s,latitude_deg,longitude_deg,roll_deg\n1,2,3,4\n",
            "found some of roll_deg, pitch_deg",
        ),
        ("", "expected a line with the names"),
    ] {
        let found = all(&file(folder.path(), "b.csv", text), &csv()).unwrap_err();
        assert!(found.contains(words), "{found}");
    }
}

/// A sentence with its checksum.
fn sentence(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte))
}

#[test]
fn sentences_of_one_time_are_one_point_and_a_night_has_a_midnight() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("logger started\n");
    for (time, date, latitude) in
        [("235959.50", "311226", "6000.0000"), ("000000.50", "010127", "6000.6000")]
    {
        text += &sentence(&format!("GPGGA,{time},{latitude},N,01030.0000,W,1,8,1,10.0,M,40.0,M,,"));
        text +=
            &sentence(&format!("GPRMC,{time},A,{latitude},N,01030.0000,W,7.2,090.0,{date},,,A"));
        text += &sentence(&format!("PASHR,{time},091.5,T,-1.0,0.5,0.0,0.1,0.1,0.2,1"));
        text += "$GPGGA,000001.00,damaged*00\n\u{1}\u{2}\n";
    }
    // A fix that is none, and a date that comes after its sentences.
    text += &sentence("GPGGA,000001.50,0000.0000,N,00000.0000,E,0,0,99,0.0,M,0.0,M,,");
    let points = all(&file(folder.path(), "a.nmea", text), &NMEA).unwrap();
    assert_eq!(points.len(), 2, "{points:?}");
    // 2026-12-31T23:59:59.5 UTC.
    assert_eq!(points[0].time_ns, 1_798_761_599 * SECOND_NS + SECOND_NS / 2);
    assert_eq!(points[1].time_ns - points[0].time_ns, SECOND_NS);
    assert!((points[0].position.unwrap().longitude_rad + 10.5_f64.to_radians()).abs() < 1e-15);
    assert!((points[1].position.unwrap().latitude_rad - 60.01_f64.to_radians()).abs() < 1e-15);
    assert_eq!(points[0].position.unwrap().height_m, 50.0);
    let [north, east] = points[0].velocity_mps.unwrap();
    assert!(north.abs() < 1e-12 && (east - 7.2 * 1852.0 / 3600.0).abs() < 1e-12);
    assert_eq!(points[0].attitude_rad(), Some([-1.0, 0.5, 91.5].map(f64::to_radians)));
}

#[test]
fn talkers_that_disagree_are_refused_with_their_names() {
    let folder = tempfile::tempdir().unwrap();
    // 0.0065 minutes of latitude are 12.0 m; one in the last digit of the coarser position is 1.9 m.
    let text = |latitude: &str, above_m: &str, speed_kn: &str| {
        sentence("GPGGA,120000,6000.0000,N,01030.0000,W,1,8,1,10.0,M,40.0,M,,")
            + &sentence("GPRMC,120000,A,6000.0000,N,01030.0000,W,7.20,090.0,261126,,,A")
            + &sentence(&format!(
                "INGGA,120000,{latitude},N,01030.0000,W,1,8,1,{above_m},M,40.0,M,,"
            ))
            + &sentence(&format!("INVTG,090.0,T,,M,{speed_kn},N,,K,A"))
    };
    let read = |text: String| all(&file(folder.path(), "two.nmea", text), &NMEA);
    for (latitude, above_m, speed_kn, words) in [
        (
            "6000.0065",
            "10.0",
            "7.20",
            "line 3: talkers GP and IN disagree: their positions at the same time are 12.0 m apart",
        ),
        ("6000.0000", "11.0", "7.20", "their heights at the same time are 1.00 m apart"),
        (
            "6000.0000",
            "10.0",
            "8.20",
            "line 4: talkers GP and IN disagree: their velocities at the same time are 0.51 m/s apart",
        ),
    ] {
        let found = read(text(latitude, above_m, speed_kn)).unwrap_err();
        assert!(found.contains(words), "{found}");
    }
    // The last digits of the same instrument's sentences may differ.
    assert_eq!(read(text("6000.0001", "10.1", "7.21")).unwrap().len(), 1);
    assert_eq!(read(text("6000.000", "10", "7.2")).unwrap().len(), 1);
}

#[test]
fn a_file_without_sentences_or_without_a_date_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let gga = sentence("GPGGA,120000,6000.0,N,01030.0,W,1,8,1,10.0,M,40.0,M,,");
    for (text, words) in [
        ("time_s,latitude_deg\n1,2\n".to_owned(), "found no sentence of NMEA 0183"),
        (gga.clone(), "1 sentences and no date, expected an RMC or a ZDA"),
    ] {
        let found = all(&file(folder.path(), "a.nmea", text), &NMEA).unwrap_err();
        assert!(found.contains(words), "{found}");
    }
    let with_date = gga + &sentence("GPZDA,120001,26,11,2026,00,00");
    let points = all(&file(folder.path(), "b.nmea", with_date), &NMEA).unwrap();
    assert_eq!(points[0].time_ns, 1_795_694_400 * SECOND_NS, "2026-11-26T12:00:00Z");
}

#[test]
fn solutions_of_rtklib_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let text = "% program   : RTKPOST\n\
        %  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  \
        sdne(m)  sdeu(m)  sdun(m) age(s)  ratio    vn(m/s)    ve(m/s)    vu(m/s)\n\
        2026/11/26 12:00:18.000   60.000000000  -10.500000000   50.0000   1  12   0.0034   0.0026   0.0057  \
        0.0000   0.0000   0.0000   0.00    3.2    1.00000   -2.00000    0.00000\n\
        2026/11/26 12:00:18.200   60.000000010  -10.500000000   50.0000   1  12   0.0034   0.0026   0.0057  \
        0.0000   0.0000   0.0000   0.00    3.2    1.00000   -2.00000    0.00000\n";
    let points = all(&file(folder.path(), "a.pos", text), &TrajectoryFormat::Rtklib).unwrap();
    assert_eq!(points[0].time_ns, 1_795_694_400 * SECOND_NS, "UTC, 18 leap seconds behind");
    assert_eq!(points[1].time_ns - points[0].time_ns, SECOND_NS / 5);
    assert_eq!(points[0].velocity_mps, Some([1.0, -2.0]));
    assert_eq!(points[0].position.unwrap().height_m, 50.0);
    let headless = text.lines().skip(2).collect::<Vec<_>>().join("\n");
    let found =
        all(&file(folder.path(), "b.pos", headless), &TrajectoryFormat::Rtklib).unwrap_err();
    assert!(found.contains("line 1: found no line before it that begins with %"), "{found}");
}

#[test]
fn records_of_an_sbet_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let record = |time_s: f64, wander: f64| {
        let mut fields = [0.0_f64; 17];
        fields[..11]
            .copy_from_slice(&[time_s, 1.0, -0.2, 50.0, 1.0, 2.0, 3.0, 0.01, 0.02, 0.5, wander]);
        fields.map(f64::to_le_bytes).concat()
    };
    let bytes = [record(388_818.0, 0.0), record(388_818.005, 0.0)].concat();
    let path = file(folder.path(), "a.sbet", &bytes);
    let points = all(&path, &TrajectoryFormat::Sbet).unwrap();
    assert_eq!(points[0].time_ns, 388_818 * SECOND_NS);
    assert_eq!(
        (points[0].position.unwrap().latitude_rad, points[0].position.unwrap().longitude_rad),
        (1.0, -0.2)
    );
    assert_eq!((points[0].velocity_mps, points[0].attitude_rad()), (None, Some([0.01, 0.02, 0.5])));
    let survey = TrajectorySurvey::of(&path, &TrajectoryFormat::Sbet).unwrap();
    assert_eq!((survey.points, survey.period_ns, survey.scale), (2, 5_000_000, TimeScale::GpsWeek));
    let turned = file(folder.path(), "b.sbet", record(1.0, 0.1));
    assert_eq!(all(&turned, &TrajectoryFormat::Sbet).unwrap()[0].attitude_rad(), None);
    let torn = file(folder.path(), "c.sbet", &bytes[..200]);
    let found = all(&torn, &TrajectoryFormat::Sbet).unwrap_err();
    assert!(found.contains("found 200 bytes, expected records of 136 bytes"), "{found}");
}

/// A track through points with the period of `every_ns`.
fn track(folder: &Path, points: &[(f64, f64, f64, [f64; 2])], gap_ns: i64) -> ReferenceTrack {
    let mut text = String::from(
        "time_s,latitude_deg,longitude_deg,velocity_north_mps,velocity_east_mps,roll_deg,pitch_deg,heading_deg\n",
    );
    for (time_s, latitude, longitude, [north, east]) in points {
        let heading = 350.0 + 2.0 * time_s;
        text += &format!(
            "{time_s:.9},{latitude:.15},{longitude:.15},{north:.15},{east:.15},0,0,{heading}\n"
        );
    }
    let path = file(folder, "track.csv", text);
    ReferenceTrack::new(TrajectoryReader::open(&path, &csv()).unwrap(), gap_ns, SECOND_NS).unwrap()
}

#[test]
fn a_reference_with_velocities_is_exact_for_a_constant_acceleration() {
    let folder = tempfile::tempdir().unwrap();
    // On the equator, along it and across the date line: longitude is the distance over the radius.
    let earth = Ellipsoid::at(0.0, 0.0);
    let radius_m = earth.transverse_radius_m;
    let moved = |t: f64| (3.0 * t + 0.25 * t * t, 3.0 + 0.5 * t);
    let longitude = |t: f64| 179.999 + (moved(t).0 / radius_m).to_degrees();
    let wrapped = |deg: f64| if deg > 180.0 { deg - 360.0 } else { deg };
    let points: Vec<_> = (0..40)
        .map(f64::from)
        .map(|t| (t, 0.0, wrapped(longitude(t)), [0.0, moved(t).1]))
        .collect();
    let mut track = track(folder.path(), &points, SECOND_NS);
    for tenth in 0..=390 {
        let t = f64::from(tenth) / 10.0;
        let found = track.at(tenth as i64 * SECOND_NS / 10).unwrap().unwrap();
        let off_rad = (found.position.unwrap().longitude_rad - longitude(t).to_radians()
            + std::f64::consts::PI)
            .rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        // Numbers of the file have 15 digits after the point.
        assert!((off_rad * radius_m).abs() < 1e-8, "{t} {}", off_rad * radius_m);
        let [north, east] = found.velocity_mps.unwrap();
        assert!(north == 0.0 && (east - moved(t).1).abs() < 1e-12, "{t}");
        let heading = q_nc([0.0, 0.0, (350.0 + 2.0 * t).to_radians()]);
        assert!(found.q_nc.unwrap().angle_to(&heading) < 1e-7, "{t}");
    }
    assert_eq!(track.at(39 * SECOND_NS + 1).unwrap(), None, "after its end");
}

#[test]
fn nothing_is_interpolated_over_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let points = [0.0, 1.0, 4.0, 5.0].map(|t| (t, 10.0, 20.0, [0.0, 0.0]));
    let mut track = track(folder.path(), &points, 2 * SECOND_NS);
    let mut is = |at_s: f64| track.at((at_s * 1e9) as i64).unwrap().is_some();
    let found = [-1.0, 0.0, 0.5, 1.0, 1.5, 3.9, 4.0, 4.5, 5.0, 5.5].map(&mut is);
    assert_eq!(found, [false, true, true, true, false, false, true, true, true, false]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the bytes are, a reader ends with points or an error.
    #[test]
    fn no_bytes_make_a_reader_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..600),
        lines in proptest::collection::vec("[$%0-9A-Z,.*/ :-]{0,80}", 0..12),
        form in 0..4,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let text = lines.iter().map(|line| sentence(line)).collect::<String>();
        let format = [csv(), NMEA, TrajectoryFormat::Rtklib, TrajectoryFormat::Sbet];
        for content in [bytes, text.into_bytes(), lines.join("\n").into_bytes()] {
            let path = file(folder.path(), "any", content);
            if let Ok(points) = all(&path, &format[form as usize]) {
                prop_assert!(points.windows(2).all(|pair| pair[0].time_ns < pair[1].time_ns));
            }
        }
    }
}

#[test]
fn a_week_of_gps_ends() {
    let gps = TimeScale::GpsWeek;
    assert_eq!(gps.offset_to(gps, 10, 10 + 3 * WEEK_NS), Some(3 * WEEK_NS));
}

/// Sentences of a ship that turns through a circle in a minute, at 1 Hz: positions, velocities and dates of each second.
struct Circle;

impl Circle {
    const RADIUS_M: f64 = 500.0;
    const TURNS_RADPS: f64 = std::f64::consts::TAU / 60.0;

    fn sum(body: &str) -> String {
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${body}*{sum:02X}\r\n")
    }

    fn velocity_mps(second: u32) -> [f64; 2] {
        let angle = Self::TURNS_RADPS * f64::from(second);
        [-angle.sin(), angle.cos()].map(|part| part * Self::RADIUS_M * Self::TURNS_RADPS)
    }

    fn latitude_min(second: u32) -> f64 {
        let north_m = Self::RADIUS_M * (Self::TURNS_RADPS * f64::from(second)).cos();
        (north_m / 6.371e6).to_degrees() * 60.0
    }

    fn longitude_min(second: u32) -> f64 {
        let east_m = Self::RADIUS_M * (Self::TURNS_RADPS * f64::from(second)).sin();
        let latitude_rad = (30.0 + (10.0 + Self::latitude_min(second)) / 60.0).to_radians();
        (east_m / 6.371e6 / latitude_rad.cos()).to_degrees() * 60.0
    }

    fn time(second: u32) -> String {
        format!("12{:02}{:02}.00", second / 60, second % 60)
    }

    fn position(second: u32, digits: usize) -> String {
        let width = digits + 3;
        let (north, east) = (10.0 + Self::latitude_min(second), 10.0 + Self::longitude_min(second));
        format!("30{north:0width$.digits$},N,030{east:0width$.digits$},E")
    }

    fn gga(second: u32) -> String {
        let (time, position) = (Self::time(second), Self::position(second, 7));
        Self::sum(&format!("GPGGA,{time},{position},1,08,1.0,0.0,M,0.0,M,,"))
    }

    fn vtg(second: u32) -> String {
        let [north, east] = Self::velocity_mps(second);
        let course_deg = east.atan2(north).to_degrees().rem_euclid(360.0);
        let knots = north.hypot(east) * 3600.0 / 1852.0;
        Self::sum(&format!("GPVTG,{course_deg:.4},T,,M,{knots:.4},N,,K,A"))
    }

    fn zda(second: u32) -> String {
        Self::sum(&format!("GPZDA,{},01,01,2026,00,00", Self::time(second)))
    }

    /// A recommended minimum without velocity, with few digits.
    fn rmc(second: u32) -> String {
        let (time, position) = (Self::time(second), Self::position(second, 2));
        Self::sum(&format!("GPRMC,{time},A,{position},,,010126,,,A"))
    }
}

#[test]
fn velocities_go_to_their_own_positions_in_any_order_of_the_cycle() {
    let folder = tempfile::tempdir().unwrap();
    type Cycle = fn(u32) -> String;
    let cycles: [(&str, Cycle); 5] = [
        ("after", |s| Circle::zda(s) + &Circle::gga(s) + &Circle::vtg(s)),
        ("before", |s| Circle::zda(s) + &Circle::vtg(s) + &Circle::gga(s)),
        ("first", |s| Circle::vtg(s) + &Circle::gga(s) + &Circle::zda(s)),
        ("early date", |s| Circle::gga(s) + &Circle::zda(s + 1) + &Circle::vtg(s)),
        ("coarse", |s| Circle::rmc(s) + &Circle::gga(s) + &Circle::vtg(s)),
    ];
    for (name, cycle) in cycles {
        let text: String = (0..40).map(cycle).collect();
        let path = file(folder.path(), "a.nmea", text);
        let reader = TrajectoryReader::open(&path, &NMEA).unwrap();
        assert_eq!(!reader.choices().is_empty(), matches!(name, "before" | "first"), "{name}");
        let points = all(&path, &NMEA).unwrap();
        assert_eq!(points.len(), 40, "{name}");
        for (second, point) in (0..).zip(&points) {
            let found = point.velocity_mps.unwrap_or_else(|| panic!("{name}: {second}"));
            let expected = Circle::velocity_mps(second);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-3, "{name} {second}: {found} {expected}");
            }
            // To seven digits of a minute, whatever else gave the position.
            let north_rad = (30.0 + (10.0 + Circle::latitude_min(second)) / 60.0).to_radians();
            assert!(
                (point.position.unwrap().latitude_rad - north_rad).abs() < 2e-11,
                "{name} {second}"
            );
            assert_eq!(point.time_ns % (60 * SECOND_NS), i64::from(second % 60) * SECOND_NS);
        }
    }
}

#[test]
fn midnight_passes_once_with_and_without_a_date() {
    let folder = tempfile::tempdir().unwrap();
    let gga = |time: &str| {
        Circle::sum(&format!("GPGGA,{time},3010.0000000,N,03010.0000000,E,1,08,1.0,0.0,M,0.0,M,,"))
    };
    let zda = |time: &str, day: u32| Circle::sum(&format!("GPZDA,{time},{day:02},01,2026,00,00"));
    for dates in [true, false] {
        let mut text = zda("235958.00", 1);
        for (time, day) in [("235958.00", 1), ("235959.00", 1), ("000000.00", 2), ("000001.00", 2)]
        {
            // The date of the next second comes early.
            text += &if dates { zda(time, day) } else { String::new() };
            text += &gga(time);
        }
        let points = all(&file(folder.path(), "m.nmea", text), &NMEA).unwrap();
        let steps: Vec<i64> = points.windows(2).map(|p| p[1].time_ns - p[0].time_ns).collect();
        assert_eq!(steps, [SECOND_NS; 3], "{dates}");
    }
}

#[test]
fn sentences_without_checksums_are_refused_with_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let text: String = (0..20).map(|s| Circle::zda(s) + &Circle::gga(s)).collect();
    let bare: String =
        text.lines().map(|line| line.split('*').next().unwrap().to_owned() + "\r\n").collect();
    let found = all(&file(folder.path(), "a.nmea", bare), &NMEA).unwrap_err();
    assert!(
        found.contains("found 40 sentences without a checksum, expected each to end in *"),
        "{found}"
    );
}

#[test]
fn a_gps_week_ends_in_an_sbet() {
    let folder = tempfile::tempdir().unwrap();
    let record = |time_s: f64| {
        let mut fields = [0.0; 17];
        (fields[0], fields[1], fields[2]) = (time_s, 0.5, 0.1);
        fields.iter().flat_map(|field: &f64| field.to_le_bytes()).collect::<Vec<u8>>()
    };
    let seconds = |times_s: &[f64]| {
        let bytes: Vec<u8> = times_s.iter().flat_map(|time_s| record(*time_s)).collect();
        let points = all(&file(folder.path(), "a.sbet", bytes), &TrajectoryFormat::Sbet)?;
        Ok::<_, String>(points.iter().map(|point| point.time_ns / SECOND_NS).collect::<Vec<_>>())
    };
    assert_eq!(seconds(&[604_799.0, 0.0, 1.0]).unwrap(), [604_799, 604_800, 604_801]);
    // Files that count on, and time that runs back within a week.
    assert_eq!(seconds(&[604_799.0, 604_800.0, 604_801.0]).unwrap(), [604_799, 604_800, 604_801]);
    let refused = |times_s: &[f64]| {
        let bytes: Vec<u8> = times_s.iter().flat_map(|time_s| record(*time_s)).collect();
        refused(&file(folder.path(), "b.sbet", bytes), &TrajectoryFormat::Sbet)
    };
    assert!(refused(&[1000.0, 999.0]).contains("1.000000000 s before"));
    // Two recordings, one after the other in a file.
    assert!(refused(&[500_000.0, 10.0]).contains("before the point before it"));
}

#[test]
fn two_columns_of_one_name_are_refused_with_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let text = "time_s,latitude_deg,longitude_deg,latitude_deg\n1,2,3,4\n2,2,3,4\n";
    let path = file(folder.path(), "two.csv", text);
    let found = all(&path, &csv()).unwrap_err();
    let words =
        "found two columns \"latitude_deg\", 2 and 4, expected one: say which by its number";
    assert!(found.contains(words), "{found}");
}

#[test]
fn the_period_of_a_solution_is_that_of_its_rate() {
    let folder = tempfile::tempdir().unwrap();
    // Rates, digits of the stamps, and gaps of a second.
    for rate_hz in [1.0, 3.0, 6.0, 7.0, 12.0, 15.0, 20.0, 30.0, 50.0, 60.0, 100.0, 120.0, 200.0] {
        for digits in [3, 6] {
            let mut text = String::from("time_s,latitude_deg,longitude_deg\n");
            for number in 0..3000 {
                let gap_s = f64::from(number / 1000);
                text += &format!("{:.digits$},10,20\n", f64::from(number) / rate_hz + gap_s);
            }
            let path = file(folder.path(), "rate.csv", text);
            let survey = TrajectorySurvey::of(&path, &csv()).unwrap();
            let expected_ns = (1e9 / rate_hz).round() as i64;
            assert_eq!(survey.period_ns, expected_ns, "{rate_hz} Hz, {digits} digits");
        }
    }
    // One that isn't a whole number of Hz.
    let rows: String = (0..3000).map(|n| format!("{:.6},10,20\n", f64::from(n) * 0.0273)).collect();
    let text = format!("time_s,latitude_deg,longitude_deg\n{rows}");
    let survey = TrajectorySurvey::of(&file(folder.path(), "odd.csv", text), &csv()).unwrap();
    assert_eq!(survey.period_ns, 27_300_000);
}
