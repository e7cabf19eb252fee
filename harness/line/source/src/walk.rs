//! Walks through the bytes of a message by its definition.

use super::definition::{Definition, Primitive, Shape, Type, Wire};
use super::fields::{FieldPath, Number};

/// Maximum number of fields visited in one message: a definition with more was made to hang a
/// reader.
const NODES_MAX: usize = 1 << 20;
/// Maximum nesting depth of messages.
const DEPTH_MAX: usize = 32;

impl Definition {
    /// Returns the numbers at `paths`, in the same order.
    pub(super) fn numbers(&self, paths: &[FieldPath], data: &[u8]) -> Result<Vec<Number>, String> {
        let (bytes, big_endian) = match (self.wire, data.get(..2)) {
            (Wire::Ros1, _) => (data, false),
            (Wire::Cdr, Some([0, 0])) => (data.get(4..).unwrap_or(&[]), true),
            (Wire::Cdr, Some([0, 1])) => (data.get(4..).unwrap_or(&[]), false),
            (Wire::Cdr, other) => {
                return Err(format!("message begins with {other:02x?}, expected plain CDR"));
            }
        };
        let mut walk = Walk {
            definition: self,
            paths,
            bytes,
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
        if fields.is_empty() && definition.wire == Wire::Cdr {
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
        let align = if self.definition.wire == Wire::Ros1 { 1 } else { align };
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
