//! Serves a run over Foxglove's WebSocket protocol.
//!
//! Messages carry run time. A late subscriber gets the earlier messages in a thinned form, so that
//! a plot begins at the start of the run. A slow client loses messages, and never delays anything.

use super::follow::Follow;
use super::gate::{self, Gate};
use super::published::{PublishedChannel, faults, messages};
use super::state::RunState;
use super::tail::TailError;
use foxglove::websocket::{Capability, ChannelView, Client, ServerListener};
use foxglove::{
    ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema, SinkId,
    WebSocketServer, WebSocketServerHandle,
};
use octant_base::failing::{Failing, FailureKind};
use octant_recorder::further::{FurtherChannel, FurtherMessages};
use octant_recorder::reader::Item;
use octant_views::boundary::EpochBoundary;
use octant_views::standard::{StandardEpochs, StandardTopic};
use std::net::{SocketAddr, TcpListener, ToSocketAddrs};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

/// Number of messages per channel that are kept for late subscribers.
const HISTORY: usize = 1000;
/// Number of messages queued for a client: room for the history of all channels.
const BACKLOG: usize = 2 * HISTORY * (STANDARD + PublishedChannel::ALL.len());
/// Number of topics with standard messages, whose channels come first.
const STANDARD: usize = StandardTopic::BRIEF.len();

/// Time for the last messages to be sent before the connections end.
const SETTLE: Duration = Duration::from_millis(300);
/// Time in which the connections have to end; afterwards they are cut off.
const END_MAX: Duration = Duration::from_secs(1);
/// Threads of the server.
const THREADS: usize = 2;

/// Reasons why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum FoxgloveServeError {
    /// The address isn't valid.
    #[error("serve at {address:?}: expected HOST:PORT, such as 127.0.0.1:8765")]
    Address {
        /// Address as it was given.
        address: String,
    },
    /// The operating system or the protocol refused.
    #[error("serve at {address}: {reason}")]
    Start {
        /// Address.
        address: String,
        /// Reason.
        reason: String,
    },
}

impl Failing for FoxgloveServeError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Address { .. } => FailureKind::Input,
            Self::Start { .. } => FailureKind::Bench,
        }
    }
}

/// Published messages, thinned as they grow.
#[derive(Debug, Default)]
struct History {
    messages: Vec<(u64, Vec<u8>)>,
    left_out: u64,
    seen: u64,
    /// Last message, kept regardless of the thinning.
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

/// Server with the channels of a run.
pub struct FoxgloveServer {
    handle: WebSocketServerHandle,
    gate: Gate,
    /// Address that clients reach.
    address: SocketAddr,
    /// Its end ends every connection.
    runtime: Runtime,
    channels: Vec<Arc<RawChannel>>,
    history: Vec<History>,
    subscribed: Receiver<(Option<SinkId>, String)>,
    /// Epochs of the run, once its first message was read.
    epochs: Option<StandardEpochs>,
    boundary: EpochBoundary,
    standard: FurtherMessages,
    /// Kept alive with its channels.
    _context: Arc<Context>,
}

/// Reports subscriptions.
struct Listener(Mutex<Sender<(Option<SinkId>, String)>>);

impl ServerListener for Listener {
    fn on_subscribe(&self, client: Client, channel: ChannelView) {
        if let Ok(sender) = self.0.lock() {
            // The receiver is gone while the server shuts down.
            let _ = sender.send((client.sink_id(), channel.topic().to_owned()));
        }
    }
}

impl FoxgloveServer {
    /// Starts serving. Port 0 selects any free port.
    ///
    /// # Errors
    /// If the address isn't valid, or the operating system refuses it.
    pub fn start(address: &str) -> Result<Self, FoxgloveServeError> {
        let socket: SocketAddr = (address.to_socket_addrs().ok())
            .and_then(|mut addresses| addresses.next())
            .ok_or_else(|| FoxgloveServeError::Address { address: address.to_owned() })?;
        let reason =
            |reason: String| FoxgloveServeError::Start { address: address.to_owned(), reason };
        let failed = |error: FoxgloveError| reason(error.to_string());
        let refused = |error: std::io::Error| reason(error.to_string());
        let listener = TcpListener::bind(socket).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let open = listener.local_addr().map_err(refused)?;
        let runtime = Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("foxglove")
            .enable_all()
            .build()
            .map_err(refused)?;
        let context = Context::new();
        let (sender, subscribed) = channel();
        let standard = StandardTopic::BRIEF.map(StandardTopic::channel);
        let channels = (standard.into_iter())
            .chain(PublishedChannel::ALL.map(PublishedChannel::channel))
            .map(|channel| {
                let FurtherChannel { schema_name, schema_encoding, schema, .. } = channel;
                ChannelBuilder::new(channel.topic)
                    .context(&context)
                    .message_encoding(channel.message_encoding)
                    .schema(Schema::new(schema_name, schema_encoding, schema.into_bytes()))
                    .build_raw()
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(failed)?;
        let hidden = gate::hidden_address().map_err(refused)?;
        let handle = WebSocketServer::new()
            .context(&context)
            .name("octant")
            .bind(hidden.to_string(), 0)
            .tokio_runtime(runtime.handle())
            .capabilities([Capability::Time])
            .message_backlog_size(BACKLOG)
            .listener(Arc::new(Listener(Mutex::new(sender))))
            .start_blocking()
            .map_err(failed)?;
        let gate = Gate::new((hidden, handle.port()).into());
        let serve = gate.clone();
        let listener = {
            let _inside = runtime.enter();
            tokio::net::TcpListener::from_std(listener).map_err(refused)?
        };
        runtime.spawn(serve.serve(listener));
        Ok(Self {
            handle,
            gate,
            address: open,
            runtime,
            history: channels.iter().map(|_| History::default()).collect(),
            channels,
            subscribed,
            epochs: None,
            boundary: EpochBoundary::default(),
            standard: FurtherMessages::default(),
            _context: context,
        })
    }

    /// Returns the port that is served.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.address.port()
    }

    /// Reads the available messages of a run and publishes them. Returns true if more are there
    /// already.
    ///
    /// # Errors
    /// As [`Follow::look`].
    pub fn look(&mut self, follow: &mut Follow) -> Result<bool, TailError> {
        self.answer();
        let before_ns = follow.state.time_ns;
        let more = follow.look(|state, time_ns, item| self.take(state, time_ns, item))?;
        if !more {
            // A run hands over whole epochs.
            self.end_epoch(self.boundary.time_ns());
        }
        if follow.state.time_ns != before_ns {
            self.handle.broadcast_time(follow.state.time_ns);
        }
        Ok(more)
    }

    /// Publishes what follows from a message of the run.
    fn take(&mut self, state: &RunState, time_ns: u64, item: &Item) {
        if self.epochs.is_none() {
            let period_ns = state.about.sample_period_ns;
            self.epochs = Some(StandardEpochs::new(&StandardTopic::BRIEF, 0, period_ns));
            let message = faults(state).to_string();
            self.publish(STANDARD + PublishedChannel::Faults as usize, time_ns, message.as_bytes());
        }
        if let Some(before_ns) = self.boundary.take(time_ns, item.topic()) {
            self.end_epoch(before_ns);
        }
        if let Some(epochs) = &mut self.epochs {
            epochs.take(time_ns, item);
        }
        messages(state, item, |channel, message| {
            self.publish(STANDARD + channel as usize, time_ns, message.to_string().as_bytes());
        });
    }

    /// Publishes the standard messages of an epoch.
    fn end_epoch(&mut self, time_ns: u64) {
        let Some(epochs) = &mut self.epochs else { return };
        let mut standard = std::mem::take(&mut self.standard);
        epochs.end(true, &mut standard);
        for (channel, message) in standard.iter() {
            self.publish(channel, time_ns, message);
        }
        standard.clear();
        self.standard = standard;
    }

    fn publish(&mut self, channel: usize, time_ns: u64, message: &[u8]) {
        let metadata = PartialMetadata { log_time: Some(time_ns) };
        self.channels[channel].log_with_meta(message, metadata);
        self.history[channel].push(time_ns, message);
    }

    /// Sends the earlier messages to new subscribers.
    fn answer(&mut self) {
        while let Ok((sink, topic)) = self.subscribed.try_recv() {
            let all = self.channels.iter().zip(&self.history);
            let Some((raw, history)) = all.into_iter().find(|(raw, _)| raw.topic() == topic) else {
                continue;
            };
            for (time_ns, message) in history.messages.iter().chain(&history.last) {
                let metadata = PartialMetadata { log_time: Some(*time_ns) };
                raw.log_with_meta_to_sink(message, metadata, sink);
            }
        }
    }

    /// Ends the connections, in order those whose clients take part.
    pub fn stop(self) {
        let Self { handle, gate, runtime, .. } = self;
        // Messages that are still queued are dropped with the connection, and nothing reports when
        // they have been sent.
        if handle.client_count() > 0 {
            std::thread::sleep(SETTLE);
        }
        let end = async {
            handle.stop().wait().await;
            gate.empty().await;
        };
        // Tasks that are still open end with the runtime.
        let _ = runtime.block_on(async { tokio::time::timeout(END_MAX, end).await });
        runtime.shutdown_timeout(END_MAX);
    }
}
