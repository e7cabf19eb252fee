//! Size of a count, by the kind of unit.
//!
//! Values from the table "Raw IMU Scale Factors" of the receiver's documentation (OEM7, log
//! `RAWIMUSX`), in the units given there. Units whose entry is ambiguous (KVH 1750 and KVH COTS: 0.1 /
//! (3600 · 256) of an unnamed unit) are left out: their scale has to be
//! given ([`super::NovAtel::scale`]).

use core::f64::consts::PI;

/// Size of one count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountScale {
    /// Rotation, rad.
    pub rotation_rad: f64,
    /// Velocity, m/s.
    pub velocity_mps: f64,
}

const DEGREE_RAD: f64 = PI / 180.0;
const FOOT_M: f64 = 0.3048;
const G_MPS2: f64 = 9.806_65;

const fn two_to_minus(power: u32) -> f64 {
    1.0 / (1u64 << power) as f64
}

/// Scale of Epson's units, whose counts are rates in 16.16 bits: degrees a second and mg, at a rate in
/// Hz.
const fn epson(degrees_per_s: f64, milli_g: f64, rate_hz: f64) -> CountScale {
    CountScale {
        rotation_rad: degrees_per_s / 65536.0 / rate_hz * DEGREE_RAD,
        velocity_mps: milli_g / 65536.0 * (G_MPS2 / 1000.0) / rate_hz,
    }
}

/// Scale of a kind of unit, by its number in the log; `None`: not in the table.
#[must_use]
pub const fn scale_of(kind: u8) -> Option<CountScale> {
    match kind {
        // HG1700-AG11, HG1900-CA29, HG1700-AG58, HG1930-AA99, HG1900-CA50, HG1930-CA50.
        1 | 5 | 11 | 20 | 27 | 28 => both(two_to_minus(33), two_to_minus(27) * FOOT_M),
        // HG1700-AG17, HG1700-AG62.
        4 | 12 => both(two_to_minus(33), two_to_minus(26) * FOOT_M),
        // LN-200.
        8 => both(two_to_minus(19), two_to_minus(14)),
        // iMAR FSAS: 0.1·2⁻⁸ arcsec.
        13 => both(0.1 * two_to_minus(8) / 3600.0 * DEGREE_RAD, 0.05 * two_to_minus(15)),
        // ISA-100C, Litef µIMU.
        26 | 52 => both(1.0e-9, 2.0e-8),
        // ADIS16488: 720·2⁻³¹ °.
        31 => both(720.0 * two_to_minus(31) * DEGREE_RAD, 200.0 * two_to_minus(31)),
        // STIM300, STIM300D.
        32 | 56 => both(two_to_minus(21) * DEGREE_RAD, two_to_minus(22)),
        // Epson G320 at 125 Hz, G370 at 200 Hz, G320 at 200 Hz.
        41 => Some(epson(0.008, 0.2, 125.0)),
        61 => Some(epson(0.015_151_5, 0.4, 200.0)),
        62 => Some(epson(0.008, 0.2, 200.0)),
        // HG4930: AN01, AN04, AN04 at 400 Hz.
        58 | 68 | 69 => both(two_to_minus(33), two_to_minus(29)),
        _ => None,
    }
}

const fn both(rotation_rad: f64, velocity_mps: f64) -> Option<CountScale> {
    Some(CountScale { rotation_rad, velocity_mps })
}
