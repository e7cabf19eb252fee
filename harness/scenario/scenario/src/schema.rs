//! JSON Schema of the scenario, made from the table of keys: for completion in editors.

use super::complete::expected;
use super::keys::{
    Bounds, Default, Key, Kind, SCENARIO, SCHEMA, Section, Variants, cases_in_words,
};
use super::quantity::UnitDimension;
use crate::channel::Channel;
use octant_toml_tree::parse_default;
use serde_json::{Map, Value, json};

/// A number followed by a unit.
const QUANTITY: &str =
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s+\S.*|\s*[^0-9\s.eE+-].*)$";

/// JSON Schema (draft 2020-12) of scenario files.
#[must_use]
pub fn schema() -> Value {
    let mut schema = object(SCENARIO);
    if let Value::Object(root) = &mut schema {
        root.insert("$schema".into(), json!("https://json-schema.org/draft/2020-12/schema"));
        root.insert("title".into(), json!(format!("Octant scenario, version {SCHEMA}")));
    }
    schema
}

fn object(section: &Section) -> Value {
    let possible = || section.keys.iter().filter(|key| !matches!(key.kind, Kind::Refused(_)));
    let properties: Map<String, Value> =
        possible().map(|key| (key.name.to_owned(), property(key))).collect();
    let required: Vec<&str> = possible()
        .filter(|key| matches!(key.default, Default::Required))
        .map(|key| key.name)
        .collect();
    let mut object = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    });
    if !required.is_empty() {
        object["required"] = json!(required);
    }
    if section.one_of {
        object["minProperties"] = json!(1);
        object["maxProperties"] = json!(1);
    }
    object
}

fn property(key: &Key) -> Value {
    let mut property = kind(&key.kind);
    let mut description = format!("{} Takes {}.", key.doc, expected(&key.kind));
    match key.default {
        Default::Value(text) => {
            let default = octant_toml_tree::json(&parse_default(text).value);
            property["default"] = default;
        }
        Default::Derived(words) => description += &format!(" Default: {words}."),
        Default::ByCase(cases) => {
            description += &format!(" Default: {}.", cases_in_words(cases));
        }
        Default::Absent(words) => description += &format!(" Left out: {words}."),
        Default::Required | Default::Section => {}
    }
    property["description"] = json!(description);
    property
}

fn kind(kind: &Kind) -> Value {
    match kind {
        Kind::Text => json!({ "type": "string" }),
        Kind::Uri(schemes) => {
            let names: Vec<&str> = schemes.iter().map(|(name, _)| *name).collect();
            json!({ "type": "string", "pattern": format!("^({})(:.+)?$", names.join("|")) })
        }
        Kind::Choice(choices) => {
            json!({ "enum": choices.iter().map(|(name, _)| *name).collect::<Vec<_>>() })
        }
        Kind::Choices(choices) => json!({ "type": "array", "items": { "enum": choices } }),
        Kind::Boolean => json!({ "type": "boolean" }),
        Kind::Integer(from, to) => {
            json!({ "type": "integer", "minimum": from, "maximum": to })
        }
        Kind::Number(bounds) => match bounds {
            // Bounds that schemas of numbers can't express briefly are left to the program.
            Bounds::Any | Bounds::NotZero => json!({ "type": "number" }),
            Bounds::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
            Bounds::NotNegative => json!({ "type": "number", "minimum": 0 }),
            Bounds::Within(from, to, _) => {
                json!({ "type": "number", "minimum": from, "maximum": to })
            }
        },
        Kind::Numbers(count) => {
            json!({ "type": "array", "items": { "type": "number" }, "minItems": count, "maxItems": count })
        }
        Kind::Quantity(dimensions, _) => quantity(dimensions),
        Kind::Quantities(dimension, count) => {
            let items = quantity(&[*dimension]);
            json!({ "type": "array", "items": items, "minItems": count, "maxItems": count })
        }
        Kind::Vector(dimensions) => {
            json!({ "type": "array", "items": quantity(dimensions), "minItems": 3, "maxItems": 3 })
        }
        Kind::Times => json!({ "type": "array", "items": quantity(&[UnitDimension::TIME]) }),
        Kind::Condition => {
            json!({ "type": "string", "examples": [crate::condition::EXAMPLE] })
        }
        Kind::Channels => {
            let names = octant_faults::Channels::NAMES.map(|(name, _)| name);
            let one = json!({ "enum": names });
            json!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1 }] })
        }
        Kind::Limit => json!({ "anyOf": [{ "type": "number" }, quantity(&[])] }),
        Kind::Column => {
            json!({ "anyOf": [{ "type": "integer", "minimum": 1 }, { "type": "string" }] })
        }
        Kind::Port(channel) => port(channel),
        Kind::Settings => json!({ "type": "object" }),
        Kind::Values => json!({ "type": "array", "minItems": 1 }),
        Kind::Names => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::Lists => {
            let names = json!({ "type": "array", "items": { "type": "string" } });
            json!({ "type": "array", "items": names, "minItems": 1 })
        }
        Kind::Codes => {
            let one = json!({ "anyOf": [{ "type": "integer" }, { "type": "string" }] });
            json!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1 }] })
        }
        Kind::Table(section) => object(section),
        Kind::Tables(section, at_least, at_most) => {
            json!({ "type": "array", "items": object(section), "minItems": at_least, "maxItems": at_most })
        }
        Kind::Variants(variants) => one_of(variants),
        Kind::VariantTables(variants, at_most) => {
            json!({ "type": "array", "items": one_of(variants), "maxItems": at_most })
        }
        Kind::Either(kinds) => json!({ "anyOf": kinds.iter().map(self::kind).collect::<Vec<_>>() }),
        // Never used as a property: only the check knows such a key.
        Kind::Refused(_) => json!(false),
    }
}

/// Schema with one object for each form.
fn one_of(variants: &Variants) -> Value {
    json!({ "oneOf": (variants.forms)().iter().map(|(_, form)| object(form)).collect::<Vec<_>>() })
}

/// Schema of a port: a name or a table, or one of them for each element.
fn port(channel: &Channel) -> Value {
    let text = json!({ "type": "string" });
    let one = json!({ "anyOf": [text, {
        "type": "object",
        "additionalProperties": false,
        "minProperties": 1,
        "properties": {
            "variable": text,
            "unit": text,
            "scale": { "type": "number" },
            "constant": { "type": ["string", "number", "boolean"] },
        },
    }] });
    let count = channel.elements;
    let each = json!({ "type": "array", "items": one, "minItems": count, "maxItems": count });
    json!({ "anyOf": [one, each] })
}

fn quantity(dimensions: &[UnitDimension]) -> Value {
    let mut quantity = json!({ "type": "string", "pattern": QUANTITY });
    if !dimensions.is_empty() {
        let examples: Vec<&str> = dimensions.iter().map(|d| d.example).collect();
        quantity["examples"] = json!(examples);
    }
    quantity
}
