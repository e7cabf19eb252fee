//! Fields of structures as states.

use crate::{State, StateError, StateReader, Writer};

/// Implements [`State`] for a structure by its fields: `values` that serde writes, `parts` that are
/// states themselves, and fields that are `kept` because they follow from the configuration. Every
/// field has to be named, so none is forgotten. `check` is called after all fields are read, and
/// refuses values that would be an index or a count out of range.
///
/// ```
/// struct Counter { limit: u32, count: u32, ring: [f64; 4] }
///
/// octant_state::state! {
///     Counter { values: count, ring; parts: ; kept: limit; check: Counter::check }
/// }
///
/// impl Counter {
///     fn check(&self) -> Result<(), octant_state::StateError> {
///         octant_state::check_below("count", self.count.into(), self.limit.into())
///     }
/// }
/// ```
#[macro_export]
macro_rules! state {
    ($name:ty {
        values: $($value:ident),*;
        parts: $($part:ident),*;
        kept: $($kept:ident),*
        $(; check: $check:expr)? $(;)?
    }) => {
        impl $crate::State for $name {
            fn save(&self, to: &mut $crate::Writer) {
                let Self { $($value,)* $($part,)* $($kept: _,)* } = self;
                $(to.value(stringify!($value), $value);)*
                $(to.part(stringify!($part), $part);)*
            }

            fn load(
                &mut self,
                from: &mut $crate::StateReader<'_>,
            ) -> ::core::result::Result<(), $crate::StateError> {
                let Self { $($value,)* $($part,)* $($kept: _,)* } = self;
                $(*$value = from.value(stringify!($value))?;)*
                $(from.part(stringify!($part), $part)?;)*
                $(($check)(self)?;)?
                Ok(())
            }
        }
    };
}

/// An optional part: the configuration decides whether it exists.
impl<T: State> State for Option<T> {
    fn save(&self, to: &mut Writer) {
        to.value("is there", &self.is_some());
        if let Some(part) = self {
            part.save(to);
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        let expected = self.is_some();
        let found: bool = from.value("is there")?;
        if found != expected {
            let problem =
                alloc::format!("{found} was found, by the configuration it is {expected}");
            return Err(StateError::value("is there", problem));
        }
        self.as_mut().map_or(Ok(()), |part| part.load(from))
    }
}

/// A fixed number of parts.
impl<T: State, const N: usize> State for [T; N] {
    fn save(&self, to: &mut Writer) {
        self.iter().for_each(|part| part.save(to));
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.iter_mut().try_for_each(|part| part.load(from))
    }
}

/// As many parts as the configuration says.
impl<T: State> State for alloc::vec::Vec<T> {
    fn save(&self, to: &mut Writer) {
        self.iter().for_each(|part| part.save(to));
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.iter_mut().try_for_each(|part| part.load(from))
    }
}

/// A part on the heap.
impl<T: State + ?Sized> State for alloc::boxed::Box<T> {
    fn save(&self, to: &mut Writer) {
        T::save(self, to);
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        T::load(self, from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StateFormat;
    use alloc::vec::Vec;
    use std::string::ToString;

    #[derive(Debug, PartialEq)]
    struct Inner {
        count: u64,
        limit: u64,
    }

    impl Inner {
        fn check(&self) -> Result<(), StateError> {
            crate::check_below("count", self.count, self.limit)
        }
    }

    #[derive(Debug, PartialEq)]
    struct Outer {
        size: usize,
        numbers: [f64; 3],
        inner: [Inner; 2],
        other: Option<Inner>,
    }

    state! { Inner { values: count; parts: ; kept: limit; check: Inner::check } }
    state! { Outer { values: numbers; parts: inner, other; kept: size } }

    const FORMAT: StateFormat = StateFormat { magic: "OCTOUTER", version: 1, what: "an outer" };

    fn outer(count: u64, other: bool) -> Outer {
        let inner = |count| Inner { count, limit: 9 };
        Outer {
            size: 4,
            numbers: [1.5, f64::NEG_INFINITY, -0.0],
            inner: [inner(count), inner(2)],
            other: other.then(|| inner(3)),
        }
    }

    fn bytes(outer: &Outer) -> Vec<u8> {
        let mut bytes = Vec::new();
        FORMAT.write(&mut bytes, |to| outer.save(to));
        bytes
    }

    fn load(into: &mut Outer, bytes: &[u8]) -> Result<(), StateError> {
        let mut from = FORMAT.read(bytes)?;
        into.load(&mut from)?;
        from.end()
    }

    #[test]
    fn what_was_saved_is_read_into_one_of_the_same_configuration() {
        let saved = outer(7, true);
        let mut fresh = Outer { numbers: [0.0; 3], ..outer(0, true) };
        load(&mut fresh, &bytes(&saved)).unwrap();
        assert_eq!(fresh, saved);
        let mut another = outer(0, false);
        let error = load(&mut another, &bytes(&saved)).unwrap_err();
        assert_eq!(error.to_string(), "is there: true was found, by the configuration it is false");
    }

    #[test]
    fn a_value_out_of_range_is_refused() {
        let error = load(&mut outer(0, true), &bytes(&outer(10, true))).unwrap_err();
        assert_eq!(error.to_string(), "count: 10 was found, at most 9 is expected");
    }

    #[test]
    fn not_a_number_keeps_its_bits() {
        let mut saved = outer(1, true);
        saved.numbers[0] = f64::from_bits(0xFFF8_0000_0000_1234);
        let mut fresh = outer(0, true);
        load(&mut fresh, &bytes(&saved)).unwrap();
        assert_eq!(fresh.numbers[0].to_bits(), 0xFFF8_0000_0000_1234);
    }
}
