//! Reads a core at the other end of a wire from `endpoint.uri` and `[endpoint.link]`.

use crate::error::Problem;
use crate::keys::EndpointKeys;
use crate::model::Live;
use octant_link::Uri;

/// Reads a port and `[endpoint.link]`.
pub(super) fn live(keys: &EndpointKeys) -> Result<Live, Problem> {
    let uri: Uri = (keys.uri.parse())
        .map_err(|error: octant_link::uri::UriError| keys.uri.problem(error.to_string()))?;
    if let Uri::Pty { .. } = uri {
        let message = "found pty:, expected serial: with the terminal that octant serve announces";
        return Err(keys.uri.problem(message));
    }
    if let Uri::Stdio = uri {
        let message = "found stdio:, expected exec: with the program whose input and output it is";
        return Err(keys.uri.problem(message));
    }
    if matches!(&uri, Uri::Tcp(tcp) if tcp.listen) {
        let message = format!(
            "found {uri}, expected tcp:HOST:PORT alone: listen is for an instrument that connects to this host"
        );
        return Err(keys.uri.problem(message));
    }
    let link = keys.link.as_ref().ok_or_else(|| keys.uri.problem("endpoint.link is missing"))?;
    let live = Live {
        uri,
        hello_s: link.hello,
        answer_s: link.answer,
        repeat_s: *link.repeat,
        reconnect_s: *link.reconnect,
    };
    if live.repeat_s > live.answer_s {
        let message = "an answer would be given up before it is asked for again; expected no more \
                       than endpoint.link.answer";
        return Err(link.repeat.problem(message));
    }
    Ok(live)
}
