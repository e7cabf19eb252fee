//! A stop button that other programs can press.
//!
//! A controller often accepts only one peer at a time, and an open serial port can't be opened again:
//! while a harness drives a table, no other program reaches it. So the harness opens a socket for each
//! table, in a folder of this host, with a thread that only waits for somebody to press. The thread
//! takes no lock of the driver and needs no reply of the table, and each connection has one of its own,
//! so that a silent one holds up no stop. Every user of this host may stop a
//! table this way, and can do nothing else to it. Runs that share the table knock at the same socket.

use crate::{EmergencyStop, Error, TableHost};

/// Result of pressing a button.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pressed {
    /// Port of the table, as named by its harness.
    pub port: String,
    /// True if the harness could write the bytes of the stop.
    pub written: bool,
}

#[cfg(unix)]
#[cfg(target_os = "linux")]
pub(crate) use unix::knock;
#[cfg(unix)]
pub use unix::{Button, press};

#[cfg(not(unix))]
pub use elsewhere::{Button, press};

#[cfg(unix)]
mod unix {
    use super::{EmergencyStop, Error, Pressed, TableHost};
    use std::io::{self, ErrorKind, Read, Write};
    use std::os::unix::fs::{FileTypeExt, PermissionsExt};
    use std::os::unix::net::{UnixListener, UnixStream};
    use std::path::{Path, PathBuf};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::thread::JoinHandle;
    use std::time::Duration;

    /// Folder of the sockets, the same for every user and environment, so that nobody has to search for
    /// it in an emergency.
    const FOLDER: &str = "/tmp/octant-tables";
    /// Word that presses the button. A connection without it only tests whether the table is in use.
    const WORD: &[u8] = b"stop\n";
    /// Word of a run that shares the table; as long as the other.
    const KNOCK: &[u8] = b"join\n";
    /// Longest wait of either end for the other.
    const PATIENCE: Duration = Duration::from_secs(3);
    /// Most connections that may take that long at a time.
    const CONNECTIONS: usize = 32;
    /// Longest wait for a further one. Whoever presses sends the word at once.
    const HASTE: Duration = Duration::from_millis(50);

    /// Path of a port's socket: a hash, because paths of sockets have to be short.
    fn place(port: &str) -> PathBuf {
        // Hash FNV-1a.
        let hash = port.bytes().fold(0xCBF2_9CE4_8422_2325u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        });
        Path::new(FOLDER).join(format!("{hash:016x}"))
    }

    /// Stop button of a table, removed on drop.
    #[derive(Debug)]
    pub struct Button {
        place: PathBuf,
        ends: Arc<AtomicBool>,
        thread: Option<JoinHandle<()>>,
    }

    impl Button {
        /// Offers a stop button for the table on a port, and lets guests of `host` in.
        ///
        /// # Errors
        /// If another program drives the table, or the socket can't be made.
        pub fn offer(port: &str, stop: EmergencyStop, host: TableHost) -> Result<Self, Error> {
            let place = place(port);
            let failed = |reason: String| Error::Button { port: port.to_owned(), reason };
            let listener = listen(&place).map_err(|error| match error.kind() {
                ErrorKind::AddrInUse => failed("another program drives this table".into()),
                _ => failed(format!("{}: {error}", place.display())),
            })?;
            let ends = Arc::new(AtomicBool::new(false));
            let (ended, name) = (Arc::clone(&ends), port.to_owned());
            let thread = std::thread::Builder::new()
                .name("table button".into())
                .spawn(move || {
                    let waiting = Arc::new(AtomicUsize::new(0));
                    for stream in listener.incoming() {
                        if ended.load(Ordering::SeqCst) {
                            return;
                        }
                        let Ok(stream) = stream else { continue };
                        let this = (stop.clone(), host.clone(), name.clone());
                        // A peer that doesn't wait for the answer has still pressed the button.
                        if waiting.load(Ordering::SeqCst) >= CONNECTIONS {
                            let _ = pressed(stream, HASTE, &this);
                            continue;
                        }
                        waiting.fetch_add(1, Ordering::SeqCst);
                        let done = Arc::clone(&waiting);
                        let serve = move || {
                            let _ = pressed(stream, PATIENCE, &this);
                            done.fetch_sub(1, Ordering::SeqCst);
                        };
                        let thread = std::thread::Builder::new().name("table button".into());
                        if thread.spawn(serve).is_err() {
                            waiting.fetch_sub(1, Ordering::SeqCst);
                        }
                    }
                })
                .map_err(|error| failed(error.to_string()))?;
            Ok(Self { place, ends, thread: Some(thread) })
        }
    }

    impl Drop for Button {
        fn drop(&mut self) {
            self.ends.store(true, Ordering::SeqCst);
            // The thread waits for a connection: this one wakes it. If the connection fails, the thread
            // isn't joined.
            if UnixStream::connect(&self.place).is_ok()
                && let Some(thread) = self.thread.take()
            {
                let _ = thread.join();
            }
            let _ = std::fs::remove_file(&self.place);
        }
    }

    fn listen(place: &Path) -> io::Result<UnixListener> {
        if !Path::new(FOLDER).is_dir() {
            std::fs::create_dir_all(FOLDER)?;
            // The next driver of a table may be another user. The permissions of another user's folder
            // are left unchanged.
            let open = std::fs::Permissions::from_mode(0o1777);
            let _ = std::fs::set_permissions(FOLDER, open);
        }
        let listener = match UnixListener::bind(place) {
            // A socket without a listener was left by a harness that was killed.
            Err(error)
                if error.kind() == ErrorKind::AddrInUse && UnixStream::connect(place).is_err() =>
            {
                std::fs::remove_file(place)?;
                UnixListener::bind(place)?
            }
            other => other?,
        };
        std::fs::set_permissions(place, std::fs::Permissions::from_mode(0o666))?;
        Ok(listener)
    }

    fn pressed(
        mut stream: UnixStream,
        wait: Duration,
        (stop, host, port): &(EmergencyStop, TableHost, String),
    ) -> io::Result<()> {
        stream.set_read_timeout(Some(wait))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut word = [0; WORD.len()];
        stream.read_exact(&mut word)?;
        if word == KNOCK {
            host.join(stream);
            return Ok(());
        }
        if word != WORD {
            return Ok(());
        }
        let written = stop.trip("stop command on the command line");
        writeln!(stream, "{} {port}", u8::from(written))
    }

    /// Presses the button of a table that a program on this host drives; without a port, those of all
    /// tables. Returns the buttons pressed: none if no program drives the table.
    ///
    /// # Errors
    /// If a button exists and doesn't answer.
    pub fn press(port: Option<&str>) -> Result<Vec<Pressed>, Error> {
        let places = match port {
            Some(port) => vec![place(port)],
            None => {
                let entries = std::fs::read_dir(FOLDER).into_iter().flatten().flatten();
                let sockets =
                    entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_socket()));
                sockets.map(|entry| entry.path()).collect()
            }
        };
        let mut all = Vec::new();
        let mut silent = None;
        for place in places {
            // A socket without a listener is ignored.
            let Ok(stream) = UnixStream::connect(&place) else { continue };
            match answer(stream) {
                Ok(pressed) => all.push(pressed),
                // The other buttons are still pressed.
                Err(error) => {
                    let port = port.unwrap_or("a table of this host").to_owned();
                    let reason = format!("the program that drives it doesn't answer: {error}");
                    silent = Some(Error::Button { port, reason });
                }
            }
        }
        silent.map_or(Ok(all), Err)
    }

    /// Knocks at a table; `None` if no program drives it.
    #[cfg(target_os = "linux")]
    pub(crate) fn knock(port: &str) -> Option<UnixStream> {
        let mut stream = UnixStream::connect(place(port)).ok()?;
        stream.write_all(KNOCK).ok()?;
        Some(stream)
    }

    fn answer(mut stream: UnixStream) -> io::Result<Pressed> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        stream.write_all(WORD)?;
        let mut answer = String::new();
        stream.take(4096).read_to_string(&mut answer)?;
        let (written, port) = answer.trim_end().split_once(' ').ok_or(ErrorKind::UnexpectedEof)?;
        Ok(Pressed { port: port.to_owned(), written: written == "1" })
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use super::{EmergencyStop, Error, Pressed, TableHost};

    /// Stop button, which doesn't exist on this system: only a stop on the port itself remains.
    #[derive(Debug)]
    pub struct Button;

    impl Button {
        /// Offers nothing.
        ///
        /// # Errors
        /// Never.
        pub fn offer(_: &str, _: EmergencyStop, _: TableHost) -> Result<Self, Error> {
            Ok(Self)
        }
    }

    /// Presses nothing.
    ///
    /// # Errors
    /// Never.
    pub fn press(_: Option<&str>) -> Result<Vec<Pressed>, Error> {
        Ok(Vec::new())
    }
}
