//! Conversion between f64 and the number types of FMI, checked: a value outside of a type is
//! refused.

/// A number type of FMI.
pub(super) trait Number: Copy + Default + std::fmt::Display {
    /// Converts f64 to the type, if the type has this number.
    fn from_f64(value: f64) -> Option<Self>;
    /// Converts the number to f64, if f64 has it.
    fn to_f64(self) -> Option<f64>;
    /// Takes the bits of a 64-bit whole number, if the type has it: see [`super::whole`].
    fn from_bits(bits: f64) -> Option<Self> {
        Self::from_f64(bits)
    }
    /// Gives the bits of a 64-bit whole number.
    fn to_bits(self) -> f64 {
        self.to_f64().unwrap_or(f64::NAN)
    }
}

/// Limit below which f64 has every whole number.
const EXACT_BELOW: f64 = 9_007_199_254_740_992.0;

macro_rules! whole {
    ($($kind:ty),*) => {$(
        impl Number for $kind {
            #[inline]
            fn from_f64(value: f64) -> Option<Self> {
                // Numbers below 2⁶³ avoid 128-bit arithmetic, which is slow.
                let whole = value as i64;
                if whole as f64 == value && whole != i64::MAX {
                    return <$kind>::try_from(whole).ok();
                }
                // Both bounds are powers of two or exact, and a value beyond i128 saturates.
                let whole = value as i128;
                (whole as f64 == value).then(|| <$kind>::try_from(whole).ok()).flatten()
            }
            #[inline]
            fn to_f64(self) -> Option<f64> {
                let value = self as f64;
                // Whole numbers below this limit are exact, and no other number is rounded to one
                // of them.
                if value.abs() < EXACT_BELOW {
                    return Some(value);
                }
                (value as i128 == self as i128).then_some(value)
            }
            #[inline]
            fn from_bits(bits: f64) -> Option<Self> {
                let whole = bits.to_bits() as i64;
                if size_of::<$kind>() == 8 {
                    return Some(whole as $kind);
                }
                <$kind>::try_from(whole).ok()
            }
            #[inline]
            fn to_bits(self) -> f64 {
                f64::from_bits(self as i64 as u64)
            }
        }
    )*};
}
whole!(i8, u8, i16, u16, i32, u32, i64, u64);

impl Number for f32 {
    /// Rounds to the nearest; a finite number stays finite.
    fn from_f64(value: f64) -> Option<Self> {
        let narrow = value as f32;
        (narrow.is_finite() || !value.is_finite()).then_some(narrow)
    }
    fn to_f64(self) -> Option<f64> {
        Some(f64::from(self))
    }
}

impl Number for f64 {
    fn from_f64(value: f64) -> Option<Self> {
        Some(value)
    }
    fn to_f64(self) -> Option<f64> {
        Some(self)
    }
}

/// A Boolean of either standard: zero is false, any other number is C's true.
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
pub(super) struct Truth<T>(pub(super) T);

impl<T: std::fmt::Display> std::fmt::Display for Truth<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

macro_rules! truth {
    ($($kind:ty),*) => {$(
        impl Number for Truth<$kind> {
            fn from_f64(value: f64) -> Option<Self> {
                (value == 0.0 || value == 1.0).then_some(Self(value as $kind))
            }
            fn to_f64(self) -> Option<f64> {
                Some(if self.0 == 0 { 0.0 } else { 1.0 })
            }
        }
    )*};
}
truth!(u8, i32);

#[cfg(test)]
mod tests {
    use super::{Number, Truth};

    #[test]
    fn whole_numbers_are_kept_or_refused() {
        assert_eq!(i8::from_f64(-128.0), Some(-128));
        assert_eq!(i8::from_f64(-129.0), None);
        assert_eq!(u8::from_f64(-0.0), Some(0));
        assert_eq!(u8::from_f64(-1.0), None);
        assert_eq!(i32::from_f64(0.5), None);
        assert_eq!(i32::from_f64(2_147_483_648.0), None);
        assert_eq!(u64::from_f64(f64::NAN), None);
        assert_eq!(u64::from_f64(f64::INFINITY), None);
        assert_eq!(u64::from_f64(18_446_744_073_709_551_616.0), None);
        assert_eq!(i64::from_f64(-9_223_372_036_854_775_808.0), Some(i64::MIN));
        assert_eq!(i64::from_f64(9_223_372_036_854_775_808.0), None);
    }

    #[test]
    fn what_f64_has_not_is_said() {
        assert_eq!(((1u64 << 53) + 1).to_f64(), None);
        assert_eq!((1u64 << 53).to_f64(), Some(9_007_199_254_740_992.0));
        assert_eq!(u64::MAX.to_f64(), None);
        assert_eq!(i64::MIN.to_f64(), Some(-9_223_372_036_854_775_808.0));
    }

    #[test]
    fn bits_are_those_of_64_bits() {
        for value in [i64::MIN, -1, 0, (1 << 53) + 1, i64::MAX] {
            assert_eq!(i64::from_bits(Number::to_bits(value)), Some(value));
            let unsigned = value as u64;
            assert_eq!(u64::from_bits(Number::to_bits(unsigned)), Some(unsigned));
        }
        assert_eq!(<i32 as Number>::from_bits(Number::to_bits(-7i64)), Some(-7));
        assert_eq!(<i32 as Number>::from_bits(Number::to_bits(1i64 << 31)), None);
        assert_eq!(<i64 as Number>::from_bits(Number::to_bits(-7i32)), Some(-7));
    }

    #[test]
    fn floats_stay_finite() {
        assert_eq!(f32::from_f64(1e39), None);
        assert_eq!(f32::from_f64(f64::INFINITY), Some(f32::INFINITY));
        assert!(f32::from_f64(f64::NAN).is_some_and(f32::is_nan));
        assert_eq!(f32::from_f64(0.1), Some(0.1));
    }

    #[test]
    fn booleans_are_two() {
        assert_eq!(Truth::<u8>::from_f64(2.0).map(|truth| truth.0), None);
        assert_eq!(Truth::<i32>::from_f64(f64::NAN).map(|truth| truth.0), None);
        assert_eq!(Truth(255u8).to_f64(), Some(1.0));
        assert_eq!(Truth(-1i32).to_f64(), Some(1.0));
        assert_eq!(Truth(0i32).to_f64(), Some(0.0));
    }
}
