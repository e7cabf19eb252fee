//! Keys of what is said of a system of FMUs, in a file of its own or in a part of its structure: faults on connections, and
//! requirements.

use super::definition::{Key, Kind, SCHEMA, Section, Tag, Variants};
use super::faults::{KIND, TRIGGER, TriggerKeys, WhenKeys, leak_all, of_kind};
use super::run::RequirementKeys;
use super::table::{At, Forms, Keys, Of, Raw, integer, keys, tables, text};
use octant_faults::connection::kinds::{self, KINDS};
use std::sync::LazyLock;

keys! {
    /// A list of faults on connections.
    pub(crate) struct ConnectionsKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format: 1.";
        faults: Option<Vec<Raw>> = Of::<Vec<Raw>>::kind(Kind::VariantTables(&FAULT, 10_000)), absent("none"),
            "Faults, in the order in which they act on a connection.";
    }
}

static FAULT: Variants = Variants { tag: Tag::Value("kind"), forms: || &FORMS };

static FORMS: LazyLock<Vec<(&'static str, &'static Section)>> = LazyLock::new(|| {
    let form = |kind: &&'static kinds::ConnectionFaultKind| {
        let common = ConnectionFaultKeys::SECTION;
        (kind.name, of_kind(common, kind.name, kind.summary, kind.parameters, kind.lasts))
    };
    KINDS.iter().map(form).collect()
});

/// Keys of a kind.
pub(crate) fn connection_section(kind: &str) -> Option<&'static Section> {
    FORMS.iter().find(|(name, _)| *name == kind).map(|(_, section)| *section)
}

keys! {
    /// A fault on a connection, without the parameters of its kind and [`LastingKeys`](super::LastingKeys).
    pub(crate) struct ConnectionFaultKeys {
        id: At<String> = text(), required, "Name of the fault, unique in the system.";
        kind: At<String> = text(), required, KIND;
        connection: String = text(), required,
            "The input that it acts on, such as calibrator.gyro.delta_theta[1]; the name of an array \
             stands for all its elements.";
        trigger: At<TriggerKeys> = Of::<TriggerKeys>::kind(Kind::Variants(&TRIGGERS)), required, TRIGGER;
    }
}

/// Forms of a trigger: those that need no core, and a condition on an output.
static TRIGGERS: Variants = Variants { tag: Tag::Key("trigger"), forms: || &TRIGGER_FORMS };

static TRIGGER_FORMS: LazyLock<Vec<(&'static str, &'static Section)>> = LazyLock::new(|| {
    let form = |(name, section): &(&'static str, &'static Section)| match *name {
        "position" | "moving_to" | "mode" => None,
        "when" => Some((*name, &WHEN as &'static Section)),
        _ => Some((*name, *section)),
    };
    (TriggerKeys::VARIANTS.forms)().iter().filter_map(form).collect()
});

static WHEN: LazyLock<Section> = LazyLock::new(|| {
    let on_output = |key: &Key| match key.name {
        "when" => Key {
            kind: Kind::Text,
            doc: "An output goes above or below a value: \"plant.truth.gimbal.roll above 45 deg\".",
            ..*key
        },
        _ => *key,
    };
    let keys = WhenKeys::SECTION.keys.iter().map(on_output).collect();
    Section { keys: leak_all(keys), one_of: false }
});

keys! {
    /// A list of requirements on a system.
    pub(crate) struct SystemRequirementsKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format: 1.";
        requirements: Option<Vec<RequirementKeys>>
            = tables::<RequirementKeys>(0, 10_000), absent("none"),
            "Limits that signals of the system have to keep.";
    }
}
