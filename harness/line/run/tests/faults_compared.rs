//! The receipt of a fault is what a comparison of two recordings shows: of the run with the fault and of the one
//! without it. The comparison is made here, from the messages of the files alone.

use super::faults_any::{draw, scenario};
use octant_base::control::Control;
use octant_faults::catalogue::{Acts, FaultKind};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Values, kinds};
use octant_recorder::reader::{Epochs, Recording as Reader};
use octant_run::{MethodRun, StreamKeeping, run_method};
use octant_sample::canonical::{AIDING_BYTES, SAMPLE_BYTES, aiding, sample};
use octant_sample::{Epoch, GimbalCommand};
use octant_scenario::{Method, Scenario};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::path::Path;
use std::sync::LazyLock;

const PERIOD_NS: u64 = 5_000_000;

/// Epochs of one step of the source.
#[derive(Clone, Default)]
struct Step {
    /// Those that reached the core.
    reached: Vec<Epoch>,
    /// That of the source without faults, as the file has it.
    clean: Option<Epoch>,
    /// Set point in the last answer.
    command: Option<GimbalCommand>,
}

struct Recorded {
    steps: Vec<Step>,
    run: MethodRun,
}

fn recorded(specs: &[FaultSpec], seed: u64) -> Recorded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.mcap");
    let keeping = StreamKeeping::File(&path);
    let scenario = scenario(specs);
    let run = run_method(&scenario, Method::Primary, seed, keeping, &Control::default()).unwrap();
    let mut steps: Vec<Step> = Vec::new();
    let mut reader = Epochs::new(Reader::open(&path).unwrap());
    while let Some(epoch) = reader.next_epoch().unwrap() {
        let number = (epoch.time_ns / PERIOD_NS) as usize;
        if epoch.sample.is_none() && epoch.clean_sample.is_none() {
            continue;
        }
        steps.resize(number.max(steps.len()), Step::default());
        let step = &mut steps[number - 1];
        if let Some(sample) = epoch.sample {
            step.reached.push(Epoch { sample, aiding: epoch.aiding });
        }
        if step.clean.is_none() {
            step.clean = Some(Epoch {
                sample: epoch.clean_sample.or(epoch.sample).unwrap(),
                aiding: epoch.clean_aiding.unwrap_or(epoch.aiding),
            });
        }
        step.command = epoch.output.map(|output| output.gimbal_command);
    }
    Recorded { steps, run }
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
fn crc32(bytes: impl Iterator<Item = u8>) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    !crc
}

fn counts(epoch: &Epoch) -> [i64; 6] {
    let ([a, b, c], [d, e, f]) = (epoch.sample.delta_theta, epoch.sample.delta_velocity);
    [a, b, c, d, e, f].map(i64::from)
}

/// Numbers of the steps in which the core got something else than the source of the twin delivered.
fn different(with: &[Step], twin: &[Epoch]) -> Vec<usize> {
    let same = |k: &usize| matches!(with[*k].reached[..], [one] if bytes(&one) == bytes(&twin[*k]));
    (0..with.len()).filter(|k| !same(k)).collect()
}

/// Those of a fault inside the plant: anything but a count is different, or the difference of the sums of counts of a
/// channel leaves a range of one count, in which it has been since the last such step.
fn disturbed(with: &[Step], twin: &[Epoch]) -> Vec<usize> {
    let (mut sums, mut altered) = ([0i64; 6], Vec::new());
    let mut since = vec![sums];
    for (k, step) in with.iter().enumerate() {
        let [found] = step.reached[..] else { panic!("step {k}") };
        let (a, b) = (counts(&found), counts(&twin[k]));
        (0..6).for_each(|channel| sums[channel] += a[channel] - b[channel]);
        since.push(sums);
        let leaves = (0..6).any(|channel| {
            let of = since.iter().map(|sums| sums[channel]);
            of.clone().max().unwrap() - of.min().unwrap() > 1
        });
        let mut rest = found;
        rest.sample.delta_theta = twin[k].sample.delta_theta;
        rest.sample.delta_velocity = twin[k].sample.delta_velocity;
        if leaves || bytes(&rest) != bytes(&twin[k]) {
            altered.push(k);
            since = vec![sums];
        } else if since.len() > 64 {
            // The range is all that counts.
            let ends = [i64::min, i64::max].map(|of: fn(i64, i64) -> i64| {
                since
                    .iter()
                    .copied()
                    .reduce(|a, b| std::array::from_fn(|i| of(a[i], b[i])))
                    .unwrap()
            });
            since = ends.to_vec();
        }
    }
    altered
}

/// Compares the receipt with the files. Returns whether the fault altered something, or `None` where the core, which felt
/// the fault, gave other set points, so that the source itself went another way.
fn adds_up(spec: &FaultSpec, seed: u64) -> Option<bool> {
    scenario(std::slice::from_ref(spec)).station(seed).ok()?;
    let with = recorded(std::slice::from_ref(spec), seed);
    let without = recorded(&[], seed);
    // Where a core gets nothing, its last set point stays. That of the last answer, a refusal, is never felt.
    let mut command = GimbalCommand::default();
    let felt = with.steps.len() - 1;
    for (step, of_twin) in with.steps[..felt].iter().zip(&without.steps) {
        command = step.command.unwrap_or(command);
        if Some(command) != of_twin.command {
            return None;
        }
    }
    let what = format!("{spec:?}");
    assert!(without.run.recorder.altered_streams.is_none(), "{what}");
    let twin: Vec<Epoch> = without.steps.iter().map(|step| step.reached[0]).collect();
    let (steps, receipt) = (&with.steps, &with.run.receipts[0]);
    // Of the last step a run that is over in its middle has a part alone.
    if spec.kind.acts == Acts::Delivery && receipt.last_sample == Some(steps.len() as u64) {
        return None;
    }
    for (k, step) in steps.iter().enumerate() {
        assert!(step.clean.unwrap().same_bits(&twin[k]), "the clean sample {k}: {what}");
    }
    let different = different(steps, &twin);
    let altered = match spec.kind.acts {
        Acts::Plant => disturbed(steps, &twin),
        _ => different.clone(),
    };
    let number = |k: Option<&usize>| k.map(|k| *k as u64 + 1);
    assert_eq!(receipt.samples_altered, altered.len() as u64, "{what}");
    assert_eq!(receipt.first_sample, number(altered.first()), "{what}");
    assert_eq!(receipt.last_sample, number(altered.last()), "{what}");
    let clean = altered.iter().flat_map(|k| bytes(&twin[*k]));
    let faulted = altered.iter().flat_map(|k| steps[*k].reached.iter().flat_map(bytes));
    assert_eq!(receipt.clean_crc32, crc32(clean), "{what}");
    assert_eq!(receipt.faulted_crc32, crc32(faulted), "{what}");
    if spec.kind.acts != Acts::Delivery && !altered.is_empty() {
        let found = receipt.largest_change.unwrap();
        let found = [found.delta_theta, found.delta_velocity].concat();
        for channel in 0..6 {
            let change = |k: &usize| {
                counts(&steps[*k].reached[0])[channel].abs_diff(counts(&twin[*k])[channel])
            };
            let expected = altered.iter().map(change).max();
            assert_eq!(Some(u64::from(found[channel])), expected, "{channel}: {what}");
        }
    }
    // Both streams from the first difference on, even if it is a single count.
    let streams = with.run.recorder.altered_streams.as_ref();
    assert_eq!(streams.is_some(), !different.is_empty(), "{what}");
    if let (Some(streams), Some(first), false) =
        (streams, different.first(), spec.kind.acts == Acts::Delivery)
    {
        assert_eq!(streams.first_sample, *first as u64 + 1, "{what}");
        let hash = |of: &dyn Fn(usize) -> Vec<u8>| {
            let mut hasher = blake3::Hasher::new();
            (*first..steps.len()).for_each(|k| _ = hasher.update(&of(k)));
            hasher.finalize().to_hex().to_string()
        };
        assert_eq!(streams.clean_blake3, hash(&|k| bytes(&twin[k])), "{what}");
        assert_eq!(streams.faulted_blake3, hash(&|k| bytes(&steps[k].reached[0])), "{what}");
    }
    Some(receipt.fired())
}

fn acts_on_stream(kind: &FaultKind) -> bool {
    matches!(kind.acts, Acts::Plant | Acts::Samples | Acts::Delivery)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_receipt_of_any_fault_is_what_two_recordings_show(
        mut spec in draw::spec().prop_filter("in the stream", |spec| acts_on_stream(spec.kind)),
        seed in 0..1000u64,
    ) {
        if matches!(spec.schedule.trigger, Trigger::After { .. }) {
            spec.schedule.trigger = Trigger::Epoch(1000);
        }
        adds_up(&spec, seed);
    }
}

/// Values of the scenario of a kind.
fn shipped(kind: &FaultKind) -> Values {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/faults");
    let path = format!("{folder}/{}.toml", kind.name);
    let text = std::fs::read_to_string(&path).unwrap();
    let mut scenario = Scenario::parse(&text, &path, Path::new(folder), &[]).unwrap();
    scenario.faults.swap_remove(0).spec.values
}

/// Every kind, in a dwell and through the move: the values of its scenario, then drawn ones, until one of its faults has
/// altered something.
#[test]
fn the_receipt_of_each_kind_is_what_two_recordings_show() {
    static KINDS: LazyLock<Vec<&FaultKind>> =
        LazyLock::new(|| kinds::all().filter(|kind| acts_on_stream(kind)).collect());
    let mut runner = TestRunner::deterministic();
    let mut inside = 0;
    for kind in KINDS.iter() {
        let strategy = draw::values(kind);
        let mut fired = false;
        for turn in 0..200 {
            let mut drawn = || strategy.new_tree(&mut runner).unwrap().current();
            let values = if turn < 2 { shipped(kind) } else { drawn() };
            let schedule = Schedule {
                // A core that gets its samples late moves late: delivery is disturbed behind the move.
                trigger: Trigger::Epoch(match (kind.acts, turn % 2) {
                    (Acts::Delivery, _) => 2000,
                    (_, 0) => 300,
                    _ => 600,
                }),
                duration: Some(400),
                recovery: 0,
                repeat: Repeat::Times { times: 2, every: 450 },
            };
            let spec = FaultSpec { id: "f0".into(), kind, values, schedule };
            fired = adds_up(&spec, 1) == Some(true);
            if fired {
                break;
            }
        }
        // The reference here is a velocity, and a jump of the position alters nothing.
        assert_eq!(fired, kind.name != "position-jump", "{}", kind.name);
        inside += u32::from(kind.acts == Acts::Plant);
    }
    assert_eq!(inside, 15, "kinds inside the plant");
}
