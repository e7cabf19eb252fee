//! The picture of a run on the terminal.

use crate::known::{known, shows};
use crate::screen::screen;
use octant_evidence::{Existing, RunFolder};
use octant_watch::dashboard::Page;
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::RunPlace;
use octant_watch::plain;

#[test]
fn the_dashboard_shows_a_known_state() {
    let here = tempfile::tempdir().unwrap();
    let folder = RunFolder::create(&here.path().join("known"), Existing::Refuse).unwrap();
    // The recording is complete, so that all of it is in the file; the run isn't.
    known(&folder).finish().unwrap();
    let mut follow = Follow::new(RunPlace::of(folder.path()).unwrap());
    while follow.look(|_, _, _| {}).unwrap() {}
    assert_eq!(follow.stage, Stage::Recorded, "its writer holds the lock, and has no verdict yet");
    let state = &follow.state;
    assert_eq!(state.time_ns, 20_000_000_000);
    assert_eq!(state.about.unread, None);

    let output = state.output.unwrap();
    let latitude_arcmin = (output.navigation.latitude_rad - 0.53).to_degrees() * 60.0;
    assert!((state.drift.unwrap().latitude_arcmin - latitude_arcmin).abs() < 1e-9);
    // The parameters on the screen are those of the file, in display units.
    let (_, estimate) = state.parameters.as_ref().unwrap();
    let bias_degph = estimate.parameters.gyro_bias[0].to_degrees() * 3600.0;
    assert!(bias_degph.abs() > 1e-6);

    let text = screen(&follow, Page::Overview, 100, 35);
    shows(
        &text,
        &[
            "a known state",
            "20.0 s of 40.0 s, 50.0 %",
            "recorded, and not judged yet",
            "mode      navigating",
            "stop      5",
            "azimuth 0.00°, roll 0.00°",
            "latitude",
            "largest, navigating",
            "nmi",
            "Parameters ±1σ",
            "gyro bias",
            "deg/h/g",
            "arcsec",
            "Faults: 1 of 2 fired",
            "spike-1 (spike) acts since 15.0 s",
            "late-1 (late-delivery) armed, at 30 s",
            "late      54.2 µs",
            "overruns  2 above 1.00 ms",
            "q leave",
        ],
    );
    shows(&screen(&follow, Page::Log, 100, 35), &["mode navigating", "spike-1 (spike) sets in"]);
    shows(&screen(&follow, Page::Curves, 100, 35), &["latitude", "NIS", "lateness"]);
    shows(&plain::page(&follow), &["gyro_bias_x", "± ", "spike-1", "50.0 %", "54.2 µs late"]);
    shows(&plain::line(&follow), &["20.0 s", "50.0 %", "1 of 2 faults fired, spike-1 acts"]);
    // No terminal is too small.
    for (width, height) in [(1, 1), (20, 5), (40, 12), (300, 3)] {
        for page in [Page::Overview, Page::Curves, Page::Log, Page::Parameters] {
            screen(&follow, page, width, height);
        }
    }
}
