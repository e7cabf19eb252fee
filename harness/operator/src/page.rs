//! The page in a browser: open questions with their buttons, and hold, resume and abort.
//!
//! It is served by the run itself, on this host alone unless an address says otherwise. Every request needs the token
//! that the run prints: without it nothing is told and nothing is taken, so that neither another user of the host nor a
//! page from elsewhere in the same browser can answer. There is no encryption.

use crate::answer::AnswerForm;
use crate::desk::{Desk, OpenQuestion};
use crate::mailbox::{DeskReply, DeskRequest};
use crate::record::AnswerWay;
use serde::Serialize;
use std::io::Read;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

/// Address by default: this host alone, any free port.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:0";

/// Most bytes of a request.
const LARGEST: u64 = 1 << 16;

/// Name of the header with the token.
const TOKEN: &str = "X-Octant-Token";

/// A page that is served until it is dropped.
pub struct Page {
    server: Arc<Server>,
    thread: Option<JoinHandle<()>>,
    url: String,
}

/// Reasons why there is no page.
#[derive(Debug, thiserror::Error)]
#[error("serve the operator's page at {address}: {reason}")]
pub struct PageError {
    /// Address.
    pub address: String,
    /// Reason.
    pub reason: String,
}

/// What the page shows.
#[derive(Serialize)]
struct PageState {
    title: String,
    questions: Vec<PageQuestion>,
    held: bool,
    aborted: Option<String>,
    log: Vec<String>,
}

#[derive(Serialize)]
struct PageQuestion {
    id: String,
    ask: String,
    expected: String,
    /// Values that have a button; empty: a field.
    buttons: Vec<String>,
    named: bool,
    left_s: Option<f64>,
}

impl PageQuestion {
    fn of(question: OpenQuestion) -> Self {
        let OpenQuestion { id, ask, form, named, left_s, .. } = question;
        let expected = form.expected();
        let buttons = match form {
            AnswerForm::Confirm | AnswerForm::YesNo => vec!["yes".to_owned(), "no".to_owned()],
            AnswerForm::Choice(choices) => choices,
            AnswerForm::Number { .. } | AnswerForm::Text => Vec::new(),
        };
        Self { id, ask, expected, buttons, named, left_s }
    }
}

impl Page {
    /// Serves the page of a desk at an address, `HOST:PORT`.
    ///
    /// # Errors
    /// If the address can't be listened at.
    pub fn start(address: &str, title: &str, desk: Arc<Desk>) -> Result<Self, PageError> {
        let failed = |reason: String| PageError { address: address.to_owned(), reason };
        let parsed: SocketAddr = address.parse().map_err(|_| {
            failed("expected an address and a port, such as 127.0.0.1:8080".to_owned())
        })?;
        let server = Arc::new(Server::http(parsed).map_err(|error| failed(error.to_string()))?);
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| failed(error.to_string()))?;
        let token: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let at = server.server_addr().to_ip().unwrap_or(parsed);
        let url = format!("http://{at}/#{token}");
        let (listener, title) = (Arc::clone(&server), title.to_owned());
        let serve = move || {
            for request in listener.incoming_requests() {
                answer(request, &title, &token, &desk);
            }
        };
        let thread = std::thread::Builder::new().name("page".to_owned()).spawn(serve);
        let thread = Some(thread.map_err(|error| failed(error.to_string()))?);
        Ok(Self { server, thread, url })
    }

    /// Address for the browser, with the token behind `#`, which a browser doesn't send.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.server.unblock();
        if let Some(thread) = self.thread.take() {
            // Only the page has failed, not the run.
            let _ = thread.join();
        }
    }
}

/// Answers a request. A browser that went away is no failure.
fn answer(mut request: Request, title: &str, token: &str, desk: &Desk) {
    let path = request.url().split(['?', '#']).next().unwrap_or_default().to_owned();
    if (request.method(), path.as_str()) == (&Method::Get, "/") {
        let _ = request.respond(reply(200, "text/html; charset=utf-8", include_str!("page.html")));
        return;
    }
    let given = request.headers().iter().find(|header| header.field.equiv(TOKEN));
    if !given.is_some_and(|header| is_same(header.value.as_str(), token)) {
        let _ = request.respond(reply(
            403,
            "text/plain; charset=utf-8",
            "the token is missing or wrong\n",
        ));
        return;
    }
    let known = match (request.method(), path.as_str()) {
        (Method::Get, "/state") => {
            let log = desk.records_from(0);
            let state = PageState {
                title: title.to_owned(),
                questions: desk.questions().into_iter().map(PageQuestion::of).collect(),
                held: desk.is_held(),
                aborted: desk.aborted(),
                log: log.iter().map(|record| format!("{} {}", record.at, record.text())).collect(),
            };
            Some((200, serde_json::to_string(&state)))
        }
        (Method::Post, "/do") => {
            let mut text = String::new();
            let read = request.as_reader().take(LARGEST).read_to_string(&mut text);
            let asked = read.ok().and_then(|_| serde_json::from_str::<DeskRequest>(&text).ok());
            let told = match asked {
                Some(asked) => asked.apply(desk, AnswerWay::Page),
                None => DeskReply::Refused("the request can't be read".to_owned()),
            };
            let status = if matches!(told, DeskReply::Taken(_)) { 200 } else { 409 };
            Some((status, serde_json::to_string(&told)))
        }
        _ => None,
    };
    let response = match known {
        Some((status, Ok(text))) => reply(status, "application/json", &text),
        Some((_, Err(error))) => reply(500, "text/plain; charset=utf-8", &error.to_string()),
        None => reply(404, "text/plain; charset=utf-8", "there is no such page\n"),
    };
    let _ = request.respond(response);
}

fn reply(status: u16, kind: &str, text: &str) -> Response<std::io::Cursor<Vec<u8>>> {
    let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'";
    let headers = [
        ("Content-Type", kind),
        ("Cache-Control", "no-store"),
        ("Content-Security-Policy", policy),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
    ];
    let response = Response::from_string(text).with_status_code(StatusCode(status));
    headers.into_iter().fold(response, |response, (name, value)| {
        // All of them are ASCII.
        match Header::from_bytes(name, value) {
            Ok(header) => response.with_header(header),
            Err(()) => response,
        }
    })
}

/// Compares in a time that doesn't tell how much of it is right.
fn is_same(found: &str, expected: &str) -> bool {
    let differs = found.bytes().zip(expected.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
    found.len() == expected.len() && differs == 0
}
