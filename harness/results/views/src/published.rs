//! Messages published during a run: JSON with schemas, in display units, by topic.

use super::state::RunState;
use octant_recorder::Event;
use octant_recorder::further::FurtherChannel;
use octant_recorder::reader::Item;
use octant_sample::parameters::{NAMES, ParameterEstimate, ParameterGroup};
use octant_sample::{Mode, Output};
use serde_json::{Map, Value, json};

/// Channel of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PublishedChannel {
    /// Progress of the run: mode, stop, health.
    State,
    /// Navigation minus truth.
    Error,
    /// Estimated parameters with σ.
    Parameters,
    /// Gimbal angles, as sensed and as commanded.
    Gimbals,
    /// NIS of the measurements.
    Nis,
    /// Lateness of a run by the clock.
    Pacing,
    /// Faults, armed and fired.
    Faults,
}

impl PublishedChannel {
    /// All channels.
    pub const ALL: [Self; 7] = [
        Self::State,
        Self::Error,
        Self::Parameters,
        Self::Gimbals,
        Self::Nis,
        Self::Pacing,
        Self::Faults,
    ];

    /// Topic.
    #[must_use]
    pub const fn topic(self) -> &'static str {
        match self {
            Self::State => "/octant/state",
            Self::Error => "/octant/error",
            Self::Parameters => "/octant/parameters",
            Self::Gimbals => "/octant/gimbals",
            Self::Nis => "/octant/nis",
            Self::Pacing => "/octant/pacing",
            Self::Faults => "/octant/faults",
        }
    }

    /// Returns the name of the schema.
    #[must_use]
    pub const fn schema_name(self) -> &'static str {
        match self {
            Self::State => "octant.State",
            Self::Error => "octant.NavigationError",
            Self::Parameters => "octant.Parameters",
            Self::Gimbals => "octant.Gimbals",
            Self::Nis => "octant.Nis",
            Self::Pacing => "octant.Pacing",
            Self::Faults => "octant.Faults",
        }
    }

    /// Returns the channel.
    #[must_use]
    pub fn channel(self) -> FurtherChannel {
        FurtherChannel {
            topic: self.topic(),
            schema_name: self.schema_name(),
            schema_encoding: "jsonschema",
            schema: self.schema().to_string(),
            message_encoding: "json",
        }
    }

    /// JSON Schema.
    #[must_use]
    pub fn schema(self) -> Value {
        match self {
            Self::State => object(&[
                ("time_s", number("s", "Run time")),
                ("done_percent", number("%", "Share of the run that is done; null where unknown")),
                ("mode", json!({ "type": "string" })),
                (
                    "mode_number",
                    number("", "0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done"),
                ),
                ("stop", number("", "Number of the stop, from 1")),
                (
                    "position",
                    number("", "Position of a stop of the calibration, from 1; else null"),
                ),
                ("moving", json!({ "type": "boolean" })),
                ("health", json!({ "type": "array", "items": { "type": "string" } })),
                ("health_bits", number("", "Flags of the core's health")),
            ]),
            Self::Error => object(&[
                ("latitude_arcmin", number("arcmin", "Navigation minus truth")),
                ("longitude_arcmin", number("arcmin", "Navigation minus truth")),
                ("radial_nmi", number("nmi", "Distance")),
            ]),
            Self::Parameters => {
                let one = |i: usize| {
                    let unit = ParameterGroup::of(i).unit();
                    let parts = [("value", number(unit, "")), ("sigma", number(unit, "1 sigma"))];
                    (NAMES[i], object(&parts))
                };
                let parameters: Vec<_> = (0..NAMES.len()).map(one).collect();
                object(&parameters)
            }
            Self::Gimbals => object(&[
                ("azimuth_deg", number("deg", "As sensed")),
                ("roll_deg", number("deg", "As sensed")),
                ("command_azimuth_deg", number("deg", "As commanded")),
                ("command_roll_deg", number("deg", "As commanded")),
            ]),
            Self::Nis => object(&[
                ("nis", number("", "Normalized innovation squared; 3 is right")),
                ("mean", number("", "Mean so far")),
            ]),
            Self::Pacing => object(&[
                ("samples", number("", "Samples that have left")),
                ("latest_us", number("us", "Largest lateness of the last second")),
                ("overruns", number("", "Overruns so far")),
                ("late_answers", number("", "Periods so far that ended without their answer")),
            ]),
            Self::Faults => {
                let fault = object(&[
                    ("id", json!({ "type": "string" })),
                    ("kind", json!({ "type": "string" })),
                    ("when", json!({ "type": "string" })),
                    ("acts", json!({ "type": "boolean" })),
                    ("firings", number("", "How often it set in")),
                ]);
                object(&[
                    ("armed", number("", "Faults of the scenario")),
                    ("fired", number("", "Those that have set in")),
                    ("acting", number("", "Those that act now")),
                    ("faults", json!({ "type": "array", "items": fault })),
                ])
            }
        }
    }
}

fn number(unit: &str, description: &str) -> Value {
    let text = match (unit, description) {
        ("", text) => text.to_owned(),
        (unit, "") => unit.to_owned(),
        (unit, text) => format!("{text}, {unit}"),
    };
    json!({ "type": "number", "description": text })
}

fn object(properties: &[(&str, Value)]) -> Value {
    let properties: Map<String, Value> =
        properties.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    json!({ "type": "object", "properties": properties })
}

/// Position of the stop of an output in a calibration, from 1.
fn position(state: &RunState, output: &Output) -> Option<usize> {
    let stop = usize::from(output.stop);
    let stops = state.about.stops.filter(|stops| stop < stops.count)?;
    (output.mode == Mode::Calibrating).then(|| stops.visited.at(stop))
}

/// Publishes the messages that follow from an item of the recording, with the state after it.
pub fn messages(state: &RunState, item: &Item, mut publish: impl FnMut(PublishedChannel, Value)) {
    match item {
        Item::Output(output) => {
            publish(
                PublishedChannel::State,
                json!({
                    "time_s": state.time_ns as f64 * 1e-9,
                    "done_percent": state.done().map(|done| done * 100.0),
                    "mode": output.mode.name(),
                    "mode_number": output.mode as u8,
                    "stop": u32::from(output.stop) + 1,
                    "position": position(state, output),
                    "moving": output.moving,
                    "health": output.health.iter().map(octant_score::health::name).collect::<Vec<_>>(),
                    "health_bits": output.health.bits(),
                }),
            );
            let target = output.gimbal_command.target;
            let mut gimbals = json!({
                "command_azimuth_deg": target.azimuth_rad().to_degrees(),
                "command_roll_deg": target.roll_rad().to_degrees(),
            });
            if let Some(sensed) = state.gimbals {
                gimbals["azimuth_deg"] = sensed.azimuth_rad().to_degrees().into();
                gimbals["roll_deg"] = sensed.roll_rad().to_degrees().into();
            }
            publish(PublishedChannel::Gimbals, gimbals);
            if let Some(nis) = state.nis.filter(|_| output.nis.is_finite()) {
                publish(
                    PublishedChannel::Nis,
                    json!({ "nis": nis.last, "mean": finite(nis.mean()) }),
                );
            }
        }
        Item::Truth(truth) => {
            let same = state.output.is_some_and(|output| output.device_time.ns == truth.time.ns);
            if let Some(drift) = state.drift.filter(|_| same) {
                publish(
                    PublishedChannel::Error,
                    json!({
                        "latitude_arcmin": finite(drift.latitude_arcmin),
                        "longitude_arcmin": finite(drift.longitude_arcmin),
                        "radial_nmi": finite(drift.radial_nmi),
                    }),
                );
            }
        }
        Item::Parameters(_, estimate) => {
            publish(PublishedChannel::Parameters, parameters(estimate));
        }
        Item::Event(event) => match event {
            Event::Pace(_) => {
                if let Some(pace) = state.pace {
                    publish(
                        PublishedChannel::Pacing,
                        json!({
                            "samples": pace.frames,
                            "latest_us": pace.latest_us,
                            "overruns": pace.overruns,
                            "late_answers": pace.late_answers,
                        }),
                    );
                }
            }
            Event::Fault { .. } | Event::Receipts(_) => {
                publish(PublishedChannel::Faults, faults(state))
            }
            _ => {}
        },
        Item::Sample(_)
        | Item::CleanSample(_)
        | Item::CleanAiding(_)
        | Item::Aiding(_)
        | Item::Innovation(..)
        | Item::Covariance(..) => {}
    }
}

/// Builds the message of the parameters.
fn parameters(estimate: &ParameterEstimate) -> Value {
    let values = estimate.parameters.to_array();
    let mut message = Map::new();
    for (i, name) in NAMES.iter().enumerate() {
        let unit = ParameterGroup::of(i).si_per_unit();
        // A parameter that isn't estimated has a value and no σ.
        let sigma = Some(estimate.sigma[i] / unit).filter(|sigma| *sigma > 0.0);
        let sigma = sigma.and_then(finite);
        let value = json!({ "value": finite(values[i] / unit), "sigma": sigma });
        message.insert((*name).to_owned(), value);
    }
    message.into()
}

/// Builds the message of all faults.
#[must_use]
pub fn faults(state: &RunState) -> Value {
    let count = |is: fn(&super::state::FaultState) -> bool| {
        state.faults.iter().filter(|fault| is(fault)).count()
    };
    json!({
        "armed": state.faults.len(),
        "fired": count(|fault| fault.firings > 0),
        "acting": count(|fault| fault.acts),
        "faults": state.faults.iter().map(|fault| json!({
            "id": fault.id,
            "kind": fault.kind,
            "when": fault.when,
            "acts": fault.acts,
            "firings": fault.firings,
        })).collect::<Vec<_>>(),
    })
}

/// JSON has no NaN.
fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
