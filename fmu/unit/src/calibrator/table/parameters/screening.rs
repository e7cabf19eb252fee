//! Parameters of screens and gates. Start values: all screens on.

use crate::calibrator::table::enumerations as of;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Real};
use crate::table::{DeclaredVariable, variables};
use octant_calibration::config::{Base, Gate, Screening};
use octant_earth::units::ARCSEC;

/// Source of the start values of the screens.
const HARDENED: Screening = Screening::hardened(Base::Still);
const HARDENED_GATE: Gate = HARDENED.gate.expect("it has a gate");
const HARDENED_STUCK_SAMPLES: u32 = HARDENED.stuck_samples.expect("it has a test");
const HARDENED_DRIFT_SIGMAS: f64 = HARDENED.drift_sigmas.expect("it has a limit");

pub(super) const GATE: [DeclaredVariable; 7] = variables! {
    tunable_parameter("screening.gate.enabled", Boolean) start(&[1.0]):
        "Innovations are gated; else every measurement is used.";
    tunable_parameter("screening.gate.nis", Real) min(0.0) nominal(36.0) start(&[HARDENED_GATE.nis]):
        "Gate: normalized innovation squared (three axes) above which a measurement is rejected, \
         above 0.";
    tunable_parameter("screening.gate.rejections", Count) within(0.0, u32::MAX as f64)
        start(&[HARDENED_GATE.rejections as f64]):
        "Gate: rejections in a row that start a recovery.";
    tunable_parameter("screening.gate.recovery", Enumeration(&of::RECOVERY)): "Gate: what a recovery does.";
    tunable_parameter("screening.gate.reset_attitude", Real) of(&q::SMALL_ANGLE) min(0.0)
        nominal(600.0 * ARCSEC) start(&[600.0 * ARCSEC]):
        "Gate, recovery by reset: standard deviation of attitude.";
    tunable_parameter("screening.gate.reset_velocity", Real) of(&q::VELOCITY) min(0.0) nominal(1.0)
        start(&[1.0]): "Gate, recovery by reset: standard deviation of velocity.";
    tunable_parameter("screening.gate.reset_position", Real) of(&q::LENGTH) min(0.0) nominal(10.0)
        start(&[10.0]): "Gate, recovery by reset: standard deviation of position.";
};

pub(super) const SCREENS: [DeclaredVariable; 9] = variables! {
    parameter("screening.stuck.enabled", Boolean) start(&[1.0]):
        "Channels that give identical counts are flagged as stuck.";
    parameter("screening.stuck.samples", Count) within(0.0, u32::MAX as f64)
        start(&[HARDENED_STUCK_SAMPLES as f64]):
        "Identical counts in a row that make a channel stuck, at least 2.";
    parameter("screening.jumps", Boolean) start(&[1.0]):
        "Samples that jump as no motion of turntable and base can are not believed.";
    parameter("screening.bridging", Boolean) start(&[1.0]):
        "Samples that are missing, invalid, stuck or not believed are bridged by what is known of \
         the motion; else they are used as they are.";
    parameter("screening.gimbals", Boolean) start(&[1.0]):
        "Turns by gyros and by encoders are compared, and encoders with the set point.";
    parameter("screening.drift.enabled", Boolean) start(&[1.0]):
        "A calibration whose parameters drift is refused.";
    tunable_parameter("screening.drift.sigmas", Real) min(0.0) nominal(6.0) start(&[HARDENED_DRIFT_SIGMAS]):
        "Correction of a parameter over a stretch of the calibration, in the standard deviations \
         that it should have, above which it drifts; above 0.";
    parameter("screening.checkpoints", Boolean) start(&[1.0]):
        "A recovery goes back to the parameters of one to two minutes before it.";
    tunable_parameter("screening.aiding_stamps", Boolean) start(&[1.0]):
        "A reference that doesn't carry the stamp of its sample is not used.";
};

macro_rules! bounds {
    ($($name:literal $quantity:ident $nominal:expr, $start:expr, $text:literal;)*) => {
        variables! {$(
            parameter(concat!("screening.", $name), Real) of(&q::$quantity) min(0.0)
                nominal($nominal) start(&[$start]): $text;
        )*}
    };
}

pub(super) const BASE: [DeclaredVariable; 1] = variables! {
    parameter("screening.base.kind", Enumeration(&of::BASE)):
        "What the instrument's case stands on: the limits of the screens follow from it.";
};

pub(super) const BOUNDS: [DeclaredVariable; 10] = bounds! {
    "base.angle" ANGLE 0.1, 0.0, "Moving base: largest angle from the mean attitude.";
    "base.rate" TURN_RATE 0.1, 0.0, "Moving base: largest angular rate.";
    "base.acceleration" ANGULAR_ACCELERATION 0.1, 0.0, "Moving base: largest angular acceleration.";
    "base.force" ACCELERATION 1.0, 0.0, "Moving base: largest acceleration of the instrument.";
    "base.jerk" JERK 1.0, 0.0, "Moving base: largest rate of change of that acceleration.";
    "encoder_sigma" SMALL_ANGLE 18.0 * ARCSEC, HARDENED.encoder_sigma_rad,
        "Standard deviation of a gimbal angle as the encoders give it.";
    "resolution.delta_theta" ANGLE_INCREMENT 1e-9, HARDENED.resolution.0,
        "Coarsest step of an angle increment, beyond that of the counts; 0: none.";
    "resolution.delta_velocity" VELOCITY_INCREMENT 1e-6, HARDENED.resolution.1,
        "Coarsest step of a velocity increment, beyond that of the counts; 0: none.";
    "vibration.delta_theta" ANGLE_INCREMENT 1e-6, HARDENED.vibration.0,
        "Largest change of an angle increment from sample to sample by vibration.";
    "vibration.delta_velocity" VELOCITY_INCREMENT 1e-3, HARDENED.vibration.1,
        "Largest change of a velocity increment from sample to sample by vibration.";
};
