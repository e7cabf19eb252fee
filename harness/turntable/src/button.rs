//! A stop that another program can press.
//!
//! A controller often takes one peer at a time, and a serial port that is open can't be opened again: while a
//! harness drives a table, nobody else reaches it. So the harness has a socket of its own for each table, in a
//! folder of this host, and a thread that does nothing else than to wait for somebody who presses. It takes no
//! lock of the driver and needs no reply of the table. Who may log in here may stop a table, and can do nothing
//! else to it.

use crate::{EmergencyStop, Error};

/// What was pressed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pressed {
    /// Port of the table, as its harness calls it.
    pub port: String,
    /// The harness could write the bytes that stop it.
    pub written: bool,
}

#[cfg(unix)]
pub use unix::{Button, press};

#[cfg(not(unix))]
pub use elsewhere::{Button, press};

#[cfg(unix)]
mod unix {
    use super::{EmergencyStop, Error, Pressed};
    use std::io::{self, ErrorKind, Read, Write};
    use std::os::unix::fs::{FileTypeExt, PermissionsExt};
    use std::os::unix::net::{UnixListener, UnixStream};
    use std::path::{Path, PathBuf};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::JoinHandle;
    use std::time::Duration;

    /// The same for every user and every environment: who is in a hurry doesn't look for it.
    const FOLDER: &str = "/tmp/octant-tables";
    /// What is said to press it. A connection alone is somebody who wants to know whether it is in use.
    const WORD: &[u8] = b"stop\n";
    /// How long either end waits for the other.
    const PATIENCE: Duration = Duration::from_secs(3);

    /// The file of a port's socket: a short name, since those of sockets have to be.
    fn place(port: &str) -> PathBuf {
        // FNV-1a.
        let hash = port.bytes().fold(0xCBF2_9CE4_8422_2325u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        });
        Path::new(FOLDER).join(format!("{hash:016x}"))
    }

    /// The button of a table. It goes when it is dropped.
    #[derive(Debug)]
    pub struct Button {
        place: PathBuf,
        ends: Arc<AtomicBool>,
        thread: Option<JoinHandle<()>>,
    }

    impl Button {
        /// Offers the stop of the table on a port.
        ///
        /// # Errors
        /// If another program drives the table, or the socket can't be made.
        pub fn offer(port: &str, stop: EmergencyStop) -> Result<Self, Error> {
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
                    for stream in listener.incoming() {
                        if ended.load(Ordering::SeqCst) {
                            return;
                        }
                        if let Ok(stream) = stream {
                            // Who doesn't wait for the answer has pressed all the same.
                            let _ = pressed(stream, &stop, &name);
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
            // It waits for somebody: that is us. Without anybody to wake it, it is left to itself.
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
            // Whoever drives the next table may be another user. Where the folder is another's, it stays as
            // it is.
            let open = std::fs::Permissions::from_mode(0o1777);
            let _ = std::fs::set_permissions(FOLDER, open);
        }
        let listener = match UnixListener::bind(place) {
            // A socket that nobody listens at is left from a harness that was killed.
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

    fn pressed(mut stream: UnixStream, stop: &EmergencyStop, port: &str) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut word = [0; WORD.len()];
        stream.read_exact(&mut word)?;
        if word != WORD {
            return Ok(());
        }
        let written = stop.trip("somebody pressed the stop on the command line");
        writeln!(stream, "{} {port}", u8::from(written))
    }

    /// Presses the button of a table that a program on this host drives; without a port those of all.
    /// What was pressed: nothing where nobody drives it.
    ///
    /// # Errors
    /// If a button is there and doesn't answer.
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
            // One that is left over has nobody behind it.
            let Ok(stream) = UnixStream::connect(&place) else { continue };
            match answer(stream) {
                Ok(pressed) => all.push(pressed),
                // The others are pressed all the same.
                Err(error) => {
                    let port = port.unwrap_or("a table of this host").to_owned();
                    let reason = format!("who drives it doesn't answer: {error}");
                    silent = Some(Error::Button { port, reason });
                }
            }
        }
        silent.map_or(Ok(all), Err)
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
    use super::{EmergencyStop, Error, Pressed};

    /// There are none here: what is left is a stop on the port itself.
    #[derive(Debug)]
    pub struct Button;

    impl Button {
        /// Offers nothing.
        ///
        /// # Errors
        /// Never.
        pub fn offer(_: &str, _: EmergencyStop) -> Result<Self, Error> {
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
