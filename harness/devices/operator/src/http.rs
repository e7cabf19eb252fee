//! Requests of a browser: one on each connection, within bounds of size and time.
//!
//! Whoever reaches the port may send anything before the token is seen. So a request is small, its connection has a
//! deadline, and nothing is allocated by a length that the other side names.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Most bytes of a request, with its headers.
const LARGEST: usize = 1 << 16;

/// Most headers of a request: browsers send about twenty.
const HEADERS: usize = 64;

/// Time for a request to arrive, and for its reply to be taken.
const DEADLINE: Duration = Duration::from_secs(5);

/// A request.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Request {
    pub(crate) method: String,
    /// Path without query.
    pub(crate) path: String,
    /// Value of the header that was asked for.
    pub(crate) header: Option<String>,
    /// True if a page of another origin made the request: its browser says so.
    pub(crate) foreign: bool,
    pub(crate) body: Vec<u8>,
}

/// Reasons why there is no request.
pub(crate) enum NoRequest {
    /// It isn't one: the status that says so.
    Bad(u16),
    /// The connection has ended, or its time is over.
    Gone,
}

impl From<io::Error> for NoRequest {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

/// Reads the request of a connection, with the value of one of its headers.
pub(crate) fn read(stream: &mut TcpStream, header: &str) -> Result<Request, NoRequest> {
    let begun = Instant::now();
    let mut bytes = Vec::new();
    loop {
        let left = DEADLINE.saturating_sub(begun.elapsed());
        // A time of zero would be none.
        if left.is_zero() {
            return Err(NoRequest::Gone);
        }
        stream.set_read_timeout(Some(left))?;
        let mut more = [0; 4096];
        let count = stream.read(&mut more)?;
        if count == 0 {
            return Err(NoRequest::Gone);
        }
        bytes.extend_from_slice(&more[..count]);
        if let Some(request) = parse(&bytes, header).map_err(NoRequest::Bad)? {
            return Ok(request);
        }
        if bytes.len() > LARGEST {
            return Err(NoRequest::Bad(413));
        }
    }
}

/// Reads a request from its bytes so far; `None`: there are more to come.
pub(crate) fn parse(bytes: &[u8], header: &str) -> Result<Option<Request>, u16> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let from = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(from)) => from,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(_) => return Err(400),
    };
    let value = |name: &str| {
        let mut all = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
        match (all.next(), all.next()) {
            (None, _) => Ok(None),
            (Some(one), None) => std::str::from_utf8(one.value).map(Some).map_err(|_| 400_u16),
            // Two of a kind: which one counts isn't said.
            (Some(_), Some(_)) => Err(400),
        }
    };
    if value("Transfer-Encoding")?.is_some() {
        return Err(411);
    }
    let length = match value("Content-Length")? {
        None => 0,
        Some(text) => text.trim().parse::<usize>().map_err(|_| 400_u16)?,
    };
    if length > LARGEST {
        return Err(413);
    }
    let body = &bytes[from..];
    if body.len() < length {
        return Ok(None);
    }
    let path = parsed.path.unwrap_or_default();
    let foreign =
        value("Origin")?.is_some_and(|origin| !is_of(origin, value("Host").ok().flatten()));
    Ok(Some(Request {
        method: parsed.method.unwrap_or_default().to_owned(),
        path: path.split(['?', '#']).next().unwrap_or_default().to_owned(),
        header: value(header)?.map(|text| text.trim().to_owned()),
        foreign,
        body: body[..length].to_vec(),
    }))
}

/// Returns whether an origin, `SCHEME://HOST:PORT`, is the host that was asked.
fn is_of(origin: &str, host: Option<&str>) -> bool {
    let authority = origin.trim().split_once("://").map(|(_, authority)| authority);
    authority.zip(host).is_some_and(|(origin, host)| origin.eq_ignore_ascii_case(host.trim()))
}

/// Sends a reply, after which the connection ends.
pub(crate) fn reply(stream: &mut TcpStream, status: u16, kind: &str, text: &str) -> io::Result<()> {
    let reason = match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        409 => "Conflict",
        411 => "Length Required",
        413 => "Content Too Large",
        503 => "Service Unavailable",
        _ => "Internal Server Error",
    };
    let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; \
                  frame-ancestors 'none'";
    let head = format!(
        "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\n\
         Connection: close\r\nCache-Control: no-store\r\nContent-Security-Policy: {policy}\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: same-origin\r\n\r\n",
        text.len()
    );
    stream.set_write_timeout(Some(DEADLINE))?;
    stream.write_all(format!("{head}{text}").as_bytes())?;
    stream.shutdown(std::net::Shutdown::Write)
}
