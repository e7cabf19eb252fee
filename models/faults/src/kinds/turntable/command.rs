//! Set points on their way from the core to the turntable.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::parameters::samples;
use crate::rule::{CommandRule, Context, FaultRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::vec::Vec;
use octant_sample::GimbalCommand;

const POSITIONS: FaultParameter = FaultParameter {
    name: "positions",
    takes: Takes::Integer(1, 1000),
    default: Some("1"),
    doc: "Positions in a row that it happens to.",
};

pub(super) static SKIPPED_POSITION: FaultKind = FaultKind {
    name: "skipped-position",
    family: Family::Turntable,
    acts: Acts::Command,
    summary: "The turntable ignores a position and stays where it is until the next one comes.",
    model: "The first set point that is new at the onset or after it is ignored: the turntable \
            keeps the one that it had,\n\n\
            \u{20}   command' = command before      until the set point changes again,\n\n\
            and follows from the next one on, from where it stands: the move takes as long as that \
            angle needs, and the core, which knows only its own timetable, may call it arrived \
            while it still turns. With `positions = n` the first n new set points are ignored. \
            Another onset ignores the next new one again.\n\n\
            A trigger `moving_to` hits the position that it names, one `at` a time the next one \
            after it. Where the fault ends first, the turntable goes to the set point of that \
            moment; a fault without a duration waits. The encoders tell the truth: only the \
            agreement of encoder and set point shows it. Table controllers do this when a command \
            is refused, as for a limit or an interlock, and nobody reads the answer.",
    parameters: &[POSITIONS],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""30 s""#)]),
    build: build_skipped,
};

fn build_skipped(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    instead(values, |now| now.set_points.last)
}

pub(super) static REPEATED_POSITION: FaultKind = FaultKind {
    name: "repeated-position",
    family: Family::Turntable,
    acts: Acts::Command,
    summary: "Instead of to a new position, the turntable goes back to the one before.",
    model: "At the first set point that is new at the onset or after it, the turntable goes back \
            from the position P where it is to the position Q where it was before:\n\n\
            \u{20}   ordered:   Q P N M\n\
            \u{20}   done:      Q P Q M\n\n\
            and stays there until the set point changes again, from when on it follows. With \
            `positions = n` it stays at Q for n new set points. At the first positions of a run, \
            where there is no position before, it stays where it is. The move is a real one: gyros \
            and encoders feel it, and it is not the one that the core expects. Another onset \
            does it again.\n\n\
            A trigger `moving_to` hits the position that it names, one `at` a time the next one \
            after it. Where the fault ends first, the turntable goes to the set point of that \
            moment. A controller that walks a stored list does this when its index goes back.",
    parameters: &[POSITIONS],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""30 s""#)]),
    build: build_repeated,
};

fn build_repeated(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    instead(values, |now| now.set_points.before)
}

fn instead(
    values: &Values,
    place: fn(&Context<'_>) -> GimbalCommand,
) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Command(Box::new(Instead {
        positions: values.integer("positions")?,
        place,
        left: 0,
        ordered: GimbalCommand::default(),
        instead: None,
    })))
}

/// Sends the turntable to another place instead of to new positions.
#[derive(Clone, Debug)]
struct Instead {
    positions: i64,
    place: fn(&Context<'_>) -> GimbalCommand,
    /// Number of new set points still to be replaced.
    left: i64,
    /// The last set point that came in.
    ordered: GimbalCommand,
    /// Set point for the turntable, after the first replacement.
    instead: Option<GimbalCommand>,
}

octant_state::state! { Instead { values: left, ordered, instead; parts: ; kept: positions, place } }

impl CommandRule for Instead {
    fn on_command(&mut self, command: &mut GimbalCommand, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.left = self.positions;
            self.ordered = now.set_points.last;
            self.instead = None;
        }
        if *command != self.ordered {
            self.ordered = *command;
            if self.left > 0 {
                self.left -= 1;
                self.instead.get_or_insert((self.place)(now));
            } else {
                self.instead = None;
            }
        }
        if let Some(instead) = self.instead {
            *command = instead;
        }
    }
}

pub(super) static WRONG_DIRECTION: FaultKind = FaultKind {
    name: "wrong-direction",
    family: Family::Turntable,
    acts: Acts::Command,
    summary: "The turntable turns the other way: moves are mirrored.",
    model: "While it lasts, set points are mirrored about the one p that the turntable had at the \
            onset:\n\n\
            \u{20}   command' = 2 p − command      in counts, saturating at the range of ±16 rad\n\n\
            so that every move from p has its right size and the wrong sign, and the moves after it \
            too: a wrong polarity of the drive or of its encoder's counting. A move that is under \
            way at the onset is not reversed: its set point is p. At the end of the fault the \
            turntable goes from where it is to the set point of that moment. The encoders show \
            where it really is.",
    parameters: &[FaultParameter {
        name: "gimbal",
        takes: Takes::Choice(&[
            ("azimuth", "the inner gimbal"),
            ("roll", "the outer gimbal"),
            ("both", "both gimbals"),
        ]),
        default: Some("both"),
        doc: "Gimbal that turns the wrong way.",
    }],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""30 s""#)]),
    build: build_direction,
};

fn build_direction(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let gimbal = values.choice("gimbal")?;
    Ok(FaultRule::Command(Box::new(WrongDirection {
        azimuth: gimbal != "roll",
        roll: gimbal != "azimuth",
        pivot: GimbalCommand::default(),
    })))
}

#[derive(Clone, Debug)]
struct WrongDirection {
    azimuth: bool,
    roll: bool,
    pivot: GimbalCommand,
}

octant_state::state! { WrongDirection { values: pivot; parts: ; kept: azimuth, roll } }

impl CommandRule for WrongDirection {
    fn on_command(&mut self, command: &mut GimbalCommand, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.pivot = now.set_points.last;
        }
        let mirror = |counts: &mut i32, pivot: i32| {
            let mirrored = 2 * i64::from(pivot) - i64::from(*counts);
            *counts = mirrored.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        };
        if self.azimuth {
            mirror(&mut command.target.azimuth, self.pivot.target.azimuth);
        }
        if self.roll {
            mirror(&mut command.target.roll, self.pivot.target.roll);
        }
    }
}

pub(super) static COMMAND_LATE: FaultKind = FaultKind {
    name: "command-late",
    family: Family::Turntable,
    acts: Acts::Command,
    summary: "Set points reach the turntable late.",
    model: "While it lasts, the turntable gets the set point of n epochs ago:\n\n\
            \u{20}   command'(k) = command(k − n)      n = delay / period, to the nearest whole number\n\n\
            and in the first n epochs the one that it had at the onset. Every move is the right one \
            and begins late by the delay, while the core's timetable runs: it counts the end of the \
            move for the dwell. At the end of the fault the turntable has the set point of that \
            moment at once; what was still under way is the same or older, and is dropped.",
    parameters: &[FaultParameter {
        name: "delay",
        takes: Takes::Quantity(&[Dimension::Time, Dimension::Samples], ParameterBounds::Positive),
        default: None,
        doc: "How late set points are: at least one sample period, at most a million.",
    }],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("delay", r#""5 s""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""30 s""#),
    ]),
    build: build_late,
};

/// Longest delay of a set point, samples: 83 min at 200 Hz.
const DELAY_MAX: u64 = 1_000_000;

fn build_late(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let delay = samples(values, "delay", 1..=DELAY_MAX, setup)? as usize;
    let ring = alloc::vec![GimbalCommand::default(); delay];
    Ok(FaultRule::Command(Box::new(CommandLate { ring, next: 0 })))
}

#[derive(Clone, Debug)]
struct CommandLate {
    /// Last set points, as many as the delay has epochs.
    ring: Vec<GimbalCommand>,
    /// Index of the oldest.
    next: usize,
}

impl octant_state::State for CommandLate {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { ring, next } = self;
        to.value("next", next);
        for command in ring {
            to.value("command", command);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.next = from.value("next")?;
        octant_state::check_below("next", self.next as u64, self.ring.len() as u64 - 1)?;
        for command in &mut self.ring {
            *command = from.value("command")?;
        }
        Ok(())
    }
}

impl CommandRule for CommandLate {
    fn on_command(&mut self, command: &mut GimbalCommand, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.ring.fill(now.set_points.last);
        }
        core::mem::swap(command, &mut self.ring[self.next]);
        self.next = (self.next + 1) % self.ring.len();
    }
}

pub(super) static COMMAND_LOST: FaultKind = FaultKind {
    name: "command-lost",
    family: Family::Turntable,
    acts: Acts::Command,
    summary: "Set points don't reach the turntable for a time.",
    model: "While it lasts, the turntable keeps the set point that it had at the onset:\n\n\
            \u{20}   command'(k) = command(k₀ − 1)      k₀: epoch of the onset\n\n\
            A move that is under way is finished; every new position is missed until the fault \
            ends. Set points are no events, they stand in every answer of the core: at the end the \
            turntable goes to the one of that moment, and a loss costs time but no position, \
            unless it outlasts one. In a dwell a loss does nothing, and its receipt says so.",
    parameters: &[],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""5 s""#)]),
    build: build_lost,
};

fn build_lost(_: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Command(Box::new(CommandLost { held: GimbalCommand::default() })))
}

#[derive(Clone, Debug)]
struct CommandLost {
    held: GimbalCommand,
}

octant_state::state! { CommandLost { values: held; parts: ; kept:  } }

impl CommandRule for CommandLost {
    fn on_command(&mut self, command: &mut GimbalCommand, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.held = now.set_points.last;
        }
        *command = self.held;
    }
}
