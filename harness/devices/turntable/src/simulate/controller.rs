//! Simulated controller: its reaction to a line.

use crate::dialect::{Command, Fields, Pattern, Values};
use crate::{Dialect, TableAxis};
use octant_plant::config::TurntableConfig;
use octant_plant::table::{self, GimbalTable};

/// Behaviour of a simulated controller.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum ControllerBehaviour {
    /// Correct.
    #[default]
    Well,
    /// Silent: it executes commands and answers nothing.
    Silent,
    /// Nonsense: it gives this answer to everything.
    Nonsense(String),
    /// Deaf: it neither executes nor answers lines.
    Deaf,
    /// Cut off: it closes the line.
    HangUp,
}

/// A simulated controller. Times are nanoseconds since it was switched on.
#[derive(Debug)]
pub struct Controller {
    dialect: Dialect,
    table: GimbalTable,
    /// Angle of the end switches of both axes, in either direction, rad.
    end_rad: f64,
    /// Rate of homing, rad/s.
    home_radps: f64,
    enabled: [bool; 2],
    homed: [bool; 2],
    fault: [u32; 2],
    /// Values of the command's lines so far.
    context: Values,
    watchdog_ns: Option<u64>,
    fed_ns: u64,
    behaviour: ControllerBehaviour,
    log: Vec<String>,
}

/// Fault word of an axis that ran into its end.
const FAULT_END: u32 = 0x4;
/// Fault word of an axis whose watchdog stopped it.
const FAULT_WATCHDOG: u32 = 0x100;

fn plant(axis: TableAxis) -> table::GimbalAxis {
    match axis {
        TableAxis::Azimuth => table::GimbalAxis::Azimuth,
        TableAxis::Roll => table::GimbalAxis::Roll,
    }
}

impl Controller {
    /// Makes a controller of a table at rest at zero, with its drives off. `end_rad`: angle of the end
    /// switches.
    #[must_use]
    pub fn new(dialect: Dialect, config: &TurntableConfig, end_rad: f64) -> Self {
        Self {
            dialect,
            table: GimbalTable::new(config),
            end_rad,
            home_radps: config.rate_radps / 6.0,
            enabled: [false; 2],
            homed: [false; 2],
            fault: [0; 2],
            context: Values::default(),
            watchdog_ns: None,
            fed_ns: 0,
            behaviour: ControllerBehaviour::Well,
            log: Vec::new(),
        }
    }

    /// Characters that end a line.
    #[must_use]
    pub fn end(&self) -> &str {
        &self.dialect.end
    }

    /// Sets the behaviour from now on.
    pub fn behave(&mut self, behaviour: ControllerBehaviour) {
        self.behaviour = behaviour;
    }

    /// Present behaviour.
    #[must_use]
    pub fn behaviour(&self) -> &ControllerBehaviour {
        &self.behaviour
    }

    /// Lines received, unchanged.
    #[must_use]
    pub fn log(&self) -> &[String] {
        &self.log
    }

    /// True motion of an axis.
    #[must_use]
    pub fn motion(&self, axis: TableAxis, now_ns: u64) -> table::AxisMotion {
        self.table.motion(plant(axis), now_ns)
    }

    /// Advances the time: end switches and watchdog act.
    pub fn tick(&mut self, now_ns: u64) {
        for axis in TableAxis::ALL {
            let motion = self.motion(axis, now_ns);
            let outward =
                motion.angle_rad.abs() > self.end_rad && motion.angle_rad * motion.rate_radps > 0.0;
            if outward {
                self.fault[axis.index()] |= FAULT_END;
                self.halt(axis, now_ns);
            }
        }
        if let Some(silence) = self.watchdog_ns
            && now_ns.saturating_sub(self.fed_ns) > silence
        {
            self.watchdog_ns = None;
            for axis in TableAxis::ALL {
                self.fault[axis.index()] |= FAULT_WATCHDOG;
                self.halt(axis, now_ns);
            }
        }
    }

    fn halt(&mut self, axis: TableAxis, now_ns: u64) {
        self.table.run_on(plant(axis), 0.0, now_ns);
    }

    /// Receives a line and returns its answer.
    pub fn line(&mut self, line: &str, now_ns: u64) -> Option<String> {
        self.tick(now_ns);
        if line.is_empty() || self.behaviour == ControllerBehaviour::Deaf {
            return None;
        }
        self.log.push(line.into());
        let reply = self.understood(line, now_ns);
        match &self.behaviour {
            ControllerBehaviour::Well => reply,
            ControllerBehaviour::Nonsense(nonsense) => Some(nonsense.clone()),
            ControllerBehaviour::Silent
            | ControllerBehaviour::Deaf
            | ControllerBehaviour::HangUp => None,
        }
    }

    fn understood(&mut self, line: &str, now_ns: u64) -> Option<String> {
        for question in &self.dialect.status {
            let asked = question.send.read(line).and_then(|fields| self.dialect.read(&fields));
            if let Some(asked) = asked {
                let axis = asked.axis.unwrap_or(TableAxis::Azimuth);
                return question.reply.write(&self.dialect.write(&self.state(axis, now_ns)));
            }
        }
        let found = self.dialect.commands.iter().find_map(|(command, lines)| {
            lines.iter().enumerate().find_map(|(index, pattern)| {
                let values = self.dialect.read(&pattern.read(line)?)?;
                Some((*command, index + 1 == lines.len(), values))
            })
        });
        let Some((command, last, values)) = found else { return self.refusal() };
        let context = &mut self.context;
        context.axis = values.axis.or(context.axis);
        context.angle_rad = values.angle_rad.or(context.angle_rad);
        context.rate_radps = values.rate_radps.or(context.rate_radps);
        context.ms = values.ms.or(context.ms);
        if last && !self.done(command, now_ns) {
            return self.refusal();
        }
        self.dialect.done.as_ref().and_then(|done| done.write(&Fields::new()))
    }

    fn refusal(&self) -> Option<String> {
        let refused = self.dialect.refused.first()?;
        let empty = Fields::from([(crate::dialect::Field::Any, String::new())]);
        refused.write(&empty)
    }

    /// Executes a command; false if it can't.
    fn done(&mut self, command: Command, now_ns: u64) -> bool {
        let context = std::mem::take(&mut self.context);
        let axis = context.axis;
        let ready = |axis: TableAxis| self.enabled[axis.index()] && self.fault[axis.index()] == 0;
        match command {
            Command::Begin => true,
            Command::Enable => axis.is_some_and(|axis| {
                self.enabled[axis.index()] = true;
                self.fault[axis.index()] = 0;
                true
            }),
            Command::Goto => match (axis, context.angle_rad) {
                (Some(axis), Some(angle)) if ready(axis) && angle.abs() <= self.end_rad => {
                    let rate = context.rate_radps.unwrap_or(f64::INFINITY);
                    self.table.go_to(plant(axis), angle, rate, now_ns);
                    true
                }
                _ => false,
            },
            Command::Rate => match (axis, context.rate_radps) {
                (Some(axis), Some(rate)) if ready(axis) => {
                    self.table.run_on(plant(axis), rate, now_ns);
                    true
                }
                _ => false,
            },
            Command::Stop => {
                // A language that stops both axes with one line names no axis.
                for one in TableAxis::ALL {
                    if axis.is_none_or(|axis| axis == one) {
                        self.halt(one, now_ns);
                    }
                }
                true
            }
            Command::Home => axis.filter(|axis| ready(*axis)).is_some_and(|axis| {
                self.table.go_to(plant(axis), 0.0, self.home_radps, now_ns);
                self.homed[axis.index()] = true;
                true
            }),
            Command::Feed => {
                let ms = context.ms.unwrap_or(0);
                self.fed_ns = now_ns;
                self.watchdog_ns = (ms > 0).then_some(u64::from(ms) * 1_000_000);
                true
            }
        }
    }

    /// State of an axis.
    fn state(&self, axis: TableAxis, now_ns: u64) -> Values {
        let motion = self.motion(axis, now_ns);
        let index = axis.index();
        let mut bits = 0;
        for (bit, set) in [
            (self.dialect.bits.enabled, self.enabled[index]),
            (self.dialect.bits.homed, self.homed[index]),
            (self.dialect.bits.moving, motion.moves),
        ] {
            bits |= bit.and_then(|bit| u32::from(set).checked_shl(bit)).unwrap_or(0);
        }
        Values {
            axis: Some(axis),
            angle_rad: Some(motion.angle_rad),
            rate_radps: Some(motion.rate_radps),
            bits: Some(bits),
            fault: Some(self.fault[index]),
            moving: Some(motion.moves),
            homed: Some(self.homed[index]),
            enabled: Some(self.enabled[index]),
            ..Values::default()
        }
    }

    /// Patterns of the language, for tests that send them.
    #[must_use]
    pub fn language(&self) -> Vec<String> {
        let commands = self.dialect.commands.iter().flat_map(|(_, lines)| lines);
        let questions = self.dialect.status.iter().map(|question| &question.send);
        commands.chain(questions).map(Pattern::text).map(Into::into).collect()
    }
}
