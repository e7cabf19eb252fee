//! A station that was saved and loaded continues bit for bit, with every kind of the catalogue
//! active; other bytes are refused.

use super::draw::spec;
use super::plain::plain;
use super::{EPOCHS, answer, source};
use crate::common::{Log, bytes, setup};
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, Occurrence, STATE_FORMAT};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultKind, FaultSpec, Receipt, Station, kinds};
use octant_sample::disturbance::Disturbance;
use octant_sample::{GimbalCommand, Truth};
use octant_state::{StateError, Writer, assert_layout};
use proptest::prelude::*;
use std::sync::LazyLock;
use std::time::Instant;

/// Result of one epoch.
#[derive(Debug, PartialEq)]
struct Step {
    delivered: Vec<u8>,
    command: GimbalCommand,
    events: Vec<UnitEvent>,
    occurrences: Vec<Occurrence>,
    begun: Vec<(u32, Disturbance)>,
    ended: Vec<u32>,
    receipts: Vec<Receipt>,
}

fn step((station, log): (&mut Station, &mut Log), specs: &[FaultSpec], k: u64) -> Step {
    if k == 20 {
        for spec in specs {
            station.fire(&spec.id);
        }
    }
    log.truth = Some(Truth::default());
    log.begun.clear();
    log.ended.clear();
    let output = answer(k - 1);
    let mut command = output.gimbal_command;
    station.before(&mut command, &output, log);
    let epoch = source(k);
    log.deliver(&epoch);
    let delivered = match station.after(&epoch, &output, log).delivered {
        Delivered::Untouched => bytes(&[epoch]),
        Delivered::These(epochs) => bytes(epochs),
    };
    let (events, occurrences) = (station.unit_events().to_vec(), station.occurrences().to_vec());
    station.told();
    let receipts = station.receipts();
    let (begun, ended) = (log.begun.clone(), log.ended.clone());
    Step { delivered, command, events, occurrences, begun, ended, receipts }
}

fn saved(station: &Station) -> Vec<u8> {
    let mut bytes = Vec::new();
    station.save(&mut bytes);
    bytes
}

fn load(specs: &[FaultSpec], bytes: &[u8]) -> Result<Station, StateError> {
    Station::load(specs, &setup(), bytes)
}

/// Runs a station, and beside it copies made at some epochs by saving and loading, and by cloning.
fn goes_on(specs: &[FaultSpec], points: &[u64]) {
    let (mut station, mut log) = (Station::new(specs, &setup()).unwrap(), Log::default());
    let mut copies: Vec<(Station, Log)> = Vec::new();
    for k in 1..=EPOCHS {
        let expected = step((&mut station, &mut log), specs, k);
        for (copy, log) in &mut copies {
            let found = step((copy, log), specs, k);
            assert_eq!(
                format!("{found:?}"),
                format!("{expected:?}"),
                "{} at {k}",
                specs[0].kind.name
            );
        }
        if points.contains(&k) {
            copies.push((load(specs, &saved(&station)).unwrap(), log.clone()));
            copies.push((station.clone(), log.clone()));
        }
    }
    let bytes = saved(&station);
    assert!(copies.iter().all(|(copy, _)| saved(copy) == bytes), "{}", specs[0].kind.name);
}

/// A fault that lasts from epoch 15 to 300, then fades if it can; twice.
fn long(kind: &'static FaultKind, id: &str) -> FaultSpec {
    let fades = kind.lasts == octant_faults::catalogue::Lasts::Fading;
    let schedule = Schedule {
        trigger: Trigger::Epoch(15),
        duration: Some(150),
        recovery: if fades { 30 } else { 0 },
        repeat: Repeat::Times { times: 2, every: 200 },
    };
    FaultSpec { id: id.into(), kind, values: plain(kind), schedule }
}

/// All kinds at once.
fn all_at_once() -> Vec<FaultSpec> {
    kinds::all().map(|kind| long(kind, kind.name)).collect()
}

#[test]
fn a_loaded_station_goes_on_bit_for_bit_with_every_kind_under_way() {
    for kind in kinds::all() {
        let spec = long(kind, "f0");
        // Before, at the onset, in the middle, while the fault fades, afterwards, in the second
        // firing.
        goes_on(&[spec], &[3, 14, 15, 16, 77, 164, 166, 180, 197, 214, 215, 260, 365, 390]);
    }
}

#[test]
fn a_loaded_station_goes_on_bit_for_bit_with_all_kinds_at_once() {
    let specs = all_at_once();
    goes_on(&specs, &[15, 60, 150, 181, 240]);
}

#[test]
fn a_station_of_other_faults_does_not_take_it() {
    let (one, other) =
        (long(kinds::named("spike").unwrap(), "a"), long(kinds::named("spike").unwrap(), "b"));
    let mut station = Station::new(std::slice::from_ref(&one), &setup()).unwrap();
    step((&mut station, &mut Log::default()), &[], 1);
    let bytes = saved(&station);
    assert!(load(std::slice::from_ref(&one), &bytes).is_ok());
    let said = |specs: &[FaultSpec]| load(specs, &bytes).unwrap_err().to_string();
    assert_eq!(
        said(std::slice::from_ref(&other)),
        "fault: \"a\" (spike) was found, \"b\" (spike) is expected"
    );
    assert_eq!(said(&[one, other.clone()]), "fault: the bytes end before it, or it is none");
    assert!(said(&[]).starts_with("end: "), "{}", said(&[]));
    let error = load(&[other.clone(), other], &bytes).unwrap_err();
    assert_eq!(error.to_string(), "faults: \"b\": the id \"b\" is given to two faults");
}

#[test]
fn the_layout_is_the_stored_one() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    let specs = all_at_once();
    let mut station = Station::new(&specs, &setup()).unwrap();
    let mut log = Log::default();
    for k in 1..=60 {
        step((&mut station, &mut log), &specs, k);
    }
    let outlines = [("every kind", Writer::outline(&station))];
    assert_layout(&format!("{folder}/station.txt"), STATE_FORMAT.version, &outlines);

    // Bytes of that version have to remain readable.
    let path = format!("{folder}/station-{}.bin", STATE_FORMAT.version);
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(&path, saved(&station)).unwrap();
    }
    let stored = std::fs::read(&path).unwrap();
    assert_eq!(saved(&load(&specs, &stored).unwrap()), stored);
}

/// What an earlier version lacked can't be made up.
#[test]
fn a_state_of_an_earlier_version_is_refused_in_words() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    let specs = all_at_once();
    for version in 1..STATE_FORMAT.version {
        let stored = std::fs::read(format!("{folder}/station-{version}.bin")).unwrap();
        assert_eq!(
            load(&specs, &stored).unwrap_err().to_string(),
            format!(
                "the state of a station of faults has version {version}, this program reads version 2"
            )
        );
    }
}

/// Makes a frame with another payload and the right checksum.
fn reframed(payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    STATE_FORMAT.write(&mut bytes, |to| payload.iter().for_each(|byte| to.value("byte", byte)));
    bytes
}

fn payload(bytes: &[u8]) -> &[u8] {
    &bytes[18..bytes.len() - 4]
}

/// Every kind alone, saved while it lasts, and once while it fades or is over.
static SAVED: LazyLock<Vec<(FaultSpec, Vec<u8>)>> = LazyLock::new(|| {
    let mut all = Vec::new();
    for kind in kinds::all() {
        let spec = long(kind, "f0");
        let mut station = Station::new(std::slice::from_ref(&spec), &setup()).unwrap();
        let mut log = Log::default();
        for k in 1..=180 {
            step((&mut station, &mut log), &[], k);
            if k == 77 || k == 180 {
                all.push((spec.clone(), saved(&station)));
            }
        }
    }
    all
});

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_the_faults_and_the_moment_it_goes_on(
        mut specs in proptest::collection::vec(spec(), 1..5),
        points in proptest::collection::vec(1..EPOCHS, 1..4),
    ) {
        for (index, spec) in specs.iter_mut().enumerate() {
            spec.id = format!("f{index}");
        }
        // A few faults are refused; the others still make a run.
        while let Err(error) = Station::new(&specs, &setup()) {
            specs.retain(|spec| spec.id != error.0);
        }
        if !specs.is_empty() {
            goes_on(&specs, &points);
        }
    }

    #[test]
    fn any_altered_bit_and_any_cut_is_refused(
        which in any::<prop::sample::Index>(),
        at in any::<prop::sample::Index>(),
        bit in 0..8u8,
    ) {
        let (spec, good) = &SAVED[which.index(SAVED.len())];
        let specs = std::slice::from_ref(spec);
        let at = at.index(good.len());
        prop_assert!(load(specs, &good[..at]).is_err());
        let mut altered = good.clone();
        altered[at] ^= 1 << bit;
        let error = load(specs, &altered).unwrap_err();
        prop_assert!(!matches!(error, StateError::Value { .. }), "{error}");
    }

    /// Any bytes with a right checksum are refused, or the station made from them doesn't panic.
    #[test]
    fn nonsense_with_a_right_checksum_does_not_panic(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), prop_oneof![any::<u8>(), Just(0xFF), Just(0)]),
            1..8,
        ),
        run in 1..9usize,
    ) {
        let (spec, good) = &SAVED[which.index(SAVED.len())];
        let mut altered = payload(good).to_vec();
        for (at, value) in &changes {
            let at = at.index(altered.len());
            let end = (at + run).min(altered.len());
            altered[at..end].fill(*value);
        }
        if let Ok(mut station) = load(std::slice::from_ref(spec), &reframed(&altered)) {
            let mut log = Log::default();
            for k in 100..300 {
                step((&mut station, &mut log), &[], k);
            }
            let _ = saved(&station);
        }
    }
}

/// Prints the duration and the size, for information.
#[test]
fn figures() {
    let specs = all_at_once();
    let mut station = Station::new(&specs, &setup()).unwrap();
    let mut log = Log::default();
    for k in 1..=60 {
        step((&mut station, &mut log), &specs, k);
    }
    const TIMES: u32 = 100;
    let start = Instant::now();
    for _ in 0..TIMES {
        std::hint::black_box(station.clone());
    }
    let cloned = start.elapsed() / TIMES;
    let start = Instant::now();
    let mut bytes = Vec::new();
    for _ in 0..TIMES {
        bytes = saved(&station);
    }
    let save = start.elapsed() / TIMES;
    let start = Instant::now();
    for _ in 0..TIMES {
        std::hint::black_box(load(&specs, &bytes).unwrap());
    }
    let loaded = start.elapsed() / TIMES;
    println!(
        "{} faults: {} bytes saved; clone {cloned:?}, save {save:?}, load {loaded:?}",
        specs.len(),
        bytes.len()
    );
}
