//! Start of the unit under test from a wrong calibration.

use super::power::Once;
use crate::catalogue::{Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{FaultRule, UnitEvent};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Parameters;

pub(super) static STALE_TABLE: FaultKind = FaultKind {
    name: "stale-table",
    family: Family::Unit,
    acts: Acts::Unit,
    summary: "The unit under test starts anew from a stored calibration that is out of date.",
    model: "At its onset the unit under test starts anew, as at `restart`, but from other \
            parameters than those that its scenario gives it:\n\n\
            \u{20}   parameters' = parameters + offset\n\n\
            for biases, scale factor errors and the diagonal of the g-dependent bias, axis by \
            axis; the others are as in the scenario. Parameters are coefficients of the error \
            (measured − true), which compensation subtracts: a gyro bias offset of +0.01 °/h makes \
            every compensated rate too small by 0.01 °/h. The prior uncertainty of the filter stays \
            what it is: with offsets of a few σ a calibration finds its way back, beyond that it is \
            told a lie about its own knowledge. A navigation without calibration has nothing to \
            find them with.\n\n\
            With a trigger at the first sample the run starts so: instruments age, and a table that \
            was made at another temperature, before a repair or for another instrument is such a \
            one. The epoch counts as altered in which the unit started.",
    parameters: &[
        FaultParameter {
            name: "gyro_bias",
            takes: Takes::Vector(&[Dimension::GyroBias]),
            default: Some(r#"["0 deg/h", "0 deg/h", "0 deg/h"]"#),
            doc: "Offset of the stored gyro biases, x, y, z.",
        },
        FaultParameter {
            name: "gyro_scale",
            takes: Takes::Vector(&[Dimension::Ratio]),
            default: Some(r#"["0 ppm", "0 ppm", "0 ppm"]"#),
            doc: "Offset of the stored gyro scale factor errors, x, y, z.",
        },
        FaultParameter {
            name: "g_dependent",
            takes: Takes::Vector(&[Dimension::GDependent]),
            default: Some(r#"["0 deg/h/g", "0 deg/h/g", "0 deg/h/g"]"#),
            doc: "Offset of the stored g-dependent gyro biases G_xx, G_yy, G_zz.",
        },
        FaultParameter {
            name: "accel_bias",
            takes: Takes::Vector(&[Dimension::AccelBias]),
            default: Some(r#"["0 ug", "0 ug", "0 ug"]"#),
            doc: "Offset of the stored accelerometer biases, x, y, z.",
        },
        FaultParameter {
            name: "accel_scale",
            takes: Takes::Vector(&[Dimension::Ratio]),
            default: Some(r#"["0 ppm", "0 ppm", "0 ppm"]"#),
            doc: "Offset of the stored accelerometer scale factor errors, x, y, z.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[
        ("gyro_bias", r#"["0.01 deg/h", "0 deg/h", "0 deg/h"]"#),
        ("accel_bias", r#"["200 ug", "0 ug", "0 ug"]"#),
    ]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let [xx, yy, zz] = values.vector("g_dependent")?;
    let offset = Parameters {
        gyro_bias: values.vector("gyro_bias")?,
        gyro_scale: values.vector("gyro_scale")?,
        g_dependent: [xx, 0.0, 0.0, 0.0, yy, 0.0, 0.0, 0.0, zz],
        accel_bias: values.vector("accel_bias")?,
        accel_scale: values.vector("accel_scale")?,
        ..Parameters::default()
    };
    if offset == Parameters::default() {
        let problem = "every offset is 0: the table would be the right one, at least one other \
                       than 0 is expected";
        return Err(FaultBuildError::value("gyro_bias", problem));
    }
    let event = UnitEvent::RestartWith { offset };
    Ok(FaultRule::Unit(Box::new(Once { event })))
}
