//! Texts of a fixed size.

use octant_wire::{Text, TextError};

#[test]
fn a_text_fits_or_says_by_how_much_not() {
    assert_eq!(Text::<4>::new("über").unwrap_err(), TextError::Long { found: 5, room: 4 });
    assert_eq!(Text::<5>::new("über").unwrap().as_str(), "über");
    assert_eq!(Text::<4>::new("a\0b").unwrap_err(), TextError::Nul { at: 1 });
}

#[test]
fn what_fits_is_whole_characters() {
    assert_eq!(Text::<4>::fitting("über").as_str(), "übe");
    assert_eq!(Text::<1>::fitting("über").as_str(), "");
    assert_eq!(Text::<8>::fitting("ab\0cd").as_str(), "ab");
}

#[test]
fn bytes_are_a_text_when_they_are_utf8_and_then_zeros() {
    assert_eq!(Text::from_bytes(*b"abc\0").unwrap().as_str(), "abc");
    assert_eq!(Text::from_bytes(*b"abcd").unwrap().as_str(), "abcd");
    assert_eq!(Text::from_bytes(*b"a\0c\0").unwrap_err(), TextError::Nul { at: 1 });
    assert_eq!(Text::from_bytes(*b"a\xffc\0").unwrap_err(), TextError::Encoding { at: 1 });
}
