//! Names of ports.
//!
//! A name is `SCHEME:NAME?OPTION=VALUE&OPTION=VALUE`. Unknown names are refused, with the nearest known
//! one.

use octant_wire::can::{Bus, Format};
use std::fmt;

/// A port, by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Uri {
    /// A serial line: `serial:/dev/ttyUSB0?baud=921600`.
    Serial(Serial),
    /// A new pseudo terminal, for the device end: `pty:`, or `pty:/tmp/device` with a link to it.
    Pty {
        /// Path of a link to the terminal; empty: no link.
        link: String,
    },
    /// A CAN interface of the kernel: `can:can0?fd=1`.
    Can(Can),
    /// A CAN adapter behind a serial line that speaks slcan: `slcan:/dev/ttyACM0?bitrate=500000`.
    Slcan(Slcan),
    /// UDP: `udp:host:port`.
    Udp(Udp),
}

/// A serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Serial {
    /// Name of the port.
    pub path: String,
    /// Bit rate, bit/s.
    pub baud: u32,
}

/// A CAN interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Can {
    /// Name of the interface.
    pub interface: String,
    /// Format of the frames.
    pub format: Format,
    /// Nominal bit rate that the bus must have, bit/s; `None`: as the interface reports.
    pub bitrate: Option<u32>,
    /// Bit rate of the data of FD frames, likewise, bit/s.
    pub data_bitrate: Option<u32>,
}

/// A CAN adapter behind a serial line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slcan {
    /// The serial line.
    pub serial: Serial,
    /// The bus behind it.
    pub bus: Bus,
}

/// A UDP address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Udp {
    /// Host or address of the other end; at the device end, the address to listen at; empty: loopback.
    pub host: String,
    /// Port; at the device end, 0 is any free port.
    pub port: u16,
}

/// Default bit rate of a serial line, bit/s.
pub const DEFAULT_BAUD: u32 = 921_600;

/// Bit rates that slcan has a command for, bit/s.
pub const SLCAN_BITRATES: [u32; 9] =
    [10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000];

/// Bit rates of FD data that slcan has a command for, bit/s.
pub const SLCAN_DATA_BITRATES: [u32; 4] = [1_000_000, 2_000_000, 4_000_000, 5_000_000];

/// Schemes, with a description and examples.
pub const SCHEMES: [(&str, &str); 5] = [
    ("serial", "a serial line: serial:/dev/ttyUSB0?baud=921600"),
    ("can", "a CAN interface: can:can0, can:can0?fd=1"),
    ("slcan", "a CAN adapter on a serial line: slcan:/dev/ttyACM0?bitrate=500000"),
    ("udp", "UDP: udp:HOST:PORT"),
    ("pty", "a new pseudo terminal, for octant serve alone"),
];

/// Error of a text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UriError {
    /// The text has nothing before a colon.
    #[error("found {found:?}, expected SCHEME:NAME with a scheme of {}", names(&schemes()))]
    NoScheme {
        /// The text.
        found: String,
    },
    /// The scheme is unknown.
    #[error("found scheme {found:?}, {}", nearest(found, &schemes()))]
    Scheme {
        /// The scheme.
        found: String,
    },
    /// The name after the scheme is missing.
    #[error("found {found:?}, expected {expected}")]
    Name {
        /// The text.
        found: String,
        /// Expected form.
        expected: &'static str,
    },
    /// The scheme doesn't have this option.
    #[error("found option {option:?} of {scheme}:, {}", nearest(option, known))]
    Option {
        /// The scheme.
        scheme: &'static str,
        /// The option.
        option: String,
        /// Options of the scheme.
        known: &'static [&'static str],
    },
    /// An option has no value, or is given twice.
    #[error("found {found:?} among the options, expected OPTION=VALUE, each once")]
    Form {
        /// Text found.
        found: String,
    },
    /// The value is invalid.
    #[error("found {option}={found}, expected {expected}")]
    Value {
        /// The option.
        option: &'static str,
        /// Value found.
        found: String,
        /// Expected form.
        expected: String,
    },
}

fn schemes() -> [&'static str; 5] {
    SCHEMES.map(|(name, _)| name)
}

fn names(known: &[&str]) -> String {
    known.join(", ")
}

/// Suggests the nearest of some names, or lists all of them.
fn nearest(found: &str, known: &[&str]) -> String {
    let near = known
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name), name))
        .filter(|(distance, name)| *distance <= name.len().max(2) / 2)
        .min();
    match near {
        Some((_, name)) => format!("expected {name}?"),
        None if known.is_empty() => "it has no options".to_owned(),
        None => format!("known are {}", names(known)),
    }
}

/// Options as written.
struct Options<'a> {
    all: Vec<(&'a str, &'a str)>,
}

impl<'a> Options<'a> {
    fn read(
        text: Option<&'a str>,
        scheme: &'static str,
        known: &'static [&'static str],
    ) -> Result<Self, UriError> {
        let mut all: Vec<(&str, &str)> = Vec::new();
        for part in text.into_iter().flat_map(|text| text.split('&')) {
            let Some((option, value)) = part.split_once('=') else {
                return Err(UriError::Form { found: part.to_owned() });
            };
            if !known.contains(&option) {
                return Err(UriError::Option { scheme, option: option.to_owned(), known });
            }
            if all.iter().any(|(other, _)| *other == option) {
                return Err(UriError::Form { found: part.to_owned() });
            }
            all.push((option, value));
        }
        Ok(Self { all })
    }

    fn get(&self, option: &str) -> Option<&'a str> {
        self.all.iter().find(|(name, _)| *name == option).map(|(_, value)| *value)
    }

    fn rate(&self, option: &'static str) -> Result<Option<u32>, UriError> {
        let Some(text) = self.get(option) else { return Ok(None) };
        match text.parse() {
            Ok(rate @ 1..) => Ok(Some(rate)),
            _ => Err(UriError::Value {
                option,
                found: text.to_owned(),
                expected: "a whole number of bits a second".to_owned(),
            }),
        }
    }

    /// Format given by `fd`; `data_bitrate` requires `fd=1`.
    fn format(&self) -> Result<Format, UriError> {
        let format = match self.get("fd") {
            None | Some("0") => Format::Classic,
            Some("1") => Format::Fd,
            Some(found) => {
                return Err(UriError::Value {
                    option: "fd",
                    found: found.to_owned(),
                    expected: "0 (classic CAN) or 1 (CAN FD)".to_owned(),
                });
            }
        };
        if let (Format::Classic, Some(found)) = (format, self.get("data_bitrate")) {
            return Err(UriError::Value {
                option: "data_bitrate",
                found: found.to_owned(),
                expected: "fd=1 with it: classic CAN has one bit rate".to_owned(),
            });
        }
        Ok(format)
    }
}

impl std::str::FromStr for Uri {
    type Err = UriError;

    fn from_str(text: &str) -> Result<Self, UriError> {
        let found = || text.to_owned();
        let (scheme, rest) =
            text.split_once(':').ok_or_else(|| UriError::NoScheme { found: found() })?;
        let (name, options) = match rest.split_once('?') {
            Some((name, options)) => (name, Some(options)),
            None => (rest, None),
        };
        let named = |expected| match name {
            "" => Err(UriError::Name { found: found(), expected }),
            name => Ok(name.to_owned()),
        };
        match scheme {
            "serial" => {
                let options = Options::read(options, "serial", &["baud"])?;
                let path = named("serial:PORT, such as serial:/dev/ttyUSB0")?;
                let baud = options.rate("baud")?.unwrap_or(DEFAULT_BAUD);
                Ok(Self::Serial(Serial { path, baud }))
            }
            "pty" => {
                Options::read(options, "pty", &[])?;
                Ok(Self::Pty { link: name.to_owned() })
            }
            "can" => {
                let options = Options::read(options, "can", &["fd", "bitrate", "data_bitrate"])?;
                Ok(Self::Can(Can {
                    interface: named("can:INTERFACE, such as can:can0")?,
                    format: options.format()?,
                    bitrate: options.rate("bitrate")?,
                    data_bitrate: options.rate("data_bitrate")?,
                }))
            }
            "slcan" => {
                const KNOWN: &[&str] = &["baud", "bitrate", "fd", "data_bitrate"];
                let options = Options::read(options, "slcan", KNOWN)?;
                let path = named("slcan:PORT, such as slcan:/dev/ttyACM0")?;
                let baud = options.rate("baud")?.unwrap_or(DEFAULT_BAUD);
                Ok(Self::Slcan(Slcan { serial: Serial { path, baud }, bus: slcan_bus(&options)? }))
            }
            "udp" => {
                Options::read(options, "udp", &[])?;
                udp(name).ok_or_else(|| UriError::Name {
                    found: found(),
                    expected: "udp:HOST:PORT, such as udp:127.0.0.1:5005 or udp:[::1]:5005",
                })
            }
            _ => Err(UriError::Scheme { found: scheme.to_owned() }),
        }
    }
}

fn slcan_bus(options: &Options<'_>) -> Result<Bus, UriError> {
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
    let format = options.format()?;
    let nominal_bps = one_of("bitrate", options.rate("bitrate")?, &SLCAN_BITRATES)?;
    let data_bps = match format {
        Format::Classic => None,
        Format::Fd => {
            let found = options.rate("data_bitrate")?;
            Some(one_of("data_bitrate", found, &SLCAN_DATA_BITRATES)?)
        }
    };
    Ok(Bus { nominal_bps, data_bps })
}

/// Parses `host:port`, `[v6]:port`, `:port` or `port`.
fn udp(name: &str) -> Option<Uri> {
    let (host, port) = name.rsplit_once(':').unwrap_or(("", name));
    let host = host.strip_prefix('[').map_or(Some(host), |host| host.strip_suffix(']'))?;
    let port = port.parse().ok()?;
    Some(Uri::Udp(Udp { host: host.to_owned(), port }))
}

impl Uri {
    /// Scheme of the URI.
    #[must_use]
    pub fn scheme(&self) -> &'static str {
        match self {
            Self::Serial(_) => "serial",
            Self::Pty { .. } => "pty",
            Self::Can(_) => "can",
            Self::Slcan(_) => "slcan",
            Self::Udp(_) => "udp",
        }
    }

    /// True if a text names a port by a known scheme, correctly or not.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.split_once(':').is_some_and(|(scheme, _)| schemes().contains(&scheme))
    }
}

impl fmt::Display for Uri {
    /// Writes the URI in the form that is parsed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(Serial { path, baud }) => write!(f, "serial:{path}?baud={baud}"),
            Self::Pty { link } => write!(f, "pty:{link}"),
            Self::Can(Can { interface, format, bitrate, data_bitrate }) => {
                write!(f, "can:{interface}?fd={}", u8::from(*format == Format::Fd))?;
                for (option, rate) in [("bitrate", bitrate), ("data_bitrate", data_bitrate)] {
                    if let Some(rate) = rate {
                        write!(f, "&{option}={rate}")?;
                    }
                }
                Ok(())
            }
            Self::Slcan(Slcan { serial: Serial { path, baud }, bus }) => {
                write!(f, "slcan:{path}?baud={baud}&bitrate={}", bus.nominal_bps)?;
                match bus.data_bps {
                    Some(rate) => write!(f, "&fd=1&data_bitrate={rate}"),
                    None => Ok(()),
                }
            }
            Self::Udp(Udp { host, port }) if host.contains(':') => write!(f, "udp:[{host}]:{port}"),
            Self::Udp(Udp { host, port }) => write!(f, "udp:{host}:{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        text.parse::<Uri>().unwrap_err().to_string()
    }

    #[test]
    fn a_name_is_what_it_was_read_from() {
        for text in [
            "serial:/dev/ttyUSB0?baud=921600",
            "serial:COM3?baud=115200",
            "pty:",
            "pty:/tmp/device",
            "can:can0?fd=0",
            "can:vcan1?fd=1&bitrate=500000&data_bitrate=2000000",
            "slcan:/dev/ttyACM0?baud=115200&bitrate=500000",
            "slcan:/dev/ttyACM0?baud=115200&bitrate=1000000&fd=1&data_bitrate=5000000",
            "udp:192.168.1.7:5005",
            "udp:[::1]:5005",
            "udp::5005",
        ] {
            let uri: Uri = text.parse().unwrap();
            assert_eq!(uri.to_string(), text);
            assert!(Uri::is_one(text) && text.starts_with(uri.scheme()));
        }
        let Uri::Serial(serial) = "serial:/dev/ttyS0".parse().unwrap() else { panic!() };
        assert_eq!(serial.baud, DEFAULT_BAUD);
        let Uri::Udp(udp) = "udp:5005".parse().unwrap() else { panic!() };
        assert_eq!((udp.host.as_str(), udp.port), ("", 5005));
    }

    #[test]
    fn what_is_not_known_is_refused_with_the_nearest() {
        assert!(refused("/dev/ttyUSB0").contains("expected SCHEME:NAME"));
        assert!(refused("seral:/dev/ttyUSB0").contains("expected serial?"));
        assert!(refused("usb:1").contains("known are serial, can, slcan, udp, pty"));
        assert!(refused("serial:/dev/ttyUSB0?bauds=1").contains("expected baud?"));
        assert!(refused("can:can0?bit_rate=500000").contains("expected bitrate?"));
        assert!(refused("udp:localhost:5005?baud=1").contains("it has no options"));
        assert!(refused("serial:/dev/ttyUSB0?baud=9600&baud=9600").contains("each once"));
        assert!(refused("serial:/dev/ttyUSB0?baud").contains("expected OPTION=VALUE"));
    }

    #[test]
    fn values_are_checked() {
        assert!(refused("serial:").contains("expected serial:PORT"));
        assert!(refused("serial:/dev/ttyUSB0?baud=fast").contains("found baud=fast"));
        assert!(refused("serial:/dev/ttyUSB0?baud=0").contains("found baud=0"));
        assert!(refused("can:can0?fd=yes").contains("0 (classic CAN) or 1 (CAN FD)"));
        assert!(refused("can:can0?data_bitrate=2000000").contains("fd=1 with it"));
        assert!(refused("slcan:/dev/ttyACM0").contains("found bitrate=nothing"));
        assert!(refused("slcan:/dev/ttyACM0?bitrate=123456").contains("one of 10000, 20000"));
        let fd = "slcan:/dev/ttyACM0?bitrate=500000&fd=1";
        assert!(refused(fd).contains("found data_bitrate=nothing"));
        for text in ["udp:", "udp:localhost", "udp:localhost:65536", "udp:[::1:5005"] {
            assert!(refused(text).contains("udp:HOST:PORT"), "{text}");
        }
    }
}
