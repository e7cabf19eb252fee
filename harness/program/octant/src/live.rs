//! Runs served to Foxglove: `octant watch --foxglove`, `octant run --live`.

/// Default address, reachable from this host only.
pub(super) const DEFAULT_ADDRESS: &str = "127.0.0.1:8765";

#[cfg(feature = "foxglove")]
pub(super) use with_server::{Live, serve};
#[cfg(not(feature = "foxglove"))]
pub(super) use without_server::{Live, serve};

#[cfg(feature = "foxglove")]
mod with_server {
    use crate::failure::Failure;
    use crate::followed::{unreadable, verdict};
    use crate::progress::watch_interrupts;
    use crate::terminal::note;
    use octant_base::interrupt;
    use octant_verdict::Verdict;
    use octant_watch::follow::Follow;
    use octant_watch::foxglove::{FoxgloveServeError, FoxgloveServer};
    use octant_watch::place::RunPlace;
    use octant_watch::plain;
    use std::path::Path;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::JoinHandle;
    use std::time::Duration;

    /// Interval of the polls: the recording grows four times a second.
    const LOOK: Duration = Duration::from_millis(100);

    fn start(address: &str) -> Result<FoxgloveServer, Failure> {
        let server = FoxgloveServer::start(address)
            .map_err(|error: FoxgloveServeError| Failure::of(&error).failed())?;
        let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
        note!("octant: serving to Foxglove at ws://{host}:{}", server.port());
        Ok(server)
    }

    /// Serves a run until it is interrupted, even after the run has ended.
    pub(crate) fn serve(mut follow: Follow, address: &str) -> Result<Verdict, Failure> {
        let mut server = start(address)?;
        watch_interrupts();
        let mut told = false;
        while !interrupt::seen() {
            if server.look(&mut follow).map_err(unreadable)? {
                continue;
            }
            if follow.stage.is_over() && !told {
                told = true;
                let end = plain::end(&follow);
                let stage = plain::stage(&follow);
                crate::terminal::print(&if end.is_empty() { format!("{stage}\n") } else { end })?;
                note!("octant: the run is over and still served; Ctrl-C stops the server");
            }
            std::thread::sleep(LOOK);
        }
        server.stop();
        verdict(&follow)
    }

    /// Server beside a run.
    pub(crate) struct Live {
        server: Option<FoxgloveServer>,
        done: Arc<AtomicBool>,
        thread: Option<JoinHandle<()>>,
    }

    impl Live {
        /// Starts serving, before the run begins.
        pub(crate) fn start(address: &str) -> Result<Self, Failure> {
            let server = Some(start(address)?);
            Ok(Self { server, done: Arc::default(), thread: None })
        }

        /// Serves the run that is written in this folder, on a thread of its own, from outside.
        pub(crate) fn follow(&mut self, folder: &Path) -> Result<(), Failure> {
            let place =
                RunPlace::of(folder).map_err(|e| Failure::bench(format!("failed to {e}")))?;
            let Some(mut server) = self.server.take() else { return Ok(()) };
            let (mut follow, done) = (Follow::new(place), Arc::clone(&self.done));
            let work = move || {
                loop {
                    let is_last = done.load(Ordering::Relaxed);
                    match server.look(&mut follow) {
                        Ok(true) => continue,
                        Ok(false) => {}
                        Err(error) => {
                            note!("octant: stopped serving: failed to {error}");
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
                Failure::bench(format!("failed to start the thread of the server: {error}"))
            })?);
            Ok(())
        }
    }

    impl Drop for Live {
        /// Publishes the remaining messages, and ends.
        fn drop(&mut self) {
            self.done.store(true, Ordering::Relaxed);
            if let Some(thread) = self.thread.take() {
                // Only serving has failed, not the run.
                let _ = thread.join();
            }
        }
    }
}

#[cfg(not(feature = "foxglove"))]
mod without_server {
    use crate::failure::Failure;
    use octant_verdict::Verdict;
    use octant_watch::follow::Follow;
    use std::path::Path;

    pub(crate) fn serve(_: Follow, _: &str) -> Result<Verdict, Failure> {
        Err(not_built("--foxglove"))
    }

    /// Uninhabited: this program is built without the server.
    pub(crate) enum Live {}

    impl Live {
        pub(crate) fn start(_: &str) -> Result<Self, Failure> {
            Err(not_built("--live"))
        }

        pub(crate) fn follow(&mut self, _: &Path) -> Result<(), Failure> {
            match *self {}
        }
    }

    fn not_built(option: &str) -> Failure {
        Failure::input(format!(
            "{option}: this program was built without the server for Foxglove, expected one built \
             with cargo build --release --features octant/foxglove"
        ))
    }
}
