//! Definitions of messages of ROS: the texts of schemas `ros2msg` and `ros1msg`.

use std::collections::HashMap;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Primitive {
    Bool,
    Signed(usize),
    Unsigned(usize),
    Float32,
    Float64,
}

impl Primitive {
    pub(super) const fn size(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Signed(size) | Self::Unsigned(size) => size,
            Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Primitive(Primitive),
    Text,
    Message(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    One,
    Fixed(usize),
    Sequence,
}

#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) ty: Type,
    pub(super) shape: Shape,
}

/// Serialisation of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wire {
    /// ROS 2: plain CDR behind its encapsulation.
    Cdr,
    /// ROS 1: little-endian, without padding.
    Ros1,
}

/// Message definition with the definitions that it uses: the text of a schema.
#[derive(Debug)]
pub(super) struct Definition {
    pub(super) root: String,
    pub(super) messages: HashMap<String, Vec<Field>>,
    pub(super) wire: Wire,
}

impl Definition {
    /// Parses the text of a schema `ros2msg` or `ros1msg`. `name` is the name of the root, `package/msg/Name`.
    pub(super) fn parse(name: &str, text: &str, wire: Wire) -> Result<Self, String> {
        let root = short_name(name);
        let mut messages: HashMap<String, Vec<Field>> = HashMap::new();
        if wire == Wire::Ros1 {
            for (time, sec) in
                [("time", Primitive::Unsigned(4)), ("duration", Primitive::Signed(4))]
            {
                let part = |name: &str| Field {
                    name: name.into(),
                    ty: Type::Primitive(sec),
                    shape: Shape::One,
                };
                messages.insert(time.into(), vec![part("sec"), part("nsec")]);
            }
        }
        let mut current = root.clone();
        messages.insert(root.clone(), Vec::new());
        for (number, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or("").trim();
            if line.is_empty() || line.starts_with("===") {
                continue;
            }
            if let Some(next) = line.strip_prefix("MSG:") {
                current = short_name(next.trim());
                messages.entry(current.clone()).or_default();
                continue;
            }
            let package = current.split('/').next().unwrap_or("");
            if let Some(field) = parse_field(line, package, wire)
                .map_err(|reason| format!("schema {name} line {}: {reason}", number + 1))?
            {
                messages.entry(current.clone()).or_default().push(field);
            }
        }
        Ok(Self { root, messages, wire })
    }
}

/// Returns the name without `msg`: `package/msg/Name`, `package::msg::Name` and `package/Name` are the same.
pub(super) fn short_name(name: &str) -> String {
    name.replace("::", "/").replace("/msg/", "/")
}

/// Parses one line of a definition; `None` for a constant.
fn parse_field(line: &str, package: &str, wire: Wire) -> Result<Option<Field>, String> {
    let mut words = line.split_whitespace();
    let (Some(ty), Some(name)) = (words.next(), words.next()) else {
        return Err(format!("found {line:?}, expected a type and a name"));
    };
    if name.contains('=') || words.next().is_some_and(|word| word.starts_with('=')) {
        return Ok(None);
    }
    let (base, shape) = match ty.split_once('[') {
        None => (ty, Shape::One),
        Some((base, rest)) => match rest.strip_suffix(']') {
            Some("") => (base, Shape::Sequence),
            Some(bound) if bound.starts_with("<=") => (base, Shape::Sequence),
            Some(count) => match count.parse() {
                Ok(count) => (base, Shape::Fixed(count)),
                Err(_) => return Err(format!("found {ty:?}, expected a number between brackets")),
            },
            None => return Err(format!("found {ty:?}, expected a closing bracket")),
        },
    };
    use Primitive::{Bool, Float32, Float64, Signed, Unsigned};
    let ty = match base.split("<=").next().unwrap_or(base) {
        "bool" => Type::Primitive(Bool),
        "int8" => Type::Primitive(Signed(1)),
        "int16" => Type::Primitive(Signed(2)),
        "int32" => Type::Primitive(Signed(4)),
        "int64" => Type::Primitive(Signed(8)),
        "byte" if wire == Wire::Ros1 => Type::Primitive(Signed(1)),
        "time" | "duration" if wire == Wire::Ros1 => Type::Message(base.into()),
        "uint8" | "byte" | "char" => Type::Primitive(Unsigned(1)),
        "uint16" => Type::Primitive(Unsigned(2)),
        "uint32" => Type::Primitive(Unsigned(4)),
        "uint64" => Type::Primitive(Unsigned(8)),
        "float32" => Type::Primitive(Float32),
        "float64" => Type::Primitive(Float64),
        "string" => Type::Text,
        "wstring" => return Err("wstring can't be read".into()),
        "Header" => Type::Message("std_msgs/Header".into()),
        other if other.contains('/') => Type::Message(short_name(other)),
        other => Type::Message(format!("{package}/{other}")),
    };
    Ok(Some(Field { name: name.into(), ty, shape }))
}
