//! Ports of devices: one way to write them, and the defaults of each device where users read them.

use crate::common::program::ends;
use octant_link::uri::DEFAULT_BAUD;
use octant_power::POWER_PORT;
use octant_turntable::TABLE_PORT;
use std::path::Path;

const QUICK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/quick.toml");

fn page(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    std::fs::read_to_string(root.join(name)).unwrap()
}

/// Text in one line, without the marks of comments.
fn words(text: &str) -> String {
    text.replace("\n#", "\n").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn pages_help_and_keys_tell_the_defaults_that_are_used() {
    let endpoints = page("docs/endpoints.md");
    let port =
        |default: Option<u16>| default.map_or("none, it is written".to_owned(), |p| p.to_string());
    for row in [
        format!("| none, it is written | {DEFAULT_BAUD} |"),
        format!(
            "| [turntable](turntable.md) | {} | {} |",
            port(TABLE_PORT.default_port),
            TABLE_PORT.default_baud
        ),
        format!(
            "| [supply or relays](power.md) | {} | {} |",
            port(POWER_PORT.default_port),
            POWER_PORT.default_baud
        ),
        format!("`baud`, default {DEFAULT_BAUD} |"),
        format!("within {} s", octant_base::address::CONNECT_LIMIT.as_secs()),
    ] {
        assert!(endpoints.contains(&row), "docs/endpoints.md lacks {row:?}");
    }
    let tour = words(&page("fixtures/scenarios/tour.toml"));
    for (ports, page_name, help) in [
        (TABLE_PORT, "docs/turntable.md", &["turntable", "status", "--help"][..]),
        (POWER_PORT, "docs/power.md", &["power", "--help"][..]),
    ] {
        let expected = ports.expected();
        assert!(page(page_name).replace('`', "").contains(&expected), "{page_name}: {expected}");
        assert!(tour.contains(&expected), "tour.toml: {expected}");
        let said = words(&ends(help, 0).0);
        assert!(said.contains(&expected), "{said}");
    }
    let expected = format!("serial:/dev/ttyUSB0?baud={DEFAULT_BAUD} (the default rate)");
    assert_eq!(tour.matches(&expected).count(), 2, "source.uri and endpoint.uri");
    for command in ["serve", "capture"] {
        let said = words(&ends(&[command, "--help"], 0).0);
        assert!(said.contains(&format!("({DEFAULT_BAUD} by default)")), "{said}");
    }
}

#[test]
fn an_address_is_refused_by_every_device_in_the_same_words() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("bytes");
    let expected = "expected tcp:[::1]:5025: an IPv6 address is in brackets";
    for arguments in [
        &["power", "tcp:::1:5025", "status"][..],
        &["turntable", "status", "tcp:::1:5025"],
        &["capture", "tcp:::1:5025", "--out", out.to_str().unwrap()],
        &["serve", "--endpoint", "tcp:::1:5025"],
        &["run", QUICK, "--endpoint", "tcp:::1:5025"],
    ] {
        let (_, error) = ends(arguments, 2);
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
}

#[test]
fn a_connection_that_fails_is_told_without_a_lesson_on_its_address() {
    for (arguments, port) in [
        (&["turntable", "status", "tcp:127.0.0.1:1"][..], "tcp:127.0.0.1:1"),
        (&["power", "tcp:localhost:1", "status"], "tcp:localhost:1"),
        (&["turntable", "status", "serial:/no/such/port"], "serial:/no/such/port?baud=115200"),
        (&["power", "serial:/no/such/port", "status"], "serial:/no/such/port?baud=9600"),
    ] {
        let (_, error) = ends(arguments, 4);
        assert!(error.contains(&format!("open {port}: ")), "{error}");
        assert!(!error.contains("expected") && !error.contains("HOST"), "{error}");
    }
}
