//! Runs served to Foxglove: `octant watch --foxglove`, `octant run --live`.

use super::Failure;
use crate::watch::follow::Follow;
use octant_requirements::Verdict;

/// Where a run is served by default: to this host alone.
pub(super) const DEFAULT_ADDRESS: &str = "127.0.0.1:8765";

#[cfg(feature = "foxglove")]
pub(super) use with_server::{Live, serve};
#[cfg(not(feature = "foxglove"))]
pub(super) use without_server::{Live, serve};

#[cfg(feature = "foxglove")]
mod with_server {
    use super::{Failure, Follow, Verdict};
    use crate::cli::progress::interrupts;
    use crate::watch::foxglove::{ServeError, Server};
    use crate::watch::place::Place;
    use crate::watch::plain;
    use std::path::Path;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::JoinHandle;
    use std::time::Duration;

    /// From one look at the recording to the next: it grows four times a second.
    const LOOK: Duration = Duration::from_millis(100);

    fn start(address: &str) -> Result<Server, Failure> {
        let server = Server::start(address).map_err(|error: ServeError| {
            let message = format!("failed to {error}");
            if error.is_bench() { Failure::bench(message) } else { Failure::input(message) }
        })?;
        let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
        note!("octant: served to Foxglove at ws://{host}:{}", server.port());
        Ok(server)
    }

    /// Serves a run until somebody interrupts, also after it has ended.
    pub(in crate::cli) fn serve(mut follow: Follow, address: &str) -> Result<Verdict, Failure> {
        let mut server = start(address)?;
        interrupts::watch();
        let mut told = false;
        while !interrupts::seen() {
            if server.look(&mut follow).map_err(crate::cli::watch::unreadable)? {
                continue;
            }
            if follow.stage.is_over() && !told {
                told = true;
                let end = plain::end(&follow);
                let stage = plain::stage(&follow);
                crate::cli::print(&if end.is_empty() { format!("{stage}\n") } else { end })?;
                note!("octant: still served; Ctrl-C ends it");
            }
            std::thread::sleep(LOOK);
        }
        server.stop();
        crate::cli::watch::verdict(&follow)
    }

    /// A server beside a run.
    pub(in crate::cli) struct Live {
        server: Option<Server>,
        done: Arc<AtomicBool>,
        thread: Option<JoinHandle<()>>,
    }

    impl Live {
        /// Begins to serve, before the run begins.
        pub(in crate::cli) fn start(address: &str) -> Result<Self, Failure> {
            let server = Some(start(address)?);
            Ok(Self { server, done: Arc::default(), thread: None })
        }

        /// Serves the run that is written in this folder, on a thread of its own, from outside.
        pub(in crate::cli) fn follow(&mut self, folder: &Path) -> Result<(), Failure> {
            let place = Place::of(folder).map_err(|e| Failure::bench(format!("failed to {e}")))?;
            let Some(mut server) = self.server.take() else { return Ok(()) };
            let (mut follow, done) = (Follow::new(place), Arc::clone(&self.done));
            let work = move || {
                loop {
                    let is_last = done.load(Ordering::Relaxed);
                    match server.look(&mut follow) {
                        Ok(true) => continue,
                        Ok(false) => {}
                        Err(error) => {
                            note!("octant: served no more: failed to {error}");
                            break;
                        }
                    }
                    if is_last {
                        break;
                    }
                    std::thread::sleep(LOOK);
                }
                server.stop();
            };
            let thread = std::thread::Builder::new().name("live".to_owned()).spawn(work);
            self.thread = Some(thread.map_err(|error| {
                Failure::bench(format!("failed to serve the run: no thread: {error}"))
            })?);
            Ok(())
        }
    }

    impl Drop for Live {
        /// Publishes what is still there, and ends.
        fn drop(&mut self) {
            self.done.store(true, Ordering::Relaxed);
            if let Some(thread) = self.thread.take() {
                // Serving has failed; the run hasn't.
                let _ = thread.join();
            }
        }
    }
}

#[cfg(not(feature = "foxglove"))]
mod without_server {
    use super::{Failure, Follow, Verdict};
    use std::path::Path;

    pub(in crate::cli) fn serve(_: Follow, _: &str) -> Result<Verdict, Failure> {
        Err(not_built("--foxglove"))
    }

    /// Nothing: this program can't serve.
    pub(in crate::cli) enum Live {}

    impl Live {
        pub(in crate::cli) fn start(_: &str) -> Result<Self, Failure> {
            Err(not_built("--live"))
        }

        pub(in crate::cli) fn follow(&mut self, _: &Path) -> Result<(), Failure> {
            match *self {}
        }
    }

    fn not_built(option: &str) -> Failure {
        Failure::input(format!(
            "{option}: this octant was built without the server for Foxglove, expected one built \
             with cargo build --release --features octant/foxglove"
        ))
    }
}
