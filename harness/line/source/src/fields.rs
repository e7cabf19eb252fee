//! Extracts numbers from foreign messages: JSON, and ROS 2 CDR by its message definition.
//!
//! A field is named by its path, such as `angular_velocity.x` or `axes[2].rate`.

use std::collections::HashMap;

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
struct Segment {
    name: String,
    index: Option<usize>,
}

/// Path to a field within a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FieldPath {
    text: String,
    segments: Vec<Segment>,
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
    Cdr(Definition),
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
            Self::Cdr(definition) => definition.numbers(paths, data),
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Primitive {
    Bool,
    Signed(usize),
    Unsigned(usize),
    Float32,
    Float64,
}

impl Primitive {
    const fn size(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Signed(size) | Self::Unsigned(size) => size,
            Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Type {
    Primitive(Primitive),
    Text,
    Message(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    One,
    Fixed(usize),
    Sequence,
}

#[derive(Clone, Debug)]
struct Field {
    name: String,
    ty: Type,
    shape: Shape,
}

/// Message definition with the definitions that it uses: the text of a `ros2msg` schema.
#[derive(Debug)]
pub(super) struct Definition {
    root: String,
    messages: HashMap<String, Vec<Field>>,
}

/// Maximum number of fields visited in one message: a definition with more was made to hang a
/// reader.
const NODES_MAX: usize = 1 << 20;
/// Maximum nesting depth of messages.
const DEPTH_MAX: usize = 32;

impl Definition {
    /// Parses the text of a schema. `name` is the name of the root, `package/msg/Name`.
    pub(super) fn parse(name: &str, text: &str) -> Result<Self, String> {
        let root = short_name(name);
        let mut messages: HashMap<String, Vec<Field>> = HashMap::new();
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
            if let Some(field) = parse_field(line, package)
                .map_err(|reason| format!("schema {name} line {}: {reason}", number + 1))?
            {
                messages.entry(current.clone()).or_default().push(field);
            }
        }
        Ok(Self { root, messages })
    }

    fn numbers(&self, paths: &[FieldPath], data: &[u8]) -> Result<Vec<Number>, String> {
        let big_endian = match data.get(..2) {
            Some([0, 0]) => true,
            Some([0, 1]) => false,
            other => return Err(format!("message begins with {other:02x?}, expected plain CDR")),
        };
        let mut walk = Walk {
            definition: self,
            paths,
            bytes: data.get(4..).unwrap_or(&[]),
            at: 0,
            big_endian,
            nodes: 0,
            found: vec![None; paths.len()],
        };
        let all = (1u64 << paths.len().min(63)) - 1;
        walk.message(&self.root, all, 0)?;
        walk.found
            .into_iter()
            .zip(paths)
            .map(|(found, path)| found.ok_or_else(|| format!("field {} is missing", path.text)))
            .collect()
    }
}

/// Returns the name without `msg`: `package/msg/Name` and `package/Name` are the same.
fn short_name(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Parses one line of a definition; `None` for a constant.
fn parse_field(line: &str, package: &str) -> Result<Option<Field>, String> {
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

/// One pass over one message.
struct Walk<'a> {
    definition: &'a Definition,
    paths: &'a [FieldPath],
    /// Message after its encapsulation header; alignment counts from here.
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    nodes: usize,
    found: Vec<Option<Number>>,
}

impl Walk<'_> {
    /// Walks a message. `active` has one bit for each path that leads into it.
    fn message(&mut self, name: &str, active: u64, depth: usize) -> Result<(), String> {
        if depth >= DEPTH_MAX {
            return Err(format!("more than {DEPTH_MAX} messages in messages"));
        }
        let definition = self.definition;
        let fields = definition
            .messages
            .get(name)
            .ok_or_else(|| format!("the schema has no definition of {name}"))?;
        if fields.is_empty() {
            // ROS 2 encodes an empty message as one byte.
            self.take(1, 1)?;
        }
        for field in fields {
            let named = self.matching(active, |path| {
                path.segments.get(depth).is_some_and(|segment| segment.name == field.name)
            });
            let count = match field.shape {
                Shape::One => {
                    let inside = self.matching(named, |path| path.segments[depth].index.is_none());
                    self.element(&field.ty, inside, depth)?;
                    continue;
                }
                Shape::Fixed(count) => count,
                Shape::Sequence => {
                    let length = self.take(4, 4)?;
                    u64::from_le_bytes(length) as usize
                }
            };
            for index in 0..count {
                let inside = self.matching(named, |path| path.segments[depth].index == Some(index));
                self.element(&field.ty, inside, depth)?;
            }
        }
        Ok(())
    }

    fn element(&mut self, ty: &Type, active: u64, depth: usize) -> Result<(), String> {
        self.nodes += 1;
        if self.nodes > NODES_MAX {
            return Err(format!("more than {NODES_MAX} fields in one message"));
        }
        match ty {
            Type::Message(name) => self.message(name, active, depth + 1),
            Type::Text => {
                let length = self.take(4, 4)?;
                let length = u64::from_le_bytes(length) as usize;
                self.take(1, length).map(|_| ())
            }
            Type::Primitive(primitive) => {
                let number = self.number(*primitive)?;
                for (bit, path) in self.paths.iter().enumerate() {
                    if active & (1 << bit) != 0 && path.segments.len() == depth + 1 {
                        self.found[bit] = Some(number);
                    }
                }
                Ok(())
            }
        }
    }

    fn matching(&self, active: u64, keep: impl Fn(&FieldPath) -> bool) -> u64 {
        if active == 0 {
            return 0;
        }
        self.paths
            .iter()
            .enumerate()
            .filter(|(bit, path)| active & (1 << bit) != 0 && keep(path))
            .fold(0, |mask, (bit, _)| mask | (1 << bit))
    }

    fn number(&mut self, primitive: Primitive) -> Result<Number, String> {
        let size = primitive.size();
        let bytes = self.take(size, size)?;
        let bits = u64::from_le_bytes(bytes);
        Ok(match primitive {
            Primitive::Bool | Primitive::Unsigned(_) => Number::Integer(bits.into()),
            Primitive::Signed(size) => {
                let shift = 64 - 8 * size as u32;
                Number::Integer((((bits << shift) as i64) >> shift).into())
            }
            Primitive::Float32 => Number::Real(f32::from_bits(bits as u32).into()),
            Primitive::Float64 => Number::Real(f64::from_bits(bits)),
        })
    }

    /// Reads the next `size` bytes after alignment; returns the first eight, least significant
    /// first.
    fn take(&mut self, align: usize, size: usize) -> Result<[u8; 8], String> {
        let start = self.at.next_multiple_of(align);
        let bytes = start
            .checked_add(size)
            .and_then(|end| self.bytes.get(start..end))
            .ok_or_else(|| format!("message ends at byte {} within a field", self.bytes.len()))?;
        self.at = start + size;
        let mut taken = [0; 8];
        let n = size.min(8);
        for (i, byte) in bytes[..n].iter().enumerate() {
            taken[if self.big_endian { n - 1 - i } else { i }] = *byte;
        }
        Ok(taken)
    }
}
