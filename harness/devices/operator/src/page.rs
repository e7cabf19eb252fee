//! The page in a browser: open questions with their buttons, and hold, resume and abort.
//!
//! It is served by the run itself, on this host alone unless an address says otherwise. Every request needs the token
//! that the run prints: without it nothing is told and nothing is taken, so that neither another user of the host nor a
//! page from elsewhere in the same browser can answer. There is no encryption.

use crate::answer::AnswerForm;
use crate::desk::{Desk, OpenQuestion};
use crate::http::{self, NoRequest};
use crate::mailbox::{DeskReply, DeskRequest};
use crate::record::AnswerWay;
use serde::Serialize;
use std::collections::VecDeque;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Address by default: this host alone, any free port.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:0";

/// Name of the header with the token.
const TOKEN: &str = "X-Octant-Token";

/// Most connections at a time without the token. A further one takes the place of the oldest.
const STRANGERS_MAX: usize = 16;

/// Most connections at a time with the token, beside the others; further ones are refused.
const KNOWN_MAX: usize = 16;

/// Pause between two looks for a connection.
const LOOK: Duration = Duration::from_millis(20);

/// A page whose address is taken, and that isn't served yet: a browser that comes early waits.
#[derive(Debug)]
pub struct BoundPage {
    listener: TcpListener,
    token: String,
    url: String,
}

/// A page that is served until it is dropped.
#[derive(Debug)]
pub struct ServedPage {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
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

impl BoundPage {
    /// Takes an address, `HOST:PORT`.
    ///
    /// # Errors
    /// If the address can't be listened at.
    pub fn bind(address: &str) -> Result<Self, PageError> {
        let failed = |reason: String| PageError { address: address.to_owned(), reason };
        let parsed: SocketAddr = address.parse().map_err(|_| {
            failed("expected an address and a port, such as 127.0.0.1:8080".to_owned())
        })?;
        let refused = |error: std::io::Error| failed(error.to_string());
        let listener = TcpListener::bind(parsed).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|error| failed(error.to_string()))?;
        let token: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let url = format!("http://{}/#{token}", listener.local_addr().map_err(refused)?);
        Ok(Self { listener, token, url })
    }

    /// Address for the browser, with the token behind `#`, which a browser doesn't send.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Serves the page of a desk.
    ///
    /// # Errors
    /// If there is no thread for it.
    pub fn serve(self, title: &str, desk: Arc<Desk>) -> Result<ServedPage, PageError> {
        let Self { listener, token, url } = self;
        let over = Arc::new(AtomicBool::new(false));
        let (ends, shown) =
            (Arc::clone(&over), Arc::new(Shown { title: title.to_owned(), token, desk }));
        let thread = std::thread::Builder::new().name("page".to_owned());
        let thread = thread.spawn(move || listen(&listener, &shown, &ends));
        let thread =
            thread.map_err(|error| PageError { address: url, reason: error.to_string() })?;
        Ok(ServedPage { over, thread: Some(thread) })
    }
}

impl Drop for ServedPage {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // Only the page has failed, not the run.
            let _ = thread.join();
        }
    }
}

/// What the connections of a page have in common.
struct Shown {
    title: String,
    token: String,
    desk: Arc<Desk>,
}

/// Connections that are open. Those that haven't shown the token can't keep out one that will: they give way to it.
#[derive(Debug, Default)]
struct Connections(Mutex<Open>);

#[derive(Debug, Default)]
struct Open {
    /// Connections without the token so far, the oldest first, by their number.
    strangers: VecDeque<(u64, TcpStream)>,
    taken: u64,
    /// Number of connections with the token.
    known: usize,
}

/// Place of a connection, free again when it is dropped.
struct ConnectionPlace {
    of: Arc<Connections>,
    number: u64,
    known: bool,
}

impl Connections {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives a connection a place, and ends the oldest stranger where there is no other.
    fn take(self: &Arc<Self>, stream: &TcpStream) -> std::io::Result<ConnectionPlace> {
        let stream = stream.try_clone()?;
        let mut open = self.open();
        if open.strangers.len() >= STRANGERS_MAX
            && let Some((_, oldest)) = open.strangers.pop_front()
        {
            let _ = oldest.shutdown(Shutdown::Both);
        }
        open.taken += 1;
        let number = open.taken;
        open.strangers.push_back((number, stream));
        Ok(ConnectionPlace { of: Arc::clone(self), number, known: false })
    }

    /// Ends all strangers.
    fn end(&self) {
        for (_, stream) in self.open().strangers.drain(..) {
            let _ = stream.shutdown(Shutdown::Both);
        }
    }
}

impl ConnectionPlace {
    /// Moves a connection with the token among those. False: there are too many.
    fn known(&mut self) -> bool {
        let mut open = self.of.open();
        if open.known >= KNOWN_MAX {
            return false;
        }
        open.strangers.retain(|(number, _)| *number != self.number);
        open.known += 1;
        self.known = true;
        true
    }
}

impl Drop for ConnectionPlace {
    fn drop(&mut self) {
        let mut open = self.of.open();
        if self.known {
            open.known -= 1;
        } else {
            open.strangers.retain(|(number, _)| *number != self.number);
        }
    }
}

/// Takes connections until the page is over, each on a thread of its own: a slow one delays no other, and not the end.
fn listen(listener: &TcpListener, shown: &Arc<Shown>, over: &AtomicBool) {
    let connections = Arc::new(Connections::default());
    while !over.load(Ordering::Relaxed) {
        let Ok((mut stream, _)) = listener.accept() else {
            std::thread::sleep(LOOK);
            continue;
        };
        // On some systems it has the mode of its listener.
        if stream.set_nonblocking(false).is_err() {
            continue;
        }
        let Ok(mut place) = connections.take(&stream) else { continue };
        let shown = Arc::clone(shown);
        let answer = move || answer(&mut stream, &shown, &mut place);
        // Without a thread the connection ends.
        let _ = std::thread::Builder::new().name("page request".to_owned()).spawn(answer);
    }
    connections.end();
}

const TEXT: &str = "text/plain";

/// Answers a request. A browser that went away is no failure.
fn answer(stream: &mut TcpStream, shown: &Shown, place: &mut ConnectionPlace) {
    let (status, kind, text) = match http::read(stream, TOKEN) {
        Ok(request) => replied(&request, shown, place),
        Err(NoRequest::Bad(status)) => (status, TEXT, "the request can't be read\n".to_owned()),
        Err(NoRequest::Gone) => return,
    };
    let _ = http::reply(stream, status, kind, &text);
}

/// Status, kind and text of a reply.
fn replied(
    request: &http::Request,
    shown: &Shown,
    place: &mut ConnectionPlace,
) -> (u16, &'static str, String) {
    let Shown { title, token, desk } = shown;
    if request.foreign {
        return (403, TEXT, "the request is of a page of another origin\n".to_owned());
    }
    let asked = (request.method.as_str(), request.path.as_str());
    if asked == ("GET", "/") {
        return (200, "text/html", include_str!("page.html").to_owned());
    }
    if !request.header.as_ref().is_some_and(|given| is_same(given, token)) {
        return (403, TEXT, "the token is missing or wrong\n".to_owned());
    }
    if !place.known() {
        return (503, TEXT, "too many connections\n".to_owned());
    }
    let (status, text) = match asked {
        ("GET", "/state") => {
            let log = desk.records_from(0);
            let state = PageState {
                title: title.clone(),
                questions: desk.questions().into_iter().map(PageQuestion::of).collect(),
                held: desk.is_held(),
                aborted: desk.aborted(),
                log: log.iter().map(|record| format!("{} {}", record.at, record.text())).collect(),
            };
            (200, serde_json::to_string(&state))
        }
        ("POST", "/do") => {
            let told = match serde_json::from_slice::<DeskRequest>(&request.body) {
                Ok(asked) => asked.apply(desk, AnswerWay::Page),
                Err(_) => DeskReply::Refused("the request can't be read".to_owned()),
            };
            let status = if matches!(told, DeskReply::Taken(_)) { 200 } else { 409 };
            (status, serde_json::to_string(&told))
        }
        _ => return (404, TEXT, "there is no such page\n".to_owned()),
    };
    match text {
        Ok(text) => (status, "application/json", text),
        Err(error) => (500, TEXT, error.to_string()),
    }
}

/// Compares in a time that doesn't tell how much of it is right.
fn is_same(found: &str, expected: &str) -> bool {
    let differs = found.bytes().zip(expected.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b));
    found.len() == expected.len() && differs == 0
}
