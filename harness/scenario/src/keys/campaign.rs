//! Keys of a campaign: its scenarios and their variations.

use super::definition::{
    Default, KeyBounds, KeyDefinition, KeyKind, SCHEMA, Section, Tag, Variants, key, section,
};
use crate::quantity::UnitDimension;

/// Keys of a campaign.
pub static CAMPAIGN: Section = section(&[
    key("schema", KeyKind::Integer(SCHEMA, SCHEMA), Default::Required, "Version of the format."),
    key("title", KeyKind::Text, Default::Required, "Name of the campaign."),
    key(
        "seed",
        KeyKind::Integer(0, i64::MAX),
        Default::Value("1"),
        "Of what is drawn; the first replicate runs with it, the next with the next number.",
    ),
    key(
        "replicates",
        KeyKind::Integer(1, 1_000_000),
        Default::Value("1"),
        "Runs of every combination, each with a seed and draws of its own.",
    ),
    key(
        "requirements",
        KeyKind::Text,
        Default::Absent("those of the scenarios alone"),
        "File with the requirements, counted from the campaign's own folder.",
    ),
    key("scenarios", KeyKind::Tables(&SCENARIO, 1, 1000), Default::Required, "What is run."),
    key(
        "factors",
        KeyKind::VariantTables(&FACTORS, 100),
        Default::Absent("nothing is varied but seeds"),
        "What is varied, in every scenario.",
    ),
    key(
        "correlations",
        KeyKind::Tables(&CORRELATION, 0, 1000),
        Default::Absent("draws are independent"),
        "Draws that go together.",
    ),
    key(
        "design",
        KeyKind::Choice(&DESIGNS),
        Default::Value("monte-carlo"),
        "How draws are spread.",
    ),
    key("limits", KeyKind::Table(&LIMITS), Default::Section, "What a case may use."),
    key(
        "stop",
        KeyKind::Table(&STOP),
        Default::Absent("every case is run"),
        "When enough is known.",
    ),
]);

static SCENARIO: Section = section(&[
    key("id", KeyKind::Text, Default::Required, "Name, unique in the campaign."),
    key("file", KeyKind::Text, Default::Required, "File, counted from the campaign's own folder."),
    key(
        "set",
        KeyKind::Settings,
        Default::Absent("the scenario as it is"),
        "Keys of the scenario with other values, as --set has them.",
    ),
    key(
        "verifies",
        KeyKind::Names,
        Default::Absent("all that are verified by test"),
        "Ids of the requirements of the campaign's file that its cases check.",
    ),
]);

const DESIGNS: [(&str, &str); 2] = [
    ("monte-carlo", "each draw for itself: more replicates leave the cases that there are"),
    (
        "latin-hypercube",
        "one draw in each of as many strips as there are replicates: another number of replicates \
         is another design",
    ),
];

static FACTORS: Variants = Variants { tag: Tag::Key("values of the factor"), forms: factor_forms };

fn factor_forms() -> &'static [(&'static str, &'static Section)] {
    static FORMS: [(&str, &Section); 5] = [
        ("values", &GRID),
        ("choose", &CHOOSE),
        ("faults", &FAULTS),
        ("uniform", &UNIFORM),
        ("normal", &NORMAL),
    ];
    &FORMS
}

const NAME: KeyDefinition =
    key("name", KeyKind::Text, Default::Required, "Name of the factor, unique in the campaign.");
const SET: KeyDefinition = key(
    "key",
    KeyKind::Text,
    Default::Derived("the name"),
    "Key of the scenario that it sets, as in --set; faults.ID.KEY is one of a fault.",
);
const UNIT: KeyDefinition = key(
    "unit",
    KeyKind::Text,
    Default::Absent("a plain number"),
    "Unit of the numbers, such as \"deg/h\".",
);

static GRID: Section = section(&[
    NAME,
    SET,
    key("values", KeyKind::Values, Default::Required, "Values: every one is run, as a grid."),
]);

static CHOOSE: Section = section(&[
    NAME,
    SET,
    key("choose", KeyKind::Values, Default::Required, "Values: one is drawn for each replicate."),
]);

static FAULTS: Section = section(&[
    NAME,
    key(
        "faults",
        KeyKind::Lists,
        Default::Required,
        "Lists of ids of the scenario's faults: those of the list are injected, the others left out.",
    ),
    key(
        "draw",
        KeyKind::Boolean,
        Default::Value("false"),
        "One list is drawn for each replicate, instead of every one run.",
    ),
]);

static UNIFORM: Section = section(&[
    NAME,
    SET,
    UNIT,
    key("uniform", KeyKind::Numbers(2), Default::Required, "Least and greatest value."),
]);

static NORMAL: Section = section(&[
    NAME,
    SET,
    UNIT,
    key("normal", KeyKind::Numbers(2), Default::Required, "Mean and standard deviation."),
    key(
        "within",
        KeyKind::Numbers(2),
        Default::Absent("not truncated"),
        "Least and greatest value: the distribution is truncated there.",
    ),
]);

static CORRELATION: Section = section(&[
    key("first", KeyKind::Text, Default::Required, "Name of a factor that is drawn."),
    key("second", KeyKind::Text, Default::Required, "Name of another."),
    key(
        "value",
        KeyKind::Number(KeyBounds::Within(-0.999, 0.999, "between -0.999 and 0.999")),
        Default::Required,
        "The correlation of the Gaussian copula that joins them: of normal factors their own.",
    ),
]);

static LIMITS: Section = section(&[
    key(
        "time",
        KeyKind::Quantity(&[UnitDimension::TIME], KeyBounds::Positive),
        Default::Value("10 min"),
        "After which a case is ended as an error.",
    ),
    key(
        "memory_mib",
        KeyKind::Integer(64, 1_000_000),
        Default::Value("2048"),
        "Address space of a case, MiB; a case that wants more ends as an error. On Linux.",
    ),
]);

const PROBABILITY: KeyKind =
    KeyKind::Number(KeyBounds::Within(0.001, 0.999_999, "between 0.001 and 0.999999"));

static STOP: Section = section(&[
    key("requirement", KeyKind::Text, Default::Required, "Id of the requirement that decides."),
    key(
        "pass",
        PROBABILITY,
        Default::Value("0.95"),
        "It has to be kept with at least this probability.",
    ),
    key("confidence", PROBABILITY, Default::Value("0.95"), "With this confidence, one-sided."),
    key(
        "every",
        KeyKind::Integer(1, 1_000_000),
        Default::Value("20"),
        "After how many cases, in the order of the plan, it is looked at again.",
    ),
]);
