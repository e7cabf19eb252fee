//! The gate of the server for Foxglove: whom it lets in, how many, and that no client keeps the server from its end.

use octant_watch::foxglove::FoxgloveServer;
use octant_watch::gate::{CLIENTS_MAX, may_read};
use std::io::{Read, Write};
use std::net::{IpAddr, TcpStream};
use std::sync::mpsc::channel;
use std::time::Duration;

/// Limit that ends a test which hangs.
const PATIENCE: Duration = Duration::from_secs(300);

fn connect(server: &FoxgloveServer) -> TcpStream {
    let stream = TcpStream::connect(("127.0.0.1", server.port())).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream
}

/// Asks for the protocol; returns the status of the reply.
fn asks(stream: &mut TcpStream, more: &str) -> String {
    write!(
        stream,
        "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n{more}\r\n"
    )
    .unwrap();
    let mut status = [0; 12];
    stream.read_exact(&mut status).unwrap();
    String::from_utf8_lossy(&status[9..]).into_owned()
}

#[track_caller]
fn stops(server: FoxgloveServer) {
    let (ended, end) = channel();
    std::thread::spawn(move || {
        server.stop();
        ended.send(()).unwrap();
    });
    end.recv_timeout(PATIENCE).unwrap();
}

#[test]
fn the_server_ends_whatever_its_clients_do() {
    let server = FoxgloveServer::start("127.0.0.1:0").unwrap();
    let idle = connect(&server);
    let mut half = connect(&server);
    half.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
    // One that never reads again.
    let mut slow = connect(&server);
    assert_eq!(asks(&mut slow, ""), "101");
    stops(server);
    drop((idle, half, slow));
}

#[test]
fn pages_of_other_origins_and_too_many_clients_are_refused() {
    let server = FoxgloveServer::start("127.0.0.1:0").unwrap();
    let origin = |origin: &str| asks(&mut connect(&server), &format!("Origin: {origin}\r\n"));
    assert_eq!(origin("https://evil.example"), "403");
    assert_eq!(origin("https://app.foxglove.dev"), "101");
    let mut clients: Vec<TcpStream> = Vec::new();
    // Those that have left may keep their places for a moment.
    let refused = loop {
        let mut stream = connect(&server);
        match asks(&mut stream, "").as_str() {
            "101" => clients.push(stream),
            status => break status.to_owned(),
        }
        assert!(clients.len() <= CLIENTS_MAX);
    };
    assert_eq!(refused, "503");
    stops(server);
}

#[test]
fn origins_that_may_read_are_those_of_foxglove_and_of_this_host() {
    let own: IpAddr = "192.168.1.7".parse().unwrap();
    for good in [
        "https://app.foxglove.dev",
        "file://",
        "app://lichtblick",
        "http://localhost:8080",
        "http://127.0.0.1:8080",
        "http://127.9.9.9",
        "http://[::1]:8080",
        "http://192.168.1.7:8080",
    ] {
        assert!(may_read(good, own), "{good}");
    }
    for bad in [
        "null",
        "",
        "http://app.foxglove.dev",
        "https://app.foxglove.dev.evil.example",
        "https://evil.example",
        "HTTPS://evil.example",
        "http://localhost.evil.example",
        "http://127.0.0.1.evil.example",
        "http://192.168.1.8:8765",
    ] {
        assert!(!may_read(bad, own), "{bad}");
    }
}

#[test]
fn the_page_has_the_number_of_clients() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/watching.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(&format!("There are {CLIENTS_MAX} places for\nclients")));
}
