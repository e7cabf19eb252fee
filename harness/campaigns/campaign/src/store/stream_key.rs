//! Hashes of streams in little memory, to tell which are the same.

/// Number of bytes of a key.
const LENGTH: usize = 16;

/// First bytes of the BLAKE3 of a stream's hash, a text. Equal texts have equal keys, and two texts with the same
/// key take 2^64 attempts to find.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct StreamKey([u8; LENGTH]);

impl From<&str> for StreamKey {
    fn from(text: &str) -> Self {
        let mut key = [0; LENGTH];
        key.copy_from_slice(&blake3::hash(text.as_bytes()).as_bytes()[..LENGTH]);
        Self(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_equal_where_texts_are() {
        let hash = format!("{:064x}", 255);
        let upper = hash.to_uppercase();
        let texts = [hash.as_str(), &upper, &hash[1..], "", "x"];
        for (a, one) in texts.iter().enumerate() {
            for (b, other) in texts.iter().enumerate() {
                assert_eq!(StreamKey::from(*one) == StreamKey::from(*other), a == b);
            }
        }
        assert_eq!(size_of::<Option<StreamKey>>(), 17);
    }
}
