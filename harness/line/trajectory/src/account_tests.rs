//! Accounts of files: each unit is used or left out for a reason, gaps are named, and likeness is told.

use crate::likeness::{Differences, Likeness};
use crate::reader::TrajectoryReader;
use crate::survey::TrajectorySurvey;
use octant_account::Account;
use octant_scenario::trajectory::{NmeaChoice, TrajectoryColumns, TrajectoryFormat};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn csv() -> TrajectoryFormat {
    TrajectoryFormat::Csv(Box::<TrajectoryColumns>::default())
}

fn nmea(talker: Option<&str>, fixes_alone: bool) -> TrajectoryFormat {
    TrajectoryFormat::Nmea(NmeaChoice {
        talker: talker.map(str::to_owned),
        fixes_alone,
        ..NmeaChoice::default()
    })
}

/// A sentence with its checksum.
fn sentence(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte))
}

/// Number of units that were left out for a reason that has these words.
fn left_out(account: &Account, words: &str) -> u64 {
    let entries = account
        .entries()
        .filter(|(heading, entry)| *heading == "left out" && entry.kind.contains(words));
    entries.map(|(_, entry)| entry.count).sum()
}

fn points(path: &Path, format: &TrajectoryFormat) -> u64 {
    let mut reader = TrajectoryReader::open(path, format).unwrap();
    std::iter::from_fn(|| reader.next().unwrap()).count() as u64
}

#[test]
fn rows_of_text_are_all_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("# made by a logger\ntime_s,latitude_deg,longitude_deg\n");
    for second in 0..100 {
        match second {
            // Two commented rows, one that the unit had no position for, one that came late, and one twice.
            30 | 31 => text += &format!("#{second},60,10\n"),
            40 => text += "40,,\n",
            41 => text += "41,NaN,nan\n",
            50 => text += "20.5,60,10\n50,60,10\n50,60,10\n",
            _ => text += &format!("{second},60,10\n"),
        }
    }
    let path = file(folder.path(), "a.csv", text);
    let survey = TrajectorySurvey::of(&path, &csv()).unwrap();
    let account = &survey.account;
    assert_eq!((survey.points, account.used_count(), account.read()), (96, 96, 102));
    assert_eq!(left_out(account, "comment mark"), 2);
    assert_eq!(left_out(account, "without a position"), 2);
    assert_eq!(left_out(account, "out of order"), 2);
    let line = account.lines().into_iter().find(|line| line.contains("out of order")).unwrap();
    assert!(
        line.contains("line 53: found a time 28.500000000 s before the point before it"),
        "{line}"
    );
    assert_eq!(points(&path, &csv()), 96);
}

#[test]
fn times_are_dates_with_and_without_an_offset() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |form: fn(u32) -> String| {
        (0..4).fold(String::from("time_s,latitude_deg,longitude_deg\n"), |text, second| {
            text + &format!("{},60,10\n", form(second))
        })
    };
    // `date -u -d '2026-11-26 12:00:00' +%s`: 1795694400.
    for (form, choices) in [
        ((|s| format!("2026-11-26T12:00:0{s}Z")) as fn(u32) -> String, 0),
        (|s| format!("2026-11-26 12:00:0{s}.000"), 1),
        (|s| format!("2026/11/26 13:00:0{s}+01:00"), 0),
    ] {
        let path = file(folder.path(), "a.csv", rows(form));
        let mut reader = TrajectoryReader::open(&path, &csv()).unwrap();
        assert_eq!(reader.next().unwrap().unwrap().time_ns, 1_795_694_400_000_000_000);
        assert_eq!(reader.choices().len(), choices);
    }
}

/// Position of a second, 2 m a second to the north, as GGA has it.
fn gga(talker: &str, second: u32, off_minutes: f64, quality: u32) -> String {
    let (minute, of_minute) = (second / 60, second % 60);
    let latitude = 10.0 + 0.001 * f64::from(second) + off_minutes;
    sentence(&format!(
        "{talker}GGA,12{minute:02}{of_minute:02},60{latitude:07.4},N,01030.0000,W,{quality},8,1,10.0,M,40.0,M,,"
    ))
}

#[test]
fn a_talker_is_chosen_and_others_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for second in 0..60 {
        text += &sentence(&format!("GPZDA,1200{second:02},26,11,2026,00,00"));
        text += &gga("GP", second, 0.0, 1);
        text += &gga("IN", second, 0.0065, 6);
    }
    let path = file(folder.path(), "two.nmea", text);
    let refused = TrajectorySurvey::of(&path, &nmea(None, false)).unwrap_err().to_string();
    assert!(
        refused.contains("talkers GP and IN disagree") && refused.contains("12.0 m"),
        "{refused}"
    );
    assert!(refused.contains("the key talker, such as talker = \"IN\""), "{refused}");
    let first = |talker: &str| {
        let mut reader = TrajectoryReader::open(&path, &nmea(Some(talker), false)).unwrap();
        reader.next().unwrap().unwrap().position.unwrap().latitude_rad.to_degrees()
    };
    assert!((first("GP") - (60.0 + 10.0 / 60.0)).abs() < 1e-12);
    assert!((first("IN") - (60.0 + 10.0065 / 60.0)).abs() < 1e-12);
    let survey = TrajectorySurvey::of(&path, &nmea(Some("IN"), false)).unwrap();
    assert_eq!((survey.points, left_out(&survey.account, "other talkers")), (60, 60));
    assert_eq!((survey.account.used_count(), survey.account.read()), (120, 180));
    let lines = survey.account.lines().join("\n");
    assert!(lines.contains("60 points of quality 6 (estimated, dead reckoning), 100 %"), "{lines}");
    // As a reference, an estimate is no fix.
    let none = TrajectorySurvey::of(&path, &nmea(Some("IN"), true)).unwrap_err().to_string();
    assert!(none.contains("found 0 points with a position"), "{none}");
}

#[test]
fn qualities_damage_and_late_sentences_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = sentence("GPZDA,115959,26,11,2026,00,00") + "started\n\n";
    for second in 0..200 {
        let quality = [4, 4, 5, 1][second as usize % 4];
        let whole = gga("GP", second, 0.0, quality);
        match second {
            20 => text += &whole.replace("8,1,10.0", "9,1,10.0"),
            21 => text += &gga("GP", second, 0.0, 0),
            22 => text += &gga("GP", second, 0.0, 8),
            23 => text += whole.split('*').next().unwrap(),
            _ => text += &whole,
        }
        text += if second == 23 { "\r\n" } else { "" };
        text += &sentence("GPGSV,1,1,00");
        if second == 100 {
            // A sentence of a minute ago.
            text += &gga("GP", 40, 0.0, 4);
        }
    }
    let path = file(folder.path(), "a.nmea", text);
    let survey = TrajectorySurvey::of(&path, &nmea(None, false)).unwrap();
    let account = &survey.account;
    assert_eq!(survey.points, 196);
    for (words, count) in [
        ("wrong checksum", 1),
        ("without a checksum", 1),
        ("without a valid fix", 1),
        ("simulator or of manual input", 1),
        ("other kinds", 200),
        ("without a sentence", 1),
        ("out of order", 1),
    ] {
        assert_eq!(left_out(account, words), count, "{words}: {:?}", account.lines());
    }
    // 196 positions and a date are used, of 197 + 4 + 200 + 1 + 1 lines.
    assert_eq!((account.used_count(), account.read()), (197, 403));
    let lines = account.lines().join("\n");
    // Seconds 20 to 23 are left out, one of each in the cycle of four.
    assert!(lines.contains("98 points of quality 4 (RTK, fixed), 50 %"), "{lines}");
    assert!(lines.contains("49 points of quality 1 (GNSS), 25 %"), "{lines}");
}

#[test]
fn two_sentences_of_one_kind_that_disagree_are_two_instruments() {
    let folder = tempfile::tempdir().unwrap();
    let text = sentence("GPZDA,120000,26,11,2026,00,00")
        + &gga("GP", 1, 0.0, 4)
        + &gga("GP", 1, 0.0065, 4);
    let path = file(folder.path(), "a.nmea", text);
    let found = TrajectorySurvey::of(&path, &nmea(None, false)).unwrap_err().to_string();
    let words = "line 3: two GPGGA of the same time disagree: their positions are 12.0 m apart";
    assert!(found.contains(words), "{found}");
}

#[test]
fn standard_deviations_of_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let text = sentence("GPZDA,120000,26,11,2026,00,00")
        + &gga("GP", 1, 0.0, 4)
        + &sentence("GPGST,120001,1.0,,,,0.25,0.5,0.75");
    let path = file(folder.path(), "a.nmea", text);
    let mut reader = TrajectoryReader::open(&path, &nmea(None, false)).unwrap();
    assert_eq!(reader.next().unwrap().unwrap().sigma.position_m, Some([0.25, 0.5]));
    let text = "%  GPST  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)\n\
        2026/11/26 12:00:18.000 60.0 -10.5 50.0 1 12 0.0034 0.0026 0.0057\n\
        2026/11/26 12:00:19.000 60.0 -10.5 50.0 5 12 4.5 3.5 9.0\n\
        2026/11/26 12:00:20.000 60.0 -10.5 50.0 1 12 0 0 0\n";
    let path = file(folder.path(), "a.pos", text);
    let mut reader = TrajectoryReader::open(&path, &TrajectoryFormat::Rtklib).unwrap();
    let sigmas = [(); 3].map(|()| reader.next().unwrap().unwrap().sigma.position_m);
    assert_eq!(sigmas, [Some([0.0034, 0.0026]), Some([4.5, 3.5]), None]);
    let lines = reader.account("reference").lines().join("\n");
    assert!(lines.contains("1 points of quality 5 (single), 33.33 %"), "{lines}");
}

/// Likeness of a solution on a circle of 2 km at 5 m/s, once a second for an hour.
fn likeness(solution: impl Fn(f64) -> [f64; 2]) -> Likeness {
    let mut likeness = Likeness::of_axes(2);
    for second in 0..3600_u32 {
        let t = f64::from(second);
        likeness.push(u64::from(second) * 1_000_000_000, solution(t), circle(t));
    }
    likeness
}

fn circle(t: f64) -> [f64; 2] {
    let (s, c) = (t * 5.0 / 2000.0).sin_cos();
    [2000.0 * s, 2000.0 * (1.0 - c)]
}

#[test]
fn a_rounded_or_late_copy_is_known_by_its_differences() {
    // Rounded to 10 cm: a uniform error of 10 cm / sqrt(12) on each axis, with a mean of none.
    let rounded = likeness(|t| circle(t).map(|x| (x * 10.0).round() / 10.0));
    let found = rounded.differences().unwrap();
    assert!((found.scatter - 0.1 / 12.0_f64.sqrt()).abs() < 1e-3, "{found:?}");
    assert!(found.mean < 2e-3, "{found:?}");
    // A second late: 5 m off as it is; what is left is of the third order, a jerk of v³/R² over 6.
    let late = likeness(|t| circle(t - 1.0));
    let found = late.differences().unwrap();
    assert!((found.scatter - 5.0 / 2.0_f64.sqrt()).abs() < 0.1, "{found:?}");
    let left = late.after_delay().unwrap();
    assert!((left.delay_s.unwrap() - 1.0).abs() < 1e-3, "{left:?}");
    assert!(left.scatter < 1e-4 && left.mean < 1e-4, "{left:?}");
    // An offset of the antenna isn't a delay.
    let beside = likeness(|t| circle(t).map(|x| x + 1.0));
    let left = beside.after_delay().unwrap();
    assert!(left.mean > 1.3, "{left:?}");
    assert!(!likeness(|_| [0.0; 2]).varies() && rounded.varies());
}

/// Numbers of a normal distribution (splitmix64, Box and Muller).
fn normals() -> impl Iterator<Item = f64> {
    let mut state = 7_u64;
    let mut uniform = move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    std::iter::from_fn(move || {
        let (radius, angle) = (libm::sqrt(-2.0 * libm::log(1.0 - uniform())), uniform());
        Some(radius * libm::cos(2.0 * std::f64::consts::PI * angle))
    })
}

#[test]
fn independent_references_are_called_too_like_once_in_a_hundred_at_most() {
    // Runs in which the reference has so many independent errors, each for as long as the others; computed by numpy for
    // 200 000 runs: 0.78, 0.58, 0.38, 0.22 and 0.01 % on two axes, 0.88, 0.69, 0.46, 0.36 and 0.06 % on one.
    let mut normal = normals();
    let runs = 20_000;
    let expected =
        [[0.0088, 0.0078], [0.0069, 0.0058], [0.0046, 0.0038], [0.0036, 0.0022], [0.0006, 0.0001]];
    for (draws, expected) in [1, 2, 3, 4, 10].into_iter().zip(expected) {
        for (axes, expected) in [1, 2].into_iter().zip(expected) {
            let mut called = 0_u32;
            for _ in 0..runs {
                let (mut sum, mut square) = ([0.0; 2], 0.0);
                for _ in 0..draws {
                    for sum in &mut sum[..axes] {
                        let error = normal.next().unwrap();
                        *sum += error;
                        square += error * error;
                    }
                }
                let n = f64::from(draws);
                let mean = libm::hypot(sum[0] / n, sum[1] / n);
                let scatter = libm::sqrt((square / n - mean * mean).max(0.0) / axes as f64);
                let differences = Differences { scatter, mean, delay_s: None };
                called += u32::from(differences.is_too_small(axes, 1.0));
            }
            let share = f64::from(called) / f64::from(runs);
            // Four standard deviations of a count.
            let within = 4.0 * libm::sqrt(expected / f64::from(runs));
            assert!((share - expected).abs() < within, "{draws} {axes}: {share}, {expected}");
            assert!(share < 0.01 + within);
        }
    }
}

/// A line of a log at a second: position of two talkers, velocity, date, attitude, deviations, damage, late, other kinds.
fn line(kind: u8, second: u32) -> String {
    let time = format!("12{:02}{:02}", second / 60, second % 60);
    match kind {
        0 => gga("GP", second, 0.0, 4),
        1 => gga("IN", second, 0.0, 6),
        2 => gga("GP", second, 0.0, 0),
        3 => sentence(&format!("GPVTG,0.0,T,,M,{second}.5,N,,K,A")),
        4 => sentence(&format!("GPZDA,{time},26,11,2026,00,00")),
        5 => sentence(&format!("PASHR,{time},1.0,T,2.0,3.0,0.0,0.1,0.1,0.2,1")),
        6 => sentence(&format!("GPGST,{time},1.0,,,,0.25,0.5,0.75")),
        7 => gga("GP", second, 0.0, 4).replacen(",W,", ",E,", 1),
        8 => gga("GP", second.saturating_sub(30), 0.0, 4),
        9 => sentence("GPGSV,1,1,00"),
        10 => "no sentence\r\n".to_owned(),
        11 => gga("GP", second, 0.0, 4).split('*').next().unwrap().to_owned() + "\r\n",
        12 => gga("GP", second, 0.0, 8),
        13 => sentence("GPGGA,99,x"),
        _ => "\r\n".to_owned(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Whatever the lines are, each of them is in the account once.
    #[test]
    fn every_line_of_a_log_is_counted_once(
        kinds in prop::collection::vec((0_u8..15, 0_u32..3), 1..200),
        talker in prop::option::of(prop::sample::select(vec!["GP", "IN"])),
        fixes_alone in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let mut text = sentence("GPZDA,120000,26,11,2026,00,00");
        let mut second = 0;
        for (kind, later) in kinds {
            second += later;
            text += &line(kind, second);
        }
        let path = file(folder.path(), "a.nmea", &text);
        let mut reader = TrajectoryReader::open(&path, &nmea(talker, fixes_alone)).unwrap();
        let mut points = 0;
        while reader.next().unwrap().is_some() {
            points += 1;
        }
        let account = reader.account("solution");
        let lines = text.lines().filter(|line| !line.trim().is_empty()).count() as u64;
        prop_assert_eq!(account.read(), lines, "{:?}", account.lines());
        prop_assert!(account.used_count() >= points);
    }

    /// Likewise rows of text.
    #[test]
    fn every_row_of_text_is_counted_once(kinds in prop::collection::vec(0_u8..5, 1..200)) {
        let folder = tempfile::tempdir().unwrap();
        let mut text = String::from("# preamble\ntime_s,latitude_deg,longitude_deg\n1000,60,10\n");
        for (second, kind) in (1001..).zip(&kinds) {
            text += &match kind {
                0 => format!("#{second},60,10\n"),
                1 => format!("{second},,\n"),
                2 => format!("{},60,10\n", second - 5),
                3 => "\n".to_owned(),
                _ => format!("{second},60,10\n"),
            };
        }
        let path = file(folder.path(), "a.csv", &text);
        let mut reader = TrajectoryReader::open(&path, &csv()).unwrap();
        let mut points = 0;
        while reader.next().unwrap().is_some() {
            points += 1;
        }
        let account = reader.account("solution");
        let rows = text.lines().skip(2).filter(|line| !line.is_empty()).count() as u64;
        prop_assert_eq!((account.read(), account.used_count()), (rows, points));
    }
}
