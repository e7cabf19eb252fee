//! A core at the other end of a wire, as read from `endpoint.uri` and `[endpoint.link]`.

use super::Reader;
use crate::error::Problem;
use octant_link::Uri;

/// A device on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Live {
    /// The port.
    pub uri: Uri,
    /// How long the first hello is waited for, s.
    pub hello_s: f64,
    /// How long an answer is waited for, s.
    pub answer_s: f64,
    /// After how long it is asked for again, s.
    pub repeat_s: f64,
    /// How long a port that went away is waited for, s; 0: the run ends at once.
    pub reconnect_s: f64,
}

/// Reads it.
pub(super) fn live(endpoint: &Reader<'_>, uri: &str) -> Result<Live, Problem> {
    let uri: Uri = uri
        .parse()
        .map_err(|error: octant_link::uri::UriError| endpoint.problem("uri", error.to_string()))?;
    if let Uri::Pty { .. } = uri {
        let message = "found pty:, expected serial: with the terminal that octant serve announces";
        return Err(endpoint.problem("uri", message));
    }
    let link = endpoint.table("link")?;
    let live = Live {
        uri,
        hello_s: link.si("hello")?,
        answer_s: link.si("answer")?,
        repeat_s: link.si("repeat")?,
        reconnect_s: link.si("reconnect")?,
    };
    if live.repeat_s > live.answer_s {
        let message = "an answer would be given up before it is asked for again; expected no more \
                       than endpoint.link.answer";
        return Err(link.problem("repeat", message));
    }
    Ok(live)
}
