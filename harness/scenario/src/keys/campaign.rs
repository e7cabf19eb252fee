//! Keys of a campaign: its scenarios and their variations.

use super::definition::{Bounds, Default, Key, Kind, SCHEMA, Section, Tag, Variants, key, section};
use crate::quantity::Dimension;

/// Keys of a campaign.
pub static CAMPAIGN: Section = section(&[
    key("schema", Kind::Integer(SCHEMA, SCHEMA), Default::Required, "Version of the format."),
    key("title", Kind::Text, Default::Required, "Name of the campaign."),
    key(
        "seed",
        Kind::Integer(0, i64::MAX),
        Default::Value("1"),
        "Of what is drawn; the first replicate runs with it, the next with the next number.",
    ),
    key(
        "replicates",
        Kind::Integer(1, 1_000_000),
        Default::Value("1"),
        "Runs of every combination, each with a seed and draws of its own.",
    ),
    key(
        "requirements",
        Kind::Text,
        Default::Absent("those of the scenarios alone"),
        "File with the requirements, counted from the campaign's own folder.",
    ),
    key("scenarios", Kind::Tables(&SCENARIO, 1, 1000), Default::Required, "What is run."),
    key(
        "factors",
        Kind::VariantTables(&FACTORS, 100),
        Default::Absent("nothing is varied but seeds"),
        "What is varied, in every scenario.",
    ),
    key(
        "correlations",
        Kind::Tables(&CORRELATION, 0, 1000),
        Default::Absent("draws are independent"),
        "Draws that go together.",
    ),
    key("design", Kind::Choice(&DESIGNS), Default::Value("monte-carlo"), "How draws are spread."),
    key("limits", Kind::Table(&LIMITS), Default::Section, "What a case may use."),
    key("stop", Kind::Table(&STOP), Default::Absent("every case is run"), "When enough is known."),
]);

static SCENARIO: Section = section(&[
    key("id", Kind::Text, Default::Required, "Name, unique in the campaign."),
    key("file", Kind::Text, Default::Required, "File, counted from the campaign's own folder."),
    key(
        "set",
        Kind::Settings,
        Default::Absent("the scenario as it is"),
        "Keys of the scenario with other values, as --set has them.",
    ),
    key(
        "verifies",
        Kind::Names,
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

const NAME: Key =
    key("name", Kind::Text, Default::Required, "Name of the factor, unique in the campaign.");
const SET: Key = key(
    "key",
    Kind::Text,
    Default::Derived("the name"),
    "Key of the scenario that it sets, as in --set; faults.ID.KEY is one of a fault.",
);
const UNIT: Key = key(
    "unit",
    Kind::Text,
    Default::Absent("a plain number"),
    "Unit of the numbers, such as \"deg/h\".",
);

static GRID: Section = section(&[
    NAME,
    SET,
    key("values", Kind::Values, Default::Required, "Values: every one is run, as a grid."),
]);

static CHOOSE: Section = section(&[
    NAME,
    SET,
    key("choose", Kind::Values, Default::Required, "Values: one is drawn for each replicate."),
]);

static FAULTS: Section = section(&[
    NAME,
    key(
        "faults",
        Kind::Lists,
        Default::Required,
        "Lists of ids of the scenario's faults: those of the list are injected, the others left out.",
    ),
    key(
        "draw",
        Kind::Boolean,
        Default::Value("false"),
        "One list is drawn for each replicate, instead of every one run.",
    ),
]);

static UNIFORM: Section = section(&[
    NAME,
    SET,
    UNIT,
    key("uniform", Kind::Numbers(2), Default::Required, "Least and greatest value."),
]);

static NORMAL: Section = section(&[
    NAME,
    SET,
    UNIT,
    key("normal", Kind::Numbers(2), Default::Required, "Mean and standard deviation."),
    key(
        "within",
        Kind::Numbers(2),
        Default::Absent("not truncated"),
        "Least and greatest value: the distribution is truncated there.",
    ),
]);

static CORRELATION: Section = section(&[
    key("first", Kind::Text, Default::Required, "Name of a factor that is drawn."),
    key("second", Kind::Text, Default::Required, "Name of another."),
    key(
        "value",
        Kind::Number(Bounds::Within(-0.999, 0.999, "between -0.999 and 0.999")),
        Default::Required,
        "The correlation of the Gaussian copula that joins them: of normal factors their own.",
    ),
]);

static LIMITS: Section = section(&[
    key(
        "time",
        Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
        Default::Value("10 min"),
        "After which a case is ended as an error.",
    ),
    key(
        "memory_mib",
        Kind::Integer(64, 1_000_000),
        Default::Value("2048"),
        "Address space of a case, MiB; a case that wants more ends as an error. On Linux.",
    ),
]);

const PROBABILITY: Kind =
    Kind::Number(Bounds::Within(0.001, 0.999_999, "between 0.001 and 0.999999"));

static STOP: Section = section(&[
    key("requirement", Kind::Text, Default::Required, "Id of the requirement that decides."),
    key(
        "pass",
        PROBABILITY,
        Default::Value("0.95"),
        "It has to be kept with at least this probability.",
    ),
    key("confidence", PROBABILITY, Default::Value("0.95"), "With this confidence, one-sided."),
    key(
        "every",
        Kind::Integer(1, 1_000_000),
        Default::Value("20"),
        "After how many cases, in the order of the plan, it is looked at again.",
    ),
]);
