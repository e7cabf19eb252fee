//! Messages of a step: sample and aiding, output, end and restart.

use super::kind::MessageKind;
use super::step::StepNumber;
use crate::Unreadable;
use crate::bytes::{Reader, Writer};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, Sample,
};

/// A sample to step on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleMessage {
    /// Number of the step.
    pub step: StepNumber,
    /// True if an aiding message of the same step was sent just before.
    pub aided: bool,
    /// The sample.
    pub sample: Sample,
}

impl SampleMessage {
    #[inline]
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        let sample = &self.sample;
        w.u16(self.step.with_flag(self.aided));
        w.u16(sample.status.bits());
        w.u64(sample.sequence);
        w.u64(sample.device_time.ns);
        for count in sample.delta_theta.iter().chain(&sample.delta_velocity) {
            w.i32(*count);
        }
        w.i32(sample.gimbal.azimuth);
        w.i32(sample.gimbal.roll);
    }

    #[inline]
    pub(super) fn read(r: &mut Reader<'_>) -> Self {
        let (step, aided) = StepNumber::and_flag(r.u16());
        let status = octant_sample::Status::from_bits_retain(r.u16());
        let sample = Sample {
            sequence: r.u64(),
            device_time: DeviceTime { ns: r.u64() },
            delta_theta: r.array(Reader::i32),
            delta_velocity: r.array(Reader::i32),
            gimbal: GimbalAngles { azimuth: r.i32(), roll: r.i32() },
            status,
        };
        Self { step, aided, sample }
    }
}

/// Reference of a step, sent before its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AidingMessage {
    /// Number of the step.
    pub step: StepNumber,
    /// Reference with its timestamp.
    pub aiding: Aiding,
}

impl AidingMessage {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        let (kind, values) = match self.aiding.reference {
            Reference::Velocity(velocity) => (0, velocity),
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                (1, [latitude_rad, longitude_rad, height_m])
            }
        };
        w.u16(self.step.number());
        w.u8(kind);
        w.u8(0);
        w.u64(self.aiding.device_time.ns);
        for value in values {
            w.f64(value);
        }
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let step = StepNumber::new(r.u16());
        let [reference, _] = r.take();
        let device_time = DeviceTime { ns: r.u64() };
        let [first, second, third] = r.array(Reader::f64);
        let reference = match reference {
            0 => Reference::Velocity([first, second, third]),
            1 => {
                Reference::Position { latitude_rad: first, longitude_rad: second, height_m: third }
            }
            found => {
                return Err(Unreadable::Value {
                    kind: MessageKind::Aiding,
                    field: "reference",
                    found: found.into(),
                    expected: "0 (velocity) or 1 (position)",
                });
            }
        };
        Ok(Self { step, aiding: Aiding { device_time, reference } })
    }
}

/// Answer of the core.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputMessage {
    /// Number of the step answered.
    pub step: StepNumber,
    /// True if the parameters changed; all of their segments follow.
    pub parameters_follow: bool,
    /// The output.
    pub output: Output,
    /// Computing time of the core, ns; 0: not measured. It is no part of the result.
    pub computing_ns: u32,
}

impl OutputMessage {
    #[inline]
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        let output = &self.output;
        w.u16(self.step.with_flag(self.parameters_follow));
        w.u16(output.stop);
        w.u64(output.sequence);
        w.u64(output.device_time.ns);
        w.u8(output.mode as u8);
        w.u8(u8::from(output.moving));
        w.u16(0);
        w.u32(output.health.bits());
        w.i32(output.gimbal_command.target.azimuth);
        w.i32(output.gimbal_command.target.roll);
        w.u32(output.parameters_revision);
        w.u32(self.computing_ns);
        let navigation = &output.navigation;
        w.f64(navigation.latitude_rad);
        w.f64(navigation.longitude_rad);
        w.f64(navigation.height_m);
        for value in navigation.velocity_mps.iter().chain(&navigation.q_nb) {
            w.f64(*value);
        }
        w.f64(output.nis);
    }

    #[inline]
    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let wrong = |field, found: u8, expected| {
            let found = found.into();
            Unreadable::Value { kind: MessageKind::Output, field, found, expected }
        };
        let (step, parameters_follow) = StepNumber::and_flag(r.u16());
        let stop = r.u16();
        let sequence = r.u64();
        let device_time = DeviceTime { ns: r.u64() };
        let [mode, moving, _, _] = r.take();
        let mode =
            *Mode::ALL.get(usize::from(mode)).ok_or_else(|| wrong("mode", mode, "0 to 4"))?;
        let moving = match moving {
            0 => false,
            1 => true,
            found => return Err(wrong("moving", found, "0 or 1")),
        };
        let health = Health::from_bits_retain(r.u32());
        let target = GimbalAngles { azimuth: r.i32(), roll: r.i32() };
        let parameters_revision = r.u32();
        let computing_ns = r.u32();
        let navigation = Navigation {
            latitude_rad: r.f64(),
            longitude_rad: r.f64(),
            height_m: r.f64(),
            velocity_mps: r.array(Reader::f64),
            q_nb: r.array(Reader::f64),
        };
        let output = Output {
            sequence,
            device_time,
            mode,
            stop,
            moving,
            gimbal_command: GimbalCommand { target },
            navigation,
            health,
            nis: r.f64(),
            parameters_revision,
        };
        Ok(Self { step, parameters_follow, output, computing_ns })
    }
}

/// Request to restart the core as at power on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Restart {
    /// Number of the step.
    pub step: StepNumber,
    /// Difference of the stored parameters from the configured ones, SI; `None`: none.
    pub offset: Option<Parameters>,
}

impl Restart {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.step.with_flag(self.offset.is_some()));
        w.u16(0);
        for value in self.offset.unwrap_or_default().to_array() {
            w.f64(value);
        }
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Self {
        let (step, offset) = StepNumber::and_flag(r.u16());
        r.u16();
        let values: [f64; PARAMETER_COUNT] = r.array(Reader::f64);
        Self { step, offset: offset.then(|| Parameters::from_array(&values)) }
    }
}

/// Notice that no sample follows: the core concludes and answers with its last output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct End {
    /// Number of the step.
    pub step: StepNumber,
}

/// Answer to a [`Restart`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ready {
    /// Number of the step answered.
    pub step: StepNumber,
}
