//! Pseudo terminals: a serial line without hardware, for a device that is a program.

use super::bytes::Bytes;
use super::error::PortError;
use std::time::Duration;

/// Near end of a pseudo terminal; the far end is opened by its name, like a serial port.
#[derive(Debug)]
pub struct Pty {
    link: String,
    /// `None` while the terminal is closed.
    #[cfg(unix)]
    inner: Option<unix::Pair>,
}

#[cfg(unix)]
mod unix {
    use crate::port::error::PortError;
    use octant_base::serial::SerialPort;
    use std::path::PathBuf;

    #[derive(Debug)]
    pub(super) struct Pair {
        pub(super) near: SerialPort,
        /// The far end is held open: reading fails at a near end whose far end was closed by its last
        /// user.
        _far: SerialPort,
        pub(super) name: String,
        /// Link to the far end, removed on drop.
        link: Option<PathBuf>,
    }

    impl Pair {
        pub(super) fn open(link: &str) -> Result<Self, PortError> {
            let refused = |reason: String| PortError::open(format!("pty:{link}"), reason);
            let (near, far, name) =
                SerialPort::pair().map_err(|error| refused(error.to_string()))?;
            let link = match link {
                "" => None,
                link => {
                    make(&name, link).map_err(|error| refused(error.to_string()))?;
                    Some(PathBuf::from(link))
                }
            };
            Ok(Self { near, _far: far, name, link })
        }
    }

    /// Makes a link, replacing a dangling one that an earlier device left behind.
    fn make(name: &str, link: &str) -> std::io::Result<()> {
        let stale = std::fs::symlink_metadata(link).is_ok_and(|about| {
            about.file_type().is_symlink() && !std::fs::exists(link).unwrap_or(true)
        });
        if stale {
            std::fs::remove_file(link)?;
        }
        std::os::unix::fs::symlink(name, link)
    }

    impl Drop for Pair {
        fn drop(&mut self) {
            if let Some(link) = &self.link {
                // The link may be gone already.
                let _ = std::fs::remove_file(link);
            }
        }
    }
}

impl Pty {
    /// Creates a pseudo terminal; with a link to its far end, unless `link` is empty.
    ///
    /// # Errors
    /// If the system has no pseudo terminals, none is free, or the link can't be made.
    #[cfg(unix)]
    pub fn open(link: &str) -> Result<Self, PortError> {
        Ok(Self { inner: Some(unix::Pair::open(link)?), link: link.to_owned() })
    }

    /// Fails, because the system has no pseudo terminals.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(unix))]
    pub fn open(link: &str) -> Result<Self, PortError> {
        Err(PortError::open(format!("pty:{link}"), "there are no pseudo terminals on this system"))
    }

    /// Name of the far end.
    #[must_use]
    pub fn name(&self) -> &str {
        #[cfg(unix)]
        return self.inner.as_ref().map_or("", |pair| &pair.name);
        #[cfg(not(unix))]
        return "";
    }
}

#[cfg(unix)]
impl Bytes for Pty {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        match &mut self.inner {
            Some(pair) => super::serial::write(&mut pair.near, &pair.name, bytes, wait),
            None => Err(super::serial::closed("pty:")),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        match &mut self.inner {
            Some(pair) => super::serial::read(&mut pair.near, &pair.name, buffer, wait),
            None => Err(super::serial::closed("pty:")),
        }
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        format!("serial:{}", self.name())
    }

    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {
        self.inner = None;
    }

    /// Creates a new terminal, under the same link and another name.
    fn reopen(&mut self) -> Result<(), PortError> {
        self.inner = None;
        *self = Self::open(&self.link)?;
        Ok(())
    }
}

#[cfg(not(unix))]
impl Bytes for Pty {
    fn send(&mut self, _: &[u8], _: Duration) -> Result<bool, PortError> {
        Err(PortError::gone("pty:", "there are no pseudo terminals on this system"))
    }

    fn receive(&mut self, _: &mut [u8], _: Duration) -> Result<usize, PortError> {
        Err(PortError::gone("pty:", "there are no pseudo terminals on this system"))
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        String::new()
    }

    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {}

    fn reopen(&mut self) -> Result<(), PortError> {
        *self = Self::open(&self.link)?;
        Ok(())
    }
}
