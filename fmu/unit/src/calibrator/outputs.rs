//! Outputs of the core as values.

use super::table::slot;
use crate::values::CellValues;
use octant_calibration::Core;
use octant_sample::Output;

/// Writes the outputs that change with every sample.
#[inline]
pub(super) fn put(output: &Output, values: &mut CellValues) {
    let target = output.gimbal_command.target;
    values.set_real(slot::COMMAND_AZIMUTH, target.azimuth_rad());
    values.set_real(slot::COMMAND_ROLL, target.roll_rad());
    values.set_integer(slot::MODE, output.mode as i32);
    values.set_integer(slot::STOP, i32::from(output.stop));
    values.set_boolean(slot::MOVING, output.moving);
    let navigation = &output.navigation;
    values.set_real(slot::LATITUDE, navigation.latitude_rad);
    values.set_real(slot::LONGITUDE, navigation.longitude_rad);
    values.set_real(slot::HEIGHT, navigation.height_m);
    values.set_reals(slot::VELOCITY, &navigation.velocity_mps);
    values.set_reals(slot::ATTITUDE, &navigation.q_nb);
    let measured = !output.nis.is_nan();
    values.set_real(slot::NIS, if measured { output.nis } else { 0.0 });
    values.set_boolean(slot::MEASURED, measured);
    values.set_integer(slot::HEALTH, output.health.bits() as i32);
    values.set_count(slot::ANSWER_SEQUENCE, output.sequence);
    values.set_count(slot::ANSWER_DEVICE_TIME, output.device_time.ns);
    values.set_count(slot::REVISION, output.parameters_revision.into());
}

/// Writes the estimated parameters and their standard deviations.
pub(super) fn put_parameters(core: &Core, values: &mut CellValues) {
    values.set_reals(slot::PARAMETERS, &core.parameters().to_array());
    values.set_reals(slot::SIGMA, core.sigma());
}
