//! Parameters of the plant other than those of the sensors: random numbers, site, motion,
//! turntable, reference. Start values: an instrument at rest at 30.5 deg north.
//!
//! Names follow the keys of a scenario.

use super::enumerations as of;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Integer, Real};
use crate::table::{DeclaredVariable, concatenated, count, variables};
use octant_earth::units::{ARCSEC, DEG};

/// Largest number of sinusoids of each motion of a ship.
pub const SINUSOIDS_MAX: usize = 64;

/// Limit above which whole numbers are not exact as Real.
const EXACT_MAX: f64 = 9_007_199_254_740_992.0;

const RANDOM: [DeclaredVariable; 4] = variables! {
    parameter("random.seed", Count) within(0.0, EXACT_MAX) start(&[1.0]):
        "Seed of every random stream: the same seed gives the same noise.";
    parameter("random.seed_high", Count) within(0.0, u32::MAX as f64):
        "Upper 32 bits of the seed: 2^32 times this is added to random.seed, for seeds of 64 bits, \
         which a Real doesn't hold.";
    parameter("random.calibration.endless", Boolean):
        "All samples are of the calibration; else what follows random.calibration.samples is \
         navigation.";
    parameter("random.calibration.samples", Count) within(0.0, EXACT_MAX) start(&[2_880_000.0]):
        "Samples of the calibration. Random streams are counted by phase, calibration and \
         navigation, from its first sample; the reference comes during the calibration only.";
};

const SITE: [DeclaredVariable; 3] = variables! {
    parameter("site.latitude", Real) of(&q::ANGLE) within(-1.57, 1.57) nominal(1.0)
        start(&[30.5 * DEG]): "Geodetic latitude of the dock or the ground, north positive.";
    parameter("site.longitude", Real) of(&q::ANGLE) nominal(1.0) start(&[114.4 * DEG]):
        "Longitude of the dock or the ground, east positive.";
    parameter("site.height", Real) of(&q::LENGTH) within(-1e5, 1e5) nominal(100.0):
        "Height of the dock or the ground above the ellipsoid.";
};

const MOTION: [DeclaredVariable; 5] = variables! {
    parameter("motion.kind", Enumeration(&of::MOTION)): "How the case of the instrument moves.";
    parameter("motion.mean.heading", Real) of(&q::ANGLE) nominal(1.0):
        "Mean heading of the case. c_nc = Rz(heading) Ry(pitch) Rx(roll).";
    parameter("motion.mean.pitch", Real) of(&q::ANGLE) nominal(1.0): "Mean pitch of the case.";
    parameter("motion.mean.roll", Real) of(&q::ANGLE) nominal(1.0):
        "Mean roll of the case (not of the gimbal).";
    parameter("motion.mooring_offset", Real) elements(3) of(&q::LENGTH) within(-1e4, 1e4)
        nominal(1.0):
        "Dockside: constant offset of the instrument from the site, which the reference of the \
         dock's position measures; north, east, down.";
};

/// The sinusoids of one motion of the ship.
macro_rules! sinusoids {
    ($name:literal, $quantity:ident, $nominal:literal, $what:literal) => {
        variables! {
            parameter(concat!("motion.", $name, ".count"), Integer)
                within(0.0, SINUSOIDS_MAX as f64):
                concat!("Dockside: number of sinusoids of ", $what, ".");
            parameter(concat!("motion.", $name, ".amplitude"), Real) elements(SINUSOIDS_MAX)
                of(&q::$quantity) nominal($nominal):
                concat!("Dockside: amplitudes A of ", $what, ", A sin(2 pi t / period + phase); \
count of them are used.");
            parameter(concat!("motion.", $name, ".period"), Real) elements(SINUSOIDS_MAX)
                of(&q::TIME) within(0.01, 1e7) nominal(8.0) start(&[8.0]):
                concat!("Dockside: periods of ", $what, "; count of them are used.");
            parameter(concat!("motion.", $name, ".phase"), Real) elements(SINUSOIDS_MAX)
                of(&q::ANGLE) nominal(1.0):
                concat!("Dockside: phases of ", $what, " at time 0; count of them are used.");
        }
    };
}

const SWAY: [DeclaredVariable; 24] = concatenated(&[
    &sinusoids!("roll", ANGLE, 0.05, "the ship's roll"),
    &sinusoids!("pitch", ANGLE, 0.05, "the ship's pitch"),
    &sinusoids!("yaw", ANGLE, 0.05, "the ship's yaw"),
    &sinusoids!("surge", LENGTH, 0.2, "the ship's surge, along the mean heading"),
    &sinusoids!("sway", LENGTH, 0.2, "the ship's sway, to starboard of the mean heading"),
    &sinusoids!("heave", LENGTH, 0.2, "the ship's heave, positive down"),
]);

const TURNTABLE: [DeclaredVariable; 5] = variables! {
    parameter("turntable.rate", Real) of(&q::TURN_RATE) within(0.0, 100.0) nominal(10.0 * DEG)
        start(&[10.0 * DEG]): "Largest rate of a gimbal's move, above 0.";
    parameter("turntable.acceleration", Real) of(&q::ANGULAR_ACCELERATION) min(0.0)
        nominal(10.0 * DEG) start(&[10.0 * DEG]): "Acceleration of a gimbal's move, above 0.";
    parameter("turntable.encoder_sigma", Real) of(&q::SMALL_ANGLE) min(0.0) nominal(18.0 * ARCSEC)
        start(&[18.0 * ARCSEC]):
        "Encoder error, root mean square over a turn: a periodic curve of each gimbal, four \
         harmonics drawn from the seed. It is no white noise.";
    parameter("turntable.non_orthogonality", Real) of(&q::SMALL_ANGLE)
        within(-10.0 * DEG, 10.0 * DEG) nominal(1e-4):
        "Angle eta by which the gimbal axes miss a right angle: c_cb = Rx(roll) Ry(eta) \
         Rz(azimuth).";
    parameter("turntable.backlash", Real) of(&q::SMALL_ANGLE) min(0.0) nominal(1e-4):
        "Play of each gear: the body lags its drive by half of it, on the side it came from. The \
         encoders sit on the drives and don't see it.";
};

const REFERENCE: [DeclaredVariable; 5] = variables! {
    parameter("aiding.reference", Enumeration(&of::AIDING)):
        "What the reference of the calibration measures.";
    tunable_parameter("aiding.velocity_sigma", Real) of(&q::SMALL_VELOCITY) min(0.0) nominal(1e-3)
        start(&[1e-3]): "Reference of velocity: standard deviation of its noise, each axis.";
    tunable_parameter("aiding.position_sigma", Real) of(&q::LENGTH) min(0.0) nominal(0.01) start(&[0.01]):
        "Reference of position: standard deviation of its noise, each axis.";
    parameter("aiding.period_ns", Count) of(&q::NANOSECONDS) within(1.0, EXACT_MAX) start(&[1e9]):
        "Period of the reference, ns: a multiple of imu.period_ns.";
    tunable_parameter("truth.enabled", Boolean) start(&[1.0]):
        "The outputs of truth are computed in every step; else they stay as they are at the start.";
};

const PARTS: &[&[DeclaredVariable]] = &[&RANDOM, &SITE, &MOTION, &SWAY, &TURNTABLE, &REFERENCE];

pub(super) const PARAMETERS: [DeclaredVariable; count(PARTS)] = concatenated(PARTS);
