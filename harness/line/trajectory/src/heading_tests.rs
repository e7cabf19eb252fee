//! Headings alone: their times, modes, instruments, and the account of each line.

use crate::point::{SECOND_NS, TimeScale, TrajectoryPoint};
use crate::reader::TrajectoryReader;
use octant_scenario::trajectory::{HeadingTime, NmeaChoice, NmeaPoints, TrajectoryFormat};

/// 2026-11-20T10:00:00Z.
const TEN_NS: i64 = 1_795_168_800 * SECOND_NS;

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

fn tagged(fields: &str, body: &str) -> String {
    let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("UdPbC\0\\{fields}*{sum:02X}\\{}", sentence(body))
}

fn zda(second: u32) -> String {
    sentence(&format!("GPZDA,10{:02}{:02}.00,20,11,2026,00,00", second / 60, second % 60))
}

fn hdt(degrees: f64) -> String {
    sentence(&format!("HEHDT,{:.1},T", degrees.rem_euclid(360.0)))
}

struct Read {
    points: Vec<TrajectoryPoint>,
    scale: TimeScale,
    used: u64,
    left_out: Vec<(&'static str, u64)>,
}

fn read_as(text: &str, choice: NmeaChoice) -> Result<Read, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.nmea");
    std::fs::write(&path, text).unwrap();
    let format = TrajectoryFormat::Nmea(choice);
    let mut reader =
        TrajectoryReader::open(&path, &format).map_err(|error| error.reason.clone())?;
    let mut points = Vec::new();
    while let Some(point) = reader.next().map_err(|error| error.reason)? {
        points.push(point);
    }
    let account = reader.account("solution");
    let left_out = reader.tally().reasons().collect();
    Ok(Read { points, scale: reader.scale(), used: account.used_count(), left_out })
}

fn read(text: &str) -> Read {
    read_as(text, NmeaChoice::default()).unwrap()
}

fn by(heading_time: HeadingTime) -> NmeaChoice {
    NmeaChoice { heading_time: Some(heading_time), ..NmeaChoice::default() }
}

fn degrees(point: &TrajectoryPoint) -> f64 {
    let attitude = point.attitude.unwrap();
    (attitude.heading_rad.to_degrees() * 1e6).round() / 1e6
}

fn seconds(points: &[TrajectoryPoint]) -> Vec<f64> {
    points.iter().map(|point| (point.time_ns - TEN_NS) as f64 / SECOND_NS as f64).collect()
}

#[test]
fn headings_of_a_cycle_are_spread_evenly_to_the_next_time() {
    // Four a second; a second of the clock is lost, and one heading is invalid.
    let mut text = hdt(9.0);
    for second in 0..5 {
        if second != 3 {
            text += &zda(second);
        }
        for quarter in 0..4 {
            let heading = f64::from(second) + f64::from(quarter) / 10.0;
            text += &if (second, quarter) == (1, 2) { sentence("HEHDT,,T") } else { hdt(heading) };
        }
    }
    let found = read(&text);
    // The cycle of two seconds has eight: they keep the spacing of the others.
    let expected: Vec<f64> = (0..20).filter(|k| *k != 6).map(|k| f64::from(k) / 4.0).collect();
    assert_eq!(seconds(&found.points), expected);
    assert_eq!(degrees(&found.points[4]), 1.0);
    assert!(found.points.iter().all(|point| point.attitude_doubt_s == 0.25));
    assert!(found.points.iter().all(|point| point.position.is_none()));
    assert_eq!(found.used, 19 + 4);
    let expected = [
        ("headings before the first time of day", 1),
        ("headings that the instrument calls invalid", 1),
    ];
    assert_eq!(found.left_out, expected);
    let digit_deg = found.points[0].digit_rad[2].to_degrees();
    assert!((digit_deg - 0.1).abs() < 1e-12);
}

#[test]
fn a_gap_of_the_log_keeps_the_spacing() {
    let cycle = |second: u32| zda(second) + &hdt(1.0) + &hdt(2.0);
    let text: String = (0..5).chain(20..25).map(cycle).collect();
    let found = seconds(&read(&text).points);
    assert_eq!(found[8..12], [4.0, 4.5, 20.0, 20.5]);
}

#[test]
fn midnight_and_the_date_are_those_of_the_clock() {
    let clock = |text: &str| sentence(&format!("GPZDA,{text},00,00"));
    let text = clock("235959.00,20,11,2026")
        + &hdt(1.0)
        + &clock("000000.00,21,11,2026")
        + &hdt(2.0)
        + &clock("000001.00,21,11,2026");
    // 14 h after ten.
    assert_eq!(seconds(&read(&text).points), [50_399.0, 50_400.0]);
}

#[test]
fn tag_blocks_and_stamps_are_times() {
    let ms = TEN_NS / 1_000_000;
    let tags = tagged(&format!("s:HE0001,n:1,c:{ms}"), "HEHDT,1.0,T")
        + &tagged(&format!("g:1-2-7,c:{}", ms + 500), "HEROT,0.0,A")
        + &tagged("g:2-2-7", "HETHS,2.0,A")
        + &tagged(&format!("c:{}", ms / 1000 + 1), "HETHS,3.0,A")
        + &tagged("s:HE0001", "HETHS,4.0,A")
        + &tagged(&format!("c:{}", ms + 2000), "HETHS,5.0,A").replace("c:", "d:");
    let found = read(&tags);
    // HDT repeats THS; the group of ROT isn't that of a heading.
    assert_eq!(seconds(&found.points), [1.0]);
    assert!(found.left_out.contains(&("headings without a time in their TAG block", 2)));
    assert!(found.left_out.contains(&("sentences with a damaged TAG block", 1)));
    let group =
        tagged(&format!("g:1-2-7,c:{ms}"), "HETHS,1.0,A") + &tagged("g:2-2-7", "HETHS,2.0,A");
    let found = read(&group);
    assert_eq!(found.points.len(), 1, "two headings of one time");
    let stamped = format!(
        "gyro 2026-11-20T10:00:00.125Z {}gyro 2026-11-20 10:00:01.5 {}",
        hdt(1.0),
        hdt(2.0)
    );
    let found = read(&stamped);
    assert_eq!(seconds(&found.points), [0.125, 1.5]);
    assert!(found.points.iter().all(|point| point.attitude_doubt_s == 0.0));
    // The user chooses among several ways.
    let both: String = (0..3)
        .map(|second| zda(second) + &format!("2026-11-20T10:00:0{second}.700Z {}", hdt(1.0)))
        .collect();
    assert_eq!(seconds(&read(&both).points), [0.7, 1.7, 2.7]);
    let cycle = read_as(&both, by(HeadingTime::Cycle)).unwrap();
    assert_eq!(seconds(&cycle.points), [0.0, 1.0, 2.0]);
}

#[test]
fn a_rate_that_is_given_needs_no_time() {
    let text: String = (0..5).map(|k| hdt(f64::from(k))).collect();
    let refusal = read_as(&text, NmeaChoice::default()).err().unwrap();
    assert!(
        refusal.contains("found 5 headings of HE and nothing that tells their times"),
        "{refusal}"
    );
    assert!(refusal.contains("heading_rate = \"10 Hz\""), "{refusal}");
    let found = read_as(&text, by(HeadingTime::Rate(10.0, Some(TEN_NS)))).unwrap();
    assert_eq!(seconds(&found.points), [0.0, 0.1, 0.2, 0.3, 0.4]);
    assert_eq!(found.scale, TimeScale::Utc);
    let own = read_as(&text, by(HeadingTime::Rate(10.0, None))).unwrap();
    assert_eq!((own.scale, own.points[1].time_ns), (TimeScale::Own, 100_000_000));
    for time in [HeadingTime::Tag, HeadingTime::Stamp, HeadingTime::Cycle] {
        let refusal = read_as(&text, by(time)).err().unwrap();
        assert!(refusal.contains("found 5 headings of HE, expected "), "{time:?}: {refusal}");
    }
}

#[test]
fn modes_and_status_decide_which_headings_count() {
    let body = |mode: &str| sentence(&format!("HETHS,100.0,{mode}"));
    let text: String = ["A", "E", "M", "S", "V", "A"]
        .iter()
        .enumerate()
        .map(|(second, mode)| zda(second as u32) + &body(mode) + &sentence("VDVBW,1.0,0.0,V,,,V"))
        .collect();
    let found = read(&text);
    assert_eq!(seconds(&found.points), [0.0, 1.0, 5.0]);
    let vbw = "VBW sentences: speed along and across the ship isn't scored";
    for expected in [
        ("sentences of a simulator or of manual input", 2),
        ("headings that the instrument calls invalid", 1),
        (vbw, 6),
    ] {
        assert!(found.left_out.contains(&expected), "{expected:?}: {:?}", found.left_out);
    }
    let reference = NmeaChoice { fixes_alone: true, ..NmeaChoice::default() };
    let found = read_as(&text, reference).unwrap();
    assert_eq!(seconds(&found.points), [0.0, 5.0]);
    assert!(found.left_out.contains(&("headings that are estimated (dead reckoning)", 1)));
}

#[test]
fn qualities_of_a_seapath_decide_which_attitudes_count() {
    let attitude = |degrees: f64| sentence(&format!("PSXN,23,-1.50,2.25,{degrees:.2},0.10"));
    let quality = |heading: u32| sentence(&format!("PSXN,20,0,0,{heading},0"));
    let text = zda(0)
        + &quality(0)
        + &attitude(10.0)
        + &zda(1)
        + &quality(2)
        + &attitude(11.0)
        + &zda(2)
        + &quality(1)
        + &attitude(12.0)
        + &zda(3);
    let found = read(&text);
    assert_eq!(seconds(&found.points), [0.0, 2.0]);
    let [roll, pitch, heading] = found.points[0].attitude_rad().unwrap().map(f64::to_degrees);
    assert!(
        (roll + 1.5).abs() < 1e-12
            && (pitch - 2.25).abs() < 1e-12
            && (heading - 10.0).abs() < 1e-12
    );
    assert_eq!(found.left_out, [("headings that the instrument calls invalid", 1)]);
}

#[test]
fn two_instruments_are_refused_until_one_is_chosen() {
    let text: String = (0..4)
        .map(|second| {
            zda(second) + &hdt(1.0) + &sentence("GPHDT,2.0,T") + &sentence("PFEC,GPatt,3.0,0.1,0.1")
        })
        .collect();
    let refusal = read_as(&text, NmeaChoice::default()).err().unwrap();
    assert!(
        refusal.contains("found headings of HE and of GP, expected one instrument"),
        "{refusal}"
    );
    for (talker, heading) in [("HE", 1.0), ("GP", 2.0), ("PFEC", 3.0)] {
        let choice = NmeaChoice { talker: Some(talker.to_owned()), ..NmeaChoice::default() };
        let found = read_as(&text, choice).unwrap();
        assert_eq!(degrees(&found.points[0]), heading);
        assert_eq!(found.left_out, [("sentences of other talkers", 8)], "{talker}");
        assert_eq!(found.points.len(), 4);
    }
}

#[test]
fn a_pashr_has_its_own_time_and_states_its_sigma() {
    let text: String = (0..3)
        .map(|second| {
            let time = format!("10000{second}.50");
            zda(second)
                + &sentence(&format!("PASHR,{time},90.12,T,1.25,-0.50,,0.010,0.010,0.020,1,0"))
        })
        .collect();
    let found = read(&text);
    assert_eq!(seconds(&found.points), [0.5, 1.5, 2.5]);
    let sigma = found.points[0].sigma.attitude_rad.unwrap()[2].to_degrees();
    assert!((sigma - 0.02).abs() < 1e-12);
}

#[test]
fn a_position_takes_the_first_heading_behind_it() {
    let gga = |second: u32| {
        sentence(&format!(
            "GPGGA,10000{second}.00,4500.0000,N,01000.0000,E,1,09,0.9,1.0,M,48.0,M,,"
        ))
    };
    let text: String = (0..3)
        .map(|second| zda(second) + &gga(second) + &hdt(f64::from(second)) + &hdt(9.0))
        .collect();
    let found = read(&text);
    assert_eq!(seconds(&found.points), [0.0, 1.0, 2.0]);
    assert_eq!(found.points.iter().map(degrees).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
    assert!(found.points.iter().all(|point| point.position.is_some()));
    // By less than the time to the next position.
    assert_eq!(found.points[2].attitude_doubt_s, 1.0);
    assert_eq!(
        found.left_out,
        [("headings without a time, besides the first behind their position", 3)]
    );
    let alone = NmeaChoice { points: Some(NmeaPoints::Headings), ..NmeaChoice::default() };
    let found = read_as(&text, alone).unwrap();
    assert_eq!(seconds(&found.points), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
    let positions = NmeaChoice { points: Some(NmeaPoints::Positions), ..by(HeadingTime::Cycle) };
    let refusal = read_as(&text, positions).err().unwrap();
    assert!(refusal.contains("expected points = \"headings\""), "{refusal}");
}

#[test]
fn headings_without_checksums_are_refused() {
    let bare = hdt(1.0).split('*').next().unwrap().to_owned() + "\r\n";
    let refusal = read_as(&bare.repeat(20), by(HeadingTime::Rate(1.0, None))).err().unwrap();
    assert!(refusal.contains("found 20 sentences without a checksum"), "{refusal}");
}
