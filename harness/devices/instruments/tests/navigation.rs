//! Navigation messages: lines with checksums of others, and frames by an independent encoder (Python's `struct`), all of one
//! state: 53.25° N, 6.5° W, 116.5 m above the ellipsoid, 1.5 m/s north, 2.25 m/s west, 0.125 m/s down, roll 2°, pitch −3°,
//! heading 271.5°.

use octant_instruments::FramingEvent;
use octant_instruments::navigation::{
    NavigationDecoder, NavigationProtocol, NavigationReading, NavigationTime,
};
use proptest::prelude::*;

const INSPVAS: &str = concat!(
    "aa441358fc01230828c9521623080000cdccccccf0db16410000000000a04a400000000000001ac00000000000205d400000",
    "00000000f83f00000000000002c0000000000000c0bf000000000000004000000000000008c00000000000f8704003000000",
    "b30e5744",
);
const INSPVA: &str = concat!(
    "aa44121cfb010020580000005ab4230828c95216000000000000000023080000cdccccccf0db16410000000000a04a400000",
    "000000001ac00000000000205d40000000000000f83f00000000000002c0000000000000c0bf000000000000004000000000",
    "000008c00000000000f8704003000000e1e55517",
);
const INSPVAX: &str = concat!(
    "aa44121cb90500207e0000005ab4230828c95216000000000000000007000000380000000000000000a04a40000000000000",
    "1ac00000000000a04e4000005d42000000000000f83f00000000000002c0000000000000c0bf000000000000004000000000",
    "000008c00000000000f870400000003f0000003f0000003f0000003f0000003f0000003f0000003f0000003f0000003f0000",
    "0000000055bff5c3",
);
const SBG_UTC: &str = "ff5a02001500e05ef8ff8700e407021d173b3b8017b42c00000000bb9233";
const SBG_NAV: &str = concat!(
    "ff5a0800480090d003000000c03f000010c00000003ecdcccc3dcdcccc3dcdcccc3d0000000000a04a400000000000001ac0",
    "0000000000a04e4000005d420000803f0000803f0000803ff400000057d433",
);
const SBG_EULER: &str =
    "ff5a0600200090d0030035fa0e3d507756bdfdb5c5bfcdcccc3dcdcccc3dcdcccc3df4000000847233";
const SBG_QUAT: &str =
    "ff5a0700240090d00300395d37bf84f3bc3b7d4ffd3c5176323fcdcccc3dcdcccc3dcdcccc3df4000000012833";
const SBG_NAV_INVALID: &str = concat!(
    "ff5a0800480090d003000000c03f000010c00000003ecdcccc3dcdcccc3dcdcccc3d0000000000a04a400000000000001ac0",
    "0000000000a04e4000005d420000803f0000803f0000803f040000007ca333",
);
const VN_COMMON: &str = concat!(
    "fa01cb1000f2052a01000000009a810e99087d1100c08743000040c0000000400000000000a04a400000000000001ac00000",
    "000000205d400000c03f000010c00000003e02003fe7",
);
const VN_LOST: &str = concat!(
    "fa01cb1000f2052a01000000009a810e99087d1100c08743000040c0000000400000000000a04a400000000000001ac00000",
    "000000205d400000c03f000010c00000003e03000cd6",
);
const VN_INS: &str = concat!(
    "fa3241020200130000f2052a0100000014021d173b3bee020700c08743000040c00000004002000000000000a04a40000000",
    "0000001ac00000000000205d400000c03f000010c00000003e1025",
);
const VN_NO_TIME: &str = concat!(
    "fa3241020200130000f2052a0100000014021d173b3bee020000c08743000040c00000004002000000000000a04a40000000",
    "0000001ac00000000000205d400000c03f000010c00000003edd5d",
);
const XS_ENU: &str = concat!(
    "faff364c10100c2cb4178007e4021d173b3b0750420c40000000003580000000fff9502206800000000074d0100cc0100000",
    "3fc00000be00000020300c400000004040000043328000e0200400000007b2",
);
const XS_NED: &str = concat!(
    "faff365e10100c2cb4178007e4021d173b3b07504310404aa00000000000c01a000000000000502308405d200000000000d0",
    "17183ff8000000000000c0020000000000003fc000000000000020340c40000000c0400000c2b10000e020040000000738",
);
const XS_ENU_Q: &str = concat!(
    "faff363210100c2cb4178007e4021d173b3b072013203f8bbad27a0dc507bf9a90a1cdc76f643f9236e49411dfae3feffb31",
    "f0f955bdf9",
);
const XS_NWU_Q: &str = concat!(
    "faff363210100c2cb4178007e4021d173b3b07201b20bfe6eba71e64ea2c3f779e707e8ba9debf9fa9efabc42fecbfe64eca",
    "1dc88476be",
);
const XS_INVALID: &str =
    "faff362910100c2cb4178007e4021d173b3b07504310404aa00000000000c01a000000000000e0200400000001b5";
const XS_OWN: &str = "faff361a1060040001e240504310404aa00000000000c01a00000000000073";

/// UTC whose leap seconds aren't known, and Xsens' status byte with the filter invalid, without and with a GNSS fix.
const SBG_UTC_WITHOUT_LEAP: &str = "ff5a02001500e05ef8ff4700e407021d173b3b8017b42c0000000037f633";
const XS_BYTE_INVALID: &str =
    "faff362610100c2cb4178007e4021d173b3b07504310404aa00000000000c01a000000000000e0100105c7";
const XS_BYTE_NO_FIX: &str =
    "faff362610100c2cb4178007e4021d173b3b07504310404aa00000000000c01a000000000000e0100103c9";
const XS_BYTE_FIX: &str =
    "faff362610100c2cb4178007e4021d173b3b07504310404aa00000000000c01a000000000000e0100107c5";

const ALL: [NavigationProtocol; 4] = [
    NavigationProtocol::Novatel,
    NavigationProtocol::Sbg,
    NavigationProtocol::VectorNav,
    NavigationProtocol::Xsens,
];
const WEEK_NS: u64 = 604_800_000_000_000;
/// 1 March 2020 in UTC, by Python's `datetime`.
const MARCH_NS: i64 = 1_583_020_800_000_000_000;

fn bytes(hex: &str) -> Vec<u8> {
    let digit = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(digit).collect()
}

/// Readings in bytes, taken in pieces of a length.
fn readings(protocol: NavigationProtocol, bytes: &[u8], piece: usize) -> Vec<NavigationReading> {
    let mut decoder = NavigationDecoder::new(protocol);
    let mut found = Vec::new();
    let mut take = |event| {
        if let FramingEvent::Reading(reading) = event {
            found.push(reading);
        }
    };
    for mut rest in bytes.chunks(piece) {
        while let Some(event) = decoder.next(&mut rest) {
            take(event);
        }
    }
    while let Some(event) = decoder.end() {
        take(event);
    }
    found
}

fn one(protocol: NavigationProtocol, hex: &str) -> NavigationReading {
    let found = readings(protocol, &bytes(hex), 7);
    assert_eq!(found.len(), 1, "{found:?}");
    found[0]
}

#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found}, expected {expected}");
}

/// Compares what is there with the one state; angles within the precision of a float.
#[track_caller]
fn is_the_state(reading: &NavigationReading) {
    if let Some(position) = reading.position_rad {
        near(position[0].to_degrees(), 53.25, 1e-8);
        near(position[1].to_degrees(), -6.5, 1e-8);
    }
    if let Some(height_m) = reading.height_m {
        near(height_m, 116.5, 1e-8);
    }
    if let Some(velocity) = reading.velocity_mps {
        assert_eq!(velocity, [1.5, -2.25, 0.125]);
    }
    if let Some([roll, pitch, heading]) = reading.attitude_rad {
        near(roll.to_degrees(), 2.0, 1e-5);
        near(pitch.to_degrees(), -3.0, 1e-5);
        near((heading.to_degrees() - 271.5 + 540.0).rem_euclid(360.0) - 180.0, 0.0, 2e-5);
    }
}

#[test]
fn lines_of_novatel_are_read() {
    // The manual's example of INSPVAX, and lines that users of receivers have published; their checksums are right.
    let manual = "#INSPVAXA,COM1,0,73.5,FINESTEERING,1695,309428.000,00000040,4e77,43562;INS_SOLUTION_GOOD,INS_PSRSP,\
                  51.11637873403,-114.03825114994,1063.6093,-16.9000,-0.0845,-0.0464,-0.0127,0.138023492,0.069459386,\
                  90.000923268,0.9428,0.6688,1.4746,0.0430,0.0518,0.0521,0.944295466,0.944567084,1.000131845,3,0*e877c178\r\n";
    let found = readings(NavigationProtocol::Novatel, manual.as_bytes(), 13);
    let [reading] = found[..] else { panic!("{found:?}") };
    assert_eq!(reading.time, NavigationTime::Gps(1695 * WEEK_NS + 309_428_000_000_000));
    let [latitude, longitude] = reading.position_rad.unwrap().map(f64::to_degrees);
    near(latitude, 51.11637873403, 1e-12);
    near(longitude, -114.03825114994, 1e-12);
    near(reading.height_m.unwrap(), 1063.6093 - 16.9, 1e-9);
    assert_eq!(reading.velocity_mps, Some([-0.0845, -0.0464, 0.0127]));
    let attitude = reading.attitude_rad.unwrap().map(f64::to_degrees);
    for (found, expected) in attitude.into_iter().zip([0.138023492, 0.069459386, 90.000923268]) {
        near(found, expected, 1e-12);
    }
    assert_eq!(reading.quality, Some("INS_SOLUTION_GOOD"));
    assert_eq!(reading.sigma.position_m, Some([0.9428, 0.6688, 1.4746]));
    assert_eq!(reading.sigma.velocity_mps, Some([0.0430, 0.0518, 0.0521]));
    near(reading.sigma.attitude_rad.unwrap()[2].to_degrees(), 1.000131845, 1e-12);
    let short = "%INSPVASA,2083,374524.200;2083,374524.200000000,31.51668826020,120.38636567293,13.9998,13.1095,-12.9404,\
                 -0.0070,2.093819658,2.854168081,316.626703726,INS_SOLUTION_GOOD*8fc5adb1\r\n";
    let found = readings(NavigationProtocol::Novatel, short.as_bytes(), 1);
    let [reading] = found[..] else { panic!("{found:?}") };
    assert_eq!(reading.time, NavigationTime::Gps(2083 * WEEK_NS + 374_524_200_000_000));
    assert_eq!(reading.height_m, Some(13.9998));
    assert_eq!(reading.velocity_mps, Some([13.1095, -12.9404, 0.0070]));
    // A log of another kind gives the same solution again, and is left out.
    let both = [short, manual, short].concat();
    assert_eq!(readings(NavigationProtocol::Novatel, both.as_bytes(), 64).len(), 2);
    // Another of the states in which there is a solution.
    let aligned = "#INSPVAXA,ICOM4,0,0.0,FINESTEERING,2107,35489.000,00000000,03de,68;INS_ALIGNMENT_COMPLETE,INS_RTKFIXED,\
                    28.23316396165,112.87713086609,82.7966,-17.0382,0.0020,-0.0191,0.0006,179.789714292,-0.387541550,\
                    1.405962922,0.0240,0.0168,0.0218,0.0047,0.0049,0.0054,0.0553,0.0553,1.0818,00000000,0*fd6e3a89\r\n";
    assert_eq!(readings(NavigationProtocol::Novatel, aligned.as_bytes(), 64).len(), 1);
}

#[test]
fn binary_logs_of_novatel_are_read() {
    for hex in [INSPVA, INSPVAS, INSPVAX] {
        let reading = one(NavigationProtocol::Novatel, hex);
        assert_eq!(reading.time, NavigationTime::Gps(2083 * WEEK_NS + 374_524_200_000_000));
        assert!(reading.position_rad.is_some() && reading.attitude_rad.is_some());
        assert!(reading.height_m.is_some() && reading.velocity_mps.is_some());
        is_the_state(&reading);
        let stated = if hex == INSPVAX { Some([0.5; 3]) } else { None };
        assert_eq!(reading.sigma.position_m, stated);
    }
    // The status before the solution is good: the same frame with another one has another checksum, so it is cut out here.
    let mut waiting = bytes(INSPVAS);
    let status = waiting.len() - 8;
    waiting[status] = 9;
    let crc = octant_instruments::checksum::novatel(&waiting[..status + 4]).to_le_bytes();
    waiting[status + 4..].copy_from_slice(&crc);
    let found = readings(NavigationProtocol::Novatel, &waiting, 7);
    assert!(found.len() == 1 && found[0].position_rad.is_none() && found[0].attitude_rad.is_none());
}

#[test]
fn sbg_tells_utc_across_the_roll_over_of_its_clock() {
    let all: Vec<u8> = [SBG_UTC, SBG_NAV, SBG_EULER, SBG_QUAT, SBG_NAV_INVALID]
        .iter()
        .flat_map(|hex| bytes(hex))
        .collect();
    let found = readings(NavigationProtocol::Sbg, &all, 5);
    let [position, euler, quaternion, invalid] = found[..] else { panic!("{found:?}") };
    assert!(invalid.position_rad.is_none() && invalid.velocity_mps.is_none());
    for reading in [position, euler, quaternion] {
        assert_eq!(reading.time, NavigationTime::Utc(MARCH_NS + 500_000_000));
        is_the_state(&reading);
    }
    assert!(position.position_rad.is_some() && position.velocity_mps.is_some());
    assert!(euler.attitude_rad.is_some() && quaternion.attitude_rad.is_some());
    // Without UTC the clock is the unit's own, and so without its leap seconds, up to 18 s of it.
    assert_eq!(one(NavigationProtocol::Sbg, SBG_NAV).time, NavigationTime::Own(250_000_000));
    let all = [SBG_UTC_WITHOUT_LEAP, SBG_NAV].map(bytes).concat();
    let found = readings(NavigationProtocol::Sbg, &all, 5);
    assert!(matches!(found[..], [NavigationReading { time: NavigationTime::Own(_), .. }]));
    assert_eq!(position.quality, Some("mode 4 (position, velocity, attitude and heading)"));
    for (sigma, expected) in [
        (position.sigma.position_m, 1.0),
        (position.sigma.velocity_mps, 0.1),
        (euler.sigma.attitude_rad, 0.1),
    ] {
        sigma.unwrap().iter().for_each(|sigma| near(*sigma, expected, 1e-7));
    }
}

#[test]
fn vectornav_is_read_from_both_groups() {
    let common = one(NavigationProtocol::VectorNav, VN_COMMON);
    assert_eq!(common.time, NavigationTime::Gps(2083 * WEEK_NS + 374_524_200_000_000));
    let ins = one(NavigationProtocol::VectorNav, VN_INS);
    assert_eq!(ins.time, NavigationTime::Utc(MARCH_NS - 250_000_000));
    for reading in [common, ins] {
        assert!(reading.position_rad.is_some() && reading.attitude_rad.is_some());
        assert!(reading.height_m.is_some() && reading.velocity_mps.is_some());
        is_the_state(&reading);
    }
    // Without GNSS for long, the position stands still, and counts for nothing.
    let lost = one(NavigationProtocol::VectorNav, VN_LOST);
    assert!(lost.position_rad.is_none() && lost.velocity_mps.is_none());
    assert!(lost.attitude_rad.is_some());
    // A UTC that the unit doesn't know.
    let own = one(NavigationProtocol::VectorNav, VN_NO_TIME);
    assert_eq!(own.time, NavigationTime::Own(5_000_000_000));
}

#[test]
fn xsens_is_read_in_all_axes_and_precisions() {
    for hex in [XS_ENU, XS_NED, XS_ENU_Q, XS_NWU_Q] {
        let reading = one(NavigationProtocol::Xsens, hex);
        assert_eq!(reading.time, NavigationTime::Utc(MARCH_NS - 250_000_000));
        assert!(reading.attitude_rad.is_some());
        is_the_state(&reading);
    }
    assert!(one(NavigationProtocol::Xsens, XS_ENU).height_m.is_some());
    assert!(one(NavigationProtocol::Xsens, XS_NED).velocity_mps.is_some());
    assert!(one(NavigationProtocol::Xsens, XS_INVALID).position_rad.is_none());
    assert!(one(NavigationProtocol::Xsens, XS_BYTE_INVALID).position_rad.is_none());
    let [without, with] =
        [XS_BYTE_NO_FIX, XS_BYTE_FIX].map(|hex| one(NavigationProtocol::Xsens, hex));
    assert!(without.position_rad.is_some() && without.quality == Some("no GNSS fix"));
    assert!(with.position_rad.is_some() && with.quality == Some("a GNSS fix"));
    let own = one(NavigationProtocol::Xsens, XS_OWN);
    assert_eq!(own.time, NavigationTime::Own(12_345_600_000));
    // A frame of a real unit, as a user published it: sample time and Euler angles, east, north, up.
    let real =
        one(NavigationProtocol::Xsens, "faff3616106004093a7cb720300cbf491a52bec36a10c32ee2ef3e");
    let [roll, pitch, heading] = real.attitude_rad.unwrap().map(f64::to_degrees);
    near(roll, -0.785_558_8, 1e-6);
    near(pitch, 0.381_668_6, 1e-6);
    near(heading, 90.0 + 174.886_459, 1e-5);
}

proptest! {
    /// Whatever comes.
    #[test]
    fn nothing_panics(noise in prop::collection::vec(any::<u8>(), 0..600), piece in 1_usize..64) {
        for protocol in ALL {
            readings(protocol, &noise, piece);
        }
    }

    #[test]
    fn a_changed_frame_is_none(at in 0_usize..1000, bit in 0_u8..8) {
        let frames = [
            (NavigationProtocol::Novatel, INSPVAX),
            (NavigationProtocol::Novatel, INSPVAS),
            (NavigationProtocol::Sbg, SBG_NAV),
            (NavigationProtocol::VectorNav, VN_COMMON),
            (NavigationProtocol::Xsens, XS_NED),
        ];
        for (protocol, hex) in frames {
            let mut frame = bytes(hex);
            let at = at % frame.len();
            frame[at] ^= 1 << bit;
            prop_assert_eq!(readings(protocol, &frame, 600), []);
        }
    }
}
