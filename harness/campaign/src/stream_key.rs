//! Hashes of streams in little memory, to tell which are the same.

/// A stream's hash. Equal keys stand for equal texts.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum StreamKey {
    /// The 64 digits of a hash.
    Hash([u8; 32]),
    /// Any other text.
    Text(Box<str>),
}

impl From<&str> for StreamKey {
    fn from(text: &str) -> Self {
        let digit = |byte: &u8| match byte {
            b'0'..=b'9' => Some(byte - b'0'),
            b'a'..=b'f' => Some(byte - b'a' + 10),
            _ => None,
        };
        let mut hash = [0; 32];
        let (pairs, rest) = text.as_bytes().as_chunks::<2>();
        if pairs.len() != hash.len() || !rest.is_empty() {
            return Self::Text(text.into());
        }
        for (byte, [high, low]) in hash.iter_mut().zip(pairs) {
            let (Some(high), Some(low)) = (digit(high), digit(low)) else {
                return Self::Text(text.into());
            };
            *byte = 16 * high + low;
        }
        Self::Hash(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_equal_where_texts_are() {
        let hash = format!("{:064x}", 255);
        let StreamKey::Hash(bytes) = StreamKey::from(hash.as_str()) else { panic!() };
        assert_eq!((bytes[30], bytes[31]), (0, 255));
        let upper = hash.to_uppercase();
        let texts = [hash.as_str(), &upper, &hash[1..], "", "x"];
        for (a, one) in texts.iter().enumerate() {
            for (b, other) in texts.iter().enumerate() {
                assert_eq!(StreamKey::from(*one) == StreamKey::from(*other), a == b);
            }
        }
    }
}
