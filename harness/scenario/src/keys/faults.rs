//! Keys of faults: common keys, and the keys of each kind, made from the catalogue.

use super::definition::{
    Default, KeyBounds, KeyDefinition, KeyKind, Section, Tag, Variants, key, section,
};
use crate::quantity::UnitDimension;
use octant_faults::catalogue::{self, FaultParameter, Lasts, Takes};
use octant_faults::kinds;
use std::sync::LazyLock;

/// Keys of a fault, which depend on its kind.
pub(crate) static FAULT: Variants = Variants { tag: Tag::Value("kind"), forms: || &FORMS };

/// Keys of every kind. The catalogue is fixed at compile time, so they are made once and kept.
static FORMS: LazyLock<Vec<(&'static str, &'static Section)>> =
    LazyLock::new(|| kinds::all().map(|kind| (kind.name, leak(fault(kind)))).collect());

/// Keys of a kind.
pub(crate) fn kind_section(kind: &str) -> Option<&'static Section> {
    FORMS.iter().find(|(name, _)| *name == kind).map(|(_, section)| *section)
}

pub(super) fn leak<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

pub(super) fn leak_all<T>(values: Vec<T>) -> &'static [T] {
    Box::leak(values.into_boxed_slice())
}

fn fault(kind: &'static catalogue::FaultKind) -> Section {
    let mut keys = vec![
        key("id", KeyKind::Text, Default::Required, "Name of the fault, unique in the scenario."),
        named(kind.name, kind.summary),
    ];
    keys.extend(kind.parameters.iter().map(parameter));
    keys.push(key("trigger", KeyKind::Variants(&TRIGGER), Default::Required, "When it sets in."));
    keys.extend(lasting(kind.lasts));
    Section { keys: leak_all(keys), one_of: false }
}

/// The key `kind`, in the form of one kind.
pub(super) fn named(name: &'static str, summary: &'static str) -> KeyDefinition {
    key(
        "kind",
        KeyKind::Choice(leak_all(vec![(name, summary)])),
        Default::Required,
        "What happens: the name of a kind of fault.",
    )
}

/// Keys of a fault's duration, recovery and repetition.
pub(super) fn lasting(lasts: Lasts) -> [KeyDefinition; 3] {
    let duration = match lasts {
        Lasts::Instant => refused("duration", "this kind is over in an instant"),
        Lasts::Span | Lasts::Fading => key(
            "duration",
            SPAN,
            Default::Absent("to the end of the run"),
            "How long it lasts, rounded to whole samples.",
        ),
    };
    let recovery = match lasts {
        Lasts::Fading => key(
            "recovery",
            KeyKind::Quantity(
                &[UnitDimension::TIME, UnitDimension::SAMPLES],
                KeyBounds::NotNegative,
            ),
            Default::Value("0 s"),
            "How long it fades after that, down a straight line.",
        ),
        Lasts::Span => refused("recovery", "this kind doesn't fade: it is there or it isn't"),
        Lasts::Instant => refused("recovery", "this kind is over in an instant"),
    };
    let repeat = key(
        "repeat",
        KeyKind::Either(&OFTEN),
        Default::Absent("once, or as often as a periodic or random trigger says"),
        "How often it comes back: so many times in all at this distance, or every time.",
    );
    [duration, recovery, repeat]
}

const fn refused(name: &'static str, reason: &'static str) -> KeyDefinition {
    key(name, KeyKind::Refused(reason), Default::Absent("none"), "Not for this kind.")
}

/// Key of a parameter of the catalogue.
pub(super) fn parameter(parameter: &'static FaultParameter) -> KeyDefinition {
    let dimensions = |all: &[catalogue::Dimension]| leak_all(all.iter().map(dimension).collect());
    let kind = match parameter.takes {
        Takes::Quantity(all, limits) => KeyKind::Quantity(dimensions(all), bounds(limits)),
        Takes::Vector(all) => KeyKind::Vector(dimensions(all)),
        Takes::Integer(from, to) => KeyKind::Integer(from, to),
        Takes::Flag => KeyKind::Boolean,
        Takes::Choice(choices) => KeyKind::Choice(choices),
        Takes::Channels => KeyKind::Channels,
        Takes::Number(limits) => KeyKind::Number(bounds(limits)),
        Takes::Value => KeyKind::Either(&VALUE),
        // The bounds are checked when the unit of the connection is known.
        Takes::Difference(_) => KeyKind::Limit,
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
static VALUE: [KeyKind; 3] = [KeyKind::Text, KeyKind::Number(KeyBounds::Any), KeyKind::Boolean];

fn bounds(bounds: catalogue::ParameterBounds) -> KeyBounds {
    match bounds {
        catalogue::ParameterBounds::NotZero => KeyBounds::NotZero,
        catalogue::ParameterBounds::Any => KeyBounds::Any,
        catalogue::ParameterBounds::Positive => KeyBounds::Positive,
        catalogue::ParameterBounds::NotNegative => KeyBounds::NotNegative,
        catalogue::ParameterBounds::Within(from, to, words) => KeyBounds::Within(from, to, words),
    }
}

/// Scenario dimension of a dimension in the catalogue.
pub(crate) fn dimension(dimension: &catalogue::Dimension) -> UnitDimension {
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
    }
}

const SPAN: KeyKind =
    KeyKind::Quantity(&[UnitDimension::TIME, UnitDimension::SAMPLES], KeyBounds::Positive);
/// Kind of a delay: a time, or a number of samples, from 0.
const DELAY: KeyKind =
    KeyKind::Quantity(&[UnitDimension::TIME, UnitDimension::SAMPLES], KeyBounds::NotNegative);
pub(super) const AFTER: KeyDefinition =
    key("after", DELAY, Default::Value("0 s"), "How long after that.");
const STOP: KeyKind = KeyKind::Integer(1, u16::MAX as i64);
const PHASE: KeyDefinition = key(
    "phase",
    KeyKind::Choice(&[
        ("calibration", "the positions of the calibration"),
        ("navigation", "those of the rotation in navigation"),
    ]),
    Default::Value("calibration"),
    "Which positions are counted.",
);
const FROM: KeyDefinition =
    key("from", DELAY, Default::Value("0 s"), "Time of the run before which it waits.");
const UNTIL: KeyDefinition = key(
    "until",
    SPAN,
    Default::Absent("the end of the run"),
    "Time of the run after which it sets in no more.",
);

/// Forms of a trigger.
pub(super) static TRIGGER: Variants = Variants {
    tag: Tag::Key("trigger"),
    forms: || {
        static FORMS: [(&str, &Section); 10] = [
            ("at", &AT),
            ("sample", &SAMPLE),
            ("position", &POSITION),
            ("moving_to", &MOVING_TO),
            ("mode", &MODE),
            ("when", &WHEN),
            ("every", &EVERY),
            ("poisson", &POISSON),
            ("after_fault", &AFTER_FAULT),
            ("manual", &MANUAL),
        ];
        &FORMS
    },
};

pub(super) static AT: Section = section(&[key(
    "at",
    DELAY,
    Default::Required,
    "Time of the run: the first sample that it alters is that of the interval which begins then.",
)]);
pub(super) static SAMPLE: Section = section(&[key(
    "sample",
    KeyKind::Integer(1, i64::MAX),
    Default::Required,
    "Number of the first sample that it alters, from 1.",
)]);
static POSITION: Section = section(&[
    key(
        "position",
        STOP,
        Default::Required,
        "The core arrives at this position, counted from 1 over all passes.",
    ),
    AFTER,
    PHASE,
]);
static MOVING_TO: Section = section(&[
    key(
        "moving_to",
        STOP,
        Default::Required,
        "The core sets out for this position, counted from 1 over all passes.",
    ),
    AFTER,
    PHASE,
]);
static MODE: Section = section(&[
    key(
        "mode",
        KeyKind::Choice(&[
            ("aligning", "it looks for its attitude"),
            ("calibrating", "it turns through positions"),
            ("navigating", "it navigates"),
        ]),
        Default::Required,
        "The core enters this mode.",
    ),
    AFTER,
]);
static WHEN: Section = section(&[
    key("when", KeyKind::Condition, Default::Required, "A signal crosses a value."),
    AFTER,
]);
pub(super) static EVERY: Section = section(&[
    key("every", SPAN, Default::Required, "Again and again, onsets so far apart."),
    FROM,
    UNTIL,
]);
pub(super) static POISSON: Section = section(&[
    key(
        "poisson",
        KeyKind::Quantity(&[UnitDimension::TIME, UnitDimension::FREQUENCY], KeyBounds::Positive),
        Default::Required,
        "At random: the mean time from its end to its next onset, or how often it comes a second.",
    ),
    FROM,
    UNTIL,
]);
pub(super) static AFTER_FAULT: Section = section(&[
    key("after_fault", KeyKind::Text, Default::Required, "The fault of this id has ended."),
    AFTER,
]);
pub(super) static MANUAL: Section = section(&[
    key("manual", KeyKind::Boolean, Default::Required, "By hand."),
    key(
        "fire",
        KeyKind::Times,
        Default::Absent("only with `octant run --fire ID=TIME`"),
        "Times of the run at which it is fired; `octant run --fire ID=TIME` adds one.",
    ),
]);

static OFTEN: [KeyKind; 2] = [
    KeyKind::Choice(&[("every time", "whenever the trigger comes true again")]),
    KeyKind::Variants(&REPEAT),
];

/// Forms of a repetition.
static REPEAT: Variants = Variants {
    tag: Tag::Key("repetition"),
    forms: || {
        static FORMS: [(&str, &Section); 1] = [("times", &TIMES)];
        &FORMS
    },
};

static TIMES: Section = section(&[
    key("times", KeyKind::Integer(2, u32::MAX as i64), Default::Required, "Onsets in all."),
    key("every", SPAN, Default::Required, "Distance of the onsets."),
]);
