//! The frame around a state: magic, version, length, checksum.

use crate::{StateError, StateReader, Writer};
use alloc::vec::Vec;

/// Outer form of the states of a model. Layout, little-endian: eight letters of magic, version u16,
/// length of the values u64, the values, CRC-32 (ISO-HDLC) of all before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateFormat {
    /// Magic at the start: eight ASCII letters.
    pub magic: &'static str,
    /// Version of the layout; raise it whenever the layout changes.
    pub version: u16,
    /// Name of the content for messages: "the state of a plant".
    pub what: &'static str,
}

const HEAD: usize = 8 + 2 + 8;
const CHECKSUM: usize = 4;

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&bytes[..N]);
    array
}

impl StateFormat {
    /// Appends a frame with the values that `fill` writes.
    pub fn write(&self, bytes: &mut Vec<u8>, fill: impl FnOnce(&mut Writer)) {
        let start = bytes.len();
        let mut magic = [0; 8];
        for (to, from) in magic.iter_mut().zip(self.magic.bytes()) {
            *to = from;
        }
        bytes.extend_from_slice(&magic);
        bytes.extend_from_slice(&self.version.to_le_bytes());
        bytes.extend_from_slice(&[0; 8]);
        let mut writer = Writer::onto(core::mem::take(bytes));
        fill(&mut writer);
        let sound = writer.is_sound();
        *bytes = writer.into_bytes();
        let length = (bytes.len() - start - HEAD) as u64;
        bytes[start + 10..start + HEAD].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes[start..]);
        // A frame that could not be written whole must not be accepted as a state.
        let checksum = if sound { checksum } else { !checksum };
        bytes.extend_from_slice(&checksum.to_le_bytes());
    }

    /// Checks a frame that fills `bytes`, and returns a reader of its values.
    ///
    /// # Errors
    /// If the frame is not of this format, not whole, or damaged.
    pub fn read<'a>(&self, bytes: &'a [u8]) -> Result<StateReader<'a>, StateError> {
        let what = self.what;
        let magic = self.magic.as_bytes();
        if bytes.len() < magic.len() || !bytes.starts_with(magic) {
            return Err(StateError::Magic { what, magic: self.magic });
        }
        let found = bytes.len();
        if found < HEAD + CHECKSUM {
            return Err(StateError::Length { what, found, expected: (HEAD + CHECKSUM) as u64 });
        }
        let version = u16::from_le_bytes(array(&bytes[8..]));
        if version != self.version {
            return Err(StateError::Version { what, found: version, expected: self.version });
        }
        let length = u64::from_le_bytes(array(&bytes[10..]));
        let expected = length.saturating_add((HEAD + CHECKSUM) as u64);
        if found as u64 != expected {
            return Err(StateError::Length { what, found, expected });
        }
        let (framed, checksum) = bytes.split_at(found - CHECKSUM);
        let (found, computed) = (u32::from_le_bytes(array(checksum)), crc32fast::hash(framed));
        if found != computed {
            return Err(StateError::Checksum { what, found, computed });
        }
        Ok(StateReader::new(&framed[HEAD..]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::string::ToString;

    const FORMAT: StateFormat =
        StateFormat { magic: "OCTTESTS", version: 3, what: "the state of a test" };

    fn frame(values: &[u64]) -> Vec<u8> {
        let mut bytes = Vec::new();
        FORMAT.write(&mut bytes, |to| values.iter().for_each(|value| to.value("value", value)));
        bytes
    }

    fn read(bytes: &[u8]) -> Result<u64, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let value = from.value("value")?;
        from.end()?;
        Ok(value)
    }

    #[test]
    fn a_frame_says_what_is_wrong_with_it() {
        let good = frame(&[7]);
        assert_eq!(read(&good), Ok(7));
        let said = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert_eq!(said(b"PK"), "not the state of a test: it does not begin with OCTTESTS");
        assert_eq!(said(&good[..10]), "the state of a test has 10 bytes, 22 are expected");
        let mut newer = good.clone();
        newer[8] = 4;
        assert_eq!(said(&newer), "the state of a test has version 4, this program reads version 3");
        assert_eq!(said(&good[..22]), "the state of a test has 22 bytes, 23 are expected");
        let mut longer = good.clone();
        longer.push(0);
        assert_eq!(said(&longer), "the state of a test has 24 bytes, 23 are expected");
        let mut altered = good;
        altered[18] ^= 1;
        assert!(said(&altered).starts_with("the state of a test is damaged: checksum 0x"));
        assert_eq!(said(&frame(&[7, 8])), "end: 1 byte is left over");
        assert_eq!(said(&frame(&[])), "value: the bytes end before it, or it is none");
    }

    #[test]
    fn frames_stand_behind_one_another() {
        let mut bytes = frame(&[1]);
        let first = bytes.len();
        FORMAT.write(&mut bytes, |to| to.value("value", &2u64));
        assert_eq!((read(&bytes[..first]), read(&bytes[first..])), (Ok(1), Ok(2)));
    }

    #[test]
    fn what_could_not_be_written_is_not_read() {
        struct Unwritable;
        impl serde::Serialize for Unwritable {
            fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
                Err(serde::ser::Error::custom("no"))
            }
        }
        let mut bytes = Vec::new();
        FORMAT.write(&mut bytes, |to| {
            to.value("value", &1u64);
            to.value("other", &Unwritable);
        });
        assert!(matches!(read(&bytes), Err(StateError::Checksum { .. })));
    }

    proptest! {
        #[test]
        fn any_altered_bit_and_any_cut_is_refused(value: u64, at: prop::sample::Index, bit in 0u8..8) {
            let good = frame(&[value]);
            prop_assert_eq!(read(&good), Ok(value));
            let at = at.index(good.len());
            prop_assert!(read(&good[..at]).is_err());
            let mut altered = good;
            altered[at] ^= 1 << bit;
            prop_assert!(read(&altered).is_err());
        }

        #[test]
        fn any_bytes_are_refused_or_read(bytes: Vec<u8>) {
            let _ = read(&bytes);
            let framed = {
                let mut framed = Vec::new();
                FORMAT.write(&mut framed, |to| bytes.iter().for_each(|byte| to.value("byte", byte)));
                framed
            };
            let mut from = FORMAT.read(&framed).unwrap();
            let _ = from.value::<Vec<(f64, Option<bool>, std::string::String)>>("anything");
        }
    }
}
