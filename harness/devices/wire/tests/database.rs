//! The CAN database equals the one that the code generates.

use octant_wire::can;

#[test]
fn the_shipped_database_is_the_one_of_the_code() {
    let mut made = String::new();
    can::write_dbc(&mut made).unwrap();
    assert!(made.is_ascii(), "tools differ in what they take the rest for");
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/can/octant.dbc");
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::create_dir_all(std::path::Path::new(file).parent().unwrap()).unwrap();
        std::fs::write(file, &made).unwrap();
    }
    let shipped = std::fs::read_to_string(file).unwrap_or_default();
    assert!(shipped == made, "run this test with OCTANT_WRITE_FIXTURES=1 to write the database");
}
