//! References that are wrong.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::{Value, Values};
use alloc::boxed::Box;
use core::f64::consts::FRAC_PI_2;
use octant_earth::ellipsoid::Ellipsoid;
use octant_sample::{Epoch, Reference};

pub(super) static AIDING_WRONG: FaultKind = FaultKind {
    name: "aiding-wrong",
    family: Family::Aiding,
    acts: Acts::Samples,
    summary: "The reference gives a wrong velocity or a wrong position.",
    model: "While it lasts, every aiding message is off by a constant e in n (north, east, down), \
            which fades in its recovery (s: 1, then down to 0). Of a velocity, where `error` is \
            one:\n\n\
            \u{20}   v' = v + s e\n\n\
            and of a position, where `error` is a length:\n\n\
            \u{20}   latitude'  = latitude + s e_N / (R_M + h)          not beyond a pole\n\
            \u{20}   longitude' = longitude + s e_E / ((R_N + h) cos latitude)\n\
            \u{20}   height'    = height − s e_D\n\n\
            with the radii of curvature of WGS-84 at the message's own latitude and height h. \
            Stamps and samples are untouched. Messages of the other sort are untouched too: an \
            error in metres does nothing to a velocity reference, and its receipt says so.\n\n\
            A real reference is so wrong when its datum or its lever arm is, when the ship creeps \
            along the quay, or when it is spoofed. A filter whose gate the error passes takes it \
            for accelerometer and attitude errors; a constant position error mostly shifts the \
            position.",
    parameters: &[FaultParameter {
        name: "error",
        takes: Takes::Vector(&[Dimension::Velocity, Dimension::Length]),
        default: None,
        doc: "Error of the reference, north, east, down: a velocity or a length.",
    }],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("error", r#"["5 mm/s", "0 mm/s", "0 mm/s"]"#),
        ("duration", r#""10 s""#),
    ]),
    build: build_wrong,
};

fn build_wrong(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Samples(Box::new(AidingWrong { error: Offset::of(values, "error")? })))
}

#[derive(Clone, Debug)]
struct AidingWrong {
    error: Offset,
}

octant_state::state! { AidingWrong { values: ; parts: ; kept: error } }

impl SampleRule for AidingWrong {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        self.error.add(epoch, [now.strength; 3]);
    }
}

pub(super) static POSITION_JUMP: FaultKind = FaultKind {
    name: "position-jump",
    family: Family::Aiding,
    acts: Acts::Samples,
    summary: "The reference's position jumps, once or again and again, and stays there.",
    model: "At its onset the position that the reference gives jumps, and from there on, to the end \
            of the run, every one is off by it; each further onset adds another jump:\n\n\
            \u{20}   latitude'  = latitude + n j_N / (R_M + h)      n: onsets so far\n\
            \u{20}   longitude' = longitude + n j_E / ((R_N + h) cos latitude)\n\
            \u{20}   height'    = height − n j_D\n\n\
            with the radii of curvature of WGS-84 at the message's own latitude and height h. \
            Stamps, samples and velocity references are untouched. A satellite receiver does this \
            when it changes its satellites or its corrections, a survey when it changes its \
            datum.\n\n\
            A jump that is taken back, or fades, is `aiding-wrong` with a length.",
    parameters: &[FaultParameter {
        name: "jump",
        takes: Takes::Vector(&[Dimension::Length]),
        default: None,
        doc: "Height of the jump, north, east, down.",
    }],
    lasts: Lasts::Instant,
    example: Example::of(&[("jump", r#"["0 m", "5 m", "0 m"]"#)]),
    build: build_jump,
};

fn build_jump(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let jump = Offset::of(values, "jump")?;
    Ok(FaultRule::Samples(Box::new(PositionJump { jump, jumps: 0 })))
}

#[derive(Clone, Debug)]
struct PositionJump {
    jump: Offset,
    jumps: u32,
}

octant_state::state! { PositionJump { values: jumps; parts: ; kept: jump } }

impl SampleRule for PositionJump {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.jumps = self.jumps.saturating_add(1);
        }
        self.afterwards(epoch, now);
    }

    fn lingers(&self) -> bool {
        self.jumps > 0
    }

    fn afterwards(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        self.jump.add(epoch, [f64::from(self.jumps); 3]);
    }
}

pub(super) static AIDING_NOISE: FaultKind = FaultKind {
    name: "aiding-noise",
    family: Family::Aiding,
    acts: Acts::Samples,
    summary: "The reference is noisier than the core was told.",
    model: "While it lasts, every aiding message gets white noise in n on top of what it has, which \
            fades in its recovery (s: 1, then down to 0):\n\n\
            \u{20}   v' = v + s sigma n      n: three standard normal numbers, new for each message\n\n\
            or, where `sigma` is a length, a position is displaced by s sigma n (north, east, down) \
            with the radii of curvature of WGS-84. The noise of the reference and this one add in \
            squares: σ'² = σ² + s² sigma². Messages of the other sort, stamps and samples are \
            untouched.\n\n\
            With a filter tuned to σ the mean NIS of three axes goes from 3 to about 3 σ'²/σ² \
            where the reference's noise dominates the innovation.",
    parameters: &[FaultParameter {
        name: "sigma",
        takes: Takes::Quantity(
            &[Dimension::Velocity, Dimension::Length],
            ParameterBounds::Positive,
        ),
        default: None,
        doc: "Standard deviation of the noise on each axis: a velocity or a length.",
    }],
    lasts: Lasts::Fading,
    example: Example::of(&[("sigma", r#""5 mm/s""#), ("duration", r#""10 s""#)]),
    build: build_noise,
};

fn build_noise(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let (sigma, dimension) = values.quantity_and_dimension("sigma")?;
    let sigma = Offset { error: [sigma; 3], dimension };
    Ok(FaultRule::Samples(Box::new(AidingNoise { sigma, stream: setup.stream("noise") })))
}

#[derive(Clone, Debug)]
struct AidingNoise {
    sigma: Offset,
    stream: Stream,
}

octant_state::state! { AidingNoise { values: ; parts: ; kept: sigma, stream } }

impl SampleRule for AidingNoise {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if epoch.aiding.is_some() {
            self.sigma.add(epoch, now.normals(&self.stream).map(|normal| now.strength * normal));
        }
    }
}

/// An error of a reference in n: north, east, down.
#[derive(Clone, Copy, Debug)]
struct Offset {
    /// Error, m/s or m.
    error: [f64; 3],
    dimension: Dimension,
}

impl Offset {
    fn of(values: &Values, name: &'static str) -> Result<Self, FaultBuildError> {
        let Some(Value::Vector(error, dimension)) = values.get(name) else {
            return Err(FaultBuildError::missing(name));
        };
        if error == [0.0; 3] {
            let problem = "0 on all axes: the reference would be right, another value is expected";
            return Err(FaultBuildError::value(name, problem));
        }
        Ok(Self { error, dimension })
    }

    /// Adds the error, times a factor for each axis, to aiding of the same dimension.
    fn add(&self, epoch: &mut Epoch, factors: [f64; 3]) {
        let Some(aiding) = &mut epoch.aiding else { return };
        let error: [f64; 3] = core::array::from_fn(|axis| factors[axis] * self.error[axis]);
        match (&mut aiding.reference, self.dimension) {
            (Reference::Velocity(velocity), Dimension::Velocity) => {
                for axis in 0..3 {
                    velocity[axis] += error[axis];
                }
            }
            (Reference::Position { latitude_rad, longitude_rad, height_m }, Dimension::Length) => {
                let earth = Ellipsoid::at(*latitude_rad, *height_m);
                let (north, east) = earth.position_rate(&error.into());
                *latitude_rad = (*latitude_rad + north).clamp(-FRAC_PI_2, FRAC_PI_2);
                *longitude_rad += east;
                *height_m -= error[2];
            }
            _ => {}
        }
    }
}
