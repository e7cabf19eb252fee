//! Serial ports, opened exclusively, and pairs of pseudo terminals: 8 data bits, no parity, one stop bit,
//! no flow control, and no byte that the system acts on.

use std::io::{self, Read, Write};
use std::time::Duration;

/// An open serial port, or one end of a pair of pseudo terminals.
#[derive(Debug)]
pub struct SerialPort {
    port: serial2::SerialPort,
    wait: Duration,
}

impl SerialPort {
    /// Opens a port exclusively, with a rate in bit/s. Bytes that came before the opening are dropped.
    ///
    /// # Errors
    /// If the port isn't there, another program has it, or its driver sets another rate.
    pub fn open(path: &str, baud: u32) -> io::Result<Self> {
        let mut port = system::open(path)?;
        let mut settings = port.get_configuration()?;
        settings.set_raw();
        settings.set_baud_rate(baud)?;
        let set = port.set_configuration(&settings);
        // A driver that can't set a rate may take another one, with or without a word.
        let found = port.get_configuration()?.get_baud_rate()?;
        if found != baud {
            return Err(io::Error::other(format!(
                "the driver gave {found} baud, expected {baud}: this port can't do that rate"
            )));
        }
        set?;
        port.discard_input_buffer()?;
        Ok(Self { port, wait: Duration::ZERO })
    }

    /// Opens a pair of pseudo terminals: the near end, the far end, and the name under which another
    /// program opens the far end. The far end isn't locked: the program that opens it locks it.
    ///
    /// # Errors
    /// If the system has none, or none is free.
    #[cfg(unix)]
    pub fn pair() -> io::Result<(Self, Self, String)> {
        let (near, far) = serial2::SerialPort::pair()?;
        let name = rustix::pty::ptsname(&near, Vec::new())?;
        let name = name.into_string().map_err(io::Error::other)?;
        let open = |port| Self { port, wait: Duration::ZERO };
        Ok((open(near), open(far), name))
    }

    /// Sets the longest wait of a read or a write, which then returns `TimedOut`; zero at first.
    pub fn set_wait(&mut self, wait: Duration) {
        self.wait = wait;
    }

    /// Makes another handle of the port, which works while this one is in use.
    ///
    /// # Errors
    /// If the system has no handle left.
    pub fn try_clone(&self) -> io::Result<Self> {
        Ok(Self { port: self.port.try_clone()?, wait: self.wait })
    }
}

impl Read for SerialPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        system::read(&mut self.port, buffer, self.wait)
    }
}

impl Write for SerialPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        system::write(&mut self.port, bytes, self.wait)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.port.flush()
    }
}

#[cfg(unix)]
impl std::os::fd::AsFd for SerialPort {
    fn as_fd(&self) -> std::os::fd::BorrowedFd<'_> {
        self.port.as_fd()
    }
}

#[cfg(unix)]
mod system {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::fs::{FlockOperation, Mode, OFlags, flock};
    use serial2::SerialPort;
    use std::io;
    use std::time::Duration;

    /// Opens and locks a port before its settings are changed: it may be another program's.
    pub(super) fn open(path: &str) -> io::Result<SerialPort> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let file = rustix::fs::open(path, flags, Mode::empty())?;
        rustix::termios::ioctl_tiocexcl(&file)?;
        flock(&file, FlockOperation::NonBlockingLockExclusive)?;
        Ok(SerialPort::from(file))
    }

    /// Waits until a port is ready. The wait has the resolution of the kernel's clock, where the
    /// library's has milliseconds.
    fn ready(port: &SerialPort, wanted: PollFlags, wait: Duration) -> io::Result<()> {
        let mut polled = [PollFd::new(port, wanted)];
        // A wait beyond the kernel's range is one without an end.
        let wait = Timespec::try_from(wait).ok();
        if poll(&mut polled, wait.as_ref())? == 0 {
            return Err(io::ErrorKind::TimedOut.into());
        }
        let found = polled[0].revents();
        // Bytes that came before a hang-up can still be read.
        let gone = found.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL);
        if gone && !(wanted == PollFlags::IN && found.contains(wanted)) {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        Ok(())
    }

    fn timed_out(error: rustix::io::Errno) -> io::Error {
        match error {
            rustix::io::Errno::AGAIN => io::ErrorKind::TimedOut.into(),
            other => other.into(),
        }
    }

    pub(super) fn read(
        port: &mut SerialPort,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<usize> {
        ready(port, PollFlags::IN, wait)?;
        rustix::io::read(&*port, buffer).map_err(timed_out)
    }

    pub(super) fn write(port: &mut SerialPort, bytes: &[u8], wait: Duration) -> io::Result<usize> {
        ready(port, PollFlags::OUT, wait)?;
        rustix::io::write(&*port, bytes).map_err(timed_out)
    }
}

#[cfg(not(unix))]
mod system {
    use serial2::SerialPort;
    use std::io;
    use std::time::Duration;

    /// Opens a port, which the system gives to one program only.
    pub(super) fn open(path: &str) -> io::Result<SerialPort> {
        SerialPort::open(path, serial2::KeepSettings)
    }

    pub(super) fn read(
        port: &mut SerialPort,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<usize> {
        port.set_read_timeout(wait)?;
        port.read(buffer)
    }

    pub(super) fn write(port: &mut SerialPort, bytes: &[u8], wait: Duration) -> io::Result<usize> {
        port.set_write_timeout(wait)?;
        port.write(bytes)
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn every_byte_passes_in_both_directions_as_it_is() {
        let (mut near, far, name) = SerialPort::pair().expect("there are pseudo terminals");
        let mut port = SerialPort::open(&name, 921_600).expect("can be opened");
        drop(far);
        let all: Vec<u8> = (0..=255).collect();
        let mut buffer = [0; 256];
        for port in [&mut near, &mut port] {
            port.set_wait(Duration::from_secs(5));
        }
        near.write_all(&all).expect("is written");
        port.read_exact(&mut buffer).expect("is read");
        assert_eq!(buffer, *all);
        port.write_all(&all).expect("is written");
        near.read_exact(&mut buffer).expect("is read");
        assert_eq!(buffer, *all);
    }

    #[test]
    fn a_wait_ends_in_time_and_a_closed_end_is_an_error() {
        let (mut near, far, _) = SerialPort::pair().expect("there are pseudo terminals");
        let started = Instant::now();
        near.set_wait(Duration::from_micros(1500));
        let error = near.read(&mut [0]).expect_err("nothing was sent");
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(started.elapsed() >= Duration::from_micros(1500));
        drop(far);
        near.set_wait(Duration::from_secs(5));
        let error = near.read(&mut [0]).expect_err("nobody has it open");
        assert_eq!(error.kind(), io::ErrorKind::BrokenPipe);
        let error = near.write(&[0]).expect_err("nobody has it open");
        assert_eq!(error.kind(), io::ErrorKind::BrokenPipe);
    }

    #[test]
    fn a_port_that_is_open_is_refused_and_so_is_what_is_no_port() {
        let (_near, _far, name) = SerialPort::pair().expect("there are pseudo terminals");
        let port = SerialPort::open(&name, 9600).expect("can be opened");
        let error = SerialPort::open(&name, 9600).expect_err("is open");
        // A privileged user passes the kernel's lock, and meets the one on the file.
        assert!(
            matches!(error.kind(), io::ErrorKind::ResourceBusy | io::ErrorKind::WouldBlock),
            "{error:?}"
        );
        drop(port);
        SerialPort::open(&name, 9600).expect("was closed");
        let error = SerialPort::open("/nowhere", 9600).expect_err("is not there");
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        SerialPort::open("/dev/null", 9600).expect_err("is no port");
    }
}
