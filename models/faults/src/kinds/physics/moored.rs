//! Motions of the whole case that the core doesn't expect: a jerk of the mooring, and sway.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::{EDGE, angular, fixed, not_nothing, within};
use crate::rule::{Context, FaultRule, PlantRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::format;
use alloc::vec::Vec;
use octant_random::normal::{uniform, words};
use octant_sample::disturbance::{Disturbance, Motor, SpectralLine};

pub(super) static MOORING_JERK: FaultKind = FaultKind {
    name: "mooring-jerk",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "The whole case is displaced and turned once, and comes back: a jerk of the mooring.",
    model: "With t since the onset the case is displaced along its mean heading, to starboard and \
            down, and turned in roll, pitch and heading, by\n\n\
            \u{20}   64 u³(1−u)³ times displacement and turn      u = t/L, 0 ≤ u ≤ 1\n\n\
            in addition to the configured motion. In its middle it is there in full; velocity and \
            acceleration are zero at both ends. The largest velocity is 3.43/L and the largest \
            acceleration 24/L² of the displacement. Rate and specific force follow from the \
            displaced position on the ellipsoid, with Coriolis, transport rate, and gravity at the \
            height; truth is displaced too.\n\n\
            Aiding of the kind zero velocity, and dock position, know nothing of it: they go on \
            saying that the ship is where it is. Aiding of the kind velocity gives the true one.\n\n\
            It is over after L, whatever the fault's end; increments are then those of the plant \
            without the fault, and counts differ by at most one. A real line that snaps leaves the \
            ship in another place: give the displacement a length of minutes.",
    parameters: &[
        FaultParameter {
            name: "displacement",
            takes: Takes::Vector(&[Dimension::Length]),
            default: Some(r#"["0 m", "0 m", "0 m"]"#),
            doc: "Displacement along the heading, to starboard, down.",
        },
        FaultParameter {
            name: "turn",
            takes: Takes::Vector(&[Dimension::Angle]),
            default: Some(r#"["0 deg", "0 deg", "0 deg"]"#),
            doc: "Turn in roll, pitch and heading.",
        },
        FaultParameter {
            name: "length",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(0.1, 86_400.0, "from 0.1 s to 24 h"),
            ),
            default: Some("5 s"),
            doc: "Time L that it takes, there and back.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("displacement", r#"["0.3 m", "0 m", "0 m"]"#)]).showing_s(5.0),
    build: build_jerk,
};

fn build_jerk(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let displacement_m = values.vector("displacement")?;
    let angle_rad = values.vector("turn")?;
    not_nothing("displacement", "turn", [&displacement_m, &angle_rad])?;
    within("displacement", &displacement_m, 1000.0, "m")?;
    within("turn", &angle_rad, 1.0, "rad")?;
    let length_s = values.quantity("length")?;
    Ok(fixed(Disturbance::Excursion { displacement_m, angle_rad, length_s }))
}

pub(super) static SWAY: FaultKind = FaultKind {
    name: "sway",
    family: Family::Aiding,
    acts: Acts::Plant,
    summary: "The case sways while the reference, and so the core, believes that it stands still.",
    model: "In each degree of freedom the case moves, in addition to the configured motion, by\n\n\
            \u{20}   w(t) A sin(2πt/P + φ)      t since the onset, φ drawn\n\n\
            roll, pitch and heading of the case, and surge along its mean heading, sway to starboard \
            and heave down. The window w rises along 10u³ − 15u⁴ + 6u⁵ from 0 to 1 within the edge \
            and falls the same way in the edge that follows the end. Rate and specific force follow \
            from the displaced position on the ellipsoid, with Coriolis, transport rate, and gravity \
            at the height; truth sways too.\n\n\
            Aiding of the kind zero velocity goes on saying zero: a core that is tuned for a static \
            base takes the sway for errors of its instrument. Dock position says the dock's; \
            aiding of the kind velocity gives the true one.\n\n\
            After end and edge the increments are those of the plant without the fault, and counts \
            differ by at most one. The phases come from the fault's own stream `phase`, anew for \
            each onset. The default is the dockside sway of the plant's own; the dynamic condition \
            of ISO 8728 is roll and pitch up to 5 deg with periods of 6 s to 15 s.",
    parameters: &[
        FaultParameter {
            name: "angles",
            takes: Takes::Vector(&[Dimension::Angle]),
            default: Some(r#"["3 deg", "1.5 deg", "1 deg"]"#),
            doc: "Amplitudes of roll, pitch and heading.",
        },
        FaultParameter {
            name: "angle_periods",
            takes: Takes::Vector(&[Dimension::Time]),
            default: Some(r#"["8 s", "6 s", "10 s"]"#),
            doc: "Their periods, 0.01 s to 1000000 s; that of an amplitude of zero is of no account.",
        },
        FaultParameter {
            name: "displacement",
            takes: Takes::Vector(&[Dimension::Length]),
            default: Some(r#"["0.2 m", "0.2 m", "0.2 m"]"#),
            doc: "Amplitudes of surge, sway and heave.",
        },
        FaultParameter {
            name: "displacement_periods",
            takes: Takes::Vector(&[Dimension::Time]),
            default: Some(r#"["6 s", "7 s", "8 s"]"#),
            doc: "Their periods, 0.01 s to 1000000 s; that of an amplitude of zero is of no account.",
        },
        FaultParameter { default: Some("10 s"), ..EDGE },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""20 s""#)]),
    build: build_sway,
};

fn build_sway(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let angles = values.vector("angles")?;
    let displacement = values.vector("displacement")?;
    not_nothing("angles", "displacement", [&angles, &displacement])?;
    within("angles", &angles, 1.0, "rad")?;
    within("displacement", &displacement, 1000.0, "m")?;
    let periods = |name: &'static str, of: &[f64; 3]| -> Result<[f64; 3], FaultBuildError> {
        let periods = values.vector(name)?;
        let wrong = |(_, period): &(&f64, &f64)| !(0.01..=1e6).contains(*period);
        match of.iter().zip(&periods).filter(|(amplitude, _)| **amplitude != 0.0).find(wrong) {
            None => Ok(periods),
            Some((_, period)) => {
                let problem = format!("{period} s was found, 0.01 s to 1000000 s is expected");
                Err(FaultBuildError::value(name, problem))
            }
        }
    };
    let sway = Sway {
        angles,
        angle_periods_s: periods("angle_periods", &angles)?,
        displacement,
        displacement_periods_s: periods("displacement_periods", &displacement)?,
        edge_s: values.quantity("edge")?,
        stream: setup.stream("phase"),
    };
    Ok(FaultRule::Plant(Box::new(sway)))
}

#[derive(Clone, Debug)]
struct Sway {
    angles: [f64; 3],
    angle_periods_s: [f64; 3],
    displacement: [f64; 3],
    displacement_periods_s: [f64; 3],
    edge_s: f64,
    stream: Stream,
}

octant_state::state! { Sway { values: ; parts: ; kept: angles, angle_periods_s, displacement, displacement_periods_s, edge_s, stream } }

impl PlantRule for Sway {
    fn begin(&mut self, now: &Context<'_>, _: &Motor) -> Disturbance {
        let key = self.stream.key(now.phase);
        let counter = 2 * u64::from(now.firing);
        let phases = [words(key, counter), words(key, counter + 1)].map(|four| four.map(uniform));
        let mut lines = Vec::with_capacity(6);
        for axis in 0..3 {
            let still = SpectralLine {
                frequency_hz: 1.0,
                displacement_m: [0.0; 3],
                angle_rad: [0.0; 3],
                phase_rad: angular(phases[0][axis]),
                angle_phase_rad: angular(phases[1][axis]),
            };
            if self.angles[axis] != 0.0 {
                let mut line =
                    SpectralLine { frequency_hz: 1.0 / self.angle_periods_s[axis], ..still };
                line.angle_rad[axis] = self.angles[axis];
                lines.push(line);
            }
            if self.displacement[axis] != 0.0 {
                let frequency_hz = 1.0 / self.displacement_periods_s[axis];
                let mut line = SpectralLine { frequency_hz, ..still };
                line.displacement_m[axis] = self.displacement[axis];
                lines.push(line);
            }
        }
        Disturbance::Case { lines, edge_s: self.edge_s }
    }
}
