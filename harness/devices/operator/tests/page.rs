//! The page and its connections: those without the token keep nobody out, and other pages aren't heard.

use crate::{asked, parts, step};
use octant_operator::page::BoundPage;
use octant_operator::{Desk, OperatorStep};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;

const ABORT: &str = r#"{"do":"abort","by":"Ada"}"#;

struct Page {
    desk: Arc<Desk>,
    address: String,
    token: String,
    served: octant_operator::page::ServedPage,
}

impl Page {
    fn new(folder: &Path) -> Self {
        let question: OperatorStep = step(parts("door"));
        let desk = Arc::new(asked(folder, question));
        let bound = BoundPage::bind("127.0.0.1:0").unwrap();
        let url = bound.url().strip_prefix("http://").unwrap().to_owned();
        let (address, token) = url.split_once("/#").unwrap();
        let (address, token) = (address.to_owned(), token.to_owned());
        let served = bound.serve("a run", Arc::clone(&desk)).unwrap();
        Self { desk, address, token, served }
    }

    fn connect(&self) -> TcpStream {
        TcpStream::connect(&self.address).unwrap()
    }

    /// Sends a request; returns the status.
    fn asks(&self, request: &str, host: &str, more: &str, body: &str) -> String {
        let mut stream = self.connect();
        let length = body.len();
        write!(
            stream,
            "{request} HTTP/1.1\r\nHost: {host}\r\n{more}Content-Length: {length}\r\n\r\n{body}"
        )
        .unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        reply.split(' ').nth(1).unwrap().to_owned()
    }

    fn with_token(&self, more: &str) -> String {
        format!("X-Octant-Token: {}\r\n{more}", self.token)
    }
}

#[test]
fn idle_connections_do_not_lock_the_abort() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new(folder.path());
    let mut idle: Vec<TcpStream> = (0..40).map(|_| page.connect()).collect();
    assert_eq!(page.asks("POST /do", &page.address, &page.with_token(""), ABORT), "200");
    assert!(page.desk.aborted().is_some());
    // The oldest have given way, and the rest ends with the page.
    let end = |stream: &mut TcpStream| stream.read(&mut [0; 8]).unwrap_or(0);
    assert_eq!(end(&mut idle[0]), 0);
    let Page { served, .. } = page;
    drop(served);
    for stream in &mut idle {
        assert_eq!(end(stream), 0);
    }
}

#[test]
fn a_page_of_another_origin_is_refused_even_with_the_token() {
    let folder = tempfile::tempdir().unwrap();
    let page = Page::new(folder.path());
    let own = page.address.clone();
    let origin = |origin: &str| page.with_token(&format!("Origin: {origin}\r\n"));
    for other in ["http://evil.example", "null", "http://localhost:1", "", &own] {
        assert_eq!(page.asks("POST /do", &own, &origin(other), ABORT), "403", "{other}");
        assert_eq!(page.asks("GET /", &own, &format!("Origin: {other}\r\n"), ""), "403");
    }
    assert!(page.desk.aborted().is_none());
    // Its own page, also where a tunnel gives it another name.
    let tunnel = "localhost:9000";
    assert_eq!(page.asks("GET /state", tunnel, &origin("http://localhost:9000"), ""), "200");
    assert_eq!(page.asks("POST /do", &own, &origin(&format!("http://{own}")), ABORT), "200");
}
