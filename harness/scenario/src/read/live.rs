//! Reads a core at the other end of a wire from `endpoint.uri` and `[endpoint.link]`.

use super::reader::Reader;
use crate::error::Problem;
use crate::model::Live;
use octant_link::Uri;

/// Reads a port and `[endpoint.link]`.
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
