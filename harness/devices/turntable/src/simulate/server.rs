//! A simulated controller on a port.

use super::{Controller, ControllerBehaviour};
use crate::TablePort;
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which the simulated time is advanced.
const WAIT: Duration = Duration::from_millis(5);
/// Longest line; a longer one is discarded.
const MAX_LINE_BYTES: usize = 4096;

struct Shared {
    controller: Mutex<Controller>,
    started: Instant,
    /// Speed of the simulated time relative to real time.
    speed: f64,
    ends: AtomicBool,
}

impl Shared {
    fn now_ns(&self) -> u64 {
        (self.started.elapsed().as_nanos() as f64 * self.speed) as u64
    }

    fn controller(&self) -> MutexGuard<'_, Controller> {
        self.controller.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A simulated controller that listens, until it is dropped.
pub struct SimulatedServer {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    address: Option<SocketAddr>,
}

impl SimulatedServer {
    /// Listens on a TCP address, for one peer after the other; port 0 is any free one. `speed`: speed
    /// of the simulated time relative to real time.
    ///
    /// # Errors
    /// If the address can't be listened on.
    pub fn tcp(
        controller: Controller,
        address: impl ToSocketAddrs,
        speed: f64,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let serve = move |shared: &Shared| {
            while !shared.ends.load(Ordering::SeqCst) {
                match listener.accept() {
                    Ok((mut stream, _)) => {
                        let _ = stream.set_nonblocking(false);
                        let _ = stream.set_nodelay(true);
                        serve(shared, &mut stream);
                    }
                    Err(_) => {
                        shared.controller().tick(shared.now_ns());
                        std::thread::sleep(WAIT);
                    }
                }
            }
        };
        Self::start(controller, speed, Some(address), serve)
    }

    /// Serves the other end of a line: a pseudo-terminal, a serial port.
    ///
    /// # Errors
    /// If the thread can't be started.
    pub fn line(
        controller: Controller,
        port: impl TablePort + 'static,
        speed: f64,
    ) -> io::Result<Self> {
        let mut port = port;
        Self::start(controller, speed, None, move |shared: &Shared| {
            // A pseudo-terminal that nobody has open is gone until it is opened again. The table moves
            // on meanwhile.
            while !shared.ends.load(Ordering::SeqCst) {
                serve(shared, &mut port);
                shared.controller().tick(shared.now_ns());
                std::thread::sleep(WAIT);
            }
        })
    }

    fn start(
        controller: Controller,
        speed: f64,
        address: Option<SocketAddr>,
        serve: impl FnOnce(&Shared) + Send + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            controller: Mutex::new(controller),
            started: Instant::now(),
            speed,
            ends: AtomicBool::new(false),
        });
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("simulated table".into())
            .spawn(move || serve(&of_thread))?;
        Ok(Self { shared, thread: Some(thread), address })
    }

    /// Address that it listens at, on TCP.
    #[must_use]
    pub fn address(&self) -> Option<SocketAddr> {
        self.address
    }

    /// Gives access to the controller and its present time, to look at the truth or to make it
    /// misbehave.
    pub fn with<T>(&self, look: impl FnOnce(&mut Controller, u64) -> T) -> T {
        let now_ns = self.shared.now_ns();
        let mut controller = self.shared.controller();
        controller.tick(now_ns);
        look(&mut controller, now_ns)
    }

    /// Waits until the server ends, which it does only when it is killed.
    pub fn wait(mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for SimulatedServer {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Serves one peer, until it leaves.
fn serve(shared: &Shared, port: &mut impl TablePort) {
    let end = shared.controller().end().to_owned();
    if port.set_wait(WAIT).is_err() {
        return;
    }
    let mut pending: Vec<u8> = Vec::new();
    let mut bytes = [0; 512];
    while !shared.ends.load(Ordering::SeqCst) {
        let heard = match port.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => count,
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => 0,
                _ => return,
            },
        };
        pending.extend(&bytes[..heard]);
        let mut replies = String::new();
        {
            let mut controller = shared.controller();
            let now_ns = shared.now_ns();
            controller.tick(now_ns);
            if *controller.behaviour() == ControllerBehaviour::HangUp {
                return;
            }
            let ends = |bytes: &[u8]| bytes.windows(end.len()).position(|w| w == end.as_bytes());
            while let Some(at) = ends(&pending) {
                let line = String::from_utf8_lossy(&pending[..at]).into_owned();
                pending.drain(..at + end.len());
                if let Some(reply) = controller.line(&line, now_ns) {
                    replies.push_str(&reply);
                    replies.push_str(&end);
                }
            }
        }
        if pending.len() > MAX_LINE_BYTES {
            pending.clear();
        }
        if port.write_all(replies.as_bytes()).and_then(|()| port.flush()).is_err() {
            return;
        }
    }
}
