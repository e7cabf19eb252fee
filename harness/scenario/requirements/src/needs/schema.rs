//! The JSON schema of a need: types of extra fields, and fields of links.

use super::{LINKS, PARENT_NEEDS};
use octant_verdict::requirement::AttributeKind;
use serde_json::{Map, Value, json};

/// Schema of the needs of a version.
pub(super) struct NeedSchema<'a> {
    properties: Option<&'a Map<String, Value>>,
}

impl<'a> NeedSchema<'a> {
    pub(super) fn new(schema: &'a Value) -> Self {
        Self { properties: schema.get("properties").and_then(Value::as_object) }
    }

    pub(super) fn is_known(&self) -> bool {
        self.properties.is_some()
    }

    fn property(&self, field: &str) -> Option<&'a Value> {
        self.properties?.get(field)
    }

    fn field_type(&self, field: &str) -> Option<&'a str> {
        self.property(field)?.get("field_type")?.as_str()
    }

    /// True if the field has the ids of other needs.
    pub(super) fn is_links(&self, field: &str) -> bool {
        match self.field_type(field) {
            Some(of) => of == "links",
            None => field == LINKS || field == PARENT_NEEDS,
        }
    }

    /// True if the field is the other direction of a field of links.
    pub(super) fn is_backlinks(&self, field: &str) -> bool {
        match self.field_type(field) {
            Some(of) => of == "backlinks",
            None => field.ends_with("_back"),
        }
    }

    /// Values that needs without the field have.
    pub(super) fn defaults(&self) -> impl Iterator<Item = (&'a String, &'a Value)> {
        let all = self.properties.into_iter().flatten();
        all.filter_map(|(name, property)| Some((name, property.get("default")?)))
    }

    /// Kind of an extra field, if the schema has one.
    pub(super) fn kind(&self, field: &str) -> Option<AttributeKind> {
        let property = self.property(field)?;
        let options = |of: &Value| -> Option<Vec<String>> {
            let options = of.get("enum")?.as_array()?;
            options.iter().filter(|v| !v.is_null()).map(|v| v.as_str().map(str::to_owned)).collect()
        };
        if let Some(options) = options(property) {
            return Some(AttributeKind::Choice(options));
        }
        if let Some(options) = property.get("items").and_then(options) {
            return Some(AttributeKind::Choices(options));
        }
        let of = property.get("type")?;
        let is = |name: &str| match of {
            Value::Array(all) => all.iter().any(|one| one == name),
            one => one == name,
        };
        match property.get("format").and_then(Value::as_str) {
            Some("date" | "date-time") if is("string") => return Some(AttributeKind::Date),
            _ => {}
        }
        [
            ("boolean", AttributeKind::Boolean),
            ("integer", AttributeKind::Integer),
            ("number", AttributeKind::Real),
        ]
        .into_iter()
        .find(|(name, _)| is(name))
        .map(|(_, kind)| kind)
    }
}

/// Property of an extra field.
pub(super) fn property(kind: &AttributeKind, is_list: bool) -> Value {
    match kind {
        AttributeKind::Text if is_list => {
            json!({ "type": "array", "items": { "type": "string" }, "field_type": "extra" })
        }
        AttributeKind::Text => json!({ "type": ["string", "null"], "field_type": "extra" }),
        AttributeKind::Integer => json!({ "type": ["integer", "null"], "field_type": "extra" }),
        AttributeKind::Real => json!({ "type": ["number", "null"], "field_type": "extra" }),
        AttributeKind::Boolean => json!({ "type": ["boolean", "null"], "field_type": "extra" }),
        AttributeKind::Date => {
            json!({ "type": ["string", "null"], "format": "date", "field_type": "extra" })
        }
        AttributeKind::Choice(options) => {
            json!({ "type": ["string", "null"], "enum": options, "field_type": "extra" })
        }
        AttributeKind::Choices(options) => json!({
            "type": "array", "items": { "type": "string", "enum": options }, "field_type": "extra",
        }),
    }
}

/// Property of a field of links.
pub(super) fn links() -> Value {
    json!({ "type": "array", "items": { "type": "string" }, "default": [], "field_type": "links" })
}
