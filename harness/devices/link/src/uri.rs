//! Names of ports.
//!
//! A name is `SCHEME:NAME?OPTION=VALUE&OPTION=VALUE`. Unknown names are refused, with the nearest known
//! one.

pub use octant_base::address::AddressError as UriError;
pub use octant_base::address::{HostPort, SerialAddress};

use octant_base::address::HostForm;
use octant_base::address::parts::AddressParts;
use octant_faults::wire::Medium;
use octant_wire::can::{Bus, CanVersion};
use std::fmt;

/// A port, by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Uri {
    /// A serial line: `serial:/dev/ttyUSB0?baud=921600`.
    Serial(SerialAddress),
    /// A new pseudo terminal, for the device end: `pty:`, or `pty:/tmp/device` with a link to it.
    Pty {
        /// Path of a link to the terminal; empty: no link.
        link: String,
    },
    /// A CAN interface of the kernel: `can:can0?fd=1`.
    Can(Can),
    /// A CAN adapter behind a serial line that speaks slcan: `slcan:/dev/ttyACM0?bitrate=500000`.
    Slcan(SlcanUri),
    /// UDP: `udp:host:port`, `udp:host:port?secret=FILE`.
    Udp(Udp),
    /// TCP: `tcp:host:port`; `tcp:host:port?listen=1` of an instrument that connects itself.
    Tcp(Tcp),
    /// A program whose standard input and output are the line: `exec:./core --fast`.
    Exec(Exec),
    /// Standard input and output, for the device end of `exec:`: `stdio:`.
    Stdio,
}

/// A CAN interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Can {
    /// Name of the interface.
    pub interface: String,
    /// Format of the frames.
    pub format: CanVersion,
    /// Nominal bit rate that the bus must have, bit/s; `None`: as the interface reports.
    pub bitrate: Option<u32>,
    /// Bit rate of the data of FD frames, likewise, bit/s.
    pub data_bitrate: Option<u32>,
}

impl Can {
    /// Bus as named, if its rates are.
    fn bus(&self) -> Option<Bus> {
        let nominal_bps = self.bitrate?;
        match (self.format, self.data_bitrate) {
            (CanVersion::Classic, _) => Some(Bus::classic(nominal_bps)),
            (CanVersion::Fd, data) => Some(Bus::fd(nominal_bps, data.unwrap_or(nominal_bps))),
        }
    }
}

/// A CAN adapter behind a serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SlcanUri {
    /// The serial line.
    pub serial: SerialAddress,
    /// The bus behind it.
    pub bus: Bus,
}

/// A UDP address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Udp {
    /// Other end; at the device end, the address to listen at.
    pub address: HostPort,
    /// File with the secret that both ends share; `None`: anyone may talk.
    pub secret: Option<String>,
}

/// A TCP address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tcp {
    /// Other end; at the end that listens, the address to listen at.
    pub address: HostPort,
    /// True if an instrument connects to this host, in place of the other way round.
    pub listen: bool,
}

/// A program with its arguments. In its text, spaces separate them; there are no quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exec {
    /// The program, from the current folder or on the path.
    pub program: String,
    /// Its arguments.
    pub arguments: Vec<String>,
}

/// Bit rates of a port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rates {
    /// A line with a wire for each direction, bit/s.
    Line(u32),
    /// A bus; `None`: the rates are those that its interface reports.
    Bus(Option<Bus>),
    /// None: a pseudo terminal, UDP, TCP, a program.
    Unlimited,
}

/// Default bit rate of a serial line, bit/s.
pub const DEFAULT_BAUD: u32 = 921_600;

/// Bit rates that slcan has a command for, bit/s.
pub const SLCAN_BITRATES: [u32; 9] =
    [10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000];

/// Bit rates of FD data that slcan has a command for, bit/s.
pub const SLCAN_DATA_BITRATES: [u32; 4] = [1_000_000, 2_000_000, 4_000_000, 5_000_000];

/// A scheme: everything that follows from it alone.
#[derive(Debug)]
pub struct Scheme {
    /// Text before the colon.
    pub name: &'static str,
    /// Devices behind a port of this scheme, with an example; `None`: it is for the device end alone.
    pub devices: Option<&'static str>,
    /// Medium, which decides what faults it can have.
    pub medium: Medium,
    options: &'static [&'static str],
    read: fn(&AddressParts<'_>) -> Result<Uri, UriError>,
}

/// All schemes.
pub const SCHEMES: [Scheme; 8] = [SERIAL, CAN, SLCAN, UDP, TCP, EXEC, PTY, STDIO];

const SERIAL: Scheme = Scheme {
    name: "serial",
    devices: Some("a device on a serial line: serial:/dev/ttyUSB0?baud=921600 (the default rate)"),
    medium: Medium::Line,
    options: &["baud"],
    read: |parts| {
        Ok(Uri::Serial(SerialAddress::read(parts, DEFAULT_BAUD, &serial_form("serial"))?))
    },
};

const CAN: Scheme = Scheme {
    name: "can",
    devices: Some("a device on a CAN bus: can:can0, can:can0?fd=1"),
    medium: Medium::Bus,
    options: &["fd", "bitrate", "data_bitrate"],
    read: |parts| {
        Ok(Uri::Can(Can {
            interface: parts.named("can:INTERFACE, such as can:can0")?,
            format: format(parts)?,
            bitrate: parts.rate("bitrate")?,
            data_bitrate: parts.rate("data_bitrate")?,
        }))
    },
};

const SLCAN: Scheme = Scheme {
    name: "slcan",
    devices: Some("the same through an adapter: slcan:/dev/ttyACM0?bitrate=500000"),
    medium: Medium::Bus,
    options: &["baud", "bitrate", "fd", "data_bitrate"],
    read: |parts| {
        let serial = SerialAddress::read(parts, DEFAULT_BAUD, &serial_form("slcan"))?;
        Ok(Uri::Slcan(SlcanUri { serial, bus: slcan_bus(parts)? }))
    },
};

const UDP: Scheme = Scheme {
    name: "udp",
    devices: Some("a device on UDP: udp:HOST:PORT"),
    medium: Medium::Datagrams,
    options: &["secret"],
    read: |parts| {
        let address = HostForm::Wire.read(parts, "udp")?;
        Ok(Uri::Udp(Udp { address, secret: parts.file("secret")? }))
    },
};

const TCP: Scheme = Scheme {
    name: "tcp",
    devices: Some("a device on TCP: tcp:HOST:PORT"),
    medium: Medium::Line,
    options: &["listen"],
    read: |parts| {
        let listen = match parts.get("listen") {
            None => false,
            Some("1") => true,
            Some(found) => {
                return Err(UriError::Value {
                    option: "listen",
                    found: found.to_owned(),
                    expected: "1, or nothing where this host connects".to_owned(),
                });
            }
        };
        Ok(Uri::Tcp(Tcp { address: HostForm::Wire.read(parts, "tcp")?, listen }))
    },
};

const EXEC: Scheme = Scheme {
    name: "exec",
    devices: Some("a program, by its standard input and output: exec:./core --fast"),
    medium: Medium::Line,
    options: &[],
    read: |parts| {
        let mut words = parts.name.split_whitespace().map(str::to_owned);
        let expected = "exec:PROGRAM ARGUMENT..., such as exec:./core --fast";
        let program = words.next().ok_or_else(|| parts.form(expected))?;
        Ok(Uri::Exec(Exec { program, arguments: words.collect() }))
    },
};

const PTY: Scheme = Scheme {
    name: "pty",
    devices: None,
    medium: Medium::Line,
    options: &[],
    read: |parts| Ok(Uri::Pty { link: parts.name.to_owned() }),
};

const STDIO: Scheme = Scheme {
    name: "stdio",
    devices: None,
    medium: Medium::Line,
    options: &[],
    read: |parts| {
        if parts.name.is_empty() {
            return Ok(Uri::Stdio);
        }
        Err(parts.form("stdio: alone"))
    },
};

fn schemes() -> Vec<&'static str> {
    SCHEMES.iter().map(|scheme| scheme.name).collect()
}

impl std::str::FromStr for Uri {
    type Err = UriError;

    fn from_str(text: &str) -> Result<Self, UriError> {
        let Some((scheme, rest)) = text.split_once(':') else {
            return Err(UriError::NoScheme { found: text.to_owned(), known: schemes() });
        };
        let Some(known) = SCHEMES.iter().find(|known| known.name == scheme) else {
            return Err(UriError::Scheme { found: scheme.to_owned(), known: schemes() });
        };
        (known.read)(&AddressParts::read(text, rest, known.name, known.options)?)
    }
}

fn slcan_bus(options: &AddressParts<'_>) -> Result<Bus, UriError> {
    let one_of = |option, found: Option<u32>, known: &[u32]| match found {
        Some(rate) if known.contains(&rate) => Ok(rate),
        found => Err(UriError::Value {
            option,
            found: found.map_or_else(|| "nothing".to_owned(), |rate| rate.to_string()),
            expected: format!(
                "one of {}: slcan has a command for no other",
                known.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
            ),
        }),
    };
    let format = format(options)?;
    let nominal_bps = one_of("bitrate", options.rate("bitrate")?, &SLCAN_BITRATES)?;
    let data_bps = match format {
        CanVersion::Classic => None,
        CanVersion::Fd => {
            let found = options.rate("data_bitrate")?;
            Some(one_of("data_bitrate", found, &SLCAN_DATA_BITRATES)?)
        }
    };
    Ok(Bus { nominal_bps, data_bps })
}

/// Text of help for the port of an instrument that sends.
#[must_use]
pub fn instrument_help() -> String {
    format!(
        "Port of the instrument: serial:PORT?baud=RATE ({DEFAULT_BAUD} by default), udp:PORT (on loopback), \
         udp:ADDRESS:PORT, tcp:HOST:PORT, or tcp:ADDRESS:PORT?listen=1 of an instrument that connects to this host"
    )
}

/// Text of help for the port of a server.
#[must_use]
pub fn server_help() -> String {
    format!(
        "Port of the server: serial:PORT?baud=RATE ({DEFAULT_BAUD} by default), can:INTERFACE, slcan:PORT, udp:PORT \
         (on loopback), udp:ADDRESS:PORT, or pty: for a new pseudo terminal"
    )
}

/// Form of an address on a serial line, with the default rate.
fn serial_form(scheme: &str) -> String {
    format!("{scheme}:PORT?baud=RATE ({DEFAULT_BAUD} by default), such as {scheme}:/dev/ttyUSB0")
}

/// Format given by `fd`; `data_bitrate` requires `fd=1`.
fn format(parts: &AddressParts<'_>) -> Result<CanVersion, UriError> {
    let format = match parts.get("fd") {
        None | Some("0") => CanVersion::Classic,
        Some("1") => CanVersion::Fd,
        Some(found) => {
            return Err(UriError::Value {
                option: "fd",
                found: found.to_owned(),
                expected: "0 (classic CAN) or 1 (CAN FD)".to_owned(),
            });
        }
    };
    if let (CanVersion::Classic, Some(found)) = (format, parts.get("data_bitrate")) {
        return Err(UriError::Value {
            option: "data_bitrate",
            found: found.to_owned(),
            expected: "fd=1 with it: classic CAN has one bit rate".to_owned(),
        });
    }
    Ok(format)
}

impl Uri {
    const fn of(&self) -> &'static Scheme {
        match self {
            Self::Serial(_) => const { &SERIAL },
            Self::Pty { .. } => const { &PTY },
            Self::Can(_) => const { &CAN },
            Self::Slcan(_) => const { &SLCAN },
            Self::Udp(_) => const { &UDP },
            Self::Tcp(_) => const { &TCP },
            Self::Exec(_) => const { &EXEC },
            Self::Stdio => const { &STDIO },
        }
    }

    /// Scheme of the URI.
    #[must_use]
    pub const fn scheme(&self) -> &'static str {
        self.of().name
    }

    /// Medium of the port.
    #[must_use]
    pub const fn medium(&self) -> Medium {
        self.of().medium
    }

    /// Bit rates of the port.
    #[must_use]
    pub fn rates(&self) -> Rates {
        match self {
            Self::Serial(serial) => Rates::Line(serial.baud),
            Self::Pty { .. } | Self::Udp(_) | Self::Tcp(_) | Self::Exec(_) | Self::Stdio => {
                Rates::Unlimited
            }
            Self::Can(can) => Rates::Bus(can.bus()),
            // The line of an adapter is USB, whatever baud rate it was given.
            Self::Slcan(slcan) => Rates::Bus(Some(slcan.bus)),
        }
    }

    /// True if a text names a port by a known scheme, correctly or not.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.split_once(':')
            .is_some_and(|(scheme, _)| SCHEMES.iter().any(|known| known.name == scheme))
    }
}

impl fmt::Display for Uri {
    /// Writes the URI in the form that is parsed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(serial) => write!(f, "serial:{serial}"),
            Self::Pty { link } => write!(f, "pty:{link}"),
            Self::Can(Can { interface, format, bitrate, data_bitrate }) => {
                write!(f, "can:{interface}?fd={}", u8::from(*format == CanVersion::Fd))?;
                for (option, rate) in [("bitrate", bitrate), ("data_bitrate", data_bitrate)] {
                    if let Some(rate) = rate {
                        write!(f, "&{option}={rate}")?;
                    }
                }
                Ok(())
            }
            Self::Slcan(SlcanUri { serial, bus }) => {
                write!(f, "slcan:{serial}&bitrate={}", bus.nominal_bps)?;
                match bus.data_bps {
                    Some(rate) => write!(f, "&fd=1&data_bitrate={rate}"),
                    None => Ok(()),
                }
            }
            Self::Udp(Udp { address, secret }) => {
                write!(f, "udp:{address}")?;
                secret.iter().try_for_each(|file| write!(f, "?secret={file}"))
            }
            Self::Tcp(Tcp { address, listen }) => {
                write!(f, "tcp:{address}{}", if *listen { "?listen=1" } else { "" })
            }
            Self::Exec(Exec { program, arguments }) => {
                write!(f, "exec:{program}")?;
                arguments.iter().try_for_each(|argument| write!(f, " {argument}"))
            }
            Self::Stdio => f.write_str("stdio:"),
        }
    }
}
