//! Bits of CAN frames compared with frames built bit by bit, with their CRC and their stuff bits; and
//! the capacity of a bus.

use octant_wire::can::{Bits, Bus, CanVersion, Slot, classic_bits, fd_bits};
use octant_wire::traffic::Traffic;
use octant_wire::{EndRole, MessageKind};
use proptest::prelude::*;

/// Lowest `count` bits of a number, highest first.
fn bits(value: u32, count: u32) -> impl Iterator<Item = bool> {
    (0..count).rev().map(move |i| value >> i & 1 == 1)
}

/// Counts the stuff bits, one after each five equal bits, before and after `at`.
fn stuffed(bits: &[bool], at: usize) -> (u32, u32) {
    let (mut last, mut run, mut before, mut after) = (!bits[0], 0, 0, 0);
    for (i, bit) in bits.iter().enumerate() {
        if *bit == last {
            run += 1;
        } else {
            last = *bit;
            run = 1;
        }
        if run == 5 {
            if i < at {
                before += 1
            } else {
                after += 1
            }
            last = !last;
            run = 1;
        }
    }
    (before, after)
}

/// CRC of a frame by ISO 11898-1, bit by bit.
fn crc(bits: &[bool], polynomial: u32, width: u32) -> u32 {
    let top = 1 << (width - 1);
    bits.iter().fold(0, |crc, bit| {
        let turn = *bit != (crc & top != 0);
        ((crc << 1) & ((top << 1) - 1)) ^ if turn { polynomial } else { 0 }
    })
}

/// Counts the bits of a classic frame with intermission.
fn classic(id: u16, data: &[u8]) -> Bits {
    let mut all = vec![false];
    all.extend(bits(id.into(), 11));
    all.extend([false, false, false]);
    all.extend(bits(data.len() as u32, 4));
    all.extend(data.iter().flat_map(|byte| bits((*byte).into(), 8)));
    all.extend(bits(crc(&all, 0x4599, 15), 15));
    let (stuff, _) = stuffed(&all, all.len());
    Bits { nominal: all.len() as u32 + stuff + 1 + 2 + 7 + 3, data: 0 }
}

/// Counts the bits of an FD frame with intermission.
fn fd(id: u16, data: &[u8]) -> Bits {
    let code = match data.len() {
        length @ 0..=8 => length,
        12 => 9,
        16 => 10,
        20 => 11,
        24 => 12,
        32 => 13,
        48 => 14,
        _ => 15,
    };
    let mut all = vec![false];
    all.extend(bits(id.into(), 11));
    // Bits RRS, IDE, FDF, res, BRS; then ESI.
    all.extend([false, false, true, false, true]);
    let arbitration = all.len();
    all.push(false);
    all.extend(bits(code as u32, 4));
    all.extend(data.iter().flat_map(|byte| bits((*byte).into(), 8)));
    let (before, after) = stuffed(&all, arbitration);
    let crc_field = if data.len() <= 16 { 4 + 17 } else { 4 + 21 };
    // One fixed stuff bit at the beginning, and one after each four bits.
    let fixed = 1 + crc_field / 4;
    Bits {
        nominal: arbitration as u32 + before + 1 + 2 + 7 + 3,
        data: (all.len() - arbitration) as u32 + after + crc_field + fixed,
    }
}

/// Most stuff bits of a classic frame with this identifier, over all data and with any CRC: the search
/// follows every run that a bit can leave.
fn worst_classic(id: u16, bytes: usize) -> u32 {
    let mut known: Vec<Option<bool>> = vec![Some(false)];
    known.extend(bits(id.into(), 11).map(Some));
    known.extend([Some(false); 3]);
    known.extend(bits(bytes as u32, 4).map(Some));
    known.extend(vec![None; 8 * bytes + 15]);
    // Best count by last bit and length of its run.
    let mut best = [[None::<u32>; 5]; 2];
    best[1][0] = Some(0);
    let mut first = true;
    for bit in known.iter().copied() {
        let mut next = [[None::<u32>; 5]; 2];
        for last in [false, true] {
            for run in 1..=4usize {
                let from = if first { best[1][0] } else { best[usize::from(last)][run] };
                let Some(count) = from else { continue };
                for value in [false, true] {
                    if bit.is_some_and(|bit| bit != value) {
                        continue;
                    }
                    let run = if !first && value == last { run + 1 } else { 1 };
                    let (at, run, count) =
                        if run == 5 { (!value, 1, count + 1) } else { (value, run, count) };
                    let place = &mut next[usize::from(at)][run];
                    *place = Some(place.map_or(count, |known| known.max(count)));
                }
            }
        }
        best = next;
        first = false;
    }
    best.iter().flatten().flatten().copied().max().unwrap() + known.len() as u32 + 13
}

proptest! {
    #[test]
    fn no_classic_frame_is_longer_than_its_worst_case(
        id in 0..0x800u16,
        data in proptest::collection::vec(prop_oneof![any::<u8>(), Just(0), Just(0xFF), Just(0xF0), Just(0x0F), Just(0x78), Just(0x87), Just(0xC3), Just(0x3C), Just(0xE1), Just(0x1E)], 0..9),
    ) {
        prop_assert!(classic(id, &data).nominal <= classic_bits(data.len()).nominal);
    }

    #[test]
    fn no_fd_frame_is_longer_than_its_worst_case(
        id in 0..0x800u16,
        length in prop::sample::select(&[0usize, 1, 5, 8, 12, 16, 20, 24, 32, 48, 64][..]),
        fill in prop::sample::select(&[0u8, 0xFF, 0xF0, 0x0F, 0x78, 0x87, 0xC3, 0x3C, 0xE1, 0x1E, 0x55][..]),
        random in proptest::option::of(any::<[u8; 64]>()),
    ) {
        let data = random.unwrap_or([fill; 64]);
        let (found, worst) = (fd(id, &data[..length]), fd_bits(length));
        prop_assert!(found.nominal <= worst.nominal);
        // A run that continues from the arbitration can put one stuff bit more into the data than the
        // worst case has, but then there is one less before.
        prop_assert!(found.nominal + found.data <= worst.nominal + worst.data);
        prop_assert!(found.data <= worst.data + (worst.nominal - found.nominal));
        for bus in [Bus::fd(500_000, 2_000_000), Bus::fd(1_000_000, 1_000_000), Bus::fd(500_000, 8_000_000)] {
            prop_assert!(found.seconds(bus) <= worst.seconds(bus));
        }
    }
}

#[test]
fn known_frames_have_known_lengths() {
    // Figure of the literature for 11-bit identifiers: 8 bytes make 135 bits with intermission.
    assert_eq!(classic_bits(8).nominal, 135);
    assert_eq!(classic_bits(0).nominal, 55);
    // By hand: 0x555 alternates, so that a frame without data has stuff bits in its control field and
    // CRC only.
    let frame = classic(0x555, &[]);
    assert!((47..=50).contains(&frame.nominal), "{frame:?}");
    // CAN FD by hand: 64 bytes make at most 22 + 512 bits with 133 stuff bits, 25 + 7 of CRC, 13.
    let worst = fd_bits(64);
    assert_eq!(worst.nominal + worst.data, 22 + 512 + 133 + 25 + 7 + 13);
    assert_eq!(worst.nominal, 17 + 4 + 13);
    // 16 bytes have the shorter CRC: 17 + 4, with 6 fixed stuff bits.
    let worst = fd_bits(16);
    assert_eq!(worst.nominal + worst.data, 22 + 128 + 37 + 21 + 6 + 13);
}

#[test]
fn the_worst_case_is_nearly_reached_by_our_identifiers() {
    // The bound ignores that the 19 bits before the data are fixed. Data and CRC, the 79 bits after
    // them, can always have 19 of the 24 stuff bits of 8 bytes.
    for slot in Slot::ALL {
        for segment in 0..slot.segments(CanVersion::Classic) {
            let bytes = slot.frame_bytes(segment, CanVersion::Classic);
            let worst = worst_classic(slot.id(segment, CanVersion::Classic), bytes);
            let bound = classic_bits(bytes).nominal;
            assert!((bound - 5..=bound).contains(&worst), "{slot:?} {segment}: {worst}, {bound}");
        }
    }
}

#[test]
fn a_check_value_of_the_frame_crc() {
    // CRC-15/CAN of "123456789", from the catalogue of CRC parameters.
    let check: Vec<bool> = b"123456789".iter().flat_map(|byte| bits((*byte).into(), 8)).collect();
    assert_eq!(crc(&check, 0x4599, 15), 0x059E);
}

#[test]
fn samples_at_200_hz_are_38_percent_of_500_kbit() {
    let bus = Bus::classic(500_000);
    let load = bus.load(&Traffic::samples(200.0));
    assert_eq!(load.frames_per_s, 1400.0, "seven frames a sample");
    // 7 · 135 · 200 / 500000.
    assert!((load.share() - 0.378).abs() < 1e-12, "{load:?}");
    assert_eq!(format!("{:.0} %", 100.0 * load.share()), "38 %");
    assert_eq!((load.from_harness, load.to_harness), (load.share(), 0.0));
}

#[test]
fn a_bus_that_is_too_slow_says_what_it_carries() {
    let session = Traffic::session(200.0);
    let overload = Bus::classic(500_000).carry(&session, 0.9).unwrap_err();
    assert_eq!(
        overload.to_string(),
        "classic CAN at 500 kbit/s can't carry 200 samples a second: in the worst case that is \
         133.6 % of the bus (38.7 % there, 94.9 % back), 90 % are allowed; it carries 132 a second"
    );
    // The sample rate reported is the highest that fits.
    let less = |hz| {
        Bus::classic(500_000).carry(&Traffic { samples_hz: hz, outputs_hz: hz, ..session }, 0.9)
    };
    assert!(less(overload.fits_hz - 1e-6).is_ok());
    assert!(less(overload.fits_hz + 1e-6).is_err());

    assert!(Bus::classic(1_000_000).carry(&session, 0.9).is_ok());
    assert!(Bus::fd(500_000, 2_000_000).carry(&session, 0.9).is_ok());
    let fast = Traffic::session(1000.0);
    assert!(Bus::fd(500_000, 2_000_000).carry(&fast, 0.9).is_err());
    assert!(Bus::fd(1_000_000, 8_000_000).carry(&fast, 0.9).is_ok());
    let hopeless = Bus::classic(10_000).carry(&session, 0.9).unwrap_err();
    assert!(hopeless.to_string().ends_with("it doesn't carry what goes beside the samples either"));
}

#[test]
fn the_load_is_the_sum_of_its_messages() {
    let bus = Bus::fd(500_000, 2_000_000);
    let output = Slot::of(EndRole::Device, MessageKind::Output, 0).unwrap();
    let bits = [fd_bits(64), fd_bits(64), fd_bits(8)];
    let seconds: f64 = bits.iter().map(|bits| bits.seconds(bus)).sum();
    assert_eq!(bus.seconds(output), seconds);
    let traffic = Traffic { outputs_hz: 100.0, ..Traffic::default() };
    let load = bus.load(&traffic);
    assert!((load.to_harness - 100.0 * seconds).abs() < 1e-15);
    assert_eq!(load.frames_per_s, 300.0);
    // Parameters count with all six segments.
    let traffic = Traffic { parameters_hz: 1.0, ..Traffic::default() };
    assert_eq!(Bus::classic(500_000).load(&traffic).frames_per_s, 72.0);
}
