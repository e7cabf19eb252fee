//! Effects of a scenario that no prediction has.

use octant_sample::further::FurtherGroup;
use octant_scenario::{MotionSpec, ParameterDistribution, Scenario};

/// Lists the effects of a scenario that are not in the prediction.
pub(super) fn not_modelled(scenario: &Scenario) -> Vec<String> {
    let extensions = &scenario.imu.extensions;
    let even = scenario.parameters.iter().any(|d| matches!(d, ParameterDistribution::Uniform(_)));
    let spectrum =
        matches!(&scenario.motion, MotionSpec::Dockside(ship) if ship.spectrum.is_some());
    let dockside = matches!(scenario.motion, MotionSpec::Dockside(_));
    let quantized =
        extensions.gyro_quantization_rad > 0.0 || extensions.accel_quantization_mps > 0.0;
    let mounted = scenario.turntable.errors.mounting_rad != [0.0; 3]
        || scenario.further[FurtherGroup::GimbalMounting as usize].is_some();
    let all: [(bool, &str); 12] = [
        (true, "nonlinear effects: products of errors, and screens and gates that reject samples"),
        (
            even,
            "the shape of uniform draws: only their variance counts, and percentiles are those of normal errors",
        ),
        (
            scenario.turntable.encoder_sigma_rad != 0.0,
            "errors of the encoders: the filter doesn't use their angles",
        ),
        (mounted, "the mounting of the body on the inner gimbal"),
        (quantized, "quantization"),
        (extensions.vibration.is_some(), "vibration"),
        (extensions.time_skew_s != 0.0, "the time skew of the inertial unit"),
        (scenario.turntable.backlash_rad != 0.0, "backlash of the gears"),
        (dockside, "the ship's roll, pitch and yaw: only the displacement of its motion enters"),
        (
            spectrum,
            "the draw of the periods of the ship's spectrum: those of the scenario's seed stand for all",
        ),
        (!scenario.faults.is_empty(), "the scenario's faults"),
        (
            !scenario.endpoint.is_in_process(),
            "the core at endpoint.uri: the built-in core stands for it",
        ),
    ];
    let named = all.into_iter().filter(|(there, _)| *there);
    named.map(|(_, what)| what.to_owned()).collect()
}
