//! Innovations of each axis: recorded beside their NIS, shown, exported, and of the size that the filter expects.

use crate::common::program::{ended, octant_in};
use octant_recorder::reader::{Epochs, Recording};
use octant_sample::{Innovation, InnovationOf};
use std::path::Path;

/// Runs an hour of calibration at 20 Hz; returns NIS and innovation of every recorded measurement.
fn measurements(folder: &Path, more: &[&str]) -> Vec<(f64, Innovation)> {
    let text = "schema = 1\n[imu]\nrate = \"20 Hz\"\n[procedure.calibration]\nduration = \"1 h\"\n";
    std::fs::write(folder.join("hour.toml"), text).unwrap();
    let run = [&["run", "hour.toml", "--out", "run"], more].concat();
    ended(octant_in(folder, &run), 0);
    let recording = Recording::open(&folder.join("run/recording.mcap")).unwrap();
    let mut epochs = Epochs::new(recording);
    let mut found = Vec::new();
    while let Some(epoch) = epochs.next_epoch().unwrap() {
        let nis = epoch.output.map_or(f64::NAN, |output| output.nis);
        assert_eq!(epoch.innovation.is_some(), nis.is_finite(), "at {} ns", epoch.time_ns);
        found.extend(epoch.innovation.map(|innovation| (nis, innovation)));
    }
    found
}

#[test]
fn innovations_of_a_run_fit_their_nis_and_what_the_filter_expects() {
    let folder = tempfile::tempdir().unwrap();
    let all = measurements(folder.path(), &[]);
    // One measurement a second, and the recording's grid has one epoch a second.
    assert!((3590..=3600).contains(&all.len()), "{}", all.len());
    let mut squares = [0.0; 3];
    for (nis, innovation) in &all {
        assert_eq!(innovation.of, InnovationOf::Velocity);
        for (axis, square) in squares.iter_mut().enumerate() {
            let normalized = innovation.value[axis] / innovation.sigma[axis];
            // ν'S⁻¹ν is at least νᵢ²/Sᵢᵢ, for any S (Cauchy and Schwarz).
            assert!(normalized * normalized <= nis * (1.0 + 1e-9), "{nis}: {innovation:?}");
            *square += normalized * normalized;
        }
    }
    for square in squares {
        // A mean of n squares of unit variance has σ √(2/n) = 0.024; four of them.
        let mean = square / all.len() as f64;
        assert!((mean - 1.0).abs() < 0.095, "{squares:?}");
    }

    let (said, _) = ended(octant_in(folder.path(), &["report", "run", "--out", "again.html"]), 0);
    let page = std::fs::read_to_string(folder.path().join("run/report.html")).unwrap();
    let again = std::fs::read_to_string(folder.path().join("again.html")).unwrap();
    for axis in ["north", "east", "down"] {
        let title = format!("Innovation of velocity {axis}");
        assert!(page.contains(&title) && again.contains(&title), "{axis}: {said}");
    }

    let export = ["export", "run", "--to", "csv", "--out", "tables", "--tables", "innovations"];
    ended(octant_in(folder.path(), &export), 0);
    let rows = std::fs::read_to_string(folder.path().join("tables/innovations.csv")).unwrap();
    let mut lines = rows.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let east = head.iter().position(|name| *name == "velocity_east_sigma_mps").unwrap();
    let first: f64 = lines.next().unwrap().split(',').nth(east).unwrap().parse().unwrap();
    assert_eq!(first.to_bits(), all[0].1.sigma[1].to_bits());
    assert_eq!(lines.count() + 1, all.len());
}

#[test]
fn innovations_of_positions_are_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    let more = ["--set", "procedure.calibration.aiding.reference=\"dock-position\""];
    let all = measurements(folder.path(), &more);
    assert!(all.len() > 3000, "{}", all.len());
    assert!(all.iter().all(|(_, innovation)| innovation.of == InnovationOf::Position));
}
