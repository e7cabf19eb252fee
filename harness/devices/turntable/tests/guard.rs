//! The guard stops the table unless it is released.

use octant_turntable::{FAREWELL, guard};
use std::io;

fn run(farewell: bool) -> (bool, Vec<u8>) {
    let mut input = Vec::new();
    input.extend(0u32.to_le_bytes());
    input.extend(4u32.to_le_bytes());
    input.extend(b"STO\n..");
    if farewell {
        input.push(FAREWELL);
    }
    let mut line = Vec::new();
    let well = guard(io::Cursor::new(input), &mut line).unwrap();
    (well, line)
}

#[test]
fn it_stops_the_table_unless_it_was_told_farewell() {
    assert_eq!(run(true), (true, Vec::new()));
    assert_eq!(run(false), (false, b"STO\nSTO\n".to_vec()));
}
