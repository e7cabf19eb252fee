//! Gate in front of the server for Foxglove, which itself waits without a limit for the greeting of a connection and
//! asks no page where it is from.
//!
//! The gate reads the request of each connection, within bounds of size and time, and passes on those that it lets in.
//! The server behind it listens at an address of this host that nobody is told.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::timeout;

/// Most clients at a time; further ones are refused.
pub const CLIENTS_MAX: usize = 16;
/// Most connections at a time that haven't made their request yet.
const GREETINGS_MAX: usize = 64;
/// Time for the request of a connection.
const GREETING: Duration = Duration::from_secs(5);
/// Time in which a client has to take something that is sent to it. Foxglove connects again.
const STALL: Duration = Duration::from_secs(30);
/// Pause after a connection that couldn't be taken.
const PAUSE: Duration = Duration::from_millis(20);
/// Largest request, bytes.
const REQUEST_BYTES_MAX: usize = 16 << 10;
/// Most headers of a request.
const HEADERS_MAX: usize = 64;
/// Host of Foxglove's own page.
const FOXGLOVE: &str = "app.foxglove.dev";

/// Gate that lets clients through to a server.
#[derive(Clone, Debug)]
pub(crate) struct Gate {
    clients: Arc<Semaphore>,
    greetings: Arc<Semaphore>,
    server: SocketAddr,
}

/// Reason for which a connection is refused: the status, and the words.
type Refusal = (&'static str, String);

/// Address for the server behind the gate, at any free port: where a whole range of addresses belongs to this host, one
/// that no page of a browser finds by trying.
pub(crate) fn hidden_address() -> io::Result<IpAddr> {
    let mut bytes = [0; 3];
    if cfg!(target_os = "linux") {
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        // Neither the first address nor the last is one of a host.
        bytes[2] = bytes[2].clamp(1, 254);
        return Ok(Ipv4Addr::new(127, bytes[0], bytes[1], bytes[2]).into());
    }
    Ok(Ipv4Addr::LOCALHOST.into())
}

impl Gate {
    /// Makes a gate to a server.
    pub(crate) fn new(server: SocketAddr) -> Self {
        Self {
            clients: Arc::new(Semaphore::new(CLIENTS_MAX)),
            greetings: Arc::new(Semaphore::new(GREETINGS_MAX)),
            server,
        }
    }

    /// Takes connections until the runtime ends.
    pub(crate) async fn serve(self, listener: TcpListener) {
        loop {
            let Ok((mut stream, _)) = listener.accept().await else {
                tokio::time::sleep(PAUSE).await;
                continue;
            };
            let Ok(place) = Arc::clone(&self.greetings).try_acquire_owned() else { continue };
            let gate = self.clone();
            tokio::spawn(async move {
                // A connection that ends early is no failure of the server.
                let Ok(Ok(head)) = timeout(GREETING, request(&mut stream)).await else { return };
                let own = stream.local_addr().map(|address| address.ip());
                let let_in =
                    own.map_err(|_| refused("500 Internal Server Error", "")).and_then(|own| {
                        may_enter(&head, own)?;
                        Arc::clone(&gate.clients)
                            .try_acquire_owned()
                            .map_err(|_| refused("503 Service Unavailable", "too many clients"))
                    });
                drop(place);
                match let_in {
                    Ok(_client) => {
                        let _ = pass(stream, gate.server, &head).await;
                    }
                    Err((status, words)) => {
                        let reply = format!(
                            "HTTP/1.1 {status}\r\nContent-Type: text/plain; charset=utf-8\r\n\
                             Content-Length: {}\r\nConnection: close\r\n\r\n{words}",
                            words.len()
                        );
                        let _ = timeout(GREETING, stream.write_all(reply.as_bytes())).await;
                    }
                }
            });
        }
    }

    /// Waits until all clients are gone.
    pub(crate) async fn empty(&self) {
        // It is never closed.
        let _ = self.clients.acquire_many(CLIENTS_MAX as u32).await;
    }
}

fn refused(status: &'static str, words: &str) -> Refusal {
    (status, format!("{words}\n"))
}

/// Reads a request, with all that came with it.
async fn request(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    while !head.windows(4).any(|end| end == b"\r\n\r\n") {
        if head.len() > REQUEST_BYTES_MAX {
            return Err(io::ErrorKind::InvalidData.into());
        }
        if stream.read_buf(&mut head).await? == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
    }
    Ok(head)
}

/// Checks the origin of a request; the server behind checks the rest.
fn may_enter(head: &[u8], own: IpAddr) -> Result<(), Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS_MAX];
    let mut parsed = httparse::Request::new(&mut headers);
    if !parsed.parse(head).is_ok_and(|status| status.is_complete()) {
        return Err(refused("400 Bad Request", "the request can't be read"));
    }
    let origins = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case("origin"));
    for header in origins {
        let origin = String::from_utf8_lossy(header.value);
        if !may_read(origin.trim(), own) {
            let words = format!(
                "found a page of {}, expected one of {FOXGLOVE}, of this host, or no page of the web",
                octant_base::printable::printable(&origin)
            );
            return Err(refused("403 Forbidden", &words));
        }
    }
    Ok(())
}

/// Returns whether the pages of an origin may read the run: those of Foxglove, and those of the host that serves it, by
/// a name that no other host can get. Programs have no origin, and those with pages of their own have other schemes
/// than the web.
#[must_use]
pub fn may_read(origin: &str, own: IpAddr) -> bool {
    let Some((scheme, authority)) = origin.split_once("://") else { return false };
    if !["http", "https"].contains(&scheme.to_ascii_lowercase().as_str()) {
        return true;
    }
    let host = match authority.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => authority.split(':').next().unwrap_or_default(),
    };
    let host = host.to_ascii_lowercase();
    match host.parse::<IpAddr>() {
        Ok(address) => {
            address.to_canonical().is_loopback() || address.to_canonical() == own.to_canonical()
        }
        Err(_) => host == "localhost" || (host == FOXGLOVE && scheme.eq_ignore_ascii_case("https")),
    }
}

/// Passes bytes both ways until one end closes, or the client takes nothing.
async fn pass(client: TcpStream, server: SocketAddr, head: &[u8]) -> io::Result<()> {
    let mut server = TcpStream::connect(server).await?;
    client.set_nodelay(true)?;
    server.set_nodelay(true)?;
    server.write_all(head).await?;
    let (mut from_client, mut to_client) = client.into_split();
    let (mut from_server, mut to_server) = server.into_split();
    let up = async move { tokio::io::copy(&mut from_client, &mut to_server).await.map(|_| ()) };
    let down = async move {
        let mut buffer = vec![0; 64 << 10];
        loop {
            let count = from_server.read(&mut buffer).await?;
            if count == 0 {
                return to_client.shutdown().await;
            }
            let mut rest = &buffer[..count];
            while !rest.is_empty() {
                let taken = timeout(STALL, to_client.write(rest)).await??;
                rest = &rest[taken..];
            }
        }
    };
    tokio::select! {
        ended = up => ended,
        ended = down => ended,
    }
}
