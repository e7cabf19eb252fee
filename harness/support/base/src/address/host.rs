//! Host and port of TCP and UDP.
//!
//! An IPv6 address is in brackets, `[::1]:5025`: without them nobody knows where the address ends and the port begins,
//! `::1:5025` is an IPv6 address itself.

use super::error::AddressError;
use super::parts::AddressParts;
use std::fmt;
use std::io::{self, ErrorKind};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, ToSocketAddrs};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Time in which a name has to be resolved and a connection has to be made.
pub const CONNECT_LIMIT: Duration = Duration::from_secs(5);

/// Host and port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostPort {
    /// Name or address of the host, an IPv6 address without brackets; empty: loopback.
    pub host: String,
    /// Port; 0 is any free port where something listens.
    pub port: u16,
}

/// Parts of an address that may be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostForm {
    /// Either end of a wire: without a host it is loopback, and at the end that listens port 0 is any free port.
    Wire,
    /// An instrument of the bench, to which programs connect: the host is written.
    Instrument {
        /// Port where none is written; `None`: it has to be written.
        default_port: Option<u16>,
    },
}

impl HostForm {
    /// Forms of an address with this scheme, with the default.
    #[must_use]
    pub fn expected(self, scheme: &str) -> String {
        match self {
            Self::Wire => format!(
                "{scheme}:HOST:PORT, such as {scheme}:127.0.0.1:5005 or {scheme}:[::1]:5005"
            ),
            Self::Instrument { default_port: Some(port) } => {
                format!("{scheme}:HOST or {scheme}:HOST:PORT ({port} by default)")
            }
            Self::Instrument { default_port: None } => format!("{scheme}:HOST:PORT"),
        }
    }

    /// Reads host and port from the name of an address with this scheme.
    ///
    /// # Errors
    /// If the name has not this form.
    pub fn read(self, parts: &AddressParts<'_>, scheme: &str) -> Result<HostPort, AddressError> {
        let wrong = |bare: Option<String>| {
            match bare {
            Some(bracketed) => parts.form(format!(
                "{scheme}:{bracketed}: an IPv6 address is in brackets, which separate it from the port"
            )),
            None => parts.form(self.expected(scheme)),
        }
        };
        let name = parts.name;
        let (host, port) = if let Some(rest) = name.strip_prefix('[') {
            let (host, after) = rest.split_once(']').ok_or_else(|| wrong(None))?;
            let address = host.split_once('%').map_or(host, |(address, _)| address);
            let zone = host.strip_prefix(address).unwrap_or_default();
            if address.parse::<Ipv6Addr>().is_err() || zone == "%" || !is_host(zone) {
                return Err(wrong(None));
            }
            match after.strip_prefix(':') {
                Some(port) => (host, Some(port)),
                None if after.is_empty() => (host, None),
                None => return Err(wrong(None)),
            }
        } else if let Some((host, port)) = name.split_once(':') {
            if port.contains(':') {
                return Err(wrong(bracketed(name)));
            }
            (host, Some(port))
        } else if self == Self::Wire {
            ("", Some(name))
        } else {
            (name, None)
        };
        let port = match (port, self) {
            (Some(port), _) => number(port),
            (None, Self::Instrument { default_port }) => default_port,
            (None, Self::Wire) => None,
        };
        let port = port.filter(|port| *port > 0 || self == Self::Wire);
        let written = match self {
            Self::Wire => true,
            // A number alone is a port without its host.
            Self::Instrument { .. } => !host.is_empty() && number(host).is_none(),
        };
        match port {
            Some(port) if written && is_host(host) => Ok(HostPort { host: host.to_owned(), port }),
            _ => Err(wrong(None)),
        }
    }
}

/// Parses a port, which has digits alone.
fn number(text: &str) -> Option<u16> {
    text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?
}

/// False for characters that are in no name of a host and belong to something else, such as a URL or another option.
fn is_host(text: &str) -> bool {
    !text.chars().any(|c| c.is_whitespace() || c.is_control() || "[]/?#@&".contains(c))
}

/// Returns an IPv6 address without brackets as it should be written; `None` if it is none.
fn bracketed(name: &str) -> Option<String> {
    let is_address = |text: &str| text.parse::<Ipv6Addr>().is_ok();
    if let Some((host, port)) = name.rsplit_once(':')
        && is_address(host)
        && number(port).is_some()
    {
        return Some(format!("[{host}]:{port}"));
    }
    is_address(name).then(|| format!("[{name}]:PORT"))
}

impl fmt::Display for HostPort {
    /// Writes the address in the form that is parsed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        if host.contains(':') { write!(f, "[{host}]:{port}") } else { write!(f, "{host}:{port}") }
    }
}

impl HostPort {
    /// Resolves the host to its addresses, of which there is at least one.
    ///
    /// # Errors
    /// If the name has no address, or isn't resolved within the limit.
    pub fn resolve(&self, limit: Duration) -> io::Result<Vec<SocketAddr>> {
        let port = self.port;
        if self.host.is_empty() {
            return Ok(vec![(Ipv4Addr::LOCALHOST, port).into()]);
        }
        if let Ok(ip) = self.host.parse::<IpAddr>() {
            return Ok(vec![(ip, port).into()]);
        }
        // The system's resolver has no limit. A thread that waits for it longer is nobody's loss.
        let (sender, receiver) = sync_channel(1);
        let host = self.host.clone();
        std::thread::Builder::new().name("resolver".to_owned()).spawn(move || {
            let found = (host.as_str(), port).to_socket_addrs();
            let _ = sender.send(found.map(|found| found.collect::<Vec<_>>()));
        })?;
        let found = match receiver.recv_timeout(limit) {
            Ok(found) => found.map_err(|error| {
                io::Error::new(error.kind(), format!("the host {:?}: {error}", self.host))
            })?,
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                let reason = format!("the host {:?} wasn't resolved within {limit:?}", self.host);
                return Err(io::Error::new(ErrorKind::TimedOut, reason));
            }
        };
        if found.is_empty() {
            let reason = format!("the host {:?} has no address", self.host);
            return Err(io::Error::new(ErrorKind::NotFound, reason));
        }
        Ok(found)
    }

    /// Connects within a limit of time to the first address of the host that answers. Small frames are sent at once.
    ///
    /// # Errors
    /// If the host isn't known, or nobody accepts in time: the error of the last address.
    pub fn connect(&self, limit: Duration) -> io::Result<TcpStream> {
        if self.port == 0 {
            let reason = "nobody listens at port 0, expected 1 to 65535";
            return Err(io::Error::new(ErrorKind::InvalidInput, reason));
        }
        let until = Instant::now() + limit;
        let addresses = self.resolve(limit)?;
        let mut left = addresses.len() as u32;
        let mut failed = io::Error::from(ErrorKind::NotFound);
        for address in addresses {
            // Later addresses get a share of the time too.
            let share = until.saturating_duration_since(Instant::now()) / left.max(1);
            left -= 1;
            match TcpStream::connect_timeout(&address, share.max(Duration::from_millis(1))) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    return Ok(stream);
                }
                Err(error) if error.kind() == ErrorKind::TimedOut => {
                    let reason = format!("nobody answered within {limit:?}");
                    failed = io::Error::new(ErrorKind::TimedOut, reason);
                }
                Err(error) => failed = error,
            }
        }
        Err(failed)
    }
}
