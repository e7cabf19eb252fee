//! The dashboard on a terminal of 80 columns and 24 lines: no word is cut.

use crate::common::known::shows;
use crate::common::program::octant_in;
use crate::common::screen::screen;
use octant_base::number::fixed;
use octant_recorder::Event;
use octant_recorder::event::Pace;
use octant_recorder::reader::Item;
use octant_watch::about::About;
use octant_watch::dashboard::Page;
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::RunPlace;
use octant_watch::plain;
use octant_watch::state::RunState;
use octant_watch::tail::{PollEnd, Tail};
use std::collections::BTreeSet;
use std::path::Path;

const SCENARIO: &str = r#"schema = 1
title = "instrument of Table 1 with two faults, on a bench"
[imu]
rate = "20 Hz"
[procedure.calibration]
duration = "24 min"
[procedure.navigation]
duration = "1 h"
[[faults]]
id = "spike-on-gyro-x"
kind = "spike"
channels = "gyro x"
amplitude = "1000 deg/h"
trigger = { position = 3, counted = "positions" }
duration = "20 samples"
[[faults]]
id = "stuck-z"
kind = "stuck-at-current"
channels = "accelerometer z"
trigger = { moving_to = 8, counted = "positions" }
duration = "10 s"
[[requirements]]
id = "NAV-1"
text = "The longitude error stays below 1 mm on the ground."
measure = "navigation.longitude_error_arcmin.max"
limit = "0.0001 arcsec"
"#;

/// Words of the small arrangement alone.
const SMALL: &[&str] = &[
    "largest",
    "last",
    "1",
    "s",
    "limit",
    "samples",
    "overruns",
    "answers",
    "late",
    "and",
    "more",
    "2",
    "gyro",
    "bias,",
    "scale,",
    "misalignment,",
    "g",
    "dependent,",
    "accel",
    "–",
    "…",
];

/// A run as it was at a time.
fn at(folder: &Path, until_s: u64) -> Follow {
    let place = RunPlace::of(folder).unwrap();
    let mut tail = Tail::new(place.clone());
    let (mut state, mut is_later) = (None, false);
    while !is_later {
        let end = tail.look(1000, |info, ns, item| {
            let state = state.get_or_insert_with(|| RunState::new(About::of(info, place.folder())));
            is_later |= ns > until_s * 1_000_000_000;
            if !is_later {
                state.take(ns, &item);
            }
        });
        is_later |= end.unwrap() == PollEnd::End;
    }
    let mut follow = Follow::new(place);
    follow.state = state.unwrap();
    follow.stage = Stage::Running;
    follow
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || "│┌┐└┘─━\"".contains(c))
        .filter(|word| !word.is_empty())
}

/// A word without the mark after it, which an ellipsis may take the place of.
fn bare(word: &str) -> &str {
    word.trim_end_matches([',', ';', ':'])
}

/// Checks that each word of the small terminal is one of the run's, and returns its overview.
#[track_caller]
fn whole(follow: &Follow) -> String {
    let state = &follow.state;
    let mut told = [plain::page(follow), plain::stage(follow), plain::end(follow)].join(" ");
    told += &follow.state.log.iter().map(|(_, text)| format!(" {text}")).collect::<String>();
    for page in [Page::Overview, Page::Log, Page::Parameters] {
        told += &screen(follow, page, 400, 120);
    }
    for drift in [state.drift.unwrap_or_default(), state.largest] {
        for value in [drift.latitude_arcmin, drift.longitude_arcmin, drift.radial_nmi] {
            told += &format!(" {}", fixed(value, 3));
        }
    }
    let known: BTreeSet<&str> = words(&told).chain(SMALL.iter().copied()).map(bare).collect();
    // A name with dots or a path may go on in the next line after its mark.
    let part = |word: &str| {
        known.iter().any(|whole| {
            let marks = ['.', '_', '/', '-'];
            let first = whole.starts_with(word) && word.ends_with(marks);
            let rest = whole.strip_suffix(word).is_some_and(|before| before.ends_with(marks));
            first || rest
        })
    };
    let place = follow.place.folder().display().to_string();
    let folder = |word: &str| word.strip_prefix('…').is_some_and(|tail| place.ends_with(tail));
    for page in [Page::Overview, Page::Log, Page::Parameters] {
        let small = screen(follow, page, 80, 24);
        for word in words(&small) {
            assert!(
                known.contains(bare(word)) || part(word) || folder(word),
                "{word:?} in\n{small}"
            );
        }
        shows(&small, &["1 overview   2 curves   3 log   4 parameters   q leave; the run goes on"]);
    }
    let curves = screen(follow, Page::Curves, 80, 24);
    shows(&curves, &[" Latitude and longitude error, arcmin ", " NIS (expected 3) "]);
    shows(&screen(follow, Page::Parameters, 80, 24), &["Parameters"]);
    screen(follow, Page::Overview, 80, 24)
}

const LABELS: &[&str] = &[
    " Core ",
    "mode",
    "stop",
    "for",
    "gimbals",
    "command",
    "NIS",
    "health",
    "last",
    " Position and drift ",
    "position",
    "velocity",
    "error",
    "now",
    "largest",
    "latitude",
    "longitude",
    "radial",
    "arcmin",
    "nmi",
];

#[test]
fn no_word_is_cut_at_80_columns_and_24_lines() {
    let here = tempfile::tempdir().unwrap();
    std::fs::write(here.path().join("s.toml"), SCENARIO).unwrap();
    let output = octant_in(here.path(), &["run", "s.toml", "--out", "runs/on-the-bench"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let run = here.path().join("runs/on-the-bench");

    // A calibration with faults.
    let calibration = at(&run, 700);
    let text = whole(&calibration);
    shows(&text, LABELS);
    shows(
        &text,
        &[
            "instrument of Table 1 with two faults, on a bench",
            "eight positions with G states, seed 1",
            "mode    calibrating",
            " of 19, position ",
            "Faults: 1 of 2 fired",
            "spike-on-gyro-x (spike)",
            "stuck-z (stuck-at-current) armed,",
            "What happened",
        ],
    );
    let parameters = screen(&calibration, Page::Parameters, 80, 24);
    shows(
        &parameters,
        &["gyro misalignment, arcsec", "g dependent, deg/h/g", "the worst", "accel bias, µg"],
    );
    for axis in ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"] {
        shows(&parameters, &[axis]);
    }

    // Navigation.
    let navigation = at(&run, 3000);
    let text = whole(&navigation);
    shows(&text, LABELS);
    shows(&text, &["mode    navigating", "largest navigating", "Faults: 2 of 2 fired"]);

    // The end, with a verdict.
    let mut ended = Follow::new(RunPlace::of(&run).unwrap());
    while ended.look(|_, _, _| {}).unwrap() {}
    assert!(matches!(ended.stage, Stage::Ended(_)));
    let text = whole(&ended);
    shows(&text, LABELS);
    shows(&text, &[" Verdict ", "ended: fail", "NAV-1", "1 h 24 min"]);

    // By the clock, with every number of the lateness, before the end and after it.
    let paced = |follow: &mut Follow| {
        let pace = Pace { frames: 1_680_000, late_answers: 3, latest_us: 12_345.0, overruns: 17 };
        follow.state.about.by_clock = true;
        follow.state.about.overrun_us = Some(20_000.0);
        follow.state.take(follow.state.time_ns, &Item::Event(Event::Pace(pace)));
    };
    let mut clocked = at(&run, 700);
    paced(&mut clocked);
    let text = whole(&clocked);
    shows(
        &text,
        &[" Lateness ", "last 1 s 12.3 ms", "largest  12.3 ms", "overruns 17", "limit    20.0 ms"],
    );
    shows(&text, &["answers  3 late", "samples  1680000"]);
    paced(&mut ended);
    shows(&whole(&ended), &[" Verdict ", " Lateness ", "overruns 17"]);

    // A run that broke off, and a scenario that can't be read.
    let mut broken = at(&run, 3000);
    let reason = "the instrument on serial:/dev/ttyUSB0?baud=921600 sent nothing for 10 s: the cable, its \
                  power or another program that has the port";
    let event = Event::Error { reason: reason.to_owned() };
    broken.state.take(broken.state.time_ns, &Item::Event(event));
    broken.state.about.unread =
        Some("scenario.toml:3:1: procedure.calibration.durration: unknown key".to_owned());
    broken.stage = Stage::BrokenOff;
    let text = whole(&broken);
    shows(&text, LABELS);
    shows(&text, &["scenario can't be read:", "broke off: nobody writes it any more"]);
    let log = screen(&broken, Page::Log, 80, 24);
    shows(&log, &["the run broke off: the instrument on", "program that has the port"]);

    // Before the first message.
    whole(&Follow::new(RunPlace::of(&run).unwrap()));
}
