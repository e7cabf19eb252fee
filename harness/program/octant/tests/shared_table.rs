//! Two units on one table: one run drives it, the other gets its angles, and each has its own verdict.

use crate::common::table::{Bench, Felt, Instrument, Running, Stage, wait_for};
use octant_turntable::TableAxis;
use std::sync::Arc;

const HOST: &str = "units = 2\n";
const GUEST: &str = "driver = \"another run\"\nstart = \"20 s\"\n";

/// A table with two instruments.
struct Pair {
    stage: Stage,
    other: Instrument,
}

impl Pair {
    fn new() -> Self {
        let stage = Stage::new();
        let other = Instrument::new(Arc::clone(&stage.server), None);
        Self { stage, other }
    }

    fn host(&self, roll_deg: u32, more: &str) -> Bench {
        Bench::new(&self.stage, roll_deg, &format!("{HOST}{more}"))
    }

    fn guest(&self, roll_deg: u32) -> Bench {
        Bench::under(&self.other, &self.stage.port, roll_deg, GUEST)
    }
}

#[test]
fn two_units_on_one_table_have_its_angles_and_each_its_verdict() {
    let pair = Pair::new();
    let (host, guest) = (pair.host(20, ""), pair.guest(20));
    // In either order: the guest waits for the driving run.
    let second = guest.run(&[]);
    std::thread::sleep(std::time::Duration::from_millis(500));
    let first = host.run(&[]);
    for (bench, running) in [(&host, first), (&guest, second)] {
        let (status, said) = running.wait();
        assert!(matches!(status, Some(0 | 1 | 3)), "{status:?}: {said}");
        let felt = Felt::of(bench);
        assert_eq!(felt.samples, 3200);
        assert!(felt.worst_deg < 2.0 && felt.without < 800, "{} {}", felt.worst_deg, felt.without);
    }
    assert!((pair.stage.angle(TableAxis::Roll) - 20.0).abs() < 1e-4 && pair.stage.rests());
    let table = |bench: &Bench| bench.json("manifest.json")["bench"]["table"].clone();
    let (first, second) = (table(&host), table(&guest));
    assert_eq!(first["shared"]["driven_by_another"], false, "{first}");
    assert_eq!(first["shared"]["others"], serde_json::json!(["had all its samples"]));
    assert_eq!((&first["shared"]["units"], &second["shared"]["units"]), (&2.into(), &2.into()));
    assert_eq!(second["shared"]["driven_by_another"], true, "{second}");
    assert_eq!(second["commands"], 0);
    let report = std::fs::read_to_string(host.out().join("report.html")).unwrap();
    assert!(report.contains("2 units: unit 2 had all its samples"));
    assert!(second["looks"].as_u64().unwrap() > 200);
}

/// Runs both, ends them in the middle of a move, and returns how they ended: status and reasons, of host and guest.
fn ended(end: impl FnOnce(&Pair, &Running, &Running)) -> [(Option<i32>, String); 2] {
    let pair = Pair::new();
    let benches = [pair.host(200, ""), pair.guest(200)];
    let running = benches.each_ref().map(|bench| bench.run(&[]));
    pair.stage.wait_for_the_way();
    end(&pair, &running[0], &running[1]);
    let mut ends = running.map(Running::wait);
    for (bench, (status, said)) in benches.iter().zip(&mut ends) {
        if *status == Some(4) {
            *said = bench.json("summary.json")["reasons"].to_string();
        }
    }
    wait_for("rest", || pair.stage.rests());
    ends
}

#[test]
fn what_stops_the_table_ends_both_runs_with_the_reason() {
    let [(host, _), (guest, why)] = ended(|pair, _, _| pair.stage.instrument.fall_silent());
    assert_eq!((host, guest), (Some(4), Some(4)), "{why}");
    assert!(
        why.contains("the run that drives it stopped it") && why.contains("no reading"),
        "{why}"
    );
}

#[test]
fn a_driving_run_that_is_killed_ends_the_other_one() {
    let [(host, _), (guest, why)] = ended(|_, host, _| host.signal("-KILL"));
    assert_eq!((host, guest), (None, Some(4)), "{why}");
    assert!(why.contains("the run that drives it is gone"), "{why}");
}

#[test]
fn a_driving_run_that_is_interrupted_or_hangs_ends_the_other_one() {
    let [(host, said), (guest, why)] = ended(|_, host, _| host.signal("-INT"));
    assert_eq!((host, guest), (Some(3), Some(4)), "{said} {why}");
    // The driving run's own table may be the one that tells it.
    assert!(why.contains("the run that drives it stopped it: "), "{why}");
    assert!(why.contains("the run was interrupted"), "{why}");
    let [_, (guest, why)] = ended(|pair, host, _| {
        host.signal("-STOP");
        // Its guard stops the table.
        wait_for("rest", || pair.stage.rests());
        std::thread::sleep(std::time::Duration::from_secs(3));
        host.signal("-KILL");
    });
    assert_eq!(guest, Some(4), "{why}");
    assert!(why.contains("the run that drives it said nothing for 2s"), "{why}");
}

#[test]
fn a_unit_that_is_lost_leaves_the_other_its_run() {
    let pair = Pair::new();
    let (host, guest) = (pair.host(20, ""), pair.guest(20));
    let (first, second) = (host.run(&[]), guest.run(&[]));
    pair.stage.wait_for_the_way();
    pair.other.fall_silent();
    assert_eq!(second.wait().0, Some(4));
    let (status, said) = first.wait();
    assert!(matches!(status, Some(0 | 1 | 3)), "{status:?}: {said}");
    let shared = host.json("manifest.json")["bench"]["table"]["shared"].clone();
    let other = shared["others"][0].as_str().unwrap();
    assert!(other.starts_with("left: ") && other.contains("no reading"), "{shared}");
}

#[test]
fn another_procedure_than_that_of_the_table_is_no_run() {
    let pair = Pair::new();
    let (host, guest) = (pair.host(200, ""), pair.guest(100));
    let (first, second) = (host.run(&[]), guest.run(&[]));
    let (status, said) = second.wait();
    assert_eq!(status, Some(4), "{said}");
    let why = guest.json("summary.json")["reasons"].to_string();
    assert!(why.contains("this run's set point is azimuth 0.0000°, roll 100.0000°"), "{why}");
    assert!(why.contains("azimuth 0.0000°, roll 200.0000°"), "{why}");
    first.signal("-INT");
    first.wait();
    wait_for("rest", || pair.stage.rests());
}

#[test]
fn who_does_not_come_is_told() {
    let pair = Pair::new();
    let (status, said) = pair.host(20, "start = \"3 s\"\n").run(&[]).wait();
    assert_ne!(status, Some(0));
    assert!(said.contains("1 of the 2 runs of turntable.drive.units came within 3s"), "{said}");
    let alone = Bench::under(
        &pair.other,
        &pair.stage.port,
        20,
        "driver = \"another run\"\nstart = \"1 s\"\n",
    );
    let (status, said) = alone.run(&[]).wait();
    assert_ne!(status, Some(0));
    assert!(said.contains("no run on this host drives it within 1s"), "{said}");
    // A run that waits can be interrupted.
    let waits = pair.guest(20);
    let waiting = waits.run(&[]);
    wait_for("the run", || waits.out().is_dir());
    waiting.signal("-INT");
    let (status, said) = waiting.wait();
    assert_ne!(status, Some(0));
    assert!(said.contains("interrupted while it waited for another run at the table"), "{said}");
    // One that drives its table for itself takes nobody.
    let host = Bench::new(&pair.stage, 20, "");
    let first = host.run(&[]);
    wait_for("the run", || host.out().is_dir());
    let (status, said) = pair.guest(20).run(&[]).wait();
    assert_ne!(status, Some(0));
    assert!(said.contains("it is for its run alone"), "{said}");
    first.signal("-INT");
    first.wait();
    let refused = Bench::under(&pair.other, &pair.stage.port, 20, &format!("{GUEST}home = true\n"));
    let (status, said) = refused.run(&[]).wait();
    assert_eq!(status, Some(2));
    assert!(said.contains("turntable.drive.home") && said.contains("another run"), "{said}");
}
