//! Room on the stack.

use super::room::with_room;
use std::panic::catch_unwind;

#[test]
fn results_and_panics_come_back() {
    let mut here = 1;
    assert_eq!(with_room(|| here += 1), ());
    assert_eq!(here, 2);
    let panic = catch_unwind(|| with_room(|| -> u8 { std::panic::panic_any("gone") }));
    assert_eq!(panic.unwrap_err().downcast_ref::<&str>(), Some(&"gone"));
}
