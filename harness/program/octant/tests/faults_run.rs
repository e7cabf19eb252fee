//! Faults in a run: receipts agree with the recording, nothing else is altered, epochs that never
//! reached the core are distinguished from those that did, and a replay gives the same bits.

use crate::common::program::{octant_in, program};
use octant_base::control::Control;
use octant_endpoint::{Endpoint, InProcess};
use octant_faults::catalogue::{Acts, Example, Family, FaultKind, Lasts};
use octant_faults::rule::{Context, DeliveryRule, FaultRule, UnitEvent, UnitRule};
use octant_faults::station::FaultSpec;
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{Receipt, Station, Values};
use octant_recorder::reader::{Epochs, RecordedEpoch, Recording as Reader, stream_hash};
use octant_recorder::{Event, Policy, Recorder, RecorderOptions, RecorderSummary, Samples};
use octant_run::bench::closed::Closed;
use octant_run::observers::done::PlannedWork;
use octant_run::{
    Bench, Ended, Faulted, MethodRun, Observers, Records, RunHost, StreamKeeping, assemble,
    run_method,
};
use octant_sample::canonical::{AIDING_BYTES, SAMPLE_BYTES, aiding, sample};
use octant_sample::{GimbalCommand, Mode, Output, Parameters};
use octant_scenario::{Method, Scenario};
use octant_score::summary::results;
use octant_source::configure::configurations;
use octant_source::{Epoch, PlantSource, Replay, Source};
use octant_verdict::Verdict;
use std::path::Path;

const LOCKSTEP: &str = include_str!("../../../../fixtures/scenarios/lockstep.toml");

/// Parses the ten-minute lock-step scenario, with more at its end.
fn scenario(more: &str) -> Scenario {
    let text = format!("{LOCKSTEP}\n{more}");
    Scenario::parse(&text, "f.toml", Path::new(""), &[]).unwrap()
}

/// Renders a spike with little effect on the calibration: 3 min, half a second.
fn spike(trigger: &str) -> String {
    format!(
        "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
         amplitude = \"1000 deg/h\"\ntrigger = {{ {trigger} }}\nduration = \"100 samples\"\n"
    )
}

struct Run {
    method: MethodRun,
    epochs: Vec<RecordedEpoch>,
    file: tempfile::TempDir,
}

fn epochs_of(path: &Path) -> Vec<RecordedEpoch> {
    let mut reader = Epochs::new(Reader::open(path).unwrap());
    std::iter::from_fn(|| reader.next_epoch().unwrap()).collect()
}

fn run(scenario: &Scenario) -> Run {
    let file = tempfile::tempdir().unwrap();
    let path = file.path().join("recording.mcap");
    let control = Control::default();
    let recording = StreamKeeping::File(&path);
    let method = run_method(scenario, Method::Primary, 1, recording, &control).unwrap();
    Run { method, epochs: epochs_of(&path), file }
}

/// Returns the source's epoch of a step.
fn clean(epoch: &RecordedEpoch) -> Epoch {
    Epoch {
        sample: epoch.clean_sample.or(epoch.sample).unwrap(),
        aiding: epoch.clean_aiding.unwrap_or(epoch.aiding),
    }
}

fn bytes(epoch: &Epoch) -> Vec<u8> {
    let mut out = [0; SAMPLE_BYTES];
    sample(&epoch.sample, &mut out);
    let mut out = out.to_vec();
    if let Some(message) = &epoch.aiding {
        let mut more = [0; AIDING_BYTES];
        aiding(message, &mut more);
        out.extend(more);
    }
    out
}

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

#[test]
fn the_receipt_adds_up_with_the_recording_and_nothing_else_is_altered() {
    let without = run(&scenario(""));
    let with = run(&scenario(&spike("at = \"3 min\"")));
    assert_eq!(without.epochs.len(), with.epochs.len());
    assert_eq!(without.epochs.len(), 120_000);

    let altered: Vec<(u64, &RecordedEpoch)> = (1..)
        .zip(&with.epochs)
        .filter(|(_, e)| e.clean_sample.is_some() || e.clean_aiding.is_some())
        .collect();
    let numbers: Vec<u64> = altered.iter().map(|(k, _)| *k).collect();
    assert_eq!(numbers, (36_001..=36_100).collect::<Vec<_>>());
    let reached = |e: &RecordedEpoch| Epoch { sample: e.sample.unwrap(), aiding: e.aiding };
    let all = |of: &dyn Fn(&RecordedEpoch) -> Epoch| {
        altered.iter().flat_map(|(_, e)| bytes(&of(e))).collect::<Vec<_>>()
    };
    let receipt = &with.method.receipts[0];
    assert_eq!(receipt.samples_altered, 100);
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(36_001), Some(36_100)));
    assert_eq!(receipt.clean_crc32, crc32(&all(&clean)));
    assert_eq!(receipt.faulted_crc32, crc32(&all(&reached)));
    assert_eq!(with.method.recorder.altered, 100);

    // Streams from the first difference to the end of the run.
    let streams = with.method.recorder.altered_streams.as_ref().unwrap();
    let (mut clean_hash, mut faulted_hash) = (blake3::Hasher::new(), blake3::Hasher::new());
    for epoch in &with.epochs[36_000..] {
        clean_hash.update(&bytes(&clean(epoch)));
        faulted_hash.update(&bytes(&reached(epoch)));
    }
    assert_eq!(streams.first_sample, 36_001);
    assert_eq!(streams.clean_blake3, clean_hash.finalize().to_hex().to_string());
    assert_eq!(streams.faulted_blake3, faulted_hash.finalize().to_hex().to_string());

    // A controlled experiment: the same bits up to the fault, and the same source to the end.
    for (k, (a, b)) in (1u64..).zip(without.epochs.iter().zip(&with.epochs)) {
        assert_eq!(bytes(&clean(a)), bytes(&clean(b)), "what the source delivered in {k}");
        if k <= 36_000 {
            assert_eq!((a.sample, a.output.map(bits)), (b.sample, b.output.map(bits)), "{k}");
        }
    }
    assert_ne!(
        without.epochs[119_999].output.map(bits),
        with.epochs[119_999].output.map(bits),
        "the core felt it"
    );
    // 1000 deg/h for half a second, in counts of 2^-36 rad.
    let added: i64 = altered
        .iter()
        .map(|(_, e)| {
            i64::from(e.sample.unwrap().delta_theta[0])
                - i64::from(e.clean_sample.unwrap().delta_theta[0])
        })
        .sum();
    let expected = 1000.0 * std::f64::consts::PI / 180.0 / 3600.0 * 0.5 * 2f64.powi(36);
    assert!((added as f64 - expected).abs() <= 0.5, "{added} {expected}");

    let told: Vec<_> = (with.epochs.iter().flat_map(|e| &e.events))
        .filter_map(|event| match event {
            Event::Fault { begins, sample, .. } => Some((*begins, *sample)),
            _ => None,
        })
        .collect();
    assert_eq!(told, [(true, 36_001), (false, 36_101)]);

    let hash = &with.method.recorder.stream_hash;
    let path = with.file.path().join("recording.mcap");
    assert_eq!(stream_hash(Reader::open(&path).unwrap()).unwrap().as_ref(), Some(hash));
    let mut last = Epochs::new(Reader::open(&path).unwrap());
    while last.next_epoch().unwrap().is_some() {}
    let recorded = Event::Receipts(results(std::slice::from_ref(receipt)));
    assert_eq!(last.last_event(), Some(&recorded));
}

/// Encodes an output, for a comparison of all bits.
fn bits(output: octant_sample::Output) -> Vec<u8> {
    let mut out = [0; octant_sample::canonical::OUTPUT_BYTES];
    octant_sample::canonical::output(&output, &mut out);
    out.to_vec()
}

#[test]
fn a_position_is_waited_for() {
    let with = run(&scenario(&spike("position = 4, after = \"2 s\"")));
    let arrived = with
        .epochs
        .iter()
        .position(|e| e.output.is_some_and(|o| o.stop == 3 && !o.moving))
        .unwrap() as u64;
    // The answer to epoch `arrived + 1` reports it; the next epoch is the first that can react.
    assert_eq!(with.method.receipts[0].first_sample, Some(arrived + 2 + 400));
    assert!(arrived > 0);
}

#[test]
fn a_fault_that_never_fires_leaves_the_run_inconclusive() {
    let scenario = scenario(&spike("when = \"nis above 1e6\""));
    let with = run(&scenario);
    assert!(with.epochs.iter().all(|e| e.clean_sample.is_none()));
    assert_eq!(with.method.recorder.altered_streams, None);
    let run = assemble(&scenario, 1, with.method, None).unwrap();
    assert_eq!(run.summary.verdict, Verdict::Inconclusive);
    let reason = "fault spike-1 never fired: its trigger never came true";
    assert!(run.summary.reasons.iter().any(|r| r == reason), "{:?}", run.summary.reasons);
    assert!(octant_score::junit::junit(&run.summary, None).unwrap().contains("fault spike-1"));
    let page = octant_report::run::render(&run.report);
    assert!(page.contains("spike-1") && page.contains(">Faults<"));
}

#[test]
fn faults_fire_by_hand_and_act_on_both_methods() {
    let text = format!(
        "{LOCKSTEP}\n[baseline]\ng_states = false\n\n{}",
        spike("manual = true, fire = [\"100 s\"]")
    );
    let scenario = Scenario::parse(&text, "f.toml", Path::new(""), &[]).unwrap();
    let control = Control::default();
    let [primary, baseline] = [Method::Primary, Method::Baseline]
        .map(|method| run_method(&scenario, method, 1, StreamKeeping::Hash, &control).unwrap());
    assert_eq!(primary.receipts, baseline.receipts);
    assert_eq!(primary.receipts[0].first_sample, Some(20_001));
    let run = assemble(&scenario, 1, primary, Some(baseline)).unwrap();
    let summary = &run.summary;
    assert_eq!(summary.baseline.as_ref().unwrap().faults, summary.faults);
    assert!(
        octant_run::assemble::text(summary, &run.report.units)
            .contains("fault spike-1 (spike): fired once, 100 samples from 20001 to 20100")
    );
}

// How the loop handles kinds that lose, delay and repeat samples, or restart the unit, doesn't
// depend on the kinds in the catalogue: these are the simplest of each sort.

/// Delivers these epochs (source numbers) in place of the source's.
#[derive(Clone, Debug)]
struct Deliver {
    kept: Option<Epoch>,
}

octant_state::state! { Deliver { values: kept; parts: ; kept: } }

impl DeliveryRule for Deliver {
    /// By the epoch's number since the onset: 0 is lost; 1 is kept; 2 is delivered, then the kept
    /// one; 3 comes twice.
    fn on_step(&mut self, incoming: &[Epoch], _: bool, now: &Context<'_>, out: &mut Vec<Epoch>) {
        for epoch in incoming {
            match now.since_onset {
                0 => {}
                1 => self.kept = Some(*epoch),
                2 => out.extend([*epoch].into_iter().chain(self.kept.take())),
                3 => out.extend([*epoch, *epoch]),
                _ => out.push(*epoch),
            }
        }
    }

    fn holds(&self) -> usize {
        usize::from(self.kept.is_some())
    }

    fn most_out(&self, incoming: usize) -> usize {
        2 * incoming + 1
    }
}

/// Applies this event at its onset, or a loss of power.
#[derive(Clone, Debug)]
struct Unit {
    event: Option<UnitEvent>,
}

octant_state::state! { Unit { values: ; parts: ; kept: event } }

impl UnitRule for Unit {
    fn on_epoch(&mut self, now: &Context<'_>) -> Option<UnitEvent> {
        self.event.filter(|_| now.since_onset == 0)
    }

    fn cuts_power(&self) -> bool {
        self.event.is_none()
    }
}

macro_rules! test_kind {
    ($name:ident, $acts:expr, $rule:expr) => {
        static $name: FaultKind = FaultKind {
            name: "test",
            family: Family::Unit,
            acts: $acts,
            summary: "",
            model: "",
            parameters: &[],
            lasts: Lasts::Span,
            example: Example::NONE,
            build: |_, _| Ok($rule),
        };
    };
}
test_kind!(DELIVERY, Acts::Delivery, FaultRule::Delivery(Box::new(Deliver { kept: None })));
test_kind!(
    RESTART,
    Acts::Unit,
    FaultRule::Unit(Box::new(Unit { event: Some(UnitEvent::Restart) }))
);
test_kind!(POWER, Acts::Unit, FaultRule::Unit(Box::new(Unit { event: None })));
test_kind!(STORED, Acts::Unit, {
    let mut offset = Parameters::default();
    offset.gyro_bias[0] = 1e-6;
    FaultRule::Unit(Box::new(Unit { event: Some(UnitEvent::RestartWith { offset }) }))
});

struct Driven {
    ended: Ended,
    epochs: Vec<RecordedEpoch>,
    summary: RecorderSummary,
    observed: Observers,
    receipts: Vec<Receipt>,
    path: std::path::PathBuf,
    _folder: tempfile::TempDir,
}

/// Drives the lock-step scenario with a fault of a test kind, as a run does.
fn drive_with(kind: &'static FaultKind, first: u64, epochs: u64, policy: Policy) -> Driven {
    let scenario = scenario("");
    let (plant, core, draws) = configurations(&scenario, Method::Primary, 1).unwrap();
    let spec = FaultSpec {
        id: "t".to_owned(),
        kind,
        values: Values::default(),
        schedule: Schedule {
            trigger: Trigger::Epoch(first),
            duration: Some(epochs),
            recovery: 0,
            repeat: Repeat::Once,
        },
    };
    let station = Station::new(&[spec], &scenario.fault_setup(1)).unwrap();
    let faulted = Faulted { station, fires: Vec::new(), host: RunHost::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.mcap");
    let options = RecorderOptions {
        policy,
        scenario: scenario.to_resolved_toml(1, &draws),
        ..RecorderOptions::default()
    };
    let recorder = Recorder::to_file(&path, &options).unwrap();
    let source = PlantSource::new(&plant, scenario.samples().unwrap()).unwrap();
    let endpoint = InProcess::new(&core).unwrap();
    let observers = Observers::new(PlannedWork::lasting(&scenario));
    let control = Control::default();
    let records = Records::new(recorder, observers, &control);
    let mut bench = Bench::of_parts(source, endpoint, Some(faulted), records);
    bench.run();
    let Closed { ended, recorder, observers: observed, receipts, .. } = bench.close().unwrap();
    let summary = recorder.finish().unwrap();
    let epochs = epochs_of(&path);
    Driven { ended, epochs, summary, observed, receipts, path, _folder: folder }
}

fn full() -> Policy {
    Policy { samples: Samples::Full, ..Policy::default() }
}

/// Replays the recording with the program: its exit status must be that of equal outputs.
#[track_caller]
fn assert_replays(driven: &Driven) {
    let output = program(&["replay", "--json"]).arg(&driven.path).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(found["stream_hash"], driven.summary.stream_hash.as_str());
    assert_eq!(found["outputs_equal"], true);
}

#[test]
fn lost_late_and_repeated_samples_stand_in_the_recording() {
    let driven = drive_with(&DELIVERY, 1001, 4, full());
    let at = |step: u64| -> Vec<&RecordedEpoch> {
        driven.epochs.iter().filter(|e| e.time_ns == step * 5_000_000).collect()
    };
    let sequences = |step: u64| -> Vec<Option<u64>> {
        at(step).iter().map(|e| e.sample.map(|sample| sample.sequence)).collect()
    };
    assert_eq!(sequences(1000), [Some(1000)]);
    assert_eq!(sequences(1001), [None], "lost");
    assert_eq!(sequences(1002), [None], "late");
    assert_eq!(sequences(1003), [Some(1003), Some(1002)], "the late one comes after");
    assert_eq!(sequences(1004), [Some(1004), Some(1004)], "twice");
    assert_eq!(sequences(1005), [Some(1005)]);
    for step in [1001, 1002] {
        let [lost] = at(step)[..] else { panic!() };
        assert_eq!(lost.clean_sample.unwrap().sequence, step);
        assert_eq!(lost.output, None);
    }
    for step in [1003, 1004] {
        assert!(at(step).iter().all(|e| e.clean_sample.is_none()), "the first is the clean one");
    }
    // Every step of the source has one clean sample in the recording.
    let mut step_ns = 0;
    let mut clean_numbers = Vec::new();
    for epoch in &driven.epochs {
        if epoch.time_ns != step_ns {
            clean_numbers.push(clean(epoch).sample.sequence);
            step_ns = epoch.time_ns;
        }
    }
    assert_eq!(clean_numbers, (1..=120_000).collect::<Vec<_>>());
    let summary = &driven.summary;
    assert_eq!((summary.epochs, summary.altered), (120_000, 4));
    assert_eq!(summary.altered_streams.as_ref().unwrap().first_sample, 1001);
    assert_eq!(driven.receipts[0].samples_altered, 4);
    assert_eq!(driven.ended, Ended::Done);
    let file = Reader::open(&driven.path).unwrap();
    assert_eq!(stream_hash(file).unwrap().as_ref(), Some(&summary.stream_hash));
    assert_replays(&driven);
    // The replay delivers the epochs that reached the core, in that order.
    let mut replay = Replay::open(&driven.path, None).unwrap();
    let mut numbers = Vec::new();
    let mut epoch = Epoch::default();
    while replay.next(&GimbalCommand::default(), &mut epoch).unwrap() {
        numbers.push(epoch.sample.sequence);
    }
    assert_eq!(numbers[998..1006], [999, 1000, 1003, 1002, 1004, 1004, 1005, 1006]);
}

#[test]
fn a_decimated_recording_holds_lost_samples_on_its_grid_alone() {
    let driven = drive_with(&POWER, 30_001, 2000, Policy::default());
    let is_lost = |e: &&RecordedEpoch| e.sample.is_none() && e.clean_sample.is_some();
    let lost: Vec<&RecordedEpoch> = driven.epochs.iter().filter(is_lost).collect();
    let seconds: Vec<u64> = lost.iter().map(|e| e.time_ns / 1_000_000_000).collect();
    assert_eq!(seconds, (151..=160).collect::<Vec<_>>());
    assert!(lost.iter().all(|e| e.truth.is_some() && e.output.is_none()));
}

#[test]
fn a_restarted_core_begins_anew_and_the_rest_copes() {
    let driven = drive_with(&RESTART, 100_001, 1, full());
    let modes: Vec<Mode> = driven.epochs.iter().map(|e| e.output.unwrap().mode).collect();
    // Eight minutes are 96 000 samples: the core navigates when it is restarted, and calibrates
    // again.
    assert_eq!((modes[99_999], modes[100_000]), (Mode::Navigating, Mode::Calibrating));
    let revision = |k: usize| driven.epochs[k].output.unwrap().parameters_revision;
    assert!(revision(100_000) < revision(99_999));
    assert_eq!(driven.observed.last_mode(), Mode::Calibrating);
    assert_eq!(driven.ended, Ended::SourceEnded);
    let unit: Vec<_> =
        driven.epochs[100_000].events.iter().filter(|e| matches!(e, Event::Unit { .. })).collect();
    assert_eq!(unit.len(), 1, "it stands before the sample that the new core got first");
    assert_replays(&driven);
}

#[test]
fn without_power_nothing_reaches_the_core_and_the_turntable_keeps_its_set_point() {
    let driven = drive_with(&POWER, 30_001, 2000, full());
    let lost = driven.epochs.iter().filter(|e| e.sample.is_none()).count();
    assert_eq!(lost, 2000);
    let answers = |k: usize| driven.epochs[k].output.is_some();
    assert!(answers(29_999) && !answers(30_000) && !answers(31_999) && answers(32_000));
    assert_eq!(driven.summary.epochs, 118_000);
    // Encoders (18 arcsec of noise) are at the set point of the last answer, once the gimbals are
    // at rest.
    let target = driven.epochs[29_999].output.unwrap().gimbal_command.target;
    let off = |k: usize| clean(&driven.epochs[k]).sample.gimbal;
    for k in [31_000, 31_999] {
        assert!((off(k).azimuth_rad() - target.azimuth_rad()).abs() < 1e-3);
        assert!((off(k).roll_rad() - target.roll_rad()).abs() < 1e-3);
    }
    assert_replays(&driven);
}

#[test]
fn a_wrong_stored_calibration_is_started_from_and_replayed() {
    let driven = drive_with(&STORED, 50_001, 1, full());
    assert_replays(&driven);
    let plain = drive_with(&RESTART, 50_001, 1, full());
    let attitude = |d: &Driven, k: usize| d.epochs[k].output.unwrap().navigation.q_nb;
    assert_eq!(attitude(&driven, 49_999), attitude(&plain, 49_999));
    // 1e-6 rad/s for one second turns the attitude by a microradian, half of it in q.
    let (a, b) = (attitude(&driven, 50_100), attitude(&plain, 50_100));
    let apart = (0..4).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    assert!((apart / 0.25e-6 - 1.0).abs() < 0.1, "{apart}");
}

#[test]
fn an_endpoint_starts_anew_from_its_configuration() {
    let scenario = scenario("");
    let (plant, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let mut source = PlantSource::new(&plant, 1000).unwrap();
    let mut fresh = InProcess::new(&core).unwrap();
    let mut used = InProcess::new(&core).unwrap();
    let (mut epoch, [mut one, mut other]) = (Epoch::default(), [Output::default(); 2]);
    for _ in 0..500 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        used.step(&epoch, &mut one).unwrap();
    }
    used.restart(None).unwrap();
    for _ in 500..1000 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        used.step(&epoch, &mut one).unwrap();
        fresh.step(&epoch, &mut other).unwrap();
        assert_eq!(bits(one), bits(other));
    }
}

/// Kinds of the catalogue for every place where faults act, in one run.
const EVERYWHERE: &str = r#"
[[faults]]
id = "slip"
kind = "gimbal-slip"
gimbal = "roll"
angle = "0.05 deg"
trigger = { position = 3, after = "5 s" }

[[faults]]
id = "lost-command"
kind = "command-lost"
trigger = { moving_to = 4 }
duration = "2 s"

[[faults]]
id = "late"
kind = "late-delivery"
delay = "0.1 s"
trigger = { at = "150 s" }
duration = "1 s"

[[faults]]
id = "drop"
kind = "dropout"
trigger = { after_fault = "late", after = "10 s" }
duration = "100 samples"

[[faults]]
id = "noise"
kind = "noise-gain"
channels = "gyro"
gain = "300 %"
trigger = { at = "200 s" }
duration = "10 s"
recovery = "5 s"

[[faults]]
id = "restart"
kind = "restart"
trigger = { at = "250 s" }
"#;

#[test]
fn faults_of_every_place_leave_a_recording_that_replays_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all.toml"), format!("{LOCKSTEP}\n{EVERYWHERE}")).unwrap();
    let octant = |arguments: &[&str]| octant_in(folder.path(), arguments);
    let run = octant(&["run", "all.toml", "--out", "all"]);
    assert!(matches!(run.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(folder.path().join("all/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    for fault in summary["faults"].as_array().unwrap() {
        assert_eq!(fault["fired"], true, "{fault}");
    }
    let replay = octant(&["replay", "all/recording.mcap", "--json"]);
    let replay: serde_json::Value = serde_json::from_slice(&replay.stdout).unwrap();
    assert_eq!(replay["outputs_equal"], true, "{replay}");
    assert_eq!(replay["stream_hash"], summary["stream_hash"]);
}

#[test]
fn the_program_says_what_a_fault_did() {
    let folder = tempfile::tempdir().unwrap();
    let octant = |arguments: &[&str]| octant_in(folder.path(), arguments);
    let file = |name: &str, trigger: &str| {
        let text = format!("{LOCKSTEP}\n{}", spike(trigger));
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    file("silent.toml", "manual = true");
    let silent = octant(&["run", "silent.toml", "--out", "silent"]);
    assert_eq!(silent.status.code(), Some(3), "a fault that didn't fire is inconclusive");
    let stderr = String::from_utf8_lossy(&silent.stderr);
    assert!(stderr.contains("no --fire spike-1=TIME does"), "{stderr}");
    assert!(String::from_utf8_lossy(&silent.stdout).contains("fault spike-1 never fired"));
    let fired = octant(&["run", "silent.toml", "--out", "fired", "--fire", "spike-1=3 min"]);
    assert_eq!(fired.status.code(), Some(0), "{}", String::from_utf8_lossy(&fired.stderr));
    let manifest = std::fs::read_to_string(folder.path().join("fired/manifest.json")).unwrap();
    assert!(manifest.contains("--fire 'spike-1=3 min'"), "{manifest}");
    let replayed = octant(&["replay", "fired/recording.mcap"]);
    assert_eq!(replayed.status.code(), Some(0));
    // The resolved scenario makes the same run.
    let again = octant(&["run", "fired/scenario.toml", "--out", "again"]);
    assert_eq!(again.status.code(), Some(0));
    let read = |name: &str| std::fs::read(folder.path().join(name).join("summary.json")).unwrap();
    assert_eq!(read("fired"), read("again"));
    file("late.toml", "at = \"1 h\"");
    let late = octant(&["run", "late.toml", "--out", "late"]);
    assert_eq!(late.status.code(), Some(2));
    let stderr = String::from_utf8_lossy(&late.stderr);
    assert!(stderr.contains("late.toml:") && stderr.contains("the run ends at 600 s"), "{stderr}");
    let list = octant(&["faults", "list"]);
    assert!(String::from_utf8_lossy(&list.stdout).contains("spike"));
    let page = octant(&["faults", "describe", "spike"]);
    let page = String::from_utf8_lossy(&page.stdout);
    assert!(page.contains("[[faults]]") && page.contains("Parameters"), "{page}");
    let unknown = octant(&["faults", "describe", "spik"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("did you mean \"spike\"?"));
}

/// Twelve seconds of calibration with one move, and three of navigation.
const SHORT: &str = "schema = 1\n\
    [procedure.calibration]\nduration = \"12 s\"\n\
    stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]\n\
    [procedure.navigation]\nduration = \"3 s\"\n[record]\nsamples = \"full\"\n";

/// A fault that waits for a jerk of the mooring sets in after it, and not in its middle.
#[test]
fn what_follows_a_jerk_sets_in_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let faults = "[[faults]]\nid = \"jerk\"\nkind = \"mooring-jerk\"\n\
        displacement = [\"0.3 m\", \"0 m\", \"0 m\"]\nlength = \"5 s\"\ntrigger = { at = \"2 s\" }\n\
        [[faults]]\nid = \"spike\"\nkind = \"spike\"\nchannels = \"gyro x\"\namplitude = \"1000 deg/h\"\n\
        duration = \"3 samples\"\ntrigger = { after_fault = \"jerk\", after = \"1 s\" }\n";
    let text = format!("{SHORT}{faults}");
    std::fs::write(folder.path().join("jerk.toml"), text).unwrap();
    let output = octant_in(folder.path(), &["run", "jerk.toml", "--out", "run"]);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(
        told.contains("fault jerk (mooring-jerk): fired once, 1000 samples from 401 to 1400"),
        "{told}"
    );
    assert!(
        told.contains("fault spike (spike): fired once, 3 samples from 1601 to 1603"),
        "{told}"
    );
    let summary = std::fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["altered_streams"]["first_sample"], 401);
    let x = &summary["faults"][0]["largest_change"]["delta_velocity"][0];
    // At most 24/L² of the displacement, over a sample of 5 ms, in counts of 2⁻³⁰ m/s.
    let largest = 24.0 * 0.3 / 25.0 * 0.005 * 2f64.powi(30);
    assert!((x.as_f64().unwrap() / largest - 1.0).abs() < 1e-4, "{x} {largest}");
}
