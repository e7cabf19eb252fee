//! Recordings are read by other MCAP readers: `tests/rigs/mcap_reader.py`, when `OCTANT_PYTHON`
//! names a Python that has the packages of `tests/rigs/requirements.txt`.

use crate::common::epochs::push;
use crate::common::stream::stream;
use octant_recorder::{Policy, Recorder, RecorderOptions, Samples};
use octant_test_processes::command;
use std::path::Path;

#[test]
fn the_python_readers_find_the_same_messages() {
    let Some(python) = std::env::var_os("OCTANT_PYTHON") else {
        println!("skipped: OCTANT_PYTHON is not set");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/rigs/mcap_reader.py");
    let folder = tempfile::tempdir().unwrap();
    for samples in [Samples::Full, Samples::Decimated] {
        let path = folder.path().join(format!("{}.mcap", samples.name()));
        let options = RecorderOptions {
            policy: Policy { samples, ..Policy::default() },
            scenario: "schema = 1\n".into(),
            ..RecorderOptions::default()
        };
        let mut recorder = Recorder::to_file(&path, &options).unwrap();
        let mut steps = stream(200 * 30);
        for step in &mut steps[3000..3020] {
            step.faulted.sample.delta_theta = [0; 3];
        }
        for step in &steps {
            push(&mut recorder, step).unwrap();
        }
        let summary = recorder.finish().unwrap();
        let output = command(&python)
            .arg(&script)
            .arg(&path)
            .args(
                summary
                    .messages
                    .iter()
                    .flat_map(|(topic, count)| ["--expect".to_owned(), format!("{topic}={count}")]),
            )
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        println!("{text}");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        // A field by name, by their decoder: the last sample of the stream.
        let last = steps.last().unwrap().faulted.sample;
        let expected = format!(
            "sequence={}, device_time_ns={}, delta_theta=[{}, {}, {}]",
            last.sequence,
            last.device_time.ns,
            last.delta_theta[0],
            last.delta_theta[1],
            last.delta_theta[2]
        );
        assert!(text.contains(&expected), "expected {expected}");

        // The readers detect a flipped bit too.
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        std::fs::write(&path, &bytes).unwrap();
        let output = command(&python).arg(&script).arg(&path).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
