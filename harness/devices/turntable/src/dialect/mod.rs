//! Command languages of controllers: their commands and replies.
//!
//! A language is a table of patterns in TOML (such as `dialects/aerotech-ensemble.toml`). A pattern is
//! a line with fields in braces: `{axis}` the name of the axis in the language; `{angle}`, `{rate}`,
//! `{acceleration}` numbers in its units; `{ms}` milliseconds; `{bits}` and `{fault}` integers, decimal
//! or with `0x`; `{moving}`, `{homed}`, `{enabled}` 0 or 1; `{any}` any text.

mod pattern;

pub(crate) use pattern::{Field, Fields, Pattern};

use crate::{Error, TableAxis};
use octant_toml_tree::error::Place;
use std::collections::BTreeMap;

/// A command of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Command {
    Begin,
    Enable,
    Goto,
    Rate,
    Stop,
    Home,
    Feed,
}

/// A status query with its reply.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    pub(crate) send: Pattern,
    pub(crate) reply: Pattern,
}

/// Meanings of the bits in `{bits}`.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bits {
    pub(crate) enabled: Option<u32>,
    pub(crate) homed: Option<u32>,
    pub(crate) moving: Option<u32>,
}

/// A command language.
#[derive(Clone, Debug)]
pub struct Dialect {
    pub(crate) name: String,
    pub(crate) end: String,
    pub(crate) decimals: usize,
    /// Radians in a unit of angle, rad/s in a unit of rate, rad/s² in a unit of acceleration.
    pub(crate) units: [f64; 3],
    pub(crate) done: Option<Pattern>,
    pub(crate) refused: Vec<Pattern>,
    pub(crate) axes: [String; 2],
    pub(crate) commands: Vec<(Command, Vec<Pattern>)>,
    pub(crate) status: Vec<Question>,
    pub(crate) bits: Bits,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    name: String,
    end: String,
    decimals: usize,
    angle: String,
    rate: String,
    acceleration: String,
    done: Option<String>,
    #[serde(default)]
    refused: Vec<String>,
    axes: RawAxes,
    commands: RawCommands,
    watchdog: Option<RawWatchdog>,
    status: Vec<RawQuestion>,
    #[serde(default)]
    bits: Bits,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawAxes {
    azimuth: String,
    roll: String,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCommands {
    #[serde(default)]
    begin: Vec<String>,
    #[serde(default)]
    enable: Vec<String>,
    goto: Vec<String>,
    #[serde(default)]
    rate: Vec<String>,
    stop: Vec<String>,
    #[serde(default)]
    home: Vec<String>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawWatchdog {
    feed: Vec<String>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawQuestion {
    send: String,
    reply: String,
}

impl Dialect {
    /// Language of Aerotech's Ensemble controllers.
    ///
    /// # Errors
    /// Never: the built-in table of patterns is tested.
    pub fn aerotech_ensemble() -> Result<Self, Error> {
        let text = include_str!("../../dialects/aerotech-ensemble.toml");
        Self::parse("dialects/aerotech-ensemble.toml", text)
    }

    /// Name of the built-in language.
    pub const BUILT_IN: &'static str = "aerotech-ensemble";

    /// Loads the built-in language by its name, or another one from a file with its table of patterns.
    ///
    /// # Errors
    /// If the file can't be read, or has no table of patterns.
    pub fn load(name: &std::path::Path) -> Result<Self, Error> {
        if name == std::path::Path::new(Self::BUILT_IN) {
            return Self::aerotech_ensemble();
        }
        let file = name.display().to_string();
        let text = std::fs::read_to_string(name).map_err(|error| Error::Dialect {
            place: file.clone(),
            what: format!(
                "{error}, expected {} or a file with a table of patterns",
                Self::BUILT_IN
            ),
        })?;
        Self::parse(&file, &text)
    }

    /// Parses a table of patterns; `file` is its name in messages.
    ///
    /// # Errors
    /// If the table is invalid: with file, and line or key.
    pub fn parse(file: &str, text: &str) -> Result<Self, Error> {
        let raw: Raw = octant_toml_tree::read_as(text).map_err(|problem| {
            let place = match problem.place {
                Place::File { line, .. } => format!("{file}:{line}"),
                _ => file.into(),
            };
            Error::Dialect { place, what: problem.message.trim().into() }
        })?;
        let wrong =
            |key: &str, what: String| Error::Dialect { place: format!("{file}: {key}"), what };
        let unit = |key: &str, found: &str, known: &[(&str, f64)]| {
            known.iter().find(|(name, _)| *name == found).map(|(_, unit)| *unit).ok_or_else(|| {
                let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                wrong(
                    key,
                    format!("found the unit `{found}`, expected one of {}", names.join(", ")),
                )
            })
        };
        let degree = 1f64.to_radians();
        let units = [
            unit(
                "angle",
                &raw.angle,
                &[("deg", degree), ("rad", 1.0), ("arcsec", degree / 3600.0)],
            )?,
            unit(
                "rate",
                &raw.rate,
                &[("deg/s", degree), ("deg/min", degree / 60.0), ("rad/s", 1.0)],
            )?,
            unit("acceleration", &raw.acceleration, &[("deg/s2", degree), ("rad/s2", 1.0)])?,
        ];
        if raw.end.is_empty() {
            return Err(wrong(
                "end",
                "found an empty text, expected the characters that end a line".into(),
            ));
        }
        if raw.decimals > 12 {
            return Err(wrong("decimals", format!("found {}, expected at most 12", raw.decimals)));
        }
        if raw.axes.azimuth == raw.axes.roll || raw.axes.azimuth.is_empty() {
            return Err(wrong(
                "axes",
                "found empty or equal names of axes, expected two different names".into(),
            ));
        }
        let patterns = |key: &str, texts: &[String]| -> Result<Vec<Pattern>, Error> {
            let parse = |text: &String| {
                if text.contains(&raw.end) {
                    return Err(wrong(
                        key,
                        format!("found the end of a line in `{text}`, expected none"),
                    ));
                }
                Pattern::parse(text).map_err(|what| wrong(key, what))
            };
            texts.iter().map(parse).collect()
        };
        let commands = &raw.commands;
        let feed = raw.watchdog.map(|watchdog| watchdog.feed).unwrap_or_default();
        let mut all = Vec::new();
        for (command, key, texts, needs) in [
            (Command::Begin, "commands.begin", &commands.begin, None),
            (Command::Enable, "commands.enable", &commands.enable, Some(Field::Axis)),
            (Command::Goto, "commands.goto", &commands.goto, Some(Field::Angle)),
            (Command::Rate, "commands.rate", &commands.rate, Some(Field::Rate)),
            (Command::Stop, "commands.stop", &commands.stop, None),
            (Command::Home, "commands.home", &commands.home, None),
            (Command::Feed, "watchdog.feed", &feed, Some(Field::Ms)),
        ] {
            let patterns = patterns(key, texts)?;
            if let Some(needed) = needs
                && !patterns.is_empty()
                && !patterns.iter().any(|pattern| pattern.has(needed))
            {
                return Err(wrong(
                    key,
                    format!("found no line with a field {{{}}}, expected one", needed.name()),
                ));
            }
            all.push((command, patterns));
        }
        for (needed, key) in [(Command::Goto, "commands.goto"), (Command::Stop, "commands.stop")] {
            if all.iter().any(|(command, lines)| *command == needed && lines.is_empty()) {
                return Err(wrong(
                    key,
                    "found no line, expected one: every table has this command".into(),
                ));
            }
        }
        let mut status = Vec::new();
        for (number, question) in raw.status.iter().enumerate() {
            let key = format!("status {}", number + 1);
            let mut both = patterns(&key, &[question.send.clone(), question.reply.clone()])?;
            let (Some(reply), Some(send)) = (both.pop(), both.pop()) else { continue };
            status.push(Question { send, reply });
        }
        if !status.iter().any(|question| question.reply.has(Field::Angle)) {
            return Err(wrong(
                "status",
                "found no reply with a field {angle}, expected one".into(),
            ));
        }
        let done = raw.done.as_ref().map(|done| patterns("done", std::slice::from_ref(done)));
        Ok(Self {
            done: done.transpose()?.and_then(|mut patterns| patterns.pop()),
            refused: patterns("refused", &raw.refused)?,
            name: raw.name,
            end: raw.end,
            decimals: raw.decimals,
            units,
            axes: [raw.axes.azimuth, raw.axes.roll],
            commands: all,
            status,
            bits: raw.bits,
        })
    }

    /// Name of the language.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Lines of a command.
    pub(crate) fn lines(&self, command: Command) -> &[Pattern] {
        let found = self.commands.iter().find(|(one, _)| *one == command);
        found.map_or(&[], |(_, lines)| lines)
    }

    /// Formats values in the language.
    pub(crate) fn write(&self, values: &Values) -> Fields {
        let mut fields: Fields = BTreeMap::new();
        let mut number = |field, value: Option<f64>, unit: f64| {
            if let Some(value) = value {
                let text = format!("{:.*}", self.decimals, value / unit);
                // A negative zero is written without its sign.
                let zero = text.trim_start_matches('-').bytes().all(|c| c == b'0' || c == b'.');
                fields.insert(field, if zero { text.trim_start_matches('-').into() } else { text });
            }
        };
        let [angle, rate, acceleration] = self.units;
        number(Field::Angle, values.angle_rad, angle);
        number(Field::Rate, values.rate_radps, rate);
        number(Field::Acceleration, values.acceleration_radps2, acceleration);
        let mut text =
            |field, value: Option<String>| value.map(|value| fields.insert(field, value));
        text(Field::Axis, values.axis.map(|axis| self.axes[axis.index()].clone()));
        for (field, value) in [
            (Field::Ms, values.ms),
            (Field::Bits, values.bits),
            (Field::Fault, values.fault),
            (Field::Moving, values.moving.map(u32::from)),
            (Field::Homed, values.homed.map(u32::from)),
            (Field::Enabled, values.enabled.map(u32::from)),
        ] {
            text(field, value.map(|value| value.to_string()));
        }
        fields
    }

    /// Parses the fields of a line; `None` if a number is invalid.
    pub(crate) fn read(&self, fields: &Fields) -> Option<Values> {
        let mut values = Values::default();
        let [angle, rate, acceleration] = self.units;
        for (field, text) in fields {
            let number = |unit: f64| {
                text.trim().parse::<f64>().ok().filter(|value| value.is_finite()).map(|v| v * unit)
            };
            let integer = || {
                let text = text.trim();
                match text.strip_prefix("0x").or(text.strip_prefix("0X")) {
                    Some(digits) => u32::from_str_radix(digits, 16).ok(),
                    None => text.parse().ok(),
                }
            };
            let flag = || integer().filter(|value| *value <= 1).map(|value| value == 1);
            match field {
                Field::Axis => {
                    let index = self.axes.iter().position(|name| name == text.trim())?;
                    values.axis = Some(TableAxis::ALL[index]);
                }
                Field::Angle => values.angle_rad = Some(number(angle)?),
                Field::Rate => values.rate_radps = Some(number(rate)?),
                Field::Acceleration => values.acceleration_radps2 = Some(number(acceleration)?),
                Field::Ms => values.ms = Some(integer()?),
                Field::Bits => values.bits = Some(integer()?),
                Field::Fault => values.fault = Some(integer()?),
                Field::Moving => values.moving = Some(flag()?),
                Field::Homed => values.homed = Some(flag()?),
                Field::Enabled => values.enabled = Some(flag()?),
                Field::Any => {}
            }
        }
        Some(values)
    }

    /// Bytes that stop the table whatever was being sent: an end of line comes first, in case a line
    /// was cut in the middle.
    pub(crate) fn emergency(&self) -> Vec<u8> {
        let mut bytes = self.end.clone().into_bytes();
        for axis in TableAxis::ALL {
            let fields = self.write(&Values { axis: Some(axis), ..Values::default() });
            for line in self.lines(Command::Stop) {
                // A stop has no field other than the axis.
                bytes.extend(line.write(&fields).unwrap_or_default().into_bytes());
                bytes.extend(self.end.as_bytes());
            }
        }
        bytes
    }
}

/// Values in a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Values {
    pub(crate) axis: Option<TableAxis>,
    pub(crate) angle_rad: Option<f64>,
    pub(crate) rate_radps: Option<f64>,
    pub(crate) acceleration_radps2: Option<f64>,
    pub(crate) ms: Option<u32>,
    pub(crate) bits: Option<u32>,
    pub(crate) fault: Option<u32>,
    pub(crate) moving: Option<bool>,
    pub(crate) homed: Option<bool>,
    pub(crate) enabled: Option<bool>,
}
