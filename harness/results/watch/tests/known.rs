//! A run in a known state, and what is shown of it.

use crate::common::epochs::push;
use crate::common::stream::stream;
use octant_evidence::RunFolder;
use octant_recorder::event::Pace;
use octant_recorder::{Event, Recorder, RecorderOptions};
use std::collections::BTreeMap;

const SCENARIO: &str = "schema = 1\ntitle = \"a known state\"\nseed = 7\n[realtime]\n\
    pace = \"clock\"\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"40 s\"\n\
    [[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
    amplitude = \"1000 deg/h\"\ntrigger = { at = \"5 s\" }\nduration = \"20 samples\"\n\
    [[faults]]\nid = \"late-1\"\nkind = \"late-delivery\"\ndelay = \"3 samples\"\n\
    trigger = { at = \"30 s\" }\nduration = \"20 samples\"\n";

/// Records 20 s of the test stream with an active fault and a report of the time keeping, not yet
/// ended.
pub(crate) fn known(folder: &RunFolder) -> Recorder {
    let options = RecorderOptions {
        scenario: SCENARIO.to_owned(),
        metadata: BTreeMap::from([("seed".to_owned(), "7".to_owned())]),
        ..RecorderOptions::default()
    };
    let path = folder.path().join("recording.mcap");
    let mut recorder = Recorder::to_file(&path, &options).unwrap();
    for (k, step) in stream(4000).iter().enumerate() {
        push(&mut recorder, step).unwrap();
        if k == 3000 {
            let (id, kind) = ("spike-1".to_owned(), "spike".to_owned());
            recorder.event(Event::Fault { begins: true, id, kind, sample: 3001 });
            let (frames, latest_us, overruns, late_answers) = (3000, 54.25, 2, 1);
            recorder.event(Event::Pace(Pace { frames, late_answers, latest_us, overruns }));
        }
    }
    recorder
}

#[track_caller]
pub(crate) fn shows(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
}
