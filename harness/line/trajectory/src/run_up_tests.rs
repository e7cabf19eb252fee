//! Run-ups of a heading test in a file, answers without a heading, stated places in a cycle, and what columns state of themselves.

use crate::comparison::ErrorName;
use crate::pairs::{SolutionPair, SolutionPairs};
use crate::point::SECOND_NS;
use crate::reader::TrajectoryReader;
use octant_scenario::Scenario;
use octant_scenario::SourceSpec;
use octant_scenario::trajectory::{
    HeadingDelay, HeadingTime, NmeaChoice, NmeaPoints, TrajectoryFormat,
};
use std::path::Path;

/// 2026-11-20T10:00:00Z.
const TEN_S: i64 = 1_795_168_800;

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

fn tagged(at_s: i64, body: &str) -> String {
    let fields = format!("c:{at_s}");
    let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("\\{fields}*{sum:02X}\\{}", sentence(body))
}

/// The pairs of a scenario with a file, and the doubt about them.
fn pairs(folder: &Path, toml: &str) -> (Vec<SolutionPair>, SolutionPairs) {
    let scenario = Scenario::parse(toml, "s.toml", folder, &[]).unwrap();
    let SourceSpec::Solution(spec) = &scenario.source else { panic!("no solution") };
    let site_rad = [scenario.site.latitude_rad, scenario.site.longitude_rad];
    let mut pairs = SolutionPairs::open(spec, (folder, site_rad), SECOND_NS as u64, None).unwrap();
    let mut all = Vec::new();
    while let Some(pair) = pairs.next_pair().unwrap() {
        all.push(pair);
    }
    (all, pairs)
}

const TEST: &str = "schema = 1
title = \"run-ups\"
[source]
uri = \"solution:all.nmea\"
[source.solution]
switched_on = [\"2026-11-20T10:00:10Z\", \"2026-11-20T10:05:00Z\"]
[source.trajectory]
true_heading = \"40 deg\"
true_heading_uncertainty = \"0.1 deg\"
[procedure.navigation]
duration = \"2 min\"
[procedure.heading_test]
test = \"settle\"
run_ups = 2
azimuths = [\"0 deg\", \"90 deg\"]
";

/// Two run-ups of two minutes; in the first 20 s of each there is no heading, and the sentences go on in the pause.
fn two_run_ups() -> String {
    let body = |t: i64| match t {
        10..30 | 300..320 => "HETHS,,V".to_owned(),
        ..300 => format!("HETHS,40.{},A", t % 2),
        _ => format!("HETHS,130.{},A", t % 2),
    };
    (0..=425).map(|t| tagged(TEN_S + t, &body(t))).collect()
}

#[test]
fn the_time_of_a_run_is_that_with_power() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all.nmea"), two_run_ups()).unwrap();
    let (all, pairs) = pairs(folder.path(), TEST);
    // From 30 to 130 s and from 320 to 420 s of the file.
    assert_eq!(all.len(), 202);
    let seconds = |pair: &SolutionPair| pair.time_ns / SECOND_NS as u64;
    assert_eq!((seconds(&all[0]), seconds(&all[100])), (21, 121));
    assert_eq!((seconds(&all[101]), seconds(&all[201])), (141, 241));
    let true_deg = |pair: &SolutionPair| pair.reference.attitude_rad().unwrap()[2].to_degrees();
    assert!((true_deg(&all[0]) - 40.0).abs() < 1e-9 && (true_deg(&all[201]) - 130.0).abs() < 1e-9);
    let without = pairs.comparison().without_heading_ns();
    assert_eq!(without.len(), 40);
    assert_eq!((without[0], without[20]), (SECOND_NS as u64, 121 * SECOND_NS as u64));
    assert_eq!(pairs.doubt(), None);
    let accounts: String = pairs.accounts().iter().map(|a| format!("{a:?}")).collect();
    assert!(accounts.contains("without power, or before"), "{accounts}");
    // The pause is no gap.
    assert!(!accounts.contains("gap"), "{accounts}");
}

#[test]
fn run_ups_that_are_missing_cut_short_or_too_close_are_no_evidence() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = two_run_ups();
    let doubt = |text: &str, toml: &str| {
        std::fs::write(here.join("all.nmea"), text).unwrap();
        pairs(here, toml).1.doubt().unwrap_or_default()
    };
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    assert_eq!(doubt(&lines[..400].concat(), TEST), "run-up 2 ends at 99 s, expected 120 s");
    assert_eq!(doubt(&lines[..200].concat(), TEST), "run-up 2 has no heading");
    let one = TEST.replace(", \"2026-11-20T10:05:00Z\"", "");
    assert_eq!(doubt(&text, &one), "1 of 2 run-ups were begun");
    // The first run-up again, with later stamps.
    let copy: Vec<String> = (10..=130)
        .map(|t: i64| (t, lines[t as usize].split_once("\\$").unwrap().1.trim_end()))
        .map(|(t, body)| tagged(TEN_S + t + 290, body.split_once('*').unwrap().0))
        .collect();
    let twice = lines[..290].concat() + &copy.concat();
    let level = TEST.replace("\"90 deg\"", "\"0 deg\"");
    assert!(
        doubt(&twice, &level).contains("one is a copy of the other"),
        "{}",
        doubt(&twice, &level)
    );
    // The first run-up would go on in the second.
    let close = TEST.replace("10:05:00Z", "10:02:00Z");
    std::fs::write(here.join("all.nmea"), &text).unwrap();
    let scenario = Scenario::parse(&close, "s.toml", here, &[]).unwrap();
    let SourceSpec::Solution(spec) = &scenario.source else { panic!("no solution") };
    let refused = SolutionPairs::open(spec, (here, [0.0; 2]), SECOND_NS as u64, None).unwrap_err();
    assert!(refused.to_string().contains("110 s after the first, expected 120 s"), "{refused}");
    // Constants show nothing, with a true heading and without.
    let constant: String = (0..=425).map(|t| tagged(TEN_S + t, "HETHS,40.0,A")).collect();
    assert!(doubt(&constant, TEST).contains("no number of the solution changes"));
    let blind =
        TEST.replace("true_heading = \"40 deg\"\ntrue_heading_uncertainty = \"0.1 deg\"\n", "");
    let blind = blind.replace("azimuths = [\"0 deg\", \"90 deg\"]\n", "");
    assert!(doubt(&constant, &blind).contains("no number of the solution changes"));
    assert_eq!(doubt(&text, &blind), "");
}

#[test]
fn a_place_in_the_cycle_that_is_known_takes_the_doubt_away() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.nmea");
    let zda = |second: u32| {
        sentence(&format!("GPZDA,10{:02}{:02}.00,20,11,2026,00,00", second / 60, second % 60))
    };
    let text: String =
        (0..10).map(|t| zda(t) + &sentence("HEHDT,40.0,T") + &sentence("HEHDT,40.1,T")).collect();
    std::fs::write(&path, text).unwrap();
    let read = |heading_delay| {
        let format = TrajectoryFormat::Nmea(NmeaChoice {
            points: Some(NmeaPoints::Headings),
            heading_time: Some(HeadingTime::Cycle),
            heading_delay,
            ..NmeaChoice::default()
        });
        let mut reader = TrajectoryReader::open(&path, &format).unwrap();
        std::iter::from_fn(|| reader.next().unwrap()).collect::<Vec<_>>()
    };
    let unknown = read(None);
    let known = read(Some(HeadingDelay { delay_s: -0.25, uncertainty_s: 0.02 }));
    assert_eq!(unknown.len(), known.len());
    for (unknown, known) in unknown.iter().zip(&known) {
        assert_eq!(known.time_ns, unknown.time_ns - SECOND_NS / 4);
        assert_eq!((unknown.attitude_doubt_s, known.attitude_doubt_s), (0.5, 0.02));
    }
}

const COLUMNS: &str = "schema = 1
title = \"columns\"
[site]
latitude = \"60 deg\"
longitude = \"10 deg\"
[source]
uri = \"solution:ins.csv\"
[source.trajectory]
file = \"ref.csv\"
offset = \"0 s\"
sigma_north = \"sdn\"
sigma_east = \"sde\"
quality = \"fix\"
quality_left_out = [\"0\"]
[procedure.navigation]
";

#[test]
fn columns_of_text_state_standard_deviations_and_qualities() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let ins: String = (0..100).map(|t| format!("{t},60.000{t:02},10\n")).collect();
    std::fs::write(here.join("ins.csv"), format!("time_s,latitude_deg,longitude_deg\n{ins}"))
        .unwrap();
    let header = "time_s,latitude_deg,longitude_deg,sdn,sde,fix\n";
    let rows = |sigma: &str| -> String {
        (0..100)
            .map(|t| {
                // Rows without a fix are left out, and bridged.
                let fix = if t % 50 == 20 { "0" } else { "rtk" };
                format!("{t},60.000{t:02},10.00001,{sigma},0.3,{fix}\n")
            })
            .collect()
    };
    std::fs::write(here.join("ref.csv"), format!("{header}{}", rows("0.2"))).unwrap();
    let (all, found) = pairs(here, COLUMNS);
    assert_eq!(all.len(), 100);
    let north = found.comparison().band(ErrorName::Latitude).of("largest").unwrap();
    let radial = found.comparison().band(ErrorName::Radial).of("largest").unwrap();
    assert!((north - 1.96 * 0.2).abs() < 1e-12 && (radial - 1.96 * 0.3).abs() < 1e-12);
    let accounts: String = found.accounts().iter().map(|a| format!("{a:?}")).collect();
    for words in ["rows of a quality that is left out", "quality rtk"] {
        assert!(accounts.contains(words), "{words}: {accounts}");
    }
    // Zeros state nothing, and a negative one is none.
    let zero = rows("0.0").replace(",0.3,", ",0,");
    std::fs::write(here.join("ref.csv"), format!("{header}{zero}")).unwrap();
    assert_eq!(pairs(here, COLUMNS).1.comparison().band(ErrorName::Latitude).of("max"), None);
    for (sigma, words) in
        [("-0.2", "a standard deviation of 0 or more"), ("nan", "a finite number")]
    {
        std::fs::write(here.join("ref.csv"), format!("{header}{}", rows(sigma))).unwrap();
        let scenario = Scenario::parse(COLUMNS, "s.toml", here, &[]).unwrap();
        let SourceSpec::Solution(spec) = &scenario.source else { panic!("no solution") };
        let refused = SolutionPairs::open(spec, (here, [1.047, 0.174]), SECOND_NS as u64, None);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("line 2: column 4") && refused.contains(words), "{refused}");
    }
    // One of two is none.
    let half = COLUMNS.replace("sigma_east = \"sde\"\n", "");
    std::fs::write(here.join("ref.csv"), format!("{header}{}", rows("0.2"))).unwrap();
    let scenario = Scenario::parse(&half, "s.toml", here, &[]).unwrap();
    let SourceSpec::Solution(spec) = &scenario.source else { panic!("no solution") };
    let refused = SolutionPairs::open(spec, (here, [1.047, 0.174]), SECOND_NS as u64, None);
    assert!(refused.unwrap_err().to_string().contains("found some of sigma_north, sigma_east"));
}
