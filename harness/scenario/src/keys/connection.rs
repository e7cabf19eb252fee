//! Keys of faults on connections of FMUs: a file of its own, or a part of a system structure.

use super::definition::{
    Default, KeyDefinition, KeyKind, SCHEMA, Section, Tag, Variants, key, section,
};
use super::faults::{
    AFTER, AFTER_FAULT, AT, EVERY, MANUAL, POISSON, SAMPLE, lasting, leak, leak_all, named,
    parameter,
};
use octant_faults::connection::kinds::{self, KINDS};
use std::sync::LazyLock;

/// A list of faults on connections.
pub static CONNECTIONS: Section = section(&[
    key("schema", KeyKind::Integer(SCHEMA, SCHEMA), Default::Required, "Version of the format: 1."),
    key(
        "faults",
        KeyKind::VariantTables(&FAULT, 10_000),
        Default::Absent("none"),
        "Faults, in the order in which they act on a connection.",
    ),
]);

static FAULT: Variants = Variants { tag: Tag::Value("kind"), forms: || &FORMS };

static FORMS: LazyLock<Vec<(&'static str, &'static Section)>> =
    LazyLock::new(|| KINDS.iter().map(|kind| (kind.name, leak(fault(kind)))).collect());

/// Keys of a kind.
pub fn connection_section(kind: &str) -> Option<&'static Section> {
    FORMS.iter().find(|(name, _)| *name == kind).map(|(_, section)| *section)
}

fn fault(kind: &'static kinds::ConnectionFaultKind) -> Section {
    let mut keys: Vec<KeyDefinition> = vec![
        key("id", KeyKind::Text, Default::Required, "Name of the fault, unique in the system."),
        named(kind.name, kind.summary),
        key(
            "connection",
            KeyKind::Text,
            Default::Required,
            "The input that it acts on, such as calibrator.gyro.delta_theta[1]; the name of an array \
             stands for all its elements.",
        ),
    ];
    keys.extend(kind.parameters.iter().map(parameter));
    keys.push(key("trigger", KeyKind::Variants(&TRIGGER), Default::Required, "When it sets in."));
    keys.extend(lasting(kind.lasts));
    Section { keys: leak_all(keys), one_of: false }
}

/// Forms of a trigger: those that need no core, and a condition on an output.
static TRIGGER: Variants = Variants {
    tag: Tag::Key("trigger"),
    forms: || {
        static FORMS: [(&str, &Section); 7] = [
            ("at", &AT),
            ("sample", &SAMPLE),
            ("when", &WHEN),
            ("every", &EVERY),
            ("poisson", &POISSON),
            ("after_fault", &AFTER_FAULT),
            ("manual", &MANUAL),
        ];
        &FORMS
    },
};

static WHEN: Section = section(&[
    key(
        "when",
        KeyKind::Text,
        Default::Required,
        "An output goes above or below a value: \"plant.truth.gimbal.roll above 45 deg\".",
    ),
    AFTER,
]);
