use super::*;
use crate::address::parts::AddressParts;
use proptest::prelude::*;
use std::net::TcpListener;
use std::time::Duration;

const SUPPLY: InstrumentPort = InstrumentPort { default_port: Some(5025), default_baud: 9600 };
const TABLE: InstrumentPort = InstrumentPort { default_port: None, default_baud: 115_200 };

fn wire(text: &str) -> Result<HostPort, AddressError> {
    let rest = text.strip_prefix("tcp:").expect("begins with the scheme");
    HostForm::Wire.read(&AddressParts::read(text, rest, "tcp", &[])?, "tcp")
}

fn refused<T: std::fmt::Debug>(read: Result<T, AddressError>) -> String {
    read.expect_err("is refused").to_string()
}

#[test]
fn an_address_is_the_same_for_every_device_but_for_its_defaults() {
    for text in ["tcp:192.168.1.30:5025", "tcp:psu:5025", "tcp:[::1]:5025", "tcp:[fe80::7%eth0]:1"]
    {
        let address = wire(text).expect("is one");
        assert_eq!(format!("tcp:{address}"), text);
        for device in [SUPPLY, TABLE] {
            assert_eq!(device.parse(text), Ok(InstrumentAddress::Tcp(address.clone())), "{text}");
        }
    }
    for (text, found) in [
        ("tcp:localhost", "tcp:localhost:5025"),
        ("tcp:[::1]", "tcp:[::1]:5025"),
        ("serial:/dev/ttyS0", "serial:/dev/ttyS0?baud=9600"),
        ("serial:COM3?baud=115200", "serial:COM3?baud=115200"),
    ] {
        assert_eq!(SUPPLY.parse(text).expect("is one").to_string(), found);
    }
    let line = TABLE.parse("serial:/dev/ttyS0").expect("is one");
    assert_eq!(line.to_string(), "serial:/dev/ttyS0?baud=115200");
    // Without a default the port has to be written.
    assert!(refused(TABLE.parse("tcp:localhost")).ends_with("expected tcp:HOST:PORT"));
    // Loopback is written by its port alone where either end may be.
    for (text, found) in [("tcp:5005", ":5005"), ("tcp::5005", ":5005"), ("tcp::0", ":0")] {
        assert_eq!(wire(text).expect("is one").to_string(), found);
    }
}

#[test]
fn an_ipv6_address_without_brackets_is_refused_with_what_to_write() {
    for (text, write) in [
        ("tcp:::1:5025", "tcp:[::1]:5025"),
        ("tcp:fe80::7:80", "tcp:[fe80::7]:80"),
        ("tcp:::1", "tcp:[::1]:PORT"),
        ("tcp:fe80::beef", "tcp:[fe80::beef]:PORT"),
    ] {
        let expected = format!("found {text:?}, expected {write}: an IPv6 address is in brackets");
        for words in [refused(wire(text)), refused(SUPPLY.parse(text)), refused(TABLE.parse(text))]
        {
            assert!(words.starts_with(&expected), "{words}");
        }
    }
}

#[test]
fn what_is_no_address_is_refused_with_the_forms_and_defaults() {
    for text in [
        "psu",
        "can:can0",
        "tcp:",
        "tcp:host:",
        "tcp::80",
        "tcp:5025",
        "tcp:host:0",
        "tcp:host:65536",
        "tcp:host:+80",
        "tcp:http://host",
        "tcp:a b",
        "tcp:[::1",
        "tcp:[::1]80",
        "tcp:[host]:80",
        "tcp:[fe80::7%]:80",
        "serial:",
    ] {
        let words = refused(SUPPLY.parse(text));
        let expected = format!(
            "found {text:?}, expected tcp:HOST or tcp:HOST:PORT (5025 by default), or \
             serial:DEVICE?baud=RATE (9600 by default)"
        );
        // After tcp: the serial line is of no interest.
        let forms = expected.split(", or ").next().expect("has a beginning");
        assert!(words.starts_with(forms), "{words}");
    }
    assert!(refused(SUPPLY.parse("serial:COM1?boud=1")).contains("expected baud?"));
    assert!(refused(SUPPLY.parse("serial:COM1?baud=0")).contains("found baud=0"));
    assert!(refused(SUPPLY.parse("tcp:psu?baud=1")).contains("it has no options"));
}

#[test]
fn a_connection_that_is_refused_says_that_alone() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = listener.local_addr().expect("has an address").port();
    let at = |host: &str| HostPort { host: host.to_owned(), port };
    at("").connect(CONNECT_LIMIT).expect("is loopback");
    at("localhost").connect(CONNECT_LIMIT).expect("is loopback");
    drop(listener);
    let error = at("127.0.0.1").connect(CONNECT_LIMIT).expect_err("nobody listens");
    assert_eq!(error.kind(), std::io::ErrorKind::ConnectionRefused);
    assert!(!error.to_string().contains("expected"), "{error}");
    let nobody = HostPort { host: String::new(), port: 0 };
    assert!(nobody.connect(CONNECT_LIMIT).is_err());
    let error = at("no.such.host.invalid").resolve(Duration::from_secs(60));
    assert!(error.expect_err("has none").to_string().contains("no.such.host.invalid"));
}

/// A listener whose queue is full answers nobody: the connection ends by its limit.
#[cfg(target_os = "linux")]
#[test]
fn a_connection_that_nobody_answers_ends_by_its_limit() {
    use rustix::net::{AddressFamily, SocketFlags, SocketType, bind, connect, getsockname, listen};
    use rustix::net::{socket, socket_with};
    use std::net::{Ipv4Addr, SocketAddr};
    let deaf = socket(AddressFamily::INET, SocketType::STREAM, None).expect("a socket");
    bind(&deaf, &SocketAddr::from((Ipv4Addr::LOCALHOST, 0))).expect("a port is free");
    listen(&deaf, 0).expect("listens");
    let address: SocketAddr = getsockname(&deaf).expect("a name").try_into().expect("of IP");
    // Nobody accepts these, so they fill the queue.
    let waiting = || {
        let kind = (AddressFamily::INET, SocketType::STREAM, SocketFlags::NONBLOCK);
        let waiting = socket_with(kind.0, kind.1, kind.2, None).expect("a socket");
        let _ = connect(&waiting, &address);
        waiting
    };
    let _held: Vec<_> = (0..16).map(|_| waiting()).collect();
    let at = HostPort { host: "127.0.0.1".to_owned(), port: address.port() };
    let error = at.connect(Duration::from_millis(50)).expect_err("nobody answers");
    assert_eq!(error.to_string(), "nobody answered within 50ms");
}

proptest! {
    #[test]
    fn every_text_is_read_without_a_panic_and_comes_back(text in any_text()) {
        for device in [SUPPLY, TABLE] {
            if let Ok(address) = device.parse(&text) {
                prop_assert_eq!(device.parse(&address.to_string()), Ok(address));
            }
        }
        let text = format!("tcp:{text}");
        if let Ok(address) = wire(&text) {
            prop_assert_eq!(wire(&format!("tcp:{address}")), Ok(address));
        }
    }

    #[test]
    fn every_address_comes_back_from_its_text(
        host in prop_oneof![
            "[a-z][a-z0-9.-]{0,20}",
            any::<std::net::Ipv4Addr>().prop_map(|ip| ip.to_string()),
            any::<std::net::Ipv6Addr>().prop_map(|ip| ip.to_string()),
        ],
        port in 1_u16..,
        path in "[A-Za-z0-9/:._-]{1,30}",
        baud in 1_u32..,
    ) {
        for address in [
            InstrumentAddress::Tcp(HostPort { host, port }),
            InstrumentAddress::Serial(SerialAddress { path, baud }),
        ] {
            prop_assert_eq!(TABLE.parse(&address.to_string()), Ok(address));
        }
    }
}

/// Texts of all kinds, most of them near to an address.
fn any_text() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        Just("tcp:".to_owned()),
        Just("serial:".to_owned()),
        Just("[".to_owned()),
        Just("]".to_owned()),
        Just(":".to_owned()),
        Just("::1".to_owned()),
        Just("%".to_owned()),
        Just("?baud=".to_owned()),
        "[0-9]{0,6}",
        "[a-z]{0,4}",
        any::<String>(),
    ];
    prop::collection::vec(part, 0..7).prop_map(|parts| parts.concat())
}
