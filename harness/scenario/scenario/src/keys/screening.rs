//! Keys of the screening.

use super::by_case::DRIFTS;
use super::definition::{Bounds, Kind};
use super::table::{Keys, Of, choice, integer, keys, number, or_text, si};
use crate::quantity::UnitDimension;

keys! {
    /// `[screening]`.
    pub(crate) struct ScreeningKeys {
        gate: Option<GateKeys>
            = or_text!("off", "every measurement is used", Kind::Table(GateKeys::SECTION)), "{}",
            "Innovation gate.";
        stuck_samples: Option<u32> = or_text!("off", "no test", Kind::Integer(2, 1_000_000)), "8",
            "Identical counts in a row that make a channel stuck.";
        jumps: bool = on_off(), "on",
            "Samples that jump as no motion of turntable and base can are not believed.";
        bridging: bool = on_off(), "on",
            "Samples missing, invalid, stuck or not believed are bridged by what is known of the motion; \
             off: used as they are.";
        gimbals: bool = on_off(), "on",
            "Turns by gyros and by encoders are compared, and encoders with the set point.";
        drift: Option<f64> = or_text!("off", "no test", Kind::Number(Bounds::Positive)),
            by_case(DRIFTS),
            "Correction of a parameter over a stretch of the calibration, in its standard deviations, \
             above which the calibration is refused.";
        checkpoints: bool = on_off(), "on",
            "A recovery goes back to the parameters of one to two minutes before it.";
        aiding_stamps: bool = on_off(), "on",
            "Aiding that doesn't carry the stamp of its sample is not used.";
    }
}

pub(super) const fn on_off() -> Of<bool> {
    choice! { "on" => true, "done"; "off" => false, "not done"; }
}

keys! {
    /// `[screening.gate]`.
    pub(crate) struct GateKeys {
        nis: f64 = number(Bounds::Positive), "36.0",
            "Normalized innovation squared (three axes) above which a measurement is rejected.";
        rejections: u32 = integer(1, 1_000_000), "5", "Rejections in a row that start a recovery.";
        recovery: Option<ResetKeys> = or_text!(
                "widening",
                "attitude, velocity, position re-open as wide as the innovation says",
                Kind::Table(ResetKeys::SECTION)
            ), "widening",
            "What a recovery does: widening, or a reset to given standard deviations.";
    }
}

keys! {
    /// `[screening.gate.recovery]`.
    pub(crate) struct ResetKeys {
        attitude: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::Positive), "600 arcsec",
            "Attitude after a reset.";
        velocity: f64 = si(&[UnitDimension::VELOCITY], Bounds::Positive), "1 m/s",
            "Velocity after a reset.";
        position: f64 = si(&[UnitDimension::LENGTH], Bounds::Positive), "10 m",
            "Position after a reset.";
    }
}
