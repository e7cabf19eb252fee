//! Extracts numbers from foreign messages: JSON, and messages of ROS by their definition.
//!
//! A field is named by its path, such as `angular_velocity.x` or `axes[2].rate`.

use super::definition::Definition;

/// Number as the message holds it: integers stay exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    Integer(i128),
    Real(f64),
}

impl Number {
    pub(super) fn real(self) -> f64 {
        match self {
            Self::Integer(value) => value as f64,
            Self::Real(value) => value,
        }
    }
}

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Segment {
    pub(super) name: String,
    pub(super) index: Option<usize>,
}

/// Path to a field within a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FieldPath {
    pub(super) text: String,
    pub(super) segments: Vec<Segment>,
}

impl std::fmt::Display for FieldPath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl FieldPath {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let segments = text
            .split('.')
            .map(|part| {
                let (name, index) = match part.split_once('[') {
                    None => (part, None),
                    Some((name, rest)) => {
                        let index = rest
                            .strip_suffix(']')
                            .and_then(|index| index.parse().ok())
                            .ok_or_else(|| {
                                format!(
                                    "field path {text:?}: found {part:?}, expected name[number]"
                                )
                            })?;
                        (name, Some(index))
                    }
                };
                if name.is_empty() {
                    return Err(format!("field path {text:?}: a name between dots is missing"));
                }
                Ok(Segment { name: name.into(), index })
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self { text: text.into(), segments })
    }
}

/// Decodes the messages of one channel.
#[derive(Debug)]
pub(super) enum FieldDecoder {
    Json,
    Ros(Definition),
}

impl FieldDecoder {
    /// Returns the numbers at `paths`, in the same order.
    pub(super) fn numbers(&self, paths: &[FieldPath], data: &[u8]) -> Result<Vec<Number>, String> {
        match self {
            Self::Json => {
                let value: serde_json::Value =
                    serde_json::from_slice(data).map_err(|error| format!("not JSON: {error}"))?;
                paths.iter().map(|path| json_number(path, &value)).collect()
            }
            Self::Ros(definition) => definition.numbers(paths, data),
        }
    }
}

fn json_number(path: &FieldPath, value: &serde_json::Value) -> Result<Number, String> {
    let mut at = Some(value);
    for segment in &path.segments {
        at = at.and_then(|value| value.get(&segment.name));
        if let Some(index) = segment.index {
            at = at.and_then(|value| value.get(index));
        }
    }
    let found = at.ok_or_else(|| format!("field {} is missing", path.text))?;
    if let Some(integer) = found.as_i64() {
        return Ok(Number::Integer(integer.into()));
    }
    if let Some(integer) = found.as_u64() {
        return Ok(Number::Integer(integer.into()));
    }
    found
        .as_f64()
        .map(Number::Real)
        .ok_or_else(|| format!("field {} is {found}, expected a number", path.text))
}
