//! A run served by Foxglove's WebSocket protocol.
//!
//! Messages carry run time. Who subscribes late gets what was before in a thinned form, so that a
//! plot begins at the start of the run. A slow client loses messages, never holds anything up.

use super::follow::Follow;
use super::published::{Channel, faults, messages};
use super::tail::TailError;
use foxglove::websocket::{Capability, ChannelView, Client, ServerListener};
use foxglove::{
    ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema, SinkId,
    WebSocketServer, WebSocketServerHandle,
};
use serde_json::Value;
use std::net::{SocketAddr, ToSocketAddrs};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Messages of a channel that are kept for those who come later.
const HISTORY: usize = 1000;
/// Messages on their way to a client: room for the history of all channels.
const BACKLOG: usize = 2 * HISTORY * Channel::ALL.len();

/// Time for the last messages to leave before the connections end.
const SETTLE: Duration = Duration::from_millis(300);

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address is none.
    #[error("serve at {address:?}: expected HOST:PORT, such as 127.0.0.1:8765")]
    Address {
        /// What was given.
        address: String,
    },
    /// The system or the protocol refused.
    #[error("serve at {address}: {reason}")]
    Start {
        /// Where.
        address: String,
        /// Why not.
        reason: String,
    },
}

impl ServeError {
    /// The port is taken or not allowed, which is not the fault of who wrote the address.
    #[must_use]
    pub const fn is_bench(&self) -> bool {
        matches!(self, Self::Start { .. })
    }
}

/// Messages that were published, thinned as they grow.
#[derive(Debug, Default)]
struct History {
    messages: Vec<(u64, Vec<u8>)>,
    left_out: u64,
    seen: u64,
    /// The last message, kept whatever was left out.
    last: Option<(u64, Vec<u8>)>,
}

impl History {
    fn push(&mut self, time_ns: u64, message: &[u8]) {
        self.last = None;
        if self.seen.is_multiple_of(self.left_out + 1) {
            self.messages.push((time_ns, message.to_vec()));
        } else {
            self.last = Some((time_ns, message.to_vec()));
        }
        self.seen += 1;
        if self.messages.len() > HISTORY {
            let mut odd = false;
            self.messages.retain(|_| {
                odd = !odd;
                odd
            });
            self.left_out = 2 * self.left_out + 1;
        }
    }
}

/// A server with the channels of a run.
pub struct Server {
    handle: WebSocketServerHandle,
    channels: Vec<Arc<RawChannel>>,
    history: Vec<History>,
    subscribed: Receiver<(Option<SinkId>, String)>,
    /// The faults that are armed have been told.
    told: bool,
    /// Kept alive with its channels.
    _context: Arc<Context>,
}

/// Tells who subscribed to what.
struct Listener(Mutex<Sender<(Option<SinkId>, String)>>);

impl ServerListener for Listener {
    fn on_subscribe(&self, client: Client, channel: ChannelView) {
        if let Ok(sender) = self.0.lock() {
            // Nobody listens any more where the server is going down.
            let _ = sender.send((client.sink_id(), channel.topic().to_owned()));
        }
    }
}

impl Server {
    /// Begins to serve. Port 0 is any that is free.
    ///
    /// # Errors
    /// If the address is none, or the system doesn't give it.
    pub fn start(address: &str) -> Result<Self, ServeError> {
        let socket: SocketAddr = (address.to_socket_addrs().ok())
            .and_then(|mut addresses| addresses.next())
            .ok_or_else(|| ServeError::Address { address: address.to_owned() })?;
        let failed = |error: FoxgloveError| ServeError::Start {
            address: address.to_owned(),
            reason: error.to_string(),
        };
        let context = Context::new();
        let (sender, subscribed) = channel();
        let channels = (Channel::ALL.iter())
            .map(|channel| {
                let schema = channel.schema().to_string().into_bytes();
                ChannelBuilder::new(channel.topic())
                    .context(&context)
                    .message_encoding("json")
                    .schema(Schema::new(channel.schema_name(), "jsonschema", schema))
                    .build_raw()
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(failed)?;
        let handle = WebSocketServer::new()
            .context(&context)
            .name("octant")
            .bind(socket.ip().to_string(), socket.port())
            .capabilities([Capability::Time])
            .message_backlog_size(BACKLOG)
            .listener(Arc::new(Listener(Mutex::new(sender))))
            .start_blocking()
            .map_err(failed)?;
        let history = Channel::ALL.iter().map(|_| History::default()).collect();
        Ok(Self { handle, channels, history, subscribed, told: false, _context: context })
    }

    /// The port that is served.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.handle.port()
    }

    /// Takes what is there of a run and publishes it. True where more is there already.
    ///
    /// # Errors
    /// As [`Follow::look`].
    pub fn look(&mut self, follow: &mut Follow) -> Result<bool, TailError> {
        self.answer();
        let before_ns = follow.state.time_ns;
        let more = follow.look(|state, time_ns, item| {
            if !self.told {
                self.told = true;
                self.publish(Channel::Faults, time_ns, &faults(state));
            }
            messages(state, item, |channel, message| self.publish(channel, time_ns, &message));
        })?;
        if follow.state.time_ns != before_ns {
            self.handle.broadcast_time(follow.state.time_ns);
        }
        Ok(more)
    }

    fn publish(&mut self, channel: Channel, time_ns: u64, message: &Value) {
        let bytes = message.to_string().into_bytes();
        let metadata = PartialMetadata { log_time: Some(time_ns) };
        self.channels[channel as usize].log_with_meta(&bytes, metadata);
        self.history[channel as usize].push(time_ns, &bytes);
    }

    /// Gives those who have subscribed what was before.
    fn answer(&mut self) {
        while let Ok((sink, topic)) = self.subscribed.try_recv() {
            let Some(channel) = Channel::ALL.iter().find(|c| c.topic() == topic) else { continue };
            let (raw, history) =
                (&self.channels[*channel as usize], &self.history[*channel as usize]);
            for (time_ns, message) in history.messages.iter().chain(&history.last) {
                let metadata = PartialMetadata { log_time: Some(*time_ns) };
                raw.log_with_meta_to_sink(message, metadata, sink);
            }
        }
    }

    /// Ends the connections in order.
    pub fn stop(self) {
        // What is on its way to a client is dropped with the connection, and nothing tells when it
        // has left.
        if self.handle.client_count() > 0 {
            std::thread::sleep(SETTLE);
        }
        self.handle.stop().wait_blocking();
    }
}
