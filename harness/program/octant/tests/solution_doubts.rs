//! Solutions whose files leave something open: gaps, copies of the reference, constants, talkers, stated deviations.

use crate::common::program::program;
use crate::score_solution::{HEADER, circle, drifting, rows, score, seconds, summary};
use std::path::Path;
use std::process::Output;

/// Requires a limit of the position, with a reference of 0.5 m.
fn required(folder: &Path, limit: &str) {
    let text = format!(
        "schema = 1\ntitle = \"sea trial\"\n[[requirements]]\nid = \"NAV-1\"\ntext = \"Stays near.\"\n\
         measure = \"navigation.radial_error_nmi.max\"\nlimit = \"{limit}\"\n[decision]\nposition = \"0.5 m\"\n"
    );
    std::fs::write(folder.join("trial.toml"), text).unwrap();
}

fn scored(folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let ended = score(folder, &[&["--scenario", "trial.toml"], more].concat());
    (ended.status.code(), text_of(&ended))
}

fn text_of(ended: &Output) -> String {
    String::from_utf8_lossy(&[&ended.stdout[..], &ended.stderr].concat()).into_owned()
}

/// Three hours that drift by 3′, with a peak of 60 nmi within 100 s.
fn peaking(t: f64) -> [f64; 5] {
    let [latitude, longitude, north, east, heading] = drifting(t);
    let within = if (5000.0..5100.0).contains(&t) { (t - 5000.0) / 100.0 } else { 0.0 };
    let peak_deg = (std::f64::consts::PI * within).sin().powi(2);
    [latitude + peak_deg, longitude, north, east, heading]
}

#[test]
fn a_peak_that_is_hidden_in_a_gap_is_no_pass() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    required(here, "5 nmi");
    let whole = rows(seconds(0, 10_800), circle, 0.0);
    let peak = rows(seconds(0, 10_800), peaking, 0.0);
    let hidden = |line: &str| {
        let time = line.split(',').next().and_then(|time| time.parse::<f64>().ok());
        time.is_some_and(|time| (5000.0..5100.0).contains(&time))
    };
    let without = |text: &str| -> String {
        text.lines().filter(|line| !hidden(line)).map(|line| format!("{line}\n")).collect()
    };
    let commented: String = peak
        .lines()
        .map(|line| format!("{}{line}\n", if hidden(line) { "#" } else { "" }))
        .collect();
    let none: String = peak
        .lines()
        .map(|line| match line.split(',').next() {
            Some(time) if hidden(line) => format!("{time},,,,,0,0,0\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let offset = ["--offset", "0 s"];
    for (solution, reference, status, words) in [
        (peak.clone(), whole.clone(), 1, "is 61.4"),
        (
            without(&peak),
            whole.clone(),
            3,
            "100 points in a gap of 101 s from 4999 s (before line 5002)",
        ),
        (commented, whole.clone(), 3, "100 lines among the rows that begin with the comment mark)"),
        (none, whole.clone(), 3, "100 rows without a position)"),
        (peak.clone(), without(&whole), 3, "100 points without a reference at their time)"),
    ] {
        std::fs::write(here.join("ins.csv"), solution).unwrap();
        std::fs::write(here.join("ref.csv"), reference).unwrap();
        let (found, text) = scored(here, &offset);
        assert_eq!(found, Some(status), "{text}");
        assert!(text.contains(words), "{words}: {text}");
        if status == 3 {
            let reason = "NAV-1: met where it was scored: of 1 gap, the longest of 101 s from 4999 s, one is too long";
            assert!(text.contains(reason), "{text}");
            // The same words in summary and report.
            let inputs = summary(here)["inputs"].to_string();
            assert!(inputs.contains("points in a gap of 101 s from 4999 s"), "{inputs}");
            let page = std::fs::read_to_string(here.join("out/report.html")).unwrap();
            assert!(page.contains("points in a gap of 101 s from 4999 s"), "{page}");
        }
    }
    // A gap of 10 s hides at most twice the largest change that the run shows within half of it.
    let lost = rows(seconds(0, 10_800).filter(|t| !(5000.0..5010.0).contains(t)), drifting, 0.0);
    std::fs::write(here.join("ins.csv"), lost).unwrap();
    std::fs::write(here.join("ref.csv"), &whole).unwrap();
    let (found, text) = scored(here, &offset);
    assert_eq!(found, Some(0), "{text}");
    assert!(text.contains("missing: 10 points in a gap of 11 s from 4999 s"), "{text}");
    let bounds = summary(here)["navigation"]["gaps"]["bounds"].clone();
    assert!(bounds["radial_error_nmi.max"].as_f64().unwrap() < 3.01, "{bounds}");
}

#[test]
fn a_copy_of_the_reference_shows_nothing_rounded_or_late() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    required(here, "1 nmi");
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 3600), circle, 0.0)).unwrap();
    let rounded = |digits: i32| {
        move |t: f64| {
            let scale = 10_f64.powi(digits);
            circle(t).map(|number| (number * scale).round() / scale)
        }
    };
    // An independent solution: 0.1 to 0.3 m off, as the errors of a reference of 0.5 m (95 %) are.
    let independent = |t: f64| {
        let [latitude, longitude, north, east, heading] = circle(t);
        let metres = 1.0 / 111_000.0;
        let off = [0.2 + 0.1 * (t / 90.0).sin(), 0.15 * (t / 130.0).cos()].map(|m| m * metres);
        [latitude + off[0], longitude + off[1], north + 0.01, east, heading]
    };
    type Solution<'a> = &'a dyn Fn(f64) -> [f64; 5];
    let cases: [(Solution<'_>, i32, &str); 5] = [
        (&rounded(6), 3, "the positions of the solution are those of the reference, but for 0.02"),
        (&rounded(7), 3, "far below the reference's own uncertainty of 0.5 m (95 %)"),
        (&|t| circle(t - 1.0), 3, "are those of the reference 1 s before, but for"),
        (&|t| rounded(7)(t + 0.5), 3, "are those of the reference 0.5 s later, but for"),
        (&independent, 0, "pass"),
    ];
    for (solution, status, words) in cases {
        std::fs::write(here.join("ins.csv"), rows(seconds(1, 3599), solution, 0.0)).unwrap();
        let (found, text) = scored(here, &["--offset", "0 s"]);
        assert_eq!(found, Some(status), "{text}");
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn constants_at_rest_show_nothing_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    required(here, "1 nmi");
    let still = |_: f64| [45.0, 10.0, 0.0, 0.0, 90.0];
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 3600), still, 0.0)).unwrap();
    // The position drifts, and the unit prints 0.0 kn beside a reference of 0.
    let drifts = |t: f64| [45.0 + t * 1e-6, 10.0, 0.0, 0.0, 90.0];
    std::fs::write(here.join("ins.csv"), rows(seconds(0, 3600), drifts, 0.0)).unwrap();
    let (found, text) = scored(here, &["--offset", "0 s"]);
    assert_eq!(found, Some(0), "{text}");
    std::fs::write(here.join("ins.csv"), rows(seconds(0, 3600), still, 0.0)).unwrap();
    let (found, text) = scored(here, &["--offset", "0 s"]);
    assert_eq!(found, Some(3), "{text}");
    assert!(text.contains("no number of the solution changes over its 3601 points"), "{text}");
}

/// A sentence with its checksum.
fn sentence(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte))
}

#[test]
fn a_talker_is_chosen_by_its_letters() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    required(here, "0.0027 nmi");
    // 5 m are 0.0027 nmi. GP is exact within 0.4 m, IN 12 m off.
    let angle = |deg: f64, digits: usize| {
        let minutes = deg.fract() * 60.0;
        format!("{:0digits$}{minutes:010.7}", deg.trunc())
    };
    let mut text = String::new();
    for second in 0..600 {
        let [latitude, longitude, ..] = circle(f64::from(second));
        let time = format!("12{:02}{:02}.00", second / 60, second % 60);
        text += &sentence(&format!("GPZDA,{time},26,11,2026,00,00"));
        for (talker, off) in [("GP", 3e-6 + 1e-6 * f64::from(second % 7)), ("IN", 12.0 / 111_130.0)]
        {
            let position = format!("{},N,{},E", angle(latitude + off, 2), angle(longitude, 3));
            text += &sentence(&format!("{talker}GGA,{time},{position},1,8,1,10.0,M,40.0,M,,"));
        }
    }
    std::fs::write(here.join("two.nmea"), text).unwrap();
    // 2026-11-26T12:00:00Z, by `date -u -d`.
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 600), circle, 0.0)).unwrap();
    let offset = ["--offset", "-1795694400 s"];
    let files =
        ["score", "--solution", "two.nmea", "--reference", "ref.csv", "--out", "out", "--force"];
    let call = |more: &[&str]| {
        let scenario = ["--scenario", "trial.toml"];
        let ended = program(&[&files[..], &scenario, &offset, more].concat());
        let ended = { ended }.current_dir(here).output().unwrap();
        (ended.status.code(), text_of(&ended))
    };
    let (status, said) = call(&[]);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("talkers GP and IN disagree") && said.contains("11.7 m"), "{said}");
    let (status, said) = call(&["--talker", "GP"]);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("left out: 600 sentences of other talkers"), "{said}");
    let (status, said) = call(&["--talker", "IN"]);
    assert_eq!(status, Some(1), "{said}");
    // Invalid fixes and damage are gaps with their causes.
    let whole = std::fs::read_to_string(here.join("two.nmea")).unwrap();
    let part = |line: &str| {
        let position = line.starts_with("$GPGGA");
        let second = (position && line.contains(",1203")) || line.contains("GPGGA,120500");
        if !second {
            return format!("{line}\r\n");
        }
        match line.contains(",1203") {
            true => sentence(&line[1..line.len() - 3].replace(",E,1,8", ",E,0,8")),
            false => format!("{}00\r\n", &line[..line.len() - 2]),
        }
    };
    std::fs::write(here.join("two.nmea"), whole.lines().map(part).collect::<String>()).unwrap();
    let (status, said) = call(&["--talker", "GP"]);
    assert_eq!(status, Some(3), "{said}");
    for words in [
        "60 points in a gap of 61 s from 179 s (before line",
        "60 sentences without a valid fix",
        "1 point in a gap of 2 s from 299 s (before line",
        "1 sentences with a wrong checksum",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let (status, said) = call(&["--talker", "GPS receiver"]);
    assert!(status == Some(2) && said.contains("expected the letters of a talker"), "{said}");
    std::fs::write(here.join("ins.csv"), rows(seconds(0, 600), drifting, 0.0)).unwrap();
    let (status, said) = scored(here, &["--offset", "0 s", "--talker", "GP"]);
    assert!(status == Some(2) && said.contains("which is no NMEA 0183"), "{said}");
}

#[test]
fn standard_deviations_of_a_reference_widen_the_band() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // 10 m off, and a limit of 15 m, 0.0081 nmi: with a reference of 4.5 m (1 sigma) that shows nothing.
    required(here, "0.0081 nmi");
    let off = |t: f64| {
        let [latitude, longitude, north, east, heading] = circle(t);
        let metres = 10.0 + 0.2 * (t / 100.0).sin();
        [latitude + metres / 111_130.0, longitude, north, east, heading]
    };
    // GPS time is 18 s ahead of UTC: 2026-11-26T12:00:00Z is second 388818 of week 2446.
    let reference = |quality: &str, sigma_m: f64| {
        (0..=600).fold(
            String::from("%  GPST  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)\n"),
            |text, second| {
                let [latitude, longitude, ..] = circle(f64::from(second));
                text + &format!(
                    "2446 {:.3} {latitude:.9} {longitude:.9} 0.0 {quality} 9 {sigma_m} {sigma_m} 9.0\n",
                    388_818.0 + f64::from(second)
                )
            },
        )
    };
    std::fs::write(here.join("ins.csv"), rows(seconds(0, 600), off, 0.0)).unwrap();
    let offset = ["--offset", "1795694400 s"];
    let files =
        ["score", "--solution", "ins.csv", "--reference", "ref.pos", "--out", "out", "--force"];
    for (quality, sigma_m, status, words) in [
        ("1", 0.01, 0, "points of quality 1 (fixed ambiguities), 100 %"),
        ("5", 4.5, 3, "points of quality 5 (single), 100 %"),
    ] {
        std::fs::write(here.join("ref.pos"), reference(quality, sigma_m)).unwrap();
        let arguments = [&files[..], &["--scenario", "trial.toml"], &offset].concat();
        let ended = program(&arguments).current_dir(here).output().unwrap();
        let text = text_of(&ended);
        assert_eq!(ended.status.code(), Some(status), "{text}");
        let found = summary(here);
        let inputs = found["inputs"].to_string();
        assert!(inputs.contains(words), "{inputs}");
        let uncertainty = found["requirements"][0]["uncertainty"].as_f64().unwrap();
        // 95 % of what the file states, or of what the scenario does: 0.5 m.
        let expected = (1.96 * sigma_m).max(0.5) / 1852.0;
        assert!((uncertainty - expected).abs() < 1e-6, "{uncertainty}, expected {expected}");
    }
}

#[test]
fn a_late_row_is_left_out_and_an_offset_may_be_a_clocks_whole_age() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    required(here, "2 nmi");
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 3700), circle, 1_795_694_400.0)).unwrap();
    let solution = rows(seconds(60, 3660), drifting, 0.0);
    let late = solution.lines().nth(100).unwrap().to_owned();
    let mut lines: Vec<&str> = solution.lines().collect();
    lines.insert(2000, &late);
    std::fs::write(here.join("ins.csv"), lines.join("\n") + "\n").unwrap();
    let (found, text) = scored(here, &["--offset", "1795694400 s"]);
    assert_eq!(found, Some(0), "{text}");
    let words = "left out: 1 out of order, of a time that isn't after a point before them, the first line 2001: \
                 found a time 1899.000000000 s before the point before it";
    assert!(text.contains(words), "{text}");
    // Each point has its reason, also of those before and after the time that is scored.
    let part = ["--offset", "1795694400 s", "--skip", "10 min", "--duration", "30 min"];
    let (found, text) = scored(here, &part);
    assert_eq!(found, Some(0), "{text}");
    assert!(
        text.contains("points of the solution: 3601 points read, 1800 used, 1801 left out"),
        "{text}"
    );
    assert!(text.contains("600 points before the time that is scored"), "{text}");
    assert!(text.contains("1201 points after the time that is scored"), "{text}");
    // Where it is the rule, the file isn't one.
    let mut backward: Vec<&str> = solution.lines().skip(1).collect();
    backward.reverse();
    std::fs::write(here.join("ins.csv"), HEADER.to_owned() + &backward.join("\n")).unwrap();
    let (found, text) = scored(here, &["--offset", "1795694400 s"]);
    assert_eq!(found, Some(2), "{text}");
    assert!(
        text.contains("3600 are out of order in all, expected times that run forward"),
        "{text}"
    );
}
