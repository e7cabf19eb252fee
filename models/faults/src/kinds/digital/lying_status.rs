//! Flags that are wrong.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;
use octant_sample::imu::Status;

pub(super) static LYING_STATUS: FaultKind = FaultKind {
    name: "lying-status",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "A status flag is set or cleared, whatever is true.",
    model: "While it lasts the flag of every sample is set (a false alarm: good data that claims \
            to be bad) or cleared (a missed alarm: bad data that claims to be good). Counts, gimbal \
            angles, stamps and the other flags aren't altered. A sample whose flag already stands \
            there isn't altered: clearing a flag shows only where something sets it, an earlier \
            fault for example, so place this one after it.",
    parameters: &[
        FaultParameter {
            name: "flag",
            takes: Takes::Choice(&[
                ("gyro-saturated", "a gyro count saturated"),
                ("accelerometer-saturated", "an accelerometer count saturated"),
                ("gimbal-invalid", "the gimbal angles are not to be used"),
                ("inertial-invalid", "the inertial counts are not to be used"),
            ]),
            default: None,
            doc: "The flag that lies.",
        },
        FaultParameter {
            name: "becomes",
            takes: Takes::Choice(&[
                ("set", "the flag says that something is wrong"),
                ("cleared", "the flag says that nothing is wrong"),
            ]),
            default: Some("set"),
            doc: "What becomes of the flag.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("flag", r#""inertial-invalid""#), ("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let flag = match values.choice("flag")? {
        "gyro-saturated" => Status::GYRO_SATURATED,
        "accelerometer-saturated" => Status::ACCELEROMETER_SATURATED,
        "gimbal-invalid" => Status::GIMBAL_INVALID,
        _ => Status::INERTIAL_INVALID,
    };
    let set = values.choice("becomes")? == "set";
    Ok(FaultRule::Samples(Box::new(LyingStatus { flag, set })))
}

#[derive(Clone, Debug)]
struct LyingStatus {
    flag: Status,
    set: bool,
}

octant_state::state! { LyingStatus { values: ; parts: ; kept: flag, set } }

impl SampleRule for LyingStatus {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        epoch.sample.status.set(self.flag, self.set);
    }
}
