//! Text of real instruments as a source: counts, stamps, and errors that name the place.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalCommand, Status};
use octant_scenario::file_names::FileNames;
use octant_scenario::recorded::{
    AxisColumn, Delimiter, GimbalColumns, RecordedColumn, RecordedQuantity, TemperatureColumn,
    TemperatureUnit, TextFiles, TextMapping, TimeColumn, TimeUnit,
};
use octant_source::{Epoch, Source, SourceError, TextSource};
use std::path::{Path, PathBuf};

fn axis(column: usize, offset: f64, scale: f64) -> AxisColumn {
    AxisColumn { column: RecordedColumn::Number(column), offset, scale }
}

fn mapping(files: TextFiles) -> TextMapping {
    TextMapping {
        files,
        time: Some(TimeColumn { column: RecordedColumn::Number(1), unit: TimeUnit::Second }),
        gyro: [2, 3, 4].map(|column| axis(column, 0.0, 1.0)),
        accelerometer: [5, 6, 7].map(|column| axis(column, 0.0, 1.0)),
        quantity: RecordedQuantity::Rates,
        nominal_rate_hz: 100.0,
        split: 1,
        delimiter: Delimiter::Character(b','),
        comment: "#".into(),
        skip_lines: 0,
        header: false,
        gimbal: None,
        temperature: None,
    }
}

fn all(source: &mut TextSource) -> Result<Vec<Epoch>, SourceError> {
    let mut epochs = Vec::new();
    let mut epoch = Epoch::default();
    while source.next(&GimbalCommand::default(), &mut epoch)? {
        epochs.push(epoch);
    }
    Ok(epochs)
}

fn file(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn read(text: &str, change: impl FnOnce(&mut TextMapping)) -> Result<Vec<Epoch>, SourceError> {
    let folder = tempfile::tempdir().unwrap();
    let mut mapping = mapping(TextFiles::One(file(&folder, "a.csv", text)));
    change(&mut mapping);
    all(&mut TextSource::open(&mapping)?)
}

fn error(text: &str, change: impl FnOnce(&mut TextMapping)) -> String {
    read(text, change).unwrap_err().to_string()
}

#[test]
fn rates_become_counts_over_the_real_intervals() {
    // 100 Hz is configured, and the stamps of 100 rows say 98.
    let rows = |k: usize| format!("{:.6}, 1e-3, 0, 0, 0, 0, 9.8\n", 1.0 + k as f64 / 98.0);
    let text: String = (0..100).map(rows).collect();
    let epochs = read(&format!("# a comment\n\n{text}"), |_| {}).unwrap();
    assert_eq!(epochs.len(), 100);
    let last = &epochs[99].sample;
    assert!(last.device_time.ns.abs_diff(2_010_204_082) < 2000, "{last:?}");
    assert_eq!(last.sequence, 100);
    // 1e-3 rad/s from row 1 to row 99, 98/98 s: the sum is that of the stamps, and the remainder of the counts is carried.
    let counts: i64 =
        epochs[1..99].iter().map(|epoch| i64::from(epoch.sample.delta_theta[0])).sum();
    assert!((counts as f64 * DELTA_THETA_LSB_RAD - 1e-3).abs() < 3e-9, "{counts}");
    // The first row has the configured period, of which the fit knows nothing yet.
    assert_eq!(epochs[0].sample.delta_theta[0], 687_195);
    let velocity: i64 =
        epochs[1..99].iter().map(|epoch| i64::from(epoch.sample.delta_velocity[2])).sum();
    assert!((velocity as f64 * DELTA_VELOCITY_LSB_MPS - 9.8).abs() < 3e-5, "{velocity}");
    assert_eq!(epochs[1].sample.status, Status::GIMBAL_INVALID, "the file has no gimbals");
}

#[test]
fn names_signs_order_increments_and_gimbals() {
    let file_names = |mapping: &TextMapping| {
        FileNames::of(&octant_scenario::SourceSpec::Text(mapping.clone())).line().unwrap()
    };
    let text = "t_ms;wz;wy;wx;az;ay;ax;azimuth;roll\n5;1e-6;2e-6;3e-6;1e-3;2e-3;3e-3;90;-45\n";
    let epochs = read(text, |mapping| {
        let named = |name: &str, scale| AxisColumn {
            column: RecordedColumn::Name(name.into()),
            offset: 0.0,
            scale,
        };
        mapping.delimiter = Delimiter::Character(b';');
        mapping.header = true;
        mapping.quantity = RecordedQuantity::Increments;
        mapping.time = Some(TimeColumn {
            column: RecordedColumn::Name("t_ms".into()),
            unit: TimeUnit::Millisecond,
        });
        mapping.gyro = [named("wx", 1.0), named("wy", -1.0), named("wz", 1.0)];
        mapping.accelerometer = [named("ax", 1.0), named("ay", 1.0), named("az", -2.0)];
        let degree = std::f64::consts::PI / 180.0;
        mapping.gimbal =
            Some(GimbalColumns { azimuth: named("azimuth", degree), roll: named("roll", degree) });
        let told = "gyro x, y, z: wx, −wy, wz; accelerometer x, y, z: ax, ay, −az";
        assert_eq!(file_names(mapping), told);
    })
    .unwrap();
    let sample = epochs[0].sample;
    let theta = |rad: f64| (rad / DELTA_THETA_LSB_RAD).round() as i32;
    assert_eq!(sample.delta_theta, [theta(3e-6), theta(-2e-6), theta(1e-6)]);
    assert_eq!(sample.delta_velocity[2], (-2e-3 / DELTA_VELOCITY_LSB_MPS).round() as i32);
    assert_eq!(sample.status, Status::empty());
    assert!((sample.gimbal.azimuth_rad().to_degrees() - 90.0).abs() < 1e-6);
    assert!((sample.gimbal.roll_rad().to_degrees() + 45.0).abs() < 1e-6);
    assert_eq!(sample.device_time.ns, 5_000_000);
}

#[test]
fn a_temperature_is_that_of_the_row_and_is_read_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.csv", "0.01,1,2,3,4,5,6,21.5\n0.02,1,2,3,4,5,6,\n");
    let mut mapping = mapping(TextFiles::One(path));
    assert_eq!(TextSource::open(&mapping).unwrap().temperature_c().unwrap(), None);
    let (column, unit) = (RecordedColumn::Number(8), TemperatureUnit::Celsius);
    (mapping.temperature, mapping.split) = (Some(TemperatureColumn { column, unit }), 2);
    let mut source = TextSource::open(&mapping).unwrap();
    let mut epoch = Epoch::default();
    for _ in 0..2 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        assert_eq!(source.temperature_c().unwrap(), Some(21.5));
    }
    // A run doesn't ask.
    assert_eq!(all(&mut source).unwrap().len(), 2);
    let said = source.temperature_c().unwrap_err().to_string();
    assert!(
        said.contains("a.csv: line 2: column 8: temperature NaN degC, expected a finite number"),
        "{said}"
    );
}

#[test]
fn what_does_not_fit_a_count_is_flagged_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.csv", "0.01,4,0,0,0,0,0\n0.02,-4,0,0,0,0,500\n0.03,1,0,0,0,0,1\n");
    let mut source = TextSource::open(&mapping(TextFiles::One(path))).unwrap();
    let epochs = all(&mut source).unwrap();
    // 2³¹ counts are 1/32 rad, 3.125 rad/s in 10 ms.
    assert_eq!(epochs[0].sample.delta_theta[0], i32::MAX);
    assert!(epochs[0].sample.status.contains(Status::GYRO_SATURATED));
    assert!(!epochs[0].sample.status.contains(Status::ACCELEROMETER_SATURATED));
    assert_eq!(epochs[1].sample.delta_theta[0], i32::MIN);
    assert!(epochs[1].sample.status.contains(Status::ACCELEROMETER_SATURATED));
    assert_eq!(source.saturated(), 2);
}

#[test]
fn errors_name_line_and_column() {
    let good = "0.01,1,2,3,4,5,6\n";
    let cases: [(String, &str); 6] = [
        (
            format!("{good}0.02,1,x2,3,4,5,6\n"),
            "line 2: column 3: found \"x2\", expected a finite number",
        ),
        (format!("{good}\n0.02,1,NaN,3,4,5,6\n"), "line 3: column 3: found \"NaN\""),
        (format!("{good}0.02,1,2\n"), "line 2: found 3 columns, expected 5 or more"),
        (
            (1..100)
                .map(|k| {
                    format!("{},1,2,3,4,5,6\n", k as f64 * 0.01 - if k > 50 { 0.4 } else { 0.0 })
                })
                .collect(),
            "line 51: the clock goes back from 0.5 s to 0.11 s: it was set, or the unit was restarted; where no row is \
             missing, time_column = \"none\" and the rate of the rows leave the stamps out",
        ),
        (format!("{good}-1,1,2,3,4,5,6\n"), "line 2: column 1: found \"-1\", expected a time"),
        (format!("{good}\u{fffd}"), "line 2: "),
    ];
    for (text, expected) in cases {
        let found = error(&text, |_| {});
        assert!(found.contains(expected), "found: {found}\nexpected: {expected}");
        assert!(found.contains("a.csv"), "{found}");
    }
    let found = error("t,a,b\n1,2,3\n", |mapping| {
        mapping.gyro[0].column = RecordedColumn::Name("wx".into());
        mapping.header = true;
    });
    assert!(found.contains("line 1: no column \"wx\", found t, a, b"), "{found}");
    let found = error("", |mapping| mapping.skip_lines = 2);
    assert!(found.contains("within the 2 lines to skip"), "{found}");
    let found = error(good, |mapping| mapping.gyro[0].column = RecordedColumn::Number(0));
    assert!(found.contains("column 0"), "{found}");
    let found = error(good, |mapping| mapping.nominal_rate_hz = 0.0);
    assert!(found.contains("nominal rate is 0 Hz"), "{found}");
    let found = error(&"1".repeat(100_000), |_| {});
    assert!(found.contains("longer than"), "{found}");
}

#[test]
fn a_header_with_another_delimiter_is_hinted_at() {
    let named = |mapping: &mut TextMapping, delimiter| {
        mapping.delimiter = delimiter;
        mapping.header = true;
        mapping.time =
            Some(TimeColumn { column: RecordedColumn::Name("t".into()), unit: TimeUnit::Second });
    };
    for (text, delimiter, expected) in [
        (
            "t,gx,gy,gz\n0,1,2,3\n",
            Delimiter::Blanks,
            "no column \"t\", found t,gx,gy,gz; with delimiter = \"comma\" the line has 4 columns",
        ),
        (
            "t;gx;gy\n",
            Delimiter::Character(b','),
            "no column \"t\", found t;gx;gy; with delimiter = \"semicolon\" the line has 3 columns",
        ),
        (
            "t gx\n",
            Delimiter::Character(b','),
            "no column \"t\", found t gx; with delimiter = \"whitespace\" the line has 2 columns",
        ),
        (
            "t,gx,t\n",
            Delimiter::Character(b','),
            "found two columns \"t\", 1 and 3, expected one: say which by its number",
        ),
        // A name with a blank in it, and no other delimiter.
        ("time gx\n", Delimiter::Blanks, "no column \"t\", found time, gx"),
    ] {
        let said = error(text, |mapping| named(mapping, delimiter));
        assert!(said.ends_with(&format!("line 1: {expected}")), "{said}");
    }
}

#[test]
fn two_files_have_to_agree() {
    let folder = tempfile::tempdir().unwrap();
    let gyro = file(&folder, "g.txt", "0.01 1 2 3\n0.02 1 2 3\n");
    let split = |accelerometer: PathBuf| {
        let mut mapping = mapping(TextFiles::Split { gyro: gyro.clone(), accelerometer });
        mapping.delimiter = Delimiter::Blanks;
        mapping.accelerometer = [2, 3, 4].map(|column| axis(column, 0.0, 1.0));
        all(&mut TextSource::open(&mapping).unwrap())
    };
    let same = file(&folder, "a.txt", "0.01 4 5 6\n0.02 4 5 6\n");
    assert_eq!(split(same).unwrap().len(), 2);
    let found = split(file(&folder, "b.txt", "0.01 4 5 6\n")).unwrap_err().to_string();
    assert!(found.contains("b.txt") && found.contains("ends after 1 row"), "{found}");
    let longer = file(&folder, "c.txt", "0.01 4 5 6\n0.02 4 5 6\n0.03 4 5 6\n");
    let found = split(longer).unwrap_err().to_string();
    assert!(found.contains("g.txt: line 2: the file ends after 2 rows"), "{found}");
    let shifted = file(&folder, "d.txt", "0.01 4 5 6\n0.0201 4 5 6\n");
    let found = split(shifted).unwrap_err().to_string();
    assert!(found.contains("d.txt: line 2: stamp 20100000 ns, expected 20000000 ns"), "{found}");
}

#[test]
fn a_header_is_skipped_in_every_file_whatever_names_the_columns() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |header: &str| format!("{header}0.01 1 2 3\n0.02 1 2 3\n");
    let split = |gyro: String, accelerometer: String| {
        let mut mapping = mapping(TextFiles::Split {
            gyro: file(&folder, "g.txt", &gyro),
            accelerometer: file(&folder, "a.txt", &accelerometer),
        });
        mapping.delimiter = Delimiter::Blanks;
        mapping.accelerometer = [2, 3, 4].map(|column| axis(column, 0.0, 1.0));
        mapping.header = true;
        all(&mut TextSource::open(&mapping)?)
    };
    let epochs = split(rows("t gx gy gz\n"), rows("t ax ay az\n")).unwrap();
    assert_eq!(epochs.len(), 2);
    assert_eq!(epochs[0].sample.device_time.ns, 10_000_000);
    // Without names the first row of data would be lost in silence.
    let found = split(rows("t gx gy gz\n"), rows("")).unwrap_err().to_string();
    assert!(found.contains("a.txt: line 1: found a row of numbers, expected the names"), "{found}");
}

#[test]
fn stamps_may_be_dates_with_a_time_of_day() {
    let stamps = |text: &str, delimiter: Delimiter, first: usize| -> Vec<u64> {
        let epochs = read(text, |mapping| {
            mapping.delimiter = delimiter;
            mapping.gyro = [0, 1, 2].map(|axis_| axis(first + axis_, 0.0, 1.0));
            mapping.accelerometer = [3, 4, 5].map(|axis_| axis(first + axis_, 0.0, 1.0));
        });
        epochs.unwrap().iter().map(|epoch| epoch.sample.device_time.ns).collect()
    };
    // `date -u -d '2027-03-31 08:00:00' +%s`: 1806480000.
    let expected = [1_806_480_000_000_000_000, 1_806_480_000_010_000_000];
    let comma = Delimiter::Character(b',');
    for [first, second] in [
        ["2027-03-31T08:00:00Z", "2027-03-31T08:00:00.01Z"],
        ["2027-03-31 08:00:00.000", "2027-03-31 08:00:00.010"],
        ["2027/03/31 10:00:00+02:00", "2027/03/31 10:00:00.01+02:00"],
    ] {
        let text = format!("{first},0,0,0,0,0,9.8\n{second},0,0,0,0,0,9.8\n");
        assert_eq!(stamps(&text, comma, 2), expected, "{text}");
    }
    // Two fields, where blanks are what separates fields.
    let text = "2027-03-31 08:00:00 0 0 0 0 0 9.8\n2027-03-31 08:00:00.01 0 0 0 0 0 9.8\n";
    assert_eq!(stamps(text, Delimiter::Blanks, 3), expected);
    let found = error("2027-02-30 08:00:00,0,0,0,0,0,9.8\n", |_| {});
    assert!(found.contains("line 1: column 1: found \"2027-02-30 08:00:00\", expected"), "{found}");
}

/// Returns the folder of real recordings, if they exist: by default one beside the repository.
fn recordings() -> PathBuf {
    std::env::var_os("OCTANT_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/recordings"),
        PathBuf::from,
    )
}

#[test]
fn a_real_multi_position_recording() {
    let folder = recordings().join("xsens-multiposition");
    if !folder.exists() {
        println!("skipped: no recording in {} (set OCTANT_RECORDINGS)", folder.display());
        return;
    }
    // Xsens unit, raw counts, 100 Hz; initial values from its publication.
    let (gyro_offset, gyro_scale) = ([32_777.14, 32_459.81, 32_511.84], 1.0 / 6258.0);
    let (accel_offset, accel_scale) = (32_768.0, 0.002_415);
    let mapping = TextMapping {
        gyro: std::array::from_fn(|i| axis(i + 2, gyro_offset[i], gyro_scale)),
        accelerometer: std::array::from_fn(|i| axis(i + 2, accel_offset, accel_scale)),
        delimiter: Delimiter::Blanks,
        ..mapping(TextFiles::Split {
            gyro: folder.join("gyroscope.txt"),
            accelerometer: folder.join("accelerometer.txt"),
        })
    };
    let mut source = TextSource::open(&mapping).unwrap();
    let epochs = all(&mut source).unwrap();
    assert_eq!(epochs.len(), 51_175);
    assert_eq!(epochs[0].sample.device_time.ns, 29_840_000);
    let flagged =
        epochs.iter().filter(|e| e.sample.status.contains(Status::GYRO_SATURATED)).count();
    assert_eq!(flagged as u64, source.saturated());
    // Counted by awk: (raw - offset) / 6258 times the interval reaches 1/32 rad on some axis. The
    // unit was turned by hand, faster than the 179 °/s that a count holds at 100 Hz.
    assert_eq!(flagged, 195);

    // Means of the raw columns up to 50 s, from the counts and from awk over the files.
    let mut previous_ns = 29_840_000 - 10_000_000;
    let (mut n, mut gyro, mut accel) = (0.0, [0.0; 3], [0.0; 3]);
    for epoch in &epochs {
        let sample = epoch.sample;
        if sample.device_time.ns > 50_000_000_000 {
            break;
        }
        let interval_s = (sample.device_time.ns - previous_ns) as f64 * 1e-9;
        previous_ns = sample.device_time.ns;
        n += 1.0;
        for i in 0..3 {
            gyro[i] += f64::from(sample.delta_theta[i]) * DELTA_THETA_LSB_RAD / interval_s;
            accel[i] += f64::from(sample.delta_velocity[i]) * DELTA_VELOCITY_LSB_MPS / interval_s;
        }
    }
    assert_eq!(n, AWK_ROWS);
    for i in 0..3 {
        let mean = gyro[i] / n / gyro_scale + gyro_offset[i];
        assert!((mean - AWK_GYRO[i]).abs() < 1e-5, "gyro {i}: {mean}, awk {}", AWK_GYRO[i]);
        let mean = accel[i] / n / accel_scale + accel_offset;
        assert!((mean - AWK_ACCEL[i]).abs() < 1e-5, "accel {i}: {mean}, awk {}", AWK_ACCEL[i]);
    }
}

// awk '$1<=50{n++; for(i=2;i<5;i++) s[i]+=$i} END{print n, s[2]/n, s[3]/n, s[4]/n}'
const AWK_ROWS: f64 = 4998.0;
const AWK_GYRO: [f64; 3] = [32_777.150_460_184, 32_459.816_526_611, 32_511.848_939_576];
const AWK_ACCEL: [f64; 3] = [33_102.205_882_353, 33_330.559_823_930, 36_433.738_895_558];
