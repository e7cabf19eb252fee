//! Motion and environment.

mod lever_arm;
mod moored;
mod shock;
mod temperature;
mod vibration_random;
mod vibration_sine;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &vibration_sine::VIBRATION_SINE,
    &vibration_random::VIBRATION_RANDOM,
    &shock::SHOCK,
    &lever_arm::LEVER_ARM,
    &temperature::TEMPERATURE_RAMP,
    &moored::MOORING_JERK,
    &moored::SWAY,
];
