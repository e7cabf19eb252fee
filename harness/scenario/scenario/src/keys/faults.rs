//! Keys of faults: common keys, and the keys of each kind, made from the catalogue. The steps of a person have their
//! triggers.

use super::definition::{Bounds, Default, Key, Kind, Section, Tag, Variants, key};
use super::table::{
    At, Forms, Keys, Of, Value, boolean, choice, form, forms, integer, keys, number, si, text,
};
use crate::error::Problem;
use crate::quantity::{Quantity, UnitDimension};
use crate::read::reader::Reader;
use octant_faults::catalogue::{self, FaultParameter, Lasts, Takes};
use octant_faults::kinds;
use octant_operator::{AnswerKind, OnNo, OnTimeout};
use octant_sample::Mode;
use std::sync::LazyLock;

/// Keys of a fault, which depend on its kind.
pub(crate) static FAULT: Variants = Variants { tag: Tag::Value("kind"), forms: || &FORMS };

/// Keys of every kind. The catalogue is fixed at compile time, so they are made once and kept.
static FORMS: LazyLock<Vec<(&'static str, &'static Section)>> = LazyLock::new(|| {
    let form = |kind: &'static catalogue::FaultKind| {
        let common = FaultKeys::SECTION;
        (kind.name, of_kind(common, kind.name, kind.summary, kind.parameters, kind.lasts))
    };
    kinds::all().map(form).collect()
});

/// Keys of a kind.
pub(crate) fn kind_section(kind: &str) -> Option<&'static Section> {
    FORMS.iter().find(|(name, _)| *name == kind).map(|(_, section)| *section)
}

pub(super) fn leak_all<T>(values: Vec<T>) -> &'static [T] {
    Box::leak(values.into_boxed_slice())
}

keys! {
    /// A fault, without the parameters of its kind and [`LastingKeys`].
    pub(crate) struct FaultKeys {
        id: At<String> = text(), required, "Name of the fault, unique in the scenario.";
        kind: At<String> = text(), required, KIND;
        trigger: At<TriggerKeys> = form::<TriggerKeys>(), required, TRIGGER;
    }
}

pub(super) const KIND: &str = "What happens: the name of a kind of fault.";
pub(super) const TRIGGER: &str = "When it sets in.";

keys! {
    /// A fault's duration, recovery and repetition.
    pub(crate) struct LastingKeys {
        duration: At<Option<Quantity>> = span(), absent("to the end of the run"),
            "How long it lasts, rounded to whole samples.";
        recovery: At<Option<Quantity>> = delay(), absent("none"),
            "How long it fades after that, down a straight line.";
        repeat: At<Option<RepeatKeys>> = repeat(),
            absent("once, or as often as a periodic or random trigger says"),
            "How often it comes back: so many times in all at this distance, or every time.";
    }
}

/// Keys of a kind of fault: the common ones, with the kind's parameters before the trigger.
pub(super) fn of_kind(
    common: &Section,
    name: &'static str,
    summary: &'static str,
    parameters: &'static [FaultParameter],
    lasts: Lasts,
) -> &'static Section {
    let mut keys = Vec::new();
    for key in common.keys {
        match key.name {
            "kind" => {
                let kind = Kind::Choice(leak_all(vec![(name, summary)]));
                keys.push(Key { kind, ..*key });
            }
            "trigger" => {
                keys.extend(parameters.iter().map(parameter));
                keys.push(*key);
            }
            _ => keys.push(*key),
        }
    }
    keys.extend(LastingKeys::SECTION.keys.iter().map(|key| lasting(key, lasts)));
    Box::leak(Box::new(Section { keys: leak_all(keys), one_of: false }))
}

/// One of [`LastingKeys`], for faults that last so.
fn lasting(key: &Key, lasts: Lasts) -> Key {
    let refused = |reason| Key {
        kind: Kind::Refused(reason),
        default: Default::Absent("none"),
        doc: "Not for this kind.",
        ..*key
    };
    match (key.name, lasts) {
        ("duration" | "recovery", Lasts::Instant) => refused("this kind is over in an instant"),
        ("recovery", Lasts::Span) => refused("this kind doesn't fade: it is there or it isn't"),
        ("recovery", Lasts::Fading) => Key { default: Default::Value("0 s"), ..*key },
        _ => *key,
    }
}

/// Key of a parameter of the catalogue.
fn parameter(parameter: &'static FaultParameter) -> Key {
    let dimensions = |all: &[catalogue::Dimension]| leak_all(all.iter().map(dimension).collect());
    let kind = match parameter.takes {
        Takes::Quantity(all, limits) => Kind::Quantity(dimensions(all), bounds(limits)),
        Takes::Vector(all) => Kind::Vector(dimensions(all)),
        Takes::Integer(from, to) => Kind::Integer(from, to),
        Takes::Flag => Kind::Boolean,
        Takes::Choice(choices) => Kind::Choice(choices),
        Takes::Channels => Kind::Channels,
        Takes::Number(limits) => Kind::Number(bounds(limits)),
        Takes::Value => Kind::Either(&VALUE),
        // The bounds are checked when the unit of the connection is known.
        Takes::Difference(_) => Kind::Limit,
    };
    let default = parameter.default.map_or(Default::Required, |text| {
        // A text stays a text even if it looks like another value: `nan`, `1`.
        let is_text = match parameter.takes {
            Takes::Quantity(..) | Takes::Choice(_) | Takes::Value => true,
            Takes::Channels => !text.starts_with('['),
            Takes::Vector(_)
            | Takes::Integer(..)
            | Takes::Flag
            | Takes::Number(_)
            | Takes::Difference(_) => false,
        };
        Default::Value(if is_text { format!("{text:?}").leak() } else { text })
    });
    key(parameter.name, kind, default, parameter.doc)
}

/// Kinds of a value that an input can have.
static VALUE: [Kind; 3] = [Kind::Text, Kind::Number(Bounds::Any), Kind::Boolean];

fn bounds(bounds: catalogue::ParameterBounds) -> Bounds {
    match bounds {
        catalogue::ParameterBounds::NotZero => Bounds::NotZero,
        catalogue::ParameterBounds::Any => Bounds::Any,
        catalogue::ParameterBounds::Positive => Bounds::Positive,
        catalogue::ParameterBounds::NotNegative => Bounds::NotNegative,
        catalogue::ParameterBounds::Within(from, to, words) => Bounds::Within(from, to, words),
    }
}

/// Dimension in scenarios of a dimension in the catalogue of faults.
#[must_use]
pub fn dimension(dimension: &catalogue::Dimension) -> UnitDimension {
    use catalogue::Dimension as Of;
    match dimension {
        Of::Time => UnitDimension::TIME,
        Of::Samples => UnitDimension::SAMPLES,
        Of::Frequency => UnitDimension::FREQUENCY,
        Of::Angle => UnitDimension::ANGLE,
        Of::SmallAngle => UnitDimension::SMALL_ANGLE,
        Of::AngularRate => UnitDimension::ANGULAR_RATE,
        Of::GyroBias => UnitDimension::GYRO_BIAS,
        Of::AngularAcceleration => UnitDimension::ANGULAR_ACCELERATION,
        Of::AngleRandomWalk => UnitDimension::ANGLE_RANDOM_WALK,
        Of::RateRandomWalk => UnitDimension::RATE_RANDOM_WALK,
        Of::GDependent => UnitDimension::G_DEPENDENT,
        Of::Length => UnitDimension::LENGTH,
        Of::Velocity => UnitDimension::VELOCITY,
        Of::Acceleration => UnitDimension::ACCELERATION,
        Of::AccelBias => UnitDimension::ACCEL_BIAS,
        Of::VelocityRandomWalk => UnitDimension::VELOCITY_RANDOM_WALK,
        Of::AccelRandomWalk => UnitDimension::ACCEL_RANDOM_WALK,
        Of::Ratio => UnitDimension::RATIO,
        Of::Temperature => UnitDimension::TEMPERATURE,
        Of::TemperatureRate => UnitDimension::TEMPERATURE_RATE,
        Of::GyroBiasPerK => UnitDimension::GYRO_BIAS_PER_K,
        Of::AccelBiasPerK => UnitDimension::ACCEL_BIAS_PER_K,
        Of::ScalePerK => UnitDimension::SCALE_PER_K,
        Of::AccelerationPsd => UnitDimension::ACCELERATION_PSD,
        Of::Voltage => UnitDimension::VOLTAGE,
    }
}

const SPAN: &[UnitDimension] = &[UnitDimension::TIME, UnitDimension::SAMPLES];

/// A time, or a number of samples, above 0.
const fn span() -> Of<Quantity> {
    Of::kind(Kind::Quantity(SPAN, Bounds::Positive))
}

/// A time, or a number of samples, from 0.
const fn delay() -> Of<Quantity> {
    Of::kind(Kind::Quantity(SPAN, Bounds::NotNegative))
}

const fn stop() -> Of<u16> {
    integer(1, u16::MAX as i64)
}

const fn phase() -> Of<Mode> {
    choice! {
        "calibration" => Mode::Calibrating, "that of the calibration";
        "navigation" => Mode::Navigating, "the rotation in navigation";
    }
}

/// Meaning of the number of a trigger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counted {
    /// Stops, over all passes.
    Stops,
    /// Positions, by their first visits.
    Positions,
}

const fn counted() -> Of<Counted> {
    choice! {
        "stops" => Counted::Stops, "stops of the sequence, over all passes";
        "positions" => Counted::Positions,
            "distinct directions of gravity in the body, by their first visits: the first stop there";
    }
}

const AFTER: &str = "How long after that.";
const PHASE: &str = "Which sequence is counted.";
const COUNTED: &str = "What the number counts.";
const STOPS: &str = "stops";
const FROM: &str = "Time of the run before which it waits.";
const UNTIL: &str = "Time of the run after which it sets in no more.";
const TO_THE_END: &str = "the end of the run";

forms! {
    /// `trigger` of a fault.
    pub(crate) enum TriggerKeys("trigger") {
        "at" => At(AtKeys);
        "sample" => Sample(SampleKeys);
        "position" => Position(PositionKeys);
        "moving_to" => MovingTo(MovingToKeys);
        "mode" => Mode(ModeKeys);
        "when" => When(WhenKeys);
        "every" => Every(EveryKeys);
        "poisson" => Poisson(PoissonKeys);
        "after_fault" => AfterFault(AfterFaultKeys);
        "manual" => Manual(ManualKeys);
    }
}

keys! {
    /// Trigger at a time.
    pub(crate) struct AtKeys {
        at: Quantity = delay(), required,
            "Time of the run: the first sample that it alters is that of the interval which begins then.";
    }
}

keys! {
    /// Trigger at a sample.
    pub(crate) struct SampleKeys {
        sample: u64 = integer(1, i64::MAX), required,
            "Number of the first sample that it alters, from 1.";
    }
}

keys! {
    /// Trigger at a position.
    pub(crate) struct PositionKeys {
        position: At<u16> = stop(), required,
            "The core arrives at this stop, counted from 1 over all passes.";
        after: Quantity = delay(), "0 s", AFTER;
        phase: Mode = phase(), "calibration", PHASE;
        counted: Option<Counted> = counted(), absent(STOPS), COUNTED;
    }
}

keys! {
    /// Trigger at the start of a move.
    pub(crate) struct MovingToKeys {
        moving_to: At<u16> = stop(), required,
            "The core sets out for this stop, counted from 1 over all passes.";
        after: Quantity = delay(), "0 s", AFTER;
        phase: Mode = phase(), "calibration", PHASE;
        counted: Option<Counted> = counted(), absent(STOPS), COUNTED;
    }
}

keys! {
    /// Trigger at a mode.
    pub(crate) struct ModeKeys {
        mode: Mode = choice! {
                "aligning" => Mode::Aligning, "it looks for its attitude";
                "calibrating" => Mode::Calibrating, "it turns through positions";
                "navigating" => Mode::Navigating, "it navigates";
            }, required, "The core enters this mode.";
        after: Quantity = delay(), "0 s", AFTER;
    }
}

keys! {
    /// Trigger by a condition.
    pub(crate) struct WhenKeys {
        when: At<String> = Of::<String>::kind(Kind::Condition), required,
            "A signal crosses a value.";
        after: Quantity = delay(), "0 s", AFTER;
    }
}

keys! {
    /// Periodic trigger.
    pub(crate) struct EveryKeys {
        every: At<Quantity> = span(), required, "Again and again, onsets so far apart.";
        from: Quantity = delay(), "0 s", FROM;
        until: At<Option<Quantity>> = span(), absent(TO_THE_END), UNTIL;
    }
}

keys! {
    /// Random trigger.
    pub(crate) struct PoissonKeys {
        poisson: Quantity
            = Of::<Quantity>::kind(Kind::Quantity(&[UnitDimension::TIME, UnitDimension::FREQUENCY], Bounds::Positive)),
            required,
            "At random: the mean time from its end to its next onset, or how often it comes a second.";
        from: Quantity = delay(), "0 s", FROM;
        until: At<Option<Quantity>> = span(), absent(TO_THE_END), UNTIL;
    }
}

keys! {
    /// Trigger after another fault.
    pub(crate) struct AfterFaultKeys {
        after_fault: String = text(), required, "The fault of this id has ended.";
        after: Quantity = delay(), "0 s", AFTER;
    }
}

keys! {
    /// Trigger by hand.
    pub(crate) struct ManualKeys {
        manual: At<bool> = boolean(), required, "By hand.";
        fire: Option<Vec<f64>> = Of::<Vec<f64>>::kind(Kind::Times),
            absent("only with `octant run --fire ID=TIME`"),
            "Times of the run at which it is fired; `octant run --fire ID=TIME` adds one.";
    }
}

/// Repetition of a fault.
#[derive(Clone, Debug)]
pub(crate) enum RepeatKeys {
    EveryTime,
    Times(TimesKeys),
}

forms! {
    /// A repetition that is a table.
    pub(crate) enum CountedKeys("repetition") {
        "times" => Times(TimesKeys);
    }
}

impl Value for RepeatKeys {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        Ok(CountedKeys::read(table, key)?.map(|CountedKeys::Times(keys)| Self::Times(keys)))
    }
}

const fn repeat() -> Of<RepeatKeys> {
    const EVERY_TIME: Kind =
        Kind::Choice(&[("every time", "whenever the trigger comes true again")]);
    Of::or_choice(
        const { Kind::Either(&[EVERY_TIME, Kind::Variants(CountedKeys::VARIANTS)]) },
        const { &[RepeatKeys::EveryTime] },
    )
}

keys! {
    /// Repetition so many times.
    pub(crate) struct TimesKeys {
        times: u32 = integer(2, u32::MAX as i64), required, "Onsets in all.";
        every: At<Quantity> = span(), required, "Distance of the onsets.";
    }
}

keys! {
    /// One of `[[operator]]`.
    pub(crate) struct OperatorKeys {
        id: String = text(), required, "Name of the step, unique in the scenario.";
        ask: String = text(), required, "What the person is asked, or is to do.";
        trigger: At<Option<TriggerKeys>> = form::<TriggerKeys>(),
            absent("before the start, before a port is opened or a table turns"),
            "When it is asked: at, sample, position, moving_to, mode or when.";
        answer: AnswerKind = choice! {
                "confirm" => AnswerKind::Confirm, "yes; a no ends the run";
                "yes-no" => AnswerKind::YesNo, "yes or no";
                "number" => AnswerKind::Number, "a number within its bounds";
                "text" => AnswerKind::Text, "a text";
                "choice" => AnswerKind::Choice, "one of its choices";
            }, "confirm", "What counts as an answer.";
        unit: Option<String> = text(), absent("none"), "Unit of a number, as the person reads it.";
        least: Option<f64> = number(Bounds::Any), absent("no bound"), "Least number.";
        most: Option<f64> = number(Bounds::Any), absent("no bound"), "Greatest number.";
        choices: Option<Vec<String>> = Of::<Vec<String>>::kind(Kind::Names), absent("none"), "Texts of a choice.";
        on_no: Option<OnNo> = choice! {
                "abort" => OnNo::Abort, "the run ends and is inconclusive";
                "ask-again" => OnNo::AskAgain, "the question stays open";
                "go-on" => OnNo::GoOn, "with yes-no alone: it is an answer as another";
            }, derived("confirm: abort; yes-no: go-on"), "What follows a no.";
        timeout: Option<f64> = si(&[UnitDimension::TIME], Bounds::Positive),
            absent("as long as it takes"), "How long the answer is waited for, in host time.";
        on_timeout: OnTimeout = choice! {
                "abort" => OnTimeout::Abort, "the run ends and is inconclusive";
                "wait" => OnTimeout::Wait, "it is recorded, and the question stays open";
            }, "abort", "What follows then. It never counts as a yes.";
        who: bool = choice! {
                "optional" => false, "a name may be given";
                "required" => true, "an answer without a name doesn't count";
            }, "optional", "Whether an answer needs the name of who gives it.";
        hold: bool = boolean(), "true",
            "Whether the run stands still while the question is open. Samples of an instrument, or by the clock, can't be stopped.";
    }
}
