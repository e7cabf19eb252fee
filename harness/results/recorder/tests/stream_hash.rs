//! The stream hash is BLAKE3 of the canonical bytes.

use octant_recorder::StreamHash;
use octant_sample::canonical::{self, AIDING_BYTES, OUTPUT_BYTES, SAMPLE_BYTES};
use octant_sample::{Aiding, DeviceTime, Output, Reference, Sample};

#[test]
fn the_hash_is_blake3_of_the_canonical_bytes_in_order() {
    let mut hash = StreamHash::new();
    let mut bytes = Vec::new();
    for k in 1..5000u64 {
        let sample = Sample { sequence: k, delta_theta: [k as i32, -1, 7], ..Default::default() };
        let output = Output { sequence: k, nis: f64::NAN, ..Default::default() };
        let aiding = (k % 200 == 0).then_some(Aiding {
            device_time: DeviceTime::from_ns(k),
            reference: Reference::Velocity([1.0, -0.0, f64::INFINITY]),
        });
        hash.epoch(&sample, aiding.as_ref(), &output);
        let mut b = [0; SAMPLE_BYTES];
        canonical::sample(&sample, &mut b);
        bytes.extend_from_slice(&b);
        if let Some(aiding) = aiding {
            let mut b = [0; AIDING_BYTES];
            canonical::aiding(&aiding, &mut b);
            bytes.extend_from_slice(&b);
        }
        let mut b = [0; OUTPUT_BYTES];
        canonical::output(&output, &mut b);
        bytes.extend_from_slice(&b);
    }
    assert_eq!(hash.hex(), blake3::hash(&bytes).to_hex().to_string());
}
