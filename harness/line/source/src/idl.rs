//! Definitions of messages in OMG IDL, as the text of a schema `ros2idl` has them.
//!
//! Structures, typedefs, enumerations and the constants that bound arrays are read; annotations are passed over.
//! Arrays of several dimensions count their elements in the order of the bytes, with one index. Unions, bit sets and
//! structures with a base aren't read.

use super::definition::{Definition, Field, Primitive, Shape, Type, Wire, short_name};
use std::collections::HashMap;

/// Deepest nesting of types and modules: a text with more was made to fill the stack.
const DEPTH_MAX: usize = 32;
/// Most elements of an array: more are no message.
const ELEMENTS_MAX: usize = 1 << 20;

impl Definition {
    /// Parses the text of a schema `ros2idl`. `name` is the name of the root, `package/msg/Name`.
    pub(super) fn parse_idl(name: &str, text: &str) -> Result<Self, String> {
        let wrong =
            |(line, reason): (usize, String)| format!("schema {name} line {line}: {reason}");
        let tokens = tokens(text).map_err(wrong)?;
        let mut parser = Parser { tokens: &tokens, at: 0, ..Parser::default() };
        let all = parser.declarations(&mut Vec::new(), false);
        all.map_err(|reason| wrong((parser.line(), reason)))?;
        let messages = parser.messages().map_err(|reason| format!("schema {name}: {reason}"))?;
        Ok(Self { root: short_name(name), messages, wire: Wire::Cdr })
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Token {
    /// A name with its scopes, a number, or a text.
    Word(String),
    Sign(char),
}

/// Splits a text, without comments, lines of the preprocessor, and the lines between files.
fn tokens(text: &str) -> Result<Vec<(usize, Token)>, (usize, String)> {
    let mut all = Vec::new();
    let mut is_comment = false;
    for (line, text) in (1..).zip(text.lines()) {
        let bare = text.trim_start();
        if !is_comment
            && (bare.starts_with('#') || bare.starts_with("===") || bare.starts_with("IDL:"))
        {
            continue;
        }
        let mut rest = text;
        loop {
            if is_comment {
                let Some((_, behind)) = rest.split_once("*/") else { break };
                (rest, is_comment) = (behind, false);
            }
            rest = rest.trim_start();
            let Some(first) = rest.chars().next() else { break };
            if rest.starts_with("//") {
                break;
            }
            if let Some(behind) = rest.strip_prefix("/*") {
                (rest, is_comment) = (behind, true);
                continue;
            }
            let length = match first {
                '"' => text_length(rest).ok_or((line, "a text has no end".to_owned()))?,
                _ if is_part(first) => {
                    rest.find(|next| !is_part(next) && next != ':').unwrap_or(rest.len())
                }
                _ => first.len_utf8(),
            };
            let (token, behind) = rest.split_at(length);
            rest = behind;
            // A single colon behind a name is a sign of its own.
            let name = token.trim_end_matches(':');
            let is_word = is_part(first) || first == '"' || token.starts_with("::");
            if is_word {
                all.push((line, Token::Word(name.to_owned())));
                all.extend((name.len()..token.len()).map(|_| (line, Token::Sign(':'))));
            } else {
                all.push((line, Token::Sign(first)));
            }
        }
    }
    Ok(all)
}

fn is_part(character: char) -> bool {
    character.is_alphanumeric() || matches!(character, '_' | '.' | '-' | '+')
}

/// Bytes of a text in quotes at the start.
fn text_length(text: &str) -> Option<usize> {
    let mut is_escaped = false;
    text.char_indices().skip(1).find_map(|(at, character)| {
        let ends = character == '"' && !is_escaped;
        is_escaped = character == '\\' && !is_escaped;
        ends.then_some(at + 1)
    })
}

/// A type as it is written.
#[derive(Clone, Debug)]
enum Written {
    Known(Type),
    /// Name, and the scope in which it stands.
    Name(String, Vec<String>),
    Sequence(Box<Written>),
}

/// A member of a structure, or a typedef.
#[derive(Clone, Debug)]
struct Declared {
    name: String,
    written: Written,
    /// Number of elements, if it is an array.
    elements: Option<usize>,
}

#[derive(Default)]
struct Parser<'a> {
    tokens: &'a [(usize, Token)],
    at: usize,
    structures: HashMap<String, Vec<Declared>>,
    typedefs: HashMap<String, Declared>,
    enumerations: HashMap<String, ()>,
    constants: HashMap<String, usize>,
    depth: usize,
}

impl Parser<'_> {
    fn line(&self) -> usize {
        let last = self.tokens.last();
        self.tokens.get(self.at.saturating_sub(1)).or(last).map_or(1, |token| token.0)
    }

    fn next(&mut self) -> Option<&Token> {
        let token = self.tokens.get(self.at).map(|token| &token.1);
        self.at += 1;
        token
    }

    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|token| &token.1)
    }

    /// Takes a sign, if it is the next one.
    fn takes(&mut self, sign: char) -> bool {
        let is = self.peek() == Some(&Token::Sign(sign));
        self.at += usize::from(is);
        is
    }

    fn sign(&mut self, sign: char) -> Result<(), String> {
        match self.next() {
            Some(Token::Sign(found)) if *found == sign => Ok(()),
            Some(found) => Err(format!("found {}, expected {sign:?}", shown(found))),
            None => Err(format!("the text ends, expected {sign:?}")),
        }
    }

    fn word(&mut self) -> Result<String, String> {
        match self.next() {
            Some(Token::Word(word)) => Ok(word.clone()),
            Some(found) => Err(format!("found {}, expected a name", shown(found))),
            None => Err("the text ends, expected a name".to_owned()),
        }
    }

    /// Passes over annotations.
    fn annotations(&mut self) -> Result<(), String> {
        while self.takes('@') {
            self.word()?;
            if self.takes('(') {
                let mut open = 1;
                while open > 0 {
                    match self.next() {
                        Some(Token::Sign('(')) => open += 1,
                        Some(Token::Sign(')')) => open -= 1,
                        Some(_) => {}
                        None => return Err("an annotation has no end".to_owned()),
                    }
                }
            }
        }
        Ok(())
    }

    fn deeper(&mut self) -> Result<(), String> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(format!("more than {DEPTH_MAX} modules or types in each other"));
        }
        Ok(())
    }

    /// Reads declarations up to the end of their module, or of the text.
    fn declarations(&mut self, scope: &mut Vec<String>, is_module: bool) -> Result<(), String> {
        self.deeper()?;
        loop {
            self.annotations()?;
            match self.peek() {
                None if is_module => return Err("the text ends within a module".to_owned()),
                None => break,
                Some(Token::Sign('}')) if is_module => break,
                _ => {}
            }
            let word = self.word()?;
            match word.as_str() {
                "module" => {
                    scope.push(self.word()?);
                    self.sign('{')?;
                    self.declarations(scope, true)?;
                    self.sign('}')?;
                    scope.pop();
                }
                "struct" => self.structure(scope)?,
                "typedef" => {
                    let written = self.written(scope)?;
                    for declared in self.declarators(&written, scope)? {
                        self.typedefs.insert(scoped(scope, &declared.name), declared);
                    }
                }
                "enum" => {
                    let name = self.word()?;
                    self.enumerations.insert(scoped(scope, &name), ());
                    self.sign('{')?;
                    while !self.takes('}') {
                        if self.next().is_none() {
                            return Err("an enumeration has no end".to_owned());
                        }
                    }
                }
                "const" => {
                    self.written(scope)?;
                    let name = self.word()?;
                    self.sign('=')?;
                    if let Some(Token::Word(word)) = self.peek()
                        && let Ok(number) = word.parse()
                    {
                        self.constants.insert(scoped(scope, &name), number);
                    }
                    while !matches!(self.peek(), None | Some(Token::Sign(';'))) {
                        self.at += 1;
                    }
                }
                other => {
                    let expected = "expected module, struct, typedef, enum or const";
                    return Err(format!("found {other:?}, {expected}"));
                }
            }
            self.sign(';')?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn structure(&mut self, scope: &[String]) -> Result<(), String> {
        let name = self.word()?;
        if self.peek() == Some(&Token::Sign(';')) {
            // Declared here, and described elsewhere.
            return Ok(());
        }
        if self.takes(':') {
            return Err(format!("structure {name} has a base, which can't be read"));
        }
        self.sign('{')?;
        let mut members = Vec::new();
        loop {
            self.annotations()?;
            if self.takes('}') {
                break;
            }
            let written = self.written(scope)?;
            members.extend(self.declarators(&written, scope)?);
            self.sign(';')?;
        }
        self.structures.insert(scoped(scope, &name), members);
        Ok(())
    }

    /// Reads the names behind a type, with their array bounds.
    fn declarators(
        &mut self,
        written: &Written,
        scope: &[String],
    ) -> Result<Vec<Declared>, String> {
        let mut all = Vec::new();
        loop {
            self.annotations()?;
            let name = self.word()?;
            let mut elements = None;
            while self.takes('[') {
                let bound = self.word()?;
                let bound = self.bound(&bound, scope)?;
                self.sign(']')?;
                elements = Some(product(elements.unwrap_or(1), bound)?);
            }
            all.push(Declared { name, written: written.clone(), elements });
            if !self.takes(',') {
                return Ok(all);
            }
        }
    }

    /// Value of a bound: a number, or a constant.
    fn bound(&self, word: &str, scope: &[String]) -> Result<usize, String> {
        if let Ok(number) = word.parse() {
            return Ok(number);
        }
        let found = scopes(scope, word).find_map(|name| self.constants.get(&name).copied());
        found.ok_or_else(|| format!("found bound {word:?}, expected a number or a constant"))
    }

    fn written(&mut self, scope: &[String]) -> Result<Written, String> {
        use Primitive::{Bool, Float32, Float64, Signed, Unsigned};
        self.deeper()?;
        let word = self.word()?;
        let known = |primitive| Ok(Written::Known(Type::Primitive(primitive)));
        let written = match word.as_str() {
            "boolean" => known(Bool),
            "octet" | "char" | "uint8" => known(Unsigned(1)),
            "int8" => known(Signed(1)),
            "short" | "int16" => known(Signed(2)),
            "uint16" => known(Unsigned(2)),
            "int32" => known(Signed(4)),
            "uint32" => known(Unsigned(4)),
            "int64" => known(Signed(8)),
            "uint64" => known(Unsigned(8)),
            "float" => known(Float32),
            "double" => known(Float64),
            "long" if self.is_word("double") => Err("long double can't be read".to_owned()),
            "long" if self.is_word("long") => known(Signed(8)),
            "long" => known(Signed(4)),
            "unsigned" => match self.word()?.as_str() {
                "short" => known(Unsigned(2)),
                "long" if self.is_word("long") => known(Unsigned(8)),
                "long" => known(Unsigned(4)),
                other => Err(format!("found unsigned {other}, expected short or long")),
            },
            "string" => {
                if self.takes('<') {
                    self.word()?;
                    self.sign('>')?;
                }
                Ok(Written::Known(Type::Text))
            }
            "sequence" => {
                self.sign('<')?;
                let of = self.written(scope)?;
                if self.takes(',') {
                    self.word()?;
                }
                self.sign('>')?;
                Ok(Written::Sequence(Box::new(of)))
            }
            "wstring" | "wchar" | "union" | "bitset" | "bitmask" | "map" | "fixed" | "any" => {
                Err(format!("{word} can't be read"))
            }
            _ => Ok(Written::Name(word, scope.to_vec())),
        };
        self.depth -= 1;
        written
    }

    /// Takes a word, if it is the next one.
    fn is_word(&mut self, expected: &str) -> bool {
        let is = matches!(self.peek(), Some(Token::Word(word)) if word == expected);
        self.at += usize::from(is);
        is
    }

    /// Fields of all structures, with their typedefs followed.
    fn messages(&self) -> Result<HashMap<String, Vec<Field>>, String> {
        let all = self.structures.iter().map(|(name, members)| {
            let fields = members.iter().map(|member| {
                let (ty, shape) = self.resolved(&member.written, member.elements, 0)?;
                Ok(Field { name: member.name.clone(), ty, shape })
            });
            Ok((short_name(name), fields.collect::<Result<Vec<_>, String>>()?))
        });
        all.collect()
    }

    fn resolved(
        &self,
        written: &Written,
        elements: Option<usize>,
        depth: usize,
    ) -> Result<(Type, Shape), String> {
        if depth > DEPTH_MAX {
            return Err(format!("more than {DEPTH_MAX} typedefs in a row"));
        }
        let own = elements.map_or(Shape::One, Shape::Fixed);
        let (ty, inner) = match written {
            Written::Known(ty) => (ty.clone(), Shape::One),
            Written::Sequence(of) => match self.resolved(of, None, depth + 1)? {
                (ty, Shape::One) => (ty, Shape::Sequence),
                _ => return Err("a sequence of arrays or sequences can't be read".to_owned()),
            },
            Written::Name(name, scope) => {
                let found = scopes(scope, name).find_map(|name| {
                    if self.structures.contains_key(&name) {
                        return Some(Ok((Type::Message(short_name(&name)), Shape::One)));
                    }
                    if self.enumerations.contains_key(&name) {
                        let ty = Type::Primitive(Primitive::Unsigned(4));
                        return Some(Ok((ty, Shape::One)));
                    }
                    let alias = self.typedefs.get(&name)?;
                    Some(self.resolved(&alias.written, alias.elements, depth + 1))
                });
                found.ok_or_else(|| format!("the schema has no definition of {name}"))??
            }
        };
        match (own, inner) {
            (shape, Shape::One) | (Shape::One, shape) => Ok((ty, shape)),
            (Shape::Fixed(own), Shape::Fixed(inner)) => {
                Ok((ty, Shape::Fixed(product(own, inner)?)))
            }
            _ => Err("an array of sequences can't be read".to_owned()),
        }
    }
}

fn product(one: usize, other: usize) -> Result<usize, String> {
    let all = one.checked_mul(other).filter(|all| *all <= ELEMENTS_MAX);
    all.ok_or_else(|| {
        format!("an array has {one} times {other} elements, expected {ELEMENTS_MAX} at most")
    })
}

fn shown(token: &Token) -> String {
    match token {
        Token::Word(word) => format!("{word:?}"),
        Token::Sign(sign) => format!("{sign:?}"),
    }
}

/// Name within a scope.
fn scoped(scope: &[String], name: &str) -> String {
    let mut all = scope.to_vec();
    all.push(name.to_owned());
    all.join("::")
}

/// Names that a name may stand for, from the innermost scope outwards.
fn scopes<'a>(scope: &'a [String], name: &'a str) -> impl Iterator<Item = String> + 'a {
    let (most, name) = match name.strip_prefix("::") {
        Some(name) => (0, name),
        None => (scope.len(), name),
    };
    (0..=most).rev().map(move |depth| scoped(&scope[..depth], name))
}
