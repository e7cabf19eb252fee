//! Simulated controllers at an address.

use super::{Controller, SimulatedServer};
use crate::{Dialect, Error};
use octant_base::address::parts::AddressParts;
use octant_base::address::{AddressError, CONNECT_LIMIT, HostForm};
use octant_plant::config::TurntableConfig;

/// Angle of the table's end switches, in either direction, degrees: two turns.
const END_DEG: f64 = 720.0;

/// Serves a simulated controller at `tcp:HOST:PORT`, or on a new pseudo-terminal with a link to it,
/// `pty:LINK`. The table is that of the default scenario. Returns the server, and the name by which it
/// is reached.
///
/// # Errors
/// If it can't listen there.
pub fn listen(at: &str, dialect: Dialect) -> Result<(SimulatedServer, String), Error> {
    let degrees = f64::to_radians;
    let config = TurntableConfig {
        rate_radps: degrees(10.0),
        acceleration_radps2: degrees(10.0),
        encoder_sigma_rad: 0.0,
        non_orthogonality_rad: 0.0,
        backlash_rad: 0.0,
        errors: Default::default(),
    };
    let controller = Controller::new(dialect, &config, degrees(END_DEG));
    let form = || {
        let expected = format!("{}, or pty:LINK", HostForm::Wire.expected("tcp"));
        Error::Address(AddressError::Name { found: at.to_owned(), expected })
    };
    match at.split_once(':') {
        Some(("tcp", address)) => {
            let parts = AddressParts::read(at, address, "tcp", &[]).map_err(Error::Address)?;
            let address = HostForm::Wire.read(&parts, "tcp").map_err(Error::Address)?;
            let server = address
                .resolve(CONNECT_LIMIT)
                .and_then(|addresses| SimulatedServer::tcp(controller, &*addresses, 1.0))
                .map_err(|error| Error::Listen {
                    port: at.to_owned(),
                    reason: error.to_string(),
                })?;
            let name =
                server.address().map_or_else(|| at.to_owned(), |address| format!("tcp:{address}"));
            Ok((server, name))
        }
        Some(("pty", link)) if !link.is_empty() => on_pty(controller, link),
        _ => Err(form()),
    }
}

#[cfg(unix)]
fn on_pty(controller: Controller, link: &str) -> Result<(SimulatedServer, String), Error> {
    let failed = |reason: String| Error::Listen { port: format!("pty:{link}"), reason };
    let (near, _far, name) =
        octant_base::serial::SerialPort::pair().map_err(|error| failed(error.to_string()))?;
    let is_link = |about: std::fs::Metadata| about.file_type().is_symlink();
    if std::fs::symlink_metadata(link).is_ok_and(is_link) {
        std::fs::remove_file(link).map_err(|error| failed(error.to_string()))?;
    }
    std::os::unix::fs::symlink(&name, link)
        .map_err(|error| failed(format!("link to {name}: {error}")))?;
    let server =
        SimulatedServer::line(controller, near, 1.0).map_err(|error| failed(error.to_string()))?;
    Ok((server, format!("serial:{link}")))
}

#[cfg(not(unix))]
fn on_pty(_: Controller, link: &str) -> Result<(SimulatedServer, String), Error> {
    let reason = "there are no pseudo-terminals on this system".to_owned();
    Err(Error::Listen { port: format!("pty:{link}"), reason })
}
