//! Random numbers and draws.

use super::numbers::Found;
use octant_plant::draw::{ParameterDraws, alignment_error, parameters, phases};
use octant_plant::sea::Spectrum;
use octant_random::philox::{StreamKey, block};
use octant_random::stream::{Ahead, Triad};
use octant_sample::parameters::ParameterGroup;
use std::hint::black_box;

/// Test vectors of Random123: key and counter.
const VECTORS: [(&str, StreamKey, [u64; 4]); 3] = [
    ("zeros", [0; 2], [0; 4]),
    ("ones", [u64::MAX; 2], [u64::MAX; 4]),
    (
        "pi",
        [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
        [
            0x243f_6a88_85a3_08d3,
            0x1319_8a2e_0370_7344,
            0xa409_3822_299f_31d0,
            0x082e_fa98_ec4e_6c89,
        ],
    ),
];

pub(super) fn found() -> Found {
    let mut all = Found::new();
    for (name, key, counter) in black_box(VECTORS) {
        for (place, word) in block(key, counter).into_iter().enumerate() {
            all.insert(format!("philox {name} high {place}"), (word >> 32) as f64);
            all.insert(format!("philox {name} low {place}"), f64::from(word as u32));
        }
    }
    normals(&mut all);
    let seed = black_box(7);
    let instrument = parameters(seed, &black_box(ParameterDraws::table_1())).to_array();
    for group in ParameterGroup::ALL {
        for (i, at) in group.range().enumerate() {
            all.insert(format!("{} {i}", group.name()), instrument[at]);
        }
    }
    let alignment = alignment_error(seed, 1e-4, 2e-3, 0.02);
    for axis in 0..3 {
        all.insert(format!("alignment phi {axis}"), alignment.phi_rad[axis]);
        all.insert(format!("alignment velocity {axis}"), alignment.velocity_mps[axis]);
    }
    for (i, phase) in phases(seed, "roll", 4).into_iter().enumerate() {
        all.insert(format!("phase {i}"), phase);
    }
    for (name, spectrum) in black_box([
        ("1.0", Spectrum::pierson_moskowitz(2.0, 8.0)),
        ("3.3", Spectrum::jonswap(2.0, 8.0, 3.3)),
    ]) {
        for (i, one) in spectrum.components(seed, "heave", 16).into_iter().enumerate() {
            all.insert(format!("sea {name} amplitude {i}"), one.amplitude);
            all.insert(format!("sea {name} period {i}"), one.period_s);
        }
    }
    all
}

/// Collects normal numbers of each phase, including those of the tail and of wedges, as their names
/// say.
fn normals(all: &mut Found) {
    let triad = Triad::new(black_box(3), "gyro.noise");
    let mut ahead = Ahead::new(triad.clone());
    for known in super::numbers::known("draws") {
        let Some(place) = known.name.strip_prefix("normal calibration ") else { continue };
        let mut numbers = place.split(' ').map(str::parse::<u64>);
        if let (Some(Ok(sample)), Some(Ok(lane))) = (numbers.next(), numbers.next()) {
            all.insert(known.name.clone(), ahead.at(sample)[lane as usize % 3]);
        }
    }
    ahead.navigate();
    for sample in 0..4 {
        for (lane, value) in ahead.at(sample).into_iter().enumerate() {
            all.insert(format!("normal navigation {sample} {lane}"), value);
        }
    }
    for (lane, value) in triad.initial().into_iter().enumerate() {
        all.insert(format!("normal draw 0 {lane}"), value);
    }
}
