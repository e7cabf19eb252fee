//! Descriptions that are refused: file and line, key, what was found, what was expected.

use octant_instruments::description::UnitDescription;

const TEXT: &str = r#"version = 1
name = "a unit"
byte_order = "big"
checksum = { kind = "sum8", at = -1 }
[[frame]]
sync = [0xA5, 0x5A]
length = 28
field = [
    { is = "gyro x", at = 2, type = "i32", unit = "rad", scale = 1e-9 },
    { is = "gyro y", at = 6, type = "i32", unit = "rad", scale = 1e-9 },
    { is = "gyro z", at = 10, type = "i32", unit = "rad", scale = 1e-9 },
    { is = "accel x", at = 14, type = "i32", unit = "m/s", scale = 1e-9 },
    { is = "accel y", at = 18, type = "i32", unit = "m/s", scale = 1e-9 },
    { is = "accel z", at = 22, type = "i32", unit = "m/s", scale = 1e-9 },
    { is = "counter", at = 26, type = "u8", mask = 0x7F },
]
"#;

/// Message of the text with one passage replaced.
fn said(old: &str, new: &str) -> String {
    assert_eq!(TEXT.matches(old).count(), 1, "{old}");
    let text = TEXT.replace(old, new);
    UnitDescription::parse("unit.toml", &text).unwrap_err().to_string()
}

#[test]
fn what_is_wrong_is_told_with_line_and_key() {
    UnitDescription::parse("unit.toml", TEXT).unwrap();
    for (old, new, expected) in [
        (
            "version = 1",
            "version = 3",
            "unit.toml:1: version: found 3, but this program reads descriptions up to version 2: use a newer Octant",
        ),
        ("version = 1", "", "unit.toml:1: version: missing, expected version = 2"),
        (
            "name = \"a unit\"",
            "nmae = \"a unit\"",
            "unit.toml:2: nmae: unknown key; did you mean \"name\"? known keys: version, name, byte_order, checksum, frame",
        ),
        (
            "\"big\"",
            "\"bug\"",
            "unit.toml:3: byte_order: found \"bug\"; did you mean \"big\"? expected one of: little, big",
        ),
        (
            "\"sum8\"",
            "\"sum12\"",
            "unit.toml:4: checksum.kind: found \"sum12\"; did you mean \"sum16\"? expected one of: none, sum8, sum16, words16, xor8, crc8, crc16, crc32",
        ),
        (
            "\"sum8\", at = -1",
            "\"sum8\"",
            "unit.toml:4: checksum.at: missing, expected the offset of the checksum's first byte",
        ),
        (
            "\"sum8\", at = -1",
            "\"sum16\", at = -1",
            "unit.toml:4: checksum.at: found -1, from which 2 bytes don't end within the frame's 28",
        ),
        (
            "at = -1",
            "at = -1, to = 28",
            "unit.toml:4: checksum: it covers the bytes from 0 to before 28, expected bytes without the checksum itself, at 27",
        ),
        (
            "kind = \"sum8\"",
            "kind = \"crc16\"",
            "unit.toml:4: checksum.poly: missing, expected a parameter of the CRC",
        ),
        (
            "kind = \"sum8\", at = -1",
            "kind = \"crc16\", at = -2, poly = 0x1021, init = 0, refin = false, refout = false, xorout = 0, check = 0x2189",
            "unit.toml:4: checksum.check: found 0x2189, but these parameters give 0x31c3 of the characters 123456789",
        ),
        (
            "kind = \"sum8\"",
            "kind = \"sum8\", poly = 7",
            "unit.toml:4: checksum.poly: unknown key; known keys: kind, from, to, at, byte_order, pad_to",
        ),
        (
            "[0xA5, 0x5A]",
            "[0x1A5]",
            "unit.toml:6: frame[0].sync: found an array of 1, expected an array of 1 to 8 bytes, such as [0xFE, 0x81]",
        ),
        (
            "length = 28",
            "length = 2800",
            "unit.toml:7: frame[0].length: found 2800, expected a whole number from 2 to 1024",
        ),
        (
            "length = 28",
            "",
            "unit.toml:5: frame[0].length: missing, expected the number of the frame's bytes, its sync and checksum with them",
        ),
        (
            "at = 22",
            "at = 25",
            "unit.toml:14: frame[0].field[5].at: found 25, from which 4 bytes don't end within the frame's 28",
        ),
        (
            "\"accel z\"",
            "\"accel x\"",
            "unit.toml:14: frame[0].field[5].is: found a second time in the frame, expected once",
        ),
        (
            "{ is = \"accel z\", at = 22, type = \"i32\", unit = \"m/s\", scale = 1e-9 },",
            "",
            "unit.toml:8: frame[0].field: found 2 of accel x, accel y and accel z, expected all three or none",
        ),
        (
            "at = 10, type = \"i32\", unit = \"rad\"",
            "at = 10, type = \"i32\", unit = \"deg/s\"",
            "unit.toml:11: frame[0].field[2].unit: found another quantity than that of the other axes of the gyros, expected increments of all or rates of all",
        ),
        (
            "at = 10, type = \"i32\", unit = \"rad\"",
            "at = 10, type = \"i32\", unit = \"m/s\"",
            "unit.toml:11: frame[0].field[2].unit: found \"m/s\", expected one of rad, mrad, urad, deg, arcsec, rad/s, mrad/s, deg/s, deg/h",
        ),
        (
            "at = 10, type = \"i32\"",
            "at = 10, type = \"int32\"",
            "unit.toml:11: frame[0].field[2].type: found \"int32\"; expected one of: i8, u8",
        ),
        (
            "at = 10, type = \"i32\", unit = \"rad\", scale = 1e-9",
            "at = 10, type = \"i32\", unit = \"rad\", scale = 0",
            "unit.toml:11: frame[0].field[2].scale: found 0, expected another number",
        ),
        (
            "mask = 0x7F",
            "mask = 0x75",
            "unit.toml:15: frame[0].field[6].mask: found 0x75, expected bits beside each other, such as 0x7F or 0x0FF0",
        ),
        (
            "mask = 0x7F",
            "modulo = 300",
            "unit.toml:15: frame[0].field[6].modulo: found 300, expected a whole number from 2 to 256",
        ),
        (
            "mask = 0x7F",
            "unit = \"s\"",
            "unit.toml:15: frame[0].field[6].unit: unknown key; known keys: is, at, type, byte_order, mask, modulo",
        ),
        (
            "is = \"counter\"",
            "is = \"status\"",
            "unit.toml:15: frame[0].field[6]: no bit has a meaning, expected good, faulty, gyro_saturated or accel_saturated",
        ),
        (
            "[[frame]]",
            "[[frame]]\nforms = [{ sync = [1], length = 28 }]",
            "unit.toml:7: frame[0].sync: found beside forms, expected it in each of the forms",
        ),
    ] {
        let found = said(old, new);
        assert!(found.starts_with(expected), "found    {found}\nexpected {expected}");
    }
}

#[test]
fn frames_that_begin_alike_are_refused() {
    let text = format!("{TEXT}[[frame]]\nsync = [0xA5]\nlength = 9\n");
    let found = UnitDescription::parse("unit.toml", &text).unwrap_err().to_string();
    let expected = "unit.toml:18: frame[1].sync: found [a5], which can't be told from [a5, 5a] of a frame before it";
    assert_eq!(found, expected);
}

#[test]
fn what_is_no_description_is_refused() {
    let said = |text: &str| UnitDescription::parse("unit.toml", text).unwrap_err().to_string();
    assert!(said("version = 1\nname = x\n").starts_with("unit.toml:2: not TOML: "));
    assert_eq!(
        said("version = 1\nname = \"a\"\n"),
        "unit.toml:1: frame: missing, expected one [[frame]] at least"
    );
    let only = "version = 1\nname = \"a\"\n[[frame]]\nsync = [1]\nlength = 9\nchecksum = { kind = \"none\" }\n";
    assert_eq!(
        said(only),
        "unit.toml:3: frame: found no frame with gyros and accelerometers, expected one at least: a reading has both"
    );
}
