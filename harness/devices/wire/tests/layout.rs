//! Fields of the messages fill their payloads, and fit the words of a CAN image.

use octant_wire::MessageKind;
use octant_wire::layout::{FieldType, fields, image_at};

#[test]
fn fields_fill_every_payload_without_gaps() {
    for kind in MessageKind::ALL {
        let mut at = 0;
        for field in fields(kind) {
            assert_eq!(field.at, at, "{}.{}", kind.name(), field.name);
            at += field.ty.bytes();
        }
        assert_eq!(at, kind.payload_bytes(), "{}", kind.name());
    }
}

#[test]
fn no_number_crosses_a_word_of_the_can_image() {
    for kind in MessageKind::ALL {
        assert_eq!((kind.payload_bytes() + 4) % 8, 0, "{}", kind.name());
        for field in fields(kind) {
            if !matches!(field.ty, FieldType::Bytes(_) | FieldType::Text(_) | FieldType::Zero(_)) {
                let at = image_at(field.at);
                let last = at + field.ty.bytes() - 1;
                assert_eq!(at / 8, last / 8, "{}.{}", kind.name(), field.name);
            }
        }
    }
}
