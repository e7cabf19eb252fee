//! JSON of numbers that may not be finite.
//!
//! JSON has no word for NaN and infinities, and `serde_json` writes null for them. It refuses to read that null as a
//! number. The functions here read null as NaN wherever a number has to be, so that what was written is read. A field that
//! may be absent (`Option`) stays absent.

use serde::Deserialize;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use std::fmt;

/// Reads JSON, with NaN for null in the place of a number.
///
/// # Errors
/// If the text isn't JSON of the type.
pub fn from_str<'a, T: Deserialize<'a>>(text: &'a str) -> serde_json::Result<T> {
    let mut json = serde_json::Deserializer::from_str(text);
    let value = T::deserialize(NullAsNan(&mut json))?;
    json.end()?;
    Ok(value)
}

/// Reads JSON, with NaN for null in the place of a number.
///
/// # Errors
/// If the bytes aren't JSON of the type.
pub fn from_slice<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> serde_json::Result<T> {
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let value = T::deserialize(NullAsNan(&mut json))?;
    json.end()?;
    Ok(value)
}

/// Wrapper of every part of a deserializer, so that it reaches each number.
#[derive(Debug)]
struct NullAsNan<T>(T);

macro_rules! forward {
    ($($method:ident($($argument:ident: $type:ty),*))*) => {$(
        fn $method<V: Visitor<'de>>(
            self,
            $($argument: $type,)*
            visitor: V,
        ) -> Result<V::Value, Self::Error> {
            self.0.$method($($argument,)* NullAsNan(visitor))
        }
    )*};
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for NullAsNan<D> {
    type Error = D::Error;

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        self.0.deserialize_option(NumberOrNull(visitor))
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        self.0.deserialize_option(NumberOrNull(visitor))
    }

    forward! {
        deserialize_any() deserialize_bool() deserialize_i8() deserialize_i16() deserialize_i32() deserialize_i64()
        deserialize_i128() deserialize_u8() deserialize_u16() deserialize_u32() deserialize_u64() deserialize_u128()
        deserialize_char() deserialize_str() deserialize_string() deserialize_bytes() deserialize_byte_buf()
        deserialize_option() deserialize_unit() deserialize_seq() deserialize_map() deserialize_identifier()
        deserialize_ignored_any()
        deserialize_unit_struct(name: &'static str)
        deserialize_newtype_struct(name: &'static str)
        deserialize_tuple(length: usize)
        deserialize_tuple_struct(name: &'static str, length: usize)
        deserialize_struct(name: &'static str, fields: &'static [&'static str])
        deserialize_enum(name: &'static str, variants: &'static [&'static str])
    }

    fn is_human_readable(&self) -> bool {
        self.0.is_human_readable()
    }
}

/// Visitor of a number that may be null.
struct NumberOrNull<V>(V);

impl<'de, V: Visitor<'de>> Visitor<'de> for NumberOrNull<V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_f64(f64::NAN)
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_f64(f64::NAN)
    }

    fn visit_some<D: Deserializer<'de>>(self, number: D) -> Result<V::Value, D::Error> {
        number.deserialize_f64(self.0)
    }
}

macro_rules! visits {
    ($($method:ident($type:ty))*) => {$(
        fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.0.$method(value)
        }
    )*};
}

impl<'de, V: Visitor<'de>> Visitor<'de> for NullAsNan<V> {
    type Value = V::Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(formatter)
    }

    visits! {
        visit_bool(bool) visit_i8(i8) visit_i16(i16) visit_i32(i32) visit_i64(i64) visit_i128(i128) visit_u8(u8)
        visit_u16(u16) visit_u32(u32) visit_u64(u64) visit_u128(u128) visit_f32(f32) visit_f64(f64) visit_char(char)
        visit_str(&str) visit_borrowed_str(&'de str) visit_string(String) visit_bytes(&[u8])
        visit_borrowed_bytes(&'de [u8]) visit_byte_buf(Vec<u8>)
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_none()
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.0.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        self.0.visit_some(NullAsNan(inner))
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(NullAsNan(inner))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, all: A) -> Result<V::Value, A::Error> {
        self.0.visit_seq(NullAsNan(all))
    }

    fn visit_map<A: MapAccess<'de>>(self, all: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(NullAsNan(all))
    }

    fn visit_enum<A: EnumAccess<'de>>(self, variant: A) -> Result<V::Value, A::Error> {
        self.0.visit_enum(NullAsNan(variant))
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for NullAsNan<S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        self.0.deserialize(NullAsNan(inner))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for NullAsNan<A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.0.next_element_seed(NullAsNan(seed))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for NullAsNan<A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        self.0.next_key_seed(seed)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        self.0.next_value_seed(NullAsNan(seed))
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: EnumAccess<'de>> EnumAccess<'de> for NullAsNan<A> {
    type Error = A::Error;
    type Variant = NullAsNan<A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        let (value, variant) = self.0.variant_seed(seed)?;
        Ok((value, NullAsNan(variant)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for NullAsNan<A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.0.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        self.0.newtype_variant_seed(NullAsNan(seed))
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.tuple_variant(length, NullAsNan(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.struct_variant(fields, NullAsNan(visitor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;
    use std::collections::BTreeMap;

    #[derive(Debug, Deserialize, Serialize)]
    enum Shape {
        Ball(f64),
        Box { sides: [f64; 2] },
        Pair(f64, f32),
        None,
    }

    #[derive(Debug, Deserialize, Serialize)]
    struct All {
        number: f64,
        absent: Option<f64>,
        rows: Vec<[f64; 2]>,
        by_name: BTreeMap<String, f64>,
        shapes: Vec<Shape>,
        nested: Option<Box<All>>,
        text: String,
        count: u64,
    }

    #[test]
    fn numbers_that_are_not_finite_come_back_as_nan_wherever_they_are() {
        let inner = All {
            number: f64::NEG_INFINITY,
            absent: None,
            rows: vec![[1.5, f64::NAN], [f64::INFINITY, -0.0]],
            by_name: BTreeMap::from([("a".to_owned(), f64::NAN), ("b".to_owned(), 5e-324)]),
            shapes: vec![
                Shape::Ball(f64::NAN),
                Shape::Box { sides: [f64::INFINITY, 2.0] },
                Shape::Pair(f64::NAN, f32::NAN),
                Shape::None,
            ],
            nested: None,
            text: "null".to_owned(),
            count: 3,
        };
        let all = All { nested: Some(Box::new(inner)), number: 1e308, ..empty() };
        let text = serde_json::to_string(&all).unwrap();
        assert!(serde_json::from_str::<All>(&text).is_err(), "what this module is for");
        for read in [from_str::<All>(&text), from_slice::<All>(text.as_bytes())] {
            let read = read.unwrap();
            assert_eq!(serde_json::to_string(&read).unwrap(), text);
            let inner = read.nested.unwrap();
            assert!(inner.number.is_nan() && inner.absent.is_none() && inner.rows[0][1].is_nan());
            assert_eq!((inner.rows[0][0], inner.by_name["b"]), (1.5, 5e-324));
            assert_eq!((read.number, inner.text.as_str()), (1e308, "null"));
        }
    }

    fn empty() -> All {
        All {
            number: 0.0,
            absent: Some(1.0),
            rows: vec![],
            by_name: BTreeMap::new(),
            shapes: vec![],
            nested: None,
            text: String::new(),
            count: 0,
        }
    }

    #[test]
    fn null_in_another_place_is_refused_with_its_place() {
        let text = serde_json::to_string(&empty()).unwrap();
        for (from, to) in [
            ("\"count\":0", "\"count\":null"),
            ("\"text\":\"\"", "\"text\":null"),
            ("\"number\":0.0,", ""),
            ("\"number\":0.0", "\"number\":\"nan\""),
            ("\"count\":0}", "\"count\":0}}"),
        ] {
            assert!(text.contains(from), "{text}");
            let error = from_str::<All>(&text.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains("line 1 column"), "{error}");
        }
    }
}
