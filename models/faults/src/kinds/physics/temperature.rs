//! Temperature.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::fixed;
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use octant_sample::disturbance::Disturbance;

pub(super) static TEMPERATURE_RAMP: FaultKind = FaultKind {
    name: "temperature-ramp",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "Temperature departs along a ramp, and biases and scale factors with it.",
    model: "With t since the onset the temperature departs by\n\n\
            \u{20}   ΔT = q t up to the plateau P, and stays there\n\n\
            and when the fault ends it returns to where it was at the same rate. With the mean ΔT of \
            an interval the gyros and accelerometers of each axis read in addition\n\n\
            \u{20}   ΔT (b_gT dt + s_gT Δθ)      ΔT (b_aT dt + s_aT Δv)\n\n\
            with the true increments Δθ and Δv of the axis, before noise, ranges and counting. It \
            is added to a temperature that the instrument is configured with. Once it is back the \
            increments are those of the plant without the fault, and counts differ by at most \
            one.\n\n\
            Sensitivities are of first order; real ones have hysteresis and react to the gradient \
            too (Shupe effect of fibre gyros), which a ramp-rate bias, `bias-step`, can stand for. \
            IEEE Std 952-2020 and IEEE Std 1293-2018 define the coefficients.",
    parameters: &[
        FaultParameter {
            name: "ramp",
            takes: Takes::Quantity(&[Dimension::TemperatureRate], ParameterBounds::NotZero),
            default: None,
            doc: "Rate q, negative for cooling.",
        },
        FaultParameter {
            name: "plateau",
            takes: Takes::Quantity(&[Dimension::Temperature], ParameterBounds::NotZero),
            default: None,
            doc: "Change P at which the ramp ends, of the sign of the ramp.",
        },
        FaultParameter {
            name: "gyro_bias",
            takes: Takes::Vector(&[Dimension::GyroBiasPerK]),
            default: Some(r#"["0 deg/h/K", "0 deg/h/K", "0 deg/h/K"]"#),
            doc: "Sensitivity b_gT of the gyro biases, x, y and z.",
        },
        FaultParameter {
            name: "accelerometer_bias",
            takes: Takes::Vector(&[Dimension::AccelBiasPerK]),
            default: Some(r#"["0 ug/K", "0 ug/K", "0 ug/K"]"#),
            doc: "Sensitivity b_aT of the accelerometer biases, x, y and z.",
        },
        FaultParameter {
            name: "gyro_scale",
            takes: Takes::Vector(&[Dimension::ScalePerK]),
            default: Some(r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#),
            doc: "Sensitivity s_gT of the gyro scale factors, x, y and z.",
        },
        FaultParameter {
            name: "accelerometer_scale",
            takes: Takes::Vector(&[Dimension::ScalePerK]),
            default: Some(r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#),
            doc: "Sensitivity s_aT of the accelerometer scale factors, x, y and z.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("ramp", r#""0.5 K/s""#),
        ("plateau", r#""4 K""#),
        ("accelerometer_bias", r#"["20 ug/K", "0 ug/K", "0 ug/K"]"#),
        ("duration", r#""10 s""#),
    ]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let ramp_kps = values.quantity("ramp")?;
    let plateau_k = values.quantity("plateau")?;
    if (ramp_kps < 0.0) != (plateau_k < 0.0) {
        let problem = "its sign is not that of the ramp, which would never reach it";
        return Err(FaultBuildError::value("plateau", problem));
    }
    let gyro_bias_per_k = values.vector("gyro_bias")?;
    let accel_bias_per_k = values.vector("accelerometer_bias")?;
    let gyro_scale_per_k = values.vector("gyro_scale")?;
    let accel_scale_per_k = values.vector("accelerometer_scale")?;
    let all = [gyro_bias_per_k, accel_bias_per_k, gyro_scale_per_k, accel_scale_per_k];
    if all == [[0.0; 3]; 4] {
        let problem = "all sensitivities are zero, at least one that isn't is expected";
        return Err(FaultBuildError::value("gyro_bias", problem));
    }
    Ok(fixed(Disturbance::Temperature {
        ramp_kps,
        plateau_k,
        gyro_bias_per_k,
        accel_bias_per_k,
        gyro_scale_per_k,
        accel_scale_per_k,
    }))
}
