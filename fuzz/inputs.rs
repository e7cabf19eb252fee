//! What is done with foreign bytes, for the fuzzer and for the test that runs the corpus.
//!
//! Nothing here may panic, run for long or take much memory, whatever the bytes are; and what is
//! accepted has to keep its promises.

use octant_calibration::table::CalibrationTable;
use octant_fmu_check::{check_archive, check_description, show};
use octant_fmu_host::archive::{Archive, ArchiveLimits};
use octant_fmu_host::description::units::{UnitConversion, known};
use octant_fmu_host::description::{decode, read, read_bytes};
use octant_recorder::reader;
use octant_scenario::Scenario;
use octant_scenario::recorded::{
    AxisColumn, Delimiter, RecordedColumn, RecordedQuantity, TextFiles, TextMapping, TimeColumn,
    TimeUnit,
};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_source::{Epoch, Source, TextSource};
use std::path::Path;

/// A scenario: refused, or resolved to a text that reads back as the same scenario.
pub(crate) fn scenario(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(scenario) = Scenario::parse(text, "input.toml", Path::new(""), &[]) else { return };
    let draws = DrawnValues::of(&scenario, &Seeded(scenario.seed));
    let resolved = scenario.to_resolved_toml(scenario.seed, &draws);
    let again = Scenario::parse(&resolved, "resolved.toml", Path::new(""), &[])
        .expect("a resolved scenario is a scenario");
    let draws = DrawnValues::of(&again, &Seeded(again.seed));
    assert_eq!(again.to_resolved_toml(again.seed, &draws), resolved);
}

/// A recording, read to its end.
pub(crate) fn recording(bytes: &[u8]) {
    let _ = reader::read_bytes(bytes);
}

/// An FMU: refused, or every entry read as the archive says, unpacked where nothing speaks against it,
/// and checked.
pub(crate) fn fmu(bytes: &[u8]) {
    let limits = ArchiveLimits {
        entries: 200,
        directory_bytes: 64 << 10,
        unpacked_bytes: 256 << 10,
        ratio_free_bytes: 64 << 10,
        read_bytes: 128 << 10,
        ..ArchiveLimits::DEFAULT
    };
    let open = || Archive::survey_bytes("input.fmu", bytes.to_vec(), limits);
    let Ok(mut archive) = open() else { return };
    for entry in archive.entries().to_vec() {
        if let Ok(contents) = archive.read(&entry.name) {
            assert!(contents.len() <= 128 << 10, "{} is read beyond the limit", entry.name);
        }
    }
    // Not for each of a million inputs: it writes files.
    if archive.entries().len() < 20
        && let Ok(unpacked) = archive.unpack()
    {
        for entry in archive.entries() {
            let path = unpacked.path().join(&entry.name);
            let inside = path.canonicalize().expect("what was unpacked is there");
            let folder = unpacked.path().canonicalize().expect("the folder is there");
            assert!(inside.starts_with(folder), "{} is outside", entry.name);
        }
    }
    if let Ok(archive) = open()
        && let Ok(checked) = check_archive(archive)
    {
        let _ = show::text(&checked.report());
    }
}

/// A model description: refused, or read the same from its decoded text; units converted and rules
/// checked in any case.
pub(crate) fn description(bytes: &[u8]) {
    let found = read_bytes(bytes, "input.xml");
    let Ok((text, _)) = decode(bytes, "input.xml") else { return };
    let again = read(&text, "input.xml");
    assert_eq!(found.is_ok(), again.is_ok());
    if let Ok(description) = again {
        for variable in &description.variables {
            let _ = description.elements(variable);
            for wanted in ["rad", "m/s", "K"] {
                if let Ok(conversion) = UnitConversion::of(&description, variable, wanted) {
                    assert!(conversion.factor.is_finite() && conversion.offset.is_finite());
                }
            }
        }
        for unit in &description.units {
            let _ = known(&unit.name);
        }
    }
    let _ = check_description(&text);
}

/// Columns of text, read to the end: stamps never go back.
pub(crate) fn text(bytes: &[u8]) {
    // Per process: targets run side by side.
    let path = std::env::temp_dir().join(format!("octant-text-{}.txt", std::process::id()));
    std::fs::write(&path, bytes).expect("the temporary folder can be written");
    for delimiter in [Delimiter::Blanks, Delimiter::Character(b',')] {
        let axis =
            |number| AxisColumn { column: RecordedColumn::Number(number), offset: 0.0, scale: 1.0 };
        let mapping = TextMapping {
            files: TextFiles::One(path.clone()),
            time: Some(TimeColumn { column: RecordedColumn::Number(1), unit: TimeUnit::Second }),
            gyro: [axis(2), axis(3), axis(4)],
            accelerometer: [axis(5), axis(6), axis(7)],
            quantity: RecordedQuantity::Rates,
            nominal_rate_hz: 100.0,
            split: 1,
            delimiter,
            comment: "#".to_owned(),
            skip_lines: 0,
            header: false,
            gimbal: None,
            temperature: None,
        };
        let Ok(mut source) = TextSource::open(&mapping) else { continue };
        let mut last_ns = 0;
        let mut epoch = Epoch::default();
        while let Ok(true) = source.next(&Default::default(), &mut epoch) {
            assert!(epoch.sample.device_time.ns >= last_ns, "a stamp goes back");
            last_ns = epoch.sample.device_time.ns;
        }
    }
    let _ = std::fs::remove_file(&path);
}

/// A calibration table: refused, or written back as the same bytes; one of an earlier version as
/// bytes of the present one that say the same.
pub(crate) fn table(bytes: &[u8]) {
    let Ok(table) = CalibrationTable::from_bytes(bytes) else { return };
    let written = table.to_bytes();
    let again = CalibrationTable::from_bytes(&written).expect("what was written is read");
    assert!(again.to_bytes() == written, "read and written twice, it changes");
    let present = bytes[..8] == written[..8];
    assert!(!present || written == bytes, "a table of the present version changes");
}
