//! Patterns of lines with fields.

use std::collections::BTreeMap;

/// A field of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Field {
    Axis,
    Angle,
    Rate,
    Acceleration,
    Ms,
    Bits,
    Fault,
    Moving,
    Homed,
    Enabled,
    Any,
}

impl Field {
    const ALL: [Self; 11] = [
        Self::Axis,
        Self::Angle,
        Self::Rate,
        Self::Acceleration,
        Self::Ms,
        Self::Bits,
        Self::Fault,
        Self::Moving,
        Self::Homed,
        Self::Enabled,
        Self::Any,
    ];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::Angle => "angle",
            Self::Rate => "rate",
            Self::Acceleration => "acceleration",
            Self::Ms => "ms",
            Self::Bits => "bits",
            Self::Fault => "fault",
            Self::Moving => "moving",
            Self::Homed => "homed",
            Self::Enabled => "enabled",
            Self::Any => "any",
        }
    }
}

/// Texts of fields.
pub(crate) type Fields = BTreeMap<Field, String>;

#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    Field(Field),
}

/// A line with fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pattern {
    pieces: Vec<Piece>,
    text: String,
}

impl Pattern {
    /// Parses a pattern; the error describes the problem.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find('{') {
            if at > 0 {
                pieces.push(Piece::Text(rest[..at].into()));
            } else if matches!(pieces.last(), Some(Piece::Field(_))) {
                return Err(format!("`{text}` has two fields without a character between them"));
            }
            let Some((name, tail)) = rest[at + 1..].split_once('}') else {
                return Err(format!("`{text}` has a {{ without its }}"));
            };
            let field = Field::ALL.into_iter().find(|field| field.name() == name);
            let Some(field) = field else {
                let names: Vec<&str> = Field::ALL.iter().map(|field| field.name()).collect();
                return Err(format!(
                    "found a field {{{name}}} in `{text}`, expected one of {}",
                    names.join(", ")
                ));
            };
            pieces.push(Piece::Field(field));
            rest = tail;
        }
        if !rest.is_empty() {
            pieces.push(Piece::Text(rest.into()));
        }
        Ok(Self { pieces, text: text.into() })
    }

    /// True if it has a field.
    pub(crate) fn has(&self, field: Field) -> bool {
        self.pieces.contains(&Piece::Field(field))
    }

    /// Text of the pattern.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Fills in the fields of the line; `None` if one is missing.
    pub(crate) fn write(&self, fields: &Fields) -> Option<String> {
        let mut line = String::new();
        for piece in &self.pieces {
            match piece {
                Piece::Text(text) => line.push_str(text),
                Piece::Field(field) => line.push_str(fields.get(field)?),
            }
        }
        Some(line)
    }

    /// Parses a line of this pattern into its fields; a field ends where the text after it begins.
    pub(crate) fn read(&self, line: &str) -> Option<Fields> {
        let mut fields = Fields::new();
        let mut rest = line;
        let mut pieces = self.pieces.iter().peekable();
        while let Some(piece) = pieces.next() {
            match piece {
                Piece::Text(text) => rest = rest.strip_prefix(text.as_str())?,
                Piece::Field(field) => {
                    let end = match pieces.peek() {
                        Some(Piece::Text(text)) => rest.find(text.as_str())?,
                        _ => rest.len(),
                    };
                    if end == 0 && *field != Field::Any {
                        return None;
                    }
                    fields.insert(*field, rest[..end].into());
                    rest = &rest[end..];
                }
            }
        }
        rest.is_empty().then_some(fields)
    }
}
