//! Screens and gates.

use super::field::{no_item, optional, put_optional, whole};
use crate::calibrator::error::CalibratorValueError;
use crate::calibrator::table::slot;
use crate::values::CellValues;
use octant_calibration::config::{Base, BaseMotion, Gate, Recovery, Screening};

pub(super) fn put(screening: &Screening, values: &mut CellValues) {
    let Screening {
        gate,
        stuck_samples,
        jumps,
        bridging,
        gimbals,
        drift_sigmas,
        checkpoints,
        aiding_stamps,
        base,
        encoder_sigma_rad,
        resolution,
        vibration,
    } = screening;
    values.set_boolean(slot::GATE, gate.is_some());
    if let Some(Gate { nis, rejections, recovery }) = *gate {
        values.set_real(slot::GATE_NIS, nis);
        values.set_count(slot::GATE_REJECTIONS, rejections.into());
        let choice = match recovery {
            Recovery::Widening => 0,
            Recovery::Reset { attitude_rad, velocity_mps, position_m } => {
                values.set_real(slot::RESET_ATTITUDE, attitude_rad);
                values.set_real(slot::RESET_VELOCITY, velocity_mps);
                values.set_real(slot::RESET_POSITION, position_m);
                1
            }
        };
        values.set_integer(slot::GATE_RECOVERY, choice);
    }
    values.set_boolean(slot::STUCK, stuck_samples.is_some());
    if let Some(samples) = *stuck_samples {
        values.set_count(slot::STUCK_SAMPLES, samples.into());
    }
    values.set_boolean(slot::JUMPS, *jumps);
    values.set_boolean(slot::BRIDGING, *bridging);
    values.set_boolean(slot::GIMBALS, *gimbals);
    put_optional(*drift_sigmas, slot::DRIFT, slot::DRIFT_SIGMAS, values);
    values.set_boolean(slot::CHECKPOINTS, *checkpoints);
    values.set_boolean(slot::AIDING_STAMPS, *aiding_stamps);
    let choice = match *base {
        Base::Still => 0,
        Base::Moving(motion) => {
            let BaseMotion { angle_rad, rate_radps, acceleration_radps2, force_mps2, jerk_mps3 } =
                motion;
            values.set_real(slot::BASE_ANGLE, angle_rad);
            values.set_real(slot::BASE_RATE, rate_radps);
            values.set_real(slot::BASE_ACCELERATION, acceleration_radps2);
            values.set_real(slot::BASE_FORCE, force_mps2);
            values.set_real(slot::BASE_JERK, jerk_mps3);
            1
        }
    };
    values.set_integer(slot::BASE, choice);
    values.set_real(slot::ENCODER_SIGMA, *encoder_sigma_rad);
    values.set_real(slot::RESOLUTION_GYRO, resolution.0);
    values.set_real(slot::RESOLUTION_ACCELEROMETER, resolution.1);
    values.set_real(slot::VIBRATION_GYRO, vibration.0);
    values.set_real(slot::VIBRATION_ACCELEROMETER, vibration.1);
}

pub(super) fn get(values: &CellValues) -> Result<Screening, CalibratorValueError> {
    let gate = || {
        Ok::<_, CalibratorValueError>(Gate {
            nis: values.real(slot::GATE_NIS),
            rejections: whole(slot::GATE_REJECTIONS, values)?,
            recovery: match values.integer(slot::GATE_RECOVERY) {
                0 => Recovery::Widening,
                1 => Recovery::Reset {
                    attitude_rad: values.real(slot::RESET_ATTITUDE),
                    velocity_mps: values.real(slot::RESET_VELOCITY),
                    position_m: values.real(slot::RESET_POSITION),
                },
                _ => return Err(no_item(slot::GATE_RECOVERY, values)),
            },
        })
    };
    Ok(Screening {
        gate: values.boolean(slot::GATE).then(gate).transpose()?,
        stuck_samples: values
            .boolean(slot::STUCK)
            .then(|| whole(slot::STUCK_SAMPLES, values))
            .transpose()?,
        jumps: values.boolean(slot::JUMPS),
        bridging: values.boolean(slot::BRIDGING),
        gimbals: values.boolean(slot::GIMBALS),
        drift_sigmas: optional(slot::DRIFT, slot::DRIFT_SIGMAS, values),
        checkpoints: values.boolean(slot::CHECKPOINTS),
        aiding_stamps: values.boolean(slot::AIDING_STAMPS),
        base: match values.integer(slot::BASE) {
            0 => Base::Still,
            1 => Base::Moving(BaseMotion {
                angle_rad: values.real(slot::BASE_ANGLE),
                rate_radps: values.real(slot::BASE_RATE),
                acceleration_radps2: values.real(slot::BASE_ACCELERATION),
                force_mps2: values.real(slot::BASE_FORCE),
                jerk_mps3: values.real(slot::BASE_JERK),
            }),
            _ => return Err(no_item(slot::BASE, values)),
        },
        encoder_sigma_rad: values.real(slot::ENCODER_SIGMA),
        resolution: (
            values.real(slot::RESOLUTION_GYRO),
            values.real(slot::RESOLUTION_ACCELEROMETER),
        ),
        vibration: (values.real(slot::VIBRATION_GYRO), values.real(slot::VIBRATION_ACCELEROMETER)),
    })
}
