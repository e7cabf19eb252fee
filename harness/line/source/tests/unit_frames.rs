//! Frames of a unit that the test writes itself, and the samples that they have to become.

use octant_sample::{GimbalCommand, Sample};
use octant_source::{Epoch, LiveSource, Source, SourceError};

pub(super) const PERIOD_NS: u64 = 5_000_000;
/// Bytes of a frame.
pub(super) const FRAME: usize = 42;

/// Frame of VectorNav's binary output, written by the table of its manual UM001: sync, the common group with the fields
/// TimeStartup and DeltaTheta, and CRC-16 of all after the sync.
pub(super) fn frame(number: u64) -> Vec<u8> {
    let mut bytes = vec![0x01];
    bytes.extend(((1_u16 << 0) | (1 << 11)).to_le_bytes());
    bytes.extend((number * PERIOD_NS).to_le_bytes());
    let k = number as f32;
    for value in [0.005, 1e-3 * k, -2e-4, 3e-5 * k, 1e-3 * k, -0.02, -0.049] {
        bytes.extend(f32::to_le_bytes(value));
    }
    let crc = bytes.iter().fold(0_u16, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
            if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 }
        })
    });
    bytes.extend(crc.to_be_bytes());
    bytes.insert(0, 0xFA);
    assert_eq!(bytes.len(), FRAME);
    bytes
}

/// Samples until the silence, and the error that it is.
pub(super) fn all(source: &mut LiveSource) -> (Vec<Sample>, String) {
    let mut found = Vec::new();
    let mut epoch = Epoch::default();
    loop {
        match source.next(&GimbalCommand::default(), &mut epoch) {
            Ok(_) => found.push(epoch.sample),
            Err(error @ SourceError::Gone { .. }) => return (found, error.to_string()),
            Err(error) => panic!("{error}"),
        }
    }
}

/// Checks that samples are those of these frames.
pub(super) fn check(found: &[Sample], numbers: &[u64]) {
    let first = numbers[0];
    let times: Vec<u64> = numbers.iter().map(|k| (k - first + 1) * PERIOD_NS).collect();
    assert_eq!(found.iter().map(|sample| sample.device_time.ns).collect::<Vec<_>>(), times);
    // Counts carry what rounding left: their sums are those of the increments.
    let (mut counted, mut sent) = ([0.0; 2], [0.0; 2]);
    for (sample, k) in found.iter().zip(numbers) {
        counted[0] += f64::from(sample.delta_theta[0]) * 2f64.powi(-36);
        counted[1] += f64::from(sample.delta_velocity[0]) * 2f64.powi(-30);
        sent[0] += f64::from(1e-3 * *k as f32).to_radians();
        sent[1] += f64::from(1e-3 * *k as f32);
        assert!((counted[0] - sent[0]).abs() < 2f64.powi(-36), "{k}");
        assert!((counted[1] - sent[1]).abs() < 2f64.powi(-30), "{k}");
    }
}
