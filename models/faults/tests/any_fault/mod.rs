//! Properties of every kind of the catalogue, for any values and any trigger: no panic, no
//! difference before the first onset, and a receipt that agrees with a comparison of the clean and
//! the delivered stream. A kind is covered as soon as it is in the catalogue.

mod draw;
mod fading;
mod plain;
mod state;

use crate::common::{Log, bytes, clean, setup};
use draw::{spec, values};
use octant_faults::catalogue::{Acts, Family, Takes};
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, Occurrence};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultBuildError, FaultSpec, Receipt, Station, kinds};
use octant_sample::imu::Status;
use octant_sample::{
    Aiding, Epoch, GimbalAngles, GimbalCommand, Health, Mode, Output, Reference, Truth,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Length of a run.
pub(crate) const EPOCHS: u64 = 400;

/// The source: counts at the limits now and then, both kinds of aiding, flags.
fn source(k: u64) -> Epoch {
    let mut epoch = clean(k);
    if k.is_multiple_of(13) {
        epoch.sample.delta_theta = [i32::MIN, i32::MAX, 0];
    }
    if k.is_multiple_of(17) {
        epoch.sample.delta_velocity = [i32::MAX, 0, i32::MIN];
    }
    if k.is_multiple_of(19) {
        epoch.sample.status = Status::from_bits_truncate(k as u16);
    }
    let reference = match k % 10 {
        0 => Reference::Velocity([1e-3, -2e-3, k as f64 * 1e-6]),
        5 => Reference::Position { latitude_rad: 0.5, longitude_rad: -2.0, height_m: k as f64 },
        _ => return epoch,
    };
    epoch.aiding = Some(Aiding { device_time: epoch.sample.device_time, reference });
    epoch
}

/// The core: a position every 40 epochs, moves of 10, navigation from 250 on.
fn answer(k: u64) -> Output {
    let stop = (k / 40) as u16;
    Output {
        sequence: k,
        mode: if k < 250 { Mode::Calibrating } else { Mode::Navigating },
        stop,
        moving: k % 40 < 10,
        nis: if k % 30 < 10 { f64::NAN } else { (k % 30) as f64 },
        health: Health::from_bits_truncate(1 << (k / 20 % 12)),
        gimbal_command: GimbalCommand {
            target: GimbalAngles { azimuth: 1_000_000 * i32::from(stop), roll: -70 * k as i32 },
        },
        ..Output::default()
    }
}

/// Record of a run.
#[derive(Debug, PartialEq)]
struct RunRecord {
    /// Epochs of the source without the disturbances of the first fault and of those after it.
    without: Vec<Epoch>,
    /// Epochs delivered for each epoch of the source.
    delivered: Vec<Vec<Epoch>>,
    commands: Vec<GimbalCommand>,
    occurrences: Vec<Occurrence>,
    events: Vec<UnitEvent>,
    begun: usize,
    ended: usize,
    receipts: Vec<Receipt>,
}

/// Faults with a manual trigger are fired at epoch 20.
fn run(specs: &[FaultSpec]) -> Result<RunRecord, (String, FaultBuildError)> {
    let mut station = Station::new(specs, &setup())?;
    let mut log = Log { truth: Some(Truth::default()), ..Log::default() };
    let (mut delivered, mut commands) = (Vec::new(), Vec::new());
    let (mut occurrences, mut events) = (Vec::new(), Vec::new());
    let mut without = Vec::new();
    for k in 1..=EPOCHS {
        if k == 20 {
            specs.iter().for_each(|spec| {
                let manual = spec.schedule.trigger == Trigger::Manual;
                assert_eq!(station.fire(&spec.id), manual);
            });
        }
        let output = answer(k - 1);
        let mut command = output.gimbal_command;
        station.before(&mut command, &output, &mut log);
        commands.push(command);
        let epoch = source(k);
        log.deliver(&epoch);
        without.push(log.delivered_without(0, epoch));
        delivered.push(match station.after(&epoch, &output, &mut log).delivered {
            Delivered::Untouched => vec![epoch],
            Delivered::These(epochs) => epochs.to_vec(),
        });
        events.extend_from_slice(station.unit_events());
        occurrences.extend_from_slice(station.occurrences());
        station.told();
    }
    let (begun, ended) = (log.begun.len(), log.ended.len());
    Ok(RunRecord {
        without,
        delivered,
        commands,
        occurrences,
        events,
        begun,
        ended,
        receipts: station.receipts(),
    })
}

/// CRC-32 (IEEE 802.3), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

fn same(delivered: &[Epoch], k: u64) -> bool {
    matches!(delivered, [one] if one.same_bits(&source(k)))
}

/// Checks that a refusal names the cause: a parameter of the kind, or the fault that it waits for.
fn refusal_is_fair(specs: &[FaultSpec], (id, error): &(String, FaultBuildError)) {
    let spec = specs.iter().find(|spec| spec.id == *id).unwrap();
    match error {
        FaultBuildError::Value { parameter, problem } => {
            assert!(
                spec.kind.parameter(parameter).is_some() || *parameter == "kind",
                "{}: {parameter}",
                spec.kind.name
            );
            assert!(!problem.is_empty());
        }
        FaultBuildError::NoSuchFault { after, .. } => assert_eq!(after, "f0"),
        FaultBuildError::DuplicateId(_) => panic!("{error}"),
    }
}

/// Checks the properties of a receipt that don't depend on the streams.
fn receipt_is_sound(told: &RunRecord, index: usize) {
    let receipt = &told.receipts[index];
    let onsets = told.occurrences.iter().filter(|it| it.fault == index && it.begins);
    let onsets: Vec<u64> = onsets.map(|it| it.epoch).collect();
    assert!(receipt.armed);
    assert_eq!(receipt.firings as usize, onsets.len());
    assert_eq!(receipt.fired(), receipt.first_sample.is_some());
    assert_eq!(receipt.fired(), receipt.last_sample.is_some());
    if let (Some(first), Some(last)) = (receipt.first_sample, receipt.last_sample) {
        assert!(onsets[0] <= first && first <= last && last <= EPOCHS);
        assert!(receipt.samples_altered <= last - first + 1);
    } else {
        assert_eq!((receipt.clean_crc32, receipt.faulted_crc32), (0, 0));
    }
}

/// Epochs in which the fault was active, fading included, and inside the plant until its effect was over.
fn active(told: &RunRecord) -> Vec<u64> {
    let is = |k: u64| {
        let mut until = told.occurrences.iter().filter(|it| it.epoch <= k);
        until.next_back().is_some_and(|it| it.begins)
    };
    (1..=EPOCHS).filter(|k| is(*k)).collect()
}

fn one_fault_adds_up(spec: &FaultSpec, told: &RunRecord) {
    receipt_is_sound(told, 0);
    let receipt = &told.receipts[0];
    let first_onset = told.occurrences.first().map_or(u64::MAX, |it| it.epoch);
    let streams = matches!(spec.kind.acts, Acts::Samples | Acts::Delivery);
    let epochs = (1..=EPOCHS).zip(&told.delivered);
    let altered: Vec<u64> = epochs.filter(|(k, out)| !same(out, *k)).map(|(k, _)| k).collect();
    let commanded = |k: u64| answer(k - 1).gimbal_command;
    let commands: Vec<u64> =
        (1..=EPOCHS).filter(|k| told.commands[*k as usize - 1] != commanded(*k)).collect();
    assert!(altered.iter().chain(&commands).all(|k| *k >= first_onset));
    assert!(streams || altered.is_empty());
    assert!(spec.kind.acts == Acts::Command || commands.is_empty());
    assert!(spec.kind.acts == Acts::Unit || told.events.is_empty());
    let expected = match spec.kind.acts {
        Acts::Samples | Acts::Delivery => {
            let from: Vec<_> = altered.iter().map(|k| source(*k)).collect();
            let to = altered.iter().flat_map(|k| told.delivered[*k as usize - 1].clone());
            let to: Vec<_> = to.collect();
            assert_eq!(receipt.clean_crc32, crc32(&bytes(&from)));
            assert_eq!(receipt.faulted_crc32, crc32(&bytes(&to)));
            altered
        }
        Acts::Command => {
            let bytes = |command: GimbalCommand| {
                [command.target.azimuth.to_le_bytes(), command.target.roll.to_le_bytes()].concat()
            };
            let from: Vec<u8> = commands.iter().flat_map(|k| bytes(commanded(*k))).collect();
            let to = commands.iter().flat_map(|k| bytes(told.commands[*k as usize - 1]));
            let to: Vec<u8> = to.collect();
            assert_eq!((receipt.clean_crc32, receipt.faulted_crc32), (crc32(&from), crc32(&to)));
            commands
        }
        Acts::Plant => {
            assert_eq!(told.begun, receipt.firings as usize);
            assert!(told.ended == told.begun || told.ended + 1 == told.begun);
            let epochs: Vec<Epoch> = (1..=EPOCHS).map(source).collect();
            let differ: Vec<usize> =
                (0..epochs.len()).filter(|k| epochs[*k] != told.without[*k]).collect();
            let of =
                |all: &[Epoch]| crc32(&bytes(&differ.iter().map(|k| all[*k]).collect::<Vec<_>>()));
            assert_eq!(receipt.clean_crc32, of(&told.without));
            assert_eq!(receipt.faulted_crc32, of(&epochs));
            let numbers: Vec<u64> = differ.iter().map(|k| *k as u64 + 1).collect();
            assert_eq!(numbers, active(told), "the end is told when the effect is over");
            numbers
        }
        // Effects on the unit are reported as events, not epoch by epoch.
        _ => return,
    };
    assert_eq!(receipt.samples_altered, expected.len() as u64);
    assert_eq!(receipt.first_sample, expected.first().copied());
    assert_eq!(receipt.last_sample, expected.last().copied());
    if matches!(spec.kind.family, Family::Analogue | Family::RingLaser | Family::Digital) {
        // No effect of these stays after their end, and no sample is lost or made.
        let active = active(told);
        assert!(expected.iter().all(|k| active.binary_search(k).is_ok()));
        assert!(told.delivered.iter().all(|out| out.len() == 1));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_receipt_of_a_fault_is_what_a_comparison_finds(spec in spec()) {
        match run(std::slice::from_ref(&spec)) {
            Ok(told) => one_fault_adds_up(&spec, &told),
            Err(error) => refusal_is_fair(&[spec], &error),
        }
    }

    #[test]
    fn several_faults_at_once_stay_in_order(
        mut specs in proptest::collection::vec(spec(), 2..6)
    ) {
        for (index, spec) in specs.iter_mut().enumerate() {
            spec.id = format!("f{index}");
        }
        // A few faults are refused; the others still make a run.
        let told = loop {
            match run(&specs) {
                Ok(told) => break told,
                Err(error) => {
                    refusal_is_fair(&specs, &error);
                    specs.retain(|spec| spec.id != error.0);
                }
            }
        };
        for index in 0..specs.len() {
            receipt_is_sound(&told, index);
        }
        let first = |acts: &dyn Fn(Acts) -> bool| {
            let all = told.occurrences.iter();
            let mut of = all.filter(|it| it.begins && acts(specs[it.fault].kind.acts));
            of.next().map_or(u64::MAX, |it| it.epoch)
        };
        let onset = first(&|acts| matches!(acts, Acts::Samples | Acts::Delivery));
        for (k, out) in (1..).zip(&told.delivered) {
            prop_assert!(k >= onset || same(out, k), "{}", k);
        }
        let onset = first(&|acts| acts == Acts::Command);
        for (k, command) in (1..).zip(&told.commands) {
            prop_assert!(k >= onset || *command == answer(k - 1).gimbal_command, "{}", k);
        }
        // A second run has the same result, bit for bit (NaN as its bits).
        let again = run(&specs).unwrap();
        prop_assert_eq!(&again.receipts, &told.receipts);
        let all = |told: &RunRecord| told.delivered.iter().map(|out| bytes(out)).collect::<Vec<_>>();
        prop_assert_eq!(all(&again), all(&told));
    }
}

#[test]
fn every_kind_can_be_built_and_leaves_a_trace() {
    let mut runner = TestRunner::deterministic();
    // Faults of the wire and of the host don't act on samples.
    for kind in
        kinds::all().filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power))
    {
        let strategy = values(kind);
        let traced = (0..500).any(|_| {
            let values = strategy.new_tree(&mut runner).unwrap().current();
            let schedule = Schedule {
                trigger: Trigger::Epoch(15),
                duration: Some(300),
                recovery: 0,
                repeat: Repeat::Once,
            };
            let spec = FaultSpec { id: "f0".into(), kind, values, schedule };
            run(&[spec]).is_ok_and(|told| told.receipts[0].fired() || !told.events.is_empty())
        });
        assert!(traced, "{}", kind.name);
    }
}

#[test]
fn the_catalogue_is_in_order() {
    let mut names = Vec::new();
    for kind in kinds::all() {
        let plain = |name: &str, joint: char| {
            let letters = |part: &str| {
                !part.is_empty()
                    && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
            };
            name.split(joint).all(letters)
        };
        assert!(plain(kind.name, '-'), "{}", kind.name);
        assert!(!names.contains(&kind.name), "{}", kind.name);
        names.push(kind.name);
        assert!(kind.summary.ends_with('.') && !kind.summary.contains('\n'), "{}", kind.name);
        assert!(kind.model.len() > 100, "{}", kind.name);
        let mut keys = vec!["id", "kind", "trigger", "duration", "recovery", "repeat"];
        for parameter in kind.parameters {
            assert!(plain(parameter.name, '_'), "{}: {}", kind.name, parameter.name);
            assert!(!keys.contains(&parameter.name), "{}: {}", kind.name, parameter.name);
            assert!(parameter.doc.ends_with('.'), "{}: {}", kind.name, parameter.name);
            keys.push(parameter.name);
            if let Takes::Choice(names) = parameter.takes {
                // Defaults are written bare: no name may read as another value of TOML.
                let word = |name: &str| {
                    name.starts_with(|c: char| c.is_ascii_lowercase())
                        && !["nan", "inf", "true", "false"].contains(&name)
                };
                assert!(names.iter().all(|(name, _)| word(name)), "{}: {names:?}", kind.name);
            }
            if let (Takes::Choice(names), Some(default)) = (parameter.takes, parameter.default) {
                let known = names.iter().any(|(name, _)| *name == default);
                assert!(known, "{}: {default}", kind.name);
            }
        }
        assert!(kinds::named(kind.name).is_some_and(|found| std::ptr::eq(found, kind)));
    }
}
